// Complex FFT of one block in shared memory: Stockham's algorithm, radices up to 8, eight values per thread.
//
// After Govindaraju et al., High Performance Discrete Fourier Transforms on Graphics Processors, 2008: every pass reads
// its values, applies twiddle factors and a butterfly, and writes them in the order of the next pass. So there is no bit
// reversal.

constexpr int PER_THREAD = 8;  // values per thread; a block has size / PER_THREAD threads

struct __align__(8) Complex {
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

// Position of value i: a gap after every sixteen avoids bank conflicts between neighbouring threads, also where they
// write every eighth value.
__device__ constexpr int place(int i) { return i + (i >> 4); }

// Position of value i + more, from the positions `at` and `mid` of i and i + 8. Compilers do not find this simplification.
__device__ __forceinline__ int further(int at, int mid, int i, int more) {
  return more % 16 == 0 ? at + place(more) : more % 16 == 8 ? mid + place(more - 8) : place(i + more);
}

__device__ constexpr int largest_radix(int left) {
  return left % 8 == 0 ? 8 : left % 5 == 0 ? 5 : left % 4 == 0 ? 4 : left % 3 == 0 ? 3 : 2;
}

// Radix of the next pass over n values, of which groups of `done` are transformed: the largest one first, then from small
// to large, so that each thread ends with eight values.
__device__ constexpr int radix_of(int n, int done) {
  int left = n / done;
  while (done > 1 && left != largest_radix(left)) left /= largest_radix(left);
  return largest_radix(left);
}

// Twiddle rows in the table for a radix; the other twiddle factors are products of these.
__device__ constexpr int turned(int radix) { return radix == 8 ? 4 : radix - 1; }

// Number of twiddle factors of all passes before the one that joins groups of `until`.
__device__ constexpr int num_turns(int n, int until) {
  int sum = 0;
  for (int done = radix_of(n, 1); done < until; done *= radix_of(n, done)) sum += done * turned(radix_of(n, done));
  return sum;
}

template <int N, int DONE = 1>
__device__ constexpr int last_radix() {
  constexpr int R = radix_of(N, DONE);
  if constexpr (DONE * R < N)
    return last_radix<N, DONE * R>();
  else
    return R;
}

// Number of values that a thread holds after the last pass.
template <int N>
__device__ constexpr int num_slots() {
  return (PER_THREAD + last_radix<N>() - 1) / last_radix<N>() * last_radix<N>();
}

// Index of the value in a slot of this thread after the last pass; -1 if none.
template <int N>
__device__ __forceinline__ int slot_value(int slot) {
  constexpr int R = last_radix<N>();
  const int i = int(threadIdx.x) + slot / R * (N / PER_THREAD);
  return i < N / R ? i + slot % R * (N / R) : -1;
}

// Runs the pass over N values of which groups of DONE are transformed, and all later passes.
template <int N, int DONE, class Load, class Store>
__device__ __forceinline__ void passes(Complex* values, const Complex* turns, Load load, Store store) {
  constexpr int R = radix_of(N, DONE), COUNT = N / R, THREADS = N / PER_THREAD;
  constexpr int MOST = (COUNT + THREADS - 1) / THREADS;
  constexpr bool LAST = DONE * R == N;
  int thread = threadIdx.x;
  asm volatile("" : "+r"(thread));  // otherwise compilers keep the indices of all passes in registers for the next transform
  Complex held[MOST][R];
#pragma unroll
  for (int b = 0; b < MOST; ++b) {
    const int i = thread + b * THREADS, at = place(i), mid = place(i + 8);
    if (COUNT % THREADS == 0 || i < COUNT) {
#pragma unroll
      for (int r = 0; r < R; ++r)
        held[b][r] = DONE == 1 ? load(i + r * COUNT) : values[further(at, mid, i, r * COUNT)];
      if constexpr (DONE > 1) {
        const Complex* turn = turns + num_turns(N, DONE) + unsigned(i) % DONE;
        Complex each[R];
#pragma unroll
        for (int r = 1; r < R; ++r) {
          constexpr int HALF = R / 2;
          each[r] = r <= turned(R) ? turn[(r - 1) * DONE] : each[HALF] * each[r - HALF];
          held[b][r] = each[r] * held[b][r];
        }
      }
      butterfly<R>(held[b]);
    }
  }
  if (!LAST) __syncthreads();
#pragma unroll
  for (int b = 0; b < MOST; ++b) {
    const int i = thread + b * THREADS;
    if (COUNT % THREADS == 0 || i < COUNT) {
      const int inner = unsigned(i) % DONE, first = (i - inner) * R + inner;
      const int at = place(first), mid = place(first + 8);
#pragma unroll
      for (int r = 0; r < R; ++r) {
        if constexpr (LAST)
          store(b * R + r, first + r * DONE, held[b][r]);
        else
          values[further(at, mid, first, r * DONE)] = held[b][r];
      }
    }
  }
  if constexpr (!LAST) {
    __syncthreads();
    passes<N, DONE * R>(values, turns, load, store);
  }
}

// Transforms the values of `load(i)` with all N / PER_THREAD threads. Results go to `store(slot, i, value)`; the slots of
// a thread are the same in every call. `values` has place(N) elements and must not be accessed before the next barrier.
// `turns` are the num_turns(N, N) twiddle factors of all passes but the first. A pass of radix R on groups of D has
// exp(-2 pi i r j / (D R)) at (r - 1) D + j for r from 1 to `turned`(R).
template <int N, class Load, class Store>
__device__ __forceinline__ void transform(Complex* values, const Complex* turns, Load load, Store store) {
  passes<N, 1>(values, turns, load, store);
}

// Computes the inverse transform, times N, of a spectrum in the threads' slots; results go to `store(i, value)`. It is the
// forward transform with conjugation before and after.
template <int N, class Store>
__device__ __forceinline__ void transform_back(
    Complex* values, const Complex* turns, const Complex* spectrum, Store store) {
  __syncthreads();
#pragma unroll
  for (int slot = 0; slot < num_slots<N>(); ++slot) {
    const int i = slot_value<N>(slot);
    if (i >= 0) values[place(i)] = conjugate(spectrum[slot]);
  }
  __syncthreads();
  transform<N>(
      values, turns, [&](int i) { return values[place(i)]; },
      [&](int, int i, Complex value) { store(i, conjugate(value)); });
}

// Copies twiddle factors to shared memory.
template <int N>
__device__ __forceinline__ void copy_turns(Complex* here, const float2* turns) {
  for (int i = threadIdx.x; i < num_turns(N, N); i += N / PER_THREAD) here[i] = Complex{turns[i].x, turns[i].y};
}
