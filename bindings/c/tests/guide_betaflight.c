/* Betaflight's task on the host: a UART with a buffer of 256 bytes, which 921600 baud empty by 92 a millisecond. */
#include "betaflight.h"
#define GUIDE(name) sw_betaflight_##name
#include "guide_ground.h"

#include "platform.h"
#include "drivers/serial.h"
#include "io/serial.h"
#include "sensors/gyro.h"

#define BUFFER 256u

struct serialPort_s {
    uint32_t waiting;
};

bool spikesInit(void);
void taskSpikes(timeUs_t now);

gyro_t gyro;
static struct serialPort_s uart;
static ground receiver;
static int is_bad;

serialPort_t *openSerialPort(serialPortIdentifier_e identifier, serialPortFunction_e function,
    serialReceiveCallbackPtr callback, void *context, uint32_t baudrate, portMode_e mode, portOptions_e options)
{
    (void)callback;
    (void)context;
    (void)options;
    is_bad |= (identifier != SERIAL_PORT_USART3) || (function == FUNCTION_NONE) || (baudrate != 921600u) || (mode != MODE_TX);
    return &uart;
}

uint32_t serialTxBytesFree(const serialPort_t *port) { return BUFFER - 1u - port->waiting; }

void serialWriteBuf(serialPort_t *port, const uint8_t *data, int count)
{
    port->waiting += (uint32_t)count;
    is_bad |= port->waiting >= BUFFER; /* the task would wait */
    ground_take(&receiver, data, (size_t)count);
}

int main(void)
{
    ground_init(&receiver);
    is_bad = spikesInit() ? 0 : 1;
    for (uint32_t sample = 0; sample < 4000u; ++sample) {
        for (uint32_t axis = 0; axis < 3u; ++axis) {
            gyro.gyroADCf[axis] = turn_rate(sample, axis);
        }
        taskSpikes(sample * 1000u);
        uart.waiting -= (uart.waiting < 92u) ? uart.waiting : 92u;
    }
    return is_bad | ground_says(&receiver, "betaflight");
}
