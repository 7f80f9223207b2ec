(** Where the band of what is still possible is as narrow as it can be.

    Each end is reached by one more step if one letter takes all parts of the property to that side ([band_tight]).
    There is such a letter if each atom occurs once, nothing always holds, and there is neither `until` nor `after_until`
    ([letter_exists]). With these the band may be wider: up to the greatest margin of a property that no run satisfies
    ([band_wider]). *)
From Coq Require Import List Arith Lia Bool ZArith.
Require Import Ltl Properties Past Robustness Bands.

(** A letter with which all parts of a property are as far to one side as they can be, whatever was before. *)
Fixpoint furthest_letter (low : bool) (p : property) (l : nat -> margin) : Prop :=
  match p with
  | Now p | Throughout p => at_margins p l = furthest low
  | Not p | Never p => furthest_letter (negb low) p l
  | And p q | Or p q => furthest_letter low p l /\ furthest_letter low q l
  | Implies p q => furthest_letter (negb low) p l /\ furthest_letter low q l
  | Always p | Eventually p | Within _ _ p => furthest_letter low p l
  | After x p => (low = true -> at_margins x l = Highest) /\ furthest_letter low p l
  | Until x p => low = true /\ at_margins x l = Lowest /\ furthest_letter low p l
  | AfterUntil x y p => low = false /\ at_margins y l = Lowest /\ furthest_letter low p l
  end.

