"""States of the laboratory's frames: printed values, the joints behind them, the verbs that take one, and bad input."""

from __future__ import annotations

import json
import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from pounding import frames
from pounding.experiments import published
from pounding.experiments.command.app import main
from pounding.experiments.configurations.library import experiments
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import find
from pounding.experiments.rig.pounding import built, built_in, shaking
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.states import LABORATORY, states_of, strong_frequencies, strong_motion
from pounding.frames.templates import template
from pounding.scale import THESIS

PAIRS = [(str(left), str(right)) for left, right, _ in published.table("4.2").index]
STICK = (
    'kind = "stick"\nname = "15B"\nstoreys = 2\nstorey_height_m = 0.1\nscale = "1:30"\n'
    "floor_mass_kg = [6.0, 6.0]\nfrequency_hz = [3.0]\ndamping_ratio = 0.02\n"
)


def test_free_vibration_and_sweep_are_table_3_1() -> None:
    printed = published.table("3.1")["experiment"]
    for name in LABORATORY:
        (free,), (sweep,) = states_of([name]), states_of([name], "sweep")
        assert (free.first_hz, sweep.first_hz) == tuple(
            printed.loc[name, ["free_vibration_hz", "mode1_hz"]].astype(float)
        )
        assert free.damping_ratio == sweep.damping_ratio == frames.load(name).damping_ratio
        assert "Table 3.1" in free.source
        assert "fitted" not in free.source + sweep.source


def test_without_a_state_a_frame_is_the_baseline_model() -> None:
    (state,) = states_of(["5B"])
    mine, baseline = built_in(state), built("5B")
    for array in ("stiffness", "damping", "mass"):
        assert np.array_equal(getattr(mine, array), getattr(baseline, array))


@pytest.mark.parametrize("name", ["5B", "10", "15B"])
def test_joints_of_unequal_pairs_give_the_frequency_that_table_7_2_prints(name: str) -> None:
    (state,) = states_of([name], "strong-motion")
    assert state.calibration == "unequal_pair"
    frame = built_in(state)
    assert frame.frequencies_hz[0] == pytest.approx({"5B": 6.96, "10": 3.53, "15B": 2.29}[name], rel=2e-5)
    assert frame.damping_ratio == 0.0105


def test_strong_motion_follows_from_what_stands_on_the_table() -> None:
    def hertz(*names: str, record: str | None = None) -> list[float | None]:
        return [one.first_hz for one in states_of(names, "strong-motion", record)]

    assert hertz("15B", "15A") == [2.113, 2.03]
    assert hertz("5A", "5B") == [6.9, 6.43]
    assert hertz("5B", "15B", record="hachinohe") == [6.96, 2.29]
    assert (hertz("15B", record="hachinohe"), hertz("15B", record="kobe")) == ([2.113], [2.29])


def test_every_frame_and_pair_of_the_thesis_has_a_state_of_strong_motion_and_no_other() -> None:
    shaken = [one for one in experiments().values() if one.motion is not None]
    assert {one.frame_names for one in shaken} == {(name,) for name in LABORATORY} | set(PAIRS)
    for one in shaken:
        assert len(strong_frequencies(one.frame_names, one.motion)) == len(one.frames)
    for pair in product(LABORATORY, repeat=2):
        if pair not in PAIRS and pair[::-1] not in PAIRS:
            with pytest.raises(ExperimentError, match="the thesis has no such test"):
                strong_frequencies(pair)


def test_what_is_fitted_is_called_fitted() -> None:
    (state,) = states_of(["10"], "strong-motion", "kobe")
    assert "fitted to the 58 uncontested peaks of Table 4.1" in str(state)
    assert "pounding study missing-in-the-thesis" in str(state)
    assert strong_motion().fitted_by in state.source
    (asked,) = states_of(["10"], "strong-motion", damping=0.02)
    assert asked.damping_ratio == 0.02
    assert "fitted" not in asked.source


