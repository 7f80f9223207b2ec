(* Reads guards with their regions: the same lines as ltlc/semantics/region_reader.py; docs/assurance.md has them. *)
open Kernel
open Words

(* What is kept or relied on, by its number in the file. *)
type subject = { entry : int; keeps : bool }

type t = {
  label : string;
  subjects : subject list;
  topics : string list;
  fallbacks : string list;
  setting : setting0;
  spots : spot list;
}

type condition = { name : string; read : int list; is_loose : bool }
type fallback = { called : string; topic : int; becomes : source list }
type known_diagram = { tree : int diagram; size : int }

type draft = {
  entries : Certificate_text.entry array;
  guards : string sequence;
  mutable leads : bool;
  heard : string sequence;
  conditions : condition sequence;
  news : (string * int list) sequence;
  answers : fallback sequence;
  parts : (subject * waiting) sequence;
  diagrams : known_diagram sequence;
  mutable assumption : int diagram option;
  clocks : clocks sequence;
  spots : spot sequence;
  places : (place0, unit) Hashtbl.t;
  acts : (int, some_clocks * int * int diagram) Hashtbl.t;  (* by place, the latest first *)
}

let largest_diagram = 100_000
let most_places = 100_000

let draft entries =
  { entries; guards = sequence (); leads = false; heard = sequence (); conditions = sequence (); news = sequence ();
    answers = sequence (); parts = sequence (); diagrams = sequence (); assumption = None; clocks = sequence ();
    spots = sequence (); places = Hashtbl.create 16; acts = Hashtbl.create 16 }

let owned d = d.guards.length
let topic d s = refer 'm' d.heard.length s
let own_topic d s = let m = topic d s in if m < owned d then m else fail "guards do not send on this topic"

(* The words of a line that ends in a name with blanks: so many, and the name. *)
let rec words_and_name n line =
  if n = 0 then [], line
  else match String.index_opt line ' ' with
    | Some i ->
        let words, name = words_and_name (n - 1) (String.sub line (i + 1) (String.length line - i - 1)) in
        String.sub line 0 i :: words, name
    | None -> fail "a name is missing or odd"
let named n line =
  let words, name = words_and_name n line in
  words, Certificate_text.name_after "" (" " ^ name)

let rec ascending = function a :: (b :: _ as rest) -> a < b && ascending rest | _ -> true
let topics d s =
  let found = Stdlib.List.map (topic d) (String.split_on_char ',' s) in
  if ascending found then found else fail "topics are named in their order"

let read_guard d line =
  match named 2 line with
  | [ "guard"; n ], name ->
      ignore (number n);
      (match String.split_on_char ' ' name with
       | [ raw; "to"; out ] -> push d.guards (raw ^ " to " ^ out)
       | _ -> fail "a guard has a line, a topic, 'to' and a topic")
  | _ -> fail "a guard has a line, a topic, 'to' and a topic"

let read_condition d word line =
  numbered d.conditions.length word;
  let is_loose = match String.split_on_char ' ' line with _ :: "loose" :: _ -> true | _ -> false in
  let words, name = named (if is_loose then 3 else 2) line in
  let read = topics d (Stdlib.List.nth words (Stdlib.List.length words - 1)) in
  if Stdlib.List.exists (fun c -> c.name = name) (to_list d.conditions) then fail "two conditions have one name";
  push d.conditions { name; read; is_loose }

let read_fallback d word = function
  | m :: called :: effects ->
      numbered d.answers.length word;
      let condition s = refer 'a' d.conditions.length s in
      let becomes = Array.make d.conditions.length Any in
      let rec each least = function
        | a :: value :: rest ->
            let a = condition a in
            if a < least then fail "conditions are named in their order";
            becomes.(a) <- (match value with "true" -> Is true | "false" -> Is false | s -> As (condition s));
            each (a + 1) rest
        | [] -> ()
        | [ _ ] -> fail "a fallback has conditions, and what each is after it" in
      each 0 effects;
      push d.answers { called; topic = own_topic d m; becomes = Array.to_list becomes }
  | _ -> fail "a fallback has a topic and a name"

let counts d s =
  let found = Stdlib.List.map number (String.split_on_char ',' s) in
  if Stdlib.List.length found = owned d then found else fail "there is one number for each guard"

