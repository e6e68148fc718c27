/* Every capacity of the library, each with its default, its meaning and what it costs.
 *
 * Override by defining the name on the compiler's command line (CMake: -DMOTEHOUND_DEFINITIONS="MH_REPORTS_MAX=128"). All code that
 * shares a structure with the library must be compiled with the same values. */
#ifndef MOTEHOUND_CONFIG_H
#define MOTEHOUND_CONFIG_H

/* Measurements of one sampling instant that a cluster head can hold. Costs 32 bytes each at the head, nothing at a
 * sensor node. When it is full the measurement with the smallest increment gives way, and is counted. */
#ifndef MH_REPORTS_MAX
#define MH_REPORTS_MAX 64
#endif

/* Past samples that a sensor node keeps, for differencing and for answering a late request. 10 bytes each. */
#ifndef MH_SENSOR_HISTORY
#define MH_SENSOR_HISTORY 4
#endif

/* The tracker `diffusion`. Window: sampling instants whose positions are estimated together. Near and strong: measurements used of an instant,
 * those nearest to the source and those with the most significant increments, 24 bytes each and instant of the window. Trail: older positions
 * that are kept, 16 bytes each. In all 2.9 kB of state, 1.7 kB with the small values of the AVR; time grows with rows and the cube of the window. */
#ifndef MH_DIFFUSION_WINDOW
#define MH_DIFFUSION_WINDOW 3
#endif
#ifdef __AVR__
#define MH_DIFFUSION_SMALL 1
#else
#define MH_DIFFUSION_SMALL 0
#endif
#ifndef MH_DIFFUSION_NEAR
#define MH_DIFFUSION_NEAR (MH_DIFFUSION_SMALL ? 5 : 8)
#endif
#ifndef MH_DIFFUSION_STRONG
#define MH_DIFFUSION_STRONG (MH_DIFFUSION_SMALL ? 5 : 8)
#endif
#ifndef MH_TRAIL_KNOTS_MAX
#define MH_TRAIL_KNOTS_MAX (MH_DIFFUSION_SMALL ? 14 : 60)
#endif

/* Its track ends after so many intervals without any measurement near it, or so many instants in succession with measurements but without a
 * significant increment. */
#ifndef MH_DIFFUSION_COAST
#define MH_DIFFUSION_COAST 30
#endif
#ifndef MH_DIFFUSION_SILENCE
#define MH_DIFFUSION_SILENCE 10
#endif

/* Particles of the trackers `pftl` and `msl`: 12 bytes each, of `msl` 20. The work grows in proportion; more than 50 bring `pftl` little. */
#ifndef MH_PARTICLES_MAX
#ifdef __AVR__
#define MH_PARTICLES_MAX 50
#else
#define MH_PARTICLES_MAX 200
#endif
#endif

/* A track that is handed from head to head, in bytes. The tracker `msl` hands over as many of its particles as find room, the tracker `gas` as many
 * sensors. */
#ifndef MH_TRACK_BYTES_MAX
#ifdef __AVR__
#define MH_TRACK_BYTES_MAX 128
#else
#define MH_TRACK_BYTES_MAX 256
#endif
#endif

/* Sensors that a head of the tracker `gas` works with, those of the saved track and its own neighbours: 20 bytes each, and 12 of stack. When it is full
 * the one that tells least gives way. And the cells of its grid, which cost time alone. */
#ifndef MH_GAS_SENSORS_MAX
#define MH_GAS_SENSORS_MAX (MH_TRACK_BYTES_MAX / 16 + 16)
#endif
#ifndef MH_GAS_CELLS
#define MH_GAS_CELLS 500
#endif

/* What a cluster head tells a fusion centre of its track, in bytes: at most the mean and two covariances of four states, and a byte. */
#define MH_SUMMARY_BYTES_MAX 97

/* States of a struct mh_gaussian, 4 (n + n (n + 1) / 2) bytes whatever part of it is used; and measured numbers that an update takes at
 * once (stacked), which cost a UKF 2 n^2 + 8 n MH_STATES_MAX + 14 n bytes of stack. */
