/* A Betaflight task: spikes of the three turn rates out of a UART.
 *
 * `spikewire emit c --flight betaflight.toml -o spikes` makes both ends of betaflight.toml beside this file, as the library's
 * README shows: a header, betaflight.h, and an archive for the board's core, which is linked. Put this file into
 * src/main/telemetry/spikes.c and into the list of sources, add TASK_SPIKES to scheduler.h, and to fc/tasks.c
 *
 *     [TASK_SPIKES] = DEFINE_TASK("SPIKES", NULL, NULL, taskSpikes, TASK_PERIOD_HZ(1000), TASK_PRIORITY_MEDIUM),
 *
 * and in tasksInit: `setTaskEnabled(TASK_SPIKES, spikesInit());`. The UART must be free of any other function;
 * FUNCTION_SPIKES is the first of Betaflight's bits that stands for none. `spikewire listen --flight betaflight.toml` reads what
 * arrives.
 */
#include <string.h>
#include "platform.h"

#include "drivers/serial.h"
#include "io/serial.h"
#include "scheduler/scheduler.h"
#include "sensors/gyro.h"

#include "betaflight.h"

#define CHANNELS SW_BETAFLIGHT_CHANNELS
#define SPIKES_PORT SERIAL_PORT_USART3
#define FUNCTION_SPIKES ((serialPortFunction_e)(1 << 20))
/* A port has 256 bytes of buffer, or more: a frame must find room in that. */
#define FRAME 192u

static sw_betaflight_bank bank;
static uintptr_t storage[SW_QUEUE_WORDS(128)];
static sw_queue queue;
static sw_writer writer;
static serialPort_t *port;

bool spikesInit(void);
void taskSpikes(timeUs_t now);

bool spikesInit(void)
{
    if ((sw_betaflight_bank_start(&bank) != SW_OK) || (sw_queue_init(&queue, storage, sizeof storage) != SW_OK)) {
        return false;
    }
    port = openSerialPort(SPIKES_PORT, FUNCTION_SPIKES, NULL, NULL, 921600u, MODE_TX, SERIAL_NOT_INVERTED);
    return port != NULL;
}

void taskSpikes(timeUs_t now)
{
    static uint8_t frame[FRAME];
    static uint32_t sample;
    const sw_betaflight_sample rates[CHANNELS] = {gyro.gyroADCf[0], gyro.gyroADCf[1], gyro.gyroADCf[2]};
    size_t length = 0;

    /* The noise of 64 samples is the session, as no other start has it. */
    if (sample < 64u) {
        static uint64_t session;
        uint32_t bits;

        memcpy(&bits, &rates[sample % CHANNELS], sizeof bits);
        session = (session ^ bits) * 0x9E3779B97F4A7C15u;
        if (++sample == 64u) {
            (void)sw_betaflight_writer_init(&writer, session);
            sample = SW_BETAFLIGHT_KEYFRAME_EVERY * 64u; /* a keyframe comes first */
        }
        return;
    }
    (void)sw_betaflight_bank_encode(&bank, (uint32_t)now, rates, &queue);
    if ((sample % SW_BETAFLIGHT_KEYFRAME_EVERY) == 0u) {
        (void)sw_betaflight_bank_keyframes(&bank, (uint32_t)now, &queue);
    }
    ++sample;
    /* Only what the port takes at once: the task never waits. */
    (void)sw_writer_observe(&writer, (uint32_t)now);
    if ((serialTxBytesFree(port) >= FRAME) &&
        (sw_writer_next_frame(&writer, &queue, frame, sizeof frame, &length) == SW_OK)) {
        serialWriteBuf(port, frame, (int)length);
    }
}
