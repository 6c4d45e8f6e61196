"""Sticks: frames known by their floors alone."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from pounding.frames.chain import chain
from pounding.frames.definition import ModeTable, StickFrame
from pounding.frames.errors import FrameError
from pounding.frames.reduction.craig_bampton import dense_modes, modal_damping
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.torsion import ratios_of, twisting

Real = NDArray[np.float64]

MATCHED = 1e-6
"""A stated frequency counts as met within this fraction."""

ORTHOGONAL = 0.1
"""Largest product in mass of two shapes of unit modal mass: the usual criterion for measured modes (NASA-STD-5002)."""

STEPS = 60
"""Most steps of the search for storey stiffnesses."""


def build(frame: StickFrame, damping: float | None = None, *, planar: bool | None = None) -> ReducedFrame:
    """Return a stick as a reduced frame: the floors' displacements along x, and their rotations where they turn.

    Args:
        frame: The stick.
        damping: Damping ratio of all modes instead of the stick's own, a fraction.
        planar: True: only the floors' displacements. False: their rotations too. None: rotations where the stick has an
            eccentricity.

    Raises:
        FrameError: No chain of storeys with these masses has the stated frequencies, or ``planar`` is not what its
            torsion allows.
    """
    mass, stiffness = mass_matrix(frame), stiffness_matrix(frame)
    frequencies, shapes = dense_modes(stiffness, mass)
    ratios = _ratios(frame, frequencies) if damping is None else np.full(frame.storeys, damping)
    turns = _turns(frame, planar)
    if turns:
        assert frame.torsion is not None
        sways = shapes
        mass, stiffness = twisting(frame, frame.torsion, mass, stiffness)
        frequencies, shapes = dense_modes(stiffness, mass)
        half = slice(frame.storeys, None)
        _, alone = dense_modes(stiffness[half, half], mass[half, half])
        ratios = ratios_of(shapes, sways, alone, mass, ratios)
    still = np.zeros(len(mass) - frame.storeys)
    return ReducedFrame(
        name=frame.name,
        storeys=frame.storeys,
        heights_m=np.array(frame.floor_heights_m),
        plan_m=frame.plan_m,
        definition=frame,
        options={"damping_ratio": float(ratios[0])} | _from_elsewhere(frame),
        mass=mass,
        stiffness=stiffness,
        damping=modal_damping(mass, shapes, frequencies, ratios),
        influence=np.concatenate([np.ones(frame.storeys), still]),
        floor_x=np.arange(frame.storeys),
        floor_rz=frame.storeys + np.arange(len(still)),
        frequencies_hz=frequencies,
        shapes=shapes,
        damping_ratios=ratios,
        moving_mass_kg=frame.moving_mass_kg,
        basis=np.eye(len(mass)),
    )


def _turns(frame: StickFrame, planar: bool | None) -> bool:
    """Return whether the rotations are kept, or raise `FrameError` for what the stick's torsion does not allow."""
    if frame.torsion is None:
        if planar is False:
            raise FrameError(
                f"frame {frame.name} is a stick whose floors do not turn, as a contact off the middle asks for; state a "
                "table torsion in its file, or leave y_m out"
            )
        return False
    if planar and not frame.torsion.is_symmetric:
        raise FrameError(f"frame {frame.name}: it has an eccentricity, planar=True cannot be")
    return planar is False or not frame.torsion.is_symmetric


def _ratios(frame: StickFrame, frequencies_hz: Real) -> Real:
    """Return the damping ratio of each mode (storeys,); `FrameError` where a Caughey series lets a mode grow."""
    ratios = np.array(frame.damping_ratios)
    given = frame.modes.damping_ratio if frame.modes is not None else frame.damping_ratio
    count = len(given) if isinstance(given, list) else 1
    if frame.damping_beyond == "last" or count == len(ratios):
        return ratios
    series = caughey(frequencies_hz, ratios[:count])
    if series.min() < 0.0:
        mode = int(np.flatnonzero(series < 0.0)[0])
        raise FrameError(
            f"frame {frame.name}: the Caughey series through {count} damping ratios gives mode {mode + 1} the ratio "
            f"{series[mode]:.3g}, below 0, so that it would grow by itself; state another number of ratios, or leave "
            "damping_beyond out"
        )
    return series


