// Reads the paths of a frame at their delays and mixes them into buses; one block per environment.
//
// Computes `delay_reads.sums_of` in shared memory and registers: upsampled source and filtered signals of the first path, an
// interpolated value per path, channel and sample, and its gain into each bus.

constexpr int SUMS = 20;      // buses per thread at a time
constexpr int TAPS = 32;      // taps of the interpolation filter between two samples
constexpr int READ = 8;       // half samples per interpolated value
constexpr int FIRST = -3;     // offset of the first of them
constexpr int WAY = 3;        // values of a path before those of its ears: lengths at both ends, bend
constexpr int FILTERED = 2;   // paths that are read from filtered signals
constexpr int BORDER = TAPS / 2;  // padding samples on both sides
constexpr int NEVER = -1, LATER = -2;  // never read, not yet planned; as `begin`, NEVER: the turn reads no source window

// Weight of half sample FIRST + I, as `delays.read_weights`; a test compares the coefficients.
template <int I>
__device__ __forceinline__ float weight(float rest) {
  constexpr float TABLE[READ][6] = {
      {-3.28e-06f, -0.022154018f, 0.009644584f, 0.033982523f, -0.025386175f, 0.003913515f},
      {1.3705e-05f, 0.1498932f, -0.095071726f, -0.19001038f, 0.1675181f, -0.03233171f},
      {-2.3411e-05f, -0.68380994f, 0.7969122f, 0.22052605f, -0.44220722f, 0.10858579f},
      {1.0000161f, -0.18709783f, -1.4271669f, 0.22791296f, 0.5776106f, -0.19126977f},
      {5.002e-06f, 1.0035994f, 0.8095377f, -0.6256576f, -0.37873825f, 0.19126977f},
      {-1.6494e-05f, -0.34569275f, -0.10889502f, 0.4624449f, 0.10072173f, -0.10858579f},
      {1.1173e-05f, 0.101867594f, 0.016688569f, -0.15674488f, 0.005859541f, 0.03233171f},
      {-2.853e-06f, -0.017105589f, -0.001589757f, 0.028427036f, -0.005818604f, -0.003913515f},
  };
  constexpr float A = TABLE[I][0], B = TABLE[I][1], C = TABLE[I][2], D = TABLE[I][3], E = TABLE[I][4], F = TABLE[I][5];
  return ((((F * rest + E) * rest + D) * rest + C) * rest + B) * rest + A;
}

// Upsampled signal; samples and those between them are in separate arrays, so that neighbouring threads read neighbours.
struct Signal {
  float *on, *between;
  int count;  // samples, without BORDER padding samples on both sides

  __device__ __forceinline__ float at(int place, float rest) const {  // `place`: first half sample that is read
    const int j = place >> 1;
    const float* a = place & 1 ? between + j : on + j;
    const float* b = place & 1 ? on + j + 1 : between + j;
    return weight<0>(rest) * a[0] + weight<1>(rest) * b[0] + weight<2>(rest) * a[1] + weight<3>(rest) * b[1] +
           weight<4>(rest) * a[2] + weight<5>(rest) * b[2] + weight<6>(rest) * a[3] + weight<7>(rest) * b[3];
  }
};

struct Sizes {
  int sources, length, filtered, rows, ears, channels, shapes, count, frame, before, window;
};

__device__ __forceinline__ Signal signal_at(float* memory, int count) {
  return {memory + BORDER, memory + 2 * BORDER + count, count};
}

// Reads samples of a source from `begin` on, zero-padded.
__device__ __forceinline__ void fill(const Signal& signal, const float* source, int length, int begin, int count) {
  for (int i = int(threadIdx.x) - BORDER; i < count + BORDER; i += blockDim.x) {
    const int from = begin + i;
    signal.on[i] = from >= 0 && from < length ? source[from] : 0.0f;
  }
}

