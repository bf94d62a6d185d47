/* A node on a bare board: its ports are UARTs 0 to 3; on UART 4 somebody may look in.
 *
 * Frames of UART 4 are stuffed as on any line. In: `S` number, seed, cause: switch on. `I` kind,
 * item: the user hands something down. `?`: say the state. Out: `s` place, bytes of the state;
 * `d` kind, frame: for the user; `r` code, a, b: a report. Numbers have their lowest byte first,
 * records are as they lie in memory. */
#include "board.h"
#include "role_node.h"

#define LOOK 4
#define PIECE 192U /* bytes of the state in one frame */
#define HEARD_MAX 250

static role_node_t node;
static uint8_t heard[HEARD_MAX];
static int32_t heard_count;

static void copy(void *to, const void *from, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        ((uint8_t *)to)[i] = ((const uint8_t *)from)[i];
    }
}

/* Tells whoever looks in; waits for the line. */
static void tell(const uint8_t *data, uint32_t count)
{
    uint8_t line[HEARD_MAX + 2];
    const int32_t size = innervate_stuff(data, (int32_t)count, line);
    for (int32_t at = 0; at < size;) {
        at += board_send(LOOK, line + at, size - at);
    }
}

static int32_t port_now(void *user)
{
    (void)user;
    return board_now();
}

static int32_t port_send(void *user, int32_t port, const uint8_t *bytes, int32_t count)
{
    (void)user;
    return board_send(port, bytes, count);
}

static void port_timer(void *user, int32_t in_us)
{
    *(int32_t *)user = in_us;
}

static void port_deliver(void *user, int32_t kind, const void *frame)
{
    uint8_t said[2 + sizeof(role_frame_t)] = {'d', 0};
    (void)user;
    said[1] = (uint8_t)kind;
    if (frame) {
        copy(said + 2, frame, sizeof(role_frame_t));
        tell(said, sizeof said);
    }
}

static void port_report(void *user, int32_t code, int32_t a, int32_t b)
{
    uint8_t said[10] = {'r', 0};
    (void)user;
    said[1] = (uint8_t)code;
    copy(said + 2, &a, 4);
    copy(said + 6, &b, 4);
    tell(said, sizeof said);
}

static void say_state(void)
{
    uint8_t said[3 + PIECE] = {'s'};
    for (uint32_t at = 0; at < sizeof node.state; at += PIECE) {
        const uint32_t left = (uint32_t)sizeof node.state - at;
        const uint32_t count = left < PIECE ? left : PIECE;
        said[1] = (uint8_t)(at & 255U);
        said[2] = (uint8_t)(at >> 8);
        copy(said + 3, (const uint8_t *)&node.state + at, count);
        tell(said, 3 + count);
    }
}

/* Somebody who looks in asks or says something; 1 = the node runs from now on. */
static int32_t asked(const innervate_port_t *port, int32_t runs)
{
    const int32_t size = innervate_unstuff(heard, heard_count);
    heard_count = 0;
    if (size == 8 && heard[0] == 'S') {
        uint16_t number;
        int32_t seed;
        copy(&number, heard + 1, 2);
        copy(&seed, heard + 3, 4);
        role_node_start(&node, &role_defaults, port, number, seed, heard[7]);
        return 1;
    }
    if (runs && size == 2 + (int32_t)sizeof(role_item_t) && heard[0] == 'I') {
        role_item_t item;
        copy(&item, heard + 2, sizeof item);
        role_node_give(&node, heard[1], &item);
    } else if (runs && size == 1 && heard[0] == '?') {
        say_state();
    }
    return runs;
}

static int32_t look(const innervate_port_t *port, int32_t runs)
{
    uint8_t byte;
    while (board_receive(LOOK, &byte, 1)) {
        if (byte == 0) {
            runs = asked(port, runs);
        } else if (heard_count < HEARD_MAX) {
            heard[heard_count++] = byte;
        }
    }
    return runs;
}

int main(void)
{
    static int32_t wait;
    static const innervate_port_t port = {
        port_now, port_send, port_timer, port_deliver, port_report, &wait,
    };
    int32_t runs = 0;
    board_start();
    for (;;) {
        uint8_t bytes[32];
        runs = look(&port, runs);
        wait = 100000;
        if (runs) {
            for (int32_t uart = 0; uart < ROLE_PORTS_MAX; uart++) {
                const int32_t count = board_receive(uart, bytes, (int32_t)sizeof bytes);
                role_node_bytes(&node, uart, bytes, count);
            }
            role_node_poll(&node);
        }
        board_sleep(wait);
    }
}
