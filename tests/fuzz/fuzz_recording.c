/* Recordings: four CSV texts, nodes, readings, truth and candidates, divided by lines with a single '%'. */
#include "fuzz.h"
#include "scenario/recording.h"

#include <math.h>
#include <string.h>

typedef int parser(const char *text, size_t length, const char *name, struct recording *recording, char *error,
                   size_t error_size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static parser *const parsers[4] = {recording_parse_nodes, recording_parse_readings, recording_parse_truth,
                                       recording_parse_candidates};
    struct recording recording = {0};
    char error[1000] = "";
    const uint8_t *part = data, *end = data + size;
    for (int i = 0; i < 4; i++) {
        const uint8_t *mark = part < end ? memchr(part, '%', (size_t)(end - part)) : NULL;
        const size_t length = (size_t)((mark != NULL ? mark : end) - part);
        char *text = malloc(length + 1); /* so that a step beyond the text is seen */
        memcpy(text, part, length);
        const int status = parsers[i](text, length, "fuzz.csv", &recording, error, sizeof error);
        free(text);
        if (status != 0) {
            require(error[0] != '\0' && strchr(error, '\n') == NULL); /* an error is one line */
            break;
        }
        part = mark != NULL ? mark + 1 : end;
        part += part < end && *part == '\n';
    }
    for (size_t i = 0; i < recording.reading_count; i++) {
        require(recording.readings[i].node < recording.node_count && isfinite(recording.readings[i].value));
        require(hypot(recording.readings[i].wind_x_mps, recording.readings[i].wind_y_mps) <= 101);
        require(i == 0 || recording.readings[i].time_s >= recording.readings[i - 1].time_s);
    }
    recording_free(&recording);
    return 0;
}
