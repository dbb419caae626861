/* What a test needs from its surroundings: somewhere to print to, and an ending. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

void board_print(const char *text);
void board_finish(int is_good);

#endif
