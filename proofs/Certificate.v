(** Certificates for monitors, their checker, and the proof that it may be believed.

    A certificate annotates every state that has no permanent verdict with formulas: after each run that leads to the
    state, what remains to be satisfied is one of them. For the permanent verdicts it lists formulas that no infinite
    word satisfies, in levels. For the others it gives infinite words that satisfy and that violate each annotation.

    Python: [ltlc/semantics/certificate.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Encodings Lasso Monitor Conditions.

(** A level of formulas that no infinite word satisfies. Without an eventuality, every step leads to the levels after
    it in the list. With the eventuality [stay U goal], each formula of the level implies it; but a step with [goal]
    leads to the levels after, and a step without [goal] to those or to the level itself, where it is never met. *)
Record level := { eventuality : option (formula * formula); members : list formula }.

Record certificate := {
  subject : property;
  encoded_by : encoding;
  assumption : predicate;              (* what is known of every letter, for the atoms are not free *)
  machine : monitor;
  annotations : list (list formula);   (* by state *)
  levels : list level;
  witnesses : list (list lasso)        (* by state *)
}.

(** * The checker *)

Definition judgement := memory -> bool * memory.
Definition verdict_is (b : bool) : judgement := fun m => (b, m).
Definition both (p q : judgement) : judgement := fun m => let (b, m) := p m in if b then q m else (false, m).
Fixpoint all {A} (p : A -> judgement) (xs : list A) : judgement :=
  match xs with [] => verdict_is true | x :: xs => both (p x) (all p xs) end.
Fixpoint any {A} (p : A -> judgement) (xs : list A) : judgement :=
  match xs with
  | [] => verdict_is false
  | x :: xs => fun m => let (b, m) := p x m in if b then (true, m) else any p xs m
  end.

Definition later_any (fs : list formula) : condition :=
  fold_right (fun f c => disjunction (later f) c) (Constant false) fs.
Definition all_members (ls : list level) : list formula := flat_map members ls.

Definition same_verdict (v w : verdict) : bool :=
  match v, w with
  | Violated, Violated | PresumablyViolated, PresumablyViolated
  | PresumablySatisfied, PresumablySatisfied | Satisfied, Satisfied => true
  | _, _ => false
  end.

Section Checker.
  Variables (depth : nat) (allowed : condition) (M : monitor) (annotated : list (list formula)).
  (** What the checker compares with, worked out once: [map (map later) annotated], and one of the dead formulas. *)
  Variables (remains : list (list condition)) (dead : condition).

  (** Whether it is right to be in state q when [c] remains to be satisfied. *)
  Definition settles (q : nat) (c : condition) : judgement :=
    match nth_error (verdicts M) q with
    | Some Violated => follows depth c dead
    | Some Satisfied => follows depth (negation c) dead
    | Some _ => any (equivalent depth c) (nth q remains [])
    | None => verdict_is false
    end.

  (** Whether every letter that [ctx] allows leads from t to a state where it is right to be. *)
  Fixpoint covers (fuel : nat) (t : target) (ctx c : condition) (m : memory) : bool * memory :=
    match ctx with
    | Constant false => (true, m)
    | _ =>
      match fuel, spend (weight ctx + weight c) m with
      | S fuel, Some m =>
        match recall (Covered t ctx c) m with
        | Some b => (b, m)
        | None =>
            let cases a low high :=
              both (covers fuel high (assign (AtStep a) true ctx) (assign (AtStep a) true c))
                   (covers fuel low (assign (AtStep a) false ctx) (assign (AtStep a) false c)) in
            let (b, m) :=
              match t with
              | Ask d => match nth_error (decisions M) d with
                         | Some a => cases (atom a) (low a) (high a) m
                         | None => (false, m)
                         end
              | State q => match first_atom c with Some a => cases a t t m | None => settles q c m end
              end in
            (b, remember (Covered t ctx c) b m)
        end
      | _, _ => (false, m)
      end
    end.

  (** The finite reading of a state's annotations is its verdict, and its edges are covered; a permanent verdict stays. *)
  Definition state_is_right (q : nat) : judgement :=
    match nth_error (verdicts M) q, nth_error (edges M) q with
    | Some PresumablyViolated, Some t =>
        all (fun f => both (verdict_is (negb (holds f []))) (covers depth t allowed (unfold f))) (nth q annotated [])
    | Some PresumablySatisfied, Some t =>
        all (fun f => both (verdict_is (holds f [])) (covers depth t allowed (unfold f))) (nth q annotated [])
    | Some v, Some (State r) =>
        verdict_is (match nth_error (verdicts M) r with Some w => same_verdict v w | None => false end)
    | _, _ => verdict_is false
    end.

  Definition member_is_dead (d : level) (lower : list level) (f : formula) : judgement :=
    let below := later_any (all_members lower) in
    let now := conjunction allowed (unfold f) in
    match eventuality d with
    | None => follows depth now below
    | Some (stay, goal) =>
        both (follows depth (later f) (later (Ltl.Until stay goal)))
          (both (follows depth (conjunction now (unfold goal)) below)
             (follows depth (conjunction now (negation (unfold goal))) (disjunction (later_any (members d)) below)))
    end.

  Fixpoint levels_are_dead (ls : list level) : judgement :=
    match ls with
    | [] => verdict_is true
    | d :: lower => both (levels_are_dead lower) (all (member_is_dead d lower) (members d))
    end.
End Checker.

(** Atoms that make [c] true if they hold and no other does: those that can, one after the other. Whether they do is
    for [possible] to see. *)
Fixpoint atoms_for (depth : nat) (c : condition) : list nat :=
  match depth, first_atom c with
  | S depth, Some a =>
      match assign (AtStep a) true c with
      | Constant false => atoms_for depth (assign (AtStep a) false c)
      | d => a :: atoms_for depth d
      end
  | _, _ => []
  end.
Definition letter_of (atoms : list nat) : letter := fun a => existsb (Nat.eqb a) atoms.

(** Whether a letter is found that satisfies A: if there is none, a certificate speaks of nothing. *)
Definition possible (depth : nat) (A : predicate) : bool :=
  at_letter A (letter_of (atoms_for depth (unfold (as_formula A)))).

(** [depth] bounds the nesting of case distinctions, [work] their number, weighed by the size of the conditions. *)
Definition check (depth work : nat) (C : certificate) : bool :=
  possible depth (assumption C) &&
  let allowed := unfold (as_formula (assumption C)) in
  let dead := later_any (all_members (levels C)) in
  let M := machine C in
  let remains := map (map later) (annotations C) in
  let start := settles depth M remains dead 0 (later (encode (encoded_by C) (subject C))) in
  let states := all (state_is_right depth allowed M (annotations C) remains dead) (seq 0 (length (verdicts M))) in
  fst (both (levels_are_dead depth allowed (levels C)) (both start states) (new_memory work)).

(** Whether the verdicts that are not permanent are shown to be open: each annotation has a word for and a word against. *)
Definition is_allowed (A : predicate) (u : lasso) : bool :=
  match loop u with [] => false | _ => forallb (at_letter A) (letters u) end.
Definition is_open (us : list lasso) (f : formula) : bool :=
  existsb (holds_on_lasso f) us && existsb (fun u => negb (holds_on_lasso f u)) us.
Definition exact (C : certificate) : bool :=
  forallb (fun q => let us := nth q (witnesses C) [] in
                    forallb (is_allowed (assumption C)) us && forallb (is_open us) (nth q (annotations C) []))
    (seq 0 (length (verdicts (machine C)))).

(** * Soundness *)

Lemma all_sound : forall meaning {A} (p : A -> judgement) (Q : A -> Prop) xs,
  (forall x m b m', p x m = (b, m') -> sound meaning m -> sound meaning m' /\ (b = true -> Q x)) ->
  forall m b m', all p xs m = (b, m') -> sound meaning m -> sound meaning m' /\ (b = true -> forall x, In x xs -> Q x).
Proof.
  intros meaning A p Q xs Hp. induction xs as [|x xs IH]; intros m b m' H Hm; simpl in H.
  - injection H as <- <-. split; auto. intros _ x [].
  - unfold both in H. destruct (p x m) as [b1 m1] eqn:E. destruct (Hp _ _ _ _ E Hm) as [S1 Q1]. destruct b1.
    + destruct (IH _ _ _ H S1) as [S2 Q2]. split; auto. intros Hb y [<-|Hy]; auto.
    + injection H as <- <-. split; auto; congruence.
Qed.

Lemma any_sound : forall meaning {A} (p : A -> judgement) (Q : A -> Prop) xs,
  (forall x m b m', p x m = (b, m') -> sound meaning m -> sound meaning m' /\ (b = true -> Q x)) ->
  forall m b m', any p xs m = (b, m') -> sound meaning m ->
  sound meaning m' /\ (b = true -> exists x, In x xs /\ Q x).
Proof.
  intros meaning A p Q xs Hp. induction xs as [|x xs IH]; intros m b m' H Hm; simpl in H.
  - injection H as <- <-. split; auto; congruence.
  - destruct (p x m) as [b1 m1] eqn:E. destruct (Hp _ _ _ _ E Hm) as [S1 Q1]. destruct b1.
    + injection H as <- <-. split; auto. intros Hb. exists x; simpl; auto.
    + destruct (IH _ _ _ H S1) as [S2 Q2]. split; auto. intros Hb. destruct (Q2 Hb) as (y & A1 & A2). exists y; simpl; auto.
Qed.

Lemma both_sound : forall meaning (p q : judgement) (P Q : Prop),
  (forall m b m', p m = (b, m') -> sound meaning m -> sound meaning m' /\ (b = true -> P)) ->
  (forall m b m', q m = (b, m') -> sound meaning m -> sound meaning m' /\ (b = true -> Q)) ->
  forall m b m', both p q m = (b, m') -> sound meaning m -> sound meaning m' /\ (b = true -> P /\ Q).
