/* lcm-gen's T_encode and T_decode keep the type's fingerprint in a static variable. Its functions one level below, which the
 * generated code itself uses for nested types, touch nothing but their arguments. */
#include "motehound/bytes.h"
#include "motehound/wire.h"

#include <stdbool.h>

static bool valid(int32_t x_mm, int32_t y_mm) { return mh_coordinate_valid(x_mm) && mh_coordinate_valid(y_mm); }

static bool beacon_sound(const mh_beacon_t *beacon)
{
    return beacon->sender != -1 && beacon->hops <= MH_HOPS_MAX && beacon->tracking <= 1;
}

static bool report_sound(const mh_report_t *report)
{
    return report->sender != -1 && report->origin != -1 && report->hops <= MH_HOPS_MAX &&
           valid(report->x_mm, report->y_mm) && mh_coordinate_valid(report->z_mm);
}

static bool request_sound(const mh_request_t *request)
{
    return request->sender != -1 && request->origin != -1 && request->hops <= MH_HOPS_MAX && request->radius_mm >= 0 &&
           valid(request->x_mm, request->y_mm) && valid(request->sender_x_mm, request->sender_y_mm);
}

static bool hello_sound(const mh_hello_t *hello) { return hello->sender != -1 && valid(hello->x_mm, hello->y_mm); }

static bool landmark_sound(const mh_landmark_t *landmark)
{
    return beacon_sound(&landmark->beacon) && valid(landmark->x_mm, landmark->y_mm);
}

static bool sync_sound(const mh_sync_t *sync) { return sync->sender != -1 && sync->root != -1 && sync->stamped <= 1; }

static bool ask_sound(const mh_ask_t *ask)
{
    return ask->sender != -1 && ask->track != -1 && ask->everyone <= 1 && valid(ask->x_mm, ask->y_mm) &&
           valid(ask->vx_mmps, ask->vy_mmps);
}

static bool answer_sound(const mh_answer_t *answer)
{
    return answer->sender != -1 && valid(answer->x_mm, answer->y_mm) && mh_coordinate_valid(answer->z_mm);
}

static bool form_sound(const mh_form_t *form)
{
    bool sound = form->sender != -1 && form->track != -1 && form->count <= MH_FORM_MEMBERS;
    for (uint8_t i = 0; sound && i < MH_FORM_MEMBERS; i++) {
        sound = (form->members[i] == -1) == (i >= form->count);
    }
    return sound;
}

static bool join_sound(const mh_join_t *join) { return join->sender != -1 && join->track != -1; }

/* The rest of data[0 .. room) is 0. */
static bool data_sound(const uint8_t *data, uint8_t length, uint8_t room)
{
    bool sound = length <= room;
    for (uint8_t i = length; sound && i < room; i++) {
        sound = data[i] == 0;
    }
    return sound;
}

static bool hand_over_sound(const mh_hand_over_t *part)
{
    return part->track != -1 && part->part < part->parts && data_sound(part->data, part->length, MH_HAND_OVER_BYTES);
}

static bool alert_sound(const mh_alert_t *alert)
{
    return alert->sender != -1 && alert->track != -1 && alert->lost <= 1 && alert->hops <= MH_HOPS_MAX &&
           valid(alert->x_mm, alert->y_mm);
}

static bool position_sound(const mh_position_t *position)
{
    return position->origin != -1 && position->track != -1 && valid(position->x_mm, position->y_mm) &&
           valid(position->vx_mmps, position->vy_mmps);
}

static bool vicinity_sound(const mh_vicinity_t *vicinity)
{
    bool sound = vicinity->sender != -1 && vicinity->count <= MH_VICINITY_NODES;
    for (uint8_t i = 0; sound && i < MH_VICINITY_NODES; i++) {
        const bool told = i < vicinity->count, at_zero = vicinity->x_mm[i] == 0 && vicinity->y_mm[i] == 0;
        sound = (vicinity->id[i] != -1) == told && (told || at_zero) && valid(vicinity->x_mm[i], vicinity->y_mm[i]);
    }
    return sound;
}

static bool token_sound(const mh_token_t *token)
{
    return token->sender != -1 && token->track != -1 && token->state <= MH_SEARCH_EXHAUSTED;
}

