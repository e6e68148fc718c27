/* A recording of a real network, from CSV: nodes (`node,x_m,y_m[,z_m][,cluster[,period_s][,noise_m2]]`), readings
 * (`time_s,node,value[,target][,bearing_rad][,wind_speed_mps,wind_toward_rad]`) and, optionally, the truth
 * (`time_s,x_m,y_m[,target][,rate_mlps]`) and the places where a leak can be (`place,x_m,y_m`).
 *
 * The wind is what the node measures beside the value: its speed and where it blows to, counter-clockwise from the x axis; one column needs the other.
 *
 * The first line names the columns, in any order. Errors are one line: file, line, column and what was expected.
 * Refused are NaN and infinity, numbers outside their range, an unknown or a duplicate node, time going backwards, a
 * missing or an unknown column, fewer than four nodes, a place twice, a file without rows. Lines may end in LF or CRLF; empty lines
 * are skipped. */
#ifndef MOTEHOUND_SIM_RECORDING_H
#define MOTEHOUND_SIM_RECORDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct recorded_node {
    uint32_t id;          /* below 2^32 - 1 */
    double x_m, y_m, z_m; /* each within +- 1e6 */
};

/* Of which fixed cluster a node is. */
struct recorded_member {
    uint32_t cluster; /* from 1 to MH_FUSED_MAX */
    double period_s;  /* between its samples; 0 without the column */
    double noise_m2;  /* variance of its ranges; 0 without the column */
    size_t line;      /* of the file */
};

struct recorded_reading {
    double time_s;
    size_t node;                   /* index into nodes */
    double value;                  /* -2047.99 to 2047.99: what a mote's Q11.20 holds */
    double bearing_rad;            /* 0 without the column */
    double wind_x_mps, wind_y_mps; /* where it blows to; 0 without the columns */
    uint8_t target;                /* 0 without the column */
};

struct recorded_truth {
    double time_s, x_m, y_m;
    double rate_mlps; /* of release; 0 without the column */
    uint8_t target;
};

struct recorded_place {
    uint32_t id;
    double x_m, y_m;
};

/* In the order of the files, so by time. */
struct recording {
    struct recorded_node *nodes;
    struct recorded_member *members; /* of each node; NULL without the column `cluster` */
    size_t node_count;
    struct recorded_reading *readings;
    size_t reading_count;
    struct recorded_truth *truths; /* NULL and 0 without a truth file */
    size_t truth_count;
    struct recorded_place *candidates; /* where the leak can be; NULL and 0 without such a file */
    size_t candidate_count;
    bool has_wind;
    double interval_s; /* median spacing of the readings of one node and target, rounded to 1 ms */
};

/* Each fills its part of `recording`, which begins as all zero bytes, from a file's text in memory; nodes first. `name`
 * stands for the file in errors. Cost: O(n log nodes). Returns 0, or -1 with one line in `error`. */
int recording_parse_nodes(const char *text, size_t length, const char *name, struct recording *recording, char *error,
                          size_t error_size);
int recording_parse_readings(const char *text, size_t length, const char *name, struct recording *recording,
                             char *error, size_t error_size);
int recording_parse_truth(const char *text, size_t length, const char *name, struct recording *recording, char *error,
                          size_t error_size);
int recording_parse_candidates(const char *text, size_t length, const char *name, struct recording *recording,
                               char *error, size_t error_size);

/* The first three from files; `truth_path` may be NULL. Returns 0, or -1 with one line in `error` and nothing to free. */
int recording_load(const char *nodes_path, const char *readings_path, const char *truth_path,
                   struct recording *recording, char *error, size_t error_size);

/* The places from a file, added to a recording that was loaded. Returns 0, or -1 with one line in `error`; the recording is still to be freed. */
int recording_load_candidates(const char *path, struct recording *recording, char *error, size_t error_size);

/* Only nodes.csv, as network.file wants it. */
int recording_load_nodes(const char *nodes_path, struct recording *recording, char *error, size_t error_size);

/* Trackers follow one target: readings, and truth, are of one target each. Returns 0, or -1 with one line in `error`;
 * the names stand for the files. */
int recording_check_targets(const struct recording *recording, const char *readings_name, const char *truth_name,
                            char *error, size_t error_size);

void recording_free(struct recording *recording);

#endif
