"""The last step of the demonstration, and the page that shows what all steps wrote."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pounding.diagnosis.report import figures
from pounding.experiments.command.demo import find_hidden
from pounding.experiments.output.index_page import Section, write_index


@pytest.mark.slow
def test_what_is_hidden_is_named_added_and_shrinks_the_misfit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    find_hidden(tmp_path / "missing-effect")
    report = json.loads((tmp_path / "missing-effect" / "report" / "report.json").read_text())
    assert report["verdict"] == "effect_named"
    (found,) = report["effects"]
    places = [json.dumps(one | {"log_evidence": None}) for one in report["candidates"]]
    assert len(set(places)) == len(places)
    assert (found["effect"], found["storey"]) == ("coulomb_friction", 3)
    (truth,) = json.loads((tmp_path / "missing-effect" / "truth.json").read_text())["effects"]
    assert found["parameters"][0]["value"] == pytest.approx(truth["parameters"][0]["value"], rel=0.02)
    assert (tmp_path / "missing-effect" / "report" / "report.html").is_file()
    assert "What was hidden: coulomb friction" in capsys.readouterr().out
    pictures = {path.name for path in (tmp_path / "missing-effect" / "report").glob("*.png")}
    assert pictures == set(figures.CAPTIONS)


def _page(folder: Path) -> str:
    (folder / "a step" / "series").mkdir(parents=True)
    for name in ("still & more.png", "film.mp4", "series.pvd", ".half", "series/part.vtu"):
        (folder / "a step" / name).write_bytes(b"x")
    sections = [
        Section(
            "A <step>", "Words.", folder / "a step", "pounding list", {"still & more.png": "A <still> [mm]."}
        ),
        Section("Not run", "Words.", folder / "nothing", "pounding list"),
    ]
    write_index("Title", sections, folder / "index.html")
    return (folder / "index.html").read_text(encoding="utf-8")


def test_the_page_shows_pictures_and_links_the_other_files(tmp_path: Path):
    page = _page(tmp_path)
    assert '<img src="a%20step/still%20%26%20more.png"' in page
    links = '<a href="a%20step/film.mp4">film.mp4</a>, <a href="a%20step/series.pvd">series.pvd</a>'
    assert links in page
    assert "A &lt;step&gt;" in page
    assert "<figcaption>A &lt;still&gt; [mm]." in page


def test_the_page_leaves_out_what_is_not_there_and_what_a_series_file_opens(tmp_path: Path):
    page = _page(tmp_path)
    assert "Not run" not in page
    assert "part.vtu" not in page
    assert ".half" not in page