Section Tight.
  Variables (v v' : nat -> nat -> margin) (t t' : times) (n : nat).
  Hypothesis begun : 0 < n.
  Hypothesis same : forall k, k < n -> t k = t' k /\ forall a, v k a = v' k a.
  (** One more step, at the time of the last instant. *)
  Hypothesis at_once : t' n = t' (n - 1).

  (** At that step: the segment has not ended, or had before. *)
  Definition unchanged (E : nat -> margin) : Prop := E n = Lowest \/ E n = Highest /\ E (n - 1) = Highest.

  Lemma backwards_tight : forall step step' last last' i, i < n ->
    (forall k a, i <= k < n -> step k a = step' k a) ->
    step' n last' = last \/ (forall a b, step (n - 1) a = step (n - 1) b) ->
    backwards step last n i = backwards step' last' (S n) i.
  Proof.
    intros step step' last last' i Hi Hs HL.
    assert (HB : forall k, k < n -> i <= k -> backwards step last n k = backwards step' last' (S n) k).
    { refine (backwards_ind _ n _ _); [intros; lia|]. intros k Hk IH _ Hik.
      rewrite !(backwards_first _ _ _ k), <- Hs by lia. destruct (Nat.eq_dec (S k) n) as [E|E].
      - rewrite E, backwards_none, backwards_first, backwards_none by lia. destruct HL as [<-|HL]; auto.
        replace k with (n - 1) by lia. apply HL.
      - now rewrite IH by lia. }
    now apply HB.
  Qed.

  Lemma always_fresh : forall E f, E n = Lowest -> backwards (always_step E f) Highest (S n) n = f n.
  Proof.
    intros E f HE. rewrite backwards_first, backwards_none by lia. unfold always_step.
    now rewrite HE, least_highest, lowest_greatest.
  Qed.
  Lemma eventually_fresh : forall E f, E n = Lowest -> backwards (eventually_step E f) Lowest (S n) n = f n.
  Proof.
    intros E f HE. rewrite backwards_first, backwards_none by lia. unfold eventually_step.
    rewrite HE, greatest_lowest. now destruct (f n).
  Qed.
  Lemma after_fresh : forall E x f, E n = Lowest ->
    backwards (after_step E x f) Highest (S n) n = greatest (neg (x n)) (f n).
  Proof.
    intros E x f HE. rewrite backwards_first, backwards_none by lia. unfold after_step.
    now rewrite HE, lowest_greatest, greatest_highest, least_highest.
  Qed.

  Lemma furthest_negb : forall low, neg (furthest (negb low)) = furthest low.
  Proof. now intros []. Qed.
  Lemma furthest_after : forall low a, (low = true -> a = Highest) -> greatest (neg a) (furthest low) = furthest low.
  Proof. intros [] a H; [now rewrite H by auto | apply greatest_highest]. Qed.

  Lemma fresh : forall p low E known, furthest_letter low p (v' n) -> E n = Lowest ->
    still_possible v' t' (S n) None p E known n = furthest low.
  Proof.
    induction p; intros low E known HL HE; cbn [furthest_letter] in HL;
      cbn [still_possible opposite option_map coming].
    - rewrite <- HL. apply at_margins_same. intros a. destruct known; auto. rewrite HE. apply least_highest.
    - now rewrite always_fresh.
    - rewrite (IHp (negb low)) by auto. apply furthest_negb.
    - destruct HL. rewrite (IHp1 low), (IHp2 low) by auto. now destruct low.
    - destruct HL. rewrite (IHp1 low), (IHp2 low) by auto. now destruct low.
    - destruct HL. rewrite (IHp1 (negb low)), (IHp2 low) by auto. now destruct low.
    - rewrite always_fresh by auto. now apply IHp.
    - rewrite eventually_fresh by auto. rewrite (IHp (negb low)) by auto. apply furthest_negb.
    - rewrite eventually_fresh by auto. now apply IHp.
    - destruct HL. rewrite after_fresh, (IHp low) by auto. now apply furthest_after.
    - destruct HL as (-> & HX & _). now rewrite eventually_fresh, HX by auto.
    - destruct HL as (-> & HY & HL). rewrite always_fresh, after_fresh, (IHp false) by
        (auto; unfold ended_by; now rewrite HE, HY). cbn [furthest]. now rewrite !greatest_highest.
    - apply IHp; auto. rewrite HE. replace (t' n + d <? t' n) with false; auto. symmetry. apply Nat.ltb_ge. lia.
  Qed.

  Lemma always_tight : forall low E E' f f' i, i < n -> unchanged E' -> (forall k, k < n -> E k = E' k) ->
    (forall k, i <= k < n -> f k = f' k) -> (E' n = Lowest -> f' n = furthest low) ->
    backwards (always_step E f) (furthest low) n i = backwards (always_step E' f') Highest (S n) i.
  Proof.
    intros low E E' f f' i Hi HU HE Hf HF. apply backwards_tight; auto.
    - intros k a Hk. unfold always_step. now rewrite HE, Hf by lia.
    - destruct HU as [HU|[_ HU]]; [left | right]; unfold always_step.
      + now rewrite HU, HF, least_highest, lowest_greatest by auto.
      + intros. now rewrite HE, HU by lia.
  Qed.
  Lemma eventually_tight : forall low E E' f f' i, i < n -> unchanged E' -> (forall k, k < n -> E k = E' k) ->
    (forall k, i <= k < n -> f k = f' k) -> (E' n = Lowest -> f' n = furthest low) ->
    backwards (eventually_step E f) (furthest low) n i = backwards (eventually_step E' f') Lowest (S n) i.
  Proof.
    intros low E E' f f' i Hi HU HE Hf HF. apply backwards_tight; auto.
    - intros k a Hk. unfold eventually_step. now rewrite HE, Hf by lia.
    - destruct HU as [HU|[_ HU]]; [left | right]; unfold eventually_step.
      + rewrite HU, HF by auto. now destruct low.
      + intros. now rewrite HE, HU by lia.
  Qed.
  Lemma after_tight : forall low E E' x f f' i, i < n -> unchanged E' -> (forall k, k < n -> E k = E' k) ->
    (forall k, i <= k < n -> f k = f' k) -> (E' n = Lowest -> f' n = furthest low) ->
    (low = true -> at_margins x (v' n) = Highest) ->
    backwards (after_step E (fun k => at_margins x (v k)) f) (furthest low) n i =
    backwards (after_step E' (fun k => at_margins x (v' k)) f') Highest (S n) i.
  Proof.
    intros low E E' x f f' i Hi HU HE Hf HF HX. apply backwards_tight; auto.
    - intros k a Hk. unfold after_step. now rewrite HE, Hf, (known_same v v' t t' n same) by lia.
    - destruct HU as [HU|[_ HU]]; [left | right]; unfold after_step.
      + now rewrite HU, HF, greatest_highest, least_highest, lowest_greatest, furthest_after by auto.
      + intros. now rewrite HE, HU by lia.
  Qed.

  Lemma tight : forall p low E E' known i, furthest_letter low p (v' n) -> unchanged E' ->
    (forall k, k < n -> E k = E' k) -> i < n ->
    still_possible v t n (Some (furthest low)) p E known i = still_possible v' t' (S n) None p E' known i.
  Proof.
    assert (HO : forall low, opposite (Some (furthest low)) = Some (furthest (negb low))) by now intros [].
    assert (HD : forall x E E', (forall k, k < n -> E k = E' k) ->
      forall k, k < n -> ended_by v x E k = ended_by v' x E' k).
    { intros. unfold ended_by. rewrite (known_same v v' t t' n same) by auto. f_equal. auto. }
    assert (HC : forall x E, at_margins x (v' n) = Lowest -> unchanged E -> unchanged (ended_by v' x E)).
    { unfold unchanged, ended_by. intros x E HX [HE|[HE HB]]; [left; now rewrite HE, HX | right].
      now rewrite HE, HB, HX, highest_greatest. }
    induction p; intros low E E' known i HL HU HE Hi; cbn [furthest_letter] in HL;
      cbn [still_possible coming]; rewrite ?HO; cbn [opposite option_map coming].
    - apply at_margins_same. intros a. rewrite HE by auto. now rewrite (proj2 (same i Hi) a).
    - apply always_tight; auto. intros. apply (known_same v v' t t' n same). lia.
    - f_equal. apply IHp; auto.
    - destruct HL. f_equal; auto.
    - destruct HL. f_equal; auto.
    - destruct HL. f_equal; auto. f_equal. auto.
    - apply always_tight; auto; intros; [apply IHp; auto; lia | now apply fresh].
    - f_equal. apply eventually_tight; auto; intros; [apply IHp; auto; lia | now apply fresh].
    - apply eventually_tight; auto; intros; [apply IHp; auto; lia | now apply fresh].
    - destruct HL. apply after_tight; auto; intros; [apply IHp; auto; lia | now apply fresh].
    - destruct HL as (-> & HX & HL). f_equal; [|apply IHp; auto].
      apply (eventually_tight true); auto. intros. apply (known_same v v' t t' n same). lia.
    - destruct HL as (-> & HY & HL).
      assert (HF : forall k, k < n -> backwards (after_step E (fun k => at_margins (opening x y) (v k))
          (still_possible v t n (Some (furthest false)) p (ended_by v y E) true)) (furthest false) n k =
        backwards (after_step E' (fun k => at_margins (opening x y) (v' k))
          (still_possible v' t' (S n) None p (ended_by v' y E') true)) Highest (S n) k).
      { intros k Hk. apply after_tight; auto; [intros; apply IHp; auto; lia | | discriminate].
        intros HN. apply fresh; auto. unfold ended_by. now rewrite HN, HY. }
      f_equal; [now apply HF|]. apply (always_tight false); auto.
      + intros k Hk. rewrite (known_same v v' t t' n same) by lia. f_equal. apply HF. lia.
      + intros _. rewrite HY. apply highest_greatest.
    - apply IHp; auto; [|intros k Hk; now rewrite (proj1 (same i Hi)), (proj1 (same k Hk)), HE].
      unfold unchanged in *. rewrite at_once. destruct (t' i + d <? t' (n - 1)); auto.
  Qed.

  Theorem band_tight : forall p low, furthest_letter low p (v' n) ->
    robustness v' t' (S n) p never_ends false 0 = if low then lower v t n p else upper v t n p.
  Proof.
    intros p low HL. rewrite <- computed_right by lia. symmetry.
    assert (HU : unchanged never_ends) by now left.
    destruct low; [apply (tight p true) | apply (tight p false)]; auto.
  Qed.
End Tight.

(** * Where there is such a letter *)

Fixpoint occurrences (p : predicate) : list nat :=
  match p with
  | PTruth => nil
  | PAtom a => a :: nil
  | PNot p => occurrences p
  | PAnd p q | POr p q => occurrences p ++ occurrences q
  end.
Fixpoint no_truth (p : predicate) : Prop :=
  match p with
  | PTruth => False
  | PAtom _ => True
  | PNot p => no_truth p
  | PAnd p q | POr p q => no_truth p /\ no_truth q
  end.
Fixpoint all_occurrences (p : property) : list nat :=
  match p with
  | Now p | Throughout p => occurrences p
  | Not p | Always p | Never p | Eventually p | Within _ _ p => all_occurrences p
  | And p q | Or p q | Implies p q => all_occurrences p ++ all_occurrences q
  | After x p | Until x p => occurrences x ++ all_occurrences p
  | AfterUntil x y p => occurrences x ++ occurrences y ++ all_occurrences p
  end.
Fixpoint no_until (p : property) : Prop :=
  match p with
  | Now p | Throughout p => no_truth p
  | Not p | Always p | Never p | Eventually p | Within _ _ p => no_until p
  | And p q | Or p q | Implies p q => no_until p /\ no_until q
  | After x p => no_truth x /\ no_until p
  | Until _ _ | AfterUntil _ _ _ => False
  end.

Lemma at_margins_on : forall p l l', (forall a, In a (occurrences p) -> l a = l' a) ->
  at_margins p l = at_margins p l'.
