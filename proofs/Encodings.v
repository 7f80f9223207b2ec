(** The encodings of the property language in core LTL; [episode] is what the language means ([Clocks.v]).

    A bound is a scope that its clock closes: at the first instant that is later than the bound, its atom holds.

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

(** * Bounds under [always], for which one clock is enough *)

(** [x] implies eventually [y] within d; or [x] implies throughout [y] for d. The clock's atom is c. *)
Inductive obligation := Response (c d : nat) (x y : predicate) | Prevention (c d : nat) (x y : predicate).

(** What [always (x implies p)] asks again and again, if that is all that it asks. Of conjunctions see [Distribute.v]. *)
Fixpoint obligation_of (x : predicate) (p : property) : option obligation :=
  match p with
  | Implies (Now y) p => obligation_of (match x with PTruth => y | _ => PAnd x y end) p
  | Within c d (Eventually (Now y)) => Some (Response c d x y)
  | Within c d (Always (Now y)) | Within c d (Throughout y) => Some (Prevention c d x y)
  | Within c d (Never (Now y)) => Some (Prevention c d x (PNot y))
  | _ => None
  end.

Definition encode_obligation (o : obligation) : formula :=
  match o with
  | Response c _ x y => globally (implies (as_formula x) (relativise (PAtom c) (eventually (as_formula y))))
  | Prevention c _ x y => globally (implies (as_formula x) (relativise (PAtom c) (globally (as_formula y))))
  end.

(** [scoped] says that the property is the body of a scope keyword, or a conjunct of one. *)
Fixpoint encode_at (e : encoding) (scoped : bool) (p : property) : formula :=
  match p with
  | Now p => as_formula p
  | Throughout p => if scoped && bare_body e then as_formula p else globally (as_formula p)
  | Not p => Ltl.Not (encode_at e false p)
  | And p q => Ltl.And (encode_at e scoped p) (encode_at e scoped q)
  | Or p q => Ltl.Or (encode_at e false p) (encode_at e false q)
  | Implies p q => implies (encode_at e false p) (encode_at e false q)
  | Always p =>
      match obligation_of PTruth p with Some o => encode_obligation o | None => globally (encode_at e false p) end
  | Never p => globally (Ltl.Not (encode_at e false p))
  | Eventually p => eventually (encode_at e false p)
  | After x p => encode_after e x (encode_at e true p)
  | Until x p => encode_until e x (encode_at e true p)
  | AfterUntil x y p => encode_after_until e x y (encode_at e true p)
  | Within c _ p => relativise (PAtom c) (encode_at e false p)
  end.
Definition encode (e : encoding) (p : property) : formula := encode_at e false p.

(** * What the formulas of [episode] say *)

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
    { intros k Hk. destruct (segment_exists s L k y Hd) as (L' & HS).
    rewrite (relativise_correct y f s L k L' HS); auto. }
    split.
    + intros k Hk. apply HR, opens_split; auto.
    + intros j A B. destruct (at_letter y (s j)) eqn:E.
      * right. rewrite He. intros k Hk. apply HR, opens_split. right; exists j; auto.
      * left. simpl. rewrite as_formula_inside by auto. congruence.
Qed.
