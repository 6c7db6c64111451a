(** Section 4 of THEOREM.md: Theorem C, one radius that grows only with the curvature. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect Section3_TheoremN.
Open Scope R_scope.

(** ε² = |g⊥|² + w²|e|² and η = ε/w. *)
Definition ε (w : R) (r g e : vec) : R := sqrt (E w (g_perp r g) e).
Definition η (w : R) (r g e : vec) : R := ε w r g e / w.

(** The part of [u] across the unit vector [r]. *)
Definition across (r u : vec) : vec := u - (r · u) * r.

Lemma across_orthogonal r u : r · r = 1 -> across r u · r = 0.
Proof.
  intros unit. replace (across r u · r) with ((r · u) * (1 - r · r)) by (unfold across; vec_ring).
  rewrite unit. ring.
Qed.

Lemma across_sq r u : r · r = 1 -> across r u · across r u = u · u - (r · u) * (r · u).
Proof.
  intros unit.
  replace (across r u · across r u) with (u · u - (2 - r · r) * ((r · u) * (r · u)))
    by (unfold across; vec_ring).
  rewrite unit. ring.
Qed.

Lemma across_le r u : r · r = 1 -> `|across r u| <= `|u|.
Proof.
  intros unit. apply norm_le_of_sq; [ apply norm_nonneg | ].
  rewrite norm_sq, across_sq by assumption. nra.
Qed.

(** Three vectors across [r] have no volume. *)
Lemma coplanar r q u v : r · r = 1 -> q · r = 0 -> u · r = 0 -> v · r = 0 -> q · (u × v) = 0.
Proof.
  intros unit qr ur vr.
  assert (volume : (q · (u × v)) * (r · r) = (q · r) * ((u × v) · r) + (u · r) * ((v × q) · r) + (v · r) * ((q × u) · r))
    by vec_ring.
  rewrite unit, qr, ur, vr in volume. lra.
Qed.

(** ** The derivative of ε² *)

(** ρ = r·g has ρ' = r'·g + r·g' = −(g × r)·K + r·(e × c) + r·X − r·d2: the Ω terms cancel, and
    (H × r)·g = −(g × r)·K. *)
Lemma ρ_rate Ω c γ r p K K' e g :
  r_rate Ω r (g + K) · g + r · g_rate Ω c γ r p K K' e g
  = - ((g × r) · K) + r · (e × c) + r · X Ω γ r p e g - r · d2 Ω c γ p K K'.
Proof. unfold r_rate, g_rate. generalize (X Ω γ r p e g) (d2 Ω c γ p K K'). vec_ring. Qed.

(** ½(|g⊥|²)' = g·g' − ρρ' = g⊥·(e × c) + ρ g⊥·(r × K) + g⊥·X − g⊥·d2. *)
Lemma half_g_perp_rate Ω c γ r p K K' e g :
  g · g_rate Ω c γ r p K K' e g
  - (r · g) * (r_rate Ω r (g + K) · g + r · g_rate Ω c γ r p K K' e g)
  = g_perp r g · (e × c) + (r · g) * (g_perp r g · (r × K))
    + g_perp r g · X Ω γ r p e g - g_perp r g · d2 Ω c γ p K K'.
Proof.
  rewrite ρ_rate. unfold g_rate, g_perp. generalize (X Ω γ r p e g) (d2 Ω c γ p K K'). vec_ring.
Qed.

(** e·e' = g⊥·(r × e) − e·d1. *)
Lemma half_e_rate Ω r p p' K e g :
  e · e_rate Ω r p p' K e g = g_perp r g · (r × e) - e · d1 Ω p p' K.
Proof. unfold e_rate, g_perp. generalize (d1 Ω p p' K). vec_ring. Qed.

Lemma bracket_terms q r α u t k : q · (r × (α * u + t * k)) = α * (q · (r × u)) + t * (q · (r × k)).
Proof. vec_ring. Qed.

(** (2): split e = e⊥ + e_r r, c = c⊥ + c_r r, K = k + K_r r; e⊥ × c⊥ is along r, and ρ = −(k·e⊥ + K_r e_r). *)
Lemma equation_2 c r K e g w :
  r · r = 1 -> r · g = - (K · e) ->
  let e_perp := across r e in let c_perp := across r c in let k := across r K in
  let e_r := r · e in let c_r := r · c in let K_r := r · K in
  g_perp r g · (e × c) + (r · g) * (g_perp r g · (r × K)) + w ^ 2 * (g_perp r g · (r × e))
  = - (g_perp r g · (r × ((c_r - w ^ 2) * e_perp + (k · e_perp) * k)))
    + e_r * (g_perp r g · (r × c_perp)) - K_r * e_r * (g_perp r g · (r × K)).
Proof.
  intros unit ρ_is e_perp c_perp k e_r c_r K_r.
  assert (split : K · e = k · e_perp + K_r * e_r).
  { replace (k · e_perp) with (K · e - (2 - r · r) * (K_r * e_r))
      by (unfold k, e_perp, K_r, e_r, across; vec_ring).
    rewrite unit. ring. }
  assert (flat : g_perp r g · (e_perp × c_perp) = 0)
    by (apply (coplanar r); auto; apply across_orthogonal; assumption).
  assert (product : (g_perp r g) · (e × c) =
    g_perp r g · (e_perp × c_perp) - c_r * (g_perp r g · (r × e_perp)) + e_r * (g_perp r g · (r × c_perp)))
    by (unfold e_perp, c_perp, c_r, e_r, across; generalize (g_perp r g); vec_ring).
  assert (turned_e : g_perp r g · (r × e) = g_perp r g · (r × e_perp))
    by (unfold e_perp, across; generalize (g_perp r g); vec_ring).
  assert (turned_K : g_perp r g · (r × K) = g_perp r g · (r × k))
    by (unfold k, across; generalize (g_perp r g); vec_ring).
  assert (bracket : g_perp r g · (r × ((c_r - w ^ 2) * e_perp + (k · e_perp) * k)) =
    (c_r - w ^ 2) * (g_perp r g · (r × e_perp)) + (k · e_perp) * (g_perp r g · (r × k)))
    by apply bracket_terms.
  rewrite product, flat, bracket, turned_e, turned_K, ρ_is, split. ring.
Qed.

(** ** The terms of (2), one by one *)

(** The bracket is a symmetric matrix with eigenvalues α = c_r − w² and α + |k|²: it stretches by at most
    max(−α, α + |k|²). *)
Lemma bracket_le α k u M :
  - α <= M -> α + `|k| ^ 2 <= M -> `|α * u + (k · u) * k| <= M * `|u|.
Proof.
  intros low high.
  assert (k_sq : `|k| ^ 2 = k · k) by (rewrite <- norm_sq; ring). rewrite k_sq in high.
  assert (k_nonneg := dot_self_nonneg k). assert (u_nonneg := dot_self_nonneg u).
  assert (M_nonneg : 0 <= M) by lra.
  apply norm_le_of_sq; [ apply Rmult_le_pos; auto using norm_nonneg | ].
  replace (M * `|u| * (M * `|u|)) with (M * M * (`|u| * `|u|)) by ring. rewrite norm_sq.
  replace ((α * u + (k · u) * k) · (α * u + (k · u) * k))
    with (α * α * (u · u) + (k · u) * (k · u) * (2 * α + k · k)) by vec_ring.
  assert (t_sq : (k · u) * (k · u) <= (k · k) * (u · u))
    by (assert (A := lagrange k u); assert (B := dot_self_nonneg (k × u)); lra).
  assert (t_nonneg : 0 <= (k · u) * (k · u)) by nra.
  remember ((k · u) * (k · u)) as tt. remember (k · k) as kk. remember (u · u) as uu.
  destruct (Rle_or_lt 0 (2 * α + kk)) as [positive | negative].
  - apply Rle_trans with ((α + kk) * (α + kk) * uu).
    + assert (tt * (2 * α + kk) <= kk * uu * (2 * α + kk)) by (apply Rmult_le_compat_r; lra). lra.
    + apply Rmult_le_compat_r; [ lra | ]. apply Rmult_le_compat; lra.
  - apply Rle_trans with (α * α * uu).
    + assert (0 <= tt * - (2 * α + kk)) by (apply Rmult_le_pos; lra). lra.
    + apply Rmult_le_compat_r; [ lra | ].
      replace (α * α) with (- α * - α) by ring. apply Rmult_le_compat; lra.
Qed.

(** g⊥·X = −γ(|g⊥|² + (Ω·p) g⊥·e) ≤ γ|Ω| P |g⊥||e|. *)
Lemma drag_perp_le Ω γ r p e g P :
  0 <= γ -> r · r = 1 -> `|p| <= P ->
  g_perp r g · X Ω γ r p e g <= γ * `|Ω| * P * (`|g_perp r g| * `|e|).
Proof.
  intros γ_nonneg unit p_le.
  assert (perp : g_perp r g · r = 0) by (apply across_orthogonal; assumption).
  assert (expanded : g_perp r g · X Ω γ r p e g =
    - γ * (g_perp r g · g_perp r g + (Ω · p) * (g_perp r g · e)) - γ * (r · g + Ω · e) * (g_perp r g · r))
    by (unfold X, g_perp; vec_ring).
  rewrite expanded, perp.
  assert (A : Rabs ((Ω · p) * (g_perp r g · e)) <= `|Ω| * P * (`|g_perp r g| * `|e|)).
  { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; [ | apply dot_le ]. apply dot_abs_le; lra. }
  apply Rabs_bounds in A. assert (B := dot_self_nonneg (g_perp r g)).
  assert (γ * (- (`|Ω| * P * (`|g_perp r g| * `|e|))) <=
    γ * (g_perp r g · g_perp r g + (Ω · p) * (g_perp r g · e))) by (apply Rmult_le_compat_l; lra).
  lra.
Qed.

(** 2 e_r = |e|² − τ, so |e_r| ≤ (ē ε/w + T)/2. *)
Lemma e_r_le r p w εs ē T :
  r · r = 1 -> 0 < w -> let e := (r - p)%V in
  `|e| <= ē -> w * `|e| <= εs -> Rabs (τ p) <= T -> Rabs (r · e) <= (ē * (εs / w) + T) / 2.
Proof.
  intros unit w_pos e e_le we_le τ_le.
  assert (twice : 2 * (r · e) = e · e - τ p).
  { unfold τ. assert (P := lemma_1_p r p unit). fold e in P. simpl in P. rewrite P. ring. }
  assert (e_nonneg := norm_nonneg e).
  assert (sq : e · e <= ē * (εs / w)).
  { rewrite <- norm_sq. apply Rmult_le_compat; try assumption.
    apply Rmult_le_reg_l with w; [ assumption | ]. replace (w * (εs / w)) with εs by (field; lra). assumption. }
  assert (sq_nonneg := dot_self_nonneg e).
  apply Rabs_bounds in τ_le. apply Rabs_le. lra.
Qed.

(** The part across r is no longer than the whole: |g| ≤ |g⊥| + K|e|. *)
Lemma g_le Ω r H p p' K_sup :
  r · r = 1 -> H · r = 0 ->
  let e := (r - p)%V in let g := (H - K Ω p p')%V in
  `|K Ω p p'| <= K_sup -> `|g| <= `|g_perp r g| + K_sup * `|e|.
Proof.
  intros unit orthogonal e g K_le.
  destruct (lemma_1_rg Ω r H p p' orthogonal) as [first second]. fold e g in first, second.
  replace g with (g_perp r g + (r · g) * r)%V at 1 by (unfold g_perp; vec_ring).
  apply norm_add_le; [ lra | ].
  rewrite norm_scale, (norm_unit r unit), Rmult_1_r, first, second, Rabs_Ropp.
  apply dot_abs_le; lra.
Qed.

(** √E ≤ ε (1 + K/w), which is what Theorem N needs at the start. *)
Lemma root_E_le Ω r H p p' K_sup w :
  0 < w -> r · r = 1 -> H · r = 0 ->
  let e := (r - p)%V in let g := (H - K Ω p p')%V in
  `|K Ω p p'| <= K_sup -> sqrt (E w g e) <= ε w r g e * (1 + K_sup / w).
Proof.
  intros w_pos unit orthogonal e g K_le.
  assert (K_nonneg := Rle_trans _ _ _ (norm_nonneg _) K_le).
  assert (ratio : 0 <= K_sup / w) by (apply Rmult_le_pos; [ lra | left; apply Rinv_0_lt_compat; lra ]).
  assert (ε_nonneg : 0 <= ε w r g e) by apply sqrt_pos.
  rewrite <- (sqrt_square (ε w r g e * (1 + K_sup / w))) by (apply Rmult_le_pos; lra).
  apply sqrt_le_1_alt.
  destruct (lemma_1_rg Ω r H p p' orthogonal) as [first second]. fold e g in first, second.
  assert (ρ_le : (r · g) * (r · g) <= (K_sup * `|e|) * (K_sup * `|e|)).
  { rewrite first, second. apply Rsqr_le_abs_1. rewrite Rabs_Ropp.
    rewrite (Rabs_pos_eq (K_sup * `|e|)) by (apply Rmult_le_pos; auto using norm_nonneg).
    apply dot_abs_le; lra. }
  assert (g_sq : g_perp r g · g_perp r g = g · g - (r · g) * (r · g)) by (apply across_sq; assumption).
  assert (ε_sq : ε w r g e * ε w r g e = E w (g_perp r g) e) by (apply sqrt_sqrt, E_nonneg).
  assert (we : w * `|e| <= ε w r g e) by (apply we_le_root_E; assumption).
  assert (e_le : `|e| <= ε w r g e / w).
  { apply Rmult_le_reg_l with w; [ assumption | ].
    replace (w * (ε w r g e / w)) with (ε w r g e) by (field; lra). assumption. }
  assert (e_nonneg := norm_nonneg e).
  assert (Ke : K_sup * `|e| <= K_sup / w * ε w r g e).
  { replace (K_sup / w * ε w r g e) with (K_sup * (ε w r g e / w)) by (field; lra).
    apply Rmult_le_compat_l; lra. }
  assert (Ke_nonneg : 0 <= K_sup * `|e|) by (apply Rmult_le_pos; lra).
  assert (whole : E w g e = ε w r g e * ε w r g e + (r · g) * (r · g)) by (rewrite ε_sq, !E_dot; lra).
  assert (square : (K_sup * `|e|) * (K_sup * `|e|) <= (K_sup / w * ε w r g e) * (K_sup / w * ε w r g e))
    by (apply Rmult_le_compat; lra).
  assert (0 <= ε w r g e * ε w r g e * (K_sup / w)) by (apply Rmult_le_pos; [ apply Rmult_le_pos | ]; lra).
  lra.
Qed.

(** ** Theorem C *)

(** |e| ≤ ē = e^{ℓν} ( η(a)(1 + K/w) + ℓ (D2/w + D1) ) (4.1). *)
Definition e_bar (Ω c : vec) (γ w P K_sup D1 D2 ℓ η_a : R) : R :=
  exp (ℓ * ν Ω c γ w P) * (η_a * (1 + K_sup / w) + ℓ * (D2 / w + D1)).

(** μ = [ max(λ−, λ+ + (S + w ē)²) + (|c| + K²) ē + γ|Ω| P ] / (2w) (4.3). *)
Definition μ (Ω c : vec) (γ w P K_sup S λm λp ē : R) : R :=
  (Rmax λm (λp + (S + w * ē) ^ 2) + (`|c| + K_sup ^ 2) * ē + γ * `|Ω| * P) / (2 * w).

(** b = (|c| + K²) T/(2w) + D2/w + D1 (4.4). *)
Definition source (c : vec) (w K_sup T D1 D2 : R) : R :=
  (`|c| + K_sup ^ 2) * T / (2 * w) + D2 / w + D1.

Section TheoremC.
Variables (Ω c : vec) (γ : R) (r H : R -> vec) (a b : R).
Variables (p p' p'' : R -> vec) (w P K_sup T D1 D2 S λm λp : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis w_pos : 0 < w.
Hypothesis is_motion : motion Ω c γ r H a b.
Hypothesis p_rate : forall s, a <= s <= b -> has_rate p s (p' s).
Hypothesis p'_rate : forall s, a <= s <= b -> has_rate p' s (p'' s).
Let Kp s := K Ω (p s) (p' s).
Let Kp' s := K' Ω (p s) (p' s) (p'' s).
Let e s := (r s - p s)%V.
Let g s := (H s - Kp s)%V.
Hypothesis P_bound : forall s, a <= s <= b -> `|p s| <= P.
Hypothesis K_bound : forall s, a <= s <= b -> `|Kp s| <= K_sup.
Hypothesis T_bound : forall s, a <= s <= b -> Rabs (τ (p s)) <= T.
Hypothesis D1_bound : forall s, a <= s <= b -> `|d1 Ω (p s) (p' s) (Kp s)| <= D1.
Hypothesis D2_bound : forall s, a <= s <= b -> `|d2 Ω c γ (p s) (Kp s) (Kp' s)| <= D2.
Hypothesis S_bound : forall s, a <= s <= b -> `|H s| <= S.
Hypothesis λm_bound : forall s, a <= s <= b -> w ^ 2 - c · r s <= λm.
Hypothesis λp_bound : forall s, a <= s <= b -> c · r s - w ^ 2 <= λp.
Let ē := e_bar Ω c γ w P K_sup D1 D2 (b - a) (η w (r a) (g a) (e a)).

Let unit s (s_in : a <= s <= b) : r s · r s = 1 := on_sphere _ _ _ _ _ _ _ is_motion s s_in.
Let orthogonal s (s_in : a <= s <= b) : H s · r s = 0 := H_orthogonal _ _ _ _ _ _ _ is_motion s s_in.

(** Theorem N bounds √E by w ē. *)
Lemma root_E_le_e_bar s : a <= s <= b -> sqrt (E w (g s) (e s)) <= w * ē.
Proof.
  intros s_in. assert (a_in : a <= a <= b) by lra.
  apply Rle_trans with ((sqrt (E w (g a) (e a)) + (b - a) * (D2 + w * D1)) * exp ((b - a) * ν Ω c γ w P)).
  - apply (theorem_N Ω c γ r H a b p p' Kp Kp' w P D1 D2); auto.
    intros t t_in. apply (K_rate Ω p p' p'' t); auto.
  - replace (w * ē) with ((ε w (r a) (g a) (e a) * (1 + K_sup / w) + (b - a) * (D2 + w * D1))
      * exp ((b - a) * ν Ω c γ w P)) by (unfold ē, e_bar, η; field; lra).
    apply Rmult_le_compat_r; [ left; apply exp_pos | ].
    apply Rplus_le_compat_r. apply (root_E_le Ω (r a) (H a) (p a) (p' a) K_sup w); auto. apply (K_bound a a_in).
Qed.

Lemma e_le_e_bar s : a <= s <= b -> `|e s| <= ē.
Proof.
  intros s_in. apply Rmult_le_reg_l with w; [ assumption | ].
  apply Rle_trans with (2 := root_E_le_e_bar s s_in). apply we_le_root_E; assumption.
Qed.

(** |k| ≤ |K| ≤ |H| + |g| ≤ S + w ē. *)
Lemma k_le s : a <= s <= b -> `|across (r s) (Kp s)| <= S + w * ē.
Proof.
  intros s_in. apply Rle_trans with (1 := across_le (r s) (Kp s) (unit s s_in)).
  replace (Kp s) with (H s - g s)%V by (unfold g; vec_ring).
  apply norm_sub_le; [ auto | ].
  apply Rle_trans with (2 := root_E_le_e_bar s s_in). apply g_le_root_E.
Qed.

(** As bounds of −x and of x they have λ− + λ+ ≥ 0: the maximum is ≥ 0. *)
Lemma max_nonneg s : a <= s <= b -> 0 <= Rmax λm (λp + (S + w * ē) ^ 2).
Proof.
  intros s_in. assert (A := λm_bound s s_in). assert (B := λp_bound s s_in).
  assert (C := pow2_ge_0 (S + w * ē)).
  assert (L := Rmax_l λm (λp + (S + w * ē) ^ 2)). assert (R := Rmax_r λm (λp + (S + w * ē) ^ 2)). lra.
Qed.

(** ½(ε²)' is g⊥·(e × c) + ρ g⊥·(r × K) + w² g⊥·(r × e) + g⊥·X − g⊥·d2 − w² e·d1. *)
Definition half_ε_sq_rate s : R :=
  g_perp (r s) (g s) · (e s × c) + (r s · g s) * (g_perp (r s) (g s) · (r s × Kp s))
  + w ^ 2 * (g_perp (r s) (g s) · (r s × e s)) + g_perp (r s) (g s) · X Ω γ (r s) (p s) (e s) (g s)
  - g_perp (r s) (g s) · d2 Ω c γ (p s) (Kp s) (Kp' s) - w ^ 2 * (e s · d1 Ω (p s) (p' s) (Kp s)).

Lemma ε_sq_derivative s :
  a <= s <= b -> is_derive (fun t => (g t · g t - (r t · g t) * (r t · g t)) + w ^ 2 * (e t · e t)) s
                           (2 * half_ε_sq_rate s).
Proof.
  intros s_in.
  assert (r_eq := motion_r _ _ _ _ _ _ _ is_motion). assert (H_eq := motion_H _ _ _ _ _ _ _ is_motion).
  assert (e_derivative : has_rate e s (e_rate Ω (r s) (p s) (p' s) (Kp s) (e s) (g s))).
  { unfold e, g. rewrite <- (lemma_1_e Ω (r s) (H s) (p s) (p' s) (Kp s)). apply rate_sub; auto. }
  assert (g_derivative : has_rate g s (g_rate Ω c γ (r s) (p s) (Kp s) (Kp' s) (e s) (g s))).
  { unfold e, g. rewrite <- (lemma_1_g Ω c γ (r s) (H s) (p s) (Kp s) (Kp' s)).
    apply rate_sub; [ auto | apply (K_rate Ω p p' p''); auto ]. }
  assert (ρ_derivative := derive_dot r g s _ _ (r_eq s s_in) g_derivative).
  eapply derive_eq.
  - apply derive_add; [ apply derive_sub | apply derive_times ].
    + apply derive_sq, g_derivative.
    + apply derive_mul; apply ρ_derivative.
    + apply derive_sq, e_derivative.
  - assert (H_is : H s = (g s + Kp s)%V) by (unfold g; vec_ring).
    assert (G := half_g_perp_rate Ω c γ (r s) (p s) (Kp s) (Kp' s) (e s) (g s)).
    assert (A := half_e_rate Ω (r s) (p s) (p' s) (Kp s) (e s) (g s)).
    rewrite <- H_is in G. unfold half_ε_sq_rate. simpl in *. rewrite A. lra.
Qed.

(** ½(ε²)' ≤ μ ε² + w b ε. *)
Lemma ε_sq_grows s :
  a <= s <= b ->
  half_ε_sq_rate s <= μ Ω c γ w P K_sup S λm λp ē * E w (g_perp (r s) (g s)) (e s)
    + w * source c w K_sup T D1 D2 * ε w (r s) (g s) (e s).
Proof.
  intros s_in.
  assert (one := unit s s_in).
  destruct (lemma_1_rg Ω (r s) (H s) (p s) (p' s) (orthogonal s s_in)) as [first second].
  fold (Kp s) in first, second. fold (e s) (g s) in first, second.
  unfold half_ε_sq_rate.
  rewrite (equation_2 c (r s) (Kp s) (e s) (g s) w one) by (rewrite first; assumption).
  set (M := Rmax λm (λp + (S + w * ē) ^ 2)).
  set (gp := g_perp (r s) (g s)). set (εs := ε w (r s) (g s) (e s)).
  assert (gp_nonneg := norm_nonneg gp). assert (e_nonneg := norm_nonneg (e s)). assert (c_nonneg := norm_nonneg c).
  assert (εs_nonneg : 0 <= εs) by apply sqrt_pos.
  assert (gp_le : `|gp| <= εs) by apply g_le_root_E.
  assert (K_nonneg := Rle_trans _ _ _ (norm_nonneg _) (K_bound s s_in)).
  assert (P_nonneg := Rle_trans _ _ _ (norm_nonneg _) (P_bound s s_in)).
  assert (M_nonneg := max_nonneg s s_in). fold M in M_nonneg.
  assert (product := product_le_E w gp (e s) w_pos).
  assert (εs_sq : εs * εs = E w gp (e s)) by (apply sqrt_sqrt, E_nonneg).
  (* the first term: the bracket, turned by r × *)
  set (bracket := ((r s · c - w ^ 2) * across (r s) (e s)
    + (across (r s) (Kp s) · across (r s) (e s)) * across (r s) (Kp s))%V).
  assert (bracket_size : `|bracket| <= M * `|e s|).
  { apply Rle_trans with (M * `|across (r s) (e s)|).
    - apply bracket_le.
      + assert (A := λm_bound s s_in). rewrite dot_comm in A. assert (L := Rmax_l λm (λp + (S + w * ē) ^ 2)).
        fold M in L. lra.
      + assert (A := λp_bound s s_in). rewrite dot_comm in A. assert (L := Rmax_r λm (λp + (S + w * ē) ^ 2)).
        fold M in L. assert (k := k_le s s_in).
        assert (`|across (r s) (Kp s)| ^ 2 <= (S + w * ē) ^ 2) by (apply pow_incr; split; [ apply norm_nonneg | assumption ]).
        lra.
    - apply Rmult_le_compat_l; [ assumption | apply across_le; assumption ]. }
  assert (term_1 : - (gp · (r s × bracket)) <= M * (`|gp| * `|e s|)).
  { assert (A := dot_lower gp (r s × bracket)).
    assert (B : `|r s × bracket| <= 1 * (M * `|e s|)) by (apply norm_cross_le; [ rewrite norm_unit; auto; lra | assumption ]).
    assert (`|gp| * `|r s × bracket| <= `|gp| * (1 * (M * `|e s|))) by (apply Rmult_le_compat_l; assumption). lra. }
  (* the terms of second order *)
  assert (e_r := e_r_le (r s) (p s) w εs ē T one w_pos (e_le_e_bar s s_in)
    (we_le_root_E w gp (e s) w_pos) (T_bound s s_in)). fold (e s) in e_r.
  set (half := (ē * (εs / w) + T) / 2) in *.
  assert (half_nonneg := Rle_trans _ _ _ (Rabs_pos _) e_r).
  assert (c_term : Rabs (gp · (r s × across (r s) c)) <= εs * (1 * `|c|)).
  { apply dot_abs_le; [ assumption | ].
    apply norm_cross_le; [ rewrite norm_unit; auto; lra | apply across_le; assumption ]. }
  assert (term_2 : (r s · e s) * (gp · (r s × across (r s) c)) <= half * (εs * (1 * `|c|))).
  { apply Rle_trans with (1 := Rle_abs _). rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. }
  assert (K_r : Rabs (r s · Kp s) <= 1 * K_sup) by (apply dot_abs_le; [ rewrite norm_unit; auto; lra | auto ]).
  assert (K_term : Rabs (gp · (r s × Kp s)) <= εs * (1 * K_sup)).
  { apply dot_abs_le; [ assumption | ]. apply norm_cross_le; [ rewrite norm_unit; auto; lra | auto ]. }
  assert (term_3 : - ((r s · Kp s) * (r s · e s) * (gp · (r s × Kp s))) <= 1 * K_sup * half * (εs * (1 * K_sup))).
  { rewrite <- Rabs_Ropp in K_r. 
    apply Rle_trans with (Rabs (- (r s · Kp s) * (r s · e s) * (gp · (r s × Kp s)))).
    - apply Rle_trans with (2 := Rle_abs _). lra.
    - rewrite !Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos.
      + apply Rmult_le_pos; apply Rabs_pos.
      + apply Rmult_le_compat; auto using Rabs_pos. }
  (* drag and defects *)
  assert (drag := drag_perp_le Ω γ (r s) (p s) (e s) (g s) P γ_nonneg one (P_bound s s_in)). fold gp in drag.
  assert (defects := defects_le _ _ (e s) gp w D1 D2 w_pos (D1_bound s s_in) (D2_bound s s_in)).
  replace (sqrt (E w gp (e s))) with εs in defects by reflexivity.
  (* together *)
  assert (rate_1 : M * (`|gp| * `|e s|) <= M * (E w gp (e s) / (2 * w))) by (apply Rmult_le_compat_l; assumption).
  assert (rate_2 : γ * `|Ω| * P * (`|gp| * `|e s|) <= γ * `|Ω| * P * (E w gp (e s) / (2 * w))).
  { apply Rmult_le_compat_l; [ | assumption ].
    apply Rmult_le_pos; [ apply Rmult_le_pos; [ assumption | apply norm_nonneg ] | assumption ]. }
  replace (μ Ω c γ w P K_sup S λm λp ē * E w gp (e s) + w * source c w K_sup T D1 D2 * εs)
    with (M * (E w gp (e s) / (2 * w)) + γ * `|Ω| * P * (E w gp (e s) / (2 * w))
      + (half * (εs * (1 * `|c|)) + 1 * K_sup * half * (εs * (1 * K_sup)))
      + (D2 + w * D1) * εs).
  - lra.
  - unfold μ, source, half. fold M. rewrite <- εs_sq. field. lra.
Qed.

(** η(s) ≤ (η(a) + ℓ b) e^{ℓμ} (4.2). *)
Lemma theorem_C_proof s :
  a <= s <= b ->
  η w (r s) (g s) (e s)
  <= (η w (r a) (g a) (e a) + (b - a) * source c w K_sup T D1 D2)
     * exp ((b - a) * μ Ω c γ w P K_sup S λm λp ē).
Proof.
  intros s_in. assert (a_in : a <= a <= b) by lra.
  assert (c_nonneg := norm_nonneg c). assert (K_sq := pow2_ge_0 K_sup).
  assert (ē_nonneg := Rle_trans _ _ _ (norm_nonneg _) (e_le_e_bar a a_in)).
  assert (P_nonneg := Rle_trans _ _ _ (norm_nonneg _) (P_bound a a_in)).
  assert (T_nonneg := Rle_trans _ _ _ (Rabs_pos _) (T_bound a a_in)).
  assert (D1_nonneg := Rle_trans _ _ _ (norm_nonneg _) (D1_bound a a_in)).
  assert (D2_nonneg := Rle_trans _ _ _ (norm_nonneg _) (D2_bound a a_in)).
  assert (μ_nonneg : 0 <= μ Ω c γ w P K_sup S λm λp ē).
  { apply Rmult_le_pos; [ | left; apply Rinv_0_lt_compat; lra ].
    assert (M := max_nonneg a a_in).
    assert (0 <= (`|c| + K_sup ^ 2) * ē) by (apply Rmult_le_pos; lra).
    assert (0 <= γ * `|Ω| * P) by (apply Rmult_le_pos; [ apply Rmult_le_pos; [ lra | apply norm_nonneg ] | lra ]).
    lra. }
  assert (source_nonneg : 0 <= w * source c w K_sup T D1 D2).
  { replace (w * source c w K_sup T D1 D2) with ((`|c| + K_sup ^ 2) * T / 2 + D2 + w * D1)
      by (unfold source; field; lra).
    assert (0 <= (`|c| + K_sup ^ 2) * T) by (apply Rmult_le_pos; lra).
    assert (0 <= w * D1) by (apply Rmult_le_pos; lra). lra. }
  assert (root : forall t, a <= t <= b ->
    g t · g t - (r t · g t) * (r t · g t) + w ^ 2 * (e t · e t) = E w (g_perp (r t) (g t)) (e t)).
  { intros t t_in. rewrite E_dot. unfold g_perp. fold (across (r t) (g t)). rewrite across_sq; auto. }
  assert (bound := lemma_2 (fun t => g t · g t - (r t · g t) * (r t · g t) + w ^ 2 * (e t · e t))
    (fun t => 2 * half_ε_sq_rate t) a b (μ Ω c γ w P K_sup S λm λp ē) (w * source c w K_sup T D1 D2)
    μ_nonneg source_nonneg ε_sq_derivative).
  cbv beta in bound.
  assert (ε_bound : ε w (r s) (g s) (e s) <=
    (ε w (r a) (g a) (e a) + (b - a) * (w * source c w K_sup T D1 D2))
    * exp ((b - a) * μ Ω c γ w P K_sup S λm λp ē)).
  { unfold ε. rewrite <- (root s s_in), <- (root a a_in). apply bound; try assumption.
    - intros t t_in. rewrite root by assumption. apply E_nonneg.
    - intros t t_in. rewrite root by assumption.
      assert (grows := ε_sq_grows t t_in). unfold ε in grows. lra. }
  unfold η. apply Rmult_le_reg_r with w; [ assumption | ].
  replace (ε w (r s) (g s) (e s) / w * w) with (ε w (r s) (g s) (e s)) by (field; lra).
  apply Rle_trans with (1 := ε_bound). right. field. lra.
Qed.

End TheoremC.

(** The statement, with everything that it needs. *)
Theorem theorem_C (Ω c : vec) (γ : R) (r H : R -> vec) (a b : R)
    (p p' p'' : R -> vec) (w P K_sup T D1 D2 S λm λp : R) :
  0 <= γ -> 0 < w ->
  motion Ω c γ r H a b ->
  (forall s, a <= s <= b -> has_rate p s (p' s)) ->
  (forall s, a <= s <= b -> has_rate p' s (p'' s)) ->
  let Kp s := K Ω (p s) (p' s) in
  let Kp' s := K' Ω (p s) (p' s) (p'' s) in
  let e s := (r s - p s)%V in
  let g s := (H s - Kp s)%V in
  (forall s, a <= s <= b -> `|p s| <= P) ->
  (forall s, a <= s <= b -> `|Kp s| <= K_sup) ->
  (forall s, a <= s <= b -> Rabs (τ (p s)) <= T) ->
  (forall s, a <= s <= b -> `|d1 Ω (p s) (p' s) (Kp s)| <= D1) ->
  (forall s, a <= s <= b -> `|d2 Ω c γ (p s) (Kp s) (Kp' s)| <= D2) ->
  (forall s, a <= s <= b -> `|H s| <= S) ->
  (forall s, a <= s <= b -> w ^ 2 - c · r s <= λm) ->
  (forall s, a <= s <= b -> c · r s - w ^ 2 <= λp) ->
  let η_at s := η w (r s) (g s) (e s) in
  let ē := e_bar Ω c γ w P K_sup D1 D2 (b - a) (η_at a) in
  forall s, a <= s <= b ->
  `|e s| <= ē                                                                             (* (4.1) *)
  /\ η_at s <= (η_at a + (b - a) * source c w K_sup T D1 D2)
              * exp ((b - a) * μ Ω c γ w P K_sup S λm λp ē).                                (* (4.2) *)
Proof.
  intros γ_nonneg w_pos is_motion p_rate p'_rate Kp Kp' e g P_ K_ T_ D1_ D2_ S_ λm_ λp_ η_at ē s s_in. split.
  - apply (e_le_e_bar Ω c γ r H a b p p' p'' w P K_sup D1 D2); assumption.
  - apply (theorem_C_proof Ω c γ r H a b p p' p'' w P K_sup T D1 D2 S λm λp); assumption.
Qed.

(** μ grows with ē, so a bound of ē may stand for it. *)
Lemma μ_grows Ω c γ w P K_sup S λm λp ē1 ē2 :
  0 < w -> 0 <= S -> 0 <= ē1 <= ē2 ->
  μ Ω c γ w P K_sup S λm λp ē1 <= μ Ω c γ w P K_sup S λm λp ē2.
Proof.
  intros w_pos S_nonneg [ē_nonneg ē_le]. apply Rmult_le_compat_r; [ left; apply Rinv_0_lt_compat; lra | ].
  assert (wē : w * ē1 <= w * ē2) by (apply Rmult_le_compat_l; lra).
  assert (0 <= w * ē1) by (apply Rmult_le_pos; lra).
  assert (square : (S + w * ē1) ^ 2 <= (S + w * ē2) ^ 2) by (apply pow_incr; lra).
  assert (second : (`|c| + K_sup ^ 2) * ē1 <= (`|c| + K_sup ^ 2) * ē2).
  { apply Rmult_le_compat_l; [ | assumption ]. assert (A := norm_nonneg c). assert (B := pow2_ge_0 K_sup). lra. }
  assert (Rmax λm (λp + (S + w * ē1) ^ 2) <= Rmax λm (λp + (S + w * ē2) ^ 2)) by (apply Rle_max_compat_l; lra).
  lra.
Qed.

(** |g| ≤ (w + K) η (4.9). *)
Lemma g_le_η Ω r H p p' K_sup w :
  0 < w -> r · r = 1 -> H · r = 0 ->
  let e := (r - p)%V in let g := (H - K Ω p p')%V in
  `|K Ω p p'| <= K_sup -> `|g| <= (w + K_sup) * η w r g e.
Proof.
  intros w_pos unit orthogonal e g K_le.
  assert (K_nonneg := Rle_trans _ _ _ (norm_nonneg _) K_le).
  apply Rle_trans with (1 := g_le Ω r H p p' K_sup unit orthogonal K_le). fold e g.
  assert (A : `|g_perp r g| <= ε w r g e) by apply g_le_root_E.
  assert (B : w * `|e| <= ε w r g e) by (apply we_le_root_E; assumption).
  assert (C : `|e| <= η w r g e).
  { apply Rmult_le_reg_l with w; [ assumption | ]. unfold η.
    replace (w * (ε w r g e / w)) with (ε w r g e) by (field; lra). assumption. }
  replace ((w + K_sup) * η w r g e) with (ε w r g e + K_sup * η w r g e) by (unfold η; field; lra).
  apply Rplus_le_compat; [ assumption | apply Rmult_le_compat_l; assumption ].
Qed.

(** |e| ≤ η. *)
Lemma e_le_η w r g e : 0 < w -> `|e| <= η w r g e.
Proof.
  intros w_pos. apply Rmult_le_reg_l with w; [ assumption | ]. unfold η.
  replace (w * (ε w r g e / w)) with (ε w r g e) by (field; lra). apply we_le_root_E; assumption.
Qed.

(** ** The rate needs no polynomial

    λ− = w² + ½|Ω|² + J(0) (4.5), λ+ = |c| − w² (4.6), S = |Ω| + √(|Ω|² + 2(J(0) + |c|)) (4.7). *)
Definition lambda_minus (Ω : vec) (w J0 : R) : R := w ^ 2 + / 2 * `|Ω| ^ 2 + J0.
Definition lambda_plus (c : vec) (w : R) : R := `|c| - w ^ 2.
Definition S_of (Ω c : vec) (J0 : R) : R := `|Ω| + sqrt (`|Ω| ^ 2 + 2 * (J0 + `|c|)).

Section Rate.
Variables (Ω c : vec) (γ : R) (r H : R -> vec) (t_start t_end J0 w : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis is_motion : motion Ω c γ r H t_start t_end.
Hypothesis J_start : energy Ω c (r t_start) (H t_start) <= J0.

Lemma energy_bound t : t_start <= t <= t_end -> energy Ω c (r t) (H t) <= J0.
Proof.
  intros t_in. apply Rle_trans with (2 := J_start).
  apply (energy_falls Ω c γ r H t_start t_end); assumption.
Qed.

Lemma cr_le_c t : t_start <= t <= t_end -> c · r t <= `|c|.
Proof.
  intros t_in. apply Rle_trans with (1 := dot_upper _ _).
  rewrite (norm_unit (r t)) by (apply (on_sphere _ _ _ _ _ _ _ is_motion); assumption). lra.
Qed.

(** c·r = ½|H|² − Ω·H − J(t) ≥ −½|Ω|² − J(0). *)
Theorem equation_4_5 t : t_start <= t <= t_end -> w ^ 2 - c · r t <= lambda_minus Ω w J0.
Proof.
  intros t_in. assert (J := energy_bound t t_in). unfold energy in J. unfold lambda_minus.
  assert (square := dot_self_nonneg (H t - Ω)).
  replace ((H t - Ω) · (H t - Ω)) with (H t · H t - 2 * (Ω · H t) + Ω · Ω) in square by vec_ring.
  assert (Ω_sq : `|Ω| ^ 2 = Ω · Ω) by (rewrite <- norm_sq; ring). lra.
Qed.

Theorem equation_4_6 t : t_start <= t <= t_end -> c · r t - w ^ 2 <= lambda_plus c w.
Proof. intros t_in. unfold lambda_plus. assert (A := cr_le_c t t_in). lra. Qed.

(** ½|H|² − |Ω||H| ≤ J(0) + |c|. *)
Theorem equation_4_7 t : t_start <= t <= t_end -> `|H t| <= S_of Ω c J0.
Proof.
  intros t_in. assert (J := energy_bound t t_in). assert (A := cr_le_c t t_in).
  assert (B := dot_upper Ω (H t)). assert (H_sq := norm_sq (H t)). unfold energy in J. unfold S_of.
  set (h := `|H t|) in *. set (ω := `|Ω|) in *.
  assert (square : (h - ω) * (h - ω) <= ω ^ 2 + 2 * (J0 + `|c|)) by (simpl; lra).
  assert (h - ω <= sqrt (ω ^ 2 + 2 * (J0 + `|c|))); [ | lra ].
  apply Rle_trans with (Rabs (h - ω)); [ apply Rle_abs | ].
  rewrite <- sqrt_Rsqr_abs. apply sqrt_le_1_alt. exact square.
Qed.

End Rate.

(** In scaled time J is h² J, so that λ−, λ+ and S are h² λ−, h² λ+ and h S. *)
Lemma energy_scaled Ω c r H h :
  energy (h * Ω) ((h * h)%R * c) r (h * H) = h ^ 2 * energy Ω c r H.
Proof. unfold energy. unfold_vec. field. Qed.

Lemma S_scaled Ω c J0 h : 0 < h -> S_of (h * Ω) ((h * h)%R * c) (h ^ 2 * J0) = h * S_of Ω c J0.
Proof.
  intros h_pos. unfold S_of. rewrite !norm_scale, !Rabs_pos_eq by nra.
  replace ((h * `|Ω|) ^ 2 + 2 * (h ^ 2 * J0 + h * h * `|c|))
    with (h * h * (`|Ω| ^ 2 + 2 * (J0 + `|c|))) by ring.
  rewrite sqrt_mult_alt, sqrt_square by nra. ring.
Qed.

Lemma lambda_minus_scaled Ω w J0 h :
  0 < h -> lambda_minus (h * Ω) (h * w)%R (h ^ 2 * J0) = h ^ 2 * lambda_minus Ω w J0.
Proof. intros h_pos. unfold lambda_minus. rewrite norm_scale, Rabs_pos_eq by lra. field. Qed.

Lemma lambda_plus_scaled c w h :
  0 < h -> lambda_plus ((h * h)%R * c) (h * w)%R = h ^ 2 * lambda_plus c w.
Proof. intros h_pos. unfold lambda_plus. rewrite norm_scale, Rabs_pos_eq by nra. ring. Qed.

(** ** From step to step *)

(** √E is a norm of (g, e). *)
Lemma root_E_add w g1 g2 e1 e2 :
  0 < w -> sqrt (E w (g1 + g2) (e1 + e2)) <= sqrt (E w g1 e1) + sqrt (E w g2 e2).
Proof.
  intros w_pos. set (A := sqrt (E w g1 e1)). set (B := sqrt (E w g2 e2)).
  assert (A_sq : A * A = E w g1 e1) by (apply sqrt_sqrt, E_nonneg).
  assert (B_sq : B * B = E w g2 e2) by (apply sqrt_sqrt, E_nonneg).
  assert (A_nonneg : 0 <= A) by apply sqrt_pos. assert (B_nonneg : 0 <= B) by apply sqrt_pos.
  assert (G := norm_add g1 g2). assert (F := norm_add e1 e2).
  assert (G0 := norm_nonneg (g1 + g2)). assert (F0 := norm_nonneg (e1 + e2)).
  assert (g1_0 := norm_nonneg g1). assert (g2_0 := norm_nonneg g2).
  assert (e1_0 := norm_nonneg e1). assert (e2_0 := norm_nonneg e2).
  rewrite <- (sqrt_square (A + B)) by lra. apply sqrt_le_1_alt.
  assert (mixed : `|g1| * `|g2| + w ^ 2 * (`|e1| * `|e2|) <= A * B).
  { assert (0 <= w ^ 2 * (`|e1| * `|e2|)) by (apply Rmult_le_pos; [ apply pow2_ge_0 | apply Rmult_le_pos; assumption ]).
    assert (0 <= `|g1| * `|g2|) by (apply Rmult_le_pos; assumption).
    assert (0 <= A * B) by (apply Rmult_le_pos; assumption).
    apply Rsqr_incr_0; [ | lra | assumption ]. unfold Rsqr.
    replace (A * B * (A * B)) with (A * A * (B * B)) by ring. rewrite A_sq, B_sq. unfold E.
    assert (S := pow2_ge_0 (w * (`|g1| * `|e2| - `|g2| * `|e1|))). lra. }
  assert (sum_g : `|g1 + g2| ^ 2 <= (`|g1| + `|g2|) ^ 2) by (apply pow_incr; lra).
  assert (sum_e : w ^ 2 * `|e1 + e2| ^ 2 <= w ^ 2 * (`|e1| + `|e2|) ^ 2)
    by (apply Rmult_le_compat_l; [ apply pow2_ge_0 | apply pow_incr; lra ]).
  replace ((A + B) * (A + B)) with (A * A + B * B + 2 * (A * B)) by ring. rewrite A_sq, B_sq.
  unfold E at 1. unfold E. lra.
Qed.

Lemma root_E_small w g e : 0 < w -> sqrt (E w g e) <= `|g| + w * `|e|.
Proof.
  intros w_pos. assert (A := norm_nonneg g). assert (B := norm_nonneg e).
  assert (C : 0 <= w * `|e|) by (apply Rmult_le_pos; lra).
  rewrite <- (sqrt_square (`|g| + w * `|e|)) by lra. apply sqrt_le_1_alt. unfold E.
  assert (0 <= `|g| * (w * `|e|)) by (apply Rmult_le_pos; assumption). lra.
Qed.

(** r and H are continuous and g⊥ is taken along the true r: in physical time η(new) ≤ η + |Δp| + |ΔK|/w (4.8). *)
Theorem equation_4_8 w r H p_old K_old p_new K_new :
  0 < w -> r · r = 1 ->
  η w r (H - K_new) (r - p_new)
  <= η w r (H - K_old) (r - p_old) + `|p_new - p_old| + `|K_new - K_old| / w.
Proof.
  intros w_pos unit. unfold η.
  apply Rmult_le_reg_r with w; [ assumption | ].
  replace (ε w r (H - K_new) (r - p_new) / w * w) with (ε w r (H - K_new) (r - p_new)) by (field; lra).
  replace ((ε w r (H - K_old) (r - p_old) / w + `|p_new - p_old| + `|K_new - K_old| / w) * w)
    with (ε w r (H - K_old) (r - p_old) + (`|K_new - K_old| + w * `|p_new - p_old|)) by (field; lra).
  unfold ε.
  replace (g_perp r (H - K_new)) with (g_perp r (H - K_old) + across r (K_old - K_new))%V
    by (unfold g_perp, across; vec_ring).
  replace (r - p_new)%V with ((r - p_old) + (p_old - p_new))%V by vec_ring.
  apply Rle_trans with (1 := root_E_add _ _ _ _ _ w_pos). apply Rplus_le_compat_l.
  apply Rle_trans with (1 := root_E_small _ _ _ w_pos).
  assert (A := across_le r (K_old - K_new) unit).
  assert (flip : forall u v, `|u - v| = `|v - u|)
    by (intros u v; rewrite <- norm_opp; f_equal; vec_ring).
  rewrite (flip p_new), (flip K_new). lra.
Qed.

(** At the start Δ is the distance of (p, K) from the exact r0, H0, and η = 0. *)
Lemma η_start w r H : η w r (H - H) (r - r) = 0.
Proof.
  replace (H - H)%V with zero by vec_ring. replace (r - r)%V with zero by vec_ring.
  unfold η, ε. replace (g_perp r zero) with zero by (unfold g_perp; vec_ring).
  replace (E w zero zero) with 0 by (rewrite E_dot; vec_ring). rewrite sqrt_0. unfold Rdiv. ring.
Qed.

(** η does not change when time is rescaled: w is h w, g is h g. *)
Lemma η_scaled h w r g e : 0 < h -> 0 < w -> η (h * w) r (h * g) e = η w r g e.
Proof.
  intros h_pos w_pos. unfold η, ε.
  replace (E (h * w) (g_perp r (h * g)) e) with (h * h * E w (g_perp r g) e)
    by (rewrite !E_dot; unfold g_perp; vec_ring).
  rewrite sqrt_mult_alt, sqrt_square by nra. field. lra.
Qed.
