#include "motehound/share.h"

#if MH_REAL_FIXED

#include <stddef.h>

#define Q30(constant) ((int32_t)((constant)*1073741824.0f))

/* The upper half of a b + *low, whose lower half goes to *low. */
#if MH_REAL_WIDE
static inline int32_t multiply(int32_t a, int32_t b, uint32_t *low)
{
    const int64_t wide = (int64_t)a * b + *low;
    *low = (uint32_t)wide;
    return (int32_t)(wide >> 32);
}
#elif defined __AVR_HAVE_MUL__
/* Column by column: one of at most four products of bytes and what there was of it fits three bytes. */
#define TIMES(i, j, first, second, third)                                                                              \
    "mul %" i "[a], %" j "[b]\n\tadd " first ", r0\n\tadc " second ", r1\n\tadc " third ", %[zero]\n\t"
#define COLUMN_1(i, j) TIMES(i, j, "%B[low]", "%C[low]", "%D[low]")
#define COLUMN_2(i, j) TIMES(i, j, "%C[low]", "%D[low]", "%A[high]")
#define COLUMN_3(i, j) TIMES(i, j, "%D[low]", "%A[high]", "%B[high]")
#define COLUMN_4(i, j) TIMES(i, j, "%A[high]", "%B[high]", "%C[high]")
#define COLUMN_5(i, j) TIMES(i, j, "%B[high]", "%C[high]", "%D[high]")
__attribute__((always_inline)) static inline int32_t multiply(int32_t a, int32_t b, uint32_t *low)
{
    uint32_t high = 0;
    /* clang-format off */
    __asm__(TIMES("A", "A", "%A[low]", "%B[low]", "%C[low]") "adc %D[low], %[zero]\n\t"
            COLUMN_1("A", "B") COLUMN_1("B", "A")
            COLUMN_2("A", "C") COLUMN_2("B", "B") COLUMN_2("C", "A")
            COLUMN_3("A", "D") COLUMN_3("B", "C") COLUMN_3("C", "B") COLUMN_3("D", "A")
            COLUMN_4("B", "D") COLUMN_4("C", "C") COLUMN_4("D", "B")
            COLUMN_5("C", "D") COLUMN_5("D", "C")
            "mul %D[a], %D[b]\n\tadd %C[high], r0\n\tadc %D[high], r1\n\tclr __zero_reg__"
            : [low] "+&r"(*low), [high] "+&r"(high)
            : [a] "r"(a), [b] "r"(b), [zero] "r"((uint8_t)0)
            : "r0");
    /* clang-format on */
    if (a < 0) { /* its bytes were taken for a + 2^32's */
        high -= (uint32_t)b;
    }
    if (b < 0) {
        high -= (uint32_t)a;
    }
    return (int32_t)high;
}
#else
/* From halves of 16 bits. No sum overflows: |high * low| <= 2^31 - 2^15. */
static inline int32_t multiply(int32_t a, int32_t b, uint32_t *low)
{
    const int16_t a_high = (int16_t)(a >> 16), b_high = (int16_t)(b >> 16);
    const uint16_t a_low = (uint16_t)a, b_low = (uint16_t)b;
    const uint32_t least = (uint32_t)a_low * b_low;
    const int32_t first = (int32_t)a_high * b_low + (int32_t)(least >> 16);
    const int32_t second = (int32_t)b_high * a_low + (int32_t)((uint32_t)first & 0xFFFF);
    *low += (uint32_t)second << 16 | (least & 0xFFFF);
    const bool carry = *low < ((uint32_t)second << 16 | (least & 0xFFFF));
    return (int32_t)a_high * b_high + (first >> 16) + (second >> 16) + carry;
}
#endif

