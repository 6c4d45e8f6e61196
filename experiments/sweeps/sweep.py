"""Many cases: a labelled grid goes in, a labelled dataset comes out.

A case is finished when its file is in the sweep's folder. Started again with the same folder, whatever ended
the last run, a sweep goes on with what is missing. A case that fails is recorded with its reason. Only one
sweep at a time may use a folder.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from pounding.cores import cores
from pounding.experiments.errors import ExperimentError
from pounding.experiments.results.provenance import software_version
from pounding.experiments.sweeps.cluster import run_distributed
from pounding.experiments.sweeps.store import Case, Outcome, Run, Store, StoreError, case_key, code_version
from pounding.experiments.sweeps.workers import Running, Task, run_here, run_processes
from pounding.frames.errors import FrameError
from pounding.frames.files import clear_stale, tried_folder

Grid = Mapping[str, Sequence[Any]]


def sweep(
    run: Run,
    cases: Grid | xr.Dataset | Iterable[Case],
    *,
    settings: Case | None = None,
    folder: Path | str | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    timeout_s: float = 30.0,
    retry_failed: bool = False,
    version: str | None = None,
    console: Console | None = None,
) -> xr.Dataset:
    """Run a function for every case and return all results, labelled.

    Args:
        run: Called as ``run(**case, **settings)``; returns a mapping of names to numbers, text or
            `xarray.DataArray`. It has to stand at the top level of a module that workers can import.
        cases: A grid (name to values, or a dataset whose coordinates are the grid): every combination is a
            case and every name a dimension of the result. Or a list of cases: one dimension `case`.
        settings: Arguments that all cases share; they become attributes of the result.
        folder: Where finished cases are kept; None keeps them in memory for this call only.
        workers: Processes on this machine; default: one a core. 0 runs in this process.
        scheduler: Address of a dask.distributed scheduler to run on instead, `tcp://host:8786`.
        timeout_s: How long the scheduler may be silent, and may be without workers [s].
        retry_failed: Run the cases again that are recorded as failed.
        version: Of the code that cases depend on; default: hash of its source files.
        console: Where progress is shown; default: standard error.

    Returns:
        A dataset with a variable for each name that `run` returned, NaN or empty text where a case failed,
        and `failure` with the reasons. Attributes: the settings, `software`, `version`, `code`.

    Raises:
        ExperimentError: No or ill-formed cases, a folder that cannot be written, a full disk, or a scheduler
            that does not answer. Finished cases are kept.
        KeyboardInterrupt: Ctrl-C; finished cases are kept.
    """
    grid, rows = _rows(cases)
    shared = dict(settings or {})
    code = version or code_version(run)
    store = Store(_writable(folder))
    keys = [case_key(run, row, shared, code) for row in rows]
    if retry_failed:
        store.forget_failures(keys)
    missing = {key: row for key, row in zip(keys, rows, strict=True) if store.get(key) is None}
    # Only a process of this machine can keep its own outcome; a cluster's sends it here.
    own = None if scheduler else store.folder
    tasks = [Task(run, row, shared, key, own) for key, row in missing.items()]
    _run_all(_runner(tasks, workers, scheduler, timeout_s), store, len(rows), len(tasks), console)
    outcomes = [store.get(key) or Outcome({}, "was not run") for key in keys]
    attributes = {"software": "pounding", "version": software_version(), "code": code}
    return _dataset(grid, rows, outcomes).assign_attrs({**_attributes(shared), **attributes})


def sweep_all(run: Run, cases: Grid | xr.Dataset | Iterable[Case], **options: Any) -> xr.Dataset:
    """Return what `sweep` does without `failure`; a case that fails is an error once all others are finished.

    Cases that failed before are run again.

    Args:
        run: See `sweep`.
        cases: See `sweep`.
        options: Those of `sweep`.

    Raises:
        ExperimentError: A case failed; says how many and why the first one did. Or as `sweep`.
    """
    data = sweep(run, cases, retry_failed=True, **options)
    failed = [str(why) for why in data.failure.values.ravel() if why]
    if failed:
        raise ExperimentError(f"{len(failed)} of {data.failure.size} runs failed, the first by: {failed[0]}")
    return data.drop_vars("failure")


def _runner(tasks: list[Task], workers: int | None, scheduler: str | None, timeout_s: float) -> Running:
    if not tasks:
        return run_here([])
    if scheduler:
        return run_distributed(tasks, scheduler, timeout_s)
    count = cores() if workers is None else workers
    return run_processes(tasks, min(count, len(tasks))) if count else run_here(tasks)


def _run_all(finished: Running, store: Store, total: int, missing: int, console: Console | None) -> None:
    """Take in finished cases, with a bar that also counts those that were there already."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    console, failures, done = console or Console(stderr=True), 0, total - missing
    # Closed at once when this function is left by an error or Ctrl-C, so that the workers end.
    with closing(finished), Progress(*columns, console=console) as progress:
        bar = progress.add_task("cases", total=total, completed=done)
        try:
            for task, future in finished:
                outcome = _outcome(future)
                failures += bool(outcome.failure)
                if task.folder is None or outcome.failure:
                    store.put(task.key, task.case, outcome)
                done += 1
                told = f"cases, {failures} failed" if failures else "cases"
                progress.update(bar, completed=done, description=told)
        except KeyboardInterrupt:
            kept = (
                "the same call goes on with the rest" if store.folder else "nothing was kept: no folder given"
            )
            raise KeyboardInterrupt(f"{done} of {total} cases are finished; {kept}") from None


