(** Where a guard is, with several properties: for each the state of its monitor and that of its reset machine, and how a
    message, a fallback or a nanosecond leads on. What leaves a guard that rests in a closed region violates no property
    that is kept ([guarded_verdict], [guarded_not_violated]), as long as none is violated that it relies on.

    Python: [ltlc/semantics/arenas.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Trackers Resets Monitor Conditions Judgements Moves Certificate Infinite Diagrams Guard.

(** Where one property is: it has not begun, it can still become satisfied or violated, or it is. *)
Inductive where_ := Waits | At (q : nat) (k : clocks) | Done | Lost.
(** How many messages have left on each of the guard's own topics, up to the number that matters (None: nothing may leave
    before all other topics have spoken), and where each property is. *)
Definition place : Type := option (list nat) * list where_.

(** What an atom of a property is: a condition by its number, which holds or not until a message on a topic that it reads
    comes; news, which comes with messages on some topics; or one that the property's own trackers decide. *)
Inductive role := Plain (c : nat) | NewsOf (ts : list nat) | Own.

(** A property begins with the first message of all; before anything may leave, with some message, at the latest with the
    one after which it may; or with the message after which so many have left on each of the guard's own topics. *)
Inductive waiting := ForSession | ForOthers | ForSent (counts : list nat).

Record part := {
  certified_by : certificate; watched : list tracker_of; roles : list role; waits : waiting; is_kept : bool
}.

(** A property of a guard, by its certificate. *)
Definition part_for (C : certificate) (rs : list role) (h : waiting) (kept : bool) : part :=
  {| certified_by := C; watched := trackers C; roles := rs; waits := h; is_kept := kept |}.

(** After a fallback a condition holds or not, or as another did before; or nothing is known. *)
Inductive source := Is (b : bool) | As (c : nat) | Any.

(** The first [owned] topics are the guard's own. [read_by]: the topics that each condition reads; it changes with messages
    on them only, unless it is [loose]: then it may at any instant. A fallback has its topic. *)
Record setting := {
  owned : nat; topics : nat; read_by : list (list nat); loose : list bool; fallbacks : list (nat * list source);
  assumed : diagram nat; parts : list part
}.

(** A message on a topic, or a nanosecond (None); which conditions are held after it; and the letter of each property. *)
Record instant := { event : option nat; values : letter; own : nat -> letter }.

Definition state_of : Type := place * instant.
Definition phase_of (x : state_of) : option (list nat) := fst (fst x).
Definition wheres (x : state_of) : list where_ := snd (fst x).

(** A clock is named by its property and its own number. *)
Definition some_clocks : Type := list (nat * nat).
Definition numbered (n : nat) (bs : list bool) : some_clocks :=
  map (fun i => (n, i)) (filter (fun i => nth i bs false) (seq 0 (length bs))).

(** * The reset machine at a message, and as time goes on *)
Section Clocks.
  Variables (news : list nat) (xs : list tracker_of).

  Definition none_pass (k : clocks) (cs : list case) : bool :=
    negb (existsb (fun b => b) (those_passing xs (states k) cs)).
  (** A message takes no time, so no clock passes a bound; where time goes on, the letter is one that can be held. *)
  Definition clocks_step (in_time : bool) (k : clocks) (l : letter) (k' : clocks) (cs : list case) : Prop :=
    if is_trivial news xs then k' = k /\ cs = [] else
    exists g, In (g, cs) (together xs (states k) (fun _ => Trackers.closed) (is_first k)) /\ at_letter g l = true /\
      (in_time = true \/ none_pass k cs = true) /\
      ((at_letter (settled news xs) l = true /\ may_hold xs k cs = true /\ k' = to_held xs cs) \/
       (in_time = false /\ at_letter (settled news xs) l = false /\ k' = to_other xs k cs)).

  Lemma clocks_step_moves : forall b k l k' cs, clocks_step b k l k' cs -> exists m, moves_by news xs k l k' m.
  Proof.
    intros b k l k' cs H. unfold clocks_step in H. unfold moves_by, moves. destruct (is_trivial news xs).
    { destruct H as [-> _]. eexists. split; [now left | split; reflexivity]. }
    destruct H as (g & HI & HG & HT & [(HS & HM & ->)|(-> & HS & ->)]); eexists; (split;
      [apply in_flat_map; exists (g, cs); split; [exact HI|]; apply in_app_iff|]).
    - left. cbn [fst snd]. unfold may_hold in HM. apply negb_true_iff in HM. rewrite HM. now left.
    - split; [|reflexivity]. cbn [letters at_letter fst]. rewrite HG. exact HS.
    - right. cbn [fst snd]. destruct HT as [HT|HT]; [discriminate|]. unfold none_pass in HT. apply negb_true_iff in HT.
      rewrite HT. now left.
    - split; [|reflexivity]. cbn [letters fst].
      change (at_letter g l && negb (at_letter (settled news xs) l) = true). now rewrite HG, HS.
  Qed.

  (** The clocks that a step neither starts nor stops. One whose first bound is 0 ns is due at once when it starts. *)
  Definition left_alone (cs : list case) : list bool :=
    map (fun xc => negb (starts (snd xc)) || match bounds (fst xc) with 0 :: _ => true | _ => false end) (combine xs cs).
End Clocks.

Section Setting.
  Variable S : setting.

  Definition role_of (P : part) (a : nat) : role :=
    match nth a (roles P) Own with
    | Plain c => if timed_atom (news (certified_by P)) (watched P) a then Own else Plain c
    | NewsOf ts => if existsb (Nat.eqb a) (news (certified_by P)) then NewsOf ts else Own
    | Own => Own
    end.
  Definition reads_topic (t c : nat) : bool := existsb (Nat.eqb t) (nth c (read_by S) []).
  (** A property takes a step at each nanosecond, and at each message on a topic that it reads. *)
  Definition hears (P : part) (e : option nat) : bool :=
    match e with
    | None => true
    | Some t => existsb (fun a => match role_of P a with
                                  | Plain c => reads_topic t c
                                  | NewsOf ts => existsb (Nat.eqb t) ts
                                  | Own => false
                                  end) (seq 0 (length (roles P)))
    end.
  Definition is_news (e : option nat) (ts : list nat) : bool :=
    match e with None => false | Some t => existsb (Nat.eqb t) ts end.

  (** The letter of property n, whose atoms are as their roles say, and which its certificate allows. *)
  Definition reads_as (n : nat) (P : part) (i : instant) : Prop :=
    at_letter (assumption (certified_by P)) (own i n) = true /\
    forall a, match role_of P a with
              | Plain c => own i n a = values i c
              | NewsOf ts => own i n a = is_news (event i) ts
              | Own => True
              end.

  Definition judged (v : verdict) (q : nat) (k : clocks) : where_ :=
    match v with Violated => Lost | Satisfied => Done | _ => At q k end.
  Definition in_time (i : instant) : bool := match event i with None => true | Some _ => false end.

  (** From states q and k to w, where the clocks d pass a bound and e are left alone. *)
  Definition moved (n : nat) (P : part) (i : instant) (q : nat) (k : clocks) (w : where_) (d e : some_clocks) : Prop :=
    let M := machine (certified_by P) in
    reads_as n P i /\ exists t q' v k' cs, nth_error (edges M) q = Some t /\ leads M (own i n) t q' /\
      nth_error (verdicts M) q' = Some v /\ clocks_step (news (certified_by P)) (watched P) (in_time i) k (own i n) k' cs /\
      w = judged v q' k' /\ d = numbered n (those_passing (watched P) (states k) cs) /\
      e = numbered n (left_alone (watched P) cs).

  Definition is_own (e : option nat) : bool := match e with Some t => t <? owned S | None => false end.
  (** Whether a property begins, where [c] have left then: what is possible. *)
  Definition beginnings (P : part) (e : option nat) (c : option (list nat)) : list bool :=
    match e, waits P, c with
    | None, _, _ => [false]
    | _, ForSession, _ => [true]
    | _, ForOthers, None => [false; true]
    | _, ForOthers, Some _ => [true]
    | _, ForSent _, None => [false]
    | _, ForSent hs, Some m => [is_own e && forallb (fun o => nth o hs 0 <=? nth o m 0) (seq 0 (owned S))]
    end.
  Definition stays (n : nat) (P : part) (w w' : where_) (d e : some_clocks) : Prop :=
    w' = w /\ d = [] /\ e = match w with At _ _ => numbered n (map (fun _ => true) (watched P)) | _ => [] end.
  Definition part_step (n : nat) (P : part) (i : instant) (c : option (list nat)) (w w' : where_) (d e : some_clocks) : Prop :=
    match w with
    | Waits => exists b : bool, In b (beginnings P (event i) c) /\
        if b then moved n P i 0 (start (watched P)) w' d e else stays n P w w' d e
    | At q k => if hears P (event i) then moved n P i q k w' d e else stays n P w w' d e
    | Done | Lost => stays n P w w' d e
    end.

  (** All properties, numbered from n. Those that are relied on are not violated, but by what the guard itself lets out. *)
  Inductive parts_step (i : instant) (c : option (list nat)) : nat -> list part -> list where_ -> list where_ ->
      some_clocks -> some_clocks -> Prop :=
  | no_part n : parts_step i c n [] [] [] [] []
  | each_part n P Ps w w' ws ws' d ds e es : part_step n P i c w w' d e -> is_own (event i) || is_kept P = true \/ w' <> Lost ->
      parts_step i c (1 + n) Ps ws ws' ds es ->
      parts_step i c n (P :: Ps) (w :: ws) (w' :: ws') (d ++ ds) (e ++ es).

  (** The numbers of messages that matter: up to that of the latest beginning, and at least 1. *)
  Definition most_counted (o : nat) : nat :=
    fold_right (fun P m => match waits P with ForSent hs => max (nth o hs 0) m | _ => m end) 1 (parts S).
  Definition none_left : list nat := map (fun _ => 0) (seq 0 (owned S)).
  Definition one_left (t : nat) (m : list nat) : list nat :=
    map (fun o => min (nth o m 0 + if o =? t then 1 else 0) (most_counted o)) (seq 0 (owned S)).
  Definition phases_after (e : option nat) (c : option (list nat)) : list (option (list nat)) :=
    match e, c with
    | None, _ => [c]
    | Some t, None => if t <? owned S then [] else [None; Some none_left]
    | Some t, Some m => [if t <? owned S then Some (one_left t m) else c]
    end.

  (** What becomes of the conditions: as time goes on, at a message with any content, after a fallback. *)
  Definition hold : nat -> source := fun c => if nth c (loose S) false then Any else As c.
  Definition heard (t : nat) : nat -> source := fun c => if nth c (loose S) false || reads_topic t c then Any else As c.
  Definition topic_of (f : nat) : nat := fst (nth f (fallbacks S) (0, [])).
  Definition sent (f : nat) : nat -> source := fun c =>
    if nth c (loose S) false then Any else
    if reads_topic (topic_of f) c then nth c (snd (nth f (fallbacks S) (0, []))) Any else As c.
  Definition does (s : nat -> source) (l l' : letter) : Prop :=
    forall c, match s c with Is b => l' c = b | As c' => l' c = l c' | Any => True end.

  Definition allowed (i : instant) : Prop := at_values (assumed S) (values i) = true.
  Definition leads_on (e : option nat) (s : nat -> source) (x y : state_of) (d e' : some_clocks) : Prop :=
    event (snd y) = e /\ allowed (snd x) /\ allowed (snd y) /\ does s (values (snd x)) (values (snd y)) /\
    In (phase_of y) (phases_after e (phase_of x)) /\
    parts_step (snd y) (phase_of y) 0 (parts S) (wheres x) (wheres y) d e'.

  (** ** The game *)
  Variable first : option (list nat).
  Definition beginning (x : state_of) : Prop := fst x = (first, map (fun _ => Waits) (parts S)) /\ allowed (snd x).
  Definition message (x y : state_of) : Prop :=
    exists t d e, owned S <= t < topics S /\ leads_on (Some t) (heard t) x y d e.
  Definition command (x y : state_of) : Prop := exists t d e, t < owned S /\ leads_on (Some t) (heard t) x y d e.
  Definition passes (d : some_clocks) (x y : state_of) : Prop := exists e, leads_on None hold x y d e.
  Definition sends (f : nat) (e : some_clocks) (x y : state_of) : Prop :=
    exists d, leads_on (Some (topic_of f)) (sent f) x y d e.
  Definition may_send (f : nat) (x : state_of) : Prop := f < length (fallbacks S) /\ phase_of x <> None.
  Definition bad (x : state_of) : Prop := In Lost (wheres x).

  Definition is_guarded := guarded state_of nat some_clocks beginning message command passes sends.
  Definition is_closed := closed state_of nat (nat * nat) some_clocks (@In _) beginning message passes sends may_send bad.
  Definition steps_by := steps state_of nat some_clocks message command passes sends.

  Lemma steps_lead_on : forall x y, steps_by x y -> exists e s d e', leads_on e s x y d e'.
  Proof.
    intros x y [[(t & d & e & _ & H)|(d & e & H)]|[(t & d & e & _ & H)|(f & e & d & H)]]; eauto 6.
  Qed.
  Lemma bad_for_ever : forall x y, steps_by x y -> bad x -> bad y.
  Proof.
    intros x y H. destruct (steps_lead_on x y H) as (e & s & d & e' & _ & _ & _ & _ & _ & HP). unfold bad.
    induction HP as [|n P Ps w w' ws ws' d ds e1 es HS HK HP IH]; auto. intros [->|HI]; [|right; auto].
    left. now destruct HS.
  Qed.

  (** * What has been read of a property *)
  Section One.
    Variables (n : nat) (P : part).
    Hypothesis HP : nth_error (parts S) n = Some P.
    Let C := certified_by P.
    Let M := machine C.
    Hypothesis HW : watched P = trackers C.

    Definition where_is (x : state_of) : where_ := nth n (wheres x) Waits.
    Definition takes_step (w w' : where_) (e : option nat) : bool :=
      match w, w' with Waits, Waits => false | Waits, _ => true | _, _ => hears P e end.
    Fixpoint has_read (x : nat -> state_of) (m : nat) : list letter :=
      match m with
      | 0 => []
      | Datatypes.S m => has_read x m ++ let y := x (1 + m) in
                         if takes_step (where_is (x m)) (where_is y) (event (snd y)) then [own (snd y) n] else []
      end.

    (** What the monitor and the clocks have to do with these letters. *)
    Definition follows_letters (w : where_) (ls : list letter) : Prop :=
      let reached j q := exists path, begins C (at_step ls) path j /\ reaches M (at_step ls) j q in
      match w with
      | Waits => ls = []
      | At q k => (exists path, begins C (at_step ls) path (length ls) /\ path (length ls) = k) /\
          reaches M (at_step ls) (length ls) q /\
          exists v, nth_error (verdicts M) q = Some v /\ v <> Violated /\ v <> Satisfied
      | Done => exists j q, j <= length ls /\ reached j q /\ nth_error (verdicts M) q = Some Satisfied
      | Lost => True
      end.

    Lemma reaches_more : forall ls more m q, m <= length ls -> reaches M (at_step ls) m q ->
      reaches M (at_step (ls ++ more)) m q.
    Proof.
      intros ls more m q Hm. apply reaches_same. intros k a Hk. unfold at_step. now rewrite app_nth1 by lia.
    Qed.
    Lemma begins_more : forall ls more path m, m <= length ls -> begins C (at_step ls) path m ->
      begins C (at_step (ls ++ more)) path m.
    Proof.
      intros ls more path m Hm [H0 H]. split; auto. intros k Hk. unfold at_step. rewrite app_nth1 by lia. exact (H k Hk).
    Qed.

    Lemma one_more : forall ls i q k w d e,
      (exists path, begins C (at_step ls) path (length ls) /\ path (length ls) = k) -> reaches M (at_step ls) (length ls) q ->
      moved n P i q k w d e -> follows_letters w (ls ++ [own i n]).
    Proof.
      intros ls i q k w d e (path & HB & HK) HR ((HA & _) & t & q' & v & k' & cs & HT & HL & HV & HC & -> & _).
      set (ls' := ls ++ [own i n]). fold C M in HT, HL, HV, HA, HC. rewrite HW in HC.
      assert (EL : length ls' = 1 + length ls) by (unfold ls'; rewrite app_length; simpl; lia).
      assert (EN : at_step ls' (length ls) = own i n) by (unfold at_step, ls'; now rewrite nth_middle).
      assert (HR' : reaches M (at_step ls') (length ls') q').
      { rewrite EL. econstructor; [apply reaches_more; [reflexivity | exact HR] | exact HT | now rewrite EN]. }
      destruct (clocks_step_moves _ _ _ _ _ _ _ HC) as (m & Hm).
      assert (HB' : begins C (at_step ls') (fun j => if j <=? length ls then path j else k') (length ls')).
      { destruct (begins_more ls [own i n] path (length ls) (le_n _) HB) as [B0 B1]. fold ls' in B1. split; auto.
        rewrite EL. intros j Hj. destruct (Nat.eq_dec j (length ls)) as [->|Hne].
        - rewrite EN, Nat.leb_refl, (proj2 (Nat.leb_gt _ _)) by lia. rewrite HK. eauto.
        - rewrite !(proj2 (Nat.leb_le _ _)) by lia. apply B1. lia. }
      assert (HE : (fun j => if j <=? length ls then path j else k') (length ls') = k').
      { cbv beta. rewrite EL, (proj2 (Nat.leb_gt _ _)) by lia. reflexivity. }
      destruct v; simpl; auto.
      - split; [eauto|]. split; auto. exists PresumablyViolated. repeat split; auto; discriminate.
      - split; [eauto|]. split; auto. exists PresumablySatisfied. repeat split; auto; discriminate.
      - exists (length ls'), q'. split; auto. split; eauto.
    Qed.

    Lemma part_follows : forall ls i c w w' d e, follows_letters w ls -> part_step n P i c w w' d e ->
      follows_letters w' (ls ++ if takes_step w w' (event i) then [own i n] else []).
    Proof.
      intros ls i c w w' d e HF HS. destruct w as [|q k| |]; simpl in HS.
      - destruct HS as ([] & _ & HS).
        + simpl in HF. subst ls. assert (HT : takes_step Waits w' (event i) = true).
          { destruct HS as (_ & t & q' & v & k' & cs & _ & _ & _ & _ & -> & _). now destruct v. }
          rewrite HT. apply (one_more [] i 0 (start (watched P)) w' d e); auto; [|constructor].
          exists (fun _ => start (trackers C)). rewrite HW. split; auto. split; auto. intros k Hk. simpl in Hk. lia.
        + destruct HS as [-> _]. simpl. now rewrite app_nil_r.
      - destruct HF as (HB & HR & HV). unfold takes_step. destruct (hears P (event i)).
        + now apply (one_more ls i q k w' d e).
        + destruct HS as [-> _]. rewrite app_nil_r. split; auto.
      - destruct HS as [-> _]. destruct HF as (j & q & HJ & (path & HB & HR) & HV). exists j, q. rewrite app_length.
        split; [lia|]. split; auto. exists path. auto using begins_more, reaches_more.
      - destruct HS as [-> _]. exact I.
    Qed.

    Lemma parts_step_at : forall i c m Ps ws ws' d e, parts_step i c m Ps ws ws' d e -> forall j Q,
      nth_error Ps j = Some Q -> exists d' e', part_step (m + j) Q i c (nth j ws Waits) (nth j ws' Waits) d' e'.
    Proof.
      intros i c m Ps ws ws' d e H. induction H as [|m Q Qs w w' ws ws' d ds e es HS HK H IH]; intros [|j] R HJ;
        try discriminate.
      - injection HJ as <-. rewrite Nat.add_0_r. eauto.
      - replace (m + Datatypes.S j) with (1 + m + j) by lia. now apply IH.
    Qed.

    Lemma has_read_follows : forall x m, beginning (x 0) -> (forall j, j < m -> steps_by (x j) (x (1 + j))) ->
      follows_letters (where_is (x m)) (has_read x m).
    Proof.
      intros x m [HB _] HS. induction m as [|m IH].
      - unfold where_is, wheres. rewrite HB. simpl. change Waits with ((fun _ : part => Waits) P) at 2.
        rewrite map_nth. reflexivity.
      - destruct (steps_lead_on _ _ (HS m (Nat.lt_succ_diag_r m))) as (e & s & d & e' & _ & _ & _ & _ & _ & HD).
        destruct (parts_step_at _ _ _ _ _ _ _ _ HD n P HP) as (d' & e2 & HT).
        exact (part_follows _ _ _ _ _ _ _ (IH (fun j Hj => HS j (Nat.lt_lt_succ_r _ _ Hj))) HT).
    Qed.

    Variables (depth work : nat).
    Hypothesis HC : check depth work C = true.
    Variable R : region state_of nat some_clocks.
    Hypothesis HR : is_closed R.

    Lemma satisfied_stays : forall s j q, reaches M s j q -> nth_error (verdicts M) q = Some Satisfied ->
      forall i, exists q', reaches M s (i + j) q' /\ nth_error (verdicts M) q' = Some Satisfied.
    Proof.
      intros s j q HQ HV i. destruct (accepted depth work C HC) as (_ & HA & _).
      induction i as [|i (r & IH1 & IH2)]; [eauto|]. destruct (HA r Satisfied IH2) as (v & t & V1 & V2 & V3).
      fold M in V1. rewrite IH2 in V1. injection V1 as <-. destruct V3 as (r' & -> & V3). exists r'. split; auto.
      econstructor; eauto. constructor.
    Qed.

    Lemma guarded_follows : forall x m, is_guarded R x m -> forall j, j <= m ->
      follows_letters (where_is (x j)) (has_read x j) /\ where_is (x j) <> Lost.
    Proof.
      intros x m HG j Hj. destruct (guarded_steps _ _ _ _ _ _ _ _ _ x m HG) as [HB HS]. split.
      - apply has_read_follows; auto. intros k Hk. apply HS. lia.
      - destruct (guarded_well _ _ _ _ _ _ _ _ _ _ _ _ _ bad_for_ever HR x m HG) as [_ HX]. intros HL.
        apply (HX j Hj). unfold bad. unfold where_is in HL. rewrite <- HL. apply nth_In.
        destruct (le_lt_dec (length (wheres (x j))) n) as [HN|HN]; auto.
        rewrite nth_overflow in HL by exact HN. discriminate.
    Qed.

    (** After every prefix of what leaves the guard, the monitor shows another verdict than 'violated'. *)
    Theorem guarded_verdict : forall x m, is_guarded R x m -> forall j, j <= m ->
      let ls := has_read x j in ls <> [] ->
      exists q v, reaches M (at_step ls) (length ls) q /\ nth_error (verdicts M) q = Some v /\ v <> Violated.
    Proof.
      intros x m HG j Hj ls HN. destruct (guarded_follows x m HG j Hj) as [HF HL]. fold ls in HF.
      destruct (where_is (x j)) as [|q k| |]; try contradiction.
      - destruct HF as (_ & HR' & v & HV & N1 & _). eauto.
      - destruct HF as (i & q & HI & (path & _ & HR') & HV).
        destruct (satisfied_stays _ _ _ HR' HV (length ls - i)) as (q' & Q1 & Q2).
        replace (length ls - i + i) with (length ls) in Q1 by lia. exists q', Satisfied. repeat split; auto; discriminate.
    Qed.

    (** So none violates the property: if a word goes on from it at all, one satisfies it. *)
    Theorem guarded_not_violated : exact C = true -> forall x m, is_guarded R x m -> forall j, j <= m ->
      let ls := has_read x j in ls <> [] ->
      (exists s, continues C (at_step ls) (length ls) s) ->
      exists s, continues C (at_step ls) (length ls) s /\ holds_for_ever C s.
    Proof.
      intros HE x m HG j Hj ls HN (s0 & H0). destruct (guarded_follows x m HG j Hj) as [HF HL]. fold ls in HF.
      destruct (where_is (x j)) as [|q k| |]; try contradiction.
      - destruct HF as ((path & HB & _) & HR' & v & HV & N1 & N2).
        destruct (check_exactly depth work C HC HE _ path (length ls) HB) as (q' & v' & Q1 & Q2 & Q3 & Q4).
        rewrite (reaches_unique M _ _ _ _ HR' Q1) in HV. unfold M in HV. rewrite HV in Q2. injection Q2 as <-.
        destruct v; try contradiction; now destruct (Q4 Q3).
      - destruct HF as (i & q & HI & (path & HB & HR') & HV).
        destruct (check_sound depth work C HC _ path i HB) as (q' & v' & Q1 & Q2 & Q3).
        rewrite (reaches_unique M _ _ _ _ HR' Q1) in HV. unfold M in HV. rewrite HV in Q2. injection Q2 as <-.
        exists s0. split; auto. apply (Q3 s0). destruct H0 as [H1 H2]. split; auto. intros k Hk. apply H2. lia.
    Qed.
  End One.
End Setting.
