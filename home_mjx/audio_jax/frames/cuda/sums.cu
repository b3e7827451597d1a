// Paths of a frame, read at their delays and added up with weights of their own; one block per environment.
//
// What `early.heard_sums` does, all of it between shared memory and registers: half samples of the source and of what
// the first path's filters make, an interpolated value per path, channel and sample, and its share in each sum.

constexpr int SUMS = 20;      // that a thread keeps at once
constexpr int TAPS = 32;      // of the filter between two samples
constexpr int READ = 8;       // half samples that are read for one value
constexpr int FIRST = -3;     // the first of them
constexpr int WAY = 3;        // numbers of a path before those of its ears: length at both ends, bend
constexpr int FILTERED = 2;   // rows that are read from what filters made

// Weight of half sample FIRST + I: `delays.read_weights`, whose numbers these are (a test compares them).
template <int I>
__device__ __forceinline__ float weight(float rest) {
  constexpr float TABLE[READ][6] = {
      {-3.2798725e-06f, -2.2154018e-02f, 9.644584e-03f, 3.3982523e-02f, -2.5386177e-02f, 3.9135143e-03f},
      {1.3705224e-05f, 1.498932e-01f, -9.5071726e-02f, -1.9001038e-01f, 1.675181e-01f, -3.233171e-02f},
      {-2.3411105e-05f, -6.8380994e-01f, 7.969122e-01f, 2.2052605e-01f, -4.4220722e-01f, 1.0858579e-01f},
      {1.0000161e+00f, -1.8709783e-01f, -1.4271669e+00f, 2.2791296e-01f, 5.776106e-01f, -1.9126977e-01f},
      {5.0022572e-06f, 1.0035994e+00f, 8.095377e-01f, -6.256576e-01f, -3.7873825e-01f, 1.9126977e-01f},
      {-1.6493668e-05f, -3.4569275e-01f, -1.0889502e-01f, 4.624449e-01f, 1.0072173e-01f, -1.0858579e-01f},
      {1.11725985e-05f, 1.01867594e-01f, 1.6688569e-02f, -1.5674488e-01f, 5.859541e-03f, 3.233171e-02f},
      {-2.8527693e-06f, -1.7105589e-02f, -1.5897566e-03f, 2.8427036e-02f, -5.8186036e-03f, -3.9135143e-03f},
  };
  constexpr float A = TABLE[I][0], B = TABLE[I][1], C = TABLE[I][2], D = TABLE[I][3], E = TABLE[I][4], F = TABLE[I][5];
  return ((((F * rest + E) * rest + D) * rest + C) * rest + B) * rest + A;
}

// Half samples, those on samples and those between them apart, so that neighbours read neighbours.
struct Signal {
  const float* half;
  int count;  // of samples, after which those between them follow

  __device__ __forceinline__ float at(int place, float rest) const {  // `place`: of the first that is read
    const int odd = place & 1, j = place >> 1;
    const float* a = half + j + odd * count;
    const float* b = half + j + odd + (1 - odd) * count;
    return weight<0>(rest) * a[0] + weight<1>(rest) * b[0] + weight<2>(rest) * a[1] + weight<3>(rest) * b[1] +
           weight<4>(rest) * a[2] + weight<5>(rest) * b[2] + weight<6>(rest) * a[3] + weight<7>(rest) * b[3];
  }
};

struct Sizes {
  int sources, length, filtered, rows, ears, channels, shapes, count, frame, before;
};

// A signal and what lies between each two of its samples; silence before and after it. The filter is symmetric.
__device__ void double_rate(const float* signal, int count, const float* half_taps, float* on, float* between) {
  for (int i = threadIdx.x; i < count; i += blockDim.x) on[i] = signal[i];
  __syncthreads();
  float tap[TAPS / 2];
#pragma unroll
  for (int t = 0; t < TAPS / 2; ++t) tap[t] = half_taps[t];
  for (int i = threadIdx.x; i < count; i += blockDim.x) {
    const bool inside = i >= TAPS / 2 - 1 && i + TAPS / 2 < count;
    float sum = 0.0f;
#pragma unroll
    for (int t = 0; t < TAPS / 2; ++t) {
      const int before = i + t - (TAPS / 2 - 1), after = i + TAPS / 2 - t;
      if (inside) {
        sum += tap[t] * (on[before] + on[after]);
      } else {
        if (before >= 0) sum += tap[t] * on[before];
        if (after < count) sum += tap[t] * on[after];
      }
    }
    between[i] = sum;
  }
}

