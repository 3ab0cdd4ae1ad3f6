// What lets one header be GLSL and C++. Shared headers hold 32-bit scalars, arrays of them, and plain functions.
#ifndef LIMN_SHARED_INTEROP_H
#define LIMN_SHARED_INTEROP_H

#ifdef __cplusplus
#include <cmath>
#include <cstdint>
#include <type_traits>
#define LIMN_SHARED_BEGIN \
    namespace limn::shared { \
    using uint = uint32_t;
#define LIMN_SHARED_END }
#define LIMN_FN inline
#define LIMN_OUT_ARRAY(T, name, n) T (&name)[n]
#define LIMN_INOUT(T) T&
#define LIMN_INOUT_ARRAY(T, name, n) T (&name)[n]
namespace limn::shared {
using real = double;  // the CPU reference; kernels compute in float
using std::sqrt;
inline bool is_finite_number(real x) {
    return std::isfinite(x);
}
}
/// Fails to compile unless C++ lays T out in `bytes` bytes of 32-bit members, as std430 does.
#define LIMN_LAYOUT(T, bytes) \
    static_assert(sizeof(T) == bytes && alignof(T) == 4 && std::is_trivially_copyable_v<T>);
#else
#define LIMN_SHARED_BEGIN
#define LIMN_SHARED_END
#define LIMN_FN
#define LIMN_OUT_ARRAY(T, name, n) out T name[n]
#define LIMN_INOUT(T) inout T
#define LIMN_INOUT_ARRAY(T, name, n) inout T name[n]
#define real float
#define LIMN_LAYOUT(T, bytes)
// By its bits: compilers of shaders may take it that no number is NaN.
bool is_finite_number(float x) {
    return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u;
}
#endif

#endif
