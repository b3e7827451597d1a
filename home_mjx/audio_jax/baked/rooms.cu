// Energy in the rooms of a house over time, see `rooms.py`: one block for WARPS matrices of an environment, a warp for each.
//
// SIZE, how many rooms there are, is given when this is compiled: at most as many as a warp has threads.

constexpr int WARP = 32, WARPS = 7, STRIDE = SIZE | 1;  // odd rows keep threads out of each other's banks
constexpr int ROWS = 2 * SIZE > WARP ? 2 * SIZE : WARP;  // that a warp has: two matrices, then steps
constexpr int TERMS = 6, HALVINGS = 3;       // as in rooms.py: of the exponential series, and of the step before it

// This thread's row of one matrix times another, whose rows all threads of a warp read together.
__device__ __forceinline__ void multiply(float* product, const float* row, const float* matrix) {
#pragma unroll
  for (int j = 0; j < SIZE; ++j) product[j] = 0.0f;
#pragma unroll 2
  for (int k = 0; k < SIZE; ++k) {
    const float one = row[k];
#pragma unroll
    for (int j = 0; j < SIZE; ++j) product[j] += one * matrix[k * STRIDE + j];
  }
}

// Puts a thread's row where it and, after the next barrier, all of its warp read it.
__device__ __forceinline__ void put(float* matrix, const float* row, int lane) {
  if (lane >= SIZE) return;
#pragma unroll
  for (int j = 0; j < SIZE; ++j) matrix[lane * STRIDE + j] = row[j];
}

extern "C" __global__ void __launch_bounds__(WARP * WARPS, 2) fall_in_rooms(
    const float* __restrict__ rates,      // (environments, matrices, SIZE, SIZE): M of dw / dn = -M w, n counting bins
    const float* __restrict__ starts,     // (environments, SIZE)
    const float* __restrict__ listeners,  // (environments, SIZE)
    const int* __restrict__ sizes,        // matrices, bins
    float* __restrict__ heard) {          // (environments, matrices, bins)
  extern __shared__ float shared[];
  const int matrices = sizes[0], bins = sizes[1], lane = threadIdx.x % WARP, warp = threadIdx.x / WARP;
  const int number = blockIdx.y * WARPS + warp;
  if (number >= matrices) return;
  const size_t place = size_t(blockIdx.x) * matrices + number;
  float* own = shared + warp * ROWS * STRIDE;
  float* power = own + SIZE * STRIDE;
  const float* rate = rates + place * SIZE * SIZE;
  const int room = lane < SIZE ? lane : SIZE - 1;
  float step[SIZE], product[SIZE];
#pragma unroll
  for (int j = 0; j < SIZE; ++j) product[j] = rate[room * SIZE + j] * (-1.0f / (1 << HALVINGS));
  put(own, product, lane);
  put(power, product, lane);
#pragma unroll
  for (int j = 0; j < SIZE; ++j) step[j] = product[j] + (j == room ? 1.0f : 0.0f);
  __syncwarp();
  for (int n = 2; n < TERMS; ++n) {
    multiply(product, power + room * STRIDE, own);
#pragma unroll
    for (int j = 0; j < SIZE; ++j) {
      product[j] *= 1.0f / float(n);
      step[j] += product[j];
    }
    __syncwarp();
    put(power, product, lane);
    __syncwarp();
  }
  for (int n = 0; n < HALVINGS; ++n) {
    put(own, step, lane);
    __syncwarp();
    multiply(product, own + room * STRIDE, own);
    __syncwarp();
#pragma unroll
    for (int j = 0; j < SIZE; ++j) step[j] = product[j];
  }
  const float* listener = listeners + blockIdx.x * SIZE;
  float now = starts[blockIdx.x * SIZE + room];
  for (int first = 0; first < bins; first += WARP) {  // as many steps as a warp has threads, which then listen to one each
    for (int k = 0; k < WARP; ++k) {
      __syncwarp();
      if (lane < SIZE) own[k * STRIDE + lane] = now;
      __syncwarp();
      float next = 0.0f;
#pragma unroll
      for (int j = 0; j < SIZE; ++j) next += step[j] * own[k * STRIDE + j];
      now = next;
    }
    float sum = 0.0f;
#pragma unroll
    for (int j = 0; j < SIZE; ++j) sum += listener[j] * own[lane * STRIDE + j];
    if (first + lane < bins) heard[place * bins + first + lane] = sum;
  }
}
