// Islands, and Newton's method for MuJoCo's convex problem in each; counterpart of numba/solver.py.
//
// Bodies that touch no other dynamic body are solved in registers, one per lane in parallel. Larger islands are solved
// by the whole warp, one after another. Sums over lanes have a fixed order, so results do not depend on the batch.

INLINE int find_root(const Index* island, int m) {
  while (island[m] != m) m = island[m];
  return m;
}

// Labels each body with the first body of its island, counts bodies and contacts, and sorts contacts by island.
__device__ void find_islands(const Env& e, int count) {
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) e.island[m] = m, e.members[m] = e.rows[m] = 0;
  sync_warp();
  for (int base = 0; base < count; base += WARP_SIZE) {
    const int n = base + LANE, first = n < count ? contact(e, n).first : 0, second = n < count ? contact(e, n).second : -1;
    for (unsigned left = warp_ballot(second >= 0); left; left &= left - 1) {
      const int lane = count_bits((left & -left) - 1);
      const int a = find_root(e.island, from_lane(first, lane)), b = find_root(e.island, from_lane(second, lane));
      sync_warp();
      if (LANE == 0) e.island[a > b ? a : b] = a < b ? a : b;
      sync_warp();
    }
  }
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) e.end[m] = find_root(e.island, m);
  sync_warp();
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) e.island[m] = e.end[m];
  sync_warp();
  const int awake = e.counts[NUM_AWAKE];
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE)
    for (int i = 0; i < awake; ++i) e.members[m] += e.island[e.list[i]] == m;
  for (int pass = 0; pass < 2; ++pass) {  // first counts, then positions
    for (int base = 0; base < count; base += WARP_SIZE) {
      const int n = base + LANE, root = n < count ? e.island[contact(e, n).first] : -1;
      const unsigned alike = warp_alike(root), before = alike & ((1u << LANE) - 1);
      if (pass == 1 && n < count) e.order[e.end[root] + count_bits(before)] = n;
      sync_warp();
      if (n < count && !before) (pass == 0 ? e.rows : e.end)[root] += count_bits(alike);
      sync_warp();
    }
    if (pass == 1) break;
    for (int base = 0, start = 0; base < e.mobiles; base += WARP_SIZE) {
      const int m = base + LANE, rows = m < e.mobiles ? e.rows[m] : 0, sum = sum_before(rows) + rows;
      if (m < e.mobiles) e.end[m] = start + sum - rows;
      start += from_lane(sum, WARP_SIZE - 1);
    }
    sync_warp();
  }
}

// Exact line search: finds the zero of the cost's slope. `derivatives` computes slope and curvature at a length.
template <class Derivatives>
INLINE real find_length(real scale, Derivatives derivatives) {
  real before, bend, low = 0, high = INF, length = 1;
  derivatives(real(0), before, bend);
  if (!(before < -NEWTON_TOLERANCE * scale)) return 0;
  for (int i = 0; i < MAX_LINE_STEPS; ++i) {
    real slope;
    derivatives(length, slope, bend);
    if (absolute(slope) <= -LINE_SEARCH_TOLERANCE * before) return length;
    if (slope < 0) low = length;
    else high = length;
    length -= slope / bend;
    if (length <= low || length >= high) length = high < INF ? (low + high) / 2 : 2 * low;
  }
  return length;
}

// Newton's method for a single body, in registers: loops over its six DoFs are unrolled.
struct Alone {
  real mass[6], free[6], acc[6], search[6];
  real hessian[6][6], gradient[6];

  INLINE void start() {
#pragma unroll
    for (int i = 0; i < 6; ++i) {
#pragma unroll
      for (int j = 0; j < i; ++j) hessian[i][j] = 0;
      hessian[i][i] = mass[i], gradient[i] = mass[i] * (acc[i] - free[i]);
    }
  }

