/** Sealed frames of a session: what two nodes seal for each other on one cable, byte for byte as
 * live nodes do. A handshake gives a session its keys (innervate_contact.h). */
#ifndef INNERVATE_SEAL_H
#define INNERVATE_SEAL_H

#include "innervate_crypto.h"

#ifdef __cplusplus
extern "C" {
#endif

#define INNERVATE_SEAL_HEAD 9
#define INNERVATE_SEAL_MORE (INNERVATE_SEAL_HEAD + INNERVATE_TAG) /* bytes beside the frame */
#define INNERVATE_COUNTERS (0xFFFFFFFFU - 1000U) /* then nothing is sealed any more */
#define INNERVATE_FRAME 0xC3 /* kind of what is sealed: a frame, */
#define INNERVATE_CONTROL 0xC5 /* or what nodes say to each other below the protocol */

/** A session; set crypto, keys and indices, the rest to 0. */
typedef struct {
    const innervate_crypto_t *crypto;
    uint8_t key_out[INNERVATE_KEY];
    uint8_t key_in[INNERVATE_KEY];
    uint32_t own; /* the index of frames for us */
    uint32_t far; /* ... of ours */
    uint32_t counter; /* of our next frame */
    uint32_t highest; /* counter of the newest frame that came, + 1; 0 = none */
    uint32_t window; /* the 32 up to it: 1 = that one came */
} innervate_session_t;

/** Seals `count` bytes at `frame + INNERVATE_SEAL_HEAD`, where the head and the tag find room
 * around them; returns the size of all, 0 when the session has counted to its end. */
int32_t innervate_close(innervate_session_t *session, uint8_t kind, uint8_t *frame, int32_t count);

/** Opens a sealed frame in place; the bytes that were sealed then begin at
 * `frame + INNERVATE_SEAL_HEAD`. Returns how many, -1 = not genuine, not for us, or here before. */
int32_t innervate_open(innervate_session_t *session, uint8_t *frame, int32_t size);

/** 1 if a session has counted so far that it should have a successor. */
int32_t innervate_is_worn(const innervate_session_t *session);

/** The 12 bytes that a counter is for a cipher. */
void innervate_nonce(const innervate_crypto_t *crypto, uint8_t *nonce, uint32_t counter);

/** A number of 4 bytes, the highest first, and back. */
void innervate_put_word(uint8_t *bytes, uint32_t word);
uint32_t innervate_get_word(const uint8_t *bytes);

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_SEAL_H */
