"""The scale of a case's frames: kept, written again, and refused where it cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.frames import definition
from pounding.frames.scale import known_scale
from pounding.scale import THESIS
from tests.diagnosis.case.bench_case import CASE, samples

OWN = "damping_ratio = [0.005, 0.004]"


def put(folder: Path, case: str) -> Path:
    (folder / "case.toml").write_text(case)
    for name in ("run1.csv", "run2.csv"):
        (folder / name).write_text(samples(0.004))
    return folder


def test_a_scale_is_read_and_written_and_reaches_the_frame(tmp_path: Path) -> None:
    case = read_case(put(tmp_path, CASE.replace(OWN, f'{OWN}\nscale = "1:30"')))
    assert case.frames[1].scale == "1:30"
    assert known_scale(definition(case.frames[1])) == THESIS
    write_case(case, tmp_path / "again")
    assert read_case(tmp_path / "again").frames == case.frames


def test_a_case_needs_no_scale(tmp_path: Path) -> None:
    assert read_case(put(tmp_path, CASE)).frames[1].scale is None


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (OWN, f"{OWN}\nscale = -1", "scale is -1; it must be"),
        (OWN, f'{OWN}\nscale = "30"', "write it as"),
        (OWN, f'{OWN}\nscale = "1:10"', r"'5B' \(1:30\) and frame 'bench' \(1:10\) are of two scales"),
        ('name = "5B"\n', 'name = "5B"\nscale = "1:30"\n', "`scale` belongs to a frame of masses and modes"),
    ],
)
def test_what_cannot_be_is_one_sentence(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(CaseError, match=said) as refused:
        read_case(put(tmp_path, CASE.replace(old, new, 1)))
    assert "case.toml" in str(refused.value)


def test_a_frame_that_yields_is_no_baseline_model(tmp_path: Path) -> None:
    own = 'kind = "stick"\nname = "own"\nstoreys = 2\nscale = "1:30"\nstorey_height_m = 0.1\nfloor_mass_kg = [6.0, 6.0]\n'
    own += "storey_stiffness_n_per_m = [5e3, 5e3]\ndamping_ratio = 0.01\n"
    case = CASE.replace('name = "5B"\n', 'name = "5B"\nfile = "own.toml"\n', 1)
    (tmp_path / "own.toml").write_text(own)
    assert read_case(put(tmp_path, case)).frames[0].storeys == 2
    (tmp_path / "own.toml").write_text(own + "yielding = { storey_shear_n = 12.0 }\n")
    with pytest.raises(CaseError, match="states `yielding`, and the baseline model is linear"):
        read_case(tmp_path)
