#include "record/output.h"

#include "scenario/text.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Every file that a run may leave; summary.json, which says that the others are whole, last. */
static const char *const result_files[] = {"runs.csv",  "track.csv",     "local.csv",  "watch.csv",   "truth.csv",
                                           "nodes.csv", "scenario.json", "events.lcm", "summary.json"};
enum { RESULT_FILES = sizeof result_files / sizeof result_files[0] };

/* Path of an output folder, with room for the names within. */
enum { LONGEST = OUTPUT_PATH_MAX - 600 };

static int sync_folder(const char *path)
{
    const int folder = open(path, O_RDONLY | O_DIRECTORY);
    if (folder < 0) {
        return -1;
    }
    const int status = fsync(folder);
    close(folder);
    return status;
}

/* The folders above the last name of `path`, made where they are missing. */
static int make_parents(const char *path)
{
    char parent[OUTPUT_PATH_MAX];
    snprintf(parent, sizeof parent, "%s", path);
    for (char *slash = strchr(parent + 1, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(parent, 0777) != 0 && errno != EEXIST) {
            return -1;
        }
        *slash = '/';
    }
    return 0;
}

static int cannot_write(const char *folder, int reason, char *error, size_t error_size)
{
    return fail(error, error_size, "%s: cannot write into this folder: %s", folder, strerror(reason));
}

/* Of the folder at `path` everything, if that is files. */
static void remove_folder(const char *path)
{
    DIR *folder = opendir(path);
    if (folder == NULL) {
        return;
    }
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        char file[OUTPUT_PATH_MAX];
        snprintf(file, sizeof file, "%.3800s/%.200s", path, entry->d_name);
        unlink(file);
    }
    closedir(folder);
    rmdir(path);
}

/* What processes that were killed have left of the same output. */
static void remove_abandoned(const struct output *output)
{
    char path[OUTPUT_PATH_MAX];
    snprintf(path, sizeof path, "%s", output->partial);
    char *slash = strrchr(path, '/'), *name = slash != NULL ? slash + 1 : path;
    const size_t stem = (size_t)(strrchr(name, '-') + 1 - name);
    char wanted[256];
    snprintf(wanted, sizeof wanted, "%.*s", (int)stem, name);
    *name = '\0';
    DIR *folder = opendir(slash != NULL ? path : ".");
    if (folder == NULL) {
        return;
    }
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        char *end = NULL;
        const long process = strncmp(entry->d_name, wanted, stem) == 0 ? strtol(entry->d_name + stem, &end, 10) : 0;
        const bool gone = process > 0 && *end == '\0' && kill((pid_t)process, 0) != 0 && errno == ESRCH;
        if (gone) {
            char abandoned[OUTPUT_PATH_MAX];
            snprintf(abandoned, sizeof abandoned, "%.3800s%.200s", path, entry->d_name);
            remove_folder(abandoned);
        }
    }
    closedir(folder);
}

int output_open(struct output *output, const char *folder, char *error, size_t error_size)
{
    size_t length = strlen(folder);
    while (length > 1 && folder[length - 1] == '/') {
        length--;
    }
    if (length == 0 || length > LONGEST) {
        return fail(error, error_size, "--out: expected a folder's path of 1 to %d bytes, found %zu", LONGEST, length);
    }
    snprintf(output->folder, sizeof output->folder, "%.*s", (int)length, folder);
    struct stat status;
    output->existed = stat(output->folder, &status) == 0;
    if (output->existed ? !S_ISDIR(status.st_mode) : lstat(output->folder, &status) == 0) {
        /* a file, or a link that leads nowhere */
        return cannot_write(output->folder, output->existed ? ENOTDIR : ENOENT, error, error_size);
    }
    const char *slash = strrchr(output->folder, '/');
    const int parent = slash != NULL ? (int)(slash - output->folder) + 1 : 0;
    if (output->existed) {
        snprintf(output->partial, sizeof output->partial, "%.*s/.motehound.partial-%ld", (int)length, folder,
                 (long)getpid());
    } else {
        snprintf(output->partial, sizeof output->partial, "%.*s.%.200s.partial-%ld", parent, output->folder,
                 output->folder + parent, (long)getpid());
    }
    output_discard(output); /* of a process that died and had our number */
    remove_abandoned(output);
    if (make_parents(output->folder) != 0 || mkdir(output->partial, 0777) != 0) {
        return cannot_write(output->folder, errno, error, error_size);
    }
    return 0;
}

const char *output_path(const struct output *output, const char *name, char path[OUTPUT_PATH_MAX])
{
    snprintf(path, OUTPUT_PATH_MAX, "%.3800s/%.200s", output->partial, name);
    return path;
}

FILE *output_create(const struct output *output, const char *name, char *error, size_t error_size)
{
    char path[OUTPUT_PATH_MAX];
    FILE *file = fopen(output_path(output, name, path), "w");
    if (file == NULL) {
        fail(error, error_size, "%s/%s: cannot write: %s", output->folder, name, strerror(errno));
    }
    return file;
}

int output_sync(FILE *file, const char *name, char *error, size_t error_size)
{
    errno = 0;
    const bool sound = fflush(file) == 0 && !ferror(file) && fsync(fileno(file)) == 0;
    return sound ? 0
                 : fail(error, error_size, "%s: cannot write: %s", name, errno != 0 ? strerror(errno) : "output error");
}

int output_finish(FILE *file, const char *name, char *error, size_t error_size)
{
    const int status = output_sync(file, name, error, error_size);
    if (fclose(file) != 0 && status == 0) {
        return fail(error, error_size, "%s: cannot write: %s", name, strerror(errno));
    }
    return status;
}

static bool among(const char *name, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(name, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* Into a folder that exists, file by file. */
static int replace(const struct output *output, const char *const *names, size_t count)
{
    for (size_t pass = 0; pass < RESULT_FILES + 1; pass++) {
        /* first the old summary goes, then file by file, the new summary last */
        const char *name = pass == 0 ? result_files[RESULT_FILES - 1] : result_files[pass - 1];
        char to[OUTPUT_PATH_MAX], from[OUTPUT_PATH_MAX];
        snprintf(to, sizeof to, "%.3800s/%s", output->folder, name);
        if (pass > 0 && among(name, names, count)) {
            if (rename(output_path(output, name, from), to) != 0) {
                return -1;
            }
        } else if (unlink(to) != 0 && errno != ENOENT) {
            return -1;
        }
    }
    return sync_folder(output->folder);
}

int output_commit(struct output *output, const char *const *names, size_t count, char *error, size_t error_size)
{
    int status = sync_folder(output->partial);
    if (status == 0 && (output->existed || rename(output->partial, output->folder) != 0)) {
        /* the second: somebody else has made it meanwhile */
        status = output->existed || errno == ENOTEMPTY || errno == EEXIST ? replace(output, names, count) : -1;
    }
    const int reason = errno;
    output_discard(output);
    return status == 0 ? 0 : cannot_write(output->folder, reason, error, error_size);
}

void output_discard(struct output *output) { remove_folder(output->partial); }
