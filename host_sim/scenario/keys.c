#include "scenario/keys.h"

#include "scenario/text.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) offsetof(struct scenario, member)

/* clang-format off */
const struct scenario_key scenario_keys[] = {
    {"name", KEY_TEXT, AT(name), "", 0, 100, NULL, "of the experiment"},
    {"description", KEY_TEXT, AT(description), "", 0, 400, NULL, "one sentence for `motehound list`"},
    {"field.width_m", KEY_NUMBER, AT(field.width_m), "80", 1, 1e5, NULL, "the field is [0, width] x [0, height]"},
    {"field.height_m", KEY_NUMBER, AT(field.height_m), "80", 1, 1e5, NULL, ""},
    {"source.path", KEY_CHOICE, AT(source.path), "arcs", 0, 0, "waypoints|arcs|still|gauss_markov|white_acceleration|none|scripted|parallel|crossing|bounce|lanes|turn|ring|random|scattered", "straight legs; two arcs of 90 degrees, left then right; no movement; as target.* says, another for each seed, a Gauss-Markov walk or a constant velocity disturbed by random accelerations; or no source at all. Of sound, one target or several: those of targets; target.count of them along the first leg of source.points, side by side, crossing or nearly meeting in its middle, in lanes that draw near, with turns, or in a ring about it; or from one random place to the next, or at another random place at each sampling instant"},
    {"source.points", KEY_POINTS, AT(source.points), "0,0; 38,78", 1, 1000, NULL, "corners, in a file as a list of {x_m, y_m, speed_factor}; the factor belongs to the leg that ends there"},
    {"source.speed_mps", KEY_NUMBER, AT(source.speed_mps), "1", 0.01, 100, NULL, "along the path"},
    {"source.duration_s", KEY_NUMBER, AT(source.duration_s), "0", 0, 1e6, NULL, "of a still source, one that moves as target.* says, or of the run without a source; others take as long as their path"},
    {"source.release_gps", KEY_NUMBER, AT(source.release_gps), "100", 0, 1e6, NULL, "mean release rate"},
    {"source.release_variation", KEY_NUMBER, AT(source.release_variation), "0", 0, 0.95, NULL, "share of the release that varies as a sine"},
    {"source.release_period_s", KEY_NUMBER, AT(source.release_period_s), "60", 0.1, 1e6, NULL, "period of that sine"},
    {"source.diffusion_m2ps", KEY_NUMBER, AT(source.diffusion_m2ps), "1", 1e-4, 1e4, NULL, "diffusion coefficient of the field"},
    {"source.rate_mlps", KEY_NUMBER, AT(source.rate_mlps), "30", 0, 1e9, NULL, "gas: rate of release"},
    {"source.mixing_m2ps", KEY_NUMBER, AT(source.mixing_m2ps), "30", 1e-4, 1e6, NULL, "gas: turbulent diffusion coefficient of the air"},
    {"source.fluctuation", KEY_NUMBER, AT(source.fluctuation), "0", 0, 3, NULL, "gas: the plume fluctuates; standard deviation of what comes to a sensor at an instant, as a share of its mean (log-normal, independent)"},
    {"source.start_s", KEY_NUMBER, AT(source.start_s), "0", 0, 1e6, NULL, "sound: before this there is no target, where there can be several"},
    {"source.loudness", KEY_NUMBER, AT(source.loudness), "1", 1e-3, 1e3, NULL, "sound: energy of a target at sensor.range_m, in units of the least that a sensor detects; at 1 that is how far it is heard"},
    {"wind.speed_mps", KEY_NUMBER, AT(wind.speed_mps), "1", 0, 100, NULL, "gas: of the wind ..."},
    {"wind.direction_rad", KEY_NUMBER, AT(wind.direction_rad), "0", -10, 10, NULL, "... which blows towards this direction, counter-clockwise from the x axis"},
    {"target.speed_mph", KEY_NUMBER, AT(target.speed_mph), "10", 0.01, 1000, NULL, "path gauss_markov: mean speed, miles per hour (0.44704 m/s)"},
    {"target.speed_sd", KEY_NUMBER, AT(target.speed_sd), "0.2", 0, 1, NULL, "gauss_markov: standard deviation of the speed, as a share of its mean"},
    {"target.heading_sd_rad", KEY_NUMBER, AT(target.heading_sd_rad), "0.39269908169872414", 0, 10, NULL, "gauss_markov: standard deviation of the heading"},
    {"target.memory", KEY_NUMBER, AT(target.memory), "0.9", 0, 1, NULL, "gauss_markov: of speed and heading from one sample to the next; 0 draws them anew, 1 keeps them"},
    {"target.x_m", KEY_NUMBER, AT(target.x_m), "0", -1e5, 1e5, NULL, "white_acceleration: where it starts, on average"},
    {"target.y_m", KEY_NUMBER, AT(target.y_m), "0", -1e5, 1e5, NULL, ""},
    {"target.vx_mps", KEY_NUMBER, AT(target.vx_mps), "1", -1e3, 1e3, NULL, "white_acceleration: how it moves then, on average"},
    {"target.vy_mps", KEY_NUMBER, AT(target.vy_mps), "0", -1e3, 1e3, NULL, ""},
    {"target.position_sd_m", KEY_NUMBER, AT(target.position_sd_m), "1", 1e-3, 1e4, NULL, "white_acceleration: standard deviation of each coordinate of its start"},
    {"target.velocity_sd_mps", KEY_NUMBER, AT(target.velocity_sd_mps), "0.2", 1e-3, 1e3, NULL, "white_acceleration: the same of its velocity"},
    {"target.acceleration_x_mps2", KEY_NUMBER, AT(target.acceleration_x_mps2), "0.01", 1e-5, 100, NULL, "white_acceleration: standard deviation of its acceleration along x, drawn anew for each sampling interval"},
    {"target.acceleration_y_mps2", KEY_NUMBER, AT(target.acceleration_y_mps2), "0.01", 1e-5, 100, NULL, "the same along y"},
    {"target.count", KEY_COUNT, AT(target.count), "1", 1, TARGETS_MAX, NULL, "parallel and the paths named after it: so many targets"},
    {"target.spacing_m", KEY_NUMBER, AT(target.spacing_m), "60", 0, 1e4, NULL, "parallel, turn: between neighbours; bounce, lanes: likewise, where they are nearest; ring: its radius"},
    {"target.apart_m", KEY_NUMBER, AT(target.apart_m), "80", 0, 1e4, NULL, "lanes: between neighbours before they draw near and after"},
    {"target.turn_deg", KEY_NUMBER, AT(target.turn_deg), "90", -180, 180, NULL, "turn: to the left by this angle; crossing, bounce: between the two ways"},
    {"target.turns", KEY_COUNT, AT(target.turns), "1", 1, 100, NULL, "turn: so many, to the left and to the right by turns"},
    {"targets", KEY_TARGETS, AT(targets), "", 0, TARGETS_MAX, NULL, "scripted: in a file a list of {start_s, speed_mps, loudness, points}, the first three 0, source.speed_mps and source.loudness where they are missing, points as source.points"},
    {"network.nodes", KEY_COUNT, AT(network.nodes), "1280", 4, 1e6, NULL, "sensor nodes"},
    {"network.layout", KEY_CHOICE, AT(network.layout), "uniform", 0, 0, "uniform|r2|grid|hashed|file|rings|strat", "random, quasi-random, cell-centred grid, random as the published experiments with ranges draw it, from network.file, on rings as clusters.* says, or one at random in each cell of a grid"},
    {"network.file", KEY_TEXT, AT(network.file), "", 0, 4000, NULL, "nodes.csv of layout file; in a file relative to it. For network.protocol fixed it has a column cluster, from 1, and may have period_s and noise_m2"},
    {"network.spacing_m", KEY_NUMBER, AT(network.spacing_m), "0", 0, 1e5, NULL, "grid: side of its cells, from the field's corner; 0 for cells that fill the field"},
    {"network.jitter", KEY_NUMBER, AT(network.jitter), "0", 0, 0.5, NULL, "grid: a node stands off the middle of its cell by up to this share of its side"},
    {"network.grid", KEY_COUNT, AT(network.grid), "34", 2, 1000, NULL, "strat: cells along each side of the field; their square is the number of nodes, whatever network.nodes is"},
    {"network.density", KEY_NUMBER, AT(network.density), "0", 0, 1e4, NULL, "mean number of nodes within sensor.range_m of a place: gives the field's side, with the head in the middle; 0: field.* and network.sink_* do"},
    {"network.sink_x_m", KEY_NUMBER, AT(network.sink_x_m), "40", -1e5, 1e5, NULL, "where the head stands"},
    {"network.sink_y_m", KEY_NUMBER, AT(network.sink_y_m), "40", -1e5, 1e5, NULL, ""},
    {"network.starts", KEY_COUNT, AT(network.starts), "0", 0, 1000, NULL, "token: so many consecutive seeds, from a multiple of it on, share a deployment, and each begins at another node, at random but farther than network.start_m from the source; the deployment is redrawn until it is connected and has so many; 0: each seed has its own deployment, and protocol.start begins"},
    {"network.start_m", KEY_NUMBER, AT(network.start_m), "400", 0, 1e5, NULL, "... this far"},
    {"network.protocol", KEY_WORD, AT(network.protocol), "collection", 0, 0, "collection|direct|cluster|prince|fixed|token|chatter", "how measurements reach the head; cluster: nodes around a ranged target follow it and report it to the sink; prince: nodes around targets that they hear follow them, each head choosing the next beforehand; fixed: the clusters of clusters.*, or of network.file, all follow it, and the sink joins what they say as fusion.* says; token: the search for a source of gas walks from head to head; chatter: not at all, each node broadcasts 30 bytes once in sensor.interval_s"},
    {"network.ideal", KEY_SWITCH, AT(network.ideal), "false", 0, 0, NULL, "cluster, prince, fixed, token: without frames, as published: nothing is lost or collides (but see fusion.report_loss), messages take no time; of cluster, energy is charged message by message"},
    {"protocol.routing", KEY_CHOICE, AT(protocol.routing), "tree", 0, 0, "tree|geographic|greedy", "collection: reports travel up the tree of the head's beacons, or by places to the head's, with face routing around voids or without"},
    {"protocol.hello_s", KEY_NUMBER, AT(protocol.hello_s), "10", 1, 600, NULL, "geographic, greedy: between a node's hellos to its neighbours"},
    {"protocol.election", KEY_CHOICE, AT(protocol.election), "sacx", 0, 0, "sacx|sac|rho|scm|scm_near|scm_set|prince|competition|timestamp", "cluster: who follows the target next: nodes along its predicted path (sacx, sac), along a ray in its heading (rho), or whoever detects it: the set when one joins (scm), when the nearest changes (scm_near), at any change (scm_set). prince: whom the head has chosen (prince), whoever hears it best (competition) or first (timestamp)"},
    {"protocol.members", KEY_COUNT, AT(protocol.members), "0", 0, MH_CLUSTER_MAX, NULL, "cluster: nodes of a cluster beside its head; 0 for the rule's own number, 15 for sacx and 7 for sac and rho"},
    {"protocol.horizon", KEY_COUNT, AT(protocol.horizon), "4", 1, MH_ELECTION_HORIZON_MAX, NULL, "sac: predicted samples that the election looks at"},
    {"protocol.least_answers", KEY_COUNT, AT(protocol.least_answers), "4", 0, MH_CLUSTER_MAX + 1, NULL, "sac, sacx, rho: an election when fewer nodes than this measure the target or will"},
    {"protocol.watch_s", KEY_NUMBER, AT(protocol.watch_s), "10", 0, 3600, NULL, "cluster, prince: a node that hears of no track looks for a target this often, at a time of its own; prince: 0 for never"},
    {"protocol.start", KEY_COUNT, AT(protocol.start), "0", 0, 1e9, NULL, "token: the node at which the search begins, where network.starts is 0"},
    {"protocol.heads_max", KEY_COUNT, AT(protocol.heads_max), "60", 1, 250, NULL, "token: the search ends after so many heads, ..."},
    {"protocol.calm", KEY_COUNT, AT(protocol.calm), "3", 1, 100, NULL, "... or when the estimates of so many in succession are calm (tracker.calm_*)"},
    {"protocol.guards", KEY_CHOICE, AT(protocol.guards), "on", 0, 0, "off|on", "prince: regents, watchdogs, repetitions, relays and the test for mirror images; off: the published rules alone"},
    {"protocol.entries", KEY_SWITCH, AT(protocol.entries), "true", 0, 0, NULL, "prince: the nodes around where targets begin expect them there in the first 30 s"},
    {"protocol.replies", KEY_COUNT, AT(protocol.replies), "2", 2, 16, NULL, "prince: a query has enough with so many"},
    {"protocol.lead_m", KEY_NUMBER, AT(protocol.lead_m), "60", 1, 1e4, NULL, "prince: the one is chosen that the target reaches after about this way, ..."},
    {"protocol.farthest", KEY_SWITCH, AT(protocol.farthest), "false", 0, 0, NULL, "... or after the longest"},
    {"clusters.nodes", KEY_NUMBERS, AT(clusters.nodes), "3, 4, 5, 6", 1, 32, NULL, "rings: of each cluster; clusters stand in the cells of a square grid over the field, row by row"},
    {"clusters.ring_m", KEY_NUMBER, AT(clusters.ring_m), "15", 0.1, 1e4, NULL, "rings: radius; the r-th ring is turned by r pi / 7"},
    {"clusters.range_variance_m2", KEY_NUMBERS, AT(clusters.range_variance_m2), "0.02, 0.015, 0.01, 0.03", 1e-6, 1e4, NULL, "rings: of the ranges of each cluster, in place of sensor.range_noise_m"},
    {"clusters.every", KEY_COUNT, AT(clusters.every), "2", 1, 1000, NULL, "rings: the first node of a cluster samples at each so many sampling instants; file: so do all without a period_s"},
    {"clusters.rates", KEY_COUNT, AT(clusters.rates), "3", 1, 32, NULL, "rings: node i of n takes 1 + floor(rates i / n) times as long as the first between samples"},
    {"clusters.shared", KEY_COUNT, AT(clusters.shared), "0", 0, 32, NULL, "fixed: a cluster hears so many nodes of the next one too"},
    {"fusion.rule", KEY_CHOICE, AT(fusion.rule), "ci", 0, 0, "ci|ci_trace_opt|ci_det|sci|ici|ei|hif|hif_feedback|naive|central", "fixed: how the sink joins what clusters say: covariance intersection with weights by the traces or optimal ones, split covariance, inverse covariance or ellipsoidal intersection, increments of information, without or with the result told to the clusters, as if independent; central: the sink has all samples itself (over the air they travel as network.protocol collection has them)"},
    {"fusion.report_s", KEY_NUMBER, AT(fusion.report_s), "1", 0.1, 3600, NULL, "fixed: between what a cluster tells the sink"},
    {"fusion.report_loss", KEY_NUMBER, AT(fusion.report_loss), "0", 0, 1, NULL, "fixed, ideal: probability that the sink does not get it"},
    {"fusion.wait_s", KEY_NUMBER, AT(fusion.wait_s), "0.5", 0.01, 3600, NULL, "fixed: the sink waits for what clusters tell this long, at most fusion.report_s"},
    {"fusion.keep_s", KEY_NUMBER, AT(fusion.keep_s), "10", 0, 3600, NULL, "fixed: what a cluster told last stands, predicted, for what is lost, until it is this old (all rules but hif*, which lose nothing)"},
    {"traffic.sources", KEY_COUNT, AT(traffic.sources), "0", 0, 1e6, NULL, "path none: nodes that report once in sensor.interval_s, each at its own time"},
    {"sensor.quantity", KEY_CHOICE, AT(sensor.quantity), "concentration", 0, 0, "concentration|range|gas|sound", "what is measured: the source's diffusing substance, how far the target is, a gas that the wind brings from it, or the energy of its sound"},
    {"sensor.interval_s", KEY_NUMBER, AT(sensor.interval_s), "1", 0.01, 3600, NULL, "between samples; in a replay the recording's own unless set"},
    {"sensor.relative_noise", KEY_NUMBER, AT(sensor.relative_noise), "0", 0, 1, NULL, "standard deviation as a share of the reading"},
    {"sensor.additive_noise", KEY_NUMBER, AT(sensor.additive_noise), "0", 0, 1000, NULL, "standard deviation, g/m2"},
    {"sensor.adc_bits", KEY_COUNT, AT(sensor.adc_bits), "0", 0, 24, NULL, "of the converter; 0 for an ideal one"},
    {"sensor.full_scale", KEY_NUMBER, AT(sensor.full_scale), "64", 1e-3, 2047, NULL, "of the converter, g/m2"},
    {"sensor.loss", KEY_NUMBER, AT(sensor.loss), "0", 0, 1, NULL, "probability that a reading never comes"},
    {"sensor.outage_start_s", KEY_NUMBER, AT(sensor.outage_start_s), "0", 0, 1e6, NULL, "from then on no reading of any node comes ..."},
    {"sensor.outage_s", KEY_NUMBER, AT(sensor.outage_s), "0", 0, 1e6, NULL, "... for this long"},
    {"sensor.range_m", KEY_NUMBER, AT(sensor.range_m), "50", 0.1, 1000, NULL, "range, sound: the target is detected within; a sound of loudness 1 is at its threshold there"},
    {"sensor.range_noise_m", KEY_NUMBER, AT(sensor.range_noise_m), "5", 0, 100, NULL, "range: standard deviation of a range"},
    {"sensor.noise_correlation", KEY_NUMBER, AT(sensor.noise_correlation), "0", 0, 1, NULL, "range: correlation of the noise of any two ranges of the same instant, unknown to the tracker"},
    {"sensor.noisy_detection", KEY_SWITCH, AT(sensor.noisy_detection), "false", 0, 0, NULL, "range: the noisy range decides whether the target is detected, not the true one"},
    {"sensor.source_noise", KEY_NUMBER, AT(sensor.source_noise), "0.19", 0, 2, NULL, "sound: standard deviation of the logarithm of what comes to a sensor"},
    {"sensor.background_noise", KEY_NUMBER, AT(sensor.background_noise), "0.05", 0, 100, NULL, "sound: standard deviation of what is left of the background when its mean is subtracted, in units of the threshold"},
    {"sensor.noise_ppm", KEY_NUMBER, AT(sensor.noise_ppm), "0.0001", 0, 1e6, NULL, "gas: standard deviation of a sample"},
    {"sensor.unit_ppm", KEY_NUMBER, AT(sensor.unit_ppm), "0.001", 1e-9, 1e6, NULL, "gas: concentration that is 1 in what the sensor gives, -2048 to 2048 in steps of a millionth"},
    {"radio.range_m", KEY_NUMBER, AT(radio.range_m), "15", 0.1, 1e5, NULL, "disc: frames reach every mote within"},
    {"radio.delay_s", KEY_NUMBER, AT(radio.delay_s), "0.001", 0, 10, NULL, "of one hop, beside the air time"},
    {"radio.bitrate_bps", KEY_NUMBER, AT(radio.bitrate_bps), "250000", 100, 1e9, NULL, "profile ideal: gives the air time"},
    {"radio.loss", KEY_NUMBER, AT(radio.loss), "0", 0, 1, NULL, "probability that a receiver loses a frame"},
    {"radio.burst_loss", KEY_NUMBER, AT(radio.burst_loss), "1", 0, 1, NULL, "the same in a burst, which a receiver has for itself"},
    {"radio.burst_good_s", KEY_NUMBER, AT(radio.burst_good_s), "10", 1e-3, 1e6, NULL, "mean time between bursts"},
    {"radio.burst_bad_s", KEY_NUMBER, AT(radio.burst_bad_s), "0", 0, 1e6, NULL, "mean duration of a burst; 0 for none"},
    {"radio.profile", KEY_WORD, AT(radio.profile), "ideal", 0, 0, "ideal|802154|cc1000", "no contention; IEEE 802.15.4 at 2.4 GHz; or Mica2's CC1000"},
    {"radio.propagation", KEY_CHOICE, AT(radio.propagation), "disc", 0, 0, "disc|log_distance", "all within radio.range_m; or by power, path loss and sensitivity"},
    {"radio.path_loss_exponent", KEY_NUMBER, AT(radio.path_loss_exponent), "3", 1, 8, NULL, "log_distance: of the path loss"},
    {"radio.reference_loss_db", KEY_NUMBER, AT(radio.reference_loss_db), "46.68", 0, 200, NULL, "log_distance: path loss at 1 m"},
    {"radio.shadowing_db", KEY_NUMBER, AT(radio.shadowing_db), "0", 0, 20, NULL, "log_distance: standard deviation of a link's log-normal shadowing"},
    {"radio.power_dbm", KEY_NUMBER, AT(radio.power_dbm), "0", -100, 50, NULL, "log_distance: of all transmitters"},
    {"radio.sensitivity_dbm", KEY_NUMBER, AT(radio.sensitivity_dbm), "0", -200, 0, NULL, "log_distance: weakest frame that is received, noise floor and carrier sense move with it; 0 for the profile's"},
    {"radio.retries", KEY_COUNT, AT(radio.retries), "-1", -1, 100, NULL, "of a frame that is not acknowledged; -1 for the profile's"},
    {"radio.backoffs", KEY_COUNT, AT(radio.backoffs), "-1", -1, 1e9, NULL, "after the first, before a frame is given up; -1 for the profile's"},
    {"radio.queue", KEY_COUNT, AT(radio.queue), "8", 1, 1000, NULL, "frames a radio holds, the one being sent included"},
    {"radio.wake_period_s", KEY_NUMBER, AT(radio.wake_period_s), "0", 0, 60, NULL, "a radio that sleeps opens for radio.wake_length_s once in this period, all at multiples of it; 0: it is deaf"},
    {"radio.wake_length_s", KEY_NUMBER, AT(radio.wake_length_s), "0.01", 1e-4, 60, NULL, "frames that begin within are received"},
    {"faults.every_s", KEY_NUMBER, AT(faults.every_s), "0", 0, 1e6, NULL, "all faults come again with this period and hit other motes; 0 for once"},
    {"faults.stuck_share", KEY_NUMBER, AT(faults.stuck.share), "0", 0, 1, NULL, "share of the motes whose sensor repeats its last reading"},
    {"faults.stuck_from_s", KEY_NUMBER, AT(faults.stuck.from_s), "0", 0, 1e6, NULL, "from then on ..."},
    {"faults.stuck_for_s", KEY_NUMBER, AT(faults.stuck.for_s), "1e6", 0, 1e6, NULL, "... for this long"},
    {"faults.spike_share", KEY_NUMBER, AT(faults.spike.share), "0", 0, 1, NULL, "share of the motes whose sensor spikes now and then"},
    {"faults.spike_from_s", KEY_NUMBER, AT(faults.spike.from_s), "0", 0, 1e6, NULL, "from then on ..."},
    {"faults.spike_for_s", KEY_NUMBER, AT(faults.spike.for_s), "1e6", 0, 1e6, NULL, "... for this long"},
    {"faults.spike_chance", KEY_NUMBER, AT(faults.spike.chance), "0.1", 0, 1, NULL, "probability that a reading of such a mote is a spike"},
    {"faults.spike", KEY_NUMBER, AT(faults.spike.height), "10", -2047, 2047, NULL, "added to a reading that is a spike, g/m2"},
    {"faults.saturate_share", KEY_NUMBER, AT(faults.saturate.share), "0", 0, 1, NULL, "share of the motes whose sensor saturates"},
    {"faults.saturate_from_s", KEY_NUMBER, AT(faults.saturate.from_s), "0", 0, 1e6, NULL, "from then on ..."},
    {"faults.saturate_for_s", KEY_NUMBER, AT(faults.saturate.for_s), "1e6", 0, 1e6, NULL, "... for this long"},
    {"faults.saturate_at", KEY_NUMBER, AT(faults.saturate.at), "5", 0, 2047, NULL, "g/m2; the mote does not know"},
    {"faults.bias_share", KEY_NUMBER, AT(faults.bias.share), "0", 0, 1, NULL, "share of the motes whose sensor is biased"},
    {"faults.bias_from_s", KEY_NUMBER, AT(faults.bias.from_s), "0", 0, 1e6, NULL, "from then on ..."},
    {"faults.bias_for_s", KEY_NUMBER, AT(faults.bias.for_s), "1e6", 0, 1e6, NULL, "... for this long"},
    {"faults.bias", KEY_NUMBER, AT(faults.bias.offset), "1", -2047, 2047, NULL, "added to every reading, g/m2"},
    {"faults.dead_share", KEY_NUMBER, AT(faults.dead.share), "0", 0, 1, NULL, "share of the nodes that die"},
    {"faults.dead_from_s", KEY_NUMBER, AT(faults.dead.from_s), "0", 0, 1e6, NULL, "when"},
    {"faults.reboot_share", KEY_NUMBER, AT(faults.reboot.share), "0", 0, 1, NULL, "share of the nodes that fall silent and restart with empty memory"},
    {"faults.reboot_from_s", KEY_NUMBER, AT(faults.reboot.from_s), "0", 0, 1e6, NULL, "silent from then on ..."},
    {"faults.reboot_for_s", KEY_NUMBER, AT(faults.reboot.for_s), "5", 0.001, 1e6, NULL, "... for this long"},
    {"faults.partition_from_s", KEY_NUMBER, AT(faults.partition.from_s), "0", 0, 1e6, NULL, "no frame crosses a line from then on ..."},
    {"faults.partition_for_s", KEY_NUMBER, AT(faults.partition.for_s), "0", 0, 1e6, NULL, "... for this long; 0 for no partition"},
    {"faults.partition_x_m", KEY_NUMBER, AT(faults.partition.x_m), "0", -1e5, 1e5, NULL, "the line runs through this place ..."},
    {"faults.partition_y_m", KEY_NUMBER, AT(faults.partition.y_m), "0", -1e5, 1e5, NULL, ""},
    {"faults.partition_angle_rad", KEY_NUMBER, AT(faults.partition.angle_rad), "0", -10, 10, NULL, "... at this angle from the x axis"},
    {"faults.mute_from_s", KEY_NUMBER, AT(faults.mute.from_s), "0", 0, 1e6, NULL, "the head's radio neither sends nor hears from then on ..."},
    {"faults.mute_for_s", KEY_NUMBER, AT(faults.mute.for_s), "0", 0, 1e6, NULL, "... for this long; 0 for a head that is never mute"},
    {"faults.jam_from_s", KEY_NUMBER, AT(faults.jam.from_s), "0", 0, 1e6, NULL, "nothing is heard in a disc from then on ..."},
    {"faults.jam_for_s", KEY_NUMBER, AT(faults.jam.for_s), "0", 0, 1e6, NULL, "... for this long; 0 for no jam"},
    {"faults.jam_x_m", KEY_NUMBER, AT(faults.jam.x_m), "0", -1e5, 1e5, NULL, "centre of the disc"},
    {"faults.jam_y_m", KEY_NUMBER, AT(faults.jam.y_m), "0", -1e5, 1e5, NULL, ""},
    {"faults.jam_radius_m", KEY_NUMBER, AT(faults.jam.radius_m), "20", 0, 1e5, NULL, ""},
    {"clock.drift_ppm", KEY_NUMBER, AT(clock.drift_ppm), "0", 0, 250, NULL, "rates of the motes' clocks lie evenly within this of the sink's, which is the true one"},
    {"clock.offset_s", KEY_NUMBER, AT(clock.offset_s), "0", 0, 1e6, NULL, "at the start they show at most this much more or less than the true time"},
    {"clock.wander_ppm", KEY_NUMBER, AT(clock.wander_ppm), "0", 0, 50, NULL, "their rates swing by this, with a period of half an hour and a phase of their own"},
    {"clock.sync", KEY_CHOICE, AT(clock.sync), "none", 0, 0, "none|flooding", "how motes get to know the true time; none: they take their own clock's"},
    {"clock.sync_period_s", KEY_NUMBER, AT(clock.sync_period_s), "15", 2, 3600, NULL, "flooding: between rounds, each of two messages a mote"},
    {"tracker.name", KEY_WORD, AT(tracker.name), "diffusion", 0, 0, "diffusion|luo|range|pftl|msl|centroid|cv_ukf|cv_ekf|gas|gas_small|gas_ekf|gas_ukf|acoustic|dm|ml", "which tracker the head runs"},
    {"tracker.diffusion_m2ps", KEY_NUMBER, AT(tracker.diffusion_m2ps), "1", 1e-4, 1e3, NULL, "diffusion, luo: assumed diffusion coefficient"},
    {"tracker.chi", KEY_NUMBER, AT(tracker.chi), "0.2", 0, 1000, NULL, "diffusion, luo: significant increment of concentration, g/m2"},
    {"tracker.release_gps", KEY_NUMBER, AT(tracker.release_gps), "100", 1e-3, 1e5, NULL, "diffusion: expected release rate"},
    {"tracker.additive_sd", KEY_NUMBER, AT(tracker.additive_sd), "0.05", 1e-3, 1000, NULL, "diffusion: assumed noise of a reading, g/m2"},
    {"tracker.relative_sd", KEY_NUMBER, AT(tracker.relative_sd), "0.05", 0, 1, NULL, "diffusion: assumed noise as a share of the reading"},
    {"tracker.forgetting", KEY_NUMBER, AT(tracker.forgetting), "0.97", 0.5, 0.9999, NULL, "luo: b of the Sage-Husa weight"},
    {"tracker.nonlinear", KEY_SWITCH, AT(tracker.nonlinear), "false", 0, 0, NULL, "luo: solve Eq. (9) from the answer of (10)"},
    {"tracker.range_sd_m", KEY_NUMBER, AT(tracker.range_sd_m), "0", 0, 100, NULL, "range, pftl, cv_ukf, cv_ekf: assumed noise of a range (of fixed clusters their own is); 0 for sensor.range_noise_m, or 0.3 in a replay"},
    {"tracker.acceleration_sd_mps2", KEY_NUMBER, AT(tracker.acceleration_sd_mps2), "0", 0, 1e3, NULL, "range: assumed acceleration of the target; 0 for that of its Gauss-Markov walk, or 1 where there is none"},
    {"tracker.height_m", KEY_NUMBER, AT(tracker.height_m), "1", -1e4, 1e4, NULL, "range, cv_ukf, cv_ekf: of the target in the nodes' frame, in a replay"},
    {"tracker.bias_sd_m", KEY_NUMBER, AT(tracker.bias_sd_m), "0", 0, 100, NULL, "range: learn each anchor's bias, expected within this; 0 for none"},
    {"tracker.scale_sd", KEY_NUMBER, AT(tracker.scale_sd), "0", 0, 0.5, NULL, "range: learn the scale of all ranges, expected within this share of 1"},
    {"tracker.speed_mps", KEY_NUMBER, AT(tracker.speed_mps), "0", 0, 1000, NULL, "pftl, msl, range: expected mean speed of the target; 0 for that of its path, or 1 in a replay"},
    {"tracker.speed_sd_mps", KEY_NUMBER, AT(tracker.speed_sd_mps), "0", 0, 1000, NULL, "pftl, msl: its standard deviation; 0 for that of its Gauss-Markov walk, or a fifth of the speed where there is none"},
    {"tracker.tolerance_m", KEY_NUMBER, AT(tracker.tolerance_m), "5", 0, 1000, NULL, "range, pftl: the sink is told when its own idea of the target is off by more than this"},
    {"tracker.particles", KEY_COUNT, AT(tracker.particles), "50", 1, 200, NULL, "pftl, msl: number of particles"},
    {"tracker.resampling", KEY_CHOICE, AT(tracker.resampling), "prc", 0, 0, "prc|systematic", "pftl: particles of little weight are redrawn (partial rejection control), or all are resampled"},
    {"tracker.literal", KEY_SWITCH, AT(tracker.literal), "false", 0, 0, NULL, "pftl: the region widens until the effective number of particles is large, as published, and not until the best one fits"},
    {"tracker.ukf_alpha", KEY_NUMBER, AT(tracker.ukf_alpha), "1", 0.1, 1, NULL, "cv_ukf, gas_ukf: how far the sigma points stand from the mean, in standard deviations times the root of the number of states"},
    {"tracker.ukf_beta", KEY_NUMBER, AT(tracker.ukf_beta), "0", 0, 10, NULL, "gas_ukf: weight of the middle point in the covariance; 2 for what is nearly Gaussian"},
    {"tracker.mixing_m", KEY_NUMBER, AT(tracker.mixing_m), "0.3", 1e-3, 1e3, NULL, "gas with winds: mixing length of the air, its turbulent diffusion coefficient over the measured wind's speed"},
    {"tracker.wind_sd_rad", KEY_NUMBER, AT(tracker.wind_sd_rad), "0.2", 0, 1, NULL, "gas with winds: standard deviation of the plume's axis about the measured wind"},
    {"tracker.background_quantile", KEY_NUMBER, AT(tracker.background_quantile), "0.2", 0.01, 0.5, NULL, "gas with winds: share of a sensor's readings below its background, ..."},
    {"tracker.background_ppmph", KEY_NUMBER, AT(tracker.background_ppmph), "1.8", 1e-6, 1e6, NULL, "... which falls at most this fast, less that share, and rises by that share of it, ppm/h"},
    {"tracker.learn_s", KEY_NUMBER, AT(tracker.learn_s), "3600", 0, 1e6, NULL, "gas with winds: at first only backgrounds are learned"},
    {"tracker.memory_s", KEY_NUMBER, AT(tracker.memory_s), "14400", 0, 1e6, NULL, "gas with winds: readings are forgotten with this time constant; 0: never"},
    {"tracker.correlation_s", KEY_NUMBER, AT(tracker.correlation_s), "600", 0, 1e6, NULL, "gas with winds: for so long the plume model errs alike"},
    {"tracker.place_sd_m", KEY_NUMBER, AT(tracker.place_sd_m), "3", 0.01, 1000, NULL, "gas with winds: the leak is off its candidate by this much (standard deviation)"},
    {"tracker.window_s", KEY_NUMBER, AT(tracker.window_s), "0", 0, 3600, NULL, "reports are waited for this long after their sample; 0 for half the interval"},
    {"tracker.prior_x_m", KEY_NUMBER, AT(tracker.prior_x_m), "0", -1e5, 1e5, NULL, "gas: the source is expected about here; with prior_y_m both 0 for the middle of the field"},
    {"tracker.prior_y_m", KEY_NUMBER, AT(tracker.prior_y_m), "0", -1e5, 1e5, NULL, ""},
    {"tracker.prior_sd_x_m", KEY_NUMBER, AT(tracker.prior_sd_x_m), "0", 0, 1e5, NULL, "gas: within this (standard deviation); 0 for 0.3 of the field's width"},
    {"tracker.prior_sd_y_m", KEY_NUMBER, AT(tracker.prior_sd_y_m), "0", 0, 1e5, NULL, "gas: likewise; 0 for 0.3 of its height"},
    {"tracker.prior_rate_mlps", KEY_NUMBER, AT(tracker.prior_rate_mlps), "50", 1e-6, 1e9, NULL, "gas: expected rate of release ..."},
    {"tracker.prior_rate_sd_mlps", KEY_NUMBER, AT(tracker.prior_rate_sd_mlps), "30", 1e-6, 1e9, NULL, "... within this"},
    {"tracker.wind_scale", KEY_NUMBER, AT(tracker.wind_scale), "1", 0, 100, NULL, "gas: speed of the wind as the tracker has it, as a multiple of what it is"},
    {"tracker.wind_off_rad", KEY_NUMBER, AT(tracker.wind_off_rad), "0", -3.2, 3.2, NULL, "gas: direction of the wind as the tracker has it, less what it is"},
    {"tracker.noise_ppm", KEY_NUMBER, AT(tracker.noise_ppm), "0", 0, 1e6, NULL, "gas: assumed noise of a sample; 0 for sensor.noise_ppm"},
    {"tracker.calm_step_m", KEY_NUMBER, AT(tracker.calm_step_m), "5", 0.001, 1e5, NULL, "gas: an estimate is calm that has moved less than this, ..."},
    {"tracker.calm_sd_m", KEY_NUMBER, AT(tracker.calm_sd_m), "10", 0.001, 1e5, NULL, "... gas, gas_small: and has a smaller standard deviation than this, of x and y together"},
    {"tracker.intervals", KEY_COUNT, AT(tracker.intervals), "0", 0, 255, NULL, "dm: of the table of distances; 0 for the distance itself"},
    {"tracker.variant", KEY_CHOICE, AT(tracker.variant), "uniform", 0, 0, "cases|uniform|joint", "dm: of three circles a point by cases, as published, by one rule for all, or by the least triangle"},
    {"tracker.separation", KEY_CHOICE, AT(tracker.separation), "joint", 0, 0, "none|decomposition|joint", "acoustic, dm, ml: targets heard together are located as if each were alone, from each one's share by predicted distances, or together (acoustic; dm, ml: decomposition)"},
    {"tracker.share_range_m", KEY_NUMBER, AT(tracker.share_range_m), "0", 0, 1e4, NULL, "decomposition: targets farther from a node have no share; 0 for 3 sensor.range_m; as published sensor.range_m"},
    {"tracker.strongest", KEY_COUNT, AT(tracker.strongest), "0", 0, 255, NULL, "acoustic, dm, ml: nodes that a position is made from, the strongest; 0 for all (dm takes three)"},
    {"tracker.filtered", KEY_SWITCH, AT(tracker.filtered), "true", 0, 0, NULL, "acoustic, dm, ml: Kalman filter of constant velocity; false: each position for itself, velocities from the last two"},
    {"tracker.groups", KEY_CHOICE, AT(tracker.groups), "none", 0, 0, "none|members|weights", "acoustic: targets that come near each other go on as a group: not, by all its members, or by the centroid of energies"},
    {"energy.profile", KEY_WORD, AT(energy.profile), "mica2", 0, 0, "mica2|micaz|none", "whose currents are charged; none: energy is not accounted for"},
    {"energy.cpu", KEY_CHOICE, AT(energy.cpu), "measured", 0, 0, "measured|assumed", "what work costs the processor: measured on an ATmega128, or as published comparisons take it"},
    {"energy.battery_j", KEY_NUMBER, AT(energy.battery_j), "0", 0, 1e6, NULL, "of each mote, which dies when it is used up; 0: all are on mains"},
    {"energy.sink_mains", KEY_SWITCH, AT(energy.sink_mains), "true", 0, 0, NULL, "the sink has no battery, and its energy is left out of the totals"},
    {"metrics.skip_first", KEY_COUNT, AT(metrics.skip_first), "3", 0, 1e6, NULL, "estimates of each target left out of the errors; of localisation_error_rs and sink_error_rs, samples"},
    {"metrics.lost_m", KEY_NUMBER, AT(metrics.lost_m), "5", 1e-6, 1e6, NULL, "a track is lost when its error is larger than this ..."},
    {"metrics.lost_samples", KEY_COUNT, AT(metrics.lost_samples), "5", 1, 1e6, NULL, "... in so many successive estimates"},
    {"metrics.mote_interval_s", KEY_NUMBER, AT(metrics.mote_interval_s), "10", 0, 1e6, NULL, "between the states of the motes that a log or bus is told; 0: never"},
    {"metrics.clock_settle_s", KEY_NUMBER, AT(metrics.clock_settle_s), "300", 0, 1e6, NULL, "errors of clocks count from then on"},
    {"sweep.key", KEY_TEXT, AT(sweep.key), "", 0, 100, NULL, "what `motehound run --sweep` varies"},
    {"sweep.values", KEY_LIST, AT(sweep.values), "", 0, 1000, NULL, "the values it takes"},
};
/* clang-format on */

