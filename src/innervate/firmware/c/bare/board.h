/** What the example asks of a board: UARTs, a clock, sleep. */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

#ifndef BOARD_UARTS
#define BOARD_UARTS 5
#endif
#ifndef BOARD_RING
#define BOARD_RING 256 /* received bytes of a UART that wait, a power of two up to 256 */
#endif

/** Switches UARTs and clock on. */
void board_start(void);

/** Microseconds modulo 2^30. */
int32_t board_now(void);

/** Hands bytes to a UART; returns how many it took. */
int32_t board_send(int32_t uart, const uint8_t *bytes, int32_t count);

/** Takes what a UART has received; returns how many bytes, `room` at most. */
int32_t board_receive(int32_t uart, uint8_t *bytes, int32_t room);

/*+ sealed */
/** Random bytes: an emulated board asks its host for them (QEMU: -semihosting). Yours has a
 * generator in hardware, or none: then it must not seal. */
void board_random(uint8_t *bytes, int32_t count);

/*- */
/** Sleeps until something comes in, at most so long. */
void board_sleep(int32_t us);

#endif /* BOARD_H */
