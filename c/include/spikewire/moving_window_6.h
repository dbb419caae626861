/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_MOVING_WINDOW_6_H
#define SPIKEWIRE_MOVING_WINDOW_6_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Moving window (MW): changes against a short past; drifts.
 *
 * Latency: 0 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 1. */
#define SW_MOVING_WINDOW_6_F32_LATENCY 0u
#define SW_MOVING_WINDOW_6_F32_NEURONS 1u
#define SW_MOVING_WINDOW_6_F32_SLOTS 1u
#define SW_MOVING_WINDOW_6_F32_SIZE 16u
typedef struct sw_moving_window_6_f32 {
    uint32_t storage[SW_MOVING_WINDOW_6_F32_SIZE / 4u];
} sw_moving_window_6_f32;
#define SW_MOVING_WINDOW_6_F32_ENCODER_STATE_SIZE 36u
typedef struct sw_moving_window_6_f32_encoder {
    const struct sw_moving_window_6_f32 *codec;
    uint32_t storage[SW_MOVING_WINDOW_6_F32_ENCODER_STATE_SIZE / 4u];
} sw_moving_window_6_f32_encoder;
#define SW_MOVING_WINDOW_6_F32_DECODER_STATE_SIZE 4u
typedef struct sw_moving_window_6_f32_decoder {
    const struct sw_moving_window_6_f32 *codec;
    uint32_t storage[SW_MOVING_WINDOW_6_F32_DECODER_STATE_SIZE / 4u];
} sw_moving_window_6_f32_decoder;
typedef int8_t sw_moving_window_6_f32_code;
SW_STATIC_ASSERT(moving_window_6_f32, sizeof(sw_moving_window_6_f32) == SW_MOVING_WINDOW_6_F32_SIZE);
SW_STATIC_ASSERT(moving_window_6_f32_code, sizeof(sw_moving_window_6_f32_code) == 1u);
/* `threshold`: what the distance from the window's mean must exceed, above 0. */
sw_status sw_moving_window_6_f32_init(sw_moving_window_6_f32 *codec, float threshold, sw_error *error);
SW_CODEC(moving_window_6_f32, float);

#define SW_MOVING_WINDOW_6_I16_LATENCY 0u
#define SW_MOVING_WINDOW_6_I16_NEURONS 1u
#define SW_MOVING_WINDOW_6_I16_SLOTS 1u
#define SW_MOVING_WINDOW_6_I16_SIZE 16u
typedef struct sw_moving_window_6_i16 {
    uint32_t storage[SW_MOVING_WINDOW_6_I16_SIZE / 4u];
} sw_moving_window_6_i16;
#define SW_MOVING_WINDOW_6_I16_ENCODER_STATE_SIZE 24u
typedef struct sw_moving_window_6_i16_encoder {
    const struct sw_moving_window_6_i16 *codec;
    uint32_t storage[SW_MOVING_WINDOW_6_I16_ENCODER_STATE_SIZE / 4u];
} sw_moving_window_6_i16_encoder;
#define SW_MOVING_WINDOW_6_I16_DECODER_STATE_SIZE 2u
typedef struct sw_moving_window_6_i16_decoder {
    const struct sw_moving_window_6_i16 *codec;
    uint16_t storage[SW_MOVING_WINDOW_6_I16_DECODER_STATE_SIZE / 2u];
} sw_moving_window_6_i16_decoder;
typedef int8_t sw_moving_window_6_i16_code;
SW_STATIC_ASSERT(moving_window_6_i16, sizeof(sw_moving_window_6_i16) == SW_MOVING_WINDOW_6_I16_SIZE);
SW_STATIC_ASSERT(moving_window_6_i16_code, sizeof(sw_moving_window_6_i16_code) == 1u);
/* `threshold`: what the distance from the window's mean must exceed, above 0. */
sw_status sw_moving_window_6_i16_init(sw_moving_window_6_i16 *codec, int16_t threshold, sw_error *error);
SW_CODEC(moving_window_6_i16, int16_t);

