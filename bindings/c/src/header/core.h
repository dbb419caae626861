/* spikewire: sensor samples to spikes and back, for firmware in C99 and C++11.
 *
 * This file holds what all codecs share; each codec has a file of its own below spikewire/. Include that, or
 * spikewire/all.h. Both are written by `cargo xtask c-library`.
 *
 * A codec NAME, such as step_forward_f32, is three types and some functions:
 *
 *   sw_NAME           its parameters: one for any number of channels
 *   sw_NAME_encoder   what one channel's encoder keeps, with a pointer to the parameters
 *   sw_NAME_decoder   what one channel's decoder keeps, with a pointer to the parameters
 *   sw_NAME_code      what a sample becomes; an int8_t for a spike, -1, 0 or 1, or for a signed number of spikes
 *
 *   sw_NAME_init             prepares parameters; what is wrong with one is told by the status, and by `error` unless
 *                            that is NULL
 *   sw_NAME_encoder_start    starts, or resets, an encoder; the parameters must stay where they are
 *   sw_NAME_encode           encodes a sample; SW_WAITING while a rate code waits for later samples, which leaves `code`
 *   sw_NAME_encode_slice     encodes samples in order, with the results of sw_NAME_encode; where a rate code waits, the
 *                            spike is SW_WAITING_SPIKE
 *   sw_NAME_finish           at a recording's end, the next code that still waits, or SW_NOTHING
 *   sw_NAME_prime            starts an encoder from the samples before its first, oldest first
 *   sw_NAME_keyframe         the value that a decoder should hold now, or SW_NOTHING
 *   sw_NAME_rejected         how many samples were not finite
 *   sw_NAME_decoder_start    starts, or resets, a decoder
 *   sw_NAME_decode           decodes the code of a sample
 *   sw_NAME_decode_slice     decodes codes in order; a byte counts as a spike by its sign, and SW_WAITING_SPIKE as none
 *   sw_NAME_held             the value that a decoder holds until the next spike, or SW_NOTHING for rate codes
 *   sw_NAME_resync           sets a decoder to a known value: the first sample, or a keyframe; SW_NOT_FINITE if it is none
 *   sw_NAME_firings          a code as the neurons that fire, by rising index; SW_TOO_SMALL if there are more
 *   sw_NAME_assemble         the code that neurons make up, in any order
 *   sw_NAME_bank             encodes a sample of each of several channels, whose encoders lie side by side, and puts the
 *                            events into a queue, in the order of time; channel c has the addresses from
 *                            first_address + c * SW_NAME_NEURONS on
 *   sw_NAME_keyframes        puts a keyframe of each channel that has one into a queue, after the events of the samples
 *                            so far; where none has one, a heartbeat, which tells a receiver the time
 *
 * The caller keeps to this:
 *
 * - A pointer that is neither null nor misaligned points to storage of its type, which nothing else uses during the
 *   call; only a queue may be put into by one context, such as an interrupt, while another one takes.
 * - Storage is zeroed before it is first used, as statics are, and then changed by these functions alone.
 * - Codes other than int8_t come from encode, encode_slice, bank or assemble of the same codec.
 *
 * What can be known is answered with a status below 0 and changes nothing: null and misaligned pointers, overlapping
 * buffers, storage that is all 0 because it was not started, parameters of another codec.
 * Nothing allocates, blocks, or keeps a global.
 */
