/* What the library answers to bad calls; then samples through bank, queue, writer and reader. Also compiled as C++. */
#include "board.h"
#include "spikewire/all.h"

static int is_good = 1;

static void is(const char *what, sw_status status, sw_status expected)
{
    if (status != expected) {
        board_print(what);
        board_print(": ");
        board_print(sw_status_text(status));
        board_print(", and not: ");
        board_print(sw_status_text(expected));
        board_print("\n");
        is_good = 0;
    }
}

static void holds(const char *what, int condition)
{
    if (condition == 0) {
        board_print(what);
        board_print(" does not hold\n");
        is_good = 0;
    }
}

/* A value that is not a number, without a library. */
static float nan_value(void)
{
    volatile float zero = 0.0f;
    return zero / zero;
}

static void pointers(void)
{
    static sw_step_forward_f32 codec;
    static sw_step_forward_i16 other;
    static sw_step_forward_f32_encoder encoder, unstarted;
    static sw_step_forward_f32_decoder decoder;
    static union {
        float samples[8];
        int8_t codes[32];
    } both;
    static const int8_t signs[3] = {7, 0, -100};
    static const float three[3] = {0.0f, 1.0f, 2.0f};
    float value = 0.0f, values[3];
    int8_t code = 0, codes[3];
    sw_error error;
    void *odd = (void *)(both.codes + 1);

    is("codec NULL", sw_step_forward_f32_init(NULL, 0.5f, NULL), SW_NULL);
    is("codec odd", sw_step_forward_f32_init((sw_step_forward_f32 *)odd, 0.5f, NULL), SW_MISALIGNED);
    is("not made", sw_step_forward_f32_encoder_start(&encoder, &codec), SW_NOT_MADE);
    is("threshold 0", sw_step_forward_f32_init(&codec, 0.0f, &error), SW_NOT_POSITIVE);
    holds("the error names the threshold", (error.parameter_length == 9u) && (error.parameter[0] == 't'));
    is("not made by a bad threshold", sw_step_forward_f32_encoder_start(&encoder, &codec), SW_NOT_MADE);
    is("other", sw_step_forward_i16_init(&other, 3, NULL), SW_OK);
    is("of another type", sw_step_forward_f32_encoder_start(&encoder, (const sw_step_forward_f32 *)(const void *)&other), SW_NOT_MADE);
    is("init", sw_step_forward_f32_init(&codec, 0.5f, &error), SW_OK);
    is("encoder NULL", sw_step_forward_f32_encoder_start(NULL, &codec), SW_NULL);
    is("start", sw_step_forward_f32_encoder_start(&encoder, &codec), SW_OK);
    is("decoder", sw_step_forward_f32_decoder_start(&decoder, &codec), SW_OK);
    is("unstarted", sw_step_forward_f32_encode(&unstarted, 1.0f, &code), SW_NOT_STARTED);
    is("code NULL", sw_step_forward_f32_encode(&encoder, 1.0f, NULL), SW_NULL);
    is("no keyframe yet", sw_step_forward_f32_keyframe(&encoder, &value), SW_NOTHING);
    is("samples NULL", sw_step_forward_f32_encode_slice(&encoder, NULL, codes, 3u), SW_NULL);
    is("no samples", sw_step_forward_f32_encode_slice(&encoder, NULL, NULL, 0u), SW_OK);
    is("overlap", sw_step_forward_f32_encode_slice(&encoder, both.samples, both.codes + 2, 8u), SW_OVERLAPPING);
    is("samples odd", sw_step_forward_f32_encode_slice(&encoder, (const float *)odd, codes, 3u), SW_MISALIGNED);
    is("beyond", sw_step_forward_f32_encode_slice(&encoder, three, codes, SIZE_MAX), SW_BAD_LENGTH);
    is("slice", sw_step_forward_f32_encode_slice(&encoder, three, codes, 3u), SW_OK);
    holds("spikes", (codes[0] == 0) && (codes[1] == 1) && (codes[2] == 1));
    is("signs", sw_step_forward_f32_decode_slice(&decoder, signs, values, 3u), SW_OK);
    holds("a byte counts by its sign", (values[1] > 0.49f) && (values[1] < 0.51f) && (values[2] < 0.01f));
    is("sign", sw_step_forward_f32_decode(&decoder, &signs[1], &value), SW_OK);
    holds("no step", value < 0.01f);
    is("resync to no number", sw_step_forward_f32_resync(&decoder, nan_value()), SW_NOT_FINITE);
    is("decode", sw_step_forward_f32_decode_slice(&decoder, codes, values, 3u), SW_OK);
    holds("values", (values[1] > 0.49f) && (values[2] > 0.99f) && (values[2] < 1.01f));
    is("keyframe", sw_step_forward_f32_keyframe(&encoder, &value), SW_OK);
}

