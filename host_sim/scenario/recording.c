#include "scenario/recording.h"

#include "motehound/config.h"
#include "scenario/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES_MIN = 4, COLUMNS_MAX = 8 };

#define WIND_MAX_MPS 100

#define PLACE_MAX_M 1e6
#define VALUE_MAX 2047.99
#define TIME_MAX_S 1e12
#define RATE_MAX_MLPS 1e9

struct column {
    const char *name;
    bool required;
    bool whole;
    double minimum, maximum;
};

/* A CSV text being read. */
struct csv {
    const char *at, *end;
    const char *name;
    size_t line;
    const struct column *columns;
    size_t column_count;
    int field_column[COLUMNS_MAX]; /* which column each field of a line is */
    size_t field_count;
    bool present[COLUMNS_MAX];  /* the file has the column */
    double values[COLUMNS_MAX]; /* of the line read last, by column; 0 where the file has no such column */
    char *error;
    size_t error_size;
};

/* Length of the line at csv->at without its end. */
static size_t line_length(const struct csv *csv)
{
    const char *newline = memchr(csv->at, '\n', (size_t)(csv->end - csv->at));
    size_t length = (size_t)((newline != NULL ? newline : csv->end) - csv->at);
    if (newline != NULL && length > 0 && csv->at[length - 1] == '\r') {
        length--;
    }
    return length;
}

static void next_line(struct csv *csv)
{
    const char *newline = memchr(csv->at, '\n', (size_t)(csv->end - csv->at));
    csv->at = newline != NULL ? newline + 1 : csv->end;
    csv->line++;
}

static void skip_empty(struct csv *csv)
{
    while (csv->at < csv->end && line_length(csv) == 0) {
        next_line(csv);
    }
}

static int expected_columns(struct csv *csv, const char *what, int length, const char *found)
{
    char list[200] = "";
    for (size_t i = 0; i < csv->column_count; i++) {
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, csv->columns[i].required ? "%s%s" : "%s[%s]", i > 0 ? "," : "",
                 csv->columns[i].name);
    }
    return fail(csv->error, csv->error_size, "%s:%zu: expected the columns %s, found %s '%.*s'", csv->name, csv->line,
                list, what, length, found);
}

static int open_csv(struct csv *csv)
{
    static const char byte_order_mark[] = "\xEF\xBB\xBF";
    csv->line = 1;
    if (csv->end - csv->at >= 3 && memcmp(csv->at, byte_order_mark, 3) == 0) {
        csv->at += 3;
    }
    skip_empty(csv);
    const char *field = csv->at;
    const char *line_end = csv->at + line_length(csv);
    bool *seen = csv->present;
    for (bool more = csv->at < csv->end; more; csv->field_count++) {
        const char *comma = memchr(field, ',', (size_t)(line_end - field));
        const size_t length = (size_t)((comma != NULL ? comma : line_end) - field);
        size_t column = 0;
        while (column < csv->column_count &&
               (strlen(csv->columns[column].name) != length || memcmp(csv->columns[column].name, field, length) != 0)) {
            column++;
        }
        const int shown = length < 40 ? (int)length : 40;
        if (column == csv->column_count) {
            return expected_columns(csv, "an unknown column", shown, field);
        }
        if (seen[column]) {
            return expected_columns(csv, "twice", shown, field);
        }
        seen[column] = true;
        csv->field_column[csv->field_count] = (int)column;
        more = comma != NULL;
        field = comma != NULL ? comma + 1 : line_end;
    }
    for (size_t i = 0; i < csv->column_count; i++) {
        if (csv->columns[i].required && !seen[i]) {
            return expected_columns(csv, "no", (int)strlen(csv->columns[i].name), csv->columns[i].name);
        }
    }
    next_line(csv);
    return 0;
}

static int refuse(const struct csv *csv, const struct column *column, const char *found, size_t length)
{
    return fail(csv->error, csv->error_size, "%s:%zu: %s: expected a %s %.12g to %.12g, found '%.*s'", csv->name,
                csv->line, column->name, column->whole ? "whole number" : "number", column->minimum, column->maximum,
                length < 40 ? (int)length : 40, found);
}

