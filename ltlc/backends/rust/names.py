"""Names of emitted Rust that those of a specification must not hide."""

from __future__ import annotations

from ltlc.backends.rust.functions import FUNCTIONS

_KEYWORDS = """
Self abstract as async await become box break const continue crate do dyn else enum extern false final fn for if impl in
let loop macro match mod move mut override priv pub ref return self static struct super trait true try type typeof union
unsafe unsized use virtual where while yield
"""
_TAKEN = """
bool char str f32 f64 i8 i16 i32 i64 i128 isize u8 u16 u32 u64 u128 usize core std Some None Ok Err Option
time samples signals state is_first next end is_over has_session outcome due new step begin advance next_deadline
History Judgement Monitors N Number P Property Samples Signals T Times Verdict NEVER
"""

RESERVED = frozenset(f"{_KEYWORDS} {_TAKEN}".split()) | frozenset(FUNCTIONS)
