(** Between which numbers the robustness of a run will be, however it continues.

    [still_possible] computes robustness backwards, instant by instant, as columns do. At the end of the run it takes
    what the definition says of no instants, and is robustness ([computed_right]). If the run continues it takes a margin
    that stands for all that is still to come, the least or the greatest: these two are the ends of a band. Every
    continuation is within ([in_band]), the band only narrows ([band_narrows]), and its sign is a verdict on every
    continuation ([band_verdict]).
    Python: [Robustness] in [ltlc/monitoring/columns/robustness.py]. *)
From Coq Require Import List Arith Lia Bool ZArith.
Require Import Ltl Properties Past Robustness.

(** * Margins are ordered *)

Definition no_more (a b : margin) : Prop :=
  match a, b with
  | Lowest, _ | _, Highest => True
  | Finite x, Finite y => (x <= y)%Z
  | _, _ => False
  end.

Ltac order :=
  repeat match goal with a : margin |- _ => destruct a end; unfold greatest; simpl in *; try tauto; try lia.

Lemma no_more_least : forall c a b, no_more c (least a b) <-> no_more c a /\ no_more c b.
Proof. intros. order. Qed.
Lemma no_more_greatest : forall c a b, no_more c (greatest a b) <-> no_more c a \/ no_more c b.
Proof. intros. order. Qed.
Lemma no_more_same : forall a b, (forall c, no_more c a <-> no_more c b) -> a = b.
Proof.
  intros a b H. assert (HA := proj1 (H a)). assert (HB := proj2 (H b)).
  destruct a, b; simpl in *; try tauto; try (exfalso; lia). f_equal. lia.
Qed.
Lemma no_more_least_of : forall f c i n, no_more c (least_of f i n) <-> forall k, i <= k < n -> no_more c (f k).
Proof.
  intros f c i n. unfold least_of. remember (n - i) as m eqn:E. revert i E.
  induction m as [|m IH]; intros i E; cbn [least_next].
  - split; [intros; lia | order].
  - rewrite no_more_least, (IH (S i)) by lia. split; [|split; [|intros]; apply H; lia].
    intros [A B] k Hk. destruct (Nat.eq_dec k i) as [->|]; auto. apply B; lia.
Qed.

Lemma neg_greatest : forall a b, neg (greatest a b) = least (neg a) (neg b).
Proof. intros. apply neg_neg. Qed.
Lemma neg_least : forall a b, neg (least a b) = greatest (neg a) (neg b).
Proof. intros. unfold greatest. now rewrite !neg_neg. Qed.
Lemma greatest_lowest : forall a, greatest a Lowest = a.
Proof. intros [|z|]; unfold greatest; simpl; auto. now rewrite Z.opp_involutive. Qed.
Lemma least_highest : forall a, least a Highest = a.
Proof. intros []; auto. Qed.
Lemma lowest_greatest : forall a, greatest Lowest a = a.
Proof. intros [|z|]; unfold greatest; simpl; auto. now rewrite Z.opp_involutive. Qed.
Lemma greatest_highest : forall a, greatest a Highest = Highest.
Proof. now intros []. Qed.
Lemma highest_greatest : forall a, greatest Highest a = Highest.
Proof. now intros []. Qed.
Ltac by_order := rewrite ?neg_greatest, ?neg_least, ?neg_neg; apply no_more_same; intros ?c;
  rewrite ?no_more_least, ?no_more_greatest, ?no_more_least, ?no_more_greatest; tauto.
Lemma greatest_over_least : forall a b c, greatest a (least b c) = least (greatest a b) (greatest a c).
Proof. intros. by_order. Qed.
Lemma greatest_over_least_of : forall a f i n,
  greatest a (least_of f i n) = least_of (fun k => greatest a (f k)) i n.
Proof.
  intros a f i n. unfold least_of. generalize (n - i). intros m. revert i.
  induction m as [|m IH]; intros i; cbn [least_next]; [order|]. now rewrite greatest_over_least, IH.
Qed.
Lemma least_of_same : forall f g i n, (forall k, i <= k < n -> f k = g k) -> least_of f i n = least_of g i n.
Proof.
  intros. apply no_more_same. intros c. rewrite !no_more_least_of. split; intros; [rewrite <- H | rewrite H]; auto.
