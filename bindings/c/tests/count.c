/* What the calls take on a recorded flight, in instructions: the same work as examples/c-boundary does in Rust. */
#include "board.h"
#include "spikewire/all.h"
#include "recording.h"

/* Where the flight is lively, and how long. */
#define FIRST 1000u
#define LENGTH 800u
/* Samples of a call of the slice forms. */
#define SLICE 200u

#define SYST ((volatile uint32_t *)0xE000E010u)

/* Ticks of the core's timer, by the core's clock, for what lies between. */
static void begin(void)
{
    SYST[0] = 4u;
    SYST[1] = 0xffffffu;
    SYST[2] = 0u;
    SYST[0] = 5u;
}

static uint32_t end(void)
{
    SYST[0] = 4u;
    return 0xffffffu - SYST[2];
}

static uint32_t nothing;

static uint32_t count(uint32_t ticks)
{
    uint64_t gigaticks = (uint64_t)(ticks - nothing) * 1000000000u;
    return (uint32_t)((gigaticks + (TICKS_PER_GIGAINSTRUCTION / 2u)) / TICKS_PER_GIGAINSTRUCTION);
}

static void print_count(const char *name, uint32_t number)
{
    board_print(name);
    print_number(number, 10u, 1u);
}

#define FLY(CODEC, LATENCY, S, LABEL, INIT, ...) FLY_(CODEC, S, LABEL, INIT, CODEC##_##INIT, __VA_ARGS__)

#define FLY_(CODEC, S, LABEL, INIT, NAME, ...)                                                                        \
    static void count_##NAME(void)                                                                                    \
    {                                                                                                                 \
        sw_##CODEC codec = {0};                                                                                       \
        sw_##CODEC##_encoder encoder = {0};                                                                           \
        sw_##CODEC##_decoder decoder = {0};                                                                           \
        value_type_##S slice[SLICE] = {0}, values[SLICE] = {0};                                                       \
        sw_##CODEC##_code codes[SLICE] = {0}, first = {0};                                                      \
        sw_status statuses[SLICE] = {0};                                                                              \
        const channel_##S *channel = &channels_##S[0];                                                                \
        uint32_t encode = 0, encode_slice = 0, decode = 0, decode_slice = 0;                                          \
        check(sw_##CODEC##_##INIT(&codec, __VA_ARGS__, NULL), "init");                                                \
        check(sw_##CODEC##_encoder_start(&encoder, &codec), "encoder_start");                                         \
        check(sw_##CODEC##_decoder_start(&decoder, &codec), "decoder_start");                                         \
        for (uint32_t i = 0; i < LENGTH; i += SLICE) {                                                                \
            for (uint32_t j = 0; j < SLICE; ++j) {                                                                    \
                slice[j] = at_##S(FIRST + i + j, 0);                                                                  \
            }                                                                                                         \
            if (i < LENGTH / 2u) {                                                                                    \
                begin();                                                                                              \
                for (uint32_t j = 0; j < SLICE; ++j) {                                                                \
                    statuses[j] = sw_##CODEC##_encode(&encoder, slice[j], &codes[j]);                                 \
                }                                                                                                     \
                encode += count(end());                                                                               \
                for (uint32_t j = 0; j < SLICE; ++j) {                                                                \
                    if (statuses[j] == SW_OK) {                                                                       \
                        begin();                                                                                      \
                        statuses[j] = sw_##CODEC##_decode(&decoder, &codes[j], &values[j]);                           \
                        decode += count(end());                                                                       \
                    }                                                                                                 \
                }                                                                                                     \
            } else {                                                                                                  \
                check(sw_##CODEC##_encode(&encoder, slice[0], &first), "encode");                                   \
                begin();                                                                                              \
                sw_status status = sw_##CODEC##_encode_slice(&encoder, &slice[1], codes, SLICE - 1u);                 \
                encode_slice += count(end());                                                                         \
                check(status, "encode_slice");                                                                        \
                begin();                                                                                              \
                status = sw_##CODEC##_decode_slice(&decoder, codes, values, SLICE - 1u);                              \
                decode_slice += count(end());                                                                         \
                check(status, "decode_slice");                                                                        \
            }                                                                                                         \
        }                                                                                                             \
        board_print(LABEL " " SAMPLE_##S);                                                                            \
        print_count(" encode ", encode);                                                                              \
        print_count(" encode_slice ", encode_slice);                                                                  \
        print_count(" decode ", decode);                                                                              \
        print_count(" decode_slice ", decode_slice);                                                                  \
        board_print("\n");                                                                                            \
    }

#include "flown.h"

#undef FLY
#define FLY(CODEC, LATENCY, S, LABEL, INIT, ...) count_##CODEC##_##INIT();

int main(void)
{
    calibrate();
    begin();
    nothing = end();
#include "flown.h"
    board_finish(is_good);
    return 0;
}
