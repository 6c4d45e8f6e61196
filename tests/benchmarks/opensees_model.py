"""The same two lumped frames in OpenSees, with its own impact materials.

Not part of the package: OpenSees' licence does not let everyone redistribute it. `pip install openseespy`
(on Debian also `apt-get install libblas3 liblapack3`) makes it available to `opensees_peer.py`.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import openseespy.opensees as ops

LEFT, RIGHT = 0, 1000
CONTACT = 9000
SAMPLES_PER_SECOND = 10_000


@dataclass(frozen=True)
class LumpedFrame:
    """A shear building [kg, N/m] with Rayleigh damping a0 M + a1 K [1/s, s]."""

    floor_mass_kg: np.ndarray
    storey_stiffness_n_per_m: np.ndarray
    mass_proportional_per_s: float
    stiffness_proportional_s: float

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return mass, stiffness and damping matrices, each (storeys, storeys)."""
        mass = np.diag(self.floor_mass_kg)
        above = np.append(self.storey_stiffness_n_per_m[1:], 0.0)
        stiffness = np.diag(self.storey_stiffness_n_per_m + above)
        stiffness -= np.diag(above[:-1], 1) + np.diag(above[:-1], -1)
        return (
            mass,
            stiffness,
            self.mass_proportional_per_s * mass + self.stiffness_proportional_s * stiffness,
        )


def lumped(
    masses: np.ndarray, first_frequency_hz: float, ratio: float, highest_anchor: int = 3
) -> LumpedFrame:
    """Return a uniform-stiffness shear building of a given first frequency, damped alike at modes 1 and 3."""
    unit = LumpedFrame(masses, np.ones(len(masses)), 0.0, 0.0)
    mass, stiffness, _ = unit.matrices()
    omega = np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)
    omega.sort()
    storey = (2 * np.pi * first_frequency_hz / omega[0]) ** 2
    first, third = omega[0] * storey**0.5, omega[highest_anchor - 1] * storey**0.5
    return LumpedFrame(
        masses,
        np.full(len(masses), storey),
        2 * ratio * first * third / (first + third),
        2 * ratio / (first + third),
    )


def material(law: str, numbers: dict[str, float], gap_m: float) -> tuple:
    """Return OpenSees' own material for a law; `numbers` in SI units as the law's parameters name them."""
    k = numbers["stiffness"]
    if law == "linear_spring":
        return ("ElasticPPGap", 1, k, -1e12, -max(gap_m, 1e-12), 0.0)
    if law == "linear_viscoelastic":
        return ("ViscoelasticGap", 1, k, numbers["damping"], -gap_m)
    if law == "hertz":
        return ("Hertzdamp", 1, k, 0.0, -gap_m, 1.5)
    if law == "nonlinear_viscoelastic":
        return ("JankowskiImpact", 1, k, numbers["damping_ratio"], numbers["effective_mass"], -gap_m, 1.5)
    if law == "hertz_damp":
        return ("Hertzdamp", 1, k, numbers["damping_factor"], -gap_m, 1.5)
    raise ValueError(f"no OpenSees material for {law}")


def add_frame(first_node: int, frame: LumpedFrame) -> None:
    ops.node(first_node, 0.0)
    ops.fix(first_node, 1)
    for storey, (mass, stiffness) in enumerate(
        zip(frame.floor_mass_kg, frame.storey_stiffness_n_per_m, strict=True), 1
    ):
        node = first_node + storey
        ops.node(node, 0.0)
        ops.mass(node, float(mass))
        ops.uniaxialMaterial("Elastic", 100 + node, float(stiffness))
        ops.element("zeroLength", node, node - 1, node, "-mat", 100 + node, "-dir", 1, "-doRayleigh", 1)
    # A region of elements damps their nodes too; a second region for the nodes would undo it.
    elements = range(first_node + 1, first_node + len(frame.floor_mass_kg) + 1)
    damping = (frame.mass_proportional_per_s, 0.0, frame.stiffness_proportional_s, 0.0)
    ops.region(first_node + 1, "-ele", *elements, "-rayleigh", *damping)


