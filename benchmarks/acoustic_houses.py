"""Compare sound in generated houses with a reference of many more and longer rays, and on walks in steps of 5 cm.

Decays and levels of an omnidirectional microphone, in the source's room and in others, are compared with the preset
`reference` or, with `--truth`, with an independent Monte Carlo. All doors are open, and walls transmit nothing, because
rays do not cross them. Walks through all rooms report the largest change of an octave per step, silent places, and the
difference between two bakes with other seeds. Prints one JSON object per line; `--out` also writes them.
"""

import argparse
import json
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from acoustics import UPRIGHT, config_of, engine, opened
from house_truth import judged

from home_mjx.audio_jax import BakeOptions, LateReverbBake, Listener, SoundSource, early_paths
from home_mjx.audio_jax.base.options import Baked
from home_mjx.audio_jax.parameters import edt, t30
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.acoustics import LATE_REVERB
from home_mjx.houses import add_bakes
from home_mjx.houses.house_set import HouseSet

STEP = 0.05  # [m] step of a walk
EDGES = 8  # maximum number of edges for diffraction
LONGEST = 3.0  # [m] maximum length of a walk
MOST = 1.5  # [dB] maximum change of an octave in a step
SILENT = -90.0  # [dB] re the source at 1 m; lower levels count as silent
EARS = np.array([0.0, 0.0, 1.5])
WAYS = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])


class Plan:
    """Free positions of a house, and numbers of doors between rooms."""

    def __init__(self, house) -> None:
        self.navigation = house.navigation
        floor = self.navigation.floor[0]
        starts = np.asarray(self.navigation.start)
        self.starts = starts[np.abs(starts[:, 2] - floor) < 0.3]
        self.rooms = np.array([self.room(p) for p in self.starts])
        names = sorted(set(self.rooms.tolist()) - {-1})
        hops = self.navigation.room_hops
        self.source_room = max(names, key=lambda room: sum(max(hops[room, other], 0) for other in names))
        self.source = self.starts[self.rooms == self.source_room][0] + EARS - [0, 0, 0.3]
        self.hops, self.all_hops = hops[self.source_room], hops

    def room(self, point) -> int:
        """Return the room of a point; -1 if it is not free to stand."""
        column, row = np.floor((point[:2] - self.navigation.origin) / self.navigation.cell).astype(int)
        rows, columns = self.navigation.room[0].shape
        if not (0 <= row < rows and 0 <= column < columns) or self.navigation.region[0, row, column] < 0:
            return -1
        return int(self.navigation.room[0, row, column])

    def listeners(self, each=2):
        """Return ear positions in every room, and the doors between them and the source."""
        kept = [np.flatnonzero(self.rooms == room)[-each:] for room in sorted(set(self.rooms.tolist()) - {-1})]
        rows = np.concatenate(kept)
        return self.starts[rows] + EARS, np.maximum(self.hops[self.rooms[rows]], 0)

    def walks(self):
        """Yield ear positions every 5 cm along the axes from all starts, up to the first obstacle."""
        for start in self.starts:
            for way in WAYS:
                places = start + np.arange(0, LONGEST, STEP)[:, None] * way
                free = np.array([self.room(p) >= 0 for p in places])
                count = len(free) if free.all() else int(np.argmin(free))
                if count > 10:
                    yield places[:count] + EARS


def is_baked(preset):
    """Return whether a preset needs a baked bank."""
    return isinstance(config_of(preset, 1.0).late, Baked)


def tight(bank):
    """Return a bank whose walls and door leaves transmit no sound, as for rays."""
    solid = bank.materials.replace(transmission=jnp.zeros_like(bank.materials.transmission))
    bank = bank.replace(materials=solid)
    if LATE_REVERB not in bank.bakes:
        return bank
    late = bank.bakes[LATE_REVERB]
    late = late.replace(**{name: jnp.zeros_like(getattr(late, name)) for name in ("wall", "portal_leak")})
    return bank.replace(bakes=bank.bakes | {LATE_REVERB: late})


def straight(scene, source, listener, config):
    """Compute the energy of direct and diffracted sound per octave."""
    config = replace(config, early=replace(config.early, num_edges=EDGES))
    paths = early_paths(scene, SoundSource(source), Listener(listener, UPRIGHT), config)
    return jnp.sum(paths.gain[: 1 + config.early.num_edges] ** 2, axis=0)