#ifndef MH_STATES_MAX
#ifdef __AVR__
#define MH_STATES_MAX 4
#else
#define MH_STATES_MAX 6
#endif
#endif
#ifndef MH_STACKED_MAX
#ifdef __AVR__
#define MH_STACKED_MAX 4
#else
#define MH_STACKED_MAX 8
#endif
#endif

/* Places among which a leak is looked for where the wind is measured, 28 bytes each, and sensors whose background is followed, 12 bytes each. */
#ifndef MH_LEAK_PLACES_MAX
#ifdef __AVR__
#define MH_LEAK_PLACES_MAX 8
#else
#define MH_LEAK_PLACES_MAX 16
#endif
#endif
#ifndef MH_LEAK_SENSORS_MAX
#ifdef __AVR__
#define MH_LEAK_SENSORS_MAX 8
#else
#define MH_LEAK_SENSORS_MAX 16
#endif
#endif

/* Targets that a node follows at once, up to 300 bytes each in the protocol `prince`; targets of a group, which travel with its track; and sources whose sound is
 * told apart in one fit, whose work grows with the cube. */
#ifndef MH_TARGETS_MAX
#ifdef __AVR__
#define MH_TARGETS_MAX 1
#else
#define MH_TARGETS_MAX 4
#endif
#endif
#ifndef MH_GROUP_MAX
#define MH_GROUP_MAX 4
#endif
#ifndef MH_SOURCES_MAX
#define MH_SOURCES_MAX (MH_GROUP_MAX + 1)
#endif

/* Newly found sources are counted on so many cells a side of a square, 4 bytes of stack each, from so many nodes, 4 bytes each. With 8 cells and
 * 12 nodes 2 to 4 % of the counts of two and three sources 10 m from their centroid are wrong, with 16 and 32 below 1 %. */
#ifndef MH_COUNT_SIDE
#ifdef __AVR__
#define MH_COUNT_SIDE 8
#else
#define MH_COUNT_SIDE 16
#endif
#endif
#ifndef MH_COUNT_NODES_MAX
#ifdef __AVR__
#define MH_COUNT_NODES_MAX 12
#else
#define MH_COUNT_NODES_MAX 32
#endif
#endif

/* Estimates that are fused at once, and so clusters of a fusion centre: some 130 bytes each there, 85 bytes of stack where weights are searched. */
#ifndef MH_FUSED_MAX
#ifdef __AVR__
#define MH_FUSED_MAX 4
#else
#define MH_FUSED_MAX 8
#endif
#endif

/* Largest frame, in bytes, check sum included: the largest PSDU of IEEE 802.15.4. */
#define MH_FRAME_MAX 127

/* A message that has been relayed this often is dropped and counted: no path is longer, so it is going in a circle. */
#ifndef MH_HOPS_MAX
#define MH_HOPS_MAX 64
#endif

/* Reports that a node of the protocol `collection` keeps until it knows that its parent has them, to send them again; some 40 bytes each. What
 * comes on top is sent too, but once. And requests it remembers, 8 bytes each, so that it relays none twice: one a head is needed. */
#ifndef MH_COLLECTION_KEPT_MAX
#ifdef __AVR__
#define MH_COLLECTION_KEPT_MAX 1
#else
#define MH_COLLECTION_KEPT_MAX 8
#endif
#endif
#ifndef MH_COLLECTION_SEEN_MAX
#ifdef __AVR__
#define MH_COLLECTION_SEEN_MAX 2
#else
#define MH_COLLECTION_SEEN_MAX 3
#endif
#endif

/* Neighbours that a node of a geographic protocol keeps, 20 bytes each. Face routing delivers for sure where no node has more neighbours
 * than this in the Gabriel graph (4 on average, at most 9 of 100,000 random nodes); more of them make greedy hops longer in a dense field. */
#ifndef MH_NEIGHBOURS_MAX
#ifdef __AVR__
#define MH_NEIGHBOURS_MAX 16
#else
#define MH_NEIGHBOURS_MAX 32
#endif
#endif

