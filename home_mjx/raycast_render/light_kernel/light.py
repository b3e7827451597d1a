"""Light at surfaces in compiled code: baked texels and probes, and shadow rays to lamps; counterpart of `lit`."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

import math
from typing import Any, NamedTuple, no_type_check

import numpy as np

from home_mjx.core.native.inner import compile_inner
from home_mjx.raycast_render.light_kernel.surface import HALF, ONE, TWO, ZERO, inverse_norm
from home_mjx.raycast_render.lighting import lights, probes
from home_mjx.schema.compiled import ARCHITECTURE, MAX_DEPTH_BELOW_FLOOR

PROBE_OFFSET, VIEW_OFFSET, FACADE_GAP = (
    np.float32(x) for x in (probes.PROBE_OFFSET, probes.VIEW_OFFSET, probes.FACADE_GAP)
)
MIN_FACING, FACING_RISE = np.float32(probes.MIN_FACING), np.float32(0.5 / probes.FACING_DEPTH)
DEPTH = np.float32(MAX_DEPTH_BELOW_FLOOR)
BIAS, RAY_END, NEAREST = (np.float32(x) for x in (lights.SHADOW_BIAS, lights.SHADOW_RAY_END, lights.MIN_LIGHT_DISTANCE))
PI, INVERSE_PI = np.float32(math.pi), np.float32(1 / math.pi)
ZENITH_UP, ZENITH_LEVEL = np.float32(probes.ZENITH_UP), np.float32(probes.ZENITH_LEVEL)
LEAST_SQUARE, OWN_SHARE, LEAST_COSINE = np.float32(1e-4), np.float32(0.7), np.float32(1e-6)
GRAZING = np.float32(1e-3)
# Columns of the tables of lights
POS, DIRECTION, INTENSITY, POWER, EXPONENT, CUTOFF, AREA, LIGHT_COLUMNS = 0, 3, 6, 9, 10, 11, 12, 13
CARRIER, OBJECT, LIGHT_IDS = 0, 1, 2
# Columns of the vector of the sky, the sun and the edge of a navigation cell
SKY_ZENITH, SKY_HORIZON, SKY_GROUND, AMBIENT, SUN_AIM, SUN_COLOR, CELL = 0, 3, 6, 9, 10, 13, 16

Pointer = Any
compiled = compile_inner()


class BakedHouse(NamedTuple):
    """Pointers to one house's baked light and navigation grid, and the numbers of their rows."""

    probe: Pointer  # mixed light, of all houses or of this environment
    texel: Pointer
    probe_bits: Pointer  # the same, packed
    texel_bits: Pointer
    packed: np.bool_
    first_probe: np.int64  # of the house in `probe`
    first_texel: np.int64
    first: Pointer
    origin: Pointer
    step: Pointer
    count: Pointer
    chart_start: Pointer
    chart: Pointer
    chart_frame: Pointer
    chart_count: Pointer
    chart_first: Pointer
    instance_model: Pointer
    model_triangle: Pointer
    grid: Pointer
    floor: Pointer
    corner: Pointer
    charted: np.int64  # instances that may have charts
    triangles: np.int64  # rows of `chart`
    levels: np.int64
    lines: np.int64
    columns: np.int64
    cell: np.float32  # [m]


class LampChoice(NamedTuple):
    """Pointers to one environment's lights and the choice among them."""

    table: Pointer
    ids: Pointer
    by_room: Pointer  # key lamps by room + 1
    by_instance: Pointer  # last and first light that an instance carries
    sky: Pointer
    rooms: np.int64
    keys: np.int64
    instances: np.int64


@compiled
@no_type_check
def find_room(bake, point):
    """Return the room whose probes light a point; -1 outdoors. See `probes.probe_room`."""
    room = point.room
    if room < 0 or point.moves:
        x, y, z = (
            point.px + point.vx * VIEW_OFFSET,
            point.py + point.vy * VIEW_OFFSET,
            point.pz + point.vz * VIEW_OFFSET,
        )
        room = _room_at(bake, x, y, z)
    if room >= 0 and _is_facade(bake, point, room):
        return np.int64(-1)
    return room


@compiled
@no_type_check
def _room_at(bake, x, y, z):
    """Return the room of the navigation grid at a position; -1 outside of rooms."""
    level = -1
    for i in range(bake.levels):
        if z > bake.floor[i] - DEPTH:
            level += 1
    column = np.int64(np.floor((x - bake.corner[0]) / bake.cell))
    line = np.int64(np.floor((y - bake.corner[1]) / bake.cell))
    if level < 0 or line < 0 or column < 0 or line >= bake.lines or column >= bake.columns:
        return np.int64(-1)
    return np.int64(bake.grid[(level * bake.lines + line) * bake.columns + column])


@compiled
@no_type_check
def _is_facade(bake, point, room):
    """Return whether a point faces away from its room beyond its probes."""
    o, s, c = bake.origin, bake.step, bake.count
    for i in range(3):
        pos = point.px if i == 0 else (point.py if i == 1 else point.pz)
        normal = point.nx if i == 0 else (point.ny if i == 1 else point.nz)
        low = o[3 * room + i]
        high = low + s[3 * room + i] * np.float32(c[3 * room + i] - 1)
        if (pos > high + FACADE_GAP and normal > HALF) or (pos < low - FACADE_GAP and normal < -HALF):
            return True
    return False


