(** What is proved of infinite words. The only file with an axiom: the law of excluded middle, as in [Classical]. *)
From Coq Require Import List Arith Lia Bool Classical.
Import ListNotations.
Require Import Ltl Properties Encodings Clocks Monitor Conditions Certificate.

Theorem decided_infinite : forall s, decided s None.
Proof. intros s f i. apply classic. Qed.

Theorem encode_correct_infinite : forall p s t, timed t None -> right p s t None 0 ->
  (sat (encode Episode p) s None 0 <-> satisfies p s t None 0).
Proof. intros p s t Ht. apply encode_correct; auto using decided_infinite. Qed.

(** * The verdict of a run (Bauer, Leucker, Schallhart 2010), of any meaning [meets] that words can have. *)
Section Verdicts.
  Variables (C : certificate) (meets : stream -> option nat -> Prop) (w : list letter).

  Definition presumed (v : verdict) : Prop :=
    match v with
    | PresumablySatisfied => meets (at_step w) (Some (length w))
    | PresumablyViolated => ~ meets (at_step w) (Some (length w))
    | _ => False
    end.

  (** What a verdict claims. *)
  Definition right_verdict (v : verdict) : Prop :=
    match v with
    | Violated => forall s, continues C w s -> ~ meets s None
    | Satisfied => forall s, continues C w s -> meets s None
    | _ => presumed v
    end.

  (** And that it is permanent if it can be. *)
  Definition exact_verdict (v : verdict) : Prop :=
    right_verdict v /\
    (presumed v -> (exists s, continues C w s /\ meets s None) /\ (exists s, continues C w s /\ ~ meets s None)).
End Verdicts.

Lemma right_verdict_ext : forall C m m' w v, (forall s L, m s L <-> m' s L) -> right_verdict C m w v -> right_verdict C m' w v.
Proof.
  intros C m m' w v E H. destruct v; simpl in *.
  - intros s Hs Hm. apply (H s Hs). now apply E.
  - now rewrite <- E.
  - now rewrite <- E.
  - intros s Hs. apply E. auto.
Qed.

Lemma exact_verdict_ext : forall C m m' w v, (forall s L, m s L <-> m' s L) -> exact_verdict C m w v -> exact_verdict C m' w v.
Proof.
  intros C m m' w v E [H1 H2]. split; [eapply right_verdict_ext; eauto|].
  intros Hp. assert (Hp' : presumed m w v) by (destruct v; simpl in *; auto; now rewrite E).
  destruct (H2 Hp') as [(s1 & A1 & B1) (s2 & A2 & B2)].
  split; [exists s1 | exists s2]; rewrite <- E; auto.
Qed.

(** A claim that speaks of something: no run is both, because it has a continuation. *)
Theorem certified_of_something : forall depth work C m w, check depth work C = true -> run_allowed C w ->
  ~ (right_verdict C m w Violated /\ right_verdict C m w Satisfied).
Proof.
  intros depth work C m w HC Hw [H1 H2]. destruct (check_continues depth work C HC w Hw) as [s Hs].
  exact (H1 s Hs (H2 s Hs)).
Qed.

Section Main.
  Variables (depth work : nat) (C : certificate).
  Hypothesis HC : check depth work C = true.
  Let M := machine C.
  Let core (s : stream) (L : option nat) : Prop := sat (encode (encoded_by C) (subject C)) s L 0.
  Let language (s : stream) (L : option nat) : Prop := satisfies (subject C) s no_times L 0.

  (** The monitor's verdict after every run is right for the encoded formula. *)
  Theorem check_sound : forall w, run_allowed C w -> exists q v,
    reaches M (at_step w) (length w) q /\ nth_error (verdicts M) q = Some v /\ right_verdict C core w v.
  Proof.
    intros w Hw. destruct (check_finite depth work C HC w Hw) as (q & v & H1 & H2 & H3 & H4). exists q, v.
    split; auto. split; auto.
    assert (HP : forall s, continues C w s -> (v = Violated -> ~ core s None) /\ (v = Satisfied -> core s None)).
    { intros s Hs. destruct (check_permanent depth work C HC w q s Hw H1 (decided_infinite s) Hs) as [P1 P2].
      split; intros ->; [apply P1 | apply P2]; exact H2. }
    pose proof (holds_sat (encode (encoded_by C) (subject C)) w 0) as HW. simpl skipn in HW.
    destruct v; simpl; unfold core in *; try rewrite <- HW; auto.
    - intros s Hs. now apply HP.
    - rewrite H4 by auto. congruence.
    - intros s Hs. now apply HP.
  Qed.

  (** With [exact], it is the verdict. *)
  Theorem check_exactly : exact C = true -> forall w, run_allowed C w -> exists q v,
    reaches M (at_step w) (length w) q /\ nth_error (verdicts M) q = Some v /\ exact_verdict C core w v.
  Proof.
    intros HE w Hw. destruct (check_sound w Hw) as (q & v & H1 & H2 & H3). exists q, v. repeat split; auto;
      apply (check_exact depth work C HC w q v decided_infinite HE Hw H1 H2); destruct v; simpl in *; tauto.
  Qed.

  (** And for the default encoding, that of the property itself, as the language defines it. Without bounds, no time is read. *)
  Hypothesis episode : encoded_by C = Episode.
  Hypothesis no_bounds : unbounded (subject C) = true.

  Lemma core_is_language : forall s L, core s L <-> language s L.
  Proof.
    intros s L. unfold core, language. rewrite episode. apply encode_correct; auto using unbounded_right, no_times_timed.
    destruct L; [apply decided_finite | apply decided_infinite].
  Qed.

  Theorem certified : forall w, run_allowed C w -> exists q v,
    reaches M (at_step w) (length w) q /\ nth_error (verdicts M) q = Some v /\ right_verdict C language w v.
  Proof.
    intros w Hw. destruct (check_sound w Hw) as (q & v & H1 & H2 & H3). exists q, v. repeat split; auto.
    eapply right_verdict_ext; eauto. apply core_is_language.
  Qed.

  Theorem certified_exactly : exact C = true -> forall w, run_allowed C w -> exists q v,
    reaches M (at_step w) (length w) q /\ nth_error (verdicts M) q = Some v /\ exact_verdict C language w v.
  Proof.
    intros HE w Hw. destruct (check_exactly HE w Hw) as (q & v & H1 & H2 & H3). exists q, v. repeat split; auto;
      eapply exact_verdict_ext; eauto; apply core_is_language.
  Qed.
End Main.
