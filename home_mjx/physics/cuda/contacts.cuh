// Contact detection; counterpart of numba/contact_detection.py.

// Returns the sum of the numbers of the lanes before this one.
INLINE int sum_before(int own) {
  int sum = own;
  for (int step = 1; step < WARP_SIZE; step *= 2) {
    const int other = from_lane(sum, LANE - step);
    if (LANE >= step) sum += other;
  }
  return sum - own;
}

// Writes the contacts of the lanes' pairs in lane order; returns the new number of contacts.
__device__ int write_contacts(const Env& e, int count, int first, int second, const Points& points) {
  const int before = sum_before(points.count), start = count + before;
  const int total = from_lane(before + points.count, WARP_SIZE - 1);
  for (int i = 0; i < points.count; ++i)
    if (start + i < e.room) make_contact(e, contact(e, start + i), first, second, points.at[i]);
  if (count + total > e.room) {
    if (LANE == 0) e.counts[POINT_OVERFLOW] = 1;
    return e.room;
  }
  return count + total;
}

// Returns centre and half extents of box `part`, from 1 on, of a drawer, in the frame of its front.
INLINE const float* tray_box(const Env& e, int m, int part) {
  return e.tray + DOOR_COLUMNS * TRAY_ROWS * (m - e.first_tray) + 6 * (part - 1);
}

// Returns the number of boxes of a dynamic body: 1, and more for a drawer, whose first one is its front.
INLINE int num_parts(const Env& e, int m) {
  return m >= e.first_tray && tray_box(e, m, 1)[3] >= 0 ? 1 + TRAY_BOXES : 1;
}

