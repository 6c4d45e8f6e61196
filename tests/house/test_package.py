"""One importable name: what is built, installed and loaded, in a clone and elsewhere."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.house.test_imports import HOUSE, PACKAGES

BUILD = "import sys; from setuptools import build_meta as b; print(getattr(b, 'build_' + sys.argv[1])(sys.argv[2]))"
"""The hooks that pip calls to build a wheel or an sdist, without a download of setuptools."""

EVERY_MODULE = """
import os, pkgutil, sys
from importlib import import_module
import pounding

def all_of(package):
    for found in pkgutil.iter_modules(package.__path__, package.__name__ + "."):
        if found.name.endswith("__main__"):
            continue
        module = import_module(found.name)
        if found.ispkg:
            all_of(module)

all_of(pounding)
names = {}
for name, module in list(sys.modules.items()):
    file = getattr(module, "__file__", None)
    if file and name != "__main__":
        names.setdefault(os.path.realpath(file), []).append(name)
ours = os.path.realpath(os.path.dirname(os.path.dirname(pounding.__file__)))
mine = {path: found for path, found in names.items() if path.startswith(ours + os.sep) and "site-packages" not in path}
print(len(mine), [found for found in mine.values() if len(found) > 1 or not found[0].startswith("pounding")])
"""


def run(
    *words: str | Path, cwd: Path, path: Path | None = None, check: bool = True
) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder with `path` alone as PYTHONPATH."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    if path is not None:
        environment["PYTHONPATH"] = str(path)
    done = subprocess.run(
        [str(word) for word in words], cwd=cwd, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0 or not check, done.stderr
    return done


def sources() -> list[str]:
    """What git has or would have of the clone, as paths from its root."""
    listed = run("git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", cwd=HOUSE).stdout
    return [one for one in listed.split("\0") if one and os.path.lexists(HOUSE / one)]


@dataclass(frozen=True)
class Built:
    """A wheel, an sdist and an environment in which nothing but the wheel is installed."""

    wheel: Path
    sdist: Path
    python: Path
    packages: Path


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    clone, out, empty = (tmp_path_factory.mktemp(name) for name in ("clone", "out", "empty"))
    for one in sources():
        (clone / one).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(HOUSE / one, clone / one, follow_symlinks=False)
    names = [
        run(sys.executable, "-c", BUILD, kind, out, cwd=clone).stdout.split()[-1]
        for kind in ("wheel", "sdist")
    ]
    venv.create(empty, symlinks=True)
    python = empty / "bin" / "python"
    packages = next((empty / "lib").glob("python*/site-packages"))
    assert not list(packages.iterdir())
    install = ("install", "--quiet", "--no-deps", "--no-index", out / names[0])
    run(sys.executable, "-m", "pip", "--python", python, *install, cwd=out)
    return Built(out / names[0], out / names[1], python, packages)


@pytest.mark.slow
def test_the_wheel_installs_one_name_and_every_file_of_the_packages(built: Built) -> None:
    top = {path.name for path in built.packages.iterdir()}
    assert {name for name in top if not name.endswith(".dist-info")} == {"pounding"}
    assert len(top) == 2
    wanted = {
        f"pounding/{one}" for one in sources() if one.startswith(tuple(f"{name}/" for name in PACKAGES))
    }
    wanted |= {one for one in sources() if one.startswith("pounding/") and not (HOUSE / one).is_symlink()}
    assert "pounding/py.typed" in wanted
    packed = {one for one in zipfile.ZipFile(built.wheel).namelist() if ".dist-info/" not in one}
    assert packed == wanted
    assert run(built.python, "-c", "import pounding.extras", cwd=built.packages.parent).stderr == ""


@pytest.mark.slow
def test_the_sdist_builds_the_same_wheel(built: Built, tmp_path: Path) -> None:
    with tarfile.open(built.sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    (unpacked,) = tmp_path.iterdir()
    assert not [name for name in (*PACKAGES, "tests") if (unpacked / name).exists()]
    run(sys.executable, "-c", BUILD, "wheel", tmp_path, cwd=unpacked)
    again = zipfile.ZipFile(tmp_path / built.wheel.name)
    first = zipfile.ZipFile(built.wheel)
    assert {one: again.read(one) for one in again.namelist()} == {
        one: first.read(one) for one in first.namelist()
    }


@pytest.mark.slow
def test_an_index_shows_the_readme_without_links_that_lead_nowhere(built: Built) -> None:
    metadata = next(built.packages.glob("*.dist-info/METADATA")).read_text(encoding="utf-8")
    _, _, described = metadata.partition("\n\n")
    assert "Description-Content-Type: text/markdown" in metadata
    assert "## Three commands" in described
    assert "what to do about pounding, how likely it is over many records" in described
    links = re.findall(r"\]\(([^)]*)\)", described)
    assert not [one for one in links if not one.startswith("https://")]
    assert "![" not in described


@pytest.mark.slow
def test_what_is_installed_works_from_elsewhere(built: Built, tmp_path: Path) -> None:
    study = run(
        sys.executable,
        "-m",
        "pounding.experiments.studies.table_3_1",
        "--help",
        cwd=tmp_path,
        path=built.packages,
    )
    assert "Usage: python -m pounding.experiments.studies.table_3_1" in study.stdout
    where = run(
        sys.executable,
        "-c",
        "import pounding.frames; print(pounding.frames.__file__)",
        cwd=tmp_path,
        path=built.packages,
    )
    assert Path(where.stdout.strip()).is_relative_to(built.packages)
    # Files that are data: frames, published tables, templates.
    for words in (["modal", "5B"], ["study", "chapter-5", "--help"]):
        run(sys.executable, "-m", "pounding", *words, cwd=tmp_path, path=built.packages)
    asked = ["design", "--tall", "39", "--short", "21", "--pga", "0.2", "--report", "page.html"]
    run(sys.executable, "-m", "pounding", *asked, cwd=tmp_path, path=built.packages)
    assert (tmp_path / "page.html").is_file()


@pytest.mark.slow
def test_the_installed_command_shakes_a_frame(built: Built, tmp_path: Path) -> None:
    """The script that pip writes, in the environment that has nothing else; the libraries are those that run this test."""
    words = ("shake", "5A", "--record", "elcentro-chopra")
    script, libraries = built.python.with_name("pounding"), Path(pytest.__file__).parents[1]
    assert "floor" in run(script, *words, cwd=tmp_path, path=libraries).stdout
    where = "import pounding; print(pounding.__file__)"
    found = run(built.python, "-c", where, cwd=tmp_path, path=libraries).stdout
    assert Path(found.strip()).is_relative_to(built.packages)


def test_no_module_is_loaded_under_two_names() -> None:
    """In the clone's root, where Python would also find frames/, contact/ and so on under these names."""
    count, twice = run(sys.executable, "-c", EVERY_MODULE, cwd=HOUSE).stdout.split(" ", 1)
    assert int(count) > 250
    assert twice.strip() == "[]"


