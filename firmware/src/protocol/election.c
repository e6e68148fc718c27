#include "motehound/election.h"

void mh_election_config_default(struct mh_election_config *config, enum mh_election rule)
{
    const uint8_t members = rule == MH_ELECTION_SACX ? 15 : 7;
    const struct mh_election_config nominal = {
        .rule = rule,
        .members = members < MH_CLUSTER_MAX ? members : MH_CLUSTER_MAX,
        .horizon = 4,
        .least_answers = 4,
        .sensing_range_m = MH_REAL(50.0f),
        .radio_range_m = MH_REAL(100.0f),
        .interval = 2 * MH_TICKS_PER_S,
    };
    *config = nominal;
}

enum mh_status mh_election_check(const struct mh_election_config *config)
{
    const bool sound = (unsigned)config->rule < MH_ELECTIONS && config->members >= 1 &&
                       config->members <= MH_CLUSTER_MAX && config->horizon >= 1 &&
                       config->horizon <= MH_ELECTION_HORIZON_MAX && config->least_answers <= MH_CLUSTER_MAX + 1 &&
                       mh_within(config->sensing_range_m, MH_REAL(0.1f), MH_REAL(1e4f)) &&
                       mh_within(config->radio_range_m, MH_REAL(0.1f), MH_REAL_UPTO(1e5f)) && config->interval >= 1 &&
                       config->interval <= 3600000u;
    return sound ? MH_OK : MH_ERR_ARGUMENT;
}

static bool takes_all_that_detect(enum mh_election rule)
{
    return rule == MH_ELECTION_SCM || rule == MH_ELECTION_SCM_NEAR || rule == MH_ELECTION_SCM_SET;
}

static uint32_t millimetres(mh_real m) { return (uint32_t)mh_real_times(m, 1000); }

const struct mh_member *mh_cluster_find(const struct mh_cluster *cluster, mh_node_id id)
{
    if (cluster->head.id == id) {
        return &cluster->head;
    }
    for (uint8_t i = 0; i < cluster->count; i++) {
        if (cluster->members[i].id == id) {
            return &cluster->members[i];
        }
    }
    return NULL;
}

bool mh_election_asks(const struct mh_election_config *config, const struct mh_cluster *cluster, mh_node_id id,
                      const struct mh_place *place, const struct mh_place *predicted)
{
    if (id == cluster->head.id) {
        return true;
    }
    if (takes_all_that_detect(config->rule)) {
        return mh_place_within(place, &cluster->head.place, millimetres(config->radio_range_m));
    }
    return mh_cluster_find(cluster, id) != NULL &&
           (config->rule != MH_ELECTION_SACX ||
            mh_place_within(place, predicted, millimetres(config->sensing_range_m + MH_ELECTION_MARGIN_M)));
}

bool mh_election_asks_all(const struct mh_election_config *config, size_t answers)
{
    return config->rule == MH_ELECTION_SACX && answers < config->least_answers;
}

/* Where the target is and goes: relative to `origin`, in metres. */
struct way {
    const struct mh_place *origin;
    struct mh_vec2 start, step; /* step: of one interval from `start` */
    mh_real step_length;
    mh_real sensing;
    uint8_t horizon;
};

static enum mh_status make_way(struct way *way, const struct mh_election_config *config, const struct mh_place *origin,
                               const struct mh_vec2 *position, const struct mh_vec2 *start,
                               const struct mh_vec2 *velocity)
{
    const mh_real interval_s = mh_real_from_ratio((int32_t)config->interval, (int32_t)MH_TICKS_PER_S);
    way->origin = origin;
    way->start = *start;
    way->step.x = mh_mul(velocity->x, interval_s);
    way->step.y = mh_mul(velocity->y, interval_s);
    way->step_length = mh_vec2_length(way->step);
    way->sensing = config->sensing_range_m;
    if (!mh_vec2_finite(*position) || !mh_vec2_finite(way->start) || !mh_finite(way->step_length)) {
        return MH_ERR_NOT_FINITE;
    }
    way->horizon = config->horizon;
    if (config->rule == MH_ELECTION_SACX) {
        const mh_real diameter = 2 * config->sensing_range_m, most = mh_real_from_int(MH_ELECTION_HORIZON_MAX);
        const bool fast = mh_wide_mul(way->step_length, most) > mh_wide_mul(diameter, MH_REAL(1.0f));
        const mh_real crossing = fast ? mh_div(diameter, way->step_length) : most;
        const uint8_t whole = (uint8_t)mh_real_times(crossing, 1);
        const uint8_t instants = (uint8_t)(whole + (mh_real_from_int(whole) < crossing ? 1 : 0));
        way->horizon = instants < 2 ? 2 : instants;
    }
    return MH_OK;
}

