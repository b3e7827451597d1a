// The fused physics step on NVIDIA GPUs: one warp per environment computes all physics steps of a control step.
// launch.py prepends the other files to this one and compiles them at run time.
//
// Counterpart of numba/ on CPUs, which documents the formulas and their sources.

// Loads the pose, velocity and parameters of an agent, body or door.
INLINE void load(const Env& e, int m, const float* qpos, const float* qvel, const float* qacc, const int* body_valid,
                 const float* body_size, const float* body_mass, const float* body_inertia, real heavier) {
  const int b = m - e.agents, h = m - e.free, bodies = e.free - e.agents;
  real *pos = e.pos + 3 * m, *quat = e.quat + 4 * m, *half = e.half + 3 * m, *mass = e.mass + 6 * m;
  real *vel = e.vel + 6 * m, *acc = e.acc + 6 * m;
  e.num_near[m] = -1, e.impulse[2 * m] = e.impulse[2 * m + 1] = 0;
  for (int k = 0; k < 9; ++k) e.rot[9 * m + k] = k % 4 == 0;
  if (m < e.agents) {
    const float* agent = e.agent + AGENT_COLUMNS * m;
    e.exists[m] = 1, e.radius[m] = agent[0] + agent[1], e.inverse[m] = 1 / real(agent[2]);
    for (int k = 0; k < 3; ++k) {
      pos[k] = qpos[4 * m + k], vel[k] = qvel[4 * m + k], acc[k] = qacc[4 * m + k];
      vel[3 + k] = k == 2 ? qvel[4 * m + 3] : 0, acc[3 + k] = 0;
      half[k] = agent[0] + (k == 2 ? agent[1] : 0), mass[k] = agent[2], mass[3 + k] = agent[3];
    }
    quat[0] = qpos[4 * m + 3];
    return;
  }
  real square = 0, length = 0;
  if (m < e.free) {
    const int q = 4 * e.agents + 7 * b, v = 4 * e.agents + 6 * b;
    e.exists[m] = body_valid[b] != 0, e.inverse[m] = 1 / (body_mass[b] * heavier);
    for (int k = 0; k < 4; ++k) length += real(qpos[q + 3 + k]) * qpos[q + 3 + k];
    for (int k = 0; k < 4; ++k) quat[k] = qpos[q + 3 + k] / sqrt(length);
    for (int k = 0; k < 6; ++k) vel[k] = qvel[v + k], acc[k] = qacc[v + k];
    for (int k = 0; k < 3; ++k) {
      pos[k] = qpos[q + k], half[k] = body_size[3 * b + k];
      mass[k] = body_mass[b] * heavier, mass[3 + k] = body_inertia[3 * b + k] * heavier;
    }
  } else {
    const float* door = e.door + DOOR_COLUMNS * h;
    const int q = 4 * e.agents + 7 * bodies + h, v = 4 * e.agents + 6 * bodies + h;
    e.exists[m] = door[6] >= 0, e.inverse[m] = door[10], quat[0] = qpos[q];
    for (int k = 0; k < 3; ++k) half[k] = door[6 + k];
    for (int k = 0; k < 6; ++k) vel[k] = acc[k] = 0, mass[k] = HEAVY;
    vel[5] = qvel[v], acc[5] = qacc[v], mass[5] = door[9];
  }
  for (int k = 0; k < 3; ++k) square += half[k] * half[k];
  for (int part = num_parts(e, m) - 1; part > 0; --part) {
    const float* box = tray_box(e, m, part);
    real far = 0;
    for (int k = 0; k < 3; ++k) far += (absolute(box[k]) + box[3 + k]) * (absolute(box[k]) + box[3 + k]);
    square = fmax(square, far);
  }
  e.radius[m] = sqrt(square);
}

INLINE void store(const Env& e, int m, const float* qpos, float* new_qpos, float* new_qvel, float* new_qacc) {
  const int b = m - e.agents, h = m - e.free, bodies = e.free - e.agents, awake = e.awake[m];
  const real *pos = e.pos + 3 * m, *quat = e.quat + 4 * m, *vel = e.vel + 6 * m, *acc = e.acc + 6 * m;
  if (m < e.agents) {
    for (int k = 0; k < 4; ++k) {
      new_qpos[4 * m + k] = k < 3 ? pos[k] : quat[0];
      new_qvel[4 * m + k] = vel[k < 3 ? k : 5], new_qacc[4 * m + k] = acc[k < 3 ? k : 5];
    }
  } else if (m < e.free) {
    const int q = 4 * e.agents + 7 * b, v = 4 * e.agents + 6 * b;
    for (int k = 0; k < 7; ++k) new_qpos[q + k] = !awake ? qpos[q + k] : k < 3 ? pos[k] : quat[k - 3];
    for (int k = 0; k < 6; ++k) new_qvel[v + k] = awake ? vel[k] : 0, new_qacc[v + k] = awake ? acc[k] : 0;
  } else {
    const int q = 4 * e.agents + 7 * bodies + h, v = 4 * e.agents + 6 * bodies + h;
    new_qpos[q] = awake ? quat[0] : qpos[q], new_qvel[v] = awake ? vel[5] : 0, new_qacc[v] = awake ? acc[5] : 0;
  }
}

