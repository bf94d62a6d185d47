/** First contact with whoever is at the far end of a line, and the sessions that come of it, as
 * live nodes have them: a network's key, Noise NNpsk0, frames sealed for this neighbour alone. */
#ifndef INNERVATE_CONTACT_H
#define INNERVATE_CONTACT_H

#include "innervate_noise.h"
#include "innervate_seal.h"

#ifdef __cplusplus
extern "C" {
#endif

#define INNERVATE_SESSIONS 3 /* of a neighbour: frames of an older one may come late */
#define INNERVATE_LIFE 8
#define INNERVATE_SAID (INNERVATE_LIFE + 10) /* bytes of what we say of ourselves */
#define INNERVATE_SAY_MAX (5 + INNERVATE_NOISE_MORE + INNERVATE_SAID + INNERVATE_TAG)
#define INNERVATE_HELLO_MAX (5 + INNERVATE_NOISE_MORE + INNERVATE_PAYLOAD_MAX + INNERVATE_TAG)

/** A session, and how it came about. */
typedef struct {
    innervate_session_t session;
    uint32_t age_ms;
    uint32_t quiet_ms; /* since something came in it; long, if nothing did */
    uint16_t who; /* the neighbour's number */
    uint8_t is_made; /* 0 = the place is free */
    uint8_t is_heard; /* 1 = something genuine has come in it */
    uint8_t is_ours; /* 1 = we asked */
} innervate_known_t;

/** The far end of one line; its fields are for looking at. */
typedef struct {
    const innervate_keys_t *keys;
    innervate_known_t known[INNERVATE_SESSIONS];
    uint8_t used; /* the session that seals what leaves, + 1; 0 = nobody is there yet */
    uint8_t has_asked; /* 1 = `secret` is drawn */
    uint8_t has_sent; /* 1 = a frame has left since something was heard */
    uint8_t network; /* its number under a seal */
    uint16_t number; /* our own */
    uint8_t life[INNERVATE_LIFE]; /* of our start */
    uint8_t secret[INNERVATE_KEY], point[INNERVATE_KEY]; /* drawn for our question */
    uint32_t index; /* under which we want frames of the session that comes of it */
    uint8_t answered[INNERVATE_KEY]; /* the point of the question that was answered last */
    uint8_t answer[INNERVATE_SAY_MAX]; /* the same question has the same answer */
    int32_t at; /* the clock at the last look */
    int32_t wait_ms; /* until the next */
    int32_t again_ms; /* between two questions */
    int32_t silent_ms; /* since a frame left that nothing came after */
} innervate_contact_t;

/** Begins: nobody is there yet. `life`: 8 bytes, drawn once for all lines of a node. */
void innervate_contact_begin(innervate_contact_t *contact, const innervate_keys_t *keys,
        uint8_t network, int32_t number, const uint8_t *life);

/** Asks who is there, again and again, or looks after a session. Returns how many bytes are to be
 * said in `out` (INNERVATE_SAY_MAX); call it whenever `wait_ms` have passed, or more often. */
int32_t innervate_contact_beat(innervate_contact_t *contact, int32_t now, uint8_t *out);

/** 1 if a frame can be sealed: somebody is there. */
int32_t innervate_contact_is_up(const innervate_contact_t *contact);

/** Seals a frame, as `innervate_close` does; 0 = nobody is there yet. */
int32_t innervate_contact_close(innervate_contact_t *contact, uint8_t *frame, int32_t count);

/** Takes what came in. Returns how many bytes of a frame begin at `bytes + INNERVATE_SEAL_HEAD`;
 * 0 = it was said below the protocol, -1 = it is not taken. `who`: whose frame it is. `said`: how
 * many bytes are to be said in `out`. */
int32_t innervate_contact_take(innervate_contact_t *contact, uint8_t *bytes, int32_t size,
        uint8_t *out, int32_t *said, int32_t *who);

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_CONTACT_H */
