/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_INTEGRATE_AND_FIRE_8_H
#define SPIKEWIRE_INTEGRATE_AND_FIRE_8_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Integrate and fire (IF): a mean, and an integral that never drifts: a gyroscope's angle.
 *
 * Latency: 0 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 8. */
#define SW_INTEGRATE_AND_FIRE_8_F32_LATENCY 0u
#define SW_INTEGRATE_AND_FIRE_8_F32_NEURONS 1u
#define SW_INTEGRATE_AND_FIRE_8_F32_SLOTS 8u
#define SW_INTEGRATE_AND_FIRE_8_F32_SIZE 16u
typedef struct sw_integrate_and_fire_8_f32 {
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_F32_SIZE / 4u];
} sw_integrate_and_fire_8_f32;
#define SW_INTEGRATE_AND_FIRE_8_F32_ENCODER_STATE_SIZE 8u
typedef struct sw_integrate_and_fire_8_f32_encoder {
    const struct sw_integrate_and_fire_8_f32 *codec;
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_F32_ENCODER_STATE_SIZE / 4u];
} sw_integrate_and_fire_8_f32_encoder;
#define SW_INTEGRATE_AND_FIRE_8_F32_DECODER_STATE_SIZE 4u
typedef struct sw_integrate_and_fire_8_f32_decoder {
    const struct sw_integrate_and_fire_8_f32 *codec;
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_F32_DECODER_STATE_SIZE / 4u];
} sw_integrate_and_fire_8_f32_decoder;
typedef int8_t sw_integrate_and_fire_8_f32_code;
SW_STATIC_ASSERT(integrate_and_fire_8_f32, sizeof(sw_integrate_and_fire_8_f32) == SW_INTEGRATE_AND_FIRE_8_F32_SIZE);
SW_STATIC_ASSERT(integrate_and_fire_8_f32_code, sizeof(sw_integrate_and_fire_8_f32_code) == 1u);
/* `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to
 * 15; `reference`: the value without spikes. */
sw_status sw_integrate_and_fire_8_f32_init(
    sw_integrate_and_fire_8_f32 *codec,
    float threshold,
    uint8_t power,
    float reference,
    sw_error *error);
SW_CODEC(integrate_and_fire_8_f32, float);

#define SW_INTEGRATE_AND_FIRE_8_I16_LATENCY 0u
#define SW_INTEGRATE_AND_FIRE_8_I16_NEURONS 1u
#define SW_INTEGRATE_AND_FIRE_8_I16_SLOTS 8u
#define SW_INTEGRATE_AND_FIRE_8_I16_SIZE 12u
typedef struct sw_integrate_and_fire_8_i16 {
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_I16_SIZE / 4u];
} sw_integrate_and_fire_8_i16;
#define SW_INTEGRATE_AND_FIRE_8_I16_ENCODER_STATE_SIZE 8u
typedef struct sw_integrate_and_fire_8_i16_encoder {
    const struct sw_integrate_and_fire_8_i16 *codec;
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_I16_ENCODER_STATE_SIZE / 4u];
} sw_integrate_and_fire_8_i16_encoder;
#define SW_INTEGRATE_AND_FIRE_8_I16_DECODER_STATE_SIZE 4u
typedef struct sw_integrate_and_fire_8_i16_decoder {
    const struct sw_integrate_and_fire_8_i16 *codec;
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_I16_DECODER_STATE_SIZE / 4u];
} sw_integrate_and_fire_8_i16_decoder;
typedef int8_t sw_integrate_and_fire_8_i16_code;
SW_STATIC_ASSERT(integrate_and_fire_8_i16, sizeof(sw_integrate_and_fire_8_i16) == SW_INTEGRATE_AND_FIRE_8_I16_SIZE);
SW_STATIC_ASSERT(integrate_and_fire_8_i16_code, sizeof(sw_integrate_and_fire_8_i16_code) == 1u);
/* `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to
 * 15; `reference`: the value without spikes. */
sw_status sw_integrate_and_fire_8_i16_init(
    sw_integrate_and_fire_8_i16 *codec,
    int16_t threshold,
    uint8_t power,
    int16_t reference,
    sw_error *error);
SW_CODEC(integrate_and_fire_8_i16, int16_t);

