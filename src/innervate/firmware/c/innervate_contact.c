/* First contact on a line (innervate/live/contact.py, keyring.py). */
#include "innervate_contact.h"

#define MASK30 0x3FFFFFFF
#define SECOND 0xC1
#define FIRST 0xD0 /* + the number of the key */
#define ANYBODY 0xFFU /* both bytes of whom it is for */
#define ALIVE 0 /* "are you there" */
#define ANSWER 1
#define ABOUT_MIN 16 /* bytes that every node says of itself */
#define ASK_MS 50 /* between two questions at first, doubling */
#define ASK_MS_MAX 1000
#define IDLE_MS 500
#define PROOF_MS 2000U /* a session of ours in which nothing came for so long never came about */
#define SILENT_MS 3000
#define RENEW_MS 600000U
#define OLD_MS (3U * RENEW_MS)

static void copy(uint8_t *to, const uint8_t *from, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        to[i] = from[i];
    }
}

/* 1 if bytes are the same; takes as long if they are not. */
static int32_t is_same(const uint8_t *one, const uint8_t *other, int32_t count)
{
    uint32_t differs = 0;
    for (int32_t i = 0; i < count; i++) {
        differs |= (uint32_t)(one[i] ^ other[i]);
    }
    return differs == 0;
}

/* The mark behind a message that only those make who have the key. */
static void mark(const innervate_contact_t *contact, uint8_t *out, const uint8_t *data,
        int32_t count)
{
    static const uint8_t name[] = "innervate mac";
    uint8_t key[INNERVATE_KEY];
    const innervate_keys_t *keys = contact->keys;
    keys->crypto->blake2s(key, INNERVATE_KEY, keys->key, name, (int32_t)sizeof name - 1);
    keys->crypto->blake2s(out, INNERVATE_TAG, key, data, count);
}

static int32_t close_message(const innervate_contact_t *contact, uint8_t *message, int32_t count)
{
    mark(contact, message + count, message, count);
    return count + INNERVATE_TAG;
}

static int32_t is_marked(const innervate_contact_t *contact, const uint8_t *message, int32_t size)
{
    uint8_t wanted[INNERVATE_TAG];
    mark(contact, wanted, message, size - INNERVATE_TAG);
    return is_same(wanted, message + size - INNERVATE_TAG, INNERVATE_TAG);
}

static void begin_noise(const innervate_contact_t *contact, innervate_noise_t *noise)
{
    uint8_t prologue[] = "innervate 2 network ?";
    const int32_t count = (int32_t)sizeof prologue - 1;
    prologue[count - 1] = contact->network;
    innervate_noise_begin(noise, contact->keys, prologue, count);
}

/* What we say of ourselves: number, for whom, life, index, and no names of a line's ends. */
static void say_about(const innervate_contact_t *contact, uint8_t *out, const uint8_t *to,
        uint32_t index)
{
    out[0] = (uint8_t)(contact->number >> 8);
    out[1] = (uint8_t)(contact->number & 255U);
    copy(out + 2, to, 2);
    copy(out + 4, contact->life, INNERVATE_LIFE);
    innervate_put_word(out + 12, index);
    out[16] = 0;
    out[17] = 0;
}

static uint32_t draw_index(const innervate_contact_t *contact)
{
    uint8_t bytes[4];
    contact->keys->crypto->random(bytes, 4);
    return innervate_get_word(bytes);
}

/* A place for a session: a free one, else the one that is not used and was quiet for longest. */
static innervate_known_t *place(innervate_contact_t *contact)
{
    innervate_known_t *found = 0;
    for (int32_t i = 0; i < INNERVATE_SESSIONS; i++) {
        innervate_known_t *known = &contact->known[i];
        if (!known->is_made) {
            return known;
        }
        if (i + 1 != contact->used && (!found || known->quiet_ms > found->quiet_ms)) {
            found = known;
        }
    }
    return found;
}

/* A session from a handshake that is finished, with what the other said of itself. */
static innervate_known_t *make(innervate_contact_t *contact, const innervate_noise_t *noise,
        const uint8_t *about, uint32_t own, int32_t is_ours)
{
    innervate_known_t *known = place(contact);
    innervate_session_t *session = &known->session;
    session->crypto = contact->keys->crypto;
    session->own = own;
    session->far = innervate_get_word(about + 12);
    session->counter = session->highest = session->window = 0;
    innervate_noise_split(noise, is_ours ? session->key_out : session->key_in,
            is_ours ? session->key_in : session->key_out);
    known->age_ms = 0;
    known->quiet_ms = OLD_MS;
    known->who = (uint16_t)((uint32_t)about[0] << 8 | about[1]);
    known->is_made = 1;
    known->is_heard = 0;
    known->is_ours = (uint8_t)is_ours;
    return known;
}

