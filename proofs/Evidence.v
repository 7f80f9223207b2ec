(** Verdicts of recorded runs: from the lines of an evidence to its verdict, by computation.

    A line has a letter and its time; steps at which nothing changes have none. [judge_line] takes one line after
    another, so that a recording of any length is judged in constant memory. If it accepts them all under a
    certificate that [check] accepts, the verdict that it shows, from the time on that it shows, is right for every
    run that is written down so: [evidence_of_lines]. Without time it is right for every word with these letters,
    however often each of them comes: [evidence_untimed]. What is counted is worked out from the letters; and where a
    letter says that a scope is open, so that values are what they were at its opening, it is.
    Python: [ltlc/assurance/evidence/judge.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Properties Past Encodings Clocks Registers Resets ClockSteps Monitor Machines Distribute Certificate
  Infinite InTime Counts Held Counting.

(** * What is written down *)

(** Between two lines the letter is held, without its news, and steps at which nothing changes are left out; but none
    that has the time of a line. T: until when the run was looked at; N: how many of its instants. *)
Definition quiet (news : list nat) (l : letter) : letter := fun a => negb (existsb (Nat.eqb a) news) && l a.
Definition next_time (ls : list (letter * nat)) (T : nat) : nat := match ls with [] => T | (_, v) :: _ => v end.
Fixpoint of_lines (news : list nat) (s : stream) (t : times) (m : nat) (ls : list (letter * nat)) (T N : nat) : Prop :=
  match ls with
  | [] => m = N
  | (l, u) :: ls => exists n, m < n /\ t m = u /\ (forall a, s m a = l a) /\
      (forall k, m < k < n -> forall a, s k a = quiet news l a) /\ (S m < n -> u < t (S m)) /\
      t (n - 1) = next_time ls T /\ of_lines news s t n ls T N
  end.

(** Words without times: each letter comes at least once. *)
Fixpoint spells (s : stream) (m : nat) (ls : list (letter * nat)) (N : nat) : Prop :=
  match ls with
  | [] => m = N
  | (l, _) :: ls => exists n, m < n /\ (forall k, m <= k < n -> forall a, s k a = l a) /\ spells s n ls N
  end.

(** * The judge *)

(** The state that one letter leads to. *)
Fixpoint follow (ds : list decision) (fuel : nat) (l : letter) (t : target) : option nat :=
  match t, fuel with
  | State q, _ => Some q
  | Ask d, S fuel =>
      match nth_error ds d with Some a => follow ds fuel l (if l (atom a) then high a else low a) | None => None end
  | Ask _, 0 => None
  end.
Definition step (M : monitor) (fuel : nat) (l : letter) (q : nat) : option nat :=
  match nth_error (edges M) q with Some t => follow (decisions M) fuel l t | None => None end.

(** The scopes at whose opening values can be taken: that of the run, then those of [after] and [after_until] in the
    order of the text. None where a scope may be open several times at once. *)
Fixpoint scopes_within (o : option scope) (p : property) : list (option scope) :=
  match p with
  | Now _ | Throughout _ => []
  | Not p | Within _ _ p => scopes_within o p
  | And p q | Or p q | Implies p q => scopes_within o p ++ scopes_within o q
  | Always p | Never p | Eventually p => scopes_within None p
  | After x p => let i := option_map (fun o => AfterEvent o x) o in i :: scopes_within i p
  | Properties.Until x p => scopes_within (option_map (fun o => BeforeEvent o x) o) p
  | AfterUntil x y p => let i := option_map (fun o => Episodes o x y) o in i :: scopes_within i p
  end.
Definition scope_numbered (C : certificate) (n : nat) : option scope :=
  nth n (Some WholeRun :: scopes_within (Some WholeRun) (subject C)) None.

(** What does not change in a run: the certificate, its clocks, and when the session began; what is counted; the atoms
    that say that a scope is open; and those that are news. *)
Record judging := { certificate_of : certificate; clocks_of : list timer; session : nat;
  counted : list (nat * count); scoped : list (nat * scope); passing_by : list nat }.

(** What is known after some lines: whether there were any, what operators of the past and clocks remember, what counts
    and scopes do, the state of the monitor, its verdict, and since when it is that. *)
Record standing := { has_read : bool; remembers : memory; tally_so_far : list tally;
  open_since : list (list (option nat)); at_state : nat; verdict_shown : verdict; since : nat }.
Definition at_first : standing :=
  {| has_read := false; remembers := ([], []); tally_so_far := []; open_since := []; at_state := 0;
     verdict_shown := PresumablySatisfied; since := 0 |}.

(** Since when scopes are open at a part, with those around them, if its letter says which are. *)
Definition is_open (c : list (option nat)) : bool := match hd None c with Some _ => true | None => false end.
Fixpoint open_scopes (os : list (nat * scope)) (x : part) (is_first : bool) (before : list (list (option nat))) :
  option (list (list (option nat))) :=
  match os with
  | [] => Some []
  | (a, o) :: os =>
      let c := fst (open_part o x is_first (hd [] before)) in
      if Bool.eqb (lets x a) (is_open c) then
        match open_scopes os x is_first (tl before) with Some cs => Some (c :: cs) | None => None end
      else None
  end.

(** The letter of a part, with its counts, its past and its clocks, and what is remembered then. None: they are not the
    same at all of its instants, or it does not say which scopes are open. *)
Definition whole_part (J : judging) (j : standing) (x : part) :
  option (letter * memory * list tally * list (list (option nat))) :=
  match counted_parts (counted J) (negb (has_read j)) (tally_so_far j) x with
  | Some (y, rs) =>
      match next_part (session J) (defined (certificate_of J)) (clocks_of J) (negb (has_read j)) (remembers j) y with
      | Some (l, r) =>
          match open_scopes (scoped J) {| lets := l; from := from x; upto := upto x; single := single x |}
                  (negb (has_read j)) (open_since j) with
          | Some cs => Some (l, r, rs, cs)
          | None => None
          end
      | None => None
      end
  | None => None
  end.

(** Whether a part is known to be one letter of the word. Without time, a letter may come more often than its line
    says. *)
Definition is_one (J : judging) (x : part) : bool :=
  single x && match defined (certificate_of J), clocks_of J, counted J with [], [], [] => false | _, _, _ => true end.

(** The letter that a part has for the monitor has to be allowed; and to lead back to the state that it leads to, so
    that it does not matter how many instants the part has. *)
Definition judge_alike (J : judging) (j : standing) (x : part) : option standing :=
  let C := certificate_of J in
  let M := machine C in
  match whole_part J j x with
  | Some (l, r, rs, cs) =>
      if at_letter (assumption C) l then
        match step M (length (decisions M)) l (at_state j) with
        | Some q =>
            match step M (length (decisions M)) l q, nth_error (verdicts M) q with
            | Some q', Some v =>
                if is_one J x || (q' =? q) then
                  Some {| has_read := true; remembers := r; tally_so_far := rs; open_since := cs; at_state := q;
                          verdict_shown := v;
                          since := if has_read j && same_verdict v (verdict_shown j) then since j else from x |}
                else None
            | _, _ => None
            end
        | None => None
        end
      else None
  | None => None
  end.

Definition standing_dec (i j : standing) : {i = j} + {i <> j}.
Proof.
  repeat first [apply Nat.eq_dec | apply Bool.bool_dec | apply list_eq_dec; intros | decide equality].
Defined.

(** What is known after a part: if its instants are not alike, they have to have one time, and the later ones, of which
    there may be none, to change nothing. So a clock may come due at the instant at which it is stopped. *)
Definition judge_part (J : judging) (j : standing) (x : part) : option standing :=
  match judge_alike J j x with
  | Some i => Some i
  | None =>
      if from x =? upto x then
        match judge_alike J j {| lets := lets x; from := from x; upto := upto x; single := true |} with
        | Some i =>
            match judge_alike J i x with
            | Some i' => if standing_dec i i' then Some i else None
            | None => None
            end
        | None => None
        end
      else None
  end.

(** A letter that is held from u to v, in parts: cut where somebody says that a clock comes due. *)
Fixpoint judge_held (J : judging) (j : standing) (l : letter) (u v : nat) (cuts : list nat) : option standing :=
  match cuts with
  | c :: cuts =>
      if (u <=? c) && (c <? v) then
        match judge_part J j {| lets := l; from := u; upto := c; single := false |} with
        | Some j => judge_held J j l (S c) v cuts
        | None => None
        end
      else judge_held J j l u v cuts
  | [] => judge_part J j {| lets := l; from := u; upto := v; single := false |}
  end.

(** One line, at u, when that of the next is known, v: its own instant, and what is held after it. *)
Definition judge_line (J : judging) (j : standing) (l : letter) (u v : nat) (cuts : list nat) : option standing :=
  if v <? u then None
  else
    match judge_part J j {| lets := l; from := u; upto := u; single := true |} with
    | Some j => if u <? v then judge_held J j (quiet (passing_by J) l) (S u) v cuts else Some j
    | None => None
    end.

Fixpoint numbered (C : certificate) (os : list (nat * nat)) : option (list (nat * scope)) :=
  match os with
  | [] => Some []
  | (a, n) :: os =>
      match scope_numbered C n, numbered C os with Some o, Some os => Some ((a, o) :: os) | _, _ => None end
  end.

(** What is counted, [cs]; the atoms that say that the scope with a number is open, [os]; those that are news, [ns]. *)
Definition prepare (C : certificate) (began : nat) (cs : list (nat * count)) (os : list (nat * nat)) (ns : list nat) :
  option judging :=
  match encoded_by C, numbered C os with
  | Episode, Some os =>
      if forallb (fun c => 0 <? many (snd c)) cs then
        Some {| certificate_of := C; clocks_of := timers WholeRun (judged C); session := began;
                counted := cs; scoped := os; passing_by := ns |}
      else None
  | _, _ => None
  end.

Fixpoint judge_all (J : judging) (j : standing) (ls : list (letter * nat)) (T : nat) (cuts : list (list nat)) :
  option standing :=
  match ls with
  | [] => Some j
  | (l, u) :: ls =>
      match judge_line J j l u (next_time ls T) (hd [] cuts) with
      | Some j => judge_all J j ls T (tl cuts)
      | None => None
      end
  end.

(** The verdict of a recorded run, and since when it is that. *)
Definition judge_lines (C : certificate) (began : nat) (cs : list (nat * count)) (os : list (nat * nat))
  (ns : list nat) (ls : list (letter * nat)) (T : nat) (cuts : list (list nat)) : option (verdict * nat) :=
  match prepare C began cs os ns with
  | Some J =>
      match judge_all J at_first ls T cuts with
      | Some j => if has_read j then Some (verdict_shown j, since j) else None
      | None => None
      end
  | None => None
  end.

(** * It follows the monitor *)

Lemma follow_leads : forall M fuel l t q, follow (decisions M) fuel l t = Some q -> leads M l t q.
Proof.
  intros M. induction fuel as [|fuel IH]; intros l [p|d] q H; simpl in H; try congruence;
    try (injection H as <-; constructor).
  destruct (nth_error (decisions M) d) as [a|] eqn:E; [|congruence]. econstructor; eauto.
Qed.

Lemma step_reaches : forall M fuel s n q l q', reaches M s n q -> (forall a, s n a = l a) ->
  step M fuel l q = Some q' ->
  reaches M s (S n) q'.
Proof.
  intros M fuel s n q l q' HR HL HS. unfold step in HS. destruct (nth_error (edges M) q) as [t|] eqn:E; [|congruence].
  eapply reaches_step; eauto. eapply leads_same; [|eapply follow_leads; eauto]. auto.
Qed.

(** A letter that leads back to its state, for any number of steps. *)
Lemma stays : forall M fuel s l m n q q', reaches M s m q -> step M fuel l q = Some q' ->
  n = S m \/ step M fuel l q' = Some q' -> (forall k, m <= k < n -> forall a, s k a = l a) ->
  forall k, m < k <= n -> reaches M s k q'.
Proof.
  intros M fuel s l m n q q' HR H1 H2 HL k Hk. replace k with (S m + (k - S m)) by lia.
  assert (Hd : S m + (k - S m) <= n) by lia. revert Hd. generalize (k - S m). clear k Hk.
  induction n0 as [|d IH]; intros Hd.
  - rewrite Nat.add_0_r in *. apply (step_reaches M fuel s m q l); auto; apply HL; lia.
  - rewrite Nat.add_succ_r in *. apply (step_reaches M fuel s _ q' l); [apply IH; lia | apply HL; lia | destruct H2;
      [lia | auto]].
Qed.

Lemma same_verdict_is : forall v w, same_verdict v w = true <-> v = w.
Proof. intros [] []; simpl; split; congruence. Qed.

Lemma judge_alike_inv : forall J j x j', judge_alike J j x = Some j' ->
  let C := certificate_of J in let M := machine C in let fuel := length (decisions M) in
  exists l, whole_part J j x = Some (l, remembers j', tally_so_far j', open_since j') /\
    at_letter (assumption C) l = true /\ step M fuel l (at_state j) = Some (at_state j') /\
    (is_one J x = true \/ step M fuel l (at_state j') = Some (at_state j')) /\
      nth_error (verdicts M) (at_state j') = Some (verdict_shown j') /\
    has_read j' = true /\
    since j' = if has_read j && same_verdict (verdict_shown j') (verdict_shown j) then since j else from x.
Proof.
  intros J j x j' H. cbv zeta. unfold judge_alike in H.
  destruct (whole_part J j x) as [[[[l r] rs] cs]|]; [|congruence].
  destruct (at_letter _ l) eqn:HA; [|congruence]. destruct (step _ _ l (at_state j)) as [q|] eqn:H1; [|congruence].
  destruct (step _ _ l q) as [q'|] eqn:H2; [|congruence]. destruct (nth_error _ q) as [v|] eqn:H3; [|congruence].
  destruct (is_one J x || (q' =? q)) eqn:H4; [|congruence]. injection H as <-. exists l. simpl. repeat split; auto.
  apply orb_true_iff in H4. destruct H4 as [H4|H4]; auto. apply Nat.eqb_eq in H4. subst q'. auto.
Qed.

Lemma judge_part_inv : forall J j x j', judge_part J j x = Some j' -> judge_alike J j x = Some j' \/
  from x = upto x /\ judge_alike J j {| lets := lets x; from := from x; upto := upto x; single := true |} = Some j' /\
  judge_alike J j' x = Some j'.
Proof.
  intros J j x j' H. unfold judge_part in H. destruct (judge_alike J j x) as [i|] eqn:E; [injection H as <-; auto|].
  destruct (Nat.eqb_spec (from x) (upto x)); [|congruence]. right. clear E.
  destruct (judge_alike J j _) as [i|] eqn:E; [|congruence].
  destruct (judge_alike J i x) as [i'|] eqn:E2; [|congruence]. destruct (standing_dec i i') as [<-|]; [|congruence].
  injection H as <-. auto.
Qed.

(** * In time *)

Section InTime.
  Variables (C : certificate) (began : nat) (s : stream) (t : times).
  Variables (cs : list (nat * count)) (os : list (nat * scope)) (ns : list nat).
  Hypothesis Ht : passing t.
  Hypothesis dense : forall k, t (S k) <= S (t k).
  Hypothesis some : forallb (fun c => 0 <? many (snd c)) cs = true.
  Let M := machine C.
  Let J := {| certificate_of := C; clocks_of := timers WholeRun (judged C); session := began;
              counted := cs; scoped := os; passing_by := ns |}.
  Let with_all := with_counts cs s t.
  Let e := word_of C began with_all t.

  (** Which scopes are open at an instant, as its letter says. *)
  Definition scopes_right (k : nat) : Prop :=
    forall a o, In (a, o) os -> e k a = match scope_tracker o e k with Some _ => true | None => false end.
  Definition chains (zs : list (nat * scope)) (k : nat) : list (list (option nat)) :=
    map (fun ao => chain e t (snd ao) k) zs.

  Lemma open_scopes_right : forall m n x, part_of e t m n x -> forall zs before found,
    before = given m [] (chains zs) -> open_scopes zs x (m =? 0) before = Some found ->
    found = chains zs (n - 1) /\ forall k, m <= k < n -> forall a o, In (a, o) zs ->
      e k a = match scope_tracker o e k with Some _ => true | None => false end.
  Proof.
    intros m n x (P1 & P2 & P3 & P4 & P5). induction zs as [|[a o] zs IH]; intros before found HB H;
      cbn [open_scopes] in H.
    - injection H as <-. split; [reflexivity | intros k _ a o []].
    - assert (HC : m = 0 \/ hd [] before = given m [] (chain e t o)).
      { rewrite HB. unfold given. destruct m; [now left | right; reflexivity]. }
      rewrite (open_part_right e t m n x P1 P2 P3 P4 P5 o _ HC) in H.
      cbn [fst] in H. destruct (Bool.eqb (lets x a) _) eqn:EA; [|congruence]. apply Bool.eqb_prop in EA.
      destruct (open_scopes zs x (m =? 0) (tl before)) as [cs'|] eqn:EO; [|congruence]. injection H as <-.
      assert (HT : tl before = given m [] (chains zs)) by (rewrite HB; unfold given; destruct m; reflexivity).
      destruct (IH _ _ HT EO) as [-> H2]. split.
      + cbn [chains map snd]. f_equal. symmetry. apply (chain_same e t m n x P1 P2 P3 P4 P5); lia.
      + intros k Hk b o' [E|Hin]; [|now apply H2]. injection E as <- <-. rewrite (P2 k Hk), EA.
        rewrite (scope_same e t m n x P1 P2 P3 P4 P5 o k Hk). unfold is_open. rewrite chain_hd.
        destruct (scope_tracker o e m); reflexivity.
  Qed.

  (** What the monitor shows after n instants. *)
  Definition shows_at (n : nat) (v : verdict) : Prop := exists q, reaches M e n q /\ nth_error (verdicts M) q = Some v.

  (** From the instant i on, at the time u, until n the monitor shows v; before it something else. *)
  Definition shows_since (i n u : nat) (v : verdict) : Prop :=
    i < n /\ t i = u /\ (forall k, i < k <= n -> shows_at k v) /\ (0 < i -> exists w, w <> v /\ shows_at i w).

  Definition right_at (n : nat) (j : standing) : Prop :=
    reaches M e n (at_state j) /\
    remembers j = given n ([], []) (remembered_all t began (defined C) (judged C) with_all) /\
    tally_so_far j = given n [] (tallies t cs s) /\ open_since j = given n [] (chains os) /\
    (forall k, k < n -> scopes_right k) /\
    has_read j = negb (n =? 0) /\ (0 < n -> exists i, shows_since i n (since j) (verdict_shown j)).

  Lemma right_at_first : right_at 0 at_first.
  Proof. repeat split; [apply reaches_start | intros k Hk; lia | intros; lia]. Qed.

  Lemma judge_alike_right : forall m n x j j', right_at m j -> part_of s t m n x -> judge_alike J j x = Some j' ->
    right_at n j'.
  Proof.
    intros m n x j j' (R1 & R2 & RT & RO & RS & R3 & R4) HP HJ. pose proof HP as (Hmn & _ & Hfrom & Hupto & Hone).
    destruct (judge_alike_inv J j x j' HJ) as (l & H1 & _ & H3 & H4 & H5 & H6 & H7).
      unfold whole_part in H1. cbn [certificate_of clocks_of session counted scoped J] in *.
    rewrite R3, negb_involutive in H1.
    destruct (counted_parts cs (m =? 0) (tally_so_far j) x) as [[y rs]|] eqn:EC; [|congruence].
    destruct (next_part began _ _ _ _ y) as [[l' r]|] eqn:EN; [|congruence].
    destruct (open_scopes os _ (m =? 0) (open_since j)) as [found|] eqn:EO; [|congruence].
    injection H1 as -> -> -> ->.
    destruct (counted_parts_right t Ht m n cs s x _ y _ some HP RT EC) as [HY HT].
    destruct (next_part_right t began Ht m n (defined C) (judged C) with_all y _ l _ HY R2 EN) as [HL HR].
    destruct (open_scopes_right m n {| lets := l; from := from x; upto := upto x; single := single x |}) with (2 := RO)
      (3 := EO) as [HO HS']; [repeat split; auto|].
    assert (H4' : n = S m \/ step M (length (decisions M)) l (at_state j') = Some (at_state j')).
    { destruct H4 as [H4|H4]; auto. left. apply HP. unfold is_one in H4. now apply andb_true_iff in H4. }
    assert (HS : forall k, m < k <= n -> reaches M e k (at_state j')) by exact (stays M _ e l m n _ _ R1 H3 H4' HL).
    assert (HV : forall k, m < k <= n -> shows_at k (verdict_shown j')) by (intros k Hk; exists (at_state j'); auto).
    split; [apply HS; lia|]. split; [|split; [|split; [|split; [|split]]]].
    - rewrite HR. unfold given. destruct n; [lia|]. simpl. now rewrite Nat.sub_0_r.
    - rewrite HT. unfold given. destruct n; [lia|]. simpl. now rewrite Nat.sub_0_r.
    - rewrite HO. unfold given. destruct n; [lia|]. simpl. now rewrite Nat.sub_0_r.
    - intros k Hk. destruct (le_lt_dec m k); [|now apply RS]. intros a o Hao. now apply (HS' k).
    - rewrite H6. destruct n; [lia | reflexivity].
    - intros _. rewrite R3 in H7. destruct (Nat.eqb_spec m 0) as [->|Hm]; simpl in H7.
      + exists 0. rewrite H7. repeat split; auto; lia.
      + destruct (R4 ltac:(lia)) as (i & I1 & I2 & I3 & I4).
        destruct (same_verdict (verdict_shown j') (verdict_shown j)) eqn:EV.
        * apply same_verdict_is in EV. exists i. rewrite H7, EV in *. repeat split; auto; [lia|].
          intros k Hk. destruct (le_lt_dec k m); [apply I3; lia | apply HV; lia].
        * exists m. rewrite H7. repeat split; auto. intros _. exists (verdict_shown j).
          split; [|apply I3; lia]. intros E. rewrite E in EV. rewrite (proj2 (same_verdict_is _ _) eq_refl) in EV.
          discriminate EV.
  Qed.

  Lemma judge_part_right : forall m n x j j', right_at m j -> part_of s t m n x -> judge_part J j x = Some j' ->
    right_at n j'.
  Proof.
    intros m n x j j' HR HP HJ. pose proof HP as (P1 & P2 & P3 & P4 & P5).
    destruct (judge_part_inv J j x j' HJ) as [H|(E & H1 & H2)]; [now apply (judge_alike_right m n x j j')|].
    assert (HM : right_at (S m) j').
    { refine (judge_alike_right m (S m) _ j j' HR _ H1). unfold part_of. simpl. rewrite Nat.sub_0_r.
      repeat split; auto; try lia. intros; apply P2; lia. }
    destruct (Nat.eq_dec n (S m)) as [->|Hn]; auto. refine (judge_alike_right (S m) n x j' j' HM _ H2).
    pose proof (Ht m (S m)). pose proof (Ht (S m) (n - 1)). repeat split; auto; try lia.
    - intros. apply P2. lia.
    - intros HX. specialize (P5 HX). lia.
  Qed.

  (** Time does not jump, so there is an instant at each cut. *)
  Lemma cut_exists : forall c n m, m < n -> t m <= c < t (n - 1) ->
    exists k, m <= k /\ S k < n /\ t k = c /\ t (S k) = S c.
  Proof.
    intros c n m Hmn. remember (n - m) as d eqn:E. revert m Hmn E. induction d as [|d IH]; intros m Hmn E H; [lia|].
    destruct (Nat.eq_dec (S m) n) as [En|En]; [subst n; simpl in H; rewrite Nat.sub_0_r in H; lia|].
    pose proof (dense m) as HD. destruct (le_lt_dec (t (S m)) c) as [Hc|Hc].
    - destruct (IH (S m)) as (k & A & B & D & F); try lia. exists k. repeat split; auto; lia.
    - exists m. repeat split; lia.
  Qed.

  Lemma judge_held_right : forall l v n cuts m u j j', right_at m j -> m < n ->
    (forall k, m <= k < n -> forall a, s k a = l a) -> t m = u -> t (n - 1) = v ->
    judge_held J j l u v cuts = Some j' -> right_at n j'.
  Proof.
    intros l v n. induction cuts as [|c cuts IH]; intros m u j j' HR Hmn HL Hu Hv HJ; cbn [judge_held] in HJ.
    - refine (judge_part_right m n _ j j' HR _ HJ). repeat split; auto. discriminate.
    - destruct (Nat.leb_spec u c), (Nat.ltb_spec c v); simpl in HJ; try (now apply (IH m u j j')).
      destruct (judge_part J j _) as [i|] eqn:EP; [|congruence].
      destruct (cut_exists c n m Hmn) as (k & A & B & D & F); [lia|].
      apply (IH (S k) (S c) i j'); auto; try lia; [|intros; apply HL; lia].
      refine (judge_part_right m (S k) _ j i HR _ EP). unfold part_of. simpl. rewrite Nat.sub_0_r.
      repeat split; auto; try lia; try discriminate. intros; apply HL; lia.
  Qed.

  Lemma judge_all_right : forall T N ls cuts m j j', right_at m j -> of_lines ns s t m ls T N ->
    judge_all J j ls T cuts = Some j' -> right_at N j'.
  Proof.
    intros T N. induction ls as [|[l u] ls IH]; intros cuts m j j' HR H HJ; cbn [of_lines] in H; cbn [judge_all] in HJ.
    - subst m. injection HJ as <-. exact HR.
    - destruct (judge_line J j l u _ _) as [i|] eqn:EL; [|congruence].
      destruct H as (n & H1 & H2 & H3 & H4 & H5 & H6 & H7). apply (IH (tl cuts) n i j'); auto.
      unfold judge_line in EL. destruct (next_time ls T <? u); [congruence|].
      destruct (judge_part J j _) as [i'|] eqn:EP; [|congruence].
      assert (HM : right_at (S m) i').
      { refine (judge_part_right m (S m) _ j i' HR _ EP). unfold part_of. simpl. rewrite Nat.sub_0_r. repeat split;
          auto.
        intros k Hk a. now replace k with m by lia. }
      destruct (Nat.ltb_spec u (next_time ls T)) as [Hu|Hu].
      + assert (Hn : S m < n).
        { destruct (Nat.eq_dec n (S m)); [subst n; simpl in H6; rewrite Nat.sub_0_r in H6; lia | lia]. }
        apply (judge_held_right (quiet ns l) (next_time ls T) n (hd [] cuts) (S m) (S u) i'); auto.
        specialize (H5 Hn). specialize (dense m). lia.
      + injection EL as <-. replace n with (S m); auto.
        destruct (Nat.eq_dec n (S m)); auto. assert (HS : S m < n) by lia. specialize (H5 HS).
        pose proof (Ht (S m) (n - 1)). lia.
  Qed.
End InTime.

(** What is accepted is right, of every run that is written down so, whatever the cuts: there is an instant at the
    time u, the i-th, such that after it and after each later one, to the end, the verdict v is right of the run up to
    there; and before it another verdict was. Counts are atoms of the run that mean what the language says, though they
    are not written down; and at each instant the letter says which of the scopes in [os] are open. *)
Theorem evidence_of_lines : forall depth work C began cs os ns ls T cuts v u, check depth work C = true ->
  judge_lines C began cs os ns ls T cuts = Some (v, u) -> forall s t N, let r := (with_counts cs s t, t) in
    is_run C began r -> of_lines ns s t 0 ls T N ->
  let right n := right_verdict (goes_on C began r n) (meets_up_to C began None) (meets_up_to C began (Some n) r) in
  let e := word_of C began (fst r) t in
  (exists i, i < N /\ t i = u /\ (forall n, i < n <= N -> right n v) /\ (0 < i -> exists w, w <> v /\ right i w)) /\
  (forall a n, In (a, n) os -> exists o, scope_numbered C n = Some o /\
     forall k, k < N -> e k a = match scope_tracker o e k with Some _ => true | None => false end).
Proof.
  intros depth work C began cs os ns ls T cuts v u HC HJ s t N r HS HL right e. unfold judge_lines, prepare in HJ.
  destruct (encoded_by C) eqn:HE; try congruence. destruct (numbered C os) as [os'|] eqn:EO; [|congruence].
  destruct (forallb _ cs) eqn:EF; [|congruence]. destruct (judge_all _ _ ls T cuts) as [j|] eqn:EJ; [|congruence].
  destruct (has_read j) eqn:EA; [|congruence]. injection HJ as <- <-. pose proof HS as [[H1 H2 _ _] _].
  destruct (judge_all_right C began s t cs os' ns H1 H2 EF T N ls cuts 0 _ j (right_at_first C began s t cs os') HL EJ)
    as (_ & _ & _ & _ & RS & R3 & R4).
  assert (HN : 0 < N) by (destruct N; [simpl in R3; congruence | lia]).
  assert (HR : forall n w, shows_at C began s t cs n w -> right n w).
  { intros n w (q & Q1 & Q2).
    assert (HRd : reading (word_of C began (fst r) t) t (fun k => k) n).
    { split; intros; auto; try lia. now replace k with j0 by lia. }
    destruct (certified depth work C HC HE began (fst r) t (fun k => k) n HS HRd) as (q' & w' & A & B & D).
    assert (q' = q) by (eapply reaches_unique; eauto). subst q'. rewrite Q2 in B. injection B as <-. exact D. }
  split.
  - destruct (R4 HN) as (i & I1 & I2 & I3 & I4). exists i. repeat split; auto. intros Hi.
    destruct (I4 Hi) as (w & W1 & W2). eauto.
  - clear - EO RS. revert os' EO RS. induction os as [|[b m] os IH]; intros os' EO RS a n Hin; [destruct Hin|].
    cbn [numbered] in EO. destruct (scope_numbered C m) as [o|] eqn:ES; [|congruence].
    destruct (numbered C os) as [rest|] eqn:EN; [|congruence]. injection EO as <-. destruct Hin as [E|Hin].
    + injection E as -> ->. exists o. split; auto. intros k Hk. apply (RS k Hk). now left.
    + apply (IH rest); auto. intros k Hk a' o' Hao. apply (RS k Hk). now right.
Qed.

(** * Without time *)

Definition untimed (C : certificate) : bool :=
  match defined C, news C with [], [] => unbounded (subject C) | _, _ => false end.

Lemma follow_same : forall ds fuel l l' t, (forall a, l a = l' a) -> follow ds fuel l t = follow ds fuel l' t.
Proof.
  intros ds. induction fuel as [|fuel IH]; intros l l' [q|d] H; simpl; auto. destruct (nth_error ds d); auto.
  rewrite <- H. now apply IH.
Qed.

Section Untimed.
  Variables (C : certificate) (began : nat) (s : stream).
  Hypothesis no_past : defined C = [].
  Hypothesis no_bounds : unbounded (subject C) = true.
  Let M := machine C.
  Let fuel := length (decisions M).
  Let J := {| certificate_of := C; clocks_of := timers WholeRun (judged C); session := began;
              counted := []; scoped := []; passing_by := [] |}.

  (** The letter l has led to the state of j, and leads back to it. *)
  Definition settled (l : letter) (j : standing) : Prop :=
    at_letter (assumption C) l = true /\ step M fuel l (at_state j) = Some (at_state j) /\
    nth_error (verdicts M) (at_state j) = Some (verdict_shown j).

  Lemma judge_alike_settles : forall l x j j', (forall a, lets x a = l a) -> judge_alike J j x = Some j' ->
    settled l j' /\ step M fuel l (at_state j) = Some (at_state j').
  Proof.
    intros l x j j' Hl HJ. destruct (judge_alike_inv J j x j' HJ) as (l' & H1 & H2 & H3 & H4 & H5 & _).
    unfold is_one in H4. unfold whole_part in H1. cbn [certificate_of clocks_of session counted scoped J] in *.
    unfold judged in H1, H4.
    rewrite no_past, unbounded_distribute, unbounded_timers in H1, H4 by exact no_bounds. cbn in H1.
      injection H1 as <- _ _ _.
    rewrite andb_false_r in H4. destruct H4 as [H4|H4]; [discriminate|].
    assert (HL : forall q, step M fuel l q = step M fuel (timed_letter [] [] (lets x)) q).
    { intros q. unfold step. destruct (nth_error (edges M) q); auto. apply follow_same. intros a. now rewrite <- Hl. }
    repeat split; rewrite ?HL; auto. rewrite <- H2. apply at_letter_same. intros a _. now rewrite <- Hl.
  Qed.

  Lemma judge_part_settles : forall l x j j', (forall a, lets x a = l a) -> judge_part J j x = Some j' ->
    settled l j' /\ step M fuel l (at_state j) = Some (at_state j').
  Proof.
    intros l x j j' Hl HJ. destruct (judge_part_inv J j x j' HJ) as [H|(_ & H & _)]; eapply judge_alike_settles;
      try exact H; exact Hl.
  Qed.

  Lemma judge_held_settles : forall l l' v cuts u j j', (forall a, l' a = l a) -> settled l j ->
    judge_held J j l' u v cuts = Some j' -> settled l j' /\ at_state j' = at_state j.
  Proof.
    intros l l' v. induction cuts as [|c cuts IH]; intros u j j' Hl HS HJ; cbn [judge_held] in HJ.
    - destruct (judge_part_settles l {| lets := l'; from := u; upto := v;
        single := false |} j j' Hl HJ) as [H1 H2]. split; auto. destruct HS as (_ & S2 & _). congruence.
    - destruct ((u <=? c) && (c <? v)); [|now apply (IH u j j')].
      destruct (judge_part J j _) as [i|] eqn:EP; [|congruence].
      destruct (judge_part_settles l {| lets := l'; from := u; upto := c;
        single := false |} j i Hl EP) as [H1 H2]. destruct (IH (S c) i j' Hl H1 HJ) as [H3 H4].
      split; auto. destruct HS as (_ & S2 & _). congruence.
  Qed.

  Lemma judge_all_spells : forall T N ls cuts m j j', reaches M s m (at_state j) -> spells s m ls N ->
    (forall k, k < m -> at_letter (assumption C) (s k) = true) -> judge_all J j ls T cuts = Some j' ->
    reaches M s N (at_state j') /\ (forall k, k < N -> at_letter (assumption C) (s k) = true) /\
    (has_read j' = true -> ls <> [] -> nth_error (verdicts M) (at_state j') = Some (verdict_shown j')).
  Proof.
    intros T N. induction ls as [|[l u] ls IH]; intros cuts m j j' HR HL HA HJ; cbn [spells] in HL;
      cbn [judge_all] in HJ.
    - subst m. injection HJ as <-. repeat split; auto. congruence.
    - destruct (judge_line J j l u _ _) as [i|] eqn:EL; [|congruence]. destruct HL as (n & H1 & H2 & H3).
      assert (HI : settled l i /\ step M fuel l (at_state j) = Some (at_state i)).
      { unfold judge_line in EL. destruct (next_time ls T <? u); [congruence|].
        destruct (judge_part J j _) as [i'|] eqn:EP; [|congruence].
        destruct (judge_part_settles l {| lets := l; from := u; upto := u; single := true |} j i') as [S1 S2]; auto.
        destruct (u <? next_time ls T); [|injection EL as <-; auto].
        assert (HQ : forall a, quiet [] l a = l a) by reflexivity.
        destruct (judge_held_settles l _ _ _ _ _ _ HQ S1 EL) as [S3 S4]. split; congruence. }
      destruct HI as [(S1 & S2 & S3) S4].
      assert (HRn : reaches M s n (at_state i)) by (apply (stays M fuel s l m n (at_state j)); auto; lia).
      assert (HAn : forall k, k < n -> at_letter (assumption C) (s k) = true).
      { intros k Hk. destruct (le_lt_dec m k); auto. rewrite <- S1. apply at_letter_same. intros a _. apply H2. lia. }
      destruct (IH (tl cuts) n i j' HRn H3 HAn HJ) as (R1 & R2 & R3). repeat split; auto. intros HY _.
      destruct ls as [|y ls]; [|apply R3; auto; discriminate]. cbn [judge_all] in HJ. injection HJ as <-. exact S3.
  Qed.
End Untimed.

(** What is accepted is right of every word with these letters, each at least once. *)
Theorem evidence_untimed : forall depth work C began ls T cuts v u, check depth work C = true -> untimed C = true ->
  judge_lines C began [] [] [] ls T cuts = Some (v, u) -> forall s N, spells s 0 ls N ->
  right_verdict (goes_on_as C s N) (meets_always C) (meets_so_far C s N) v.
Proof.
  intros depth work C began ls T cuts v u HC HU HJ s N HL. unfold judge_lines, prepare in HJ.
  destruct (encoded_by C) eqn:HE; try congruence. cbn [numbered forallb] in HJ.
  destruct (judge_all _ _ ls T cuts) as [j|] eqn:EJ; [|congruence].
  destruct (has_read j) eqn:EA; [|congruence]. injection HJ as <- <-. unfold untimed in HU.
  destruct (defined C) eqn:HD; [|congruence]. destruct (news C) eqn:HN; [|congruence].
  destruct (judge_all_spells C began s HD HU T N ls cuts 0 at_first j (reaches_start _ _) HL) with (2 := EJ)
    as (R1 & R2 & R3); [intros; lia|].
  destruct (certified_untimed depth work C HC HE HU HD HN s N R2) as (q & v & A & B & D).
  assert (q = at_state j) by (eapply reaches_unique; eauto). subst q. rewrite R3 in B; auto; [injection B as <-;
    exact D|].
  intros ->. cbn in EJ. injection EJ as <-. discriminate EA.
Qed.
