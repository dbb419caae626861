/* Both ends of flights, as `emit c --flight` makes them: each hears its own sender, and none hears an exact value of another.
 *
 * A line for each, which laptop/flight/tests/both_ends.rs has too: `sf 405 frames, 10155 bytes, 954 exact values, …`. The
 * hash is over all bytes and all exact values.
 */
#include "print.h"

#if defined(PAIRS)
#include "pairs/flights.h"
#else
#include "flown/flights.h"
#endif

#define CHANNELS 6u
#define SAMPLES 400u

#if defined(PAIRS)
#define MOST_BYTES 0x20000u
#else
#define MOST_BYTES 0x6000u /* what a board has room for */
#endif

typedef struct flight {
    const char *name;
    uint32_t fingerprint, kinds, period, keyframe_every;
    const double *counts;
    void (*start)(sw_writer *writer);
    void (*encode)(uint32_t now, const double *values, sw_queue *queue);
    void (*keyframes)(uint32_t now, sw_queue *queue);
    void (*forget)(void);
    void (*take)(const uint8_t *bytes, size_t length);
    sw_status (*exact)(uint16_t channel, uint8_t *bytes, size_t *length);
} flight;

static void check(sw_status status, const char *what)
{
    if (status < SW_OK) {
        board_print(what);
        board_print(": ");
        board_print(sw_status_text(status));
        board_print("\n");
        board_finish(0);
    }
}

static void copy(uint8_t *to, const void *from, size_t length)
{
    for (size_t i = 0; i < length; ++i) {
        to[i] = ((const uint8_t *)from)[i];
    }
}

