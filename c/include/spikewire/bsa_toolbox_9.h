/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_BSA_TOOLBOX_9_H
#define SPIKEWIRE_BSA_TOOLBOX_9_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
 *
 * Latency: 9 samples. Neurons of a channel: 1. Sub-timesteps of a sample: 1. */
#define SW_BSA_TOOLBOX_9_F32_LATENCY 9u
#define SW_BSA_TOOLBOX_9_F32_NEURONS 1u
#define SW_BSA_TOOLBOX_9_F32_SLOTS 1u
#define SW_BSA_TOOLBOX_9_F32_SIZE 92u
typedef struct sw_bsa_toolbox_9_f32 {
    uint32_t storage[SW_BSA_TOOLBOX_9_F32_SIZE / 4u];
} sw_bsa_toolbox_9_f32;
#define SW_BSA_TOOLBOX_9_F32_ENCODER_STATE_SIZE 48u
typedef struct sw_bsa_toolbox_9_f32_encoder {
    const struct sw_bsa_toolbox_9_f32 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_F32_ENCODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_f32_encoder;
#define SW_BSA_TOOLBOX_9_F32_DECODER_STATE_SIZE 40u
typedef struct sw_bsa_toolbox_9_f32_decoder {
    const struct sw_bsa_toolbox_9_f32 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_F32_DECODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_f32_decoder;
typedef int8_t sw_bsa_toolbox_9_f32_code;
SW_STATIC_ASSERT(bsa_toolbox_9_f32, sizeof(sw_bsa_toolbox_9_f32) == SW_BSA_TOOLBOX_9_F32_SIZE);
SW_STATIC_ASSERT(bsa_toolbox_9_f32_code, sizeof(sw_bsa_toolbox_9_f32_code) == 1u);
/* `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_f32_init(
    sw_bsa_toolbox_9_f32 *codec,
    const float taps[9],
    float factor,
    float shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_f32_init_peak(
    sw_bsa_toolbox_9_f32 *codec,
    uint8_t shape,
    float peak,
    float factor,
    float shift,
    sw_error *error);
SW_CODEC(bsa_toolbox_9_f32, float);

#define SW_BSA_TOOLBOX_9_I16_LATENCY 9u
#define SW_BSA_TOOLBOX_9_I16_NEURONS 1u
#define SW_BSA_TOOLBOX_9_I16_SLOTS 1u
#define SW_BSA_TOOLBOX_9_I16_SIZE 56u
typedef struct sw_bsa_toolbox_9_i16 {
    uint32_t storage[SW_BSA_TOOLBOX_9_I16_SIZE / 4u];
} sw_bsa_toolbox_9_i16;
#define SW_BSA_TOOLBOX_9_I16_ENCODER_STATE_SIZE 48u
typedef struct sw_bsa_toolbox_9_i16_encoder {
    const struct sw_bsa_toolbox_9_i16 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_I16_ENCODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_i16_encoder;
#define SW_BSA_TOOLBOX_9_I16_DECODER_STATE_SIZE 40u
typedef struct sw_bsa_toolbox_9_i16_decoder {
    const struct sw_bsa_toolbox_9_i16 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_I16_DECODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_i16_decoder;
typedef int8_t sw_bsa_toolbox_9_i16_code;
SW_STATIC_ASSERT(bsa_toolbox_9_i16, sizeof(sw_bsa_toolbox_9_i16) == SW_BSA_TOOLBOX_9_I16_SIZE);
SW_STATIC_ASSERT(bsa_toolbox_9_i16_code, sizeof(sw_bsa_toolbox_9_i16_code) == 1u);
/* `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_i16_init(
    sw_bsa_toolbox_9_i16 *codec,
    const int16_t taps[9],
    float factor,
    int16_t shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_i16_init_peak(
    sw_bsa_toolbox_9_i16 *codec,
    uint8_t shape,
    int16_t peak,
    float factor,
    int16_t shift,
    sw_error *error);
SW_CODEC(bsa_toolbox_9_i16, int16_t);

#define SW_BSA_TOOLBOX_9_Q8_8_LATENCY 9u
#define SW_BSA_TOOLBOX_9_Q8_8_NEURONS 1u
#define SW_BSA_TOOLBOX_9_Q8_8_SLOTS 1u
#define SW_BSA_TOOLBOX_9_Q8_8_SIZE 56u
typedef struct sw_bsa_toolbox_9_q8_8 {
    uint32_t storage[SW_BSA_TOOLBOX_9_Q8_8_SIZE / 4u];
} sw_bsa_toolbox_9_q8_8;
#define SW_BSA_TOOLBOX_9_Q8_8_ENCODER_STATE_SIZE 48u
typedef struct sw_bsa_toolbox_9_q8_8_encoder {
    const struct sw_bsa_toolbox_9_q8_8 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_q8_8_encoder;
#define SW_BSA_TOOLBOX_9_Q8_8_DECODER_STATE_SIZE 40u
typedef struct sw_bsa_toolbox_9_q8_8_decoder {
    const struct sw_bsa_toolbox_9_q8_8 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_Q8_8_DECODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_q8_8_decoder;
typedef int8_t sw_bsa_toolbox_9_q8_8_code;
SW_STATIC_ASSERT(bsa_toolbox_9_q8_8, sizeof(sw_bsa_toolbox_9_q8_8) == SW_BSA_TOOLBOX_9_Q8_8_SIZE);
SW_STATIC_ASSERT(bsa_toolbox_9_q8_8_code, sizeof(sw_bsa_toolbox_9_q8_8_code) == 1u);
/* `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_q8_8_init(
    sw_bsa_toolbox_9_q8_8 *codec,
    const sw_q8_8 taps[9],
    float factor,
    sw_q8_8 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_q8_8_init_peak(
    sw_bsa_toolbox_9_q8_8 *codec,
    uint8_t shape,
    sw_q8_8 peak,
    float factor,
    sw_q8_8 shift,
    sw_error *error);
SW_CODEC(bsa_toolbox_9_q8_8, sw_q8_8);

#define SW_BSA_TOOLBOX_9_Q16_16_LATENCY 9u
#define SW_BSA_TOOLBOX_9_Q16_16_NEURONS 1u
#define SW_BSA_TOOLBOX_9_Q16_16_SLOTS 1u
#define SW_BSA_TOOLBOX_9_Q16_16_SIZE 92u
typedef struct sw_bsa_toolbox_9_q16_16 {
    uint32_t storage[SW_BSA_TOOLBOX_9_Q16_16_SIZE / 4u];
} sw_bsa_toolbox_9_q16_16;
#define SW_BSA_TOOLBOX_9_Q16_16_ENCODER_STATE_SIZE 48u
typedef struct sw_bsa_toolbox_9_q16_16_encoder {
    const struct sw_bsa_toolbox_9_q16_16 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_q16_16_encoder;
#define SW_BSA_TOOLBOX_9_Q16_16_DECODER_STATE_SIZE 40u
typedef struct sw_bsa_toolbox_9_q16_16_decoder {
    const struct sw_bsa_toolbox_9_q16_16 *codec;
    uint32_t storage[SW_BSA_TOOLBOX_9_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_bsa_toolbox_9_q16_16_decoder;
typedef int8_t sw_bsa_toolbox_9_q16_16_code;
SW_STATIC_ASSERT(bsa_toolbox_9_q16_16, sizeof(sw_bsa_toolbox_9_q16_16) == SW_BSA_TOOLBOX_9_Q16_16_SIZE);
SW_STATIC_ASSERT(bsa_toolbox_9_q16_16_code, sizeof(sw_bsa_toolbox_9_q16_16_code) == 1u);
/* `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_q16_16_init(
    sw_bsa_toolbox_9_q16_16 *codec,
    const sw_q16_16 taps[9],
    float factor,
    sw_q16_16 shift,
    sw_error *error);
/* `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`:
 * what is taken off the samples, at most their minimum. */
sw_status sw_bsa_toolbox_9_q16_16_init_peak(
    sw_bsa_toolbox_9_q16_16 *codec,
    uint8_t shape,
    sw_q16_16 peak,
    float factor,
    sw_q16_16 shift,
    sw_error *error);
SW_CODEC(bsa_toolbox_9_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
