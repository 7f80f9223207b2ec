(** That the checker of [Follows.v] may be believed: after every run, an accepted program shows the verdict of its
    monitor ([followed_sound]). At each instant the two are in a pair, the trackers stand as it says, and each clock is
    due when its next bound passes ([in_pair]). *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers Resets Monitor Conditions Judgements Moves Certificate Program Follows.

Lemma choices_in : forall late options, Forall2 (fun b o => In b o) late options -> In late (choices options).
Proof.
  intros late options H. induction H as [|b o late options Hb _ IH]; simpl; auto.
  apply in_flat_map. exists b. split; auto. apply in_map. exact IH.
Qed.

Lemma are_due_right_nth : forall is_right y rs i, are_due_right is_right y i rs = true ->
  forall j r, nth_error rs j = Some r -> is_right r (setting_of (i + j) y) = true.
Proof.
  induction rs as [|r rs IH]; intros i H [|j] r' E; simpl in *; try discriminate; apply andb_true_iff in H;
    destruct H as [H1 H2]; [injection E as <-; now rewrite Nat.add_0_r | rewrite Nat.add_succ_r; now apply (IH (S i) H2)].
Qed.

Lemma ends_same : forall P answers answers' w y,
  (forall b, In b (branches P) -> answers' (asked b) = answers (asked b)) -> ends P answers w y -> ends P answers' w y.
Proof.
  intros P answers answers' w y HE H. induction H as [o x Ho|b x z Hb _ IH]; [now constructor|].
  apply (ends_asked P _ b x); auto. rewrite HE; auto. now apply nth_error_In in Hb.
Qed.

(** When a clock is due that was due [old], or not. *)
Definition set_at (old : option nat) (now : nat) (setting : option (anchor * nat)) : option nat :=
  match setting with
  | None => None
  | Some (ThisInstant, d) => Some (now + d)
  | Some (JustBefore, d) => Some (now - 1 + d)
  | Some (WhenDue, d) => option_map (plus d) old
  end.

Lemma done_due : forall c now y i, due (done c now y) i = set_at (due c i) now (setting_of i y).
Proof.
  intros c now y i. unfold done, setting_of. simpl. destruct (find _ (settings y)) as [z|] eqn:E.
  - apply find_some in E. destruct E as [_ E]. apply Nat.eqb_eq in E. unfold set_due. rewrite E. reflexivity.
  - simpl. now destruct (due c i).
Qed.

Lemma not_set : forall y i n, (forall z, In z (settings y) -> set_clock z < n) -> n <= i ->
  setting_of i y = Some (WhenDue, 0).
Proof.
  intros y i n H Hi. unfold setting_of. destruct (find _ (settings y)) as [z|] eqn:E; auto. apply find_some in E.
  destruct E as [E1 E2]. apply Nat.eqb_eq in E2. specialize (H z E1). lia.
Qed.

(** * One clock *)
Section Clock.
  Variables (e : stream) (t : times) (began : nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Variable x : tracker_of.
  Hypothesis HW : well_formed e t began x.

  Let state_at := before_instant e t began x.
  Let case_at := the_case e t began x.
  Let bound n := nth n (bounds x) 0.

  (** From when the clock counts, and when it is due, before instant k. *)
  Definition from (k : nat) : nat := match k with 0 => began | S j => base e t began x j end.
  Definition due_in (k : nat) : option nat :=
    if counts x (state_at k) then Some (from k + bound (snd (state_at k))) else None.
  Definition late_in (k : nat) : bool := match due_in k with Some d => d <? t k | None => false end.
  Definition occasion_at (k : nat) : occasion :=
    match k with 0 => Opening | S j => if t (S j) =? t j then Step else Wait end.

  Lemma case_fits : forall k, In (case_at k) (cases x (state_at k) (around e (about x) k)) /\ fits e t began x k (case_at k).
  Proof. intros k. now apply the_case_fits. Qed.
  Lemma next_state : forall k, next (case_at k) = state_at (S k).
  Proof. intros k. destruct (case_fits k) as [_ (_ & _ & H & _)]. exact H. Qed.

  Lemma bounds_rise : rising (bounds x).
  Proof.
    unfold well_formed in HW. destruct (about x) as [o|cl]; [|tauto]. destruct HW as (a & _ & _ & H).
    destruct o as [p|[d|] p|[d|] p|[d|] p q|d p]; (first [rewrite (proj1 H) | rewrite H]); simpl; auto.
  Qed.

  Lemma age_state : forall d p, about x = Follows (Age d p) -> bounds x = [d] /\ state_at 0 = (First, 0) /\
    forall k, exists j, state_at (S k) = (Running, count (bounds x) j (t k)).
  Proof.
    intros d p Ha. unfold well_formed in HW. rewrite Ha in HW. destruct HW as (a & _ & _ & HB). split; auto.
    unfold state_at, before_instant, initial, after. rewrite Ha. split; auto. intros k.
    destruct (latest (fun j => at_letter p (e j)) k); eauto.
  Qed.

  Lemma after_counts : forall k, counts x (state_at (S k)) = is_running x (state_at (S k)).
  Proof.
    intros k. unfold counts. destruct (about x) as [[p|D p|D p|D p q|d p]|cl] eqn:Ha; try apply orb_false_r.
    destruct (age_state d p Ha) as (_ & _ & H). destruct (H k) as (j & ->). apply orb_false_r.
  Qed.

  Lemma running_state : forall k, is_running x (state_at (S k)) = true ->
    state_at (S k) = (Running, count (bounds x) (base e t began x k) (t k)) /\ snd (state_at (S k)) < length (bounds x).
  Proof.
    intros k H. pose proof (after_running e t began x k HW H) as E. split; auto. revert H. unfold is_running.
    change (state_at (S k)) with (after e t began x k). rewrite E. simpl. apply Nat.ltb_lt.
  Qed.

  Lemma counts_first : counts x (state_at 0) = true -> exists d p, about x = Follows (Age d p).
  Proof.
    unfold counts, state_at, before_instant, initial. destruct (about x) as [[p|D p|D p|D p q|d p]|cl]; simpl; eauto;
      discriminate.
  Qed.

  (** An age that is not over at the first instant counts from the beginning of the session. *)
  Lemma age_first : forall d p, about x = Follows (Age d p) -> starts (case_at 0) = false ->
    latest (fun j => at_letter p (e j)) 0 = None /\
    passed (case_at 0) = Some (count (bounds x) began (t 0)).
  Proof.
    intros d p Ha HS. destruct (case_fits 0) as [HI (HG & _ & HN & _)]. unfold cases in HI. rewrite Ha in HI.
    destruct HI as [HI|HI]; [rewrite <- HI in HS; discriminate HS|]. apply in_map_iff in HI. destruct HI as (n & HI & _).
    rewrite <- HI in HG, HN. rewrite <- HI. simpl in HG. apply negb_true_iff in HG. simpl. rewrite HG. split; auto.
    unfold after in HN. rewrite Ha in HN. simpl in HN. rewrite HG in HN. congruence.
  Qed.

  Lemma late_in_may_be : forall k, In (late_in k) (may_be_late (occasion_at k) (x, state_at k, case_at k)).
  Proof.
    intros k. unfold late_in, due_in, may_be_late. destruct (counts x (state_at k)) eqn:EC;
      [|destruct (occasion_at k); simpl; auto].
    destruct k as [|j].
    - cbn [occasion_at from]. destruct (counts_first EC) as (d & p & Ha). destruct (age_state d p Ha) as (HB & HS & _).
      destruct (starts (case_at 0)) eqn:Es.
      + destruct (case_fits 0) as [HI _]. unfold cases in HI. rewrite Ha in HI. destruct HI as [HI|HI].
        * rewrite <- HI. simpl. destruct (_ <? _); auto.
        * apply in_map_iff in HI. destruct HI as (n & HI & _). rewrite <- HI in Es. discriminate Es.
      + destruct (age_first d p Ha Es) as [_ ->]. left. unfold bound. rewrite HS. simpl.
        symmetry. apply (count_nth (bounds x) began (t 0) 0 bounds_rise). rewrite HB. simpl. lia.
    - rewrite after_counts in EC. destruct (running_state j EC) as [HS HL]. simpl from.
      assert (HC : forall n, bound n = nth n (bounds x) 0) by reflexivity.
      unfold occasion_at. destruct (Nat.eqb_spec (t (S j)) (t j)) as [E|E].
      + left. rewrite E, HC, (count_nth _ _ _ _ bounds_rise HL). rewrite HS. simpl. symmetry. apply Nat.ltb_irrefl.
      + destruct (case_fits (S j)) as [_ (_ & _ & _ & _ & HP & _)].
        destruct (passed (case_at (S j))) as [n|] eqn:EP; [|destruct (_ <? _); simpl; auto].
        destruct (HP n EC eq_refl) as (i & Ei & Hn & _). injection Ei as <-. left.
        rewrite HC, (count_nth _ _ _ _ bounds_rise HL). now rewrite <- Hn.
  Qed.

  Lemma step_passes_nothing : forall k, occasion_at k = Step -> passes x (state_at k) (case_at k) = false.
  Proof.
    intros [|j] H; [discriminate H|]. unfold occasion_at in H. destruct (Nat.eqb_spec (t (S j)) (t j)) as [E|]; [|discriminate].
    unfold passes. destruct (is_running x (state_at (S j))) eqn:ER; auto.
    destruct (passed (case_at (S j))) as [n|] eqn:EP; auto. simpl. apply Nat.ltb_ge.
    destruct (case_fits (S j)) as [_ (_ & _ & _ & _ & HP & _)]. destruct (HP n ER EP) as (i & Ei & _ & Hlt).
    injection Ei as <-. fold state_at in Hlt. destruct (le_lt_dec n (snd (state_at (S j)))) as [|HX]; auto.
    specialize (Hlt HX). lia.
  Qed.

  (** How the clock counts on. *)
  Lemma counts_on : forall k, is_running x (state_at (S k)) = true ->
    if starts (case_at k) then from (S k) = t k
    else if is_held (state_at k) then from (S k) = from k /\ match k with 0 => False | S j => from k = t j end
    else counts x (state_at k) = true -> from (S k) = from k.
  Proof.
    intros k HR. destruct (case_fits k) as [_ (_ & _ & HN & _ & _ & HB)]. unfold runs_from in HB. rewrite HN in HB.
    specialize (HB HR). destruct (starts (case_at k)) eqn:Es; [exact HB|]. destruct k as [|j].
    - assert (HH : is_held (state_at 0) = false).
      { unfold state_at, before_instant, initial. destruct (about x) as [[]|]; reflexivity. }
      rewrite HH. intros HC. destruct (counts_first HC) as (d & p & Ha). destruct (age_first d p Ha Es) as [HL _].
      simpl from. unfold base. now rewrite Ha, HL.
    - specialize (HB j eq_refl). simpl from. destruct (is_held (state_at (S j))) eqn:EH; auto. split; auto.
      apply held_base. unfold is_held, state_at in EH. simpl in EH. destruct (fst (after e t began x j)); auto; discriminate.
  Qed.

  Lemma due_after : forall k setting, is_due_right (occasion_at k) (x, state_at k, case_at k) setting = true ->
    set_at (due_in k) (t k) setting = due_in (S k).
  Proof.
    intros k setting H. unfold due_in. rewrite after_counts. unfold is_due_right in H. rewrite next_state in H.
    fold (bound (snd (state_at k))) in H. fold (bound (snd (state_at (S k)))) in H. pose proof (counts_on k) as HC.
    destruct setting as [[[| |] d]|]; cbn [set_at].
    - rewrite !andb_true_iff, orb_true_iff, andb_true_iff, Nat.eqb_eq in H. destruct H as [[HR HS] ->].
      rewrite HR. specialize (HC HR). do 2 f_equal. destruct (starts (case_at k)) eqn:Es; [now rewrite HC|].
      destruct HS as [HS|[HH HO]]; [discriminate|]. rewrite HH in HC. destruct k as [|j]; [now destruct HC|].
      destruct HC as [-> ->]. unfold occasion_at in HO. destruct (Nat.eqb_spec (t (S j)) (t j)); [lia | discriminate].
    - rewrite !andb_true_iff, negb_true_iff, Nat.eqb_eq in H. destruct H as [[[[HR Es] HH] HO] ->].
      rewrite HR. specialize (HC HR). rewrite Es, HH in HC. destruct k as [|j]; [now destruct HC|].
      destruct HC as [-> ->]. unfold occasion_at in HO. destruct (Nat.eqb_spec (t (S j)) (t j)); [discriminate|].
      pose proof (dense j). pose proof (Ht j (S j) ltac:(lia)). f_equal. lia.
    - destruct (counts x (state_at k)) eqn:EC.
      + rewrite !andb_true_iff, !negb_true_iff, Nat.eqb_eq in H. destruct H as [[[HR Es] HH] HD]. rewrite HR.
        specialize (HC HR). rewrite Es, HH in HC. rewrite (HC eq_refl). cbn [option_map]. f_equal. lia.
      + apply negb_true_iff in H. now rewrite H.
    - apply negb_true_iff in H. now rewrite H.
  Qed.

  Lemma off_after : forall k setting, is_off (x, state_at k, case_at k) setting = true ->
    set_at (due_in k) (t k) setting = None.
  Proof.
    intros k [[[| |] d]|] H; simpl in *; try discriminate; auto. unfold due_in. apply negb_true_iff in H. now rewrite H.
  Qed.
End Clock.

(** * The run *)
Section Run.
  Variables (depth work : nat) (news : list nat) (xs : list tracker_of) (A : predicate).
  Variables (P : program) (M : monitor) (pairs : list pair).
  Hypothesis accepted : follows_monitor depth work news xs A M P pairs = true.

  (** The letters that the program reads, and those that the monitor reads, with the atoms that trackers decide. Time
      passes only where there is something to time; then the letter is held, and news is over. *)
  Variables (s e : stream) (t : times) (began N : nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Hypothesis all_well_formed : forall x, In x xs -> well_formed e t began x.
  Hypothesis all_placed : placed [] xs.
  Hypothesis letters_read : forall k a, is_decided xs a = false -> e k a = s k a.
  Hypothesis held_letters : forall k, t k < t (S k) -> is_trivial news xs = false /\
    (forall a, In a news -> e (S k) a = false) /\ (forall a, timed_atom news xs a = false -> e (S k) a = e k a).
  Hypothesis allowed_letters : forall k, k < N -> at_letter A (e k) = true.

  Let clocks := filter has_bounds xs.
  Definition states_at (k : nat) : list state := map (fun x => before_instant e t began x k) xs.
  Definition cases_of (k : nat) : list case := map (fun x => the_case e t began x k) xs.
  Definition late_at (k : nat) : list bool := map (fun x => late_in e t began x k) clocks.
  Definition due_of (k i : nat) : option nat :=
    match nth_error clocks i with Some x => due_in e t began x k | None => None end.
  Let rows_at (k : nat) : list row := rows xs (states_at k) (cases_of k).

  Lemma clock_well_formed : forall x, In x clocks -> well_formed e t began x.
  Proof. intros x H. apply filter_In in H. now apply all_well_formed. Qed.

  Lemma rows_are : forall k, rows_at k = map (fun x => (x, before_instant e t began x k, the_case e t began x k)) clocks.
  Proof.
    intros k. unfold rows_at, states_at, cases_of, clocks. clear. induction xs as [|x ys IH]; simpl; auto.
    rewrite IH. now destruct (has_bounds x).
  Qed.

  Lemma next_states : forall k, map next (cases_of k) = states_at (S k).
  Proof.
    intros k. unfold cases_of, states_at. rewrite map_map. apply map_ext_in. intros x Hx.
    apply (next_state e t began Ht dense x). auto.
  Qed.

  Lemma nothing_passes : forall k, occasion_at t k = Step ->
    existsb (fun b => b) (those_passing xs (states_at k) (cases_of k)) = false.
  Proof.
    intros k Hk. unfold states_at, cases_of. pose proof all_well_formed as HW. revert HW. clear - Ht dense Hk.
    induction xs as [|x ys IH]; simpl; intros HW; auto.
    rewrite (step_passes_nothing e t began Ht dense x (HW x (or_introl eq_refl)) k Hk). simpl. auto.
  Qed.

  Lemma late_chosen : forall k, In (late_at k) (choices (map (may_be_late (occasion_at t k)) (rows_at k))).
  Proof.
    intros k. apply choices_in. rewrite rows_are, map_map. unfold late_at. pose proof clock_well_formed as HW. revert HW.
    generalize clocks as l. clear - Ht dense. induction l as [|x l IH]; simpl; intros HW; constructor; auto.
    apply late_in_may_be; auto.
  Qed.

  Lemma together_at : forall k, exists g, at_letter g (e k) = true /\ In (g, cases_of k)
    (together xs (states_at k) (fun _ => closed) match occasion_at t k with Opening => true | _ => false end).
  Proof.
    intros k. destruct (together_follows e t began Ht dense xs [] (fun _ => closed) k
      match occasion_at t k with Opening => true | _ => false end) as (g & H1 & H2); eauto.
    - intros o [].
    - intros _. unfold occasion_at. destruct k as [|j]; auto. now destruct (t (S j) =? t j).
  Qed.

  Lemma moves_at : forall k q x r looks, moves_on xs P M pairs (occasion_at t k) q x r (states_at k) looks (e k) ->
    exists w, way_to_go (occasion_at t k) x looks (late_at k) = Some w /\
      leads_to P M (late_at k) w q r (e k) (landed P M pairs (occasion_at t k) (rows_at k) (cases_of k) (e k)).
  Proof.
    intros k q x r looks H. destruct (together_at k) as (g & H1 & H2).
    apply (H g (cases_of k) H2 H1 (nothing_passes k)). apply late_chosen.
  Qed.

  (** ** What the program does *)

  Lemma existsb_nth : forall f late, (forall i, f i = nth i late false) ->
    existsb f (seq 0 (length late)) = existsb (fun b : bool => b) late.
  Proof.
    intros f late H. apply eq_true_iff_eq. rewrite !existsb_exists. split.
    - intros (i & Hi & Hf). apply in_seq in Hi. rewrite H in Hf. exists true. split; auto. rewrite <- Hf.
      apply nth_In. lia.
    - intros (b & Hb & ->). apply In_nth with (d := false) in Hb. destruct Hb as (i & Hi & E). exists i.
      split; [apply in_seq; lia | now rewrite H].
  Qed.

  Lemma done_stays : forall c now, restless c = false -> done c now (stays (is_in c)) = c.
  Proof. intros [q d r] now H. simpl in H. subst r. reflexivity. Qed.

  Lemma takes_way : forall k c x late w y, nth_error (stances P) (is_in c) = Some x ->
    (forall i, past_due c (t k) i = nth i late false) ->
    existsb (past_due c (t k)) (seq 0 (length (first_due P))) = existsb (fun b => b) late ->
    way_to_go (occasion_at t k) x (restless c) late = Some w ->
    match w with Some w => ends P (answers_with (e k) late) w y | None => y = stays (is_in c) end ->
    takes P s t k c (done c (t k) y).
  Proof.
    intros k c x late w y Hx HL HE Hw HY. exists x. split; auto.
    assert (HS : forall w, ends P (answers_with (e k) late) w y -> reacts P c (t k) (s k) w (done c (t k) y)).
    { intros w' H. exists y. split; auto. apply (ends_same P _ _ _ _) with (2 := H). intros b Hb.
      destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (_ & HF & _).
      unfold asks_for_nothing_decided in HF. rewrite forallb_forall in HF. specialize (HF b Hb).
      unfold answers_at, answers_with. destruct (asked b) as [a|i]; auto. symmetry. apply letters_read.
      now apply negb_true_iff. }
    unfold occasion_at in Hw. unfold is_step. destruct k as [|j]; simpl in Hw.
    - injection Hw as <-. auto.
    - destruct (t (S j) =? t j); simpl in Hw; [injection Hw as <-; auto|].
      unfold has_come. rewrite HE. destruct (restless c || existsb (fun b => b) late) eqn:EC.
      + destruct (at_clock_step x) as [w'|]; [|discriminate]. injection Hw as <-. exists w'. auto.
      + injection Hw as <-. subst y. apply done_stays. now apply orb_false_iff in EC.
  Qed.

  (** Before instant n the two are in a pair. *)
  Definition in_pair (n : nat) (c : config) (p : pair) : Prop :=
    In p pairs /\ is_in c = in_program p /\ reaches M e n (in_monitor p) /\ restless c = looks_again p /\
    if permanent M (in_monitor p) then forall i, due c i = None
    else stand p = states_at n /\ (exists k, n = S k /\ at_letter (last_letter p) (e k) = true) /\
         forall i, due c i = due_of n i.

  Lemma meets_true : forall y r p, meets y r p = true ->
    in_program p = goes_to y /\ in_monitor p = r /\ looks_again p = again y.
  Proof.
    intros y r p H. unfold meets in H. rewrite !andb_true_iff in H. destruct H as [[H1 H2] H3].
    apply Nat.eqb_eq in H1, H2. apply eqb_prop in H3. auto.
  Qed.

  Lemma as_many_dues : length (first_due P) = length clocks.
  Proof.
    destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (-> & _). unfold first_dues. now rewrite map_length.
  Qed.

  Lemma landed_in_pair : forall k c y r,
    landed P M pairs (occasion_at t k) (rows_at k) (cases_of k) (e k) y r -> (forall i, due c i = due_of k i) ->
    reaches M e (S k) r -> exists p, in_pair (S k) (done c (t k) y) p.
  Proof.
    intros k c y r (HR & HB & p & Hp & Hm & Hs & Hl) HD Hr. exists p. destruct (meets_true _ _ _ Hm) as (M1 & M2 & M3).
    split; auto. split; [now rewrite M1|]. rewrite M2. split; auto. split; [now rewrite M3|].
    assert (HN : forall i, nth_error clocks i = None -> due (done c (t k) y) i = None).
    { intros i E. rewrite done_due, (not_set y i (length (first_due P))), HD; auto.
      - unfold due_of. now rewrite E.
      - rewrite as_many_dues. now apply nth_error_None. }
    assert (HI : forall i x, nth_error clocks i = Some x ->
        (if permanent M r then is_off else is_due_right (occasion_at t k))
          (x, before_instant e t began x k, the_case e t began x k) (setting_of i y) = true).
    { intros i x E. apply (are_due_right_nth _ y (rows_at k) 0 HR i). rewrite rows_are.
      exact (map_nth_error (fun x => (x, before_instant e t began x k, the_case e t began x k)) i clocks E). }
    destruct (permanent M r) eqn:EP.
    - intros i. destruct (nth_error clocks i) as [x|] eqn:E; [|now apply HN].
      rewrite done_due, HD. unfold due_of. rewrite E. now apply off_after, HI.
    - split; [destruct Hs as [Hs|Hs]; [discriminate | now rewrite Hs, next_states]|]. split; [eauto|].
      intros i. unfold due_of at 1. destruct (nth_error clocks i) as [x|] eqn:E; [|now apply HN].
      rewrite done_due, HD. unfold due_of. rewrite E. apply (due_after e t began Ht dense); auto.
      apply clock_well_formed. now apply nth_error_In in E.
  Qed.

  (** One instant after another. *)
  Lemma from_trackers : forall k c x r tr looks, nth_error (stances P) (is_in c) = Some x -> restless c = looks ->
    (forall i, due c i = due_of k i) -> reaches M e k r -> nth_error (edges M) r = Some tr ->
    moves_on xs P M pairs (occasion_at t k) (is_in c) x tr (states_at k) looks (e k) ->
    exists c' p, takes P s t k c c' /\ in_pair (S k) c' p.
  Proof.
    intros k c x r tr looks Hx HR HD Hr Ht' HM. destruct (moves_at k _ _ _ _ HM) as (w & Hw & y & r' & H1 & H2 & H3).
    assert (HL : forall i, past_due c (t k) i = nth i (late_at k) false).
    { intros i. unfold past_due, late_at. rewrite HD. unfold due_of. revert i. generalize clocks as l.
      induction l as [|z l IH]; intros [|i]; simpl; auto. }
    assert (HE : existsb (past_due c (t k)) (seq 0 (length (first_due P))) = existsb (fun b => b) (late_at k)).
    { rewrite <- (existsb_nth _ _ HL). rewrite as_many_dues. unfold late_at. now rewrite map_length. }
    destruct (landed_in_pair k c y r' H3 HD) as (p & Hp); [econstructor; eauto|].
    exists (done c (t k) y), p. split; auto. rewrite <- HR in Hw. eapply takes_way; eauto.
  Qed.

  Lemma from_pair : forall n c p, n < N -> in_pair n c p -> exists c' p', takes P s t n c c' /\ in_pair (S n) c' p'.
  Proof.
    intros n c p HN (Hp & Hq & Hr & HL & H). destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (_ & _ & _ & HP).
    destruct (HP p Hp) as (x & v & tr & Hx & Hv & Htr & _ & HM). rewrite <- Hq in Hx.
    destruct (permanent M (in_monitor p)) eqn:EP.
    - destruct HM as [HQ HM]. destruct (HM (e n) (allowed_letters n HN)) as [HS HI].
      assert (HG : exists w, way_to_go (occasion_at t n) x (restless c) [] = Some w /\
                leads_to P M [] w (in_program p) tr (e n) (landed_for_good M pairs)).
      { rewrite HL, HQ. destruct (occasion_at t n); [exists (Some (at_step x)) | exists (Some (at_step x)) | exists None]; auto. }
      destruct HG as (w & Hw & y & r & H1 & H2 & HF & (p' & Hp' & Hm) & HZ).
      destruct (meets_true _ _ _ Hm) as (M1 & M2 & M3).
      assert (HD : forall i, past_due c (t n) i = nth i [] false) by (intros i; unfold past_due; rewrite H; now destruct i).
      exists (done c (t n) y), p'. split.
      + rewrite <- Hq in H1. eapply takes_way; eauto.
        assert (HE : forall l, existsb (past_due c (t n)) l = false); [|apply HE].
        induction l as [|i l IH]; simpl; auto. unfold past_due at 1. now rewrite H.
      + split; auto. split; [now rewrite M1|]. rewrite M2, HF. split; [econstructor; eauto|]. split; [now rewrite M3|].
        intros i. unfold done. simpl. destruct (find _ (settings y)) as [z|] eqn:Ez; [|apply H].
        apply find_some in Ez. specialize (HZ z (proj1 Ez)). unfold set_due.
        destruct (to_be_due z) as [[[| |] d]|]; try destruct HZ; auto. now rewrite H.
    - destruct H as (Hst & (k & -> & Hl) & HD). destruct HM as [HS HW].
      apply (from_trackers (S k) c x (in_monitor p) tr (looks_again p)); auto.
      rewrite Hq, <- Hst. unfold occasion_at. destruct (Nat.eqb_spec (t (S k)) (t k)) as [E|E]; auto.
      pose proof (Ht k (S k) ltac:(lia)). assert (Hlt : t k < t (S k)) by lia.
      destruct (held_letters k Hlt) as (Hn & HX & HY). rewrite Hn in HW. destruct HW as [HA HV]. apply HV; auto.
      simpl. rewrite (untimed_held news xs e t) by (auto; intros j Hj; apply held_letters, Hj). rewrite Hl. simpl.
      apply all_of_them_true. intros q Hq'. apply in_map_iff in Hq'. destruct Hq' as (a & <- & Ha). simpl. now rewrite HX.
  Qed.

  Lemma first_due_right : permanent M 0 = false -> forall i, due (beginning P began) i = due_of 0 i.
  Proof.
    intros EP i. destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (HF & _). unfold beginning, due_of. simpl.
    rewrite HF. unfold first_dues. rewrite EP. fold clocks. revert i. generalize clocks as l.
    induction l as [|x l IH]; intros [|i]; simpl; auto. unfold due_in, before_instant, counts, initial.
    destruct (about x) as [[]|]; simpl; auto.
  Qed.

  Lemma follows_on : forall n, n <= N -> exists c, runs P s t began n c /\
    ((n = 0 /\ c = beginning P began /\ permanent M 0 = false) \/ exists p, in_pair n c p).
  Proof.
    destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (HF & _ & (x & v & tr & Hx & Hv & Htr & HV & HB) & HP).
    induction n as [|n IH]; intros HN.
    - exists (beginning P began). split; [constructor|]. destruct (permanent M 0) eqn:EP; [right | left; auto].
      destruct HB as (p & Hp & Hm). destruct (meets_true _ _ _ Hm) as (M1 & M2 & M3). exists p.
      split; auto. split; [now rewrite M1|]. rewrite M2, EP. split; [constructor|]. split; [now rewrite M3|].
      intros i. unfold beginning. simpl. rewrite HF. unfold first_dues. rewrite EP. fold clocks. revert i. generalize clocks as l.
      induction l as [|z l IH]; intros [|i]; simpl; auto. now destruct (about z) as [[]|].
    - destruct (IH ltac:(lia)) as (c & Hc & [(-> & -> & EP) | (p & Hp)]).
      + rewrite EP in HB.
        destruct (from_trackers 0 (beginning P began) x 0 tr false Hx eq_refl (first_due_right EP) (reaches_start M e) Htr
                    (HB (e 0) (allowed_letters 0 ltac:(lia)))) as (c' & p' & H1 & H2).
        exists c'. split; eauto. econstructor; eauto.
      + destruct (from_pair n c p ltac:(lia) Hp) as (c' & p' & H1 & H2). exists c'. split; eauto. econstructor; eauto.
  Qed.

  (** Without clocks, nothing happens between steps, whenever they come. *)
  Theorem stays_between_steps : is_trivial news xs = true -> forall n c p, in_pair n c p ->
    forall now, has_come P c now = false.
  Proof.
    intros HT n c p (Hp & _ & _ & HR & _) now. destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (HF & _ & _ & HP).
    destruct (HP p Hp) as (x & v & tr & _ & _ & _ & _ & HM). rewrite HT in HM. unfold has_come.
    assert (HX : xs = []) by (unfold is_trivial in HT; now destruct xs). rewrite HF, HR, HX. simpl.
    destruct (permanent M (in_monitor p)); destruct HM as [H1 H2]; [now rewrite H1 | now rewrite H2].
  Qed.

  (** The program shows the verdict of the monitor. *)
  Theorem followed_sound : forall n, n <= N -> exists r v,
    reaches M e n r /\ nth_error (verdicts M) r = Some v /\ shows_after P s t began n v.
  Proof.
    intros n HN. destruct (accepted_means _ _ _ _ _ _ _ _ accepted) as (_ & _ & (x & v & tr & Hx & Hv & _ & HV & _) & HP).
    destruct (follows_on n HN) as (c & Hc & [(-> & -> & _) | (p & Hp & Hq & Hr & _)]).
    - exists 0, v. split; [constructor|]. split; auto. exists (beginning P began), x. auto.
    - destruct (HP p Hp) as (z & u & tz & Hz & Hu & _ & HU & _). exists (in_monitor p), u. repeat split; auto.
      exists c, z. rewrite Hq. auto.
  Qed.
End Run.
