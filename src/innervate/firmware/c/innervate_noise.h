/** The handshake Noise_NNpsk0_25519 of the Noise Protocol Framework, revision 34, with SHA-256 and
 * the maker's cipher: two nodes that hold one key agree on keys of a session. */
#ifndef INNERVATE_NOISE_H
#define INNERVATE_NOISE_H

#include "innervate_crypto.h"

#ifdef __cplusplus
extern "C" {
#endif

#define INNERVATE_NOISE_MORE (INNERVATE_KEY + INNERVATE_TAG) /* bytes beside the payload */
#define INNERVATE_PAYLOAD_MAX 96 /* bytes of a payload */

/** What both sides know so far. */
typedef struct {
    const innervate_crypto_t *crypto;
    uint8_t hash[INNERVATE_KEY]; /* of all that was said */
    uint8_t chain[INNERVATE_KEY];
    uint8_t key[INNERVATE_KEY];
} innervate_noise_t;

/** Begins with what both know: a prologue, 64 bytes at most, and the shared key. */
void innervate_noise_begin(innervate_noise_t *noise, const innervate_keys_t *keys,
        const uint8_t *prologue, int32_t count);

/** Writes a message: a point, and at `message + INNERVATE_KEY` a payload of `count` bytes that
 * stands there already, encrypted. Returns its size. */
int32_t innervate_noise_write(innervate_noise_t *noise, uint8_t *message, const uint8_t *point,
        int32_t count);

/** Reads one in place; how many bytes its payload has, -1 = nobody with the key has written it. */
int32_t innervate_noise_read(innervate_noise_t *noise, uint8_t *message, int32_t size);

/** The same of the second message, after whose point both points are mixed in; -1 also if the far
 * point is none. `secret`: our scalar. */
int32_t innervate_noise_write_second(innervate_noise_t *noise, uint8_t *message, int32_t count,
        const uint8_t *secret, const uint8_t *far);
int32_t innervate_noise_read_second(innervate_noise_t *noise, uint8_t *message, int32_t size,
        const uint8_t *secret);

/** The keys of what the initiator sends, and of what it receives. */
void innervate_noise_split(const innervate_noise_t *noise, uint8_t *first, uint8_t *second);

/** The public point of a scalar. */
void innervate_point(const innervate_crypto_t *crypto, uint8_t *point, const uint8_t *secret);

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_NOISE_H */