def caughey(frequencies_hz: Real, ratios: Real) -> Real:
    """Return the damping ratio of each mode (n,) by the Caughey series with as many terms as ratios are stated.

    The ratios are z_i = 1/2 sum_b a_b w_i^(2b - 1), b = 0, 1 and so on (Clough and Penzien, Dynamics of Structures, section
    12.5): one term is damping in proportion to the mass, two are Rayleigh's.

    Args:
        frequencies_hz: Frequency of each mode (n,) [Hz], rising.
        ratios: Damping ratio of the lowest modes (p,), as fractions.
    """
    # In units of the first frequency, for powers of rad/s would leave no digits.
    relative = frequencies_hz / frequencies_hz[0]
    terms = relative[:, None] ** (2.0 * np.arange(len(ratios)) - 1.0)
    return np.asarray(terms @ np.linalg.solve(terms[: len(ratios)], ratios))


def _from_elsewhere(frame: StickFrame) -> dict[str, Any]:
    """Return modes, matrices and torsion for the provenance, so that a result can be made again without their files."""
    stated = {"modes": frame.modes, "matrices": frame.matrices, "torsion": frame.torsion}
    return {key: msgspec.to_builtins(value) for key, value in stated.items() if value is not None}


def mass_matrix(frame: StickFrame) -> Real:
    """Return the mass matrix (storeys, storeys) [kg] of a stick."""
    if frame.matrices is not None:
        return np.asarray(frame.matrices.mass_kg, float)
    return np.diag(np.asarray(frame.floor_mass_kg, float))


def notes(frame: StickFrame) -> list[str]:
    """Return sentences on what modes or matrices leave open: where the remainder lies, what the condensation left out."""
    found = []
    if frame.modes is not None and len(frame.modes.frequency_hz) < frame.storeys:
        source = "by the file" if frame.modes.remainder_hz else "the next mode of a uniform shear building"
        found.append(
            f"modes {len(frame.modes.frequency_hz) + 1} to {frame.storeys} are not in the table; they are put at "
            f"{remainder_hz(frame.modes):.4g} Hz ({source})"
        )
    if frame.matrices is not None and frame.matrices.left_out is not None:
        out = frame.matrices.left_out
        found.append(
            f"condensed to {frame.storeys} floors: {out.rows} rows are left out, with {out.diagonal_mass:.4g} on "
            f"the diagonal of the mass matrix, of which {out.added_to_floors_kg:.4g} kg along x went to the floors"
        )
    if frame.torsion is not None and not frame.torsion.is_symmetric:
        found.append(
            "the floors turn: the stated stiffnesses or frequencies are those of the sway without eccentricity, whose first "
            f"frequency is {dense_modes(stiffness_matrix(frame), mass_matrix(frame))[0][0]:.4g} Hz"
        )
    return found


def remainder_hz(modes: ModeTable) -> float:
    """Return the frequency of what the modes do not cover [Hz].

    Unless stated it is (2 m + 1) / (2 m - 1) times the last of m frequencies: there a uniform shear building has the
    first mode that is missing. Motions above it are then softer than in truth, never stiffer.
    """
    last = len(modes.frequency_hz)
    return modes.remainder_hz or modes.frequency_hz[-1] * (2 * last + 1) / (2 * last - 1)


def of_modes(name: str, modes: ModeTable, mass: Real) -> Real:
    """Return the stiffness (n, n) [N/m] that has stated modes, and one frequency for all other motions.

    The shapes are replaced by the nearest ones that are orthogonal in mass (the polar factor, as Loewdin's).

    Args:
        name: Name of the frame, for the message.
        modes: The modes.
        mass: Mass (n, n) [kg].

    Raises:
        FrameError: Two shapes are further from orthogonal than `ORTHOGONAL`.
    """
    shapes = np.asarray(modes.shapes, float).T
    shapes = shapes / np.sqrt(np.einsum("im,ij,jm->m", shapes, mass, shapes))
    gram = shapes.T @ mass @ shapes
    apart = np.abs(gram - np.eye(len(gram)))
    one, other = np.unravel_index(apart.argmax(), apart.shape)
    if apart.max() > ORTHOGONAL:
        raise FrameError(
            f"frame {name}: the shapes of modes {min(one, other) + 1} and {max(one, other) + 1}"
            f"{f' in {modes.file}' if modes.file else ''} are {apart.max():.3g} from orthogonal in mass (0: orthogonal, "
            f"1: the same; allowed {ORTHOGONAL:g}); correct floor_mass_kg or the order of the floors, or leave one mode out"
        )
    values, vectors = np.linalg.eigh(gram)
    shapes = shapes @ (vectors / np.sqrt(values)) @ vectors.T
    rows = mass @ shapes
    squares = (2.0 * np.pi * np.asarray(modes.frequency_hz)) ** 2
    rest = (2.0 * np.pi * remainder_hz(modes)) ** 2
    stiffness = (rows * squares) @ rows.T + rest * (mass - rows @ rows.T)
    return np.asarray((stiffness + stiffness.T) / 2.0)


