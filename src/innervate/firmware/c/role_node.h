/** A node: the protocol, its frames on serial lines, its timers.
 *
 *     role_node_start(&node, &role_defaults, &port, number, seed, cause);
 *     for ever: role_node_bytes(&node, port, bytes, count) for what UARTs have received,
 *               role_node_poll(&node) every millisecond, or when `set_timer` says.
 *
 * All five functions are called from one context: none from an interrupt. */
#ifndef ROLE_NODE_H
#define ROLE_NODE_H

#include "innervate_port.h"
#include "innervate_wire.h"
#include "role.h"
#include "role_wire.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef ROLE_PORTS_MAX
#define ROLE_PORTS_MAX 4 /* serial lines */
#endif
#ifndef ROLE_QUEUE
#define ROLE_QUEUE 64 /* bytes that wait for a line at most: some frames */
#endif

/** One end of a cable. */
typedef struct {
    uint8_t in[ROLE_SIZE_MAX + 2]; /* of the frame that comes in */
    uint8_t out[ROLE_QUEUE]; /* whole frames that wait, the first perhaps begun */
    uint8_t heard; /* bytes in `in`; more than fit = too long, wait for the zero */
    uint8_t waiting; /* bytes in `out` */
    uint8_t begun; /* 1 = the first frame in `out` is on the wire */
} role_line_t;

/** A node; its fields are for looking at. */
typedef struct {
    role_state_t state;
    role_out_t out;
    role_frame_t frame; /* what came in */
    role_line_t line[ROLE_PORTS_MAX];
    int32_t due[ROLE_TIMERS_MAX]; /* -1 = not set */
    const role_params_t *params;
    const innervate_port_t *port;
    uint32_t dropped; /* pieces of a line that were no frame */
    uint32_t lost; /* frames for which there was no room */
    uint8_t broken; /* 1 = an outbox overflowed; the node stands still */
} role_node_t;

/** Switches on; seed: 1 to 1072496638, on every node another, not near each other. */
void role_node_start(role_node_t *node, const role_params_t *params, const innervate_port_t *port,
        int32_t number, int32_t seed, int32_t cause);

/** Bytes have come in on a port. */
void role_node_bytes(role_node_t *node, int32_t port, const uint8_t *bytes, int32_t count);

/** Looks at timers, and hands UARTs what they take. */
void role_node_poll(role_node_t *node);

/** The node's user hands something down. */
void role_node_give(role_node_t *node, int32_t kind, const role_item_t *item);

#ifdef __cplusplus
}
#endif

#endif /* ROLE_NODE_H */
