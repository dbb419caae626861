/* The ground of a guide's test: it reads what arrives, and says whether it is what was sent. GUIDE(name) is the name of a type or
 * function of the guide's flight. */
#ifndef GUIDE_GROUND_H
#define GUIDE_GROUND_H

#include <stdio.h>

typedef struct ground {
    sw_reader reader;
    GUIDE(receiver) receiver;
    uint32_t events;
    uint32_t keyframes;
} ground;

static void ground_item(void *context, const sw_item *item)
{
    ground *own = (ground *)context;
    own->events += (item->kind == SW_EVENT) ? 1u : 0u;
    own->keyframes += (item->kind == SW_KEYFRAME) ? 1u : 0u;
}

static void ground_init(ground *own)
{
    (void)sw_reader_init(&own->reader);
    (void)GUIDE(receiver_init)(&own->receiver);
}

static void ground_take(ground *own, const uint8_t *bytes, size_t length)
{
    (void)sw_reader_take(&own->reader, bytes, length, ground_item, own);
    (void)GUIDE(receiver_take)(&own->receiver, bytes, length, NULL, NULL);
}

/* 0 if frames with spikes came, keyframes of three channels twice a second for at least 2.5 s, no frame was lost or cut, and
 * the values are exact: sender and receiver are of one flight file. */
static int ground_says(const ground *own, const char *guide)
{
    sw_reader_counts counts;
    uint32_t exact = 0;
    for (uint16_t channel = 0; channel < 3u; ++channel) {
        GUIDE(sample) value;
        exact += (GUIDE(receiver_exact)(&own->receiver, channel, &value) == SW_OK) ? 1u : 0u;
    }
    (void)sw_reader_counts_of(&own->reader, &counts);
    (void)printf("%s: %u frames, %u events, %u keyframes, %u lost, %u skipped bytes, %u exact\n", guide, (unsigned)counts.frames,
        (unsigned)own->events, (unsigned)own->keyframes, (unsigned)counts.lost_frames, (unsigned)counts.skipped, (unsigned)exact);
    return ((counts.frames > 20u) && (own->events > 100u) && (own->keyframes >= 3u * 2u * 5u / 2u) && (exact == 3u) && (counts.lost_frames == 0u)
               && (counts.skipped == 0u))
        ? 0
        : 1;
}

/* A turn rate in degrees a second that swings, with noise as a sensor has it. */
static float turn_rate(uint32_t sample, uint32_t axis)
{
    static uint32_t noise = 1u;
    const uint32_t phase = (sample + axis * 37u) % 200u;
    noise = noise * 1664525u + 1013904223u;
    return ((phase < 100u) ? (float)phase : (float)(200u - phase)) + (float)(noise >> 24) * 0.001f;
}

#endif