@compiled
@no_type_check
def find_chart(bake, point, triangle, front):
    """Return the chart of a hit face; -1 for backs, faces without one and moving instances."""
    if not front or point.instance >= bake.charted or bake.chart_start[point.instance] < 0:
        return np.int64(-1)
    model = max(np.int64(bake.instance_model[point.instance]), 0)
    row = np.int64(bake.chart_start[point.instance]) - np.int64(bake.model_triangle[model]) + np.int64(triangle)
    return np.int64(bake.chart[min(max(row, 0), bake.triangles - 1)])


@compiled
@no_type_check
def _color(table, packed_table, packed, row, channel):
    """Return a channel of a row of a table of colours."""
    if not packed:
        return table[3 * row + channel]
    bits = np.int64(packed_table[row])
    return np.float32((bits >> (9 * channel)) & 511) * np.float32(2.0 ** np.float32((bits >> 27) - 24))


@compiled
@no_type_check
def texel_light(bake, point, chart):
    """Return the irradiance [W/m^2] of a chart at a point, between four texels."""
    f, at = bake.chart_frame, 9 * chart
    x, y, z = point.px - f[at], point.py - f[at + 1], point.pz - f[at + 2]
    first_count, second_count = np.int64(bake.chart_count[2 * chart]), np.int64(bake.chart_count[2 * chart + 1])
    i, u = _split(x * f[at + 3] + y * f[at + 4] + z * f[at + 5], first_count)
    j, v = _split(x * f[at + 6] + y * f[at + 7] + z * f[at + 8], second_count)
    cell = bake.first_texel + np.int64(bake.chart_first[chart]) + i * second_count + j
    red = green = blue = ZERO
    for corner in range(4):
        a, b = corner & 1, corner >> 1
        weight = (u if a else ONE - u) * (v if b else ONE - v)
        row = cell + a * second_count + b
        red += _color(bake.texel, bake.texel_bits, bake.packed, row, 0) * weight
        green += _color(bake.texel, bake.texel_bits, bake.packed, row, 1) * weight
        blue += _color(bake.texel, bake.texel_bits, bake.packed, row, 2) * weight
    return red, green, blue


@compiled
@no_type_check
def _split(place, count):
    """Return the index of a place among `count` points in a row, and the share of the next one."""
    place = min(max(place, ZERO), np.float32(count - 1))
    low = min(np.int64(place), count - 2)
    return low, place - np.float32(low)


@compiled
@no_type_check
def probe_light(bake, sky, point, room):
    """Return the irradiance [W/m^2] of probes on a point; outdoors of the open sky."""
    if room < 0:
        return _open_light(sky, point.sz)
    if bake.first[room] < 0:
        return ZERO, ZERO, ZERO
    o, s, c = bake.origin, bake.step, bake.count
    ny, nz = np.int64(c[3 * room + 1]), np.int64(c[3 * room + 2])
    i, u = _split((point.px + point.sx * PROBE_OFFSET - o[3 * room]) / s[3 * room], np.int64(c[3 * room]))
    j, v = _split((point.py + point.sy * PROBE_OFFSET - o[3 * room + 1]) / s[3 * room + 1], ny)
    k, w = _split((point.pz + point.sz * PROBE_OFFSET - o[3 * room + 2]) / s[3 * room + 2], nz)
    cell = bake.first_probe + np.int64(bake.first[room]) + (i * ny + j) * nz + k
    fx, fy, fz = (1 if point.sx < ZERO else 0), (3 if point.sy < ZERO else 2), (5 if point.sz < ZERO else 4)
    xx, yy, zz = point.sx * point.sx, point.sy * point.sy, point.sz * point.sz
    rx, ry, rz = point.sx * s[3 * room], point.sy * s[3 * room + 1], point.sz * s[3 * room + 2]
    low = PROBE_OFFSET - (rx * u + ry * v + rz * w)
    red = green = blue = total = ZERO
    for corner in range(8):
        a, b, d = corner & 1, corner >> 1 & 1, corner >> 2
        above = low + (rx if a else ZERO) + (ry if b else ZERO) + (rz if d else ZERO)
        weight = min(max(HALF + above * FACING_RISE, MIN_FACING), ONE)
        weight *= (u if a else ONE - u) * (v if b else ONE - v) * (w if d else ONE - w)
        total += weight
        row = 6 * (cell + a * ny * nz + b * nz + d)
        for face, square in ((fx, xx), (fy, yy), (fz, zz)):
            part = weight * square
            red += _color(bake.probe, bake.probe_bits, bake.packed, row + face, 0) * part
            green += _color(bake.probe, bake.probe_bits, bake.packed, row + face, 1) * part
            blue += _color(bake.probe, bake.probe_bits, bake.packed, row + face, 2) * part
    return red / total, green / total, blue / total