const size_t scenario_key_count = sizeof scenario_keys / sizeof scenario_keys[0];

const struct scenario_key *scenario_key_find(const char *path)
{
    for (size_t i = 0; i < scenario_key_count; i++) {
        if (strcmp(scenario_keys[i].path, path) == 0) {
            return &scenario_keys[i];
        }
    }
    return NULL;
}

const char *scenario_key_expectation(const struct scenario_key *key, char *text, size_t size)
{
    switch (key->type) {
    case KEY_NUMBER:
        snprintf(text, size, "a number %g to %g", key->minimum, key->maximum);
        break;
    case KEY_COUNT:
        snprintf(text, size, "a whole number %.0f to %.0f", key->minimum, key->maximum);
        break;
    case KEY_SWITCH:
        snprintf(text, size, "true or false");
        break;
    case KEY_CHOICE:
    case KEY_WORD:
        snprintf(text, size, strchr(key->choices, '|') != NULL ? "one of %s" : "%s", key->choices);
        for (char *bar = strchr(text, '|'); bar != NULL; bar = strchr(bar, '|')) {
            *bar = '/';
        }
        break;
    case KEY_TEXT:
        snprintf(text, size, "UTF-8 text of at most %.0f bytes", key->maximum);
        break;
    case KEY_POINTS:
        snprintf(text, size, "%.0f to %.0f points `x,y[,speed factor]; ...`", key->minimum, key->maximum);
        break;
    case KEY_TARGETS:
        snprintf(text, size, "at most %.0f targets `start_s,speed_mps,loudness: x,y[,speed factor]; ... | ...`",
                 key->maximum);
        break;
    case KEY_NUMBERS:
        snprintf(text, size, "1 to %d numbers %g to %g `a, b, ...`", SCENARIO_NUMBERS_MAX, key->minimum, key->maximum);
        break;
    case KEY_LIST:
        snprintf(text, size, "at most %.0f values in UTF-8 `a, b, ...`", key->maximum);
        break;
    }
    return text;
}

