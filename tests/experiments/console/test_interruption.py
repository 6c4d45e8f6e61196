"""Ctrl-C is an interruption wherever it comes: in an import, in the engine, in what an engine makes of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable

import numpy as np
import pytest

from pounding import frames
from pounding.experiments.console.interruption import heeding
from pounding.experiments.rig.rig import Rig

DURING_AN_IMPORT = """
import os, signal, sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == sys.argv[1]:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
from pounding.experiments.command import main
main(["modal", "5A"])
"""


@pytest.mark.parametrize("module", ["cyclopts", "rich", "numpy", "scipy.linalg", "pounding.frames.building"])
def test_during_imports(module: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", DURING_AN_IMPORT, module], capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "pounding: interrupted\n")


def interrupt_after(calls: int) -> Callable[[float], None]:
    """Return a progress function that has this process interrupted at its n-th call, from inside the engine."""
    left = [calls]

    def progress(_time_s: float) -> None:
        left[0] -= 1
        if left[0] == 0:
            os.kill(os.getpid(), signal.SIGINT)

    return progress


def test_inside_the_engine_it_is_no_error_of_physics(stick: frames.ReducedFrame) -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            Rig([stick]).run(np.sin(np.arange(4000) / 50.0), 0.0036, progress=interrupt_after(2))
    finally:
        signal.signal(signal.SIGINT, before)


def ended_by(number: signal.Signals, made_of_it: Exception | None) -> None:
    """Have this process signalled, and an error made of it."""
    with heeding():
        try:
            os.kill(os.getpid(), number)
        except KeyboardInterrupt:
            if made_of_it is not None:
                raise made_of_it from None
            raise


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize(
    "made_of_it", [ImportError("cannot import name"), ValueError("lower the shaking"), None]
)
def test_whatever_is_made_of_the_signal(
    number: signal.Signals, status: int, made_of_it: Exception | None, capsys: pytest.CaptureFixture[str]
) -> None:
    handlers = {each: signal.signal(each, signal.SIG_DFL) for each in (signal.SIGINT, signal.SIGTERM)}
    try:
        with pytest.raises(SystemExit) as left:
            ended_by(number, made_of_it)
    finally:
        for each, handler in handlers.items():
            signal.signal(each, handler)
    assert left.value.code == status
    assert capsys.readouterr().err == f"pounding: {'interrupted' if status == 130 else 'terminated'}\n"


def test_an_error_without_a_signal_stays_what_it_is() -> None:
    with pytest.raises(ZeroDivisionError), heeding():
        _ = 1 / 0


def test_a_program_that_ignores_ctrl_c_goes_on_ignoring_it() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with heeding():
            os.kill(os.getpid(), signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_another_thread_leaves_signals_alone() -> None:
    found = []

    def work() -> None:
        with heeding():
            found.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert found == [before]


DROPPING = {
    "a finaliser": "class Dying:\n    def __del__(self):\n        interrupt()\nDying()",
    "a weak reference": "class Dying: pass\none = Dying()\nheld = weakref.ref(one, interrupt)\ndel one",
    "a library": "with contextlib.suppress(BaseException):\n    interrupt()",
}
"""Code that drops whatever is raised in it."""


@pytest.mark.parametrize("code", DROPPING.values(), ids=list(DROPPING))
def test_where_exceptions_are_dropped(code: str) -> None:
    """The command would go on, some with a traceback."""
    code = (
        "import contextlib, signal, time, weakref\n"
        "from pounding.experiments.console.interruption import heeding\n"
        "def interrupt(*_):\n"
        "    signal.raise_signal(signal.SIGINT)\n"
        f"code = {code!r}\n"
        "with heeding():\n"
        "    exec(code)\n"
        # The signal that comes again ends no sleep, but the one after it does not begin.
        "    for _ in range(400):\n"
        "        time.sleep(0.05)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "pounding: interrupted\n")
