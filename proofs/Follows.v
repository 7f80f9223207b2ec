(** The checker that a program follows its monitor: that after every run both show the same verdict.

    The pairs of states in which the two can be are given, by somebody whom nobody has to trust. The checker only tests
    that in each pair both show the same, and that every letter that is allowed leads from it to such a pair again. A
    program that sets a clock is refused: properties with clocks are not covered yet.
    Python: [ltlc/semantics/following.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Monitor Conditions Judgements Certificate Program.

(** * Walking through decisions, of a program or of a monitor *)

(** The atoms that have been asked for on the way. *)
Definition answered := list (nat * bool).
Fixpoint answer_to (a : nat) (known : answered) : option bool :=
  match known with [] => None | (b, v) :: known => if a =? b then Some v else answer_to a known end.

(** What a node is: an end, or a question with the nodes after 'yes' and after 'no'. *)
Inductive seen (node result : Type) := Found (x : result) | Decides (q : question) (yes no : node).
Arguments Found {node result} x.
Arguments Decides {node result} q yes no.

Section Walk.
  Variables (node result : Type) (look : node -> option (seen node result)) (is_late : nat -> bool).

  (** Whether [judge] accepts every end to which letters lead that [ctx] allows and that answer as is known. *)
  Fixpoint walk (fuel : nat) (n : node) (known : answered) (ctx : condition)
    (judge : result -> answered -> condition -> judgement) : judgement := fun m =>
    match ctx with
    | Constant false => (true, m)
    | _ =>
      match fuel, spend (weight ctx) m with
      | S fuel, Some m =>
          match look n with
          | Some (Found x) => judge x known ctx m
          | Some (Decides (IsLate c) yes no) => walk fuel (if is_late c then yes else no) known ctx judge m
          | Some (Decides (Holds a) yes no) =>
              match answer_to a known with
              | Some v => walk fuel (if v then yes else no) known ctx judge m
              | None => both (walk fuel yes ((a, true) :: known) (assign (AtStep a) true ctx) judge)
                             (walk fuel no ((a, false) :: known) (assign (AtStep a) false ctx) judge) m
              end
          | None => (false, m)
          end
      | _, _ => (false, m)
      end
    end.
End Walk.

(** Whether [judge] accepts [ctx], or its cases by atoms that it asks for: an impossible case may not be seen at once. *)
Fixpoint by_cases (fuel : nat) (ctx : condition) (judge : judgement) : judgement := fun m =>
  match ctx with
  | Constant false => (true, m)
  | _ =>
    match fuel, first_atom ctx, spend (weight ctx) m with
    | S fuel, Some a, Some m =>
        either judge (both (by_cases fuel (assign (AtStep a) true ctx) judge)
                           (by_cases fuel (assign (AtStep a) false ctx) judge)) m
    | _, _, _ => judge m
    end
  end.

Definition look_of_program (P : program) (w : way) : option (seen way outcome) :=
  match w with
  | Ends o => option_map Found (nth_error (outcomes P) o)
  | Asks b => option_map (fun x => Decides (asked x) (if_so x) (if_not x)) (nth_error (branches P) b)
  end.
Definition look_of_monitor (M : monitor) (t : target) : option (seen target nat) :=
  match t with
  | State q => Some (Found q)
  | Ask d => option_map (fun x => Decides (Holds (atom x)) (high x) (low x)) (nth_error (decisions M) d)
  end.

(** * The checker *)

(** A state of the program, and one of the monitor. *)
Definition pair : Type := nat * nat.

Section Checker.
  Variables (depth : nat) (P : program) (M : monitor) (pairs : list pair).

  Definition is_paired (q r : nat) : bool := existsb (fun p => (q =? fst p) && (r =? snd p)) pairs.
  Definition sets_nothing (x : outcome) : bool := match settings x with [] => negb (again x) | _ => false end.

  (** Whether every letter that is allowed leads from a way of the program, and from a target of the monitor, to a
      pair. *)
  Definition lead_to_pairs (w : way) (t : target) (allowed : condition) : judgement :=
    walk _ _ (look_of_program P) (fun _ => false) depth w [] allowed (fun x known ctx =>
      walk _ _ (look_of_monitor M) (fun _ => false) depth t known ctx (fun r _ ctx =>
        by_cases depth ctx (verdict_is (sets_nothing x && is_paired (goes_to x) r)))).

  Definition pair_is_right (allowed : condition) (p : pair) : judgement :=
    match nth_error (stances P) (fst p), nth_error (verdicts M) (snd p), nth_error (edges M) (snd p) with
    | Some x, Some v, Some t =>
        both (verdict_is (same_verdict (shows_verdict x) v)) (lead_to_pairs (at_step x) t allowed)
    | _, _, _ => verdict_is false
    end.
End Checker.

(** Whether P follows M over the letters that A allows. *)
Definition follows_monitor (depth work : nat) (A : predicate) (M : monitor) (P : program) (pairs : list pair) : bool :=
  is_paired pairs 0 0 && match first_due P with [] => true | _ => false end &&
  fst (all (pair_is_right depth P M pairs (unfold (as_formula A))) pairs (new_memory work)).

(** * It may be believed *)

(** Nothing is recalled here; memories bound the work. *)
Definition anything (x : claim) : Prop := True.
Lemma anything_sound : forall m, sound anything m.
Proof. intros m h k _. exact I. Qed.

(** The letter answers as is known, and satisfies the condition. *)
Definition fits_letter (l : letter) (known : answered) (ctx : condition) : Prop :=
  (forall a v, answer_to a known = Some v -> l a = v) /\ true_in (model_of l) ctx.

Lemma fits_assigned : forall l known ctx a, fits_letter l known ctx ->
  fits_letter l ((a, l a) :: known) (assign (AtStep a) (l a) ctx).
Proof.
  intros l known ctx a [H1 H2]. split.
  - intros b v. simpl. destruct (Nat.eqb_spec b a) as [->|]; [congruence | auto].
  - apply assign_true; auto; [apply model_of_reads | simpl; tauto].
Qed.

Section Walks.
  Variables (node result : Type) (look : node -> option (seen node result)) (is_late : nat -> bool).
  Variables (l : letter) (reaches_end : node -> result -> Prop).
  Let says (q : question) : bool := match q with Holds a => l a | IsLate c => is_late c end.
  Hypothesis at_end : forall n x, look n = Some (Found x) -> reaches_end n x.
  Hypothesis at_question : forall n q yes no x, look n = Some (Decides q yes no) ->
    reaches_end (if says q then yes else no) x -> reaches_end n x.

  Lemma walk_shows : forall (judge : result -> answered -> condition -> judgement) (Q : result -> Prop),
    (forall x known ctx, shows anything (judge x known ctx) (fits_letter l known ctx -> Q x)) ->
    forall fuel n known ctx, shows anything (walk _ _ look is_late fuel n known ctx judge)
      (fits_letter l known ctx -> exists x, reaches_end n x /\ Q x).
  Proof.
    intros judge Q HJ. induction fuel as [|fuel IH]; intros n known ctx m b m' H Hm; split; auto using anything_sound;
      intros -> HF; simpl in H.
    - destruct ctx as [[]| | | |]; try discriminate H. destruct HF as [_ HF]. discriminate HF.
    - assert (HC : match fuel, spend (weight ctx) m with _, Some m => match look n with
               | Some (Found x) => judge x known ctx m
               | Some (Decides (IsLate c) yes no) => walk _ _ look is_late fuel (if is_late c then yes else no) known ctx judge m
               | Some (Decides (Holds a) yes no) =>
                   match answer_to a known with
                   | Some v => walk _ _ look is_late fuel (if v then yes else no) known ctx judge m
                   | None => both (walk _ _ look is_late fuel yes ((a, true) :: known) (assign (AtStep a) true ctx) judge)
                                  (walk _ _ look is_late fuel no ((a, false) :: known) (assign (AtStep a) false ctx) judge) m
                   end
               | None => (false, m) end | _, None => (false, m) end = (true, m')).
      { destruct ctx as [[]| | | |]; auto. destruct HF as [_ HF]. discriminate HF. }
      clear H. destruct (spend (weight ctx) m) as [m1|]; [|discriminate HC].
      destruct (look n) as [[x|q yes no]|] eqn:El; [| |discriminate HC].
      + exists x. split; auto. destruct (HJ x known ctx m1 true m' HC (anything_sound m1)) as [_ H]. auto.
      + assert (HG : exists x, reaches_end (if says q then yes else no) x /\ Q x);
          [|destruct HG as (x & H1 & H2); eauto].
        destruct q as [a|c]; simpl; [|destruct (IH _ _ _ _ _ _ HC (anything_sound m1)) as [_ H]; auto].
        destruct (answer_to a known) as [v|] eqn:Ea.
        * destruct HF as [HK HT]. rewrite (HK a v Ea).
          destruct (IH _ _ _ _ _ _ HC (anything_sound m1)) as [_ H]. apply H; auto. now split.
        * apply (fits_assigned l known ctx a) in HF.
          destruct (both_shows anything _ _ _ _ (IH yes ((a, true) :: known) (assign (AtStep a) true ctx))
                      (IH no ((a, false) :: known) (assign (AtStep a) false ctx)) m1 true m' HC (anything_sound m1))
            as [_ H]. destruct (H eq_refl) as [H1 H0]. destruct (l a); auto.
  Qed.
End Walks.

Lemma by_cases_shows : forall l judge Q, shows anything judge Q -> forall fuel ctx,
  shows anything (by_cases fuel ctx judge) (true_in (model_of l) ctx -> Q).
Proof.
  intros l judge Q HJ. assert (HQ : forall (X : Prop), shows anything judge (X -> Q)).
  { intros X. eapply shows_some; [exact HJ | auto]. }
  induction fuel as [|fuel IH]; intros ctx m b m' H Hm; split; auto using anything_sound; intros -> HT; simpl in H.
  - assert (HC : judge m = (true, m')) by (destruct ctx as [[]| | | |]; auto; discriminate HT).
    now destruct (HJ m true m' HC Hm) as [_ A]; apply A.
  - assert (HC : match first_atom ctx, spend (weight ctx) m with
             | Some a, Some m1 => either judge (both (by_cases fuel (assign (AtStep a) true ctx) judge)
                                                    (by_cases fuel (assign (AtStep a) false ctx) judge)) m1
             | _, _ => judge m end = (true, m')) by (destruct ctx as [[]| | | |]; auto; discriminate HT).
    destruct (first_atom ctx) as [a|]; [destruct (spend _ m) as [m1|]|];
      try (now destruct (HJ m true m' HC Hm) as [_ A]; apply A).
    assert (HA : true_in (model_of l) (assign (AtStep a) (l a) ctx)).
    { apply assign_true; auto; [apply model_of_reads | simpl; tauto]. }
    assert (HS : shows anything (both (by_cases fuel (assign (AtStep a) true ctx) judge)
                                      (by_cases fuel (assign (AtStep a) false ctx) judge)) Q).
    { eapply shows_some; [apply both_shows; apply IH|]. intros [H1 H0]. destruct (l a); auto. }
    now destruct (either_shows anything _ _ _ HJ HS m1 true m' HC (anything_sound m1)) as [_ A]; apply A.
Qed.

Section Sound.
  Variables (depth work : nat) (A : predicate) (M : monitor) (P : program) (pairs : list pair).
  Hypothesis accepted : follows_monitor depth work A M P pairs = true.

  Lemma is_paired_in : forall q r, is_paired pairs q r = true -> In (q, r) pairs.
  Proof.
    intros q r H. apply existsb_exists in H. destruct H as ((q' & r') & H & E). apply andb_true_iff in E.
    destruct E as [E1 E2]. apply Nat.eqb_eq in E1, E2. simpl in *. congruence.
  Qed.

  (** What a letter does in a pair. *)
  Definition leads_on (l : letter) (w : way) (t : target) : Prop :=
    exists x r, ends P (fun q => match q with Holds a => l a | IsLate _ => false end) w x /\ leads M l t r /\
      sets_nothing x = true /\ In (goes_to x, r) pairs.

  Lemma lead_to_pairs_shows : forall w t ctx, shows anything (lead_to_pairs depth P M pairs w t ctx)
    (forall l, true_in (model_of l) ctx -> leads_on l w t).
  Proof.
    intros w t ctx m b m' H Hm. split; auto using anything_sound. intros -> l Hl.
    assert (HI : forall x known c, shows anything
        (walk _ _ (look_of_monitor M) (fun _ => false) depth t known c (fun r _ ctx =>
          by_cases depth ctx (verdict_is (sets_nothing x && is_paired pairs (goes_to x) r))))
        (fits_letter l known c -> exists r, leads M l t r /\ sets_nothing x = true /\ In (goes_to x, r) pairs)).
    { intros x. apply walk_shows.
      - intros [q|d] r E; simpl in E; [injection E as ->; constructor | destruct (nth_error _ d); discriminate].
      - intros [r|d] q yes no y E HL; simpl in E; [discriminate|].
        destruct (nth_error (decisions M) d) as [z|] eqn:Ed; [|discriminate]. injection E as <- <- <-.
        now apply (leads_ask M l d z).
      - intros r known c. eapply shows_some.
        + apply (by_cases_shows l _ (sets_nothing x = true /\ In (goes_to x, r) pairs)).
          apply verdict_is_shows. intros E. apply andb_true_iff in E. destruct E. auto using is_paired_in.
        + intros HR [_ HF]. auto. }
    assert (HW : shows anything (lead_to_pairs depth P M pairs w t ctx) (fits_letter l [] ctx -> exists x,
        ends P (fun q => match q with Holds a => l a | IsLate _ => false end) w x /\
        exists r, leads M l t r /\ sets_nothing x = true /\ In (goes_to x, r) pairs)).
    { apply walk_shows; auto.
      - intros [o|d] x E; simpl in E; [|destruct (nth_error _ d); discriminate].
        destruct (nth_error (outcomes P) o) eqn:Eo; [|discriminate]. injection E as <-. now constructor.
      - intros [o|d] q yes no x E HL; simpl in E; [destruct (nth_error _ o); discriminate|].
        destruct (nth_error (branches P) d) as [z|] eqn:Ed; [|discriminate]. injection E as <- <- <-.
        now apply (ends_asked P _ d z). }
    destruct (HW m true m' H Hm) as [_ HG]. destruct HG as (x & H1 & r & H2 & H3 & H4); auto.
    - split; [discriminate | exact Hl].
    - exists x, r. auto.
  Qed.

  Definition right_pair (p : pair) : Prop := exists x v t,
    nth_error (stances P) (fst p) = Some x /\ nth_error (verdicts M) (snd p) = Some v /\
    nth_error (edges M) (snd p) = Some t /\ shows_verdict x = v /\
    forall l, at_letter A l = true -> leads_on l (at_step x) t.

  Lemma pairs_are_right : In (0, 0) pairs /\ first_due P = [] /\ forall p, In p pairs -> right_pair p.
  Proof.
    pose proof accepted as H. unfold follows_monitor in H. rewrite !andb_true_iff in H. destruct H as [[H0 HD] H].
    split; [now apply is_paired_in|]. split; [now destruct (first_due P)|]. set (ctx := unfold (as_formula A)) in *.
    assert (HS : shows anything (all (pair_is_right depth P M pairs ctx) pairs) (forall p, In p pairs -> right_pair p)).
    { apply all_shows. intros [q r]. unfold pair_is_right, right_pair. simpl.
      destruct (nth_error (stances P) q) as [x|]; [|now apply verdict_is_shows].
      destruct (nth_error (verdicts M) r) as [v|]; [|now apply verdict_is_shows].
      destruct (nth_error (edges M) r) as [t|]; [|now apply verdict_is_shows].
      eapply shows_some; [apply both_shows; [apply verdict_is_shows; intros E; exact E | apply lead_to_pairs_shows]|].
      intros [HV HL]. exists x, v, t. repeat split; auto.
      - now destruct (shows_verdict x), v.
      - intros l Hl. apply HL. now apply (predicate_true _ l (model_of_reads l)). }
    destruct (all (pair_is_right depth P M pairs ctx) pairs (new_memory work)) as [b m] eqn:E. simpl in H. subst b.
    destruct (HS _ _ _ E (anything_sound _)) as [_ HR]. auto.
  Qed.

  (** No clock runs. *)
  Definition at_rest (c : config) : Prop := (forall k, due c k = None) /\ restless c = false.

  Lemma done_at_rest : forall c now x, at_rest c -> sets_nothing x = true -> at_rest (done c now x).
  Proof.
    intros c now x [H1 H2] H. unfold sets_nothing in H. unfold at_rest, done. simpl.
    destruct (settings x); [|discriminate H]. split; [exact H1 | now destruct (again x)].
  Qed.

  (** After every run of steps both are in a pair. *)
  Lemma run_in_pairs : forall s began n, (forall k, k < n -> at_letter A (s k) = true) ->
    exists c r, runs P s (fun _ => 0) began n c /\ reaches M s n r /\ In (is_in c, r) pairs /\ at_rest c.
  Proof.
    intros s began n. destruct pairs_are_right as (H0 & HD & HP).
    induction n as [|n IH]; intros HA.
    - exists (beginning P began), 0. repeat split; auto; try constructor.
      intros k. unfold beginning. simpl. rewrite HD. now destruct k.
    - destruct IH as (c & r & Hc & Hr & Hp & HR); [intros k Hk; apply HA; lia|].
      destruct (HP _ Hp) as (x & v & t & Hx & _ & Ht & _ & HL). simpl in Hx, Ht.
      destruct (HL (s n) (HA n ltac:(lia))) as (y & r' & He & Hl & HS & HI).
      exists (done c 0 y), r'. split; [|split; [econstructor; eauto | split; [exact HI | now apply done_at_rest]]].
      econstructor; [exact Hc|]. exists x. split; auto. assert (E : is_step (fun _ => 0) n = true) by (now destruct n).
      rewrite E. exists y. split; auto.
      assert (HQ : forall answers, (forall q, answers q = match q with Holds a => s n a | IsLate _ => false end) ->
                forall w z, ends P (fun q => match q with Holds a => s n a | IsLate _ => false end) w z -> ends P answers w z).
      { intros answers HE w z H. induction H as [|b z u Hb _ IH]; [now constructor|]. eapply ends_asked; eauto.
        now rewrite HE. }
      apply HQ with (2 := He). intros [a|k]; auto. unfold answers_at, late. now rewrite (proj1 HR).
  Qed.

  (** The program shows the verdict of the monitor, after every run of allowed letters, whenever the session began. *)
  Theorem follows_monitor_sound : forall s began n, (forall k, k < n -> at_letter A (s k) = true) ->
    exists r v, reaches M s n r /\ nth_error (verdicts M) r = Some v /\ shows_after P s (fun _ => 0) began n v.
  Proof.
    intros s began n HA. destruct pairs_are_right as (_ & _ & HP).
    destruct (run_in_pairs s began n HA) as (c & r & Hc & Hr & Hp & _).
    destruct (HP _ Hp) as (x & v & t & Hx & Hv & _ & HE & _). exists r, v. repeat split; auto. exists c, x. auto.
  Qed.
End Sound.
