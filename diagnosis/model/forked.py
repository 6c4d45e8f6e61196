"""Independent pieces of work in worker processes: of what Python itself does, threads would do one thing at a time.

A worker is forked from this process, which takes a moment, and has all that a piece needs already; only its result is sent
back. Where processes cannot be forked, or libraries of the system do not survive it, pieces are done in turn.
"""

from __future__ import annotations

import io
import multiprocessing
import pickle
import signal
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.side_by_side import cores, in_turn

T = TypeVar("T")
R = TypeVar("R")

FORKS = sys.platform == "linux"
"""Whether workers may be forked from this process: elsewhere libraries of the system do not survive it."""


def forked(
    function: Callable[[T], R],
    pieces: Sequence[T],
    told: Callable[[T], None] | None = None,
    shared: Sequence[object] = (),
    at_once: bool = True,
) -> list[R]:
    """Return the function's result for each piece, in the order of the pieces, as `side_by_side` does.

    Args:
        function: Does a piece. What it changes is not seen here, only what it returns.
        pieces: The pieces.
        told: Called with each piece as its turn comes, in the order of the pieces.
        shared: Objects that results may refer to, which are large or have no name by which they could be imported: a
            result refers to the same ones here.
        at_once: Whether there is memory for several pieces at a time; else they are done in turn.

    Raises:
        CaseError: A worker was ended from outside, as when memory runs out.
    """
    if not (FORKS and at_once) or cores() < 2 or len(pieces) < 2:
        return in_turn(function, pieces, told)
    turns = iter(range(len(pieces)))
    results: dict[int, R] = {}
    busy: list[_Worker] = []

    def begin(worker: _Worker) -> None:
        number = next(turns, None)
        worker.begin(number)
        if number is None:
            busy.remove(worker)
        elif told is not None:
            told(pieces[number])

    with ExitStack() as stack:
        for _ in range(min(cores(), len(pieces))):
            busy.append(stack.enter_context(_Worker(function, pieces, shared)))
            begin(busy[-1])
        while busy:
            ready = wait([worker.answers for worker in busy])
            for worker in [one for one in busy if one.answers in ready]:
                number, results[number] = worker.result()
                begin(worker)
    return [results[number] for number in range(len(pieces))]


@contextmanager
def meanwhile(
    function: Callable[[], R], at_once: bool = True, shared: Sequence[object] = ()
) -> Iterator[Callable[[], R]]:
    """Have a worker process work while this one goes on; what is yielded waits for its result and returns it.

    Where there is no second core, or no worker, the work is done when its result is asked for.

    Args:
        function: Does the work. What it changes is not seen here, only what it returns.
        at_once: Whether there is memory for it beside what this process does.
        shared: Objects that the result may refer to, as in `forked`.
    """
    if not (FORKS and at_once) or cores() < 2:
        yield function
        return
    with _Worker(lambda _: function(), [None], shared) as worker:
        worker.begin(0)
        yield lambda: worker.result()[1]


class _Worker:
    """A process that does pieces as it is told to; it ends with the block in which it is used."""

    def __init__(
        self, function: Callable[[Any], Any], pieces: Sequence[Any], shared: Sequence[object]
    ) -> None:
        context = multiprocessing.get_context("fork")
        self._shared = shared
        self.answers, theirs = context.Pipe()
        work = (theirs, self.answers, function, pieces, shared)
        self._process = context.Process(target=_work, args=work, daemon=True)
        with warnings.catch_warnings():
            # Our own threads are idle now and hold no lock; what other threads hold, no piece asks for.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._process.start()
        theirs.close()

    def __enter__(self) -> _Worker:
        return self

    def __exit__(self, *_: object) -> None:
        # A request to end would be heeded as the one who waits heeds it: with a traceback, or after the work is done.
        self._process.kill()
        self._process.join()
        self.answers.close()

    def begin(self, number: int | None) -> None:
        """Have a piece done; None where there is nothing left to do."""
        self.answers.send(number)

    def result(self) -> tuple[int, Any]:
        """Return the number of the piece that has been done, and its result; raise what it raised."""
        try:
            number, done, value = _Unpickler(self.answers.recv_bytes(), self._shared).load()
        except EOFError:
            self._process.join()
            raise CaseError(
                "a worker process of the diagnosis ended before its work was done, with status "
                f"{self._process.exitcode}, as when memory runs out; free some memory, or let the diagnosis have one core: "
                "taskset -c 0 pounding diagnose ..."
            ) from None
        if not done:
            raise value
        return number, value


def _work(
    answers: Connection,
    parents: Connection,
    function: Callable[[Any], Any],
    pieces: Sequence[Any],
    shared: Sequence[object],
) -> None:
    # Ctrl-C is for the process that waits; it ends this one, or its end of the connection is closed with it. Who asks all of
    # them to end gets one answer, from the process that waits.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parents.close()
    with suppress(EOFError, BrokenPipeError):
        while (number := answers.recv()) is not None:
            try:
                answer = _pickled((number, True, function(pieces[number])), shared)
            except Exception as error:
                answer = _pickled((number, False, _sendable(error)), shared)
            answers.send_bytes(answer)


def _sendable(error: Exception) -> Exception:
    """Return an error as it can be sent, which not every library's can: then another one that says the same."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # whatever its own constructor raises
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _pickled(thing: object, shared: Sequence[object]) -> bytes:
    buffer = io.BytesIO()
    _Pickler(buffer, shared).dump(thing)
    return buffer.getvalue()


class _Pickler(pickle.Pickler):
    """Names what is shared by its number instead of writing it."""

    def __init__(self, file: io.BytesIO, shared: Sequence[object]) -> None:
        super().__init__(file, protocol=5)
        self._numbers = {id(one): number for number, one in enumerate(shared)}

    def persistent_id(self, obj: object) -> int | None:
        """Return the number of what is shared, None for all else."""
        return self._numbers.get(id(obj))


class _Unpickler(pickle.Unpickler):
    """Puts what is shared where its number stands."""

    def __init__(self, data: bytes, shared: Sequence[object]) -> None:
        super().__init__(io.BytesIO(data))
        self._shared = shared

    def persistent_load(self, number: int) -> object:
        """Return what is shared under a number."""
        return self._shared[number]
