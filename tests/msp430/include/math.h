/* What the library uses of math.h, for a compiler that comes without a C library. */
#ifndef MATH_H
#define MATH_H

#define INFINITY __builtin_inff()
#define isfinite(x) __builtin_isfinite(x)

float sqrtf(float);
float expf(float);
float logf(float);
float atan2f(float, float);
float fabsf(float);
float floorf(float);
float cosf(float);
float sinf(float);
float powf(float, float);

#endif
