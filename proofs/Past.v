(** The past: atoms that the run so far decides, what they mean ([value]), and that one remembered step is enough to
    follow each of them ([tracked_correct]).

    News are atoms of the letters; an age counts from them. An operator inside another one is an atom that is
    defined before.
    Python: [ltlc/semantics/timed_atoms.py] and [instants.py] ([holds_at], [with_past]). *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties.

(** No bound, or a number of nanoseconds. *)
Definition bound := option nat.

Inductive past :=
| Previously (p : predicate)
| Once (D : bound) (p : predicate)
| Historically (D : bound) (p : predicate)
| Since (D : bound) (p q : predicate)
| Age (d : nat) (p : predicate).           (* the time since p, or since the session began, is at most d *)

(** * What they mean at instant k, the session having begun at [began] *)
Section Meaning.
  Variables (s : stream) (t : times) (began : nat).

  (** Instant j is one of the last D before k; it is at least D before k, without a bound the first one. *)
  Definition recent (D : bound) (j k : nat) : bool := match D with None => true | Some d => t k <=? t j + d end.
  Definition long_ago (D : bound) (j k : nat) : bool := match D with None => j =? 0 | Some d => t j + d <=? t k end.

  Definition some_instant (k : nat) (f : nat -> bool) : bool := existsb f (seq 0 (S k)).
  Definition every_instant (i k : nat) (f : nat -> bool) : bool := forallb f (seq i (S k - i)).

  Definition value (o : past) (k : nat) : bool :=
    let at_ p j := at_letter p (s j) in
    match o with
    | Previously p => match k with 0 => false | S j => at_ p j end
    | Once D p => some_instant k (fun j => recent D j k && at_ p j)
    | Historically D p => some_instant k (fun j => long_ago D j k && every_instant j k (at_ p))
    | Since D p q => some_instant k (fun j => recent D j k && at_ q j && every_instant (S j) k (at_ p))
    | Age d p => some_instant k (fun j => recent (Some d) j k && at_ p j) ||
                 every_instant 0 k (fun j => negb (at_ p j)) && (t k <=? began + d)
    end.
End Meaning.

Lemma some_instant_true : forall k f, some_instant k f = true <-> exists j, j <= k /\ f j = true.
Proof.
  intros k f. unfold some_instant. rewrite existsb_exists. split; intros (j & A & B); exists j; rewrite in_seq in *;
    split; auto; lia.
Qed.
Lemma every_instant_true : forall i k f, every_instant i k f = true <-> forall j, i <= j <= k -> f j = true.
Proof.
  intros i k f. unfold every_instant. rewrite forallb_forall. split; intros H j Hj; apply H; rewrite in_seq in *; lia.
Qed.

(** * Following them: the one instant to remember *)
Section Trackers.
  Variables p q : nat -> bool.

  (** The latest instant with p; the instant since which p holds; the latest with q since which p holds. *)
  Fixpoint latest (k : nat) : option nat :=
    if p k then Some k else match k with 0 => None | S j => latest j end.
  Fixpoint since_when (k : nat) : option nat :=
    if p k then match k with 0 => Some 0 | S j => match since_when j with Some i => Some i | None => Some k end end
      else None.
  Fixpoint kept_since (k : nat) : option nat :=
    if q k then Some k else if p k then match k with 0 => None | S j => kept_since j end else None.

  Lemma latest_spec : forall k, match latest k with
    | Some j => j <= k /\ p j = true /\ forall m, j < m <= k -> p m = false
    | None => forall m, m <= k -> p m = false
    end.
  Proof.
    intros k. induction k as [|k IH]; cbn [latest].
    - destruct (p 0) eqn:E; [repeat split; auto; intros; lia|]. intros m Hm. now replace m with 0 by lia.
    - destruct (p (S k)) eqn:E; [repeat split; auto; intros; lia|]. destruct (latest k) as [j|].
      + destruct IH as (A & B & C). repeat split; auto. intros m Hm. destruct (Nat.eq_dec m (S k)); subst; auto.
      apply C; lia.
      + intros m Hm. destruct (Nat.eq_dec m (S k)); subst; auto. apply IH; lia.
  Qed.

  Lemma since_when_spec : forall k, match since_when k with
    | Some j => j <= k /\ (forall m, j <= m <= k -> p m = true) /\ (j = 0 \/ p (j - 1) = false)
    | None => p k = false
    end.
  Proof.
    intros k. induction k as [|k IH]; cbn [since_when].
    - destruct (p 0) eqn:E; auto. repeat split; auto. intros m Hm. now replace m with 0 by lia.
    - destruct (p (S k)) eqn:E; auto. destruct (since_when k) as [j|].
      + destruct IH as (A & B & C). repeat split; auto. intros m Hm. destruct (Nat.eq_dec m (S k)); subst; auto.
      apply B; lia.
      + repeat split; auto; [|simpl; now rewrite Nat.sub_0_r; right]. intros m Hm. now replace m with (S k) by lia.
  Qed.

  Lemma kept_since_spec : forall k, match kept_since k with
    | Some j => j <= k /\ q j = true /\ (forall m, j < m <= k -> p m = true) /\ forall m, j < m <= k -> q m = false
    | None => forall j, j <= k -> q j = true -> exists m, j < m <= k /\ p m = false
    end.
  Proof.
    intros k. induction k as [|k IH]; cbn [kept_since].
    - destruct (q 0) eqn:E; [repeat split; auto; intros; lia|].
      destruct (p 0); intros j Hj Hq; replace j with 0 in Hq by lia; congruence.
    - destruct (q (S k)) eqn:E; [repeat split; auto; intros; lia|]. destruct (p (S k)) eqn:Ep.
      + destruct (kept_since k) as [j|].
        * destruct IH as (A & B & C & D).
          repeat split; auto; intros m Hm; (destruct (Nat.eq_dec m (S k)); [subst; auto|]); [apply C | apply D]; lia.
        * intros j Hj Hq. destruct (Nat.eq_dec j (S k)); [congruence|]. destruct (IH j) as (m & M1 & M2); auto; try lia.
          exists m. split; auto; lia.
      + intros j Hj Hq. destruct (Nat.eq_dec j (S k)); [congruence|]. exists (S k). split; auto; lia.
  Qed.
End Trackers.

(** What is remembered answers at any later time. *)
Definition answer (test : nat -> nat -> bool) (r : option nat) (k : nat) : bool :=
  match r with Some j => test j k | None => false end.

Definition tracked (s : stream) (t : times) (began : nat) (o : past) (k : nat) : bool :=
  let at_ p j := at_letter p (s j) in
  match o with
  | Previously p => match k with 0 => false | S j => at_ p j end
  | Once D p => answer (recent t D) (latest (at_ p) k) k
  | Historically D p => answer (long_ago t D) (since_when (at_ p) k) k
  | Since D p q => answer (recent t D) (kept_since (at_ p) (at_ q) k) k
  | Age d p => match latest (at_ p) k with Some j => t k <=? t j + d | None => t k <=? began + d end
  end.

Lemma recent_later : forall t D i j k, passing t -> i <= j -> recent t D i k = true -> recent t D j k = true.
Proof.
  intros t [d|] i j k Ht Hij H; auto. simpl in *. apply Nat.leb_le in H. apply Nat.leb_le. pose proof (Ht i j Hij). lia.
Qed.
Lemma long_ago_earlier : forall t D i j k, passing t -> i <= j -> long_ago t D j k = true -> long_ago t D i k = true.
Proof.
  intros t [d|] i j k Ht Hij H; simpl in *.
  - apply Nat.leb_le in H. apply Nat.leb_le. pose proof (Ht i j Hij). lia.
  - apply Nat.eqb_eq in H. apply Nat.eqb_eq. lia.
Qed.

Lemma once_tracked : forall s t D p k, passing t ->
  answer (recent t D) (latest (fun j => at_letter p (s j)) k) k =
  some_instant k (fun j => recent t D j k && at_letter p (s j)).
Proof.
  intros s t D p k Ht. apply eq_true_iff_eq. rewrite some_instant_true.
  pose proof (latest_spec (fun j => at_letter p (s j)) k) as HL.
  destruct (latest (fun j => at_letter p (s j)) k) as [j|]; simpl; setoid_rewrite andb_true_iff.
  - destruct HL as (A & B & C). split; [intros; exists j; auto|]. intros (m & M1 & M2 & M3).
    destruct (le_lt_dec m j); [eapply recent_later; eauto | rewrite C in M3 by lia; congruence].
  - split; [congruence|]. intros (m & M1 & M2 & M3). rewrite HL in M3 by auto. congruence.
Qed.

(** Each past operator is what its tracker says. *)
Theorem tracked_correct : forall s t began o k, passing t -> tracked s t began o k = value s t began o k.
Proof.
  intros s t began o k Ht. destruct o as [p|D p|D p|D p q|d p]; cbn [tracked value]; auto using once_tracked.
  - apply eq_true_iff_eq. rewrite some_instant_true. setoid_rewrite andb_true_iff. setoid_rewrite every_instant_true.
    pose proof (since_when_spec (fun j => at_letter p (s j)) k) as HL.
    destruct (since_when (fun j => at_letter p (s j)) k) as [j|]; simpl.
    + destruct HL as (A & B & C). split; [intros; exists j; auto|]. intros (m & M1 & M2 & M3).
      destruct (le_lt_dec j m); [eapply long_ago_earlier; eauto|]. destruct C as [->|C]; [lia|].
      rewrite M3 in C by lia. congruence.
    + split; [congruence|]. intros (m & M1 & M2 & M3). rewrite M3 in HL by lia. congruence.
  - apply eq_true_iff_eq. rewrite some_instant_true. setoid_rewrite andb_true_iff. setoid_rewrite every_instant_true.
    setoid_rewrite andb_true_iff. pose proof (kept_since_spec (fun j => at_letter p (s j)) (fun j => at_letter q (s j))
      k) as HL.
    destruct (kept_since (fun j => at_letter p (s j)) (fun j => at_letter q (s j)) k) as [j|]; simpl.
    + destruct HL as (A & B & C & E). split; [intros; exists j; repeat split; auto; intros m M; apply C; lia|].
      intros (m & M1 & (M2 & M3) & M4). destruct (le_lt_dec m j); [eapply recent_later; eauto|].
      rewrite E in M3 by lia. congruence.
    + split; [congruence|]. intros (j & J1 & (J2 & J3) & J4). destruct (HL j J1 J3) as (m & M1 & M2).
      rewrite J4 in M2 by lia. congruence.
  - rewrite <- (once_tracked s t (Some d) p k Ht). apply eq_true_iff_eq.
  rewrite orb_true_iff, andb_true_iff, every_instant_true.
    pose proof (latest_spec (fun j => at_letter p (s j)) k) as HL.
    destruct (latest (fun j => at_letter p (s j)) k) as [j|]; simpl.
    + destruct HL as (A & B & _). split; auto. intros [H|[H _]]; auto. specialize (H j). rewrite B in H.
      simpl in H. assert (false = true) by (apply H; lia). congruence.
    + split; [|intros [H|[_ H]]; [congruence|auto]]. intros H. right. split; auto. intros j Hj. now rewrite HL by lia.
Qed.

(** * A run with its past: each operator has an atom, those inside an operator come before it *)

Definition definitions := list (nat * past).

Fixpoint with_past (began : nat) (defs : definitions) (s : stream) (t : times) : stream :=
  match defs with
  | [] => s
  | (c, o) :: defs => with_past began defs (fun k a => if a =? c then value s t began o k else s k a) t
  end.
Fixpoint with_trackers (began : nat) (defs : definitions) (s : stream) (t : times) : stream :=
  match defs with
  | [] => s
  | (c, o) :: defs => with_trackers began defs (fun k a => if a =? c then tracked s t began o k else s k a) t
  end.

(** Two runs that are the same in their first n instants. *)
Definition same_before (n : nat) (s s' : stream) (t t' : times) : Prop :=
  forall k, k < n -> t k = t' k /\ forall a, s k a = s' k a.

Definition asks (o : past) (a : nat) : bool :=
  match o with
  | Previously p | Once _ p | Historically _ p | Age _ p => mentions p a
  | Since _ p q => mentions p a || mentions q a
  end.

Lemma existsb_same : forall f g (l : list nat), (forall j, In j l -> f j = g j) -> existsb f l = existsb g l.
Proof. induction l as [|j l IH]; simpl; intros H; auto. rewrite (H j), IH; auto. Qed.
Lemma forallb_same : forall f g (l : list nat), (forall j, In j l -> f j = g j) -> forallb f l = forallb g l.
Proof. induction l as [|j l IH]; simpl; intros H; auto. rewrite (H j), IH; auto. Qed.

(** Past operators look at the past alone, and there at the atoms that they ask for. *)
Lemma value_same : forall s s' t t' began o k,
  (forall j, j <= k -> t j = t' j /\ forall a, asks o a = true -> s j a = s' j a) ->
  value s t began o k = value s' t' began o k.
Proof.
  intros s s' t t' began o k H.
  assert (HA : forall x, (forall a, mentions x a = true -> asks o a = true) ->
            forall j, j <= k -> at_letter x (s j) = at_letter x (s' j)) by (intros x Hx j Hj; apply at_letter_same;
              intros; apply H; auto).
  assert (HT : forall j, j <= k -> t j = t' j) by (intros j Hj; now apply H).
  assert (HR : forall D j, j <= k -> recent t D j k = recent t' D j k) by (intros [d|] j Hj; simpl;
    rewrite ?HT by lia; auto).
  assert (HL : forall D j, j <= k -> long_ago t D j k = long_ago t' D j k) by (intros [d|] j Hj; simpl;
    rewrite ?HT by lia; auto).
  assert (HS : forall f g, (forall j, j <= k -> f j = g j) -> some_instant k f = some_instant k g).
  { intros f g E. apply existsb_same. intros j Hj. apply E. apply in_seq in Hj. lia. }
  assert (HE : forall i f g, (forall j, j <= k -> f j = g j) -> every_instant i k f = every_instant i k g).
  { intros i f g E. apply forallb_same. intros j Hj. apply E. apply in_seq in Hj. lia. }
  destruct o as [p|D p|D p|D p q|d p]; cbn [value]; simpl asks in HA.
  - destruct k; auto.
  - apply HS. intros j Hj. now rewrite HR, (HA p).
  - apply HS. intros j Hj. rewrite HL by auto. f_equal. apply HE. auto.
  - assert (Hp : forall j, j <= k -> at_letter p (s j) = at_letter p (s' j)) by (apply HA; intros a ->; auto).
    assert (Hq : forall j, j <= k -> at_letter q (s j) = at_letter q (s' j)) by (apply HA; intros a ->;
      apply orb_true_r).
    apply HS. intros j Hj. rewrite HR, Hq by auto. f_equal. apply HE. auto.
  - rewrite HT by auto. f_equal; [apply HS | f_equal; apply HE]; intros j Hj; now rewrite ?HR, (HA p).
Qed.

Lemma with_past_causal : forall began defs s s' t t' n, same_before n s s' t t' ->
  same_before n (with_past began defs s t) (with_past began defs s' t') t t'.
Proof.
  intros began defs. induction defs as [|[c o] defs IH]; intros s s' t t' n H; simpl; auto.
  apply IH. intros k Hk. split; [now apply H|]. intros a. destruct (a =? c); [|now apply H].
  apply value_same. intros j Hj. destruct (H j) as [A B]; [lia|]. auto.
Qed.

(** An atom that is defined means its definition, in the run with its past. *)
Fixpoint inside_out (defs : definitions) : Prop :=
  match defs with
  | [] => True
  | (c, o) :: defs => asks o c = false /\ (forall c' o', In (c', o') defs ->
    c' <> c /\ asks o c' = false) /\ inside_out defs
  end.

Lemma with_past_elsewhere : forall began defs s t k a, (forall c o, In (c, o) defs -> c <> a) ->
  with_past began defs s t k a = s k a.
Proof.
  intros began defs. induction defs as [|[c o] defs IH]; intros s t k a H; simpl; auto. rewrite IH.
  - destruct (Nat.eqb_spec a c); auto. subst. exfalso. apply (H c o); simpl; auto.
  - intros c' o' Hc. apply (H c' o'). simpl; auto.
Qed.

Theorem past_means : forall began defs s t c o k, inside_out defs -> In (c, o) defs ->
  with_past began defs s t k c = value (with_past began defs s t) t began o k.
Proof.
  intros began defs. induction defs as [|[c' o'] defs IH]; intros s t c o k HO HI; [destruct HI|].
  destruct HO as (H1 & H2 & H3). destruct HI as [E|HI]; [injection E as -> -> | now apply IH].
  simpl. set (s' := fun k a => if a =? c then value s t began o k else s k a).
  rewrite with_past_elsewhere by (intros; now apply (H2 c0 o0)). unfold s' at 1. rewrite Nat.eqb_refl.
  apply value_same. intros j _. split; auto. intros a Ha. rewrite with_past_elsewhere.
  - unfold s'. destruct (Nat.eqb_spec a c); auto. subst. congruence.
  - intros c0 o0 H0 <-. destruct (H2 c0 o0 H0). congruence.
Qed.

(** Followed online, a run has the past that it is defined to have. *)
Theorem with_trackers_correct : forall began defs s t, passing t -> forall k a,
  with_trackers began defs s t k a = with_past began defs s t k a.
Proof.
  intros began defs s t Ht. revert s. induction defs as [|[c o] defs IH]; intros s k a; simpl; auto. rewrite IH.
  apply (with_past_causal began defs _ _ t t (S k)); auto. intros j _. split; auto. intros b.
  destruct (b =? c); auto. now apply tracked_correct.
Qed.