  INLINE void add(const Contact& c) {
    const Push p = push_of(c);
    real jacobian[3][6];
#pragma unroll
    for (int row = 0; row < 3; ++row)
#pragma unroll
      for (int k = 0; k < 3; ++k) jacobian[row][k] = -c.frame[row][k], jacobian[row][3 + k] = c.turn[0][row][k];
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      const real x = jacobian[0][i], y = jacobian[1][i], z = jacobian[2][i];
      const real u = p.w00 * x + p.w01 * y + p.w02 * z, v = p.w01 * x + p.w11 * y, w = p.w02 * x + p.w22 * z;
      gradient[i] += x * p.force[0] + y * p.force[1] + z * p.force[2];
#pragma unroll
      for (int j = 0; j <= i; ++j) hessian[i][j] += u * jacobian[0][j] + v * jacobian[1][j] + w * jacobian[2][j];
    }
  }

  // Cholesky in place, then search = -hessian^-1 gradient.
  INLINE void find_search() {
#pragma unroll
    for (int j = 0; j < 6; ++j) {
#pragma unroll
      for (int i = j; i < 6; ++i) {
#pragma unroll
        for (int k = 0; k < j; ++k) hessian[i][j] -= hessian[i][k] * hessian[j][k];
        if (i == j) hessian[j][j] = 1 / sqrt(fmax(hessian[j][j], MIN_PIVOT));  // its inverse
        else hessian[i][j] *= hessian[j][j];
      }
    }
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      search[i] = -gradient[i];
#pragma unroll
      for (int k = 0; k < i; ++k) search[i] -= hessian[i][k] * search[k];
      search[i] *= hessian[i][i];
    }
#pragma unroll
    for (int i = 5; i >= 0; --i) {
#pragma unroll
      for (int k = i + 1; k < 6; ++k) search[i] -= hessian[k][i] * search[k];
      search[i] *= hessian[i][i];
    }
  }

  INLINE real find_step(const Env& e, const Index* contacts, int count) {
    real start = 0, curve = 0, scale = 0;
#pragma unroll
    for (int k = 0; k < 6; ++k) {
      start += mass[k] * (acc[k] - free[k]) * search[k], curve += mass[k] * search[k] * search[k];
      scale += mass[k] * (acc[k] * acc[k] + free[k] * free[k]);
    }
    for (int i = 0; i < count; ++i) {
      Contact& c = contact(e, contacts[i]);
      real slope[3] = {0, 0, 0};
      add_relative<0>(c, search, slope);
#pragma unroll
      for (int k = 0; k < 3; ++k) c.slope[k] = slope[k];
    }
    return find_length(scale, [&](real length, real& slope, real& bend) {
      slope = start + length * curve, bend = curve;
      for (int i = 0; i < count; ++i) add_derivatives(contact(e, contacts[i]), length, slope, bend);
    });
  }
};

__device__ __noinline__ void solve_alone(const Env& e, int m) {
  Alone own;
#pragma unroll
  for (int k = 0; k < 6; ++k)
    own.mass[k] = e.mass[6 * m + k], own.free[k] = e.smooth[6 * m + k], own.acc[k] = e.acc[6 * m + k];
  const int count = e.rows[m];
  const Index* contacts = e.order + e.end[m] - count;
  bool full = false;
  for (int i = 0; i < int(e.numbers.iterations); ++i) {
    bool changed = false;
    for (int n = 0; n < count; ++n) {
      Contact& c = contact(e, contacts[n]);
      real value[3] = {0, 0, 0};
      add_relative<0>(c, own.acc, value);
      changed |= set_residual(c, value);
    }
    if (full && !changed) break;
    own.start();
    for (int n = 0; n < count; ++n)
      if (const Contact& c = contact(e, contacts[n]); c.active) own.add(c);
    own.find_search();
    const real length = own.find_step(e, contacts, count);
    if (length == 0) break;
    full = length == 1;
#pragma unroll
    for (int k = 0; k < 6; ++k) own.acc[k] += length * own.search[k];
  }
#pragma unroll
  for (int k = 0; k < 6; ++k) e.acc[6 * m + k] = own.acc[k];
}

// An island of several bodies, solved by the whole warp. The DoFs of body m are at offset[m] of its vectors.
struct Joined {
  int root, size, count;
  const Index *contacts, *offset;
  real *hessian, *gradient, *search;
};

#define CONTACTS_OF(c, s)                         \
  for (int n = LANE; n < s.count; n += WARP_SIZE) \
    if (Contact& c = contact(e, s.contacts[n]); true)
#define MEMBERS_OF(m, s)                                     \
  for (int m = s.root + LANE; m < e.mobiles; m += WARP_SIZE) \
    if (e.awake[m] && e.island[m] == s.root)

