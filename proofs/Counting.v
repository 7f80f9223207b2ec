(** Counts where letters are held: what [Held.v] does for operators of the past.

    To a certificate a count is an atom of letters, which may change at any instant. Here it is what the language
    defines, [count_value], and worked out part by part from the letters of what is counted: [counted_parts_right].
    Python: [count_part] in [ltlc/assurance/evidence/parts.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Counts Certificate Held.

(** [once p N times], with a bound in the last D. If it [begins], p occurs where it holds and did not at the instant
    before; else wherever it holds. If it is [presumed], it holds until D has passed since the first instant, too. *)
Record count := { occurring : predicate; many : nat; bounded : bound; begins : bool; is_presumed : bool }.

(** * What it means *)
Definition occurs_at (o : count) (s : stream) (k : nat) : bool :=
  at_letter (occurring o) (s k) && negb (begins o && match k with 0 => false | S j => at_letter (occurring o) (s j) end).
Definition still_presumed (o : count) (first u : nat) : bool :=
  is_presumed o && match bounded o with Some d => u <=? first + d | None => false end.
Definition count_value (o : count) (s : stream) (t : times) (k : nat) : bool :=
  reached (occurs_at o s) t (many o) (bounded o) k || still_presumed o (t 0) (t k).

(** A run with its counts, each an atom. *)
Fixpoint with_counts (cs : list (nat * count)) (s : stream) (t : times) : stream :=
  match cs with
  | [] => s
  | (c, o) :: cs => with_counts cs (fun k a => if a =? c then count_value o s t k else s k a) t
  end.

(** * Part by part *)

(** What is remembered: the last times of occurrence, whether p held, and the time of the first instant. *)
Definition tally : Type := list nat * bool * nat.
Definition holds_at (o : count) (first : nat) (r : list nat) (u : nat) : bool :=
  is_reached (many o) (bounded o) r u || still_presumed o first u.

(** The value at the first and at the last instant of a part, and what is remembered then. None: it would depend on how
    many instants the part has. *)
Definition count_part (o : count) (is_first : bool) (r : tally) (x : part) : option (bool * bool * tally) :=
  let '(old, held, first) := if is_first then ([], false, from x) else r in
  let here := at_letter (occurring o) (lets x) in
  if here && negb (begins o) && negb (single x) then None
  else
    let now := if here && negb (begins o && held) then push (many o) old (from x) else old in
    Some (holds_at o first now (from x), holds_at o first now (upto x), (now, here, first)).

Fixpoint counted_parts (cs : list (nat * count)) (is_first : bool) (rs : list tally) (x : part) :
  option (part * list tally) :=
  match cs with
  | [] => Some (x, [])
  | (c, o) :: cs =>
      match count_part o is_first (hd ([], false, 0) rs) x with
      | Some (v, w, r) =>
          let y := {| lets := fun a => if a =? c then v else lets x a; from := from x; upto := upto x;
            single := single x |} in
          if Bool.eqb v w then
            match counted_parts cs is_first (tl rs) y with Some (z, rs) => Some (z, r :: rs) | None => None end
          else None
      | None => None
      end
  end.

Section Right.
  Variable t : times.
  Hypothesis Ht : passing t.

  Definition tallied (o : count) (s : stream) (k : nat) : tally :=
    (ring (occurs_at o s) t (many o) k, at_letter (occurring o) (s k), t 0).

  Lemma holds_at_earlier : forall o first r u v, u <= v -> holds_at o first r v = true -> holds_at o first r u = true.
  Proof.
    intros o first r u v Huv. unfold holds_at, is_reached, still_presumed. rewrite !orb_true_iff, !andb_true_iff.
    intros [[H1 H2]|[H1 H2]]; [left | right]; (split; [exact H1|]).
    - destruct (bounded o) as [d|]; auto. destruct r as [|e r]; auto. apply Nat.leb_le in H2. apply Nat.leb_le. lia.
    - destruct (bounded o) as [d|]; auto. apply Nat.leb_le in H2. apply Nat.leb_le. lia.
  Qed.

  Lemma count_value_is : forall o s k, 0 < many o ->
    count_value o s t k = holds_at o (t 0) (ring (occurs_at o s) t (many o) k) (t k).
  Proof. intros o s k HN. unfold count_value, holds_at. now rewrite ring_correct. Qed.

  Theorem count_part_right : forall o s m n x r v r', 0 < many o -> part_of s t m n x ->
    (m = 0 \/ r = given m r (tallied o s)) -> count_part o (m =? 0) r x = Some (v, v, r') ->
    (forall k, m <= k < n -> count_value o s t k = v) /\ tallied o s (n - 1) = r'.
  Proof.
    intros o s m n x r v r' HN (P1 & P2 & P3 & P4 & P5) HR H. unfold count_part in H.
    assert (HE : (if m =? 0 then (@nil nat, false, from x) else r) =
      (given m (@nil nat) (ring (occurs_at o s) t (many o)), given m false (fun j => at_letter (occurring o) (s j)), t 0)).
    { destruct m as [|j]; simpl; [now rewrite P3|]. destruct HR as [HR|HR]; [discriminate | exact HR]. }
    rewrite HE in H.
    assert (HL : forall k, m <= k < n -> at_letter (occurring o) (s k) = at_letter (occurring o) (lets x)).
    { intros k Hk. apply at_letter_same. intros a _. now apply P2. }
    destruct (at_letter (occurring o) (lets x) && negb (begins o) && negb (single x)) eqn:ES; [discriminate|].
    set (old := given m (@nil nat) (ring (occurs_at o s) t (many o))) in *.
    set (held := given m false (fun j => at_letter (occurring o) (s j))) in *.
    set (now := if at_letter (occurring o) (lets x) && negb (begins o && held) then push (many o) old (from x)
      else old) in *.
    assert (HM : ring (occurs_at o s) t (many o) m = now).
    { unfold now, old, held, given. destruct m as [|j]; cbn [ring]; unfold next, occurs_at at 1; rewrite HL by lia;
        rewrite P3; reflexivity. }
    assert (HK : forall k, m <= k < n -> ring (occurs_at o s) t (many o) k = now).
    { intros k Hk. rewrite <- HM. apply (over_when_the_first_is _ _ _ m k); [lia|]. intros i Hi. unfold occurs_at.
      rewrite HL by lia. destruct i as [|i]; [lia|]. rewrite HL by lia.
      destruct (at_letter (occurring o) (lets x)); auto. simpl in ES |- *. destruct (begins o); auto. simpl in ES.
      destruct (single x); [|discriminate]. specialize (P5 eq_refl). lia. }
    injection H as H1 H2 H3. split.
    - intros k Hk. rewrite count_value_is, HK by auto.
      pose proof (Ht m k ltac:(lia)). pose proof (Ht k (n - 1) ltac:(lia)).
      rewrite P3 in *. rewrite P4 in *. destruct v.
      + apply (holds_at_earlier _ _ _ _ (upto x)); auto.
      + destruct (holds_at o (t 0) now (t k)) eqn:E; auto. apply (holds_at_earlier _ _ _ (from x)) in E; auto.
        congruence.
    - unfold tallied. rewrite HK, HL by lia. exact H3.
  Qed.

  Fixpoint tallies (cs : list (nat * count)) (s : stream) (k : nat) : list tally :=
    match cs with
    | [] => []
    | (c, o) :: cs => tallied o s k :: tallies cs (fun k a => if a =? c then count_value o s t k else s k a) k
    end.

  Theorem counted_parts_right : forall m n cs s x rs y rs', forallb (fun c => 0 <? many (snd c)) cs = true ->
    part_of s t m n x -> rs = given m [] (tallies cs s) -> counted_parts cs (m =? 0) rs x = Some (y, rs') ->
    part_of (with_counts cs s t) t m n y /\ rs' = tallies cs s (n - 1).
  Proof.
    intros m n. induction cs as [|[c o] cs IH]; intros s x rs y rs' HN HP HR H; cbn [counted_parts] in H.
    - injection H as <- <-. split; auto.
    - cbn [forallb snd] in HN. apply andb_true_iff in HN. destruct HN as [HN HNs]. apply Nat.ltb_lt in HN.
      destruct (count_part o (m =? 0) _ x) as [[[v w] r]|] eqn:E; [|congruence].
      destruct (Bool.eqb v w) eqn:Evw; [|congruence]. apply Bool.eqb_prop in Evw. subst w.
      assert (HB : m = 0 \/ hd ([], false, 0) rs = given m (hd ([], false, 0) rs) (tallied o s)).
      { destruct m as [|j]; [now left | right]. rewrite HR. reflexivity. }
      destruct (count_part_right o s m n x _ v r HN HP HB E) as [E1 E2].
      destruct (counted_parts cs (m =? 0) (tl rs) _) as [[z zs]|] eqn:EZ; [|congruence]. injection H as <- <-.
      apply (IH (fun k a => if a =? c then count_value o s t k else s k a)) in EZ; auto.
      + destruct EZ as [Z1 ->]. split; [exact Z1|]. simpl. now rewrite <- E2.
      + destruct HP as (P1 & P2 & P3 & P4 & P5). repeat split; auto. intros k Hk a. simpl.
        destruct (a =? c); [|now apply P2]. now apply E1.
      + rewrite HR. destruct m; reflexivity.
  Qed.
End Right.
