// What one would write by hand, to compare with: the codecs of the table with fixed numbers of taps, of averaged samples
// and of spikes, without a look at whether a sample is finite, and with sums that wrap. It is compiled once for each TYPE
// of sample; sums are of type WIDE. `p` are a threshold, both ends of a range, or taps.

#include <stddef.h>
#include <stdint.h>

#define JOINED(name, type) plain_##name##_##type
#define NAMED(name, type) JOINED(name, type)
#define CODEC(name) void NAMED(name, TYPE)(TYPE *restrict x, size_t n, const TYPE *restrict p, int8_t *restrict out)

enum { SPIKES = 4, AVERAGED = 6, TAPS = 15 };

CODEC(tbr) {
    WIDE threshold = p[0];
    for (size_t i = 1; i < n; i++) {
        WIDE change = (WIDE)x[i] - x[i - 1];
        out[i] = change > threshold ? 1 : change < -threshold ? -1 : 0;
    }
}

CODEC(sf) {
    WIDE threshold = p[0], base = x[0];
    for (size_t i = 1; i < n; i++) {
        int8_t spike = 0;
        if (x[i] > base + threshold) {
            spike = 1;
            base += threshold;
        } else if (x[i] < base - threshold) {
            spike = -1;
            base -= threshold;
        }
        out[i] = spike;
    }
}

CODEC(sod) {
    WIDE threshold = p[0], base = x[0];
    for (size_t i = 1; i < n; i++) {
        int8_t count = 0;
        for (; count < SPIKES && x[i] > base + threshold; count++) base += threshold;
        if (count == 0)
            for (; count > -SPIKES && x[i] < base - threshold; count--) base -= threshold;
        out[i] = count;
    }
}

CODEC(mw) {
    WIDE margin = (WIDE)p[0] * AVERAGED, sum = 0;
    for (size_t i = 0; i < AVERAGED; i++) sum += x[i];
    for (size_t i = AVERAGED; i < n; i++) {
        WIDE distance = (WIDE)x[i] * AVERAGED - sum;
        out[i] = distance > margin ? 1 : distance < -margin ? -1 : 0;
        sum += (WIDE)x[i] - x[i - AVERAGED];
    }
}

static inline int8_t fire(WIDE *v, WIDE threshold) {
    int8_t count = 0;
    for (; count < SPIKES && *v >= threshold; count++) *v -= threshold;
    if (count == 0)
        for (; count > -SPIKES && *v <= -threshold; count--) *v += threshold;
    return count;
}

CODEC(if) {
    WIDE v = 0;
    for (size_t i = 0; i < n; i++) {
        v += x[i];
        out[i] = fire(&v, p[0]);
    }
}

CODEC(lif) {
    WIDE v = 0;
    for (size_t i = 0; i < n; i++) {
        v -= v / 16;
        v += x[i];
        out[i] = fire(&v, p[0]);
    }
}

CODEC(sigma_delta) {
    WIDE range = (WIDE)p[1] - p[0], sum = 0;
    for (size_t i = 0; i < n; i++) {
        if (x[i] > p[0]) sum += x[i] > p[1] ? range : (WIDE)x[i] - p[0];
        out[i] = sum >= range;
        if (out[i]) sum -= range;
    }
}

CODEC(weighted_phase) {
    WIDE range = (WIDE)p[1] - p[0];
    for (size_t i = 0; i < n; i++) {
        uint8_t digits = 0;
        if (x[i] >= p[1]) digits = 255;
        else if (x[i] > p[0]) digits = ((WIDE)x[i] - p[0]) * 256 / range;
        out[i] = (int8_t)digits;
    }
}

CODEC(hsa) {
    for (size_t i = 0; i < n; i++) {
        size_t fits = 0;
        while (fits < TAPS && i + fits < n && x[i + fits] >= p[fits]) fits++;
        out[i] = fits == TAPS;
        if (fits == TAPS)
            for (size_t j = 0; j < TAPS; j++) x[i + j] -= p[j];
    }
}