INLINE int packed(int row, int column) { return row * (row + 1) / 2 + column; }  // of a lower triangle
__device__ constexpr int newton_words(int size) { return size * (size + 1) / 2 + 2 * size; }

// One element that a contact adds to: of the Hessian's blocks of the first body (21), the second one (21) and both (36),
// or of the gradient (12). Each lane owns a few elements, the same for all contacts.
struct Entry {
  int side[2], at[2];  // for row and column: the contact's body, and the index of its DoF
  bool gradient;
};
constexpr int ENTRIES = 90, OWN_ENTRIES = (ENTRIES + WARP_SIZE - 1) / WARP_SIZE;

INLINE Entry entry(int n) {
  if (n >= 78) return {{(n - 78) / 6, 0}, {(n - 78) % 6, 0}, true};
  if (n >= 42) return {{1, 0}, {(n - 42) / 6, (n - 42) % 6}, false};
  const int side = n / 21;
  int row = 0, column = n % 21;
  while (column > row) column -= ++row;
  return {{side, side}, {row, column}, false};
}

INLINE real jacobian(const Contact& c, int row, int side, int k) {
  return k >= 3 ? c.turn[side][row][k - 3] : side ? c.frame[row][k] : -c.frame[row][k];
}

// Adds a contact's forces to the gradient and its stiffness to the Hessian.
INLINE void add_contact(const Joined& s, const Contact& c, const Entry* entries) {
  const Push& p = c.push;
  const int offset[2] = {s.offset[c.first], c.second < 0 ? -1 : s.offset[c.second]};
#pragma unroll
  for (int n = 0; n < OWN_ENTRIES; ++n) {
    const Entry& own = entries[n];
    if (LANE + n * WARP_SIZE >= ENTRIES || (c.second < 0 && (own.side[0] || own.side[1]))) continue;
    const int row = offset[own.side[0]] + own.at[0], column = offset[own.side[1]] + own.at[1];
    const real x = jacobian(c, 0, own.side[0], own.at[0]), y = jacobian(c, 1, own.side[0], own.at[0]),
               z = jacobian(c, 2, own.side[0], own.at[0]);
    if (own.gradient) {
      s.gradient[row] += x * p.force[0] + y * p.force[1] + z * p.force[2];
    } else {
      const real u = p.w00 * x + p.w01 * y + p.w02 * z, v = p.w01 * x + p.w11 * y, w = p.w02 * x + p.w22 * z;
      s.hessian[row > column ? packed(row, column) : packed(column, row)] +=
          u * jacobian(c, 0, own.side[1], own.at[1]) + v * jacobian(c, 1, own.side[1], own.at[1]) +
          w * jacobian(c, 2, own.side[1], own.at[1]);
    }
  }
}

INLINE void assemble(const Env& e, const Joined& s, const Entry* entries) {
  CONTACTS_OF(c, s) { c.push = push_of(c); }
  for (int i = LANE; i < packed(s.size, 0); i += WARP_SIZE) s.hessian[i] = 0;
  sync_warp();
  MEMBERS_OF(m, s) {
    for (int k = 0; k < 6; ++k) {
      const int at = s.offset[m] + k;
      s.hessian[packed(at, at)] = e.mass[6 * m + k];
      s.gradient[at] = e.mass[6 * m + k] * (e.acc[6 * m + k] - e.smooth[6 * m + k]);
    }
  }
  sync_warp();
  for (int n = 0; n < s.count; ++n) {
    const Contact& c = contact(e, s.contacts[n]);
    if (!c.active) continue;
    add_contact(s, c, entries);
    sync_warp();
  }
}

