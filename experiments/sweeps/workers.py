"""Where the cases of a sweep run: here or in processes of this machine; `cluster` runs them on others.

Each runner takes tasks and yields, as they finish, each with a future that holds its outcome or its error. A
worker that dies takes no other case with it: the cases it may have been at are tried again one by one, and
only the one that kills its worker every time is given up.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait as wait_for
from pathlib import Path
from typing import Any

from pounding.experiments.sweeps.store import Case, Outcome, Run, Store
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
                    with _deaf_to_ctrl_c():
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
            with _deaf_to_ctrl_c():
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


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Start processes that leave Ctrl-C to this one from their first moment on: they inherit what is blocked here."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


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
