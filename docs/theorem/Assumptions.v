(** What the theorems of the table in THEOREM.md, section 15, rest on. Allowed are the axioms of Coq's real numbers,
    classical logic and functional extensionality. *)

From Foucault Require Import Section1_System Section2_ErrorAndDefect Section3_TheoremN Section4_TheoremC Section4_Steps.
From Foucault Require Import Section5_TheoremE Section6_Sizes Section7_Tube Section8_Transits Section10_Rounding Section10_Clenshaw Section10_Sizes Section13_Sections.

(** The main theorems, one by one. *)
Print Assumptions newton.
Print Assumptions energy_falls.
Print Assumptions lemma_2.
Print Assumptions theorem_N.
Print Assumptions theorem_C.
Print Assumptions one_step.
Print Assumptions equation_5_4.
Print Assumptions equation_7_4.
Print Assumptions chain_counted.
Print Assumptions equation_8_10.
Print Assumptions lemma_10_2.
Print Assumptions equation_10_3c.
Print Assumptions lemma_13_4_b.

(** All of them together. *)
Definition every_theorem :=
  (@first_equation,
   @second_equation,
   @newton,
   @on_sphere,
   @H_orthogonal,
   @energy_rate,
   @energy_falls,
   @scaled_time,
   @kept_without_drag,
   @rest_is_a_motion,
   @circle_is_a_motion,
   @lemma_0_d1,
   @lemma_0_d2,
   @lemma_0_Kp,
   @lemma_1_e,
   @lemma_1_g,
   @lemma_1_p,
   @lemma_1_rg,
   @lemma_2,
   @theorem_N,
   @equation_2,
   @theorem_C,
   @g_le_η,
   @equation_4_5,
   @equation_4_6,
   @equation_4_7,
   @S_scaled,
   @lambda_minus_scaled,
   @lambda_plus_scaled,
   @equation_4_8,
   @one_step,
   @equation_5_1,
   @equation_5_2,
   @equation_5_3,
   @equation_5_4,
   @derivative_le,
   @equation_6_1,
   @equation_6_2,
   @equation_6_3,
   @equation_6_4,
   @equation_6_5,
   @equation_6_6,
   @equation_6_7,
   @equation_6_8,
   @equation_7_1,
   @equation_7_2,
   @equation_7_3,
   @equation_7_4,
   @equation_8_1,
   @equation_8_2,
   @equation_8_5,
   @equation_8_6,
   @equation_8_8_before,
   @equation_8_8_after,
   @equation_8_9,
   @equation_8_10,
   @none_is_missed,
   @cluster_is_monotone,
   @chain_none_missed,
   @chain_counted,
   @lemma_10_2_inside,
   @lemma_10_2_near,
   @lemma_10_2,
   @clenshaw_value,
   @clenshaw_rate,
   @value_is_off,
   @rate_is_off,
   @variable_is_off,
   @of_lines_are,
   @errors_le,
   @value_at_u,
   @equation_10_3c,
   @second_order_of_HALF,
   @lemma_13_1_a,
   @lemma_13_1_b,
   @lemma_13_2,
   @lemma_13_4_a,
   @lemma_13_4_b).
Print Assumptions every_theorem.
