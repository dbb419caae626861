/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_THRESHOLD_HOUGH_15_H
#define SPIKEWIRE_THRESHOLD_HOUGH_15_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Threshold Hough spiker (T-HSA): the nearest reconstruction of the rate codes at the paper's settings.
 *
 * Latency: 14 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 1. */
#define SW_THRESHOLD_HOUGH_15_F32_LATENCY 14u
#define SW_THRESHOLD_HOUGH_15_F32_NEURONS 1u
#define SW_THRESHOLD_HOUGH_15_F32_SLOTS 1u
#define SW_THRESHOLD_HOUGH_15_F32_SIZE 136u
typedef struct sw_threshold_hough_15_f32 {
    uint32_t storage[SW_THRESHOLD_HOUGH_15_F32_SIZE / 4u];
} sw_threshold_hough_15_f32;
#define SW_THRESHOLD_HOUGH_15_F32_ENCODER_STATE_SIZE 68u
typedef struct sw_threshold_hough_15_f32_encoder {
    const struct sw_threshold_hough_15_f32 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_F32_ENCODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_f32_encoder;
#define SW_THRESHOLD_HOUGH_15_F32_DECODER_STATE_SIZE 64u
typedef struct sw_threshold_hough_15_f32_decoder {
    const struct sw_threshold_hough_15_f32 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_F32_DECODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_f32_decoder;
typedef int8_t sw_threshold_hough_15_f32_code;
SW_STATIC_ASSERT(threshold_hough_15_f32, sizeof(sw_threshold_hough_15_f32) == SW_THRESHOLD_HOUGH_15_F32_SIZE);
SW_STATIC_ASSERT(threshold_hough_15_f32_code, sizeof(sw_threshold_hough_15_f32_code) == 1u);
/* `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is
 * taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_f32_init(
    sw_threshold_hough_15_f32 *codec,
    const float taps[15],
    float threshold,
    float shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may
 * fall short of it in all; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_f32_init_peak(
    sw_threshold_hough_15_f32 *codec,
    uint8_t shape,
    float peak,
    float threshold,
    float shift,
    sw_error *error);
SW_CODEC(threshold_hough_15_f32, float);

#define SW_THRESHOLD_HOUGH_15_I16_LATENCY 14u
#define SW_THRESHOLD_HOUGH_15_I16_NEURONS 1u
#define SW_THRESHOLD_HOUGH_15_I16_SLOTS 1u
#define SW_THRESHOLD_HOUGH_15_I16_SIZE 76u
typedef struct sw_threshold_hough_15_i16 {
    uint32_t storage[SW_THRESHOLD_HOUGH_15_I16_SIZE / 4u];
} sw_threshold_hough_15_i16;
#define SW_THRESHOLD_HOUGH_15_I16_ENCODER_STATE_SIZE 68u
typedef struct sw_threshold_hough_15_i16_encoder {
    const struct sw_threshold_hough_15_i16 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_I16_ENCODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_i16_encoder;
#define SW_THRESHOLD_HOUGH_15_I16_DECODER_STATE_SIZE 64u
typedef struct sw_threshold_hough_15_i16_decoder {
    const struct sw_threshold_hough_15_i16 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_I16_DECODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_i16_decoder;
typedef int8_t sw_threshold_hough_15_i16_code;
SW_STATIC_ASSERT(threshold_hough_15_i16, sizeof(sw_threshold_hough_15_i16) == SW_THRESHOLD_HOUGH_15_I16_SIZE);
SW_STATIC_ASSERT(threshold_hough_15_i16_code, sizeof(sw_threshold_hough_15_i16_code) == 1u);
/* `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is
 * taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_i16_init(
    sw_threshold_hough_15_i16 *codec,
    const int16_t taps[15],
    int16_t threshold,
    int16_t shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may
 * fall short of it in all; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_i16_init_peak(
    sw_threshold_hough_15_i16 *codec,
    uint8_t shape,
    int16_t peak,
    int16_t threshold,
    int16_t shift,
    sw_error *error);
SW_CODEC(threshold_hough_15_i16, int16_t);

#define SW_THRESHOLD_HOUGH_15_Q8_8_LATENCY 14u
#define SW_THRESHOLD_HOUGH_15_Q8_8_NEURONS 1u
#define SW_THRESHOLD_HOUGH_15_Q8_8_SLOTS 1u
#define SW_THRESHOLD_HOUGH_15_Q8_8_SIZE 76u
typedef struct sw_threshold_hough_15_q8_8 {
    uint32_t storage[SW_THRESHOLD_HOUGH_15_Q8_8_SIZE / 4u];
} sw_threshold_hough_15_q8_8;
#define SW_THRESHOLD_HOUGH_15_Q8_8_ENCODER_STATE_SIZE 68u
typedef struct sw_threshold_hough_15_q8_8_encoder {
    const struct sw_threshold_hough_15_q8_8 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_q8_8_encoder;
#define SW_THRESHOLD_HOUGH_15_Q8_8_DECODER_STATE_SIZE 64u
typedef struct sw_threshold_hough_15_q8_8_decoder {
    const struct sw_threshold_hough_15_q8_8 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_Q8_8_DECODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_q8_8_decoder;
typedef int8_t sw_threshold_hough_15_q8_8_code;
SW_STATIC_ASSERT(threshold_hough_15_q8_8, sizeof(sw_threshold_hough_15_q8_8) == SW_THRESHOLD_HOUGH_15_Q8_8_SIZE);
SW_STATIC_ASSERT(threshold_hough_15_q8_8_code, sizeof(sw_threshold_hough_15_q8_8_code) == 1u);
/* `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is
 * taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_q8_8_init(
    sw_threshold_hough_15_q8_8 *codec,
    const sw_q8_8 taps[15],
    sw_q8_8 threshold,
    sw_q8_8 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may
 * fall short of it in all; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_q8_8_init_peak(
    sw_threshold_hough_15_q8_8 *codec,
    uint8_t shape,
    sw_q8_8 peak,
    sw_q8_8 threshold,
    sw_q8_8 shift,
    sw_error *error);
SW_CODEC(threshold_hough_15_q8_8, sw_q8_8);

#define SW_THRESHOLD_HOUGH_15_Q16_16_LATENCY 14u
#define SW_THRESHOLD_HOUGH_15_Q16_16_NEURONS 1u
#define SW_THRESHOLD_HOUGH_15_Q16_16_SLOTS 1u
#define SW_THRESHOLD_HOUGH_15_Q16_16_SIZE 136u
typedef struct sw_threshold_hough_15_q16_16 {
    uint32_t storage[SW_THRESHOLD_HOUGH_15_Q16_16_SIZE / 4u];
} sw_threshold_hough_15_q16_16;
#define SW_THRESHOLD_HOUGH_15_Q16_16_ENCODER_STATE_SIZE 68u
typedef struct sw_threshold_hough_15_q16_16_encoder {
    const struct sw_threshold_hough_15_q16_16 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_q16_16_encoder;
#define SW_THRESHOLD_HOUGH_15_Q16_16_DECODER_STATE_SIZE 64u
typedef struct sw_threshold_hough_15_q16_16_decoder {
    const struct sw_threshold_hough_15_q16_16 *codec;
    uint32_t storage[SW_THRESHOLD_HOUGH_15_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_threshold_hough_15_q16_16_decoder;
typedef int8_t sw_threshold_hough_15_q16_16_code;
SW_STATIC_ASSERT(threshold_hough_15_q16_16, sizeof(sw_threshold_hough_15_q16_16) == SW_THRESHOLD_HOUGH_15_Q16_16_SIZE);
SW_STATIC_ASSERT(threshold_hough_15_q16_16_code, sizeof(sw_threshold_hough_15_q16_16_code) == 1u);
/* `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is
 * taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_q16_16_init(
    sw_threshold_hough_15_q16_16 *codec,
    const sw_q16_16 taps[15],
    sw_q16_16 threshold,
    sw_q16_16 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may
 * fall short of it in all; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_threshold_hough_15_q16_16_init_peak(
    sw_threshold_hough_15_q16_16 *codec,
    uint8_t shape,
    sw_q16_16 peak,
    sw_q16_16 threshold,
    sw_q16_16 shift,
    sw_error *error);
SW_CODEC(threshold_hough_15_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
