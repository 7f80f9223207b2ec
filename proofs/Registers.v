(** Clocks are followed online: each counts from one instant, which a register remembers. So for every run there is
    one word with clock atoms to judge ([with_clocks]), and on it the encoding says what the property says
    ([encode_correct_online]).

    Python: [Clock] in [ltlc/semantics/timed_atoms.py], and its trackers. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Relativise Encodings Clocks.

(** * Scopes and clocks *)

Inductive scope :=
| WholeRun
| AfterEvent (o : scope) (x : predicate)
| BeforeEvent (o : scope) (x : predicate)
| Episodes (o : scope) (x y : predicate).

(** From when a clock counts: the opening of a scope; in a scope, the first [x] that no [y] has answered; the last
    [x]. *)
Inductive clock :=
| SinceOpening (o : scope)
| FirstOpen (o : scope) (x y : predicate)
| LastTrigger (o : scope) (x : predicate).

(** The atom that a clock is past a bound. *)
Record timer := { atom_of : nat; clock_of : clock; bound_of : nat }.

Definition timer_of (o : scope) (b : obligation) : timer :=
  match b with
  | Response c d x y => {| atom_of := c; clock_of := FirstOpen o x y; bound_of := d |}
  | Prevention c d x _ => {| atom_of := c; clock_of := LastTrigger o x; bound_of := d |}
  end.

(** What stands before the end of a scope began when the scope around it did. *)
Fixpoint opening_of (o : scope) : scope := match o with BeforeEvent o _ => opening_of o | _ => o end.

Fixpoint timers (o : scope) (p : property) : list timer :=
  match p with
  | Now _ | Throughout _ | Never _ | Eventually _ => []
  | Not p => timers o p
  | And p q | Or p q | Implies p q => timers o p ++ timers o q
  | Always p => match obligation_of PTruth p with Some b => [timer_of o b] | None => [] end
  | After x p => timers (AfterEvent o x) p
  | Until x p => timers (BeforeEvent o x) p
  | AfterUntil x y p => timers (Episodes o x y) p
  | Within c d p => {| atom_of := c; clock_of := SinceOpening (opening_of o); bound_of := d |} :: timers o p
  end.

(** Bounds stand at anchors: at the beginning of the run or of a scope, under [not], [and], [or], [implies] there;
    or they are obligations under [always] at one. *)
Fixpoint anchored (p : property) : bool :=
  match p with
  | Now _ | Throughout _ => true
  | Not p | After _ p | Until _ p | AfterUntil _ _ p | Within _ _ p => anchored p
  | And p q | Or p q | Implies p q => anchored p && anchored q
  | Always p => match obligation_of PTruth p with Some _ => true | None => unbounded p end
  | Never p | Eventually p => unbounded p
  end.

(** * Registers *)

(** A tracker says at each step whether its scope is open, by the step where it began. *)
Definition tracker := nat -> option nat.
Definition tracks (tr : tracker) (L : option nat) (i : nat) : Prop := forall k, i <= k -> inside L k -> tr k = Some i.

Section Register.
  Variables (update : option nat -> nat -> option nat) (tr : tracker).

  (** A register is empty when its scope begins, and is updated at each step of it. *)
  Fixpoint register (k : nat) : option nat :=
    match tr k with
    | None => None
    | Some a => update (match k with 0 => None | S j => if a <=? j then register j else None end) k
    end.
  Definition before (k : nat) : option nat :=
    match tr k, k with Some a, S j => if a <=? j then register j else None | _, _ => None end.

  Lemma register_eq : forall k, register k = match tr k with None => None | Some _ => update (before k) k end.
  Proof. intros k. unfold before. destruct k; simpl; destruct (tr _); auto. Qed.

  Lemma register_step : forall L a k, tracks tr L a -> a <= k -> inside L k -> register k = update (before k) k.
  Proof. intros L a k HT Hk Hi. rewrite register_eq, (HT k Hk Hi). reflexivity. Qed.

  Lemma before_start : forall L a, tracks tr L a -> inside L a -> before a = None.
  Proof.
    intros L a HT Hi. unfold before. rewrite (HT a) by auto. destruct a; auto.
    destruct (Nat.leb_spec (S a) a); auto; lia.
  Qed.

  Lemma before_next : forall L a k, tracks tr L a -> a <= k -> inside L (S k) -> before (S k) = register k.
  Proof.
    intros L a k HT Hk Hi. unfold before. rewrite (HT (S k)) by (auto; lia).
    destruct (Nat.leb_spec a k); auto; lia.
  Qed.

  (** What holds of an empty register at the beginning, and is kept, holds. *)
  Lemma before_invariant : forall L a (I : nat -> option nat -> Prop), tracks tr L a -> I a None ->
    (forall k r, a <= k -> inside L k -> I k r -> I (S k) (update r k)) ->
    forall k, a <= k -> inside L k -> I k (before k).
  Proof.
    intros L a I HT H0 HI k Hk. induction Hk as [|k Hk IH]; intros Hi.
    - now rewrite (before_start L a).
    - assert (Hi' : inside L k) by (eapply inside_le; [|exact Hi]; lia).
      rewrite (before_next L a), (register_step L a) by auto. auto.
  Qed.

  Lemma register_invariant : forall L a (I : nat -> option nat -> Prop), tracks tr L a -> I a None ->
    (forall k r, a <= k -> inside L k -> I k r -> I (S k) (update r k)) ->
    forall k, a <= k -> inside L k -> I (S k) (register k).
  Proof.
    intros L a I HT H0 HI k Hk Hi. rewrite (register_step L a) by auto. apply HI; auto.
    now apply (before_invariant L a).
  Qed.
End Register.

(** The updates. *)
Definition opened (x : predicate) (s : stream) (r : option nat) (k : nat) : option nat :=
  match r with Some j => Some j | None => if at_letter x (s k) then Some k else None end.
Definition episode (x y : predicate) (s : stream) (r : option nat) (k : nat) : option nat :=
  if at_letter y (s k) then None else opened x s r k.
Definition uncut (x : predicate) (s : stream) (tr : tracker) (r : option nat) (k : nat) : option nat :=
  if at_letter x (s k) then None else match tr k with Some a => if a =? k then Some k else r | None => None end.
Definition trigger (x : predicate) (s : stream) (r : option nat) (k : nat) : option nat :=
  if at_letter x (s k) then Some k else r.

Fixpoint scope_tracker (o : scope) (s : stream) : tracker :=
  match o with
  | WholeRun => fun _ => Some 0
  | AfterEvent o x => register (opened x s) (scope_tracker o s)
  | BeforeEvent o x => register (uncut x s (scope_tracker o s)) (scope_tracker o s)
  | Episodes o x y => register (episode x y s) (scope_tracker o s)
  end.

(** The step from which a clock counts. A response's is read before its step is taken in, for a [y] is due up to the
    bound; a prevention's after, for each [x] begins anew. *)
Definition counts_from (cl : clock) (s : stream) : tracker :=
  match cl with
  | SinceOpening o => scope_tracker o s
  | FirstOpen o x y => before (episode x y s) (scope_tracker o s)
  | LastTrigger o x => register (trigger x s) (scope_tracker o s)
  end.

Definition older (t : times) (d : nat) (r : option nat) (k : nat) : bool :=
  match r with Some j => t j + d <? t k | None => false end.
Definition late (x : timer) (s : stream) (t : times) (k : nat) : bool :=
  older t (bound_of x) (counts_from (clock_of x) s k) k.

(** * The trackers show where scopes are open *)

Lemma tracks_after : forall x s tr L i k, tracks tr L i -> first_step x s L i k ->
  tracks (register (opened x s) tr) L k.
Proof.
  intros x s tr L i k HT (A & B & C & D) m Hm Hi.
  assert (HI := register_invariant (opened x s) tr L i (fun m r => (m <= k -> r = None) /\ (k < m -> r = Some k)) HT).
  apply HI; auto; try lia; [split; auto; lia|].
  intros j r Hj Hij [H1 H2]. split; intros Hjk.
  - rewrite H1 by lia. simpl. rewrite D by lia. reflexivity.
  - destruct (Nat.eq_dec j k) as [->|]; [rewrite H1 by lia; simpl; now rewrite C | rewrite H2 by lia; reflexivity].
Qed.

Lemma tracks_until : forall x s tr L i k, tracks tr L i -> first_step x s L i k ->
  tracks (register (uncut x s tr) tr) (Some k) i.
Proof.
  intros x s tr L i k HT (A & B & C & D) m Hm Hi. simpl in Hi.
  assert (HL : forall j, j < k -> inside L j) by (intros; eapply inside_le; [|exact B]; lia).
  assert (HI := register_invariant (uncut x s tr) tr L i (fun m r => i < m <= k -> r = Some i) HT).
  apply HI; auto; try lia. intros j r Hj Hij H1 Hjk. unfold uncut. rewrite D, (HT j) by (auto; lia).
  destruct (Nat.eqb_spec i j); [now subst | apply H1; lia].
Qed.

(** Where an episode opens, the register has its opening. *)
Lemma episode_register : forall x y s tr L i k, tracks tr L i -> opens x y s L i k ->
  i <= k /\ inside L k /\ register (episode x y s) tr k = Some k.
Proof.
  intros x y s tr L i k HT HO.
  (* from a step where the register is empty before, to the next opening *)
  assert (HN : forall j m, i <= j -> inside L m -> before (episode x y s) tr j = None ->
    first_step (opening x y) s L j m ->
            register (episode x y s) tr m = Some m).
  { intros j m Hj Hm HB (F1 & _ & F3 & F4).
    assert (HE : forall n, j <= n -> n <= m -> before (episode x y s) tr n = None).
    { intros n Hn. induction Hn as [|n Hn IH]; intros Hnm; auto.
      rewrite (before_next _ tr L i) by (auto; try lia; try (eapply inside_le; [|exact Hm]; lia)).
      rewrite (register_step _ tr L i) by (auto; try lia; try (eapply inside_le; [|exact Hm]; lia)). rewrite IH by lia.
      unfold episode, opened. specialize (F4 n). simpl in F4. destruct (at_letter y (s n)); auto.
      destruct (at_letter x (s n)); auto. simpl in F4. assert (true = false) by (apply F4; lia). congruence. }
    rewrite (register_step _ tr L i), HE by (auto; lia). unfold episode, opened.
    apply opening_true in F3. destruct F3 as [F3 F5]. now rewrite F5, F3. }
  induction HO as [k HF | j m k HO IH HM HF].
  - pose proof HF as (A & B & _). repeat split; auto. apply (HN i); auto. apply (before_start _ tr L); auto.
    eapply inside_le; eauto.
  - destruct IH as (A & B & C). pose proof HM as (M1 & M2 & M3 & _). pose proof HF as (F1 & F2 & F3 & _).
    apply opening_true in F3. destruct F3 as [_ F3].
    assert (m <> k) by (intros ->; congruence). repeat split; auto; try lia.
    assert (HS : first_step (opening x y) s L (S m) k).
    { destruct HF as (G1 & G2 & G3 & G4). repeat split; auto; try lia. intros n Hn. apply G4; lia. }
    apply (HN (S m)); auto; try lia.
    assert (Hm : inside L (S m)) by (eapply inside_le; [|exact F2]; lia).
    rewrite (before_next _ tr L i) by (auto; lia). rewrite (register_step _ tr L i) by (auto; lia).
    unfold episode. now rewrite M3.
Qed.

Lemma tracks_episode : forall x y s tr L i k L', tracks tr L i -> opens x y s L i k -> segment s L k y L' ->
  tracks (register (episode x y s) tr) L' k.
Proof.
  intros x y s tr L i k L' HT HO HS m Hm. destruct (episode_register x y s tr L i k HT HO) as (A & B & C).
  induction Hm as [|m Hm IH]; intros Hi; auto.
  destruct (in_segment s L k y L' (S m) HS) as [D E]; auto; try lia.
  assert (inside L' m) by (eapply inside_le; [|exact Hi]; lia).
  rewrite (register_step _ tr L i) by (auto; lia). rewrite (before_next _ tr L i) by (auto; lia). rewrite IH by auto.
  unfold episode, opened. now rewrite E.
Qed.

(** * The clocks of obligations are right *)

(** The earliest obligation that is open. *)
Lemma response_register : forall x y d s t tr L i k, passing t -> tracks tr L i -> i <= k -> inside L k ->
  (older t d (before (episode x y s) tr k) k = true <-> overdue x y d s t i k).
Proof.
  intros x y d s t tr L i k Ht HT Hk Hi.
  set (earliest := fun k (r : option nat) => match r with
     | Some j => i <= j < k /\ at_letter x (s j) = true /\ none_in y s j k /\
                 forall o, i <= o < k -> at_letter x (s o) = true -> none_in y s o k -> j <= o
     | None => forall o, i <= o < k -> at_letter x (s o) = true -> none_in y s o k -> False
     end).
  assert (HI : earliest k (before (episode x y s) tr k)).
  { apply (before_invariant (episode x y s) tr L i earliest HT); auto; [intros o; lia|].
    clear k Hk Hi. intros k r Hk Hi HR. unfold earliest, episode, opened in *. destruct (at_letter y (s k)) eqn:Ey.
    { intros o Ho Hx Hn. rewrite (Hn k) in Ey by lia. congruence. }
    destruct r as [j|]; [|destruct (at_letter x (s k)) eqn:Ex].
    - destruct HR as (R1 & R2 & R3 & R4). repeat split; auto; try lia.
      + intros m Hm. destruct (Nat.eq_dec m k); subst; auto. apply R3; lia.
      + intros o Ho Hx Hn. destruct (Nat.eq_dec o k); [lia|]. apply R4; auto; try lia. intros m Hm. apply Hn; lia.
    - repeat split; auto; try lia.
      + intros m Hm. replace m with k by lia. auto.
      + intros o Ho Hx Hn. destruct (Nat.eq_dec o k); [lia|]. exfalso. apply (HR o); auto; try lia. intros m Hm.
      apply Hn; lia.
    - intros o Ho Hx Hn. destruct (Nat.eq_dec o k); [congruence|]. apply (HR o); auto; try lia. intros m Hm.
    apply Hn; lia. }
  unfold older, overdue, beyond, earliest in *. destruct (before (episode x y s) tr k) as [j|].
  - destruct HI as (I1 & I2 & I3 & I4). rewrite Nat.ltb_lt. split.
    + intros H. exists j. repeat split; auto; lia.
    + intros (o & O1 & O2 & O3 & O4). destruct (Nat.eq_dec o k) as [->|]; [lia|].
      assert (j <= o) by (apply I4; auto; lia). assert (t j <= t o) by (apply Ht; lia). lia.
  - split; [congruence|]. intros (o & O1 & O2 & O3 & O4). exfalso.
    destruct (Nat.eq_dec o k) as [->|]; [lia|]. apply (HI o); auto; lia.
Qed.

(** The latest trigger. *)
Lemma prevention_register : forall x d s t tr L i k, passing t -> tracks tr L i -> i <= k -> inside L k ->
  triggered x s i k -> (older t d (register (trigger x s) tr k) k = true <-> run_out x d s t i k).
Proof.
  intros x d s t tr L i k Ht HT Hk Hi HX.
  set (last := fun k (r : option nat) => match r with
     | Some j => i <= j < k /\ at_letter x (s j) = true /\ forall o, j < o < k -> at_letter x (s o) = false
     | None => forall o, i <= o < k -> at_letter x (s o) = false
     end).
  assert (HI : last (S k) (register (trigger x s) tr k)).
  { apply (register_invariant (trigger x s) tr L i last HT); auto; [intros o; lia|].
    clear k Hk Hi HX. intros k r Hk Hi HR. unfold last, trigger in *. destruct (at_letter x (s k)) eqn:Ex.
    - repeat split; auto; try lia.
    - destruct r as [j|].
      + destruct HR as (R1 & R2 & R3). repeat split; auto; try lia.
        intros o Ho. destruct (Nat.eq_dec o k); subst; auto. apply R3; lia.
      + intros o Ho. destruct (Nat.eq_dec o k); subst; auto. apply HR; lia. }
  unfold older, run_out, beyond, last in *. destruct (register (trigger x s) tr k) as [j|].
  - destruct HI as (I1 & I2 & I3). rewrite Nat.ltb_lt. split.
    + intros H o Ho Hx. destruct (le_lt_dec o j); [|rewrite I3 in Hx by lia; congruence].
      assert (t o <= t j) by (apply Ht; lia). lia.
    + intros H. apply H; auto; lia.
  - destruct HX as (j & J1 & J2). rewrite HI in J2 by lia. congruence.
Qed.

(** * So the clocks of a property are right *)

(** The word shows what the timers say. *)
Definition shown (xs : list timer) (s : stream) (t : times) : Prop :=
  forall x, In x xs -> forall k, s k (atom_of x) = late x s t k.

Lemma shown_app : forall xs ys s t, shown (xs ++ ys) s t -> shown xs s t /\ shown ys s t.
Proof. intros xs ys s t H. split; intros x Hx; apply H, in_app_iff; auto. Qed.

Lemma obligation_clock_right : forall b o s t L i k, passing t -> tracks (scope_tracker o s) L i ->
  shown [timer_of o b] s t -> i <= k -> inside L k -> right_obligation b s t i k.
Proof.
  intros b o s t L i k Ht HT HS A B. specialize (HS _ (or_introl eq_refl)). destruct b as [c d x y|c d x y]; simpl.
  - change (s k c) with (s k (atom_of (timer_of o (Response c d x y)))). rewrite HS.
    now apply (response_register x y d s t (scope_tracker o s) L).
  - intros HX. change (s k c) with (s k (atom_of (timer_of o (Prevention c d x y)))). rewrite HS.
    now apply (prevention_register x d s t (scope_tracker o s) L).
Qed.

Theorem clocks_right : forall p o s t L i, passing t -> anchored p = true ->
  tracks (scope_tracker o s) L i -> tracks (scope_tracker (opening_of o) s) L i ->
  shown (timers o p) s t -> right p s t L i.
Proof.
  intros p o s t L i Ht. revert o L i.
  induction p; intros o L i HA HT HB HS; simpl in HA, HS; simpl right; auto;
    try (apply andb_true_iff in HA; destruct HA as [A1 A2]; apply shown_app in HS; destruct HS; split; eauto; fail);
    try (intros; now apply unbounded_right).
  - eauto.
  - destruct (obligation_of PTruth p) as [b|]; intros k A B; [|now apply unbounded_right].
    now apply (obligation_clock_right b o s t L i k).
  - intros k Hk. apply (IHp (AfterEvent o x)); auto; now apply (tracks_after x s _ L i k).
  - intros k Hk. pose proof (tracks_until x s _ L i k HT Hk) as HU. apply (IHp (BeforeEvent o x)); auto.
    intros m A B. apply HB; auto. destruct Hk as (_ & C & _). simpl in B. eapply inside_le; [|exact C]; lia.
  - intros k L' HO HL. apply (IHp (Episodes o x y)); auto; now apply (tracks_episode x y s _ L i k L').
  - split.
    + intros k A B. rewrite (HS _ (or_introl eq_refl)). unfold late. simpl. rewrite (HB k A B). simpl. apply Nat.ltb_lt.
    + intros L' HP. pose proof (part_inside t L i d L') as HI.
      apply (IHp o); auto; [| |intros x Hx; apply HS; simpl; auto]; intros k A B; [apply HT | apply HB]; auto;
        now apply HI.
Qed.

Lemma tracks_run : forall s L, tracks (scope_tracker WholeRun s) L 0.
Proof. intros s L k _ _. reflexivity. Qed.

(** * What clocks look at: the past alone, and there the atoms of their events *)

Fixpoint scope_asks (o : scope) (a : nat) : bool :=
  match o with
  | WholeRun => false
  | AfterEvent o x | BeforeEvent o x => scope_asks o a || mentions x a
  | Episodes o x y => scope_asks o a || mentions x a || mentions y a
  end.
Definition clock_asks (cl : clock) (a : nat) : bool :=
  match cl with
  | SinceOpening o => scope_asks o a
  | FirstOpen o x y => scope_asks o a || mentions x a || mentions y a
  | LastTrigger o x => scope_asks o a || mentions x a
  end.

(** The two streams have the same letters up to k, of those atoms that [asks] tells. *)
Definition same_up_to (k : nat) (asks : nat -> bool) (s s' : stream) : Prop :=
  forall j, j <= k -> forall a, asks a = true -> s j a = s' j a.

Lemma same_up_to_some : forall k f g s s', same_up_to k g s s' -> (forall a, f a = true -> g a = true) ->
  same_up_to k f s s'.
Proof. intros k f g s s' H Hf j Hj a Ha. auto. Qed.

Lemma register_same : forall f g tr ur k, (forall r j, j <= k -> f r j = g r j) -> (forall j, j <= k -> tr j = ur j) ->
  register f tr k = register g ur k.
Proof.
  intros f g tr ur k. induction k as [|k IH]; intros Hf Ht; simpl; rewrite Ht by auto; destruct (ur _); auto.
  rewrite Hf, IH by auto. reflexivity.
Qed.

Lemma before_same : forall f g tr ur k, (forall r j, j <= k -> f r j = g r j) -> (forall j, j <= k -> tr j = ur j) ->
  before f tr k = before g ur k.
Proof.
  intros f g tr ur k Hf Ht. unfold before. rewrite Ht by auto. destruct (ur k), k; auto. destruct (n <=? k); auto.
  apply register_same; auto.
Qed.

Lemma at_letter_up_to : forall x k s s' j, same_up_to k (mentions x) s s' -> j <= k ->
  at_letter x (s j) = at_letter x (s' j).
Proof. intros x k s s' j H Hj. apply at_letter_same. intros a. now apply H. Qed.

Lemma scope_same : forall o k s s', same_up_to k (scope_asks o) s s' ->
  forall j, j <= k -> scope_tracker o s j = scope_tracker o s' j.
Proof.
  induction o as [|o IH x|o IH x|o IH x y]; intros k s s' H j Hj; auto;
    assert (HO : forall j, j <= k -> scope_tracker o s j = scope_tracker o s' j)
      by (apply IH; eapply same_up_to_some; [exact H|]; simpl; intros a ->; reflexivity);
    assert (HX : forall j, j <= k -> at_letter x (s j) = at_letter x (s' j))
      by (intros m Hm; apply (at_letter_up_to x k); auto; eapply same_up_to_some; [exact H|]; simpl; intros a ->;
          now rewrite ?orb_true_r);
    simpl; apply register_same; intros; try (apply HO; lia).
  - unfold opened. now rewrite HX by lia.
  - unfold uncut. now rewrite HX, HO by lia.
  - assert (HY : at_letter y (s j0) = at_letter y (s' j0)).
    { apply (at_letter_up_to y k); [|lia]. eapply same_up_to_some; [exact H|]. simpl. intros a ->.
    now rewrite orb_true_r. }
    unfold episode, opened. now rewrite HX, HY by lia.
Qed.

Lemma counts_from_same : forall cl k s s', same_up_to k (clock_asks cl) s s' ->
  counts_from cl s k = counts_from cl s' k.
Proof.
  intros cl k s s' H.
  assert (HO : forall o, (forall a, scope_asks o a = true -> clock_asks cl a = true) ->
            forall j, j <= k -> scope_tracker o s j = scope_tracker o s' j).
  { intros o Ho. apply scope_same. eapply same_up_to_some; eauto. }
  assert (HX : forall x, (forall a, mentions x a = true -> clock_asks cl a = true) ->
            forall j, j <= k -> at_letter x (s j) = at_letter x (s' j)).
  { intros x Hx j. apply at_letter_up_to. eapply same_up_to_some; eauto. }
  destruct cl as [o|o x y|o x]; simpl counts_from; simpl clock_asks in *.
  - apply HO; auto.
  - apply before_same; intros; [|apply HO; auto; intros a ->; reflexivity]. unfold episode, opened.
    rewrite (HX x), (HX y); auto; intros a ->; now rewrite ?orb_true_r.
  - apply register_same; intros; [|apply HO; auto; intros a ->; reflexivity]. unfold trigger.
    rewrite (HX x); auto; intros a ->; now rewrite ?orb_true_r.
Qed.

(** A clock counts from a step that has been. *)
Definition remembers (f : option nat -> nat -> option nat) : Prop := forall r k j, f r k = Some j ->
  j = k \/ r = Some j.
Definition backward (tr : tracker) : Prop := forall k a, tr k = Some a -> a <= k.

Lemma opened_remembers : forall x s, remembers (opened x s).
Proof. intros x s [i|] k j; simpl; auto. destruct (at_letter x (s k)); intros H; [injection H as <-;
  auto | congruence]. Qed.
Lemma episode_remembers : forall x y s, remembers (episode x y s).
Proof. intros x y s r k j. unfold episode. destruct (at_letter y (s k)); [congruence | apply opened_remembers]. Qed.
Lemma uncut_remembers : forall x s tr, remembers (uncut x s tr).
Proof.
  intros x s tr r k j. unfold uncut. destruct (at_letter x (s k)), (tr k) as [a|]; try congruence; auto.
  destruct (a =? k); auto. intros H; injection H as <-; auto.
Qed.
Lemma trigger_remembers : forall x s, remembers (trigger x s).
Proof. intros x s r k j. unfold trigger. destruct (at_letter x (s k)); intros H; auto. injection H as <-; auto. Qed.

Lemma register_backward : forall f tr, remembers f -> backward (register f tr).
Proof.
  intros f tr Hf k. induction k as [|k IH]; intros j H; simpl in H.
  - destruct (tr 0); [|congruence]. destruct (Hf _ _ _ H); [lia | congruence].
  - destruct (tr (S k)) as [a|]; [|congruence]. destruct (Hf _ _ _ H) as [->|E]; auto.
    destruct (a <=? k); [apply IH in E; lia | congruence].
Qed.
Lemma before_backward : forall f tr, remembers f -> backward (before f tr).
Proof.
  intros f tr Hf k j. unfold before. destruct (tr k), k; try congruence. destruct (n <=? k); [|congruence].
  intros H. apply (register_backward f tr Hf) in H. lia.
Qed.
Lemma scope_backward : forall o s, backward (scope_tracker o s).
Proof.
  destruct o; intros s; simpl; auto using register_backward, opened_remembers, episode_remembers, uncut_remembers.
  intros k a H. injection H as <-. lia.
Qed.
Lemma counts_from_backward : forall cl s, backward (counts_from cl s).
Proof.
  destruct cl; intros s; simpl;
    auto using scope_backward, before_backward, register_backward, episode_remembers, trigger_remembers.
Qed.

Lemma late_same : forall x s s' t t' k, same_up_to k (clock_asks (clock_of x)) s s' -> (forall j, j <= k ->
  t j = t' j) ->
  late x s t k = late x s' t' k.
Proof.
  intros x s s' t t' k H Ht. unfold late. rewrite (counts_from_same _ k s s' H).
  pose proof (counts_from_backward (clock_of x) s' k) as HB. destruct (counts_from (clock_of x) s' k) as [j|]; simpl;
    auto.
Qed.

(** * The word to judge *)

Fixpoint property_asks (p : property) (a : nat) : bool :=
  match p with
  | Now p | Throughout p => mentions p a
  | Not p | Always p | Never p | Eventually p | Within _ _ p => property_asks p a
  | And p q | Or p q | Implies p q => property_asks p a || property_asks q a
  | After x p | Until x p => mentions x a || property_asks p a
  | AfterUntil x y p => mentions x a || mentions y a || property_asks p a
  end.

(** An atom belongs to one timer, and no event asks for it. *)
Definition own_timers (p : property) : Prop :=
  (forall x y, In x (timers WholeRun p) -> In y (timers WholeRun p) -> atom_of x = atom_of y -> x = y) /\
  (forall x, In x (timers WholeRun p) -> property_asks p (atom_of x) = false).

Definition with_clocks (p : property) (s : stream) (t : times) : stream := fun k a =>
  match find (fun x => atom_of x =? a) (timers WholeRun p) with Some x => late x s t k | None => s k a end.

Lemma obligation_asks : forall p z b, obligation_of z p = Some b -> forall o a,
  clock_asks (clock_of (timer_of o b)) a = true -> scope_asks o a || mentions z a || property_asks p a = true.
Proof.
  apply (obligation_of_ind (fun z p b => forall o a, clock_asks (clock_of (timer_of o b)) a = true ->
    scope_asks o a || mentions z a || property_asks p a = true)); simpl; intros z; intros; auto;
    try (rewrite H; reflexivity).
  specialize (H o0 a H0). destruct z; simpl in *; rewrite ?orb_true_iff in *; tauto.
Qed.

Lemma timers_ask : forall p o x a, In x (timers o p) -> clock_asks (clock_of x) a = true ->
  scope_asks o a || property_asks p a = true.
Proof.
  assert (HO : forall o a, scope_asks (opening_of o) a = true -> scope_asks o a = true).
  { induction o; intros a H; simpl in *; auto. now rewrite IHo. }
  induction p; intros o z a HI HA; simpl in HI; try (destruct HI; fail); simpl property_asks;
    try (apply in_app_iff in HI; destruct HI as [HI|HI]; [apply (IHp1 o z a) in HI | apply (IHp2 o z a) in HI]; auto;
         rewrite !orb_true_iff in *; tauto).
  - now apply (IHp o z a).
  - destruct (obligation_of PTruth p) as [b|] eqn:E; [|destruct HI]. destruct HI as [<-|[]].
    pose proof (obligation_asks p PTruth b E o a HA) as H. simpl in H. now rewrite orb_false_r in H.
  - apply (IHp _ z a) in HI; auto. simpl in HI. rewrite !orb_true_iff in *. tauto.
  - apply (IHp _ z a) in HI; auto. simpl in HI. rewrite !orb_true_iff in *. tauto.
  - apply (IHp _ z a) in HI; auto. simpl in HI. rewrite !orb_true_iff in *. tauto.
  - destruct HI as [<-|HI]; [simpl in HA; now rewrite HO | now apply (IHp o z a)].
Qed.

Lemma with_clocks_elsewhere : forall p s t k a, own_timers p -> property_asks p a = true ->
  with_clocks p s t k a = s k a.
Proof.
  intros p s t k a [_ H] Ha. unfold with_clocks. destruct (find _ _) as [x|] eqn:E; auto.
  apply find_some in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E2. subst. rewrite H in Ha by auto. congruence.
Qed.

Lemma with_clocks_shown : forall p s t, own_timers p -> shown (timers WholeRun p) (with_clocks p s t) t.
Proof.
  intros p s t HO x Hx k. unfold with_clocks at 1.
  destruct (find (fun y => atom_of y =? atom_of x) (timers WholeRun p)) as [y|] eqn:E.
  - apply find_some in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E2. rewrite (proj1 HO y x) by auto.
    apply late_same; auto. intros j _ a Ha. symmetry. apply with_clocks_elsewhere; auto.
    pose proof (timers_ask p WholeRun x a Hx Ha) as H. simpl in H. exact H.
  - apply (find_none _ _ E x) in Hx. now rewrite Nat.eqb_refl in Hx.
Qed.

Lemma with_clocks_causal : forall p s s' t t' n, (forall k, k < n -> t k = t' k /\ forall a, s k a = s' k a) ->
  forall k a, k < n -> with_clocks p s t k a = with_clocks p s' t' k a.
Proof.
  intros p s s' t t' n H k a Hk. unfold with_clocks. destruct (find _ _) as [x|]; [|now apply H].
  apply late_same; [intros j Hj b _|intros j Hj]; apply H; lia.
Qed.

(** A property does not look at what its events do not ask for. *)
Definition same_asked (p : nat -> bool) (s s' : stream) : Prop := forall k a, p a = true -> s k a = s' k a.

Lemma at_letter_asked : forall x s s' k, same_asked (mentions x) s s' -> at_letter x (s k) = at_letter x (s' k).
Proof. intros x s s' k H. apply at_letter_same. intros a. apply H. Qed.
Lemma first_step_asked : forall x s s' L i k, same_asked (mentions x) s s' -> first_step x s L i k ->
  first_step x s' L i k.
Proof.
  intros x s s' L i k H (A & B & C & D). repeat split; auto; [now rewrite <- (at_letter_asked x s s')|].
  intros m Hm. rewrite <- (at_letter_asked x s s'); auto.
Qed.
Lemma opens_asked : forall x y s s' L i k, same_asked (mentions x) s s' -> same_asked (mentions y) s s' ->
  opens x y s L i k -> opens x y s' L i k.
Proof.
  intros x y s s' L i k Hx Hy H. assert (HO : same_asked (mentions (opening x y)) s s').
  { intros j a Ha. simpl in Ha. apply orb_true_iff in Ha. destruct Ha; auto. }
  induction H; [apply opens_first | eapply opens_next]; eauto using first_step_asked.
Qed.
Lemma segment_asked : forall y s s' L i L', same_asked (mentions y) s s' -> segment s L i y L' -> segment s' L i y L'.
Proof.
  intros y s s' L i L' H [(k & A & B) | (A & B)]; [left; exists k; eauto using first_step_asked | right; split; auto].
  intros m M1 M2. rewrite <- (at_letter_asked y s s'); auto.
Qed.

Lemma satisfies_asked : forall p s s' t L i, same_asked (property_asks p) s s' ->
  (satisfies p s t L i <-> satisfies p s' t L i).
Proof.
  assert (HS : forall f s s', same_asked f s s' -> same_asked f s' s) by (intros f s s' H k a Ha; symmetry; auto).
  assert (H2 : forall (f g : nat -> bool) s s', same_asked (fun a => f a || g a) s s' ->
    same_asked f s s' /\ same_asked g s s').
  { intros f g s s' H. split; intros k a Ha; apply H; rewrite Ha; auto using orb_true_r. }
  induction p; intros s s' t L i H; simpl in H; simpl satisfies;
    try (apply H2 in H; destruct H as [H H']; rewrite (IHp1 s s'), (IHp2 s s') by auto; tauto).
  - assert (E : at_letter p (seen s L i) = at_letter p (seen s' L i)); [|now rewrite E].
    destruct L as [n|]; simpl; [destruct (i <? n)|]; auto using at_letter_asked.
  - split; intros HT k A B; [rewrite <- (at_letter_asked p s s') | rewrite (at_letter_asked p s s')]; auto.
  - now rewrite (IHp s s').
  - split; intros HT k A B; apply (IHp s s'); auto.
  - split; intros HT k A B C; apply (HT k A B); apply (IHp s s'); auto.
  - split; intros (k & A & B & C); exists k; repeat split; auto; apply (IHp s s'); auto.
  - apply H2 in H. destruct H as [H H']. split; intros HT k A; apply (IHp s s'); auto; apply HT;
      eapply first_step_asked; [|exact A| |exact A]; auto.
  - apply H2 in H. destruct H as [H H']. split; intros (k & A & C); exists k; (split; [|apply (IHp s s'); auto]);
      eapply first_step_asked; [|exact A| |exact A]; auto.
  - apply H2 in H. destruct H as [H H']. apply H2 in H. destruct H as [H H''].
    split; intros HT k L' A B; apply (IHp s s'); auto; apply HT;
      [eapply opens_asked; [| |exact A] | eapply segment_asked; [|exact B] |
       eapply opens_asked; [| |exact A] | eapply segment_asked; [|exact B]]; auto.
  - split; intros HT L' A; apply (IHp s s'); auto.
Qed.

(** Every run, with its clocks, satisfies the encoding exactly if it satisfies the property. *)
Theorem encode_correct_online : forall p s t L, timed t L -> anchored p = true -> own_timers p ->
  decided (with_clocks p s t) L -> (sat (encode Episode p) (with_clocks p s t) L 0 <-> satisfies p s t L 0).
Proof.
  intros p s t L Ht HA HO Hd. rewrite (encode_correct p (with_clocks p s t) t L 0 Ht Hd).
  - apply satisfies_asked. intros k a. now apply with_clocks_elsewhere.
  - apply (clocks_right p WholeRun); auto using (tracks_run (with_clocks p s t) L), with_clocks_shown. apply Ht.
Qed.

(** To compute with: what the table of cases has of timed properties. *)
Corollary encode_correct_timed : forall p s t n, passing t -> anchored p = true -> own_timers p ->
  (holds (encode Episode p) (map (with_clocks p s t) (seq 0 n)) = true <-> satisfies p s t (Some n) 0).
Proof.
  intros p s t n Ht HA HO. assert (timed t (Some n)) by (split; [auto | congruence]).
  rewrite <- encode_correct_online by auto using decided_finite. set (e := with_clocks p s t).
  set (w := map e (seq 0 n)).
  assert (Hn : length w = n) by (unfold w; now rewrite map_length, seq_length).
  change (holds (encode Episode p) (skipn 0 w) = true <-> sat (encode Episode p) e (Some n) 0).
  rewrite holds_sat, Hn. apply sat_ext. intros k _ Hk. simpl in Hk. unfold at_step, w.
  rewrite (nth_indep _ no_atom (e 0)) by (rewrite map_length, seq_length; lia). now rewrite map_nth, seq_nth by lia.
Qed.
