(** Counts: `once p N times within D`, and the ring of the last N times of occurrence by which monitors follow it.

    What occurs at an instant is any predicate of instants: that p holds, or that it does and did not before.
    Python: [Occurred] in [ltlc/semantics/timed_atoms.py], [holds_at] in [instants.py], [Counter] in [timed_run.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past.

Section Counts.
  Variables (occurs : nat -> bool) (t : times) (N : nat) (D : bound).

  (** The definition: at N instants or more of the last D, up to k. *)
  Definition counted (k : nat) : nat := length (filter (fun j => occurs j && recent t D j k) (seq 0 (S k))).
  Definition reached (k : nat) : bool := N <=? counted k.

  (** The ring: a time comes behind the others, and if there were N the first one goes. *)
  Definition push (ring : list nat) (time : nat) : list nat :=
    if N <=? length ring then tl (ring ++ [time]) else ring ++ [time].
  Definition next (ring : list nat) (k : nat) : list nat := if occurs k then push ring (t k) else ring.
  Fixpoint ring (k : nat) : list nat := next (match k with 0 => [] | S j => ring j end) k.

  (** It is full, and its first time is one of the last D. *)
  Definition is_reached (ring : list nat) (time : nat) : bool :=
    (length ring =? N) && match D, ring with
                          | None, _ => true
                          | Some d, first :: _ => time <=? first + d
                          | Some _, [] => false
                          end.

  (** The times of all occurrences up to k. *)
  Definition occurred (k : nat) : list nat := map t (filter occurs (seq 0 (S k))).
  Definition last_ones (l : list nat) : list nat := skipn (length l - N) l.

  Lemma push_last : 0 < N -> forall l e, push (last_ones l) e = last_ones (l ++ [e]).
  Proof.
    intros HN l e. unfold push, last_ones. rewrite app_length, skipn_length. simpl.
    destruct (Nat.leb_spec N (length l - (length l - N))) as [H|H].
    - assert (HS : length l + 1 - N = S (length l - N)) by lia. rewrite HS.
      assert (HL : length l - N <= length l) by lia. revert HL H. generalize (length l - N). clear HS.
      induction l as [|a l IH]; intros m HL H; simpl in *.
      + lia.
      + destruct m as [|m]; simpl; auto. apply IH; lia.
    - replace (length l + 1 - N) with 0 by lia. replace (length l - N) with 0 by lia. reflexivity.
  Qed.

  Lemma occurred_next : forall k, occurred (S k) = occurred k ++ (if occurs (S k) then [t (S k)] else []).
  Proof.
    intros k. unfold occurred. rewrite seq_S, filter_app, map_app. simpl. destruct (occurs (S k)); reflexivity.
  Qed.

  Theorem ring_last : 0 < N -> forall k, ring k = last_ones (occurred k).
  Proof.
    intros HN. induction k as [|k IH]; simpl ring; unfold next.
    - unfold occurred. simpl. destruct (occurs 0); simpl; auto.
      change [] with (last_ones []) at 1. rewrite push_last by auto. reflexivity.
    - rewrite IH, occurred_next. destruct (occurs (S k)); simpl.
      + apply push_last. auto.
      + rewrite app_nil_r. reflexivity.
  Qed.

  (** Of a list that ascends, with what holds from some place on: it holds of N or more if of the N-th last. *)
  Fixpoint ascends (l : list nat) : Prop :=
    match l with [] => True | a :: l' => (forall b, In b l' -> a <= b) /\ ascends l' end.

  Lemma filter_all : forall (P : nat -> bool) l, (forall b, In b l -> P b = true) -> filter P l = l.
  Proof.
    intros P l. induction l as [|a l IH]; simpl; intros H; auto. rewrite H by auto. f_equal. auto.
  Qed.

  Lemma many_hold : forall (P : nat -> bool) l, 0 < N -> ascends l -> (forall a b, a <= b -> P a = true -> P b = true) ->
    (N <= length (filter P l) <-> N <= length l /\ exists a r, last_ones l = a :: r /\ P a = true).
  Proof.
    intros P l HN. unfold last_ones. induction l as [|a l IH]; intros HA HP.
    - simpl. split; [lia|]. intros [H _]. lia.
    - destruct HA as [HA HA']. destruct (P a) eqn:Ha.
      + rewrite filter_all.
        2: { intros b [<-|Hb]; auto. apply (HP a b); auto. }
        split; [|intros [H _]; exact H]. intros H. split; auto.
        destruct (skipn (length (a :: l) - N) (a :: l)) as [|b r] eqn:E.
        * apply (f_equal (@length nat)) in E. rewrite skipn_length in E. cbn [length] in *. lia.
        * exists b, r. split; auto. assert (Hb : In b (a :: l)).
          { rewrite <- (firstn_skipn (length (a :: l) - N) (a :: l)), E. apply in_or_app. right. left. auto. }
          destruct Hb as [<-|Hb]; auto. apply (HP a b); auto.
      + simpl filter. rewrite Ha. rewrite (IH HA' HP). cbn [length].
        destruct (le_lt_dec N (length l)) as [H|H].
        * replace (S (length l) - N) with (S (length l - N)) by lia. cbn [skipn].
          split; intros [_ H2]; (split; [lia|exact H2]).
        * split; [intros [H1 _]; lia|]. intros [H1 (b & r & E & Hb)].
          replace (S (length l) - N) with 0 in E by lia. simpl in E. injection E as E1 E2. subst. congruence.
  Qed.

  Hypothesis in_order : forall j k, j <= k -> t j <= t k.

  Lemma ascending : forall n i, ascends (map t (filter occurs (seq i n))).
  Proof.
    induction n as [|n IH]; intros i; simpl; auto. destruct (occurs i); simpl; auto. split; auto.
    intros b Hb. apply in_map_iff in Hb. destruct Hb as (j & <- & Hj). apply filter_In in Hj. destruct Hj as [Hj _].
    apply in_seq in Hj. apply in_order. lia.
  Qed.

  Lemma counted_times : forall k,
    counted k = length (filter (fun e => match D with None => true | Some d => t k <=? e + d end) (occurred k)).
  Proof.
    intros k. unfold counted, occurred. generalize (seq 0 (S k)) as l. induction l as [|j l IH]; simpl; auto.
    destruct (occurs j); simpl; auto. unfold recent at 1. destruct D as [d|]; simpl.
    - destruct (t k <=? t j + d); simpl; auto.
    - auto.
  Qed.

  (** The ring tells what the definition says. *)
  Theorem ring_correct : 0 < N -> forall k, is_reached (ring k) (t k) = reached k.
  Proof.
    intros HN k. apply eq_true_iff_eq. unfold reached. rewrite Nat.leb_le, counted_times.
    rewrite many_hold; auto using (ascending (S k) 0).
    2: { intros a b Hab. destruct D as [d|]; auto. rewrite !Nat.leb_le. lia. }
    unfold is_reached. rewrite ring_last by auto. rewrite andb_true_iff, Nat.eqb_eq.
    assert (HL : length (last_ones (occurred k)) = N <-> N <= length (occurred k)).
    { unfold last_ones. rewrite skipn_length. lia. }
    rewrite HL. split; intros [H1 H2]; (split; [exact H1|]).
    - apply HL in H1. destruct (last_ones (occurred k)) as [|a r]; simpl in H1; [lia|].
      exists a, r. split; [reflexivity|exact H2].
    - destruct H2 as (a & r & E & Ha). rewrite E. exact Ha.
  Qed.

  Lemma first_of_ring : 0 < N -> forall k e r, ring k = e :: r -> t 0 <= e.
  Proof.
    intros HN k e r E. rewrite ring_last in E by auto. assert (He : In e (occurred k)).
    { rewrite <- (firstn_skipn (length (occurred k) - N) (occurred k)). fold (last_ones (occurred k)). rewrite E.
      apply in_or_app. right. left. auto. }
    unfold occurred in He. apply in_map_iff in He. destruct He as (j & <- & _). apply in_order. lia.
  Qed.

  (** What is presumed for the first d counts from the beginning until the ring is full, and from then on as any. *)
  Theorem presumed_correct : forall d, D = Some d -> 0 < N -> forall k,
    (if length (ring k) =? N then is_reached (ring k) (t k) else t k <=? t 0 + d) = reached k || (t k <=? t 0 + d).
  Proof.
    intros d HD HN k. rewrite <- (ring_correct HN k). unfold is_reached. rewrite HD.
    destruct (Nat.eqb_spec (length (ring k)) N) as [H|H]; simpl; auto.
    destruct (ring k) as [|e r] eqn:E; simpl in H; [lia|]. pose proof (first_of_ring HN k e r E).
    destruct (Nat.leb_spec (t k) (e + d)); simpl; auto. symmetry. apply Nat.leb_gt. lia.
  Qed.

  (** Where nothing occurs the ring stays, so a count is over the moment its first time is, and not before. *)
  Theorem over_when_the_first_is : forall j k, j <= k -> (forall i, j < i <= k -> occurs i = false) -> ring k = ring j.
  Proof.
    intros j k H. induction H as [|k H IH]; intros Ho; auto.
    simpl ring. unfold next. rewrite Ho by lia. apply IH. intros i Hi. apply Ho. lia.
  Qed.
End Counts.
