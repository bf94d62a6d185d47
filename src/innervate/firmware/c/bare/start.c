/* Reset and interrupts of a Cortex-M, and what compilers call by themselves. */
#include <stddef.h>
#include <stdint.h>

extern uint32_t stack_top, data_load, data_begin, data_end, bss_begin, bss_end;
int main(void);
void board_interrupt(void);
void reset(void);
void *memcpy(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);

void *memcpy(void *to, const void *from, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        ((volatile uint8_t *)to)[i] = ((const uint8_t *)from)[i];
    }
    return to;
}

void *memset(void *to, int value, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        ((volatile uint8_t *)to)[i] = (uint8_t)value;
    }
    return to;
}

void reset(void)
{
    memcpy(&data_begin, &data_load, (uintptr_t)&data_end - (uintptr_t)&data_begin);
    memset(&bss_begin, 0, (uintptr_t)&bss_end - (uintptr_t)&bss_begin);
    main();
    for (;;) {
    }
}

static void stop(void)
{
    for (;;) {
    }
}

/* Stack, reset, faults, the beat (SysTick), 32 interrupts of the board. */
__attribute__((section(".vectors"), used)) static void (*const vectors[48])(void) = {
    (void (*)(void))&stack_top, reset, stop, stop, stop, stop, stop, 0, 0, 0, 0, stop, stop, 0,
    stop, board_interrupt,
    board_interrupt, board_interrupt, board_interrupt, board_interrupt, board_interrupt,
    board_interrupt, board_interrupt, board_interrupt, board_interrupt, board_interrupt,
    board_interrupt, board_interrupt, board_interrupt, board_interrupt, board_interrupt,
    board_interrupt, board_interrupt, board_interrupt, board_interrupt, board_interrupt,
    board_interrupt, board_interrupt, board_interrupt, board_interrupt, board_interrupt,
    board_interrupt, board_interrupt, board_interrupt, board_interrupt, board_interrupt,
    board_interrupt, board_interrupt,
};
