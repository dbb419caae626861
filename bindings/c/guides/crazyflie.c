/* An app-layer file for the Crazyflie: spikes of the three turn rates to the ground, over the app channel.
 *
 * An app as examples/app_hello_world of the firmware is one: its Makefile, its app-config with CONFIG_APP_STACKSIZE=600,
 * and in its Kbuild, with this file beside it as spikes.c,
 *
 *     obj-y += spikes.o spikewire.o
 *     ccflags-y += -I$(SPIKEWIRE)/include
 *     $(obj)/spikewire.o: $(SPIKEWIRE)/lib/libspikewire.a
 *     	$(LD) -r -nostdlib -Wl,--whole-archive $< -o $@
 *
 * The build knows no libraries, so that the archive becomes an object, of which the last link keeps what is called.
 * Then `make cf2_defconfig && make SPIKEWIRE=…/target/c-library/cortex-m4`. The ground feeds what arrives to
 * sw_reader_take, or to `spikewire listen --from link`.
 */
#include <string.h>
#include "FreeRTOS.h"
#include "app.h"
#include "app_channel.h"
#include "debug.h"
#include "log.h"
#include "task.h"

#include "spikewire/step_forward.h"

#define CHANNELS 3u
#define PERIOD_MS 2u
#define KEYFRAMES_A_SECOND 20u /* after a loss, values are exact again within 50 ms */
#define THRESHOLD 5.0f /* degrees a second */

static sw_step_forward_f32 codec;
static sw_step_forward_f32_encoder encoders[CHANNELS];
static uintptr_t storage[SW_QUEUE_WORDS(128)];
static sw_queue queue;
static sw_writer writer;

static sw_status start(uint64_t session)
{
    sw_error error;
    sw_status status = sw_step_forward_f32_init(&codec, THRESHOLD, &error);
    for (uint32_t i = 0; (i < CHANNELS) && (status == SW_OK); ++i) {
        status = sw_step_forward_f32_encoder_start(&encoders[i], &codec);
    }
    if (status == SW_OK) {
        status = sw_queue_init(&queue, storage, sizeof storage);
    }
    if (status == SW_OK) {
        status = sw_writer_init(&writer, CHANNELS, PERIOD_MS * 1000u, session);
    }
    return status;
}

void appMain(void)
{
    static uint8_t frame[SW_MAX_FRAME];
    int8_t codes[CHANNELS];
    TickType_t woken = xTaskGetTickCount();
    const logVarId_t gyro[CHANNELS] = {
        logGetVarId("gyro", "x"), logGetVarId("gyro", "y"), logGetVarId("gyro", "z")};
    uint64_t session = 0;
    sw_status status;

    /* The noise of 64 samples, as no other start has it. */
    for (uint32_t sample = 0; sample < 64u; ++sample) {
        const float rate = logGetFloat(gyro[sample % CHANNELS]);
        uint32_t bits;

        memcpy(&bits, &rate, sizeof bits);
        session = (session ^ bits) * 0x9E3779B97F4A7C15u;
        vTaskDelayUntil(&woken, M2T(PERIOD_MS));
    }
    status = start(session);

    if (status != SW_OK) {
        DEBUG_PRINT("spikes: %s\n", sw_status_text(status));
        return;
    }
    for (uint32_t sample = 0;; ++sample) {
        const sw_stamp stamp = {(uint32_t)(xTaskGetTickCount() * 1000u), 0u, 0u};
        float rates[CHANNELS];
        size_t length = 0;

        for (uint32_t i = 0; i < CHANNELS; ++i) {
            rates[i] = logGetFloat(gyro[i]);
        }
        (void)sw_step_forward_f32_bank(encoders, rates, codes, CHANNELS, &stamp, &queue);
        if ((sample % (1000u / PERIOD_MS / KEYFRAMES_A_SECOND)) == 0u) {
            (void)sw_step_forward_f32_keyframes(encoders, CHANNELS, &stamp, &queue);
        }
        /* A packet of the radio is shorter than a frame, which a reader takes cut anywhere. */
        if (((sample % 10u) == 0u) && (sw_writer_next_frame(&writer, &queue, frame, sizeof frame, &length) == SW_OK)) {
            for (size_t at = 0; at < length; at += APPCHANNEL_MTU) {
                size_t rest = length - at;
                /* Without a radio there is no room: the rest is lost to the reader, which counts the frame as lost. */
                if (appchannelSendDataPacket(&frame[at], (rest < APPCHANNEL_MTU) ? rest : APPCHANNEL_MTU) != pdTRUE) {
                    break;
                }
            }
        }
        vTaskDelayUntil(&woken, M2T(PERIOD_MS));
    }
}
