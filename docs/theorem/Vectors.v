(** Vectors of three reals: sum, multiple, scalar product [·], cross product [×], Euclidean length [`| |]. *)

From Coq Require Import Reals Lra Psatz.
Open Scope R_scope.

Record vec := mkvec { x : R; y : R; z : R }.

Definition zero := mkvec 0 0 0.
Definition add u v := mkvec (x u + x v) (y u + y v) (z u + z v).
Definition opp u := mkvec (- x u) (- y u) (- z u).
Definition sub u v := mkvec (x u - x v) (y u - y v) (z u - z v).
Definition scale k u := mkvec (k * x u) (k * y u) (k * z u).
Definition dot u v := x u * x v + y u * y v + z u * z v.
Definition cross u v :=
  mkvec (y u * z v - z u * y v) (z u * x v - x u * z v) (x u * y v - y u * x v).
Definition norm u := sqrt (dot u u).

Declare Scope vec_scope.
Delimit Scope vec_scope with V.
Bind Scope vec_scope with vec.
Arguments add (u v)%V.
Arguments opp u%V.
Arguments sub (u v)%V.
Arguments scale k%R u%V.
Arguments dot (u v)%V.
Arguments cross (u v)%V.
Arguments norm u%V.
Notation "u + v" := (add u v) : vec_scope.
Notation "- u" := (opp u) : vec_scope.
Notation "u - v" := (sub u v) : vec_scope.
Notation "k * u" := (scale k u) : vec_scope.
Notation "u × v" := (cross u v) (at level 39, left associativity) : vec_scope.
Notation "u · v" := (dot u v) (at level 39, no associativity) : R_scope.
Notation "`| u |" := (norm u) (at level 0, u at level 99, format "`| u |") : R_scope.

Lemma vec_ext u v : x u = x v -> y u = y v -> z u = z v -> u = v.
Proof. destruct u, v; simpl; intros; subst; reflexivity. Qed.

(** [vec_ring] decides equations of vectors, or of scalar products, that hold as polynomials. *)
Ltac unfold_vec := unfold dot, cross, sub, add, opp, scale, zero; simpl.
Ltac vec_ring := intros; lazymatch goal with |- @eq vec _ _ => apply vec_ext | _ => idtac end; unfold_vec; ring.

(** ** Identities *)

Lemma dot_comm u v : u · v = v · u.                                              Proof. vec_ring. Qed.
Lemma dot_add_l u v w : (u + v) · w = u · w + v · w.                             Proof. vec_ring. Qed.
Lemma dot_add_r u v w : u · (v + w) = u · v + u · w.                             Proof. vec_ring. Qed.
Lemma dot_sub_l u v w : (u - v) · w = u · w - v · w.                             Proof. vec_ring. Qed.
Lemma dot_sub_r u v w : u · (v - w) = u · v - u · w.                             Proof. vec_ring. Qed.
Lemma dot_scale_l k u v : (k * u) · v = k * (u · v).                             Proof. vec_ring. Qed.
Lemma dot_scale_r k u v : u · (k * v) = k * (u · v).                             Proof. vec_ring. Qed.
Lemma cross_anti u v : (u × v = - (v × u))%V.                                    Proof. vec_ring. Qed.
Lemma dot_cross_self_l u v : u · (u × v) = 0.                                    Proof. vec_ring. Qed.
Lemma dot_cross_self_r u v : v · (u × v) = 0.                                    Proof. vec_ring. Qed.
Lemma triple u v w : u · (v × w) = v · (w × u).                                  Proof. vec_ring. Qed.
Lemma cross_cross u v w : (u × (v × w) = (u · w) * v - (u · v) * w)%V.            Proof. vec_ring. Qed.
Lemma cross_cross_l u v w : ((u × v) × w = (u · w) * v - (v · w) * u)%V.          Proof. vec_ring. Qed.
Lemma lagrange u v : (u × v) · (u × v) = (u · u) * (v · v) - (u · v) * (u · v).  Proof. vec_ring. Qed.

(** ** Length *)

Lemma dot_self_nonneg u : 0 <= u · u.
Proof. unfold dot; nra. Qed.

Lemma norm_nonneg u : 0 <= `|u|.
Proof. apply sqrt_pos. Qed.

Lemma norm_sq u : `|u| * `|u| = u · u.
Proof. apply sqrt_sqrt, dot_self_nonneg. Qed.

Lemma norm_le_of_sq u k : 0 <= k -> u · u <= k * k -> `|u| <= k.
Proof.
  intros k_nonneg H. unfold norm. rewrite <- (sqrt_square k) by assumption. now apply sqrt_le_1_alt.
Qed.

Lemma norm_opp u : `|- u| = `|u|.
Proof. unfold norm; f_equal; vec_ring. Qed.

Lemma norm_scale k u : `|k * u| = Rabs k * `|u|.
Proof.
  unfold norm. replace ((k * u) · (k * u)) with (Rsqr k * (u · u)) by (unfold Rsqr; vec_ring).
  rewrite sqrt_mult_alt by apply Rle_0_sqr. now rewrite sqrt_Rsqr_abs.
Qed.

Lemma norm_unit u : u · u = 1 -> `|u| = 1.
Proof. intros H. unfold norm. rewrite H. apply sqrt_1. Qed.

Lemma norm_zero : `|zero| = 0.
Proof. unfold norm. replace (zero · zero) with 0 by vec_ring. apply sqrt_0. Qed.

(** Cauchy and Schwarz; the same for [×]; the triangle. *)
Lemma dot_le u v : Rabs (u · v) <= `|u| * `|v|.
Proof.
  assert (positive := Rmult_le_pos _ _ (norm_nonneg u) (norm_nonneg v)).
  rewrite <- (Rabs_right (`|u| * `|v|)) by lra. apply Rsqr_le_abs_0. unfold Rsqr.
  replace (`|u| * `|v| * (`|u| * `|v|)) with (`|u| * `|u| * (`|v| * `|v|)) by ring.
  rewrite !norm_sq. assert (H := lagrange u v). assert (S := dot_self_nonneg (u × v)). lra.
Qed.

Lemma Rabs_bounds k a : Rabs k <= a -> - a <= k <= a.
Proof. intros. assert (A := Rle_abs k). assert (B := Rle_abs (- k)). rewrite Rabs_Ropp in B. lra. Qed.

Lemma dot_upper u v : u · v <= `|u| * `|v|.
Proof. assert (H := dot_le u v). apply Rabs_bounds in H. lra. Qed.

Lemma dot_lower u v : - (`|u| * `|v|) <= u · v.
Proof. assert (H := dot_le u v). apply Rabs_bounds in H. lra. Qed.

Lemma norm_cross u v : `|u × v| <= `|u| * `|v|.
Proof.
  apply norm_le_of_sq. apply Rmult_le_pos; apply norm_nonneg.
  replace (`|u| * `|v| * (`|u| * `|v|)) with (`|u| * `|u| * (`|v| * `|v|)) by ring.
  rewrite !norm_sq, lagrange. nra.
Qed.

Lemma norm_add u v : `|u + v| <= `|u| + `|v|.
Proof.
  assert (u_nonneg := norm_nonneg u). assert (v_nonneg := norm_nonneg v).
  apply norm_le_of_sq. lra.
  assert (H := dot_upper u v). assert (A := norm_sq u). assert (B := norm_sq v).
  replace ((u + v) · (u + v)) with (u · u + 2 * (u · v) + v · v) by vec_ring. nra.
Qed.

Lemma norm_sub u v : `|u - v| <= `|u| + `|v|.
Proof.
  replace (u - v)%V with (u + - v)%V by vec_ring. rewrite <- (norm_opp v). apply norm_add.
Qed.

(** An orthogonal pair: Pythagoras. *)
Lemma norm_orthogonal u v : u · v = 0 -> `|u + v| * `|u + v| = `|u| * `|u| + `|v| * `|v|.
Proof.
  intros H. rewrite !norm_sq. replace ((u + v) · (u + v)) with (u · u + 2 * (u · v) + v · v) by vec_ring.
  rewrite H. ring.
Qed.

(** The size of a cross product or of a multiple, once those of its factors are bounded. *)
Lemma norm_cross_le u v a b : `|u| <= a -> `|v| <= b -> `|u × v| <= a * b.
Proof.
  intros. apply Rle_trans with (1 := norm_cross u v).
  apply Rmult_le_compat; auto using norm_nonneg.
Qed.

Lemma norm_scale_le k u a b : Rabs k <= a -> `|u| <= b -> `|k * u| <= a * b.
Proof.
  intros. rewrite norm_scale. apply Rmult_le_compat; auto using norm_nonneg, Rabs_pos.
Qed.

Lemma dot_abs_le u v a b : `|u| <= a -> `|v| <= b -> Rabs (u · v) <= a * b.
Proof.
  intros. apply Rle_trans with (1 := dot_le u v).
  apply Rmult_le_compat; auto using norm_nonneg.
Qed.

Lemma norm_add_le u v a b : `|u| <= a -> `|v| <= b -> `|u + v| <= a + b.
Proof. intros. assert (H1 := norm_add u v). lra. Qed.

Lemma norm_sub_le u v a b : `|u| <= a -> `|v| <= b -> `|u - v| <= a + b.
Proof. intros. assert (H1 := norm_sub u v). lra. Qed.
