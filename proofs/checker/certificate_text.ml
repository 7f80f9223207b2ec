(* Reads certificates: the same lines, and the same limits, as ltlc/semantics/certificate_reader.py. *)
open Kernel
open Words

type entry = {
  label : string;
  certificate : certificate;
  atoms : string list;
  about : bool;  (* whether the formula that the file states is the encoding of the property *)
  followed : Program_text.followed option;
}

let largest_formula = 100_000
let most_temporal = 5_000
let deepest_property = 40
let deepest_predicate = 300
let largest_encoding = 1_000_000
let largest_task = 500_000_000
let most_trackers = 50
let longest_text = 100_000_000

type known_formula = { formula : formula; nodes : int; height : int; predicate : predicate option }
type known_property = { property : property; depth : int; bound : int }
type definition = News | Past of past
(* A place by what remains, and the number of the state of the clocks if there is one. *)
type spot = { clocks : int option; remains : known_formula }

type draft = {
  name : string;
  mutable temporal : int;
  mutable line : int option;
  mutable encoding : encoding option;
  atoms : string sequence;
  definitions : (int, definition * int * int) Hashtbl.t;  (* by atom, with size and height *)
  formulas : known_formula sequence;
  used : (int, unit) Hashtbl.t;  (* the atoms that are formulas *)
  properties : known_property sequence;
  mutable subject : known_property option;
  mutable formula_stated : formula option;
  mutable assumed : known_formula option;
  clocks : clocks sequence;
  states : (verdict * target) sequence;
  annotated : spot list sequence;
  asked : decision sequence;
  dead : (spot list * progress option) sequence;
  words : (int, lasso) Hashtbl.t;
  program : Program_text.draft;
}

let draft name =
  { name; temporal = 0; line = None; encoding = None; atoms = sequence (); definitions = Hashtbl.create 16;
    formulas = sequence (); used = Hashtbl.create 16; properties = sequence (); subject = None; formula_stated = None;
    assumed = None; clocks = sequence (); states = sequence (); annotated = sequence (); asked = sequence ();
    dead = sequence (); words = Hashtbl.create 16;
    program = Program_text.draft () }

let name_after keyword line =
  let skip = String.length keyword + 1 in
  let n = String.length line - skip in
  let name = if n > 0 then String.sub line skip n else "" in
  let plain = String.for_all (fun c -> c >= ' ' && c <> '\x7f') name in
  if n <= 0 || name.[0] = ' ' || name.[n - 1] = ' ' || not plain then fail "a name is missing or odd" else name

let target s =
  match part s with
  | Some ('q', n) -> State n
  | Some ('d', n) -> Ask n
  | _ -> fail "not a state or a decision"

(* How many characters, of UTF-8. *)
let characters s = String.fold_left (fun n c -> if Char.code c land 0xc0 = 0x80 then n else n + 1) 0 s

let both f a b = match a, b with Some a, Some b -> Some (f a b) | _ -> None

let known d s = get d.formulas (refer 'f' d.formulas.length s)

let read_formula d words =
  let add formula predicate parts =
    let nodes = Stdlib.List.fold_left (fun n p -> n + p.nodes) 1 parts in
    let height = 1 + Stdlib.List.fold_left (fun n p -> max n p.height) 0 parts in
    (match formula with Next _ | Until _ -> d.temporal <- d.temporal + 1 | _ -> ());
    if nodes > largest_formula || d.temporal > most_temporal then fail "the formula is too large";
    push d.formulas { formula; nodes; height; predicate } in
  match words with
  | [ "true" ] -> add Truth (Some PTruth) []
  | [ a ] ->
      let n = refer 'a' d.atoms.length a in
      let formula = Atom n and predicate = Some (PAtom n) in
      Hashtbl.replace d.used n ();
      add formula predicate
        (match Hashtbl.find_opt d.definitions n with
         | Some (_, nodes, height) -> [ { formula; predicate; nodes; height } ]
         | None -> [])
  | [ "not"; f ] -> let f = known d f in add (Not f.formula) (Option.map (fun p -> PNot p) f.predicate) [ f ]
  | [ "next"; f ] -> let f = known d f in add (Next f.formula) None [ f ]
  | [ "and"; f; g ] -> let f = known d f in let g = known d g in
      add (And (f.formula, g.formula)) (both (fun p q -> PAnd (p, q)) f.predicate g.predicate) [ f; g ]
  | [ "or"; f; g ] -> let f = known d f in let g = known d g in
      add (Or (f.formula, g.formula)) (both (fun p q -> POr (p, q)) f.predicate g.predicate) [ f; g ]
  | [ "until"; f; g ] -> let f = known d f in let g = known d g in
      add (Until (f.formula, g.formula)) None [ f; g ]
  | _ -> fail "not a formula"

