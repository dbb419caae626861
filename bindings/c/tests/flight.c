/* The recorded flight through every codec: sample by sample and in slices, as examples/flight-log flies it in Rust.
 *
 * A line for each, such as `sf f32 spikes=2074 hash=0123456789abcdef`. The hash is over all spikes and all decoded bits.
 */
#include "board.h"
#include "spikewire/all.h"

#include "recording.h"

#define MOST_FIRINGS 64u
#define SLICE 50u

typedef struct line {
    uint32_t spikes;
    uint64_t hash;
} line;

static void hash_byte(line *own, uint8_t byte)
{
    own->hash = (own->hash ^ byte) * 0x00000100000001b3u;
}

static void hash_half(line *own, uint16_t half)
{
    hash_byte(own, (uint8_t)(half & 0xffu));
    hash_byte(own, (uint8_t)(half >> 8));
}

static void hash_firings(line *own, const sw_neuron_spike *firings, size_t count)
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

#define FLY_(CODEC, LATENCY, S, LABEL, INIT, NAME, ...)                                                                        \
    static line one_by_one_##NAME(void)                                                                               \
    {                                                                                                                 \
        sw_##CODEC codec = {0};                                                                                       \
        sw_##CODEC##_encoder encoder = {0};                                                                           \
        sw_##CODEC##_decoder decoder = {0};                                                                           \
        sw_neuron_spike firings[MOST_FIRINGS] = {0};                                                                        \
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
        sw_##CODEC codec = {0};                                                                                       \
        sw_##CODEC##_encoder encoder = {0};                                                                           \
        sw_##CODEC##_decoder decoder = {0};                                                                           \
        sw_neuron_spike firings[MOST_FIRINGS] = {0};                                                                        \
        value_type_##S slice[SLICE] = {0}, values[SLICE] = {0};                                                       \
        sw_##CODEC##_code codes[SLICE] = {0};                                                                         \
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

#include "flown.h"

#undef FLY
#define FLY(CODEC, LATENCY, S, LABEL, INIT, ...) fly_##CODEC##_##INIT();

int main(void)
{
    calibrate();
#include "flown.h"
    board_finish(is_good);
    return 0;
}
