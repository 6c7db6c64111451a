(** Section 7 of THEOREM.md: velocity and acceleration, from |e| ≤ η and |g| ≤ Γ. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect Section6_Sizes.
Open Scope R_scope.

(** v = r' and r'' of the motion. *)
Definition v (Ω r H : vec) : vec := r_rate Ω r H.
Definition r'' (Ω c : vec) (γ : R) (r H : vec) : vec := H_rate Ω c γ r H × r + (H - Ω) × v Ω r H.

Lemma v_rate Ω c γ r H a b s :
  motion Ω c γ r H a b -> a <= s <= b ->
  has_rate (fun t => v Ω (r t) (H t)) s (r'' Ω c γ (r s) (H s)).
Proof.
  intros [r_eq H_eq _] s_in. eapply rate_eq.
  - apply (rate_cross (fun t => (H t - Ω)%V)); [ apply rate_sub; [ apply H_eq; assumption | apply rate_const ] | apply r_eq; assumption ].
  - unfold r'', v. f_equal. f_equal. vec_ring.
Qed.

Section Tube.
(** At one time; K is any curve with the defects d1, d2 of (p, K). *)
Variables (Ω c : vec) (γ : R) (r H p p' p'' K K' : vec) (η Γ P K_sup D1 D2 D1' : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis unit : r · r = 1.
Hypothesis η_bound : `|r - p| <= η.
Hypothesis Γ_bound : `|H - K| <= Γ.
Hypothesis P_bound : `|p| <= P.
Hypothesis K_bound : `|K| <= K_sup.
Hypothesis D1_bound : `|d1 Ω p p' K| <= D1.
Hypothesis D2_bound : `|d2 Ω c γ p K K'| <= D2.
Hypothesis D1'_bound : `|d1' Ω p p' p'' K K'| <= D1'.

Definition U : R := Γ + (K_sup + `|Ω|) * η + D1.
Definition Γ1 : R := `|c| * η + `|Ω| * Γ + γ * (Γ + `|Ω| * (1 + P) * η) + D2.
Definition K1 : R := P * `|c| + K_sup * `|Ω| + γ * (K_sup + `|Ω| * (1 + P ^ 2)) + D2.
Definition A : R :=
  Γ1 + K1 * η + Γ * ((K_sup + `|Ω|) * P + D1 + U) + (K_sup + `|Ω|) * U + D1'.

Let r_size : `|r| <= 1. Proof. rewrite norm_unit; auto; lra. Qed.
Let K_Ω_size : `|K - Ω| <= K_sup + `|Ω|. Proof. apply norm_sub_le; lra. Qed.

(** v − p' = e'. *)
Theorem equation_7_1 : `|v Ω r H - p'| <= U.
Proof.
  unfold v. rewrite (lemma_1_e Ω r H p p' K). unfold e_rate, U.
  apply norm_sub_le; [ | assumption ].
  apply norm_add_le.
  - replace Γ with (Γ * 1) by ring. apply norm_cross_le; assumption.
  - apply norm_cross_le; assumption.
Qed.

(** g' = H' − K'. *)
Theorem equation_7_2 : `|H_rate Ω c γ r H - K'| <= Γ1.
Proof.
  rewrite (lemma_1_g Ω c γ r H p K K'). unfold g_rate, Γ1.
  apply norm_sub_le; [ | assumption ].
  apply norm_add_le; [ apply norm_add_le | ].
  - rewrite (Rmult_comm (`|c|)). apply norm_cross_le; [ assumption | lra ].
  - rewrite (Rmult_comm (`|Ω|)). apply norm_cross_le; [ assumption | lra ].
  - unfold X. apply norm_scale_le; [ rewrite Rabs_Ropp, Rabs_pos_eq; lra | ].
    replace (Γ + `|Ω| * (1 + P) * η) with (Γ + `|Ω| * η * 1 + `|Ω| * P * η) by ring.
    apply norm_add_le; [ apply norm_add_le; [ assumption | ] | ]; apply norm_scale_le; try assumption;
      apply dot_abs_le; (assumption || lra).
Qed.

(** K' = d2 + p × c + K × Ω − γ (K − Ω + (Ω·p) p). *)
Theorem equation_7_3 : `|K'| <= K1.
Proof.
  replace K' with (p × c + K × Ω - γ * (K - Ω + (Ω · p) * p) + d2 Ω c γ p K K')%V by (unfold d2; vec_ring).
  unfold K1. apply norm_add_le; [ | assumption ].
  apply norm_sub_le; [ apply norm_add_le | ].
  - apply norm_cross_le; [ assumption | lra ].
  - apply norm_cross_le; [ assumption | lra ].
  - apply norm_scale_le; [ rewrite Rabs_pos_eq; lra | ].
    replace (K_sup + `|Ω| * (1 + P ^ 2)) with (K_sup + `|Ω| + `|Ω| * P * P) by ring.
    apply norm_add_le; [ assumption | ]. apply norm_scale_le; [ apply dot_abs_le; (assumption || lra) | assumption ].
Qed.

(** |p'| ≤ (K + |Ω|) P + D1, so that |v| ≤ |p'| + U. *)
Lemma v_size : `|v Ω r H| <= (K_sup + `|Ω|) * P + D1 + U.
Proof.
  replace (v Ω r H) with (((K - Ω) × p + d1 Ω p p' K) + (v Ω r H - p'))%V by (unfold d1; vec_ring).
  apply norm_add_le; [ apply norm_add_le; [ apply norm_cross_le | ] | apply equation_7_1 ]; assumption.
Qed.

(** r'' − p'' = (H' − K') × r + K' × e + g × v + (K − Ω) × (v − p') − d1'. *)
Theorem equation_7_4 : `|r'' Ω c γ r H - p''| <= A.
Proof.
  assert (parts : (r'' Ω c γ r H - p'' =
    (H_rate Ω c γ r H - K') × r + K' × (r - p) + (H - K) × v Ω r H + (K - Ω) × (v Ω r H - p')
    - d1' Ω p p' p'' K K')%V).
  { unfold r'', d1'. generalize (H_rate Ω c γ r H) (v Ω r H). vec_ring. }
  rewrite parts. unfold A.
  apply norm_sub_le; [ | assumption ].
  apply norm_add_le; [ apply norm_add_le; [ apply norm_add_le | ] | ].
  - replace Γ1 with (Γ1 * 1) by ring. apply norm_cross_le; [ apply equation_7_2 | assumption ].
  - apply norm_cross_le; [ apply equation_7_3 | assumption ].
  - apply norm_cross_le; [ assumption | apply v_size ].
  - apply norm_cross_le; [ assumption | apply equation_7_1 ].
Qed.

End Tube.
