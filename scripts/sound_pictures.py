"""Draws the pictures of docs/sound.md.

python scripts/sound_pictures.py                                 docs/images/sound_*.png, of a generated house
python scripts/sound_pictures.py map --dataset ROOT --out local/sound   of another dataset, not for the docs
"""

import argparse
import sys
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import matplotlib
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "benchmarks"))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))

import acoustic_rooms as rooms
from acoustics import PRESETS, UPRIGHT, config_of, heard
from decay_oracle import fly

from home_mjx.audio_jax import (
    AudioConfig,
    BakeOptions,
    Listener,
    Source,
    baked_sound,
    early_paths,
    with_late_sound,
)
from home_mjx.bank.bank import HouseBank
from home_mjx.cli.floors import storey_pictures
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.scene_compile.cache.house_set import HouseSet
from home_mjx.viz.media import write_png

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parent.parent
GENERATED = "procedural:1?seed=91001"
OCTAVES = {125: 0, 1000: 3, 8000: 6}
KHZ = OCTAVES[1000]
EARS = np.array([0.0, 0.0, 1.5])
DPI = 80


def scene_of(bank, angle=None):
    """The first house of a bank, doors as wide open as they get if no angles are given."""
    physics = bank.physics
    angle = physics.door_wide[0] if angle is None else angle
    nobody = jnp.zeros((0, 3)), jnp.zeros((0, 4))
    return make_scene(bank, jnp.int32(0), physics.body_pos[0], physics.body_quat[0], *nobody, door_angle=angle)


def falling(energy):
    """Energy that is still to come [dB]."""
    rest = np.cumsum(energy[::-1])[::-1]
    return 10 * np.log10(np.maximum(rest / rest[0], 1e-9))


def saved(figure, folder, name):
    """Writes a figure."""
    figure.tight_layout()
    figure.savefig(folder / f"sound_{name}.png", dpi=DPI)
    plt.close(figure)
    print(folder / f"sound_{name}.png", flush=True)


def decays(args):
    """Decays in two coupled rooms at 1 kHz: the oracle, presets and baked sound."""
    case, seconds = rooms.coupled(), 1.5
    bank = with_late_sound(HouseBank.from_compiled([case.house]), [case.house], BakeOptions())
    dt = AudioConfig().bin_seconds
    truth = fly(case.blocks, case.source, case.listeners, seconds, dt, 40_000, radius=0.5).energy
    curves = {"Monte Carlo": truth[:, KHZ]}
    for preset in (name for name in PRESETS if name != "reference"):
        curves[preset] = heard(case, bank, config_of(preset, seconds), 1)[0, :, KHZ]
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
    for axis, name, group in zip(
        axes, ("the source's room", "the other room"), (slice(0, 3), slice(3, 6)), strict=True
    ):
        for label, energy in curves.items():
            style = {"color": "black", "lw": 3, "alpha": 0.4} if label == "Monte Carlo" else {}
            axis.plot(np.arange(energy.shape[1]) * dt, falling(energy[group].mean(axis=0)), label=label, **style)
        axis.set(title=f"Two coupled rooms: {name}", xlabel="time [s]", ylim=(-50, 1), xlim=(0, 1))
    axes[0].set_ylabel("energy still to come, 1 kHz [dB]")
    axes[0].legend()
    saved(figure, args.out, "decays")


def doors(args):
    """Level over time in the room next door, for three angles of the door between."""
    house, bank = args.house, args.baked
    portals = house.navigation.portals
    hinged = (portals.room >= 0).all(axis=1) & (portals.leaf[:, 0] >= 0)
    pair = portals.room[np.flatnonzero(hinged)[0]]
    source, listener = (jnp.asarray(middle(house, room), jnp.float32) for room in pair)
    config = AudioConfig(receiver="omni", late="baked", num_edges=8)
    wide, closed = bank.physics.door_wide[0], bank.physics.door_closed[0]

    @jax.jit
    def over_time(share):
        scene = scene_of(bank, closed + share * (wide - closed))
        late = baked_sound(scene, source, listener, config).energy
        paths = early_paths(scene, Source(source), Listener(listener, UPRIGHT), config)
        at = (paths.distance / (config.bin_seconds * config.speed_of_sound)).astype(jnp.int32)
        return late.at[at].add(paths.gain**2, mode="drop")[:, KHZ]

    figure, axis = plt.subplots(figsize=(6, 4))
    for name, share in (("open", 1.0), ("a third open", 0.33), ("shut", 0.0)):
        energy = np.asarray(over_time(jnp.float32(share)))
        level = 10 * np.log10(np.maximum(energy, 1e-9))
        label = f"{name}: {10 * np.log10(energy.sum()):.1f} dB"
        axis.plot(np.arange(len(level)) * config.bin_seconds, level, label=label)
    axis.set(xlabel="time [s]", ylabel="energy per 4 ms, 1 kHz [dB]", title="All doors of a house, from the next room")
    axis.legend()
    saved(figure, args.out, "doors")


