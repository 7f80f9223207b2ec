(** Next-free formulas: the verdict on a finite run is that of its last step repeated for ever.

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
  induction f; intros s n k j Hx Hk Hj; simpl in *; try congruence; try (apply andb_true_iff in Hx; destruct Hx as [X1 X2]).
  - tauto.
  - unfold freeze. replace (Nat.min k (n - 1)) with (n - 1) by lia. replace (Nat.min j (n - 1)) with (n - 1) by lia. tauto.
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

Theorem encode_next_free : forall e p, is_next_free (encode e p) = true.
Proof.
  assert (H : forall e p b, is_next_free (encode_at e b p) = true); [|intros; apply H].
  intros e p. induction p; intros b; try destruct e; try destruct b; simpl;
    rewrite ?as_formula_next_free, ?IHp, ?IHp1, ?IHp2, ?relativise_next_free by auto; reflexivity.
Qed.
