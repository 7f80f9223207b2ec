(** The encodings of the property language in core LTL; [episode] is what the language means ([encode_correct]).

    Python: [ltlc/semantics/encodings.py]. *)
From Coq Require Import List Arith Lia Bool.
Require Import Ltl Properties Relativise.

Inductive encoding := Episode | Pointwise | PointwiseStrong | Dwyer.

(** If [x] ever holds, [f] holds from its first step on. *)
Definition first (x : predicate) (f : formula) : formula :=
  weak_until (Ltl.Not (as_formula x)) (Ltl.And (as_formula x) f).

Definition encode_after (e : encoding) (x : predicate) (f : formula) : formula :=
  match e with
  | Episode | Dwyer => first x f
  | Pointwise | PointwiseStrong => globally (implies (as_formula x) (globally f))
  end.

Definition encode_until (e : encoding) (x : predicate) (f : formula) : formula :=
  match e with
  | Episode | Dwyer => Ltl.And (eventually (as_formula x)) (relativise x f)
  | Pointwise | PointwiseStrong => Ltl.Until f (as_formula x)
  end.

Definition encode_after_until (e : encoding) (x y : predicate) (f : formula) : formula :=
  match e with
  | Episode =>
      let next_episode := first (opening x y) (relativise y f) in
      Ltl.And next_episode (globally (implies (as_formula y) next_episode))
  | Dwyer => globally (implies (as_formula (opening x y)) (relativise y f))
  | Pointwise => globally (implies (as_formula x) (weak_until f (as_formula y)))
  | PointwiseStrong => globally (implies (as_formula x) (Ltl.Until f (as_formula y)))
  end.

(** What becomes of a state predicate as the body of a scope keyword. *)
Definition bare_body (e : encoding) : bool :=
  match e with Pointwise | PointwiseStrong => true | _ => false end.

(** [scoped] says that the property is the body of a scope keyword, or a conjunct of one. *)
Fixpoint encode_at (e : encoding) (scoped : bool) (p : property) : formula :=
  match p with
  | Now p => as_formula p
  | Throughout p => if scoped && bare_body e then as_formula p else globally (as_formula p)
  | Not p => Ltl.Not (encode_at e false p)
  | And p q => Ltl.And (encode_at e scoped p) (encode_at e scoped q)
  | Or p q => Ltl.Or (encode_at e false p) (encode_at e false q)
  | Implies p q => implies (encode_at e false p) (encode_at e false q)
  | Always p => globally (encode_at e false p)
  | Never p => globally (Ltl.Not (encode_at e false p))
  | Eventually p => eventually (encode_at e false p)
  | After x p => encode_after e x (encode_at e true p)
  | Until x p => encode_until e x (encode_at e true p)
  | AfterUntil x y p => encode_after_until e x y (encode_at e true p)
  end.
Definition encode (e : encoding) (p : property) : formula := encode_at e false p.

(** * [episode] is the denotation *)

Lemma first_sat : forall x f s L i, decided s L ->
  (sat (first x f) s L i <-> forall k, first_step x s L i k -> sat f s L k).
Proof.
  intros x f s L i Hd; unfold first, weak_until; split.
  - intros H k (H1 & H2 & H3 & H4). destruct (Hd f k) as [Hf|Hf]; auto. exfalso; apply H. exists k.
    repeat split; auto; simpl; rewrite ?as_formula_inside by auto; try tauto.
    intros m Hm [Ho _]. rewrite as_formula_inside in Ho by (eapply inside_le; [|eauto]; lia).
    rewrite H4 in Ho by auto; congruence.
  - intros H (k & H1 & H2 & (Ha & Hb) & Hc). simpl in *. rewrite as_formula_inside in Ha by auto.
    assert (Hx : at_letter x (s k) = true) by (destruct (at_letter x (s k)); auto; exfalso; apply Ha; congruence).
    destruct (first_step_inside x s L k i H1 H2 Hx) as (m & Hm & Hf).
    assert (Hs : sat f s L m) by (apply H; auto).
    assert (Hxm : sat (as_formula x) s L m) by (apply as_formula_inside; apply Hf).
    destruct (Nat.eq_dec m k) as [->|]; [tauto|]. destruct Hf as (Hi & _). apply (Hc m); [lia | tauto].
Qed.

Lemma throughout_sat : forall p s L i, decided s L ->
  (sat (globally (as_formula p)) s L i <-> forall k, i <= k -> inside L k -> at_letter p (s k) = true).
Proof.
  intros p s L i Hd. rewrite globally_sat by auto.
  split; intros H k H1 H2; [apply (as_formula_inside p s L) | apply as_formula_inside]; auto.
