// Lets a C++ compiler take cast.cu for a CPU: warps and blocks of one thread, no fused arithmetic. See also warp_shim.h.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>

using std::max;
using std::min;

#ifndef WARP_SIZE
#define WARP_SIZE 1
#endif
#define __device__
#define __forceinline__ inline
#define __global__
#define __launch_bounds__(...)
#define __restrict__

struct float2 { float x, y; };
struct float3 { float x, y, z; };
struct float4 { float x, y, z, w; };
struct int2 { int x, y; };
struct int4 { int x, y, z, w; };
struct uint3 { unsigned x, y, z; };
static thread_local uint3 threadIdx, blockIdx, gridDim;

inline float3 make_float3(float x, float y, float z) { return {x, y, z}; }
inline int2 make_int2(int x, int y) { return {x, y}; }
template <class T> inline T __ldg(const T* p) { return *p; }
inline float __fadd_rn(float a, float b) { return a + b; }
inline float __fsub_rn(float a, float b) { return a - b; }
inline float __fmul_rn(float a, float b) { return a * b; }
inline float __fdiv_rn(float a, float b) { return a / b; }
inline int __float_as_int(float x) { int y; std::memcpy(&y, &x, 4); return y; }
inline float __int_as_float(int x) { float y; std::memcpy(&y, &x, 4); return y; }
inline int __ffs(unsigned x) { return __builtin_ffs(int(x)); }
inline int __clz(int x) { return x ? __builtin_clz(unsigned(x)) : 32; }
inline float rsqrtf(float x) { return 1 / std::sqrt(x); }
inline float __powf(float x, float y) { return std::pow(x, y); }
inline float fast_reciprocal(float x) { return 1 / x; }
#if WARP_SIZE == 1
inline float warp_min(float x) { return x; }
inline float warp_max(float x) { return x; }
inline unsigned warp_ballot(bool x) { return x; }
#endif

using Place = int2*;
inline Place place_of(int2* entry) { return entry; }
inline Place shift(Place place, int entries) { return place + entries; }
inline void put(Place place, int2 x) { *place = x; }
inline int2 get(Place place) { return *place; }
