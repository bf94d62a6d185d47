/* Bytes and frames at will for a cell: nothing may be read or written beside its place. */
#include "skin_node.h"
#include <stdio.h>
#include <stdlib.h>

static uint32_t state = 1;
static int32_t clock_us;
static uint32_t sent, delivered;

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

static int32_t port_send(void *user, int32_t port, const uint8_t *bytes, int32_t count)
{
    (void)user;
    (void)port;
    (void)bytes;
    const int32_t is_full = (clock_us >> 20) & 1;
    const int32_t taken = is_full ? 0 : (int32_t)draw((uint32_t)count + 1U);
    sent += (uint32_t)taken;
    return taken;
}

static void port_deliver(void *user, int32_t kind, const void *frame)
{
    (void)user;
    (void)kind;
    delivered += frame != 0;
}

static int32_t drawn_frame(uint8_t *line)
{
    uint8_t data[SKIN_SIZE_MAX];
    skin_frame_t frame;
    uint8_t *bytes = (uint8_t *)&frame;
    for (uint32_t i = 0; i < sizeof frame; i++) {
        bytes[i] = (uint8_t)draw(256);
    }
    frame.kind = (uint8_t)(1 + draw(4));
    frame.cell = draw(2) ? 1 : 65535;
    frame.dist = (uint8_t)draw(draw(2) ? 4 : 256);
    return innervate_stuff(data, skin_encode(&frame, data), line);
}

int main(int count, char **words)
{
    static skin_node_t node;
    static const innervate_port_t port = {port_now, port_send, 0, port_deliver, 0, 0};
    const long pieces = count > 1 ? atol(words[1]) : 1000;
    skin_node_start(&node, &skin_defaults, &port, 1, 7, 0);
    for (long piece = 0; piece < pieces; piece++) {
        uint8_t line[64];
        int32_t size = (int32_t)draw(sizeof line);
        if (draw(2)) {
            size = drawn_frame(line);
            if (draw(4) == 0) {
                line[draw((uint32_t)size)] ^= (uint8_t)(1U << draw(8));
            }
        } else {
            for (int32_t i = 0; i < size; i++) {
                line[i] = (uint8_t)draw(draw(2) ? 4 : 256);
            }
        }
        skin_node_bytes(&node, (int32_t)draw(SKIN_PORTS_MAX), line, size);
        clock_us = (clock_us + (int32_t)draw(5000)) & 0x3FFFFFFF;
        skin_node_poll(&node);
        if (draw(10) == 0) {
            skin_node_give(&node, 1, &node.frame);
        }
    }
    printf("%u %u %u %u %d\n", (unsigned)sent, (unsigned)delivered, (unsigned)node.dropped,
            (unsigned)node.lost, node.broken);
    return 0;
}
