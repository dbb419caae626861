#pragma once
#include <stddef.h>
#include <stdint.h>
typedef uint32_t TickType_t;
#define pdTRUE 1
#define M2T(ms) ((TickType_t)(ms))
