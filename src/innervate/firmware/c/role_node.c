/*+ lines */
/* A node: the protocol, its frames on serial lines, its timers. */
/*- */
/*+ air */
/* A station: the protocol, its packets, its timers. */
/*- */
#include "role_node.h"

#define MASK30 0x3FFFFFFF
#define HALF30 0x20000000

static int32_t role_node_now(const role_node_t *node)
{
    return node->port->now(node->port->user) & MASK30;
}

/*+ lines */
/*+ clear */
#define MORE 3 /* bytes that a frame takes of the queue beside its own */
/*- */
/*+ sealed */
#define MORE (3 + INNERVATE_SEAL_MORE) /* bytes that a frame takes of the queue beside its own */
/*- */

/* Bytes of what stands at `at` in the queue: a port, a frame, a zero. */
static int32_t role_length(const role_node_t *node, int32_t at)
{
    int32_t length = 1;
    while (node->queue[at + length - 1] != 0) {
        length++;
    }
    return length;
}

/* Where the first frame for a port stands, from `at` on; behind all if there is none. */
static int32_t role_find(const role_node_t *node, int32_t at, int32_t port)
{
    while (at < node->waiting && node->queue[at] != port + 1) {
        at += role_length(node, at);
    }
    return at;
}

/* Takes bytes out of the queue. */
static void role_cut(role_node_t *node, int32_t at, int32_t count)
{
    node->waiting = (uint16_t)(node->waiting - count);
    for (int32_t i = at; i < node->waiting; i++) {
        node->queue[i] = node->queue[i + count];
    }
}

/* Drops the last frame for a port, from `at` on; 0 if there is none. */
static int32_t role_drop(role_node_t *node, int32_t at, int32_t port)
{
    int32_t last = -1, length = 0;
    while ((at = role_find(node, at + length, port)) < node->waiting) {
        last = at;
        length = role_length(node, at);
    }
    if (last >= 0) {
        role_cut(node, last, length);
    }
    return last >= 0;
}

/* Queues a frame: urgent ones behind what is on the wire, FLUSH drops what waits for the port. */
static void role_queue(role_node_t *node, int32_t port, const role_frame_t *frame, int32_t flags)
{
/*+ sealed */
    if (!innervate_contact_is_up(&node->contact[port])) {
        return; /* nobody is there yet */
    }
/*- */
    const int32_t count = role_size(frame) + MORE;
    int32_t at = role_find(node, 0, port);
    if (node->line[port].begun) {
        at = role_find(node, at + role_length(node, at), port);
    }
    while (((flags & ROLE_FLUSH) ||
            ((flags & ROLE_URGENT) && node->waiting + count > ROLE_QUEUE)) &&
            role_drop(node, at, port)) {
        node->lost = (uint16_t)(node->lost + !(flags & ROLE_FLUSH));
    }
    if (node->waiting + count > ROLE_QUEUE) {
        node->lost++;
        return;
    }
    if (!(flags & ROLE_URGENT)) {
        at = node->waiting;
    }
    for (int32_t i = node->waiting; i > at; i--) {
        node->queue[i - 1 + count] = node->queue[i - 1];
    }
    node->queue[at] = (uint8_t)(port + 1);
    uint8_t *const piece = node->queue + at + 2;
/*+ clear */
    innervate_stuff(piece, role_encode(frame, piece), piece - 1);
/*- */
/*+ sealed */
    innervate_stuff(piece, innervate_contact_close(&node->contact[port], piece,
            role_encode(frame, piece + INNERVATE_SEAL_HEAD)), piece - 1);
/*- */
    node->waiting = (uint16_t)(node->waiting + count);
}

/* Hands a UART what it takes. */
static void role_pump(role_node_t *node, int32_t port)
{
    int32_t at = role_find(node, 0, port);
    while (at < node->waiting) {
        const int32_t left = role_length(node, at) - 1;
        const int32_t taken = node->port->send(node->port->user, port, node->queue + at + 1, left);
        if (taken <= 0) {
            return;
        }
        node->line[port].begun = taken < left;
        if (taken < left) {
            role_cut(node, at + 1, taken);
        } else {
            role_cut(node, at, left + 1);
            at = role_find(node, at, port);
        }
    }
}

/*+ sealed */
/* Says something below the protocol, behind all that waits. */
static void role_say(role_node_t *node, int32_t port, const uint8_t *bytes, int32_t count)
{
    if (count > 0 && node->waiting + count + 3 <= ROLE_QUEUE) {
        node->queue[node->waiting] = (uint8_t)(port + 1);
        innervate_stuff(bytes, count, node->queue + node->waiting + 1);
        node->waiting = (uint16_t)(node->waiting + count + 3);
        role_pump(node, port);
    }
}

