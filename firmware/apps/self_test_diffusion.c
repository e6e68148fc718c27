#include "motehound/line_source.h"
#include "self_test_parts.h"

/* Two segments of a moving source's way, integrated in double precision */
bool self_test_diffusion(void)
{
    static const struct {
        struct mh_segment segment;
        struct mh_vec2 node;
        mh_real diffusion, value;
    } known[] = {{{{0.0f, 0.0f}, {1.0f, 0.0f}, 1.0f, 0.0f}, {1.5f, 0.5f}, 1.0f, 0.09081231f},
                 {{{0.0f, 0.0f}, {3.0f, 1.0f}, 2.0f, 0.0f}, {3.2f, 2.0f}, 0.5f, 0.02500728f}};
    bool passed = self_test_node();
    for (uint8_t i = 0; i < 2; i++) {
        struct mh_segment_field field = {0.0f, {0.0f, 0.0f}, {0.0f, 0.0f}};
        mh_segment_add_field(&known[i].segment, known[i].node, known[i].diffusion, 1.0f, &field);
        passed = passed && mh_abs(field.value - known[i].value) <= 1e-3f * known[i].value;
    }
    return passed;
}
