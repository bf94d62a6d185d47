/** What sealing asks of the maker: algorithms that a board has, or that `crypto/` shows. */
#ifndef INNERVATE_CRYPTO_H
#define INNERVATE_CRYPTO_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define INNERVATE_KEY 32 /* bytes of a key, a point, a hash */
#define INNERVATE_TAG 16

/** Under what bytes are encrypted. */
typedef struct {
    const uint8_t *key; /* 32 bytes */
    uint8_t nonce[12];
    const uint8_t *head; /* bytes that the tag covers, and that are not encrypted */
    int32_t head_count;
} innervate_lock_t;

/** A maker's algorithms. */
typedef struct {
    /** 1 = `close` and `open` are AES-256-GCM, which only boards among themselves can agree on;
     * 0 = they are ChaCha20-Poly1305, which live nodes have. */
    uint8_t is_aes;
    /** Encrypts `count` bytes in place, and writes their tag of 16 bytes behind them. */
    void (*close)(const innervate_lock_t *lock, uint8_t *data, int32_t count);
    /** Decrypts; 1 if the tag behind the bytes says that they are genuine, else 0. */
    int32_t (*open)(const innervate_lock_t *lock, uint8_t *data, int32_t count);
    /** X25519 (RFC 7748), the scalar as drawn; 0 if what comes of it is 0, else 1. */
    int32_t (*x25519)(uint8_t *out, const uint8_t *scalar, const uint8_t *point);
    /** SHA-256 of bytes. */
    void (*sha256)(uint8_t *out, const uint8_t *data, int32_t count);
    /** BLAKE2s with a key of 32 bytes; `size` bytes of it, 32 at most. */
    void (*blake2s)(uint8_t *out, int32_t size, const uint8_t *key, const uint8_t *data,
            int32_t count);
    /** Random bytes that nobody can guess: a hardware's, never those of a counter or a clock. */
    void (*random)(uint8_t *out, int32_t count);
} innervate_crypto_t;

/** What a node has to prove itself with: the network's key, as in a node file's `secret.N`. */
typedef struct {
    const innervate_crypto_t *crypto;
    uint8_t number; /* of the key, 0 to 15 */
    uint8_t key[INNERVATE_KEY];
} innervate_keys_t;

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_CRYPTO_H */
