"""Handling of Ctrl-C, which ends a command within seconds, even while JAX compiles.

Python raises `KeyboardInterrupt` only between two bytecode instructions, and XLA compiles a program within one, for up
to a minute. An interrupt while JAX traces or lowers a program leaves objects whose destruction may crash or hang.
"""

import os
import signal
import socket
import sys
import threading
from typing import NoReturn

EXIT_INTERRUPTED = 130  # exit code, as in shells
GRACE_PERIOD = 1.0  # [s] for Python to raise; after that it must be inside a long call


def watch_interrupts() -> None:
    """Install a handler that ends this process on Ctrl-C; call it in the main thread.

    The first interrupt raises `KeyboardInterrupt`, as always. If Python has not raised it within a second, or is
    interrupted again, the process ends at once with code 130. Any handler other than Python's default stays, as does an
    ignored SIGINT (`nohup command &`).
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return
    noticed = threading.Event()

    def handle(number: int, frame: object) -> None:
        """Record the interrupt and raise `KeyboardInterrupt`."""
        noticed.set()
        raise KeyboardInterrupt

    reader, writer = socket.socketpair()
    writer.setblocking(False)
    signal.signal(signal.SIGINT, handle)
    # The C-level signal handler writes here at once, even while Python is inside a long call.
    signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader, writer, noticed), daemon=True).start()


def exit_interrupted() -> NoReturn:
    """Flush the output, report the interrupt on stderr, and end this process with code 130; destroy no object."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:  # its reader has closed the pipe
            continue
    _end()


def _watch(reader: socket.socket, writer: socket.socket, noticed: threading.Event) -> None:
    """End this process on an interrupt that is not `noticed` within `GRACE_PERIOD`, else on the next one."""
    _wait(reader)
    if noticed.wait(GRACE_PERIOD):
        _wait(reader)
    _end()


def _wait(reader: socket.socket) -> None:
    """Block until SIGINT arrives."""
    while signal.SIGINT not in reader.recv(1):  # one byte per signal that Python handles
        continue


def _end() -> NoReturn:
    """Report the interrupt on stderr and end this process at once with code 130."""
    try:
        os.write(2, b"\nhome-mjx: interrupted\n")
    finally:
        os._exit(EXIT_INTERRUPTED)
