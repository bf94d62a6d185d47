/* Bytes and frames at will for a node: nothing may be read or written beside its place. */
#include "role_node.h"
#include <stdio.h>
#include <stdlib.h>
#ifdef SEALED
#include "crypto/innervate_example.h"
#endif

#define LINE_MAX (2 * ROLE_SIZE_MAX + 8)

static uint32_t state = 1;
static int32_t clock_us;
static uint32_t sent, delivered, opened;
static role_node_t node;

static uint32_t draw(uint32_t n)
{
    state = state * 1664525U + 1013904223U;
    return (state >> 16) % n;
}

static int32_t port_now(void *user)
{
    (void)user;
    return clock_us;
}

static void port_deliver(void *user, int32_t kind, const void *frame)
{
    (void)user;
    (void)kind;
    delivered += frame != 0;
#ifdef AIR
    for (int32_t i = 0; i < node.payload_count; i++) {
        sent += node.payload[i] == 1;
    }
#endif
}

/* A frame that makes sense more often than chance would have it. */
static void draw_frame(role_frame_t *frame)
{
    uint8_t *bytes = (uint8_t *)frame;
    for (uint32_t i = 0; i < sizeof *frame; i++) {
        bytes[i] = (uint8_t)draw(draw(2) ? 4 : 256);
    }
    frame->kind = (uint8_t)(1 + draw(KINDS));
#ifdef MESH
    frame->kind = (uint8_t)(draw(4) ? frame->kind : ROLE_ACK);
    frame->link_src = (uint8_t)draw(4);
    frame->link_dst = draw(2) ? 1 : 255;
    frame->origin = (uint8_t)draw(4);
    frame->dest = (uint8_t)(frame->link_dst == 255 ? 255 : draw(4));
    frame->path_len = (uint8_t)(1 + draw(draw(8) ? 3 : 40));
    frame->length = (uint8_t)draw(draw(4) ? 20 : 130);
#endif
#ifdef SKIN
    frame->cell = draw(2) ? 1 : 65535;
    frame->dist = (uint8_t)draw(draw(2) ? 4 : 256);
#endif
#ifdef AIR
    frame->slots = (uint16_t)(1 + draw(20));
#endif
}

/* Bytes on the way: a frame, perhaps with a fault, or none. */
static int32_t drawn(uint8_t *data)
{
    role_frame_t frame;
    int32_t size = 0;
    if (draw(2)) {
        draw_frame(&frame);
#ifdef AIR
        const uint8_t payload[4] = {1, 2, 3, 4};
        const int32_t count = frame.kind == ROLE_DATA ? (int32_t)draw(5) : 0;
        size = role_encode(&frame, payload, count, data);
#else
        size = role_encode(&frame, data);
#endif
        if (size > 0 && draw(4) == 0) {
            data[draw((uint32_t)size)] ^= (uint8_t)(1U << draw(8));
            if (draw(2) && size > 2) {
                innervate_seal_crc(data, size);
            }
        }
    } else {
        size = (int32_t)draw(LINE_MAX - 4);
        for (int32_t i = 0; i < size; i++) {
            data[i] = (uint8_t)draw(draw(2) ? 4 : 256);
        }
        if (size > 2 && draw(2)) {
            innervate_seal_crc(data, size);
        }
    }
    return size;
}

#ifdef AIR
static void port_send(void *user, int32_t at, const uint8_t *bytes, int32_t count, int32_t slots)
{
    (void)user;
    (void)at;
    (void)slots;
    sent += (uint32_t)count + (bytes[count - 1] == 0);
}

static const innervate_air_t port = {port_now, port_send, 0, port_deliver, 0, 0};

static void step(void)
{
    uint8_t *data = malloc(LINE_MAX); /* its end is a wall */
    const int32_t size = drawn(data);
    data = realloc(data, (size_t)(size > 0 ? size : 1));
    const int32_t cd = (int32_t)draw(2);
    if (size > 0) {
        role_node_heard(&node, clock_us, data, size);
    }
    role_node_carrier(&node, clock_us, cd, cd ? (int32_t)draw(2) : 0);
    free(data);
    clock_us = (clock_us + (int32_t)draw(50000)) & 0x3FFFFFFF;
    role_node_poll(&node);
    if (draw(10) == 0) {
        const uint8_t packet[3] = {7, 8, 9};
        role_node_give(&node, packet, (int32_t)draw(4));
    }
}
#else
#ifdef SEALED
static innervate_contact_t peer[ROLE_PORTS_MAX]; /* the far ends, numbers 2.. */
static uint8_t heard[ROLE_PORTS_MAX][256], answer[ROLE_PORTS_MAX][INNERVATE_SAY_MAX];
static int32_t count_heard[ROLE_PORTS_MAX], count_answer[ROLE_PORTS_MAX];