/* `place`, as a vector from where the target is expected after `intervals`. */
static struct mh_vec2 from_prediction(const struct way *way, mh_real intervals, const struct mh_place *place)
{
    return mh_vec2_between(mh_vec2_along(way->start, intervals, way->step), mh_place_relative(place, way->origin));
}

static bool covers(const struct way *way, mh_real intervals, const struct mh_place *place)
{
    return mh_vec2_square(from_prediction(way, intervals, place)) <= mh_wide_mul(way->sensing, way->sensing);
}

/* At how many instants the node covers the target. */
static uint8_t instants(const struct mh_member *member)
{
    return member->last == 0
               ? 0
               : (uint8_t)(member->last - member->first + 1); /* a straight line cuts a disc in one piece */
}

/* Which node is better: more instants, then less cost, then the lower identifier. */
static bool better(const struct mh_member *a, mh_wide a_cost, const struct mh_member *b, mh_wide b_cost)
{
    if (instants(a) != instants(b)) {
        return instants(a) > instants(b);
    }
    if (a_cost < b_cost || a_cost > b_cost) {
        return a_cost < b_cost;
    }
    return a->id < b->id;
}

/* How far the target goes inside the node's disc from P_1 on. */
static mh_real way_inside(const struct way *way, const struct mh_place *place)
{
    const struct mh_vec2 d = from_prediction(way, MH_REAL(1.0f), place);
    if (!(way->step_length > 0)) {
        return mh_add(way->sensing, -mh_vec2_length(d));
    }
    const mh_real ahead = mh_wide_div(mh_vec2_dot(d, way->step), way->step_length);
    const mh_wide half_chord = mh_wide_mul(ahead, ahead) + mh_wide_mul(way->sensing, way->sensing) - mh_vec2_square(d);
    return ahead + mh_wide_sqrt(half_chord > 0 ? half_chord : 0);
}

/* The candidate as a node of the cluster that the rules sac, sacx and rho form. */
static struct mh_member rank_ahead(const struct mh_election_config *config, const struct way *way,
                                   const struct mh_candidate *candidate, mh_wide *cost)
{
    struct mh_member member = {candidate->id, candidate->place, 0, 0};
    if (config->rule == MH_ELECTION_RHO) {
        *cost = -mh_wide_mul(way_inside(way, &candidate->place), MH_REAL(1.0f));
        return member;
    }
    for (uint8_t q = 1; q <= way->horizon; q++) {
        if (covers(way, mh_real_from_int(q), &candidate->place)) {
            member.first = member.first == 0 ? q : member.first;
            member.last = q;
        }
    }
    const mh_real aim =
        config->rule == MH_ELECTION_SACX ? mh_real_from_int(way->horizon + 1) / 2 : mh_real_from_int(way->horizon);
    *cost = mh_vec2_square(from_prediction(way, aim, &candidate->place));
    return member;
}

/* The best members of a cluster, so far. */
struct list {
    struct mh_cluster *cluster;
    uint8_t limit;
    mh_wide costs[MH_CLUSTER_MAX];
};

static void add(struct list *list, const struct mh_member *member, mh_wide cost)
{
    struct mh_cluster *cluster = list->cluster;
    uint8_t i = cluster->count;
    if (i == list->limit) {
        if (i == 0 || !better(member, cost, &cluster->members[i - 1], list->costs[i - 1])) {
            return;
        }
        i--;
    } else {
        cluster->count++;
    }
    for (; i > 0 && better(member, cost, &cluster->members[i - 1], list->costs[i - 1]); i--) {
        list->costs[i] = list->costs[i - 1];
        cluster->members[i] = cluster->members[i - 1];
    }
    list->costs[i] = cost;
    cluster->members[i] = *member;
}