(* A timed atom: what defines it, the state predicates that decide it, a duration. *)
let read_definition d words =
  let event s = let f = known d s in
    match f.predicate with Some p -> p, f | None -> fail "a timed atom is decided by state predicates" in
  let positive s = let n = duration s in if n = 0 then fail "a duration is too small" else n in
  let one make f = let p, f = event f in Past (make p), [ f ] in
  let two make f g = let p, f = event f in let q, g = event g in Past (make p q), [ f; g ] in
  let is_news = function
    | PAtom a -> (match Hashtbl.find_opt d.definitions a with Some (News, _, _) -> true | _ -> false)
    | _ -> false in
  match words with
  | a :: definition ->
      let definition, parts = match definition with
        | [ "news" ] -> News, []
        | [ "previously"; f ] -> one (fun p -> Previously p) f
        | [ "once"; f ] -> one (fun p -> Once (None, p)) f
        | [ "once"; f; n ] -> let n = positive n in one (fun p -> Once (Some n, p)) f
        | [ "historically"; f ] -> one (fun p -> Historically (None, p)) f
        | [ "historically"; f; n ] -> let n = positive n in one (fun p -> Historically (Some n, p)) f
        | [ "since"; f; g ] -> two (fun p q -> Since (None, p, q)) f g
        | [ "since"; f; g; n ] -> let n = positive n in two (fun p q -> Since (Some n, p, q)) f g
        | [ "age"; f; n ] ->
            let n = duration n in
            one (fun p -> if is_news p then Age (n, p) else fail "an age is that of news") f
        | _ -> fail "not a definition of a timed atom" in
      let a = refer 'a' d.atoms.length a in
      if Hashtbl.mem d.definitions a || Hashtbl.mem d.used a then fail "this atom is defined or used already";
      if Hashtbl.length d.definitions = most_trackers then fail "too many atoms are defined";
      let nodes = Stdlib.List.fold_left (fun n p -> n + p.nodes) 1 parts in
      let height = 1 + Stdlib.List.fold_left (fun n p -> max n p.height) 0 parts in
      if nodes > largest_formula || height > deepest_predicate then fail "the definition is too large";
      Hashtbl.replace d.definitions a (definition, nodes, height)
  | [] -> fail "not a definition of a timed atom"

let read_clocks = function
  | ("read" | "unread" as first) :: words ->
      (* the state of each tracker, and whether its clock has only begun *)
      let rec each = function
        | [] -> []
        | "running" :: n :: rest -> let n = number n in ((Running, n), false) :: each rest
        | "begun" :: rest -> ((Running, 0), true) :: each rest
        | "idle" :: rest -> ((Idle, 0), false) :: each rest
        | "first" :: rest -> ((First, 0), false) :: each rest
        | "held" :: rest -> ((Held, 0), false) :: each rest
        | "always" :: rest -> ((Forever, 0), false) :: each rest
        | _ -> fail "this is not what a clock can do" in
      let states, begun = Stdlib.List.split (each words) in
      { is_first = (first = "unread"); states; begun }
  | _ -> fail "a state of the clocks says 'read' or 'unread' first"

let spot d s =
  match String.rindex_opt s '.' with
  | Some i ->
      { clocks = Some (refer 'k' d.clocks.length (String.sub s 0 i));
        remains = known d (String.sub s (i + 1) (String.length s - i - 1)) }
  | None -> { clocks = None; remains = known d s }

