(** Section 6 of THEOREM.md: computing the defect, the sizes (6.1) to (6.8). The sums of digits (6.9) to (6.17) are
    not here. *)

From Coq Require Import Reals Lra Psatz List.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect.
Open Scope R_scope.

(** ** Polynomials on |s| ≤ 1

    A list of coefficients c0, c1, ... *)
Fixpoint eval (c : list R) (s : R) : R :=
  match c with nil => 0 | c0 :: c => c0 + s * eval c s end.

(** The derivative, by Horner's rule: (c0 + s q)' = q + s q'. *)
Fixpoint eval' (c : list R) (s : R) : R :=
  match c with nil => 0 | _ :: c => eval c s + s * eval' c s end.

(** Σ|c_n|, and Σ n|c_n| where the first coefficient of the list has the number n. *)
Fixpoint sum_abs (c : list R) : R :=
  match c with nil => 0 | c0 :: c => Rabs c0 + sum_abs c end.
Fixpoint sum_n_abs (n : nat) (c : list R) : R :=
  match c with nil => 0 | c0 :: c => INR n * Rabs c0 + sum_n_abs (S n) c end.

Lemma eval_derivative c s : is_derive (eval c) s (eval' c s).
Proof.
  induction c as [ | c0 c IH]; simpl.
  - apply derive_const.
  - eapply derive_eq.
    + apply (derive_add (fun _ => c0)); [ apply derive_const | ].
      apply (derive_mul (fun t => t) (eval c)); [ apply (is_derive_id (K := R_AbsRing)) | exact IH ].
    + unfold one; simpl; ring.
Qed.

Lemma sum_abs_nonneg c : 0 <= sum_abs c.
Proof. induction c; simpl; [ lra | ]. assert (A := Rabs_pos a). lra. Qed.

Lemma eval_le c s : Rabs s <= 1 -> Rabs (eval c s) <= sum_abs c.
Proof.
  intros small. induction c as [ | c0 c IH]; simpl; [ rewrite Rabs_R0; lra | ].
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_mult.
  assert (Rabs s * Rabs (eval c s) <= 1 * sum_abs c) by (apply Rmult_le_compat; auto using Rabs_pos). lra.
Qed.

Lemma sum_n_abs_next n c : sum_n_abs (S n) c = sum_n_abs n c + sum_abs c.
Proof.
  revert n. induction c as [ | c0 c IH]; intros n; [ simpl; ring | ].
  change (INR (S n) * Rabs c0 + sum_n_abs (S (S n)) c = INR n * Rabs c0 + sum_n_abs (S n) c + (Rabs c0 + sum_abs c)).
  rewrite (IH (S n)), S_INR. ring.
Qed.

(** Σ n|c_n| bounds the derivative ... *)
Lemma eval'_le c s : Rabs s <= 1 -> Rabs (eval' c s) <= sum_n_abs 0 c.
Proof.
  intros small. induction c as [ | c0 c IH]; [ simpl; rewrite Rabs_R0; lra | ].
  change (Rabs (eval c s + s * eval' c s) <= INR 0 * Rabs c0 + sum_n_abs 1 c).
  rewrite sum_n_abs_next. apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_mult.
  assert (A := eval_le c s small).
  assert (Rabs s * Rabs (eval' c s) <= 1 * sum_n_abs 0 c) by (apply Rmult_le_compat; auto using Rabs_pos).
  simpl. lra.
Qed.

(** ... and is at most N Σ|c_n|, N the degree. *)
Lemma degree_le c n N :
  (n + length c <= S N)%nat -> sum_n_abs n c <= INR N * sum_abs c.
Proof.
  revert n. induction c as [ | c0 c IH]; intros n short; simpl in *; [ lra | ].
  assert (first : INR n * Rabs c0 <= INR N * Rabs c0)
    by (apply Rmult_le_compat_r; [ apply Rabs_pos | apply le_INR; lia ]).
  assert (others : sum_n_abs (S n) c <= INR N * sum_abs c) by (apply IH; lia).
  lra.
Qed.

Theorem derivative_le c N s :
  (length c <= S N)%nat -> Rabs s <= 1 -> Rabs (eval' c s) <= INR N * sum_abs c.
Proof.
  intros short small. apply Rle_trans with (1 := eval'_le c s small). apply degree_le. simpl. exact short.
Qed.

(** ** The constants *)

(** d = p'' + 2 Ω × p' + Ω × (Ω × p) + γ p' − c + λ p. *)
Lemma d_expanded Ω c γ λ p p' p'' :
  (d Ω c γ λ p p' p'' = p'' + 2 * (Ω × p') + Ω × (Ω × p) + γ * p' - c + λ * p)%V.
Proof. unfold d, V, V'. vec_ring. Qed.

(** Each constant is replaced by another one, ω² by one of its own; k is the direction of Ω. If these are off by ϑ in
    all, D gets ϑ (2 sup|p'| + P) more, as P ≥ 1 (6.1). *)
Definition d_computed (k c : vec) (ω ω_sq γ λ : R) (p p' p'' : vec) : vec :=
  p'' + (2 * ω) * (k × p') + ω_sq * (k × (k × p)) + γ * p' - c + λ * p.

Theorem equation_6_1 k c c_0 ω ω_0 ω_sq_0 γ γ_0 λ p p' p'' P p'_sup D ϑ :
  k · k = 1 -> 1 <= P -> `|p| <= P -> `|p'| <= p'_sup ->
  Rabs (ω - ω_0) + Rabs (ω ^ 2 - ω_sq_0) + Rabs (γ - γ_0) + `|c - c_0| <= ϑ ->
  `|d_computed k c_0 ω_0 ω_sq_0 γ_0 λ p p' p''| <= D ->
  `|d (ω * k) c γ λ p p' p''| <= D + ϑ * (2 * p'_sup + P).
Proof.
  intros unit P_one p_le p'_le ϑ_le D_le.
  replace (d (ω * k) c γ λ p p' p'') with
    (d_computed k c_0 ω_0 ω_sq_0 γ_0 λ p p' p''
      + ((ω - ω_0) * (2 * (k × p')) + (ω ^ 2 - ω_sq_0) * (k × (k × p)) + (γ - γ_0) * p' - (c - c_0)))%V
    by (rewrite d_expanded; unfold d_computed; vec_ring).
  assert (k_le : `|k| <= 1) by (rewrite norm_unit; auto; lra).
  assert (p'_nonneg := Rle_trans _ _ _ (norm_nonneg _) p'_le).
  assert (turned : `|2 * (k × p')| <= 2 * p'_sup).
  { apply norm_scale_le; [ rewrite Rabs_pos_eq; lra | ].
    replace p'_sup with (1 * p'_sup) by ring. apply norm_cross_le; assumption. }
  assert (twice : `|k × (k × p)| <= P).
  { replace P with (1 * (1 * P)) by ring. apply norm_cross_le; [ | apply norm_cross_le ]; assumption. }
  set (δω := Rabs (ω - ω_0)) in *. set (δω_sq := Rabs (ω ^ 2 - ω_sq_0)) in *. set (δγ := Rabs (γ - γ_0)) in *.
  set (δc := `|c - c_0|) in *.
  assert (δω_0 : 0 <= δω) by apply Rabs_pos. assert (δω_sq_0 : 0 <= δω_sq) by apply Rabs_pos.
  assert (δγ_0 : 0 <= δγ) by apply Rabs_pos. assert (δc_0 : 0 <= δc) by apply norm_nonneg.
  apply Rle_trans with (D + (δω * (2 * p'_sup) + δω_sq * P + δγ * p'_sup + δc)).
  - apply norm_add_le; [ assumption | ].
    apply norm_sub_le; [ | apply Rle_refl ].
    apply norm_add_le; [ apply norm_add_le | ]; apply norm_scale_le; assumption || apply Rle_refl.
  - assert (0 <= δγ * p'_sup) by (apply Rmult_le_pos; assumption).
    assert (0 <= (δω_sq + δc) * p'_sup) by (apply Rmult_le_pos; lra).
    assert (0 <= (δω + δγ) * P) by (apply Rmult_le_pos; lra).
    assert (0 <= δc * (P - 1)) by (apply Rmult_le_pos; lra).
    assert ((δω + δω_sq + δγ + δc) * (2 * p'_sup + P) <= ϑ * (2 * p'_sup + P))
      by (apply Rmult_le_compat_r; lra).
    lra.
Qed.

(** ** The sizes *)

(** The derivative of τ', and that of d1 for any p and K. *)
Definition τ'' (p p' p'' : vec) : R := 2 * (p' · p' + p · p'').
Definition d1' (Ω p p' p'' K K' : vec) : vec := p'' - (K' × p + (K - Ω) × p').

Lemma τ'_rate p p' p'' s :
  has_rate p s (p' s) -> has_rate p' s (p'' s) ->
  is_derive (fun t => τ' (p t) (p' t)) s (τ'' (p s) (p' s) (p'' s)).
Proof. intros. apply derive_times. apply derive_dot; assumption. Qed.

Lemma d1_rate Ω p p' p'' K K' s :
  has_rate p s (p' s) -> has_rate p' s (p'' s) -> has_rate K s (K' s) ->
  has_rate (fun t => d1 Ω (p t) (p' t) (K t)) s (d1' Ω (p s) (p' s) (p'' s) (K s) (K' s)).
Proof.
  intros. eapply rate_eq.
  - apply rate_sub; [ eassumption | ].
    apply (rate_cross (fun t => (K t - Ω)%V)); [ apply rate_sub; [ eassumption | apply rate_const ] | eassumption ].
  - unfold d1'. vec_ring.
Qed.

(** d1' = τ' (½p' − V) − τ V' + ½ τ'' p. *)
Lemma d1'_is Ω p p' p'' :
  (d1' Ω p p' p'' (K Ω p p') (K' Ω p p' p'')
   = τ' p p' * (/ 2 * p' - V Ω p p') - τ p * V' Ω p' p'' + (/ 2 * τ'' p p' p'') * p)%V.
Proof. unfold d1', K, K', τ', τ'', τ, V, V'. apply vec_ext; unfold_vec; field. Qed.

Section Sizes.
Variables (Ω c : vec) (γ λ : R) (p p' p'' : vec) (T τ'_sup τ''_sup p'_sup p''_sup D : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis T_bound : Rabs (τ p) <= T.
Hypothesis τ'_bound : Rabs (τ' p p') <= τ'_sup.
Hypothesis τ''_bound : Rabs (τ'' p p' p'') <= τ''_sup.
Hypothesis p'_bound : `|p'| <= p'_sup.
Hypothesis p''_bound : `|p''| <= p''_sup.
Hypothesis D_bound : `|d Ω c γ λ p p' p''| <= D.

(** P² = 1 + T, |V| = |p'| + |Ω| P, |V'| = |p''| + |Ω||p'|, as the numbers that are computed. *)
Let P := sqrt (1 + T).
Let V_sup := p'_sup + `|Ω| * P.
Let V'_sup := p''_sup + `|Ω| * p'_sup.

Theorem equation_6_2 : `|p| <= P.
Proof.
  apply sqrt_le_1_alt. apply Rabs_bounds in T_bound. unfold τ in T_bound. lra.
Qed.

Lemma P_at_least_1 : 1 <= P.
Proof. rewrite <- sqrt_1. apply sqrt_le_1_alt. assert (A := Rabs_pos (τ p)). lra. Qed.

Theorem equation_6_3 : `|V Ω p p'| <= V_sup.
Proof. apply norm_add_le; [ assumption | ]. apply norm_cross_le; [ lra | apply equation_6_2 ]. Qed.

Theorem equation_6_4 : `|V' Ω p' p''| <= V'_sup.
Proof. apply norm_add_le; [ assumption | ]. apply norm_cross_le; [ lra | assumption ]. Qed.

Theorem equation_6_5 : `|K Ω p p'| <= P * V_sup.
Proof. apply norm_cross_le; [ apply equation_6_2 | apply equation_6_3 ]. Qed.

Theorem equation_6_6 : `|d1 Ω p p' (K Ω p p')| <= T * V_sup + / 2 * P * τ'_sup.
Proof.
  rewrite lemma_0_d1.
  replace (T * V_sup + / 2 * P * τ'_sup) with (/ 2 * τ'_sup * P + T * V_sup) by ring.
  apply norm_sub_le; apply norm_scale_le; auto using equation_6_2, equation_6_3.
  rewrite Rabs_mult, (Rabs_pos_eq (/ 2)) by lra. lra.
Qed.

Theorem equation_6_7 : `|d2 Ω c γ p (K Ω p p') (K' Ω p p' p'')| <= P * D + γ * `|Ω| * T.
Proof.
  rewrite (lemma_0_d2 Ω c γ λ).
  replace (P * D + γ * `|Ω| * T) with (P * D + γ * T * `|Ω|) by ring.
  apply norm_add_le.
  - apply norm_cross_le; [ apply equation_6_2 | assumption ].
  - apply norm_scale_le; [ | lra ]. rewrite Rabs_mult, (Rabs_pos_eq γ) by assumption.
    apply Rmult_le_compat_l; assumption.
Qed.

(** |½p' − V| = |½p' + Ω × p|. *)
Theorem equation_6_8 :
  `|d1' Ω p p' p'' (K Ω p p') (K' Ω p p' p'')| <= τ'_sup * V_sup + T * V'_sup + / 2 * P * τ''_sup.
Proof.
  rewrite d1'_is.
  assert (inner : `|/ 2 * p' - V Ω p p'| <= V_sup).
  { replace (/ 2 * p' - V Ω p p')%V with (- (/ 2 * p') - Ω × p)%V
      by (unfold V; apply vec_ext; unfold_vec; field).
    assert (p'_nonneg := norm_nonneg p').
    apply norm_sub_le; [ | apply norm_cross_le; [ lra | apply equation_6_2 ] ].
    rewrite norm_opp, norm_scale, Rabs_pos_eq by lra. lra. }
  replace (τ'_sup * V_sup + T * V'_sup + / 2 * P * τ''_sup)
    with (τ'_sup * V_sup + T * V'_sup + / 2 * τ''_sup * P) by ring.
  apply norm_add_le; [ apply norm_sub_le | ]; apply norm_scale_le; auto using equation_6_2, equation_6_4.
  rewrite Rabs_mult, (Rabs_pos_eq (/ 2)) by lra. lra.
Qed.

End Sizes.
