(** Section 13 of THEOREM.md: Lemma 13.1 (the form and its rate), Lemma 13.2 (t = 0) and Lemma 13.4 (highest and lowest
    points of a box). The rounding of the form (13.1c, d) and the words are not here. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section7_Tube Section8_Transits.
Open Scope R_scope.

(** ** Lemma 13.1

    hF = ha·r + b·v − hd on the motion, f = ha·p + b·p' − hd on the polynomials; their rates. *)
Definition form (h : R) (a b : vec) (d : R) (r v : vec) : R := (h * a) · r + b · v - h * d.
Definition form' (h : R) (a b : vec) (v r'' : vec) : R := (h * a) · v + b · r''.

Lemma form_rate h a b d r v r'' s :
  has_rate r s (v s) -> has_rate v s (r'' s) ->
  is_derive (fun t => form h a b d (r t) (v t)) s (form' h a b (v s) (r'' s)).
Proof.
  intros. unfold form, form'. eapply derive_eq.
  - apply derive_sub; [ apply derive_add | apply derive_const ];
      (apply derive_dot; [ apply rate_const | eassumption ]).
  - vec_ring.
Qed.

Section Form.
Variables (h d η U A : R) (a b r v r'' p p' p'' : vec).
Hypothesis h_pos : 0 < h.
Hypothesis η_bound : `|r - p| <= η.
Hypothesis U_bound : `|v - p'| <= U.
Hypothesis A_bound : `|r'' - p''| <= A.

Theorem lemma_13_1_a : Rabs (form h a b d r v - form h a b d p p') <= h * `|a| * η + `|b| * U.
Proof.
  replace (form h a b d r v - form h a b d p p') with ((h * a) · (r - p) + b · (v - p'))
    by (unfold form; vec_ring).
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat; apply dot_abs_le; try assumption; try lra.
  rewrite norm_scale, Rabs_pos_eq; lra.
Qed.

Theorem lemma_13_1_b : Rabs (form' h a b v r'' - form' h a b p' p'') <= h * `|a| * U + `|b| * A.
Proof.
  replace (form' h a b v r'' - form' h a b p' p'') with ((h * a) · (v - p') + b · (r'' - p''))
    by (unfold form'; vec_ring).
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat; apply dot_abs_le; try assumption; try lra.
  rewrite norm_scale, Rabs_pos_eq; lra.
Qed.

End Form.

(** ** Lemma 13.2: if F(0) = 0 exactly, then on a first leaf (0, δ] on which F' has a sign, F has the same one. *)
Theorem lemma_13_2 (F F' : R -> R) δ σ :
  (forall t, 0 <= t <= δ -> is_derive F t (F' t)) -> F 0 = 0 ->
  (forall t, 0 < t <= δ -> 0 < σ * F' t) -> forall t, 0 < t <= δ -> 0 < σ * F t.
Proof.
  intros derivative at_0 sign t t_in.
  apply (equation_8_9 F F' 0 δ derivative σ at_0); [ intros; apply sign; lra | assumption ].
Qed.

(** ** Lemma 13.4

    With e = r − p, f = v − p', g = r'' − p'': if b·p ≠ 0,

      |b·f| ≤ |b| (|b × p| U + |b| (η (|p'| + U) + |p·p'|)) / |b·p|,                                  (13.4a)
      |b·g| ≤ |b| (|b × p| A + |b| (η (|p''| + A) + U (2|p'| + U) + |(p·p')'|)) / |b·p|.               (13.4b) *)
Section Apsis.
Variables (η U A : R) (b r v r'' p p' p'' : vec).
Hypothesis η_bound : `|r - p| <= η.
Hypothesis U_bound : `|v - p'| <= U.
Hypothesis A_bound : `|r'' - p''| <= A.
Hypothesis bp : b · p <> 0.

(** p·f = (b·p)(b·f)/|b|² + p⊥·f⊥, and |p⊥| = |b × p|/|b|. *)
Lemma along_and_across q size Q :
  `|q| <= size -> Rabs (p · q) <= Q -> Rabs (b · q) <= `|b| * (`|b × p| * size + `|b| * Q) / Rabs (b · p).
Proof.
  intros q_le pq_le.
  assert (b_nonneg := norm_nonneg b).
  assert (split : (b · p) * (b · q) = (b · b) * (p · q) - (b × p) · (b × q)) by vec_ring.
  assert (bp_pos := Rabs_pos_lt _ bp).
  apply Rmult_le_reg_l with (Rabs (b · p)); [ assumption | ].
  replace (Rabs (b · p) * (`|b| * (`|b × p| * size + `|b| * Q) / Rabs (b · p)))
    with (`|b| * `|b| * Q + `|b × p| * (`|b| * size)) by (field; lra).
  rewrite <- Rabs_mult, split. unfold Rminus.
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp, Rabs_mult.
  apply Rplus_le_compat.
  - rewrite (Rabs_pos_eq (b · b)) by apply dot_self_nonneg. rewrite norm_sq.
    apply Rmult_le_compat_l; [ apply dot_self_nonneg | assumption ].
  - apply dot_abs_le; [ lra | ]. apply norm_cross_le; [ lra | assumption ].
Qed.

(** 0 = r·v = p·p' + p·f + e·v. *)
Theorem lemma_13_4_a :
  r · v = 0 ->
  Rabs (b · (v - p'))
  <= `|b| * (`|b × p| * U + `|b| * (η * (`|p'| + U) + Rabs (p · p'))) / Rabs (b · p).
Proof.
  intros rv. apply along_and_across; [ assumption | ].
  replace (p · (v - p')) with (- (((r - p) · v) + p · p') + r · v) by vec_ring.
  rewrite rv, Rplus_0_r, Rabs_Ropp.
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat_r. apply dot_abs_le; [ assumption | ].
  replace v with (p' + (v - p'))%V at 1 by vec_ring. apply norm_add_le; lra.
Qed.

(** 0 = r·r'' + v·v = (p·p')' + p·g + e·r'' + f·(v + p'). *)
Theorem lemma_13_4_b :
  r · r'' + v · v = 0 ->
  Rabs (b · (r'' - p''))
  <= `|b| * (`|b × p| * A + `|b| * (η * (`|p''| + A) + U * (2 * `|p'| + U) + Rabs (p' · p' + p · p'')))
     / Rabs (b · p).
Proof.
  intros sphere. apply along_and_across; [ assumption | ].
  replace (p · (r'' - p''))
    with (- (((r - p) · r'') + ((v - p') · (v + p')) + (p' · p' + p · p'')) + (r · r'' + v · v)) by vec_ring.
  rewrite sphere, Rplus_0_r, Rabs_Ropp.
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat_r.
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat; apply dot_abs_le; try assumption.
  - replace r'' with (p'' + (r'' - p''))%V by vec_ring. apply norm_add_le; lra.
  - replace (v + p')%V with (2 * p' + (v - p'))%V by vec_ring.
    apply norm_add_le; [ apply norm_scale_le; [ rewrite Rabs_pos_eq; lra | lra ] | assumption ].
Qed.

End Apsis.

(** On the motion r·v = 0 and r·r'' + v·v = 0. *)
Lemma r_dot_v Ω r H : r · v Ω r H = 0.
Proof. unfold v, r_rate. vec_ring. Qed.

Lemma r_dot_r'' Ω c γ r H : r · r'' Ω c γ r H + v Ω r H · v Ω r H = 0.
Proof. unfold r'', v, r_rate. generalize (H_rate Ω c γ r H). vec_ring. Qed.
