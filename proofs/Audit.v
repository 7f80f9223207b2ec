(** What the main theorems assume; [make] compares the answers with [assumptions.txt]. *)
Require Import Ltl Properties Anew Past Relativise Encodings Agreement Clocks Registers Stutter Instants Trackers Resets
  ClockSteps Times OneClock
  Lasso Monitor Conditions Judgements Moves Machines Distribute Certificate Infinite InTime Thresholds
  Program Follows Followed Shown Counts.

Print Assumptions holds_sat.
Print Assumptions progress_holds.
Print Assumptions progress_sat.
Print Assumptions relativise_correct.
Print Assumptions response_earliest.
Print Assumptions prevention_latest.
Print Assumptions encode_correct.
Print Assumptions encode_correct_finite.
Print Assumptions always_after_until.
Print Assumptions bare_bodies_agree.
Print Assumptions last_step_for_ever.
Print Assumptions encode_next_free.
Print Assumptions past_means.
Print Assumptions with_trackers_correct.
Print Assumptions tracked_correct.
Print Assumptions encode_correct_online.
Print Assumptions encode_correct_timed.
Print Assumptions with_clocks_causal.
Print Assumptions clocks_right.
Print Assumptions stutter_invariant.
Print Assumptions instants_prefix.
Print Assumptions clock_steps_enough.
Print Assumptions tracker_follows.
Print Assumptions runs_are_words.
Print Assumptions runs_of_property_are_words.
Print Assumptions steps_are_words.
Print Assumptions times_exist.
Print Assumptions words_are_runs.
Print Assumptions one_clock_words_are_runs.
Print Assumptions reaches_unique.
Print Assumptions holds_on_lasso_correct.
Print Assumptions unfold_correct.
Print Assumptions equivalent_sound.
Print Assumptions each_move_shows.
Print Assumptions run_along.
Print Assumptions distribute_means_the_same.
Print Assumptions check_finite.
Print Assumptions check_permanent.
Print Assumptions check_exact.
Print Assumptions check_runs.
Print Assumptions certified_of_something.
Print Assumptions compare_rank.
Print Assumptions add_le.
Print Assumptions condition_changes_once.
Print Assumptions valuations_on_exact.
Print Assumptions valuations_exact.
Print Assumptions integers_line.
Print Assumptions singles_line.
Print Assumptions runs_unique.
Print Assumptions followed_sound.
Print Assumptions stays_between_steps.
Print Assumptions each_step.
Print Assumptions ring_correct.
Print Assumptions presumed_correct.
Print Assumptions over_when_the_first_is.

(* Below: infinite words, excluded middle. *)
Print Assumptions encode_correct_infinite.
Print Assumptions check_sound.
Print Assumptions check_exactly.
Print Assumptions certified.
Print Assumptions certified_exactly.
Print Assumptions certified_exactly_in_time.
Print Assumptions certified_untimed.
Print Assumptions certified_exactly_untimed.
Print Assumptions shown.
Print Assumptions shown_untimed.
Print Assumptions shown_exactly_untimed.
