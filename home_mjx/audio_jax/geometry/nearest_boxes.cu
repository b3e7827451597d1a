// Boxes over which the path from source to listener is shortest, see `nearest_boxes.py`; a block per environment.

constexpr int THREADS = 256, WARP = 32;               // as in nearest_boxes.py
constexpr int FIELDS = 15;                            // values per box, as in box_lengths.py
constexpr int STEPS = 3;                              // projections onto segment and box, as in box_lengths.py
constexpr float MIN_SQUARE = 1e-4f;                   // [m²], minimum squared distance of source and listener
constexpr float WITHOUT_EDGES = 3.0e38f, TAKEN = 3.2e38f;  // as lengths

struct Ends {
  float source[3], listener[3], way[3], inverse;
};

// Length [m] of the path over box i of `count` boxes whose fields are rows: centre, axes row by row, half sizes.
__device__ float path_length(const float* boxes, int count, int i, const Ends& ends) {
  float axis[9], center[3], half[3], place[3];
#pragma unroll
  for (int k = 0; k < 3; ++k) center[k] = place[k] = boxes[k * count + i], half[k] = boxes[(12 + k) * count + i];
#pragma unroll
  for (int k = 0; k < 9; ++k) axis[k] = boxes[(3 + k) * count + i];
#pragma unroll
  for (int step = 0; step < STEPS; ++step) {
    float share = 0.0f, offset[3];
#pragma unroll
    for (int k = 0; k < 3; ++k) share += (place[k] - ends.source[k]) * ends.way[k];
    share = fminf(fmaxf(share * ends.inverse, 0.0f), 1.0f);
#pragma unroll
    for (int k = 0; k < 3; ++k) offset[k] = ends.source[k] + share * ends.way[k] - center[k], place[k] = center[k];
#pragma unroll
    for (int row = 0; row < 3; ++row) {
      float local = 0.0f;
#pragma unroll
      for (int k = 0; k < 3; ++k) local += axis[3 * row + k] * offset[k];
      local = fminf(fmaxf(local, -half[row]), half[row]);
#pragma unroll
      for (int k = 0; k < 3; ++k) place[k] += axis[3 * row + k] * local;
    }
  }
  float square[2] = {0.0f, 0.0f};
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    square[0] += (place[k] - ends.source[k]) * (place[k] - ends.source[k]);
    square[1] += (place[k] - ends.listener[k]) * (place[k] - ends.listener[k]);
  }
  return sqrtf(square[0]) + sqrtf(square[1]);
}

extern "C" __global__ void __launch_bounds__(THREADS) nearest_boxes(
    const float* __restrict__ fixed,      // (houses, FIELDS, fixed boxes)
    const int* __restrict__ fixed_owner,  // (houses, fixed boxes): object, -1 architecture, -2 without exposed edges
    const int* __restrict__ houses,       // (environments)
    const float* __restrict__ moving,     // (environments, FIELDS, moving boxes)
    const int* __restrict__ moving_owner, // (environments, moving boxes)
    const float* __restrict__ points,     // (environments, 6): source, listener
    const int* __restrict__ bodies,       // (environments, 2): objects whose boxes do not count; -1 none
    const int* __restrict__ sizes,        // fixed boxes, moving boxes, results
    int* __restrict__ nearest) {          // (environments, results): shortest first
  extern __shared__ float shared[];
  const int num_fixed = sizes[0], all = num_fixed + sizes[1], results = sizes[2], env = blockIdx.x;
  float *lengths = shared, *least = shared + all, *where = least + THREADS / WARP;  // a value per box, two per warp
  Ends ends;
  float square = 0.0f;
  for (int k = 0; k < 3; ++k) {
    ends.source[k] = points[env * 6 + k], ends.listener[k] = points[env * 6 + 3 + k];
    ends.way[k] = ends.listener[k] - ends.source[k], square += ends.way[k] * ends.way[k];
  }
  ends.inverse = 1.0f / fmaxf(square, MIN_SQUARE);
  const size_t house = houses[env];
  float best = TAKEN;
  int index = 0;
  for (int i = threadIdx.x; i < all; i += THREADS) {
    const bool is_fixed = i < num_fixed;
    const int place = is_fixed ? i : i - num_fixed, count = is_fixed ? num_fixed : sizes[1];
    const size_t group = is_fixed ? house : env;
    const int owner = (is_fixed ? fixed_owner : moving_owner)[group * count + place];
    const bool own = owner >= 0 && (owner == bodies[env * 2] || owner == bodies[env * 2 + 1]);
    const float* boxes = (is_fixed ? fixed : moving) + group * FIELDS * count;
    const float length = owner < -1 || own ? WITHOUT_EDGES : path_length(boxes, count, place, ends);
    lengths[i] = length;
    if (length < best) best = length, index = i;
  }
  for (int n = 0; n < results; ++n) {
    float value = best, at = float(index);  // indices are exact up to 2^24
    for (int other = WARP / 2; other > 0; other /= 2) {
      const float next = __shfl_xor_sync(0xffffffffu, value, other), from = __shfl_xor_sync(0xffffffffu, at, other);
      if (next < value || (next == value && from < at)) value = next, at = from;
    }
    if (threadIdx.x % WARP == 0) least[threadIdx.x / WARP] = value, where[threadIdx.x / WARP] = at;
    __syncthreads();
    for (int warp = 0; warp < THREADS / WARP; ++warp)
      if (warp == 0 || least[warp] < value || (least[warp] == value && where[warp] < at))
        value = least[warp], at = where[warp];
    const int chosen = int(at);
    if (threadIdx.x == 0) nearest[env * results + n] = chosen;
    if (chosen % THREADS == threadIdx.x) {  // the only thread that reads and writes this length
      lengths[chosen] = best = TAKEN;
      for (int i = threadIdx.x; i < all; i += THREADS)
        if (lengths[i] < best) best = lengths[i], index = i;
    }
    __syncthreads();
  }
}
