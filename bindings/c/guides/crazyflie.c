/* An app-layer file for the Crazyflie: spikes of the three turn rates to the ground, over the app channel.
 *
 * `spikewire emit c --flight crazyflie.toml -o spikes` makes both ends of crazyflie.toml beside this file, as the library's
 * README shows: SPIKEWIRE is a directory with its headers in include and its archive as lib/libspikewire.a. The rest is an app
 * as examples/app_hello_world of the firmware is one: its Makefile, its app-config with CONFIG_APP_STACKSIZE=600, and in its
 * Kbuild, with this file beside it as spikes.c,
 *
 *     obj-y += spikes.o spikewire.o
 *     ccflags-y += -I$(SPIKEWIRE)/include
 *     $(obj)/spikewire.o: $(SPIKEWIRE)/lib/libspikewire.a
 *     	$(LD) -r -nostdlib -Wl,--whole-archive $< -o $@
 *
 * The build knows no libraries, so that the archive becomes an object, of which the last link keeps what is called.
 * Then `make cf2_defconfig && make SPIKEWIRE=…`. The ground feeds what arrives to sw_crazyflie_receiver_take, or to
 * `spikewire listen --flight crazyflie.toml`.
 */
#include <string.h>
#include "FreeRTOS.h"
#include "app.h"
#include "app_channel.h"
#include "debug.h"
#include "log.h"
#include "task.h"

#include "crazyflie.h"

#define CHANNELS SW_CRAZYFLIE_CHANNELS
#define PERIOD_MS (SW_CRAZYFLIE_PERIOD / 1000u)

static sw_crazyflie_bank bank;
static uintptr_t storage[SW_QUEUE_WORDS(512)]; /* what gathers in 20 ms */
static sw_queue queue;
static sw_writer writer;

static sw_status start(uint64_t session)
{
    sw_status status = sw_crazyflie_bank_start(&bank);
    if (status == SW_OK) {
        status = sw_queue_init(&queue, storage, sizeof storage);
    }
    if (status == SW_OK) {
        status = sw_crazyflie_writer_init(&writer, session);
    }
    return status;
}

void appMain(void)
{
    static uint8_t frame[SW_MAX_FRAME];
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
        const uint32_t now = (uint32_t)(xTaskGetTickCount() * 1000u);
        sw_crazyflie_sample rates[CHANNELS];
        size_t length = 0;

        for (uint32_t i = 0; i < CHANNELS; ++i) {
            rates[i] = logGetFloat(gyro[i]);
        }
        (void)sw_crazyflie_bank_encode(&bank, now, rates, &queue);
        if ((sample % SW_CRAZYFLIE_KEYFRAME_EVERY) == 0u) {
            (void)sw_crazyflie_bank_keyframes(&bank, now, &queue);
        }
        /* A frame goes once its first event is 20 ms old, as `gathering` in the file says; the writer knows the time by this. */
        (void)sw_writer_observe(&writer, now);
        if (sw_writer_next_frame(&writer, &queue, frame, sizeof frame, &length) == SW_OK) {
            /* A packet of the radio is shorter than a frame, which a reader takes cut anywhere. */
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