/* Edit distance (Levenshtein); paths are at most 63 bytes long, longer ones are cut. */
static size_t distance(const char *a, const char *b)
{
    enum { LONGEST = 63 };
    size_t row[LONGEST + 1];
    const size_t a_length = strnlen(a, LONGEST), b_length = strnlen(b, LONGEST);
    for (size_t j = 0; j <= b_length; j++) {
        row[j] = j;
    }
    for (size_t i = 1; i <= a_length; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            const size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            const size_t shifted = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = replaced < shifted ? replaced : shifted;
        }
    }
    return row[b_length];
}

int scenario_key_unknown(const char *place, const char *path, char *error, size_t error_size)
{
    const struct scenario_key *nearest = &scenario_keys[0];
    for (size_t i = 1; i < scenario_key_count; i++) {
        if (distance(path, scenario_keys[i].path) < distance(path, nearest->path)) {
            nearest = &scenario_keys[i];
        }
    }
    return fail(error, error_size, "%s%.60s: unknown key, expected one of `motehound list --keys`; the nearest is %s",
                place, path, nearest->path);
}

/* Index of `word` among the words of `choices`, or -1. */
static int choice_of(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    int index = 0;
    for (const char *c = choices; c != NULL; index++) {
        const char *end = strchr(c, '|');
        if ((end != NULL ? (size_t)(end - c) : strlen(c)) == length && strncmp(c, word, length) == 0) {
            return index;
        }
        c = end != NULL ? end + 1 : NULL;
    }
    return -1;
}

