/** An example of what sealing asks for, where a board has nothing of its own: small, in plain C, in
 * time that does not depend on keys if the processor multiplies so. Held against published vectors
 * and another implementation; no cryptographer has looked at it. Take your maker's if there is. */
#ifndef INNERVATE_EXAMPLE_H
#define INNERVATE_EXAMPLE_H

#include "innervate_crypto.h"

#ifdef __cplusplus
extern "C" {
#endif

/** ChaCha20-Poly1305 (RFC 8439), X25519 (RFC 7748), SHA-256 (FIPS 180-4), BLAKE2s (RFC 7693). */
void innervate_example_close(const innervate_lock_t *lock, uint8_t *data, int32_t count);
int32_t innervate_example_open(const innervate_lock_t *lock, uint8_t *data, int32_t count);
int32_t innervate_example_x25519(uint8_t *out, const uint8_t *scalar, const uint8_t *point);
void innervate_example_sha256(uint8_t *out, const uint8_t *data, int32_t count);
void innervate_example_blake2s(uint8_t *out, int32_t size, const uint8_t *key, const uint8_t *data,
        int32_t count);

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_EXAMPLE_H */
