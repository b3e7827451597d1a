"""Light at surfaces in chunks of pixels, as C functions for `core.native.handler`."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import cfunc, types

from home_mjx.core.native import ffi, memory
from home_mjx.core.native.ffi import OPERANDS, RESULTS, dim
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.raycast_render.light_kernel import light, operands, surface
from home_mjx.raycast_render.light_kernel.light import (
    AMBIENT,
    CELL,
    INTENSITY,
    INVERSE_PI,
    LIGHT_COLUMNS,
    LIGHT_IDS,
    OBJECT,
    SUN_AIM,
    SUN_COLOR,
    BakedHouse,
    LampChoice,
)
from home_mjx.raycast_render.light_kernel.surface import LEAST_SPECULAR, ONE, TWO, ZERO, Episode, Tables
from home_mjx.raycast_render.lighting import gloss, lights, probes, texture
from home_mjx.raycast_render.scene import appearance

CHUNK = 512  # pixels
_P = operands.PLACE
TRIANGLE, UV, NORMAL, SLOT, PART, INVERSE, MATERIAL, SEMANTIC = (_P[name] for name in operands.SURFACES)
SEMANTICS, ALBEDO, SPECULAR, SHININESS, TEXTURE, TEXTURES = (_P[name] for name in operands.MATERIALS)
FIRST, ORIGIN, STEP, COUNT, CHART_START, CHART, CHART_FRAME, CHART_COUNT, CHART_FIRST = (_P[x] for x in operands.BAKES)
MODEL, MODEL_TRIANGLE, GRID, FLOOR, CORNER = (_P[name] for name in operands.PLACES)
PROBE, TEXEL = (_P[name] for name in operands.MIXED)
HOUSE, MOVING_SLOT, MOVING_INVERSE, MOVING_MATERIAL, MOVING_SEMANTIC, LOOK, LOOK_IDS = (
    _P[name] for name in operands.ENVIRONMENT
)
LIGHTS, LIGHT_ROWS, BY_ROOM, BY_INSTANCE, SKY, GROWTH = (_P[name] for name in operands.LAMPS)
T, INSTANCE, HIT_TRIANGLE, HIT_U, HIT_V, FRONT, FROM, DIRECTION, FOOTPRINT = (_P[name] for name in operands.RAYS)
BAKED, LAMPS, PACKED, SUN, SUNNY = range(len(operands.ATTRIBUTES))
BASE, START, WAY, REACH, EXCLUDE, SHARE = range(len(operands.RESULTS))
INF = np.float32(np.inf)

Pointer = Any
floats, ints, words = map(pointer_to, (types.float32, types.int32, types.uint32))
compiled = compile_inner()


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Return the C functions `count` (chunks of a call) and `work` (of a job), compiled or from Numba's disk cache."""
    # The cache checks this file only. The functions refer to the digest, so that a change of the others invalidates it.
    kernel: tuple[Any, ...] = (ffi, memory, light, operands, surface)
    constants: tuple[Any, ...] = (appearance, gloss, lights, probes, texture)  # modules whose values are compiled in
    digest = ffi.hash_sources(*(part.__file__ for part in (*kernel, *constants)))

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of chunks of a call: those of one environment times the environments."""
        _ = digest
        return dim(frame, RESULTS, BASE, 0) * _pieces(frame)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Shade chunks of a job until none is left; return 0."""
        _ = digest
        ffi.run_chunks(job, _shade_chunk)
        return 0

    return count, work


