"""What cannot be a frame: each check is one sentence that says what is wrong and where."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite
from typing import TYPE_CHECKING

from pounding import bounds
from pounding.bounds import Bound
from pounding.frames import floor_matrices, storey_laws
from pounding.frames.errors import FrameError
from pounding.scale import scale_of
from pounding.toml_text import shown

if TYPE_CHECKING:
    from pounding.frames.definition import Joints, Matrices, ModeTable, PlateFrame, Slab, StickFrame, Torsion

EDGE = 1e-9
"""Round-off allowed when a column stands on the edge of the floor [m]."""


def plate_frame(frame: PlateFrame) -> None:
    """Raise FrameError for a plate frame that cannot be built."""
    name = _name(frame.name)
    _storeys(name, frame.storeys)
    _plate_values(name, frame)
    _poisson(name, "material", frame.material.poissons_ratio)
    _joints(name, frame.joints)
    damping(name, [frame.damping_ratio])
    _scale(name, frame.scale)
    _masses(name, frame)
    _storey_factors(name, frame)
    _mass_eccentricity(name, frame)
    _places(name, frame)
    _yielding(name, frame)
    storey_laws.check(name, frame.storey_law, frame.storeys)


def _plate_values(name: str, frame: PlateFrame) -> None:
    material, columns = frame.material, frame.columns
    bounded = {
        "storey_height_m": (bounds.LENGTH, frame.storey_height_m),
        "plate.length_m": (bounds.LENGTH, frame.plate.length_m),
        "plate.width_m": (bounds.LENGTH, frame.plate.width_m),
        "plate.thickness_m": (bounds.THICKNESS, frame.plate.thickness_m),
        "columns.width_m": (bounds.THICKNESS, columns.width_m),
        "columns.thickness_m": (bounds.THICKNESS, columns.thickness_m),
        "columns.inset_x_m": (bounds.OFFSET, columns.inset_x_m),
        "columns.inset_y_m": (bounds.OFFSET, columns.inset_y_m),
        "material.youngs_modulus_gpa": (bounds.MODULUS, material.youngs_modulus_gpa),
        "material.density_kg_per_m3": (bounds.DENSITY, material.density_kg_per_m3),
        "material.yield_stress_mpa": (bounds.STRESS, material.yield_stress_mpa),
        "nonstructural_mass_kg": (bounds.ADDED_MASS, frame.nonstructural_mass_kg),
        "stiffness_factor": (bounds.FACTOR, frame.stiffness_factor),
        "joint_factor": (bounds.FACTOR, frame.joint_factor),
        "weight_factor": (bounds.WEIGHT_FACTOR, frame.weight_factor),
        "mass_eccentricity_m": (bounds.OFFSET, frame.mass_eccentricity_m),
    }
    bounded |= {
        f"joints.stiffness_n_m_per_rad.{key}": (bounds.ROTATIONAL_STIFFNESS, value)
        for key, value in frame.joints.stiffness_n_m_per_rad.items()
    }
    if frame.base_rotational_stiffness_n_m_per_rad is not None:
        base = frame.base_rotational_stiffness_n_m_per_rad
        bounded["base_rotational_stiffness_n_m_per_rad"] = (bounds.ROTATIONAL_STIFFNESS, base)
    for key, (bound, value) in bounded.items():
        _within(name, key, value, bound)


def _joints(name: str, joints: Joints) -> None:
    if joints.default not in joints.stiffness_n_m_per_rad:
        raise FrameError(
            f"{name}: joints.default is {joints.default!r}, not one of "
            f"{', '.join(joints.stiffness_n_m_per_rad) or 'none'} in joints.stiffness_n_m_per_rad"
        )


def _storey_factors(name: str, frame: PlateFrame) -> None:
    _per_storey(name, "storey_stiffness_factor", frame.storey_stiffness_factor, frame.storeys)
    for storey, factor in enumerate(frame.storey_stiffness_factor, 1):
        _within(name, f"storey_stiffness_factor of storey {storey}", factor, bounds.FACTOR)


def _mass_eccentricity(name: str, frame: PlateFrame) -> None:
    if abs(frame.mass_eccentricity_m) >= frame.plate.width_m / 6.0:
        # Beyond the kernel of the plate the mass density would turn negative at the far edge.
        raise FrameError(
            f"{name}: mass_eccentricity_m is {frame.mass_eccentricity_m}, must be below a sixth "
            f"of the floor's width ({frame.plate.width_m / 6.0:.4g} m)"
        )


def stick_frame(frame: StickFrame) -> None:
    """Raise FrameError for a stick that cannot be built."""
    name = _name(frame.name)
    _storeys(name, frame.storeys)
    heights = frame.storey_height_m
    if isinstance(heights, list):
        _per_storey(name, "storey_height_m", heights, frame.storeys, required=True)
    for height in heights if isinstance(heights, list) else [heights]:
        _within(name, "storey_height_m", height, bounds.LENGTH)
    _one_source(name, frame)
    _per_storey(name, "floor_mass_kg", frame.floor_mass_kg, frame.storeys, required=frame.matrices is None)
    for floor, mass in enumerate(frame.floor_mass_kg, 1):
        _within(name, f"floor_mass_kg of floor {floor}", mass, bounds.MASS)
    _per_storey(name, "storey_stiffness_n_per_m", frame.storey_stiffness_n_per_m, frame.storeys)
    for storey, stiffness in enumerate(frame.storey_stiffness_n_per_m, 1):
        _within(name, f"storey_stiffness_n_per_m of storey {storey}", stiffness, bounds.STIFFNESS)
    _frequencies(name, frame.frequency_hz, frame.storeys)
    _bending_shear(name, frame)
    if frame.modes is not None:
        _modes(name, frame, frame.modes)
    if frame.matrices is not None:
        _matrices(name, frame.matrices, frame.storeys)
    ratios = frame.damping_ratios if not isinstance(frame.damping_ratio, list) else frame.damping_ratio
    if not 1 <= len(ratios) <= frame.storeys:
        raise FrameError(f"{name}: damping_ratio has {len(ratios)} values, needs 1 to {frame.storeys}")
    damping(name, ratios)
    for key, side in zip(("length", "width"), frame.plan_m, strict=True):
        _within(name, f"plan_m ({key})", side, bounds.LENGTH)
    if frame.yielding is not None and frame.yielding.storey_shear_n is None:
        raise FrameError(
            f"{name}: yielding.storey_shear_n is missing; a stick has no columns to take it from"
        )
    _yielding(name, frame)
    storey_laws.check(name, frame.storey_law, frame.storeys)
    _scale(name, frame.scale)
    if frame.slab is not None:
        _slab(name, frame.slab)
    if frame.torsion is not None:
        _torsion(name, frame, frame.torsion)


def _torsion(name: str, frame: StickFrame, torsion: Torsion) -> None:
    if (torsion.frequency_ratio is None) == (not torsion.stiffness_n_m_per_rad):
        stated = "none is" if torsion.frequency_ratio is None else "both are"
        raise FrameError(
            f"{name}: torsion needs either frequency_ratio or stiffness_n_m_per_rad, one of them ({stated} stated)"
        )
    if torsion.frequency_ratio is not None:
        _within(name, "torsion.frequency_ratio", torsion.frequency_ratio, bounds.FREQUENCY_RATIO)
    for key, bound in (
        ("stiffness_n_m_per_rad", bounds.ROTATIONAL_STIFFNESS),
        ("floor_inertia_kg_m2", bounds.INERTIA),
    ):
        values = getattr(torsion, key)
        _per_storey(name, f"torsion.{key}", values, frame.storeys)
        for number, value in enumerate(values, 1):
            _within(name, f"torsion.{key}, value {number}", value, bound)
    _eccentricity(name, frame, torsion.eccentricity_m)
    if frame.yielding is not None:
        raise FrameError(
            f"{name}: torsion and yielding exclude each other: when a storey yields that turns depends on the place of each "
            "of its columns, which a stick does not know; leave one out"
        )


def _eccentricity(name: str, frame: StickFrame, stated: float | list[float]) -> None:
    values = stated if isinstance(stated, list) else [stated]
    if isinstance(stated, list):
        _per_storey(name, "torsion.eccentricity_m", stated, frame.storeys, required=True)
        if frame.stiffness_ratio is not None or frame.modes is not None or frame.matrices is not None:
            raise FrameError(
                f"{name}: torsion.eccentricity_m is a list, one for each storey, and only a chain has storeys of its own; "
                "state one number"
            )
    half = frame.plan_m[1] / 2.0
    for value in values:
        if not abs(value) <= half:  # true for NaN
            raise FrameError(
                f"{name}: torsion.eccentricity_m is {value:g} m, off the floor, whose width (the second of plan_m) is "
                f"{frame.plan_m[1]:g} m; correct either"
            )


def _one_source(name: str, frame: StickFrame) -> None:
    sources = {
        "storey_stiffness_n_per_m": bool(frame.storey_stiffness_n_per_m),
        "frequency_hz": bool(frame.frequency_hz),
        "modes": frame.modes is not None,
        "matrices": frame.matrices is not None,
    }
    stated = [key for key, given in sources.items() if given]
    if len(stated) != 1:
        raise FrameError(
            f"{name}: give either storey_stiffness_n_per_m or frequency_hz, or a table modes or matrices, one of them "
            f"({' and '.join(stated) or 'none'} {'are' if len(stated) > 1 else 'is'} stated)"
        )
    if frame.modes is not None and not frame.floor_mass_kg:
        raise FrameError(
            f"{name}: modes without masses are no frame; add floor_mass_kg, the mass of each floor [kg]"
        )
    if frame.matrices is not None and frame.floor_mass_kg:
        raise FrameError(f"{name}: matrices hold the mass already; leave floor_mass_kg out")
    if frame.modes is not None and frame.damping_ratio is not None:
        raise FrameError(f"{name}: the modes have their own damping; leave damping_ratio out")
    if frame.modes is None and frame.damping_ratio is None:
        raise FrameError(f"{name}: damping_ratio is missing; state a fraction (0.5 % is 0.005)")
    if (frame.modes or frame.matrices) and (frame.yielding or frame.stiffness_ratio is not None):
        what = "yielding" if frame.yielding else "stiffness_ratio"
        raise FrameError(f"{name}: {what} and {stated[0]} exclude each other; leave one out")


def _modes(name: str, frame: StickFrame, modes: ModeTable) -> None:
    place = f"{name}: modes{f' of {modes.file}' if modes.file else ''}"
    count = len(modes.frequency_hz)
    if not count:
        raise FrameError(f"{name}: modes.file is missing; name the CSV with the modes")
    if len(modes.damping_ratio) != count or len(modes.shapes) != count:
        raise FrameError(
            f"{place}: {count} frequencies, {len(modes.damping_ratio)} damping ratios and {len(modes.shapes)} shapes; "
            "state one of each for a mode"
        )
    _frequencies(place, modes.frequency_hz, frame.storeys)
    damping(place, modes.damping_ratio)
    for number, shape in enumerate(modes.shapes, 1):
        _per_storey(place, f"shape {number}", shape, frame.storeys, required=True)
        if not all(map(isfinite, shape)) or not any(shape):
            raise FrameError(f"{place}: shape {number} is zero or not finite; leave the mode out")
    if modes.remainder_hz is not None:
        _within(name, "modes.remainder_hz", modes.remainder_hz, bounds.FREQUENCY)
        if modes.remainder_hz <= modes.frequency_hz[-1]:
            raise FrameError(
                f"{name}: modes.remainder_hz is {modes.remainder_hz:g}; it must be above the last mode's "
                f"{modes.frequency_hz[-1]:g} Hz"
            )


def _matrices(name: str, matrices: Matrices, storeys: int) -> None:
    if matrices.floor_rows and len(matrices.floor_rows) != storeys:
        raise FrameError(
            f"{name}: matrices.floor_rows has {len(matrices.floor_rows)} values, needs one for each of {storeys} storeys"
        )
    for key, rows in {"mass_kg": matrices.mass_kg, "stiffness_n_per_m": matrices.stiffness_n_per_m}.items():
        if not rows:
            raise FrameError(
                f"{name}: matrices.mass_file and matrices.stiffness_file are missing; name both files"
            )
        floor_matrices.check(f"{name}: matrices.{key}", rows, storeys)
    for floor in range(storeys):
        _within(name, f"matrices, mass of floor {floor + 1}", matrices.mass_kg[floor][floor], bounds.MASS)
        stiffness = matrices.stiffness_n_per_m[floor][floor]
        _within(name, f"matrices, stiffness of floor {floor + 1}", stiffness, bounds.STIFFNESS)


def _bending_shear(name: str, frame: StickFrame) -> None:
    if frame.stiffness_ratio is None:
        return
    _within(name, "stiffness_ratio", frame.stiffness_ratio, bounds.STIFFNESS_RATIO)
    if len(frame.frequency_hz) != 1:
        raise FrameError(f"{name}: stiffness_ratio needs frequency_hz with the first frequency alone")
    if frame.yielding is not None:
        raise FrameError(
            f"{name}: stiffness_ratio and yielding exclude each other; only a chain's storeys yield"
        )


def _yielding(name: str, frame: PlateFrame | StickFrame) -> None:
    if frame.yielding is None:
        return
    shears, ratio = frame.yielding.storey_shear_n, frame.yielding.hardening_ratio
    if isinstance(shears, list):
        _per_storey(name, "yielding.storey_shear_n", shears, frame.storeys, required=True)
    for shear in shears if isinstance(shears, list) else [shears]:
        if shear is not None:
            _within(name, "yielding.storey_shear_n", shear, bounds.STOREY_SHEAR)
    if not 0.0 <= ratio < 1.0:
        raise FrameError(f"{name}: yielding.hardening_ratio is {ratio}, a fraction from 0 to below 1")
    if frame.yielding.sharpness is not None:
        _within(name, "yielding.sharpness", frame.yielding.sharpness, bounds.KNEE)


def _scale(name: str, stated: str | float | None) -> None:
    if stated is not None:
        scale_of(stated, f"{name}: scale", FrameError)


def _slab(name: str, slab: Slab) -> None:
    _within(name, "slab.thickness_m", slab.thickness_m, bounds.THICKNESS)
    _within(name, "slab.youngs_modulus_gpa", slab.youngs_modulus_gpa, bounds.MODULUS)
    _within(name, "slab.density_kg_per_m3", slab.density_kg_per_m3, bounds.DENSITY)
    _poisson(name, "slab", slab.poissons_ratio)


def _poisson(name: str, of: str, ratio: float) -> None:
    if not 0.0 <= ratio < 0.5:
        raise FrameError(f"{name}: {of}.poissons_ratio is {ratio}, must be 0 to 0.5")


def _name(name: str) -> str:
    if not name.strip():
        raise FrameError("frame: name is empty; give it one")
    if not name.isprintable():
        raise FrameError(f"frame: name {shown(name)} holds a character that cannot be printed; leave it out")
    return f"frame {name}"


def _storeys(name: str, storeys: int) -> None:
    _within(name, "storeys", storeys, bounds.STOREYS)


def _within(name: str, key: str, value: float, bound: Bound) -> None:
    bound.check(value, f"{name}: {key}", FrameError)


def _per_storey(
    name: str, key: str, values: Sequence[float], storeys: int, *, required: bool = False
) -> None:
    if (values or required) and len(values) != storeys:
        raise FrameError(f"{name}: {key} has {len(values)} values, needs one for each of {storeys} storeys")


def damping(name: str, ratios: Sequence[float]) -> None:
    """Raise FrameError for damping ratios, (modes,), that are no fractions of the critical damping.

    Args:
        name: What has them, the subject of the sentence.
        ratios: The ratios [-].
    """
    for ratio in ratios:
        if not 0.0 <= ratio < 1.0:
            raise FrameError(
                f"{name}: damping_ratio is {ratio}; give a fraction from 0 to below 1 (0.5 % is 0.005)"
            )


def _frequencies(name: str, frequencies: Sequence[float], storeys: int) -> None:
    if len(frequencies) > storeys:
        raise FrameError(f"{name}: frequency_hz has {len(frequencies)} values for {storeys} storeys")
    for frequency in frequencies:
        _within(name, "frequency_hz", frequency, bounds.FREQUENCY)
    if any(b <= a for a, b in pairwise(frequencies)):
        raise FrameError(f"{name}: frequency_hz must rise, lowest first")


def _masses(name: str, frame: PlateFrame) -> None:
    _per_storey(name, "added_mass_kg", frame.added_mass_kg, frame.storeys)
    for floor, mass in enumerate(frame.added_mass_kg, 1):
        _within(name, f"added_mass_kg of floor {floor}", mass, bounds.ADDED_MASS)
        if mass < 0.0:
            raise FrameError(f"{name}: added_mass_kg of floor {floor} is {mass}, must not be negative")
    left = frame.floor_plate_mass_kg + frame.nonstructural_mass_kg / frame.storeys
    if not left > 0.0:
        raise FrameError(
            f"{name}: nonstructural_mass_kg is {frame.nonstructural_mass_kg}, which leaves {left:.3g} kg a "
            "floor; it must stay positive"
        )


def _places(name: str, frame: PlateFrame) -> None:
    places, half = frame.places_m, frame.columns.width_m / 2.0
    edge_x, edge_y = frame.plate.length_m / 2.0 + EDGE, frame.plate.width_m / 2.0 + EDGE
    if len(places) < 2:
        raise FrameError(f"{name}: columns.places_m holds {len(places)} column, needs two or more")
    for number, (x, y) in enumerate(places, 1):
        if not (abs(x) <= edge_x and abs(y) + half <= edge_y):
            raise FrameError(
                f"{name}: column {number} at x = {x:g} m, y = {y:g} m does not stand on the floor of "
                f"{frame.plate.length_m:g} m x {frame.plate.width_m:g} m; move it inwards"
            )
        for other, (x2, y2) in enumerate(places[: number - 1], 1):
            if abs(x - x2) <= EDGE and abs(y - y2) < frame.columns.width_m - EDGE:
                raise FrameError(f"{name}: columns {other} and {number} stand in each other; move one")
