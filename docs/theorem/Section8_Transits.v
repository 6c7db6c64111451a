(** Section 8 of THEOREM.md: transits. The zeros of a function u, which is ẋ, with the derivative u', which is ẍ.
    The parity of what is possible (8.7) is not here, and neither is "ẋ = 0 for ever". *)

From Coq Require Import Reals Lra Psatz List Ranalysis5.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Vectors Curves Section1_System Section2_ErrorAndDefect Section6_Sizes Section7_Tube.
Open Scope R_scope.
Import ListNotations.

(** The true ẋ lies in f ± U and ẍ in f' ± A, as a component is no larger than the vector. *)
Lemma component_le u v size : `|u - v| <= size -> x v - size <= x u <= x v + size.
Proof.
  intros near. assert (nonneg := norm_nonneg (u - v)%V).
  assert (sq := norm_sq (u - v)%V).
  assert (first : (x u - x v) * (x u - x v) <= `|u - v| * `|u - v|)
    by (rewrite sq; assert (B := Rle_0_sqr (y u - y v)); assert (C := Rle_0_sqr (z u - z v));
        unfold Rsqr in *; unfold dot, sub; simpl; lra).
  assert (Rabs (x u - x v) <= size).
  { apply Rle_trans with (2 := near). rewrite <- (Rabs_pos_eq (`|u - v|)) by assumption.
    apply Rsqr_le_abs_0. exact first. }
  apply Rabs_bounds in H. lra.
Qed.

(** A sign is 1 or −1; "u has the sign σ at t" is 0 < σ u(t). *)
Definition is_sign (σ : R) : Prop := σ = 1 \/ σ = -1.

