// Energy decay in the coupled rooms of a house, see `coupled_decay.py`.
//
// ROOMS (number of rooms, padding included) and MAX_ELEMENTS (matrix elements in a thread's registers) are compile-time
// definitions. A block computes matrices of one environment, at the smallest of a few sizes that holds the
// rooms of its house. A matrix in shared memory is multiplied in place by a matrix of which each of LANES threads holds
// some columns in registers. Energy after a n + b bins is the product of a row, the listener's weights propagated by b
// steps, and a column, the start propagated by a n steps. So only a few steps depend on each other. n is RUN.

constexpr int THREADS = 32;
constexpr int TERMS = 6, HALVINGS = 3;                // as in room_matrices.py: terms of the exponential series, halvings of its step
constexpr int DOUBLINGS = 3, RUN = 1 << DOUBLINGS;    // as in coupled_decay.py

// Threads per matrix, as `threads_per_matrix` in coupled_decay.py.
__device__ constexpr int lanes_of(int size) {
  int lanes = 1;
  while (size * ((size + lanes - 1) / lanes) > MAX_ELEMENTS && lanes < THREADS) lanes *= 2;
  return lanes;
}

// A thread's part of one matrix.
template <int SIZE>
struct Part {
  static constexpr int LANES = lanes_of(SIZE), SLOTS = THREADS / LANES;  // threads per matrix, matrices per block
  static constexpr int PITCH = SLOTS + 1;                   // stride between elements of a matrix; odd, against bank conflicts
  static constexpr int OWN = (SIZE + LANES - 1) / LANES;    // columns per thread
  float* matrix;         // of its slot: element (i, k) is matrix[(i * SIZE + k) * PITCH]
  int lane;              // index among the threads of its matrix
  float own[SIZE][OWN];  // columns lane, lane + LANES, ... of another matrix; 0 beyond the last

  // Makes writes visible to all threads of a matrix, which belong to one warp.
  static __device__ __forceinline__ void together() {
    if constexpr (LANES > 1) __syncwarp();
  }

  __device__ __forceinline__ void take() {
#pragma unroll
    for (int k = 0; k < SIZE; ++k)
#pragma unroll
      for (int c = 0; c < OWN; ++c) own[k][c] = inside(c) ? matrix[(k * SIZE + column(c)) * PITCH] : 0.0f;
    together();
  }

  __device__ __forceinline__ int column(int c) const { return c * LANES + lane; }
  __device__ __forceinline__ bool inside(int c) const { return SIZE % LANES == 0 || column(c) < SIZE; }

  // Multiplies a row by `own`; each thread gets its own columns of the product.
  __device__ __forceinline__ void product(float* sum, const float* row) const {
#pragma unroll
    for (int c = 0; c < OWN; ++c) sum[c] = 0.0f;
#pragma unroll
    for (int k = 0; k < SIZE; ++k) {
      const float one = row[k * PITCH];
#pragma unroll
      for (int c = 0; c < OWN; ++c) sum[c] += one * own[k][c];
    }
  }

  __device__ __forceinline__ void put(float* row, const float* values) const {
#pragma unroll
    for (int c = 0; c < OWN; ++c)
      if (inside(c)) row[column(c) * PITCH] = values[c];
  }

  // matrix = unit + scale * matrix * own.
  __device__ __forceinline__ void multiply(float unit, float scale) {
#pragma unroll 1
    for (int i = 0; i < SIZE; ++i) {
      float sum[OWN];
      float* row = matrix + i * SIZE * PITCH;
      product(sum, row);
      together();
#pragma unroll
      for (int c = 0; c < OWN; ++c) sum[c] = scale * sum[c] + (column(c) == i ? unit : 0.0f);
      put(row, sum);
    }
    together();
  }

  __device__ __forceinline__ void square() {
    take();
    multiply(0.0f, 1.0f);
  }

  // Multiplies `own` by a column in place; each thread holds the whole column.
  __device__ __forceinline__ void apply(float* column_values) const {
    float sum[SIZE];
#pragma unroll
    for (int k = 0; k < SIZE; ++k) {
      sum[k] = 0.0f;
#pragma unroll
      for (int c = 0; c < OWN; ++c) sum[k] += own[k][c] * value_at(column_values, c);
    }
#pragma unroll
    for (int k = 0; k < SIZE; ++k) {
#pragma unroll
      for (int other = LANES / 2; other > 0; other /= 2) sum[k] += __shfl_xor_sync(0xffffffffu, sum[k], other);
      column_values[k] = sum[k];
    }
  }

