"""The functions that emitted Rust may call, as they are written into a file, word for word."""

from __future__ import annotations

from ltlc.backends.library import called_in, needed

NUMBER = """\
/// What is made a double by rounding.
trait Number: Copy {
    fn rounded(self) -> f64;
}

macro_rules! number {
    ($($type:ty),*) => {
        $(impl Number for $type {
            fn rounded(self) -> f64 {
                self as f64
            }
        })*
    };
}

number!(f32, f64, i8, i16, i32, i64, u8, u16, u32, u64, usize);
"""

# Some functions come in pairs, which differ in these words.

_EXTREME = """\
/// The {what} of two numbers; NaN if one of them is.
fn {name}(left: f64, right: f64) -> f64 {{
    if right {order} left || right.is_nan() {{
        right
    }} else {{
        left
    }}
}}
"""

_EXTREME_ELEMENT = """\
/// The {name} number; NaN, which is no measurement, if there is none.
fn {name}<T: Number>(array: &[T]) -> f64 {{
    let mut found = f64::NAN;
    for each in array {{
        if double(*each) {order} found || found.is_nan() {{
            found = double(*each);
        }}
    }}
    found
}}
"""

_ORDER = """\
/// Below 0 if `left` is less than `right`, above 0 if it is greater, exactly; NaN if `right` is.
fn {name}(left: {type}, right: f64) -> f64 {{
    if right.is_nan() {{
        return right;
    }}
    if right >= {high} {{
        return -1.0;
    }}
    if right < {low} {{
        return 1.0;
    }}
    let whole = right as {type};
    if left != whole {{
        return if left < whole {{ -1.0 }} else {{ 1.0 }};
    }}
    whole as f64 - right
}}
"""

