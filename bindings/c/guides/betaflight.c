/* A Betaflight task: spikes of the three turn rates out of a UART.
 *
 * Put this file into src/main/telemetry/spikes.c and into the list of sources, add TASK_SPIKES to scheduler.h, and to
 * fc/tasks.c
 *
 *     [TASK_SPIKES] = DEFINE_TASK("SPIKES", NULL, NULL, taskSpikes, TASK_PERIOD_HZ(1000), TASK_PRIORITY_MEDIUM),
 *
 * and in tasksInit: `setTaskEnabled(TASK_SPIKES, spikesInit());`. Link lib/libspikewire.a of the board's core. The UART
 * must be free of any other function; FUNCTION_SPIKES is the first of Betaflight's bits that stands for none.
 */
#include <string.h>
#include "platform.h"

#include "drivers/serial.h"
#include "io/serial.h"
#include "scheduler/scheduler.h"
#include "sensors/gyro.h"

#include "spikewire/step_forward.h"

#define CHANNELS 3u
#define PERIOD_US 1000u
#define KEYFRAMES_A_SECOND 20u /* after a loss, values are exact again within 50 ms */
#define THRESHOLD 5.0f /* degrees a second */
#define SPIKES_PORT SERIAL_PORT_USART3
#define FUNCTION_SPIKES ((serialPortFunction_e)(1 << 20))
/* A port has 256 bytes of buffer, or more: a frame must find room in that. */
#define FRAME 192u

static sw_step_forward_f32 codec;
static sw_step_forward_f32_encoder encoders[CHANNELS];
static uintptr_t storage[SW_QUEUE_WORDS(128)];
static sw_queue queue;
static sw_writer writer;
static serialPort_t *port;

bool spikesInit(void);
void taskSpikes(timeUs_t now);

bool spikesInit(void)
{
    sw_error error;

    if (sw_step_forward_f32_init(&codec, THRESHOLD, &error) != SW_OK) {
        return false;
    }
    for (uint32_t i = 0; i < CHANNELS; ++i) {
        if (sw_step_forward_f32_encoder_start(&encoders[i], &codec) != SW_OK) {
            return false;
        }
    }
    if (sw_queue_init(&queue, storage, sizeof storage) != SW_OK) {
        return false;
    }
    port = openSerialPort(SPIKES_PORT, FUNCTION_SPIKES, NULL, NULL, 921600u, MODE_TX, SERIAL_NOT_INVERTED);
    return port != NULL;
}

void taskSpikes(timeUs_t now)
{
    static uint8_t frame[FRAME];
    static uint32_t sample;
    const sw_stamp stamp = {(uint32_t)now, 0u, 0u};
    const float rates[CHANNELS] = {gyro.gyroADCf[0], gyro.gyroADCf[1], gyro.gyroADCf[2]};
    int8_t codes[CHANNELS];
    size_t length = 0;

    /* The noise of 64 samples is the session, as no other start has it. */
    if (sample < 64u) {
        static uint64_t session;
        uint32_t bits;

        memcpy(&bits, &rates[sample % CHANNELS], sizeof bits);
        session = (session ^ bits) * 0x9E3779B97F4A7C15u;
        if (++sample == 64u) {
            (void)sw_writer_init(&writer, CHANNELS, PERIOD_US, session);
        }
        return;
    }
    (void)sw_step_forward_f32_bank(encoders, rates, codes, CHANNELS, &stamp, &queue);
    if ((sample % (1000000u / PERIOD_US / KEYFRAMES_A_SECOND)) == 0u) {
        (void)sw_step_forward_f32_keyframes(encoders, CHANNELS, &stamp, &queue);
    }
    ++sample;
    /* Only what the port takes at once: the task never waits. */
    if ((serialTxBytesFree(port) >= FRAME) &&
        (sw_writer_next_frame(&writer, &queue, frame, sizeof frame, &length) == SW_OK)) {
        serialWriteBuf(port, frame, (int)length);
    }
}
