/* A scenario's YAML file. libcyaml checks its shape by a schema that is made from the table of keys and gives every
 * value as text; scenario_set turns the texts into values, so that a file and --set are read by the same code.
 * libyaml's own document tree is asked only for the line of a value that was refused. */
#include "scenario/keys.h"
#include "scenario/text.h"

#include <cyaml/cyaml.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { KEYS_MAX = 256, SECTIONS_MAX = 32, FIELDS_MAX = KEYS_MAX + 2 * SECTIONS_MAX };

struct raw_point {
    char *x, *y, *speed_factor;
};

struct raw_target {
    char *start_s, *speed_mps, *loudness;
    struct raw_point *points;
    unsigned points_count;
};

/* The document as texts, NULL where a key is absent. */
struct raw {
    char *values[KEYS_MAX];
    struct raw_point *points;
    unsigned points_count;
    struct raw_target *targets;
    unsigned targets_count;
    char **lists[KEYS_MAX];
    unsigned list_counts[KEYS_MAX];
};

static const cyaml_schema_field_t point_fields[] = {
    CYAML_FIELD_STRING_PTR("x_m", CYAML_FLAG_POINTER, struct raw_point, x, 0, CYAML_UNLIMITED),
    CYAML_FIELD_STRING_PTR("y_m", CYAML_FLAG_POINTER, struct raw_point, y, 0, CYAML_UNLIMITED),
    CYAML_FIELD_STRING_PTR("speed_factor", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw_point, speed_factor, 0,
                           CYAML_UNLIMITED),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t point_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct raw_point, point_fields),
};
static const cyaml_schema_field_t target_fields[] = {
    CYAML_FIELD_STRING_PTR("start_s", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw_target, start_s, 0,
                           CYAML_UNLIMITED),
    CYAML_FIELD_STRING_PTR("speed_mps", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw_target, speed_mps, 0,
                           CYAML_UNLIMITED),
    CYAML_FIELD_STRING_PTR("loudness", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw_target, loudness, 0,
                           CYAML_UNLIMITED),
    CYAML_FIELD_SEQUENCE("points", CYAML_FLAG_POINTER, struct raw_target, points, &point_schema, 1, CYAML_UNLIMITED),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t target_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct raw_target, target_fields),
};
static const cyaml_schema_value_t text_schema = {
    CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char *, 0, CYAML_UNLIMITED),
};

struct schema {
    cyaml_schema_field_t fields[FIELDS_MAX]; /* of all sections, one after the other, each ended by CYAML_FIELD_END */
    cyaml_schema_field_t top[SECTIONS_MAX];
    char section_names[SECTIONS_MAX][32];
    cyaml_schema_value_t root;
};

static bool is_list(const struct scenario_key *key) { return key->type == KEY_LIST || key->type == KEY_NUMBERS; }

static cyaml_schema_field_t field_of(size_t index, const char *name)
{
    const cyaml_schema_field_t points = CYAML_FIELD_SEQUENCE("", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw,
                                                             points, &point_schema, 1, CYAML_UNLIMITED);
    const cyaml_schema_field_t targets = CYAML_FIELD_SEQUENCE("", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw,
                                                              targets, &target_schema, 1, CYAML_UNLIMITED);
    cyaml_schema_field_t list = CYAML_FIELD_SEQUENCE_COUNT("", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw,
                                                           lists[0], list_counts[0], &text_schema, 1, CYAML_UNLIMITED);
    cyaml_schema_field_t field =
        CYAML_FIELD_STRING_PTR("", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct raw, values[0], 0, CYAML_UNLIMITED);
    if (scenario_keys[index].type == KEY_POINTS) {
        field = points;
    } else if (scenario_keys[index].type == KEY_TARGETS) {
        field = targets;
    } else if (is_list(&scenario_keys[index])) {
        list.data_offset = (uint32_t)(offsetof(struct raw, lists) + index * sizeof(char **));
        list.count_offset = (uint32_t)(offsetof(struct raw, list_counts) + index * sizeof(unsigned));
        field = list;
    } else {
        field.data_offset = (uint32_t)(offsetof(struct raw, values) + index * sizeof(char *));
    }
    field.key = name;
    return field;
}