static void use(innervate_contact_t *contact, const innervate_known_t *known)
{
    contact->used = (uint8_t)(known - contact->known + 1);
    contact->has_sent = 0;
    contact->silent_ms = 0;
    contact->again_ms = ASK_MS;
    contact->wait_ms = ASK_MS;
}

static int32_t say_control(innervate_known_t *known, uint8_t kind, uint8_t *out)
{
    out[INNERVATE_SEAL_HEAD] = kind;
    return innervate_close(&known->session, INNERVATE_CONTROL, out, 1);
}

/* Our question, always the same until it is answered; what was mixed into it so far. */
static int32_t ask(const innervate_contact_t *contact, innervate_noise_t *noise, uint8_t *out)
{
    static const uint8_t anybody[2] = {ANYBODY, ANYBODY};
    begin_noise(contact, noise);
    out[0] = (uint8_t)(FIRST + contact->keys->number);
    say_about(contact, out + 1 + INNERVATE_KEY, anybody, contact->index);
    return 1 + innervate_noise_write(noise, out + 1, contact->point, INNERVATE_SAID);
}

static int32_t first(innervate_contact_t *contact, uint8_t *bytes, int32_t size, uint8_t *out)
{
    innervate_noise_t noise;
    uint8_t secret[INNERVATE_KEY];
    uint8_t *point = bytes + 1, *about = point + INNERVATE_KEY;
    if (contact->answer[0] == SECOND && is_same(point, contact->answered, INNERVATE_KEY)) {
        copy(out, contact->answer, INNERVATE_SAY_MAX);
        return INNERVATE_SAY_MAX;
    }
    begin_noise(contact, &noise);
    if (innervate_noise_read(&noise, point, size - 1 - INNERVATE_TAG) < ABOUT_MIN ||
            ((uint32_t)about[0] << 8 | about[1]) == contact->number) {
        return -1;
    }
    const uint32_t own = draw_index(contact);
    contact->keys->crypto->random(secret, INNERVATE_KEY);
    out[0] = SECOND;
    copy(out + 1, about + 12, 4);
    say_about(contact, out + 5 + INNERVATE_KEY, about, own);
    const int32_t count =
            innervate_noise_write_second(&noise, out + 5, INNERVATE_SAID, secret, point);
    if (count < 0) {
        return -1;
    }
    make(contact, &noise, about, own, 0);
    copy(contact->answered, point, INNERVATE_KEY);
    close_message(contact, out, 5 + count);
    copy(contact->answer, out, INNERVATE_SAY_MAX);
    return INNERVATE_SAY_MAX;
}

static int32_t second(innervate_contact_t *contact, uint8_t *bytes, int32_t size, uint8_t *out)
{
    innervate_noise_t noise;
    const uint8_t *about = bytes + 5 + INNERVATE_KEY;
    if (!contact->has_asked || innervate_get_word(bytes + 1) != contact->index) {
        return -1;
    }
    ask(contact, &noise, out);
    if (innervate_noise_read_second(&noise, bytes + 5, size - 5 - INNERVATE_TAG,
            contact->secret) < ABOUT_MIN ||
            ((uint32_t)about[0] << 8 | about[1]) == contact->number) {
        return -1;
    }
    contact->has_asked = 0;
    for (int32_t i = 0; i < INNERVATE_KEY; i++) {
        contact->secret[i] = 0; /* nobody who takes the board later shall have it */
    }
    innervate_known_t *known = make(contact, &noise, about, contact->index, 1);
    use(contact, known);
    return say_control(known, ALIVE, out);
}

/* What is sealed in a session: how many bytes of a frame, 0 = a control frame, -1 = not taken. */
static int32_t sealed(innervate_contact_t *contact, uint8_t *bytes, int32_t size, uint8_t *out,
        int32_t *said, int32_t *who)
{
    for (int32_t i = 0; i < INNERVATE_SESSIONS; i++) {
        innervate_known_t *known = &contact->known[i];
        const int32_t count = known->is_made ? innervate_open(&known->session, bytes, size) : -1;
        if (count < 0) {
            continue;
        }
        if (!known->is_heard && !known->is_ours) {
            use(contact, known);
        }
        known->is_heard = 1;
        known->quiet_ms = 0;
        contact->has_sent = 0;
        contact->silent_ms = 0;
        *who = known->who;
        if (bytes[0] == INNERVATE_FRAME) {
            return count > 0 ? count : -1;
        }
        if (count > 0 && bytes[INNERVATE_SEAL_HEAD] == ALIVE) {
            *said = say_control(known, ANSWER, out);
        }
        return 0;
    }
    return -1;
}

