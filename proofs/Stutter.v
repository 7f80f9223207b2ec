(** Next-free formulas do not see that a letter is repeated: the verdict on a finite run is that of its last step
    repeated for ever, and of a run in time it is enough to look at the instants at which a letter changes.

    Python: [is_next_free] in [ltlc/semantics/ltl.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Relativise Encodings.

Fixpoint is_next_free (f : formula) : bool :=
  match f with
  | Truth | Atom _ => true
  | Ltl.Not f => is_next_free f
  | Ltl.And f g | Ltl.Or f g | Ltl.Until f g => is_next_free f && is_next_free g
  | Next _ => false
  end.

(** The first n letters, then the last of them for ever. *)
Definition freeze (s : stream) (n : nat) : stream := fun k => s (Nat.min k (n - 1)).

Lemma freeze_tail : forall f s n k j, is_next_free f = true -> n - 1 <= k -> n - 1 <= j ->
  (sat f (freeze s n) None k <-> sat f (freeze s n) None j).
Proof.
  induction f; intros s n k j Hx Hk Hj; simpl in *; try congruence; try (apply andb_true_iff in Hx;
    destruct Hx as [X1 X2]).
  - tauto.
  - unfold freeze. replace (Nat.min k (n - 1)) with (n - 1) by lia. replace (Nat.min j (n - 1)) with (n - 1) by lia.
  tauto.
  - now rewrite (IHf s n k j).
  - now rewrite (IHf1 s n k j), (IHf2 s n k j).
  - now rewrite (IHf1 s n k j), (IHf2 s n k j).
  - split; intros (m & A & _ & B & C).
    + exists j. repeat split; auto; [apply (IHf2 s n m j); auto; lia | intros; lia].
    + exists k. repeat split; auto; [apply (IHf2 s n m k); auto; lia | intros; lia].
Qed.

Lemma freeze_sat : forall f s n i, is_next_free f = true -> i < n ->
  (sat f s (Some n) i <-> sat f (freeze s n) None i).
Proof.
  induction f; intros s n i Hx Hi; simpl in *; try congruence; try (apply andb_true_iff in Hx; destruct Hx as [X1 X2]).
  - tauto.
  - unfold freeze. replace (Nat.min i (n - 1)) with i by lia. tauto.
  - now rewrite IHf.
  - now rewrite IHf1, IHf2.
  - now rewrite IHf1, IHf2.
  - split.
    + intros (k & A & B & C & D). exists k. repeat split; auto; [apply IHf2; auto|].
      intros m Hm. apply IHf1; auto; lia.
    + intros (k & A & _ & C & D). exists (Nat.min k (n - 1)). repeat split; try lia.
      * apply IHf2; auto; try lia. destruct (le_lt_dec k (n - 1)).
        -- replace (Nat.min k (n - 1)) with k by lia; auto.
        -- apply (freeze_tail f2 s n k); auto; lia.
      * intros m Hm. apply IHf1; auto; try lia. apply D; lia.
Qed.

Theorem last_step_for_ever : forall f w, is_next_free f = true -> w <> [] ->
  (holds f w = true <-> sat f (freeze (at_step w) (length w)) None 0).
Proof.
  intros f w Hx Hw. change w with (skipn 0 w) at 1. rewrite holds_sat. apply freeze_sat; auto.
  destruct w; [congruence | simpl; lia].
Qed.

(** Every property of the language is next-free, in every encoding. *)
Lemma as_formula_next_free : forall p, is_next_free (as_formula p) = true.
Proof. induction p; simpl; rewrite ?IHp, ?IHp1, ?IHp2; reflexivity. Qed.

Lemma relativise_next_free : forall y f, is_next_free f = true -> is_next_free (relativise y f) = true.
Proof.
  induction f; simpl; intros H; auto; try congruence; try (apply andb_true_iff in H; destruct H);
    rewrite ?as_formula_next_free, ?IHf1, ?IHf2; auto.
Qed.

Lemma obligation_next_free : forall o, is_next_free (encode_obligation o) = true.
Proof.
  intros [c d x y|c d x y]; simpl; rewrite ?relativise_next_free by apply as_formula_next_free;
    rewrite ?as_formula_next_free; reflexivity.
Qed.

Theorem encode_next_free : forall e p, is_next_free (encode e p) = true.
Proof.
  assert (H : forall e p b, is_next_free (encode_at e b p) = true); [|intros; apply H].
  intros e p. induction p; intros b; try destruct e; try destruct b; simpl;
    try (destruct (obligation_of PTruth p); [apply obligation_next_free|simpl]);
    rewrite ?as_formula_next_free, ?IHp, ?IHp1, ?IHp2, ?relativise_next_free by auto; reflexivity.
Qed.

(** * Repetition does not matter *)

(** (s', L') repeats letters of (s, L): its step k shows step h k. It stays or moves to the next step, and leaves
    out none. *)
Record repeats (h : nat -> nat) (s' : stream) (L' : option nat) (s : stream) (L : option nat) : Prop := {
  in_order : forall i k, i <= k -> h i <= h k;
  complete : forall j, inside L j -> exists k, h k = j;
  same_end : forall k, inside L' k <-> inside L (h k);
  same_letter : forall k a, inside L' k -> s' k a = s (h k) a
}.

(** The first step from k on that shows j. *)
Lemma first_shown : forall h s' L' s L k j, repeats h s' L' s L -> inside L j -> h k <= j ->
  exists m, k <= m /\ h m = j /\ forall i, k <= i < m -> h i < j.
Proof.
  intros h s' L' s L k j [HO HC _ _] Hj Hk. destruct (HC j Hj) as (n & Hn). subst j.
  remember (n - k) as e eqn:E. revert k Hk E. induction e as [|e IH]; intros k Hk E.
  - exists k. repeat split; auto; try (intros; lia). pose proof (HO n k). lia.
  - destruct (Nat.eq_dec (h k) (h n)) as [Heq|Hne]; [exists k; repeat split; auto; intros; lia|].
    pose proof (HO k n). pose proof (HO n (S k)). destruct (le_lt_dec n k); [lia|].
    destruct (IH (S k)) as (m & A & B & C); try lia; [apply HO; lia|].
    exists m. repeat split; auto; try lia. intros i Hi. destruct (Nat.eq_dec i k); [subst; lia | apply C; lia].
Qed.

Theorem stutter_invariant : forall f h s' L' s L, repeats h s' L' s L -> is_next_free f = true ->
  forall k, sat f s' L' k <-> sat f s L (h k).
Proof.
  intros f h s' L' s L HR. pose proof HR as [HO HC HE HL].
  induction f; intros Hx k; simpl in *; try congruence; try (apply andb_true_iff in Hx; destruct Hx as [X1 X2]).
  - tauto.
  - rewrite HE. split; intros [A B]; split; auto; [rewrite <- HL | rewrite HL]; auto; now rewrite HE.
  - now rewrite IHf.
  - now rewrite IHf1, IHf2.
  - now rewrite IHf1, IHf2.
  - split.
    + intros (m & A & B & C & D). exists (h m). repeat split; [now apply HO | now apply HE | now apply IHf2 |].
      intros j Hj. assert (Hb : inside L j) by (eapply inside_le; [|apply HE; exact B]; lia).
      destruct (first_shown h s' L' s L k j HR Hb) as (i & I1 & I2 & _); [lia|]. subst j.
      apply IHf1; auto. apply D. destruct (le_lt_dec m i) as [Hm|]; [pose proof (HO m i Hm)|]; lia.
    + intros (j & A & B & C & D). destruct (first_shown h s' L' s L k j HR B A) as (m & M1 & M2 & M3). subst j.
      exists m. repeat split; auto; [now apply HE | now apply IHf2 |].
      intros i Hi. apply IHf1; auto. apply D. split; [apply HO; lia | now apply M3].
Qed.

(** So steps may be left out: keep the first, and all whose letter is not that of the one before. *)
Section Kept.
  Variables (s : stream) (L : option nat) (kept : nat -> bool).
  Hypothesis changes_kept : forall k a, inside L (S k) -> kept (S k) = false -> s (S k) a = s k a.

  (** How many of the steps from 1 up to k are kept: the number of the kept step that k shows. *)
  Fixpoint number (k : nat) : nat := match k with 0 => 0 | S j => if kept (S j) then S (number j) else number j end.

  (** v has the kept letters, in order. *)
  Variables (v : stream) (M : option nat).
  Hypothesis v_letter : forall k a, inside L k -> (k = 0 \/ kept k = true) -> v (number k) a = s k a.
  Hypothesis v_end : forall k, inside L k <-> inside M (number k).
  Hypothesis v_all : forall j, inside M j -> exists k, number k = j.

  Lemma number_order : forall i k, i <= k -> number i <= number k.
  Proof. intros i k H. induction H; auto. simpl. destruct (kept (S m)); lia. Qed.

  Theorem kept_enough : forall f, is_next_free f = true -> forall k, sat f s L k <-> sat f v M (number k).
  Proof.
    intros f Hx. apply stutter_invariant; auto. split; auto using number_order.
    intros k a. induction k as [|k IH]; intros Hk; [symmetry; apply v_letter; auto|].
    destruct (kept (S k)) eqn:E; [symmetry; apply v_letter; auto|]. simpl. rewrite E.
    rewrite changes_kept by auto. apply IH. eapply inside_le; [|exact Hk]; lia.
  Qed.
End Kept.
