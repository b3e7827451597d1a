"""Style of a home: its choice of models and materials."""

from home_procgen.style.style import HomeStyle

__all__ = ["HomeStyle"]
