(** A guard: a filter between a controller and what it commands, as a game between it and all else. Where it may rest, no
    kept property is violated, and whatever comes, it can come to rest again ([never_at_a_loss], [in_time]); it is not
    drawn into sending for ever ([few_are_sent], [time_goes_on]); and it changes only what has to be changed ([necessary]).

    A state is all that decides what can come: where each property is, and what is held. Python:
    [ltlc/analysis/guards]. *)
From Coq Require Import Arith Lia.

Section Game.
  Variables (state fallback : Type).
  (** Clocks that pass a bound together, or those that a fallback neither stops nor starts anew. *)
  Variables (clock some : Type) (among : clock -> some -> Prop).

  Variable beginning : state -> Prop.
  Variable message : state -> state -> Prop.              (* on another topic than the guard's *)
  Variable command : state -> state -> Prop.              (* the controller's is let through *)
  Variable passes : some -> state -> state -> Prop.       (* a nanosecond: these clocks pass a bound, no other *)
  Variable sends : fallback -> some -> state -> state -> Prop.  (* a fallback, which leaves these clocks alone *)
  Variable may_send : fallback -> state -> Prop.
  Variable bad : state -> Prop.                           (* a kept property is violated *)

  (** Where the guard may rest, where it answers at once, and where it acts before some clocks pass. *)
  Record region := {
    rests : state -> Prop;
    answers : fallback -> state -> Prop;
    acts : some -> fallback -> state -> Prop
  }.
  Variable R : region.

  Definition answered (x : state) : Prop := rests R x \/ exists f, answers R f x.

  (** What a region has to be. *)
  Record closed : Prop := {
    begins_at_rest : forall x, beginning x -> rests R x;
    rests_well : forall x, rests R x -> ~ bad x;
    answers_well : forall x f, answers R f x -> ~ bad x /\ may_send f x;
    answers_lead : forall x f e y, answers R f x -> sends f e x y -> rests R y;
    messages_answered : forall x y, rests R x -> message x y -> answered y;
    time_answered : forall x y d, rests R x -> passes d x y ->
      answered y \/ (exists c, among c d) /\ exists f, acts R d f x;
    acts_may : forall x d f, acts R d f x -> may_send f x;
    acts_lead : forall x d f e y, acts R d f x -> sends f e x y -> rests R y /\
      forall d' z c, passes d' y z -> among c d -> among c e -> among c d' -> answered z
  }.

  (** ** What leaves the guard *)

  (** What comes by itself; and every step. *)
  Definition comes (x y : state) : Prop := message x y \/ exists d, passes d x y.
  Definition steps (x y : state) : Prop := comes x y \/ command x y \/ exists f e, sends f e x y.
  Hypothesis bad_for_ever : forall x y, steps x y -> bad x -> bad y.

  (** [guarded x n]: the states of a run, n steps long, at whose end the guard rests. It lets through, or sends, only that
      after which it may rest; when something else comes after which it may not, it answers. *)
  Inductive guarded (x : nat -> state) : nat -> Prop :=
  | nothing_yet : beginning (x 0) -> guarded x 0
  | goes_by n : guarded x n -> steps (x n) (x (S n)) -> rests R (x (S n)) -> guarded x (S n)
  | is_answered n f e : guarded x n -> comes (x n) (x (S n)) -> sends f e (x (S n)) (x (S (S n))) ->
      rests R (x (S (S n))) -> guarded x (S (S n)).

  Lemma guarded_steps : forall x n, guarded x n -> beginning (x 0) /\ forall m, m < n -> steps (x m) (x (S m)).
  Proof.
    intros x n H. induction H as [H | n H [B IH] HS HR | n f e H [B IH] HC HS HR]; split; auto; intros m Hm; [lia| |].
    - destruct (Nat.eq_dec m n) as [->|]; auto. apply IH. lia.
    - destruct (Nat.eq_dec m (S n)) as [->|]; [right; right; eauto|].
      destruct (Nat.eq_dec m n) as [->|]; [now left|]. apply IH. lia.
  Qed.

  (** Nothing is ever violated, not even between a message and its answer. *)
  Theorem guarded_well : closed -> forall x n, guarded x n -> rests R (x n) /\ forall m, m <= n -> ~ bad (x m).
  Proof.
    intros HC x n H. pose proof (guarded_steps x n H) as [_ HS].
    assert (HR : rests R (x n)) by (destruct H; auto; now apply (begins_at_rest HC)).
    split; auto. assert (HB : forall k m, m + k = n -> ~ bad (x m)).
    { induction k as [|k IH]; intros m Hm HB; [replace m with n in HB by lia; now apply (rests_well HC (x n))|].
      apply (IH (S m) ltac:(lia)). apply (bad_for_ever (x m)); auto. apply HS. lia. }
    intros m Hm. apply (HB (n - m)). lia.
  Qed.

  (** Whatever message comes, the guard may rest after it, or has an answer after which it may. *)
  Theorem never_at_a_loss : closed -> forall x n y, guarded x n -> message (x n) y ->
    rests R y \/ exists f, may_send f y /\ forall e z, sends f e y z -> rests R z.
  Proof.
    intros HC x n y HG HM. destruct (guarded_well HC x n HG) as [HR _].
    destruct (messages_answered HC _ _ HR HM) as [H|(f & H)]; auto. right. exists f. split.
    - now apply (answers_well HC y f).
    - intros e z. now apply (answers_lead HC y f).
  Qed.
  (** So it is when time goes on; or else a clock passes a bound, and it can act before. Then it may rest, and when one of
      these clocks passes that the act left alone, there is an answer without a second act. *)
  Theorem in_time : closed -> forall x n y d, guarded x n -> passes d (x n) y ->
    answered y \/ (exists c, among c d) /\ exists f, may_send f (x n) /\ forall e z, sends f e (x n) z -> rests R z /\
      forall d' z' c, passes d' z z' -> among c d -> among c e -> among c d' -> answered z'.
  Proof.
    intros HC x n y d HG HP. destruct (guarded_well HC x n HG) as [HR _].
    destruct (time_answered HC _ _ _ HR HP) as [H|(H & f & HA)]; auto. right. split; auto. exists f. split.
    - now apply (acts_may HC _ d).
    - intros e z. now apply (acts_lead HC).
  Qed.

  (** ** Time goes on

      A run in which the guard sends only what the region says, and acts once before something else comes. [acted]: that it
      has just acted, for which clocks, and which of all it left alone; [k] steps have come by themselves or from the
      controller, and [m] messages are the guard's own. *)
  Inductive thrifty (x : nat -> state) : nat -> option (some * some) -> nat -> nat -> Prop :=
  | none_sent : beginning (x 0) -> thrifty x 0 None 0 0
  | one_comes n acted k m : thrifty x n acted k m -> comes (x n) (x (S n)) \/ command (x n) (x (S n)) ->
      rests R (x (S n)) -> thrifty x (S n) None (S k) m
  | one_answered n acted k m f e : thrifty x n acted k m -> comes (x n) (x (S n)) -> answers R f (x (S n)) ->
      sends f e (x (S n)) (x (S (S n))) -> thrifty x (S (S n)) None (S k) (S m)
  | one_act n k m d f e : thrifty x n None k m -> rests R (x n) -> acts R d f (x n) -> sends f e (x n) (x (S n)) ->
      thrifty x (S n) (Some (d, e)) k (S m).

  Lemma thrifty_guarded : closed -> forall x n acted k m, thrifty x n acted k m -> guarded x n.
  Proof.
    intros HC x n acted k m H. induction H as [H | n a k m H IH HS HR | n a k m f e H IH HS HA HF | n k m d f e H IH HR HA HF].
    - now constructor.
    - apply goes_by; auto. unfold steps. tauto.
    - eapply is_answered; eauto. now apply (answers_lead HC _ _ _ _ HA HF).
    - apply goes_by; auto; [unfold steps; eauto | now apply (acts_lead HC _ _ _ _ _ HA HF)].
  Qed.

  (** It sends at most two messages for each that comes and each nanosecond. *)
  Theorem few_are_sent : forall x n acted k m, thrifty x n acted k m ->
    m <= 2 * k + match acted with Some _ => 1 | None => 0 end.
  Proof.
    intros x n acted k m H. induction H as [H | n a k m H IH HS HR | n a k m f e H IH HS HA HF | n k m d f e H IH HR HA HF];
      try destruct a; simpl in *; lia.
  Qed.
  (** And it can always go on like this: when it has acted, and the clocks that pass next are some of those for which it
      did, and left alone, then there is an answer, and no second act is needed. *)
  Theorem time_goes_on : closed -> forall x n acted k m y d', thrifty x n acted k m -> passes d' (x n) y ->
    match acted with
    | None => answered y \/ exists f, acts R d' f (x n)
    | Some (d, e) => (forall c, among c d' -> among c d /\ among c e) -> answered y
    end.
  Proof.
    intros HC x n acted k m y d' H HP. pose proof (thrifty_guarded HC _ _ _ _ _ H) as HG.
    destruct (guarded_well HC x n HG) as [HR _]. pose proof (time_answered HC _ _ _ HR HP) as HT.
    destruct H as [H | n a k m H HS HR' | n a k m f e H HS HA HF | n k m d f e H HR' HA HF]; try tauto.
    intros HD. destruct HT as [HT|((c & Hc) & _)]; auto. destruct (HD c Hc) as [H1 H2].
    now apply (proj2 (acts_lead HC _ _ _ _ _ HA HF) d' y c).
  Qed.

  (** ** Nothing is changed that need not be

      [forced n x]: from x all else can force a violation in n moves, whatever fallbacks are sent. No closed region rests
      there, however it was made: so no guard with these fallbacks that is sure to keep the properties lets through what
      leads there. *)
  Fixpoint forced (n : nat) (x : state) : Prop :=
    match n with
    | 0 => bad x
    | S n =>
        let fails x := forall f, exists e y, sends f e x y /\ forced n y in
        forced n x \/
        (exists y, message x y /\ (bad y \/ forced n y /\ fails y)) \/
        (exists d y, passes d x y /\ (bad y \/ forced n y /\ fails y) /\ fails x)
    end.

  Theorem necessary : closed -> forall n x, forced n x -> ~ rests R x.
  Proof.
    intros HC n. induction n as [|n IH]; intros x H HR; [exact (rests_well HC x HR H)|].
    assert (HA : forall y, answered y ->
              (bad y \/ forced n y /\ forall f, exists e z, sends f e y z /\ forced n z) -> False).
    { intros y [A|(f & A)] [B|[B1 B2]].
      - exact (rests_well HC y A B).
      - exact (IH y B1 A).
      - exact (proj1 (answers_well HC y f A) B).
      - destruct (B2 f) as (e & z & S1 & S2). apply (IH z S2). exact (answers_lead HC y f e z A S1). }
    destruct H as [H|[(y & M1 & M2)|(d & y & M1 & M2 & M3)]].
    - exact (IH x H HR).
    - apply (HA y); auto. exact (messages_answered HC x y HR M1).
    - destruct (time_answered HC x y d HR M1) as [A|(_ & f & A)]; [now apply (HA y)|].
      destruct (M3 f) as (e & z & S1 & S2). apply (IH z S2). exact (proj1 (acts_lead HC x d f e z A S1)).
  Qed.
End Game.

Arguments rests {state fallback some}. Arguments answers {state fallback some}. Arguments acts {state fallback some}.
Arguments answered {state fallback some}.