def test_gap_takes_the_states_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["gap", "10", "5B", "--record", "elcentro-chopra", "--state", "strong-motion", "--json"]
    main(words)
    found = json.loads(capsys.readouterr().out)
    states = states_of(["10", "5B"], "strong-motion")
    assert found["parameters"]["states"] == [one.as_dict() for one in states]
    left, right = map(built_in, states)
    shaken = find("elcentro-chopra").scaled(THESIS.time_factor)
    assert found["required_gap_mm"] == pytest.approx(1e3 * pair_gap(left, right, shaken).closing_m)
    main(words[:-1])
    shown = " ".join(capsys.readouterr().out.split())
    assert all(str(one) in shown for one in states)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("modal 15B --state guess", '"guess" for --state. Choose from'),
        ("shake 8 --record elcentro-chopra --state sweep", "frame '8' has no state 'sweep'"),
        ("shake mine.toml --record elcentro-chopra --state free-vibration", "'mine.toml' has no state"),
        ("gap 15B mine.toml --record elcentro-chopra --state sweep", "'mine.toml' has no state"),
        ("gap 15A 5B --record elcentro-chopra --state strong-motion", "15A beside 5B has no strong-motion"),
        ("pound 10 10 --gap 3 --record elcentro-chopra --state strong-motion", "no such test"),
        ("pound 15C 10 --gap 3 --record elcentro-chopra --state sweep", "did you mean 15A or 15B"),
        ("modal 15B --state sweep --joints rigid", "rigid joints have none"),
        ("experiment push-5A --state strong-motion", "'push-5A' has no ground motion"),
    ],
)
def test_a_state_that_a_frame_has_not_is_one_sentence(
    words: str,
    sentence: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "mine.toml").write_text(STICK)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(frames, "build", None)  # refused before any work
    with pytest.raises(SystemExit) as leaving:
        main(words.split())
    assert leaving.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert sentence in err
    assert err.count("\n") == 1


def test_a_frame_file_that_changed_is_built_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a session, or from another folder, the same path may lead to another building."""
    text = template("stick", "office")
    for folder, hz in (("one", "[1.1, 3.2]"), ("other", "[0.9, 2.6]")):
        (tmp_path / folder).mkdir()
        monkeypatch.chdir(tmp_path / folder)
        Path("office.toml").write_text(text.replace("[1.1, 3.2]", hz))
        assert built("office.toml").frequencies_hz[0] == pytest.approx(float(hz[1:4]))
    assert built("office.toml") is built("office.toml")


def test_a_frame_is_built_as_its_file_says_an_infinite_number_too(tmp_path: Path) -> None:
    """A friction that nothing wears has an infinite rate of wear, for which JSON has no word."""
    law = (
        '[[storey_law]]\nkind = "friction"\nstorey = 1\nforce_n = 1000.0\nsticking_stiffness_n_per_m = 1e8\n'
    )
    (tmp_path / "office.toml").write_text(f"{template('stick', 'office')}\n{law}")
    name = str(tmp_path / "office.toml")
    stated = frames.load(name).storey_law[0]
    assert stated.half_worn_m_per_s == math.inf
    assert list(built(name).definition.storey_law) == [stated]


def test_a_ground_motion_that_changed_is_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a session, or in another folder, the same name may be another motion."""
    for folder, size in (("one", 1.0), ("other", 2.0)):
        (tmp_path / folder).mkdir()
        monkeypatch.setenv("POUNDING_RECORDS", str(tmp_path / folder))
        for once_more in (1.0, 3.0):
            rows = (f"{0.01 * i},{once_more * size * np.sin(0.1 * i)}" for i in range(200))
            file = tmp_path / folder / "quarry.csv"
            file.write_text("time_s,acceleration_m_s2\n" + "\n".join(rows))
            assert shaking("quarry").acceleration_m_s2.max() == pytest.approx(once_more * size, rel=1e-3)
    assert shaking("quarry") is shaking("quarry")
