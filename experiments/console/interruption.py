"""Ctrl-C and a request to end, at whatever moment: one line and an exit status of its own.

Only the standard library is imported here, so that the command heeds Ctrl-C while it still imports all the others.
"""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

ENDINGS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
"""What is said when one of these ends the command."""

SHELL = 128
"""A shell's exit status of a program that was ended by signal n is this plus n: 130 for Ctrl-C."""

AGAIN_S = 0.02
"""Time after which a signal comes again [s] that came where its exception is dropped."""


class _Interruption(KeyboardInterrupt):
    """Unlike its base it can be referred to weakly: when nobody holds it any more, somebody dropped it."""


@contextmanager
def heeding() -> Iterator[None]:
    """Leave with one line and status 130 (or 143) when the block is interrupted (or the process asked to end).

    Libraries in other languages make errors of their own of an interruption, and half-imported modules miss names.
    Whatever ends the block after a signal came, the signal was its reason.

    Raises:
        SystemExit: A signal ended the block.
    """
    received: list[signal.Signals] = []
    raised: list[weakref.ref[_Interruption]] = []
    inside = True

    def heed(number: int, _frame: FrameType | None) -> NoReturn:
        received.append(signal.Signals(number))
        raise watched()  # a name for it here would hold it: its traceback has this frame

    def watched() -> _Interruption:
        interruption = _Interruption()
        raised.append(weakref.ref(interruption, dropped))
        return interruption

    def dropped(_interruption: object) -> None:
        # Finalisers, callbacks and some libraries drop whatever is raised in them; one on its way out is held.
        if inside:
            timer = threading.Timer(AGAIN_S, _thread.interrupt_main, [received[0]])
            timer.daemon = True
            timer.start()

    usual = sys.unraisablehook

    def quiet(unraisable: sys.UnraisableHookArgs) -> None:
        if not issubclass(unraisable.exc_type, _Interruption):
            usual(unraisable)

    before = _install(heed)
    sys.unraisablehook = quiet
    try:
        yield
    except BaseException as error:
        inside = False
        if not received and not isinstance(error, KeyboardInterrupt):
            raise
        for number in before:  # the cleaning up is not to be interrupted again
            signal.signal(number, signal.SIG_IGN)
        before = {}
        how_far = str(error) if isinstance(error, KeyboardInterrupt) else ""
        _leave((*received, signal.SIGINT)[0], how_far)
    finally:
        inside = False
        sys.unraisablehook = usual
        for number, handler in before.items():
            signal.signal(number, handler)


def _install(heed: signal._HANDLER) -> dict[signal.Signals, signal._HANDLER]:
    """Install a handler where the signal has its default one, and return that one by signal."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    defaults = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: signal.getsignal(number) for number in ENDINGS}
    before = {number: handler for number, handler in before.items() if handler in defaults}
    for number in before:
        signal.signal(number, heed)
    return before


def _leave(number: signal.Signals, how_far: str) -> NoReturn:
    said = f"{ENDINGS[number]}; {how_far}" if how_far else ENDINGS[number]
    sys.stderr.write(f"pounding: {said}\n")
    sys.exit(SHELL + number)
