"""A ground motion's file without a unit: every verb that takes one also takes its unit."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.command import main

VERBS = {
    "shake": "shake low.toml --record plain.csv",
    "gap": "gap low.toml high.toml --record plain.csv",
    "pound": "pound low.toml high.toml --gap 20 --solver exact --record plain.csv",
    "mitigate": "mitigate street.toml --measure bumpers --evaluations 3 --record plain.csv",
    "fragility": "fragility street.toml --record plain.csv --record other.csv",
    "experiment": "experiment alone-5A-elcentro --record plain.csv",
}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, hz in (("low", 2.0), ("high", 1.3)):
        (tmp_path / f"{name}.toml").write_text(
            f'kind = "stick"\nname = "{name}"\nscale = 1\nstoreys = 2\nstorey_height_m = 3.0\n'
            f"floor_mass_kg = [2e5, 2e5]\nfrequency_hz = [{hz}]\ndamping_ratio = 0.03\n"
            "plan_m = [12.0, 10.0]\n[slab]\nthickness_m = 0.2\n"
        )
    (tmp_path / "street.toml").write_text(
        '[[building]]\nframe = "low.toml"\n[[building]]\nframe = "high.toml"\n[[gap]]\ngap_mm = [20.0]\n'
    )
    for name, hz in (("plain", 1.5), ("other", 1.0)):
        rows = [f"{0.02 * i:.2f},{200.0 * math.sin(2 * math.pi * hz * 0.02 * i):.6f}" for i in range(100)]
        (tmp_path / f"{name}.csv").write_text("\n".join(rows) + "\n")
    return tmp_path


@pytest.mark.parametrize("verb", VERBS)
def test_a_verb_takes_the_unit_and_asks_for_it(
    verb: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [*VERBS[verb].split(), "--json"]
    with pytest.raises(SystemExit) as left:
        main(words)
    out, err = capsys.readouterr()
    assert (left.value.code, out, err.count("\n")) == (2, "", 1)
    assert "plain.csv: no unit of acceleration; give it with --record-unit g or --record-unit m/s2" in err
    main([*words, "--record-unit", "gal"])
    result = json.loads(capsys.readouterr().out)
    assert result["records"][0]["pga_g"] == pytest.approx(2.0 / STANDARD_GRAVITY, rel=0.02)
    assert result.get("parameters", {}).get("record_unit", "gal") == "gal"


def test_all_experiments_take_the_motions_of_the_thesis(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(["experiment", "--all", "--out", "all", "--record-unit", "g"])
    assert left.value.code == 2
    assert "--record and --record-unit belong to one experiment" in capsys.readouterr().err