#ifdef __AVR_HAVE_MUL__
mh_real mh_mul(mh_real a, mh_real b)
{
    uint32_t low = MH_REAL_ONE / 2;
    const int32_t high = multiply(a, b, &low);
    if ((int16_t)high != high) {
        return high < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const int32_t middle = (int32_t)((uint32_t)high << 16 | low >> 16);
    return middle == INT32_MIN ? -MH_REAL_INFINITE : middle;
}
#elif !MH_REAL_WIDE
/* As in multiply(), but only the middle of the 64 bits is wanted. Modulo 2^32 it is easily had; it has not overflowed if its upper half is the sum of the
 * parts' upper halves and at most one carry. */
mh_real mh_mul(mh_real a, mh_real b)
{
    const int16_t a_high = (int16_t)(a >> 16), b_high = (int16_t)(b >> 16);
    const uint16_t a_low = (uint16_t)a, b_low = (uint16_t)b;
    const int32_t first = (int32_t)a_high * b_low;
    const int32_t second = (int32_t)b_high * a_low + (int32_t)(((uint32_t)a_low * b_low + MH_REAL_ONE / 2) >> 16);
    const int32_t high = (int32_t)a_high * b_high;
    const int32_t middle = (int32_t)(((uint32_t)high << 16) + (uint32_t)first + (uint32_t)second);
    const int32_t upper = high + (first >> 16) + (second >> 16);
    if ((uint32_t)((middle >> 16) - upper) > 1 || middle == INT32_MIN) {
        return upper < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    return middle;
}
#endif

#ifdef __AVR__
/* a b / 2^(but_one + 1), but_one < 32: this processor shifts bytes at once, bits in a loop. */
static int32_t shifted(int32_t a, int32_t b, uint8_t but_one)
{
    uint32_t low = 0;
    int32_t high = multiply(a, b, &low);
    for (; but_one >= 8; but_one = (uint8_t)(but_one - 8)) {
        low = low >> 8 | (uint32_t)high << 24;
        high >>= 8;
    }
    for (; but_one > 0; but_one--) {
        low = low >> 1 | (uint32_t)high << 31;
        high >>= 1;
    }
    if (high != 0 && high != -1) {
        return high < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const uint32_t size = (low >> 1 | (uint32_t)high << 31) + (low & 1);
    if (high == 0) {
        return size > MH_REAL_MAX ? MH_REAL_INFINITE : (int32_t)size;
    }
    return (int32_t)size < -MH_REAL_MAX ? -MH_REAL_INFINITE : (int32_t)size;
}
#endif

int32_t mh_mul_shift(int32_t a, int32_t b, uint8_t shift)
{
    if (shift == 0) {
        return mh_real_saturate((int64_t)a * b);
    }
#ifdef __AVR__
    if (shift <= 32) {
        return shifted(a, b, (uint8_t)(shift - 1));
    }
#endif
    uint32_t low = shift <= 32 ? (uint32_t)1 << (shift - 1) : 0;
    int32_t high = multiply(a, b, &low);
    if (shift > 32) {
        shift = (uint8_t)(shift - 33);
        high >>= shift; /* and half of that, rounded: no sum to overflow */
        return (high >> 1) + (high & 1);
    }
    if (shift == 32) {
        return high;
    }
    const int32_t over = high >> (shift - 1);
    if (over != 0 && over != -1) {
        return high < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const int32_t result = (int32_t)((uint32_t)high << (32 - shift) | low >> shift);
    return mh_finite(result) ? result : result < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
}

/* Products of numbers with 30 fractional bits. An AVR shifts bytes at once, bits in a loop. */
static int32_t without_30_bits(int32_t high, uint32_t low)
{
    const uint8_t last = (uint8_t)(low >> 24) >> 6;
    uint32_t quarter = (uint32_t)high;
    quarter += quarter;
    quarter += quarter;
    return (int32_t)(quarter + last);
}

static int32_t mul30(int32_t a, int32_t b)
{
    uint32_t low = (uint32_t)1 << 29;
    const int32_t high = multiply(a, b, &low);
    return without_30_bits(high, low);
}

#if !MH_REAL_WIDE
mh_real mh_part(mh_share share, mh_real a) { return mul30(share, a); }

mh_real mh_turned(mh_share c, mh_real a, mh_share s, mh_real b)
{
    uint32_t low = (uint32_t)1 << 29;
    int32_t high = multiply(c, a, &low);
    high += multiply(s, b, &low);
    return without_30_bits(high, low);
}
#endif

#if MH_REAL_WIDE
/* `steps` binary digits of over / under after the point, for over < under. */
static uint32_t divide(uint32_t over, uint32_t under, uint8_t steps)
{
    return (uint32_t)(((uint64_t)over << steps) / under);
}

mh_real mh_div(mh_real a, mh_real b) { return mh_wide_div((mh_wide)a * MH_REAL_ONE, b); }

/* The fractional bits of a quotient are those of a less those of b. */
mh_real mh_wide_div(mh_wide a, mh_real b)
{
    if (b == 0) {
        return a < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const bool negative = (a < 0) != (b < 0);
    const uint64_t over = a < 0 ? 0 - (uint64_t)a : (uint64_t)a, under = (uint32_t)mh_abs(b);
    const uint64_t quotient = (over + under / 2) / under;
    const mh_real saturated = quotient > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)quotient;
    return negative ? -saturated : saturated;
}
#else
/* One more digit of *rest / under, for *rest < under. */
__attribute__((always_inline)) static inline uint32_t divide_further(uint32_t quotient, uint32_t *rest, uint32_t under)
{
    const uint32_t lacking = under - *rest;
    quotient += quotient;
    if (*rest >= lacking) {
        *rest -= lacking;
        return quotient + 1;
    }
    *rest += *rest;
    return quotient;
}

static uint32_t divide(uint32_t over, uint32_t under, uint8_t steps)
{
    uint32_t quotient = 0;
    do {
        quotient = divide_further(quotient, &over, under);
    } while (--steps > 0);
    return quotient;
}

/* To nearest, saturated. */
static mh_real rounded(uint32_t quotient, uint32_t rest, uint32_t under, bool negative)
{
    const mh_real size = quotient > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)(quotient + (rest >= under - rest));
    return negative ? -size : size;
}

mh_real mh_div(mh_real a, mh_real b)
{
    const bool negative = (a < 0) != (b < 0);
    uint32_t rest = (uint32_t)mh_abs(a), under = (uint32_t)mh_abs(b), quotient = 0;
    if (under <= rest >> 15) { /* the quotient is 2^15 or more */
        return negative ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    uint8_t digits = MH_REAL_BITS;
    for (; under <= rest; digits++) {
        under += under;
    }
    do {
        quotient = divide_further(quotient, &rest, under);
    } while (--digits > 0);
    return rounded(quotient, rest, under, negative);
}

mh_real mh_wide_div(mh_wide a, mh_real b)
{
    const bool negative = (a < 0) != (b < 0);
    const uint64_t over = a < 0 ? 0 - (uint64_t)a : (uint64_t)a;
    const uint32_t under = (uint32_t)mh_abs(b);
    uint32_t rest = (uint32_t)(over >> 32), digits = (uint32_t)over, quotient = 0;
    if (rest >= (under + 1) / 2) { /* the quotient is 2^31 or more */
        return negative ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    uint8_t left = 32;
    while (left > 8 && rest < 0x1000000 && (rest << 8 | digits >> 24) < under) { /* eight digits are 0 */
        rest = rest << 8 | digits >> 24;
        digits <<= 8;
        left = (uint8_t)(left - 8);
    }
    do {
        rest += rest;
        rest += digits >> 31;
        digits += digits;
        quotient += quotient;
        if (rest >= under) {
            rest -= under;
            quotient++;
        }
    } while (--left > 0);
    return rounded(quotient, rest, under, negative);
}
#endif

/* Both are shortened until the divisor has 31 bits; a dividend that then has no room for the fraction is too large anyway. */
mh_real mh_wide_ratio(mh_wide a, mh_wide b)
{
    const bool negative = (a < 0) != (b < 0);
    uint64_t over = a < 0 ? 0 - (uint64_t)a : (uint64_t)a, under = b < 0 ? 0 - (uint64_t)b : (uint64_t)b;
    for (; under >> 31 != 0; under >>= 1) {
        over >>= 1;
    }
    if (under == 0 || over >> 47 != 0) {
        return negative ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const uint64_t quotient = ((over << MH_REAL_BITS) + under / 2) / under;
    const mh_real saturated = quotient > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)quotient;
    return negative ? -saturated : saturated;
}

mh_real mh_sqrt(mh_real a) { return mh_wide_sqrt((mh_wide)a * MH_REAL_ONE); }

/* Two digits of a at a time, one of the root: what is over is (a - root^2) / 4^left, where `left` digits of the root are to come, and at most 2 root.
 * Sums in place of shifts: an AVR shifts by one bit, in a loop. */
mh_real mh_wide_sqrt(mh_wide a)
{
    if (a < 0) {
        return -MH_REAL_INFINITE;
    }
    uint32_t rest = 0, root = 0, digits = (uint32_t)(a >> 32);
    uint8_t left = 32;
    if (digits == 0) {
        digits = (uint32_t)a;
        left = 16;
    }
    for (; digits < 0x40000000 && left > 1; left--) {
        digits += digits;
        digits += digits;
    }
    for (;;) {
        const uint8_t next = (uint8_t)(digits >> 24) >> 6;
        const bool one = rest > root || (rest == root && next > 0);
        if (one) {
            rest -= root;
        }
        rest += rest;
        rest += rest;
        rest += next;
        root += root;
        if (one) {
            rest--;
            root++;
        }
        if (--left == 0) {
            break;
        }
        if (left == 16) {
            digits = (uint32_t)a;
        } else {
            digits += digits;
            digits += digits;
        }
    }
    return root >= MH_REAL_INFINITE ? MH_REAL_INFINITE : (mh_real)(rest > root ? root + 1 : root); /* to nearest */
}

/* 2^(whole + part) with part within +-1/2, by the series of e^x. */
mh_real mh_exp(mh_real a)
{
    if (a > MH_REAL(10.3972f)) {
        return MH_REAL_INFINITE;
    }
    if (a < MH_REAL(-12.0f)) {
        return 0;
    }
    uint32_t low = 0;
    const int32_t high = multiply(a, 1549082005, &low); /* times log2(e), with 30 fractional bits more */
    const int32_t whole = (high + 0x2000) >> 14;
    const uint32_t part = ((uint32_t)high << 16 | low >> 16) - ((uint32_t)whole << 30);
    const int32_t x = mul30((int32_t)part, Q30(0.693147181f));
    int32_t sum = Q30(1.0f / 5040);
    static const int32_t coefficients[] = {Q30(1.0f / 720), Q30(1.0f / 120), Q30(1.0f / 24),
                                           Q30(1.0f / 6),   Q30(0.5f),       Q30(1.0f)};
    for (size_t i = 0; i < sizeof coefficients / sizeof coefficients[0]; i++) {
        sum = coefficients[i] + mul30(x, sum);
    }
    const uint32_t power = (uint32_t)(Q30(1.0f) + mul30(x, sum)); /* below 2^30.51 */
    const int8_t shift = (int8_t)(30 - MH_REAL_BITS - whole);     /* at least -1: a is below 15.01 log 2 */
    const uint32_t rounded = shift <= 0 ? power << -shift : (power + ((uint32_t)1 << (shift - 1))) >> shift;
    return rounded > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)rounded;
}

/* The number as m 2^k with m within a factor of the root of 2 of 1; ln m = 2 artanh((m - 1) / (m + 1)). */
mh_real mh_log(mh_real a)
{
    if (a <= 0) {
        return -MH_REAL_INFINITE;
    }
    int8_t exponent = 14;
    int32_t m = a; /* 30 fractional bits in the end */
    for (; m < Q30(1.0f); exponent--) {
        m *= 2;
    }
    if (m > Q30(1.41421356f)) {
        m /= 2;
        exponent++;
    }
    const int32_t size = (int32_t)divide((uint32_t)mh_abs(m - Q30(1.0f)), (uint32_t)m + (uint32_t)Q30(1.0f), 30);
    const int32_t t = m < Q30(1.0f) ? -size : size, square = mul30(t, t);
    const int32_t series =
        Q30(1.0f) + mul30(square, Q30(1.0f / 3) + mul30(square, Q30(1.0f / 5) + mul30(square, Q30(1.0f / 7))));
    const int64_t sum = 2 * (int64_t)mul30(t, series) + (int64_t)exponent * Q30(0.693147181f);
    return (mh_real)((sum + ((int64_t)1 << 13)) >> 14);
}

/* By a polynomial of the smaller over the larger coordinate (Hastings). */
mh_real mh_atan2(mh_real y, mh_real x)
{
    const uint32_t large = (uint32_t)mh_max(mh_abs(x), mh_abs(y)), small = (uint32_t)mh_min(mh_abs(x), mh_abs(y));
    if (large == 0) {
        return 0;
    }
    const int32_t z = small == large ? Q30(1.0f) : (int32_t)divide(small, large, 30), square = mul30(z, z);
    int32_t sum = Q30(-0.01172120f);
    static const int32_t coefficients[] = {Q30(0.05265332f), Q30(-0.11643287f), Q30(0.19354346f), Q30(-0.33262347f),
                                           Q30(0.99997726f)};
    for (size_t i = 0; i < sizeof coefficients / sizeof coefficients[0]; i++) {
        sum = coefficients[i] + mul30(square, sum);
    }
    int32_t angle = mul30(z, sum) >> 14;
    angle = mh_abs(y) > mh_abs(x) ? MH_REAL(1.57079633f) - angle : angle;
    angle = x < 0 ? MH_REAL(3.14159265f) - angle : angle;
    return y < 0 ? -angle : angle;
}

mh_real mh_real_from_int(int32_t a)
{
    return a > 32767 ? MH_REAL_INFINITE : a < -32767 ? -MH_REAL_INFINITE : a * MH_REAL_ONE;
}

mh_real mh_real_from_ratio(int32_t a, int32_t b) { return mh_wide_div((mh_wide)a * MH_REAL_ONE, b); }

int32_t mh_real_times(mh_real a, int32_t b)
{
    const int64_t product = (int64_t)a * b / MH_REAL_ONE;
    return product > INT32_MAX ? INT32_MAX : product < INT32_MIN ? INT32_MIN : (int32_t)product;
}

uint32_t mh_real_to_ieee(mh_real a)
{
    const uint32_t sign = a < 0 ? 0x80000000u : 0;
    if (!mh_finite(a)) {
        return sign | 0x7F800000u;
    }
    uint64_t mantissa = (uint64_t)(uint32_t)mh_abs(a) << 24;
    if (mantissa == 0) {
        return 0;
    }
    uint32_t exponent = 127 + 31 - MH_REAL_BITS;
    for (; mantissa < (uint64_t)1 << 55; exponent--) {
        mantissa <<= 1;
    }
    /* the leading one, at bit 23 after rounding, adds to the exponent, as a carry does */
    return sign | (((exponent - 1) << 23) + (uint32_t)((mantissa + ((uint64_t)1 << 31)) >> 32));
}

mh_real mh_real_from_ieee(uint32_t bits)
{
    const int16_t exponent = (int16_t)((bits >> 23 & 0xFF) - 127);
    const int64_t mantissa = (int64_t)(bits & 0x7FFFFF) | 0x800000;
    if (exponent < -MH_REAL_BITS - 1) {
        return 0;
    }
    const int8_t shift = (int8_t)(23 - MH_REAL_BITS - (exponent > 20 ? 20 : exponent));
    const mh_real size = mh_real_saturate(shift <= 0 ? mantissa * ((int64_t)1 << -shift)
                                                     : (mantissa + ((int64_t)1 << (shift - 1))) >> shift);
    return bits >> 31 ? -size : size;
}

#else
typedef int mh_real_is_float; /* C99 wants a declaration */
#endif
