"""The functions that emitted C may call, as they are written into a file, word for word."""

from __future__ import annotations

MATHEMATICS = frozenset(
    {*("sqrt", "fabs", "fabsf", "floor", "ceil", "fmod"), *("exp", "log", "sin", "cos", "tan", "asin", "acos", "atan2")}
)
"""What is called of the C library, and declared in `math.h`."""

# Some functions come in pairs, which differ in these words.

_EXTREME = """\
/* The {what} of two numbers; NaN if one of them is. */
static double {name}(double left, double right)
{{
    return right {order} left || right != right ? right : left;
}}
"""

_ORDER = """\
/* Below 0 if `left` is less than `right`, above 0 if it is greater, exactly; NaN if `right` is. */
static double {name}({type} left, double right)
{{
    if (right != right) {{
        return right;
    }}
    if (right >= {high}) {{
        return -1.0;
    }}
    if (right < {low}) {{
        return 1.0;
    }}
    const {type} whole = ({type})right;
    if (left != whole) {{
        return left < whole ? -1.0 : 1.0;
    }}
    return (double)whole - right;
}}
"""

FUNCTIONS = {
    "least": _EXTREME.format(name="least", what="smaller", order="<"),
    "greatest": _EXTREME.format(name="greatest", what="larger", order=">"),
    "same_text": """\
/* Whether two strings are the same. */
static bool same_text(const char *left, const char *right)
{
    while (*left != '\\0' && *left == *right) {
        left++;
        right++;
    }
    return *left == *right;
}
""",
    "past": """\
/* Where the sample from `ago` samples ago is, if the latest is at `latest`. */
static uint32_t past(uint32_t latest, uint32_t ago, uint32_t depth)
{
    return ago <= latest ? latest - ago : latest + depth - ago;
}
""",
    "occurred": """\
/* Something occurs at `time`, noted in the place of the first of `most` times; whether there are as many. */
static bool occurred(int64_t *times, uint32_t *count, uint32_t most, int64_t time)
{
    times[*count % most] = time;
    *count = *count + 1u < 2u * most ? *count + 1u : most;
    return *count >= most;
}
""",
    "slope": """\
/* Change per second; NaN if no time has passed. */
static double slope(double change, int64_t duration)
{
    return duration == 0 ? (double)NAN : change / ((double)duration / 1e9);
}
""",
    "order_signed": _ORDER.format(
        name="order_signed", type="int64_t", low="-9223372036854775808.0", high="9223372036854775808.0"
    ),
    "order_unsigned": _ORDER.format(name="order_unsigned", type="uint64_t", low="0.0", high="18446744073709551616.0"),
    "order_integers": """\
/* Below 0 if `left` is less than `right`, above 0 if it is greater. */
static double order_integers(int64_t left, uint64_t right)
{
    if (left < 0 || (uint64_t)left < right) {
        return -1.0;
    }
    return (uint64_t)left > right ? 1.0 : 0.0;
}
""",
    "gap": """\
/* The difference of two numbers, 0 of equal infinities; NaN if one of them is. */
static double gap(double left, double right)
{
    return left == right ? 0.0 : left - right;
}
""",
    "rounded_down": """\
/* The largest integer that is not greater, never -0.0. */
static double rounded_down(double number)
{
    return floor(number) + 0.0;
}
""",
    "rounded_up": """\
/* The smallest integer that is not less, never -0.0. */
static double rounded_up(double number)
{
    return ceil(number) + 0.0;
}
""",
    "sign_of": """\
/* 1 if positive, -1 if negative, 0.0 if zero; NaN if the number is. */
static double sign_of(double number)
{
    return number > 0.0 ? 1.0 : number < 0.0 ? -1.0 : number + 0.0;
}
""",
    "modulo": """\
/* The remainder of a division, with the sign of the divisor, never -0.0; NaN by 0 and of infinity. */
static double modulo(double dividend, double divisor)
{
    const double rest = fmod(dividend, divisor);
    return (rest < 0.0 && divisor > 0.0) || (rest > 0.0 && divisor < 0.0) ? rest + divisor : rest + 0.0;
}
""",
    "angle_between": """\
/* The angle, 0 to pi, between two directions; NaN if they are infinitely far apart. */
static double angle_between(double left, double right)
{
    const double turn = fmod(fabs(left - right), 6.283185307179586);
    return turn > 3.141592653589793 ? 6.283185307179586 - turn : turn;
}
""",
    "norm": """\
/* The Euclidean norm; NaN if a component is. Squares are summed in twice a double's precision. */
static double norm(const double *components, size_t count)
{
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) {
        largest = greatest(largest, fabs(components[i]));
    }
    if (!(largest > 0.0 && largest < (double)INFINITY)) {
        return largest;
    }
    int exponent;
    (void)frexp(largest, &exponent);
    double high = 0.0;
    double low = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double x = ldexp(components[i], -exponent);
        const double square = x * x;
        const double sum = high + square;
        low += square_error(x, square) + (high > square ? (high - sum) + square : (square - sum) + high);
        high = sum;
    }
    const double root = sqrt(high + low);
    const double square = root * root;
    const double rest = ((high - square) - square_error(root, square)) + low;
    return ldexp(root + rest / (2.0 * root), exponent);
}
""",
    "square_error": """\
/* What is left of x * x beyond the double `square`. */
static double square_error(double x, double square)
{
    const double shifted = 134217729.0 * x;
    const double high = shifted - (shifted - x);
    const double low = x - high;
    return ((high * high - square) + 2.0 * high * low) + low * low;
}
""",
    "unit": """\
/* The quaternion of length 1 in the same direction; NaN if there is none. */
static void unit(const double *orientation, double *result)
{
    double length = norm(orientation, 4);
    if (length == 0.0 || length == (double)INFINITY) {
        length = (double)NAN;
    }
    for (size_t i = 0; i < 4; i++) {
        result[i] = orientation[i] / length;
    }
}
""",
    "roll": """\
/* The rotation about x, -pi to pi, of an orientation (x, y, z, w) as yaw, pitch, then roll. */
static double roll(const double *orientation)
{
    double q[4];
    unit(orientation, q);
    return atan2(2.0 * (q[3] * q[0] + q[1] * q[2]), 1.0 - 2.0 * (q[0] * q[0] + q[1] * q[1]));
}
""",
    "pitch": """\
/* The rotation about y, -pi/2 to pi/2, of an orientation (x, y, z, w) as yaw, pitch, roll. */
static double pitch(const double *orientation)
{
    double q[4];
    unit(orientation, q);
    const double sine = 2.0 * (q[3] * q[1] - q[2] * q[0]);
    return asin(greatest(-1.0, least(1.0, sine)));
}
""",
    "yaw": """\
/* The rotation about z, -pi to pi, of an orientation (x, y, z, w) as yaw, pitch, then roll. */
static double yaw(const double *orientation)
{
    double q[4];
    unit(orientation, q);
    return atan2(2.0 * (q[3] * q[2] + q[0] * q[1]), 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]));
}
""",
    "angle": """\
/* The angle, 0 to pi, of the rotation between two orientations (x, y, z, w, x, y, z, w). */
static double angle(const double *orientations)
{
    double p[4];
    double q[4];
    double difference[4];
    double sum[4];
    unit(orientations, p);
    unit(orientations + 4, q);
    for (size_t i = 0; i < 4; i++) {
        difference[i] = p[i] - q[i];
        sum[i] = p[i] + q[i];
    }
    const double apart = norm(difference, 4);
    const double near = norm(sum, 4);
    return 4.0 * atan2(least(apart, near), greatest(apart, near));
}
""",
    "mantissa_of": """\
/* The integer that a finite number is 2^-1074 times, less the power of 2 that is added to `place`; without its sign. */
static uint64_t mantissa_of(double number, int *place)
{
    union {
        double number;
        uint64_t bits;
    } given;
    given.number = number;
    const int exponent = (int)((given.bits >> 52) & 2047u);
    const uint64_t fraction = given.bits & UINT64_C(0xfffffffffffff);
    *place += exponent > 0 ? exponent - 1 : 0;
    return exponent > 0 ? fraction | UINT64_C(0x10000000000000) : fraction;
}
""",
    "add_bits": """\
/* Add `bits`, shifted to the left by less than 32, to `digits`, or take them away. */
static void add_bits(int64_t *digits, uint64_t bits, int shift, int64_t sign)
{
    const uint64_t low = (bits & UINT64_C(0xffffffff)) << shift;
    const uint64_t high = (bits >> 32) << shift;
    digits[0] += sign * (int64_t)(low & UINT64_C(0xffffffff));
    digits[1] += sign * (int64_t)((low >> 32) + (high & UINT64_C(0xffffffff)));
    digits[2] += sign * (int64_t)(high >> 32);
}
""",
    "add_exactly": """\
/* Add a finite number to `digits`, of 32 bits each, the first of which counts 2^-1074. */
static void add_exactly(int64_t *digits, double number)
{
    int place = 0;
    const uint64_t mantissa = mantissa_of(number, &place);
    add_bits(digits + place / 32, mantissa, place % 32, number < 0.0 ? -1 : 1);
}
""",
    "carry": """\
/* Bring all digits but the last into 0 to 2^32 - 1. */
static void carry(int64_t *digits, int count)
{
    for (int i = 0; i < count - 1; i++) {
        int64_t over = digits[i] / INT64_C(4294967296);
        if (digits[i] - over * INT64_C(4294967296) < 0) {
            over--;
        }
        digits[i] -= over * INT64_C(4294967296);
        digits[i + 1] += over;
    }
}
""",
    "add_product": """\
/* Add the product of two finite numbers to `digits`, of 32 bits each, the first of which counts 2^-2148. */
static void add_product(int64_t *digits, double left, double right)
{
    int place = 0;
    const uint64_t one = mantissa_of(left, &place);
    const uint64_t other = mantissa_of(right, &place);
    const uint64_t low = UINT64_C(0xffffffff);
    const int64_t sign = (left < 0.0) == (right < 0.0) ? 1 : -1;
    int64_t *const digit = digits + place / 32;
    add_bits(digit, (one & low) * (other & low), place % 32, sign);
    add_bits(digit + 1, (one & low) * (other >> 32) + (one >> 32) * (other & low), place % 32, sign);
    add_bits(digit + 2, (one >> 32) * (other >> 32), place % 32, sign);
}
""",
    "turn": """\
/* Above 0 if the point is to the left of the way from one to other, below 0 to the right, 0 on the line, exactly. */
static double turn(const double *one, const double *other, const double *point)
{
    const double left = (one[0] - point[0]) * (other[1] - point[1]);
    const double right = (one[1] - point[1]) * (other[0] - point[0]);
    const double bound = 4e-16 * (fabs(left) + fabs(right));
    if (bound > 1e-280 && fabs(left - right) > bound) {
        return left - right;
    }
    int64_t digits[135] = {0};
    add_product(digits, one[0], other[1]);
    add_product(digits, -one[1], other[0]);
    add_product(digits, other[0], point[1]);
    add_product(digits, -other[1], point[0]);
    add_product(digits, point[0], one[1]);
    add_product(digits, -point[1], one[0]);
    carry(digits, 135);
    for (int i = 0; i < 134; i++) {
        if (digits[i] != 0) {
            return digits[134] < 0 ? -1.0 : 1.0;
        }
    }
    return (double)digits[134];
}
""",
    "inside": """\
/* 1 if the point, which stands before the corners of a polygon, lies in it or on its border, exactly; else 0. */
static double inside(const double *points, size_t count)
{
    const double x = points[0];
    const double y = points[1];
    if (x - x != 0.0 || y - y != 0.0) {
        return x != x || y != y ? (double)NAN : 0.0;
    }
    bool is_inside = false;
    const double *one = points + count - 2;
    for (const double *other = points + 2; other < points + count; one = other, other += 2) {
        if ((y < one[1] || y > other[1]) && (y < other[1] || y > one[1])) {
            continue;
        }
        const double turned = turn(one, other, points);
        if (turned == 0.0 && ((one[0] <= x && x <= other[0]) || (other[0] <= x && x <= one[0]))) {
            return 1.0;
        }
        if ((one[1] <= y) != (other[1] <= y) && (turned > 0.0) == (other[1] > one[1])) {
            is_inside = !is_inside;
        }
    }
    return is_inside ? 1.0 : 0.0;
}
""",
    "distance": """\
/* How far the point, which stands before the corners of a polygon, is from it, 0 inside; NaN if a coordinate is. */
static double distance(const double *points, size_t count)
{
    const double found = inside(points, count);
    if (found != 0.0) {
        return found == 1.0 ? 0.0 : found;
    }
    double nearest = (double)INFINITY;
    const double *one = points + count - 2;
    for (const double *other = points + 2; other < points + count; one = other, other += 2) {
        const double edge[2] = {other[0] - one[0], other[1] - one[1]};
        const double first[2] = {points[0] - one[0], points[1] - one[1]};
        const double second[2] = {points[0] - other[0], points[1] - other[1]};
        const double along = first[0] * edge[0] + first[1] * edge[1];
        const double apart = 0.0 < along && along < edge[0] * edge[0] + edge[1] * edge[1]
                                 ? fabs(edge[0] * first[1] - edge[1] * first[0]) / norm(edge, 2)
                                 : least(norm(first, 2), norm(second, 2));
        nearest = apart < nearest ? apart : nearest;
    }
    return nearest;
}
""",
    "rounded": """\
/* The double nearest to what `digits` stand for, of which the even one of two. */
static double rounded(int64_t *digits, int count)
{
    carry(digits, count);
    const bool is_negative = digits[count - 1] < 0;
    if (is_negative) {
        for (int i = 0; i < count; i++) {
            digits[i] = -digits[i];
        }
        carry(digits, count);
    }
    int top = 32 * count - 1;
    while (top >= 0 && ((digits[top / 32] >> (top % 32)) & 1) == 0) {
        top--;
    }
    const int last = top > 52 ? top - 52 : 0;
    uint64_t mantissa = 0;
    for (int bit = top; bit >= last; bit--) {
        mantissa = 2 * mantissa + (uint64_t)((digits[bit / 32] >> (bit % 32)) & 1);
    }
    if (last > 0 && ((digits[(last - 1) / 32] >> ((last - 1) % 32)) & 1) != 0) {
        bool is_above = false;
        for (int bit = 0; bit < last - 1; bit++) {
            is_above = is_above || ((digits[bit / 32] >> (bit % 32)) & 1) != 0;
        }
        mantissa += is_above ? 1 : mantissa & 1;
    }
    const double magnitude = ldexp((double)mantissa, last - 1074);
    return is_negative ? -magnitude : magnitude;
}
""",
    "of_rank": """\
/* The double at a place in the order of doubles: -infinity is at 2^52 - 1, infinity at 2^64 - 2^52. */
static double of_rank(uint64_t rank)
{
    const uint64_t sign = UINT64_C(0x8000000000000000);
    union {
        uint64_t bits;
        double number;
    } found;
    found.bits = rank < sign ? ~rank : rank - sign;
    return found.number;
}
""",
    "halfway": """\
/* The double nearest to the mean of two, never -0.0. */
static double halfway(double left, double right)
{
    const double sum = left + right;
    return sum - sum == 0.0 ? sum / 2.0 + 0.0 : left / 2.0 + right / 2.0;
}
""",
    "sooner": """\
/* The earlier of two times. */
static int64_t sooner(int64_t left, int64_t right)
{
    return right < left ? right : left;
}
""",
}
"""Each after what it needs is written; what it needs is what it mentions."""

