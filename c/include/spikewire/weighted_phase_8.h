/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_WEIGHTED_PHASE_8_H
#define SPIKEWIRE_WEIGHTED_PHASE_8_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Weighted phase: a value in binary digits: the finest in few sub-timesteps.
 *
 * Latency: 0 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 8. */
#define SW_WEIGHTED_PHASE_8_F32_LATENCY 0u
#define SW_WEIGHTED_PHASE_8_F32_NEURONS 1u
#define SW_WEIGHTED_PHASE_8_F32_SLOTS 8u
#define SW_WEIGHTED_PHASE_8_F32_SIZE 16u
typedef struct sw_weighted_phase_8_f32 {
    uint32_t storage[SW_WEIGHTED_PHASE_8_F32_SIZE / 4u];
} sw_weighted_phase_8_f32;
#define SW_WEIGHTED_PHASE_8_F32_ENCODER_STATE_SIZE 4u
typedef struct sw_weighted_phase_8_f32_encoder {
    const struct sw_weighted_phase_8_f32 *codec;
    uint32_t storage[SW_WEIGHTED_PHASE_8_F32_ENCODER_STATE_SIZE / 4u];
} sw_weighted_phase_8_f32_encoder;
#define SW_WEIGHTED_PHASE_8_F32_DECODER_STATE_SIZE 4u
typedef struct sw_weighted_phase_8_f32_decoder {
    const struct sw_weighted_phase_8_f32 *codec;
    uint32_t storage[SW_WEIGHTED_PHASE_8_F32_DECODER_STATE_SIZE / 4u];
} sw_weighted_phase_8_f32_decoder;
#define SW_WEIGHTED_PHASE_8_F32_CODE_SIZE 2u
typedef struct sw_weighted_phase_8_f32_code {
    uint16_t storage[SW_WEIGHTED_PHASE_8_F32_CODE_SIZE / 2u];
} sw_weighted_phase_8_f32_code;
SW_STATIC_ASSERT(weighted_phase_8_f32, sizeof(sw_weighted_phase_8_f32) == SW_WEIGHTED_PHASE_8_F32_SIZE);
SW_STATIC_ASSERT(weighted_phase_8_f32_code, sizeof(sw_weighted_phase_8_f32_code) == 2u);
/* `min`, `max`: the range, which must rise. */
sw_status sw_weighted_phase_8_f32_init(sw_weighted_phase_8_f32 *codec, float min, float max, sw_error *error);
SW_CODEC(weighted_phase_8_f32, float);

#define SW_WEIGHTED_PHASE_8_I16_LATENCY 0u
#define SW_WEIGHTED_PHASE_8_I16_NEURONS 1u
#define SW_WEIGHTED_PHASE_8_I16_SLOTS 8u
#define SW_WEIGHTED_PHASE_8_I16_SIZE 12u
typedef struct sw_weighted_phase_8_i16 {
    uint32_t storage[SW_WEIGHTED_PHASE_8_I16_SIZE / 4u];
} sw_weighted_phase_8_i16;
#define SW_WEIGHTED_PHASE_8_I16_ENCODER_STATE_SIZE 4u
typedef struct sw_weighted_phase_8_i16_encoder {
    const struct sw_weighted_phase_8_i16 *codec;
    uint32_t storage[SW_WEIGHTED_PHASE_8_I16_ENCODER_STATE_SIZE / 4u];
} sw_weighted_phase_8_i16_encoder;
#define SW_WEIGHTED_PHASE_8_I16_DECODER_STATE_SIZE 2u
typedef struct sw_weighted_phase_8_i16_decoder {
    const struct sw_weighted_phase_8_i16 *codec;
    uint16_t storage[SW_WEIGHTED_PHASE_8_I16_DECODER_STATE_SIZE / 2u];
} sw_weighted_phase_8_i16_decoder;
#define SW_WEIGHTED_PHASE_8_I16_CODE_SIZE 2u
typedef struct sw_weighted_phase_8_i16_code {
    uint16_t storage[SW_WEIGHTED_PHASE_8_I16_CODE_SIZE / 2u];
} sw_weighted_phase_8_i16_code;
SW_STATIC_ASSERT(weighted_phase_8_i16, sizeof(sw_weighted_phase_8_i16) == SW_WEIGHTED_PHASE_8_I16_SIZE);
SW_STATIC_ASSERT(weighted_phase_8_i16_code, sizeof(sw_weighted_phase_8_i16_code) == 2u);
/* `min`, `max`: the range, which must rise. */
sw_status sw_weighted_phase_8_i16_init(sw_weighted_phase_8_i16 *codec, int16_t min, int16_t max, sw_error *error);
SW_CODEC(weighted_phase_8_i16, int16_t);