def emptied(bank):
    """Return a bank whose movable bodies are far away."""
    return bank.replace(physics=bank.physics.replace(body_pos=bank.physics.body_pos - jnp.float32([0, 0, 100])))


def heard(bank, plan, config, keys):
    """Compute energies (places, bands, bins) at the listeners of a plan, averaged over keys."""
    source, house = jnp.asarray(plan.source, jnp.float32), jnp.int32(0)
    run = jax.jit(partial(engine, config=config))
    out = [
        np.mean([np.asarray(run(bank, house, source, jnp.asarray(p, jnp.float32), k)) for k in keys], axis=0)
        for p in plan.listeners()[0]
    ]
    return np.moveaxis(np.stack(out), 1, 2)


def errors(truth, ours, hops, dt, groups=None):
    """Yield one record per number of doors between; `groups` adds errors of energies that are summed per group.

    A decay starts where it is first within 20 dB of its largest bin. With few particles, the energy of a far room
    starts late and has peaks, so the EDT of single places is too short. Sums over many places of a room are reliable.
    """
    for doors in sorted(set(hops.tolist())):
        mine = hops == doors
        record = {"doors": int(doors), "places": int(mine.sum()), **_differences(truth[mine], ours[mine], dt)}
        if groups is not None:
            some = [mine & (groups == group) for group in np.unique(groups[mine])]
            both = (np.stack([x[one].sum(axis=0) for one in some]) for x in (truth, ours))
            record |= {f"rooms_{name}": value for name, value in _differences(*both, dt).items()}
            record["rooms"] = len(some)
        yield record


def _differences(truth, ours, dt):
    """Compute mean and RMS differences over places and octaves, of level [dB], T30 and EDT [%]."""
    found = {"level": 10 * np.log10(ours.sum(axis=2) / truth.sum(axis=2))}
    for name, read in (("t30", t30), ("edt", edt)):
        both = [np.asarray(read(jnp.asarray(x / x.max(), jnp.float32), dt)) for x in (ours, truth)]
        found[name] = 100 * (both[0] / both[1] - 1)
    out = {}
    for name, error in found.items():
        known, digits = error[np.isfinite(error)], 2 if name == "level" else 1
        if known.size:
            out[name] = round(float(known.mean()), digits)
            out[f"{name}_rms"] = round(float(np.sqrt((known**2).mean())), digits)
    return out


def decays(bank, plan, presets, refs, seconds, moved):
    """Yield records of levels, T30 and EDT; `moved` adds the effect of removing all movable bodies."""
    hops, best = plan.listeners()[1], config_of("reference", seconds)
    keys = jax.random.split(jax.random.key(7), refs + max(refs, 4))
    start = time.perf_counter()
    truth = heard(bank, plan, best, keys[:refs])
    print(f"reference: {len(hops)} places, {time.perf_counter() - start:.0f} s", flush=True)
    others = {preset: (bank, config_of(preset, seconds), 1 if is_baked(preset) else 4) for preset in presets}
    others["the reference again"] = bank, best, refs
    if moved:
        others["the reference, nothing movable"] = emptied(bank), best, refs
    for name, (where, config, count) in others.items():
        ours = heard(where, plan, config, keys[refs : refs + count])
        for record in errors(truth, ours, hops, config.bin_seconds):
            yield {"preset": name, **record}


