// Kernels of the `cuda` backend: two-level traversal, one ray per thread. nvrtc.py compiles them at run time.
//
// Counterpart of xla.py and numba/. Triangle tests round as theirs do, so that all three return the same hits. Box
// tests round differently, which does not change any hit.
//
// Every index read from an array is clipped to its rows, and children must follow their parents. Invalid trees may be
// cut short, but cannot cause reads outside of the arrays or endless loops. This costs two comparisons in the inner
// loop, and no register, branch or address.
//
// Sources: S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013; T. Ize, "Robust BVH
// ray traversal", JCGT 2(2), 2013; T. Aila, S. Laine, "Understanding the efficiency of ray traversal on GPUs", HPG 2009
// (both children's boxes in the parent, the nearer child first, a stack per ray); S. Boulos, I. Wald, P. Shirley,
// "Geometric and arithmetic culling methods for entire ray packets", 2006 (boxes against all rays of a warp).

#define INLINE __device__ __forceinline__

constexpr int BLOCK = 64;          // threads per block, as in cuda.py
constexpr int BLOCKS_PER_SM = 18;  // limits the compiler to 56 registers, since many warps hide memory latency
constexpr int GROUP = 32;          // moving instances that are culled together
constexpr int TILE_WIDTH = 8;      // [px], image tile of a warp
constexpr int TILE_HEIGHT = 4;
constexpr int EMPTY = -1;          // code of an empty leaf; on the stack, the bottom of a tree
constexpr int MAX_DEPTH = 32;      // maximum depth of a tree, as in bvh.py
constexpr int STACK = 2 * MAX_DEPTH + 4;  // entries for the deferred nodes of two trees and their bottoms
constexpr int ALL_KINDS = 7;       // bits of all ray kinds, as in schema/compiled.py
constexpr int SOUND = 4;
constexpr int CUTOUT_SHIFT = 8;    // bits of material_mask below the number of the cut-out layer, as in geometry.py
constexpr float MISS = 3e38f;      // as in scene/types.py, like the next two
constexpr float FAR_SLACK = 1 + 6e-7f;
constexpr float TINY = 1e-20f;
#define INF __int_as_float(0x7f800000)

#ifndef WARP_SIZE  // tests define it to compile this file for a CPU, with warps of one thread
constexpr int WARP_SIZE = 32;
constexpr unsigned ALL_LANES = 0xffffffffu;

INLINE float fast_reciprocal(float x) {
  float y;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
  return y;
}

INLINE int reduce_min(int x) {
#if __CUDA_ARCH__ >= 800
  return __reduce_min_sync(ALL_LANES, x);
#else
  for (int step = WARP_SIZE / 2; step > 0; step /= 2) x = min(x, __shfl_xor_sync(ALL_LANES, x, step));
  return x;
#endif
}

// Maps a float's bits to an integer of the same order, which hardware can reduce, and back.
INLINE int in_order(int bits) { return bits ^ ((bits >> 31) & 0x7fffffff); }

INLINE float warp_min(float x) { return __int_as_float(in_order(reduce_min(in_order(__float_as_int(x))))); }

INLINE float warp_max(float x) { return -warp_min(-x); }

INLINE unsigned warp_ballot(bool x) { return __ballot_sync(ALL_LANES, x); }

// Address of an entry of a ray's stack in local memory. It is half as long as a pointer, so that one instruction clips
// it to the end of the stack.
using Place = int;

INLINE Place place_of(int2* entry) { return int(__cvta_generic_to_local(entry)); }

INLINE Place shift(Place place, int entries) { return place + entries * int(sizeof(int2)); }

INLINE void put(Place place, int2 x) {
  asm volatile("st.local.v2.s32 [%0], {%1, %2};" ::"r"(place), "r"(x.x), "r"(x.y) : "memory");
}

INLINE int2 get(Place place) {
  int2 x;
  asm volatile("ld.local.v2.s32 {%0, %1}, [%2];" : "=r"(x.x), "=r"(x.y) : "r"(place) : "memory");
  return x;
}
#endif

