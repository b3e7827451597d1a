// Late sound of a frame: sources convolved with responses and their tails; one block per environment and pair of channels.
// Computes `late_tail.late_spectra` and the end of `late_tail.frame_by_xla`, with one transform for both channels of a pair.

constexpr int BANDS = 7, ENDS = 2;  // octaves; start and end of the frame
constexpr int HALF = SIZE / 2 + 1;  // values of a real signal's spectrum

struct Sizes {
  // `first` and `half`: samples of a response's parts; `echoes`: repetitions of the second part in the tail; `start`:
  // first source sample of the first part's window; `width`: samples of a window; `begin`: first frame sample in sums.
  int sources, length, channels, response, first, half, echoes, start, width, begin, frame;
};

// Reads a source window. Windows are transformed in pairs: those of both parts, then those of the tail's repetitions.
__device__ __forceinline__ float windowed(const float* source, const Sizes& size, int window, int i) {
  if (i >= size.width || window > size.echoes + 1) return 0.0f;
  const int from = size.start - (window ? size.first + (window - 1) * size.half : 0) + i;
  return from >= 0 && from < size.length ? source[from] : 0.0f;
}

__device__ __forceinline__ float echo_level(const float* levels, const float* octaves, const Sizes& size, int echo, int k) {
  if (echo >= size.echoes) return 0.0f;
  float level = 0.0f;
  for (int band = 0; band < BANDS; ++band) level += levels[echo * BANDS + band] * octaves[band * HALF + k];
  return level;
}

extern "C" __global__ void __launch_bounds__(SIZE / PER_THREAD, 1) late_frames(
    const float* __restrict__ sources,    // (environments, sources, length)
    const float* __restrict__ responses,  // (environments, sources, ENDS, channels, response), in the noise's time
    const int* __restrict__ shifts,       // (environments, sources, ENDS): noise sample at which a response begins
    const int* __restrict__ onsets,       // (environments, sources, ENDS): response sample before which it is zero
    const float* __restrict__ levels,     // (environments, sources, ENDS, echoes, BANDS)
    const float* __restrict__ octaves,    // (BANDS, HALF)
    const float2* __restrict__ turns,     // twiddle factors of all passes, see `transform`
    const int* __restrict__ numbers,      // Sizes
    float* __restrict__ frames) {         // (environments, channels, frame)
  extern __shared__ float shared[];
  constexpr int THREADS = SIZE / PER_THREAD, SLOTS = num_slots<SIZE>();
  const Sizes size = *(const Sizes*)numbers;
  const int left = 2 * blockIdx.y, env = blockIdx.x, thread = threadIdx.x;
  const bool both = left + 1 < size.channels;
  Complex* values = (Complex*)shared;
  Complex* table = values + place(SIZE);
  Complex* now = table + num_turns(SIZE, SIZE);  // source spectrum of the first part; `later`: of the second
  Complex* later[ENDS] = {now + HALF, now + 2 * HALF};
  copy_turns<SIZE>(table, turns);
  __syncthreads();
  Complex whole[ENDS][SLOTS];
#pragma unroll
  for (int slot = 0; slot < SLOTS; ++slot) whole[0][slot] = whole[1][slot] = Complex{0.0f, 0.0f};

  for (int number = 0; number < size.sources; ++number) {
    const size_t one = size_t(env) * size.sources + number;
    const float* source = sources + one * size.length;
    const float* level = levels + one * ENDS * size.echoes * BANDS;
    for (int window = 0; window < size.echoes + 2; window += 2) {
      Complex pair[SLOTS];
      transform<SIZE>(
          values, table,
          [&](int i) { return Complex{windowed(source, size, window, i), windowed(source, size, window + 1, i)}; },
          [&](int slot, int, Complex value) { pair[slot] = value; });
      __syncthreads();
#pragma unroll
      for (int slot = 0; slot < SLOTS; ++slot) {
        const int i = slot_value<SIZE>(slot);
        if (i >= 0) values[place(i)] = pair[slot];
      }
      __syncthreads();
      for (int k = thread; k < HALF; k += THREADS) {
        const Complex a = values[place(k)], b = conjugate(values[place(k ? SIZE - k : 0)]);
        const Complex real = 0.5f * (a + b), imaginary = 0.5f * back(a - b);
        if (window == 0) {
          now[k] = real;
          later[0][k] = later[1][k] = imaginary;
        } else {
#pragma unroll
          for (int end = 0; end < ENDS; ++end) {
            const float* mine = level + end * size.echoes * BANDS;
            later[end][k] = later[end][k] + echo_level(mine, octaves, size, window - 2, k) * real +
                            echo_level(mine, octaves, size, window - 1, k) * imaginary;
          }
        }
      }
      __syncthreads();
    }
#pragma unroll
    for (int end = 0; end < ENDS; ++end) {
      const int shift = shifts[one * ENDS + end], onset = onsets[one * ENDS + end];
      const size_t row = (one * ENDS + end) * size.channels + left;
      for (int part = 0; part < 2; ++part) {
        const Complex* spectrum = part ? later[end] : now;
        const int from = part ? size.first : 0, count = part ? size.half : size.first;
        transform<SIZE>(
            values, table,
            [&](int i) {
              const int sample = from + i;
              if (i >= count || sample < onset) return Complex{0.0f, 0.0f};
              int there = sample + shift;  // clamped to the noise for any shift
              there = max(0, min(there < size.response ? there : there - size.response, size.response - 1));
              const float* heard = responses + row * size.response + there;
              return Complex{heard[0], both ? heard[size.response] : 0.0f};
            },
            [&](int slot, int i, Complex value) {
              const Complex heard = i < HALF ? spectrum[i] : conjugate(spectrum[SIZE - i]);
              whole[end][slot] = whole[end][slot] + heard * value;
            });
      }
    }
    __syncthreads();
  }

  // Crossfade from the frame's start to its end.
  float* out = frames + size_t(env * size.channels + left) * size.frame;
  const float step = 1.0f / float(size.frame);
#pragma unroll
  for (int end = 0; end < ENDS; ++end)
    transform_back<SIZE>(values, table, whole[end], [&](int i, Complex value) {
      const int sample = i - size.begin;
      if (sample < 0 || sample >= size.frame) return;
      const float fade = float(sample + 1) * step, share = (end ? fade : 1.0f - fade) * (1.0f / SIZE);
      out[sample] = (end ? out[sample] : 0.0f) + share * value.re;
      if (both) out[size.frame + sample] = (end ? out[size.frame + sample] : 0.0f) + share * value.im;
    });
}
