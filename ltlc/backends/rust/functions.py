"""The functions of emitted Rust that are not printed from C, word for word; C calls its own by the same names."""

from __future__ import annotations

from ltlc.backends.library import called_in, needed
from ltlc.backends.rust.types import ARRAYS, scalar_text

ONLY_IN_C = frozenset({"same_text", "add_bits", "carry"})
"""What Rust has no need of: strings are compared by an operator, and `add_product` calls no other function."""

FUNCTIONS = {
    "fabs": """\
/// The number without its sign.
fn fabs(number: f64) -> f64 {
    f64::from_bits(number.to_bits() & !(1 << 63))
}
""",
    "fabsf": """\
/// The number without its sign.
fn fabsf(number: f32) -> f32 {
    f32::from_bits(number.to_bits() & !(1 << 31))
}
""",
    "fmod": """\
/// What is left of a division, with the sign of the dividend.
fn fmod(dividend: f64, divisor: f64) -> f64 {
    dividend % divisor
}
""",
    "floor": """\
/// The largest integer that is not greater.
fn floor(number: f64) -> f64 {
    if number.is_nan() || fabs(number) >= 4503599627370496.0 {
        return number;
    }
    let whole = number as i64 as f64;
    if whole > number {
        whole - 1.0
    } else {
        whole
    }
}
""",
    "ceil": """\
/// The smallest integer that is not less.
fn ceil(number: f64) -> f64 {
    -floor(-number)
}
""",
    "occurred": """\
/// Something occurs at `time`, noted in the place of the first of `most` times; whether there are as many.
fn occurred(times: &mut [i64], count: &mut u32, most: u32, time: i64) -> bool {
    times[(*count % most) as usize] = time;
    *count = if *count + 1 < 2 * most { *count + 1 } else { most };
    *count >= most
}
""",
    "inside": """\
/// 1 if the point, which stands before the corners of a polygon, lies in it or on its border, exactly; else 0.
fn inside(points: &[f64], count: usize) -> f64 {
    let (x, y) = (points[0], points[1]);
    if !(x - x == 0.0 && y - y == 0.0) {
        return if x.is_nan() || y.is_nan() { f64::NAN } else { 0.0 };
    }
    let mut is_inside = false;
    let (mut ax, mut ay) = (points[count - 2], points[count - 1]);
    for corner in points[2..count].chunks(2) {
        let (bx, by) = (corner[0], corner[1]);
        if (ay <= y && y <= by) || (by <= y && y <= ay) {
            let turned = turn([ax, ay], [bx, by], [x, y]);
            if turned == 0.0 && ((ax <= x && x <= bx) || (bx <= x && x <= ax)) {
                return 1.0;
            }
            if (ay <= y) != (by <= y) && (turned > 0.0) == (by > ay) {
                is_inside = !is_inside;
            }
        }
        ax = bx;
        ay = by;
    }
    if is_inside {
        1.0
    } else {
        0.0
    }
}
""",
    "turn": """\
/// Above 0 if the point is to the left of the way from one to other, below 0 to the right, 0 on the line, exactly.
fn turn(one: [f64; 2], other: [f64; 2], point: [f64; 2]) -> f64 {
    let left = (one[0] - point[0]) * (other[1] - point[1]);
    let right = (one[1] - point[1]) * (other[0] - point[0]);
    let bound = 4e-16 * (fabs(left) + fabs(right));
    if bound > 1e-280 && fabs(left - right) > bound {
        return left - right;
    }
    let mut digits = [0i64; 135];
    add_product(&mut digits, one[0], other[1]);
    add_product(&mut digits, -one[1], other[0]);
    add_product(&mut digits, other[0], point[1]);
    add_product(&mut digits, -other[1], point[0]);
    add_product(&mut digits, point[0], one[1]);
    add_product(&mut digits, -point[1], one[0]);
    let mut is_zero = true;
    for i in 0..134 {
        let over = digits[i] >> 32;
        digits[i] -= over << 32;
        digits[i + 1] += over;
        is_zero = is_zero && digits[i] == 0;
    }
    if digits[134] < 0 {
        -1.0
    } else if is_zero && digits[134] == 0 {
        0.0
    } else {
        1.0
    }
}
""",
    "add_product": """\
/// Add the product of two finite numbers to `digits`, of 32 bits each, the first of which counts 2^-2148.
fn add_product(digits: &mut [i64; 135], left: f64, right: f64) {
    let ((one, first), (other, second)) = (mantissa_of(left), mantissa_of(right));
    let place = first + second;
    let product = u128::from(one) * u128::from(other);
    for (number, half) in [product as u64, (product >> 64) as u64].iter().enumerate() {
        let bits = u128::from(*half) << (place % 32);
        for part in 0..3 {
            let digit = (bits >> (32 * part)) as u32 as i64;
            let at = place / 32 + 2 * number + part;
            digits[at] += if (left < 0.0) == (right < 0.0) { digit } else { -digit };
        }
    }
}
""",
    "mantissa_of": """\
/// A finite number without its sign: an integer, and how many powers of 2 above 2^-1074 that counts.
fn mantissa_of(number: f64) -> (u64, usize) {
    let bits = number.to_bits();
    let exponent = (bits >> 52 & 2047) as usize;
    let fraction = bits & 0x000f_ffff_ffff_ffff;
    if exponent > 0 {
        (fraction | 1 << 52, exponent - 1)
    } else {
        (fraction, 0)
    }
}
""",
    "of_rank": """\
/// The double at a place in the order of doubles: -infinity is at 2^52 - 1, infinity at 2^64 - 2^52.
fn of_rank(rank: u64) -> f64 {
    let sign = 1 << 63;
    f64::from_bits(if rank < sign { !rank } else { rank - sign })
}
""",
}

_OF_ARRAYS = {
    "recent": """\
/// The last `count` samples, oldest first: each of the last `depth` stands in two places, `depth` apart.
fn recent_{plural}<'a>(samples: &'a [{element}], latest: u32, depth: u32, count: u32) -> &'a [{element}] {{
    let end = latest + depth + 1;
    &samples[(end - count) as usize..end as usize]
}}
""",
    "slice": """\
/// The elements from `start` up to, not including, `stop`; below 0 these count from the end.
fn slice_{plural}<'a>(array: &'a [{element}], start: i64, stop: i64) -> &'a [{element}] {{
    let length = array.len() as i64;
    let within = |end: i64| (if end < 0 {{ end + length }} else {{ end }}).clamp(0, length) as usize;
    let (first, last) = (within(start), within(stop));
    &array[first..last.max(first)]
}}
""",
}

FUNCTIONS |= {
    f"{name}_{plural}": text.format(plural=plural, element=scalar_text(scalar, "'a "))
    for plural, scalar in ARRAYS.items()
    for name, text in _OF_ARRAYS.items()
}


def texts(code: str) -> list[str]:
    """The definitions of the functions that `code` calls, and of those that they call."""
    return needed(FUNCTIONS, code, called_in)
