"""Imports MJX before the rest of this package does: where warp is missing, MJX says so on stdout, amid our output."""

import contextlib
import io

with contextlib.redirect_stdout(io.StringIO()):
    from mujoco import mjx

__all__ = ["mjx"]
