"""The folder that a configuration leaves: made under a hidden name, and there only when it is whole."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pounding.experiments.configurations import measured
from pounding.experiments.configurations.running import Outcome
from pounding.experiments.console.output import plain
from pounding.experiments.output.result_folder import Kept
from pounding.experiments.pictures.series import replace_folder
from pounding.experiments.results.provenance import stamp
from pounding.frames.errors import FrameError
from pounding.frames.files import scratch, tried_folder, uninterrupted, write_whole

RESULT = "experiment.json"
"""A folder without it is not whole."""

AT_TIMES = ("collision.png", "closest.png", "forces.png", "loops.png")
"""What a run leaves or not, so that an older one of another run must go."""


def prepare(out: Path, name: str) -> None:
    """See that the folder of a configuration can be written, before anything is computed.

    Args:
        out: Folder for all configurations.
        name: Name of the configuration.

    Raises:
        FrameError: It cannot be made or written.
    """
    tried_folder(out / name)


def result_of(outcome: Outcome) -> dict[str, Any]:
    """Return all of an outcome as `pounding experiment --json` prints it, stamped."""
    experiment = outcome.experiment
    asked: dict[str, Any] = {
        "experiment": experiment.name,
        "kind": experiment.kind,
        "frames": experiment.frame_names,
    }
    asked |= {"record": experiment.motion, "states": [one.as_dict() for one in outcome.states]}
    whole = stamp(asked, outcome.motions) | {
        "experiment": experiment.name,
        "title": experiment.title,
        "chapters": experiment.chapters,
        "figures": experiment.figures,
        "measured": [asdict(row) for row in outcome.rows],
        "warnings": outcome.warnings,
        "result": outcome.numbers,
    }
    found: dict[str, Any] = plain(whole)
    return found


def keep(outcome: Outcome, out: Path) -> Kept:
    """Write the files of a configuration into the folder of its name.

    Args:
        outcome: What it gave.
        out: Folder for all configurations; made if it is not there.

    Returns:
        What is in its folder now.

    Raises:
        FrameError: A file cannot be written. Then nothing of it stays, and what was there before is not touched.
    """
    folder, result = out / outcome.experiment.name, result_of(outcome)
    try:
        with scratch(out, outcome.experiment.name) as made:
            kept = outcome.write(result, made)
            measured.write(outcome.rows, made / "measured.csv")
            files = [*kept.files, "measured.csv", RESULT]
            text = json.dumps(result | {"files": files}, indent=2, allow_nan=False)
            write_whole(made / RESULT, (text + "\n").encode())
            _settle(made, folder)
    except OSError as error:
        raise FrameError(f"{folder}: cannot be written ({error.strerror or error})") from error
    return Kept(files, kept.notes)


def _settle(made: Path, folder: Path) -> None:
    """Move what was made to where it belongs; of an older run only what is made anew goes."""
    made.chmod(0o755)
    with uninterrupted():
        if not folder.exists():
            os.replace(made, folder)
            return
        (folder / RESULT).unlink(missing_ok=True)
        for name in AT_TIMES:
            (folder / name).unlink(missing_ok=True)
        for path in sorted(made.iterdir(), key=lambda one: one.name == RESULT):
            if path.is_dir():
                replace_folder(path, folder / path.name)
            else:
                os.replace(path, folder / path.name)
