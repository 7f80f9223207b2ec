(* judge CERTIFICATES EVIDENCE    from letters to verdicts, line by line: exit 0 if every verdict is as claimed, 1 if not, 2 if
                                  a file cannot be read

   Trusted here: how lines become letters of the certificate, and that each is given to [judge_line] with the time of the
   next. Where a letter that is held has to be cut is looked for here, and need not be right. *)
open Kernel
open Evidence_text

let depth = 200
let work = 64_000_000

exception Refused of string
let refuse message = raise (Refused message)

let read_file name =
  let channel = open_in_bin name in
  Fun.protect ~finally:(fun () -> close_in channel) (fun () -> really_input_string channel (in_channel_length channel))

let in_words = function
  | Violated -> "violated" | Satisfied -> "satisfied"
  | PresumablyViolated -> "presumably_violated" | PresumablySatisfied -> "presumably_satisfied"

(* Whether a certificate is accepted; each is looked at once. *)
let checked = Hashtbl.create 64
let is_certified (entry : Certificate_text.entry) =
  match Hashtbl.find_opt checked entry.label with
  | Some answer -> answer
  | None ->
      let c = entry.certificate in
      let answer = entry.about && possible depth c.assumption && check depth work c in
      Hashtbl.replace checked entry.label answer;
      answer

(* For each atom of the evidence, and then each count, its number in the certificate; if the monitor does not depend on it, one
   that the certificate does not have. What the certificate does not define has to be there, and nothing that it defines. *)
let places claim (entry : Certificate_text.entry) judging =
  let number = Hashtbl.create 16 in
  Stdlib.List.iteri (fun a name -> Hashtbl.replace number name a) entry.atoms;
  let is_defined a =
    Stdlib.List.mem_assoc a entry.certificate.defined
    || Stdlib.List.exists (fun timer -> timer.atom_of = a) judging.clocks_of in
  let place name =
    match Hashtbl.find_opt number name with
    | Some a when is_defined a -> refuse (Printf.sprintf "'%s' follows from the other atoms" name)
    | Some a -> Hashtbl.remove number name; a
    | None when Stdlib.List.mem name entry.atoms -> refuse (Printf.sprintf "'%s' is there twice" name)
    | None -> -1 in
  let found = Array.map place (Array.append claim.names (Array.of_list (Stdlib.List.map fst claim.counts))) in
  Hashtbl.iter (fun name a -> if not (is_defined a) then refuse (Printf.sprintf "'%s' is missing" name)) number;
  let size = Stdlib.List.length entry.atoms in
  Array.mapi (fun n a -> if a < 0 then size + n else a) found

(* What is counted, of atoms in these places; and those of its atoms that are news. *)
let count_of claim place said =
  let wrong () = refuse ("not a count: " ^ said) in
  let atom word =
    match if String.length word > 1 && word.[0] = 'a' then after "a" word else "" with
    | n when Words.is_number n && int_of_string n < Array.length claim.names -> place.(int_of_string n)
    | _ -> wrong () in
  let duration word = if Words.has_digits 18 word && word <> "0" then int_of_string word else wrong () in
  let rec predicate = function
    | "true" :: rest -> PTruth, [], rest
    | "not" :: rest -> let p, news, rest = predicate rest in PNot p, news, rest
    | "and" :: rest -> let p, q, news, rest = two rest in PAnd (p, q), news, rest
    | "or" :: rest -> let p, q, news, rest = two rest in POr (p, q), news, rest
    | "new" :: word :: rest -> let a = atom word in PAtom a, [ a ], rest
    | word :: rest -> PAtom (atom word), [], rest
    | [] -> wrong ()
  and two words =
    let p, news, words = predicate words in
    let q, others, words = predicate words in
    p, q, news @ others, words in
  let flag word words = match words with first :: rest when first = word -> true, rest | _ -> false, words in
  match String.split_on_char ' ' said with
  | times :: words when Words.is_number times && times <> "0" ->
      let bounded, words = match words with "within" :: d :: rest -> Some (duration d), rest | _ -> None, words in
      let begins, words = flag "begins" words in
      let is_presumed, words = flag "presumed" words in
      let occurring, news, rest = predicate words in
      if rest <> [] then wrong ();
      { occurring; many = int_of_string times; bounded; begins; is_presumed }, news
  | _ -> wrong ()

