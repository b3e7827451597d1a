// One environment and its contacts; counterpart of numba/constraint.py.

// Contribution of a contact to gradient and Hessian, in its frame.
struct Push {
  real force[3];
  real w00, w01, w02, w11, w22;
};

struct Contact {
  real frame[3][3];                       // rows: normal from the first to the second body, two tangents
  real turn[2][3][3];                     // velocities in the frame from the spins of the first and the second body
  real weight, friction;                  // weight: 1 / regularisation of its rows
  real target[3], residual[3], slope[3];  // in the frame; `edge_value` projects them on the rows
  Push push;
  real pos[3];
  int first, second, active;
};
static_assert(sizeof(Contact) <= CONTACT_WORDS * sizeof(real), "fused.py allocates too little memory per contact");

// One environment: pointers into shared memory and scratch.
struct Env {
  int agents, free, mobiles, statics;  // free: agents + bodies, index of the first door; mobiles: up to the last one
  int room, pair_room;                 // maximum numbers of contacts and of pairs of dynamic bodies
  int first_tray;                      // index of the first leaf that may have a tray; that of no body without trays
  // Element 0 of quat is an agent's yaw or a door's coordinate. All dynamic bodies have six velocities; a door's rate is
  // the last, and HEAVY masses keep the others at zero.
  real *pos, *quat, *rot, *vel, *acc, *smooth, *half, *mass, *inverse, *radius, *impulse;
  Flag *awake, *exists, *calm, *wakes;
  short* num_near;
  Index *island, *members, *rows, *end, *offset, *list, *order;  // list: awake dynamic bodies
  int *counts, *pairs;                                           // pairs: dynamic bodies near each other
  real *near, *near_from, *small, *large;  // small and large: memory for Newton's method, small is shared memory
  const float *agent, *door, *surface;  // tables of the agents, the house's doors and its bodies
  const float* tray;                    // TRAY_ROWS rows of each leaf that may have a tray
  real rougher;                         // friction factor of bodies
  Contact *first_contacts, *contacts;  // the first few are in shared memory
  Numbers numbers;
};

INLINE Contact& contact(const Env& e, int n) { return n < SHARED_CONTACTS ? e.first_contacts[n] : e.contacts[n]; }

