/* Over which of several lines a frame leaves (innervate/networks/mesh/live/stack.py). */
#include "role_links.h"

void role_links_begin(role_state_t *state, int32_t leads)
{
    state->rank = leads ? 0 : -1;
}

void role_links_heard(role_links_t *links, int32_t port, role_frame_t *frame)
{
    if (frame->link_src < ROLE_NODES) {
        links->heard_on[frame->link_src] = (uint8_t)(port + 1);
    }
    if (frame->kind != ROLE_ACK) { /* acks tell how loud the frame was that they are for */
        frame->rssi = ROLE_LOUD;
    }
}

int32_t role_links_is_from(const role_frame_t *frame, int32_t who)
{
    return frame->link_src == who;
}

int32_t role_links_leaves(const role_links_t *links, int32_t port, const role_frame_t *frame,
        int32_t attempt)
{
    const int32_t known =
            frame->link_dst < ROLE_NODES ? links->heard_on[frame->link_dst] : 0;
    return known == 0 || attempt > 0 || known == port + 1;
}