/* One mapping for each section, the part of a path before its dot; the keys of a section stand together in the table.
 * All sections lie over the same struct raw. */
static void make_schema(struct schema *schema)
{
    memset(schema, 0, sizeof *schema);
    size_t fields = 0, top = 0, sections = 0;
    for (size_t i = 0; i < scenario_key_count; i++) {
        const char *path = scenario_keys[i].path;
        const char *dot = strchr(path, '.');
        if (dot == NULL) {
            schema->top[top++] = field_of(i, path);
            continue;
        }
        const size_t length = (size_t)(dot - path);
        if (sections == 0 || strlen(schema->section_names[sections - 1]) != length ||
            strncmp(schema->section_names[sections - 1], path, length) != 0) {
            fields += sections > 0; /* leave CYAML_FIELD_END behind the section before */
            snprintf(schema->section_names[sections], sizeof schema->section_names[0], "%.*s", (int)length, path);
            schema->top[top++] = (cyaml_schema_field_t){
                .key = schema->section_names[sections],
                .value = {.type = CYAML_MAPPING,
                          .flags = CYAML_FLAG_OPTIONAL,
                          .data_size = sizeof(struct raw),
                          .mapping = {.fields = &schema->fields[fields]}},
            };
            sections++;
        }
        schema->fields[fields++] = field_of(i, dot + 1);
    }
    schema->root = (cyaml_schema_value_t){CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct raw, schema->top)};
}

/* What libcyaml says: a line "Load: ...", then a backtrace from the innermost mapping outwards. */
struct complaint {
    char text[2048];
    size_t used;
};

static void listen(cyaml_log_t level, void *context, const char *format, va_list arguments)
{
    (void)level;
    struct complaint *complaint = context;
    const size_t left = sizeof complaint->text - complaint->used;
    const int written = vsnprintf(complaint->text + complaint->used, left, format, arguments);
    complaint->used += written < 0 ? 0 : ((size_t)written < left ? (size_t)written : left - 1);
}

/* The keys of the backtrace, outermost first, joined by dots. */
static void path_of(const struct complaint *complaint, char *path, size_t size)
{
    static const char mark[] = "in mapping field '";
    path[0] = '\0';
    for (const char *at = strstr(complaint->text, mark); at != NULL; at = strstr(at + 1, mark)) {
        const char *name = at + sizeof mark - 1;
        char inner[200];
        snprintf(inner, sizeof inner, "%s", path);
        snprintf(path, size, "%.*s%s%.120s", (int)strcspn(name, "'"), name, inner[0] != '\0' ? "." : "", inner);
    }
}

static const char *shape(const char *word)
{
    if (strncmp(word, "SEQUENCE", 8) == 0) {
        return "a list";
    }
    if (strncmp(word, "MAPPING", 7) == 0) {
        return "a block of keys";
    }
    return "a single value";
}

/* A node of the document by path, such as source.points[2].x_m; NULL if it is not there. */
static const yaml_node_t *node_of(yaml_document_t *document, const char *path)
{
    const yaml_node_t *node = yaml_document_get_root_node(document);
    while (node != NULL && *path != '\0') {
        const yaml_node_t *next = NULL;
        if (*path == '[' && node->type == YAML_SEQUENCE_NODE) {
            const long index = strtol(path + 1, NULL, 10);
            const yaml_node_item_t *item = node->data.sequence.items.start + index;
            next = item < node->data.sequence.items.top ? yaml_document_get_node(document, *item) : NULL;
            path += strcspn(path, "]") + 1;
        } else if (node->type == YAML_MAPPING_NODE) {
            const size_t length = strcspn(path, ".[");
            for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top;
                 pair++) {
                const yaml_node_t *key = yaml_document_get_node(document, pair->key);
                if (key->type == YAML_SCALAR_NODE && key->data.scalar.length == length &&
                    memcmp(key->data.scalar.value, path, length) == 0) {
                    next = yaml_document_get_node(document, pair->value);
                }
            }
            path += length;
        }
        path += *path == '.';
        node = next;
    }
    return node;
}