static void choices(void)
{
    static sw_hough_15_f32 codec;
    static sw_hough_15_f32_encoder encoder;
    static sw_hough_15_f32_decoder decoder;
    static sw_slots_15_10_f32 slots;
    static sw_slots_15_10_f32_encoder neurons;
    static sw_slots_15_10_f32_code code;
    static sw_neuron_spike firings[15];
    float taps[15] = {0.0f};
    int8_t spikes[20];
    float values[20];
    static const float rest[20] = {0.0f};
    size_t count = 0;
    sw_error error;

    taps[3] = nan_value();
    is("taps NaN", sw_hough_15_f32_init(&codec, taps, 0.0f, &error), SW_NOT_FINITE);
    holds("the error names the tap", (error.index == 3u) && (error.value != error.value));
    taps[3] = 0.0f;
    is("shape", sw_hough_15_f32_init_peak(&codec, 9u, 1.0f, 0.0f, NULL), SW_BAD_CHOICE);
    is("taps NULL", sw_hough_15_f32_init(&codec, NULL, 0.0f, NULL), SW_NULL);
    is("taps 0", sw_hough_15_f32_init(&codec, taps, 0.0f, &error), SW_ALL_ZERO);
    taps[7] = 1.0f;
    is("taps", sw_hough_15_f32_init(&codec, taps, 0.0f, &error), SW_OK);
    is("start", sw_hough_15_f32_encoder_start(&encoder, &codec), SW_OK);
    is("waits", sw_hough_15_f32_encode(&encoder, 0.0f, &spikes[0]), SW_WAITING);
    is("slice", sw_hough_15_f32_encode_slice(&encoder, rest, spikes, 20u), SW_OK);
    holds("13 more wait", (spikes[12] == SW_WAITING_SPIKE) && (spikes[13] == 0));
    is("decoder", sw_hough_15_f32_decoder_start(&decoder, &codec), SW_OK);
    is("decode", sw_hough_15_f32_decode_slice(&decoder, spikes, values, 20u), SW_OK);
    holds("none while it waits", (values[0] < 0.01f) && (values[12] < 0.01f));
    is("finish", sw_hough_15_f32_finish(&encoder, &spikes[0]), SW_OK);

    is("range", sw_slots_15_10_f32_init(&slots, 1.0f, 1.0f, 1.5f, 1u, &error), SW_NOT_RISING);
    is("slots", sw_slots_15_10_f32_init(&slots, -1.0f, 1.0f, 1.5f, 1u, &error), SW_OK);
    is("floor", sw_slots_15_10_f32_init(&slots, -1.0f, 1.0f, 1.5f, 0u, &error), SW_OUT_OF_RANGE);
    is("start", sw_slots_15_10_f32_encoder_start(&neurons, &slots), SW_OK);
    is("encode", sw_slots_15_10_f32_encode(&neurons, 0.1f, &code), SW_OK);
    is("room for one", sw_slots_15_10_f32_firings(&code, firings, 1u, &count), SW_TOO_SMALL);
    is("firings", sw_slots_15_10_f32_firings(&code, firings, 15u, &count), SW_OK);
    holds("several fire", (count > 1u) && (firings[0].neuron < firings[1].neuron));
}

typedef struct seen {
    uint32_t events;
    uint32_t keyframes;
    uint32_t breaks;
    uint32_t last_tick;
} seen;

static void take(void *context, const sw_item *item)
{
    seen *own = (seen *)context;
    own->events += (item->kind == SW_EVENT) ? 1u : 0u;
    own->keyframes += (item->kind == SW_KEYFRAME) ? 1u : 0u;
    own->breaks += (item->kind == SW_BREAK) ? 1u : 0u;
    own->last_tick = item->tick;
}

