"""A file of the user's candidates is tried in a process of its own first, where compiled code that loops can be stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from pounding.diagnosis.effects.candidate_file import read_candidates
from pounding.diagnosis.errors import CaseError

TRIAL_S = 60.0
"""Time in which a file must be read, compiled and tried [s]; one of three functions takes two, Python's start included."""
START_S = 60.0
"""Time that Python may take to start before it [s]: a second, but on a busy machine ten, which is no fault of the file's."""

_CHILD = f"from {__name__} import in_child; in_child()"
_TRYING, _DONE = "trying: ", "all tried"
_RANG = -signal.SIGALRM if hasattr(signal, "SIGALRM") else None
"""What a process leaves that its own clock ended."""


def try_out(path: Path | str) -> None:
    """Execute, compile and try a file of candidates in a process that is ended when it takes too long.

    What else is wrong with the file is left to `read_candidates`, which says it better.

    Args:
        path: Python file of the user's.

    Raises:
        CaseError: The file does not come to an end within `TRIAL_S`, or it ends Python itself.
    """
    # The child finds what this process finds, whatever lies in the current folder.
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-P", "-c", _CHILD, str(path), str(TRIAL_S)]
    try:
        child = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=START_S + TRIAL_S,
        )
        told, late = child.stdout, child.returncode == _RANG
    except subprocess.TimeoutExpired as error:
        told, late = error.stdout or b"", True
    lines = told.decode(errors="replace").splitlines()
    if _DONE in lines:
        return
    where = next(
        (line.removeprefix(_TRYING) for line in reversed(lines) if line.startswith(_TRYING)), str(path)
    )
    if late:
        raise CaseError(
            f"{where} was given up after {TRIAL_S:g} s: its code does not come to an end; look for a loop that never stops"
        )
    raise CaseError(
        f"{where} ends Python itself when it is tried; look for a recursion or an exit in its code"
    )


def in_child() -> None:
    """Try the file that the command line names; whatever is wrong with it, that its code came to an end is said."""
    path, limit_s = sys.argv[1:]
    if _RANG is not None:
        # This process ends, too, where the one that waits for it was killed.
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, float(limit_s))
    with suppress(Exception):  # The caller meets the same error and says it.
        read_candidates(path, lambda where: print(f"\n{_TRYING}{where}", flush=True))
    print(f"\n{_DONE}", flush=True)
