#include "motehound/circles.h"
#include "motehound/distance_table.h"
#include "self_test_parts.h"

/* An energy of 1.5 at R = 40 m lies in the ninth of ten intervals, for (10/9)^2 < 1.5 < (10/8)^2; circles of 5 m about (0, 0) and 3 m about (12, 0) have a gap from 5 to 9 m */
bool self_test_distances(void)
{
    static const struct mh_distance_table table = {MH_REAL(40.0f), 10, MH_DISTANCE_MIDDLE};
    static const struct mh_circle a = {{0, 0}, MH_REAL(5.0f)}, b = {{MH_REAL(12.0f), 0}, MH_REAL(3.0f)};
    const struct mh_vec2 point = mh_two_circles(&a, &b);
    return self_test_node() && near(mh_distance(&table, MH_REAL(1.5f)), MH_REAL(34.0f)) &&
           near(point.x, MH_REAL(7.0f)) && near(point.y, 0);
}
