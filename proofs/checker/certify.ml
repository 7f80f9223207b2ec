(* certify FILE...        check certificates, and the programs and guards in them: exit 0 if all are certified exactly, if
                          only over the words of their reset machines, each program follows its monitor, and each
                          guard is certified, 1 if not, 2 if a file is not a certificate
   certify --table        evaluate the properties and formulas on standard input: see table below *)
open Kernel

let depth = 200
let work = 64_000_000

let read_file name =
  let channel = open_in_bin name in
  Fun.protect ~finally:(fun () -> close_in channel) (fun () -> really_input_string channel (in_channel_length channel))

(* A state predicate as the language writes it, with how tightly it binds; as [in_words] in certificate_text.py. *)
let rec in_words names predicate =
  let within strength p = let text, own = in_words names p in if own < strength then "(" ^ text ^ ")" else text in
  match predicate with
  | PTruth -> "true", 3
  | PAtom a -> Stdlib.List.nth names a, 3
  | PNot p -> "not " ^ within 2 p, 2
  | PAnd (p, q) -> within 1 p ^ " and " ^ within 1 q, 1
  | POr (p, q) -> within 0 p ^ " or " ^ within 0 q, 0

(* Whether 'exactly' speaks of runs in time, not only of the words of the reset machine: there is one clock of bounds. *)
let words_are_runs c =
  match Stdlib.List.filter (fun x -> x.bounds <> []) (trackers c) with
  | [] | [ { about = Measures _ } ] -> true
  | _ -> false

let check_program c (f : Program_text.followed) =
  let follows = follows_monitor depth work c.news (trackers c) c.assumption c.machine f.program f.pairs in
  Printf.printf "  its program %s the monitor\n" (if follows then "follows" else "is not shown to follow");
  follows