// Samples between what a path brings at `time` [frames] left its source and now: whole ones, and the rest [-half ones].
__device__ __forceinline__ float rest_of(const float* way, int ear, int ears, float time, float rate, int* whole) {
  const float curve = time * (1.0f - time), line = way[0] + time * (way[1] - way[0]), across = curve * way[2];
  const float root = sqrtf(fmaxf(line * line - across, 0.0f));
  const float samples = (line - __fdividef(across, fmaxf(line + root, 1e-6f))) * rate, low = floorf(samples);
  const float start = way[WAY + ear], middle = way[WAY + ears + ear], end = way[WAY + 2 * ears + ear];
  *whole = int(low);
  return -2.0f * (samples - low + start + time * (end - start) + 4.0f * curve * (middle - (start + end) / 2.0f));
}

extern "C" __global__ void __launch_bounds__(768, 1) add_paths(
    const float* __restrict__ sources,   // (environments, sources, length)
    const float* __restrict__ filtered,  // (environments, sources, FILTERED, filtered)
    const int* __restrict__ starts,      // (environments, sources, 3): half sample of each that is heard without delay
    const float* __restrict__ ways,      // (environments, sources, rows, WAY + 3 * ears)
    const float2* __restrict__ weights,  // (environments, sources, rows, channels, shapes, in whole SUMS): at first, and what comes
    const float* __restrict__ taps,      // (TAPS)
    const float* __restrict__ rates,     // samples per metre
    const int* __restrict__ numbers,     // Sizes
    float* __restrict__ sums) {          // (environments, channels, shapes, count)
  extern __shared__ float shared[];
  const Sizes size = *(const Sizes*)numbers;
  const int all = FILTERED * size.filtered + size.length, thread = threadIdx.x, threads = blockDim.x;
  const int way_size = WAY + 3 * size.ears, whole_shapes = (size.shapes + SUMS - 1) / SUMS * SUMS;
  const int share = size.rows * size.channels * whole_shapes;
  float2* shares = (float2*)shared;
  float* on = (float*)(shares + share);
  float* between = on + all;
  float* way = between + all;
  float* kernel = way + size.rows * way_size;
  int* sounds = (int*)(kernel + TAPS);
  const Signal signal = {on, all};
  const float rate = rates[0];
  float* out = sums + size_t(blockIdx.x) * size.channels * size.shapes * size.count;
  for (int i = thread; i < TAPS; i += threads) kernel[i] = taps[i];
  for (int source = 0; source < size.sources; ++source) {
    const size_t number = size_t(blockIdx.x) * size.sources + source;
    __syncthreads();
    for (int i = thread; i < size.rows; i += threads) sounds[i] = 0;
    __syncthreads();
    for (int i = thread; i < share; i += threads) {
      shares[i] = weights[number * share + i];
      if (shares[i].x != 0.0f || shares[i].y != 0.0f) sounds[i * size.rows / share] = 1;
    }
    for (int i = thread; i < size.rows * way_size; i += threads) way[i] = ways[number * size.rows * way_size + i];
    for (int part = 0; part <= FILTERED; ++part) {
      const int begin = part * size.filtered;
      const float* from = part < FILTERED ? filtered + (number * FILTERED + part) * size.filtered
                                          : sources + number * size.length;
      double_rate(from, part < FILTERED ? size.filtered : size.length, kernel, on + begin, between + begin);
    }
    __syncthreads();
    for (int item = thread; item < size.channels * size.count; item += threads) {
      const int channel = item / size.count, k = item - channel * size.count;
      const int ear = size.ears == 1 ? 0 : channel;
      const float time = float(k - size.before) / float(size.frame), fade = fminf(fmaxf(time, 0.0f), 1.0f);
      for (int base = 0; base < size.shapes; base += SUMS) {
        float sum[SUMS];
#pragma unroll
        for (int s = 0; s < SUMS; ++s) sum[s] = 0.0f;
        for (int row = 0; row < size.rows; ++row) {
          if (!sounds[row]) continue;
          const int part = row < FILTERED ? row : FILTERED, begin = 2 * part * size.filtered;
          const int last = begin + 2 * (part < FILTERED ? size.filtered : size.length) - READ;
          int whole;
          const float rest = rest_of(way + row * way_size, ear, size.ears, time, rate, &whole), low = floorf(rest);
          int place = starts[number * 3 + part] + 2 * (k - whole) + int(low) + FIRST;
          place = max(begin, min(place, last));
          const float heard = signal.at(place, rest - low), faded = heard * fade;
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
            *to = source ? *to + sum[s] : sum[s];
          }
        }
      }
    }
  }
}
