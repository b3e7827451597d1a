// Contact points of pairs of shapes, in the order of numba/box_box.py and numba/capsule.py.

struct Vec {
  real x, y, z;
  INLINE real operator[](int k) const { return k == 0 ? x : k == 1 ? y : z; }
};

INLINE Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
INLINE Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
INLINE Vec operator*(real s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
INLINE real dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
INLINE real absolute(real x) { return fabs(x); }  // also maps -0 to 0
INLINE real clamped(real x, real low, real high) { return x < low ? low : x > high ? high : x; }

struct Box {
  Vec pos;
  Vec axis[3];  // in the world
  real half[3];
  INLINE Vec local(Vec v) const { return {dot(axis[0], v), dot(axis[1], v), dot(axis[2], v)}; }
  INLINE Vec world(Vec v) const { return v.x * axis[0] + v.y * axis[1] + v.z * axis[2]; }
};

struct Point {
  Vec pos;
  real distance;
  Vec normal;
};

// Contact points of a pair, before they are written to the contacts.
struct Points {
  Point at[MAX_PAIR_POINTS];
  int count;
  INLINE void add(Vec pos, real distance, Vec normal) {
    if (count < MAX_PAIR_POINTS) at[count++] = {pos, distance, normal};
  }
};

struct Clip {
  const Box& box;  // owner of the face
  int up;
  real side;
  Vec normal;  // of the contacts
  Points& points;
  INLINE real size(int q) const { return box.half[(up + 1 + q) % 3]; }
  INLINE void add(real x, real y, real z) {
    if (z > 0) return;
    const Vec p = x * box.axis[(up + 1) % 3] + (side * y) * box.axis[(up + 2) % 3] +
                  (side * (z / 2 + box.half[up])) * box.axis[up];
    points.add(box.pos + p, z, normal);
  }
};

// Adds the points where an edge crosses the border of the rectangle.
INLINE void crossings(Clip& clip, const real* start, const real* edge) {
  for (int q = 0; q < 2; ++q) {
    if (absolute(edge[q]) <= MIN_CROSS_LENGTH) continue;
    for (int s = -1; s <= 1; s += 2) {
      const real border = s * clip.size(q);
      const real t = (border - start[q]) / edge[q];
      const real across = start[1 - q] + t * edge[1 - q];
      if (t < 0 || t > 1 || absolute(across) > clip.size(1 - q)) continue;
      clip.add(q == 0 ? border : across, q == 0 ? across : border, start[2] + t * edge[2]);
    }
  }
}

// Clips the face of the other box that is most antiparallel to this face.
__device__ void face_points(const Box& one, const Box& two, int up, real sign, Points& points) {
  const Vec between = two.pos - one.pos;
  const real side = dot(one.axis[up], between) < 0 ? -1 : 1;
  const Vec frame[3] = {one.axis[(up + 1) % 3], side * one.axis[(up + 2) % 3], side * one.axis[up]};
  real corner[3], local[3][3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = dot(frame[k], between);
    for (int j = 0; j < 3; ++j) local[k][j] = dot(frame[k], two.axis[j]);
  }
  corner[2] -= one.half[up];
  const real x = absolute(local[2][0]), y = absolute(local[2][1]), z = absolute(local[2][2]);
  const int facing = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  real edges[2][3];
  for (int j = 0; j < 3; ++j) {
    const real lower = local[2][j] < 0 ? two.half[j] : -two.half[j];
    for (int k = 0; k < 3; ++k) {
      corner[k] += lower * local[k][j];
      if (j != facing) edges[j == (facing + 1) % 3 ? 0 : 1][k] = -2 * lower * local[k][j];
    }
  }
  Clip clip{one, up, side, sign * frame[2], points};
  for (int i = 0; i < 4; ++i) {
    real start[3];
    for (int k = 0; k < 3; ++k) start[k] = corner[k] + (i > 1 ? edges[1 - i % 2][k] : 0);
    crossings(clip, start, edges[i % 2]);
  }
  const real a = edges[0][0], c = edges[0][1], b = edges[1][0], d = edges[1][1], det = a * d - b * c;
  for (int i = 0; i < 4 && det != 0; ++i) {
    const real px = i & 1 ? clip.size(0) : -clip.size(0), py = i & 2 ? clip.size(1) : -clip.size(1);
    const real u = ((px - corner[0]) * d - (py - corner[1]) * b) / det;
    const real v = ((py - corner[1]) * a - (px - corner[0]) * c) / det;
    if (u > 0 && v > 0 && u < 1 && v < 1) clip.add(px, py, corner[2] + u * edges[0][2] + v * edges[1][2]);
  }
  for (int i = 0; i < 4; ++i) {
    real p[3];
    for (int k = 0; k < 3; ++k) p[k] = corner[k] + (i & 1 ? edges[0][k] : 0) + (i & 2 ? edges[1][k] : 0);
    if (absolute(p[0]) < clip.size(0) && absolute(p[1]) < clip.size(1)) clip.add(p[0], p[1], p[2]);
  }
}

__device__ void box_box(const Box& one, const Box& two, Points& points) {
  const Vec gap = one.local(two.pos - one.pos);
  const real between[3] = {gap.x, gap.y, gap.z};
  real cosine[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) cosine[i][j] = dot(one.axis[i], two.axis[j]);
  real least = INF;
  int face = -1;
  for (int i = 0; i < 3; ++i) {
    real over1 = one.half[i] - absolute(between[i]), over2 = two.half[i], along = 0;
    for (int j = 0; j < 3; ++j) {
      over1 += absolute(cosine[i][j]) * two.half[j];
      over2 += absolute(cosine[j][i]) * one.half[j];
      along += cosine[j][i] * between[j];
    }
    over2 -= absolute(along);
    if (over1 < 0 || over2 < 0) return;
    if (over1 < least) least = over1, face = i;
    if (over2 < least) least = over2, face = 3 + i;
  }
  real best = INF, axis[3] = {0, 0, 0};
  int edge = -1;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int p = (i + 1) % 3, q = (i + 2) % 3;
      real x = -cosine[q][j], y = cosine[p][j];
      const real length = sqrt(x * x + y * y);
      if (length < MIN_CROSS_LENGTH) continue;
      x /= length, y /= length;
      const real apart = x * between[p] + y * between[q];
      real over = one.half[p] * absolute(x) + one.half[q] * absolute(y) - absolute(apart);
      for (int k = 0; k < 3; ++k)
        if (k != j) over += two.half[k] * absolute(cosine[i][3 - j - k]) / length;
      if (over < 0) return;
      if (over < best) {
        const real sign = apart < 0 ? -1 : 1;
        best = over, edge = 3 * i + j;
        axis[i] = 0, axis[p] = sign * x, axis[q] = sign * y;
      }
    }
  if (edge >= 0 && best < least * MAX_EDGE_OVERLAP_RATIO) {
    real likeness = 0;
    for (int k = 0; k < 3; ++k) likeness += axis[k] * (face < 3 ? (k == face) : cosine[k][face - 3]);
    if (absolute(likeness) < ALIGNED_COSINE || best < ALIGNED_OVERLAP_RATIO * least) {
      const int e1 = edge / 3, e2 = edge % 3;
      real start[3], other[3];
      for (int k = 0; k < 3; ++k) {
        other[k] = between[k];
        start[k] = k == e1 ? 0 : axis[k] > 0 ? one.half[k] : -one.half[k];
      }
      for (int j = 0; j < 3; ++j)
        if (j != e2) {
          const real away = axis[0] * cosine[0][j] + axis[1] * cosine[1][j] + axis[2] * cosine[2][j];
          const real shift = away < 0 ? two.half[j] : -two.half[j];
          for (int k = 0; k < 3; ++k) other[k] += shift * cosine[k][j];
        }
      const real along = cosine[e1][e2], gap1 = other[e1] - start[e1];
      real gap2 = 0;
      for (int k = 0; k < 3; ++k) gap2 += (other[k] - start[k]) * cosine[k][e2];
      const real t = (along * gap1 - gap2) / (1 - along * along), s = gap1 + t * along;
      if (absolute(s) <= one.half[e1] && absolute(t) <= two.half[e2]) {
        real distance = 0, middle[3];
        for (int k = 0; k < 3; ++k) {
          const real here = start[k] + (k == e1 ? s : 0), there = other[k] + t * cosine[k][e2];
          distance += (there - here) * axis[k];
          middle[k] = (here + there) / 2;
        }
        points.add(one.pos + one.world({middle[0], middle[1], middle[2]}), distance,
                   one.world({axis[0], axis[1], axis[2]}));
        return;
      }
    }
  }
  if (face < 3)
    face_points(one, two, face, 1, points);
  else
    face_points(two, one, face - 3, -1, points);
}

