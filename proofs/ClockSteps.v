(** A monitor reads steps and clock steps only: where the letter with its clocks is not what it was. To the reset
    machine that is as if it had read every instant ([steps_are_words]), for a tracker does not move where a letter
    is repeated. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers Resets.

Section Repeated.
  Variables (e : stream) (t : times) (began : nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Variable k : nat.
  Hypothesis repeated : forall a, e (S k) a = e k a.

  Lemma same_letter : forall p, at_letter p (e (S k)) = at_letter p (e k).
  Proof. intros p. apply at_letter_same. auto. Qed.

  Lemma register_repeated : forall f tr, tr (S k) = tr k -> (forall a, tr k = Some a -> a <= k) ->
    (forall a r, tr k = Some a -> f (f r k) (S k) = f r k) -> register f tr (S k) = register f tr k.
  Proof.
    intros f tr H1 H2 H3. rewrite register_eq, H1. destruct (tr k) as [a|] eqn:E; [|now rewrite register_eq, E].
    assert (HB : before f tr (S k) = register f tr k).
    { unfold before. rewrite H1. specialize (H2 a eq_refl). destruct (Nat.leb_spec a k); auto; lia. }
    rewrite HB, register_eq, E. now apply (H3 a).
  Qed.

  Lemma opened_twice : forall x r, opened x e (opened x e r k) (S k) = opened x e r k.
  Proof.
    intros x [j|]; simpl; auto. destruct (at_letter x (e k)) eqn:E; simpl; auto. now rewrite same_letter, E.
  Qed.
  Lemma episode_twice : forall x y r, episode x y e (episode x y e r k) (S k) = episode x y e r k.
  Proof.
    intros x y r. unfold episode. rewrite (same_letter y). destruct (at_letter y (e k)); auto. apply opened_twice.
  Qed.

  Lemma scope_repeated : forall o, scope_tracker o e (S k) = scope_tracker o e k.
  Proof.
    induction o as [|o IH x|o IH x|o IH x y]; simpl; auto; apply register_repeated; auto;
      try (intros a; apply scope_backward); intros a r Ha.
    - apply opened_twice.
    - unfold uncut at 1. rewrite same_letter, IH, Ha. unfold uncut. destruct (at_letter x (e k)); auto. rewrite Ha.
      pose proof (scope_backward o e k a Ha). destruct (Nat.eqb_spec a (S k)); auto; lia.
    - apply episode_twice.
  Qed.

  (** The atoms show how many bounds have passed. *)
  Lemma count_shown : forall x cl i j, about x = Measures cl -> well_formed e t began x ->
    counts_from cl e k = Some i -> counts_from cl e (S k) = Some j ->
    count (bounds x) (t j) (t (S k)) = count (bounds x) (t i) (t k).
  Proof.
    intros x cl i j Ha HW Hi Hj. assert (HL : length (decides x) = length (bounds x)).
    { unfold well_formed in HW. rewrite Ha in HW. tauto. }
    pose proof (count_most (bounds x) (t i) (t k)) as M1. pose proof (count_most (bounds x) (t j) (t (S k))) as M2.
    assert (HN : forall n, n < length (bounds x) -> (n <? count (bounds x) (t j) (t (S k))) = (n <? count (bounds x) (t
      i) (t k))).
    { intros n Hn. pose proof (clock_atoms e t began x cl _ k Ha HW Hi n) as A1.
      pose proof (clock_atoms e t began x cl _ (S k) Ha HW Hj n) as A2. rewrite repeated, A1 in A2 by lia.
      unfold first_of in A2. rewrite !nth_table in A2 by lia. symmetry. apply A2. lia. }
    destruct (lt_eq_lt_dec (count (bounds x) (t j) (t (S k))) (count (bounds x) (t i) (t k))) as [[H|H]|H]; auto;
      exfalso.
    - specialize (HN (count (bounds x) (t j) (t (S k)))). rewrite Nat.ltb_irrefl in HN.
      rewrite (proj2 (Nat.ltb_lt _ _) H) in HN. discriminate HN. lia.
    - specialize (HN (count (bounds x) (t i) (t k))). rewrite Nat.ltb_irrefl in HN.
      rewrite (proj2 (Nat.ltb_lt _ _) H) in HN. discriminate HN. lia.
  Qed.

  Lemma clock_repeated : forall x cl, about x = Measures cl -> well_formed e t began x ->
    after e t began x (S k) = after e t began x k.
  Proof.
    intros x cl Ha HW. unfold after. rewrite Ha. destruct cl as [o|o p q|o p].
    - rewrite scope_repeated. destruct (scope_tracker o e k) as [j|] eqn:E; simpl; auto. f_equal.
      apply (count_shown x (SinceOpening o)); auto. simpl. now rewrite scope_repeated.
    - assert (HR : register (episode p q e) (scope_tracker o e) (S k) = register (episode p q e) (scope_tracker o e) k).
      { apply register_repeated; [apply scope_repeated | intros a; apply scope_backward | intros;
        apply episode_twice]. }
      rewrite HR. destruct (register (episode p q e) (scope_tracker o e) k) as [j|] eqn:E; simpl; auto. f_equal.
      assert (HF : counts_from (FirstOpen o p q) e (S k) = Some j).
      { simpl. unfold before. rewrite scope_repeated. rewrite register_eq in E. pose proof (scope_backward o e k) as HB.
        destruct (scope_tracker o e k) as [a|] eqn:Eo; [|discriminate]. specialize (HB a eq_refl).
        destruct (Nat.leb_spec a k); [|lia]. now rewrite register_eq, Eo. }
      rewrite register_eq in E. destruct (scope_tracker o e k) eqn:Eo; [|discriminate].
      destruct (episode_remembers p q e _ _ _ E) as [->|HP]; [|now apply (count_shown x (FirstOpen o p q) j j Ha HW)].
      rewrite count_now. destruct (before (episode p q e) (scope_tracker o e) k) as [i|] eqn:Eb.
      { rewrite (count_shown x (FirstOpen o p q) i k Ha HW Eb HF). unfold episode, opened in E.
        destruct (at_letter q (e k)); [discriminate|]. injection E as ->. apply count_now. }
      assert (HL : length (decides x) = length (bounds x)) by (unfold well_formed in HW; rewrite Ha in HW; tauto).
      pose proof (count_most (bounds x) (t k) (t (S k))) as M. destruct (count (bounds x) (t k) (t (S k))) as [|i]
        eqn:EC; auto.
      pose proof (clock_atoms e t began x (FirstOpen o p q) _ k Ha HW Eb 0) as A1.
      pose proof (clock_atoms e t began x (FirstOpen o p q) _ (S k) Ha HW HF 0) as A2.
      rewrite repeated, A1 in A2 by lia.
      unfold first_of in A2. rewrite !nth_table, EC in A2 by lia. discriminate A2. lia.
    - assert (HR : at_letter p (e k) = false -> register (trigger p e) (scope_tracker o e) (S k) = register (trigger p
      e) (scope_tracker o e) k).
      { intros Ep. apply register_repeated; [apply scope_repeated | intros a; apply scope_backward |].
        intros a r _. unfold trigger. now rewrite same_letter, Ep. }
      rewrite same_letter. destruct (at_letter p (e k)) eqn:Ep.
      + rewrite !register_eq, scope_repeated. destruct (scope_tracker o e k); auto.
        unfold trigger. now rewrite same_letter, Ep.
      + rewrite HR by auto. destruct (register (trigger p e) (scope_tracker o e) k) as [j|] eqn:E; auto. f_equal.
        apply (count_shown x (LastTrigger o p)); auto.
  Qed.

  (** A bound of the past, as its atom shows it. *)
  Lemma once_repeated : forall x o a D r r' now, decides x = [a] -> (forall k, e k a = value e t began o k) ->
    match D with None => bounds x = [] | Some d => bounds x = [d] /\ 0 < d end ->
    (forall m, tracked e t began o m = answer (recent t D) (if m =? S k then r' else r) m \/ (m <> k /\ m <> S k)) ->
    (now = true /\ r <> None /\ r' <> None \/ r' = r) ->
    once_state t x now r' (S k) = once_state t x now r k.
  Proof.
    intros x o a D r r' now Hd Hv HD HT H. destruct D as [d|]; unfold once_state.
    - destruct HD as [-> _]. destruct H as [(-> & H1 & H2)| ->]; [destruct r, r'; congruence|].
      destruct r as [j|]; auto. destruct now; auto. specialize (Hv (S k)) as V1. specialize (Hv k) as V2.
      rewrite <- tracked_correct in V1, V2 by auto.
      destruct (HT k) as [T1|[T1 _]]; [|congruence]. destruct (HT (S k)) as [T2|[_ T2]]; [|congruence].
      rewrite T1 in V2. rewrite T2, repeated, V2 in V1. rewrite Nat.eqb_refl in V1.
      replace (k =? S k) with false in V1 by (symmetry; apply Nat.eqb_neq; lia). simpl in V1.
      destruct (Nat.leb_spec (t k) (t j + d)), (Nat.leb_spec (t (S k)) (t j + d)); try discriminate;
        destruct (Nat.ltb_spec (t j + d) (t (S k))), (Nat.ltb_spec (t j + d) (t k)); auto; lia.
    - rewrite HD. destruct H as [(_ & H1 & H2)| ->]; [destruct r, r'; congruence | reflexivity].
  Qed.

  Lemma at_k : forall (P : nat -> option nat -> Prop) (r : nat -> option nat), (forall m, P m (r m)) ->
    forall m, P m (if m =? S k then r (S k) else r k) \/ (m <> k /\ m <> S k).
  Proof.
    intros P r H m. destruct (Nat.eqb_spec m (S k)) as [->|H1]; [left; auto|].
    destruct (Nat.eq_dec m k) as [->|H2]; [left; auto | right; auto].
  Qed.

  Theorem state_repeated : forall x, well_formed e t began x -> after e t began x (S k) = after e t began x k.
  Proof.
    intros x HW. destruct (about x) as [o|cl] eqn:Ha; [|now apply (clock_repeated x cl)].
    pose proof HW as HX. unfold well_formed in HX. rewrite Ha in HX. destruct HX as (a & Hd & Hv & HB).
    assert (HE : value e t began o (S k) = value e t began o k) by (rewrite <- !Hv; apply repeated).
    rewrite <- !tracked_correct in HE by auto. unfold after. rewrite Ha. destruct o as [p|D p|D p|D p q|d p].
    - now rewrite same_letter.
    - rewrite same_letter. set (f := fun j => at_letter p (e j)) in *.
      apply (once_repeated x (Once D p) a D (latest f k) (latest f (S k))); auto.
      + apply (at_k (fun m r => tracked e t began (Once D p) m = answer (recent t D) r m) (latest f)). reflexivity.
      + assert (Hf : f (S k) = f k) by apply same_letter. simpl. rewrite Hf.
        destruct (f k) eqn:E; [left|right; auto]. change (at_letter p (e k)) with (f k). rewrite E.
        repeat split; try congruence.
        destruct k; simpl; rewrite E; congruence.
    - set (f := fun j => at_letter p (e j)) in *. assert (Hf : f (S k) = f k) by apply same_letter.
      destruct D as [d|]; [destruct HB as [HB H0]|]; rewrite HB.
      + assert (HS : since_when f (S k) = match f k with true => since_when f k | false => None end).
        { simpl. rewrite Hf. destruct (f k) eqn:E; auto. destruct k; simpl; rewrite E; auto.
        destruct (since_when f n); auto. }
        assert (HN : f k = false -> since_when f k = None) by (intros E; destruct k; simpl; now rewrite E).
        change (answer (long_ago t (Some d)) (since_when f (S k)) (S k) = answer (long_ago t (Some d)) (since_when f k)
          k) in HE.
        rewrite HS in *. destruct (f k) eqn:E; [|now rewrite HN].
        destruct (since_when f k) as [j|]; auto. simpl in HE. simpl. f_equal. rewrite HB. cbn [count].
        destruct (Nat.leb_spec (t j + d) (t (S k))), (Nat.leb_spec (t j + d) (t k)); try discriminate;
          destruct (Nat.ltb_spec (t j + (d - 1)) (t (S k))), (Nat.ltb_spec (t j + (d - 1)) (t k)); auto; lia.
      + rewrite every_next, Hf. destruct (every_instant 0 k f) eqn:E; auto. rewrite every_instant_true in E.
        now rewrite (E k) by lia.
    - rewrite same_letter. set (f := fun j => at_letter p (e j)) in *. set (g := fun j => at_letter q (e j)) in *.
      assert (Hf : f (S k) = f k) by apply same_letter. assert (Hg : g (S k) = g k) by apply same_letter.
      apply (once_repeated x (Since D p q) a D (kept_since f g k) (kept_since f g (S k))); auto.
      + apply (at_k (fun m r => tracked e t began (Since D p q) m = answer (recent t D) r m) (kept_since f g)).
      reflexivity.
      + change (at_letter q (e k)) with (g k). cbn [kept_since]. rewrite Hf, Hg.
        destruct (g k) eqn:E; [left|right; destruct (f k) eqn:E']; auto; [|destruct k; simpl; now rewrite E, E'].
        repeat split; try congruence. destruct k; simpl; rewrite E; congruence.
    - set (f := fun j => at_letter p (e j)) in *. assert (Hf : f (S k) = f k) by apply same_letter.
      change (match latest f (S k) with Some j => t (S k) <=? t j + d | None => t (S k) <=? began + d end =
              match latest f k with Some j => t k <=? t j + d | None => t k <=? began + d end) in HE.
      assert (HS : latest f (S k) = if f (S k) then Some (S k) else latest f k) by reflexivity. rewrite HS, Hf in *.
      clear HS.
      destruct (f k) eqn:E.
      + assert (HL : latest f k = Some k) by (destruct k; simpl; now rewrite E). now rewrite HL, !count_now.
      + rewrite HB. destruct (latest f k) as [j|]; f_equal; cbn [count];
          [destruct (Nat.leb_spec (t (S k)) (t j + d)), (Nat.leb_spec (t k) (t j + d)),
             (Nat.ltb_spec (t j + d) (t (S k))), (Nat.ltb_spec (t j + d) (t k))
          |destruct (Nat.leb_spec (t (S k)) (began + d)), (Nat.leb_spec (t k) (began + d)),
             (Nat.ltb_spec (began + d) (t (S k))), (Nat.ltb_spec (began + d) (t k))]; auto; try discriminate; lia.
  Qed.
End Repeated.

(** * What the monitor has read, and then every instant of what comes, is a fair word *)
Section Steps.
  Variables (news : list nat) (xs : list tracker_of) (e : stream) (t : times) (began : nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Hypothesis all_well_formed : forall x, In x xs -> well_formed e t began x.
  Hypothesis is_word : word news xs e (path news xs e t began).

  (** The instants that are read: the first, every step, and all at which the letter is not what it was; from [n] on,
      every one. Where nothing is read, time passes and the letter is held ([settled_held]). *)
  Variables (read_at : nat -> nat) (n : nat) (v : stream).
  Hypothesis first_read : read_at 0 = 0.
  Hypothesis in_order : forall j, read_at j < read_at (S j).
  Hypothesis left_out : forall j k, read_at j <= k < read_at (S j) -> forall a, e k a = e (read_at j) a.
  Hypothesis held_there : forall j k, read_at j < k < read_at (S j) -> at_letter (settled news xs) (e k) = true.
  Hypothesis all_later : forall i, read_at (n + i) = read_at n + i.
  Hypothesis letters_read : forall j a, v j a = e (read_at j) a.

  Definition path_read (j : nat) : clocks :=
    match j with 0 => start xs | S i => path news xs e t began (S (read_at i)) end.

  Lemma states_left_out : forall j d, read_at j + d < read_at (S j) -> forall x, In x xs ->
    after e t began x (read_at j + d) = after e t began x (read_at j).
  Proof.
    intros j d. induction d as [|d IH]; intros Hd x Hx; [now rewrite Nat.add_0_r|]. rewrite Nat.add_succ_r in *.
    rewrite <- (IH ltac:(lia) x Hx). apply state_repeated; auto. intros a.
    rewrite (left_out j (S (read_at j + d))) by lia. symmetry. apply left_out. lia.
  Qed.

  Lemma path_is_read : forall j, path news xs e t began (read_at j) = path_read j.
  Proof.
    intros [|i]; [now rewrite first_read|]. pose proof (in_order i) as HO. destruct (read_at (S i)) as [|m] eqn:E;
      [lia|].
    destruct (Nat.eq_dec m (read_at i)) as [->|Hm]; [reflexivity|]. simpl.
    pose proof (held_there i m ltac:(lia)) as HM.
    assert (HI : at_letter (settled news xs) (e (read_at i)) = true).
    { rewrite <- HM. apply at_letter_same. intros a _. symmetry. apply left_out. lia. }
    f_equal; apply map_ext_in; intros x Hx.
    - replace m with (read_at i + (m - read_at i)) by lia. apply states_left_out; auto. lia.
    - now rewrite !begun_after_eq, HM, HI.
  Qed.

  Lemma read_order : forall i j, i < j -> read_at i < read_at j.
  Proof. intros i j H. induction H as [|j _ IH]; [apply in_order|]. pose proof (in_order j). lia. Qed.

  Lemma move_read : forall j m,
    moves_by news xs (path news xs e t began (read_at j)) (e (read_at j)) (path news xs e t began (S (read_at j))) m ->
    moves_by news xs (path_read j) (v j) (path_read (S j)) m.
  Proof.
    intros j m (A & B & C). rewrite path_is_read in A. repeat split; auto. rewrite <- B. apply at_letter_same.
    intros a _. apply letters_read.
  Qed.

  Theorem steps_are_words : word news xs v path_read.
  Proof.
    destruct is_word as (_ & HM & HF). split; [reflexivity|]. split.
    - intros j. destruct (HM (read_at j)) as (m & Hm). exists m. now apply move_read.
    - intros i Hi N. destruct (HF i Hi (Nat.max (read_at n) (read_at N))) as (k & m & Hk & Hm & Hf).
      pose proof (all_later (k - read_at n)) as HK. replace (read_at n + (k - read_at n)) with k in HK by lia.
      exists (n + (k - read_at n)), m. rewrite <- HK in Hm. split; [|split; auto using move_read].
      destruct (le_lt_dec N (n + (k - read_at n))) as [|HN]; auto. apply read_order in HN. lia.
  Qed.
End Steps.
