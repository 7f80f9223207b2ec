(** Where the encodings agree with one another, and where they do not: the claims of the documentation, as theorems. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Relativise Encodings.

(** * [always] of an episode property is the [dwyer] one *)

Lemma opens_at : forall x y s L i k, opens x y s L i k -> i <= k /\ inside L k /\ at_letter (opening x y) (s k) = true.
Proof.
  intros x y s L i k H. apply opens_split in H. destruct H as [(A & B & C & _) | (j & D & _ & _ & (A & B & C & _))];
    repeat split; auto; lia.
Qed.

Theorem dwyer_is_always_episode : forall x y f s L i, decided s L ->
  (sat (globally (encode_after_until Episode x y f)) s L i <-> sat (encode_after_until Dwyer x y f) s L i).
Proof.
  intros x y f s L i Hd. simpl encode_after_until at 2. rewrite !globally_sat by auto. split; intros H k H1 H2.
  - destruct (at_letter (opening x y) (s k)) eqn:E.
    2: { left. simpl sat. change (~ sat (as_formula (opening x y)) s L k). rewrite as_formula_inside by auto. congruence. }
    right. destruct (segment_exists s L k y Hd) as (L' & HS). rewrite (relativise_correct y f s L k L' HS).
    specialize (H k H1 H2). rewrite (episodes_sat x y f) in H by auto. apply H; auto.
    apply opens_first. repeat split; auto. intros m Hm; lia.
  - rewrite (episodes_sat x y f) by auto. intros j L' Ho HS. apply opens_at in Ho. destruct Ho as (A & B & C).
    destruct (H j) as [Hn|Hj]; auto; try lia.
    + exfalso; apply Hn. apply (as_formula_inside (opening x y)); auto.
    + now rewrite (relativise_correct y f s L j L' HS) in Hj.
Qed.

Fixpoint after_until_free (p : property) : bool :=
  match p with
  | Now _ | Throughout _ => true
  | Not p | Always p | Never p | Eventually p | After _ p | Properties.Until _ p | Within _ _ p => after_until_free p
  | And p q | Or p q | Implies p q => after_until_free p && after_until_free q
  | AfterUntil _ _ _ => false
  end.

Lemma dwyer_is_episode_elsewhere : forall p b, after_until_free p = true -> encode_at Dwyer b p = encode_at Episode b p.
Proof.
  induction p; intros b H; simpl in *; try congruence; try (apply andb_true_iff in H; destruct H);
    rewrite ?IHp, ?IHp1, ?IHp2 by auto; auto.
Qed.

Corollary always_after_until : forall x y p s L i, after_until_free p = true -> decided s L ->
  (sat (encode Episode (Always (AfterUntil x y p))) s L i <-> sat (encode Dwyer (AfterUntil x y p)) s L i).
Proof.
  intros x y p s L i H Hd.
  change (encode Dwyer (AfterUntil x y p)) with (encode_after_until Dwyer x y (encode_at Dwyer true p)).
  rewrite dwyer_is_episode_elsewhere by auto. now apply dwyer_is_always_episode.
Qed.

(** * On bodies that are state predicates, [pointwise] and [dwyer] agree with [episode] *)

(** The predicate that a body demands throughout, if it is no more than that. *)
Fixpoint bare (p : property) : option predicate :=
  match p with
  | Throughout p => Some p
  | And p q => match bare p, bare q with Some p, Some q => Some (PAnd p q) | _, _ => None end
  | _ => None
  end.

Fixpoint bare_bodies (p : property) : bool :=
  match p with
  | Now _ | Throughout _ => true
  | Not p | Always p | Never p | Eventually p => bare_bodies p
  | And p q | Or p q | Implies p q => bare_bodies p && bare_bodies q
  | After _ p | Properties.Until _ p | AfterUntil _ _ p => if bare p then true else false
  | Within _ _ p => bare_bodies p
  end.

Lemma bare_pointwise : forall p q s L i, bare p = Some q ->
  (sat (encode_at Pointwise true p) s L i <-> sat (as_formula q) s L i).
Proof.
  induction p; intros r s L i H; simpl in H; try congruence.
  - injection H as <-. reflexivity.
  - destruct (bare p1) as [q1|] eqn:E1, (bare p2) as [q2|] eqn:E2; try congruence. injection H as <-.
    simpl. now rewrite (IHp1 q1), (IHp2 q2).
Qed.

Lemma bare_throughout : forall p q e s L i, bare p = Some q -> bare_body e = false -> decided s L ->
  (sat (encode_at e true p) s L i <-> forall k, i <= k -> inside L k -> at_letter q (s k) = true).
Proof.
  induction p; intros r e s L i H He Hd; simpl in H; try congruence.
  - injection H as <-. simpl encode_at. rewrite He. simpl andb. now apply throughout_sat.
  - destruct (bare p1) as [q1|] eqn:E1, (bare p2) as [q2|] eqn:E2; try congruence. injection H as <-.
    simpl. rewrite (IHp1 q1), (IHp2 q2) by auto. split.
    + intros [A B] k H1 H2. now rewrite A, B.
    + intros A; split; intros k H1 H2; specialize (A k H1 H2); apply andb_true_iff in A; tauto.
Qed.

Section BareBodies.
  Variables (x y q : predicate) (s : stream) (L : option nat).
  Hypothesis Hd : decided s L.

  (** What all of them say: [q] at every step from an [x] without [y] on, up to the next [y]. *)
  Definition guarded (i : nat) : Prop :=
    forall k m, i <= k <= m -> inside L m -> at_letter (opening x y) (s k) = true ->
    (forall c, k < c <= m -> at_letter y (s c) = false) -> at_letter q (s m) = true.

  Lemma episode_of : forall i k, i <= k -> inside L k -> at_letter (opening x y) (s k) = true ->
    exists k0, i <= k0 <= k /\ opens x y s L i k0 /\ forall c, k0 < c <= k -> at_letter y (s c) = false.
  Proof.
    intros i k Hk Hb Ho.
    assert (HJ : exists j, i <= j <= k /\ (j = i \/ at_letter y (s j) = true) /\
                           forall c, j < c <= k -> at_letter y (s c) = false).
    { clear Ho Hb. induction k as [|k IH].
      - exists 0. repeat split; lia.
      - destruct (at_letter y (s (S k))) eqn:E; [exists (S k); repeat split; auto; intros; lia|].
        destruct (Nat.eq_dec i (S k)) as [->|]; [exists (S k); repeat split; auto; intros; lia|].
        destruct IH as (j & A & B & C); [lia|]. exists j; repeat split; auto; try lia.
        intros c Hc. destruct (Nat.eq_dec c (S k)); subst; auto. apply C; lia. }
    destruct HJ as (j & A & B & C).
    destruct (first_step_inside (opening x y) s L k j) as (k0 & D & E); auto; [lia|].
    pose proof E as (E1 & _). exists k0. split; [lia|]. split; [|intros; apply C; lia].
    destruct B as [-> | B]; [now apply opens_first|]. apply opens_split. right. exists j.
    split; [lia|]. split; [eapply inside_le; [|exact Hb]; lia | auto].
  Qed.

  Lemma episode_guarded : forall f i,
    (forall s L i, decided s L -> (sat f s L i <-> forall k, i <= k -> inside L k -> at_letter q (s k) = true)) ->
    (sat (encode_after_until Episode x y f) s L i <-> guarded i).
  Proof.
    intros f i Hf. rewrite episodes_sat by auto. split.
    - intros H k m Hkm Hb Ho Hy. assert (Hbk : inside L k) by (eapply inside_le; [|exact Hb]; lia).
      destruct (episode_of i k) as (k0 & A & B & C); auto; try lia.
      destruct (segment_exists s L k0 y Hd) as (L' & HS). specialize (H k0 L' B HS).
      rewrite Hf in H by (eapply segment_decided; eauto). apply H; [lia|].
      apply (reaches_segment s L k0 y L' m HS); auto; [lia|]. intros c Hc.
      destruct (Nat.eq_dec c k0) as [->|].
      + apply opens_at in B. now apply (opening_true x y).
      + destruct (le_lt_dec c k); [apply C | apply Hy]; lia.
    - intros H k L' Ho HS. apply opens_at in Ho. destruct Ho as (A & B & C).
      rewrite Hf by (eapply segment_decided; eauto). intros m Hm Hb.
      apply (H k m); auto; [apply (in_segment s L k y L' m HS); auto|]. intros c Hc.
      apply (in_segment s L k y L' c HS); [lia | eapply inside_le; [|exact Hb]; lia].
  Qed.

  Lemma dwyer_guarded : forall f i,
    (forall s L i, decided s L -> (sat f s L i <-> forall k, i <= k -> inside L k -> at_letter q (s k) = true)) ->
    (sat (encode_after_until Dwyer x y f) s L i <-> guarded i).
  Proof.
    intros f i Hf. rewrite <- dwyer_is_always_episode, globally_sat by auto. split.
    - intros H k m Hkm Hb. specialize (H k). rewrite episode_guarded in H by auto. apply H; auto; try lia.
      eapply inside_le; [|exact Hb]; lia.
    - intros H k Hk _. rewrite episode_guarded by auto. intros j m Hj. apply H; lia.
  Qed.

  Lemma pointwise_guarded : forall f i,
    (forall j, sat f s L j <-> sat (as_formula q) s L j) ->
    (sat (encode_after_until Pointwise x y f) s L i <-> guarded i).
  Proof.
    intros f i Hf. simpl encode_after_until. rewrite globally_sat by auto. split.
    - intros H k m Hkm Hb Ho Hy. assert (Hin : forall c, c <= m -> inside L c) by (intros; eapply inside_le; [|exact Hb]; lia).
      pose proof (opening_true x y _ Ho) as [Hx Hyk].
      destruct (H k) as [Hn|Hw]; [lia | apply Hin; lia | |].
      { exfalso; apply Hn. apply as_formula_inside; auto. apply Hin; lia. }
      destruct (at_letter q (s m)) eqn:Eq; auto. exfalso. apply Hw.
      assert (HN : forall c, k <= c <= m -> ~ sat (as_formula y) s L c).
      { intros c Hc. rewrite as_formula_inside by (apply Hin; lia).
        destruct (Nat.eq_dec c k) as [->|]; [congruence|]. rewrite Hy by lia; congruence. }
      exists m. split; [lia|]. split; [auto|]. split; [|intros; apply HN; lia].
      split; [|apply HN; lia]. intros Hs. rewrite Hf, as_formula_inside in Hs by auto. congruence.
    - intros H k Hk Hb. destruct (at_letter x (s k)) eqn:Ex.
      2: { left. simpl. rewrite as_formula_inside by auto. congruence. }
      right. intros (m & A & B & (C & Hm) & D). apply C. rewrite Hf, as_formula_inside by auto.
      assert (HY : forall c, k <= c <= m -> at_letter y (s c) = false).
      { intros c Hc. destruct (at_letter y (s c)) eqn:E; auto. exfalso.
        assert (Hs : sat (as_formula y) s L c) by (apply as_formula_inside; auto; eapply inside_le; [|exact B]; lia).
        destruct (Nat.eq_dec c m) as [->|]; [now apply Hm | apply (D c); auto; lia]. }
      apply (H k m); auto; [simpl; rewrite Ex, HY by lia; reflexivity|]. intros c Hc. apply HY; lia.
  Qed.

  Lemma pointwise_after : forall f g i,
    (forall j, sat f s L j <-> sat (as_formula q) s L j) ->
    (forall j, sat g s L j <-> forall k, j <= k -> inside L k -> at_letter q (s k) = true) ->
    (sat (encode_after Pointwise x f) s L i <-> sat (encode_after Episode x g) s L i).
  Proof.
    intros f g i Hf Hg. simpl encode_after. rewrite first_sat, globally_sat by auto. split.
    - intros H k Hk. destruct Hk as (A & B & C & D). destruct (H k A B) as [Hn|Hs].
      + exfalso; apply Hn. now apply as_formula_inside.
      + rewrite globally_sat in Hs by auto. rewrite Hg. intros m Hm Hb.
        specialize (Hs m Hm Hb). now rewrite Hf, as_formula_inside in Hs.
    - intros H k A B. destruct (at_letter x (s k)) eqn:E.
      2: { left. simpl. rewrite as_formula_inside by auto. congruence. }
      right. destruct (first_step_inside x s L k i A B E) as (j & Hj & Hf0).
      specialize (H j Hf0). rewrite Hg in H. rewrite globally_sat by auto. intros m Hm Hb.
      rewrite Hf, as_formula_inside by auto. apply H; auto; lia.
  Qed.

  Lemma pointwise_until : forall f g i,
    (forall j, sat f s L j <-> sat (as_formula q) s L j) ->
    (forall s L j, decided s L -> (sat g s L j <-> forall k, j <= k -> inside L k -> at_letter q (s k) = true)) ->
    (sat (encode_until Pointwise x f) s L i <-> sat (encode_until Episode x g) s L i).
  Proof.
    intros f g i Hf Hg. change (sat (Ltl.Until f (as_formula x)) s L i <->
      sat (eventually (as_formula x)) s L i /\ sat (relativise x g) s L i). rewrite eventually_sat. split.
    - intros (k & A & B & C & D). split; [exists k; auto|]. rewrite as_formula_inside in C by auto.
      destruct (first_step_inside x s L k i A B C) as (m & Hm & Hfm).
      rewrite (relativise_correct x g s L i (Some m)) by (left; eauto). rewrite Hg by apply decided_finite.
      intros c Hc Hb. simpl in Hb. specialize (D c). rewrite Hf, as_formula_inside in D.
      + apply D; lia.
      + eapply inside_le; [|exact B]; lia.
    - intros [(k & A & B & C) HR]. rewrite as_formula_inside in C by auto.
      destruct (first_step_inside x s L k i A B C) as (m & Hm & Hfm).
      rewrite (relativise_correct x g s L i (Some m)) in HR by (left; eauto). rewrite Hg in HR by apply decided_finite.
      destruct Hfm as (E & F & G & _). exists m. repeat split; auto; [now apply as_formula_inside|].
      intros c Hc. rewrite Hf, as_formula_inside by (eapply inside_le; [|exact F]; lia). apply HR; simpl; lia.
  Qed.
End BareBodies.

Theorem bare_bodies_agree : forall e p s L i, e = Pointwise \/ e = Dwyer -> bare_bodies p = true -> decided s L ->
  (sat (encode e p) s L i <-> sat (encode Episode p) s L i).
Proof.
  unfold encode. intros e p s L i He. revert L i.
  induction p; intros L i H Hd; simpl in H;
    try (apply andb_true_iff in H; destruct H); try (destruct (bare p) as [q|] eqn:Eq; [clear H | congruence]).
  - reflexivity.
  - reflexivity.
  - simpl. now rewrite IHp.
  - simpl. now rewrite IHp1, IHp2.
  - simpl. now rewrite IHp1, IHp2.
  - simpl. now rewrite IHp1, IHp2.
  - simpl encode_at. destruct (obligation_of PTruth p); [reflexivity|].
    rewrite !globally_sat by auto. split; intros A k B C; apply IHp; auto.
  - simpl encode_at. rewrite !globally_sat by auto. split; intros A k B C D; apply (A k B C); apply IHp; auto.
  - simpl encode_at. rewrite !eventually_sat. split; intros (k & A & B & C); exists k; repeat split; auto; apply IHp; auto.
  - simpl encode_at. destruct He as [-> | ->].
    + apply (pointwise_after x q); auto; intros j; [now apply bare_pointwise | now apply bare_throughout].
    + change (encode_after Dwyer) with (encode_after Episode). simpl encode_after. rewrite !first_sat by auto.
      split; intros A k B; specialize (A k B); rewrite (bare_throughout p q) in *; auto.
  - simpl encode_at. destruct He as [-> | ->].
    + apply (pointwise_until x q); auto; intros; [now apply bare_pointwise | now apply bare_throughout].
    + assert (HR : forall L', segment s L i x L' ->
        (sat (relativise x (encode_at Dwyer true p)) s L i <-> sat (relativise x (encode_at Episode true p)) s L i)).
      { intros L' HS. rewrite !(relativise_correct x _ s L i L' HS).
        rewrite !(bare_throughout p q) by (auto; eapply segment_decided; eauto). reflexivity. }
      destruct (segment_exists s L i x Hd) as (L' & HS). specialize (HR L' HS).
      change (sat (eventually (as_formula x)) s L i /\ sat (relativise x (encode_at Dwyer true p)) s L i <->
              sat (eventually (as_formula x)) s L i /\ sat (relativise x (encode_at Episode true p)) s L i). tauto.
  - simpl encode_at.
    rewrite (episode_guarded x y q s L Hd (encode_at Episode true p)) by (intros; now apply bare_throughout).
    destruct He as [-> | ->].
    + apply pointwise_guarded; auto. intros; now apply bare_pointwise.
    + apply dwyer_guarded; auto. intros; now apply bare_throughout.
  - simpl encode_at. destruct (segment_exists s L i (PAtom c) Hd) as (L' & HS).
    rewrite !(relativise_correct (PAtom c) _ s L i L' HS). apply IHp; eauto using segment_decided.
Qed.

(** * Where they differ: runs that one encoding accepts and the other does not *)

Definition steps (w : list (list nat)) : list letter := map (fun l a => existsb (Nat.eqb a) l) w.

(** Atoms of the examples: near the sign, far from it, stopped. *)
Definition near := PAtom 0.
Definition far := PAtom 1.
Definition stopped := PAtom 2.

(** The robot stops at the sign and drives on while it is still near. *)
Definition stops_then_drives_on := steps [[0]; [0; 2]; [0]; [1]].
Definition stop_at_sign := AfterUntil near far (Eventually (Now stopped)).

Theorem episode_accepts_driving_on : holds (encode Episode stop_at_sign) stops_then_drives_on = true.
Proof. reflexivity. Qed.
Theorem dwyer_rejects_driving_on : holds (encode Dwyer stop_at_sign) stops_then_drives_on = false.
Proof. reflexivity. Qed.
Theorem pointwise_rejects_driving_on : holds (encode Pointwise stop_at_sign) stops_then_drives_on = false.
Proof. reflexivity. Qed.
Theorem pointwise_strong_rejects_driving_on : holds (encode PointwiseStrong stop_at_sign) stops_then_drives_on = false.
Proof. reflexivity. Qed.

(** An episode that does not end: only [pointwise-strong] asks for its end, even of a state predicate. *)
Definition stay_stopped := AfterUntil near far (Throughout stopped).
Theorem episode_accepts_open_episode : holds (encode Episode stay_stopped) (steps [[0; 2]]) = true.
Proof. reflexivity. Qed.
Theorem pointwise_strong_rejects_open_episode : holds (encode PointwiseStrong stay_stopped) (steps [[0; 2]]) = false.
Proof. reflexivity. Qed.

(** [after near, eventually stopped]: once for [episode], again and again for [pointwise]. *)
Definition stop_once := After near (Eventually (Now stopped)).
Theorem episode_accepts_one_stop : holds (encode Episode stop_once) (steps [[0; 2]; []]) = true.
Proof. reflexivity. Qed.
Theorem pointwise_rejects_one_stop : holds (encode Pointwise stop_once) (steps [[0; 2]; []]) = false.
Proof. reflexivity. Qed.

(** [until far, eventually stopped]: for [episode] the stop must come before, [pointwise] looks beyond the scope. *)
Definition stop_before := Properties.Until far (Eventually (Now stopped)).
Theorem episode_rejects_late_stop : holds (encode Episode stop_before) (steps [[]; [1]; [2]]) = false.
Proof. reflexivity. Qed.
Theorem pointwise_accepts_late_stop : holds (encode Pointwise stop_before) (steps [[]; [1]; [2]]) = true.
Proof. reflexivity. Qed.