static void free_list(char **values, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        free(values[i]);
    }
    free(values);
}

/* `text` cut at each `separator` into pieces without spaces around them. Returns the number of pieces; -1: no memory.
 */
static int split(const char *text, char separator, char ***pieces)
{
    size_t count = 1;
    for (const char *c = text; *c != '\0'; c++) {
        count += *c == separator;
    }
    *pieces = calloc(count, sizeof **pieces);
    if (*pieces == NULL) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        const char separators[] = {separator, '\0'};
        const size_t length = strcspn(text, separators);
        const size_t before = strspn(text, " \t") < length ? strspn(text, " \t") : length;
        size_t kept = length - before;
        while (kept > 0 && strchr(" \t", text[before + kept - 1]) != NULL) {
            kept--;
        }
        (*pieces)[i] = strndup(text + before, kept);
        if ((*pieces)[i] == NULL) {
            free_list(*pieces, (unsigned)i);
            return -1;
        }
        text += length + 1;
    }
    return (int)count;
}

const struct member_range point_members[POINT_MEMBERS] = {
    {"x_m", -1e6, 1e6}, {"y_m", -1e6, 1e6}, {"speed_factor", 1e-3, 1e3}};
const struct member_range target_members[TARGET_MEMBERS] = {
    {"start_s", 0, 1e6}, {"speed_mps", 0.01, 100}, {"loudness", 1e-3, 1e3}};

