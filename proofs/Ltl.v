(** Words and core LTL: syntax, one satisfaction relation for finite and infinite words, and progression.

    Python: [ltlc/semantics/words.py], [ltl.py], [finite.py], [progression.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.

(** * Words *)

(** A letter says of each atom, known by its number, whether it holds at a step. *)
Definition letter := nat -> bool.
Definition no_atom : letter := fun _ => false.

(** A word is a stream of letters and an end: [Some n] for the finite word of the first n letters, [None] for the
    infinite word. [inside L k]: the word has a step k. *)
Definition stream := nat -> letter.
Definition inside (L : option nat) (k : nat) : Prop :=
  match L with None => True | Some n => k < n end.

(** A list of letters as a stream; what comes after its end is never looked at. *)
Definition at_step (w : list letter) : stream := fun k => nth k w no_atom.

Lemma inside_le : forall L i k, i <= k -> inside L k -> inside L i.
Proof. destruct L; simpl; intros; lia. Qed.

(** * Formulas *)

Inductive formula : Type :=
| Truth
| Atom (a : nat)
| Not (f : formula)
| And (f g : formula)
| Or (f g : formula)
| Next (f : formula)      (* strong next *)
| Until (f g : formula).

Definition FALSE := Not Truth.
Definition implies f g := Or (Not f) g.
Definition eventually f := Until Truth f.
Definition globally f := Not (eventually (Not f)).
Definition weak_until f g := Not (Until (Not g) (And (Not f) (Not g))).
Definition NON_EMPTY := Until Truth Truth.

(** [sat f s L i]: the rest, from step i on, of the word (s, L) satisfies [f]. It may be empty: i may be the end. *)
Fixpoint sat (f : formula) (s : stream) (L : option nat) (i : nat) : Prop :=
  match f with
  | Truth => True
  | Atom a => inside L i /\ s i a = true
  | Not f => ~ sat f s L i
  | And f g => sat f s L i /\ sat g s L i
  | Or f g => sat f s L i \/ sat g s L i
  | Next f => inside L (S i) /\ sat f s L (S i)
  | Until f g => exists k, i <= k /\ inside L k /\ sat g s L k /\ forall m, i <= m < k -> sat f s L m
  end.

(** The same on a list of letters, to compute with: LTLf. Python: [finite.holds]. *)
Fixpoint holds (f : formula) : list letter -> bool :=
  match f with
  | Truth => fun _ => true
  | Atom a => fun w => match w with [] => false | l :: _ => l a end
  | Not f => fun w => negb (holds f w)
  | And f g => fun w => holds f w && holds g w
  | Or f g => fun w => holds f w || holds g w
  | Next f => fun w => match w with _ :: (_ :: _) as rest => holds f rest | _ => false end
  | Until f g => fix until (w : list letter) : bool :=
      match w with [] => false | _ :: rest => holds g w || (holds f w && until rest) end
  end.

Lemma until_unfold : forall f g s L i, inside L i ->
  (sat (Until f g) s L i <-> sat g s L i \/ (sat f s L i /\ sat (Until f g) s L (S i))).
Proof.
  intros f g s L i Hi; split.
  - intros (k & Hk & Hb & Hg & Hf). destruct (Nat.eq_dec i k).
    + subst; now left.
    + right; split; [apply Hf; lia|]. exists k; repeat split; auto; try lia. intros; apply Hf; lia.
  - intros [Hg | [Hf (k & Hk & Hb & Hg & Hm)]].
    + exists i; repeat split; auto. intros; lia.
    + exists k; repeat split; auto; try lia. intros m ?. destruct (Nat.eq_dec m i); subst; auto. apply Hm; lia.
Qed.

Lemma skipn_at_step : forall w i, i < length w -> skipn i w = at_step w i :: skipn (S i) w.
Proof.
  induction w as [|l w IH]; intros i H; [simpl in H; lia|].
  destruct i; [reflexivity|]. simpl in H. change (skipn i w = at_step w i :: skipn (S i) w). apply IH; lia.
Qed.

Theorem holds_sat : forall f w i, holds f (skipn i w) = true <-> sat f (at_step w) (Some (length w)) i.
Proof.
  induction f; intros w i.
  - simpl; tauto.
  - simpl. destruct (le_lt_dec (length w) i).
    + rewrite skipn_all2 by lia. split; intros; [congruence | lia].
    + rewrite skipn_at_step by lia. tauto.
  - simpl. rewrite <- IHf. destruct (holds f (skipn i w)); simpl; split; congruence.
  - simpl. now rewrite andb_true_iff, IHf1, IHf2.
  - simpl. now rewrite orb_true_iff, IHf1, IHf2.
  - simpl. rewrite <- IHf. destruct (le_lt_dec (length w) i).
    + rewrite skipn_all2 by lia. split; [congruence|lia].
    + rewrite skipn_at_step by lia. destruct (le_lt_dec (length w) (S i)).
      * rewrite (skipn_all2 w (n:=S i)) by lia. split; [congruence|lia].
      * rewrite (skipn_at_step w (S i)) by lia. split; [split; [lia|auto] | tauto].
  - remember (length w - i) as n eqn:E. revert i E. induction n; intros i E.
    + rewrite skipn_all2 by lia. split; [simpl; congruence|]. intros (k & ? & Hk & _). simpl in Hk; lia.
    + assert (Hi : i < length w) by lia.
      rewrite until_unfold by (simpl; lia). rewrite <- IHf1, <- IHf2, <- IHn by lia.
      rewrite (skipn_at_step w i Hi) at 1.
      change (holds (Until f1 f2) (at_step w i :: skipn (S i) w)) with
        (holds f2 (at_step w i :: skipn (S i) w)
         || (holds f1 (at_step w i :: skipn (S i) w) && holds (Until f1 f2) (skipn (S i) w))).
      rewrite <- (skipn_at_step w i Hi). now rewrite orb_true_iff, andb_true_iff.
Qed.

(** Satisfaction looks at no letter outside the word, and at none before the step where it starts. *)
Lemma sat_ext : forall f s s' L i, (forall k, i <= k -> inside L k -> s k = s' k) -> sat f s L i <-> sat f s' L i.
Proof.
  induction f; intros s s' L i H; simpl.
  - tauto.
  - split; intros [H1 H2]; split; auto; [rewrite <- H | rewrite H]; auto.
  - now rewrite (IHf s s' L i H).
  - now rewrite (IHf1 s s' L i H), (IHf2 s s' L i H).
  - now rewrite (IHf1 s s' L i H), (IHf2 s s' L i H).
  - rewrite (IHf s s' L (S i)); [tauto|]. intros; apply H; auto; lia.
  - split; intros (k & A & B & C & D); exists k; repeat split; auto;
      try (apply (IHf2 s s' L k); auto; intros; apply H; auto; lia);
      intros m Hm; apply (IHf1 s s' L m); auto; intros; apply H; auto; lia.
Qed.

(** * Which words decide every formula

    [sat] is a proposition. On a finite word it is decided by computation, without any axiom. Of infinite words this is
    assumed, as the law of excluded middle, in [Infinite.v] and nowhere else. *)
Definition decided (s : stream) (L : option nat) : Prop := forall f i, sat f s L i \/ ~ sat f s L i.

Theorem decided_finite : forall s n, decided s (Some n).
Proof.
  intros s n f i. set (w := map s (seq 0 n)).
  assert (Hn : length w = n) by (unfold w; now rewrite map_length, seq_length).
  assert (E : sat f s (Some n) i <-> sat f (at_step w) (Some n) i).
  { apply sat_ext. intros k _ Hk. simpl in Hk. unfold at_step, w.
    rewrite (nth_indep _ no_atom (s 0)) by (rewrite map_length, seq_length; lia).
    now rewrite map_nth, seq_nth by lia. }
  rewrite E, <- Hn, <- holds_sat. destruct (holds f (skipn i w)); [now left | right; congruence].
Qed.

Lemma globally_sat : forall f s L i, decided s L ->
  (sat (globally f) s L i <-> forall k, i <= k -> inside L k -> sat f s L k).
Proof.
  intros f s L i Hd; simpl; split.
  - intros H k H1 H2. destruct (Hd f k) as [Hf|Hf]; auto. exfalso; apply H. exists k; repeat split; auto.
  - intros H (k & H1 & H2 & H3 & _). auto.
Qed.

Lemma eventually_sat : forall f s L i, sat (eventually f) s L i <-> exists k, i <= k /\ inside L k /\ sat f s L k.
Proof.
  intros; simpl; split.
  - intros (k & H1 & H2 & H3 & _); eauto.
  - intros (k & H1 & H2 & H3); exists k; auto.
Qed.

(** * Progression: what remains to be satisfied after a letter *)
Fixpoint progress (f : formula) (l : letter) : formula :=
  match f with
  | Truth => Truth
  | Atom a => if l a then Truth else FALSE
  | Not f => Not (progress f l)
  | And f g => And (progress f l) (progress g l)
  | Or f g => Or (progress f l) (progress g l)
  | Next f => And NON_EMPTY f
  | Until f g => Or (progress g l) (And (progress f l) (Until f g))
  end.

Theorem progress_holds : forall f l w, holds (progress f l) w = holds f (l :: w).
Proof.
  induction f; intros l w; simpl progress; try reflexivity.
  - simpl. destruct (l a); reflexivity.
  - simpl. now rewrite IHf.
  - simpl. now rewrite IHf1, IHf2.
  - simpl. now rewrite IHf1, IHf2.
  - destruct w; reflexivity.
  - change (holds (progress f2 l) w || (holds (progress f1 l) w && holds (Until f1 f2) w) = holds (Until f1 f2) (l :: w)).
    rewrite IHf1, IHf2. reflexivity.
Qed.

Theorem progress_sat : forall f s L i, inside L i -> (sat (progress f (s i)) s L (S i) <-> sat f s L i).
Proof.
  induction f; intros s L i Hi.
  - reflexivity.
  - simpl progress. destruct (s i a) eqn:E; simpl; split; try tauto; intros; try (destruct H; congruence).
  - simpl. now rewrite IHf.
  - simpl. now rewrite IHf1, IHf2.
  - simpl. now rewrite IHf1, IHf2.
  - simpl. split.
    + intros [(k & H1 & H2 & _) H]; split; auto. eapply inside_le; eauto.
    + intros [H1 H2]; split; auto. exists (S i); repeat split; auto.
  - rewrite until_unfold by auto.
    change (sat (progress f2 (s i)) s L (S i) \/ (sat (progress f1 (s i)) s L (S i) /\ sat (Until f1 f2) s L (S i)) <->
            sat f2 s L i \/ (sat f1 s L i /\ sat (Until f1 f2) s L (S i))).
    now rewrite IHf1, IHf2.
Qed.
