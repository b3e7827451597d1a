// Energies between cells from the sums of all flights: renewal.py, portal_correction.py and pair_sums.py on GPUs.
// Compiled after flight.cu. Every sum has a fixed order, so that results have the same bits in every run.

constexpr int CELLS = 32;           // cells of a block of solve_renewal
constexpr int RENEWAL_TEAM = 1024;  // its threads
constexpr int DECAY_TEAM = 128;     // threads of a block of sum_decays
constexpr int SPANS = 5;
constexpr float LEAST_ENERGY = 1e-25f;  // smaller energies are zero

// Copies energies of cells from states (count, cells, bins, RECORDED) to `found` (RECORDED, states, all_bins, stride)
struct Gathering {
  const float* energy;
  float* found;
  const int* row;  // (count,)
  Word count, cells, bins, states, all_bins, stride;
};

extern "C" __global__ void __launch_bounds__(BLOCK) gather_states(const Gathering s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x;
  if (i >= s.count * s.cells * s.bins * RECORDED) return;
  Word lane = i % RECORDED, k = i / RECORDED % s.bins, cell = i / RECORDED / s.bins % s.cells;
  Word state = s.row[i / RECORDED / s.bins / s.cells];
  if (k < s.all_bins) s.found[((lane * s.states + state) * s.all_bins + k) * s.stride + cell] = s.energy[i];
}

// Adds the transfer between states to `found` in place, see renewal.py; a block has some cells of a lane. Within a bin
// all states are updated at once, while renewal.py does so one after the other.
struct Renewal {
  float* found;               // (RECORDED, states, bins, stride)
  float* base;                // (2, RECORDED, states, stride)
  const float* share;         // (RECORDED, pairs, bins)
  const int* end;             // (states + 1,), range of pairs of each state
  const int* pair;            // (pairs, 3): next state, first bin (at least 1) and one past the last bin of transfer
  const int* sweeps;          // (states,), 1: energy passes within a bin
  Word states, bins, stride, pairs, directional_bins, repeats;
};

extern "C" __global__ void __launch_bounds__(RENEWAL_TEAM) solve_renewal(const Renewal s) {
  Word lane = blockIdx.y, cell = Word(blockIdx.x) * CELLS + threadIdx.x % CELLS, row = s.states * s.stride;
  Word bins = lane < OCTAVES ? s.bins : s.directional_bins;
  float* found = s.found + lane * s.bins * row + cell;
  const float* share = s.share + lane * s.pairs * s.bins;
  float *first = s.base + lane * row + cell, *other = first + RECORDED * row;
  for (Word k = 0; k < bins; ++k) {
    for (Word g = threadIdx.x / CELLS; g < s.states; g += RENEWAL_TEAM / CELLS) {
      float* here = found + (g * s.bins + k) * s.stride;
      float a = *here, b = 0, c = 0, d = 0;
      for (int pair = s.end[g]; pair < s.end[g + 1]; ++pair) {
        Word lag = s.pair[3 * pair + 1], last = min(Word(s.pair[3 * pair + 2]), k + 1);
        const float *w = share + pair * s.bins, *past = found + s.pair[3 * pair] * s.bins * s.stride;
        for (; lag + 3 < last; lag += 4) {
          a += w[lag] * past[(k - lag) * s.stride];
          b += w[lag + 1] * past[(k - lag - 1) * s.stride];
          c += w[lag + 2] * past[(k - lag - 2) * s.stride];
          d += w[lag + 3] * past[(k - lag - 3) * s.stride];
        }
        for (; lag < last; ++lag) a += w[lag] * past[(k - lag) * s.stride];
      }
      a = (a + b) + (c + d);
      *here = first[g * s.stride] = fabsf(a) > LEAST_ENERGY ? a : 0;
    }
    __syncthreads();
    for (Word sweep = 0; sweep < s.repeats; ++sweep) {
      for (Word g = threadIdx.x / CELLS; g < s.states; g += RENEWAL_TEAM / CELLS) {
        float sum = first[g * s.stride];
        for (int pair = s.end[g]; s.sweeps[g] && pair < s.end[g + 1]; ++pair)
          sum += share[pair * s.bins] * found[(s.pair[3 * pair] * s.bins + k) * s.stride];
        other[g * s.stride] = sum;
      }
      __syncthreads();
      for (Word g = threadIdx.x / CELLS; g < s.states; g += RENEWAL_TEAM / CELLS)
        found[(g * s.bins + k) * s.stride] = other[g * s.stride];
      __syncthreads();
    }
  }
}

