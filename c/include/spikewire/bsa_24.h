/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_BSA_24_H
#define SPIKEWIRE_BSA_24_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
 *
 * Latency: 23 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 1. */
#define SW_BSA_24_F32_LATENCY 23u
#define SW_BSA_24_F32_NEURONS 1u
#define SW_BSA_24_F32_SLOTS 1u
#define SW_BSA_24_F32_SIZE 216u
typedef struct sw_bsa_24_f32 {
    uint32_t storage[SW_BSA_24_F32_SIZE / 4u];
} sw_bsa_24_f32;
#define SW_BSA_24_F32_ENCODER_STATE_SIZE 104u
typedef struct sw_bsa_24_f32_encoder {
    const struct sw_bsa_24_f32 *codec;
    uint32_t storage[SW_BSA_24_F32_ENCODER_STATE_SIZE / 4u];
} sw_bsa_24_f32_encoder;
#define SW_BSA_24_F32_DECODER_STATE_SIZE 100u
typedef struct sw_bsa_24_f32_decoder {
    const struct sw_bsa_24_f32 *codec;
    uint32_t storage[SW_BSA_24_F32_DECODER_STATE_SIZE / 4u];
} sw_bsa_24_f32_decoder;
typedef int8_t sw_bsa_24_f32_code;
SW_STATIC_ASSERT(bsa_24_f32, sizeof(sw_bsa_24_f32) == SW_BSA_24_F32_SIZE);
SW_STATIC_ASSERT(bsa_24_f32_code, sizeof(sw_bsa_24_f32_code) == 1u);
/* `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their
 * minimum. */
