// What one would write by hand for network D, to compare with: blocks of outputs whose sums stay in registers over all
// spikes, lists of spikes, neurons fixed to what the network needs. Plain C, no intrinsics.

#include <stddef.h>
#include <stdint.h>

enum { INPUTS = 16, NEURONS = 256, OUTPUTS = 4, FOURS = 2 };

#define STATE(T)                                                                                                       \
    {                                                                                                                  \
        T current[NEURONS], potential[NEURONS], output[OUTPUTS];                                                       \
        uint16_t fired[NEURONS], before[NEURONS];                                                                      \
        size_t count;                                                                                                  \
    }

struct float_neuron {
    float current_decay, decay, bias, threshold;
};
struct float_state STATE(float);

// Each sum has a name, as compilers leave arrays in memory.
#define EACH(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7) DO(8) DO(9) DO(10) DO(11) DO(12) DO(13) DO(14) DO(15)
#define START(k) float sum##k = neurons[first + k].bias;
#define ADD(k) sum##k += row[k];
#define STEP(k)                                                                                                        \
    {                                                                                                                  \
        const struct float_neuron *neuron = &neurons[first + k];                                                       \
        float current = s->current[first + k] * neuron->current_decay + sum##k;                                        \
        float v = s->potential[first + k] * neuron->decay + current;                                                   \
        s->fired[fired] = first + k;                                                                                   \
        fired += v > neuron->threshold;                                                                                \
        s->current[first + k] = current;                                                                               \
        s->potential[first + k] = v > neuron->threshold ? 0 : v;                                                       \
    }

size_t plain_float(const float *in, const float *back, const float *out, const struct float_neuron *neurons,
                   struct float_state *s, const uint16_t *inputs, size_t count) {
    size_t before = s->count, fired = 0;
    for (size_t at = 0; at < before; at++) s->before[at] = s->fired[at];
    for (size_t first = 0; first < NEURONS; first += 16) {
        EACH(START)
        for (size_t at = 0; at < count; at++) {
            const float *row = in + inputs[at] * NEURONS + first;
            EACH(ADD)
        }
        for (size_t at = 0; at < before; at++) {
            const float *row = back + s->before[at] * NEURONS + first;
            EACH(ADD)
        }
        EACH(STEP)
    }
    s->count = fired;
    float sum[OUTPUTS] = {0};
    for (size_t at = 0; at < fired; at++)
        for (size_t k = 0; k < OUTPUTS; k++) sum[k] += out[s->fired[at] * OUTPUTS + k];
    for (size_t k = 0; k < OUTPUTS; k++) s->output[k] = s->output[k] * 0.25f + sum[k];
    return fired;
}

struct int_neuron {
    int32_t current_decay, decay, bias, threshold;
};
struct int_state STATE(int32_t);

// Four bytes a word, which are the weights + 128: `odd` has the sums of two, `all` these times 256 and the others.
static void add_bytes(uint32_t *restrict all, uint32_t *restrict odd, const uint32_t *rows, const uint16_t *spikes,
                      size_t count) {
    for (size_t at = 0; at < count; at++) {
        const uint32_t *row = rows + spikes[at] * (NEURONS / 4);
        for (size_t k = 0; k < FOURS; k++) {
            all[k] += row[k];
            odd[k] += row[k] >> 8 & 0x00ff00ff;
        }
    }
}

static int32_t scaled(int32_t value, int32_t factor) {
#ifdef __ARM_FEATURE_DSP
    return (int64_t)value * factor >> 16;
#else
    return (value >> 16) * factor + (int32_t)((uint32_t)(value & 0xffff) * (uint32_t)factor >> 16);
#endif
}

size_t plain_int(const uint32_t *in, const uint32_t *back, const int8_t *out, const struct int_neuron *neurons,
                 struct int_state *s, const uint16_t *inputs, size_t count) {
    size_t before = s->count, fired = 0;
    int32_t offset = (int32_t)(count + before) * 128;
    for (size_t at = 0; at < before; at++) s->before[at] = s->fired[at];
    for (size_t first = 0; first < NEURONS; first += 4 * FOURS) {
        uint32_t all[FOURS] = {0}, odd[FOURS] = {0};
        add_bytes(all, odd, in + first / 4, inputs, count);
        add_bytes(all, odd, back + first / 4, s->before, before);
        for (size_t k = 0; k < FOURS; k++) {
            uint32_t even = all[k] - (odd[k] << 8);
            uint32_t each[4] = {even & 0xffff, odd[k] & 0xffff, even >> 16, odd[k] >> 16};
            for (size_t j = 0; j < 4; j++) {
                size_t at = first + 4 * k + j;
                int32_t sum = neurons[at].bias + (((int32_t)each[j] - offset) << 4);
                int32_t current = scaled(s->current[at], neurons[at].current_decay) + sum;
                int32_t v = scaled(s->potential[at], neurons[at].decay) + current;
                s->fired[fired] = at;
                fired += v > neurons[at].threshold;
                s->current[at] = current;
                s->potential[at] = v > neurons[at].threshold ? 0 : v;
            }
        }
    }
    s->count = fired;
    int32_t sum[OUTPUTS] = {0};
    for (size_t at = 0; at < fired; at++)
        for (size_t k = 0; k < OUTPUTS; k++) sum[k] += out[s->fired[at] * OUTPUTS + k];
    for (size_t k = 0; k < OUTPUTS; k++) s->output[k] = scaled(s->output[k], 16384) + (sum[k] << 4);
    return fired;
}
