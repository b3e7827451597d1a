// Lets a C++ compiler take cast.cu with warps of 32 lanes, a block each: lanes are fibers, and meet wherever a warp acts
// as one. Where some lanes come there and others elsewhere, or to their end, the program stops.
#include <ucontext.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#define WARP_SIZE 32
#include "cuda_shim.h"

enum Meeting { ENDED, LEAST, MOST, BALLOT };

static ucontext_t scheduler, lanes[WARP_SIZE];
static Meeting meeting[WARP_SIZE];
static float given[WARP_SIZE], told[WARP_SIZE];
static void (*work)();

// Gives a number to the warp; once it returns, all lanes' are told.
inline void meet(Meeting kind, float x) {
  const unsigned own = threadIdx.x;
  meeting[own] = kind, given[own] = x;
  swapcontext(&lanes[own], &scheduler);
  threadIdx.x = own;
}

inline float warp_min(float x) {
  meet(LEAST, x);
  return *std::min_element(told, told + WARP_SIZE);
}

inline float warp_max(float x) {
  meet(MOST, x);
  return *std::max_element(told, told + WARP_SIZE);
}

inline unsigned warp_ballot(bool x) {
  meet(BALLOT, x);
  unsigned votes = 0;
  for (int i = 0; i < WARP_SIZE; ++i) votes |= unsigned(told[i] != 0) << i;
  return votes;
}

static void lane() {
  work();
  meet(ENDED, 0);
}

// One warp, until all of its lanes have ended
static void run_warp(unsigned x, unsigned y, void (*kernel)()) {
  constexpr int STACK = 1 << 16;
  std::vector<char> stacks(size_t(WARP_SIZE) * STACK);
  blockIdx = {x, y, 0}, work = kernel;
  for (int i = 0; i < WARP_SIZE; ++i) {
    getcontext(&lanes[i]);
    lanes[i].uc_stack = {stacks.data() + size_t(i) * STACK, 0, STACK};
    makecontext(&lanes[i], lane, 0);
  }
  do {
    for (unsigned i = 0; i < WARP_SIZE; ++i) {
      threadIdx = {i, 0, 0};
      swapcontext(&scheduler, &lanes[i]);
    }
    for (int i = 0; i < WARP_SIZE; ++i) {
      if (meeting[i] != meeting[0]) fprintf(stderr, "lanes 0 and %d have parted\n", i), abort();
      told[i] = given[i];
    }
  } while (meeting[0] != ENDED);
}