// The arrays of gpu_geometry.py, and one environment's part of the arrays of cuda.py
struct Operands {
  const float4* __restrict__ node;      // 4 per node: centre and half size of each child's box, then their codes
  const float4* __restrict__ triangle;  // 3 per triangle: its corners; w of the first is the material slot
  const int* __restrict__ material_mask;
  const float* __restrict__ uv;          // 6 per triangle: texture coordinates of its corners
  const unsigned* __restrict__ cutout;   // a bit per texel, rows of whole words
  const int* __restrict__ texels;        // number of layers and their edge
  const float4* __restrict__ fixed;   // 4 per static instance: rows of its inverse, then root, number, object, material
  const float4* __restrict__ moving;  // the same for moving instances
  const float2* __restrict__ box;     // 3 per moving instance: centre and half size of its world bounds
  int root;                           // root of the tree over the static instances
  int num_moving;
  int nodes, triangles, materials, instances;  // numbers of rows; instances per house
};

struct Ray {
  float ox, oy, oz, dx, dy, dz, t_min;
  int exclude, mask;
};

// A ray prepared for box tests: 1 / direction and origin / direction
struct Slopes {
  float ix, iy, iz, cx, cy, cz;
};

// A ray prepared for triangle tests: its longest axis is swapped with z
struct Shear {
  int axis;
  float ox, oy, oz, dx, dy, iz;
};

struct Best {
  float t;
  int instance, triangle;
  float u, v, total;  // edge functions and their sum; the hit's weights are u / total and v / total
  bool front;
};

// Boxes ----------------------------------------------------------------------------------------------------------

INLINE float reciprocal(float x) { return fast_reciprocal(copysignf(fmaxf(fabsf(x), TINY), x)); }

INLINE Slopes slopes_of(float ox, float oy, float oz, float dx, float dy, float dz) {
  float ix = reciprocal(dx), iy = reciprocal(dy), iz = reciprocal(dz);
  return {ix, iy, iz, ox * ix, oy * iy, oz * iz};
}

INLINE Slopes slopes_of(const Ray& ray) { return slopes_of(ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz); }

// Returns whether a ray hits a box between t_min and limit; writes the entry distance. An empty box has half size -inf.
INLINE bool meets(const Slopes& s, float cx, float cy, float cz, float hx, float hy, float hz, float t_min, float limit,
                  float& near) {
  float x = fmaf(cx, s.ix, -s.cx), y = fmaf(cy, s.iy, -s.cy), z = fmaf(cz, s.iz, -s.cz);
  float ax = fabsf(s.ix), ay = fabsf(s.iy), az = fabsf(s.iz);
  near = fmaxf(fmaxf(fmaf(-hx, ax, x), fmaf(-hy, ay, y)), fmaxf(fmaf(-hz, az, z), t_min));
  float far = fminf(fminf(fmaf(hx, ax, x), fmaf(hy, ay, y)), fmaf(hz, az, z));
  return near <= fminf(far * FAR_SLACK, limit);
}

// Stack of codes, each with its entry distance. One extra entry behind the last absorbs pushes on a full stack, which
// are lost.
struct Stack {
  Place top, end;
};

INLINE void push(Stack& stack, int code, float t) {
  put(stack.top, make_int2(code, __float_as_int(t)));
  stack.top = min(shift(stack.top, 1), stack.end);
}

INLINE void push_bottom(Stack& stack) { push(stack, EMPTY, -INF); }

// Pops the topmost code that the ray enters before its best hit, or the bottom
INLINE int pop(Stack& stack, float limit) {
  int2 entry;
  do {
    entry = get(stack.top = shift(stack.top, -1));
  } while (__int_as_float(entry.y) > limit);
  return entry.x;
}

// Returns the nearer child of a node that the ray hits, or pops the stack
INLINE int descend(const Operands& world, int node, const Slopes& s, float t_min, float limit, Stack& stack) {
  const float4* at = world.node + 4ll * node;
  float4 p = __ldg(at), q = __ldg(at + 1), r = __ldg(at + 2);
  int2 child = __ldg(reinterpret_cast<const int2*>(at + 3));
  float t0, t1;
  bool meets0 = meets(s, p.x, p.y, p.z, p.w, q.x, q.y, t_min, limit, t0);
  bool meets1 = meets(s, q.z, q.w, r.x, r.y, r.z, r.w, t_min, limit, t1);
  // As unsigned numbers, leaf codes are larger than all nodes. Both boxes are tested first: a branch would cost more.
  meets0 &= unsigned(child.x) > unsigned(node);
  meets1 &= unsigned(child.y) > unsigned(node);
  if (!(meets0 | meets1)) return pop(stack, limit);
  if (meets0 & meets1) {
    bool swap = t1 < t0;
    push(stack, swap ? child.x : child.y, swap ? t0 : t1);
    return swap ? child.y : child.x;
  }
  return meets0 ? child.x : child.y;
}

