// Filters a source with the causal octave filters of both ends of a frame (`kernels/direct_filter.py`); one block per source.
//
// SIZE, the transform size, is a compile-time definition. Both filters are real, so their outputs are the real and the
// imaginary part of one signal.

constexpr int BANDS = 7, HALF = SIZE / 2 + 1;  // octaves; values of a real filter's spectrum

// Evaluates exp of the sum of octave levels times log minimum-phase filters; 0 if `on` is 0.
__device__ __forceinline__ Complex filter_at(const float* levels, float on, const float2* octaves, int k) {
  float size = 0.0f, phase = 0.0f, sine, cosine;
  for (int band = 0; band < BANDS; ++band) {
    const float2 one = octaves[band * HALF + k];
    size += levels[band] * one.x;
    phase += levels[band] * one.y;
  }
  sincosf(phase, &sine, &cosine);
  const float amplitude = on * expf(size);
  return {amplitude * cosine, amplitude * sine};
}

extern "C" __global__ void __launch_bounds__(SIZE / PER_THREAD, 2) filter_direct(
    const float* __restrict__ sources,   // (sources, length)
    const int* __restrict__ begins,      // (sources): first output sample
    const float* __restrict__ levels,    // (sources, 2, BANDS): logarithms of gains
    const float* __restrict__ sounds,    // (sources, 2): 0 if silent, else 1
    const float2* __restrict__ octaves,  // (BANDS, HALF)
    const float2* __restrict__ turns,    // twiddle factors of all passes, see `transform`
    const int* __restrict__ sizes,       // length, samples of the filters, output samples
    float* __restrict__ filtered) {      // (sources, 2, made)
  extern __shared__ float shared[];
  constexpr int THREADS = SIZE / PER_THREAD;
  const int length = sizes[0], ringing = sizes[1], made = sizes[2], number = blockIdx.x, thread = threadIdx.x;
  Complex* values = (Complex*)shared;
  Complex* table = values + place(SIZE);
  Complex* filter[2] = {table + num_turns(SIZE, SIZE), table + num_turns(SIZE, SIZE) + HALF};
  const float* source = sources + size_t(number) * length;
  const int begin = max(-ringing - made, min(begins[number], length)) - ringing;
  copy_turns<SIZE>(table, turns);
  for (int i = thread; i < 2 * HALF; i += THREADS) {
    const int end = i >= HALF, row = 2 * number + end;
    filter[end][i - end * HALF] = filter_at(levels + row * BANDS, sounds[row], octaves, i - end * HALF);
  }
  __syncthreads();
  Complex whole[num_slots<SIZE>()];
  transform<SIZE>(
      values, table,
      [&](int i) {
        const int from = begin + i;
        return Complex{i < ringing + made && from >= 0 && from < length ? source[from] : 0.0f, 0.0f};
      },
      [&](int slot, int i, Complex value) {
        const int k = i < HALF ? i : SIZE - i;
        Complex first = filter[0][k], last = filter[1][k];
        if (i >= HALF) first = conjugate(first), last = conjugate(last);
        whole[slot] = value * Complex{first.re - last.im, first.im + last.re};
      });
  float* out = filtered + size_t(number) * 2 * made - ringing;
  transform_back<SIZE>(values, table, whole, [&](int i, Complex value) {
    if (i < ringing || i >= ringing + made) return;
    out[i] = value.re * (1.0f / SIZE);
    out[made + i] = value.im * (1.0f / SIZE);
  });
}