/*- */
/*- */
/*+ air */
/* Hands the radio a frame, with the packets in it. */
static void role_send(role_node_t *node, const role_frame_t *frame)
{
    uint8_t bytes[ROLE_SIZE_MAX], payload[ROLE_PAYLOAD_MAX];
    int32_t count = 0;
    for (int32_t k = 0; k < frame->count; k++) {
        const role_packet_t *packet = &node->packet[(frame->handle + k) % ROLE_PACKETS];
        for (int32_t i = 0; i < packet->count && count < ROLE_PAYLOAD_MAX; i++) {
            payload[count++] = packet->bytes[i];
        }
    }
    count = role_encode(frame, payload, count, bytes);
    node->port->send(node->port->user, node->at, bytes, count, frame->slots);
}

/*- */
/* Carries out what a handler wants done. */
static void role_drain(role_node_t *node)
{
    role_out_t *out = &node->out;
    for (int32_t i = 0; i < out->count; i++) {
        const role_action_t *act = &out->action[i];
        const role_frame_t *frame = role_frame_of(out, i);
        const int32_t a = act->a; /* port or timer */
        if (act->kind == ROLE_SEND && frame) {
/*+ air */
            role_send(node, frame);
/*- */
/*+ ports */
            if (a >= 0 && a < ROLE_PORTS_MAX) {
                role_queue(node, a, frame, act->c);
                role_pump(node, a);
            }
/*- */
/*+ hooks */
            for (int32_t port = 0; port < ROLE_PORTS_MAX; port++) {
                if (role_links_leaves(&node->links, port, frame, act->b)) {
                    role_queue(node, port, frame, act->c);
                    role_pump(node, port);
                }
            }
/*- */
/*+ field */
            for (int32_t port = 0; port < ROLE_PORTS_MAX; port++) {
                role_queue(node, port, frame, act->c);
                role_pump(node, port);
            }
/*+ ends */
            node->unended = (uint8_t)(node->unended + !(act->c & ROLE_URGENT));
/*- */
/*- */
        } else if (act->kind == ROLE_SET_TIMER && a >= 0 && a < ROLE_TIMERS_MAX) {
            node->due[a] = act->b;
        } else if (act->kind == ROLE_DELIVER && node->port->deliver) {
            node->port->deliver(node->port->user, a, frame);
        } else if (act->kind == ROLE_REPORT && node->port->report) {
            node->port->report(node->port->user, a, act->b, act->c);
        }
    }
    node->broken = node->broken || out->overflow;
    role_clear(out);
}

void role_node_start(role_node_t *node, const role_params_t *params, const INNERVATE_PORT *port,
        int32_t number, int32_t seed, int32_t cause)
{
    uint8_t *bytes = (uint8_t *)node;
/*+ gate */
    role_gate_t *const gate = node->gate;
/*- */
/*+ sealed */
    const innervate_keys_t *const keys = node->keys;
    uint8_t life[INNERVATE_LIFE];
/*- */
    for (uint32_t i = 0; i < sizeof *node; i++) {
        bytes[i] = 0;
    }
    node->params = params;
    node->port = port;
    for (int32_t timer = 0; timer < ROLE_TIMERS_MAX; timer++) {
        node->due[timer] = -1;
    }
    role_init(&node->state, number, seed);
/*+ to */
    node->number = (uint16_t)number;
/*- */
/*+ gate */
    node->gate = gate;
    if (gate) {
        role_init_gate(gate);
    }
/*- */
/*+ air */
    node->at = role_node_now(node);
/*- */
/*+ hooks */
    role_links_begin(&node->state, HAS_GATE);
/*- */
/*+ sealed */
    node->keys = keys;
    keys->crypto->random(life, INNERVATE_LIFE);
    for (int32_t line = 0; line < ROLE_PORTS_MAX; line++) {
        innervate_contact_begin(&node->contact[line], keys, KEY_KIND, number, life);
    }
/*- */
    role_clear(&node->out);
    role_on_start(&node->state, /*gate*/params, role_node_now(node), cause, &node->out);
    role_drain(node);
}

/*+ lines */
/* A piece of a line between two zeros. */
static void role_piece(role_node_t *node, int32_t port, uint8_t *bytes, int32_t count)
{
    int32_t size = count > ROLE_PIECE_MAX + 1 ? -1 : innervate_unstuff(bytes, count);
/*+ sealed */
    uint8_t out[INNERVATE_SAY_MAX];
    int32_t said, who = 0;
    size = innervate_contact_take(&node->contact[port], bytes, size, out, &said, &who);
    role_say(node, port, out, said);
    if (size == 0) {
        return;
    }
    bytes += INNERVATE_SEAL_HEAD;
/*- */
    if (size < 0 || role_decode(bytes, size, &node->frame) != ROLE_OK) {
        node->dropped++;
        return;
    }
/*+ hooks */
/*+ sealed */
    if (!role_links_is_from(&node->frame, who)) {
        node->dropped++;
        return;
    }
/*- */
    role_links_heard(&node->links, port, &node->frame);
/*- */
/*+ to */
    if (node->frame.to != ROLE_EVERYBODY && node->frame.to != node->number) {
        return;
    }
/*- */
/*+ rssi */
    node->frame.rssi = ROLE_LOUD;
/*- */
/*+ field */
    port = 0; /* it came by the air */
/*- */
    const int32_t now = role_node_now(node);
    role_on_frame(&node->state, /*gate*/node->params, now, port, &node->frame, &node->out);
    role_drain(node);
}

