// Flights of rays through a house, one ray per thread: the estimator of trace/flight.py. Compiled after cast.cu.
//
// A bounce of all flights is two kernels: trace_segments, then resample_flights with a block per flight. Random numbers
// depend on seed, bounce and ray alone, and sums are integers, so that results have the same bits in every run.

constexpr int OCTAVES = 7;        // as in schema/compiled.py
constexpr int LANES = 8;          // floats of a row of octaves
constexpr int RECORDED = 10;      // octaves, then the intensity
constexpr int PLACE = 12;         // floats of a ray: origin, direction, normal of the surface, distance, 2 unused
constexpr int NOTES = 4;          // integers of a ray: material row, room in front of the surface, unmirrored, room
constexpr int TEAM = 256;         // threads of a block of resample_flights
constexpr int TRACING_BLOCKS = 10;  // blocks of trace_segments per multiprocessor: limits the compiler to 96 registers
constexpr float FINE = 4398046511104.f;  // 2^42, units of energy 1 in sums of cells, of portals and of rooms
constexpr float COARSE = 68719476736.f;  // 2^36, the same in sums that include path length or all reflections
// As in trace/flight.py
constexpr float RAY_OFFSET = 1e-4f, INWARD_OFFSET = .1f, MAX_RAY_LENGTH = 1e4f, FLOOR_THICKNESS_RATIO = 2;
constexpr float BELOW_CELL = .9f + INWARD_OFFSET, MAX_ACTIVE_SHARE = .1f, MIN_ENERGY_SHARE = 1e-6f, EVENNESS = .7f;
constexpr float TINY_ENERGY = 1e-30f, BELOW_ONE = .99999994f, TURN = 6.2831855f;
constexpr int SAMPLES_PER_BIN = 2, ENTRY_BISECTIONS = 5, BEHIND_OFFSETS = 4;

using Word = long long;
using Sum = unsigned long long;  // of integers in two's complement
enum Purpose { CHANCE, HEIGHT, AROUND, END_CHANCE, END_HEIGHT, END_AROUND, RESAMPLE, PHASE, PURPOSES };

// Arguments are structures of 8-byte words, in the order of device.py and flights.py.
struct World {  // as in cast.cu
  const float4 *node, *triangle;
  const int* material_mask;
  const float4 *fixed, *moving;
  const float2* box;
  Word root, num_moving, nodes, triangles, materials, instances;
};

struct Flights : World {
  const float* inverse;                                     // (i, 3, 4), model from world
  const int* material;                                      // (i,)
  const float *absorption, *scattering, *transmission;      // (materials, LANES)
  const int* lookup;                                        // (levels, rows, columns)
  const float *low, *high;                                  // (cells,)
  const int* cell_room;                                     // (cells,)
  const unsigned char* joined;                              // (rooms, rooms)
  const float* air;                                         // (LANES,)
  Word levels, rows, columns, rooms, cells;
  double x, y, step, bin_length;
  const Word* first;                                        // (flights + 1,), first ray
  const Sum* seed;                                          // (flights,)
  const float* age;                                         // (flights,), path length [m]
  int* limit;                                               // (flights,), number of bounces
  const int* flight;                                        // (rays,)
  float* place;                                             // (2, rays, PLACE), after even and odd bounces
  float* energy;                                            // (2, rays, LANES)
  int* notes;                                               // (2, rays, NOTES)
  double* reached;                                          // (rays,), cumulative weight in the flight
  float* factor;                                            // (flights, rooms, LANES), of energies in weights
  float* balance;                                           // (flights, 2, LANES), active energy, and that at first
  Sum* aged;                                                // (flights, LANES)
  Sum *recorded, *portal, *path_length, *absorbed, *exchanged, *transmitted;  // see tracer.SourceSums
  float *ended_place, *ended_energy;                        // (kept, LANES)
  int* ended_rooms;                                         // (kept, 2)
  Word* ended_key;                                          // (kept,), order of ended rays
  Sum* ended_count;
  Word kept, flights, rays, bins, from_source, ends, bounce;
};

