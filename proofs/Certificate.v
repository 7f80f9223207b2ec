(** Certificates for monitors, their checker, and the proof that it may be believed.

    A certificate annotates every state that has no permanent verdict with places: a state of the reset machine of the
    property, which the checker works out itself, and a formula. After each run that leads to the monitor's state, one
    of them says where the clocks are and what remains to be satisfied. For the permanent verdicts it lists places from
    which no word of the machine goes on to satisfy what remains, in levels. For the others it gives words that satisfy
    and that violate each annotation. A property without time has the machine with one state.

    Python: [ltlc/semantics/certificate.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Lasso Properties Past Encodings Clocks Registers Trackers Resets Monitor Conditions Judgements Moves
  Machines Distribute.

Definition place : Type := clocks * formula.

(** What cannot go on for ever without: an eventuality [stay U goal], or a fairness set of the machine. *)
Inductive progress := Eventuality (stay goal : formula) | FairSet (i : nat).

(** A level of places from which no word satisfies what remains. Without progress, every step leads to the levels after
    it in the list. With an eventuality, each formula of the level implies it; a step with its goal leads to the levels
    after, and a step without to those or to the level itself. So do the steps in a fairness set, and those that are
    not. *)
Record level := { progresses : option progress; members : list place }.

Record certificate := {
  subject : property;
  defined : definitions;               (* what the atoms of the past are *)
  news : list nat;                     (* the atoms that are news *)
  encoded_by : encoding;
  assumption : predicate;              (* what is known of every letter, for the atoms are not free *)
  machine : monitor;
  annotations : list (list place);     (* by state *)
  levels : list level;
  witnesses : list (list lasso)        (* by state *)
}.

(** What the checker works out from the property. *)
Definition judged (C : certificate) : property := distribute (subject C).
Definition formula_of (C : certificate) : formula := encode (encoded_by C) (judged C).
Definition trackers (C : certificate) : list tracker_of := trackers_for (defined C) (judged C).

(** * The checker *)

Definition all_members (ls : list level) : list place := flat_map members ls.

(** For each state of the machine, that what remains in one of the places with it has to be satisfied. *)
Definition conditions : Type := list (clocks * condition).
Fixpoint at_clocks (k : clocks) (t : conditions) : condition :=
  match t with [] => Constant false | (k', c) :: t => if clocks_eqb k k' then c else at_clocks k t end.
Fixpoint add (k : clocks) (c : condition) (t : conditions) : conditions :=
  match t with
  | [] => [(k, c)]
  | (k', d) :: t => if clocks_eqb k k' then (k', disjunction c d) :: t else (k', d) :: add k c t
  end.
Definition somewhere (ps : list place) : conditions := fold_right (fun p => add (fst p) (later (snd p))) [] ps.

Definition same_verdict (v w : verdict) : bool :=
  match v, w with
  | Violated, Violated | PresumablyViolated, PresumablyViolated
  | PresumablySatisfied, PresumablySatisfied | Satisfied, Satisfied => true
  | _, _ => false
  end.

Section Checker.
  Variables (depth : nat) (news : list nat) (xs : list tracker_of) (allowed : condition) (M : monitor).
  Variable annotated : list (list place).
  (** What the checker compares with, worked out once: the conditions of the annotations, and of the dead places. *)
  Variables (remains : list conditions) (dead : conditions).

  (** Whether it is right to be in states q and k when [c] remains to be satisfied. *)
  Definition settles (q : nat) (k : clocks) (c : condition) : judgement :=
    match nth_error (verdicts M) q with
    | Some Violated => follows depth c (at_clocks k dead)
    | Some Satisfied => follows depth (negation c) (at_clocks k dead)
    | Some _ =>
        any (fun p => if clocks_eqb k (fst p) then equivalent depth c (snd p) else verdict_is false) (nth q remains [])
    | None => verdict_is false
    end.

  (** Whether every letter that [ctx] allows leads from t to a state where it is right to be, with the clocks in k. *)
  Fixpoint covers (fuel : nat) (t : target) (k : clocks) (ctx c : condition) (m : memory) : bool * memory :=
    match ctx with
    | Constant false => (true, m)
    | _ =>
      match fuel, spend (weight ctx + weight c) m with
      | S fuel, Some m =>
        match recall (Covered t k ctx c) m with
        | Some b => (b, m)
        | None =>
            let cases a low high :=
              both (covers fuel high k (assign (AtStep a) true ctx) (assign (AtStep a) true c))
                   (covers fuel low k (assign (AtStep a) false ctx) (assign (AtStep a) false c)) in
            let (b, m) :=
              match t with
              | Ask d => match nth_error (decisions M) d with
                         | Some a => cases (atom a) (low a) (high a) m
                         | None => (false, m)
                         end
              | State q =>
                  match first_atom c, first_atom ctx with
                  | Some a, _ => cases a t t m
                  | None, Some a => either (settles q k c) (cases a t t) m
                  | None, None => settles q k c m
                  end
              end in
            (b, remember (Covered t k ctx c) b m)
        end
      | _, _ => (false, m)
      end
    end.

  (** The finite reading of a state's annotations is its verdict, and its edges are covered; a permanent verdict
      stays. *)
  Definition place_is_right (t : target) (b : bool) (p : place) : judgement :=
    both (verdict_is (Bool.eqb (holds (snd p) []) b))
         (each_move news xs (fst p) allowed (fun ctx k _ => covers depth t k ctx (unfold (snd p)))).
  Definition state_is_right (q : nat) : judgement :=
    match nth_error (verdicts M) q, nth_error (edges M) q with
    | Some PresumablyViolated, Some t => all (place_is_right t false) (nth q annotated [])
    | Some PresumablySatisfied, Some t => all (place_is_right t true) (nth q annotated [])
    | Some v, Some (State r) =>
        verdict_is (match nth_error (verdicts M) r with Some w => same_verdict v w | None => false end)
    | _, _ => verdict_is false
    end.

  (** Whether every word from a place where f remains has a step that progresses; and whether a step does. *)
  Definition must_come (p : option progress) (f : formula) : judgement :=
    match p with
    | None => verdict_is true
    | Some (Eventuality stay goal) => follows depth (later f) (later (Ltl.Until stay goal))
    | Some (FairSet i) => verdict_is (i <? sets news xs)
    end.
  Definition coming (p : option progress) (fair : list bool) : condition :=
    match p with
    | None => TRUE
    | Some (Eventuality _ goal) => unfold goal
    | Some (FairSet i) => Constant (nth i fair false)
    end.

  Definition member_is_dead (by_ : option progress) (here below : conditions) (p : place) : judgement :=
    both (must_come by_ (snd p))
         (each_move news xs (fst p) allowed (fun ctx k fair =>
            let now := conjunction ctx (unfold (snd p)) in
            let after := at_clocks k below in
            both (follows depth (conjunction now (coming by_ fair)) after)
                 (follows depth (conjunction now (negation (coming by_ fair)))
                    (disjunction (at_clocks k here) after)))).

  Fixpoint levels_are_dead (ls : list level) : judgement :=
    match ls with
    | [] => verdict_is true
    | d :: lower =>
        both (levels_are_dead lower)
             (all (member_is_dead (progresses d) (somewhere (members d)) (somewhere (all_members lower))) (members d))
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

(** Whether the atoms are defined as the theorems ask, and nothing is assumed of those that time decides. *)
Definition well_defined (C : certificate) : bool :=
  proper (defined C) (judged C) (news C) && negb (asks_time (news C) (trackers C) (assumption C)).

(** [depth] bounds the nesting of case distinctions, [work] their number, weighed by the size of the conditions. *)
Definition check (depth work : nat) (C : certificate) : bool :=
  possible depth (assumption C) && well_defined C &&
  let allowed := unfold (as_formula (assumption C)) in
  let xs := trackers C in
  let M := machine C in
  let dead := somewhere (all_members (levels C)) in
  let remains := map (map (fun p => (fst p, later (snd p)))) (annotations C) in
  let start := settles depth M remains dead 0 (start xs) (later (formula_of C)) in
  let states :=
    all (state_is_right depth (news C) xs allowed M (annotations C) remains dead) (seq 0 (length (verdicts M))) in
  fst (both (levels_are_dead depth (news C) xs allowed (levels C)) (both start states) (new_memory work)).

(** Whether the verdicts that are not permanent are shown to be open: each annotation has a word for and a word
    against. *)
Definition is_allowed (A : predicate) (u : lasso) : bool :=
  match loop u with [] => false | _ => forallb (at_letter A) (Lasso.letters u) end.
Definition is_open (news : list nat) (xs : list tracker_of) (us : list lasso) (p : place) : bool :=
  let runs := filter (is_run news xs (fst p)) us in
  existsb (holds_on_lasso (snd p)) runs && existsb (fun u => negb (holds_on_lasso (snd p) u)) runs.
Definition exact (C : certificate) : bool :=
  let xs := trackers C in
  forallb (fun q => let us := nth q (witnesses C) [] in
                    forallb (is_allowed (assumption C)) us &&
                    forallb (is_open (news C) xs us) (nth q (annotations C) []))
    (seq 0 (length (verdicts (machine C)))).

(** * What conditions say of places *)

Lemma later_true_next : forall s L i, decided s L -> forall f, true_in (model_at s L i) (later f) <-> sat f s L (S i).
Proof. intros s L i Hd. apply later_true; [now apply model_at_decides | reflexivity]. Qed.

(** The model that judges formulas from step i on itself, and knows no atom. *)
Definition model_from (s : stream) (L : option nat) (i : nat) : model := fun x =>
  match x with AtStep _ => False | FromNext f => sat f s L i end.
Lemma model_from_decides : forall s L i, decided s L -> decides (model_from s L i).
Proof. intros s L i Hd [a|f]; simpl; auto. Qed.
Lemma later_true_here : forall s L i, decided s L -> forall f, true_in (model_from s L i) (later f) <-> sat f s L i.
Proof. intros s L i Hd. apply later_true; [now apply model_from_decides | reflexivity]. Qed.

Lemma add_true : forall P, decides P -> forall k k' c t,
  true_in P (at_clocks k (add k' c t)) <-> (k = k' /\ true_in P c) \/ true_in P (at_clocks k t).
Proof.
  assert (HE : forall k k' : clocks, clocks_eqb k k' = true /\ k = k' \/ clocks_eqb k k' = false /\ k <> k').
  { intros k k'. pose proof (clocks_eqb_eq k k'). destruct (clocks_eqb k k'); [left | right]; split; auto;
      [now apply H | intros E; apply H in E; discriminate]. }
  intros P HP k k' c t. induction t as [|[k1 d] t IH]; simpl.
  - destruct (HE k k') as [[-> E]|[-> E]]; simpl; intuition congruence.
  - destruct (HE k' k1) as [[-> ->]|[-> E1]]; simpl.
    + destruct (HE k k1) as [[-> ->]|[-> E]]; [rewrite disjunction_true by auto|]; intuition congruence.
    + destruct (HE k k1) as [[-> ->]|[-> E]]; [intuition congruence | exact IH].
Qed.

Lemma somewhere_true : forall P, decides P -> forall k ps,
  true_in P (at_clocks k (somewhere ps)) <-> exists f, In (k, f) ps /\ true_in P (later f).
Proof.
  intros P HP k ps. induction ps as [|[k' f] ps IH]; simpl.
  - split; [discriminate | intros (f & [] & _)].
  - rewrite add_true, IH by auto. simpl. split.
    + intros [[-> H]|(g & A & B)]; eauto.
    + intros (g & [E|A] & B); [injection E as -> ->; auto | eauto].
Qed.

(** Some place of [ps] is where the word is at step i. *)
Definition some_place (ps : list place) (path : nat -> clocks) (s : stream) (L : option nat) (i : nat) : Prop :=
  exists f, In (path i, f) ps /\ sat f s L i.

Section Soundness.
  Variables (depth : nat) (news : list nat) (xs : list tracker_of) (A : predicate) (M : monitor).
  Variables (annotated : list (list place)) (dead : list place).
  Let allowed := unfold (as_formula A).
  Let remains := map (map (fun p : place => (fst p, later (snd p)))) annotated.

  (** What it means for the states q and k to be right when [c] remains to be satisfied after letter l. *)
  Definition settled_at (l : letter) (q : nat) (k : clocks) (c : condition) : Prop :=
    match nth_error (verdicts M) q with
    | Some Violated => forall P, reads P l -> true_in P c -> exists f, In (k, f) dead /\ true_in P (later f)
    | Some Satisfied => forall P, reads P l -> ~ true_in P c -> exists f, In (k, f) dead /\ true_in P (later f)
    | Some _ => exists f, In (k, f) (nth q annotated []) /\ forall P, reads P l -> (true_in P c <-> true_in P (later f))
    | None => False
    end.

  Definition meaning (x : claim) : Prop :=
    match x with
    | Equivalent c d => same c d
    | Covered t k ctx c => forall l, true_in (model_of l) ctx -> exists q, leads M l t q /\ settled_at l q k c
    end.

  Lemma meaning_equivalent : forall c d, meaning (Equivalent c d) <-> same c d.
  Proof. reflexivity. Qed.
  Hint Resolve meaning_equivalent : core.

  Lemma settles_shows : forall q k c, shows meaning (settles depth M remains (somewhere dead) q k c)
    (forall l, settled_at l q k c).
  Proof.
    intros q k c. unfold settles, settled_at.
    assert (HA : shows meaning
      (any (fun p => if clocks_eqb k (fst p) then equivalent depth c (snd p) else verdict_is false) (nth q remains []))
      (forall l, exists f, In (k, f) (nth q annotated []) /\
         forall P, reads P l -> (true_in P c <-> true_in P (later f)))).
    { eapply shows_some.
      - apply (any_shows meaning _ (fun p => k = fst p /\ same c (snd p))). intros [k' d]. simpl.
        destruct (clocks_eqb k k') eqn:E; [|now apply verdict_is_shows]. apply clocks_eqb_eq in E.
        eapply shows_some; [now apply equivalent_shows | auto].
      - intros ([k' d] & H & E & HS) l. simpl in *. subst k'. unfold remains in H.
        change (@nil (clocks * condition)) with (map (fun p : place => (fst p, later (snd p))) []) in H.
        rewrite map_nth in H. apply in_map_iff in H. destruct H as ((k' & f) & E & H). injection E as -> <-.
        exists f. split; auto. intros P [HP _]. auto. }
    destruct (nth_error (verdicts M) q) as [[]|]; auto; [| |apply verdict_is_shows; discriminate];
      (eapply shows_some; [now apply follows_shows|]); intros H l P [HP _] Hc;
        apply (somewhere_true P HP), H; auto. now apply negation_true.
  Qed.

  Lemma settled_assign : forall l q k a c, settled_at l q k (assign (AtStep a) (l a) c) -> settled_at l q k c.
  Proof.
    intros l q k a c. unfold settled_at.
    assert (E : forall P, reads P l -> true_in P (assign (AtStep a) (l a) c) <-> true_in P c).
    { intros P [HP Ha]. apply assign_true; auto. }
    destruct (nth_error (verdicts M) q) as [[]|]; auto.
    - intros H P HP Hc. apply (H P HP). now apply E.
    - intros (f & H1 & H2). exists f; split; auto. intros P HP. rewrite <- (E P HP). auto.
    - intros (f & H1 & H2). exists f; split; auto. intros P HP. rewrite <- (E P HP). auto.
    - intros H P HP Hc. apply (H P HP). now rewrite E.
  Qed.

  Lemma cases_sound : forall t a low high k ctx c,
    (forall l q, leads M l (if l a then high else low) q -> leads M l t q) ->
    meaning (Covered high k (assign (AtStep a) true ctx) (assign (AtStep a) true c)) ->
    meaning (Covered low k (assign (AtStep a) false ctx) (assign (AtStep a) false c)) ->
    meaning (Covered t k ctx c).
  Proof.
    intros t a low high k ctx c Ht Hh Hl l Hc.
    assert (E : true_in (model_of l) (assign (AtStep a) (l a) ctx)).
    { apply assign_true; auto; [apply model_of_reads | simpl; tauto]. }
    assert (HQ : exists q, leads M l (if l a then high else low) q /\ settled_at l q k (assign (AtStep a) (l a) c)).
    { destruct (l a); [apply (Hh l E) | apply (Hl l E)]. }
    destruct HQ as (q & B & D). exists q. split; auto. eapply settled_assign; eauto.
  Qed.

  Lemma covers_shows : forall fuel t k ctx c, shows meaning (covers depth M remains (somewhere dead) fuel t k ctx c)
    (meaning (Covered t k ctx c)).
  Proof.
    induction fuel as [|fuel IH]; intros t k ctx c m b m' H Hm.
    - simpl in H. destruct ctx as [[]| | | |]; injection H as <- <-; split; auto; congruence.
    - assert (HB : forall a low high, (forall l q, leads M l (if l a then high else low) q -> leads M l t q) ->
        shows meaning
          (both (covers depth M remains (somewhere dead) fuel high k
                   (assign (AtStep a) true ctx) (assign (AtStep a) true c))
                (covers depth M remains (somewhere dead) fuel low k
                   (assign (AtStep a) false ctx) (assign (AtStep a) false c)))
          (meaning (Covered t k ctx c))).
      { intros a low high Ht. eapply shows_some; [apply both_shows; apply IH|]. intros [H1 H2].
        now apply (cases_sound t a low high). }
      simpl in H.
      assert (HF : ctx = Constant false \/
                forall (X : Type) (x y : X), match ctx with Constant false => x | _ => y end = y).
      { destruct ctx as [[]| | | |]; auto. }
      destruct HF as [-> | HF].
      { injection H as <- <-. split; auto. intros _ l Hl. discriminate Hl. }
      rewrite HF in H. clear HF.
      destruct (spend (weight ctx + weight c) m) as [m1|] eqn:Es; [|injection H as <- <-; split; auto; congruence].
      apply (spend_sound meaning) in Es; auto.
      destruct (recall (Covered t k ctx c) m1) as [r|] eqn:Er.
      { injection H as <- <-. split; auto. intros ->. exact (recall_sound meaning _ _ Es Er). }
      match type of H with (let (_, _) := ?e in _) = _ => destruct e as [r m2] eqn:E end.
      injection H as <- <-.
      assert (HR : sound meaning m2 /\ (r = true -> meaning (Covered t k ctx c))).
      { destruct t as [q|d].
        - assert (HQ : shows meaning (settles depth M remains (somewhere dead) q k c)
                    (meaning (Covered (State q) k ctx c))).
          { eapply shows_some; [apply settles_shows|]. intros HQ l _. exists q. split; [constructor | auto]. }
          assert (HS : forall a l q', leads M l (if l a : bool then State q else State q) q' -> leads M l (State q) q')
            by (intros a l q'; destruct (l a); auto).
          destruct (first_atom c) as [a|]; [exact (HB a _ _ (HS a) _ _ _ E Es)|].
          destruct (first_atom ctx) as [a|]; [|exact (HQ _ _ _ E Es)].
          exact (either_shows meaning _ _ _ HQ (HB a _ _ (HS a)) _ _ _ E Es).
        - destruct (nth_error (decisions M) d) as [e|] eqn:Ed.
          + eapply (HB (atom e) (low e) (high e)); eauto. intros l q. now apply leads_ask.
          + injection E as <- <-. split; auto; congruence. }
      destruct HR. split; auto using remember_sound.
  Qed.

  (** What it means for a state to be right. *)
  Definition right_place (t : target) (b : bool) (p : place) : Prop :=
    holds (snd p) [] = b /\
    forall l m, at_letter A l = true -> In m (moves news xs (fst p)) -> at_letter (letters m) l = true ->
      exists q, leads M l t q /\ settled_at l q (Resets.target m) (unfold (snd p)).
  Definition right_state (q : nat) : Prop :=
    exists v t, nth_error (verdicts M) q = Some v /\ nth_error (edges M) q = Some t /\
    match v with
    | PresumablyViolated => forall p, In p (nth q annotated []) -> right_place t false p
    | PresumablySatisfied => forall p, In p (nth q annotated []) -> right_place t true p
    | _ => exists r, t = State r /\ nth_error (verdicts M) r = Some v
    end.

  Lemma place_is_right_shows : forall t b p,
    shows meaning (place_is_right depth news xs allowed M remains (somewhere dead) t b p) (right_place t b p).
  Proof.
    intros t b [k f]. eapply shows_some.
    - apply both_shows; [apply (verdict_is_shows _ _ (holds f [] = b)); apply eqb_prop|].
      apply (each_move_shows news xs meaning k allowed _ (fun c to _ => meaning (Covered t to c (unfold f)))).
      intros c to fs. apply covers_shows.
    - intros [H1 H2]. split; auto. intros l m Hl Hm HP.
      destruct (H2 l m (lets_predicate l A Hl) Hm HP) as (c & Hc & HC). apply HC, Hc, model_of_reads.
  Qed.

  Lemma state_is_right_shows : forall q,
    shows meaning (state_is_right depth news xs allowed M annotated remains (somewhere dead) q) (right_state q).
  Proof.
    intros q. unfold state_is_right, right_state.
    assert (HN : forall Q, shows meaning (verdict_is false) Q) by (intros Q; now apply verdict_is_shows).
    destruct (nth_error (verdicts M) q) as [v|] eqn:Ev; [|apply HN].
    destruct (nth_error (edges M) q) as [t|] eqn:Et; [|destruct v; apply HN].
    assert (HP : v = Violated \/ v = Satisfied -> shows meaning
        match t with
        | State r => verdict_is (match nth_error (verdicts M) r with Some w => same_verdict v w | None => false end)
        | Ask _ => verdict_is false
        end
        (exists r, t = State r /\ nth_error (verdicts M) r = Some v)).
    { intros Hv. destruct t as [r|]; [|apply HN]. apply verdict_is_shows. intros H. exists r. split; auto.
      destruct (nth_error (verdicts M) r) as [w|]; [|discriminate].
      destruct Hv as [-> | ->]; destruct w; try discriminate; auto. }
    destruct v;
      (eapply shows_some; [first [apply HP; auto; fail | apply all_shows; intros; apply place_is_right_shows]|]);
      intros H; do 2 eexists; eauto.
  Qed.

  (** * Words *)
  Variable phi : formula.
  Hypothesis start_right : forall l, settled_at l 0 (start xs) (later phi).
  Hypothesis states_right : forall q v, nth_error (verdicts M) q = Some v -> right_state q.

  (** The path of the first n letters, all allowed. *)
  Definition path_of (s : stream) (path : nat -> clocks) (n : nat) : Prop :=
    path 0 = start xs /\
    forall k, k < n -> at_letter A (s k) = true /\ exists m, moves_by news xs (path k) (s k) (path (S k)) m.

  (** What is known when the first n letters of [s] have led to state q: of every word that starts with them. *)
  Definition starts_like (s : stream) (n : nat) (s' : stream) (L : option nat) : Prop :=
    decided s' L /\ forall k, k < n -> inside L k /\ s' k = s k.
  Definition known_at (s : stream) (path : nat -> clocks) (n q : nat) : Prop :=
    match nth_error (verdicts M) q with
    | Some Violated => forall s' L, starts_like s n s' L -> sat phi s' L 0 ->
        exists k, k <= n /\ some_place dead path s' L k
    | Some Satisfied => forall s' L, starts_like s n s' L -> ~ sat phi s' L 0 ->
        exists k, k <= n /\ some_place dead path s' L k
    | Some _ => exists f, In (path n, f) (nth q annotated []) /\
                  forall s' L, starts_like s n s' L -> (sat phi s' L 0 <-> sat f s' L n)
    | None => False
    end.

  Lemma known_from_settled : forall s path n q c l, settled_at l q (path n) c ->
    (forall s' L, starts_like s n s' L -> exists P, reads P l /\ (true_in P c <-> sat phi s' L 0) /\
                    (forall f, true_in P (later f) <-> sat f s' L n)) ->
    known_at s path n q.
  Proof.
    intros s path n q c l Hq HP. unfold settled_at in Hq. unfold known_at.
    destruct (nth_error (verdicts M) q) as [[]|]; auto.
    - intros s' L Hs Hphi. destruct (HP s' L Hs) as (P & A1 & A2 & A3).
      destruct (Hq P A1) as (f & B1 & B2); [now apply A2|].
      exists n. split; auto. exists f. split; auto. now apply A3.
    - destruct Hq as (f & B1 & B2). exists f; split; auto. intros s' L Hs.
      destruct (HP s' L Hs) as (P & A1 & A2 & A3). rewrite <- A2, <- A3. auto.
    - destruct Hq as (f & B1 & B2). exists f; split; auto. intros s' L Hs.
      destruct (HP s' L Hs) as (P & A1 & A2 & A3). rewrite <- A2, <- A3. auto.
    - intros s' L Hs Hphi. destruct (HP s' L Hs) as (P & A1 & A2 & A3).
      destruct (Hq P A1) as (f & B1 & B2); [now rewrite A2|].
      exists n. split; auto. exists f. split; auto. now apply A3.
  Qed.

  Lemma known_start : forall s path, path 0 = start xs -> known_at s path 0 0.
  Proof.
    intros s path H0. apply (known_from_settled s path 0 0 (later phi) no_atom); [rewrite H0; apply start_right|].
    intros s' L [Hd _]. exists (model_from s' L 0). pose proof (later_true_here s' L 0 Hd) as HL.
    repeat split; try apply HL.
    - now apply model_from_decides.
    - simpl. tauto.
    - simpl. unfold no_atom. congruence.
  Qed.

  Lemma starts_like_le : forall s n s' L, starts_like s (S n) s' L -> starts_like s n s' L.
  Proof. intros s n s' L [H1 H2]. split; auto. Qed.

  Lemma known_step : forall s path n q m, at_letter A (s n) = true -> moves_by news xs (path n) (s n) (path (S n)) m ->
    known_at s path n q ->
    exists t q', nth_error (edges M) q = Some t /\ leads M (s n) t q' /\ known_at s path (S n) q'.
  Proof.
    intros s path n q m Ha (M1 & M2 & M3) Hk.
    destruct (nth_error (verdicts M) q) as [v|] eqn:Ev; [|unfold known_at in Hk; rewrite Ev in Hk; destruct Hk].
    destruct (states_right q v Ev) as (v' & t & Ev' & Et & Hv). rewrite Ev in Ev'. injection Ev' as <-.
    assert (HC : forall f b, right_place t b (path n, f) ->
      (forall s' L, starts_like s n s' L -> (sat phi s' L 0 <-> sat f s' L n)) ->
      exists t q', nth_error (edges M) q = Some t /\ leads M (s n) t q' /\ known_at s path (S n) q').
    { intros f b [_ HM] Hphi. destruct (HM (s n) m Ha M1 M2) as (q' & B1 & B2). rewrite M3 in B2.
      exists t, q'. repeat split; auto. apply (known_from_settled s path (S n) q' (unfold f) (s n) B2).
      intros s' L Hs. pose proof Hs as [Hd Hl]. destruct (Hl n) as [Hin Hsn]; [lia|].
      exists (model_at s' L n). split; [rewrite <- Hsn; now apply model_at_reads|]. split.
      - rewrite unfold_correct by auto. symmetry. apply Hphi. now apply starts_like_le.
      - intros g. now apply later_true_next. }
    assert (HS : forall r, t = State r -> nth_error (verdicts M) r = Some v -> (v = Violated \/ v = Satisfied) ->
      exists t q', nth_error (edges M) q = Some t /\ leads M (s n) t q' /\ known_at s path (S n) q').
    { intros r Et' Er Hvv. exists t, r. repeat split; auto; [subst; constructor|].
      unfold known_at in *. rewrite Ev in Hk. rewrite Er.
      destruct Hvv; subst v; intros s' L Hs Hp; destruct (Hk s' L (starts_like_le _ _ _ _ Hs) Hp) as (k & B1 & B2);
        exists k; split; auto. }
    unfold known_at in Hk. rewrite Ev in Hk.
    destruct v; try (destruct Hv as (r & B1 & B2); eauto; fail); destruct Hk as (f & B1 & B2); eauto.
  Qed.

  Lemma run_known : forall s path n, path_of s path n -> exists q, reaches M s n q /\ known_at s path n q.
  Proof.
    intros s path n [H0 HP]. assert (H : forall k, k <= n -> exists q, reaches M s k q /\ known_at s path k q).
    { induction k as [|k IH]; intros Hk.
      - exists 0. split; [constructor | now apply known_start].
      - destruct IH as (q & B1 & B2); [lia|]. destruct (HP k Hk) as (Ha & m & Hm).
        destruct (known_step s path k q m Ha Hm B2) as (t & q' & C1 & C2 & C3).
        exists q'. split; auto. econstructor; eauto. }
    now apply H.
  Qed.
End Soundness.

(** * Levels: no word goes on from their places and satisfies what remains *)
Section Levels.
  Variables (depth : nat) (news : list nat) (xs : list tracker_of) (A : predicate) (mean : claim -> Prop).
  Let allowed := unfold (as_formula A).
  Hypothesis mean_equivalent : forall c d, mean (Equivalent c d) <-> same c d.

  (** A fair word of the machine, over allowed letters. *)
  Record is_word (s : stream) (path : nat -> clocks) : Prop := {
    all_decided : decided s None;
    all_allowed : forall k, at_letter A (s k) = true;
    a_word : word news xs s path
  }.

  Definition never (ps : list place) : Prop := forall s path i, is_word s path -> ~ some_place ps path s None i.

  (** Step i, by move m, progresses. *)
  Definition comes (p : option progress) (s : stream) (i : nat) (m : move) : Prop :=
    match p with
    | None => True
    | Some (Eventuality _ goal) => sat goal s None i
    | Some (FairSet j) => nth j (fair m) false = true
    end.
  (** What is shown of a member of a level. *)
  Definition dead_in (p : option progress) (here below : list place) (x : place) : Prop :=
    (forall s path i, is_word s path -> path i = fst x -> sat (snd x) s None i ->
       exists j m, i <= j /\ moves_by news xs (path j) (s j) (path (S j)) m /\ comes p s j m) /\
    (forall s path i m, is_word s path -> path i = fst x -> sat (snd x) s None i ->
       moves_by news xs (path i) (s i) (path (S i)) m ->
       (comes p s i m -> some_place below path s None (S i)) /\
       (~ comes p s i m -> some_place (here ++ below) path s None (S i))).

  Lemma coming_true : forall p s i m, decided s None ->
    (true_in (model_at s None i) (coming p (fair m)) <-> comes p s i m).
  Proof.
    intros [[stay goal|j]|] s i m Hd; simpl; [|tauto|tauto]. apply unfold_correct; [auto | exact I].
  Qed.

  Lemma must_come_shows : forall p f, shows mean (must_come depth news xs p f)
    (forall s path i, is_word s path -> sat f s None i ->
       exists j m, i <= j /\ moves_by news xs (path j) (s j) (path (S j)) m /\ comes p s j m).
  Proof.
    assert (HA : forall s path i, is_word s path -> exists m, moves_by news xs (path i) (s i) (path (S i)) m).
    { intros s path i Hw. apply Hw. }
    intros [[stay goal|j]|] f.
    - eapply shows_some; [now apply follows_shows|]. intros H s path i Hw Hf.
      specialize (H _ (model_from_decides s None i (all_decided _ _ Hw))).
      rewrite !later_true_here in H by apply Hw. destruct (H Hf) as (j & Hj & _ & Hg & _).
      destruct (HA s path j Hw) as (m & Hm). exists j, m. auto.
    - apply verdict_is_shows. intros H s path i Hw _. apply Nat.ltb_lt in H.
      destruct (a_word _ _ Hw) as (_ & _ & HF). destruct (HF j H i) as (n & m & H1 & H2 & H3). exists n, m. auto.
    - apply verdict_is_shows. intros _ s path i Hw _. destruct (HA s path i Hw) as (m & Hm). exists i, m. simpl. auto.
  Qed.

  Lemma member_is_dead_shows : forall p here below x,
    shows mean (member_is_dead depth news xs allowed p (somewhere here) (somewhere below) x) (dead_in p here below x).
  Proof.
    intros p here below [k f]. eapply shows_some.
    - apply both_shows; [apply must_come_shows|].
      apply (each_move_shows news xs mean k allowed _ (fun c to fs =>
        (forall P, decides P -> true_in P c -> true_in P (unfold f) -> true_in P (coming p fs) ->
           exists g, In (to, g) below /\ true_in P (later g)) /\
        (forall P, decides P -> true_in P c -> true_in P (unfold f) -> ~ true_in P (coming p fs) ->
           exists g, In (to, g) (here ++ below) /\ true_in P (later g)))).
      intros c to fs. eapply shows_some; [apply both_shows; now apply follows_shows|].
      intros [H1 H2]. split; intros P HP Hc Hf Hp.
      + apply somewhere_true, H1; auto. rewrite !conjunction_true. auto.
      + specialize (H2 P HP). rewrite !conjunction_true, negation_true, disjunction_true, !somewhere_true in H2 by auto.
        destruct H2 as [(g & B1 & B2) | (g & B1 & B2)]; auto; exists g; split; auto; apply in_app_iff; auto.
    - intros [H1 H2]. split; [intros s path i Hw _; now apply H1|].
      intros s path i m Hw Hk Hf (M1 & M2 & M3). simpl in Hk, Hf. rewrite Hk in M1.
      pose proof (all_decided _ _ Hw) as Hd.
      destruct (H2 (s i) m (lets_predicate _ A (all_allowed _ _ Hw i)) M1 M2) as (c & Hc & B1 & B2).
      specialize (Hc _ (model_at_reads s None i Hd)). pose proof (model_at_decides s None i Hd) as HP.
      apply (unfold_correct f s None i Hd I) in Hf. rewrite M3 in *.
      rewrite <- (coming_true p s i m Hd). split; intros HC;
        [destruct (B1 _ HP Hc Hf HC) as (g & G1 & G2) | destruct (B2 _ HP Hc Hf HC) as (g & G1 & G2)];
        exists g; split; auto; now apply (later_true_next s None i).
  Qed.

  Lemma comes_decided : forall p s i m, decided s None -> comes p s i m \/ ~ comes p s i m.
  Proof. intros p s i m Hd. rewrite <- coming_true by auto. apply true_in_decided. now apply model_at_decides. Qed.

  Lemma level_never : forall p here below, never below -> (forall x, In x here -> dead_in p here below x) ->
    never (here ++ below).
  Proof.
    intros p here below Hlow Hdead s path i0 Hw.
    assert (HL : forall n i j m f, In (path i, f) here -> sat f s None i -> j = i + n ->
              moves_by news xs (path j) (s j) (path (S j)) m -> ~ comes p s j m).
    { induction n as [|n IH]; intros i j m f Hf Hs -> Hm Hc; destruct (Hdead _ Hf) as [_ HD].
      - rewrite Nat.add_0_r in *. apply (Hlow s path (S i) Hw). now apply (HD s path i m).
      - destruct (a_word _ _ Hw) as (_ & HM & _). destruct (HM i) as (m' & Hm').
        destruct (HD s path i m' Hw eq_refl Hs Hm') as [D1 D2].
        destruct (comes_decided p s i m' (all_decided _ _ Hw)) as [HP|HP]; [now apply (Hlow s path (S i) Hw), D1|].
        destruct (D2 HP) as (g & B1 & B2). apply in_app_iff in B1.
        destruct B1 as [B1|B1]; [|apply (Hlow s path (S i) Hw); exists g; auto].
        apply (IH (S i) (i + S n) m g B1 B2); auto. lia. }
    intros (f & Hf & Hs). apply in_app_iff in Hf. destruct Hf as [Hf|Hf]; [|apply (Hlow s path i0 Hw); exists f; auto].
    destruct (Hdead _ Hf) as [HC _]. destruct (HC s path i0 Hw eq_refl Hs) as (j & m & Hj & Hm & HP).
    apply (HL (j - i0) i0 j m f Hf Hs); auto. lia.
  Qed.

  Lemma levels_are_dead_shows : forall ls,
    shows mean (levels_are_dead depth news xs allowed ls) (never (all_members ls)).
  Proof.
    induction ls as [|d lower IH]; simpl.
    - apply verdict_is_shows. intros _ s path i _ (f & [] & _).
    - eapply shows_some; [apply both_shows; [apply IH | apply all_shows; intros x; apply member_is_dead_shows]|].
      intros [H1 H2]. now apply (level_never (progresses d)).
  Qed.
End Levels.

(** * What an accepted certificate proves of the words of the machine *)

Section Accepted.
  Variables (depth work : nat) (C : certificate).
  Hypothesis HC : check depth work C = true.
  Let phi := formula_of C.
  Let A := assumption C.
  Let M := machine C.
  Let dead := all_members (levels C).
  Let xs := trackers C.

  Lemma accepted_defined : well_defined C = true.
  Proof. unfold check in HC. rewrite !andb_true_iff in HC. tauto. Qed.

  Lemma accepted : never (news C) xs A dead /\
    (forall q v, nth_error (verdicts M) q = Some v -> right_state (news C) xs A M (annotations C) dead q) /\
    forall s path n, path_of (news C) xs A s path n ->
      exists q, reaches M s n q /\ known_at M (annotations C) dead phi s path n q.
  Proof.
    unfold check in HC. apply andb_true_iff in HC. destruct HC as [_ HS]. fold A M dead phi xs in HS.
    match type of HS with fst ?e = _ => destruct e as [b m] eqn:E end. simpl in HS. subst b.
    set (mean := meaning M (annotations C) dead).
    assert (HJ : shows mean (both (levels_are_dead depth (news C) xs (unfold (as_formula A)) (levels C))
        (both (settles depth M (map (map (fun p : place => (fst p, later (snd p)))) (annotations C)) (somewhere dead) 0
                 (start xs) (later phi))
              (all (state_is_right depth (news C) xs (unfold (as_formula A)) M (annotations C)
                      (map (map (fun p : place => (fst p, later (snd p)))) (annotations C)) (somewhere dead))
                 (seq 0 (length (verdicts M))))))
      (never (news C) xs A dead /\ (forall l, settled_at M (annotations C) dead l 0 (start xs) (later phi)) /\
       forall q, In q (seq 0 (length (verdicts M))) -> right_state (news C) xs A M (annotations C) dead q)).
    { apply both_shows; [now apply levels_are_dead_shows|]. apply both_shows; [apply settles_shows|].
      apply all_shows. intros q. apply state_is_right_shows. }
    destruct (HJ _ _ _ E (new_memory_sound mean work)) as [_ H]. destruct (H eq_refl) as (H1 & H2 & H3).
    assert (HQ : forall q v, nth_error (verdicts M) q = Some v -> right_state (news C) xs A M (annotations C) dead q).
    { intros q v Hq. apply H3, in_seq. split; [lia|]. apply nth_error_Some. congruence. }
    split; auto. split; auto. intros s path n Hs. now apply (run_known (news C) xs A M (annotations C) dead phi).
  Qed.

  (** The runs in question: the fair words of the machine, over allowed letters; and how they start. *)
  Definition is_run_of (s : stream) (path : nat -> clocks) : Prop :=
    word (news C) xs s path /\ forall k, at_letter A (s k) = true.
  Definition continues (s : stream) (n : nat) (s' : stream) : Prop :=
    (exists path, is_run_of s' path) /\ forall k, k < n -> s' k = s k.

  Lemma run_path : forall s path n, is_run_of s path -> path_of (news C) xs A s path n.
  Proof. intros s path n [(H1 & H2 & _) H3]. split; auto. Qed.

  (** After every run there is one state, with a verdict; where it says 'presumably', it is that of the finite run. This
      needs no axiom. *)
  Theorem check_finite : forall s path n, path_of (news C) xs A s path n -> exists q v,
    reaches M s n q /\ nth_error (verdicts M) q = Some v /\
    (v = PresumablySatisfied -> sat phi s (Some n) 0) /\ (v = PresumablyViolated -> ~ sat phi s (Some n) 0).
  Proof.
    intros s path n Hw. destruct accepted as (_ & HS & HR). destruct (HR _ _ _ Hw) as (q & B1 & B2).
    unfold known_at in B2.
    destruct (nth_error (verdicts M) q) as [v|] eqn:Ev; [|destruct B2]. exists q, v.
    destruct (HS q v Ev) as (v' & t & Ev' & _ & H3). rewrite Ev in Ev'. injection Ev' as <-.
    assert (HL : starts_like s n s (Some n)) by (split; [apply decided_finite | simpl; auto]).
    assert (HF : forall f b, right_place (news C) xs A M (annotations C) dead t b (path n, f) ->
      (forall s' L, starts_like s n s' L -> sat phi s' L 0 <-> sat f s' L n) -> (sat phi s (Some n) 0 <-> b = true)).
    { intros f b [H1 _] Hf. rewrite (Hf _ _ HL). simpl in H1. rewrite <- H1. pose proof (holds_sat f [] 0) as H0.
      simpl skipn in H0. simpl length in H0. rewrite H0.
      (* nothing is read from the end on *)
      assert (HE : forall g i, sat g s (Some n) (n + i) <-> sat g (at_step []) (Some 0) i).
      { clear. induction g; intros i; simpl; try tauto.
        - split; intros [H _]; lia.
        - now rewrite IHg.
        - now rewrite IHg1, IHg2.
        - now rewrite IHg1, IHg2.
        - split; intros [H _]; lia.
        - split; intros (k & H1 & H2 & _); lia. }
      rewrite <- (HE f 0). now rewrite Nat.add_0_r. }
    split; auto. split; auto. split; intros ->; destruct B2 as (f & H1 & H2); rewrite (HF f _ (H3 _ H1) H2); auto;
      discriminate.
  Qed.

  (** Permanent verdicts hold for every continuation of the run. *)
  Theorem check_permanent : forall s n q s', reaches M s n q -> decided s' None -> continues s n s' ->
    (nth_error (verdicts M) q = Some Violated -> ~ sat phi s' None 0) /\
    (nth_error (verdicts M) q = Some Satisfied -> sat phi s' None 0).
  Proof.
    intros s n q s' Hq Hd [(path & Hw) Hc]. destruct accepted as (HN & _ & HR).
    destruct (HR s' path n (run_path _ _ _ Hw)) as (q' & B1 & B2).
    assert (q' = q).
    { eapply reaches_unique; [exact B1|]. clear - Hq Hc. revert Hc. induction Hq as [|n q t r Hq IH Ht Hl]; intros Hc;
        [constructor|]. econstructor; eauto. rewrite Hc by lia. auto. }
    subst q'. assert (HX : ~ exists k, k <= n /\ some_place dead path s' None k).
    { intros (k & _ & Hk). apply (HN s' path k); auto. split; auto; apply Hw. }
    assert (HS : starts_like s' n s' None) by (split; simpl; auto).
    unfold known_at in B2. split; intros Ev; rewrite Ev in B2; specialize (B2 s' None HS).
    - intros Hs. auto.
    - destruct (Hd phi 0) as [H|H]; auto. exfalso; auto.
  Qed.

  (** Where there is no permanent verdict, there are continuations of either kind. *)
  Definition followed_by (s : stream) (n : nat) (u : lasso) : stream := fun k =>
    if k <? n then s k else lasso_word u (k - n).

  Lemma followed_by_sat : forall s n u f, sat f (followed_by s n u) None n <-> sat f (lasso_word u) None 0.
  Proof.
    intros s n u f. rewrite <- (Nat.add_0_r n) at 2. rewrite sat_shift. apply sat_ext. intros k _ _.
    unfold followed_by. rewrite (proj2 (Nat.ltb_ge _ _)) by lia. f_equal. lia.
  Qed.

  Lemma followed_by_continues : forall s path n u, path_of (news C) xs A s path n -> is_allowed A u = true ->
    is_run (news C) xs (path n) u = true -> loop u <> [] /\ continues s n (followed_by s n u).
  Proof.
    intros s path n u [H0 HP] Hu Hr. unfold is_allowed in Hu.
    assert (Hl : loop u <> []) by (destruct (loop u); congruence).
    assert (HF : forallb (at_letter A) (Lasso.letters u) = true) by (destruct (loop u); congruence).
    rewrite forallb_forall in HF. pose proof (loop_length u Hl) as Hlen. split; auto.
    destruct (run_along (news C) xs u (path n) Hl Hr) as (R1 & R2 & R3).
    set (way := along (news C) xs u (path n)) in *.
    set (path' := fun k => if k <? n then path k else way (k - n)).
    assert (E1 : forall k, k < n -> followed_by s n u k = s k /\ path' k = path k).
    { intros k Hk. unfold followed_by, path'. now rewrite (proj2 (Nat.ltb_lt _ _) Hk). }
    assert (E2 : forall k, followed_by s n u (n + k) = lasso_word u k /\ path' (n + k) = way k).
    { intros k. unfold followed_by, path'. rewrite (proj2 (Nat.ltb_ge (n + k) n)) by lia.
      replace (n + k - n) with k by lia. auto. }
    assert (En : path' n = path n) by (pose proof (E2 0) as E; rewrite Nat.add_0_r in E; destruct E; congruence).
    split; [|intros k Hk; now apply E1]. exists path'. split.
    - split; [|split].
      + destruct n; [now rewrite En | rewrite (proj2 (E1 0 ltac:(lia))); auto].
      + intros k. destruct (le_lt_dec n k) as [Hk|Hk].
        * destruct (R2 (k - n)) as (m & Hm). exists m. replace k with (n + (k - n)) by lia.
          rewrite <- Nat.add_succ_r. destruct (E2 (k - n)) as [-> ->], (E2 (S (k - n))) as [_ ->]. exact Hm.
        * destruct (HP k Hk) as (_ & m & Hm). exists m. destruct (E1 k Hk) as [-> ->].
          assert (ES : path' (S k) = path (S k)).
          { destruct (Nat.eq_dec (S k) n) as [<-|]; auto. apply E1. lia. }
          rewrite ES. exact Hm.
      + intros i Hi N. destruct (R3 i Hi N) as (j & m & Hj & Hm & Hf). exists (n + j), m. split; [lia|]. split; auto.
        rewrite <- Nat.add_succ_r. destruct (E2 j) as [-> ->], (E2 (S j)) as [_ ->]. exact Hm.
    - intros k. destruct (le_lt_dec n k) as [Hk|Hk]; [|destruct (E1 k Hk) as [-> _]; now apply HP].
      replace k with (n + (k - n)) by lia. destruct (E2 (k - n)) as [-> _]. apply HF.
      unfold lasso_word, Lasso.letters. apply in_app_iff. destruct (Nat.ltb_spec (k - n) (length (stem u))).
      + left. now apply nth_In.
      + right. apply nth_In. apply Nat.mod_upper_bound. lia.
  Qed.

  Theorem check_exact : forall s path n q v, (forall s, decided s None) -> exact C = true ->
    path_of (news C) xs A s path n -> reaches M s n q ->
    nth_error (verdicts M) q = Some v -> v = PresumablySatisfied \/ v = PresumablyViolated ->
    (exists s', continues s n s' /\ sat phi s' None 0) /\ (exists s', continues s n s' /\ ~ sat phi s' None 0).
  Proof.
    intros s path n q v Hdec HE Hw Hq Ev Hv. destruct accepted as (_ & _ & HR).
    destruct (HR _ _ _ Hw) as (q' & B1 & B2).
    assert (q' = q) by (eapply reaches_unique; eauto). subst q'.
    assert (HK : exists f, In (path n, f) (nth q (annotations C) []) /\ forall s', continues s n s' ->
                   (sat phi s' None 0 <-> sat f s' None n)).
    { unfold known_at in B2. rewrite Ev in B2.
      destruct Hv; subst v; destruct B2 as (f & H1 & H2); exists f; split; auto; intros s' [_ Hs]; apply H2;
        split; simpl; auto. }
    destruct HK as (f & Hf & HK).
    unfold exact in HE. cbv zeta in HE. rewrite forallb_forall in HE. specialize (HE q).
    rewrite in_seq in HE. assert (Hq' : q < length (verdicts M)) by (apply nth_error_Some; congruence).
    specialize (HE (conj (Nat.le_0_l _) Hq')). apply andb_true_iff in HE. destruct HE as [HA HO].
    rewrite forallb_forall in HA, HO. specialize (HO _ Hf). unfold is_open in HO. apply andb_true_iff in HO.
    destruct HO as [H1 H2]. apply existsb_exists in H1, H2. destruct H1 as (u1 & I1 & H1), H2 as (u2 & I2 & H2).
    apply filter_In in I1, I2. destruct I1 as [I1 R1], I2 as [I2 R2]. simpl in *.
    destruct (followed_by_continues s path n u1 Hw (HA u1 I1) R1) as [L1 C1].
    destruct (followed_by_continues s path n u2 Hw (HA u2 I2) R2) as [L2 C2].
    split.
    - exists (followed_by s n u1). split; auto. rewrite (HK _ C1), followed_by_sat. now apply holds_on_lasso_correct.
    - exists (followed_by s n u2). split; auto. rewrite (HK _ C2), followed_by_sat.
      rewrite <- (holds_on_lasso_correct u2 L2). destruct (holds_on_lasso f u2); simpl in H2; congruence.
  Qed.
End Accepted.
