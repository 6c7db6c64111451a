(** Section 1 of THEOREM.md: the system, what it keeps, the energy, scaled time. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves.
Open Scope R_scope.

(** The two right-hand sides of (1),

      r' = (H − Ω) × r,        H' = r × c + H × Ω − γ (H − Ω + (Ω·r) r). *)
Definition r_rate (Ω r H : vec) : vec := (H - Ω) × r.
Definition H_rate (Ω c : vec) (γ : R) (r H : vec) : vec :=
  r × c + H × Ω - γ * (H - Ω + (Ω · r) * r).

(** A motion on [a, b]: any differentiable solution of (1), with |r| = 1 and H·r = 0 at one time. That it exists
    for the times asked for is a premise of all that follows. *)
Record motion (Ω c : vec) (γ : R) (r H : R -> vec) (a b : R) : Prop := {
  motion_r : forall s, a <= s <= b -> has_rate r s (r_rate Ω (r s) (H s));
  motion_H : forall s, a <= s <= b -> has_rate H s (H_rate Ω c γ (r s) (H s));
  motion_at_one_time : exists s, a <= s <= b /\ r s · r s = 1 /\ H s · r s = 0
}.

(** ** Why (1) is the pendulum

    Newton's law in turning axes, r'' = F − λ r, with F = c − Ω × (Ω × r) − 2 Ω × v − γ v and the tension
    λ = |v|² + r·F that keeps |r| = 1. *)
Definition force (Ω c : vec) (γ : R) (r v : vec) : vec :=
  c - Ω × (Ω × r) - 2 * (Ω × v) - γ * v.
Definition tension (F r v : vec) : R := v · v + r · F.

(** H × r = v + Ω × r, because |r| = 1 and r·v = 0: the first equation of (1). *)
Lemma first_equation Ω r v :
  r · r = 1 -> r · v = 0 -> v = r_rate Ω r (r × (v + Ω × r)).
Proof.
  intros unit orthogonal.
  assert (expanded : r_rate Ω r (r × (v + Ω × r)) =
    ((r · r) * (v + Ω × r) - (r · v) * r - Ω × r)%V) by (unfold r_rate; vec_ring).
  rewrite expanded, unit, orthogonal. vec_ring.
Qed.

(** The second: H' = v × (v + Ω × r) + r × (r'' + Ω × v), with r'' by Newton's law. *)
Lemma second_equation Ω c γ r v λ :
  r · r = 1 -> r · v = 0 ->
  (v × (v + Ω × r) + r × ((force Ω c γ r v - λ * r) + Ω × v) = H_rate Ω c γ r (r × (v + Ω × r)))%V.
Proof.
  intros unit orthogonal.
  assert (drag : (r × v = r × (v + Ω × r) - Ω + (Ω · r) * r)%V).
  { replace (r × (v + Ω × r))%V with (r × v + (r · r) * Ω - (Ω · r) * r)%V by vec_ring.
    rewrite unit. vec_ring. }
  unfold H_rate, force. rewrite <- drag.
  replace ((r × (v + Ω × r)) × Ω)%V with ((r · Ω) * (v + Ω × r) - ((v + Ω × r) · Ω) * r)%V by vec_ring.
  replace (v × (v + Ω × r))%V with ((r · v) * Ω - (v · Ω) * r)%V by vec_ring.
  assert (torque : forall A B, (r × ((c - A - 2 * B - γ * v - λ * r) + B)
    = r × c - r × A - r × B - γ * (r × v))%V) by vec_ring.
  rewrite torque, (cross_cross r Ω (Ω × r)), (cross_cross r Ω v), dot_cross_self_r.
  rewrite orthogonal. vec_ring.
Qed.

(** Conversely (1) gives r'' = F − (v·v + r·F) r with every term: the left side is the derivative of (H − Ω) × r. *)
Lemma newton Ω c γ r H :
  r · r = 1 -> H · r = 0 ->
  let v := r_rate Ω r H in
  (H_rate Ω c γ r H × r + (H - Ω) × v = force Ω c γ r v - tension (force Ω c γ r v) r v * r)%V.
Proof.
  intros unit orthogonal v.
  assert (Hr : (H × r = v + Ω × r)%V) by (unfold v, r_rate; vec_ring).
  assert (H_is : (H = r × (v + Ω × r))%V).
  { rewrite <- Hr. replace (r × (H × r))%V with ((r · r) * H - (H · r) * r)%V by vec_ring.
    rewrite unit, orthogonal. vec_ring. }
  assert (rv : r · v = 0) by (unfold v, r_rate; vec_ring).
  assert (second := second_equation Ω c γ r v 0 unit rv).
  rewrite <- H_is in second. rewrite <- second.
  generalize (force Ω c γ r v). intros F. unfold tension. clear second. clearbody v.
  assert (rw : r · (v + Ω × r) = 0) by (rewrite dot_add_r, rv, dot_cross_self_r; ring).
  assert (parts : forall A B w, ((A + r × ((F - 0 * r) + B)) × r + (H - Ω) × w =
    (r · r) * (F + B) - (r · F + r · B) * r + A × r + H × w - Ω × w)%V) by vec_ring.
  rewrite parts.
  assert (Hv : (H × v = - ((v · v + (Ω × r) · v) * r))%V)
    by (rewrite H_is, cross_cross_l, rv; generalize (Ω × r)%V; vec_ring).
  rewrite Hv, cross_cross_l, (dot_comm v r), rv, (dot_comm (v + Ω × r)), rw, unit.
  replace (r · (Ω × v)) with (- ((Ω × r) · v)) by vec_ring.
  generalize (Ω × r)%V (Ω × v)%V. vec_ring.
Qed.

(** ** What is kept *)

Section Kept.
Variables (Ω c : vec) (γ : R) (r H : R -> vec) (a b : R).
Hypothesis is_motion : motion Ω c γ r H a b.

(** (r·r)' = 0. *)
Lemma on_sphere s : a <= s <= b -> r s · r s = 1.
Proof.
  destruct is_motion as [r_eq _ (s0 & s0_in & unit & _)]. intros s_in. rewrite <- unit.
  apply (constant (fun t => r t · r t) a b); auto.
  intros t t_in. eapply derive_eq. apply derive_sq. apply r_eq; auto. unfold r_rate. vec_ring.
Qed.

(** (H·r)' = −γ (H·r − Ω·r + (Ω·r)(r·r)) = −γ H·r. *)
Lemma Hr_rate t : a <= t <= b -> is_derive (fun t => H t · r t) t (- γ * (H t · r t)).
Proof.
  intros t_in. assert (unit := on_sphere t t_in). destruct is_motion as [r_eq H_eq _].
  eapply derive_eq. apply derive_dot; [ apply H_eq | apply r_eq ]; auto.
  transitivity (- γ * (H t · r t - Ω · r t + (Ω · r t) * (r t · r t))).
  - unfold r_rate, H_rate. vec_ring.
  - rewrite unit. ring.
Qed.

Lemma H_orthogonal s : a <= s <= b -> H s · r s = 0.
Proof.
  destruct is_motion as [_ _ (s0 & s0_in & _ & orthogonal)]. intros s_in.
  assert (kept : exp (γ * (s - a)) * (H s · r s) = exp (γ * (s0 - a)) * (H s0 · r s0)).
  { apply (constant (fun t => exp (γ * (t - a)) * (H t · r t)) a b); auto.
    intros t t_in. eapply derive_eq.
    apply derive_mul; [ apply derive_exp_at | apply Hr_rate; auto ]. simpl. ring. }
  rewrite orthogonal, Rmult_0_r in kept.
  assert (positive := exp_pos (γ * (s - a))).
  apply Rmult_integral in kept. destruct kept; lra.
Qed.

End Kept.

(** ** Energy

    J = ½|H|² − Ω·H − c·r (1.1). *)
Definition energy (Ω c r H : vec) : R := / 2 * (H · H) - Ω · H - c · r.

(** J' = (H − Ω)·H' − c·v = −γ |v|². *)
Lemma energy_rate Ω c γ r H :
  r · r = 1 -> H · r = 0 ->
  (H - Ω) · H_rate Ω c γ r H - c · r_rate Ω r H = - γ * (r_rate Ω r H · r_rate Ω r H).
Proof.
  intros unit orthogonal.
  assert (v_sq : r_rate Ω r H · r_rate Ω r H = (H - Ω) · (H - Ω) - (Ω · r) * (Ω · r)).
  { unfold r_rate. rewrite lagrange, unit.
    replace ((H - Ω) · r) with (H · r - Ω · r) by vec_ring. rewrite orthogonal. ring. }
  rewrite v_sq.
  assert (terms : forall k, (H - Ω) · (r × c + H × Ω - γ * (H - Ω + k * r)) - c · ((H - Ω) × r)
    = - γ * ((H - Ω) · (H - Ω) + k * (H · r - Ω · r))) by vec_ring.
  unfold r_rate, H_rate. rewrite terms, orthogonal. ring.
Qed.

(** J(t) ≤ J(a) for t ≥ a, with drag as well. *)
Lemma energy_falls Ω c γ r H a b :
  0 <= γ -> motion Ω c γ r H a b ->
  forall t, a <= t <= b -> energy Ω c (r t) (H t) <= energy Ω c (r a) (H a).
Proof.
  intros γ_nonneg is_motion t t_in.
  apply (falling (fun s => energy Ω c (r s) (H s))
    (fun s => - γ * (r_rate Ω (r s) (H s) · r_rate Ω (r s) (H s)))); [ lra | | ].
  - intros s s_in.
    assert (inside : a <= s <= b) by lra.
    rewrite <- (energy_rate Ω c γ (r s) (H s));
      [ | apply (on_sphere _ _ _ _ _ _ _ is_motion); auto | apply (H_orthogonal _ _ _ _ _ _ _ is_motion); auto ].
    destruct is_motion as [r_eq H_eq _].
    eapply derive_eq. unfold energy.
    apply derive_sub; [ apply derive_sub | ].
    + apply derive_times, derive_sq, H_eq; auto.
    + apply derive_dot; [ apply rate_const | apply H_eq; auto ].
    + apply derive_dot; [ apply rate_const | apply r_eq; auto ].
    + simpl. generalize (H_rate Ω c γ (r s) (H s)) (r_rate Ω (r s) (H s)). intros. unfold_vec. field.
  - intros s _. assert (sq := dot_self_nonneg (r_rate Ω (r s) (H s))). nra.
Qed.

(** ** Scaled time

    On a step s = (t − centre)/h; replace Ω, c, γ, H by hΩ, h²c, hγ, hH. The form stays. *)
Lemma scaled_time Ω c γ r H centre h a b :
  0 < h -> motion Ω c γ r H (centre + h * a) (centre + h * b) ->
  motion (h * Ω) (h * h * c) (h * γ) (fun s => r (centre + h * s)) (fun s => (h * H (centre + h * s)%R)%V) a b.
Proof.
  intros h_pos [r_eq H_eq (t0 & t0_in & unit & orthogonal)].
  assert (moved : forall s, a <= s <= b -> centre + h * a <= centre + h * s <= centre + h * b) by (intros; nra).
  constructor.
  - intros s s_in. eapply rate_eq. apply rate_rescaled, r_eq, moved, s_in. unfold r_rate. vec_ring.
  - intros s s_in. eapply rate_eq. apply (rate_times h), (rate_rescaled H), H_eq, moved, s_in. unfold H_rate. vec_ring.
  - exists ((t0 - centre) / h).
    assert (back : centre + h * ((t0 - centre) / h) = t0) by (field; lra).
    rewrite back. repeat split.
    + apply Rmult_le_reg_l with h; [ lra | ]. apply Rplus_le_reg_l with centre. rewrite back. lra.
    + apply Rmult_le_reg_l with h; [ lra | ]. apply Rplus_le_reg_l with centre. rewrite back. lra.
    + assumption.
    + rewrite dot_scale_l, orthogonal. ring.
Qed.

(** Without drag H·r is kept on the sphere or off it. *)
Lemma kept_without_drag Ω c r H : r_rate Ω r H · H + r · H_rate Ω c 0 r H = 0.
Proof. unfold r_rate, H_rate. vec_ring. Qed.

(** ** There are motions: no theorem about them is empty *)

(** At rest in unstable balance, on the axis of rotation. *)
Lemma rest_is_a_motion γ ω g a b :
  a <= b -> motion (mkvec 0 0 ω) (mkvec 0 0 g) γ (fun _ => mkvec 0 0 1) (fun _ => zero) a b.
Proof.
  intros ab. constructor.
  - intros. eapply rate_eq. apply rate_const. unfold r_rate. vec_ring.
  - intros. eapply rate_eq. apply rate_const. unfold H_rate. vec_ring.
  - exists a. repeat split; try lra; vec_ring.
Qed.

(** A great circle, without rotation, gravity and drag. *)
Lemma circle_is_a_motion ω a b :
  a <= b ->
  motion zero zero 0 (fun s => mkvec (cos (ω * s)) (sin (ω * s)) 0) (fun _ => mkvec 0 0 ω) a b.
Proof.
  intros ab. constructor.
  - intros. unfold r_rate. components; unfold zero; simpl; auto_derive; auto; ring.
  - intros. eapply rate_eq. apply rate_const. unfold H_rate. vec_ring.
  - exists a. split; [ lra | ]. split; unfold_vec.
    + assert (one := sin2_cos2 (ω * a)). unfold Rsqr in one. lra.
    + ring.
Qed.
