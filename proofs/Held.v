(** Letters that are held: what operators of the past and clocks are meanwhile, and what of them has to be remembered.

    A run has an instant at every nanosecond; a recording has a line where its letter changes. So a run is followed
    part by part: in a [part], all instants have one letter. [next_part] works out from the first and the last of them
    what operators of the past and clocks are at all of them, and gives None if they differ between the two: then the
    part has to be cut. What it gives is right: [past_part_right], [clock_part_right], [next_part_right].

    Python: [ltlc/assurance/evidence/parts.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Resets ClockSteps Certificate.

(** Some instants, one after the other, with one letter: the times of the first and of the last. Of a [single] one it
    is known that it is only one. *)
Record part := { lets : letter; from : nat; upto : nat; single : bool }.

(** The instants of a run from m on, before n, are those of a part. *)
Definition part_of (s : stream) (t : times) (m n : nat) (x : part) : Prop :=
  m < n /\ (forall k, m <= k < n -> forall a, s k a = lets x a) /\ t m = from x /\ t (n - 1) = upto x /\
  (single x = true -> n = S m).

(** * The past: what is remembered is the time of one instant, and whether it is the first *)

Definition kept := option (bool * nat).
Definition within (D : bound) (e u : nat) : bool := match D with None => true | Some d => u <=? e + d end.

(** Its value at the first and at the last instant of a part, and what is remembered then. *)
Definition past_part (began : nat) (o : past) (is_first : bool) (r : kept) (x : part) : bool * bool * kept :=
  let here p := at_letter p (lets x) in
  let ends f r' := (f (from x), f (upto x), r') in
  let now := Some (false, upto x) in
  let since D u := match r with Some (_, e) => within D e u | None => false end in
  match o with
  | Previously p => let v := match r with Some (b, _) => b | None => false end in
      (v, (if single x then v else here p), Some (here p, 0))
  | Once D p => if here p then (true, true, now) else ends (since D) r
  | Historically D p =>
      if here p then
        let r' := match r with Some _ => r | None => Some (is_first, from x) end in
        let lasts u := match r', D with Some (z, _), None => z | Some (_, e), Some d => e + d <=? u | None, _ => false end in
        ends lasts r'
      else (false, false, None)
  | Since D p q => if here q then (true, true, now) else if here p then ends (since D) r else (false, false, None)
  | Age d p => if here p then (true, true, now)
               else ends (fun u => u <=? match r with Some (_, e) => e | None => began end + d) r
  end.

Section Part.
  Variables (s : stream) (t : times) (began m n : nat) (x : part).
  Hypothesis Ht : passing t.
  Hypothesis Hmn : m < n.
  Hypothesis same : forall k, m <= k < n -> forall a, s k a = lets x a.
  Hypothesis Hfrom : t m = from x.
  Hypothesis Hupto : t (n - 1) = upto x.
  Hypothesis Hsingle : single x = true -> n = S m.

  Lemma here : forall p k, m <= k < n -> at_letter p (s k) = at_letter p (lets x).
  Proof. intros p k Hk. apply at_letter_same. intros a _. auto. Qed.

  Lemma between : forall k, m <= k < n -> from x <= t k <= upto x.
  Proof. intros k Hk. pose proof (Ht m k). pose proof (Ht k (n - 1)). lia. Qed.

  Definition remembered (o : past) (k : nat) : kept :=
    let at_ p j := at_letter p (s j) in
    let timed := option_map (fun j => (false, t j)) in
    match o with
    | Previously p => Some (at_ p k, 0)
    | Once _ p | Age _ p => timed (latest (at_ p) k)
    | Historically _ p => option_map (fun j => (j =? 0, t j)) (since_when (at_ p) k)
    | Since _ p q => timed (kept_since (at_ p) (at_ q) k)
    end.
  Definition remembered_before (o : past) : kept := match m with 0 => None | S j => remembered o j end.

  (** What a fold over instants gives where the letter stays. *)
  Lemma latest_here : forall p k, m <= k < n -> latest (fun j => at_letter p (s j)) k =
    if at_letter p (lets x) then Some k
    else match m with 0 => None | S j => latest (fun j => at_letter p (s j)) j end.
  Proof.
    intros p k Hk. replace k with (m + (k - m)) by lia. assert (Hd : m + (k - m) < n) by lia. revert Hd.
    generalize (k - m). clear k Hk. induction n0 as [|d IH]; intros Hd.
    - rewrite Nat.add_0_r in *. pose proof (here p m ltac:(lia)) as HE. destruct m; simpl; rewrite HE;
        destruct (at_letter p (lets x)); auto.
    - rewrite Nat.add_succ_r in *. simpl. rewrite (here p) by lia. destruct (at_letter p (lets x)) eqn:E; auto.
      rewrite IH by lia. reflexivity.
  Qed.

  Lemma since_here : forall p k, m <= k < n -> since_when (fun j => at_letter p (s j)) k =
    if at_letter p (lets x) then
      match match m with 0 => None | S j => since_when (fun j => at_letter p (s j)) j end with
      | Some i => Some i
      | None => Some m
      end
    else None.
  Proof.
    intros p k Hk. replace k with (m + (k - m)) by lia. assert (Hd : m + (k - m) < n) by lia. revert Hd.
    generalize (k - m). clear k Hk. induction n0 as [|d IH]; intros Hd.
    - rewrite Nat.add_0_r in *. pose proof (here p m ltac:(lia)) as HE. destruct m; simpl; rewrite HE;
        destruct (at_letter p (lets x)); auto.
    - rewrite Nat.add_succ_r in *. simpl. rewrite (here p) by lia. destruct (at_letter p (lets x)) eqn:E; auto.
      rewrite IH by lia. destruct (match m with 0 => None | S j => since_when (fun j => at_letter p (s j)) j end); auto.
  Qed.

  Lemma kept_here : forall p q k, m <= k < n -> kept_since (fun j => at_letter p (s j)) (fun j => at_letter q (s j)) k =
    if at_letter q (lets x) then Some k
    else if at_letter p (lets x) then
      match m with 0 => None | S j => kept_since (fun j => at_letter p (s j)) (fun j => at_letter q (s j)) j end
    else None.
  Proof.
    intros p q k Hk. replace k with (m + (k - m)) by lia. assert (Hd : m + (k - m) < n) by lia. revert Hd.
    generalize (k - m). clear k Hk. induction n0 as [|d IH]; intros Hd.
    - rewrite Nat.add_0_r in *. pose proof (here p m ltac:(lia)) as HE. pose proof (here q m ltac:(lia)) as HF.
      destruct m; simpl; rewrite HE, HF; destruct (at_letter q (lets x)), (at_letter p (lets x)); auto.
    - rewrite Nat.add_succ_r in *. simpl. rewrite (here p), (here q) by lia.
      destruct (at_letter q (lets x)) eqn:E; auto. destruct (at_letter p (lets x)) eqn:F;
        auto. rewrite IH by lia. reflexivity.
  Qed.

  Lemma falls : forall e d k, m <= k < n -> (from x <=? e + d) = (upto x <=? e + d) ->
    (t k <=? e + d) = (from x <=? e + d).
  Proof.
    intros e d k Hk H. pose proof (between k Hk).
    destruct (Nat.leb_spec (from x) (e + d)), (Nat.leb_spec (upto x) (e + d)), (Nat.leb_spec (t k) (e + d)); auto;
      try discriminate; lia.
  Qed.
  Lemma rises : forall e k, m <= k < n -> (e <=? from x) = (e <=? upto x) -> (e <=? t k) = (e <=? from x).
  Proof.
    intros e k Hk H. pose proof (between k Hk).
    destruct (Nat.leb_spec e (from x)), (Nat.leb_spec e (upto x)), (Nat.leb_spec e (t k)); auto; try discriminate; lia.
  Qed.

  Ltac recent_now := simpl; match goal with D : bound |- _ => destruct D; simpl; auto; apply Nat.leb_le; lia end.

  Lemma pull_out : forall (f : nat -> bool * nat) (g : nat -> option nat),
    match m return kept with 0 => None | S j => option_map f (g j) end =
    option_map f (match m with 0 => None | S j => g j end).
  Proof. intros. destruct m; reflexivity. Qed.

  (** If the value is the same at the first and the last instant, it is that at all; and what is remembered is right. *)
  Theorem past_part_right : forall o v r', past_part began o (m =? 0) (remembered_before o) x = (v, v, r') ->
    (forall k, m <= k < n -> tracked s t began o k = v) /\ remembered o (n - 1) = r'.
  Proof.
    intros o v r' H. destruct o as [p|D p|D p|D p q|d p]; unfold past_part, remembered_before in H;
      cbn [tracked remembered] in *.
    - injection H as H1 H2 H3. split; [|rewrite <- H3, here by lia; reflexivity].
      intros k Hk. destruct (Nat.eq_dec k m) as [->|Hne]; [rewrite <- H1; destruct m; reflexivity|].
      destruct (single x); [specialize (Hsingle eq_refl); lia|]. destruct k as [|j];
        [lia|]. rewrite here by lia. congruence.
    - rewrite (pull_out (fun j => (false, t j)) (latest (fun j => at_letter p (s j)))) in H.
        rewrite (latest_here p (n - 1)) by lia. destruct (at_letter p (lets x)) eqn:E.
      + injection H as <- _ <-. split; [|simpl; now rewrite Hupto]. intros k Hk. rewrite latest_here, E by auto.
          recent_now.
      + injection H as H1 H2 H3. split; [|exact H3]. intros k Hk. rewrite latest_here, E by auto. rewrite <- H1.
          rewrite <- H1 in H2.
        destruct (match m with 0 => None | S j => latest _ j end) as [j|]; auto. destruct D as [d|]; auto.
        simpl in *. symmetry in H2. now apply falls.
    - rewrite (pull_out (fun j => (j =? 0, t j)) (since_when (fun j => at_letter p (s j)))) in H.
        rewrite (since_here p (n - 1)) by lia. destruct (at_letter p (lets x)) eqn:E.
      + injection H as H1 H2 H3. rewrite <- H1 in H2.
        assert (HR : option_map (fun j => (j =? 0, t j))
          (match match m with 0 => None | S j => since_when (fun j => at_letter p (s j)) j end with Some i => Some i |
            None => Some m end) = r').
        { rewrite <- H3. destruct (match m with 0 => None | S j => since_when _ j end); simpl;
            auto. now rewrite Hfrom. }
        split; auto. intros k Hk. rewrite since_here, E by auto. rewrite <- H1. rewrite H3, <- HR in *. clear HR H3 H1.
        destruct (match match m with 0 => None | S j => since_when _ j end with Some i => Some i | None => Some m end)
          as [i|]; auto.
        simpl in *. destruct D as [d|]; simpl; auto. symmetry in H2. now apply rises.
      + injection H as <- _ <-. split; auto. intros k Hk. rewrite since_here, E by auto. reflexivity.
    - rewrite (pull_out (fun j => (false, t j)) (kept_since (fun j => at_letter p (s j)) (fun j => at_letter q (s
        j)))) in H.
      rewrite (kept_here p q (n - 1)) by lia. destruct (at_letter q (lets x)) eqn:E.
      + injection H as <- _ <-. split; [|simpl; now rewrite Hupto]. intros k Hk. rewrite kept_here, E by auto.
          recent_now.
      + destruct (at_letter p (lets x)) eqn:F.
        * injection H as H1 H2 H3. split; [|exact H3]. intros k Hk. rewrite kept_here, E, F by auto. rewrite <- H1.
            rewrite <- H1 in H2.
          destruct (match m with 0 => None | S j => kept_since _ _ j end) as [j|]; auto. destruct D as [d|]; auto.
          simpl in *. symmetry in H2. now apply falls.
        * injection H as <- _ <-. split; auto. intros k Hk. rewrite kept_here, E, F by auto. reflexivity.
    - rewrite (pull_out (fun j => (false, t j)) (latest (fun j => at_letter p (s j)))) in H.
        rewrite (latest_here p (n - 1)) by lia. destruct (at_letter p (lets x)) eqn:E.
      + injection H as <- _ <-. split; [|simpl; now rewrite Hupto]. intros k Hk. rewrite latest_here, E by auto.
          apply Nat.leb_le. lia.
      + injection H as H1 H2 H3. split; [|exact H3]. intros k Hk. rewrite latest_here, E by auto. rewrite <- H1.
          rewrite <- H1 in H2.
        destruct (match m with 0 => None | S j => latest _ j end) as [j|]; simpl in *; symmetry in H2; now apply falls.
  Qed.
End Part.

(** * Clocks: of each scope around a clock, when it opened *)

(** Since when a scope and those around it are open at a part, and whether it opens there. *)
Fixpoint open_part (o : scope) (x : part) (is_first : bool) (before : list (option nat)) : list (option nat) * bool :=
  let inside o (f : option nat -> list (option nat) -> list (option nat) * bool) :=
    let '(outer, fresh) := open_part o x is_first (tl before) in
    match hd None outer with
    | None => (None :: outer, false)
    | Some _ => f (if fresh then None else hd None before) outer
    end in
  let opened e r (outer : list (option nat)) :=
    match r with
    | Some _ => (r :: outer, false)
    | None => if at_letter e (lets x) then (Some (from x) :: outer, true) else (None :: outer, false)
    end in
  match o with
  | WholeRun => ([if is_first then Some (from x) else hd None before], is_first)
  | AfterEvent o e => inside o (opened e)
  | Episodes o e y => inside o (fun r outer => if at_letter y (lets x) then (None :: outer,
    false) else opened e r outer)
  | BeforeEvent o y =>
      let '(outer, fresh) := open_part o x is_first (tl before) in
      if at_letter y (lets x) then (None :: outer, false)
      else match hd None outer with
           | None => (None :: outer, false)
           | Some _ => ((if fresh then Some (from x) else hd None before) :: outer, fresh)
           end
  end.

(** What a clock remembers: from when it counts, and its scopes. *)
Definition clock_state : Type := option nat * list (option nat).
Definition past_by (d : nat) (r : option nat) (u : nat) : bool := match r with Some e => e + d <? u | None => false end.

Definition clock_part (cl : clock) (d : nat) (x : part) (is_first : bool) (before : clock_state) : bool * bool *
  clock_state :=
  match cl with
  | SinceOpening o =>
      let '(c, _) := open_part o x is_first (snd before) in
      (past_by d (hd None c) (from x), past_by d (hd None c) (upto x), (None, c))
  | FirstOpen o p q =>
      let '(c, fresh) := open_part o x is_first (snd before) in
      match hd None c with
      | None => (false, false, (None, c))
      | Some _ =>
          let r := if fresh then None else fst before in
          let r' := if at_letter q (lets x) then None
                    else match r with Some _ => r | None => if at_letter p (lets x) then Some (from x) else None end in
          (past_by d r (from x), (if single x then past_by d r (from x) else past_by d r' (upto x)), (r', c))
      end
  | LastTrigger o p =>
      let '(c, fresh) := open_part o x is_first (snd before) in
      match hd None c with
      | None => (false, false, (None, c))
      | Some _ =>
          if at_letter p (lets x) then (false, false, (Some (upto x), c))
          else let r := if fresh then None else fst before in (past_by d r (from x), past_by d r (upto x), (r, c))
      end
  end.

Section ClockPart.
  Variables (s : stream) (t : times) (m n : nat) (x : part).
  Hypothesis Ht : passing t.
  Hypothesis Hmn : m < n.
  Hypothesis same : forall k, m <= k < n -> forall a, s k a = lets x a.
  Hypothesis Hfrom : t m = from x.
  Hypothesis Hupto : t (n - 1) = upto x.
  Hypothesis Hsingle : single x = true -> n = S m.

  Notation at_time := (option_map t).
  Definition chain : scope -> nat -> list (option nat) := fix chain o k :=
    at_time (scope_tracker o s k) ::
    match o with WholeRun => [] | AfterEvent o _ | BeforeEvent o _ | Episodes o _ _ => chain o k end.
  (** What was remembered before the part. *)
  Definition given {A} (nothing : A) (f : nat -> A) : A := match m with 0 => nothing | S j => f j end.

  Lemma chain_hd : forall o k, hd None (chain o k) = at_time (scope_tracker o s k).
  Proof. intros [] k; reflexivity. Qed.

  (** A register at the first instant, by whether its scope opens there. *)
  Lemma register_first : forall f tr, (forall a, tr m = Some a -> a <= m) ->
    register f tr m = match tr m with None => None | Some a => f (if a =? m then
      None else given None (register f tr)) m end.
  Proof.
    intros f tr HB. rewrite register_eq. unfold before, given. destruct (tr m) as [a|] eqn:E;
      auto. specialize (HB a eq_refl).
    destruct m as [|j]; [destruct a; [reflexivity | lia]|].
    destruct (Nat.leb_spec a j), (Nat.eqb_spec a (S j)); try lia; reflexivity.
  Qed.

  Definition opens_now (o : scope) : bool := match scope_tracker o s m with Some a => a =? m | None => false end.

  Lemma given_hd : forall o rest before,
    (m = 0 \/ before = given [] (fun j => at_time (scope_tracker o s j) :: rest j)) -> m <> 0 ->
    hd None before = at_time (given None (scope_tracker o s)).
  Proof. intros o rest before [-> | ->] Hm; [congruence|]. unfold given. destruct m; [congruence|]. reflexivity. Qed.

  Lemma uncut_is : forall y tr r k, uncut y s tr r k =
    if at_letter y (s k) then None else match tr k with Some a => if a =? k then Some k else r | None => None end.
  Proof. reflexivity. Qed.

  Lemma episode_is : forall e y r k, episode e y s r k = if at_letter y (s k) then None else opened e s r k.
  Proof. reflexivity. Qed.

  (** Which scopes are open at the first instant, since when, and whether the innermost opens there. *)
  Theorem open_part_right : forall o before, (m = 0 \/ before = given [] (chain o)) ->
    open_part o x (m =? 0) before = (chain o m, opens_now o).
  Proof.
    assert (HS : forall e, at_letter e (lets x) = at_letter e (s m)) by (intros e; apply at_letter_same; intros;
      symmetry; apply same; lia).
    assert (HT : forall o before, (m = 0 \/ before = given [] (fun j => chain o j)) ->
      m = 0 \/ before = given [] (chain o)) by auto.
    assert (HR : forall f o, (if match scope_tracker o s m with Some a => a =? m | None => false end then None
        else at_time (given None (register f (scope_tracker o s)))) =
        at_time (match scope_tracker o s m with Some a => if a =? m then
          None else given None (register f (scope_tracker o s)) | None => given None (register f (scope_tracker o s))
            end)).
    { intros f o. destruct (scope_tracker o s m) as [a|]; auto. destruct (a =? m); auto. }
    induction o as [|o IH e|o IH y|o IH e y]; intros before HB.
    - unfold opens_now. simpl. destruct (Nat.eqb_spec m 0) as [E|E].
      + rewrite E in *. rewrite Hfrom. reflexivity.
      + destruct HB as [|HB]; [congruence|]. rewrite HB. unfold given. destruct m; [congruence|]. reflexivity.
    - assert (HI : m = 0 \/ tl before = given [] (chain o)) by (destruct HB as [ | ->]; auto; right; unfold given;
        destruct m; reflexivity).
      assert (HH : m <> 0 -> hd None before = at_time (given None (scope_tracker (AfterEvent o e) s))).
      { intros Hm. destruct HB as [ | ->]; [congruence|]. unfold given. destruct m; [congruence | reflexivity]. }
      cbn [open_part]. rewrite (IH _ HI), chain_hd. unfold opens_now in *. cbn [chain]. simpl scope_tracker in *.
      rewrite register_first by apply scope_backward. pose proof (scope_backward o s m) as HBk.
      destruct (scope_tracker o s m) as [a|] eqn:E; simpl; auto. specialize (HBk a eq_refl).
      destruct (Nat.eqb_spec a m) as [Ea|Ea].
      + simpl. rewrite HS. destruct (at_letter e (s m)); simpl; [now rewrite Nat.eqb_refl, Hfrom | reflexivity].
      + rewrite HH by lia. destruct (given None (register (opened e s) (scope_tracker o s))) as [r|] eqn:G; simpl.
        * replace (r =? m) with false; auto. symmetry. apply Nat.eqb_neq. unfold given in G. destruct m;
            [discriminate|].
          apply (register_backward _ _ (opened_remembers e s)) in G. lia.
        * rewrite HS. destruct (at_letter e (s m)); simpl; [now rewrite Nat.eqb_refl, Hfrom | reflexivity].
    - assert (HI : m = 0 \/ tl before = given [] (chain o)) by (destruct HB as [ | ->]; auto; right; unfold given;
        destruct m; reflexivity).
      assert (HH : m <> 0 -> hd None before = at_time (given None (scope_tracker (BeforeEvent o y) s))).
      { intros Hm. destruct HB as [ | ->]; [congruence|]. unfold given. destruct m; [congruence | reflexivity]. }
      cbn [open_part]. rewrite (IH _ HI), chain_hd. unfold opens_now in *. cbn [chain]. simpl scope_tracker in *.
      rewrite register_first by apply scope_backward. pose proof (scope_backward o s m) as HBk. rewrite HS.
      destruct (scope_tracker o s m) as [a|] eqn:E; [specialize (HBk a eq_refl); rewrite uncut_is, E|];
        destruct (at_letter y (s m)); auto.
      destruct (Nat.eqb_spec a m) as [Ea|Ea]; simpl; [now rewrite Nat.eqb_refl, Hfrom|]. rewrite HH by lia.
      destruct (given None (register (uncut y s (scope_tracker o s)) (scope_tracker o s))) as [r|] eqn:G; simpl; auto.
      replace (r =? m) with false; auto. symmetry. apply Nat.eqb_neq. unfold given in G. destruct m; [discriminate|].
      apply (register_backward _ _ (uncut_remembers y s _)) in G. lia.
    - assert (HI : m = 0 \/ tl before = given [] (chain o)) by (destruct HB as [ | ->]; auto; right; unfold given;
        destruct m; reflexivity).
      assert (HH : m <> 0 -> hd None before = at_time (given None (scope_tracker (Episodes o e y) s))).
      { intros Hm. destruct HB as [ | ->]; [congruence|]. unfold given. destruct m; [congruence | reflexivity]. }
      cbn [open_part]. rewrite (IH _ HI), chain_hd. unfold opens_now in *. cbn [chain]. simpl scope_tracker in *.
      rewrite register_first by apply scope_backward. pose proof (scope_backward o s m) as HBk.
      destruct (scope_tracker o s m) as [a|] eqn:E; simpl; auto. specialize (HBk a eq_refl). rewrite !HS, episode_is.
      destruct (at_letter y (s m)); auto. unfold opened at 1 2.
      destruct (Nat.eqb_spec a m) as [Ea|Ea].
      + simpl. destruct (at_letter e (s m)); simpl; [now rewrite Nat.eqb_refl, Hfrom | reflexivity].
      + rewrite HH by lia. destruct (given None (register (episode e y s) (scope_tracker o s))) as [r|] eqn:G; simpl.
        * replace (r =? m) with false; auto. symmetry. apply Nat.eqb_neq. unfold given in G. destruct m;
            [discriminate|].
          apply (register_backward _ _ (episode_remembers e y s)) in G. lia.
        * destruct (at_letter e (s m)); simpl; [now rewrite Nat.eqb_refl, Hfrom | reflexivity].
  Qed.

  Lemma scope_same : forall o k, m <= k < n -> scope_tracker o s k = scope_tracker o s m.
  Proof.
    intros o k Hk. replace k with (m + (k - m)) by lia. assert (Hd : m + (k - m) < n) by lia. revert Hd.
    generalize (k - m). clear k Hk. induction n0 as [|d IH]; intros Hd; [now rewrite Nat.add_0_r|].
    rewrite Nat.add_succ_r in *. rewrite scope_repeated; [apply IH; lia|]. intros a. rewrite !same by lia. reflexivity.
  Qed.
  Lemma chain_same : forall o k, m <= k < n -> chain o k = chain o m.
  Proof. induction o; intros k Hk; cbn [chain]; rewrite scope_same by auto; rewrite ?IHo by auto; reflexivity. Qed.

  Definition clock_memory (cl : clock) (k : nat) : clock_state :=
    match cl with
    | SinceOpening o => (None, chain o k)
    | FirstOpen o p q => (at_time (register (episode p q s) (scope_tracker o s) k), chain o k)
    | LastTrigger o p => (at_time (register (trigger p s) (scope_tracker o s) k), chain o k)
    end.

  Lemma before_first : forall f tr a, tr m = Some a -> a <= m ->
    before f tr m = if a =? m then None else given None (register f tr).
  Proof.
    intros f tr a E Ha. unfold before, given. rewrite E. destruct m as [|j]; [destruct a; [reflexivity | lia]|].
    destruct (Nat.leb_spec a j), (Nat.eqb_spec a (S j)); try lia; reflexivity.
  Qed.
  Lemma before_later : forall f tr a k, tr k = Some a -> a <= m -> m < k -> before f tr k = register f tr (k - 1).
  Proof.
    intros f tr a k E Ha Hk. unfold before. rewrite E. destruct k as [|j]; [lia|]. simpl. rewrite Nat.sub_0_r.
    destruct (Nat.leb_spec a j); auto; lia.
  Qed.

  (** What a register that stays in the part is at its instants. *)
  Lemma register_same : forall f tr a, (forall k, m <= k < n -> tr k = Some a) -> a <= m ->
    (forall k, m <= k -> S k < n -> forall r, f (f r k) (S k) = f r k) ->
    forall k, m <= k < n -> register f tr k = f (before f tr m) m.
  Proof.
    intros f tr a HT Ha HF k Hk. replace k with (m + (k - m)) by lia. assert (Hd : m + (k - m) < n) by lia. revert Hd.
    generalize (k - m). clear k Hk.
    assert (H : forall d, m + d < n -> register f tr (m + d) = f (before f tr m) m /\
      exists r, register f tr (m + d) = f r (m + d)).
    { induction d as [|d IH]; intros Hd.
      - rewrite Nat.add_0_r. rewrite register_eq, HT by lia. eauto.
      - destruct (IH ltac:(lia)) as (H1 & r & H2). rewrite Nat.add_succ_r in *. rewrite register_eq, HT by lia.
        rewrite (before_later f tr a) by (auto; try lia; apply HT; lia). simpl. rewrite Nat.sub_0_r. split; [|eauto].
        rewrite H2. rewrite HF by lia. now rewrite <- H2. }
    intros d Hd. now apply H.
  Qed.

  Lemma later_still : forall d r k, m <= k < n -> past_by d r (from x) = past_by d r (upto x) ->
    past_by d r (t k) = past_by d r (from x).
  Proof.
    intros d [e|] k Hk H; auto. simpl in *. pose proof (Ht m k). pose proof (Ht k (n - 1)).
    destruct (Nat.ltb_spec (e + d) (from x)), (Nat.ltb_spec (e + d) (upto x)), (Nat.ltb_spec (e + d) (t k)); auto;
      try discriminate; lia.
  Qed.

  Lemma older_is : forall d r k, older t d r k = past_by d (at_time r) (t k).
  Proof. intros d [j|] k; reflexivity. Qed.

  (** Of a clock the same as of the past: whether it is late, and what it remembers. *)
  Theorem clock_part_right : forall cl d before_ v st', (m = 0 \/ before_ = given (None, []) (clock_memory cl)) ->
    clock_part cl d x (m =? 0) before_ = (v, v, st') ->
    (forall k, m <= k < n -> older t d (counts_from cl s k) k = v) /\ clock_memory cl (n - 1) = st'.
  Proof.
    intros cl d before_ v st' HB H.
    assert (HS : forall e, at_letter e (lets x) = at_letter e (s m)) by (intros e; apply at_letter_same; intros;
      symmetry; apply same; lia).
    assert (HC : forall o, (forall k, clock_memory cl k = (fst (clock_memory cl k), chain o k)) ->
      m = 0 \/ snd before_ = given [] (chain o)).
    { intros o E. destruct HB as [ | ->]; auto. right. unfold given. destruct m; auto. now rewrite E. }
    assert (HF : forall f o a, (forall k, fst (clock_memory cl k) = at_time (register f (scope_tracker o s) k)) ->
              scope_tracker o s m = Some a ->
              (if a =? m then None else fst before_) = at_time (before f (scope_tracker o s) m)).
    { intros f o a E Ea. pose proof (scope_backward o s m a Ea) as Ha. rewrite (before_first f _ a Ea Ha).
      destruct (Nat.eqb_spec a m); auto. destruct HB as [ | ->]; [lia|]. unfold given. destruct m;
        [lia|]. now rewrite E. }
    destruct cl as [o|o p q|o p]; cbn [clock_part] in H.
    - rewrite (open_part_right o _ (HC o ltac:(reflexivity))), chain_hd in H. injection H as H1 H2 H3. split.
      + intros k Hk. cbn [counts_from]. rewrite scope_same, older_is by auto. rewrite <- H1. apply later_still;
          auto. congruence.
      + rewrite <- H3. simpl. now rewrite chain_same by lia.
    - rewrite (open_part_right o _ (HC o ltac:(reflexivity))), chain_hd in H. unfold opens_now in H.
      cbn [counts_from clock_memory]. rewrite chain_same by lia.
      destruct (scope_tracker o s m) as [a|] eqn:E; simpl in H.
      + pose proof (scope_backward o s m a E) as Ha.
        assert (HT : forall k, m <= k < n -> scope_tracker o s k = Some a) by (intros; rewrite scope_same; auto).
        pose proof (HF (episode p q s) o a ltac:(reflexivity) E) as HF1.
          set (b := before (episode p q s) (scope_tracker o s) m) in *.
        rewrite HF1 in H. set (r' := episode p q s b m).
        assert (HR : forall k, m <= k < n -> register (episode p q s) (scope_tracker o s) k = r').
        { apply (register_same _ _ a); auto. intros k Hk HSk r. apply episode_twice. intros c. rewrite !same by lia.
            reflexivity. }
        assert (HR' : (if at_letter q (lets x) then None else match at_time b with Some _ => at_time b
                       | None => if at_letter p (lets x) then Some (from x) else None end) = at_time r').
        { unfold r'. rewrite episode_is, !HS. destruct (at_letter q (s m)); auto. destruct b; auto. simpl.
          destruct (at_letter p (s m)); simpl; rewrite ?Hfrom; auto. }
        rewrite HR' in H. injection H as H1 H2 H3. split; [|rewrite HR by lia; exact H3].
        intros k Hk. rewrite older_is. destruct (Nat.eq_dec k m) as [->|Hne]; [fold b; now rewrite Hfrom|].
        rewrite (before_later _ _ a) by (auto; lia). rewrite HR by lia.
        assert (Es : single x = false) by (destruct (single x); auto; specialize (Hsingle eq_refl);
          lia). rewrite Es in H2.
        assert (HM : past_by d (at_time r') (from x) = past_by d (at_time r') (upto x)).
        { rewrite H2. pose proof (Ht m (n - 1)) as Hends. destruct v.
          - unfold r' in *. rewrite episode_is in *. destruct (at_letter q (s m)); [discriminate H2|].
            destruct b as [j|]; [exact H1 | discriminate H1].
          - destruct (at_time r') as [e|]; [|reflexivity]. simpl in *. rewrite Nat.ltb_ge in *. lia. }
        rewrite later_still by auto. congruence.
      + injection H as <- _ <-. split.
        * intros k Hk. unfold before. rewrite scope_same, E by auto. reflexivity.
        * rewrite register_eq, scope_same, E by lia. reflexivity.
    - rewrite (open_part_right o _ (HC o ltac:(reflexivity))), chain_hd in H. unfold opens_now in H.
      cbn [counts_from clock_memory]. rewrite chain_same by lia.
      destruct (scope_tracker o s m) as [a|] eqn:E; simpl in H.
      + pose proof (scope_backward o s m a E) as Ha.
        assert (HT : forall k, m <= k < n -> scope_tracker o s k = Some a) by (intros; rewrite scope_same; auto).
        assert (HL : forall k, m <= k < n -> at_letter p (s k) = at_letter p (lets x)).
        { intros k Hk. apply at_letter_same. intros c _. now apply same. }
        destruct (at_letter p (lets x)) eqn:Ep.
        * assert (HR : forall k, m <= k < n -> register (trigger p s) (scope_tracker o s) k = Some k).
          { intros k Hk. rewrite register_eq, HT by auto. unfold trigger. now rewrite HL by auto. }
          injection H as <- _ <-. split; [|rewrite HR by lia; simpl; now rewrite Hupto].
          intros k Hk. rewrite HR by auto. simpl. apply Nat.ltb_ge. lia.
        * pose proof (HF (trigger p s) o a ltac:(reflexivity) E) as HF1. rewrite HF1 in H. injection H as H1 H2 H3.
          assert (HR : forall k, m <= k < n -> register (trigger p s) (scope_tracker o s) k = before (trigger p s)
            (scope_tracker o s) m).
          { intros k Hk. rewrite (register_same _ _ a) by (auto; intros j J1 J2 r; unfold trigger; rewrite !HL by lia;
              reflexivity).
            unfold trigger at 1. now rewrite HL by lia. }
          split; [|rewrite HR by lia; exact H3].
          intros k Hk. rewrite HR, older_is by auto. rewrite later_still; auto. congruence.
      + injection H as <- _ <-. split.
        * intros k Hk. rewrite register_eq, scope_same, E by auto. reflexivity.
        * rewrite register_eq, scope_same, E by lia. reflexivity.
  Qed.
End ClockPart.

(** * A run, part by part *)

Fixpoint past_parts (began : nat) (defs : definitions) (is_first : bool) (rs : list kept) (x : part) : option (part *
  list kept) :=
  match defs with
  | [] => Some (x, [])
  | (c, o) :: defs =>
      let '(v, w, r) := past_part began o is_first (hd None rs) x in
      let y := {| lets := fun a => if a =? c then v else lets x a; from := from x; upto := upto x;
        single := single x |} in
      if Bool.eqb v w then
        match past_parts began defs is_first (tl rs) y with Some (z, rs) => Some (z, r :: rs) | None => None end
      else None
  end.

Fixpoint clock_parts (ts : list timer) (is_first : bool) (cs : list clock_state) (x : part) : option (list bool * list
  clock_state) :=
  match ts with
  | [] => Some ([], [])
  | y :: ts =>
      let '(v, w, c) := clock_part (clock_of y) (bound_of y) x is_first (hd (None, []) cs) in
      if Bool.eqb v w then
        match clock_parts ts is_first (tl cs) x with Some (vs, cs) => Some (v :: vs, c :: cs) | None => None end
      else None
  end.

Definition timed_letter (ts : list timer) (vs : list bool) (l : letter) : letter := fun a =>
  match find (fun e => atom_of (fst e) =? a) (combine ts vs) with Some e => snd e | None => l a end.

Definition memory : Type := list kept * list clock_state.
(** The letter of a part, with its past and its clocks, which are the same at all of its instants; and what is
    remembered then. None: they are not the same. *)
Definition next_part (began : nat) (defs : definitions) (ts : list timer) (is_first : bool) (r : memory) (x : part) :
  option (letter * memory) :=
  match past_parts began defs is_first (fst r) x with
  | Some (y, rs) => match clock_parts ts is_first (snd r) y with
                    | Some (vs, cs) => Some (timed_letter ts vs (lets y), (rs, cs))
                    | None => None
                    end
  | None => None
  end.
Section Parts.
  Variables (t : times) (began : nat).
  Hypothesis Ht : passing t.


  Fixpoint past_memory (defs : definitions) (s : stream) (k : nat) : list kept :=
    match defs with
    | [] => []
    | (c, o) :: defs => remembered s t o k :: past_memory defs (fun k a => if a =? c then
      value s t began o k else s k a) k
    end.

  Lemma past_parts_right : forall m n defs s x rs y rs', part_of s t m n x -> rs = given m [] (past_memory defs s) ->
    past_parts began defs (m =? 0) rs x = Some (y, rs') ->
    part_of (with_past began defs s t) t m n y /\ rs' = past_memory defs s (n - 1).
  Proof.
    intros m n. induction defs as [|[c o] defs IH]; intros s x rs y rs' HP HR H; cbn [past_parts] in H.
    - injection H as <- <-. split; auto.
    - destruct HP as (P1 & P2 & P3 & P4 & P5).
      destruct (past_part began o (m =? 0) (hd None rs) x) as [[v w] r] eqn:E.
      destruct (Bool.eqb v w) eqn:Evw; [|congruence]. apply Bool.eqb_prop in Evw. subst w.
      assert (Hhd : hd None rs = remembered_before s t m o) by (rewrite HR; unfold given, remembered_before;
        destruct m; reflexivity).
      rewrite Hhd in E. destruct (past_part_right s t began m n x Ht P1 P2 P3 P4 P5 o v r E) as [E1 E2].
      destruct (past_parts began defs (m =? 0) (tl rs) _) as [[z zs]|] eqn:EZ; [|congruence]. injection H as <- <-.
      apply (IH (fun k a => if a =? c then value s t began o k else s k a)) in EZ.
      + destruct EZ as [Z1 ->]. split; [exact Z1|]. simpl. now rewrite <- E2.
      + repeat split; auto. intros k Hk a. simpl. destruct (a =? c); [|now apply P2].
        rewrite <- tracked_correct by auto. now apply E1.
      + rewrite HR. unfold given. destruct m; reflexivity.
  Qed.

  Lemma clock_parts_right : forall m n e x, part_of e t m n x -> forall ts cs vs cs',
    (m = 0 \/ cs = given m [] (fun j => map (fun y => clock_memory e t (clock_of y) j) ts)) ->
    clock_parts ts (m =? 0) cs x = Some (vs, cs') ->
    (forall k, m <= k < n -> map (fun y => late y e t k) ts = vs) /\
    cs' = map (fun y => clock_memory e t (clock_of y) (n - 1)) ts.
  Proof.
    intros m n e x (P1 & P2 & P3 & P4 & P5). induction ts as [|y ts IH]; intros cs vs cs' HR H; cbn [clock_parts] in H.
    - injection H as <- <-. auto.
    - destruct (clock_part (clock_of y) (bound_of y) x (m =? 0) (hd (None, []) cs)) as [[v w] c] eqn:E.
      destruct (Bool.eqb v w) eqn:Evw; [|congruence]. apply Bool.eqb_prop in Evw. subst w.
      apply (clock_part_right e t m n x Ht P1 P2 P3 P4 P5) in E.
      + destruct (clock_parts ts (m =? 0) (tl cs) x) as [[us ds]|] eqn:EZ; [|congruence]. injection H as <- <-.
        destruct E as [E1 E2]. apply IH in EZ.
        * destruct EZ as [Z1 ->]. split; [|simpl; now rewrite E2]. intros k Hk. simpl. rewrite Z1 by auto. f_equal.
            now apply E1.
        * destruct HR as [ | ->]; auto. right. unfold given. destruct m; reflexivity.
      + destruct HR as [ | ->]; auto. right. unfold given. destruct m; reflexivity.
  Qed.

  Lemma find_combined : forall (f : timer -> bool) l a ts,
    timed_letter ts (map f ts) l a = match find (fun x => atom_of x =? a) ts with Some x => f x | None => l a end.
  Proof.
    intros f l a ts. unfold timed_letter. induction ts as [|y ts IH]; simpl; auto. destruct (atom_of y =? a); auto.
  Qed.

  Definition remembered_all (defs : definitions) (p : property) (s : stream) (k : nat) : memory :=
    (past_memory defs s k, map (fun y => clock_memory (with_past began defs s t) t (clock_of y) k) (timers WholeRun p)).

  (** All of the past and all clocks: the letter that the monitor reads at each instant of the part. *)
  Lemma next_part_right : forall m n defs p s x r l r', part_of s t m n x ->
    r = given m ([], []) (remembered_all defs p s) ->
    next_part began defs (timers WholeRun p) (m =? 0) r x = Some (l, r') ->
    (forall k, m <= k < n -> forall a, timed_word defs p began s t k a = l a) /\ r' = remembered_all defs p s (n - 1).
  Proof.
    intros m n defs p s x r l r' HP HR H. unfold next_part in H.
    destruct (past_parts began defs (m =? 0) (fst r) x) as [[y rs]|] eqn:E1; [|congruence].
    destruct (clock_parts (timers WholeRun p) (m =? 0) (snd r) y) as [[vs cs]|] eqn:E2;
      [|congruence]. injection H as <- <-.
    apply (past_parts_right m n defs s) in E1; [|auto | rewrite HR; unfold given, remembered_all; destruct m;
      reflexivity].
    destruct E1 as [HY ->].
    apply (clock_parts_right m n (with_past began defs s t)) in E2;
      [|auto | destruct m; [now left | right; rewrite HR; reflexivity]].
    destruct E2 as [HV ->]. split; [|reflexivity]. intros k Hk a. unfold timed_word, with_clocks.
    rewrite <- (HV k Hk), find_combined. destruct (find _ _); auto. destruct HY as (_ & HY & _). auto.
  Qed.
End Parts.
