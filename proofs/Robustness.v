(** By how much a run satisfies a property: the denotation with margins for truth.

    [robustness_right]: a positive robustness means that the property is satisfied, a negative one that it is not; at 0
    nothing is said. [robustness_near]: if no margin differs by more than d, neither does the robustness; so the verdict
    is that of every run whose margins differ by less than the robustness ([same_verdict]).
    Margins are whole numbers, or infinite: each double but NaN is a whole multiple of the least one, and what is said
    of margins speaks of their order and sign alone.
    Python: [ltlc/semantics/robustness.py]. *)
From Coq Require Import List Arith Lia Bool ZArith.
Require Import Ltl Properties Past.

Inductive margin := Lowest | Finite (z : Z) | Highest.

Definition neg (a : margin) : margin :=
  match a with Lowest => Highest | Finite z => Finite (- z) | Highest => Lowest end.
Definition least (a b : margin) : margin :=
  match a, b with
  | Lowest, _ | _, Lowest => Lowest
  | Highest, c | c, Highest => c
  | Finite x, Finite y => Finite (Z.min x y)
  end.
Definition greatest (a b : margin) : margin := neg (least (neg a) (neg b)).

Definition positive (a : margin) : Prop :=
  match a with Lowest => False | Finite z => (0 < z)%Z | Highest => True end.
Definition negative (a : margin) : Prop := positive (neg a).

(** The least and the greatest of the instants from i to before n. *)
Fixpoint least_next (f : nat -> margin) (i n : nat) : margin :=
  match n with 0 => Highest | S n => least (f i) (least_next f (S i) n) end.
Definition least_of (f : nat -> margin) (i n : nat) : margin := least_next f i (n - i).
Definition greatest_of (f : nat -> margin) (i n : nat) : margin := neg (least_of (fun k => neg (f k)) i n).

Fixpoint at_margins (p : predicate) (l : nat -> margin) : margin :=
  match p with
  | PTruth => Highest
  | PAtom a => l a
  | PNot p => neg (at_margins p l)
  | PAnd p q => least (at_margins p l) (at_margins q l)
  | POr p q => greatest (at_margins p l) (at_margins q l)
  end.

(** * The robustness of a run of n instants, with margins v of its atoms *)
Section Robustness.
  Variables (v : nat -> nat -> margin) (t : times) (n : nat).

  (** [ended] says by how much the segment has ended at an instant; it lasts up to the first at which it has. *)
  Definition outside (ended : nat -> margin) (i k : nat) : margin := greatest_of ended i (S k).
  Definition ended_by (x : predicate) (ended : nat -> margin) (k : nat) : margin :=
    greatest (ended k) (at_margins x (v k)).
  Definition first_margin (x : predicate) (ended : nat -> margin) (i k : nat) : margin :=
    least (neg (outside ended i k))
      (least (at_margins x (v k)) (neg (greatest_of (fun m => at_margins x (v m)) i k))).
  Definition opens_margin (x y : predicate) (ended : nat -> margin) (i k : nat) : margin :=
    greatest (first_margin (opening x y) ended i k)
      (greatest_of (fun j => least (neg (outside ended i j))
        (least (at_margins y (v j)) (first_margin (opening x y) ended j k))) i (S k)).

  (** [known]: that instant i is in the segment has been asked, so that it is not asked again. *)
  Fixpoint robustness (p : property) (ended : nat -> margin) (known : bool) (i : nat) : margin :=
    match p with
    | Now p => at_margins p (fun a =>
        if i <? n then if known then v i a else least (v i a) (neg (ended i)) else Lowest)
    | Throughout p => least_of (fun k => greatest (outside ended i k) (at_margins p (v k))) i n
    | Not p => neg (robustness p ended known i)
    | And p q => least (robustness p ended known i) (robustness q ended known i)
    | Or p q => greatest (robustness p ended known i) (robustness q ended known i)
    | Implies p q => greatest (neg (robustness p ended known i)) (robustness q ended known i)
    | Always p => least_of (fun k => greatest (outside ended i k) (robustness p ended true k)) i n
    | Never p => least_of (fun k => greatest (outside ended i k) (neg (robustness p ended true k))) i n
    | Eventually p => greatest_of (fun k => least (neg (outside ended i k)) (robustness p ended true k)) i n
    | After x p => least_of (fun k => greatest (neg (first_margin x ended i k)) (robustness p ended true k)) i n
    | Until x p =>
        least (greatest_of (fun k => least (neg (outside ended i k)) (at_margins x (v k))) i n)
          (robustness p (ended_by x ended) false i)
    | AfterUntil x y p =>
        least_of (fun k => greatest (neg (opens_margin x y ended i k)) (robustness p (ended_by y ended) true k)) i n
    | Within _ d p => robustness p (fun k => if t i + d <? t k then Highest else ended k) known i
    end.

  (** The past. An age is decided by times alone. *)
  Definition looking_back (s : stream) (began : nat) (o : past) (k : nat) : margin :=
    let of p j := at_margins p (v j) in
    match o with
    | Previously p => match k with 0 => Lowest | S j => of p j end
    | Once D p => greatest_of (fun j => if recent t D j k then of p j else Lowest) 0 (S k)
    | Historically D p =>
        greatest_of (fun j => if long_ago t D j k then least_of (of p) j (S k) else Lowest) 0 (S k)
    | Since D p q =>
        greatest_of (fun j => if recent t D j k then least (of q j) (least_of (of p) (S j) (S k)) else Lowest) 0 (S k)
    | Age d p => if value s t began (Age d p) k then Highest else Lowest
    end.
