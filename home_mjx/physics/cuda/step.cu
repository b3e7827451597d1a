// The fused physics step on NVIDIA GPUs: one warp per environment does all physics steps of a control step.
// cuda.py puts shapes.cuh and solver.cuh before this file and compiles them at run time.
//
// It does what native/ does on CPUs, where the formulas and their sources are.

// Writes the contacts of the pairs that the lanes hold, in the order of lanes.
__device__ int write_contacts(const Env& e, int count, int first, int second, real friction, const Points& points) {
  int before = points.count;  // inclusive sum over lanes
  for (int step = 1; step < WARP_SIZE; step *= 2) {
    const int other = from_lane(before, LANE - step);
    if (LANE >= step) before += other;
  }
  const int total = from_lane(before, WARP_SIZE - 1), start = count + before - points.count;
  for (int i = 0; i < points.count; ++i)
    if (start + i < e.room) make_contact(e, e.contacts[start + i], first, second, friction, points.at[i]);
  if (count + total > e.room) {
    if (LANE == 0) e.counts[LOST_POINTS] = 1;
    return e.room;
  }
  return count + total;
}

INLINE Box mobile_box(const Env& e, int m) {
  Box box;
  const real* rot = e.rot + 9 * m;
  box.pos = {e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
  for (int k = 0; k < 3; ++k) {
    box.axis[k] = {rot[k], rot[3 + k], rot[6 + k]};
    box.half[k] = e.half[3 * m + k];
  }
  return box;
}

INLINE void rotation(const real* q, real* rot) {
  const real w = q[0], x = q[1], y = q[2], z = q[3];
  rot[0] = 1 - 2 * (y * y + z * z), rot[1] = 2 * (x * y - w * z), rot[2] = 2 * (x * z + w * y);
  rot[3] = 2 * (x * y + w * z), rot[4] = 1 - 2 * (x * x + z * z), rot[5] = 2 * (y * z - w * x);
  rot[6] = 2 * (x * z - w * y), rot[7] = 2 * (y * z + w * x), rot[8] = 1 - 2 * (x * x + y * y);
}

struct House {
  const float *pos, *quat, *half;
};

INLINE Box static_box(const House& house, int c) {
  Box box;
  real rot[9], quat[4];
  for (int k = 0; k < 4; ++k) quat[k] = house.quat[4 * c + k];
  rotation(quat, rot);
  box.pos = {house.pos[3 * c], house.pos[3 * c + 1], house.pos[3 * c + 2]};
  for (int k = 0; k < 3; ++k) {
    box.axis[k] = {rot[k], rot[3 + k], rot[6 + k]};
    box.half[k] = house.half[3 * c + k];
  }
  return box;
}

// Whether one of the six face axes separates two boxes by more than `reach`.
INLINE bool apart(const Box& a, const Box& b, real reach) {
  const Vec between = b.pos - a.pos;
  for (int k = 0; k < 3; ++k) {
    real own = a.half[k], other = b.half[k];
    for (int j = 0; j < 3; ++j) {
      own += absolute(dot(a.axis[k], b.axis[j])) * b.half[j];
      other += absolute(dot(b.axis[k], a.axis[j])) * a.half[j];
    }
    if (absolute(dot(a.axis[k], between)) - own > reach || absolute(dot(b.axis[k], between)) - other > reach) return true;
  }
  return false;
}

// How far any point of a mobile can have moved since its static boxes were looked for, at most.
INLINE real moved(const Env& e, int m) {
  real square = 0, turn = 0;
  for (int k = 0; k < 3; ++k) {
    const real step = e.pos[3 * m + k] - e.near_from[12 * m + k];
    square += step * step;
  }
  for (int k = 0; k < 9; ++k) {
    const real step = e.rot[9 * m + k] - e.near_from[12 * m + 3 + k];
    turn += step * step;
  }
  return sqrt(square) + e.radius[m] * sqrt(turn);
}

// Looks for static boxes near the mobiles that have moved; the lanes share the static boxes.
__device__ void keep_near(const Env& e, const House& house) {
  bool any = false;
  int* looks = e.members;  // which mobiles have moved
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) {
    looks[m] = e.used[m] && (e.num_near[m] < 0 || moved(e, m) >= REACH);
    if (!looks[m]) continue;
    any = true, e.num_near[m] = 0;
    for (int k = 0; k < 12; ++k) e.near_from[12 * m + k] = k < 3 ? e.pos[3 * m + k] : e.rot[9 * m + k - 3];
  }
  if (!warp_ballot(any)) return;
  sync_warp();
  for (int base = 0; base < e.statics; base += WARP_SIZE) {
    const int c = base + LANE;
    const bool here = c < e.statics && house.half[3 * c] >= 0;
    const Box box = static_box(house, here ? c : 0);
    for (int m = 0; m < e.mobiles; ++m) {
      if (!looks[m]) continue;
      const Box own = mobile_box(e, m);
      const real reach = e.radius[m] + REACH;
      const Vec at = box.local(own.pos - box.pos);
      real square = 0;
#pragma unroll
      for (int k = 0; k < 3; ++k) {
        const real beyond = fmax(absolute(at[k]) - box.half[k], real(0));
        square += beyond * beyond;
      }
      const bool close = here && square < reach * reach && !apart(own, box, REACH);
      const unsigned mask = warp_ballot(close);
      const int place = e.num_near[m] + count_bits(mask & ((1u << LANE) - 1));
      if (close && place < NEAR) e.near[NEAR * m + place] = c;
      sync_warp();
      if (LANE == 0) e.num_near[m] += count_bits(mask);
      sync_warp();
    }
  }
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE)
    if (e.num_near[m] > NEAR) e.num_near[m] = NEAR, e.counts[LOST_STATIC] = 1;
  sync_warp();
}

