(* Reads what runs, and the pairs in which it follows its monitor: the same lines as ltlc/semantics/control_text.py. *)
open Kernel
open Words

type followed = { program : program; pairs : pair list }

type draft = {
  clocks : int option sequence;
  stances : stance sequence;
  branches : branch sequence;
  outcomes : outcome sequence;
  pairs : pair sequence;
}

let draft () =
  { clocks = sequence (); stances = sequence (); branches = sequence (); outcomes = sequence (); pairs = sequence () }

let way s =
  match part s with
  | Some ('o', n) -> Ends n
  | Some ('b', n) -> Asks n
  | _ -> fail "not an outcome or a branch"

let read_clock = function
  | [] -> None
  | [ "first"; d ] -> Some (duration d)
  | _ -> fail "a clock says 'first' and a duration, or nothing"

let read_stance = function
  | [ v; w ] -> { shows_verdict = verdict_of v; at_step = way w; at_clock_step = None }
  | [ v; w; "expires"; u ] -> { shows_verdict = verdict_of v; at_step = way w; at_clock_step = Some (way u) }
  | _ -> fail "not a state of a program"

let read_branch d atoms = function
  | [ q; "then"; yes; "else"; no ] ->
      let asked =
        if q <> "" && q.[0] = 'c' then IsLate (refer 'c' d.clocks.length q) else Holds (refer 'a' atoms q) in
      { asked; if_so = way yes; if_not = way no }
  | _ -> fail "not a branch"

let rec read_settings d = function
  | [] -> [], false
  | [ "again" ] -> [], true
  | c :: "never" :: rest -> with_setting d c None rest
  | c :: "now" :: n :: rest -> with_setting d c (Some (ThisInstant, duration n)) rest
  | c :: "before" :: n :: rest -> with_setting d c (Some (JustBefore, duration n)) rest
  | c :: "due" :: n :: rest -> with_setting d c (Some (WhenDue, duration n)) rest
  | _ -> fail "not how a clock is set"
and with_setting d c to_be_due rest =
  let set_clock = refer 'c' d.clocks.length c in
  let settings, again = read_settings d rest in
  { set_clock; to_be_due } :: settings, again

let read_outcome d = function
  | s :: rest ->
      let goes_to = refer 's' d.stances.length s in
      let settings, again = read_settings d rest in
      { goes_to; settings; again }
  | [] -> fail "an outcome has a state"

(* A state of the program and one of the monitor, then where the trackers are, if there are any, whether a clock step comes
   next, and a state predicate that the last letter satisfies. *)
let read_pair d states clocks predicate = function
  | s :: q :: rest ->
      let in_program = refer 's' d.stances.length s and in_monitor = refer 'q' states q in
      let stand, rest = match rest with
        | k :: rest when k <> "" && k.[0] = 'k' -> clocks k, rest
        | _ -> [], rest in
      let looks_again, rest = match rest with "again" :: rest -> true, rest | _ -> false, rest in
      let last_letter = match rest with [] -> PTruth | [ f ] -> predicate f | _ -> fail "not a pair" in
      { in_program; in_monitor; stand; looks_again; last_letter }
  | _ -> fail "a pair has a state of the program and one of the monitor"

(* One line, in a certificate with so many atoms, and states of the monitor; [clocks] and [predicate] look others up. *)
let read d kind word rest atoms states clocks predicate =
  match kind with
  | "c" -> numbered d.clocks.length word; push d.clocks (read_clock rest)
  | "s" -> numbered d.stances.length word; push d.stances (read_stance rest)
  | "b" -> numbered d.branches.length word; push d.branches (read_branch d atoms rest)
  | "o" -> numbered d.outcomes.length word; push d.outcomes (read_outcome d rest)
  | _ -> push d.pairs (read_pair d states clocks predicate rest)

let followed (d : draft) =
  if d.clocks.length + d.stances.length + d.branches.length + d.outcomes.length + d.pairs.length = 0 then None
  else begin
    let leads = function Ends n -> exists d.outcomes.length n | Asks n -> exists d.branches.length n in
    let stands s = leads s.at_step; Option.iter leads s.at_clock_step in
    let asks (b : branch) = leads b.if_so; leads b.if_not in
    Stdlib.List.iter stands (to_list d.stances);
    Stdlib.List.iter asks (to_list d.branches);
    if d.stances.length = 0 then fail "the program has no state";
    let program = { stances = to_list d.stances; branches = to_list d.branches; outcomes = to_list d.outcomes;
                    first_due = to_list d.clocks } in
    Some { program; pairs = to_list d.pairs }
  end