// Triangles ---------------------------------------------------------------------------------------------------------
// The _rn functions prevent fused multiply-adds: both triangles must round the edge function of a shared edge alike.

INLINE Shear shear_of(float ox, float oy, float oz, float dx, float dy, float dz) {
  float x = fabsf(dx), y = fabsf(dy), z = fabsf(dz);
  int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  float longest = axis == 0 ? dx : axis == 1 ? dy : dz;
  return {axis,
          axis == 0 ? oz : ox,
          axis == 1 ? oz : oy,
          axis == 0 ? ox : axis == 1 ? oy : oz,
          axis == 0 ? dz : dx,
          axis == 1 ? dz : dy,
          __fdiv_rn(1, longest)};
}

// Shears a corner so that the ray runs along z through the origin; z is in units of t
INLINE float3 corner_of(const Shear& s, const float4& p) {
  float z = __fmul_rn(__fsub_rn(s.axis == 0 ? p.x : s.axis == 1 ? p.y : p.z, s.oz), s.iz);
  float x = __fsub_rn(__fsub_rn(s.axis == 0 ? p.z : p.x, s.ox), __fmul_rn(s.dx, z));
  float y = __fsub_rn(__fsub_rn(s.axis == 1 ? p.z : p.y, s.oy), __fmul_rn(s.dy, z));
  return make_float3(x, y, z);
}

// Ties go to the lower instance and triangle, so that the order of traversal does not matter.
INLINE bool comes_first(float t, int instance, int triangle, const Best& best) {
  if (t != best.t || best.instance < 0) return t <= best.t;
  return instance == best.instance ? triangle < best.triangle : instance < best.instance;
}

// Returns the texel of a texture coordinate that repeats; 0 for NaN
INLINE int texel_at(const float* uv, float u, float v, int edge) {
  float a = __fmul_rn(__fsub_rn(__fsub_rn(1, u), v), __ldg(uv));
  float x = __fadd_rn(__fadd_rn(a, __fmul_rn(u, __ldg(uv + 2))), __fmul_rn(v, __ldg(uv + 4)));
  float place = __fmul_rn(__fsub_rn(x, floorf(x)), float(edge));
  return place >= 0 ? min(int(place), edge - 1) : 0;
}

// Returns whether the nearest texel of a hit is cut out
INLINE bool is_cut_out(const float* uv, const unsigned* cutout, const int* texels, int layer, float u, float v,
                       float total) {
  int layers = __ldg(texels), edge = __ldg(texels + 1);
  u = __fdiv_rn(u, total), v = __fdiv_rn(v, total);
  int column = texel_at(uv, u, v, edge), row = edge - 1 - texel_at(uv + 1, u, v, edge);
  long long line = (long long)min(layer, layers - 1) * edge + row;
  return __ldg(cutout + line * ((edge + 31) / 32) + column / 32) >> column % 32 & 1;
}

