(** What is proved of the verdicts that a program shows: by a certificate of its monitor, and by the pairs in which it
    follows that. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Clocks Encodings Monitor Certificate Infinite InTime Program Follows.

(** * Without time, each instant is a step *)
Section Untimed.
  Variables (depth work depth' work' : nat) (C : certificate) (P : program) (pairs : list pair).
  Hypothesis certificate_accepted : check depth work C = true.
  Hypothesis program_accepted : follows_monitor depth' work' (assumption C) (machine C) P pairs = true.
  Hypothesis episode : encoded_by C = Episode.
  Hypothesis no_bounds : unbounded (subject C) = true.
  Hypothesis no_past : defined C = [].
  Hypothesis no_news : news C = [].

  Theorem shown_untimed : forall s began n, allowed_for C s n -> exists v,
    shows_after P s (fun _ => 0) began n v /\
    right_verdict (goes_on_as C s n) (meets_always C) (meets_so_far C s n) v.
  Proof.
    intros s began n Hs.
    destruct (certified_untimed depth work C certificate_accepted episode no_bounds no_past no_news s n Hs)
      as (q & v & H1 & H2 & H3).
    destruct (follows_monitor_sound _ _ _ _ _ _ program_accepted s began n Hs) as (q' & v' & A1 & A2 & A3).
    rewrite (reaches_unique _ _ _ _ _ A1 H1) in A2. exists v. split; [congruence | exact H3].
  Qed.

  Theorem shown_exactly_untimed : exact C = true -> forall s began n, allowed_for C s n -> exists v,
    shows_after P s (fun _ => 0) began n v /\
    exact_verdict (goes_on_as C s n) (meets_always C) (meets_so_far C s n) v.
  Proof.
    intros HE s began n Hs.
    destruct (certified_exactly_untimed depth work C certificate_accepted episode no_bounds no_past no_news HE s n Hs)
      as (q & v & H1 & H2 & H3).
    destruct (follows_monitor_sound _ _ _ _ _ _ program_accepted s began n Hs) as (q' & v' & A1 & A2 & A3).
    rewrite (reaches_unique _ _ _ _ _ A1 H1) in A2. exists v. split; [congruence | exact H3].
  Qed.
End Untimed.
