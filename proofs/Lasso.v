(** Ultimately periodic words: where every formula can be evaluated on an infinite word.

    Python: [Lasso] in [ltlc/semantics/words.py], [holds_on_lasso] in [lasso.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl.

(** The letters of [stem], then those of [loop] again and again. *)
Record lasso := { stem : list letter; loop : list letter }.

Definition letters (u : lasso) : list letter := stem u ++ loop u.
Definition size (u : lasso) : nat := length (letters u).
Definition lasso_word (u : lasso) : stream := fun k =>
  if k <? length (stem u) then nth k (stem u) no_atom
  else nth ((k - length (stem u)) mod length (loop u)) (loop u) no_atom.

(** After the last position comes the first one of the loop. *)
Definition next_position (u : lasso) (k : nat) : nat := if S k =? size u then length (stem u) else S k.

Definition table (u : lasso) (value : nat -> bool) : list bool := map value (seq 0 (size u)).
Definition entry (values : list bool) (k : nat) : bool := nth k values false.

(** Whether [left U right] holds at k, seen within n positions. *)
Fixpoint until_within (n : nat) (u : lasso) (left right : list bool) (k : nat) : bool :=
  match n with
  | 0 => false
  | S n => entry right k || (entry left k && until_within n u left right (next_position u k))
  end.

(** The truth of a formula at each position. *)
Fixpoint truth (u : lasso) (f : formula) : list bool :=
  match f with
  | Truth => table u (fun _ => true)
  | Atom a => map (fun l => l a) (letters u)
  | Not f => map negb (truth u f)
  | And f g => let p := truth u f in let q := truth u g in table u (fun k => entry p k && entry q k)
  | Or f g => let p := truth u f in let q := truth u g in table u (fun k => entry p k || entry q k)
  | Next f => let p := truth u f in table u (fun k => entry p (next_position u k))
  | Until f g => let p := truth u f in let q := truth u g in table u (until_within (size u) u p q)
  end.
Definition holds_on_lasso (f : formula) (u : lasso) : bool := entry (truth u f) 0.

Lemma sat_shift : forall f s p k, sat f s None (p + k) <-> sat f (fun j => s (p + j)) None k.
Proof.
  induction f; intros s p k; simpl.
  - tauto.
  - tauto.
  - now rewrite IHf.
  - now rewrite IHf1, IHf2.
  - now rewrite IHf1, IHf2.
  - rewrite <- IHf. now rewrite Nat.add_succ_r.
  - split; intros (m & A & _ & B & C).
    + exists (m - p). split; [lia|]. split; [auto|]. split.
      * rewrite <- IHf2. now replace (p + (m - p)) with m by lia.
      * intros j Hj. rewrite <- IHf1. apply C; lia.
    + exists (p + m). split; [lia|]. split; [auto|]. split; [now rewrite IHf2|].
      intros j Hj. replace j with (p + (j - p)) by lia. rewrite IHf1. apply C; lia.
Qed.

Section Lasso.
  Variable u : lasso.
  Hypothesis Hloop : loop u <> [].

  Lemma loop_length : 0 < length (loop u).
  Proof. destruct (loop u); [congruence | simpl; lia]. Qed.

  Lemma size_split : size u = length (stem u) + length (loop u).
  Proof. unfold size, letters. now rewrite app_length. Qed.

  Lemma lasso_word_periodic : forall k, length (stem u) <= k -> lasso_word u (length (loop u) + k) = lasso_word u k.
  Proof.
    intros k Hk. unfold lasso_word. pose proof loop_length.
    rewrite (proj2 (Nat.ltb_ge k _)) by lia. rewrite (proj2 (Nat.ltb_ge (_ + k) _)) by lia.
    replace (length (loop u) + k - length (stem u)) with (k - length (stem u) + 1 * length (loop u)) by lia.
    now rewrite Nat.mod_add by lia.
  Qed.

  Lemma sat_periodic : forall f k, length (stem u) <= k ->
    (sat f (lasso_word u) None (length (loop u) + k) <-> sat f (lasso_word u) None k).
  Proof.
    intros f k Hk. rewrite sat_shift. apply sat_ext. intros j Hj _. apply lasso_word_periodic; lia.
  Qed.

  Lemma sat_next : forall f k d, k < size u ->
    (sat f (lasso_word u) None (next_position u k + d) <-> sat f (lasso_word u) None (S k + d)).
  Proof.
    intros f k d Hk. unfold next_position. destruct (Nat.eqb_spec (S k) (size u)) as [E|]; [|tauto].
    rewrite E, size_split. replace (length (stem u) + length (loop u) + d)
      with (length (loop u) + (length (stem u) + d)) by lia.
    symmetry. apply sat_periodic; lia.
  Qed.

  Lemma next_position_inside : forall k, k < size u -> next_position u k < size u.
  Proof.
    intros k Hk. unfold next_position. pose proof loop_length. rewrite size_split in *.
    destruct (Nat.eqb_spec (S k) (length (stem u) + length (loop u))); lia.
  Qed.

  Lemma entry_table : forall value k, k < size u -> entry (table u value) k = value k.
  Proof.
    intros value k Hk. unfold entry, table. rewrite (nth_indep _ false (value 0)) by now rewrite map_length, seq_length.
    now rewrite map_nth, seq_nth.
  Qed.

  Lemma entry_map : forall {A} (value : A -> bool) xs d k, k < length xs -> entry (map value xs) k = value (nth k xs d).
  Proof.
    intros A value xs d k Hk. unfold entry. rewrite (nth_indep _ false (value d)) by now rewrite map_length.
    apply map_nth.
  Qed.

  Lemma nth_letters : forall k, k < size u -> nth k (letters u) no_atom = lasso_word u k.
  Proof.
    intros k Hk. rewrite size_split in Hk. unfold letters, lasso_word.
    destruct (Nat.ltb_spec k (length (stem u))); [now rewrite app_nth1|].
    rewrite app_nth2 by lia. now rewrite Nat.mod_small by lia.
  Qed.

  Lemma truth_length : forall f, length (truth u f) = size u.
  Proof. induction f; simpl; unfold table; rewrite ?map_length, ?seq_length; auto. Qed.

  Lemma until_within_correct : forall f g p q n k,
    (forall j, j < size u -> entry p j = true <-> sat f (lasso_word u) None j) ->
    (forall j, j < size u -> entry q j = true <-> sat g (lasso_word u) None j) ->
    k < size u ->
    (until_within n u p q k = true <->
     exists d, d < n /\ sat g (lasso_word u) None (k + d) /\ forall e, e < d -> sat f (lasso_word u) None (k + e)).
  Proof.
    intros f g p q n k Hp Hq. revert k. induction n; intros k Hk; simpl.
    - split; [congruence | intros (d & A & _); lia].
    - rewrite orb_true_iff, andb_true_iff, Hp, Hq, IHn by auto using next_position_inside. split.
      + intros [Hg | [Hf (d & A & B & C)]].
        * exists 0. rewrite Nat.add_0_r. repeat split; auto; intros; lia.
        * exists (S d). rewrite sat_next in B by auto. rewrite Nat.add_succ_r. repeat split; auto; [lia|].
          intros [|e] He; [now rewrite Nat.add_0_r|]. rewrite Nat.add_succ_r. apply sat_next; auto. apply C; lia.
      + intros ([|d] & A & B & C); [left; now rewrite Nat.add_0_r in B | right]. split.
        * rewrite <- (Nat.add_0_r k). apply C; lia.
        * exists d. rewrite sat_next by auto. rewrite Nat.add_succ_r in B. repeat split; auto; [lia|].
          intros e He. rewrite sat_next by auto. specialize (C (S e)). rewrite Nat.add_succ_r in C. apply C; lia.
  Qed.

  (** A step that satisfies [g] is found within one pass of the word. *)
  Lemma until_bounded : forall f g k, k < size u ->
    (sat (Until f g) (lasso_word u) None k <->
     exists d, d < size u /\ sat g (lasso_word u) None (k + d) /\ forall e, e < d -> sat f (lasso_word u) None (k + e)).
  Proof.
    intros f g k Hk. pose proof loop_length. pose proof size_split. split.
    - intros (m & A & _ & B & C). remember (m - k) as d eqn:Ed. revert m A B C Ed.
      induction d as [d IH] using lt_wf_ind. intros m A B C Ed.
      destruct (le_lt_dec (size u) d).
      + apply (IH (d - length (loop u))) with (m := m - length (loop u)); try lia.
        * rewrite <- sat_periodic by lia. now replace (length (loop u) + (m - length (loop u))) with m by lia.
        * intros j Hj. apply C; lia.
      + exists d. replace (k + d) with m by lia. repeat split; auto. intros e He. apply C; lia.
    - intros (d & A & B & C). exists (k + d). simpl. repeat split; auto; [lia|].
      intros m Hm. replace m with (k + (m - k)) by lia. apply C; lia.
  Qed.

  Lemma truth_correct : forall f k, k < size u -> (entry (truth u f) k = true <-> sat f (lasso_word u) None k).
  Proof.
    induction f; intros k Hk; simpl truth.
    - rewrite entry_table by auto. simpl; tauto.
    - rewrite (entry_map _ _ no_atom) by exact Hk. rewrite nth_letters by auto. simpl; tauto.
    - rewrite (entry_map negb _ false) by now rewrite truth_length. simpl. rewrite <- IHf by auto.
      unfold entry. destruct (nth k (truth u f) false); simpl; split; congruence.
    - rewrite entry_table, andb_true_iff, IHf1, IHf2 by auto. simpl; tauto.
    - rewrite entry_table, orb_true_iff, IHf1, IHf2 by auto. simpl; tauto.
    - rewrite entry_table, IHf by auto using next_position_inside.
      rewrite <- (Nat.add_0_r (next_position u k)), sat_next, Nat.add_0_r by auto. simpl; tauto.
    - rewrite entry_table by auto. rewrite (until_within_correct f1 f2) by auto. symmetry. now apply until_bounded.
  Qed.

  Theorem holds_on_lasso_correct : forall f, holds_on_lasso f u = true <-> sat f (lasso_word u) None 0.
  Proof. intros f. apply truth_correct. pose proof loop_length. rewrite size_split. lia. Qed.
End Lasso.
