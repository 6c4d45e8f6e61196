"""The fixed set: cases of the project's own generator, always the same, and the open cases."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from pounding.diagnosis.benchmark.drawing import draw_set
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.writing import write_hidden

SEED = 20261122
SINGLES, PAIRS = 32, 12


SHARED = Path(__file__).parents[3] / "shared"


def find_folders() -> None:
    """Name the folders of records and open cases, beside the clone where the environment names none; leave without."""
    for variable, name in (("POUNDING_RECORDS", "records"), ("POUNDING_CASES", "cases")):
        folder = Path(os.environ.setdefault(variable, str(SHARED / name)))
        if not folder.is_dir():
            sys.exit(f"guard: {folder} is not there; set {variable} to the folder of the {name}")


def drawn_names() -> list[str]:
    """Return the names of the drawn cases."""
    return [f"pair-{i:02d}" for i in range(PAIRS)] + [f"single-{i:02d}" for i in range(SINGLES)]


def open_folders() -> dict[str, Path]:
    """Return the folders of the open cases by name, from the folder that POUNDING_CASES names."""
    files = sorted(Path(os.environ["POUNDING_CASES"]).glob("*/case.toml"))
    return {file.parent.name: file.parent for file in files}


def make(name: str, folder: Path) -> None:
    """Write a drawn case into a folder, unless it is there; its motions need the records of POUNDING_RECORDS."""
    if (folder / "case.toml").is_file():
        return
    kind, number = name.split("-")
    pairs = kind == "pair"
    drawn = draw_set(PAIRS if pairs else SINGLES, SEED, pairs=pairs)[int(number)]
    hidden = hide(drawn.effects, drawn.frames, seed=drawn.seed, source="mixed", title=f"case {int(number)}")
    write_hidden(hidden, folder)