#define SW_INTEGRATE_AND_FIRE_8_Q8_8_LATENCY 0u
#define SW_INTEGRATE_AND_FIRE_8_Q8_8_NEURONS 1u
#define SW_INTEGRATE_AND_FIRE_8_Q8_8_SLOTS 8u
#define SW_INTEGRATE_AND_FIRE_8_Q8_8_SIZE 12u
typedef struct sw_integrate_and_fire_8_q8_8 {
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_Q8_8_SIZE / 4u];
} sw_integrate_and_fire_8_q8_8;
#define SW_INTEGRATE_AND_FIRE_8_Q8_8_ENCODER_STATE_SIZE 8u
typedef struct sw_integrate_and_fire_8_q8_8_encoder {
    const struct sw_integrate_and_fire_8_q8_8 *codec;
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_integrate_and_fire_8_q8_8_encoder;
#define SW_INTEGRATE_AND_FIRE_8_Q8_8_DECODER_STATE_SIZE 4u
typedef struct sw_integrate_and_fire_8_q8_8_decoder {
    const struct sw_integrate_and_fire_8_q8_8 *codec;
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_Q8_8_DECODER_STATE_SIZE / 4u];
} sw_integrate_and_fire_8_q8_8_decoder;
typedef int8_t sw_integrate_and_fire_8_q8_8_code;
SW_STATIC_ASSERT(integrate_and_fire_8_q8_8, sizeof(sw_integrate_and_fire_8_q8_8) == SW_INTEGRATE_AND_FIRE_8_Q8_8_SIZE);
SW_STATIC_ASSERT(integrate_and_fire_8_q8_8_code, sizeof(sw_integrate_and_fire_8_q8_8_code) == 1u);
/* `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to
 * 15; `reference`: the value without spikes. */
sw_status sw_integrate_and_fire_8_q8_8_init(
    sw_integrate_and_fire_8_q8_8 *codec,
    sw_q8_8 threshold,
    uint8_t power,
    sw_q8_8 reference,
    sw_error *error);
SW_CODEC(integrate_and_fire_8_q8_8, sw_q8_8);

#define SW_INTEGRATE_AND_FIRE_8_Q16_16_LATENCY 0u
#define SW_INTEGRATE_AND_FIRE_8_Q16_16_NEURONS 1u
#define SW_INTEGRATE_AND_FIRE_8_Q16_16_SLOTS 8u
#define SW_INTEGRATE_AND_FIRE_8_Q16_16_SIZE 16u
typedef struct sw_integrate_and_fire_8_q16_16 {
    uint32_t storage[SW_INTEGRATE_AND_FIRE_8_Q16_16_SIZE / 4u];
} sw_integrate_and_fire_8_q16_16;
#define SW_INTEGRATE_AND_FIRE_8_Q16_16_ENCODER_STATE_SIZE 16u
typedef struct sw_integrate_and_fire_8_q16_16_encoder {
    const struct sw_integrate_and_fire_8_q16_16 *codec;
    uint64_t storage[SW_INTEGRATE_AND_FIRE_8_Q16_16_ENCODER_STATE_SIZE / 8u];
} sw_integrate_and_fire_8_q16_16_encoder;
#define SW_INTEGRATE_AND_FIRE_8_Q16_16_DECODER_STATE_SIZE 8u
typedef struct sw_integrate_and_fire_8_q16_16_decoder {
    const struct sw_integrate_and_fire_8_q16_16 *codec;
    uint64_t storage[SW_INTEGRATE_AND_FIRE_8_Q16_16_DECODER_STATE_SIZE / 8u];
} sw_integrate_and_fire_8_q16_16_decoder;
typedef int8_t sw_integrate_and_fire_8_q16_16_code;
SW_STATIC_ASSERT(integrate_and_fire_8_q16_16, sizeof(sw_integrate_and_fire_8_q16_16) == SW_INTEGRATE_AND_FIRE_8_Q16_16_SIZE);
SW_STATIC_ASSERT(integrate_and_fire_8_q16_16_code, sizeof(sw_integrate_and_fire_8_q16_16_code) == 1u);
/* `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to
 * 15; `reference`: the value without spikes. */
sw_status sw_integrate_and_fire_8_q16_16_init(
    sw_integrate_and_fire_8_q16_16 *codec,
    sw_q16_16 threshold,
    uint8_t power,
    sw_q16_16 reference,
    sw_error *error);
SW_CODEC(integrate_and_fire_8_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
