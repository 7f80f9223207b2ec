(** The instants of what has been observed, and that a monitor need not look at all of them.

    An observation is a list of steps and the time T up to which we have looked. Between two steps, and after the
    last, the letter is held. It is held up to and at the time of the next step: so an observation is a prefix of
    each of its continuations ([instants_prefix]), and nothing that has been seen is taken back.
    Python: [ltlc/semantics/instants.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Encodings Clocks Registers Stutter.

Section Instants.
  Variables (A : Type) (quiet : A -> A).       (* a letter, and what is held of it: all but its news *)

  (** The letter at each nanosecond from u up to and including v. *)
  Definition hold (l : A) (u v : nat) : list (A * nat) := map (fun e => (l, e)) (seq u (S v - u)).

  (** From a step with letter l at time u on: that step, its letter held, and so for the steps after it. *)
  Fixpoint instants (l : A) (u : nat) (steps : list (A * nat)) (T : nat) : list (A * nat) :=
    (l, u) :: match steps with
              | [] => hold (quiet l) (S u) T
              | (m, v) :: steps => hold (quiet l) (S u) v ++ instants m v steps T
              end.

  (** Times do not decrease, and T is not before the last step. *)
  Fixpoint ordered (u : nat) (steps : list (A * nat)) (T : nat) : Prop :=
    match steps with [] => u <= T | (_, v) :: steps => u <= v /\ ordered v steps T end.

  Lemma ordered_end : forall steps u T, ordered u steps T -> u <= T.
  Proof. induction steps as [|[m v] steps IH]; simpl; intros u T H; auto. destruct H as [H1 H2]. apply IH in H2. lia.
  Qed.

  Lemma hold_longer : forall l u v w, u <= S v -> v <= w -> exists r, hold l u w = hold l u v ++ r.
  Proof.
    intros l u v w H1 H2. unfold hold. exists (map (fun e => (l, e)) (seq (S v) (w - v))).
    rewrite <- map_app. f_equal. replace (S w - u) with ((S v - u) + (w - v)) by lia. rewrite seq_app. do 2 f_equal.
    lia.
  Qed.

  Theorem instants_prefix : forall steps l u T more T', ordered u steps T -> ordered T more T' ->
    exists r, instants l u (steps ++ more) T' = instants l u steps T ++ r.
  Proof.
    induction steps as [|[m v] steps IH]; intros l u T more T' H1 H2; simpl in H1.
    - pose proof (ordered_end more T T' H2) as HT. destruct more as [|[m v] more]; simpl in *.
      + destruct (hold_longer (quiet l) (S u) T T') as (r & ->); try lia. eauto.
      + destruct H2 as [H2 _]. destruct (hold_longer (quiet l) (S u) T v) as (r & ->); try lia. rewrite <- app_assoc.
      eauto.
    - destruct H1 as [H1 H3]. simpl. destruct (IH m v T more T' H3 H2) as (r & ->). rewrite app_assoc. eauto.
  Qed.
End Instants.

(** Of the instants of a run it is enough to look at the first, and at those at which a letter or the answer of a
    clock is not what it was: at messages, and where clocks become late. [v] has these. *)
Theorem clock_steps_enough : forall p s t L kept v M, timed t L -> anchored p = true -> own_timers p ->
  decided (with_clocks p s t) L ->
  (forall k a, inside L (S k) -> kept (S k) = false -> with_clocks p s t (S k) a = with_clocks p s t k a) ->
  (forall k a, inside L k -> (k = 0 \/ kept k = true) -> v (number kept k) a = with_clocks p s t k a) ->
  (forall k, inside L k <-> inside M (number kept k)) -> (forall j, inside M j -> exists k, number kept k = j) ->
  (sat (encode Episode p) v M 0 <-> satisfies p s t L 0).
Proof.
  intros p s t L kept v M Ht HA HO Hd H1 H2 H3 H4. rewrite <- (encode_correct_online p s t L Ht HA HO Hd). symmetry.
  apply (kept_enough (with_clocks p s t) L kept H1 v M H2 H3 H4 _ (encode_next_free Episode p) 0).
Qed.

(** While a letter is held, a clock that runs does not stop: its answer changes once, to late. *)
Lemma older_for_good : forall t d r j k, passing t -> j <= k -> older t d r j = true -> older t d r k = true.
Proof.
  intros t d [i|] j k Ht Hk H; simpl in *; [|congruence]. apply Nat.ltb_lt in H. apply Nat.ltb_lt.
  pose proof (Ht j k Hk). lia.
Qed.
