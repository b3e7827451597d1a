"""The peer of `physics_rates.py`: MuJoCo Warp steps the same houses, with the same shapes, masses and contacts.

    python benchmarks/warp_physics.py [--houses ROOT] [--num-houses 64] [--measure 3] [--num-envs 4096] [--bodies 0 8]

MuJoCo Warp (`pip install mujoco-warp`) has one model for all of its worlds, so each of the first `--measure` houses is
measured by itself. Its model is that of `impl="c"`: every static box is there, and MuJoCo Warp's broad phase chooses.
Agents get drawn forces, anew for each control step, as nothing steers them. The graph of a control step is captured
once. One JSON object a line; `overflow` says whether contacts or constraints did not find room.
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
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.physics.mjx.slots import half_above_floor
from home_mjx.physics.mujoco.mjcf import Rows, house_mjcf
from home_mjx.schema.timing import Timing

STEPS, CALLS, SUBSTEPS = 20, 5, Timing().substeps
NCONMAX, NJMAX = 256, 1024  # contacts and constraints that a world has room for
PUSH = 4.0  # [m/s^2]; an agent under such forces moves at about half a metre a second
ITERATIONS = 6  # of Newton's method and of its line search, as in `PhysicsConfig`


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=64)
    parser.add_argument("--measure", type=int, default=3, help="houses, each by itself")
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--bodies", type=int, nargs="+", default=[0, 8, 32])
    args = parser.parse_args()
    options = {"num_houses": args.num_houses, "max_bodies": max(args.bodies), "sensors": ("state",)}
    bank = home_mjx.make("PointNav-v0", args.houses, **options).params.bank
    config, begins = PhysicsConfig(), np.asarray(bank.navigation.start)
    for house in range(args.measure):
        for bodies in args.bodies:
            rows = rows_of(bank, house, bodies)
            model = mujoco.MjModel.from_xml_string(house_mjcf(config, rows))
            model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)  # is not known to MuJoCo Warp
            model.opt.iterations = model.opt.ls_iterations = ITERATIONS
            record = {"case": "physics/mujoco_warp", "house": house, "bodies": int(rows.body_valid.sum())}
            record |= {"doors": int(rows.door_valid.sum()), "statics": int((rows.collider_size > 0).all(-1).sum())}
            record |= measure(model, poses(bank, config, house, rows), begins[house], args.num_envs)
            print(json.dumps(record), flush=True)


def rows_of(bank, house: int, bodies: int) -> Rows:
    """A house's rows with its first bodies; doors only beside all bodies that the bank has room for."""
    tables = bank.physics.replace(collider_size=half_above_floor(bank.physics))  # as `impl="c"` does
    rows = {name: np.array(getattr(tables, name)[house]) for name in Rows._fields}
    rows["body_valid"][bodies:] = False
    rows["door_valid"][:] &= bodies == rows["body_valid"].shape[0]
    return Rows(**rows)


def poses(bank, config: PhysicsConfig, house: int, rows: Rows) -> np.ndarray:
    """`qpos` of the model, where everything stands after a reset."""
    template = Template(config, bank.spec)
    state = physics.reset(template, bank, jnp.int32(house), bank.navigation.start[house, :1], jnp.zeros(1))
    used = np.concatenate([np.ones(4, bool), np.repeat(rows.body_valid, 7), rows.door_valid])
    return np.asarray(state.qpos)[used]


def measure(model, start: np.ndarray, begins: np.ndarray, num_envs: int) -> dict:
    """Milliseconds of a control step of all worlds, whose agents begin at `begins`."""
    import mujoco_warp as mjw
    import warp as wp

    wp.config.quiet = True  # standard output is for the records
    data = mujoco.MjData(model)
    data.qpos[:] = start
    mujoco.mj_forward(model, data)
    m, d = mjw.put_model(model), mjw.put_data(model, data, nworld=num_envs, nconmax=NCONMAX, njmax=NJMAX)
    m.opt.warn_overflow = 0  # prints a line per world
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
