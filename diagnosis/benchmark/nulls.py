"""The stored nulls, by which the false-alarm rate is met: rigs on which nothing is missing, simulated and searched.

``python -m pounding.diagnosis.benchmark.nulls 72 --seed 20261123 --out nulls.csv`` makes them, two at a time; a file that
is there already is gone on with. They are hidden cases in which nothing is hidden, but the frame is off its model as
frames are: beside the scatter of the own world's frames a discrepancy at a scale drawn from its prior.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import numpy as np
from scipy.linalg import eigh
from scipy.stats import binomtest

from pounding.cores import cores
from pounding.diagnosis.case.case import Case, CaseFrame
from pounding.diagnosis.decision.beyond_errors import search_beyond_errors
from pounding.diagnosis.decision.false_alarms import FILE, of_rows, read_nulls
from pounding.diagnosis.decision.nulls import Shown, shown
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.hidden.beams import Beams, Matrices
from pounding.diagnosis.hidden.instruments import recorded
from pounding.diagnosis.hidden.rigging import RUNS, draw_rig
from pounding.diagnosis.hidden.worlds import OWN
from pounding.diagnosis.inference.discrepancy import SCALES
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.settings import SETTINGS
from pounding.extras import extra_module

FRAMES = ("5A", "5B", "10", "15A", "15B")
NOISES = (0.002, 0.05)
"""Range of the noise over the root mean square of each channel, drawn log-uniform."""
DISCREPANT = 6
"""So many modes, the lowest, have a discrepancy, as in the model of the diagnosis."""
DURATION_S = 4.0
"""Length of each run [s]: half a usual one, for a second of CPU instead of two."""


@dataclass(frozen=True, kw_only=True)
class _Off(Beams):
    """A frame whose lowest modes are stiffer by an upper triangle of factors, shape (modes, modes)."""

    factors: np.ndarray

    def matrices(self) -> Matrices:
        """Return the matrices of the frame."""
        known = super().matrices()
        many = min(len(self.factors), self.storeys)
        squared, shapes = eigh(known.stiffness, known.mass, subset_by_index=[0, many - 1])
        half = np.sqrt(np.outer(squared, squared)) * self.factors[:many, :many]
        pushed = known.mass @ shapes
        both = half + half.T - np.diag(np.diag(half))
        return replace(known, stiffness=known.stiffness + pushed @ both @ pushed.T)


@dataclass(frozen=True)
class Row:
    """A null of the file: the rig, what was drawn, and what the search found (`Shown`)."""

    number: int
    seed: int
    frame: str
    channels: int
    samples: int
    noise: float
    discrepancy: float
    verdict: str
    cpu_s: float


@dataclass(frozen=True)
class Drawn:
    """A null before it is searched: the frame, noise over the root mean square of its channels [-], scale of the discrepancy
    [-], the baseline model with the runs, and the numbers of training and held-out runs.
    """

    frame: str
    noise: float
    discrepancy: float
    model: Model
    training: list[int]
    held_out: list[int]


def draw(number: int, seed: int) -> Drawn:
    """Return a null, the same whenever it is asked for.

    Args:
        number: Its number in the set; frames come in turn.
        seed: Of the set.
    """
    rng = np.random.default_rng([seed, number])
    frame = FRAMES[number % len(FRAMES)]
    noise = float(np.exp(rng.uniform(*np.log(NOISES))))
    discrepancy = float(rng.choice(SCALES))
    model, training, held_out = _model(_with_fewer(_case(frame, noise, discrepancy, rng), rng))
    return Drawn(frame, noise, discrepancy, model, training, held_out)


def null(number: int, seed: int) -> dict[str, object]:
    """Return the row of a null.

    Args:
        number: Its number in the set.
        seed: Of the set.
    """
    began = time.process_time()
    drawn = draw(number, seed)
    effects = candidates(drawn.model)
    found = search_beyond_errors(drawn.model, effects, drawn.training, drawn.held_out)
    observed = drawn.model.observed
    samples = sum(len(run.time_s) for run in observed.runs)
    row = Row(
        number, seed, drawn.frame, len(observed.names), samples, drawn.noise, drawn.discrepancy, decide(found).verdict,
        time.process_time() - began,
    )  # fmt: skip
    return asdict(row) | asdict(shown(found))


def _case(frame: str, noise: float, discrepancy: float, rng: np.random.Generator) -> Case:
    """Return a hidden case in which nothing is hidden, of a frame with a discrepancy."""
    world = replace(OWN, built=lambda chance, name: _off(OWN.built(chance, name), chance, discrepancy))
    rig = draw_rig(rng, (frame,), "mixed", DURATION_S, world=world, noise=noise)
    runs = tuple(
        recorded(rng, rig.behind_sensors(rig.bare, run), rig.channels, rig.log, f"run{run + 1}.csv")
        for run in range(RUNS)
    )
    known = tuple(CaseFrame(name, beams.storeys) for name, beams in rig.bare.frames.items())
    return Case("null", Path(), known, runs, rig.channels, ())


def _off(beams: Beams, rng: np.random.Generator, discrepancy: float) -> _Off:
    factors = discrepancy * np.triu(rng.standard_normal((DISCREPANT, DISCREPANT)))
    return _Off(**vars(beams), factors=factors)


def _with_fewer(case: Case, rng: np.random.Generator) -> Case:
    """Return a case with one to all of its response channels."""
    responses = [i for i, channel in enumerate(case.channels) if not channel.is_table]
    count = int(rng.integers(1, len(responses) + 1))
    left_out = set(rng.permutation(responses)[count:].tolist())
    kept = [i for i in range(len(case.channels)) if i not in left_out]
    runs = tuple(replace(run, values=run.values[:, kept]) for run in case.runs)
    return replace(case, channels=tuple(case.channels[i] for i in kept), runs=runs)


def _model(case: Case) -> tuple[Model, list[int], list[int]]:
    """Return the model of a case, and the numbers of its training and held-out runs."""
    structure = Structure(baseline_frames(case))
    model = Model(structure, observe(case, structure), case.prior)
    numbers = {run.file: i for i, run in enumerate(case.runs)}
    training, held_out = case.split()
    return model, [numbers[run.file] for run in training], [numbers[run.file] for run in held_out]


def make(numbers: Sequence[int], seed: int, out: Path, workers: int) -> None:
    """Add the nulls of some numbers to a file, those that it lacks.

    Args:
        numbers: Their numbers.
        seed: Of the set.
        out: The file.
        workers: Processes.
    """
    joblib = extra_module("joblib")
    names = [one.name for one in (*fields(Row), *fields(Shown))]
    known: set[int] = set()
    if out.is_file():
        known = {int(row["number"]) for row in read_nulls(out)[0]}
    else:
        out.write_text(",".join(names) + "\n", encoding="utf-8")
    missing = [number for number in numbers if number not in known]
    tasks = (joblib.delayed(null)(number, seed) for number in missing)
    for row in joblib.Parallel(n_jobs=workers, return_as="generator")(tasks):
        with out.open("a", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(_shortly(row[name]) for name in names)


def _shortly(value: object) -> object:
    return f"{value:.5g}" if isinstance(value, float) else value


def judged(path: Path) -> list[str]:
    """Return how many nulls of a file raise an alarm at the usual rate, in sentences.

    The nulls of the package are judged each by all the others, any others by those of the package.

    Args:
        path: The file.
    """
    rows, _ = read_nulls(path)
    stored_rows, _ = read_nulls(FILE)
    rate = SETTINGS.decision.false_alarms
    named = remaining = 0
    for row in rows:
        alarms = of_rows(rate, [one for one in stored_rows if one != row], "")
        named += max(float(row["ordinary"]), float(row["absorbing"])) >= alarms.needed
        remaining += alarms.too_much(float(row["left"]))
    told = []
    alarms_said = sum(row["verdict"] != "nothing_missing" for row in rows)
    for what, count in (
        ("enough evidence for an effect", named),
        ("more remains than noise", remaining),
        ("verdict other than nothing missing, by the thresholds when it was made", alarms_said),
    ):
        low, high = binomtest(count, len(rows)).proportion_ci(0.95, method="wilson")
        told.append(f"{what}: {count} of {len(rows)} nulls, {100 * low:.0f} to {100 * high:.0f} %")
    return told


def main() -> None:
    """Make the nulls that are asked for, or judge a file."""
    parser = argparse.ArgumentParser(prog="python -m pounding.diagnosis.benchmark.nulls", description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=0, help="how many nulls")
    parser.add_argument(
        "--judge", action="store_true", help="print how many nulls of the file raise an alarm"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the set")
    parser.add_argument(
        "--out", type=Path, required=True, help="CSV file; nulls that it has are not made again"
    )
    parser.add_argument("--workers", type=int, default=min(2, cores()), help="nulls at a time")
    asked = parser.parse_args()
    if asked.judge:
        print("\n".join(judged(asked.out)))
    else:
        make(range(asked.count), asked.seed, asked.out, asked.workers)


if __name__ == "__main__":
    main()
