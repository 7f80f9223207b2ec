(** Monitors: complete, deterministic Moore machines whose guards are shared decision diagrams, and their verdicts.

    Python: [ltlc/semantics/verdicts.py], [monitor.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl.

Inductive verdict := Violated | PresumablyViolated | PresumablySatisfied | Satisfied.

(** Where an edge leads: to a state, or to a decision, which asks one atom of the letter. *)
Inductive target := State (q : nat) | Ask (d : nat).
Record decision := { atom : nat; low : target; high : target }.

(** State 0 is the initial one. *)
Record monitor := { verdicts : list verdict; edges : list target; decisions : list decision }.

(** The letter [l] leads from a target to a state. *)
Inductive leads (M : monitor) (l : letter) : target -> nat -> Prop :=
| leads_state : forall q, leads M l (State q) q
| leads_ask : forall d a q, nth_error (decisions M) d = Some a ->
    leads M l (if l (atom a) then high a else low a) q -> leads M l (Ask d) q.

(** The state after the first n letters of [s]. *)
Inductive reaches (M : monitor) (s : stream) : nat -> nat -> Prop :=
| reaches_start : reaches M s 0 0
| reaches_step : forall n q t q', reaches M s n q -> nth_error (edges M) q = Some t -> leads M (s n) t q' ->
    reaches M s (S n) q'.

Lemma leads_unique : forall M l t q, leads M l t q -> forall q', leads M l t q' -> q = q'.
Proof.
  induction 1 as [q | d a q H1 H2 IH]; intros q' H'; inversion H' as [| ? a' ? E1 E2]; subst; auto.
  rewrite H1 in E1. injection E1 as <-. auto.
Qed.

(** A monitor is deterministic: there is one state after a run. *)
Theorem reaches_unique : forall M s n q q', reaches M s n q -> reaches M s n q' -> q = q'.
Proof.
  intros M s n q q' H. revert q'. induction H as [| n q t r _ IH Ht Hl]; intros q' H'; inversion H' as [| ? q2 t2 ? A B C]; subst; auto.
  apply IH in A. subst q2. rewrite Ht in B. injection B as <-. eapply leads_unique; eauto.
Qed.

(** It reads what atoms are. *)
Lemma leads_same : forall M l l' t q, (forall a, l a = l' a) -> leads M l t q -> leads M l' t q.
Proof. intros M l l' t q H. induction 1 as [|d a q HD _ IH]; [constructor|]. econstructor; [exact HD|]. now rewrite <- H. Qed.
Lemma reaches_same : forall M s s' n q, (forall k a, k < n -> s k a = s' k a) -> reaches M s n q -> reaches M s' n q.
Proof.
  intros M s s' n q H HR. induction HR as [|n q t r _ IH HT HL]; [constructor|]. econstructor; [|exact HT|].
  - apply IH. intros k a Hk. apply H. lia.
  - apply (leads_same M (s n)); auto.
Qed.