let read_part d word = function
  | [ ("keeps" | "assumes" as how); n; "begins"; w ] ->
      numbered d.parts.length word;
      let entry = number n in
      exists (Array.length d.entries) entry;
      let waits = match w with "session" -> ForSession | "silent" -> ForOthers | s -> ForSent (counts d s) in
      push d.parts ({ entry; keeps = (how = "keeps") }, waits)
  | _ -> fail "a property of a guard reads: u0 keeps 0 begins 1"

let diagram d = function
  | "true" -> { tree = Value true; size = 1 }
  | "false" -> { tree = Value false; size = 1 }
  | s -> get d.diagrams (refer 'd' d.diagrams.length s)

let read_diagram d word = function
  | [ a; "then"; yes; "else"; no ] ->
      numbered d.diagrams.length word;
      let yes = diagram d yes and no = diagram d no in
      let size = 1 + yes.size + no.size in
      if size > largest_diagram then fail "the predicate is too large";
      push d.diagrams { tree = If (refer 'a' d.conditions.length a, yes.tree, no.tree); size }
  | _ -> fail "not a decision"

let tree d s = (diagram d s).tree

(* Each property takes a word, of which [at] says where it is; then the rest. *)
let trackers_of d (s, _) = trackers d.entries.(s.entry).Certificate_text.certificate
let where_of d all_trackers part word =
  let c = d.entries.((fst part).entry).Certificate_text.certificate in
  let states = Stdlib.List.length c.machine.edges in
  match String.split_on_char '.' word with
  | [ "waits" ] -> Waits
  | [ "satisfied" ] -> Done
  | [ q ] ->
      if all_trackers <> [] then fail "it is not said where the clocks are";
      At (refer 'q' states q, { is_first = false; states = []; begun = [] })
  | [ k; q ] ->
      let k = get d.clocks (refer 'k' d.clocks.length k) in
      let fits x (_, passed) = passed <= Stdlib.List.length x.bounds in
      if Stdlib.List.compare_lengths k.states all_trackers <> 0 || all_trackers = []
         || not (Stdlib.List.for_all2 fits all_trackers k.states) then
        fail "this is no state of the clocks of the property";
      At (refer 'q' states q, k)
  | _ -> fail "a property waits, is satisfied, or is in a state"

let read_place d all_trackers word = function
  | phase :: rest ->
      numbered d.spots.length word;
      if d.spots.length = most_places then fail "there are too many places";
      let phase = if phase = "silent" then None else Some (counts d phase) in
      let rec wheres parts xs words = match parts, xs, words with
        | [], [], words -> [], words
        | part :: parts, x :: xs, word :: words ->
            let w = where_of d x part word in
            let ws, rest = wheres parts xs words in
            w :: ws, rest
        | _ -> fail "it is not said where each property is" in
      let ws, rest = wheres (to_list d.parts) all_trackers rest in
      let rest, resting = match rest with "rests" :: p :: rest -> rest, tree d p | _ -> fail "expected 'rests'" in
      let answering = Array.make (if rest = [] then 0 else d.answers.length) (Value false) in
      let rec each least = function
        | g :: p :: rest ->
            let g = refer 'g' d.answers.length g in
            if g < least then fail "fallbacks are named in their order";
            answering.(g) <- tree d p;
            each (g + 1) rest
        | [] -> ()
        | [ _ ] -> fail "a fallback has a predicate" in
      each 0 rest;
      let spot_place = phase, ws in
      if Hashtbl.mem d.places spot_place then fail "there is a second line for this place";
      Hashtbl.replace d.places spot_place ();
      push d.spots { spot_place; resting; answering = Array.to_list answering; ahead = [] }
  | [] -> fail "a place says how many messages have left"

let read_act d all_trackers = function
  | r :: rest ->
      let place = refer 'r' d.spots.length r in
      let clock s = match String.split_on_char '.' s with
        | [ n; i ] ->
            let n = number n and i = number i in
            exists (Stdlib.List.length all_trackers) n;
            exists (Stdlib.List.length (Stdlib.List.nth all_trackers n)) i;
            n, i
        | _ -> fail "a clock is named by its property and its number" in
      (match Stdlib.List.rev rest with
       | p :: g :: (_ :: _ as clocks) ->
           let clocks = Stdlib.List.rev_map clock clocks in
           if not (ascending clocks) then fail "clocks are named in their order";
           Hashtbl.add d.acts place (clocks, refer 'g' d.answers.length g, tree d p)
       | _ -> fail "an act ahead has a place, clocks, a fallback and a predicate")
  | [] -> fail "an act ahead has a place"