/* The next line's values. Returns 1, 0 at the end, or -1 with one line in csv->error. The line read stays csv->line
 * until the next call. */
static int read_row(struct csv *csv, bool first)
{
    if (!first) {
        next_line(csv);
    }
    skip_empty(csv);
    if (csv->at >= csv->end) {
        return 0;
    }
    const char *field = csv->at;
    const char *line_end = csv->at + line_length(csv);
    for (size_t i = 0; i < csv->field_count; i++) {
        const char *comma = memchr(field, ',', (size_t)(line_end - field));
        if ((comma == NULL) != (i + 1 == csv->field_count)) {
            return fail(csv->error, csv->error_size, "%s:%zu: expected %zu fields, found %s", csv->name, csv->line,
                        csv->field_count, comma == NULL ? "fewer" : "more");
        }
        const size_t length = (size_t)((comma != NULL ? comma : line_end) - field);
        const struct column *column = &csv->columns[csv->field_column[i]];
        double value;
        if (!text_number(field, length, &value) || value < column->minimum || value > column->maximum ||
            (column->whole && floor(value) < value)) {
            return refuse(csv, column, field, length);
        }
        csv->values[csv->field_column[i]] = value;
        field += length + 1;
    }
    return 1;
}

/* Room for one more element of `size` bytes in an array that doubles. Returns false if there is no memory. */
static bool grow(void **array, size_t count, size_t size)
{
    if (count < 16 ? count > 0 : (count & (count - 1)) != 0) {
        return true;
    }
    void *larger = realloc(*array, (count < 16 ? 16 : 2 * count) * size);
    if (larger == NULL) {
        return false;
    }
    *array = larger;
    return true;
}

struct indexed {
    uint32_t id;
    size_t index;
};

static int by_id(const void *a, const void *b)
{
    const struct indexed *left = a, *right = b;
    if (left->id != right->id) {
        return left->id < right->id ? -1 : 1;
    }
    return left->index < right->index ? -1 : left->index > right->index;
}

/* The nodes ordered by identifier; to be freed. */
static struct indexed *index_nodes(const struct recording *recording)
{
    struct indexed *index = calloc(recording->node_count + 1, sizeof *index);
    for (size_t i = 0; i < recording->node_count && index != NULL; i++) {
        index[i] = (struct indexed){recording->nodes[i].id, i};
    }
    if (index != NULL) {
        qsort(index, recording->node_count, sizeof *index, by_id);
    }
    return index;
}

static int no_memory(const struct csv *csv) { return fail(csv->error, csv->error_size, "%s: no memory", csv->name); }

static int time_backwards(const struct csv *csv, double before, double found)
{
    return fail(csv->error, csv->error_size,
                "%s:%zu: time_s: expected at least %.12g, the time of the row before, found %.12g", csv->name,
                csv->line, before, found);
}