// Sums energies, negative ones as 0, over the cells of each room and the bins of each interval: (m, states, rooms,
// intervals, OCTAVES), from `energy` with strides per batch m, octave, state, bin and cell
struct RoomSums {
  const float* energy;
  double* out;
  const int *room, *edge;  // (cells,), (intervals + 1,)
  Word batches, states, rooms, intervals, cells, batch, lane, state, bin, cell;
};

extern "C" __global__ void __launch_bounds__(BLOCK) sum_rooms_over_time(const RoomSums s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x;
  if (i >= s.batches * s.states * s.rooms * s.intervals * OCTAVES) return;
  Word octave = i % OCTAVES, part = i / OCTAVES % s.intervals, room = i / OCTAVES / s.intervals % s.rooms;
  Word state = i / OCTAVES / s.intervals / s.rooms % s.states, batch = i / OCTAVES / s.intervals / s.rooms / s.states;
  const float* from = s.energy + batch * s.batch + octave * s.lane + state * s.state;
  double sum = 0;
  for (Word c = 0; c < s.cells; ++c)
    for (Word k = s.edge[part]; s.room[c] == room && k < s.edge[part + 1]; ++k)
      sum += fmaxf(from[k * s.bin + c * s.cell], 0);
  s.out[i] = sum;
}

// Copies energies after states to (lanes, states, cells, bins), times `ratio` per state, room and bin, and sums them up
struct After {
  const float* found;  // (lanes, states of the renewal, all_bins, stride)
  const float* ratio;  // (states, rooms, bins); null: energies may be negative and are not changed
  const int* room;     // (cells,)
  float* after;
  double* total;  // (lanes, states, cells, bins + 1), cumulative
  Word lanes, states, cells, bins, rooms, all_bins, stride, all_states;
};

extern "C" __global__ void __launch_bounds__(BLOCK) sum_after(const After s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x;
  if (i >= s.lanes * s.states * s.cells) return;
  Word cell = i % s.cells, state = i / s.cells % s.states, lane = i / s.cells / s.states;
  const float* from = s.found + (lane * s.all_states + state) * s.all_bins * s.stride + cell;
  const float* ratio = s.ratio ? s.ratio + (state * s.rooms + s.room[cell]) * s.bins : nullptr;
  float* after = s.after + i * s.bins;
  double *total = s.total + i * (s.bins + 1), sum = 0;
  total[0] = 0;
  for (Word k = 0; k < s.bins; ++k) {
    float value = from[k * s.stride];
    if (ratio) value = fmaxf(value, 0) * ratio[k];
    after[k] = value;
    total[k + 1] = sum += value;
  }
}

// Sums between cells, see pair_sums.py
struct Pairs {
  const float* own;     // (cells, cells, own_bins, RECORDED), octave `first_lane` and on
  const float* sent;    // (lanes, states, sent_bins, cells)
  const float* after;   // (lanes, states, cells, bins)
  const double* total;  // (lanes, states, cells, bins + 1)
  const int* arrival;   // (cells, cells)
  const int* room;      // (cells,)
  const int* most;      // (cells,), latest arrival at each cell
  const int* end;       // (SPANS,), end of each span [bins]
  double *pair;         // (cells, cells, SPANS, lanes)
  double *part;         // (cells, rooms, lanes, bins), decays to one cell
  double *shape;        // (rooms, rooms, lanes, bins)
  Word cells, rooms, states, lanes, bins, own_bins, sent_bins, first_lane;
};

