"""Cases of a sweep on the workers of a dask.distributed scheduler.

What happens to workers is the scheduler's affair: it gives the cases of a worker that died, or that has been silent for
longer than its `worker-ttl`, to another one, computes lost results again, and gives up a case after `allowed-failures`
further workers died with it. As it counts every case that a worker had been given and not only the one that it was at,
cases that are given up are tried again here, each alone. Here it is also seen whether the scheduler itself is alive.
"""

from __future__ import annotations

import asyncio
import logging
import socket
import time
from collections import Counter
from collections.abc import Generator, Iterator, Mapping
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from typing import Any, NoReturn

from pounding.experiments.errors import ExperimentError
from pounding.experiments.sweeps.store import Case, Outcome
from pounding.experiments.sweeps.workers import Finished, Running, Task
from pounding.extras import extra_module

LOOK_EVERY_S = 1.0
"""Time between two looks at the scheduler [s]."""

GO_ON = "what is finished is kept, start again to go on"


def run_distributed(tasks: list[Task], address: str, timeout_s: float) -> Running:
    """Run tasks on the workers of a dask scheduler.

    Args:
        tasks: What is to be run.
        address: Address of the scheduler.
        timeout_s: How long the scheduler may be silent, and may be without workers [s].

    Raises:
        ExperimentError: The scheduler does not answer, has no workers, or is lost on the way.
        MissingExtraError: dask.distributed is not installed.
    """
    with _quiet(), _connected(address, timeout_s) as client:
        watch = _Watch(client, address, timeout_s, {_key(task): task.case for task in tasks})
        given_up = yield from _settled(tasks, watch, "")
        for task in given_up:
            # Alone, so that no other case can have killed its workers.
            yield from _settled([task], watch, "-alone")


def _settled(tasks: list[Task], watch: _Watch, tag: str) -> Generator[Finished, None, list[Task]]:
    """Yield tasks as they finish; several tasks whose workers died are returned instead, one is yielded as it is."""
    client, given_up = watch.client, []
    loop, ended = client.loop.asyncio_loop, SimpleQueue[Future[Outcome]]()
    flight: dict[Future[Outcome], tuple[Task, Any]] = {}
    try:
        for task in tasks:
            remote = client.submit(task, key=_key(task) + tag, pure=False)
            # Fetched while others are computed: a result is not lost when its worker dies later.
            future = asyncio.run_coroutine_threadsafe(_fetched(remote), loop)
            flight[future] = task, remote
            future.add_done_callback(ended.put)
        while flight:
            watch.look()
            with suppress(Empty):
                future = ended.get(timeout=LOOK_EVERY_S)
                task, remote = flight.pop(future)
                if watch.ends(future, remote):
                    watch.fail("was lost")
                remote.release()
                if tag == "" and isinstance(future.exception(), watch.killed):
                    given_up.append(task)
                else:
                    yield task, future
        return given_up
    finally:
        with suppress(TimeoutError, OSError, CancelledError):
            client.cancel([remote for _, remote in flight.values()], force=True)


def _key(task: Task) -> str:
    return f"case-{task.key}"


async def _fetched(remote: Any) -> Outcome:
    outcome: Outcome = await remote
    return outcome


