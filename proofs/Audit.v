(** What the main theorems assume; [make] compares the answers with [assumptions.txt].

    Those that assume the same stand side by side: Coq goes through all proofs below once for each question. *)
Require Import Ltl Properties Anew Past Relativise Encodings Agreement Clocks Registers Stutter Instants Trackers Resets
  ClockSteps Times OneClock
  Lasso Monitor Conditions Judgements Moves Machines Distribute Certificate Infinite InTime Thresholds
  Program Follows Followed Shown Counts Intervals Held Counting Evidence Instances Diagrams Guard GuardedPlaces
  GuardCheck GuardInTime GuardedNode Robustness CountMargins Bands Tightness.

(** Nothing. *)
Definition constructive :=
  (@holds_sat, @progress_holds, @progress_sat, @relativise_correct, @response_earliest, @prevention_latest,
   @encode_correct, @encode_correct_finite, @always_after_until, @bare_bodies_agree, @last_step_for_ever,
   @encode_next_free, @past_means, @with_trackers_correct, @tracked_correct, @encode_correct_online,
   @encode_correct_timed, @with_clocks_causal, @clocks_right, @stutter_invariant, @instants_prefix,
   @clock_steps_enough, @tracker_follows, @runs_are_words, @runs_of_property_are_words, @steps_are_words,
   @times_exist, @words_are_runs, @one_clock_words_are_runs, @reaches_unique, @holds_on_lasso_correct,
   @unfold_correct, @equivalent_sound, @each_move_shows, @run_along, @distribute_means_the_same, @check_finite,
   @check_permanent, @check_exact, @check_runs, @certified_of_something, @compare_rank, @add_le,
   @condition_changes_once, @valuations_on_exact, @valuations_exact, @integers_line, @singles_line, @runs_unique,
   @followed_sound, @stays_between_steps, @each_step, @ring_correct, @presumed_correct, @over_when_the_first_is,
   @interval_means, @interval_means_not, @open_for, @opened, @episode_opened, @past_part_right, @clock_part_right,
   @next_part_right, @counted_parts_right, @whole_means, @evidence_of_instances, @lines_of_instance, @opened_by_is,
   @guarded_well, @never_at_a_loss, @in_time, @few_are_sent, @time_goes_on, @necessary, @guarded_verdict,
   @check_guard_sound, @check_guard_of_something, @moves_in_time, @started_clocks_wait, @node_is_guarded,
   @robustness_right, @looking_back_right, @robustness_near, @looking_back_near, @same_verdict, @nth_greatest_is,
   @count_margin_right, @count_margin_near, @count_margin_known, @computed_right, @in_band, @band_narrows,
   @band_verdict, @looking_back_known, @interval_continued, @band_tight, @letter_exists, @band_wider).

(** At most the law of the excluded middle. *)
Definition classical :=
  (@encode_correct_infinite, @check_sound, @check_exactly, @certified, @certified_exactly, @certified_exactly_in_time,
   @certified_untimed, @certified_exactly_untimed, @shown, @shown_untimed, @shown_exactly_untimed, @evidence_of_lines,
   @evidence_untimed, @guarded_not_violated, @guarded_in_time, @nothing_is_violated, @accepted_guard).

Print Assumptions constructive.
Print Assumptions classical.
