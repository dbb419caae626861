/* Both ends of a flight, written from its file. spikewire.h says what a caller keeps to. */
#ifndef SPIKEWIRE_@UPPER@_H
#define SPIKEWIRE_@UPPER@_H

#include "spikewire.h"

#if defined(__cplusplus)
extern "C" {
#endif

#define SW_@UPPER@_CHANNELS @CHANNELS@u
#define SW_@UPPER@_PERIOD @PERIOD@u /* microseconds from sample to sample */
#define SW_@UPPER@_KEYFRAME_EVERY @KEYFRAME_EVERY@u /* samples */
/* Initialisers, in the order of a sample: names of the channels, and counts for one unit of each. */
#define SW_@UPPER@_NAMES {@NAMES@}
#define SW_@UPPER@_COUNTS {@COUNTS@}

/* A sample of one channel, in counts. */
typedef @SAMPLE@ sw_@NAME@_sample;

/* The sender: encoders with their filters. Storage is as large as a machine of 64 bits needs. */
typedef struct sw_@NAME@_bank {
    uint64_t storage[@BANK@];
} sw_@NAME@_bank;

/* Starts, or resets, the encoders. */
sw_status sw_@NAME@_bank_start(sw_@NAME@_bank *bank);
/* Encodes a sample of each channel, taken at this time in microseconds, in the context that encodes. */
sw_status sw_@NAME@_bank_encode(
    sw_@NAME@_bank *bank, uint32_t now, const sw_@NAME@_sample samples[@CHANNELS@], sw_queue *queue);
/* Puts keyframes, or a heartbeat, after the sample of this time: every SW_@UPPER@_KEYFRAME_EVERY samples. */
sw_status sw_@NAME@_bank_keyframes(const sw_@NAME@_bank *bank, uint32_t now, sw_queue *queue);
/* How many samples were not finite, over all channels. */
sw_status sw_@NAME@_bank_rejected(const sw_@NAME@_bank *bank, uint32_t *count);

/* Prepares the writer of the flight's frames, which carry its fingerprint; `session` is one that no other start has. */
sw_status sw_@NAME@_writer_init(sw_writer *writer, uint64_t session);

/* The receiver: it finds frames in bytes, decodes them, and knows which values are exact. */
typedef struct sw_@NAME@_receiver {
    uint64_t storage[@RECEIVER@];
} sw_@NAME@_receiver;

/* Is handed the channel, the time and the value of each keyframe, event or sample. */
typedef void (*sw_@NAME@_take_value)(void *context, uint16_t channel, uint32_t tick, sw_@NAME@_sample value);

sw_status sw_@NAME@_receiver_init(sw_@NAME@_receiver *receiver);
/* Decodes the frames that these bytes complete; `take` may be NULL. */
sw_status sw_@NAME@_receiver_take(sw_@NAME@_receiver *receiver, const uint8_t *bytes, size_t length,
    sw_@NAME@_take_value take, void *context);
/* Says that all events before this time have arrived: the samples that are over by then are decoded. */
sw_status sw_@NAME@_receiver_advance(
    sw_@NAME@_receiver *receiver, uint32_t now, sw_@NAME@_take_value take, void *context);
/* Reads a channel's value if it has the bits of the sender's; otherwise a status above 0 says what is missing, and
 * SW_OTHER_FLIGHT that the sender was made from another file. */
sw_status sw_@NAME@_receiver_exact(const sw_@NAME@_receiver *receiver, uint16_t channel, sw_@NAME@_sample *value);
/* Reads a channel's value, exact or not. */
sw_status sw_@NAME@_receiver_estimate(const sw_@NAME@_receiver *receiver, uint16_t channel, sw_@NAME@_sample *value);
/* What the receiver's reader has seen. */
sw_status sw_@NAME@_receiver_counts_of(const sw_@NAME@_receiver *receiver, sw_reader_counts *counts);

#if defined(__cplusplus)
}
#endif

#endif