def _outcome(future: Any) -> Outcome:
    error = future.exception()
    if error is None:
        outcome: Outcome = future.result()
        return outcome
    if isinstance(error, StoreError):
        raise error
    name = type(error).__name__
    if name in ("BrokenProcessPool", "KilledWorker"):
        return Outcome({}, "its worker died every time it was tried (killed, crashed or out of memory)")
    return Outcome({}, f"{name}: {error}")


def _rows(cases: Grid | xr.Dataset | Iterable[Case]) -> tuple[Grid | None, list[dict[str, Any]]]:
    """Return the grid, if it is one, and its cases."""
    grid: Grid | None = None
    if isinstance(cases, xr.Dataset):
        grid = {str(name): cases.coords[name].values.tolist() for name in cases.dims}
    elif isinstance(cases, Mapping):
        grid = {str(name): list(values) for name, values in cases.items()}
    if grid is not None:
        rows = [dict(zip(grid, values, strict=True)) for values in itertools.product(*grid.values())]
    elif not isinstance(cases, Mapping):
        rows = [dict(case) for case in cases]
    if not rows or not rows[0]:
        raise ExperimentError("sweep: no cases; give at least one value for each name")
    odd = next((index for index, row in enumerate(rows) if set(row) != set(rows[0])), None)
    if odd is not None:
        raise ExperimentError(f"sweep: case {odd + 1} has not the same names as the first")
    return grid, rows


def _writable(folder: Path | str | None) -> Path | None:
    if folder is None:
        return None
    path = Path(folder)
    try:
        tried_folder(path)
    except FrameError as error:
        raise StoreError(f"sweep: {error}") from None
    if path.is_dir():
        clear_stale(path)
    return path


def _dataset(grid: Grid | None, rows: list[dict[str, Any]], outcomes: list[Outcome]) -> xr.Dataset:
    if grid is not None:
        coords: dict[str, Any] = dict(grid)
        shape = tuple(len(values) for values in grid.values())
    else:
        names = rows[0]
        coords = {name: ("case", [row[name] for row in rows]) for name in names}
        shape = (len(rows),)
    dims = tuple(grid) if grid is not None else ("case",)
    data: dict[str, Any] = {
        "failure": (dims, np.array([o.failure for o in outcomes], dtype=object).reshape(shape))
    }
    for name in dict.fromkeys(itertools.chain.from_iterable(outcome.values for outcome in outcomes)):
        values = [outcome.values.get(name) for outcome in outcomes]
        data[name] = _variable(values, dims, shape)
    return xr.Dataset(data, coords=coords)


def _variable(values: list[Any], dims: tuple[str, ...], shape: tuple[int, ...]) -> Any:
    """Return one result of all cases: numbers, text or arrays, with a hole where a case failed."""
    sample = next(value for value in values if value is not None)
    if isinstance(sample, xr.DataArray):
        blank = xr.full_like(sample, np.nan, dtype=float)
        stacked = xr.concat([blank if v is None else v for v in values], "_case", join="outer")
        return _unfold(stacked, dims, shape).assign_attrs(sample.attrs)
    if isinstance(sample, str):
        return dims, np.array(["" if v is None else v for v in values], dtype=object).reshape(shape)
    return dims, np.array([np.nan if v is None else v for v in values], dtype=float).reshape(shape)


def _unfold(stacked: xr.DataArray, dims: tuple[str, ...], shape: tuple[int, ...]) -> xr.DataArray:
    """Return an array over cases as one over the grid's dimensions and its own."""
    inner = [str(dim) for dim in stacked.dims if dim != "_case"]
    values = stacked.transpose("_case", *inner).values
    coords = {name: stacked.coords[name] for name in inner if name in stacked.coords}
    return xr.DataArray(values.reshape(*shape, *values.shape[1:]), coords, (*dims, *inner))


def _attributes(settings: Case) -> dict[str, Any]:
    """Return settings as attributes that NetCDF can hold."""
    return {
        key: value if isinstance(value, str | int | float) and not isinstance(value, bool) else str(value)
        for key, value in settings.items()
    }
