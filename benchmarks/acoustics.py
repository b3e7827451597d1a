"""Compare sound with an independent Monte Carlo: decay times and levels per octave, in acoustically difficult rooms.

Each preset, and the first two with rays in every step, runs in the same rooms against the same reference. Prints a
Markdown table; `--out` writes one JSON object per line. The rooms and the oracle are those of the tests
(`tests/helpers/acoustic_rooms.py`, `tests/helpers/decay_oracle.py`).
"""

import argparse
import json
import sys
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))

import acoustic_rooms as rooms
from decay_oracle import fly

from home_mjx.audio_jax import (
    AudioConfig,
    BakeOptions,
    LateReverbBake,
    Listener,
    SoundSource,
    audio_preset,
    early_paths,
)
from home_mjx.audio_jax.auralization.response import late_energy
from home_mjx.audio_jax.base.options import Baked, Omni
from home_mjx.audio_jax.parameters import decay_time, edt, t30
from home_mjx.bank.bank import HouseBank
from home_mjx.houses import add_bakes
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.compiled import BANDS

PRESETS = ("fast", "balanced", "reference", "fast-traced", "balanced-traced", "baked")
SEEDS = {"fast-traced": 8, "balanced-traced": 4, "reference": 2}  # runs per listener; baked reverberation needs one
UPRIGHT = jnp.float32([0.5, 0.5, -0.5, -0.5])
LATE = (-25.0, -45.0)  # [dB] range in which coupled rooms decay together
ERRORS = ("T30 [s]", "here", "error", "EDT [s]", "here", "error", "Level error [dB]", "Late slope [s]", "here")
COLUMNS = ("Preset", "Room", "Octave [Hz]", *ERRORS)


def engine(scene_bank, house, source, listener, key, config):
    """Compute the histogram (bins, bands) of one omnidirectional microphone: paths and late part."""
    scene = opened(scene_bank, house)
    who, ears = SoundSource(source), Listener(listener, UPRIGHT)
    paths = early_paths(scene, who, ears, config)
    late = late_energy(scene, who, ears, key, config)[:, 0]
    at = (paths.distance / (config.bin_seconds * config.speed_of_sound)).astype(jnp.int32)
    return late.at[at].add(paths.gain**2, mode="drop")


def opened(bank, house):
    """Build the scene of a house without agents, with all doors fully open."""
    physics = bank.physics
    bodies, nobody = (physics.body_pos[house], physics.body_quat[house]), (jnp.zeros((0, 3)), jnp.zeros((0, 4)))
    return make_scene(bank, house, *bodies, *nobody, door_angle=physics.door_fully_open[house])


def config_of(preset, seconds):
    """Return options of an omnidirectional microphone with a response of `seconds`."""
    options = {"receiver": Omni(), "response_seconds": seconds}
    if preset == "baked":
        return AudioConfig(late=Baked(), **options)
    name, traced = preset.removesuffix("-traced"), preset.endswith("-traced")
    return audio_preset(name, **options, **({"late": "traced"} if traced else {}))


def heard(case, bank, config, seeds):
    """Compute histograms (seeds, listeners, bands, bins) in the only house of a bank."""
    run = jax.jit(jax.vmap(partial(engine, config=config), in_axes=(None, None, None, 0, 0)))
    source, house = jnp.asarray(case.source, jnp.float32), jnp.int32(0)
    keys = jax.random.split(jax.random.key(0), seeds * len(case.listeners)).reshape(seeds, -1)
    listeners = jnp.asarray(case.listeners, jnp.float32)
    energy = np.stack([np.asarray(run(bank, house, source, listeners, some)) for some in keys])
    return np.moveaxis(energy, 2, 3)


def places(case):
    """Return groups of listeners: all, or those of each of two rooms."""
    if not case.name.endswith("coupled"):
        return {case.name: slice(None)}
    return {f"{case.name}, source's room": slice(0, 3), f"{case.name}, other room": slice(3, None)}


