// Lets a C++ compiler take the fused step's CUDA C for a CPU: warps of one thread, in double precision.
#include <cmath>
#include <cstring>
#include <cstddef>
#define WARP_SIZE 1
#define __device__
#define __forceinline__ inline
#define __noinline__
#define __global__
#define __launch_bounds__(...)
#define LANE 0
typedef double real;
constexpr real LINE_SEARCH_TOLERANCE = 1e-9, NEWTON_TOLERANCE = 1e-22, MIN_PIVOT = 1e-12, MIN_CROSS_LENGTH = 1e-15, MAX_EDGE_OVERLAP_RATIO = 1 - 1e-12, TINY = 1e-15;
inline void sync_warp() {}
inline unsigned warp_ballot(bool x) { return x; }
inline int count_bits(unsigned x) { return __builtin_popcount(x); }
inline unsigned warp_alike(int) { return 1; }
inline int from_lane(int x, int) { return x; }
inline real from_lane(real x, int) { return x; }
inline real warp_sum(real x) { return x; }
static double shared_doubles[1 << 14];
inline real* shared_memory() { return shared_doubles; }
struct uint3_ { unsigned x, y, z; };
static uint3_ blockIdx;
using std::fabs; using std::sqrt; using std::sin; using std::cos; using std::fmin; using std::fmax;
