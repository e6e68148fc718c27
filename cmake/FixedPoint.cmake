# What there is in fixed point (MH_REAL=fixed): sources under firmware/src, and unit tests under tests/unit/firmware. All else needs float.
set(MOTEHOUND_FIXED_POINT_SOURCES
  base/geometry base/real_fixed
)
set(MOTEHOUND_FIXED_POINT_TESTS
  test_real_fixed
)
