"""Three buildings in a row in OpenSees and here: displacements and contact forces side by side.

`pip install openseespy==3.7.1.2` first (and libblas3, liblapack3); then
`python tests/benchmarks/opensees_street.py --out docs/validation/opensees-street.json`.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
import openseespy.opensees as ops
from opensees_model import add_frame, lumped, material
from opensees_peer import numbers, stick

from pounding.contact.parameters import make_law
from pounding.experiments.records import find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.rig import Rig

OFFICE = lumped(np.array([310e3, 290e3, 290e3, 250e3]), 1.1, 0.03)
FLATS = lumped(np.array([340e3, 320e3, 320e3, 320e3, 320e3, 270e3]), 0.7, 0.05)
ROW = (OFFICE, FLATS, OFFICE)
FLOOR, GAP_M, DURATION_S = 4, 0.06, 15.0
LAW = make_law("linear_viscoelastic", stiffness=3.75e9, restitution=0.65, masses=(250e3, 320e3), tension=True)
STEPS_S = (2e-4, 1e-4, 5e-5)


def theirs(step_s: float) -> tuple[list[float], list[float]]:
    """Return the largest displacement of each building [m] and the largest force of each contact [N] in OpenSees."""
    record = find("elcentro-chopra")
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.logFile("/dev/null", "-noEcho")
    for place, frame in enumerate(ROW):
        add_frame(1000 * place, frame)
    for pair in range(2):
        name, _, *values = material(LAW.name, numbers(LAW), GAP_M)
        ops.uniaxialMaterial(name, 1 + pair, *values)
        nodes = 1000 * pair + FLOOR, 1000 * (pair + 1) + FLOOR
        ops.element("zeroLength", 9000 + pair, *nodes, "-mat", 1 + pair, "-dir", 1, "-doRayleigh", 0)
    ops.timeSeries("Path", 1, "-dt", record.step_s, "-values", *record.acceleration_m_s2.tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormUnbalance", 1e-2, 30)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    with tempfile.TemporaryDirectory() as folder:
        moved = [Path(folder, f"moved{place}") for place in range(3)]
        pressed = [Path(folder, f"pressed{pair}") for pair in range(2)]
        for place, frame in enumerate(ROW):
            nodes = [1000 * place + floor for floor in range(1, len(frame.floor_mass_kg) + 1)]
            ops.recorder("EnvelopeNode", "-file", str(moved[place]), "-node", *nodes, "-dof", 1, "disp")
        for pair in range(2):
            ops.recorder(
                "EnvelopeElement", "-file", str(pressed[pair]), "-ele", 9000 + pair, "material", 1, "stress"
            )
        failed = ops.analyze(round(DURATION_S / step_s), step_s)
        ops.wipe()
        if failed:
            raise RuntimeError(f"OpenSees did not converge at a step of {step_s} s")
        return (
            [float(np.loadtxt(file)[2].max()) for file in moved],
            [float(-np.loadtxt(file)[0]) for file in pressed],
        )


def ours(solver: str) -> tuple[list[float], list[float]]:
    """Return the same by one of our solvers."""
    row = [stick(f"{place}", frame) for place, frame in enumerate(ROW)]
    contacts = [Contact(LAW, GAP_M, FLOOR, pair) for pair in range(2)]
    run = Rig(row, contacts).run(find("elcentro-chopra"), duration_s=DURATION_S, solver=solver)
    forces = [max(float(history.pulse(*one)[3].max()) for one in history.pulses) for history in run.contacts]
    return [float(np.abs(frame.displacement_m).max()) for frame in run.frames], forces


def main() -> None:
    """Write the peaks of both solvers and of OpenSees at three steps, and how far they are from the exact solver's."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    rows = {solver: ours(solver) for solver in ("exact", "exudyn")}
    rows |= {f"OpenSees, {1e3 * step:g} ms": theirs(step) for step in STEPS_S}
    reference = [np.array(one) for one in rows["exact"]]
    found = {
        name: {
            "displacement_m": moved,
            "force_n": forces,
            "displacement_error": float(np.abs(np.array(moved) / reference[0] - 1.0).max()),
            "force_error": float(np.abs(np.array(forces) / reference[1] - 1.0).max()),
        }
        for name, (moved, forces) in rows.items()
    }
    out = parser.parse_args().out
    out.write_text(json.dumps(found, indent=2) + "\n")
    for name, one in found.items():
        print(
            f"{name}: displacements {one['displacement_error']:.2%}, forces {one['force_error']:.2%} from exact"
        )


if __name__ == "__main__":
    main()
