/* A RISC-V core in an emulator: start-up, and a console by semihosting. No C library. */
#include "board.h"

extern uint32_t board_data_from[], board_data[], board_data_end[], board_bss[], board_bss_end[];

int main(void);

/* The three instructions that ask for it must lie together, uncompressed. */
__attribute__((noinline)) static uintptr_t semihosting(uintptr_t operation, const void *argument)
{
    register uintptr_t a0 __asm__("a0") = operation;
    register const void *a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n.option norvc\n.balign 16\n"
                     "slli zero, zero, 0x1f\nebreak\nsrai zero, zero, 7\n.option pop"
                     : "+r"(a0) : "r"(a1) : "memory");
    return a0;
}

void board_print(const char *text)
{
    static uintptr_t console;
    uintptr_t length = 0;
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
    const uintptr_t end[2] = {0x20026u, is_good ? 0u : 1u};
    (void)semihosting(0x20u, end);
    for (;;) {
    }
}

__attribute__((used)) static void begin(void)
{
    const uint32_t *from = board_data_from;
    for (uint32_t *to = board_data; to < board_data_end; ++to) {
        *to = *from++;
    }
    for (uint32_t *to = board_bss; to < board_bss_end; ++to) {
        *to = 0;
    }
    (void)main();
    board_finish(0);
}

__attribute__((naked, section(".vectors"), used)) void VECTORS(void)
{
    __asm__ volatile("la sp, board_stack\nj begin");
}
