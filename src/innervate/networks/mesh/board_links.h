/** role: over which of several lines a frame leaves, and how those that come in are heard. */
#ifndef ROLE_LINKS_H
#define ROLE_LINKS_H

#include "role.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef ROLE_PORTS_MAX
#define ROLE_PORTS_MAX 2 /* serial lines */
#endif
#define ROLE_LOUD (-50) /* dBm: of every frame that comes over a cable */

typedef struct {
    uint8_t heard_on[ROLE_NODES]; /* by neighbour: the line where it was heard last, + 1; 0 none */
} role_links_t;

/** Before a start: whether this node is the gateway. */
void role_links_begin(role_state_t *state, int32_t leads);

/** A frame came in on a line. */
void role_links_heard(role_links_t *links, int32_t port, role_frame_t *frame);

/** 1 if a frame is from whom it says: `who` has sealed it. */
int32_t role_links_is_from(const role_frame_t *frame, int32_t who);

/** 1 if a frame leaves by a line: where its receiver was heard last; by all if that is not known,
 * if it is for all, or if it was sent in vain before. */
int32_t role_links_leaves(const role_links_t *links, int32_t port, const role_frame_t *frame,
        int32_t attempt);

#ifdef __cplusplus
}
#endif

#endif /* ROLE_LINKS_H */
