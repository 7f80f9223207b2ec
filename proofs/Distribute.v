(** Conjuncts under [always] are judged each by itself where there are bounds on time, so that each bound has its clock
    and what has none needs none: [distribute], which says the same ([distribute_means_the_same]).

    Python: [_encode_always] in [ltlc/semantics/encodings.py] does it as it encodes. *)
From Coq Require Import List Arith Lia Bool.
Require Import Ltl Properties Encodings Clocks.

(** [always] (x implies p), one [always] for each conjunct of p. *)
Fixpoint each_always (x : predicate) (p : property) : property :=
  let whole := Always (match x with PTruth => p | _ => Implies (Now x) p end) in
  if unbounded p then whole else
  match p with
  | And p q => And (each_always x p) (each_always x q)
  | Implies (Now y) p => each_always (match x with PTruth => y | _ => PAnd x y end) p
  | _ => whole
  end.

Fixpoint distribute (p : property) : property :=
  match p with
  | Always p => each_always PTruth p
  | Not p => Not (distribute p)
  | And p q => And (distribute p) (distribute q)
  | Or p q => Or (distribute p) (distribute q)
  | Implies p q => Implies (distribute p) (distribute q)
  | After x p => After x (distribute p)
  | Until x p => Until x (distribute p)
  | AfterUntil x y p => AfterUntil x y (distribute p)
  | Within c d p => Within c d (distribute p)
  | _ => p
  end.

Lemma each_always_means : forall p x s t L i, satisfies (each_always x p) s t L i <->
  forall k, i <= k -> inside L k -> at_letter x (s k) = true -> satisfies p s t L k.
Proof.
  assert (HW : forall p x s t L i,
            satisfies (Always (match x with PTruth => p | _ => Implies (Now x) p end)) s t L i <->
            forall k, i <= k -> inside L k -> at_letter x (s k) = true -> satisfies p s t L k).
  { intros p x s t L i. assert (HN : forall q, satisfies (Always (Implies (Now q) p)) s t L i <->
      forall k, i <= k -> inside L k -> at_letter q (s k) = true -> satisfies p s t L k).
    { intros q. simpl. split; intros H k A B C; apply H; auto; rewrite seen_inside in *; auto. }
    destruct x; try apply HN. simpl. split; intros H k A B; auto. }
  induction p; intros z s t L i; cbn [each_always]; destruct (unbounded _); try apply HW.
  - change (satisfies (each_always z p1) s t L i /\ satisfies (each_always z p2) s t L i <->
      forall k, i <= k -> inside L k -> at_letter z (s k) = true -> satisfies p1 s t L k /\ satisfies p2 s t L k).
    rewrite IHp1, IHp2. split; [intros [H1 H2] k A B C; auto | intros H; split; intros k A B C; now apply H].
  - destruct p1; try apply HW. rewrite IHp2. simpl.
    split; intros H k A B C; [intros D; rewrite seen_inside in D by auto|]; apply H; auto;
      rewrite ?seen_inside by auto; destruct z; simpl in *; rewrite ?andb_true_iff in *; tauto.
Qed.

Theorem distribute_means_the_same : forall p s t L i, satisfies (distribute p) s t L i <-> satisfies p s t L i.
Proof.
  induction p; intros s t L i; simpl distribute; simpl satisfies; try tauto.
  - now rewrite IHp.
  - now rewrite IHp1, IHp2.
  - now rewrite IHp1, IHp2.
  - now rewrite IHp1, IHp2.
  - rewrite each_always_means. simpl. split; intros H k A B; auto.
  - split; intros H k A; apply IHp; auto.
  - split; intros (k & A & B); exists k; (split; [auto | now apply IHp]).
  - split; intros H k L' A B; apply IHp; eauto.
  - split; intros H L' A; apply IHp; auto.
Qed.
