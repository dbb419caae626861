/* The recorded flight through every codec: sample by sample and in slices, as examples/flight-log flies it in Rust.
 *
 * A line for each, such as `sf f32 spikes=2074 hash=0123456789abcdef`. The hash is over all spikes and all decoded bits.
 */
#include "board.h"
#include "spikewire/all.h"

#define CHANNELS 6u
#define RECORD (4u + (4u * CHANNELS))
#define MOST_FIRINGS 64u
#define SLICE 50u

extern const uint8_t recording[], recording_end[];

typedef struct line {
    uint32_t spikes;
    uint64_t hash;
} line;

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

static void hash_byte(line *own, uint8_t byte)
{
    own->hash = (own->hash ^ byte) * 0x00000100000001b3u;
}

static void hash_half(line *own, uint16_t half)
{
    hash_byte(own, (uint8_t)(half & 0xffu));
    hash_byte(own, (uint8_t)(half >> 8));
}

static void hash_firings(line *own, const sw_firing *firings, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        own->spikes += 1u;
        hash_half(own, firings[i].neuron);
        hash_half(own, firings[i].slot);
        hash_byte(own, firings[i].polarity > 0 ? 1u : 0u);
    }
    hash_byte(own, 0xffu);
}

static void hash_value(line *own, double value)
{
    union {
        double value;
        uint64_t bits;
    } both;
    both.value = value;
    for (uint32_t shift = 0; shift < 64u; shift += 8u) {
        hash_byte(own, (uint8_t)((both.bits >> shift) & 0xffu));
    }
}

static void print_number(uint64_t number, uint32_t base, uint32_t digits)
{
    char text[24];
    uint32_t at = sizeof text - 1u;
    text[at] = '\0';
    do {
        text[--at] = "0123456789abcdef"[number % base];
        number /= base;
    } while (number > 0u || at + digits > sizeof text - 1u);
    board_print(&text[at]);
}

