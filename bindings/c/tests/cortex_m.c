/* A Cortex-M in an emulator: start-up, and a console by semihosting. No C library. */
#include "board.h"

extern uint32_t board_data_from[], board_data[], board_data_end[], board_bss[], board_bss_end[], board_stack[];

int main(void);

static uint32_t semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void board_print(const char *text)
{
    static uint32_t console;
    uint32_t length = 0;
    if (console == 0u) {
        const uintptr_t open[3] = {(uintptr_t)":tt", 4u, 3u};
        console = semihosting(0x01u, open);
    }
    while (text[length] != '\0') {
        ++length;
    }
    const uintptr_t write[3] = {console, (uintptr_t)text, length};
    (void)semihosting(0x05u, write);
}

void board_finish(int is_good)
{
    (void)semihosting(0x18u, (const void *)(is_good ? 0x20026u : 0x20023u));
    for (;;) {
    }
}

static void reset(void)
{
    const uint32_t *from = board_data_from;
    for (uint32_t *to = board_data; to < board_data_end; ++to) {
        *to = *from++;
    }
    for (uint32_t *to = board_bss; to < board_bss_end; ++to) {
        *to = 0;
    }
#if defined(__ARM_FP)
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm__ volatile("dsb\nisb");
#endif
    (void)main();
    board_finish(0);
}

static void fault(void)
{
    board_print("fault\n");
    board_finish(0);
}

typedef struct vectors {
    uint32_t *stack;
    void (*handlers[15])(void);
} vectors;

__attribute__((section(".vectors"), used)) const vectors VECTORS = {
    board_stack, {reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, 0, 0, fault, fault},
};
