(** Section 5 of THEOREM.md: Theorem E, (5.1) to (5.4). There are six columns in the code; here any number. How they are
    carried across a boundary (5.5) and how residuals are cut is not here. *)

From Coq Require Import Reals Lra Psatz List.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect Section3_TheoremN.
Open Scope R_scope.
Import ListNotations.

(** R1_j = Wp_j' − WK_j × p − (K − Ω) × Wp_j,
    R2_j = WK_j' − Wp_j × c − WK_j × Ω + γ (WK_j + (Ω·Wp_j) p + (Ω·p) Wp_j). *)
Definition R1 (Ω p K Wp Wp' WK : vec) : vec := Wp' - WK × p - (K - Ω) × Wp.
Definition R2 (Ω c : vec) (γ : R) (p Wp WK WK' : vec) : vec :=
  WK' - Wp × c - WK × Ω + γ * (WK + (Ω · Wp) * p + (Ω · p) * Wp).

(** The defects of (p + Wp ζ, K + WK ζ), for one column with ζ in it ... *)
Lemma d1_of_sum Ω p p' K Wp Wp' WK :
  (d1 Ω (p + Wp) (p' + Wp') (K + WK) = d1 Ω p p' K + R1 Ω p K Wp Wp' WK - WK × Wp)%V.
Proof. unfold d1, R1. vec_ring. Qed.

Lemma d2_of_sum Ω c γ p K K' Wp WK WK' :
  (d2 Ω c γ (p + Wp) (K + WK) (K' + WK')
   = d2 Ω c γ p K K' + R2 Ω c γ p Wp WK WK' + (γ * (Ω · Wp)) * Wp)%V.
Proof. unfold d2, R2. vec_ring. Qed.

(** ... and R1, R2 are linear in a column. *)
Lemma R1_linear Ω p K ζ A A' B C C' D :
  (R1 Ω p K (ζ * A + C) (ζ * A' + C') (ζ * B + D) = ζ * R1 Ω p K A A' B + R1 Ω p K C C' D)%V.
Proof. unfold R1. vec_ring. Qed.

Lemma R2_linear Ω c γ p ζ A B B' C D D' :
  (R2 Ω c γ p (ζ * A + C) (ζ * B + D) (ζ * B' + D') = ζ * R2 Ω c γ p A B B' + R2 Ω c γ p C D D')%V.
Proof. unfold R2. vec_ring. Qed.

Lemma R1_zero Ω p K : R1 Ω p K zero zero zero = zero.               Proof. unfold R1. vec_ring. Qed.
Lemma R2_zero Ω c γ p : R2 Ω c γ p zero zero zero = zero.           Proof. unfold R2. vec_ring. Qed.

(** A column, the constant ζ with |ζ| ≤ z, and bounds of |Wp|, |WK|, |R1|, |R2| on the step. *)
Record column := {
  Wp : R -> vec; Wp' : R -> vec; WK : R -> vec; WK' : R -> vec;
  ζ : R; z_of : R; Wp_sup : R; WK_sup : R; R1_sup : R; R2_sup : R
}.

(** Σ ζ_j f_j at a time, and Σ z_j (a bound of f_j). *)
Definition combined (f : column -> R -> vec) (columns : list column) (s : R) : vec :=
  fold_right (fun j rest => ζ j * f j s + rest)%V zero columns.
Definition total (bound : column -> R) (columns : list column) : R :=
  fold_right (fun j rest => z_of j * bound j + rest) 0 columns.

Lemma combined_cons f j rest s : combined f (j :: rest) s = (ζ j * f j s + combined f rest s)%V.
Proof. reflexivity. Qed.

Lemma combined_le (f : column -> R -> vec) bound columns s :
  (forall j, In j columns -> Rabs (ζ j) <= z_of j /\ `|f j s| <= bound j) ->
  `|combined f columns s| <= total bound columns.
Proof.
  induction columns as [ | j rest IH]; simpl; intros bounds.
  - rewrite norm_zero. lra.
  - destruct (bounds j (or_introl eq_refl)) as [ζ_le f_le].
    apply norm_add_le; [ apply norm_scale_le; assumption | ].
    apply IH. intros k inside. apply bounds. right. exact inside.
Qed.

Lemma combined_rate (f f' : column -> R -> vec) columns s :
  (forall j, In j columns -> has_rate (f j) s (f' j s)) ->
  has_rate (combined f columns) s (combined f' columns s).
Proof.
  induction columns as [ | j rest IH]; simpl; intros rates; [ apply rate_const | ].
  apply (rate_add (fun t => (ζ j * f j t)%V) (combined f rest)).
  - apply rate_times. apply rates. left. reflexivity.
  - apply IH. intros k inside. apply rates. right. exact inside.
Qed.

Lemma R1_combined Ω p K columns s :
  R1 Ω (p s) (K s) (combined Wp columns s) (combined Wp' columns s) (combined WK columns s) = combined (fun j s => R1 Ω (p s) (K s) (Wp j s) (Wp' j s) (WK j s)) columns s.
Proof.
  induction columns as [ | j rest IH]; [ apply R1_zero | ].
  rewrite !combined_cons, R1_linear, IH. reflexivity.
Qed.

Lemma R2_combined Ω c γ p columns s :
  R2 Ω c γ (p s) (combined Wp columns s) (combined WK columns s) (combined WK' columns s) = combined (fun j s => R2 Ω c γ (p s) (Wp j s) (WK j s) (WK' j s)) columns s.
Proof.
  induction columns as [ | j rest IH]; [ apply R2_zero | ].
  rewrite !combined_cons, R2_linear, IH. reflexivity.
Qed.

Section TheoremE.
Variables (Ω c : vec) (γ : R) (r H : R -> vec) (a b : R).
Variables (p p' K K' : R -> vec) (columns : list column) (w P D1 D2 : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis w_pos : 0 < w.
Hypothesis is_motion : motion Ω c γ r H a b.
Hypothesis p_rate : forall s, a <= s <= b -> has_rate p s (p' s).
Hypothesis K_rate : forall s, a <= s <= b -> has_rate K s (K' s).
Hypothesis P_bound : forall s, a <= s <= b -> `|p s| <= P.
Hypothesis D1_bound : forall s, a <= s <= b -> `|d1 Ω (p s) (p' s) (K s)| <= D1.
Hypothesis D2_bound : forall s, a <= s <= b -> `|d2 Ω c γ (p s) (K s) (K' s)| <= D2.

Let R1_at j s := R1 Ω (p s) (K s) (Wp j s) (Wp' j s) (WK j s).
Let R2_at j s := R2 Ω c γ (p s) (Wp j s) (WK j s) (WK' j s).
Hypothesis ζ_bound : forall j, In j columns -> Rabs (ζ j) <= z_of j.
Hypothesis column_rates : forall j s, In j columns -> a <= s <= b ->
  has_rate (Wp j) s (Wp' j s) /\ has_rate (WK j) s (WK' j s).
Hypothesis column_sizes : forall j s, In j columns -> a <= s <= b ->
  `|Wp j s| <= Wp_sup j /\ `|WK j s| <= WK_sup j /\ `|R1_at j s| <= R1_sup j /\ `|R2_at j s| <= R2_sup j.

(** (r, H) = (p + Wp ζ, K + WK ζ) + (e, g), with e(a) = g(a) = 0. *)
Let p_ζ s := (p s + combined Wp columns s)%V.
Let K_ζ s := (K s + combined WK columns s)%V.
Hypothesis start : r a = p_ζ a /\ H a = K_ζ a.

Definition Zp := total Wp_sup columns.
Definition ZK := total WK_sup columns.

Lemma Wp_combined_le s : a <= s <= b -> `|combined Wp columns s| <= Zp.
Proof. intros. apply combined_le. intros j inside. split; [ auto | apply column_sizes; assumption ]. Qed.

Lemma WK_combined_le s : a <= s <= b -> `|combined WK columns s| <= ZK.
Proof. intros. apply combined_le. intros j inside. split; [ auto | apply column_sizes; assumption ]. Qed.

(** (5.1) *)
Theorem equation_5_1 s :
  a <= s <= b ->
  `|d1 Ω (p_ζ s) (p' s + combined Wp' columns s) (K_ζ s)| <= D1 + total R1_sup columns + Zp * ZK.
Proof.
  intros s_in. unfold p_ζ, K_ζ. rewrite d1_of_sum, R1_combined.
  apply norm_sub_le; [ apply norm_add_le; [ auto | ] | ].
  - apply combined_le. intros j inside. split; [ auto | apply (column_sizes j s inside s_in) ].
  - rewrite (Rmult_comm Zp). apply norm_cross_le; [ apply WK_combined_le | apply Wp_combined_le ]; assumption.
Qed.

(** (5.2) *)
Theorem equation_5_2 s :
  a <= s <= b ->
  `|d2 Ω c γ (p_ζ s) (K_ζ s) (K' s + combined WK' columns s)| <= D2 + total R2_sup columns + γ * `|Ω| * Zp ^ 2.
Proof.
  intros s_in. unfold p_ζ, K_ζ. rewrite d2_of_sum, R2_combined.
  apply norm_add_le; [ apply norm_add_le; [ auto | ] | ].
  - apply combined_le. intros j inside. split; [ auto | apply (column_sizes j s inside s_in) ].
  - replace (γ * `|Ω| * Zp ^ 2) with (γ * (`|Ω| * Zp) * Zp) by ring.
    apply norm_scale_le; [ | apply Wp_combined_le; assumption ].
    rewrite Rabs_mult, (Rabs_pos_eq γ) by assumption. apply Rmult_le_compat_l; [ assumption | ].
    apply dot_abs_le; [ lra | apply Wp_combined_le; assumption ].
Qed.

(** ε₁ = ℓ ( (D2 + Σ z_j |R2_j| + γ|Ω| Zp²)/w + D1 + Σ z_j |R1_j| + Zp ZK ) e^{ℓν}, ν with P + Zp for P (5.3). *)
Definition ε_1 : R :=
  (b - a) * ((D2 + total R2_sup columns + γ * `|Ω| * Zp ^ 2) / w + D1 + total R1_sup columns + Zp * ZK)
  * exp ((b - a) * ν Ω c γ w (P + Zp)).

Theorem equation_5_3 s : a <= s <= b -> sqrt (E w (H s - K_ζ s) (r s - p_ζ s)) / w <= ε_1.
Proof.
  intros s_in.
  assert (bound := theorem_N Ω c γ r H a b p_ζ (fun s => p' s + combined Wp' columns s)%V
    K_ζ (fun s => K' s + combined WK' columns s)%V w (P + Zp)
    (D1 + total R1_sup columns + Zp * ZK) (D2 + total R2_sup columns + γ * `|Ω| * Zp ^ 2)
    γ_nonneg w_pos is_motion).
  apply Rmult_le_reg_r with w; [ assumption | ].
  replace (sqrt (E w (H s - K_ζ s) (r s - p_ζ s)) / w * w) with (sqrt (E w (H s - K_ζ s) (r s - p_ζ s)))
    by (field; lra).
  apply Rle_trans with ((sqrt (E w (H a - K_ζ a) (r a - p_ζ a))
    + (b - a) * ((D2 + total R2_sup columns + γ * `|Ω| * Zp ^ 2) + w * (D1 + total R1_sup columns + Zp * ZK)))
    * exp ((b - a) * ν Ω c γ w (P + Zp))).
  - apply bound; try assumption.
    + intros t t_in. apply rate_add; [ auto | ]. apply combined_rate. intros j inside. apply (column_rates j t inside t_in).
    + intros t t_in. apply rate_add; [ auto | ]. apply combined_rate. intros j inside. apply (column_rates j t inside t_in).
    + intros t t_in. apply norm_add_le; [ auto | apply Wp_combined_le; assumption ].
    + exact equation_5_1.
    + exact equation_5_2.
  - destruct start as [-> ->].
    replace (E w (K_ζ a - K_ζ a) (p_ζ a - p_ζ a)) with 0 by (rewrite E_dot; vec_ring).
    rewrite sqrt_0. unfold ε_1. right. field. lra.
Qed.

(** |r − p| ≤ Zp + ε₁, |H − K| ≤ ZK + w ε₁ (5.4). *)
Theorem equation_5_4 s : a <= s <= b -> `|r s - p s| <= Zp + ε_1 /\ `|H s - K s| <= ZK + w * ε_1.
Proof.
  intros s_in. assert (radius := equation_5_3 s s_in).
  assert (size : sqrt (E w (H s - K_ζ s) (r s - p_ζ s)) <= w * ε_1).
  { apply Rmult_le_reg_r with (/ w); [ apply Rinv_0_lt_compat; assumption | ].
    replace (w * ε_1 * / w) with ε_1 by (field; lra). exact radius. }
  split.
  - replace (r s - p s)%V with (combined Wp columns s + (r s - p_ζ s))%V by (unfold p_ζ; vec_ring).
    apply norm_add_le; [ apply Wp_combined_le; assumption | ].
    apply Rmult_le_reg_l with w; [ assumption | ].
    apply Rle_trans with (2 := size). apply we_le_root_E. assumption.
  - replace (H s - K s)%V with (combined WK columns s + (H s - K_ζ s))%V by (unfold K_ζ; vec_ring).
    apply norm_add_le; [ apply WK_combined_le; assumption | ].
    apply Rle_trans with (2 := size). apply g_le_root_E.
Qed.

End TheoremE.