/* The number of a member of a list. */
static bool read_member(const char *text, const struct member_range *range, double *number)
{
    return text_number(text, strlen(text), number) && *number >= range->minimum && *number <= range->maximum;
}

/* "x,y[,factor]; ..." -> points, which the caller frees. Returns how many; -1 on anything else. */
static int read_points(const char *text, double most, struct waypoint **points)
{
    char **pieces;
    const int count = split(text, ';', &pieces);
    if (count < 0) {
        return -1;
    }
    *points = calloc((size_t)count, sizeof **points);
    bool sound = *points != NULL && count <= most;
    for (int i = 0; i < count && sound; i++) {
        char **numbers;
        const int numbers_count = split(pieces[i], ',', &numbers);
        double number[POINT_MEMBERS] = {0, 0, 1};
        sound = numbers_count == 2 || numbers_count == POINT_MEMBERS;
        for (int j = 0; j < numbers_count && sound; j++) {
            sound = read_member(numbers[j], &point_members[j], &number[j]);
        }
        (*points)[i] = (struct waypoint){number[0], number[1], number[2]};
        if (numbers_count > 0) {
            free_list(numbers, (unsigned)numbers_count);
        }
    }
    free_list(pieces, (unsigned)count);
    if (!sound) {
        free(*points);
    }
    return sound ? count : -1;
}

