(** Relativisation: a formula judged on the segment that ends before the next step with [y].

    Python: [relativise] in [ltlc/semantics/encodings.py]. *)
From Coq Require Import List Arith Lia Bool.
Require Import Ltl Properties.

Fixpoint relativise (y : predicate) (f : formula) : formula :=
  let within f := Ltl.And (Ltl.Not (as_formula y)) f in
  match f with
  | Truth => Truth
  | Atom a => within (Atom a)
  | Ltl.Not f => Ltl.Not (relativise y f)
  | Ltl.And f g => Ltl.And (relativise y f) (relativise y g)
  | Ltl.Or f g => Ltl.Or (relativise y f) (relativise y g)
  | Next f => within (Next (within (relativise y f)))
  | Ltl.Until f g => Ltl.Until (within (relativise y f)) (within (relativise y g))
  end.

(** Inside the segment. *)
Lemma relativise_inside : forall y s L i L', segment s L i y L' ->
  forall f j, i <= j -> inside L' j -> (sat (relativise y f) s L j <-> sat f s L' j).
Proof.
  intros y s L i L' HS. induction f; intros j Hj Hb.
  - simpl; tauto.
  - simpl. destruct (in_segment _ _ _ _ _ _ HS Hj Hb) as [Hi Hy]. rewrite as_formula_inside by auto. rewrite Hy.
    intuition congruence.
  - simpl. now rewrite IHf.
  - simpl. now rewrite IHf1, IHf2.
  - simpl. now rewrite IHf1, IHf2.
  - simpl. split.
    + intros (_ & H1 & H2 & H3).
      assert (inside L' (S j)).
      { eapply reaches_segment; eauto; try lia. intros m Hm. destruct (Nat.eq_dec m (S j)).
        - subst. destruct (at_letter y (s (S j))) eqn:E; auto. exfalso; apply H2. rewrite as_formula_inside; auto.
        - assert (inside L' m) by (eapply inside_le; [|exact Hb]; lia). eapply in_segment; eauto; lia. }
      split; auto. apply IHf; auto; lia.
    + intros (H1 & H2). assert (i <= S j) by lia.
      destruct (in_segment _ _ _ _ _ _ HS H H1) as [Ha Hy].
      destruct (in_segment _ _ _ _ _ _ HS Hj Hb) as [Ha' Hy']. repeat split; auto.
      * rewrite as_formula_inside by auto. congruence.
      * rewrite as_formula_inside by auto. congruence.
      * apply IHf; auto.
  - simpl. split.
    + intros (k & H1 & H2 & (H3 & H4) & H5).
      assert (Hall : forall m, i <= m <= k -> at_letter y (s m) = false).
      { intros m Hm. destruct (le_lt_dec j m) as [Hjm|Hjm].
        - destruct (at_letter y (s m)) eqn:E; auto. exfalso. destruct (Nat.eq_dec m k).
          + subst. apply H3. rewrite as_formula_inside; auto.
          + destruct (H5 m) as [Hx _]; [lia|]. apply Hx.
            rewrite as_formula_inside; auto. eapply inside_le; [|exact H2]; lia.
        - eapply in_segment; eauto; try lia. eapply inside_le; [|exact Hb]; lia. }
      assert (Hk : inside L' k) by (eapply reaches_segment; eauto; lia).
      exists k; repeat split; auto; [apply IHf2; auto; lia|].
      intros m Hm. apply IHf1; try lia; [eapply inside_le; [|exact Hk]; lia | apply H5; auto].
    + intros (k & H1 & H2 & H3 & H4). assert (Hik : i <= k) by lia.
      assert (HX : forall m, j <= m <= k -> inside L' m /\ inside L m /\ at_letter y (s m) = false).
      { intros m Hm. assert (inside L' m) by (eapply inside_le; [|exact H2]; lia). split; auto.
        eapply in_segment; eauto; lia. }
      exists k. destruct (HX k) as (_ & Hb1 & Hb2); [lia|]. repeat split; auto.
      * rewrite as_formula_inside by auto; congruence.
      * apply IHf2; auto.
      * rewrite as_formula_inside; [| apply HX; lia]. destruct (HX m) as (_ & _ & E); [lia|]. congruence.
      * apply IHf1; [lia | apply HX; lia | apply H4; auto].
Qed.

(** On the empty segment: [y] holds right now. *)
Lemma relativise_empty : forall y s L k, inside L k -> at_letter y (s k) = true ->
  forall f, sat (relativise y f) s L k <-> sat f s (Some k) k.
Proof.
  intros y s L k Hb Hy. assert (HE : sat (as_formula y) s L k) by (rewrite as_formula_inside; auto).
  induction f; simpl; try tauto.
  - split; [tauto | intros [H _]; lia].
  - split; [tauto | intros [H _]; lia].
  - split.
    + intros (m & A & B & (C & _) & D). destruct (Nat.eq_dec m k); [subst; tauto|].
      destruct (D k) as [E _]; [lia | tauto].
    + intros (m & A & B & _). lia.
Qed.

(** Beyond the end of a finite word. *)
Lemma relativise_beyond : forall y f s n i, n <= i -> (sat (relativise y f) s (Some n) i <-> sat f s (Some n) i).
Proof.
  intros y f s n i Hi. induction f; simpl; try tauto.
  - split; [tauto | intros [H _]; lia].
  - split; [intros (_ & H & _) | intros (H & _)]; lia.
  - split; intros (k & A & B & _); lia.
Qed.

(** The three cases together: the segment may be empty. *)
Theorem relativise_correct : forall y f s L i L', segment s L i y L' ->
  (sat (relativise y f) s L i <-> sat f s L' i).
Proof.
  intros y f s L i L' HS. pose proof HS as [(k & (A & B & C & D) & ->) | (H & ->)].
  - destruct (Nat.eq_dec i k) as [->|]; [now apply relativise_empty|].
    apply (relativise_inside y s L i (Some k)); auto; simpl; lia.
  - destruct L as [n|]; [destruct (le_lt_dec n i)|].
    + now apply relativise_beyond.
    + apply (relativise_inside y s (Some n) i (Some n)); auto.
    + apply (relativise_inside y s None i None); simpl; auto.
Qed.
