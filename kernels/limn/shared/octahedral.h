// Unit vectors as two numbers in [-1, 1]: the octahedron |x| + |y| + |z| = 1 unfolded into a square (Cigolle et al., A
// Survey of Efficient Representations for Independent Unit Vectors, JCGT 2014). As two 16-bit signed normalised numbers
// (VK_FORMAT_R16G16_SNORM, the first in the low half of the word) they are off by 0.004 degrees at most.
#ifndef LIMN_SHARED_OCTAHEDRAL_H
#define LIMN_SHARED_OCTAHEDRAL_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

LIMN_FN real octahedral_abs(real x) {
    return x < real(0) ? -x : x;
}
// 1 - |y| with the sign of x: where what lies below the equator is folded to.
LIMN_FN real octahedral_fold(real x, real y) {
    const real folded = real(1) - octahedral_abs(y);
    return x < real(0) ? -folded : folded;
}

// Of any vector but zero, whatever its length.
LIMN_FN void octahedral_of(real x, real y, real z, LIMN_OUT_ARRAY(real, e, 2)) {
    const real scale = real(1) / (octahedral_abs(x) + octahedral_abs(y) + octahedral_abs(z));
    const real a = x * scale, b = y * scale;
    e[0] = z < real(0) ? octahedral_fold(a, b) : a;
    e[1] = z < real(0) ? octahedral_fold(b, a) : b;
}

// A vector along the one that (a, b) stands for, not of unit length.
LIMN_FN void octahedral_direction(real a, real b, LIMN_OUT_ARRAY(real, n, 3)) {
    n[2] = real(1) - octahedral_abs(a) - octahedral_abs(b);
    n[0] = n[2] < real(0) ? octahedral_fold(a, b) : a;
    n[1] = n[2] < real(0) ? octahedral_fold(b, a) : b;
}

LIMN_SHARED_END
#endif
