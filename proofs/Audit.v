(** What the main theorems assume; [make] compares the answers with [assumptions.txt]. *)
Require Import Ltl Properties Relativise Encodings Agreement Stutter Lasso Monitor Conditions Certificate Infinite Thresholds.

Print Assumptions holds_sat.
Print Assumptions progress_holds.
Print Assumptions progress_sat.
Print Assumptions relativise_correct.
Print Assumptions encode_correct.
Print Assumptions encode_correct_finite.
Print Assumptions always_after_until.
Print Assumptions bare_bodies_agree.
Print Assumptions last_step_for_ever.
Print Assumptions encode_next_free.
Print Assumptions reaches_unique.
Print Assumptions holds_on_lasso_correct.
Print Assumptions unfold_correct.
Print Assumptions equivalent_sound.
Print Assumptions check_finite.
Print Assumptions check_runs.
Print Assumptions check_continues.
Print Assumptions certified_of_something.
Print Assumptions compare_rank.
Print Assumptions add_le.
Print Assumptions condition_changes_once.
Print Assumptions valuations_exact.

(* Below: infinite words, excluded middle. *)
Print Assumptions encode_correct_infinite.
Print Assumptions check_sound.
Print Assumptions check_exactly.
Print Assumptions certified.
Print Assumptions certified_exactly.
