"""The one place where an error becomes a sentence and an exit status."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from cyclopts import App, CycloptsError
from rich.console import Console

from pounding.errors import InputError
from pounding.experiments.results.provenance import software_version

BAD_INPUT = 2
INTERRUPTED = 130


def command(**named: Any) -> App:
    """Return a command without words yet; `run` says what it raises."""
    return App(
        version=software_version,
        # An unknown option or a value of the wrong kind is bad input like any other: one sentence, status 2.
        exit_on_error=False,
        print_error=False,
        # The verbs return nothing to show and never an exit status: they print by themselves.
        result_action="return_value",
        # Ctrl-C has a sentence of its own (see `run`).
        suppress_keyboard_interrupt=False,
        **named,
    )


def run(app: App, arguments: Sequence[str] | None = None) -> None:
    """Run a command and leave with its exit status.

    Args:
        app: The command.
        arguments: Its words; those of the command line when None.

    Raises:
        SystemExit: 2 with one sentence on standard error for bad input, 130 when interrupted.
    """
    warnings.showwarning = _warned
    try:
        app(arguments)
    except InputError as error:
        _leave(str(error), BAD_INPUT)
    except CycloptsError as error:
        _leave(f"{error} (see {' '.join(app.name)} --help)", BAD_INPUT)
    except BrokenPipeError:
        # The reader of our output (a pager, `head`) has seen enough; nothing more can be told to it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except OSError as error:
        # A folder that cannot be written, a full disk: the user's to mend, and no traceback helps.
        place = f"{error.filename}: " if error.filename else ""
        _leave(f"{place}{error.strerror or error}", BAD_INPUT)
    except KeyboardInterrupt:
        _leave("interrupted; what was finished is kept, the same command goes on from there", INTERRUPTED)


def run_script(function: Callable[..., Any]) -> None:
    """Run a script's function by `python -m`: options, sentences and exit status are those of the command."""
    spec = getattr(sys.modules["__main__"], "__spec__", None)
    app = command(name=f"python -m {spec.name}" if spec else sys.argv[0])
    app.default(function)
    run(app)


def _warned(message: Warning | str, category: type[Warning], *_place: Any, **_more: Any) -> None:
    """Show our own warnings as sentences; a library's are for its developers, not for a user."""
    if issubclass(category, UserWarning):
        Console(stderr=True, highlight=False, soft_wrap=True).print(f"warning: {message}", markup=False)


def _leave(sentence: str, status: int) -> None:
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    console.print(f"pounding: {' '.join(sentence.split())}", markup=False)
    sys.exit(status)
