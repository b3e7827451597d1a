"""Generated houses that several tests look at, each made once."""

from functools import cache

from home_mjx.scene_compile.generate import build_house

built = cache(build_house)
