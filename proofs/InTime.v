(** What an accepted certificate proves of runs in time.

    A run has letters and times, an instant at every nanosecond ([observed]). The monitor reads the first instant, each
    step, and those at which the letter with its clocks and its past is not what it was ([reading]). After every run its
    verdict is right for the property as the language defines it: [certified]. With [exact], no verdict comes later than
    the words of the reset machine demand: [certified_exactly]. If there is one clock, these are runs in time:
    [certified_exactly_in_time]. Without time: [certified_untimed], [certified_exactly_untimed]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Stutter Trackers Resets ClockSteps OneClock Monitor
  Machines Distribute Certificate Infinite.

(** * What is read of a word *)

(** Of a word with times, the first n instants that are read, then every one: [read_at n] instants have been seen. *)
Record reading (e : stream) (t : times) (read_at : nat -> nat) (n : nat) : Prop := {
  first_read : read_at 0 = 0;
  in_order : forall j, read_at j < read_at (S j);
  left_out : forall j k, read_at j <= k < read_at (S j) -> forall a, e k a = e (read_at j) a;
  no_step_left_out : forall j k, read_at j < S k < read_at (S j) -> t k < t (S k);
  all_later : forall i, read_at (n + i) = read_at n + i
}.

Section Reading.
  Variables (e : stream) (t : times) (read_at : nat -> nat) (n : nat) (v : stream).
  Hypothesis HR : reading e t read_at n.
  Hypothesis letters_read : forall j a, v j a = e (read_at j) a.

  Lemma reading_order : forall i j, i < j -> read_at i < read_at j.
  Proof.
    intros i j H. induction H as [|j _ IH]; [apply (in_order _ _ _ _ HR)|]. pose proof (in_order _ _ _ _ HR j). lia.
  Qed.

  (** The letter that was read last at each instant. *)
  Fixpoint last_read (k : nat) : nat :=
    match k with 0 => 0 | S k => if read_at (S (last_read k)) =? S k then S (last_read k) else last_read k end.

  Lemma last_read_is : forall k, read_at (last_read k) <= k < read_at (S (last_read k)).
  Proof.
    induction k as [|k IH]; simpl.
    - pose proof (first_read _ _ _ _ HR). pose proof (in_order _ _ _ _ HR 0). lia.
    - destruct (Nat.eqb_spec (read_at (S (last_read k))) (S k)) as [E|E]; [|lia].
      pose proof (in_order _ _ _ _ HR (S (last_read k))). lia.
  Qed.

  Lemma last_read_unique : forall k j, read_at j <= k < read_at (S j) -> last_read k = j.
  Proof.
    intros k j H. pose proof (last_read_is k) as HL.
    destruct (lt_eq_lt_dec (last_read k) j) as [[HJ|HJ]|HJ]; auto; exfalso.
    - destruct (Nat.eq_dec (S (last_read k)) j) as [<-|]; [lia|].
      pose proof (reading_order (S (last_read k)) j ltac:(lia)). lia.
    - destruct (Nat.eq_dec (S j) (last_read k)) as [E|]; [rewrite E in *; lia|].
      pose proof (reading_order (S j) (last_read k) ltac:(lia)). lia.
  Qed.

  Lemma repeats_read : forall L M, (forall k, inside L k <-> inside M (last_read k)) -> repeats last_read e L v M.
  Proof.
    intros L M HE. split; auto.
    - intros i k H. induction H as [|k _ IH]; auto. simpl. destruct (_ =? _); lia.
    - intros j _. exists (read_at j). apply last_read_unique. pose proof (in_order _ _ _ _ HR j). lia.
    - intros k a _. rewrite letters_read. apply (left_out _ _ _ _ HR). apply last_read_is.
  Qed.

  (** A formula without next says the same of what is read as of all instants. *)
  Lemma read_for_ever : forall f, is_next_free f = true -> (sat f e None 0 <-> sat f v None 0).
  Proof.
    intros f Hf. apply (stutter_invariant f last_read e None v None); auto. apply repeats_read. simpl. tauto.
  Qed.
  Lemma read_so_far : forall f, is_next_free f = true -> (sat f e (Some (read_at n)) 0 <-> sat f v (Some n) 0).
  Proof.
    intros f Hf. apply (stutter_invariant f last_read e (Some (read_at n)) v (Some n)); auto. apply repeats_read.
    intros k. simpl. pose proof (last_read_is k). split; intros H0.
    - destruct (le_lt_dec n (last_read k)) as [Hn|]; auto. exfalso.
      destruct (Nat.eq_dec n (last_read k)) as [E|]; [rewrite E in *; lia|].
      pose proof (reading_order n (last_read k) ltac:(lia)). lia.
    - destruct (Nat.eq_dec (S (last_read k)) n) as [<-|]; [lia|].
      pose proof (reading_order (S (last_read k)) n ltac:(lia)). lia.
  Qed.
End Reading.

Section Certified.
  Variables (depth work : nat) (C : certificate).
  Hypothesis HC : check depth work C = true.
  Hypothesis episode : encoded_by C = Episode.
  Variable began : nat.                  (* when the session began *)
  Let M := machine C.
  Let xs := trackers C.

  (** The letters of a run, with the past and the clocks. *)
  Definition word_of (s : stream) (t : times) : stream := timed_word (defined C) (judged C) began s t.

  (** The runs in question: those whose letters the certificate assumes. *)
  Definition is_run (r : stream * times) : Prop :=
    observed (news C) (fst r) (snd r) /\ forall k, at_letter (assumption C) (word_of (fst r) (snd r) k) = true.
  (** Those that are the same in their first N instants. *)
  Definition goes_on (r : stream * times) (N : nat) (r' : stream * times) : Prop :=
    is_run r' /\ same_before N (fst r) (fst r') (snd r) (snd r').

  (** What the language says of a run, and of its beginning up to L. *)
  Definition meets_up_to (L : option nat) (r : stream * times) : Prop :=
    satisfies (subject C) (with_past began (defined C) (fst r) (snd r)) (snd r) L 0.

  Lemma is_proper : proper (defined C) (judged C) (news C) = true.
  Proof.
    pose proof (accepted_defined depth work C HC) as H. unfold well_defined in H. now apply andb_true_iff in H.
  Qed.

  Lemma word_means : forall r L, is_run r -> (L = None \/ exists n, L = Some n) ->
    (sat (formula_of C) (word_of (fst r) (snd r)) L 0 <-> meets_up_to L r).
  Proof.
    intros [s t] L [HO _] HL. unfold formula_of, meets_up_to, word_of, timed_word. rewrite episode.
    rewrite <- (distribute_means_the_same (subject C)). apply encode_correct_online.
    - split; [apply HO|]. intros _. apply HO.
    - exact (proper_anchored _ _ _ is_proper).
    - apply (timers_their_own _ _ _ (proper_atoms _ _ _ is_proper)).
    - destruct HL as [-> | (n & ->)]; [apply decided_infinite | apply decided_finite].
  Qed.

  (** What is read of a run is a word of the machine. *)
  Lemma read_word : forall s t read_at n v, is_run (s, t) -> reading (word_of s t) t read_at n ->
    (forall j a, v j a = word_of s t (read_at j) a) -> exists path, is_run_of C v path.
  Proof.
    intros s t read_at n v [HO HA] HR HV. simpl in HO, HA.
    assert (HW : exists path, word (news C) xs v path).
    { destruct (is_trivial (news C) xs) eqn:E.
      - exists (fun _ => start xs). unfold word, moves_by, moves, sets. rewrite E.
        repeat split; [|intros; lia]. intros k. eexists. split; [left; reflexivity|]. auto.
      - pose proof (proper_trackers _ _ _ is_proper E) as HX. pose proof (proper_atoms _ _ _ is_proper) as HN.
        assert (HW : forall x, In x xs -> well_formed (word_of s t) t began x)
          by (intros x Hx; now apply (trackers_well_formed _ _ _ _ HX HN)).
        eexists. apply (steps_are_words (news C) xs (word_of s t) t began) with (read_at := read_at) (n := n);
          try apply HO; try apply HR; auto.
        + now apply runs_of_property_are_words.
        + intros j [|k] Hk; [lia|]. apply (settled_held (news C) xs (word_of s t) t began); auto.
          * apply (word_held _ _ _ _ HX HN _ _ _ HO).
          * now apply (no_step_left_out _ _ _ _ HR j). }
    destruct HW as (path & HW). exists path. split; auto. intros k. rewrite <- (HA (read_at k)).
    apply at_letter_same. auto.
  Qed.

  Lemma goes_on_same : forall s t s' t' N, same_before N s s' t t' -> forall k a, k < N ->
    word_of s' t' k a = word_of s t k a.
  Proof.
    intros s t s' t' N H k a Hk. symmetry. unfold word_of, timed_word.
    apply (with_clocks_causal (judged C) _ _ t t' N); auto. now apply with_past_causal.
  Qed.

  Section Run.
    Variables (s : stream) (t : times) (read_at : nat -> nat) (n : nat).
    Hypothesis HS : is_run (s, t).
    Hypothesis HR : reading (word_of s t) t read_at n.
    (** What the monitor reads. *)
    Let v : stream := fun j => word_of s t (read_at j).
    Let N := read_at n.

    (** What is read of a run that goes on. *)
    Definition read_on (r : stream * times) : stream := fun j =>
      if j <? n then v j else word_of (fst r) (snd r) (read_at j).

    Lemma read_on_is : forall r, goes_on (s, t) N r -> reading (word_of (fst r) (snd r)) (snd r) read_at n /\
      forall j a, read_on r j a = word_of (fst r) (snd r) (read_at j) a.
    Proof.
      intros [s' t'] [HG HB]. simpl in *. assert (HE := goes_on_same s t s' t' N HB).
      assert (HN : forall j, j < n -> read_at (S j) <= N).
      { intros j Hj. unfold N. destruct (Nat.eq_dec (S j) n) as [->|]; auto.
        pose proof (reading_order _ _ _ _ HR (S j) n). lia. }
      split.
      - split; try apply HR; intros j k Hk; [intros a|]; destruct (le_lt_dec n j) as [Hj|Hj].
        + pose proof (all_later _ _ _ _ HR (j - n)) as E1. pose proof (all_later _ _ _ _ HR (S (j - n))) as E2.
          replace (n + (j - n)) with j in E1 by lia. replace (n + S (j - n)) with (S j) in E2 by lia.
          replace k with (read_at j) by lia. reflexivity.
        + specialize (HN j Hj). rewrite !HE by lia. now apply (left_out _ _ _ _ HR).
        + pose proof (all_later _ _ _ _ HR (j - n)) as E1. pose proof (all_later _ _ _ _ HR (S (j - n))) as E2.
          replace (n + (j - n)) with j in E1 by lia. replace (n + S (j - n)) with (S j) in E2 by lia. lia.
        + specialize (HN j Hj). rewrite <- (proj1 (HB k ltac:(lia))), <- (proj1 (HB (S k) ltac:(lia))).
          now apply (no_step_left_out _ _ _ _ HR j).
      - intros j a. unfold read_on. destruct (Nat.ltb_spec j n); auto. symmetry. apply HE.
        now apply (reading_order _ _ _ _ HR).
    Qed.

    Lemma read_on_continues : forall r, goes_on (s, t) N r -> continues C v n (read_on r) /\
      (holds_for_ever C (read_on r) <-> meets_up_to None r).
    Proof.
      intros [s' t'] HG. destruct (read_on_is _ HG) as [HR' HV]. split; [split|].
      - eapply read_word; [apply HG | exact HR' | exact HV].
      - intros k Hk. unfold read_on. now rewrite (proj2 (Nat.ltb_lt _ _) Hk).
      - rewrite <- (word_means (s', t') None) by (auto; apply HG). symmetry.
        apply (read_for_ever _ _ _ _ _ HR' HV). apply encode_next_free.
    Qed.

    Lemma so_far_means : sat (formula_of C) v (Some n) 0 <-> meets_up_to (Some N) (s, t).
    Proof.
      rewrite <- (word_means (s, t)) by eauto. symmetry. apply (read_so_far _ _ _ _ v HR); [reflexivity|].
      apply encode_next_free.
    Qed.

    Lemma begins_read : exists path, begins C v path n.
    Proof.
      destruct (read_word s t read_at n v HS HR) as (path & HW); [reflexivity|]. exists path. now apply run_path.
    Qed.

    (** The verdict after every run is right: of the run so far, or of every run that it can become. *)
    Theorem certified : exists q u, reaches M v n q /\ nth_error (verdicts M) q = Some u /\
      right_verdict (goes_on (s, t) N) (meets_up_to None) (meets_up_to (Some N) (s, t)) u.
    Proof.
      destruct begins_read as (path & HB). destruct (check_sound depth work C HC v path n HB) as (q & u & H1 & H2 & H3).
      exists q, u. split; auto. split; auto. pose proof so_far_means as HM. destruct u; simpl in *; try tauto;
        intros r Hr; destruct (read_on_continues r Hr) as [A B]; specialize (H3 _ A); tauto.
    Qed.

    (** And while it is not permanent, words of the machine go on from what has been read to either outcome. *)
    Theorem certified_exactly : exact C = true -> exists q u, reaches M v n q /\ nth_error (verdicts M) q = Some u /\
      right_verdict (goes_on (s, t) N) (meets_up_to None) (meets_up_to (Some N) (s, t)) u /\
      (presumed (meets_up_to (Some N) (s, t)) u -> undecided (continues C v n) (holds_for_ever C)).
    Proof.
      intros HE. destruct begins_read as (path & HB).
      destruct (check_exactly depth work C HC HE v path n HB) as (q & u & H1 & H2 & _ & H3).
      destruct certified as (q' & u' & C1 & C2 & C3). assert (q' = q) by (eapply reaches_unique; eauto). subst q'.
      fold M in H2. rewrite H2 in C2. injection C2 as <-. exists q, u. split; auto. split; auto. split; auto.
      intros HP. apply H3. pose proof so_far_means as HM. destruct u; simpl in *; tauto.
    Qed.
  End Run.

  (** ** One clock *)

  (** Of the property's trackers one is a clock with bounds, the others are of scopes; there are no atoms of the past,
      and no news. *)
  Definition has_one_clock : Prop := exists scopes z, xs = scopes ++ [z] /\ (forall x, In x scopes -> is_scope x) /\
    one_clock (judged C) z /\ bounds z <> [] /\ defined C = [] /\ news C = [].

  (** A run in time: its letters show which clocks are late. More than a nanosecond may pass between two instants. *)
  Definition in_time (r : stream * times) : Prop :=
    timed (snd r) None /\ shown (timers WholeRun (judged C)) (fst r) (snd r).
  Definition goes_on_in_time (v : stream) (n : nat) (r : stream * times) : Prop :=
    in_time r /\ continues C v n (fst r).
  Definition meets_in_time (r : stream * times) : Prop := satisfies (subject C) (fst r) (snd r) None 0.

  Theorem one_clock_in_time : has_one_clock -> forall v n, undecided (continues C v n) (holds_for_ever C) ->
    undecided (goes_on_in_time v n) meets_in_time.
  Proof.
    intros (scopes & z & HX & HS & HO & HB & HD & _) v n.
    assert (HT : trackers_of (defined C) (judged C) (news C) xs).
    { apply proper_trackers; [exact is_proper|]. change (is_trivial (news C) xs = false). rewrite HX.
      destruct scopes; reflexivity. }
    assert (HW : forall w, continues C v n w -> exists t, goes_on_in_time v n (w, t) /\
              (holds_for_ever C w <-> meets_in_time (w, t))).
    { intros w Hw. pose proof Hw as [(path & Hp & _) _]. fold xs in Hp. rewrite HX in Hp, HT. rewrite HD in HT.
      destruct (one_clock_words_are_runs (judged C) (news C) scopes z w path HT HS HO HB
                  (proper_anchored _ _ _ is_proper) (decided_infinite w) Hp) as (t & T1 & T2 & T3).
      exists t. split; [split; [split|]; auto|]. unfold holds_for_ever, formula_of, meets_in_time. rewrite episode, T3.
      apply distribute_means_the_same. }
    intros [(w1 & A1 & B1) (w2 & A2 & B2)]. destruct (HW w1 A1) as (t1 & D1 & E1), (HW w2 A2) as (t2 & D2 & E2).
    split; [exists (w1, t1) | exists (w2, t2)]; tauto.
  Qed.

  (** With one clock, runs in time go on from what has been read to either outcome. *)
  Corollary certified_exactly_in_time : has_one_clock -> exact C = true -> forall s t read_at n, is_run (s, t) ->
    reading (word_of s t) t read_at n -> let v := fun j => word_of s t (read_at j) in
    exists q u, reaches M v n q /\ nth_error (verdicts M) q = Some u /\
      right_verdict (goes_on (s, t) (read_at n)) (meets_up_to None) (meets_up_to (Some (read_at n)) (s, t)) u /\
      (presumed (meets_up_to (Some (read_at n)) (s, t)) u -> undecided (goes_on_in_time v n) meets_in_time).
  Proof.
    intros H1 HE s t read_at n HS HR v. destruct (certified_exactly s t read_at n HS HR HE) as (q & u & A & B & D & E).
    exists q, u. repeat split; auto; apply (one_clock_in_time H1 v n (E H)).
  Qed.

  (** ** There is something to speak of *)

  Lemma untimed_same : forall s t p k, asks_time (news C) xs p = false ->
    at_letter p (word_of s t k) = at_letter p (s k).
  Proof.
    intros s t p k Hp. apply at_letter_same. intros a Ha.
    assert (HA : timed_atom (news C) xs a = false).
    { revert Hp Ha. clear. induction p; simpl; intros H Ha; try discriminate; auto;
        [apply Nat.eqb_eq in Ha; now subst | |];
        apply orb_false_iff in H; apply orb_true_iff in Ha; destruct H, Ha; auto. }
    pose proof is_proper as HP. unfold proper, are_theirs in HP. rewrite !andb_true_iff, !forallb_forall in HP.
    destruct HP as [_ [[[_ H2] H3] _]]. unfold word_of. rewrite timed_word_elsewhere, with_past_elsewhere; auto.
    - intros c o Ho ->. specialize (H2 _ Ho). simpl in H2. unfold xs, trackers in HA. congruence.
    - intros y Hy <-. specialize (H3 _ Hy). unfold xs, trackers in HA. congruence.
  Qed.

  (** A letter is found, and a run that holds it for ever. *)
  Theorem check_runs : exists r, is_run r.
  Proof.
    pose proof HC as HL. unfold check in HL. rewrite !andb_true_iff in HL. destruct HL as [[HL HD] _].
    unfold possible in HL.
    set (l := letter_of _) in HL. unfold well_defined in HD. apply andb_true_iff in HD. destruct HD as [_ HT].
    apply negb_true_iff in HT. fold xs in HT.
    set (held := fun a => negb (existsb (Nat.eqb a) (news C)) && l a).
    exists (fun _ => held, fun k => k). split; simpl.
    - split; auto; [intros i k H; exact H | intros u; exists (S u); lia |].
      intros k _ a. unfold held. destruct (existsb _ _); reflexivity.
    - intros k. rewrite untimed_same by exact HT. rewrite <- HL. apply at_letter_same. intros a Ha. unfold held.
      assert (E : existsb (Nat.eqb a) (news C) = false); [|now rewrite E].
      assert (HA : timed_atom (news C) xs a = false); [|unfold timed_atom in HA; now apply orb_false_iff in HA].
      revert HT Ha. generalize (assumption C). clear. induction p; simpl; intros H Ha; try discriminate; auto;
        [apply Nat.eqb_eq in Ha; now subst | |];
        apply orb_false_iff in H; apply orb_true_iff in Ha; destruct H, Ha; auto.
  Qed.

  (** So no verdict is right by being about nothing. *)
  Theorem certified_of_something : forall s t N so_far, is_run (s, t) ->
    ~ (right_verdict (goes_on (s, t) N) (meets_up_to None) so_far Violated /\
       right_verdict (goes_on (s, t) N) (meets_up_to None) so_far Satisfied).
  Proof. intros s t N so_far H. apply (never_both _ _ _ _ (s, t)). split; auto. intros k _. auto. Qed.
End Certified.

(** A property that is as these theorems ask: 'always (a0 implies eventually a1 within 2)'. *)
Example stops_in_time_is_proper : proper [] (distribute stops_in_time) [] = true.
Proof. reflexivity. Qed.
Example its_trackers : trackers_for [] (distribute stops_in_time) = [the_run; the_clock].
Proof. reflexivity. Qed.

(** * Without time, runs are words *)
Section Untimed.
  Variables (depth work : nat) (C : certificate).
  Hypothesis HC : check depth work C = true.
  Hypothesis episode : encoded_by C = Episode.
  Hypothesis no_bounds : unbounded (subject C) = true.
  Hypothesis no_past : defined C = [].
  Hypothesis no_news : news C = [].
  Let M := machine C.

  Definition allowed_for (s : stream) (n : nat) : Prop := forall k, k < n -> at_letter (assumption C) (s k) = true.
  Definition goes_on_as (s : stream) (n : nat) (s' : stream) : Prop :=
    (forall k, at_letter (assumption C) (s' k) = true) /\ forall k, k < n -> s' k = s k.
  Definition meets_always (s : stream) : Prop := satisfies (subject C) s no_times None 0.
  Definition meets_so_far (s : stream) (n : nat) : Prop := satisfies (subject C) s no_times (Some n) 0.

  Lemma unbounded_distribute : forall p, unbounded p = true -> distribute p = p.
  Proof.
    induction p; simpl; intros H; try discriminate; try (apply andb_true_iff in H; destruct H);
      rewrite ?IHp, ?IHp1, ?IHp2; auto. destruct p; cbn [each_always]; now rewrite H.
  Qed.
  Lemma unbounded_timers : forall p o, unbounded p = true -> timers o p = [].
  Proof.
    induction p; simpl; intros o H; try discriminate; try (apply andb_true_iff in H; destruct H);
      rewrite ?IHp1, ?IHp2; auto. now rewrite unbounded_no_obligation.
  Qed.

  Lemma no_trackers : trackers C = [].
  Proof.
    unfold trackers, trackers_for, judged. rewrite no_past, unbounded_distribute, unbounded_timers by auto. reflexivity.
  Qed.

  (** The machine has one state, and every word. *)
  Lemma any_word : forall s, word (news C) (trackers C) s (fun _ => start (trackers C)).
  Proof.
    intros s. rewrite no_trackers, no_news. split; [reflexivity|]. split; [|change (sets [] []) with 0; intros; lia].
    intros k. eexists. split; [left; reflexivity|]. auto.
  Qed.

  Lemma any_begins : forall s n, allowed_for s n -> begins C s (fun _ => start (trackers C)) n.
  Proof. intros s n H. split; auto. intros k Hk. split; auto. apply (any_word s). Qed.

  Lemma any_continues : forall s n s', continues C s n s' <-> goes_on_as s n s'.
  Proof.
    intros s n s'. split; [intros [(path & _ & H1) H2] | intros [H1 H2]]; split; auto.
    exists (fun _ => start (trackers C)). split; auto using any_word.
  Qed.

  Lemma untimed_means : forall s L, (L = None \/ exists n, L = Some n) ->
    (sat (formula_of C) s L 0 <-> satisfies (subject C) s no_times L 0).
  Proof.
    intros s L HL. unfold formula_of, judged. rewrite episode, unbounded_distribute by auto.
    apply encode_correct; auto using unbounded_right, no_times_timed.
    destruct HL as [-> | (n & ->)]; [apply decided_infinite | apply decided_finite].
  Qed.

  Theorem certified_untimed : forall s n, allowed_for s n -> exists q v,
    reaches M s n q /\ nth_error (verdicts M) q = Some v /\
    right_verdict (goes_on_as s n) meets_always (meets_so_far s n) v.
  Proof.
    intros s n Hs. destruct (check_sound depth work C HC s _ n (any_begins s n Hs)) as (q & v & H1 & H2 & H3).
    exists q, v. split; auto. split; auto. unfold holds_for_ever, meets_always, meets_so_far in *.
    destruct v; simpl in *; rewrite <- ?untimed_means by eauto; auto; intros s' Hs'; rewrite <- untimed_means by auto;
      apply H3; now apply any_continues.
  Qed.

  Theorem certified_exactly_untimed : exact C = true -> forall s n, allowed_for s n -> exists q v,
    reaches M s n q /\ nth_error (verdicts M) q = Some v /\
    exact_verdict (goes_on_as s n) meets_always (meets_so_far s n) v.
  Proof.
    intros HE s n Hs.
    destruct (check_exactly depth work C HC HE s _ n (any_begins s n Hs)) as (q & v & H1 & H2 & H3 & H4).
    destruct (certified_untimed s n Hs) as (q' & v' & C1 & C2 & C3).
    assert (q' = q) by (eapply reaches_unique; eauto). subst q'. fold M in H2. rewrite H2 in C2. injection C2 as <-.
    exists q, v. split; auto. split; auto. split; auto. intros HP.
    destruct H4 as [(s1 & A1 & B1) (s2 & A2 & B2)].
    - unfold meets_so_far in HP. destruct v; simpl in *; rewrite ?untimed_means by eauto; auto.
    - unfold holds_for_ever in *. rewrite untimed_means in B1, B2 by auto.
      split; [exists s1 | exists s2]; (split; [now apply any_continues | auto]).
  Qed.
End Untimed.
