(** Section 4 of THEOREM.md, "From step to step": Theorem C, its rate and (4.8) together, as a proof uses them. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect Section3_TheoremN Section4_TheoremC.
Open Scope R_scope.

(** A motion on a part of its time. *)
Lemma motion_part Ω c γ r H a b a1 b1 :
  motion Ω c γ r H a b -> a <= a1 -> a1 <= b1 -> b1 <= b -> motion Ω c γ r H a1 b1.
Proof.
  intros is_motion low ordered high. constructor.
  - intros s s_in. apply (motion_r _ _ _ _ _ _ _ is_motion). lra.
  - intros s s_in. apply (motion_H _ _ _ _ _ _ _ is_motion). lra.
  - exists a1. split; [ lra | split ].
    + apply (on_sphere _ _ _ _ _ _ _ is_motion). lra.
    + apply (H_orthogonal _ _ _ _ _ _ _ is_motion). lra.
Qed.

(** ē grows with η(a). *)
Lemma e_bar_grows Ω c γ w P K_sup D1 D2 ℓ η1 η2 :
  0 < w -> 0 <= K_sup -> η1 <= η2 ->
  e_bar Ω c γ w P K_sup D1 D2 ℓ η1 <= e_bar Ω c γ w P K_sup D1 D2 ℓ η2.
Proof.
  intros w_pos K_nonneg η_le. apply Rmult_le_compat_l; [ left; apply exp_pos | ].
  apply Rplus_le_compat_r, Rmult_le_compat_r; [ | assumption ].
  assert (0 <= K_sup / w) by (apply Rmult_le_pos; [ | left; apply Rinv_0_lt_compat ]; lra). lra.
Qed.

Section OneStep.
(** The motion in physical time, from the release on, with J(0) ≤ J0. *)
Variables (Ω c : vec) (γ : R) (r H : R -> vec) (t_start t_end J0 w0 : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis w0_pos : 0 < w0.
Hypothesis is_motion : motion Ω c γ r H t_start t_end.
Hypothesis J_start : energy Ω c (r t_start) (H t_start) <= J0.

(** A step: t = centre + h s, a <= s <= b, the constants scaled, and the polynomials with their sizes. *)
Variables (centre h a b : R) (p p' p'' : R -> vec) (P K_sup T D1 D2 : R).
Hypothesis h_pos : 0 < h.
Hypothesis ordered : a <= b.
Hypothesis inside : t_start <= centre + h * a /\ centre + h * b <= t_end.
Let Ω_h := (h * Ω)%V.
Let c_h := ((h * h)%R * c)%V.
Let γ_h := h * γ.
Let w := h * w0.
Let Kp s := K Ω_h (p s) (p' s).
Hypothesis p_rate : forall s, a <= s <= b -> has_rate p s (p' s).
Hypothesis p'_rate : forall s, a <= s <= b -> has_rate p' s (p'' s).
Hypothesis P_bound : forall s, a <= s <= b -> `|p s| <= P.
Hypothesis K_bound : forall s, a <= s <= b -> `|Kp s| <= K_sup.
Hypothesis T_bound : forall s, a <= s <= b -> Rabs (τ (p s)) <= T.
Hypothesis D1_bound : forall s, a <= s <= b -> `|d1 Ω_h (p s) (p' s) (Kp s)| <= D1.
Hypothesis D2_bound : forall s, a <= s <= b ->
  `|d2 Ω_h c_h γ_h (p s) (Kp s) (K' Ω_h (p s) (p' s) (p'' s))| <= D2.

(** K in physical time, and η of a pair (p, K) there. *)
Definition K_physical s : vec := / h * Kp s.
Definition η_physical t (position momentum : vec) : R := η w0 (r t) (H t - momentum) (r t - position).

(** The radius at the end of the step before, and the jumps. *)
Variables (p_old K_old : vec) (η_old p_jump K_jump : R).
Hypothesis η_old_bound : η_physical (centre + h * a) p_old K_old <= η_old.
Hypothesis p_jump_bound : `|p a - p_old| <= p_jump.
Hypothesis K_jump_bound : `|K_physical a - K_old| <= K_jump.

(** What is computed. *)
Definition η_start := η_old + p_jump + K_jump / w0.                                              (* (4.8) *)
Definition ē_step := e_bar Ω_h c_h γ_h w P K_sup D1 D2 (b - a) η_start.                          (* (4.1) *)
Definition μ_step := μ Ω_h c_h γ_h w P K_sup (S_of Ω_h c_h (h ^ 2 * J0))
  (lambda_minus Ω_h w (h ^ 2 * J0)) (lambda_plus c_h w) ē_step.                                  (* (4.3), (4.5) to (4.7) *)
Definition η_new := (η_start + (b - a) * source c_h w K_sup T D1 D2) * exp ((b - a) * μ_step).   (* (4.2), (4.4) *)

Let r_h s := r (centre + h * s).
Let H_h s := (h * H (centre + h * s)%R)%V.

Let scaled : motion Ω_h c_h γ_h r_h H_h a b.
Proof.
  apply scaled_time; [ assumption | ].
  apply (motion_part Ω c γ r H t_start t_end); try assumption; try apply inside.
  apply Rplus_le_compat_l, Rmult_le_compat_l; lra.
Qed.

(** η in the time of the step is that in physical time. *)
Lemma η_of_step s : η w (r_h s) (H_h s - Kp s) (r_h s - p s) = η_physical (centre + h * s) (p s) (K_physical s).
Proof.
  unfold η_physical, K_physical. rewrite <- (η_scaled h w0) by assumption. f_equal.
  unfold H_h. generalize (H (centre + h * s)) (Kp s). intros u v. apply vec_ext; unfold_vec; field; lra.
Qed.

Let energy_at_a : energy Ω_h c_h (r_h a) (H_h a) <= h ^ 2 * J0.
Proof.
  unfold Ω_h, c_h, H_h. rewrite energy_scaled. apply Rmult_le_compat_l; [ apply pow2_ge_0 | ].
  apply (energy_bound Ω c γ r H t_start t_end J0); try assumption.
  assert (h * a <= h * b) by (apply Rmult_le_compat_l; lra). unfold r_h. lra.
Qed.

Theorem one_step : forall s, a <= s <= b ->
  let t := centre + h * s in
  η_physical t (p s) (K_physical s) <= η_new
  /\ `|r t - p s| <= η_new
  /\ `|h * H t - Kp s| <= (w + K_sup) * η_new.                                                    (* (4.9) *)
Proof.
  intros s s_in t.
  assert (a_in : a <= a <= b) by lra.
  assert (w_pos : 0 < w) by (apply Rmult_lt_0_compat; assumption).
  assert (γ_h_nonneg : 0 <= γ_h) by (apply Rmult_le_pos; lra).
  assert (K_nonneg := Rle_trans _ _ _ (norm_nonneg _) (K_bound a a_in)).
  assert (start : η w (r_h a) (H_h a - Kp a) (r_h a - p a) <= η_start).
  { rewrite η_of_step. unfold η_physical, η_start.
    assert (unit : r (centre + h * a) · r (centre + h * a) = 1) by (apply (on_sphere _ _ _ _ _ _ _ scaled a a_in)).
    apply Rle_trans with (1 := equation_4_8 w0 _ _ p_old K_old _ _ w0_pos unit).
    assert (K_jump / w0 >= `|K_physical a - K_old| / w0).
    { apply Rle_ge, Rmult_le_compat_r; [ left; apply Rinv_0_lt_compat; assumption | assumption ]. }
    unfold η_physical in η_old_bound. lra. }
  destruct (theorem_C Ω_h c_h γ_h r_h H_h a b p p' p'' w P K_sup T D1 D2 (S_of Ω_h c_h (h ^ 2 * J0))
    (lambda_minus Ω_h w (h ^ 2 * J0)) (lambda_plus c_h w)) with (s := s) as [near radius]; try assumption.
  - apply (equation_4_7 Ω_h c_h γ_h r_h H_h a b); assumption.
  - apply (equation_4_5 Ω_h c_h γ_h r_h H_h a b); assumption.
  - apply (equation_4_6 Ω_h c_h γ_h r_h H_h a b); assumption.
  - fold (Kp a) (Kp s) in near, radius.
    set (η_a := η w (r_h a) (H_h a - Kp a) (r_h a - p a)) in *.
    set (ē := e_bar Ω_h c_h γ_h w P K_sup D1 D2 (b - a) η_a) in *.
    assert (ē_nonneg : 0 <= ē) by (apply Rle_trans with (1 := norm_nonneg _) (2 := near)).
    assert (ē_le : ē <= ē_step) by (apply e_bar_grows; assumption).
    assert (S_nonneg : 0 <= S_of Ω_h c_h (h ^ 2 * J0))
      by (apply Rplus_le_le_0_compat; [ apply norm_nonneg | apply sqrt_pos ]).
    assert (rate : μ Ω_h c_h γ_h w P K_sup (S_of Ω_h c_h (h ^ 2 * J0)) (lambda_minus Ω_h w (h ^ 2 * J0))
      (lambda_plus c_h w) ē <= μ_step) by (apply μ_grows; auto).
    assert (source_nonneg : 0 <= source c_h w K_sup T D1 D2).
    { assert (T_0 := Rle_trans _ _ _ (Rabs_pos _) (T_bound a a_in)).
      assert (D1_0 := Rle_trans _ _ _ (norm_nonneg _) (D1_bound a a_in)).
      assert (D2_0 := Rle_trans _ _ _ (norm_nonneg _) (D2_bound a a_in)).
      assert (c_0 := norm_nonneg c_h). assert (K_sq := pow2_ge_0 K_sup).
      assert (inverse : 0 < / w) by (apply Rinv_0_lt_compat; assumption).
      assert (inverse2 : 0 < / (2 * w)) by (apply Rinv_0_lt_compat; lra).
      unfold source, Rdiv. assert (0 <= D2 * / w) by (apply Rmult_le_pos; lra).
      assert (0 <= (`|c_h| + K_sup ^ 2) * T * / (2 * w)) by (apply Rmult_le_pos; [ apply Rmult_le_pos | ]; lra).
      lra. }
    assert (η_a_nonneg : 0 <= η_a).
    { apply Rmult_le_pos; [ apply sqrt_pos | left; apply Rinv_0_lt_compat; assumption ]. }
    assert (length_source : 0 <= (b - a) * source c_h w K_sup T D1 D2) by (apply Rmult_le_pos; lra).
    assert (grown : η w (r_h s) (H_h s - Kp s) (r_h s - p s) <= η_new).
    { apply Rle_trans with (1 := radius). apply Rmult_le_compat.
      - lra.
      - left; apply exp_pos.
      - lra.
      - apply exp_le, Rmult_le_compat_l; lra. }
    unfold t. split; [ rewrite <- η_of_step; exact grown | split ].
    + apply Rle_trans with (2 := grown). apply (e_le_η w (r_h s) (H_h s - Kp s) (r_h s - p s)). assumption.
    + apply Rle_trans with ((w + K_sup) * η w (r_h s) (H_h s - Kp s) (r_h s - p s)).
      * apply (g_le_η Ω_h (r_h s) (H_h s) (p s) (p' s)); try assumption.
        -- apply (on_sphere _ _ _ _ _ _ _ scaled). assumption.
        -- apply (H_orthogonal _ _ _ _ _ _ _ scaled). assumption.
        -- apply (K_bound s s_in).
      * apply Rmult_le_compat_l; [ lra | exact grown ].
Qed.

End OneStep.