// Interpolates the samples between; the filter is symmetric.
__device__ __forceinline__ void double_rate(const Signal& signal, int count, const float* half_taps) {
  float tap[TAPS / 2];
#pragma unroll
  for (int t = 0; t < TAPS / 2; ++t) tap[t] = half_taps[t];
  for (int i = threadIdx.x; i < count; i += blockDim.x) {
    float sum = 0.0f;
#pragma unroll
    for (int t = 0; t < TAPS / 2; ++t) sum += tap[t] * (signal.on[i + t - (TAPS / 2 - 1)] + signal.on[i + TAPS / 2 - t]);
    signal.between[i] = sum;
  }
}

// Delay of a path at `time` [frames]: whole samples in `whole`; returns the negative remainder [half samples].
__device__ __forceinline__ float rest_of(const float* way, int ear, int ears, float time, float rate, int* whole) {
  const float curve = time * (1.0f - time), line = way[0] + time * (way[1] - way[0]), across = curve * way[2];
  const float root = sqrtf(fmaxf(line * line - across, 0.0f));
  const float samples = (line - __fdividef(across, fmaxf(line + root, 1e-6f))) * rate, low = floorf(samples);
  const float start = way[WAY + ear], middle = way[WAY + ears + ear], end = way[WAY + 2 * ears + ear];
  *whole = int(low);
  return -2.0f * (samples - low + start + time * (end - start) + 4.0f * curve * (middle - (start + end) / 2.0f));
}

// Bounds the source samples that a path reads, from the constant velocity of its image source.
__device__ __forceinline__ void find_reach(const float* way, const Sizes& size, int start, float rate, int* low, int* high) {
  const float change = way[1] - way[0], moved = sqrtf(change * change + fabsf(way[2])), length = float(size.length);
  const float most = fmaxf(float(size.before), float(size.count - size.before)) / float(size.frame);
  float late = 0.0f;
  for (int i = 0; i < 3 * size.ears; ++i) late = fmaxf(late, fabsf(way[WAY + i]));
  const float middle = 0.5f * float(start) - way[0] * rate, spread = most * moved * rate + 3.0f * late + READ;
  *low = int(fmaxf(0.0f, fminf(middle - spread, length)));
  *high = int(fmaxf(0.0f, fminf(middle + float(size.count) + spread, length)));
}

// Assigns each path to the turn in which it is read, NEVER if none: a turn has one source window. Returns the turns.
__device__ int plan(const Sizes& size, const int* low, const int* high, int* turn, int* begin) {
  int turns = 0;
  for (int left = 1; left;) {
    int first = -1;
    for (int row = FILTERED; row < size.rows; ++row)
      if (turn[row] == LATER && (first < 0 || low[row] < low[first])) first = row;
    begin[turns] = first < 0 ? NEVER : low[first];
    left = 0;
    for (int row = FILTERED; row < size.rows; ++row) {
      if (turn[row] != LATER) continue;
      if (row == first || high[row] <= begin[turns] + size.window)
        turn[row] = turns;
      else
        left = 1;
    }
    ++turns;
  }
  return turns;
}

