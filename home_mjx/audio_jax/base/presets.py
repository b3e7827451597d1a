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
    "fast": {
        "motion": True,
        "late": "baked",
        "tail_seconds": 0.0,
        "max_crossings": 16,
        "num_edges": 8,
        "num_heard": 8,
    },
    "balanced": {
        "motion": True,
        "late": "baked",
        "max_crossings": 16,
        "num_edges": 8,
        "num_reflections": 12,
        "num_heard": 10,
    },
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
TRACED: dict[str, dict[str, Any]] = {
    "fast": {"late": "traced", "num_edges": 0},
    "balanced": {
        "late": "traced",
        "num_rays": 512,
        "num_bounces": 150,
        "reflection_order": 2,
        "num_reflections": 24,
        "num_heard": None,
    },
    "reference": {},
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
        >>> audio_preset("fast").late, audio_preset("fast", late="traced").num_rays
        ('baked', 48)
    """
    known = {**PRESETS, "home": HOME}
    check_known("preset", [name], known)
    other = {"baked": FIRST_ORDER, "traced": TRACED.get(name, {})}.get(changes.get("late", ""), {})
    return AudioConfig(**{**known[name], **other, **changes})
