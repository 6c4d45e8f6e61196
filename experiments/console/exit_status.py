"""The one place where an error becomes a sentence and an exit status."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from cyclopts import (
    App,
    CoercionError,
    CycloptsError,
    MissingArgumentError,
    UnknownCommandError,
    ValidationError,
)
from rich.console import Console

from pounding.errors import InputError
from pounding.experiments.console import remarks
from pounding.experiments.console.completion import Command
from pounding.experiments.console.interruption import heeding
from pounding.experiments.results.provenance import software_version
from pounding.spelling import did_you_mean, nearest

BAD_INPUT = 2
NUMBERS: dict[type | None, tuple[str, str]] = {
    float: ("number", "; a unit, if it has one, is stated in the help and not typed"),
    int: ("whole number", ""),
}
"""What a number is called in a sentence, and what is to be done."""


def command(**named: Any) -> App:
    """Return a command without words yet; `run` says what it raises."""
    return Command(
        version=software_version,
        # An unknown option or a value of the wrong kind is bad input like any other: one sentence, status 2.
        exit_on_error=False,
        print_error=False,
        # The verbs return nothing to show and never an exit status: they print by themselves.
        result_action="return_value",
        # Ctrl-C has a sentence of its own (see `heeding`).
        suppress_keyboard_interrupt=False,
        **named,
    )


def run(app: App, arguments: Sequence[str] | None = None) -> None:
    """Run a command and leave with its exit status.

    Args:
        app: The command.
        arguments: Its words; those of the command line when None.

    Raises:
        SystemExit: 2 with one sentence on standard error for bad input, 130 when interrupted, 143 when terminated.
    """
    warnings.showwarning = _warned
    _open_streams()
    remarks.show()
    try:
        with heeding():
            app(arguments)
            # What a pipe or a disk does not take shall show here, not when Python ends.
            sys.stdout.flush()
    except InputError as error:
        _leave(str(error), BAD_INPUT)
    except ValidationError as error:
        _leave(_of_option(error), BAD_INPUT)
    except CycloptsError as error:
        page = " ".join([*app.name, *(error.command_chain or ())])
        said = _of_verb(app, error) if isinstance(error, UnknownCommandError) else _of_words(error)
        _leave(f"{said} (see {page} --help)", BAD_INPUT)
    except BrokenPipeError:
        # The reader of our output (a pager, `head`) has seen enough; nothing more can be told to it.
        _drop_output()
        sys.exit(0)
    except OSError as error:
        _drop_output()
        # A folder that cannot be written, a full disk: the user's to mend, and no traceback helps.
        place = f"{error.filename}: " if error.filename else ""
        _leave(f"{place}{error.strerror or error}", BAD_INPUT)


def run_script(function: Callable[..., Any]) -> None:
    """Run a script's function by `python -m`: options, sentences and exit status are those of the command."""
    spec = getattr(sys.modules["__main__"], "__spec__", None)
    app = command(name=f"python -m {spec.name}" if spec else sys.argv[0])
    app.default(function)
    run(app)


def _of_option(error: ValidationError) -> str:
    """Return what is wrong with an option whose value was checked, the option first."""
    tokens = error.argument.tokens if error.argument else []
    option = next((token.keyword for token in tokens if token.keyword), None)
    return f"{option}: {error.exception_message}" if option else str(error)


def _of_verb(app: App, error: UnknownCommandError) -> str:
    """Return that a verb, or the name of a study, is not known, and which were meant."""
    for name in error.command_chain or ():
        app = app[name]
    (word, *_) = error.unused_tokens or ("",)
    question = did_you_mean(nearest(word, [name for name in app if not name.startswith("-")]))
    return f"{word!r} is not known" + (f"; {question}" if question else "")


def _of_words(error: CycloptsError) -> str:
    """Return what is wrong with the words of a command, in the words of its help and not in those of Python."""
    argument = error.argument
    if isinstance(error, MissingArgumentError) and argument:
        name = argument.name
        if name in (error.root_input_tokens or ()):
            return f"{name} needs a value"
        if error.unused_tokens:
            # One of them may be this option, mistyped: cyclopts says which.
            return str(error)
        return f"{name.lstrip('-').upper() if argument.field_info.is_positional else name} is missing"
    if isinstance(error, CoercionError) and error.token and error.target_type in NUMBERS:
        option = error.token.keyword or (argument.name.lstrip("-").upper() if argument else "")
        kind, hint = NUMBERS[error.target_type]
        return f"{option}: {error.token.value!r} is not a {kind}{hint}"
    return str(error)


def _open_streams() -> None:
    """Refuse to work for a closed standard output, and let no character be one that the terminal cannot show.

    Where standard output is closed, its number goes to the next file that is opened, and what is printed into that file.
    """
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if sys.stdout is None:
        _leave("standard output is closed; send it to a file, or to /dev/null", BAD_INPUT)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors="replace")


def _drop_output() -> None:
    """Send what is still to be written to nowhere, for Python would fail on it once more when it ends."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _warned(message: Warning | str, category: type[Warning], *_place: Any, **_more: Any) -> None:
    """Show our own warnings as sentences; a library's are for its developers, not for a user."""
    if issubclass(category, UserWarning):
        Console(stderr=True, highlight=False, soft_wrap=True).print(f"warning: {message}", markup=False)


def _leave(sentence: str, status: int) -> None:
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    plain = "".join(letter if letter.isprintable() else "?" for letter in " ".join(sentence.split()))
    console.print(f"pounding: {plain}", markup=False)
    sys.exit(status)