static bool set_points(struct scenario *scenario, const struct scenario_key *key, const char *value)
{
    struct waypoint *points;
    const int count = read_points(value, key->maximum, &points);
    if (count < 0) {
        return false;
    }
    free(scenario->source.points);
    scenario->source.points = points;
    scenario->source.points_count = (unsigned)count;
    return true;
}

static void free_targets(struct scripted_target *targets, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        free(targets[i].points);
    }
    free(targets);
}

/* "start_s,speed_mps,loudness: points". The points are the caller's to free. */
static bool read_target(const char *text, struct scripted_target *target)
{
    enum { POINTS_MAX = 1000 };
    const char *colon = strchr(text, ':');
    char *head = colon != NULL ? strndup(text, (size_t)(colon - text)) : NULL;
    char **numbers;
    const int numbers_count = head != NULL ? split(head, ',', &numbers) : -1;
    double number[TARGET_MEMBERS] = {0};
    bool sound = numbers_count == TARGET_MEMBERS;
    for (int i = 0; i < numbers_count && sound; i++) {
        sound = read_member(numbers[i], &target_members[i], &number[i]);
    }
    if (numbers_count > 0) {
        free_list(numbers, (unsigned)numbers_count);
    }
    free(head);
    *target = (struct scripted_target){.start_s = number[0], .speed_mps = number[1], .loudness = number[2]};
    const int count = sound ? read_points(colon + 1, POINTS_MAX, &target->points) : -1;
    target->points_count = count < 0 ? 0 : (unsigned)count;
    return count >= 0;
}