INLINE Box mobile_box(const Env& e, int m, int part = 0) {
  Box box;
  const real* rot = e.rot + 9 * m;
  box.pos = {e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
  for (int k = 0; k < 3; ++k) {
    box.axis[k] = {rot[k], rot[3 + k], rot[6 + k]};
    box.half[k] = e.half[3 * m + k];
  }
  if (part > 0) {
    const float* own = tray_box(e, m, part);
    for (int k = 0; k < 3; ++k) box.pos = box.pos + real(own[k]) * box.axis[k], box.half[k] = own[3 + k];
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

// Returns whether one of the six face axes separates two boxes by more than `reach`.
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

// Returns an upper bound of the displacement of a body's points since its nearby boxes were listed [m].
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

// Appends the lanes' static boxes `c`, if they are valid, to the lists of the dynamic bodies `looks` that they are near.
INLINE void list_near(const Env& e, const House& house, int c, bool valid, const Index* looks) {
  const Box box = static_box(house, valid ? c : 0);
  for (int m = 0; m < e.free; ++m) {
    if (!looks[m]) continue;
    const Box own = mobile_box(e, m);
    const real reach = e.radius[m] + NEAR_DISTANCE;
    const Vec at = box.local(own.pos - box.pos);
    real square = 0;
#pragma unroll
    for (int k = 0; k < 3; ++k) {
      const real beyond = fmax(absolute(at[k]) - box.half[k], real(0));
      square += beyond * beyond;
    }
    const bool close = valid && square < reach * reach && !apart(own, box, NEAR_DISTANCE);
    const unsigned mask = warp_ballot(close);
    const int place = e.num_near[m] + count_bits(mask & ((1u << LANE) - 1));
    if (close && place < MAX_NEAR_BOXES) e.near[MAX_NEAR_BOXES * m + place] = c;
    sync_warp();
    if (LANE == 0) e.num_near[m] += count_bits(mask);
    sync_warp();
  }
}

// Updates the lists of static boxes near bodies that have moved; the static boxes are distributed over the lanes.
__device__ void keep_near(const Env& e, const House& house) {
  bool any = false;
  Index* looks = e.members;  // flags of dynamic bodies whose list is updated
  for (int m = LANE; m < e.free; m += WARP_SIZE) {
    looks[m] = e.awake[m] && (e.num_near[m] < 0 || moved(e, m) >= NEAR_DISTANCE);
    if (!looks[m]) continue;
    any = true, e.num_near[m] = 0;
    for (int k = 0; k < 12; ++k) e.near_from[12 * m + k] = k < 3 ? e.pos[3 * m + k] : e.rot[9 * m + k - 3];
  }
  if (!warp_ballot(any)) return;
  sync_warp();
  // Most slots of a typical house are empty: these are skipped, SKIP groups of them with one wait for memory.
  constexpr int SKIP = 4;
  for (int start = 0; start < e.statics; start += SKIP * WARP_SIZE) {
    int valid = 0, any = 0;  // a bit per group: of this lane, of any lane
#pragma unroll
    for (int k = 0; k < SKIP; ++k) {
      const int c = start + k * WARP_SIZE + LANE;
      valid |= (c < e.statics && house.half[3 * c] >= 0) << k;
    }
#pragma unroll
    for (int k = 0; k < SKIP; ++k) any |= (warp_ballot(valid >> k & 1) != 0) << k;
#pragma unroll 1
    for (int k = 0; k < SKIP; ++k)
      if (any >> k & 1) list_near(e, house, start + k * WARP_SIZE + LANE, valid >> k & 1, looks);
  }
  for (int m = LANE; m < e.free; m += WARP_SIZE)
    if (e.num_near[m] > MAX_NEAR_BOXES) e.num_near[m] = MAX_NEAR_BOXES, e.counts[STATIC_OVERFLOW] = 1;
  sync_warp();
}

INLINE void on_floor(const Env& e, int m, real floor, Points& points) {
  const Vec down = {0, 0, -1};
  const Vec pos = {e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]};
  if (m < e.agents) {
    const real bottom = pos.z - e.agent[AGENT_COLUMNS * m + 1] - e.agent[AGENT_COLUMNS * m];
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

INLINE void with_box(const Env& e, int m, int part, const Box& box, Points& points) {
  const Box own = mobile_box(e, m, part);
  if (m >= e.agents) {
    box_box(own, box, points);
  } else if (!apart(own, box, 0)) {
    capsule_box(own.pos, e.agent[AGENT_COLUMNS * m], e.agent[AGENT_COLUMNS * m + 1], box, points);
  }
}

// Adds contacts at the joint limits of a door; x of the normal is the sign of the push.
INLINE void at_limits(const Env& e, int m, Points& points) {
  const float* door = e.door + DOOR_COLUMNS * (m - e.free);
  for (int end = 0; end < 2; ++end) {
    const real sense = end == 0 ? 1 : -1, distance = sense * (e.quat[4 * m] - door[11 + end]);
    if (distance < 0) points.add({e.pos[3 * m], e.pos[3 * m + 1], e.pos[3 * m + 2]}, distance, {sense, 0, 0});
  }
}

// Lists the awake dynamic bodies in ascending order; returns their number.
__device__ int list_awake(const Env& e) {
  int count = 0;
  for (int base = 0; base < e.mobiles; base += WARP_SIZE) {
    const int m = base + LANE;
    const bool awake = m < e.mobiles && e.awake[m];
    const unsigned mask = warp_ballot(awake);
    if (awake) e.list[count + count_bits(mask & ((1u << LANE) - 1))] = m;
    count += count_bits(mask);
  }
  sync_warp();
  return count;
}

// Returns whether the bounding spheres of two dynamic bodies are at most `reach` apart.
INLINE bool spheres_meet(const Env& e, int a, int b, real reach) {
  real square = 0;
  for (int k = 0; k < 3; ++k) {
    const real step = e.pos[3 * a + k] - e.pos[3 * b + k];
    square += step * step;
  }
  const real far = e.radius[a] + e.radius[b] + reach;
  return square <= far * far;
}

// Lists pairs of dynamic bodies whose bounding spheres overlap, as first + (second + part * mobiles) * mobiles; returns
// their number. The first is awake. Of two awake bodies, the first has the lower index. Doors do not collide with each
// other; a drawer has a pair for each of its boxes.
__device__ int list_pairs(const Env& e, int awake) {
  int count = 0;
  for (int base = 0; base < awake * e.mobiles; base += WARP_SIZE) {
    const int pair = base + LANE, m = e.list[pair < awake * e.mobiles ? pair / e.mobiles : 0], other = pair % e.mobiles;
    bool near = pair < awake * e.mobiles && e.exists[other] && other != m && (m < e.free || other < e.free);
    near = near && (!e.awake[other] || other < m);
    near = near && spheres_meet(e, m, other, 0);
    const int both = near && e.awake[other] ? other + m * e.mobiles : m + other * e.mobiles;
    const int parts = near ? num_parts(e, m > other ? m : other) : 0;
    for (int part = 0; part <= TRAY_BOXES; ++part) {
      const unsigned mask = warp_ballot(part < parts);
      if (mask == 0) break;
      const int place = count + count_bits(mask & ((1u << LANE) - 1));
      if (part < parts && place < e.pair_room) e.pairs[place] = both + part * e.mobiles * e.mobiles;
      count += count_bits(mask);
    }
  }
  sync_warp();
  if (count <= e.pair_room) return count;
  if (LANE == 0) e.counts[POINT_OVERFLOW] = 1;
  return e.pair_room;
}

// Writes all contacts of an environment; returns their number.
__device__ int find_contacts(const Env& e, const House& house, real floor) {
  keep_near(e, house);
  const int awake = list_awake(e), pairs = list_pairs(e, awake);
  if (LANE == 0) e.counts[NUM_AWAKE] = awake;
  int statics = 0;
  for (int i = 0; i < awake && e.list[i] < e.free; ++i) statics += e.num_near[e.list[i]];
  const int total = awake + statics + pairs;
  int count = 0;
  for (int base = 0; base < total; base += WARP_SIZE) {
    int pair = base + LANE, first = -1, second = STATIC, part = 0;
    Points points;
    points.count = 0;
    if (pair < awake) {
      first = e.list[pair];
      if (first < e.free) second = FLOOR, on_floor(e, first, floor, points);
      else second = JOINT_LIMIT, at_limits(e, first, points);
    } else if (pair < total) {  // a static box or another dynamic body
      Box box;
      if ((pair -= awake) < statics) {
        int i = 0;
        while (pair >= e.num_near[e.list[i]]) pair -= e.num_near[e.list[i++]];
        const int m = e.list[i];
        const int number = int(e.near[MAX_NEAR_BOXES * m + pair]);
        first = m, second = STATIC - number, box = static_box(house, number);
      } else {
        const int both = e.pairs[pair - statics];
        first = both % e.mobiles, second = both / e.mobiles % e.mobiles, part = both / e.mobiles / e.mobiles;
        if (second >= e.agents) box = mobile_box(e, second, second >= e.free ? part : 0);
        if (first < e.free) part = 0;  // that of the first body
      }
      if (second >= 0 && second < e.agents) {
        const Vec a = {e.pos[3 * first], e.pos[3 * first + 1], e.pos[3 * first + 2]};
        const Vec b = {e.pos[3 * second], e.pos[3 * second + 1], e.pos[3 * second + 2]};
        capsule_capsule(a, b, e.agent + AGENT_COLUMNS * first, e.agent + AGENT_COLUMNS * second, points);
      } else {
        with_box(e, first, part, box, points);
      }
      if (second >= 0 && !e.awake[second]) {
        if (points.count) e.wakes[second] = 1;
        second = SLEEPING_BODY - second;
      }
    }
    count = write_contacts(e, count, first, second, points);
  }
  sync_warp();
  return count;
}
