(** By how much something has occurred N times: the N-th greatest margin of its occurrences.

    [nth_greatest_is]: N of the margins or more are as large, for every size. [count_margin_right]: a positive margin
    means that the count holds, a negative one that it does not. [count_margin_near]: if no margin differs by more than
    d, neither does that of the count. [count_margin_known]: it depends on the past alone. So what [Robustness.v] and
    [Bands.v] say of runs, they say of runs with counts.
    Python: [Occurred] in [_looking_back] and [_occurs], [ltlc/semantics/robustness.py]. *)
From Coq Require Import List Arith Lia Bool ZArith.
Import ListNotations.
Require Import Ltl Properties Past Counts Counting Robustness.

(** Of N margins the least: of those N for which it is greatest. *)
Fixpoint nth_greatest (N : nat) (l : list margin) : margin :=
  match l, N with
  | _, 0 => Highest
  | [], S _ => Lowest
  | a :: l, S M => greatest (least a (nth_greatest M l)) (nth_greatest N l)
  end.

(** a is at least b. *)
Definition reaches (b a : margin) : bool :=
  match a, b with
  | Highest, _ | _, Lowest => true
  | Finite x, Finite y => (y <=? x)%Z
  | _, _ => false
  end.

Lemma reaches_least : forall b a c, reaches b (least a c) = reaches b a && reaches b c.
Proof.
  intros b a c. destruct a, b, c; simpl; auto; try now rewrite andb_true_r.
  - now rewrite andb_false_r.
  - apply eq_true_iff_eq. rewrite andb_true_iff, !Z.leb_le. lia.
Qed.
Lemma reaches_greatest : forall b a c, reaches b (greatest a c) = reaches b a || reaches b c.
Proof.
  intros b a c. unfold greatest. destruct a, b, c; simpl; auto; rewrite ?orb_true_r, ?orb_false_r, ?Z.opp_involutive; auto.
  apply eq_true_iff_eq. rewrite orb_true_iff, !Z.leb_le. lia.
Qed.

Theorem nth_greatest_is : forall b N l, b <> Lowest ->
  reaches b (nth_greatest N l) = (N <=? length (filter (reaches b) l)).
Proof.
  intros b N l Hb. revert N. induction l as [|a l IH]; intros [|M]; auto.
  - destruct b; simpl; auto. contradiction.
  - cbn [nth_greatest filter]. rewrite reaches_greatest, reaches_least, !IH.
    apply eq_true_iff_eq. rewrite orb_true_iff, andb_true_iff, !Nat.leb_le.
    destruct (reaches b a); cbn [length]; intuition (try discriminate; lia).
Qed.

Lemma nth_greatest_right : forall N (f : nat -> margin) (g : nat -> bool) l, (forall j, says (f j) (g j = true)) ->
  says (nth_greatest N (map f l)) (N <= length (filter g l)).
Proof.
  intros N f g l H. revert N. induction l as [|j l IH]; intros [|M]; cbn [map nth_greatest filter length].
  1, 2, 3: split; margins; lia.
  eapply says_iff; [apply says_or; [apply says_and; [apply H | intros _; apply IH] | apply IH]|].
  destruct (g j); cbn [length]; intuition (try discriminate; lia).
Qed.

Lemma nth_greatest_near : forall d N (f g : nat -> margin) l, (forall j, near d (f j) (g j)) ->
  near d (nth_greatest N (map f l)) (nth_greatest N (map g l)).
Proof.
  intros d N f g l H. revert N. induction l as [|j l IH]; intros [|M]; cbn [map nth_greatest]; simpl; auto.
  apply near_greatest; auto. now apply near_least.
Qed.