static void choose_ahead(const struct mh_election_config *config, const struct way *way,
                         const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster)
{
    struct list list;
    list.cluster = cluster;
    list.limit = config->members;
    cluster->count = 0;
    for (size_t i = 0; i < count; i++) {
        const struct mh_candidate *candidate = &candidates[i];
        const bool near = config->rule == MH_ELECTION_SACX ? mh_place_within(&candidate->place, &cluster->head.place,
                                                                             millimetres(config->radio_range_m))
                                                           : covers(way, MH_REAL(1.0f), &candidate->place);
        if (candidate->id == cluster->head.id || !near) {
            continue;
        }
        mh_wide cost;
        const struct mh_member member = rank_ahead(config, way, candidate, &cost);
        if (config->rule == MH_ELECTION_RHO || member.last != 0) {
            add(&list, &member, cost);
        }
    }
}

/* The nodes that detect, those nearest to `about` first. */
static void choose_detecting(const struct mh_candidate *candidates, size_t count, uint8_t limit,
                             const struct mh_place *about, struct mh_cluster *cluster)
{
    struct list list;
    list.cluster = cluster;
    list.limit = limit;
    cluster->count = 0;
    for (size_t i = 0; i < count; i++) {
        if (candidates[i].detects && candidates[i].id != cluster->head.id) {
            const struct mh_member member = {candidates[i].id, candidates[i].place, 0, 0};
            add(&list, &member, mh_vec2_square(mh_place_relative(&candidates[i].place, about)));
        }
    }
}

/* Of those that detect, the one nearest to `about`; NULL if there is none. */
static const struct mh_candidate *nearest_detecting(const struct mh_candidate *candidates, size_t count,
                                                    const struct mh_place *about)
{
    const struct mh_candidate *nearest = NULL;
    mh_wide least = 0;
    for (size_t i = 0; i < count; i++) {
        const mh_wide square = mh_vec2_square(mh_place_relative(&candidates[i].place, about));
        if (candidates[i].detects &&
            (nearest == NULL || square < least || (!(square > least) && candidates[i].id < nearest->id))) {
            nearest = &candidates[i];
            least = square;
        }
    }
    return nearest;
}

enum mh_status mh_elect_first(const struct mh_election_config *config, const struct mh_place *about,
                              const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster)
{
    const struct mh_candidate *head = nearest_detecting(candidates, count, about);
    if (head == NULL) {
        return MH_NONE;
    }
    const struct mh_member member = {head->id, head->place, 0, 0};
    cluster->head = member;
    choose_detecting(candidates, count, takes_all_that_detect(config->rule) ? MH_CLUSTER_MAX : config->members,
                     &head->place, cluster);
    return MH_OK;
}

static bool due_by_detection(enum mh_election rule, const struct mh_candidate *candidates, size_t count,
                             const struct mh_candidate *nearest, const struct mh_cluster *cluster)
{
    if (rule == MH_ELECTION_SCM_NEAR) {
        return nearest->id != cluster->head.id;
    }
    bool head_detects = false;
    uint8_t known = 0; /* nodes of the cluster that detect */
    for (size_t i = 0; i < count; i++) {
        if (candidates[i].detects) {
            if (mh_cluster_find(cluster, candidates[i].id) == NULL) {
                return true;
            }
            known++;
            head_detects = head_detects || candidates[i].id == cluster->head.id;
        }
    }
    return !head_detects || (rule == MH_ELECTION_SCM_SET && known < cluster->count + 1);
}

static enum mh_status elect_by_detection(const struct mh_election_config *config, const struct mh_estimate *estimate,
                                         const struct mh_candidate *candidates, size_t count,
                                         struct mh_cluster *cluster)
{
    const struct mh_place about = mh_place_from_offset(&estimate->origin, estimate->position);
    const struct mh_candidate *nearest = nearest_detecting(candidates, count, &about);
    if (nearest == NULL || !due_by_detection(config->rule, candidates, count, nearest, cluster)) {
        return MH_NONE;
    }
    const struct mh_member head = {nearest->id, nearest->place, 0, 0};
    cluster->head = head;
    choose_detecting(candidates, count, MH_CLUSTER_MAX, &about, cluster);
    return MH_OK;
}

