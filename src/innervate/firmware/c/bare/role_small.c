/* The least that a node on a bare board needs: its ports are UARTs 0 to 3. Fit it to your board. */
#include "board.h"
/*+ sealed */
#include "crypto/innervate_example.h"
/*- */
#include "role_node.h"

#ifndef NUMBER
#define NUMBER 1 /* every node has another */
#endif
/*+ sealed */
#ifndef KEY
#error "-DKEY=0x12,0x34,...: the network's key, 32 bytes, as in the node files' keys.secret.1"
#endif
/*- */
#ifndef SEED
#define SEED 334214459 /* 1 to 1072496638, on every node another, not near each other */
#endif

static role_node_t node;
/*+ gate */
#ifdef LEADS
static role_gate_t gate; /* what a node needs that leads */
#endif
/*- */
/*+ sealed */
static const innervate_crypto_t crypto = {0, innervate_example_close, innervate_example_open,
        innervate_example_x25519, innervate_example_sha256, innervate_example_blake2s,
        board_random};
static const innervate_keys_t keys = {&crypto, 1, {KEY}};
/*- */
static int32_t wait_us;

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
    (void)user;
    wait_us = in_us;
}

int main(void)
{
    static const innervate_port_t port = {port_now, port_send, port_timer, 0, 0, 0};
    board_start();
/*+ gate */
#ifdef LEADS
    node.gate = &gate;
#endif
/*- */
/*+ sealed */
    node.keys = &keys;
/*- */
    role_node_start(&node, &role_defaults, &port, NUMBER, SEED, 1);
    for (;;) {
        uint8_t bytes[4];
        for (int32_t uart = 0; uart < ROLE_PORTS_MAX; uart++) {
            const int32_t count = board_receive(uart, bytes, (int32_t)sizeof bytes);
            role_node_bytes(&node, uart, bytes, count);
        }
        role_node_poll(&node);
        board_sleep(wait_us);
    }
}
