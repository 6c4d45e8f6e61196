"""Long work is announced on standard error before it starts, short work is not, and what remains is told in words."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import xarray as xr
from rich.console import Console

from pounding import frames
from pounding.errors import InputError
from pounding.experiments.command import gap as gap_module
from pounding.experiments.command import hide as hide_module
from pounding.experiments.command.app import main
from pounding.experiments.console import estimates
from pounding.experiments.studies import frame_mesh, table_4_1


def stick(storeys: int) -> frames.ReducedFrame:
    return frames.build(
        frames.StickFrame(
            name=f"{storeys} storeys",
            storeys=storeys,
            storey_height_m=0.1,
            floor_mass_kg=[6.0] * storeys,
            frequency_hz=[3.0],
            damping_ratio=0.01,
        )
    )


def test_what_remains_is_told_from_the_first_case_on() -> None:
    assert estimates.remaining(0.0, 0, 36) == ""
    assert estimates.remaining(60.0, 2, 34) == ", about 17 minutes remain"
    assert estimates.remaining(60.0, 2, 34, 200.0) == ", about 3 minutes remain"
    assert estimates.remaining(70.0, 2, 34, -10.0) == ", about 0 s remain"
    assert estimates.remaining(60.0, 36, 0) == ""


def test_gaps_and_hidden_cases_cost_what_was_measured() -> None:
    """On one core: 600 s at 1 ms with two frames of 40 storeys took 11 s, three runs of 60 s with one effect 41 s."""
    assert 4.0 < estimates.of_gap([stick(40), stick(40)], 600.0, 1e-3).seconds < 34.0
    assert 14.0 < estimates.of_hiding(1, 1, 60.0).seconds < 120.0
    assert estimates.of_hiding(2, 1, 60.0).seconds > estimates.SAID_S


def test_a_long_gap_is_announced_and_a_short_one_is_not(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, test_records: Path
) -> None:
    words = ["gap", "5A", "5B", "--record", "elcentro", "--records", str(test_records), "--json"]
    main(words)
    said = capsys.readouterr()
    assert said.err == ""
    json.loads(said.out)

    def stopped(*_args: object, **_options: object) -> None:
        raise InputError("enough")

    monkeypatch.setattr(estimates, "SAID_S", 0.0)
    monkeypatch.setattr(gap_module, "gap_answer", stopped)
    with pytest.raises(SystemExit):
        main(words)
    said = capsys.readouterr()
    assert "the gap between 5A and 5B takes about" in said.err
    assert said.out == ""


def test_a_long_case_to_hide_is_announced(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def stopped(*_args: object, **_options: object) -> None:
        raise InputError("enough")

    monkeypatch.setattr(hide_module, "hide_effects", stopped)
    words = ["hide", "bumper", "--frame", "15B", "--frame", "5B", "--out", str(tmp_path / "case")]
    for more, announced in (([], False), (["--duration", "60"], True), (["--duration", "1e9"], False)):
        with pytest.raises(SystemExit):
            main([*words, *more])
        said = capsys.readouterr()
        assert ("making the case takes about 3 minutes on one core" in said.err) == announced
        assert said.out == ""


def test_studies_of_many_builds_show_how_far_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console(force_terminal=True, record=True, width=100)
    shown: list[xr.DataArray] = []

    def predicted(variant: table_4_1.Variant, folder: Path | None) -> xr.DataArray:
        shown.append(table_4_1.measured())
        return shown[-1]

    monkeypatch.setattr(table_4_1, "predict", predicted)
    data = table_4_1.compare(None, console)
    assert len(shown) == data.sizes["variant"] == 24
    assert "variants of the model" in console.export_text()
    monkeypatch.setattr(frame_mesh, "progress_console", lambda: console)
    monkeypatch.setattr(
        frame_mesh, "bare", lambda frame, density: {"f1_hz": 1.0, "roof_stiffness_n_per_mm": 1.0}
    )
    assert len(frame_mesh.meshes()) == 13
    assert "meshes" in console.export_text()