static bool finite_reals(const uint8_t *bytes, uint8_t count)
{
    bool finite = true;
    for (uint8_t i = 0; finite && i < count; i++) {
        finite = mh_finite(mh_get_real(&bytes));
    }
    return finite;
}

static bool leak_sound(const mh_leak_t *leak)
{
    return leak->track != -1 && valid(leak->head_x_mm, leak->head_y_mm) && valid(leak->x_mm, leak->y_mm) &&
           finite_reals(leak->rate, 1) && finite_reals(leak->spread, 6) && leak->state <= MH_SEARCH_EXHAUSTED;
}

static bool lead_sound(const mh_lead_t *lead)
{
    return lead->sender != -1 && lead->cluster != MH_CLUSTER_NONE &&
           data_sound(lead->data, lead->length, MH_LEAD_BYTES);
}

static bool taken_sound(const mh_taken_t *taken) { return taken->cluster != MH_CLUSTER_NONE; }

static bool awake_sound(const mh_awake_t *awake)
{
    const uint8_t first = awake->length < MH_AWAKE_BYTES ? awake->length : MH_AWAKE_BYTES;
    return awake->sender != -1 && valid(awake->x_mm, awake->y_mm) && awake->enters_cs >= 0 && awake->arms_cs >= 0 &&
           awake->extent_cm >= 0 && awake->members >= 1 && awake->members <= MH_GROUP_MAX &&
           awake->length <= 2 * MH_AWAKE_BYTES && data_sound(awake->data, first, MH_AWAKE_BYTES);
}

static bool rest_sound(const mh_rest_t *rest)
{
    return rest->sender != -1 && data_sound(rest->data, rest->length, MH_AWAKE_BYTES);
}

static bool locate_sound(const mh_locate_t *locate)
{
    return locate->sender != -1 && locate->kind <= MH_LOCATE_COMPETITION;
}

static bool sound_sound(const mh_sound_t *sound)
{
    return sound->sender != -1 && sound->asker != -1 && valid(sound->x_mm, sound->y_mm);
}

static bool fail_sound(const mh_fail_t *fail) { return fail->sender != -1 && valid(fail->x_mm, fail->y_mm); }

static bool succeed_sound(const mh_succeed_t *succeed) { return succeed->sender != -1; }

static bool compete_sound(const mh_compete_t *compete)
{
    return compete->sender != -1 && valid(compete->x_mm, compete->y_mm);
}

static bool detection_sound(const mh_detection_t *detection)
{
    return detection->sender != -1 && valid(detection->x_mm, detection->y_mm);
}

static bool suppress_sound(const mh_suppress_t *suppress) { return suppress->sender != -1 && suppress->released <= 1; }

static bool merge_sound(const mh_merge_t *merge)
{
    return merge->sender != -1 && merge->target != merge->other && merge->answers <= 1;
}

static bool route_sound(const mh_route_t *route)
{
    return route->sender != -1 && route->origin != -1 && route->hops >= 0 && route->hops <= MH_ROUTE_HOPS_MAX &&
           valid(route->x_mm, route->y_mm);
}

static bool face_sound(const mh_face_t *face)
{
    return route_sound(&face->route) && face->entry != -1 && face->first != -1 &&
           valid(face->sender_x_mm, face->sender_y_mm) && valid(face->entry_x_mm, face->entry_y_mm);
}

#define TYPE(name, of_kind, in_envelope, part)                                                                         \
    static int encode_##name(const struct mh_message *message, uint8_t *bytes, int room)                               \
    {                                                                                                                  \
        return __mh_##name##_t_encode_array(bytes, 0, room, &message->part, 1);                                        \
    }                                                                                                                  \
    static int decode_##name(struct mh_message *message, const uint8_t *bytes, int length)                             \
    {                                                                                                                  \
        const int taken = __mh_##name##_t_decode_array(bytes, 0, length, &message->part, 1);                           \
        return taken >= 0 && name##_sound(&message->part) ? taken : -1;                                                \
    }                                                                                                                  \
    const struct mh_wire_type mh_wire_##name = {of_kind, in_envelope, __mh_##name##_t_hash_recursive, encode_##name,   \
                                                decode_##name}

