(** Judgements: answers that are worked out within a budget of work, with a memory of what has been found out; and that
    'yes' means what it should ([shows]).

    Python: the methods of [_Checker] in [ltlc/semantics/certificate.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Conditions.

Definition judgement := memory -> bool * memory.
Definition verdict_is (b : bool) : judgement := fun m => (b, m).
Definition both (p q : judgement) : judgement := fun m => let (b, m) := p m in if b then q m else (false, m).
Definition either (p q : judgement) : judgement := fun m => let (b, m) := p m in if b then (true, m) else q m.
Definition all {A} (p : A -> judgement) (xs : list A) : judgement :=
  fold_right (fun x => both (p x)) (verdict_is true) xs.
Definition any {A} (p : A -> judgement) (xs : list A) : judgement :=
  fold_right (fun x => either (p x)) (verdict_is false) xs.

Section Shows.
  Variable meaning : claim -> Prop.

  (** The answer 'yes' of a judgement shows Q, if what is remembered is right. *)
  Definition shows (j : judgement) (Q : Prop) : Prop := forall m b m', j m = (b, m') -> sound meaning m ->
    sound meaning m' /\ (b = true -> Q).

  Lemma shows_some : forall j (P Q : Prop), shows j P -> (P -> Q) -> shows j Q.
  Proof. intros j P Q H HQ m b m' E Hm. destruct (H m b m' E Hm). auto. Qed.

  Lemma verdict_is_shows : forall b (Q : Prop), (b = true -> Q) -> shows (verdict_is b) Q.
  Proof. intros b Q H m b' m' E Hm. injection E as <- <-. auto. Qed.

  Lemma both_shows : forall p q (P Q : Prop), shows p P -> shows q Q -> shows (both p q) (P /\ Q).
  Proof.
    intros p q P Q Hp Hq m b m' H Hm. unfold both in H. destruct (p m) as [b1 m1] eqn:E.
    destruct (Hp _ _ _ E Hm) as [S1 P1]. destruct b1.
    - destruct (Hq _ _ _ H S1) as [S2 Q2]. split; auto.
    - injection H as <- <-. split; auto; congruence.
  Qed.

  Lemma either_shows : forall p q Q, shows p Q -> shows q Q -> shows (either p q) Q.
  Proof.
    intros p q Q Hp Hq m b m' H Hm. unfold either in H. destruct (p m) as [b1 m1] eqn:E.
    destruct (Hp _ _ _ E Hm) as [S1 P1]. destruct b1; [|eapply Hq; eauto]. injection H as <- <-. split; auto.
  Qed.

  Lemma all_shows : forall {A} (p : A -> judgement) (Q : A -> Prop) xs, (forall x, shows (p x) (Q x)) ->
    shows (all p xs) (forall x, In x xs -> Q x).
  Proof.
    intros A p Q xs Hp. induction xs as [|x xs IH]; [apply verdict_is_shows; intros _ x []|].
    eapply shows_some; [apply both_shows; [apply Hp | apply IH]|]. intros [H1 H2] y [<-|Hy]; auto.
  Qed.

  Lemma any_shows : forall {A} (p : A -> judgement) (Q : A -> Prop) xs, (forall x, shows (p x) (Q x)) ->
    shows (any p xs) (exists x, In x xs /\ Q x).
  Proof.
    intros A p Q xs Hp. induction xs as [|x xs IH]; [apply verdict_is_shows; discriminate|]. apply either_shows.
    - eapply shows_some; [apply Hp|]. intros H. exists x. simpl. auto.
    - eapply shows_some; [apply IH|]. intros (y & A1 & A2). exists y. simpl. auto.
  Qed.

  Hypothesis meaning_equivalent : forall c d, meaning (Equivalent c d) <-> same c d.

  Lemma equivalent_shows : forall depth c d, shows (equivalent depth c d) (same c d).
  Proof. intros depth c d m b m'. now apply equivalent_sound. Qed.
  Lemma follows_shows : forall depth c d, shows (follows depth c d) (forall P, decides P -> true_in P c -> true_in P d).
  Proof. intros depth c d m b m'. now apply follows_sound. Qed.
End Shows.

(** * Conditions on a letter *)

(** Models that read the atoms of the current step in a letter. *)
Definition reads (P : model) (l : letter) : Prop := decides P /\ forall a, P (AtStep a) <-> l a = true.
Definition model_of (l : letter) : model := fun x => match x with AtStep a => l a = true | FromNext _ => False end.

Lemma model_of_reads : forall l, reads (model_of l) l.
Proof. intros l. split; [intros [a|f]; simpl; [destruct (l a); auto | auto] | simpl; tauto]. Qed.

Lemma model_at_reads : forall s L i, decided s L -> reads (model_at s L i) (s i).
Proof. intros s L i Hd. split; [now apply model_at_decides | simpl; tauto]. Qed.

Lemma predicate_true : forall P l, reads P l -> forall p, true_in P (unfold (as_formula p)) <-> at_letter p l = true.
Proof.
  intros P l [HP Ha]. induction p; simpl unfold; simpl at_letter.
  - simpl; tauto.
  - apply Ha.
  - rewrite negation_true, IHp by auto. destruct (at_letter p l); simpl; split; congruence.
  - now rewrite conjunction_true, IHp1, IHp2, andb_true_iff by auto.
  - now rewrite disjunction_true, IHp1, IHp2, orb_true_iff by auto.
Qed.

(** The condition is true of the letter, whatever comes after it. *)
Definition lets (l : letter) (c : condition) : Prop := forall P, reads P l -> true_in P c.

Lemma lets_predicate : forall l p, at_letter p l = true -> lets l (unfold (as_formula p)).
Proof. intros l p H P HP. now apply (predicate_true P l). Qed.

(** The letters of [ctx] that satisfy p; where there are none, there is nothing to judge. *)
Definition narrowed (ctx : condition) (p : predicate) (judge : condition -> judgement) : judgement := fun m =>
  let c := conjunction ctx (unfold (as_formula p)) in
  match spend (weight c) m with
  | None => (false, m)
  | Some m => match c with Constant false => (true, m) | _ => judge c m end
  end.

Lemma narrowed_shows : forall meaning ctx p judge Q, (forall c, shows meaning (judge c) (Q c)) ->
  shows meaning (narrowed ctx p judge)
    (forall l, lets l ctx -> at_letter p l = true -> exists c, lets l c /\ Q c).
Proof.
  intros meaning ctx p judge Q HJ m b m' H Hm. unfold narrowed in H.
  set (c := conjunction ctx (unfold (as_formula p))) in *.
  assert (HL : forall l, lets l ctx -> at_letter p l = true -> lets l c).
  { intros l H1 H2 P HP. unfold c. apply conjunction_true.
    split; [now apply H1 | now apply (predicate_true P l)]. }
  destruct (spend (weight c) m) as [m1|] eqn:Es; [|injection H as <- <-; split; auto; congruence].
  apply (spend_sound meaning) in Es; auto.
  assert (HC : c = Constant false \/ judge c m1 = (b, m')) by (destruct c as [[]| | | |]; auto).
  destruct HC as [HC|HC].
  - rewrite HC in *. injection H as <- <-. split; auto. intros _ l H1 H2. specialize (HL l H1 H2 _ (model_of_reads l)).
    discriminate HL.
  - destruct (HJ c m1 b m' HC Es) as [S1 Q1]. split; auto. intros Hb l H1 H2. eauto.
Qed.