#ifndef SPIKEWIRE_H
#define SPIKEWIRE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__cplusplus)
#define SW_STATIC_ASSERT(name, condition) static_assert(condition, #name)
extern "C" {
#elif defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
#define SW_STATIC_ASSERT(name, condition) _Static_assert(condition, #name)
#else
#define SW_STATIC_ASSERT(name, condition) typedef char sw_assert_##name[(condition) ? 1 : -1]
#endif

/* The version of this header, as a text and as major * 10000 + minor * 100 + patch; and that of the library. */
#define SW_VERSION "@VERSION@"
#define SW_VERSION_NUMBER @VERSION_NUMBER@
const char *sw_version(void);

/* What a call returns: below 0 if it did not do what it was asked. */
typedef int32_t sw_status;

@STATUSES@
/* The spike of a rate code that waits for later samples. */
#define SW_WAITING_SPIKE INT8_MIN

/* A line that says what a status means. */
const char *sw_status_text(sw_status status);

/* What is wrong with a parameter. Numbers that the status has no use for are 0. */
typedef struct sw_error {
    sw_status status;
    uint32_t index;            /* which of a list, from 0 */
    const char *parameter;     /* its name, not ended by 0; NULL if the status names none */
    uint32_t parameter_length; /* bytes of the name */
    float value;               /* what it was */
    float min;                 /* the smallest value allowed; of a list, the value before */
    float max;                 /* the largest value allowed */
} sw_error;

/* Fixed point: the value times 256, and times 65536. */
typedef int16_t sw_q8_8;
typedef int32_t sw_q16_16;

/* Shapes of filters; the Gaussian's alpha is 2.5. */
#define SW_TRIANGULAR ((uint8_t)0)
#define SW_HANN ((uint8_t)1)
#define SW_GAUSSIAN ((uint8_t)2)

/* One neuron's spike within the code of one sample. */
typedef struct sw_neuron_spike {
    uint16_t neuron; /* within its channel, from 0 */
    uint16_t slot;   /* sub-timestep within the sample, from 0 */
    int8_t polarity; /* 1 or -1 */
} sw_neuron_spike;

/* When a sample was taken, and under which addresses its spikes go out. */
typedef struct sw_stamp {
    uint32_t tick;          /* microseconds, wrapping */
    uint32_t slot_ticks;    /* microseconds of a sub-timestep; 0: all events of a sample have its tick */
    uint16_t first_address; /* of the first channel's first neuron */
} sw_stamp;

#define SW_EVENT ((uint8_t)0)
#define SW_KEYFRAME ((uint8_t)1)
#define SW_BREAK ((uint8_t)2)
#define SW_HEARTBEAT ((uint8_t)3)

/* An event, a keyframe, a break (items were lost, or the encoders changed without events), or a heartbeat (a sample was
 * taken, and its events come before). */
typedef struct sw_item {
    uint32_t tick;       /* microseconds, wrapping */
    uint32_t bits;       /* of a keyframe's sample; of 16 bits in the low half */
    uint32_t lost;       /* items that were lost before this one */
    uint16_t address;    /* the neuron; of a keyframe the channel's first, of a heartbeat the bank's first */
    uint8_t kind;        /* SW_EVENT, SW_KEYFRAME, SW_BREAK or SW_HEARTBEAT */
    uint8_t sample_kind; /* of a keyframe: 0 float, 1 + bits of fraction for 16 bits, 18 + those for 32 bits */
    int8_t polarity;     /* of an event: 1 or -1 */
} sw_item;

/* A queue of items from one context, such as the interrupt that encodes, to another, such as main. Lock-free: neither
 * waits for the other. What finds no room is lost and counted. */
typedef struct sw_queue {
    uintptr_t storage[6];
} sw_queue;

/* Storage for a queue: `static uintptr_t storage[SW_QUEUE_WORDS(256)];`. Room for one item less than the power of two,
 * 8 to 4096, that it is given. */
#define SW_QUEUE_WORDS(items) ((32u + (16u * (items))) / sizeof(uintptr_t))

/* Makes an empty queue, as long as `bytes` of storage allow. */
sw_status sw_queue_init(sw_queue *queue, uintptr_t *storage, size_t bytes);
/* Appends an item, in the context that encodes. */
sw_status sw_queue_put(sw_queue *queue, const sw_item *item);
/* Takes the oldest item, or SW_NOTHING. */
sw_status sw_queue_take(sw_queue *queue, sw_item *item);
/* How many items are in it, and how many were lost since it was made; in the context that takes. */
sw_status sw_queue_counts(sw_queue *queue, uint32_t *length, uint32_t *lost);

/* The longest frame of a link, in bytes. */
#define SW_MAX_FRAME @MAX_FRAME@u

/* Turns the items of a queue into frames for a UART, USB or radio. */
#define SW_WRITER_SIZE @WRITER_SIZE@u
typedef struct sw_writer {
    uint@WRITER_BITS@_t storage[SW_WRITER_SIZE / @WRITER_ALIGN@u];
} sw_writer;

/* For so many channels, a sample every `period` microseconds, and a session that no other start has: the starts so far,
 * counted in flash, or 64 random bits. A constant would let a receiver go on from the values of an earlier start. */
sw_status sw_writer_init(sw_writer *writer, uint16_t channels, uint32_t period, uint64_t session);
/* Sends the fingerprint of what both ends know of the flight, before the first frame: a receiver with another one calls no
 * value exact. */
sw_status sw_writer_describe(sw_writer *writer, uint32_t fingerprint);
/* Sends so many bits, 0 to 4, of a channel's step number with its first event of a frame, so that a step code's values heal
 * after lost frames without waiting for a keyframe. Before the first frame. */
sw_status sw_writer_heal(sw_writer *writer, uint8_t bits);
/* Lets events wait for others in the queue, up to so many microseconds by `sw_writer_observe`, so that fewer frames go. */
sw_status sw_writer_gather(sw_writer *writer, uint32_t micros);
/* Tells the time in microseconds, wrapping. Needed at least every 17.9 minutes in which no item is written. */
sw_status sw_writer_observe(sw_writer *writer, uint32_t now);
/* Writes a frame of what the queue holds, or SW_NOTHING. SW_MAX_FRAME bytes are room enough. */
sw_status sw_writer_next_frame(sw_writer *writer, sw_queue *queue, uint8_t *bytes, size_t capacity, size_t *length);

/* Finds frames in bytes that are cut anywhere, damaged, or begin in the middle. */
#define SW_READER_SIZE @READER_SIZE@u
typedef struct sw_reader {
    uint64_t storage[SW_READER_SIZE / 8u];
} sw_reader;

/* What a reader has seen. */
typedef struct sw_reader_counts {
    uint32_t frames;
    uint32_t lost_frames;
    uint32_t bad_checksums;
    uint32_t repeated;
    uint32_t late;
    uint32_t skipped; /* bytes that belong to no frame */
} sw_reader_counts;

/* Is handed each item. */
typedef void (*sw_take_item)(void *context, const sw_item *item);

sw_status sw_reader_init(sw_reader *reader);
/* Hands each item of each frame that the bytes complete to `take`, in order; a break where frames are missing. Returns
 * SW_OTHER_VERSION, above 0, while the bytes since the last frame look like those of another version of the link. */
sw_status sw_reader_take(sw_reader *reader, const uint8_t *bytes, size_t length, sw_take_item take, void *context);
sw_status sw_reader_counts_of(const sw_reader *reader, sw_reader_counts *counts);

/* What a calibration has seen. */
typedef struct sw_calibration_counts {
    uint32_t seen;     /* finite samples that its results are taken from */
    uint32_t ignored;  /* samples after those that it can count */
    uint32_t rejected; /* samples that were not finite */
} sw_calibration_counts;

/* Minimum, maximum and differences of a signal, before arming: sums are in double precision.
 *
 *   observe     takes samples in order
 *   range       the smallest and the largest, or SW_TOO_FEW_SAMPLES
 *   threshold   the mean of the differences between samples (of_magnitudes 0) or of their magnitudes (1), and `factor`
 *               of their standard deviations
 */
@CALIBRATIONS@/* Declares the functions of a codec, which are told at the top. SAMPLE is the type of a sample. */
#define SW_CODEC(NAME, SAMPLE) \
    sw_status sw_##NAME##_encoder_start(sw_##NAME##_encoder *encoder, const sw_##NAME *codec); \
    sw_status sw_##NAME##_encode(sw_##NAME##_encoder *encoder, SAMPLE sample, sw_##NAME##_code *code); \
    sw_status sw_##NAME##_encode_slice(sw_##NAME##_encoder *encoder, const SAMPLE *samples, \
        sw_##NAME##_code *codes, size_t count); \
    sw_status sw_##NAME##_finish(sw_##NAME##_encoder *encoder, sw_##NAME##_code *code); \
    sw_status sw_##NAME##_prime(sw_##NAME##_encoder *encoder, const SAMPLE *past, size_t count); \
    sw_status sw_##NAME##_keyframe(const sw_##NAME##_encoder *encoder, SAMPLE *value); \
    sw_status sw_##NAME##_rejected(const sw_##NAME##_encoder *encoder, uint32_t *count); \
    sw_status sw_##NAME##_decoder_start(sw_##NAME##_decoder *decoder, const sw_##NAME *codec); \
    sw_status sw_##NAME##_decode(sw_##NAME##_decoder *decoder, const sw_##NAME##_code *code, SAMPLE *value); \
    sw_status sw_##NAME##_decode_slice(sw_##NAME##_decoder *decoder, const sw_##NAME##_code *codes, SAMPLE *values, \
        size_t count); \
    sw_status sw_##NAME##_held(const sw_##NAME##_decoder *decoder, SAMPLE *value); \
    sw_status sw_##NAME##_resync(sw_##NAME##_decoder *decoder, SAMPLE value); \
    sw_status sw_##NAME##_firings(const sw_##NAME##_code *code, sw_neuron_spike *firings, size_t capacity, \
        size_t *count); \
    sw_status sw_##NAME##_assemble(const sw_neuron_spike *firings, size_t count, sw_##NAME##_code *code); \
    sw_status sw_##NAME##_bank(sw_##NAME##_encoder *encoders, const SAMPLE *samples, sw_##NAME##_code *codes, \
        size_t channels, const sw_stamp *stamp, sw_queue *queue); \
    sw_status sw_##NAME##_keyframes(sw_##NAME##_encoder *encoders, size_t channels, const sw_stamp *stamp, \
        sw_queue *queue)


#if defined(__cplusplus)
}
#endif

#endif
