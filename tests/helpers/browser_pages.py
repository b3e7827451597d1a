"""Headless Chromium by Playwright, for tests of pages."""

import contextlib
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"),
)


@contextlib.contextmanager
def open_browser() -> Iterator[Any]:
    """Yield a function that opens a page at an address, and waits for its first picture."""
    from playwright.sync_api import sync_playwright

    with contextlib.ExitStack() as stack:
        player = stack.enter_context(sync_playwright())
        browser = player.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        stack.callback(browser.close)

        def open_page(address: str, script: str = "", has_scene: bool = True) -> Any:
            """Open a page; `script` runs in it before its own. Without the 3D scene it is much faster."""
            page = browser.new_page(viewport={"width": 1000, "height": 600})
            if not has_scene:
                page.route("**/scene/**", lambda route: route.fulfill(body="", content_type="text/html"))
            page.set_default_timeout(60_000)
            page.errors = []
            page.on("pageerror", lambda error: page.errors.append(str(error)))
            page.add_init_script(script)
            page.goto(address)
            wait_until(lambda: page.evaluate("window.viewer?.frames ?? 0") > 0)
            return page

        yield open_page


@contextlib.contextmanager
def run_viewer(viewer: Any) -> Iterator[Any]:
    """Run a viewer in a thread during the block; it must end after `stop`."""
    with viewer:
        thread = threading.Thread(target=viewer.run, daemon=True)
        thread.start()
        yield viewer
        viewer.stop()
        thread.join(30)
        assert not thread.is_alive()


def wait_until(condition: Callable[[], Any], seconds: float = 60.0) -> None:
    """Wait until a condition holds; it must within some seconds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)