Section Count.
  Variables (o : count) (t : times).
  (** [comes]: where there is a step, or, of what occurs with messages, news of one. *)
  Variable comes : nat -> bool.

  Definition occurs_margin (v : nat -> nat -> margin) (k : nat) : margin :=
    let p j := at_margins (occurring o) (v j) in
    if comes k then
      least (p k) (if begins o then match k with 0 => Highest | S j => neg (p j) end else Highest)
    else Lowest.

  Definition count_margin (v : nat -> nat -> margin) (k : nat) : margin :=
    if still_presumed o (t 0) (t k) then Highest
    else nth_greatest (many o)
      (map (fun j => if recent t (bounded o) j k then occurs_margin v j else Lowest) (seq 0 (S k))).

  Theorem count_margin_right : forall v (s : stream), (forall k a, says (v k a) (s k a = true)) ->
    (forall k, comes k = false -> occurs_at o s k = false) ->
    forall k, says (count_margin v k) (count_value o s t k = true).
  Proof.
    intros v s HV HC k. unfold count_margin, count_value.
    destruct (still_presumed o (t 0) (t k)); [rewrite orb_true_r; split; margins; auto|].
    rewrite orb_false_r. unfold reached. eapply says_iff; [|symmetry; apply Nat.leb_le]. unfold counted.
    apply nth_greatest_right. intros j.
    destruct (recent t (bounded o) j k);
      [rewrite andb_true_r | rewrite andb_false_r; split; margins; intros; discriminate].
    unfold occurs_margin. destruct (comes j) eqn:E; [|rewrite (HC j E); split; margins; intros; discriminate].
    unfold occurs_at.
    eapply says_iff; [apply says_and; [apply at_margins_right; apply HV | intros _]|].
    - instantiate (1 := negb (begins o && match j with 0 => false | S i => at_letter (occurring o) (s i) end) = true).
      destruct (begins o); [|split; margins; auto].
      destruct j as [|i]; [split; margins; auto|].
      eapply says_iff; [apply says_not, at_margins_right; apply HV|].
      simpl. destruct (at_letter (occurring o) (s i)); simpl; intuition congruence.
    - now rewrite andb_true_iff.
  Qed.

  Theorem count_margin_near : forall d v v', (forall k a, near d (v k a) (v' k a)) ->
    forall k, near d (count_margin v k) (count_margin v' k).
  Proof.
    intros d v v' H k. unfold count_margin. destruct (still_presumed o (t 0) (t k)); [exact I|].
    apply nth_greatest_near. intros j. destruct (recent t (bounded o) j k); [|exact I].
    unfold occurs_margin. destruct (comes j); [|exact I].
    apply near_least; [apply near_margins, H|].
    destruct (begins o); [|exact I]. destruct j as [|i]; [exact I|]. apply near_neg, near_margins, H.
  Qed.
End Count.

(** It is known where the run is: of what is the same up to k, it is the same there. *)
Theorem count_margin_known : forall o t t' comes comes' v v' k,
  (forall j, j <= k -> t j = t' j /\ comes j = comes' j /\ forall a, v j a = v' j a) ->
  count_margin o t comes v k = count_margin o t' comes' v' k.
Proof.
  intros o t t' comes comes' v v' k H.
  assert (HP : forall p j, j <= k -> at_margins p (v j) = at_margins p (v' j)).
  { intros p j Hj. destruct (H j Hj) as (_ & _ & A). induction p; simpl; f_equal; auto. }
  unfold count_margin. rewrite (proj1 (H 0 ltac:(lia))), (proj1 (H k ltac:(lia))).
  destruct (still_presumed o (t' 0) (t' k)); auto. f_equal. apply map_ext_in. intros j Hj. apply in_seq in Hj.
  assert (HR : recent t (bounded o) j k = recent t' (bounded o) j k).
  { unfold recent. destruct (bounded o); auto. now rewrite (proj1 (H j ltac:(lia))), (proj1 (H k ltac:(lia))). }
  rewrite HR. unfold occurs_margin. rewrite (proj1 (proj2 (H j ltac:(lia)))), HP by lia.
  destruct j as [|i]; auto. now rewrite (HP _ i) by lia.
Qed.
