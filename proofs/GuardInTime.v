(** The game of a guard has every move that a run in time can make ([moves_in_time]); and a clock that an act ahead
    starts passes no bound in the nanosecond that comes ([started_clocks_wait]), so one act is enough for one deadline. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers Resets Moves Monitor Certificate Infinite InTime
  GuardedPlaces.

Section Runs.
  Variables (news : list nat) (xs : list tracker_of) (e : stream) (t : times) (began : nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Hypothesis all_well_formed : forall x, In x xs -> well_formed e t began x.
  Hypothesis all_placed : placed [] xs.
  Hypothesis held_letters : forall k, t k < t (S k) ->
    (forall a, In a news -> e (S k) a = false) /\ (forall a, timed_atom news xs a = false -> e (S k) a = e k a).
  Hypothesis not_trivial : is_trivial news xs = false.

  (** Whether time has passed since the instant before. *)
  Definition takes_time (k : nat) : bool := match k with 0 => false | S j => t j <? t k end.

  (** Instants at which time passes are nanoseconds of the game, others are messages. *)
  Theorem moves_in_time : forall k, clocks_step news xs (takes_time k) (path news xs e t began k) (e k)
    (path news xs e t began (S k)) (cases_at xs e t began k).
  Proof.
    intros k. unfold clocks_step. rewrite not_trivial.
    destruct (cases_together news xs e t began Ht dense all_well_formed all_placed held_letters k) as (g & HI & HG). exists g.
    pose proof (passing_takes_time news xs e t began Ht dense all_well_formed k) as HP.
    pose proof (begun_do_not_pass news xs e t began Ht dense all_well_formed held_letters k) as HB.
    pose proof (cases_next news xs e t began Ht dense all_well_formed k) as HN.
    pose proof (settled_held news xs e t began all_well_formed held_letters) as HS.
    assert (HT : takes_time k = false -> none_pass xs (path news xs e t began k) (cases_at xs e t began k) = true).
    { intros H. unfold none_pass. apply negb_true_iff. apply not_true_is_false. intros HE.
      destruct (HP HE) as (j & -> & Hj). unfold takes_time in H. apply Nat.ltb_ge in H. lia. }
    assert (HL : at_letter (settled news xs) (e k) = false -> takes_time k = false).
    { intros H. destruct k as [|j]; auto. simpl. apply Nat.ltb_ge. destruct (le_lt_dec (t (S j)) (t j)) as [|Hj]; auto.
      rewrite (HS j Hj) in H. discriminate. }
    split; auto. split; auto. split; [destruct (takes_time k); auto|].
    destruct (at_letter (settled news xs) (e k)) eqn:ES.
    - left. split; auto. split; [unfold may_hold; now rewrite HB|]. unfold to_held, to. rewrite HN. cbn [path states].
      f_equal. unfold none_begun. apply map_ext. intros x. now rewrite begun_after_eq, ES.
    - right. split; auto. split; auto. unfold to_other, to.
      rewrite HN, (cases_begun news xs e t began). cbn [path states]. f_equal.
      apply map_ext. intros x. now rewrite begun_after_eq, ES.
  Qed.

  (** In the next nanosecond only those pass that the instant has left alone. *)
  Theorem started_clocks_wait : forall k i,
    nth i (those_passing xs (states (path news xs e t began (S k))) (cases_at xs e t began (S k))) false = true ->
    nth i (left_alone xs (cases_at xs e t began k)) false = true.
  Proof.
    intros k i. rewrite path_states. unfold cases_at, left_alone. revert i all_well_formed. clear - Ht dense.
    induction xs as [|x ys IH]; intros i HW H; [destruct i; discriminate|].
    destruct i as [|i]; [|now apply IH; auto; intros y Hy; apply HW; right]. cbn [those_passing map combine nth] in *.
    destruct (the_case_fits e t began Ht dense x k (HW x (or_introl eq_refl))) as (_ & _ & _ & HN & _ & _ & HR).
    destruct (the_case_fits e t began Ht dense x (S k) (HW x (or_introl eq_refl))) as (_ & _ & _ & _ & _ & HP & _).
    unfold passes in H. apply andb_true_iff in H. destruct H as [H1 H2]. cbn [fst snd].
    change (before_instant e t began x (S k)) with (after e t began x k) in *.
    destruct (passed (the_case e t began x (S k))) as [n|]; [|discriminate]. apply Nat.ltb_lt in H2.
    destruct (HP n H1 eq_refl) as (j & E & Hn & _). injection E as <-.
    destruct (starts (the_case e t began x k)) eqn:EA; auto. simpl.
    unfold runs_from in HR. rewrite HN, EA in HR. specialize (HR H1). pose proof (dense k).
    destruct (bounds x) as [|[|d] bs]; auto; [simpl in Hn; lia|]. cbn [count] in Hn.
    destruct (Nat.ltb_spec (base e t began x k + S d) (t (S k))); lia.
  Qed.
End Runs.

(** What leaves a guard in time: if a run in time has these letters, an accepted monitor's verdict on it, which is right for
    the property as the language defines it ([certified]), is another than 'violated'. *)
Theorem guarded_in_time : forall S n C rs h kept depth work first R,
  nth_error (parts S) n = Some (part_for C rs h kept) -> check depth work C = true -> encoded_by C = Episode ->
  is_closed S first R -> forall x m, is_guarded S first R x m -> forall j, j <= m ->
  let ls := has_read S n (part_for C rs h kept) x j in ls <> [] ->
  forall began s t read_at, is_run C began (s, t) -> reading (word_of C began s t) t read_at (length ls) ->
  (forall k a, k < length ls -> at_step ls k a = word_of C began s t (read_at k) a) ->
  exists v, v <> Violated /\
    right_verdict (goes_on C began (s, t) (read_at (length ls))) (meets_up_to C began None)
      (meets_up_to C began (Some (read_at (length ls))) (s, t)) v.
Proof.
  intros S n C rs h kept depth work first R HP HC HE HR x m HG j Hj ls HN began s t read_at HS HD HL.
  destruct (guarded_verdict S first n _ HP eq_refl depth work HC R HR x m HG j Hj HN) as (q & v & Q1 & Q2 & Q3).
  destruct (certified depth work C HC HE began s t read_at (length ls) HS HD) as (q' & v' & C1 & C2 & C3).
  apply (reaches_same _ _ (fun k => word_of C began s t (read_at k))) in Q1; auto.
  rewrite (reaches_unique _ _ _ _ _ Q1 C1) in Q2. exists v. split; auto.
  change (nth_error (verdicts (machine C)) q' = Some v) in Q2. rewrite C2 in Q2. injection Q2 as <-. exact C3.
Qed.
