"""Front of the viewer: one port with the page, its channels and viser's scene behind it; checks who asks (asyncio)."""

import asyncio
import http
import io
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from email.message import Message
from http.client import HTTPException, parse_headers
from http.cookies import CookieError, SimpleCookie
from typing import NamedTuple
from urllib.parse import parse_qs, urlsplit

from home_mjx.errors import ConfigError

LOCAL_NAMES = ("localhost", "127.0.0.1", "::1")
MAX_HEAD_BYTES = 1 << 16
HEAD_SECONDS = 10.0  # [s], time within which a request's head must arrive
CHUNK_BYTES = 1 << 16
PORT_TRIES = 20  # number of ports that are tried, from the given one on
COOKIE = "home_mjx_token"
# The page has gone, or its request is not HTTP.
GONE = (OSError, TimeoutError, asyncio.IncompleteReadError, asyncio.LimitOverrunError, HTTPException, ValueError)
PAGE_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Connection": "close",
}


class PageFile(NamedTuple):
    """A file that the front serves."""

    kind: str  # MIME type
    data: bytes


class Upstream(NamedTuple):
    """A server on this machine to which requests below a prefix go."""

    port: int
    path: str  # path that replaces the prefix


class Request(NamedTuple):
    """Head of a request."""

    method: str
    target: str  # path with query
    version: str
    headers: Message

    @property
    def is_websocket(self) -> bool:
        """True if the request opens a WebSocket."""
        return self.headers.get("Upgrade", "").lower() == "websocket"


@dataclass(frozen=True)
class Front:
    """Routes and access of the viewer's one port.

    Requests must name this machine or carry the token, so that no page of another origin can drive the simulation.

    Attributes:
        files: Files by path.
        upstreams: Servers by path, or by prefix such as `/scene/`, which also stands for `/scene`.
        token: Secret that the first address carries as `?token=`, and a cookie after it; None: only requests to
            localhost are answered.
    """

    files: Mapping[str, PageFile]
    upstreams: Mapping[str, Upstream]
    token: str | None = None

    async def handle(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one connection, and close it."""
        try:
            request = await asyncio.wait_for(read_head(reader), HEAD_SECONDS)
            reason = self.refusal(request)
            if reason is not None:
                writer.write(format_response(http.HTTPStatus.FORBIDDEN, PageFile("text/plain", reason.encode())))
            elif (upstream := self.find_upstream(request.target)) is not None:
                await _relay(request, upstream, reader, writer)
            else:
                writer.write(self._file(request))
            await writer.drain()
        except GONE:
            pass  # there is nobody to tell
        finally:
            writer.close()

    def refusal(self, request: Request) -> str | None:
        """Return why a request is refused; None: it is answered."""
        host, origin = request.headers.get("Host", ""), request.headers.get("Origin")
        if origin is not None and urlsplit(origin).netloc != host:
            return f"this page belongs to {origin}; open the viewer's own address"
        if self.token is None:
            name = urlsplit(f"//{host}").hostname
            return None if name in LOCAL_NAMES else f"the viewer answers on localhost only, not as {host}"
        given = (*parse_qs(urlsplit(request.target).query).get("token", ()), _cookie(request))
        if any(secrets.compare_digest(text.encode(), self.token.encode()) for text in given):
            return None
        return "open the whole address that the viewer has printed, with its token"

    def find_upstream(self, target: str) -> Upstream | None:
        """Return the server of a path, with the path there; None: it is a file's."""
        path = urlsplit(target).path
        for prefix, upstream in self.upstreams.items():
            if path == prefix.rstrip("/") or (prefix.endswith("/") and path.startswith(prefix)):
                return upstream._replace(path=upstream.path + path[len(prefix) :])
        return None

    def _file(self, request: Request) -> bytes:
        """Return the response with a file; with the token's cookie, so that later requests carry it."""
        file = self.files.get(urlsplit(request.target).path)
        if file is None or request.method != "GET":
            return format_response(http.HTTPStatus.NOT_FOUND, PageFile("text/plain", b"no such page"))
        cookie = {} if self.token is None else {"Set-Cookie": f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict"}
        return format_response(http.HTTPStatus.OK, file, cookie)


async def read_head(reader: asyncio.StreamReader) -> Request:
    """Read a request's head.

    Raises:
        ValueError: It is not that of an HTTP request.
        asyncio.IncompleteReadError: The connection ends before.
        asyncio.LimitOverrunError: It is longer than the reader's limit.
    """
    head = await reader.readuntil(b"\r\n\r\n")
    line, _, rest = head.partition(b"\r\n")
    method, target, version = line.decode("latin-1").split(" ")
    return Request(method, target, version, parse_headers(io.BytesIO(rest)))


def format_response(status: http.HTTPStatus, file: PageFile, more: Mapping[str, str] | None = None) -> bytes:
    """Return a whole response with a file as its body."""
    headers = {**PAGE_HEADERS, "Content-Type": file.kind, "Content-Length": str(len(file.data)), **(more or {})}
    lines = [f"HTTP/1.1 {status.value} {status.phrase}", *(f"{name}: {text}" for name, text in headers.items())]
    return "\r\n".join([*lines, "", ""]).encode() + file.data


def open_port(host: str, port: int) -> socket.socket:
    """Return a listening socket on a port, or on the next free one; 0: any free port.

    Raises:
        ConfigError: The host cannot be bound, or `PORT_TRIES` ports are taken.
    """
    problem = None
    for number in [port] if port == 0 else range(port, min(port + PORT_TRIES, 1 << 16)):
        try:
            family = socket.getaddrinfo(host, number, type=socket.SOCK_STREAM)[0][0]
            return socket.create_server((host, number), family=family)
        except OSError as error:
            problem = error
    raise ConfigError(f"cannot listen on {host}, port {port} or the next ones: {problem}", hint="Pass another --port.")


def _cookie(request: Request) -> str:
    """Return the token of a request's cookie; "" if there is none."""
    try:
        cookie = SimpleCookie(request.headers.get("Cookie", ""))
    except CookieError:
        return ""
    return cookie[COOKIE].value if COOKIE in cookie else ""


async def _relay(
    request: Request, upstream: Upstream, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
) -> None:
    """Pass a request to a server and copy both directions until either ends."""
    far_reader, far_writer = await asyncio.open_connection("127.0.0.1", upstream.port)
    headers = [(name, text) for name, text in request.headers.items() if name.lower() != "connection"]
    headers.append(("Connection", "Upgrade" if request.is_websocket else "close"))
    lines = [f"{request.method} {upstream.path} {request.version}", *(f"{name}: {text}" for name, text in headers)]
    far_writer.write("\r\n".join([*lines, "", ""]).encode("latin-1"))
    both = [asyncio.create_task(_copy(reader, far_writer)), asyncio.create_task(_copy(far_reader, writer))]
    try:
        await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in both:
            task.cancel()
        await asyncio.gather(*both, return_exceptions=True)
        far_writer.close()


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Copy bytes until the end."""
    while data := await reader.read(CHUNK_BYTES):
        writer.write(data)
        await writer.drain()