// Cholesky in place of the lower triangle, then search = -hessian^-1 gradient.
INLINE void find_search(const Joined& s) {
  real *h = s.hessian, *x = s.search;
  const int size = s.size;
  for (int j = 0; j < size; ++j) {
    for (int i = j + LANE; i < size; i += WARP_SIZE) {
      const real *row = h + packed(i, 0), *other = h + packed(j, 0);
      real value = row[j];
      for (int k = 0; k < j; ++k) value -= row[k] * other[k];
      x[i] = value;
    }
    sync_warp();
    const real pivot = sqrt(fmax(x[j], MIN_PIVOT));
    for (int i = j + LANE; i < size; i += WARP_SIZE) h[packed(i, j)] = i == j ? pivot : x[i] / pivot;
    sync_warp();
  }
  for (int i = LANE; i < size; i += WARP_SIZE) x[i] = -s.gradient[i];
  sync_warp();
  for (int j = 0; j < size; ++j) {
    const real value = x[j] / h[packed(j, j)];
    sync_warp();
    for (int i = j + LANE; i < size; i += WARP_SIZE) x[i] = i == j ? value : x[i] - h[packed(i, j)] * value;
    sync_warp();
  }
  for (int j = size - 1; j >= 0; --j) {
    const real value = x[j] / h[packed(j, j)];
    sync_warp();
    for (int i = LANE; i <= j; i += WARP_SIZE) x[i] = i == j ? value : x[i] - h[packed(j, i)] * value;
    sync_warp();
  }
}

INLINE real find_step(const Env& e, const Joined& s) {
  real start = 0, curve = 0, scale = 0;
  MEMBERS_OF(m, s) {
    for (int k = 0; k < 6; ++k) {
      const real step = s.search[s.offset[m] + k], mass = e.mass[6 * m + k];
      const real guess = e.acc[6 * m + k], free = e.smooth[6 * m + k];
      start += mass * (guess - free) * step, curve += mass * step * step;
      scale += mass * (guess * guess + free * free);
    }
  }
  start = warp_sum(start), curve = warp_sum(curve), scale = warp_sum(scale);
  CONTACTS_OF(c, s) {
    relative(c, s.search, [&](int m) { return s.offset[m]; }, c.slope);
  }
  return find_length(scale, [&](real length, real& slope, real& bend) {
    real first = 0, second = 0;
    CONTACTS_OF(c, s) { add_derivatives(c, length, first, second); }
    slope = start + length * curve + warp_sum(first), bend = curve + warp_sum(second);
  });
}

__device__ __noinline__ void solve_joined(const Env& e, const Joined& s) {
  bool full = false;
  Entry entries[OWN_ENTRIES];
#pragma unroll
  for (int n = 0; n < OWN_ENTRIES; ++n) entries[n] = entry(LANE + n * WARP_SIZE < ENTRIES ? LANE + n * WARP_SIZE : 0);
  for (int i = 0; i < int(e.numbers.iterations); ++i) {
    bool changed = false;
    CONTACTS_OF(c, s) {
      real value[3];
      relative(c, e.acc, six, value);
      changed |= set_residual(c, value);
    }
    const bool any = warp_ballot(changed) != 0;
    sync_warp();
    if (full && !any) return;
    assemble(e, s, entries);
    find_search(s);
    const real length = find_step(e, s);
    if (length == 0) return;
    full = length == 1;
    MEMBERS_OF(m, s) {
      for (int k = 0; k < 6; ++k) e.acc[6 * m + k] += length * s.search[s.offset[m] + k];
    }
    sync_warp();
  }
}

__device__ void solve(const Env& e, int count) {
  find_islands(e, count);
  const int awake = e.counts[NUM_AWAKE];
  for (int i = LANE; i < awake; i += WARP_SIZE) {
    const int m = e.list[i];
    if (e.island[m] != m || e.members[m] > 1) continue;
    if (e.rows[m] == 0)
      for (int k = 0; k < 6; ++k) e.acc[6 * m + k] = e.smooth[6 * m + k];
    else
      solve_alone(e, m);
  }
  sync_warp();
  for (int i = 0; i < awake; ++i) {
    const int root = e.list[i];
    if (e.island[root] != root || e.members[root] == 1) continue;
    if (LANE == 0)
      for (int k = i, at = 0; k < awake; ++k)
        if (const int m = e.list[k]; e.island[m] == root) e.offset[m] = at, at += 6;
    sync_warp();
    const int size = 6 * e.members[root], count = e.rows[root];
    real* memory = e.members[root] <= SMALL_ISLAND ? e.small : e.large;
    real* gradient = memory + packed(size, 0);
    solve_joined(e, {root, size, count, e.order + e.end[root] - count, e.offset, memory, gradient, gradient + size});
    sync_warp();
  }
}
