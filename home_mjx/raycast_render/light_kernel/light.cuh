// Light at surfaces: baked texels and probes, and rays to lamps and the sun; counterpart of light.py.

constexpr float PROBE_OFFSET = 0.05f, VIEW_OFFSET = 0.25f, FACADE_GAP = 0.15f, DEPTH = 0.3f;
constexpr float MIN_FACING = 0.02f, FACING_RISE = 5.0f;
constexpr float BIAS = 5e-4f, RAY_END = 0.05f, NEAREST = 0.6f, LEAST_SQUARE = 1e-4f, OWN_SHARE = 0.7f;
constexpr float LEAST_COSINE = 1e-6f, GRAZING = 1e-3f, LEAST_SPECULAR = 0.02f;
constexpr float PI = 3.14159265f, INVERSE_PI = 0.318309886f, ZENITH_UP = 2.51327412f, ZENITH_LEVEL = 0.9585f;
constexpr int ARCHITECTURE = 0;
// Columns of the tables of lights, and of the vector of the sky, the sun and the edge of a navigation cell
constexpr int POS = 0, AXIS = 3, INTENSITY = 6, POWER = 9, EXPONENT = 10, CUTOFF = 11, AREA = 12, LIGHT_COLUMNS = 13;
constexpr int CARRIER = 0, OBJECT = 1, LIGHT_IDS = 2;
constexpr int SKY_ZENITH = 0, SKY_HORIZON = 3, SKY_GROUND = 6, AMBIENT = 9, SUN_AIM = 10, SUN_COLOR = 13, CELL = 16;

// One house's baked light and navigation grid
struct Bake {
  const float *__restrict__ probe, *__restrict__ texel;  // mixed light from the house's first row on
  const unsigned *__restrict__ probe_bits, *__restrict__ texel_bits;  // the same, packed
  const int *__restrict__ first, *__restrict__ count, *__restrict__ chart_start, *__restrict__ chart,
      *__restrict__ chart_count, *__restrict__ chart_first, *__restrict__ instance_model,
      *__restrict__ model_triangle, *__restrict__ grid;
  const float *__restrict__ origin, *__restrict__ step, *__restrict__ chart_frame, *__restrict__ floor,
      *__restrict__ corner;
  int packed, probes, texels, rooms, charted, triangles, charts, models, levels, lines, columns;
  float cell;  // [m]
};

struct Lamps {
  const float *__restrict__ table, *__restrict__ sky;
  const int *__restrict__ ids, *__restrict__ by_room, *__restrict__ by_instance;
  int lights, rooms, keys, instances;
};

// A ray to a lamp or the sun, and the radiance that it brings if nothing blocks it; no ray if `reach` is negative
struct ShadowRay {
  float3 way, light;
  float reach;
  int exclude;
};

INLINE int room_at(const Bake& bake, float3 pos) {
  int level = -1;
  for (int i = 0; i < bake.levels; ++i) level += pos.z > __ldg(bake.floor + i) - DEPTH;
  float x = floorf((pos.x - __ldg(bake.corner)) / bake.cell), y = floorf((pos.y - __ldg(bake.corner + 1)) / bake.cell);
  if (level < 0 || !(x >= 0 && y >= 0 && x < bake.columns && y < bake.lines)) return -1;
  return __ldg(bake.grid + (level * bake.lines + int(y)) * bake.columns + int(x));
}

INLINE bool is_beyond(float pos, float normal, float low, float step, int count) {
  float high = low + step * (count - 1);
  return (pos > high + FACADE_GAP && normal > 0.5f) || (pos < low - FACADE_GAP && normal < -0.5f);
}

// Returns the room whose probes light a point; -1 outdoors
INLINE int find_room(const Bake& bake, const Point& point) {
  int room = point.room;
  if (room < 0 || point.moves) room = room_at(bake, point.pos + point.view * VIEW_OFFSET);
  if (room < 0) return -1;
  room = min(room, bake.rooms - 1);
  float3 low = load3(bake.origin + 3 * room), step = load3(bake.step + 3 * room);
  const int* count = bake.count + 3 * room;
  bool facade = is_beyond(point.pos.x, point.normal.x, low.x, step.x, __ldg(count)) ||
                is_beyond(point.pos.y, point.normal.y, low.y, step.y, __ldg(count + 1)) ||
                is_beyond(point.pos.z, point.normal.z, low.z, step.z, __ldg(count + 2));
  return facade ? -1 : room;
}

// Returns the chart of a hit face; -1 for backs, faces without one and moving instances
INLINE int find_chart(const Bake& bake, const Hit& hit) {
  if (!hit.front || hit.instance >= bake.charted) return -1;
  int start = __ldg(bake.chart_start + hit.instance);
  if (start < 0) return -1;
  int model = clip(__ldg(bake.instance_model + hit.instance), bake.models);
  return min(__ldg(bake.chart + clip(start - __ldg(bake.model_triangle + model) + hit.triangle, bake.triangles)),
             bake.charts - 1);
}