void innervate_contact_begin(innervate_contact_t *contact, const innervate_keys_t *keys,
        uint8_t network, int32_t number, const uint8_t *life)
{
    uint8_t *bytes = (uint8_t *)contact;
    for (uint32_t i = 0; i < sizeof *contact; i++) {
        bytes[i] = 0;
    }
    contact->keys = keys;
    contact->network = network;
    contact->number = (uint16_t)number;
    contact->again_ms = ASK_MS;
    copy(contact->life, life, INNERVATE_LIFE);
}

/* Lets time pass; forgets sessions that are too old, or of which nothing came. */
static void pass(innervate_contact_t *contact, int32_t ms)
{
    contact->wait_ms -= ms;
    contact->silent_ms += contact->has_sent ? ms : 0;
    for (int32_t i = 0; i < INNERVATE_SESSIONS; i++) {
        innervate_known_t *known = &contact->known[i];
        known->age_ms += (uint32_t)ms;
        known->quiet_ms += (uint32_t)ms;
        if (known->age_ms > OLD_MS ||
                (known->is_ours && !known->is_heard && known->age_ms > PROOF_MS)) {
            known->is_made = 0;
            contact->used = contact->used == i + 1 ? 0 : contact->used;
        }
    }
}

static int32_t wants_session(const innervate_contact_t *contact)
{
    if (contact->used == 0 || contact->silent_ms > SILENT_MS) {
        return 1;
    }
    const innervate_known_t *known = &contact->known[contact->used - 1];
    const uint32_t late = known->is_ours ? RENEW_MS : RENEW_MS / 5U * 6U;
    return known->age_ms > late || innervate_is_worn(&known->session);
}

int32_t innervate_contact_beat(innervate_contact_t *contact, int32_t now, uint8_t *out)
{
    const int32_t ms = ((now - contact->at) & MASK30) / 1000;
    contact->at = (contact->at + 1000 * ms) & MASK30;
    pass(contact, ms);
    if (contact->wait_ms > 0) {
        return 0;
    }
    if (wants_session(contact)) {
        innervate_noise_t noise;
        uint8_t chance;
        if (!contact->has_asked) {
            contact->keys->crypto->random(contact->secret, INNERVATE_KEY);
            innervate_point(contact->keys->crypto, contact->point, contact->secret);
            contact->index = draw_index(contact);
            contact->has_asked = 1;
        }
        contact->keys->crypto->random(&chance, 1);
        contact->wait_ms = contact->again_ms * (384 + chance) / 512; /* three to five quarters */
        contact->again_ms = contact->again_ms < ASK_MS_MAX / 2 ? 2 * contact->again_ms : ASK_MS_MAX;
        return close_message(contact, out, ask(contact, &noise, out));
    }
    innervate_known_t *known = &contact->known[contact->used - 1];
    contact->wait_ms = known->is_heard ? IDLE_MS : ASK_MS;
    return known->is_heard ? 0 : say_control(known, ALIVE, out);
}

int32_t innervate_contact_is_up(const innervate_contact_t *contact)
{
    return contact->used != 0 &&
            contact->known[contact->used - 1].session.counter < INNERVATE_COUNTERS;
}

int32_t innervate_contact_close(innervate_contact_t *contact, uint8_t *frame, int32_t count)
{
    if (!innervate_contact_is_up(contact)) {
        return 0;
    }
    contact->has_sent = 1;
    return innervate_close(&contact->known[contact->used - 1].session, INNERVATE_FRAME, frame,
            count);
}

int32_t innervate_contact_take(innervate_contact_t *contact, uint8_t *bytes, int32_t size,
        uint8_t *out, int32_t *said, int32_t *who)
{
    int32_t count = -1;
    *said = 0;
    if (size < INNERVATE_SEAL_MORE) {
        return -1;
    }
    if (bytes[0] == INNERVATE_FRAME || bytes[0] == INNERVATE_CONTROL) {
        return sealed(contact, bytes, size, out, said, who);
    }
    const int32_t begins = bytes[0] == FIRST + contact->keys->number;
    if ((begins || bytes[0] == SECOND) && size > 5 + INNERVATE_NOISE_MORE + INNERVATE_TAG &&
            is_marked(contact, bytes, size)) {
        count = (begins ? first : second)(contact, bytes, size, out);
    }
    *said = count < 0 ? 0 : count;
    return count < 0 ? -1 : 0;
}