static bool set_targets(struct scenario *scenario, const struct scenario_key *key, const char *value)
{
    char **pieces = NULL;
    const int count = *value == '\0' ? 0 : split(value, '|', &pieces);
    struct scripted_target *targets = count > 0 ? calloc((size_t)count, sizeof *targets) : NULL;
    bool sound = count >= 0 && count <= key->maximum && (count == 0 || targets != NULL);
    unsigned made = 0;
    for (int i = 0; i < count && sound; i++) {
        sound = read_target(pieces[i], &targets[i]);
        made += sound;
    }
    if (count > 0) {
        free_list(pieces, (unsigned)count);
    }
    if (!sound) {
        free_targets(targets, made);
        return false;
    }
    free_targets(scenario->targets, scenario->targets_count);
    scenario->targets = targets;
    scenario->targets_count = made;
    return true;
}

/* As scenario.json will want it. */
static bool is_utf8(const char *text)
{
    json_t *string = json_string(text);
    json_decref(string);
    return string != NULL;
}

static bool set_list(struct scenario *scenario, const struct scenario_key *key, const char *value)
{
    char **values = NULL;
    const int count = *value == '\0' ? 0 : split(value, ',', &values);
    if (count < 0 || !is_utf8(value) || count > key->maximum) {
        if (count > 0) {
            free_list(values, (unsigned)count);
        }
        return false;
    }
    free_list(scenario->sweep.values, scenario->sweep.values_count);
    scenario->sweep.values = values;
    scenario->sweep.values_count = (unsigned)count;
    return true;
}

