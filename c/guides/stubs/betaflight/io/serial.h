#pragma once
#include "drivers/serial.h"
typedef enum { SERIAL_PORT_USART1 = 0 } serialPortIdentifier_e;
typedef enum { FUNCTION_TELEMETRY_IBUS = 512 } serialPortFunction_e;
typedef struct serialPortConfig_s {
    serialPortIdentifier_e identifier;
} serialPortConfig_t;
const serialPortConfig_t *findSerialPortConfig(serialPortFunction_e function);
serialPort_t *openSerialPort(serialPortIdentifier_e identifier, serialPortFunction_e function,
    serialReceiveCallbackPtr callback, void *context, uint32_t baudrate, portMode_e mode, portOptions_e options);
