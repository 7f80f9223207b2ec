(** Decision diagrams, as trees: what a guard's region says of the conditions that are held. *)
From Coq Require Import List Bool.
Import ListNotations.
Require Import Ltl Properties.

Section Diagrams.
  Context {X : Type}.
  Hypothesis eq_dec : forall x y : X, {x = y} + {x <> y}.

  Inductive diagram := Value (b : bool) | If (x : X) (yes no : diagram).

  Fixpoint at_values (d : diagram) (v : X -> bool) : bool :=
    match d with Value b => b | If x yes no => if v x then at_values yes v else at_values no v end.

  Definition variable (x : X) : diagram := If x (Value true) (Value false).
  Definition is_false (d : diagram) : bool := match d with Value false => true | _ => false end.

  (** A question whose answer changes nothing is not asked. *)
  Definition choose (x : X) (yes no : diagram) : diagram :=
    match yes, no with
    | Value true, Value true => Value true
    | Value false, Value false => Value false
    | _, _ => If x yes no
    end.
  Fixpoint given (x : X) (b : bool) (d : diagram) : diagram :=
    match d with
    | Value _ => d
    | If y yes no => if eq_dec x y then given x b (if b then yes else no) else choose y (given x b yes) (given x b no)
    end.
  Fixpoint negated (d : diagram) : diagram :=
    match d with Value b => Value (negb b) | If x yes no => If x (negated yes) (negated no) end.
  (** No path asks twice for the same, if none of d does: so nothing satisfies the result only if it is [Value false]. *)
  Fixpoint meet (d e : diagram) : diagram :=
    match d, e with
    | Value b, _ => if b then e else d
    | _, Value b => if b then d else e
    | If x yes no, _ => choose x (meet yes (given x true e)) (meet no (given x false e))
    end.
  Definition join (d e : diagram) : diagram := negated (meet (negated d) (negated e)).

  Lemma choose_at : forall x yes no v, at_values (choose x yes no) v = if v x then at_values yes v else at_values no v.
  Proof. intros x [[]|] [[]|] v; simpl; destruct (v x); reflexivity. Qed.
  Lemma given_at : forall x b d v, v x = b -> at_values (given x b d) v = at_values d v.
  Proof.
    intros x b d v H. induction d as [|y yes IHy no IHn]; auto. simpl. destruct (eq_dec x y) as [<-|].
    - rewrite H. destruct b; auto.
    - now rewrite choose_at, IHy, IHn.
  Qed.
  Lemma negated_at : forall d v, at_values (negated d) v = negb (at_values d v).
  Proof. induction d as [|x yes IHy no IHn]; intros v; simpl; auto. destruct (v x); auto. Qed.
  Lemma meet_at : forall d e v, at_values (meet d e) v = at_values d v && at_values e v.
  Proof.
    induction d as [[]|x yes IHy no IHn]; intros e v; auto. destruct e as [[]|y f g].
    - simpl. now rewrite andb_true_r.
    - simpl. now rewrite andb_false_r.
    - unfold meet; fold meet. rewrite choose_at, IHy, IHn. change (at_values (If x yes no) v) with
        (if v x then at_values yes v else at_values no v).
      destruct (v x) eqn:E; now rewrite given_at.
  Qed.
  Lemma join_at : forall d e v, at_values (join d e) v = at_values d v || at_values e v.
  Proof. intros. unfold join. now rewrite negated_at, meet_at, !negated_at, negb_andb, !negb_involutive. Qed.
  Lemma is_false_at : forall d v, is_false d = true -> at_values d v = false.
  Proof. intros [[]|] v H; auto; discriminate. Qed.

  (** Whether [c] entails [d]. *)
  Definition entails (c d : diagram) : bool := is_false (meet c (negated d)).
  Lemma entails_at : forall c d v, entails c d = true -> at_values c v = true -> at_values d v = true.
  Proof.
    intros c d v H Hc. apply (is_false_at _ v) in H. rewrite meet_at, negated_at, Hc in H. now apply negb_false_iff in H.
  Qed.
End Diagrams.

Arguments diagram : clear implicits.

(** What is put in for each variable. *)
Section Put.
  Context {X Y : Type} (eq_dec : forall x y : Y, {x = y} + {x <> y}) (g : X -> diagram Y).
  Fixpoint put (d : diagram X) : diagram Y :=
    match d with
    | Value b => Value b
    | If x yes no => join eq_dec (meet eq_dec (g x) (put yes)) (meet eq_dec (negated (g x)) (put no))
    end.
  Lemma put_at : forall d v w, (forall x, at_values (g x) v = w x) -> at_values (put d) v = at_values d w.
  Proof.
    intros d v w H. induction d as [|x yes IHy no IHn]; simpl; auto.
    rewrite join_at, !meet_at, negated_at, IHy, IHn, H. destruct (w x); simpl; auto using orb_false_r.
  Qed.
  Fixpoint put_predicate (at_ : nat -> diagram Y) (p : predicate) : diagram Y :=
    match p with
    | PTruth => Value true
    | PAtom a => at_ a
    | PNot p => negated (put_predicate at_ p)
    | PAnd p q => meet eq_dec (put_predicate at_ p) (put_predicate at_ q)
    | POr p q => join eq_dec (put_predicate at_ p) (put_predicate at_ q)
    end.
  Lemma put_predicate_at : forall at_ p v l, (forall a, at_values (at_ a) v = l a) ->
    at_values (put_predicate at_ p) v = at_letter p l.
  Proof.
    intros at_ p v l H. induction p; simpl; auto.
    - now rewrite negated_at, IHp.
    - now rewrite meet_at, IHp1, IHp2.
    - now rewrite join_at, IHp1, IHp2.
  Qed.
End Put.