def stiffness_matrix(frame: StickFrame) -> Real:
    """Return the stiffness matrix (storeys, storeys) [N/m] of a stick; raises as `storey_stiffnesses` and `of_modes`."""
    if frame.matrices is not None:
        return np.asarray(frame.matrices.stiffness_n_per_m, float)
    if frame.modes is not None:
        return of_modes(frame.name, frame.modes, mass_matrix(frame))
    if frame.stiffness_ratio is None:
        return chain(storey_stiffnesses(frame))
    unit = bending_shear(np.asarray(frame.floor_heights_m), frame.stiffness_ratio)
    first = dense_modes(unit, np.diag(np.asarray(frame.floor_mass_kg, float)))[0][0]
    return np.asarray(unit * (frame.frequency_hz[0] / first) ** 2)


def bending_shear(heights_m: Real, ratio: float) -> Real:
    """Return the stiffness (n, n) of a bending and a shear cantilever that the floors couple, of EI/H^3 = 1.

    The bending cantilever's floors have the flexibility a^2 (3 b - a) / (6 EI), a the lower and b the upper of the two
    heights. A storey of height h of the shear cantilever has the stiffness GA/h with GA = alpha^2 EI / H^2. In the limit
    of many floors this is the beam of Miranda and Taghavi (2005), J. Struct. Eng. 131(2).

    Args:
        heights_m: Height of each floor above the base (n,) [m].
        ratio: Lateral stiffness ratio alpha = H sqrt(GA / EI) [-].
    """
    height = heights_m / heights_m[-1]
    low, high = np.minimum.outer(height, height), np.maximum.outer(height, height)
    bending = np.linalg.inv(low**2 * (3.0 * high - low) / 6.0)
    shear = chain(ratio**2 / np.diff(height, prepend=0.0))
    return np.asarray((bending + bending.T) / 2.0 + shear)


def storey_stiffnesses(frame: StickFrame) -> Real:
    """Return the stiffness of each storey (storeys,) [N/m].

    Stated stiffnesses are returned as they are. From frequencies the storeys follow as the ones nearest to
    equal ones (in the logarithm of the stiffness) that have these frequencies: one frequency alone scales
    equal storeys.

    Raises:
        FrameError: No chain of storeys with these masses has these frequencies.
    """
    if frame.storey_stiffness_n_per_m:
        return np.asarray(frame.storey_stiffness_n_per_m, float)
    mass = np.diag(np.asarray(frame.floor_mass_kg, float))
    wanted = np.asarray(frame.frequency_hz, float)
    equal = np.ones(frame.storeys)
    scale = (wanted[0] / dense_modes(chain(equal), mass)[0][0]) ** 2
    logarithm = np.log(scale * equal)
    start = logarithm.copy()
    for _ in range(STEPS):
        frequencies, shapes = dense_modes(chain(np.exp(logarithm)), mass)
        miss = np.log(wanted / frequencies[: len(wanted)])
        if np.abs(miss).max() < MATCHED:
            return np.asarray(np.exp(logarithm))
        slope = _sensitivity(np.exp(logarithm), frequencies, shapes)[: len(wanted)]
        # The least distance from equal storeys that meets the linearised frequencies.
        target = np.linalg.lstsq(slope, miss + slope @ (logarithm - start), rcond=None)[0]
        step = start + target - logarithm
        logarithm = logarithm + step * min(1.0, 0.5 / max(np.abs(step).max(), 1e-12))
    raise FrameError(
        f"frame {frame.name}: no storeys with these floor masses have the frequencies "
        f"{', '.join(f'{f:g}' for f in wanted)} Hz; the nearest found are "
        f"{', '.join(f'{f:.4g}' for f in frequencies[: len(wanted)])} Hz; state fewer frequencies"
    )


def _sensitivity(storeys: Real, frequencies: Real, shapes: Real) -> Real:
    """Return d ln(frequency) / d ln(storey stiffness) (modes, storeys)."""
    drift = np.diff(shapes, axis=0, prepend=0.0)
    return 0.5 * (storeys[:, None] * drift**2).T / (2.0 * np.pi * frequencies[:, None]) ** 2
