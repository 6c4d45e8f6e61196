"""The reference of the Python API: its examples run as they stand, and it has every public name."""

from __future__ import annotations

import doctest
import re
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import pytest

from pounding import frames
from pounding.contact import collide, thesis_law
from pounding.diagnosis.decision.claims import Place, candidate, claim, parameter
from pounding.diagnosis.report.report import CalibratedParameter, HeldOutMisfit, Misfit, Misfits
from pounding.experiments.records import REFERENCES, find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.many import Case, many
from pounding.experiments.rig.pounding import pound
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.rig import Rig
from pounding.experiments.separation.gaps.gap import gap_answer
from pounding.scale import THESIS

API = Path(__file__).parents[2] / "docs" / "api"
EXAMPLE = re.compile(r"```pycon\n(.*?)```", re.DOTALL)


@pytest.mark.parametrize(
    "page", ["frames", "contact", "experiments", pytest.param("diagnosis", marks=pytest.mark.slow)]
)
def test_the_examples_run_as_they_stand(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = "\n".join(EXAMPLE.findall((API / f"{page}.md").read_text(encoding="utf-8")))
    example = doctest.DocTestParser().get_doctest(text, {}, page, f"{page}.md", 0)
    assert example.examples
    ran = doctest.DocTestRunner(optionflags=doctest.REPORT_NDIFF).run(example)
    assert ran.failed == 0, capsys.readouterr().out


@pytest.mark.parametrize("package", ["frames", "contact", "experiments.records", "diagnosis"])
def test_every_public_name_is_on_its_page(package: str) -> None:
    page = (API / f"{package.partition('.')[0]}.md").read_text(encoding="utf-8")
    named = {name.rpartition(".")[2] for name in re.findall(r"^\.\. auto\w+:: (\S+)$", page, re.MULTILINE)}
    named |= set(re.findall(r"`(\w+)`", page))
    assert not set(import_module(f"pounding.{package}").__all__) - named


def test_what_a_script_prints_is_one_short_line() -> None:
    low, tall = (frames.load(name) for name in ("5B", "15B"))
    row = [frames.build(tall), frames.build(low)]
    record = find("elcentro-chopra").scaled(THESIS.time_factor)
    law = thesis_law("linear_viscoelastic")
    run = pound(*row, record, law, gap_m=0.008, solver="exact")
    contact = Contact(law, gap_m=0.008, floor=5)
    case = Case(row, (contact,), record.acceleration_m_s2, record.step_s)
    printed = [
        *(low, low.published, REFERENCES["kobe"], row[0], record, law, contact, Rig(row, (contact,)), case),
        *(run, run.motion, run.motion.frames[0], run.motion.contacts[0], run.impacts[0]),
        *(pair_gap(*row, record), next(many([case], workers=0)), collide(law, 10.0, 10.0, 0.2)),
        gap_answer(*row, record),
    ]
    _are_short_lines(printed)


def test_what_a_report_holds_is_one_short_line_each() -> None:
    place = Place(effect="stiffness_change", frame="5A", storey=3)
    size = parameter("relative_change", -0.2412345, 0.0412345, "1")
    named = claim(place, [size], 412.345678, [place, Place(effect="added_mass", frame="5A", floor=3)])
    fitted = Misfit(before=0.0497089, after=0.0167347, noise_floor=0.0168856)
    unseen = HeldOutMisfit(before=0.1056598, after=None, noise_floor=None, run="run3.csv")
    gain = CalibratedParameter(
        parameter="channel_gain",
        baseline=1.0,
        calibrated=1.0033192,
        std=0.0011726,
        prior_std=0.003,
        channel="5A_a5",
    )
    misfits = Misfits(training=fitted, held_out=unseen)
    _are_short_lines([place, size, candidate(place, 412.345678), named, misfits, gain])
    assert repr(named) == (
        "Claim(stiffness change in storey 3 of 5A (relative change -0.241 ± 0.041), log_evidence 412.3, "
        "one of a class of 2)"
    )
    assert repr(misfits) == "Misfits(training 4.97 % -> 1.67 %, held out 10.6 % -> unknown)"
    assert repr(gain) == "CalibratedParameter(channel_gain of channel 5A_a5: 1 -> 1.003 ± 0.0012)"


def _are_short_lines(printed: Sequence[object]) -> None:
    for one in printed:
        assert len(repr(one)) < 200, type(one)
        assert "\n" not in repr(one)
        assert " object at 0x" not in repr(one)
