/* Sealed frames of a session (innervate/wire/seal.py, innervate/live/session.py). */
#include "innervate_seal.h"

#define FRAME 0xC3
#define COUNTERS (0xFFFFFFFFU - 1000U)
#define WINDOW 32U

static void put_word(uint8_t *bytes, uint32_t word)
{
    for (int32_t i = 0; i < 4; i++) {
        bytes[i] = (uint8_t)(word >> (24 - 8 * i) & 255U);
    }
}

static uint32_t get_word(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

/* Four zeros and the counter in 8 bytes, its lowest first. */
static void make_nonce(uint8_t *nonce, uint32_t counter)
{
    for (int32_t i = 0; i < 12; i++) {
        nonce[i] = 0;
    }
    for (int32_t i = 0; i < 4; i++) {
        nonce[4 + i] = (uint8_t)(counter >> (8 * i) & 255U);
    }
}

int32_t innervate_close(innervate_session_t *session, uint8_t *frame, int32_t count)
{
    uint8_t nonce[12];
    uint8_t *data = frame + INNERVATE_SEAL_HEAD;
    if (session->counter >= COUNTERS) {
        return 0;
    }
    frame[0] = FRAME;
    put_word(frame + 1, session->far);
    put_word(frame + 5, session->counter);
    make_nonce(nonce, session->counter);
    session->counter++;
    session->cipher->close(session->key_out, nonce, frame, data, count, data + count);
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
    uint8_t nonce[12];
    const int32_t count = size - INNERVATE_SEAL_MORE;
    uint8_t *data = frame + INNERVATE_SEAL_HEAD;
    if (count < 0 || frame[0] != FRAME || get_word(frame + 1) != session->own) {
        return -1;
    }
    const uint32_t counter = get_word(frame + 5);
    if (counter >= COUNTERS || !is_new(session, counter)) {
        return -1;
    }
    make_nonce(nonce, counter);
    if (!session->cipher->open(session->key_in, nonce, frame, data, count, data + count)) {
        return -1;
    }
    take(session, counter);
    return count;
}
