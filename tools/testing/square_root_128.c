/* The square root of 128 bits that programs by flang ask for, where its run-time library has none (scripts/check flang). */
#include <quadmath.h>

__float128 _FortranASqrtF128(__float128 x);

__float128 _FortranASqrtF128(__float128 x) { return sqrtq(x); }
