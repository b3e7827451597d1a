// Accelerations without contact, and integration; counterpart of numba/smooth_acceleration.py and numba/integration.py.

// Control inputs of an environment's agents and doors.
struct Control {
  const float *action, *grip, *goal;
  const int* held;
};

INLINE void drive_agent(const Env& e, int a, const float* action) {
  const Numbers& n = e.numbers;
  const float* agent = e.agent + AGENT_COLUMNS * a;
  const real mass = agent[2], push = agent[7], c = cos(e.quat[4 * a]), s = sin(e.quat[4 * a]);
  real *out = e.smooth + 6 * a, *vel = e.vel + 6 * a;
  real forward = clamped(action[0], -1, 1) * agent[4] - (c * vel[0] + s * vel[1]);
  real left = clamped(action[1], -1, 1) * agent[5] - (c * vel[1] - s * vel[0]);
  if (n.control == 1) {
    forward *= push / (agent[4] * mass), left *= push / (agent[5] * mass);
  } else {
    const real length = sqrt(forward * forward + left * left);
    const real gain = fmin(real(1), push * n.response_time / (mass * length + real(1e-12))) / n.response_time;
    forward *= gain, left *= gain;
  }
  out[0] = c * forward - s * left, out[1] = s * forward + c * left, out[2] = -n.gravity, out[3] = out[4] = 0;
  out[5] = (clamped(action[2], -1, 1) * agent[6] - vel[5]) / n.response_time;
}

INLINE void climb(const Env& e, int a, const float* ramps, int count) {
  const real radius = e.agent[AGENT_COLUMNS * a], bottom = e.pos[3 * a + 2] - e.radius[a];
  real highest = -INF, pull_x = 0, pull_y = 0;
  for (int r = 0; r < count; ++r) {
    const float* ramp = ramps + RAMP_COLUMNS * r;
    const real x = e.pos[3 * a] - ramp[0], y = e.pos[3 * a + 1] - ramp[1], slope = ramp[7];
    const real along = x * ramp[2] + y * ramp[3], across = y * ramp[2] - x * ramp[3];
    const real sine = slope / sqrt(1 + slope * slope), surface = ramp[6] + along * slope;
    if (slope <= 0 || along < -ramp[4] - real(0.3) * radius || along > ramp[4] - radius * sine) continue;
    if (absolute(across) > ramp[5] || absolute(bottom - surface) >= e.numbers.on_ramp || surface <= highest) continue;
    highest = surface, pull_x = e.numbers.gravity * slope * ramp[2], pull_y = e.numbers.gravity * slope * ramp[3];
  }
  e.smooth[6 * a] += pull_x, e.smooth[6 * a + 1] += pull_y;
}

INLINE void fall(const Env& e, int m) {
  real* out = e.smooth + 6 * m;
  const real *mass = e.mass + 6 * m, *vel = e.vel + 6 * m;
  out[0] = out[1] = 0, out[2] = -e.numbers.gravity;
  for (int k = 0; k < 3; ++k) {
    const int p = (k + 1) % 3, q = (k + 2) % 3;
    out[3 + k] = (mass[3 + p] - mass[3 + q]) * vel[3 + p] * vel[3 + q] / mass[3 + k];
  }
}

INLINE real length_of(Vec v) { return sqrt(dot(v, v)) + real(1e-12); }

// Returns the velocity per distance, or per angle, towards a grip [1/s].
INLINE real reach(const Numbers& n, real far, real fastest) {
  return fmin(real(1), fastest * 2 * n.hand_time / far) / (2 * n.hand_time);
}

