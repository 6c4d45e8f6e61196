"""The table of physical bounds, and that every reader and option holds it before long work."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from pounding import bounds, frames
from pounding.bounds import Bound
from pounding.errors import InputError
from pounding.experiments.command.app import main
from pounding.experiments.console import estimates
from pounding.frames import FrameError
from pounding.frames.loading import parse

TABLE = {name: value for name, value in vars(bounds).items() if isinstance(value, Bound)}


@pytest.mark.parametrize("name", TABLE)
def test_every_bound_is_a_range_with_a_reason(name: str) -> None:
    bound = TABLE[name]
    assert bound.low < bound.high
    assert bound.why
    for value in (bound.low, bound.high):
        bound.check(value, "it")
    for value in (math.nan, math.inf, -math.inf, bound.high * 1.01, 10**400):
        with pytest.raises(InputError, match="it must be"):
            bound.check(value, "it")


def test_a_sentence_is_in_the_unit_of_the_file() -> None:
    assert bounds.GAP.fault(-2.0, "gap_mm", per=1e-3, unit="mm").startswith(
        "gap_mm is -2 mm; it must be 0 to 100000 mm: "
    )


def test_the_first_value_beyond_is_found_and_gaps_are_not() -> None:
    assert bounds.ACCELERATION.beyond(np.array([0.0, math.nan, -2e5, 1e300])) == 2
    assert bounds.ACCELERATION.beyond(np.array([0.0, math.nan])) is None


STICK = """
kind = "stick"
name = "mine"
storeys = 2
storey_height_m = 3.0
floor_mass_kg = [5.0, 5.0]
damping_ratio = 0.01
storey_stiffness_n_per_m = [2e4, 2e4]
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("storeys = 2", "storeys = 1000000", "storeys is 1e+06; it must be 1 to 200"),
        ("[5.0, 5.0]", "[5.0, 1e300]", "floor_mass_kg of floor 2 is 1e+300 kg"),
        ("[2e4, 2e4]", "[1e-12, 2e4]", "storey_stiffness_n_per_m of storey 1 is 1e-12 N/m"),
        ("storey_height_m = 3.0", "storey_height_m = 1e9", "storey_height_m is 1e+09 m"),
    ],
)
def test_a_frame_file_beyond_the_bounds_is_refused(old: str, new: str, said: str) -> None:
    with pytest.raises(FrameError) as refused:
        parse(STICK.replace(old, new), "mine.toml")
    assert said in str(refused.value)


def test_a_mesh_that_no_computer_holds_is_refused_before_it_is_made() -> None:
    frame = frames.load("5A")
    wide = frames.changed(frame, plate=resized(frame.plate, length_m=40.0, width_m=40.0))
    with pytest.raises(FrameError, match=r"the number of nodes at 0\.02 m apart"):
        frames.build(wide, use_cache=False)


def resized(plate: frames.Plate, **sides: float) -> frames.Plate:
    return frames.Plate(**{"thickness_m": plate.thickness_m, **sides})


REFUSED = [
    (["modal", "5A", "--up-to-hz", "nan"], "--up-to-hz: the value is nan Hz; it must be 0.001 to 1000 Hz"),
    (["modal", "5A", "--up-to-hz", "0"], "--up-to-hz: the value is 0 Hz"),
    (["modal", "5A", "--up-to-hz", "-3"], "--up-to-hz: the value is -3 Hz"),
    (["modal", "5A", "--up-to-hz", "1e-300"], "--up-to-hz: the value is 1e-300 Hz"),
    (["shake", "5A", "--record", "elcentro-chopra", "--pga", "1e300"], "--pga: the value is 1e+300 g"),
    (["hide", "nothing", "--out", "OUT", "--seed", "-1"], "--seed: the value is -1; it must be 0"),
    (["diagnose", "--benchmark", "3", "--seed", "-1"], "--seed: the value is -1"),
    (["diagnose", "--benchmark", "-3"], "--benchmark: the value is -3"),
    (["design", "--tall", "1e300", "--short", "9", "--pga", "0.3"], "the height of the taller building is 1e+300 m"),
    (["design", "--tall", "30", "--short", "1e-300", "--pga", "0.3"], "height of the lower building is 1e-300 m"),
    (["design", "--tall", "30", "--short", "9", "--pga", "1e-300"], "the peak ground acceleration is 1e-300 g"),
    (["study", "chapter-5", "--workers", "-1"], "--workers: the value is -1"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "said"), REFUSED)
def test_an_option_beyond_the_bounds_is_one_sentence_and_status_2(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([word.replace("OUT", str(tmp_path / "out")) for word in words])
    assert left.value.code == 2
    assert not list(tmp_path.iterdir())
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert said in err


def test_no_mode_below_a_frequency_is_a_result(capsys: pytest.CaptureFixture[str]) -> None:
    main(["modal", "5A", "--up-to-hz", "0.1", "--json"])
    assert '"modes": []' in capsys.readouterr().out


def test_short_work_is_done_without_a_word_and_long_work_is_announced(
    capsys: pytest.CaptureFixture[str],
) -> None:
    plain = frames.load("15B")
    estimates.announce(estimates.of_frame(plain))
    estimates.announce(estimates.of_run([frames.build(plain)], 10.0))
    assert capsys.readouterr().err == ""
    estimates.announce(estimates.of_frame(frames.changed(plain, storeys=150)))
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("building frame 15B takes about ")
    assert said.err.count("\n") == 1


def test_work_that_would_not_end_or_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"the time that .* takes is .* days; it must be 0 to 7 days"):
        estimates.announce(estimates.of_diagnosis(10**7, 200))
    endless = dataclasses.replace(estimates.of_diagnosis(1000, 1), gigabytes=1e9)
    with pytest.raises(InputError, match="GB of memory and this computer has"):
        estimates.announce(endless)


@pytest.mark.parametrize(
    ("seconds", "said"), [(75.0, "75 s"), (600.0, "10 minutes"), (7200.0, "2 hours"), (2e5, "2 days")]
)
def test_times_in_words(seconds: float, said: str) -> None:
    assert estimates.in_words(seconds) == said