Qed.

Lemma episodes_sat : forall x y f s L i, decided s L ->
  (sat (encode_after_until Episode x y f) s L i <->
   forall k L', opens x y s L i k -> segment s L k y L' -> sat f s L' k).
Proof.
  intros x y f s L i Hd. simpl encode_after_until. set (e := first (opening x y) (relativise y f)).
  change (sat e s L i /\ sat (globally (implies (as_formula y) e)) s L i <->
    forall k L', opens x y s L i k -> segment s L k y L' -> sat f s L' k).
  assert (He : forall j, sat e s L j <->
    forall k, first_step (opening x y) s L j k -> sat (relativise y f) s L k) by (intros; now apply first_sat).
  rewrite globally_sat, He by auto. split.
  - intros [H1 H2] k L' Ho HS. rewrite <- (relativise_correct y f s L k L' HS).
    apply opens_split in Ho. destruct Ho as [Ho | (j & A & B & C & D)]; auto.
    destruct (H2 j A B) as [Hn | Hj]; [|now rewrite He in Hj; auto].
    exfalso; apply Hn. now rewrite as_formula_inside.
  - intros H. assert (HR : forall k, opens x y s L i k -> sat (relativise y f) s L k).
    { intros k Hk. destruct (segment_exists s L k y Hd) as (L' & HS). rewrite (relativise_correct y f s L k L' HS); auto. }
    split.
    + intros k Hk. apply HR, opens_split; auto.
    + intros j A B. destruct (at_letter y (s j)) eqn:E.
      * right. rewrite He. intros k Hk. apply HR, opens_split. right; exists j; auto.
      * left. simpl. rewrite as_formula_inside by auto. congruence.
Qed.

Theorem encode_correct : forall p s L i, decided s L -> (sat (encode Episode p) s L i <-> satisfies p s L i).
Proof.
  assert (H : forall p b s L i, decided s L -> (sat (encode_at Episode b p) s L i <-> satisfies p s L i));
    [|now intros; apply H].
  induction p; intros b s L i Hd.
  - apply as_formula_sat.
  - simpl encode_at. rewrite andb_false_r. now apply throughout_sat.
  - simpl. now rewrite IHp.
  - simpl. now rewrite IHp1, IHp2.
  - simpl. now rewrite IHp1, IHp2.
  - pose proof (Hd (encode_at Episode false p1) i) as Hp. simpl. rewrite IHp1, IHp2 in * by auto. tauto.
  - simpl encode_at. rewrite globally_sat by auto. split; intros H k H1 H2; apply (IHp false s L k Hd); auto.
  - simpl encode_at. rewrite globally_sat by auto.
    split; intros H k H1 H2 H3; apply (H k H1 H2); now apply (IHp false s L k Hd).
  - simpl encode_at. rewrite eventually_sat.
    split; intros (k & H1 & H2 & H3); exists k; repeat split; auto; now apply (IHp false s L k Hd).
  - simpl encode_at. rewrite first_sat by auto. split; intros H k Hk; apply (IHp true s L k Hd); auto.
  - simpl encode_at. change (sat (eventually (as_formula x)) s L i /\ sat (relativise x (encode_at Episode true p)) s L i
      <-> satisfies (Until x p) s L i). rewrite eventually_sat.
    assert (HR : forall k, first_step x s L i k ->
              (sat (relativise x (encode_at Episode true p)) s L i <-> satisfies p s (Some k) i)).
    { intros k HF. rewrite <- (IHp true s (Some k) i) by apply decided_finite.
      apply relativise_correct. left; eauto. }
    split.
    + intros [(k0 & A & B & C) H]. rewrite as_formula_inside in C by auto.
      destruct (first_step_inside x s L k0 i A B C) as (k & _ & Hk). exists k; split; auto. now apply HR.
    + intros (k & HF & H). split; [|now apply (HR k)]. destruct HF as (A & B & C & _).
      exists k; repeat split; auto. now rewrite as_formula_inside.
  - rewrite (episodes_sat x y (encode_at Episode true p)) by auto.
    split; intros H k L' Ho HS; apply (IHp true s L' k); eauto using segment_decided.
Qed.

(** On finite words without any axiom; for infinite words see [Infinite.v]. *)
Corollary encode_correct_finite : forall p w,
  holds (encode Episode p) w = true <-> satisfies p (at_step w) (Some (length w)) 0.
Proof.
  intros p w. rewrite <- encode_correct by apply decided_finite.
  change w with (List.skipn 0 w) at 1. apply holds_sat.
Qed.
