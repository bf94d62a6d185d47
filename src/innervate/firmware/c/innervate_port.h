/** What a driver asks of the board it runs on: a few functions, none of which waits. */
#ifndef INNERVATE_PORT_H
#define INNERVATE_PORT_H

#include <stdint.h>

typedef struct {
    /** Microseconds of a clock that wraps at 2^30, or at a multiple of it. */
    int32_t (*now)(void *user);
    /** Hands bytes to a port's UART; returns how many it took, from 0 on. */
    int32_t (*send)(void *user, int32_t port, const uint8_t *bytes, int32_t count);
    /** `poll` is wanted in so many microseconds at the latest; 0 = nobody asks (poll often). */
    void (*set_timer)(void *user, int32_t in_us);
    /** For the node's own user: what kind, and a pointer to the network's frame, which may be 0;
     * 0 = nobody listens. */
    void (*deliver)(void *user, int32_t kind, const void *frame);
    /** What the protocol says of itself; 0 = nobody listens. */
    void (*report)(void *user, int32_t code, int32_t a, int32_t b);
    void *user; /* what they are given */
} innervate_port_t;

/** The same of a radio, for stations on a channel. */
typedef struct {
    int32_t (*now)(void *user);
    /** A frame to send, of so many slots: decided at `at`, on the air a turnaround later. The radio
     * is deaf until it says a carrier again (or none). */
    void (*send)(void *user, int32_t at, const uint8_t *bytes, int32_t count, int32_t slots);
    void (*set_timer)(void *user, int32_t in_us);
    void (*deliver)(void *user, int32_t kind, const void *frame);
    void (*report)(void *user, int32_t code, int32_t a, int32_t b);
    void *user; /* what they are given */
} innervate_air_t;

#endif /* INNERVATE_PORT_H */
