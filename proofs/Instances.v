(** Evidence of what is judged from each message on: of a run, and of the instances that its messages open.

    An instance is the run in which the atom m holds at one instant only ([marked]); what a certificate says is of
    [After (PAtom m) p]. Its lines are those of the run, without m in all but one of them: [lines_of_instance]. The
    verdict of all together follows from those of the instances: [evidence_of_instances]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Anew Past Encodings Clocks Registers Resets Monitor Certificate Infinite InTime Counting
  Evidence.

Section Instances.
  Variables (C : certificate) (began : nat) (cs : list (nat * count)) (m : nat) (p : property).
  Hypothesis subject_is : subject C = After (PAtom m) p.
  Hypothesis unread_m : reads p m = false.

  (** Nothing but the subject asks for m. *)
  Hypothesis past_without : forall c o, In (c, o) (defined C) -> c <> m /\ asks o m = false.
  Hypothesis counts_without : forall c o, In (c, o) cs -> c <> m /\ mentions (occurring o) m = false.

  Definition run : Type := stream * times.
  (** The run in its session, with its counts; the letters of that, with the past. *)
  Definition with_all (s : stream) (t : times) : run := (with_counts cs s t, t).
  Definition letters_with_past (s : stream) (t : times) : stream := with_past began (defined C) (with_counts cs s t) t.
  Definition instance (k : nat) (r : run) : run := with_all (marked m k (fst r)) (snd r).

  (** What is said of the run as a whole. *)
  Definition each_anew : property := Always (Implies (Now (PAtom m)) p).
  Definition whole_meets (L : option nat) (r : run) : Prop :=
    satisfies each_anew (letters_with_past (fst r) (snd r)) (snd r) L 0.
  Definition whole_goes_on (r : run) (N : nat) (r' : run) : Prop :=
    (forall k, is_run C began (instance k r')) /\ same_before N (fst r) (fst r') (snd r) (snd r').

  (** Counts and the past do not see m. *)
  Definition alike (s s' : stream) (f : nat -> bool) : Prop := same_but m s s' /\ forall i, s' i m = f i.

  Lemma count_alike : forall o s s' t k, same_but m s s' -> mentions (occurring o) m = false ->
    count_value o s t k = count_value o s' t k.
  Proof.
    intros o s s' t k H Ho. unfold count_value. f_equal. unfold Counts.reached, Counts.counted. do 2 f_equal.
    apply filter_ext. intros j. f_equal. unfold occurs_at. rewrite (same_letter m s s') by auto. do 3 f_equal.
    destruct j; auto. now apply (same_letter m).
  Qed.

  Lemma counts_alike : forall zs s s' t f, (forall c o, In (c, o) zs -> c <> m /\ mentions (occurring o) m = false) ->
    alike s s' f -> alike (with_counts zs s t) (with_counts zs s' t) f.
  Proof.
    induction zs as [|[c o] zs IH]; intros s s' t f HZ [H1 H2]; simpl; [split; auto|].
    destruct (HZ c o ltac:(now left)) as [Hc Ho]. apply IH; [intros c' o' Hin; apply (HZ c' o'); now right|]. split.
    - intros i a Ha. destruct (a =? c); [now apply count_alike | now apply H1].
    - intros i. apply Nat.eqb_neq in Hc. rewrite Nat.eqb_sym, Hc. apply H2.
  Qed.

  Lemma past_alike : forall defs s s' t f, (forall c o, In (c, o) defs -> c <> m /\ asks o m = false) ->
    alike s s' f -> alike (with_past began defs s t) (with_past began defs s' t) f.
  Proof.
    induction defs as [|[c o] defs IH]; intros s s' t f HZ [H1 H2]; simpl; [split; auto|].
    destruct (HZ c o ltac:(now left)) as [Hc Ho]. apply IH; [intros c' o' Hin; apply (HZ c' o'); now right|]. split.
    - intros i a Ha. destruct (a =? c); [|now apply H1]. apply value_same. intros j _. split; auto.
      intros b Hb. apply H1. intros ->. congruence.
    - intros i. apply Nat.eqb_neq in Hc. rewrite Nat.eqb_sym, Hc. apply H2.
  Qed.

  Lemma counts_causal : forall zs s s' t t' n, same_before n s s' t t' ->
    same_before n (with_counts zs s t) (with_counts zs s' t') t t'.
  Proof.
    induction zs as [|[c o] zs IH]; intros s s' t t' n H; simpl; auto. apply IH. intros j Hj. split; [now apply H|].
    intros a. destruct (a =? c); [|now apply H]. unfold count_value. destruct (H 0 ltac:(lia)) as [H0 _].
    destruct (H j Hj) as [Hj' _]. rewrite H0, Hj'. f_equal. unfold Counts.reached, Counts.counted. do 2 f_equal.
    apply filter_ext_in. intros i Hi. apply in_seq in Hi.
    assert (HO : forall i, i <= j -> at_letter (occurring o) (s i) = at_letter (occurring o) (s' i)).
    { intros i' Hi'. apply at_letter_same. intros b _. apply H. lia. }
    f_equal.
    - unfold occurs_at. rewrite HO by lia. do 3 f_equal. destruct i; auto. apply HO. lia.
    - unfold recent. destruct (bounded o); auto. destruct (H i ltac:(lia)) as [-> _]. now rewrite Hj'.
  Qed.

  Lemma instance_letters : forall k s t,
    alike (letters_with_past s t) (letters_with_past (marked m k s) t) (fun i => i =? k).
  Proof.
    intros k s t. apply past_alike; [exact past_without|]. apply counts_alike; [exact counts_without|]. split.
    - apply marked_same.
    - intros i. unfold marked. now rewrite Nat.eqb_refl.
  Qed.
  Lemma whole_letters : forall s t i, letters_with_past s t i m = s i m.
  Proof.
    intros s t i. assert (H : alike (letters_with_past s t) (letters_with_past s t) (fun i => s i m)).
    { apply past_alike; [exact past_without|]. apply counts_alike; [exact counts_without|].
      split; [intros j a _|]; auto. }
    apply H.
  Qed.

  Lemma instance_means : forall k r L, meets_up_to C began L (instance k r) <->
    satisfies (After (PAtom m) p) (marked m k (letters_with_past (fst r) (snd r))) (snd r) L 0.
  Proof.
    intros k [s t] L. unfold meets_up_to, instance, with_all. cbn [fst snd]. rewrite subject_is.
    fold (letters_with_past (marked m k s) t). apply satisfies_asked. intros i a _.
    destruct (instance_letters k s t) as [H1 H2]. unfold marked at 2. destruct (Nat.eqb_spec a m) as [->|Ha].
    - apply H2.
    - symmetry. now apply H1.
  Qed.

  (** The run as a whole is what its instances are. *)
  Theorem whole_means : forall r L, whole_meets L r <->
    forall k, inside L k -> fst r k m = true -> meets_up_to C began L (instance k r).
  Proof.
    intros [s t] L. unfold whole_meets, each_anew. cbn [fst snd].
    rewrite <- (each_step m (PAtom m) p (letters_with_past s t) t L 0 unread_m). split; intros H k.
    - intros Hk Hm. apply instance_means. cbn [fst snd]. apply H; [lia | exact Hk |]. simpl. now rewrite whole_letters.
    - intros _ Hk Hm. simpl in Hm. rewrite whole_letters in Hm. now apply (instance_means k (s, t)), H.
  Qed.

  (** If one instance is violated for good, so is the whole; if one is not satisfied so far, nor is the whole; and if
      all are, it is. *)
  Theorem evidence_of_instances : forall r N,
    (forall k v, k < N -> fst r k m = true ->
       right_verdict (goes_on C began (instance k r) N) (meets_up_to C began None)
         (meets_up_to C began (Some N) (instance k r)) v ->
       (v = Violated -> right_verdict (whole_goes_on r N) (whole_meets None) (whole_meets (Some N) r) Violated) /\
       (v = PresumablyViolated ->
          right_verdict (whole_goes_on r N) (whole_meets None) (whole_meets (Some N) r) PresumablyViolated)) /\
    ((forall k, k < N -> fst r k m = true -> meets_up_to C began (Some N) (instance k r)) ->
       right_verdict (whole_goes_on r N) (whole_meets None) (whole_meets (Some N) r) PresumablySatisfied).
  Proof.
    intros [s t] N. split.
    - intros k v Hk Hm Hv. split; intros ->.
      + intros [s' t'] [HR HB] HW. simpl in Hv. apply (Hv (instance k (s', t'))).
        * split; [apply HR|]. unfold instance, with_all. cbn [fst snd] in *. apply counts_causal.
          intros j Hj. destruct (HB j Hj) as [HB1 HB2]. split; auto. intros a. unfold marked.
          destruct (a =? m); auto.
        * apply whole_means; [exact HW | exact I |]. cbn [fst snd] in *. rewrite <- Hm. symmetry. now apply (HB k Hk).
      + simpl in Hv |- *. intros HW. apply Hv. apply whole_means; [exact HW | exact Hk | exact Hm].
    - intros H. simpl. apply whole_means. intros k Hk. apply H. exact Hk.
  Qed.

  (** * Its lines *)
  Definition without (l : letter) : letter := fun a => negb (a =? m) && l a.
  Definition all_without : list (letter * nat) -> list (letter * nat) := map (fun x => (without (fst x), snd x)).
  (** The lines of the instance that the j-th line opens. *)
  Fixpoint only (j : nat) (ls : list (letter * nat)) : list (letter * nat) :=
    match ls with
    | [] => []
    | (l, u) :: ls => match j with 0 => (l, u) :: all_without ls | S j => (without l, u) :: only j ls end
    end.

  Lemma next_time_same : forall ls ls' T, map snd ls = map snd ls' -> next_time ls T = next_time ls' T.
  Proof. intros [|[l u] ls] [|[l' u'] ls'] T H; simpl in *; congruence. Qed.
  Lemma only_times : forall ls j, map snd (only j ls) = map snd ls.
  Proof.
    induction ls as [|[l u] ls IH]; intros [|j]; simpl; auto; f_equal; auto. unfold all_without. rewrite map_map. auto.
  Qed.
  Lemma without_times : forall ls, map snd (all_without ls) = map snd ls.
  Proof. intros ls. unfold all_without. rewrite map_map. auto. Qed.

  Lemma marked_off : forall k s i, i <> k -> forall a, marked m k s i a = without (s i) a.
  Proof. intros k s i Hi a. unfold marked, without. destruct (a =? m); auto. now apply Nat.eqb_neq. Qed.

  Section Lines.
    Variables (ns : list nat) (s : stream) (t : times) (T N : nat).
    Hypothesis is_news : In m ns.

    Lemma quiet_m : forall l, quiet ns l m = false.
    Proof.
      intros l. unfold quiet. replace (existsb (Nat.eqb m) ns) with true; auto. symmetry. apply existsb_exists.
      exists m. split; auto. apply Nat.eqb_refl.
    Qed.
    Lemma quiet_without : forall l a, quiet ns (without l) a = quiet ns l a.
    Proof.
      intros l a. destruct (Nat.eq_dec a m) as [->|Ha]; [now rewrite !quiet_m|]. unfold quiet, without.
      apply Nat.eqb_neq in Ha. now rewrite Ha.
    Qed.
    Lemma marked_quiet : forall k i l, (forall a, s i a = quiet ns l a) -> i <> k ->
      forall a, marked m k s i a = quiet ns l a.
    Proof.
      intros k i l H Hi a. rewrite marked_off by auto. unfold without. rewrite H.
      destruct (Nat.eqb_spec a m) as [->|]; auto. now rewrite quiet_m.
    Qed.

    Lemma lines_after : forall ls i k, k < i -> of_lines ns s t i ls T N ->
      of_lines ns (marked m k s) t i (all_without ls) T N.
    Proof.
      induction ls as [|[l u] ls IH]; intros i k Hk H; cbn [of_lines all_without map fst snd] in *; auto.
      destruct H as (n & H1 & H2 & H3 & H4 & H5 & H6 & H7). exists n. repeat split; auto.
      - intros a. rewrite marked_off by lia. unfold without. now rewrite H3.
      - intros j Hj a. rewrite quiet_without. apply marked_quiet; [now apply H4 | lia].
      - rewrite H6. apply next_time_same. symmetry. apply without_times.
      - apply IH; [lia | exact H7].
    Qed.

    (** What a run with these lines has at an instant with m are the lines of the instance that it opens. *)
    Theorem lines_of_instance : forall ls i k, of_lines ns s t i ls T N -> i <= k < N -> s k m = true ->
      exists j, of_lines ns (marked m k s) t i (only j ls) T N.
    Proof.
      induction ls as [|[l u] ls IH]; intros i k H Hk Hm; cbn [of_lines] in H; [lia|].
      destruct H as (n & H1 & H2 & H3 & H4 & H5 & H6 & H7). destruct (Nat.eq_dec k i) as [->|Hne].
      - exists 0. cbn [only of_lines]. exists n. repeat split; auto.
        + intros a. unfold marked. destruct (Nat.eqb_spec a m) as [->|]; auto. rewrite <- H3, Hm. apply Nat.eqb_refl.
        + intros j Hj. apply marked_quiet; [now apply H4 | lia].
        + rewrite H6. apply next_time_same. symmetry. apply without_times.
        + apply lines_after; [lia | exact H7].
      - assert (Hn : n <= k).
        { destruct (le_lt_dec n k); auto. rewrite (H4 k) in Hm by lia. now rewrite quiet_m in Hm. }
        destruct (IH n k H7 ltac:(lia) Hm) as [j Hj]. exists (S j). cbn [only of_lines]. exists n. repeat split; auto.
        + intros a. rewrite marked_off by lia. unfold without. now rewrite H3.
        + intros i' Hi a. rewrite quiet_without. apply marked_quiet; [now apply H4 | lia].
        + rewrite H6. apply next_time_same. symmetry. apply only_times.
    Qed.
  End Lines.
End Instances.

(** Whether all this is so: what the judge asks before it judges instances. *)
Definition opened_by (C : certificate) (cs : list (nat * count)) (m : nat) : bool :=
  match subject C with
  | After (PAtom a) p => (a =? m) && negb (reads p m) && existsb (Nat.eqb m) (news C) &&
      forallb (fun d => negb (fst d =? m) && negb (asks (snd d) m)) (defined C) &&
      forallb (fun d => negb (fst d =? m) && negb (mentions (occurring (snd d)) m)) cs
  | _ => false
  end.

Lemma opened_by_is : forall C cs m, opened_by C cs m = true -> exists p,
  subject C = After (PAtom m) p /\ reads p m = false /\ In m (news C) /\
  (forall c o, In (c, o) (defined C) -> c <> m /\ asks o m = false) /\
  (forall c o, In (c, o) cs -> c <> m /\ mentions (occurring o) m = false).
Proof.
  intros C cs m H. unfold opened_by in H. destruct (subject C) as [| | | | | | | | |[|a| | |] p| | |]; try discriminate.
  rewrite !andb_true_iff, !forallb_forall in H. destruct H as [[[[H1 H2] H3] H4] H5]. apply Nat.eqb_eq in H1. subst a.
  assert (HF : forall (A : Type) (f : A -> nat -> bool) (c : nat) (o : A),
    negb (c =? m) && negb (f o m) = true -> c <> m /\ f o m = false).
  { intros A f c o HE. apply andb_true_iff in HE. destruct HE as [HA HB]. rewrite negb_true_iff in *.
    split; auto. now apply Nat.eqb_neq. }
  exists p. repeat split; auto; try (now apply negb_true_iff).
  - apply existsb_exists in H3. destruct H3 as (b & HB & E). apply Nat.eqb_eq in E. now subst b.
  - now apply (HF past asks c o), (H4 (c, o)).
  - now apply (HF past asks c o), (H4 (c, o)).
  - now apply (HF count (fun o => mentions (occurring o)) c o), (H5 (c, o)).
  - now apply (HF count (fun o => mentions (occurring o)) c o), (H5 (c, o)).
Qed.