INLINE void test(const Operands& world, int triangle, int instance, int material, const Ray& ray, const Shear& s,
                 Best& best) {
  const float4* at = world.triangle + 3ll * triangle;
  float4 first = __ldg(at);
  float3 a = corner_of(s, first), b = corner_of(s, __ldg(at + 1)), c = corner_of(s, __ldg(at + 2));
  // Edge functions. Their signs come from a comparison of the products.
  float u0 = __fmul_rn(c.x, b.y), u1 = __fmul_rn(c.y, b.x);
  float v0 = __fmul_rn(a.x, c.y), v1 = __fmul_rn(a.y, c.x);
  float w0 = __fmul_rn(b.x, a.y), w1 = __fmul_rn(b.y, a.x);
  bool positive = u0 >= u1 && v0 >= v1 && w0 >= w1;
  if (!positive && !(u0 <= u1 && v0 <= v1 && w0 <= w1)) return;
  float u = __fsub_rn(u0, u1), v = __fsub_rn(v0, v1), w = __fsub_rn(w0, w1);
  float total = __fadd_rn(__fadd_rn(u, v), w);
  if (total == 0) return;
  float t = __fdiv_rn(__fadd_rn(__fadd_rn(__fmul_rn(u, a.z), __fmul_rn(v, b.z)), __fmul_rn(w, c.z)), total);
  if (!(t >= ray.t_min) || !comes_first(t, instance, triangle, best)) return;
  unsigned row = min(unsigned(material) + unsigned(__float_as_int(first.w)), unsigned(world.materials - 1));
  int material_mask = __ldg(world.material_mask + row), stops = material_mask & ray.mask & ALL_KINDS;
  if (stops == 0) return;
  // The hint keeps the registers of the others: the compiler spills within this rare branch.
  if (__builtin_expect(material_mask > ALL_KINDS && (stops & SOUND) == 0, 0)) {
    int layer = max((material_mask >> CUTOUT_SHIFT) - 1, 0);
    if (is_cut_out(world.uv + 6ll * triangle, world.cutout, world.texels, layer, v, w, total)) return;
  }
  bool mirrored = s.axis != 2;  // swapping an axis with z changes the orientation
  bool front = positive == ((s.iz > 0) != mirrored);
  best = {t, instance, triangle, v, w, total, front};
}

// Instances -----------------------------------------------------------------------------------------------------------

INLINE float dot(const float4& row, float x, float y, float z) {
  return __fadd_rn(__fadd_rn(__fmul_rn(row.x, x), __fmul_rn(row.y, y)), __fmul_rn(row.z, z));
}

// Transforms a ray into the frame of an instance
INLINE void enter(const float4* instance, const Ray& ray, Slopes& slopes, Shear& shear) {
  float4 x = __ldg(instance), y = __ldg(instance + 1), z = __ldg(instance + 2);
  float ox = __fadd_rn(dot(x, ray.ox, ray.oy, ray.oz), x.w), dx = dot(x, ray.dx, ray.dy, ray.dz);
  float oy = __fadd_rn(dot(y, ray.ox, ray.oy, ray.oz), y.w), dy = dot(y, ray.dx, ray.dy, ray.dz);
  float oz = __fadd_rn(dot(z, ray.ox, ray.oy, ray.oz), z.w), dz = dot(z, ray.dx, ray.dy, ray.dz);
  slopes = slopes_of(ox, oy, oz, dx, dy, dz);
  shear = shear_of(ox, oy, oz, dx, dy, dz);
}

// Traverses the tree over the static instances from `code`, then the moving instances, counted from `moving`, whose
// bits are set in `pending`. One loop serves both levels, so that rays of a warp in different instances, or in none,
// descend nodes together.
template <bool ANY_HIT>
INLINE void traverse(const Operands& world, const Ray& ray, int code, const float4* moving, unsigned pending, Best& best) {
  int2 places[STACK + 1];
  Place bottom = place_of(places);
  Stack stack{bottom, shift(bottom, STACK)};
  push_bottom(stack);
  Slopes slopes = slopes_of(ray);
  Shear shear{};
  int instance = -1, material = 0;
  for (;;) {
    while (unsigned(code) < unsigned(world.nodes))
      code = descend(world, code, slopes, ray.t_min, best.t, stack);
    if (instance >= 0 && code != EMPTY) {  // at triangles
      int triangle = unsigned(~code) >> 4;
      for (int count = min(~code & 15, world.triangles - triangle); count > 0; --count)
        test(world, triangle++, instance, material, ray, shear, best);
      if (ANY_HIT && best.instance >= 0) return;
      code = pop(stack, best.t);
    } else if (instance >= 0) {  // finished an instance
      instance = -1;
      slopes = slopes_of(ray);
      code = pop(stack, best.t);
    } else {  // at static instances, or finished them
      // The stack is not empty after a tree with empty leaves that a ray hits, or one deeper than MAX_DEPTH.
      if (stack.top > shift(stack.end, -2)) return;
      const float4* next;
      if (code != EMPTY) {
        int index = unsigned(~code) >> 4, more = (~code & 15) - 1;
        if (index >= world.instances) {
          code = pop(stack, best.t);
          continue;
        }
        if (more > 0) push(stack, ~((index + 1) << 4 | more), ray.t_min);
        next = world.fixed + 4 * index;
      } else {
        if (pending == 0) return;
        push_bottom(stack);
        next = moving + 4 * (__ffs(pending) - 1);
        pending &= pending - 1;
      }
      int4 record = __ldg(reinterpret_cast<const int4*>(next + 3));
      bool is_none = record.x == EMPTY || record.y < 0;  // a bottom is pushed only for instances that are entered
      if (is_none || (ray.exclude >= 0 && record.z == ray.exclude)) {
        code = pop(stack, best.t);
      } else {
        push_bottom(stack);
        enter(next, ray, slopes, shear);
        code = record.x;
        instance = record.y;
        material = record.w;
      }
    }
  }
}