int recording_parse_nodes(const char *text, size_t length, const char *name, struct recording *recording, char *error,
                          size_t error_size)
{
    static const struct column columns[] = {{"node", true, true, 0, 4294967294.0},
                                            {"x_m", true, false, -PLACE_MAX_M, PLACE_MAX_M},
                                            {"y_m", true, false, -PLACE_MAX_M, PLACE_MAX_M},
                                            {"z_m", false, false, -PLACE_MAX_M, PLACE_MAX_M},
                                            {"cluster", false, true, 1, MH_FUSED_MAX},
                                            {"period_s", false, false, 1e-3, 1e6},
                                            {"noise_m2", false, false, 1e-6, 1e4}};
    struct csv csv = {.at = text,
                      .end = text + length,
                      .name = name,
                      .columns = columns,
                      .column_count = 7,
                      .error = error,
                      .error_size = error_size};
    if (open_csv(&csv) != 0) {
        return -1;
    }
    if (!csv.present[4] && (csv.present[5] || csv.present[6])) {
        return fail(error, error_size, "%s:%zu: expected a column cluster beside period_s and noise_m2, found none",
                    name, csv.line - 1);
    }
    int status = 1;
    for (bool first = true; (status = read_row(&csv, first)) == 1; first = false) {
        if (!grow((void **)&recording->nodes, recording->node_count, sizeof *recording->nodes) ||
            (csv.present[4] &&
             !grow((void **)&recording->members, recording->node_count, sizeof *recording->members))) {
            return no_memory(&csv);
        }
        if (csv.present[4]) {
            recording->members[recording->node_count] =
                (struct recorded_member){(uint32_t)csv.values[4], csv.values[5], csv.values[6], csv.line};
        }
        recording->nodes[recording->node_count++] =
            (struct recorded_node){(uint32_t)csv.values[0], csv.values[1], csv.values[2], csv.values[3]};
    }
    if (status < 0) {
        return -1;
    }
    struct indexed *index = index_nodes(recording);
    if (index == NULL) {
        return no_memory(&csv);
    }
    for (size_t i = 1; i < recording->node_count; i++) {
        if (index[i].id == index[i - 1].id) {
            status = fail(error, error_size, "%s: node: expected each once, found %lu in rows %zu and %zu", name,
                          (unsigned long)index[i].id, index[i - 1].index + 1, index[i].index + 1);
            free(index);
            return status;
        }
    }
    free(index);
    if (recording->node_count < NODES_MIN) {
        return fail(error, error_size, "%s: node: expected at least %d nodes, found %zu", name, NODES_MIN,
                    recording->node_count);
    }
    return 0;
}

static int by_value(const void *a, const void *b)
{
    const double left = *(const double *)a, right = *(const double *)b;
    return left < right ? -1 : left > right;
}

/* One reading of the stream of readings that one node makes of one target. */
struct streamed {
    size_t stream;
    double time_s;
};

static int by_stream(const void *a, const void *b)
{
    const struct streamed *left = a, *right = b;
    if (left->stream != right->stream) {
        return left->stream < right->stream ? -1 : 1;
    }
    return by_value(&left->time_s, &right->time_s);
}

/* The median time between successive readings of one node and target, to the millisecond of a mote's clock; 0 without
 * any, -1 without memory. */
static double median_spacing(const struct recording *recording)
{
    const size_t readings = recording->reading_count;
    struct streamed *streamed = malloc(readings * sizeof *streamed);
    double *spacings = malloc(readings * sizeof *spacings);
    double median = -1;
    if (streamed != NULL && spacings != NULL) {
        for (size_t i = 0; i < readings; i++) {
            const struct recorded_reading *reading = &recording->readings[i];
            streamed[i] = (struct streamed){reading->node * 256 + reading->target, reading->time_s};
        }
        qsort(streamed, readings, sizeof *streamed, by_stream);
        size_t count = 0;
        for (size_t i = 1; i < readings; i++) {
            if (streamed[i].stream == streamed[i - 1].stream && streamed[i].time_s > streamed[i - 1].time_s) {
                spacings[count++] = streamed[i].time_s - streamed[i - 1].time_s;
            }
        }
        qsort(spacings, count, sizeof *spacings, by_value);
        median = count > 0 ? round(1000 * spacings[count / 2]) / 1000 : 0;
    }
    free(streamed);
    free(spacings);
    return median;
}

