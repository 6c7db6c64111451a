(** Section 10 of THEOREM.md: Lemma 10.2, the variable of a series in doubles, with Flocq's model of binary64: rounding to
    nearest, ties to even, with subnormal numbers and without an overflow. Lemma 10.3 is in
    Section10_Clenshaw. *)

From Coq Require Import Reals Lra Psatz ZArith Lia.
From Flocq Require Import Core Plus_error Relative Sterbenz.
Open Scope R_scope.

Definition double_exponent : Z -> Z := FLT_exp (-1074) 53.
Notation double := (generic_format radix2 double_exponent).
Notation rnd := (round radix2 double_exponent ZnearestE).
Definition ε : R := bpow radix2 (-53).

#[export] Instance prec_53 : Prec_gt_0 53. Proof. reflexivity. Qed.
#[export] Instance double_valid : Valid_exp double_exponent. Proof. apply FLT_exp_valid. exact prec_53. Qed.
#[export] Instance double_monotone : Monotone_exp double_exponent. Proof. apply FLT_exp_monotone. Qed.

Lemma ε_small : 0 < ε < / 16.
Proof.
  unfold ε. split; [ apply bpow_gt_0 | ].
  replace (/ 16) with (bpow radix2 (-4)) by (simpl; lra). apply bpow_lt. lia.
Qed.

Lemma two_ε : bpow radix2 (-52) = 2 * ε.
Proof. unfold ε. change (-52)%Z with (1 + -53)%Z. rewrite bpow_plus. simpl (bpow radix2 1). lra. Qed.

(** A result of at most 1 in size is off by at most ε, also where it underflows. *)
Lemma error_below_1 q : Rabs q <= 1 -> Rabs (rnd q - q) <= ε.
Proof.
  intros q_le. apply Rle_trans with (1 := error_le_half_ulp radix2 double_exponent _ q).
  apply Rle_trans with (/ 2 * ulp radix2 double_exponent 1).
  - apply Rmult_le_compat_l; [ lra | ]. apply ulp_le; [ exact double_valid | exact double_monotone | ].
    rewrite Rabs_R1. exact q_le.
  - change 1 with (bpow radix2 0). rewrite ulp_bpow. right. unfold ε.
    change (double_exponent (0 + 1)) with (-52)%Z.
    fold ε. rewrite two_ε. lra.
Qed.

(** A sum of doubles is off by at most ε of itself: a small one is exact. *)
Lemma sum_error x y : double x -> double y -> exists δ, Rabs δ <= ε /\ rnd (x + y) = (x + y) * (1 + δ).
Proof.
  intros x_double y_double.
  destruct (FLT_plus_error_N_ex radix2 (-1074) 53 (fun n => negb (Z.even n)) x y x_double y_double)
    as (δ & δ_le & value).
  exists δ. split; [ | exact value ].
  apply Rle_trans with (1 := δ_le).
  assert (u : u_ro radix2 53 = ε).
  { change (u_ro radix2 53) with (/ 2 * bpow radix2 (-52)). rewrite two_ε. lra. }
  rewrite u. assert (E := ε_small).
  apply Rmult_le_reg_r with (1 + ε); [ lra | ].
  replace (ε / (1 + ε) * (1 + ε)) with ε by (field; lra). nra.
Qed.

Lemma difference_error x y : double x -> double y -> exists δ, Rabs δ <= ε /\ rnd (x - y) = (x - y) * (1 + δ).
Proof. intros. apply (sum_error x (- y)); [ assumption | apply generic_format_opp; assumption ]. Qed.

(** ** Lemma 10.2

    u is evaluated as û = ((t − a) − (b − t))/(b − a), for a ≤ t ≤ b. *)
Section Variable_u.
Variables (a t b : R).
Hypothesis a_double : double a.
Hypothesis t_double : double t.
Hypothesis b_double : double b.
Hypothesis a_t : a <= t.
Hypothesis t_b : t <= b.
Hypothesis a_b : a < b.

Definition u : R := ((t - a) - (b - t)) / (b - a).
Definition numerator : R := rnd (rnd (t - a) - rnd (b - t)).
Definition width : R := rnd (b - a).
Definition u_hat : R := rnd (numerator / width).

Lemma rnd_le x y : x <= y -> rnd x <= rnd y.
Proof. apply round_le; [ exact double_valid | apply valid_rnd_N ]. Qed.

Lemma rnd_double x : double x -> rnd x = x.
Proof. apply round_generic, valid_rnd_N. Qed.

