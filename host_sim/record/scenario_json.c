#include "record/scenario_json.h"

#include "scenario/keys.h"

#include <string.h>

/* The word at `index` among words separated by '|'. */
static json_t *word_at(const char *choices, unsigned index)
{
    while (index-- > 0) {
        choices += strcspn(choices, "|") + 1;
    }
    return json_stringn(choices, strcspn(choices, "|"));
}

static json_t *points(const struct waypoint *points, unsigned count)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < count; i++) {
        const struct waypoint *point = &points[i];
        json_array_append_new(list, json_pack("{s:f, s:f, s:f}", "x_m", point->x_m, "y_m", point->y_m, "speed_factor",
                                              point->speed_factor));
    }
    return list;
}

static json_t *targets(const struct scenario *scenario)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < scenario->targets_count; i++) {
        const struct scripted_target *target = &scenario->targets[i];
        json_array_append_new(list, json_pack("{s:f, s:f, s:f, s:o}", "start_s", target->start_s, "speed_mps",
                                              target->speed_mps, "loudness", target->loudness, "points",
                                              points(target->points, target->points_count)));
    }
    return list;
}

static json_t *sweep_values(const struct scenario *scenario)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < scenario->sweep.values_count; i++) {
        json_array_append_new(list, json_string(scenario->sweep.values[i]));
    }
    return list;
}

static json_t *numbers(const struct number_list *numbers)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < numbers->count; i++) {
        json_array_append_new(list, json_real(numbers->values[i]));
    }
    return list;
}

static json_t *value_of(const struct scenario *scenario, const struct scenario_key *key)
{
    const char *member = (const char *)scenario + key->offset;
    switch (key->type) {
    case KEY_NUMBER:
        return json_real(*(const double *)member);
    case KEY_COUNT:
        return json_integer(*(const int64_t *)member);
    case KEY_SWITCH:
        return json_boolean(*(const bool *)member);
    case KEY_CHOICE:
        return word_at(key->choices, *(const unsigned *)member);
    case KEY_WORD:
    case KEY_TEXT:
        return json_string(*(char *const *)member);
    case KEY_POINTS:
        return points(scenario->source.points, scenario->source.points_count);
    case KEY_TARGETS:
        return targets(scenario);
    case KEY_NUMBERS:
        return numbers((const struct number_list *)(const void *)member);
    case KEY_LIST:
        return sweep_values(scenario);
    }
    return NULL;
}

/* With the field that is laid out, for those who draw it. */
json_t *scenario_json(const struct scenario *scenario)
{
    const struct scenario_field field = scenario_field(scenario);
    struct scenario shown = *scenario;
    shown.field.width_m = field.width_m;
    shown.field.height_m = field.height_m;
    shown.network.sink_x_m = field.sink_x_m;
    shown.network.sink_y_m = field.sink_y_m;
    json_t *whole = json_object();
    int status = whole == NULL ? -1 : 0;
    for (size_t i = 0; i < scenario_key_count && status == 0; i++) {
        const struct scenario_key *key = &scenario_keys[i];
        const char *dot = strchr(key->path, '.');
        json_t *section = whole;
        const char *name = key->path;
        if (dot != NULL) {
            char section_name[40] = "";
            memcpy(section_name, key->path, (size_t)(dot - key->path));
            name = dot + 1;
            section = json_object_get(whole, section_name);
            if (section == NULL) {
                section = json_object();
                status |= json_object_set_new(whole, section_name, section);
            }
        }
        status |= json_object_set_new(section, name, value_of(&shown, key));
    }
    if (status != 0) {
        json_decref(whole);
        return NULL;
    }
    return whole;
}
