/* What cluster heads and their fusion centre tell each other of a target's state (x, vx, y, vy), as bytes. Metres and m/s, relative to an origin that all of
 * them share by configuration.
 *
 * The first byte is the kind. Then come, numbers as in bytes.h and matrices packed as in matrix.h:
 *
 * | kind | bytes | what |
 * |---|---:|---|
 * | MH_SUMMARY_PLAIN | 57 | mean, covariance |
 * | MH_SUMMARY_SPLIT | 97 | mean, dependent covariance, independent covariance |
 * | MH_SUMMARY_INCREMENT | 61 | information vector, information matrix, the time (4 bytes) since when |
 * | MH_SUMMARY_FUSED | 59 | mean, covariance, whose increments are in them (2 bytes): from the centre to the heads |
 *
 * The time that it is of travels beside it, in the message. */
#ifndef MOTEHOUND_SUMMARY_H
#define MOTEHOUND_SUMMARY_H

#if MH_REAL_FIXED
#error "motehound/summary.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/fusion.h"
#include "motehound/ticks.h"

#include <stdbool.h>
#include <stddef.h>

/* A state farther from the origin, faster, or less sure in these units than this is absurd, and refused wherever it comes from: soon it would be beyond mh_real. */
#define MH_SUMMARY_FARTHEST_M 1e7f
#define MH_SUMMARY_FASTEST_MPS 1e5f

enum mh_summary_kind { MH_SUMMARY_PLAIN = 1, MH_SUMMARY_SPLIT, MH_SUMMARY_INCREMENT, MH_SUMMARY_FUSED };

enum { MH_SUMMARY_STATES = 4 };

struct mh_summary {
    enum mh_summary_kind kind;
    union {
        struct mh_gaussian plain; /* PLAIN, FUSED */
        struct mh_split_gaussian split;
        struct mh_information increment;
    } of;
    mh_tick
        since; /* INCREMENT: what the sender's reference knew, the centre knows: nothing that was measured until then is in it */
    uint16_t clusters; /* FUSED: bit c is set where the increment of cluster c, of the same time, is in it */
};

/* Whether a state, finite and positive definite, is not absurd. */
bool mh_summary_sane(const struct mh_gaussian *state);

/* -> bytes[0 .. MH_SUMMARY_BYTES_MAX). Returns the length. The summary must be one that mh_summary_read takes. */
size_t mh_summary_write(const struct mh_summary *summary, uint8_t *bytes);

/* And back; `summary` is untouched after an error. Errors: MH_ERR_CORRUPT (kind, length, a number that is not finite, a covariance that is not positive definite, a state that is absurd. Of an increment only that its
 * numbers are finite can be known here). */
enum mh_status mh_summary_read(struct mh_summary *summary, const uint8_t *bytes, size_t length);

/* The kind of summary that heads send to a centre of this rule. */
enum mh_summary_kind mh_summary_kind_of(enum mh_fusion_rule rule);

/* True if bytes are of kind MH_SUMMARY_FUSED and say that the increment of this cluster is in it: for the head as good as the acknowledgement of its summary. */
bool mh_summary_holds(const uint8_t *bytes, size_t length, uint8_t cluster);

#endif
