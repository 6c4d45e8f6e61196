"""One lumped model of two frames in OpenSees and in the exudyn rig, side by side in one run.

Same masses, storey springs, damping matrix, record, gap and law in both; each engine runs at several
accuracies, OpenSees by Newmark's average acceleration and by central differences. Speeds are compared where
both meet the same force accuracy against a converged reference: the cheapest setting of each from which on
every finer one meets it too. Costs are processor time, the best of three runs. The full Craig-Bampton frames
of the package are timed beside them.

    pip install openseespy==3.7.1.2   # no dependency: its licence does not let everyone redistribute it
    apt-get install libblas3 liblapack3
    python tests/benchmarks/opensees_peer.py --record northridge --out docs/validation/opensees.json
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parent))
from opensees_model import LumpedFrame, lumped, peaks

from pounding import frames
from pounding.contact import BUILT_IN, HertzDamp, Law, NonlinearViscoelastic, thesis_law
from pounding.contact.damping import hertz_damp_ratio
from pounding.experiments.records import find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import ExactRig
from pounding.experiments.rig.rig import Accuracy, Rig
from pounding.scale import THESIS

LAWS = BUILT_IN
INTEGRATORS = ("Newmark", "CentralDifference")
STEPS_S = (4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7)
EXACT_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
LONGEST_STEP_S = 2e-3
REFERENCE = Accuracy(relative=1e-9, absolute=1e-11, longest_step_s=1e-4)
REPEATS = 3
FORCE_ERRORS = (0.03, 0.01)
SAMPLE_S = 1e-4


def stick(name: str, frame: LumpedFrame) -> frames.ReducedFrame:
    """Return the lumped frame as the rig takes it, with the very same damping matrix."""
    definition = frames.StickFrame(
        name=name,
        storeys=len(frame.floor_mass_kg),
        storey_height_m=0.1,
        floor_mass_kg=frame.floor_mass_kg.tolist(),
        storey_stiffness_n_per_m=frame.storey_stiffness_n_per_m.tolist(),
        damping_ratio=0.005,
    )
    return dataclasses.replace(frames.build(definition), damping=frame.matrices()[2])


def numbers(law: Law) -> dict[str, float]:
    """Return a law's parameters as OpenSees' material wants them."""
    found = {key: value for key, value in dataclasses.asdict(law).items() if isinstance(value, float)}
    if isinstance(law, NonlinearViscoelastic):
        found["effective_mass"] = law.reduced_mass
    if isinstance(law, HertzDamp):
        found["damping_factor"] = hertz_damp_ratio(law.restitution, law.formula)
    return found


@dataclasses.dataclass(frozen=True)
class Sample:
    """What is compared: peak force [N] and displacement [m], cost [CPU s per simulated s]."""

    engine: str
    setting: str
    peak_force_n: float
    peak_m: float
    cost: float

    def errors(self, reference: Sample) -> tuple[float, float]:
        """Return the errors of peak force and displacement, as fractions of the reference's."""
        return (
            abs(self.peak_force_n / reference.peak_force_n - 1.0),
            abs(self.peak_m / reference.peak_m - 1.0),
        )


class Pair:
    """15 storeys beside 5, lumped, under one record."""

    def __init__(
        self, record_name: str, gap_m: float, duration_s: float, longest_step_s: float = LONGEST_STEP_S
    ) -> None:
        self.longest_step_s = longest_step_s
        self.left = lumped(np.full(15, 98.0 / 15), 2.28, 0.00503)
        self.right = lumped(np.full(5, 32.7 / 5), 6.531, 0.00467)
        self.record = find(record_name).scaled(THESIS.time_factor)
        self.gap_m, self.duration_s = gap_m, min(duration_s, self.record.duration_s)

    def opensees(self, law: Law, integrator: str, step_s: float) -> Sample | None:
        """Return OpenSees' result, or None where it did not converge."""
        try:
            runs = [
                peaks(
                    self.left, self.right, floor=5, gap_m=self.gap_m, law=law.name, numbers=numbers(law),
                    acceleration_m_s2=self.record.acceleration_m_s2, sample_s=self.record.step_s,
                    step_s=step_s, duration_s=self.duration_s, integrator=integrator,
                )
                for _ in range(REPEATS)
            ]  # fmt: skip
        except RuntimeError:
            return None
        cost = min(run.processor_s for run in runs) / self.duration_s
        setting = f"{integrator} {1e3 * step_s:g} ms"
        return Sample("OpenSees", setting, runs[0].peak_force_n, runs[0].peak_m, cost)

    def rig(self, law: Law, accuracy: Accuracy, *, full: bool = False) -> Sample:
        """Return the rig's result, on the lumped frames or on the package's own."""
        if full:
            bodies = [frames.build(frames.load(name)) for name in ("15B", "5B")]
        else:
            bodies = [stick("lumped-15", self.left), stick("lumped-5", self.right)]
        rig = Rig(bodies, [Contact(law, self.gap_m, 5)])
        motions = [
            rig.run(self.record, duration_s=self.duration_s, accuracy=accuracy) for _ in range(REPEATS)
        ]
        motion = min(motions, key=lambda one: one.processor_s)
        peak = max(np.abs(frame.displacement_m[:, frame.reduced.floor_x]).max() for frame in motion.frames)
        force = motion.contacts[0].sampled(1.0 / SAMPLE_S)[1].max()
        engine = "exudyn, Craig-Bampton" if full else "exudyn"
        setting = f"tolerance {accuracy.relative:g}"
        return Sample(engine, setting, float(force), float(peak), motion.processor_s / motion.model_s)

    def exact(self, law: Law, tolerance: float, longest_step_s: float) -> Sample:
        """Return what the exact solver gives on the lumped frames, its steps read as those of the rig are."""
        bodies = [stick("lumped-15", self.left), stick("lumped-5", self.right)]
        rig = ExactRig(bodies, [Contact(law, self.gap_m, 5)])
        costs = []
        for _ in range(3 * REPEATS):
            started = time.thread_time()
            solution = rig.solve(
                self.record.acceleration_m_s2, self.record.step_s, duration_s=self.duration_s,
                tolerance=tolerance, longest_s=longest_step_s,
            )  # fmt: skip
            costs.append(time.thread_time() - started)
        motion = rig.motion(solution, (0.0, 0.0))
        peak = max(np.abs(frame.displacement_m[:, frame.reduced.floor_x]).max() for frame in motion.frames)
        force = motion.contacts[0].sampled(1.0 / SAMPLE_S)[1].max()
        setting = f"tolerance {tolerance:g}"
        return Sample("exact", setting, float(force), float(peak), min(costs) / self.duration_s)