let read_property d words =
  let event s =
    let f = known d s in
    if f.height > deepest_predicate then fail "the property is too large";
    match f.predicate with Some p -> p, f.nodes | None -> fail "a state predicate must not contain next or until" in
  let body s = get d.properties (refer 'p' d.properties.length s) in
  let add property depth bound =
    let total = Stdlib.List.fold_left (fun n p -> n + p.bound) bound (to_list d.properties) in
    if depth > deepest_property || total > largest_encoding then fail "the property is too large";
    push d.properties { property; depth; bound } in
  let plain make s = let p, n = event s in add (make p) 1 (n + 6) in
  let one make s = let p = body s in add (make p.property) (p.depth + 1) (p.bound + 6) in
  let two make s u = let p = body s in let q = body u in
    add (make p.property q.property) (1 + max p.depth q.depth) (p.bound + q.bound + 6) in
  let scope make x s = let x, n = event x in let p = body s in
    add (make x p.property) (p.depth + 1) (2 * n + p.bound * (2 * n + 6) + 12) in
  match words with
  | [ "now"; f ] -> plain (fun p -> Now p) f
  | [ "throughout"; f ] -> plain (fun p -> Throughout p) f
  | [ "not"; p ] -> one (fun p -> Not0 p) p
  | [ "and"; p; q ] -> two (fun p q -> And0 (p, q)) p q
  | [ "or"; p; q ] -> two (fun p q -> Or0 (p, q)) p q
  | [ "implies"; p; q ] ->
      let p = body p in let q = body q in
      let is_trigger = match p.property with Now _ -> not (unbounded q.property) | _ -> false in
      let bound = if is_trigger then q.bound + ((p.bound + 8) * ((q.bound / 6) + 1)) + 6 else p.bound + q.bound + 6 in
      add (Implies (p.property, q.property)) (1 + max p.depth q.depth) bound
  | [ "always"; p ] -> one (fun p -> Always p) p
  | [ "never"; p ] -> one (fun p -> Never p) p
  | [ "eventually"; p ] -> one (fun p -> Eventually p) p
  | [ "after"; x; p ] -> scope (fun x p -> After (x, p)) x p
  | [ "until"; x; p ] -> scope (fun x p -> Until0 (x, p)) x p
  | [ "after_until"; x; y; p ] ->
      let x, n = event x in let y, k = event y in let p = body p in
      add (AfterUntil (x, y, p.property)) (p.depth + 1) (2 * (2 * (n + k) + p.bound * (2 * k + 6) + 14) + k + 10)
  | [ "within"; n; p ] ->
      let n = duration n in let p = body p in
      if n = 0 then fail "a bound is more than 0";
      add (Within (0, n, p.property)) (p.depth + 1) ((8 * p.bound) + 12)
  | _ -> fail "not a property"

let encoding_of = function
  | "episode" -> Episode | "pointwise" -> Pointwise | "pointwise-strong" -> PointwiseStrong | "dwyer" -> Dwyer
  | _ -> fail "no such encoding"

let letter_of d s =
  let n = String.length s in
  if n < 2 || s.[0] <> '{' || s.[n - 1] <> '}' then fail "not a letter";
  let inside = String.sub s 1 (n - 2) in
  let atoms = if inside = "" then [] else Stdlib.List.map (refer 'a' d.atoms.length) (String.split_on_char ',' inside) in
  fun a -> Stdlib.List.mem a atoms

let rec split_at_loop d before = function
  | "loop" :: (_ :: _ as after) when not (Stdlib.List.mem "loop" after) ->
      { stem = Stdlib.List.rev before; loop = Stdlib.List.map (letter_of d) after }
  | [] | "loop" :: _ -> fail "a witness has a state, letters, 'loop' and letters"
  | s :: rest -> split_at_loop d (letter_of d s :: before) rest

let read_dead d words =
  let read = Stdlib.List.map (spot d) in
  match Stdlib.List.rev words with
  | u :: "never" :: members ->
      (match (known d u).formula with
       | Until (f, g) -> push d.dead (read (Stdlib.List.rev members), Some (Eventuality (f, g)))
       | _ -> fail "what never happens must be an until formula")
  | n :: "clock" :: members -> push d.dead (read (Stdlib.List.rev members), Some (FairSet (number n)))
  | _ -> push d.dead (read words, None)

let stage = function
  | "property" -> 0 | "line" -> 1 | "encoding" -> 2 | "a" -> 3 | "f" | "t" -> 4 | "p" -> 5 | "subject" -> 6
  | "formula" -> 7 | "assumption" -> 8 | "k" -> 9 | "q" -> 10 | "d" -> 11 | "dead" -> 12 | "witness" -> 13
  | "c" -> 14 | "s" -> 15 | "b" -> 16 | "o" -> 17 | "pair" -> 18 | "end" -> 19
  | _ -> fail "this starts no line of a certificate"

