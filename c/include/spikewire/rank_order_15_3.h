/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */
#ifndef SPIKEWIRE_RANK_ORDER_15_3_H
#define SPIKEWIRE_RANK_ORDER_15_3_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

/* Rank order: a value finer than the neurons, by who fires first.
 *
 * Latency: 0 samples. Neurons of a channel: 15. Sub-timesteps of a sample: 3. */
#define SW_RANK_ORDER_15_3_F32_LATENCY 0u
#define SW_RANK_ORDER_15_3_F32_NEURONS 15u
#define SW_RANK_ORDER_15_3_F32_SLOTS 3u
#define SW_RANK_ORDER_15_3_F32_SIZE 172u
typedef struct sw_rank_order_15_3_f32 {
    uint32_t storage[SW_RANK_ORDER_15_3_F32_SIZE / 4u];
} sw_rank_order_15_3_f32;
#define SW_RANK_ORDER_15_3_F32_ENCODER_STATE_SIZE 4u
typedef struct sw_rank_order_15_3_f32_encoder {
    const struct sw_rank_order_15_3_f32 *codec;
    uint32_t storage[SW_RANK_ORDER_15_3_F32_ENCODER_STATE_SIZE / 4u];
} sw_rank_order_15_3_f32_encoder;
#define SW_RANK_ORDER_15_3_F32_DECODER_STATE_SIZE 4u
typedef struct sw_rank_order_15_3_f32_decoder {
    const struct sw_rank_order_15_3_f32 *codec;
    uint32_t storage[SW_RANK_ORDER_15_3_F32_DECODER_STATE_SIZE / 4u];
} sw_rank_order_15_3_f32_decoder;
#define SW_RANK_ORDER_15_3_F32_CODE_SIZE 20u
typedef struct sw_rank_order_15_3_f32_code {
    uint32_t storage[SW_RANK_ORDER_15_3_F32_CODE_SIZE / 4u];
} sw_rank_order_15_3_f32_code;
SW_STATIC_ASSERT(rank_order_15_3_f32, sizeof(sw_rank_order_15_3_f32) == SW_RANK_ORDER_15_3_F32_SIZE);
SW_STATIC_ASSERT(rank_order_15_3_f32_code, sizeof(sw_rank_order_15_3_f32_code) == 20u);
/* `centres`: of the neurons, rising. */
sw_status sw_rank_order_15_3_f32_init(sw_rank_order_15_3_f32 *codec, const float centres[15], sw_error *error);
/* `min`, `max`: the range, which must rise. The centres are evenly spaced. */
sw_status sw_rank_order_15_3_f32_init_linear(sw_rank_order_15_3_f32 *codec, float min, float max, sw_error *error);
SW_CODEC(rank_order_15_3_f32, float);

#define SW_RANK_ORDER_15_3_I16_LATENCY 0u
#define SW_RANK_ORDER_15_3_I16_NEURONS 15u
#define SW_RANK_ORDER_15_3_I16_SLOTS 3u
#define SW_RANK_ORDER_15_3_I16_SIZE 108u
typedef struct sw_rank_order_15_3_i16 {
    uint32_t storage[SW_RANK_ORDER_15_3_I16_SIZE / 4u];
} sw_rank_order_15_3_i16;
#define SW_RANK_ORDER_15_3_I16_ENCODER_STATE_SIZE 4u
typedef struct sw_rank_order_15_3_i16_encoder {
    const struct sw_rank_order_15_3_i16 *codec;
    uint32_t storage[SW_RANK_ORDER_15_3_I16_ENCODER_STATE_SIZE / 4u];
} sw_rank_order_15_3_i16_encoder;
#define SW_RANK_ORDER_15_3_I16_DECODER_STATE_SIZE 2u
typedef struct sw_rank_order_15_3_i16_decoder {
    const struct sw_rank_order_15_3_i16 *codec;
    uint16_t storage[SW_RANK_ORDER_15_3_I16_DECODER_STATE_SIZE / 2u];
} sw_rank_order_15_3_i16_decoder;
#define SW_RANK_ORDER_15_3_I16_CODE_SIZE 20u
typedef struct sw_rank_order_15_3_i16_code {
    uint32_t storage[SW_RANK_ORDER_15_3_I16_CODE_SIZE / 4u];
} sw_rank_order_15_3_i16_code;
SW_STATIC_ASSERT(rank_order_15_3_i16, sizeof(sw_rank_order_15_3_i16) == SW_RANK_ORDER_15_3_I16_SIZE);
SW_STATIC_ASSERT(rank_order_15_3_i16_code, sizeof(sw_rank_order_15_3_i16_code) == 20u);
/* `centres`: of the neurons, rising. */
sw_status sw_rank_order_15_3_i16_init(sw_rank_order_15_3_i16 *codec, const int16_t centres[15], sw_error *error);
/* `min`, `max`: the range, which must rise. The centres are evenly spaced. */
sw_status sw_rank_order_15_3_i16_init_linear(sw_rank_order_15_3_i16 *codec, int16_t min, int16_t max, sw_error *error);
SW_CODEC(rank_order_15_3_i16, int16_t);