def walked(banks, plan, preset, seconds, most):
    """Yield records of walks: step sizes in the source's room and in others, and the difference of two bakes."""
    config = config_of(preset, seconds)
    source, house = jnp.asarray(plan.source, jnp.float32), jnp.int32(0)

    def levels(bank, places, key):
        scene = opened(bank, house)
        whole = jax.vmap(lambda p: jnp.sum(engine(bank, house, source, p, key, config), axis=0))(places)
        return whole, jax.vmap(lambda p: straight(scene, source, p, config))(places)

    run, size = jax.jit(levels), round(LONGEST / STEP)
    steps, direct, quiet, places, apart = {True: [], False: []}, [], 0, 0, []
    for number, walk in enumerate(plan.walks()):
        if number >= most:
            break
        padded = jnp.asarray(np.pad(walk, ((0, size - len(walk)), (0, 0)), mode="edge"), jnp.float32)
        found = [run(bank, padded, jax.random.key(number)) for bank in banks]
        energy, early = (10 * np.log10(np.asarray(x)[: len(walk)] + 1e-12) for x in found[0])
        own = np.array([plan.hops[plan.room(p)] <= 0 for p in walk])
        change, bent = np.abs(np.diff(energy, axis=0)).max(axis=1), np.abs(np.diff(early, axis=0))
        for here in (True, False):
            steps[here] += change[(own[1:] & own[:-1]) == here].tolist()
        direct += bent[np.minimum(early[1:], early[:-1]) > -60].tolist()
        quiet, places = quiet + int((energy.max(axis=1) < SILENT).sum()), places + len(walk)
        if len(banks) > 1:
            other = 10 * np.log10(np.asarray(found[1][0])[: len(walk)] + 1e-12)
            apart.append(np.sqrt(np.mean((energy - other)[~own] ** 2) / 2) if (~own).any() else np.nan)
    for here, name in ((True, "source's room"), (False, "other rooms")):
        sizes = np.array(steps[here] or [0.0])
        share = 100 * float((sizes > MOST).mean())
        yield {
            "preset": preset,
            "walk": name,
            "steps": len(sizes),
            "above": round(share, 2),
            "largest": round(sizes.max(), 2),
        }
    yield {
        "preset": preset,
        "silent": quiet,
        "places": places,
        "direct_above": round(100 * float((np.array(direct or [0.0]) > MOST).mean()), 2),
        "direct_largest": round(float(np.max(direct or [0.0])), 2),
        "seed_sd": round(float(np.nanmean(apart)), 2) if apart else None,
    }


def main():
    """Run the selected comparisons."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--houses", default="procedural:1?seed=91000", help="dataset or generator; its first house is used"
    )
    parser.add_argument("--presets", nargs="*", default=["fast-traced", "baked"])
    parser.add_argument("--parts", nargs="*", choices=("decays", "moved", "walks"), default=("decays", "walks"))
    parser.add_argument("--truth", type=int, default=0, help="particles per octave of each half of the oracle")
    parser.add_argument("--sources", type=int, default=4, help="number of rooms with a source, with --truth")
    parser.add_argument("--each", type=int, default=2, help="number of listeners per room, with --truth")
    parser.add_argument("--rays", type=int, help="baked rays per cell")
    parser.add_argument("--refs", type=int, default=2, help="runs of the reference per place")
    parser.add_argument("--walks", type=int, default=10**6, help="maximum number of walks")
    parser.add_argument("--seconds", type=float, default=1.2, help="length of the responses")
    parser.add_argument("--out", type=Path, help="file that records are appended to")
    args = parser.parse_args()
    house = HouseSet(args.houses).load()[0]
    plan, bank = Plan(house), HouseBank.from_compiled([house])
    banks = [bank]
    if any(map(is_baked, args.presets)):
        start = time.perf_counter()
        banks = [
            add_bakes(bank, [house], LateReverbBake(BakeOptions(rays=args.rays, seed=seed)))
            for seed in range(1 + ("walks" in args.parts))
        ]
        cells = banks[0].bakes[LATE_REVERB].level.shape[1]
        print(f"baked {cells} cells {len(banks)} times in {time.perf_counter() - start:.0f} s", flush=True)
    found = []
    if "decays" in args.parts and args.truth:
        how = args.presets, args.seconds, args.truth, args.sources, args.each, EARS - [0, 0, 0.3]
        found.append(judged(house, tight(banks[0]), plan, *how, errors))
    elif "decays" in args.parts:
        found.append(decays(tight(banks[0]), plan, args.presets, args.refs, args.seconds, "moved" in args.parts))
    if "walks" in args.parts:
        found += [walked(banks if is_baked(p) else banks[:1], plan, p, args.seconds, args.walks) for p in args.presets]
    for part in found:
        for record in part:
            record = {"houses": args.houses, **record}
            print(json.dumps(record), flush=True)
            if args.out:
                with args.out.open("a") as file:
                    file.write(json.dumps(record) + "\n")


if __name__ == "__main__":
    main()