@compiled
@no_type_check
def _pieces(frame):
    """Return the number of chunks of one environment."""
    return -(-dim(frame, RESULTS, BASE, 1) // CHUNK)


@compiled
@no_type_check
def _shared_floats(frame, index):
    """Return a pointer to the float operand `index`, which environments share."""
    return floats(ffi.data(frame, OPERANDS, index))


@compiled
@no_type_check
def _shared_ints(frame, index):
    """Return a pointer to the integer operand `index`, which environments share."""
    return ints(ffi.data(frame, OPERANDS, index))


@compiled
@no_type_check
def _tables(frame):
    """Return the call's `Tables`."""
    texels, edge = dim(frame, OPERANDS, TEXTURES, 1), 1
    while (4 * edge * edge - 1) // 3 < texels:
        edge *= 2
    return Tables(
        _shared_floats(frame, TRIANGLE),
        _shared_floats(frame, UV),
        _shared_floats(frame, NORMAL),
        _shared_ints(frame, SLOT),
        _shared_ints(frame, PART),
        _shared_floats(frame, INVERSE),
        _shared_ints(frame, MATERIAL),
        _shared_ints(frame, SEMANTIC),
        _shared_ints(frame, SEMANTICS),
        _shared_floats(frame, ALBEDO),
        _shared_floats(frame, SPECULAR),
        _shared_floats(frame, SHININESS),
        _shared_ints(frame, TEXTURE),
        words(ffi.data(frame, OPERANDS, TEXTURES)),
        dim(frame, OPERANDS, INVERSE, 1),
        dim(frame, OPERANDS, SEMANTICS, 1),
        dim(frame, OPERANDS, TEXTURES, 0),
        texels,
        edge,
    )


@compiled
@no_type_check
def _episode(frame, env, house):
    """Return the `Episode` of environment `env`."""
    look, ids = ffi.float_row(frame, LOOK, env), ffi.int_row(frame, LOOK_IDS, env)
    return Episode(
        house,
        ffi.int_row(frame, MOVING_SLOT, env),
        ffi.float_row(frame, MOVING_INVERSE, env),
        ffi.int_row(frame, MOVING_MATERIAL, env),
        ffi.int_row(frame, MOVING_SEMANTIC, env),
        ffi.float_row(frame, GROWTH, env)[0],
        look[0],
        look[1],
        np.int64(ids[0]) & surface.MASK,
        np.int64(ids[1]),
    )


@compiled
@no_type_check
def _bake(frame, env, house, sky):
    """Return the `BakedHouse` of environment `env`."""
    packed = ffi.attribute(frame, PACKED) != 0
    probes, texels = dim(frame, OPERANDS, PROBE, 0), dim(frame, OPERANDS, TEXEL, 0)
    houses = dim(frame, OPERANDS, FIRST, 0)
    own = np.int64(0) if packed else house
    return BakedHouse(
        ffi.float_row(frame, PROBE, env if packed else 0),
        ffi.float_row(frame, TEXEL, env if packed else 0),
        words(ffi.row(frame, OPERANDS, PROBE, env if packed else 0)),
        words(ffi.row(frame, OPERANDS, TEXEL, env if packed else 0)),
        packed,
        own * (probes // houses),
        own * (texels // houses),
        ffi.int_row(frame, FIRST, house),
        ffi.float_row(frame, ORIGIN, house),
        ffi.float_row(frame, STEP, house),
        ffi.int_row(frame, COUNT, house),
        ffi.int_row(frame, CHART_START, house),
        ffi.int_row(frame, CHART, house),
        ffi.float_row(frame, CHART_FRAME, house),
        ffi.int_row(frame, CHART_COUNT, house),
        ffi.int_row(frame, CHART_FIRST, house),
        ffi.int_row(frame, MODEL, house),
        _shared_ints(frame, MODEL_TRIANGLE),
        ffi.int_row(frame, GRID, house),
        ffi.float_row(frame, FLOOR, house),
        ffi.float_row(frame, CORNER, house),
        dim(frame, OPERANDS, CHART_START, 1),
        dim(frame, OPERANDS, CHART, 1),
        dim(frame, OPERANDS, GRID, 1),
        dim(frame, OPERANDS, GRID, 2),
        dim(frame, OPERANDS, GRID, 3),
        sky[CELL],
    )


@compiled
@no_type_check
def _lamps(frame, env):
    """Return the `LampChoice` of environment `env`."""
    return LampChoice(
        ffi.float_row(frame, LIGHTS, env),
        ffi.int_row(frame, LIGHT_ROWS, env),
        ffi.int_row(frame, BY_ROOM, env),
        ffi.int_row(frame, BY_INSTANCE, env),
        ffi.float_row(frame, SKY, env),
        dim(frame, OPERANDS, BY_ROOM, 1) - 1,
        dim(frame, OPERANDS, BY_ROOM, 2),
        dim(frame, OPERANDS, BY_INSTANCE, 1),
    )


class Pixels(NamedTuple):
    """Pointers to the camera rays of one environment, to their hits and to the results, and numbers of rays."""

    t: Pointer
    instance: Pointer
    triangle: Pointer
    u: Pointer
    v: Pointer
    front: Pointer
    origin: Pointer
    direction: Pointer
    footprint: Pointer
    base: Pointer
    start: Pointer
    way: Pointer
    reach: Pointer
    exclude: Pointer
    share: Pointer
    count: np.int64  # pixels
    rays: np.int64  # shadow rays per pixel
    lamps: np.int64  # of which to lamps
    sun: np.bool_
    baked: np.bool_
    sunny: np.bool_


@compiled
@no_type_check
def _pixels(frame, env):
    """Return the `Pixels` of environment `env`."""
    return Pixels(
        ffi.float_row(frame, T, env),
        ffi.int_row(frame, INSTANCE, env),
        ffi.int_row(frame, HIT_TRIANGLE, env),
        ffi.float_row(frame, HIT_U, env),
        ffi.float_row(frame, HIT_V, env),
        ffi.int_row(frame, FRONT, env),
        ffi.float_row(frame, FROM, env),
        ffi.float_row(frame, DIRECTION, env),
        ffi.float_row(frame, FOOTPRINT, env),
        ffi.float_result(frame, BASE, env),
        ffi.float_result(frame, START, env),
        ffi.float_result(frame, WAY, env),
        ffi.float_result(frame, REACH, env),
        ffi.int_result(frame, EXCLUDE, env),
        ffi.float_result(frame, SHARE, env),
        dim(frame, RESULTS, BASE, 1),
        dim(frame, RESULTS, REACH, 1),
        np.int64(ffi.attribute(frame, LAMPS)),
        ffi.attribute(frame, SUN) != 0,
        ffi.attribute(frame, BAKED) != 0,
        ffi.attribute(frame, SUNNY) != 0,
    )


@compiled
@no_type_check
def _shade_chunk(frame, chunk):
    """Shade the pixels of a chunk: `CHUNK` of one environment, or those that are left for the last."""
    pieces = _pieces(frame)
    env, first = chunk // pieces, (chunk % pieces) * CHUNK
    house = min(max(np.int64(ffi.int_row(frame, HOUSE, env)[0]), 0), dim(frame, OPERANDS, FIRST, 0) - 1)
    pixels, lamps = _pixels(frame, env), _lamps(frame, env)
    tables, episode, bake = _tables(frame), _episode(frame, env, house), _bake(frame, env, house, lamps.sky)
    for pixel in range(first, min(first + CHUNK, pixels.count)):
        _shade_pixel(pixels, pixel, tables, episode, bake, lamps)


@compiled
@no_type_check
def _shade_pixel(pixels, pixel, tables, episode, bake, lamps):
    """Write the results of one pixel: its light without shadow rays, and these with what they bring if unblocked."""
    at, base = 3 * pixel, pixels.base
    instance = pixels.instance[pixel]
    if instance < 0:
        base[at] = base[at + 1] = base[at + 2] = ZERO
        for k in range(pixels.rays):
            _no_ray(pixels, k * pixels.count + pixel)
        return
    o, d, triangle = pixels.origin, pixels.direction, max(pixels.triangle[pixel], 0)
    ray = (o[at], o[at + 1], o[at + 2], d[at], d[at + 1], d[at + 2], pixels.footprint[pixel])
    hit = (pixels.t[pixel], instance, triangle, pixels.u[pixel], pixels.v[pixel])
    point = surface.describe_surface(tables, episode, ray, hit)
    room = light.find_room(bake, point)
    chart = light.find_chart(bake, point, triangle, pixels.front[pixel] != 0)
    if chart >= 0:
        red, green, blue = light.texel_light(bake, point, chart)
    else:
        red, green, blue = light.probe_light(bake, lamps.sky, point, room)
    scale = lamps.sky[AMBIENT] * INVERSE_PI
    base[at] = point.red * red * scale
    base[at + 1] = point.green * green * scale
    base[at + 2] = point.blue * blue * scale
    _write_rays(pixels, pixel, tables, lamps, point, room, chart >= 0 and pixels.baked)


@compiled
@no_type_check
def _write_rays(pixels, pixel, tables, lamps, point, room, charted):
    """Write the shadow rays of one pixel."""
    s = tables.specular
    top = max(max(s[3 * point.row], s[3 * point.row + 1]), s[3 * point.row + 2])
    gloss = (ONE / max(top, LEAST_SPECULAR), np.sqrt(TWO / (tables.shininess[point.row] + TWO)))
    one, other = light.choose_lamps(lamps, point, room)
    for k in range(pixels.rays):
        place, row = k * pixels.count + pixel, one if k == 0 else other
        if k < pixels.lamps:
            if charted or row < 0:
                _no_ray(pixels, place)
            else:
                _write_lamp_ray(pixels, place, tables, lamps, point, row, gloss)
        elif not pixels.sun or (charted and pixels.sunny):
            _no_ray(pixels, place)
        else:
            _write_sun_ray(pixels, place, tables, lamps, point, gloss)


@compiled
@no_type_check
def _no_ray(pixels, place):
    """Write a shadow ray that brings nothing."""
    pixels.reach[place], pixels.exclude[place] = -ONE, np.int32(-1)
    for i in range(3 * place, 3 * place + 3):
        pixels.start[i] = pixels.way[i] = pixels.share[i] = ZERO


@compiled
@no_type_check
def _write_lamp_ray(pixels, place, tables, lamps, point, row, gloss):
    """Write the shadow ray to a lamp."""
    x, y, z, far, diffuse, specular = light.lamp_ray(lamps, point, row, gloss)
    t, at = lamps.table, LIGHT_COLUMNS * row + INTENSITY
    _write_ray(pixels, place, point, (x, y, z), far, lamps.ids[LIGHT_IDS * row + OBJECT])
    _write_share(pixels, place, tables, point, (t[at], t[at + 1], t[at + 2]), diffuse, specular)


@compiled
@no_type_check
def _write_sun_ray(pixels, place, tables, lamps, point, gloss):
    """Write the shadow ray to the sun."""
    sky = lamps.sky
    x, y, z = sky[SUN_AIM], sky[SUN_AIM + 1], sky[SUN_AIM + 2]
    diffuse = light.surface_cosine(point, x, y, z)
    _write_ray(pixels, place, point, (x, y, z), INF if diffuse > ZERO else -ONE, np.int32(-1))
    color = (sky[SUN_COLOR], sky[SUN_COLOR + 1], sky[SUN_COLOR + 2])
    specular = diffuse * light.highlight(point, gloss, x, y, z) if diffuse > ZERO else ZERO
    _write_share(pixels, place, tables, point, color, diffuse, specular)


@compiled
@no_type_check
def _write_ray(pixels, place, point, way, reach, exclude):
    """Write a shadow ray."""
    at = 3 * place
    pixels.start[at] = point.px + point.nx * light.BIAS
    pixels.start[at + 1] = point.py + point.ny * light.BIAS
    pixels.start[at + 2] = point.pz + point.nz * light.BIAS
    pixels.way[at], pixels.way[at + 1], pixels.way[at + 2] = way
    pixels.reach[place], pixels.exclude[place] = reach, exclude


@compiled
@no_type_check
def _write_share(pixels, place, tables, point, color, diffuse, specular):
    """Write the radiance that an unblocked ray brings, from the light's colour and shares of it."""
    s, at = tables.specular, 3 * place
    diffuse = diffuse * INVERSE_PI
    pixels.share[at] = color[0] * (point.red * diffuse + s[3 * point.row] * specular)
    pixels.share[at + 1] = color[1] * (point.green * diffuse + s[3 * point.row + 1] * specular)
    pixels.share[at + 2] = color[2] * (point.blue * diffuse + s[3 * point.row + 2] * specular)
