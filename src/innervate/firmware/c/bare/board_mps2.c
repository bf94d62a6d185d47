/* The board mps2-an385 (a Cortex-M3 at 25 MHz, five UARTs), as QEMU emulates it. */
#include "board.h"

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))
#define TICKS_PER_US 25U
#define PLACE(n) ((n) & (BOARD_RING - 1U))

/* UARTs: 0 data, 4 state (1 full, 2 received), 8 control, 12 interrupts, 16 divider. */
static const uint32_t uarts[5] = {
    0x40004000U, 0x40005000U, 0x40006000U, 0x40007000U, 0x40009000U,
};
static const uint8_t lines[5] = {0, 2, 4, 18, 20}; /* of their received bytes */
static volatile uint8_t ring[BOARD_UARTS][BOARD_RING];
static volatile uint8_t first[BOARD_UARTS], behind[BOARD_UARTS];
static uint32_t ticks, rest, clock;

#define TIMER 0x40002000U /* counts down from 2^32 at 25 MHz */
#define SYSTICK 0xE000E010U
#define ENABLE_INTERRUPTS 0xE000E100U

void board_start(void)
{
    for (int32_t i = 0; i < BOARD_UARTS; i++) {
        REGISTER(uarts[i] + 16U) = 16;
        REGISTER(uarts[i] + 8U) = 1U | 2U | 8U; /* send, receive, interrupt on received */
        REGISTER(ENABLE_INTERRUPTS) = 1U << lines[i];
    }
    REGISTER(TIMER) = 0xFFFFFFFFU;
    REGISTER(TIMER + 8U) = 0x80U | 2U; /* on, 32 bits, free running */
    ticks = REGISTER(TIMER + 4U);
}

int32_t board_now(void)
{
    const uint32_t seen = REGISTER(TIMER + 4U);
    const uint32_t passed = ticks - seen + rest;
    ticks = seen;
    clock += passed / TICKS_PER_US;
    rest = passed % TICKS_PER_US;
    return (int32_t)(clock & 0x3FFFFFFFU);
}

int32_t board_send(int32_t uart, const uint8_t *bytes, int32_t count)
{
    int32_t taken = 0;
    while (taken < count && !(REGISTER(uarts[uart] + 4U) & 1U)) {
        REGISTER(uarts[uart]) = bytes[taken];
        taken++;
    }
    return taken;
}

int32_t board_receive(int32_t uart, uint8_t *bytes, int32_t room)
{
    int32_t count = 0;
    while (count < room && first[uart] != behind[uart]) {
        bytes[count] = ring[uart][PLACE(first[uart])];
        first[uart]++;
        count++;
    }
    return count;
}

/*+ sealed */
#define OPEN 1 /* what a host is asked */
#define READ 6

static int32_t ask_host(int32_t what, const void *words)
{
    register int32_t r0 __asm__("r0") = what;
    register const void *r1 __asm__("r1") = words;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void board_random(uint8_t *bytes, int32_t count)
{
    static const char name[] = "/dev/urandom";
    static int32_t file = -1;
    if (file < 0) {
        const uintptr_t open[3] = {(uintptr_t)name, 1, sizeof name - 1};
        file = ask_host(OPEN, open);
    }
    const uintptr_t read[3] = {(uintptr_t)file, (uintptr_t)bytes, (uintptr_t)count};
    while (file < 0 || ask_host(READ, read) != 0) {
        /* without chance nothing is sealed */
    }
}

/*- */
void board_interrupt(void)
{
    for (int32_t i = 0; i < BOARD_UARTS; i++) {
        REGISTER(uarts[i] + 12U) = 2;
        while (REGISTER(uarts[i] + 4U) & 2U) {
            ring[i][PLACE(behind[i])] = (uint8_t)REGISTER(uarts[i]);
            behind[i]++;
        }
    }
}

void board_sleep(int32_t us)
{
    const uint32_t most = 600000;
    const uint32_t wait = (uint32_t)us < most ? (uint32_t)us : most;
    if (wait == 0) {
        return;
    }
    REGISTER(SYSTICK + 4U) = wait * TICKS_PER_US;
    REGISTER(SYSTICK + 8U) = 0;
    REGISTER(SYSTICK) = 7; /* on, with an interrupt, from the processor's clock */
    __asm volatile("cpsid i");
    for (int32_t i = 0; i < BOARD_UARTS; i++) {
        if (first[i] != behind[i]) {
            REGISTER(SYSTICK) = 0;
        }
    }
    if (REGISTER(SYSTICK) & 1U) {
        __asm volatile("wfi"); /* an interrupt that is due ends it, and is served below */
    }
    __asm volatile("cpsie i");
    REGISTER(SYSTICK) = 0;
}
