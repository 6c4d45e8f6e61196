"""`build`: from a frame's definition to its reduced form."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

import numpy as np

from pounding.frames import cache, checks, stick
from pounding.frames.definition import Frame, PlateFrame, StickFrame
from pounding.frames.errors import FrameError
from pounding.frames.fe.assembly import Model, Options, assemble
from pounding.frames.fe.mesh import DEFAULT, Density
from pounding.frames.fe.symmetry import is_symmetric, planar_basis
from pounding.frames.reduction.craig_bampton import craig_bampton, dense_modes, modal_damping
from pounding.frames.reduction.reduced_frame import ReducedFrame

KEEP_HZ = 300.0
"""Fixed-interface modes are kept up to this frequency unless asked otherwise [Hz]."""


def build(
    frame: Frame,
    *,
    joints: Literal["calibrated", "rigid"] = "calibrated",
    p_delta: bool = True,
    damping: float | None = None,
    calibration: str | None = None,
    keep_hz: float | None = None,
    modes: int | None = None,
    planar: bool | None = None,
    density: Density | None = None,
    rigid_floors: bool = True,
    use_cache: bool = True,
) -> ReducedFrame:
    """Return the reduced form of a frame: the baseline model, unless options say otherwise.

    Args:
        frame: A plate frame or a stick; a stick keeps its storeys as they are and takes ``damping`` and ``planar`` alone.
        joints: "calibrated" or "rigid".
        p_delta: Whether gravity's geometric stiffness counts.
        damping: Damping ratio of all modes, a fraction; the frame's own when None.
        calibration: Name of the joints' calibration; the frame's default when None.
        keep_hz: Keep the fixed-interface modes up to this frequency [Hz]; `KEEP_HZ` when None.
        modes: Or keep so many.
        planar: True: only the motions that a shaking along x can excite, on the floors' displacements along
            x. False: all motions, and the floors' displacement along y and rotation about z are kept too.
            None: True for a frame with a doubly symmetric plan. A stick keeps the rotation, and needs its torsion for it.
        density: How fine the mesh is.
        rigid_floors: Whether floors are rigid in their plane.
        use_cache: Whether a result on disk may be used and written.

    Raises:
        FrameError: A value that cannot be, an unstable frame, or ``planar=True`` for one that is not
            symmetric.
    """
    if damping is not None:
        checks.damping(frame.name, [damping])
    if isinstance(frame, StickFrame):
        with _solvable(frame):
            return stick.build(frame, damping, planar=planar)
    if keep_hz is not None and modes is not None:
        raise FrameError("reduction: give either keep_hz or modes")
    symmetric = is_symmetric(frame)
    if planar and not symmetric:
        raise FrameError(f"frame {frame.name}: its plan is not symmetric, planar=True cannot be")
    options = Options(joints, p_delta, calibration, rigid_floors, density or DEFAULT)
    settings = dataclasses.asdict(options) | {
        "planar": symmetric if planar is None else planar,
        "keep_hz": (KEEP_HZ if keep_hz is None else keep_hz) if modes is None else None,
        "modes": modes,
    }
    settings["calibration"] = (calibration or frame.joints.default) if joints == "calibrated" else None
    arrays = cache.load(frame, settings) if use_cache else None
    if arrays is None:
        with _solvable(frame):
            arrays = _reduce(assemble(frame, options), settings)
        if use_cache:
            cache.save(frame, settings, arrays)
    return _reduced(frame, settings, arrays, frame.damping_ratio if damping is None else damping)


@contextmanager
def _solvable(frame: Frame) -> Iterator[None]:
    """Turn the solvers' errors, of matrices that cannot be solved in double precision, into a sentence."""
    try:
        with np.errstate(all="ignore"):
            yield
    except (np.linalg.LinAlgError, ArithmeticError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise FrameError(
            f"frame {frame.name}: its modes cannot be computed ({reason}); its masses or stiffnesses lie too far apart"
        ) from error


def _reduce(model: Model, settings: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return what is worth keeping on disk: the reduced matrices and the way back."""
    storeys, coordinates = model.frame.storeys, model.coordinates
    carried = coordinates.translation()
    stiffness, mass = model.stiffness, model.mass
    if settings["planar"]:
        quarter = planar_basis(model.mesh, coordinates)
        stiffness, mass = quarter.T @ stiffness @ quarter, quarter.T @ mass @ quarter
        carried = quarter.T @ carried / (quarter.T @ quarter).diagonal()
        kept = quarter[coordinates.floor[:, 0]].indices.astype(np.int64)
    else:
        kept = coordinates.floor.T.ravel()
    small = craig_bampton(
        stiffness.tocsr(), mass.tocsr(), kept, carried, keep_hz=settings["keep_hz"], modes=settings["modes"]
    )
    # Not the floors' ones, which would leave the modes' participation 0.2 % off: the table's load is what counts.
    influence = np.linalg.solve(small.mass, small.basis.T @ (mass @ carried))
    return {
        "mass": small.mass,
        "stiffness": small.stiffness,
        "basis": small.basis,
        "influence": influence,
        "frequencies_shapes": np.vstack(dense_modes(small.stiffness, small.mass)),
        "kept": np.array([len(kept) // storeys]),
    }


def _reduced(
    frame: PlateFrame, settings: dict[str, Any], arrays: dict[str, np.ndarray], ratio: float
) -> ReducedFrame:
    storeys, mass = frame.storeys, arrays["mass"]
    frequencies, shapes = arrays["frequencies_shapes"][0], arrays["frequencies_shapes"][1:]
    ratios = np.full(len(frequencies), ratio)
    groups = int(arrays["kept"][0])
    return ReducedFrame(
        name=frame.name,
        storeys=storeys,
        heights_m=np.array(frame.floor_heights_m),
        plan_m=(frame.plate.length_m, frame.plate.width_m),
        definition=frame,
        options=settings | {"damping_ratio": ratio},
        mass=mass,
        stiffness=arrays["stiffness"],
        damping=modal_damping(mass, shapes, frequencies, ratios),
        influence=arrays["influence"],
        floor_x=np.arange(storeys),
        floor_rz=np.arange(2 * storeys, 3 * storeys) if groups == 3 else np.arange(0),
        frequencies_hz=frequencies,
        shapes=shapes,
        damping_ratios=ratios,
        moving_mass_kg=frame.moving_mass_kg,
        basis=arrays["basis"],
    )
