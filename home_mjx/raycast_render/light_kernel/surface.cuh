// Surfaces at hits: frame, material and filtered colour; counterpart of surface.py. It follows cast.cu.

constexpr float TINY_SQUARE = 1e-37f, TINY_VOLUME = 1e-30f, MAX_DENSITY = 1e12f, LEAST_FACING = 0.05f;
constexpr unsigned MULTIPLIER_1 = 0x85EBCA6Bu, MULTIPLIER_2 = 0xC2B2AE35u, GOLDEN = 0x9E3779B1u;
constexpr float UNIT_SCALE = 1.0f / 16777216;
constexpr int RED = 0, GREEN = 1, BLUE = 2, SWAP = 3, LAYER = 4;  // channels of hash_uniform

// Arrays of the bank that describe surfaces, and numbers of rows
struct Tables {
  const float *__restrict__ uv, *__restrict__ normal, *__restrict__ specular, *__restrict__ shininess;
  const float4* __restrict__ albedo;
  const int *__restrict__ part, *__restrict__ instance_semantic, *__restrict__ semantics, *__restrict__ texture,
      *__restrict__ kind, *__restrict__ mirror;
  const unsigned* __restrict__ textures;
  int columns, rows, layers, texels, edge;  // of `semantics`, its rows, textures, texels of a layer, largest level
};

// What differs between environments: moving instances, and overrides of the appearance
struct Episode {
  const int *__restrict__ slot, *__restrict__ semantic;
  int slots;
  float growth;  // of footprints [m] per unit of t
  float tint, swap;
  unsigned seed;
  int last_layer;
};

struct Hit {
  float t;
  int instance, triangle;
  float u, v;
  bool front;
};

// Surface at the end of a ray
struct Point {
  float3 pos, normal, shading, view, color;
  int row, instance, room;
  bool moves;
};

