"""Modes that PyOMA2 identifies from the ambient vibration of a stick, as a table that a frame file takes, beside the truth.

`pip install pyoma-2` first; then `python tests/benchmarks/pyoma_modes.py --out docs/validation/pyoma-modes.json`.
"""

from __future__ import annotations

import argparse
import json
import logging
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyoma2
from pyoma2.algorithms import SSI
from pyoma2.setup import SingleSetup
from scipy.linalg import expm

from pounding import frames
from pounding.experiments.records import find
from pounding.experiments.rig.exact import run_exact

OFFICE = """\
kind = "stick"
storeys = 4
storey_height_m = [4.0, 3.2, 3.2, 3.2]
floor_mass_kg = [310e3, 290e3, 290e3, 250e3]
plan_m = [24.0, 15.0]
slab = { thickness_m = 0.20 }
"""
TRUTH = 'name = "office"\nfrequency_hz = [1.1, 3.2]\ndamping_ratio = [0.03, 0.04]\n'
MEASURED = 'name = "measured"\n[modes]\nfile = "modes.csv"\n'

RATE_HZ = 50.0
DURATION_S = 3600.0
NOISE = 0.05
"""Of each sensor, as a share of the rms of what it measures."""

BLOCK_ROWS, ORDER = 30, 24


def ambient(frame: frames.ReducedFrame, seed: int) -> np.ndarray:
    """Return what accelerometers on all floors record (m, n) [m/s^2] while independent noise pushes every floor.

    Args:
        frame: The stick.
        seed: Seed of the forces and of the sensors' noise.
    """
    rng, floors, step = np.random.default_rng(seed), frame.storeys, 1.0 / RATE_HZ
    inverse = np.linalg.inv(frame.mass)
    springs = -inverse @ np.hstack([frame.stiffness, frame.damping])
    system = np.vstack([np.hstack([np.zeros((floors, floors)), np.eye(floors)]), springs])
    ahead = expm(system * step)
    # A force that is held over a step.
    pushed = np.linalg.solve(
        system, (ahead - np.eye(2 * floors)) @ np.vstack([np.zeros((floors, floors)), inverse])
    )
    forces = 1e3 * rng.standard_normal((int(DURATION_S * RATE_HZ), floors))
    state, found = np.zeros(2 * floors), np.empty(forces.shape)
    for number, force in enumerate(forces):
        found[number] = springs @ state + inverse @ force
        state = ahead @ state + pushed @ force
    return found + NOISE * found.std(axis=0) * rng.standard_normal(found.shape)


def identified(measured: np.ndarray, near_hz: list[float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frequencies (k,) [Hz], damping ratios (k,) and shapes (n, k) by covariance-driven subspace identification.

    Args:
        measured: Accelerations (m, n).
        near_hz: Where peaks of the spectrum lie; the user of PyOMA2 picks them in its plot.
    """
    logging.disable(logging.INFO)
    setup = SingleSetup(measured, fs=RATE_HZ)
    setup.add_algorithms(SSI(name="ssi", method="cov", br=BLOCK_ROWS, ordmax=ORDER))
    setup.run_by_name("ssi")
    setup.mpe("ssi", sel_freq=near_hz, order_in=ORDER)
    found = setup["ssi"].result
    return np.asarray(found.Fn), np.asarray(found.Xi), np.asarray(found.Phi)


def as_table(frequencies: np.ndarray, ratios: np.ndarray, shapes: np.ndarray) -> pd.DataFrame:
    """Return a table of modes as a frame file takes it; of a complex shape the real part, turned to its largest entry."""
    tops = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    table = pd.DataFrame((shapes / tops).T.real, columns=[f"floor_{n}" for n in range(1, len(shapes) + 1)])
    table.insert(0, "frequency_hz", frequencies)
    table.insert(1, "damping_ratio", ratios)
    return table


def compared(modes: int, seed: int, folder: Path) -> dict[str, Any]:
    """Return how near a stick of identified modes is to the one whose vibration was measured.

    Args:
        modes: How many are identified.
        seed: Seed of the ambient vibration.
        folder: Where its files are written.
    """
    (folder / "office.toml").write_text(OFFICE + TRUTH)
    truth = frames.build(frames.load(folder / "office.toml"))
    near = [round(float(f), 1) for f in truth.frequencies_hz[:modes]]
    as_table(*identified(ambient(truth, seed), near)).to_csv(folder / "modes.csv", index=False)
    (folder / "measured.toml").write_text(OFFICE + MEASURED)
    found = frames.build(frames.load(folder / "measured.toml"))
    record = find("elcentro-chopra")
    peaks = [
        np.abs(run_exact([one], [], record.acceleration_m_s2, record.step_s).frames[0].displacement_m).max(
            axis=0
        )
        for one in (truth, found)
    ]
    return {
        "modes": modes,
        "seed": seed,
        "frequency_hz": {
            "truth": truth.frequencies_hz[:modes].tolist(),
            "found": found.frequencies_hz[:modes].tolist(),
        },
        "damping_ratio": {
            "truth": truth.damping_ratios[:modes].tolist(),
            "found": found.damping_ratios[:modes].tolist(),
        },
        "mac": [mac(truth.shapes[:, k], found.shapes[:, k]) for k in range(modes)],
        "peak_mm": {"truth": (1e3 * peaks[0]).tolist(), "found": (1e3 * peaks[1]).tolist()},
    }


def mac(first: np.ndarray, second: np.ndarray) -> float:
    """Return the modal assurance criterion of two shapes [-]."""
    return float((first @ second) ** 2 / ((first @ first) * (second @ second)))


def main() -> None:
    """Identify, read back, compare, and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    with tempfile.TemporaryDirectory() as folder:
        runs = [compared(modes, seed, Path(folder)) for modes in (2, 3) for seed in (1, 2, 3)]
    result = {
        "pyoma2": getattr(pyoma2, "__version__", ""),
        "rate_hz": RATE_HZ,
        "duration_s": DURATION_S,
        "noise": NOISE,
        "runs": runs,
    }
    parser.parse_args().out.write_text(json.dumps(result, indent=2) + "\n")
    for one in runs:
        print(json.dumps(one))


if __name__ == "__main__":
    main()
