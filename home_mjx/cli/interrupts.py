"""Ctrl-C ends a command within seconds, also while JAX compiles.

Python raises `KeyboardInterrupt` only between two of its instructions. XLA compiles a program within one, for up to a
minute. An interrupt while JAX traces or lowers a program leaves objects whose destruction crashes or hangs the process.
"""

import os
import signal
import socket
import sys
import threading
from typing import NoReturn

INTERRUPTED = 130  # exit code, as of shells
GRACE = 1.0  # [s], for Python to notice; after that it is inside a long call


def watch_interrupts() -> None:
    """From now on, Ctrl-C ends this process; called in the main thread.

    The first raises `KeyboardInterrupt`, as always. If Python has not noticed it within a second, or is interrupted
    again, the process ends at once with code 130. An ignored SIGINT (`nohup command &`) stays ignored.

    Example:
        >>> watch_interrupts()  # doctest: +SKIP
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return
    noticed = threading.Event()

    def handle(number: int, frame: object) -> None:
        noticed.set()
        raise KeyboardInterrupt

    reader, writer = socket.socketpair()
    writer.setblocking(False)
    signal.signal(signal.SIGINT, handle)
    # The operating system's handler writes here at once, whatever Python does.
    signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader, writer, noticed), daemon=True).start()


def leave() -> NoReturn:
    """Ends this process as interrupted, and destroys nothing."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:  # its reader has left
            continue
    _end()


def _watch(reader: socket.socket, writer: socket.socket, noticed: threading.Event) -> None:
    _wait(reader)
    if noticed.wait(GRACE):
        _wait(reader)
    _end()


def _wait(reader: socket.socket) -> None:
    while signal.SIGINT not in reader.recv(1):  # one byte per signal that Python handles
        continue


def _end() -> NoReturn:
    try:
        os.write(2, b"\nhome-mjx: interrupted\n")
    finally:
        os._exit(INTERRUPTED)