// Adds the contact of a sphere and a box; the centre is in the box's frame.
INLINE void sphere_box(Vec center, real radius, const Box& box, Points& points) {
  const Vec near = {clamped(center.x, -box.half[0], box.half[0]), clamped(center.y, -box.half[1], box.half[1]),
                    clamped(center.z, -box.half[2], box.half[2])};
  Vec normal = near - center;
  const real distance = sqrt(dot(normal, normal));
  if (distance > radius) return;
  if (distance > TINY) {
    normal = (1 / distance) * normal;
    const Vec at = center + ((distance + radius) / 2) * normal;
    points.add(box.pos + box.world(at), distance - radius, box.world(normal));
    return;
  }
  // The centre is inside the box: push out through the nearest face.
  real nearest = INF, side = 1;
  int axis = 0;
  for (int k = 0; k < 3; ++k)
    for (int s = -1; s <= 1; s += 2) {
      const real depth = absolute(s * box.half[k] - center[k]);
      if (depth < nearest) nearest = depth, axis = k, side = s;
    }
  normal = {axis == 0 ? -side : real(0), axis == 1 ? -side : real(0), axis == 2 ? -side : real(0)};
  const Vec at = center + ((radius - nearest) / 2) * normal;
  points.add(box.pos + box.world(at), -nearest - radius, box.world(normal));
}

