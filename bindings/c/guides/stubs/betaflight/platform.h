#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
typedef uint32_t timeUs_t;
uint32_t micros(void);