(* A claim that is being judged: the line before is kept until the time of the next is known. If an atom [opens] instances,
   these are [opened], and what is not decided stands once for all that are alike; the first was [violated] then. *)
type run = {
  judging : judging; letter_of : string -> letter; opens : int option; mutable standing : standing;
  mutable opened : standing list; mutable violated : int option; mutable before : (letter * int) option;
}

let start claim entries =
  let entry = match Stdlib.List.find_opt (fun (e : Certificate_text.entry) -> e.label = claim.label) entries with
    | Some entry -> entry
    | None -> refuse "it has no certificate" in
  if not (is_certified entry) then refuse "its monitor is not certified";
  let certificate = entry.certificate in
  let prepared counts scopes news =
    match prepare certificate claim.session counts scopes news with
    | Some judging -> judging
    | None when scopes <> [] -> refuse "there is no scope with its number that is open once at a time"
    | None -> refuse "its encoding is not that of the language" in
  let place = places claim entry (prepared [] [] []) in
  let before_scopes = Stdlib.List.length entry.atoms + Array.length place in
  let size = before_scopes + Stdlib.List.length claim.scopes in
  let counts = Stdlib.List.map (fun (_, said) -> count_of claim place said) claim.counts in
  let counted n (count, _) = place.(Array.length claim.names + n), count in
  let scopes = Stdlib.List.mapi (fun n number -> before_scopes + n, number) claim.scopes in
  let news = Stdlib.List.concat (certificate.news :: Stdlib.List.map snd counts) in
  let judging = prepared (Stdlib.List.mapi counted counts) scopes news in
  let atoms = Array.length claim.names in
  let place_of n = if n < atoms then place.(n) else before_scopes + n - atoms in
  let known = Hashtbl.create 64 in
  let letter_of text =
    match Hashtbl.find_opt known text with
    | Some letter -> letter
    | None ->
        let holds = Array.make size false in
        Stdlib.List.iter (fun n -> holds.(place_of n) <- true) (numbers_of claim text);
        let letter a = a < size && Array.unsafe_get holds a in
        if Hashtbl.length known = 10_000 then Hashtbl.reset known;
        Hashtbl.replace known text letter;
        letter in
  let opens = Option.map (fun n -> place.(n)) claim.opens in
  Option.iter (fun a -> if not (opened_by certificate judging.counted a) then refuse "its certificate is not of instances") opens;
  { judging; letter_of; opens; standing = at_first; opened = []; violated = None; before = None }

(* Why a part is not judged. *)
let reason judging standing x =
  match whole_part judging standing x with
  | None when judging.scoped <> [] -> "it does not say which scopes are open"
  | None when judging.counted <> [] -> "what is counted depends on steps that have no line"
  | None -> "what 'previously' asks depends on steps that have no line"
  | Some (((l, _), _), _) when not (at_letter judging.certificate_of.assumption l) ->
      "the certificate assumes that there is no such letter"
  | Some _ -> "the verdict depends on how often this letter comes"