/* The line of the value at `path`, or of what makes the document no YAML at all; 0 if neither is to be found. */
static size_t line_of(const char *yaml, size_t length, const char *path, char *problem, size_t problem_size)
{
    yaml_parser_t parser;
    yaml_document_t document;
    size_t line = 0;
    if (!yaml_parser_initialize(&parser)) {
        return 0;
    }
    yaml_parser_set_input_string(&parser, (const unsigned char *)yaml, length);
    if (yaml_parser_load(&parser, &document)) {
        const yaml_node_t *node = node_of(&document, path);
        line = node != NULL ? node->start_mark.line + 1 : 0;
        yaml_document_delete(&document);
    } else {
        line = parser.problem_mark.line + 1;
        snprintf(problem, problem_size, "%s", parser.problem != NULL ? parser.problem : "no memory");
    }
    yaml_parser_delete(&parser);
    return line;
}

/* What libcyaml refused, in our words. */
static int explain(const char *yaml, size_t length, const char *name, cyaml_err_t status,
                   const struct complaint *complaint, char *error, size_t error_size)
{
    const char *text = complaint->text;
    const char *line_text = strstr(text, "(line: ");
    size_t line = line_text != NULL ? strtoul(line_text + 7, NULL, 10) : 1;
    char path[300], place[4200], word[100] = "";
    path_of(complaint, path, sizeof path);
    const char *after = path[0] != '\0' ? ": " : "";
    if (strstr(text, "libyaml: ") != NULL) {
        char problem[200] = "";
        line = line_of(yaml, length, "", problem, sizeof problem);
        return fail(error, error_size, "%s:%zu: expected YAML: %s", name, line, problem);
    }
    snprintf(place, sizeof place, "%s:%zu: ", name, line);
    if (sscanf(text, "Load: Unexpected key: %99[^\n]", word) == 1) {
        char whole[420];
        snprintf(whole, sizeof whole, "%s%s%s", path, path[0] != '\0' ? "." : "", word);
        return scenario_key_unknown(place, whole, error, error_size);
    }
    if (strncmp(text, "Load: Expecting ", 16) == 0) {
        const char *found = strstr(text, "event: ");
        return fail(error, error_size, "%s%s%sexpected %s, found %s", place, path, after, shape(text + 16),
                    shape(found != NULL ? found + 7 : ""));
    }
    if (sscanf(text, "Load: Missing required mapping field: %99[^\n]", word) == 1) {
        char *last = strrchr(path, '.'); /* the backtrace names the field read last, which is sound */
        if (last != NULL) {
            *last = '\0';
        }
        return fail(error, error_size, "%s%s%sexpected a key %s", place, path, after, word);
    }
    if (strstr(text, "Insufficient entries") != NULL) {
        return fail(error, error_size, "%s%s%sexpected at least one entry, found none", place, path, after);
    }
    if (strstr(text, "already seen") != NULL) {
        return fail(error, error_size, "%s%s%sexpected once, found twice", place, path, after);
    }
    return fail(error, error_size, "%s%s%s%s", place, path, after,
                status == CYAML_OK ? "expected one document, found more" : cyaml_strerror(status));
}

/* What is being turned into text, for errors. */
struct document {
    const char *yaml;
    size_t length;
    const char *name;
    char *error;
    size_t error_size;
};

enum { NUMBER_MAX = 60, POINT_MAX = 3 * NUMBER_MAX + 4 };

