/* What check.c asks of an emulated board: QEMU's semihosting, a timer, a reset. */
#include <stddef.h>
#include <stdint.h>

#define BUFFER 16384U
#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))
enum { OPEN = 1, WRITE0 = 4, READ = 6, EXIT = 0x18 };

int main(void);
int read_script(void *to, uint32_t count);
void say(const char *text);
uint32_t tick_count(void);
void start_board(void);
void reset(void);
void *memcpy(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);

static uint8_t buffer[BUFFER];
static uint32_t at = BUFFER, had = BUFFER;
static uintptr_t file;

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

#ifdef __riscv
static uintptr_t ask(uintptr_t what, const void *arguments)
{
    register uintptr_t a0 __asm("a0") = what;
    register const void *a1 __asm("a1") = arguments;
    __asm volatile(".option push\n.option norvc\n.balign 16\nslli x0, x0, 0x1f\nebreak\n"
                   "srai x0, x0, 7\n.option pop\n" : "+r"(a0) : "r"(a1) : "memory");
    return a0;
}

__attribute__((naked, section(".vectors"), used)) void reset(void)
{
    __asm volatile("la sp, stack_top\ncall begin\n");
}
#else
static uintptr_t ask(uintptr_t what, const void *arguments)
{
    register uintptr_t r0 __asm("r0") = what;
    register const void *r1 __asm("r1") = arguments;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

extern uint32_t stack_top;
void begin(void);
void reset(void)
{
    begin();
}
__attribute__((section(".vectors"), used)) static void (*const vectors[4])(void) = {
    (void (*)(void))&stack_top, reset, 0, 0,
};
#define TIMER 0x40002004U /* counts down at 25 MHz */
#endif
#define FINISHED (const void *)0x20026

void begin(void);
__attribute__((used)) void begin(void)
{
    main();
    ask(EXIT, FINISHED);
    for (;;) {
    }
}

int read_script(void *to, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (at == had) {
            const uintptr_t arguments[3] = {file, (uintptr_t)buffer, BUFFER};
            had = BUFFER - (uint32_t)ask(READ, arguments);
            at = 0;
            if (had == 0) {
                return 0;
            }
        }
        ((uint8_t *)to)[i] = buffer[at];
        at++;
    }
    return 1;
}

void say(const char *text)
{
    ask(WRITE0, text);
}

uint32_t tick_count(void)
{
#ifdef __riscv
    return 0;
#else
    return REGISTER(TIMER);
#endif
}

void start_board(void)
{
    static const char name[] = "script";
    const uintptr_t arguments[3] = {(uintptr_t)name, 1, sizeof name - 1};
#ifndef __riscv
    REGISTER(0x40002000U) = 0xFFFFFFFFU;
    REGISTER(0x40002008U) = 0x80U | 2U;
#endif
    file = ask(OPEN, arguments);
}
