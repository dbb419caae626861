/* The Crazyflie's app on the host: three seconds with a radio, then one without, in which it must not wait. */
#include <setjmp.h>
#include "crazyflie.h"
#define GUIDE(name) sw_crazyflie_##name
#include "guide_ground.h"

#include "FreeRTOS.h"
#include "app.h"
#include "app_channel.h"
#include "debug.h"
#include "log.h"
#include "task.h"

static jmp_buf end;
static ground receiver;
static TickType_t now;
static uint32_t end_ms, refused, polls;
static int has_radio = 1;

TickType_t xTaskGetTickCount(void) { return now; }

void vTaskDelayUntil(TickType_t *woken, TickType_t period)
{
    *woken += period;
    now = *woken;
    if (now >= end_ms) {
        longjmp(end, 1);
    }
}

logVarId_t logGetVarId(const char *group, const char *name) { return (logVarId_t)((group[0] == 'g') ? name[0] - 'x' : 9); }

float logGetFloat(logVarId_t id)
{
    ++polls;
    return turn_rate(now / 2u, id);
}

int appchannelSendDataPacket(void *data, size_t length)
{
    if (!has_radio) {
        ++refused;
        return 0;
    }
    ground_take(&receiver, (const uint8_t *)data, length);
    return pdTRUE;
}

void debugPrint(const char *format, ...) { (void)puts(format); }

static void fly(uint32_t milliseconds)
{
    end_ms = now + milliseconds;
    if (setjmp(end) == 0) {
        appMain();
    }
}

int main(void)
{
    int is_bad;

    ground_init(&receiver);
    fly(3000u);
    is_bad = ground_says(&receiver, "crazyflie");
    has_radio = 0;
    polls = 0;
    fly(1000u);
    /* Three axes each 2 ms, and one of them before the session is known. */
    (void)printf("crazyflie without a radio: %u packets refused, %u polls\n", (unsigned)refused, (unsigned)polls);
    return ((is_bad == 0) && (refused > 10u) && (polls > 1200u)) ? 0 : 1;
}