// Computes the positions of a capsule's two contact spheres on its axis, from -1 to 1; `second` is NONE if missing.
__device__ void capsule_places(Vec center, Vec axis, real length, const Box& box, real& first, real& second) {
  real best = INF, t = 0, at = 0;
  int kind = -1, on = -1, corner = 0;  // kind: 0 face, 1 edge, 2 corner
  for (int end = -1; end <= 1; end += 2) {
    int outside = 0, face = -1;
    real square = 0;
    for (int k = 0; k < 3; ++k) {
      const real beyond = absolute(center[k] + end * axis[k]) - box.half[k];
      if (beyond > 0) ++outside, face = k, square += beyond * beyond;
    }
    if (outside <= 1 && square < best) best = square, t = end, kind = 0, on = face;
  }
  for (int j = 0; j < 3; ++j) {
    const real ma = box.half[j] * box.half[j], mb = -box.half[j] * axis[j], mc = length * length;
    const real det = ma * mc - mb * mb;
    if (absolute(det) < TINY) continue;
    for (int i = 0; i < 8; ++i) {
      if (i & (1 << j)) continue;
      real gap[3];
      for (int k = 0; k < 3; ++k) gap[k] = (k == j ? 0 : i & (1 << k) ? box.half[k] : -box.half[k]) - center[k];
      const real u = -box.half[j] * gap[j], v = axis.x * gap[0] + axis.y * gap[1] + axis.z * gap[2];
      real edge = (mc * u - mb * v) / det, place = (ma * v - mb * u) / det;
      int end = 0;
      if (absolute(edge) > 1) {
        end = edge > 0 ? 1 : -1;
        edge = end;
        place = (v - edge * mb) / mc;
      }
      if (absolute(place) > 1) {
        place = place > 0 ? 1 : -1;
        edge = (u - place * mb) / ma;
        if (absolute(edge) > 1) end = edge > 0 ? 1 : -1, edge = end;
      }
      real square = 0;
      for (int k = 0; k < 3; ++k) {
        const real value = gap[k] - place * axis[k] + (k == j ? box.half[j] * edge : 0);
        square += value * value;
      }
      if (square < best - TINY) {
        best = square, t = place, on = j, at = edge, kind = end == 0 ? 1 : 2;
        corner = end > 0 ? i + (1 << j) : i;
      }
    }
  }
  first = t, second = NONE;
  int forward = 0;
  for (int k = 0; k < 3; ++k)
    if (axis[k] > 0) forward += 1 << k;
  if (kind == 0) {
    if (on < 0) return;
    const real direction = -t;
    real reach = 2;
    for (int k = 0; k < 3; ++k)
      if (k != on) {
        const real value = center[k] + t * axis[k];
        for (int s = -1; s <= 1; s += 2) {
          const real step = (s * box.half[k] - value) / axis[k] * direction;
          if (0 < step && step < reach) reach = step;
        }
      }
    second = t + reach * direction;
  } else if (kind == 2) {
    int turn = forward ^ corner;
    if (turn == 0 || turn == 7) return;
    real direction = 1, ahead = 1 - t, back = 1 + t;
    if (turn == 3 || turn == 5 || turn == 6) direction = -1, turn = 7 - turn, ahead = 1 + t, back = 1 - t;
    const int ax = turn == 1 ? 0 : turn == 2 ? 1 : 2, ax1 = (ax + 1) % 3, ax2 = (ax + 2) % 3;
    if (axis[ax] * axis[ax] > real(0.5) * length * length) {
      second = t + direction * fmin(ahead, 2 * box.half[ax] / absolute(axis[ax]));
    } else {
      const real r = fmin(2 * box.half[ax1] / absolute(axis[ax1]), 2 * box.half[ax2] / absolute(axis[ax2]));
      second = t - direction * fmin(back, r);
    }
  } else if (kind == 1) {
    const int turn = (forward ^ corner) & (7 - (1 << on));
    if (turn != 1 && turn != 2 && turn != 4) return;
    int ax1 = (on + 1) % 3, ax2 = (on + 2) % 3;
    if (absolute(axis[ax1]) > absolute(axis[ax2])) ax1 = ax2;
    ax2 = 3 - on - ax1;
    const int across = (turn >> ax2) & 1;
    const real left = ((forward >> on) & 1) == across ? 1 - at : 1 + at;
    const real reach = fmin(across ? 1 - t : 1 + t, 2 * box.half[ax2] / absolute(axis[ax2]));
    second = t + (across ? 1 : -1) * fmin(reach, box.half[on] * left / absolute(axis[on]));
  }
}

