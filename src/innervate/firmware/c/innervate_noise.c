/* The handshake of the network's key (innervate/live/noise.py). */
#include "innervate_noise.h"

#include "innervate_seal.h"

#define BLOCK 64 /* bytes that SHA-256 takes at once */
#define MIXED_MAX (INNERVATE_PAYLOAD_MAX + INNERVATE_TAG)

static void copy(uint8_t *to, const uint8_t *from, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        to[i] = from[i];
    }
}

/* HMAC-SHA-256 of up to 33 bytes under a key of 32. */
static void authenticate(const innervate_crypto_t *crypto, uint8_t *out, const uint8_t *key,
        const uint8_t *data, int32_t count)
{
    uint8_t inner[BLOCK + INNERVATE_KEY + 1], outer[BLOCK + INNERVATE_KEY];
    for (int32_t i = 0; i < BLOCK; i++) {
        const uint8_t byte = i < INNERVATE_KEY ? key[i] : 0;
        inner[i] = byte ^ 0x36U;
        outer[i] = byte ^ 0x5CU;
    }
    copy(inner + BLOCK, data, count);
    crypto->sha256(outer + BLOCK, inner, BLOCK + count);
    crypto->sha256(out, outer, BLOCK + INNERVATE_KEY);
}

/* HKDF: `parts` times 32 bytes out of a chaining key and a secret of 32 bytes, or none. */
static void derive(const innervate_noise_t *noise, uint8_t (*out)[INNERVATE_KEY], int32_t parts,
        const uint8_t *secret)
{
    uint8_t key[INNERVATE_KEY], last[INNERVATE_KEY + 1];
    int32_t count = 0;
    authenticate(noise->crypto, key, noise->chain, secret, secret ? INNERVATE_KEY : 0);
    for (int32_t part = 0; part < parts; part++) {
        last[count] = (uint8_t)(part + 1);
        authenticate(noise->crypto, out[part], key, last, count + 1);
        copy(last, out[part], INNERVATE_KEY);
        count = INNERVATE_KEY;
    }
}

static void mix_hash(innervate_noise_t *noise, const uint8_t *data, int32_t count)
{
    uint8_t text[INNERVATE_KEY + MIXED_MAX];
    copy(text, noise->hash, INNERVATE_KEY);
    copy(text + INNERVATE_KEY, data, count);
    noise->crypto->sha256(noise->hash, text, INNERVATE_KEY + count);
}

static void mix_key(innervate_noise_t *noise, const uint8_t *secret)
{
    uint8_t out[2][INNERVATE_KEY];
    derive(noise, out, 2, secret);
    copy(noise->chain, out[0], INNERVATE_KEY);
    copy(noise->key, out[1], INNERVATE_KEY);
}

void innervate_noise_begin(innervate_noise_t *noise, const innervate_keys_t *keys,
        const uint8_t *prologue, int32_t count)
{
    static const uint8_t aes[] = "Noise_NNpsk0_25519_AESGCM_SHA256"; /* 32 bytes: its own hash */
    static const uint8_t chacha[] = "Noise_NNpsk0_25519_ChaChaPoly_SHA256";
    uint8_t out[3][INNERVATE_KEY];
    noise->crypto = keys->crypto;
    if (keys->crypto->is_aes) {
        copy(noise->hash, aes, INNERVATE_KEY);
    } else {
        keys->crypto->sha256(noise->hash, chacha, (int32_t)sizeof chacha - 1);
    }
    copy(noise->chain, noise->hash, INNERVATE_KEY);
    mix_hash(noise, prologue, count);
    derive(noise, out, 3, keys->key);
    copy(noise->chain, out[0], INNERVATE_KEY);
    mix_hash(noise, out[1], INNERVATE_KEY);
    copy(noise->key, out[2], INNERVATE_KEY);
}

/* A point that was said: with a shared key it is mixed into the key as well. */
static void mix_point(innervate_noise_t *noise, const uint8_t *point)
{
    mix_hash(noise, point, INNERVATE_KEY);
    mix_key(noise, point);
}

/* Every key of a handshake encrypts one payload, so the counter is always 0. */
static int32_t close_payload(innervate_noise_t *noise, uint8_t *message, int32_t count)
{
    innervate_lock_t lock = {noise->key, {0}, noise->hash, INNERVATE_KEY};
    noise->crypto->close(&lock, message + INNERVATE_KEY, count);
    mix_hash(noise, message + INNERVATE_KEY, count + INNERVATE_TAG);
    return count + INNERVATE_NOISE_MORE;
}

static int32_t open_payload(innervate_noise_t *noise, uint8_t *message, int32_t count)
{
    uint8_t before[INNERVATE_KEY];
    innervate_lock_t lock = {noise->key, {0}, before, INNERVATE_KEY};
    copy(before, noise->hash, INNERVATE_KEY);
    mix_hash(noise, message + INNERVATE_KEY, count + INNERVATE_TAG);
    return noise->crypto->open(&lock, message + INNERVATE_KEY, count) ? count : -1;
}

/* How many bytes the payload of a message has, -1 = there can be none. */
static int32_t payload_of(int32_t size)
{
    const int32_t count = size - INNERVATE_NOISE_MORE;
    return count <= INNERVATE_PAYLOAD_MAX ? count : -1;
}

int32_t innervate_noise_write(innervate_noise_t *noise, uint8_t *message, const uint8_t *point,
        int32_t count)
{
    copy(message, point, INNERVATE_KEY);
    mix_point(noise, point);
    return close_payload(noise, message, count);
}

int32_t innervate_noise_read(innervate_noise_t *noise, uint8_t *message, int32_t size)
{
    const int32_t count = payload_of(size);
    if (count < 0) {
        return -1;
    }
    mix_point(noise, message);
    return open_payload(noise, message, count);
}

/* Our scalar and the other's point; 0 = it is none. */
static int32_t mix_both(innervate_noise_t *noise, const uint8_t *secret, const uint8_t *far)
{
    uint8_t shared[INNERVATE_KEY];
    if (!noise->crypto->x25519(shared, secret, far)) {
        return 0;
    }
    mix_key(noise, shared);
    return 1;
}

int32_t innervate_noise_write_second(innervate_noise_t *noise, uint8_t *message, int32_t count,
        const uint8_t *secret, const uint8_t *far)
{
    innervate_point(noise->crypto, message, secret);
    mix_point(noise, message);
    return mix_both(noise, secret, far) ? close_payload(noise, message, count) : -1;
}

int32_t innervate_noise_read_second(innervate_noise_t *noise, uint8_t *message, int32_t size,
        const uint8_t *secret)
{
    const int32_t count = payload_of(size);
    if (count < 0) {
        return -1;
    }
    mix_point(noise, message);
    return mix_both(noise, secret, message) ? open_payload(noise, message, count) : -1;
}

void innervate_noise_split(const innervate_noise_t *noise, uint8_t *first, uint8_t *second)
{
    uint8_t out[2][INNERVATE_KEY];
    derive(noise, out, 2, 0);
    copy(first, out[0], INNERVATE_KEY);
    copy(second, out[1], INNERVATE_KEY);
}

void innervate_point(const innervate_crypto_t *crypto, uint8_t *point, const uint8_t *secret)
{
    static const uint8_t base[INNERVATE_KEY] = {9};
    crypto->x25519(point, secret, base);
}
