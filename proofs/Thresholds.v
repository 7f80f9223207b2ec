(** Which comparisons of one number with constants hold together: the line of its type, cut where they change.

    A double is a [spec_float] of Coq's library that is valid and no NaN. Part one orders the doubles by their ranks,
    part two shows that rounding, and so adding a margin, keeps the order, part three that the samples of
    [ltlc/specification/cells.py] give exactly the letters that some number of a line gives; the last part, that
    binary64, binary32 and the integers up to 53 bits are lines. Nothing here needs real numbers. *)
From Coq Require Import ZArith Lia Bool List Sorted SpecFloat.
Import ListNotations.
Open Scope Z_scope.

Notation EMIN := (-1074).
Definition INFINITE : Z := 2047 * 2 ^ 52.

(** * Ranks *)

(** The place of a double among all: neighbours have neighbouring ranks, both zeros have rank 0. *)
Definition rank (x : spec_float) : Z :=
  match x with
  | S754_finite s m e => cond_Zopp s ((e - EMIN) * 2 ^ 52 + Zpos m)
  | S754_infinity s => cond_Zopp s INFINITE
  | _ => 0
  end.

Definition is_double (x : spec_float) : Prop := valid_binary 53 1024 x = true /\ x <> S754_nan.

(** What a valid mantissa and exponent are. *)
Definition fits (m : positive) (e : Z) : Prop :=
  EMIN <= e <= 971 /\ Zpos m < 2 ^ 53 /\ (e = EMIN \/ 2 ^ 52 <= Zpos m).

Lemma digits_bounds : forall m, 2 ^ (Zpos (digits2_pos m) - 1) <= Zpos m < 2 ^ Zpos (digits2_pos m).
Proof.
  assert (H : forall p, Zpos (Pos.succ p) - 1 = Z.succ (Zpos p - 1)) by lia.
  induction m; cbn [digits2_pos]; try rewrite H, Pos2Z.inj_succ, !Z.pow_succ_r by lia; lia.
Qed.

Lemma digits_at_most : forall m n, 0 <= n -> Zpos m < 2 ^ n -> Zpos (digits2_pos m) <= n.
Proof.
  intros m n Hn H. pose proof (digits_bounds m) as [A _]. apply Z.nlt_ge. intros B.
  assert (2 ^ n <= 2 ^ (Zpos (digits2_pos m) - 1)) by (apply Z.pow_le_mono_r; lia). lia.
Qed.

Lemma digits_at_least : forall m n, 2 ^ n <= Zpos m -> n + 1 <= Zpos (digits2_pos m).
Proof.
  intros m n H. pose proof (digits_bounds m) as [_ B]. apply Z.nlt_ge. intros C.
  destruct (Z.neg_nonneg_cases n); [lia|].
  assert (2 ^ Zpos (digits2_pos m) <= 2 ^ n) by (apply Z.pow_le_mono_r; lia). lia.
Qed.

Lemma bounded_fits : forall m e, bounded 53 1024 m e = true <-> fits m e.
Proof.
  intros m e. unfold bounded, canonical_mantissa, fits, fexp, emin. rewrite andb_true_iff, <- Zeq_is_eq_bool, Z.leb_le.
  pose proof (digits_bounds m) as [A B]. split.
  - intros [H1 H2]. assert (HD : Zpos (digits2_pos m) <= 53) by lia. repeat split; try lia.
    + eapply Z.lt_le_trans; [exact B|]. apply Z.pow_le_mono_r; lia.
    + destruct (Z.eq_dec e EMIN); [now left | right]. assert (Zpos (digits2_pos m) = 53) as E by lia. rewrite E in A. exact A.
  - intros ((H1 & H2) & H3 & H4). apply digits_at_most in H3; [|lia]. destruct H4 as [->|H4]; [lia|].
    apply digits_at_least in H4. lia.
Qed.

Lemma rank_bound : forall m e, fits m e -> 0 < (e - EMIN) * 2 ^ 52 + Zpos m < INFINITE.
Proof. intros m e (H1 & H2 & H3). unfold INFINITE. lia. Qed.

