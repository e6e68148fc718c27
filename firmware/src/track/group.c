#include "motehound/group.h"

#include "motehound/bytes.h"

void mh_group_config_default(struct mh_group_config *config, enum mh_group_mode mode)
{
    const bool weights = mode == MH_GROUP_WEIGHTS;
    *config = (struct mh_group_config){.mode = mode,
                                       .merge_m = weights ? MH_REAL(50.0f) : MH_REAL(20.0f),
                                       .split_m = weights ? MH_REAL(75.0f) : MH_REAL(30.0f),
                                       .merge_epochs = 2,
                                       .split_epochs = 3,
                                       .member_sd_m = MH_REAL(12.0f),
                                       .fix_sd_m = MH_REAL(2.5f),
                                       .extent_memory = MH_REAL(0.6f),
                                       .turn_sd_mps = MH_REAL(4.0f),
                                       .odds = MH_REAL(20.0f)};
}

enum mh_status mh_group_config_check(const struct mh_group_config *config)
{
    const bool valid = config->mode <= MH_GROUP_WEIGHTS && mh_within(config->merge_m, MH_REAL(1.0f), MH_REAL(60.0f)) &&
                       mh_within(config->split_m, config->merge_m, MH_REAL(120.0f)) && config->merge_epochs >= 1 &&
                       config->merge_epochs <= MH_GROUP_EPOCHS_MAX && config->split_epochs >= 1 &&
                       config->split_epochs <= MH_GROUP_EPOCHS_MAX &&
                       mh_within(config->member_sd_m, MH_REAL(0.1f), MH_REAL(100.0f)) &&
                       mh_within(config->fix_sd_m, MH_REAL(0.1f), MH_REAL(100.0f)) &&
                       mh_within(config->extent_memory, 0, MH_REAL(0.99f)) &&
                       mh_within(config->turn_sd_mps, MH_REAL(0.01f), MH_REAL(100.0f)) &&
                       mh_within(config->odds, MH_REAL(1.0f), MH_REAL_UPTO(1e6f));
    return valid ? MH_OK : MH_ERR_ARGUMENT;
}

void mh_group_single(struct mh_group *group, uint32_t target)
{
    *group = (struct mh_group){.targets = {{.target = target}}, .count = 1};
}

struct mh_vec2 mh_group_place(const struct mh_group *group, struct mh_vec2 centroid, uint8_t i)
{
    const struct mh_vec2 offset = mh_group_offset(&group->members[i]);
    return (struct mh_vec2){mh_add(centroid.x, offset.x), mh_add(centroid.y, offset.y)};
}

size_t mh_group_write(const struct mh_group *group, uint8_t *bytes)
{
    uint8_t *at = bytes;
    *at++ = (uint8_t)(group->count | (group->unresolved ? 0x80 : 0));
    *at++ = (uint8_t)(group->splits << 4 | group->merges);
    if (group->merges > 0) {
        mh_put_u32(&at, group->near);
    }
    if (group->count < 2) {
        return (size_t)(at - bytes);
    }
    mh_put_u16(&at, group->extent);
    for (uint8_t i = 0; i < group->count; i++) {
        const struct mh_group_target *target = &group->targets[i];
        if (i > 0) {
            mh_put_u32(&at, target->target);
        }
        *at++ = (uint8_t)target->vx;
        *at++ = (uint8_t)target->vy;
        mh_put_u16(&at, target->alone);
        *at++ = (uint8_t)group->members[i].x;
        *at++ = (uint8_t)group->members[i].y;
    }
    if (group->splits > 0) {
        *at++ = group->parts;
        mh_put_u16(&at, group->split_time);
        for (uint8_t i = 0; i < group->count; i++) {
            *at++ = (uint8_t)group->members[i].first_x;
            *at++ = (uint8_t)group->members[i].first_y;
        }
    }
    return (size_t)(at - bytes);
}

static int8_t get_i8(const uint8_t **at)
{
    const uint8_t bits = *(*at)++;
    return (int8_t)(bits > INT8_MAX ? bits - 256 : bits);
}

/* Bytes of a group with these first two. */
static size_t size_of(uint8_t count, uint8_t splits, uint8_t merges)
{
    size_t size = merges > 0 ? 6 : 2;
    if (count > 1) {
        size += 10u * count - 2u;
    }
    if (splits > 0) {
        size += 2u * count + 3u;
    }
    return size;
}

enum mh_status mh_group_read(struct mh_group *group, uint32_t target, const uint8_t *bytes, size_t length,
                             size_t *taken)
{
    if (length < 2) {
        return MH_ERR_CORRUPT;
    }
    const uint8_t *at = bytes + 2;
    struct mh_group read = {.count = (uint8_t)(bytes[0] & 0x7f),
                            .unresolved = (bytes[0] & 0x80) != 0,
                            .splits = (uint8_t)(bytes[1] >> 4),
                            .merges = (uint8_t)(bytes[1] & 15),
                            .targets = {{.target = target}}};
    if (read.count < 1 || read.count > MH_GROUP_MAX || (read.splits > 0 && (read.merges > 0 || read.count < 2)) ||
        length < size_of(read.count, read.splits, read.merges)) {
        return MH_ERR_CORRUPT;
    }
    bool valid = true;
    if (read.merges > 0) {
        read.near = mh_get_u32(&at);
    }
    if (read.count > 1) {
        read.extent = mh_get_u16(&at);
        for (uint8_t i = 0; i < read.count; i++) {
            struct mh_group_target *one = &read.targets[i];
            if (i > 0) {
                one->target = mh_get_u32(&at);
                valid = valid && one->target > read.targets[i - 1].target;
            }
            one->vx = get_i8(&at);
            one->vy = get_i8(&at);
            one->alone = mh_get_u16(&at);
            read.members[i].x = get_i8(&at);
            read.members[i].y = get_i8(&at);
            valid = valid && one->vy > INT8_MIN && read.members[i].x > INT8_MIN && read.members[i].y > INT8_MIN;
        }
    }
    if (read.splits > 0) {
        read.parts = *at++;
        read.split_time = mh_get_u16(&at);
        valid = valid && read.parts > 0 && read.parts < 1u << (read.count - 1);
        for (uint8_t i = 0; i < read.count; i++) {
            read.members[i].first_x = get_i8(&at);
            read.members[i].first_y = get_i8(&at);
            valid = valid && read.members[i].first_x > INT8_MIN && read.members[i].first_y > INT8_MIN;
        }
    }
    for (uint8_t i = 0; i < read.count; i++) {
        valid = valid && !(read.merges > 0 && read.near == read.targets[i].target);
    }
    if (!valid) {
        return MH_ERR_CORRUPT;
    }
    *group = read;
    *taken = (size_t)(at - bytes);
    return MH_OK;
}
