// Radiance along camera rays from their first hits on: glass and mirrors, surfaces, lamps and the sun with their
// shadows, in one kernel, a pixel per thread. It follows cast.cu, whose rays it casts, surface.cuh and light.cuh.
//
// Counterpart of shaders/lit.py. Warps stay together until all of their rays are cast, since `cast` needs whole warps.

#ifndef LIGHT_BLOCKS_PER_SM
#define LIGHT_BLOCKS_PER_SM 12  // limits the compiler to 80 registers
#endif

constexpr int LIGHT = 2;            // bit of ray kinds, as in schema/compiled.py
constexpr float HIT_EPSILON = 1e-4f;  // [m], as in specular.py
constexpr float GLOW_RED = 0.64f, GLOW_GREEN = 0.72f, GLOW_BLUE = 0.8f;  // [W/m^2/sr], of surfaces with glow 1

// Numbers of `size`, as in cuda.py. The first five and the two of cut-outs are read as cast.cu reads its own.
enum Size {
  ENVIRONMENTS, RAYS_EACH, INSTANCES, NUM_MOVING, WIDTH, NODES, TRIANGLES, MATERIALS, HOUSES, CUTOUT_LAYERS, CUTOUT_EDGE,
  SEMANTIC_ROWS, SEMANTIC_COLUMNS, ROOM_COLUMN, GLASS_KIND, TEXTURE_LAYERS, LAYER_TEXELS, TEXTURE_EDGE, PROBES, TEXELS,
  ROOMS, CHARTED, CHART_TRIANGLES, CHARTS, MODELS, LEVELS, LINES, COLUMNS, SLOTS, LIGHTS, LAMP_ROOMS, KEYS,
  LAMP_INSTANCES, GLOWING, EMITTING, DEPTH_LIMIT, NUM_LAMPS, HAS_SUN, TEXELS_HAVE_LAMPS, TEXELS_HAVE_SUN, IS_PACKED, NUM_SIZES
};

// State of a camera ray: its last segment, the hit at its end, and the throughput of glass and mirrors
struct Path {
  float3 origin, direction, throughput;
  float footprint;  // [m], at the origin of the last segment
  Hit hit;
};

// Continues rays of a warp at glass and mirrors; returns false if none does
INLINE bool extend(const Operands& world, const Tables& tables, const Episode& episode, const int* size, int exclude,
                   bool alive, Path& path) {
  bool on = false, mirror = false;
  if (alive && path.hit.instance >= 0) {
    const float4* record = record_of(world, slot_of(episode, path.hit.instance), path.hit.instance);
    int row = material_row(world, record, path.hit.triangle);
    float4 albedo = __ldg(tables.albedo + row);
    mirror = __ldg(tables.mirror + row) != 0;
    on = mirror || (__ldg(tables.kind + row) == __ldg(size + GLASS_KIND) && albedo.w < 1);
    if (on) {
      float3 end = path.origin + path.direction * path.hit.t, tint = xyz(albedo);
      if (mirror) {
        float3 normal = area_vector(world, turn_of(record), path.hit.triangle, path.direction);
        normal = normal * inverse_norm(normal);
        path.direction = path.direction - normal * (2 * dot(path.direction, normal));
        end = end + normal * HIT_EPSILON;
      } else {
        float3 white = make_float3(1, 1, 1);
        tint = white - (white - tint) * albedo.w;
      }
      path.origin = end;
      path.throughput = path.throughput * tint;
      path.footprint += episode.growth * path.hit.t;
    }
  }
  if (!warp_ballot(on)) return false;
  Ray ray{path.origin.x,    path.origin.y,    path.origin.z, path.direction.x,
          path.direction.y, path.direction.z, 0,             mirror ? -1 : exclude,
          LIGHT};
  Best best = cast<false>(world, on && is_finite(ray), ray, INF);
  if (on) {
    path.hit = {best.t, best.instance, best.triangle, __fdiv_rn(best.u, best.total), __fdiv_rn(best.v, best.total),
                best.front};
  }
  return true;
}

