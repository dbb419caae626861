/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_NON_LINEAR_GAUSSIAN_20_H
#define SPIKEWIRE_NON_LINEAR_GAUSSIAN_20_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Non-linear Gaussian receptive fields (GRF): a value, finer where it is most of the time.
 *
 * Latency: 0 samples. Neurons of a channel: 20. Sub-timesteps of a sample: 1. */
#define SW_NON_LINEAR_GAUSSIAN_20_F32_LATENCY 0u
#define SW_NON_LINEAR_GAUSSIAN_20_F32_NEURONS 20u
#define SW_NON_LINEAR_GAUSSIAN_20_F32_SLOTS 1u
#define SW_NON_LINEAR_GAUSSIAN_20_F32_SIZE 212u
typedef struct sw_non_linear_gaussian_20_f32 {
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_F32_SIZE / 4u];
} sw_non_linear_gaussian_20_f32;
#define SW_NON_LINEAR_GAUSSIAN_20_F32_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_gaussian_20_f32_encoder {
    const struct sw_non_linear_gaussian_20_f32 *codec;
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_F32_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_gaussian_20_f32_encoder;
#define SW_NON_LINEAR_GAUSSIAN_20_F32_DECODER_STATE_SIZE 4u
typedef struct sw_non_linear_gaussian_20_f32_decoder {
    const struct sw_non_linear_gaussian_20_f32 *codec;
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_F32_DECODER_STATE_SIZE / 4u];
} sw_non_linear_gaussian_20_f32_decoder;
#define SW_NON_LINEAR_GAUSSIAN_20_F32_CODE_SIZE 2u
typedef struct sw_non_linear_gaussian_20_f32_code {
    uint16_t storage[SW_NON_LINEAR_GAUSSIAN_20_F32_CODE_SIZE / 2u];
} sw_non_linear_gaussian_20_f32_code;
SW_STATIC_ASSERT(non_linear_gaussian_20_f32, sizeof(sw_non_linear_gaussian_20_f32) == SW_NON_LINEAR_GAUSSIAN_20_F32_SIZE);
SW_STATIC_ASSERT(non_linear_gaussian_20_f32_code, sizeof(sw_non_linear_gaussian_20_f32_code) == 2u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0. */
sw_status sw_non_linear_gaussian_20_f32_init(
    sw_non_linear_gaussian_20_f32 *codec,
    const float centres[20],
    const float widths[20],
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0. */
sw_status sw_non_linear_gaussian_20_f32_init_companded(
    sw_non_linear_gaussian_20_f32 *codec,
    float min,
    float max,
    float companding,
    sw_error *error);
SW_CODEC(non_linear_gaussian_20_f32, float);

#define SW_NON_LINEAR_GAUSSIAN_20_I16_LATENCY 0u
#define SW_NON_LINEAR_GAUSSIAN_20_I16_NEURONS 20u
#define SW_NON_LINEAR_GAUSSIAN_20_I16_SLOTS 1u
#define SW_NON_LINEAR_GAUSSIAN_20_I16_SIZE 132u
typedef struct sw_non_linear_gaussian_20_i16 {
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_I16_SIZE / 4u];
} sw_non_linear_gaussian_20_i16;
#define SW_NON_LINEAR_GAUSSIAN_20_I16_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_gaussian_20_i16_encoder {
    const struct sw_non_linear_gaussian_20_i16 *codec;
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_I16_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_gaussian_20_i16_encoder;
#define SW_NON_LINEAR_GAUSSIAN_20_I16_DECODER_STATE_SIZE 2u
typedef struct sw_non_linear_gaussian_20_i16_decoder {
    const struct sw_non_linear_gaussian_20_i16 *codec;
    uint16_t storage[SW_NON_LINEAR_GAUSSIAN_20_I16_DECODER_STATE_SIZE / 2u];
} sw_non_linear_gaussian_20_i16_decoder;
#define SW_NON_LINEAR_GAUSSIAN_20_I16_CODE_SIZE 2u
typedef struct sw_non_linear_gaussian_20_i16_code {
    uint16_t storage[SW_NON_LINEAR_GAUSSIAN_20_I16_CODE_SIZE / 2u];
} sw_non_linear_gaussian_20_i16_code;
SW_STATIC_ASSERT(non_linear_gaussian_20_i16, sizeof(sw_non_linear_gaussian_20_i16) == SW_NON_LINEAR_GAUSSIAN_20_I16_SIZE);
SW_STATIC_ASSERT(non_linear_gaussian_20_i16_code, sizeof(sw_non_linear_gaussian_20_i16_code) == 2u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0. */
sw_status sw_non_linear_gaussian_20_i16_init(
    sw_non_linear_gaussian_20_i16 *codec,
    const int16_t centres[20],
    const float widths[20],
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0. */
sw_status sw_non_linear_gaussian_20_i16_init_companded(
    sw_non_linear_gaussian_20_i16 *codec,
    int16_t min,
    int16_t max,
    float companding,
    sw_error *error);
SW_CODEC(non_linear_gaussian_20_i16, int16_t);

#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_LATENCY 0u
#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_NEURONS 20u
#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_SLOTS 1u
#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_SIZE 132u
typedef struct sw_non_linear_gaussian_20_q8_8 {
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q8_8_SIZE / 4u];
} sw_non_linear_gaussian_20_q8_8;
#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_gaussian_20_q8_8_encoder {
    const struct sw_non_linear_gaussian_20_q8_8 *codec;
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_gaussian_20_q8_8_encoder;
#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_DECODER_STATE_SIZE 2u
typedef struct sw_non_linear_gaussian_20_q8_8_decoder {
    const struct sw_non_linear_gaussian_20_q8_8 *codec;
    uint16_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q8_8_DECODER_STATE_SIZE / 2u];
} sw_non_linear_gaussian_20_q8_8_decoder;
#define SW_NON_LINEAR_GAUSSIAN_20_Q8_8_CODE_SIZE 2u
typedef struct sw_non_linear_gaussian_20_q8_8_code {
    uint16_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q8_8_CODE_SIZE / 2u];
} sw_non_linear_gaussian_20_q8_8_code;
SW_STATIC_ASSERT(non_linear_gaussian_20_q8_8, sizeof(sw_non_linear_gaussian_20_q8_8) == SW_NON_LINEAR_GAUSSIAN_20_Q8_8_SIZE);
SW_STATIC_ASSERT(non_linear_gaussian_20_q8_8_code, sizeof(sw_non_linear_gaussian_20_q8_8_code) == 2u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0. */
sw_status sw_non_linear_gaussian_20_q8_8_init(
    sw_non_linear_gaussian_20_q8_8 *codec,
    const sw_q8_8 centres[20],
    const float widths[20],
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0. */
sw_status sw_non_linear_gaussian_20_q8_8_init_companded(
    sw_non_linear_gaussian_20_q8_8 *codec,
    sw_q8_8 min,
    sw_q8_8 max,
    float companding,
    sw_error *error);
SW_CODEC(non_linear_gaussian_20_q8_8, sw_q8_8);

#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_LATENCY 0u
#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_NEURONS 20u
#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_SLOTS 1u
#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_SIZE 212u
typedef struct sw_non_linear_gaussian_20_q16_16 {
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q16_16_SIZE / 4u];
} sw_non_linear_gaussian_20_q16_16;
#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_gaussian_20_q16_16_encoder {
    const struct sw_non_linear_gaussian_20_q16_16 *codec;
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_gaussian_20_q16_16_encoder;
#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_DECODER_STATE_SIZE 4u
typedef struct sw_non_linear_gaussian_20_q16_16_decoder {
    const struct sw_non_linear_gaussian_20_q16_16 *codec;
    uint32_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_non_linear_gaussian_20_q16_16_decoder;
#define SW_NON_LINEAR_GAUSSIAN_20_Q16_16_CODE_SIZE 2u
typedef struct sw_non_linear_gaussian_20_q16_16_code {
    uint16_t storage[SW_NON_LINEAR_GAUSSIAN_20_Q16_16_CODE_SIZE / 2u];
} sw_non_linear_gaussian_20_q16_16_code;
SW_STATIC_ASSERT(non_linear_gaussian_20_q16_16, sizeof(sw_non_linear_gaussian_20_q16_16) == SW_NON_LINEAR_GAUSSIAN_20_Q16_16_SIZE);
SW_STATIC_ASSERT(non_linear_gaussian_20_q16_16_code, sizeof(sw_non_linear_gaussian_20_q16_16_code) == 2u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0. */
sw_status sw_non_linear_gaussian_20_q16_16_init(
    sw_non_linear_gaussian_20_q16_16 *codec,
    const sw_q16_16 centres[20],
    const float widths[20],
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0. */
sw_status sw_non_linear_gaussian_20_q16_16_init_companded(
    sw_non_linear_gaussian_20_q16_16 *codec,
    sw_q16_16 min,
    sw_q16_16 max,
    float companding,
    sw_error *error);
SW_CODEC(non_linear_gaussian_20_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
