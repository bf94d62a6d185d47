/* X25519 as RFC 7748 has it: the ladder of its section 5, on 16 limbs of 16 bits. */
#include "innervate_example.h"

#define LIMBS 16

typedef struct {
    uint32_t limb[LIMBS]; /* each below 2^17; modulo 2^255 - 19 */
} number_t;

/* Limbs below 2^16 + 38 again; 2^256 is 38. */
static void carry(number_t *out, uint64_t *limb)
{
    for (int32_t pass = 0; pass < 2; pass++) {
        uint64_t over = 0;
        for (int32_t i = 0; i < LIMBS; i++) {
            limb[i] += over;
            over = limb[i] >> 16;
            limb[i] &= 0xFFFFU;
        }
        limb[0] += 38U * over;
    }
    for (int32_t i = 0; i < LIMBS; i++) {
        out->limb[i] = (uint32_t)limb[i];
    }
}

static void add(number_t *out, const number_t *a, const number_t *b)
{
    uint64_t limb[LIMBS];
    for (int32_t i = 0; i < LIMBS; i++) {
        limb[i] = (uint64_t)a->limb[i] + b->limb[i];
    }
    carry(out, limb);
}

/* With 4 times the modulus, so that no limb is below 0. */
static void subtract(number_t *out, const number_t *a, const number_t *b)
{
    uint64_t limb[LIMBS];
    for (int32_t i = 0; i < LIMBS; i++) {
        limb[i] = (uint64_t)a->limb[i] + (i == 0 ? 0x1FFB4U : 0x1FFFEU) - b->limb[i];
    }
    carry(out, limb);
}

static void multiply(number_t *out, const number_t *a, const number_t *b)
{
    uint64_t limb[2 * LIMBS] = {0};
    for (int32_t i = 0; i < LIMBS; i++) {
        for (int32_t j = 0; j < LIMBS; j++) {
            limb[i + j] += (uint64_t)a->limb[i] * b->limb[j];
        }
    }
    for (int32_t i = 0; i < LIMBS; i++) {
        limb[i] += 38U * limb[i + LIMBS];
    }
    carry(out, limb);
}

/* To the power of 2^255 - 21, whose bits are 1 but for two. */
static void invert(number_t *out, const number_t *a)
{
    number_t power = *a;
    for (int32_t bit = 253; bit >= 0; bit--) {
        multiply(&power, &power, &power);
        if (bit != 2 && bit != 4) {
            multiply(&power, &power, a);
        }
    }
    *out = power;
}

static void swap(number_t *a, number_t *b, uint32_t is_wanted)
{
    const uint32_t mask = 0U - is_wanted;
    for (int32_t i = 0; i < LIMBS; i++) {
        const uint32_t both = mask & (a->limb[i] ^ b->limb[i]);
        a->limb[i] ^= both;
        b->limb[i] ^= both;
    }
}

static void read(number_t *out, const uint8_t *bytes)
{
    for (int32_t i = 0; i < LIMBS; i++) {
        out->limb[i] = bytes[2 * i] | (uint32_t)bytes[2 * i + 1] << 8;
    }
    out->limb[LIMBS - 1] &= 0x7FFFU;
}

/* All limbs below 2^16, then less the modulus as often as it goes into it: twice at most. */
static void write(uint8_t *bytes, const number_t *a)
{
    number_t whole, less;
    uint64_t limb[LIMBS];
    for (int32_t i = 0; i < LIMBS; i++) {
        limb[i] = a->limb[i];
    }
    carry(&whole, limb);
    for (int32_t time = 0; time < 2; time++) {
        uint32_t borrow = 0;
        for (int32_t i = 0; i < LIMBS; i++) {
            const uint32_t modulus = i == 0 ? 0xFFEDU : i == LIMBS - 1 ? 0x7FFFU : 0xFFFFU;
            const uint32_t rest = whole.limb[i] - modulus - borrow;
            less.limb[i] = rest & 0xFFFFU;
            borrow = rest >> 31;
        }
        swap(&whole, &less, 1U - borrow);
    }
    for (int32_t i = 0; i < LIMBS; i++) {
        bytes[2 * i] = (uint8_t)(whole.limb[i] & 255U);
        bytes[2 * i + 1] = (uint8_t)(whole.limb[i] >> 8);
    }
}

/* A step of the ladder; names are the RFC's. */
static void step(const number_t *x1, number_t *x2, number_t *z2, number_t *x3, number_t *z3)
{
    static const number_t a24 = {{0xDB41U, 1}};
    number_t a, b, c, d, e;
    add(&a, x2, z2);
    subtract(&b, x2, z2);
    add(&c, x3, z3);
    subtract(&d, x3, z3);
    multiply(&d, &d, &a);
    multiply(&c, &c, &b);
    add(x3, &d, &c);
    multiply(x3, x3, x3);
    subtract(z3, &d, &c);
    multiply(z3, z3, z3);
    multiply(z3, z3, x1);
    multiply(&a, &a, &a);
    multiply(&b, &b, &b);
    multiply(x2, &a, &b);
    subtract(&e, &a, &b);
    multiply(z2, &a24, &e);
    add(z2, z2, &a);
    multiply(z2, z2, &e);
}

int32_t innervate_example_x25519(uint8_t *out, const uint8_t *scalar, const uint8_t *point)
{
    number_t x1, x2 = {{1}}, z2 = {{0}}, x3, z3 = {{1}};
    uint32_t swapped = 0, any = 0;
    read(&x1, point);
    x3 = x1;
    for (int32_t bit = 254; bit >= 0; bit--) {
        uint32_t is_set = (uint32_t)scalar[bit >> 3] >> (bit & 7) & 1U;
        is_set = bit < 3 ? 0U : bit == 254 ? 1U : is_set;
        swap(&x2, &x3, swapped ^ is_set);
        swap(&z2, &z3, swapped ^ is_set);
        swapped = is_set;
        step(&x1, &x2, &z2, &x3, &z3);
    }
    swap(&x2, &x3, swapped);
    swap(&z2, &z3, swapped);
    invert(&z2, &z2);
    multiply(&x2, &x2, &z2);
    write(out, &x2);
    for (int32_t i = 0; i < INNERVATE_KEY; i++) {
        any |= out[i];
    }
    return any != 0;
}
