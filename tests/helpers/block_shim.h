// Lets a C++ compiler take kernels whose threads wait for each other: each is a fiber, and a block's take turns.
#include <ucontext.h>

#include <algorithm>
#include <cmath>
#include <vector>

using std::max;
using std::min;

#define __device__
#define __forceinline__ inline
#define __noinline__
#define __global__
#define __launch_bounds__(...)
#define __restrict__
#define __align__(n) alignas(n)

inline void sincosf(float x, float* s, float* c) { *s = std::sin(x), *c = std::cos(x); }
inline float __fdividef(float a, float b) { return a / b; }

struct float2 { float x, y; };
struct float4 { float x, y, z, w; };
struct uint3 { unsigned x, y, z; };
static uint3 threadIdx, blockIdx, blockDim;
static float* shared;
static ucontext_t scheduler;
static std::vector<ucontext_t> fibers;
static std::vector<bool> ended;
static void (*work)();

inline void __syncthreads() {
  const unsigned own = threadIdx.x;
  swapcontext(&fibers[own], &scheduler);
  threadIdx.x = own;
}

// All warps go through the same barriers, so one of a warp may as well be one of the block.
inline void __syncwarp() { __syncthreads(); }

inline float __shfl_xor_sync(unsigned, float value, int other) {
  static float all[1024];
  all[threadIdx.x] = value;
  __syncthreads();
  const float found = all[threadIdx.x ^ other];
  __syncthreads();
  return found;
}

static void fiber() {
  const unsigned own = threadIdx.x;
  work();
  ended[own] = true;
  swapcontext(&fibers[own], &scheduler);
}

// One block; all of its threads reach a barrier, or their end, before any goes on.
static void run_block(unsigned x, unsigned y, unsigned threads, int words, void (*kernel)()) {
  constexpr int STACK = 1 << 16;
  std::vector<float> memory(words, NAN);
  std::vector<char> stacks(size_t(threads) * STACK);
  blockIdx = {x, y, 0}, blockDim = {threads, 1, 1}, shared = memory.data(), work = kernel;
  fibers.assign(threads, ucontext_t{}), ended.assign(threads, false);
  for (unsigned i = 0; i < threads; ++i) {
    getcontext(&fibers[i]);
    fibers[i].uc_stack = {stacks.data() + size_t(i) * STACK, 0, STACK};
    makecontext(&fibers[i], fiber, 0);
  }
  while (!std::all_of(ended.begin(), ended.end(), [](bool x) { return x; }))
    for (unsigned i = 0; i < threads; ++i)
      if (!ended[i]) {
        threadIdx = {i, 0, 0};
        swapcontext(&scheduler, &fibers[i]);
      }
}