/* A new cluster is due by the rules sac, sacx and rho. */
static bool due_ahead(const struct mh_election_config *config, const struct way *way,
                      const struct mh_candidate *candidates, size_t count, const struct mh_cluster *cluster)
{
    size_t answers = 0, replacements = 0;
    for (size_t i = 0; i < count; i++) {
        answers += candidates[i].detects;
        replacements += covers(way, MH_REAL(1.0f), &candidates[i].place);
    }
    if (replacements == 0) {
        return false;
    }
    if (!covers(way, MH_REAL(1.0f), &cluster->head.place)) {
        return true;
    }
    size_t covering = 1;
    for (uint8_t i = 0; i < cluster->count; i++) {
        covering += covers(way, MH_REAL(1.0f), &cluster->members[i].place);
    }
    const size_t effective = answers < covering ? answers : covering;
    return effective < config->least_answers && replacements > effective;
}

/* rho: how well the candidate's place suits a head: 2, near the present head and in the sector ahead; 1, near it; 0. */
static uint8_t suits(const struct way *way, const struct mh_candidate *candidate, const struct mh_place *head)
{
    if (!mh_place_within(&candidate->place, head, millimetres(way->sensing))) {
        return 0;
    }
    const struct mh_vec2 d = from_prediction(way, 0, &candidate->place);
    const mh_wide ahead = mh_vec2_dot(d, way->step);
    const mh_real along = way->step_length > 0 ? mh_wide_div(ahead, way->step_length) : 0;
    const bool in_sector =
        !(way->step_length > 0) ||
        (ahead >= 0 && 2 * mh_wide_mul(along, along) >= mh_vec2_square(d)); /* cos2 of 45 degrees is 1/2 */
    return in_sector ? 2 : 1;
}

/* The next head, of those that cover the target's next place; the present one if there is none. A function of its own: what it compares is off the stack
 * before members are chosen. */
static void choose_head(const struct mh_election_config *config, const struct way *way,
                        const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster)
{
    struct mh_member head = cluster->head;
    mh_wide least = 0;
    uint8_t best_suits = 0;
    bool found = false;
    for (size_t i = 0; i < count; i++) {
        if (!covers(way, MH_REAL(1.0f), &candidates[i].place)) {
            continue;
        }
        mh_wide cost;
        const struct mh_member member = rank_ahead(config, way, &candidates[i], &cost);
        const uint8_t how = config->rule == MH_ELECTION_RHO ? suits(way, &candidates[i], &cluster->head.place) : 0;
        if (!found || how > best_suits || (how == best_suits && better(&member, cost, &head, least))) {
            found = true;
            head = member;
            least = cost;
            best_suits = how;
        }
    }
    cluster->head = head;
}

static enum mh_status elect_ahead(const struct mh_election_config *config, const struct way *way,
                                  const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster)
{
    if (!due_ahead(config, way, candidates, count, cluster)) {
        return MH_NONE;
    }
    choose_head(config, way, candidates, count, cluster);
    choose_ahead(config, way, candidates, count, cluster);
    return MH_OK;
}

enum mh_status mh_elect(const struct mh_election_config *config, const struct mh_estimate *estimate,
                        const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster)
{
    struct way way;
    const bool own = config->rule == MH_ELECTION_SACX;
    const enum mh_status status =
        make_way(&way, config, &estimate->origin, &estimate->position, own ? &estimate->position : &estimate->stored,
                 own ? &estimate->velocity : &estimate->stored_velocity);
    if (status != MH_OK) {
        return status;
    }
    return takes_all_that_detect(config->rule) ? elect_by_detection(config, estimate, candidates, count, cluster)
                                               : elect_ahead(config, &way, candidates, count, cluster);
}

enum mh_status mh_elect_members(const struct mh_election_config *config, const struct mh_place *origin,
                                const struct mh_vec2 *position, const struct mh_vec2 *velocity,
                                const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster)
{
    struct way way;
    const enum mh_status status = make_way(&way, config, origin, position, position, velocity);
    if (status == MH_OK && config->rule == MH_ELECTION_SACX) {
        choose_ahead(config, &way, candidates, count, cluster);
    }
    return status;
}