// Computes the acceleration of a held body towards its grip and the reaction on its holder.
INLINE void carry(const Env& e, int a, int m, const float* grip) {
  const Numbers& n = e.numbers;
  const real c = cos(e.quat[4 * a]), s = sin(e.quat[4 * a]), spin = e.vel[6 * a + 5];
  const real *va = e.vel + 6 * a, *vm = e.vel + 6 * m;
  const Vec arm = {c * grip[0] - s * grip[1], s * grip[0] + c * grip[1], grip[2]};
  const Vec agent = {e.pos[3 * a], e.pos[3 * a + 1], e.pos[3 * a + 2]};
  const Vec thing = {e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
  const Vec gap = agent + arm - thing;
  const Vec carried = {va[0] - spin * arm.y - vm[0], va[1] + spin * arm.x - vm[1], va[2] - vm[2]};
  const Vec wanted = carried + reach(n, length_of(gap), n.hand_speed) * gap;
  const real most = fmin(n.hand_acceleration, n.hand_force / e.mass[6 * m]);
  const real cut = fmin(real(1), most * n.hand_time / length_of(wanted)) / n.hand_time;
  real* out = e.smooth + 6 * m;
  for (int k = 0; k < 3; ++k) out[k] = cut * wanted[k];
  const real far = sqrt(gap.x * gap.x + gap.y * gap.y);
  const real lag = far < n.hand_leash ? fmax(real(0), far - n.hand_slack) : 0;
  const real back = n.hand_stiffness * lag / ((far + real(1e-12)) * e.mass[6 * a]);
  e.smooth[6 * a] -= back * gap.x, e.smooth[6 * a + 1] -= back * gap.y;
  const real hc = cos(e.quat[4 * a] / 2), hs = sin(e.quat[4 * a] / 2);
  const real w = hc * grip[3] - hs * grip[6], x = hc * grip[4] - hs * grip[5];
  const real y = hc * grip[5] + hs * grip[4], z = hc * grip[6] + hs * grip[3];
  const real *q = e.quat + 4 * m, *rot = e.rot + 9 * m, sign = q[0] * w + q[1] * x + q[2] * y + q[3] * z >= 0 ? 2 : -2;
  const Vec miss = sign * Vec{q[0] * x - q[1] * w - q[2] * z + q[3] * y, q[0] * y + q[1] * z - q[2] * w - q[3] * x,
                              q[0] * z - q[1] * y + q[2] * x - q[3] * w};
  const Vec rate = spin * Vec{rot[6], rot[7], rot[8]} + reach(n, length_of(miss), n.hand_spin) * miss;
  const Vec twist = (1 / n.hand_time) * (rate - Vec{vm[3], vm[4], vm[5]});
  const real soft = fmin(real(1), n.hand_twist / length_of(twist));
  for (int k = 0; k < 3; ++k) out[3 + k] = soft * twist[k];
}

INLINE void drive_door(const Env& e, int m, real goal) {
  const Numbers& n = e.numbers;
  const real rate = e.vel[6 * m + 5], most = n.door_torque / e.mass[6 * m + 5];
  real* out = e.smooth + 6 * m;
  for (int k = 0; k < 5; ++k) out[k] = 0;
  out[5] = -n.door_drag * rate;
  if (absolute(goal) >= NOT_DRIVEN) return;
  const real wanted = clamped((goal - e.quat[4 * m]) / n.door_time, -n.door_speed, n.door_speed);
  out[5] += clamped((wanted - rate) / n.hand_time, -most, most);
}

INLINE void smooth(const Env& e, int m, const Control& control, const float* ramps, int num_ramps) {
  if (m >= e.free) return drive_door(e, m, control.goal[m - e.free]);
  if (m >= e.agents) return fall(e, m);
  drive_agent(e, m, control.action + 3 * m);
  climb(e, m, ramps, num_ramps);
}

// Applies hands, after `smooth` of all dynamic bodies. Two agents never hold the same body.
INLINE void hold(const Env& e, int a, const Control& control) {
  if (control.held[a] >= 0) carry(e, a, e.agents + control.held[a], control.grip + 7 * a);
  for (int k = 3; k < 6; ++k) e.acc[6 * a + k] = e.smooth[6 * a + k];  // contacts do not turn agents
}

// Computes the pose of a door leaf from its coordinate.
INLINE void place_leaf(const Env& e, int m) {
  const float* door = e.door + DOOR_COLUMNS * (m - e.free);
  real *pos = e.pos + 3 * m, *rot = e.rot + 9 * m;
  const real way = e.quat[4 * m], angle = door[15] * way, c = cos(angle), s = sin(angle);
  pos[0] = door[0] + c * door[2] - s * door[3] + door[13] * way;
  pos[1] = door[1] + s * door[2] + c * door[3] + door[14] * way, pos[2] = door[4];
  const real u = cos(angle + door[5]), v = sin(angle + door[5]);
  rot[0] = u, rot[1] = -v, rot[2] = 0, rot[3] = v, rot[4] = u, rot[5] = 0, rot[6] = rot[7] = 0, rot[8] = 1;
}

INLINE void limit(real* v, real most) {
  const real square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  if (square > most * most)
    for (int k = 0; k < 3; ++k) v[k] *= most / sqrt(square);
}

// Integrates by semi-implicit Euler; the pose follows the velocity before the speed limit.
INLINE void move(const Env& e, int m) {
  const real dt = e.numbers.sim_dt;
  real *pos = e.pos + 3 * m, *q = e.quat + 4 * m, *vel = e.vel + 6 * m, *acc = e.acc + 6 * m;
  if (m >= e.free) {
    vel[5] += dt * acc[5], q[0] += dt * vel[5];
    return;
  }
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
