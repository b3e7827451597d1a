"""Three sets of options with their cost and their errors.

Errors are the largest over the octaves 125 to 8000 Hz, for one microphone. `benchmarks/acoustics.py` measures them in
six rooms against an independent Monte Carlo reference. The first figure is for bare or evenly absorbing rooms. Then
follow a soft floor, a carpet with a curtain, two coupled rooms, and scattering that rises with frequency. Errors of
moving tones are those of `tests/audio_jax/moving_sources`. For furnished houses see docs/benchmarks.md.
"""

from dataclasses import replace
from typing import Any

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.options import Baked, EarlyPaths, Motion, Traced
from home_mjx.core.checks import check_known
from home_mjx.core.variants import override_fields

PRESETS = {
    # T30 within 1 %, then +-3, +-4, +3 and +-3 %; late slopes within 6 %. EDT within 1 % (-2, -4, +4, -2 %), level
    # exact (+0.1, +0.2, -0.3, +0.1 dB). Tones at 1.4 m/s: error below -40 dB. Responses end after 0.5 s.
    "fast": AudioConfig(
        early=EarlyPaths(num_edges=8, max_crossings=16),
        late=Baked(),
        motion=Motion(max_audible_paths=8, tail_seconds=0.0),
    ),
    # The same late reverberation, with all first-order reflections of large rooms, and a tail: T30 of 0.5 to 2 s
    # measured from waveforms within 5 %.
    "balanced": AudioConfig(
        early=EarlyPaths(num_reflections=12, num_edges=8, max_crossings=16),
        late=Baked(),
        motion=Motion(max_audible_paths=10),
    ),
    # Unbiased up to Monte Carlo noise, without baking: T30 within 2 %, then +-8, -9, +-5, and +-8 %; late slopes
    # within 8 %. EDT within 1 % (3, -2, +6, +-3 %), level exact (+-0.1 dB, beyond the door of coupled rooms -0.5).
    "reference": AudioConfig(
        early=EarlyPaths(num_reflections=62, reflection_order=3, num_edges=16),
        late=Traced(num_rays=10_500, num_bounces=150, octave_rays=True, detector="sphere"),
        motion=Motion(),
    ),
}
# The presets with late="traced": for houses that cannot be baked, and rooms whose furniture has moved.
TRACED_PRESETS = {
    # T30 within 3 %, then -27, -26, -23 to +22 and -53 to +11 %; late slopes of coupled rooms are half as long. EDT
    # within 3 % (-8, -6, +10, -31 %), level exact (-0.4, -0.3, -0.5, -0.8 dB).
    "fast": replace(PRESETS["fast"], early=EarlyPaths(max_crossings=16), late=Traced()),
    # T30 within 2 %, then +-2, -6, +-2 and -42 to +20 %; late slopes +4 %. EDT within 2 % (-7, -5, +5, -30 %), level
    # within 0.1 dB (-0.4, -0.2, -0.4, -0.7).
    "balanced": AudioConfig(
        early=EarlyPaths(num_reflections=24, reflection_order=2, num_edges=8, max_crossings=16),
        late=Traced(num_rays=512, num_bounces=150),
        motion=Motion(),
    ),
    "reference": PRESETS["reference"],
}


def audio_preset(name: str, **changes: Any) -> AudioConfig:
    """Return the options of the preset "fast", "balanced" or "reference"; `PRESETS` lists their errors.

    "fast" and "balanced" look up baked late reverberation, see `add_bakes`; `make` bakes it unless a bank is
    passed. With `late="traced"` they trace rays in every step instead. `late="baked"` sets `reflection_order` to 1.

    Args:
        name: Name of the preset.
        **changes: Options that override the preset's: fields of `AudioConfig` or of its records, such as `num_edges=0`,
            whole records, or the words that select them.

    Raises:
        ConfigError: The preset or an option is unknown, or an option has an invalid value.

    Example:
        >>> audio_preset("fast").late, audio_preset("fast", late="traced", num_rays=96).late.num_rays
        (Baked(), 96)
    """
    check_known("preset", [name], PRESETS)
    preset, late = PRESETS[name], changes.get("late")
    if late == "traced" or isinstance(late, Traced):
        preset = TRACED_PRESETS[name]
    elif late == "baked" or isinstance(late, Baked):  # baked energies contain the higher orders
        preset = replace(preset, early=replace(preset.early, reflection_order=1), late=Baked())
    return override_fields(preset, changes)