// Moving instances -----------------------------------------------------------------------------------------------------

// Bounds of the origins and of 1 / direction of a warp's rays along an axis
struct Span {
  float low, high, least, most;
};

INLINE Span span_of(bool alive, float origin, float slope) {
  return {warp_min(alive ? origin : INF), warp_max(alive ? origin : -INF), warp_min(alive ? slope : INF),
          warp_max(alive ? slope : -INF)};
}

// Narrows [near, far] to the distances at which any ray may be between two planes of a box, by interval arithmetic
INLINE void narrow(const Span& s, float center, float half, float& near, float& far) {
  if (s.least < 0 && s.most > 0) return;
  float a = center - half - s.high, b = center + half - s.low;
  float p = a * s.least, q = a * s.most, r = b * s.least, t = b * s.most;
  near = fmaxf(near, fminf(fminf(p, q), fminf(r, t)));
  far = fminf(far, fmaxf(fmaxf(p, q), fmaxf(r, t)));
}

struct Box {
  float2 p, q, r;  // p: centre x, y; q: centre z, half size x; r: half size y, z
};

INLINE Box box_at(const float2* at) { return {__ldg(at), __ldg(at + 1), __ldg(at + 2)}; }

// Bounds of all rays of a warp
struct Beam {
  Span x, y, z;
  float start;
};

INLINE Beam beam_of(bool alive, const Ray& ray, const Slopes& s) {
  return {span_of(alive, ray.ox, s.ix), span_of(alive, ray.oy, s.iy), span_of(alive, ray.oz, s.iz),
          warp_min(alive ? ray.t_min : INF)};
}

// Returns a bit mask of the moving instances of a group that any ray of the warp may hit; each lane tests one box
// against all rays.
INLINE unsigned find_candidates(const float2* boxes, int count, const Beam& beam, float end) {
  unsigned candidates = 0;
  for (int first = 0; first < count; first += WARP_SIZE) {
    int i = first + threadIdx.x % WARP_SIZE;
    bool may = false;
    if (i < count) {
      Box box = box_at(boxes + 3 * i);
      float near = beam.start, far = end;
      narrow(beam.x, box.p.x, box.q.y, near, far);
      narrow(beam.y, box.p.y, box.r.x, near, far);
      narrow(beam.z, box.q.x, box.r.y, near, far);
      may = near <= far * (1 + 1e-5f) && box.q.y >= 0;  // not empty
    }
    candidates |= warp_ballot(may) << first;
  }
  return candidates;
}

// Returns a bit mask of the moving instances of a group whose bounds this ray hits
INLINE unsigned find_moving(const float2* boxes, int count, const Beam& beam, const Slopes& s, bool alive,
                            const Ray& ray, float limit) {
  unsigned found = 0;
  float end = warp_max(alive ? limit : -INF);
  for (unsigned left = find_candidates(boxes, count, beam, end); left; left &= left - 1) {
    int i = __ffs(left) - 1;
    Box box = box_at(boxes + 3 * i);
    float near;
    bool met = meets(s, box.p.x, box.p.y, box.q.x, box.q.y, box.r.x, box.r.y, ray.t_min, limit, near);
    if (met && alive) found |= 1u << i;
  }
  return found;
}

// Rays ------------------------------------------------------------------------------------------------------------------