let check_entry (entry : Certificate_text.entry) =
  let c = entry.certificate in
  let certified = possible depth c.assumption && entry.about && check depth work c in
  let is_exact = certified && exact c in
  let answer =
    if not (possible depth c.assumption) then "not certified: no letter is found that its assumption allows"
    else if not certified then "not certified"
    else if not is_exact then "certified"
    else if words_are_runs c then "certified exactly" else "certified, exactly over the words of its reset machine" in
  Printf.printf "%s: %s\n" entry.label answer;
  if c.assumption <> PTruth then Printf.printf "  assuming %s\n" (fst (in_words entry.atoms c.assumption));
  let is_well = match entry.followed with
    | Some program when certified -> check_program c program && is_exact
    | _ -> is_exact in
  (if is_exact then `Exactly else if certified then `Certified else `No), is_well

(* What is wrong with a region, of what the proved checker asks of it. *)
let wrong_with (g : Guard_text.t) =
  let s = g.setting and spots = g.spots in
  let in_spot r spot =
    let when_not b reason = if b then [] else [ Printf.sprintf "r%d: %s" r reason ] in
    let fallback f = Stdlib.List.nth g.fallbacks f in
    let message t = when_not (message_is_answered s spots spot t) ("no answer to a message on " ^ Stdlib.List.nth g.topics t) in
    let answer f = when_not (answer_leads s spots spot f) ("it may not rest after " ^ fallback f) in
    let act (((_, f), _) as a) = when_not (act_leads s spots spot a) ("it may not rest after " ^ fallback f ^ " ahead") in
    let from n count = Stdlib.List.init count (fun i -> n + i) in
    when_not (may_send_in s spot) "it may not send here"
    @ Stdlib.List.concat_map message (from s.owned (s.topics - s.owned))
    @ when_not (time_is_answered s spots spot) "no answer to the passage of time"
    @ Stdlib.List.concat_map answer (from 0 (Stdlib.List.length spot.answering))
    @ Stdlib.List.concat_map act spot.ahead in
  if not (something_is_possible s) then [ "nothing is found that its assumption allows" ]
  else if not (starts_at_rest s spots) then [ "it may not rest in r0, where it starts" ]
  else Stdlib.List.concat (Stdlib.List.mapi in_spot spots)

exception Too_much

(* The check allocates so many words at most. *)
let largest_check = 2e10
let limited check =
  let most = Gc.minor_words () +. largest_check in
  let alarm = Gc.create_alarm (fun () -> if Gc.minor_words () > most then raise Too_much) in
  Fun.protect ~finally:(fun () -> Gc.delete_alarm alarm) check

(* A guard, with what has been found of each property. *)
let check_guard_entry (entries : Certificate_text.entry array) certified (g : Guard_text.t) =
  let enough (s : Guard_text.subject) = certified.(s.entry) = `Exactly || (certified.(s.entry) = `Certified && not s.keeps) in
  let name (s : Guard_text.subject) = entries.(s.entry).label in
  let answer =
    match Stdlib.List.find_opt (fun s -> not (enough s)) g.subjects with
    | Some s -> "not certified: " ^ name s ^ " is not"
    | None ->
        match limited (fun () -> check_guard g.setting g.spots) with
        | true -> "certified"
        | false -> (match wrong_with g with w :: _ -> "not certified: " ^ w | [] -> "not certified")
        | exception Too_much -> "not certified: the region is too large to be checked" in
  Printf.printf "guard %s: %s\n" g.label answer;
  let listed keeps word =
    match Stdlib.List.filter (fun (s : Guard_text.subject) -> s.keeps = keeps) g.subjects with
    | [] -> ()
    | some -> Printf.printf "  %s %s\n" word (String.concat ", " (Stdlib.List.map name some)) in
  listed true "keeping"; listed false "relying on";
  answer = "certified"

let check_file name =
  let parsed () =
    let entries, guards = Certificate_text.parse (read_file name) in
    let entries = Array.of_list entries in
    entries, Stdlib.List.map (Guard_text.read entries) guards in
  match parsed () with
  | entries, guards ->
      let found = Array.map check_entry entries in
      let guarded = Stdlib.List.map (check_guard_entry entries (Array.map fst found)) guards in
      if Array.for_all snd found && Stdlib.List.for_all Fun.id guarded then 0 else 1
  | exception Words.Unreadable (line, message) -> Printf.printf "%s: line %d: %s\n" name line message; 2
  | exception Sys_error message -> prerr_endline message; 2

(* The table of cases: a property or formula over atoms a0 and a1 in prefix notation, then what it is on every run of at
   most three steps (in each encoding), then on every lasso of a stem of at most one step and a loop of at most two.
   Or 'line', the least double and comparisons of a number with constants; then their letters. *)
let all_letters = Stdlib.List.init 4 (fun mask a -> a < 2 && (mask lsr a) land 1 = 1)
let rec words length =
  if length = 0 then [ [] ]
  else Stdlib.List.concat_map (fun l -> Stdlib.List.map (fun w -> l :: w) (words (length - 1))) all_letters
let runs = Stdlib.List.concat_map words [ 0; 1; 2; 3 ]
let lassos =
  Stdlib.List.concat_map
    (fun stem -> Stdlib.List.map (fun loop -> { stem; loop }) (Stdlib.List.concat_map words [ 1; 2 ]))
    (Stdlib.List.concat_map words [ 0; 1 ])

let rec formula = function
  | "t" :: r -> Truth, r
  | "!" :: r -> let f, r = formula r in Not f, r
  | "X" :: r -> let f, r = formula r in Next f, r
  | (("&" | "|" | "U") as o) :: r ->
      let f, r = formula r in let g, r = formula r in
      (match o with "&" -> And (f, g) | "|" -> Or (f, g) | _ -> Until (f, g)), r
  | ("a0" | "a1") as a :: r -> Atom (Char.code a.[1] - 48), r
  | _ -> failwith "not a formula"

let rec predicate = function
  | Truth -> PTruth | Atom a -> PAtom a | Not f -> PNot (predicate f)
  | And (f, g) -> PAnd (predicate f, predicate g) | Or (f, g) -> POr (predicate f, predicate g)
  | Next _ | Until _ -> failwith "not a state predicate"

let event words = let f, r = formula words in predicate f, r

let rec property_with event clock = function
  | "now" :: r -> let p, r = event r in Now p, r
  | "throughout" :: r -> let p, r = event r in Throughout p, r
  | (("not" | "always" | "never" | "eventually") as o) :: r ->
      let p, r = property_with event clock r in
      (match o with "not" -> Not0 p | "always" -> Always p | "never" -> Never p | _ -> Eventually p), r
  | (("and" | "or" | "implies") as o) :: r ->
      let p, r = property_with event clock r in let q, r = property_with event clock r in
      (match o with "and" -> And0 (p, q) | "or" -> Or0 (p, q) | _ -> Implies (p, q)), r
  | "after" :: r -> let x, r = event r in let p, r = property_with event clock r in After (x, p), r
  | "until" :: r -> let x, r = event r in let p, r = property_with event clock r in Until0 (x, p), r
  | "after_until" :: r ->
      let x, r = event r in let y, r = event r in let p, r = property_with event clock r in AfterUntil (x, y, p), r
  | "within" :: d :: r -> let p, r = property_with event clock r in Within (clock (), int_of_string d, p), r
  | _ -> failwith "not a property"

let property = property_with event (fun () -> failwith "a bound needs times")

(* Four truth values a hexadecimal digit, the first the highest. *)
let rec digits = function
  | [] -> ""
  | bits ->
      let rec take n bits = match n, bits with 0, r -> 0, r | n, b :: r -> let v, r = take (n - 1) r in ((if b then 1 else 0) lsl (n - 1)) + v, r | n, [] -> let v, _ = take (n - 1) [] in v, [] in
      let value, rest = take 4 bits in
      Printf.sprintf "%x" value ^ digits rest

let on_runs f = digits (Stdlib.List.map (holds f) runs)
let on_lassos f = digits (Stdlib.List.map (holds_on_lasso f) lassos)

(* Timed cases: 'timed' or 'news' and a property, in whose predicates past operators may stand ('once 2 a0', 'once - a0'
   without a bound, 'age 2 a1'); then what it is, by the language's definition, on every observation below. After 'news', atom
   a1 holds at steps only, not where a letter is held. The session begins with the first step, at 0. *)
type observation = { first : letter; steps : (letter * int) list; until : int }

let rec choices = function [] -> [ [] ] | xs :: rest -> Stdlib.List.concat_map (fun x -> Stdlib.List.map (fun r -> x :: r) (choices rest)) xs
let observations =
  let runs length gaps tails =
    Stdlib.List.concat_map
      (fun letters ->
        Stdlib.List.concat_map
          (fun gaps ->
            let times = Stdlib.List.fold_left (fun ts g -> (Stdlib.List.hd ts + g) :: ts) [ 0 ] gaps in
            Stdlib.List.map
              (fun tail ->
                { first = Stdlib.List.hd letters;
                  steps = Stdlib.List.combine (Stdlib.List.tl letters) (Stdlib.List.tl (Stdlib.List.rev times));
                  until = Stdlib.List.hd times + tail })
              tails)
          (choices (Stdlib.List.init (length - 1) (fun _ -> gaps))))
      (words length) in
  runs 1 [] [ 0; 3 ] @ runs 2 [ 0; 1; 3 ] [ 0; 2 ] @ runs 3 [ 0; 2 ] [ 2 ]

type definitions = { mutable past : (int * past) list; mutable next : int }

let fresh d = d.next <- d.next + 1; d.next - 1
let bound = function "-" -> None | d -> Some (int_of_string d)

let rec timed_event d words =
  let one make r = let p, r = timed_event d r in let c = fresh d in d.past <- d.past @ [ (c, make p) ]; PAtom c, r in
  match words with
  | "t" :: r -> PTruth, r
  | "!" :: r -> let p, r = timed_event d r in PNot p, r
  | (("&" | "|") as o) :: r ->
      let p, r = timed_event d r in let q, r = timed_event d r in (if o = "&" then PAnd (p, q) else POr (p, q)), r
  | (("a0" | "a1") as a) :: r -> PAtom (Char.code a.[1] - 48), r
  | "previously" :: r -> one (fun p -> Previously p) r
  | "once" :: b :: r -> one (fun p -> Once (bound b, p)) r
  | "historically" :: b :: r -> one (fun p -> Historically (bound b, p)) r
  | "since" :: b :: r -> let p, r = timed_event d r in one (fun q -> Since (bound b, p, q)) r
  | "age" :: b :: r -> one (fun p -> Age (int_of_string b, p)) r
  | _ -> failwith "not a state predicate"

(* A run asks for its letters again and again: work each out once. *)
let remembered f =
  let known = Hashtbl.create 64 in
  fun k a ->
    match Hashtbl.find_opt known (k, a) with
    | Some b -> b
    | None -> let b = f k a in Hashtbl.add known (k, a) b; b

let judge quiet d p o =
  let run = Array.of_list (instants quiet o.first 0 o.steps o.until) in
  let letter k = fst run.(k) and time k = snd run.(min k (Array.length run - 1)) in
  let with_past = Stdlib.List.fold_left (fun s each -> remembered (with_past 0 [ each ] s time)) letter d.past in
  holds (encode Episode p) (Stdlib.List.init (Array.length run) (remembered (with_clocks p with_past time)))

let on_observations quiet words =
  let d = { past = []; next = 2 } in
  let p, _ = property_with (timed_event d) (fun () -> fresh d) words in
  let p = distribute p in
  digits (Stdlib.List.map (judge quiet d p) observations)

(* The letters of comparisons of one number with constants: what holds of each, in ascending order of the number. *)
module Line = struct
  open Lines

  (* A double by its bits, in hexadecimal. *)
  let rec positive n =
    if n = 1L then XH
    else let half = positive (Int64.shift_right_logical n 1) in if Int64.logand n 1L = 0L then XO half else XI half
  let integer n = if n = 0 then Z0 else if n > 0 then Zpos (positive (Int64.of_int n)) else Zneg (positive (Int64.of_int (-n)))

  let double text =
    let bits = Int64.of_string ("0x" ^ text) in
    let negative = Int64.compare bits 0L < 0 in
    let exponent = Int64.to_int (Int64.logand (Int64.shift_right_logical bits 52) 0x7ffL) in
    let fraction = Int64.logand bits 0xfffffffffffffL in
    if exponent = 0x7ff then if fraction = 0L then S754_infinity negative else S754_nan
    else if exponent = 0 && fraction = 0L then S754_zero negative
    else
      let mantissa = if exponent = 0 then fraction else Int64.logor fraction 0x10000000000000L in
      S754_finite (negative, positive mantissa, integer (max exponent 1 - 1075))

  let relation = function
    | "<" -> Less | "<=" -> AtMost | "==" -> Equal | ">=" -> AtLeast | ">" -> Greater | _ -> failwith "not a relation"
  let rec comparisons = function
    | side :: r :: margin :: constant :: rest ->
        { relates = relation r; margin = double margin; constant = double constant; constant_is_left = side = "left" }
        :: comparisons rest
    | [] -> []
    | _ -> failwith "not a comparison"
  let letter bits = String.concat "" (Stdlib.List.map (fun b -> if b then "1" else "0") bits)

  let rank text = integer (int_of_string text)
  let letters_on line words = Stdlib.List.map letter (valuations_on line (comparisons words))
  let letters = function
    | "line" :: least :: words -> letters_on (doubles_from (double least)) words
    | "singles" :: least :: words -> letters_on (singles_from (rank least)) words
    | "integers" :: least :: most :: words -> letters_on (integers (rank least) (rank most)) words
    | _ -> failwith "not a line"
end

let table_line line =
  let text = Stdlib.List.hd (String.split_on_char ';' line) |> String.trim in
  let columns = match String.split_on_char ' ' text with
    | "timed" :: words -> [ on_observations Fun.id words ]
    | "news" :: words -> [ on_observations (fun l a -> a <> 1 && l a) words ]
    | ("line" | "singles" | "integers") :: _ as words -> Line.letters words
    | "formula" :: words -> let f, _ = formula words in [ on_runs f; on_lassos f ]
    | words ->
        let p, _ = property words in
        let encoded = Stdlib.List.map (fun e -> encode e p) [ Episode; Pointwise; PointwiseStrong; Dwyer ] in
        Stdlib.List.map on_runs encoded @ Stdlib.List.map on_lassos encoded in
  print_endline (String.concat " " ((text ^ " ;") :: columns))

let rec table () = match input_line stdin with
  | line -> table_line line; table ()
  | exception End_of_file -> 0

let () =
  exit (match Stdlib.List.tl (Array.to_list Sys.argv) with
    | [ "--table" ] -> table ()
    | [] -> prerr_endline "usage: certify FILE... | certify --table"; 2
    | files -> Stdlib.List.fold_left max 0 (Stdlib.List.map check_file files))
