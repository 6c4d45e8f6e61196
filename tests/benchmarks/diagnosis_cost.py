"""What a diagnosis costs over samples, channels and storeys: CPU and wall seconds, and the most memory it needed.

Each row is a case of three runs in which a storey is a cubic spring too stiff. It is written to a folder, and read,
diagnosed and reported in a process of its own, so that memory is its own, too; it is measured where Linux tells of it. The
frames are those of the thesis; the model makes the motion, with noise of 1 %. One thing varies at a time about 3 x 8 s at
500 Hz, and its exponent is fitted. Last come a pair of frames that the generator made and the longest case that the
diagnosis is meant for: three runs of 60 s at 1 kHz with 12 channels.

    python -m tests.benchmarks.diagnosis_cost --out cost.json
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from pounding.diagnosis import diagnose
from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Run
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.effects.storey import CubicStiffness
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.storeys import Structure

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What the command sets: the diagnosis has threads of its own."""
RUNS, NOISE, PEAK_M_S2 = 3, 0.01, 3.0
FLOORS = {"5A": 5, "10": 10, "15B": 15}
STIFFENED = 0.05
"""Share of the linear force that the cubic spring adds at twice the usual drift."""


@dataclass(frozen=True)
class Setting:
    """A case: frame, channels of floors (accelerations from the top, then displacements), seconds and rate of each run."""

    frame: str = "5A"
    channels: int = 5
    duration_s: float = 8.0
    rate_hz: float = 500.0

    @property
    def samples(self) -> int:
        """Samples of all runs, each of all channels."""
        return RUNS * round(self.duration_s * self.rate_hz)


BASE = Setting()
AXES = {
    "samples": [replace(BASE, duration_s=seconds) for seconds in (4.0, 8.0, 16.0)],
    "channels": [replace(BASE, channels=count) for count in (2, 5, 10)],
    "storeys": [replace(BASE, frame=name) for name in FLOORS],
}
LONG = Setting("10", 12, 60.0, 1000.0)


def made(setting: Setting) -> Case:
    """Return the case of a setting."""
    floors = range(FLOORS[setting.frame], 0, -1)
    sensors = [("absolute_acceleration", "m/s^2", floor) for floor in floors]
    sensors += [("relative_displacement", "m", floor) for floor in floors]
    channels = [Channel("table", "table_acceleration", "m/s^2")]
    channels += [
        Channel(f"{quantity[9]}{floor}", quantity, unit, setting.frame, floor)
        for quantity, unit, floor in sensors[: setting.channels]
    ]
    rng = np.random.default_rng(1)
    step = 1.0 / setting.rate_hz
    times = np.arange(round(setting.duration_s * setting.rate_hz)) * step
    runs = []
    for number in range(RUNS):
        values = np.zeros((len(times), len(channels)))
        values[:, 0] = shaking(rng, len(times), step) * (1.0, 0.8, 0.6)[number]
        runs.append(Run(f"run{number + 1}.csv", None, times, step, values))
    frame = CaseFrame(setting.frame, FLOORS[setting.frame])
    case = Case("cost", Path(), (frame,), tuple(runs), tuple(channels))
    model = modelled(case)
    moved = model.predict(0.3 * model.std * rng.standard_normal(len(model.std)), None, [stiffening(model)])
    for run, shown in zip(runs, moved.outputs, strict=True):
        run.values[:, 1:] = shown + NOISE * shown.std(axis=0) * rng.standard_normal(shown.shape)
    return case


def modelled(case: Case) -> Model:
    """Return the baseline model of a case, with its data."""
    structure = Structure(baseline_frames(case))
    return Model(structure, observe(case, structure), case.prior)


def stiffening(model: Model) -> tuple[CubicStiffness, np.ndarray]:
    """Return the cubic spring of a case and its coefficient [N/m^3], (1,), as the motion of the baseline has it."""
    effect = CubicStiffness(index=1, frame=model.structure.frames[0].name, storey=2)
    still = np.zeros(len(model.std))
    states = model.predict(still).before[0]
    modes = model.modes(model.assemble(still))
    drift = states[:, : len(modes.omega)] @ (model.structure.drift @ modes.floors)[1]
    return effect, np.array([STIFFENED * effect.stiffness(model) / (2 * float(drift.std())) ** 2])


def shaking(rng: np.random.Generator, samples: int, step_s: float) -> np.ndarray:
    """Return noise below about 20 Hz that grows and fades [m/s^2], (samples,)."""
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    spectrum *= np.exp(-((np.fft.rfftfreq(samples, step_s) / 20.0) ** 2))
    series = np.fft.irfft(spectrum, samples) * np.sin(np.linspace(0, np.pi, samples)) ** 0.5
    return np.asarray(PEAK_M_S2 * series / np.abs(series).max())


def pair() -> Case:
    """Return a pair of frames that collide, one of which has a softer storey, as the generator makes it."""
    return hide(["stiffness_change:2"], ("5A", "5B"), seed=15, visibility=3.0, source="artificial").case


