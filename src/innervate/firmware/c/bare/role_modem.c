/* A station on a bare board: on UART 0 a radio modem, on UART 1 the station's user.
 *
 * Frames are stuffed as on any line; numbers have their lowest byte first, ages are microseconds.
 * From the modem: `C` cd, voc, age: the carrier came or went so long ago. `F` age, frame: received.
 * To it: `T` age, slots, frame: it was decided so long ago to send this. What the user says is a
 * packet to all; he hears sender (two bytes) and packet. */
#include "board.h"
#include "role_node.h"

#ifndef NUMBER
#define NUMBER 1 /* every station has another */
#endif
#ifndef SEED
#define SEED 334214459 /* 1 to 1072496638, on every station another, not near each other */
#endif
#define MODEM 0
#define USER 1
#define LINES 2
#define LINE_MAX (ROLE_SIZE_MAX + 9)

static role_node_t node;
static int32_t wait_us;
static uint8_t heard[LINES][LINE_MAX];
static uint8_t heard_count[LINES];

static int32_t port_now(void *user)
{
    (void)user;
    return board_now();
}

/* Puts a frame, which begins at `line + 1`, on a line, and waits until that has it. */
static void put(int32_t uart, uint8_t *line, int32_t count)
{
    const int32_t size = innervate_stuff(line + 1, count, line);
    for (int32_t at = 0; at < size;) {
        at += board_send(uart, line + at, size - at);
    }
}

static void port_send(void *user, int32_t at, const uint8_t *bytes, int32_t count, int32_t slots)
{
    uint8_t line[LINE_MAX];
    const int32_t age = (board_now() - at) & 0x3FFFFFFF;
    (void)user;
    line[1] = 'T';
    for (int32_t i = 0; i < 4; i++) {
        line[2 + i] = (uint8_t)((uint32_t)age >> (8 * i) & 255U);
    }
    line[6] = (uint8_t)(slots & 255);
    line[7] = (uint8_t)(slots >> 8);
    for (int32_t i = 0; i < count; i++) {
        line[8 + i] = bytes[i];
    }
    put(MODEM, line, 7 + count);
}

static void port_timer(void *user, int32_t in_us)
{
    (void)user;
    wait_us = in_us;
}

static void port_deliver(void *user, int32_t kind, const void *frame)
{
    uint8_t line[ROLE_PAYLOAD_MAX + 5];
    const int32_t source = ((const role_frame_t *)frame)->source;
    (void)user;
    (void)kind;
    line[1] = (uint8_t)(source & 255);
    line[2] = (uint8_t)(source >> 8);
    for (int32_t i = 0; i < node.payload_count; i++) {
        line[3 + i] = node.payload[i];
    }
    put(USER, line, 2 + node.payload_count);
}

/* The modem says something. */
static void modem_says(const uint8_t *said, int32_t count)
{
    const int32_t head = said[0] == 'C' ? 3 : 1;
    uint32_t age = 0;
    if (count < head + 4) {
        return;
    }
    for (int32_t i = 3; i >= 0; i--) {
        age = age << 8 | said[head + i];
    }
    const int32_t at = (board_now() - (int32_t)(age & 0x0FFFFFFFU)) & 0x3FFFFFFF;
    if (said[0] == 'C') {
        role_node_carrier(&node, at, said[1], said[2]);
    } else if (said[0] == 'F') {
        role_node_heard(&node, at, said + 5, count - 5);
    }
}

static void listen(int32_t uart)
{
    uint8_t byte;
    while (board_receive(uart, &byte, 1)) {
        const int32_t count = heard_count[uart];
        if (byte != 0) {
            if (count < LINE_MAX) {
                heard[uart][heard_count[uart]++] = byte;
            }
            continue;
        }
        heard_count[uart] = 0;
        const int32_t size = count < LINE_MAX ? innervate_unstuff(heard[uart], count) : -1;
        if (size > 0 && uart == MODEM) {
            modem_says(heard[uart], size);
        } else if (size > 0) {
            role_node_give(&node, heard[uart], size);
        }
    }
}

int main(void)
{
    static const innervate_air_t air = {port_now, port_send, port_timer, port_deliver, 0, 0};
    board_start();
    role_node_start(&node, &role_defaults, &air, NUMBER, SEED, 1);
    for (;;) {
        listen(USER);
        listen(MODEM);
        role_node_poll(&node);
        board_sleep(wait_us);
    }
}