Lemma signed_derivative (u u' : R -> R) σ s : is_derive u s (u' s) -> is_derive (fun t => σ * u t) s (σ * u' s).
Proof. apply derive_times. Qed.

Section Leaf.
Variables (u u' : R -> R) (low high : R).
Hypothesis ordered : low <= high.
Hypothesis derivative : forall t, low <= t <= high -> is_derive u t (u' t).

(** (8.1) The mean value form: if u(m) + u'(I)(I − m) has a sign, u has it on the leaf I. *)
Theorem equation_8_1 σ m F U G A :
  low <= m <= high ->
  F - U <= u m <= F + U ->
  (forall t, low <= t <= high -> G - A <= u' t <= G + A) ->
  (forall value slope t, F - U <= value <= F + U -> G - A <= slope <= G + A -> low <= t <= high ->
    0 < σ * (value + slope * (t - m))) ->
  forall t, low <= t <= high -> 0 < σ * u t.
Proof.
  intros m_in value_in slope_in sign t t_in.
  assert (slope : exists k, G - A <= k <= G + A /\ u t = u m + k * (t - m)).
  { destruct (total_order_T m t) as [[less | same] | greater].
    - destruct (mean_value u u' m t) as (n & n_in & equation); [ lra | intros; apply derivative; lra | ].
      exists (u' n). split; [ apply slope_in; lra | lra ].
    - exists (u' m). split; [ apply slope_in; lra | rewrite same; ring ].
    - destruct (mean_value u u' t m) as (n & n_in & equation); [ lra | intros; apply derivative; lra | ].
      exists (u' n). split; [ apply slope_in; lra | lra ]. }
  destruct slope as (k & k_in & ->). apply sign; assumption.
Qed.

(** u' has the sign σ: σ u grows. *)
Lemma monotone σ s t :
  (forall t, low <= t <= high -> 0 < σ * u' t) -> low <= s -> s < t -> t <= high -> σ * u s < σ * u t.
Proof.
  intros sign low_s s_t t_high.
  apply (strictly_rising (fun t => σ * u t) (fun t => σ * u' t)); [ assumption | | ].
  - intros; apply derive_times, derivative; lra.
  - intros; apply sign; lra.
Qed.

(** (8.2) ẍ has a sign and ẋ has the same sign at both ends. *)
Theorem equation_8_2 σ τ :
  is_sign σ -> is_sign τ ->
  (forall t, low <= t <= high -> 0 < σ * u' t) -> 0 < τ * u low -> 0 < τ * u high ->
  forall t, low <= t <= high -> 0 < τ * u t.
Proof.
  intros σ_sign τ_sign sign at_low at_high t t_in.
  assert (left : low < t -> σ * u low < σ * u t) by (intros; apply monotone; auto; lra).
  assert (right : t < high -> σ * u t < σ * u high) by (intros; apply monotone; auto; lra).
  destruct (Req_dec t low) as [-> | ]; [ assumption | ].
  destruct (Req_dec t high) as [-> | ]; [ assumption | ].
  destruct σ_sign as [-> | ->], τ_sign as [-> | ->]; lra.
Qed.

(** (8.5) A cluster on which ẍ has a sign, with equal sides: no zero. *)
Theorem equation_8_5 σ τ :
  is_sign σ -> is_sign τ ->
  (forall t, low <= t <= high -> 0 < σ * u' t) -> 0 < τ * u low -> 0 < τ * u high ->
  forall t, low <= t <= high -> u t <> 0.
Proof.
  intros σ_sign τ_sign sign at_low at_high t t_in is_zero.
  assert (A := equation_8_2 σ τ σ_sign τ_sign sign at_low at_high t t_in). rewrite is_zero in A. lra.
Qed.

(** (8.6) With opposite sides: exactly one zero, in the direction of ẍ. *)
Theorem equation_8_6 σ :
  is_sign σ ->
  (forall t, low <= t <= high -> 0 < σ * u' t) -> σ * u low < 0 -> 0 < σ * u high ->
  exists t, (low < t < high /\ u t = 0 /\ 0 < σ * u' t)
    /\ forall s, low <= s <= high -> u s = 0 -> s = t.
Proof.
  intros σ_sign sign at_low at_high.
  assert (apart : low < high).
  { destruct (Req_dec low high) as [same | ]; [ rewrite same in at_low; lra | lra ]. }
  destruct (IVT_interv (fun t => σ * u t) low high) as (t & t_in & is_zero); auto.
  { intros t t_in. apply (continuous_of_derive _ t (σ * u' t)), derive_times, derivative, t_in. }
  assert (root : u t = 0) by (destruct σ_sign as [-> | ->]; lra).
  exists t. split.
  - assert (t <> low) by (intros ->; rewrite root in at_low; lra).
    assert (t <> high) by (intros ->; rewrite root in at_high; lra).
    split; [ lra | ]. split; [ assumption | apply sign; lra ].
  - intros s s_in s_zero. destruct (total_order_T s t) as [[less | same] | greater]; [ exfalso | assumption | exfalso ].
    + assert (A := monotone σ s t sign ltac:(lra) less ltac:(lra)). rewrite s_zero, root in A. lra.
    + assert (A := monotone σ t s sign ltac:(lra) greater ltac:(lra)). rewrite s_zero, root in A. lra.
Qed.

(** Which direction the sides have is that of ẍ: the other one cannot be. *)
Lemma direction_of_sides σ :
  (forall t, low <= t <= high -> 0 < σ * u' t) -> 0 < σ * u low -> σ * u high < 0 -> False.
Proof.
  intros sign at_low at_high.
  destruct (Req_dec low high) as [same | ]; [ rewrite same in at_low; lra | ].
  assert (A := monotone σ low high sign ltac:(lra) ltac:(lra) ltac:(lra)). lra.
Qed.

(** (8.8) Where ẍ has a sign on a cluster: if at a time in it ẋ has the sign of a side, there is no zero between them. *)
Theorem equation_8_8_before σ t :
  (forall t, low <= t <= high -> 0 < σ * u' t) ->
  low <= t <= high -> σ * u t < 0 -> forall s, low <= s <= t -> u s <> 0.
Proof.
  intros sign t_in at_t s s_in is_zero.
  destruct (Req_dec s t) as [same | ]; [ rewrite <- same, is_zero in at_t; lra | ].
  assert (A := monotone σ s t sign ltac:(lra) ltac:(lra) ltac:(lra)). rewrite is_zero in A. lra.
Qed.

Theorem equation_8_8_after σ t :
  (forall t, low <= t <= high -> 0 < σ * u' t) ->
  low <= t <= high -> 0 < σ * u t -> forall s, t <= s <= high -> u s <> 0.
Proof.
  intros sign t_in at_t s s_in is_zero.
  destruct (Req_dec s t) as [same | ]; [ rewrite <- same, is_zero in at_t; lra | ].
  assert (A := monotone σ t s sign ltac:(lra) ltac:(lra) ltac:(lra)). rewrite is_zero in A. lra.
Qed.

(** (8.9) If ẋ(0) = 0, a first leaf (0, δ] on which ẍ has a sign has it for ẋ as well. *)
Theorem equation_8_9 σ :
  u low = 0 -> (forall t, low < t <= high -> 0 < σ * u' t) ->
  forall t, low < t <= high -> 0 < σ * u t.
Proof.
  intros at_low sign t t_in.
  assert (A : σ * u low < σ * u t).
  { apply (strictly_rising (fun t => σ * u t) (fun t => σ * u' t)); [ lra | | ].
    - intros; apply derive_times, derivative; lra.
    - intros; apply sign; lra. }
  rewrite at_low in A. lra.
Qed.

End Leaf.

(** ** Leaves and clusters *)

(** A leaf is E, ẋ has the sign σ; M, ẍ has the sign σ; or R. *)
Inductive kind := leaf_E (σ : R) | leaf_M (σ : R) | leaf_R.
Definition leaf : Type := (R * R) * kind.

Definition leaf_holds (u u' : R -> R) (l : leaf) : Prop :=
  let '((low, high), k) := l in
  match k with
  | leaf_E σ => forall t, low <= t <= high -> 0 < σ * u t
  | leaf_M σ => forall t, low <= t <= high -> 0 < σ * u' t
  | leaf_R => True
  end.

(** Each interval begins where the one before it ends, from [a] to [b]. *)
Fixpoint chain {verdict : Type} (a : R) (l : list ((R * R) * verdict)) (b : R) : Prop :=
  match l with
  | [] => a = b
  | ((low, high), _) :: l => a = low /\ low <= high /\ chain high l b
  end.

Lemma chain_ordered {verdict} (l : list ((R * R) * verdict)) a b : chain a l b -> a <= b.
Proof.
  revert a. induction l as [ | ((low, high), k) l IH]; simpl; intros a; [ lra | ].
  intros (-> & ordered & rest). specialize (IH high rest). lra.
Qed.

Lemma chain_covers {verdict} (l : list ((R * R) * verdict)) a b t :
  chain a l b -> l <> [] -> a <= t <= b -> exists low high k, In ((low, high), k) l /\ low <= t <= high.
Proof.
  revert a. induction l as [ | ((low, high), k) l IH]; simpl; [ congruence | ].
  intros a (-> & ordered & rest) _ t_in.
  destruct (Rle_or_lt t high) as [here | later].
  - exists low, high, k. split; [ left; reflexivity | lra ].
  - assert (l <> []) by (intros ->; simpl in rest; lra).
    destruct (IH high rest H ltac:(lra)) as (low' & high' & k' & inside & t_in').
    exists low', high', k'. auto.
Qed.

(** Every zero lies in a leaf that is not E, so none is missed. *)
Theorem none_is_missed u u' leaves a b t :
  chain a leaves b -> leaves <> [] -> (forall l, In l leaves -> leaf_holds u u' l) ->
  a <= t <= b -> u t = 0 ->
  exists low high k, In ((low, high), k) leaves /\ low <= t <= high /\ forall σ, k <> leaf_E σ.
Proof.
  intros joined some hold t_in is_zero.
  destruct (chain_covers leaves a b t joined some t_in) as (low & high & k & inside & t_here).
  exists low, high, k. repeat split; try tauto. intros σ ->.
  specialize (hold _ inside). simpl in hold. specialize (hold t t_here). rewrite is_zero in hold. lra.
Qed.

(** A cluster all of whose leaves are M of one sign: ẍ has that sign on all of it. *)
Theorem cluster_is_monotone u u' leaves a b σ :
  chain a leaves b -> leaves <> [] -> (forall l, In l leaves -> leaf_holds u u' l) ->
  (forall interval k, In (interval, k) leaves -> k = leaf_M σ) ->
  forall t, a <= t <= b -> 0 < σ * u' t.
Proof.
  intros joined some hold all_M t t_in.
  destruct (chain_covers leaves a b t joined some t_in) as (low & high & k & inside & t_here).
  rewrite (all_M _ _ inside) in inside. exact (hold _ inside t t_here).
Qed.

(** ** A chain of decided pieces loses no zero

    A piece is an interval without a zero (E leaves, or a cluster by (8.5)), one with exactly one zero, inside it (a
    cluster by (8.6)), or one where zeros are possible. *)
Inductive verdict := no_zero | one_zero | possible.

Definition piece_holds (u : R -> R) (piece : (R * R) * verdict) : Prop :=
  let '((low, high), answer) := piece in
  match answer with
  | no_zero => forall t, low <= t <= high -> u t <> 0
  | one_zero => exists t, (low < t < high /\ u t = 0) /\ forall s, low <= s <= high -> u s = 0 -> s = t
  | possible => True
  end.

Definition is_one (piece : (R * R) * verdict) : bool :=
  match snd piece with one_zero => true | _ => false end.

(** Every zero lies in a piece with one zero or where zeros are possible. *)
Theorem chain_none_missed u pieces a b t :
  chain a pieces b -> pieces <> [] -> (forall piece, In piece pieces -> piece_holds u piece) ->
  a <= t <= b -> u t = 0 ->
  exists low high answer, In ((low, high), answer) pieces /\ low <= t <= high /\ answer <> no_zero.
Proof.
  intros joined some hold t_in is_zero.
  destruct (chain_covers pieces a b t joined some t_in) as (low & high & k & inside & t_here).
  exists low, high, k. repeat split; try tauto. intros ->. exact (hold _ inside t t_here is_zero).
Qed.

(** Where nothing is merely possible, the zeros are counted: as many as there are pieces with one zero. *)
Theorem chain_counted u pieces a b :
  chain a pieces b -> (forall piece, In piece pieces -> piece_holds u piece /\ snd piece <> possible) ->
  exists zeros, NoDup zeros /\ length zeros = length (filter is_one pieces)
    /\ (forall t, In t zeros -> a <= t <= b /\ u t = 0)
    /\ (pieces <> [] -> forall t, a <= t <= b -> u t = 0 -> In t zeros).
Proof.
  revert a. induction pieces as [ | ((low, high), answer) pieces IH]; intros a joined hold.
  - exists []. simpl. repeat split; try tauto. constructor.
  - simpl in joined. destruct joined as (-> & ordered & rest).
    assert (rest_ordered := chain_ordered pieces high b rest).
    destruct (IH high rest) as (zeros & distinct & number & are_zeros & all).
    { intros piece inside. apply hold. right. exact inside. }
    destruct (hold ((low, high), answer) (or_introl eq_refl)) as [here decided].
    (* a zero after this piece is one of the others *)
    assert (later : forall t, high < t <= b -> u t = 0 -> In t zeros).
    { intros t t_in is_zero. apply all; [ | lra | assumption ]. intros empty. rewrite empty in rest. simpl in rest. lra. }
    destruct answer; simpl in here; [ | | simpl in decided; congruence ].
    + exists zeros. simpl. repeat split; auto.
      * destruct (are_zeros t H). lra.
      * destruct (are_zeros t H). lra.
      * apply are_zeros. assumption.
      * intros _ t t_in is_zero. destruct (Rle_or_lt t high) as [inside | ].
        -- exfalso. apply (here t); [ lra | assumption ].
        -- apply later; [ lra | assumption ].
    + destruct here as (z & (z_in & z_zero) & unique).
      exists (z :: zeros). simpl. repeat split.
      * constructor; [ | assumption ]. intros inside. destruct (are_zeros z inside). lra.
      * rewrite number. reflexivity.
      * destruct H as [<- | inside]; [ lra | destruct (are_zeros t inside); lra ].
      * destruct H as [<- | inside]; [ lra | destruct (are_zeros t inside); lra ].
      * destruct H as [<- | inside]; [ assumption | apply are_zeros; assumption ].
      * intros _ t t_in is_zero. destruct (Rle_or_lt t high) as [inside | ].
        -- left. symmetry. apply unique; [ lra | assumption ].
        -- right. apply later; [ lra | assumption ].
Qed.

(** ** A start at rest (8.10) *)

(** With ẍ = f − γ ẋ − q x, |q| ≤ Q, f(0) = 0 and f growing: if Q δ² < 1, then ẋ > 0 on (0, δ]. *)
Section FromRest.
Variables (X X1 f f' q : R -> R) (γ Q δ : R).
Hypothesis γ_nonneg : 0 <= γ.
Hypothesis X_derivative : forall t, 0 <= t <= δ -> is_derive X t (X1 t).
Hypothesis X1_derivative : forall t, 0 <= t <= δ -> is_derive X1 t (f t - γ * X1 t - q t * X t).
Hypothesis f_derivative : forall t, 0 <= t <= δ -> is_derive f t (f' t).
Hypothesis f_grows : forall t, 0 < t <= δ -> 0 < f' t.
Hypothesis q_bound : forall t, 0 <= t <= δ -> Rabs (q t) <= Q.
Hypothesis at_rest : X 0 = 0 /\ X1 0 = 0 /\ f 0 = 0.
Hypothesis short : Q * δ ^ 2 < 1.

Lemma f_positive t : 0 < t <= δ -> 0 < f t.
Proof.
  intros t_in. destruct at_rest as (_ & _ & <-).
  apply (strictly_rising f f'); [ lra | | ]; intros; [ apply f_derivative | apply f_grows ]; lra.
Qed.

Lemma f_monotone s t : 0 <= s <= t -> t <= δ -> 0 <= f s <= f t.
Proof.
  intros s_t t_δ. split.
  - destruct (Req_dec s 0) as [-> | ]; [ destruct at_rest as (_ & _ & ->); lra | ].
    left. apply f_positive. lra.
  - destruct (Req_dec s t) as [-> | ]; [ lra | left ].
    apply (strictly_rising f f'); [ lra | | ]; intros; [ apply f_derivative | apply f_grows ]; lra.
Qed.

(** ẋ(t) = ∫ e^{−γ(t−s)} (f − q x) ds, in the form of a mean value. *)
Lemma X1_mean t :
  0 < t <= δ -> exists m, 0 < m < t /\ X1 t = t * (exp (γ * (m - t)) * (f m - q m * X m)).
Proof.
  intros t_in.
  destruct (mean_value (fun s => exp (γ * (s - t)) * X1 s)
    (fun s => exp (γ * (s - t)) * (f s - q s * X s)) 0 t) as (m & m_in & value); [ lra | | ].
  - intros s s_in. eapply derive_eq.
    + apply (derive_mul (fun u => exp (γ * (u - t))) X1); [ apply derive_exp_at | apply X1_derivative; lra ].
    + simpl. ring.
  - exists m. split; [ lra | ].
    destruct at_rest as (_ & X1_0 & _). rewrite X1_0 in value.
    replace (t - t) with 0 in value by ring. rewrite !Rmult_0_r, exp_0 in value. lra.
Qed.

(** With M the largest |x| up to t and B = f(t) + Q M: |ẋ| ≤ s B, |x| ≤ ½ s² B. *)
Section UpTo.
Variables (t M : R).
Hypothesis t_in : 0 < t <= δ.
Hypothesis M_bound : forall s, 0 <= s <= t -> Rabs (X s) <= M.
Let B := f t + Q * M.

Lemma source_le s : 0 <= s <= t -> Rabs (f s - q s * X s) <= B.
Proof.
  intros s_in. assert (F := f_monotone s t s_in ltac:(lra)).
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp, Rabs_mult, Rabs_pos_eq by lra.
  assert (Rabs (q s) * Rabs (X s) <= Q * M)
    by (apply Rmult_le_compat; auto using Rabs_pos; apply q_bound; lra).
  unfold B. lra.
Qed.

Lemma B_nonneg : 0 <= B.
Proof. apply Rle_trans with (Rabs (f 0 - q 0 * X 0)); [ apply Rabs_pos | apply source_le; lra ]. Qed.

Lemma X1_le s : 0 <= s <= t -> Rabs (X1 s) <= s * B.
Proof.
  intros s_in. destruct (Req_dec s 0) as [-> | ].
  - destruct at_rest as (_ & -> & _). rewrite Rabs_R0. lra.
  - destruct (X1_mean s) as (m & m_in & ->); [ lra | ].
    rewrite !Rabs_mult, (Rabs_pos_eq s) by lra. rewrite Rabs_pos_eq by (left; apply exp_pos).
    apply Rmult_le_compat_l; [ lra | ].
    assert (small : exp (γ * (m - s)) <= 1) by (rewrite <- exp_0; apply exp_le; nra).
    assert (A := source_le m ltac:(lra)). assert (positive := exp_pos (γ * (m - s))).
    assert (exp (γ * (m - s)) * Rabs (f m - q m * X m) <= 1 * B)
      by (apply Rmult_le_compat; auto using Rabs_pos; lra).
    lra.
Qed.

Lemma X_le s : 0 <= s <= t -> Rabs (X s) <= / 2 * s ^ 2 * B.
Proof.
  intros s_in. destruct at_rest as (X_0 & _ & _).
  assert (parabola : forall u, is_derive (fun u => / 2 * B * (u * u)) u (/ 2 * B * (1 * u + u * 1)))
    by (intros u; apply derive_times, derive_mul; apply (is_derive_id (K := R_AbsRing))).
  apply Rabs_le. split.
  - assert (A : X 0 + / 2 * B * (0 * 0) <= X s + / 2 * B * (s * s)); [ | rewrite X_0 in A; simpl; lra ].
    apply (rising (fun u => X u + / 2 * B * (u * u)) (fun u => X1 u + / 2 * B * (1 * u + u * 1))); [ lra | | ].
    + intros u u_in. apply derive_add; [ apply X_derivative; lra | apply parabola ].
    + intros u u_in. assert (L := X1_le u ltac:(lra)). apply Rabs_bounds in L. lra.
  - assert (A : X s - / 2 * B * (s * s) <= X 0 - / 2 * B * (0 * 0)); [ | rewrite X_0 in A; simpl; lra ].
    apply (falling (fun u => X u - / 2 * B * (u * u)) (fun u => X1 u - / 2 * B * (1 * u + u * 1))); [ lra | | ].
    + intros u u_in. apply derive_sub; [ apply X_derivative; lra | apply parabola ].
    + intros u u_in. assert (L := X1_le u ltac:(lra)). apply Rabs_bounds in L. lra.
Qed.

End UpTo.

(** So M ≤ f t², |q x| < f: f − q x has the sign of f. *)
Lemma source_positive t : 0 < t <= δ -> 0 < f t - q t * X t.
Proof.
  intros t_in.
  destruct (continuity_ab_maj (fun s => Rabs (X s)) 0 t) as (top & largest & top_in); [ lra | | ].
  { intros s s_in. apply (continuity_pt_comp X Rabs); [ | apply Rcontinuity_abs ].
    apply (continuous_of_derive X s (X1 s)), X_derivative. lra. }
  set (M := Rabs (X top)) in *.
  assert (M_le := X_le t M t_in largest top top_in). fold M in M_le.
  assert (B_0 := B_nonneg t M t_in largest).
  assert (M_nonneg : 0 <= M) by apply Rabs_pos.
  assert (Q_nonneg : 0 <= Q) by (apply Rle_trans with (Rabs (q t)); [ apply Rabs_pos | apply q_bound; lra ]).
  assert (f_pos := f_positive t t_in).
  assert (top_sq : top ^ 2 <= t ^ 2) by (apply pow_incr; lra).
  assert (t_sq : t ^ 2 <= δ ^ 2) by (apply pow_incr; lra).
  assert (Qt : Q * t ^ 2 < 1).
  { assert (Q * t ^ 2 <= Q * δ ^ 2) by (apply Rmult_le_compat_l; assumption). lra. }
  assert (M_half : M <= / 2 * t ^ 2 * (f t + Q * M)).
  { apply Rle_trans with (1 := M_le). apply Rmult_le_compat_r; lra. }
  assert (M_small : M <= t ^ 2 * f t).
  { assert (M * (Q * t ^ 2) <= M * 1) by (apply Rmult_le_compat_l; lra). lra. }
  assert (qX : Rabs (q t * X t) <= Q * M).
  { rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos; [ apply q_bound; lra | apply largest; lra ]. }
  assert (QM : Q * M <= Q * (t ^ 2 * f t)) by (apply Rmult_le_compat_l; assumption).
  assert (less : Q * t ^ 2 * f t < 1 * f t) by (apply Rmult_lt_compat_r; assumption).
  apply Rabs_bounds in qX. lra.
Qed.

Theorem from_rest t : 0 < t <= δ -> 0 < X1 t.
Proof.
  intros t_in. destruct (X1_mean t t_in) as (m & m_in & ->).
  apply Rmult_lt_0_compat; [ lra | ]. apply Rmult_lt_0_compat; [ apply exp_pos | apply source_positive; lra ].
Qed.

End FromRest.

(** λ = |H|² + r·c, hence |q| = |λ − |Ω|²| ≤ Q = S² + |c|, as S ≥ |Ω|. *)
Lemma tension_is Ω c γ r H :
  r · r = 1 -> H · r = 0 ->
  tension (force Ω c γ r (v Ω r H)) r (v Ω r H) = H · H + r · c.
Proof.
  intros unit orthogonal.
  set (w := v Ω r H).
  assert (H_r : (H × r = w + Ω × r)%V) by (unfold w, v, r_rate; vec_ring).
  assert (H_sq : H · H = (w + Ω × r) · (w + Ω × r)).
  { rewrite <- H_r, lagrange, unit, orthogonal. ring. }
  assert (rw : r · w = 0) by (unfold w, v, r_rate; vec_ring).
  rewrite H_sq. clearbody w. unfold tension, force.
  replace (w · w + r · (c - Ω × (Ω × r) - 2 * (Ω × w) - γ * w))
    with ((w + Ω × r) · (w + Ω × r) + r · c - γ * (r · w)) by vec_ring.
  rewrite rw. ring.
Qed.

Lemma q_le Ω c γ r H S :
  r · r = 1 -> H · r = 0 -> `|H| <= S -> `|Ω| <= S ->
  Rabs (tension (force Ω c γ r (v Ω r H)) r (v Ω r H) - `|Ω| ^ 2) <= S ^ 2 + `|c|.
Proof.
  intros unit orthogonal H_le Ω_le. rewrite tension_is by assumption. rewrite <- norm_sq.
  assert (rc : Rabs (r · c) <= 1 * `|c|) by (apply dot_abs_le; [ rewrite norm_unit; auto; lra | lra ]).
  apply Rabs_bounds in rc.
  assert (A := norm_nonneg H). assert (B := norm_nonneg Ω).
  assert (H_sq : `|H| * `|H| <= S * S) by (apply Rmult_le_compat; assumption).
  assert (Ω_sq : `|Ω| * `|Ω| <= S * S) by (apply Rmult_le_compat; assumption).
  assert (0 <= `|H| * `|H|) by (apply Rmult_le_pos; assumption).
  assert (0 <= `|Ω| * `|Ω|) by (apply Rmult_le_pos; assumption).
  apply Rabs_le. simpl. lra.
Qed.

(** The x component of r'' = F − λ r, where Ω and c have none: ẍ = f − γ ẋ − q x with f = 2 (Ω_w ṁ − Ω_m ẇ) and
    q = λ − |Ω|². The axes x, m, w are the components x, y, z. *)
Lemma x_of_newton Ω c γ r H :
  x Ω = 0 -> x c = 0 -> r · r = 1 -> H · r = 0 ->
  x (r'' Ω c γ r H) =
  2 * (z Ω * y (v Ω r H) - y Ω * z (v Ω r H)) - γ * x (v Ω r H)
  - (tension (force Ω c γ r (v Ω r H)) r (v Ω r H) - `|Ω| ^ 2) * x r.
Proof.
  intros x_Ω x_c unit orthogonal. unfold r''. unfold v at 1.
  rewrite (newton Ω c γ r H unit orthogonal). fold (v Ω r H).
  replace (`|Ω| ^ 2) with (Ω · Ω) by (rewrite <- norm_sq; ring).
  generalize (tension (force Ω c γ r (v Ω r H)) r (v Ω r H)). intros λ.
  generalize (v Ω r H). intros u. unfold force. unfold_vec. rewrite x_Ω, x_c. ring.
Qed.

(** (8.10) At a release at rest with x0 = 0, the first leaf (0, δ] is E with the sign of u = Ω_w m̈ − Ω_m ẅ, if u has
    one on it and Q δ² < 1. *)
Theorem equation_8_10 Ω c γ r H S δ σ :
  0 <= γ -> motion Ω c γ r H 0 δ ->
  x Ω = 0 -> x c = 0 -> x (r 0) = 0 -> v Ω (r 0) (H 0) = zero ->
  (forall t, 0 <= t <= δ -> `|H t| <= S) -> `|Ω| <= S ->
  (S ^ 2 + `|c|) * δ ^ 2 < 1 ->
  (forall t, 0 < t <= δ ->
    0 < σ * (z Ω * y (r'' Ω c γ (r t) (H t)) - y Ω * z (r'' Ω c γ (r t) (H t)))) ->
  forall t, 0 < t <= δ -> 0 < σ * x (v Ω (r t) (H t)).
Proof.
  intros γ_nonneg is_motion x_Ω x_c x_0 rest S_bound Ω_le short sign.
  assert (unit := on_sphere _ _ _ _ _ _ _ is_motion).
  assert (orthogonal := H_orthogonal _ _ _ _ _ _ _ is_motion).
  apply (from_rest (fun t => σ * x (r t)) (fun t => σ * x (v Ω (r t) (H t)))
    (fun t => σ * (2 * (z Ω * y (v Ω (r t) (H t)) - y Ω * z (v Ω (r t) (H t)))))
    (fun t => σ * (2 * (z Ω * y (r'' Ω c γ (r t) (H t)) - y Ω * z (r'' Ω c γ (r t) (H t)))))
    (fun t => tension (force Ω c γ (r t) (v Ω (r t) (H t))) (r t) (v Ω (r t) (H t)) - `|Ω| ^ 2)
    γ (S ^ 2 + `|c|) δ); auto.
  - intros t t_in. destruct (motion_r _ _ _ _ _ _ _ is_motion t t_in) as (x_rate & _ & _).
    apply derive_times. exact x_rate.
  - intros t t_in. destruct (v_rate Ω c γ r H 0 δ t is_motion t_in) as (x_rate & _ & _). eapply derive_eq.
    + apply derive_times. exact x_rate.
    + rewrite x_of_newton by auto. ring.
  - intros t t_in. destruct (v_rate Ω c γ r H 0 δ t is_motion t_in) as (_ & y_rate & z_rate).
    apply derive_times, derive_times, derive_sub; apply derive_times; assumption.
  - intros t t_in. specialize (sign t t_in). lra.
  - intros t t_in. apply q_le; auto.
  - rewrite rest, x_0. simpl. repeat split; ring.
Qed.