def cost(case: Path, out: Path) -> dict[str, Any]:
    """Return what diagnosing a folder costs in this process and its workers: seconds, and most memory at a time [MiB]."""
    processor, wall = processor_s(), time.perf_counter()
    with Memory() as memory:
        report = diagnose(case, out)
    return {
        "cpu_s": processor_s() - processor,
        "wall_s": time.perf_counter() - wall,
        "memory_mb": memory.most_mb,
        "verdict": report.verdict,
        "effects": [effect.effect for effect in report.effects],
    }


def processor_s() -> float:
    """Return the CPU seconds of this process and of those that it has waited for."""
    return sum(os.times()[:4])


class Memory:
    """The most memory that this process and its workers have at a time, looked at ten times a second.

    Attributes:
        most_mb: It [MiB]; what several of them share counts once.
    """

    def __init__(self) -> None:
        self.most_mb = 0.0
        self._ended = threading.Event()
        self._watching = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Memory:
        self._watching.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._watching.join()

    def _watch(self) -> None:
        while not self._ended.wait(0.1):
            workers = [
                one for task in Path("/proc/self/task").iterdir() for one in told(task / "children").split()
            ]
            self.most_mb = max(self.most_mb, sum(map(share_mb, ["self", *workers])))


def share_mb(process: str) -> float:
    """Return a process' memory [MiB], of what others have too its share; nothing of one that has ended."""
    rows = told(Path(f"/proc/{process}/smaps_rollup")).splitlines()
    return sum(int(row.split()[1]) for row in rows if row.startswith("Pss:")) / 1024


def told(file: Path) -> str:
    """Return what the system tells in a file, nothing where what it is about has ended."""
    try:
        return file.read_text()
    except OSError:
        return ""


def apart(setting: Setting | None) -> dict[str, Any]:
    """Return the cost of a setting, or of the pair (None), in a process of its own."""
    with TemporaryDirectory() as folder:
        case = Path(folder) / "case"
        write_case(pair() if setting is None else made(setting), case)
        done = subprocess.run(
            [sys.executable, "-m", "tests.benchmarks.diagnosis_cost", "--one", str(case)],
            capture_output=True,
            text=True,
            check=True,
            env=os.environ | dict.fromkeys(ONE_THREAD, "1"),
        )
    return dict(json.loads(done.stdout.splitlines()[-1]))


def exponent(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Return the power of the size by which the cost grows, fitted by least squares in the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def measured() -> dict[str, Any]:
    """Return the costs of all settings, each measured once, and the exponents."""
    settings = list(dict.fromkeys([one for axis in AXES.values() for one in axis] + [LONG]))
    apart(BASE)  # compiles what is not compiled yet
    costs = {one: apart(one) for one in settings}
    sizes: dict[str, Callable[[Setting], float]] = {
        "samples": lambda one: one.samples,
        "channels": lambda one: one.channels,
        "storeys": lambda one: FLOORS[one.frame],
    }
    exponents = {
        name: exponent([sizes[name](one) for one in axis], [costs[one]["cpu_s"] for one in axis])
        for name, axis in AXES.items()
    }
    rows = [
        asdict(one) | {"storeys": FLOORS[one.frame], "samples": one.samples} | found
        for one, found in costs.items()
    ]
    return {"cores": os.cpu_count(), "rows": rows, "pair": apart(None), "exponents": exponents}


def shown(found: dict[str, Any]) -> Table:
    """Return the costs as a table."""
    table = Table("case", "storeys", "channels", "CPU s", "wall s", "memory MiB", "verdict")

    def row(words: list[str], one: dict[str, Any]) -> None:
        numbers = [f"{one['cpu_s']:.0f}", f"{one['wall_s']:.0f}", f"{one['memory_mb']:.0f}"]
        table.add_row(*words, *numbers, ", ".join([one["verdict"], *one["effects"]]))

    for one in found["rows"]:
        label = f"{one['frame']}, {RUNS} x {one['duration_s']:g} s at {one['rate_hz']:g} Hz"
        row([label, str(one["storeys"]), str(one["channels"])], one)
    row(["5A beside 5B, generated", "10", ""], found["pair"])
    return table


def main() -> None:
    """Measure and print; with --one diagnose one folder in this process, and print what it cost as JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, help="JSON file of the costs")
    parser.add_argument("--base", action="store_true", help="only the base case; prints its cost as JSON")
    parser.add_argument("--one", type=Path, help="folder of a case; prints its cost as JSON")
    options = parser.parse_args()
    if options.one is not None:
        print(json.dumps(cost(options.one, options.one.with_name("report"))))
        return
    if options.base:
        print(json.dumps(apart(BASE)))
        return
    found = measured()
    console = Console()
    console.print(shown(found))
    powers = ", ".join(f"{name} {power:.2f}" for name, power in found["exponents"].items())
    console.print(f"CPU seconds grow by these powers: {powers}")
    if options.out is not None:
        options.out.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
