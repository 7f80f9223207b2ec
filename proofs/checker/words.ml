(* The words of a certificate, and what is wrong with a line: as in ltlc/semantics/certificate_words.py. *)
open Kernel

exception Unreadable of int * string

let line_number = ref 0
let fail message = raise (Unreadable (!line_number, message))

(* A growing sequence. *)
type 'a sequence = { mutable length : int; items : (int, 'a) Hashtbl.t }

let sequence () = { length = 0; items = Hashtbl.create 16 }
let push s x = Hashtbl.replace s.items s.length x; s.length <- s.length + 1
let get s i = Hashtbl.find s.items i
let to_list s = Stdlib.List.init s.length (get s)

let has_digits most s =
  let n = String.length s in
  n >= 1 && n <= most && (n = 1 || s.[0] <> '0') && String.for_all (fun c -> c >= '0' && c <= '9') s
let is_number = has_digits 9

let number s = if is_number s then int_of_string s else fail "not a number"
let duration s = if has_digits 18 s then int_of_string s else fail "not a duration in nanoseconds"

let part s =
  if String.length s >= 2 && String.contains "atfpkqdcsbomngur" s.[0] && is_number (String.sub s 1 (String.length s - 1))
  then Some (s.[0], int_of_string (String.sub s 1 (String.length s - 1)))
  else None

let refer sort count s =
  match part s with
  | Some (c, n) when c = sort && n < count -> n
  | _ -> fail ("there is no such thing here: " ^ s)

let numbered count s = match part s with Some (_, n) when n = count -> () | _ -> fail "numbered out of order"

let verdict_of = function
  | "violated" -> Violated | "satisfied" -> Satisfied
  | "presumably_violated" -> PresumablyViolated | "presumably_satisfied" -> PresumablySatisfied
  | _ -> fail "no such verdict"

(* What is referred to and may come later has to come. *)
let exists count n = if n >= count then fail "there is no such thing"