End Robustness.

(** The whole run: its segment ends with it. *)
Definition never_ends : nat -> margin := fun _ => Lowest.

(** * What signs say *)

Definition says (a : margin) (P : Prop) : Prop := (positive a -> P) /\ (negative a -> ~ P).

Ltac margins := unfold negative in *; simpl in *; try tauto; try lia.
Ltac cases a b := destruct a, b; margins.

Lemma neg_neg : forall a, neg (neg a) = a.
Proof. intros [|z|]; simpl; auto. now rewrite Z.opp_involutive. Qed.
Lemma positive_least : forall a b, positive (least a b) <-> positive a /\ positive b.
Proof. intros a b. cases a b. Qed.
Lemma negative_least : forall a b, negative (least a b) <-> negative a \/ negative b.
Proof. intros a b. cases a b. Qed.
Lemma positive_greatest : forall a b, positive (greatest a b) <-> positive a \/ positive b.
Proof. intros a b. unfold greatest. cases a b. Qed.
Lemma negative_greatest : forall a b, negative (greatest a b) <-> negative a /\ negative b.
Proof. intros a b. unfold greatest. cases a b. Qed.

Lemma positive_least_of : forall f i n, positive (least_of f i n) -> forall k, i <= k < n -> positive (f k).
Proof.
  intros f i n. unfold least_of. remember (n - i) as m eqn:E. revert i E. induction m as [|m IH]; intros i E H k Hk;
    [lia|].
  simpl in H. apply positive_least in H as [H1 H2].
  destruct (Nat.eq_dec k i) as [->|]; auto. apply (IH (S i)); auto; lia.
Qed.
Lemma negative_least_of : forall f i n, negative (least_of f i n) -> exists k, i <= k < n /\ negative (f k).
Proof.
  intros f i n. unfold least_of. remember (n - i) as m eqn:E. revert i E. induction m as [|m IH]; intros i E H;
    [margins|].
  simpl in H. apply negative_least in H as [H|H]; [exists i; split; auto; lia|].
  destruct (IH (S i)) as (k & Hk & HN); auto; [lia|]. exists k. split; auto; lia.
Qed.

Lemma says_iff : forall a P Q, says a P -> (P <-> Q) -> says a Q.
Proof. unfold says. tauto. Qed.
Lemma says_not : forall a P, says a P -> says (neg a) (~ P).
Proof. intros a P [H1 H2]. split; [exact H2|]. unfold negative. rewrite neg_neg. tauto. Qed.
Lemma says_and : forall a b (P Q : Prop), says a P -> (P -> says b Q) -> says (least a b) (P /\ Q).
Proof.
  intros a b P Q [H1 H2] H. split; intros HS.
  - apply positive_least in HS as [A B]. split; auto. now apply H; auto.
  - intros [HP HQ]. apply negative_least in HS as [A|B]; [now apply H2 | now apply (H HP)].
Qed.
Lemma says_implies : forall a b (P Q : Prop), says a (~ P) -> (P -> says b Q) -> says (greatest a b) (P -> Q).
Proof.
  intros a b P Q [H1 H2] H. split; intros HS.
  - apply positive_greatest in HS as [A|B]; intros HP; [exfalso; now apply (H1 A) | now apply (proj1 (H HP))].
  - apply negative_greatest in HS as [A B]. intros HI. apply (H2 A). intros HP. now apply (proj2 (H HP) B), HI.
Qed.
Lemma says_or : forall a b (P Q : Prop), says a P -> says b Q -> says (greatest a b) (P \/ Q).
Proof.
  intros a b P Q [H1 H2] [H3 H4]. split; intros HS; [apply positive_greatest in HS | apply negative_greatest in HS];
    tauto.
Qed.
Lemma says_every : forall f i n (P : nat -> Prop), (forall k, i <= k < n -> says (f k) (P k)) ->
  says (least_of f i n) (forall k, i <= k < n -> P k).
