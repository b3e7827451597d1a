// Sums of a frame through the filters that they share; one block per environment and pair of channels.
//
// Filters are real, so a pair goes through them as the real and the imaginary part of one signal.

extern "C" __global__ void __launch_bounds__(768, 1) filter_sums(
    const float* __restrict__ sums,       // (environments, channels, shapes, count)
    const float2* __restrict__ spectra,   // (shapes, size), divided by `size`
    const float2* __restrict__ turns,     // (size)
    const int* __restrict__ sizes,        // channels, shapes, count, size, begin, frame
    float* __restrict__ frames) {         // (environments, channels, frame)
  extern __shared__ float shared[];
  const int channels = sizes[0], shapes = sizes[1], count = sizes[2], size = sizes[3], begin = sizes[4];
  const int frame = sizes[5], threads = blockDim.x, thread = threadIdx.x;
  Complex* values = (Complex*)shared;
  Complex* table = values + size;
  const int left = 2 * blockIdx.y, env = blockIdx.x;
  const bool both = left + 1 < channels;
  const float* here = sums + size_t(env * channels + left) * shapes * count;
  const float* there = both ? here + size_t(shapes) * count : here;
  for (int i = thread; i < size; i += threads) table[i] = Complex{turns[i].x, turns[i].y};
  Complex whole[PER_THREAD];
#pragma unroll
  for (int j = 0; j < PER_THREAD; ++j) whole[j] = Complex{0.0f, 0.0f};
#pragma unroll 1
  for (int shape = 0; shape < shapes; ++shape) {
    const float* a = here + size_t(shape) * count;
    const float* b = there + size_t(shape) * count;
    for (int i = thread; i < size; i += threads)
      values[i] = i < count ? Complex{a[i], both ? b[i] : 0.0f} : Complex{0.0f, 0.0f};
    transform(values, table, size);
#pragma unroll
    for (int j = 0; j < PER_THREAD; ++j) {
      int i = thread + j * threads;
      float2 filter = spectra[size_t(shape) * size + i];
      whole[j] = whole[j] + Complex{filter.x, filter.y} * values[i];
    }
    __syncthreads();
  }
#pragma unroll
  for (int j = 0; j < PER_THREAD; ++j) values[thread + j * threads] = conjugate(whole[j]);
  transform(values, table, size);
  float* out = frames + size_t(env * channels + left) * frame;
  for (int i = thread; i < frame; i += threads) {
    Complex heard = values[begin + i];
    out[i] = heard.re;
    if (both) out[frame + i] = -heard.im;
  }
}
