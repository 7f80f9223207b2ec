(** What happens to a node is a run of its guard: commands, other messages and nanoseconds at their times, and what it sends
    ([node_is_guarded]). So of all properties at once, what leaves the node violates none, as long as what it relies on holds
    and it was never late ([nothing_is_violated]). *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Encodings Trackers Resets Monitor Machines Conditions Judgements Moves Certificate Infinite InTime
  Diagrams Guard GuardedPlaces GuardCheck GuardInTime.

(** A nanosecond passes; a message is heard, or a command let through, on a topic; a fallback is sent. *)
Inductive deed := Waited | Took (topic : nat) | Sent (f : nat).

Section Node.
  Variable S : setting.
  Variable first : option (list nat).

  Definition event_of (d : deed) : option nat :=
    match d with Waited => None | Took topic => Some topic | Sent f => Some (topic_of S f) end.
  Definition effect_of (d : deed) : nat -> source :=
    match d with Waited => hold S | Took topic => heard S topic | Sent f => sent S f end.

  (** What it has done, where it was before and after each deed, and when. *)
  Variables (did : nat -> deed) (x : nat -> state_of) (clock : nat -> nat).
  (** What each property is about: a run of letters and times of its own. *)
  Variables (began : nat -> nat) (s : nat -> stream) (t : nat -> times).

  Definition step_taken (n : nat) (P : part) (k : nat) : bool :=
    takes_step S P (where_is n (x k)) (where_is n (x (1 + k))) (event (snd (x (1 + k)))).
  Definition count (n : nat) (P : part) (k : nat) : nat := length (has_read S n P x k).

  Section One.
    Variables (n : nat) (P : part).
    Let C := certified_by P.
    Definition own_word : stream := word_of C (began n) (s n) (t n).
    Definition clocks_at (r : nat) : clocks :=
      if is_trivial (news C) (trackers C) then start (trackers C)
      else path (news C) (trackers C) own_word (t n) (began n) r.

    (** A property takes its steps when it hears something, with the letters of its run, at their times; and where it is,
        is where its monitor and its clocks are after them. *)
    Record is_followed (m : nat) : Prop := {
      in_game : watched P = trackers C /\ encoded_by C = Episode /\ exists depth work, check depth work C = true;
      its_run : is_run C (began n) (s n, t n);
      its_letters : forall k, k < m -> step_taken n P k = true ->
        (forall a, own (snd (x (1 + k))) n a = own_word (count n P k) a) /\
        (forall a, match role_of P a with
                   | Plain c => own_word (count n P k) a = values (snd (x (1 + k))) c
                   | NewsOf ts => own_word (count n P k) a = is_news (event (snd (x (1 + k)))) ts
                   | Own => True
                   end) /\
        t n (count n P k) = clock (1 + k);
      begins_in_time : forall k, k < m -> where_is n (x k) = Waits ->
        In (step_taken n P k) (beginnings S P (event (snd (x (1 + k)))) (phase_of (x (1 + k))));
      stands : forall k, k <= m -> match count n P k with
        | 0 => where_is n (x k) = Waits
        | r => exists q v, reaches (machine C) own_word r q /\ nth_error (verdicts (machine C)) q = Some v /\
                 where_is n (x k) = judged v q (clocks_at r)
        end
    }.
  End One.

  (** What happens to a node, m deeds long, as long as what it relies on holds. *)
  Record happens (m : nat) : Prop := {
    at_first : beginning S first (x 0);
    possible : forall k, k <= m -> allowed S (snd (x k));
    all_are_there : forall k, k <= m -> length (wheres (x k)) = length (parts S);
    each_event : forall k, k < m -> event (snd (x (1 + k))) = event_of (did k);
    each_topic : forall k, k < m -> match did k with
      | Waited => True
      | Took topic => topic < topics S
      | Sent f => topic_of S f < owned S
      end;
    each_time : forall k, k < m -> clock (1 + k) = match did k with Waited => 1 + clock k | _ => clock k end;
    each_effect : forall k, k < m -> does (effect_of (did k)) (values (snd (x k))) (values (snd (x (1 + k))));
    each_phase : forall k, k < m -> In (phase_of (x (1 + k))) (phases_after S (event_of (did k)) (phase_of (x k)));
    each_property : forall n P, nth_error (parts S) n = Some P -> is_followed n P m;
    assumptions_hold : forall n P k, nth_error (parts S) n = Some P -> k < m -> is_kept P = false ->
      is_own S (event_of (did k)) = false -> where_is n (x (1 + k)) <> Lost
  }.

  (** The node lets pass, or sends, only that after which it may rest; if what else comes is such that it may not, it sends a
      fallback at once after which it may: it is never late. *)
  Inductive keeps_to (R : region state_of nat some_clocks) : nat -> Prop :=
  | at_the_beginning : keeps_to R 0
  | stays_silent k : keeps_to R k -> rests R (x (1 + k)) -> keeps_to R (1 + k)
  | answers_at_once k f : keeps_to R k -> is_own S (event_of (did k)) = false -> did (1 + k) = Sent f ->
      rests R (x (2 + k)) -> keeps_to R (2 + k).

  Section Property.
    Variables (n : nat) (P : part) (m : nat).
    Hypothesis HP : nth_error (parts S) n = Some P.
    Hypothesis HH : happens m.
    Let C := certified_by P.
    Let M := machine C.
    Let w := own_word n P.
    Let HF : is_followed n P m := each_property m HH n P HP.

    Lemma letters_possible : forall k, at_letter (assumption C) (w k) = true.
    Proof. apply (its_run n P m HF). Qed.

    (** Its clocks go on as those of the game. *)
    Lemma clocks_go_on : forall r, exists cs,
      clocks_step (news C) (trackers C) (takes_time (t n) r) (clocks_at n P r) (w r) (clocks_at n P (1 + r)) cs.
    Proof.
      intros r. unfold clocks_at. fold C. destruct (is_trivial (news C) (trackers C)) eqn:E.
      - exists []. unfold clocks_step. now rewrite E.
      - destruct (in_game n P m HF) as (_ & HE & depth & work & HC). fold C in HE, HC.
        pose proof (proj1 (its_run n P m HF)) as HO. simpl in HO. fold C in HO.
        pose proof (is_proper depth work C HC) as HD.
        pose proof (proper_trackers _ _ _ HD E) as HX. pose proof (proper_atoms _ _ _ HD) as HN.
        eexists. apply moves_in_time; try apply HO; try apply HX; auto.
        + intros y Hy. now apply (trackers_well_formed _ _ _ _ HX HN).
        + now apply (word_held _ _ _ _ HX HN).
    Qed.

    (** After every number of steps its monitor is somewhere, with a verdict; and a permanent one stays. *)
    Lemma is_somewhere : forall r, exists q v, reaches M w r q /\ nth_error (verdicts M) q = Some v.
    Proof.
      intros r. destruct (in_game n P m HF) as (_ & _ & depth & work & HC). fold C in HC.
      destruct (check_finite depth work C HC w (clocks_at n P) r) as (q & v & H1 & H2 & _); eauto.
      split; [unfold clocks_at; fold C; now destruct (is_trivial _ _)|]. intros k _. split; [apply letters_possible|].
      destruct (clocks_go_on k) as (cs & H). exact (clocks_step_moves _ _ _ _ _ _ _ H).
    Qed.
    Lemma next_verdict : forall r q v q' v', reaches M w r q -> nth_error (verdicts M) q = Some v ->
      reaches M w (1 + r) q' -> nth_error (verdicts M) q' = Some v' -> v = Violated \/ v = Satisfied -> v' = v.
    Proof.
      intros r q v q' v' HQ HV HQ' HV' H. destruct (in_game n P m HF) as (_ & _ & depth & work & HC). fold C in HC.
      destruct (accepted depth work C HC) as (_ & HA & _). destruct (HA q v HV) as (u & g & V1 & V2 & V3).
      fold M in V1, V2, V3. rewrite HV in V1. injection V1 as <-.
      assert (E : exists p, g = State p /\ nth_error (verdicts M) p = Some v) by (destruct H; subst v; exact V3).
      destruct E as (p & -> & EP). assert (HR : reaches M w (1 + r) p) by (econstructor; eauto; constructor).
      rewrite (reaches_unique M _ _ _ _ HQ' HR) in HV'. congruence.
    Qed.

    Lemma count_next : forall k, count n P (1 + k) = count n P k + if step_taken n P k then 1 else 0.
    Proof. intros k. unfold count, step_taken. simpl. rewrite app_length. now destruct (takes_step _ _ _ _ _). Qed.

    Lemma waits_before : forall k, k <= m -> count n P k = 0 -> where_is n (x k) = Waits.
    Proof. intros k Hk H. pose proof (stands n P m HF k Hk) as HS. now rewrite H in HS. Qed.
    Lemma stands_after : forall k r, k <= m -> count n P k = 1 + r -> exists q v,
      reaches M w (1 + r) q /\ nth_error (verdicts M) q = Some v /\ where_is n (x k) = judged v q (clocks_at n P (1 + r)).
    Proof. intros k r Hk H. pose proof (stands n P m HF k Hk) as HS. now rewrite H in HS. Qed.
    Lemma judged_runs : forall v q c, judged v q c <> Waits.
    Proof. now intros [] q c. Qed.

    Lemma letters_read : forall j, j <= m -> forall k a, k < length (has_read S n P x j) ->
      at_step (has_read S n P x j) k a = w k a.
    Proof.
      induction j as [|j IH]; intros Hj k a Hk; [simpl in Hk; lia|]. simpl in Hk |- *. unfold at_step in *.
      change (takes_step S P (where_is n (x j)) (where_is n (x (Datatypes.S j))) (event (snd (x (Datatypes.S j)))))
        with (step_taken n P j) in *.
      destruct (step_taken n P j) eqn:E; [|rewrite app_nil_r in *; apply IH; lia]. rewrite app_length in Hk. simpl in Hk.
      destruct (Nat.eq_dec k (length (has_read S n P x j))) as [->|HN].
      - rewrite nth_middle. now apply (its_letters n P m HF j Hj E).
      - rewrite app_nth1 by lia. apply IH; lia.
    Qed.

    (** What it has read last is as of now: it hears every nanosecond. *)
    Lemma read_until_now : forall k r, k <= m -> count n P k = 1 + r -> t n r = clock k.
    Proof.
      induction k as [|k IH]; intros r Hk Hr; [discriminate|]. change (Datatypes.S k) with (1 + k) in *.
      rewrite count_next in Hr.
      destruct (step_taken n P k) eqn:E.
      - destruct (its_letters n P m HF k Hk E) as (_ & _ & HT). now replace r with (count n P k) by lia.
      - rewrite (IH r) by lia. destruct (stands_after k r ltac:(lia) ltac:(lia)) as (q & v & _ & _ & HW).
        unfold step_taken in E. rewrite (each_event m HH k Hk) in E. rewrite (each_time m HH k Hk).
        destruct (did k); auto. exfalso. rewrite HW in E. destruct v; discriminate.
    Qed.
    Lemma time_is_taken : forall k, k < m -> step_taken n P k = true ->
      takes_time (t n) (count n P k) = in_time (snd (x (1 + k))).
    Proof.
      intros k Hk E. unfold in_time. rewrite (each_event m HH k Hk). destruct (count n P k) as [|r] eqn:EC.
      - pose proof (begins_in_time n P m HF k Hk (waits_before k ltac:(lia) EC)) as HB.
        rewrite E, (each_event m HH k Hk) in HB. simpl. destruct (did k); auto. destruct HB as [HB|[]]; discriminate.
      - simpl. rewrite (read_until_now k r ltac:(lia) EC).
        destruct (its_letters n P m HF k Hk E) as (_ & _ & HT). rewrite EC in HT. rewrite HT, (each_time m HH k Hk).
        destruct (did k); simpl; [apply Nat.ltb_lt | apply Nat.ltb_ge | apply Nat.ltb_ge]; lia.
    Qed.

    Lemma takes_its_step : forall k q, k < m -> step_taken n P k = true -> reaches M w (count n P k) q ->
      exists d e, moved n P (snd (x (1 + k))) q (clocks_at n P (count n P k)) (where_is n (x (1 + k))) d e.
    Proof.
      intros k q Hk E HQ. destruct (its_letters n P m HF k Hk E) as (HL & HR & _).
      destruct (clocks_go_on (count n P k)) as (cs & HC).
      assert (EC : count n P (1 + k) = 1 + count n P k) by (rewrite count_next, E; lia).
      destruct (stands_after (1 + k) (count n P k) Hk EC) as (q' & v & HQ' & HV & HW).
      inversion HQ' as [|? q0 g ? HQ0 HE' HG]; subst. rewrite (reaches_unique M _ _ _ _ HQ0 HQ) in HE'.
      eexists _, _. split.
      - split.
        + rewrite <- (letters_possible (count n P k)). now apply at_letter_same.
        + intros a. specialize (HR a). rewrite HL. exact HR.
      - exists g, q', v, (clocks_at n P (1 + count n P k)), cs. split; [exact HE'|]. split.
        + now apply (leads_same M (w (count n P k))).
        + split; [exact HV|]. destruct (in_game n P m HF) as (-> & _). fold C. split; auto.
          rewrite <- (time_is_taken k Hk E). revert HC. unfold clocks_step. destruct (is_trivial _ _); auto.
          intros (g' & H1 & H2 & H3 & H4). exists g'. split; auto. split.
          * rewrite <- H2. now apply at_letter_same.
          * split; auto. rewrite (at_letter_same _ _ (w (count n P k))) by auto. exact H4.
    Qed.

    Lemma part_goes_on : forall k, k < m -> exists d e,
      part_step S n P (snd (x (1 + k))) (phase_of (x (1 + k))) (where_is n (x k)) (where_is n (x (1 + k))) d e.
    Proof.
      intros k Hk. pose proof (count_next k) as HN. destruct (count n P k) as [|r] eqn:EC.
      - pose proof (waits_before k ltac:(lia) EC) as HW. pose proof (begins_in_time n P m HF k Hk HW) as HB.
        rewrite HW. unfold part_step. destruct (step_taken n P k) eqn:E.
        + destruct (takes_its_step k 0 Hk E) as (d & e & H); [rewrite EC; constructor|]. exists d, e, true. split; auto.
          rewrite EC in H. destruct (in_game n P m HF) as (-> & _). fold C. revert H. unfold clocks_at. fold C.
          now destruct (is_trivial _ _).
        + exists [], [], false. split; auto. pose proof (waits_before (1 + k) Hk HN) as HW'. now rewrite HW'.
      - destruct (stands_after k r ltac:(lia) EC) as (q & v & HQ & HV & HW).
        assert (HS : exists r' q' v', count n P (1 + k) = 1 + r' /\ reaches M w (1 + r') q' /\
                  nth_error (verdicts M) q' = Some v' /\ where_is n (x (1 + k)) = judged v' q' (clocks_at n P (1 + r')) /\
                  (v = Violated \/ v = Satisfied -> v' = v)).
        { destruct (step_taken n P k).
          - destruct (stands_after (1 + k) (1 + r) Hk ltac:(lia)) as (q' & v' & HQ' & HV' & HW').
            exists (1 + r), q', v'. repeat split; auto; [lia|]. exact (next_verdict _ _ _ _ _ HQ HV HQ' HV').
          - destruct (stands_after (1 + k) r Hk ltac:(lia)) as (q' & v' & HQ' & HV' & HW').
            exists r, q', v'. repeat split; auto; [lia|]. intros _.
            rewrite (reaches_unique M _ _ _ _ HQ' HQ) in HV'. congruence. }
        destruct HS as (r' & q' & v' & ER & HQ' & HV' & HW' & HK).
        assert (HA : forall c, where_is n (x k) = At q c -> c = clocks_at n P (1 + r) -> exists d e,
                  part_step S n P (snd (x (1 + k))) (phase_of (x (1 + k))) (At q c) (where_is n (x (1 + k))) d e).
        { intros c HAt ->. unfold part_step. destruct (hears S P (event (snd (x (1 + k))))) eqn:EH.
          - assert (E : step_taken n P k = true) by (unfold step_taken; rewrite HAt; exact EH).
            destruct (takes_its_step k q Hk E) as (d & e & H); [now rewrite EC|]. rewrite EC in H. eauto.
          - assert (E : step_taken n P k = false) by (unfold step_taken; rewrite HAt; exact EH).
            rewrite E in HN. assert (r' = r) by lia. subst r'. rewrite (reaches_unique M _ _ _ _ HQ' HQ) in HV', HW'.
            rewrite HV in HV'. injection HV' as <-. eexists _, _. split; [congruence|]. split; reflexivity. }
        destruct v; rewrite HW; unfold judged;
          [ | apply (HA _ HW); reflexivity | apply (HA _ HW); reflexivity | ];
          rewrite HW', HK by auto; unfold part_step, judged, stays; eauto.
    Qed.
  End Property.

  (** ** All of them *)
  Lemma parts_go_on : forall i c Ps n ws ws',
    length ws = length Ps -> length ws' = length Ps ->
    (forall j P, nth_error Ps j = Some P ->
       (exists d e, part_step S (n + j) P i c (nth j ws Waits) (nth j ws' Waits) d e) /\
       (is_own S (event i) || is_kept P = true \/ nth j ws' Waits <> Lost)) ->
    exists d e, parts_step S i c n Ps ws ws' d e.
  Proof.
    intros i c Ps. induction Ps as [|P Ps IH]; intros n [|w ws] [|w' ws'] H1 H2 H; try discriminate.
    - exists [], []. constructor.
    - destruct (H 0 P eq_refl) as ((d & e & HS) & HK). rewrite Nat.add_0_r in HS.
      destruct (IH (1 + n) ws ws') as (ds & es & HD); [simpl in *; lia | simpl in *; lia| |].
      + intros j Q HQ. replace (1 + n + j) with (n + Datatypes.S j) by lia. exact (H (Datatypes.S j) Q HQ).
      + exists (d ++ ds), (e ++ es). now constructor.
  Qed.

  Lemma leads_everywhere : forall m, happens m -> forall k, k < m -> exists d e,
    leads_on S (event_of (did k)) (effect_of (did k)) (x k) (x (1 + k)) d e.
  Proof.
    intros m HH k Hk.
    destruct (parts_go_on (snd (x (1 + k))) (phase_of (x (1 + k))) (parts S) 0 (wheres (x k)) (wheres (x (1 + k))))
      as (d & e & H).
    - apply (all_are_there m HH). lia.
    - now apply (all_are_there m HH).
    - intros j P HP. split; [exact (part_goes_on j P m HP HH k Hk)|]. rewrite (each_event m HH k Hk).
      destruct (is_own S (event_of (did k))) eqn:EO; auto. destruct (is_kept P) eqn:EK; auto.
      right. exact (assumptions_hold m HH j P k HP Hk EK EO).
    - exists d, e. split; [now apply (each_event m HH)|]. split; [apply (possible m HH); lia|].
      split; [now apply (possible m HH)|]. split; [now apply (each_effect m HH)|]. split; auto. now apply (each_phase m HH).
  Qed.

  Theorem node_is_guarded : forall R m, happens m -> keeps_to R m -> is_guarded S first R x m.
  Proof.
    intros R m HH HK.
    assert (HC : forall k, k < m -> is_own S (event_of (did k)) = false ->
              comes state_of some_clocks (message S) (passes S) (x k) (x (1 + k))).
    { intros k Hk HO. destruct (leads_everywhere m HH k Hk) as (d & e & H). pose proof (each_topic m HH k Hk) as HT.
      unfold comes, message, passes. destruct (did k) as [|topic|f]; simpl in *; [right; eauto | left | ].
      - apply Nat.ltb_ge in HO. exists topic, d, e. auto.
      - apply Nat.ltb_ge in HO. lia. }
    assert (HS : forall k, k < m -> steps_by S (x k) (x (1 + k))).
    { intros k Hk. destruct (is_own S (event_of (did k))) eqn:EO; [|left; auto]. right.
      destruct (leads_everywhere m HH k Hk) as (d & e & H). unfold command, sends.
      destruct (did k) as [|topic|f]; simpl in *; [discriminate | left | right; eauto].
      apply Nat.ltb_lt in EO. exists topic, d, e. auto. }
    assert (HG : forall j, keeps_to R j -> j <= m -> is_guarded S first R x j).
    { intros j HJ. induction HJ as [|k HJ IH HR|k f HJ IH HO HD HR]; intros Hj.
      - constructor. apply (at_first m HH).
      - apply goes_by; [apply IH; lia | apply HS; lia | exact HR].
      - destruct (leads_everywhere m HH (1 + k) ltac:(lia)) as (d & e & H). rewrite HD in H.
        apply (is_answered _ _ _ _ _ _ _ _ _ x k f e); [apply IH; lia | apply HC; auto; lia | exists d; exact H | exact HR]. }
    now apply HG.
  Qed.

  (** An accepted region is enough for all properties at once: after each deed, the verdict on what each has read is right
      for the property as the language defines it, and it is not 'violated'. *)
  Theorem nothing_is_violated : forall spots m, first = first_phase spots -> check_guard S spots = true ->
    happens m -> keeps_to (region_of spots) m ->
    forall n P, nth_error (parts S) n = Some P -> forall j, j <= m -> has_read S n P x j <> [] ->
    let C := certified_by P in
    exists v, v <> Violated /\
      right_verdict (goes_on C (began n) (s n, t n) (count n P j)) (meets_up_to C (began n) None)
        (meets_up_to C (began n) (Some (count n P j)) (s n, t n)) v.
  Proof.
    intros spots m HE HG HH HK n P HP j Hj HN C. pose proof (each_property m HH n P HP) as HF.
    pose proof (letters_read n P m HP HH j Hj) as HL. pose proof (node_is_guarded _ m HH HK) as HX.
    pose proof (check_guard_sound S spots HG) as HS. rewrite <- HE in HS.
    pose proof (its_run n P m HF) as HR. destruct (in_game n P m HF) as (HW & HC' & depth & work & HC).
    destruct P as [C' xs rs h kept]. simpl in *. subst xs.
    refine (guarded_in_time S n C' rs h kept depth work first _ HP HC HC' HS x m HX j Hj HN
      (began n) (s n) (t n) (fun k => k) HR _ HL).
    split; auto; try (intros; lia). intros i k H a. now replace k with i by lia.
  Qed.
End Node.
