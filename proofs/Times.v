(** One clock: the words of its machine are runs in time.

    [times_exist]: whenever a clock counts from steps that have been, and its bounds pass in order and one day all
    do unless it starts anew, there are times with which it does so. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers.

Section Times.
  (** From which step the clock counts at each step, and how many bounds have passed there. *)
  Variables (from : nat -> option nat) (passed_at : nat -> nat) (bs : list nat).
  Hypothesis in_order : rising bs.
  Hypothesis has_been : forall k j, from k = Some j -> j <= k.
  Hypothesis counts_on : forall k j, from (S k) = Some j -> j <= k -> from k = Some j \/ j = k.
  Hypothesis begins_at_none : forall k, from k = Some k -> passed_at k = 0.
  Hypothesis none_comes_back : forall k j, from k = Some j -> from (S k) = Some j -> passed_at k <= passed_at (S k).
  Hypothesis no_more : forall k, passed_at k <= length bs.
  (** Time may pass at a step: the clock does not wait for a bound. *)
  Definition free (k : nat) : Prop := from k = None \/ from k = Some k \/ passed_at k = length bs.
  Hypothesis free_again : forall n, exists k, n <= k /\ free k.

  (** The first moment at which m bounds have passed, since u. *)
  Definition moment (u m : nat) : nat := match m with 0 => 0 | S m => u + nth m bs 0 + 1 end.
  Definition next_time (t : nat -> nat) (k : nat) : nat :=
    match from (S k) with
    | Some j => if j <=? k then
                  Nat.max (t k + (if passed_at (S k) =? length bs then 1 else 0)) (moment (t j) (passed_at (S k)))
                else S (t k)
    | None => S (t k)
    end.
  (** The times up to k. *)
  Fixpoint times_to (k : nat) : nat -> nat :=
    match k with 0 => fun _ => 0 | S k => fun i => if i <=? k then times_to k i else next_time (times_to k) k end.
  Definition some_times : times := fun k => times_to k k.

  Lemma times_to_same : forall k i, i <= k -> times_to k i = some_times i.
  Proof.
    induction k as [|k IH]; intros i Hi; [now replace i with 0 by lia|]. destruct (Nat.eq_dec i (S k)) as [->|]; auto.
    simpl. destruct (Nat.leb_spec i k); [apply IH; auto | lia].
  Qed.

  Lemma next_time_same : forall t t' k, (forall i, i <= k -> t i = t' i) -> next_time t k = next_time t' k.
  Proof.
    intros t t' k H. unfold next_time. rewrite (H k) by auto. destruct (from (S k)) as [j|]; auto.
    destruct (Nat.leb_spec j k); auto.
  Qed.

  Lemma time_step : forall k, some_times (S k) = next_time some_times k.
  Proof.
    intros k. change (some_times (S k)) with (if S k <=? k then times_to k (S k) else next_time (times_to k) k).
    destruct (Nat.leb_spec (S k) k); [lia|].
    apply next_time_same. intros i. apply times_to_same.
  Qed.

  Lemma times_pass_on : forall k, some_times k <= some_times (S k).
  Proof.
    intros k. rewrite time_step. unfold next_time. destruct (from (S k)) as [j|]; [|lia]. destruct (j <=? k); lia.
  Qed.

  Lemma passing_times : passing some_times.
  Proof. intros i k H. induction H; auto. pose proof (times_pass_on m). lia. Qed.

  (** How many bounds have passed at the moment at which the m-th does, or later, if that is before the next. *)
  Lemma count_between : forall m u v, m <= length bs -> moment u m <= v -> (m < length bs -> v <= u + nth m bs 0) ->
    count bs u v = m.
  Proof.
    intros m u v Hm H1 H2. pose proof (count_most bs u v) as HC.
    assert (HN : forall i, i < length bs -> (u + nth i bs 0 < v <-> i < count bs u v)).
    { intros i Hi. rewrite <- Nat.ltb_lt, (count_nth bs u v i in_order Hi). apply Nat.ltb_lt. }
    destruct (lt_eq_lt_dec (count bs u v) m) as [[H|H]|H]; auto; exfalso.
    - destruct m as [|m]; [lia|]. simpl in H1. specialize (HN m). assert (m < count bs u v) by (apply HN; lia). lia.
    - specialize (H2 ltac:(lia)). specialize (HN m ltac:(lia)). lia.
  Qed.

  Theorem bounds_pass : forall k j, from k = Some j -> count bs (some_times j) (some_times k) = passed_at k.
  Proof.
    induction k as [|k IH]; intros j HF.
    - pose proof (has_been 0 j HF). assert (j = 0) by lia. subst j. now rewrite count_now, (begins_at_none 0 HF).
    - pose proof (has_been (S k) j HF) as Hj. destruct (Nat.eq_dec j (S k)) as [->|Hne].
      { now rewrite count_now, (begins_at_none (S k) HF). }
      assert (HL : count bs (some_times j) (some_times k) <= passed_at (S k)).
      { destruct (counts_on k j HF) as [HP| ->]; [lia| |rewrite count_now; lia]. rewrite (IH j HP).
      now apply (none_comes_back k j). }
      set (u := some_times j) in *. pose proof (no_more (S k)) as HM. rewrite time_step. unfold next_time. rewrite HF.
      destruct (Nat.leb_spec j k); [|lia]. fold u. apply count_between; auto; [lia|]. intros Hlt.
      destruct (Nat.eqb_spec (passed_at (S k)) (length bs)); [lia|]. rewrite Nat.add_0_r. apply Nat.max_lub.
      + destruct (le_lt_dec (some_times k) (u + nth (passed_at (S k)) bs 0)) as [|HX]; auto. exfalso.
        pose proof (count_nth bs u (some_times k) (passed_at (S k)) in_order Hlt) as HC.
        rewrite (proj2 (Nat.ltb_lt _ _) HX) in HC. symmetry in HC. apply Nat.ltb_lt in HC. lia.
      + unfold moment. destruct (passed_at (S k)) as [|m]; [lia|]. clear - in_order Hlt.
        assert (HA : forall l i, rising l -> S i < length l -> nth i l 0 < nth (S i) l 0).
        { induction l as [|b l IH]; intros i HR Hi; simpl in Hi; [lia|]. simpl in HR. destruct i as [|i].
          - destruct l as [|c l]; simpl in *; [lia | apply HR].
          - change (nth i l 0 < nth (S i) l 0). apply IH; [eapply ascending_rising; eauto | lia]. }
        specialize (HA bs m in_order Hlt). lia.
  Qed.

  Lemma diverging_times : diverges some_times.
  Proof.
    assert (H : forall u, exists k, u <= some_times k).
    { induction u as [|u (k & IH)]; [exists 0; lia|]. destruct (free_again (S k)) as ([|m] & Hm & HF); [lia|].
      exists (S m). rewrite time_step. assert (some_times k <= some_times m) by (apply passing_times; lia).
      unfold next_time.
      destruct HF as [-> | [-> | HF]]; [lia | destruct (Nat.leb_spec (S m) m); lia |].
      destruct (from (S m)) as [j|]; [|lia]. destruct (j <=? m); [|lia]. rewrite HF, Nat.eqb_refl. lia. }
    intros u. destruct (H (S u)) as (k & Hk). exists k. lia.
  Qed.

  Theorem times_exist : exists t, passing t /\ diverges t /\
    forall k, match from k with
              | Some j => forall i, i < length bs -> (t j + nth i bs 0 <? t k) = (i <? passed_at k)
              | None => True
              end.
  Proof.
    exists some_times. split; [apply passing_times|]. split; [apply diverging_times|]. intros k.
    destruct (from k) as [j|] eqn:E; auto. intros i Hi. rewrite (count_nth bs _ _ i in_order Hi).
    now rewrite (bounds_pass k j E).
  Qed.
End Times.