void role_node_bytes(role_node_t *node, int32_t port, const uint8_t *bytes, int32_t count)
{
    role_line_t *line = &node->line[port];
    for (int32_t i = 0; i < count && !node->broken; i++) {
        if (bytes[i] != 0) {
            if (line->heard < ROLE_PIECE_MAX + 2) {
                line->in[line->heard++] = bytes[i];
            }
        } else if (line->heard > 0) {
            const uint8_t heard = line->heard;
            line->heard = 0;
            role_piece(node, port, line->in, heard);
        }
    }
}

/*- */
/*+ air */
void role_node_carrier(role_node_t *node, int32_t at, int32_t cd, int32_t voc)
{
    if (!node->broken) {
        node->at = at & MASK30;
        role_on_carrier(&node->state, node->params, node->at, cd, voc, &node->out);
        role_drain(node);
    }
}

void role_node_heard(role_node_t *node, int32_t at, const uint8_t *bytes, int32_t count)
{
    if (node->broken || role_decode(bytes, count, &node->frame) != ROLE_OK) {
        node->dropped++;
        return;
    }
    node->at = at & MASK30;
    if (node->frame.count > 0 && count > ROLE_PAYLOAD_AT + 2) {
        node->payload = bytes + ROLE_PAYLOAD_AT;
        node->payload_count = count - ROLE_PAYLOAD_AT - 2;
    }
    role_on_frame(&node->state, node->params, node->at, 0, &node->frame, &node->out);
    role_drain(node);
    node->payload = 0;
    node->payload_count = 0;
}

/*- */
void role_node_poll(role_node_t *node)
{
    int32_t soonest = HALF30;
/*+ lines */
    for (int32_t port = 0; port < ROLE_PORTS_MAX; port++) {
/*+ sealed */
        uint8_t out[INNERVATE_SAY_MAX];
        innervate_contact_t *const contact = &node->contact[port];
        role_say(node, port, out, innervate_contact_beat(contact, role_node_now(node), out));
        soonest = 1000 * contact->wait_ms < soonest ? 1000 * contact->wait_ms : soonest;
/*- */
        role_pump(node, port);
    }
/*+ ends */
    for (int32_t left = node->unended; left > 0 && node->waiting == 0 && !node->broken; left--) {
        node->unended--;
/*+ sent */
        role_on_sent(&node->state, node->params, role_node_now(node), 1, &node->out);
/*- */
/*+ carrier */
        role_on_carrier(&node->state, node->params, role_node_now(node), 0, 0, &node->out);
/*- */
        role_drain(node);
    }
    soonest = node->unended > 0 ? 1000 : soonest;
/*- */
/*- */
    for (int32_t timer = 0; timer < ROLE_TIMERS_MAX && !node->broken; timer++) {
        const int32_t now = role_node_now(node);
        if (node->due[timer] >= 0 && ((now - node->due[timer]) & MASK30) < HALF30) {
            node->due[timer] = -1;
/*+ air */
            node->at = now;
/*- */
            role_on_timer(&node->state, /*gate*/node->params, now, timer, &node->out);
            role_drain(node);
        }
    }
    for (int32_t timer = 0; timer < ROLE_TIMERS_MAX; timer++) {
        if (node->due[timer] >= 0) {
            const int32_t left = (node->due[timer] - role_node_now(node)) & MASK30;
            const int32_t wait = left < HALF30 ? left : 0;
            soonest = wait < soonest ? wait : soonest;
        }
    }
    if (node->port->set_timer) {
        node->port->set_timer(node->port->user, soonest);
    }
}

/*+ lines */
void role_node_give(role_node_t *node, int32_t kind, const role_item_t *item)
{
    if (!node->broken) {
        const int32_t now = role_node_now(node);
/*+ keeps */
        role_on_input(&node->state, /*gate*/node->params, now, kind, item, &node->out);
/*- */
/*+ writes */
        role_item_t own = *item; /* which the protocol writes into */
        role_on_input(&node->state, /*gate*/node->params, now, kind, &own, &node->out);
/*- */
        role_drain(node);
    }
}
/*- */
/*+ air */
int32_t role_node_give(role_node_t *node, const uint8_t *bytes, int32_t count)
{
    role_packet_t *packet = &node->packet[node->handle % ROLE_PACKETS];
    role_item_t item;
    if (node->broken || count < 0 || count > ROLE_PACKET_MAX ||
            node->state.queued >= ROLE_PACKETS) {
        return 0;
    }
    packet->count = (uint8_t)count;
    for (int32_t i = 0; i < count; i++) {
        packet->bytes[i] = bytes[i];
    }
    item.slots = (uint16_t)(count + 2 > ROLE_SLOTS_MIN ? count + 2 : ROLE_SLOTS_MIN);
    item.handle = node->handle++;
    item.ago = 0;
    node->at = role_node_now(node);
    role_on_input(&node->state, node->params, node->at, ROLE_PACKET, &item, &node->out);
    role_drain(node);
    return 1;
}
/*- */
