(* What the atoms that clocks are late are called, as in ltlc/semantics/timed_atoms.py; and which timed atoms decide a
   formula, in the order of trackers.py. *)
open Kernel

let plain name =
  let later c = (c >= 'a' && c <= 'z') || c = '_' || (c >= '0' && c <= '9') in
  name <> "" && not (name.[0] >= '0' && name.[0] <= '9') && String.for_all later name
  && not (Stdlib.List.mem name [ "true"; "false"; "xor" ])

let quoted name =
  if plain name then name
  else
    let escaped = Buffer.create (String.length name + 2) in
    String.iter (fun c -> if c = '\\' || c = '"' then Buffer.add_char escaped '\\'; Buffer.add_char escaped c) name;
    "\"" ^ Buffer.contents escaped ^ "\""

(* A state predicate in Spot's syntax, with how tightly it binds: [to_text] in ltl.py. *)
let rec in_spot names predicate =
  let within strength p = let text, own = in_spot names p in if own < strength then "(" ^ text ^ ")" else text in
  match predicate with
  | PTruth -> "1", 3
  | PNot PTruth -> "0", 3
  | PAtom a -> quoted (names a), 3
  | PNot p -> "!" ^ within 3 p, 3
  | POr (PNot p, q) -> within 3 p ^ " -> " ^ within 3 q, 0
  | POr (p, q) -> within 1 p ^ " | " ^ within 1 q, 1
  | PAnd (p, q) -> within 2 p ^ " & " ^ within 2 q, 2

let clock_text names clock =
  let text p = fst (in_spot names p) in
  let rec inside = function WholeRun -> "" | o -> ", " ^ scope o
  and scope = function
    | WholeRun -> "the beginning"
    | AfterEvent (o, x) -> "after " ^ text x ^ inside o
    | BeforeEvent (o, x) -> "until " ^ text x ^ inside o
    | Episodes (o, x, y) -> "after " ^ text x ^ " until " ^ text y ^ inside o in
  match clock with
  | SinceOpening o -> scope o
  | FirstOpen (o, x, y) -> "the first " ^ text x ^ " without " ^ text y ^ inside o
  | LastTrigger (o, x) -> "the last " ^ text x ^ inside o

let units = [ "h", 3_600_000_000_000; "min", 60_000_000_000; "s", 1_000_000_000; "ms", 1_000_000; "us", 1_000; "ns", 1 ]

(* As [duration_text] in ltlc/semantics/durations.py: with decimals rather than four digits, but for full seconds. *)
let duration_text d =
  let seconds_and_less = Stdlib.List.filter (fun (_, size) -> size <= 1_000_000_000) units in
  let name, size = Stdlib.List.find (fun (_, size) -> d mod size = 0) (if d = 0 then seconds_and_less else units) in
  if d mod 1_000_000_000 = 0 || d / size < 1000 then Printf.sprintf "%d %s" (d / size) name
  else
    let name, size = Stdlib.List.find (fun (_, size) -> d >= size) seconds_and_less in
    let rec decimals rest = if rest = 0 then "" else string_of_int (rest * 10 / size) ^ decimals (rest * 10 mod size) in
    Printf.sprintf "%d.%s %s" (d / size) (decimals (d mod size)) name

let late_text names timer = "more than " ^ duration_text timer.bound_of ^ " since " ^ clock_text names timer.clock_of

let rec scope_operands = function
  | WholeRun -> []
  | AfterEvent (o, x) | BeforeEvent (o, x) -> scope_operands o @ [ x ]
  | Episodes (o, x, y) -> scope_operands o @ [ x; y ]
let clock_operands = function
  | SinceOpening o -> scope_operands o
  | FirstOpen (o, x, y) -> scope_operands o @ [ x; y ]
  | LastTrigger (o, x) -> scope_operands o @ [ x ]
let past_operands = function
  | Previously p | Once (_, p) | Historically (_, p) | Age (_, p) -> [ p ]
  | Since (_, p, q) -> [ p; q ]

(* Every atom that decides a formula, those that decide an atom before it, each once. *)
let atoms_within operands formula =
  let seen = Hashtbl.create 16 and found = ref [] in
  let rec atom a =
    if not (Hashtbl.mem seen a) then begin
      Stdlib.List.iter predicate (operands a);
      Hashtbl.replace seen a ();
      found := a :: !found
    end
  and predicate = function
    | PTruth -> ()
    | PAtom a -> atom a
    | PNot p -> predicate p
    | PAnd (p, q) | POr (p, q) -> predicate p; predicate q in
  let rec visit = function
    | Truth -> ()
    | Atom a -> atom a
    | Not f | Next f -> visit f
    | And (f, g) | Or (f, g) | Until (f, g) -> visit f; visit g in
  visit formula;
  Stdlib.List.rev !found