let once = [ 1; 2; 6; 7; 8 ]
let required = function Some x -> x | None -> fail "the property lacks a line"

let check_size d =
  let nodes = Stdlib.List.fold_left (fun n spot -> n + spot.remains.nodes) 1 in
  let walk = if d.clocks.length = 0 then 0 else 4 * (required d.subject).bound in
  let evaluate q spots =
    let per_square = nodes spots + (required d.assumed).nodes in
    let cost n u = let k = size u in n + (k * k * per_square) + (k * walk * Stdlib.List.length spots) in
    Stdlib.List.fold_left cost (nodes spots) (Hashtbl.find_all d.words q) in
  let members = Stdlib.List.concat_map fst (to_list d.dead) in
  let dead = (Stdlib.List.length members + d.dead.length)
             * Stdlib.List.fold_left (fun n spot -> n + spot.remains.nodes + 1) 0 members in
  let states = Stdlib.List.mapi evaluate (to_list d.annotated) in
  if Stdlib.List.fold_left ( + ) dead states > largest_task then fail "the certificate is too large to be checked"

let check_complete d =
  ignore (required d.line, required d.encoding, required d.subject, required d.formula_stated, required d.assumed);
  if d.states.length = 0 then fail "the property has no state";
  if Stdlib.List.length (Stdlib.List.sort_uniq compare (to_list d.atoms)) < d.atoms.length then
    fail "two atoms have one name";
  let leads = function State q -> exists d.states.length q | Ask n -> exists d.asked.length n in
  Stdlib.List.iter (fun (_, t) -> leads t) (to_list d.states);
  Stdlib.List.iter (fun (a : decision) -> leads a.low; leads a.high) (to_list d.asked);
  check_size d

(* Whether one clock is enough for each bound where it stands. *)
let rec clocks_enough encoding p =
  let both p q = clocks_enough encoding p && clocks_enough encoding q in
  let scope judged_once p = (judged_once || unbounded p) && clocks_enough encoding p in
  match p with
  | Now _ | Throughout _ -> true
  | Not0 p | Always p | Never p | Eventually p | Within (_, _, p) -> clocks_enough encoding p
  | And0 (p, q) | Or0 (p, q) | Implies (p, q) -> both p q
  | After (_, p) | Until0 (_, p) -> scope (encoding = Episode || encoding = Dwyer) p
  | AfterUntil (_, _, p) -> scope (encoding = Episode) p

(* The property with an atom for each bound, in the order of its parts: those that [atom] makes. *)
let rec with_atoms atom p =
  let go = with_atoms atom in
  let both make p q = let p = go p in let q = go q in make p q in
  match p with
  | Now _ | Throughout _ -> p
  | Not0 p -> Not0 (go p) | Always p -> Always (go p) | Never p -> Never (go p) | Eventually p -> Eventually (go p)
  | And0 (p, q) -> both (fun p q -> And0 (p, q)) p q
  | Or0 (p, q) -> both (fun p q -> Or0 (p, q)) p q
  | Implies (p, q) -> both (fun p q -> Implies (p, q)) p q
  | After (x, p) -> After (x, go p) | Until0 (x, p) -> Until0 (x, go p)
  | AfterUntil (x, y, p) -> AfterUntil (x, y, go p)
  | Within (_, n, p) -> let c = atom () in Within (c, n, go p)