TYPE(beacon, MH_MESSAGE_BEACON, MH_ENVELOPE_NONE, as.beacon);
TYPE(report, MH_MESSAGE_REPORT, MH_ENVELOPE_NONE, as.report);
TYPE(request, MH_MESSAGE_REQUEST, MH_ENVELOPE_NONE, as.request);
TYPE(hello, MH_MESSAGE_HELLO, MH_ENVELOPE_NONE, as.hello);
TYPE(landmark, MH_MESSAGE_LANDMARK, MH_ENVELOPE_NONE, as.landmark);
TYPE(sync, MH_MESSAGE_SYNC, MH_ENVELOPE_NONE, as.sync);
TYPE(ask, MH_MESSAGE_ASK, MH_ENVELOPE_NONE, as.ask);
TYPE(answer, MH_MESSAGE_ANSWER, MH_ENVELOPE_NONE, as.answer);
TYPE(form, MH_MESSAGE_FORM, MH_ENVELOPE_NONE, as.form);
TYPE(join, MH_MESSAGE_JOIN, MH_ENVELOPE_NONE, as.join);
TYPE(hand_over, MH_MESSAGE_HAND_OVER, MH_ENVELOPE_NONE, as.hand_over);
TYPE(alert, MH_MESSAGE_ALERT, MH_ENVELOPE_NONE, as.alert);
TYPE(position, MH_MESSAGE_POSITION, MH_ENVELOPE_NONE, as.position);
TYPE(vicinity, MH_MESSAGE_VICINITY, MH_ENVELOPE_NONE, as.vicinity);
TYPE(token, MH_MESSAGE_TOKEN, MH_ENVELOPE_NONE, as.token);
TYPE(leak, MH_MESSAGE_LEAK, MH_ENVELOPE_NONE, as.leak);
TYPE(lead, MH_MESSAGE_LEAD, MH_ENVELOPE_NONE, as.lead);
TYPE(taken, MH_MESSAGE_TAKEN, MH_ENVELOPE_NONE, as.taken);
TYPE(awake, MH_MESSAGE_AWAKE, MH_ENVELOPE_NONE, as.awake);
TYPE(rest, MH_MESSAGE_REST, MH_ENVELOPE_NONE, as.rest);
TYPE(locate, MH_MESSAGE_LOCATE, MH_ENVELOPE_NONE, as.locate);
TYPE(sound, MH_MESSAGE_SOUND, MH_ENVELOPE_NONE, as.sound);
TYPE(fail, MH_MESSAGE_FAIL, MH_ENVELOPE_NONE, as.fail);
TYPE(succeed, MH_MESSAGE_SUCCEED, MH_ENVELOPE_NONE, as.succeed);
TYPE(compete, MH_MESSAGE_COMPETE, MH_ENVELOPE_NONE, as.compete);
TYPE(detection, MH_MESSAGE_DETECTION, MH_ENVELOPE_NONE, as.detection);
TYPE(suppress, MH_MESSAGE_SUPPRESS, MH_ENVELOPE_NONE, as.suppress);
TYPE(merge, MH_MESSAGE_MERGE, MH_ENVELOPE_NONE, as.merge);
TYPE(route, MH_MESSAGE_KINDS, MH_ENVELOPE_ROUTE, header.route);
TYPE(face, MH_MESSAGE_KINDS, MH_ENVELOPE_FACE, header);

mh_wire_types mh_wire_all[] = {&mh_wire_beacon,
                               &mh_wire_report,
                               &mh_wire_request,
                               &mh_wire_hello,
                               &mh_wire_landmark,
                               &mh_wire_sync,
                               &mh_wire_ask,
                               &mh_wire_answer,
                               &mh_wire_form,
                               &mh_wire_join,
                               &mh_wire_hand_over,
                               &mh_wire_alert,
                               &mh_wire_position,
                               &mh_wire_vicinity,
                               &mh_wire_token,
                               &mh_wire_leak,
                               &mh_wire_lead,
                               &mh_wire_taken,
                               &mh_wire_awake,
                               &mh_wire_rest,
                               &mh_wire_locate,
                               &mh_wire_sound,
                               &mh_wire_fail,
                               &mh_wire_succeed,
                               &mh_wire_compete,
                               &mh_wire_detection,
                               &mh_wire_suppress,
                               &mh_wire_merge,
                               &mh_wire_route,
                               &mh_wire_face,
                               NULL};