// Returns whether something blocks a shadow ray; all threads of a warp must call it.
INLINE bool is_blocked(const Operands& world, const Point& point, const ShadowRay& shadow) {
  bool needed = shadow.reach >= 0;
  if (!warp_ballot(needed)) return false;
  float3 start = point.pos + point.normal * BIAS;
  Ray ray{start.x, start.y, start.z, shadow.way.x, shadow.way.y, shadow.way.z, 0, shadow.exclude, LIGHT};
  return cast<true>(world, needed && is_finite(ray), ray, shadow.reach).instance >= 0;
}

// Operands in the order of cuda.py
#define LIGHT_OPERANDS                                                                                                \
  const float4 *node, const float4 *corner, const int *material_mask, const float *uv, const unsigned *cutout,       \
      const float4 *fixed, const int *house_root, const float *normal, const int *part,                               \
      const int *instance_semantic, const int *semantics, const float4 *albedo, const float *specular,               \
      const float *shininess, const int *texture, const unsigned *textures, const int *kind, const int *mirror,      \
      const int *instance_model, const int *model_triangle, const int *grid, const float *floor,                     \
      const float *grid_corner, const int *first, const float *probe_origin, const float *probe_step,                \
      const int *probe_count, const int *chart_start, const int *chart, const float *chart_frame,                    \
      const int *chart_count, const int *chart_first, const void *probe, const void *texel, const int *house,        \
      const float4 *moving, const float2 *box, const int *moving_slot, const int *moving_semantic,                   \
      const float *look, const int *look_ids, const float *lights, const int *light_ids, const int *by_room,         \
      const int *by_instance, const float *sky, const float *growth, const float *glow, const int *glowing,          \
      const float *emission, const int *exclude,                                                                      \
      const float *t, const int *instance, const int *hit_triangle, const float *hit_u, const float *hit_v,          \
      const int *front, const float *origin, const float *direction, const int *size, float *light

