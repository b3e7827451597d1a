// Body sleeping; counterpart of numba/sleep.py.

INLINE real length_of(const real* v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

INLINE void find_sleepers(const Env& e, const Control& control) {
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) {
    bool calm = m >= e.agents && e.numbers.sleep > 0, still = true;
    for (int a = 0; a < e.agents; ++a) calm = calm && control.held[a] != m - e.agents;
    if (m >= e.free) calm = calm && absolute(control.goal[m - e.free]) >= NOT_DRIVEN;
    for (int k = 0; k < 6; ++k) still = still && e.vel[6 * m + k] == 0 && e.acc[6 * m + k] == 0;
    e.wakes[m] = 0, e.calm[m] = calm, e.awake[m] = e.exists[m] && !(calm && still);
  }
  sync_warp();
}

INLINE void wake(const Env& e, int m) {
  e.awake[m] = 1, e.calm[m] = 0, e.wakes[m] = 0, e.acc[6 * m + (m < e.free ? 2 : 5)] = -MIN_AWAKE_ACCELERATION;
}

// Wakes dynamic bodies that agents or fast bodies may touch in the next physics step.
__device__ void wake_near(const Env& e) {
  bool any = false;
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE) any |= e.exists[m] && !e.awake[m];
  if (!warp_ballot(any)) return;
  const int awake = list_awake(e);
  for (int base = 0; base < awake * e.mobiles; base += WARP_SIZE) {
    const int pair = base + LANE, m = e.list[pair < awake * e.mobiles ? pair / e.mobiles : 0], other = pair % e.mobiles;
    if (pair >= awake * e.mobiles || (m >= e.agents && e.calm[m]) || !e.exists[other] || e.awake[other]) continue;
    if (m >= e.free && other >= e.free) continue;
    const real *vel = e.vel + 6 * m, fast = m < e.free ? length_of(vel) + length_of(vel + 3) * e.radius[m]
                                                       : 2 * absolute(vel[5]) * e.radius[m];
    const real near = WAKE_DISTANCE + 2 * e.numbers.sim_dt * fast;
    if (!spheres_meet(e, m, other, near)) continue;
    for (int part = num_parts(e, m > other ? m : other) - 1; part >= 0; --part) {
      const Box one = mobile_box(e, m, m >= e.free ? part : 0), two = mobile_box(e, other, other >= e.free ? part : 0);
      if (!apart(one, two, near)) e.wakes[other] = 1;
    }
  }
  sync_warp();
  for (int m = e.agents + LANE; m < e.mobiles; m += WARP_SIZE)
    if (e.wakes[m]) wake(e, m);
  sync_warp();
}

// Wakes touched bodies and marks moving ones as not calm, after a physics step.
INLINE void wake_touched(const Env& e) {
  for (int m = e.agents + LANE; m < e.mobiles; m += WARP_SIZE) {
    const real *vel = e.vel + 6 * m, *acc = e.acc + 6 * m;
    const bool fast = (m < e.free && length_of(vel) > e.numbers.rest_speed) || length_of(vel + 3) > e.numbers.rest_spin;
    if (fast || (m < e.free && length_of(acc) > e.numbers.rest_pull)) e.calm[m] = 0;
    if (e.wakes[m]) wake(e, m);
  }
  sync_warp();
}

// Sets islands whose bodies are all calm to sleep, after a control step.
INLINE void fall_asleep(const Env& e) {
  for (int m = LANE; m < e.mobiles; m += WARP_SIZE)
    if (e.awake[m] && !e.calm[m]) e.wakes[e.island[m]] = 1;
  sync_warp();
  for (int m = e.agents + LANE; m < e.mobiles; m += WARP_SIZE)
    if (e.awake[m] && !e.wakes[e.island[m]])
      for (int k = 0; k < 6; ++k) e.vel[6 * m + k] = e.acc[6 * m + k] = 0;
  sync_warp();
}