(* What an atom of a property is: the condition or the news of this name, if there is one. *)
let role_of_name d name =
  let rec at i = function
    | [] -> None
    | x :: rest -> if x = name then Some i else at (i + 1) rest in
  match at 0 (Stdlib.List.map (fun c -> c.name) (to_list d.conditions)) with
  | Some c -> Plain c
  | None -> (match Stdlib.List.assoc_opt name (to_list d.news) with Some ts -> NewsOf ts | None -> Own)

let finish d =
  if not d.leads || d.parts.length = 0 || d.spots.length = 0 then fail "the guard lacks a line";
  if d.heard.length < owned d then fail "the guard has a topic that is not heard";
  let assumed = match d.assumption with Some p -> p | None -> fail "the guard lacks a line" in
  let part (s, waits) =
    let entry = d.entries.(s.entry) in
    part_for entry.Certificate_text.certificate (Stdlib.List.map (role_of_name d) entry.Certificate_text.atoms) waits s.keeps in
  let setting =
    { owned = owned d; topics = d.heard.length; read_by = Stdlib.List.map (fun c -> c.read) (to_list d.conditions);
      loose = Stdlib.List.map (fun c -> c.is_loose) (to_list d.conditions);
      fallbacks = Stdlib.List.map (fun f -> f.topic, f.becomes) (to_list d.answers); assumed;
      parts = Stdlib.List.map part (to_list d.parts) } in
  let spot r = { (get d.spots r) with
                 ahead = Stdlib.List.rev_map (fun (c, g, p) -> (c, g), p) (Hashtbl.find_all d.acts r) } in
  { label = String.concat ", " (to_list d.guards); subjects = Stdlib.List.map fst (to_list d.parts);
    topics = to_list d.heard; fallbacks = Stdlib.List.map (fun f -> f.called) (to_list d.answers); setting;
    spots = Stdlib.List.init d.spots.length spot }

let stage = function
  | "guard" -> 0 | "lead" -> 1 | "m" -> 2 | "a" -> 3 | "n" -> 4 | "g" -> 5 | "u" -> 6 | "d" -> 7 | "assumption" -> 8
  | "k" -> 9 | "r" -> 10 | "ahead" -> 11 | "end" -> 12
  | _ -> fail "this starts no line of a guard"

(* One guard, or several that are one: its numbered lines, to 'end'. *)
let read entries lines =
  let d = draft entries in
  let all_trackers = lazy (Stdlib.List.map (trackers_of d) (to_list d.parts)) in
  let item last (at, line) =
    line_number := at;
    let words = String.split_on_char ' ' line in
    let word = Stdlib.List.hd words and rest = Stdlib.List.tl words in
    let kind = match part word with Some (c, _) -> String.make 1 c | None -> word in
    if part word = None && String.length kind = 1 then fail "this starts no line of a guard";
    let now = stage kind in
    if now < last then fail "this comes too late";
    if now = last && (now = 1 || now = 8) then fail "this comes a second time";
    (match kind, rest with
     | "guard", _ -> read_guard d line
     | "lead", [ n ] -> ignore (duration n); d.leads <- true
     | "m", _ -> numbered d.heard.length word; push d.heard (snd (named 1 line))
     | "a", _ -> read_condition d word line
     | "n", _ ->
         numbered d.news.length word;
         let words, name = named 2 line in
         push d.news (name, topics d (Stdlib.List.nth words 1))
     | "g", _ -> read_fallback d word rest
     | "u", _ -> read_part d word rest
     | "d", _ -> read_diagram d word rest
     | "assumption", [ p ] -> d.assumption <- Some (tree d p)
     | "k", _ -> numbered d.clocks.length word; push d.clocks (Certificate_text.read_clocks rest)
     | "r", _ -> read_place d (Lazy.force all_trackers) word rest
     | "ahead", _ -> read_act d (Lazy.force all_trackers) rest
     | "end", [] -> ()
     | _ -> fail "unexpected words");
    now in
  ignore (Stdlib.List.fold_left item 0 lines);
  finish d
