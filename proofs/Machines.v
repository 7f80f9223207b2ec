(** The reset machine of a property, worked out from it; and whether the property, with what defines its atoms, is one
    that the theorems on runs in time speak of ([proper]). The checker asks that itself, of every certificate.

    Python: [trackers_of] in [ltlc/semantics/trackers.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers Resets.

Definition holds_of {P : Prop} (d : {P} + {~ P}) : bool := if d then true else false.
Lemma holds_of_true : forall P (d : {P} + {~ P}), holds_of d = true -> P.
Proof. intros P [H|H]; simpl; auto; discriminate. Qed.

Definition past_eq_dec : forall o o' : past, {o = o'} + {o <> o'}.
Proof. decide equality; try apply predicate_eq_dec; try apply Nat.eq_dec; decide equality; apply Nat.eq_dec. Defined.
Definition clock_eq_dec : forall c c' : clock, {c = c'} + {c <> c'}.
Proof. decide equality; try apply predicate_eq_dec; apply scope_eq_dec. Defined.
Definition timer_eq_dec : forall y y' : timer, {y = y'} + {y <> y'}.
Proof. decide equality; try apply Nat.eq_dec; apply clock_eq_dec. Defined.
Definition definition_eq_dec : forall d d' : nat * past, {d = d'} + {d <> d'}.
Proof. decide equality; [apply past_eq_dec | apply Nat.eq_dec]. Defined.

(** * The trackers *)

(** The scopes around a clock and their own, from the whole run inwards. *)
Fixpoint scopes_to (o : scope) : list scope :=
  match o with
  | WholeRun => [o]
  | AfterEvent o' _ | BeforeEvent o' _ | Episodes o' _ _ => scopes_to o' ++ [o]
  end.
Definition clocks_to (cl : clock) : list clock :=
  match cl with
  | SinceOpening o => map SinceOpening (scopes_to o)
  | FirstOpen o _ _ | LastTrigger o _ => map SinceOpening (scopes_to o) ++ [cl]
  end.
Definition each_once (cls : list clock) : list clock :=
  fold_left (fun known cl => if holds_of (in_dec clock_eq_dec cl known) then known else known ++ [cl]) cls [].

(** The bounds on a clock with their atoms, in ascending order. *)
Fixpoint insert (y : timer) (ys : list timer) : list timer :=
  match ys with
  | [] => [y]
  | z :: rest => if bound_of y <? bound_of z then y :: ys
                 else if bound_of y =? bound_of z then ys else z :: insert y rest
  end.
Definition clock_tracker (ys : list timer) (cl : clock) : tracker_of :=
  let own := fold_right insert [] (filter (fun y => holds_of (clock_eq_dec (clock_of y) cl)) ys) in
  {| about := Measures cl; decides := map atom_of own; bounds := map bound_of own |}.
Definition past_tracker (d : nat * past) : tracker_of :=
  {| about := Follows (snd d); decides := [fst d]; bounds := past_bounds (snd d) |}.

Definition trackers_for (defs : definitions) (p : property) : list tracker_of :=
  let ys := timers WholeRun p in
  map past_tracker defs ++ map (clock_tracker ys) (each_once (flat_map (fun y => clocks_to (clock_of y)) ys)).

(** * What is asked of them, to compute with *)
Section Proper.
  Variables (defs : definitions) (p : property) (news : list nat).
  Let ys := timers WholeRun p.
  Let xs := trackers_for defs p.

  Fixpoint ascend (bs : list nat) : bool :=
    match bs with [] => true | b :: rest => match rest with [] => true | c :: _ => b <? c end && ascend rest end.
  Definition is_positive (o : past) : bool :=
    match o with Once (Some d) _ | Since (Some d) _ _ | Historically (Some d) _ => 0 <? d | _ => true end.

  Definition is_theirs (x : tracker_of) : bool :=
    match about x with
    | Follows o => match decides x with
                   | [c] => holds_of (in_dec definition_eq_dec (c, o) defs) &&
                            holds_of (list_eq_dec Nat.eq_dec (bounds x) (past_bounds o)) && is_positive o
                   | _ => false
                   end
    | Measures cl =>
        (length (decides x) =? length (bounds x)) && ascend (bounds x) && forallb (fun d => 0 <? d) (bounds x) &&
        forallb (fun ad => let y := {| atom_of := fst ad; clock_of := cl; bound_of := snd ad |} in
                           holds_of (in_dec timer_eq_dec y ys))
          (combine (decides x) (bounds x)) &&
        match cl, bounds x with SinceOpening (BeforeEvent _ _), _ :: _ => false | _, _ => true end
    end.

  Fixpoint are_placed (scopes : list scope) (zs : list tracker_of) : bool :=
    match zs with
    | [] => true
    | z :: zs => match outer (about z) with None => true | Some o => holds_of (in_dec scope_eq_dec o scopes) end &&
                 are_placed (match about z with Measures (SinceOpening o) => o :: scopes | _ => scopes end) zs
    end.
  Definition are_theirs : bool :=
    forallb is_theirs xs && forallb (fun d => timed_atom news xs (fst d)) defs &&
    forallb (fun y => timed_atom news xs (atom_of y)) ys && are_placed [] xs.

  Fixpoint are_inside_out (ds : definitions) : bool :=
    match ds with
    | [] => true
    | (c, o) :: ds =>
        negb (asks o c) && forallb (fun d => negb (fst d =? c) && negb (asks o (fst d))) ds && are_inside_out ds
    end.
  Definition atoms_are_own : bool :=
    are_inside_out defs &&
    forallb (fun y => forallb (fun z => negb (atom_of y =? atom_of z) || holds_of (timer_eq_dec y z)) ys) ys &&
    forallb (fun y => negb (property_asks p (atom_of y))) ys &&
    forallb (fun y => forallb (fun d => negb (atom_of y =? fst d) && negb (asks (snd d) (atom_of y))) defs) ys &&
    forallb (fun a => forallb (fun d => negb (fst d =? a)) defs && forallb (fun y => negb (atom_of y =? a)) ys) news.

  Definition proper : bool := anchored p && atoms_are_own && are_theirs.

  Lemma ascend_rising : forall bs, ascend bs = true -> rising bs.
  Proof.
    induction bs as [|b bs IH]; simpl; auto. intros H. apply andb_true_iff in H. destruct H as [H1 H2].
    specialize (IH H2). destruct bs as [|c bs]; simpl in *; auto. apply Nat.ltb_lt in H1. auto.
  Qed.

  Lemma placed_sound : forall zs scopes, are_placed scopes zs = true -> placed scopes zs.
  Proof.
    induction zs as [|z zs IH]; simpl; auto. intros scopes H. apply andb_true_iff in H. destruct H as [H1 H2].
    split; auto. destruct (outer (about z)); auto. now apply holds_of_true in H1.
  Qed.

  Lemma inside_out_sound : forall ds, are_inside_out ds = true -> inside_out ds.
  Proof.
    induction ds as [|[c o] ds IH]; simpl; auto. intros H. rewrite !andb_true_iff, negb_true_iff, forallb_forall in H.
    destruct H as [[H1 H2] H3]. repeat split; auto; specialize (H2 _ H); apply andb_true_iff in H2;
      rewrite !negb_true_iff in H2; simpl in H2; destruct H2 as [H2 H4]; [now apply Nat.eqb_neq in H2 | auto].
  Qed.

  Lemma theirs_sound : forall x, is_theirs x = true -> match about x with
      | Follows o => exists c, decides x = [c] /\ In (c, o) defs /\ bounds x = past_bounds o /\ positive o
      | Measures cl => length (decides x) = length (bounds x) /\ rising (bounds x) /\ ~ In 0 (bounds x) /\
          (forall i, i < length (bounds x) ->
             In {| atom_of := nth i (decides x) 0; clock_of := cl; bound_of := nth i (bounds x) 0 |} ys) /\
          match cl with SinceOpening (BeforeEvent _ _) => bounds x = [] | _ => True end
      end.
  Proof.
    intros x H. unfold is_theirs in H. destruct (about x) as [o|cl].
    - destruct (decides x) as [|c [|d ds]]; try discriminate. rewrite !andb_true_iff in H. destruct H as [[H1 H2] H3].
      exists c. repeat split; [now apply holds_of_true in H1 | now apply holds_of_true in H2 |].
      destruct o as [q|[d|] q|[d|] q|[d|] q r|d q]; simpl in *; auto; now apply Nat.ltb_lt.
    - rewrite !andb_true_iff, !forallb_forall in H. destruct H as [[[[H1 H2] H3] H4] H5]. apply Nat.eqb_eq in H1.
      repeat split; auto using ascend_rising.
      + intros H0. specialize (H3 0 H0). discriminate.
      + intros i Hi. specialize (H4 (nth i (decides x) 0, nth i (bounds x) 0)). simpl in H4.
        apply holds_of_true in H4; auto. rewrite <- (combine_nth _ _ i 0 0 H1). apply nth_In.
        rewrite combine_length. lia.
      + destruct cl as [[]| |]; auto. destruct (bounds x); [auto | discriminate].
  Qed.

  Hypothesis is_proper : proper = true.

  Lemma proper_anchored : anchored p = true.
  Proof. unfold proper in is_proper. rewrite !andb_true_iff in is_proper. tauto. Qed.

  Lemma proper_atoms : own_atoms defs p news.
  Proof.
    unfold proper, atoms_are_own in is_proper. rewrite !andb_true_iff, !forallb_forall in is_proper.
    destruct is_proper as [[_ [[[[H1 H2] H3] H4] H5]] _]. split.
    - now apply inside_out_sound.
    - split.
      + intros y z Hy Hz E. specialize (H2 y Hy). rewrite forallb_forall in H2. specialize (H2 z Hz).
        rewrite E, Nat.eqb_refl in H2. now apply holds_of_true in H2.
      + intros y Hy. now apply negb_true_iff, H3.
    - intros y c o Hy Ho. specialize (H4 y Hy). rewrite forallb_forall in H4. specialize (H4 _ Ho).
      rewrite andb_true_iff, !negb_true_iff in H4. simpl in H4. destruct H4 as [H4 H6]. split; auto.
      now apply Nat.eqb_neq.
    - intros a Ha. specialize (H5 a Ha). rewrite andb_true_iff, !forallb_forall in H5. destruct H5 as [H5 H6]. split.
      + intros o Ho. specialize (H5 _ Ho). simpl in H5. now rewrite Nat.eqb_refl in H5.
      + intros y Hy. specialize (H6 y Hy). apply negb_true_iff in H6. now apply Nat.eqb_neq.
  Qed.

  Lemma proper_trackers : is_trivial news xs = false -> trackers_of defs p news xs.
  Proof.
    unfold proper, are_theirs in is_proper. rewrite !andb_true_iff, !forallb_forall in is_proper.
    destruct is_proper as [_ [[[H1 H2] H3] H4]]. intros HT. split; auto using placed_sound.
    - intros x Hx. exact (theirs_sound x (H1 x Hx)).
    - intros a [(o & Ho)|(y & Hy & <-)]; [exact (H2 _ Ho) | now apply H3].
  Qed.
End Proper.
