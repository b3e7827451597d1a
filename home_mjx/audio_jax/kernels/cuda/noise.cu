// Noise that carries the energy of responses: octaves of a few noises, mixed for each channel, as loud as bins are, with
// amplitudes that run straight from knot to knot. What `shares.Shares` and a product with `noise_bins` give, but octaves
// are mixed before they get their amplitudes. One block per RUN bins of the noise, or pieces of them, and ROWS ends of
// frames in one channel; a thread keeps two samples of all noises, half a bin apart.
//
// SIZE, how many noises there are, is given when this is compiled.

constexpr int NOISES = SIZE, BANDS = 7, ROWS = 64, THREADS = 64;
constexpr int RUN = 5;  // bins of a block, one after the other
constexpr int MIX = (NOISES * BANDS + 3) / 4 * 4;  // numbers of a row, padded so that four are read at once
constexpr int PART = 8, LOUD = 4 * PART;  // octaves, padded: at the start of each half of a bin, and what comes until its end
constexpr float TINY = 1e-36f;

__device__ __forceinline__ float at(float4 x, int i) { return i == 0 ? x.x : i == 1 ? x.y : i == 2 ? x.z : x.w; }

// Amplitudes of a bin, as `shares.amplitudes` has them, where its power is `power` and its neighbours' are these.
__device__ __forceinline__ void put_knots(float* loud, float before, float power, float after) {
  const float low = sqrtf((before + power) / 2), mid = sqrtf(power), high = sqrtf((power + after) / 2);
  const float here = (low * low + low * mid + 2 * mid * mid + mid * high + high * high) / 6;
  const float scale = sqrtf(((before + 6 * power + after) / 8) / fmaxf(here, TINY));
  loud[0] = scale * low, loud[PART] = scale * (mid - low);
  loud[2 * PART] = scale * mid, loud[3 * PART] = scale * (high - mid);
}

// Of one octave and channel in three bins, `stride` numbers apart; responses end at both ends.
__device__ __forceinline__ void read_knots(float* loud, const float* power, int bin, int bins, int stride) {
  const float own = power[0], before = power[bin > 0 ? -stride : 0], after = power[bin + 1 < bins ? stride : 0];
  put_knots(loud, fabsf(before), fabsf(own), fabsf(after));
  const float sign = own < 0.0f ? -1.0f : own > 0.0f ? 1.0f : own;  // of what has none it is none
  for (int i = 0; i < 4; ++i) loud[i * PART] *= sign;
}

// Adds what octaves carry at `place`, from 0 to 1, of a half of a bin.
__device__ __forceinline__ void carry(const float* loud, const float* octaves, float place, float& sum) {
#pragma unroll
  for (int i = 0; i < PART / 4; ++i) {
    const float4 start = ((const float4*)loud)[i], more = ((const float4*)(loud + PART))[i];
#pragma unroll
    for (int j = 4 * i; j < 4 * i + 4; ++j)
      if (j < BANDS) sum += (at(start, j - 4 * i) + place * at(more, j - 4 * i)) * octaves[j];
  }
}

extern "C" __global__ void __launch_bounds__(THREADS, 7) carry_noise(
    const float* __restrict__ noise,    // (own, NOISES, BANDS, response)
    const float* __restrict__ powers,   // (ends, bins, channels, BANDS), of all ends of all environments
    const float* __restrict__ mixes,    // (ends, channels, NOISES, BANDS)
    const float* __restrict__ commons,  // (ends, bins, common, BANDS)
    const int* __restrict__ starts,     // (ends): bin of the noise with which a response begins
    const int* __restrict__ sizes,      // ends, bins, channels, samples of a bin, common channels, own noises
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
    __syncthreads();  // nobody reads what is loud in the bin before
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
    __syncthreads();  // after all that is read from afar is under way
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
