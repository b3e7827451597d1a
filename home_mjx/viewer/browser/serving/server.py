"""Server of the viewer: viser's scene, the channels of the page and the front on one thread each (extra `view`)."""

import asyncio
import contextlib
import http
import importlib
import io
import secrets
import threading
from collections.abc import Callable
from importlib import resources
from typing import TYPE_CHECKING, Any

from home_mjx.errors import ConfigError, install_hint
from home_mjx.viewer.browser.serving.channel import Channel, Message
from home_mjx.viewer.browser.serving.front import LOCAL_NAMES, MAX_HEAD_BYTES, Front, PageFile, Upstream, open_port

if TYPE_CHECKING:
    import viser

DEFAULT_PORT = 8080
PING_SECONDS = 120.0  # [s], time after which a page that does not answer is dropped; busy ones take some
START_SECONDS = 10.0  # [s], time within which the server's thread must start
FRAME_CAPACITY, SOUND_CAPACITY = 4, 32  # messages that wait for a slow page
PAGE = "home_mjx.viewer.browser"
KINDS = {"html": "text/html; charset=utf-8", "css": "text/css", "js": "text/javascript"}


def load_viser() -> Any:
    """Import and return viser.

    Raises:
        ConfigError: The extra `view` is not installed.
    """
    try:
        return importlib.import_module("viser")
    except ModuleNotFoundError as error:
        raise ConfigError(f"the viewer needs the package `{error.name}`", hint=install_hint("view")) from error


def read_page() -> dict[str, PageFile]:
    """Return the files of the page by path; `/` is `index.html`."""
    files = {}
    for file in (resources.files(PAGE) / "page").iterdir():
        kind = KINDS.get(file.name.rpartition(".")[2])
        if kind is not None:
            files[f"/{file.name}"] = PageFile(kind, file.read_bytes())
    return {**files, "/": files["/index.html"]}


class ViewServer:
    """The viewer's page on one port, from the first line on; use it as a context.

    Args:
        host: Name or address to bind; other machines can reach any but localhost, with the token of `address`.
        port: Port; the next free one is used if it is taken, any free one for 0.
        on_key: Callback for messages of the pages, see `Channel`, on the server's thread.
        on_listen: Callback for messages of the pages' sound, on the server's thread.
        greeting: Function that returns the state that a page shows first, as JSON.
        sound_greeting: Function that returns the format of the sound, as JSON.

    Attributes:
        scene: viser's server, with the scene and the panels.
        live: Channel of pictures (JPEG) and states (JSON).
        sound: Channel of sound, float32 stereo frames.
        port: The port in use.
        address: Address of the page.

    Raises:
        ConfigError: viser is not installed, or no port is free.
    """

    def __init__(
        self,
        host: str = "localhost",
        port: int = DEFAULT_PORT,
        on_key: Callable[[Any], None] = lambda message: None,
        greeting: Callable[[], Message | None] = lambda: None,
        sound_greeting: Callable[[], Message | None] = lambda: None,
        on_listen: Callable[[Any], None] = lambda message: None,
    ) -> None:
        self._viser = load_viser()
        self._socket = open_port(host, port)
        self.port = int(self._socket.getsockname()[1])
        self.token = None if host in LOCAL_NAMES else secrets.token_urlsafe(16)
        self.address = f"http://{host}:{self.port}/" + (f"?token={self.token}" if self.token else "")
        self.live = Channel(FRAME_CAPACITY, on_key, greeting)
        self.sound = Channel(SOUND_CAPACITY, on_listen, sound_greeting)
        with contextlib.redirect_stdout(io.StringIO()):  # viser prints its own address
            self.scene: viser.ViserServer = self._viser.ViserServer("127.0.0.1", 0, verbose=False)
        self._loop = asyncio.new_event_loop()
        self._is_ready, self._thread = threading.Event(), threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        if not self._is_ready.wait(START_SECONDS):
            raise ConfigError("the viewer's server did not start")

    def __enter__(self) -> "ViewServer":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections and stop the threads."""
        self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join(START_SECONDS)
        with contextlib.redirect_stdout(io.StringIO()):
            self.scene.stop()

    def _run(self) -> None:
        """Run the server until `close`; the body of its thread."""
        asyncio.set_event_loop(self._loop)
        self._stop = asyncio.Event()
        self._loop.run_until_complete(self._serve())
        self._loop.close()

    async def _serve(self) -> None:
        """Serve the channels on a port of their own, and everything on the front's."""
        gone = importlib.import_module("websockets.exceptions").ConnectionClosed
        serve = importlib.import_module("websockets.asyncio.server").serve
        key = secrets.token_urlsafe(16)  # only the front knows it, so that no page can go past it
        routes = {f"/{key}/live": self.live, f"/{key}/sound": self.sound}

        def refuse_others(connection: Any, request: Any) -> Any:
            """Return a response to requests that do not come from the front; None: go on."""
            return None if request.path in routes else connection.respond(http.HTTPStatus.NOT_FOUND, "no such page\n")

        async def serve_channel(connection: Any) -> None:
            """Serve one connection of a channel."""
            with contextlib.suppress(gone):  # without a closing handshake, such as a laptop that sleeps
                await routes[connection.request.path].serve(connection)

        options = {"compression": None, "process_request": refuse_others, "ping_timeout": PING_SECONDS}
        inner = await serve(serve_channel, "127.0.0.1", 0, **options)
        own = next(iter(inner.sockets)).getsockname()[1]
        upstreams = {
            "/live": Upstream(own, f"/{key}/live"),
            "/sound": Upstream(own, f"/{key}/sound"),
            "/scene/": Upstream(self.scene.get_port(), "/"),
        }
        front = Front(read_page(), upstreams, self.token)
        async with inner, await asyncio.start_server(front.handle, sock=self._socket, limit=MAX_HEAD_BYTES):
            self._is_ready.set()
            await self._stop.wait()
            tasks = asyncio.all_tasks() - {asyncio.current_task()}
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