Proof.
  intros meaning p q P Q Hp Hq m b m' H Hm. unfold both in H. destruct (p m) as [b1 m1] eqn:E.
  destruct (Hp _ _ _ E Hm) as [S1 P1]. destruct b1.
  - destruct (Hq _ _ _ H S1) as [S2 Q2]. split; auto.
  - injection H as <- <-. split; auto; congruence.
Qed.

Lemma verdict_is_sound : forall meaning c m b m', verdict_is c m = (b, m') -> sound meaning m ->
  sound meaning m' /\ (b = true -> c = true).
Proof. intros meaning c m b m' H Hm. injection H as <- <-. auto. Qed.

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

Lemma later_any_true : forall P, decides P -> forall fs,
  true_in P (later_any fs) <-> exists f, In f fs /\ true_in P (later f).
Proof.
  intros P HP. induction fs as [|f fs IH]; simpl later_any.
  - simpl. split; [congruence | intros (f & [] & _)].
  - rewrite disjunction_true, IH by auto. split.
    + intros [H | (g & A & B)]; [exists f | exists g]; simpl; auto.
    + intros (g & [<-|A] & B); [now left | right; eauto].
Qed.

Lemma later_true_next : forall s L i, decided s L -> forall f, true_in (model_at s L i) (later f) <-> sat f s L (S i).
Proof. intros s L i Hd. apply later_true; [now apply model_at_decides | reflexivity]. Qed.

(** The model that judges formulas from step i on itself, and knows no atom. *)
Definition model_from (s : stream) (L : option nat) (i : nat) : model := fun x =>
  match x with AtStep _ => False | FromNext f => sat f s L i end.
