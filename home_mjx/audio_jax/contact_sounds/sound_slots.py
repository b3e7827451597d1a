"""Contact sounds of an environment: slots for transient and sustained sounds, and their emitted signals.

A sound that has ended keeps its slot and reverberates from its last position until the slot is reused, oldest first.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.contact_sounds.options import ContactSoundConfig
from home_mjx.audio_jax.contact_sounds.sound_bank import bank_power, sustained_bank, transient_bank
from home_mjx.core.pytree import Pytree

NEVER_STARTED = -(2**29)  # [samples], start of empty slots
FREE, NOBODY = -1, -1


class TransientSounds(Pytree):
    """Transient sounds (footsteps, impacts, thuds), one per slot."""

    pos: Float[Array, "k 3"]  # [m], world
    body: Int[Array, " k"]  # object id of the sounding body, which does not occlude its own sound; -1 none
    row: Int[Array, " k"]  # row of `transient_bank`
    gain: Float[Array, " k"]  # 0: empty slot
    start: Int[Array, " k"]  # [samples] since the episode's start


class SustainedSounds(Pytree):
    """Sustained sounds (scrapes, creaks), one per slot."""

    pos: Float[Array, "j 3"]  # [m], world
    body: Int[Array, " j"]  # object id of the sounding body
    row: Int[Array, " j"]  # row of `sustained_bank`
    emitter: Int[Array, " j"]  # index of the emitter; FREE: none
    gain: Float[Array, "j h"]  # at the end of this frame and of previous ones


class ContactSounds(Pytree):
    """Contact sounds of an environment, and the state that triggers footsteps."""

    transients: TransientSounds
    sustained: SustainedSounds
    walked_distance: Float[Array, " a"]  # [m], distance walked by each agent since the episode's start


def empty_contact_sounds(config: ContactSoundConfig, audio: AudioConfig, num_agents: int) -> ContactSounds:
    """Return contact sounds with all slots empty, and walked distances of 0.

    Example:
        >>> empty_contact_sounds(ContactSoundConfig(), AudioConfig(), 1).sustained.gain.shape
        (2, 7)
    """
    k, j = config.num_transients, config.num_sustained
    return ContactSounds(
        transients=TransientSounds(
            pos=jnp.zeros((k, 3), jnp.float32),
            body=jnp.full(k, NOBODY, jnp.int32),
            row=jnp.zeros(k, jnp.int32),
            gain=jnp.zeros(k, jnp.float32),
            start=jnp.full(k, NEVER_STARTED, jnp.int32),
        ),
        sustained=SustainedSounds(
            pos=jnp.zeros((j, 3), jnp.float32),
            body=jnp.full(j, NOBODY, jnp.int32),
            row=jnp.zeros(j, jnp.int32),
            emitter=jnp.full(j, FREE, jnp.int32),
            gain=jnp.zeros((j, num_stored_frames(audio)), jnp.float32),
        ),
        walked_distance=jnp.zeros(num_agents, jnp.float32),
    )


def num_stored_frames(audio: AudioConfig) -> int:
    """Return the number of frame-end gains stored per sustained slot: this frame's, those in the memory, one more.

    The memory is `audio.memory_length` - 1 samples, in frames, rounded up.
    """
    return 2 + math.ceil((audio.memory_length - 1) / audio.frame)


def add_transients(
    old: TransientSounds, new: TransientSounds, audio: AudioConfig, now: Int[Array, ""]
) -> tuple[TransientSounds, Bool[Array, ""]]:
    """Put new transient sounds into empty slots, then into those that started first.

    Equally loud sounds and equally old slots are taken in the order of their indices.

    Args:
        old: Current sounds in k slots.
        new: New sounds, in any number; those with gain 0 are ignored.
        audio: Options for the lengths.
        now: Time since the episode's start [samples].

    Returns:
        The updated slots with at most the k loudest new sounds, and whether a sound was lost. That is the case if there
        are more than k new sounds, or if one that still sounds is replaced.
    """
    k, n = old.gain.size, new.gain.size
    loudest = jnp.argsort(-new.gain, stable=True)[: min(k, n)]
    slot = jnp.argsort(old.start, stable=True)[: min(k, n)]
    taken = new.gain[loudest] > 0
    length = transient_bank(audio.sample_rate).shape[1]
    sounds = (old.gain[slot] > 0) & (old.start[slot] + length > now)
    lost = jnp.any(taken & sounds) | (jnp.sum(new.gain > 0) > k)

    def put(before: Array, after: Array) -> Array:
        """Write one field of the loudest new sounds to their slots."""
        there = taken.reshape(-1, *[1] * (before.ndim - 1))
        return before.at[slot].set(jnp.where(there, after[loudest], before[slot]))

    return jax.tree.map(put, old, new), lost


def update_sustained(
    old: SustainedSounds,
    pos: Float[Array, "n 3"],
    body: Int[Array, " n"],
    row: Int[Array, " n"],
    gain: Float[Array, " n"],
) -> tuple[SustainedSounds, Bool[Array, ""]]:
    """Update sustained sounds: an emitter keeps its slot until its gains are 0; the loudest new ones take free slots.

    Its gains are the current one and all stored ones but the oldest. Equally loud emitters come in the order of their
    indices. Slots of silent emitters and free slots keep their position, body and row. Gains of earlier frames move
    back by one column; in slots that change their emitter they become 0.

    Args:
        old: Current sounds.
        pos: Positions of all n possible emitters [m]; their index is `SustainedSounds.emitter`.
        body: Object ids of the emitters.
        row: Row of `sustained_bank` of each emitter.
        gain: Current gain of each emitter; 0 if silent.

    Returns:
        The updated slots, and whether an emitter found no slot.
    """
    own = jnp.maximum(old.emitter, 0)
    now = jnp.where(old.emitter >= 0, gain[own], 0.0)
    kept = (old.emitter >= 0) & ((now > 0) | jnp.any(old.gain[:, :-1] > 0, axis=1))
    number = jnp.arange(gain.size, dtype=jnp.int32)
    has_slot = jnp.any(kept[:, None] & (old.emitter[:, None] == number[None]), axis=0)
    waiting = jnp.where(has_slot, 0.0, gain)
    count = min(old.emitter.size, gain.size)
    loudest = jnp.argsort(-waiting, stable=True)[:count]
    slot = jnp.argsort(kept, stable=True)[:count]
    taken = (waiting[loudest] > 0) & ~kept[slot]
    owner = jnp.where(kept, old.emitter, FREE)
    owner = owner.at[slot].set(jnp.where(taken, loudest.astype(jnp.int32), owner[slot]))
    who, active = jnp.maximum(owner, 0), owner >= 0
    level = jnp.where(active, gain[who], 0.0)
    before = jnp.where(kept[:, None], old.gain[:, :-1], 0.0)
    moves = (active & (level > 0))[:, None]
    new = SustainedSounds(
        pos=jnp.where(moves, pos[who], old.pos),
        body=jnp.where(moves[:, 0], body[who], old.body),
        row=jnp.where(moves[:, 0], row[who], old.row),
        emitter=owner,
        gain=jnp.concatenate([level[:, None], before], axis=1),
    )
    return new, jnp.sum(waiting > 0) > jnp.sum(taken)


def sound_positions(noises: ContactSounds) -> tuple[Float[Array, "e 3"], Int[Array, " e"]]:
    """Return world positions [m] and object ids of all slots, empty ones included: transient, then sustained ones."""
    both = noises.transients, noises.sustained
    return jnp.concatenate([x.pos for x in both]), jnp.concatenate([x.body for x in both])


def has_sound(noises: ContactSounds) -> Bool[Array, " e"]:
    """Return a mask of slots: transient ones that ever had a sound, then sustained ones with a nonzero stored gain."""
    return jnp.concatenate([noises.transients.gain > 0, jnp.any(noises.sustained.gain > 0, axis=1)])


def emitted_signals(noises: ContactSounds, time: Int[Array, ""], audio: AudioConfig) -> Float[Array, "e w"]:
    """Return the pressure at 1 m of each slot, transient ones first, in the w samples of `emitted_signal`.

    `noises` are the sounds after the step of this frame, `time` is its start [samples since the episode's start]. Loops
    of sustained sounds begin at the episode's start; their gains are linear between frame ends.
    """
    span = jnp.arange(1 - audio.memory_length, audio.frame + audio.num_lookahead, dtype=jnp.int32)
    blows, loops = jnp.asarray(transient_bank(audio.sample_rate)), jnp.asarray(sustained_bank(audio.sample_rate))

    def strike(row: Array, gain: Array, start: Array) -> Array:
        """Return the signal of one transient slot."""
        at = time + span - start
        played = blows[row, jnp.clip(at, 0, blows.shape[1] - 1)]
        return jnp.where((at >= 0) & (at < blows.shape[1]), gain * played, 0.0)

    def rub(row: Array, gain: Array) -> Array:
        """Return the signal of one sustained slot."""
        place = (span + 1).astype(jnp.float32) / audio.frame  # 0 at the frame's start, 1 at its end
        return _interpolate_gain(gain, place) * loops[row, (time + span) % loops.shape[1]]

    s, r = noises.transients, noises.sustained
    return jnp.concatenate([jax.vmap(strike)(s.row, s.gain, s.start), jax.vmap(rub)(r.row, r.gain)])


def emitted_power(noises: ContactSounds, time: Int[Array, ""], audio: AudioConfig) -> Float[Array, "e w bands"]:
    """Compute the power of `emitted_signals` per time bin and octave, as input of `mean_band_power`.

    Of the w bins, the first `audio.num_bins - 1` precede the frame; the others are its length, rounded to at least one
    bin. Times since a sound's start are rounded down to bins, and loops have their mean power. Arguments are those of
    `emitted_signals`.
    """
    size, rate = audio.bin_samples, audio.sample_rate
    frame = max(round(audio.frame / size), 1)
    bins = jnp.arange(1 - audio.num_bins, frame, dtype=jnp.int32)
    blows = jnp.asarray(bank_power(transient_bank(rate), rate, size))
    loops = jnp.asarray(bank_power(sustained_bank(rate), rate, size).mean(axis=1))

    def strike(row: Array, gain: Array, start: Array) -> Array:
        """Return the power of one transient slot."""
        at = bins + (time - start) // size
        on = (at >= 0) & (at < blows.shape[1])
        return jnp.where(on[:, None], gain**2 * blows[row, jnp.clip(at, 0, blows.shape[1] - 1)], 0.0)

    def rub(row: Array, gain: Array) -> Array:
        """Return the power of one sustained slot."""
        place = (bins.astype(jnp.float32) + 0.5) * (size / audio.frame)
        return _interpolate_gain(gain, place)[:, None] ** 2 * loops[row][None]

    s, r = noises.transients, noises.sustained
    return jnp.concatenate([jax.vmap(strike)(s.row, s.gain, s.start), jax.vmap(rub)(r.row, r.gain)])


def _interpolate_gain(gain: Float[Array, " h"], place: Float[Array, " w"]) -> Float[Array, " w"]:
    """Interpolate `gain`, of frame ends from this one back, linearly at `place` [frames since its start]; clamped."""
    back = jnp.clip(1 - place, 0.0, gain.size - 1.0)  # frames before the end of this one
    whole = jnp.minimum(back.astype(jnp.int32), gain.size - 2)
    rest = back - whole.astype(jnp.float32)
    return gain[whole] * (1 - rest) + gain[whole + 1] * rest
