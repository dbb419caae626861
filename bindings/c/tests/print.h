/* Numbers as text, without a C library. */
#ifndef PRINT_H
#define PRINT_H

#include "board.h"

static void print_number(uint64_t number, uint32_t base, uint32_t digits)
{
    char text[24];
    uint32_t at = sizeof text - 1u;
    text[at] = '\0';
    do {
        text[--at] = "0123456789abcdef"[number % base];
        number /= base;
    } while (number > 0u || at + digits > sizeof text - 1u);
    board_print(&text[at]);
}

#endif