INLINE int clip(int x, int count) { return min(max(x, 0), count - 1); }
INLINE float3 operator+(float3 a, float3 b) { return make_float3(a.x + b.x, a.y + b.y, a.z + b.z); }
INLINE float3 operator-(float3 a, float3 b) { return make_float3(a.x - b.x, a.y - b.y, a.z - b.z); }
INLINE float3 operator*(float3 a, float3 b) { return make_float3(a.x * b.x, a.y * b.y, a.z * b.z); }
INLINE float3 operator*(float3 a, float s) { return make_float3(a.x * s, a.y * s, a.z * s); }
INLINE float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE float3 cross(float3 a, float3 b) {
  return make_float3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
INLINE float inverse_norm(float3 v) { return rsqrtf(fmaxf(dot(v, v), TINY_SQUARE)); }
INLINE float3 xyz(const float4& v) { return make_float3(v.x, v.y, v.z); }
INLINE float3 load3(const float* at) { return make_float3(__ldg(at), __ldg(at + 1), __ldg(at + 2)); }

INLINE int slot_of(const Episode& episode, int instance) {
  return __ldg(episode.slot + min(instance, episode.slots - 1));
}

// Returns the record of an instance, see gpu_geometry.py
INLINE const float4* record_of(const Operands& world, int slot, int instance) {
  if (slot >= 0) return world.moving + 4 * min(slot, world.num_moving - 1);
  return world.fixed + 4 * min(instance, world.instances - 1);
}

INLINE int material_row(const Operands& world, const float4* record, int triangle) {
  int first = __ldg(reinterpret_cast<const int4*>(record + 3)).w;
  return clip(first + __float_as_int(__ldg(world.triangle + 3ll * triangle).w), world.materials);
}

// Matrix that maps cross products of model vectors to the world, by rows
struct Turn {
  float3 x, y, z;
};

INLINE Turn turn_of(const float4* record) {
  float3 x = xyz(__ldg(record)), y = xyz(__ldg(record + 1)), z = xyz(__ldg(record + 2));
  float volume = 1 / fmaxf(fabsf(dot(x, cross(y, z))), TINY_VOLUME);
  return {x * volume, y * volume, z * volume};
}

INLINE float3 to_world(const Turn& turn, float3 v) { return turn.x * v.x + turn.y * v.y + turn.z * v.z; }

// Returns the normal of a triangle in the world, as long as twice its area [m^2], facing the ray
INLINE float3 area_vector(const Operands& world, const Turn& turn, int triangle, float3 direction) {
  const float4* at = world.triangle + 3ll * triangle;
  float3 a = xyz(__ldg(at)), b = xyz(__ldg(at + 1)), c = xyz(__ldg(at + 2));
  float3 area = to_world(turn, cross(b - a, c - a));
  return dot(area, direction) > 0 ? area * -1 : area;
}

// Returns the unit smooth normal on the side of the area vector, which replaces missing ones
INLINE float3 smooth_normal(const Tables& tables, const Turn& turn, const Hit& hit, float3 area) {
  const float* at = tables.normal + 9ll * hit.triangle;
  float3 local = load3(at) * (1 - hit.u - hit.v) + load3(at + 3) * hit.u + load3(at + 6) * hit.v;
  float3 smooth = to_world(turn, local);
  float side = dot(smooth, area) < 0 ? -1 : 1;
  if (!(dot(smooth, smooth) > 0)) smooth = area, side = 1;
  return smooth * (side * inverse_norm(smooth));
}

// Textures -------------------------------------------------------------------------------------------------------------

// Returns the linear light of the lowest byte, in sRGB
INLINE float decode(unsigned packed) {
  float x = float(packed & 255) * (1.0f / 255);
  return x <= 0.04045f ? x * (1 / 12.92f) : __powf((x + 0.055f) * (1 / 1.055f), 2.4f);
}

INLINE float3 decode3(unsigned packed) { return make_float3(decode(packed), decode(packed >> 8), decode(packed >> 16)); }

// Interpolates between the four nearest texels of a mip level, with wrap-around
INLINE float3 bilinear(const Tables& tables, int layer, float u, float v, int level) {
  int edge = tables.edge, size = edge >> level;
  long long start = (long long)layer * tables.texels + (edge * edge - size * size) * 4ll / 3;
  float column = (u - floorf(u)) * size - 0.5f, line = (1 - (v - floorf(v))) * size - 0.5f;
  float left = floorf(column), top = floorf(line), right_share = column - left, low_share = line - top;
  int x0 = int(left) & (size - 1), y0 = int(top) & (size - 1), x1 = (x0 + 1) & (size - 1), y1 = (y0 + 1) & (size - 1);
  const unsigned* t = tables.textures + start;
  unsigned a = __ldg(t + y0 * size + x0), b = __ldg(t + y0 * size + x1);
  unsigned c = __ldg(t + y1 * size + x0), d = __ldg(t + y1 * size + x1);
  float3 upper = decode3(a) * (1 - right_share) + decode3(b) * right_share;
  float3 lower = decode3(c) * (1 - right_share) + decode3(d) * right_share;
  return upper * (1 - low_share) + lower * low_share;
}

// Interpolates between texels and mip levels of a repeating texture; returns linear light
INLINE float3 trilinear(const Tables& tables, int layer, float u, float v, float level) {
  int last = 31 - __clz(tables.edge);
  level = fminf(fmaxf(level, 0.0f), float(last));
  int low = int(level);
  float share = level - low;
  float3 color = bilinear(tables, layer, u, v, low);
  if (share > 0) color = color + (bilinear(tables, layer, u, v, min(low + 1, last)) - color) * share;
  return color;
}

INLINE unsigned mix_bits(unsigned x) {
  x = (x ^ (x >> 16)) * MULTIPLIER_1;
  x = (x ^ (x >> 13)) * MULTIPLIER_2;
  return x ^ (x >> 16);
}

INLINE float hash_uniform(unsigned seed, int row, int what) {
  return float(mix_bits(mix_bits(unsigned(row) * GOLDEN + unsigned(what)) ^ seed) >> 8) * UNIT_SCALE;
}

// Scales a channel by the random factor of a material row, clipped to [0, 1]
INLINE float tinted(const Episode& episode, int row, int channel, float color) {
  float factor = 1 + episode.tint * (2 * hash_uniform(episode.seed, row, channel) - 1);
  return fminf(fmaxf(color * factor, 0.0f), 1.0f);
}

// Returns the texture layer of a material row, or by chance a random one; -1 none
INLINE int swapped_layer(const Tables& tables, const Episode& episode, int row) {
  int layer = __ldg(tables.texture + row);
  if (layer < 0 || !(episode.swap > 0) || hash_uniform(episode.seed, row, SWAP) >= episode.swap) return layer;
  int count = episode.last_layer + 1;
  return min(int(hash_uniform(episode.seed, row, LAYER) * count), count - 1);
}

// Returns the material's colour times its texture, filtered over a footprint; `density` is that per area
INLINE float3 filtered_color(const Tables& tables, const Episode& episode, const Hit& hit, int row, float density) {
  float3 color = xyz(__ldg(tables.albedo + row));
  if (episode.tint > 0) {
    color = make_float3(tinted(episode, row, RED, color.x), tinted(episode, row, GREEN, color.y),
                        tinted(episode, row, BLUE, color.z));
  }
  int layer = min(swapped_layer(tables, episode, row), tables.layers - 1);
  if (layer < 0) return color;
  const float* c = tables.uv + 6ll * hit.triangle;
  float u0 = __ldg(c), v0 = __ldg(c + 1), u1 = __ldg(c + 2), v1 = __ldg(c + 3), u2 = __ldg(c + 4), v2 = __ldg(c + 5);
  float area = fabsf((u1 - u0) * (v2 - v0) - (v1 - v0) * (u2 - u0));
  float level = 0.5f * log2f(fmaxf(density * area * float(tables.edge) * float(tables.edge), 1e-20f));
  float w = 1 - hit.u - hit.v;
  return color * trilinear(tables, layer, u0 * w + u1 * hit.u + u2 * hit.v, v0 * w + v1 * hit.u + v2 * hit.v, level);
}

// Returns the surface at a hit, whose instance is not negative, at the end of a ray
INLINE Point describe_surface(const Operands& world, const Tables& tables, const Episode& episode, float3 origin,
                              float3 direction, float footprint, const Hit& hit, int room_column) {
  Point point;
  int slot = slot_of(episode, hit.instance), instance = min(hit.instance, world.instances - 1);
  const float4* record = record_of(world, slot, hit.instance);
  Turn turn = turn_of(record);
  float3 area = area_vector(world, turn, hit.triangle, direction);
  float per = inverse_norm(area), inverse_length = inverse_norm(direction);
  float width = footprint + episode.growth * hit.t;
  float size = width * width / fmaxf(fabsf(dot(area, direction)) * per * inverse_length, LEAST_FACING);
  point.row = material_row(world, record, hit.triangle);
  point.pos = origin + direction * hit.t;
  point.normal = area * per;
  point.shading = smooth_normal(tables, turn, hit, area);
  point.view = direction * -inverse_length;
  point.color = filtered_color(tables, episode, hit, point.row, size * fminf(per, MAX_DENSITY));
  point.instance = hit.instance;
  point.moves = slot >= 0;
  int first = slot >= 0 ? __ldg(episode.semantic + min(slot, world.num_moving - 1)) : __ldg(tables.instance_semantic + instance);
  int row = clip(first + __ldg(tables.part + hit.triangle), tables.rows);
  point.room = __ldg(tables.semantics + (long long)row * tables.columns + room_column);
  return point;
}
