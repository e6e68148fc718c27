/* An output folder whose files appear whole or not at all.
 *
 * Files are written into a hidden folder and made durable there. Where the output folder does not exist, the hidden one
 * stands beside it, `.NAME.partial-PID`, and is renamed to it. A folder that exists stays what it is, be it a mount
 * point, a link or somebody's current folder: the hidden one, `.motehound.partial-PID`, stands within it and each file
 * is renamed out of it, summary.json last and its predecessor removed first, so that a folder with a summary.json
 * always holds the files of one run. What else is in the folder stays. */
#ifndef MOTEHOUND_SIM_OUTPUT_H
#define MOTEHOUND_SIM_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { OUTPUT_PATH_MAX = 4096 };

struct output {
    char folder[OUTPUT_PATH_MAX];  /* where the files are to appear */
    char partial[OUTPUT_PATH_MAX]; /* where they are being written */
    bool existed;                  /* the folder, before we came */
};

/* Make the hidden folder, and the folders above. Hidden folders of the same output whose process is no more go. Returns 0, or -1 with one line in `error` if `folder` could not be
 * written. */
int output_open(struct output *output, const char *folder, char *error, size_t error_size);

/* A file for writing in it. Returns NULL with one line in `error`. */
FILE *output_create(const struct output *output, const char *name, char *error, size_t error_size);

/* Have what was written to `file` on the disk. Returns 0, or -1 with one line in `error` if any of it is not. */
int output_sync(FILE *file, const char *name, char *error, size_t error_size);

/* Close a file from output_create and have it on the disk. Returns 0, or -1 with one line in `error` if any of it is
 * not. */
int output_finish(FILE *file, const char *name, char *error, size_t error_size);

/* Path of a file in the hidden folder, in `path`, which is returned. */
const char *output_path(const struct output *output, const char *name, char path[OUTPUT_PATH_MAX]);

/* Let the `count` files `names` appear; results of an earlier run that are not among them go. Returns 0, or -1 with one
 * line in `error`; the hidden folder is gone in either case. */
int output_commit(struct output *output, const char *const *names, size_t count, char *error, size_t error_size);

/* Remove the hidden folder and what is in it. */
void output_discard(struct output *output);

#endif