(* The last instants before a clock's answer changes while a letter is held from u to v. *)
let rec cuts_of judging standing letter u v =
  let part w = { lets = letter; from = u; upto = w; single = false } in
  let judged w = judge_part judging standing (part w) in
  if judged v <> None then []
  else begin
    let rec last_judged low high =
      let middle = low + ((high - low) / 2) in
      if middle = low then low else if judged middle <> None then last_judged middle high else last_judged low middle in
    let cut = last_judged u v in
    match judged cut with
    | Some standing when cut < v -> cut :: cuts_of judging standing letter (cut + 1) v
    | _ -> refuse (reason judging standing (part cut))
  end

(* What is known after a line, which is held up to v. *)
let judged judging standing letter u v =
  let with_cuts cuts = judge_line judging standing letter u v cuts in
  match with_cuts [] with
  | Some standing -> standing
  | None ->
      let x = { lets = letter; from = u; upto = u; single = true } in
      match judge_part judging standing x with
      | None -> refuse (reason judging standing x)
      | Some standing ->
          match with_cuts (cuts_of judging standing (quiet judging.passing_by letter) (u + 1) v) with
          | Some standing -> standing
          | None -> refuse "it is not judged"

(* Each instance is judged along all lines, as if the atom that opens it held at its own and at no other one. *)
let judge_instances run a letter u v =
  let others b = b <> a && letter b in
  let going_on = Stdlib.List.map (fun standing -> judged run.judging standing others u v) run.opened in
  let all = if letter a then judged run.judging run.standing letter u v :: going_on else going_on in
  let is_open standing = match standing.verdict_shown with Violated | Satisfied -> false | _ -> true in
  let alike = Stdlib.List.map (fun standing -> { standing with since = 0 }) (Stdlib.List.filter is_open all) in
  let violated = Stdlib.List.filter (fun standing -> standing.verdict_shown = Violated) all in
  (match run.violated, Stdlib.List.sort compare (Stdlib.List.map (fun standing -> standing.since) violated) with
   | None, first :: _ -> run.violated <- Some first
   | _ -> ());
  run.opened <- Stdlib.List.sort_uniq compare alike;
  run.standing <- judged run.judging run.standing others u v

(* The line before, now that it is known to be held up to v. *)
let judge_before run v =
  match run.before with
  | None -> ()
  | Some (letter, u) ->
      if u > latest || v > latest then refuse "times after the year 2084 are not judged";
      if v < u then refuse "times go back";
      match run.opens with
      | Some a -> judge_instances run a letter u v
      | None -> run.standing <- judged run.judging run.standing letter u v

(* The verdict of all that was judged, and since when it is that: with instances that of the worst. *)
let shown run =
  match run.opens, run.violated with
  | None, _ -> run.standing.verdict_shown, run.standing.since
  | Some _, Some first -> Violated, first
  | Some _, None ->
      let is_owed standing = standing.verdict_shown = PresumablyViolated in
      (if Stdlib.List.exists is_owed run.opened then PresumablyViolated else PresumablySatisfied), 0

let from verdict time = Printf.sprintf "%s from %d on" verdict time

(* What became of a claim, whose letters have been judged if it has any. *)
let answer run until verdict decided =
  if decided <> until then refuse "the run was not looked at up to the time of its verdict";
  if verdict = "not_started" then
    if run.before = None then "not_started, as claimed" else refuse "it has letters, so it has started"
  else begin
    if run.before = None then refuse "it has no letters";
    judge_before run until;
    let verdict_shown, since = shown run in
    let found = in_words verdict_shown in
    let time = match verdict_shown with Violated | Satisfied -> since | _ -> until in
    if (found, time) <> (verdict, decided) then
      refuse (Printf.sprintf "the verdict is %s, not %s" (from found time) (from verdict decided));
    from found time ^ ", as claimed"
  end

(* The letters of a claim, or of a slice, to their end, even if they are refused before: what is claimed of them, and what was
   found or why it is refused. *)
let judge_letters s claim entries =
  let refused = ref None in
  let guarded f x = if !refused = None then try Some (f x) with Refused why -> refused := Some why; None else None in
  let run = guarded (start claim) entries in
  let any = ref false in
  let each time text =
    any := true;
    match run with
    | Some run when !refused = None ->
        let letter = run.letter_of text in
        ignore (guarded (fun () -> judge_before run time; run.before <- Some (letter, time)) ())
    | _ -> ignore (numbers_of claim text) in
  let letters = read_letters s each in
  let (until, verdict, decided) as stated = read_end s in
  let found = match letters, run with
    | `Summed, _ -> refused := Some "its letters are given as a sum: `recorded --fill` writes them"; None
    | `Lines, Some run -> guarded (fun run -> answer run until verdict decided) run
    | `Lines, None -> None in
  stated, (match found, !refused with
    | Some said, _ -> Ok said
    | None, why -> Error (Option.value why ~default:"")), !any || letters = `Summed

(* The slices of a claim, and that it has the verdict of the worst; none is satisfied for good, since another id may come. *)
let judge_slices s claim entries =
  let rec slices () =
    match optional s "slice " with
    | None -> []
    | Some id -> let stated, found, _ = judge_letters s claim entries in (id, stated, found) :: slices () in
  let all = slices () in
  let (until, verdict, decided), _, has_letters = judge_letters s claim entries in
  let ids = Stdlib.List.map (fun (id, _, _) -> id) all in
  let times v = Stdlib.List.filter_map (fun (_, (_, verdict, decided), _) -> if verdict = v then Some decided else None) all in
  let has v = times v <> [] in
  let worst =
    if has "violated" then "violated"
    else if has "presumably_violated" then "presumably_violated"
    else if has "satisfied" || has "presumably_satisfied" then "presumably_satisfied"
    else "not_started" in
  let time = match times "violated" with [] -> until | first :: others -> Stdlib.List.fold_left min first others in
  let refused = Stdlib.List.find_map (fun (id, _, found) ->
    match found with Ok _ -> None | Error why -> Some (Printf.sprintf "slice %s: %s" id why)) all in
  match refused with
  | Some why -> Error why
  | None when has_letters -> Error "it has letters that belong to no id"
  | None when Stdlib.List.length (Stdlib.List.sort_uniq compare ids) < Stdlib.List.length ids -> Error "an id is there twice"
  | None when (worst, time, time) <> (verdict, decided, until) ->
      Error (Printf.sprintf "the verdict is %s, not %s" (from worst time) (from verdict decided))
  | None -> Ok (from worst time ^ ", as claimed")

(* A claim to its end. *)
let judge_claim s entries =
  let claim = read_claim s in
  let found =
    if claim.is_sliced then judge_slices s claim entries
    else let _, found, _ = judge_letters s claim entries in found in
  match found with
  | Ok said -> Printf.printf "%s: %s\n%!" claim.label said; true
  | Error why -> Printf.printf "%s: REFUSED: %s\n%!" claim.label why; false

(* One document: whether all that it claims is right. *)
let judge_document s entries digest =
  let named, files = read_head s in
  Printf.printf "evidence of %s\n" (String.concat ", " files);
  if named <> digest then Printf.printf "REFUSED: the certificates are not those that the evidence names\n";
  let rec claims right =
    if s.next <> Some "" then right
    else begin
      ignore (take s);
      if next_is s "not-covered " then (Printf.printf "%s\n" (take s); claims right)
      else (let is_right = judge_claim s entries in claims (is_right && right))
    end in
  let right = claims (named = digest) in
  read_last s;
  right

let judge_file certificates evidence =
  let text = read_file certificates in
  let entries, _ = Certificate_text.parse text in
  let labels = Stdlib.List.map (fun (e : Certificate_text.entry) -> e.label) entries in
  if Stdlib.List.length (Stdlib.List.sort_uniq compare labels) < Stdlib.List.length labels then
    raise (Sys_error (certificates ^ ": two certificates have the same label"));
  let channel = open_in_bin evidence in
  let s = source channel in
  let digest = Sha256.of_text text in
  let rec documents right =
    let right = judge_document s entries digest && right in
    if s.next <> None then documents right
    else if has_end channel then right
    else Words.fail "the last line has no end" in
  documents true

let () =
  exit (match Sys.argv with
    | [| _; certificates; evidence |] ->
        (match judge_file certificates evidence with
         | right -> if right then 0 else 1
         | exception Words.Unreadable (line, message) -> Printf.printf "line %d: %s\n" line message; 2
         | exception Sys_error message -> prerr_endline message; 2)
    | _ -> prerr_endline "usage: judge CERTIFICATES EVIDENCE"; 2)
