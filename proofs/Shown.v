(** What is proved of the verdicts that a program shows: by a certificate of its monitor, and by the pairs in which it
    follows that. A run has an instant at every nanosecond; the program takes its steps, and its clock steps. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Clocks Registers Encodings Trackers Resets Monitor Conditions Machines Certificate Infinite InTime
  Program Follows Followed.

Section Shown.
  Variables (depth work depth' work' : nat) (C : certificate) (P : program) (pairs : list pair).
  Hypothesis certificate_accepted : check depth work C = true.
  Hypothesis program_accepted :
    follows_monitor depth' work' (news C) (trackers C) (assumption C) (machine C) P pairs = true.
  Hypothesis episode : encoded_by C = Episode.

  (** * In time *)
  Section InTime.
    Hypothesis has_clocks : is_trivial (news C) (trackers C) = false.
    Variable began : nat.
    Let M := machine C.

    Lemma only_decided : forall s t k a, is_decided (trackers C) a = false -> word_of C began s t k a = s k a.
    Proof.
      intros s t k a Ha. pose proof (is_proper depth work C certificate_accepted) as HP.
      destruct (existsb (Nat.eqb a) (news C)) eqn:EN.
      - apply existsb_exists in EN. destruct EN as (b & Hb & E). apply Nat.eqb_eq in E. subst b.
        destruct (news_of_letters _ _ _ (proper_atoms _ _ _ HP) a Hb) as [N1 N2].
        unfold word_of. rewrite timed_word_elsewhere by exact N2. apply with_past_elsewhere.
        intros c o Ho ->. now apply (N1 o).
      - apply (untimed_same depth work C certificate_accepted began s t (PAtom a) k). simpl. unfold timed_atom.
        now rewrite EN.
    Qed.

    Lemma shows_the_monitors : forall s t, is_run C began (s, t) -> forall n, exists r v,
      reaches M (word_of C began s t) n r /\ nth_error (verdicts M) r = Some v /\ shows_after P s t began n v.
    Proof.
      intros s t [HO HA] n. pose proof (is_proper depth work C certificate_accepted) as HP. simpl in HO, HA.
      pose proof (proper_trackers _ _ _ HP has_clocks) as HX. pose proof (proper_atoms _ _ _ HP) as HN.
      apply (followed_sound _ _ _ _ _ _ _ _ program_accepted s (word_of C began s t) t began n); auto.
      - apply HO.
      - apply HO.
      - intros x Hx. now apply (trackers_well_formed _ _ _ _ HX HN).
      - apply (outer_first _ _ _ _ HX).
      - intros k a. apply only_decided.
      - intros k Hk. split; auto. now apply (word_held _ _ _ _ HX HN _ _ _ HO).
    Qed.

    Lemma reads_all : forall s t n, reading (word_of C began s t) t (fun k => k) n.
    Proof. intros s t n. split; intros; try lia; try reflexivity. now replace k with j by lia. Qed.

    Theorem shown : forall s t, is_run C began (s, t) -> forall n, exists v, shows_after P s t began n v /\
      right_verdict (goes_on C began (s, t) n) (meets_up_to C began None) (meets_up_to C began (Some n) (s, t)) v.
    Proof.
      intros s t HS n. destruct (shows_the_monitors s t HS n) as (r & v & H1 & H2 & H3). exists v. split; auto.
      destruct (certified depth work C certificate_accepted episode began s t (fun k => k) n HS (reads_all s t n))
        as (q & u & B1 & B2 & B3).
      rewrite (reaches_unique _ _ _ _ _ B1 H1) in B2. fold M in B2. rewrite H2 in B2. now injection B2 as <-.
    Qed.
  End InTime.

  (** * Without time, each instant is a step *)
  Section Untimed.
    Hypothesis no_bounds : unbounded (subject C) = true.
    Hypothesis no_past : defined C = [].
    Hypothesis no_news : news C = [].

    Lemma shows_the_monitors_untimed : forall s began n, allowed_for C s n -> exists r v,
      reaches (machine C) s n r /\ nth_error (verdicts (machine C)) r = Some v /\ shows_after P s (fun _ => 0) began n v.
    Proof.
      intros s began n HA. pose proof program_accepted as HP. rewrite no_news, no_trackers in HP by auto.
      apply (followed_sound _ _ _ _ _ _ _ _ HP s s (fun _ => 0) began n); auto.
      - intros i k _. lia.
      - intros x [].
      - exact I.
      - intros k H. lia.
    Qed.

    Theorem shown_untimed : forall s began n, allowed_for C s n -> exists v,
      shows_after P s (fun _ => 0) began n v /\
      right_verdict (goes_on_as C s n) (meets_always C) (meets_so_far C s n) v.
    Proof.
      intros s began n Hs. destruct (shows_the_monitors_untimed s began n Hs) as (r & v & H1 & H2 & H3).
      destruct (certified_untimed depth work C certificate_accepted episode no_bounds no_past no_news s n Hs)
        as (q & u & B1 & B2 & B3).
      rewrite (reaches_unique _ _ _ _ _ B1 H1), H2 in B2. injection B2 as <-. eauto.
    Qed.

    Theorem shown_exactly_untimed : exact C = true -> forall s began n, allowed_for C s n -> exists v,
      shows_after P s (fun _ => 0) began n v /\
      exact_verdict (goes_on_as C s n) (meets_always C) (meets_so_far C s n) v.
    Proof.
      intros HE s began n Hs. destruct (shows_the_monitors_untimed s began n Hs) as (r & v & H1 & H2 & H3).
      destruct (certified_exactly_untimed depth work C certificate_accepted episode no_bounds no_past no_news HE s n Hs)
        as (q & u & B1 & B2 & B3).
      rewrite (reaches_unique _ _ _ _ _ B1 H1), H2 in B2. injection B2 as <-. eauto.
    Qed.
  End Untimed.
End Shown.