// Casts a ray at the static instances first, since walls hide most moving instances.
template <bool ANY_HIT>
INLINE Best cast(const Operands& world, bool alive, const Ray& ray, float t_max) {
  Best best{fminf(t_max, MISS), -1, -1, 0, 0, 1, false};
  if (alive) traverse<ANY_HIT>(world, ray, world.root, world.moving, 0, best);
  Slopes slopes = slopes_of(ray);
  Beam beam = beam_of(alive && !(ANY_HIT && best.instance >= 0), ray, slopes);
  for (int first = 0; first < world.num_moving; first += GROUP) {
    int count = min(world.num_moving - first, GROUP);
    bool open = alive && !(ANY_HIT && best.instance >= 0);
    unsigned pending = find_moving(world.box + 3 * first, count, beam, slopes, open, ray, best.t);
    if (pending) traverse<ANY_HIT>(world, ray, EMPTY, world.moving + 4 * first, pending, best);
  }
  return best;
}

// Returns the index of this thread's ray within its environment, or -1. Warps cast tiles of the image, if there is one.
INLINE int ray_of_thread(int rays_per_env, int width) {
  int lane = threadIdx.x % WARP_SIZE, warp = blockIdx.x * (BLOCK / WARP_SIZE) + threadIdx.x / WARP_SIZE;
  int x = lane, y = 0;
  if (width > 0) {
    int across = (width + TILE_WIDTH - 1) / TILE_WIDTH, down = warp / across;
    x = (warp - down * across) * TILE_WIDTH + lane % TILE_WIDTH;
    y = down * TILE_HEIGHT + lane / TILE_WIDTH;
    if (x >= width) return -1;
  } else {
    x += warp * WARP_SIZE;
  }
  int ray = y * width + x;
  return ray < rays_per_env ? ray : -1;
}

struct Rays {
  const float *__restrict__ origin, *__restrict__ direction, *__restrict__ t_min, *__restrict__ t_max;
  const int *__restrict__ exclude, *__restrict__ mask;
};

// Loads a ray. Each field has one value per ray, or one per environment if its `own` is 0.
INLINE Ray load(const Rays& rays, const int* own, int env, long long row, float& t_max) {
  const float* o = rays.origin + 3 * (__ldg(own) ? row : env);
  const float* d = rays.direction + 3 * (__ldg(own + 1) ? row : env);
  t_max = __ldg(rays.t_max + (__ldg(own + 3) ? row : env));
  return {__ldg(o),
          __ldg(o + 1),
          __ldg(o + 2),
          __ldg(d),
          __ldg(d + 1),
          __ldg(d + 2),
          __ldg(rays.t_min + (__ldg(own + 2) ? row : env)),
          __ldg(rays.exclude + (__ldg(own + 4) ? row : env)),
          __ldg(rays.mask + (__ldg(own + 5) ? row : env))};
}

// Returns whether all components are finite: a finite number times zero is zero. Other rays have no hit.
INLINE bool is_finite(const Ray& ray) { return (ray.ox + ray.oy + ray.oz + ray.dx + ray.dy + ray.dz) * 0 == 0; }

// Work of one thread
struct Task {
  long long row;  // of the ray and of its results; -1 none: the thread only joins its warp's collective operations
  Ray ray;
  float t_max;
};

INLINE bool can_hit(const Task& task) { return task.row >= 0 && is_finite(task.ray) && task.ray.t_min <= task.t_max; }

// Loads this thread's environment and ray; returns false for blocks that have none. `size` holds the numbers of
// environments, rays per environment, static and moving instances per environment, and pixels in a row. Then follow
// six flags, 1 if a field of the rays has one value per ray; the numbers of nodes, triangles, materials and houses;
// the query's steps and the bits of its skin; the number of cut-out layers and their edge.
INLINE bool find_task(Operands& world, const int* __restrict__ house_root, const int* __restrict__ house,
                      const Rays& rays, const int* __restrict__ size, Task& task) {
  int env = blockIdx.y + gridDim.y * blockIdx.z;
  if (env >= __ldg(size)) return false;
  int number = ray_of_thread(__ldg(size + 1), __ldg(size + 4));
  int at = min(max(__ldg(house + env), 0), __ldg(size + 14) - 1);
  long long row = (long long)env * __ldg(size + 1) + max(number, 0);
  task.row = number < 0 ? -1 : row;
  world.instances = __ldg(size + 2), world.num_moving = __ldg(size + 3);
  world.nodes = __ldg(size + 11), world.triangles = __ldg(size + 12), world.materials = __ldg(size + 13);
  world.texels = size + 17;
  world.root = __ldg(house_root + at);
  world.fixed += 4ll * at * world.instances;
  world.moving += 4ll * env * world.num_moving;
  world.box += 3ll * env * world.num_moving;
  task.ray = load(rays, size + 5, env, row, task.t_max);
  return true;
}