Proof.
  intros f i n P H. split; intros HS.
  - intros k Hk. apply (proj1 (H k Hk)). now apply (positive_least_of f i n).
  - intros HP. apply negative_least_of in HS as (k & Hk & HN). exact (proj2 (H k Hk) HN (HP k Hk)).
Qed.
Lemma says_some : forall f i n (P : nat -> Prop), (forall k, i <= k < n -> says (f k) (P k)) ->
  says (greatest_of f i n) (exists k, i <= k < n /\ P k).
Proof.
  intros f i n P H. unfold greatest_of. split; intros HS.
  - change (negative (least_of (fun k => neg (f k)) i n)) in HS. apply negative_least_of in HS as (k & Hk & HN).
    unfold negative in HN. rewrite neg_neg in HN. exists k. split; auto. now apply (proj1 (H k Hk)).
  - unfold negative in HS. rewrite neg_neg in HS. intros (k & Hk & HP).
    apply (proj2 (H k Hk)); auto. apply (positive_least_of _ i n HS k Hk).
Qed.

Lemma at_margins_right : forall p l (w : letter), (forall a, says (l a) (w a = true)) ->
  says (at_margins p l) (at_letter p w = true).
Proof.
  induction p; simpl; intros l w H; auto.
  - split; margins; auto.
  - eapply says_iff; [apply says_not, IHp, H|]. rewrite negb_true_iff. destruct (at_letter p w); intuition congruence.
  - eapply says_iff; [apply says_and; [apply IHp1, H | intros; apply IHp2, H]|]. now rewrite andb_true_iff.
  - eapply says_iff; [apply says_or; [apply IHp1, H | apply IHp2, H]|]. now rewrite orb_true_iff.
Qed.

