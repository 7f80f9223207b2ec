(** Conditions: what a formula demands of the current step and of what comes after it, as a Boolean combination; and a
    bounded, memoised test of whether two conditions are equivalent.

    Python: [ltlc/semantics/conditions.py]. *)
From Coq Require Import List Arith Lia Bool FMapAVL OrderedTypeEx.
Import ListNotations.
Require Import Ltl Properties Trackers Resets Monitor.

(** A fact is what conditions are made of: an atom at the current step, or a formula judged from the next step on. *)
Inductive fact := AtStep (a : nat) | FromNext (f : formula).

Inductive condition :=
| Constant (b : bool)
| Fact (x : fact)
| Negation (c : condition)
| Conjunction (c d : condition)
| Disjunction (c d : condition).

Definition TRUE := Constant true.
Definition negation (c : condition) : condition :=
  match c with Constant b => Constant (negb b) | Negation c => c | _ => Negation c end.
Definition conjunction (c d : condition) : condition :=
  match c, d with
  | Constant b, _ => if b then d else c
  | _, Constant b => if b then c else d
  | _, _ => Conjunction c d
  end.
Definition disjunction (c d : condition) : condition :=
  match c, d with
  | Constant b, _ => if b then c else d
  | _, Constant b => if b then d else c
  | _, _ => Disjunction c d
  end.

(** [later f]: the formula from the next step on. Boolean operators are those of conditions. *)
Fixpoint later (f : formula) : condition :=
  match f with
  | Truth => TRUE
  | Ltl.Not f => negation (later f)
  | Ltl.And f g => conjunction (later f) (later g)
  | Ltl.Or f g => disjunction (later f) (later g)
  | _ => Fact (FromNext f)
  end.