(** Comparing doubles is comparing ranks. *)
Theorem compare_rank : forall x y, is_double x -> is_double y -> SFcompare x y = Some (rank x ?= rank y).
Proof.
  assert (HF : forall m e m' e', fits m e -> fits m' e' -> forall c,
    match e ?= e' with Lt => Lt | Gt => Gt | Eq => Pos.compare_cont Eq m m' end = c ->
    ((e - EMIN) * 2 ^ 52 + Zpos m ?= (e' - EMIN) * 2 ^ 52 + Zpos m') = c).
  { intros m e m' e' (A1 & A2 & A3) (B1 & B2 & B3) c <-. destruct (Z.compare_spec e e') as [->|H|H].
    - rewrite Zcompare_plus_compat. reflexivity.
    - apply Z.compare_lt_iff. lia.
    - apply Z.compare_gt_iff. lia. }
  intros [s|s| |s m e] [s'|s'| |s' m' e'] [Hx Nx] [Hy Ny]; try congruence; simpl in Hx, Hy; rewrite ?bounded_fits in *;
    try pose proof (rank_bound m e Hx); try pose proof (rank_bound m' e' Hy); unfold SFcompare, rank; f_equal;
    try (destruct s; try destruct s'; unfold cond_Zopp; symmetry;
         first [apply Z.compare_eq_iff; lia | apply Z.compare_lt_iff; unfold INFINITE in *; lia
               | apply Z.compare_gt_iff; unfold INFINITE in *; lia]; fail).
  destruct s, s'; unfold cond_Zopp; symmetry;
    try (first [apply Z.compare_lt_iff; lia | apply Z.compare_gt_iff; lia]; fail).
  - rewrite Z.compare_opp. apply HF; auto. rewrite (Z.compare_antisym e' e). destruct (e' ?= e); auto.
    apply (Pos.compare_antisym m m').
  - now apply HF.
Qed.

(** * Rounding to nearest keeps the order *)

(** [half_even n d]: the integer nearest to n / d, the even one of two. *)
Definition half_even (n d : Z) : Z :=
  round_nearest_even (n / d) (if n mod d =? 0 then loc_Exact else loc_Inexact (2 * (n mod d) ?= d)).

Lemma half_even_bounds : forall n d, 0 < d -> 2 * n - d <= 2 * d * half_even n d <= 2 * n + d.
Proof.
  intros n d Hd. unfold half_even. pose proof (Z.div_mod n d ltac:(lia)) as E. pose proof (Z.mod_pos_bound n d Hd) as B.
  set (q := n / d) in *. set (r := n mod d) in *. unfold round_nearest_even.
  destruct (Z.eqb_spec r 0); [nia|]. destruct (Z.compare_spec (2 * r) d); [destruct (Z.even q)|..]; nia.
Qed.

Lemma half_even_le : forall n n' d, 0 < d -> n <= n' -> half_even n d <= half_even n' d.
Proof.
  intros n n' d Hd Hn. destruct (Z.eq_dec n n') as [->|]; [lia|].
  pose proof (half_even_bounds n d Hd). pose proof (half_even_bounds n' d Hd). nia.
Qed.

Lemma half_even_scale : forall n d k, 0 < d -> 0 < k -> half_even (n * k) (d * k) = half_even n d.
Proof.
  intros n d k Hd Hk. unfold half_even. rewrite Z.div_mul_cancel_r, Z.mul_mod_distr_r by lia.
  replace (n mod d * k =? 0) with (n mod d =? 0) by (apply eq_true_iff_eq; rewrite !Z.eqb_eq; nia).
  replace (2 * (n mod d * k)) with (2 * (n mod d) * k) by ring. now rewrite <- Zmult_compare_compat_r by lia.
Qed.

Lemma half_even_exact : forall n d, 0 < d -> half_even (n * d) d = n.
Proof. intros n d Hd. unfold half_even. rewrite Z.mod_mul, Z.div_mul by lia. reflexivity. Qed.

(** The place of the double nearest to n units of the smallest double, n >= 0. *)
Definition shift_of (n : Z) : Z := Z.max 0 (Z.log2 n - 52).
Definition rounded (n : Z) : Z := Z.min INFINITE (shift_of n * 2 ^ 52 + half_even n (2 ^ shift_of n)).

Lemma half_even_shift : forall n, 0 < n ->
  0 <= half_even n (2 ^ shift_of n) <= 2 ^ 53 /\ (0 < shift_of n -> 2 ^ 52 <= half_even n (2 ^ shift_of n)).
Proof.
  intros n Hn. pose proof (Z.log2_spec n Hn) as [A B]. unfold shift_of. set (s := Z.max 0 (Z.log2 n - 52)).
  assert (Hs : 0 < 2 ^ s) by (apply Z.pow_pos_nonneg; lia).
  repeat split.
  - rewrite <- (half_even_exact 0 (2 ^ s) Hs). apply half_even_le; lia.
  - rewrite <- (half_even_exact (2 ^ 53) (2 ^ s) Hs). apply half_even_le; auto.
    rewrite <- Z.pow_add_r by lia. apply Z.lt_le_incl, (Z.lt_le_trans _ _ _ B), Z.pow_le_mono_r; lia.
  - intros Hp. rewrite <- (half_even_exact (2 ^ 52) (2 ^ s) Hs). apply half_even_le; auto.
    rewrite <- Z.pow_add_r by lia. now replace (52 + s) with (Z.log2 n) by lia.
Qed.

Lemma rounded_le : forall n n', 0 < n <= n' -> rounded n <= rounded n'.
Proof.
  intros n n' H. unfold rounded. apply Z.min_le_compat_l.
  assert (HL : shift_of n <= shift_of n') by (unfold shift_of; pose proof (Z.log2_le_mono n n' ltac:(lia)); lia).
  destruct (Z.eq_dec (shift_of n) (shift_of n')) as [E|E].
  - rewrite E. apply Zplus_le_compat_l, half_even_le; [apply Z.pow_pos_nonneg; unfold shift_of; lia | lia].
  - pose proof (half_even_shift n ltac:(lia)) as [A _]. pose proof (half_even_shift n' ltac:(lia)) as [_ B].
    unfold shift_of in *. lia.
Qed.

(** [iter_pos shr_1 p]: the quotient by 2 ^ p, and where the remainder lies. *)
Definition shifted (n k : Z) (x : shr_record) : Prop :=
  0 <= k /\ 0 <= shr_m x /\ exists r t, n = 2 ^ k * shr_m x + r /\ 2 * r = (if shr_r x then 2 ^ k else 0) + t /\
  0 <= t < 2 ^ k /\ 0 <= r < 2 ^ k /\ shr_s x = negb (t =? 0).

Lemma shr_1_shifted : forall n k x, shifted n k x -> shifted n (k + 1) (shr_1 x).
Proof.
  intros n k [m b s] (Hk & Hm & r & t & E1 & E2 & B1 & B2 & Es). cbn [shr_m shr_r shr_s] in *. unfold shifted.
  rewrite Z.pow_add_r, Z.pow_1_r by lia.
  assert (HS : b || s = negb (2 * r =? 0)).
  { rewrite Es. destruct b; cbn [orb]; [|now replace (2 * r) with t by lia].
    symmetry. apply negb_true_iff, Z.eqb_neq. lia. }
  destruct m as [|[p|p|]|p]; try lia; cbn [shr_1 shr_m shr_r shr_s]; (split; [lia|]); (split; [lia|]);
    rewrite ?(Pos2Z.inj_xI p), ?(Pos2Z.inj_xO p) in E1.
  - exists r, (2 * r). repeat split; auto; lia.
  - exists (r + 2 ^ k), (2 * r). repeat split; auto; lia.
  - exists r, (2 * r). repeat split; auto; lia.
  - exists (r + 2 ^ k), (2 * r). repeat split; auto; lia.
Qed.

Lemma iter_shifted : forall p n k x, shifted n k x -> shifted n (k + Zpos p) (iter_pos shr_1 p x).
Proof.
  induction p; intros n k x H; cbn [iter_pos].
  - replace (k + Zpos p~1) with (k + 1 + Zpos p + Zpos p) by lia. auto using shr_1_shifted.
  - replace (k + Zpos p~0) with (k + Zpos p + Zpos p) by lia. auto.
  - now apply shr_1_shifted.
Qed.

Lemma round_shifted : forall n k x, shifted n k x ->
  round_nearest_even (shr_m x) (loc_of_shr_record x) = half_even n (2 ^ k).
Proof.
  intros n k [m b s] (Hk & Hm & r & t & E1 & E2 & B1 & B2 & Es). cbn [shr_m shr_r shr_s] in *.
  assert (Hd : n / 2 ^ k = m /\ n mod 2 ^ k = r).
  { rewrite E1, (Z.mul_comm (2 ^ k)), Z.add_comm. split.
    - rewrite Z.div_add, Z.div_small by lia. lia.
    - rewrite Z.mod_add, Z.mod_small by lia. lia. }
  unfold half_even. destruct Hd as [-> ->]. subst s.
  destruct b, (Z.eqb_spec t 0); cbn [negb loc_of_shr_record]; destruct (Z.eqb_spec r 0); try lia; auto.
  - now replace (2 * r ?= 2 ^ k) with Eq by (symmetry; apply Z.compare_eq_iff; lia).
  - now replace (2 * r ?= 2 ^ k) with Gt by (symmetry; apply Z.compare_gt_iff; lia).
  - now replace (2 * r ?= 2 ^ k) with Lt by (symmetry; apply Z.compare_lt_iff; lia).
Qed.

Lemma fexp_shift : forall m e, EMIN <= e ->
  fexp 53 1024 (Zpos (digits2_pos m) + e) = EMIN + shift_of (Zpos m * 2 ^ (e - EMIN)).
Proof.
  intros m e He. unfold shift_of, fexp, emin. rewrite Z.log2_mul_pow2 by lia.
  rewrite (Z.log2_unique (Zpos m) (Zpos (digits2_pos m) - 1)); [lia | lia |].
  pose proof (digits_bounds m). now replace (Z.succ (Zpos (digits2_pos m) - 1)) with (Zpos (digits2_pos m)) by lia.
Qed.

Lemma shl_align_value : forall m e e', EMIN <= e -> EMIN <= e' ->
  snd (shl_align m e e') = Z.min e e' /\
  Zpos (fst (shl_align m e e')) * 2 ^ (Z.min e e' - EMIN) = Zpos m * 2 ^ (e - EMIN).
Proof.
  intros m e e' He He'. unfold shl_align. destruct (e' - e) as [|d|d] eqn:E; cbn [fst snd].
  - now replace (Z.min e e') with e by lia.
  - now replace (Z.min e e') with e by lia.
  - replace (Z.min e e') with e' by lia. split; auto. rewrite shift_pos_correct, Z.pow_pos_fold.
    replace (e - EMIN) with (Zpos d + (e' - EMIN)) by lia. rewrite Z.pow_add_r by lia. ring.
Qed.

Lemma shr_fexp_shifted : forall m e f, fexp 53 1024 (Zpos (digits2_pos m) + e) = f -> e <= f ->
  exists x, shr_fexp 53 1024 (Zpos m) e loc_Exact = (x, f) /\ shifted (Zpos m) (f - e) x.
Proof.
  intros m e f Hf He. unfold shr_fexp, shr. cbn [Zdigits2 shr_record_of_loc]. rewrite Hf.
  assert (H0 : shifted (Zpos m) 0 {| shr_m := Zpos m; shr_r := false; shr_s := false |}).
  { split; [lia|]. split; [simpl; lia|]. exists 0, 0. cbn [shr_m shr_r shr_s]. repeat split; lia. }
  destruct (f - e) as [|p|p] eqn:E; [| |lia].
  - replace e with f by lia. eauto.
  - exists (iter_pos shr_1 p {| shr_m := Zpos m; shr_r := false; shr_s := false |}). split; [f_equal; lia|].
    change (Zpos p) with (0 + Zpos p). now apply iter_shifted.
Qed.

(** A mantissa that has been rounded is made to fit. *)
Lemma renormalised : forall s m h, 0 <= h -> 0 < m <= 2 ^ 53 -> (0 < h -> 2 ^ 52 <= m) ->
  forall x, (let '(r, e) := shr_fexp 53 1024 m (EMIN + h) loc_Exact in
             match shr_m r with
             | Z0 => S754_zero s
             | Zpos n => if e <=? 1024 - 53 then S754_finite s n e else S754_infinity s
             | _ => S754_nan
             end) = x ->
  is_double x /\ rank x = cond_Zopp s (Z.min INFINITE (h * 2 ^ 52 + m)).
Proof.
  intros s m h Hh Hm Hl x. destruct m as [|m|m]; try lia. destruct (Z.eq_dec (Zpos m) (2 ^ 53)) as [E|E].
  - injection E as ->. unfold shr_fexp. cbn [Zdigits2 digits2_pos Pos.succ shr_record_of_loc].
    replace (fexp 53 1024 (54 + (EMIN + h)) - (EMIN + h)) with 1 by (unfold fexp, emin; lia). cbn [shr iter_pos shr_1 shr_m orb].
    intros <-. destruct (Z.leb_spec (EMIN + h + 1) (1024 - 53)).
    + split; [split; [apply bounded_fits; unfold fits; lia | congruence]|]. unfold rank. f_equal. unfold INFINITE. lia.
    + split; [split; [reflexivity | congruence]|]. unfold rank. f_equal. unfold INFINITE. lia.
  - assert (HD : Zpos (digits2_pos m) <= 53) by (apply digits_at_most; lia).
    unfold shr_fexp. cbn [Zdigits2 shr_record_of_loc].
    assert (HF : fexp 53 1024 (Zpos (digits2_pos m) + (EMIN + h)) - (EMIN + h) <= 0) by (unfold fexp, emin; lia).
    unfold shr. destruct (fexp 53 1024 (Zpos (digits2_pos m) + (EMIN + h)) - (EMIN + h)); try lia; cbn [shr_m];
      (intros <-; destruct (Z.leb_spec (EMIN + h) (1024 - 53));
        [split; [split; [apply bounded_fits; unfold fits; lia | congruence]|]; unfold rank; f_equal; unfold INFINITE; lia
        | split; [split; [reflexivity | congruence]|]; unfold rank; f_equal; unfold INFINITE; lia]).
Qed.

Lemma binary_round_rank : forall s m e, EMIN <= e ->
  is_double (binary_round 53 1024 s m e) /\
  rank (binary_round 53 1024 s m e) = cond_Zopp s (rounded (Zpos m * 2 ^ (e - EMIN))).
Proof.
  intros s m e He. unfold binary_round. set (n := Zpos m * 2 ^ (e - EMIN)).
  assert (Hn : 0 < n) by (apply Z.mul_pos_pos; [lia | apply Z.pow_pos_nonneg; lia]).
  rewrite (fexp_shift m e He). fold n. assert (Hh : 0 <= shift_of n) by (unfold shift_of; lia).
  destruct (shl_align_value m e (EMIN + shift_of n)) as [A B]; try lia.
  destruct (shl_align m e (EMIN + shift_of n)) as [m' e']. cbn [fst snd] in A, B. subst e'. fold n in B.
  set (e' := Z.min e (EMIN + shift_of n)) in *. assert (He' : EMIN <= e') by lia.
  assert (HF : fexp 53 1024 (Zpos (digits2_pos m') + e') = EMIN + shift_of n) by (now rewrite fexp_shift, B).
  destruct (shr_fexp_shifted m' e' _ HF ltac:(lia)) as (x & E & Hx).
  unfold binary_round_aux. rewrite E, (round_shifted _ _ _ Hx).
  replace (half_even (Zpos m') (2 ^ (EMIN + shift_of n - e'))) with (half_even n (2 ^ shift_of n)).
  2: { rewrite <- (half_even_scale (Zpos m') _ (2 ^ (e' - EMIN))) by (apply Z.pow_pos_nonneg; lia).
       rewrite B, <- Z.pow_add_r by lia. do 2 f_equal. lia. }
  destruct (half_even_shift n Hn) as [H1 H2]. unfold rounded.
  eapply renormalised; try reflexivity; auto. split; [|lia].
  destruct (Z.eq_dec (shift_of n) 0) as [E0|E0]; [|lia]. rewrite E0. change (2 ^ 0) with 1.
  rewrite <- (Z.mul_1_r n), half_even_exact; lia.
Qed.

Lemma rounded_nonneg : forall n, 0 < n -> 0 <= rounded n.
Proof.
  intros n Hn. pose proof (half_even_shift n Hn) as [[A _] _]. unfold rounded, INFINITE, shift_of in *. lia.
Qed.

(** The rank of the double nearest to n units, of either sign. *)
Definition nearest (n : Z) : Z :=
  match n with Z0 => 0 | Zpos p => rounded (Zpos p) | Zneg p => - rounded (Zpos p) end.

Lemma nearest_le : forall n n', n <= n' -> nearest n <= nearest n'.
Proof.
  assert (H : forall p, 0 <= rounded (Zpos p)) by (intros; apply rounded_nonneg; lia).
  intros [|p|p] [|q|q] Hn; cbn [nearest]; try lia; try pose proof (H p); try pose proof (H q); try lia.
  - apply rounded_le. lia.
  - pose proof (rounded_le (Zpos q) (Zpos p)). lia.
Qed.

Lemma normalize_rank : forall m e z, EMIN <= e ->
  is_double (binary_normalize 53 1024 m e z) /\
  rank (binary_normalize 53 1024 m e z) = nearest (m * 2 ^ (e - EMIN)).
Proof.
  intros m e z He. assert (HP : 0 < 2 ^ (e - EMIN)) by (apply Z.pow_pos_nonneg; lia).
  destruct m as [|m|m]; cbn [binary_normalize].
  - rewrite Z.mul_0_l. repeat split; congruence.
  - destruct (binary_round_rank false m e He) as [A B]. split; auto. rewrite B. cbn [cond_Zopp].
    destruct (Zpos m * 2 ^ (e - EMIN)) eqn:E; auto; lia.
  - destruct (binary_round_rank true m e He) as [A B]. split; auto. rewrite B. cbn [cond_Zopp].
    replace (Zneg m * 2 ^ (e - EMIN)) with (- (Zpos m * 2 ^ (e - EMIN))) by lia.
    destruct (Zpos m * 2 ^ (e - EMIN)) eqn:E; auto; lia.
Qed.

(** A finite double in units of the smallest. *)
Definition units (x : spec_float) : Z :=
  match x with S754_finite s m e => cond_Zopp s (Zpos m * 2 ^ (e - EMIN)) | _ => 0 end.
Definition is_finite (x : spec_float) : Prop :=
  match x with S754_zero _ => True | S754_finite _ m e => fits m e | _ => False end.

Lemma finite_double : forall x, is_finite x -> is_double x.
Proof. intros [s|s| |s m e] H; try contradiction; split; try congruence; try reflexivity. now apply bounded_fits. Qed.

Lemma double_cases : forall x, is_double x -> is_finite x \/ exists s, x = S754_infinity s.
Proof. intros [s|s| |s m e] [H N]; try congruence; simpl; eauto. left. now apply bounded_fits. Qed.

Lemma nearest_units : forall x, is_finite x -> nearest (units x) = rank x.
Proof.
  intros [s|s| |s m e] H; try contradiction; auto. pose proof H as ((H1 & H2) & H3 & H4).
  assert (HP : 0 < 2 ^ (e - EMIN)) by (apply Z.pow_pos_nonneg; lia).
  assert (HS : shift_of (Zpos m * 2 ^ (e - EMIN)) = e - EMIN).
  { unfold shift_of. rewrite Z.log2_mul_pow2 by lia.
    assert (Z.log2 (Zpos m) < 53) by (apply Z.log2_lt_pow2; lia).
    destruct H4 as [->|H4]; [lia|]. assert (52 <= Z.log2 (Zpos m)) by (apply Z.log2_le_pow2; lia). lia. }
  assert (HR : rounded (Zpos m * 2 ^ (e - EMIN)) = (e - EMIN) * 2 ^ 52 + Zpos m).
  { unfold rounded. rewrite HS, half_even_exact by lia. pose proof (rank_bound m e H). lia. }
  unfold units, rank. rewrite <- HR. destruct (Zpos m * 2 ^ (e - EMIN)) eqn:E; try lia. now destruct s.
Qed.

Lemma units_le : forall x y, is_finite x -> is_finite y -> rank x <= rank y -> units x <= units y.
Proof.
  assert (HP : forall m e, 0 < Zpos m * 2 ^ e \/ e < 0).
  { intros m e. destruct (Z.neg_nonneg_cases e); auto. left. apply Z.mul_pos_pos; [lia | now apply Z.pow_pos_nonneg]. }
  assert (HF : forall m e m' e', fits m e -> fits m' e' ->
    (e - EMIN) * 2 ^ 52 + Zpos m <= (e' - EMIN) * 2 ^ 52 + Zpos m' ->
    Zpos m * 2 ^ (e - EMIN) <= Zpos m' * 2 ^ (e' - EMIN)).
  { intros m e m' e' (A1 & A2 & A3) (B1 & B2 & B3) H. destruct (Z.eq_dec e e') as [->|Hne].
    - apply Z.mul_le_mono_nonneg_r; [apply Z.pow_nonneg|]; lia.
    - assert (He : e < e') by lia. assert (HE : 2 ^ (e' - EMIN) = 2 ^ (e' - e - 1) * 2 * 2 ^ (e - EMIN)).
      { replace (e' - EMIN) with (e' - e - 1 + 1 + (e - EMIN)) by lia. now rewrite !Z.pow_add_r by lia. }
      rewrite HE, Z.mul_assoc. apply Z.mul_le_mono_nonneg_r; [apply Z.pow_nonneg; lia|].
      assert (0 < 2 ^ (e' - e - 1)) by (apply Z.pow_pos_nonneg; lia). nia. }
  intros [s|s| |s m e] [s'|s'| |s' m' e'] Hx Hy H; try contradiction; unfold units, rank in *.
  - lia.
  - pose proof (rank_bound _ _ Hy). pose proof (HP m' (e' - EMIN)). destruct Hy as (? & _), s'; cbn [cond_Zopp] in *; lia.
  - pose proof (rank_bound _ _ Hx). pose proof (HP m (e - EMIN)). destruct Hx as (? & _), s; cbn [cond_Zopp] in *; lia.
  - pose proof (rank_bound _ _ Hx). pose proof (rank_bound _ _ Hy). pose proof (HP m (e - EMIN)). pose proof (HP m' (e' - EMIN)).
    pose proof (HF _ _ _ _ Hx Hy). pose proof (HF _ _ _ _ Hy Hx). destruct Hx as (? & _), Hy as (? & _).
    destruct s, s'; cbn [cond_Zopp] in *; lia.
Qed.

(** * The sum with a finite double keeps the order *)

Definition add := SFadd 53 1024.
Definition sub := SFsub 53 1024.

Lemma add_finite : forall x y, is_finite x -> is_finite y ->
  is_double (add x y) /\ rank (add x y) = nearest (units x + units y).
Proof.
  intros x y Hx Hy. pose proof (finite_double x Hx). pose proof (finite_double y Hy).
  pose proof (nearest_units x Hx). pose proof (nearest_units y Hy).
  destruct x as [s|s| |s m e], y as [s'|s'| |s' m' e']; try contradiction; unfold add, SFadd.
  - destruct (Bool.eqb s s'); repeat split; congruence.
  - auto.
  - now rewrite Z.add_0_r.
  - clear H H0 H1 H2. pose proof (proj1 (proj1 Hx)). pose proof (proj1 (proj1 Hy)).
    destruct (shl_align_value m e (Z.min e e')) as [_ A]; try lia. destruct (shl_align_value m' e' (Z.min e e')) as [_ B]; try lia.
    replace (Z.min e (Z.min e e')) with (Z.min e e') in A by lia. replace (Z.min e' (Z.min e e')) with (Z.min e e') in B by lia.
    edestruct (normalize_rank (cond_Zopp s (Zpos (fst (shl_align m e (Z.min e e')))) +
      cond_Zopp s' (Zpos (fst (shl_align m' e' (Z.min e e'))))) (Z.min e e') false) as [C D]; [lia|].
    split; [exact C|]. rewrite D. f_equal. unfold units. rewrite <- A, <- B. destruct s, s'; cbn [cond_Zopp]; ring.
Qed.

Lemma rank_finite : forall x, is_finite x -> - INFINITE < rank x < INFINITE.
Proof.
  intros [s|s| |s m e] H; try contradiction; unfold rank; [unfold INFINITE; lia|].
  apply rank_bound in H. destruct s; cbn [cond_Zopp]; lia.
Qed.

Lemma rank_infinite : forall s, rank (S754_infinity s) = if s then - INFINITE else INFINITE.
Proof. now intros []. Qed.

Lemma rank_range : forall x, is_double x -> - INFINITE <= rank x <= INFINITE.
Proof.
  intros x Hx. destruct (double_cases x Hx) as [H|[s ->]]; [pose proof (rank_finite x H); lia|].
  rewrite rank_infinite. unfold INFINITE. destruct s; lia.
Qed.

Lemma add_double : forall x m, is_double x -> is_finite m -> is_double (add x m).
Proof.
  intros x m Hx Hm. destruct (double_cases x Hx) as [Hf|[s ->]]; [now apply add_finite|].
  destruct m; try contradiction; exact Hx.
Qed.

Theorem add_le : forall x y m, is_double x -> is_double y -> is_finite m -> rank x <= rank y ->
  rank (add x m) <= rank (add y m).
Proof.
  intros x y m Hx Hy Hm H. pose proof (rank_range _ (add_double x m Hx Hm)). pose proof (rank_range _ (add_double y m Hy Hm)).
  pose proof (rank_range x Hx). pose proof (rank_range y Hy).
  assert (HI : forall s, rank (add (S754_infinity s) m) = rank (S754_infinity s)) by (intros; destruct m; try contradiction; auto).
  destruct (double_cases x Hx) as [Hf|[s ->]], (double_cases y Hy) as [Hg|[s' ->]].
  - destruct (add_finite x m Hf Hm) as [_ ->], (add_finite y m Hg Hm) as [_ ->].
    apply nearest_le, Zplus_le_compat_r, units_le; auto.
  - pose proof (rank_finite x Hf). rewrite HI, rank_infinite in *. destruct s'; lia.
  - pose proof (rank_finite y Hg). rewrite HI, rank_infinite in *. destruct s; lia.
  - now rewrite !HI.
Qed.

(** * Comparisons of one double with a constant *)

Inductive relation := Less | AtMost | Equal | AtLeast | Greater.

(** As [holds] in [cells.py]. *)
Definition holds (r : relation) (margin left right : spec_float) : bool :=
  match r with
  | Less => SFltb left (add right margin)
  | AtMost => SFleb left (add right margin)
  | AtLeast => SFleb (add right margin) left
  | Greater => SFltb (add right margin) left
  | Equal =>
      if SFeqb margin (S754_zero false) then SFeqb left right
      else SFeqb left right || SFleb (SFabs (sub left right)) margin
  end.

Record comparison_with := { relates : relation; margin : spec_float; constant : spec_float; constant_is_left : bool }.

Definition condition (c : comparison_with) (x : spec_float) : bool :=
  if constant_is_left c then holds (relates c) (margin c) (constant c) x
  else holds (relates c) (margin c) x (constant c).

Definition well_formed (c : comparison_with) : Prop := is_double (constant c) /\ is_finite (margin c).

(** The double of a rank. *)
Definition at_rank (r : Z) : spec_float :=
  match Z.abs r with
  | Zpos a =>
      let (h, m) := Z.div_eucl (Zpos a) (2 ^ 52) in
      if h =? 2047 then S754_infinity (r <? 0)
      else if h =? 0 then S754_finite (r <? 0) a EMIN
      else S754_finite (r <? 0) (Z.to_pos (2 ^ 52 + m)) (EMIN + h - 1)
  | _ => S754_zero false
  end.

Lemma at_rank_double : forall r, - INFINITE <= r <= INFINITE -> is_double (at_rank r) /\ rank (at_rank r) = r.
Proof.
  intros r Hr. unfold at_rank. destruct (Z.abs r) as [|a|a] eqn:Ea; [| |lia].
  { repeat split; [congruence | simpl; lia]. }
  pose proof (Z_div_mod (Zpos a) (2 ^ 52) ltac:(lia)) as HD. destruct (Z.div_eucl (Zpos a) (2 ^ 52)) as [h m].
  destruct HD as [E B]. unfold INFINITE in Hr. assert (HS : forall z, z = Zpos a -> cond_Zopp (r <? 0) z = r).
  { intros z ->. destruct (Z.ltb_spec r 0); cbn [cond_Zopp]; lia. }
  destruct (Z.eqb_spec h 2047) as [->|H1]; [|destruct (Z.eqb_spec h 0) as [->|H2]].
  - repeat split; try congruence. apply HS. unfold INFINITE. lia.
  - split; [split; [apply bounded_fits; unfold fits; lia | congruence] | apply HS; lia].
  - split; [split; [apply bounded_fits; unfold fits; rewrite Z2Pos.id; lia | congruence] |].
    unfold rank. rewrite Z2Pos.id by lia. apply HS. lia.
Qed.

(** Comparisons of doubles are comparisons of ranks. *)
Lemma ltb_rank : forall x y, is_double x -> is_double y -> SFltb x y = (rank x <? rank y).
Proof. intros x y Hx Hy. unfold SFltb, Z.ltb. rewrite compare_rank by auto. now destruct (rank x ?= rank y). Qed.
Lemma leb_rank : forall x y, is_double x -> is_double y -> SFleb x y = (rank x <=? rank y).
Proof. intros x y Hx Hy. unfold SFleb, Z.leb. rewrite compare_rank by auto. now destruct (rank x ?= rank y). Qed.
Lemma eqb_rank : forall x y, is_double x -> is_double y -> SFeqb x y = (rank x =? rank y).
Proof.
  intros x y Hx Hy. unfold SFeqb. rewrite compare_rank, Z.eqb_compare by auto. now destruct (rank x ?= rank y).
Qed.

Lemma abs_rank : forall x, is_double x -> is_double (SFabs x) /\ rank (SFabs x) = Z.abs (rank x).
Proof.
  intros [s|s| |s m e] [H N]; try congruence; unfold SFabs; (split; [split; [exact H | congruence]|]); unfold rank.
  - reflexivity.
  - destruct s; cbn [cond_Zopp]; unfold INFINITE; lia.
  - apply bounded_fits, rank_bound in H. destruct s; cbn [cond_Zopp]; lia.
Qed.

Lemma opp_finite : forall x, is_finite x -> is_finite (SFopp x) /\ units (SFopp x) = - units x.
Proof. intros [s|s| |s m e] H; try contradiction; split; auto; unfold units, SFopp; destruct s; cbn [negb cond_Zopp]; lia. Qed.

Lemma sub_add : forall x y, sub x y = add x (SFopp y).
Proof.
  intros [s|s| |s m e] [s'|s'| |s' m' e']; auto. unfold sub, add, SFsub, SFadd, SFopp. f_equal. now destruct s'.
Qed.

Lemma sub_self : forall x, is_finite x -> rank (sub x x) = 0.
Proof.
  intros x Hx. rewrite sub_add. destruct (opp_finite x Hx) as [Ho E].
  destruct (add_finite x (SFopp x) Hx Ho) as [_ ->].
  now rewrite E, Z.add_opp_diag_r.
Qed.

Lemma nearest_opp : forall n, nearest (- n) = - nearest n.
Proof. intros [|p|p]; cbn [nearest Z.opp]; lia. Qed.

(** [near x c m]: whether x and c differ by at most m, as computed. *)
Definition near (x c m : spec_float) : bool := SFleb (SFabs (sub x c)) m.

Lemma near_finite : forall x c m, is_double x -> is_finite c -> is_finite m ->
  near x c m = (Z.abs (rank (sub x c)) <=? rank m).
Proof.
  intros x c m Hx Hc Hm. unfold near. rewrite sub_add. destruct (opp_finite c Hc) as [Ho _].
  destruct (abs_rank _ (add_double x _ Hx Ho)) as [A B]. now rewrite leb_rank, B by auto using finite_double.
Qed.

Lemma near_infinite : forall x c m, is_double x -> is_double c -> is_finite m ->
  ~ (is_finite x /\ is_finite c) -> near x c m = false.
Proof.
  intros x c m Hx Hc Hm H.
  assert (HI : SFleb (S754_infinity false) m = false).
  { rewrite leb_rank; [|split; [reflexivity | congruence] | auto using finite_double].
    pose proof (rank_finite m Hm). now apply Z.leb_gt. }
  destruct (double_cases x Hx) as [Fx|[s ->]], (double_cases c Hc) as [Fc|[s' ->]]; try tauto; unfold near, sub.
  - destruct x; try contradiction; exact HI.
  - destruct c; try contradiction; exact HI.
  - destruct s, s'; simpl; auto.
Qed.

Lemma near_sym : forall x c m, is_double x -> is_double c -> is_finite m -> near c x m = near x c m.
Proof.
  intros x c m Hx Hc Hm.
  destruct (double_cases x Hx) as [Fx|[s ->]]; [destruct (double_cases c Hc) as [Fc|[s ->]]|];
    try (rewrite !near_infinite by (auto; simpl; tauto); reflexivity).
  rewrite !near_finite, !sub_add by auto. destruct (opp_finite x Fx) as [Ox Ux], (opp_finite c Fc) as [Oc Uc].
  destruct (add_finite c _ Fc Ox) as [_ ->], (add_finite x _ Fx Oc) as [_ ->]. rewrite Ux, Uc.
  replace (units c + - units x) with (- (units x + - units c)) by lia. now rewrite nearest_opp, Z.abs_opp.
Qed.

Lemma eqb_sym : forall x y, is_double x -> is_double y -> SFeqb x y = SFeqb y x.
Proof. intros x y Hx Hy. rewrite !eqb_rank by auto. apply Z.eqb_sym. Qed.

(** * A condition changes at most once between pivots *)

(** On the ranks above [low] up to [high], where f is once as at [high] it stays so. *)
Definition changes_once (f : Z -> bool) (low high : Z) : Prop :=
  forall r r', low < r <= r' -> r' <= high -> f r = f high -> f r' = f high.

(** A condition as a function of the rank. *)
Definition at_place (c : comparison_with) (r : Z) : bool := condition c (at_rank r).

Lemma rising : forall f low high, (forall r r', low < r <= r' -> r' <= high -> f r = true -> f r' = true) ->
  changes_once f low high.
Proof.
  intros f low high H r r' Hr Hr' E. destruct (f high) eqn:Eh; [now apply (H r r')|].
  destruct (f r') eqn:E'; auto. rewrite (H r' high) in Eh; auto; lia.
Qed.
Lemma falling : forall f low high, (forall r r', low < r <= r' -> r' <= high -> f r' = true -> f r = true) ->
  changes_once f low high.
Proof.
  intros f low high H r r' Hr Hr' E. destruct (f high) eqn:Eh; [apply (H r' high); auto; lia|].
  destruct (f r') eqn:E'; auto. rewrite (H r r') in E; auto.
Qed.

Lemma place : forall r low high, - INFINITE <= low -> high <= INFINITE -> low < r <= high ->
  is_double (at_rank r) /\ rank (at_rank r) = r.
Proof. intros. apply at_rank_double. lia. Qed.

(** The same, be it infinite, or near. Subtracting the constant gives 0 at it, and keeps the order. *)
Lemma near_changes_once : forall c m low high, is_double c -> is_finite m -> - INFINITE <= low -> high <= INFINITE ->
  rank c <= low \/ high <= rank c -> changes_once (fun r => SFeqb (at_rank r) c || near (at_rank r) c m) low high.
Proof.
  intros c m low high Hc Hm Hl Hh Hp.
  assert (HP : forall r, low < r <= high -> is_double (at_rank r) /\ rank (at_rank r) = r)
    by (intros; now apply (place r low high)).
  assert (HE : forall r, low < r <= high -> SFeqb (at_rank r) c = (r =? rank c)).
  { intros r Hr. destruct (HP r Hr) as [A B]. now rewrite eqb_rank, B by auto. }
  destruct (double_cases c Hc) as [Fc|[s ->]].
  2: { intros r r' Hr Hr'. rewrite !HE by lia.
       rewrite !near_infinite, !orb_false_r by (auto; try apply HP; simpl; try tauto; lia). lia. }
  assert (HN : forall r r', low < r <= r' -> r' <= high ->
    near (at_rank r) c m = (Z.abs (rank (sub (at_rank r) c)) <=? rank m) /\
    near (at_rank r') c m = (Z.abs (rank (sub (at_rank r') c)) <=? rank m) /\
    (rank c <= low -> 0 <= rank (sub (at_rank r) c) <= rank (sub (at_rank r') c)) /\
    (high <= rank c -> rank (sub (at_rank r) c) <= rank (sub (at_rank r') c) <= 0)).
  { intros r r' Hr Hr'. destruct (HP r ltac:(lia)) as [A1 A2], (HP r' ltac:(lia)) as [B1 B2].
    rewrite !near_finite by auto. rewrite <- (sub_self c Fc), !sub_add. destruct (opp_finite c Fc) as [Oc _].
    repeat split; apply add_le; auto; lia. }
  destruct Hp as [Hp|Hp]; [apply falling | apply rising]; intros r r' Hr Hr'; rewrite !HE by lia;
    destruct (HN r r' Hr Hr') as (-> & -> & H1 & H2); rewrite !orb_true_iff, !Z.eqb_eq, !Z.leb_le; lia.
Qed.

Theorem condition_changes_once : forall c low high, well_formed c -> - INFINITE <= low -> high <= INFINITE ->
  rank (constant c) <= low \/ high <= rank (constant c) -> changes_once (at_place c) low high.
Proof.
  intros [k m c left] low high [Hc Hm] Hl Hh Hp. cbn [margin constant] in *. pose proof (add_double c m Hc Hm) as HA.
  assert (HD : forall r r', low < r <= r' -> r' <= high -> exists x y, at_rank r = x /\ at_rank r' = y /\
    is_double x /\ is_double y /\ is_double (add x m) /\ is_double (add y m) /\
    rank x = r /\ rank y = r' /\ rank (add x m) <= rank (add y m)).
  { intros r r' Hr Hr'. destruct (place r low high Hl Hh ltac:(lia)) as [A1 A2], (place r' low high Hl Hh ltac:(lia)) as [B1 B2].
    exists (at_rank r), (at_rank r'). repeat (split; [now auto using add_double|]). apply add_le; auto; lia. }
  unfold changes_once, at_place, condition, holds. cbn [relates margin constant constant_is_left].
  destruct k; [| |destruct (SFeqb m (S754_zero false))|..].
  - destruct left; [apply rising | apply falling]; intros r r' Hr Hr';
      destruct (HD r r' Hr Hr') as (x & y & -> & -> & ? & ? & ? & ? & ? & ? & ?); rewrite !ltb_rank, !Z.ltb_lt by auto; lia.
  - destruct left; [apply rising | apply falling]; intros r r' Hr Hr';
      destruct (HD r r' Hr Hr') as (x & y & -> & -> & ? & ? & ? & ? & ? & ? & ?); rewrite !leb_rank, !Z.leb_le by auto; lia.
  - intros r r' Hr Hr'. destruct (place r low high Hl Hh ltac:(lia)) as [A1 A2], (place r' low high Hl Hh ltac:(lia)) as [B1 B2],
      (place high low high Hl Hh ltac:(lia)) as [C1 C2]. destruct left; rewrite !eqb_rank by auto; lia.
  - pose proof (near_changes_once c m low high Hc Hm Hl Hh Hp) as HN. destruct left; [|exact HN].
    intros r r' Hr Hr'. fold (near c (at_rank r) m) (near c (at_rank r') m) (near c (at_rank high) m).
    rewrite !(near_sym _ c), !(eqb_sym c) by (auto; apply (place _ low high Hl Hh); lia). now apply (HN r r').
  - destruct left; [apply falling | apply rising]; intros r r' Hr Hr';
      destruct (HD r r' Hr Hr') as (x & y & -> & -> & ? & ? & ? & ? & ? & ? & ?); rewrite !leb_rank, !Z.leb_le by auto; lia.
  - destruct left; [apply falling | apply rising]; intros r r' Hr Hr';
      destruct (HD r r' Hr Hr') as (x & y & -> & -> & ? & ? & ? & ? & ? & ? & ?); rewrite !ltb_rank, !Z.ltb_lt by auto; lia.
Qed.

(** What holds of a double depends on its rank. *)
Lemma condition_rank : forall c x, well_formed c -> is_double x -> condition c x = at_place c (rank x).
Proof.
  intros [k m c left] x [Hc Hm] Hx. destruct (at_rank_double (rank x) (rank_range x Hx)) as [Hy E].
  unfold at_place, condition, holds. cbn [relates margin constant constant_is_left] in *. set (y := at_rank (rank x)) in *.
  assert (HA : rank (add y m) = rank (add x m)) by (apply Z.le_antisymm; apply add_le; auto; lia).
  pose proof (add_double x m Hx Hm). pose proof (add_double y m Hy Hm). pose proof (add_double c m Hc Hm).
  assert (HE : near y c m = near x c m).
  { destruct (double_cases c Hc) as [Fc|[s ->]].
    - destruct (opp_finite c Fc) as [Oc _]. rewrite !near_finite, !sub_add by auto. do 2 f_equal.
      apply Z.le_antisymm; apply add_le; auto; lia.
    - rewrite !near_infinite; auto; simpl; tauto. }
  fold (near x c m) (near y c m) (near c x m) (near c y m). rewrite !(near_sym _ c), HE by auto.
  destruct left, k; try destruct (SFeqb m (S754_zero false)); rewrite ?ltb_rank, ?leb_rank, ?eqb_rank by auto;
    now rewrite ?HA, ?E.
Qed.

(** * The samples, and the letters that they give *)

(** The first rank from [first] to [high] at which f is [last], if it changes at most once; [fuel] bounds the search. *)
Fixpoint bisect (fuel : nat) (f : Z -> bool) (last : bool) (first high : Z) : Z :=
  match fuel with
  | O => high
  | S fuel =>
      if first <? high then
        let middle := (first + high) / 2 in
        if Bool.eqb (f middle) last then bisect fuel f last first middle else bisect fuel f last (middle + 1) high
      else high
  end.
Definition change (f : Z -> bool) (low high : Z) : Z := bisect 64 f (f high) (low + 1) high.

(** Each once, in ascending order. *)
Fixpoint insert (r : Z) (l : list Z) : list Z :=
  match l with
  | [] => [r]
  | x :: l' => if r <? x then r :: l else if r =? x then l else x :: insert r l'
  end.

(** Each pivot, the rank after it, and where a condition changes before the next. *)
Fixpoint cut (fs : list (Z -> bool)) (pivots : list Z) : list Z :=
  match pivots with
  | low :: (high :: _) as rest => low :: low + 1 :: map (fun f => change f low high) fs ++ cut fs rest
  | _ => pivots
  end.

(** A line of numbers that are doubles, such as those of a type: they have the ranks from [least] to [most] there.
    [place_of] is the place of each among all doubles, [floor] the rank of the last that is not above a place. *)
Record line := { least : Z; most : Z; place_of : Z -> Z; floor : Z -> Z }.

Definition on (l : line) (r : Z) : Prop := least l <= r <= most l.

Definition is_line (l : line) : Prop :=
  least l <= most l /\ - INFINITE <= least l /\ most l <= INFINITE /\
  (forall r, on l r -> - INFINITE <= place_of l r <= INFINITE) /\
  (forall r r', on l r -> on l r' -> r < r' -> place_of l r < place_of l r') /\
  (forall p r, on l r -> place_of l r <= p <-> r <= floor l p).

(** As [samples] in [cells.py]. *)
Definition samples (l : line) (fs : list (Z -> bool)) (pivots : list Z) : list Z :=
  cut fs (fold_right insert []
    (filter (fun r => (least l <=? r) && (r <=? most l)) (least l :: most l :: map (floor l) pivots))).

(** As [_line_valuations] in [alphabet.py]: a letter says of each comparison whether it holds. *)
Definition valuations_on (l : line) (cs : list comparison_with) : list (list bool) :=
  map (fun r => map (fun c => at_place c (place_of l r)) cs)
    (samples l (map (fun c r => at_place c (place_of l r)) cs) (map (fun c => rank (constant c)) cs)).

(** All doubles from one on. *)
Definition doubles_from (x : spec_float) : line :=
  {| least := rank x; most := INFINITE; place_of := fun r => r; floor := fun p => p |}.

Definition valuations (cs : list comparison_with) (x : spec_float) : list (list bool) := valuations_on (doubles_from x) cs.

Lemma bisect_sound : forall f low top, changes_once f low top -> forall fuel first high,
  low < first <= high -> high <= top -> high - first < 2 ^ Z.of_nat fuel ->
  (forall r, low < r < first -> f r <> f top) -> f high = f top ->
  let r := bisect fuel f (f top) first high in
  first <= r <= high /\ f r = f top /\ forall r', low < r' < r -> f r' <> f top.
Proof.
  intros f low top HC. induction fuel as [|fuel IH]; intros first high H1 H2 H3 H4 H5; cbn [bisect].
  - replace first with high in H4 by (simpl in H3; lia). split; [lia|]. auto.
  - rewrite Nat2Z.inj_succ, Z.pow_succ_r in H3 by lia. destruct (Z.ltb_spec first high) as [Hlt|Hge].
    2: { replace first with high in H4 by lia. split; [lia|]. auto. }
    cbv zeta. set (middle := (first + high) / 2).
    assert (HM : first <= middle < high /\ 2 * middle <= first + high <= 2 * middle + 1).
    { unfold middle. pose proof (Z.div_mod (first + high) 2). pose proof (Z.mod_pos_bound (first + high) 2). lia. }
    destruct (Bool.eqb (f middle) (f top)) eqn:E.
    + apply eqb_prop in E. destruct (IH first middle) as (A & B & C); auto; try lia. split; [lia|]. auto.
    + apply eqb_false_iff in E. destruct (IH (middle + 1) high) as (A & B & C); auto; try lia.
      * intros r Hr Er. apply E. apply (HC r middle); auto; lia.
      * split; [lia|]. auto.
Qed.

Definition in_range (r : Z) : Prop := - INFINITE <= r <= INFINITE.

Lemma change_sound : forall f low high, in_range low -> in_range high -> low < high -> changes_once f low high ->
  let r := change f low high in
  low < r <= high /\ forall r', low < r' <= high -> (f r' = f high <-> r <= r').
Proof.
  intros f low high Hl Hh H HC. unfold in_range, INFINITE in *.
  destruct (bisect_sound f low high HC 64 (low + 1) high) as (A & B & C); [lia | lia | | lia | reflexivity |].
  { change (2 ^ Z.of_nat 64) with (2 ^ 64). lia. }
  unfold change. generalize dependent (bisect 64 f (f high) (low + 1) high). intros r A B C. cbv zeta.
  split; [lia|]. intros r' Hr'. split.
  - intros E. apply Z.nlt_ge. intros Hlt. apply (C r'); auto; lia.
  - intros Hle. apply (HC r r'); auto; lia.
Qed.

Local Opaque change.

Lemma latest : forall {A} (place : A -> Z) xs first r, first <= r ->
  exists s, In s (first :: map place xs) /\ first <= s <= r /\ forall x, In x xs -> place x <= r -> place x <= s.
Proof.
  intros A place xs first r Hr. induction xs as [|x xs (s & A1 & A2 & A3)].
  - exists first. split; [now left|]. split; [lia | intros x []].
  - assert (HI : forall z, In z (first :: map place xs) -> In z (first :: map place (x :: xs))) by (intros z []; simpl; auto).
    destruct (Z_le_gt_dec (place x) r), (Z_le_gt_dec (place x) s);
      try (exists s; split; [auto|]; split; [lia|]; intros y [<-|Hy] Hyr; [lia | auto]; fail).
    exists (place x). split; [right; now left|]. split; [lia|]. intros y [<-|Hy] Hyr; [lia|]. specialize (A3 y Hy Hyr). lia.
Qed.

(** Between two pivots, each rank has the conditions of a sample. *)
Lemma gap_complete : forall fs low high r, in_range low -> in_range high -> low < r <= high ->
  (forall f, In f fs -> changes_once f low high) ->
  exists s, In s (low + 1 :: map (fun f => change f low high) fs) /\ forall f, In f fs -> f s = f r.
Proof.
  intros fs low high r Hl Hh Hr HC.
  destruct (latest (fun f => change f low high) fs (low + 1) r ltac:(lia)) as (s & A & B & C).
  exists s. split; [exact A|]. intros f Hf.
  destruct (change_sound f low high Hl Hh ltac:(lia) (HC f Hf)) as [_ D]. cbv zeta in D.
  pose proof (D s ltac:(lia)) as Ds. pose proof (D r ltac:(lia)) as Dr. specialize (C f Hf).
  destruct (Z_le_gt_dec (change f low high) r) as [Hle|Hgt].
  - now rewrite (proj2 Dr Hle), (proj2 Ds (C Hle)).
  - assert (f s <> f high) by (rewrite Ds; lia). assert (f r <> f high) by (rewrite Dr; lia).
    destruct (f s), (f r), (f high); congruence.
Qed.

Lemma in_insert : forall r l x, In x (insert r l) <-> x = r \/ In x l.
Proof.
  intros r. induction l as [|y l IH]; intros x; cbn [insert In]; [intuition congruence|].
  destruct (Z.ltb_spec r y); [cbn [In]; intuition congruence|]. destruct (Z.eqb_spec r y); cbn [In]; [|rewrite IH];
    intuition congruence.
Qed.

Lemma sorted_insert : forall r l, StronglySorted Z.lt l -> StronglySorted Z.lt (insert r l).
Proof.
  intros r. induction l as [|y l IH]; intros H; cbn [insert]; [repeat constructor|]. apply StronglySorted_inv in H.
  destruct H as [H1 H2]. destruct (Z.ltb_spec r y) as [Hr|Hr]; [|destruct (Z.eqb_spec r y)].
  - constructor; [now constructor|]. constructor; auto. eapply Forall_impl; [|exact H2]. intros; lia.
  - now constructor.
  - constructor; auto. apply Forall_forall. intros x Hx. rewrite Forall_forall in H2. apply in_insert in Hx.
    destruct Hx as [->|Hx]; [lia | auto].
Qed.

Definition gaps_once (fs : list (Z -> bool)) (l : list Z) : Prop :=
  forall low high, In low l -> In high l -> low < high -> (forall x, In x l -> x <= low \/ high <= x) ->
  forall f, In f fs -> changes_once f low high.

Lemma cut_right : forall fs l, StronglySorted Z.lt l -> (forall x, In x l -> in_range x) -> gaps_once fs l ->
  (forall s, In s (cut fs l) -> exists x y, In x l /\ In y l /\ x <= s <= y) /\
  forall x y r, In x l -> In y l -> x <= r <= y -> exists s, In s (cut fs l) /\ forall f, In f fs -> f s = f r.
Proof.
  intros fs. induction l as [|low l IH]; intros HS HR HG; [split; [intros s [] | intros x y r []]|].
  apply StronglySorted_inv in HS. destruct HS as [HS HF]. rewrite Forall_forall in HF. destruct l as [|high rest].
  { split.
    - intros s [<-|[]]. exists low, low. split; [now left|]. split; [now left | lia].
    - intros x y r [<-|[]] [<-|[]] Hr. exists low. split; [now left|]. intros. f_equal. lia. }
  assert (Hlh : low < high) by (apply HF; now left).
  assert (Hgap : forall f, In f fs -> changes_once f low high).
  { apply HG; try (simpl; tauto); auto. intros x [<-|Hx]; [lia|]. right. destruct Hx as [<-|Hx]; [lia|].
    apply StronglySorted_inv in HS. destruct HS as [_ HS]. rewrite Forall_forall in HS. specialize (HS x Hx). lia. }
  destruct IH as [IH1 IH2]; auto.
  { intros x Hx. apply HR. now right. }
  { intros lo hi Hlo Hhi Hlt Hx. apply HG; try (now right); auto. intros x [<-|Hx']; [|auto].
    specialize (HF lo Hlo). lia. }
  assert (Rl : in_range low) by (apply HR; now left). assert (Rh : in_range high) by (apply HR; right; now left).
  change (cut fs (low :: high :: rest)) with (low :: (low + 1) :: map (fun f => change f low high) fs ++ cut fs (high :: rest)).
  split.
  - intros s [<-|[<-|Hs]]; [exists low, low | exists low, high |]; try (split; [|split]; simpl; auto; lia).
    apply in_app_iff in Hs. destruct Hs as [Hs|Hs].
    + apply in_map_iff in Hs. destruct Hs as (f & <- & Hf).
      destruct (change_sound f low high Rl Rh Hlh (Hgap f Hf)) as [A _]. exists low, high. split; [|split]; simpl; auto; lia.
    + destruct (IH1 s Hs) as (x & y & A & B & C). exists x, y. split; [|split]; auto; now right.
  - intros x y r Hx Hy Hr. destruct (Z_le_gt_dec high r) as [Hle|Hgt].
    + assert (Hy' : In y (high :: rest)) by (destruct Hy as [<-|Hy]; [lia | exact Hy]).
      destruct (IH2 high y r) as (s & A & B); auto; [now left | lia |]. exists s. split; auto.
      right. right. apply in_app_iff. now right.
    + assert (Hlr : low <= r) by (destruct Hx as [<-|Hx]; [|specialize (HF x Hx)]; lia).
      destruct (Z.eq_dec low r) as [<-|Hne]; [exists low; split; auto; now left|].
      destruct (gap_complete fs low high r Rl Rh ltac:(lia) Hgap) as (s & A & B). exists s. split; auto.
      right. destruct A as [<-|A]; [now left|]. right. apply in_app_iff. now left.
Qed.

(** On a line, a condition changes at most once between pivots, for it does so among all doubles. *)
Lemma line_changes_once : forall l c low high, is_line l -> well_formed c -> on l low -> on l high -> low < high ->
  floor l (rank (constant c)) <= low \/ high <= floor l (rank (constant c)) ->
  changes_once (fun r => at_place c (place_of l r)) low high.
Proof.
  intros l c low high (_ & _ & _ & HB & HI & HF) HW Hl Hh Hlh Hp. set (p := rank (constant c)) in *.
  pose proof (rank_range _ (proj1 HW)) as HR. fold p in HR. pose proof (HB _ Hl). pose proof (HB _ Hh).
  assert (HM : forall r, low < r <= high -> on l r /\ place_of l low < place_of l r <= place_of l high).
  { intros r Hr. assert (Ho : on l r) by (unfold on in *; lia). split; [exact Ho|]. split; [apply HI; auto; lia|].
    destruct (Z.eq_dec r high) as [->|]; [lia|]. apply Z.lt_le_incl, HI; auto; lia. }
  assert (HO : exists q, changes_once (at_place c) q (place_of l high) /\
    forall r, low < r <= high -> q < place_of l r).
  { destruct Hp as [Hp|Hp].
    - exists p. split; [apply condition_changes_once; auto; fold p; lia|]. intros r Hr. destruct (HM r Hr) as [Ho _].
      apply Z.nle_gt. intros HC. apply (HF p r Ho) in HC. lia.
    - exists (place_of l low). apply HF in Hp; auto.
      split; [apply condition_changes_once; auto; fold p; lia|]. intros r Hr. apply (HM r Hr). }
  destruct HO as (q & HC & HQ). intros r r' Hr Hr'. destruct (HM r ltac:(lia)) as [A1 A2], (HM r' ltac:(lia)) as [B1 B2].
  pose proof (HQ r ltac:(lia)). apply HC; [|lia]. destruct (Z.eq_dec r r') as [->|]; [lia|]. pose proof (HI r r' A1 B1). lia.
Qed.

(** The letters that are computed are those that some number of the line gives, and no others. *)
Theorem valuations_on_exact : forall l cs, is_line l -> (forall c, In c cs -> well_formed c) ->
  forall v, In v (valuations_on l cs) <->
    exists r, on l r /\ v = map (fun c => condition c (at_rank (place_of l r))) cs.
Proof.
  intros l cs HL HW v. pose proof HL as (H0 & H1 & H2 & _). unfold valuations_on, samples.
  set (wanted := filter _ _). set (fs := map _ cs). set (pivots := fold_right insert [] wanted).
  assert (HI : forall x, In x pivots <-> on l x /\
    (x = least l \/ x = most l \/ exists c, In c cs /\ x = floor l (rank (constant c)))).
  { intros x. transitivity (In x wanted).
    - unfold pivots. generalize wanted. intros w. induction w as [|y w IH]; cbn [fold_right In]; [tauto|].
      rewrite in_insert, IH. intuition congruence.
    - unfold wanted, on. rewrite filter_In, andb_true_iff, !Z.leb_le. cbn [In]. rewrite map_map, in_map_iff. split.
      + intros [[<-|[<-|(c & <- & Hc)]] H]; split; auto. right. right. exists c. auto.
      + intros [H [->|[->|(c & Hc & ->)]]]; split; auto. right. right. exists c. auto. }
  assert (HS : StronglySorted Z.lt pivots).
  { unfold pivots. generalize wanted. intros w. induction w; cbn [fold_right]; [constructor | now apply sorted_insert]. }
  assert (HR : forall x, In x pivots -> in_range x) by (intros x Hx; apply HI in Hx; unfold in_range, on in *; lia).
  assert (HG : gaps_once fs pivots).
  { intros low high A B C D f Hf. apply in_map_iff in Hf. destruct Hf as (c & <- & Hc).
    pose proof (proj1 (proj1 (HI _) A)) as OA. pose proof (proj1 (proj1 (HI _) B)) as OB.
    apply line_changes_once; auto. set (p := floor l (rank (constant c))).
    destruct (Z_le_gt_dec (least l) p), (Z_le_gt_dec p (most l)); unfold on in *; try lia.
    apply D, HI. unfold on. split; [lia|]. right. right. exists c. auto. }
  destruct (cut_right fs pivots HS HR HG) as [C1 C2]. rewrite in_map_iff. split.
  - intros (r & <- & Hr). destruct (C1 r Hr) as (x & y & A & B & D). apply HI in A. apply HI in B.
    exists r. split; [unfold on in *; lia | reflexivity].
  - intros (r & Hr & ->). destruct (C2 (least l) (most l) r) as (s & A & B); try (apply HI; unfold on in *; split; [lia | auto]);
      [unfold on in Hr; lia|].
    exists s. split; auto. apply map_ext_in. intros c Hc. apply (B (fun r => at_place c (place_of l r))).
    apply in_map_iff. exists c. auto.
Qed.

Lemma doubles_line : forall x, is_double x -> is_line (doubles_from x).
Proof.
  intros x Hx. pose proof (rank_range x Hx). unfold is_line, on, doubles_from. cbn [least most place_of floor].
  repeat split; intros; lia.
Qed.

(** Of doubles: the letters that some double from [x] on gives. *)
Theorem valuations_exact : forall cs x, (forall c, In c cs -> well_formed c) -> is_double x ->
  forall v, In v (valuations cs x) <->
    exists y, is_double y /\ rank x <= rank y /\ v = map (fun c => condition c y) cs.
Proof.
  intros cs x HW Hx v. pose proof (rank_range x Hx) as RX. unfold valuations.
  rewrite (valuations_on_exact _ _ (doubles_line x Hx) HW). unfold on, doubles_from. cbn [least most place_of]. split.
  - intros (r & Hr & ->). destruct (at_rank_double r ltac:(lia)) as [E F]. exists (at_rank r). rewrite F. repeat split; try apply E. lia.
  - intros (y & Hy & Hxy & ->). pose proof (rank_range y Hy). exists (rank y). split; [lia|].
    apply map_ext_in. intros c Hc. now apply condition_rank; [apply HW|].
Qed.

(** * The lines of the types of fields *)

(** A line by the places of its numbers alone; [floor] is searched for. *)
Definition above (hi : Z) (place : Z -> Z) (p r : Z) : bool := (hi <? r) || (p <? place r).
Definition line_of (lo hi : Z) (place : Z -> Z) : line :=
  {| least := lo; most := hi; place_of := place; floor := fun p => bisect 64 (above hi place p) true lo (hi + 1) - 1 |}.

Lemma line_of_line : forall lo hi place, lo <= hi -> - INFINITE <= lo -> hi <= INFINITE ->
  (forall r, lo <= r <= hi -> - INFINITE <= place r <= INFINITE) ->
  (forall r r', lo <= r -> r' <= hi -> r < r' -> place r < place r') -> is_line (line_of lo hi place).
Proof.
  intros lo hi place H1 H2 H3 HB HI. unfold is_line, on, line_of. cbn [least most place_of floor].
  split; [exact H1|]. split; [exact H2|]. split; [exact H3|]. split; [exact HB|]. split; [intros; apply HI; lia|].
  intros p r Hr. set (f := above hi place p). assert (HT : f (hi + 1) = true) by (unfold f, above; apply orb_true_iff; left; apply Z.ltb_lt; lia).
  assert (HC : changes_once f (lo - 1) (hi + 1)).
  { apply rising. unfold f, above. intros x y Hx Hy. rewrite !orb_true_iff, !Z.ltb_lt. intros [A|A]; [left; lia|].
    destruct (Z_lt_le_dec hi y); [left; lia|]. right. destruct (Z.eq_dec x y) as [->|]; [lia|].
    pose proof (HI x y). lia. }
  destruct (bisect_sound f (lo - 1) (hi + 1) HC 64 lo (hi + 1)) as (A & B & C); try lia; auto.
  { change (2 ^ Z.of_nat 64) with (2 ^ 64). unfold INFINITE in *. lia. }
  rewrite HT in *. generalize dependent (bisect 64 f true lo (hi + 1)). intros s A B C. split.
  - intros Hp. apply Z.nlt_ge. intros Hs. assert (E : f r = true).
    { rewrite <- HT. apply (HC s r); try lia. congruence. }
    unfold f, above in E. apply orb_true_iff in E. rewrite !Z.ltb_lt in E. lia.
  - intros Hs. assert (E : f r <> true) by (apply C; lia). apply not_true_is_false, orb_false_iff in E.
    rewrite !Z.ltb_ge in E. lia.
Qed.

(** A short number, shifted, in units of the smallest double, is a double, and its place is known. *)
Definition short_place (n s : Z) : Z :=
  let k := Z.log2 (Z.abs n) in Z.sgn n * ((s + k - 52) * 2 ^ 52 + Z.abs n * 2 ^ (52 - k)).

Lemma short_is_exact : forall n s, Z.abs n < 2 ^ 53 -> 52 <= s <= 1993 ->
  exists x, is_finite x /\ units x = n * 2 ^ s /\ rank x = short_place n s.
Proof.
  intros n s Hn Hs. unfold short_place.
  destruct (Z.eq_dec n 0) as [->|H0]; [exists (S754_zero false); repeat split; simpl; auto; lia|].
  set (k := Z.log2 (Z.abs n)). pose proof (Z.log2_spec (Z.abs n) ltac:(lia)) as [A B]. fold k in A, B.
  assert (Hk : 0 <= k < 53) by (split; [apply Z.log2_nonneg | apply Z.log2_lt_pow2; lia]).
  assert (E : 2 ^ (52 - k) * 2 ^ k = 2 ^ 52) by (rewrite <- Z.pow_add_r by lia; f_equal; lia).
  assert (HP : 0 < 2 ^ (52 - k)) by (apply Z.pow_pos_nonneg; lia).
  rewrite Z.pow_succ_r in B by lia.
  assert (HM : 2 ^ 52 <= Z.abs n * 2 ^ (52 - k) < 2 ^ 53) by (change (2 ^ 53) with (2 * 2 ^ 52); nia).
  exists (S754_finite (n <? 0) (Z.to_pos (Z.abs n * 2 ^ (52 - k))) (EMIN + (s + k - 52))). split; [|split].
  - cbn [is_finite]. unfold fits. rewrite Z2Pos.id by lia. lia.
  - cbn [units]. rewrite Z2Pos.id by lia. replace (EMIN + (s + k - 52) - EMIN) with (s - (52 - k)) by lia.
    assert (E2 : Z.abs n * 2 ^ (52 - k) * 2 ^ (s - (52 - k)) = Z.abs n * 2 ^ s).
    { rewrite <- Z.mul_assoc, <- Z.pow_add_r by lia. do 2 f_equal. lia. }
    rewrite E2. destruct (Z.ltb_spec n 0); cbn [cond_Zopp]; nia.
  - cbn [rank]. rewrite Z2Pos.id by lia. replace (EMIN + (s + k - 52) - EMIN) with (s + k - 52) by lia.
    destruct (Z.ltb_spec n 0); cbn [cond_Zopp]; [rewrite (Z.sgn_neg n) by lia | rewrite (Z.sgn_pos n) by lia]; ring.
Qed.

Lemma short_lt : forall n s n' s', Z.abs n < 2 ^ 53 -> 52 <= s <= 1993 -> Z.abs n' < 2 ^ 53 -> 52 <= s' <= 1993 ->
  n * 2 ^ s < n' * 2 ^ s' -> short_place n s < short_place n' s'.
Proof.
  intros n s n' s' H1 H2 H3 H4 H. destruct (short_is_exact n s H1 H2) as (x & Hx & Ex & <-).
  destruct (short_is_exact n' s' H3 H4) as (y & Hy & Ey & <-). pose proof (units_le y x Hy Hx). lia.
Qed.

Lemma short_range : forall n s, Z.abs n < 2 ^ 53 -> 52 <= s <= 1993 -> - INFINITE < short_place n s < INFINITE.
Proof. intros n s H1 H2. destruct (short_is_exact n s H1 H2) as (x & Hx & _ & <-). now apply rank_finite. Qed.

(** Integers that are doubles: their own ranks. *)
Definition integers (lo hi : Z) : line := line_of lo hi (fun n => short_place n 1074).

Theorem integers_line : forall lo hi, - 2 ^ 53 < lo -> lo <= hi -> hi < 2 ^ 53 -> is_line (integers lo hi).
Proof.
  intros lo hi H1 H2 H3. apply line_of_line; try (unfold INFINITE; lia).
  - intros r Hr. pose proof (short_range r 1074). lia.
  - intros r r' Hr Hr' Hlt. apply short_lt; lia.
Qed.

(** The numbers of binary32: their bits but the sign are the rank; those of the infinities are [SINGLE_INFINITE]. *)
Definition SINGLE_INFINITE : Z := 255 * 2 ^ 23.
Definition single_mantissa (r : Z) : Z :=
  let a := Z.abs r in Z.sgn r * (if a <? 2 ^ 23 then a else 2 ^ 23 + a mod 2 ^ 23).
Definition single_shift (r : Z) : Z := 925 + Z.max 0 (Z.abs r / 2 ^ 23 - 1).
Definition single_place (r : Z) : Z :=
  if SINGLE_INFINITE <=? r then INFINITE else if r <=? - SINGLE_INFINITE then - INFINITE
  else short_place (single_mantissa r) (single_shift r).
Definition singles_from (lo : Z) : line := line_of lo SINGLE_INFINITE single_place.

Lemma single_grows : forall r r', r < r' ->
  single_mantissa r * 2 ^ single_shift r < single_mantissa r' * 2 ^ single_shift r'.
Proof.
  set (m := fun a => if a <? 2 ^ 23 then a else 2 ^ 23 + a mod 2 ^ 23). set (h := fun a => Z.max 0 (a / 2 ^ 23 - 1)).
  assert (HP : forall k, 0 <= k -> 0 < 2 ^ k) by (intros; apply Z.pow_pos_nonneg; lia).
  assert (HM : forall a b, 0 <= a < b -> m a * 2 ^ h a < m b * 2 ^ h b).
  { intros a b H. unfold m, h.
    pose proof (Z.div_mod a (2 ^ 23) ltac:(lia)) as Ea. pose proof (Z.mod_pos_bound a (2 ^ 23) ltac:(lia)) as Ba.
    pose proof (Z.div_mod b (2 ^ 23) ltac:(lia)) as Eb. pose proof (Z.mod_pos_bound b (2 ^ 23) ltac:(lia)) as Bb.
    set (q := a / 2 ^ 23) in *. set (x := a mod 2 ^ 23) in *. set (q' := b / 2 ^ 23) in *. set (x' := b mod 2 ^ 23) in *.
    destruct (Z.ltb_spec a (2 ^ 23)), (Z.ltb_spec b (2 ^ 23)); try lia.
    - replace (Z.max 0 (q - 1)) with 0 by lia. replace (Z.max 0 (q' - 1)) with 0 by lia. lia.
    - replace (Z.max 0 (q - 1)) with 0 by lia. pose proof (HP (Z.max 0 (q' - 1)) ltac:(lia)). nia.
    - replace (Z.max 0 (q - 1)) with (q - 1) by lia. replace (Z.max 0 (q' - 1)) with (q' - 1) by lia.
      pose proof (HP (q - 1) ltac:(lia)). destruct (Z.eq_dec q q') as [E|E]; [rewrite <- E; nia|].
      assert (E2 : 2 ^ (q' - 1) = 2 ^ (q' - 1 - q) * 2 * 2 ^ (q - 1)).
      { replace (q' - 1) with (q' - 1 - q + 1 + (q - 1)) at 1 by lia. now rewrite !Z.pow_add_r by lia. }
      pose proof (HP (q' - 1 - q) ltac:(lia)). rewrite E2. nia. }
  assert (HE : forall r, single_mantissa r * 2 ^ single_shift r = Z.sgn r * (m (Z.abs r) * 2 ^ h (Z.abs r)) * 2 ^ 925).
  { intros r. unfold single_mantissa, single_shift. fold (m (Z.abs r)). fold (h (Z.abs r)).
    rewrite Z.pow_add_r by (unfold h; lia). ring. }
  intros r r' H. rewrite !HE. apply Z.mul_lt_mono_pos_r; [apply HP; lia|].
  assert (H0 : m 0 * 2 ^ h 0 = 0) by reflexivity. pose proof (HM 0 (Z.abs r)). pose proof (HM 0 (Z.abs r')).
  pose proof (HM (Z.abs r) (Z.abs r')). pose proof (HM (Z.abs r') (Z.abs r)).
  destruct (Z.sgn_spec r) as [[A ->]|[[A ->]|[A ->]]], (Z.sgn_spec r') as [[B ->]|[[B ->]|[B ->]]]; lia.
Qed.

Lemma single_fits : forall r, - SINGLE_INFINITE < r < SINGLE_INFINITE ->
  Z.abs (single_mantissa r) < 2 ^ 53 /\ 52 <= single_shift r <= 1993.
Proof.
  intros r Hr. unfold SINGLE_INFINITE in Hr. unfold single_mantissa, single_shift.
  pose proof (Z.mod_pos_bound (Z.abs r) (2 ^ 23) ltac:(lia)).
  assert (Z.abs r / 2 ^ 23 < 255) by (apply Z.div_lt_upper_bound; lia). split; [|lia].
  destruct (Z.ltb_spec (Z.abs r) (2 ^ 23)), (Z.sgn_spec r) as [[_ ->]|[[_ ->]|[_ ->]]]; lia.
Qed.

Theorem singles_line : forall lo, - SINGLE_INFINITE <= lo <= SINGLE_INFINITE -> is_line (singles_from lo).
Proof.
  intros lo Hlo. assert (HR : forall r, - SINGLE_INFINITE < r < SINGLE_INFINITE ->
    - INFINITE < short_place (single_mantissa r) (single_shift r) < INFINITE) by (intros; now apply short_range; apply single_fits).
  apply line_of_line; try (unfold INFINITE, SINGLE_INFINITE in *; lia); unfold single_place.
  - intros r Hr. destruct (Z.leb_spec SINGLE_INFINITE r), (Z.leb_spec r (- SINGLE_INFINITE)); try (unfold INFINITE; lia).
    pose proof (HR r). lia.
  - intros r r' Hr Hr' Hlt. pose proof (HR r). pose proof (HR r'). assert (0 < SINGLE_INFINITE) by reflexivity.
    destruct (Z.leb_spec SINGLE_INFINITE r), (Z.leb_spec r (- SINGLE_INFINITE)),
      (Z.leb_spec SINGLE_INFINITE r'), (Z.leb_spec r' (- SINGLE_INFINITE)); try lia; try (unfold INFINITE; lia).
    apply short_lt; try (apply single_fits; lia). now apply single_grows.
Qed.
