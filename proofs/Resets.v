(** The reset machine: which words are runs in time, without times. [runs_are_words]: the letters of every run, with
    the atoms that its trackers decide, are a fair word of the machine.

    An atom that a clock is late is not free: it holds only after its bound has passed, then until the clock is
    reset. The machine runs all trackers side by side, and lets a clock pass its next bound wherever time could.
    Time goes on for ever: each clock that runs passes its bounds or starts anew, and letters that can be held
    recur.
    Python: [ltlc/semantics/reset_machine.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Trackers.

Definition predicate_eq_dec : forall p q : predicate, {p = q} + {p <> q}.
Proof. decide equality. apply Nat.eq_dec. Defined.
Definition scope_eq_dec : forall o o' : scope, {o = o'} + {o <> o'}.
Proof. decide equality; apply predicate_eq_dec. Defined.

(** Whether nothing has been read yet; the state of each tracker; and whether its clock has run for no time: since it
    started, no letter could be held. *)
Record clocks := { is_first : bool; states : list state; begun : list bool }.

(** By any letter with [letters] to [target]; in which of the fairness sets the step is. *)
Record move := { letters : predicate; target : clocks; fair : list bool }.

Section Machine.
  (** The atoms that are news, and the trackers, each after those of the scopes around it. *)
  Variables (news : list nat) (xs : list tracker_of).

  Definition none_begun : list bool := map (fun _ => false) xs.
  Definition start : clocks :=
    {| is_first := match xs with [] => false | _ => true end; states := map initial xs; begun := none_begun |}.

  Definition all_of_them (ps : list predicate) : predicate := fold_right PAnd PTruth ps.
  Definition atoms_as (x : tracker_of) (c : case) : predicate :=
    all_of_them (map (fun ab => if snd ab : bool then PAtom (fst ab) else PNot (PAtom (fst ab)))
                     (combine (decides x) (holding c))).

  (** The scopes that are known, and whether this is the first instant. *)
  Definition known : Type := scope -> openness.
  Definition surroundings (env : known) (first : bool) (x : tracker_of) : openness :=
    match outer (about x) with None => (true, first) | Some o => env o end.
  Definition learn (env : known) (x : tracker_of) (c : case) : known := fun o =>
    match about x with Measures (SinceOpening o') => if scope_eq_dec o o' then opened_to c else env o | _ => env o end.

  (** What trackers may do together, and by which letters. *)
  Fixpoint together (ys : list tracker_of) (sts : list state) (env : known) (first : bool) :
    list (predicate * list case) :=
    match ys, sts with
    | y :: ys, st :: sts =>
        flat_map (fun c => map (fun r => (PAnd (PAnd (guard c) (atoms_as y c)) (fst r), c :: snd r))
                             (together ys sts (learn env y c) first))
                 (cases y st (surroundings env first y))
    | _, _ => [(PTruth, [])]
    end.

  (** The letters that can be held: no news, and [previously] has caught up, unless its operand is of the past or
      news. *)
  Definition timed_atom (a : nat) : bool :=
    existsb (Nat.eqb a) news || existsb (fun x => existsb (Nat.eqb a) (decides x)) xs.
  Fixpoint asks_time (p : predicate) : bool :=
    match p with
    | PTruth => false
    | PAtom a => timed_atom a
    | PNot p => asks_time p
    | PAnd p q | POr p q => asks_time p || asks_time q
    end.
  Definition caught_up (x : tracker_of) : predicate :=
    match about x, decides x with
    | Follows (Previously p), [a] => if asks_time p then PTruth
                                     else POr (PAnd (PAtom a) p) (PAnd (PNot (PAtom a)) (PNot p))
    | _, _ => PTruth
    end.
  Definition settled : predicate :=
    PAnd (all_of_them (map (fun a => PNot (PAtom a)) news)) (all_of_them (map caught_up xs)).

  (** The clock is not one that has yet to pass a bound, or has just been started. *)
  Definition goes_on (x : tracker_of) (c : case) : bool := starts c || negb (is_running x (next c)).
  (** The clock passes a bound, which takes time. *)
  Definition passes (x : tracker_of) (st : state) (c : case) : bool :=
    is_running x st && match passed c with Some n => snd st <? n | None => false end.

  Definition has_bounds (x : tracker_of) : bool := match bounds x with [] => false | _ => true end.
  Fixpoint marks (ys : list tracker_of) (cs : list case) : list bool :=
    match ys, cs with
    | y :: ys, c :: cs => if has_bounds y then goes_on y c :: marks ys cs else marks ys cs
    | _, _ => []
    end.
  Fixpoint those_passing (ys : list tracker_of) (sts : list state) (cs : list case) : list bool :=
    match ys, sts, cs with
    | y :: ys, st :: sts, c :: cs => passes y st c :: those_passing ys sts cs
    | _, _, _ => []
    end.

  (** After an instant at which none passes, the clock has run for no time, and is to do so. *)
  Definition has_begun (x : tracker_of) (st : state) (b : bool) (c : case) : bool :=
    is_running x (next c) && match bounds x with d :: _ => 0 <? d | [] => false end &&
    (starts c || match fst st with Held => true | _ => false end || b).
  Fixpoint have_begun (ys : list tracker_of) (sts : list state) (bs : list bool) (cs : list case) : list bool :=
    match ys, sts, bs, cs with
    | y :: ys, st :: sts, b :: bs, c :: cs => has_begun y st b c :: have_begun ys sts bs cs
    | _, _, _, _ => []
    end.

  Definition is_trivial : bool := match xs, news with [], [] => true | _, _ => false end.
  Definition sets : nat := if is_trivial then 0 else S (length (filter has_bounds xs)).

  Definition moves (k : clocks) : list move :=
    if is_trivial then [{| letters := PTruth; target := k; fair := [] |}] else
    flat_map (fun r =>
      let to bs := {| is_first := false; states := map next (snd r); begun := bs |} in
      let pass := those_passing xs (states k) (snd r) in
      let held := {| letters := PAnd (fst r) settled; target := to none_begun; fair := marks xs (snd r) ++ [true] |} in
      let rest := {| letters := PAnd (fst r) (PNot settled);
                     target := to (have_begun xs (states k) (begun k) (snd r)); fair :=
                       marks xs (snd r) ++ [false] |} in
      (if existsb (fun pb => fst pb && snd pb) (combine pass (begun k)) then [] else [held]) ++
      (if existsb (fun p => p) pass then [] else [rest]))
      (together xs (states k) (fun _ => closed) (is_first k)).

  (** A fair word: moves one after the other, and those of each fairness set again and again. *)
  Definition moves_by (k : clocks) (l : letter) (k' : clocks) (m : move) : Prop :=
    In m (moves k) /\ at_letter (letters m) l = true /\ target m = k'.
  Definition word (e : stream) (path : nat -> clocks) : Prop :=
    path 0 = start /\
    (forall k, exists m, moves_by (path k) (e k) (path (S k)) m) /\
    (forall i, i < sets -> forall n, exists k m, n <= k /\ moves_by (path k) (e k) (path (S k)) m /\
      nth i (fair m) false = true).
End Machine.

(** * Every run is a fair word *)
Section Runs.
  Variables (news : list nat) (xs : list tracker_of) (e : stream) (t : times) (began : nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Hypothesis goes_on_for_ever : diverges t.
  Hypothesis all_well_formed : forall x, In x xs -> well_formed e t began x.

  (** Each tracker stands after that of the scope around it. *)
  Fixpoint placed (scopes : list scope) (ys : list tracker_of) : Prop :=
    match ys with
    | [] => True
    | y :: ys => (match outer (about y) with None => True | Some o => In o scopes end) /\
                 placed (match about y with Measures (SinceOpening o) => o :: scopes | _ => scopes end) ys
    end.
  Hypothesis all_placed : placed [] xs.

  (** Where time passes, the letter is held: no news, and the atoms that nothing decides are what they were. *)
  Hypothesis held_letters : forall k, t k < t (S k) ->
    (forall a, In a news -> e (S k) a = false) /\ (forall a, timed_atom news xs a = false -> e (S k) a = e k a).

  Lemma all_of_them_true : forall ps l, (forall p, In p ps -> at_letter p l = true) ->
    at_letter (all_of_them ps) l = true.
  Proof. induction ps as [|p ps IH]; simpl; intros l H; auto. now rewrite H, IH by auto. Qed.

  Lemma untimed_held : forall p k, asks_time news xs p = false -> t k < t (S k) ->
    at_letter p (e (S k)) = at_letter p (e k).
  Proof.
    induction p; simpl; intros k H Hk; auto; [now apply held_letters | now rewrite IHp | |];
      apply orb_false_iff in H; destruct H; now rewrite IHp1, IHp2.
  Qed.

  Lemma settled_held : forall k, t k < t (S k) -> at_letter (settled news xs) (e (S k)) = true.
  Proof.
    intros k Hk. simpl. apply andb_true_iff. split; apply all_of_them_true; intros p Hp; apply in_map_iff in Hp.
    - destruct Hp as (a & <- & Ha). simpl. now rewrite (proj1 (held_letters k Hk)).
    - destruct Hp as (x & <- & Hx). pose proof (all_well_formed x Hx) as HW. unfold well_formed in HW. unfold caught_up.
      destruct (about x) as [[p| | | |]|]; auto. destruct HW as (a & -> & Hv & _).
      destruct (asks_time news xs p) eqn:E; auto. simpl. rewrite Hv. simpl. rewrite (untimed_held p k E Hk).
      now destruct (at_letter p (e k)).
  Qed.

  Lemma decided_true : forall x c k, fits e t began x k c -> at_letter (atoms_as x c) (e k) = true.
  Proof.
    intros x c k (_ & H & _). unfold atoms_as. apply all_of_them_true. intros p Hp. apply in_map_iff in Hp.
    destruct Hp as ([a b] & <- & Hp). apply In_nth with (d := (0, false)) in Hp. destruct Hp as (i & Hi & E).
    rewrite combine_length in Hi. simpl.
    assert (HN : forall (l : list nat) (m : list bool) i, i < length l -> i < length m ->
              nth i (combine l m) (0, false) = (nth i l 0, nth i m false)).
    { induction l as [|y l IH]; intros [|z m] [|j] A B; simpl in *; auto; try lia. apply IH; lia. }
    rewrite HN in E by lia. injection E as <- <-. specialize (H i).
    destruct (nth i (holding c) false); simpl; rewrite H by lia; auto.
  Qed.

  (** At every instant, the trackers together. *)
  Definition cases_at (k : nat) : list case := map (fun x => the_case e t began x k) xs.

  Lemma together_follows : forall ys scopes env k first, (forall y, In y ys -> well_formed e t began y) ->
    placed scopes ys ->
    (forall o, In o scopes -> env o = open_at e o k) -> (ys <> [] -> first = (k =? 0)) ->
    exists l, In (l, map (fun y => the_case e t began y k) ys)
                 (together ys (map (fun y => before_instant e t began y k) ys) env first) /\
      at_letter l (e k) = true.
  Proof.
    induction ys as [|y ys IH]; intros scopes env k first HW HP HE HF; simpl.
    - exists PTruth. auto.
    - destruct HP as [H1 H2]. specialize (HF ltac:(discriminate)). set (c := the_case e t began y k).
    assert (HS : surroundings env first y = around e (about y) k).
      { unfold surroundings, around. destruct (outer (about y)); [auto | now rewrite HF]. }
      destruct (the_case_fits e t began Ht dense y k (HW y (or_introl eq_refl))) as [A B]. fold c in A, B.
      destruct (IH _ (learn env y c) k first (fun z Hz => HW z (or_intror Hz)) H2) as (l & C & D); auto.
      + intros o Ho. unfold learn. pose proof B as (_ & _ & _ & HO & _). destruct (about y) as [|[o'| |]]; auto.
        destruct (scope_eq_dec o o') as [->|Hne]; auto. apply HE. destruct Ho; congruence.
      + exists (PAnd (PAnd (guard c) (atoms_as y c)) l). split.
        * apply in_flat_map. exists c. rewrite HS. split; auto. apply in_map_iff.
          exists (l, map (fun y => the_case e t began y k) ys). auto.
        * simpl. rewrite (decided_true y c k B), D. pose proof B as (-> & _). reflexivity.
  Qed.

  Lemma cases_fit : forall k, Forall2 (fun x c => fits e t began x k c) xs (cases_at k).
  Proof.
    intros k. unfold cases_at. revert all_well_formed. clear - Ht dense. induction xs as [|x ys IH]; simpl; auto.
    intros HW. constructor; auto. apply the_case_fits; auto.
  Qed.

  (** After instant k. *)
  Fixpoint begun_after (x : tracker_of) (k : nat) : bool :=
    negb (at_letter (settled news xs) (e k)) &&
    has_begun x (before_instant e t began x k) match k with 0 => false | S j => begun_after x j end
      (the_case e t began x k).

  Definition begun_before (x : tracker_of) (k : nat) : bool := match k with 0 => false | S j => begun_after x j end.
  Lemma begun_after_eq : forall x k, begun_after x k = negb (at_letter (settled news xs) (e k)) &&
    has_begun x (before_instant e t began x k) (begun_before x k) (the_case e t began x k).
  Proof. destruct k; reflexivity. Qed.

  Definition path (k : nat) : clocks :=
    match k with
    | 0 => start xs
    | S j => {| is_first := false; states := map (fun x => after e t began x j) xs;
                begun := map (fun x => begun_after x j) xs |}
    end.

  Lemma path_states : forall k, states (path k) = map (fun x => before_instant e t began x k) xs.
  Proof. destruct k; reflexivity. Qed.
  Lemma path_begun : forall k, begun (path k) = map (fun x => begun_before x k) xs.
  Proof. destruct k; reflexivity. Qed.
  Lemma path_first : forall k, xs <> [] -> is_first (path k) = (k =? 0).
  Proof. intros [|k] H; [unfold path, start; destruct xs; [now destruct H | reflexivity] | reflexivity]. Qed.

  (** No time has passed since the clock began. *)
  Lemma begun_now : forall x, well_formed e t began x -> forall k, begun_after x k = true ->
    is_running x (after e t began x k) = true /\ t k <= base e t began x k /\
    match bounds x with d :: _ => 0 < d | [] => False end.
  Proof.
    intros x HW. assert (HX : forall k, begun_after x k = true ->
      (match k with 0 => True | S j => begun_after x j = true -> t j <= base e t began x j end) ->
      is_running x (after e t began x k) = true /\ t k <= base e t began x k /\
      match bounds x with d :: _ => 0 < d | [] => False end).
    { intros k H IH. destruct (the_case_fits e t began Ht dense x k HW) as [_ HF]. set (c :=
      the_case e t began x k) in *.
      rewrite begun_after_eq in H. apply andb_true_iff in H. destruct H as [HS HB]. apply negb_true_iff in HS.
        fold c in HB.
      unfold has_begun in HB. apply andb_true_iff in HB. destruct HB as [HB HC].
      apply andb_true_iff in HB. destruct HB as [HR HD]. pose proof HF as (_ & _ & HN & _ & _ & HG).
      specialize (HG HR). rewrite HN in HR. split; [exact HR|].
      split; [|destruct (bounds x); [discriminate | now apply Nat.ltb_lt]].
      destruct (starts c); [lia|]. simpl in HC. destruct k as [|j].
      { simpl in HC. exfalso. revert HC. unfold initial. destruct (about x) as [[]|]; discriminate. }
      rewrite (HG j eq_refl). assert (E : t (S j) = t j).
      { pose proof (Ht j (S j)). destruct (Nat.eq_dec (t (S j)) (t j)); auto. rewrite settled_held in HS by lia.
        discriminate. }
      rewrite E. apply orb_true_iff in HC. destruct HC as [HC|HC]; auto. simpl in HC.
      rewrite (held_base e t began x j); auto. now destruct (fst (after e t began x j)). }
    induction k as [|k IH]; intros H; apply HX; auto. intros Hk. now apply IH.
  Qed.

  (** What the trackers do at an instant, they may do together. *)
  Lemma cases_together : forall k, exists l,
    In (l, cases_at k) (together xs (states (path k)) (fun _ => closed) (is_first (path k))) /\ at_letter l (e k) = true.
  Proof.
    intros k. rewrite path_states. apply (together_follows xs []); auto; [intros o [] | apply path_first].
  Qed.
  Lemma cases_next : forall k, map next (cases_at k) = states (path (S k)).
  Proof.
    intros k. pose proof (cases_fit k) as HF. simpl. clear - HF. induction HF as [|x c ys cs H _ IH]; simpl; auto.
    destruct H as (_ & _ & -> & _). now rewrite IH.
  Qed.
  Lemma passing_takes_time : forall k, existsb (fun p => p) (those_passing xs (states (path k)) (cases_at k)) = true ->
    exists j, k = S j /\ t j < t k.
  Proof.
    intros k. pose proof (cases_fit k) as HF. rewrite path_states. clear - HF.
    induction HF as [|x c ys cs H _ IH]; simpl; [discriminate|].
    intros HO. apply orb_true_iff in HO. destruct HO as [HO|HO]; auto. destruct H as (_ & _ & _ & _ & H & _).
    unfold passes in HO. apply andb_true_iff in HO. destruct HO as [H1 H2]. destruct (passed c) as [n|];
      [|discriminate].
    apply Nat.ltb_lt in H2. destruct (H n H1 eq_refl) as (j & E & _ & H3). eauto.
  Qed.
  Lemma begun_do_not_pass : forall k, existsb (fun pb => fst pb && snd pb)
    (combine (those_passing xs (states (path k)) (cases_at k)) (begun (path k))) = false.
  Proof.
    intros k. unfold cases_at. rewrite path_states, path_begun.
    assert (HY : forall ys, (forall y, In y ys -> In y xs) ->
      existsb (fun pb => fst pb && snd pb)
        (combine (those_passing ys (map (fun x => before_instant e t began x k) ys)
                                   (map (fun x => the_case e t began x k) ys))
                 (map (fun x => begun_before x k) ys)) = false); [|apply HY; auto].
    induction ys as [|x ys IH]; intros HI; [reflexivity|]. simpl. rewrite IH by (intros y Hy; apply HI; simpl; auto).
    rewrite orb_false_r. specialize (HI x (or_introl eq_refl)).
    destruct (the_case_fits e t began Ht dense x k (all_well_formed x HI)) as [_ H1].
    destruct (passes x (before_instant e t began x k) (the_case e t began x k)) eqn:E; auto. simpl.
    destruct k as [|j]; auto. destruct (begun_after x j) eqn:EB; auto. exfalso.
    destruct (begun_now x (all_well_formed x HI) j EB) as (HR & HT & HD).
    unfold passes in E. apply andb_true_iff in E. destruct E as [_ E]. destruct H1 as (_ & _ & _ & _ & H1 & _).
    destruct (passed (the_case e t began x (S j))) as [n|]; [|discriminate]. apply Nat.ltb_lt in E.
    destruct (H1 n HR eq_refl) as (i & Ei & Hn & _). injection Ei as <-. pose proof (dense j).
    destruct (bounds x) as [|d bs]; [destruct HD|]. cbn [count] in Hn.
    destruct (Nat.ltb_spec (base e t began x j + d) (t (S j))); lia.
  Qed.
  Lemma cases_begun : forall k, have_begun xs (states (path k)) (begun (path k)) (cases_at k) =
    map (fun x => has_begun x (before_instant e t began x k) (begun_before x k) (the_case e t began x k)) xs.
  Proof.
    intros k. rewrite path_states, path_begun. unfold cases_at.
    assert (HY : forall ys, have_begun ys (map (fun x => before_instant e t began x k) ys)
      (map (fun x => begun_before x k) ys) (map (fun x => the_case e t began x k) ys) =
      map (fun x => has_begun x (before_instant e t began x k) (begun_before x k) (the_case e t began x k)) ys);
      [|apply HY].
    induction ys as [|x ys IH]; simpl; auto. now rewrite IH.
  Qed.

  Hypothesis not_trivial : is_trivial news xs = false.

  (** The move at an instant; it is one at which a letter is held, if time has passed. *)
  Lemma move_at : forall k, exists l m,
    moves_by news xs (path k) (e k) (path (S k)) m /\ at_letter l (e k) = true /\
    (exists b, fair m = marks xs (cases_at k) ++ [b] /\ (forall j, k = S j -> t j < t k -> b = true)).
  Proof.
    intros k. destruct (cases_together k) as (l & A & B). exists l. pose proof (cases_next k) as HG.
    set (pass := those_passing xs (states (path k)) (cases_at k)).
    pose proof (passing_takes_time k) as HP. pose proof (begun_do_not_pass k) as HE. fold pass in HP, HE.
    unfold moves_by, moves. rewrite not_trivial.
    destruct (at_letter (settled news xs) (e k)) eqn:ES.
    - eexists. split; auto. split; [apply in_flat_map; exists (l, cases_at k); split; [exact A|]; cbn [snd];
      fold pass; rewrite HE; left;
        reflexivity|].
      + split; [simpl; simpl in ES; now rewrite B, ES|]. cbn [target]. rewrite HG. cbn [path states]. f_equal.
        unfold none_begun.
        apply map_ext. intros x. now rewrite begun_after_eq, ES.
      + split; auto. exists true. auto.
    - assert (HH : forall j, k = S j -> ~ t j < t k).
      { intros j -> Hj. rewrite (settled_held j Hj) in ES. discriminate ES. }
      assert (HN : existsb (fun p => p) pass = false).
      { destruct (existsb _ pass); auto. destruct HP as (j & E & Hj); auto. exfalso; now apply (HH j). }
      eexists. split; auto.
      split; [apply in_flat_map; exists (l, cases_at k); split; [exact A|]; apply in_app_iff; right; cbn [snd];
        fold pass; rewrite HN; left; reflexivity|].
      + split; [cbn [letters at_letter fst]; now rewrite B, ES|]. cbn [target snd]. rewrite HG, cases_begun.
        cbn [path states]. f_equal. apply map_ext. intros x. now rewrite begun_after_eq, ES.
      + split; auto. exists false. split; auto. intros j E Hj. exfalso. now apply (HH j).
  Qed.

  (** ** Time goes on *)

  Lemma after_running : forall x k, well_formed e t began x -> is_running x (after e t began x k) = true ->
    after e t began x k = (Running, count (bounds x) (base e t began x k) (t k)).
  Proof.
    assert (HO : forall x now r k, is_running x (once_state t x now r k) = true ->
              (match bounds x with [] => True | d :: bs => bs = [] end) ->
              once_state t x now r k = (Running, count (bounds x) (match r with Some j => t j | None => began end) (t
                k))).
    { intros x now r k H HB. unfold once_state in *. destruct r as [j|]; [|discriminate].
    destruct (bounds x) as [|d bs]; [discriminate|].
      subst bs. destruct now; [discriminate|]. simpl. destruct (t j + d <? t k); [discriminate | reflexivity]. }
    assert (HC : forall x r k, is_running x (counting t x r k) = true ->
              counting t x r k = (Running, count (bounds x) (match r with Some j => t j | None => began end) (t k))).
    { intros x [j|] k H; [reflexivity | discriminate]. }
    intros x k HW H. unfold well_formed in HW. unfold after, base in *.
    destruct (about x) as [[p|D p|D p|D p q|d p]|[o|o p q|o p]]; auto.
    - destruct (at_letter p (e k)); discriminate.
    - apply HO; auto. destruct HW as (a & _ & _ & HB). destruct D; [destruct HB as [-> _] | rewrite HB]; auto.
    - destruct (bounds x) as [|d bs] eqn:EB; [destruct (every_instant _ _ _); discriminate|]. rewrite <- EB.
    now apply HC.
    - apply HO; auto. destruct HW as (a & _ & _ & HB). destruct D; [destruct HB as [-> _] | rewrite HB]; auto.
    - now destruct (latest (fun j => at_letter p (e j)) k).
    - destruct (register _ _ k) as [j|]; [|discriminate]. destruct (at_letter p (e k)); [discriminate | reflexivity].
  Qed.

  Lemma count_all : forall bs from now, (forall d, In d bs -> from + d < now) -> count bs from now = length bs.
  Proof.
    induction bs as [|b bs IH]; simpl; intros from now H; auto. destruct (Nat.ltb_spec (from + b) now) as [_|HN].
    - f_equal. apply IH. auto.
    - specialize (H b (or_introl eq_refl)). lia.
  Qed.
  Lemma in_sum : forall (bs : list nat) d, In d bs -> d <= fold_right plus 0 bs.
  Proof. induction bs as [|b bs IH]; simpl; intros d H; [destruct H|]. destruct H as [<-|H]; [lia|].
  specialize (IH d H). lia. Qed.

  Lemma marks_of : forall k ys cs, Forall2 (fun x c => fits e t began x k c) ys cs ->
    length (marks ys cs) = length (filter has_bounds ys) /\
    forall i x, nth_error (filter has_bounds ys) i = Some x -> exists c, fits e t began x k c /\
      nth i (marks ys cs) false = goes_on x c.
  Proof.
    intros k ys cs H. induction H as [|y c ys cs Hf _ [IH1 IH2]]; simpl.
    - split; auto. intros [|i] x E; discriminate.
    - destruct (has_bounds y); simpl; [|auto]. split; [now rewrite IH1|]. intros [|i] x E; simpl in *; auto.
      injection E as <-. eauto.
  Qed.

  Lemma fair_step : forall i k cs m b, Forall2 (fun x c => fits e t began x k c) xs cs -> fair m = marks xs cs ++ [b] ->
    i < length (filter has_bounds xs) -> nth i (fair m) false = nth i (marks xs cs) false.
  Proof. intros i k cs m b HF -> Hi. apply app_nth1. now rewrite (proj1 (marks_of k xs cs HF)). Qed.

  Lemma clock_goes_on : forall i n, i < length (filter has_bounds xs) -> exists k m, n <= k /\
    moves_by news xs (path k) (e k) (path (S k)) m /\ nth i (fair m) false = true.
  Proof.
    intros i n Hi. destruct (nth_error (filter has_bounds xs) i) as [x|] eqn:E; [|apply nth_error_None in E; lia].
    assert (HW : well_formed e t began x).
    { apply all_well_formed. apply nth_error_In, filter_In in E. apply E. }
    set (fine := exists k m, n <= k /\ moves_by news xs (path k) (e k) (path (S k)) m /\ nth i (fair m) false = true).
    assert (HS : forall k, n <= k -> fine \/ exists c, fits e t began x k c /\ starts c = false /\
              is_running x (after e t began x k) = true).
    { intros k Hk. pose proof (cases_fit k) as HF. set (cs := cases_at k) in *.
      destruct (move_at k) as (l & m & HM & _ & (b & Hb & _)).
      fold cs in Hb.
      destruct (proj2 (marks_of k xs cs HF) i x E) as (c & Hc & Hn). destruct (goes_on x c) eqn:EG.
      - left. exists k, m. repeat split; auto; try apply HM. now rewrite (fair_step i k cs m b HF Hb Hi).
      - right. exists c. unfold goes_on in EG. apply orb_false_iff in EG. destruct EG as [E1 E2].
        destruct Hc as (H1 & H2 & H3 & H4). rewrite H3 in E2. apply negb_false_iff in E2.
        repeat split; auto; apply H4. }
    assert (HB : forall d, fine \/ (is_running x (after e t began x (n + d)) = true /\
              base e t began x (n + d) = base e t began x n)).
    { induction d as [|d [IH|[IH1 IH2]]]; auto.
      - rewrite Nat.add_0_r. destruct (HS n (le_n n)) as [H|(c & _ & _ & H)]; auto.
      - rewrite Nat.add_succ_r. destruct (HS (S (n + d))) as [H|(c & Hc & H1 & H2)]; [lia | auto |].
        right. split; auto. rewrite <- IH2. destruct Hc as (_ & _ & H3 & _ & _ & H4).
        unfold runs_from in H4. rewrite H3, H1 in H4. auto. }
    destruct (goes_on_for_ever (base e t began x n + fold_right plus 0 (bounds x))) as (N & HN).
    destruct (HB N) as [H|[H1 H2]]; auto. exfalso. pose proof (after_running x (n + N) HW H1) as HA. rewrite HA in H1.
    simpl in H1.
    rewrite count_all in H1; [now rewrite Nat.ltb_irrefl in H1|]. intros d Hd. rewrite H2.
    pose proof (in_sum (bounds x) d Hd).
    pose proof (Ht N (n + N)). lia.
  Qed.

  Lemma time_passes : forall n, exists k, n <= k /\ t k < t (S k).
  Proof.
    intros n. destruct (goes_on_for_ever (t n)) as (N & HN).
    assert (H : forall d, (exists k, n <= k /\ t k < t (S k)) \/ t (n + d) = t n).
    { induction d as [|d [IH|IH]]; [right; now rewrite Nat.add_0_r | auto |]. rewrite Nat.add_succ_r.
      pose proof (Ht (n + d) (S (n + d))). destruct (Nat.eq_dec (t (n + d)) (t (S (n + d)))); [right; lia|].
      left. exists (n + d). split; lia. }
    destruct (H N) as [H'|H']; auto. pose proof (Ht N (n + N)). lia.
  Qed.

  Theorem runs_are_words : word news xs e path.
  Proof.
    split; [reflexivity|]. split.
    - intros k. destruct (move_at k) as (l & m & HM & _). eauto.
    - unfold sets. rewrite not_trivial. intros i Hi n.
      destruct (Nat.eq_dec i (length (filter has_bounds xs))) as [->|Hne]; [|apply clock_goes_on; lia].
      destruct (time_passes n) as (j & Hj & Htj). pose proof (cases_fit (S j)) as HF.
      destruct (move_at (S j)) as (l & m & HM & _ & (b & Hb & Hs)).
      exists (S j), m. split; [lia|]. split; auto. rewrite Hb, <- (proj1 (marks_of (S j) xs _ HF)), app_nth2,
        Nat.sub_diag by lia.
      simpl. now apply (Hs j).
  Qed.
End Runs.

(** * The machine of a property *)
Section Property.
  Variables (defs : definitions) (p : property) (news : list nat) (xs : list tracker_of).

  Definition past_bounds (o : past) : list nat :=
    match o with
    | Once (Some d) _ | Since (Some d) _ _ | Age d _ => [d]
    | Historically (Some d) _ => [d - 1]
    | _ => []
    end.
  Definition positive (o : past) : Prop :=
    match o with Once (Some d) _ | Since (Some d) _ _ | Historically (Some d) _ => 0 < d | _ => True end.

  (** The trackers are those of the past operators in [defs] and of the clocks of p, each with all its bounds. *)
  Record trackers_of : Prop := {
    each_is_theirs : forall x, In x xs -> match about x with
      | Follows o => exists c, decides x = [c] /\ In (c, o) defs /\ bounds x = past_bounds o /\ positive o
      | Measures cl => length (decides x) = length (bounds x) /\ rising (bounds x) /\ ~ In 0 (bounds x) /\
          (forall i, i < length (bounds x) ->
             In {| atom_of := nth i (decides x) 0; clock_of := cl; bound_of := nth i (bounds x) 0 |} (timers WholeRun
               p)) /\
          match cl with SinceOpening (BeforeEvent _ _) => bounds x = [] | _ => True end
      end;
    all_are_there : forall a, (exists o, In (a, o) defs) \/ (exists y, In y (timers WholeRun p) /\ atom_of y = a) ->
      timed_atom news xs a = true;
    outer_first : placed [] xs;
    some_are_there : is_trivial news xs = false
  }.

  (** Each atom is defined once: by a past operator, by a timer, as news, or by the letters. *)
  Record own_atoms : Prop := {
    past_inside_out : inside_out defs;
    timers_their_own : own_timers p;
    timers_no_past : forall y c o, In y (timers WholeRun p) -> In (c, o) defs ->
      atom_of y <> c /\ asks o (atom_of y) = false;
    news_of_letters : forall a, In a news -> (forall o, ~ In (a, o) defs) /\ forall y, In y (timers WholeRun p) ->
      atom_of y <> a
  }.

  (** An observed run: an instant at every nanosecond, and where time passes, the letter is held without its news. *)
  Record observed (s : stream) (t : times) : Prop := {
    times_pass : passing t;
    every_nanosecond : forall k, t (S k) <= S (t k);
    time_goes_on : diverges t;
    letters_held : forall k, t k < t (S k) -> forall a, s (S k) a = negb (existsb (Nat.eqb a) news) && s k a
  }.

  (** The word to judge: the letters, with the past and the clocks. *)
  Definition timed_word (began : nat) (s : stream) (t : times) : stream := with_clocks p (with_past began defs s t) t.

  Lemma timed_word_elsewhere : forall began s t k a, (forall y, In y (timers WholeRun p) -> atom_of y <> a) ->
    timed_word began s t k a = with_past began defs s t k a.
  Proof.
    intros began s t k a H. unfold timed_word, with_clocks. destruct (find _ _) as [y|] eqn:E; auto.
    apply find_some in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E2. now destruct (H y E1).
  Qed.

  (** The word shows what the trackers follow. *)
  Lemma trackers_well_formed : trackers_of -> own_atoms -> forall s t began x, In x xs ->
    well_formed (timed_word began s t) t began x.
  Proof.
    intros HX HO s t began x Hx. set (e := timed_word began s t). pose proof (each_is_theirs HX x Hx) as H.
    unfold well_formed. destruct (about x) as [o|cl].
    - destruct H as (c & H1 & H2 & H3 & H4). exists c. split; auto. split.
      + intros k. unfold e. rewrite timed_word_elsewhere by (intros y Hy; now apply (timers_no_past HO y c o)).
        rewrite (past_means began defs s t c o k) by (auto; apply HO). apply value_same. intros j _. split; auto.
        intros a Ha. symmetry. apply timed_word_elsewhere. intros y Hy <-. destruct (timers_no_past HO y c o Hy H2).
        congruence.
      + destruct o as [q|[d|] q|[d|] q|[d|] q r|d q]; simpl in *; auto.
    - destruct H as (H1 & H2 & H3 & H4 & H5). repeat split; auto. intros i k Hi.
      exact (with_clocks_shown p (with_past began defs s t) t (timers_their_own HO) _ (H4 i Hi) k).
  Qed.

  (** Where time passes, the word is held: no news, and the atoms that nothing decides are what they were. *)
  Lemma word_held : trackers_of -> own_atoms -> forall s t began, observed s t -> forall k, t k < t (S k) ->
    (forall a, In a news -> timed_word began s t (S k) a = false) /\
    (forall a, timed_atom news xs a = false -> timed_word began s t (S k) a = timed_word began s t k a).
  Proof.
    intros HX HO s t began HS k Hk. pose proof (with_past_elsewhere began defs s t) as HP.
    pose proof (letters_held s t HS k Hk) as HL. split.
    - intros a Ha. destruct (news_of_letters HO a Ha) as [N1 N2]. rewrite timed_word_elsewhere by auto.
      rewrite HP by (intros c o H <-; now apply (N1 o)). rewrite HL.
      assert (E : existsb (Nat.eqb a) news = true) by (apply existsb_exists; exists a; split; auto; apply Nat.eqb_refl).
      now rewrite E.
    - intros a Ha. assert (HN : ~ ((exists o, In (a, o) defs) \/ exists y, In y (timers WholeRun p) /\ atom_of y = a)).
      { intros H. apply (all_are_there HX) in H. congruence. }
      assert (N1 : forall y, In y (timers WholeRun p) -> atom_of y <> a) by (intros y Hy E; apply HN; eauto).
      assert (N2 : forall c o, In (c, o) defs -> c <> a) by (intros c o H <-; apply HN; eauto).
      rewrite !timed_word_elsewhere, !HP, HL by auto. unfold timed_atom in Ha. apply orb_false_iff in Ha.
      now rewrite (proj1 Ha).
  Qed.

  (** Every observed run, with its past and its clocks, is a fair word of the machine. *)
  Theorem runs_of_property_are_words : trackers_of -> own_atoms -> forall s t began, observed s t ->
    word news xs (timed_word began s t) (path news xs (timed_word began s t) t began).
  Proof.
    intros HX HO s t began HS. apply runs_are_words; try apply HS; try apply HX; auto.
    - intros x Hx. now apply trackers_well_formed.
    - now apply word_held.
  Qed.
End Property.
