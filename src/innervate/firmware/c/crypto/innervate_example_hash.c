/* SHA-256 as FIPS 180-4, and BLAKE2s with a key as RFC 7693 has it. */
#include "innervate_example.h"

/* The roots of the first primes, after the point: square ones, and cubic ones. */
static const uint32_t start[8] = {
    0x6A09E667U, 0xBB67AE85U, 0x3C6EF372U, 0xA54FF53AU, 0x510E527FU, 0x9B05688CU,
    0x1F83D9ABU, 0x5BE0CD19U,
};
static const uint32_t rounds[64] = {
    0x428A2F98U, 0x71374491U, 0xB5C0FBCFU, 0xE9B5DBA5U, 0x3956C25BU, 0x59F111F1U, 0x923F82A4U,
    0xAB1C5ED5U, 0xD807AA98U, 0x12835B01U, 0x243185BEU, 0x550C7DC3U, 0x72BE5D74U, 0x80DEB1FEU,
    0x9BDC06A7U, 0xC19BF174U, 0xE49B69C1U, 0xEFBE4786U, 0x0FC19DC6U, 0x240CA1CCU, 0x2DE92C6FU,
    0x4A7484AAU, 0x5CB0A9DCU, 0x76F988DAU, 0x983E5152U, 0xA831C66DU, 0xB00327C8U, 0xBF597FC7U,
    0xC6E00BF3U, 0xD5A79147U, 0x06CA6351U, 0x14292967U, 0x27B70A85U, 0x2E1B2138U, 0x4D2C6DFCU,
    0x53380D13U, 0x650A7354U, 0x766A0ABBU, 0x81C2C92EU, 0x92722C85U, 0xA2BFE8A1U, 0xA81A664BU,
    0xC24B8B70U, 0xC76C51A3U, 0xD192E819U, 0xD6990624U, 0xF40E3585U, 0x106AA070U, 0x19A4C116U,
    0x1E376C08U, 0x2748774CU, 0x34B0BCB5U, 0x391C0CB3U, 0x4ED8AA4AU, 0x5B9CCA4FU, 0x682E6FF3U,
    0x748F82EEU, 0x78A5636FU, 0x84C87814U, 0x8CC70208U, 0x90BEFFFAU, 0xA4506CEBU, 0xBEF9A3F7U,
    0xC67178F2U,
};
/* Which word of a block a mixing of BLAKE2s takes, by round. */
static const uint8_t order[10][16] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
    {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4},
    {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
    {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13},
    {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
    {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11},
    {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
    {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5},
    {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0},
};

static uint32_t turn(uint32_t word, uint32_t bits)
{
    return word >> bits | word << (32U - bits);
}

/* A block of 64 bytes into a hash. */
static void take(uint32_t *hash, const uint8_t *block)
{
    uint32_t w[64], s[8];
    for (int32_t i = 0; i < 16; i++) {
        w[i] = (uint32_t)block[4 * i] << 24 | (uint32_t)block[4 * i + 1] << 16 |
                (uint32_t)block[4 * i + 2] << 8 | block[4 * i + 3];
    }
    for (int32_t i = 16; i < 64; i++) {
        const uint32_t a = w[i - 15], b = w[i - 2];
        w[i] = w[i - 16] + (turn(a, 7) ^ turn(a, 18) ^ a >> 3) + w[i - 7] +
                (turn(b, 17) ^ turn(b, 19) ^ b >> 10);
    }
    for (int32_t i = 0; i < 8; i++) {
        s[i] = hash[i];
    }
    for (int32_t i = 0; i < 64; i++) {
        const uint32_t a = s[0], e = s[4];
        const uint32_t one = s[7] + (turn(e, 6) ^ turn(e, 11) ^ turn(e, 25)) +
                ((e & s[5]) ^ (~e & s[6])) + rounds[i] + w[i];
        const uint32_t two = (turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) +
                ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
        for (int32_t k = 7; k > 0; k--) {
            s[k] = s[k - 1];
        }
        s[4] += one;
        s[0] = one + two;
    }
    for (int32_t i = 0; i < 8; i++) {
        hash[i] += s[i];
    }
}

void innervate_example_sha256(uint8_t *out, const uint8_t *data, int32_t count)
{
    uint32_t hash[8];
    for (int32_t i = 0; i < 8; i++) {
        hash[i] = start[i];
    }
    for (int32_t at = 0; at < count + 9; at += 64) { /* behind it a bit, and the length in bits */
        uint8_t block[64];
        for (int32_t i = 0; i < 64; i++) {
            block[i] = at + i < count ? data[at + i] : at + i == count ? 0x80U : 0U;
        }
        for (int32_t i = 0; i < 4 && at + 64 >= count + 9; i++) {
            block[63 - i] = (uint8_t)((uint32_t)count * 8U >> (8 * i) & 255U);
        }
        take(hash, block);
    }
    for (int32_t i = 0; i < 32; i++) {
        out[i] = (uint8_t)(hash[i / 4] >> (24 - 8 * (i % 4)) & 255U);
    }
}

static void mix(uint32_t *v, int32_t a, int32_t b, int32_t c, int32_t d, const uint32_t *words)
{
    static const uint32_t bits[2][2] = {{16, 12}, {8, 7}};
    for (int32_t half = 0; half < 2; half++) {
        v[a] += v[b] + words[half];
        v[d] = turn(v[d] ^ v[a], bits[half][0]);
        v[c] += v[d];
        v[b] = turn(v[b] ^ v[c], bits[half][1]);
    }
}

/* A block of 64 bytes into a hash of BLAKE2s; `behind`: bytes up to its end. */
static void take_block(uint32_t *hash, const uint8_t *block, int32_t behind, int32_t is_last)
{
    uint32_t v[16], m[16];
    for (int32_t i = 0; i < 16; i++) {
        m[i] = block[4 * i] | (uint32_t)block[4 * i + 1] << 8 | (uint32_t)block[4 * i + 2] << 16 |
                (uint32_t)block[4 * i + 3] << 24;
        v[i] = i < 8 ? hash[i] : start[i - 8];
    }
    v[12] ^= (uint32_t)behind;
    v[14] = is_last ? ~v[14] : v[14];
    for (int32_t round = 0; round < 10; round++) {
        for (int32_t i = 0; i < 8; i++) {
            const int32_t skew = i / 4; /* columns, then diagonals */
            const uint32_t words[2] = {m[order[round][2 * i]], m[order[round][2 * i + 1]]};
            mix(v, i % 4, 4 + (i + skew) % 4, 8 + (i + 2 * skew) % 4, 12 + (i + 3 * skew) % 4,
                    words);
        }
    }
    for (int32_t i = 0; i < 8; i++) {
        hash[i] ^= v[i] ^ v[8 + i];
    }
}

void innervate_example_blake2s(uint8_t *out, int32_t size, const uint8_t *key, const uint8_t *data,
        int32_t count)
{
    uint32_t hash[8];
    for (int32_t i = 0; i < 8; i++) {
        hash[i] = start[i];
    }
    hash[0] ^= 0x01010000U ^ (uint32_t)INNERVATE_KEY << 8 ^ (uint32_t)size;
    for (int32_t at = -64; at < count || at == -64; at += 64) { /* the key has the first block */
        uint8_t block[64];
        for (int32_t i = 0; i < 64; i++) {
            const int32_t k = at + i;
            block[i] = at < 0 ? (i < INNERVATE_KEY ? key[i] : 0U) : k < count ? data[k] : 0U;
        }
        const int32_t is_last = at + 64 >= count;
        take_block(hash, block, is_last ? count + 64 : at + 128, is_last);
    }
    for (int32_t i = 0; i < size; i++) {
        out[i] = (uint8_t)(hash[i / 4] >> (8 * (i % 4)) & 255U);
    }
}