Qed.
Lemma greatest_of_same : forall f g i n, (forall k, i <= k < n -> f k = g k) -> greatest_of f i n = greatest_of g i n.
Proof. intros. unfold greatest_of. f_equal. apply least_of_same. intros. now rewrite H. Qed.
Lemma least_of_first : forall f i n, i < n -> least_of f i n = least (f i) (least_of f (S i) n).
Proof. intros. unfold least_of. now replace (n - i) with (S (n - S i)) by lia. Qed.
Lemma least_of_none : forall f i n, n <= i -> least_of f i n = Highest.
Proof. intros. unfold least_of. now replace (n - i) with 0 by lia. Qed.
Lemma greatest_of_first : forall f i n, i < n -> greatest_of f i n = greatest (f i) (greatest_of f (S i) n).
Proof. intros. unfold greatest_of, greatest. now rewrite least_of_first, neg_neg by auto. Qed.

Lemma outside_here : forall ended i, outside ended i i = ended i.
Proof.
  intros. unfold outside. rewrite greatest_of_first by auto. unfold greatest_of. rewrite least_of_none by auto.
  apply greatest_lowest.
Qed.
Lemma outside_first : forall ended i k, i < k -> outside ended i k = greatest (ended i) (outside ended (S i) k).
Proof. intros. unfold outside. apply greatest_of_first. lia. Qed.

(** * Backwards *)

(** What a step makes at each instant of the value at the next one; at the end there is [last]. *)
Fixpoint next (step : nat -> margin -> margin) (last : margin) (i m : nat) : margin :=
  match m with 0 => last | S m => step i (next step last (S i) m) end.
Definition backwards (step : nat -> margin -> margin) (last : margin) (n i : nat) : margin := next step last i (n - i).

Lemma backwards_first : forall step last n i, i < n ->
  backwards step last n i = step i (backwards step last n (S i)).
Proof. intros. unfold backwards. now replace (n - i) with (S (n - S i)) by lia. Qed.
Lemma backwards_none : forall step last n i, n <= i -> backwards step last n i = last.
Proof. intros. unfold backwards. now replace (n - i) with 0 by lia. Qed.
(** From the end. *)
Lemma backwards_ind : forall (P : nat -> Prop) n, (forall i, n <= i -> P i) ->
  (forall i, i < n -> P (S i) -> P i) -> forall i, P i.
Proof.
  intros P n HN HS i. remember (n - i) as m eqn:E. revert i E.
  induction m as [|m IH]; intros i E; [apply HN; lia|]. apply HS; [lia|]. apply IH. lia.
Qed.

(** In a segment that [ended] ends, of what holds by f at an instant: at all; at some; and at the first x. *)
Definition always_step (ended f : nat -> margin) (k : nat) (next : margin) : margin :=
  greatest (ended k) (least (f k) next).
Definition eventually_step (ended f : nat -> margin) (k : nat) (next : margin) : margin :=
  least (neg (ended k)) (greatest (f k) next).
Definition after_step (ended x f : nat -> margin) (k : nat) (next : margin) : margin :=
  greatest (ended k) (least (greatest (neg (x k)) (f k)) (greatest (x k) next)).
(** What is found at the first instant that is A after the time b; [enough]: it holds if the segment has ended. *)
Definition interval_step (t : times) (enough : bool) (ended found : nat -> margin) (b A k : nat) (next : margin) :=
  let later := if b + A <=? t k then found k else next in
  if enough then greatest (ended k) later else least (neg (ended k)) later.

(** The margin for what is still to come, if the run continues. *)
Definition opposite : option margin -> option margin := option_map neg.
Definition coming (future : option margin) (none : margin) : margin :=
  match future with None => none | Some f => f end.