INLINE float3 unpack(unsigned bits) {
  float scale = __int_as_float((int(bits >> 27) - 24 + 127) << 23);
  return make_float3(float(bits & 511), float(bits >> 9 & 511), float(bits >> 18 & 511)) * scale;
}

INLINE float3 color_at(const float* table, const unsigned* bits, bool packed, int row) {
  return packed ? unpack(__ldg(bits + row)) : load3(table + 3ll * row);
}

// Splits a place among `count` points in a row into an index and the share of the next one
INLINE int split(float place, int count, float& share) {
  place = fminf(fmaxf(place, 0.0f), float(count - 1));
  int low = min(int(place), count - 2);
  share = place - low;
  return low;
}

// Returns the irradiance [W/m^2] of a chart at a point, between four texels
INLINE float3 texel_light(const Bake& bake, float3 pos, int chart) {
  const float* frame = bake.chart_frame + 9ll * chart;
  float3 offset = pos - load3(frame);
  int first = max(__ldg(bake.chart_count + 2 * chart), 2), second = max(__ldg(bake.chart_count + 2 * chart + 1), 2);
  float u, v;
  int i = split(dot(offset, load3(frame + 3)), first, u), j = split(dot(offset, load3(frame + 6)), second, v);
  int cell = __ldg(bake.chart_first + chart) + i * second + j;
  float3 light = make_float3(0, 0, 0);
  for (int corner = 0; corner < 4; ++corner) {
    int a = corner & 1, b = corner >> 1;
    float weight = (a ? u : 1 - u) * (b ? v : 1 - v);
    int row = clip(cell + a * second + b, bake.texels);
    light = light + color_at(bake.texel, bake.texel_bits, bake.packed, row) * weight;
  }
  return light;
}

// Returns the sky's irradiance on a normal whose vertical part is `up`, without obstacles
INLINE float3 open_light(const float* sky, float up) {
  float high = ZENITH_LEVEL + up * (ZENITH_UP / 2) + up * up * (ZENITH_UP / 2 - ZENITH_LEVEL);
  float side = PI * (1 + up) / 2 - high, below = PI * (1 - up) / 2;
  return load3(sky + SKY_ZENITH) * high + load3(sky + SKY_HORIZON) * side + load3(sky + SKY_GROUND) * below;
}

// Returns the irradiance [W/m^2] of probes on a point; outdoors of the open sky
INLINE float3 probe_light(const Bake& bake, const float* sky, const Point& point, int room) {
  if (room < 0) return open_light(sky, point.shading.z);
  int first = __ldg(bake.first + room);
  float3 light = make_float3(0, 0, 0), n = point.shading;
  if (first < 0) return light;
  float3 step = load3(bake.step + 3 * room), place = point.pos + n * PROBE_OFFSET - load3(bake.origin + 3 * room);
  const int* counts = bake.count + 3 * room;
  int nx = max(__ldg(counts), 2), ny = max(__ldg(counts + 1), 2), nz = max(__ldg(counts + 2), 2);
  float u, v, w;
  int i = split(place.x / step.x, nx, u), j = split(place.y / step.y, ny, v), k = split(place.z / step.z, nz, w);
  int cell = first + (i * ny + j) * nz + k;
  int fx = n.x < 0 ? 1 : 0, fy = n.y < 0 ? 3 : 2, fz = n.z < 0 ? 5 : 4;
  float3 rise = make_float3(n.x * step.x, n.y * step.y, n.z * step.z);
  float low = PROBE_OFFSET - (rise.x * u + rise.y * v + rise.z * w), total = 0;  // of the first probe above the plane
  for (int corner = 0; corner < 8; ++corner) {
    int a = corner & 1, b = corner >> 1 & 1, d = corner >> 2;
    float above = low + (a ? rise.x : 0) + (b ? rise.y : 0) + (d ? rise.z : 0);
    float weight = fminf(fmaxf(0.5f + above * FACING_RISE, MIN_FACING), 1.0f);
    weight *= (a ? u : 1 - u) * (b ? v : 1 - v) * (d ? w : 1 - w);
    total += weight;
    int row = 6 * clip(cell + (a * ny + b) * nz + d, bake.probes);
    light = light + color_at(bake.probe, bake.probe_bits, bake.packed, row + fx) * (weight * n.x * n.x);
    light = light + color_at(bake.probe, bake.probe_bits, bake.packed, row + fy) * (weight * n.y * n.y);
    light = light + color_at(bake.probe, bake.probe_bits, bake.packed, row + fz) * (weight * n.z * n.z);
  }
  return light * (1 / total);
}

// Returns the sky's radiance [W/m^2/sr] along a direction; below horizontal, the bare ground's
INLINE float3 sky_light(const float* sky, float3 direction) {
  float up = direction.z * inverse_norm(direction);
  if (!(up >= 0)) return load3(sky + SKY_GROUND);
  float3 horizon = load3(sky + SKY_HORIZON);
  return horizon + (load3(sky + SKY_ZENITH) - horizon) * sqrtf(fminf(up, 1.0f));
}

// Lamps and the sun -----------------------------------------------------------------------------------------------------

