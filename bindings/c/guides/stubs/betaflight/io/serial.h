#pragma once
#include "drivers/serial.h"
typedef enum { SERIAL_PORT_USART3 = 53 } serialPortIdentifier_e;
typedef enum { FUNCTION_NONE = 0 } serialPortFunction_e;
serialPort_t *openSerialPort(serialPortIdentifier_e identifier, serialPortFunction_e function,
    serialReceiveCallbackPtr callback, void *context, uint32_t baudrate, portMode_e mode, portOptions_e options);
