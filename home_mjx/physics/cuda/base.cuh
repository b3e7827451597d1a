// Types, limits and machine-dependent functions. Precedes shapes.cuh in the compiled source.

#define INLINE __device__ __forceinline__

#ifndef WARP_SIZE  // tests define it to compile for a CPU, with warps of one thread and in double precision
typedef float real;
constexpr int WARP_SIZE = 32;
constexpr unsigned ALL_LANES = 0xffffffffu;
#define LANE int(threadIdx.x)
constexpr real LINE_SEARCH_TOLERANCE = 1e-2f;  // line-search tolerance: final slope of the cost over that at its start
constexpr real NEWTON_TOLERANCE = 1e-11f;  // Newton tolerance: remaining decrease over the cost's scale
constexpr real MIN_PIVOT = 1e-9f;  // minimum Cholesky pivot before its square root [kg] or [kg m^2]
constexpr real MIN_CROSS_LENGTH = 1e-4f;  // minimum length of the cross product of edge directions
constexpr real MAX_EDGE_OVERLAP_RATIO = 1 - 1e-6f;
constexpr real TINY = 1e-9f;

INLINE void sync_warp() { __syncwarp(); }
INLINE unsigned warp_ballot(bool x) { return __ballot_sync(ALL_LANES, x); }
INLINE int count_bits(unsigned x) { return __popc(x); }
INLINE unsigned warp_alike(int x) { return __match_any_sync(ALL_LANES, x); }
INLINE real from_lane(real x, int lane) { return __shfl_sync(ALL_LANES, x, lane < 0 ? 0 : lane); }
INLINE int from_lane(int x, int lane) { return __shfl_sync(ALL_LANES, x, lane < 0 ? 0 : lane); }
// Returns the same bits in every lane: both lanes of each exchange add the same two numbers.
INLINE real warp_sum(real x) {
  for (int step = WARP_SIZE / 2; step > 0; step /= 2) x += __shfl_xor_sync(ALL_LANES, x, step);
  return x;
}
extern __shared__ float shared_floats[];
INLINE real* shared_memory() { return shared_floats; }
#endif

typedef unsigned char Flag;
typedef unsigned short Index;  // of a dynamic body or contact; shared memory holds fewer than 1500 bodies

#define INF real(1e30)
#define NONE real(-9)  // the capsule has no second contact sphere

constexpr int MAX_PAIR_POINTS = 16;  // maximum number of contact points of a pair of shapes
constexpr int BLOCKS = 16;  // minimum number of blocks per multiprocessor: 128 registers a thread
constexpr int SLEEPING_BODY = -1000000;  // code of a contact's second body m if that sleeps: SLEEPING_BODY - m
constexpr int PAIRS_PER_BODY = 16;  // pairs of nearby bodies per dynamic body that the buffer holds, as in fused.py
constexpr int MAX_NEAR_BOXES = 24;  // maximum number of listed static boxes per dynamic body
constexpr int POINTS_PER_BODY = 24;  // contact points per dynamic body that the buffer holds
constexpr int CONTACT_WORDS = 52;  // words of memory per contact, as in fused.py
constexpr int SHARED_CONTACTS = 10;  // contacts of an environment that are in shared memory, as in fused.py
constexpr int SMALL_ISLAND = 3;  // maximum dynamic bodies of an island solved in shared memory, as in fused.py
// Codes of a contact's second side if that is no dynamic body; static box c is STATIC - c.
constexpr int JOINT_LIMIT = -1, FLOOR = -2, STATIC = -3;
constexpr real MIN_SUPPORT_NORMAL = real(0.5);  // as in base/state.py
// Columns of the tables, see numba/params.py
constexpr int AGENT_COLUMNS = 8, DOOR_COLUMNS = 16, RAMP_COLUMNS = 8, SURFACE_COLUMNS = 5;
constexpr int TRAY_BOXES = 4, TRAY_ROWS = 2;  // see base/doors.py
constexpr int NOT_DRIVEN = 1000000000;  // goal of a door that is not driven
constexpr real WAKE_DISTANCE = 0.01;  // [m], see numba/sleep.py
constexpr real MIN_AWAKE_ACCELERATION = 1e-6;  // acceleration that marks a woken dynamic body; sleeping ones have 0
constexpr real HEAVY = 1e20;  // mass of a door's unused DoFs
constexpr int STATIC_OVERFLOW = 0, POINT_OVERFLOW = 1, NUM_AWAKE = 2, NUM_COUNTS = 3;
constexpr int MAX_LINE_STEPS = 40;
constexpr int NUM_NUMBERS = 32;
constexpr real ALIGNED_COSINE = 0.99, ALIGNED_OVERLAP_RATIO = 0.95;  // see numba/box_box.py
constexpr real NEAR_DISTANCE = 0.1;  // [m], see numba/contact_detection.py

struct Numbers {
  real sim_dt, substeps, gravity, control, response_time, max_body_speed, max_body_spin, stiffness, damping,
      impedance_low, impedance_high, impedance_width, iterations, corner_radius, sleep, rest_speed, rest_spin, rest_pull, on_ramp,
      hand_time, hand_speed, hand_spin, hand_twist, hand_acceleration, hand_force, hand_stiffness, hand_slack,
      hand_leash, door_drag, door_time, door_speed, door_torque;
};
