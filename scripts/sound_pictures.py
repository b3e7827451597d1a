"""Draw the images of docs/sound/.

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
from scipy.ndimage import distance_transform_edt, gaussian_filter1d
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "benchmarks"))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))

import acoustic_rooms as rooms
from acoustics import UPRIGHT, config_of, heard
from decay_oracle import fly

from home_mjx.audio_jax import (
    AudioConfig,
    BakeOptions,
    LateReverbBake,
    Listener,
    SoundSource,
    audio_preset,
    clip_samples,
    early_paths,
    render_frame,
    render_receiver_state,
    stft_magnitude,
)
from home_mjx.audio_jax.base.options import Baked, EarlyPaths, Omni
from home_mjx.audio_jax.late_reverb.lookup.lookup import lookup_late_sound
from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.houses import add_bakes
from home_mjx.houses.house_set import HouseSet
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.viewer.pictures.media import write_png, write_wav
from home_mjx.viewer.pictures.storey_maps import draw_storey_maps

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parent.parent
GENERATED = "procedural:1?seed=91001"
OCTAVES = {125: 0, 1000: 3, 8000: 6}
KHZ = OCTAVES[1000]
DECAYS = {"fast, traced": "fast-traced", "balanced, traced": "balanced-traced", "baked": "baked"}
EARS = np.array([0.0, 0.0, 1.5])
DPI = 80


def scene_of(bank, angle=None):
    """Build the scene of the first house of a bank, with fully open doors if no angles are passed."""
    physics = bank.physics
    angle = physics.door_fully_open[0] if angle is None else angle
    nobody = jnp.zeros((0, 3)), jnp.zeros((0, 4))
    return make_scene(bank, jnp.int32(0), physics.body_pos[0], physics.body_quat[0], *nobody, door_angle=angle)


def falling(energy):
    """Compute the backward-integrated energy decay [dB]."""
    rest = np.cumsum(energy[::-1])[::-1]
    return 10 * np.log10(np.maximum(rest / rest[0], 1e-9))


def saved(figure, folder, name):
    """Write a figure."""
    figure.tight_layout()
    figure.savefig(folder / f"sound_{name}.png", dpi=DPI)
    plt.close(figure)
    print(folder / f"sound_{name}.png", flush=True)


def decays(args):
    """Draw decays in two coupled rooms at 1 kHz: the oracle, presets with traced rays, and baked reverberation."""
    case, seconds = rooms.coupled(), 1.5
    bank = add_bakes(HouseBank.from_compiled([case.house]), [case.house], LateReverbBake(BakeOptions()))
    dt = AudioConfig().bin_seconds
    truth = fly(case.blocks, case.source, case.listeners, seconds, dt, 40_000, radius=0.5).energy
    curves = {"Monte Carlo": truth[:, KHZ]}
    for label, preset in DECAYS.items():
        curves[label] = heard(case, bank, config_of(preset, seconds), 1)[0, :, KHZ]
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
    """Draw level over time in the adjacent room, for three angles of the door between."""
    house, bank = args.house, args.baked
    portals = house.navigation.portals
    hinged = (portals.room >= 0).all(axis=1) & (portals.leaf[:, 0] >= 0)
    pair = portals.room[np.flatnonzero(hinged)[0]]
    source, listener = (jnp.asarray(middle(house, room), jnp.float32) for room in pair)
    config = AudioConfig(early=EarlyPaths(num_edges=8), late=Baked(), receiver=Omni())
    wide, closed = bank.physics.door_fully_open[0], bank.physics.door_closed[0]

    @jax.jit
    def over_time(share):
        scene = scene_of(bank, closed + share * (wide - closed))
        late = lookup_late_sound(scene, source, listener, config).energy
        paths = early_paths(scene, SoundSource(source), Listener(listener, UPRIGHT), config)
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
    """Draw levels of a walk past a doorway: direct and diffracted sound, and the total."""
    case = rooms.coupled()
    bank = add_bakes(HouseBank.from_compiled([case.house]), [case.house], LateReverbBake(BakeOptions()))
    scene, source = scene_of(bank), jnp.float32([4.6, 0.9, 1.4])
    along = np.arange(-1.8, 1.81, 0.05)
    places = jnp.asarray(np.stack([np.full_like(along, 7.2), along, np.full_like(along, 1.5)], axis=1), jnp.float32)
    cliff, bent = (AudioConfig(early=EarlyPaths(num_edges=n), late=Baked(), receiver=Omni()) for n in (0, 8))

    @partial(jax.jit, static_argnums=1)
    def walk(places, config):
        def one(place):
            paths = early_paths(scene, SoundSource(source), Listener(place, UPRIGHT), config)
            straight = jnp.sum(paths.gain[: 1 + config.early.num_edges] ** 2, axis=0)
            late = jnp.sum(lookup_late_sound(scene, source, place, config).energy, axis=0)
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
    """Draw level and T30 over a storey."""
    house, config = args.house, AudioConfig(late=Baked(), response_seconds=1.2)
    goal = np.asarray(house.navigation.start)[0] + EARS
    pictures = draw_storey_maps(scene_of(args.baked), goal.astype(np.float32), config)
    height = max(picture.shape[0] for picture in pictures.values())
    each = [np.pad(p, ((0, height - len(p)), (0, 8), (0, 0)), constant_values=255) for p in pictures.values()]
    write_png(args.out / "sound_map.png", np.concatenate(each, axis=1))
    print(args.out / "sound_map.png", flush=True)


def walk(args):
    """Draw a walk through all rooms at 1 m/s to the radio: spectrogram and level over time; also write its sound."""
    config = audio_preset("fast", tail_seconds=1.0)
    house, scene = args.house, scene_of(args.baked)
    goal = max(range(len(house.rooms.floor)), key=lambda room: clearance(house, room).max())
    way = way_to(house, middle(house, goal))
    source = SoundSource(jnp.asarray(way[-1] + [0.6, 0.0, -0.3], jnp.float32))
    clip = jnp.asarray(clip_samples(args.clip, config))
    ahead = np.gradient(gaussian_filter1d(way, 8, axis=0, mode="nearest"), axis=0)
    yaws = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    ears = [
        Listener(jnp.asarray(p, jnp.float32), camera_quat(jnp.float32(y), jnp.float32(0)))
        for p, y in zip(way, yaws, strict=True)
    ]
    key, span = jax.random.key(0), np.arange(1 - config.memory_length, config.frame + config.num_lookahead)
    hear = jax.jit(lambda listener: render_receiver_state(scene, source, listener, key, config))
    between = jax.jit(lambda sound, old, new: render_frame(sound, old, new, config))
    old, sound = hear(ears[0]), []
    for number, listener in enumerate(ears[1:]):
        new = hear(listener)
        sound.append(np.asarray(between(clip[(span + number * config.frame) % clip.size], old, new)))
        old = new
    sound = np.concatenate(sound, axis=1)
    room = [int(house.navigation.room[cell_of(house, place)]) for place in way]
    draw_walk(sound, np.array(room), np.linalg.norm(way - np.asarray(source.pos), axis=1), config, args)
    loudest = np.max(np.abs(sound))
    write_wav(args.wav or args.out / "sound_walk.wav", sound, config.sample_rate)
    print(
        f"{sound.shape[1] / config.sample_rate:.1f} s, largest {loudest:.3f}, nan {np.isnan(sound).sum()}", flush=True
    )


def draw_walk(sound, room, distance, config, args):
    """Draw the spectrogram of the left ear, the levels of both ears in 50 ms, and the walk."""
    rate = config.sample_rate
    magnitude = np.asarray(stft_magnitude(jnp.asarray(sound[0]), rate))
    figure, axes = plt.subplots(3, 1, figsize=(10, 7), sharex=True, height_ratios=(3, 2, 1))
    seconds = sound.shape[1] / rate
    level = 20 * np.log10(np.maximum(magnitude.T, 1e-7))
    axes[0].imshow(
        level, origin="lower", aspect="auto", extent=(0, seconds, 0, rate / 2000), vmin=level.max() - 80, cmap="magma"
    )
    axes[0].set(ylabel="frequency [kHz]", title="A walk to a radio: left ear")
    size = rate // 20
    power = np.mean(sound[:, : sound.shape[1] // size * size].reshape(2, -1, size) ** 2, axis=2)
    for ear, row in zip(("left", "right"), power, strict=True):
        axes[1].plot((np.arange(len(row)) + 0.5) / 20, 10 * np.log10(np.maximum(row, 1e-12)), label=ear)
    axes[1].set(ylabel="level in 50 ms [dB]")
    axes[1].legend()
    time = np.arange(len(room)) * config.frame / rate
    axes[2].plot(time, distance, color="black")
    for change in np.flatnonzero(np.diff(room)):
        for axis in axes:
            axis.axvline(time[change + 1], color="grey", lw=0.6)
    axes[2].set(ylabel="distance [m]", xlabel="time [s]; grey: into another room")
    saved(figure, args.out, "walk")


def way_to(house, goal, step=0.1):
    """Return ear positions every `step` [m] on the shortest path to a goal from the farthest place."""
    free = house.navigation.region[0] >= 0
    rows, columns = np.nonzero(free)
    number = -np.ones(free.shape, int)
    number[rows, columns] = np.arange(rows.size)
    edges = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        there = (np.clip(rows + down, 0, free.shape[0] - 1), np.clip(columns + right, 0, free.shape[1] - 1))
        joined = free[there]
        edges.append(
            (number[rows, columns][joined], number[there][joined], np.full(joined.sum(), np.hypot(down, right)))
        )
    first, second, length = (np.concatenate(x) for x in zip(*edges, strict=True))
    graph = coo_array((length, (first, second)), (rows.size, rows.size)).tocsr()
    end = number[cell_of(house, goal)[1:]]
    far, before = dijkstra(graph, directed=False, indices=end, return_predecessors=True)
    cells = [int(np.argmax(np.where(np.isfinite(far), far, -1)))]
    while cells[-1] != end:
        cells.append(int(before[cells[-1]]))
    plan = house.navigation.origin + (np.stack([columns[cells], rows[cells]], 1) + 0.5) * house.navigation.cell
    plan = gaussian_filter1d(plan, 3, axis=0, mode="nearest")
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(plan, axis=0), axis=1))])
    at = np.arange(0, along[-1], step)
    return np.stack([*(np.interp(at, along, plan[:, i]) for i in (0, 1)), np.full(at.size, goal[2])], axis=1)


def cell_of(house, place):
    """Return the index of a place of the lowest storey in maps of the house."""
    column, row = ((place[:2] - house.navigation.origin) / house.navigation.cell).astype(int)
    return 0, row, column


def clearance(house, room=None):
    """Compute the distance [cells] from each free cell to the next cell that is blocked or outside the room."""
    navigation = house.navigation
    free = navigation.region[0] >= 0
    return distance_transform_edt(free if room is None else free & (navigation.room[0] == room))


def middle(house, room):
    """Return the ear position of a room with the largest clearance."""
    navigation = house.navigation
    away = clearance(house, room)
    row, column = np.unravel_index(np.argmax(away), away.shape)
    plan = navigation.origin + (np.array([column, row]) + 0.5) * navigation.cell
    return np.append(plan, house.rooms.floor[room]) + EARS


PICTURES = {"decays": decays, "doors": doors, "doorway": doorway, "map": plan, "walk": walk}


def main():
    """Draw the images that the command line selects."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", nargs="*", choices=[*PICTURES, []], help="images to draw (default: all)")
    parser.add_argument("--dataset", default=GENERATED)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    parser.add_argument("--clip", default="radio", help="clip of the source on the walk")
    parser.add_argument(
        "--wav", type=Path, help="file for the sound of the walk (default: sound_walk.wav beside the images)"
    )
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    chosen = args.pictures or list(PICTURES)
    if {"doors", "map", "walk"} & set(chosen):
        args.house = HouseSet(args.dataset, num_houses=1).load()[0]
        args.baked = add_bakes(HouseBank.from_compiled([args.house]), [args.house], LateReverbBake(BakeOptions()))
    for name in chosen:
        PICTURES[name](args)


if __name__ == "__main__":
    main()