class _Watch:
    """Looks now and then whether the scheduler answers and has workers.

    Args:
        client: Client of the scheduler.
        address: Address of the scheduler.
        timeout_s: How long it may be silent or without workers [s].
        cases: The cases by their keys on the cluster.
    """

    def __init__(self, client: Any, address: str, timeout_s: float, cases: Mapping[str, Case]) -> None:
        self.client, self.address, self.timeout_s, self.cases = client, address, timeout_s, cases
        self.killed = extra_module("distributed").KilledWorker
        self._looked = self._manned = time.monotonic()

    def look(self) -> None:
        """Ask the scheduler for its workers, if the last time is long enough ago."""
        now = time.monotonic()
        if now - self._looked < LOOK_EVERY_S:
            return
        if self._asked("ncores", workers=None):
            self._manned = now
        elif now - self._manned > self.timeout_s:
            self.fail(f"has had no workers for {self.timeout_s:g} s{self._suspects()}")
        self._looked = time.monotonic()

    def ends(self, future: Future[Outcome], remote: Any) -> bool:
        """Return whether a future ended because the scheduler was lost, and not by its case.

        Args:
            future: What waited for the case.
            remote: The cluster's own future.
        """
        if future.cancelled() or remote.status == "cancelled":
            return True
        return isinstance(future.exception(), OSError) and remote.status != "error"

    def fail(self, what: str) -> NoReturn:
        """Raise the error that ends the sweep.

        Args:
            what: What became of the scheduler.
        """
        raise ExperimentError(f"scheduler {self.address} {what}; {GO_ON}")

    def _asked(self, question: str, **words: Any) -> Any:
        if self.client.status != "running":
            self.fail("was lost")
        try:
            return self.client.sync(
                getattr(self.client.scheduler, question), callback_timeout=self.timeout_s, **words
            )
        except TimeoutError:
            self.fail(f"has been silent for {self.timeout_s:g} s")
        except (OSError, CancelledError):
            self.fail("was lost")

    def _suspects(self) -> str:
        """Return, in words, which cases most of the lost workers had been given."""
        deaths = Counter[str]()
        for _, event in self._asked("events", topic="all"):
            if event.get("action") == "remove-worker" and not event.get("expected"):
                deaths.update(str(key) for key in event.get("processing-tasks", ()))
        often = [str(dict(case)) for key, case in self.cases.items() if deaths[key] > 1]
        return f" (more than one died with the case {' or '.join(often)})" if often else ""


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the client's own remarks and tracebacks off the terminal: what matters is raised as one sentence."""
    logger = logging.getLogger("distributed.client")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


@contextmanager
def _connected(address: str, timeout_s: float) -> Iterator[Any]:
    distributed = extra_module("distributed")
    silent = ExperimentError(
        f"scheduler {address} does not answer within {timeout_s:g} s; check the address, start one with"
        " 'dask scheduler' and 'dask worker', or leave it out to run on this machine"
    )
    if address.startswith("tls://") and not _certificate(distributed):
        raise ExperimentError(
            f"scheduler {address}: TLS needs a certificate; name it in DASK_DISTRIBUTED__COMM__TLS__CA_FILE and"
            " DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT, as docs/sweeps.md shows"
        )
    if not _greets(address, timeout_s):
        raise silent
    try:
        client = distributed.Client(address, timeout=timeout_s, set_as_default=False)
    except (OSError, ValueError, TimeoutError):
        raise silent from None
    try:
        try:
            client.wait_for_workers(1, timeout=timeout_s)
        except TimeoutError:
            raise ExperimentError(
                f"scheduler {address} has no workers after {timeout_s:g} s; start 'dask worker {address}'"
            ) from None
        yield client
    finally:
        # A scheduler that is silent does not say good-bye either.
        with suppress(TimeoutError, OSError, CancelledError):
            client.close(timeout=timeout_s)


def _certificate(distributed: Any) -> bool:
    """Return whether dask's configuration names a certificate for us."""
    return distributed.Security().get_connection_args("client").get("ssl_context") is not None


def _greets(address: str, timeout_s: float) -> bool:
    """Return whether something at a TCP address speaks first, as a scheduler does.

    The client's own time-out ends a connection that is refused, not one that is accepted and stays silent.
    """
    scheme, _, place = address.rpartition("://")
    if scheme not in ("", "tcp"):
        return True
    host, _, port = place.rpartition(":")
    try:
        with socket.create_connection((host.strip("[]"), int(port)), timeout=timeout_s) as connection:
            return bool(connection.recv(1))
    except (OSError, ValueError):
        return False