#define SW_WEIGHTED_PHASE_8_Q8_8_LATENCY 0u
#define SW_WEIGHTED_PHASE_8_Q8_8_NEURONS 1u
#define SW_WEIGHTED_PHASE_8_Q8_8_SLOTS 8u
#define SW_WEIGHTED_PHASE_8_Q8_8_SIZE 12u
typedef struct sw_weighted_phase_8_q8_8 {
    uint32_t storage[SW_WEIGHTED_PHASE_8_Q8_8_SIZE / 4u];
} sw_weighted_phase_8_q8_8;
#define SW_WEIGHTED_PHASE_8_Q8_8_ENCODER_STATE_SIZE 4u
typedef struct sw_weighted_phase_8_q8_8_encoder {
    const struct sw_weighted_phase_8_q8_8 *codec;
    uint32_t storage[SW_WEIGHTED_PHASE_8_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_weighted_phase_8_q8_8_encoder;
#define SW_WEIGHTED_PHASE_8_Q8_8_DECODER_STATE_SIZE 2u
typedef struct sw_weighted_phase_8_q8_8_decoder {
    const struct sw_weighted_phase_8_q8_8 *codec;
    uint16_t storage[SW_WEIGHTED_PHASE_8_Q8_8_DECODER_STATE_SIZE / 2u];
} sw_weighted_phase_8_q8_8_decoder;
#define SW_WEIGHTED_PHASE_8_Q8_8_CODE_SIZE 2u
typedef struct sw_weighted_phase_8_q8_8_code {
    uint16_t storage[SW_WEIGHTED_PHASE_8_Q8_8_CODE_SIZE / 2u];
} sw_weighted_phase_8_q8_8_code;
SW_STATIC_ASSERT(weighted_phase_8_q8_8, sizeof(sw_weighted_phase_8_q8_8) == SW_WEIGHTED_PHASE_8_Q8_8_SIZE);
SW_STATIC_ASSERT(weighted_phase_8_q8_8_code, sizeof(sw_weighted_phase_8_q8_8_code) == 2u);
/* `min`, `max`: the range, which must rise. */
sw_status sw_weighted_phase_8_q8_8_init(sw_weighted_phase_8_q8_8 *codec, sw_q8_8 min, sw_q8_8 max, sw_error *error);
SW_CODEC(weighted_phase_8_q8_8, sw_q8_8);

#define SW_WEIGHTED_PHASE_8_Q16_16_LATENCY 0u
#define SW_WEIGHTED_PHASE_8_Q16_16_NEURONS 1u
#define SW_WEIGHTED_PHASE_8_Q16_16_SLOTS 8u
#define SW_WEIGHTED_PHASE_8_Q16_16_SIZE 16u
typedef struct sw_weighted_phase_8_q16_16 {
    uint32_t storage[SW_WEIGHTED_PHASE_8_Q16_16_SIZE / 4u];
} sw_weighted_phase_8_q16_16;
#define SW_WEIGHTED_PHASE_8_Q16_16_ENCODER_STATE_SIZE 4u
typedef struct sw_weighted_phase_8_q16_16_encoder {
    const struct sw_weighted_phase_8_q16_16 *codec;
    uint32_t storage[SW_WEIGHTED_PHASE_8_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_weighted_phase_8_q16_16_encoder;
#define SW_WEIGHTED_PHASE_8_Q16_16_DECODER_STATE_SIZE 4u
typedef struct sw_weighted_phase_8_q16_16_decoder {
    const struct sw_weighted_phase_8_q16_16 *codec;
    uint32_t storage[SW_WEIGHTED_PHASE_8_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_weighted_phase_8_q16_16_decoder;
#define SW_WEIGHTED_PHASE_8_Q16_16_CODE_SIZE 2u
typedef struct sw_weighted_phase_8_q16_16_code {
    uint16_t storage[SW_WEIGHTED_PHASE_8_Q16_16_CODE_SIZE / 2u];
} sw_weighted_phase_8_q16_16_code;
SW_STATIC_ASSERT(weighted_phase_8_q16_16, sizeof(sw_weighted_phase_8_q16_16) == SW_WEIGHTED_PHASE_8_Q16_16_SIZE);
SW_STATIC_ASSERT(weighted_phase_8_q16_16_code, sizeof(sw_weighted_phase_8_q16_16_code) == 2u);
/* `min`, `max`: the range, which must rise. */
sw_status sw_weighted_phase_8_q16_16_init(
    sw_weighted_phase_8_q16_16 *codec,
    sw_q16_16 min,
    sw_q16_16 max,
    sw_error *error);
SW_CODEC(weighted_phase_8_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
