/*+ lines */
/** A node: the protocol, its frames on serial lines, its timers.
 *
 *     role_node_start(&node, &role_defaults, &port, number, seed, cause);
 *     for ever: role_node_bytes(&node, port, bytes, count) for what UARTs have received,
 *               role_node_poll(&node) every millisecond, or when `set_timer` says.
 *
 * All functions are called from one context: none from an interrupt. */
/*- */
/*+ air */
/** A station: the protocol, its packets, its timers; a radio sends and hears its frames.
 *
 *     role_node_start(&node, &role_defaults, &air, number, seed, cause);
 *     for ever: role_node_carrier and role_node_heard for what the radio says,
 *               role_node_poll(&node) every millisecond, or when `set_timer` says.
 *
 * All functions are called from one context: none from an interrupt. */
/*- */
#ifndef ROLE_NODE_H
#define ROLE_NODE_H

/*+ sealed */
#include "innervate_contact.h"
/*- */
#include "innervate_port.h"
#include "innervate_wire.h"
#include "role.h"
/*+ hooks */
#include "role_links.h"
/*- */
#include "role_wire.h"

#ifdef __cplusplus
extern "C" {
#endif

/*+ lines */
#ifndef ROLE_PORTS_MAX
/*+ cables */
#define ROLE_PORTS_MAX 4 /* serial lines */
/*- */
/*+ field */
#define ROLE_PORTS_MAX 2 /* serial lines: a modem that everybody near hears, or a neighbour each */
/*- */
#endif
/*+ clear */
#define ROLE_SENT_MAX ROLE_SIZE_MAX /* bytes of a frame on a line, */
#define ROLE_PIECE_MAX ROLE_SIZE_MAX /* and of all that can come in */
/*- */
/*+ sealed */
#define ROLE_SENT_MAX (ROLE_SIZE_MAX + INNERVATE_SEAL_MORE) /* bytes of a frame on a line, */
#define ROLE_PIECE_MAX \
    (ROLE_SENT_MAX > INNERVATE_HELLO_MAX ? ROLE_SENT_MAX : INNERVATE_HELLO_MAX) /* and of all */
/*- */
/*+ to */
#define ROLE_EVERYBODY 65535 /* whom a frame is for that is for all */
/*- */
/*+ rssi */
#define ROLE_LOUD (-50) /* dBm: of every frame, as a line does not say */
/*- */
#ifndef ROLE_QUEUE
#define ROLE_QUEUE (8 * ROLE_SENT_MAX + 3) /* bytes that wait for lines at most */
#endif

/** One end of a cable. */
typedef struct {
    uint8_t heard; /* bytes in `in`; more than fit = too long, wait for the zero */
    uint8_t begun; /* 1 = the first frame that waits for it is on the wire */
    uint8_t in[ROLE_PIECE_MAX + 2]; /* of the frame that comes in */
} role_line_t;

/*- */
/*+ air */
#define ROLE_PACKETS 16 /* that wait, or are on their way: the protocol's queue */
#define ROLE_PACKET 1 /* kind of input */
#define ROLE_SLOTS_MIN 3 /* of a packet: as many as it has bytes, and two for its CRC */
#ifndef ROLE_PACKET_MAX
#define ROLE_PACKET_MAX PACKET_BYTES /* bytes of a packet; payloads hold PER_TURN */
#endif

/** A packet that somebody wants sent. */
typedef struct {
    uint8_t count; /* bytes */
    uint8_t bytes[ROLE_PACKET_MAX];
} role_packet_t;

/*- */
/** A node; its fields are for looking at. */
typedef struct {
    role_state_t state;
    role_out_t out;
    role_frame_t frame; /* what came in */
/*+ lines */
    role_line_t line[ROLE_PORTS_MAX];
    uint16_t waiting; /* bytes in `queue` */
    uint8_t queue[ROLE_QUEUE]; /* frames for all lines: port + 1, what is left of it, a zero */
/*- */
/*+ air */
    role_packet_t packet[ROLE_PACKETS]; /* by the lowest bits of its handle */
    uint16_t handle; /* of the next one */
    int32_t at; /* when what a handler is told of was */
    const uint8_t *payload; /* of the frame that came in, while it is handled; 0 = none */
    int32_t payload_count; /* its bytes */
/*- */
/*+ to */
    uint16_t number; /* who we are */
/*- */
/*+ ends */
    uint8_t unended; /* own frames whose end the protocol was not told yet */
/*- */
/*+ hooks */
    role_links_t links;
/*- */
/*+ sealed */
    const innervate_keys_t *keys; /* set it before the start */
    innervate_contact_t contact[ROLE_PORTS_MAX];
/*- */
/*+ gate */
    role_gate_t *gate; /* set it before the start; 0 = this node never leads */
/*- */
    int32_t due[ROLE_TIMERS_MAX]; /* -1 = not set */
    const role_params_t *params;
    const INNERVATE_PORT *port;
    uint16_t dropped; /* pieces of a line that were no frame */
    uint16_t lost; /* frames for which there was no room */
    uint8_t broken; /* 1 = an outbox overflowed; the node stands still */
} role_node_t;

/** Switches on; seed: 1 to 1072496638, on every node another, not near each other. */
void role_node_start(role_node_t *node, const role_params_t *params, const INNERVATE_PORT *port,
        int32_t number, int32_t seed, int32_t cause);

/*+ lines */
/** Bytes have come in on a port. */
void role_node_bytes(role_node_t *node, int32_t port, const uint8_t *bytes, int32_t count);

/** Looks at timers, and hands UARTs what they take. */
void role_node_poll(role_node_t *node);

/** The node's user hands something down. */
void role_node_give(role_node_t *node, int32_t kind, const role_item_t *item);
/*- */
/*+ air */
/** The carrier came or went, or the radio listens again after it has sent: `cd` somebody is heard,
 * `voc` just one. `at`: when that was. */
void role_node_carrier(role_node_t *node, int32_t at, int32_t cd, int32_t voc);

/** A frame was received; its carrier's end is told after it. */
void role_node_heard(role_node_t *node, int32_t at, const uint8_t *bytes, int32_t count);

/** Looks at timers. */
void role_node_poll(role_node_t *node);

/** Sends a packet to all; 1, or 0 if too many wait or it is too long. */
int32_t role_node_give(role_node_t *node, const uint8_t *bytes, int32_t count);
/*- */

#ifdef __cplusplus
}
#endif

#endif /* ROLE_NODE_H */