static bool set_numbers(struct number_list *member, const struct scenario_key *key, const char *value)
{
    struct number_list list = {.count = 0};
    char **pieces;
    const int count = split(value, ',', &pieces);
    if (count < 0) {
        return false;
    }
    bool sound = count <= SCENARIO_NUMBERS_MAX;
    for (int i = 0; i < count && sound; i++) {
        sound = text_number(pieces[i], strlen(pieces[i]), &list.values[i]) && list.values[i] >= key->minimum &&
                list.values[i] <= key->maximum;
        list.count++;
    }
    free_list(pieces, (unsigned)count);
    if (sound) {
        *member = list;
    }
    return sound;
}

static bool set_text(char **member, const char *value)
{
    char *copy = strdup(value);
    if (copy == NULL) {
        return false;
    }
    free(*member);
    *member = copy;
    return true;
}

/* False if `value` is not what the key expects. */
static bool set(struct scenario *scenario, const struct scenario_key *key, const char *value)
{
    void *member = (char *)scenario + key->offset;
    double number = 0;
    switch (key->type) {
    case KEY_NUMBER:
    case KEY_COUNT:
        if (!text_number(value, strlen(value), &number) || number < key->minimum || number > key->maximum) {
            return false;
        }
        if (key->type == KEY_NUMBER) {
            *(double *)member = number;
            return true;
        }
        *(int64_t *)member = floor(number) >= number ? (int64_t)number : *(int64_t *)member;
        return floor(number) >= number;
    case KEY_SWITCH:
        if (strcmp(value, "true") != 0 && strcmp(value, "false") != 0) {
            return false;
        }
        *(bool *)member = value[0] == 't';
        return true;
    case KEY_CHOICE: {
        const int choice = choice_of(key->choices, value);
        if (choice >= 0) {
            memcpy(member, &choice, sizeof choice);
        }
        return choice >= 0;
    }
    case KEY_WORD:
        return choice_of(key->choices, value) >= 0 && set_text(member, value);
    case KEY_TEXT:
        return (double)strlen(value) <= key->maximum && is_utf8(value) && set_text(member, value);
    case KEY_POINTS:
        return set_points(scenario, key, value);
    case KEY_TARGETS:
        return set_targets(scenario, key, value);
    case KEY_NUMBERS:
        return set_numbers(member, key, value);
    case KEY_LIST:
        return set_list(scenario, key, value);
    }
    return false;
}

int scenario_set(struct scenario *scenario, const char *path, const char *value, char *error, size_t error_size)
{
    const struct scenario_key *key = scenario_key_find(path);
    if (key == NULL) {
        return scenario_key_unknown("", path, error, error_size);
    }
    if (!set(scenario, key, value)) {
        char expectation[300];
        return fail(error, error_size, "%s: expected %s, found '%.60s'", path,
                    scenario_key_expectation(key, expectation, sizeof expectation), value);
    }
    return 0;
}

int scenario_init(struct scenario *scenario)
{
    memset(scenario, 0, sizeof *scenario);
    for (size_t i = 0; i < scenario_key_count; i++) {
        if (!set(scenario, &scenario_keys[i], scenario_keys[i].standard)) {
            scenario_free(scenario);
            return -1;
        }
    }
    return 0;
}

void scenario_free(struct scenario *scenario)
{
    for (size_t i = 0; i < scenario_key_count; i++) {
        if (scenario_keys[i].type == KEY_TEXT || scenario_keys[i].type == KEY_WORD) {
            free(*(char **)(void *)((char *)scenario + scenario_keys[i].offset));
        }
    }
    free(scenario->source.points);
    free_targets(scenario->targets, scenario->targets_count);
    free_list(scenario->sweep.values, scenario->sweep.values_count);
    memset(scenario, 0, sizeof *scenario);
}
