"""The commands of the README's first page print what stands there."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from pounding.experiments.command.app import app
from pounding.experiments.console.exit_status import run

README = Path(__file__).parents[3] / "README.md"


def _printed(command: str, capsys: pytest.CaptureFixture[str]) -> dict:
    """Run a command of the README with --json, without its folder."""
    words = re.sub(r" --out \S+", "", command).split()[1:]
    run(app, [*words, "--json"])
    return json.loads(capsys.readouterr().out)


def _block(verb: str) -> tuple[str, list[list[str]]]:
    """Return a command of the README and the numbers in the lines below it."""
    text = README.read_text(encoding="utf-8")
    (block,) = re.findall(rf"```text\n\$ (pounding {verb} .*?)```", text, re.DOTALL)
    command, *lines = block.strip().splitlines()
    return command, [re.findall(r"\d+(?:\.\d+)?", line) for line in lines]


def test_the_gap_is_as_the_readme_says(capsys: pytest.CaptureFixture[str]):
    command, (required, (least, largest, _share, _same)) = _block("gap")
    found = _printed(command, capsys)
    assert [f"{found['required_gap_mm']:.2f}", f"{found['time_s']:.3f}"] == required
    assert [f"{found['spread']['low_mm']:.2f}", f"{found['spread']['high_mm']:.2f}"] == [least, largest]


def test_the_impacts_are_as_the_readme_says(capsys: pytest.CaptureFixture[str]):
    command, (_heads, *rows) = _block("pound")
    found = _printed(command, capsys)
    impacts = found["runs"][0]["impacts"]
    assert len(impacts) == len(rows)
    for impact, (time, floor, peak, approach, touches, *_rest) in zip(impacts, rows, strict=True):
        assert f"{impact['time_s']:.4f}" == time
        assert (f"{impact['floor']}", f"{impact['peak_force_n']:.0f}") == (floor, peak)
        assert (f"{impact['approach_velocity_m_s']:.3f}", f"{impact['touches']}") == (approach, touches)


def test_the_diagnosis_says_what_the_tutorial_that_is_run_says():
    (commands, said) = re.findall(
        r"\$ pounding (hide .*?) --out .*?\n.*?\n(Missing is .*?)```",
        README.read_text(encoding="utf-8"),
        re.DOTALL,
    )[0]
    page = (README.parent / "docs" / "tutorials" / "measurement.md").read_text(encoding="utf-8")
    assert f"pounding {commands} --out" in page
    assert said in page
