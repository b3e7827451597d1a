// Noise responses: octaves of a few noises are mixed for each channel and scaled to the energy of bins, with amplitudes
// that are linear between knots. The result equals `noise_gains.Shares` times `noise_bins`, but octaves are mixed before they
// are scaled. One block per RUN bins of the noise, or parts of these bins, and ROWS frame ends in one channel. A thread
// keeps two samples of all noises, half a bin apart.
//
// SIZE, the number of noises, is a compile-time definition.

constexpr int NOISES = SIZE, BANDS = 7, ROWS = 64, THREADS = 64;
constexpr int RUN = 5;  // bins per block, in sequence
constexpr int MIX = (NOISES * BANDS + 3) / 4 * 4;  // mix weights per row, padded for reads of four
constexpr int PART = 8, LOUD = 4 * PART;  // padded octaves; start and change per half bin
constexpr float TINY = 1e-36f;

__device__ __forceinline__ float at(float4 x, int i) { return i == 0 ? x.x : i == 1 ? x.y : i == 2 ? x.z : x.w; }

// Computes the amplitudes of a bin from its power and those of its neighbours, as `noise_gains.amplitudes`.
__device__ __forceinline__ void put_knots(float* loud, float before, float power, float after) {
  const float low = sqrtf((before + power) / 2), mid = sqrtf(power), high = sqrtf((power + after) / 2);
  const float here = (low * low + low * mid + 2 * mid * mid + mid * high + high * high) / 6;
  const float scale = sqrtf(((before + 6 * power + after) / 8) / fmaxf(here, TINY));
  loud[0] = scale * low, loud[PART] = scale * (mid - low);
  loud[2 * PART] = scale * mid, loud[3 * PART] = scale * (high - mid);
}

// Reads the amplitudes of one octave and channel from three bins at a stride; at a response's ends the bin itself.
__device__ __forceinline__ void read_knots(float* loud, const float* power, int bin, int bins, int stride) {
  const float own = power[0], before = power[bin > 0 ? -stride : 0], after = power[bin + 1 < bins ? stride : 0];
  put_knots(loud, fabsf(before), fabsf(own), fabsf(after));
  const float sign = own < 0.0f ? -1.0f : own > 0.0f ? 1.0f : own;  // keeps 0 and NaN
  for (int i = 0; i < 4; ++i) loud[i * PART] *= sign;
}

// Adds the scaled octaves at `place`, from 0 to 1, in a half bin.
__device__ __forceinline__ void carry(const float* loud, const float* octaves, float place, float& sum) {
#pragma unroll
  for (int i = 0; i < PART / 4; ++i) {
    const float4 start = ((const float4*)loud)[i], more = ((const float4*)(loud + PART))[i];
#pragma unroll
    for (int j = 4 * i; j < 4 * i + 4; ++j)
      if (j < BANDS) sum += (at(start, j - 4 * i) + place * at(more, j - 4 * i)) * octaves[j];
  }
}

extern "C" __global__ void __launch_bounds__(THREADS, 7) shape_noise(
    const float* __restrict__ noise,    // (own, NOISES, BANDS, response)
    const float* __restrict__ powers,   // (ends, bins, channels, BANDS), frame ends of all environments
    const float* __restrict__ mixes,    // (ends, channels, NOISES, BANDS)
    const float* __restrict__ commons,  // (ends, bins, common, BANDS)
    const int* __restrict__ starts,     // (ends): noise bin at which a response begins
    const int* __restrict__ sizes,      // ends, bins, channels, samples per bin, common channels, noise sets
    float* __restrict__ responses) {    // (ends, channels, response), in the noise's time
  extern __shared__ float shared[];
  const int ends = sizes[0], bins = sizes[1], channels = sizes[2], bin = sizes[3], common = sizes[4], own = sizes[5];
  const int half = bin / 2, pieces = (half + THREADS - 1) / THREADS, width = min(half, THREADS);
  const int begin = blockIdx.y / pieces * RUN, thread = threadIdx.x, response = bins * bin;
  float* mix = shared;
  float* loud = mix + ROWS * MIX;
  float* together = loud + ROWS * LOUD;
  const int channel = blockIdx.x % channels, first = blockIdx.x / channels * ROWS, count = min(ROWS, ends - first);
#pragma unroll 5
  for (int i = thread; i < ROWS * NOISES * BANDS; i += THREADS) {
    const int row = i / (NOISES * BANDS), j = i - row * NOISES * BANDS;
    const size_t from = size_t(first + min(row, count - 1)) * channels + channel;
    mix[row * MIX + j] = mixes[from * NOISES * BANDS + j];
  }
  const int lane = thread / width, lanes = THREADS / width;
  const int sample = blockIdx.y % pieces * width + thread - lane * width;
  const bool idle = lane >= lanes || sample >= half;
  const float place = (float(sample) + 0.5f) / float(half);
  for (int which = begin; which < min(begin + RUN, bins); ++which) {
    __syncthreads();  // all reads of the previous bin's amplitudes are done
#pragma unroll 2
    for (int i = thread; i < ROWS * BANDS; i += THREADS) {
      const int row = i / BANDS, octave = i - row * BANDS, end = first + min(row, count - 1);
      int mine = (which - starts[end]) % bins;
      mine += mine < 0 ? bins : 0;
      const size_t cell = size_t(end) * bins + mine;
      float* to = loud + row * LOUD + octave;
      read_knots(to, powers + (cell * channels + channel) * BANDS + octave, mine, bins, channels * BANDS);
      if (!common) continue;
      to = together + row * LOUD + octave;
      if (channel)
        read_knots(to, commons + (cell * common + channel - 1) * BANDS + octave, mine, bins, common * BANDS);
      else
        put_knots(to, 0.0f, 0.0f, 0.0f);
    }
    const int here = which * bin + (idle ? 0 : sample);
    const float* from = noise + size_t(own > 1 ? channel : 0) * NOISES * BANDS * response + here;
    float heard[2][NOISES * BANDS];
#pragma unroll
    for (int i = 0; i < NOISES * BANDS; ++i) {
      heard[0][i] = from[size_t(i) * response];
      heard[1][i] = from[size_t(i) * response + half];
    }
    __syncthreads();  // after all global reads have been issued
    for (int row = lane; row < count && !idle; row += lanes) {
      float mixed[2][BANDS] = {};
#pragma unroll
      for (int i = 0; i < MIX / 4; ++i) {
        const float4 four = ((const float4*)(mix + row * MIX))[i];
#pragma unroll
        for (int j = 4 * i; j < 4 * i + 4; ++j) {
          if (j >= NOISES * BANDS) continue;
          mixed[0][j % BANDS] += at(four, j - 4 * i) * heard[0][j];
          mixed[1][j % BANDS] += at(four, j - 4 * i) * heard[1][j];
        }
      }
      float* out = responses + (size_t(first + row) * channels + channel) * response + here;
#pragma unroll
      for (int i = 0; i < 2; ++i) {
        float sum = 0.0f;
        carry(loud + row * LOUD + i * 2 * PART, mixed[i], place, sum);
        if (common) carry(together + row * LOUD + i * 2 * PART, heard[i], place, sum);
        out[i * half] = sum;
      }
    }
  }
}
