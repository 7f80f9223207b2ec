(** The property language over atoms, and what it means: a property is judged on a word, a run or a segment of one.

    A run is a stream of letters and one of times: its instants. Bounds read the times, everything else the letters.
    Python: [ltlc/semantics/properties.py] (the syntax) and [denotation.py] ([satisfies]). *)
From Coq Require Import List Arith Lia Bool.
Require Import Ltl.

(** State predicates and events are formulas without [Next] and [Until]; here they are a type of their own. *)
Inductive predicate :=
| PTruth | PAtom (a : nat) | PNot (p : predicate) | PAnd (p q : predicate) | POr (p q : predicate).

(** Whether a step with this letter satisfies a predicate. *)
Fixpoint at_letter (p : predicate) (l : letter) : bool :=
  match p with
  | PTruth => true
  | PAtom a => l a
  | PNot p => negb (at_letter p l)
  | PAnd p q => at_letter p l && at_letter q l
  | POr p q => at_letter p l || at_letter q l
  end.

(** Whether a predicate asks for an atom; it says the same of letters that agree on what it asks. *)
Fixpoint mentions (p : predicate) (a : nat) : bool :=
  match p with
  | PTruth => false
  | PAtom b => a =? b
  | PNot p => mentions p a
  | PAnd p q | POr p q => mentions p a || mentions q a
  end.