Lemma model_from_decides : forall s L i, decided s L -> decides (model_from s L i).
Proof. intros s L i Hd [a|f]; simpl; auto. Qed.
Lemma later_true_here : forall s L i, decided s L -> forall f, true_in (model_from s L i) (later f) <-> sat f s L i.
Proof. intros s L i Hd. apply later_true; [now apply model_from_decides | reflexivity]. Qed.

Definition some_sat (fs : list formula) (s : stream) (L : option nat) (i : nat) : Prop := exists f, In f fs /\ sat f s L i.

Section Soundness.
  Variables (depth : nat) (A : predicate) (M : monitor) (annotated : list (list formula)) (dead : list formula).
  Let allowed := unfold (as_formula A).
  Let remains := map (map later) annotated.

  (** What it means for a state to be right when [c] remains to be satisfied after letter l. *)
  Definition settled (l : letter) (q : nat) (c : condition) : Prop :=
    match nth_error (verdicts M) q with
    | Some Violated => forall P, reads P l -> true_in P c -> true_in P (later_any dead)
    | Some Satisfied => forall P, reads P l -> ~ true_in P c -> true_in P (later_any dead)
    | Some _ => exists f, In f (nth q annotated []) /\ forall P, reads P l -> (true_in P c <-> true_in P (later f))
    | None => False
    end.

  Definition meaning (k : claim) : Prop :=
    match k with
    | Equivalent c d => same c d
    | Covered t ctx c => forall l, true_in (model_of l) ctx -> exists q, leads M l t q /\ settled l q c
    end.

  Lemma meaning_equivalent : forall c d, meaning (Equivalent c d) <-> same c d.
  Proof. reflexivity. Qed.

  Lemma settles_sound : forall q c m b m', settles depth M remains (later_any dead) q c m = (b, m') -> sound meaning m ->
    sound meaning m' /\ (b = true -> forall l, settled l q c).
  Proof.
    intros q c m b m' H Hm. unfold settles in H. unfold settled.
    assert (HA : any (equivalent depth c) (nth q remains []) m = (b, m') ->
      sound meaning m' /\ (b = true -> forall l, exists f, In f (nth q annotated []) /\
                                         forall P, reads P l -> (true_in P c <-> true_in P (later f)))).
    { intros HA. apply (any_sound meaning _ (same c)) in HA; auto.
      - destruct HA as [S1 Q1]. split; auto. intros Hb l. destruct (Q1 Hb) as (d & A1 & A2).
        unfold remains in A1. change (@nil condition) with (map later []) in A1. rewrite map_nth in A1.
        apply in_map_iff in A1. destruct A1 as (f & <- & A1). exists f; split; auto. intros P [HP _]. auto.
      - intros. eapply equivalent_sound; eauto using meaning_equivalent. }
    destruct (nth_error (verdicts M) q) as [[]|]; auto.
    - destruct (follows_sound meaning meaning_equivalent _ _ _ _ _ _ H Hm) as [S1 Q1]. split; auto.
      intros Hb l P [HP _]. auto.
    - destruct (follows_sound meaning meaning_equivalent _ _ _ _ _ _ H Hm) as [S1 Q1]. split; auto.
      intros Hb l P [HP _] Hc. apply Q1; auto. now apply negation_true.
    - injection H as <- <-. split; auto; congruence.
  Qed.

  Lemma settled_assign : forall l q a c, settled l q (assign (AtStep a) (l a) c) -> settled l q c.
  Proof.
    intros l q a c. unfold settled.
    assert (E : forall P, reads P l -> true_in P (assign (AtStep a) (l a) c) <-> true_in P c).
    { intros P [HP Ha]. apply assign_true; auto. }
    destruct (nth_error (verdicts M) q) as [[]|]; auto.
    - intros H P HP Hc. apply (H P HP). now apply E.
    - intros (f & H1 & H2). exists f; split; auto. intros P HP. rewrite <- (E P HP). auto.
    - intros (f & H1 & H2). exists f; split; auto. intros P HP. rewrite <- (E P HP). auto.
    - intros H P HP Hc. apply (H P HP). now rewrite E.
  Qed.

  Lemma cases_sound : forall t a low high ctx c,
    (forall l q, leads M l (if l a then high else low) q -> leads M l t q) ->
    meaning (Covered high (assign (AtStep a) true ctx) (assign (AtStep a) true c)) ->
    meaning (Covered low (assign (AtStep a) false ctx) (assign (AtStep a) false c)) ->
    meaning (Covered t ctx c).
  Proof.
    intros t a low high ctx c Ht Hh Hl l Hc.
    assert (E : true_in (model_of l) (assign (AtStep a) (l a) ctx)).
    { apply assign_true; auto; [apply model_of_reads | simpl; tauto]. }
    assert (HQ : exists q, leads M l (if l a then high else low) q /\ settled l q (assign (AtStep a) (l a) c)).
    { destruct (l a); [apply (Hh l E) | apply (Hl l E)]. }
    destruct HQ as (q & B & D). exists q. split; auto. eapply settled_assign; eauto.
  Qed.

  Lemma covers_sound : forall fuel t ctx c m b m', covers depth M remains (later_any dead) fuel t ctx c m = (b, m') ->
    sound meaning m -> sound meaning m' /\ (b = true -> meaning (Covered t ctx c)).
  Proof.
    induction fuel as [|fuel IH]; intros t ctx c m b m' H Hm.
    - simpl in H. destruct ctx as [[]| | | |]; injection H as <- <-; split; auto; congruence.
    - assert (HB : forall a low high, (forall l q, leads M l (if l a then high else low) q -> leads M l t q) ->
        forall m b m',
        both (covers depth M remains (later_any dead) fuel high (assign (AtStep a) true ctx) (assign (AtStep a) true c))
             (covers depth M remains (later_any dead) fuel low (assign (AtStep a) false ctx) (assign (AtStep a) false c)) m = (b, m') ->
        sound meaning m -> sound meaning m' /\ (b = true -> meaning (Covered t ctx c))).
      { intros a low high Ht m1 b1 m1' E Hm1.
        apply (both_sound meaning _ _ (meaning (Covered high (assign (AtStep a) true ctx) (assign (AtStep a) true c)))
                 (meaning (Covered low (assign (AtStep a) false ctx) (assign (AtStep a) false c)))) in E; eauto.
        destruct E as [E1 E2]. split; auto. intros Hb. destruct (E2 Hb). now apply (cases_sound t a low high). }
      simpl in H.
      assert (HF : ctx = Constant false \/ (forall (X : Type) (x y : X), match ctx with Constant false => x | _ => y end = y)).
      { destruct ctx as [[]| | | |]; auto. }
      destruct HF as [-> | HF].
      { injection H as <- <-. split; auto. intros _ l Hl. discriminate Hl. }
      rewrite HF in H. clear HF. destruct (spend (weight ctx + weight c) m) as [m1|] eqn:Es; [|injection H as <- <-; split; auto; congruence].
      apply (spend_sound meaning) in Es; auto.
      destruct (recall (Covered t ctx c) m1) as [r|] eqn:Er.
      { injection H as <- <-. split; auto. intros ->. exact (recall_sound meaning _ _ Es Er). }
      match type of H with (let (_, _) := ?e in _) = _ => destruct e as [r m2] eqn:E end.
      injection H as <- <-.
      assert (HR : sound meaning m2 /\ (r = true -> meaning (Covered t ctx c))).
      { destruct t as [q|d].
        - destruct (first_atom c) as [a|] eqn:Ea.
          + apply (HB a (State q) (State q)) in E; auto. intros l r0. destruct (l a); auto.
          + destruct (settles_sound _ _ _ _ _ E Es) as [S1 Q1]. split; auto.
            intros Hr l _. exists q. split; [constructor | auto].
        - destruct (nth_error (decisions M) d) as [e|] eqn:Ed.
          + apply (HB (atom e) (low e) (high e)) in E; auto. intros l q. now apply leads_ask.
          + injection E as <- <-. split; auto; congruence. }
      destruct HR. split; auto using remember_sound.
  Qed.

  (** What it means for a state to be right. *)
  Definition right_state (q : nat) : Prop :=
    exists v t, nth_error (verdicts M) q = Some v /\ nth_error (edges M) q = Some t /\
    match v with
    | PresumablyViolated | PresumablySatisfied =>
        forall f, In f (nth q annotated []) ->
          (holds f [] = true <-> v = PresumablySatisfied) /\ meaning (Covered t allowed (unfold f))
    | _ => exists r, t = State r /\ nth_error (verdicts M) r = Some v
    end.

  Lemma state_is_right_sound : forall q m b m', state_is_right depth allowed M annotated remains (later_any dead) q m = (b, m') ->
    sound meaning m -> sound meaning m' /\ (b = true -> right_state q).
  Proof.
    intros q m b m' H Hm. unfold state_is_right in H. unfold right_state.
    assert (HA : forall t (p : formula -> bool), all (fun f => both (verdict_is (p f)) (covers depth M remains (later_any dead) depth t allowed (unfold f)))
        (nth q annotated []) m = (b, m') -> sound meaning m' /\
        (b = true -> forall f, In f (nth q annotated []) -> p f = true /\ meaning (Covered t allowed (unfold f)))).
    { intros t p HA.
      apply (all_sound meaning _ (fun f => p f = true /\ meaning (Covered t allowed (unfold f)))) in HA; auto.
      intros f. apply both_sound; intros; [eapply verdict_is_sound; eauto | eapply covers_sound; eauto]. }
    destruct (nth_error (verdicts M) q) as [v|] eqn:Ev; [|injection H as <- <-; split; auto; congruence].
    destruct (nth_error (edges M) q) as [t|] eqn:Et.
    2: { assert (HF : verdict_is false m = (b, m')) by (destruct v; exact H). injection HF as <- <-. split; auto; congruence. }
    assert (HP : match v with Violated | Satisfied =>
        match t with State r => verdict_is (match nth_error (verdicts M) r with Some w => same_verdict v w | None => false end)
                   | Ask _ => verdict_is false end m = (b, m') -> sound meaning m' /\ (b = true -> exists r, t = State r /\ nth_error (verdicts M) r = Some v)
        | _ => True end).
    { destruct v; auto; destruct t as [r|]; intros E; injection E as <- <-; split; auto; try congruence;
        destruct (nth_error (verdicts M) r) as [[]|] eqn:Er; simpl; try congruence; intros _; exists r; auto. }
    destruct v; try (destruct (HP H) as [S1 Q1]; split; auto; intros Hb; do 2 eexists; repeat split; eauto; fail).
    - destruct (HA t (fun f => negb (holds f [])) H) as [S1 Q1]. split; auto. intros Hb.
      do 2 eexists; repeat split; eauto; destruct (Q1 Hb _ H0) as [E1 E2]; auto; try congruence.
      intros Hf. rewrite Hf in E1. discriminate.
    - destruct (HA t (fun f => holds f []) H) as [S1 Q1]. split; auto. intros Hb.
      do 2 eexists; repeat split; eauto; destruct (Q1 Hb _ H0) as [E1 E2]; auto.
  Qed.

  (** * Runs *)
  Variable phi : formula.
  Hypothesis start_right : forall l, settled l 0 (later phi).
  Hypothesis states_right : forall q v, nth_error (verdicts M) q = Some v -> right_state q.

  (** What is known when the first n letters of [s] have led to state q: of every word that starts with them. *)
  Definition starts_like (s : stream) (n : nat) (s' : stream) (L : option nat) : Prop :=
    decided s' L /\ forall k, k < n -> inside L k /\ s' k = s k.
  Definition known (s : stream) (n q : nat) : Prop :=
    match nth_error (verdicts M) q with
    | Some Violated => forall s' L, starts_like s n s' L -> sat phi s' L 0 -> exists k, some_sat dead s' L k
    | Some Satisfied => forall s' L, starts_like s n s' L -> ~ sat phi s' L 0 -> exists k, some_sat dead s' L k
    | Some _ => exists f, In f (nth q annotated []) /\
                  forall s' L, starts_like s n s' L -> (sat phi s' L 0 <-> sat f s' L n)
    | None => False
    end.

  Lemma known_from_settled : forall s n q c l, settled l q c ->
    (forall s' L, starts_like s n s' L -> exists P, reads P l /\ (true_in P c <-> sat phi s' L 0) /\
                    (forall f, true_in P (later f) <-> sat f s' L n)) ->
    known s n q.
  Proof.
    intros s n q c l Hq HP. unfold settled in Hq. unfold known.
    destruct (nth_error (verdicts M) q) as [[]|]; auto.
    - intros s' L Hs Hphi. destruct (HP s' L Hs) as (P & A1 & A2 & A3). exists n.
      destruct A1 as [A1 A1']. assert (HD : true_in P (later_any dead)) by (apply Hq; [split; auto | now apply A2]).
      apply later_any_true in HD; auto. destruct HD as (f & B1 & B2). exists f; split; auto. now apply A3.
    - destruct Hq as (f & B1 & B2). exists f; split; auto. intros s' L Hs.
      destruct (HP s' L Hs) as (P & A1 & A2 & A3). rewrite <- A2, <- A3. auto.
    - destruct Hq as (f & B1 & B2). exists f; split; auto. intros s' L Hs.
      destruct (HP s' L Hs) as (P & A1 & A2 & A3). rewrite <- A2, <- A3. auto.
    - intros s' L Hs Hphi. destruct (HP s' L Hs) as (P & A1 & A2 & A3). exists n.
      destruct A1 as [A1 A1']. assert (HD : true_in P (later_any dead)) by (apply Hq; [split; auto | now rewrite A2]).
      apply later_any_true in HD; auto. destruct HD as (f & B1 & B2). exists f; split; auto. now apply A3.
  Qed.

  Lemma known_start : forall s, known s 0 0.
  Proof.
    intros s. apply (known_from_settled s 0 0 (later phi) no_atom (start_right no_atom)).
    intros s' L [Hd _]. exists (model_from s' L 0). pose proof (later_true_here s' L 0 Hd) as HL. repeat split; try apply HL.
    - now apply model_from_decides.
    - simpl. tauto.
    - simpl. unfold no_atom. congruence.
  Qed.

  Lemma starts_like_le : forall s n s' L, starts_like s (S n) s' L -> starts_like s n s' L.
  Proof. intros s n s' L [H1 H2]. split; auto. Qed.

  Lemma known_step : forall s n q, at_letter A (s n) = true -> known s n q ->
    exists t q', nth_error (edges M) q = Some t /\ leads M (s n) t q' /\ known s (S n) q'.
  Proof.
    intros s n q Ha Hk. destruct (nth_error (verdicts M) q) as [v|] eqn:Ev; [|unfold known in Hk; rewrite Ev in Hk; destruct Hk].
    destruct (states_right q v Ev) as (v' & t & Ev' & Et & Hv). rewrite Ev in Ev'. injection Ev' as <-.
    assert (HC : forall f, In f (nth q annotated []) -> meaning (Covered t allowed (unfold f)) ->
      (forall s' L, starts_like s n s' L -> (sat phi s' L 0 <-> sat f s' L n)) ->
      exists t q', nth_error (edges M) q = Some t /\ leads M (s n) t q' /\ known s (S n) q').
    { intros f Hf HM Hphi. destruct (HM (s n)) as (q' & B1 & B2).
      { apply (predicate_true _ (s n)); auto using model_of_reads. }
      exists t, q'. repeat split; auto. apply (known_from_settled s (S n) q' (unfold f) (s n) B2).
      intros s' L Hs. pose proof Hs as [Hd Hl]. destruct (Hl n) as [Hin Hsn]; [lia|].
      exists (model_at s' L n). split; [rewrite <- Hsn; now apply model_at_reads|]. split.
      - rewrite unfold_correct by auto. symmetry. apply Hphi. now apply starts_like_le.
      - intros g. now apply later_true_next. }
    assert (HS : forall r, t = State r -> nth_error (verdicts M) r = Some v -> (v = Violated \/ v = Satisfied) ->
      exists t q', nth_error (edges M) q = Some t /\ leads M (s n) t q' /\ known s (S n) q').
    { intros r Et' Er Hvv. exists t, r. repeat split; auto; [subst; constructor|].
      unfold known in *. rewrite Ev in Hk. rewrite Er.
      destruct Hvv; subst v; intros s' L Hs; apply Hk; now apply starts_like_le. }
    destruct v.
    - destruct Hv as (r & B1 & B2). eauto.
    - unfold known in Hk. rewrite Ev in Hk. destruct Hk as (f & B1 & B2). destruct (Hv f B1). eauto.
    - unfold known in Hk. rewrite Ev in Hk. destruct Hk as (f & B1 & B2). destruct (Hv f B1). eauto.
    - destruct Hv as (r & B1 & B2). eauto.
  Qed.

  Lemma run_known : forall s n, (forall k, k < n -> at_letter A (s k) = true) -> exists q, reaches M s n q /\ known s n q.
  Proof.
    intros s n. induction n as [|n IH]; intros Ha.
    - exists 0. split; [constructor | apply known_start].
    - destruct IH as (q & B1 & B2); [auto|]. destruct (known_step s n q) as (t & q' & C1 & C2 & C3); auto.
      exists q'. split; auto. econstructor; eauto.
  Qed.
End Soundness.

(** * Levels: no infinite word over allowed letters satisfies a formula of theirs *)
Section Levels.
  Variables (depth : nat) (A : predicate) (mean : claim -> Prop).
  Let allowed := unfold (as_formula A).
  Hypothesis mean_equivalent : forall c d, mean (Equivalent c d) <-> same c d.

  Definition is_word (s : stream) : Prop := decided s None /\ forall k, at_letter A (s k) = true.

  Lemma allowed_true : forall s i, is_word s -> true_in (model_at s None i) allowed.
  Proof. intros s i [Hd Ha]. apply (predicate_true _ (s i)); auto. now apply model_at_reads. Qed.

  Definition never (fs : list formula) : Prop := forall s i, is_word s -> ~ some_sat fs s None i.
  (** Every step at which f holds leads to [fs], if the condition c is true there. *)
  Definition steps_to (f : formula) (c : condition) (fs : list formula) : Prop :=
    forall s i, is_word s -> sat f s None i -> true_in (model_at s None i) c -> some_sat fs s None (S i).

  Lemma steps_to_sound : forall f c d fs m b m',
    follows depth (conjunction (conjunction allowed (unfold f)) c) d m = (b, m') -> sound mean m ->
    (forall P, decides P -> true_in P d -> true_in P (later_any fs)) ->
    sound mean m' /\ (b = true -> steps_to f c fs).
  Proof.
    intros f c d fs m b m' H Hm Hfs. destruct (follows_sound mean mean_equivalent _ _ _ _ _ _ H Hm) as [S1 Q1].
    split; auto. intros Hb s i Hw Hf Hc. pose proof Hw as [Hd _]. pose proof (model_at_decides s None i Hd) as HP.
    specialize (Q1 Hb (model_at s None i) HP). rewrite !conjunction_true, unfold_correct in Q1 by (auto; exact I).
    pose proof (Hfs _ HP (Q1 (conj (conj (allowed_true s i Hw) Hf) Hc))) as HR.
    apply later_any_true in HR; auto. destruct HR as (g & B1 & B2). exists g; split; auto.
    now apply (later_true_next s None i).
  Qed.

  Lemma conjunction_TRUE : forall c, conjunction c TRUE = c.
  Proof. destruct c as [[]| | | |]; reflexivity. Qed.

  Definition dead_in (d : level) (lower : list level) (f : formula) : Prop :=
    match eventuality d with
    | None => steps_to f TRUE (all_members lower)
    | Some (stay, goal) =>
        (forall s i, is_word s -> sat f s None i -> sat (Ltl.Until stay goal) s None i) /\
        steps_to f (unfold goal) (all_members lower) /\
        steps_to f (negation (unfold goal)) (members d ++ all_members lower)
    end.

  Lemma member_is_dead_sound : forall d lower f m b m', member_is_dead depth allowed d lower f m = (b, m') ->
    sound mean m -> sound mean m' /\ (b = true -> dead_in d lower f).
  Proof.
    intros d lower f m b m' H Hm. unfold member_is_dead in H. unfold dead_in.
    destruct (eventuality d) as [[stay goal]|].
    - revert m b m' H Hm. apply (both_sound mean); [|apply (both_sound mean)]; intros m b m' H Hm.
      + destruct (follows_sound mean mean_equivalent _ _ _ _ _ _ H Hm) as [S1 Q1]. split; auto.
        intros Hb s i [Hd _] Hf. specialize (Q1 Hb _ (model_from_decides s None i Hd)).
        rewrite !later_true_here in Q1 by auto. auto.
      + eapply steps_to_sound; eauto.
      + eapply steps_to_sound; eauto. intros P HP. rewrite disjunction_true, !later_any_true by auto.
        intros [(g & B1 & B2) | (g & B1 & B2)]; exists g; split; auto; apply in_app_iff; auto.
    - apply (steps_to_sound f TRUE (later_any (all_members lower))) with (m := m); auto. now rewrite conjunction_TRUE.
  Qed.

  Lemma level_never : forall d lower, never (all_members lower) -> (forall f, In f (members d) -> dead_in d lower f) ->
    never (members d ++ all_members lower).
  Proof.
    intros d lower Hlow Hdead s i0 Hw. pose proof Hw as [Hd _].
    assert (HL : forall f i, In f (members d) -> ~ sat f s None i).
    { intros f i Hf Hs. pose proof (Hdead f Hf) as HF. unfold dead_in in HF, Hdead.
      destruct (eventuality d) as [[stay goal]|]; [|apply (Hlow s (S i) Hw); apply HF; simpl; auto].
      destruct HF as (HU & _ & _). destruct (HU s i Hw Hs) as (k & Hk & _ & Hr & _). clear HU.
      remember (k - i) as n eqn:En. revert f i Hf Hs Hk En.
      induction n as [|n IH]; intros f i Hf Hs Hk En; destruct (Hdead f Hf) as (_ & H1 & H2);
        pose proof (unfold_correct goal s None i Hd I) as HR.
      - replace k with i in Hr by lia. apply (Hlow s (S i) Hw), H1; auto. now apply HR.
      - destruct (Hd goal i) as [Hri|Hri]; [apply (Hlow s (S i) Hw), H1; auto; now apply HR|].
        destruct (H2 s i Hw Hs) as (g & B1 & B2).
        { rewrite negation_true by now apply model_at_decides. now rewrite HR. }
        apply in_app_iff in B1. destruct B1 as [B1|B1]; [|apply (Hlow s (S i) Hw); exists g; auto].
        apply (IH g (S i)); auto; lia. }
    intros (f & Hf & Hs). apply in_app_iff in Hf.
    destruct Hf as [Hf|Hf]; [apply (HL f i0); auto | apply (Hlow s i0 Hw); exists f; auto].
  Qed.

  Lemma levels_are_dead_sound : forall ls m b m', levels_are_dead depth allowed ls m = (b, m') -> sound mean m ->
    sound mean m' /\ (b = true -> never (all_members ls)).
  Proof.
    induction ls as [|d lower IH]; intros m b m' H Hm; simpl in H.
    - injection H as <- <-. split; auto. intros _ s i _ (f & [] & _).
    - apply (both_sound mean _ _ (never (all_members lower)) (forall f, In f (members d) -> dead_in d lower f)) in H; auto.
      + destruct H as [S1 Q1]. split; auto. intros Hb. destruct (Q1 Hb). now apply level_never.
      + intros m1 b1 m1' H1 Hm1. apply (all_sound mean _ (dead_in d lower)) in H1; auto.
        intros; eapply member_is_dead_sound; eauto.
  Qed.
End Levels.

(** * What an accepted certificate proves *)

Section Accepted.
  Variables (depth work : nat) (C : certificate).
  Hypothesis HC : check depth work C = true.
  Let phi := encode (encoded_by C) (subject C).
  Let A := assumption C.
  Let M := machine C.
  Let dead := all_members (levels C).
  Let before := known M (annotations C) dead phi.

  Lemma accepted : never A dead /\ (forall q v, nth_error (verdicts M) q = Some v -> right_state A M (annotations C) dead q) /\
    forall s n, (forall k, k < n -> at_letter A (s k) = true) -> exists q, reaches M s n q /\ before s n q.
  Proof.
    unfold check in HC. apply andb_true_iff in HC. destruct HC as [_ HS]. fold A M dead phi in HS.
    match type of HS with fst ?e = _ => destruct e as [b m] eqn:E end. simpl in HS. subst b.
    set (mean := meaning M (annotations C) dead).
    apply (both_sound mean _ _ (never A dead)
      ((forall l, settled M (annotations C) dead l 0 (later phi)) /\
       (forall q, In q (seq 0 (length (verdicts M))) -> right_state A M (annotations C) dead q))) in E.
    - destruct E as [_ E]. destruct (E eq_refl) as (H1 & H2 & H3).
      assert (HQ : forall q v, nth_error (verdicts M) q = Some v -> right_state A M (annotations C) dead q).
      { intros q v Hq. apply H3, in_seq. split; [lia|]. apply nth_error_Some. congruence. }
      repeat split; auto. intros s n Hs. now apply (run_known A M (annotations C) dead phi).
    - intros; eapply levels_are_dead_sound; eauto. reflexivity.
    - apply both_sound; intros m1 b m2 H Hm.
      + eapply settles_sound; eauto.
      + apply (all_sound mean _ (right_state A M (annotations C) dead)) in H; auto.
        intros; eapply state_is_right_sound; eauto.
    - apply new_memory_sound.
  Qed.

  (** The runs in question are those over allowed letters. *)
  Definition run_allowed (w : list letter) : Prop := forall k, k < length w -> at_letter A (at_step w k) = true.
  Definition continues (w : list letter) (s : stream) : Prop :=
    (forall k, k < length w -> s k = at_step w k) /\ forall k, at_letter A (s k) = true.

  (** There is something to speak of: runs of every length, and a continuation of each. *)
  Lemma a_letter : exists l, at_letter A l = true.
  Proof. unfold check in HC. apply andb_true_iff in HC. eexists. apply HC. Qed.

  Theorem check_runs : forall n, exists w, length w = n /\ run_allowed w.
  Proof.
    destruct a_letter as [l Hl]. intros n. exists (repeat l n). split; [apply repeat_length|].
    intros k Hk. rewrite repeat_length in Hk. unfold at_step. rewrite nth_indep with (d' := l) by now rewrite repeat_length.
    now rewrite nth_repeat.
  Qed.

  Theorem check_continues : forall w, run_allowed w -> exists s, continues w s.
  Proof.
    destruct a_letter as [l Hl]. intros w Hw. exists (fun k => if k <? length w then at_step w k else l). split.
    - intros k Hk. now rewrite (proj2 (Nat.ltb_lt _ _) Hk).
    - intros k. destruct (Nat.ltb_spec k (length w)); auto.
  Qed.

  Lemma run_starts_like : forall w, starts_like (at_step w) (length w) (at_step w) (Some (length w)).
  Proof. intros w. split; [apply decided_finite | simpl; auto]. Qed.

  Lemma continues_starts_like : forall w s, decided s None -> continues w s ->
    starts_like (at_step w) (length w) s None.
  Proof. intros w s Hd [H _]. split; simpl; auto. Qed.

  (** After every run there is one state, with a verdict; where it says 'presumably', it is that of the finite run. This
      needs no axiom. *)
  Theorem check_finite : forall w, run_allowed w -> exists q v,
    reaches M (at_step w) (length w) q /\ nth_error (verdicts M) q = Some v /\
    (v = PresumablySatisfied -> holds phi w = true) /\ (v = PresumablyViolated -> holds phi w = false).
  Proof.
    intros w Hw. destruct accepted as (_ & HS & HR). destruct (HR _ _ Hw) as (q & B1 & B2). unfold before, known in B2.
    destruct (nth_error (verdicts M) q) as [v|] eqn:Ev; [|destruct B2]. exists q, v.
    destruct (HS q v Ev) as (v' & t & Ev' & _ & H3). rewrite Ev in Ev'. injection Ev' as <-.
    assert (HF : forall f, In f (nth q (annotations C) []) ->
      (forall s' L, starts_like (at_step w) (length w) s' L -> sat phi s' L 0 <-> sat f s' L (length w)) ->
      holds phi w = holds f []).
    { intros f _ Hf. specialize (Hf _ _ (run_starts_like w)). rewrite <- (holds_sat phi w 0), <- holds_sat, skipn_all in Hf.
      now apply eq_true_iff_eq. }
    repeat split; auto; intros ->; destruct B2 as (f & H1 & H2); rewrite (HF f H1 H2); destruct (H3 f H1) as [H4 _].
    - now apply H4.
    - destruct (holds f []); auto. destruct H4 as [H4 _]. specialize (H4 eq_refl). discriminate.
  Qed.

  (** Permanent verdicts hold for every continuation of the run. *)
  Theorem check_permanent : forall w q s, run_allowed w -> reaches M (at_step w) (length w) q ->
    decided s None -> continues w s ->
    (nth_error (verdicts M) q = Some Violated -> ~ sat phi s None 0) /\
    (nth_error (verdicts M) q = Some Satisfied -> sat phi s None 0).
  Proof.
    intros w q s Hw Hq Hd Hc. destruct accepted as (HN & _ & HR). destruct (HR _ _ Hw) as (q' & B1 & B2).
    assert (q' = q) by (eapply reaches_unique; eauto). subst q'.
    assert (HX : ~ exists k, some_sat dead s None k).
    { intros [k Hk]. apply (HN s k); auto. split; auto. apply Hc. }
    unfold before, known in B2. split; intros Ev; rewrite Ev in B2; specialize (B2 s None (continues_starts_like w s Hd Hc)).
    - intros Hs. auto.
    - destruct (Hd phi 0) as [H|H]; auto. exfalso; auto.
  Qed.

  (** Where there is no permanent verdict, there are continuations of either kind. *)
  Definition followed_by (w : list letter) (u : lasso) : stream := fun k =>
    if k <? length w then at_step w k else lasso_word u (k - length w).

  Lemma followed_by_sat : forall w u f, sat f (followed_by w u) None (length w) <-> sat f (lasso_word u) None 0.
  Proof.
    intros w u f. rewrite <- (Nat.add_0_r (length w)), sat_shift. apply sat_ext. intros k _ _.
    unfold followed_by. rewrite (proj2 (Nat.ltb_ge _ _)) by lia. f_equal. lia.
  Qed.

  Lemma followed_by_continues : forall w u, run_allowed w -> is_allowed A u = true ->
    loop u <> [] /\ continues w (followed_by w u).
  Proof.
    intros w u Hw Hu. unfold is_allowed in Hu. assert (Hl : loop u <> []) by (destruct (loop u); congruence).
    assert (HF : forallb (at_letter A) (letters u) = true) by (destruct (loop u); congruence).
    rewrite forallb_forall in HF. pose proof (loop_length u Hl) as Hlen. split; auto. split; intros k.
    - intros Hk. unfold followed_by. now rewrite (proj2 (Nat.ltb_lt _ _) Hk).
    - unfold followed_by. destruct (Nat.ltb_spec k (length w)); [now apply Hw|]. apply HF.
      unfold lasso_word, letters. apply in_app_iff. destruct (Nat.ltb_spec (k - length w) (length (stem u))).
      + left. now apply nth_In.
      + right. apply nth_In. apply Nat.mod_upper_bound. lia.
  Qed.

  Theorem check_exact : forall w q v, (forall s, decided s None) -> exact C = true ->
    run_allowed w -> reaches M (at_step w) (length w) q ->
    nth_error (verdicts M) q = Some v -> v = PresumablySatisfied \/ v = PresumablyViolated ->
    (exists s, continues w s /\ sat phi s None 0) /\ (exists s, continues w s /\ ~ sat phi s None 0).
  Proof.
    intros w q v Hdec HE Hw Hq Ev Hv. destruct accepted as (_ & _ & HR). destruct (HR _ _ Hw) as (q' & B1 & B2).
    assert (q' = q) by (eapply reaches_unique; eauto). subst q'.
    assert (HK : exists f, In f (nth q (annotations C) []) /\ forall s, continues w s ->
                   (sat phi s None 0 <-> sat f s None (length w))).
    { unfold before, known in B2. rewrite Ev in B2.
      destruct Hv; subst v; destruct B2 as (f & H1 & H2); exists f; split; auto; intros s Hs; apply H2;
        now apply continues_starts_like. }
    destruct HK as (f & Hf & HK).
    unfold exact in HE. rewrite forallb_forall in HE. specialize (HE q).
    rewrite in_seq in HE. assert (Hq' : q < length (verdicts M)) by (apply nth_error_Some; congruence).
    specialize (HE (conj (Nat.le_0_l _) Hq')). cbv zeta in HE. apply andb_true_iff in HE. destruct HE as [HA HO].
    rewrite forallb_forall in HA, HO. specialize (HO f Hf). unfold is_open in HO. apply andb_true_iff in HO.
    destruct HO as [H1 H2]. apply existsb_exists in H1, H2. destruct H1 as (u1 & I1 & H1), H2 as (u2 & I2 & H2).
    destruct (followed_by_continues w u1 Hw (HA u1 I1)) as [L1 C1], (followed_by_continues w u2 Hw (HA u2 I2)) as [L2 C2].
    split.
    - exists (followed_by w u1). split; auto. rewrite (HK _ C1), followed_by_sat. now apply holds_on_lasso_correct.
    - exists (followed_by w u2). split; auto. rewrite (HK _ C2), followed_by_sat.
      rewrite <- (holds_on_lasso_correct u2 L2). destruct (holds_on_lasso f u2); simpl in H2; congruence.
  Qed.
End Accepted.
