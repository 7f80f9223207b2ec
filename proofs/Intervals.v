(** Intervals: `within [A, B], P` is said by a scope that opens when the scope around has been open for A.

    Words are of instants, one for each nanosecond at least. [interval_means]: what the encoding says is what intervals
    mean; [open_for]: that the scope has been open for A is a state predicate of the past.
    Python: [without_intervals] in [ltlc/semantics/intervals.py], [Within] in [properties.py]. *)
From Coq Require Import List Arith Lia Bool.
Require Import Ltl Properties Past.

Section Intervals.
  Variables (s : stream) (t : times).
  Hypothesis passes : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).

  (** k is the first instant of the segment that is A or more later than its first. *)
  Definition begins (L : option nat) (i A k : nat) : Prop :=
    i <= k /\ inside L k /\ t i + A <= t k /\ forall m, i <= m < k -> t m < t i + A.

  (** The part of the segment from A to B later than its first instant; empty where the segment ends before. *)
  Definition interval (p : property) (L : option nat) (i A B : nat) : Prop :=
    (forall k L', begins L i A k -> part t L i B L' -> satisfies p s t L' k) /\
    ((forall k, ~ begins L i A k) -> satisfies p s t (Some i) i).

  Lemma begins_exactly : forall L i A k, begins L i A k -> t k = t i + A.
  Proof.
    intros L i A [|k] (A1 & _ & A3 & A4).
    - assert (i = 0) by lia. subst i. lia.
    - destruct (Nat.eq_dec i (S k)) as [->|]; [lia|]. specialize (A4 k ltac:(lia)). pose proof (dense k). lia.
  Qed.

  (** B from the first instant is B - A from the one at which the interval begins. *)
  Lemma same_part : forall L i A B k L', A < B -> begins L i A k -> (part t L i B L' <-> part t L k (B - A) L').
  Proof.
    intros L i A B k L' HAB Hk. pose proof (begins_exactly L i A k Hk) as E. destruct Hk as (K1 & K2 & K3 & K4).
    assert (HB : forall m, beyond t B i m <-> beyond t (B - A) k m) by (intros m; unfold beyond; lia).
    assert (HE : forall m, i <= m < k -> ~ beyond t B i m) by (intros m Hm; unfold beyond; specialize (K4 m Hm); lia).
    assert (HK : ~ beyond t B i k) by (unfold beyond; lia).
    unfold part. split; intros [(m & M1 & M2 & M3 & M4 & ->) | (M & ->)].
    - left. exists m. assert (k <= m). { destruct (le_lt_dec k m); auto. exfalso. apply (HE m); auto; lia. }
      repeat split; auto; [now apply HB|]. intros j Hj. rewrite <- HB. apply M4; lia.
    - right. split; auto. intros m Hm Hi. rewrite <- HB. apply M; auto; lia.
    - left. exists m. repeat split; auto; [lia | now apply HB|]. intros j Hj.
      destruct (le_lt_dec k j); [rewrite HB; apply M4; lia | apply HE; lia].
    - right. split; auto. intros m Hm Hi. destruct (le_lt_dec k m); [rewrite HB; auto | apply HE; lia].
  Qed.

  (** A predicate that says that A has passed holds first where the interval begins. *)
  Variables (L : option nat) (i A B : nat) (x : predicate).
  Hypothesis ordered : A < B.
  Hypothesis said : forall k, i <= k -> inside L k -> at_letter x (s k) = (t i + A <=? t k).

  Lemma begins_first : forall k, begins L i A k <-> first_step x s L i k.
  Proof.
    intros k. split.
    - intros (A1 & A2 & A3 & A4). repeat split; auto; [rewrite said; auto; now apply Nat.leb_le|].
      intros m Hm. rewrite said; [|lia | eapply inside_le; [|exact A2]; lia]. apply Nat.leb_gt. apply A4; lia.
    - intros (A1 & A2 & A3 & A4). rewrite said in A3 by auto. apply Nat.leb_le in A3. repeat split; auto.
      intros m Hm. specialize (A4 m Hm). rewrite said in A4; [|lia | eapply inside_le; [|exact A2]; lia].
      now apply Nat.leb_gt.
  Qed.

  Lemma one_first : forall k m, first_step x s L i k -> first_step x s L i m -> k = m.
  Proof.
    intros k m (A1 & _ & A3 & A4) (B1 & _ & B3 & B4). destruct (lt_eq_lt_dec k m) as [[H|H]|H]; auto.
    - rewrite B4 in A3; [congruence | lia].
    - rewrite A4 in B3; [congruence | lia].
  Qed.

  Lemma inside_interval : forall p c k, begins L i A k ->
    (satisfies (Within c (B - A) p) s t L k <-> forall L', part t L i B L' -> satisfies p s t L' k).
  Proof.
    intros p c k Hk. simpl. split; intros H L' HP; apply H; now apply (same_part L i A B k L' ordered Hk).
  Qed.

  (** What holds on no instants holds where there is no interval. *)
  Theorem interval_means : forall p c, satisfies p s t (Some i) i ->
    (interval p L i A B <-> satisfies (After x (Within c (B - A) p)) s t L i).
  Proof.
    intros p c HE. cbn [satisfies]. split.
    - intros [H _] k Hk. apply begins_first in Hk. now apply inside_interval; auto.
    - intros H. split; [|auto]. intros k L' Hk HP. assert (Hf := proj1 (begins_first k) Hk).
      apply (H k Hf). now apply (same_part L i A B k L' ordered Hk).
  Qed.

  Lemma begins_or_not : timed t L -> 0 < A -> (exists k, begins L i A k) \/ forall k, ~ begins L i A k.
  Proof.
    intros HT HA. assert (HB : forall m, beyond t (A - 1) i m <-> t i + A <= t m) by (intros m; unfold beyond; lia).
    destruct (part_exists t L i (A - 1) HT) as (L' & [(k & K1 & K2 & K3 & K4 & _) | (M & _)]).
    - left. exists k. repeat split; auto; [now apply HB|]. intros m Hm. specialize (K4 m Hm). rewrite HB in K4. lia.
    - right. intros k (A1 & A2 & A3 & _). apply (M k A1 A2). now apply HB.
  Qed.

  (** What does not hold on no instants does not where there is no interval; whether it holds at all is decided. *)
  Theorem interval_means_not : forall p c, ~ satisfies p s t (Some i) i -> timed t L -> 0 < A ->
    (forall k, satisfies (Within c (B - A) p) s t L k \/ ~ satisfies (Within c (B - A) p) s t L k) ->
    (interval p L i A B <-> satisfies (Not (After x (Not (Within c (B - A) p)))) s t L i).
  Proof.
    intros p c HE HT HA HD. set (W := Within c (B - A) p) in *. cbn [satisfies]. split.
    - intros [H1 H2] HN. destruct (begins_or_not HT HA) as [(k & Hk)|HK]; [|now apply HE, H2].
      apply (HN k); [now apply begins_first|]. apply (inside_interval p c k Hk). intros L' HP. now apply (H1 k).
    - intros HN. split.
      + intros k L' Hk HP. apply (proj1 (inside_interval p c k Hk)); [|exact HP]. fold W. destruct (HD k) as [H|H]; auto. exfalso.
        apply HN. intros m Hm. apply begins_first in Hk. rewrite (one_first m k Hm Hk). exact H.
      + intros HK. exfalso. apply HN. intros k Hk. exfalso. now apply (HK k), begins_first.
  Qed.
End Intervals.

(** That the scope has been open for A: it is now, and was not just before its first instant. *)
Theorem open_for : forall s t began open i k A, passing t -> i <= k ->
  (forall m, i <= m <= k -> at_letter open (s m) = true) -> (i = 0 \/ at_letter open (s (i - 1)) = false) ->
  value s t began (Historically (Some A) open) k = (t i + A <=? t k).
Proof.
  intros s t began open i k A Ht Hik HO HB. apply eq_true_iff_eq. unfold value. rewrite some_instant_true, Nat.leb_le.
  split.
  - intros (j & J1 & J2). apply andb_true_iff in J2 as [J2 J3]. rewrite every_instant_true in J3. simpl in J2.
    apply Nat.leb_le in J2. destruct (le_lt_dec i j) as [H|H]; [pose proof (Ht i j H); lia|].
    destruct HB as [-> | HB]; [lia|]. rewrite J3 in HB by lia. congruence.
  - intros H. exists i. split; auto. apply andb_true_iff. split; [now apply Nat.leb_le|]. now apply every_instant_true.
Qed.

(** Of the scope that opens at the first x from the first instant of the scope around: [around] holds there and on,
    and not just before. *)
Theorem opened : forall s t began around x L i k m, first_step x s L i k -> k <= m ->
  (forall j, i <= j <= m -> at_letter around (s j) = true) -> (i = 0 \/ at_letter around (s (i - 1)) = false) ->
  (forall j, i <= j <= m -> value s t began (Since None around (PAnd around x)) j = (k <=? j)) /\
  (i = 0 \/ value s t began (Since None around (PAnd around x)) (i - 1) = false).
Proof.
  intros s t began around x L i k m (K1 & _ & K3 & K4) Hm HA HB. split.
  - intros j Hj. apply eq_true_iff_eq. unfold value. rewrite some_instant_true, Nat.leb_le. split.
    + intros (n & N1 & N2). apply andb_true_iff in N2 as [N2 N3]. rewrite every_instant_true in N3. simpl in N2.
      apply andb_true_iff in N2 as [N2 N4]. destruct (le_lt_dec k j) as [|H]; auto. exfalso.
      destruct (le_lt_dec i n); [rewrite K4 in N4; [congruence | lia]|].
      destruct HB as [-> | HB]; [lia|]. destruct (Nat.eq_dec n (i - 1)) as [->|]; [congruence|].
      rewrite N3 in HB by lia. congruence.
    + intros H. exists k. split; auto. rewrite !andb_true_iff. simpl. rewrite HA, K3 by lia. repeat split.
      apply every_instant_true. intros n Hn. apply HA; lia.
  - destruct HB as [|HB]; auto. destruct i as [|i]; auto. right. apply not_true_is_false. unfold value.
    replace (S i - 1) with i in * by lia. rewrite some_instant_true. intros (n & N1 & N2).
    apply andb_true_iff in N2 as [N2 N3]. rewrite every_instant_true in N3. simpl in N2.
    apply andb_true_iff in N2 as [N2 _]. destruct (Nat.eq_dec n i) as [->|]; [congruence|].
    rewrite N3 in HB by lia. congruence.
Qed.

(** Of an episode that [around] is around: it is open up to the next y, and was not just before it opened. *)
Theorem episode_opened : forall s t began around x y L i k m, opens x y s L i k -> k <= m ->
  (forall j, i <= j <= m -> at_letter around (s j) = true) -> (i = 0 \/ at_letter around (s (i - 1)) = false) ->
  (forall j, k <= j <= m -> at_letter y (s j) = false) ->
  let kept := PAnd around (PNot y) in
  (forall j, k <= j <= m -> value s t began (Since None kept (PAnd kept x)) j = true) /\
  (k = 0 \/ value s t began (Since None kept (PAnd kept x)) (k - 1) = false).
Proof.
  intros s t began around x y L i k m HO Hm HA HB HY kept. apply opens_split in HO.
  assert (HF : exists j, i <= j <= k /\ first_step (opening x y) s L j k /\ (j = i \/ at_letter y (s j) = true)).
  { destruct HO as [H | (j & J1 & _ & J3 & H)]; [exists i | exists j]; pose proof (proj1 H); auto 6. }
  destruct HF as (j & J & (F1 & F2 & F3 & F4) & HJ). apply opening_true in F3 as [Fx Fy].
  assert (HK : forall n, i <= n <= m -> at_letter y (s n) = false -> at_letter kept (s n) = true).
  { intros n Hn E. simpl. rewrite HA, E by lia. auto. }
  split.
  - intros n Hn. unfold value. apply some_instant_true. exists k. split; [lia|]. cbn [recent at_letter].
    rewrite HK, Fx by (auto; lia). simpl. apply every_instant_true. intros o Ho. apply HK; [lia|]. apply HY; lia.
  - destruct k as [|k]; auto. right. apply not_true_is_false. unfold value. replace (S k - 1) with k by lia.
    rewrite some_instant_true. intros (n & N1 & N2). apply andb_true_iff in N2 as [N2 N3].
    rewrite every_instant_true in N3. cbn [recent at_letter] in N2. apply andb_true_iff in N2 as [_ N4].
    apply andb_true_iff in N4 as [N4 N5]. simpl in N4, N3. apply andb_true_iff in N4 as [N4 N6].
    destruct (le_lt_dec j n) as [H|H].
    + specialize (F4 n ltac:(lia)). simpl in F4. rewrite N5, N6 in F4. discriminate.
    + destruct HJ as [-> | HJ].
      * destruct HB as [-> | HB]; [lia|]. destruct (Nat.eq_dec n (i - 1)) as [->|]; [congruence|].
        specialize (N3 (i - 1) ltac:(lia)). rewrite HB in N3. discriminate.
      * destruct (Nat.eq_dec j (S k)) as [->|]; [congruence|]. specialize (N3 j ltac:(lia)).
        rewrite HJ, andb_false_r in N3. discriminate.
Qed.