INLINE void on_floor(const Env& e, int m, real floor, Points& points) {
  const Vec down = {0, 0, -1};
  const Vec pos = {e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
  if (m < e.agents) {
    const real bottom = pos.z - e.numbers.length - e.numbers.radius;
    if (bottom < floor) points.add({pos.x, pos.y, (bottom + floor) / 2}, bottom - floor, down);
    return;
  }
  if (pos.z - e.radius[m] > floor) return;
  const Box box = mobile_box(e, m);
  const real r = e.numbers.corner_radius;
  for (int corner = 0; corner < 8; ++corner) {
    Vec at = pos;
    for (int j = 0; j < 3; ++j) at = at + ((corner & (4 >> j) ? 1 : -1) * (box.half[j] - r)) * box.axis[j];
    const real distance = at.z - r - floor;
    if (distance < 0) points.add({at.x, at.y, floor + distance / 2}, distance, down);
  }
}

INLINE void with_box(const Env& e, int m, const Box& box, Points& points) {
  const Box own = mobile_box(e, m);
  if (m >= e.agents) {
    box_box(own, box, points);
  } else if (!apart(own, box, 0)) {
    capsule_box(own.pos, e.numbers.radius, e.numbers.length, box, points);
  }
}

// All contacts of an environment; returns their number.
__device__ int find_contacts(const Env& e, const House& house, real floor) {
  keep_near(e, house);
  int statics = 0;
  for (int m = 0; m < e.mobiles; ++m) statics += e.used[m] ? e.num_near[m] : 0;
  const int mobile_pairs = e.mobiles * (e.mobiles - 1) / 2, total = e.mobiles + statics + mobile_pairs;
  int count = 0;
  for (int base = 0; base < total; base += WARP_SIZE) {
    int pair = base + LANE, first = -1, second = STATIC;
    real friction = 0;
    Points points;
    points.count = 0;
    if (pair < e.mobiles) {
      if (e.used[pair]) first = pair, second = FLOOR, on_floor(e, pair, floor, points);
    } else if ((pair -= e.mobiles) < statics) {
      int m = 0;
      while (!e.used[m] || pair >= e.num_near[m]) pair -= e.used[m] ? e.num_near[m] : 0, ++m;
      first = m;
      with_box(e, m, static_box(house, int(e.near[NEAR * m + pair])), points);
    } else if ((pair -= statics) < mobile_pairs) {
      second = 1;
      while (pair >= second) pair -= second, ++second;
      first = pair;
      const Vec a = {e.pos[3 * first], e.pos[3 * first + 1], e.pos[3 * first + 2]};
      const Vec b = {e.pos[3 * second], e.pos[3 * second + 1], e.pos[3 * second + 2]};
      const real reach = e.radius[first] + e.radius[second];
      if (e.used[first] && e.used[second] && dot(b - a, b - a) <= reach * reach) {
        if (second < e.agents)
          capsule_capsule(a, b, e.numbers.radius, e.numbers.length, points);
        else
          with_box(e, first, mobile_box(e, second), points);
      }
    }
    if (first >= e.agents) friction = e.numbers.friction;
    count = write_contacts(e, count, first, second, friction, points);
  }
  sync_warp();
  return count;
}

// Accelerations without contact: motors and gravity, gravity and gyroscopic torque.
INLINE void smooth(const Env& e, int m, const float* action) {
  const Numbers& n = e.numbers;
  real *out = e.smooth + 6 * m, *vel = e.vel + 6 * m;
  const real* mass = e.mass + 6 * m;
  out[0] = out[1] = out[3] = out[4] = 0, out[2] = -n.gravity;
  if (m < e.agents) {
    const real forward = clamped(action[3 * m], -1, 1) * n.forward_speed;
    const real left = clamped(action[3 * m + 1], -1, 1) * n.strafe_speed;
    const real turn = clamped(action[3 * m + 2], -1, 1) * n.turn_rate;
    const real c = cos(e.quat[4 * m]), s = sin(e.quat[4 * m]), gain = n.agent_mass / n.response_time;
    const real x = (c * forward - s * left - vel[0]) * gain, y = (s * forward + c * left - vel[1]) * gain;
    const real cut = fmin(real(1), n.push_force / sqrt(x * x + y * y + real(1e-12)));
    out[0] = x * cut / n.agent_mass, out[1] = y * cut / n.agent_mass;
    out[5] = (turn - vel[5]) / n.response_time;
    for (int k = 3; k < 6; ++k) e.acc[6 * m + k] = out[k];  // contacts do not turn agents
  } else {
    for (int k = 0; k < 3; ++k) {
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      out[3 + k] = (mass[3 + p] - mass[3 + q]) * vel[3 + p] * vel[3 + q] / mass[3 + k];
    }
  }
}

INLINE void limit(real* v, real most) {
  const real square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  if (square > most * most)
    for (int k = 0; k < 3; ++k) v[k] *= most / sqrt(square);
}

// Semi-implicit Euler; the pose follows the speed before it is limited.
INLINE void move(const Env& e, int m) {
  const real dt = e.numbers.sim_dt;
  real *pos = e.pos + 3 * m, *q = e.quat + 4 * m, *vel = e.vel + 6 * m, *acc = e.acc + 6 * m;
  for (int k = 0; k < 6; ++k) vel[k] += dt * acc[k];
  for (int k = 0; k < 3; ++k) pos[k] += dt * vel[k];
  if (m < e.agents) {
    q[0] += dt * vel[5];
    return;
  }
  const real rate = sqrt(vel[3] * vel[3] + vel[4] * vel[4] + vel[5] * vel[5]);
  if (rate >= TINY) {
    const real c = cos(rate * dt / 2), s = sin(rate * dt / 2) / rate;
    const real x = vel[3] * s, y = vel[4] * s, z = vel[5] * s, w0 = q[0], x0 = q[1], y0 = q[2], z0 = q[3];
    q[0] = w0 * c - x0 * x - y0 * y - z0 * z, q[1] = w0 * x + x0 * c + y0 * z - z0 * y;
    q[2] = w0 * y - x0 * z + y0 * c + z0 * x, q[3] = w0 * z + x0 * y - y0 * x + z0 * c;
    const real scale = 1 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; ++k) q[k] *= scale;
  }
  limit(vel, e.numbers.max_body_speed);
  limit(vel + 3, e.numbers.max_body_spin);
}

