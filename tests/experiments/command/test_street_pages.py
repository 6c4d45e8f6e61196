"""The figures on the pages on streets, measures and many records are those of the commands that stand there."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path
from typing import Any

import pytest

from pounding.experiments.command.app import main
from pounding.experiments.console.street_input import linear_street
from pounding.experiments.mitigation.measures import HARD_SHARE, measures
from pounding.experiments.mitigation.response import response
from pounding.experiments.mitigation.standing import Standing
from pounding.experiments.records import find

DOCS = Path(__file__).parents[3] / "docs"
RECORD = ["--record", "elcentro-chopra"]
FLATS = {
    "storeys": "6",
    "storey_height_m": "[4.0, 3.2, 3.2, 3.2, 3.2, 3.2]",
    "floor_mass_kg": "[340e3, 320e3, 320e3, 320e3, 320e3, 270e3]",
    "frequency_hz": "[0.7, 2.0]",
    "damping_ratio": "0.05",
    "plan_m": "[20.0, 18.0]",
}


def text(page: str) -> str:
    return (DOCS / page).read_text(encoding="utf-8")


def joined(words: str) -> str:
    return re.sub(r"\s+", " ", words)


@pytest.fixture
def folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    for name, keys in (("office", {}), ("flats", FLATS)):
        path = tmp_path / f"{name}.toml"
        main(["new-frame", str(path)])
        content = path.read_text()
        for key, value in keys.items():
            content = re.sub(rf"^{key} = .*$", f"{key} = {value}", content, flags=re.MULTILINE)
        path.write_text(content)
    for name, content in re.findall(
        r"`((?:garage|hits)\.toml)`[^`]*```toml\n(.*?)```", text("streets.md"), re.DOTALL
    ):
        (tmp_path / name).write_text(content)
    row = [str(tmp_path / f"{name}.toml") for name in ("office", "flats", "office")]
    main(["new-street", str(tmp_path / "street.toml"), *row, "--gap", "60"])
    capsys.readouterr()
    return tmp_path


def answer(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    main([*words, "--json"])
    return dict(json.loads(capsys.readouterr().out))


def test_the_row_of_three(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (run,) = answer(["pound", str(folder / "street.toml"), *RECORD, "--solver", "exact"], capsys)["runs"]
    left = [one["peak_force_n"] / 1e6 for one in run["impacts"] if one["left"] == "office"]
    right = [one["peak_force_n"] / 1e6 for one in run["impacts"] if one["right"] == "office#2"]
    said = joined(text("streets.md"))
    assert f"They collide {len(run['impacts'])} times" in said
    assert f"the left office in {len(left)} and the right one in {len(right)}" in said
    assert f"{max(left):.1f} MN on the left and {max(right):.1f} MN on the right" in said


def test_the_floor_against_columns(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    street = folder / "hits.toml"
    said = joined(text("streets.md"))
    for solver, words in (
        ("exact", "{:,.0f} kN and {:,.0f} kN m by"),
        ("exudyn", "({:,.0f} and {:,.0f} by"),
    ):
        (run,) = answer(["pound", str(street), *RECORD, "--solver", solver], capsys)["runs"]
        (column,) = run["columns"]
        assert words.format(column["shear_kn"], column["moment_kn_m"]) in said
        if solver == "exact":
            peak = max(one["peak_force_n"] for one in run["impacts"]) / 1e6
            assert f"has {len(run['impacts'])} impacts of at most {peak:.1f} MN" in said


def test_what_helps_where_a_floor_hits_columns(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The rows without a search, and that of the drift alone on both pages."""
    street = folder / "hits.toml"
    only = [word for name in ("wider-gap", "collision-walls") for word in ("--measure", name)]
    found = answer(["mitigate", str(street), *RECORD, *only, "--evaluations", "3"], capsys)["measures"]
    assert [one["name"] for one in found] == ["none", "wider-gap", "collision-walls"]
    for one in found:
        r = one["response"]
        assert (
            f"| {one['name']} | {r['peak_force_n'] / 1e3:,.0f} | {r['column_shear_kn']:,.0f} | "
            f"{r['column_moment_kn_m']:,.0f} | {r['touches']} | {100 * r['drift']:.2f} | {r['acceleration_g']:.2f} | "
            f"{max(r['required_gap_mm']):.1f} |"
        ) in text("mitigation.md")
    out = folder / "measures"
    main(["mitigate", str(street), *RECORD, "--measure", "collision-walls", "--out", str(out)])
    assert "No measure tried lowers the largest acceleration of a floor" in joined(capsys.readouterr().out)
    assert (
        f'<td class="n">{found[2]["response"]["column_shear_kn"]:,.0f}</td>'
        in (out / "mitigate.html").read_text()
    )
    apart = found[1]["response"]
    said = f"bears {apart['column_shear_kn']:,.0f} kN and {apart['column_moment_kn_m']:,.0f} kN m, because"
    assert said in joined(text("streets.md"))


def test_a_hard_link_is_hard_enough(folder: Path) -> None:
    assert "Between 30 and 1,000 times the stiffness" in joined(text("mitigation.md"))
    row = linear_street(str(folder / "street.toml"), None, None)
    pair = Standing(row.frames[:2], tuple(row.contacts()[0][:1]))
    (hard,) = (one for one in measures(pair, [1.0]) if one.name == "hard-links")
    linked = hard.apply(())
    found = []
    for share in (30.0, HARD_SHARE, 1000.0):
        (link,) = linked.links
        other = dataclasses.replace(link, stiffness=link.stiffness * share / HARD_SHARE)
        found.append(response(dataclasses.replace(linked, links=(other,)), find("elcentro-chopra")))
    for one in found:
        assert one.drift == pytest.approx(found[-1].drift, rel=0.02)
        assert one.link_force_n == pytest.approx(found[-1].link_force_n, rel=0.02)


@pytest.mark.slow
def test_many_records(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["fragility", str(folder / "street.toml"), "--set", "fema-p695-farfield"]
    page = text("many-records.md")
    main([*words, "--force", "5000", "--drift", "2"])
    printed = joined(capsys.readouterr().out)
    rows = re.findall(r"^\| ((?:floors|force|drift) [^|]*) \| ([\d. |]+) \|$", page, re.MULTILINE)
    assert len(rows) == 3
    for what, numbers in rows:
        assert f"│ {what.replace(',', '')} │ {numbers.replace('|', '│')} │" in printed
    (peak,) = answer([*words, "--period", "0"], capsys)["fragilities"]
    assert f"the median is {peak['median_g']:.3f} g and beta {peak['beta']:.2f}" in joined(page)
    main([*words, "--target", "ec8-1:0.1:B"])
    (quoted,) = re.findall(r"> (Brought to .*?)\n\n", page, re.DOTALL)
    assert re.sub(r"[>\s]+", " ", quoted) in joined(capsys.readouterr().out)
