#pragma once
#include "platform.h"
typedef struct serialPort_s serialPort_t;
typedef void (*serialReceiveCallbackPtr)(uint16_t data, void *context);
typedef enum { MODE_TX = 2 } portMode_e;
typedef enum { SERIAL_NOT_INVERTED = 0 } portOptions_e;
uint32_t serialTxBytesFree(const serialPort_t *port);
void serialWriteBuf(serialPort_t *port, const uint8_t *data, int count);