  // Selects the value of this thread's column c without a run-time index: registers cannot be indexed.
  __device__ __forceinline__ float value_at(const float* values, int c) const {
    float found = 0.0f;
#pragma unroll
    for (int l = 0; l < LANES; ++l)
      if (c * LANES + l < SIZE && l == lane) found = values[c * LANES + l];
    return found;
  }
};

template <int SIZE>
__device__ void decay(int env, int group, int matrices, const float* __restrict__ rates, const float* __restrict__ starts,
                      const float* __restrict__ listeners, int octaves, int bins, float* __restrict__ heard, float* shared) {
  constexpr int LANES = Part<SIZE>::LANES, SLOTS = Part<SIZE>::SLOTS, PITCH = Part<SIZE>::PITCH, OWN = Part<SIZE>::OWN;
  const int first = group * SLOTS, slot = threadIdx.x / LANES;
  if (first >= matrices) return;
  const int number = min(first + slot, matrices - 1);  // threads beyond the last matrix repeat it
  Part<SIZE> part;
  part.matrix = shared + slot, part.lane = threadIdx.x % LANES;
  for (int i = threadIdx.x; i < SLOTS * SIZE * SIZE; i += THREADS) {
    const int at = i / (SIZE * SIZE), place = i % (SIZE * SIZE);
    const size_t row = (size_t(env) * matrices + min(first + at, matrices - 1)) * ROOMS + place / SIZE;
    shared[place * PITCH + at] = rates[row * ROOMS + place % SIZE] * (-1.0f / (1 << HALVINGS));
  }
  __syncthreads();
  part.take();
  for (int i = part.lane; i < SIZE * SIZE; i += LANES) {  // Horner's scheme, from the last term of the series
    float& value = part.matrix[i * PITCH];
    value = value * (1.0f / (TERMS - 1)) + (i % (SIZE + 1) == 0 ? 1.0f : 0.0f);
  }
  part.together();
  for (int n = TERMS - 2; n > 0; --n) part.multiply(1.0f, 1.0f / float(n));
  for (int n = 0; n < HALVINGS; ++n) part.square();

  const int state = number / octaves, octave = number % octaves;
  float* rows = part.matrix + SIZE * SIZE * PITCH;  // RUN rows
  for (int k = part.lane; k < SIZE; k += LANES) rows[k * PITCH] = listeners[env * ROOMS + k];
  part.take();
#pragma unroll 1
  for (int b = 1; b < RUN; ++b) {
    float sum[OWN];
    part.product(sum, rows + (b - 1) * SIZE * PITCH);
    part.put(rows + b * SIZE * PITCH, sum);
    part.together();
  }
  for (int n = 0; n < DOUBLINGS; ++n) part.square();
  part.take();
  float now[SIZE];
#pragma unroll
  for (int k = 0; k < SIZE; ++k) now[k] = starts[env * ROOMS + k];
  float* out = heard + (size_t(env) * (matrices / octaves) + state) * bins * octaves + octave;
  for (int begin = 0; begin < bins; begin += RUN) {
    for (int b = part.lane; b < RUN; b += LANES) {
      float sum = 0.0f;
#pragma unroll
      for (int k = 0; k < SIZE; ++k) sum += rows[(b * SIZE + k) * PITCH] * now[k];
      if (begin + b < bins && first + slot < matrices) out[(begin + b) * octaves] = sum;
    }
    part.apply(now);
  }
}

extern "C" __global__ void __launch_bounds__(THREADS) decay_in_rooms(
    const float* __restrict__ rates,      // (environments, states, octaves, ROOMS, ROOMS): M of dw / dn = -M w, n in bins
    const float* __restrict__ starts,     // (environments, ROOMS)
    const float* __restrict__ listeners,  // (environments, ROOMS)
    const int* __restrict__ counts,       // (environments): number of rooms; the others are padding
    const int* __restrict__ sizes,        // environments, states, octaves, bins
    float* __restrict__ heard) {          // (environments, states, bins, octaves)
  extern __shared__ float shared[];
  const int octaves = sizes[2], bins = sizes[3], matrices = sizes[1] * octaves;
  const int env = blockIdx.x % sizes[0], group = blockIdx.x / sizes[0];
  const int rooms = counts[env];
  // The sizes are those of `SIZES` in coupled_decay.py.
#define DECAY_AT(SIZE)                                                                                       \
  if constexpr (SIZE < ROOMS)                                                                                \
    if (rooms <= SIZE)                                                                                       \
      return decay<SIZE>(env, group, matrices, rates, starts, listeners, octaves, bins, heard, shared)
  DECAY_AT(8);
  DECAY_AT(12);
  DECAY_AT(16);
  DECAY_AT(24);
#undef DECAY_AT
  decay<ROOMS>(env, group, matrices, rates, starts, listeners, octaves, bins, heard, shared);
}