sw_status sw_bsa_24_f32_init(
    sw_bsa_24_f32 *codec,
    const float taps[24],
    float threshold,
    float shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_f32_init_sum(
    sw_bsa_24_f32 *codec,
    uint8_t shape,
    float sum,
    float threshold,
    float shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4;
 * `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_f32_init_factor(
    sw_bsa_24_f32 *codec,
    uint8_t shape,
    float sum,
    float factor,
    float shift,
    sw_error *error);
SW_CODEC(bsa_24_f32, float);

#define SW_BSA_24_I16_LATENCY 23u
#define SW_BSA_24_I16_NEURONS 1u
#define SW_BSA_24_I16_SLOTS 1u
#define SW_BSA_24_I16_SIZE 120u
typedef struct sw_bsa_24_i16 {
    uint32_t storage[SW_BSA_24_I16_SIZE / 4u];
} sw_bsa_24_i16;
#define SW_BSA_24_I16_ENCODER_STATE_SIZE 104u
typedef struct sw_bsa_24_i16_encoder {
    const struct sw_bsa_24_i16 *codec;
    uint32_t storage[SW_BSA_24_I16_ENCODER_STATE_SIZE / 4u];
} sw_bsa_24_i16_encoder;
#define SW_BSA_24_I16_DECODER_STATE_SIZE 100u
typedef struct sw_bsa_24_i16_decoder {
    const struct sw_bsa_24_i16 *codec;
    uint32_t storage[SW_BSA_24_I16_DECODER_STATE_SIZE / 4u];
} sw_bsa_24_i16_decoder;
typedef int8_t sw_bsa_24_i16_code;
SW_STATIC_ASSERT(bsa_24_i16, sizeof(sw_bsa_24_i16) == SW_BSA_24_I16_SIZE);
SW_STATIC_ASSERT(bsa_24_i16_code, sizeof(sw_bsa_24_i16_code) == 1u);
/* `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their
 * minimum. */
sw_status sw_bsa_24_i16_init(
    sw_bsa_24_i16 *codec,
    const int16_t taps[24],
    int16_t threshold,
    int16_t shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_i16_init_sum(
    sw_bsa_24_i16 *codec,
    uint8_t shape,
    int16_t sum,
    int16_t threshold,
    int16_t shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4;
 * `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_i16_init_factor(
    sw_bsa_24_i16 *codec,
    uint8_t shape,
    int16_t sum,
    float factor,
    int16_t shift,
    sw_error *error);
SW_CODEC(bsa_24_i16, int16_t);

#define SW_BSA_24_Q8_8_LATENCY 23u
#define SW_BSA_24_Q8_8_NEURONS 1u
#define SW_BSA_24_Q8_8_SLOTS 1u
#define SW_BSA_24_Q8_8_SIZE 120u
typedef struct sw_bsa_24_q8_8 {
    uint32_t storage[SW_BSA_24_Q8_8_SIZE / 4u];
} sw_bsa_24_q8_8;
#define SW_BSA_24_Q8_8_ENCODER_STATE_SIZE 104u
typedef struct sw_bsa_24_q8_8_encoder {
    const struct sw_bsa_24_q8_8 *codec;
    uint32_t storage[SW_BSA_24_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_bsa_24_q8_8_encoder;
#define SW_BSA_24_Q8_8_DECODER_STATE_SIZE 100u
typedef struct sw_bsa_24_q8_8_decoder {
    const struct sw_bsa_24_q8_8 *codec;
    uint32_t storage[SW_BSA_24_Q8_8_DECODER_STATE_SIZE / 4u];
} sw_bsa_24_q8_8_decoder;
typedef int8_t sw_bsa_24_q8_8_code;
SW_STATIC_ASSERT(bsa_24_q8_8, sizeof(sw_bsa_24_q8_8) == SW_BSA_24_Q8_8_SIZE);
SW_STATIC_ASSERT(bsa_24_q8_8_code, sizeof(sw_bsa_24_q8_8_code) == 1u);
/* `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their
 * minimum. */
sw_status sw_bsa_24_q8_8_init(
    sw_bsa_24_q8_8 *codec,
    const sw_q8_8 taps[24],
    sw_q8_8 threshold,
    sw_q8_8 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_q8_8_init_sum(
    sw_bsa_24_q8_8 *codec,
    uint8_t shape,
    sw_q8_8 sum,
    sw_q8_8 threshold,
    sw_q8_8 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4;
 * `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_q8_8_init_factor(
    sw_bsa_24_q8_8 *codec,
    uint8_t shape,
    sw_q8_8 sum,
    float factor,
    sw_q8_8 shift,
    sw_error *error);
SW_CODEC(bsa_24_q8_8, sw_q8_8);

#define SW_BSA_24_Q16_16_LATENCY 23u
#define SW_BSA_24_Q16_16_NEURONS 1u
#define SW_BSA_24_Q16_16_SLOTS 1u
#define SW_BSA_24_Q16_16_SIZE 216u
typedef struct sw_bsa_24_q16_16 {
    uint32_t storage[SW_BSA_24_Q16_16_SIZE / 4u];
} sw_bsa_24_q16_16;
#define SW_BSA_24_Q16_16_ENCODER_STATE_SIZE 104u
typedef struct sw_bsa_24_q16_16_encoder {
    const struct sw_bsa_24_q16_16 *codec;
    uint32_t storage[SW_BSA_24_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_bsa_24_q16_16_encoder;
#define SW_BSA_24_Q16_16_DECODER_STATE_SIZE 100u
typedef struct sw_bsa_24_q16_16_decoder {
    const struct sw_bsa_24_q16_16 *codec;
    uint32_t storage[SW_BSA_24_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_bsa_24_q16_16_decoder;
typedef int8_t sw_bsa_24_q16_16_code;
SW_STATIC_ASSERT(bsa_24_q16_16, sizeof(sw_bsa_24_q16_16) == SW_BSA_24_Q16_16_SIZE);
SW_STATIC_ASSERT(bsa_24_q16_16_code, sizeof(sw_bsa_24_q16_16_code) == 1u);
/* `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their
 * minimum. */
sw_status sw_bsa_24_q16_16_init(
    sw_bsa_24_q16_16 *codec,
    const sw_q16_16 taps[24],
    sw_q16_16 threshold,
    sw_q16_16 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_q16_16_init_sum(
    sw_bsa_24_q16_16 *codec,
    uint8_t shape,
    sw_q16_16 sum,
    sw_q16_16 threshold,
    sw_q16_16 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4;
 * `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_24_q16_16_init_factor(
    sw_bsa_24_q16_16 *codec,
    uint8_t shape,
    sw_q16_16 sum,
    float factor,
    sw_q16_16 shift,
    sw_error *error);
SW_CODEC(bsa_24_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
