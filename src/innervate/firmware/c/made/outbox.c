/*+ struct */
/** The outbox: what a handler wants done, in this order. */
typedef struct {
    uint8_t count; /* actions */
    uint8_t overflow; /* 1 = one did not fit: a broken invariant, stop */
/*+ whole */
    uint8_t frames; /* how many are in use */
    uint8_t place[ROLE_OUTBOX]; /* by action: its frame + 1; 0 none */
    role_frame_t frame[ROLE_FRAMES];
/*- */
/*+ behind */
    uint16_t newest; /* as in `place` */
    uint16_t place[ROLE_OUTBOX]; /* by action: at which byte its frame begins, + 1; 0 none */
    union {
        role_frame_t first;
        uint8_t bytes[ROLE_FRAME_BYTES]; /* one behind the other, each up to where its
                                         * `@last` is in use: copy none as a whole */
    } frame;
/*- */
    role_action_t action[ROLE_OUTBOX];
} role_out_t;
/*- */
/*+ give */
/*+ whole */
/* The frame of an action: one of few, given out when it is first asked for. */
static role_frame_t *role_frame(role_out_t *out, int32_t action)
{
    if (out->place[action] == 0) {
        if (out->frames >= ROLE_FRAMES) {
            out->overflow = 1;
            return &out->frame[ROLE_FRAMES - 1];
        }
        out->frames++;
        out->place[action] = out->frames;
    }
    return &out->frame[out->place[action] - 1];
}
/*- */
/*+ behind */
static role_frame_t *role_frame_at(role_out_t *out, int32_t place)
{
    return (role_frame_t *)(void *)&out->frame.bytes[place - 1];
}

/* The frame of an action. When it is first asked for, it begins behind what the newest has of its
 * `@last`, to which nothing may be added from then on. */
static role_frame_t *role_frame(role_out_t *out, int32_t action)
{
    if (out->place[action] == 0) {
        int32_t at = 0;
        if (out->newest > 0) {
            const role_frame_t *newest = role_frame_at(out, out->newest);
            at = (int32_t)((const uint8_t *)&newest->@last[newest->@used] - out->frame.bytes);
            at = (at + @spare) & ~@spare;
        }
        if (at + (int32_t)sizeof(role_frame_t) > ROLE_FRAME_BYTES) {
            out->overflow = 1;
            at = 0;
        }
        out->newest = (uint16_t)(at + 1);
        out->place[action] = out->newest;
    }
    return role_frame_at(out, out->place[action]);
}
/*- */
/*- */
/*+ own */
void role_clear(role_out_t *out)
{
    out->count = 0;
    out->overflow = 0;
/*+ whole */
    out->frames = 0;
/*- */
/*+ behind */
    out->newest = 0;
/*- */
/*+ frames */
    for (int32_t i = 0; i < ROLE_OUTBOX; i++) {
        out->place[i] = 0;
    }
/*- */
}
/*+ frames */

const role_frame_t *role_frame_of(const role_out_t *out, int32_t action)
{
/*- */
/*+ whole */
    return out->place[action] ? &out->frame[out->place[action] - 1] : 0;
/*- */
/*+ behind */
    return out->place[action] ? (const role_frame_t *)(const void *)
            &out->frame.bytes[out->place[action] - 1] : 0;
/*- */
/*+ frames */
}
/*- */
/*- */
