/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_SIGMA_DELTA_H
#define SPIKEWIRE_SIGMA_DELTA_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
 *
 * Latency: 0 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 1. */
#define SW_SIGMA_DELTA_F32_LATENCY 0u
#define SW_SIGMA_DELTA_F32_NEURONS 1u
#define SW_SIGMA_DELTA_F32_SLOTS 1u
#define SW_SIGMA_DELTA_F32_SIZE 16u
typedef struct sw_sigma_delta_f32 {
    uint32_t storage[SW_SIGMA_DELTA_F32_SIZE / 4u];
} sw_sigma_delta_f32;
#define SW_SIGMA_DELTA_F32_ENCODER_STATE_SIZE 8u
typedef struct sw_sigma_delta_f32_encoder {
    const struct sw_sigma_delta_f32 *codec;
    uint32_t storage[SW_SIGMA_DELTA_F32_ENCODER_STATE_SIZE / 4u];
} sw_sigma_delta_f32_encoder;
#define SW_SIGMA_DELTA_F32_DECODER_STATE_SIZE 8u
typedef struct sw_sigma_delta_f32_decoder {
    const struct sw_sigma_delta_f32 *codec;
    uint32_t storage[SW_SIGMA_DELTA_F32_DECODER_STATE_SIZE / 4u];
} sw_sigma_delta_f32_decoder;
typedef int8_t sw_sigma_delta_f32_code;
SW_STATIC_ASSERT(sigma_delta_f32, sizeof(sw_sigma_delta_f32) == SW_SIGMA_DELTA_F32_SIZE);
SW_STATIC_ASSERT(sigma_delta_f32_code, sizeof(sw_sigma_delta_f32_code) == 1u);
/* `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15. */
sw_status sw_sigma_delta_f32_init(sw_sigma_delta_f32 *codec, float min, float max, uint8_t power, sw_error *error);
SW_CODEC(sigma_delta_f32, float);

#define SW_SIGMA_DELTA_I16_LATENCY 0u
#define SW_SIGMA_DELTA_I16_NEURONS 1u
#define SW_SIGMA_DELTA_I16_SLOTS 1u
#define SW_SIGMA_DELTA_I16_SIZE 12u
typedef struct sw_sigma_delta_i16 {
    uint32_t storage[SW_SIGMA_DELTA_I16_SIZE / 4u];
} sw_sigma_delta_i16;
#define SW_SIGMA_DELTA_I16_ENCODER_STATE_SIZE 8u
typedef struct sw_sigma_delta_i16_encoder {
    const struct sw_sigma_delta_i16 *codec;
    uint32_t storage[SW_SIGMA_DELTA_I16_ENCODER_STATE_SIZE / 4u];
} sw_sigma_delta_i16_encoder;
#define SW_SIGMA_DELTA_I16_DECODER_STATE_SIZE 8u
typedef struct sw_sigma_delta_i16_decoder {
    const struct sw_sigma_delta_i16 *codec;
    uint32_t storage[SW_SIGMA_DELTA_I16_DECODER_STATE_SIZE / 4u];
} sw_sigma_delta_i16_decoder;
typedef int8_t sw_sigma_delta_i16_code;
SW_STATIC_ASSERT(sigma_delta_i16, sizeof(sw_sigma_delta_i16) == SW_SIGMA_DELTA_I16_SIZE);
SW_STATIC_ASSERT(sigma_delta_i16_code, sizeof(sw_sigma_delta_i16_code) == 1u);
/* `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15. */
sw_status sw_sigma_delta_i16_init(sw_sigma_delta_i16 *codec, int16_t min, int16_t max, uint8_t power, sw_error *error);
SW_CODEC(sigma_delta_i16, int16_t);

#define SW_SIGMA_DELTA_Q8_8_LATENCY 0u
#define SW_SIGMA_DELTA_Q8_8_NEURONS 1u
#define SW_SIGMA_DELTA_Q8_8_SLOTS 1u
#define SW_SIGMA_DELTA_Q8_8_SIZE 12u
typedef struct sw_sigma_delta_q8_8 {
    uint32_t storage[SW_SIGMA_DELTA_Q8_8_SIZE / 4u];
} sw_sigma_delta_q8_8;
#define SW_SIGMA_DELTA_Q8_8_ENCODER_STATE_SIZE 8u
typedef struct sw_sigma_delta_q8_8_encoder {
    const struct sw_sigma_delta_q8_8 *codec;
    uint32_t storage[SW_SIGMA_DELTA_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_sigma_delta_q8_8_encoder;
#define SW_SIGMA_DELTA_Q8_8_DECODER_STATE_SIZE 8u
typedef struct sw_sigma_delta_q8_8_decoder {
    const struct sw_sigma_delta_q8_8 *codec;
    uint32_t storage[SW_SIGMA_DELTA_Q8_8_DECODER_STATE_SIZE / 4u];
} sw_sigma_delta_q8_8_decoder;
typedef int8_t sw_sigma_delta_q8_8_code;
SW_STATIC_ASSERT(sigma_delta_q8_8, sizeof(sw_sigma_delta_q8_8) == SW_SIGMA_DELTA_Q8_8_SIZE);
SW_STATIC_ASSERT(sigma_delta_q8_8_code, sizeof(sw_sigma_delta_q8_8_code) == 1u);
/* `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15. */
sw_status sw_sigma_delta_q8_8_init(
    sw_sigma_delta_q8_8 *codec,
    sw_q8_8 min,
    sw_q8_8 max,
    uint8_t power,
    sw_error *error);
SW_CODEC(sigma_delta_q8_8, sw_q8_8);

#define SW_SIGMA_DELTA_Q16_16_LATENCY 0u
#define SW_SIGMA_DELTA_Q16_16_NEURONS 1u
#define SW_SIGMA_DELTA_Q16_16_SLOTS 1u
#define SW_SIGMA_DELTA_Q16_16_SIZE 16u
typedef struct sw_sigma_delta_q16_16 {
    uint32_t storage[SW_SIGMA_DELTA_Q16_16_SIZE / 4u];
} sw_sigma_delta_q16_16;
#define SW_SIGMA_DELTA_Q16_16_ENCODER_STATE_SIZE 16u
typedef struct sw_sigma_delta_q16_16_encoder {
    const struct sw_sigma_delta_q16_16 *codec;
    uint64_t storage[SW_SIGMA_DELTA_Q16_16_ENCODER_STATE_SIZE / 8u];
} sw_sigma_delta_q16_16_encoder;
#define SW_SIGMA_DELTA_Q16_16_DECODER_STATE_SIZE 16u
typedef struct sw_sigma_delta_q16_16_decoder {
    const struct sw_sigma_delta_q16_16 *codec;
    uint64_t storage[SW_SIGMA_DELTA_Q16_16_DECODER_STATE_SIZE / 8u];
} sw_sigma_delta_q16_16_decoder;
typedef int8_t sw_sigma_delta_q16_16_code;
SW_STATIC_ASSERT(sigma_delta_q16_16, sizeof(sw_sigma_delta_q16_16) == SW_SIGMA_DELTA_Q16_16_SIZE);
SW_STATIC_ASSERT(sigma_delta_q16_16_code, sizeof(sw_sigma_delta_q16_16_code) == 1u);
/* `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15. */
sw_status sw_sigma_delta_q16_16_init(
    sw_sigma_delta_q16_16 *codec,
    sw_q16_16 min,
    sw_q16_16 max,
    uint8_t power,
    sw_error *error);
SW_CODEC(sigma_delta_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