Section Computed.
  Variables (v : nat -> nat -> margin) (t : times) (n : nat).

  Fixpoint still_possible (future : option margin) (p : property) (ended : nat -> margin) (known : bool) (i : nat)
      : margin :=
    let at_ x k := at_margins x (v k) in
    let always f := backwards (always_step ended f) (coming future Highest) n in
    let eventually future f := backwards (eventually_step ended f) (coming future Lowest) n in
    let after x f := backwards (after_step ended (at_ x) f) (coming future Highest) n in
    match p with
    | Now p => at_margins p (fun a => if known then v i a else least (v i a) (neg (ended i)))
    | Throughout p => always (at_ p) i
    | Not p => neg (still_possible (opposite future) p ended known i)
    | And p q => least (still_possible future p ended known i) (still_possible future q ended known i)
    | Or p q => greatest (still_possible future p ended known i) (still_possible future q ended known i)
    | Implies p q =>
        greatest (neg (still_possible (opposite future) p ended known i)) (still_possible future q ended known i)
    | Always p => always (still_possible future p ended true) i
    | Never p => neg (eventually (opposite future) (still_possible (opposite future) p ended true) i)
    | Eventually p => eventually future (still_possible future p ended true) i
    | After x p => after x (still_possible future p ended true) i
    | Until x p => least (eventually future (at_ x) i) (still_possible future p (ended_by v x ended) false i)
    | AfterUntil x y p =>
        let first := after (opening x y) (still_possible future p (ended_by v y ended) true) in
        least (first i) (always (fun k => greatest (neg (at_ y k)) (first k)) i)
    | Within _ d p => still_possible future p (fun k => if t i + d <? t k then Highest else ended k) known i
    end.

  (** `within [A, A + d], P`, of the segment that begins at i; [enough]: P holds of no instants. *)
  Definition possible_interval (future : option margin) (enough : bool) (A d : nat) (p : property)
      (ended : nat -> margin) (i : nat) : margin :=
    backwards (interval_step t enough ended (still_possible future (Within 0 d p) ended true) (t i) A)
      (coming future (if enough then Highest else Lowest)) n i.

  (** The ends of the band. *)
  Definition lower (p : property) : margin := still_possible (Some Lowest) p never_ends false 0.
  Definition upper (p : property) : margin := still_possible (Some Highest) p never_ends false 0.

  (** ** If the run is over, this is robustness *)

  Lemma always_right : forall ended f i, backwards (always_step ended f) Highest n i =
    least_of (fun k => greatest (outside ended i k) (f k)) i n.
  Proof.
    intros ended f. apply (backwards_ind _ n); intros i Hi; [now rewrite backwards_none, least_of_none by auto|].
    intros IH. rewrite backwards_first, IH, (least_of_first _ i) by auto. unfold always_step.
    rewrite greatest_over_least, greatest_over_least_of. f_equal.
    - now rewrite outside_here.
    - apply least_of_same. intros k Hk. rewrite (outside_first _ i) by lia. by_order.
  Qed.

  Lemma eventually_dual : forall ended f last i, backwards (eventually_step ended f) last n i =
    neg (backwards (always_step ended (fun k => neg (f k))) (neg last) n i).
  Proof.
    intros ended f last. apply (backwards_ind _ n); intros i Hi; [now rewrite !backwards_none, neg_neg by auto|].
    intros IH. rewrite (backwards_first _ last), (backwards_first _ (neg last)), IH by auto.
    unfold eventually_step, always_step. by_order.
  Qed.

  Lemma eventually_right : forall ended f i, backwards (eventually_step ended f) Lowest n i =
    greatest_of (fun k => least (neg (outside ended i k)) (f k)) i n.
  Proof.
    intros. rewrite eventually_dual. cbn [neg]. rewrite always_right. unfold greatest_of. f_equal.
    apply least_of_same. intros. by_order.
  Qed.

  Lemma after_right : forall ended x f i,
    backwards (after_step ended (fun k => at_margins x (v k)) f) Highest n i =
    least_of (fun k => greatest (neg (first_margin v x ended i k)) (f k)) i n.
  Proof.
    intros ended x f. apply (backwards_ind _ n); intros i Hi; [now rewrite backwards_none, least_of_none by auto|].
    intros IH. rewrite backwards_first, IH, (least_of_first _ i) by auto. unfold after_step, first_margin.
    rewrite greatest_over_least, !greatest_over_least_of. f_equal.
    - rewrite outside_here. unfold greatest_of at 1. rewrite least_of_none by auto.
      cbn [neg]. rewrite least_highest. by_order.
    - apply least_of_same. intros k Hk.
      rewrite (outside_first _ i), (greatest_of_first (fun m => at_margins x (v m)) i) by lia. by_order.
  Qed.

  Lemma after_until_right : forall ended x y f i,
    let first := backwards (after_step ended (fun k => at_margins (opening x y) (v k)) f) Highest n in
    let again := backwards (always_step ended (fun k => greatest (neg (at_margins y (v k))) (first k))) Highest n in
    least (first i) (again i) = least_of (fun k => greatest (neg (opens_margin v x y ended i k)) (f k)) i n.
  Proof.
    intros ended x y f i first again. unfold again, first. rewrite always_right, after_right.
    set (o := first_margin v (opening x y) ended).
    transitivity (least_of (fun k => least (greatest (neg (o i k)) (f k)) (least_of (fun j =>
      greatest (outside ended i j) (greatest (neg (at_margins y (v j))) (greatest (neg (o j k)) (f k))))
      i (S k))) i n).
    - apply no_more_same. intros c. rewrite no_more_least, !no_more_least_of. split.
      + intros [A B] k Hk. rewrite no_more_least, no_more_least_of. split; auto. intros j Hj.
        specialize (B j ltac:(lia)). cbn beta in B. rewrite after_right in B. fold o in B.
        rewrite !greatest_over_least_of, no_more_least_of in B. apply B. lia.
      + intros A. assert (B := fun k Hk => proj1 (no_more_least _ _ _) (A k Hk)). split; [intros; now apply B|].
        intros j Hj. rewrite after_right. fold o. rewrite !greatest_over_least_of, no_more_least_of. intros k Hk.
        specialize (B k ltac:(lia)). rewrite no_more_least_of in B. apply (proj2 B). lia.
    - apply least_of_same. intros k Hk. unfold opens_margin. fold o. rewrite neg_greatest.
      unfold greatest_of. rewrite neg_neg.
      transitivity (greatest (f k) (least (neg (o i k)) (least_of (fun j => neg (least (neg (outside ended i j))
        (least (at_margins y (v j)) (o j k)))) i (S k)))); [|by_order].
      rewrite greatest_over_least, greatest_over_least_of. f_equal; [by_order|].
      apply least_of_same. intros j Hj. by_order.
  Qed.

  Theorem computed_right : forall p ended known i, i < n ->
    still_possible None p ended known i = robustness v t n p ended known i.
  Proof.
    induction p; intros ended known i Hi; cbn [still_possible robustness opposite option_map coming].
    - apply Nat.ltb_lt in Hi. now rewrite Hi.
    - apply always_right.
    - now rewrite IHp.
    - now rewrite IHp1, IHp2.
    - now rewrite IHp1, IHp2.
    - now rewrite IHp1, IHp2.
    - rewrite always_right. apply least_of_same. intros. now rewrite IHp by lia.
    - rewrite eventually_right. unfold greatest_of. rewrite neg_neg. apply least_of_same. intros. rewrite IHp by lia.
      by_order.
    - rewrite eventually_right. unfold greatest_of. f_equal. apply least_of_same. intros. now rewrite IHp by lia.
    - rewrite after_right. apply least_of_same. intros. now rewrite IHp by lia.
    - now rewrite eventually_right, IHp.
    - rewrite after_until_right. apply least_of_same. intros. now rewrite IHp by lia.
    - now rewrite IHp.
  Qed.