(* The subject, whose bounds get the atoms of the file that have their clocks' names; and the clocks by these atoms. *)
let with_clocks d =
  let { property; bound; _ } = required d.subject in
  let clocks = Hashtbl.create 16 in
  if unbounded property then property, clocks else begin
    let longest = Stdlib.List.fold_left (fun n name -> max n (characters name)) 0 (to_list d.atoms) in
    if longest * bound > longest_text then fail "the names of atoms are too long";
    if not (clocks_enough (required d.encoding) property && anchored (distribute property)) then
      fail "the property has a bound that takes many clocks";
    let next = ref d.atoms.length in
    let numbered = with_atoms (fun () -> incr next; !next - 1) property in
    let known = Hashtbl.create 16 and numbers = Hashtbl.create 16 in
    Stdlib.List.iteri (fun n name -> Hashtbl.replace known name n) (to_list d.atoms);
    let enter timer =
      match Hashtbl.find_opt known (Clocks_text.late_text (get d.atoms) timer) with
      | Some a -> Hashtbl.replace numbers timer.atom_of a; Hashtbl.replace clocks a timer.clock_of
      | None -> () in
    Stdlib.List.iter enter (timers WholeRun (distribute numbered));
    let defining a _ (x, _, _) found = found || match x with Past o -> asks o a | News -> false in
    let decides a _ found = found || property_asks property a || Hashtbl.fold (defining a) d.definitions false in
    if Hashtbl.fold decides clocks false then fail "that a clock is late decides no part of the property itself";
    let next = ref (d.atoms.length - 1) in
    with_atoms (fun () -> incr next; Option.value (Hashtbl.find_opt numbers !next) ~default:!next) numbered, clocks
  end

(* Whether the states of the clocks can be those of trackers with so many bounds each, and all places have one. *)
let check_clocks d most =
  let fits (k : clocks) =
    Stdlib.List.compare_lengths k.states most = 0
    && Stdlib.List.for_all2 (fun (_, passed) all -> passed <= all) k.states most in
  if Stdlib.List.length most > most_trackers then fail "the property has too many clocks";
  if not (Stdlib.List.for_all fits (to_list d.clocks)) then fail "this is no state of the clocks of the property";
  let spots = Stdlib.List.concat (to_list d.annotated @ Stdlib.List.map fst (to_list d.dead)) in
  let is_open (p : pair) = match fst (get d.states p.in_monitor) with Violated | Satisfied -> false | _ -> true in
  let is_nowhere (p : pair) = is_open p && Stdlib.List.compare_lengths p.stand most < 0 in
  if most <> [] && Stdlib.List.exists (fun (spot : spot) -> spot.clocks = None) spots
     || Stdlib.List.exists is_nowhere (to_list d.program.pairs) then
    fail "it is not said where the clocks are"

let finish d =
  check_complete d;
  let subject, clocks = with_clocks d in
  let stated = required d.formula_stated in
  let about = formula_eqb stated (encode (required d.encoding) (distribute subject)) in
  let clock_of a = if about then Hashtbl.find_opt clocks a else None in
  let defined_as a = match Hashtbl.find_opt d.definitions a with
    | Some (x, _, _) when clock_of a = None -> Some x
    | _ -> None in
  let operands a = match clock_of a, defined_as a with
    | Some clock, _ -> Clocks_text.clock_operands clock
    | None, Some (Past o) -> Clocks_text.past_operands o
    | _ -> [] in
  let within = Clocks_text.atoms_within operands stated in
  let past a = match defined_as a with Some (Past o) -> Some (a, o) | _ -> None in
  let none = { is_first = false; states = []; begun = [] } in
  let place (spot : spot) = Option.fold spot.clocks ~none ~some:(get d.clocks), spot.remains.formula in
  let places = Stdlib.List.map (Stdlib.List.map place) in
  let level (spots, progresses) = { progresses; members = Stdlib.List.map place spots } in
  let certificate =
    { subject0 = subject;
      defined = Stdlib.List.filter_map past within;
      news = Stdlib.List.filter (fun a -> defined_as a = Some News) within;
      encoded_by = required d.encoding;
      assumption = required (required d.assumed).predicate;
      machine = { verdicts = Stdlib.List.map fst (to_list d.states); edges = Stdlib.List.map snd (to_list d.states);
                  decisions = to_list d.asked };
      annotations = places (to_list d.annotated);
      levels = Stdlib.List.map level (to_list d.dead);
      witnesses = Stdlib.List.init d.states.length (fun q -> Stdlib.List.rev (Hashtbl.find_all d.words q)) } in
  let most = if about then Stdlib.List.map (fun x -> Stdlib.List.length x.bounds) (trackers certificate)
    else Stdlib.List.map (fun (_, o) -> Stdlib.List.length (past_bounds o)) certificate.defined in
  check_clocks d most;
  { label = d.name; atoms = to_list d.atoms; about; certificate; followed = Program_text.followed d.program }

let read_item d kind line words =
  let word = Stdlib.List.hd words and rest = Stdlib.List.tl words in
  let only = function [ x ] -> x | _ -> fail "expected one word" in
  match kind with
  | "line" -> d.line <- Some (number (only rest))
  | "encoding" -> d.encoding <- Some (encoding_of (only rest))
  | "a" -> numbered d.atoms.length word; push d.atoms (name_after word line)
  | "t" -> numbered (Hashtbl.length d.definitions) word; read_definition d rest
  | "f" -> numbered d.formulas.length word; read_formula d rest
  | "p" -> numbered d.properties.length word; read_property d rest
  | "subject" -> d.subject <- Some (get d.properties (refer 'p' d.properties.length (only rest)))
  | "formula" -> d.formula_stated <- Some (known d (only rest)).formula
  | "assumption" ->
      let f = known d (only rest) in
      if f.predicate = None then fail "an assumption must not contain next or until";
      d.assumed <- Some f
  | "k" -> numbered d.clocks.length word; push d.clocks (read_clocks rest)
  | "q" ->
      numbered d.states.length word;
      (match rest with
       | v :: t :: more ->
           let fs = match more with [] -> [] | "remains" :: (_ :: _ as fs) -> fs | _ -> fail "expected 'remains'" in
           push d.states (verdict_of v, target t);
           push d.annotated (Stdlib.List.map (spot d) fs)
       | _ -> fail "a state has a verdict and what follows")
  | "d" ->
      numbered d.asked.length word;
      (match rest with
       | [ a; "then"; high; "else"; low ] ->
           push d.asked { atom = refer 'a' d.atoms.length a; low = target low; high = target high }
       | _ -> fail "not a decision")
  | "dead" -> read_dead d rest
  | "witness" ->
      (match rest with
       | q :: word -> Hashtbl.add d.words (refer 'q' d.states.length q) (split_at_loop d [] word)
       | [] -> fail "a witness has a state")
  | "c" | "s" | "b" | "o" | "pair" ->
      let clocks k = (get d.clocks (refer 'k' d.clocks.length k)).states in
      let predicate s = match (known d s).predicate with
        | Some p -> p
        | None -> fail "a letter satisfies a state predicate" in
      Program_text.read d.program kind word rest d.atoms.length d.states.length clocks predicate
  | _ -> fail "unexpected line"

(* The certificates in a text; and of each guard that comes after them its lines, with their numbers, for guard_text.ml. *)
let parse text =
  let entries = ref [] and current = ref None and last = ref 0 and header = ref false and expected = ref None in
  let guards = ref [] and guard = ref [] in
  let item line words =
    let word = Stdlib.List.hd words in
    let kind = match part word with Some (c, _) -> String.make 1 c | None -> word in
    if part word = None && String.length kind = 1 then fail "this starts no line of a certificate";
    let now = stage kind in
    match !current with
    | None -> if now <> 0 then fail "a property starts with 'property'"; current := Some (draft (name_after word line)); last := 0
    | Some d ->
        if now = 0 || now < !last then fail "this comes too late";
        if now = !last && Stdlib.List.mem now once then fail "this comes a second time";
        last := now;
        if kind <> "end" then read_item d kind line words
        else begin
          if words <> [ "end" ] then fail "unexpected words";
          entries := finish d :: !entries; current := None
        end in
  let line index text =
    line_number := index + 1;
    if text <> "" && text.[0] <> '#' then begin
      let words = String.split_on_char ' ' text in
      if not !header then (if text = "ltlc-certificate 1" then header := true else fail "not a certificate")
      else
        match !expected, words with
        | None, [ "properties"; n ] -> expected := Some (number n, 0)
        | None, [ "properties"; n; "guards"; g ] -> let n = number n in expected := Some (n, number g)
        | None, _ -> fail "the second line says 'properties' and how many"
        | Some _, word :: _ when !guard <> [] || (!current = None && word = "guard") ->
            guard := (index + 1, text) :: !guard;
            if text = "end" then begin guards := Stdlib.List.rev !guard :: !guards; guard := [] end
        | Some _, _ -> if !guards <> [] then fail "properties come before guards"; item text words
    end in
  Stdlib.List.iteri line (String.split_on_char '\n' text);
  if !current <> None || !guard <> [] || !expected = None then fail "the text ends in the middle of a certificate";
  if Some (Stdlib.List.length !entries, Stdlib.List.length !guards) <> !expected then
    fail "the number of properties or guards is another";
  Stdlib.List.rev !entries, Stdlib.List.rev !guards