#define SW_MOVING_WINDOW_6_Q8_8_LATENCY 0u
#define SW_MOVING_WINDOW_6_Q8_8_NEURONS 1u
#define SW_MOVING_WINDOW_6_Q8_8_SLOTS 1u
#define SW_MOVING_WINDOW_6_Q8_8_SIZE 16u
typedef struct sw_moving_window_6_q8_8 {
    uint32_t storage[SW_MOVING_WINDOW_6_Q8_8_SIZE / 4u];
} sw_moving_window_6_q8_8;
#define SW_MOVING_WINDOW_6_Q8_8_ENCODER_STATE_SIZE 24u
typedef struct sw_moving_window_6_q8_8_encoder {
    const struct sw_moving_window_6_q8_8 *codec;
    uint32_t storage[SW_MOVING_WINDOW_6_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_moving_window_6_q8_8_encoder;
#define SW_MOVING_WINDOW_6_Q8_8_DECODER_STATE_SIZE 2u
typedef struct sw_moving_window_6_q8_8_decoder {
    const struct sw_moving_window_6_q8_8 *codec;
    uint16_t storage[SW_MOVING_WINDOW_6_Q8_8_DECODER_STATE_SIZE / 2u];
} sw_moving_window_6_q8_8_decoder;
typedef int8_t sw_moving_window_6_q8_8_code;
SW_STATIC_ASSERT(moving_window_6_q8_8, sizeof(sw_moving_window_6_q8_8) == SW_MOVING_WINDOW_6_Q8_8_SIZE);
SW_STATIC_ASSERT(moving_window_6_q8_8_code, sizeof(sw_moving_window_6_q8_8_code) == 1u);
/* `threshold`: what the distance from the window's mean must exceed, above 0. */
sw_status sw_moving_window_6_q8_8_init(sw_moving_window_6_q8_8 *codec, sw_q8_8 threshold, sw_error *error);
SW_CODEC(moving_window_6_q8_8, sw_q8_8);

#define SW_MOVING_WINDOW_6_Q16_16_LATENCY 0u
#define SW_MOVING_WINDOW_6_Q16_16_NEURONS 1u
#define SW_MOVING_WINDOW_6_Q16_16_SLOTS 1u
#define SW_MOVING_WINDOW_6_Q16_16_SIZE 24u
typedef struct sw_moving_window_6_q16_16 {
    uint64_t storage[SW_MOVING_WINDOW_6_Q16_16_SIZE / 8u];
} sw_moving_window_6_q16_16;
#define SW_MOVING_WINDOW_6_Q16_16_ENCODER_STATE_SIZE 40u
typedef struct sw_moving_window_6_q16_16_encoder {
    const struct sw_moving_window_6_q16_16 *codec;
    uint64_t storage[SW_MOVING_WINDOW_6_Q16_16_ENCODER_STATE_SIZE / 8u];
} sw_moving_window_6_q16_16_encoder;
#define SW_MOVING_WINDOW_6_Q16_16_DECODER_STATE_SIZE 4u
typedef struct sw_moving_window_6_q16_16_decoder {
    const struct sw_moving_window_6_q16_16 *codec;
    uint32_t storage[SW_MOVING_WINDOW_6_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_moving_window_6_q16_16_decoder;
typedef int8_t sw_moving_window_6_q16_16_code;
SW_STATIC_ASSERT(moving_window_6_q16_16, sizeof(sw_moving_window_6_q16_16) == SW_MOVING_WINDOW_6_Q16_16_SIZE);
SW_STATIC_ASSERT(moving_window_6_q16_16_code, sizeof(sw_moving_window_6_q16_16_code) == 1u);
/* `threshold`: what the distance from the window's mean must exceed, above 0. */
sw_status sw_moving_window_6_q16_16_init(sw_moving_window_6_q16_16 *codec, sw_q16_16 threshold, sw_error *error);
SW_CODEC(moving_window_6_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