@dataclass(frozen=True)
class Run:
    """Histories at 10,000 samples a second [s, m, N] and the processor time of the analysis [s]."""

    time_s: np.ndarray
    left_m: np.ndarray
    right_m: np.ndarray
    force_n: np.ndarray
    processor_s: float


@dataclass(frozen=True)
class Peaks:
    """Peaks over a run [m, N] and the processor time of the analysis [s]."""

    peak_m: float
    peak_force_n: float
    processor_s: float


def run(left: LumpedFrame, right: LumpedFrame, **options: Any) -> Run:
    """Shake both frames as `_shaken` says and return histories, which OpenSees writes as text while it runs."""
    with tempfile.TemporaryDirectory() as folder:
        files = {name: Path(folder, f"{name}.out") for name in ("left", "right", "force")}

        def record() -> None:
            sampled = ("-time", "-dT", 1 / SAMPLES_PER_SECOND)
            for name, nodes in (("left", _nodes(LEFT, left)), ("right", _nodes(RIGHT, right))):
                ops.recorder("Node", "-file", str(files[name]), *sampled, "-node", *nodes, "-dof", 1, "disp")
            ops.recorder(
                "Element", "-file", str(files["force"]), *sampled, "-ele", CONTACT, "material", 1, "stress"
            )

        spent = _shaken(left, right, record, **options)
        moved_left, moved_right, force = (np.loadtxt(files[name]) for name in ("left", "right", "force"))
    return Run(moved_left[:, 0], moved_left[:, 1:], moved_right[:, 1:], -force[:, 1], spent)


def peaks(left: LumpedFrame, right: LumpedFrame, **options: Any) -> Peaks:
    """Shake both frames as `_shaken` says and return peaks: recorders of envelopes cost OpenSees little."""
    with tempfile.TemporaryDirectory() as folder:
        moved, pressed = Path(folder, "moved.out"), Path(folder, "pressed.out")

        def record() -> None:
            nodes = [*_nodes(LEFT, left), *_nodes(RIGHT, right)]
            ops.recorder("EnvelopeNode", "-file", str(moved), "-node", *nodes, "-dof", 1, "disp")
            ops.recorder("EnvelopeElement", "-file", str(pressed), "-ele", CONTACT, "material", 1, "stress")

        spent = _shaken(left, right, record, **options)
        # Rows of an envelope: lowest, highest, largest magnitude. The contact's stress is a compression.
        return Peaks(float(np.loadtxt(moved)[2].max()), float(-np.loadtxt(pressed)[0]), spent)


def _nodes(first: int, frame: LumpedFrame) -> range:
    return range(first + 1, first + len(frame.floor_mass_kg) + 1)


def _shaken(
    left: LumpedFrame,
    right: LumpedFrame,
    record: Callable[[], None],
    *,
    floor: int,
    gap_m: float,
    law: str,
    numbers: dict[str, float],
    acceleration_m_s2: np.ndarray,
    sample_s: float,
    step_s: float,
    duration_s: float,
    integrator: str = "CentralDifference",
) -> float:
    """Shake both frames on one table with a contact between their floors `floor`; return processor time [s]."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.logFile("/dev/null", "-noEcho")
    add_frame(LEFT, left)
    add_frame(RIGHT, right)
    ops.uniaxialMaterial(*material(law, numbers, gap_m))
    ops.element("zeroLength", CONTACT, LEFT + floor, RIGHT + floor, "-mat", 1, "-dir", 1, "-doRayleigh", 0)
    ops.timeSeries("Path", 1, "-dt", sample_s, "-values", *acceleration_m_s2.tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("ProfileSPD")
    if integrator == "Newmark":
        ops.test("NormUnbalance", 1e-6, 20)
        ops.algorithm("Newton")
        ops.integrator("Newmark", 0.5, 0.25)
    else:
        ops.algorithm("Linear")
        ops.integrator(integrator)
    ops.analysis("Transient")
    record()
    begin = time.process_time()
    failed = ops.analyze(round(duration_s / step_s), step_s)
    spent = time.process_time() - begin
    ops.wipe()  # closes the recorders' files
    if failed:
        raise RuntimeError(f"OpenSees' {integrator} did not converge for {law} at a step of {step_s} s")
    return spent
