// A block's complex transform in shared memory: Stockham's, radices of at most 8, eight values per thread.
//
// As in Govindaraju et al., High Performance Discrete Fourier Transforms on Graphics Processors, 2008: every pass reads
// its values, turns and adds them up, and writes them where the next one finds them, so nothing has to be reversed.

constexpr int PER_THREAD = 8;  // values; a transform has that many times as many as a block has threads

struct Complex {
  float re, im;
};

__device__ __forceinline__ Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
__device__ __forceinline__ Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
__device__ __forceinline__ Complex operator*(Complex a, Complex b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
__device__ __forceinline__ Complex operator*(float a, Complex b) { return {a * b.re, a * b.im}; }
__device__ __forceinline__ Complex conjugate(Complex a) { return {a.re, -a.im}; }
__device__ __forceinline__ Complex back(Complex a) { return {a.im, -a.re}; }  // times -i

__device__ __forceinline__ void two(Complex& a, Complex& b) {
  Complex sum = a + b;
  b = a - b;
  a = sum;
}

template <int R>
__device__ __forceinline__ void butterfly(Complex* v);

template <>
__device__ __forceinline__ void butterfly<2>(Complex* v) {
  two(v[0], v[1]);
}

template <>
__device__ __forceinline__ void butterfly<3>(Complex* v) {
  Complex sum = v[1] + v[2], turned = 0.86602540f * back(v[1] - v[2]), middle = v[0] - 0.5f * sum;
  v[0] = v[0] + sum;
  v[1] = middle + turned;
  v[2] = middle - turned;
}

template <>
__device__ __forceinline__ void butterfly<4>(Complex* v) {
  two(v[0], v[2]);
  two(v[1], v[3]);
  v[3] = back(v[3]);
  two(v[0], v[1]);
  two(v[2], v[3]);
  Complex second = v[2];
  v[2] = v[1];
  v[1] = second;
}

template <>
__device__ __forceinline__ void butterfly<5>(Complex* v) {
  constexpr float COS_1 = 0.30901699f, COS_2 = -0.80901699f, SIN_1 = 0.95105652f, SIN_2 = 0.58778525f;
  Complex sum_1 = v[1] + v[4], sum_2 = v[2] + v[3], less_1 = back(v[1] - v[4]), less_2 = back(v[2] - v[3]);
  Complex even_1 = v[0] + COS_1 * sum_1 + COS_2 * sum_2, odd_1 = SIN_1 * less_1 + SIN_2 * less_2;
  Complex even_2 = v[0] + COS_2 * sum_1 + COS_1 * sum_2, odd_2 = SIN_2 * less_1 - SIN_1 * less_2;
  v[0] = v[0] + sum_1 + sum_2;
  v[1] = even_1 + odd_1;
  v[2] = even_2 + odd_2;
  v[3] = even_2 - odd_2;
  v[4] = even_1 - odd_1;
}

template <>
__device__ __forceinline__ void butterfly<8>(Complex* v) {
  constexpr float HALF = 0.70710678f;
  Complex even[4] = {v[0], v[2], v[4], v[6]}, odd[4] = {v[1], v[3], v[5], v[7]};
  butterfly<4>(even);
  butterfly<4>(odd);
  odd[1] = Complex{HALF * (odd[1].re + odd[1].im), HALF * (odd[1].im - odd[1].re)};
  odd[2] = back(odd[2]);
  odd[3] = Complex{HALF * (odd[3].im - odd[3].re), -HALF * (odd[3].re + odd[3].im)};
#pragma unroll
  for (int i = 0; i < 4; ++i) {
    v[i] = even[i] + odd[i];
    v[i + 4] = even[i] - odd[i];
  }
}

// One pass over `size` values, of which groups of `done` are transforms already. `turns`: exp(-2 pi i j / size).
template <int R>
__device__ __forceinline__ void pass(Complex* values, const Complex* turns, int size, int done) {
  constexpr int MOST = (PER_THREAD + R - 1) / R;
  asm volatile("" : "+r"(size), "+r"(done));  // or compilers keep the indices of all passes in registers for the next
  const int count = size / R, step = count / done;
  Complex held[MOST][R];
#pragma unroll
  for (int b = 0; b < MOST; ++b) {
    int i = int(threadIdx.x) + b * int(blockDim.x);
    if (i < count) {
      Complex turn = turns[(i % done) * step], power = turn;
      held[b][0] = values[i];
#pragma unroll
      for (int r = 1; r < R; ++r) {
        held[b][r] = power * values[i + r * count];
        power = power * turn;
      }
      butterfly<R>(held[b]);
    }
  }
  __syncthreads();
#pragma unroll
  for (int b = 0; b < MOST; ++b) {
    int i = int(threadIdx.x) + b * int(blockDim.x);
    if (i < count) {
      int inner = i % done, first = (i - inner) * R + inner;
#pragma unroll
      for (int r = 0; r < R; ++r) values[first + r * done] = held[b][r];
    }
  }
  __syncthreads();
}

// In place; all threads of the block take part, and may read the results at once.
__device__ __forceinline__ void transform(Complex* values, const Complex* turns, int size) {
  __syncthreads();
  int done = 1;
  for (; size / done % 8 == 0; done *= 8) pass<8>(values, turns, size, done);
  for (; size / done % 5 == 0; done *= 5) pass<5>(values, turns, size, done);
  for (; size / done % 4 == 0; done *= 4) pass<4>(values, turns, size, done);
  for (; size / done % 3 == 0; done *= 3) pass<3>(values, turns, size, done);
  for (; size / done % 2 == 0; done *= 2) pass<2>(values, turns, size, done);
}
