/* Where scenarios are found by name: $MOTEHOUND_SCENARIOS, then `scenarios` and `../share/motehound/scenarios` beside
 * the program, then the folder of the source tree that the program was built from. */
#ifndef MOTEHOUND_SIM_FOLDER_H
#define MOTEHOUND_SIM_FOLDER_H

#include <stddef.h>

enum { SCENARIO_PATH_MAX = 4096 };

/* The file that `name` stands for: itself if there is such a file, else NAME.yaml in the folders. Returns 0, or -1 with
 * one line in `error`. */
int scenario_find(const char *name, char path[SCENARIO_PATH_MAX], char *error, size_t error_size);

/* Call `each` with the path of every scenario that can be found by name, in alphabetical order, each name once. Returns
 * the number of them. */
size_t scenario_list(void (*each)(void *context, const char *name, const char *path), void *context);

#endif