// Finds the two lamps of a point, see `lights.key_lamps`; -1 none
INLINE int2 choose_lamps(const Lamps& lamps, const Point& point, int room) {
  const int* keys = lamps.by_room + lamps.keys * clip(room + 1, lamps.rooms);
  int2 chosen = make_int2(__ldg(keys), lamps.keys > 1 ? __ldg(keys + 1) : -1);
  if (point.instance < lamps.instances) {
    for (int i = 0; i < 2; ++i) {
      int own = __ldg(lamps.by_instance + 2 * point.instance + i);
      if (own >= 0 && own != chosen.x) chosen = make_int2(own, chosen.x);
    }
  }
  return chosen;
}

// Returns the cosine between the shading normal and a unit direction; 0 behind that or the geometric normal
INLINE float surface_cosine(const Point& point, float3 toward) {
  return dot(toward, point.normal) > 0 ? fmaxf(dot(toward, point.shading), 0.0f) : 0;
}

// Returns the share of a light's intensity at a cosine to its axis; 0 below the cutoff
INLINE float profile(float cosine, float exponent, float cutoff) {
  if (!(cosine >= cutoff)) return 0;
  if (exponent == 0) return 1;
  cosine = fmaxf(cosine, LEAST_COSINE);
  return exponent == 1 ? cosine : __powf(cosine, exponent);
}

// Returns the specular BRDF [1/sr] over the reflectance at normal incidence, see `gloss.ggx`
INLINE float highlight(const Point& point, float edge, float alpha, float3 toward) {
  float3 half = toward + point.view;
  half = half * inverse_norm(half);
  float up = fminf(fmaxf(dot(half, point.shading), 0.0f), 1.0f);
  float light = fminf(fmaxf(dot(toward, point.shading), GRAZING), 1.0f);
  float view = fminf(fmaxf(dot(point.view, point.shading), GRAZING), 1.0f);
  float spread = 1 - up * up * (1 - alpha * alpha), both = 2 * light * view;
  float flat = 1 - fminf(fmaxf(dot(half, toward), 0.0f), 1.0f), square = flat * flat;
  float fresnel = 1 + (edge - 1) * (square * square * flat);
  return alpha * alpha / (PI * spread * spread) * (0.5f / (both + alpha * (light + view - both))) * fresnel;
}

// Returns the radiance of light `color` that arrives at a point in a share of `diffuse`
INLINE float3 reflected(const Tables& tables, const Point& point, float3 color, float diffuse, float3 toward) {
  float3 specular = load3(tables.specular + 3 * point.row);
  float edge = 1 / fmaxf(fmaxf(fmaxf(specular.x, specular.y), specular.z), LEAST_SPECULAR);
  float alpha = sqrtf(2 / (__ldg(tables.shininess + point.row) + 2));
  float gloss = diffuse * highlight(point, edge, alpha, toward);
  return color * (point.color * (diffuse * INVERSE_PI) + specular * gloss);
}

INLINE ShadowRay no_ray() { return {make_float3(0, 0, 0), make_float3(0, 0, 0), -1, -1}; }

// Returns the ray to the lamp in a row of the table
INLINE ShadowRay lamp_ray(const Lamps& lamps, const Tables& tables, const Point& point, int row) {
  ShadowRay ray = no_ray();
  row = min(row, lamps.lights - 1);
  const float* t = lamps.table + LIGHT_COLUMNS * row;
  const int* ids = lamps.ids + LIGHT_IDS * row;
  float3 offset = load3(t + POS) - point.pos;
  float area = __ldg(t + AREA);
  int carrier = __ldg(ids + CARRIER);
  bool own = carrier == point.instance && carrier != ARCHITECTURE && area == 0;
  float square = fmaxf(dot(offset, offset), own ? NEAREST * NEAREST : LEAST_SQUARE);
  float3 toward = offset * inverse_norm(offset);
  float share = OWN_SHARE;
  if (!own) {
    share = profile(-dot(toward, load3(t + AXIS)), __ldg(t + EXPONENT), __ldg(t + CUTOFF));
    share *= surface_cosine(point, toward);
  }
  share /= square + area * INVERSE_PI;
  if (!(share > 0 && __ldg(t + POWER) > 0)) return ray;
  ray.way = offset - point.normal * BIAS;
  ray.light = reflected(tables, point, load3(t + INTENSITY), share, toward);
  ray.exclude = __ldg(ids + OBJECT);
  if (!own) ray.reach = 1 - RAY_END * fminf(inverse_norm(ray.way), 1 / RAY_END);
  return ray;
}

INLINE ShadowRay sun_ray(const Lamps& lamps, const Tables& tables, const Point& point) {
  ShadowRay ray = no_ray();
  ray.way = load3(lamps.sky + SUN_AIM);
  float cosine = surface_cosine(point, ray.way);
  if (!(cosine > 0)) return ray;
  ray.light = reflected(tables, point, load3(lamps.sky + SUN_COLOR), cosine, ray.way);
  ray.reach = INF;
  return ray;
}
