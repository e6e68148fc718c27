/* The totals of a run that have a name, in one table. A line here is all that one more takes: it then goes over the bus, into runs.csv
 * and summary.json, and into `motehound list --metrics`. */
#ifndef MOTEHOUND_SIM_TOTALS_H
#define MOTEHOUND_SIM_TOTALS_H

#include "simulation.h"

/* Identifier, name with its unit, value from `c`, a const struct simulation_counters * (NaN for one that does not apply), meaning.
 * What the values call is in totals.c. */
/* clang-format off */
#define TOTALS(X)                                                                                                                                  \
    X(FRAMES_SENT, "frames_sent", frames_sent(c), "frames sent by all motes, every hop counted")                                                   \
    X(FRAMES_SENT_BEACONS, "frames_sent_beacons", c->frames_sent[MH_MESSAGE_BEACON], "of these beacons, which build the way to the head")          \
    X(FRAMES_SENT_REPORTS, "frames_sent_reports", c->frames_sent[MH_MESSAGE_REPORT], "of these reports of readings")                               \
    X(FRAMES_SENT_REQUESTS, "frames_sent_requests", c->frames_sent[MH_MESSAGE_REQUEST], "of these requests of the head for readings")              \
    X(FRAMES_SENT_HELLOS, "frames_sent_hellos", c->frames_sent[MH_MESSAGE_HELLO], "of these hellos to the neighbours")                             \
    X(FRAMES_SENT_LANDMARKS, "frames_sent_landmarks", c->frames_sent[MH_MESSAGE_LANDMARK], "of these landmarks, which say where the head is")      \
    X(FRAMES_SENT_SYNCS, "frames_sent_syncs", c->frames_sent[MH_MESSAGE_SYNC], "of these synchronisations of the clocks")                          \
    X(FRAMES_SENT_ASKS, "frames_sent_asks", c->frames_sent[MH_MESSAGE_ASK], "of these requests of a head for samples of its cluster")              \
    X(FRAMES_SENT_ANSWERS, "frames_sent_answers", c->frames_sent[MH_MESSAGE_ANSWER], "of these answers to them")                                   \
    X(FRAMES_SENT_FORMS, "frames_sent_forms", c->frames_sent[MH_MESSAGE_FORM], "of these announcements of a cluster")                              \
    X(FRAMES_SENT_JOINS, "frames_sent_joins", c->frames_sent[MH_MESSAGE_JOIN], "of these answers to them")                                         \
    X(FRAMES_SENT_HAND_OVERS, "frames_sent_hand_overs", c->frames_sent[MH_MESSAGE_HAND_OVER], "of these parts of tracks on their way to the next head")\
    X(FRAMES_SENT_ALERTS, "frames_sent_alerts", c->frames_sent[MH_MESSAGE_ALERT], "of these alerts that the target was found or lost")             \
    X(FRAMES_SENT_POSITIONS, "frames_sent_positions", c->frames_sent[MH_MESSAGE_POSITION], "of these positions on their way to the sink")          \
    X(FRAMES_SENT_VICINITIES, "frames_sent_vicinities", c->frames_sent[MH_MESSAGE_VICINITY], "of these lists of neighbours, for neighbours")      \
    X(FRAMES_SENT_TOKENS, "frames_sent_tokens", c->frames_sent[MH_MESSAGE_TOKEN], "of these messages about who has the token of a search")         \
    X(FRAMES_SENT_LEAKS, "frames_sent_leaks", c->frames_sent[MH_MESSAGE_LEAK], "of these leaks found, on their way to the sink")                    \
    X(FRAMES_SENT_LEADS, "frames_sent_leads", c->frames_sent[MH_MESSAGE_LEAD], "of these such that say that a fixed cluster has a head")               \
    X(FRAMES_SENT_TAKENS, "frames_sent_takens", c->frames_sent[MH_MESSAGE_TAKEN], "of these acknowledgements of the fusion centre")                \
    X(FRAMES_SENT_AWAKES, "frames_sent_awakes", c->frames_sent[MH_MESSAGE_AWAKE], "of these announcements of a target's new head")                    \
    X(FRAMES_SENT_RESTS, "frames_sent_rests", c->frames_sent[MH_MESSAGE_REST], "of these rests of tracks that had no room in them")                   \
    X(FRAMES_SENT_LOCATES, "frames_sent_locates", c->frames_sent[MH_MESSAGE_LOCATE], "of these calls to localise a target")                           \
    X(FRAMES_SENT_SOUNDS, "frames_sent_sounds", c->frames_sent[MH_MESSAGE_SOUND], "of these answers to them")                                         \
    X(FRAMES_SENT_FAILS, "frames_sent_fails", c->frames_sent[MH_MESSAGE_FAIL], "of these such that say that a target was not found")                  \
    X(FRAMES_SENT_SUCCEEDS, "frames_sent_succeeds", c->frames_sent[MH_MESSAGE_SUCCEED], "of these of new heads to the old ones")                      \
    X(FRAMES_SENT_COMPETES, "frames_sent_competes", c->frames_sent[MH_MESSAGE_COMPETE], "of these of nodes that contend for the lead")                \
    X(FRAMES_SENT_DETECTIONS, "frames_sent_detections", c->frames_sent[MH_MESSAGE_DETECTION], "of these of nodes that have detected a target, of which the first leads")\
    X(FRAMES_SENT_SUPPRESSES, "frames_sent_suppresses", c->frames_sent[MH_MESSAGE_SUPPRESS], "of these of the first of them to the others")           \
    X(FRAMES_SENT_MERGES, "frames_sent_merges", c->frames_sent[MH_MESSAGE_MERGE], "of these about targets that go on as a group")                     \
    X(FRAMES_RECEIVED, "frames_received", c->frames_received, "receptions, one for each mote that is handed a frame")                              \
    X(FRAMES_DUPLICATE, "frames_duplicate", c->frames_duplicate, "receptions of a frame that the mote had before; its radio keeps them to itself")  \
    X(FRAMES_LOST, "frames_lost", c->frames_lost, "receptions that failed")                                                                        \
    X(FRAMES_REPEATED, "frames_repeated", c->frames_repeated, "of the frames sent those sent again for want of an acknowledgement")                    \
    X(FRAMES_LOST_COLLISION, "frames_lost_collision", c->frames_lost_by[LOSS_COLLISION], "of the receptions that failed, because of interference")     \
    X(FRAMES_LOST_RANDOM, "frames_lost_random", c->frames_lost_by[LOSS_RANDOM], "of the receptions that failed, by the channel's own loss process")    \
    X(FRAMES_LOST_DEAF, "frames_lost_deaf", c->frames_lost_by[LOSS_DEAF], "of the receptions that failed, because the receiver was sending")           \
    X(FRAMES_LOST_ASLEEP, "frames_lost_asleep", c->frames_lost_by[LOSS_ASLEEP], "of the receptions that failed, because the receiver was asleep")      \
    X(FRAMES_LOST_DEAD, "frames_lost_dead", c->frames_lost_by[LOSS_DEAD], "of the receptions that failed, because the receiver was dead, or the sender died over it")\
    X(FRAMES_LOST_JAMMED, "frames_lost_jammed", c->frames_lost_by[LOSS_JAMMED], "of the receptions that failed, in a jammed zone")                     \
    X(FRAMES_LOST_PARTITION, "frames_lost_partition", c->frames_lost_by[LOSS_PARTITION], "of the receptions that failed, by a partition of the network")\
    X(FRAMES_LOST_MUTE, "frames_lost_mute", c->frames_lost_by[LOSS_MUTE], "of the receptions that failed, because the head's radio was mute")             \
    X(FRAMES_LOST_RANGE, "frames_lost_range", c->frames_lost_by[LOSS_RANGE], "of the receptions that failed, because the addressee was out of range")  \
    X(FRAMES_LOST_BUSY, "frames_lost_busy", c->frames_lost_by[LOSS_BUSY], "frames given up because the channel was never free")                        \
    X(FRAMES_LOST_NO_ACK, "frames_lost_no_ack", c->frames_lost_by[LOSS_NO_ACK], "frames given up for want of an acknowledgement")                      \
    X(FRAMES_LOST_QUEUE, "frames_lost_queue", c->frames_lost_by[LOSS_QUEUE], "frames that the radio refused because it was full")                      \
    X(READINGS, "readings", c->motes.readings, "samples taken by all motes")                                                                       \
    X(READINGS_REFUSED, "readings_refused", c->motes.readings_refused, "samples out of range or out of time")                                      \
    X(READINGS_UNSYNCHRONISED, "readings_unsynchronised", c->motes.readings_unsynchronised, "readings refused before the network time was known")  \
    X(REPORTS, "reports", c->motes.reports, "readings that a mote reported")                                                                       \
    X(REPORTS_ASKED, "reports_asked", c->motes.reports_asked, "of these reported only because the head asked")                                     \
    X(REPORTS_NO_ROUTE, "reports_no_route", c->motes.reports_no_route, "of these lost for want of a next hop, or of room in the queue")                                     \
    X(MESSAGES_LOST_QUEUE, "messages_lost_queue", c->protocol.lost[MH_LOSS_QUEUE_FULL], "messages that a mote had no room for")                    \
    X(MESSAGES_LOST_NO_ACK, "messages_lost_no_ack", c->protocol.lost[MH_LOSS_NOT_ACKNOWLEDGED], "messages given up after all attempts")            \
    X(MESSAGES_LOST_NO_ROUTE, "messages_lost_no_route", c->protocol.lost[MH_LOSS_NO_ROUTE], "messages on their way given up for want of a next hop")\
    X(MESSAGES_LOST_LOOP, "messages_lost_loop", c->protocol.lost[MH_LOSS_LOOP], "messages given up because they came back")                        \
    X(MESSAGES_LOST_HOPS, "messages_lost_hops", c->protocol.lost[MH_LOSS_HOPS], "messages given up after too many hops")                           \
    X(MESSAGES_DUPLICATE, "messages_duplicate", c->protocol.lost[MH_LOSS_DUPLICATE], "messages that a mote got again, and did not take")           \
    X(MESSAGES_RETRIED, "messages_retried", c->protocol.retries, "messages that a mote sent again, beside what its radio does")                    \
    X(MEASUREMENTS, "measurements", c->head.measurements, "reports that reached the head in time")                                                 \
    X(MEASUREMENTS_LATE, "measurements_late", c->head.late, "reports that reached the head too late")                                              \
    X(MEASUREMENTS_OVERFLOWED, "measurements_overflowed", c->head.overflowed, "reports that gave way to stronger ones for want of room")           \
    X(MEASUREMENTS_SATURATED, "measurements_saturated", c->head.at_end, "reports whose value or increment is where sensor nodes saturate, +-2048") \
    X(SATURATIONS, "saturations", c->head.saturated, "steps that trackers refused because a number was too large for their arithmetic") \
    X(DELIVERY_SHARE, "delivery_share", delivery_share(c), "share of the reports that reached the head, in time or late")                          \
    X(CLUSTERS, "clusters", of_clusters(c, c->clusters.total.formed), "clusters formed after the first")                                           \
    X(RECOVERIES, "recoveries", of_clusters(c, c->clusters.total.recoveries), "of these formed because the target was lost")                       \
    X(REPORTS_PER_SAMPLE, "reports_per_sample", per_sample(c, of_clusters(c, c->clusters.total.reports)), "positions sent to the sink, by sampling instant") \
    X(ASKED_PER_SAMPLE, "asked_per_sample", per_sample(c, of_clusters(c, c->clusters.total.asked)), "nodes that a head asked to sample, by sampling instant") \
    X(ANSWERED_PER_SAMPLE, "answered_per_sample", per_sample(c, of_clusters(c, c->clusters.total.answered)), "of these such that measured the target") \
    X(TOKENS_HANDED, "tokens_handed", c->protocol.searches.handed, "searches: tokens that the next head took")                                      \
    X(TOKENS_REFUSED, "tokens_refused", c->protocol.searches.refused, "times that a node did not take one")                                        \
    X(SEARCHES_RESUMED, "searches_resumed", c->protocol.searches.resumed, "times that a head fell silent, and the one before led again")           \
    X(SEARCHES_SENT_FOR, "searches_sent_for", c->protocol.searches.sent_for, "times that the sink heard of no search and had a node begin")        \
    X(HEADS_YIELDED, "heads_yielded", c->protocol.searches.yielded, "searches: times that a head gave way to another")                             \
    X(SEARCHES_CORRUPT, "searches_corrupt", c->protocol.searches.corrupt, "searches: messages with absurd content, not used")                      \
    X(SUMMARIES, "summaries", c->protocol.fixed.summaries, "fixed clusters: summaries of their tracks that heads sent to the sink")              \
    X(SUMMARIES_TAKEN, "summaries_taken", c->protocol.fixed.taken, "of these that the fusion centre took")                                       \
    X(SUMMARIES_REPEATED, "summaries_repeated", c->protocol.fixed.repeated, "of these that it had already: the acknowledgement was lost")        \
    X(SUMMARIES_OVERDUE, "summaries_overdue", c->protocol.fixed.overdue, "of these of a time that was fused already")                            \
    X(SUMMARIES_REFUSED, "summaries_refused", c->protocol.fixed.refused, "messages to heads and sink that were no summaries, or of no cluster")  \
    X(FUSED, "fused", c->protocol.fixed.fused, "positions of the fusion centre")                                                                 \
    X(CORRECTED, "corrected", c->protocol.fixed.corrected, "times that a cluster's track took what the centre fed back")                         \
    X(UNCORRECTED, "uncorrected", c->protocol.fixed.uncorrected, "times that it did not, because it was too old")                                \
    X(SAMPLES_MISDIRECTED, "samples_misdirected", c->protocol.fixed.misdirected, "samples that came to who was head before")                       \
    X(HEADS_TAKEN_OVER, "heads_taken_over", c->protocol.fixed.taken_over, "fixed clusters: times that a member led because the head was silent") \
    X(MESSAGES_PER_CLUSTER, "messages_per_cluster", per_cluster(c, messages_of_locating(c)), "prince: calls to localise, answers, and those of competitions, by fix") \
    X(MESSAGES_PER_CLUSTER_ALL, "messages_per_cluster_all", per_cluster(c, messages_of_locating(c) + messages_of_heads(c)), "prince: the same and the announcements of heads, their hand-overs and reports of failure, by fix") \
    X(DOUBLE_HEADS, "double_heads", per_cluster(c, (double)c->double_heads), "prince: share of the fixes after which a second node was head of the same generation, for a while") \
    X(TARGETS_FOUNDED, "targets_founded", of_princes(c, c->protocol.princes.founded), "prince: times that nodes took what they heard for a new target") \
    X(FIXES, "fixes", of_princes(c, c->protocol.princes.located), "prince: fixes, each of which begins a cluster")               \
    X(FIXES_PRINCE, "fixes_prince", of_princes(c, c->protocol.princes.princes), "of these by the node that the head had chosen")     \
    X(FIXES_EXCEPTION, "fixes_exception", of_princes(c, c->protocol.princes.exceptions), "of these by an outer node, which the target had turned to") \
    X(FIXES_REGENT, "fixes_regent", of_princes(c, c->protocol.princes.regents), "of these by another in the place of a silent prince") \
    X(FIXES_COMPETITION, "fixes_competition", of_princes(c, c->protocol.princes.competitions), "of these by who won a competition, or detected the target first") \
    X(FIXES_RETRIED, "fixes_retried", of_princes(c, c->protocol.princes.retries), "prince: calls to localise that were sent again")    \
    X(FIXES_FAILED, "fixes_failed", of_princes(c, c->protocol.princes.fails), "prince: calls to localise that were given up")       \
    X(WATCHDOGS, "watchdogs", of_princes(c, c->protocol.princes.watchdogs), "prince: times that a head missed its successor")        \
    X(RELAYS, "relays", of_princes(c, c->protocol.princes.relays), "prince: reports of failure passed on")                           \
    X(AWAKES_REPEATED, "awakes_repeated", of_princes(c, c->protocol.princes.repeated), "prince: announcements of a head repeated for who had not heard them") \
    X(TARGETS_GIVEN_UP, "targets_given_up", of_princes(c, c->protocol.princes.lost), "prince: targets that their head, or who looked for them last, gave up") \
    X(TARGETS_EVICTED, "targets_evicted", of_princes(c, c->protocol.princes.evicted), "prince: times that a node's table had no room for a target, and the first that was to leave it went") \
    X(PRINCE_REFUSED, "prince_refused", of_princes(c, c->protocol.princes.refused), "prince: messages with absurd content, or of no time about now") \
    X(GROUPS_MERGED, "groups_merged", of_princes(c, c->protocol.princes.merged), "prince: times that two targets went on as a group")   \
    X(GROUPS_SPLIT, "groups_split", of_princes(c, c->protocol.princes.split), "prince: times that a group fell into parts")          \
    X(PCRB_M, "pcrb_m", of_bounds(c, c->bounds.pcrb_m), "ranged walk, or fixed clusters: the posterior Cramer-Rao bound of position_rmse_m")              \
    X(CCRB_M, "ccrb_m", of_bounds(c, c->bounds.ccrb_m), "fixed clusters: the bound along the run's own path") \
    X(LOCAL_CCRB_M_1, "local_ccrb_m_1", of_bounds(c, c->bounds.local_ccrb_m[0]), "the same of the first fixed cluster by itself") \
    X(LOCAL_CCRB_M_2, "local_ccrb_m_2", of_bounds(c, c->bounds.local_ccrb_m[1]), "of the second") \
    X(LOCAL_CCRB_M_3, "local_ccrb_m_3", of_bounds(c, c->bounds.local_ccrb_m[2]), "of the third") \
    X(LOCAL_CCRB_M_4, "local_ccrb_m_4", of_bounds(c, c->bounds.local_ccrb_m[3]), "of the fourth") \
    X(FIX_CRLB_M, "fix_crlb_m", of_sound(c, c->bounds.fix_crlb_m), "sound: the Cramer-Rao bound of position_rmse_m for fixes from the samples of one instant, of all nodes that detect a target") \
    X(CLUSTERS_LEAST, "clusters_least", in_hindsight(c, c->bounds.hand_overs), "ranged target: the least hand-overs in hindsight, between heads that sense it at every instant") \
    X(REPORTS_LEAST, "reports_least", per_sample(c, in_hindsight(c, c->bounds.reports)), "ranged target: the least reports in hindsight that follow it within tracker.tolerance_m, by sampling instant") \
    X(CLOCK_ERROR_MEDIAN_MS, "clock_error_median_ms", c->clock_error_median_ms, "median of the error of the motes' network time, over motes and time")\
    X(CLOCK_ERROR_P99_MS, "clock_error_p99_ms", c->clock_error_p99_ms, "99th percentile of the error of the motes' network time")                  \
    X(CLOCK_KNOWN_SHARE, "clock_known_share", c->clock_known_share, "share of the motes and times at which the network time was known")            \
    X(LIFETIME_S, "lifetime_s", c->energy.lifetime_s, "until the first battery was empty")                                                         \
    X(LIFETIME_HALF_S, "lifetime_half_s", c->energy.lifetime_half_s, "until half of the batteries were empty")                                     \
    X(MOTES_DEAD, "motes_dead", c->energy.dead, "motes whose battery is empty at the end")                                                         \
    X(ENERGY_MJ, "energy_mj", energy_mj(c, ANY, ANY), "energy used by all motes but the one on mains")                                                     \
    X(ENERGY_MJ_LOCALISATION, "energy_mj_localisation", energy_mj(c, ANY, ENERGY_LOCALISATION), "of this for sampling and computing")              \
    X(ENERGY_MJ_MEASURING, "energy_mj_measuring", energy_mj(c, ANY, ENERGY_MEASURING), "of this for asking for readings and answering")            \
    X(ENERGY_MJ_CLUSTERING, "energy_mj_clustering", energy_mj(c, ANY, ENERGY_CLUSTERING), "of this for clusters")                                  \
    X(ENERGY_MJ_REPORTING, "energy_mj_reporting", energy_mj(c, ANY, ENERGY_REPORTING), "of this for carrying reports")                             \
    X(ENERGY_MJ_ROUTING, "energy_mj_routing", energy_mj(c, ANY, ENERGY_ROUTING), "of this for finding ways and neighbours")                        \
    X(ENERGY_MJ_TIME, "energy_mj_time", energy_mj(c, ANY, ENERGY_TIME), "of this for keeping clocks together")                                     \
    X(ENERGY_MJ_IDLE, "energy_mj_idle", energy_mj(c, ANY, ENERGY_IDLE), "of this for nothing: waiting and sleeping")                               \
    X(ENERGY_MJ_HOTTEST, "energy_mj_hottest", 1e3 * c->energy.hottest_j, "energy used by the mote that used most")                                  \
    X(ENERGY_MJ_PER_SAMPLE, "energy_mj_per_sample", per_sample(c, energy_mj(c, ANY, ANY)), "energy used by all motes but the one on mains, by sampling instant") \
    X(ENERGY_MJ_PER_SAMPLE_LOCALISATION, "energy_mj_per_sample_localisation", per_sample(c, energy_mj(c, ANY, ENERGY_LOCALISATION)), "of this for sampling and computing") \
    X(ENERGY_MJ_PER_SAMPLE_MEASURING, "energy_mj_per_sample_measuring", per_sample(c, energy_mj(c, ANY, ENERGY_MEASURING)), "of this for asking and answering") \
    X(ENERGY_MJ_PER_SAMPLE_CLUSTERING, "energy_mj_per_sample_clustering", per_sample(c, energy_mj(c, ANY, ENERGY_CLUSTERING)), "of this for clusters") \
    X(ENERGY_MJ_PER_SAMPLE_REPORTING, "energy_mj_per_sample_reporting", per_sample(c, energy_mj(c, ANY, ENERGY_REPORTING)), "of this for carrying reports") \
    X(ENERGY_MJ_PER_SAMPLE_ROUTING, "energy_mj_per_sample_routing", per_sample(c, energy_mj(c, ANY, ENERGY_ROUTING)), "of this for finding ways and neighbours") \
    X(ENERGY_MJ_PER_SAMPLE_TIME, "energy_mj_per_sample_time", per_sample(c, energy_mj(c, ANY, ENERGY_TIME)), "of this for keeping clocks together") \
    X(ENERGY_MJ_PER_SAMPLE_IDLE, "energy_mj_per_sample_idle", per_sample(c, energy_mj(c, ANY, ENERGY_IDLE)), "of this for waiting and sleeping")      \
    X(ENERGY_MJ_STATE_SENSING, "energy_mj_state_sensing", energy_mj(c, ENERGY_SENSING, ANY), "energy of the sensors")                              \
    X(ENERGY_MJ_STATE_CPU, "energy_mj_state_cpu", energy_mj(c, ENERGY_CPU, ANY), "energy of the processors, idle ones included")                   \
    X(ENERGY_MJ_STATE_TRANSMIT, "energy_mj_state_transmit", energy_mj(c, ENERGY_TRANSMIT, ANY), "energy of the radios while transmitting")         \
    X(ENERGY_MJ_STATE_RECEIVE, "energy_mj_state_receive", energy_mj(c, ENERGY_RECEIVE, ANY), "energy of the radios while receiving")               \
    X(ENERGY_MJ_STATE_LISTEN, "energy_mj_state_listen", energy_mj(c, ENERGY_LISTEN, ANY), "energy of the radios while listening")                  \
    X(ENERGY_MJ_STATE_SLEEP, "energy_mj_state_sleep", energy_mj(c, ENERGY_SLEEP, ANY), "energy of the radios while sleeping")                      \
    X(EVENTS, "events", c->events, "that motes handled: readings, frames, alarms ...")                                                           \
    X(WINDOWS, "windows", c->windows, "of simulated time that the motes were run through together")
/* clang-format on */

#define TOTAL_ENUMERATOR(id, name, value, meaning) TOTAL_##id,
enum total { TOTALS(TOTAL_ENUMERATOR) TOTAL_COUNT };

extern const char *const total_names[TOTAL_COUNT];
extern const char *const total_meanings[TOTAL_COUNT];

void totals_of(const struct simulation_counters *counters, double values[TOTAL_COUNT]);

#endif