(** [unfold f]: the formula now, in terms of this step's atoms and of formulas from the next step on. *)
Fixpoint unfold (f : formula) : condition :=
  match f with
  | Truth => TRUE
  | Atom a => Fact (AtStep a)
  | Ltl.Not f => negation (unfold f)
  | Ltl.And f g => conjunction (unfold f) (unfold g)
  | Ltl.Or f g => disjunction (unfold f) (unfold g)
  | Next f => conjunction (Fact (FromNext NON_EMPTY)) (later f)
  | Ltl.Until f g => disjunction (unfold g) (conjunction (unfold f) (Fact (FromNext (Ltl.Until f g))))
  end.

(** * Equality *)

Fixpoint formula_eqb (f g : formula) : bool :=
  match f, g with
  | Truth, Truth => true
  | Atom a, Atom b => a =? b
  | Ltl.Not f, Ltl.Not g | Next f, Next g => formula_eqb f g
  | Ltl.And f f', Ltl.And g g' | Ltl.Or f f', Ltl.Or g g' | Ltl.Until f f', Ltl.Until g g' =>
      formula_eqb f g && formula_eqb f' g'
  | _, _ => false
  end.
Definition fact_eqb (x y : fact) : bool :=
  match x, y with
  | AtStep a, AtStep b => a =? b
  | FromNext f, FromNext g => formula_eqb f g
  | _, _ => false
  end.
Fixpoint condition_eqb (c d : condition) : bool :=
  match c, d with
  | Constant a, Constant b => Bool.eqb a b
  | Fact x, Fact y => fact_eqb x y
  | Negation c, Negation d => condition_eqb c d
  | Conjunction c c', Conjunction d d' | Disjunction c c', Disjunction d d' => condition_eqb c d && condition_eqb c' d'
  | _, _ => false
  end.

Lemma formula_eqb_eq : forall f g, formula_eqb f g = true -> f = g.
Proof.
  induction f; destruct g; simpl; intros H; try congruence; try (apply Nat.eqb_eq in H; congruence);
    try (apply andb_true_iff in H; destruct H); f_equal; auto.
Qed.
Lemma fact_eqb_eq : forall x y, fact_eqb x y = true -> x = y.
Proof.
  destruct x, y; simpl; intros H; try congruence; f_equal; [now apply Nat.eqb_eq | now apply formula_eqb_eq].
Qed.
Lemma condition_eqb_eq : forall c d, condition_eqb c d = true -> c = d.
Proof.
  induction c; destruct d; simpl; intros H; try congruence; try (apply andb_true_iff in H; destruct H); f_equal;
    auto using fact_eqb_eq, eqb_prop.
Qed.

(** * What conditions mean *)

(** A model says which facts hold. *)
Definition model := fact -> Prop.
Definition decides (P : model) : Prop := forall x, P x \/ ~ P x.

Fixpoint true_in (P : model) (c : condition) : Prop :=
  match c with
  | Constant b => b = true
  | Fact x => P x
  | Negation c => ~ true_in P c
  | Conjunction c d => true_in P c /\ true_in P d
  | Disjunction c d => true_in P c \/ true_in P d
  end.

Definition same (c d : condition) : Prop := forall P, decides P -> (true_in P c <-> true_in P d).

Section Model.
  Variable P : model.
  Hypothesis HP : decides P.

  Lemma true_in_decided : forall c, true_in P c \/ ~ true_in P c.
  Proof. induction c; simpl; try tauto; try (destruct b; auto; fail); try apply HP. Qed.

  Lemma negation_true : forall c, true_in P (negation c) <-> ~ true_in P c.
  Proof.
    intros c. destruct c; simpl; try tauto.
    - destruct b; simpl; intuition congruence.
    - pose proof (true_in_decided c). tauto.
  Qed.
  Lemma conjunction_true : forall c d, true_in P (conjunction c d) <-> true_in P c /\ true_in P d.
  Proof.
    intros c d. destruct c as [[] | | | |]; simpl; try tauto; try (now intuition congruence);
      destruct d as [[] | | | |]; simpl; intuition congruence.
  Qed.
  Lemma disjunction_true : forall c d, true_in P (disjunction c d) <-> true_in P c \/ true_in P d.
  Proof.
    intros c d. destruct c as [[] | | | |]; simpl; try tauto; try (now intuition congruence);
      destruct d as [[] | | | |]; simpl; intuition congruence.
  Qed.
End Model.

(** A model that speaks of step i of a word. *)
Definition model_at (s : stream) (L : option nat) (i : nat) : model := fun x =>
  match x with AtStep a => s i a = true | FromNext f => sat f s L (S i) end.

Lemma model_at_decides : forall s L i, decided s L -> decides (model_at s L i).
Proof. intros s L i Hd [a|f]; simpl; [destruct (s i a); auto | apply Hd]. Qed.

Lemma later_true : forall P s L i, decides P -> (forall f, P (FromNext f) <-> sat f s L i) ->
  forall f, true_in P (later f) <-> sat f s L i.
Proof.
  intros P s L i HP H. induction f; simpl later; try apply H.
  - simpl; tauto.
  - rewrite negation_true by auto. simpl; tauto.
  - rewrite conjunction_true by auto. simpl; tauto.
  - rewrite disjunction_true by auto. simpl; tauto.
Qed.

Theorem unfold_correct : forall f s L i, decided s L -> inside L i ->
  (true_in (model_at s L i) (unfold f) <-> sat f s L i).
Proof.
  intros f s L i Hd Hi. pose proof (model_at_decides s L i Hd) as HP. induction f; simpl unfold.
  - simpl; tauto.
  - simpl; tauto.
  - rewrite negation_true by auto. simpl; tauto.
  - rewrite conjunction_true by auto. simpl; tauto.
  - rewrite disjunction_true by auto. simpl; tauto.
  - change (true_in (model_at s L i) (conjunction (Fact (FromNext NON_EMPTY)) (later f)) <-> sat (Next f) s L i).
    rewrite conjunction_true, (later_true _ s L (S i)) by (auto; reflexivity). simpl. split.
    + intros [(k & A & B & _) C]. split; auto. eapply inside_le; eauto.
    + intros [A B]. split; auto. exists (S i); auto.
  - rewrite disjunction_true, conjunction_true, IHf1, IHf2 by auto. symmetry. now apply until_unfold.
Qed.

(** * Deciding a fact *)

Fixpoint assign (x : fact) (b : bool) (c : condition) : condition :=
  match c with
  | Constant _ => c
  | Fact y => if fact_eqb x y then Constant b else c
  | Negation c => negation (assign x b c)
  | Conjunction c d => conjunction (assign x b c) (assign x b d)
  | Disjunction c d => disjunction (assign x b c) (assign x b d)
  end.

Lemma assign_true : forall P x (b : bool), decides P -> (P x <-> b = true) ->
  forall c, true_in P (assign x b c) <-> true_in P c.
Proof.
  intros P x b HP Hx. induction c; simpl assign.
  - tauto.
  - destruct (fact_eqb x x0) eqn:E; [|tauto]. apply fact_eqb_eq in E; subst. simpl. now rewrite Hx.
  - rewrite negation_true by auto. simpl; tauto.
  - rewrite conjunction_true by auto. simpl; tauto.
  - rewrite disjunction_true by auto. simpl; tauto.
Qed.

Fixpoint weight (c : condition) : nat :=
  match c with
  | Constant _ | Fact _ => 1
  | Negation c => 1 + weight c
  | Conjunction c d | Disjunction c d => 1 + weight c + weight d
  end.

(** The leftmost fact, and the leftmost atom of the current step. *)
Fixpoint first_fact (c : condition) : option fact :=
  match c with
  | Constant _ => None
  | Fact x => Some x
  | Negation c => first_fact c
  | Conjunction c d | Disjunction c d => match first_fact c with Some x => Some x | None => first_fact d end
  end.
Fixpoint first_atom (c : condition) : option nat :=
  match c with
  | Constant _ | Fact (FromNext _) => None
  | Fact (AtStep a) => Some a
  | Negation c => first_atom c
  | Conjunction c d | Disjunction c d => match first_atom c with Some a => Some a | None => first_atom d end
  end.

(** * Memory: what has been found out, and how much work is left

    Claims are kept in buckets by a hash, which no proof relies on. *)

Inductive claim :=
| Equivalent (c d : condition)
| Covered (t : target) (k : clocks) (allowed c : condition).     (* see Certificate.v *)

Definition clocks_eq_dec : forall k k' : clocks, {k = k'} + {k <> k'}.
Proof.
  assert (HS : forall st st' : state, {st = st'} + {st <> st'}) by (decide equality; [apply Nat.eq_dec | decide equality]).
  decide equality; [apply (list_eq_dec bool_dec) | apply (list_eq_dec HS) | apply bool_dec].
Defined.
Definition clocks_eqb (k k' : clocks) : bool := if clocks_eq_dec k k' then true else false.
Lemma clocks_eqb_eq : forall k k', clocks_eqb k k' = true <-> k = k'.
Proof. intros k k'. unfold clocks_eqb. destruct (clocks_eq_dec k k'); split; congruence. Qed.

Definition target_eqb (t u : target) : bool :=
  match t, u with State q, State r => q =? r | Ask d, Ask e => d =? e | _, _ => false end.
Definition claim_eqb (k l : claim) : bool :=
  match k, l with
  | Equivalent c d, Equivalent c' d' => condition_eqb c c' && condition_eqb d d'
  | Covered t k a c, Covered t' k' a' c' => target_eqb t t' && clocks_eqb k k' && condition_eqb c c' && condition_eqb a a'
  | _, _ => false
  end.
Lemma claim_eqb_eq : forall k l, claim_eqb k l = true -> k = l.
Proof.
  destruct k, l; simpl; intros H; try congruence; rewrite ?andb_true_iff in H.
  - destruct H as [A B]. apply condition_eqb_eq in A, B. congruence.
  - destruct H as [[[A D] B] C]. apply condition_eqb_eq in B, C. apply clocks_eqb_eq in D.
    destruct t, t0; simpl in A; try congruence; apply Nat.eqb_eq in A; congruence.
Qed.

Definition mix (h k : nat) : nat := Nat.modulo (31 * h + k) (1 + 256 * 256).
Fixpoint hash_formula (f : formula) : nat :=
  match f with
  | Truth => 1
  | Atom a => mix 2 a
  | Ltl.Not f => mix 3 (hash_formula f)
  | Ltl.And f g => mix (mix 4 (hash_formula f)) (hash_formula g)
  | Ltl.Or f g => mix (mix 5 (hash_formula f)) (hash_formula g)
  | Next f => mix 6 (hash_formula f)
  | Ltl.Until f g => mix (mix 7 (hash_formula f)) (hash_formula g)
  end.
Fixpoint hash_condition (c : condition) : nat :=
  match c with
  | Constant b => if b then 8 else 9
  | Fact (AtStep a) => mix 10 a
  | Fact (FromNext f) => mix 11 (hash_formula f)
  | Negation c => mix 12 (hash_condition c)
  | Conjunction c d => mix (mix 13 (hash_condition c)) (hash_condition d)
  | Disjunction c d => mix (mix 14 (hash_condition c)) (hash_condition d)
  end.
Definition hash_clocks (k : clocks) : nat := fold_left (fun h st => mix h (snd st)) (states k) 15.
Definition hash (k : claim) : nat :=
  match k with
  | Equivalent c d => mix (hash_condition c) (hash_condition d)
  | Covered (State q) k a c => mix (mix (mix (hash_clocks k) (hash_condition c)) (hash_condition a)) (2 * q)
  | Covered (Ask d) k a c => mix (mix (mix (hash_clocks k) (hash_condition c)) (hash_condition a)) (2 * d + 1)
  end.

Module Table := FMapAVL.Make Nat_as_OT.

Record memory := { budget : nat; known : Table.t (list (claim * bool)) }.
Definition new_memory (n : nat) : memory := {| budget := n; known := Table.empty _ |}.

Definition bucket (h : nat) (t : Table.t (list (claim * bool))) : list (claim * bool) :=
  match Table.find h t with Some b => b | None => [] end.
Definition recall (k : claim) (m : memory) : option bool :=
  match find (fun e => claim_eqb k (fst e)) (bucket (hash k) (known m)) with
  | Some (_, b) => Some b
  | None => None
  end.
Definition remember (k : claim) (b : bool) (m : memory) : memory :=
  {| budget := budget m; known := Table.add (hash k) ((k, b) :: bucket (hash k) (known m)) (known m) |}.
(** Looking at conditions costs their size; None when there is not enough left. *)
Definition spend (cost : nat) (m : memory) : option memory :=
  if cost <=? budget m then Some {| budget := budget m - cost; known := known m |} else None.

(** What is remembered as true means something. *)
Definition sound (meaning : claim -> Prop) (m : memory) : Prop :=
  forall h k, In (k, true) (bucket h (known m)) -> meaning k.

Section Memory.
  Variable meaning : claim -> Prop.

  Lemma new_memory_sound : forall n, sound meaning (new_memory n).
  Proof. intros n h k H. unfold bucket in H. simpl in H. destruct H. Qed.

  Lemma recall_sound : forall k m, sound meaning m -> recall k m = Some true -> meaning k.
  Proof.
    intros k m Hm H. unfold recall in H.
    destruct (find (fun e => claim_eqb k (fst e)) (bucket (hash k) (known m))) as [[k' b]|] eqn:E; [|congruence].
    injection H as ->. apply find_some in E. destruct E as [A B]. simpl in B. apply claim_eqb_eq in B. subst. eauto.
  Qed.

  Lemma remember_sound : forall k b m, sound meaning m -> (b = true -> meaning k) -> sound meaning (remember k b m).
  Proof.
    intros k b m Hm Hk h k' H.
    change (In (k', true) (match Table.find h (Table.add (hash k) ((k, b) :: bucket (hash k) (known m)) (known m)) with
                           | Some l => l | None => [] end)) in H.
    destruct (Nat.eq_dec (hash k) h) as [<-|Hne].
    - rewrite (Table.find_1 (Table.add_1 _ _ (eq_refl (hash k)))) in H.
      destruct H as [H|H]; [injection H as -> ->; auto | eauto].
    - destruct (Table.find h (Table.add (hash k) ((k, b) :: bucket (hash k) (known m)) (known m))) as [l|] eqn:E; [|destruct H].
      apply Table.find_2 in E. apply Table.add_3 in E; auto. apply Table.find_1 in E.
      apply (Hm h). unfold bucket. now rewrite E.
  Qed.

  Lemma spend_sound : forall n m m', spend n m = Some m' -> sound meaning m -> sound meaning m'.
  Proof. unfold spend. intros n m m' H Hm. destruct (n <=? budget m); [|congruence]. injection H as <-. exact Hm. Qed.
End Memory.

(** * Equivalence, by case distinction; [false] says 'not found out' *)

Fixpoint equivalent (depth : nat) (c d : condition) (m : memory) : bool * memory :=
  if condition_eqb c d then (true, m) else
  match depth, match first_fact c with Some x => Some x | None => first_fact d end, spend (weight c + weight d) m with
  | S depth, Some x, Some m =>
      match recall (Equivalent c d) m with
      | Some b => (b, m)
      | None =>
          let (yes, m) := equivalent depth (assign x true c) (assign x true d) m in
          if yes then
            let (no, m) := equivalent depth (assign x false c) (assign x false d) m in
            (no, remember (Equivalent c d) no m)
          else (false, remember (Equivalent c d) false m)
      end
  | _, _, _ => (false, m)
  end.

Definition follows (depth : nat) (c d : condition) (m : memory) : bool * memory :=
  equivalent depth (disjunction (negation c) d) TRUE m.

Section Equivalence.
  Variable meaning : claim -> Prop.
  Hypothesis meaning_equivalent : forall c d, meaning (Equivalent c d) <-> same c d.

  Lemma same_by_cases : forall x c d, same (assign x true c) (assign x true d) ->
    same (assign x false c) (assign x false d) -> same c d.
  Proof.
    intros x c d H1 H2 P HP. destruct (HP x) as [Hx|Hx].
    - rewrite <- (assign_true P x true HP) by tauto. rewrite (H1 P HP). apply assign_true; tauto.
    - rewrite <- (assign_true P x false HP) by (split; [tauto | congruence]). rewrite (H2 P HP).
      apply assign_true; auto. split; [tauto | congruence].
  Qed.

  Lemma equivalent_sound : forall depth c d m b m', equivalent depth c d m = (b, m') -> sound meaning m ->
    sound meaning m' /\ (b = true -> same c d).
  Proof.
    induction depth as [|depth IH]; intros c d m b m' H Hm; simpl in H;
      (destruct (condition_eqb c d) eqn:E;
        [injection H as <- <-; split; auto; intros _; apply condition_eqb_eq in E; subst; intros P HP; tauto|]).
    - injection H as <- <-. split; auto; congruence.
    - destruct (match first_fact c with Some x => Some x | None => first_fact d end) as [x|].
      2: { injection H as <- <-. split; auto; congruence. }
      destruct (spend (weight c + weight d) m) as [m1|] eqn:Es.
      2: { injection H as <- <-. split; auto; congruence. }
      apply (spend_sound meaning) in Es; auto.
      destruct (recall (Equivalent c d) m1) as [r|] eqn:Er.
      { injection H as <- <-. split; auto. intros ->. apply meaning_equivalent, (recall_sound _ _ _ Es Er). }
      destruct (equivalent depth (assign x true c) (assign x true d) m1) as [yes m2] eqn:E1.
      destruct (IH _ _ _ _ _ E1 Es) as [S1 C1]. destruct yes.
      + destruct (equivalent depth (assign x false c) (assign x false d) m2) as [no m3] eqn:E2.
        destruct (IH _ _ _ _ _ E2 S1) as [S2 C2]. injection H as <- <-.
        assert (HC : no = true -> same c d) by (intros; apply (same_by_cases x); auto).
        split; auto. apply remember_sound; auto. intros; apply meaning_equivalent; auto.
      + injection H as <- <-. split; [|congruence]. apply remember_sound; auto; congruence.
  Qed.

  Lemma follows_sound : forall depth c d m b m', follows depth c d m = (b, m') -> sound meaning m ->
    sound meaning m' /\ (b = true -> forall P, decides P -> true_in P c -> true_in P d).
  Proof.
    intros depth c d m b m' H Hm. destruct (equivalent_sound _ _ _ _ _ _ H Hm) as [A B]. split; auto.
    intros Hb P HP Hc. specialize (B Hb P HP). rewrite disjunction_true, negation_true in B by auto.
    simpl in B. tauto.
  Qed.
End Equivalence.
