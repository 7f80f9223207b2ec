(** Clock atoms: [encode_correct], on a word whose clock atoms are right, a property says what its encoding says.

    A bound is encoded as a scope that ends when its clock is late. Where a bound opens once in its scope, the clock
    counts from there. Under [always] it opens again and again, and one clock is enough for two shapes: for a
    response, the clock of the earliest obligation that is open; for a prevention, that of the latest trigger.
    Python: [encode] in [ltlc/semantics/encodings.py], and [Late] in [timed_atoms.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Relativise Encodings.

(** * When the clock atoms of a stream are right *)

(** At k, an obligation from j on, of [y] after [x], is open and more than d old. Times do not decrease, so this
    asks the earliest. *)
Definition overdue (x y : predicate) (d : nat) (s : stream) (t : times) (i k : nat) : Prop :=
  exists j, i <= j <= k /\ at_letter x (s j) = true /\ none_in y s j k /\ beyond t d j k.
(** There is a trigger from i up to k; and all of them are more than d ago, so the latest is. *)
Definition triggered (x : predicate) (s : stream) (i k : nat) : Prop := exists j, i <= j <= k /\
  at_letter x (s j) = true.
Definition run_out (x : predicate) (d : nat) (s : stream) (t : times) (i k : nat) : Prop :=
  forall j, i <= j <= k -> at_letter x (s j) = true -> beyond t d j k.

Definition right_obligation (o : obligation) (s : stream) (t : times) (i k : nat) : Prop :=
  match o with
  | Response c d x y => s k c = true <-> overdue x y d s t i k
  | Prevention c d x _ => triggered x s i k -> (s k c = true <-> run_out x d s t i k)
  end.

(** Right for p, judged on the segment (i, L): where a clock's scope is open. Elsewhere anything will do. *)
Fixpoint right (p : property) (s : stream) (t : times) (L : option nat) (i : nat) : Prop :=
  match p with
  | Now _ | Throughout _ => True
  | Not p => right p s t L i
  | And p q | Or p q | Implies p q => right p s t L i /\ right q s t L i
  | Always p => match obligation_of PTruth p with
                | Some o => forall k, i <= k -> inside L k -> right_obligation o s t i k
                | None => forall k, i <= k -> inside L k -> right p s t L k
                end
  | Never p | Eventually p => forall k, i <= k -> inside L k -> right p s t L k
  | After x p => forall k, first_step x s L i k -> right p s t L k
  | Until x p => forall k, first_step x s L i k -> right p s t (Some k) i
  | AfterUntil x y p => forall k L', opens x y s L i k -> segment s L k y L' -> right p s t L' k
  | Within c d p => (forall k, i <= k -> inside L k -> (s k c = true <-> beyond t d i k)) /\
                    (forall L', part t L i d L' -> right p s t L' i)
  end.

(** * A clock that counts from the beginning of its segment *)

Lemma part_is_segment : forall c d s t L i, (forall k, i <= k -> inside L k -> (s k c = true <-> beyond t d i k)) ->
  forall L', part t L i d L' <-> segment s L i (PAtom c) L'.
Proof.
  intros c d s t L i H L'. assert (HF : forall k, i <= k -> inside L k -> (s k c = false <-> ~ beyond t d i k)).
  { intros k A B. rewrite <- (H k A B). destruct (s k c); intuition congruence. }
  split; intros [(k & A & B) | (A & B)].
  - left. destruct B as (B & C & D & ->). exists k. repeat split; auto; [now apply H|].
    intros m Hm. apply HF; auto; try lia. eapply inside_le; [|exact B]; lia.
  - right. split; auto. intros m M1 M2. apply HF; auto.
  - left. destruct A as (A & C & D & E). subst L'. exists k. repeat split; auto; [now apply H|].
    intros m Hm. apply HF; try lia; [eapply inside_le; [|exact C]; lia | apply E; auto].
  - right. split; auto. intros m M1 M2. apply HF; auto. now apply A.
Qed.

(** * The clock of an obligation *)

(** Some step from k on, before the clock is late, has [y]; every such step has it. *)
Lemma eventually_until_late : forall c y s L k, decided s L ->
  (sat (relativise (PAtom c) (eventually (as_formula y))) s L k <->
   exists j, k <= j /\ inside L j /\ at_letter y (s j) = true /\ forall m, k <= m <= j -> s m c = false).
Proof.
  intros c y s L k Hd. destruct (segment_exists s L k (PAtom c) Hd) as (L' & HS).
  rewrite (relativise_correct (PAtom c) _ s L k L' HS), eventually_sat. split.
  - intros (j & A & B & C). pose proof (in_segment s L k (PAtom c) L' j HS A B) as [D _].
    rewrite as_formula_inside in C by auto. exists j. repeat split; auto.
    intros m Hm. apply (in_segment s L k (PAtom c) L' m HS); [lia|]. eapply inside_le; [|exact B]; lia.
  - intros (j & A & B & C & D). assert (E : inside L' j) by (apply (reaches_segment s L k (PAtom c) L' j HS); auto).
    exists j. repeat split; auto. now apply as_formula_inside.
Qed.

Lemma throughout_until_late : forall c y s L k, decided s L ->
  (sat (relativise (PAtom c) (globally (as_formula y))) s L k <->
   forall j, k <= j -> inside L j -> (forall m, k <= m <= j -> s m c = false) -> at_letter y (s j) = true).
Proof.
  intros c y s L k Hd. destruct (segment_exists s L k (PAtom c) Hd) as (L' & HS).
  rewrite (relativise_correct (PAtom c) _ s L k L' HS), throughout_sat by (eapply segment_decided; eauto). split.
  - intros H j A B C. apply H; auto. apply (reaches_segment s L k (PAtom c) L' j HS); auto.
  - intros H j A B. apply H; auto; [apply (in_segment s L k (PAtom c) L' j HS); auto|].
    intros m Hm. apply (in_segment s L k (PAtom c) L' m HS); [lia|]. eapply inside_le; [|exact B]; lia.
Qed.

(** What an obligation asks at a step: of the letters with the clock, and of the letters with their times. *)
Definition asked (o : obligation) (s : stream) (L : option nat) (k : nat) : Prop :=
  match o with
  | Response c _ x y => at_letter x (s k) = true -> sat (relativise (PAtom c) (eventually (as_formula y))) s L k
  | Prevention c _ x y => at_letter x (s k) = true -> sat (relativise (PAtom c) (globally (as_formula y))) s L k
  end.
Definition asked_in_time (o : obligation) (s : stream) (t : times) (L : option nat) (k : nat) : Prop :=
  match o with
  | Response _ d x y => at_letter x (s k) = true ->
      exists j, k <= j /\ inside L j /\ at_letter y (s j) = true /\ ~ beyond t d k j
  | Prevention _ d x y => at_letter x (s k) = true ->
      forall j, k <= j -> inside L j -> ~ beyond t d k j -> at_letter y (s j) = true
  end.

Lemma seen_inside : forall s L k, inside L k -> seen s L k = s k.
Proof. intros s [n|] k Hk; simpl in *; auto. destruct (Nat.ltb_spec k n); auto; lia. Qed.

Lemma encoded_obligation : forall o s L i, decided s L ->
  (sat (encode_obligation o) s L i <-> forall k, i <= k -> inside L k -> asked o s L k).
Proof.
  assert (H : forall x f s L i, decided s L -> (sat (globally (implies (as_formula x) f)) s L i <->
            forall k, i <= k -> inside L k -> at_letter x (s k) = true -> sat f s L k)).
  { intros x f s L i Hd. rewrite globally_sat by auto. split; intros H k A B.
    - intros Hx. destruct (H k A B) as [N|N]; auto. exfalso; apply N. now apply as_formula_inside.
    - destruct (at_letter x (s k)) eqn:E; [right; auto | left]. simpl. rewrite as_formula_inside by auto. congruence. }
  intros [c d x y|c d x y] s L i Hd; apply H; auto.
Qed.

(** The part of a bound, seen from the whole. *)
Lemma eventually_in_part : forall d y s t L k, timed t L ->
  ((forall L', part t L k d L' -> exists j, k <= j /\ inside L' j /\ at_letter y (seen s L' j) = true) <->
   (exists j, k <= j /\ inside L j /\ at_letter y (s j) = true /\ ~ beyond t d k j)).
Proof.
  intros d y s t L k Ht. split.
  - intros H. destruct (part_exists t L k d Ht) as (L' & HP). destruct (H L' HP) as (j & A & B & C).
    rewrite seen_inside in C by auto. rewrite (part_inside t L k d L' j) in B by (auto; apply Ht). exists j. tauto.
  - intros (j & A & B & C & D) L' HP. assert (E : inside L' j) by (apply (part_inside t L k d L' j); auto; apply Ht).
    exists j. rewrite seen_inside; auto.
Qed.

Lemma throughout_part : forall d (y : nat -> Prop) t L k, timed t L ->
  ((forall L', part t L k d L' -> forall j, k <= j -> inside L' j -> y j) <->
   (forall j, k <= j -> inside L j -> ~ beyond t d k j -> y j)).
Proof.
  intros d y t L k Ht. split.
  - intros H j A B C. destruct (part_exists t L k d Ht) as (L' & HP). apply (H L' HP j A).
    apply (part_inside t L k d L' j); auto. apply Ht.
  - intros H L' HP j A B. rewrite (part_inside t L k d L' j) in B by (auto; apply Ht). apply H; tauto.
Qed.

(** The cases of [obligation_of]: what is true of each of them is true of what it accepts. *)
Lemma obligation_of_ind : forall P : predicate -> property -> obligation -> Prop,
  (forall x y p o, P (match x with PTruth => y | _ => PAnd x y end) p o -> P x (Implies (Now y) p) o) ->
  (forall x c d y, P x (Within c d (Eventually (Now y))) (Response c d x y)) ->
  (forall x c d y, P x (Within c d (Always (Now y))) (Prevention c d x y)) ->
  (forall x c d y, P x (Within c d (Throughout y)) (Prevention c d x y)) ->
  (forall x c d y, P x (Within c d (Never (Now y))) (Prevention c d x (PNot y))) ->
  forall p x o, obligation_of x p = Some o -> P x p o.
Proof.
  intros P H1 H2 H3 H4 H5. induction p; intros z o E; simpl in E; try discriminate E.
  - destruct p1; try discriminate E. auto.
  - destruct p as [|y| | | | |p|p|p| | | |]; try discriminate E; [injection E as <-; auto|..];
      destruct p; try discriminate E; injection E as <-; auto.
Qed.

Lemma satisfied_obligation : forall p x o, obligation_of x p = Some o -> forall s t L k, timed t L -> inside L k ->
  ((at_letter x (s k) = true -> satisfies p s t L k) <-> asked_in_time o s t L k).
Proof.
  apply (obligation_of_ind (fun x p o => forall s t L k, timed t L -> inside L k ->
    ((at_letter x (s k) = true -> satisfies p s t L k) <-> asked_in_time o s t L k)));
    intros; simpl satisfies; [|unfold asked_in_time ..].
  - rewrite <- H by auto. simpl. rewrite seen_inside by auto.
    destruct x; simpl; rewrite ?andb_true_iff; tauto.
  - now rewrite <- eventually_in_part.
  - rewrite <- throughout_part by auto. split; intros HA Hx L' HP j A B; specialize (HA Hx L' HP j A B);
      [rewrite seen_inside in HA | rewrite seen_inside]; auto.
  - now rewrite <- throughout_part.
  - rewrite <- (throughout_part d (fun j => negb (at_letter y (s j)) = true)) by auto.
    split; intros HA Hx L' HP j A B; specialize (HA Hx L' HP j A B);
      [rewrite seen_inside in HA by auto | rewrite seen_inside by auto]; destruct (at_letter y (s j)); simpl in *;
        congruence.
Qed.

(** One clock, that of the earliest obligation that is open: a [y] settles them all. *)
Theorem response_earliest : forall c d x y s t L i, passing t -> decided s L ->
  (forall k, i <= k -> inside L k -> right_obligation (Response c d x y) s t i k) ->
  ((forall k, i <= k -> inside L k -> asked (Response c d x y) s L k) <->
   (forall k, i <= k -> inside L k -> asked_in_time (Response c d x y) s t L k)).
Proof.
  intros c d x y s t L i Ht Hd HR. unfold asked, asked_in_time, right_obligation in *.
  split; intros H k A B Hx; specialize (H k A B Hx) as Hk.
  - rewrite eventually_until_late in Hk by auto. destruct Hk as (j & J1 & J2 & J3 & J4).
    destruct (first_step_inside y s L j k J1 J2 J3) as (m & Hm & (M1 & M2 & M3 & M4)).
    exists m. repeat split; auto. intros Hb. assert (E : s m c = true); [|rewrite J4 in E by lia; congruence].
    apply (HR m); auto; [lia|]. exists k. repeat split; auto; lia.
  - rewrite eventually_until_late by auto. destruct Hk as (j & J1 & J2 & J3 & J4).
    destruct (first_step_inside y s L j k J1 J2 J3) as (f & Hf & (F1 & F2 & F3 & F4)).
    exists f. repeat split; auto. intros m Hm. destruct (s m c) eqn:E; auto. exfalso.
    assert (Hmi : inside L m) by (eapply inside_le; [|exact F2]; lia).
    apply (HR m) in E; [|lia|auto]. destruct E as (o & O1 & O2 & O3 & O4). unfold beyond in *.
    destruct (le_lt_dec k o) as [Hko|Hko].
    + pose proof (Ht k o Hko). assert (t m <= t j) by (apply Ht; lia). lia.
    + destruct (H o) as (g & G1 & G2 & G3 & G4); auto; try lia; [eapply inside_le; [|exact B]; lia|].
      destruct (le_lt_dec m g) as [Hmg|Hmg]; [pose proof (Ht m g Hmg); lia|]. rewrite O3 in G3 by lia. congruence.
Qed.

Lemma latest_trigger : forall x s k j, k <= j -> at_letter x (s k) = true ->
  exists o, k <= o <= j /\ at_letter x (s o) = true /\ forall m, o < m <= j -> at_letter x (s m) = false.
Proof.
  intros x s k j Hk Hx. induction j as [|j IH].
  - exists k. repeat split; auto; intros; lia.
  - destruct (at_letter x (s (S j))) eqn:E; [exists (S j); repeat split; auto; intros; lia|].
    destruct (Nat.eq_dec k (S j)) as [->|]; [congruence|]. destruct IH as (o & A & B & C); [lia|].
    exists o. repeat split; auto; try lia. intros m Hm. destruct (Nat.eq_dec m (S j)); subst; auto. apply C; lia.
Qed.

(** One clock, that of the latest trigger: what it asks ends last. *)
Theorem prevention_latest : forall c d x y s t L i, passing t -> decided s L ->
  (forall k, i <= k -> inside L k -> right_obligation (Prevention c d x y) s t i k) ->
  ((forall k, i <= k -> inside L k -> asked (Prevention c d x y) s L k) <->
   (forall k, i <= k -> inside L k -> asked_in_time (Prevention c d x y) s t L k)).
Proof.
  intros c d x y s t L i Ht Hd HR. unfold asked, asked_in_time, right_obligation in *.
  split; intros H k A B Hx; specialize (H k A B Hx) as Hk.
  - intros j J1 J2 J3. rewrite throughout_until_late in Hk by auto. apply Hk; auto.
    intros m Hm. destruct (s m c) eqn:E; auto. exfalso; apply J3.
    apply (HR m) in E; try lia; [| eapply inside_le; [|exact J2]; lia | exists k; split; auto; lia].
    specialize (E k). unfold beyond in *. assert (t m <= t j) by (apply Ht; lia).
    assert (t k + d < t m) by (apply E; auto; lia). lia.
  - rewrite throughout_until_late by auto. intros j J1 J2 J3.
    destruct (latest_trigger x s k j J1 Hx) as (o & O1 & O2 & O3).
    apply (H o); auto; try lia; [eapply inside_le; [|exact J2]; lia|]. intros Hb.
    assert (E : s j c = true); [|rewrite J3 in E by lia; congruence].
    apply (HR j); auto; try lia; [exists k; split; auto; lia|]. intros m Hm Hxm.
    destruct (le_lt_dec m o) as [Hmo|Hmo]; [|rewrite O3 in Hxm by lia; congruence].
    unfold beyond in *. pose proof (Ht m o Hmo). lia.
Qed.

Lemma obligation_agrees : forall o s t L i, timed t L -> decided s L ->
  (forall k, i <= k -> inside L k -> right_obligation o s t i k) ->
  (sat (encode_obligation o) s L i <-> forall k, i <= k -> inside L k -> asked_in_time o s t L k).
Proof.
  intros o s t L i Ht Hd HR. rewrite encoded_obligation by auto.
  destruct o; [apply response_earliest | apply prevention_latest]; auto; apply Ht.
Qed.

(** * The encoding is right *)

Theorem encode_correct : forall p s t L i, timed t L -> decided s L -> right p s t L i ->
  (sat (encode Episode p) s L i <-> satisfies p s t L i).
Proof.
  assert (H : forall p b s t L i, timed t L -> decided s L -> right p s t L i ->
            (sat (encode_at Episode b p) s L i <-> satisfies p s t L i)); [|now intros; apply H].
  induction p; intros b s t L i Ht Hd HR; simpl right in HR.
  - apply as_formula_sat.
  - simpl encode_at. rewrite andb_false_r. now apply throughout_sat.
  - simpl. now rewrite (IHp false s t).
  - destruct HR. simpl. now rewrite (IHp1 b s t), (IHp2 b s t).
  - destruct HR. simpl. now rewrite (IHp1 false s t), (IHp2 false s t).
  - destruct HR as [R1 R2]. pose proof (Hd (encode_at Episode false p1) i) as Hp. simpl.
    rewrite (IHp1 false s t), (IHp2 false s t) in * by auto. tauto.
  - simpl encode_at. simpl satisfies. destruct (obligation_of PTruth p) as [o|] eqn:E.
    + rewrite (obligation_agrees o s t L i Ht Hd HR).
      split; intros H k A B; apply (satisfied_obligation p PTruth o E s t L k Ht B); auto.
    + rewrite globally_sat by auto. split; intros H k A B; apply (IHp false s t L k Ht Hd); auto.
  - simpl encode_at. rewrite globally_sat by auto.
    split; intros H k A B C; apply (H k A B); apply (IHp false s t L k Ht Hd); auto.
  - simpl encode_at. rewrite eventually_sat.
    split; intros (k & A & B & C); exists k; repeat split; auto; apply (IHp false s t L k Ht Hd); auto.
  - simpl encode_at. rewrite first_sat by auto. split; intros H k Hk; apply (IHp true s t L k Ht Hd); auto.
  - simpl encode_at. change (sat (eventually (as_formula x)) s L i /\
    sat (relativise x (encode_at Episode true p)) s L i
      <-> satisfies (Until x p) s t L i). rewrite eventually_sat.
    assert (HI : forall k, first_step x s L i k ->
              (sat (relativise x (encode_at Episode true p)) s L i <-> satisfies p s t (Some k) i)).
    { intros k HF. rewrite <- (IHp true s t (Some k) i) by eauto using timed_finite, decided_finite.
      apply relativise_correct. left; eauto. }
    split.
    + intros [(k0 & A & B & C) H]. rewrite as_formula_inside in C by auto.
      destruct (first_step_inside x s L k0 i A B C) as (k & _ & Hk). exists k; split; auto. now apply HI.
    + intros (k & HF & H). split; [|now apply (HI k)]. destruct HF as (A & B & C & _).
      exists k; repeat split; auto. now rewrite as_formula_inside.
  - simpl encode_at. rewrite (episodes_sat x y (encode_at Episode true p)) by auto.
    split; intros H k L' Ho HS; apply (IHp true s t L' k); eauto using segment_decided, timed_segment.
  - destruct HR as [R1 R2]. pose proof (part_is_segment c d s t L i R1) as HP. simpl encode_at. simpl satisfies. split.
    + intros H L' HL. pose proof (proj1 (HP L') HL) as HS. rewrite (relativise_correct _ _ _ _ _ _ HS) in H.
      apply (IHp false s t L' i); eauto using segment_decided, timed_part.
    + intros H. destruct (segment_exists s L i (PAtom c) Hd) as (L' & HS). pose proof (proj2 (HP L') HS) as HL.
      rewrite (relativise_correct _ _ _ _ _ _ HS). apply (IHp false s t L' i); eauto using segment_decided, timed_part.
Qed.

(** * Properties without bounds, whose words need no clocks *)

Fixpoint unbounded (p : property) : bool :=
  match p with
  | Now _ | Throughout _ => true
  | Not p | Always p | Never p | Eventually p | After _ p | Until _ p | AfterUntil _ _ p => unbounded p
  | And p q | Or p q | Implies p q => unbounded p && unbounded q
  | Within _ _ _ => false
  end.

Lemma unbounded_no_obligation : forall p x, unbounded p = true -> obligation_of x p = None.
Proof.
  induction p; intros z H; simpl in *; auto; try congruence. apply andb_true_iff in H. destruct H. destruct p1; auto.
Qed.

Lemma unbounded_right : forall p s t L i, unbounded p = true -> right p s t L i.
Proof.
  induction p; intros s t L i H; simpl in *; try congruence; auto; try (apply andb_true_iff in H; destruct H; auto).
  rewrite unbounded_no_obligation by auto. auto.
Qed.

(** Times for words whose times do not matter: one nanosecond a step. *)
Definition no_times : times := fun k => k.
Lemma no_times_timed : forall L, timed no_times L.
Proof. intros L. split; [intros i k H; exact H | intros _ u; exists (S u); unfold no_times; lia]. Qed.

(** On finite words without any axiom; for infinite words see [Infinite.v]. *)
Corollary encode_correct_finite : forall p t w, passing t -> right p (at_step w) t (Some (length w)) 0 ->
  (holds (encode Episode p) w = true <-> satisfies p (at_step w) t (Some (length w)) 0).
Proof.
  intros p t w Ht HR. assert (timed t (Some (length w))) by (split; [auto | congruence]).
  rewrite <- encode_correct by auto using decided_finite. change w with (List.skipn 0 w) at 1. apply holds_sat.
Qed.
