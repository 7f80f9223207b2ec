(** The checker of a guard's region: whatever message comes, whatever clocks pass, and whatever it then sends, it comes to
    rest again ([check_guard_sound]). Conditions on letters are decision diagrams, and no letter is listed.

    A step is taken symbolically: after it, each condition is a diagram over what held before and what comes anew.
    Python: [ltlc/semantics/region_check.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Trackers Resets Monitor Conditions Judgements Moves Machines Certificate
  Infinite Diagrams Guard GuardedPlaces.

(** What is asked of one step, or of two: whether a condition held before, whether one that may be anything holds after it,
    and an atom that is a property's own. *)
Inductive asked := Was (c : nat) | Becomes (second : bool) (c : nat) | OfPart (second : bool) (n a : nat).
Definition asked_eq_dec : forall x y : asked, {x = y} + {x <> y}.
Proof. decide equality; try apply Nat.eq_dec; apply bool_dec. Defined.
Definition where_eq_dec : forall x y : where_, {x = y} + {x <> y}.
Proof. decide equality; [apply clocks_eq_dec | apply Nat.eq_dec]. Defined.
Definition place_eq_dec : forall x y : place, {x = y} + {x <> y}.
Proof. repeat decide equality; apply clocks_eq_dec. Defined.
Definition clock_name_eq_dec : forall x y : nat * nat, {x = y} + {x <> y}.
Proof. repeat decide equality. Defined.

Definition tree : Type := diagram asked.
Definition both_ : tree -> tree -> tree := meet asked_eq_dec.

(** The letters of [ctx] that satisfy d; where there are none, there is nothing to judge. *)
Definition within (ctx d : tree) (judge : tree -> bool) : bool :=
  let c := both_ ctx d in if is_false c then true else judge c.

(** A place where the guard may rest or answer: where it rests; which fallback it sends at once where; and what it sends
    where before some clocks pass. *)
Record spot := {
  spot_place : place; resting : diagram nat; answering : list (diagram nat);
  ahead : list (some_clocks * nat * diagram nat)
}.

Section Check.
  Variable S : setting.

  (** * One step *)
  Section Step.
    Variables (second : bool) (e : option nat) (now : nat -> tree).

    Section One.
      Variables (n : nat) (P : part).
      Let C := certified_by P.
      Let M := machine C.
      Let xs := watched P.

      Definition part_atom (a : nat) : tree :=
        match role_of P a with
        | Plain c => now c
        | NewsOf ts => Value (is_news e ts)
        | Own => variable (OfPart second n a)
        end.
      Definition part_tree : predicate -> tree := put_predicate asked_eq_dec part_atom.

      Fixpoint each_cases (ys : list tracker_of) (sts : list state) (env : Resets.known) (first : bool) (ctx : tree)
        (judge : tree -> list case -> bool) : bool :=
        match ys, sts with
        | y :: ys, st :: sts =>
            forallb (fun c => within ctx (part_tree (PAnd (Trackers.guard c) (atoms_as y c))) (fun ctx =>
                       each_cases ys sts (learn env y c) first ctx (fun ctx cs => judge ctx (c :: cs))))
              (cases y st (surroundings env first y))
        | _, _ => judge ctx []
        end.
      Definition clocks_ways (k : clocks) (ctx : tree) (judge : tree -> clocks -> list case -> bool) : bool :=
        if is_trivial (news C) xs then judge ctx k [] else
        let held := part_tree (settled (news C) xs) in
        let timed := match e with None => true | Some _ => false end in
        each_cases xs (states k) (fun _ => Trackers.closed) (is_first k) ctx (fun ctx cs =>
          if timed || none_pass xs k cs
          then (if may_hold xs k cs then within ctx held (fun ctx => judge ctx (to_held xs cs) cs) else true) &&
               (if timed then true else within ctx (negated held) (fun ctx => judge ctx (to_other xs k cs) cs))
          else true).
      Fixpoint monitor_ways (fuel : nat) (t : target) (ctx : tree) (judge : tree -> nat -> bool) : bool :=
        match t, fuel with
        | State q, _ => judge ctx q
        | Ask d, Datatypes.S fuel =>
            match nth_error (decisions M) d with
            | Some a => within ctx (part_atom (atom a)) (fun ctx => monitor_ways fuel (high a) ctx judge) &&
                        within ctx (negated (part_atom (atom a))) (fun ctx => monitor_ways fuel (low a) ctx judge)
            | None => false
            end
        | Ask _, 0 => false
        end.
      Definition moved_ways (q : nat) (k : clocks) (ctx : tree)
        (judge : tree -> where_ -> some_clocks -> some_clocks -> bool) : bool :=
        match nth_error (edges M) q with
        | Some t =>
            clocks_ways k ctx (fun ctx k' cs =>
              monitor_ways (1 + length (decisions M)) t ctx (fun ctx q' =>
                match nth_error (verdicts M) q' with
                | Some v => judge ctx (judged v q' k') (numbered n (those_passing xs (states k) cs))
                              (numbered n (left_alone xs cs))
                | None => false
                end))
        | None => false
        end.
      Definition part_ways (c : option (list nat)) (w : where_) (ctx : tree)
        (judge : tree -> where_ -> some_clocks -> some_clocks -> bool) : bool :=
        match w with
        | Waits => forallb (fun b : bool => if b then moved_ways 0 (start xs) ctx judge else judge ctx Waits [] [])
                     (beginnings S P e c)
        | At q k => if hears S P e then moved_ways q k ctx judge
                    else judge ctx w [] (numbered n (map (fun _ => true) xs))
        | Done | Lost => judge ctx w [] []
        end.
    End One.

    Definition is_lost (w : where_) : bool := match w with Lost => true | _ => false end.
    Fixpoint parts_ways (c : option (list nat)) (n : nat) (Ps : list part) (ws : list where_) (ctx : tree)
      (judge : tree -> list where_ -> some_clocks -> some_clocks -> bool) : bool :=
      match Ps, ws with
      | [], [] => judge ctx [] [] []
      | P :: Ps, w :: ws =>
          part_ways n P c w ctx (fun ctx w' d a =>
            if is_own S e || is_kept P || negb (is_lost w')
            then parts_ways c (1 + n) Ps ws ctx (fun ctx ws' ds es => judge ctx (w' :: ws') (d ++ ds) (a ++ es))
            else true)
      | _, _ => false
      end.
  End Step.

  Definition before : nat -> tree := fun c => variable (Was c).
  Definition after (second : bool) (s : nat -> source) (now : nat -> tree) : nat -> tree := fun c =>
    match s c with Is b => Value b | As c' => now c' | Any => variable (Becomes second c) end.
  Definition of_letter (now : nat -> tree) : diagram nat -> tree := put asked_eq_dec now.

  (** Every way from a place by an event, after which the conditions are [s] of those of [now]. *)
  Definition ways (second : bool) (e : option nat) (s : nat -> source) (x : place) (ctx : tree) (now : nat -> tree)
    (judge : tree -> (nat -> tree) -> place -> some_clocks -> some_clocks -> bool) : bool :=
    let now := after second s now in
    within ctx (of_letter now (assumed S)) (fun ctx =>
      forallb (fun c => parts_ways second e now c 0 (parts S) (snd x) ctx (fun ctx ws d a => judge ctx now (c, ws) d a))
        (phases_after S e (fst x))).

  (** * The region *)
  Variable spots : list spot.

  Definition spot_at (x : place) : option spot :=
    find (fun s => if place_eq_dec (spot_place s) x then true else false) spots.
  Definition rest_at (x : place) : diagram nat := match spot_at x with Some s => resting s | None => Value false end.
  Definition answered_in (s : spot) : diagram nat := fold_right (join Nat.eq_dec) (resting s) (answering s).
  Definition answered_at (x : place) : diagram nat := match spot_at x with Some s => answered_in s | None => Value false end.
  Definition acts_for (s : spot) (d : some_clocks) : diagram nat :=
    fold_right (fun a p => if list_eq_dec clock_name_eq_dec (fst (fst a)) d then join Nat.eq_dec (snd a) p else p)
      (Value false) (ahead s).

  Definition is_among (c : nat * nat) (d : some_clocks) : bool := if in_dec clock_name_eq_dec c d then true else false.
  Definition into (ctx : tree) (now : nat -> tree) (goal : diagram nat) : bool :=
    entails asked_eq_dec ctx (of_letter now goal).
  (** Where the conditions held before satisfy p, and are possible. *)
  Definition given_that (p : diagram nat) : tree := both_ (of_letter before p) (of_letter before (assumed S)).

  Definition message_is_answered (s : spot) (t : nat) : bool :=
    ways false (Some t) (heard S t) (spot_place s) (given_that (resting s)) before
      (fun ctx now y _ _ => into ctx now (answered_at y)).
  Definition time_is_answered (s : spot) : bool :=
    ways false None (hold S) (spot_place s) (given_that (resting s)) before (fun ctx now y d _ =>
      entails asked_eq_dec ctx (join asked_eq_dec (of_letter now (answered_at y))
        match d with [] => Value false | _ => of_letter before (acts_for s d) end)).
  Definition answer_leads (s : spot) (f : nat) : bool :=
    ways false (Some (topic_of S f)) (sent S f) (spot_place s) (given_that (nth f (answering s) (Value false))) before
      (fun ctx now y _ _ => into ctx now (rest_at y)).
  Definition act_leads (s : spot) (a : some_clocks * nat * diagram nat) : bool :=
    let '(d, f, p) := a in
    ways false (Some (topic_of S f)) (sent S f) (spot_place s) (given_that (meet Nat.eq_dec (resting s) p)) before
      (fun ctx now y _ e =>
         into ctx now (rest_at y) &&
         ways true None (hold S) y ctx now (fun ctx now z d' _ =>
           if existsb (fun c => is_among c d && is_among c e) d' then into ctx now (answered_at z) else true)).
  Definition may_send_in (s : spot) : bool :=
    match fst (spot_place s), answering s, ahead s with None, [], [] | Some _, _, _ => true | _, _, _ => false end &&
    (length (answering s) <=? length (fallbacks S)) &&
    forallb (fun a => snd (fst a) <? length (fallbacks S)) (ahead s).

  Definition check_spot (s : spot) : bool :=
    negb (existsb is_lost (snd (spot_place s))) && may_send_in s &&
    forallb (message_is_answered s) (seq (owned S) (topics S - owned S)) && time_is_answered s &&
    forallb (answer_leads s) (seq 0 (length (answering s))) && forallb (act_leads s) (ahead s).

  (** Conditions that hold on a path to true, if there is one. *)
  Fixpoint on_a_path (d : diagram nat) : option (list nat) :=
    match d with
    | Value b => if b then Some [] else None
    | If c yes no => match on_a_path no with Some cs => Some cs | None => option_map (cons c) (on_a_path yes) end
    end.
  (** Whether something can be held: otherwise the region says nothing. *)
  Definition something_is_possible : bool :=
    match on_a_path (assumed S) with Some cs => at_values (assumed S) (letter_of cs) | None => false end.

  (** The first place is where the guard starts. *)
  Definition first_phase : option (list nat) := match spots with s :: _ => fst (spot_place s) | [] => None end.
  Definition starts_at_rest : bool :=
    match spots with
    | s :: _ => (match first_phase with None => true | Some m => forallb (Nat.eqb 0) m end) &&
                (if place_eq_dec (spot_place s) (first_phase, map (fun _ => Waits) (parts S)) then true else false) &&
                entails Nat.eq_dec (assumed S) (resting s)
    | [] => false
    end.

  Definition check_guard : bool := something_is_possible && starts_at_rest && forallb check_spot spots.

  Definition region_of : region state_of nat some_clocks := {|
    rests := fun x => exists s, spot_at (fst x) = Some s /\ at_values (resting s) (values (snd x)) = true;
    answers := fun f x => exists s, spot_at (fst x) = Some s /\ f < length (answering s) /\
      at_values (nth f (answering s) (Value false)) (values (snd x)) = true;
    acts := fun d f x => exists s p, spot_at (fst x) = Some s /\ In (d, f, p) (ahead s) /\
      at_values p (values (snd x)) = true /\ at_values (resting s) (values (snd x)) = true
  |}.

  (** * The check is sound *)

  Lemma within_shows : forall v ctx d judge, within ctx d judge = true -> at_values ctx v = true -> at_values d v = true ->
    exists ctx', at_values ctx' v = true /\ judge ctx' = true.
  Proof.
    intros v ctx d judge H H1 H2. unfold within in H. exists (both_ ctx d). unfold both_ in *.
    assert (E : at_values (meet asked_eq_dec ctx d) v = true) by now rewrite meet_at, H1, H2.
    destruct (is_false (meet asked_eq_dec ctx d)) eqn:EF; auto. apply (is_false_at _ v) in EF. congruence.
  Qed.

  Lemma leads_from : forall M l t q, leads M l t q -> match t with
    | State r => q = r
    | Ask d => exists a, nth_error (decisions M) d = Some a /\ leads M l (if l (atom a) then high a else low a) q
    end.
  Proof. intros M l t q H. destruct H as [|d a q H1 H2]; eauto. Qed.

  Section Shows.
    Variables (second : bool) (e : option nat) (now : nat -> tree) (v : asked -> bool) (i : instant).
    Hypothesis is_event : event i = e.
    Hypothesis is_now : forall c, at_values (now c) v = values i c.
    Hypothesis is_own_letter : forall n a, v (OfPart second n a) = own i n a.

    Section One.
      Variables (n : nat) (P : part).
      Hypothesis HP : reads_as n P i.

      Lemma part_atom_at : forall a, at_values (part_atom second e now n P a) v = own i n a.
      Proof.
        intros a. destruct HP as [_ HA]. specialize (HA a). unfold part_atom.
        destruct (role_of P a); [now rewrite is_now | now rewrite HA, is_event |].
        simpl. rewrite is_own_letter. now destruct (own i n a).
      Qed.
      Lemma part_tree_at : forall p, at_values (part_tree second e now n P p) v = at_letter p (own i n).
      Proof. intros p. apply put_predicate_at, part_atom_at. Qed.

      Lemma each_cases_shows : forall ys sts env first ctx judge, at_values ctx v = true ->
        each_cases second e now n P ys sts env first ctx judge = true -> forall g cs, In (g, cs) (together ys sts env first) ->
        at_letter g (own i n) = true -> exists ctx', at_values ctx' v = true /\ judge ctx' cs = true.
      Proof.
        induction ys as [|y ys IH]; intros [|st sts] env first ctx judge HX HJ g cs HI HG; simpl in HI, HJ;
          try (destruct HI as [E|[]]; injection E as <- <-; eauto).
        apply in_flat_map in HI. destruct HI as (c & Hc & HI). apply in_map_iff in HI.
        destruct HI as ((q & ds) & E & HI). injection E as <- <-. cbn [at_letter fst] in HG.
        apply andb_true_iff in HG. destruct HG as [HG HQ]. rewrite forallb_forall in HJ. specialize (HJ c Hc).
        apply (within_shows v) in HJ; auto; [|now rewrite part_tree_at]. destruct HJ as (ctx' & HX' & HJ).
        exact (IH _ _ _ _ _ HX' HJ q ds HI HQ).
      Qed.

      Lemma clocks_ways_shows : forall k ctx judge, at_values ctx v = true ->
        clocks_ways second e now n P k ctx judge = true -> forall k' cs,
        clocks_step (news (certified_by P)) (watched P) (in_time i) k (own i n) k' cs ->
        exists ctx', at_values ctx' v = true /\ judge ctx' k' cs = true.
      Proof.
        intros k ctx judge HX HJ k' cs HC. unfold clocks_ways in HJ. unfold clocks_step, in_time in HC.
        rewrite is_event in HC. destruct (is_trivial (news (certified_by P)) (watched P)).
        { destruct HC as [-> ->]. eauto. }
        destruct HC as (g & HI & HG & HT & HC). cbv zeta in HJ.
        destruct (each_cases_shows _ _ _ _ _ _ HX HJ g cs HI HG) as (ctx' & HX' & HJ'). cbv beta in HJ'.
        replace (match e with None => true | Some _ => false end || none_pass (watched P) k cs) with true in HJ'
          by (symmetry; apply orb_true_iff; tauto).
        apply andb_true_iff in HJ'. destruct HJ' as [H1 H2]. destruct HC as [(HS & HM & ->)|(HE & HS & ->)].
        - rewrite HM in H1. apply (within_shows v) in H1; auto. now rewrite part_tree_at.
        - rewrite HE in H2. apply (within_shows v) in H2; auto. now rewrite negated_at, part_tree_at, HS.
      Qed.

      Lemma monitor_ways_shows : forall fuel t ctx judge, at_values ctx v = true ->
        monitor_ways second e now n P fuel t ctx judge = true -> forall q, leads (machine (certified_by P)) (own i n) t q ->
        exists ctx', at_values ctx' v = true /\ judge ctx' q = true.
      Proof.
        induction fuel as [|fuel IH]; intros t ctx judge HX HJ q' HL; pose proof (leads_from _ _ _ _ HL) as HT;
          destruct t as [q|d]; simpl in HJ; try discriminate; try (rewrite HT; eauto; fail).
        destruct HT as (a & E & HL'). rewrite E in HJ. apply andb_true_iff in HJ. destruct HJ as [H1 H2].
        destruct (own i n (atom a)) eqn:EA.
        - apply (within_shows v) in H1; auto; [|now rewrite part_atom_at]. destruct H1 as (ctx' & HX' & H1). eauto.
        - apply (within_shows v) in H2; auto; [|now rewrite negated_at, part_atom_at, EA].
          destruct H2 as (ctx' & HX' & H2). eauto.
      Qed.
    End One.

    Lemma moved_ways_shows : forall n P q k ctx judge, at_values ctx v = true ->
      moved_ways second e now n P q k ctx judge = true -> forall w d a, moved n P i q k w d a ->
      exists ctx', at_values ctx' v = true /\ judge ctx' w d a = true.
    Proof.
      intros n P q k ctx judge HX HJ w d a (HP & t & q' & u & k' & cs & HT & HL & HV & HC & -> & -> & ->).
      unfold moved_ways in HJ. rewrite HT in HJ.
      destruct (clocks_ways_shows n P HP _ _ _ HX HJ _ _ HC) as (ctx1 & HX1 & HJ1).
      destruct (monitor_ways_shows n P HP _ _ _ _ HX1 HJ1 _ HL) as (ctx2 & HX2 & HJ2). rewrite HV in HJ2. eauto.
    Qed.

    Lemma part_ways_shows : forall n P c w ctx judge, at_values ctx v = true ->
      part_ways second e now n P c w ctx judge = true -> forall w' d a, part_step S n P i c w w' d a ->
      exists ctx', at_values ctx' v = true /\ judge ctx' w' d a = true.
    Proof.
      intros n P c w ctx judge HX HJ w' d a HS. unfold part_step in HS. destruct w as [|q k| |]; simpl in HJ.
      - destruct HS as (b & HB & HS). rewrite is_event in HB. rewrite forallb_forall in HJ. specialize (HJ b HB).
        destruct b; [eapply moved_ways_shows; eauto | destruct HS as (-> & -> & ->); eauto].
      - rewrite is_event in HS. destruct (hears S P e);
          [eapply moved_ways_shows; eauto | destruct HS as (-> & -> & ->); eauto].
      - destruct HS as (-> & -> & ->); eauto.
      - destruct HS as (-> & -> & ->); eauto.
    Qed.

    Lemma parts_ways_shows : forall c n Ps ws ws' d a, parts_step S i c n Ps ws ws' d a -> forall ctx judge,
      at_values ctx v = true -> parts_ways second e now c n Ps ws ctx judge = true ->
      exists ctx', at_values ctx' v = true /\ judge ctx' ws' d a = true.
    Proof.
      intros c n Ps ws ws' d a H.
      induction H as [|n P Ps w w' ws ws' d ds a es HS HK H IH]; intros ctx judge HX HJ; simpl in HJ; eauto.
      destruct (part_ways_shows n P c w ctx _ HX HJ w' d a HS) as (ctx1 & HX1 & HJ1).
      assert (E : is_own S e || is_kept P || negb (is_lost w') = true).
      { rewrite is_event in HK. destruct HK as [->|HK]; auto. apply orb_true_iff. right. now destruct w'. }
      rewrite E in HJ1. exact (IH _ _ HX1 HJ1).
    Qed.
  End Shows.

  (** The valuation that reads one letter, or three, one after the other. *)
  Definition reading (l : letter) (i j : instant) : asked -> bool := fun x =>
    match x with
    | Was c => l c
    | Becomes false c => values i c
    | Becomes true c => values j c
    | OfPart false n a => own i n a
    | OfPart true n a => own j n a
    end.

  Lemma ways_show : forall v second e s ctx now judge x y d a, leads_on S e s x y d a ->
    at_values ctx v = true -> (forall c, at_values (now c) v = values (snd x) c) ->
    (forall c, v (Becomes second c) = values (snd y) c) -> (forall n b, v (OfPart second n b) = own (snd y) n b) ->
    ways second e s (fst x) ctx now judge = true ->
    (forall c, at_values (after second s now c) v = values (snd y) c) /\
    exists ctx', at_values ctx' v = true /\ judge ctx' (after second s now) (fst y) d a = true.
  Proof.
    intros v second e s ctx now judge x y d a (HE & _ & HA & HD & HC & HS) HX HN HF HO HJ.
    assert (HN' : forall c, at_values (after second s now c) v = values (snd y) c).
    { intros c. specialize (HD c). unfold after. destruct (s c); simpl; auto; [now rewrite HN|].
      rewrite HF. now destruct (values (snd y) c). }
    split; auto. unfold ways in HJ. cbv zeta in HJ. apply (within_shows v) in HJ; auto.
    2: { unfold of_letter. rewrite (put_at asked_eq_dec _ _ v (values (snd y))) by auto. exact HA. }
    destruct HJ as (ctx1 & HX1 & HJ). rewrite forallb_forall in HJ. specialize (HJ _ HC).
    destruct (parts_ways_shows second e _ v (snd y) HE HN' HO _ _ _ _ _ _ _ HS ctx1 _ HX1 HJ) as (ctx2 & HX2 & HJ2).
    exists ctx2. split; auto. destruct y as [[c ws] i]. exact HJ2.
  Qed.

  Lemma into_shows : forall v ctx now goal l, into ctx now goal = true -> at_values ctx v = true ->
    (forall c, at_values (now c) v = l c) -> at_values goal l = true.
  Proof.
    intros v ctx now goal l H HX HN. apply (entails_at _ _ _ v) in H; auto. unfold of_letter in H.
    now rewrite (put_at asked_eq_dec _ _ v l) in H by auto.
  Qed.

  Lemma before_at : forall l i j c, at_values (before c) (reading l i j) = l c.
  Proof. intros. simpl. now destruct (l c). Qed.
  Lemma given_that_at : forall p (x : state_of) i j, at_values p (values (snd x)) = true -> allowed S (snd x) ->
    at_values (given_that p) (reading (values (snd x)) i j) = true.
  Proof.
    intros p x i j H1 H2. unfold given_that, both_, of_letter. rewrite meet_at.
    rewrite !(put_at asked_eq_dec before _ _ (values (snd x))) by apply before_at. now rewrite H1.
  Qed.

  (** From a state where p holds, by one step. *)
  Lemma one_step : forall p e s x y d a judge, leads_on S e s x y d a -> at_values p (values (snd x)) = true ->
    ways false e s (fst x) (given_that p) before judge = true -> forall j, exists ctx,
      at_values ctx (reading (values (snd x)) (snd y) j) = true /\ judge ctx (after false s before) (fst y) d a = true /\
      forall c, at_values (after false s before c) (reading (values (snd x)) (snd y) j) = values (snd y) c.
  Proof.
    intros p e s x y d a judge HL HP HJ j. pose proof HL as (_ & HA & _).
    destruct (ways_show (reading (values (snd x)) (snd y) j) false e s (given_that p) before judge x y d a HL)
      as (HN & ctx & HX & HJ');
      auto.
    - now apply given_that_at.
    - intros c. apply before_at.
    - eauto.
  Qed.

  Lemma spot_at_in : forall x s, spot_at x = Some s -> In s spots /\ spot_place s = x.
  Proof.
    intros x s H. apply find_some in H. destruct H as [H1 H2]. destruct (place_eq_dec (spot_place s) x); auto; discriminate.
  Qed.
  Lemma joined_at : forall ds d l, at_values (fold_right (join Nat.eq_dec) d ds) l = true <->
    at_values d l = true \/ exists f, f < length ds /\ at_values (nth f ds (Value false)) l = true.
  Proof.
    intros ds d l. induction ds as [|e ds IH]; simpl.
    - split; auto. intros [H|(f & H & _)]; auto. lia.
    - rewrite join_at, orb_true_iff, IH. split.
      + intros [H|[H|(f & H1 & H2)]]; auto; right; [exists 0 | exists (Datatypes.S f)]; split; auto; lia.
      + intros [H|([|f] & H1 & H2)]; auto. right. right. exists f. split; auto. lia.
  Qed.
  Lemma answered_at_true : forall x, at_values (answered_at (fst x)) (values (snd x)) = true ->
    answered region_of x.
  Proof.
    intros x H. unfold answered_at in H. destruct (spot_at (fst x)) as [s|] eqn:ES; [|discriminate].
    unfold answered_in in H. apply joined_at in H. destruct H as [H|(f & H1 & H2)].
    - left. exists s. auto.
    - right. exists f, s. auto.
  Qed.
  Lemma rest_at_true : forall x, at_values (rest_at (fst x)) (values (snd x)) = true -> rests region_of x.
  Proof.
    intros x H. unfold rest_at in H. destruct (spot_at (fst x)) as [s|] eqn:ES; [|discriminate]. exists s. auto.
  Qed.
  Lemma acts_for_true : forall s d l, at_values (acts_for s d) l = true ->
    exists f p, In (d, f, p) (ahead s) /\ at_values p l = true.
  Proof.
    intros s d l. unfold acts_for. induction (ahead s) as [|[[d' f] p] rest IH]; simpl; [discriminate|].
    destruct (list_eq_dec clock_name_eq_dec d' d) as [->|].
    - rewrite join_at, orb_true_iff. intros [H|H]; eauto. destruct (IH H) as (g & q & H1 & H2). eauto.
    - intros H. destruct (IH H) as (g & q & H1 & H2). eauto.
  Qed.

  Lemma check_guard_of_something : check_guard = true -> exists l, at_values (assumed S) l = true.
  Proof.
    intros H. unfold check_guard, something_is_possible in H. rewrite !andb_true_iff in H. destruct H as [[H _] _].
    destruct (on_a_path (assumed S)); [eauto | discriminate].
  Qed.

  Theorem check_guard_sound : check_guard = true -> is_closed S first_phase region_of.
  Proof.
    intros H. unfold check_guard in H. rewrite !andb_true_iff, forallb_forall in H. destruct H as [[_ H0] HC].
    assert (HS : forall x s, spot_at x = Some s -> spot_place s = x /\ negb (existsb is_lost (snd x)) = true /\
              may_send_in s = true /\
              (forall t, owned S <= t < topics S -> message_is_answered s t = true) /\ time_is_answered s = true /\
              (forall f, f < length (answering s) -> answer_leads s f = true) /\
              forall a, In a (ahead s) -> act_leads s a = true).
    { intros x s H. destruct (spot_at_in x s H) as [H1 H2]. specialize (HC s H1). unfold check_spot in HC.
      rewrite !andb_true_iff, !forallb_forall, H2 in HC. destruct HC as [[[[[C1 C2] C3] C4] C5] C6].
      repeat split; auto; [intros t Ht; apply C3 | intros f Hf; apply C5]; apply in_seq; lia. }
    assert (HW : forall x s, spot_at (fst x) = Some s -> ~ bad x).
    { intros x s H HB. destruct (HS _ _ H) as (_ & HL & _). apply negb_true_iff in HL.
      assert (HX : existsb is_lost (snd (fst x)) = true) by (apply existsb_exists; exists Lost; auto). congruence. }
    assert (HM : forall x s, spot_at (fst x) = Some s -> answering s <> [] \/ ahead s <> [] -> phase_of x <> None).
    { intros x s H HN HP. destruct (HS _ _ H) as (HP' & _ & HM & _). unfold may_send_in in HM. rewrite HP' in HM.
      unfold phase_of in HP. rewrite HP, !andb_true_iff in HM. destruct HM as [[HM _] _].
      destruct (answering s), (ahead s); try discriminate. tauto. }
    assert (HL : forall (x : state_of) s, spot_at (fst x) = Some s -> length (answering s) <= length (fallbacks S) /\
              forall a, In a (ahead s) -> snd (fst a) < length (fallbacks S)).
    { intros x s H. destruct (HS _ _ H) as (_ & _ & HM' & _). unfold may_send_in in HM'.
      rewrite !andb_true_iff, Nat.leb_le, forallb_forall in HM'. destruct HM' as [[_ H1] H2]. split; auto.
      intros a Ha. now apply Nat.ltb_lt, H2. }
    split.
    - intros x [HB HA]. unfold starts_at_rest in H0. destruct spots as [|s rest] eqn:ES; [discriminate|].
      rewrite !andb_true_iff in H0. destruct H0 as [[_ H1] H2]. exists s.
      destruct (place_eq_dec _ _) as [HP|] in H1; [|discriminate].
      split; [|exact (entails_at _ _ _ _ H2 HA)]. unfold spot_at. rewrite ES. simpl.
      destruct (place_eq_dec (spot_place s) (fst x)) as [|HN]; auto. destruct HN. now rewrite HP, HB.
    - intros x (s & H & _). exact (HW x s H).
    - intros x f (s & H1 & H2 & H3). split; [exact (HW x s H1)|]. split.
      + apply Nat.lt_le_trans with (1 := H2), (HL x s H1).
      + apply (HM x s H1). left. intros E. rewrite E in H2. simpl in H2. lia.
    - intros x f e y (s & H1 & H2 & H3) (d & HD). destruct (HS _ _ H1) as (HP & _ & _ & _ & _ & HA & _).
      specialize (HA f H2). unfold answer_leads in HA. rewrite HP in HA.
      destruct (one_step _ _ _ x y d e _ HD H3 HA (snd y)) as (ctx & HX & HJ & HN). cbv beta in HJ.
      apply rest_at_true. exact (into_shows _ _ _ _ _ HJ HX HN).
    - intros x y (s & H1 & H2) (t & d & e & Ht & HD). destruct (HS _ _ H1) as (HP & _ & _ & HA & _).
      specialize (HA t Ht). unfold message_is_answered in HA. rewrite HP in HA.
      destruct (one_step _ _ _ x y d e _ HD H2 HA (snd y)) as (ctx & HX & HJ & HN). cbv beta in HJ.
      apply answered_at_true. exact (into_shows _ _ _ _ _ HJ HX HN).
    - intros x y d (s & H1 & H2) (e & HD). destruct (HS _ _ H1) as (HP & _ & _ & _ & HA & _).
      unfold time_is_answered in HA. rewrite HP in HA.
      destruct (one_step _ _ _ x y d e _ HD H2 HA (snd y)) as (ctx & HX & HJ & HN). cbv beta in HJ.
      apply (entails_at _ _ _ _ HJ) in HX. rewrite join_at, orb_true_iff in HX. destruct HX as [HX|HX].
      + left. apply answered_at_true. unfold of_letter in HX. now rewrite (put_at asked_eq_dec _ _ _ _ HN) in HX.
      + right. destruct d as [|c d]; [discriminate|]. split; [exists c; now left|]. unfold of_letter in HX.
        rewrite (put_at asked_eq_dec before _ _ (values (snd x))) in HX by apply before_at.
        destruct (acts_for_true s (c :: d) _ HX) as (f & p & H3 & H4). exists f, s, p. auto.
    - intros x d f (s & p & H1 & H2 & _). split; [exact (proj2 (HL x s H1) _ H2)|]. apply (HM x s H1). right.
      intros E. rewrite E in H2. destruct H2.
    - intros x d f e y (s & p & H1 & H2 & H3 & H4) (d1 & HD). destruct (HS _ _ H1) as (HP & _ & _ & _ & _ & _ & HA).
      specialize (HA _ H2). unfold act_leads in HA. rewrite HP in HA.
      assert (HB : at_values (meet Nat.eq_dec (resting s) p) (values (snd x)) = true) by now rewrite meet_at, H3, H4.
      assert (HJ := one_step _ _ _ x y d1 e _ HD HB HA). split.
      + destruct (HJ (snd y)) as (ctx & HX & HJ' & HN). cbv beta in HJ'. apply andb_true_iff in HJ'. destruct HJ' as [HJ' _].
        apply rest_at_true. exact (into_shows _ _ _ _ _ HJ' HX HN).
      + intros d' z c (e' & HD') C1 C2 C3. destruct (HJ (snd z)) as (ctx & HX & HJ' & HN). cbv beta in HJ'.
        apply andb_true_iff in HJ'. destruct HJ' as [_ HJ'].
        destruct (ways_show (reading (values (snd x)) (snd y) (snd z)) true None (hold S) ctx
          (after false (sent S f) before)
          (fun ctx now z d' _ => if existsb (fun c => is_among c d && is_among c e) d' then into ctx now (answered_at z) else true)
          y z d' e' HD' HX HN) as (HN' & ctx' & HX' & HJ2); auto. cbv beta in HJ2.
        assert (E : existsb (fun c => is_among c d && is_among c e) d' = true).
        { apply existsb_exists. exists c. split; auto. unfold is_among.
          destruct (in_dec clock_name_eq_dec c d), (in_dec clock_name_eq_dec c e); tauto. }
        rewrite E in HJ2. apply answered_at_true. exact (into_shows _ _ _ _ _ HJ2 HX' HN').
  Qed.
End Check.

(** Where the certificates and the region are accepted: no prefix of what leaves the guard violates a property. *)
Theorem accepted_guard : forall S spots n C rs h kept depth work,
  check_guard S spots = true -> nth_error (parts S) n = Some (part_for C rs h kept) ->
  check depth work C = true -> exact C = true ->
  forall x m, is_guarded S (first_phase spots) (region_of spots) x m -> forall j, j <= m ->
  let ls := has_read S n (part_for C rs h kept) x j in
  ls <> [] -> (exists s, continues C (at_step ls) (length ls) s) ->
  exists s, continues C (at_step ls) (length ls) s /\ holds_for_ever C s.
Proof.
  intros S spots n C rs h kept depth work HG HP HC HE x m HX j Hj ls HN HS.
  exact (guarded_not_violated S _ n _ HP eq_refl depth work HC _ (check_guard_sound S spots HG) HE x m HX j Hj HN HS).
Qed.
