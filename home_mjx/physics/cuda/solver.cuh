// Islands, and MuJoCo's convex problem in each by Newton's method: what native/constraint.py and native/solver.py do.
//
// Mobiles that touch no other are solved by one lane each, at the same time; larger islands by the whole warp, one after
// the other. Sums over lanes are made in a fixed order, so that results do not depend on the batch.

struct Contact {
  real jacobian[2][3][6];  // contact frame (normal, two tangents) from the numbers of the first and the second mobile
  real weight, friction;
  real target[4], residual[4], slope[4];
  int first, second, active;
};
static_assert(sizeof(Contact) <= CONTACT_WORDS * sizeof(real), "launch.py gives too little room");

// One environment: pointers into shared memory and scratch.
struct Env {
  int agents, mobiles, statics, room;  // room: most contacts
  real *pos, *quat, *rot, *vel, *acc, *smooth, *half, *mass, *radius;
  int *used, *num_near, *island, *members, *rows, *offset, *counts;
  real *near, *near_from, *hessian, *gradient, *search;
  Contact* contacts;
  Numbers numbers;
  INLINE int dofs(int m) const { return m < agents ? AGENT_DOFS : BODY_DOFS; }
};

INLINE int num_rows(const Contact& c) { return c.friction > 0 ? 4 : 1; }

INLINE real edge_value(int row, real friction, const real* v) {
  const real tangent = row < 2 ? v[1] : v[2];
  return v[0] + (row % 2 == 0 ? friction * tangent : -friction * tangent);
}

// In the contact frame, of the second mobile against the first one.
INLINE void relative(const Contact& c, const real* first, const real* second, int dofs1, int dofs2, real* out) {
  for (int row = 0; row < 3; ++row) {
    real sum = 0;
    for (int k = 0; k < dofs1; ++k) sum += c.jacobian[0][row][k] * first[k];
    for (int k = 0; k < dofs2; ++k) sum += c.jacobian[1][row][k] * second[k];
    out[row] = sum;
  }
}

INLINE void relative(const Env& e, const Contact& c, const real* values, real* out) {
  const int b = c.second < 0 ? 0 : c.second;
  relative(c, values + 6 * c.first, values + 6 * b, e.dofs(c.first), c.second < 0 ? 0 : e.dofs(b), out);
}

INLINE real impedance(const Numbers& numbers, real depth) {
  const real x = depth / numbers.impedance_width;
  if (x >= 1) return numbers.impedance_high;
  const real y = x < real(0.5) ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
  return numbers.impedance_low + y * (numbers.impedance_high - numbers.impedance_low);
}

