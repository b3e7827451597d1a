"""Three sets of options with their cost and their errors.

Errors are the largest over the octaves 125 to 8000 Hz, for one microphone. `benchmarks/acoustics.py` measures them in
six rooms against an independent Monte Carlo reference. The first figure is for bare or evenly absorbing rooms. Then
follow a soft floor, a carpet with a curtain, two coupled rooms, and scattering that rises with frequency. Errors of
moving tones are those of `tests/audio_jax/moving_sources`. For furnished houses see docs/benchmarks.md.
"""

from typing import Any

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.core.checks import check_known

PRESETS: dict[str, dict[str, Any]] = {
    # T30 within 1 %, then +-3, +-4, +3 and +-3 %; late slopes within 6 %. EDT within 1 % (-2, -4, +4, -2 %), level
    # exact (+0.1, +0.2, -0.3, +0.1 dB). Tones at 1.4 m/s: error below -40 dB. Responses end after 0.5 s.
    "fast": {
        "motion": True,
        "late": "baked",
        "tail_seconds": 0.0,
        "max_crossings": 16,
        "num_edges": 8,
        "max_audible_paths": 8,
    },
    # The same late reverberation, with all first-order reflections of large rooms, and a tail: T30 of 0.5 to 2 s
    # measured from waveforms within 5 %.
    "balanced": {
        "motion": True,
        "late": "baked",
        "max_crossings": 16,
        "num_edges": 8,
        "num_reflections": 12,
        "max_audible_paths": 10,
    },
    # Unbiased up to Monte Carlo noise, without baking: T30 within 2 %, then +-8, -9, +-5, and +-8 %; late slopes
    # within 8 %. EDT within 1 % (3, -2, +6, +-3 %), level exact (+-0.1 dB, beyond the door of coupled rooms -0.5).
    "reference": {
        "motion": True,
        "num_rays": 10_500,
        "num_bounces": 150,
        "octave_rays": True,
        "detector": "sphere",
        "num_edges": 16,
        "reflection_order": 3,
        "num_reflections": 62,
    },
}
# Changes to the presets for late="traced": for houses that cannot be baked, and rooms whose furniture has moved.
TRACED_CHANGES: dict[str, dict[str, Any]] = {
    # T30 within 3 %, then -27, -26, -23 to +22 and -53 to +11 %; late slopes of coupled rooms are half as long. EDT
    # within 3 % (-8, -6, +10, -31 %), level exact (-0.4, -0.3, -0.5, -0.8 dB).
    "fast": {"late": "traced", "num_edges": 0},
    # T30 within 2 %, then +-2, -6, +-2 and -42 to +20 %; late slopes +4 %. EDT within 2 % (-7, -5, +5, -30 %), level
    # within 0.1 dB (-0.4, -0.2, -0.4, -0.7).
    "balanced": {
        "late": "traced",
        "num_rays": 512,
        "num_bounces": 150,
        "reflection_order": 2,
        "num_reflections": 24,
        "max_audible_paths": None,
    },
    "reference": {},
}
BAKED_CHANGES: dict[str, Any] = {"reflection_order": 1}  # baked energies contain the higher orders

# The acoustics of HoME (2017), for comparison only: see `propagation/home2017_paths.py`.
HOME2017: dict[str, Any] = {
    "early": "home",
    "late": "none",
    "reflection_order": 3,
    "num_reflections": 62,
    "receiver": "omni",
    "response_seconds": 1.0,
    "humidity": 65.0,
}


def audio_preset(name: str, **changes: Any) -> AudioConfig:
    """Return the options of the preset "fast", "balanced" or "reference"; `PRESETS` lists their errors.

    "fast" and "balanced" look up baked late reverberation, see `add_bakes`; `make` bakes it unless a bank is
    passed. With `late="traced"` they trace rays in every step instead.

    Args:
        name: Name of the preset; "home" for the acoustics of HoME (2017).
        **changes: Options that override the preset's.

    Raises:
        ConfigError: The preset is unknown, or an option has an invalid value.

    Example:
        >>> audio_preset("fast").late, audio_preset("fast", late="traced").num_rays
        ('baked', 48)
    """
    known = {**PRESETS, "home": HOME2017}
    check_known("preset", [name], known)
    other = {"baked": BAKED_CHANGES, "traced": TRACED_CHANGES.get(name, {})}.get(changes.get("late", ""), {})
    return AudioConfig(**{**known[name], **other, **changes})
