"""The taste of a home: which of the things of a kind it has, and how they are dressed."""

from home_procgen.style.style import Style

__all__ = ["Style"]
