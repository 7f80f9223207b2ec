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

(* For each atom of the evidence its number in the certificate; -1 if the monitor does not depend on it. What the certificate
   does not define has to be there, and nothing that it defines. *)
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
  let found = Array.map place claim.names in
  Hashtbl.iter (fun name a -> if not (is_defined a) then refuse (Printf.sprintf "'%s' is missing" name)) number;
  found

(* A claim that is being judged: the line before is kept until the time of the next is known. *)
type run = {
  judging : judging; letter_of : string -> letter; mutable standing : standing; mutable before : (letter * int) option;
}

let start claim entries =
  let entry = match Stdlib.List.find_opt (fun (e : Certificate_text.entry) -> e.label = claim.label) entries with
    | Some entry -> entry
    | None -> refuse "it has no certificate" in
  if not (is_certified entry) then refuse "its monitor is not certified";
  let judging = match prepare entry.certificate claim.session with
    | Some judging -> judging
    | None -> refuse "its encoding is not that of the language" in
  let place = places claim entry judging and size = Stdlib.List.length entry.atoms in
  let known = Hashtbl.create 64 in
  let letter_of text =
    match Hashtbl.find_opt known text with
    | Some letter -> letter
    | None ->
        let holds = Array.make size false in
        Stdlib.List.iter (fun n -> if place.(n) >= 0 then holds.(place.(n)) <- true) (numbers_of claim text);
        let letter a = a < size && Array.unsafe_get holds a in
        if Hashtbl.length known = 10_000 then Hashtbl.reset known;
        Hashtbl.replace known text letter;
        letter in
  { judging; letter_of; standing = at_first; before = None }

(* Why a part is not judged. *)
let reason judging standing x =
  let c = judging.certificate_of in
  match next_part judging.session c.defined judging.clocks_of (not standing.has_read) standing.remembers x with
  | None -> "what 'previously' asks depends on steps that have no line"
  | Some (l, _) when not (at_letter c.assumption l) -> "the certificate assumes that there is no such letter"
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

(* The line before, now that it is known to be held up to v. *)
let judge_before run v =
  match run.before with
  | None -> ()
  | Some (letter, u) ->
      if u > latest || v > latest then refuse "times after the year 2084 are not judged";
      if v < u then refuse "times go back";
      let judged cuts = judge_line run.judging run.standing letter u v cuts in
      let with_cuts () =
        let x = { lets = letter; from = u; upto = u; single = true } in
        match judge_part run.judging run.standing x with
        | None -> refuse (reason run.judging run.standing x)
        | Some standing -> judged (cuts_of run.judging standing (quiet run.judging.certificate_of.news letter) (u + 1) v) in
      match judged [] with
      | Some standing -> run.standing <- standing
      | None -> (match with_cuts () with Some standing -> run.standing <- standing | None -> refuse "it is not judged")

let from verdict time = Printf.sprintf "%s from %d on" verdict time

(* What became of a claim, whose letters have been judged if it has any. *)
let answer run until verdict decided =
  if decided <> until then refuse "the run was not looked at up to the time of its verdict";
  if verdict = "not_started" then
    if run.before = None then "not_started, as claimed" else refuse "it has letters, so it has started"
  else begin
    if run.before = None then refuse "it has no letters";
    judge_before run until;
    let found = in_words run.standing.verdict_shown in
    let time = match run.standing.verdict_shown with Violated | Satisfied -> run.standing.since | _ -> until in
    if (found, time) <> (verdict, decided) then
      refuse (Printf.sprintf "the verdict is %s, not %s" (from found time) (from verdict decided));
    from found time ^ ", as claimed"
  end

(* A claim to its end, even if it is refused before. *)
let judge_claim s entries =
  let claim = read_claim s in
  let refused = ref None in
  let guarded f x = if !refused = None then try Some (f x) with Refused why -> refused := Some why; None else None in
  let run = guarded (start claim) entries in
  let each time text =
    match run with
    | Some run when !refused = None ->
        let letter = run.letter_of text in
        ignore (guarded (fun () -> judge_before run time; run.before <- Some (letter, time)) ())
    | _ -> ignore (numbers_of claim text) in
  let letters = read_letters s each in
  let until, verdict, decided = read_end s in
  let found = match letters, run with
    | `Summed, _ -> refused := Some "its letters are given as a sum: `recorded --fill` writes them"; None
    | `Lines, Some run -> guarded (fun run -> answer run until verdict decided) run
    | `Lines, None -> None in
  match found, !refused with
  | Some said, _ -> Printf.printf "%s: %s\n%!" claim.label said; true
  | None, why -> Printf.printf "%s: REFUSED: %s\n%!" claim.label (Option.value why ~default:""); false

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
  let entries = Certificate_text.parse text in
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
