(** Section 2 of THEOREM.md: approximant, error, defect. Lemma 0, Lemma 1, Lemma 2. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System.
Open Scope R_scope.

(** The approximant is p, with p' and p'', and λ. With V = p' + Ω × p let

      K = p × V,    d = V' + Ω × V + γ p' − c + λ p,    τ = |p|² − 1,
      e = r − p,    g = H − K,    g⊥ = g − (r·g) r. *)
Definition V (Ω p p' : vec) : vec := p' + Ω × p.
Definition V' (Ω p' p'' : vec) : vec := p'' + Ω × p'.
Definition K (Ω p p' : vec) : vec := p × V Ω p p'.
Definition K' (Ω p p' p'' : vec) : vec := p' × V Ω p p' + p × V' Ω p' p''.
Definition d (Ω c : vec) (γ λ : R) (p p' p'' : vec) : vec :=
  V' Ω p' p'' + Ω × V Ω p p' + γ * p' - c + λ * p.
Definition τ (p : vec) : R := p · p - 1.
Definition τ' (p p' : vec) : R := 2 * (p · p').
Definition g_perp (r g : vec) : vec := g - (r · g) * r.

(** The defects of any (p, K) in (1):

      d1 = p' − (K − Ω) × p,    d2 = K' − p × c − K × Ω + γ (K − Ω + (Ω·p) p). *)
Definition d1 (Ω p p' K : vec) : vec := p' - (K - Ω) × p.
Definition d2 (Ω c : vec) (γ : R) (p K K' : vec) : vec :=
  K' - p × c - K × Ω + γ * (K - Ω + (Ω · p) * p).

(** V', K' and τ' are the derivatives of V, K and τ. *)
Lemma V_rate Ω p p' p'' s :
  has_rate p s (p' s) -> has_rate p' s (p'' s) ->
  has_rate (fun t => V Ω (p t) (p' t)) s (V' Ω (p' s) (p'' s)).
Proof. intros. apply rate_add; [ | apply rate_const_cross ]; assumption. Qed.

Lemma K_rate Ω p p' p'' s :
  has_rate p s (p' s) -> has_rate p' s (p'' s) ->
  has_rate (fun t => K Ω (p t) (p' t)) s (K' Ω (p s) (p' s) (p'' s)).
Proof. intros. apply rate_cross; [ assumption | apply V_rate; assumption ]. Qed.

Lemma τ_rate p p' s : has_rate p s (p' s) -> is_derive (fun t => τ (p t)) s (τ' (p s) (p' s)).
Proof.
  intros. apply derive_eq with (τ' (p s) (p' s) - 0); [ | ring ].
  apply derive_sub; [ apply derive_sq; assumption | apply derive_const ].
Qed.

(** ** Lemma 0

      d1 = ½ τ' p − τ V,        d2 = p × d + γ τ Ω,        K·p = 0,       whatever λ is. *)
Lemma lemma_0_d1 Ω p p' :
  (d1 Ω p p' (K Ω p p') = (/ 2 * τ' p p') * p - τ p * V Ω p p')%V.
Proof. unfold d1, K, τ', τ, V. apply vec_ext; unfold_vec; field. Qed.

(** K' − K × Ω = (p' + Ω × p) × V + p × (V' + Ω × V), where the first product is V × V = 0. *)
Lemma K_turns Ω p p' p'' :
  (K' Ω p p' p'' - K Ω p p' × Ω = p × (V' Ω p' p'' + Ω × V Ω p p'))%V.
Proof.
  assert (jacobi : forall u u', (p' × u + p × u' - (p × u) × Ω = (p' + Ω × p) × u + p × (u' + Ω × u))%V)
    by vec_ring.
  unfold K', K. rewrite jacobi. fold (V Ω p p'). generalize (V' Ω p' p'') (V Ω p p'). vec_ring.
Qed.

(** K − Ω + (Ω·p) p = p × p' + τ Ω. *)
Lemma K_drags Ω p p' : (K Ω p p' - Ω + (Ω · p) * p = p × p' + τ p * Ω)%V.
Proof. unfold K, V, τ. vec_ring. Qed.

Lemma lemma_0_d2 Ω c γ λ p p' p'' :
  (d2 Ω c γ p (K Ω p p') (K' Ω p p' p'') = p × d Ω c γ λ p p' p'' + (γ * τ p) * Ω)%V.
Proof.
  unfold d2. rewrite K_drags.
  replace (K' Ω p p' p'' - p × c - K Ω p p' × Ω)%V with ((K' Ω p p' p'' - K Ω p p' × Ω) - p × c)%V
    by (generalize (K' Ω p p' p'') (K Ω p p'); vec_ring).
  rewrite K_turns. unfold d.
  generalize (V' Ω p' p'') (Ω × V Ω p p')%V (τ p). vec_ring.
Qed.

Lemma lemma_0_Kp Ω p p' : K Ω p p' · p = 0.
Proof. unfold K, V. vec_ring. Qed.

(** ** Lemma 1

      e' = g × r + (K − Ω) × e − d1   and   g' = e × c + g × Ω + X − d2   with X = −γ [g + (Ω·e) r + (Ω·p) e].

    It holds for any p and K with their defects in (1). *)
Definition X (Ω : vec) (γ : R) (r p e g : vec) : vec := - γ * (g + (Ω · e) * r + (Ω · p) * e).
Definition e_rate (Ω r p p' K e g : vec) : vec := g × r + (K - Ω) × e - d1 Ω p p' K.
Definition g_rate (Ω c : vec) (γ : R) (r p K K' e g : vec) : vec :=
  e × c + g × Ω + X Ω γ r p e g - d2 Ω c γ p K K'.

Lemma lemma_1_e Ω r H p p' K :
  let e := (r - p)%V in let g := (H - K)%V in
  (r_rate Ω r H - p' = e_rate Ω r p p' K e g)%V.
Proof. unfold r_rate, e_rate, d1. vec_ring. Qed.

Lemma lemma_1_g Ω c γ r H p K K' :
  let e := (r - p)%V in let g := (H - K)%V in
  (H_rate Ω c γ r H - K' = g_rate Ω c γ r p K K' e g)%V.
Proof. unfold H_rate, g_rate, X, d2. vec_ring. Qed.

(** Further |p|² = 1 − 2 r·e + |e|² ... *)
Lemma lemma_1_p r p : r · r = 1 -> let e := (r - p)%V in p · p = 1 - 2 * (r · e) + e · e.
Proof. intros unit e. rewrite <- unit. unfold e. vec_ring. Qed.

(** ... and r·g = −r·K = −K·e. *)
Lemma lemma_1_rg Ω r H p p' :
  H · r = 0 ->
  let e := (r - p)%V in let g := (H - K Ω p p')%V in
  r · g = - (r · K Ω p p') /\ - (r · K Ω p p') = - (K Ω p p' · e).
Proof.
  intros orthogonal e g. unfold e, g. split.
  - rewrite dot_sub_r, (dot_comm r H), orthogonal. ring.
  - rewrite dot_sub_r, lemma_0_Kp, (dot_comm r). ring.
Qed.

(** ** Lemma 2 (Gronwall)

    If Y ≥ 0 is differentiable and ½Y' ≤ μY + β√Y with constants μ, β ≥ 0, then √Y(s) ≤ (√Y(a) + ℓβ) e^{ℓμ}. *)
Section Gronwall.
Variables (Y Y' : R -> R) (a b μ β : R).
Hypothesis μ_nonneg : 0 <= μ.
Hypothesis β_nonneg : 0 <= β.
Hypothesis Y_derivative : forall s, a <= s <= b -> is_derive Y s (Y' s).
Hypothesis Y_nonneg : forall s, a <= s <= b -> 0 <= Y s.
Hypothesis Y_grows : forall s, a <= s <= b -> / 2 * Y' s <= μ * Y s + β * sqrt (Y s).

(** z = √(Y + δ²) has z z' ≤ μ z² + β z, so z' ≤ μ z + β. *)
Definition gronwall_z (δ s : R) : R := sqrt (Y s + δ * δ).

Lemma gronwall_z_pos δ s : 0 < δ -> a <= s <= b -> 0 < gronwall_z δ s.
Proof. intros. apply sqrt_lt_R0. specialize (Y_nonneg s H0). nra. Qed.

Lemma gronwall_z_derivative δ s :
  0 < δ -> a <= s <= b -> is_derive (gronwall_z δ) s (Y' s * / (2 * gronwall_z δ s)).
Proof.
  intros δ_pos s_in. unfold gronwall_z.
  apply (is_derive_comp sqrt (fun t => Y t + δ * δ)).
  - apply is_derive_Reals, derivable_pt_lim_sqrt. specialize (Y_nonneg s s_in). nra.
  - apply derive_eq with (Y' s + 0); [ | ring ].
    apply derive_add; [ auto | apply derive_const ].
Qed.

Lemma gronwall_z_grows δ s :
  0 < δ -> a <= s <= b -> Y' s * / (2 * gronwall_z δ s) <= μ * gronwall_z δ s + β.
Proof.
  intros δ_pos s_in.
  assert (z_pos := gronwall_z_pos δ s δ_pos s_in).
  assert (nonneg := Y_nonneg s s_in). assert (grows := Y_grows s s_in).
  assert (z_sq : gronwall_z δ s * gronwall_z δ s = Y s + δ * δ) by (apply sqrt_sqrt; nra).
  assert (root : sqrt (Y s) <= gronwall_z δ s) by (apply sqrt_le_1_alt; nra).
  apply Rmult_le_reg_r with (gronwall_z δ s); [ assumption | ].
  replace (Y' s * / (2 * gronwall_z δ s) * gronwall_z δ s) with (/ 2 * Y' s) by (field; lra).
  apply Rle_trans with (1 := grows).
  replace ((μ * gronwall_z δ s + β) * gronwall_z δ s) with (μ * (Y s + δ * δ) + β * gronwall_z δ s)
    by (rewrite <- z_sq; ring).
  apply Rplus_le_compat; apply Rmult_le_compat_l; nra.
Qed.

(** Integrated: z(s) e^{−μ(s−a)} − β (s − a) falls. *)
Lemma gronwall_z_bound δ s :
  0 < δ -> a <= s <= b -> gronwall_z δ s <= (gronwall_z δ a + (s - a) * β) * exp (μ * (s - a)).
Proof.
  intros δ_pos s_in.
  assert (falls : gronwall_z δ s * exp (- μ * (s - a)) - β * (s - a)
    <= gronwall_z δ a * exp (- μ * (a - a)) - β * (a - a)).
  { apply (falling (fun t => gronwall_z δ t * exp (- μ * (t - a)) - β * (t - a))
      (fun t => Y' t * / (2 * gronwall_z δ t) * exp (- μ * (t - a))
        + gronwall_z δ t * (- μ * exp (- μ * (t - a))) - β * (1 - 0))); [ lra | | ].
    - intros t t_in. apply derive_sub.
      + apply (derive_mul (gronwall_z δ) (fun u => exp (- μ * (u - a))));
          [ apply gronwall_z_derivative; lra | apply derive_exp_at ].
      + apply derive_times, derive_sub; [ apply (is_derive_id (K := R_AbsRing)) | apply derive_const ].
    - intros t t_in.
      assert (inside : a <= t <= b) by lra.
      assert (grows := gronwall_z_grows δ t δ_pos inside).
      assert (small : exp (- μ * (t - a)) <= 1) by (rewrite <- exp_0; apply exp_le; nra).
      assert (positive := exp_pos (- μ * (t - a))).
      set (z' := Y' t * / (2 * gronwall_z δ t)) in *. set (w := exp (- μ * (t - a))) in *.
      assert (z' * w <= (μ * gronwall_z δ t + β) * w) by (apply Rmult_le_compat_r; lra).
      assert (β * w <= β * 1) by (apply Rmult_le_compat_l; lra).
      lra. }
  replace (a - a) with 0 in falls by ring. rewrite !Rmult_0_r, exp_0 in falls.
  assert (inverse : exp (- μ * (s - a)) * exp (μ * (s - a)) = 1).
  { rewrite <- exp_plus. replace (- μ * (s - a) + μ * (s - a)) with 0 by ring. apply exp_0. }
  assert (positive := exp_pos (μ * (s - a))).
  replace (gronwall_z δ s) with (gronwall_z δ s * exp (- μ * (s - a)) * exp (μ * (s - a)))
    by (rewrite Rmult_assoc, inverse; ring).
  apply Rmult_le_compat_r; lra.
Qed.

Theorem lemma_2 : forall s, a <= s <= b ->
  sqrt (Y s) <= (sqrt (Y a) + (b - a) * β) * exp ((b - a) * μ).
Proof.
  intros s s_in.
  set (bound := (sqrt (Y a) + (b - a) * β) * exp ((b - a) * μ)).
  assert (E_pos := exp_pos ((b - a) * μ)).
  (* for every δ > 0 *)
  assert (nearly : forall δ, 0 < δ -> sqrt (Y s) <= bound + δ * exp ((b - a) * μ)).
  { intros δ δ_pos.
    assert (a_in : a <= a <= b) by lra.
    apply Rle_trans with (gronwall_z δ s).
    { apply sqrt_le_1_alt. nra. }
    apply Rle_trans with (1 := gronwall_z_bound δ s δ_pos s_in).
    assert (start : gronwall_z δ a <= sqrt (Y a) + δ).
    { unfold gronwall_z. assert (sq := sqrt_sqrt (Y a) (Y_nonneg a a_in)).
      assert (root := sqrt_pos (Y a)).
      rewrite <- (sqrt_square (sqrt (Y a) + δ)) by lra. apply sqrt_le_1_alt. nra. }
    replace (bound + δ * exp ((b - a) * μ)) with ((sqrt (Y a) + δ + (b - a) * β) * exp ((b - a) * μ))
      by (unfold bound; ring).
    assert (z_pos := gronwall_z_pos δ a δ_pos a_in).
    assert ((s - a) * β <= (b - a) * β) by (apply Rmult_le_compat_r; lra).
    assert (0 <= (s - a) * β) by (apply Rmult_le_pos; lra).
    apply Rmult_le_compat; [ lra | apply Rlt_le, exp_pos | lra | apply exp_le; nra ]. }
  (* δ → 0 *)
  destruct (Rle_or_lt (sqrt (Y s)) bound) as [ok | too_large]; [ exact ok | exfalso ].
  assert (half : 0 < (sqrt (Y s) - bound) * / (2 * exp ((b - a) * μ))).
  { apply Rmult_lt_0_compat; [ lra | apply Rinv_0_lt_compat; lra ]. }
  specialize (nearly _ half).
  replace ((sqrt (Y s) - bound) * / (2 * exp ((b - a) * μ)) * exp ((b - a) * μ))
    with (/ 2 * (sqrt (Y s) - bound)) in nearly by (field; lra).
  lra.
Qed.

End Gronwall.
