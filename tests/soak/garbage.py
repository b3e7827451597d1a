"""Garbage in every array that rays and physics are given: native code has to end, and to stay within its arrays.

    python tests/soak/garbage.py [--parts rays physics] [--scenes N] [--seconds S] [--backend cpu|cuda|xla] [--seed N]
    compute-sanitizer python tests/soak/garbage.py --backend cuda --scenes 10000

A call has one bank full of garbage (trees, models, instances, materials, boxes, doors ...) and some scenes of it, each
with garbage of its own (house, what moves, rays; or poses, speeds, what is held, actions): random bits, numbers that
are none, indices just outside, values of other rows. Every twentieth call has no garbage and must give what the first
one gave. Programs are compiled once. Needs nothing but the package, so that it runs under NVIDIA's compute-sanitizer;
each array of a call has an allocation of its own then, so that nothing beside one is read unseen.

One JSON object a line for each part. Exits with 1 if a call gives something else, by a signal, or after `--stuck`
seconds if one does not end; `garbage.<part>` in the folder `--out` names the call then, and `--first` repeats it.
"""

import argparse
import faulthandler
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers")]
if __name__ == "__main__":  # before JAX is imported
    os.environ.setdefault("JAX_PLATFORMS", "cuda,cpu" if "cuda" in sys.argv else "cpu")
    os.environ.setdefault("XLA_PYTHON_CLIENT_ALLOCATOR", "platform")

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
from odd_numbers import garbled  # noqa: E402

from home_mjx import HouseBank, physics  # noqa: E402
from home_mjx.bank.records.gpu_geometry import gpu_geometry  # noqa: E402
from home_mjx.raycast_render import Scene, cast, make_scene, occluded  # noqa: E402
from home_mjx.raycast_render.casting.cast import cast_multi_hit  # noqa: E402

SCENES = 16  # of a call
INTACT = 20  # every so many calls one has no garbage

