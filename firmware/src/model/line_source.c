#include "motehound/line_source.h"

/* beyond this the exponential is below 1e-6 of the value at the source */
#define NEGLIGIBLE_EXPONENT 16.0f

#define YOUNG_POINTS 8
#define OLD_POINTS 4
#define YOUNG_RATIO 300.0f
#define YOUNG_SPAN 5.70378247f /* ln 300 */

/* Gauss-Legendre on [0, 1] */
static const mh_real young_nodes[YOUNG_POINTS] = {0.0198550718f, 0.101666761f, 0.237233795f, 0.408282679f,
                                                  0.591717321f,  0.762766205f, 0.898333239f, 0.980144928f};
static const mh_real young_weights[YOUNG_POINTS] = {0.0506142681f, 0.111190517f, 0.156853323f, 0.181341892f,
                                                    0.181341892f,  0.156853323f, 0.111190517f, 0.0506142681f};
/* 300^(node - 1): the young nodes as shares of age_a where the segment ends at the source itself */
static const mh_real young_shares[YOUNG_POINTS] = {0.00373303589f, 0.00595277737f, 0.0128983935f, 0.0342171983f,
                                                   0.0974168985f,  0.258430117f,   0.559962707f,  0.892928284f};
static const mh_real old_nodes[OLD_POINTS] = {0.0694318442f, 0.330009478f, 0.669990522f, 0.930568156f};
static const mh_real old_weights[OLD_POINTS] = {0.173927423f, 0.326072577f, 0.326072577f, 0.173927423f};

/* One quadrature point: what `weight` seconds of release at this age leave at the node, Eq. (4). */
static void add_point(const struct mh_segment *segment, struct mh_vec2 node, mh_real diffusion, mh_real age,
                      mh_real weight, struct mh_segment_field *field)
{
    const mh_real share_a = (age - segment->age_b) / (segment->age_a - segment->age_b);
    const mh_real share_b = 1.0f - share_a;
    const struct mh_vec2 offset = {node.x - share_a * segment->a.x - share_b * segment->b.x,
                                   node.y - share_a * segment->a.y - share_b * segment->b.y};
    const mh_real spread = 1.0f / (4.0f * diffusion * age);
    const mh_real exponent = (offset.x * offset.x + offset.y * offset.y) * spread;
    if (exponent > NEGLIGIBLE_EXPONENT) {
        return;
    }
    const mh_real value = weight * spread * (1.0f / MH_PI) * mh_exp(-exponent);
    const mh_real slope = 2.0f * spread * value;
    field->value += value;
    field->da.x += share_a * slope * offset.x;
    field->da.y += share_a * slope * offset.y;
    field->db.x += share_b * slope * offset.x;
    field->db.y += share_b * slope * offset.y;
}

void mh_segment_add_field(const struct mh_segment *segment, struct mh_vec2 node, mh_real diffusion_m2ps, mh_real sign,
                          struct mh_segment_field *field)
{
    const mh_real oldest = segment->age_a;
    if (!(oldest > 0.0f)) {
        return;
    }
    const mh_real youngest = mh_max(segment->age_b, 0.0f);
    if (youngest >= 0.25f * oldest) {
        const mh_real duration = oldest - youngest;
        for (int i = 0; i < OLD_POINTS; i++) {
            add_point(segment, node, diffusion_m2ps, youngest + duration * old_nodes[i],
                      sign * duration * old_weights[i], field);
        }
        return;
    }
    /* the integrand changes over decades of age: quadrature in ln s, ds = s d(ln s) */
    const bool reaches_source = YOUNG_RATIO * youngest <= oldest;
    const mh_real span = reaches_source ? YOUNG_SPAN : mh_log(oldest / youngest);
    for (int i = 0; i < YOUNG_POINTS; i++) {
        const mh_real age = oldest * (reaches_source ? young_shares[i] : mh_exp(span * (young_nodes[i] - 1.0f)));
        add_point(segment, node, diffusion_m2ps, age, sign * span * young_weights[i] * age, field);
    }
}

mh_real mh_segment_old_field(const struct mh_segment *segment, struct mh_vec2 node, mh_real diffusion_m2ps)
{
    const mh_real duration = segment->age_a - segment->age_b;
    const int points = segment->age_b < 2.0f * duration ? 4 : segment->age_b < 10.0f * duration ? 2 : 1;
    const mh_real step = duration / (mh_real)points;
    struct mh_segment_field field = {0.0f, {0.0f, 0.0f}, {0.0f, 0.0f}};
    for (int i = 0; i < points; i++) {
        add_point(segment, node, diffusion_m2ps, segment->age_b + step * ((mh_real)i + 0.5f), step, &field);
    }
    return field.value;
}
