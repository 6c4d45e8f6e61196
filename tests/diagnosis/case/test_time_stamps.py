"""Time stamps as loggers write them: rounded, jittering, with lost rows; and those that say no uniform time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.case import Channel, Run
from pounding.diagnosis.case.csv import read_run
from pounding.diagnosis.case.time_stamps import LONGEST_GAP_S, rounding
from pounding.diagnosis.errors import CaseError

CHANNELS = (Channel("table", "table_acceleration", "m/s^2"),)
Format = Callable[[float], str]


def read(folder: Path, stamps: list[str]) -> tuple[Run, list[str]]:
    """Read a run in which each sample is the number of its row."""
    rows = [f"{stamp},{number}" for number, stamp in enumerate(stamps)]
    (folder / "run.csv").write_text("\n".join(["time_s,table", *rows]) + "\n")
    return read_run(folder / "run.csv", CHANNELS)


def refused(folder: Path, stamps: list[str]) -> str:
    with pytest.raises(CaseError) as wrong:
        read(folder, stamps)
    return str(wrong.value)


@pytest.mark.parametrize("step", [0.0016384, 1 / 1024, 1 / 2048, 0.005, 1 / 300])
@pytest.mark.parametrize(
    "written",
    [
        "{:.9f}".format, "{:.6f}".format, "{:.5f}".format, "{:.4f}".format, "{:.8g}".format, "{:.6e}".format,
        lambda t: f"{np.float32(t):.7f}",
    ],
)  # fmt: skip
@pytest.mark.parametrize("start", [0.0, 37.2])
def test_rounded_stamps_are_the_uniform_times_that_they_stand_for(
    tmp_path: Path, step: float, written: Format, start: float
) -> None:
    times = start + step * np.arange(8000)
    run, warnings = read(tmp_path, [written(float(t)) for t in times])
    assert warnings == []
    assert run.step_s == pytest.approx(step, rel=1e-6)
    np.testing.assert_allclose(run.time_s, times, atol=2e-5)
    assert len(run.values) == 8000


def test_stamps_cut_to_milliseconds_keep_their_mean_rate(tmp_path: Path) -> None:
    # Intervals of 1 and 2 ms only: no single one is the step.
    times = 0.0016384 * np.arange(5000)
    run, _ = read(tmp_path, [f"{np.floor(1e3 * t) / 1e3:.3f}" for t in times])
    assert run.step_s == pytest.approx(0.0016384, rel=1e-5)


def test_a_clock_that_jitters_by_a_twentieth_of_a_sample_is_accepted(tmp_path: Path) -> None:
    times = 0.002 * np.arange(3000) + 1e-4 * np.random.default_rng(0).uniform(-1, 1, 3000)
    run, warnings = read(tmp_path, [f"{t:.7f}" for t in times])
    assert warnings == []
    assert run.step_s == pytest.approx(0.002, rel=1e-5)


@pytest.mark.parametrize("written", ["{:.9f}", "{:.6f}", "{:.3f}"])
def test_lost_rows_are_dropouts_where_the_times_say(tmp_path: Path, written: str) -> None:
    times = 0.0016384 * np.arange(4000)
    lost = [100, 101, 102, 900, 3998]
    kept = np.setdiff1d(np.arange(4000), lost)
    run, (warning,) = read(tmp_path, [written.format(t) for t in times[kept]])
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(run.values[:, 0])), lost)
    np.testing.assert_array_equal(run.values[kept, 0], np.arange(len(kept)))
    assert run.step_s == pytest.approx(0.0016384, rel=2e-6)
    assert warning == "run.csv: 5 of 4000 rows are missing, as the times say; dropouts stand at their times"


def test_rows_that_are_missing_for_long_are_refused(tmp_path: Path) -> None:
    times = 0.002 * np.arange(2000)
    rows = int(LONGEST_GAP_S / 0.002)
    run, _ = read(tmp_path, [f"{t:.4f}" for t in np.delete(times, range(500, 500 + rows))])
    assert np.isnan(run.values[:, 0]).sum() == rows
    said = refused(tmp_path, [f"{t:.4f}" for t in np.delete(times, range(500, 700))])
    assert said.startswith("run.csv line 502: 200 rows are missing before it (0.4 s)")


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda t: np.where(t > 2.0, t - 0.5, t), "time does not go on"),
        (lambda t: np.where(t == t[700], t[699], t), "line 702: time does not go on"),
        (lambda t: np.where(t == t[700], t[700] - 0.0008, t), "line 702: time steps by 0.0012 s where"),
        (lambda t: np.where(t > 2.0, 2.0 + 1.4 * (t - 2.0), t), "time steps by 0.0028 s where"),
        (lambda t: np.where(t > 2.0, 2.0 + 2.0 * (t - 2.0), t), "time steps by 0.004 s where"),
        (lambda t: t * (1 + 0.002 * t), "s from uniform steps of"),
        (lambda t: t + 3e-4 * np.random.default_rng(1).standard_normal(len(t)), "time steps by"),
    ],
)  # fmt: skip
def test_stamps_that_are_not_uniform_are_refused_in_a_sentence(
    tmp_path: Path, spoil: Callable[[np.ndarray], np.ndarray], said: str
) -> None:
    sentence = refused(tmp_path, [f"{t:.7f}" for t in spoil(0.002 * np.arange(2000))])
    assert said in sentence
    assert "\n" not in sentence


def test_digits_are_counted_where_they_are_printed() -> None:
    words = ["0", "0.0016384", "9.9983616", "10.001638", "10.5", "1.05e1", "100"]
    digit = rounding(np.array([float(word) for word in words]), words)
    np.testing.assert_allclose(digit, [1e-7, 1e-7, 1e-7, 1e-6, 1e-6, 1e-6, 1.0])


@pytest.mark.parametrize("written", ["{:.8g}", "{:.6f}"])
def test_a_recording_of_twenty_thousand_rounded_stamps_is_read(
    written: str, open_cases: Path, tmp_path: Path
) -> None:
    header, *rows = (open_cases / "real-oscillator" / "run1.csv").read_text().splitlines()
    cells = [row.partition(",") for row in rows]
    lines = [header, *(f"{written.format(float(time))},{rest}" for time, _, rest in cells)]
    (tmp_path / "run1.csv").write_text("\n".join(lines) + "\n")
    run, warnings = read_run(tmp_path / "run1.csv", CHANNELS)
    assert run.step_s == pytest.approx(0.0016384, rel=1e-8)
    assert len(run.values) == 20000
    assert warnings == ["run1.csv: column 'd1' is no [[channel]] of the case and not used"]
