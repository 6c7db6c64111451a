(** What each theorem of the table in THEOREM.md, section 15, rests on. Allowed are the axioms of Coq's real numbers,
    classical logic and functional extensionality. *)

From Foucault Require Import Section1_System Section2_ErrorAndDefect Section3_TheoremN Section4_TheoremC.
From Foucault Require Import Section4_Steps Section6_Sizes Section7_Tube Section8_Transits Section10_Rounding Section13_Sections.

Print Assumptions first_equation.
Print Assumptions second_equation.
Print Assumptions newton.
Print Assumptions on_sphere.
Print Assumptions H_orthogonal.
Print Assumptions energy_rate.
Print Assumptions energy_falls.
Print Assumptions scaled_time.
Print Assumptions lemma_0_d1.
Print Assumptions lemma_0_d2.
Print Assumptions lemma_0_Kp.
Print Assumptions lemma_1_e.
Print Assumptions lemma_1_g.
Print Assumptions lemma_1_p.
Print Assumptions lemma_1_rg.
Print Assumptions lemma_2.
Print Assumptions theorem_N.
Print Assumptions equation_2.
Print Assumptions theorem_C.
Print Assumptions g_le_η.
Print Assumptions equation_4_5.
Print Assumptions equation_4_6.
Print Assumptions equation_4_7.
Print Assumptions equation_4_8.
Print Assumptions one_step.
Print Assumptions derivative_le.
Print Assumptions equation_6_1.
Print Assumptions equation_6_2.
Print Assumptions equation_6_3.
Print Assumptions equation_6_4.
Print Assumptions equation_6_5.
Print Assumptions equation_6_6.
Print Assumptions equation_6_7.
Print Assumptions equation_6_8.
Print Assumptions equation_7_1.
Print Assumptions equation_7_2.
Print Assumptions equation_7_3.
Print Assumptions equation_7_4.
Print Assumptions equation_8_1.
Print Assumptions equation_8_2.
Print Assumptions equation_8_5.
Print Assumptions equation_8_6.
Print Assumptions equation_8_8_before.
Print Assumptions equation_8_8_after.
Print Assumptions equation_8_9.
Print Assumptions equation_8_10.
Print Assumptions none_is_missed.
Print Assumptions cluster_is_monotone.
Print Assumptions chain_none_missed.
Print Assumptions chain_counted.
Print Assumptions lemma_10_2_inside.
Print Assumptions lemma_10_2_near.
Print Assumptions lemma_10_2.
Print Assumptions lemma_13_1_a.
Print Assumptions lemma_13_1_b.
Print Assumptions lemma_13_2.
Print Assumptions lemma_13_4_a.
Print Assumptions lemma_13_4_b.