Lemma at_letter_same : forall p (l l' : letter), (forall a, mentions p a = true -> l a = l' a) -> at_letter p l = at_letter p l'.
Proof.
  induction p; simpl; intros l l' H; auto.
  - apply H, Nat.eqb_refl.
  - now rewrite (IHp l l').
  - rewrite (IHp1 l l'), (IHp2 l l'); auto; intros b Hb; apply H; rewrite Hb; auto using orb_true_r.
  - rewrite (IHp1 l l'), (IHp2 l l'); auto; intros b Hb; apply H; rewrite Hb; auto using orb_true_r.
Qed.

Fixpoint as_formula (p : predicate) : formula :=
  match p with
  | PTruth => Truth
  | PAtom a => Atom a
  | PNot p => Ltl.Not (as_formula p)
  | PAnd p q => Ltl.And (as_formula p) (as_formula q)
  | POr p q => Ltl.Or (as_formula p) (as_formula q)
  end.

Inductive property :=
| Now (p : predicate)
| Throughout (p : predicate)
| Not (p : property)
| And (p q : property)
| Or (p q : property)
| Implies (p q : property)
| Always (p : property)
| Never (p : property)
| Eventually (p : property)
| After (x : predicate) (p : property)
| Until (x : predicate) (p : property)
| AfterUntil (x y : predicate) (p : property)
| Within (c d : nat) (p : property).      (* d: the bound; c: the atom of its clock, which only encodings read *)

(** * Scopes *)

(** k is the first step from i on at which [x] holds. *)
Definition none_in (x : predicate) (s : stream) (i k : nat) : Prop :=
  forall m, i <= m < k -> at_letter x (s m) = false.
Definition first_step (x : predicate) (s : stream) (L : option nat) (i k : nat) : Prop :=
  i <= k /\ inside L k /\ at_letter x (s k) = true /\ none_in x s i k.

(** L' is the end of the segment that starts at i and ends before the next step with [y], if there is one. *)
Definition segment (s : stream) (L : option nat) (i : nat) (y : predicate) (L' : option nat) : Prop :=
  (exists k, first_step y s L i k /\ L' = Some k) \/
  ((forall m, i <= m -> inside L m -> at_letter y (s m) = false) /\ L' = L).

Definition opening (x y : predicate) : predicate := PAnd x (PNot y).

(** An episode opens at step k of the word that starts at i: the first at the first step with [x] and not [y]; it ends at
    the first later step m with [y], and the next opens at the first step from m on with [x] and not [y]. *)
Inductive opens (x y : predicate) (s : stream) (L : option nat) (i : nat) : nat -> Prop :=
| opens_first : forall k, first_step (opening x y) s L i k -> opens x y s L i k
| opens_next : forall j m k, opens x y s L i j -> first_step y s L (S j) m ->
    first_step (opening x y) s L m k -> opens x y s L i k.

(** * Times: nanoseconds, which do not decrease from one instant to the next *)

Definition times := nat -> nat.
Definition passing (t : times) : Prop := forall i k, i <= k -> t i <= t k.
(** Time that goes on for ever passes every moment. *)
Definition diverges (t : times) : Prop := forall u, exists k, u < t k.
(** The times of a word: those of an infinite one go on for ever. *)
Definition timed (t : times) (L : option nat) : Prop := passing t /\ (L = None -> diverges t).

(** L' is the end of the part of the segment from i on whose instants are at most d later than its first. *)
Definition beyond (t : times) (d i k : nat) : Prop := t i + d < t k.
Definition part (t : times) (L : option nat) (i d : nat) (L' : option nat) : Prop :=
  (exists k, i <= k /\ inside L k /\ beyond t d i k /\ (forall m, i <= m < k -> ~ beyond t d i m) /\ L' = Some k) \/
  ((forall m, i <= m -> inside L m -> ~ beyond t d i m) /\ L' = L).

(** * Denotation *)

(** The letter seen at a step: beyond the end of the word no atom holds. *)
Definition seen (s : stream) (L : option nat) (i : nat) : letter :=
  match L with
  | None => s i
  | Some n => if i <? n then s i else no_atom
  end.

Fixpoint satisfies (p : property) (s : stream) (t : times) (L : option nat) (i : nat) : Prop :=
  match p with
  | Now p => at_letter p (seen s L i) = true
  | Throughout p => forall k, i <= k -> inside L k -> at_letter p (s k) = true
  | Not p => ~ satisfies p s t L i
  | And p q => satisfies p s t L i /\ satisfies q s t L i
  | Or p q => satisfies p s t L i \/ satisfies q s t L i
  | Implies p q => satisfies p s t L i -> satisfies q s t L i
  | Always p => forall k, i <= k -> inside L k -> satisfies p s t L k
  | Never p => forall k, i <= k -> inside L k -> ~ satisfies p s t L k
  | Eventually p => exists k, i <= k /\ inside L k /\ satisfies p s t L k
  | After x p => forall k, first_step x s L i k -> satisfies p s t L k
  | Until x p => exists k, first_step x s L i k /\ satisfies p s t (Some k) i
  | AfterUntil x y p => forall k L', opens x y s L i k -> segment s L k y L' -> satisfies p s t L' k
  | Within _ d p => forall L', part t L i d L' -> satisfies p s t L' i
  end.

(** * Predicates as formulas *)

Lemma as_formula_inside : forall p s L i, inside L i -> (sat (as_formula p) s L i <-> at_letter p (s i) = true).
Proof.
  induction p; simpl; intros s L i Hi.
  - tauto.
  - tauto.
  - rewrite IHp by auto. destruct (at_letter p (s i)); simpl; split; congruence.
  - now rewrite IHp1, IHp2, andb_true_iff by auto.
  - now rewrite IHp1, IHp2, orb_true_iff by auto.
Qed.

Lemma as_formula_sat : forall p s L i, sat (as_formula p) s L i <-> at_letter p (seen s L i) = true.
Proof.
  intros p s L i. destruct L as [n|]; [|now apply (as_formula_inside p s None)]. simpl.
  destruct (Nat.ltb_spec i n) as [H|H]; [now apply as_formula_inside|].
  induction p; simpl.
  - tauto.
  - unfold no_atom; split; [lia | congruence].
  - rewrite IHp. destruct (at_letter p no_atom); simpl; split; congruence.
  - now rewrite IHp1, IHp2, andb_true_iff.
  - now rewrite IHp1, IHp2, orb_true_iff.
Qed.

(** * Facts about scopes *)

Lemma first_step_exists : forall x s k i, i <= k -> at_letter x (s k) = true ->
  exists m, i <= m <= k /\ at_letter x (s m) = true /\ none_in x s i m.
Proof.
  intros x s k i Hik Hx. remember (k - i) as n eqn:En. revert i Hik En.
  induction n; intros i Hik En.
  - assert (i = k) by lia; subst i. exists k; split; [lia|]; split; auto. intros m Hm; lia.
  - destruct (at_letter x (s i)) eqn:E.
    + exists i; split; [lia|]; split; auto. intros m Hm; lia.
    + destruct (IHn (S i)) as (m & H1 & H2 & H3); try lia.
      exists m; split; [lia|]; split; auto. intros j Hj. destruct (Nat.eq_dec j i); subst; auto. apply H3; lia.
Qed.

Lemma first_step_inside : forall x s L k i, i <= k -> inside L k -> at_letter x (s k) = true ->
  exists m, m <= k /\ first_step x s L i m.
Proof.
  intros x s L k i H1 H2 H3. destruct (first_step_exists x s k i H1 H3) as (m & Hm & Hx & Hn).
  exists m; split; [lia|]. repeat split; auto; try lia. eapply inside_le; [|eauto]; lia.
Qed.

Lemma segment_exists : forall s L i y, decided s L -> exists L', segment s L i y L'.
Proof.
  intros s L i y Hd. destruct (Hd (eventually (as_formula y)) i) as [H|H]; rewrite eventually_sat in H.
  - destruct H as (k & H1 & H2 & H3). rewrite as_formula_inside in H3 by auto.
    destruct (first_step_inside y s L k i H1 H2 H3) as (m & _ & Hm). exists (Some m). left; eauto.
  - exists L; right; split; auto. intros m H1 H2. destruct (at_letter y (s m)) eqn:E; auto.
    exfalso; apply H; exists m; repeat split; auto. now apply as_formula_inside.
Qed.

Lemma segment_decided : forall s L i y L', segment s L i y L' -> decided s L -> decided s L'.
Proof. intros s L i y L' [(k & _ & ->) | (_ & ->)] Hd; auto using decided_finite. Qed.

Lemma in_segment : forall s L i y L' j, segment s L i y L' -> i <= j -> inside L' j ->
  inside L j /\ at_letter y (s j) = false.
Proof.
  intros s L i y L' j [(k & (H1 & H2 & H3 & H4) & E) | (H & E)] Hj Hb; subst; auto.
  simpl in Hb. split; [eapply inside_le; [|eauto]; lia | apply H4; lia].
Qed.

(** A step that is reached without meeting [y] lies in the segment. *)
Lemma reaches_segment : forall s L i y L' j, segment s L i y L' -> i <= j -> inside L j ->
  (forall m, i <= m <= j -> at_letter y (s m) = false) -> inside L' j.
Proof.
  intros s L i y L' j [(k & (H1 & H2 & H3 & H4) & E) | (H & E)] Hj Hb Hn; subst; auto.
  simpl. destruct (le_lt_dec k j); auto. rewrite Hn in H3 by lia; congruence.
Qed.

Lemma opening_true : forall x y l, at_letter (opening x y) l = true -> at_letter x l = true /\ at_letter y l = false.
Proof. intros x y l H. simpl in H. destruct (at_letter x l), (at_letter y l); simpl in H; auto; congruence. Qed.

(** An episode opens at the first candidate from the start, or at the first candidate from some step with [y] on. *)
Lemma opens_split : forall x y s L i k,
  opens x y s L i k <->
  first_step (opening x y) s L i k \/
  exists j, i <= j /\ inside L j /\ at_letter y (s j) = true /\ first_step (opening x y) s L j k.
Proof.
  intros x y s L i k; split.
  - intros H. assert (HI : forall j, opens x y s L i j -> i <= j).
    { intros j Hj. induction Hj as [k0 Hk | j0 m0 k0 _ IH Hm Hk]; [apply Hk | destruct Hm, Hk; lia]. }
    destruct H as [k H | j m k H H1 H2]; [now left | right]. exists m. apply HI in H.
    destruct H1 as (A & B & C & _). repeat split; auto; try lia; apply H2.
  - intros [H | (j & A & B & C & H)]; [now apply opens_first|].
    assert (HO : forall n k0, opens x y s L i k0 -> k0 < j -> j - k0 <= n -> opens x y s L i k).
    { induction n; intros k0 Ho Hk0 Hn; [lia|].
      destruct (first_step_inside y s L j (S k0)) as (m & Hm & Hf); auto.
      destruct (Nat.eq_dec m j) as [->|Hne]; [eapply opens_next; eauto|].
      assert (Hmj : forall c, m <= c <= j -> inside L c) by (intros; eapply inside_le; [|exact B]; lia).
      destruct (decided_finite s j (eventually (as_formula (opening x y))) m) as [He|He]; rewrite eventually_sat in He.
      - destruct He as (c & C1 & C2 & C3). rewrite as_formula_inside in C3 by auto. simpl in C2.
        destruct (first_step_inside (opening x y) s L c m C1) as (k1 & D1 & D2); auto; [apply Hmj; lia|].
        apply (IHn k1); [eapply opens_next; eauto | lia |]. destruct D2, Hf; lia.
      - eapply opens_next; eauto. destruct H as (E1 & E2 & E3 & E4). repeat split; auto; [lia|].
        intros c Hc. destruct (le_lt_dec j c); [apply E4; lia|].
        destruct (at_letter (opening x y) (s c)) eqn:E; auto.
        exfalso; apply He; exists c. split; [lia|]. split; [simpl; lia|]. apply as_formula_inside; simpl; auto; lia. }
    destruct (decided_finite s j (eventually (as_formula (opening x y))) i) as [He|He]; rewrite eventually_sat in He.
    + destruct He as (c & C1 & C2 & C3). rewrite as_formula_inside in C3 by auto. simpl in C2.
      destruct (first_step_inside (opening x y) s L c i C1) as (k0 & D1 & D2); auto.
      { eapply inside_le; [|exact B]; lia. }
      apply (HO j k0); [now apply opens_first | lia | lia].
    + apply opens_first. destruct H as (E1 & E2 & E3 & E4). repeat split; auto; [lia|].
      intros c Hc. destruct (le_lt_dec j c); [apply E4; lia|].
      destruct (at_letter (opening x y) (s c)) eqn:E; auto.
      exfalso; apply He; exists c. split; [lia|]. split; [simpl; lia|]. apply as_formula_inside; simpl; auto; lia.
Qed.

(** * Facts about parts *)

Lemma timed_finite : forall t L n, timed t L -> timed t (Some n).
Proof. intros t L n [Ht _]. split; auto. congruence. Qed.

Lemma timed_segment : forall s t L i y L', timed t L -> segment s L i y L' -> timed t L'.
Proof. intros s t L i y L' Ht [(k & _ & ->) | (_ & ->)]; eauto using timed_finite. Qed.

Lemma timed_part : forall t L i d L', timed t L -> part t L i d L' -> timed t L'.
Proof. intros t L i d L' Ht [(k & _ & _ & _ & _ & ->) | (_ & ->)]; eauto using timed_finite. Qed.

Lemma part_inside : forall t L i d L' j, passing t -> part t L i d L' -> i <= j ->
  (inside L' j <-> inside L j /\ ~ beyond t d i j).
Proof.
  intros t L i d L' j Ht [(k & A & B & C & D & ->) | (H & ->)] Hj; simpl.
  - split.
    + intros Hk. split; [eapply inside_le; [|exact B]; lia | apply D; lia].
    + intros [Hi Hb]. destruct (le_lt_dec k j) as [Hk|]; auto. exfalso; apply Hb. unfold beyond in *.
      pose proof (Ht k j Hk). lia.
  - split; [intros Hi; split; auto | tauto].
Qed.

(** The first instant before n that is beyond the bound, if there is one. *)
Lemma first_beyond : forall t d i n,
  (exists m, i <= m < n /\ beyond t d i m /\ forall j, i <= j < m -> ~ beyond t d i j) \/
  (forall m, i <= m < n -> ~ beyond t d i m).
Proof.
  intros t d i n. induction n as [|n IH]; [right; intros; lia|].
  destruct IH as [(m & A & B & C) | IH]; [left; exists m; repeat split; auto; lia|].
  destruct (le_lt_dec i n); [|right; intros; lia]. destruct (lt_dec (t i + d) (t n)) as [H|H].
  - left. exists n. repeat split; auto.
  - right. intros m Hm. destruct (Nat.eq_dec m n); subst; auto. apply IH; lia.
Qed.

(** Every part exists: on a finite word by looking, on an infinite one because time goes on. *)
Lemma part_exists : forall t L i d, timed t L -> exists L', part t L i d L'.
Proof.
  intros t [n|] i d [Ht Hd]; unfold part.
  - destruct (first_beyond t d i n) as [(m & A & B & C) | N].
    + exists (Some m). left. exists m. repeat split; simpl; auto; lia.
    + exists (Some n). right. simpl; auto.
  - destruct (Hd eq_refl (t i + d)) as (n & Hn).
    assert (Hin : i <= n) by (destruct (le_lt_dec i n); auto; pose proof (Ht n i); lia).
    destruct (first_beyond t d i (S n)) as [(m & A & B & C) | N].
    + exists (Some m). left. exists m. repeat split; simpl; auto; lia.
    + exfalso. apply (N n); auto.
Qed.
