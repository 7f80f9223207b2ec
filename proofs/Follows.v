(** The checker that a program follows its monitor: that after every run both show the same verdict.

    The pairs in which the two can be are given, by somebody whom nobody has to trust: a state of the program, one of the
    monitor, and where the trackers of the property are, which say what its clocks do. The checker tests that in each pair
    both show the same, and that every step and every nanosecond leads to such a pair again, with the due times that the
    trackers ask for. That it may be believed is in [Followed.v].
    Python: [ltlc/semantics/following.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Registers Trackers Resets Monitor Conditions Judgements Moves Certificate Program.

(** * Walking through decisions, of a program or of a monitor *)

(** The atoms that have been asked for on the way. *)
Definition answered := list (nat * bool).
Fixpoint answer_to (a : nat) (known : answered) : option bool :=
  match known with [] => None | (b, v) :: known => if a =? b then Some v else answer_to a known end.

(** What a node is: an end, or a question with the nodes after 'yes' and after 'no'. *)
Inductive seen (node result : Type) := Found (x : result) | Decides (q : question) (yes no : node).
Arguments Found {node result} x.
Arguments Decides {node result} q yes no.

Section Walk.
  Variables (node result : Type) (look : node -> option (seen node result)) (is_late : nat -> bool).

  (** Whether [judge] accepts every end to which letters lead that [ctx] allows and that answer as is known. *)
  Fixpoint walk (fuel : nat) (n : node) (known : answered) (ctx : condition)
    (judge : result -> answered -> condition -> judgement) : judgement := fun m =>
    match ctx with
    | Constant false => (true, m)
    | _ =>
      match fuel, spend (weight ctx) m with
      | S fuel, Some m =>
          match look n with
          | Some (Found x) => judge x known ctx m
          | Some (Decides (IsLate c) yes no) => walk fuel (if is_late c then yes else no) known ctx judge m
          | Some (Decides (Holds a) yes no) =>
              match answer_to a known with
              | Some v => walk fuel (if v then yes else no) known ctx judge m
              | None => both (walk fuel yes ((a, true) :: known) (assign (AtStep a) true ctx) judge)
                             (walk fuel no ((a, false) :: known) (assign (AtStep a) false ctx) judge) m
              end
          | None => (false, m)
          end
      | _, _ => (false, m)
      end
    end.
End Walk.

(** Whether [judge] accepts [ctx], or its cases by atoms that it asks for: an impossible case may not be seen at once. *)
Fixpoint by_cases (fuel : nat) (known : answered) (ctx : condition) (judge : answered -> condition -> judgement) :
  judgement := fun m =>
  match ctx with
  | Constant false => (true, m)
  | _ =>
    match fuel, first_atom ctx, spend (weight ctx) m with
    | S fuel, Some a, Some m =>
        either (judge known ctx)
               (both (by_cases fuel ((a, true) :: known) (assign (AtStep a) true ctx) judge)
                     (by_cases fuel ((a, false) :: known) (assign (AtStep a) false ctx) judge)) m
    | _, _, _ => judge known ctx m
    end
  end.

Definition look_of_program (P : program) (w : way) : option (seen way outcome) :=
  match w with
  | Ends o => option_map Found (nth_error (outcomes P) o)
  | Asks b => option_map (fun x => Decides (asked x) (if_so x) (if_not x)) (nth_error (branches P) b)
  end.
Definition look_of_monitor (M : monitor) (t : target) : option (seen target nat) :=
  match t with
  | State q => Some (Found q)
  | Ask d => option_map (fun x => Decides (Holds (atom x)) (high x) (low x)) (nth_error (decisions M) d)
  end.

(** * The checker *)

(** Where a program and its monitor can be after an instant. While the monitor's verdict is not permanent, [stand] are the
    states of the trackers, and what is known of that instant's letter, time and news aside, is that [last_letter] holds. *)
Record pair := {
  in_program : nat; in_monitor : nat; stand : list state; looks_again : bool; last_letter : predicate
}.

(** An instant is the first step, another step, or a nanosecond later than the one before. *)
Inductive occasion := Opening | Step | Wait.

(** Whether a bound of the clock is yet to pass; that of an age from the beginning of the session on. *)
Definition counts (x : tracker_of) (st : state) : bool :=
  is_running x st || match about x, fst st with Follows (Age _ _), First => true | _, _ => false end.
Definition is_held (st : state) : bool := match fst st with Held => true | _ => false end.

(** A clock at an instant: its tracker, the state before, and the case. *)
Definition row : Type := tracker_of * state * case.
Fixpoint rows (ys : list tracker_of) (sts : list state) (cs : list case) : list row :=
  match ys, sts, cs with
  | y :: ys, st :: sts, c :: cs => if has_bounds y then (y, st, c) :: rows ys sts cs else rows ys sts cs
  | _, _, _ => []
  end.

(** Whether the clock can be past its due time: a step comes after the clock steps up to its time. *)
Definition may_be_late (o : occasion) (r : row) : list bool :=
  let '(x, st, c) := r in
  match o with
  | Step => [false]
  | _ => if counts x st then match passed c with Some n => [snd st <? n] | None => [true; false] end else [false]
  end.
Fixpoint choices (options : list (list bool)) : list (list bool) :=
  match options with [] => [[]] | o :: os => flat_map (fun b => map (cons b) (choices os)) o end.

(** How an outcome sets clock i. *)
Definition setting_of (i : nat) (y : outcome) : option (anchor * nat) :=
  match find (fun z => set_clock z =? i) (settings y) with Some z => to_be_due z | None => Some (WhenDue, 0) end.

(** Whether the clock is then due when its next bound passes, if it runs; and whether it is then off. *)
Definition is_due_right (o : occasion) (r : row) (setting : option (anchor * nat)) : bool :=
  let '(x, st, c) := r in
  let bound n := nth n (bounds x) 0 in
  let runs_on := is_running x (next c) in
  match setting with
  | None => negb runs_on
  | Some (WhenDue, d) =>
      if counts x st
      then runs_on && negb (starts c) && negb (is_held st) && (bound (snd st) + d =? bound (snd (next c)))
      else negb runs_on
  | Some (ThisInstant, d) =>
      runs_on && (starts c || is_held st && match o with Step => true | _ => false end) && (d =? bound (snd (next c)))
  | Some (JustBefore, d) =>
      runs_on && negb (starts c) && is_held st && match o with Wait => true | _ => false end &&
      (d =? bound (snd (next c)))
  end.
Definition is_off (r : row) (setting : option (anchor * nat)) : bool :=
  match setting with None => true | Some (WhenDue, _) => negb (counts (fst (fst r)) (snd (fst r))) | _ => false end.
Fixpoint are_due_right (is_right : row -> option (anchor * nat) -> bool) (y : outcome) (i : nat) (rs : list row) : bool :=
  match rs with [] => true | r :: rs => is_right r (setting_of i y) && are_due_right is_right y (S i) rs end.

(** The program stays in q: nothing happens. *)
Definition stays (q : nat) : outcome := {| goes_to := q; settings := []; again := false |}.
(** Where the program goes, unless it stays, in a state x that looks again or not, with these clocks late. *)
Definition way_to_go (o : occasion) (x : stance) (looks : bool) (late : list bool) : option (option way) :=
  match o with
  | Wait => if looks || existsb (fun b => b) late then option_map Some (at_clock_step x) else Some None
  | _ => Some (Some (at_step x))
  end.

Definition same_states (sts sts' : list state) : bool :=
  if list_eq_dec (fun st st' : state => ltac:(decide equality; [apply Nat.eq_dec | decide equality])) sts sts'
  then true else false.

(** What remains of a condition with what has been answered. *)
Definition under (known : answered) (c : condition) : condition :=
  fold_right (fun av c => assign (AtStep (fst av)) (snd av) c) c known.

Section Checker.
  Variables (depth : nat) (news : list nat) (xs : list tracker_of) (allowed : condition).
  Variables (P : program) (M : monitor) (pairs : list pair).

  Definition permanent (r : nat) : bool :=
    match nth_error (verdicts M) r with Some Violated | Some Satisfied => true | _ => false end.

  Definition meets (y : outcome) (r : nat) (p : pair) : bool :=
    (in_program p =? goes_to y) && (in_monitor p =? r) && Bool.eqb (looks_again p) (again y).

  (** Whether it is right that the program does y and the monitor is in r, by letters of [ctx] with which the trackers do
      [cs]; and once the verdict is permanent, by any letters. *)
  Definition lands (o : occasion) (rs : list row) (cs : list case) (y : outcome) (r : nat) (known : answered)
    (ctx : condition) : judgement :=
    if are_due_right (if permanent r then is_off else is_due_right o) y 0 rs &&
       forallb (fun z => set_clock z <? length (first_due P)) (settings y)
    then any (fun p => if meets y r p && (permanent r || same_states (stand p) (map next cs))
                       then follows depth ctx (under known (unfold (as_formula (last_letter p)))) else verdict_is false)
             pairs
    else verdict_is false.
  Definition lands_for_good (y : outcome) (r : nat) (_ : answered) (_ : condition) : judgement :=
    verdict_is (permanent r && existsb (meets y r) pairs &&
                forallb (fun z => match to_be_due z with None | Some (WhenDue, _) => true | _ => false end) (settings y)).

  (** Whether [land] accepts all ends to which letters of [ctx] lead, from a way of the program, or from its staying in q,
      and from a target of the monitor. *)
  Definition lead (late : list bool) (w : option way) (q : nat) (t : target) (ctx : condition)
    (land : outcome -> nat -> answered -> condition -> judgement) : judgement :=
    let with_monitor y known ctx :=
      walk _ _ (look_of_monitor M) (fun _ => false) depth t known ctx (fun r known ctx =>
        by_cases depth known ctx (land y r)) in
    match w with
    | Some w => walk _ _ (look_of_program P) (fun i => nth i late false) depth w [] ctx with_monitor
    | None => with_monitor (stays q) [] ctx
    end.

  (** The same for all that trackers in [sts] may do. At a step, none passes a bound. *)
  Definition move_on (o : occasion) (q : nat) (x : stance) (t : target) (sts : list state) (looks : bool)
    (ctx : condition) : judgement :=
    each_case xs sts (fun _ => closed) match o with Opening => true | _ => false end ctx (fun ctx cs =>
      if match o with Step => existsb (fun b => b) (those_passing xs sts cs) | _ => false end then verdict_is true else
      let rs := rows xs sts cs in
      all (fun late => match way_to_go o x looks late with
                       | Some w => lead late w q t ctx (lands o rs cs)
                       | None => verdict_is false
                       end) (choices (map (may_be_late o) rs))).

  Definition no_news : predicate := all_of_them (map (fun a => PNot (PAtom a)) news).

  Definition pair_is_right (p : pair) : judgement :=
    let (q, r) := (in_program p, in_monitor p) in
    match nth_error (stances P) q, nth_error (verdicts M) r, nth_error (edges M) r with
    | Some x, Some v, Some t =>
        both (verdict_is (same_verdict (shows_verdict x) v))
          (if permanent r then
             both (verdict_is (negb (looks_again p)))
               (both (lead [] (Some (at_step x)) q t allowed lands_for_good) (lead [] None q t allowed lands_for_good))
           else
             both (move_on Step q x t (stand p) (looks_again p) allowed)
               (if is_trivial news xs then verdict_is (negb (looks_again p)) else
                both (verdict_is (negb (asks_time news xs (last_letter p))))
                  (narrowed allowed (PAnd (last_letter p) no_news) (move_on Wait q x t (stand p) (looks_again p)))))
    | _, _, _ => verdict_is false
    end.

  Definition begins_right : judgement :=
    match nth_error (stances P) 0, nth_error (verdicts M) 0, nth_error (edges M) 0 with
    | Some x, Some v, Some t =>
        both (verdict_is (same_verdict (shows_verdict x) v))
          (if permanent 0 then verdict_is (existsb (meets (stays 0) 0) pairs)
           else move_on Opening 0 x t (map initial xs) false allowed)
    | _, _, _ => verdict_is false
    end.

  (** When clocks are first due, and that the program asks for no atom that trackers decide. *)
  Definition first_dues : list (option nat) :=
    map (fun x => match about x with
                  | Follows (Age _ _) => if permanent 0 then None else Some (nth 0 (bounds x) 0)
                  | _ => None
                  end) (filter has_bounds xs).
  Definition same_dues (ds ds' : list (option nat)) : bool :=
    if list_eq_dec (fun d d' : option nat => ltac:(decide equality; apply Nat.eq_dec)) ds ds' then true else false.
  Definition is_decided (a : nat) : bool := existsb (fun x => existsb (Nat.eqb a) (Trackers.decides x)) xs.
  Definition asks_for_nothing_decided : bool :=
    forallb (fun b => match asked b with Holds a => negb (is_decided a) | IsLate _ => true end) (branches P).
End Checker.

(** Whether P follows M over the letters that A allows, with the trackers xs. *)
Definition follows_monitor (depth work : nat) (news : list nat) (xs : list tracker_of) (A : predicate) (M : monitor)
  (P : program) (pairs : list pair) : bool :=
  let allowed := unfold (as_formula A) in
  same_dues (first_due P) (first_dues xs M) && asks_for_nothing_decided xs P &&
  fst (both (begins_right depth xs allowed P M pairs) (all (pair_is_right depth news xs allowed P M pairs) pairs)
         (new_memory work)).

(** * What its answers mean *)

(** What is remembered: equivalences. *)
Definition equal_conditions (x : claim) : Prop := match x with Equivalent c d => same c d | Covered _ _ _ _ => True end.
Notation shown := (shows equal_conditions).

Lemma shown_for_all : forall {X} j (Q : X -> Prop) (x0 : X), (forall x, shown j (Q x)) -> shown j (forall x, Q x).
Proof.
  intros X j Q x0 H m b m' E Hm. split; [apply (H x0 m b m' E Hm)|]. intros Hb x. now apply (H x m b m' E Hm).
Qed.

(** The letter answers as is known, and satisfies the condition. *)
Definition fits_letter (l : letter) (known : answered) (ctx : condition) : Prop :=
  (forall a v, In (a, v) known -> l a = v) /\ true_in (model_of l) ctx.

Lemma model_assign : forall l a c, true_in (model_of l) (assign (AtStep a) (l a) c) <-> true_in (model_of l) c.
Proof. intros l a c. apply assign_true; [apply model_of_reads | simpl; tauto]. Qed.

Lemma fits_assigned : forall l known ctx a v, l a = v -> fits_letter l known ctx ->
  fits_letter l ((a, v) :: known) (assign (AtStep a) v ctx).
Proof.
  intros l known ctx a v <- [H1 H2]. split; [|now apply model_assign].
  intros b w [E|H]; [injection E as <- <-; reflexivity | auto].
Qed.

Lemma answer_in : forall known a v, answer_to a known = Some v -> In (a, v) known.
Proof.
  induction known as [|[b w] known IH]; simpl; intros a v H; [discriminate|].
  destruct (Nat.eqb_spec a b) as [->|]; [left; congruence | right; auto].
Qed.

Lemma under_true : forall l c known ctx, fits_letter l known ctx ->
  (true_in (model_of l) (under known c) <-> true_in (model_of l) c).
Proof.
  intros l c known ctx [H _]. induction known as [|[a v] known IH]; simpl; [tauto|].
  rewrite <- (H a v (or_introl eq_refl)), model_assign. apply IH. intros b w Hb. apply H. now right.
Qed.

Lemma unless_false : forall ctx, ctx = Constant false \/
  forall (X : Type) (x y : X), match ctx with Constant false => x | _ => y end = y.
Proof. destruct ctx as [[]| | | |]; auto. Qed.
Lemma fits_no_false : forall l known, ~ fits_letter l known (Constant false).
Proof. intros l known [_ H]. discriminate H. Qed.

Section Walks.
  Variables (node result : Type) (look : node -> option (seen node result)) (is_late : nat -> bool).
  Variables (l : letter) (reaches_end : node -> result -> Prop).
  Let says (q : question) : bool := match q with Holds a => l a | IsLate c => is_late c end.
  Hypothesis at_end : forall n x, look n = Some (Found x) -> reaches_end n x.
  Hypothesis at_question : forall n q yes no x, look n = Some (Decides q yes no) ->
    reaches_end (if says q then yes else no) x -> reaches_end n x.

  Lemma walk_shows : forall (judge : result -> answered -> condition -> judgement) (Q : result -> Prop),
    (forall x known ctx, shown (judge x known ctx) (fits_letter l known ctx -> Q x)) ->
    forall fuel n known ctx, shown (walk _ _ look is_late fuel n known ctx judge)
      (fits_letter l known ctx -> exists x, reaches_end n x /\ Q x).
  Proof.
    intros judge Q HJ. induction fuel as [|fuel IH]; intros n known ctx m b m' H Hm; simpl in H.
    { destruct ctx as [[]| | | |]; injection H as <- <-; split; auto; try congruence.
      intros _ HF. now destruct (fits_no_false _ _ HF). }
    destruct (unless_false ctx) as [-> | HN].
    { injection H as <- <-. split; auto. intros _ HF. now destruct (fits_no_false _ _ HF). }
    rewrite HN in H. clear HN. destruct (spend (weight ctx) m) as [m1|] eqn:Es; [|injection H as <- <-; split; auto; congruence].
    apply (spend_sound equal_conditions) in Es; auto.
    destruct (look n) as [[x|[a|c] yes no]|] eqn:El; [| | |injection H as <- <-; split; auto; congruence].
    - destruct (HJ x known ctx _ _ _ H Es) as [HS HQ]. split; auto. intros Hb HF. exists x. auto.
    - destruct (answer_to a known) as [v|] eqn:Ea.
      + destruct (IH _ _ _ _ _ _ H Es) as [HS HQ]. split; auto. intros Hb HF. destruct (HQ Hb HF) as (x & H1 & H2).
        exists x. split; auto. apply (at_question n _ _ _ x El). simpl. now rewrite (proj1 HF a v (answer_in _ _ _ Ea)).
      + destruct (both_shows equal_conditions _ _ _ _ (IH yes ((a, true) :: known) (assign (AtStep a) true ctx))
                    (IH no ((a, false) :: known) (assign (AtStep a) false ctx)) _ _ _ H Es) as [HS HQ].
        split; auto. intros Hb HF. destruct (HQ Hb) as [H1 H0].
        assert (HX : exists x, reaches_end (if l a then yes else no) x /\ Q x).
        { destruct (l a) eqn:Ela; [apply H1 | apply H0]; now apply fits_assigned. }
        destruct HX as (x & H2 & H3). exists x. split; auto. now apply (at_question n _ _ _ x El).
    - destruct (IH _ _ _ _ _ _ H Es) as [HS HQ]. split; auto. intros Hb HF. destruct (HQ Hb HF) as (x & H1 & H2).
      exists x. split; auto. now apply (at_question n _ _ _ x El).
  Qed.
End Walks.

Lemma by_cases_shows : forall l (Q : Prop) judge,
  (forall known ctx, shown (judge known ctx) (fits_letter l known ctx -> Q)) ->
  forall fuel known ctx, shown (by_cases fuel known ctx judge) (fits_letter l known ctx -> Q).
Proof.
  intros l Q judge HJ. induction fuel as [|fuel IH]; intros known ctx m b m' H Hm; simpl in H;
    (destruct (unless_false ctx) as [-> | HN];
      [injection H as <- <-; split; auto; intros _ HF; now destruct (fits_no_false _ _ HF) | rewrite HN in H; clear HN]).
  - now apply (HJ known ctx m).
  - destruct (first_atom ctx) as [a|]; [|now apply (HJ known ctx m)].
    destruct (spend (weight ctx) m) as [m1|] eqn:Es; [|now apply (HJ known ctx m)].
    apply (spend_sound equal_conditions) in Es; auto.
    assert (HB : shown (both (by_cases fuel ((a, true) :: known) (assign (AtStep a) true ctx) judge)
                             (by_cases fuel ((a, false) :: known) (assign (AtStep a) false ctx) judge))
                   (fits_letter l known ctx -> Q)).
    { eapply shows_some; [apply both_shows; apply IH|]. intros [H1 H0] HF.
      destruct (l a) eqn:Ela; [apply H1 | apply H0]; now apply fits_assigned. }
    exact (either_shows equal_conditions _ _ _ (HJ known ctx) HB _ _ _ H Es).
Qed.

Section Means.
  Variables (depth : nat) (news : list nat) (xs : list tracker_of) (A : predicate).
  Variables (P : program) (M : monitor) (pairs : list pair).
  Let allowed := unfold (as_formula A).

  (** By the letter l the trackers do [cs], the program does y, and the monitor is then in r. *)
  Definition landed (o : occasion) (rs : list row) (cs : list case) (l : letter) (y : outcome) (r : nat) : Prop :=
    are_due_right (if permanent M r then is_off else is_due_right o) y 0 rs = true /\
    (forall z, In z (settings y) -> set_clock z < length (first_due P)) /\
    exists p, In p pairs /\ meets y r p = true /\ (permanent M r = true \/ stand p = map next cs) /\
      at_letter (last_letter p) l = true.
  Definition landed_for_good (y : outcome) (r : nat) : Prop :=
    permanent M r = true /\ (exists p, In p pairs /\ meets y r p = true) /\
    forall z, In z (settings y) -> match to_be_due z with None | Some (WhenDue, _) => True | _ => False end.

  Lemma lands_shows : forall o rs cs l y r known ctx,
    shown (lands depth P M pairs o rs cs y r known ctx) (fits_letter l known ctx -> landed o rs cs l y r).
  Proof.
    intros o rs cs l y r known ctx. unfold lands, landed.
    destruct (are_due_right _ y 0 rs); [|now apply verdict_is_shows].
    destruct (forallb _ (settings y)) eqn:EF; [|now apply verdict_is_shows]. rewrite forallb_forall in EF.
    eapply shows_some.
    - apply (any_shows equal_conditions _ (fun p => fits_letter l known ctx -> meets y r p = true /\
        (permanent M r = true \/ stand p = map next cs) /\ at_letter (last_letter p) l = true)).
      intros p. destruct (meets y r p && _) eqn:EM; [|now apply verdict_is_shows]. apply andb_true_iff in EM.
      destruct EM as [EM ES]. eapply shows_some; [now apply follows_shows|]. intros H HF. split; auto. split.
      + apply orb_true_iff in ES. destruct ES as [ES|ES]; auto. right. unfold same_states in ES.
        destruct (list_eq_dec _ (stand p) (map next cs)); [auto | discriminate].
      + apply (predicate_true _ l (model_of_reads l)). apply (under_true l _ known ctx HF).
        apply H; [apply model_of_reads | apply HF].
    - intros (p & H1 & H2) HF. split; auto. split.
      + intros z Hz. apply Nat.ltb_lt. now apply EF.
      + exists p. destruct (H2 HF) as (B & C & D). auto.
  Qed.

  Lemma lands_for_good_shows : forall y r known ctx, shown (lands_for_good M pairs y r known ctx) (landed_for_good y r).
  Proof.
    intros y r known ctx. apply verdict_is_shows. intros H. rewrite !andb_true_iff, forallb_forall in H.
    destruct H as [[H1 H2] H3]. apply existsb_exists in H2. destruct H2 as (p & H2). split; auto. split; [eauto|].
    intros z Hz. specialize (H3 z Hz). destruct (to_be_due z) as [[[] ?]|]; auto; discriminate.
  Qed.

  (** Where a letter leads, with these clocks late. *)
  Definition answers_with (l : letter) (late : list bool) (q : question) : bool :=
    match q with Holds a => l a | IsLate i => nth i late false end.
  Definition leads_to (late : list bool) (w : option way) (q : nat) (t : target) (l : letter)
    (land : outcome -> nat -> Prop) : Prop :=
    exists y r, match w with Some w => ends P (answers_with l late) w y | None => y = stays q end /\
      leads M l t r /\ land y r.

  Lemma lead_shows : forall late w q t ctx land (Q : letter -> outcome -> nat -> Prop),
    (forall l y r known c, shown (land y r known c) (fits_letter l known c -> Q l y r)) ->
    shown (lead depth P M late w q t ctx land) (forall l, true_in (model_of l) ctx -> leads_to late w q t l (Q l)).
  Proof.
    intros late w q t ctx land Q HL. apply (shown_for_all _ _ no_atom). intros l.
    assert (HM : forall y known c, shown
        (walk _ _ (look_of_monitor M) (fun _ => false) depth t known c (fun r known ctx => by_cases depth known ctx (land y r)))
        (fits_letter l known c -> exists r, leads M l t r /\ Q l y r)).
    { intros y. apply walk_shows.
      - intros [r|d] x E; simpl in E; [injection E as ->; constructor | destruct (nth_error _ d); discriminate].
      - intros [r|d] x yes no z E H; simpl in E; [discriminate|].
        destruct (nth_error (decisions M) d) as [u|] eqn:Ed; [|discriminate]. injection E as <- <- <-.
        now apply (leads_ask M l d u).
      - intros r known c. apply by_cases_shows. intros known' c'. apply HL. }
    assert (H0 : true_in (model_of l) ctx -> fits_letter l [] ctx) by (intros H; split; [intros a v [] | exact H]).
    unfold lead, leads_to. destruct w as [w|].
    - eapply shows_some.
      + apply (walk_shows _ _ (look_of_program P) (fun i => nth i late false) l
                 (fun w y => ends P (answers_with l late) w y)) with (Q := fun y => exists r, leads M l t r /\ Q l y r).
        * intros [o|d] x E; simpl in E; [|destruct (nth_error _ d); discriminate].
          destruct (nth_error (outcomes P) o) eqn:Eo; [|discriminate]. injection E as <-. now constructor.
        * intros [o|d] x yes no z E H; simpl in E; [destruct (nth_error _ o); discriminate|].
          destruct (nth_error (branches P) d) as [u|] eqn:Ed; [|discriminate]. injection E as <- <- <-.
          now apply (ends_asked P _ d u).
        * intros y known c. apply HM.
      + intros H HT. destruct (H (H0 HT)) as (y & H1 & r & H2 & H3). exists y, r. auto.
    - eapply shows_some; [apply HM|]. intros H HT. destruct (H (H0 HT)) as (r & H1 & H2). exists (stays q), r. auto.
  Qed.

  (** What happens at an occasion, by a letter with which the trackers do some cases. *)
  Definition moves_on (o : occasion) (q : nat) (x : stance) (t : target) (sts : list state) (looks : bool) (l : letter) :
    Prop := forall g cs, In (g, cs) (together xs sts (fun _ => closed) match o with Opening => true | _ => false end) ->
      at_letter g l = true -> (o = Step -> existsb (fun b => b) (those_passing xs sts cs) = false) ->
      forall late, In late (choices (map (may_be_late o) (rows xs sts cs))) ->
      exists w, way_to_go o x looks late = Some w /\ leads_to late w q t l (landed o (rows xs sts cs) cs l).

  Lemma move_on_shows : forall o q x t sts looks ctx,
    shown (move_on depth xs P M pairs o q x t sts looks ctx) (forall l, lets l ctx -> moves_on o q x t sts looks l).
  Proof.
    intros o q x t sts looks ctx. eapply shows_some.
    - apply (each_case_shows equal_conditions xs sts _ _ ctx _ (fun c cs =>
        (o = Step -> existsb (fun b => b) (those_passing xs sts cs) = false) ->
        forall late, In late (choices (map (may_be_late o) (rows xs sts cs))) ->
        exists w, way_to_go o x looks late = Some w /\
          forall l, true_in (model_of l) c -> leads_to late w q t l (landed o (rows xs sts cs) cs l))).
      intros c cs.
      assert (HS : shown (all (fun late => match way_to_go o x looks late with
            | Some w => lead depth P M late w q t c (lands depth P M pairs o (rows xs sts cs) cs)
            | None => verdict_is false end) (choices (map (may_be_late o) (rows xs sts cs))))
          (forall late, In late (choices (map (may_be_late o) (rows xs sts cs))) ->
            exists w, way_to_go o x looks late = Some w /\
              forall l, true_in (model_of l) c -> leads_to late w q t l (landed o (rows xs sts cs) cs l))).
      { apply all_shows. intros late. destruct (way_to_go o x looks late) as [w|]; [|now apply verdict_is_shows].
        eapply shows_some; [apply lead_shows; intros; apply lands_shows|]. intros H. exists w. auto. }
      destruct (match o with Step => existsb (fun b => b) (those_passing xs sts cs) | _ => false end) eqn:EP.
      + apply verdict_is_shows. intros _ HN. destruct o; try discriminate EP. rewrite (HN eq_refl) in EP. discriminate.
      + eapply shows_some; [exact HS | auto].
    - intros H l Hl g cs Hg Hgl HP late Hlate. destruct (H l g cs Hl Hg Hgl) as (c & Hc & HQ).
      destruct (HQ HP late Hlate) as (w & Hw & HL). exists w. split; auto. apply HL. apply Hc, model_of_reads.
  Qed.

  Definition right_pair (p : pair) : Prop := exists x v t,
    nth_error (stances P) (in_program p) = Some x /\ nth_error (verdicts M) (in_monitor p) = Some v /\
    nth_error (edges M) (in_monitor p) = Some t /\ shows_verdict x = v /\
    if permanent M (in_monitor p) then
      looks_again p = false /\
      forall l, at_letter A l = true -> leads_to [] (Some (at_step x)) (in_program p) t l landed_for_good /\
                                        leads_to [] None (in_program p) t l landed_for_good
    else
      (forall l, at_letter A l = true -> moves_on Step (in_program p) x t (stand p) (looks_again p) l) /\
      (if is_trivial news xs then looks_again p = false else asks_time news xs (last_letter p) = false /\
        forall l, at_letter A l = true -> at_letter (PAnd (last_letter p) (no_news news)) l = true ->
          moves_on Wait (in_program p) x t (stand p) (looks_again p) l).

  Lemma same_verdict_true : forall v w, same_verdict v w = true -> v = w.
  Proof. destruct v, w; simpl; congruence. Qed.
  Lemma allowed_lets : forall l, at_letter A l = true -> lets l allowed.
  Proof. intros l H. now apply lets_predicate. Qed.

  Lemma pair_is_right_shows : forall p, shown (pair_is_right depth news xs allowed P M pairs p) (right_pair p).
  Proof.
    intros p. unfold pair_is_right, right_pair. cbv zeta.
    destruct (nth_error (stances P) (in_program p)) as [x|]; [|now apply verdict_is_shows].
    destruct (nth_error (verdicts M) (in_monitor p)) as [v|]; [|now apply verdict_is_shows].
    destruct (nth_error (edges M) (in_monitor p)) as [t|]; [|now apply verdict_is_shows].
    destruct (permanent M (in_monitor p)).
    - eapply shows_some.
      + apply both_shows; [apply verdict_is_shows; intros E; exact (same_verdict_true _ _ E)|].
        apply both_shows; [apply verdict_is_shows; intros E; exact (proj1 (negb_true_iff _) E)|].
        apply both_shows; apply lead_shows with (Q := fun _ => landed_for_good); intros l y r known c;
          (eapply shows_some; [apply lands_for_good_shows | auto]).
      + intros (HV & HL & H1 & H2). exists x, v, t. repeat split; auto; [apply H1 | apply H2];
          apply (allowed_lets l); auto using model_of_reads.
    - assert (HW : shown (if is_trivial news xs then verdict_is (negb (looks_again p)) else
            both (verdict_is (negb (asks_time news xs (last_letter p))))
              (narrowed allowed (PAnd (last_letter p) (no_news news))
                 (move_on depth xs P M pairs Wait (in_program p) x t (stand p) (looks_again p))))
          (if is_trivial news xs then looks_again p = false else asks_time news xs (last_letter p) = false /\
            forall l, lets l allowed -> at_letter (PAnd (last_letter p) (no_news news)) l = true ->
              exists c, lets l c /\
                forall l, lets l c -> moves_on Wait (in_program p) x t (stand p) (looks_again p) l)).
      { destruct (is_trivial news xs); [apply verdict_is_shows; intros E; exact (proj1 (negb_true_iff _) E)|].
        apply both_shows; [apply verdict_is_shows; intros E; exact (proj1 (negb_true_iff _) E)|].
        apply narrowed_shows. intros c. apply move_on_shows. }
      eapply shows_some.
      + apply both_shows; [apply verdict_is_shows; intros E; exact (same_verdict_true _ _ E)|].
        apply both_shows; [apply move_on_shows | exact HW].
      + intros (HV & HS & HX). exists x, v, t. repeat split; auto using allowed_lets.
        destruct (is_trivial news xs); auto. destruct HX as [HT HN]. split; auto.
        intros l Ha Hl. destruct (HN l (allowed_lets l Ha) Hl) as (c & Hc & HM). auto.
  Qed.

  Definition begins_well : Prop := exists x v t,
    nth_error (stances P) 0 = Some x /\ nth_error (verdicts M) 0 = Some v /\ nth_error (edges M) 0 = Some t /\
    shows_verdict x = v /\
    if permanent M 0 then exists p, In p pairs /\ meets (stays 0) 0 p = true
    else forall l, at_letter A l = true -> moves_on Opening 0 x t (map initial xs) false l.

  Lemma begins_right_shows : shown (begins_right depth xs allowed P M pairs) begins_well.
  Proof.
    unfold begins_right, begins_well.
    destruct (nth_error (stances P) 0) as [x|]; [|now apply verdict_is_shows].
    destruct (nth_error (verdicts M) 0) as [v|]; [|now apply verdict_is_shows].
    destruct (nth_error (edges M) 0) as [t|]; [|now apply verdict_is_shows].
    destruct (permanent M 0); (eapply shows_some;
      [apply both_shows; [apply verdict_is_shows; intros E; exact (same_verdict_true _ _ E)|] | ]).
    - apply verdict_is_shows. intros E. exact (proj1 (existsb_exists _ _) E).
    - intros (HV & HE). exists x, v, t. auto.
    - apply move_on_shows.
    - intros (HV & HE). exists x, v, t. repeat split; auto using allowed_lets.
  Qed.

  Theorem accepted_means : forall work, follows_monitor depth work news xs A M P pairs = true ->
    first_due P = first_dues xs M /\ asks_for_nothing_decided xs P = true /\ begins_well /\
    forall p, In p pairs -> right_pair p.
  Proof.
    intros work H. unfold follows_monitor in H. rewrite !andb_true_iff in H. destruct H as [[HD HA] H].
    assert (HS : shown (both (begins_right depth xs allowed P M pairs) (all (pair_is_right depth news xs allowed P M pairs) pairs))
                   (begins_well /\ forall p, In p pairs -> right_pair p)).
    { apply both_shows; [apply begins_right_shows | apply all_shows; apply pair_is_right_shows]. }
    fold allowed in H. destruct (both _ _ (new_memory work)) as [b m] eqn:E. simpl in H. subst b.
    destruct (HS _ _ _ E (new_memory_sound _ _)) as [_ HR]. specialize (HR eq_refl).
    unfold same_dues in HD. destruct (list_eq_dec _ (first_due P) (first_dues xs M)); [tauto | discriminate].
  Qed.
End Means.