struct Octaves {
  float x[OCTAVES];
};

struct Point {
  float x, y, z;
};

struct Flyer {  // a ray of a flight
  Point origin, direction;
  float travelled;
  Octaves energy;
  int room, last;
  bool recorded;
};

struct Surface {  // at the end of a ray's segment
  Point normal;
  int row, seen;
  bool unmirrored;
};

struct Tally {  // energies of a segment that sums over rooms receive
  Word before, after;  // rows of the rooms at its ends
  Octaves flown, lost;  // times half its length; absorbed
};

INLINE float total(const Octaves& e) {
  float sum = 0;
  for (int b = 0; b < OCTAVES; ++b) sum += e.x[b];
  return sum;
}

INLINE Octaves load(const float* at) {
  Octaves e;
  for (int b = 0; b < OCTAVES; ++b) e.x[b] = at[b];
  return e;
}

INLINE void store(float* at, const Octaves& e) {
  for (int b = 0; b < OCTAVES; ++b) at[b] = e.x[b];
}

INLINE void add(Sum* at, float value, float units) { atomicAdd(at, Sum(__float2ll_rn(value * units))); }

INLINE void add(Sum* sums, Word row, const Octaves& e, float units) {
  for (int b = 0; b < OCTAVES; ++b)
    if (e.x[b] != 0) add(sums + row * OCTAVES + b, e.x[b], units);
}

// Adds energies of all lanes of a warp: at once, if those `alive` have the same row
INLINE void add_by_warp(Sum* sums, bool alive, Word row, const Octaves& e, float units) {
#ifndef WARP_SIZE
  unsigned lanes = warp_ballot(alive);
  if (lanes == 0) return;
  Word common = __shfl_sync(ALL_LANES, row, __ffs(lanes) - 1);
  if (warp_ballot(alive && row != common) == 0) {
    for (int b = 0; b < OCTAVES; ++b) {
      Word value = alive ? __float2ll_rn(e.x[b] * units) : 0;
      for (int step = 16; step > 0; step /= 2) value += __shfl_xor_sync(ALL_LANES, value, step);
      if (threadIdx.x % 32 == 0) atomicAdd(sums + common * OCTAVES + b, Sum(value));
    }
    return;
  }
#endif
  if (alive) add(sums, row, e, units);
}

// Returns a random number in [0, 1): number `bounce, ray, purpose` of a SplitMix64 stream
INLINE float uniform(const Flights& f, int flight, Word bounce, Word ray, Purpose purpose) {
  Sum z = f.seed[flight] + Sum(((bounce << 32) + ray) * PURPOSES + purpose + 1) * 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return float((z ^ (z >> 31)) >> 40) * 5.9604645e-8f;
}

INLINE Point along(const Point& o, const Point& d, float t) { return {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z}; }

INLINE float dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Returns exp(-air length) of an octave, as `attenuate` does
INLINE float attenuation(float air, float length) {
  float x = fminf(air * length, 8) * .125f;
  float y = 1 - x * (1 - x * (.5f - x * (1 / 6.f - x * (1 / 24.f))));
  y *= y, y *= y;
  return y * y;
}

INLINE int cell_at(const Flights& f, const Point& p) {
  float column = floorf((p.x - float(f.x)) / float(f.step)), row = floorf((p.y - float(f.y)) / float(f.step));
  if (!(row >= 0 && row < f.rows && column >= 0 && column < f.columns)) return -1;
  for (Word level = f.levels - 1; level >= 0; --level) {
    int cell = f.lookup[(level * f.rows + Word(row)) * f.columns + Word(column)];
    if (cell >= 0 && p.z >= f.low[cell] - BELOW_CELL) return cell;
  }
  return -1;
}

INLINE int room_at(const Flights& f, const Point& p) {
  int cell = cell_at(f, p);
  return cell >= 0 ? f.cell_room[cell] : -1;
}

