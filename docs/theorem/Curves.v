(** Curves of vectors, their derivatives, and what the sign of a derivative says on an interval. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors.
Open Scope R_scope.

(** The derivative of the curve [f] at [s] is [v]. (Coquelicot's [is_derive f s l] says it of a real function.) *)
Definition has_rate (f : R -> vec) (s : R) (v : vec) : Prop :=
  is_derive (fun t => x (f t)) s (x v)
  /\ is_derive (fun t => y (f t)) s (y v)
  /\ is_derive (fun t => z (f t)) s (z v).
Arguments has_rate f s v%V.

(** ** Rules of derivation *)

Ltac components := split; [ | split ]; simpl.

Lemma rate_eq f s u v : has_rate f s u -> u = v -> has_rate f s v.
Proof. intros; subst; assumption. Qed.

Lemma derive_eq (f : R -> R) (s k l : R) : is_derive f s k -> k = l -> is_derive f s l.
Proof. intros; subst; assumption. Qed.

Lemma derive_add (f g : R -> R) (s k l : R) :
  is_derive f s k -> is_derive g s l -> is_derive (fun t => f t + g t) s (k + l).
Proof. intros; apply (is_derive_plus f g); assumption. Qed.

Lemma derive_sub (f g : R -> R) (s k l : R) :
  is_derive f s k -> is_derive g s l -> is_derive (fun t => f t - g t) s (k - l).
Proof. intros; apply (is_derive_minus f g); assumption. Qed.

Lemma derive_mul (f g : R -> R) (s k l : R) :
  is_derive f s k -> is_derive g s l -> is_derive (fun t => f t * g t) s (k * g s + f s * l).
Proof. intros; apply (is_derive_mult f g); auto; exact Rmult_comm. Qed.

Lemma derive_const (k s : R) : is_derive (fun _ : R => k) s 0.
Proof. apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule)). Qed.

Lemma derive_times (k : R) (f : R -> R) (s l : R) : is_derive f s l -> is_derive (fun t => k * f t) s (k * l).
Proof. intros; apply (is_derive_scal f); assumption. Qed.

Lemma rate_const v s : has_rate (fun _ => v) s zero.
Proof. components; apply derive_const. Qed.

Lemma rate_add f g s u v :
  has_rate f s u -> has_rate g s v -> has_rate (fun t => (f t + g t)%V) s (u + v).
Proof. intros (?&?&?) (?&?&?); components; apply derive_add; assumption. Qed.

Lemma rate_sub f g s u v :
  has_rate f s u -> has_rate g s v -> has_rate (fun t => (f t - g t)%V) s (u - v).
Proof. intros (?&?&?) (?&?&?); components; apply derive_sub; assumption. Qed.

Lemma rate_scale (k : R -> R) f s (l : R) v :
  is_derive k s l -> has_rate f s v -> has_rate (fun t => (k t * f t)%V) s (l * f s + k s * v).
Proof. intros ? (?&?&?); components; apply derive_mul; assumption. Qed.

Lemma rate_times k f s v : has_rate f s v -> has_rate (fun t => (k * f t)%V) s (k * v).
Proof. intros (?&?&?); components; apply derive_times; assumption. Qed.

Lemma derive_dot f g s u v :
  has_rate f s u -> has_rate g s v -> is_derive (fun t => f t · g t) s (u · g s + f s · v).
Proof.
  intros (?&?&?) (?&?&?).
  apply derive_eq with ((x u * x (g s) + x (f s) * x v) + (y u * y (g s) + y (f s) * y v)
    + (z u * z (g s) + z (f s) * z v)); [ | vec_ring ].
  unfold dot. apply derive_add; [ apply derive_add | ]; apply derive_mul; assumption.
Qed.

Lemma derive_sq f s u : has_rate f s u -> is_derive (fun t => f t · f t) s (2 * (f s · u)).
Proof. intros. eapply derive_eq. apply derive_dot; eassumption. vec_ring. Qed.

Lemma rate_cross f g s u v :
  has_rate f s u -> has_rate g s v -> has_rate (fun t => (f t × g t)%V) s (u × g s + f s × v).
Proof.
  intros (?&?&?) (?&?&?). components.
  - eapply derive_eq. apply derive_sub; apply derive_mul; eassumption. vec_ring.
  - eapply derive_eq. apply derive_sub; apply derive_mul; eassumption. vec_ring.
  - eapply derive_eq. apply derive_sub; apply derive_mul; eassumption. vec_ring.
Qed.

Lemma rate_const_cross w f s v : has_rate f s v -> has_rate (fun t => (w × f t)%V) s (w × v).
Proof.
  intros. eapply rate_eq. apply rate_cross. apply rate_const. eassumption. vec_ring.
Qed.

(** The same curve in another unit of time, counted from another moment. *)
Lemma derive_rescaled (f : R -> R) (t0 h s l : R) :
  is_derive f (t0 + h * s) l -> is_derive (fun u => f (t0 + h * u)) s (h * l).
Proof.
  intros Hf. apply (is_derive_comp f (fun u => t0 + h * u)); [ exact Hf | ].
  eapply derive_eq. apply derive_add. apply derive_const. apply derive_times. apply (is_derive_id (K := R_AbsRing)).
  unfold one; simpl; ring.
Qed.

Lemma rate_rescaled f t0 h s v :
  has_rate f (t0 + h * s) v -> has_rate (fun u => f (t0 + h * u)) s (h * v).
Proof.
  intros (A & B & C). components.
  - apply (derive_rescaled (fun t => x (f t))); assumption.
  - apply (derive_rescaled (fun t => y (f t))); assumption.
  - apply (derive_rescaled (fun t => z (f t))); assumption.
Qed.

(** ** The mean value *)

Lemma continuous_of_derive (f : R -> R) (s l : R) : is_derive f s l -> continuity_pt f s.
Proof.
  intros Hf. apply derivable_continuous_pt. exists l. now apply is_derive_Reals.
Qed.

Lemma mean_value (f f' : R -> R) a b :
  a < b -> (forall s, a <= s <= b -> is_derive f s (f' s)) ->
  exists m, a < m < b /\ f b - f a = f' m * (b - a).
Proof.
  intros a_b derivative.
  destruct (MVT_cor2 f f' a b a_b) as (m & value & m_in).
  - intros s s_in. apply is_derive_Reals. auto.
  - exists m; auto.
Qed.

Lemma rising (f f' : R -> R) a b :
  a <= b -> (forall s, a <= s <= b -> is_derive f s (f' s)) ->
  (forall s, a <= s <= b -> 0 <= f' s) -> f a <= f b.
Proof.
  intros a_b derivative sign. destruct (Req_dec a b) as [-> | different]; [ lra | ].
  destruct (mean_value f f' a b) as (m & m_in & value); [ lra | auto | ].
  assert (0 <= f' m * (b - a)) by (apply Rmult_le_pos; [ apply sign; lra | lra ]). lra.
Qed.

Lemma strictly_rising (f f' : R -> R) a b :
  a < b -> (forall s, a <= s <= b -> is_derive f s (f' s)) ->
  (forall s, a < s < b -> 0 < f' s) -> f a < f b.
Proof.
  intros a_b derivative sign.
  destruct (mean_value f f' a b) as (m & m_in & value); auto.
  assert (0 < f' m * (b - a)) by (apply Rmult_lt_0_compat; [ apply sign; lra | lra ]). lra.
Qed.

Lemma falling (f f' : R -> R) a b :
  a <= b -> (forall s, a <= s <= b -> is_derive f s (f' s)) ->
  (forall s, a <= s <= b -> f' s <= 0) -> f b <= f a.
Proof.
  intros a_b derivative sign.
  assert (- f a <= - f b); [ | lra ].
  apply (rising (fun s => - f s) (fun s => - f' s) a b); auto.
  - intros s s_in. apply (is_derive_opp f). auto.
  - intros s s_in. specialize (sign s s_in). lra.
Qed.

Lemma constant (f : R -> R) a b :
  (forall s, a <= s <= b -> is_derive f s 0) ->
  forall s t, a <= s <= b -> a <= t <= b -> f s = f t.
Proof.
  intros derivative.
  assert (ordered : forall s t, a <= s <= b -> a <= t <= b -> s <= t -> f s = f t).
  { intros s t s_in t_in s_t. apply Rle_antisym.
    - apply (rising f (fun _ => 0)); auto; [ intros; apply derivative; lra | intros; lra ].
    - apply (falling f (fun _ => 0)); auto; [ intros; apply derivative; lra | intros; lra ]. }
  intros s t s_in t_in. destruct (Rle_dec s t); [ auto | symmetry; apply ordered; auto; lra ].
Qed.

(** ** The exponential function *)

Lemma derive_exp_at (k t0 s : R) : is_derive (fun t => exp (k * (t - t0))) s (k * exp (k * (s - t0))).
Proof.
  apply (is_derive_comp exp (fun t => k * (t - t0))); [ apply is_derive_exp | ].
  apply derive_eq with (k * (1 - 0)); [ | ring ].
  apply derive_times, derive_sub; [ apply (is_derive_id (K := R_AbsRing)) | apply derive_const ].
Qed.

Lemma exp_le s t : s <= t -> exp s <= exp t.
Proof. intros [less | ->]; [ left; apply exp_increasing; assumption | lra ]. Qed.
