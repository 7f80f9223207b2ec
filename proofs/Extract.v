(** The checker, the evaluators and the encodings as OCaml: [checker/kernel.ml].

    Trusted here: Coq's extraction, [nat] as OCaml's machine integers (no number in a certificate comes near their end),
    and a faster [mix], which makes hashes, on which no proof relies. *)
From Coq Require Import Extraction ExtrOcamlBasic ExtrOcamlNatInt.
Require Import Ltl Properties Past Encodings Registers Instants Lasso Monitor Conditions Certificate.
Require Thresholds.
Extraction Language OCaml.
Extract Constant mix => "fun h k -> (31 * h + k) mod 65537".
Extract Inlined Constant Nat.leb => "(<=)".
Extraction "checker/kernel.ml" check possible exact encode holds holds_on_lasso formula_eqb instants with_past with_clocks
  Thresholds.valuations.
