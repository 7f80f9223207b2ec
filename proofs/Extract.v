(** The checker, the judge, the evaluators and the encodings as OCaml: [checker/kernel.ml];
    which letters exist: [checker/lines.ml], for the table of cases only.

    Trusted here: Coq's extraction, [nat] as OCaml's machine integers (no number in a certificate comes near their end,
    and no time that the judge takes), and a faster [mix], which makes hashes, on which no proof relies. *)
From Coq Require Import Arith Extraction ExtrOcamlBasic ExtrOcamlNatInt.
Require Import Ltl Properties Past Encodings Clocks Registers Instants Lasso Monitor Conditions Machines Distribute
  Certificate Program Follows Held Counting Evidence Instances GuardedPlaces GuardCheck.
Require Resets Thresholds.
Extraction Language OCaml.
Extract Constant mix => "fun h k -> (31 * h + k) mod 65537".
Extract Inlined Constant Nat.leb => "(<=)".
Extract Inlined Constant Nat.ltb => "(<)".
Extract Inlined Constant Nat.eq_dec => "(=)".
Extraction "checker/kernel.ml" check possible exact follows_monitor trackers Resets.past_bounds asks timers property_asks encode
  distribute anchored unbounded holds holds_on_lasso formula_eqb instants with_past with_clocks
  prepare at_first whole_part judge_part judge_line opened_by
  part_for check_guard something_is_possible starts_at_rest may_send_in message_is_answered time_is_answered
  answer_leads act_leads.
Extraction "checker/lines.ml" Thresholds.valuations_on Thresholds.doubles_from Thresholds.singles_from Thresholds.integers.