// Sums over spans of time; blocks of sources along x, pairs of target and octave along y
extern "C" __global__ void __launch_bounds__(BLOCK) sum_spans(const Pairs s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x, target = blockIdx.y / s.lanes, b = blockIdx.y % s.lanes;
  if (i >= s.cells) return;
  Word arrival = s.arrival[i * s.cells + target], ends[SPANS];
  double spans[SPANS] = {};
  const float* own = s.own + (i * s.cells + target) * s.own_bins * RECORDED + s.first_lane + b;
  for (int span = 0; span < SPANS; ++span) {
    Word start = span ? s.end[span - 1] + arrival : 0;
    for (Word k = start; k < min(s.end[span] + arrival, s.own_bins); ++k) spans[span] += own[k * RECORDED];
    ends[span] = span == SPANS - 1 ? s.bins : min(s.end[span] + arrival, s.bins);
  }
  for (Word g = 0; g < s.states; ++g) {
    const double* total = s.total + ((b * s.states + g) * s.cells + target) * (s.bins + 1);
    const float* sent = s.sent + (b * s.states + g) * s.sent_bins * s.cells + i;
    if (total[s.bins] == 0) continue;
    for (Word k = 0; k < s.sent_bins; ++k) {
      double energy = sent[k * s.cells], before = 0;
      if (energy == 0) continue;
      for (int span = 0; span < SPANS; ++span) {
        double until = total[max(ends[span] - k, Word(0))];
        spans[span] += energy * (until - before);
        before = until;
      }
    }
  }
  for (int span = 0; span < SPANS; ++span) s.pair[((i * s.cells + target) * SPANS + span) * s.lanes + b] = spans[span];
}

// Sums decays from each room to each cell, by bins after the first possible arrival; blocks of targets along x, pairs of
// room and octave along y
extern "C" __global__ void __launch_bounds__(DECAY_TEAM) sum_decays(const Pairs s) {
  extern __shared__ double moved[];  // (sent_bins + most,), emission of the room, from bin -most on
  Word target = blockIdx.x, room = blockIdx.y / s.lanes, b = blockIdx.y % s.lanes, most = s.most[target];
  Word length = s.sent_bins + most;
  double* out = s.part + ((target * s.rooms + room) * s.lanes + b) * s.bins;
  for (Word at = threadIdx.x; at < s.bins; at += DECAY_TEAM) {
    double sum = 0;
    for (Word i = 0; i < s.cells; ++i) {
      if (s.room[i] != room) continue;
      const float* own = s.own + (i * s.cells + target) * s.own_bins * RECORDED + s.first_lane + b;
      Word arrival = s.arrival[i * s.cells + target];
      for (Word k = at ? at + arrival : 0; k <= at + arrival && k < s.own_bins; ++k) sum += own[k * RECORDED];
    }
    out[at] = sum;
  }
  for (Word g = 0; g < s.states; ++g) {
    const float* sent = s.sent + (b * s.states + g) * s.sent_bins * s.cells;
    const float* after = s.after + ((b * s.states + g) * s.cells + target) * s.bins;
    const double* total = s.total + ((b * s.states + g) * s.cells + target) * (s.bins + 1);
    if (total[s.bins] == 0) continue;
    __syncthreads();
    for (Word j = threadIdx.x; j < length; j += DECAY_TEAM) {
      double sum = 0;
      for (Word i = 0; i < s.cells; ++i) {
        if (s.room[i] != room) continue;
        Word k = j + s.arrival[i * s.cells + target] - most;
        if (k >= 0 && k < s.sent_bins) sum += sent[k * s.cells + i];
      }
      moved[j] = sum;
    }
    __syncthreads();
    for (Word at = threadIdx.x; at < s.bins; at += DECAY_TEAM) {
      double sum = 0;
      for (Word j = 0; j < length && j - most <= at; ++j) {
        Word shift = j - most;
        if (moved[j] == 0) continue;
        if (at - shift < s.bins) sum += moved[j] * after[at - shift];
        if (at == 0 && shift < 0) sum += moved[j] * total[min(-shift, s.bins)];
      }
      out[at] += sum;
    }
  }
}

// Sums the decays to the cells of each room
extern "C" __global__ void __launch_bounds__(BLOCK) sum_targets(const Pairs s) {
  Word i = Word(blockIdx.x) * BLOCK + threadIdx.x, row = s.lanes * s.bins;
  if (i >= s.rooms * s.rooms * row) return;
  Word inner = i % row, entered = i / row % s.rooms, room = i / row / s.rooms;
  double sum = 0;
  for (Word target = 0; target < s.cells; ++target)
    if (s.room[target] == entered) sum += s.part[(target * s.rooms + room) * row + inner];
  s.shape[i] = sum;
}