Tree = Any
Part = Callable[[str], tuple[Callable[..., Tree], Tree, Tree]]
"""Of a backend: what is called, what all scenes of a call share, and what each of them has (scenes ...)."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", nargs="+", choices=list(PARTS), default=list(PARTS))
    parser.add_argument("--scenes", type=int, default=1 << 62, help="of each part")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="of each part")
    parser.add_argument("--backend", choices=("cpu", "cuda", "xla"), default="cpu")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="call to begin with")
    parser.add_argument("--stuck", type=float, default=300.0, help="seconds after which a call does not end")
    parser.add_argument("--out", type=Path, default=Path("garbage-failures"))
    args = parser.parse_args(arguments)
    failed = 0
    for name in args.parts:
        record = attack(name, args)
        print(json.dumps(record), flush=True)
        failed += record["failed"]
    return int(failed > 0)


def attack(name: str, args: argparse.Namespace) -> dict[str, Any]:
    """One part: calls, until there were enough."""
    number, scenes, failed, finite = args.first, 0, 0, 0
    args.out.mkdir(parents=True, exist_ok=True)
    note = args.out / f"garbage.{name}"
    run, shared, own = PARTS[name](args.backend)
    right = as_numpy(run(shared, own))
    begun = told = time.monotonic()  # what compiles does not count
    while scenes < args.scenes and time.monotonic() - begun < args.seconds:
        note.write_text(f"--parts {name} --backend {args.backend} --seed {args.seed} --first {number}\n")
        faulthandler.dump_traceback_later(args.stuck, exit=True)
        is_intact = number % INTACT == INTACT - 1
        given = (shared, own) if is_intact else garbled(f"{name}:{args.seed}:{number}", shared, own)
        found = as_numpy(run(*given))
        faulthandler.cancel_dump_traceback_later()
        if is_intact and not equal(found, right):
            failed += 1
            print(f"call {number} without garbage gives something else", file=sys.stderr, flush=True)
        number, scenes, finite = number + 1, scenes + SCENES * (not is_intact), finite + numbers_in(found)
        if time.monotonic() - told > 20:
            told = time.monotonic()
            print(json.dumps({"part": name, "call": number, "scenes": scenes}), file=sys.stderr, flush=True)
    note.unlink(missing_ok=True)
    counts = {"calls": number - args.first, "scenes": scenes, "numbers": finite, "failed": failed}
    return {
        "part": name,
        "backend": args.backend,
        "seed": args.seed,
        **counts,
        "seconds": round(time.monotonic() - begun, 1),
    }


def as_numpy(tree: Tree) -> list[np.ndarray]:
    """All arrays, once they are there."""
    return [np.asarray(x) for x in jax.tree.leaves(tree)]


def equal(a: Sequence[np.ndarray], b: Sequence[np.ndarray]) -> bool:
    """Whether all bits are."""
    return all(x.tobytes() == y.tobytes() for x, y in zip(a, b, strict=True))


def numbers_in(found: Sequence[np.ndarray]) -> int:
    """How many of the results are finite."""
    return sum(int(np.isfinite(x).sum()) for x in found)


# What is called


def rays(backend: str) -> tuple[Callable[..., Tree], Tree, Tree]:
    """Casts of all kinds; of images, so that packets and tiles of rays are as in use."""
    from handmade import shoebox, two_rooms

    bank = HouseBank.from_compiled([shoebox(), two_rooms()])
    geometry, rng = bank.geometry.replace(gpu=None), np.random.default_rng(0)
    shared = geometry.replace(gpu=gpu_geometry(geometry)) if backend == "cuda" else geometry
    house = jnp.asarray(np.arange(SCENES) % bank.num_houses, jnp.int32)
    agent = jnp.zeros((2, 3), jnp.float32).at[1].set(1.0), jnp.tile(jnp.array([1.0, 0, 0, 0], jnp.float32), (2, 1))
    body = bank.physics.body_pos, bank.physics.body_quat
    place = jax.vmap(lambda h: make_scene(bank, h, body[0][h], body[1][h], *agent).moving)
    count = (SCENES, 6, 9)
    beam = {
        "origin": f32(rng.uniform(-1, 1, (*count, 3)) + np.array([0, 0, 1.5])),
        "direction": f32(rng.normal(size=(*count, 3))),
        "t_min": f32(np.zeros(count)),
        "t_max": f32(np.full(count, np.inf)),
        "exclude": jnp.full(count, -1, jnp.int32),
        "mask": jnp.full(count, 7, jnp.int32),
    }
    rest = bank.replace(geometry=geometry)

    @jax.jit
    def run(shared: Tree, own: Tree) -> Tree:
        def one(house: jax.Array, moving: Tree, beam: dict[str, jax.Array]) -> Tree:
            scene = Scene(bank=rest.replace(geometry=shared), house=house, moving=moving)
            every = cast_multi_hit(scene, **beam, num_hits=4, hit_epsilon=1e-4, backend=backend)
            return cast(scene, **beam, backend=backend), occluded(scene, **beam, backend=backend), every

        return jax.vmap(one)(*own)

    return run, shared, (house, jax.jit(place)(house), beam)


def steps(backend: str) -> tuple[Callable[..., Tree], Tree, Tree]:
    """Control steps of the compiled physics, of boxes, doors and what is held."""
    from rollouts import SCENES as HOUSES
    from tiny_houses import make_bank

    del backend  # programs are lowered for the platform
    bank = make_bank(list(HOUSES.values()))
    template = physics.Template(physics.PhysicsConfig(impl="fused"), bank.spec)
    house = jnp.asarray(np.arange(SCENES) % bank.num_houses, jnp.int32)

    def reset(h: jax.Array) -> Tree:
        feet = jnp.zeros((1, 3), jnp.float32).at[0, 2].set(bank.physics.floor[h])
        return physics.reset(template, bank, h, feet, jnp.zeros(1, jnp.float32))

    @jax.jit
    def run(shared: Tree, own: Tree) -> Tree:
        full = bank.replace(physics=shared)
        return jax.vmap(lambda h, state, action: physics.step(template, full, h, state, action))(*own)

    action = f32(np.random.default_rng(0).uniform(-1, 1, (SCENES, 1, 3)))
    return run, bank.physics, (house, jax.jit(jax.vmap(reset))(house), action)


def f32(x: np.ndarray) -> jax.Array:
    return jnp.asarray(x, jnp.float32)


PARTS: dict[str, Part] = {"rays": rays, "physics": steps}

if __name__ == "__main__":
    faulthandler.enable()
    sys.exit(main())