FUNCTIONS = {
    "double": f"""\
{NUMBER}
/// The nearest double.
fn double<T: Number>(number: T) -> f64 {{
    number.rounded()
}}
""",
    "absolute": """\
/// The number without its sign.
fn absolute(number: f64) -> f64 {
    f64::from_bits(number.to_bits() & !(1 << 63))
}
""",
    "absolute_single": """\
/// The number without its sign.
fn absolute_single(number: f32) -> f32 {
    f32::from_bits(number.to_bits() & !(1 << 31))
}
""",
    "least": _EXTREME.format(name="least", what="smaller", order="<"),
    "greatest": _EXTREME.format(name="greatest", what="larger", order=">"),
    "gap": """\
/// The difference of two numbers, 0 of equal infinities; NaN if one of them is.
fn gap(left: f64, right: f64) -> f64 {
    if left == right {
        0.0
    } else {
        left - right
    }
}
""",
    "rounded_down": """\
/// The largest integer that is not greater, never -0.0.
fn rounded_down(number: f64) -> f64 {
    if number.is_nan() || absolute(number) >= 4503599627370496.0 {
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
    "rounded_up": """\
/// The smallest integer that is not less, never -0.0.
fn rounded_up(number: f64) -> f64 {
    0.0 - rounded_down(-number)
}
""",
    "sign_of": """\
/// 1 if positive, -1 if negative, 0.0 if zero; NaN if the number is.
fn sign_of(number: f64) -> f64 {
    if number > 0.0 {
        1.0
    } else if number < 0.0 {
        -1.0
    } else {
        number + 0.0
    }
}
""",
    "modulo": """\
/// The remainder of a division, with the sign of the divisor, never -0.0; NaN by 0 and of infinity.
fn modulo(dividend: f64, divisor: f64) -> f64 {
    let rest = dividend % divisor;
    if (rest < 0.0 && divisor > 0.0) || (rest > 0.0 && divisor < 0.0) {
        rest + divisor
    } else {
        rest + 0.0
    }
}
""",
    "angle_between": """\
/// The angle, 0 to pi, between two directions; NaN if they are infinitely far apart.
fn angle_between(left: f64, right: f64) -> f64 {
    let turn = absolute(left - right) % 6.283185307179586;
    if turn > 3.141592653589793 {
        6.283185307179586 - turn
    } else {
        turn
    }
}
""",
    "inside": """\
/// 1 if the point, which stands before the corners of a polygon, lies in it or on its border, exactly; else 0.
fn inside<const N: usize>(points: [f64; N]) -> f64 {
    let (x, y) = (points[0], points[1]);
    if !(x - x == 0.0 && y - y == 0.0) {
        return if x.is_nan() || y.is_nan() { f64::NAN } else { 0.0 };
    }
    let mut is_inside = false;
    let (mut ax, mut ay) = (points[N - 2], points[N - 1]);
    for corner in points[2..].chunks(2) {
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
    let bound = 4e-16 * (absolute(left) + absolute(right));
    if bound > 1e-280 && absolute(left - right) > bound {
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
    let ((one, first), (other, second)) = (mantissa(left), mantissa(right));
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
    "mantissa": """\
/// A finite number without its sign: an integer, and how many powers of 2 above 2^-1074 that counts.
fn mantissa(number: f64) -> (u64, usize) {
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
    "slope": """\
/// Change per second; NaN if no time has passed.
fn slope(change: f64, duration: i64) -> f64 {
    if duration == 0 {
        f64::NAN
    } else {
        change / (duration as f64 / 1e9)
    }
}
""",
    "order_signed": _ORDER.format(
        name="order_signed", type="i64", low="-9223372036854775808.0", high="9223372036854775808.0"
    ),
    "order_unsigned": _ORDER.format(name="order_unsigned", type="u64", low="0.0", high="18446744073709551616.0"),
    "order_integers": """\
/// Below 0 if `left` is less than `right`, above 0 if it is greater.
fn order_integers(left: i64, right: u64) -> f64 {
    if left < 0 || (left as u64) < right {
        return -1.0;
    }
    if left as u64 > right {
        1.0
    } else {
        0.0
    }
}
""",
    "slice": """\
/// The elements from `start` up to, not including, `stop`; below 0 these count from the end.
fn slice<T>(array: &[T], start: i64, stop: i64) -> &[T] {
    let length = array.len() as i64;
    let within = |end: i64| (if end < 0 { end + length } else { end }).clamp(0, length) as usize;
    let (first, last) = (within(start), within(stop));
    &array[first..last.max(first)]
}
""",
    "length": """\
/// How many elements there are.
fn length<T>(array: &[T]) -> f64 {
    double(array.len())
}
""",
    "complete": """\
/// How many numbers there are; NaN if one of them is.
fn complete<T: Number>(array: &[T]) -> f64 {
    for each in array {
        if double(*each).is_nan() {
            return f64::NAN;
        }
    }
    double(array.len())
}
""",
    "smallest": _EXTREME_ELEMENT.format(name="smallest", order="<"),
    "largest": _EXTREME_ELEMENT.format(name="largest", order=">"),
    "nearest": """\
/// The first of the numbers that differ least from another; NaN if there is none, or if that is NaN.
fn nearest<T: Number>(sought: f64, array: &[T]) -> f64 {
    let (mut found, mut least_apart) = (f64::NAN, f64::NAN);
    for each in array {
        let apart = absolute(gap(double(*each), sought));
        if apart < least_apart || (least_apart.is_nan() && !apart.is_nan()) {
            found = double(*each);
            least_apart = apart;
        }
    }
    found
}
""",
    "of_rank": """\
/// The double at a place in the order of doubles: -infinity is at 2^52 - 1, infinity at 2^64 - 2^52.
fn of_rank(rank: u64) -> f64 {
    let sign = 1 << 63;
    f64::from_bits(if rank < sign { !rank } else { rank - sign })
}
""",
    "ranked": """\
/// The number that `below` others come before; it is bisected, so that nothing has to be sorted.
fn ranked<T: Number>(array: &[T], below: usize) -> f64 {
    let (mut low, mut high) = (0x000f_ffff_ffff_ffff, 0xfff0_0000_0000_0000);
    while low < high {
        let middle = low + (high - low) / 2;
        if array.iter().filter(|each| double(**each) <= of_rank(middle)).count() > below {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    of_rank(low)
}
""",
    "median": """\
/// The middle number, or the mean of the middle two; NaN, which is no measurement, if there is none.
fn median<T: Number>(array: &[T]) -> f64 {
    let count = array.iter().filter(|each| !double(**each).is_nan()).count();
    if count == 0 {
        return f64::NAN;
    }
    let (low, high) = (ranked(array, (count - 1) / 2), ranked(array, count / 2));
    let sum = low + high;
    if sum - sum == 0.0 {
        sum / 2.0 + 0.0
    } else {
        low / 2.0 + high / 2.0
    }
}
""",
}


def texts(code: str) -> list[str]:
    """The definitions of the functions that `code` calls, and of those that they call."""
    return needed(FUNCTIONS, code, called_in)