def doorway(args):
    """Walking past a doorway: what comes straight or bent, and all of it."""
    case = rooms.coupled()
    bank = with_late_sound(HouseBank.from_compiled([case.house]), [case.house], BakeOptions())
    scene, source = scene_of(bank), jnp.float32([4.6, 0.9, 1.4])
    along = np.arange(-1.8, 1.81, 0.05)
    places = jnp.asarray(np.stack([np.full_like(along, 7.2), along, np.full_like(along, 1.5)], axis=1), jnp.float32)
    cliff, bent = (AudioConfig(receiver="omni", late="baked", num_edges=n) for n in (0, 8))

    @partial(jax.jit, static_argnums=1)
    def walk(places, config):
        def one(place):
            paths = early_paths(scene, Source(source), Listener(place, UPRIGHT), config)
            straight = jnp.sum(paths.gain[: 1 + config.num_edges] ** 2, axis=0)
            late = jnp.sum(baked_sound(scene, source, place, config).energy, axis=0)
            return straight, late + jnp.sum(paths.gain**2, axis=0)

        return jax.vmap(one)(places)

    found = {"straight": walk(places, cliff)[0], "with edges": walk(places, bent)[0], "all": walk(places, bent)[1]}
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), sharey=True)
    for axis, (octave, row) in zip(axes, OCTAVES.items(), strict=True):
        for label, energy in found.items():
            axis.plot(along, 10 * np.log10(np.maximum(np.asarray(energy)[:, row], 1e-6)), label=label)
        axis.set(title=f"{octave} Hz", xlabel="place along the wall [m]", ylim=(-45, 0))
    axes[0].set_ylabel("level re 1 m [dB]")
    axes[0].legend()
    saved(figure, args.out, "doorway")


def plan(args):
    """Level and T30 over a storey."""
    house, config = args.house, AudioConfig(late="baked", response_seconds=1.2)
    goal = np.asarray(house.navigation.start)[0] + EARS
    pictures = storey_pictures(scene_of(args.baked), goal.astype(np.float32), config)
    height = max(picture.shape[0] for picture in pictures.values())
    each = [np.pad(p, ((0, height - len(p)), (0, 8), (0, 0)), constant_values=255) for p in pictures.values()]
    write_png(args.out / "sound_map.png", np.concatenate(each, axis=1))
    print(args.out / "sound_map.png", flush=True)


def middle(house, room):
    """Ears at the place of a room that is farthest from what stands there."""
    from scipy.ndimage import distance_transform_edt

    navigation = house.navigation
    free = (navigation.room[0] == room) & (navigation.region[0] >= 0)
    row, column = np.unravel_index(np.argmax(distance_transform_edt(free)), free.shape)
    plan = navigation.origin + (np.array([column, row]) + 0.5) * navigation.cell
    return np.append(plan, house.rooms.floor[room]) + EARS


PICTURES = {"decays": decays, "doors": doors, "doorway": doorway, "map": plan}


def main():
    """Draws what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", nargs="*", choices=[*PICTURES, []], help="only these (default: all)")
    parser.add_argument("--dataset", default=GENERATED)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    chosen = args.pictures or list(PICTURES)
    if {"doors", "map"} & set(chosen):
        args.house = HouseSet(args.dataset, num_houses=1).load()[0]
        args.baked = with_late_sound(HouseBank.from_compiled([args.house]), [args.house], BakeOptions())
    for name in chosen:
        PICTURES[name](args)


if __name__ == "__main__":
    main()
