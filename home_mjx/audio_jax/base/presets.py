"""Three choices of options, by what they cost and how wrong they are.

Errors are those of `benchmarks/acoustics.py`, in six rooms against a Monte Carlo that shares nothing with the engine,
the largest over octaves of 125 to 8000 Hz. Rooms that absorb evenly or are bare are named first; then those with a soft
floor, with a carpet and a curtain, two coupled rooms, and scattering that rises with frequency. They are those of one
microphone; moving tones, of `tests/audio_jax/motion`. Where houses can be baked, use
`audio_preset("fast", late="baked", num_edges=8)`, or `audio_preset("balanced", late="baked")`, which renders more
reflections and a tail; both of first order, as baked sound has all others. With `late="baked"`: T30 within 1 %, then
+-2, -3, +7 and +-2 %; late slopes within 3 %; EDT within 2 % (+6 % in the coupled rooms); level within 0.2 dB.
"""

from typing import Any

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.core.checks import check_known

PRESETS: dict[str, dict[str, Any]] = {
    # T30 within 3 %, then -27, -26, -23 to +22 and -53 to +11 %; late slopes of coupled rooms are half as long.
    # EDT within 3 % (-8, -6, +10, -31 %), level exact (-0.4, -0.3, -0.5, -0.8 dB). Tones at 1.4 m/s: error below
    # -40 dB. Ends after 0.5 s.
    "fast": {"motion": True, "tail_seconds": 0.0, "max_crossings": 16},
    # T30 within 2 %, then +-2, -6, +-2 and -42 to +20 %; late slopes +4 %. EDT within 2 % (-7, -5, +5, -30 %),
    # level within 0.1 dB (-0.4, -0.2, -0.4, -0.7). Tones as above; T30 of 0.5 to 2 s read from waveforms within 5 %.
    "balanced": {
        "motion": True,
        "num_rays": 512,
        "num_bounces": 150,
        "max_crossings": 16,
        "num_edges": 8,
        "reflection_order": 2,
        "num_reflections": 24,
    },
    # T30 within 2 %, then -5, -7, +-2 and -42 to +22 %; late slopes +4 %. EDT within 2 % (-7, -5, +5, -31 %),
    # level within 0.1 dB (-0.3, -0.2, -0.6, -0.6): what is left is how rays are traced, not how many.
    "reference": {
        "motion": True,
        "num_rays": 3000,
        "num_bounces": 150,
        "num_edges": 16,
        "reflection_order": 3,
        "num_reflections": 62,
    },
}


FIRST_ORDER: dict[str, Any] = {"reflection_order": 1}  # the others are in what has been baked

# Not sound as it is, but as HoME (2017) had it, to compare with it: see `propagation/home_paths.py`.
HOME: dict[str, Any] = {
    "early": "home",
    "late": "none",
    "reflection_order": 3,
    "num_reflections": 62,
    "receiver": "omni",
    "response_seconds": 1.0,
    "humidity": 65.0,
}


def audio_preset(name: str, **changes: Any) -> AudioConfig:
    """The options of a preset, "fast", "balanced" or "reference"; what each gets wrong stands beside it in `PRESETS`.

    Args:
        name: Of the preset; or "home": as HoME (2017) had it.
        **changes: Options that shall differ from it.

    Raises:
        ConfigError: There is no such preset, or an option has a value that cannot be used.

    Example:
        >>> audio_preset("fast").num_rays, audio_preset("balanced", num_rays=128).num_rays
        (48, 128)
        >>> audio_preset("balanced", late="baked").reflection_order
        1
    """
    known = {**PRESETS, "home": HOME}
    check_known("preset", [name], known)
    baked = FIRST_ORDER if changes.get("late") == "baked" else {}
    return AudioConfig(**{**known[name], **baked, **changes})