_EXTREME_ELEMENT = """\
/* The NAME number; NaN, which is no measurement, if there is none. */
static double NAME_{plural}({array} array)
{{
    double found = (double)NAN;
    for (size_t i = 0; i < array.length; i++) {{
        const double each = (double)array.elements[i];
        if (each ORDER found || found != found) {{
            found = each;
        }}
    }}
    return found;
}}
"""

OF_ARRAYS = {
    "recent": """\
/* The last `count` samples, oldest first: each of the last `depth` stands in two places, `depth` apart. */
static {array} recent_{plural}({pointer}samples, uint32_t latest, uint32_t depth, uint32_t count)
{{
    const {array} found = {{samples + (latest + depth + 1u - count), count}};
    return found;
}}
""",
    "complete": """\
/* How many numbers there are; NaN if one of them is. */
static double complete_{plural}({array} array)
{{
    for (size_t i = 0; i < array.length; i++) {{
        if (array.elements[i] != array.elements[i]) {{
            return (double)NAN;
        }}
    }}
    return (double)array.length;
}}
""",
    "slice": """\
/* The elements from `start` up to, not including, `stop`; below 0 these count from the end. */
static {array} slice_{plural}({array} array, int64_t start, int64_t stop)
{{
    const int64_t length = (int64_t)array.length;
    start = start < 0 ? start + length : start;
    stop = stop < 0 ? stop + length : stop;
    start = start < 0 ? 0 : start > length ? length : start;
    stop = stop < start ? start : stop > length ? length : stop;
    if (start < stop) {{
        array.elements += start;
    }}
    array.length = (size_t)(stop - start);
    return array;
}}
""",
    "smallest": _EXTREME_ELEMENT.replace("NAME", "smallest").replace("ORDER", "<"),
    "largest": _EXTREME_ELEMENT.replace("NAME", "largest").replace("ORDER", ">"),
    "nearest": """\
/* The first of the numbers that differ least from another; NaN if there is none, or if that is NaN. */
static double nearest_{plural}(double sought, {array} array)
{{
    double found = (double)NAN;
    double least_apart = (double)NAN;
    for (size_t i = 0; i < array.length; i++) {{
        const double each = (double)array.elements[i];
        const double apart = fabs(gap(each, sought));
        if (apart < least_apart || (least_apart != least_apart && apart == apart)) {{
            found = each;
            least_apart = apart;
        }}
    }}
    return found;
}}
""",
    "ranked": """\
/* The number that `below` others come before; it is bisected, so that nothing has to be sorted. */
static double ranked_{plural}({array} array, size_t below)
{{
    uint64_t low = UINT64_C(0x000fffffffffffff);
    uint64_t high = UINT64_C(0xfff0000000000000);
    while (low < high) {{
        const uint64_t middle = low + (high - low) / 2u;
        const double number = of_rank(middle);
        size_t count = 0;
        for (size_t i = 0; i < array.length; i++) {{
            count += (double)array.elements[i] <= number ? 1u : 0u;
        }}
        if (count > below) {{
            high = middle;
        }} else {{
            low = middle + 1u;
        }}
    }}
    return of_rank(low);
}}
""",
    "median": """\
/* The middle number, or the mean of the middle two; NaN, which is no measurement, if there is none. */
static double median_{plural}({array} array)
{{
    size_t count = 0;
    for (size_t i = 0; i < array.length; i++) {{
        count += (double)array.elements[i] <= (double)INFINITY ? 1u : 0u;
    }}
    if (count == 0) {{
        return (double)NAN;
    }}
    return halfway(ranked_{plural}(array, (count - 1u) / 2u), ranked_{plural}(array, count / 2u));
}}
""",
    "mean": """\
/* The sum of the numbers, rounded, divided by how many there are; NaN, which is no measurement, if there is none. */
static double mean_{plural}({array} array)
{{
    int64_t digits[69] = {{0}};
    double special = 0.0;
    size_t count = 0;
    for (size_t i = 0; i < array.length; i++) {{
        const double each = (double)array.elements[i];
        count += each == each ? 1u : 0u;
        if (fabs(each) < (double)INFINITY) {{
            add_exactly(digits, each);
        }} else if (each == each) {{
            special += each;
        }}
    }}
    return (special == 0.0 ? rounded(digits, 69) : special) / (double)count;
}}
""",
    "sum": """\
/* The double nearest to the sum; NaN if an element is. */
static double sum_{plural}({array} array)
{{
    int64_t digits[69] = {{0}};
    double special = 0.0;
    for (size_t i = 0; i < array.length; i++) {{
        const double each = (double)array.elements[i];
        if (fabs(each) < (double)INFINITY) {{
            add_exactly(digits, each);
        }} else {{
            special += each;
        }}
    }}
    return special == 0.0 ? rounded(digits, 69) : special;
}}
""",
}