static void print_line(const char *label, const char *sample, const line *own)
{
    board_print(label);
    board_print(" ");
    board_print(sample);
    board_print(" spikes=");
    print_number(own->spikes, 10u, 1u);
    board_print(" hash=");
    print_number(own->hash, 16u, 16u);
    board_print("\n");
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

/* What a code says, and what the decoder makes of it. */
#define TAKE(CODEC, S)                                                                                                \
    do {                                                                                                              \
        size_t count = 0;                                                                                             \
        check(sw_##CODEC##_firings(&code, firings, MOST_FIRINGS, &count), "firings");                                 \
        hash_firings(&own, firings, count);                                                                           \
        check(sw_##CODEC##_decode(&decoder, &code, &value), "decode");                                                \
        if (decoded < samples()) {                                                                                    \
            ++decoded;                                                                                                \
            hash_value(&own, value_##S(value));                                                                       \
        }                                                                                                             \
    } while (0)

#define FLY(CODEC, LATENCY, S, LABEL, INIT, ...) FLY_(CODEC, LATENCY, S, LABEL, INIT, CODEC##_##INIT, __VA_ARGS__)

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

#define FLY_(CODEC, LATENCY, S, LABEL, INIT, NAME, ...)                                                                        \
    static line one_by_one_##NAME(void)                                                                               \
    {                                                                                                                 \
        static sw_##CODEC codec;                                                                                      \
        static sw_##CODEC##_encoder encoder;                                                                          \
        static sw_##CODEC##_decoder decoder;                                                                          \
        static sw_firing firings[MOST_FIRINGS];                                                                       \
        line own = {0u, 0xcbf29ce484222325u};                                                                         \
        for (uint32_t index = 0; index < CHANNELS; ++index) {                                                         \
            const channel_##S *channel = &channels_##S[index];                                                        \
            sw_##CODEC##_code code;                                                                                   \
            value_type_##S value;                                                                                     \
            sw_error error;                                                                                           \
            size_t decoded = 0;                                                                                       \
            check(sw_##CODEC##_##INIT(&codec, __VA_ARGS__, &error), "init");                                          \
            check(sw_##CODEC##_encoder_start(&encoder, &codec), "encoder_start");                                     \
            check(sw_##CODEC##_decoder_start(&decoder, &codec), "decoder_start");                                     \
            check(sw_##CODEC##_resync(&decoder, at_##S(0, index)), "resync");                                         \
            for (size_t i = 0; i < samples(); ++i) {                                                                  \
                sw_status status = sw_##CODEC##_encode(&encoder, at_##S(i, index), &code);                            \
                check(status, "encode");                                                                              \
                if (status == SW_OK) {                                                                                \
                    TAKE(CODEC, S);                                                                                   \
                }                                                                                                     \
            }                                                                                                         \
            while (sw_##CODEC##_finish(&encoder, &code) == SW_OK) {                                                   \
                TAKE(CODEC, S);                                                                                       \
            }                                                                                                         \
        }                                                                                                             \
        return own;                                                                                                   \
    }                                                                                                                 \
    static line in_slices_##NAME(void)                                                                                \
    {                                                                                                                 \
        static sw_##CODEC codec;                                                                                      \
        static sw_##CODEC##_encoder encoder;                                                                          \
        static sw_##CODEC##_decoder decoder;                                                                          \
        static sw_firing firings[MOST_FIRINGS];                                                                       \
        static value_type_##S slice[SLICE], values[SLICE];                                                            \
        static sw_##CODEC##_code codes[SLICE];                                                                        \
        line own = {0u, 0xcbf29ce484222325u};                                                                         \
        for (uint32_t index = 0; index < CHANNELS; ++index) {                                                         \
            const channel_##S *channel = &channels_##S[index];                                                        \
            sw_##CODEC##_code code;                                                                                   \
            value_type_##S value;                                                                                     \
            size_t decoded = 0, waiting = LATENCY;                                                                    \
            check(sw_##CODEC##_##INIT(&codec, __VA_ARGS__, NULL), "init");                                            \
            check(sw_##CODEC##_encoder_start(&encoder, &codec), "encoder_start");                                     \
            check(sw_##CODEC##_decoder_start(&decoder, &codec), "decoder_start");                                     \
            check(sw_##CODEC##_resync(&decoder, at_##S(0, index)), "resync");                                         \
            for (size_t i = 0; i < samples(); i += SLICE) {                                                           \
                size_t length = (samples() - i < SLICE) ? samples() - i : SLICE;                                      \
                for (size_t j = 0; j < length; ++j) {                                                                 \
                    slice[j] = at_##S(i + j, index);                                                                  \
                }                                                                                                     \
                check(sw_##CODEC##_encode_slice(&encoder, slice, codes, length), "encode_slice");                     \
                size_t first = (waiting < length) ? waiting : length;                                                 \
                waiting -= first;                                                                                     \
                check(sw_##CODEC##_decode_slice(&decoder, &codes[first], values, length - first), "decode_slice");    \
                for (size_t j = first; j < length; ++j) {                                                             \
                    size_t count = 0;                                                                                 \
                    check(sw_##CODEC##_firings(&codes[j], firings, MOST_FIRINGS, &count), "firings");                 \
                    check(sw_##CODEC##_assemble(firings, count, &code), "assemble");                                  \
                    check(sw_##CODEC##_firings(&code, firings, MOST_FIRINGS, &count), "firings");                     \
                    hash_firings(&own, firings, count);                                                               \
                    hash_value(&own, value_##S(values[j - first]));                                                   \
                    ++decoded;                                                                                        \
                }                                                                                                     \
            }                                                                                                         \
            while (sw_##CODEC##_finish(&encoder, &code) == SW_OK) {                                                   \
                TAKE(CODEC, S);                                                                                       \
            }                                                                                                         \
        }                                                                                                             \
        return own;                                                                                                   \
    }                                                                                                                 \
    static void fly_##NAME(void)                                                                                      \
    {                                                                                                                 \
        line one = one_by_one_##NAME(), slices = in_slices_##NAME();                                                  \
        print_line(LABEL, SAMPLE_##S, &one);                                                                          \
        if ((one.spikes != slices.spikes) || (one.hash != slices.hash)) {                                             \
            print_line(LABEL " in slices", SAMPLE_##S, &slices);                                                      \
            is_good = 0;                                                                                              \
        }                                                                                                             \
    }

#define SAMPLE_f32 "f32"
#define SAMPLE_i16 "i16"
#define SAMPLE_q8_8 "q8.8"
#define SAMPLE_q16_16 "q16.16"

#include "flown.h"

#undef FLY
#define FLY(CODEC, LATENCY, S, LABEL, INIT, ...) fly_##CODEC##_##INIT();

int main(void)
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
#include "flown.h"
    board_finish(is_good);
    return 0;
}