// Returns the object id of a hit instance: that of the moving instance with its number, else that of the house
INLINE int object_of(const Operands& world, int instance) {
  int object = -1;
  if (instance < world.instances) object = __ldg(reinterpret_cast<const int4*>(world.fixed + 4 * instance + 3)).z;
  for (int i = 0; i < world.num_moving; ++i) {
    int4 record = __ldg(reinterpret_cast<const int4*>(world.moving + 4 * i + 3));
    if (record.y == instance) object = record.z;
  }
  return object;
}

// Operands in the order of cuda.py
#define OPERANDS                                                                                                     \
  const float4 *node, const float4 *corner, const int *material_mask, const float *uv, const unsigned *cutout,       \
      const float4 *fixed, const float4 *moving, const float2 *box, const int *house_root, const int *house,         \
      const float *origin, const float *direction, const float *t_min, const float *t_max, const int *exclude,       \
      const int *mask, const int *size
#define WORLD \
  Operands { node, corner, material_mask, uv, cutout, size, fixed, moving, box, 0, 0, 0, 0, 0, 0 }
#define RAYS \
  Rays { origin, direction, t_min, t_max, exclude, mask }
#define RESULTS float *t, int *instance, int *triangle, float *u, float *v, bool *front

INLINE void store(const Best& best, long long row, RESULTS) {
  t[row] = best.instance < 0 ? MISS : best.t;
  instance[row] = best.instance;
  triangle[row] = best.triangle;
  u[row] = __fdiv_rn(best.u, best.total);
  v[row] = __fdiv_rn(best.v, best.total);
  front[row] = best.front;
}

#ifndef WITHOUT_CASTS  // kernels that follow this file define it
extern "C" __global__ void __launch_bounds__(BLOCK, BLOCKS_PER_SM) cast_closest(OPERANDS, RESULTS) {
  Operands world = WORLD;
  Task task;
  if (!find_task(world, house_root, house, RAYS, size, task)) return;
  Best best = cast<false>(world, can_hit(task), task.ray, task.t_max);
  if (task.row >= 0) store(best, task.row, t, instance, triangle, u, v, front);
}

extern "C" __global__ void __launch_bounds__(BLOCK, BLOCKS_PER_SM) cast_any(OPERANDS, int* instance) {
  Operands world = WORLD;
  Task task;
  if (!find_task(world, house_root, house, RAYS, size, task)) return;
  Best best = cast<true>(world, can_hit(task), task.ray, task.t_max);
  if (task.row >= 0) instance[task.row] = best.instance;
}

// Returns successive hits along a ray. Each cast begins behind the hit before it and ignores the object hit last, with
// all of its faces; the architecture cannot be ignored. A warp continues until all of its rays have missed.
extern "C" __global__ void __launch_bounds__(BLOCK, BLOCKS_PER_SM) cast_through(OPERANDS, RESULTS) {
  Operands world = WORLD;
  Task task;
  if (!find_task(world, house_root, house, RAYS, size, task)) return;
  bool goes_on = true;
  for (int step = 0, steps = __ldg(size + 15); step < steps; ++step) {
    Best best{0, -1, -1, 0, 0, 1, false};
    goes_on = goes_on && can_hit(task);
    if (warp_ballot(goes_on)) best = cast<false>(world, goes_on, task.ray, task.t_max);
    if (task.row >= 0) store(best, task.row * steps + step, t, instance, triangle, u, v, front);
    goes_on = best.instance >= 0;
    if (!goes_on) continue;
    int object = object_of(world, best.instance);
    if (object >= 0) task.ray.exclude = object;
    task.ray.t_min = __fadd_rn(best.t, __int_as_float(__ldg(size + 16)));
  }
}
#endif
