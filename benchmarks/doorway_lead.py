"""Compute the interaural lead of sound through a doorway, without the engine.

Particles are traced from a source in one of two coupled rooms. Those that pass a listener in the other room within
25 ms of the first possible arrival are its reflections. As many of them are drawn as a room of that volume has in that
time, each with a random sign. Together with the sound diffracted at the jamb (Maekawa), they reach two ears on an exact
sphere. The lead is the lag of the largest cross-correlation of both ears, from 100 to 1500 Hz. Prints the difference of
single draws from the lead of sound from the doorway alone, the accuracy limit of random late sound.
"""

import argparse
import math
import sys
from pathlib import Path

import numba as nb
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))

import acoustic_rooms as rooms
from decay_oracle import SPEED, _meet, _turn

from home_mjx.audio_jax.receivers.spherical_head import sphere_spectrum

RADIUS, WINDOW, BALL = 0.0875, 0.025, 0.25  # [m] of the head, [s] of the reflections, [m] of the receiver sphere
RATE, SIZE, FINER = 64000, 8192, 16
FREQUENCY = np.fft.rfftfreq(SIZE, 1 / RATE)
USED = (FREQUENCY > 100) & (FREQUENCY < 1500)
HEADS = sphere_spectrum(FREQUENCY[USED], np.linspace(0, np.pi, 181), RADIUS, SPEED)
DOOR, HALF = np.array([6.0, 0.0, 1.45]), 0.45
SOURCES = ((4.8, 1.4, 1.4), (2.0, -0.6, 1.4))
LISTENERS = ((7.5, 1.3, 1.5), (8.2, 1.0, 1.5), (7.0, 1.6, 1.5))
OCTAVE = 3  # index of 1 kHz
DRAWS = 200


@nb.njit(cache=True)
def arrivals(low, high, absorption, scattering, source, listener, count, seconds, rng):
    """Trace particles; return rows of time [s], energy times chord in the receiver [m], and incident direction."""
    out, rows, point, way = np.zeros((2_000_000, 5)), 0, np.zeros(3), np.zeros(3)
    for i in range(count):
        z, angle = 2 * (i + rng.random()) / count - 1, 2 * math.pi * rng.random()
        ring = math.sqrt(max(0.0, 1 - z * z))
        way[0], way[1], way[2] = ring * math.cos(angle), ring * math.sin(angle), z
        point[:] = source
        left, flown, bounces = 1.0, 0.0, 0
        while flown < seconds * SPEED and left > 1e-4:
            length, block, face = _meet(low, high, point, way)
            if block < 0:
                break
            offset = listener - point
            middle = (offset * way).sum()
            half = BALL**2 - ((offset * offset).sum() - middle**2)
            if bounces > 0 and half > 0 and 0 < middle < length and rows < out.shape[0]:
                out[rows, 0], out[rows, 1] = (flown + middle) / SPEED, left * 2 * math.sqrt(half)
                out[rows, 2:] = -way
                rows += 1
            point += length * way
            point[face] = low[block, face] if way[face] > 0 else high[block, face]
            flown += length
            left *= 1 - absorption[block]
            _turn(way, face, scattering[block], rng)
            bounces += 1
    return out[:rows]


def lead(cross):
    """Compute the lead of the first ear [µs] from a cross spectrum."""
    whole = np.zeros(FREQUENCY.size, complex)
    whole[USED] = cross
    correlation, lag = np.fft.irfft(whole, FINER * SIZE), np.arange(FINER * SIZE)
    lag[lag > FINER * SIZE // 2] -= FINER * SIZE
    near = np.abs(lag) < 1e-3 * RATE * FINER
    return -lag[near][np.argmax(correlation[near])] / (RATE * FINER) * 1e6


def at_ear(direction, axis):
    """Return the spectra (n, f) of one ear for sound from unit vectors (n, 3)."""
    return HEADS[np.round(np.degrees(np.arccos(np.clip(direction @ axis, -1, 1)))).astype(int)]


def measure(room, source, listener, off, rng, count):
    """Return leads [µs] of single draws, of all together, and of the doorway alone, and the relative energy [dB]."""
    blocks = room.blocks
    parts = [np.asarray(x, float) for x in (blocks.low, blocks.high)]
    walls = [np.ascontiguousarray(x[:, OCTAVE]) for x in (blocks.absorption, blocks.scattering)]
    found = arrivals(*parts, *walls, source, listener, count, 0.08, rng)
    jamb = np.array([DOOR[0], np.clip(np.interp(6, *zip(source[:2], listener[:2], strict=True)), -HALF, HALF), DOOR[2]])
    way, straight = np.linalg.norm(jamb - source) + np.linalg.norm(listener - jamb), np.linalg.norm(listener - source)
    first = way / SPEED
    found = found[(found[:, 0] > first - 1e-3) & (found[:, 0] < first + WINDOW)]
    energy = 3 / BALL**3 / count * found[:, 1]  # re the free field at 1 m
    bent = 1 / straight**2 / (3 + 20 * 2 * (way - straight) * 500 / SPEED)  # Maekawa's formula at 500 Hz
    toward, edge = ((x - listener) / np.linalg.norm(x - listener) for x in (DOOR, jamb))
    yaw = np.arctan2(toward[1], toward[0]) + np.radians(off)
    axes = [side * np.array([-np.sin(yaw), np.cos(yaw), 0.0]) for side in (1, -1)]
    density = 4 * np.pi * SPEED**3 * (first + WINDOW / 2) ** 2 / room.volume
    leads, total = [], 0
    for _ in range(DRAWS):
        number = rng.poisson(density * WINDOW)
        chosen = found[rng.choice(len(found), number, p=energy / energy.sum())]
        size = rng.choice([-1, 1], number) * np.sqrt(energy.sum() / max(number, 1))
        wave = size[:, None] * np.exp(-2j * np.pi * (chosen[:, 0] - first)[:, None] * FREQUENCY[USED])
        ears = [(wave * at_ear(chosen[:, 2:], a)).sum(0) + np.sqrt(bent) * at_ear(edge[None], a)[0] for a in axes]
        cross = ears[0] * np.conj(ears[1])
        leads.append(lead(cross))
        total = total + cross
    alone = lead(at_ear(toward[None], axes[0])[0] * np.conj(at_ear(toward[None], axes[1])[0]))
    return np.array(leads), lead(total), alone, 10 * np.log10(energy.sum() / bent)


def main():
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--particles", type=int, default=1_500_000)
    args = parser.parse_args()
    room, rng = rooms.coupled(), np.random.default_rng(0)
    print(
        "| source | listener | head off the doorway | doorway alone | all draws | draws within 80 µs | rest re bent |"
    )
    print("|" + " --- |" * 7)
    for source in SOURCES:
        for listener in LISTENERS:
            for off in (46, -46):
                at = np.array(source), np.array(listener)
                leads, together, alone, rest = measure(room, *at, off, rng, args.particles)
                share = np.mean(np.abs(leads - alone) < 80)
                cells = (source, listener, f"{off}°", f"{alone:.0f} µs", f"{together:.0f} µs", f"{share:.0%}")
                print("| " + " | ".join(map(str, cells)) + f" | {rest:.1f} dB |", flush=True)


if __name__ == "__main__":
    main()