// Adds the contact points of an upright capsule and a box.
__device__ void capsule_box(Vec pos, real radius, real length, const Box& box, Points& points) {
  const Vec center = box.local(pos - box.pos), axis = {length * box.axis[0].z, length * box.axis[1].z, length * box.axis[2].z};
  real first, second;
  capsule_places(center, axis, length, box, first, second);
  sphere_box(center + first * axis, radius, box, points);
  if (second != NONE) sphere_box(center + second * axis, radius, box, points);
}

// Adds the contact points of two upright capsules; sizes are radius, then half length of the axis.
__device__ void capsule_capsule(Vec one, Vec two, const float* size1, const float* size2, Points& points) {
  const real radius1 = size1[0], length1 = size1[1], radius2 = size2[0], length2 = size2[1];
  const real low = fmax(one.z - length1, two.z - length2), high = fmin(one.z + length1, two.z + length2);
  for (int i = 0; i < 2; ++i) {
    real z1 = i == 0 ? low : high, z2 = z1;
    if (low > high) z1 = one.z < two.z ? high : low, z2 = one.z < two.z ? low : high;
    const Vec step = {two.x - one.x, two.y - one.y, z2 - z1};
    const real distance = sqrt(dot(step, step)), gap = distance - radius1 - radius2;
    if (gap > 0) continue;
    const Vec normal = distance < TINY ? Vec{1, 0, 0} : (1 / distance) * step;
    points.add(Vec{one.x, one.y, z1} + (radius1 + gap / 2) * normal, gap, normal);
  }
}
