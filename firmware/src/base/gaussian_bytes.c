#include "motehound/bytes.h"
#include "motehound/gaussian.h"

#include <string.h>

size_t mh_gaussian_write(const struct mh_gaussian *gaussian, uint8_t *bytes)
{
    const uint8_t n = gaussian->n;
    uint8_t *at = bytes;
    for (uint_fast8_t i = 0; i < n; i++) {
        mh_put_real(&at, gaussian->x[i]);
    }
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        mh_put_real(&at, gaussian->P[i]);
    }
    return (size_t)MH_GAUSSIAN_BYTES(n);
}

enum mh_status mh_gaussian_read(struct mh_gaussian *gaussian, uint8_t n, const uint8_t *bytes)
{
    if (n < 1 || n > MH_STATES_MAX) {
        return MH_ERR_CORRUPT;
    }
    struct mh_gaussian told;
    const uint8_t *at = bytes;
    told.n = n;
    for (uint_fast8_t i = 0; i < n; i++) {
        told.x[i] = mh_get_real(&at);
    }
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        told.P[i] = mh_get_real(&at);
    }
    if (mh_gaussian_check(&told) != MH_OK) {
        return MH_ERR_CORRUPT;
    }
    memcpy(gaussian->x, told.x, n * sizeof told.x[0]);
    memcpy(gaussian->P, told.P, mh_packed_size(n) * sizeof told.P[0]);
    gaussian->n = n;
    return MH_OK;
}