End Computed.

(** * A run that continues *)

(** On one side or the other; and the margin that is furthest to this side. *)
Definition toward (low : bool) (a b : margin) : Prop := if low then no_more a b else no_more b a.
Definition furthest (low : bool) : margin := if low then Lowest else Highest.

Lemma toward_furthest : forall low a, toward low (furthest low) a.
Proof. intros [] []; simpl; auto. Qed.
Lemma toward_same : forall low a, toward low a a.
Proof. intros [] []; simpl; auto with zarith. Qed.
Lemma toward_neg : forall low a b, toward (negb low) a b -> toward low (neg a) (neg b).
Proof. intros [] a b; order. Qed.
Lemma toward_least : forall low a a' b b', toward low a a' -> toward low b b' -> toward low (least a b) (least a' b').
Proof. intros [] a a' b b'; order. Qed.
Lemma toward_greatest : forall low a a' b b',
  toward low a a' -> toward low b b' -> toward low (greatest a b) (greatest a' b').
Proof. intros. apply toward_neg, toward_least; apply toward_neg; now rewrite negb_involutive. Qed.
Lemma at_margins_same : forall p l l', (forall a, l a = l' a) -> at_margins p l = at_margins p l'.
Proof. induction p; simpl; intros; f_equal; auto. Qed.