def test_a_folder_of_the_users_own_named_experiments_does_no_harm(tmp_path: Path) -> None:
    for name in PACKAGES:
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise SystemExit('not ours')")
    clone = tmp_path / "clone"
    clone.symlink_to(HOUSE)
    told = run(
        sys.executable,
        "-m",
        "pounding",
        "list",
        cwd=tmp_path,
        path=Path(f"{tmp_path}:{clone}"),
    )
    assert "15B" in told.stdout
    assert told.stderr == ""


def test_a_clone_without_links_is_said_in_one_sentence(tmp_path: Path) -> None:
    """Where git may not make links, it leaves text files that hold their targets."""
    shutil.copy(HOUSE / "Makefile", tmp_path)
    (tmp_path / "pyproject.toml").touch()
    (tmp_path / "pounding").mkdir()
    shutil.copy(HOUSE / "pounding" / "__init__.py", tmp_path / "pounding")
    (tmp_path / "pounding" / "frames").write_text("../frames")
    made = run("make", "test", cwd=tmp_path, check=False)
    assert "this clone was made without symbolic links; run 'git config" in made.stderr
    assert not (tmp_path / ".venv").exists()
    loaded = run(sys.executable, "-c", "import pounding.frames", cwd=tmp_path, check=False)
    assert loaded.stderr.splitlines()[-1].startswith("ImportError: ")
    assert "this clone was made without symbolic links; run 'git config" in loaded.stderr.splitlines()[-1]
