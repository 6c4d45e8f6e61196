"""An installation that lacks the library of one feature: that feature says what to install, all others work."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pounding.experiments.command import main
from pounding.experiments.records.fema import read_fema
from pounding.experiments.separation.chapter_7 import regression
from pounding.experiments.sweeps.sweep import sweep
from pounding.extras import EXTRAS, MissingExtraError, extra_module
from tests.house.test_imports import HOUSE, MODULES, imported, place

PROJECT = tomllib.loads((HOUSE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BROUGHT_BY = {"llvmlite": "numba", "vtkmodules": "pyvista"}
"""Libraries that belong to a dependency of ours and may be used as it uses them."""

DEVELOPMENT = {"openseespy"}
"""No dependency and no extra, because its licence forbids redistribution; refused in a sentence where it is not there."""

_DISTRIBUTIONS = packages_distributions()

BLOCKER = """
from importlib.machinery import PathFinder

found = PathFinder.find_spec

def find_spec(name, path=None, target=None):
    return None if name.partition(".")[0] in {blocked} else found(name, path, target)

PathFinder.find_spec = find_spec
"""


def names(requirements: list[str]) -> set[str]:
    """The distributions of some requirements, as pip spells them."""
    return {re.split(r"[\[<>=!~ ]", one)[0].lower().replace("_", "-") for one in requirements}


def distributions(library: str) -> list[str]:
    """The installed distributions that a library comes with."""
    return _DISTRIBUTIONS.get(BROUGHT_BY.get(library, library), [])


def without(folder: Path, libraries: list[str], *words: str) -> subprocess.CompletedProcess[str]:
    """Run the command in processes that cannot import some libraries."""
    (folder / "sitecustomize.py").write_text(BLOCKER.format(blocked=set(libraries)))
    return subprocess.run(
        [sys.executable, "-m", "pounding", *words],
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | {"PYTHONPATH": str(folder)},
    )


def test_every_extra_is_in_the_project_file_and_in_all() -> None:
    optional = PROJECT["optional-dependencies"]
    for library, extra in EXTRAS.items():
        assert library.replace("_", "-") in names(optional[extra.name]), library
    assert set(optional) == {extra.name for extra in EXTRAS.values()} | {"all", "develop"}
    every = re.findall(r"\w+", optional["all"][0].partition("[")[2])
    assert set(every) == {extra.name for extra in EXTRAS.values()}


def test_libraries_are_dependencies_and_those_of_extras_are_imported_by_one_function() -> None:
    used: dict[str, str] = {}
    for path in MODULES.values():
        used |= {one.partition(".")[0]: place(path) for one in imported(path, types=False)}
    ignored = {"pounding", *DEVELOPMENT, *sys.stdlib_module_names}
    used = {one: path for one, path in used.items() if one not in ignored}
    assert not used.keys() & EXTRAS.keys(), "to be imported by extra_module"
    declared = names(PROJECT["dependencies"])
    unknown = {one: path for one, path in used.items() if not names(distributions(one)) & declared}
    assert not unknown, "not among the dependencies of pyproject.toml"


@pytest.mark.parametrize("words", ["--help", "list", "modal 5A", "design --tall 39 --short 21 --pga 0.2"])
def test_without_any_extra_the_command_works(words: str, tmp_path: Path) -> None:
    done = without(tmp_path, list(EXTRAS), *words.split())
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""


@pytest.mark.slow
def test_without_any_extra_a_frame_is_shaken_and_two_collide(tmp_path: Path) -> None:
    for words in (
        ["shake", "5A", "--out", str(tmp_path / "shaken"), "--csv"],
        ["pound", "10", "5B", "--gap", "5", "--out", str(tmp_path / "pair")],
        ["gap", "10", "5B"],
    ):
        done = without(tmp_path, list(EXTRAS), *words, "--record", "elcentro-chopra")
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "shaken" / "shake.nc").is_file()


@pytest.mark.parametrize(
    ("library", "words"),
    [
        ("imageio_ffmpeg", ["shake", "5A", "--record", "elcentro-chopra", "--film", "--out", "OUT"]),
        (
            "imageio_ffmpeg",
            ["pound", "10", "5B", "--gap", "5", "--record", "elcentro-chopra", "--film", "--out", "OUT"],
        ),
        ("imageio_ffmpeg", ["diagnose", "case", "--film", "--out", "OUT"]),
        ("joblib", ["diagnose", "case", "--calibrate", "--out", "OUT"]),
        ("pint", ["diagnose", "case", "--candidates", "mine.py", "--out", "OUT"]),
        ("pysindy", ["diagnose", "--benchmark", "1", "--way", "sparse-pysindy", "--out", "OUT"]),
        ("statsmodels", ["study", "chapter-7", "--out", "OUT"]),
    ],
)
def test_a_feature_without_its_library_is_one_sentence_that_names_the_extra(
    library: str,
    words: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hide(library, monkeypatch)
    with pytest.raises(SystemExit) as left:
        main([str(tmp_path / "out") if one == "OUT" else one for one in words])
    out, err = capsys.readouterr()
    assert left.value.code == 2
    assert out == ""
    assert err.startswith(f"pounding: {EXTRAS[library].features} need the extra")
    assert err.endswith(f"pip install '.[{EXTRAS[library].name}]' from a checkout of pounding\n")
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def hide(library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a library not be found in this process, nor what another test has loaded of it."""
    for module in [one for one in sys.modules if one.startswith(f"{library}.")] + [library]:
        monkeypatch.setitem(sys.modules, module, None)


def nothing(case: int) -> dict[str, int]:
    return {"nothing": case}


def test_functions_without_their_library_raise_the_same(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for library in ("distributed", "hdf5plugin", "statsmodels"):
        hide(library, monkeypatch)
    with pytest.raises(MissingExtraError, match=r"\.\[cluster\]"):
        sweep(nothing, {"case": [1]}, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(MissingExtraError, match=r"\.\[records\]"):
        read_fema("coolwater-ln", tmp_path / "farfield.hdf5")
    cases = pd.DataFrame({"HT": np.arange(9.0), "gap_mm": np.arange(9.0) ** 2})
    with pytest.raises(MissingExtraError, match=r"\.\[regression\]"):
        regression.fit(cases, ["HT"])


def test_a_library_that_is_broken_is_said_with_its_reason(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "pint").mkdir()
    (tmp_path / "pint" / "__init__.py").write_text("import no_such_library_below_pint")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "pint", raising=False)
    with pytest.raises(MissingExtraError, match="no_such_library_below_pint"):
        extra_module("pint")
