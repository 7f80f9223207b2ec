(* Reads certificates: the same lines, and the same limits, as ltlc/semantics/certificate_reader.py. *)
open Kernel

exception Unreadable of int * string

type entry = {
  label : string;
  certificate : certificate;
  atoms : string list;
  stated : formula;  (* what the file says the encoding of the property is *)
}

let largest_formula = 100_000
let most_temporal = 5_000
let deepest_property = 40
let deepest_predicate = 300
let largest_encoding = 1_000_000
let largest_task = 500_000_000

let line_number = ref 0
let fail message = raise (Unreadable (!line_number, message))

let refuse_clocks () = fail "a property with clocks: this checker does not know them yet"

(* A growing sequence. *)
type 'a sequence = { mutable length : int; items : (int, 'a) Hashtbl.t }

let sequence () = { length = 0; items = Hashtbl.create 16 }
let push s x = Hashtbl.replace s.items s.length x; s.length <- s.length + 1
let get s i = Hashtbl.find s.items i
let to_list s = Stdlib.List.init s.length (get s)

type known_formula = { formula : formula; nodes : int; height : int; predicate : predicate option }
type known_property = { property : property; depth : int; bound : int }

type draft = {
  name : string;
  mutable temporal : int;
  mutable line : int option;
  mutable encoding : encoding option;
  atoms : string sequence;
  formulas : known_formula sequence;
  properties : known_property sequence;
  mutable subject : property option;
  mutable formula_stated : formula option;
  mutable assumed : known_formula option;
  states : (verdict * target) sequence;
  annotated : known_formula list sequence;
  asked : decision sequence;
  dead : (known_formula list * (formula * formula) option) sequence;
  words : (int, lasso) Hashtbl.t;
}

let draft name =
  { name; temporal = 0; line = None; encoding = None; atoms = sequence (); formulas = sequence (); properties = sequence ();
    subject = None; formula_stated = None; assumed = None; states = sequence (); annotated = sequence ();
    asked = sequence (); dead = sequence (); words = Hashtbl.create 16 }

let is_number s =
  let n = String.length s in
  n >= 1 && n <= 9 && (n = 1 || s.[0] <> '0') && String.for_all (fun c -> c >= '0' && c <= '9') s

let number s = if is_number s then int_of_string s else fail "not a number"

let part s =
  if String.length s >= 2 && String.contains "atfpkqd" s.[0] && is_number (String.sub s 1 (String.length s - 1))
  then Some (s.[0], int_of_string (String.sub s 1 (String.length s - 1)))
  else None

let refer sort count s =
  match part s with
  | Some (c, n) when c = sort && n < count -> n
  | _ -> fail ("there is no such thing here: " ^ s)

let numbered count s = match part s with Some (_, n) when n = count -> () | _ -> fail "numbered out of order"

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
  | [ a ] -> let n = refer 'a' d.atoms.length a in add (Atom n) (Some (PAtom n)) []
  | [ "not"; f ] -> let f = known d f in add (Not f.formula) (Option.map (fun p -> PNot p) f.predicate) [ f ]
  | [ "next"; f ] -> let f = known d f in add (Next f.formula) None [ f ]
  | [ "and"; f; g ] -> let f = known d f in let g = known d g in
      add (And (f.formula, g.formula)) (both (fun p q -> PAnd (p, q)) f.predicate g.predicate) [ f; g ]
  | [ "or"; f; g ] -> let f = known d f in let g = known d g in
      add (Or (f.formula, g.formula)) (both (fun p q -> POr (p, q)) f.predicate g.predicate) [ f; g ]
  | [ "until"; f; g ] -> let f = known d f in let g = known d g in
      add (Until (f.formula, g.formula)) None [ f; g ]
  | _ -> fail "not a formula"

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
  | [ "implies"; p; q ] -> two (fun p q -> Implies (p, q)) p q
  | [ "always"; p ] -> one (fun p -> Always p) p
  | [ "never"; p ] -> one (fun p -> Never p) p
  | [ "eventually"; p ] -> one (fun p -> Eventually p) p
  | [ "after"; x; p ] -> scope (fun x p -> After (x, p)) x p
  | [ "until"; x; p ] -> scope (fun x p -> Until0 (x, p)) x p
  | [ "after_until"; x; y; p ] ->
      let x, n = event x in let y, k = event y in let p = body p in
      add (AfterUntil (x, y, p.property)) (p.depth + 1) (2 * (2 * (n + k) + p.bound * (2 * k + 6) + 14) + k + 10)
  | "within" :: _ -> refuse_clocks ()
  | _ -> fail "not a property"

let encoding_of = function
  | "episode" -> Episode | "pointwise" -> Pointwise | "pointwise-strong" -> PointwiseStrong | "dwyer" -> Dwyer
  | _ -> fail "no such encoding"