extern "C" __global__ void __launch_bounds__(BLOCK, LIGHT_BLOCKS_PER_SM) shade_paths(LIGHT_OPERANDS) {
  int env = blockIdx.y + gridDim.y * blockIdx.z;
  if (env >= __ldg(size)) return;
  int number = ray_of_thread(__ldg(size + RAYS_EACH), __ldg(size + WIDTH)), at = clip(__ldg(house + env), __ldg(size + HOUSES));
  long long row = (long long)env * __ldg(size + RAYS_EACH) + max(number, 0);
  int instances = __ldg(size + INSTANCES), num_moving = __ldg(size + NUM_MOVING), slots = __ldg(size + SLOTS);
  Operands world{node, corner, material_mask, uv, cutout, size + CUTOUT_LAYERS, fixed + 4ll * at * instances,
                 moving + 4ll * env * num_moving, box + 3ll * env * num_moving, __ldg(house_root + at), num_moving,
                 __ldg(size + NODES), __ldg(size + TRIANGLES), __ldg(size + MATERIALS), instances};
  Tables tables{uv, normal, specular, shininess, albedo, part, instance_semantic + (long long)at * instances, semantics,
                texture, kind, mirror, textures, __ldg(size + SEMANTIC_COLUMNS), __ldg(size + SEMANTIC_ROWS),
                __ldg(size + TEXTURE_LAYERS), __ldg(size + LAYER_TEXELS), __ldg(size + TEXTURE_EDGE)};
  Episode episode{moving_slot + (long long)env * slots, moving_semantic + (long long)env * num_moving, slots,
                  __ldg(growth + 2 * env + 1), __ldg(look + 2 * env), __ldg(look + 2 * env + 1),
                  unsigned(__ldg(look_ids + 2 * env)), __ldg(look_ids + 2 * env + 1)};

  bool alive = number >= 0;
  Path path{load3(origin + 3 * row), load3(direction + 3 * row), make_float3(1, 1, 1), __ldg(growth + 2 * env),
            {__ldg(t + row), alive ? __ldg(instance + row) : -1, __ldg(hit_triangle + row), __ldg(hit_u + row),
             __ldg(hit_v + row), __ldg(front + row) != 0}};
  path.hit.triangle = clip(path.hit.triangle, world.triangles);
  for (int event = 0; event < __ldg(size + DEPTH_LIMIT); ++event)
    if (!extend(world, tables, episode, size, __ldg(exclude + env), alive, path)) break;

  bool seen = alive && path.hit.instance >= 0, charted = false;
  const float* above = sky + 17ll * env;
  Lamps lamps{lights + (long long)LIGHT_COLUMNS * env * __ldg(size + LIGHTS), above,
              light_ids + (long long)LIGHT_IDS * env * __ldg(size + LIGHTS),
              by_room + (long long)env * __ldg(size + LAMP_ROOMS) * __ldg(size + KEYS),
              by_instance + 2ll * env * __ldg(size + LAMP_INSTANCES), __ldg(size + LIGHTS), __ldg(size + LAMP_ROOMS),
              __ldg(size + KEYS), __ldg(size + LAMP_INSTANCES)};
  float3 sum = make_float3(0, 0, 0);
  Point point{};
  int2 chosen = make_int2(-1, -1);
  if (seen) {
    point = describe_surface(world, tables, episode, path.origin, path.direction, path.footprint, path.hit,
                             __ldg(size + ROOM_COLUMN));
    bool packed = __ldg(size + IS_PACKED) != 0;
    int probes = __ldg(size + PROBES), texels = __ldg(size + TEXELS), rooms = __ldg(size + ROOMS);
    int charts = __ldg(size + CHARTS), levels = __ldg(size + LEVELS), cells = __ldg(size + LINES) * __ldg(size + COLUMNS);
    long long own = packed ? env : at;
    Bake bake{(const float*)probe + (packed ? 0 : 18 * own * probes), (const float*)texel + (packed ? 0 : 3 * own * texels),
              (const unsigned*)probe + (packed ? 6 * own * probes : 0), (const unsigned*)texel + (packed ? own * texels : 0),
              first + at * rooms, probe_count + 3 * at * rooms, chart_start + (long long)at * __ldg(size + CHARTED),
              chart + (long long)at * __ldg(size + CHART_TRIANGLES), chart_count + 2ll * at * charts,
              chart_first + (long long)at * charts, instance_model + (long long)at * instances, model_triangle,
              grid + (long long)at * levels * cells, probe_origin + 3 * at * rooms, probe_step + 3 * at * rooms,
              chart_frame + 9ll * at * charts, floor + at * levels, grid_corner + 2 * at, packed, probes, texels, rooms,
              min(__ldg(size + CHARTED), instances), __ldg(size + CHART_TRIANGLES), charts, __ldg(size + MODELS), levels,
              __ldg(size + LINES), __ldg(size + COLUMNS), __ldg(above + CELL)};
    int room = find_room(bake, point), place = charts > 0 && texels > 0 ? find_chart(bake, path.hit) : -1;
    float3 around = place >= 0 ? texel_light(bake, point.pos, place) : probe_light(bake, above, point, room);
    sum = point.color * around * (__ldg(above + AMBIENT) * INVERSE_PI);
    chosen = choose_lamps(lamps, point, room);
    charted = place >= 0;
  }
  bool lamps_open = seen && !(charted && __ldg(size + TEXELS_HAVE_LAMPS));
  bool sun_open = seen && !(charted && __ldg(size + TEXELS_HAVE_SUN));
  int num_lamps = __ldg(size + NUM_LAMPS);
  for (int k = 0, count = num_lamps + __ldg(size + HAS_SUN); k < count; ++k) {
    ShadowRay shadow = no_ray();
    int lamp = k == 0 ? chosen.x : chosen.y;
    if (k < num_lamps) {
      if (lamps_open && lamp >= 0) shadow = lamp_ray(lamps, tables, point, lamp);
    } else if (sun_open) {
      shadow = sun_ray(lamps, tables, point);
    }
    if (!is_blocked(world, point, shadow)) sum = sum + shadow.light;
  }

  if (!alive) return;
  if (!seen) sum = sky_light(above, path.direction);
  if (seen && path.hit.instance < __ldg(size + GLOWING)) {
    float level = __ldg(glow + (long long)env * __ldg(size + GLOWING) + path.hit.instance);
    sum = sum + make_float3(GLOW_RED, GLOW_GREEN, GLOW_BLUE) * level;
  }
  for (int i = 0, count = __ldg(size + EMITTING); seen && i < count; ++i) {
    long long emitter = (long long)env * count + i;
    if (__ldg(glowing + emitter) == point.row) sum = sum + load3(emission + 3 * emitter) * GLOW_BLUE;
  }
  sum = sum * path.throughput;
  light[3 * row] = sum.x, light[3 * row + 1] = sum.y, light[3 * row + 2] = sum.z;
}
