(** Programs: what runs on a robot. A program asks atoms and clocks, shows verdicts and sets clocks; it knows no timed
    atom. Certified are monitors; that a program follows its monitor is for [Follows.v] to check.

    Python: [ltlc/semantics/control.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Monitor.

(** * Syntax *)

(** From when a duration counts: this instant, a nanosecond before it, or when the clock was due. *)
Inductive anchor := ThisInstant | JustBefore | WhenDue.
(** The clock [set_clock] is due a duration after that, or never. *)
Record setting := { set_clock : nat; to_be_due : option (anchor * nat) }.
(** With [again], a clock step comes a nanosecond later: the letter changes by itself. *)
Record outcome := { goes_to : nat; settings : list setting; again : bool }.

(** A question is whether an atom of the letter holds, or whether a clock is past its due time. *)
Inductive question := Holds (a : nat) | IsLate (c : nat).
(** Where a state leads: to an outcome, or to a branch, which asks one question. *)
Inductive way := Ends (o : nat) | Asks (b : nat).
Record branch := { asked : question; if_so : way; if_not : way }.

(** What a state shows; where a step leads from it, and where a clock step does, if one can come. *)
Record stance := { shows_verdict : verdict; at_step : way; at_clock_step : option way }.

(** State 0 is the initial one. Clock c is due the c-th of [first_due] after the session has begun, or not at all. *)
Record program := {
  stances : list stance; branches : list branch; outcomes : list outcome; first_due : list (option nat)
}.

(** * Meaning *)

(** By [answers], a way leads to an outcome. *)
Inductive ends (P : program) (answers : question -> bool) : way -> outcome -> Prop :=
| ends_there : forall o x, nth_error (outcomes P) o = Some x -> ends P answers (Ends o) x
| ends_asked : forall b x y, nth_error (branches P) b = Some x ->
    ends P answers (if answers (asked x) then if_so x else if_not x) y -> ends P answers (Asks b) y.

(** What is known between two instants: the state, when each clock is due, and whether a clock step comes next. *)
Record config := { is_in : nat; due : nat -> option nat; restless : bool }.

Definition past_due (c : config) (now k : nat) : bool := match due c k with Some d => d <? now | None => false end.

(** When a clock is due that an outcome sets at [now]. *)
Definition set_due (c : config) (now : nat) (x : setting) : option nat :=
  match to_be_due x with
  | None => None
  | Some (ThisInstant, d) => Some (now + d)
  | Some (JustBefore, d) => Some (now - 1 + d)
  | Some (WhenDue, d) => option_map (plus d) (due c (set_clock x))
  end.

(** What an outcome makes of it: a clock that is not set is due when it was. *)
Definition done (c : config) (now : nat) (x : outcome) : config :=
  {| is_in := goes_to x;
     due := fun k => match find (fun y => set_clock y =? k) (settings x) with
                     | Some y => set_due c now y
                     | None => due c k
                     end;
     restless := again x |}.

Definition answers_at (c : config) (now : nat) (l : letter) (x : question) : bool :=
  match x with Holds a => l a | IsLate k => past_due c now k end.

(** At [now], with the letter l, it goes the way w. *)
Definition reacts (P : program) (c : config) (now : nat) (l : letter) (w : way) (c' : config) : Prop :=
  exists x, ends P (answers_at c now l) w x /\ c' = done c now x.

Section Runs.
  (** The letters and times of a run, with an instant at every nanosecond, and the beginning of the session. *)
  Variables (P : program) (s : stream) (t : times) (began : nat).

  Definition beginning : config :=
    {| is_in := 0;
       due := fun k => match nth_error (first_due P) k with Some (Some d) => Some (began + d) | _ => None end;
       restless := false |}.

  (** An instant is a step if it is the first, or no time has passed since the one before. Else the letter is held, and
      there is a clock step if a clock is late, or the letter changes by itself; or nothing happens. *)
  Definition is_step (k : nat) : bool := match k with 0 => true | S j => t k =? t j end.
  Definition has_come (c : config) (now : nat) : bool :=
    restless c || existsb (past_due c now) (seq 0 (length (first_due P))).

  Definition takes (k : nat) (c c' : config) : Prop := exists x, nth_error (stances P) (is_in c) = Some x /\
    if is_step k then reacts P c (t k) (s k) (at_step x) c' else
    if has_come c (t k)
    then exists w, at_clock_step x = Some w /\ reacts P c (t k) (s k) w c'
    else c' = c.

  (** The program after the first n instants. *)
  Inductive runs : nat -> config -> Prop :=
  | runs_start : runs 0 beginning
  | runs_on : forall k c c', runs k c -> takes k c c' -> runs (S k) c'.

  (** It shows a verdict after the first n instants. *)
  Definition shows_after (n : nat) (v : verdict) : Prop :=
    exists c x, runs n c /\ nth_error (stances P) (is_in c) = Some x /\ shows_verdict x = v.
End Runs.

(** * A program is deterministic *)

Lemma ends_unique : forall P answers w x, ends P answers w x -> forall y, ends P answers w y -> x = y.
Proof.
  induction 1 as [o x Hx | b x z Hx _ IH]; intros y Hy; inversion Hy as [? ? Ho | ? x' ? Hb He]; subst.
  - rewrite Hx in Ho. now injection Ho.
  - rewrite Hx in Hb. injection Hb as <-. auto.
Qed.

Lemma reacts_unique : forall P c now l w c1 c2, reacts P c now l w c1 -> reacts P c now l w c2 -> c1 = c2.
Proof. intros P c now l w c1 c2 (x & Hx & ->) (y & Hy & ->). now rewrite (ends_unique _ _ _ _ Hx _ Hy). Qed.

Theorem runs_unique : forall P s t began n c c', runs P s t began n c -> runs P s t began n c' -> c = c'.
Proof.
  intros P s t began n c c' H. revert c'. induction H as [|k c d Hc IH Hd]; intros c' H'; inversion H' as [|? c2 ? A B];
    subst; auto.
  apply IH in A. subst c2. destruct Hd as (x & Hx & Hd), B as (y & Hy & B). rewrite Hx in Hy. injection Hy as <-.
  destruct (is_step t k); [eapply reacts_unique; eauto|]. destruct (has_come P c (t k)); [|congruence].
  destruct Hd as (w & Hw & Hd), B as (w' & Hw' & B). rewrite Hw in Hw'. injection Hw' as <-. eapply reacts_unique; eauto.
Qed.