let verdict_of = function
  | "violated" -> Violated | "satisfied" -> Satisfied
  | "presumably_violated" -> PresumablyViolated | "presumably_satisfied" -> PresumablySatisfied
  | _ -> fail "no such verdict"

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
  let read = Stdlib.List.map (known d) in
  match Stdlib.List.rev words with
  | u :: "never" :: members ->
      (match (known d u).formula with
       | Until (f, g) -> push d.dead (read (Stdlib.List.rev members), Some (f, g))
       | _ -> fail "what never happens must be an until formula")
  | _ -> push d.dead (read words, None)

let stage = function
  | "property" -> 0 | "line" -> 1 | "encoding" -> 2 | "a" -> 3 | "f" -> 4 | "p" -> 5 | "subject" -> 6 | "formula" -> 7
  | "t" | "k" -> refuse_clocks ()
  | "assumption" -> 8 | "q" -> 9 | "d" -> 10 | "dead" -> 11 | "witness" -> 12 | "end" -> 13
  | _ -> fail "this starts no line of a certificate"

let once = [ 1; 2; 6; 7; 8 ]
let required = function Some x -> x | None -> fail "the property lacks a line"

let check_size d =
  let nodes = Stdlib.List.fold_left (fun n f -> n + f.nodes) 1 in
  let evaluate q fs =
    let per_square = nodes fs + (required d.assumed).nodes in
    let squares = Stdlib.List.fold_left (fun n u -> let k = size u in n + (k * k)) 0 (Hashtbl.find_all d.words q) in
    nodes fs + (squares * per_square) in
  let members = Stdlib.List.concat_map fst (to_list d.dead) in
  let dead = (Stdlib.List.length members + d.dead.length)
             * Stdlib.List.fold_left (fun n f -> n + f.nodes + 1) 0 members in
  let states = Stdlib.List.mapi evaluate (to_list d.annotated) in
  if Stdlib.List.fold_left ( + ) dead states > largest_task then fail "the certificate is too large to be checked"

let finish d =
  let subject = required d.subject and encoded_by = required d.encoding and stated = required d.formula_stated in
  let assumed = required d.assumed in
  ignore (required d.line);
  if d.states.length = 0 then fail "the property has no state";
  if Stdlib.List.length (Stdlib.List.sort_uniq compare (to_list d.atoms)) < d.atoms.length then
    fail "two atoms have one name";
  let exists = function
    | State q -> if q >= d.states.length then fail "there is no such state"
    | Ask n -> if n >= d.asked.length then fail "there is no such decision" in
  Stdlib.List.iter (fun (_, t) -> exists t) (to_list d.states);
  Stdlib.List.iter (fun (a : decision) -> exists a.low; exists a.high) (to_list d.asked);
  check_size d;
  let plain = Stdlib.List.map (fun f -> f.formula) in
  let machine = { verdicts = Stdlib.List.map fst (to_list d.states); edges = Stdlib.List.map snd (to_list d.states);
                  decisions = to_list d.asked } in
  { label = d.name;
    atoms = to_list d.atoms;
    stated;
    certificate =
      { subject; encoded_by; machine;
        assumption = required assumed.predicate;
        annotations = Stdlib.List.map plain (to_list d.annotated);
        levels = Stdlib.List.map (fun (fs, e) -> { eventuality = e; members = plain fs }) (to_list d.dead);
        witnesses = Stdlib.List.init d.states.length (fun q -> Stdlib.List.rev (Hashtbl.find_all d.words q)) } }

let read_item d kind line words =
  let word = Stdlib.List.hd words and rest = Stdlib.List.tl words in
  let only = function [ x ] -> x | _ -> fail "expected one word" in
  match kind with
  | "line" -> d.line <- Some (number (only rest))
  | "encoding" -> d.encoding <- Some (encoding_of (only rest))
  | "a" -> numbered d.atoms.length word; push d.atoms (name_after word line)
  | "f" -> numbered d.formulas.length word; read_formula d rest
  | "p" -> numbered d.properties.length word; read_property d rest
  | "subject" -> d.subject <- Some (get d.properties (refer 'p' d.properties.length (only rest))).property
  | "formula" -> d.formula_stated <- Some (known d (only rest)).formula
  | "assumption" ->
      let f = known d (only rest) in
      if f.predicate = None then fail "an assumption must not contain next or until";
      d.assumed <- Some f
  | "q" ->
      numbered d.states.length word;
      (match rest with
       | v :: t :: more ->
           let fs = match more with [] -> [] | "remains" :: (_ :: _ as fs) -> fs | _ -> fail "expected 'remains'" in
           push d.states (verdict_of v, target t);
           push d.annotated (Stdlib.List.map (known d) fs)
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
  | _ -> fail "unexpected line"

let parse text =
  let entries = ref [] and current = ref None and last = ref 0 and header = ref false and expected = ref None in
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
        | None, [ "properties"; n ] -> expected := Some (number n)
        | None, _ -> fail "the second line says 'properties' and how many"
        | Some _, _ -> item text words
    end in
  Stdlib.List.iteri line (String.split_on_char '\n' text);
  if !current <> None || !expected = None then fail "the text ends in the middle of a certificate";
  if Some (Stdlib.List.length !entries) <> !expected then fail "the number of properties is another";
  Stdlib.List.rev !entries