// Adds energy and intensity of a segment to cells, at SAMPLES_PER_BIN regular times per bin
INLINE void record(const Flights& f, int flight, const Flyer& ray, float length, float phase) {
  float unit = float(f.bin_length) / SAMPLES_PER_BIN;
  Word index = Word(ceilf(ray.travelled / unit - phase));
  float at = (float(index) + phase) * unit - ray.travelled;
  for (; at < length && index < f.bins * SAMPLES_PER_BIN; at += unit, ++index) {
    Point p = along(ray.origin, ray.direction, at);
    int cell = cell_at(f, p);
    if (cell < 0 || p.z < f.low[cell] || p.z >= f.high[cell] || index < 0) continue;
    Sum* row = f.recorded + ((flight * f.cells + cell) * f.bins + index / SAMPLES_PER_BIN) * RECORDED;
    float sum = 0;
    for (int b = 0; b < OCTAVES; ++b) {
      float e = ray.energy.x[b] * attenuation(f.air[b], at) / SAMPLES_PER_BIN;
      add(row + b, e, FINE);
      sum += e;
    }
    add(row + OCTAVES, sum * ray.direction.x, FINE);
    add(row + OCTAVES + 1, sum * ray.direction.y, FINE);
    add(row + OCTAVES + 2, sum * ray.direction.z, FINE);
  }
}

// Adds the energy that architecture would transmit to the first other room behind it
INLINE void transmit(const Flights& f, int flight, const Octaves& energy, const Point& p, const Surface& s, int room) {
  const float depths[BEHIND_OFFSETS] = {.08f, .15f, .25f, .4f};
  float across = fabsf(s.normal.z) < .5f ? 1 : FLOOR_THICKNESS_RATIO;
  for (int i = 0; i < BEHIND_OFFSETS; ++i) {
    int behind = room_at(f, along(p, s.normal, -depths[i] * across));
    if (behind < 0 || behind == room) continue;
    Octaves passed = energy;
    for (int b = 0; b < OCTAVES; ++b) passed.x[b] *= f.transmission[LANES * Word(s.row) + b];
    add(f.transmitted, (flight * f.rooms + room) * f.rooms + behind, passed, COARSE);
    return;
  }
}

// Writes a specular or Lambertian direction, multiplies the energies by their factors; returns whether it is specular
INLINE bool reflect(const float* scattering, const Surface& s, const Octaves& share, float chance, float height,
                    float turn, Point& direction, Octaves& energy) {
  float sum = 0;
  for (int b = 0; b < OCTAVES; ++b) sum += share.x[b] * scattering[b];
  float scatters = sum / fmaxf(total(share), TINY_ENERGY);
  if (chance >= scatters) {
    for (int b = 0; b < OCTAVES; ++b) energy.x[b] *= (1 - scattering[b]) / (1 - scatters);
    direction = along(direction, s.normal, -2 * dot(direction, s.normal));
    return true;
  }
  for (int b = 0; b < OCTAVES; ++b) energy.x[b] *= scattering[b] / scatters;
  float z = 1 - 2 * height, radius = sqrtf(fmaxf(1 - z * z, 0));
  Point d{s.normal.x + radius * cosf(TURN * turn), s.normal.y + radius * sinf(TURN * turn), s.normal.z + z};
  float scale = 1 / fmaxf(sqrtf(dot(d, d)), 1e-6f);
  direction = {d.x * scale, d.y * scale, d.z * scale};
  return false;
}

// Adds energy that passes from a room to another one, or ages there (equal rooms), at a time [bins]
INLINE void add_portal(const Flights& f, int flight, int room, int entered, float when, const Octaves& energy) {
  Word bin = max(min(Word(when), f.bins - 1), Word(0));
  add(f.portal, ((flight * f.rooms + room) * f.rooms + entered) * f.bins + bin, energy, FINE);
}

INLINE void keep(const Flights& f, int flight, Word number, const Flyer& ray, const Octaves& energy, float since,
                 int room, int entered, Word bounce) {
  if (f.kept == 0) return;
  Word at = atomicAdd(f.ended_count, Sum(1));
  if (at >= f.kept) return;
  float* place = f.ended_place + LANES * at;
  place[0] = ray.origin.x, place[1] = ray.origin.y, place[2] = ray.origin.z;
  place[3] = ray.direction.x, place[4] = ray.direction.y, place[5] = ray.direction.z, place[6] = since;
  store(f.ended_energy + LANES * at, energy);
  f.ended_rooms[2 * at] = room, f.ended_rooms[2 * at + 1] = entered;
  f.ended_key[at] = Word(flight) << 48 | bounce << 28 | number;
}

