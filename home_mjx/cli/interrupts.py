"""Handling of Ctrl-C and SIGTERM, which end a command within seconds, even while JAX compiles.

Python raises `KeyboardInterrupt` only between two bytecode instructions, and XLA compiles a program within one, for up
to a minute. An interrupt while JAX traces or lowers a program leaves objects whose destruction may crash or hang.
"""

import os
import signal
import socket
import sys
import threading
from typing import NoReturn

EXIT_INTERRUPTED = 130  # exit code of Ctrl-C, as in shells
SIGNAL_EXIT = 128  # added to the number of a signal, as in shells
GRACE_PERIOD = 1.0  # [s] for Python to raise; after that it must be inside a long call


def watch_interrupts() -> None:
    """Install a handler that ends this process on Ctrl-C and SIGTERM; call it in the main thread.

    The first signal raises `KeyboardInterrupt(number)`, so that open files are completed also when a scheduler ends a
    job. If Python has not raised it within a second, or is interrupted again, the process ends at once with code 128 +
    number: 130 or 143. Any handler other than Python's default stays, as does an ignored SIGINT (`nohup command &`).
    """
    defaults = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    watched = frozenset(number for number, default in defaults.items() if signal.getsignal(number) == default)
    if not watched:
        return
    noticed = threading.Event()

    def handle(number: int, frame: object) -> None:
        """Record the signal and raise `KeyboardInterrupt`."""
        noticed.set()
        raise KeyboardInterrupt(number)

    reader, writer = socket.socketpair()
    writer.setblocking(False)
    for number in watched:
        signal.signal(number, handle)
    # The C-level signal handler writes here at once, even while Python is inside a long call.
    signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    # The writer is passed too: it would be closed here otherwise.
    threading.Thread(target=_watch, args=(reader, writer, noticed, watched), daemon=True).start()


def exit_interrupted(number: int = signal.SIGINT) -> NoReturn:
    """Flush the output, report signal `number` on stderr, and end this process with code 128 + number.

    No object is destroyed.
    """
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:  # its reader has closed the pipe
            continue
    _end(number)


def _watch(reader: socket.socket, writer: socket.socket, noticed: threading.Event, watched: frozenset[int]) -> None:
    """End this process on a watched signal that is not `noticed` within `GRACE_PERIOD`, else on the next one."""
    number = _wait(reader, watched)
    if noticed.wait(GRACE_PERIOD):
        number = _wait(reader, watched)
    _end(number)


def _wait(reader: socket.socket, watched: frozenset[int]) -> int:
    """Block until a watched signal arrives, and return its number."""
    while (number := reader.recv(1)[0]) not in watched:  # one byte per signal that Python handles
        continue
    return number


def _end(number: int) -> NoReturn:
    """Report a signal on stderr and end this process at once with code 128 + number."""
    try:
        os.write(2, b"\nhome-mjx: interrupted\n" if number == signal.SIGINT else b"\nhome-mjx: terminated\n")
    finally:
        os._exit(SIGNAL_EXIT + number)