extern "C" __global__ void __launch_bounds__(384, 3) mix_paths(
    const float* __restrict__ sources,   // (environments, sources, length)
    const float* __restrict__ filtered,  // (environments, sources, FILTERED, filtered)
    const int* __restrict__ starts,      // (environments, sources, 3): half sample of each part at zero delay
    const float* __restrict__ ways,      // (environments, sources, rows, WAY + 3 * ears)
    const float2* __restrict__ weights,  // (environments, sources, rows, channels, shapes padded to SUMS): at the start, change
    const float* __restrict__ taps,      // (TAPS)
    const float* __restrict__ rates,     // samples per metre
    const int* __restrict__ numbers,     // Sizes
    float* __restrict__ sums) {          // (environments, channels, shapes, count)
  extern __shared__ float shared[];
  const Sizes size = *(const Sizes*)numbers;
  const int thread = threadIdx.x, threads = blockDim.x;
  const int way_size = WAY + 3 * size.ears, whole_shapes = (size.shapes + SUMS - 1) / SUMS * SUMS;
  const int share = size.rows * size.channels * whole_shapes, memory = 2 * (size.filtered + BORDER);
  float2* shares = (float2*)shared;
  float* kernel = (float*)(shares + share);
  float* way = kernel + TAPS;
  int* turn = (int*)(way + size.rows * way_size);
  int *low = turn + size.rows, *high = low + size.rows, *begin = high + size.rows, *turns = begin + size.rows + 1;
  float* signals = (float*)(turns + 1);
  Signal part[FILTERED + 1];
#pragma unroll
  for (int i = 0; i <= FILTERED; ++i)
    part[i] = signal_at(signals + i * memory, i < FILTERED ? size.filtered : size.window);
  const float rate = rates[0];
  float* out = sums + size_t(blockIdx.x) * size.channels * size.shapes * size.count;
  for (int i = thread; i < TAPS; i += threads) kernel[i] = taps[i];
  for (int source = 0; source < size.sources; ++source) {
    const size_t number = size_t(blockIdx.x) * size.sources + source;
    __syncthreads();
    for (int i = thread; i < size.rows; i += threads) turn[i] = NEVER;
    __syncthreads();
    for (int i = thread; i < share; i += threads) {
      shares[i] = weights[number * share + i];
      const int row = i * size.rows / share;
      if (shares[i].x != 0.0f || shares[i].y != 0.0f) turn[row] = row < FILTERED ? 0 : LATER;
    }
    for (int i = thread; i < size.rows * way_size; i += threads) way[i] = ways[number * size.rows * way_size + i];
#pragma unroll
    for (int i = 0; i < FILTERED; ++i)
      fill(part[i], filtered + (number * FILTERED + i) * size.filtered, size.filtered, 0, size.filtered);
    __syncthreads();
    const int heard_first = starts[number * 3 + FILTERED] - 2 * FILTERED * size.filtered;
    for (int row = thread; row < size.rows; row += threads)
      find_reach(way + row * way_size, size, heard_first, rate, low + row, high + row);
#pragma unroll
    for (int i = 0; i < FILTERED; ++i) double_rate(part[i], size.filtered, kernel);
    __syncthreads();
    if (thread == 0) *turns = plan(size, low, high, turn, begin);
    __syncthreads();
    for (int now = 0; now < *turns; ++now) {
      const int first = begin[now];
      if (first != NEVER) {
        fill(part[FILTERED], sources + number * size.length, size.length, first, size.window);
        __syncthreads();
        double_rate(part[FILTERED], size.window, kernel);
        __syncthreads();
      }
      for (int item = thread; item < size.channels * size.count; item += threads) {
        const int channel = item / size.count, k = item - channel * size.count;
        const int ear = size.ears == 1 ? 0 : channel;
        const float time = float(k - size.before) / float(size.frame), fade = fminf(fmaxf(time, 0.0f), 1.0f);
        for (int base = 0; base < size.shapes; base += SUMS) {
          float sum[SUMS];
#pragma unroll
          for (int s = 0; s < SUMS; ++s) sum[s] = 0.0f;
          for (int row = 0; row < size.rows; ++row) {
            if (turn[row] != now) continue;
            const bool own = row < FILTERED;
            const Signal signal = row == 0 ? part[0] : row == 1 ? part[1] : part[FILTERED];
            int whole;
            const float rest = rest_of(way + row * way_size, ear, size.ears, time, rate, &whole), below = floorf(rest);
            const int half = own ? starts[number * 3 + row] - 2 * row * size.filtered : heard_first;
            int place = half + 2 * (k - whole) + int(below) + FIRST;
            if (!own) place = max(0, min(place, 2 * size.length - READ)) - 2 * first;
            place = max(0, min(place, 2 * signal.count - READ));
            const float heard = signal.at(place, rest - below), faded = heard * fade;
            const float4* mine = (const float4*)(shares + (row * size.channels + channel) * whole_shapes + base);
#pragma unroll
            for (int s = 0; s < SUMS / 2; ++s) {
              const float4 pair = mine[s];
              sum[2 * s] += heard * pair.x + faded * pair.y;
              sum[2 * s + 1] += heard * pair.z + faded * pair.w;
            }
          }
#pragma unroll
          for (int s = 0; s < SUMS; ++s) {
            if (base + s < size.shapes) {
              float* to = out + size_t(channel * size.shapes + base + s) * size.count + k;
              *to = source + now ? *to + sum[s] : sum[s];
            }
          }
        }
      }
      __syncthreads();
    }
  }
}
