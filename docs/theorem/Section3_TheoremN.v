(** Section 3 of THEOREM.md: Theorem N, a bound without any condition. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect.
Open Scope R_scope.

(** E = |g|² + w²|e|². *)
Definition E (w : R) (g e : vec) : R := `|g| ^ 2 + w ^ 2 * `|e| ^ 2.

(** ν = (|c| + w² + γ|Ω|(1 + P)) / (2w). *)
Definition ν (Ω c : vec) (γ w P : R) : R := (`|c| + w ^ 2 + γ * `|Ω| * (1 + P)) / (2 * w).

Lemma E_dot w g e : E w g e = g · g + w ^ 2 * (e · e).
Proof. unfold E. rewrite <- !norm_sq. ring. Qed.

Lemma E_nonneg w g e : 0 <= E w g e.
Proof. rewrite E_dot. assert (A := dot_self_nonneg g). assert (B := dot_self_nonneg e). nra. Qed.

Lemma E_derivative w g e g' e' s :
  has_rate g s g' -> has_rate e s e' ->
  is_derive (fun t => E w (g t) (e t)) s (2 * (g s · g' + w ^ 2 * (e s · e'))).
Proof.
  intros. apply is_derive_ext with (fun t => g t · g t + w ^ 2 * (e t · e t)).
  - intros; symmetry; apply E_dot.
  - eapply derive_eq. apply derive_add; [ | apply derive_times ]; apply derive_sq; eassumption. simpl. ring.
Qed.

