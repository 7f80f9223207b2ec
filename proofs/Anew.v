(** What is judged from each message on: `each new s: P` says what `always (new s implies P)` says.

    An instance is the property [After (PAtom m) p] on the run in which the atom m, which p does not read, holds at the
    step of its message and nowhere else: [marked]. [each_step] says that all instances together are [Always], [Implies].
    Python: [ltlc/runtime/slice_openings.py], [ltlc.specification.specification.Instances]. *)
From Coq Require Import List Arith Lia Bool.
Require Import Ltl Properties.

(** Whether a property asks for an atom. *)
Fixpoint reads (p : property) (a : nat) : bool :=
  match p with
  | Now x | Throughout x => mentions x a
  | Not p | Always p | Never p | Eventually p | Within _ _ p => reads p a
  | And p q | Or p q | Implies p q => reads p a || reads q a
  | After x p | Until x p => mentions x a || reads p a
  | AfterUntil x y p => mentions x a || mentions y a || reads p a
  end.

(** The runs that say the same of all atoms but m. *)
Definition same_but (m : nat) (s s' : stream) : Prop := forall i a, a <> m -> s i a = s' i a.

Lemma same_sym : forall m s s', same_but m s s' -> same_but m s' s.
Proof. intros m s s' H i a Ha. symmetry. now apply H. Qed.

Lemma same_letter : forall m s s' x i, same_but m s s' -> mentions x m = false -> at_letter x (s i) = at_letter x (s' i).
Proof. intros m s s' x i H Hx. apply at_letter_same. intros a Ha. apply H. intros ->. congruence. Qed.

Lemma same_seen : forall m s s' x L i, same_but m s s' -> mentions x m = false ->
  at_letter x (seen s L i) = at_letter x (seen s' L i).
Proof.
  intros m s s' x L i H Hx. unfold seen. destruct L as [n|]; [|now apply (same_letter m)].
  destruct (i <? n); [now apply (same_letter m) | reflexivity].
Qed.

Lemma same_first : forall m s s' x L i k, same_but m s s' -> mentions x m = false ->
  first_step x s L i k -> first_step x s' L i k.
Proof.
  intros m s s' x L i k H Hx (H1 & H2 & H3 & H4). repeat split; auto.
  - now rewrite <- (same_letter m s s' x k H Hx).
  - intros j Hj. rewrite <- (same_letter m s s' x j H Hx). now apply H4.
Qed.

Lemma same_segment : forall m s s' y L i L', same_but m s s' -> mentions y m = false ->
  segment s L i y L' -> segment s' L i y L'.
Proof.
  intros m s s' y L i L' H Hy [(k & Hk & E)|(Hn & E)]; [left | right].
  - exists k. split; [now apply (same_first m s) | exact E].
  - split; [|exact E]. intros j Hj Hi. rewrite <- (same_letter m s s' y j H Hy). now apply Hn.
Qed.

Lemma same_opens : forall m s s' x y L i k, same_but m s s' -> mentions x m = false -> mentions y m = false ->
  opens x y s L i k -> opens x y s' L i k.
Proof.
  intros m s s' x y L i k H Hx Hy HO.
  assert (Ho : mentions (opening x y) m = false) by (simpl; now rewrite Hx, Hy).
  induction HO as [k Hk | j n k HO IH Hn Hk].
  - apply opens_first. now apply (same_first m s).
  - apply opens_next with j n; [exact IH | now apply (same_first m s) | now apply (same_first m s)].
Qed.

(** What is not read makes no difference. *)
Theorem unread : forall p m s s' t L i, reads p m = false -> same_but m s s' ->
  (satisfies p s t L i <-> satisfies p s' t L i).
Proof.
  intros p m. induction p; intros s s' t L i Hr H; simpl in Hr |- *;
    repeat (apply orb_false_elim in Hr; destruct Hr as [Hr ?]); pose proof (same_sym m s s' H) as H'.
  - now rewrite (same_seen m s s').
  - split; intros HS k Hk Hi; [rewrite <- (same_letter m s s') | rewrite (same_letter m s s')]; auto.
  - now rewrite (IHp s s').
  - now rewrite (IHp1 s s'), (IHp2 s s').
  - now rewrite (IHp1 s s'), (IHp2 s s').
  - now rewrite (IHp1 s s'), (IHp2 s s').
  - split; intros HS k Hk Hi; apply (IHp s s'); auto.
  - split; intros HS k Hk Hi HP; apply (HS k Hk Hi); apply (IHp s s'); auto.
  - split; intros (k & Hk & Hi & HS); exists k; (split; [|split]); auto; apply (IHp s s'); auto.
  - split; intros HS k Hk; apply (IHp s s'); auto; apply HS;
      first [now apply (same_first m s') | now apply (same_first m s)].
  - split; intros (k & Hk & HS); exists k; (split; [first [now apply (same_first m s) | now apply (same_first m s')] |]);
      apply (IHp s s'); auto.
  - split; intros HS k L' Ho Hs; apply (IHp s s'); auto; apply HS;
      first [now apply (same_opens m s') | now apply (same_segment m s')
            | now apply (same_opens m s) | now apply (same_segment m s)].
  - split; intros HS L' HL; apply (IHp s s'); auto.
Qed.

(** The run in which m holds at step k, and nowhere else. *)
Definition marked (m k : nat) (s : stream) : stream := fun i a => if a =? m then i =? k else s i a.

Lemma marked_same : forall m k s, same_but m s (marked m k s).
Proof. intros m k s i a Ha. unfold marked. apply Nat.eqb_neq in Ha. now rewrite Ha. Qed.

Lemma first_marked : forall m k s L i j, first_step (PAtom m) (marked m k s) L i j -> j = k.
Proof.
  intros m k s L i j (_ & _ & H & _). simpl in H. unfold marked in H. rewrite Nat.eqb_refl in H. now apply Nat.eqb_eq.
Qed.

Lemma first_at : forall m k s L i, i <= k -> inside L k -> first_step (PAtom m) (marked m k s) L i k.
Proof.
  intros m k s L i Hk Hi. unfold first_step, none_in, marked. simpl. repeat split; auto.
  - now rewrite !Nat.eqb_refl.
  - intros j Hj. rewrite Nat.eqb_refl. apply Nat.eqb_neq. lia.
Qed.

(** An instance judges the property on the rest of the run, from its message on. *)
Theorem instance : forall m p s t L i k, reads p m = false -> i <= k -> inside L k ->
  (satisfies (After (PAtom m) p) (marked m k s) t L i <-> satisfies p s t L k).
Proof.
  intros m p s t L i k Hr Hk Hi. rewrite (unread p m s (marked m k s) t L k Hr (marked_same m k s)). simpl. split.
  - intros HA. apply HA. now apply first_at.
  - intros HP j Hj. now rewrite (first_marked m k s L i j Hj).
Qed.

Lemma seen_inside : forall s L i, inside L i -> seen s L i = s i.
Proof. intros s [n|] i H; simpl in *; [apply Nat.ltb_lt in H; now rewrite H | reflexivity]. Qed.

(** The instances of all steps at which x holds say what [Always], [Implies] say. *)
Theorem each_step : forall m x p s t L i, reads p m = false ->
  ((forall k, i <= k -> inside L k -> at_letter x (s k) = true ->
      satisfies (After (PAtom m) p) (marked m k s) t L i)
   <-> satisfies (Always (Implies (Now x) p)) s t L i).
Proof.
  intros m x p s t L i Hr. split; intros H k Hk Hi Hx.
  - simpl in Hx. rewrite seen_inside in Hx by exact Hi. now apply (instance m p s t L i k Hr Hk Hi), H.
  - apply (instance m p s t L i k Hr Hk Hi), (H k Hk Hi). simpl. now rewrite seen_inside.
Qed.
