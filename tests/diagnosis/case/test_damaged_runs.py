"""Damaged CSV files of measured runs: refused in one sentence, or read as the file says, whoever reads them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from pounding.diagnosis.case.case import Channel
from pounding.diagnosis.case.csv import read_run
from pounding.experiments.measurements import history
from tests.damaging import Damage, damages, decoded, little_memory, plain_numbers, read_or_refused, same

COUNT, STEP_S = 200, 0.005
NAMES = ("table_acceleration_g", "15B_relative_displacement_floor10_mm", "contact_force_kN")
CHANNELS = (
    Channel(NAMES[0], "table_acceleration", "g"),
    Channel(NAMES[1], "relative_displacement", "mm", frame="15B", floor=10),
    Channel(NAMES[2], "contact_force", "kN", contact=1),
)
TO_SI = np.array([9.80665, 1e-3, 1e3])
Table = tuple[np.ndarray, np.ndarray]


def true_file() -> str:
    """Return a run with a sample that was lost."""
    rows = [
        f"{STEP_S * i:.6f},{np.sin(0.1 * i):.7g},{3 * np.cos(0.2 * i):.7g},{max(np.sin(0.3 * i), 0):.7g}"
        for i in range(COUNT)
    ]
    rows[60] = rows[60].rpartition(",")[0] + ","
    return "\n".join([",".join(["time_s", *NAMES]), *rows]) + "\n"


def said(text: str) -> Table:
    """Return times [s] and values in SI (samples, channels) by an independent reading; NaN where a cell is empty."""
    lines = [line for line in text.splitlines() if line.replace(",", "").strip()]
    header = [cell.strip().strip('"') for cell in lines[0].split(",")]
    cells = [[cell.strip().strip('"') for cell in line.split(",")] for line in lines[1:]]
    words = ["-1e99" if cell.lower() in ("", "nan") else cell for row in cells for cell in row]
    table = np.array(plain_numbers(words)).reshape(len(cells), len(header))
    table[table == -1e99] = np.nan
    columns = [header.index(name) if name in header else -1 for name in NAMES]
    values = np.column_stack([table[:, c] if c >= 0 else np.full(len(table), np.nan) for c in columns])
    return table[:, 0], values * TO_SI


def by_case(path: Path) -> Table:
    run, warnings = read_run(path, CHANNELS)
    assert all(warning.isprintable() for warning in warnings)
    return run.time_s, run.values


def by_overlay(path: Path) -> Table:
    found = {channel.name: channel for channel in history.read(path)}
    time = next(iter(found.values())).time_s
    lost = np.full(len(time), np.nan)
    return time, np.column_stack([found[name].values if name in found else lost for name in NAMES])


by_reader = pytest.mark.parametrize("reader", [by_case, by_overlay])
often = settings(
    max_examples=220, deadline=None, database=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
seldom = settings(often, max_examples=4)


def check(reader: Callable[[Path], Table], done: list[Damage]) -> None:
    data = true_file().encode("utf-8")
    _, whole = said(data.decode("utf-8"))
    for damage in done:
        data = damage(data)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.csv"
        path.write_bytes(data)
        found = read_or_refused(reader, path)
    if found is None:
        return
    time, values = found
    text = decoded(data)
    said_time, said_values = said(text)
    if reader is by_case:
        # Rows that were lost stand on the grid of the times as dropouts.
        stands = np.abs(time[:, None] - said_time).min(axis=1) < 0.1 * STEP_S
        assert np.isnan(values[~stands]).all()
        time, values = time[stands], values[stands]
    assert same(values.ravel(), said_values.ravel()), "the samples are not those in the file"
    np.testing.assert_allclose(time, said_time, atol=2e-6)
    if {damage.kind for damage in done} & {"swap", "replace"}:
        return
    kept = len(values) if text[-1:].isspace() else len(values) - 1
    if reader is by_case:
        # Only here are times a grid: each row stands at its own place.
        places = np.rint(time[:kept] / STEP_S).astype(int)
        assert same(values[:kept].ravel(), whole[places].ravel())


@by_reader
def test_a_true_file_is_read(reader: Callable[[Path], Table], tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(true_file(), encoding="utf-8")
    time, values = reader(tmp_path / "run.csv")
    assert same(values.ravel(), said(true_file())[1].ravel())
    assert len(time) == COUNT


@by_reader
def test_a_damaged_file_is_refused_or_read_rightly(reader: Callable[[Path], Table]) -> None:
    run(reader, seldom)


@pytest.mark.slow
@by_reader
def test_many_damaged_files_are_refused_or_read_rightly(reader: Callable[[Path], Table]) -> None:
    with little_memory():
        run(reader, often)


def run(reader: Callable[[Path], Table], how: settings) -> None:
    how(given(damages)(lambda done: check(reader, done)))()