int recording_parse_readings(const char *text, size_t length, const char *name, struct recording *recording,
                             char *error, size_t error_size)
{
    static const struct column columns[] = {{"time_s", true, false, -TIME_MAX_S, TIME_MAX_S},
                                            {"node", true, true, 0, 4294967294.0},
                                            {"value", true, false, -VALUE_MAX, VALUE_MAX},
                                            {"target", false, true, 0, 255},
                                            {"bearing_rad", false, false, -7, 7},
                                            {"wind_speed_mps", false, false, 0, WIND_MAX_MPS},
                                            {"wind_toward_rad", false, false, -7, 7}};
    struct csv csv = {.at = text,
                      .end = text + length,
                      .name = name,
                      .columns = columns,
                      .column_count = 7,
                      .error = error,
                      .error_size = error_size};
    if (open_csv(&csv) != 0) {
        return -1;
    }
    if (csv.present[5] != csv.present[6]) {
        return fail(error, error_size,
                    "%s:%zu: expected both columns wind_speed_mps and wind_toward_rad or neither, found one", name,
                    csv.line - 1);
    }
    recording->has_wind = csv.present[5];
    struct indexed *index = index_nodes(recording);
    if (index == NULL) {
        return no_memory(&csv);
    }
    int status = 1;
    for (bool first = true; (status = read_row(&csv, first)) == 1; first = false) {
        const double time_s = csv.values[0];
        const uint32_t id = (uint32_t)csv.values[1];
        size_t low = 0, high = recording->node_count;
        while (low < high) {
            const size_t middle = low + (high - low) / 2;
            low = index[middle].id < id ? middle + 1 : low;
            high = index[middle].id < id ? high : middle;
        }
        if (low == recording->node_count || index[low].id != id) {
            status = fail(error, error_size, "%s:%zu: node: expected one of the %zu nodes of the nodes file, found %lu",
                          name, csv.line, recording->node_count, (unsigned long)id);
            break;
        }
        const size_t count = recording->reading_count;
        if (count > 0 && time_s < recording->readings[count - 1].time_s) {
            status = time_backwards(&csv, recording->readings[count - 1].time_s, time_s);
            break;
        }
        if (!grow((void **)&recording->readings, count, sizeof *recording->readings)) {
            status = no_memory(&csv);
            break;
        }
        recording->readings[recording->reading_count++] =
            (struct recorded_reading){.time_s = time_s,
                                      .node = index[low].index,
                                      .value = csv.values[2],
                                      .bearing_rad = csv.values[4],
                                      .wind_x_mps = csv.values[5] * cos(csv.values[6]),
                                      .wind_y_mps = csv.values[5] * sin(csv.values[6]),
                                      .target = (uint8_t)csv.values[3]};
    }
    free(index);
    if (status < 0) {
        return -1;
    }
    if (recording->reading_count == 0) {
        return fail(error, error_size, "%s:%zu: expected at least one reading, found none", name, csv.line);
    }
    recording->interval_s = median_spacing(recording);
    return recording->interval_s < 0 ? no_memory(&csv) : 0;
}

int recording_parse_truth(const char *text, size_t length, const char *name, struct recording *recording, char *error,
                          size_t error_size)
{
    static const struct column columns[] = {{"time_s", true, false, -TIME_MAX_S, TIME_MAX_S},
                                            {"x_m", true, false, -PLACE_MAX_M, PLACE_MAX_M},
                                            {"y_m", true, false, -PLACE_MAX_M, PLACE_MAX_M},
                                            {"target", false, true, 0, 255},
                                            {"rate_mlps", false, false, 0, RATE_MAX_MLPS}};
    struct csv csv = {.at = text,
                      .end = text + length,
                      .name = name,
                      .columns = columns,
                      .column_count = 5,
                      .error = error,
                      .error_size = error_size};
    if (open_csv(&csv) != 0) {
        return -1;
    }
    int status = 1;
    for (bool first = true; (status = read_row(&csv, first)) == 1; first = false) {
        const size_t count = recording->truth_count;
        if (count > 0 && csv.values[0] < recording->truths[count - 1].time_s) {
            return time_backwards(&csv, recording->truths[count - 1].time_s, csv.values[0]);
        }
        if (!grow((void **)&recording->truths, count, sizeof *recording->truths)) {
            return no_memory(&csv);
        }
        recording->truths[recording->truth_count++] =
            (struct recorded_truth){csv.values[0], csv.values[1], csv.values[2], csv.values[4], (uint8_t)csv.values[3]};
    }
    if (status < 0) {
        return -1;
    }
    if (recording->truth_count == 0) {
        return fail(error, error_size, "%s:%zu: expected at least one row, found none", name, csv.line);
    }
    return 0;
}

