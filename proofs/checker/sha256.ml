(* SHA-256 (FIPS 180-4), as a sum that takes one text after another. Words are in the lower 32 bits of integers. *)

let constants =
  [| 0x428a2f98; 0x71374491; 0xb5c0fbcf; 0xe9b5dba5; 0x3956c25b; 0x59f111f1; 0x923f82a4; 0xab1c5ed5; 0xd807aa98; 0x12835b01;
     0x243185be; 0x550c7dc3; 0x72be5d74; 0x80deb1fe; 0x9bdc06a7; 0xc19bf174; 0xe49b69c1; 0xefbe4786; 0x0fc19dc6; 0x240ca1cc;
     0x2de92c6f; 0x4a7484aa; 0x5cb0a9dc; 0x76f988da; 0x983e5152; 0xa831c66d; 0xb00327c8; 0xbf597fc7; 0xc6e00bf3; 0xd5a79147;
     0x06ca6351; 0x14292967; 0x27b70a85; 0x2e1b2138; 0x4d2c6dfc; 0x53380d13; 0x650a7354; 0x766a0abb; 0x81c2c92e; 0x92722c85;
     0xa2bfe8a1; 0xa81a664b; 0xc24b8b70; 0xc76c51a3; 0xd192e819; 0xd6990624; 0xf40e3585; 0x106aa070; 0x19a4c116; 0x1e376c08;
     0x2748774c; 0x34b0bcb5; 0x391c0cb3; 0x4ed8aa4a; 0x5b9cca4f; 0x682e6ff3; 0x748f82ee; 0x78a5636f; 0x84c87814; 0x8cc70208;
     0x90befffa; 0xa4506ceb; 0xbef9a3f7; 0xc67178f2 |]

type t = { state : int array; block : Bytes.t; mutable filled : int; mutable length : int; words : int array }

let start () =
  { state = [| 0x6a09e667; 0xbb67ae85; 0x3c6ef372; 0xa54ff53a; 0x510e527f; 0x9b05688c; 0x1f83d9ab; 0x5be0cd19 |];
    block = Bytes.create 64; filled = 0; length = 0; words = Array.make 64 0 }

let low x = x land 0xffffffff
let turn x n = (x lsr n) lor low (x lsl (32 - n))

let take_block sum =
  let w = sum.words in
  for i = 0 to 15 do w.(i) <- low (Int32.to_int (Bytes.get_int32_be sum.block (4 * i))) done;
  for i = 16 to 63 do
    let x = w.(i - 15) and y = w.(i - 2) in
    let s0 = turn x 7 lxor turn x 18 lxor (x lsr 3) and s1 = turn y 17 lxor turn y 19 lxor (y lsr 10) in
    w.(i) <- low (w.(i - 16) + s0 + w.(i - 7) + s1)
  done;
  let s = Array.copy sum.state in
  for i = 0 to 63 do
    let e = s.(4) and a = s.(0) in
    let choice = (e land s.(5)) lxor (low (lnot e) land s.(6)) in
    let t1 = s.(7) + (turn e 6 lxor turn e 11 lxor turn e 25) + choice + constants.(i) + w.(i) in
    let majority = (a land s.(1)) lxor (a land s.(2)) lxor (s.(1) land s.(2)) in
    let t2 = (turn a 2 lxor turn a 13 lxor turn a 22) + majority in
    s.(7) <- s.(6); s.(6) <- s.(5); s.(5) <- e; s.(4) <- low (s.(3) + t1);
    s.(3) <- s.(2); s.(2) <- s.(1); s.(1) <- a; s.(0) <- low (t1 + t2)
  done;
  Array.iteri (fun i x -> sum.state.(i) <- low (sum.state.(i) + x)) s

let add sum text =
  let n = String.length text in
  let rec from at =
    if at < n then begin
      let some = min (64 - sum.filled) (n - at) in
      Bytes.blit_string text at sum.block sum.filled some;
      sum.filled <- sum.filled + some;
      if sum.filled = 64 then (take_block sum; sum.filled <- 0);
      from (at + some)
    end in
  sum.length <- sum.length + n;
  from 0

(* The digest in hexadecimal; the sum is of no use after it. *)
let digest sum =
  let bits = 8 * sum.length and zeros = (119 - sum.filled) mod 64 in
  let tail = Bytes.make (zeros + 9) '\000' in
  Bytes.set tail 0 '\x80';
  Bytes.set_int64_be tail (zeros + 1) (Int64.of_int bits);
  add sum (Bytes.to_string tail);
  String.concat "" (Array.to_list (Array.map (Printf.sprintf "%08x") sum.state))

let of_text text = let sum = start () in add sum text; digest sum
