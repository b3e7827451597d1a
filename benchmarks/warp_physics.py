"""Peer of `physics_rates.py`: MuJoCo Warp steps the same houses, with the same shapes, masses and contacts.

    python benchmarks/warp_physics.py [--houses ROOT] [--num-houses 64] [--measure 3] [--num-envs 4096] [--bodies 0 8]

MuJoCo Warp (`pip install mujoco-warp`) has one model for all of its worlds, so each of the first `--measure` houses is
measured separately. Its model is that of `impl="c"`: it has every static box, and MuJoCo Warp's broad phase selects.
Agents have random forces at each control step, because there is no controller. The graph of a control step is captured
once. Prints one JSON object per line; `overflow` reports dropped contacts or constraints.
"""

import argparse
import json
import statistics
import time

import jax.numpy as jnp
import mujoco
import numpy as np

import home_mjx
from home_mjx import physics
from home_mjx.physics import PhysicsSetup, Template
from home_mjx.physics.mjx.contact_slots import half_above_floor
from home_mjx.physics.mujoco.house_mjcf import HouseRows, house_mjcf
from home_mjx.schema.timing import Timing

STEPS, CALLS, SUBSTEPS = 20, 5, Timing().substeps
NCONMAX, NJMAX = 256, 1024  # maximum number of contacts and constraints of a world
PUSH = 4.0  # [m/s^2] acceleration by forces; agents then move at about 0.5 m/s
ITERATIONS = 6  # iterations of Newton's method and its line search, as in `PhysicsSetup`


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=64)
    parser.add_argument("--measure", type=int, default=3, help="number of houses, each measured separately")
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--bodies", type=int, nargs="+", default=[0, 8, 32])
    args = parser.parse_args()
    options = {"num_houses": args.num_houses, "max_bodies": max(args.bodies), "sensors": ("state",)}
    bank = home_mjx.make("PointNav-v0", args.houses, **options).params.bank
    config, begins = PhysicsSetup(), np.asarray(bank.navigation.start)
    for house in range(args.measure):
        for bodies in args.bodies:
            rows = rows_of(bank, house, bodies)
            model = mujoco.MjModel.from_xml_string(house_mjcf(config, rows))
            model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)  # not supported by MuJoCo Warp
            model.opt.iterations = model.opt.ls_iterations = ITERATIONS
            record = {"case": "physics/mujoco_warp", "house": house, "bodies": int(rows.body_valid.sum())}
            record |= {"doors": int(rows.door_valid.sum()), "statics": int((rows.collider_size > 0).all(-1).sum())}
            record |= measure(model, poses(bank, config, house, rows), begins[house], args.num_envs)
            print(json.dumps(record), flush=True)


def rows_of(bank, house: int, bodies: int) -> HouseRows:
    """Return a house's rows with its first bodies; doors only if all bodies are included."""
    tables = bank.physics.replace(collider_size=half_above_floor(bank.physics))  # as in `impl="c"`
    rows = {name: np.array(getattr(tables, name)[house]) for name in HouseRows._fields}
    rows["body_valid"][bodies:] = False
    rows["door_valid"][:] &= bodies == rows["body_valid"].shape[0]
    return HouseRows(**rows)


def poses(bank, config: PhysicsSetup, house: int, rows: HouseRows) -> np.ndarray:
    """Return the `qpos` of the model after a reset."""
    template = Template(config, bank.spec)
    state = physics.reset(template, bank, jnp.int32(house), bank.navigation.start[house, :1], jnp.zeros(1))
    used = np.concatenate([np.ones(4, bool), np.repeat(rows.body_valid, 7), rows.door_valid])
    return np.asarray(state.qpos)[used]


def measure(model, start: np.ndarray, begins: np.ndarray, num_envs: int) -> dict:
    """Measure milliseconds of a control step of all worlds, whose agents start at `begins`."""
    import mujoco_warp as mjw
    import warp as wp

    wp.config.quiet = True  # standard output is reserved for the records
    data = mujoco.MjData(model)
    data.qpos[:] = start
    mujoco.mj_forward(model, data)
    m, d = mjw.put_model(model), mjw.put_data(model, data, nworld=num_envs, nconmax=NCONMAX, njmax=NJMAX)
    m.opt.warn_overflow = 0  # warnings would print a line per world
    qpos = np.tile(data.qpos, (num_envs, 1)).astype(np.float32)
    qpos[:, :3] = begins[np.arange(num_envs) % len(begins)]
    d.qpos.assign(qpos)
    draw = np.random.default_rng(0)
    forces = np.zeros((STEPS, num_envs, model.nv), np.float32)
    pushes = model.body_mass[1] * np.array([PUSH, PUSH, 0, 0.1])
    forces[..., :4] = draw.uniform(-1, 1, (STEPS, num_envs, 4)) * pushes
    pushed = [wp.array(force, dtype=float) for force in forces]

    def advance():
        for _ in range(SUBSTEPS):
            mjw.step(m, d)

    begun = time.perf_counter()
    advance()
    wp.synchronize()
    compiled = time.perf_counter() - begun
    if wp.get_device().is_cuda:
        with wp.ScopedCapture() as capture:
            advance()
        advance = lambda: wp.capture_launch(capture.graph)  # noqa: E731
    times = []
    for _ in range(CALLS + 1):
        begun = time.perf_counter()
        for force in pushed:
            wp.copy(d.qfrc_applied, force)
            advance()
        wp.synchronize()
        times.append((time.perf_counter() - begun) / STEPS)
    seconds, z = statistics.median(times[1:]), d.qpos.numpy()[:, 2]
    record = {"num_envs": num_envs, "compile_s": round(compiled, 1), "ms": round(1e3 * seconds, 3)}
    record |= {
        "env_steps_per_s": round(num_envs / seconds),
        "physics_steps_per_s": round(num_envs * SUBSTEPS / seconds),
    }
    most = int(d.nacon.numpy()[0]), int(d.nefc.numpy().max())
    record |= {"contacts": most[0], "constraints": most[1], "overflow": most[0] > d.naconmax or most[1] > d.njmax}
    return record | {"fell": int((z < qpos[:, 2] - 1).sum()), "device": str(wp.get_device().name)}


if __name__ == "__main__":
    main()