int recording_parse_candidates(const char *text, size_t length, const char *name, struct recording *recording,
                               char *error, size_t error_size)
{
    static const struct column columns[] = {{"place", true, true, 0, 4294967294.0},
                                            {"x_m", true, false, -PLACE_MAX_M, PLACE_MAX_M},
                                            {"y_m", true, false, -PLACE_MAX_M, PLACE_MAX_M}};
    struct csv csv = {.at = text,
                      .end = text + length,
                      .name = name,
                      .columns = columns,
                      .column_count = 3,
                      .error = error,
                      .error_size = error_size};
    if (open_csv(&csv) != 0) {
        return -1;
    }
    int status = 1;
    for (bool first = true; (status = read_row(&csv, first)) == 1; first = false) {
        const uint32_t id = (uint32_t)csv.values[0];
        for (size_t i = 0; i < recording->candidate_count; i++) {
            if (recording->candidates[i].id == id) {
                return fail(error, error_size, "%s:%zu: place: expected each once, found %lu again", name, csv.line,
                            (unsigned long)id);
            }
        }
        if (recording->candidate_count == MH_LEAK_PLACES_MAX) {
            return fail(error, error_size, "%s:%zu: expected at most %d places, found more", name, csv.line,
                        MH_LEAK_PLACES_MAX);
        }
        if (!grow((void **)&recording->candidates, recording->candidate_count, sizeof *recording->candidates)) {
            return no_memory(&csv);
        }
        recording->candidates[recording->candidate_count++] = (struct recorded_place){id, csv.values[1], csv.values[2]};
    }
    if (status < 0) {
        return -1;
    }
    if (recording->candidate_count == 0) {
        return fail(error, error_size, "%s:%zu: expected at least one place, found none", name, csv.line);
    }
    return 0;
}

typedef int (*parser)(const char *text, size_t length, const char *name, struct recording *recording, char *error,
                      size_t error_size);

static int load(parser parse, const char *path, struct recording *recording, char *error, size_t error_size)
{
    size_t length;
    char *text = text_read_file(path, &length, error, error_size);
    if (text == NULL) {
        return -1;
    }
    const int status = parse(text, length, path, recording, error, error_size);
    free(text);
    return status;
}

int recording_load_nodes(const char *nodes_path, struct recording *recording, char *error, size_t error_size)
{
    memset(recording, 0, sizeof *recording);
    const int status = load(recording_parse_nodes, nodes_path, recording, error, error_size);
    if (status != 0) {
        recording_free(recording);
    }
    return status;
}

int recording_load_candidates(const char *path, struct recording *recording, char *error, size_t error_size)
{
    return load(recording_parse_candidates, path, recording, error, error_size);
}

int recording_load(const char *nodes_path, const char *readings_path, const char *truth_path,
                   struct recording *recording, char *error, size_t error_size)
{
    if (recording_load_nodes(nodes_path, recording, error, error_size) != 0) {
        return -1;
    }
    if (load(recording_parse_readings, readings_path, recording, error, error_size) != 0 ||
        (truth_path != NULL && load(recording_parse_truth, truth_path, recording, error, error_size) != 0)) {
        recording_free(recording);
        return -1;
    }
    return 0;
}

static int two_targets(const char *name, size_t row, int first, int other, char *error, size_t error_size)
{
    return fail(error, error_size,
                "%s: target: expected one, which is all that a replay follows, found %d and %d in row %zu", name, first,
                other, row + 1);
}

int recording_check_targets(const struct recording *recording, const char *readings_name, const char *truth_name,
                            char *error, size_t error_size)
{
    for (size_t i = 1; i < recording->reading_count; i++) {
        const int first = recording->readings[0].target, other = recording->readings[i].target;
        if (other != first) {
            return two_targets(readings_name, i, first, other, error, error_size);
        }
    }
    for (size_t i = 1; i < recording->truth_count; i++) {
        const int first = recording->truths[0].target, other = recording->truths[i].target;
        if (other != first) {
            return two_targets(truth_name, i, first, other, error, error_size);
        }
    }
    return 0;
}

void recording_free(struct recording *recording)
{
    free(recording->nodes);
    free(recording->members);
    free(recording->readings);
    free(recording->truths);
    free(recording->candidates);
    memset(recording, 0, sizeof *recording);
}
