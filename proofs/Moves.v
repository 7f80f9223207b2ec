(** What the checker does with the reset machine: it looks at all moves from a state, as conditions on the letter
    ([each_move]), and follows one letter after the other along a lasso ([is_run]).

    Python: [moves] and [is_run] in [ltlc/semantics/certificate.py]. *)
From Coq Require Import List Arith Lia Bool.
Import ListNotations.
Require Import Ltl Lasso Properties Past Encodings Clocks Registers Trackers Conditions Judgements Resets.

Section Moves.
  Variables (news : list nat) (xs : list tracker_of).

  (** * All moves *)

  Fixpoint each_case (ys : list tracker_of) (sts : list state) (env : known) (first : bool) (ctx : condition)
    (judge : condition -> list case -> judgement) : judgement :=
    match ys, sts with
    | y :: ys, st :: sts =>
        all (fun c => narrowed ctx (PAnd (guard c) (atoms_as y c)) (fun ctx =>
               each_case ys sts (learn env y c) first ctx (fun ctx cs => judge ctx (c :: cs))))
          (cases y st (surroundings env first y))
    | _, _ => judge ctx []
    end.

  (** When the trackers do [cs]: whether a letter may come that can be held, or one that cannot; and the state then. *)
  Definition may_hold (k : clocks) (cs : list case) : bool :=
    negb (existsb (fun pb => fst pb && snd pb) (combine (those_passing xs (states k) cs) (begun k))).
  Definition may_not_hold (k : clocks) (cs : list case) : bool :=
    negb (existsb (fun p => p) (those_passing xs (states k) cs)).
  Definition to (cs : list case) (bs : list bool) : clocks :=
    {| is_first := false; states := map next cs; begun := bs |}.
  Definition to_held (cs : list case) : clocks := to cs (none_begun xs).
  Definition to_other (k : clocks) (cs : list case) : clocks := to cs (have_begun xs (states k) (begun k) cs).

  (** What is to be judged of each move from k by letters of [ctx]: these letters, its target, its fairness sets. *)
  Definition each_move (k : clocks) (ctx : condition) (judge : condition -> clocks -> list bool -> judgement)
    : judgement :=
    if is_trivial news xs then judge ctx k [] else
    each_case xs (states k) (fun _ => closed) (is_first k) ctx (fun ctx cs =>
      both (if may_hold k cs
            then narrowed ctx (settled news xs) (fun ctx => judge ctx (to_held cs) (marks xs cs ++ [true]))
            else verdict_is true)
           (if may_not_hold k cs
            then narrowed ctx (PNot (settled news xs)) (fun ctx => judge ctx (to_other k cs) (marks xs cs ++ [false]))
            else verdict_is true)).

  Section Shows.
    Variable meaning : claim -> Prop.

    Lemma each_case_shows : forall ys sts env is_first ctx judge (Q : condition -> list case -> Prop),
      (forall c cs, shows meaning (judge c cs) (Q c cs)) ->
      shows meaning (each_case ys sts env is_first ctx judge)
        (forall l p cs, lets l ctx -> In (p, cs) (together ys sts env is_first) -> at_letter p l = true ->
           exists c, lets l c /\ Q c cs).
    Proof.
      assert (H0 : forall ctx judge (Q : condition -> list case -> Prop),
                (forall c cs, shows meaning (judge c cs) (Q c cs)) ->
                shows meaning (judge ctx [])
                  (forall l p cs, lets l ctx -> In (p, cs) [(PTruth, [])] -> at_letter p l = true ->
                    exists c, lets l c /\ Q c cs)).
      { intros ctx judge Q HJ. eapply shows_some; [apply HJ|]. intros HQ l p cs Hl [E|[]] _. injection E as <- <-.
        eauto. }
      induction ys as [|y ys IH]; intros [|st sts] env is_first ctx judge Q HJ; try now apply H0.
      simpl each_case. eapply shows_some.
      - apply all_shows. intros c. apply narrowed_shows. intros ctx'.
        apply (IH sts (learn env y c) is_first ctx' _ (fun d cs => Q d (c :: cs))). intros d cs. apply HJ.
      - intros H l p cs Hl HI HP. simpl in HI. apply in_flat_map in HI. destruct HI as (c & Hc & HI).
        apply in_map_iff in HI. destruct HI as ((q & ds) & E & HI). injection E as <- <-.
        cbn [at_letter fst] in HP. apply andb_true_iff in HP. destruct HP as [HP HQ].
        destruct (H c Hc l Hl HP) as (ctx' & Hl' & H'). exact (H' l q ds Hl' HI HQ).
    Qed.

    Lemma each_move_shows : forall k ctx judge (Q : condition -> clocks -> list bool -> Prop),
      (forall c to f, shows meaning (judge c to f) (Q c to f)) ->
      shows meaning (each_move k ctx judge)
        (forall l m, lets l ctx -> In m (moves news xs k) -> at_letter (letters m) l = true ->
           exists c, lets l c /\ Q c (target m) (fair m)).
    Proof.
      intros k ctx judge Q HJ. unfold each_move, moves. destruct (is_trivial news xs).
      { eapply shows_some; [apply HJ|]. intros HQ l m Hl [<-|[]] _. eauto. }
      assert (HN : forall c p to f, shows meaning (narrowed c p (fun d => judge d to f))
                (forall l, lets l c -> at_letter p l = true -> exists d, lets l d /\ Q d to f)).
      { intros c p to f. apply narrowed_shows. intros d. apply HJ. }
      eapply shows_some.
      - apply (each_case_shows xs (states k) _ (is_first k) ctx _ (fun c cs =>
          (may_hold k cs = true -> forall l, lets l c -> at_letter (settled news xs) l = true ->
             exists d, lets l d /\ Q d (to_held cs) (marks xs cs ++ [true])) /\
          (may_not_hold k cs = true -> forall l, lets l c -> at_letter (PNot (settled news xs)) l = true ->
             exists d, lets l d /\ Q d (to_other k cs) (marks xs cs ++ [false])))).
        intros c cs. apply both_shows;
          [destruct (may_hold k cs) | destruct (may_not_hold k cs)]; try (apply verdict_is_shows; discriminate);
          (eapply shows_some; [apply HN|]); auto.
      - intros H l m Hl HI HP. apply in_flat_map in HI. destruct HI as ((p & cs) & HI & HM).
        assert (H' := fun HP => H l p cs Hl HI HP). clear H. apply in_app_iff in HM. cbn [fst snd] in HM.
        unfold may_hold, may_not_hold in H'.
        destruct HM as [HM|HM]; (destruct (existsb _ _) eqn:EX in HM; [destruct HM|]); destruct HM as [<-|[]].
        + cbn [letters target fair fst snd] in *.
          change (at_letter p l && at_letter (settled news xs) l = true) in HP. apply andb_true_iff in HP.
          destruct HP as [H1 H2]. destruct (H' H1) as (c & Hc & HQ & _).
          apply HQ; auto. now rewrite EX.
        + cbn [letters target fair fst snd] in *.
          change (at_letter p l && at_letter (PNot (settled news xs)) l = true) in HP. apply andb_true_iff in HP.
          destruct HP as [H1 H2]. destruct (H' H1) as (c & Hc & _ & HQ).
          apply HQ; auto. now rewrite EX.
    Qed.
  End Shows.

  (** * Along a word *)

  Fixpoint first_cases (ys : list tracker_of) (sts : list state) (env : known) (first : bool) (l : letter) :
    option (list case) :=
    match ys, sts with
    | y :: ys, st :: sts =>
        let fits c := at_letter (PAnd (guard c) (atoms_as y c)) l in
        match find fits (cases y st (surroundings env first y)) with
        | Some c => option_map (cons c) (first_cases ys sts (learn env y c) first l)
        | None => None
        end
    | _, _ => Some []
    end.

  (** The state after a letter, and the fairness sets of the move. *)
  Definition go (k : clocks) (l : letter) : option (clocks * list bool) :=
    if is_trivial news xs then Some (k, []) else
    match first_cases xs (states k) (fun _ => closed) (is_first k) l with
    | Some cs =>
        if at_letter (settled news xs) l
        then if may_hold k cs then Some (to_held cs, marks xs cs ++ [true]) else None
        else if may_not_hold k cs then Some (to_other k cs, marks xs cs ++ [false]) else None
    | None => None
    end.

  (** The state after some letters, and the fairness sets of all the moves. *)
  Fixpoint go_on (k : clocks) (ls : list letter) : option (clocks * list (list bool)) :=
    match ls with
    | [] => Some (k, [])
    | l :: ls => match go k l with
                 | Some (k, f) => option_map (fun r => (fst r, f :: snd r)) (go_on k ls)
                 | None => None
                 end
    end.

  (** Whether the lasso is a fair word from k on; its loop leads back to itself. *)
  Definition is_run (k : clocks) (u : lasso) : bool :=
    match go_on k (stem u) with
    | Some (start, _) =>
        match go_on start (loop u) with
        | Some (back, fs) => clocks_eqb back start &&
                             forallb (fun i => existsb (fun f => nth i f false) fs) (seq 0 (sets news xs))
        | None => false
        end
    | None => false
    end.

  Lemma first_cases_together : forall ys sts env is_first l cs, first_cases ys sts env is_first l = Some cs ->
    exists p, In (p, cs) (together ys sts env is_first) /\ at_letter p l = true.
  Proof.
    induction ys as [|y ys IH]; intros [|st sts] env is_first l cs H; simpl in H;
      try (injection H as <-; exists PTruth; split; [left|]; reflexivity).
    destruct (find _ _) as [c|] eqn:E; [|discriminate]. apply find_some in E. destruct E as [E1 E2].
    destruct (first_cases ys sts (learn env y c) is_first l) as [ds|] eqn:EC; [|discriminate]. injection H as <-.
    destruct (IH _ _ _ _ _ EC) as (p & A & B). exists (PAnd (PAnd (guard c) (atoms_as y c)) p). split.
    - simpl. apply in_flat_map. exists c. split; auto. apply in_map_iff. exists (p, ds). auto.
    - cbn [at_letter] in *. now rewrite E2, B.
  Qed.

  Lemma go_moves : forall k l k' f, go k l = Some (k', f) -> exists m, moves_by news xs k l k' m /\ fair m = f.
  Proof.
    intros k l k' f H. unfold go in H. unfold moves_by, moves. destruct (is_trivial news xs).
    { injection H as <- <-. eexists. split; [split; [left|]; auto|]; auto. }
    destruct (first_cases _ _ _ _ l) as [cs|] eqn:E; [|discriminate].
    destruct (first_cases_together _ _ _ _ _ _ E) as (p & HI & HP).
    unfold may_hold, may_not_hold in H. destruct (at_letter (settled news xs) l) eqn:EH;
      (destruct (existsb _ _) eqn:EX in H; [discriminate|]); injection H as <- <-; eexists;
      (split; [split; [apply in_flat_map; exists (p, cs); split; [exact HI|]; apply in_app_iff|]|]).
    - left. cbn [fst snd]. rewrite EX. left. reflexivity.
    - split; auto. cbn [letters at_letter fst]. now rewrite HP, EH.
    - reflexivity.
    - right. cbn [fst snd]. rewrite EX. left. reflexivity.
    - split; auto. cbn [letters at_letter fst]. now rewrite HP, EH.
    - reflexivity.
  Qed.

  (** ** The path along a lasso *)
  Section Along.
    Variables (u : lasso) (k : clocks).
    Hypothesis Hloop : loop u <> [].
    Hypothesis Hrun : is_run k u = true.

    Fixpoint along (n : nat) : clocks :=
      match n with
      | 0 => k
      | S n => match go (along n) (lasso_word u n) with Some (k', _) => k' | None => along n end
      end.

    Lemma go_on_along : forall ls i k' fs, (forall j, j < length ls -> nth j ls no_atom = lasso_word u (i + j)) ->
      go_on (along i) ls = Some (k', fs) -> along (i + length ls) = k' /\ length fs = length ls /\
      forall j, j < length ls -> go (along (i + j)) (lasso_word u (i + j)) = Some (along (S (i + j)), nth j fs []).
    Proof.
      induction ls as [|l ls IH]; intros i k' fs HL H; simpl in H.
      - injection H as <- <-. simpl. rewrite Nat.add_0_r. repeat split; auto. intros; lia.
      - assert (El : lasso_word u i = l)
          by (specialize (HL 0 ltac:(simpl; lia)); rewrite Nat.add_0_r in HL; now rewrite <- HL).
        destruct (go (along i) l) as [[k1 f]|] eqn:E; [|discriminate].
        assert (E1 : along (S i) = k1) by (simpl; now rewrite El, E).
        destruct (go_on k1 ls) as [[k2 gs]|] eqn:E2; [|discriminate]. injection H as <- <-. rewrite <- E1 in E2.
        destruct (IH (S i) k2 gs) as (A & B & C); auto.
        { intros j Hj. specialize (HL (S j)). simpl in HL. rewrite HL by lia. f_equal. lia. }
        simpl length. rewrite Nat.add_succ_r. split; [exact A|]. split; [now rewrite B|].
        intros [|j] Hj; [rewrite Nat.add_0_r, El, E; now rewrite E1|]. rewrite Nat.add_succ_r. apply C. lia.
    Qed.

    Lemma lasso_parts : exists fs, length fs = length (loop u) /\ along (size u) = along (length (stem u)) /\
      (forall j, j < size u -> exists f, go (along j) (lasso_word u j) = Some (along (S j), f)) /\
      (forall j, j < length (loop u) ->
         go (along (length (stem u) + j)) (lasso_word u (length (stem u) + j))
           = Some (along (S (length (stem u) + j)), nth j fs [])) /\
      forall i, i < sets news xs -> exists j, j < length (loop u) /\ nth i (nth j fs []) false = true.
    Proof.
      unfold is_run in Hrun. destruct (go_on k (stem u)) as [[k1 gs]|] eqn:E1; [|discriminate].
      destruct (go_on k1 (loop u)) as [[k2 fs]|] eqn:E2; [|discriminate]. apply andb_true_iff in Hrun.
      destruct Hrun as [H1 H2]. apply clocks_eqb_eq in H1. subst k2. rewrite forallb_forall in H2.
      destruct (go_on_along (stem u) 0 k1 gs) as (A1 & A2 & A3); auto.
      { intros j Hj. unfold lasso_word. simpl. now rewrite (proj2 (Nat.ltb_lt _ _) Hj). }
      simpl in A1, A3. rewrite <- A1 in E2.
      destruct (go_on_along (loop u) (length (stem u)) (along (length (stem u))) fs) as (B1 & B2 & B3); [|exact E2|].
      { intros j Hj. unfold lasso_word. rewrite (proj2 (Nat.ltb_ge _ _)) by lia. f_equal.
        replace (length (stem u) + j - length (stem u)) with j by lia. now rewrite Nat.mod_small. }
      exists fs. rewrite size_split. repeat split; auto.
      - intros j Hj. destruct (le_lt_dec (length (stem u)) j) as [Hs|Hs]; [|eauto].
        specialize (B3 (j - length (stem u))). replace (length (stem u) + (j - length (stem u))) with j in B3 by lia.
        eexists. apply B3. lia.
      - intros i Hi. specialize (H2 i). rewrite in_seq in H2. specialize (H2 ltac:(lia)).
        apply existsb_exists in H2. destruct H2 as (f & F1 & F2). apply In_nth with (d := []) in F1.
        destruct F1 as (j & J1 & <-). exists j. split; auto. lia.
    Qed.

    Lemma along_periodic : forall n, length (stem u) <= n -> along (length (loop u) + n) = along n.
    Proof.
      destruct lasso_parts as (_ & _ & HE & _). rewrite size_split in HE.
      intros n Hn. induction Hn as [|n Hn IH]; [now rewrite Nat.add_comm|]. rewrite Nat.add_succ_r. cbn [along].
      now rewrite IH, (lasso_word_periodic u Hloop) by auto.
    Qed.

    Lemma along_goes : forall n, exists f, go (along n) (lasso_word u n) = Some (along (S n), f).
    Proof.
      destruct lasso_parts as (_ & _ & _ & HG & _). pose proof (loop_length u Hloop). pose proof (size_split u).
      intros n. induction n as [n IH] using lt_wf_ind. destruct (le_lt_dec (size u) n) as [Hn|Hn]; auto.
      destruct (IH (n - length (loop u))) as (f & Hf); [lia|]. exists f.
      replace n with (length (loop u) + (n - length (loop u))) by lia.
      rewrite along_periodic, (lasso_word_periodic u Hloop), Hf by lia.
      now rewrite <- (along_periodic (S (n - length (loop u)))) by lia; rewrite Nat.add_succ_r.
    Qed.

    Theorem run_along : along 0 = k /\
      (forall n, exists m, moves_by news xs (along n) (lasso_word u n) (along (S n)) m) /\
      (forall i, i < sets news xs -> forall n, exists j m, n <= j /\
         moves_by news xs (along j) (lasso_word u j) (along (S j)) m /\ nth i (fair m) false = true).
    Proof.
      split; [reflexivity|]. split.
      - intros n. destruct (along_goes n) as (f & Hf). destruct (go_moves _ _ _ _ Hf) as (m & Hm & _). eauto.
      - destruct lasso_parts as (fs & _ & _ & _ & HL & HF). intros i Hi n. destruct (HF i Hi) as (j & Hj & Hn).
        pose proof (loop_length u Hloop) as Hlen.
        assert (HP : forall d, go (along (d * length (loop u) + (length (stem u) + j)))
                  (lasso_word u (d * length (loop u) + (length (stem u) + j)))
                  = Some (along (S (d * length (loop u) + (length (stem u) + j))), nth j fs [])).
        { induction d as [|d IH]; [apply HL; auto|].
          replace (S d * length (loop u) + (length (stem u) + j))
            with (length (loop u) + (d * length (loop u) + (length (stem u) + j))) by (simpl; lia).
          rewrite along_periodic, (lasso_word_periodic u Hloop), IH by lia.
          rewrite <- (along_periodic (S (d * length (loop u) + (length (stem u) + j)))) by lia.
          now rewrite Nat.add_succ_r. }
        destruct (go_moves _ _ _ _ (HP n)) as (m & Hm & Ef).
        exists (n * length (loop u) + (length (stem u) + j)), m. split; [nia|]. split; auto. now rewrite Ef.
    Qed.
  End Along.
End Moves.