/* Nodes within two hops that a node of the protocol `token` knows the places of, itself among them: 16 bytes each, 14 on an AVR. With fewer the next head
 * of a search is chosen as if those farthest off did not measure. */
#ifndef MH_VICINITY_MAX
#ifdef __AVR__
#define MH_VICINITY_MAX 24
#else
#define MH_VICINITY_MAX 96
#endif
#endif

/* Messages that wait at a node to be sent to a neighbour, some 140 bytes each, and messages it remembers having taken, so that it takes
 * none twice, 16 bytes each. */
#ifndef MH_LINK_QUEUE_MAX
#ifdef __AVR__
#define MH_LINK_QUEUE_MAX 4
#else
#define MH_LINK_QUEUE_MAX 16
#endif
#endif
#ifndef MH_LINK_SEEN_MAX
#ifdef __AVR__
#define MH_LINK_SEEN_MAX 8
#else
#define MH_LINK_SEEN_MAX 32
#endif
#endif

/* A message in an envelope that has been relayed this often is dropped and counted. A walk around a face takes up to twice as many hops as
 * the face has edges, and a sparse field of many nodes has long faces; a smaller number limits the harm where links are no unit discs. */
#ifndef MH_ROUTE_HOPS_MAX
#define MH_ROUTE_HOPS_MAX 4096
#endif

/* Members of a cluster, its head not counted: 20 bytes each, in what a node knows of its cluster. The rules scm* take all nodes that detect the
 * target, as far as there is room; the others make do with 7 or 15. */
#ifndef MH_CLUSTER_MAX
#ifdef __AVR__
#define MH_CLUSTER_MAX 8
#else
#define MH_CLUSTER_MAX 32
#endif
#endif

/* Clusters of the protocol `fixed`, 130 bytes each. */
#ifndef MH_FIXED_CLUSTERS_MAX
#ifdef __AVR__
#define MH_FIXED_CLUSTERS_MAX 4
#else
#define MH_FIXED_CLUSTERS_MAX 8
#endif
#endif

/* Synchronised time: pairs of local and network time that the line goes through, 8 bytes each, one a round; and neighbours whose messages are
 * stamped, 10 bytes each. */
#ifndef MH_CLOCK_PAIRS
#ifdef __AVR__
#define MH_CLOCK_PAIRS 16
#else
#define MH_CLOCK_PAIRS 24
#endif
#endif
#ifndef MH_CLOCK_NEIGHBOURS
#define MH_CLOCK_NEIGHBOURS 8
#endif

/* What the tracker `range` can learn of its ranges: their scale and the biases of as many anchors less one. The first anchors it hears have
 * it; further ones are taken for noisier. Each is a state of its Kalman filter: nine, for eight anchors, cost 340 bytes of state and as many of stack.
 * 0: nothing is learned. */
#ifndef MH_RANGE_BIASES_MAX
#define MH_RANGE_BIASES_MAX 0
#endif

/* Anchors whose last range the tracker `range` keeps while it looks for a target, to start from at least three that were read one after the
 * other. 32 bytes each. */
#ifndef MH_RANGE_HEARD_MAX
#ifdef __AVR__
#define MH_RANGE_HEARD_MAX 3
#else
#define MH_RANGE_HEARD_MAX 8
#endif
#endif

/* Largest number of states of a Kalman filter that move, and of all of them: those that only are learned come on top. A filter costs
 * 4 (n + n (n + 1) / 2) bytes for all n, whatever part of it is used. */
#ifndef MH_KALMAN_MOVING_MAX
#define MH_KALMAN_MOVING_MAX 4
#endif
#ifndef MH_KALMAN_STATES_MAX
#define MH_KALMAN_STATES_MAX (MH_KALMAN_MOVING_MAX + MH_RANGE_BIASES_MAX)
#endif

