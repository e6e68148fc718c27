#include "scenario/folder.h"

#include "scenario/text.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FOLDERS = 4, NAMES_MAX = 1000, NAME_SIZE = 200 };

/* The folder's path in `path`; false if there is no such folder. */
static bool folder(size_t index, char path[SCENARIO_PATH_MAX])
{
    char program[2048];
    ssize_t length = 0;
    path[0] = '\0';
    if (index == 0 && getenv("MOTEHOUND_SCENARIOS") != NULL) {
        snprintf(path, SCENARIO_PATH_MAX, "%s", getenv("MOTEHOUND_SCENARIOS"));
    } else if ((index == 1 || index == 2) && (length = readlink("/proc/self/exe", program, sizeof program - 1)) > 0) {
        program[length] = '\0';
        *strrchr(program, '/') = '\0';
        snprintf(path, SCENARIO_PATH_MAX, "%s/%s", program, index == 1 ? "scenarios" : "../share/motehound/scenarios");
    } else if (index == 3) {
        snprintf(path, SCENARIO_PATH_MAX, "%s", MOTEHOUND_SCENARIO_FOLDER);
    }
    struct stat status;
    return path[0] != '\0' && stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

int scenario_find(const char *name, char path[SCENARIO_PATH_MAX], char *error, size_t error_size)
{
    if (strlen(name) < SCENARIO_PATH_MAX && access(name, F_OK) == 0) {
        struct stat status;
        if (strchr(name, '/') != NULL || stat(name, &status) != 0 || !S_ISDIR(status.st_mode)) {
            snprintf(path, SCENARIO_PATH_MAX, "%s", name);
            return 0;
        }
    }
    for (size_t i = 0; i < FOLDERS && strchr(name, '/') == NULL; i++) {
        char within[SCENARIO_PATH_MAX];
        if (folder(i, within) &&
            (size_t)snprintf(path, SCENARIO_PATH_MAX, "%s/%s.yaml", within, name) < SCENARIO_PATH_MAX &&
            access(path, F_OK) == 0) {
            return 0;
        }
    }
    return fail(error, error_size, "%.200s: expected a scenario's file or a name of `motehound list`, found neither",
                name);
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

size_t scenario_list(void (*each)(void *context, const char *name, const char *path), void *context)
{
    char(*names)[NAME_SIZE] = calloc(NAMES_MAX, NAME_SIZE);
    size_t count = 0;
    for (size_t i = 0; i < FOLDERS && names != NULL; i++) {
        char within[SCENARIO_PATH_MAX];
        DIR *entries = folder(i, within) ? opendir(within) : NULL;
        for (const struct dirent *entry; entries != NULL && (entry = readdir(entries)) != NULL && count < NAMES_MAX;) {
            const char *dot = strrchr(entry->d_name, '.');
            if (dot != NULL && strcmp(dot, ".yaml") == 0 && dot - entry->d_name < NAME_SIZE) {
                snprintf(names[count++], NAME_SIZE, "%.*s", (int)(dot - entry->d_name), entry->d_name);
            }
        }
        if (entries != NULL) {
            closedir(entries);
        }
    }
    if (names == NULL) {
        return 0;
    }
    qsort(names, count, NAME_SIZE, by_name);
    size_t different = 0;
    for (size_t i = 0; i < count; i++) {
        char path[SCENARIO_PATH_MAX], error[300];
        if ((i == 0 || strcmp(names[i], names[i - 1]) != 0) &&
            scenario_find(names[i], path, error, sizeof error) == 0) {
            each(context, names[i], path);
            different++;
        }
    }
    free(names);
    return different;
}
