(** Trackers: how the atoms of time and of the past follow, instant by instant, from a state and at most one clock;
    and that in every run each tracker always has a case that fits ([tracker_follows]).

    [cases] is the whole definition of a tracker: what may happen at an instant. A run with times takes the case
    that its clock tells; the reset machine ([Resets.v]), which knows no times, may take each of them.
    Python: [ltlc/semantics/trackers.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers.

Inductive phase :=
| Idle        (* nothing is timed *)
| First       (* nothing has been read yet *)
| Running     (* time is counted *)
| Held        (* what it counts from holds still *)
| Forever.    (* what it waited for has come, and no clock takes that back *)

(** A phase, and how many bounds have passed on the clock. *)
Definition state : Type := phase * nat.
Definition idle : state := (Idle, 0).
Definition started : state := (Running, 0).
Definition held : state := (Held, 0).
Definition forever : state := (Forever, 0).

(** Of a scope at an instant: whether it is open, and whether it opens there. *)
Definition openness : Type := bool * bool.
Definition closed : openness := (false, false).

(** Where [guard] holds and [passed] bounds have passed (None: in any case), the atoms of the tracker are [holding].
    [starts] says that the clock is at 0; [opened_to] is the scope that the clock measures. *)
Record case := {
  guard : predicate; holding : list bool; next : state; passed : option nat; starts : bool; opened_to : openness
}.

(** What is followed: an operator of the past, or a clock. *)
Inductive subject := Follows (o : past) | Measures (cl : clock).

(** The tracker of an atom of the past, or of a clock with all its bounds, in ascending order, and an atom for each. *)
Record tracker_of := { about : subject; decides : list nat; bounds : list nat }.

Definition initial (x : tracker_of) : state :=
  match about x with Follows (Historically _ _) | Follows (Age _ _) => (First, 0) | _ => idle end.

Definition is_running (x : tracker_of) (st : state) : bool :=
  match st with (Running, n) => n <? length (bounds x) | _ => false end.

(** The first n of the atoms hold. *)
Definition first_of (x : tracker_of) (n : nat) : list bool := map (fun i => i <? n) (seq 0 (length (decides x))).
Definition all_but (x : tracker_of) (n : nat) : list bool := map (fun i => negb (i <? n)) (seq 0 (length (decides x))).
Definition none_of (x : tracker_of) : list bool := first_of x 0.
Definition all_of (x : tracker_of) : list bool := all_but x 0.

Section Cases.
  Variable x : tracker_of.

  (** The tracker is at rest, or where no clock decides. *)
  Definition at_once (g : predicate) (h : list bool) (st : state) : case :=
    {| guard := g; holding := h; next := st; passed := None; starts := false; opened_to := closed |}.
  Definition starting (g : predicate) (h : list bool) (st : state) (o : openness) : case :=
    {| guard := g; holding := h; next := st; passed := None; starts := true; opened_to := o |}.
  Definition in_time (g : predicate) (h : list bool) (st : state) (n : nat) (o : openness) : case :=
    {| guard := g; holding := h; next := st; passed := Some n; starts := false; opened_to := o |}.

  (** Clock steps come before a second bound could pass. *)
  Definition may_have_passed (st : state) : list nat :=
    if snd st <? length (bounds x) then [snd st; S (snd st)] else [snd st].

  Definition held_case (g : predicate) : case :=
    match bounds x with [] => at_once g (all_of x) forever | _ => starting g (all_of x) held closed end.
  Definition once_cases (g : predicate) (st : state) : list case :=
    match fst st with
    | Forever => [at_once g (all_of x) forever]
    | Held => [in_time g (all_of x) started 0 closed]
    | Running => [in_time g (all_of x) started 0 closed; in_time g (none_of x) idle 1 closed]
    | _ => [at_once g (none_of x) idle]
    end.
  Definition running_cases (g : predicate) (st : state) (o : openness) : list case :=
    map (fun n => in_time g (first_of x n) (Running, n) n o) (may_have_passed st).
  Definition historically_cases (p : predicate) (st : state) : list case :=
    match bounds x with
    | [] => match fst st with
            | First | Forever => [at_once p (all_of x) forever]
            | _ => [at_once p (none_of x) idle]
            end
    | _ => match fst st with
           | Running => running_cases p st closed
           | _ => [starting p (none_of x) started closed]
           end
    end.
  Definition scope_cases (opens : predicate) (closes : option predicate) (st : state) (around : openness) : list case :=
    let opening := [starting opens (none_of x) started (true, true); at_once (PNot opens) (none_of x) idle] in
    match fst st with
    | Running => if snd around then opening else
                 match closes with
                 | None => running_cases PTruth st (true, false)
                 | Some y => running_cases (PNot y) st (true, false) ++ [at_once y (none_of x) idle]
                 end
    | _ => opening
    end.
  Definition until_cases (y : predicate) (st : state) (around : openness) : list case :=
    if negb (snd around) && match fst st with Running => false | _ => true end then [at_once PTruth (none_of x) idle]
    else [at_once y (none_of x) idle;
          {| guard := PNot y; holding := none_of x; next := started; passed := None; starts := false;
            opened_to := (true, snd around) |}].
  Definition first_open_cases (p q : predicate) (st : state) : list case :=
    match fst st with
    | Running => map (fun n => in_time q (first_of x n) idle n closed) (may_have_passed st) ++ running_cases (PNot q)
      st closed
    | _ => let opens := PAnd p (PNot q) in
           [starting opens (none_of x) started closed; at_once (PNot opens) (none_of x) idle]
    end.
  Definition last_trigger_cases (p : predicate) (st : state) : list case :=
    starting p (none_of x) held closed ::
    match fst st with
    | Held => [in_time (PNot p) (none_of x) started 0 closed]
    | Running => running_cases (PNot p) st closed
    | _ => [at_once (PNot p) (none_of x) idle]
    end.

  Definition afresh (around : openness) (st : state) : state := if snd around then idle else st.

  Definition cases (st : state) (around : openness) : list case :=
    match about x with
    | Follows (Previously p) =>
        let h := match fst st with Forever => all_of x | _ => none_of x end in [at_once p h forever;
          at_once (PNot p) h idle]
    | Follows (Once _ p) => held_case p :: once_cases (PNot p) st
    | Follows (Historically _ p) => historically_cases p st ++ [at_once (PNot p) (none_of x) idle]
    | Follows (Since _ p q) => held_case q :: once_cases (PAnd (PNot q) p) st ++ [at_once (PAnd (PNot q) (PNot p))
      (none_of x) idle]
    | Follows (Age _ p) => starting p (all_of x) started closed ::
                           map (fun n => in_time (PNot p) (all_but x n) (Running, n) n closed) (may_have_passed st)
    | Measures (SinceOpening WholeRun) => scope_cases PTruth None st around
    | Measures cl =>
        if negb (fst around) then [at_once PTruth (none_of x) idle] else
        match cl with
        | SinceOpening WholeRun => []
        | SinceOpening (AfterEvent _ p) => scope_cases p None st around
        | SinceOpening (BeforeEvent _ p) => until_cases p st around
        | SinceOpening (Episodes _ p q) => scope_cases (PAnd p (PNot q)) (Some q) st around
        | FirstOpen _ p q => first_open_cases p q (afresh around st)
        | LastTrigger _ p => last_trigger_cases p (afresh around st)
        end
    end.
End Cases.

(** * How many bounds have passed *)

Fixpoint count (bs : list nat) (from now : nat) : nat :=
  match bs with [] => 0 | d :: bs => if from + d <? now then S (count bs from now) else 0 end.

(** Bounds ascend. *)
Fixpoint ascending (d : nat) (bs : list nat) : Prop := match bs with [] => True | e :: bs => d < e /\
  ascending e bs end.
Definition rising (bs : list nat) : Prop := match bs with [] => True | d :: bs => ascending d bs end.

Lemma ascending_rising : forall bs d, ascending d bs -> rising bs.
Proof. destruct bs; simpl; tauto. Qed.

Lemma ascending_all : forall bs d, ascending d bs -> forall e, In e bs -> d < e.
Proof.
  induction bs as [|b bs IH]; simpl; intros d H e He; [destruct He|]. destruct H as [H1 H2], He as [<-|He]; auto.
  specialize (IH b H2 e He). lia.
Qed.

Lemma count_none : forall bs d from now, ascending d bs -> now <= from + S d -> count bs from now = 0.
Proof.
  intros [|b bs] d from now H Hn; simpl; auto. destruct H as [H _]. destruct (Nat.ltb_spec (from + b) now); auto; lia.
Qed.
Lemma count_now : forall bs now, count bs now now = 0.
Proof. intros [|b bs] now; simpl; auto. destruct (Nat.ltb_spec (now + b) now); auto; lia. Qed.

Lemma count_most : forall bs from now, count bs from now <= length bs.
Proof. induction bs as [|b bs IH]; simpl; intros from now; auto. destruct (_ <? _); [apply le_n_S; auto | lia]. Qed.

Lemma count_step : forall bs from now now', rising bs -> now <= now' <= S now ->
  count bs from now' = count bs from now \/ (count bs from now' = S (count bs from now) /\ now < now').
Proof.
  induction bs as [|b bs IH]; intros from now now' HA Hn; simpl; auto. simpl in HA.
  destruct (Nat.ltb_spec (from + b) now), (Nat.ltb_spec (from + b) now'); auto; try lia.
  - destruct (IH from now now' (ascending_rising _ _ HA) Hn) as [-> | [-> E]]; auto.
  - right. split; [|lia]. f_equal. apply (count_none bs b); auto. lia.
Qed.

Lemma count_nth : forall bs from now i, rising bs -> i < length bs ->
  (from + nth i bs 0 <? now) = (i <? count bs from now).
Proof.
  induction bs as [|b bs IH]; intros from now i HA Hi; simpl in Hi; [lia|]. simpl in HA. cbn [count].
  destruct (Nat.ltb_spec (from + b) now) as [H|H].
  - destruct i as [|i]; cbn [nth]; [now apply Nat.ltb_lt|]. rewrite IH by (eauto using ascending_rising; lia).
  reflexivity.
  - apply Nat.ltb_ge. destruct i as [|i]; cbn [nth]; auto.
    pose proof (ascending_all bs b HA (nth i bs 0)) as HB. specialize (HB ltac:(apply nth_In; lia)). lia.
Qed.

(** * A run, and the tracker on it *)
Section Run.
  Variables (e : stream) (t : times) (began : nat).
  Hypothesis Ht : passing t.
  (** Every nanosecond has an instant. *)
  Hypothesis dense : forall k, t (S k) <= S (t k).

  Definition open_at (o : scope) (k : nat) : openness :=
    match scope_tracker o e k with None => closed | Some a => (true, a =? k) end.

  (** The scope around a tracker; around the whole run there is an open one, which opens at the first instant. *)
  Definition outer (s : subject) : option scope :=
    match s with
    | Follows _ | Measures (SinceOpening WholeRun) => None
    | Measures (SinceOpening (AfterEvent o _)) | Measures (SinceOpening (BeforeEvent o _))
    | Measures (SinceOpening (Episodes o _ _)) | Measures (FirstOpen o _ _) | Measures (LastTrigger o _) => Some o
    end.
  Definition around (s : subject) (k : nat) : openness :=
    match outer s with None => (true, k =? 0) | Some o => open_at o k end.

  (** What the tracker remembers after instant k. *)
  Definition counting (x : tracker_of) (r : option nat) (k : nat) : state :=
    match r with None => idle | Some j => (Running, count (bounds x) (t j) (t k)) end.
  Definition once_state (x : tracker_of) (now : bool) (r : option nat) (k : nat) : state :=
    match r, bounds x with
    | None, _ => idle
    | Some _, [] => forever
    | Some j, d :: _ => if now then held else if t j + d <? t k then idle else started
    end.
  Definition after (x : tracker_of) (k : nat) : state :=
    let at_ p j := at_letter p (e j) in
    match about x with
    | Follows (Previously p) => if at_ p k then forever else idle
    | Follows (Once _ p) => once_state x (at_ p k) (latest (at_ p) k) k
    | Follows (Historically _ p) =>
        match bounds x with
        | [] => if every_instant 0 k (at_ p) then forever else idle
        | _ => counting x (since_when (at_ p) k) k
        end
    | Follows (Since _ p q) => once_state x (at_ q k) (kept_since (at_ p) (at_ q) k) k
    | Follows (Age _ p) => match latest (at_ p) k with
                           | Some j => (Running, count (bounds x) (t j) (t k))
                           | None => (Running, count (bounds x) began (t k))
                           end
    | Measures (SinceOpening o) => counting x (scope_tracker o e k) k
    | Measures (FirstOpen o p q) => counting x (register (episode p q e) (scope_tracker o e) k) k
    | Measures (LastTrigger o p) =>
        match register (trigger p e) (scope_tracker o e) k with
        | None => idle
        | Some j => if at_ p k then held else (Running, count (bounds x) (t j) (t k))
        end
    end.
  Definition before_instant (x : tracker_of) (k : nat) : state := match k with 0 => initial x | S j => after x j end.

  (** The time from which it counts. *)
  Definition base (x : tracker_of) (k : nat) : nat :=
    let at_ p j := at_letter p (e j) in
    let time r := match r with Some j => t j | None => began end in
    match about x with
    | Follows (Previously _) => began
    | Follows (Once _ p) | Follows (Age _ p) => time (latest (at_ p) k)
    | Follows (Historically _ p) => time (since_when (at_ p) k)
    | Follows (Since _ p q) => time (kept_since (at_ p) (at_ q) k)
    | Measures (SinceOpening o) => time (scope_tracker o e k)
    | Measures (FirstOpen o p q) => time (register (episode p q e) (scope_tracker o e) k)
    | Measures (LastTrigger o p) => time (register (trigger p e) (scope_tracker o e) k)
    end.

  (** The letters show what the tracker decides, and its bounds are those of what it follows. *)
  Definition well_formed (x : tracker_of) : Prop :=
    match about x with
    | Follows o => exists a, decides x = [a] /\ (forall k, e k a = value e t began o k) /\
        match o with
        | Previously _ => bounds x = []
        | Once None _ | Historically None _ | Since None _ _ => bounds x = []
        | Once (Some d) _ | Since (Some d) _ _ => bounds x = [d] /\ 0 < d
        | Historically (Some d) _ => bounds x = [d - 1] /\ 0 < d
        | Age d _ => bounds x = [d]
        end
    | Measures cl => length (decides x) = length (bounds x) /\ rising (bounds x) /\ ~ In 0 (bounds x) /\
        (forall i k, i < length (bounds x) ->
          e k (nth i (decides x) 0) = older t (nth i (bounds x) 0) (counts_from cl e k) k) /\
        match cl with SinceOpening (BeforeEvent _ _) => bounds x = [] | _ => True end
    end.

  (** A case that starts the clock counts from now; one that runs on, from where it did. *)
  Definition runs_from (x : tracker_of) (k : nat) (c : case) : Prop :=
    is_running x (next c) = true ->
    if starts c then base x k = t k else forall m, k = S m -> base x (S m) = base x m.

  (** A case that fits an instant: of its letter, of the tracker's atoms, of its state and its scope; bounds pass
      when they have passed, and only when time does. *)
  Definition fits (x : tracker_of) (k : nat) (c : case) : Prop :=
    at_letter (guard c) (e k) = true /\
    (forall i, i < length (decides x) -> e k (nth i (decides x) 0) = nth i (holding c) false) /\
    next c = after x k /\
    (match about x with Measures (SinceOpening o) => opened_to c = open_at o k | _ => True end) /\
    (forall n, is_running x (before_instant x k) = true -> passed c = Some n -> exists j, k = S j /\
       n = count (bounds x) (base x j) (t k) /\ (snd (before_instant x k) < n -> t j < t k)) /\
    runs_from x k c.

  (** ** What is needed of each tracker *)

  Lemma nth_table : forall (f : nat -> bool) n i, i < n -> nth i (map f (seq 0 n)) false = f i.
  Proof.
    intros f n i Hi. rewrite (nth_indep _ false (f 0)) by now rewrite map_length, seq_length.
    rewrite (map_nth f (seq 0 n) 0 i), seq_nth by auto. reflexivity.
  Qed.

  (** A clock that runs: at the next instant, as many bounds have passed or one more, and then time has. *)
  Lemma runs_on : forall x from k, rising (bounds x) ->
    In (count (bounds x) from (t (S k))) (may_have_passed x (Running, count (bounds x) from (t k))) /\
    (count (bounds x) from (t k) < count (bounds x) from (t (S k)) -> t k < t (S k)).
  Proof.
    intros x from k HR. unfold may_have_passed. simpl. pose proof (count_most (bounds x) from (t (S k))) as HM.
    pose proof (Ht k (S k)) as H1. pose proof (dense k) as H2.
    destruct (count_step (bounds x) from (t k) (t (S k)) HR ltac:(lia)) as [E | [E F]]; rewrite E in *.
    - split; [destruct (_ <? _); simpl; auto | lia].
    - split; auto. destruct (Nat.ltb_spec (count (bounds x) from (t k)) (length (bounds x))) as [H|H]; simpl; auto; lia.
  Qed.

  (** The register of a scope, from the one before. *)
  Lemma before_open : forall f o k, before f (scope_tracker o e) k =
    match open_at o k, k with (true, false), S j => register f (scope_tracker o e) j | _, _ => None end.
  Proof.
    intros f o k. unfold before, open_at, closed. pose proof (scope_backward o e k) as HB.
    destruct (scope_tracker o e k) as [a|]; auto. specialize (HB a eq_refl).
    destruct k as [|j]; [now destruct (a =? 0)|]. destruct (Nat.eqb_spec a (S j)), (Nat.leb_spec a j); auto; lia.
  Qed.

  (** A clock's atoms, where its register is r. *)
  Lemma clock_atoms : forall x cl r k, about x = Measures cl -> well_formed x -> counts_from cl e k = r ->
    forall i, i < length (decides x) -> e k (nth i (decides x) 0) =
      nth i (first_of x (match r with Some j => count (bounds x) (t j) (t k) | None => 0 end)) false.
  Proof.
    intros x cl r k Ha HW Hr i Hi. unfold well_formed in HW. rewrite Ha in HW. destruct HW as (H1 & H2 & H3 & H4 & _).
    unfold first_of. rewrite nth_table, H4, Hr by lia. destruct r as [j|]; simpl; [apply count_nth; auto;
      lia | reflexivity].
  Qed.

  (** ** Clocks *)
  Lemma starts_afresh : forall x k c, starts c = true -> base x k = t k -> runs_from x k c.
  Proof. intros x k c H1 H2 _. now rewrite H1. Qed.
  Lemma does_not_run : forall x k c, is_running x (next c) = false -> runs_from x k c.
  Proof. intros x k c H H'. congruence. Qed.
  Lemma no_bounds : forall x st, bounds x = [] -> is_running x st = false.
  Proof. intros x [[] n] H; simpl; auto. now rewrite H. Qed.
  Hint Resolve starts_afresh does_not_run : core.

  Section Clock.
    Variables (x : tracker_of) (cl : clock).
    Hypothesis is_clock : about x = Measures cl.
    Hypothesis HW : well_formed x.

    Definition scope_shown (k : nat) (c : case) : Prop :=
      match cl with SinceOpening o => opened_to c = open_at o k | _ => True end.

    (** A case in which no clock passes a bound. *)
    Lemma fits_at_rest : forall k c, at_letter (guard c) (e k) = true -> next c = after x k ->
      holding c = none_of x -> counts_from cl e k = None \/ (exists j, counts_from cl e k = Some j /\ t j = t k) ->
      scope_shown k c -> passed c = None -> runs_from x k c -> fits x k c.
    Proof.
      intros k c Hg Hn Hh Hr Hs Hp Hb. unfold fits. rewrite is_clock, Hh. split; auto.
      split; [|repeat split; auto; congruence].
      intros i Hi. destruct Hr as [Hr|(j & Hr & E)]; rewrite (clock_atoms x cl _ k is_clock HW Hr i Hi); auto.
      now rewrite E, count_now.
    Qed.

    (** The clock runs on. *)
    Lemma fits_running : forall m j g st o, let k := S m in counts_from cl e k = Some j -> base x m = t j ->
      before_instant x k = (Running, count (bounds x) (t j) (t m)) -> at_letter g (e k) = true ->
      scope_shown k (in_time g (first_of x (count (bounds x) (t j) (t k))) st (count (bounds x) (t j) (t k)) o) ->
        st = after x k -> runs_from x k (in_time g [] st 0 o) ->
      In (count (bounds x) (t j) (t k)) (may_have_passed x (before_instant x k)) /\
      fits x k (in_time g (first_of x (count (bounds x) (t j) (t k))) st (count (bounds x) (t j) (t k)) o).
    Proof.
      intros m j g st o k Hr Hm Hb Hg Hs Hn HF. subst k. assert (HR : rising (bounds x)).
      { unfold well_formed in HW. rewrite is_clock in HW. tauto. }
      destruct (runs_on x (t j) m HR) as [H1 H2]. rewrite Hb. split; auto. unfold fits. rewrite is_clock, Hb. simpl.
      split; auto.
      split; [intros i Hi; now apply (clock_atoms x cl (Some j) (S m) is_clock HW Hr i Hi)|]. split; auto.
      split; [exact Hs|].
      split; [|exact HF]. intros n _ E. injection E as <-. exists m. rewrite Hm. auto.
    Qed.

    Lemma in_running : forall g st o n, In n (may_have_passed x st) ->
      In (in_time g (first_of x n) (Running, n) n o) (running_cases x g st o).
    Proof. intros g st o n H. unfold running_cases. apply in_map_iff. eauto. Qed.
  End Clock.

  Lemma open_fresh : forall o k a, scope_tracker o e k = Some a -> open_at o k = (true, a =? k).
  Proof. intros o k a H. unfold open_at. now rewrite H. Qed.

  (** A scope that opens with one predicate, and closes with another or not at all. *)
  Lemma scope_follows : forall x o f opens closes k r, about x = Measures (SinceOpening o) -> well_formed x ->
    (forall k, scope_tracker o e k = match around (about x) k with
                                     | (false, _) => None
                                     | (true, _) => f (match around (about x) k, k with (_, false),
                                       S j => scope_tracker o e j | _, _ => None end) k
                                     end) ->
    (forall j k, f (Some j) k = match closes with Some y => if at_letter y (e k) then None else Some j | None => Some j
      end) ->
    (forall k, f None k = if at_letter opens (e k) then Some k else None) ->
    around (about x) k = (true, r) ->
    exists c, In c (scope_cases x opens closes (before_instant x k) (around (about x) k)) /\ fits x k c.
  Proof.
    intros x o f opens closes k r Ha HW Hf H1 H2 Hr. pose proof (Hf k) as Hk. rewrite Hr in Hk.
    assert (HO : scope_tracker o e k = f None k -> exists c,
      In c [starting opens (none_of x) started (true, true); at_once (PNot opens) (none_of x) idle] /\ fits x k c).
    { intros E. rewrite H2 in E. destruct (at_letter opens (e k)) eqn:Eo.
      - eexists. split; [left; reflexivity|]. apply (fits_at_rest x (SinceOpening o)); auto.
        + unfold after. rewrite Ha, E. simpl. now rewrite count_now.
        + right. exists k. auto.
        + unfold scope_shown. simpl. now rewrite (open_fresh o k k E), Nat.eqb_refl.
        + apply starts_afresh; auto. unfold base. now rewrite Ha, E.
      - eexists. split; [right; left; reflexivity|]. apply (fits_at_rest x (SinceOpening o)); auto.
        + simpl. now rewrite Eo.
        + unfold after. now rewrite Ha, E.
        + unfold scope_shown, open_at. simpl. now rewrite E. }
    rewrite Hr. unfold scope_cases. simpl snd. destruct r.
    { destruct (fst (before_instant x k)); apply HO; rewrite Hk; destruct k; reflexivity. }
    destruct k as [|m]; [unfold before_instant, initial; rewrite Ha; apply HO; exact Hk|].
    assert (Hb : before_instant x (S m) = counting x (scope_tracker o e m) m) by (simpl; unfold after; now rewrite Ha).
    rewrite Hb. destruct (scope_tracker o e m) as [j|] eqn:Ej; [|apply HO; exact Hk]. simpl in Hb. simpl fst.
    rewrite H1 in Hk.
    pose proof (scope_backward o e m j Ej) as Hj.
    assert (HR : forall g, at_letter g (e (S m)) = true -> scope_tracker o e (S m) = Some j ->
              exists c, In c (running_cases x g (Running, count (bounds x) (t j) (t m)) (true, false)) /\
                fits x (S m) c).
    { intros g Hg Es.
      destruct (fits_running x (SinceOpening o) Ha HW m j g (Running, count (bounds x) (t j) (t (S m))) (true,
        false)) as [A B]; auto.
      - unfold base. now rewrite Ha, Ej.
      - unfold scope_shown. simpl. rewrite (open_fresh o (S m) j Es). destruct (Nat.eqb_spec j (S m)); auto; lia.
      - unfold after. now rewrite Ha, Es.
      - intros _ m' E. injection E as <-. unfold base. now rewrite Ha, Es, Ej.
      - eexists. split; [|exact B]. apply in_running. now rewrite <- Hb. }
    destruct closes as [y|]; [destruct (at_letter y (e (S m))) eqn:Ey|].
    - eexists. split; [apply in_app_iff; right; left; reflexivity|]. apply (fits_at_rest x (SinceOpening o)); auto.
      + unfold after. now rewrite Ha, Hk.
      + unfold scope_shown, open_at. simpl. now rewrite Hk.
    - destruct (HR (PNot y)) as (c & A & B); auto; [simpl; now rewrite Ey|]. exists c. split; auto.
    apply in_app_iff; auto.
    - apply HR; auto.
  Qed.

  Lemma register_around : forall f o k, register f (scope_tracker o e) k =
    match open_at o k with
    | (false, _) => None
    | (true, _) => f (match open_at o k, k with (_, false), S j => register f (scope_tracker o e) j | _,
      _ => None end) k
    end.
  Proof.
    intros f o k. rewrite register_eq, before_open. unfold open_at. destruct (scope_tracker o e k) as [a|]; auto.
  Qed.

  Lemma around_open : forall o k r, open_at o k = (true, r) -> exists a, scope_tracker o e k = Some a /\ r = (a =? k).
  Proof. unfold open_at, closed. intros o k r H. destruct (scope_tracker o e k) as [a|]; [|congruence].
  injection H as <-. eauto. Qed.

  Lemma until_follows : forall x o p k r, about x = Measures (SinceOpening (BeforeEvent o p)) -> well_formed x ->
    open_at o k = (true, r) ->
    exists c, In c (until_cases x p (before_instant x k) (true, r)) /\ fits x k c.
  Proof.
    intros x o p k r Ha HW Hr. set (g := uncut p e (scope_tracker o e)).
    assert (HB : bounds x = []) by (unfold well_formed in HW; rewrite Ha in HW; tauto).
    assert (HC : forall q m, counting x q m = match q with Some _ => started | None => idle end).
    { intros [j|] m; simpl; auto. now rewrite HB. }
    assert (HA : forall m, after x m = match register g (scope_tracker o e) m with Some _ => started | None => idle
      end).
    { intros m. unfold after. rewrite Ha. apply HC. }
    assert (HK : register g (scope_tracker o e) k = if at_letter p (e k) then None else
                   if r then Some k else match k with S j => register g (scope_tracker o e) j | 0 => None end).
    { rewrite register_around, Hr. unfold g at 1, uncut. destruct (around_open o k r Hr) as (a & -> & ->).
      destruct (at_letter p (e k)), (a =? k), k; reflexivity. }
    assert (HF : forall c, at_letter (guard c) (e k) = true -> next c = after x k -> holding c = none_of x ->
              opened_to c = open_at (BeforeEvent o p) k -> passed c = None -> fits x k c).
    { intros c H1 H2 H3 H4 H5. unfold fits. rewrite Ha, H3. split; auto.
    split; [|repeat split; auto; [congruence | now apply does_not_run, no_bounds]].
      intros i Hi. unfold well_formed in HW. rewrite Ha, HB in HW. simpl in HW. lia. }
    assert (HO : open_at (BeforeEvent o p) k =
                 match register g (scope_tracker o e) k with Some a => (true, a =? k) | None => closed end) by reflexivity.
    assert (HS : match k with 0 => idle | S m => after x m end = before_instant x k).
    { destruct k; auto. simpl. unfold initial. now rewrite Ha. }
    unfold until_cases. rewrite <- HS. destruct (at_letter p (e k)) eqn:Ep.
    - assert (HE : fits x k (at_once PTruth (none_of x) idle) /\ fits x k (at_once p (none_of x) idle)).
      { split; apply HF; simpl; auto; rewrite ?HA, ?HO, ?HK; auto. }
      destruct (negb _ && _); eexists; (split; [left; reflexivity | apply HE]).
    - destruct r.
      + eexists. split; [right; left; reflexivity|]. apply HF; simpl; auto; rewrite ?Ep, ?HA, ?HO, ?HK, ?Nat.eqb_refl;
        auto.
      + destruct k as [|m]; [|rewrite HA; destruct (register g (scope_tracker o e) m) as [a|] eqn:Em].
        * eexists. split; [left; reflexivity|]. apply HF; simpl; auto; rewrite ?HA, ?HO, ?HK; auto.
        * eexists. split; [right; left; reflexivity|]. assert (Hg : remembers g) by apply uncut_remembers.
          pose proof (register_backward g (scope_tracker o e) Hg m a Em).
          apply HF; simpl; auto; rewrite ?Ep, ?HA, ?HO, ?HK; auto. destruct (Nat.eqb_spec a (S m)); auto; lia.
        * eexists. split; [left; reflexivity|]. apply HF; simpl; auto; rewrite ?HA, ?HO, ?HK; auto.
  Qed.

  Lemma first_open_follows : forall x o p q k r, about x = Measures (FirstOpen o p q) -> well_formed x ->
    open_at o k = (true, r) ->
    exists c, In c (first_open_cases x p q (afresh (true, r) (before_instant x k))) /\ fits x k c.
  Proof.
    intros x o p q k r Ha HW Hr. set (f := episode p q e). set (cl := FirstOpen o p q) in *.
    assert (HA : forall m, after x m = counting x (register f (scope_tracker o e) m) m) by (intros m; unfold after;
      now rewrite Ha).
    assert (HX : forall m, base x m = match register f (scope_tracker o e) m with Some j => t j | None => began end)
      by (intros m; unfold base; now rewrite Ha).
    assert (HO : counts_from cl e k = None -> register f (scope_tracker o e) k = f None k -> exists c,
      In c [starting (PAnd p (PNot q)) (none_of x) started closed; at_once (PNot (PAnd p (PNot q))) (none_of x) idle]
        /\ fits x k c).
    { intros Hb Hn.
      change (f None k) with (if at_letter q (e k) then None else if at_letter p (e k) then Some k else None) in Hn.
      destruct (at_letter p (e k) && negb (at_letter q (e k))) eqn:E.
      - eexists. split; [left; reflexivity|]. apply andb_true_iff in E. destruct E as [E1 E2].
        destruct (at_letter q (e k)) eqn:Eq; [discriminate|]. rewrite E1 in Hn.
        apply (fits_at_rest x cl Ha HW); simpl; auto; [now rewrite E1, Eq | |].
        + rewrite HA, Hn. simpl. now rewrite count_now.
        + apply starts_afresh; auto. now rewrite HX, Hn.
      - eexists. split; [right; left; reflexivity|].
        apply (fits_at_rest x cl Ha HW); simpl; auto; [now rewrite E|]. rewrite HA, Hn.
        destruct (at_letter q (e k)), (at_letter p (e k)); auto; discriminate. }
    pose proof (register_around f o k) as HK. rewrite Hr in HK. pose proof (before_open f o k) as HB. rewrite Hr in HB.
    change (before f (scope_tracker o e) k) with (counts_from cl e k) in HB.
    unfold first_open_cases, afresh. simpl snd. destruct r; [apply HO; auto|].
    destruct k as [|m]; [unfold before_instant, initial; rewrite Ha; apply HO; auto|].
    assert (Hb : before_instant x (S m) = counting x (register f (scope_tracker o e) m) m) by (simpl; apply HA).
    rewrite Hb. destruct (register f (scope_tracker o e) m) as [j|] eqn:Ej; [|apply HO; auto]. simpl in Hb. simpl fst.
    assert (HN : at_letter q (e (S m)) = false -> after x (S m) = (Running, count (bounds x) (t j) (t (S m)))).
    { intros Eq. rewrite HA, HK. unfold f at 1, episode, opened. now rewrite Eq. }
    assert (HY : at_letter q (e (S m)) = true -> after x (S m) = idle).
    { intros Eq. rewrite HA, HK. unfold f at 1, episode. now rewrite Eq. }
    assert (Hx : base x m = t j) by now rewrite HX, Ej.
    simpl counting. rewrite <- Hb. destruct (at_letter q (e (S m))) eqn:Eq.
    - destruct (fits_running x cl Ha HW m j q idle closed HB Hx Hb Eq I) as [A B];
      [now rewrite HY | now apply does_not_run |].
      eexists. split; [|exact B]. apply in_app_iff. left. apply in_map_iff. eauto.
    - destruct (fits_running x cl Ha HW m j (PNot q) (Running,
      count (bounds x) (t j) (t (S m))) closed HB Hx Hb) as [A B];
        simpl; auto; [now rewrite Eq | now rewrite HN | |].
      { intros _ m' E. injection E as <-. rewrite !HX, HK, Ej. unfold f, episode, opened. now rewrite Eq. }
      eexists. split; [|exact B]. apply in_app_iff. right. now apply in_running.
  Qed.

  Lemma count_soon : forall bs from now, ~ In 0 bs -> now <= S from -> count bs from now = 0.
  Proof. intros [|[|b] bs] from now H0 Hn; simpl in *; auto; [tauto|].
  destruct (Nat.ltb_spec (from + S b) now); auto; lia. Qed.

  Lemma last_trigger_follows : forall x o p k r, about x = Measures (LastTrigger o p) -> well_formed x ->
    open_at o k = (true, r) ->
    exists c, In c (last_trigger_cases x p (afresh (true, r) (before_instant x k))) /\ fits x k c.
  Proof.
    intros x o p k r Ha HW Hr. set (f := trigger p e). set (cl := LastTrigger o p) in *.
    assert (HA : forall m, after x m = match register f (scope_tracker o e) m with
                  | None => idle
                  | Some j => if at_letter p (e m) then held else (Running, count (bounds x) (t j) (t m)) end)
      by (intros m; unfold after; now rewrite Ha).
    assert (HX : forall m, base x m = match register f (scope_tracker o e) m with Some j => t j | None => began end)
      by (intros m; unfold base; now rewrite Ha).
    pose proof (register_around f o k) as HK. rewrite Hr in HK. unfold last_trigger_cases, afresh. simpl snd.
    destruct (at_letter p (e k)) eqn:Ep.
    { assert (HT : register f (scope_tracker o e) k = Some k) by (rewrite HK; unfold f at 1, trigger; now rewrite Ep).
      eexists. split; [left; reflexivity|]. apply (fits_at_rest x cl Ha HW); simpl; auto; [now rewrite HA, HT, Ep|].
      right. exists k. auto. }
    assert (HI : register f (scope_tracker o e) k = None -> fits x k (at_once (PNot p) (none_of x) idle)).
    { intros Hn. apply (fits_at_rest x cl Ha HW); simpl; auto; [now rewrite Ep | now rewrite HA, Hn]. }
    assert (Hf : forall q, f q k = q) by (intros q; unfold f, trigger; now rewrite Ep). rewrite Hf in HK. destruct r.
    { eexists. split; [right; left; reflexivity|]. apply HI. rewrite HK. now destruct k. }
    destruct k as [|m].
    { unfold before_instant, initial. rewrite Ha. eexists. split; [right; left; reflexivity|]. auto. }
    simpl before_instant. rewrite HA. destruct (register f (scope_tracker o e) m) as [j|] eqn:Ej.
    2: { eexists. split; [right; left; reflexivity|]. auto. }
    assert (HN : after x (S m) = (Running, count (bounds x) (t j) (t (S m)))) by now rewrite HA, HK, Ep.
    destruct (at_letter p (e m)) eqn:Em.
    - assert (j = m).
      { rewrite register_eq in Ej. destruct (scope_tracker o e m); [|discriminate]. unfold f, trigger in Ej.
      rewrite Em in Ej. congruence. }
      subst j. assert (H0 : count (bounds x) (t m) (t (S m)) = 0).
      { apply count_soon; auto. unfold well_formed in HW. rewrite Ha in HW. tauto. }
      eexists. split; [right; left; reflexivity|]. unfold fits. rewrite Ha. simpl. split; [now rewrite Ep|]. split.
      + intros i Hi. rewrite (clock_atoms x cl (Some m) (S m) Ha HW HK i Hi). now rewrite H0.
      + split; [now rewrite HN, H0|]. split; auto. rewrite HA, Ej, Em. split; [discriminate|].
        intros _ m' E. injection E as <-. now rewrite !HX, HK, Ej.
    - assert (Hb : before_instant x (S m) = (Running, count (bounds x) (t j) (t m))) by (simpl; now rewrite HA, Ej, Em).
      assert (Hx : base x m = t j) by now rewrite HX, Ej.
      destruct (fits_running x cl Ha HW m j (PNot p) (Running,
        count (bounds x) (t j) (t (S m))) closed HK Hx Hb) as [A B];
        simpl; auto; [now rewrite Ep | |].
      { intros _ m' E. injection E as <-. now rewrite !HX, HK, Ej. }
      eexists. split; [|exact B]. right. simpl fst. rewrite <- Hb. now apply in_running.
  Qed.
  (** ** The past *)

  (** One atom, with the value of its operator. *)
  Lemma fits_past : forall x o a k c, about x = Follows o -> decides x = [a] ->
    (forall k, e k a = value e t began o k) ->
    at_letter (guard c) (e k) = true -> [tracked e t began o k] = holding c -> next c = after x k ->
    (forall n, is_running x (before_instant x k) = true -> passed c = Some n -> exists j, k = S j /\
       n = count (bounds x) (base x j) (t k) /\ (snd (before_instant x k) < n -> t j < t k)) ->
    runs_from x k c -> fits x k c.
  Proof.
    intros x o a k c Ha Hd Hv Hg Hh Hn Hp Hf. unfold fits. rewrite Ha, Hd. repeat split; auto. intros i Hi. simpl in Hi.
    assert (i = 0) by lia. subst i. rewrite <- Hh. simpl. rewrite Hv. symmetry. now apply tracked_correct.
  Qed.

  Lemma one_atom : forall x a n, decides x = [a] -> first_of x n = [0 <? n] /\ all_but x n = [negb (0 <? n)].
  Proof. intros x a n H. unfold first_of, all_but. rewrite H. auto. Qed.

  (** What has come, and has been kept: [r] remembers when it came last. *)
  Lemma once_follows : forall x o a D (start kept : predicate) (r : nat -> option nat) k,
    about x = Follows o -> decides x = [a] -> (forall k, e k a = value e t began o k) ->
    match D with None => bounds x = [] | Some d => bounds x = [d] /\ 0 < d end ->
    initial x = idle -> (forall k, after x k = once_state x (at_letter start (e k)) (r k) k) ->
    (forall k, tracked e t began o k = answer (recent t D) (r k) k) ->
    (forall k, base x k = match r k with Some j => t j | None => began end) ->
    (forall k, at_letter start (e k) = true -> r k = Some k) ->
    (at_letter start (e k) = true \/
     at_letter kept (e k) = true /\ at_letter start (e k) = false /\ r k = match k with 0 => None | S m => r m end) ->
    exists c, In c (held_case x start :: once_cases x kept (before_instant x k)) /\ fits x k c.
  Proof.
    intros x o a D start kept r k Ha Hd Hv HD Hi HA HT HX Hs [H|(H1 & H2 & H3)];
      pose proof (one_atom x a 0 Hd) as [E0 E1]; simpl in E0, E1.
    - eexists. split; [left; reflexivity|]. specialize (HA k). specialize (HT k). rewrite (Hs k H), H in *.
      assert (HR : recent t D k k = true) by (destruct D as [d|]; simpl; auto; apply Nat.leb_le; lia). simpl in HT.
      rewrite HR in HT.
      unfold held_case, all_of. destruct D as [d|]; [destruct HD as [HD _]|]; unfold once_state in HA; rewrite HD in *;
        apply (fits_past x o a); simpl; auto; rewrite ?HT, ?E1, ?HA; auto; discriminate.
    - assert (HI : r k = None -> fst (before_instant x k) <> Forever -> fits x k (at_once kept (none_of x) idle)).
      { intros Hn _. apply (fits_past x o a); simpl; auto; [rewrite HT, Hn; unfold none_of;
        now rewrite E0 | now rewrite HA, Hn | discriminate]. }
      destruct k as [|m].
      { eexists. split; [right; unfold once_cases; simpl; rewrite Hi; left; reflexivity|]. apply HI; auto. simpl.
      rewrite Hi. discriminate. }
      simpl before_instant. rewrite HA. destruct (r m) as [j|] eqn:Ej.
      2: { eexists. split; [right; left; reflexivity|]. apply HI; auto. simpl. rewrite HA, Ej. simpl. discriminate. }
      pose proof (HT (S m)) as HTk. pose proof (HA (S m)) as HAk. rewrite H3 in HTk, HAk. simpl in HTk.
      destruct D as [d|]; [destruct HD as [HD Hd0]|]; unfold once_state in *; rewrite HD in *.
      2: { eexists. split; [right; left; reflexivity|]. unfold all_of.
           apply (fits_past x o a); simpl; auto; [now rewrite HTk, E1 | discriminate]. }
      rewrite H2 in HAk. unfold recent in HTk. pose proof (dense m) as HDm. pose proof (Ht m (S m)) as HPm.
      destruct (at_letter start (e m)) eqn:Em.
      + rewrite (Hs m Em) in Ej. injection Ej as <-. assert (HL : t m + d <? t (S m) = false) by (apply Nat.ltb_ge;
        lia).
        eexists. split; [right; left; reflexivity|]. unfold all_of. apply (fits_past x o a); simpl; auto.
        * rewrite HTk, E1. f_equal. apply Nat.leb_le. lia.
        * now rewrite HAk, HL.
        * intros n Hr. exfalso. revert Hr. rewrite HA, (Hs m Em), Em. discriminate.
        * intros _ m' E. injection E as <-. now rewrite !HX, H3, (Hs m Em).
      + destruct (Nat.ltb_spec (t j + d) (t m)) as [Hlt|Hge].
        * eexists. split; [right; left; reflexivity|]. unfold none_of.
        apply (fits_past x o a); simpl; auto; [| |discriminate].
          -- rewrite HTk, E0. f_equal. apply Nat.leb_gt. lia.
          -- rewrite HAk. destruct (Nat.ltb_spec (t j + d) (t (S m))); auto; lia.
        * destruct (Nat.ltb_spec (t j + d) (t (S m))) as [Hlt|Hge'].
          -- eexists. split; [right; right; left; reflexivity|]. unfold none_of. apply (fits_past x o a); simpl; auto.
             ++ rewrite HTk, E0. f_equal. apply Nat.leb_gt. lia.
             ++ intros n _ E. injection E as <-. exists m. rewrite HX, Ej, HD. cbn [count].
                rewrite (proj2 (Nat.ltb_lt _ _) Hlt). repeat split; auto; lia.
          -- eexists. split; [right; left; reflexivity|]. unfold all_of. apply (fits_past x o a); simpl; auto.
             ++ rewrite HTk, E1. f_equal. apply Nat.leb_le. lia.
             ++ intros n _ E. injection E as <-. exists m. rewrite HX, Ej, HD. cbn [count].
                rewrite (proj2 (Nat.ltb_ge _ _) Hge'). repeat split; auto; lia.
             ++ intros _ m' E. injection E as <-. now rewrite !HX, H3, Ej.
  Qed.

  Lemma running_past : forall x o a d g k from n h, about x = Follows o -> decides x = [a] ->
    (forall k, e k a = value e t began o k) -> bounds x = [d] ->
    (match k with 0 => n = 0 /\ before_instant x 0 = (First, 0)
                | S m => before_instant x k = (Running, n) /\ n = count [d] from (t m) end) ->
    at_letter g (e k) = true -> after x k = (Running, count [d] from (t k)) ->
    [tracked e t began o k] = h (count [d] from (t k)) -> (forall m, k = S m ->
      base x (S m) = base x m /\ base x m = from) ->
    In (count [d] from (t k)) (may_have_passed x (before_instant x k)) /\
    fits x k (in_time g (h (count [d] from (t k))) (Running, count [d] from (t k)) (count [d] from (t k)) closed).
  Proof.
    intros x o a d g k from n h Ha Hd Hv HB Hk Hg Hn Hh HX. split.
    - destruct k as [|m].
      + destruct Hk as [_ Hb]. rewrite Hb. unfold may_have_passed. rewrite HB. simpl.
        destruct (from + d <? t 0); auto.
      + destruct Hk as [Hb ->]. rewrite Hb, <- HB. apply runs_on. now rewrite HB.
    - apply (fits_past x o a); auto; [|intros _ m E; now apply HX]. intros m Hr E. injection E as <-.
      destruct k as [|j].
      + destruct Hk as [_ Hb]. rewrite Hb in Hr. discriminate.
      + destruct Hk as [Hb ->]. rewrite Hb. simpl. exists j. destruct (HX j eq_refl) as [_ ->].
        rewrite HB. repeat split; auto. intros Hlt.
        apply (proj2 (runs_on x from j ltac:(now rewrite HB))). now rewrite HB.
  Qed.

  Lemma historically_so_far : forall p k,
    value e t began (Historically None p) k = every_instant 0 k (fun j => at_letter p (e j)).
  Proof.
    intros p k. apply eq_true_iff_eq. simpl. rewrite some_instant_true, every_instant_true. split.
    - intros (j & _ & H). apply andb_true_iff in H. destruct H as [H1 H2]. apply Nat.eqb_eq in H1. subst.
      now rewrite every_instant_true in H2.
    - intros H. exists 0. split; [lia|]. simpl. now apply every_instant_true.
  Qed.
  Lemma every_next : forall f m, every_instant 0 (S m) f = every_instant 0 m f && f (S m).
  Proof.
    intros f m. apply eq_true_iff_eq. rewrite andb_true_iff, !every_instant_true. split.
    - intros H. split; intros; apply H; lia.
    - intros [H1 H2] j Hj. destruct (Nat.eq_dec j (S m)) as [->|]; auto. apply H1; lia.
  Qed.

  Lemma historically_follows : forall x D p a k, about x = Follows (Historically D p) -> decides x = [a] ->
    (forall k, e k a = value e t began (Historically D p) k) ->
    match D with None => bounds x = [] | Some d => bounds x = [d - 1] /\ 0 < d end ->
    exists c, In c (historically_cases x p (before_instant x k) ++ [at_once (PNot p) (none_of x) idle]) /\ fits x k c.
  Proof.
    intros x D p a k Ha Hd Hv HD. pose proof (one_atom x a) as HO. set (f := fun j => at_letter p (e j)).
    assert (HN : at_letter p (e k) = false -> fits x k (at_once (PNot p) (none_of x) idle)).
    { intros Ep. apply (fits_past x (Historically D p) a); simpl; auto; [now rewrite Ep | | |discriminate].
      - unfold none_of. rewrite (proj1 (HO 0 Hd)). f_equal. fold f. assert (E : since_when f k = None) by (destruct k;
        simpl; unfold f at 1; now rewrite Ep).
        now rewrite E.
      - unfold after. rewrite Ha. fold f. destruct D as [d|]; [destruct HD as [HD _]|]; rewrite HD.
        + assert (E : since_when f k = None) by (destruct k; simpl; unfold f at 1; now rewrite Ep). now rewrite E.
        + assert (E : every_instant 0 k f = false); [|now rewrite E].
          destruct (every_instant 0 k f) eqn:E; auto. rewrite every_instant_true in E. specialize (E k). unfold f in E.
          rewrite E in Ep by lia. discriminate. }
    destruct (at_letter p (e k)) eqn:Ep; [clear HN|eexists; split; [apply in_app_iff; right; left; reflexivity | auto]].
    unfold historically_cases. destruct D as [d|]; [destruct HD as [HD H0]|]; rewrite HD.
    - assert (HA : forall k, after x k = counting x (since_when f k) k) by (intros m; unfold after; rewrite Ha, HD;
      reflexivity).
      assert (HS : since_when f k = Some k -> fits x k (starting p (none_of x) started closed)).
      { intros E. apply (fits_past x (Historically (Some d) p) a); simpl; auto; [| |discriminate|].
        - fold f. rewrite E. unfold none_of. rewrite (proj1 (HO 0 Hd)). simpl. f_equal. apply Nat.leb_gt. lia.
        - rewrite HA, E. simpl. now rewrite count_now.
        - apply starts_afresh; auto. unfold base. rewrite Ha. fold f. now rewrite E. }
      destruct k as [|m].
      { eexists. split; [|apply HS; simpl; unfold f; now rewrite Ep]. unfold before_instant, initial. rewrite Ha.
      left. reflexivity. }
      assert (HW : since_when f (S m) = match since_when f m with Some i => Some i | None => Some (S m) end).
      { simpl. unfold f at 1. now rewrite Ep. }
      simpl before_instant. rewrite HA. destruct (since_when f m) as [j|] eqn:Ej.
      2: { eexists. split; [|apply HS; auto]. left. reflexivity. }
      destruct (running_past x (Historically (Some d) p) a (d - 1) p (S m) (t j) (count [d - 1] (t j) (t m)) (first_of
        x) Ha Hd Hv HD) as [A B];
        auto.
      + split; auto. change (after x m = (Running, count [d - 1] (t j) (t m))). rewrite HA, Ej. unfold counting.
      now rewrite HD.
      + rewrite HA, HW. unfold counting. now rewrite HD.
      + rewrite (proj1 (HO _ Hd)). f_equal. unfold tracked. fold f. rewrite HW. unfold answer, long_ago. cbn [count].
        destruct (Nat.leb_spec (t j + d) (t (S m))), (Nat.ltb_spec (t j + (d - 1)) (t (S m))); simpl; auto; lia.
      + intros m' E. injection E as <-. unfold base. rewrite Ha. fold f. now rewrite HW, Ej.
      + eexists. split; [|exact B]. apply in_app_iff. left. simpl. unfold running_cases. apply in_map_iff. eexists.
      split; [reflexivity|].
        simpl in A. rewrite HA, Ej in A. simpl in A. rewrite HD in A. rewrite HD. exact A.
    - assert (HA : forall k, after x k = if every_instant 0 k f then forever else idle) by (intros m; unfold after;
      rewrite Ha, HD; reflexivity).
      assert (HT : tracked e t began (Historically None p) k = every_instant 0 k f)
        by (rewrite tracked_correct by auto; apply historically_so_far).
      assert (HF : every_instant 0 k f = true -> fits x k (at_once p (all_of x) forever)).
      { intros E. apply (fits_past x (Historically None p) a); simpl guard; auto; [| |discriminate].
        - unfold all_of. simpl holding. unfold all_of. rewrite HT, E, (proj2 (HO 0 Hd)). reflexivity.
        - now rewrite HA, E. }
      destruct k as [|m].
      { eexists. split; [|apply HF]; [unfold before_instant, initial; rewrite Ha; left; reflexivity|].
        apply every_instant_true. intros j Hj. replace j with 0 by lia. exact Ep. }
      simpl before_instant. rewrite HA. assert (HE : every_instant 0 (S m) f = every_instant 0 m f).
      { rewrite every_next. unfold f at 2. rewrite Ep. apply andb_true_r. }
      rewrite <- HE. destruct (every_instant 0 (S m) f) eqn:E.
      + eexists. split; [left; reflexivity|]. auto.
      + eexists. split; [left; reflexivity|]. apply (fits_past x (Historically None p) a); simpl guard; auto;
        [| |discriminate].
        * simpl holding. unfold none_of. now rewrite HT, (proj1 (HO 0 Hd)).
        * now rewrite HA, E.
  Qed.

  Lemma age_follows : forall x d p a k, about x = Follows (Age d p) -> decides x = [a] ->
    (forall k, e k a = value e t began (Age d p) k) -> bounds x = [d] ->
    exists c, In c (cases x (before_instant x k) (around (about x) k)) /\ fits x k c.
  Proof.
    intros x d p a k Ha Hd Hv HB. pose proof (one_atom x a) as HO. set (f := fun j => at_letter p (e j)).
    set (from := fun k => match latest f k with Some j => t j | None => began end).
    assert (HA : forall k, after x k = (Running, count [d] (from k) (t k))).
    { intros m. unfold after, from. rewrite Ha, HB. fold f. destruct (latest f m); auto. }
    unfold cases. rewrite Ha. destruct (at_letter p (e k)) eqn:Ep.
    - assert (E : latest f k = Some k) by (destruct k; simpl; unfold f; now rewrite Ep).
      eexists. split; [left; reflexivity|]. apply (fits_past x (Age d p) a); simpl; auto; [| |discriminate|].
      + fold f. rewrite E. unfold all_of. rewrite (proj2 (HO 0 Hd)). simpl. f_equal. apply Nat.leb_le. lia.
      + rewrite HA. unfold from. rewrite E, count_now. reflexivity.
      + apply starts_afresh; auto. unfold base. rewrite Ha. fold f. now rewrite E.
    - assert (HF : match k with 0 => from k = began | S m => from k = from m end).
      { unfold from. destruct k; simpl; unfold f at 1; rewrite Ep; reflexivity. }
      destruct (running_past x (Age d p) a d (PNot p) k (from k) (match k with 0 => 0 | S m => count [d] (from k) (t m)
        end) (all_but x) Ha Hd Hv HB) as [A B];
        auto.
      + destruct k as [|m]; split; auto; [unfold before_instant, initial; now rewrite Ha|].
        simpl before_instant. rewrite HA. now rewrite HF.
      + simpl. now rewrite Ep.
      + rewrite (proj2 (HO _ Hd)). f_equal. simpl tracked. fold f. unfold from. simpl.
        destruct (latest f k) as [j|]; [destruct (Nat.leb_spec (t k) (t j + d)), (Nat.ltb_spec (t j + d) (t k))
                                       |destruct (Nat.leb_spec (t k) (began + d)), (Nat.ltb_spec (began + d) (t k))];
                                         simpl; auto; lia.
      + intros m' ->. unfold base. rewrite Ha. fold f. split; [exact HF | symmetry; exact HF].
      + eexists. split; [|exact B]. right. apply in_map_iff. eexists. split; [reflexivity | exact A].
  Qed.

  (** * In every run, at every instant, each tracker has a case that fits *)

  Lemma closed_follows : forall x cl o k, about x = Measures cl -> well_formed x -> outer (about x) = Some o ->
    fst (open_at o k) = false -> fits x k (at_once PTruth (none_of x) idle).
  Proof.
    intros x cl o k Ha HW Ho HE. assert (HN : scope_tracker o e k = None).
    { unfold open_at in HE. destruct (scope_tracker o e k); auto; discriminate. }
    assert (HR : forall f, register f (scope_tracker o e) k = None) by (intros f; now rewrite register_eq, HN).
    assert (HB : forall f, before f (scope_tracker o e) k = None) by (intros f; unfold before; now rewrite HN).
    rewrite Ha in Ho. destruct cl as [[| | |]| |]; simpl in Ho; try discriminate Ho; injection Ho as ->;
      eapply fits_at_rest; eauto; unfold after, scope_shown, open_at; rewrite ?Ha; simpl; rewrite ?HR, ?HB; auto.
  Qed.

  Theorem tracker_follows : forall x k, well_formed x ->
    exists c, In c (cases x (before_instant x k) (around (about x) k)) /\ fits x k c.
  Proof.
    intros x k HW. pose proof HW as HX. unfold well_formed in HX. destruct (about x) as [o|cl] eqn:Ha.
    - destruct HX as (a & Hd & Hv & HB). unfold cases. rewrite Ha. destruct o as [p|D p|D p|D p q|d p].
      + pose proof (one_atom x a 0 Hd) as [E0 E1]. simpl in E0, E1.
        assert (HT : [tracked e t began (Previously p) k] =
                     match fst (before_instant x k) with Forever => all_of x | _ => none_of x end).
        { destruct k as [|m]; simpl; [unfold initial; rewrite Ha; unfold none_of; now rewrite E0|].
          unfold after. rewrite Ha. unfold all_of, none_of. destruct (at_letter p (e m)); simpl;
            [now rewrite E1 | now rewrite E0]. }
        destruct (at_letter p (e k)) eqn:Ep; eexists; (split; [|apply (fits_past x (Previously p) a k _ Ha Hd Hv)]).
        * left. reflexivity.
        * exact Ep.
        * exact HT.
        * unfold after. now rewrite Ha, Ep.
        * discriminate.
        * auto.
        * right. left. reflexivity.
        * simpl. now rewrite Ep.
        * exact HT.
        * unfold after. now rewrite Ha, Ep.
        * discriminate.
        * auto.
      + apply (once_follows x (Once D p) a D p (PNot p) (latest (fun j => at_letter p (e j)))); auto.
        * unfold initial. now rewrite Ha.
        * intros m. unfold after. now rewrite Ha.
        * intros m. unfold base. now rewrite Ha.
        * intros m H. destruct m; simpl; now rewrite H.
        * simpl. destruct (at_letter p (e k)) eqn:Ep; auto. right. repeat split. destruct k; simpl; now rewrite Ep.
      + apply (historically_follows x D p a); auto.
      + rewrite app_comm_cons. set (f := fun j => at_letter p (e j)). set (g := fun j => at_letter q (e j)).
        assert (HS : initial x = idle) by (unfold initial; now rewrite Ha).
        assert (HA : forall m, after x m = once_state x (at_letter q (e m)) (kept_since f g m) m) by (intros m;
          unfold after; now rewrite Ha).
        destruct (at_letter q (e k)) eqn:Eq; [|destruct (at_letter p (e k)) eqn:Ep].
        * destruct (once_follows x (Since D p q) a D q (PAnd (PNot q) p) (kept_since f g) k) as (c & A & B); auto.
          -- intros m. unfold base. now rewrite Ha.
          -- intros m H. change (g m = true) in H. destruct m; cbn [kept_since]; now rewrite H.
          -- exists c. split; auto. apply in_app_iff; auto.
        * destruct (once_follows x (Since D p q) a D q (PAnd (PNot q) p) (kept_since f g) k) as (c & A & B); auto.
          -- intros m. unfold base. now rewrite Ha.
          -- intros m H. change (g m = true) in H. destruct m; cbn [kept_since]; now rewrite H.
          -- right. simpl. rewrite Eq, Ep. repeat split. change (g k = false) in Eq. change (f k = true) in Ep.
             destruct k; cbn [kept_since]; now rewrite Eq, Ep.
          -- exists c. split; auto. apply in_app_iff; auto.
        * assert (HN : kept_since f g k = None).
          { change (g k = false) in Eq. change (f k = false) in Ep. destruct k; cbn [kept_since]; now rewrite Eq, Ep. }
          eexists. split; [apply in_app_iff; right; left; reflexivity|].
          apply (fits_past x (Since D p q) a); simpl guard; auto; [simpl; now rewrite Eq, Ep | | |discriminate].
          -- unfold tracked. fold f g. rewrite HN. simpl. unfold none_of. now rewrite (proj1 (one_atom x a 0 Hd)).
          -- now rewrite HA, HN.
      + pose proof (age_follows x d p a k Ha Hd Hv HB) as H. unfold cases in H. rewrite Ha in H. exact H.
    - unfold cases. rewrite Ha. destruct (outer (Measures cl)) as [o|] eqn:Eo.
      2: { destruct cl as [[| | |]| |]; try discriminate Eo.
           destruct (scope_follows x WholeRun (fun r k => match r with Some j => Some j | None => Some k end) PTruth
             None k (k =? 0))
             as (c & A & B); auto; [|now rewrite Ha | rewrite Ha in A; eauto].
           intros m. rewrite Ha. unfold around. simpl. destruct m; reflexivity. }
      assert (Hr : around (Measures cl) k = open_at o k) by (unfold around; now rewrite Eo).
      rewrite Hr. destruct (open_at o k) as [[|] r] eqn:Ek.
      2: { assert (HC : fits x k (at_once PTruth (none_of x) idle)) by (apply (closed_follows x cl o k);
        rewrite ?Ha, ?Ek; auto).
           destruct cl as [[| | |]| |]; try discriminate Eo; (eexists; split; [left; reflexivity | exact HC]). }
      assert (HS : forall f m, match open_at o m with
           | (false, _) => None
           | (true, _) => f (match open_at o m, m with (_, false), S j => register f (scope_tracker o e) j | _,
             _ => None end) m
           end = register f (scope_tracker o e) m) by (intros f m; symmetry; apply register_around).
      destruct cl as [[|o' p|o' p|o' p q]|o' p q|o' p]; try discriminate Eo; injection Eo as ->; simpl negb; cbv iota.
      + destruct (scope_follows x (AfterEvent o p) (opened p e) p None k r) as (c & A & B); auto.
        * intros m. rewrite Ha. unfold around. simpl outer. cbv iota. symmetry. apply HS.
        * rewrite Ha. exact Hr.
        * rewrite Ha, Hr in A. eauto.
      + eapply until_follows; eauto.
      + destruct (scope_follows x (Episodes o p q) (episode p q e) (PAnd p (PNot q)) (Some q) k r) as (c & A & B); auto.
        * intros m. rewrite Ha. unfold around. simpl outer. cbv iota. symmetry. apply HS.
        * intros m. unfold episode, opened. simpl. destruct (at_letter q (e m)), (at_letter p (e m)); auto.
        * rewrite Ha. exact Hr.
        * rewrite Ha, Hr in A. eauto.
      + eapply first_open_follows; eauto.
      + eapply last_trigger_follows; eauto.
  Qed.

  Lemma held_base : forall x k, fst (after x k) = Held -> base x k = t k.
  Proof.
    assert (HO : forall x now r k, fst (once_state x now r k) = Held -> now = true).
    { intros x [|] [j|] k; unfold once_state; destruct (bounds x); try discriminate; auto.
      destruct (t j + n <? t k); discriminate. }
    intros x k H. unfold after in H. unfold base. destruct (about x) as [[p|D p|D p|D p q|d p]|[o|o p q|o p]].
    - destruct (at_letter p (e k)); discriminate.
    - apply HO in H. destruct k; simpl; now rewrite H.
    - destruct (bounds x); [destruct (every_instant _ _ _) | destruct (since_when _ _)]; discriminate.
    - apply HO in H. destruct k; cbn [kept_since]; now rewrite H.
    - destruct (latest _ _); discriminate.
    - destruct (scope_tracker o e k); discriminate.
    - destruct (register _ _ _); discriminate.
    - destruct (register _ _ _) as [j|] eqn:E; [|discriminate]. destruct (at_letter p (e k)) eqn:Ep; [|discriminate].
      rewrite register_eq in E. unfold trigger in E. rewrite Ep in E. destruct (scope_tracker o e k); [|discriminate].
      now injection E as <-.
  Qed.

  (** Which case it is can be told. *)
  Lemma fits_dec : forall x k c, {fits x k c} + {~ fits x k c}.
  Proof.
    assert (both : forall P Q : Prop, {P} + {~ P} -> {Q} + {~ Q} -> {P /\ Q} + {~ (P /\ Q)}) by tauto.
    assert (all_below : forall (f g : nat -> bool) n, {forall i, i < n -> f i = g i} + {~ forall i, i < n ->
      f i = g i}).
    { induction n as [|n [IH|IH]]; [left; lia| |right; intros H; apply IH; auto].
      destruct (bool_dec (f n) (g n)) as [E|E]; [left|right; auto].
      intros i Hi. destruct (Nat.eq_dec i n) as [->|]; auto. apply IH. lia. }
    assert (same_state : forall a b : state, {a = b} + {a <> b}) by (repeat decide equality).
    assert (same_scope : forall a b : openness, {a = b} + {a <> b}) by (repeat decide equality).
    intros x k c. unfold fits, runs_from. repeat apply both; auto using bool_dec.
    - destruct (about x) as [|[o| |]]; auto.
    - destruct (is_running x (before_instant x k)); [|left; discriminate].
      destruct (passed c) as [n|]; [|left; discriminate].
      destruct k as [|j]; [right; intros HN; destruct (HN n eq_refl eq_refl) as (j & E & _); discriminate|].
      destruct (Nat.eq_dec n (count (bounds x) (base x j) (t (S j)))) as [EN|EN],
        (lt_dec (t j) (t (S j))) as [ET|ET], (lt_dec (snd (before_instant x (S j))) n) as [H|H];
        try (left; intros m _ E; injection E as <-; exists j; repeat split; auto; tauto);
        right; intros HN; destruct (HN n eq_refl eq_refl) as (i & E & HE); injection E as <-; tauto.
    - destruct (is_running x (next c)); [|left; discriminate].
      destruct (starts c); [destruct (Nat.eq_dec (base x k) (t k)); auto|].
      destruct k as [|j]; [left; discriminate|].
      destruct (Nat.eq_dec (base x (S j)) (base x j)) as [E|E]; [left; intros _ m H; injection H as <-; auto | right;
        auto].
  Qed.

  Definition the_case (x : tracker_of) (k : nat) : case :=
    match find (fun c => if fits_dec x k c then true else false) (cases x (before_instant x k) (around (about x) k)) with
    | Some c => c
    | None => at_once PTruth [] idle
    end.

  Lemma the_case_fits : forall x k, well_formed x ->
    In (the_case x k) (cases x (before_instant x k) (around (about x) k)) /\ fits x k (the_case x k).
  Proof.
    intros x k HW. unfold the_case. destruct (find _ _) as [c|] eqn:E.
    - apply find_some in E. destruct E as [E1 E2]. destruct (fits_dec x k c); [auto | discriminate].
    - destruct (tracker_follows x k HW) as (c & H1 & H2). apply find_none with (2 := H1) in E.
      destruct (fits_dec x k c); [discriminate | tauto].
  Qed.
End Run.
