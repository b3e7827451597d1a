"""Compare moving listeners in one room: frames per second here and responses per second of pyroomacoustics, in one run.

Its hybrid method (image sources of order 3, 10,000 rays, air) computes one response of two microphones. Here the unit
is a response and the 0.1 s of crossfaded stereo sound, with the preset `balance_rows`. Both use all cores. HoME's EVERT
made 117 listener updates per second of order 2, without late reverberation, of a fixed source. Needs `pip install
pyroomacoustics`; run it on otherwise idle cores.
"""

import argparse
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))

import acoustic_rooms as rooms

from home_mjx.audio_jax import Listener, SoundSource, audio_preset
from home_mjx.audio_jax.auralization.clips import clip_samples
from home_mjx.audio_jax.moving_sources.frames import render_frame
from home_mjx.audio_jax.moving_sources.receiver_state import render_receiver_state
from home_mjx.bank.bank import HouseBank
from home_mjx.core.profiling import calls_per_second, compiled, device_name
from home_mjx.core.workers import usable_cores
from home_mjx.houses import add_bakes
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.compiled import BANDS

SIZE = (6.0, 5.0, 3.0)  # [m] size of the room
FLOOR, ELSEWHERE, SCATTERING = 0.6, 0.03, 0.1  # absorption and scattering of the room "uneven"
STEP, EARS = 0.1, 0.0875  # [m] movement of a listener in a frame, and distance of an ear from the head's centre
RAYS, ORDER, EVERT = 10_000, 3, 117


def here(envs, seconds, preset):
    """Measure frames per second with `envs` environments."""
    case, config = rooms.uneven(), audio_preset(preset)
    bank = add_bakes(HouseBank.from_compiled([case.house]), [case.house], "late_reverb")
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    physics, upright = bank.physics, jnp.float32([0.5, 0.5, -0.5, -0.5])
    clip = jnp.asarray(clip_samples("radio", config))[: config.memory_length - 1 + config.frame + config.num_lookahead]

    def hear(place):
        scene = make_scene(bank, jnp.int32(0), physics.body_pos[0], physics.body_quat[0], *nobody)
        return render_receiver_state(
            scene, SoundSource(jnp.float32(case.source)), Listener(place, upright), jax.random.key(0), config
        )

    def step(place, old):
        new = hear(place)
        return render_frame(clip, old, new, config), new

    places = jnp.asarray(listeners(envs), jnp.float32)
    old = jax.jit(jax.vmap(hear))(places - jnp.float32([STEP, 0, 0]))
    program, _ = compiled(jax.vmap(step), places, old)
    return envs * calls_per_second(program, places, old, seconds=seconds)


def listeners(count):
    """Return positions (count, 3) [m] from the room's centre, half a metre from its surfaces."""
    low, high = np.array([-SIZE[0] / 2, -SIZE[1] / 2, 0.0]) + 0.5, np.array([SIZE[0] / 2, SIZE[1] / 2, SIZE[2]]) - 0.5
    return np.random.default_rng(0).uniform(low, high, (count, 3))


def responses(places):
    """Compute a response per place with pyroomacoustics; return the length of the last one [samples]."""
    import pyroomacoustics as pra

    rate, middle = audio_preset("balanced").sample_rate, np.array([SIZE[0] / 2, SIZE[1] / 2, 0])
    octaves = {"center_freqs": list(BANDS)}
    walls = dict.fromkeys(("east", "west", "north", "south", "ceiling"), ELSEWHERE) | {"floor": FLOOR}
    materials = {
        name: pra.Material(
            {"coeffs": [value] * len(BANDS), **octaves}, {"coeffs": [SCATTERING] * len(BANDS), **octaves}
        )
        for name, value in walls.items()
    }
    for place in places:
        room = pra.ShoeBox(SIZE, rate, max_order=ORDER, materials=materials, ray_tracing=True, air_absorption=True)
        room.set_ray_tracing(n_rays=RAYS, receiver_radius=0.5)
        room.add_source(rooms.SOURCE + middle)
        ears = place + middle + np.array([[0, EARS, 0], [0, -EARS, 0]])
        room.add_microphone_array(ears.T)
        room.compute_rir()
    return max(len(x[0]) for x in room.rir)


def theirs(count):
    """Measure its responses per second on all cores, with `count` responses each."""
    cores = usable_cores()
    parts = np.split(listeners(cores * count), cores)
    with ProcessPoolExecutor(cores) as pool:
        list(pool.map(responses, [part[:1] for part in parts]))
        start = time.perf_counter()
        length = max(pool.map(responses, parts))
        return cores * count / (time.perf_counter() - start), length


def main():
    """Run both measurements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--peer-updates", type=int, default=8, help="number of responses per core")
    parser.add_argument("--out", type=Path, help="file that records are appended to")
    args = parser.parse_args()
    peer, length = theirs(args.peer_updates)
    records = [{"case": "pyroomacoustics hybrid", "updates": round(peer, 2), "rays": RAYS, "samples": length}]
    for preset in ("fast", "balanced"):
        rate = here(args.envs, args.seconds, preset)
        ratios = {"by_pyroomacoustics": round(rate / peer, 1), "by_evert": round(rate / EVERT, 1)}
        records.append({"case": preset, "updates": round(rate, 1), "environments": args.envs, **ratios})
    for record in records:
        record |= {"device": device_name()}
        print(json.dumps(record))
        if args.out:
            with args.out.open("a") as file:
                file.write(json.dumps(record) + "\n")


if __name__ == "__main__":
    main()