#define SW_RANK_ORDER_15_3_Q8_8_LATENCY 0u
#define SW_RANK_ORDER_15_3_Q8_8_NEURONS 15u
#define SW_RANK_ORDER_15_3_Q8_8_SLOTS 3u
#define SW_RANK_ORDER_15_3_Q8_8_SIZE 108u
typedef struct sw_rank_order_15_3_q8_8 {
    uint32_t storage[SW_RANK_ORDER_15_3_Q8_8_SIZE / 4u];
} sw_rank_order_15_3_q8_8;
#define SW_RANK_ORDER_15_3_Q8_8_ENCODER_STATE_SIZE 4u
typedef struct sw_rank_order_15_3_q8_8_encoder {
    const struct sw_rank_order_15_3_q8_8 *codec;
    uint32_t storage[SW_RANK_ORDER_15_3_Q8_8_ENCODER_STATE_SIZE / 4u];
} sw_rank_order_15_3_q8_8_encoder;
#define SW_RANK_ORDER_15_3_Q8_8_DECODER_STATE_SIZE 2u
typedef struct sw_rank_order_15_3_q8_8_decoder {
    const struct sw_rank_order_15_3_q8_8 *codec;
    uint16_t storage[SW_RANK_ORDER_15_3_Q8_8_DECODER_STATE_SIZE / 2u];
} sw_rank_order_15_3_q8_8_decoder;
#define SW_RANK_ORDER_15_3_Q8_8_CODE_SIZE 20u
typedef struct sw_rank_order_15_3_q8_8_code {
    uint32_t storage[SW_RANK_ORDER_15_3_Q8_8_CODE_SIZE / 4u];
} sw_rank_order_15_3_q8_8_code;
SW_STATIC_ASSERT(rank_order_15_3_q8_8, sizeof(sw_rank_order_15_3_q8_8) == SW_RANK_ORDER_15_3_Q8_8_SIZE);
SW_STATIC_ASSERT(rank_order_15_3_q8_8_code, sizeof(sw_rank_order_15_3_q8_8_code) == 20u);
/* `centres`: of the neurons, rising. */
sw_status sw_rank_order_15_3_q8_8_init(sw_rank_order_15_3_q8_8 *codec, const sw_q8_8 centres[15], sw_error *error);
/* `min`, `max`: the range, which must rise. The centres are evenly spaced. */
sw_status sw_rank_order_15_3_q8_8_init_linear(
    sw_rank_order_15_3_q8_8 *codec,
    sw_q8_8 min,
    sw_q8_8 max,
    sw_error *error);
SW_CODEC(rank_order_15_3_q8_8, sw_q8_8);

#define SW_RANK_ORDER_15_3_Q16_16_LATENCY 0u
#define SW_RANK_ORDER_15_3_Q16_16_NEURONS 15u
#define SW_RANK_ORDER_15_3_Q16_16_SLOTS 3u
#define SW_RANK_ORDER_15_3_Q16_16_SIZE 172u
typedef struct sw_rank_order_15_3_q16_16 {
    uint32_t storage[SW_RANK_ORDER_15_3_Q16_16_SIZE / 4u];
} sw_rank_order_15_3_q16_16;
#define SW_RANK_ORDER_15_3_Q16_16_ENCODER_STATE_SIZE 4u
typedef struct sw_rank_order_15_3_q16_16_encoder {
    const struct sw_rank_order_15_3_q16_16 *codec;
    uint32_t storage[SW_RANK_ORDER_15_3_Q16_16_ENCODER_STATE_SIZE / 4u];
} sw_rank_order_15_3_q16_16_encoder;
#define SW_RANK_ORDER_15_3_Q16_16_DECODER_STATE_SIZE 4u
typedef struct sw_rank_order_15_3_q16_16_decoder {
    const struct sw_rank_order_15_3_q16_16 *codec;
    uint32_t storage[SW_RANK_ORDER_15_3_Q16_16_DECODER_STATE_SIZE / 4u];
} sw_rank_order_15_3_q16_16_decoder;
#define SW_RANK_ORDER_15_3_Q16_16_CODE_SIZE 20u
typedef struct sw_rank_order_15_3_q16_16_code {
    uint32_t storage[SW_RANK_ORDER_15_3_Q16_16_CODE_SIZE / 4u];
} sw_rank_order_15_3_q16_16_code;
SW_STATIC_ASSERT(rank_order_15_3_q16_16, sizeof(sw_rank_order_15_3_q16_16) == SW_RANK_ORDER_15_3_Q16_16_SIZE);
SW_STATIC_ASSERT(rank_order_15_3_q16_16_code, sizeof(sw_rank_order_15_3_q16_16_code) == 20u);
/* `centres`: of the neurons, rising. */
sw_status sw_rank_order_15_3_q16_16_init(
    sw_rank_order_15_3_q16_16 *codec,
    const sw_q16_16 centres[15],
    sw_error *error);
/* `min`, `max`: the range, which must rise. The centres are evenly spaced. */
sw_status sw_rank_order_15_3_q16_16_init_linear(
    sw_rank_order_15_3_q16_16 *codec,
    sw_q16_16 min,
    sw_q16_16 max,
    sw_error *error);
SW_CODEC(rank_order_15_3_q16_16, sw_q16_16);

#if defined(__cplusplus)
}
#endif

#endif