def compare(name, truth, ours, dt):
    """Yield one record per octave; truth (listeners, bands, bins), ours (seeds, listeners, bands, bins)."""
    late = {"late": partial(decay_time, start=LATE[0], stop=LATE[1])} if "source's" in name else {}
    times = {"t30": t30, "edt": edt, **late}
    both = [jnp.asarray(x / x.max(), jnp.float32) for x in (truth, ours)]
    means = {n: [np.nanmean(f(e, dt).reshape(-1, len(BANDS)), axis=0) for e in both] for n, f in times.items()}
    level = 10 * np.log10(ours.mean(axis=(0, 1)).sum(axis=-1) / truth.mean(axis=0).sum(axis=-1))
    for band, octave in enumerate(BANDS):
        record = {"room": name, "octave": octave, "level_error": round(float(level[band]), 2)}
        for key, (right, here) in means.items():
            record |= {f"{key}_truth": round(float(right[band]), 3), key: round(float(here[band]), 3)}
        yield record


def cells(record):
    """Format one record as Markdown cells."""
    parts = [record["preset"], record["room"], f"{record['octave']:g}"]
    for key in ("t30", "edt"):
        right, here = record[f"{key}_truth"], record[key]
        parts += [f"{right:.2f}", f"{here:.2f}", f"{100 * (here / right - 1):+.0f} %"]
    late = [f"{record[key]:.2f}" if key in record else "" for key in ("late_truth", "late")]
    return [*parts, f"{record['level_error']:+.1f}", *late]


def main():
    """Run the selected comparisons."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--particles", type=int, default=100_000, help="particles of the oracle per octave")
    parser.add_argument("--presets", nargs="*", choices=PRESETS, default=PRESETS[:-1])
    parser.add_argument("--bake-seed", type=int, default=0, help="seed of baked late reverberation")
    parser.add_argument("--bake-rays", type=int, default=BakeOptions.rays, help="rays per cell")
    parser.add_argument(
        "--bake-size", type=float, default=BakeOptions.cell_size, help="target edge length of its cells [m]"
    )
    parser.add_argument("--rooms", nargs="*", help="rooms to measure, such as uneven (default: all)")
    parser.add_argument("--seconds", type=float, default=3.0, help="length of the decays")
    parser.add_argument("--out", type=Path, help="file that records are appended to")
    args = parser.parse_args()
    cases = [
        rooms.even(),
        rooms.uneven(),
        rooms.rising(),
        rooms.household(False),
        rooms.household(True),
        rooms.coupled(),
        rooms.small_coupled(),
    ]
    cases = [case for case in cases if not args.rooms or case.name in args.rooms]
    print("| " + " | ".join(COLUMNS) + " |\n|" + " --- |" * len(COLUMNS))
    for case in cases:
        for record in measure(case, args):
            print("| " + " | ".join(cells(record)) + " |", flush=True)
            if args.out:
                with args.out.open("a") as file:
                    file.write(json.dumps({**record, "particles": args.particles}) + "\n")


def measure(case, args):
    """Yield the records of one room, of all presets against one reference."""
    bank = HouseBank.from_compiled([case.house])
    dt = AudioConfig().bin_seconds
    truth = fly(case.blocks, case.source, case.listeners, args.seconds, dt, args.particles).energy
    for preset in args.presets:
        config = config_of(preset, args.seconds)
        if isinstance(config.late, Baked) and not bank.bakes:
            bank = add_bakes(
                bank, [case.house], LateReverbBake(BakeOptions(args.bake_size, args.bake_rays, seed=args.bake_seed))
            )
        ours = heard(case, bank, config, SEEDS.get(preset, 1))
        for name, group in places(case).items():
            for record in compare(name, truth[group], ours[:, group], dt):
                yield {"preset": preset, **record}


if __name__ == "__main__":
    main()