Lemma rnd_is_double x : double (rnd x).
Proof. apply generic_format_round; [ exact double_valid | apply valid_rnd_N ]. Qed.

Lemma rnd_nonneg x : 0 <= x -> 0 <= rnd x.
Proof. intros. rewrite <- (rnd_double 0) by apply generic_format_0. apply rnd_le. assumption. Qed.

Lemma width_pos : 0 < width.
Proof.
  assert (nonneg : 0 <= width) by (apply rnd_nonneg; lra).
  assert (width <> 0); [ | lra ].
  apply (round_plus_neq_0 radix2 double_exponent ZnearestE b (- a)); [ assumption | | lra ].
  apply generic_format_opp. assumption.
Qed.

(** Rounding is monotone: t − a is at most the rounded width, b − t ≥ 0, so the numerator is at most the width in size. *)
Lemma numerator_le : - width <= numerator <= width.
Proof.
  assert (A : 0 <= rnd (t - a) <= width) by (split; [ apply rnd_nonneg | apply rnd_le ]; lra).
  assert (B : 0 <= rnd (b - t) <= width) by (split; [ apply rnd_nonneg | apply rnd_le ]; lra).
  assert (W : rnd width = width) by (apply rnd_double, rnd_is_double).
  assert (mW : rnd (- width) = - width)
    by (apply rnd_double, generic_format_opp, rnd_is_double).
  unfold numerator. split.
  - rewrite <- mW at 1. apply rnd_le. lra.
  - rewrite <- W at 1. apply rnd_le. lra.
Qed.

Lemma quotient_le : -1 <= numerator / width <= 1.
Proof.
  assert (W := width_pos). assert (N := numerator_le).
  split; apply Rmult_le_reg_r with width; try assumption;
    replace (numerator / width * width) with numerator by (field; lra); lra.
Qed.

Theorem lemma_10_2_inside : Rabs u_hat <= 1.
Proof.
  assert (one : double 1) by (apply (generic_format_FLT_1 radix2 (-1074) 53); discriminate).
  assert (m_one : double (-1)) by (apply (generic_format_opp _ _ 1); assumption).
  assert (Q := quotient_le).
  assert (low : -1 <= u_hat) by (rewrite <- (rnd_double (-1) m_one); apply rnd_le; lra).
  assert (high : u_hat <= 1) by (rewrite <- (rnd_double 1 one); apply rnd_le; lra).
  apply Rabs_le. lra.
Qed.

Lemma u_le : Rabs u <= 1.
Proof.
  apply Rabs_le. unfold u.
  split; apply Rmult_le_reg_r with (b - a); try lra;
    replace ((t - a - (b - t)) / (b - a) * (b - a)) with (t - a - (b - t)) by (field; lra); lra.
Qed.

(** If 2a ≥ b, all three are multiples of the last place of a and at most a: the differences are exact, and so is the
    numerator. *)
Section Near.
Hypothesis near : b <= 2 * a.

Lemma a_pos : 0 < a. Proof. lra. Qed.

(** The exponent of the last place of a. *)
Let place := double_exponent (mag radix2 a).

Lemma multiple_of_place v : double v -> a <= v -> exists n, v = IZR n * bpow radix2 place.
Proof.
  intros v_double a_v.
  assert (fixed : generic_format radix2 (FIX_exp place) v).
  { apply (generic_inclusion_mag radix2 double_exponent (FIX_exp place)); [ | assumption ].
    intros _. apply double_monotone. apply mag_le; [ exact a_pos | assumption ]. }
  apply FIX_format_generic in fixed. destruct fixed as [f value exponent].
  exists (Fnum f). rewrite value. unfold F2R. rewrite exponent. reflexivity.
Qed.

Lemma numerator_exact : double ((t - a) - (b - t)).
Proof.
  destruct (multiple_of_place a a_double (Rle_refl a)) as [i a_is].
  destruct (multiple_of_place t t_double a_t) as [j t_is].
  destruct (multiple_of_place b b_double ltac:(lra)) as [k b_is].
  assert (fixed : generic_format radix2 (FIX_exp place) ((t - a) - (b - t))).
  { apply generic_format_FIX. exists (Float radix2 (2 * j - i - k) place); [ | reflexivity ].
    rewrite a_is, t_is, b_is. unfold F2R. cbn [Fnum Fexp]. rewrite !minus_IZR, mult_IZR. ring. }
  apply (generic_inclusion_mag radix2 (FIX_exp place) double_exponent); [ | exact fixed ].
  intros different. change (double_exponent (mag radix2 (t - a - (b - t))) <= double_exponent (mag radix2 a))%Z.
  apply double_monotone. apply mag_le_abs; [ exact different | ].
  rewrite (Rabs_pos_eq a) by (left; exact a_pos). apply Rabs_le. lra.