(** * Soundness *)
Section Sound.
  Variables (v : nat -> nat -> margin) (t : times) (n : nat) (s : stream).
  Hypothesis atoms_right : forall k a, says (v k a) (s k a = true).

  (** Where the segment from i on ends, if it does where e is true. *)
  Fixpoint stop_next (e : nat -> bool) (i m : nat) : nat :=
    match m with 0 => i | S m => if e i then i else stop_next e (S i) m end.
  Definition stop (e : nat -> bool) (i : nat) : nat := stop_next e i (n - i).

  Lemma before_stop : forall e i k, i <= k -> (k < stop e i <-> k < n /\ forall m, i <= m <= k -> e m = false).
  Proof.
    intros e i k. unfold stop. remember (n - i) as m eqn:E. revert i E. induction m as [|m IH]; intros i E Hk; simpl.
    - split; [lia|]. intros [H _]. lia.
    - destruct (e i) eqn:Ei.
      + split; [lia|]. intros [_ H]. rewrite (H i) in Ei by lia. discriminate.
      + destruct (Nat.eq_dec k i) as [->|].
        * split; [|intros _; assert (forall a b, a <= stop_next e a b) as HB
            by (intros a b; revert a; induction b; simpl; intros a; [lia|]; destruct (e a); [lia|];
                specialize (IHb (S a)); lia); specialize (HB (S i) m); lia].
          intros _. split; [lia|]. intros j Hj. now replace j with i by lia.
        * rewrite (IH (S i)) by lia. split; intros [A B]; split; auto; intros j Hj; [|apply B; lia].
          destruct (Nat.eq_dec j i) as [->|]; auto. apply B; lia.
  Qed.

  Lemma stop_least : forall e i, i <= stop e i.
  Proof.
    intros e i. unfold stop. generalize (n - i). intros m. revert i. induction m as [|m IH]; intros i; simpl; [lia|].
    destruct (e i); [lia|]. specialize (IH (S i)). lia.
  Qed.

  Lemma same_stop : forall a b i, i <= a -> i <= b -> (forall k, i <= k -> (k < a <-> k < b)) -> a = b.
  Proof.
    intros a b i Ha Hb H. destruct (lt_eq_lt_dec a b) as [[L|]|L]; auto; [specialize (H a Ha) | specialize (H b Hb)];
      lia.
  Qed.

  Lemma stop_later : forall e i k, i <= k -> k < stop e i -> stop e k = stop e i.
  Proof.
    intros e i k Hk HI. pose proof (stop_least e k). apply (same_stop _ _ k); [auto | lia|]. intros j Hj.
    pose proof (proj1 (before_stop e i k Hk) HI) as [_ HE]. rewrite !before_stop by lia.
    split; intros [A B]; split; auto; intros m Hm; [|apply B; lia].
    destruct (le_lt_dec m k); [apply HE; lia | apply B; lia].
  Qed.

  (** Where it ends if it also ends at the first instant with b. *)
  Lemma stop_cut : forall e b i, let e' k := e k || b k in
    (exists k, i <= k < stop e i /\ b k = true /\ (forall m, i <= m < k -> b m = false) /\ stop e' i = k) \/
    ((forall m, i <= m < stop e i -> b m = false) /\ stop e' i = stop e i).
  Proof.
    intros e b i e'. pose proof (stop_least e i) as HL. pose proof (stop_least e' i) as HL'.
    assert (HC : forall k, i <= k < stop e' i -> b k = false).
    { intros k Hk. destruct (proj1 (before_stop e' i k ltac:(lia)) ltac:(lia)) as [_ A]. specialize (A k ltac:(lia)).
      apply orb_false_iff in A. tauto. }
    assert (HB : stop e' i <= stop e i).
    { destruct (le_lt_dec (stop e' i) (stop e i)) as [|H]; auto. exfalso.
      destruct (proj1 (before_stop e' i (stop e i) HL) H) as [A B].
      assert (stop e i < stop e i); [|lia]. apply before_stop; auto. split; auto. intros m Hm. specialize (B m Hm).
      apply orb_false_iff in B. tauto. }
    destruct (Nat.eq_dec (stop e' i) (stop e i)) as [E|E]; [right; split; auto; intros; apply HC; lia|].
    left. exists (stop e' i). repeat split; auto; [lia|].
    destruct (b (stop e' i)) eqn:Eb; auto. exfalso. assert (stop e' i < stop e' i); [|lia].
    apply before_stop; auto. destruct (proj1 (before_stop e i (stop e' i) HL') ltac:(lia)) as [A B]. split; auto.
    intros m Hm. unfold e'. rewrite B by lia. simpl. destruct (Nat.eq_dec m (stop e' i)) as [->|]; auto. apply HC; lia.
  Qed.

  Lemma stop_inside : forall e i k, i <= k -> inside (Some (stop e i)) k -> k < stop e k.
  Proof. intros e i k Hk HI. simpl in HI. now rewrite (stop_later e i k). Qed.

  (** [ended] says where e is true. *)
  Definition agrees (ended : nat -> margin) (e : nat -> bool) : Prop := forall k, says (ended k) (e k = true).

  Lemma letter_right : forall x k, says (at_margins x (v k)) (at_letter x (s k) = true).
  Proof. intros. apply at_margins_right. apply atoms_right. Qed.

  Lemma outside_right : forall ended e i k, agrees ended e -> i <= k < n ->
    says (outside ended i k) (~ inside (Some (stop e i)) k).
  Proof.
    intros ended e i k HA Hk. eapply says_iff; [apply says_some; intros; apply HA|]. simpl.
    rewrite before_stop by lia. split.
    - intros (m & Hm & Em) [_ H]. rewrite H in Em by lia. discriminate.
    - intros H. destruct (existsb e (seq i (S k - i))) eqn:E.
      + apply existsb_exists in E as (m & Hm & Em). apply in_seq in Hm. exists m. split; auto; lia.
      + exfalso. apply H. split; [lia|]. intros m Hm. destruct (e m) eqn:Em; auto. rewrite <- E. symmetry.
        apply existsb_exists. exists m. split; auto. apply in_seq; lia.
  Qed.

  Lemma inside_right : forall ended e i k, agrees ended e -> i <= k < n ->
    says (neg (outside ended i k)) (inside (Some (stop e i)) k).
  Proof.
    intros ended e i k HA Hk. eapply says_iff; [apply says_not, (outside_right ended e); auto|]. simpl. lia.
  Qed.

  Lemma first_right : forall x ended e i k, agrees ended e -> i <= k < n ->
    says (first_margin v x ended i k) (first_step x s (Some (stop e i)) i k).
  Proof.
    intros x ended e i k HA Hk. eapply says_iff.
    - apply says_and; [apply (inside_right ended e); auto|]. intros _. apply says_and; [apply letter_right|]. intros _.
      apply says_not, says_some. intros m _. apply letter_right.
    - unfold first_step, none_in. split.
      + intros (A & B & C). repeat split; auto; try lia. intros m Hm. destruct (at_letter x (s m)) eqn:E; auto.
        exfalso. apply C. now exists m.
      + intros (_ & A & B & C). repeat split; auto. intros (m & Hm & Em). rewrite C in Em by auto. discriminate.
  Qed.

  Lemma opens_right : forall x y ended e i k, agrees ended e -> i <= k < n ->
    says (opens_margin v x y ended i k) (opens x y s (Some (stop e i)) i k).
  Proof.
    intros x y ended e i k HA Hk. set (L := Some (stop e i)).
    eapply says_iff; [apply says_or; [apply (first_right _ _ e); auto|]|].
    - apply (says_some _ _ _ (fun j => inside L j /\ at_letter y (s j) = true /\ first_step (opening x y) s L j k)).
      intros j Hj. apply says_and; [apply inside_right; auto; lia|]. intros HI. apply says_and; [apply letter_right|].
      intros _. unfold L. rewrite <- (stop_later e i j) by (auto; lia). apply first_right; auto. lia.
    - rewrite opens_split. fold L. split.
      + intros [H|(j & Hj & A & B & C)]; [now left | right]. exists j. repeat split; auto; try lia; apply C.
      + intros [H|(j & Hj & A & B & C)]; [now left | right]. exists j. split; [|auto]. destruct C. lia.
  Qed.

  Lemma ended_by_right : forall x ended e, agrees ended e ->
    agrees (ended_by v x ended) (fun k => e k || at_letter x (s k)).
  Proof.
    intros x ended e HA k. eapply says_iff; [apply says_or; [apply HA | apply letter_right]|]. now rewrite orb_true_iff.
  Qed.

  Lemma segment_stop : forall e y i L', segment s (Some (stop e i)) i y L' <->
    L' = Some (stop (fun k => e k || at_letter y (s k)) i).
  Proof.
    intros e y i L'. unfold segment.
    destruct (stop_cut e (fun k => at_letter y (s k)) i) as [(k & Hk & Bk & Nk & E)|(HN & E)]; rewrite E; split.
    - intros [(m & (A & B & C & D) & ->)|(H & ->)].
      + f_equal. simpl in B. destruct (lt_eq_lt_dec m k) as [[Hm|]|Hm]; auto; exfalso.
        * rewrite Nk in C by lia. discriminate.
        * rewrite D in Bk by lia. discriminate.
      + exfalso. rewrite H in Bk; simpl; try lia.
    - intros ->. left. exists k. repeat split; auto; simpl; lia.
    - intros [(m & (A & B & C & D) & ->)|(H & ->)]; auto. exfalso. simpl in B. rewrite HN in C by lia. discriminate.
    - intros ->. right. split; auto.
  Qed.

  Lemma part_stop : forall e d i L', part t (Some (stop e i)) i d L' <->
    L' = Some (stop (fun k => e k || (t i + d <? t k)) i).
  Proof.
    intros e d i L'. unfold part, beyond.
    destruct (stop_cut e (fun k => t i + d <? t k) i) as [(k & Hk & Bk & Nk & E)|(HN & E)]; rewrite E; split.
    - apply Nat.ltb_lt in Bk. intros [(m & A & B & C & D & ->)|(H & ->)].
      + f_equal. simpl in B. destruct (lt_eq_lt_dec m k) as [[Hm|]|Hm]; auto; exfalso.
        * specialize (Nk m ltac:(lia)). apply Nat.ltb_ge in Nk. lia.
        * apply (D k); auto; lia.
      + exfalso. apply (H k); simpl; auto; lia.
    - apply Nat.ltb_lt in Bk. intros ->. left. exists k. repeat split; simpl; auto; try lia.
      intros m Hm. specialize (Nk m Hm). apply Nat.ltb_ge in Nk. lia.
    - intros [(m & A & B & C & D & ->)|(H & ->)]; auto. exfalso. simpl in B. specialize (HN m ltac:(lia)).
      apply Nat.ltb_ge in HN. lia.
    - intros ->. right. split; auto. intros m Hm Hi. simpl in Hi. specialize (HN m ltac:(lia)).
      apply Nat.ltb_ge in HN. lia.
  Qed.

  Lemma opens_inside : forall x y e i k, i <= k < n -> opens x y s (Some (stop e i)) i k ->
    k < stop (fun k => e k || at_letter y (s k)) k.
  Proof.
    intros x y e i k Hk HO. apply before_stop; auto. split; [lia|]. intros m Hm. replace m with k by lia.
    assert (HF : at_letter (opening x y) (s k) = true /\ k < stop e i).
    { apply opens_split in HO as [(A & B & C & _)|(j & A & _ & _ & (B & C & D & _))]; simpl in *; auto. }
    destruct HF as [HF HI]. apply opening_true in HF as [_ HF]. rewrite HF.
    apply (before_stop e i k) in HI as [_ HE]; [|lia].
    rewrite HE by lia. reflexivity.
  Qed.

  Theorem robustness_right : forall p ended e known i, agrees ended e -> (known = true -> i < stop e i) ->
    says (robustness v t n p ended known i) (satisfies p s t (Some (stop e i)) i).
  Proof.
    induction p; intros ended e known i HA HK; cbn [robustness satisfies].
    - apply at_margins_right. intros a. simpl. destruct (Nat.ltb_spec i n) as [Hi|Hi].
      + destruct known.
        { specialize (HK eq_refl). apply Nat.ltb_lt in HK. rewrite HK. apply atoms_right. }
        eapply says_iff; [apply says_and; [apply atoms_right|]; intros _; apply says_not, HA|].
        destruct (Nat.ltb_spec i (stop e i)) as [HS|HS].
        * apply before_stop in HS as [_ HS]; auto. rewrite HS by lia. intuition congruence.
        * destruct (e i) eqn:E; [unfold no_atom; intuition congruence|]. exfalso. assert (i < stop e i); [|lia].
          apply before_stop; auto. split; auto. intros m Hm. now replace m with i by lia.
      + destruct (Nat.ltb_spec i (stop e i)) as [HS|HS]; [apply before_stop in HS; auto; lia|].
        unfold no_atom. split; margins; intros; discriminate.
    - eapply says_iff; [apply says_every; intros k Hk; apply says_implies; [apply (outside_right _ e); auto|];
        intros _; apply letter_right|].
      split; intros H k; [intros A B; apply H; auto; simpl in B; apply before_stop in B; auto; lia | intros A B;
        apply H; auto; lia].
    - apply says_not, IHp; auto.
    - apply says_and; [now apply IHp1 | intros _; now apply IHp2].
    - apply says_or; [now apply IHp1 | now apply IHp2].
    - apply says_implies; [now apply says_not, IHp1 | intros _; now apply IHp2].
    - eapply says_iff; [apply says_every; intros k Hk; apply says_implies; [apply (outside_right _ e); auto|];
        intros HI; apply IHp; [exact HA | intros HT; apply (stop_inside e i); [lia | exact HI]]|].
      split; intros H k; [intros A B; assert (HS := B); simpl in HS; apply before_stop in HS; auto;
        rewrite <- (stop_later e i k) by auto; apply H; auto; lia | intros A B; simpl in B;
        rewrite (stop_later e i k) by (auto; lia); apply H; auto; lia].
    - eapply says_iff; [apply says_every; intros k Hk; apply says_implies; [apply (outside_right _ e); auto|];
        intros HI; apply says_not, IHp; [exact HA | intros HT; apply (stop_inside e i); [lia | exact HI]]|].
      split; intros H k; [intros A B; assert (HS := B); simpl in HS; apply before_stop in HS; auto;
        rewrite <- (stop_later e i k) by auto; apply H; auto; lia | intros A B; simpl in B;
        rewrite (stop_later e i k) by (auto; lia); apply H; auto; lia].
    - eapply says_iff; [apply says_some; intros k Hk; apply says_and; [apply (inside_right _ e); auto|];
        intros HI; apply IHp; [exact HA | intros HT; apply (stop_inside e i); [lia | exact HI]]|].
      split; intros (k & A & B & C); exists k.
      + simpl in B. rewrite (stop_later e i k) in C by (auto; lia). repeat split; auto; lia.
      + assert (HS := B). simpl in HS. apply before_stop in HS as [HS _]; auto.
        repeat split; auto. now rewrite (stop_later e i k) by auto.
    - eapply says_iff; [apply says_every; intros k Hk; apply says_implies; [apply says_not, (first_right _ _ e); auto|];
        intros (_ & HI & _); apply IHp; [exact HA | intros HT; apply (stop_inside e i); [lia | exact HI]]|].
      split; intros H k.
      + intros HF. assert (HG := HF). destruct HG as (A & B & _). assert (HS := B). simpl in HS.
        rewrite <- (stop_later e i k) by auto. apply before_stop in HS as [HS _]; auto.
      + intros A HF. assert (HG := HF). destruct HG as (_ & B & _). simpl in B. rewrite (stop_later e i k) by (auto;
          lia). auto.
    - eapply says_iff.
      + apply says_and; [|intros _; apply IHp; [now apply ended_by_right | discriminate]].
        apply (says_some _ _ _ (fun k => inside (Some (stop e i)) k /\ at_letter x (s k) = true)).
        intros k Hk. apply says_and; [apply (inside_right _ e); auto|]. intros _. apply letter_right.
      + destruct (stop_cut e (fun k => at_letter x (s k)) i) as [(k & Hk & Bk & Nk & E)|(HN & E)]; rewrite E; split.
        * intros [_ H]. exists k. repeat split; auto; simpl; lia.
        * intros (m & (A & B & C & D) & H). assert (m = k) as ->.
          { destruct (lt_eq_lt_dec m k) as [[Hm|]|Hm]; auto; exfalso.
            - rewrite Nk in C by lia. discriminate.
            - rewrite D in Bk by lia. discriminate. }
          split; auto. assert (HS := B). simpl in HS. apply before_stop in HS as [HS _]; auto. exists k. auto.
        * intros [(k & A & B & C) _]. exfalso. simpl in B. rewrite HN in C by lia. discriminate.
        * intros (k & (A & B & C & D) & _). exfalso. simpl in B. rewrite HN in C by lia. discriminate.
    - eapply says_iff; [apply says_every; intros k Hk; apply says_implies; [apply says_not, (opens_right _ _ _ e);
        auto|];
        intros HO; apply IHp; [now apply ended_by_right | intros HT; now apply (opens_inside x y e i k)]|].
      split.
      + intros H k L' HO HG. assert (HI : i <= k /\ k < stop e i).
        { apply opens_split in HO as [(A & B & _)|(j & A & _ & _ & (B & C & _))]; simpl in *; lia. }
        rewrite <- (stop_later e i k) in HG by tauto. apply segment_stop in HG as ->. apply H; auto. split; [tauto|].
        apply (before_stop e i k); tauto.
      + intros H k Hk HO. apply (H k _ HO). assert (HI : i <= k /\ k < stop e i).
        { apply opens_split in HO as [(A & B & _)|(j & A & _ & _ & (B & C & _))]; simpl in *; lia. }
        rewrite <- (stop_later e i k) by tauto. now apply segment_stop.
    - eapply says_iff; [apply (IHp _ (fun k => e k || (t i + d <? t k)))|].
      + intros k. destruct (t i + d <? t k); [rewrite orb_true_r | rewrite orb_false_r; apply HA].
        split; margins; auto.
      + intros E. specialize (HK E). apply before_stop; auto. apply before_stop in HK as [A B]; auto. split; auto.
        intros m Hm. rewrite B by auto. replace m with i by lia. apply Nat.ltb_ge. lia.
      + split; [intros H L' HP; apply part_stop in HP as ->; exact H | intros H; apply H; now apply part_stop].
  Qed.

  (** The past. *)
  Theorem looking_back_right : forall began o k,
    says (looking_back v t s began o k) (value s t began o k = true).
  Proof.
    intros began o k. destruct o as [p|D p|D p|D p q|d p]; cbn [looking_back value].
    - destruct k; [split; margins; intros; discriminate | apply letter_right].
    - eapply says_iff; [apply (says_some _ _ _ (fun j => recent t D j k = true /\ at_letter p (s j) = true))|].
      + intros j _. destruct (recent t D j k); [|split; margins; intros; intuition discriminate].
        eapply says_iff; [apply letter_right|]. tauto.
      + rewrite some_instant_true. split; intros (j & A & B); exists j; rewrite andb_true_iff in *; split; auto; lia.
    - eapply says_iff; [apply (says_some _ _ _ (fun j => long_ago t D j k = true /\
        forall m, j <= m < S k -> at_letter p (s m) = true))|].
      + intros j _. destruct (long_ago t D j k); [|split; margins; intros; intuition discriminate].
        eapply says_iff; [apply says_every; intros; apply letter_right|]. tauto.
      + rewrite some_instant_true. split; intros (j & A & B); exists j; rewrite andb_true_iff, every_instant_true in *;
          (split; [lia|]; split; [tauto|]; intros m Hm; apply B; lia).
    - eapply says_iff; [apply (says_some _ _ _ (fun j => recent t D j k = true /\ at_letter q (s j) = true /\
        forall m, S j <= m < S k -> at_letter p (s m) = true))|].
      + intros j _. destruct (recent t D j k); [|split; margins; intros; intuition discriminate].
        eapply says_iff; [apply says_and; [apply letter_right|]; intros _; apply says_every; intros;
          apply letter_right|].
        tauto.
      + rewrite some_instant_true. split; intros (j & A & B); exists j; rewrite !andb_true_iff, every_instant_true in *;
          (split; [lia|]; intuition; match goal with H : _ |- _ => apply H end; lia).
    - destruct (some_instant k _ || _); split; margins; intros; auto; discriminate.
  Qed.
End Sound.

(** * Nearness *)

Definition near (d : Z) (a b : margin) : Prop :=
  match a, b with
  | Lowest, Lowest | Highest, Highest => True
  | Finite x, Finite y => (Z.abs (x - y) <= d)%Z
  | _, _ => False
  end.
(** More than d. *)
Definition above (d : Z) (a : margin) : Prop :=
  match a with Lowest => False | Finite z => (d < z)%Z | Highest => True end.

Section Near.
  Variable d : Z.

  Lemma near_neg : forall a b, near d a b -> near d (neg a) (neg b).
  Proof. intros a b. cases a b. Qed.
  Lemma near_least : forall a a' b b', near d a a' -> near d b b' -> near d (least a b) (least a' b').
  Proof. intros a a' b b'. destruct a, a', b, b'; margins. Qed.
  Lemma near_greatest : forall a a' b b', near d a a' -> near d b b' -> near d (greatest a b) (greatest a' b').
  Proof. intros. now apply near_neg, near_least; apply near_neg. Qed.
  Lemma near_least_of : forall f g i n, (forall k, near d (f k) (g k)) -> near d (least_of f i n) (least_of g i n).
  Proof.
    intros f g i n H. unfold least_of. generalize (n - i). intros m. revert i. induction m; intros i; simpl; auto.
    now apply near_least.
  Qed.
  Lemma near_greatest_of : forall f g i n, (forall k, near d (f k) (g k)) ->
    near d (greatest_of f i n) (greatest_of g i n).
  Proof. intros. apply near_neg, near_least_of. intros. now apply near_neg. Qed.
  Lemma near_margins : forall p l l', (forall a, near d (l a) (l' a)) -> near d (at_margins p l) (at_margins p l').
  Proof. induction p; simpl; intros; auto using near_neg, near_least, near_greatest. Qed.

  Hint Resolve near_neg near_least near_greatest near_least_of near_greatest_of near_margins : near.

  Variables (v v' : nat -> nat -> margin) (t : times) (n : nat).
  Hypothesis margins_near : forall k a, near d (v k a) (v' k a).

  Lemma near_outside : forall E E' i k, (forall j, near d (E j) (E' j)) -> near d (outside E i k) (outside E' i k).
  Proof. unfold outside. auto with near. Qed.
  Lemma near_first : forall x E E' i k, (forall j, near d (E j) (E' j)) ->
    near d (first_margin v x E i k) (first_margin v' x E' i k).
  Proof. unfold first_margin. auto 8 using near_outside with near. Qed.
  Lemma near_opens : forall x y E E' i k, (forall j, near d (E j) (E' j)) ->
    near d (opens_margin v x y E i k) (opens_margin v' x y E' i k).
  Proof. unfold opens_margin. auto 12 using near_outside, near_first with near. Qed.

  Theorem robustness_near : forall p E E' known i, (forall k, near d (E k) (E' k)) ->
    near d (robustness v t n p E known i) (robustness v' t n p E' known i).
  Proof.
    induction p; intros E E' known i HE; cbn [robustness]; auto 8 using near_outside, near_first, near_opens with near.
    - apply near_margins. intros a. destruct (i <? n); simpl; auto. destruct known; auto with near.
    - apply near_least; [auto 8 using near_outside with near|]. apply IHp. intros k. unfold ended_by. auto with near.
    - apply near_least_of. intros k. apply near_greatest; [auto using near_opens with near|]. apply IHp.
      intros j. unfold ended_by. auto with near.
    - apply IHp. intros k. destruct (t i + d0 <? t k); simpl; auto.
  Qed.

  Theorem looking_back_near : forall s began o k, near d (looking_back v t s began o k) (looking_back v' t s began o k).
  Proof.
    intros s began [p|D p|D p|D p q|c p] k; cbn [looking_back].
    - destruct k; simpl; auto with near.
    - apply near_greatest_of. intros j. destruct (recent t D j k); simpl; auto with near.
    - apply near_greatest_of. intros j. destruct (long_ago t D j k); simpl; auto with near.
    - apply near_greatest_of. intros j. destruct (recent t D j k); simpl; auto with near.
    - destruct (value s t began (Age c p) k); simpl; auto.
  Qed.
End Near.

(** A run has the verdict of every other one whose margins differ by less than its robustness. *)
Corollary same_verdict : forall d v v' t n s p, (forall k a, near d (v k a) (v' k a)) ->
  (forall k a, says (v' k a) (s k a = true)) -> (0 <= d)%Z ->
  (above d (robustness v t n p never_ends false 0) -> satisfies p s t (Some n) 0) /\
  (above d (neg (robustness v t n p never_ends false 0)) -> ~ satisfies p s t (Some n) 0).
Proof.
  intros d v v' t n s p HN HS Hd.
  assert (HE : agrees never_ends (fun _ => false)) by (intros k; split; margins; intros; discriminate).
  pose proof (robustness_right v' t n s HS p never_ends _ false 0 HE ltac:(discriminate)) as [A B].
  replace (stop n (fun _ => false) 0) with n in A, B.
  2: { apply (same_stop _ _ 0); [lia | apply stop_least|]. intros k _. rewrite before_stop by lia. intuition. }
  assert (HR : near d (robustness v t n p never_ends false 0) (robustness v' t n p never_ends false 0))
    by (apply robustness_near; auto; intros; simpl; auto).
  split; intros H; [apply A | apply B];
    destruct (robustness v t n p never_ends false 0), (robustness v' t n p never_ends false 0);
    margins.
Qed.