// Fills in a contact: its Jacobian, regularisation and reference accelerations.
__device__ void make_contact(const Env& e, Contact& c, int first, int second, real friction, const Point& point) {
  const Vec n = point.normal;
  const int axis = absolute(n.y) < real(0.5) ? 1 : 2;
  const real length = sqrt(1 - n[axis] * n[axis]);
  const Vec unit = {0, real(axis == 1), real(axis == 2)};
  const Vec tangent = (1 / length) * (unit - n[axis] * n);
  const Vec frame[3] = {n, tangent, cross(n, tangent)};
  c.first = first, c.second = second, c.friction = friction, c.active = 0;
  real inverse = 0;
  for (int side = 0; side < 2; ++side) {
    const int m = side == 0 ? first : second;
    if (m < 0) continue;
    const real sign = side == 0 ? -1 : 1;
    const real* rot = e.rot + 9 * m;
    const Vec arm = point.pos - Vec{e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
    for (int row = 0; row < 3; ++row) {
      const Vec turn = cross(arm, frame[row]);
      real* jacobian = c.jacobian[side][row];
      for (int k = 0; k < 3; ++k) {
        jacobian[k] = sign * frame[row][k];
        jacobian[3 + k] = m < e.agents ? 0 : sign * (rot[k] * turn.x + rot[3 + k] * turn.y + rot[6 + k] * turn.z);
      }
    }
    inverse += 1 / e.mass[6 * m];
  }
  const bool agent = first < e.agents;
  const real stiffness = agent ? e.numbers.agent_stiffness : e.numbers.body_stiffness;
  const real damping = agent ? e.numbers.agent_damping : e.numbers.body_damping;
  const real imp = impedance(e.numbers, -point.distance);
  if (friction > 0) inverse *= (1 + friction * friction) * 2 * friction * friction;
  c.weight = 1 / fmax(inverse * (1 - imp) / imp, real(1e-15));
  real velocity[3];
  relative(e, c, e.vel, velocity);
  for (int row = 0; row < num_rows(c); ++row)
    c.target[row] = -stiffness * imp * point.distance - damping * edge_value(row, friction, velocity);
}

INLINE int find_root(const int* island, int m) {
  while (island[m] != m) m = island[m];
  return m;
}

// Each mobile's island is its first mobile; sizes of islands.
__device__ void find_islands(const Env& e, int count) {
  if (LANE == 0) {
    for (int m = 0; m < e.mobiles; ++m) e.island[m] = m, e.members[m] = 0, e.rows[m] = 0;
    for (int n = 0; n < count; ++n)
      if (e.contacts[n].second >= 0) {
        const int a = find_root(e.island, e.contacts[n].first), b = find_root(e.island, e.contacts[n].second);
        e.island[a > b ? a : b] = a < b ? a : b;
      }
    for (int m = 0; m < e.mobiles; ++m) {
      const int root = e.island[m] = find_root(e.island, m);
      e.offset[m] = e.rows[root];  // first number in the island's vectors; `rows` counts the numbers for now
      e.rows[root] += e.dofs(m);
      ++e.members[root];
    }
    for (int m = 0; m < e.mobiles; ++m) e.rows[m] = 0;
    for (int n = 0; n < count; ++n) ++e.rows[e.island[e.contacts[n].first]];
  }
  sync_warp();
}

template <int WIDTH>
INLINE real sum_over(real x) {
  return WIDTH == 1 ? x : warp_sum(x);
}

template <int WIDTH>
INLINE void sync_group() {
  if (WIDTH > 1) sync_warp();
}

// What Newton's method works on: an island, or one mobile in a lane of its own.
struct Island {
  int root, size, count;  // count: contacts of the environment
  real *hessian, *gradient, *search;
};

#define CONTACTS_OF(n, c, s) \
  for (int n = LANE_OF(WIDTH); n < s.count; n += WIDTH) \
    if (Contact& c = e.contacts[n]; e.island[c.first] == s.root)
#define MEMBERS_OF(m, s) \
  for (int m = s.root + LANE_OF(WIDTH); m < e.mobiles; m += WIDTH) \
    if (e.used[m] && e.island[m] == s.root)

template <int WIDTH>
INLINE bool residuals(const Env& e, const Island& s) {
  real changed = 0;
  CONTACTS_OF(n, c, s) {
    real value[3];
    relative(e, c, e.acc, value);
    int active = 0;
    for (int row = 0; row < num_rows(c); ++row) {
      c.residual[row] = edge_value(row, c.friction, value) - c.target[row];
      if (c.residual[row] < 0) active |= 1 << row;
    }
    if (active != c.active) changed += 1;
    c.active = active;
  }
  return sum_over<WIDTH>(changed) > 0;
}

// Adds a contact's force to the gradient and its stiffness to the Hessian, entry by entry.
template <int WIDTH>
INLINE void add_contact(const Env& e, const Island& s, const Contact& c) {
  real force[3] = {0, 0, 0}, w00 = 0, w01 = 0, w02 = 0, w11 = 0, w22 = 0;
  for (int row = 0; row < num_rows(c); ++row)
    if (c.active & (1 << row)) {
      const real edge = row % 2 == 0 ? c.friction : -c.friction, push = c.weight * c.residual[row];
      force[0] += push, w00 += c.weight;
      if (row < 2)
        force[1] += push * edge, w01 += c.weight * edge, w11 += c.weight * edge * edge;
      else
        force[2] += push * edge, w02 += c.weight * edge, w22 += c.weight * edge * edge;
    }
  const int entries = c.second < 0 ? 6 : 12;
  for (int at = LANE_OF(WIDTH); at < entries * entries; at += WIDTH) {
    const int i = at / entries, j = at % entries, mi = i < 6 ? c.first : c.second, mj = j < 6 ? c.first : c.second;
    const int ki = i % 6, kj = j % 6;
    if (ki >= e.dofs(mi) || kj >= e.dofs(mj)) continue;
    const int row = e.offset[mi] + ki, column = e.offset[mj] + kj;
    const real x = c.jacobian[i / 6][0][ki], y = c.jacobian[i / 6][1][ki], z = c.jacobian[i / 6][2][ki];
    if (j == 0) s.gradient[row] += x * force[0] + y * force[1] + z * force[2];
    if (row < column) continue;
    const real u = w00 * x + w01 * y + w02 * z, v = w01 * x + w11 * y, w = w02 * x + w22 * z;
    s.hessian[s.size * row + column] +=
        u * c.jacobian[j / 6][0][kj] + v * c.jacobian[j / 6][1][kj] + w * c.jacobian[j / 6][2][kj];
  }
}

template <int WIDTH>
INLINE void assemble(const Env& e, const Island& s) {
  for (int i = LANE_OF(WIDTH); i < s.size * s.size; i += WIDTH) s.hessian[i] = 0;
  sync_group<WIDTH>();
  MEMBERS_OF(m, s) {
    for (int k = 0; k < e.dofs(m); ++k) {
      const int at = e.offset[m] + k;
      s.hessian[s.size * at + at] = e.mass[6 * m + k];
      s.gradient[at] = e.mass[6 * m + k] * (e.acc[6 * m + k] - e.smooth[6 * m + k]);
    }
  }
  sync_group<WIDTH>();
  for (int n = 0; n < s.count; ++n) {
    const Contact& c = e.contacts[n];
    if (e.island[c.first] != s.root || !c.active) continue;
    add_contact<WIDTH>(e, s, c);
    sync_group<WIDTH>();
  }
}

// Cholesky, in place of the lower triangle.
template <int WIDTH>
INLINE void factorise(const Island& s) {
  real* h = s.hessian;
  const int size = s.size;
  for (int j = 0; j < size; ++j) {
    for (int i = j + LANE_OF(WIDTH); i < size; i += WIDTH) {
      real value = h[size * i + j];
      for (int k = 0; k < j; ++k) value -= h[size * i + k] * h[size * j + k];
      s.search[i] = value;
    }
    sync_group<WIDTH>();
    const real pivot = sqrt(fmax(s.search[j], SMALLEST));
    for (int i = j + LANE_OF(WIDTH); i < size; i += WIDTH) h[size * i + j] = i == j ? pivot : s.search[i] / pivot;
    sync_group<WIDTH>();
  }
}

template <int WIDTH>
INLINE void back_substitute(const Island& s) {
  const int size = s.size;
  for (int i = 0; i < size; ++i) {
    real sum = 0;
    for (int k = LANE_OF(WIDTH); k < i; k += WIDTH) sum += s.hessian[size * i + k] * s.search[k];
    sum = sum_over<WIDTH>(sum);
    if (LANE_OF(WIDTH) == 0) s.search[i] = (-s.gradient[i] - sum) / s.hessian[size * i + i];
    sync_group<WIDTH>();
  }
  for (int i = size - 1; i >= 0; --i) {
    real sum = 0;
    for (int k = i + 1 + LANE_OF(WIDTH); k < size; k += WIDTH) sum += s.hessian[size * k + i] * s.search[k];
    sum = sum_over<WIDTH>(sum);
    if (LANE_OF(WIDTH) == 0) s.search[i] = (s.search[i] - sum) / s.hessian[size * i + i];
    sync_group<WIDTH>();
  }
}

template <int WIDTH>
INLINE void derivatives(const Env& e, const Island& s, real start, real curve, real length, real& slope, real& bend) {
  real first = 0, second = 0;
  CONTACTS_OF(n, c, s) {
    for (int row = 0; row < num_rows(c); ++row) {
      const real rate = c.slope[row], value = c.residual[row] + length * rate;
      if (value < 0) first += c.weight * value * rate, second += c.weight * rate * rate;
    }
  }
  slope = start + length * curve + sum_over<WIDTH>(first);
  bend = curve + sum_over<WIDTH>(second);
}

template <int WIDTH>
INLINE real line_search(const Env& e, const Island& s) {
  real start = 0, curve = 0, scale = 0;
  MEMBERS_OF(m, s) {
    for (int k = 0; k < e.dofs(m); ++k) {
      const real step = s.search[e.offset[m] + k], mass = e.mass[6 * m + k];
      const real guess = e.acc[6 * m + k], free = e.smooth[6 * m + k];
      start += mass * (guess - free) * step, curve += mass * step * step;
      scale += mass * (guess * guess + free * free);
    }
  }
  start = sum_over<WIDTH>(start), curve = sum_over<WIDTH>(curve), scale = sum_over<WIDTH>(scale);
  CONTACTS_OF(n, c, s) {
    real value[3];
    const int b = c.second < 0 ? c.first : c.second;
    relative(c, s.search + e.offset[c.first], s.search + e.offset[b], e.dofs(c.first), c.second < 0 ? 0 : e.dofs(b), value);
    for (int row = 0; row < num_rows(c); ++row) c.slope[row] = edge_value(row, c.friction, value);
  }
  real before, bend;
  derivatives<WIDTH>(e, s, start, curve, 0, before, bend);
  if (!(before < -SOLVED * scale)) return 0;
  real low = 0, high = INF, length = 1;
  for (int i = 0; i < LINE_STEPS; ++i) {
    real slope;
    derivatives<WIDTH>(e, s, start, curve, length, slope, bend);
    if (absolute(slope) <= -ENOUGH * before) return length;
    if (slope < 0) low = length;
    else high = length;
    length -= slope / bend;
    if (length <= low || length >= high) length = high < INF ? (low + high) / 2 : 2 * low;
  }
  return length;
}

template <int WIDTH>
__device__ __noinline__ void newton(const Env& e, const Island& s) {
  bool full = false;
  for (int i = 0; i < int(e.numbers.iterations); ++i) {
    const bool changed = residuals<WIDTH>(e, s);
    sync_group<WIDTH>();
    if (full && !changed) return;
    assemble<WIDTH>(e, s);
    factorise<WIDTH>(s);
    back_substitute<WIDTH>(s);
    const real length = line_search<WIDTH>(e, s);
    if (length == 0) return;
    full = length == 1;
    MEMBERS_OF(m, s) {
      for (int k = 0; k < e.dofs(m); ++k) e.acc[6 * m + k] += length * s.search[e.offset[m] + k];
    }
    sync_group<WIDTH>();
  }
}

__device__ void solve(const Env& e, int count) {
  find_islands(e, count);
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) {
    if (!e.used[m] || e.island[m] != m || e.members[m] > 1) continue;
    if (e.rows[m] == 0) {
      for (int k = 0; k < 6; ++k) e.acc[6 * m + k] = e.smooth[6 * m + k];
    } else {
      real hessian[BODY_DOFS * BODY_DOFS], gradient[BODY_DOFS], search[BODY_DOFS];
      newton<1>(e, {m, e.dofs(m), count, hessian, gradient, search});
    }
  }
  sync_warp();
  for (int root = 0; root < e.mobiles; ++root)
    if (e.used[root] && e.island[root] == root && e.members[root] > 1) {
      int size = 0;
      for (int m = root; m < e.mobiles; ++m)
        if (e.island[m] == root) size += e.dofs(m);
      newton<WARP_SIZE>(e, {root, size, count, e.hessian, e.gradient, e.search});
      sync_warp();
    }
}