INLINE float length_inside(const Flights& f, const Flyer& ray, float length, int room) {
  float low = 0, high = length;
  for (int i = 0; i < ENTRY_BISECTIONS; ++i) {
    float middle = (low + high) * .5f;
    (room_at(f, along(ray.origin, ray.direction, middle)) == room ? high : low) = middle;
  }
  return length - high;
}

INLINE Point normal_of(const Flights& f, const Point& direction, int instance, int triangle) {
  const float4* t = f.triangle + 3ll * triangle;
  float4 p = t[0], q = t[1], r = t[2];
  float ax = q.x - p.x, ay = q.y - p.y, az = q.z - p.z, bx = r.x - p.x, by = r.y - p.y, bz = r.z - p.z;
  float u = ay * bz - az * by, v = az * bx - ax * bz, w = ax * by - ay * bx;
  const float* m = f.inverse + 12ll * instance;
  Point n{m[0] * u + m[4] * v + m[8] * w, m[1] * u + m[5] * v + m[9] * w, m[2] * u + m[6] * v + m[10] * w};
  float scale = 1 / fmaxf(sqrtf(dot(n, n)), TINY_ENERGY);
  if (dot(n, direction) > 0) scale = -scale;
  return {n.x * scale, n.y * scale, n.z * scale};
}

INLINE const float* row_of(const float* table, int row) { return table + LANES * Word(row); }

// Records the segment of a ray up to its hit, and reduces its energy or ends it; `number`: of the ray in its flight
INLINE Surface meet(const Flights& f, int flight, Word number, Flyer& ray, const Best& hit, Tally& tally) {
  Surface s{{0, 0, 1}, 0, ray.room, false};
  int before = ray.room;
  Word row_before = flight * f.rooms + before;
  tally = {row_before, row_before, {}, ray.energy};
  if (hit.instance < 0) {
    ray.energy = {};
    return s;
  }
  float length = hit.t;
  Word row = Word(f.material[hit.instance]) + __float_as_int(f.triangle[3ll * hit.triangle].w);
  s.row = int(min(max(row, Word(0)), f.materials - 1));
  s.normal = normal_of(f, ray.direction, hit.instance, hit.triangle);
  Point end = along(ray.origin, ray.direction, length);
  int seen = room_at(f, along(end, s.normal, INWARD_OFFSET));
  s.seen = seen >= 0 ? seen : before;
  int room = f.joined[before * f.rooms + s.seen] || s.seen == ray.last ? s.seen : before;
  tally.after = flight * f.rooms + room;
  if (ray.recorded) record(f, flight, ray, length, uniform(f, flight, 0, number, PHASE));
  Octaves left, middle;
  const float* absorption = row_of(f.absorption, s.row);
  for (int b = 0; b < OCTAVES; ++b) {
    float half = attenuation(f.air[b], .5f * length);
    middle.x[b] = ray.energy.x[b] * half;
    left.x[b] = middle.x[b] * half;
    tally.flown.x[b] = middle.x[b] * (.5f * length);
  }
  if (room != before) add(f.exchanged, row_before * f.rooms + room, middle, COARSE);
  if (hit.instance == 0) transmit(f, flight, left, end, s, room);
  for (int b = 0; b < OCTAVES; ++b) {
    left.x[b] *= 1 - absorption[b];
    tally.lost.x[b] = ray.energy.x[b] - left.x[b];
  }
  bool unheard = f.from_source && ray.travelled == 0, goes = f.ends && room != before && !unheard;
  float inside = goes ? length_inside(f, ray, length, room) : 0;
  ray.travelled += length;
  ray.origin = along(end, s.normal, RAY_OFFSET);
  s.unmirrored = unheard && hit.instance == 0;
  ray.room = room, ray.energy = left;
  if (!goes && !(ray.travelled >= f.age[flight] && !unheard)) return s;
  float when = (ray.travelled - inside) / float(f.bin_length);
  int from = goes ? before : room;
  add_portal(f, flight, from, room, when, left);
  if (!goes)
    for (int b = 0; b < OCTAVES; ++b) add(f.aged + flight * LANES + b, left.x[b], FINE);
  const float* active = f.balance + 2 * LANES * Word(flight);
  Octaves share = left;
  for (int b = 0; b < OCTAVES; ++b) share.x[b] /= fmaxf(active[b], TINY_ENERGY);
  Flyer out = ray;
  auto chance = [&](Purpose purpose) { return uniform(f, flight, f.bounce, number, purpose); };
  reflect(row_of(f.scattering, s.row), s, share, chance(END_CHANCE), chance(END_HEIGHT), chance(END_AROUND),
          out.direction, out.energy);
  float since = inside + (when - floorf(when)) * float(f.bin_length);
  keep(f, flight, number, out, out.energy, since, from, room, f.bounce);
  ray.energy = {};
  return s;
}