def compare(pair: Pair) -> Iterator[dict]:
    """Yield one row a law: every run with its errors, and the speed ratio at equal force accuracy."""
    for name in LAWS:
        law = thesis_law(name, tension=True)  # OpenSees' materials pull before separation
        reference = pair.rig(law, REFERENCE)
        ours = [pair.rig(law, Accuracy(r, r * 1e-2, pair.longest_step_s)) for r in TOLERANCES]
        closed = [pair.exact(law, tolerance, pair.longest_step_s) for tolerance in EXACT_TOLERANCES]
        peers = {
            integrator: [
                peer for step in STEPS_S if (peer := pair.opensees(law, integrator, step)) is not None
            ]
            for integrator in INTEGRATORS
        }
        runs = [*ours, *closed, *(sample for samples in peers.values() for sample in samples)]
        yield {
            "law": name,
            "reference": dataclasses.asdict(reference),
            "runs": [_described(sample, reference) for sample in runs],
            "speed_ratio_at_force_error": {
                f"{limit:g}": _ratio(ours, peers, reference, limit) for limit in FORCE_ERRORS
            },
            "exact_speed_ratio_at_force_error": {
                f"{limit:g}": _ratio(closed, peers, reference, limit) for limit in FORCE_ERRORS
            },
            "craig_bampton": dataclasses.asdict(pair.rig(law, Accuracy(), full=True)),
        }


def _described(sample: Sample, reference: Sample) -> dict:
    """Return a run and its errors; nothing but its cost where the force is off by more than itself."""
    force, displacement = sample.errors(reference)
    found = dataclasses.asdict(sample) | {"force_error": force, "displacement_error": displacement}
    if force < 1.0:
        return found
    return found | dict.fromkeys(("peak_force_n", "peak_m", "force_error", "displacement_error"))


def _cheapest(samples: Iterable[Sample], reference: Sample, limit: float) -> float | None:
    """Return the lowest cost among settings from which on every finer one keeps the limit."""
    kept = None
    for sample in reversed(list(samples)):
        if sample.errors(reference)[0] > limit:
            break
        kept = sample.cost
    return kept


def _ratio(
    ours: list[Sample], peers: dict[str, list[Sample]], reference: Sample, limit: float
) -> float | None:
    mine = _cheapest(ours, reference, limit)
    theirs = [cost for samples in peers.values() if (cost := _cheapest(samples, reference, limit))]
    return min(theirs) / mine if mine and theirs else None


def show(rows: list[dict], console: Console) -> None:
    """Print the runs and the ratios."""
    table = Table("law", "engine", "setting", "force [N]", "error", "peak [mm]", "error", "s / model s")
    for row in rows:
        for run in row["runs"]:
            numbers = ["blew up", "", "", ""]
            if run["force_error"] is not None:
                numbers = [
                    f"{run['peak_force_n']:.0f}", f"{run['force_error']:.2%}",
                    f"{1e3 * run['peak_m']:.2f}", f"{run['displacement_error']:.2%}",
                ]  # fmt: skip
            table.add_row(row["law"], run["engine"], run["setting"], *numbers, f"{run['cost']:.3f}")
        full = row["craig_bampton"]
        table.add_row(row["law"], full["engine"], full["setting"], f"{full['peak_force_n']:.0f}", "",
                      f"{1e3 * full['peak_m']:.2f}", "", f"{full['cost']:.3f}")  # fmt: skip
        table.add_section()
    console.print(table)
    for row in rows:
        for key, engine in (("speed", "exudyn"), ("exact_speed", "the exact solver")):
            ratios = ", ".join(
                f"{ratio:.1f} times at {float(limit):.0%}"
                if ratio
                else f"no settings in common at {float(limit):.0%}"
                for limit, ratio in row[f"{key}_ratio_at_force_error"].items()
            )
            console.print(f"{row['law']}: {engine} is faster than OpenSees by {ratios} of force error")


def main() -> None:
    """Run the comparison and print it; write it as JSON where asked."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--record", default="northridge")
    parser.add_argument("--gap", type=float, default=20.0, help="gap [mm]")
    parser.add_argument("--duration", type=float, default=4.0, help="model seconds")
    parser.add_argument("--longest-step", type=float, default=1e3 * LONGEST_STEP_S, help="ours [ms]")
    parser.add_argument("--out", type=Path)
    chosen = parser.parse_args()
    pair = Pair(chosen.record, 1e-3 * chosen.gap, chosen.duration, 1e-3 * chosen.longest_step)
    rows = list(compare(pair))
    show(rows, Console(width=150))
    if chosen.out:
        chosen.out.write_text(
            json.dumps({"record": chosen.record, "gap_mm": chosen.gap, "laws": rows}, indent=1) + "\n"
        )


if __name__ == "__main__":
    main()
