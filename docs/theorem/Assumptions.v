(** What each main theorem rests on: the axioms of Coq's real numbers, functional extensionality, classical logic. *)

From Foucault Require Import Section1_System Section2_ErrorAndDefect Section3_TheoremN.
From Foucault Require Import Section4_TheoremC Section4_Steps Section6_Sizes Section7_Tube Section8_Transits Section13_Sections.

Print Assumptions newton.
Print Assumptions energy_falls.
Print Assumptions lemma_0_d2.
Print Assumptions lemma_1_g.
Print Assumptions lemma_2.
Print Assumptions theorem_N.
Print Assumptions theorem_C.
Print Assumptions equation_4_5.
Print Assumptions equation_4_6.
Print Assumptions equation_4_7.
Print Assumptions equation_4_8.
Print Assumptions one_step.
Print Assumptions equation_6_8.
Print Assumptions equation_7_4.
Print Assumptions equation_8_6.
Print Assumptions none_is_missed.
Print Assumptions chain_counted.
Print Assumptions equation_8_10.
Print Assumptions lemma_13_4_b.
