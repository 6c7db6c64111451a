(** Section 10 of THEOREM.md: of Lemma 10.3 the sizes of the errors, and (10.3c). An operation is off by at most ε of its
    exact result; κ is what is left for terms of second order, 2⁻²⁰ in `HALF`. *)

From Coq Require Import Reals Lra Psatz List.
From Coquelicot Require Import Coquelicot.
From Foucault Require Import Curves Section10_Clenshaw.
Open Scope R_scope.
Import ListNotations.

(** ** Weighted sums of |c_j| *)

Definition one (_ : nat) : R := 1.

Lemma weighted_nonneg m k c : (forall j, (k <= j)%nat -> 0 <= m j) -> 0 <= weighted m k c.
Proof.
  revert k. induction c as [ | c0 c IH]; intros k m_nonneg; simpl; [ lra | ].
  assert (0 <= m k * Rabs c0) by (apply Rmult_le_pos; [ apply m_nonneg; lia | apply Rabs_pos ]).
  assert (0 <= weighted m (S k) c) by (apply IH; intros; apply m_nonneg; lia). lra.
Qed.

Lemma weighted_le m m' k c :
  (forall j, (k <= j < k + length c)%nat -> m j <= m' j) -> weighted m k c <= weighted m' k c.
Proof.
  revert k. induction c as [ | c0 c IH]; intros k m_le; simpl in *; [ lra | ].
  assert (m k * Rabs c0 <= m' k * Rabs c0) by (apply Rmult_le_compat_r; [ apply Rabs_pos | apply m_le; lia ]).
  assert (weighted m (S k) c <= weighted m' (S k) c) by (apply IH; intros; apply m_le; lia). lra.
Qed.

Lemma weighted_ext m m' k c : (forall j, m j = m' j) -> weighted m k c = weighted m' k c.
Proof.
  intros same. revert k. induction c as [ | c0 c IH]; intros k; simpl; [ reflexivity | ]. rewrite IH, same. reflexivity.
Qed.

Lemma weighted_linear m m' a k c :
  weighted (fun j => a * m j + m' j) k c = a * weighted m k c + weighted m' k c.
Proof. revert k. induction c as [ | c0 c IH]; intros k; simpl; [ ring | ]. rewrite IH. ring. Qed.

Lemma weighted_times m a k c : weighted (fun j => a * m j) k c = a * weighted m k c.
Proof. revert k. induction c as [ | c0 c IH]; intros k; simpl; [ ring | ]. rewrite IH. ring. Qed.

Lemma weighted_shift m m' k c :
  (forall j, m (S j) = m' j) -> weighted m (S k) c = weighted m' k c.
Proof.
  intros shifted. revert k. induction c as [ | c0 c IH]; intros k; simpl; [ reflexivity | ].
  rewrite IH, shifted. reflexivity.
Qed.

(** A = Σ|c_j|, and B_k = Σ_{j ≥ k} (j − k + 1)|c_j| for the coefficients from c_k on. *)
Definition A (c : list R) : R := weighted one 0 c.
Definition B (c : list R) : R := weighted INR 1 c.

Lemma A_any k c : weighted one k c = A c.
Proof.
  unfold A. induction k as [ | k IH]; [ reflexivity | ]. rewrite <- IH. apply weighted_shift. reflexivity.
Qed.

Lemma A_nonneg c : 0 <= A c. Proof. apply weighted_nonneg. intros. unfold one. lra. Qed.
Lemma B_nonneg c : 0 <= B c. Proof. apply weighted_nonneg. intros. apply pos_INR. Qed.

(** B_k = |c_k| + A + B_{k+1}, A of the coefficients after c_k. *)
Lemma weighted_2 c : weighted INR 2 c = A c + B c.
Proof.
  unfold B. rewrite <- (A_any 1 c).
  rewrite (weighted_shift INR (fun j => 1 * one j + INR j) 1 c) by (intros; rewrite S_INR; unfold one; ring).
  rewrite weighted_linear. ring.
Qed.

Lemma B_cons c0 c : B (c0 :: c) = Rabs c0 + A c + B c.
Proof.
  change (B (c0 :: c)) with (INR 1 * Rabs c0 + weighted INR 2 c). rewrite weighted_2. change (INR 1) with 1. ring.
Qed.

(** The error of the line of c_k, in units of ε and to first order: 2B_{k+1} of the product, B_k − |c_k| of the difference, B_k of the
    sum. *)
Definition of_line (c0 : R) (c : list R) : R := 2 * B c + (A c + B c) + B (c0 :: c).

Fixpoint of_lines (c : list R) : R :=
  match c with [] => 0 | c0 :: c => of_line c0 c + of_lines c end.

(** Together these are 2j² − 1 of |c_j|. *)
Lemma of_lines_are c : of_lines c = weighted (fun j => 2 * INR j ^ 2 - 1) 1 c.
Proof.
  induction c as [ | c0 c IH]; [ reflexivity | ].
  change (of_lines (c0 :: c)) with (of_line c0 c + of_lines c). rewrite IH. unfold of_line. rewrite B_cons.
  change (weighted (fun j => 2 * INR j ^ 2 - 1) 1 (c0 :: c))
    with ((2 * INR 1 ^ 2 - 1) * Rabs c0 + weighted (fun j => 2 * INR j ^ 2 - 1) 2 c).
  change (INR 1) with 1. rewrite (weighted_shift _ (fun j => 4 * INR j + (2 * one j + (2 * INR j ^ 2 - 1))) 1 c)
    by (intros; rewrite S_INR; unfold one; ring).
  rewrite !weighted_linear, A_any. fold (B c). ring.
Qed.

Section Sizes.
Variables (rnd : R -> R) (ε κ u : R) (N : nat).
Hypothesis ε_nonneg : 0 <= ε.
Hypothesis ε_small : ε <= / 16.
Hypothesis κ_nonneg : 0 <= κ.
Hypothesis relative : forall v, Rabs (rnd v - v) <= ε * Rabs v.
Hypothesis u_le : Rabs u <= 1.

(** θ is of second order: the errors of all lines, as they come back through the sums. *)
Let θ := 2 * INR N * (INR N + 1) * (1 + κ) * ε.
Hypothesis second_order : (1 + θ) * (1 + 3 * ε) <= 1 + κ.

Lemma θ_nonneg : 0 <= θ.
Proof.
  assert (P := pos_INR N). unfold θ.
  apply Rmult_le_pos; [ | assumption ]. apply Rmult_le_pos; [ | lra ]. apply Rmult_le_pos; lra.
Qed.

(** Three operations on exact x, with factors: the product is off by ε|x1|, and so on. *)
Lemma three_operations x1 x c0 b1 :
  let p := rnd x1 in let y := x1 - b1 in
  Rabs x1 <= (1 + θ) * x -> 0 <= x ->
  forall g, 0 <= g -> Rabs y <= (1 + θ) * g ->
  Rabs (rnd (rnd (p - b1) + c0) - (y + c0)) <= (1 + κ) * ε * (x + g + (g + Rabs c0)).
Proof.
  intros p y x1_le x_nonneg g g_nonneg y_le.
  assert (T0 := θ_nonneg).
  assert (e1 := relative x1). fold p in e1.
  assert (e2 := relative (p - b1)). set (q := rnd (p - b1)) in *.
  assert (e3 := relative (q + c0)). set (s := rnd (q + c0)) in *.
  assert (c0_nonneg := Rabs_pos c0).
  assert (E1 : Rabs (p - x1) <= ε * ((1 + θ) * x)) by (apply Rle_trans with (1 := e1); apply Rmult_le_compat_l; assumption).
  assert (P : Rabs (p - b1) <= (1 + θ) * g + ε * ((1 + θ) * x)).
  { replace (p - b1) with (y + (p - x1)) by (unfold y; ring). apply Rle_trans with (1 := Rabs_triang _ _). lra. }
  assert (E2 : Rabs (q - (p - b1)) <= ε * ((1 + θ) * g + ε * ((1 + θ) * x)))
    by (apply Rle_trans with (1 := e2); apply Rmult_le_compat_l; assumption).
  assert (Q : Rabs (q + c0) <= (1 + θ) * g + ε * ((1 + θ) * x) + ε * ((1 + θ) * g + ε * ((1 + θ) * x)) + Rabs c0).
  { replace (q + c0) with ((p - b1) + (q - (p - b1)) + c0) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat_r.
    apply Rle_trans with (1 := Rabs_triang _ _). lra. }
  assert (E3 : Rabs (s - (q + c0)) <= ε * ((1 + θ) * g + ε * ((1 + θ) * x) + ε * ((1 + θ) * g + ε * ((1 + θ) * x)) + Rabs c0))
    by (apply Rle_trans with (1 := e3); apply Rmult_le_compat_l; assumption).
  assert (sum : Rabs (s - (y + c0)) <= Rabs (p - x1) + Rabs (q - (p - b1)) + Rabs (s - (q + c0))).
  { replace (s - (y + c0)) with ((p - x1) + (q - (p - b1)) + (s - (q + c0))) by (unfold y; ring).
    apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat_r. apply Rabs_triang. }
  apply Rle_trans with (1 := sum).
  apply Rle_trans with ((1 + θ) * (1 + 3 * ε) * ε * (x + g + (g + Rabs c0))).
  - assert (0 <= (1 + θ) * ε) by (apply Rmult_le_pos; lra).
    assert (0 <= ε * Rabs c0) by (apply Rmult_le_pos; lra).
    assert (0 <= θ * (ε * Rabs c0)) by (apply Rmult_le_pos; lra).
    assert (0 <= (1 + θ) * ε * (ε * Rabs c0)) by (apply Rmult_le_pos; assumption).
    assert (0 <= (1 + θ) * ε * (ε * x)) by (apply Rmult_le_pos; [ assumption | apply Rmult_le_pos; lra ]).
    assert (0 <= (1 + θ) * ε * (ε * g)) by (apply Rmult_le_pos; [ assumption | apply Rmult_le_pos; lra ]).
    assert (0 <= (1 + θ) * ε * (ε * x) * (1 - ε)) by (apply Rmult_le_pos; [ assumption | lra ]).
    lra.
  - apply Rmult_le_compat_r; [ lra | ]. apply Rmult_le_compat_r; lra.
Qed.
(** j ≤ N in a list of at most N coefficients. *)
Lemma j_le_N j (c : list R) : (1 <= j < 1 + length c)%nat -> (length c <= N)%nat -> 1 <= INR j <= INR N.
Proof. intros. split; [ change 1 with (INR 1) | ]; apply le_INR; lia. Qed.

(** Σ (2j² − 1)|c_j| is at most 2N B and 2N² A, and B at most N A. *)
Lemma of_lines_le_B c : (length c <= N)%nat -> of_lines c <= 2 * INR N * B c.
Proof.
  intros short. rewrite of_lines_are. unfold B. rewrite <- weighted_times.
  apply weighted_le. intros j j_in. assert (J := j_le_N j c j_in short). nra.
Qed.

Lemma of_lines_le_A c : (length c <= N)%nat -> of_lines c <= 2 * INR N ^ 2 * A c.
Proof.
  intros short. rewrite of_lines_are. rewrite <- (A_any 1), <- weighted_times.
  apply weighted_le. intros j j_in. assert (J := j_le_N j c j_in short). unfold one. nra.
Qed.

Lemma B_le_A c : (length c <= N)%nat -> B c <= INR N * A c.
Proof.
  intros short. unfold B. rewrite <- (A_any 1), <- weighted_times.
  apply weighted_le. intros j j_in. assert (J := j_le_N j c j_in short). unfold one. lra.
Qed.

(** If the errors δ_k of all lines are as large as that together, they come back through the sums as θ of B. *)
Lemma they_come_back c :
  (length c <= N)%nat -> A (errors rnd u c) <= (1 + κ) * ε * of_lines c ->
  Rabs (fst (rounded rnd u c)) <= (1 + θ) * B c
  /\ Rabs (2 * u * fst (rounded rnd u c) - snd (rounded rnd u c)) <= (1 + θ) * (A c + B c).
Proof.
  intros short total.
  assert (N_nonneg := pos_INR N).
  assert (κε : 0 <= (1 + κ) * ε) by (apply Rmult_le_pos; lra).
  assert (same := errors_length rnd u c).
  assert (δ_short : (length (errors rnd u c) <= N)%nat) by (rewrite <- same; assumption).
  assert (B_δ := B_le_A _ δ_short). assert (lines := of_lines_le_B c short). assert (B_0 := B_nonneg c).
  assert (A_0 := A_nonneg c). assert (Aδ_0 := A_nonneg (errors rnd u c)). assert (T0 := θ_nonneg).
  assert (back : (INR N + 1) * A (errors rnd u c) <= θ * B c).
  { apply Rle_trans with ((INR N + 1) * ((1 + κ) * ε * (2 * INR N * B c))).
    - apply Rmult_le_compat_l; [ lra | ]. apply Rle_trans with (1 := total). apply Rmult_le_compat_l; assumption.
    - right. unfold θ. ring. }
  assert (S_size : forall j, Rabs (S_ j u) <= INR j) by (intros; apply S_le; assumption).
  split.
  - rewrite rounded_is_exact, clenshaw_rate, series_added by assumption.
    apply Rle_trans with (1 := Rabs_triang _ _).
    assert (first := series_le (fun k => S_ k u) INR 1 c S_size).
    assert (second := series_le (fun k => S_ k u) INR 1 (errors rnd u c) S_size).
    fold (B c) in first. fold (B (errors rnd u c)) in second. lra.
  - assert (sum : 2 * u * fst (rounded rnd u c) - snd (rounded rnd u c)
      = series (fun k => S_ k u) 2 (added c (errors rnd u c))).
    { rewrite (sums_are u (fun k => S_ k u) _ 1 (S_recurrent u)), <- rounded_is_exact. simpl. ring. }
    rewrite sum, series_added by assumption.
    apply Rle_trans with (1 := Rabs_triang _ _).
    assert (first := series_le (fun k => S_ k u) INR 2 c S_size).
    assert (second := series_le (fun k => S_ k u) INR 2 (errors rnd u c) S_size).
    rewrite weighted_2 in first, second.
    assert (0 <= θ * A c) by (apply Rmult_le_pos; assumption). lra.
Qed.

Lemma A_cons c0 c : A (c0 :: c) = Rabs c0 + A c.
Proof.
  change (A (c0 :: c)) with (one 0 * Rabs c0 + weighted one 1 c). rewrite A_any. unfold one. ring.
Qed.

(** The errors δ_k of all lines are at most ε Σ (2k² − 1)|c_k|, but for second orders. *)
Lemma errors_le c : (length c <= N)%nat -> A (errors rnd u c) <= (1 + κ) * ε * of_lines c.
Proof.
  induction c as [ | c0 c IH]; intros short; [ unfold A; simpl; lra | ].
  simpl in short. assert (shorter : (length c <= N)%nat) by lia. specialize (IH shorter).
  destruct (they_come_back c shorter IH) as [b_le y_le].
  change (of_lines (c0 :: c)) with (of_line c0 c + of_lines c).
  simpl errors. destruct (rounded rnd u c) as [b1 b2]. simpl in b_le, y_le.
  rewrite A_cons.
  assert (B_0 := B_nonneg c). assert (A_0 := A_nonneg c). assert (T0 := θ_nonneg).
  assert (x1 : Rabs (2 * u * b1) <= (1 + θ) * (2 * B c)).
  { rewrite Rabs_mult, Rabs_mult, (Rabs_pos_eq 2) by lra.
    assert (Rabs u * Rabs b1 <= 1 * ((1 + θ) * B c)) by (apply Rmult_le_compat; auto using Rabs_pos). lra. }
  assert (this := three_operations (2 * u * b1) (2 * B c) c0 b2 x1 ltac:(lra) (A c + B c) ltac:(lra) y_le).
  assert (line_is : of_line c0 c = 2 * B c + (A c + B c) + (A c + B c + Rabs c0))
    by (unfold of_line; rewrite B_cons; ring).
  rewrite line_is. unfold line. cbv zeta in this. lra.
Qed.

(** The value is off from C(û) by at most ε Σ (2k² + k + 1)|c_k|, but for second orders. *)
Theorem value_at_u c0 c :
  (length c <= N)%nat ->
  Rabs (rnd (rnd (rnd (u * fst (rounded rnd u c)) - snd (rounded rnd u c)) + c0) - series (fun k => T k u) 0 (c0 :: c))
  <= (1 + κ) * ε * weighted (fun k => 2 * INR k ^ 2 + INR k + 1) 0 (c0 :: c).
Proof.
  intros short. assert (total := errors_le c short).
  destruct (they_come_back c short total) as [b_le _].
  assert (off := value_is_off rnd u c0 c u_le).
  assert (A_0 := A_nonneg c). assert (T0 := θ_nonneg). assert (N_nonneg := pos_INR N).
  assert (κε : 0 <= (1 + κ) * ε) by (apply Rmult_le_pos; lra).
  assert (y_le : Rabs (u * fst (rounded rnd u c) - snd (rounded rnd u c)) <= (1 + θ) * A c).
  { assert (sum : u * fst (rounded rnd u c) - snd (rounded rnd u c)
      = series (fun k => T k u) 1 (added c (errors rnd u c))).
    { rewrite (sums_are u (fun k => T k u) _ 0 (T_recurrent u)), <- rounded_is_exact. simpl. ring. }
    rewrite sum, series_added by apply errors_length.
    apply Rle_trans with (1 := Rabs_triang _ _).
    assert (T_size : forall j, Rabs (T j u) <= one j) by (intros; apply T_le; assumption).
    assert (first := series_le (fun k => T k u) one 1 c T_size).
    assert (second := series_le (fun k => T k u) one 1 (errors rnd u c) T_size).
    rewrite A_any in first, second.
    assert (small : A (errors rnd u c) <= θ * A c).
    { apply Rle_trans with (1 := total).
      apply Rle_trans with ((1 + κ) * ε * (2 * INR N ^ 2 * A c)).
      - apply Rmult_le_compat_l; [ assumption | apply of_lines_le_A; assumption ].
      - assert (0 <= (1 + κ) * ε * (2 * INR N * A c)) by (apply Rmult_le_pos; [ assumption | apply Rmult_le_pos; lra ]).
        unfold θ. lra. }
    lra. }
  destruct (rounded rnd u c) as [b1 b2]. simpl fst in *. simpl snd in *. cbv zeta in off.
  assert (x1 : Rabs (u * b1) <= (1 + θ) * B c).
  { rewrite Rabs_mult. assert (Rabs u * Rabs b1 <= 1 * ((1 + θ) * B c)) by (apply Rmult_le_compat; auto using Rabs_pos). lra. }
  assert (last := three_operations (u * b1) (B c) c0 b2 x1 (B_nonneg c) (A c) A_0 y_le). cbv zeta in last.
  apply Rle_trans with (1 := off).
  change (weighted (fun _ : nat => 1)) with (weighted one).
  match goal with |- weighted one 0 (?δ0 :: ?δ) <= _ => change (weighted one 0 (δ0 :: δ)) with (A (δ0 :: δ)) end.
  rewrite A_cons.
  change (weighted (fun k => 2 * INR k ^ 2 + INR k + 1) 0 (c0 :: c))
    with ((2 * INR 0 ^ 2 + INR 0 + 1) * Rabs c0 + weighted (fun k => 2 * INR k ^ 2 + INR k + 1) 1 c).
  change (INR 0) with 0.
  assert (split : weighted (fun k => 2 * INR k ^ 2 + INR k + 1) 1 c = of_lines c + B c + 2 * A c).
  { rewrite of_lines_are, <- (A_any 1 c). unfold B.
    rewrite <- !weighted_times.
    transitivity (weighted (fun j => 1 * (2 * INR j ^ 2 - 1) + (1 * INR j + 2 * one j)) 1 c).
    - apply weighted_ext. intros j. unfold one. ring.
    - rewrite !weighted_linear, !weighted_times. ring. }
  rewrite split. lra.
Qed.

(** (10.3c): û for u costs λε Σ k²|c_k| more. *)
Theorem equation_10_3c v λ c0 c :
  (length c <= N)%nat -> 0 <= λ -> Rabs v <= 1 -> Rabs (u - v) <= λ * ε ->
  Rabs (rnd (rnd (rnd (u * fst (rounded rnd u c)) - snd (rounded rnd u c)) + c0) - series (fun k => T k v) 0 (c0 :: c))
  <= (1 + κ) * ε * weighted (fun k => (2 + λ) * INR k ^ 2 + INR k + 1) 0 (c0 :: c).
Proof.
  intros short λ_nonneg v_le near.
  assert (value := value_at_u c0 c short).
  assert (moved := variable_is_off v u (c0 :: c) 0 v_le u_le).
  set (computed := rnd (rnd (rnd (u * fst (rounded rnd u c)) - snd (rounded rnd u c)) + c0)) in *.
  replace (computed - series (fun k => T k v) 0 (c0 :: c))
    with ((computed - series (fun k => T k u) 0 (c0 :: c))
      + (series (fun j => T j u) 0 (c0 :: c) - series (fun j => T j v) 0 (c0 :: c))) by ring.
  apply Rle_trans with (1 := Rabs_triang _ _).
  assert (squares : 0 <= weighted (fun j => INR j ^ 2) 0 (c0 :: c))
    by (apply weighted_nonneg; intros; apply pow2_ge_0).
  assert (cost : Rabs (u - v) * weighted (fun j => INR j ^ 2) 0 (c0 :: c)
    <= (1 + κ) * (λ * ε) * weighted (fun j => INR j ^ 2) 0 (c0 :: c)).
  { apply Rmult_le_compat_r; [ assumption | ].
    assert (0 <= κ * (λ * ε)) by (apply Rmult_le_pos; [ | apply Rmult_le_pos ]; lra). lra. }
  assert (sum : weighted (fun k => (2 + λ) * INR k ^ 2 + INR k + 1) 0 (c0 :: c)
    = λ * weighted (fun j => INR j ^ 2) 0 (c0 :: c) + weighted (fun k => 2 * INR k ^ 2 + INR k + 1) 0 (c0 :: c)).
  { rewrite <- weighted_linear. apply weighted_ext. intros j. ring. }
  rewrite sum. lra.
Qed.

End Sizes.

(** `HALF` has κ = 2⁻²⁰ and ε = 2⁻⁵³: enough up to the degree 10,000. *)
Lemma second_order_of_HALF N :
  INR N <= 10000 ->
  (1 + 2 * INR N * (INR N + 1) * (1 + / 2 ^ 20) * / 2 ^ 53) * (1 + 3 * / 2 ^ 53) <= 1 + / 2 ^ 20.
Proof.
  intros N_le. assert (N_nonneg := pos_INR N).
  assert (square : INR N * (INR N + 1) <= 10000 * 10001) by (apply Rmult_le_compat; lra).
  replace (/ 2 ^ 20) with (/ 1048576) by (f_equal; ring).
  replace (/ 2 ^ 53) with (/ 9007199254740992) by (f_equal; ring).
  lra.
Qed.