Proof.
  induction p; simpl; intros l l' H; f_equal; auto; (apply IHp1 || apply IHp2); intros; apply H, in_or_app; auto.
Qed.
Lemma furthest_letter_on : forall p low l l', (forall a, In a (all_occurrences p) -> l a = l' a) ->
  furthest_letter low p l -> furthest_letter low p l'.
Proof.
  induction p; cbn [all_occurrences furthest_letter]; intros low l l' H.
  1, 2: intros <-; symmetry; now apply at_margins_on.
  all: try (now apply IHp).
  1-3: intros [A B]; split; [apply (IHp1 _ l) | apply (IHp2 _ l)]; auto; intros; apply H, in_or_app; auto.
  all: rewrite <- (at_margins_on _ l l') by (intros; apply H; rewrite ?in_app_iff; auto 6).
  - intros [A B]. split; auto. apply (IHp _ l); auto. intros; apply H, in_or_app; auto.
  - intros (A & B & C). repeat split; auto. apply (IHp _ l); auto. intros; apply H, in_or_app; auto.
  - intros (A & B & C). repeat split; auto. apply (IHp _ l); auto. intros; apply H. rewrite !in_app_iff; auto.
Qed.

Lemma both_letters : forall xs ys (l l' : nat -> margin), NoDup (xs ++ ys) ->
  exists l'', (forall a, In a xs -> l a = l'' a) /\ (forall a, In a ys -> l' a = l'' a).
Proof.
  intros xs ys l l' H. exists (fun a => if existsb (Nat.eqb a) xs then l a else l' a). split; intros a Ha.
  - destruct (existsb (Nat.eqb a) xs) eqn:E; auto. rewrite <- not_true_iff_false, existsb_exists in E.
    exfalso. apply E. exists a. split; auto. apply Nat.eqb_refl.
  - destruct (existsb (Nat.eqb a) xs) eqn:E; auto. apply existsb_exists in E as (b & Hb & E).
    apply Nat.eqb_eq in E. subst b. exfalso. revert H Ha Hb. clear.
    induction xs as [|x xs IH]; simpl; [tauto|]. intros H Ha [->|Hb];
      inversion_clear H as [|? ? HN HD]; auto. apply HN, in_or_app. auto.
Qed.
Lemma once_each : forall (xs ys : list nat), NoDup (xs ++ ys) -> NoDup xs /\ NoDup ys.
Proof.
  induction xs as [|x xs IH]; simpl; intros ys H; [split; auto; constructor|]. inversion_clear H as [|? ? HN HD].
  destruct (IH ys HD). split; auto. constructor; auto. intros HX. apply HN, in_or_app. auto.
Qed.

Lemma furthest_margins : forall p low, no_truth p -> NoDup (occurrences p) -> exists l, at_margins p l = furthest low.
Proof.
  induction p; cbn [no_truth occurrences at_margins]; intros low HO HN; try tauto.
  - now exists (fun _ => furthest low).
  - destruct (IHp (negb low)) as (l & E); auto. exists l. rewrite E. apply furthest_negb.
  - destruct HO, (once_each _ _ HN), (IHp1 low) as (l & A), (IHp2 low) as (l' & B); auto.
    destruct (both_letters _ _ l l' HN) as (l'' & C & D). exists l''.
    rewrite <- (at_margins_on _ _ _ C), <- (at_margins_on _ _ _ D), A, B. now destruct low.
  - destruct HO, (once_each _ _ HN), (IHp1 low) as (l & A), (IHp2 low) as (l' & B); auto.
    destruct (both_letters _ _ l l' HN) as (l'' & C & D). exists l''.
    rewrite <- (at_margins_on _ _ _ C), <- (at_margins_on _ _ _ D), A, B. now destruct low.
Qed.

Theorem letter_exists : forall p low, no_until p -> NoDup (all_occurrences p) -> exists l, furthest_letter low p l.
Proof.
  assert (HB : forall p q b c, NoDup (all_occurrences p ++ all_occurrences q) ->
    (NoDup (all_occurrences p) -> exists l, furthest_letter b p l) ->
    (NoDup (all_occurrences q) -> exists l, furthest_letter c q l) ->
    exists l, furthest_letter b p l /\ furthest_letter c q l).
  { intros p q b c HN HP HQ. destruct (once_each _ _ HN) as [A B], (HP A) as (l & HL), (HQ B) as (l' & HL').
    destruct (both_letters _ _ l l' HN) as (l'' & C & D). exists l''. split; eapply furthest_letter_on; eauto. }
  induction p; cbn [no_until all_occurrences furthest_letter]; intros low HO HN; try tauto;
    auto using furthest_margins; try (destruct HO; apply HB; auto).
  destruct HO as [HX HP], (once_each _ _ HN) as [A B], (IHp low HP B) as (l' & HL).
  destruct (furthest_margins x (negb low) HX A) as (l & E), (both_letters _ _ l l' HN) as (l'' & C & D).
  exists l''. split; [|eapply furthest_letter_on; eauto]. intros ->. now rewrite <- (at_margins_on _ _ _ C), E.
Qed.

(** * Where the band is wider *)

(** In the last instant x can only come with nothing before it. *)
Example band_wider : let p := Always (Until (PAtom 0) (Eventually (Now (PAtom 1)))) in
  (forall s t m, 0 < m -> ~ satisfies p s t (Some m) 0) /\ forall t, upper (fun _ _ => Lowest) t 1 p = Highest.
Proof.
  split; [|reflexivity]. intros s t m Hm H.
  destruct (H (m - 1)) as (k & (A & B & _) & j & C & D & _); simpl in *; lia.
Qed.