// Sizes: environments, houses, static boxes, bodies, agents, bytes of scratch per environment.
extern "C" __global__ void __launch_bounds__(WARP_SIZE, BLOCKS) step_physics(
    const float* collider_pos, const float* collider_quat, const float* collider_half, const int* body_valid,
    const float* body_size, const float* body_mass, const float* body_inertia, const float* floors, const float* numbers,
    const int* houses, const float* qpos, const float* qvel, const float* qacc, const float* action, const int* sizes,
    float* new_qpos, float* new_qvel, float* new_qacc, int* touched, int* lost, char* scratch) {
  const int env = blockIdx.x, num_houses = sizes[1], bodies = sizes[3];
  Env e;
  e.statics = sizes[2], e.agents = sizes[4], e.mobiles = e.agents + bodies, e.room = POINTS_PER_MOBILE * e.mobiles;
  const int M = e.mobiles, D = 6 * M, S = 6 * SMALL_ISLAND;
  real* at = shared_memory();
  e.pos = at, at += 3 * M, e.quat = at, at += 4 * M, e.rot = at, at += 9 * M, e.vel = at, at += 6 * M;
  e.acc = at, at += 6 * M, e.smooth = at, at += 6 * M, e.half = at, at += 3 * M, e.mass = at, at += 6 * M;
  e.radius = at, at += M, e.small = at, at += newton_words(S);
  int* whole = reinterpret_cast<int*>(at);
  e.used = whole, e.num_near = whole + M, e.island = whole + 2 * M, e.members = whole + 3 * M;
  e.rows = whole + 4 * M, e.end = whole + 5 * M, e.offset = whole + 6 * M, e.counts = whole + 7 * M;
  e.order = e.counts + 2;
  real* own = reinterpret_cast<real*>(scratch + size_t(env) * sizes[5]);
  e.near = own, own += NEAR * M, e.near_from = own, own += 12 * M, e.large = own, own += newton_words(D);
  e.contacts = reinterpret_cast<Contact*>(own);
  for (int i = 0; i < NUM_NUMBERS; ++i) reinterpret_cast<real*>(&e.numbers)[i] = numbers[i];
  const int house = houses[env] < 0 ? 0 : houses[env] < num_houses ? houses[env] : num_houses - 1;
  const House boxes = {collider_pos + size_t(house) * e.statics * 3, collider_quat + size_t(house) * e.statics * 4,
                       collider_half + size_t(house) * e.statics * 3};
  const int nq = 4 * e.agents + 7 * bodies, nv = 4 * e.agents + 6 * bodies;
  qpos += size_t(env) * nq, qvel += size_t(env) * nv, qacc += size_t(env) * nv, action += size_t(env) * 3 * e.agents;
  new_qpos += size_t(env) * nq, new_qvel += size_t(env) * nv, new_qacc += size_t(env) * nv;
  if (LANE == 0) e.counts[LOST_STATIC] = e.counts[LOST_POINTS] = 0;
  for (int m = LANE; m < M; m += WARP_SIZE) {
    e.num_near[m] = -1;
    for (int k = 0; k < 9; ++k) e.rot[9 * m + k] = k % 4 == 0;
    if (m < e.agents) {
      e.used[m] = 1, e.radius[m] = e.numbers.radius + e.numbers.length;
      for (int k = 0; k < 3; ++k) {
        e.pos[3 * m + k] = qpos[4 * m + k], e.vel[6 * m + k] = qvel[4 * m + k], e.acc[6 * m + k] = qacc[4 * m + k];
        e.vel[6 * m + 3 + k] = k == 2 ? qvel[4 * m + 3] : 0, e.acc[6 * m + 3 + k] = 0;
        e.half[3 * m + k] = e.numbers.radius + (k == 2 ? e.numbers.length : 0);
        e.mass[6 * m + k] = e.numbers.agent_mass, e.mass[6 * m + 3 + k] = e.numbers.yaw_inertia;
      }
      e.quat[4 * m] = qpos[4 * m + 3];
    } else {
      const int b = m - e.agents, row = house * bodies + b, q = 4 * e.agents + 7 * b, v = 4 * e.agents + 6 * b;
      e.used[m] = body_valid[row] != 0;
      real square = 0, length = 0;
      for (int k = 0; k < 4; ++k) length += real(qpos[q + 3 + k]) * qpos[q + 3 + k];
      for (int k = 0; k < 4; ++k) e.quat[4 * m + k] = qpos[q + 3 + k] / sqrt(length);
      for (int k = 0; k < 6; ++k) e.vel[6 * m + k] = qvel[v + k], e.acc[6 * m + k] = qacc[v + k];
      for (int k = 0; k < 3; ++k) {
        e.pos[3 * m + k] = qpos[q + k], e.half[3 * m + k] = body_size[3 * row + k];
        e.mass[6 * m + k] = body_mass[row], e.mass[6 * m + 3 + k] = body_inertia[3 * row + k];
        square += e.half[3 * m + k] * e.half[3 * m + k];
      }
      e.radius[m] = sqrt(square);
    }
  }
  sync_warp();
  for (int substep = 0; substep < int(e.numbers.substeps); ++substep) {
    for (int m = LANE; m < M; m += WARP_SIZE)
      if (e.used[m]) {
        if (m >= e.agents) rotation(e.quat + 4 * m, e.rot + 9 * m);
        smooth(e, m, action);
      }
    sync_warp();
    const int count = find_contacts(e, boxes, floors[house]);
    solve(e, count);
    for (int m = LANE; m < M; m += WARP_SIZE)
      if (e.used[m]) move(e, m);
    for (int a = 0; a < e.agents; ++a) {
      real here = 0;
      for (int n = LANE; n < count; n += WARP_SIZE) {
        const Contact& c = e.contacts[n];
        if (c.second != FLOOR && (c.first == a || c.second == a)) here += 1;
      }
      const int sum = int(warp_sum(here));
      if (substep == 0 && LANE == 0) touched[env * e.agents + a] = 0;
      if (LANE == 0 && sum > touched[env * e.agents + a]) touched[env * e.agents + a] = sum;
    }
    sync_warp();
  }
  for (int m = LANE; m < M; m += WARP_SIZE) {
    if (m < e.agents) {
      for (int k = 0; k < 3; ++k) {
        new_qpos[4 * m + k] = e.pos[3 * m + k], new_qvel[4 * m + k] = e.vel[6 * m + k];
        new_qacc[4 * m + k] = e.acc[6 * m + k];
      }
      new_qpos[4 * m + 3] = e.quat[4 * m], new_qvel[4 * m + 3] = e.vel[6 * m + 5], new_qacc[4 * m + 3] = e.acc[6 * m + 5];
    } else {
      const int b = m - e.agents, q = 4 * e.agents + 7 * b, v = 4 * e.agents + 6 * b;
      for (int k = 0; k < 7; ++k) new_qpos[q + k] = !e.used[m] ? qpos[q + k] : k < 3 ? e.pos[3 * m + k] : e.quat[4 * m + k - 3];
      for (int k = 0; k < 6; ++k) {
        new_qvel[v + k] = e.used[m] ? e.vel[6 * m + k] : 0;
        new_qacc[v + k] = e.used[m] ? e.acc[6 * m + k] : 0;
      }
    }
  }
  if (LANE == 0) lost[2 * env] = e.counts[LOST_STATIC], lost[2 * env + 1] = e.counts[LOST_POINTS];
}
