/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_NON_LINEAR_SLOTS_15_10_H
#define SPIKEWIRE_NON_LINEAR_SLOTS_15_10_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Non-linear GRF with sub-timesteps: a value finer than the neurons, by spike time, and finest where it is most of the
 * time.
 *
 * Latency: 0 samples. Neurons of a channel: 15. Sub-timesteps of a sample: 10. */
#define SW_NON_LINEAR_SLOTS_15_10_F32_LATENCY 0u
#define SW_NON_LINEAR_SLOTS_15_10_F32_NEURONS 15u
#define SW_NON_LINEAR_SLOTS_15_10_F32_SLOTS 10u
#define SW_NON_LINEAR_SLOTS_15_10_F32_SIZE 228u
typedef struct sw_non_linear_slots_15_10_f32 {
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_F32_SIZE / 4u];
} sw_non_linear_slots_15_10_f32;
#define SW_NON_LINEAR_SLOTS_15_10_F32_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_slots_15_10_f32_encoder {
    const struct sw_non_linear_slots_15_10_f32 *codec;
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_F32_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_slots_15_10_f32_encoder;
#define SW_NON_LINEAR_SLOTS_15_10_F32_DECODER_STATE_SIZE 4u
typedef struct sw_non_linear_slots_15_10_f32_decoder {
    const struct sw_non_linear_slots_15_10_f32 *codec;
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_F32_DECODER_STATE_SIZE / 4u];
} sw_non_linear_slots_15_10_f32_decoder;
#define SW_NON_LINEAR_SLOTS_15_10_F32_CODE_SIZE 32u
typedef struct sw_non_linear_slots_15_10_f32_code {
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_F32_CODE_SIZE / 4u];
} sw_non_linear_slots_15_10_f32_code;
SW_STATIC_ASSERT(non_linear_slots_15_10_f32, sizeof(sw_non_linear_slots_15_10_f32) == SW_NON_LINEAR_SLOTS_15_10_F32_SIZE);
SW_STATIC_ASSERT(non_linear_slots_15_10_f32_code, sizeof(sw_non_linear_slots_15_10_f32_code) == 32u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below
 * this level of the slots are silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_f32_init(
    sw_non_linear_slots_15_10_f32 *codec,
    const float centres[15],
    const float widths[15],
    uint16_t floor,
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0;
 * `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are
 * silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_f32_init_companded(
    sw_non_linear_slots_15_10_f32 *codec,
    float min,
    float max,
    float companding,
    float beta,
    uint16_t floor,
    sw_error *error);
SW_CODEC(non_linear_slots_15_10_f32, float);

#define SW_NON_LINEAR_SLOTS_15_10_I16_LATENCY 0u
#define SW_NON_LINEAR_SLOTS_15_10_I16_NEURONS 15u
#define SW_NON_LINEAR_SLOTS_15_10_I16_SLOTS 10u
#define SW_NON_LINEAR_SLOTS_15_10_I16_SIZE 304u
typedef struct sw_non_linear_slots_15_10_i16 {
    uint64_t storage[SW_NON_LINEAR_SLOTS_15_10_I16_SIZE / 8u];
} sw_non_linear_slots_15_10_i16;
#define SW_NON_LINEAR_SLOTS_15_10_I16_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_slots_15_10_i16_encoder {
    const struct sw_non_linear_slots_15_10_i16 *codec;
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_I16_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_slots_15_10_i16_encoder;
#define SW_NON_LINEAR_SLOTS_15_10_I16_DECODER_STATE_SIZE 2u
typedef struct sw_non_linear_slots_15_10_i16_decoder {
    const struct sw_non_linear_slots_15_10_i16 *codec;
    uint16_t storage[SW_NON_LINEAR_SLOTS_15_10_I16_DECODER_STATE_SIZE / 2u];
} sw_non_linear_slots_15_10_i16_decoder;
#define SW_NON_LINEAR_SLOTS_15_10_I16_CODE_SIZE 32u
typedef struct sw_non_linear_slots_15_10_i16_code {
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_I16_CODE_SIZE / 4u];
} sw_non_linear_slots_15_10_i16_code;
SW_STATIC_ASSERT(non_linear_slots_15_10_i16, sizeof(sw_non_linear_slots_15_10_i16) == SW_NON_LINEAR_SLOTS_15_10_I16_SIZE);
SW_STATIC_ASSERT(non_linear_slots_15_10_i16_code, sizeof(sw_non_linear_slots_15_10_i16_code) == 32u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below
 * this level of the slots are silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_i16_init(
    sw_non_linear_slots_15_10_i16 *codec,
    const int16_t centres[15],
    const float widths[15],
    uint16_t floor,
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0;
 * `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are
 * silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_i16_init_companded(
    sw_non_linear_slots_15_10_i16 *codec,
    int16_t min,
    int16_t max,
    float companding,
    float beta,
    uint16_t floor,
    sw_error *error);
SW_CODEC(non_linear_slots_15_10_i16, int16_t);

#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_LATENCY 0u
#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_NEURONS 15u
#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_SLOTS 10u
#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_SIZE 304u
typedef struct sw_non_linear_slots_15_10_q8_8 {
    uint64_t storage[SW_NON_LINEAR_SLOTS_15_10_Q8_8_SIZE / 8u];
} sw_non_linear_slots_15_10_q8_8;
#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_slots_15_10_q8_8_encoder {
    const struct sw_non_linear_slots_15_10_q8_8 *codec;
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_slots_15_10_q8_8_encoder;
#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_DECODER_STATE_SIZE 2u
typedef struct sw_non_linear_slots_15_10_q8_8_decoder {
    const struct sw_non_linear_slots_15_10_q8_8 *codec;
    uint16_t storage[SW_NON_LINEAR_SLOTS_15_10_Q8_8_DECODER_STATE_SIZE / 2u];
} sw_non_linear_slots_15_10_q8_8_decoder;
#define SW_NON_LINEAR_SLOTS_15_10_Q8_8_CODE_SIZE 32u
typedef struct sw_non_linear_slots_15_10_q8_8_code {
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_Q8_8_CODE_SIZE / 4u];
} sw_non_linear_slots_15_10_q8_8_code;
SW_STATIC_ASSERT(non_linear_slots_15_10_q8_8, sizeof(sw_non_linear_slots_15_10_q8_8) == SW_NON_LINEAR_SLOTS_15_10_Q8_8_SIZE);
SW_STATIC_ASSERT(non_linear_slots_15_10_q8_8_code, sizeof(sw_non_linear_slots_15_10_q8_8_code) == 32u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below
 * this level of the slots are silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_q8_8_init(
    sw_non_linear_slots_15_10_q8_8 *codec,
    const sw_q8_8 centres[15],
    const float widths[15],
    uint16_t floor,
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0;
 * `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are
 * silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_q8_8_init_companded(
    sw_non_linear_slots_15_10_q8_8 *codec,
    sw_q8_8 min,
    sw_q8_8 max,
    float companding,
    float beta,
    uint16_t floor,
    sw_error *error);
SW_CODEC(non_linear_slots_15_10_q8_8, sw_q8_8);

#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_LATENCY 0u
#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_NEURONS 15u
#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_SLOTS 10u
#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_SIZE 336u
typedef struct sw_non_linear_slots_15_10_q16_16 {
    uint64_t storage[SW_NON_LINEAR_SLOTS_15_10_Q16_16_SIZE / 8u];
} sw_non_linear_slots_15_10_q16_16;
#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_ENCODER_STATE_SIZE 4u
typedef struct sw_non_linear_slots_15_10_q16_16_encoder {
    const struct sw_non_linear_slots_15_10_q16_16 *codec;
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_non_linear_slots_15_10_q16_16_encoder;
#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_DECODER_STATE_SIZE 4u
typedef struct sw_non_linear_slots_15_10_q16_16_decoder {
    const struct sw_non_linear_slots_15_10_q16_16 *codec;
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_non_linear_slots_15_10_q16_16_decoder;
#define SW_NON_LINEAR_SLOTS_15_10_Q16_16_CODE_SIZE 32u
typedef struct sw_non_linear_slots_15_10_q16_16_code {
    uint32_t storage[SW_NON_LINEAR_SLOTS_15_10_Q16_16_CODE_SIZE / 4u];
} sw_non_linear_slots_15_10_q16_16_code;
SW_STATIC_ASSERT(non_linear_slots_15_10_q16_16, sizeof(sw_non_linear_slots_15_10_q16_16) == SW_NON_LINEAR_SLOTS_15_10_Q16_16_SIZE);
SW_STATIC_ASSERT(non_linear_slots_15_10_q16_16_code, sizeof(sw_non_linear_slots_15_10_q16_16_code) == 32u);
/* `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below
 * this level of the slots are silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_q16_16_init(
    sw_non_linear_slots_15_10_q16_16 *codec,
    const sw_q16_16 centres[15],
    const float widths[15],
    uint16_t floor,
    sw_error *error);
/* `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0;
 * `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are
 * silent, 1 or more. */
sw_status sw_non_linear_slots_15_10_q16_16_init_companded(
    sw_non_linear_slots_15_10_q16_16 *codec,
    sw_q16_16 min,
    sw_q16_16 max,
    float companding,
    float beta,
    uint16_t floor,
    sw_error *error);
SW_CODEC(non_linear_slots_15_10_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
