/* ChaCha20-Poly1305 as RFC 8439 has it. */
#include "innervate_example.h"

#define LIMBS 5 /* of 26 bits, modulo 2^130 - 5 */
#define MASK26 0x3FFFFFFU

static uint32_t get_word(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void put_word(uint8_t *bytes, uint32_t word)
{
    for (int32_t i = 0; i < 4; i++) {
        bytes[i] = (uint8_t)(word >> (8 * i) & 255U);
    }
}

static uint32_t turn(uint32_t word, uint32_t bits)
{
    return word << bits | word >> (32U - bits);
}

static void quarter(uint32_t *s, int32_t a, int32_t b, int32_t c, int32_t d)
{
    s[a] += s[b];
    s[d] = turn(s[d] ^ s[a], 16);
    s[c] += s[d];
    s[b] = turn(s[b] ^ s[c], 12);
    s[a] += s[b];
    s[d] = turn(s[d] ^ s[a], 8);
    s[c] += s[d];
    s[b] = turn(s[b] ^ s[c], 7);
}

/* A block of 64 bytes of the stream. */
static void stream(const innervate_lock_t *lock, uint32_t number, uint8_t *out)
{
    uint32_t first[16] = {0x61707865U, 0x3320646EU, 0x79622D32U, 0x6B206574U}, s[16];
    for (int32_t i = 0; i < 8; i++) {
        first[4 + i] = get_word(lock->key + 4 * i);
    }
    first[12] = number;
    for (int32_t i = 0; i < 3; i++) {
        first[13 + i] = get_word(lock->nonce + 4 * i);
    }
    for (int32_t i = 0; i < 16; i++) {
        s[i] = first[i];
    }
    for (int32_t round = 0; round < 10; round++) {
        for (int32_t i = 0; i < 4; i++) {
            quarter(s, i, 4 + i, 8 + i, 12 + i);
        }
        for (int32_t i = 0; i < 4; i++) {
            quarter(s, i, 4 + (i + 1) % 4, 8 + (i + 2) % 4, 12 + (i + 3) % 4);
        }
    }
    for (int32_t i = 0; i < 16; i++) {
        put_word(out + 4 * i, s[i] + first[i]);
    }
}

static void crypt(const innervate_lock_t *lock, uint8_t *data, int32_t count)
{
    uint8_t block[64];
    for (int32_t i = 0; i < count; i++) {
        if (i % 64 == 0) {
            stream(lock, 1U + (uint32_t)i / 64U, block);
        }
        data[i] ^= block[i % 64];
    }
}

static void split(uint32_t *limb, const uint8_t *bytes, uint32_t top)
{
    limb[0] = get_word(bytes) & MASK26;
    limb[1] = get_word(bytes + 3) >> 2 & MASK26;
    limb[2] = get_word(bytes + 6) >> 4 & MASK26;
    limb[3] = get_word(bytes + 9) >> 6 & MASK26;
    limb[4] = get_word(bytes + 12) >> 8 | top << 24;
}

static void carry(uint32_t *limb)
{
    uint32_t over = 0;
    for (int32_t i = 0; i < 2 * LIMBS; i++) {
        limb[i % LIMBS] += over;
        over = limb[i % LIMBS] >> 26;
        limb[i % LIMBS] &= MASK26;
        over = i % LIMBS == LIMBS - 1 ? 5U * over : over;
    }
    limb[0] += over;
}

/* Adds a block of 16 bytes to the sum, and multiplies it. */
static void absorb(uint32_t *sum, const uint32_t *factor, const uint8_t *block)
{
    uint32_t limb[LIMBS];
    uint64_t over = 0, wide[LIMBS] = {0};
    split(limb, block, 1);
    for (int32_t i = 0; i < LIMBS; i++) {
        for (int32_t j = 0; j < LIMBS; j++) {
            const uint32_t times = i + j < LIMBS ? 1U : 5U;
            wide[(i + j) % LIMBS] += (uint64_t)(sum[i] + limb[i]) * (times * factor[j]);
        }
    }
    for (int32_t i = 0; i < LIMBS; i++) {
        wide[i] += over;
        over = wide[i] >> 26;
        sum[i] = (uint32_t)(wide[i] & MASK26);
    }
    over = sum[0] + 5U * over;
    sum[0] = (uint32_t)(over & MASK26);
    sum[1] += (uint32_t)(over >> 26);
}

/* Bytes in blocks, the last filled up with zeros. */
static void absorb_all(uint32_t *sum, const uint32_t *factor, const uint8_t *data, int32_t count)
{
    for (int32_t at = 0; at < count; at += 16) {
        uint8_t block[16] = {0};
        for (int32_t i = 0; i < 16 && at + i < count; i++) {
            block[i] = data[at + i];
        }
        absorb(sum, factor, block);
    }
}

/* The sum modulo 2^130 - 5, and the second half of the key on it. */
static void finish(uint8_t *tag, uint32_t *sum, const uint8_t *key)
{
    uint32_t less[LIMBS], borrow = 0;
    uint64_t word = 0;
    carry(sum);
    for (int32_t i = 0; i < LIMBS; i++) {
        const uint32_t rest = sum[i] - (i == 0 ? MASK26 - 4U : MASK26) - borrow;
        less[i] = rest & MASK26;
        borrow = rest >> 31;
    }
    for (int32_t i = 0; i < LIMBS; i++) {
        sum[i] ^= (borrow - 1U) & (sum[i] ^ less[i]);
    }
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t low = sum[i] >> (6U * i);
        word += (uint64_t)(low | sum[i + 1] << (26U - 6U * i)) + get_word(key + 4U * i);
        put_word(tag + 4U * i, (uint32_t)(word & 0xFFFFFFFFU));
        word >>= 32;
    }
}

static void make_tag(const innervate_lock_t *lock, const uint8_t *data, int32_t count, uint8_t *tag)
{
    uint8_t key[64], sizes[16] = {0};
    uint32_t factor[LIMBS], sum[LIMBS] = {0};
    stream(lock, 0, key);
    for (int32_t i = 0; i < 16; i += 4) {
        key[i + 3] &= 15U;
        key[i] &= i == 0 ? 255U : 252U;
    }
    split(factor, key, 0);
    absorb_all(sum, factor, lock->head, lock->head_count);
    absorb_all(sum, factor, data, count);
    put_word(sizes, (uint32_t)lock->head_count);
    put_word(sizes + 8, (uint32_t)count);
    absorb(sum, factor, sizes);
    finish(tag, sum, key + 16);
}

void innervate_example_close(const innervate_lock_t *lock, uint8_t *data, int32_t count)
{
    crypt(lock, data, count);
    make_tag(lock, data, count, data + count);
}

int32_t innervate_example_open(const innervate_lock_t *lock, uint8_t *data, int32_t count)
{
    uint8_t tag[INNERVATE_TAG];
    uint32_t differs = 0;
    make_tag(lock, data, count, tag);
    for (int32_t i = 0; i < INNERVATE_TAG; i++) {
        differs |= (uint32_t)(tag[i] ^ data[count + i]);
    }
    if (differs != 0) {
        return 0;
    }
    crypt(lock, data, count);
    return 1;
}
