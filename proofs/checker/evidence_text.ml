(* Reads evidence, line by line: the lines of docs/evidence.md, in their order. A text is never held as a whole. *)
open Words

(* A text that is read: the next line, and the SHA-256 of those before it in the document. *)
type source = { channel : in_channel; mutable next : string option; mutable sum : Sha256.t }

let line_of channel = try Some (input_line channel) with End_of_file -> None

let source channel =
  line_number := 1;
  { channel; next = line_of channel; sum = Sha256.start () }

let take s =
  match s.next with
  | None -> fail "the text ends in the middle of a document"
  | Some line ->
      Sha256.add s.sum line;
      Sha256.add s.sum "\n";
      incr line_number;
      s.next <- line_of s.channel;
      line

(* What follows a word, and a blank, at the beginning of a line. *)
let after word line = String.sub line (String.length word) (String.length line - String.length word)
let next_is s word = match s.next with Some line -> String.starts_with ~prefix:word line | None -> false

let is_text name =
  let n = String.length name in
  n > 0 && name.[0] <> ' ' && name.[n - 1] <> ' ' && String.for_all (fun c -> c >= ' ' && c <> '\x7f') name
let text_of word line = let name = after word line in if is_text name then name else fail "a name is missing or odd"

let need s word = if next_is s word then text_of word (take s) else fail (Printf.sprintf "expected '%s'" (String.trim word))
let optional s word = if next_is s word then Some (need s word) else None
let rec all s word = match optional s word with Some name -> let rest = all s word in name :: rest | None -> []

let is_sha256 hex =
  String.length hex = 64 && String.for_all (fun c -> (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f')) hex

(* Of '… sha256 HEX', what is before it and the digest. *)
let with_sha256 text =
  let n = String.length text - 64 - String.length " sha256 " in
  if n < 0 || String.sub text n 8 <> " sha256 " || not (is_sha256 (after (String.sub text 0 (n + 8)) text)) then
    fail "expected 'sha256' and a digest";
  String.sub text 0 n, String.sub text (n + 8) 64

(* The last time that is judged, in the year 2084: with any duration added, it is an integer of the machine. What is later
   is [too_late]. *)
let latest = 3_600_000_000_000_000_000
let too_late = latest + 1
let time text =
  if not (has_digits 19 text) then fail "not a time in nanoseconds";
  match int_of_string_opt text with Some t when t <= latest -> t | _ -> too_late
let later t gap = if t > latest || gap > latest - t then too_late else t + gap

let verdicts = [ "violated"; "satisfied"; "presumably_violated"; "presumably_satisfied"; "not_started" ]

(* One property: what is read before its letters. Of each count, its name and what is said of it; the numbers of scopes, for
   each of which letters have an atom behind the others; the atom that opens instances, if there are any; and whether it is
   about each id. *)
type claim = {
  label : string; names : string array; counts : (string * string) list; scopes : int list; opens : int option;
  is_sliced : bool; session : int;
}

let read_claim s =
  let label = need s "property " in
  ignore (need s "text ");
  ignore (optional s "requirement ");
  ignore (all s "verifies ");
  let rec atoms found =
    match optional s "atom " with
    | None -> Array.of_list (Stdlib.List.rev found)
    | Some name -> ignore (need s "is {"); atoms (name :: found) in
  let names = atoms [] in
  let rec counts () =
    match optional s "count " with
    | None -> []
    | Some name -> let said = need s "of " in (name, said) :: counts () in
  let counts = counts () in
  let number text = match String.split_on_char ' ' text with
    | n :: _ when is_number n -> int_of_string n
    | _ -> fail "a scope has a number" in
  let scopes = Stdlib.List.map number (all s "scope ") in
  let opens = match optional s "instances " with
    | None -> None
    | Some text ->
        match part text with
        | Some ('a', n) when n < Array.length names -> Some n
        | _ -> fail "there is no such atom" in
  let is_sliced = optional s "key " <> None in
  { label; names; counts; scopes; opens; is_sliced; session = time (need s "session ") }

(* What is in the place of letters: each line goes to [each], with its time and the numbers of its atoms as a text. *)
let read_letters s each =
  if next_is s "letters " then begin
    ignore (with_sha256 (need s "letters "));
    `Summed
  end else begin
    let entry word =
      let text = need s word in
      match String.index_opt text ' ' with
      | Some i -> time (String.sub text 0 i), after (String.sub text 0 (i + 1)) text
      | None -> time text, "" in
    if next_is s "at " then begin
      let first, letter = entry "at " in
      each first letter;
      let rec go now = if next_is s "+" then (let gap, letter = entry "+" in let t = later now gap in each t letter; go t) in
      go first
    end;
    `Lines
  end

(* The atoms of a letter: of 'a0 a2' the numbers, ascending. *)
let numbers_of claim letter =
  let number word =
    if String.length word > 1 && word.[0] = 'a' then number (after "a" word) else fail "not an atom" in
  let numbers = if letter = "" then [] else Stdlib.List.map number (String.split_on_char ' ' letter) in
  if Stdlib.List.sort_uniq compare numbers <> numbers then fail "the atoms of a letter are not in order";
  if Stdlib.List.exists (fun n -> n >= Array.length claim.names + Stdlib.List.length claim.scopes) numbers then fail "there is no such atom";
  numbers

let read_end s =
  let until = time (need s "until ") in
  match String.split_on_char ' ' (need s "verdict ") with
  | [ verdict; decided ] when Stdlib.List.mem verdict verdicts -> until, verdict, time decided
  | _ -> fail "not a verdict and its time"

(* The head of a document: the digest of the certificates that it names, and the names of the files of the recording. *)
let read_head s =
  if s.next <> Some "ltlc-evidence 2" then fail "this is no evidence";
  s.sum <- Sha256.start ();
  ignore (take s);
  ignore (need s "ltlc ");
  ignore (with_sha256 (need s "specification "));
  let digest = after "sha256 " (need s "certificates ") in
  if not (is_sha256 digest) then fail "not a digest";
  let file text =
    let name_and_size, _ = with_sha256 text in
    match String.rindex_opt name_and_size ' ' with
    | Some i -> String.sub name_and_size 0 i
    | None -> fail "a file has a name and a size" in
  let first = file (need s "recording ") in
  let files = first :: Stdlib.List.map file (all s "recording ") in
  ignore (Stdlib.List.map with_sha256 (all s "definition "));
  ignore (all s "signal ");
  ignore (optional s "rate ");
  ignore (optional s "timeout ");
  if s.next = Some "stamp header" then ignore (take s);
  ignore (optional s "from ");
  ignore (optional s "to ");
  digest, files

(* The last line of a document, which is the digest of all others. *)
let read_last s =
  let found = Sha256.digest s.sum in
  s.sum <- Sha256.start ();
  if not (next_is s ("end sha256 " ^ found)) then fail "the SHA-256 of the lines before is another: something was changed";
  ignore (need s "end sha256 ")

(* Whether a file ends where its last line does; of what cannot be looked at again that is not known. *)
let has_end channel =
  try
    seek_in channel (in_channel_length channel - 1);
    input_char channel = '\n'
  with Sys_error _ -> true
