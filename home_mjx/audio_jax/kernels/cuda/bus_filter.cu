// Filters the buses of a frame; one block per environment and pair of channels.
//
// SIZE, the transform size, is a compile-time definition. Filters are real, so a pair of channels is filtered as the real
// and the imaginary part of one signal.

// Resident blocks per multiprocessor: three were fastest of one to five.
constexpr int BLOCKS = SIZE / PER_THREAD <= 640 ? 3 : 1;

extern "C" __global__ void __launch_bounds__(SIZE / PER_THREAD, BLOCKS) filter_buses(
    const float* __restrict__ sums,       // (environments, channels, shapes, count)
    const float2* __restrict__ spectra,   // (shapes, SIZE), divided by SIZE
    const float2* __restrict__ turns,     // twiddle factors of all passes, see `transform`
    const int* __restrict__ sizes,        // channels, shapes, count, begin, frame
    float* __restrict__ frames) {         // (environments, channels, frame)
  extern __shared__ float shared[];
  const int channels = sizes[0], shapes = sizes[1], count = sizes[2], begin = sizes[3], frame = sizes[4];
  Complex* values = (Complex*)shared;
  Complex* table = values + place(SIZE);
  const int left = 2 * blockIdx.y, env = blockIdx.x;
  const bool both = left + 1 < channels;
  const float* here = sums + size_t(env * channels + left) * shapes * count;
  const float* there = both ? here + size_t(shapes) * count : here;
  copy_turns<SIZE>(table, turns);
  Complex whole[num_slots<SIZE>()];
#pragma unroll
  for (Complex& one : whole) one = Complex{0.0f, 0.0f};
  __syncthreads();
#pragma unroll 1
  for (int shape = 0; shape < shapes; ++shape) {
    const float* a = here + size_t(shape) * count;
    const float* b = there + size_t(shape) * count;
    const float2* filter = spectra + size_t(shape) * SIZE;
    transform<SIZE>(
        values, table, [&](int i) { return i < count ? Complex{a[i], both ? b[i] : 0.0f} : Complex{0.0f, 0.0f}; },
        [&](int slot, int i, Complex value) {
          const float2 one = filter[i];
          whole[slot] = whole[slot] + Complex{one.x, one.y} * value;
        });
  }
  float* out = frames + size_t(env * channels + left) * frame - begin;
  transform_back<SIZE>(values, table, whole, [&](int i, Complex value) {
    if (i < begin || i >= begin + frame) return;
    out[i] = value.re;
    if (both) out[frame + i] = value.im;
  });
}