// Returns the lever arm from a body's rotation axis to a point. For a leaf that slides along s it is s x up, so that its
// rotation becomes the displacement along s.
INLINE Vec arm_to(const Env& e, int m, Vec at) {
  const Vec arm = at - Vec{e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
  if (m < e.free) return arm;
  const float* door = e.door + DOOR_COLUMNS * (m - e.free);
  return {door[15] * (at.x - door[0]) + door[14], door[15] * (at.y - door[1]) - door[13], arm.z};
}

INLINE int num_rows(const Contact& c) { return c.friction > 0 ? 4 : 1; }

INLINE real edge_value(int row, real friction, const real* v) {
  const real tangent = row < 2 ? v[1] : v[2];
  return v[0] + (row % 2 == 0 ? friction * tangent : -friction * tangent);
}

// Adds the first (0) or second (1) body's part to the relative velocity in the contact frame.
template <int SIDE>
INLINE void add_relative(const Contact& c, const real* values, real* out) {
#pragma unroll
  for (int row = 0; row < 3; ++row)
#pragma unroll
    for (int k = 0; k < 3; ++k)
      out[row] += c.turn[SIDE][row][k] * values[3 + k] + (SIDE == 0 ? -c.frame[row][k] : c.frame[row][k]) * values[k];
}

// Computes the velocity of the second body relative to the first; `place` maps a body to its offset in `values`.
template <class Place>
INLINE void relative(const Contact& c, const real* values, Place place, real* out) {
  out[0] = out[1] = out[2] = 0;
  add_relative<0>(c, values + place(c.first), out);
  if (c.second >= 0) add_relative<1>(c, values + place(c.second), out);
}

INLINE int six(int mobile) { return 6 * mobile; }

INLINE real impedance(real low, real high, real x) {
  if (x >= 1) return high;
  const real y = x < real(0.5) ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
  return low + y * (high - low);
}

// Contact parameters.
struct Surface {
  real friction, stiffness, damping, low, width;
};

INLINE Surface surface_of(const Env& e, int first, int second) {
  const Numbers& n = e.numbers;
  if (second == JOINT_LIMIT || first < e.agents) return {0, n.stiffness, n.damping, n.impedance_low, n.impedance_width};
  int other = second <= SLEEPING_BODY ? SLEEPING_BODY - second : second;
  if (first >= e.free) other = first, first = SLEEPING_BODY - second;  // a door that meets a sleeping body
  const float* own = e.surface + SURFACE_COLUMNS * (first - e.agents);
  const float* its = other < 0 || other >= e.free ? own : e.surface + SURFACE_COLUMNS * (other - e.agents);
  return {fmax(real(own[0]), real(its[0])) * e.rougher, fmax(real(own[1]), real(its[1])), fmax(real(own[2]), real(its[2])),
          (real(own[3]) + its[3]) / 2, (real(own[4]) + its[4]) / 2};
}

// Writes a contact's Jacobian, regularisation and reference accelerations.
__device__ void make_contact(const Env& e, Contact& c, int first, int second, const Point& point) {
  const Vec n = point.normal;
  const int axis = absolute(n.y) < real(0.5) ? 1 : 2;
  const real length = sqrt(1 - n[axis] * n[axis]);
  const Vec unit = {0, real(axis == 1), real(axis == 2)};
  const Vec tangent = (1 / length) * (unit - n[axis] * n);
  const Vec frame[3] = {n, tangent, cross(n, tangent)};
  c.first = first, c.second = second, c.active = 0;
  for (int k = 0; k < 3; ++k) c.pos[k] = point.pos[k];
  real inverse = 0;
  for (int row = 0; row < 3; ++row)
    for (int k = 0; k < 3; ++k) c.frame[row][k] = frame[row][k];
  for (int side = 0; side < 2; ++side) {
    const int m = side == 0 ? first : second;
    if (m < 0) continue;
    const real sign = m < e.agents ? 0 : side == 0 ? -1 : 1;
    const real* rot = e.rot + 9 * m;
    const Vec arm = arm_to(e, m, point.pos);
    for (int row = 0; row < 3; ++row) {
      const Vec turn = cross(arm, frame[row]);
      for (int k = 0; k < 3; ++k)
        c.turn[side][row][k] = sign * (rot[k] * turn.x + rot[3 + k] * turn.y + rot[6 + k] * turn.z);
    }
    inverse += e.inverse[m];
  }
  if (second == JOINT_LIMIT) {  // at a joint limit, the first row is the door's rate itself
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) c.frame[row][k] = 0, c.turn[0][row][k] = row == 0 && k == 2 ? n.x : 0;
    inverse = 1 / e.mass[6 * first + 5];
  }
  const Surface surface = surface_of(e, first, second);
  const real imp = impedance(surface.low, e.numbers.impedance_high, -point.distance / surface.width);
  const real friction = c.friction = surface.friction;
  if (friction > 0) inverse *= (1 + friction * friction) * 2 * friction * friction;
  c.weight = 1 / fmax(inverse * (1 - imp) / imp, real(1e-15));
  real velocity[3];
  relative(c, e.vel, six, velocity);
  for (int k = 0; k < 3; ++k) c.target[k] = -surface.damping * velocity[k];
  c.target[0] -= surface.stiffness * imp * point.distance;
}

// Updates a contact's active rows at the accelerations `value` in its frame; returns whether the active set changed.
INLINE bool set_residual(Contact& c, const real* value) {
  real residual[3];
  int active = 0;
#pragma unroll
  for (int k = 0; k < 3; ++k) c.residual[k] = residual[k] = value[k] - c.target[k];
#pragma unroll
  for (int row = 0; row < 4; ++row)
    if (row < num_rows(c) && edge_value(row, c.friction, residual) < 0) active |= 1 << row;
  const bool changed = active != c.active;
  c.active = active;
  return changed;
}

INLINE Push push_of(const Contact& c) {
  Push p = {{0, 0, 0}, 0, 0, 0, 0, 0};
#pragma unroll
  for (int row = 0; row < 4; ++row)
    if (c.active & (1 << row)) {
      const real edge = row % 2 == 0 ? c.friction : -c.friction, push = c.weight * edge_value(row, c.friction, c.residual);
      p.force[0] += push, p.w00 += c.weight;
      if (row < 2)
        p.force[1] += push * edge, p.w01 += c.weight * edge, p.w11 += c.weight * edge * edge;
      else
        p.force[2] += push * edge, p.w02 += c.weight * edge, p.w22 += c.weight * edge * edge;
    }
  return p;
}

// Adds a contact's share to the cost's derivatives at a length along the search direction.
INLINE void add_derivatives(const Contact& c, real length, real& first, real& second) {
#pragma unroll
  for (int row = 0; row < 4; ++row) {
    if (row >= num_rows(c)) break;
    const real rate = edge_value(row, c.friction, c.slope);
    const real value = edge_value(row, c.friction, c.residual) + length * rate;
    if (value < 0) first += c.weight * value * rate, second += c.weight * rate * rate;
  }
}
