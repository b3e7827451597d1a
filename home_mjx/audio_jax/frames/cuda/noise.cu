// Noise that carries the energy of responses: octaves of a few noises, mixed for each channel, in bins whose amplitude
// runs straight from knot to knot. What `diffuse.Shares.of_bins` and a product with `noise_bins` give, but octaves are
// mixed before they get their amplitude. One block per bin and ROWS responses; a thread keeps its sample of all noises.
//
// SIZE, how many noises there are, is given when this is compiled.

constexpr int NOISES = SIZE, BANDS = 7, KNOTS = 3, ROWS = 64;
constexpr int MIX = (NOISES * BANDS + 3) / 4 * 4;  // numbers of a row, padded so that four are read at once
constexpr int KNOT = 8, AMPLITUDE = KNOTS * KNOT;

__device__ __forceinline__ float at(float4 x, int i) { return i == 0 ? x.x : i == 1 ? x.y : i == 2 ? x.z : x.w; }

extern "C" __global__ void __launch_bounds__(256, 3) carry_noise(
    const float* __restrict__ noise,       // (own, NOISES, BANDS, response)
    const float* __restrict__ amplitudes,  // (ends, bins, channels, KNOTS, BANDS), of all ends of all environments
    const float* __restrict__ mixes,       // (ends, channels, NOISES, BANDS)
    const float* __restrict__ commons,     // (ends, bins, common, KNOTS, BANDS)
    const int* __restrict__ sizes,         // ends, bins, channels, samples of a bin, common channels, own noises
    float* __restrict__ responses) {       // (ends, channels, response)
  extern __shared__ float shared[];
  const int ends = sizes[0], bins = sizes[1], channels = sizes[2], bin = sizes[3], common = sizes[4], own = sizes[5];
  const int which = blockIdx.y, thread = threadIdx.x, threads = blockDim.x, response = bins * bin;
  float* mix = shared;
  float* amplitude = mix + ROWS * MIX;
  float* together = amplitude + ROWS * AMPLITUDE;
  // Rows of a block are of one channel, which may have noises of its own.
  const int channel = blockIdx.x % channels, first = blockIdx.x / channels * ROWS, count = min(ROWS, ends - first);
  for (int i = thread; i < count * NOISES * BANDS; i += threads) {
    const int row = i / (NOISES * BANDS), j = i - row * NOISES * BANDS;
    mix[row * MIX + j] = mixes[(size_t(first + row) * channels + channel) * NOISES * BANDS + j];
  }
  for (int i = thread; i < count * KNOTS * BANDS; i += threads) {
    const int row = i / (KNOTS * BANDS), j = i - row * KNOTS * BANDS, to = row * AMPLITUDE + j / BANDS * KNOT + j % BANDS;
    const size_t cell = size_t(first + row) * bins + which;
    amplitude[to] = amplitudes[(cell * channels + channel) * KNOTS * BANDS + j];
    if (common) together[to] = channel ? commons[(cell * common + channel - 1) * KNOTS * BANDS + j] : 0.0f;
  }
  __syncthreads();
  const int lanes = threads / bin > 0 ? threads / bin : 1, lane = thread / bin;
  if (lane >= lanes) return;
  for (int sample = thread - lane * bin; sample < bin; sample += threads) {
    float heard[NOISES][BANDS];
    const float* here = noise + size_t(own > 1 ? channel : 0) * NOISES * BANDS * response + which * bin + sample;
#pragma unroll
    for (int i = 0; i < NOISES * BANDS; ++i) heard[i / BANDS][i % BANDS] = here[size_t(i) * response];
    const float place = 2.0f * (float(sample) + 0.5f) / float(bin);  // in halves of a bin
    const int half = place >= 1.0f;
    const float after = place - float(half), before = 1.0f - after;
    for (int row = lane; row < count; row += lanes) {
      const float4* weight = (const float4*)(mix + row * MIX);
      const float4* low = (const float4*)(amplitude + row * AMPLITUDE + half * KNOT);
      float mixed[BANDS] = {};
#pragma unroll
      for (int i = 0; i < MIX / 4; ++i) {
        const float4 four = weight[i];
#pragma unroll
        for (int j = 4 * i; j < 4 * i + 4; ++j)
          if (j < NOISES * BANDS) mixed[j % BANDS] += at(four, j - 4 * i) * heard[j / BANDS][j % BANDS];
      }
      float sum = 0.0f;
#pragma unroll
      for (int i = 0; i < KNOT / 4; ++i) {
        const float4 a = low[i], b = low[i + KNOT / 4];
#pragma unroll
        for (int j = 4 * i; j < 4 * i + 4; ++j)
          if (j < BANDS) sum += (before * at(a, j - 4 * i) + after * at(b, j - 4 * i)) * mixed[j];
      }
      if (common) {
        const float* mine = together + row * AMPLITUDE + half * KNOT;
#pragma unroll
        for (int j = 0; j < BANDS; ++j) sum += (before * mine[j] + after * mine[KNOT + j]) * heard[0][j];
      }
      responses[(size_t(first + row) * channels + channel) * response + which * bin + sample] = sum;
    }
  }
}