/* Three channels, a queue, frames, and the other end. */
static void linked(void)
{
    static sw_step_forward_i16 codec;
    static sw_step_forward_i16_encoder encoders[3];
    static int8_t codes[3];
    static uintptr_t storage[SW_QUEUE_WORDS(64)];
    static sw_queue queue, unmade;
    static sw_writer writer;
    static sw_reader reader;
    static uint8_t frame[SW_MAX_FRAME];
    /* The empty first frame of a session by version 3 of the link. */
    static const uint8_t version_3[22] = {0xA5u, 0x34u, 0x15u, 0x7Cu, 0x4Au, 0x7Fu, 0xB9u, 0x79u, 0xE8u, 0x03u, 0u,
                                          0u,    0u,    0u,    0xE8u, 0x03u, 0u,    0u,    0x85u, 0xC1u, 0xF6u, 0x8Bu};
    sw_reader_counts counts;
    sw_stamp stamp = {1000u, 0u, 0u};
    uint32_t waiting = 0, lost = 0, sent = 0;
    seen received = {0u, 0u, 0u, 0u};
    sw_item item;
    size_t length = 0;

    is("a queue in itself", sw_queue_init(&queue, (uintptr_t *)(void *)&queue, sizeof queue), SW_OVERLAPPING);
    is("a queue in its storage", sw_queue_init((sw_queue *)(void *)&storage[8], storage, sizeof storage), SW_OVERLAPPING);
    is("small queue", sw_queue_init(&queue, storage, 16u), SW_TOO_SMALL);
    is("queue", sw_queue_init(&queue, storage, sizeof storage), SW_OK);
    is("nothing", sw_queue_take(&queue, &item), SW_NOTHING);
    is("unmade", sw_queue_take(&unmade, &item), SW_NOT_STARTED);
    is("writer", sw_writer_init(&writer, 3u, 1000u, 7u), SW_OK);
    is("reader", sw_reader_init(&reader), SW_OK);
    is("codec", sw_step_forward_i16_init(&codec, 10, NULL), SW_OK);
    for (size_t i = 0; i < 3u; ++i) {
        is("start", sw_step_forward_i16_encoder_start(&encoders[i], &codec), SW_OK);
    }
    for (int16_t step = 0; step < 20; ++step) {
        int16_t samples[3];
        samples[0] = (int16_t)(step * 11);
        samples[1] = 0;
        samples[2] = (int16_t)(step * -11);
        is("bank", sw_step_forward_i16_bank(encoders, samples, codes, 3u, &stamp, &queue), SW_OK);
        sent += (codes[0] != 0) ? 1u : 0u;
        sent += (codes[1] != 0) ? 1u : 0u;
        sent += (codes[2] != 0) ? 1u : 0u;
        stamp.tick += 1000u;
    }
    is("keyframes", sw_step_forward_i16_keyframes(encoders, 3u, &stamp, &queue), SW_OK);
    is("counts", sw_queue_counts(&queue, &waiting, &lost), SW_OK);
    holds("38 events and 3 keyframes wait", (sent == 38u) && (waiting == 41u) && (lost == 0u));
    is("short frame", sw_writer_next_frame(&writer, &queue, frame, 4u, &length), SW_TOO_SMALL);
    while (sw_writer_next_frame(&writer, &queue, frame, sizeof frame, &length) == SW_OK) {
        /* Cut in two. */
        is("read", sw_reader_take(&reader, frame, 5u, take, &received), SW_OK);
        is("read", sw_reader_take(&reader, frame + 5, length - 5u, take, &received), SW_OK);
    }
    holds("all arrive", (received.events == sent) && (received.keyframes == 3u) && (received.breaks == 1u));
    is("no callback", sw_reader_take(&reader, frame, 5u, NULL, NULL), SW_NULL);
    is("another version", sw_reader_take(&reader, version_3, sizeof version_3, take, &received), SW_OTHER_VERSION);
    is("counts", sw_reader_counts_of(&reader, &counts), SW_OK);
    holds("nothing is lost", (counts.frames >= 1u) && (counts.lost_frames == 0u) && (counts.bad_checksums == 0u));
}

/* Another archive from Rust has its own of these, of other types: they must not meet the library's. */
void _critical_section_1_0_acquire(void);
void _critical_section_1_0_release(void);
void _critical_section_1_0_acquire(void) { holds("another's critical section is left alone", 0); }
void _critical_section_1_0_release(void) {}

static int same(const char *one, const char *other)
{
    while ((*one != '\0') && (*one == *other)) {
        ++one;
        ++other;
    }
    return *one == *other;
}

int main(void)
{
    holds("header and library have one version", same(sw_version(), SW_VERSION) && (SW_VERSION_NUMBER >= 100));
    pointers();
    choices();
    linked();
    board_print(is_good ? "every call is answered as it should be\n" : "");
    board_finish(is_good);
    return 0;
}
