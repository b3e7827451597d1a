"""`radiance.cu` without a GPU, in warps of 32 lanes on the CPU, against the same light by operations of JAX."""

import ctypes
import re
import types
from pathlib import Path

import jax
import numpy as np
import pytest
from compiled_kernels import nvrtc_ptx, shared_library
from lit_flat import VARIED, composed_radiance, glowing_bank, lit_bank, places, radiance

from home_mjx.raycast_render import LitShader
from home_mjx.raycast_render.light_kernel import cuda, light, surface
from home_mjx.raycast_render.lighting import specular
from home_mjx.raycast_render.scene import appearance
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.baked import BakedShader
from home_mjx.schema.compiled import RayKind

ON = types.SimpleNamespace(KERNEL=types.SimpleNamespace(is_usable=lambda platform: platform == "cuda"))
SOURCE = "".join(path.read_text() for path in cuda.SOURCES)


LISTED = re.search(r"#define LIGHT_OPERANDS(.*?)float \*light\b", SOURCE, re.S)[1].replace("\\\n", " ")  # operands


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The kernel as a function for the CPU."""
    text = SOURCE.replace("constexpr int BLOCK = 64;", "constexpr int BLOCK = 32;")
    kinds = [part.strip().rsplit("*", 1)[0] for part in LISTED.split(",") if part.strip()]
    kinds = [kind if kind.startswith("const") else "" for kind in kinds]
    for i, kind in enumerate(kinds):
        kinds[i] = kind or kinds[i - 1]
    given = ", ".join(f"({kind}*)p[{i}]" for i, kind in enumerate(kinds))
    text = (
        f'#define WITHOUT_CASTS\n#include "{Path(__file__).parents[2] / "helpers" / "warp_shim.h"}"\n{text}'
        + f"""
static void** p;
static void one() {{ shade_paths({given}, (float*)p[{len(kinds)}]); }}
extern "C" void run(void** arrays, int warps, int environments) {{
  p = arrays, gridDim = {{unsigned(warps), unsigned(environments), 1}};
  for (int e = 0; e < environments; ++e)
    for (int w = 0; w < warps; ++w) run_warp(w, e, one);
}}
"""
    )
    return shared_library(tmp_path_factory.mktemp("light"), text, "-ffp-contract=off")


@pytest.fixture
def emulated(library, monkeypatch):
    """The shaders call the kernel as on a GPU."""

    def launch(entry, ptx, grid, threads, shared, operands, results):
        def run(*arrays):
            given = [np.ascontiguousarray(x) for x in arrays]
            light = np.full(results[0].shape, np.nan, np.float32)
            pointers = [x.ctypes.data for x in (*given, light)]
            library.run((ctypes.c_void_p * len(pointers))(*pointers), 2 * grid[0], grid[1])
            return light

        plain = [x if x.dtype in ("float32", "uint32") else x.astype("int32") for x in operands]
        return (jax.pure_callback(run, results[0], *plain),)

    monkeypatch.setattr(cuda, "launch_ptx", launch)
    monkeypatch.setattr(cuda, "compile_kernels", lambda: "")
    monkeypatch.setattr(lit, "native", ON)
    monkeypatch.setattr(lit, "with_fallback_gradient", lambda fallback, kernels: kernels.get("cuda", fallback))


CASES = [
    (lit_bank, BakedShader(), None),
    (lit_bank, LitShader(num_lights=1), VARIED),
    (glowing_bank, LitShader(sun=0.0, max_specular_depth=1), None),
]


@pytest.mark.parametrize(("make_bank", "shader", "look"), CASES)
def test_the_kernel_computes_the_light_of_the_shaders(emulated, make_bank, shader, look):
    """Floats differ in the last digits; a texel, a mip level or a shadow's edge, in few pixels."""
    bank = make_bank()
    fused, objects = radiance(bank, places(bank), shader, look)
    composed = composed_radiance(shader, look is VARIED, make_bank)
    assert (objects >= 0).mean() > 0.1
    assert composed.std() > 0.05
    apart = np.abs(fused - composed).max(-1) > 2e-3 * (0.1 + composed.max(-1))
    assert apart.mean() < 2e-3


def test_operands_are_in_the_order_of_the_source():
    other = {"from_": "origin", "origin": "probe_origin", "step": "probe_step", "count": "probe_count"}
    other |= {"corner": "grid_corner", "triangle_hit": "hit_triangle", "u": "hit_u", "v": "hit_v"}
    other |= {"triangle": "corner"}  # of cast.cu
    assert len(set(cuda.NAMES)) == len(cuda.NAMES)
    assert re.findall(r"\*(\w+)", LISTED) == [*(other.get(name, name) for name in cuda.NAMES), "size"]


def test_constants_are_those_of_the_other_executor():
    told = dict(re.findall(r"(\b[A-Z][A-Z_0-9]+) = (0x[0-9A-F]+|[-\d.e]+)", SOURCE))
    for name in ("PROBE_OFFSET", "VIEW_OFFSET", "FACADE_GAP", "DEPTH", "BIAS", "RAY_END", "NEAREST", "LEAST_SQUARE"):
        assert float(told[name]) == pytest.approx(float(getattr(light, name))), name
    for name in ("OWN_SHARE", "LEAST_COSINE", "GRAZING", "ZENITH_UP", "ZENITH_LEVEL", "INVERSE_PI", "PI"):
        assert float(told[name]) == pytest.approx(float(getattr(light, name))), name
    for name in ("MIN_FACING", "FACING_RISE"):
        assert float(told[name]) == pytest.approx(float(getattr(light, name))), name
    columns = "POS", "INTENSITY", "POWER", "EXPONENT", "CUTOFF", "AREA", "LIGHT_COLUMNS", "CARRIER", "OBJECT"
    sky = "SKY_ZENITH", "SKY_HORIZON", "SKY_GROUND", "AMBIENT", "SUN_AIM", "SUN_COLOR", "CELL", "ARCHITECTURE"
    for name in (*columns, "LIGHT_IDS", *sky):
        assert int(told[name]) == getattr(light, name), name
    for name in ("TINY_SQUARE", "TINY_VOLUME", "MAX_DENSITY", "LEAST_FACING", "LEAST_SPECULAR"):
        assert float(told[name]) == pytest.approx(float(getattr(surface, name))), name
    for name in ("MULTIPLIER_1", "MULTIPLIER_2", "GOLDEN", "RED", "GREEN", "BLUE", "SWAP", "LAYER"):
        assert int(told[name], 0) == getattr(appearance, name), name
    assert float(told["HIT_EPSILON"]) == specular.HIT_EPSILON
    assert int(told["LIGHT"]) == RayKind.LIGHT
    glow = [float(told[f"GLOW_{name}"]) for name in ("RED", "GREEN", "BLUE")]
    assert glow == pytest.approx([x * lit.GLOW_RADIANCE for x in lit.GLOW_COLOR])


@pytest.mark.parametrize("capability", [80, 90, 120])
def test_nvrtc_compiles_it(tmp_path, monkeypatch, capability):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    ptx = nvrtc_ptx(cuda.SOURCES, capability, {"WITHOUT_CASTS": 1})
    assert ".entry shade_paths" in ptx
