/* Sealed frames of a session (innervate/wire/seal.py, innervate/live/session.py). */
#include "innervate_seal.h"

#define WINDOW 32U

void innervate_put_word(uint8_t *bytes, uint32_t word)
{
    for (int32_t i = 0; i < 4; i++) {
        bytes[i] = (uint8_t)(word >> (24 - 8 * i) & 255U);
    }
}

uint32_t innervate_get_word(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

/* Four zeros and the counter in 8 bytes, as Noise has it: for ChaCha its lowest first. */
void innervate_nonce(const innervate_crypto_t *crypto, uint8_t *nonce, uint32_t counter)
{
    for (int32_t i = 0; i < 12; i++) {
        nonce[i] = 0;
    }
    for (int32_t i = 0; i < 4; i++) {
        nonce[crypto->is_aes ? 11 - i : 4 + i] = (uint8_t)(counter >> (8 * i) & 255U);
    }
}

int32_t innervate_close(innervate_session_t *session, uint8_t kind, uint8_t *frame, int32_t count)
{
    innervate_lock_t lock = {session->key_out, {0}, frame, INNERVATE_SEAL_HEAD};
    if (session->counter >= INNERVATE_COUNTERS) {
        return 0;
    }
    frame[0] = kind;
    innervate_put_word(frame + 1, session->far);
    innervate_put_word(frame + 5, session->counter);
    innervate_nonce(session->crypto, lock.nonce, session->counter);
    session->counter++;
    session->crypto->close(&lock, frame + INNERVATE_SEAL_HEAD, count);
    return count + INNERVATE_SEAL_MORE;
}

/* 1 if a counter was not here before, and is not too far behind to know. */
static int32_t is_new(const innervate_session_t *session, uint32_t counter)
{
    if (counter >= session->highest) {
        return 1;
    }
    const uint32_t behind = session->highest - 1U - counter;
    return behind < WINDOW && !(session->window >> behind & 1U);
}

static void take(innervate_session_t *session, uint32_t counter)
{
    if (counter >= session->highest) {
        const uint32_t ahead = counter + 1U - session->highest;
        session->window = ahead < WINDOW ? session->window << ahead | 1U : 1U;
        session->highest = counter + 1U;
    } else {
        session->window |= 1U << (session->highest - 1U - counter);
    }
}

int32_t innervate_open(innervate_session_t *session, uint8_t *frame, int32_t size)
{
    innervate_lock_t lock = {session->key_in, {0}, frame, INNERVATE_SEAL_HEAD};
    const int32_t count = size - INNERVATE_SEAL_MORE;
    if (count < 0 || (frame[0] != INNERVATE_FRAME && frame[0] != INNERVATE_CONTROL) ||
            innervate_get_word(frame + 1) != session->own) {
        return -1;
    }
    const uint32_t counter = innervate_get_word(frame + 5);
    if (counter >= INNERVATE_COUNTERS || !is_new(session, counter)) {
        return -1;
    }
    innervate_nonce(session->crypto, lock.nonce, counter);
    if (!session->crypto->open(&lock, frame + INNERVATE_SEAL_HEAD, count)) {
        return -1;
    }
    take(session, counter);
    return count;
}

int32_t innervate_is_worn(const innervate_session_t *session)
{
    return session->counter > INNERVATE_COUNTERS / 2U;
}
