(** What is proved of infinite words. This file is the only one that uses an axiom, the law of excluded middle, as in
    [Classical]; what rests on it is here and in [InTime.v]. *)
From Coq Require Import List Arith Lia Bool Classical.
Import ListNotations.
Require Import Ltl Properties Encodings Clocks Registers Resets Monitor Conditions Machines Distribute Certificate.

Theorem decided_infinite : forall s, decided s None.
Proof. intros s f i. apply classic. Qed.

Theorem encode_correct_infinite : forall p s t, timed t None -> right p s t None 0 ->
  (sat (encode Episode p) s None 0 <-> satisfies p s t None 0).
Proof. intros p s t Ht. apply encode_correct; auto using decided_infinite. Qed.

(** * The verdict of a run (Bauer, Leucker, Schallhart 2010): of what it is so far, and of all that it can become. *)
Section Verdicts.
  Context {X : Type}.
  Variables (continuation meets : X -> Prop) (so_far : Prop).

  Definition presumed (v : verdict) : Prop :=
    match v with PresumablySatisfied => so_far | PresumablyViolated => ~ so_far | _ => False end.

  (** What a verdict claims. *)
  Definition right_verdict (v : verdict) : Prop :=
    match v with
    | Violated => forall x, continuation x -> ~ meets x
    | Satisfied => forall x, continuation x -> meets x
    | _ => presumed v
    end.

  (** Both outcomes are still possible. *)
  Definition undecided : Prop := (exists x, continuation x /\ meets x) /\ (exists x, continuation x /\ ~ meets x).
  (** The verdict is right, and permanent if it can be. *)
  Definition exact_verdict (v : verdict) : Prop := right_verdict v /\ (presumed v -> undecided).
End Verdicts.

(** No run that has a continuation is both violated and satisfied. *)
Theorem never_both : forall X (continuation meets : X -> Prop) so_far x, continuation x ->
  ~ (right_verdict continuation meets so_far Violated /\ right_verdict continuation meets so_far Satisfied).
Proof. intros X continuation meets so_far x Hx [H1 H2]. exact (H1 x Hx (H2 x Hx)). Qed.

(** * Of every encoding, over the words of the machine *)
Section Words.
  Variables (depth work : nat) (C : certificate).
  Hypothesis HC : check depth work C = true.
  Let M := machine C.

  (** The first n letters of a word, all allowed, with the states of the machine on the way. *)
  Definition begins (s : stream) (path : nat -> clocks) (n : nat) : Prop :=
    path_of (news C) (trackers C) (assumption C) s path n.
  Definition holds_for_ever (s : stream) : Prop := sat (formula_of C) s None 0.

  (** The monitor's verdict is right for the encoded formula. *)
  Theorem check_sound : forall s path n, begins s path n -> exists q v,
    reaches M s n q /\ nth_error (verdicts M) q = Some v /\
    right_verdict (continues C s n) holds_for_ever (sat (formula_of C) s (Some n) 0) v.
  Proof.
    intros s path n Hw. destruct (check_finite depth work C HC s path n Hw) as (q & v & H1 & H2 & H3 & H4). exists q, v.
    split; auto. split; auto.
    assert (HP : forall s', continues C s n s' ->
              (v = Violated -> ~ holds_for_ever s') /\ (v = Satisfied -> holds_for_ever s')).
    { intros s' Hs. destruct (check_permanent depth work C HC s n q s' H1 (decided_infinite s') Hs) as [P1 P2].
      split; intros ->; [apply P1 | apply P2]; exact H2. }
    destruct v; simpl; auto; intros s' Hs; now apply (HP s' Hs).
  Qed.

  (** With [exact], it is the verdict. *)
  Theorem check_exactly : exact C = true -> forall s path n, begins s path n -> exists q v,
    reaches M s n q /\ nth_error (verdicts M) q = Some v /\
    exact_verdict (continues C s n) holds_for_ever (sat (formula_of C) s (Some n) 0) v.
  Proof.
    intros HE s path n Hw. destruct (check_sound s path n Hw) as (q & v & H1 & H2 & H3). exists q, v.
    split; auto. split; auto. split; auto. intros HP.
    apply (check_exact depth work C HC s path n q v decided_infinite HE Hw H1 H2). destruct v; simpl in HP; tauto.
  Qed.
End Words.