@compiled
@no_type_check
def _open_light(sky, up):
    """Return the sky's irradiance on a normal whose vertical part is `up`, without obstacles."""
    high = ZENITH_LEVEL + up * (ZENITH_UP * HALF) + up * up * (ZENITH_UP * HALF - ZENITH_LEVEL)
    side, below = PI * (ONE + up) * HALF - high, PI * (ONE - up) * HALF
    return (
        sky[SKY_ZENITH] * high + sky[SKY_HORIZON] * side + sky[SKY_GROUND] * below,
        sky[SKY_ZENITH + 1] * high + sky[SKY_HORIZON + 1] * side + sky[SKY_GROUND + 1] * below,
        sky[SKY_ZENITH + 2] * high + sky[SKY_HORIZON + 2] * side + sky[SKY_GROUND + 2] * below,
    )


@compiled
@no_type_check
def choose_lamps(lamps, point, room):
    """Return the two lamps of a point, see `lights.key_lamps`; -1 none."""
    place = min(max(room + 1, 0), lamps.rooms)
    one, other = np.int64(lamps.by_room[lamps.keys * place]), np.int64(-1)
    if lamps.keys > 1:
        other = np.int64(lamps.by_room[lamps.keys * place + 1])
    if point.instance < lamps.instances:
        for i in range(2):
            own = np.int64(lamps.by_instance[2 * point.instance + i])
            if own >= 0 and own != one:
                one, other = own, one
    return one, other


@compiled
@no_type_check
def lamp_ray(lamps, point, row, gloss):
    """Return the way to a lamp from the start of a shadow ray, its reach, and shares of the lamp's intensity.

    The reach is negative where no ray is needed; the shares, diffuse and specular, are 0 where no light arrives.
    `gloss` holds the edge factor and the width of highlights.
    """
    t, at = lamps.table, LIGHT_COLUMNS * row
    x, y, z = t[at] - point.px, t[at + 1] - point.py, t[at + 2] - point.pz
    wx, wy, wz = x - point.nx * BIAS, y - point.ny * BIAS, z - point.nz * BIAS
    carrier = np.int64(lamps.ids[LIGHT_IDS * row + CARRIER])
    own = carrier == point.instance and carrier != ARCHITECTURE and t[at + AREA] == ZERO
    square = max(x * x + y * y + z * z, NEAREST * NEAREST if own else LEAST_SQUARE)
    per = inverse_norm(x, y, z)
    x, y, z = x * per, y * per, z * per
    share = OWN_SHARE
    if not own:
        cosine = -(x * t[at + DIRECTION] + y * t[at + DIRECTION + 1] + z * t[at + DIRECTION + 2])
        share = _profile(cosine, t[at + EXPONENT], t[at + CUTOFF]) * surface_cosine(point, x, y, z)
    share = share / (square + t[at + AREA] * INVERSE_PI)
    if not (share > ZERO and t[at + POWER] > ZERO):
        return wx, wy, wz, -ONE, ZERO, ZERO
    reach = -ONE if own else ONE - RAY_END * min(inverse_norm(wx, wy, wz), ONE / RAY_END)
    return wx, wy, wz, reach, share, share * highlight(point, gloss, x, y, z)


@compiled
@no_type_check
def surface_cosine(point, x, y, z):
    """Return the cosine between the shading normal and a unit direction; 0 behind that or the geometric normal."""
    if not x * point.nx + y * point.ny + z * point.nz > ZERO:
        return ZERO
    return max(x * point.sx + y * point.sy + z * point.sz, ZERO)


@compiled
@no_type_check
def _profile(cosine, exponent, cutoff):
    """Return the share of a light's intensity at a cosine to its axis; 0 below the cutoff."""
    if not cosine >= cutoff:
        return ZERO
    if exponent == ZERO:
        return ONE
    if exponent == ONE:
        return max(cosine, LEAST_COSINE)
    return np.float32(math.exp(exponent * np.float32(math.log(max(cosine, LEAST_COSINE)))))


@compiled
@no_type_check
def highlight(point, gloss, x, y, z):
    """Return the specular BRDF [1/sr] over the reflectance at normal incidence; see `gloss.ggx`."""
    edge, alpha = gloss
    hx, hy, hz = x + point.vx, y + point.vy, z + point.vz
    per = inverse_norm(hx, hy, hz)
    hx, hy, hz = hx * per, hy * per, hz * per
    up = min(max(hx * point.sx + hy * point.sy + hz * point.sz, ZERO), ONE)
    light = min(max(x * point.sx + y * point.sy + z * point.sz, GRAZING), ONE)
    view = min(max(point.vx * point.sx + point.vy * point.sy + point.vz * point.sz, GRAZING), ONE)
    spread = ONE - up * up * (ONE - alpha * alpha)
    both = TWO * light * view
    flat = ONE - min(max(hx * x + hy * y + hz * z, ZERO), ONE)
    square = flat * flat
    fresnel = ONE + (edge - ONE) * (square * square * flat)
    density = alpha * alpha / (PI * spread * spread)
    return density * (HALF / (both + alpha * (light + view - both))) * fresnel