#if MH_REPORTS_MAX < 4 || MH_REPORTS_MAX > 4096
#error "MH_REPORTS_MAX must be 4 to 4096: least squares needs four reports, and the table is searched linearly"
#endif
#if MH_SENSOR_HISTORY < 2 || MH_SENSOR_HISTORY > 16
#error "MH_SENSOR_HISTORY must be 2 to 16: a difference needs two samples"
#endif
#if MH_DIFFUSION_WINDOW < 2 || MH_DIFFUSION_WINDOW > 8
#error "MH_DIFFUSION_WINDOW must be 2 to 8: a turn shows in the sample after it, and the cost grows with the cube"
#endif
#if MH_DIFFUSION_NEAR < 3 || MH_DIFFUSION_NEAR > 32 || MH_DIFFUSION_STRONG < 3 || MH_DIFFUSION_STRONG > 32
#error "MH_DIFFUSION_NEAR and MH_DIFFUSION_STRONG must be 3 to 32"
#endif
#if MH_TRAIL_KNOTS_MAX < 4 || MH_TRAIL_KNOTS_MAX > 250
#error "MH_TRAIL_KNOTS_MAX must be 4 to 250: its knots thin out with age, so more buy nothing"
#endif
#if MH_DIFFUSION_COAST < 1 || MH_DIFFUSION_COAST > 250 || MH_DIFFUSION_SILENCE < 1 || MH_DIFFUSION_SILENCE > 250
#error "MH_DIFFUSION_COAST and MH_DIFFUSION_SILENCE must be 1 to 250: intervals of up to an hour, counted in ticks"
#endif
#if MH_PARTICLES_MAX < 1 || MH_PARTICLES_MAX > 4096
#error "MH_PARTICLES_MAX must be 1 to 4096: a step draws up to 200 times as many, in one go"
#endif
#if MH_TRACK_BYTES_MAX < 64 || MH_TRACK_BYTES_MAX > 1900
#error "MH_TRACK_BYTES_MAX must be 64 to 1900: a constant-velocity filter takes 60, and it travels in at most 31 frames"
#endif
#if MH_GAS_SENSORS_MAX < 4 || MH_GAS_SENSORS_MAX > 4096
#error "MH_GAS_SENSORS_MAX must be 4 to 4096: a place and a rate take three, and the work grows in proportion"
#endif
#if MH_GAS_CELLS < 16 || MH_GAS_CELLS > 10000
#error "MH_GAS_CELLS must be 16 to 10000: a step computes a concentration for each cell and sensor"
#endif
#if MH_STATES_MAX < 4 || MH_STATES_MAX > 16
#error "MH_STATES_MAX must be 4 to 16: position and velocity in the plane are four, and the work grows with the cube"
#endif
#if MH_STACKED_MAX < 1 || MH_STACKED_MAX > 64
#error "MH_STACKED_MAX must be 1 to 64: a stacked update inverts a matrix of this size"
#endif
#if MH_LEAK_PLACES_MAX < 1 || MH_LEAK_PLACES_MAX > 1024 || MH_LEAK_SENSORS_MAX < 1 || MH_LEAK_SENSORS_MAX > 1024
#error                                                                                                                 \
    "MH_LEAK_PLACES_MAX and MH_LEAK_SENSORS_MAX must be 1 to 1024: the sensors are searched linearly, a reading costs 6 exponentials a place"
#endif
#if MH_FUSED_MAX < 2 || MH_FUSED_MAX > 16
#error "MH_FUSED_MAX must be 2 to 16: feedback has a bit for each cluster in two bytes"
#endif
#if MH_TARGETS_MAX < 1 || MH_TARGETS_MAX > 16 || MH_GROUP_MAX < 1 || MH_GROUP_MAX > 8
#error                                                                                                                 \
    "MH_TARGETS_MAX must be 1 to 16: the table is searched linearly; MH_GROUP_MAX 1 to 8: its targets travel in one message"
