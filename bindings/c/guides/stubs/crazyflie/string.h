/* The compiler of the checks has no library of C; the firmware's has. */
#ifndef STRING_H
#define STRING_H
void *memcpy(void *to, const void *from, __SIZE_TYPE__ length);
#endif