/* `value`, or what stands for it where there is none, of a member of the list's entry at `entry`; NULL, with one line, where it is no number of its range. */
static const char *number_text(const struct document *document, const char *entry, const struct member_range *range,
                               const char *value, const char *standard)
{
    const char *text = value != NULL ? value : standard;
    double number;
    if (strlen(text) <= NUMBER_MAX && text_number(text, strlen(text), &number) && number >= range->minimum &&
        number <= range->maximum) {
        return text;
    }
    char path[120], problem[8];
    snprintf(path, sizeof path, "%s.%s", entry, range->name);
    fail(document->error, document->error_size, "%s:%zu: %s: expected a number %g to %g, found '%.60s'", document->name,
         line_of(document->yaml, document->length, path, problem, sizeof problem), path, range->minimum, range->maximum,
         text);
    return NULL;
}

/* The points of the list at `path` as --set writes them -> text, with POINT_MAX bytes for each. False with one line. */
static bool write_points(const struct document *document, const char *path, const struct raw_point *points,
                         unsigned count, char *text)
{
    for (unsigned i = 0; i < count; i++) {
        const char *values[POINT_MEMBERS] = {points[i].x, points[i].y, points[i].speed_factor};
        char point[100];
        snprintf(point, sizeof point, "%s[%u]", path, i);
        for (size_t j = 0; j < POINT_MEMBERS; j++) {
            const char *number = number_text(document, point, &point_members[j], values[j], "1");
            if (number == NULL) {
                return false;
            }
            text += sprintf(text, "%s%s", number, j < 2 ? "," : (i + 1 < count ? ";" : ""));
        }
    }
    *text = '\0';
    return true;
}

static char *no_memory(const struct document *document)
{
    fail(document->error, document->error_size, "%s: no memory", document->name);
    return NULL;
}

/* The points as --set writes them. Returns NULL with one line. */
static char *points_text(const struct document *document, const struct raw *raw)
{
    char *text = malloc((size_t)raw->points_count * POINT_MAX + 1);
    if (text == NULL) {
        return no_memory(document);
    }
    if (!write_points(document, "source.points", raw->points, raw->points_count, text)) {
        free(text);
        return NULL;
    }
    return text;
}

/* One target likewise -> text. */
static bool write_target(const struct document *document, unsigned index, const struct raw_target *target,
                         const struct scenario *scenario, char *text)
{
    char entry[40], points[60], standard[TARGET_MEMBERS][NUMBER_MAX] = {"0"};
    snprintf(entry, sizeof entry, "targets[%u]", index);
    snprintf(points, sizeof points, "%s.points", entry);
    snprintf(standard[1], sizeof standard[1], "%.17g", scenario->source.speed_mps);
    snprintf(standard[2], sizeof standard[2], "%.17g", scenario->source.loudness);
    const char *values[TARGET_MEMBERS] = {target->start_s, target->speed_mps, target->loudness};
    text += sprintf(text, "%s", index > 0 ? "|" : "");
    for (size_t j = 0; j < TARGET_MEMBERS; j++) {
        const char *number = number_text(document, entry, &target_members[j], values[j], standard[j]);
        if (number == NULL) {
            return false;
        }
        text += sprintf(text, "%s%c", number, j + 1 < TARGET_MEMBERS ? ',' : ':');
    }
    return write_points(document, points, target->points, target->points_count, text);
}

/* The targets as --set writes them. Returns NULL with one line. */
static char *targets_text(const struct document *document, const struct raw *raw, const struct scenario *scenario)
{
    size_t size = 1;
    for (unsigned i = 0; i < raw->targets_count; i++) {
        size += ((size_t)raw->targets[i].points_count + 1) * POINT_MAX + 1;
    }
    char *text = calloc(size, 1);
    if (text == NULL) {
        return no_memory(document);
    }
    for (unsigned i = 0; i < raw->targets_count; i++) {
        if (!write_target(document, i, &raw->targets[i], scenario, text + strlen(text))) {
            free(text);
            return NULL;
        }
    }
    return text;
}