/* The ends of one flight, whose number for 1 is ONE, behind functions without its types. */
#define ENDS(NAME, UPPER, ONE, FINGERPRINT, KINDS)                                                                    \
    static sw_##NAME##_bank NAME##_near;                                                                              \
    static sw_##NAME##_receiver NAME##_far;                                                                           \
    static const double NAME##_counts[CHANNELS] = SW_##UPPER##_COUNTS;                                                \
    static void NAME##_start(sw_writer *writer)                                                                       \
    {                                                                                                                 \
        check(sw_##NAME##_bank_start(&NAME##_near), #NAME " bank_start");                                             \
        check(sw_##NAME##_writer_init(writer, 7u), #NAME " writer_init");                                             \
    }                                                                                                                 \
    static void NAME##_encode(uint32_t now, const double *values, sw_queue *queue)                                    \
    {                                                                                                                 \
        sw_##NAME##_sample samples[CHANNELS];                                                                         \
        for (uint32_t i = 0; i < CHANNELS; ++i) {                                                                     \
            samples[i] = (sw_##NAME##_sample)(values[i] * (ONE));                                                     \
        }                                                                                                             \
        check(sw_##NAME##_bank_encode(&NAME##_near, now, samples, queue), #NAME " bank_encode");                      \
    }                                                                                                                 \
    static void NAME##_keyframes(uint32_t now, sw_queue *queue)                                                       \
    {                                                                                                                 \
        check(sw_##NAME##_bank_keyframes(&NAME##_near, now, queue), #NAME " bank_keyframes");                         \
    }                                                                                                                 \
    static void NAME##_forget(void) { check(sw_##NAME##_receiver_init(&NAME##_far), #NAME " receiver_init"); }        \
    static void NAME##_take(const uint8_t *bytes, size_t length)                                                      \
    {                                                                                                                 \
        check(sw_##NAME##_receiver_take(&NAME##_far, bytes, length, NULL, NULL), #NAME " receiver_take");             \
    }                                                                                                                 \
    static sw_status NAME##_exact(uint16_t channel, uint8_t *bytes, size_t *length)                                   \
    {                                                                                                                 \
        sw_##NAME##_sample value = 0;                                                                                 \
        sw_status status = sw_##NAME##_receiver_exact(&NAME##_far, channel, &value);                                  \
        check(status, #NAME " receiver_exact");                                                                       \
        *length = sizeof value;                                                                                       \
        copy(bytes, &value, sizeof value);                                                                            \
        return status;                                                                                                \
    }

#define ROW(NAME, UPPER, ONE, FINGERPRINT, KINDS)                                                                     \
    {#NAME, FINGERPRINT, KINDS, SW_##UPPER##_PERIOD, SW_##UPPER##_KEYFRAME_EVERY, NAME##_counts, NAME##_start,        \
        NAME##_encode, NAME##_keyframes, NAME##_forget, NAME##_take, NAME##_exact},

FLIGHTS(ENDS)

static const flight flights[] = {FLIGHTS(ROW)};
#define COUNT (sizeof flights / sizeof flights[0])

/* What a sender sent, and where its tenth and its 60th sample begin. */
typedef struct sent {
    uint8_t bytes[MOST_BYTES];
    size_t length, late, early;
    uint32_t frames;
} sent;

#if defined(PAIRS)
static sent all[COUNT];
#else
static sent all[1];
#endif

/* A saw with a step, whose numbers are the same on any machine, and whole in counts. */
static double saw(uint32_t place, uint32_t channel, double counts)
{
    uint32_t up = (place * (3u + (2u * channel))) % 193u;
    double value = ((double)(up < 97u ? up : 193u - up) - 48.0) / 32.0 * counts;
    return counts > 1.0 ? (double)(int32_t)value : value;
}

static void send(const flight *own, sent *to)
{
    static uintptr_t storage[SW_QUEUE_WORDS(1024)];
    static sw_writer writer;
    static sw_queue queue;
    uint8_t frame[SW_MAX_FRAME];
    size_t length;
    check(sw_queue_init(&queue, storage, sizeof storage), "queue_init");
    own->start(&writer);
    to->length = 0;
    to->frames = 0;
    for (uint32_t place = 0; place < SAMPLES; ++place) {
        double values[CHANNELS];
        uint32_t now = place * own->period, kept = 0, lost = 0;
        to->late = place == 10u ? to->length : to->late;
        to->early = place == 60u ? to->length : to->early;
        for (uint32_t i = 0; i < CHANNELS; ++i) {
            values[i] = saw(place, i, own->counts[i]);
        }
        own->encode(now, values, &queue);
        if (place % own->keyframe_every == 0u) {
            own->keyframes(now, &queue);
        }
        check(sw_writer_observe(&writer, now), "writer_observe");
        while (sw_writer_next_frame(&writer, &queue, frame, sizeof frame, &length) == SW_OK) {
            if (length > MOST_BYTES - to->length) {
                board_print("no room\n");
                board_finish(0);
            }
            copy(&to->bytes[to->length], frame, length);
            to->length += length;
            ++to->frames;
        }
        check(sw_queue_counts(&queue, &kept, &lost), "queue_counts");
        if (lost > 0u) {
            board_print("a queue overflows\n");
            board_finish(0);
        }
    }
}

static uint64_t fnv(uint64_t hash, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; ++i) {
        hash = (hash ^ bytes[i]) * 0x00000100000001b3u;
    }
    return hash;
}

/* Hears a part of what was sent, and returns how many values were exact; `why` is the last status of the first channel. */
static uint32_t hear(const flight *own, const uint8_t *bytes, size_t length, uint64_t *hash, sw_status *why)
{
    uint32_t exact = 0;
    own->forget();
    while (length > 0u) {
        size_t part = length < 64u ? length : 64u;
        own->take(bytes, part);
        bytes += part;
        length -= part;
        for (uint16_t channel = 0; channel < CHANNELS; ++channel) {
            uint8_t value[8], number[2] = {(uint8_t)channel, 0u};
            size_t size = 0;
            sw_status status = own->exact(channel, value, &size);
            *why = channel == 0u ? status : *why;
            if (status == SW_OK) {
                ++exact;
                *hash = fnv(fnv(*hash, number, sizeof number), value, size);
            }
        }
    }
    return exact;
}

static void print_count(uint64_t count, const char *what)
{
    print_number(count, 10u, 1u);
    board_print(what);
}

/* Each flight by itself. */
static void own_ends(void)
{
    for (size_t i = 0; i < COUNT; ++i) {
        sent *to = &all[i % (sizeof all / sizeof all[0])];
        sw_status why;
        uint64_t hash;
        uint32_t exact;
        send(&flights[i], to);
        hash = fnv(0xcbf29ce484222325u, to->bytes, to->length);
        exact = hear(&flights[i], to->bytes, to->length, &hash, &why);
        board_print(flights[i].name);
        board_print(" ");
        print_count(to->frames, " frames, ");
        print_count(to->length, " bytes, ");
        print_count(exact, " exact values, ");
        print_number(hash, 16u, 16u);
        board_print("\n");
    }
}

#if defined(PAIRS)
/* Each flight with those that differ from it in one thing, from the first frame on and from a later one. */
static void pairs(void)
{
    uint32_t heard[32] = {0}, reasons[32] = {0}, same = 0;
    for (size_t i = 0; i < COUNT; ++i) {
        for (size_t j = 0; j < COUNT; ++j) {
            uint32_t common = flights[i].kinds & flights[j].kinds;
            if (i == j || common == 0u) {
                continue;
            }
            if (flights[i].fingerprint == flights[j].fingerprint) {
                ++same; /* fields of one width code as the cells between their centres */
                continue;
            }
            for (uint32_t is_late = 0; is_late < 2u; ++is_late) {
                size_t from = is_late == 1u ? all[i].late : 0u;
                uint64_t hash = 0;
                sw_status why = SW_OK;
                uint32_t exact = hear(&flights[j], &all[i].bytes[from], all[i].early - from, &hash, &why);
                if (exact > 0u) {
                    board_print(flights[j].name);
                    board_print(" has exact values of ");
                    board_print(flights[i].name);
                    board_print("\n");
                    board_finish(0);
                }
                /* Who joins late waits for a full frame, which has the fingerprint: until then the reasons are others. */
                reasons[why] += 1u - is_late;
            }
            for (uint32_t kind = 0; kind < 32u; ++kind) {
                heard[kind] += (common >> kind) & 1u;
            }
        }
    }
    for (uint32_t kind = 0; kind < 32u; ++kind) {
        if (heard[kind] > 0u) {
            board_print("kind ");
            print_count(kind, ": ");
            print_count(heard[kind], " pairs\n");
        }
    }
    for (uint32_t why = 0; why < 32u; ++why) {
        if (reasons[why] > 0u) {
            board_print("reason ");
            print_count(why, ": ");
            print_count(reasons[why], ", ");
            board_print(sw_status_text((sw_status)why));
            board_print("\n");
        }
    }
    print_count(same, " the same\n");
}
#endif

int main(void)
{
    own_ends();
#if defined(PAIRS)
    pairs();
#endif
    board_finish(1);
    return 0;
}
