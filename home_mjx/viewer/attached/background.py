"""Viewer of an environment from Python and in notebooks, on a thread of its own."""

import threading
from html import escape
from typing import Any

from home_mjx.tasks.env.env import Env
from home_mjx.viewer.browser.run import Viewer, ViewOptions

JOIN_SECONDS = 30.0  # [s], longest wait for the current step at the end
FRAME_HEIGHT = 600  # [px], in notebooks


class BackgroundViewer:
    """Viewer that runs until `close`; a notebook shows its page where it is the last value of a cell.

    Args:
        env: The environment; of a batch, its single environment.
        options: Options of the viewer.

    Attributes:
        address: Address of the page.

    Raises:
        ConfigError: As of `Viewer`.

    Example:
        >>> viewer = env.view(agent="expert")  # doctest: +SKIP
        >>> viewer.address  # doctest: +SKIP
        'http://localhost:8080/'
        >>> viewer.close()  # doctest: +SKIP
    """

    def __init__(self, env: Env[Any], options: ViewOptions | None = None) -> None:
        single = Env(getattr(env.core, "core", env.core), env.params, env.spec)
        self.viewer = Viewer(single, options)
        self.address = self.viewer.server.address
        self._is_closed = False
        self._thread = threading.Thread(target=self.viewer.run, name="home-mjx viewer", daemon=True)
        self._thread.start()

    def __repr__(self) -> str:
        return f"BackgroundViewer({self.address})"

    def _repr_html_(self) -> str:
        """Return the page as a frame of a notebook."""
        where = escape(self.address, quote=True)
        return f'<iframe src="{where}" width="100%" height="{FRAME_HEIGHT}" allow="autoplay" frameborder="0"></iframe>'

    def __enter__(self) -> "BackgroundViewer":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop the viewer; a second call does nothing."""
        if self._is_closed:
            return
        self._is_closed = True
        if self._thread.is_alive():
            self.viewer.stop()
            self._thread.join(JOIN_SECONDS)
        self.viewer.close()


def view(env: Env[Any], **options: Any) -> BackgroundViewer:
    """Open a viewer of an environment in the background; options are those of `ViewOptions`."""
    return BackgroundViewer(env, ViewOptions(**options))
