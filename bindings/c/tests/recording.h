/* The recorded flight in each sample type, and what its channels' calibrations tell. */
#ifndef RECORDING_H
#define RECORDING_H

#include "print.h"
#include "spikewire.h"

#define CHANNELS 6u
#define RECORD (4u + (4u * CHANNELS))

extern const uint8_t recording[], recording_end[];

static int is_good = 1;

static void check(sw_status status, const char *what)
{
    if (status < 0) {
        board_print(what);
        board_print(": ");
        board_print(sw_status_text(status));
        board_print("\n");
        is_good = 0;
    }
}

static size_t samples(void) { return (size_t)(recording_end - recording) / RECORD; }

static float recorded(size_t index, uint32_t channel)
{
    const uint8_t *at = &recording[(index * RECORD) + 4u + (4u * channel)];
    union {
        uint32_t bits;
        float value;
    } both;
    both.bits = (uint32_t)at[0] | ((uint32_t)at[1] << 8) | ((uint32_t)at[2] << 16) | ((uint32_t)at[3] << 24);
    return both.value;
}

/* The nearest whole number, halves upwards, within limits. */
static inline int32_t nearest(double value, double least, double largest)
{
    double rounded = value + 0.5;
    if (rounded < least) {
        return (int32_t)least;
    }
    if (rounded >= largest + 1.0) {
        return (int32_t)largest;
    }
    int64_t whole = (int64_t)rounded;
    return (int32_t)(((double)whole > rounded) ? whole - 1 : whole);
}

typedef float value_type_f32;
typedef int16_t value_type_i16;
typedef sw_q8_8 value_type_q8_8;
typedef sw_q16_16 value_type_q16_16;

#define ONE_f32 1.0
#define ONE_i16 1.0
#define ONE_q8_8 256.0
#define ONE_q16_16 65536.0

/* Counts of an inertial sensor at its widest ranges, 2000 degrees a second and 16 g. */
static inline double unit_i16(uint32_t channel)
{
    return (channel < 3u) ? 32768.0 / 2000.0 * 57.29577951308232 : 32768.0 / 16.0 / 9.80665;
}
static inline double unit_none(uint32_t channel)
{
    (void)channel;
    return 1.0;
}
#define UNIT_f32 unit_none
#define UNIT_i16 unit_i16
#define UNIT_q8_8 unit_none
#define UNIT_q16_16 unit_none

#define FROM_f32(value) ((float)(value))
#define FROM_i16(value) ((int16_t)nearest((value), -32768.0, 32767.0))
#define FROM_q8_8(value) ((sw_q8_8)nearest((value) * 256.0, -32768.0, 32767.0))
#define FROM_q16_16(value) ((sw_q16_16)nearest((value) * 65536.0, -2147483648.0, 2147483647.0))

/* A channel in a sample type: its samples, and what its calibration tells. */
#define CHANNEL(S, SAMPLE)                                                                                            \
    typedef struct channel_##S {                                                                                      \
        uint32_t index;                                                                                               \
        SAMPLE min;                                                                                                   \
        SAMPLE max;                                                                                                   \
        sw_calibration_##S calibration;                                                                               \
    } channel_##S;                                                                                                    \
    static SAMPLE at_##S(size_t index, uint32_t channel)                                                              \
    {                                                                                                                 \
        return FROM_##S((double)recorded(index, channel) * UNIT_##S(channel));                                        \
    }                                                                                                                 \
    static double value_##S(SAMPLE sample) { return (double)sample / ONE_##S; }                                       \
    static inline SAMPLE fraction_##S(const channel_##S *channel, double part)                                        \
    {                                                                                                                 \
        return FROM_##S((value_##S(channel->max) - value_##S(channel->min)) * part);                                  \
    }                                                                                                                 \
    static channel_##S channels_##S[CHANNELS];                                                                        \
    static void calibrate_##S(void)                                                                                   \
    {                                                                                                                 \
        for (uint32_t index = 0; index < CHANNELS; ++index) {                                                         \
            channel_##S *channel = &channels_##S[index];                                                              \
            channel->index = index;                                                                                   \
            check(sw_calibration_##S##_init(&channel->calibration), "calibration");                                   \
            for (size_t i = 0; i < samples(); ++i) {                                                                  \
                SAMPLE sample = at_##S(i, index);                                                                     \
                check(sw_calibration_##S##_observe(&channel->calibration, &sample, 1u), "observe");                   \
            }                                                                                                         \
            check(sw_calibration_##S##_range(&channel->calibration, &channel->min, &channel->max), "range");          \
        }                                                                                                             \
    }

#define SAMPLE_f32 "f32"
#define SAMPLE_i16 "i16"
#define SAMPLE_q8_8 "q8.8"
#define SAMPLE_q16_16 "q16.16"

#if defined(FLY_f32)
CHANNEL(f32, float)
#endif
#if defined(FLY_i16)
CHANNEL(i16, int16_t)
#endif
#if defined(FLY_q8_8)
CHANNEL(q8_8, sw_q8_8)
#endif
#if defined(FLY_q16_16)
CHANNEL(q16_16, sw_q16_16)
#endif

static void calibrate(void)
{
#if defined(FLY_f32)
    calibrate_f32();
#endif
#if defined(FLY_i16)
    calibrate_i16();
#endif
#if defined(FLY_q8_8)
    calibrate_q8_8();
#endif
#if defined(FLY_q16_16)
    calibrate_q16_16();
#endif
}

#endif