Qed.

Theorem lemma_10_2_near : Rabs (u_hat - u) <= 1 * ε.
Proof.
  assert (a_0 := a_pos).
  assert (exact_ta : rnd (t - a) = t - a) by (apply rnd_double, sterbenz; auto with typeclass_instances; lra).
  assert (exact_bt : rnd (b - t) = b - t) by (apply rnd_double, sterbenz; auto with typeclass_instances; lra).
  assert (exact_ba : width = b - a) by (apply rnd_double, sterbenz; auto with typeclass_instances; lra).
  unfold u_hat, numerator. rewrite exact_ta, exact_bt, exact_ba, (rnd_double _ numerator_exact).
  fold u. rewrite Rmult_1_l. apply error_below_1, u_le.
Qed.

End Near.

(** Else t − a and b − t are off by ε of themselves; rounding numerator, width and quotient adds three times ε. *)
Lemma quotient_error : Rabs (numerator / width - u) <= 4 * ε.
Proof.
  destruct (difference_error t a t_double a_double) as (δ1 & δ1_le & first).
  destruct (difference_error b t b_double t_double) as (δ2 & δ2_le & second).
  destruct (difference_error (rnd (t - a)) (rnd (b - t)) (rnd_is_double _) (rnd_is_double _)) as (δ3 & δ3_le & third).
  destruct (difference_error b a b_double a_double) as (δ4 & δ4_le & fourth).
  assert (E := ε_small).
  assert (bounds : forall δ, Rabs δ <= ε -> - ε <= δ <= ε)
    by (intros δ H; split; [ assert (A := Rle_abs (- δ)); rewrite Rabs_Ropp in A; lra | assert (A := Rle_abs δ); lra ]).
  apply bounds in δ1_le, δ2_le, δ3_le, δ4_le.
  set (s := (t - a) / (b - a)). set (q := (b - t) / (b - a)).
  assert (s_in : 0 <= s) by (apply Rmult_le_pos; [ lra | left; apply Rinv_0_lt_compat; lra ]).
  assert (q_in : 0 <= q) by (apply Rmult_le_pos; [ lra | left; apply Rinv_0_lt_compat; lra ]).
  assert (whole : s + q = 1) by (unfold s, q; field; lra).
  set (m := s * (1 + δ1) - q * (1 + δ2)).
  assert (u_is : u = s - q) by (unfold u, s, q; field; lra).
  assert (quotient : numerator / width = m * ((1 + δ3) / (1 + δ4))).
  { unfold numerator, width. rewrite third, first, second, fourth. unfold m, s, q. field. lra. }
  assert (m_near : - ε <= m - u <= ε).
  { replace (m - u) with (s * δ1 - q * δ2) by (rewrite u_is; unfold m; ring). nra. }
  assert (u_in : -1 <= u <= 1) by (rewrite u_is; lra).
  set (κ := (1 + δ3) / (1 + δ4) - 1).
  assert (κ_is : κ * (1 + δ4) = δ3 - δ4) by (unfold κ; field; lra).
  assert (κ_in : - (5 / 2 * ε) <= κ <= 5 / 2 * ε) by nra.
  rewrite quotient. replace (m * ((1 + δ3) / (1 + δ4)) - u) with ((m - u) + m * κ) by (unfold κ; ring).
  apply Rabs_le.
  assert (m_in : - (17 / 16) <= m <= 17 / 16) by lra.
  assert (product : - (17 / 16 * (5 / 2 * ε)) <= m * κ <= 17 / 16 * (5 / 2 * ε)).
  { apply Rabs_le_inv. rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; apply Rabs_le; lra. }
  lra.
Qed.

Theorem lemma_10_2 : Rabs (u_hat - u) <= 5 * ε.
Proof.
  replace (u_hat - u) with ((rnd (numerator / width) - numerator / width) + (numerator / width - u))
    by (unfold u_hat; ring).
  apply Rle_trans with (1 := Rabs_triang _ _).
  assert (A : Rabs (rnd (numerator / width) - numerator / width) <= ε)
    by (apply error_below_1, Rabs_le; exact quotient_le).
  assert (B := quotient_error). lra.
Qed.

End Variable_u.
