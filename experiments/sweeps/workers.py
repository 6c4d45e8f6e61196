"""Where the cases of a sweep run: here, in processes of this machine, or on a dask.distributed cluster.

Each runner takes tasks and yields, as they finish, each with a future that holds its outcome or its error. A
worker that dies takes no other case with it: the cases it may have been at are tried again one by one, and
only the one that kills its worker every time is given up.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import threading
from collections import deque
from collections.abc import Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing.connection import wait as wait_for
from pathlib import Path
from typing import Any

from pounding.experiments.errors import ExperimentError
from pounding.experiments.sweeps.store import Case, Outcome, Run, Store
from pounding.extras import extra_module
from pounding.frames.files import clear_begun

ATTEMPTS_ALONE = 2
"""How often a case that may have killed its worker is tried in a worker of its own."""


@dataclass(frozen=True)
class Task:
    """One case to run.

    Attributes:
        run: The function.
        case: Its arguments that differ from case to case.
        settings: Its other arguments.
        key: Of the finished case.
        folder: Where the worker keeps the outcome itself; None leaves that to the caller.
    """

    run: Run
    case: Case
    settings: Case
    key: str
    folder: Path | None

    def __call__(self) -> Outcome:
        """Run the case and keep its outcome; whatever `run` raises is raised."""
        outcome = Outcome(dict(self.run(**self.case, **self.settings)))
        if self.folder is not None:
            Store(self.folder).put(self.key, self.case, outcome)
        return outcome


Finished = tuple[Task, "Future[Outcome] | Any"]
Running = Generator[Finished, None, None]


def run_here(tasks: list[Task]) -> Running:
    """Run tasks one after another in this process."""
    with ThreadPoolExecutor(max_workers=1) as pool:
        for task in tasks:
            future = pool.submit(task)
            wait([future])
            yield task, future


def run_processes(tasks: list[Task], workers: int) -> Running:
    """Run tasks in fresh processes of this machine; survives processes that die."""
    queue = deque(tasks)
    while queue:
        suspects = yield from _until_broken(queue, workers)
        for task in suspects:
            yield from _alone(task)


def _until_broken(queue: deque[Task], workers: int) -> Generator[Finished, None, list[Task]]:
    """Run tasks until none is left or a process dies; return those that may have been running then."""
    flight: dict[Future[Outcome], Task] = {}
    broken: list[Task] = []
    pool = _pool(workers)
    try:
        while (queue or flight) and not broken:
            while queue and len(flight) < 2 * workers and not broken:
                task = queue.popleft()
                try:
                    flight[pool.submit(task)] = task
                except BrokenProcessPool:
                    broken.append(task)
            done, _ = wait(flight, return_when=FIRST_COMPLETED)
            for future in done:
                task = flight.pop(future)
                if isinstance(future.exception(), BrokenProcessPool):
                    broken.append(task)
                else:
                    yield task, future
        return broken + list(flight.values())
    finally:
        _stop(pool, [task.folder for task in (*broken, *flight.values())])


def _alone(task: Task) -> Running:
    """Run one task in a process of its own, again if that process is killed."""
    kept = Store(task.folder).get(task.key) if task.folder is not None else None
    if kept is not None:  # its process died after the work was done
        future: Future[Outcome] = Future()
        future.set_result(kept)
        yield task, future
        return
    for _ in range(ATTEMPTS_ALONE):
        pool = _pool(1)
        try:
            future = pool.submit(task)
            error = future.exception()
        finally:
            _stop(pool, [task.folder])
        if not isinstance(error, BrokenProcessPool):
            break
    yield task, future


def _pool(workers: int) -> ProcessPoolExecutor:
    # Fresh processes: threads of this one, of exudyn and of BLAS, do not survive a fork.
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_start_worker)


def _start_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for([sentinel])
    os._exit(1)


def _stop(pool: ProcessPoolExecutor, folders: Iterable[Path | None]) -> None:
    """End a pool now: cases that are still running are lost, and are run again by the next sweep.

    Args:
        pool: The pool.
        folders: Where its cases are kept; a file that a case was just writing is removed.
    """
    # `kill_workers` does this from Python 3.14 on.
    processes = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes:
        process.terminate()
    for process in processes:
        process.join()
    for folder in {folder for folder in folders if folder is not None}:
        clear_begun(folder, (process.pid for process in processes))


def run_distributed(tasks: list[Task], address: str, timeout_s: float) -> Running:
    """Run tasks on the workers of a dask scheduler.

    Args:
        tasks: What is to be run.
        address: Address of the scheduler.
        timeout_s: How long to wait for it [s].

    Raises:
        ExperimentError: The scheduler does not answer, has no workers, or is lost on the way.
        MissingExtraError: dask.distributed is not installed.
    """
    distributed = extra_module("distributed")
    silent = ExperimentError(
        f"scheduler {address} does not answer within {timeout_s:g} s; check the address, start one with"
        " 'dask scheduler' and 'dask worker', or leave it out to run on this machine"
    )
    if not _greets(address, timeout_s):
        raise silent
    try:
        client = distributed.Client(address, timeout=timeout_s, set_as_default=False)
    except (OSError, ValueError, TimeoutError):
        raise silent from None
    with client:
        try:
            client.wait_for_workers(1, timeout=timeout_s)
        except TimeoutError:
            raise ExperimentError(
                f"scheduler {address} has no workers after {timeout_s:g} s; start 'dask worker {address}'"
            ) from None
        futures = {client.submit(task, key=f"case-{task.key}", pure=False): task for task in tasks}
        try:
            for future in distributed.as_completed(list(futures), loop=client.loop):
                if future.status in ("cancelled", "lost"):
                    raise ExperimentError(
                        f"scheduler {address} was lost; what is finished is kept, start again to go on"
                    )
                yield futures[future], future
                future.release()
        finally:
            client.cancel(list(futures), force=True)


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
