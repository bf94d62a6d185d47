/** Sealed frames of a session, with the ChaCha20-Poly1305 that the maker has.
 *
 * What two nodes seal for each other on one cable, byte for byte as live nodes do. The handshake
 * that gives a session its keys is not here: two boards may be given keys when they are made, a
 * new pair for every start, as counters begin at 0. Link it if you use it. */
#ifndef INNERVATE_SEAL_H
#define INNERVATE_SEAL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define INNERVATE_SEAL_HEAD 9
#define INNERVATE_SEAL_TAG 16
#define INNERVATE_SEAL_MORE (INNERVATE_SEAL_HEAD + INNERVATE_SEAL_TAG) /* bytes beside the frame */

/** The maker's cipher; `key` is whatever it knows a key by. Both work in place. */
typedef struct {
    /** Encrypts `count` bytes and writes their tag of 16 bytes; `head`, 9 bytes, is covered. */
    void (*close)(const void *key, const uint8_t *nonce, const uint8_t *head, uint8_t *data,
            int32_t count, uint8_t *tag);
    /** Decrypts; 1 if the tag says that it is genuine, else 0. */
    int32_t (*open)(const void *key, const uint8_t *nonce, const uint8_t *head, uint8_t *data,
            int32_t count, const uint8_t *tag);
} innervate_cipher_t;

/** A session; set cipher, keys and indices, the rest to 0. */
typedef struct {
    const innervate_cipher_t *cipher;
    const void *key_out;
    const void *key_in;
    uint32_t own; /* the index of frames for us */
    uint32_t far; /* ... of ours */
    uint32_t counter; /* of our next frame */
    uint32_t highest; /* counter of the newest frame that came, + 1; 0 = none */
    uint32_t window; /* the 32 up to it: 1 = that one came */
} innervate_session_t;

/** Seals `count` bytes at `frame + INNERVATE_SEAL_HEAD`, where the head and the tag find room
 * around them; returns the size of all, 0 when the session has counted to its end. */
int32_t innervate_close(innervate_session_t *session, uint8_t *frame, int32_t count);

/** Opens a sealed frame in place; the bytes that were sealed then begin at
 * `frame + INNERVATE_SEAL_HEAD`. Returns how many, -1 = not genuine, not for us, or here before. */
int32_t innervate_open(innervate_session_t *session, uint8_t *frame, int32_t size);

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_SEAL_H */