// Counts contacts of each agent, except with what carries it; keeps the maximum over physics steps.
INLINE void count_touched(const Env& e, int count, int* touched) {
  for (int a = 0; a < e.agents; ++a) {
    int here = 0;
    for (int base = 0; base < count; base += WARP_SIZE) {
      const int n = base + LANE;
      bool touches = false;
      if (n < count) {
        const Contact& c = contact(e, n);
        const bool carries = c.second == FLOOR ||
            (c.second <= STATIC && c.second > SLEEPING_BODY && c.frame[0][2] <= -MIN_SUPPORT_NORMAL);
        touches = !carries && (c.first == a || c.second == a);
      }
      here += count_bits(warp_ballot(touches));
    }
    if (LANE == 0 && here > touched[a]) touched[a] = here;
  }
}

// Adds the impulse of contact `n` to dynamic body `m`, and keeps its position and partner if it is the body's strongest.
INLINE void note_push(const Env& e, int m, int partner, int n, real impulse, float* push, int* other) {
  e.impulse[2 * m] += impulse;
  if (impulse <= e.impulse[2 * m + 1]) return;
  e.impulse[2 * m + 1] = impulse, other[m] = partner <= SLEEPING_BODY ? SLEEPING_BODY - partner : partner;
  for (int k = 0; k < 3; ++k) push[4 * m + 1 + k] = contact(e, n).pos[k];
}

// Adds the impulses of a physics step and keeps the strongest contact of each dynamic body. Lanes compute the impulses
// of a group of contacts; these are then added in order, each by the lanes that own its bodies.
INLINE void note_pushes(const Env& e, int count, float* push, int* other) {
  for (int base = 0; base < count; base += WARP_SIZE) {
    const int n = base + LANE;
    int first = 0, second = JOINT_LIMIT;
    real impulse = 0;
    if (n < count) {
      const Contact& c = contact(e, n);
      real value[3], force = 0;
      first = c.first, second = c.second;
      relative(c, e.acc, six, value);
      for (int k = 0; k < 3; ++k) value[k] -= c.target[k];
      for (int row = 0; row < num_rows(c); ++row) force -= c.weight * fmin(edge_value(row, c.friction, value), real(0));
      impulse = second == JOINT_LIMIT ? 0 : force * e.numbers.sim_dt;
    }
    for (unsigned left = warp_ballot(impulse != 0); left; left &= left - 1) {
      const int lane = count_bits((left & -left) - 1), a = from_lane(first, lane), b = from_lane(second, lane);
      const real here = from_lane(impulse, lane);
      if (a % WARP_SIZE == LANE) note_push(e, a, b, base + lane, here, push, other);
      if (b >= 0 && b % WARP_SIZE == LANE) note_push(e, b, a, base + lane, here, push, other);
    }
  }
}