Local Hint Resolve toward_same toward_neg toward_least toward_greatest : toward.

Section Continued.
  Variables (v v' : nat -> nat -> margin) (t t' : times) (n m : nat).
  Hypothesis longer : n <= m.
  Hypothesis same : forall k, k < n -> t k = t' k /\ forall a, v k a = v' k a.

  Lemma backwards_toward : forall low step step' last i,
    (forall k a b, i <= k < n -> toward low a b -> toward low (step k a) (step' k b)) ->
    toward low (backwards step (furthest low) n i) (backwards step' last m i).
  Proof.
    intros low step step' last. refine (backwards_ind _ n _ _); intros i Hi.
    - intros _. rewrite backwards_none by auto. apply toward_furthest.
    - intros IH H. rewrite !(backwards_first _ _ _ i) by lia. apply H; [lia|]. apply IH. intros. apply H; auto; lia.
  Qed.

  Lemma known_same : forall x k, k < n -> at_margins x (v k) = at_margins x (v' k).
  Proof. intros. apply at_margins_same. now apply same. Qed.

  Lemma always_toward : forall low E E' f f' last i, (forall k, k < n -> E k = E' k) ->
    (forall k, i <= k < n -> toward low (f k) (f' k)) ->
    toward low (backwards (always_step E f) (furthest low) n i) (backwards (always_step E' f') last m i).
  Proof.
    intros low E E' f f' last i HE Hf. apply backwards_toward. intros k a b Hk. unfold always_step.
    rewrite HE by lia. auto with toward.
  Qed.
  Lemma eventually_toward : forall low E E' f f' last i, (forall k, k < n -> E k = E' k) ->
    (forall k, i <= k < n -> toward low (f k) (f' k)) ->
    toward low (backwards (eventually_step E f) (furthest low) n i) (backwards (eventually_step E' f') last m i).
  Proof.
    intros low E E' f f' last i HE Hf. apply backwards_toward. intros k a b Hk. unfold eventually_step.
    rewrite HE by lia. auto with toward.
  Qed.
  Lemma after_toward : forall low E E' x f f' last i, (forall k, k < n -> E k = E' k) ->
    (forall k, i <= k < n -> toward low (f k) (f' k)) ->
    toward low (backwards (after_step E (fun k => at_margins x (v k)) f) (furthest low) n i)
      (backwards (after_step E' (fun k => at_margins x (v' k)) f') last m i).
  Proof.
    intros low E E' x f f' last i HE Hf. apply backwards_toward. intros k a b Hk. unfold after_step.
    rewrite HE, known_same by lia. auto 6 with toward.
  Qed.
  Theorem continued : forall p low future E E' known i, (forall k, k < n -> E k = E' k) -> i < n ->
    toward low (still_possible v t n (Some (furthest low)) p E known i)
      (still_possible v' t' m future p E' known i).
  Proof.
    assert (HO : forall low, opposite (Some (furthest low)) = Some (furthest (negb low))) by now intros [].
    assert (HD : forall x E E', (forall k, k < n -> E k = E' k) ->
      forall k, k < n -> ended_by v x E k = ended_by v' x E' k).
    { intros. unfold ended_by. rewrite known_same by auto. f_equal. auto. }
    induction p; intros low future E E' known i HE Hi; cbn [still_possible coming]; rewrite ?HO; cbn [coming];
      auto with toward.
    - rewrite (at_margins_same _ _ (fun a => if known then v' i a else least (v' i a) (neg (E' i))));
        auto with toward. intros a. rewrite HE by auto. now rewrite (proj2 (same i Hi) a).
    - apply always_toward; auto. intros. rewrite known_same by lia. auto with toward.
    - apply always_toward; auto. intros. apply IHp; auto; lia.
    - apply toward_neg, eventually_toward; auto. intros. apply IHp; auto; lia.
    - apply eventually_toward; auto. intros. apply IHp; auto; lia.
    - apply after_toward; auto. intros. apply IHp; auto; lia.
    - apply toward_least; [apply eventually_toward; auto; intros; rewrite known_same by lia; auto with toward|].
      apply IHp; auto.
    - apply toward_least; [apply after_toward; auto; intros; apply IHp; auto; lia|].
      apply always_toward; auto. intros. rewrite known_same by lia. apply toward_greatest; [auto with toward|].
      apply after_toward; auto. intros. apply IHp; auto; lia.
    - apply IHp; auto. intros k Hk. rewrite (proj1 (same i Hi)), (proj1 (same k Hk)). now rewrite HE.
  Qed.
  Theorem interval_continued : forall low future enough A d p E E' i, (forall k, k < n -> E k = E' k) -> i < n ->
    toward low (possible_interval v t n (Some (furthest low)) enough A d p E i)
      (possible_interval v' t' m future enough A d p E' i).
  Proof.
    intros low future enough A d p E E' i HE Hi. apply backwards_toward. intros k a b Hk HT. unfold interval_step.
    assert (HF := continued (Within 0 d p) low future E E' true k HE ltac:(lia)).
    rewrite HE, (proj1 (same i Hi)), (proj1 (same k ltac:(lia))) by lia.
    destruct enough, (t' i + A <=? t' k); auto with toward.
  Qed.

  (** A step may come at the time of the last instant, so the run goes on from there, at any times. *)
  Hypothesis begun : 0 < n.
  Variable p : property.

  Theorem in_band :
    no_more (lower v t n p) (robustness v' t' m p never_ends false 0) /\
    no_more (robustness v' t' m p never_ends false 0) (upper v t n p).
  Proof.
    rewrite <- computed_right by lia. split; [apply (continued p true) | apply (continued p false)]; auto.
  Qed.

  Theorem band_narrows :
    no_more (lower v t n p) (lower v' t' m p) /\ no_more (upper v' t' m p) (upper v t n p).
  Proof. split; [apply (continued p true) | apply (continued p false)]; auto. Qed.

  (** What the band says of letters s' of the longer run. *)
  Theorem band_verdict : forall s', (forall k a, says (v' k a) (s' k a = true)) ->
    (positive (lower v t n p) -> satisfies p s' t' (Some m) 0) /\
    (negative (upper v t n p) -> ~ satisfies p s' t' (Some m) 0).
  Proof.
    intros s' HS. destruct in_band as [HL HU].
    assert (HN : forall k a, near 0 (v' k a) (v' k a)) by (intros; destruct (v' k a); simpl; auto; lia).
    destruct (same_verdict 0 v' v' t' m s' p HN HS (Z.le_refl 0)) as [A B]. split; intros H; [apply A | apply B];
      unfold negative in *; destruct (lower v t n p), (upper v t n p), (robustness v' t' m p never_ends false 0);
      simpl in *; auto; try tauto; lia.
  Qed.

  (** What looks back is known where the run is: of margins of atoms that are the same, so are these. *)
  Theorem looking_back_known : forall s s' began o k, k < n -> (forall j a, j <= k -> s j a = s' j a) ->
    looking_back v t s began o k = looking_back v' t' s' began o k.
  Proof.
    intros s s' began o k Hk HS. assert (HT : forall j, j <= k -> t j = t' j) by (intros; apply same; lia).
    assert (HR : forall D j, j <= k -> recent t D j k = recent t' D j k)
      by (intros [d|] j Hj; simpl; rewrite ?HT by lia; auto).
    assert (HL : forall D j, j <= k -> long_ago t D j k = long_ago t' D j k)
      by (intros [d|] j Hj; simpl; rewrite ?HT by lia; auto).
    assert (HP : forall p i,
      least_of (fun j => at_margins p (v j)) i (S k) = least_of (fun j => at_margins p (v' j)) i (S k))
      by (intros; apply least_of_same; intros; apply known_same; lia).
    destruct o as [q|D q|D q|D q r|d q]; cbn [looking_back].
    - destruct k; auto. apply known_same. lia.
    - apply greatest_of_same. intros j Hj. now rewrite HR, known_same by lia.
    - apply greatest_of_same. intros j Hj. now rewrite HL, HP by lia.
    - apply greatest_of_same. intros j Hj. now rewrite HR, known_same, HP by lia.
    - rewrite (value_same s s' t t' began (Age d q) k); auto.
  Qed.
End Continued.
