"""The fixed set: cases of the project's own generator, always the same, and the open cases."""

from __future__ import annotations

import json
import os
import sys
from functools import cache
from pathlib import Path
from typing import Any

from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.writing import write_hidden

DRAWN = Path(__file__).with_name("drawn.json")
"""12 pairs and 32 single frames, as `draw_set` drew them of seed 20261122 at 5d638ea.

It would draw others today: what is drawn depends on how many effects there are.
"""

SHARED = Path(__file__).parents[3] / "shared"


def find_folders() -> None:
    """Name the folders of records and open cases, beside the clone where the environment names none; leave without."""
    for variable, name in (("POUNDING_RECORDS", "records"), ("POUNDING_CASES", "cases")):
        folder = Path(os.environ.setdefault(variable, str(SHARED / name)))
        if not folder.is_dir():
            sys.exit(f"guard: {folder} is not there; set {variable} to the folder of the {name}")


def drawn_names() -> list[str]:
    """Return the names of the drawn cases."""
    return list(_drawn())


@cache
def _drawn() -> dict[str, dict[str, Any]]:
    """Return what is hidden in each drawn case, on which frames, and its seed."""
    return dict(json.loads(DRAWN.read_text(encoding="utf-8")))


def open_folders() -> dict[str, Path]:
    """Return the folders of the open cases by name, from the folder that POUNDING_CASES names."""
    files = sorted(Path(os.environ["POUNDING_CASES"]).glob("*/case.toml"))
    return {file.parent.name: file.parent for file in files}


def make(name: str, folder: Path) -> None:
    """Write a drawn case into a folder, unless it is there; its motions need the records of POUNDING_RECORDS."""
    if (folder / "case.toml").is_file():
        return
    drawn = _drawn()[name]
    title = f"case {int(name.split('-')[1])}"
    hidden = hide(drawn["effects"], drawn["frames"], seed=drawn["seed"], source="mixed", title=title)
    write_hidden(hidden, folder)
