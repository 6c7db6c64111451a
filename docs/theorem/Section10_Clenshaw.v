(** Section 10 of THEOREM.md: of Lemma 10.3 (Clenshaw's sums) the exact part. What is computed is the exact sum for the
    coefficients c_k + δ_k, so that the value is off by Σ|δ_k| and the rate by Σ k|δ'_k|; and what û for u costs. The
    sizes of the δ_k are in Section10_Sizes; the bound (10.3d) of the rate is in neither. *)

From Coq Require Import Reals Lra Psatz List.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Curves.
Open Scope R_scope.
Import ListNotations.

(** ** Chebyshev's polynomials: T_k, and S_k = U_{k−1} *)

Fixpoint T (k : nat) (u : R) : R :=
  match k with 0 => 1 | S k' => match k' with 0 => u | S k'' => 2 * u * T k' u - T k'' u end end.
Fixpoint S_ (k : nat) (u : R) : R :=
  match k with 0 => 0 | S k' => match k' with 0 => 1 | S k'' => 2 * u * S_ k' u - S_ k'' u end end.

(** F_{k+2} = 2u F_{k+1} − F_k. *)
Definition recurrent (u : R) (F : nat -> R) : Prop := forall k, F (S (S k)) = 2 * u * F (S k) - F k.

Lemma T_recurrent u : recurrent u (fun k => T k u). Proof. intros k. reflexivity. Qed.
Lemma S_recurrent u : recurrent u (fun k => S_ k u). Proof. intros k. reflexivity. Qed.

(** T_{k+1} = u T_k − (1 − u²) S_k and S_{k+1} = u S_k + T_k. *)
Lemma next u k : T (S k) u = u * T k u - (1 - u ^ 2) * S_ k u /\ S_ (S k) u = u * S_ k u + T k u.
Proof.
  induction k as [ | k [T_next S_next]]; [ cbn [T S_]; split; ring | ].
  rewrite (T_recurrent u k), (S_recurrent u k), T_next, S_next. split; ring.
Qed.

(** T_k² + (1 − u²) S_k² = 1: for |u| ≤ 1 |T_k| ≤ 1, and so |S_k| ≤ k. *)
Lemma pell u k : (T k u) ^ 2 + (1 - u ^ 2) * (S_ k u) ^ 2 = 1.
Proof.
  induction k as [ | k IH]; [ cbn [T S_]; ring | ].
  destruct (next u k) as [-> ->].
  transitivity ((T k u) ^ 2 + (1 - u ^ 2) * (S_ k u) ^ 2); [ ring | exact IH ].
Qed.

Lemma T_le u k : Rabs u <= 1 -> Rabs (T k u) <= 1.
Proof.
  intros u_le. assert (P := pell u k).
  assert (u_sq : u ^ 2 <= 1) by (rewrite <- (pow2_abs u); assert (A := Rabs_pos u); nra).
  assert (0 <= (1 - u ^ 2) * (S_ k u) ^ 2) by (apply Rmult_le_pos; [ lra | apply pow2_ge_0 ]).
  rewrite <- Rabs_R1. apply Rsqr_le_abs_0. unfold Rsqr. lra.
Qed.

Lemma S_le u k : Rabs u <= 1 -> Rabs (S_ k u) <= INR k.
Proof.
  intros u_le. induction k as [ | k IH]; [ simpl; rewrite Rabs_R0; lra | ].
  destruct (next u k) as [_ ->]. rewrite S_INR.
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_mult.
  assert (Rabs u * Rabs (S_ k u) <= 1 * INR k) by (apply Rmult_le_compat; auto using Rabs_pos).
  assert (A := T_le u k u_le). lra.
Qed.

(** T_k' = k S_k, at most k² in size. *)
Lemma T_derivative k u :
  is_derive (T k) u (INR k * S_ k u) /\ is_derive (T (S k)) u (INR (S k) * S_ (S k) u).
Proof.
  induction k as [ | k [here there]].
  - split.
    + apply derive_eq with 0; [ apply (derive_const 1) | simpl; ring ].
    + apply derive_eq with 1; [ apply (is_derive_id (K := R_AbsRing)) | simpl; ring ].
  - split; [ exact there | ].
    apply (is_derive_ext (fun v => 2 * v * T (S k) v - T k v)); [ reflexivity | ].
    eapply derive_eq.
    + apply derive_sub; [ | exact here ].
      apply (derive_mul (fun v => 2 * v) (T (S k))); [ apply derive_times, (is_derive_id (K := R_AbsRing)) | exact there ].
    + destruct (next u k) as [T_next S_next]. rewrite (S_recurrent u k), !S_INR, T_next, S_next.
      unfold one. simpl. ring.
Qed.

Lemma T_moves k u v : Rabs u <= 1 -> Rabs v <= 1 -> Rabs (T k v - T k u) <= INR k ^ 2 * Rabs (v - u).
Proof.
  intros u_le v_le.
  assert (bound : forall s, Rabs s <= 1 -> Rabs (INR k * S_ k s) <= INR k ^ 2).
  { intros s s_le. rewrite Rabs_mult, Rabs_pos_eq by apply pos_INR.
    assert (A := S_le s k s_le). assert (B := pos_INR k). simpl. rewrite Rmult_1_r. apply Rmult_le_compat_l; assumption. }
  assert (between : forall s, Rmin u v <= s <= Rmax u v -> Rabs s <= 1).
  { intros s s_in. apply Rabs_le. apply Rabs_le_between in u_le, v_le.
    unfold Rmin, Rmax in s_in. destruct (Rle_dec u v); lra. }
  destruct (MVT_gen (T k) u v (fun s => INR k * S_ k s)) as (m & m_in & ->).
  - intros s _. apply T_derivative.
  - intros s _. apply (continuous_of_derive (T k) s (INR k * S_ k s)), T_derivative.
  - rewrite Rabs_mult. apply Rmult_le_compat_r; [ apply Rabs_pos | apply bound, between, m_in ].
Qed.

(** ** Clenshaw's sums, exactly *)

(** Σ c_j F_{k+j} over a list of coefficients. *)
Fixpoint series (F : nat -> R) (k : nat) (c : list R) : R :=
  match c with [] => 0 | c0 :: c => c0 * F k + series F (S k) c end.

(** b_k = (2u b_{k+1} − b_{k+2}) + c_k: the pair b_k, b_{k+1} of the coefficients from c_k on. *)
Fixpoint sums (u : R) (c : list R) : R * R :=
  match c with [] => (0, 0) | c0 :: c => let '(b1, b2) := sums u c in ((2 * u * b1 - b2) + c0, b1) end.

Lemma sums_are u F c k :
  recurrent u F -> series F (S k) c = fst (sums u c) * F (S k) - snd (sums u c) * F k.
Proof.
  intros F_recurrent. revert k. induction c as [ | c0 c IH]; intros k; simpl; [ ring | ].
  rewrite IH, F_recurrent. destruct (sums u c) as [b1 b2]. simpl. ring.
Qed.

(** value = (u b_1 − b_2) + c_0 = C(u). *)
Theorem clenshaw_value u c0 c :
  (u * fst (sums u c) - snd (sums u c)) + c0 = series (fun k => T k u) 0 (c0 :: c).
Proof.
  simpl. rewrite (sums_are u (fun k => T k u) c 0 (T_recurrent u)). simpl. ring.
Qed.

(** d_1, of the coefficients k c_k from k = 1 on, is Σ k c_k U_{k−1} = dC/du. *)
Theorem clenshaw_rate u kc : fst (sums u kc) = series (fun k => S_ k u) 1 kc.
Proof.
  rewrite (sums_are u (fun k => S_ k u) kc 0 (S_recurrent u)). simpl. ring.
Qed.

(** ** ... and rounded, with any function [rnd]; y = 2u is exact. *)
Section Rounded.
Variable rnd : R -> R.

Definition line (u b1 b2 c0 : R) : R := rnd (rnd (rnd (2 * u * b1) - b2) + c0).

Fixpoint rounded (u : R) (c : list R) : R * R :=
  match c with [] => (0, 0) | c0 :: c => let '(b1, b2) := rounded u c in (line u b1 b2 c0, b1) end.

(** δ_k, the error of the three operations of a line. *)
Fixpoint errors (u : R) (c : list R) : list R :=
  match c with
  | [] => []
  | c0 :: c => let '(b1, b2) := rounded u c in (line u b1 b2 c0 - ((2 * u * b1 - b2) + c0)) :: errors u c
  end.

Fixpoint added (c δ : list R) : list R :=
  match c, δ with c0 :: c, δ0 :: δ => (c0 + δ0) :: added c δ | _, _ => [] end.

(** What is computed is exact for the coefficients c_k + δ_k. *)
Theorem rounded_is_exact u c : rounded u c = sums u (added c (errors u c)).
Proof.
  induction c as [ | c0 c IH]; [ reflexivity | ].
  simpl. destruct (rounded u c) as [b1 b2]. simpl. rewrite <- IH. f_equal. ring.
Qed.

Lemma series_added F k c δ :
  length c = length δ -> series F k (added c δ) = series F k c + series F k δ.
Proof.
  revert k δ. induction c as [ | c0 c IH]; intros k [ | δ0 δ]; simpl; try discriminate; [ intros; ring | ].
  intros same. rewrite IH by congruence. ring.
Qed.

Lemma errors_length u c : length c = length (errors u c).
Proof. induction c as [ | c0 c IH]; simpl; [ reflexivity | ]. destruct (rounded u c). simpl. congruence. Qed.

(** Σ m_k |δ_k|, for sizes m_k of F_k. *)
Fixpoint weighted (m : nat -> R) (k : nat) (δ : list R) : R :=
  match δ with [] => 0 | δ0 :: δ => m k * Rabs δ0 + weighted m (S k) δ end.

Lemma series_le F m k δ : (forall j, Rabs (F j) <= m j) -> Rabs (series F k δ) <= weighted m k δ.
Proof.
  intros F_le. revert k. induction δ as [ | δ0 δ IH]; intros k; simpl; [ rewrite Rabs_R0; lra | ].
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat; [ | apply IH ].
  rewrite Rabs_mult, Rmult_comm. apply Rmult_le_compat_r; [ apply Rabs_pos | apply F_le ].
Qed.

(** The value is off from C(û) by at most Σ|δ_k|, δ_0 the error of the last line. *)
Theorem value_is_off u c0 c :
  Rabs u <= 1 ->
  let '(b1, b2) := rounded u c in
  let value := rnd (rnd (rnd (u * b1) - b2) + c0) in
  let δ0 := value - ((u * b1 - b2) + c0) in
  Rabs (value - series (fun k => T k u) 0 (c0 :: c)) <= weighted (fun _ => 1) 0 (δ0 :: errors u c).
Proof.
  intros u_le. destruct (rounded u c) as [b1 b2] eqn:computed. intros value δ0.
  assert (exact : value = series (fun k => T k u) 0 ((c0 + δ0) :: added c (errors u c))).
  { rewrite <- clenshaw_value, <- rounded_is_exact, computed. unfold δ0. simpl. ring. }
  change ((c0 + δ0) :: added c (errors u c)) with (added (c0 :: c) (δ0 :: errors u c)) in exact.
  rewrite series_added in exact by (simpl; rewrite <- errors_length; reflexivity).
  rewrite exact.
  replace (series (fun k => T k u) 0 (c0 :: c) + series (fun k => T k u) 0 (δ0 :: errors u c)
    - series (fun k => T k u) 0 (c0 :: c)) with (series (fun k => T k u) 0 (δ0 :: errors u c)) by ring.
  apply series_le. intros j. apply T_le. assumption.
Qed.

(** d_1 is off from dC/du at û by at most Σ k|δ'_k|, for the coefficients k c_k as they are rounded. *)
Theorem rate_is_off u kc :
  Rabs u <= 1 ->
  Rabs (fst (rounded u kc) - series (fun k => S_ k u) 1 kc) <= weighted INR 1 (errors u kc).
Proof.
  intros u_le. rewrite rounded_is_exact, clenshaw_rate, series_added by apply errors_length.
  replace (series (fun k => S_ k u) 1 kc + series (fun k => S_ k u) 1 (errors u kc) - series (fun k => S_ k u) 1 kc)
    with (series (fun k => S_ k u) 1 (errors u kc)) by ring.
  apply series_le. intros j. apply S_le. assumption.
Qed.

(** û for u costs |û − u| Σ k²|c_k|. *)
Theorem variable_is_off u v c k :
  Rabs u <= 1 -> Rabs v <= 1 ->
  Rabs (series (fun j => T j v) k c - series (fun j => T j u) k c)
  <= Rabs (v - u) * weighted (fun j => INR j ^ 2) k c.
Proof.
  intros u_le v_le. revert k. induction c as [ | c0 c IH]; intros k; simpl.
  - rewrite Rminus_0_r, Rabs_R0. lra.
  - replace (c0 * T k v + series (fun j => T j v) (S k) c - (c0 * T k u + series (fun j => T j u) (S k) c))
      with (c0 * (T k v - T k u) + (series (fun j => T j v) (S k) c - series (fun j => T j u) (S k) c)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _). specialize (IH (S k)). rewrite Rabs_mult.
    assert (A := T_moves k u v u_le v_le).
    assert (Rabs c0 * Rabs (T k v - T k u) <= Rabs c0 * (INR k ^ 2 * Rabs (v - u)))
      by (apply Rmult_le_compat_l; [ apply Rabs_pos | exact A ]).
    simpl in *. lra.
Qed.

End Rounded.