static void chance(uint8_t *out, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        out[i] = (uint8_t)draw(256);
    }
}

static const innervate_crypto_t crypto = {0, innervate_example_close, innervate_example_open,
        innervate_example_x25519, innervate_example_sha256, innervate_example_blake2s, chance};
static const innervate_keys_t keys = {&crypto, 1, {1, 2, 3}};

/* The far end hears a byte; what it answers is said at the next step. */
static void hear(int32_t line, uint8_t byte)
{
    int32_t who;
    if (byte != 0) {
        heard[line][count_heard[line] < 255 ? count_heard[line]++ : 255] = byte;
        return;
    }
    const int32_t size = innervate_unstuff(heard[line], count_heard[line]);
    count_heard[line] = 0;
    if (innervate_contact_take(&peer[line], heard[line], size, answer[line], &count_answer[line],
            &who) > 0) {
        opened++;
    }
}

static void say(int32_t line, const uint8_t *bytes, int32_t count)
{
    uint8_t stuffed[INNERVATE_SAY_MAX + 2];
    if (count > 0) {
        role_node_bytes(&node, line, stuffed, innervate_stuff(bytes, count, stuffed));
    }
}

static void look_after_peers(void)
{
    for (int32_t line = 0; line < ROLE_PORTS_MAX; line++) {
        uint8_t out[INNERVATE_SAY_MAX];
        say(line, answer[line], count_answer[line]);
        count_answer[line] = 0;
        say(line, out, innervate_contact_beat(&peer[line], clock_us, out));
    }
}

/* What was drawn, as if the far end had said it. */
static int32_t close_drawn(int32_t line, uint8_t *data, int32_t size)
{
    for (int32_t i = size - 1; i >= 0; i--) {
        data[INNERVATE_SEAL_HEAD + i] = data[i];
    }
    return innervate_contact_close(&peer[line], data, size);
}
#endif

static int32_t port_send(void *user, int32_t line, const uint8_t *bytes, int32_t count)
{
    (void)user;
    const int32_t is_full = (clock_us >> 20) & 1;
    const int32_t taken = is_full ? 0 : (int32_t)draw((uint32_t)count + 1U);
    sent += (uint32_t)taken;
#ifdef SEALED
    for (int32_t i = 0; i < taken; i++) {
        hear(line, bytes[i]);
    }
#else
    (void)line;
    (void)bytes;
#endif
    return taken;
}

static const innervate_port_t port = {port_now, port_send, 0, port_deliver, 0, 0};

static void step(void)
{
    uint8_t data[LINE_MAX + 25], line[LINE_MAX + 27];
    int32_t size = drawn(data);
    const int32_t port_at = (int32_t)draw(ROLE_PORTS_MAX);
#ifdef SEALED
    look_after_peers();
    if (draw(4)) {
        size = close_drawn(port_at, data, size);
    }
#endif
    if (draw(2) && size < 254) {
        size = innervate_stuff(data, size, line);
        role_node_bytes(&node, port_at, line, size);
    } else {
        role_node_bytes(&node, port_at, data, size);
    }
    clock_us = (clock_us + (int32_t)draw(5000)) & 0x3FFFFFFF;
    role_node_poll(&node);
    if (draw(10) == 0) {
#ifdef MESH
        role_item_t item = {0};
        item.dest = (uint8_t)draw(4);
        item.flags = (uint8_t)draw(256);
        item.length = (uint8_t)draw(91);
        role_node_give(&node, 1, &item);
#else
        role_node_give(&node, 1, &node.frame);
#endif
    }
}
#endif

int main(int count, char **words)
{
    const long pieces = count > 1 ? atol(words[1]) : 1000;
#ifdef MESH
    static role_gate_t gate;
    node.gate = count > 2 ? &gate : 0;
#endif
#ifdef SEALED
    const uint8_t life[INNERVATE_LIFE] = {9};
    for (int32_t line = 0; line < ROLE_PORTS_MAX; line++) {
        innervate_contact_begin(&peer[line], &keys, KIND, 2 + line, life);
    }
    node.keys = &keys;
#endif
    role_node_start(&node, &role_defaults, &port, 1, 7, 0);
    for (long piece = 0; piece < pieces; piece++) {
        step();
    }
    int pretended = 0; /* frames that were taken from numbers which no far end has */
#if defined SEALED && defined MESH
    pretended = node.links.heard_on[0] + node.links.heard_on[1];
#endif
    printf("%u %u %u %u %u %d %d\n", (unsigned)sent, (unsigned)delivered, (unsigned)node.dropped,
            (unsigned)node.lost, (unsigned)opened, pretended, node.broken);
    return 0;
}