(** The sizes of g and e in terms of E. *)
Lemma g_le_root_E w g e : `|g| <= sqrt (E w g e).
Proof.
  assert (nonneg := norm_nonneg g). rewrite <- (sqrt_square (`|g|)) by assumption.
  apply sqrt_le_1_alt. unfold E. assert (A := pow2_ge_0 w). assert (B := pow2_ge_0 (`|e|)). nra.
Qed.

Lemma we_le_root_E w g e : 0 < w -> w * `|e| <= sqrt (E w g e).
Proof.
  intros w_pos. assert (nonneg := norm_nonneg e).
  rewrite <- (sqrt_square (w * `|e|)) by nra.
  apply sqrt_le_1_alt. unfold E. assert (A := pow2_ge_0 (`|g|)). nra.
Qed.

(** |g||e| ≤ E/(2w). *)
Lemma product_le_E w g e : 0 < w -> `|g| * `|e| <= E w g e / (2 * w).
Proof.
  intros w_pos. apply Rmult_le_reg_r with (2 * w); [ lra | ].
  replace (E w g e / (2 * w) * (2 * w)) with (E w g e) by (field; lra).
  unfold E. assert (A := pow2_ge_0 (`|g| - w * `|e|)). nra.
Qed.

(** ½E' = g·(e × c) + w² e·(g × r) + g·X − g·d2 − w² e·d1; the first two are g·(e × (c − w² r)). *)
Lemma half_E_rate Ω c γ r p p' K K' e g w :
  g · g_rate Ω c γ r p K K' e g + w ^ 2 * (e · e_rate Ω r p p' K e g)
  = g · (e × (c - (w ^ 2) * r)) + g · X Ω γ r p e g - g · d2 Ω c γ p K K' - w ^ 2 * (e · d1 Ω p p' K).
Proof.
  unfold g_rate, e_rate. generalize (X Ω γ r p e g) (d2 Ω c γ p K K') (d1 Ω p p' K) (w ^ 2). vec_ring.
Qed.

(** g·(e × (c − w² r)) ≤ |g||e|(|c| + w²), because |r| = 1. *)
Lemma pull_le c r e g w :
  r · r = 1 -> g · (e × (c - (w ^ 2) * r)) <= `|g| * `|e| * (`|c| + w ^ 2).
Proof.
  intros unit. apply Rle_trans with (1 := dot_upper _ _).
  rewrite Rmult_assoc. apply Rmult_le_compat_l; [ apply norm_nonneg | ].
  apply norm_cross_le; [ lra | ].
  apply norm_sub_le; [ lra | ].
  rewrite norm_scale, (norm_unit r unit), Rabs_pos_eq by apply pow2_ge_0. lra.
Qed.

(** g·X ≤ −γ|g|² + γ|Ω|(1 + P)|g||e|. *)
Lemma drag_le Ω γ r p e g P :
  0 <= γ -> r · r = 1 -> `|p| <= P ->
  g · X Ω γ r p e g <= - γ * `|g| ^ 2 + γ * `|Ω| * (1 + P) * (`|g| * `|e|).
Proof.
  intros γ_nonneg unit p_le.
  assert (expanded : g · X Ω γ r p e g = - γ * (g · g) - γ * ((Ω · e) * (g · r) + (Ω · p) * (g · e)))
    by (unfold X; vec_ring).
  rewrite expanded, <- norm_sq.
  assert (A : Rabs ((Ω · e) * (g · r)) <= `|Ω| * `|e| * (`|g| * 1)).
  { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; [ apply dot_le | ].
    rewrite <- (norm_unit r unit). apply dot_le. }
  assert (B : Rabs ((Ω · p) * (g · e)) <= `|Ω| * P * (`|g| * `|e|)).
  { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; [ | apply dot_le ].
    apply dot_abs_le; lra. }
  apply Rabs_bounds in A. apply Rabs_bounds in B.
  assert (γ * (- (`|Ω| * `|e| * (`|g| * 1)) - `|Ω| * P * (`|g| * `|e|)) <= γ * ((Ω · e) * (g · r) + (Ω · p) * (g · e)))
    by (apply Rmult_le_compat_l; lra).
  simpl. lra.
Qed.

(** |g||d2| + w²|e||d1| ≤ √E (D2 + w D1). *)
Lemma defects_le d1 d2 e g w D1 D2 :
  0 < w -> `|d1| <= D1 -> `|d2| <= D2 ->
  - (g · d2) - w ^ 2 * (e · d1) <= (D2 + w * D1) * sqrt (E w g e).
Proof.
  intros w_pos d1_le d2_le.
  assert (A := dot_lower g d2). assert (B := dot_lower e d1).
  assert (G := g_le_root_E w g e). assert (We := we_le_root_E w g e w_pos).
  assert (`|g| * `|d2| <= sqrt (E w g e) * D2) by (apply Rmult_le_compat; auto using norm_nonneg).
  assert (w * `|e| * `|d1| <= sqrt (E w g e) * D1).
  { apply Rmult_le_compat; auto using norm_nonneg. apply Rmult_le_pos; [ lra | apply norm_nonneg ]. }
  assert (w * (w * `|e| * `|d1|) <= w * (sqrt (E w g e) * D1)) by (apply Rmult_le_compat_l; lra).
  assert (w ^ 2 * (- (`|e| * `|d1|)) <= w ^ 2 * (e · d1)) by (apply Rmult_le_compat_l; [ apply pow2_ge_0 | lra ]).
  simpl in *. lra.
Qed.

(** ** Theorem N

    On the whole step √E(s) ≤ (√E(a) + ℓ (D2 + w D1)) e^{ℓν} (3.1), for any p and K. *)
Theorem theorem_N Ω c γ r H a b p p' K K' w P D1 D2 :
  0 <= γ -> 0 < w -> motion Ω c γ r H a b ->
  (forall s, a <= s <= b -> has_rate p s (p' s)) ->
  (forall s, a <= s <= b -> has_rate K s (K' s)) ->
  (forall s, a <= s <= b -> `|p s| <= P) ->
  (forall s, a <= s <= b -> `|d1 Ω (p s) (p' s) (K s)| <= D1) ->
  (forall s, a <= s <= b -> `|d2 Ω c γ (p s) (K s) (K' s)| <= D2) ->
  forall s, a <= s <= b ->
  sqrt (E w (H s - K s) (r s - p s)) <=
  (sqrt (E w (H a - K a) (r a - p a)) + (b - a) * (D2 + w * D1)) * exp ((b - a) * ν Ω c γ w P).
Proof.
  intros γ_nonneg w_pos is_motion p_rate K_rate p_le d1_le d2_le s s_in.
  assert (a_in : a <= a <= b) by lra.
  assert (P_nonneg := Rle_trans _ _ _ (norm_nonneg (p a)) (p_le a a_in)).
  assert (D1_nonneg := Rle_trans _ _ _ (norm_nonneg _) (d1_le a a_in)).
  assert (D2_nonneg := Rle_trans _ _ _ (norm_nonneg _) (d2_le a a_in)).
  assert (rate_nonneg : 0 <= `|c| + w ^ 2 + γ * `|Ω| * (1 + P)).
  { assert (C := norm_nonneg c). assert (W := pow2_ge_0 w).
    assert (0 <= γ * `|Ω| * (1 + P))
      by (apply Rmult_le_pos; [ apply Rmult_le_pos; [ lra | apply norm_nonneg ] | lra ]).
    lra. }
  apply (lemma_2 (fun t => E w (H t - K t) (r t - p t))
    (fun t => 2 * ((H t - K t) · (H_rate Ω c γ (r t) (H t) - K' t)
      + w ^ 2 * ((r t - p t) · (r_rate Ω (r t) (H t) - p' t))))); auto.
  - unfold ν. apply Rmult_le_pos; [ assumption | left; apply Rinv_0_lt_compat; lra ].
  - assert (0 <= w * D1) by (apply Rmult_le_pos; lra). lra.
  - intros t t_in. destruct is_motion as [r_eq H_eq _].
    apply (E_derivative w (fun u => (H u - K u)%V) (fun u => (r u - p u)%V));
      apply rate_sub; auto.
  - intros; apply E_nonneg.
  - intros t t_in.
    assert (unit := on_sphere _ _ _ _ _ _ _ is_motion t t_in).
    rewrite (lemma_1_g Ω c γ (r t) (H t) (p t) (K t)), (lemma_1_e Ω (r t) (H t) (p t) (p' t) (K t)).
    set (e := (r t - p t)%V). set (g := (H t - K t)%V).
    rewrite half_E_rate.
    assert (pull := pull_le c (r t) e g w unit).
    assert (drag := drag_le Ω γ (r t) (p t) e g P γ_nonneg unit (p_le t t_in)).
    assert (defects := defects_le _ _ e g w D1 D2 w_pos (d1_le t t_in) (d2_le t t_in)).
    assert (lost : 0 <= γ * `|g| ^ 2) by (apply Rmult_le_pos; [ lra | apply pow2_ge_0 ]).
    assert (grown : `|g| * `|e| * (`|c| + w ^ 2 + γ * `|Ω| * (1 + P)) <= ν Ω c γ w P * E w g e).
    { replace (ν Ω c γ w P * E w g e) with (E w g e / (2 * w) * (`|c| + w ^ 2 + γ * `|Ω| * (1 + P)))
        by (unfold ν; field; lra).
      apply Rmult_le_compat_r; [ assumption | apply product_le_E; assumption ]. }
    lra.
Qed.