static char *list_text(const char *name, char **list, unsigned count, char *error, size_t error_size)
{
    size_t size = 1;
    for (unsigned i = 0; i < count; i++) {
        size += strlen(list[i]) + 1;
    }
    char *text = calloc(size, 1);
    if (text == NULL) {
        fail(error, error_size, "%s: no memory", name);
        return NULL;
    }
    for (unsigned i = 0; i < count; i++) {
        const size_t used = strlen(text);
        snprintf(text + used, size - used, "%s%s", i > 0 ? "," : "", list[i]);
    }
    return text;
}

/* The value of key `index` as --set would give it: NULL where it is absent, else in *value. What is made for it is *made, the caller's to free. False
 * with one line. */
static bool value_text(const struct document *document, const struct raw *raw, size_t index,
                       const struct scenario *scenario, const char **value, char **made)
{
    const enum key_type type = scenario_keys[index].type;
    *value = raw->values[index];
    *made = NULL;
    const bool listed = type == KEY_POINTS    ? raw->points != NULL
                        : type == KEY_TARGETS ? raw->targets != NULL
                                              : raw->lists[index] != NULL;
    if (!listed) {
        return true;
    }
    *value = *made = type == KEY_POINTS    ? points_text(document, raw)
                     : type == KEY_TARGETS ? targets_text(document, raw, scenario)
                                           : list_text(document->name, raw->lists[index], raw->list_counts[index],
                                                       document->error, document->error_size);
    return *made != NULL;
}

static int apply(const char *yaml, size_t length, const char *name, const struct raw *raw, struct scenario *scenario,
                 char *error, size_t error_size)
{
    const struct document document = {yaml, length, name, error, error_size};
    for (size_t i = 0; i < scenario_key_count; i++) {
        const struct scenario_key *key = &scenario_keys[i];
        const char *value;
        char *made, reason[600], problem[8];
        if (!value_text(&document, raw, i, scenario, &value, &made)) {
            return -1;
        }
        const int status = value == NULL ? 0 : scenario_set(scenario, key->path, value, reason, sizeof reason);
        free(made);
        if (status != 0) {
            return fail(error, error_size, "%s:%zu: %s", name,
                        line_of(yaml, length, key->path, problem, sizeof problem), reason);
        }
    }
    return 0;
}

int scenario_parse(const char *yaml, size_t length, const char *name, struct scenario *scenario, char *error,
                   size_t error_size)
{
    struct schema schema;
    struct complaint complaint = {.used = 0};
    make_schema(&schema);
    const cyaml_config_t config = {
        .log_fn = listen,
        .log_ctx = &complaint,
        .mem_fn = cyaml_mem,
        .log_level = CYAML_LOG_WARNING,
        .flags = CYAML_CFG_NO_ALIAS,
    };
    struct raw *raw = NULL;
    const cyaml_err_t status =
        cyaml_load_data((const uint8_t *)yaml, length, &config, &schema.root, (cyaml_data_t **)&raw, NULL);
    int result = 0;
    if (status != CYAML_OK || complaint.used > 0) {
        result = explain(yaml, length, name, status, &complaint, error, error_size);
    } else if (raw == NULL) {
        result = fail(error, error_size, "%s:1: expected keys of a scenario, found nothing", name);
    } else {
        result = apply(yaml, length, name, raw, scenario, error, error_size);
    }
    if (raw != NULL) {
        cyaml_free(&config, &schema.root, raw, 0);
    }
    return result;
}

int scenario_load(const char *path, struct scenario *scenario, char *error, size_t error_size)
{
    size_t length;
    char *yaml = text_read_file(path, &length, error, error_size);
    if (yaml == NULL) {
        return -1;
    }
    const int status = scenario_parse(yaml, length, path, scenario, error, error_size);
    free(yaml);
    const char *slash = strrchr(path, '/');
    const char *file = scenario->network.file;
    if (status != 0 || file[0] == '\0' || file[0] == '/' || slash == NULL) {
        return status;
    }
    char joined[4001];
    snprintf(joined, sizeof joined, "%.*s/%s", (int)(slash - path), path, file);
    return scenario_set(scenario, "network.file", joined, error, error_size);
}