#endif
#if MH_SOURCES_MAX < 2 || MH_SOURCES_MAX > 8
#error "MH_SOURCES_MAX must be 2 to 8: a fit solves twice as many equations at once"
#endif
#if MH_SOURCES_MAX < MH_GROUP_MAX
#error "MH_SOURCES_MAX must not be below MH_GROUP_MAX: all targets of a group are fitted at once"
#endif
#if MH_COUNT_SIDE < 4 || MH_COUNT_SIDE > 32 || MH_COUNT_NODES_MAX < 4 || MH_COUNT_NODES_MAX > 64
#error                                                                                                                 \
    "MH_COUNT_SIDE must be 4 to 32, MH_COUNT_NODES_MAX 4 to 64: both are on the stack, and the work grows with the nodes and the square of the side"
#endif
#if MH_HOPS_MAX < 1 || MH_HOPS_MAX > 127
#error "MH_HOPS_MAX must be 1 to 127: it travels as a signed byte"
#endif
#if MH_COLLECTION_KEPT_MAX < 1 || MH_COLLECTION_KEPT_MAX > 100 || MH_COLLECTION_SEEN_MAX < 1 ||                        \
    MH_COLLECTION_SEEN_MAX > 100
#error "MH_COLLECTION_KEPT_MAX and MH_COLLECTION_SEEN_MAX must be 1 to 100: both are searched linearly"
#endif
#if MH_NEIGHBOURS_MAX < 4 || MH_NEIGHBOURS_MAX > 250
#error                                                                                                                 \
    "MH_NEIGHBOURS_MAX must be 4 to 250: a Gabriel graph has four neighbours on average, and the table is searched linearly"
#endif
#if MH_VICINITY_MAX < 4 || MH_VICINITY_MAX > 250
#error "MH_VICINITY_MAX must be 4 to 250: a head needs a few neighbours, and the table is searched linearly"
#endif
#if MH_LINK_QUEUE_MAX < 1 || MH_LINK_QUEUE_MAX > 100 || MH_LINK_SEEN_MAX < 1 || MH_LINK_SEEN_MAX > 250
#error "MH_LINK_QUEUE_MAX must be 1 to 100, MH_LINK_SEEN_MAX 1 to 250: both are searched linearly"
#endif
#if MH_ROUTE_HOPS_MAX < 1 || MH_ROUTE_HOPS_MAX > 32767
#error "MH_ROUTE_HOPS_MAX must be 1 to 32767: it travels as 16 bits with a sign"
#endif
#if MH_CLUSTER_MAX < 4 || MH_CLUSTER_MAX > 200
#error "MH_CLUSTER_MAX must be 4 to 200: a position takes a few ranges, and the list is searched linearly"
#endif
#if MH_FIXED_CLUSTERS_MAX < 1 || MH_FIXED_CLUSTERS_MAX > 250
#error "MH_FIXED_CLUSTERS_MAX must be 1 to 250: a cluster's number travels as a byte"
#endif
#if MH_CLOCK_PAIRS < 2 || MH_CLOCK_PAIRS > 32 || MH_CLOCK_NEIGHBOURS < 1 || MH_CLOCK_NEIGHBOURS > 250
#error                                                                                                                 \
    "MH_CLOCK_PAIRS must be 2 to 32, MH_CLOCK_NEIGHBOURS 1 to 250: a line needs two pairs, and its sums have room for 32"
#endif
#if MH_RANGE_BIASES_MAX < 0 || MH_RANGE_BIASES_MAX > 12
#error "MH_RANGE_BIASES_MAX must be 0 to 12: the work of each range grows with its square"
#endif
#if MH_RANGE_HEARD_MAX < 3 || MH_RANGE_HEARD_MAX > 64
#error "MH_RANGE_HEARD_MAX must be 3 to 64: a place in the plane needs three ranges"
#endif
#if MH_KALMAN_MOVING_MAX < 4 || MH_KALMAN_STATES_MAX < MH_KALMAN_MOVING_MAX + MH_RANGE_BIASES_MAX ||                   \
    MH_KALMAN_STATES_MAX > 16
#error                                                                                                                 \
    "MH_KALMAN_MOVING_MAX must be at least 4, MH_KALMAN_STATES_MAX that and MH_RANGE_BIASES_MAX to 16: work and stack grow with the square"
#endif

#endif
