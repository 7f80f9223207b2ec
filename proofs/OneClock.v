(** With one clock, the machine knows all: each of its fair words is a run in time ([words_are_runs]). So what a
    certificate shows to be open over the words of the machine is open in time. Of several clocks the machine does
    not know in which order they pass their bounds: it has every run as a word ([Resets.v]), and maybe more words
    than those. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers Resets Times.

(** * What a word tells of the trackers *)

(** One case for each, all allowed by the letter. *)
Fixpoint chosen (ys : list tracker_of) (sts : list state) (env : known) (first : bool) (l : letter) (cs : list case)
  : Prop :=
  match ys, sts, cs with
  | y :: ys, st :: sts, c :: cs =>
      In c (cases y st (surroundings env first y)) /\ at_letter (guard c) l = true /\
        at_letter (atoms_as y c) l = true /\
      chosen ys sts (learn env y c) first l cs
  | [], [], [] => True
  | _, _, _ => False
  end.

Lemma together_chosen : forall ys sts env first p cs l, length sts = length ys ->
  In (p, cs) (together ys sts env first) -> at_letter p l = true -> chosen ys sts env first l cs.
Proof.
  induction ys as [|y ys IH]; intros [|st sts] env first p cs l HL HI HP; simpl in HL; try discriminate; simpl in HI.
  - destruct HI as [E|[]]. injection E as <- <-. exact I.
  - apply in_flat_map in HI. destruct HI as (c & Hc & HI). apply in_map_iff in HI. destruct HI as ((q & ds) & E & HI).
    injection E as <- <-. simpl in HP. apply andb_true_iff in HP. destruct HP as [HP HQ]. apply andb_true_iff in HP.
    destruct HP as [H1 H2]. simpl. repeat split; auto. eapply IH; eauto.
Qed.

Lemma moves_chosen : forall news xs k l k' m, is_trivial news xs = false -> length (states k) = length xs ->
  moves_by news xs k l k' m -> exists cs, chosen xs (states k) (fun _ => closed) (is_first k) l cs /\
    is_first k' = false /\ states k' = map next cs /\ exists b, fair m = marks xs cs ++ [b].
Proof.
  intros news xs k l k' m HT HL (H1 & H2 & H3). unfold moves in H1. rewrite HT in H1. apply in_flat_map in H1.
  destruct H1 as ((p & cs) & HI & HM). exists cs. apply in_app_iff in HM.
  assert (HP : at_letter p l = true /\ is_first k' = false /\ states k' = map next cs /\
                 exists b, fair m = marks xs cs ++ [b]).
  { destruct HM as [HM|HM]; (destruct (existsb _ _) in HM; [destruct HM|]);
      destruct HM as [<-|[]]; simpl in H2, H3; apply andb_true_iff in H2; subst k'; simpl; repeat split; auto;
      try tauto; eauto. }
  destruct HP as (A & B). split; auto. eapply together_chosen; eauto.
Qed.

Lemma decided_nth : forall x c l i, at_letter (atoms_as x c) l = true -> i < length (decides x) ->
  i < length (holding c) ->
  l (nth i (decides x) 0) = nth i (holding c) false.
Proof.
  intros x c l. unfold atoms_as. generalize (holding c). induction (decides x) as [|a ds IH];
    intros [|b bs] i H Hd Hb; simpl in *; try lia.
  apply andb_true_iff in H. destruct H as [H1 H2]. destruct i as [|i]; [destruct b; simpl in H1; destruct (l a); auto|].
  apply IH; auto; lia.
Qed.

(** ** Scopes, which no clock decides *)

Definition is_scope (x : tracker_of) : Prop := (exists o, about x = Measures (SinceOpening o)) /\ bounds x = [] /\
  decides x = [].

(** Times that stand still are good enough for them. *)
Definition still : times := fun _ => 0.
Lemma still_passing : passing still.
Proof. intros i k _. auto. Qed.
Lemma still_dense : forall k, still (S k) <= S (still k).
Proof. intros k. unfold still. lia. Qed.

Lemma scope_well_formed : forall e x, is_scope x -> well_formed e still 0 x.
Proof.
  intros e x ((o & Ha) & Hb & Hd). unfold well_formed. rewrite Ha, Hb, Hd. simpl. repeat split; auto; [intros; lia|].
  destruct o; auto.
Qed.

Lemma scope_exclusive : forall x st a l c c', is_scope x -> In c (cases x st a) -> In c' (cases x st a) ->
  at_letter (guard c) l = true -> at_letter (guard c') l = true -> c = c'.
Proof.
  intros x st a l c c' ((o & Ha) & Hb & Hd) H1 H2 G1 G2. unfold cases in *. rewrite Ha in *.
  unfold scope_cases, until_cases, running_cases, may_have_passed in *. rewrite Hb in *. simpl length in *.
  assert (HL : snd st <? 0 = false) by (apply Nat.ltb_ge; lia). rewrite HL in *.
  destruct o as [|o p|o p|o p q], a as [[|] [|]], st as [[] n]; simpl in H1, H2;
    repeat match goal with H : _ \/ _ |- _ => destruct H as [H|H] end; try contradiction; subst; auto; simpl in G1, G2;
    repeat match goal with H : context [at_letter ?p l] |- _ => destruct (at_letter p l) end; simpl in *; congruence.
Qed.

(** * One clock *)
Section OneClock.
  Variables (news : list nat) (scopes : list tracker_of) (z : tracker_of) (cl : clock) (e : stream) (path : nat ->
    clocks).
  Hypothesis are_scopes : forall x, In x scopes -> is_scope x.
  Hypothesis is_clock : about z = Measures cl.
  Hypothesis z_atoms : length (decides z) = length (bounds z).
  Hypothesis z_rising : rising (bounds z).
  Hypothesis z_bounds : bounds z <> [].
  Hypothesis z_not_until : match cl with SinceOpening (BeforeEvent _ _) => False | _ => True end.
  Let xs := scopes ++ [z].
  Hypothesis all_placed : placed [] xs.
  Hypothesis is_word : word news xs e path.

  Lemma scopes_chosen : forall ys known env k first stz cs, (forall y, In y ys -> is_scope y) ->
    placed known (ys ++ [z]) ->
    (forall o, In o known -> env o = open_at e o k) -> first = (k =? 0) ->
    chosen (ys ++ [z]) (map (fun y => before_instant e still 0 y k) ys ++ [stz]) env first (e k) cs ->
    exists c ds, cs = ds ++ [c] /\ map next ds = map (fun y => after e still 0 y k) ys /\ length ds = length ys /\
      In c (cases z stz (around e (about z) k)) /\ at_letter (guard c) (e k) = true /\
        at_letter (atoms_as z c) (e k) = true.
  Proof.
    assert (HA : forall y known env k first, (match outer (about y) with None => True | Some o => In o known end) ->
              (forall o, In o known -> env o = open_at e o k) -> first = (k =? 0) ->
                surroundings env first y = around e (about y) k).
    { intros y known env k first H HE ->. unfold surroundings, around. destruct (outer (about y)); auto. }
    induction ys as [|y ys IH]; intros known env k first stz [|c cs] HS HP HE HF HC; simpl in HC; try tauto.
    - destruct HC as (H1 & H2 & H3 & H4). destruct cs; [|destruct H4]. exists c, []. repeat split; auto.
      rewrite <- (HA z known env k first); auto. apply HP.
    - destruct HP as [P1 P2]. destruct HC as (H1 & H2 & H3 & H4). rewrite (HA y known env k first) in H1 by auto.
      destruct (tracker_follows e still 0 still_passing still_dense y k (scope_well_formed e y (HS y (or_introl
        eq_refl))))
        as (c' & Hc' & Hf). pose proof Hf as (G & _ & HN & HO & _).
      assert (c = c') by (eapply scope_exclusive; eauto; apply HS; simpl; auto). subst c'.
      destruct (IH _ (learn env y c) k first stz cs (fun x Hx => HS x (or_intror Hx)) P2) as (d & ds & ->
        & E1 & E2 & E3); auto.
      + intros o Ho. unfold learn. destruct (HS y (or_introl eq_refl)) as ((o' & Hy) & _). rewrite Hy in *.
        destruct (scope_eq_dec o o') as [->|Hne]; auto. apply HE. destruct Ho; congruence.
      + exists d, (c :: ds). simpl. rewrite HN, E1, E2. auto.
  Qed.

  Lemma not_trivial : is_trivial news xs = false.
  Proof. unfold xs. destruct scopes; reflexivity. Qed.

  Definition at_z (k : nat) (st : state) : Prop :=
    is_first (path k) = (k =? 0) /\
    states (path k) = map (fun y => before_instant e still 0 y k) scopes ++ [st].

  Lemma marks_one : forall ys ds c, (forall y, In y ys -> is_scope y) -> length ds = length ys ->
    marks (ys ++ [z]) (ds ++ [c]) = [goes_on z c].
  Proof.
    induction ys as [|y ys IH]; intros [|d ds] c HS HL; simpl in HL; try discriminate.
    - simpl. unfold has_bounds. destruct (bounds z); [congruence | reflexivity].
    - simpl. unfold has_bounds at 1. destruct (HS y (or_introl eq_refl)) as (_ & -> & _). apply IH; auto.
    intros y' Hy. apply HS. simpl. auto.
  Qed.

  Lemma z_step : forall k st m, at_z k st -> moves_by news xs (path k) (e k) (path (S k)) m ->
    exists c, at_z (S k) (next c) /\ In c (cases z st (around e (about z) k)) /\
    at_letter (guard c) (e k) = true /\ at_letter (atoms_as z c) (e k) = true /\ nth 0 (fair m) false = goes_on z c.
  Proof.
    intros k st m [HF HK] Hm.
    assert (HL : length (states (path k)) = length xs) by (rewrite HK; unfold xs; simpl;
      now rewrite !app_length, map_length).
    destruct (moves_chosen news xs (path k) (e k) (path (S k)) m not_trivial HL Hm) as (cs & HC & HI & HN & (b & Hb)).
    rewrite HK, HF in HC.
    destruct (scopes_chosen scopes [] _ k (k =? 0) st cs are_scopes all_placed (fun o (H : In o []) => match H with
      end) eq_refl HC)
      as (c & ds & -> & E1 & E3 & E2 & E4 & E5). exists c. repeat split; auto.
    - rewrite HN, map_app, E1. reflexivity.
    - rewrite Hb. unfold xs. now rewrite marks_one by auto.
  Qed.

  Lemma z_starts : at_z 0 idle.
  Proof.
    unfold at_z. destruct is_word as (H & _). rewrite H. unfold start, xs. simpl. rewrite map_app. simpl.
    unfold initial at 2. rewrite is_clock. destruct scopes; split; reflexivity.
  Qed.

  Definition z_state (k : nat) : state := last (states (path k)) idle.
  Lemma z_state_is : forall k, at_z k (z_state k).
  Proof.
    assert (H : forall k, exists st, at_z k st).
    { induction k as [|k (st & IH)]; [exists idle; apply z_starts|].
      destruct is_word as (_ & HM & _). destruct (HM k) as (m & Hm). destruct (z_step k st m IH Hm) as (c & Hc & _).
      eauto. }
    intros k. destruct (H k) as (st & Hst). assert (E : z_state k = st); [|now rewrite E].
    unfold z_state. destruct Hst as [_ ->]. apply last_last.
  Qed.

  (** ** The clock itself *)

  Definition z_register (k : nat) : option nat :=
    match cl with
    | SinceOpening o => scope_tracker o e k
    | FirstOpen o p q => register (episode p q e) (scope_tracker o e) k
    | LastTrigger o p => register (trigger p e) (scope_tracker o e) k
    end.
  Let from := counts_from cl e.
  Let most := length (bounds z).

  (** What is so before step k. *)
  Definition before_step (k : nat) (st : state) : Prop :=
    match k with
    | 0 => st = idle
    | S m => match z_register m with None => st = idle | Some j => (exists n, st = (Running, n) /\
      n <= most) \/ st = held end
    end.
  (** What a case tells of step k: n bounds have passed. *)
  Record tells (k : nat) (st : state) (c : case) (n : nat) : Prop := {
    first_hold : holding c = first_of z n;
    not_too_many : n <= most;
    none_yet : from k = None \/ from k = Some k -> n = 0;
    none_back : forall m j i, k = S m -> st = (Running, i) -> from k = Some j -> j <= m -> i <= n;
    then_state : match z_register k with None => next c = idle | Some _ => next c = (Running,
      n) \/ (next c = held /\ n = 0) end;
    held_now : next c = held -> (exists o p, cl = LastTrigger o p) /\ z_register k = Some k;
    if_free : starts c = true \/ is_running z (next c) = false ->
      from k = None \/ from k = Some k \/ n = most \/ z_register k = None
  }.

  Lemma tells_rest : forall k st c, holding c = none_of z -> (from k = None \/ from k = Some k) ->
    match z_register k with
    | None => next c = idle
    | Some j => next c = started \/ next c = held /\ (exists o p, cl = LastTrigger o p) /\ j = k
    end -> tells k st c 0.
  Proof.
    intros k st c H1 H2 H3. split; auto; [lia | | | |tauto].
    - intros m j i -> _ HF Hj. destruct H2 as [H2|H2]; rewrite H2 in HF; [discriminate|]. injection HF as <-. lia.
    - destruct (z_register k); auto. destruct H3 as [H3|[H3 _]]; auto.
    - intros HH. destruct (z_register k) as [j|]; [|rewrite H3 in HH; discriminate].
      destruct H3 as [H3|(_ & H3 & ->)]; auto. rewrite H3 in HH. discriminate.
  Qed.

  (** It runs on, and more bounds may pass. *)
  Lemma tells_running : forall k i n c j, In n (may_have_passed z (Running, i)) -> i <= most -> from k = Some j ->
    j <> k ->
    holding c = first_of z n -> match z_register k with None => next c = idle | Some _ => next c = (Running, n) end ->
    starts c = false -> tells k (Running, i) c n.
  Proof.
    intros k i n c j HI Hi HF Hj Hh Hn Hs. assert (HM : i <= n <= most).
    { unfold may_have_passed in HI. simpl in HI. fold most in HI. destruct (Nat.ltb_spec i most); simpl in HI; lia. }
    split; auto; try lia.
    - intros [H|H]; rewrite H in HF; [discriminate | injection HF as <-; congruence].
    - intros m j' i' _ E _ _. injection E as <-. lia.
    - destruct (z_register k); auto.
    - intros H. destruct (z_register k); rewrite Hn in H; discriminate.
    - intros [H|H]; [congruence|]. destruct (z_register k); [|auto]. rewrite Hn in H. simpl in H.
    apply Nat.ltb_ge in H. fold most in H. right; right; left. lia.
  Qed.

  Lemma in_running_cases : forall g st o c, In c (running_cases z g st o) ->
    exists n, In n (may_have_passed z st) /\ c = in_time g (first_of z n) (Running, n) n o.
  Proof. intros g st o c H. unfold running_cases in H. apply in_map_iff in H. destruct H as (n & <- & Hn). eauto. Qed.

  Lemma before_running : forall k st, before_step k st -> fst st = Running ->
    exists m j n, k = S m /\ z_register m = Some j /\ st = (Running, n) /\ n <= most.
  Proof.
    intros [|m] st HB HS; simpl in HB; [subst; discriminate|]. destruct (z_register m) as [j|] eqn:E; [|subst;
      discriminate].
    destruct HB as [(n & -> & Hn)| ->]; [eauto 7 | discriminate].
  Qed.
  Lemma before_not : forall k st, before_step k st -> fst st <> Running -> st <> held ->
    match k with 0 => True | S m => z_register m = None end.
  Proof.
    intros [|m] st HB H1 H2; simpl in HB; auto. destruct (z_register m); auto.
    destruct HB as [(i & -> & _)| ->]; simpl in *; congruence.
  Qed.

  Lemma scope_tells : forall o f opens closes k r st c, cl = SinceOpening o ->
    (forall k, scope_tracker o e k = match around e (about z) k with
                                     | (false, _) => None
                                     | (true, _) => f (match around e (about z) k, k with (_, false),
                                       S j => scope_tracker o e j | _, _ => None end) k
                                     end) ->
    (forall j k, f (Some j) k = match closes with Some y => if at_letter y (e k) then None else Some j | None => Some j
      end) ->
    (forall k, f None k = if at_letter opens (e k) then Some k else None) ->
    around e (about z) k = (true, r) -> before_step k st -> st <> held ->
    In c (scope_cases z opens closes st (true, r)) -> at_letter (guard c) (e k) = true -> exists n, tells k st c n.
  Proof.
    intros o f opens closes k r st c Hcl Hf H1 H2 Hr HB Hh HI HG. pose proof (Hf k) as Hk. rewrite Hr in Hk.
    assert (HR : z_register k = scope_tracker o e k) by (unfold z_register; now rewrite Hcl).
    assert (HF : from k = scope_tracker o e k) by (unfold from; now rewrite Hcl).
    assert (HO : scope_tracker o e k = f None k ->
              In c [starting opens (none_of z) started (true, true); at_once (PNot opens) (none_of z) idle] ->
                exists n, tells k st c n).
    { intros E [<-|[<-|[]]]; rewrite H2 in E; simpl in HG; exists 0; (apply tells_rest;
      [reflexivity | rewrite HF | rewrite HR]).
      - rewrite HG in E. auto.
      - rewrite E, HG. auto.
      - destruct (at_letter opens (e k)); [discriminate|auto].
      - rewrite E. destruct (at_letter opens (e k)); [discriminate|reflexivity]. }
    unfold scope_cases in HI. simpl snd in HI. destruct r.
    { apply HO; [rewrite Hk; now destruct k|]. destruct (fst st); exact HI. }
    assert (HN : fst st <> Running -> exists n, tells k st c n).
    { intros Es. pose proof (before_not k st HB Es Hh) as HN. apply HO; [|destruct (fst st); auto; congruence].
      destruct k as [|m]; auto. unfold z_register in HN. rewrite Hcl in HN. now rewrite HN in Hk. }
    destruct (fst st) eqn:Es; try (apply HN; congruence). clear HN.
    destruct (before_running k st HB Es) as (m & j & i & -> & Hm & -> & Hi). unfold z_register in Hm. rewrite Hcl in Hm.
    rewrite Hm, H1 in Hk. pose proof (scope_backward o e m j Hm) as Hj.
    assert (HX : In c (running_cases z match closes with Some y => PNot y | None => PTruth end (Running, i) (true,
      false)) \/
                 exists y, closes = Some y /\ c = at_once y (none_of z) idle).
    { destruct closes as [y|]; [apply in_app_iff in HI; destruct HI as [HI|[<-|[]]]|]; eauto. }
    destruct HX as [HX|(y & -> & ->)].
    - destruct (in_running_cases _ _ _ _ HX) as (n & Hn & ->). simpl in HG.
      assert (E : scope_tracker o e (S m) = Some j).
      { rewrite Hk. destruct closes as [y|]; auto. simpl in HG. destruct (at_letter y (e (S m))); [discriminate|auto]. }
      exists n. apply (tells_running (S m) i n _ j); auto; [now rewrite HF | lia | now rewrite HR, E].
    - simpl in HG. rewrite HG in Hk. exists 0. apply tells_rest; auto; [left; now rewrite HF | now rewrite HR, Hk].
  Qed.

  Lemma closed_tells : forall k st, fst (around e (about z) k) = false ->
    tells k st (at_once PTruth (none_of z) idle) 0.
  Proof.
    intros k st H. assert (HN : from k = None /\ z_register k = None).
    { unfold from, z_register. rewrite is_clock in H. unfold around in H.
      destruct cl as [[|o p|o p|o p q]|o p q|o p]; simpl in H; try discriminate;
        assert (E : scope_tracker o e k = None) by (unfold open_at in H; destruct (scope_tracker o e k); auto;
          discriminate);
        simpl; rewrite ?register_eq; unfold before; rewrite E; auto. }
    destruct HN as [H1 H2]. apply tells_rest; auto. now rewrite H2.
  Qed.

  Lemma first_open_tells : forall o p q k r st c, cl = FirstOpen o p q -> open_at e o k = (true, r) ->
    before_step k st -> st <> held -> In c (first_open_cases z p q (afresh (true, r) st)) ->
      at_letter (guard c) (e k) = true ->
    exists n, tells k st c n.
  Proof.
    intros o p q k r st c Hcl Hr HB Hh HI HG. set (f := episode p q e).
    pose proof (register_around e f o k) as HK. pose proof (before_open e f o k) as HF. rewrite Hr in HK, HF.
    assert (HR : forall m, z_register m = register f (scope_tracker o e) m) by (intros m; unfold z_register;
      now rewrite Hcl).
    assert (HFr : from k = before f (scope_tracker o e) k) by (unfold from; now rewrite Hcl). rewrite <- HFr in HF.
    rewrite <- HR in HK.
    assert (HO : from k = None -> z_register k = f None k ->
      In c [starting (PAnd p (PNot q)) (none_of z) started closed; at_once (PNot (PAnd p (PNot q))) (none_of z) idle] ->
      exists n, tells k st c n).
    { intros E1 E2 HI'. exists 0.
      change (f None k) with (if at_letter q (e k) then None else if at_letter p (e k) then Some k else None) in E2.
      destruct HI' as [<-|[<-|[]]]; simpl in HG; (apply tells_rest; [reflexivity | auto |]); rewrite E2;
        destruct (at_letter q (e k)), (at_letter p (e k)); simpl in HG; auto; discriminate. }
    unfold first_open_cases, afresh in HI. simpl snd in HI. destruct r; [apply HO; auto|].
    assert (HN : fst st <> Running -> exists n, tells k st c n).
    { intros Es. pose proof (before_not k st HB Es Hh) as HN. apply HO; [| |destruct (fst st); auto; congruence].
      - rewrite HF. destruct k as [|m]; auto. now rewrite <- HR.
      - rewrite HK. destruct k as [|m]; auto. now rewrite <- HR, HN. }
    destruct (fst st) eqn:Es; try (apply HN; congruence). clear HN.
    destruct (before_running k st HB Es) as (m & j & i & -> & Hm & -> & Hi). rewrite <- HR, Hm in HF.
    rewrite <- HR, Hm in HK.
    assert (Hj : j <= m).
    { rewrite HR in Hm. apply (register_backward f (scope_tracker o e) (episode_remembers p q e) m j Hm). }
    assert (HQ : f (Some j) (S m) = if at_letter q (e (S m)) then None else Some j) by reflexivity.
    apply in_app_iff in HI. destruct HI as [HI|HI].
    - apply in_map_iff in HI. destruct HI as (n & <- & Hn). simpl in HG. rewrite HQ, HG in HK.
      exists n. apply (tells_running (S m) i n _ j); auto; [lia | now rewrite HK].
    - destruct (in_running_cases _ _ _ _ HI) as (n & Hn & ->). simpl in HG.
      rewrite HQ in HK. destruct (at_letter q (e (S m))); [discriminate|].
      exists n. apply (tells_running (S m) i n _ j); auto; [lia | now rewrite HK].
  Qed.

  Lemma last_trigger_tells : forall o p k r st c, cl = LastTrigger o p -> open_at e o k = (true, r) ->
    before_step k st -> (st = held -> match k with 0 => False | S m => z_register m = Some m end) ->
    In c (last_trigger_cases z p (afresh (true, r) st)) -> at_letter (guard c) (e k) = true -> exists n, tells k st c n.
  Proof.
    intros o p k r st c Hcl Hr HB Hh HI HG. set (f := trigger p e). pose proof (register_around e f o k) as HK.
    rewrite Hr in HK.
    assert (HR : forall m, z_register m = register f (scope_tracker o e) m) by (intros m; unfold z_register;
      now rewrite Hcl).
    assert (HF : from k = z_register k) by (unfold from, z_register; now rewrite Hcl). rewrite <- HR in HK.
    assert (Hf : forall b, f b k = if at_letter p (e k) then Some k else b) by reflexivity. rewrite Hf in HK.
    unfold last_trigger_cases, afresh in HI. simpl snd in HI. destruct HI as [<-|HI].
    { simpl in HG. rewrite HG in HK. exists 0. apply tells_rest; [reflexivity | right; now rewrite HF|]. rewrite HK.
    right. eauto. }
    assert (HN : z_register k = None -> c = at_once (PNot p) (none_of z) idle -> exists n, tells k st c n).
    { intros E ->. exists 0. apply tells_rest; [reflexivity | left; now rewrite HF | now rewrite E]. }
    destruct r.
    { simpl in HI. destruct HI as [<-|[]]. simpl in HG. destruct (at_letter p (e k)); [discriminate|]. apply HN; auto. }
    destruct (fst st) eqn:Es.
    3: { destruct (before_running k st HB Es) as (m & j & i & -> & Hm & -> & Hi). rewrite <- HR, Hm in HK.
         destruct (in_running_cases _ _ _ _ HI) as (n & Hn & ->). simpl in HG.
         destruct (at_letter p (e (S m))); [discriminate|].
         assert (j <= m) by (rewrite HR in Hm; apply (register_backward f (scope_tracker o e) (trigger_remembers p e) m
           j Hm)).
         exists n. apply (tells_running (S m) i n _ j); auto; [now rewrite HF | lia | now rewrite HK]. }
    3: { destruct HI as [<-|[]]. simpl in HG. destruct (at_letter p (e k)); [discriminate|].
         destruct k as [|m]; [simpl in HB; subst; discriminate|]. simpl in HB.
         destruct (z_register m) as [j|] eqn:Em; [|subst; discriminate].
         destruct HB as [(n & -> & _)| ->]; [discriminate|]. rewrite <- HR, Em in HK. exists 0. split.
         - reflexivity.
         - lia.
         - auto.
         - intros m' j' i _ E. discriminate.
         - rewrite HK. auto.
         - discriminate.
         - intros [E|E]; [discriminate|]. simpl in E. apply Nat.ltb_ge in E. fold most in E. right; right; left. lia. }
    all: destruct HI as [<-|[]]; simpl in HG; destruct (at_letter p (e k)); [discriminate|]; apply HN; auto; rewrite HK;
      pose proof (before_not k st HB ltac:(congruence) ltac:(intros ->; discriminate)) as HX; destruct k as [|m];
        auto; now rewrite <- HR.
  Qed.

  (** ** Along the word *)

  Lemma register_contiguous : forall f tr, remembers f -> forall k a, register f tr (S k) = Some a -> a <= k ->
    register f tr k = Some a.
  Proof.
    intros f tr Hf k a H Ha. rewrite register_eq in H. destruct (tr (S k)) as [b|] eqn:E; [|congruence].
    destruct (Hf _ _ _ H) as [->|HB]; [lia|]. unfold before in HB. rewrite E in HB. destruct (b <=? k); congruence.
  Qed.

  Lemma from_register : forall k j, from (S k) = Some j -> j <= k -> z_register k = Some j.
  Proof.
    unfold from, z_register. destruct cl as [o|o p q|o p]; simpl; intros k j H Hj.
    - destruct o; simpl in *; eauto using register_contiguous, opened_remembers, uncut_remembers, episode_remembers.
    - unfold before in H. destruct (scope_tracker o e (S k)) as [a|]; [|discriminate]. destruct (a <=? k); congruence.
    - eauto using register_contiguous, trigger_remembers.
  Qed.
  Lemma register_from : forall k j, z_register k = Some j -> from k = Some j \/ j = k.
  Proof.
    unfold from, z_register. destruct cl as [o|o p q|o p]; simpl; intros k j H; auto. rewrite register_eq in H.
    destruct (scope_tracker o e k); [|discriminate]. destruct (episode_remembers p q e _ _ _ H); auto.
  Qed.

  (** How many bounds have passed, by the letters. *)
  Definition shown_at (k : nat) : nat := length (filter (e k) (decides z)).

  Lemma shown_count : forall (f : nat -> bool) ds n, n <= length ds -> (forall i, i < length ds ->
    f (nth i ds 0) = (i <? n)) ->
    length (filter f ds) = n.
  Proof.
    intros f. induction ds as [|a ds IH]; intros n Hn H; simpl in *; [lia|].
    pose proof (H 0 ltac:(lia)) as H0. simpl in H0. destruct n as [|n]; rewrite H0; simpl.
    - apply IH; [lia|]. intros i Hi. apply (H (S i)). lia.
    - f_equal. apply IH; [lia|]. intros i Hi. apply (H (S i)). lia.
  Qed.

  Definition sound_before (k : nat) (st : state) : Prop := before_step k st /\
    (st = held -> (exists o p, cl = LastTrigger o p) /\ match k with 0 => False | S m => z_register m = Some m end).

  Lemma case_tells : forall k st c, sound_before k st -> In c (cases z st (around e (about z) k)) ->
    at_letter (guard c) (e k) = true -> exists n, tells k st c n.
  Proof.
    intros k st c [HB HH] HI HG. assert (HX : (forall o p, cl <> LastTrigger o p) -> st <> held).
    { intros H E. destruct (HH E) as [(o & p & E') _]. now apply (H o p). }
    destruct (around e (about z) k) as [b r] eqn:EA. unfold cases in HI. rewrite is_clock in HI.
    assert (HC : b = false -> c = at_once PTruth (none_of z) idle -> exists n, tells k st c n).
    { intros -> ->. exists 0. apply closed_tells. now rewrite EA. }
    pose proof EA as EO. rewrite is_clock in EO. unfold around in EO. pose proof z_not_until as HU.
    assert (Hcl : exists kind, cl = kind) by eauto. destruct Hcl as (kind & Ecl). rewrite Ecl in HI, EO, HU.
    destruct kind as [[|o p|o p|o p q]|o p q|o p]; simpl in EO; try (destruct HU; fail).
    - injection EO as <- <-.
      apply (scope_tells WholeRun (fun r k => match r with Some j => Some j | None => Some k end) PTruth None k (k =?
        0) st c); auto.
      + intros m. rewrite is_clock, Ecl. unfold around. simpl. destruct m; reflexivity.
      + apply HX. rewrite Ecl. discriminate.
    - destruct b; [|simpl in HI; destruct HI as [<-|[]]; auto].
      apply (scope_tells (AfterEvent o p) (opened p e) p None k r st c); auto; [|apply HX; rewrite Ecl; discriminate].
      intros m. rewrite is_clock, Ecl. unfold around. simpl outer. cbv iota. apply (register_around e (opened p e) o m).
    - destruct b; [|simpl in HI; destruct HI as [<-|[]]; auto].
      apply (scope_tells (Episodes o p q) (episode p q e) (PAnd p (PNot q)) (Some q) k r st c); auto; [| |apply HX;
        rewrite Ecl; discriminate].
      + intros m. rewrite is_clock, Ecl. unfold around. simpl outer. cbv iota.
      apply (register_around e (episode p q e) o m).
      + intros m. unfold episode, opened. simpl. destruct (at_letter q (e m)), (at_letter p (e m)); auto.
    - destruct b; [|simpl in HI; destruct HI as [<-|[]]; auto].
      eapply first_open_tells; eauto. apply HX. rewrite Ecl. discriminate.
    - destruct b; [|simpl in HI; destruct HI as [<-|[]]; auto].
      eapply last_trigger_tells; eauto. intros E. apply HH, E.
  Qed.

  Lemma along : forall k, sound_before k (z_state k) /\ forall m, moves_by news xs (path k) (e k) (path (S k)) m ->
    exists c, tells k (z_state k) c (shown_at k) /\ z_state (S k) = next c /\ nth 0 (fair m) false = goes_on z c /\
      forall i, i < length (decides z) -> e k (nth i (decides z) 0) = (i <? shown_at k).
  Proof.
    assert (HC : forall k, sound_before k (z_state k) -> forall m, moves_by news xs (path k) (e k) (path (S k)) m ->
      exists c, tells k (z_state k) c (shown_at k) /\ z_state (S k) = next c /\ nth 0 (fair m) false = goes_on z c /\
        forall i, i < length (decides z) -> e k (nth i (decides z) 0) = (i <? shown_at k)).
    { intros k HS m Hm. destruct (z_step k (z_state k) m (z_state_is k) Hm) as (c & HZ & HI & HG & HD & HF).
      destruct (case_tells k (z_state k) c HS HI HG) as (n & HT). exists c.
      assert (HL : forall i, i < length (decides z) -> e k (nth i (decides z) 0) = (i <? n)).
      { intros i Hi. pose proof (first_hold _ _ _ _ HT) as HH. rewrite (decided_nth z c (e k) i HD Hi), HH.
        - unfold first_of. now rewrite (nth_table (fun j => j <? n)) by auto.
        - rewrite HH. unfold first_of. now rewrite map_length, seq_length. }
      assert (HN : shown_at k = n).
      { apply shown_count; auto. rewrite z_atoms. apply (not_too_many _ _ _ _ HT). }
      rewrite HN. split; [exact HT|]. split; [|auto]. destruct (z_state_is (S k)) as [_ H1].
      destruct HZ as [_ HZ]. rewrite HZ in H1. apply app_inj_tail in H1. destruct H1; congruence. }
    induction k as [|k [IH _]].
    - assert (HS : sound_before 0 (z_state 0)); [|split; auto].
      destruct (z_state_is 0) as [_ H1]. destruct z_starts as [_ H2]. rewrite H2 in H1. apply app_inj_tail in H1.
        destruct H1 as [_ <-]. split; [reflexivity | discriminate].
    - assert (HS : sound_before (S k) (z_state (S k))); [|split; auto].
      destruct is_word as (_ & HM & _). destruct (HM k) as (m & Hm). destruct (HC k IH m Hm) as (c & HT & -> & _ & _).
      split.
      + simpl. pose proof (then_state _ _ _ _ HT) as H. destruct (z_register k) as [j|]; auto.
      destruct H as [H|[H _]]; auto.
        left. exists (shown_at k). split; auto. apply (not_too_many _ _ _ _ HT).
      + apply (held_now _ _ _ _ HT).
  Qed.

  (** Every fair word of the machine with one clock is a run: there are times with which its clock says what the
      word says. *)
  Theorem words_are_runs : exists t, passing t /\ diverges t /\ forall k i, i < length (bounds z) ->
    e k (nth i (decides z) 0) = older t (nth i (bounds z) 0) (counts_from cl e k) k.
  Proof.
    assert (HA : forall k, exists c, tells k (z_state k) c (shown_at k) /\ z_state (S k) = next c /\
              forall i, i < length (decides z) -> e k (nth i (decides z) 0) = (i <? shown_at k)).
    { intros k. destruct is_word as (_ & HM & _). destruct (HM k) as (m & Hm).
      destruct (proj2 (along k) m Hm) as (c & A & B & _ & D). eauto. }
    destruct (times_exist from shown_at (bounds z) z_rising) as (t & T1 & T2 & T3).
    - intros k j. apply counts_from_backward.
    - intros k j H1 H2. apply register_from. now apply from_register.
    - intros k H. destruct (HA k) as (c & HT & _). apply (none_yet _ _ _ _ HT). auto.
    - intros k j H1 H2. destruct (HA k) as (c & HT & HN & _). destruct (HA (S k)) as (c' & HT' & _).
      pose proof (counts_from_backward cl e k j H1) as Hj. pose proof (then_state _ _ _ _ HT) as HS.
      rewrite (from_register k j H2 Hj) in HS. destruct HS as [HS|[_ HS]]; [|lia].
      apply (none_back _ _ _ _ HT' k j (shown_at k)); auto. congruence.
    - intros k. destruct (HA k) as (c & HT & _). apply (not_too_many _ _ _ _ HT).
    - intros n. destruct is_word as (_ & _ & HF). assert (H0 : 0 < sets news xs).
      { unfold sets. rewrite not_trivial. lia. }
      destruct (HF 0 H0 n) as (k & m & Hk & Hm & HM). destruct (proj2 (along k) m Hm) as (c & HT & _ & HG & _).
      rewrite HM in HG. unfold goes_on in HG. symmetry in HG. apply orb_true_iff in HG.
      assert (HX : starts c = true \/ is_running z (next c) = false).
      { destruct HG as [HG|HG]; auto. right. now apply negb_true_iff in HG. }
      destruct (if_free _ _ _ _ HT HX) as [H|[H|[H|H]]]; try (exists k; unfold free; tauto).
      exists (S k). split; [lia|]. unfold free. destruct (from (S k)) as [j|] eqn:E; auto. right; left.
      pose proof (counts_from_backward cl e (S k) j E) as Hj. destruct (Nat.eq_dec j (S k)) as [->|]; auto.
      rewrite (from_register k j E) in H by lia. discriminate.
    - exists t. repeat split; auto. intros k i Hi. destruct (HA k) as (c & HT & _ & HL). rewrite HL by lia.
    specialize (T3 k).
      fold from. destruct (from k) as [j|] eqn:E; simpl; [symmetry; auto|].
      rewrite (none_yet _ _ _ _ HT) by auto. reflexivity.
  Qed.
End OneClock.

(** * A property with one clock, which may have several bounds *)

(** The timers of p are those of [z]. *)
Definition one_clock (p : property) (z : tracker_of) : Prop := forall y, In y (timers WholeRun p) ->
  about z = Measures (clock_of y) /\
  exists i, i < length (bounds z) /\ atom_of y = nth i (decides z) 0 /\ bound_of y = nth i (bounds z) 0.

(** Over a fair word of its machine, the encoding says what the property says of a run in time. *)
Theorem one_clock_words_are_runs : forall p news scopes z e path,
  trackers_of [] p news (scopes ++ [z]) -> (forall x, In x scopes -> is_scope x) -> one_clock p z -> bounds z <> [] ->
  anchored p = true -> decided e None -> word news (scopes ++ [z]) e path ->
  exists t, timed t None /\ shown (timers WholeRun p) e t /\ (sat (encode Episode p) e None 0 <-> satisfies p e t None
    0).
Proof.
  intros p news scopes z e path HX HS HO HB HA Hd HW.
  assert (HZ : In z (scopes ++ [z])) by (apply in_app_iff; simpl; auto).
  pose proof (each_is_theirs _ _ _ _ HX z HZ) as H.
  destruct (about z) as [o|cl] eqn:Ez; [destruct H as (c & _ & [] & _)|]. destruct H as (H1 & H2 & _ & _ & H3).
  destruct (words_are_runs news scopes z cl e path) as (t & T1 & T2 & T3); auto.
  - destruct cl as [[]| |]; auto.
  - apply HX.
  - assert (HT : timed t None) by (split; auto). assert (HH : shown (timers WholeRun p) e t).
    { intros y Hy k. destruct (HO y Hy) as (E & i & Hi & E1 & E2). rewrite Ez in E. injection E as E.
      unfold late. rewrite E1, E2, <- E. now apply T3. }
    exists t. split; auto. split; auto. apply encode_correct; auto.
    apply (clocks_right p WholeRun); auto using (tracks_run e None).
Qed.

(** The machine of 'always (a0 implies eventually a1 within 2)', whose clock has the atom a2. *)
Definition stops_in_time : property := Always (Implies (Now (PAtom 0)) (Within 2 2 (Eventually (Now (PAtom 1))))).
Definition the_run : tracker_of := {| about := Measures (SinceOpening WholeRun); decides := []; bounds := [] |}.
Definition the_clock : tracker_of := {| about := Measures (FirstOpen WholeRun (PAtom 0) (PAtom 1)); decides := [2];
  bounds := [2] |}.

Example has_a_machine : trackers_of [] stops_in_time [] [the_run; the_clock].
Proof.
  split.
  - intros x [<-|[<-|[]]]; simpl; repeat split; auto; try (intros [H|[]]; discriminate); intros [|i] Hi; simpl in *;
    auto; lia.
  - intros a [(o & [])|(y & [<-|[]] & <-)]. reflexivity.
  - simpl. auto.
  - reflexivity.
Qed.
Example has_one_clock : one_clock stops_in_time the_clock.
Proof. intros y [<-|[]]. split; auto. exists 0. auto. Qed.