INLINE double weight_of(const Flights& f, int flight, const Octaves& e, int room, Octaves& share) {
  const float* factor = f.factor + (flight * f.rooms + room) * LANES;
  double weight = 0;
  for (int b = 0; b < OCTAVES; ++b) weight += share.x[b] = e.x[b] * factor[b];
  return weight;
}

// Returns ray `number` of a flight as it starts bounce `bounce`: resampled from those after the last one, and reflected
INLINE Flyer next_ray(const Flights& f, int flight, Word number, Word bounce) {
  Word first = f.first[flight], count = f.first[flight + 1] - first, i = number, buffer = (bounce + 1 & 1) * f.rays;
  const double* reached = f.reached + first;
  double whole = reached[count - 1], spacing = whole / count, start = 0;
  if (bounce > 0) {
    start = spacing * uniform(f, flight, bounce - 1, 0, RESAMPLE);
    Word high = count - 1;
    for (i = 0; i < high;) {
      Word middle = (i + high) / 2;
      if (reached[middle] > start + number * spacing) high = middle;
      else i = middle + 1;
    }
  }
  Word row = buffer + first + i;
  const float* p = f.place + PLACE * row;
  const int* note = f.notes + NOTES * row;
  Flyer ray{{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, p[9], load(f.energy + LANES * row), note[3], note[1], note[2] == 0};
  if (bounce == 0) return ray;
  Octaves share;
  double weight = weight_of(f, flight, ray.energy, ray.room, share), before = i > 0 ? reached[i - 1] : 0;
  if (!(weight > 0) || !(spacing > 0)) {
    ray.energy = {};
    return ray;
  }
  Word low = max(Word(ceil((before - start) / spacing)), Word(0)), high = Word(ceil((reached[i] - start) / spacing)) - 1;
  low = min(low, number), high = max(i == count - 1 ? count - 1 : min(high, count - 1), number);
  for (int b = 0; b < OCTAVES; ++b) ray.energy.x[b] *= float(spacing / weight);
  auto chance = [&](Purpose purpose) { return uniform(f, flight, bounce, number, purpose); };
  float part = fminf((float(number - low) + chance(CHANCE)) / float(high - low + 1), BELOW_ONE);
  Surface s{{p[6], p[7], p[8]}, note[0], note[1], note[2] != 0};
  bool mirrored = reflect(row_of(f.scattering, s.row), s, share, part, chance(HEIGHT), chance(AROUND), ray.direction,
                          ray.energy);
  ray.recorded = !(mirrored && s.unmirrored);
  return ray;
}

INLINE Operands world_of(const World& w) {
  return {w.node, w.triangle, w.material_mask, nullptr, nullptr, nullptr, w.fixed, w.moving, w.box, int(w.root),
          int(w.num_moving), int(w.nodes), int(w.triangles), int(w.materials), int(w.instances)};
}

// Traces the next segment of all rays
extern "C" __global__ void __launch_bounds__(BLOCK, TRACING_BLOCKS) trace_segments(const Flights f) {
  Word slot = Word(blockIdx.x) * BLOCK + threadIdx.x;
  int flight = slot < f.rays ? f.flight[slot] : 0;
  bool flies = slot < f.rays && f.bounce < f.limit[flight];
  Word number = slot - f.first[flight];
  Flyer ray{};
  if (flies) ray = next_ray(f, flight, number, f.bounce);
  bool alive = flies && total(ray.energy) > 0;
  Best hit{0, -1, -1, 0, 0, 1, false};
  if (warp_ballot(alive)) {
    const Point &o = ray.origin, &d = ray.direction;
    hit = cast<false>(world_of(f), alive, Ray{o.x, o.y, o.z, d.x, d.y, d.z, 0, -1, SOUND}, MAX_RAY_LENGTH);
  }
  Surface s{{0, 0, 1}, 0, ray.room, false};
  Tally tally{};
  if (alive) s = meet(f, flight, number, ray, hit, tally);
  add_by_warp(f.path_length, alive, tally.before, tally.flown, COARSE);
  add_by_warp(f.path_length, alive, tally.after, tally.flown, COARSE);
  add_by_warp(f.absorbed, alive, tally.after, tally.lost, COARSE);
  if (!flies) return;
  Word row = (f.bounce & 1) * f.rays + slot;
  float* p = f.place + PLACE * row;
  p[0] = ray.origin.x, p[1] = ray.origin.y, p[2] = ray.origin.z;
  p[3] = ray.direction.x, p[4] = ray.direction.y, p[5] = ray.direction.z;
  p[6] = s.normal.x, p[7] = s.normal.y, p[8] = s.normal.z, p[9] = ray.travelled;
  store(f.energy + LANES * row, ray.energy);
  int* note = f.notes + NOTES * row;
  note[0] = s.row, note[1] = s.seen, note[2] = s.unmirrored, note[3] = ray.room;
}

// Range of a flight's rays of a thread
struct Part {
  Word first, end;
};

INLINE Part part_of(Word count) {
  Word each = (count + TEAM - 1) / TEAM;
  return {min(each * threadIdx.x, count), min(each * (threadIdx.x + 1), count)};
}

// Adds the energies of a flight's rays to `room`, per room and octave
INLINE void sum_rooms(const Flights& f, Word first, Word count, Sum* room) {
  Part part = part_of(count);
  Octaves sum{};
  int here = -1;
  for (Word i = part.first; i < part.end; ++i) {
    int at = f.notes[NOTES * (first + i) + 3];
    if (at != here && here >= 0) {
      add(room, here, sum, FINE);
      sum = {};
    }
    here = at;
    Octaves e = load(f.energy + LANES * (first + i));
    for (int b = 0; b < OCTAVES; ++b) sum.x[b] += e.x[b];
  }
  if (here >= 0) add(room, here, sum, FINE);
}

// Weighs the rays of a flight (a block) after bounce `bounce`, or before the first one: -1. Decides whether it goes on.
extern "C" __global__ void __launch_bounds__(TEAM) resample_flights(const Flights f) {
  extern __shared__ Sum room[];  // (rooms, OCTAVES)
  __shared__ double part_sum[TEAM];
  int flight = blockIdx.x;
  Word start = f.first[flight], count = f.first[flight + 1] - start, first = (f.bounce & 1) * f.rays + start;
  if (count == 0 || (f.bounce >= 0 && f.bounce >= f.limit[flight])) return;
  for (Word i = threadIdx.x; i < f.rooms * OCTAVES; i += TEAM) room[i] = 0;
  __syncthreads();
  sum_rooms(f, first, count, room);
  __syncthreads();
  float* balance = f.balance + 2 * LANES * Word(flight);
  if (threadIdx.x == 0) {
    bool active = false;
    for (int b = 0; b < OCTAVES; ++b) {
      Word all = 0;
      double even = 0;
      for (Word r = 0; r < f.rooms; ++r) {
        Word here = Word(room[r * OCTAVES + b]);
        all += here;
        if (here > 0) even += powf(float(here) / FINE, 1 - EVENNESS);
      }
      for (Word r = 0; r < f.rooms; ++r) {
        Word here = Word(room[r * OCTAVES + b]);
        float factor = here > 0 ? float(powf(float(here) / FINE, -EVENNESS) / even) : 0;
        f.factor[(flight * f.rooms + r) * LANES + b] = factor;
      }
      balance[b] = float(all) / FINE;
      if (f.bounce < 0) balance[LANES + b] = balance[b];
      float aged = float(Word(f.aged[flight * LANES + b])) / FINE;
      active |= balance[b] > fmaxf(MAX_ACTIVE_SHARE * aged, MIN_ENERGY_SHARE * balance[LANES + b]);
    }
    if (!active) f.limit[flight] = int(f.bounce + 1);
  }
  __syncthreads();
  Part part = part_of(count);
  double sum = 0;
  Octaves share;
  for (Word i = part.first; i < part.end; ++i)
    sum += weight_of(f, flight, load(f.energy + LANES * (first + i)), f.notes[NOTES * (first + i) + 3], share);
  part_sum[threadIdx.x] = sum;
  for (int step = 1; step < TEAM; step *= 2) {
    __syncthreads();
    double before = threadIdx.x >= step ? part_sum[threadIdx.x - step] : 0;
    __syncthreads();
    part_sum[threadIdx.x] += before;
  }
  __syncthreads();
  sum = threadIdx.x > 0 ? part_sum[threadIdx.x - 1] : 0;
  for (Word i = part.first; i < part.end; ++i) {
    sum += weight_of(f, flight, load(f.energy + LANES * (first + i)), f.notes[NOTES * (first + i) + 3], share);
    f.reached[start + i] = sum;
  }
}

// Counts the energy that is left after the last bounce as aged
extern "C" __global__ void __launch_bounds__(BLOCK) finish_flights(const Flights f) {
  Word slot = Word(blockIdx.x) * BLOCK + threadIdx.x;
  if (slot >= f.rays) return;
  int flight = f.flight[slot];
  Word number = slot - f.first[flight], bounce = f.limit[flight];
  Flyer ray = next_ray(f, flight, number, bounce);
  if (!(total(ray.energy) > 0)) return;
  float when = ray.travelled / float(f.bin_length);
  add_portal(f, flight, ray.room, ray.room, when, ray.energy);
  keep(f, flight, number, ray, ray.energy, (when - floorf(when)) * float(f.bin_length), ray.room, ray.room, bounce);
}

// Tests whether segments between points are obstructed
struct Segments : World {
  const float *start, *way;  // (count, 3)
  unsigned char* found;
  Word count;
};

extern "C" __global__ void __launch_bounds__(BLOCK) test_segments(const Segments s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x;
  bool alive = i < s.count;
  Ray ray{0, 0, 0, 0, 0, 1, 0, -1, SOUND};
  if (alive) {
    const float *o = s.start + 3 * i, *d = s.way + 3 * i;
    ray = {o[0], o[1], o[2], d[0], d[1], d[2], 0, -1, SOUND};
  }
  alive = alive && is_finite(ray);
  Best hit = cast<true>(world_of(s), alive, ray, 1);
  if (i < s.count) s.found[i] = alive && hit.instance >= 0;
}

// Converts sums of integers to energies: times unit (flights, lanes), and for cells times density (cells,)
struct Scaling {
  const Sum* sums;
  float* out;
  const float *unit, *density;
  Word count, each, lanes, inner;  // values, those of a flight, of a row, of a cell; inner 0: no density
  double scale;
};

extern "C" __global__ void __launch_bounds__(BLOCK) scale_sums(const Scaling s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x;
  if (i >= s.count) return;
  float value = float(double(Word(s.sums[i])) * s.scale) * s.unit[i / s.each * s.lanes + i % s.lanes];
  s.out[i] = s.inner ? value * s.density[i % s.each / s.inner] : value;
}