// `order`: environments in the order of their start. `sizes`: environments, houses, static boxes, bodies, agents, doors,
// ramps, bytes of scratch per environment, leaves that may have a tray. Rows of trays follow those of a house's doors.
extern "C" __global__ void __launch_bounds__(WARP_SIZE, BLOCKS) step_physics(
    const float* collider_pos, const float* collider_quat, const float* collider_half, const int* body_valid,
    const float* body_size, const float* body_mass, const float* body_inertia, const float* body_surface,
    const float* doors, const float* ramps, const float* floors, const float* agents, const float* numbers,
    const int* houses, const float* qpos, const float* qvel, const float* qacc, const float* action, const int* held,
    const float* grip, const float* goal, const float* scale, const int* order, const int* sizes, float* new_qpos,
    float* new_qvel, float* new_qacc, int* touched, int* lost, float* push, int* other, char* scratch) {
  const int env = order[blockIdx.x], num_houses = sizes[1];
  const int bodies = sizes[3], num_doors = sizes[5], num_ramps = sizes[6], num_trays = sizes[8];
  Env e;
  e.statics = sizes[2], e.agents = sizes[4], e.free = e.agents + bodies, e.mobiles = e.free + num_doors;
  e.room = POINTS_PER_BODY * e.mobiles, e.pair_room = PAIRS_PER_BODY * e.mobiles;
  const int M = e.mobiles, D = 6 * M, S = 6 * SMALL_ISLAND;
  real* at = shared_memory();
  e.pos = at, at += 3 * M, e.quat = at, at += 4 * M, e.rot = at, at += 9 * M, e.vel = at, at += 6 * M;
  e.acc = at, at += 6 * M, e.smooth = at, at += 6 * M, e.radius = at, at += M, e.small = at, at += newton_words(S);
  e.first_contacts = reinterpret_cast<Contact*>(at), at += CONTACT_WORDS * SHARED_CONTACTS;
  e.counts = reinterpret_cast<int*>(at), e.num_near = reinterpret_cast<short*>(e.counts + NUM_COUNTS);
  e.island = reinterpret_cast<Index*>(e.num_near + M), e.members = e.island + M, e.rows = e.members + M;
  e.end = e.rows + M, e.offset = e.end + M, e.list = e.offset + M;
  e.awake = reinterpret_cast<Flag*>(e.list + M), e.exists = e.awake + M, e.calm = e.exists + M, e.wakes = e.calm + M;
  // Shared memory limits how many environments a multiprocessor steps at once: what is read less often is in scratch.
  real* own = reinterpret_cast<real*>(scratch + size_t(env) * sizes[7]);
  e.near = own, own += MAX_NEAR_BOXES * M, e.near_from = own, own += 12 * M, e.large = own, own += newton_words(D);
  e.half = own, own += 3 * M, e.mass = own, own += 6 * M, e.inverse = own, own += M, e.impulse = own, own += 2 * M;
  e.pairs = reinterpret_cast<int*>(own), own += PAIRS_PER_BODY * M;
  e.order = reinterpret_cast<Index*>(own), own += POINTS_PER_BODY / 2 * M;
  e.contacts = reinterpret_cast<Contact*>(own);
  for (int i = 0; i < NUM_NUMBERS; ++i) reinterpret_cast<real*>(&e.numbers)[i] = numbers[i];
  const int house = houses[env] < 0 ? 0 : houses[env] < num_houses ? houses[env] : num_houses - 1;
  const House boxes = {collider_pos + size_t(house) * e.statics * 3, collider_quat + size_t(house) * e.statics * 4,
                       collider_half + size_t(house) * e.statics * 3};
  e.rougher = scale[2 * env];
  e.agent = agents, e.surface = body_surface + size_t(house) * bodies * SURFACE_COLUMNS;
  e.door = doors + size_t(house) * (num_doors + TRAY_ROWS * num_trays) * DOOR_COLUMNS;
  e.tray = e.door + num_doors * DOOR_COLUMNS, e.first_tray = e.mobiles - num_trays;
  ramps += size_t(house) * num_ramps * RAMP_COLUMNS;
  const int nq = 4 * e.agents + 7 * bodies + num_doors, nv = 4 * e.agents + 6 * bodies + num_doors;
  qpos += size_t(env) * nq, qvel += size_t(env) * nv, qacc += size_t(env) * nv;
  new_qpos += size_t(env) * nq, new_qvel += size_t(env) * nv, new_qacc += size_t(env) * nv;
  const Control control = {action + size_t(env) * 3 * e.agents, grip + size_t(env) * 7 * e.agents,
                           goal + size_t(env) * num_doors, held + size_t(env) * e.agents};
  touched += size_t(env) * e.agents, push += size_t(env) * 4 * M, other += size_t(env) * M;
  if (LANE == 0) e.counts[STATIC_OVERFLOW] = e.counts[POINT_OVERFLOW] = 0;
  for (int m = LANE; m < M; m += WARP_SIZE) {
    const int row = house * bodies;
    load(e, m, qpos, qvel, qacc, body_valid + row, body_size + 3 * row, body_mass + row, body_inertia + 3 * row,
         scale[2 * env + 1]);
    if (m < e.agents) touched[m] = 0;
    other[m] = JOINT_LIMIT;
    for (int k = 0; k < 4; ++k) push[4 * m + k] = 0;
  }
  sync_warp();
  find_sleepers(e, control);  // of all slots
  while (e.mobiles > e.free && !e.exists[e.mobiles - 1]) --e.mobiles;  // most houses have fewer doors than slots
  for (int substep = 0; substep < int(e.numbers.substeps); ++substep) {
    for (int m = LANE; m < e.mobiles; m += WARP_SIZE)
      if (e.awake[m] || (substep == 0 && e.exists[m])) {
        if (m >= e.free) place_leaf(e, m);
        else if (m >= e.agents) rotation(e.quat + 4 * m, e.rot + 9 * m);
      }
    sync_warp();
    wake_near(e);
    for (int m = LANE; m < e.mobiles; m += WARP_SIZE)
      if (e.awake[m]) smooth(e, m, control, ramps, num_ramps);
    sync_warp();
    for (int a = LANE; a < e.agents; a += WARP_SIZE) hold(e, a, control);
    sync_warp();
    const int count = find_contacts(e, boxes, floors[house]);
    solve(e, count);
    note_pushes(e, count, push, other);
    count_touched(e, count, touched);
    for (int m = LANE; m < e.mobiles; m += WARP_SIZE)
      if (e.awake[m]) move(e, m);
    sync_warp();
    wake_touched(e);
  }
  fall_asleep(e);
  for (int m = LANE; m < M; m += WARP_SIZE) {
    store(e, m, qpos, new_qpos, new_qvel, new_qacc);
    push[4 * m] = e.impulse[2 * m];
  }
  if (LANE == 0) lost[2 * env] = e.counts[STATIC_OVERFLOW], lost[2 * env + 1] = e.counts[POINT_OVERFLOW];
}
