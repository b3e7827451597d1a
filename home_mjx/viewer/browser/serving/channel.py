"""Channels from the simulation to browser pages: messages are broadcast, and slow pages lose the oldest ones."""

import asyncio
import json
from collections import deque
from collections.abc import Callable, Collection
from typing import Any, NamedTuple

Message = bytes | str
MAX_KEY_BYTES = 4096  # [bytes] maximum size of a page's message


class _Page(NamedTuple):
    """Number of one page, its queue, and the event that wakes its sender."""

    number: int
    queue: deque[Message]
    event: asyncio.Event


class Channel:
    """Broadcast of messages to all pages that have connected: binary ones are data, text ones are JSON.

    Args:
        capacity: Maximum number of binary messages that wait for one page; older ones are dropped. Text is kept.
        on_message: Callback for each message of a page, parsed from JSON, with the page's number as `page`; the last
            one has the type `leave`. It runs on the server's thread.
        greeting: Function that returns the first message of each page; None: no message.
    """

    def __init__(
        self,
        capacity: int,
        on_message: Callable[[Any], None] = lambda message: None,
        greeting: Callable[[], Message | None] = lambda: None,
    ) -> None:
        self.capacity, self._on_message, self._greeting = capacity, on_message, greeting
        self._pages: list[_Page] = []
        self._count = 0
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def num_pages(self) -> int:
        """Number of connected pages."""
        return len(self._pages)

    @property
    def pages(self) -> tuple[int, ...]:
        """Numbers of the connected pages."""
        return tuple(page.number for page in self._pages)

    def publish(self, message: Message, pages: Collection[int] | None = None) -> None:
        """Send a message to some connected pages, None: to all, without waiting; from any thread."""
        loop = self._loop
        if loop is not None and self._pages and not loop.is_closed():
            loop.call_soon_threadsafe(self._put, message, pages)

    async def serve(self, connection: Any) -> None:
        """Serve one page until it closes the connection."""
        self._loop = asyncio.get_running_loop()
        self._count += 1
        page = _Page(self._count, deque(), asyncio.Event())
        self._pages.append(page)  # before the greeting, which may ask for a picture
        greeting = self._greeting()
        if greeting is not None:
            page.queue.append(greeting)
            page.event.set()
        sender = asyncio.create_task(_send(connection, page))
        try:
            async for text in connection:
                self._receive(text, page.number)
        finally:
            self._pages.remove(page)
            self._on_message({"type": "leave", "page": page.number})
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)

    def _put(self, message: Message, pages: Collection[int] | None) -> None:
        """Append a message to the queues of pages, None: of all; drop the oldest binary one if too many wait."""
        for page in self._pages:
            if pages is not None and page.number not in pages:
                continue
            waiting = [queued for queued in page.queue if isinstance(queued, bytes)]
            if isinstance(message, bytes) and len(waiting) >= self.capacity:
                page.queue.remove(waiting[0])
            page.queue.append(message)
            page.event.set()

    def _receive(self, text: Message, page: int) -> None:
        """Pass a page's message on; anything but a small JSON object is ignored."""
        if len(text) > MAX_KEY_BYTES:
            return
        try:
            message = json.loads(text)
        except ValueError:
            return
        if isinstance(message, dict):
            self._on_message({**message, "page": page})


async def _send(connection: Any, page: _Page) -> None:
    """Send the messages of a page's queue until the task is cancelled or the connection closes."""
    while True:
        await page.event.wait()
        page.event.clear()
        while page.queue:
            await connection.send(page.queue.popleft())
