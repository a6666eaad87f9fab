"""`spear`, and `python -m spear_pin`: the command line as a process, with its signals, streams and environment.

It imports next to nothing before it heeds signals; what the commands need takes longer to import than to interrupt.
"""

from __future__ import annotations

import os
import signal
import sys

TYPE_CHECKING = False  # typing takes long to import
if TYPE_CHECKING:
    from types import FrameType
    from typing import NoReturn

IMPORTER = "<frozen importlib._bootstrap>"
SOON = 0.05  # s


def main() -> NoReturn:
    """Run the command line and exit with its status; 130 after SIGINT, 143 after SIGTERM."""
    received: list[int] = []
    working = False

    def end(number: int, frame: FrameType | None) -> None:
        """Unwind what is under way, so that nothing is left behind; at once where that is asked for again."""
        if received or not working:
            os._exit(128 + number)
        received.append(number)
        unwind(number, frame)

    def unwind(number: int, frame: FrameType | None) -> None:
        """Leave, and again where that was not heard, as in a library's callback.

        No module is left half imported, for what imports it may take it for one that is not installed; and what
        cleans up, for this or another exception, is left to end.
        """
        signal.setitimer(signal.ITIMER_REAL, SOON if working else 0.0)
        if working and not _importing(frame) and sys.exception() is None:
            raise SystemExit(128 + received[0])

    def ignored(unraisable: sys.UnraisableHookArgs) -> None:
        """Print an exception that Python ignores, unless a signal has been received."""
        if not received:
            sys.__unraisablehook__(unraisable)

    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as in a background job
            signal.signal(number, end)
    signal.signal(signal.SIGALRM, unwind)
    sys.unraisablehook = ignored
    _open_streams()
    # figures are drawn into files, which carry no date: neither is of use, and libraries trip over bad ones
    os.environ["MPLBACKEND"] = "agg"
    os.environ.pop("SOURCE_DATE_EPOCH", None)
    from spear_pin import cli

    try:
        working = True
        status: object = cli.main()
    except SystemExit as ended:
        status = ended.code
    except BaseException:
        if not received:  # else it is what a library made of the signal
            raise
    finally:
        working = False
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    raise SystemExit(128 + received[0] if received else status)


def _importing(frame: FrameType | None) -> bool:
    while frame is not None and frame.f_code.co_filename != IMPORTER:
        frame = frame.f_back
    return frame is not None


def _open_streams() -> None:
    """Let no file take the place of a standard stream that is closed, and no character be one too many."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY if name == "stdout" else os.O_RDWR)  # what is printed is then missed
            if number:
                setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


if __name__ == "__main__":  # worker processes import this module too
    main()
