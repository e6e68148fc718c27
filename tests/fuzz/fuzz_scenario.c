/* Scenarios: any text as YAML, and each of its lines as one --set. */
#include "fuzz.h"
#include "scenario/scenario.h"

#include <string.h>

static void set_each_line(const char *text, struct scenario *scenario)
{
    char error[1000];
    char *copy = strdup(text), *rest = NULL;
    for (char *line = strtok_r(copy, "\n", &rest); line != NULL; line = strtok_r(NULL, "\n", &rest)) {
        char *equals = strchr(line, '=');
        if (equals != NULL) {
            *equals = '\0';
            const int status = scenario_set(scenario, line, equals + 1, error, sizeof error);
            require(status == 0 || (error[0] != '\0' && strchr(error, '\n') == NULL));
        }
    }
    free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char error[1000] = "";
    struct scenario scenario;
    char *text = malloc(size + 1);
    memcpy(text, data, size);
    text[size] = '\0';
    require(scenario_init(&scenario) == 0);
    if (scenario_parse(text, size, "fuzz", &scenario, error, sizeof error) != 0) {
        require(error[0] != '\0' && strchr(error, '\n') == NULL); /* an error is one line */
    } else {
        scenario_check(&scenario, "fuzz", error, sizeof error);
    }
    scenario_free(&scenario);
    require(scenario_init(&scenario) == 0);
    set_each_line(text, &scenario);
    scenario_free(&scenario);
    free(text);
    return 0;
}
