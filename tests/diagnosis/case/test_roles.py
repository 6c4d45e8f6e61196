"""Which runs are learnt from, which is held out, and what a reference run may be."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.errors import CaseError
from tests.diagnosis.case.bench_case import CASE, edit, samples


def test_roles(folder: Path) -> None:
    training, held_out = read_case(folder).split()
    assert ([r.file for r in training], [r.file for r in held_out]) == (["run1.csv"], ["run2.csv"])
    edit(folder / "case.toml", 'file = "run1.csv"', 'file = "run1.csv"\nrole = "held_out"')
    training, held_out = read_case(folder).split()
    assert ([r.file for r in training], [r.file for r in held_out]) == (["run2.csv"], ["run1.csv"])
    edit(folder / "case.toml", '[[run]]\nfile = "run2.csv"\n', "")
    with pytest.raises(CaseError, match="every run is held out"):
        read_case(folder)


@pytest.mark.parametrize(
    ("displacements", "shaken", "held_out"),
    [
        (("d2", "d3", "d4"), 0.5, "run2.csv"),
        (("d2",), 3.0, "run2.csv"),
        ((), 3.0, "run3.csv"),
    ],
    ids=[
        "a bad sample has no say",
        "how far it goes counts",
        "how it shakes if nothing says how far it goes",
    ],
)
def test_the_largest_motion_is_learnt_from(
    folder: Path, displacements: tuple[str, ...], shaken: float, held_out: str
) -> None:
    channels = ["d2", "d3", "d4"]
    for file, size, others, spike in (
        ("run1.csv", 1.0, 1.0, 99.0),
        ("run2.csv", 0.5, shaken, 0.5),
        ("run3.csv", 1.2, 1.2, 1.2),
    ):
        rows = [row.split(",")[:3] for row in samples(0.002).splitlines()[1:]]
        lines = [f"{t},{a},{size * float(d)},{others * float(d)},{others * float(d)}" for t, a, d in rows]
        lines[9] = lines[9].rpartition(",")[0] + f",{spike}"
        (folder / file).write_text("\n".join([",".join(["time_s,table", *channels]), *lines]) + "\n")
    kinds = {
        name: ("relative_displacement", "mm") if name in displacements else ("absolute_acceleration", "g")
        for name in channels
    }
    text = CASE[: CASE.index('[[channel]]\nname = "d2"')].replace(RUN2, RUN2 + '[[run]]\nfile = "run3.csv"\n')
    for floor, (name, (quantity, unit)) in enumerate(kinds.items(), 2):
        text += f'[[channel]]\nname = "{name}"\nframe = "5B"\nfloor = {floor}\n'
        text += f'quantity = "{quantity}"\nunit = "{unit}"\n\n'
    (folder / "case.toml").write_text(text)
    assert [run.file for run in read_case(folder).split()[1]] == [held_out]
    edit(folder / "case.toml", 'file = "run1.csv"', 'file = "run1.csv"\nrole = "held_out"')
    assert [run.file for run in read_case(folder).split()[1]] == ["run1.csv"]


RUN1, RUN2 = ('[[run]]\nfile = "run1.csv"\n', '[[run]]\nfile = "run2.csv"\n')
CONTACT = CASE[CASE.index('[[channel]]\nname = "force"') : CASE.index("[prior]")]
"""The contact of the case, and the channel of its force."""


def test_a_reference_run_is_learnt_from_and_never_held_out_by_default(folder: Path) -> None:
    (folder / "run3.csv").write_text(samples(0.002))
    more = '[[run]]\nfile = "run3.csv"\nrole = "reference"\n'
    (folder / "case.toml").write_text(CASE.replace(CONTACT, "").replace(RUN2, RUN2 + more))
    case = read_case(folder)
    training, held_out = case.split()
    assert ([r.file for r in training], [r.file for r in held_out]) == (
        ["run1.csv", "run3.csv"],
        ["run2.csv"],
    )
    write_case(case, folder / "again")
    assert [run.role for run in read_case(folder / "again").runs] == [None, None, "reference"]
    edit(folder / "case.toml", RUN2, "")
    training, held_out = read_case(folder).split()
    assert [run.file for run in training] == ["run1.csv", "run3.csv"]
    assert held_out == ()


@pytest.mark.parametrize(
    ("roles", "more", "said"),
    [
        (("reference", "reference"), "", "run1.csv': every run is a reference, so there is no run in which"),
        (("held_out", "reference"), "", "run2.csv': every run but the references is held out"),
        (("reference", None), CONTACT, "run1.csv': a reference run cannot stand beside a ..contact.."),
        (
            ("reference", None),
            '[[modal]]\nframe = "5B"\nquantity = "frequency"\nmode = 1\nvalue = 6.5\nunit = "Hz"\nstd = 0.1\n'
            'test = "hammer"\n',
            "run1.csv': a reference run cannot stand beside ..modal..",
        ),
        (("referense", None), "", "unknown role 'referense'; did you mean 'reference'"),
    ],
)
def test_what_no_reference_run_can_be(
    folder: Path, roles: tuple[str | None, ...], more: str, said: str
) -> None:
    text = CASE.replace(CONTACT, more)
    for run, role in zip((RUN1, RUN2), roles, strict=True):
        text = text.replace(run, run + (f'role = "{role}"\n' if role else ""))
    (folder / "case.toml").write_text(text)
    with pytest.raises(CaseError, match=said) as caught:
        read_case(folder)
    assert len(str(caught.value).splitlines()) == 1


def test_a_single_run_holds_nothing_out(folder: Path) -> None:
    edit(folder / "case.toml", '[[run]]\nfile = "run2.csv"\n', "")
    training, held_out = read_case(folder).split()
    assert [run.file for run in training] == ["run1.csv"]
    assert held_out == ()
