"""Hide effects in plane frames, and with --diagnose diagnose them and print a table.

Not part of the tests. A set has 24 cases in a random order: 5 frames of a strange construction without an effect, 14
with one effect, 2 with two, and 3 with something that is in no catalogue. Frames, laws, motions, integration and files
are those of this folder and of SciPy; of the project only the baseline model of a frame is used, the folder of records
that POUNDING_RECORDS names, and the diagnosis itself once a case has been written. A set takes a quarter of an hour,
its diagnosis much longer; both go on where they were interrupted.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from tests.planar_world.judging import HEAD, Judged, report_of, row, summary
from tests.planar_world.making import make
from tests.planar_world.motion import missing_records
from tests.planar_world.plan import Plan, plans
from tests.planar_world.truth import truth


def main() -> None:
    """Make the cases that are asked for, and diagnose them where that is asked for."""
    asked = _arguments()
    wanted = plans(asked.seed)
    names = [plan.name for plan in wanted]
    only = asked.only.split(",") if asked.only else names
    if unknown := [name for name in only if name not in names]:
        _refuse(f"no case {unknown[0]!r}; there are {', '.join(names)}")
    if missing := missing_records():
        _refuse(missing)
    wanted = [plan for plan in wanted if plan.name in only]
    store = Store(asked.out)
    store.claim(asked.seed)
    for plan in wanted:
        if not store.has(plan):
            store.make(plan)
            print(f"{plan.name}: written", file=sys.stderr, flush=True)
    if asked.diagnose:
        _diagnose(store, wanted)


def _refuse(why: str) -> NoReturn:
    """Say what is wrong in one line, and end with status 2."""
    print(f"planar_world: {why}", file=sys.stderr)
    sys.exit(2)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.planar_world", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="which set is drawn")
    parser.add_argument(
        "--out", type=Path, required=True, help="folder for the cases, truth.json, and reports/"
    )
    parser.add_argument("--only", default="", metavar="NAMES", help="only these cases, such as c01,c05")
    parser.add_argument("--diagnose", action="store_true", help="diagnose the cases and print a table")
    return parser.parse_args()


@dataclass(frozen=True)
class Store:
    """The folder of a set: folders of cases, `truth.json`, `seed.txt`, and the reports in `reports/`.

    Attributes:
        folder: Made if it is not there.
    """

    folder: Path

    def claim(self, seed: int) -> None:
        """Begin the set of a seed, or go on with it; leave where the folder holds the set of another."""
        file = self.folder / "seed.txt"
        if file.is_file() and (other := file.read_text(encoding="utf-8").strip()) != str(seed):
            _refuse(f"{self.folder} holds the set of seed {other}; give another folder")
        self.folder.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{seed}\n", encoding="utf-8")

    def truths(self) -> dict[str, dict[str, Any]]:
        """Return the truth of every case that was made, by its name."""
        file = self.folder / "truth.json"
        if not file.is_file():
            return {}
        return {entry["case"]: entry for entry in json.loads(file.read_text(encoding="utf-8"))}

    def has(self, plan: Plan) -> bool:
        """Whether a case is there, whole."""
        return plan.name in self.truths() and (self.folder / plan.name / "case.toml").is_file()

    def make(self, plan: Plan) -> None:
        """Write a case and its truth; a report on an earlier one of its name is gone."""
        self.report(plan).unlink(missing_ok=True)
        made = make(self.folder / plan.name, plan)
        truths = dict(sorted((self.truths() | {plan.name: truth(made)}).items()))
        part = self.folder / "truth.json.part"
        part.write_text(json.dumps(list(truths.values()), indent=1), encoding="utf-8")
        part.replace(self.folder / "truth.json")

    def report(self, plan: Plan) -> Path:
        """Return the file of the report on a case."""
        return self.folder / "reports" / f"{plan.name}.json"


def _diagnose(store: Store, wanted: list[Plan]) -> None:
    """Print a row for every case, diagnosed from its files alone, and then the counts."""
    print(row(HEAD), row(["---"] * len(HEAD)), sep="\n", flush=True)
    truths, judged = store.truths(), []
    for plan in wanted:
        report = report_of(store.folder / plan.name, store.report(plan))
        judged.append(Judged.of(truths[plan.name], report))
        print(row(judged[-1].cells()), flush=True)
    print("", *summary(judged), sep="\n")


if __name__ == "__main__":
    main()
