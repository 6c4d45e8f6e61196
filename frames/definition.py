"""What a frame is, as data: the structures behind a frame file.

Every key that has a unit names it. Lengths are the frame's own, at the scale that ``scale`` states (1:30 for the
frames of the thesis). The fields of `PlateFrame` from ``stiffness_factor`` on are departures from the plain frame; make a
changed frame with ``changed(frame, added_mass_kg=[...])``.
"""

from __future__ import annotations

from itertools import accumulate
from typing import Any, Literal

import msgspec

from pounding.constants import STANDARD_GRAVITY
from pounding.frames import checks
from pounding.frames.errors import FrameError
from pounding.frames.storey_laws import StatedLaw


class Data(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all structures: immutable, and a key that is not known is an error."""


class Plate(Data, frozen=True):
    """A floor: a rectangular plate.

    Attributes:
        length_m: Side along x, the direction of shaking [m].
        width_m: Side along y [m].
        thickness_m: Thickness [m].
    """

    length_m: float
    width_m: float
    thickness_m: float


class Columns(Data, frozen=True):
    """The columns: flat strips over the full height, their wide side along y, so that their thickness bends.

    Attributes:
        width_m: Side along y [m].
        thickness_m: Side along x [m].
        inset_x_m: Distance of the columns of the default places, one at each corner, from the floor's edges
            along x [m].
        inset_y_m: The same along y [m], from a column's outer side.
        places_m: Centres (x, y) in plan [m], origin at the floor's centre; when given, instead of one column
            at each corner.
        continuous: True: a column runs on through the floors, with one joint at each, as a panel zone; False:
            it is cut at every floor and each end has a joint of its own.
    """

    width_m: float
    thickness_m: float
    inset_x_m: float = 0.0
    inset_y_m: float = 0.0
    places_m: list[tuple[float, float]] = []
    continuous: bool = True


class Material(Data, frozen=True):
    """An isotropic linear material."""

    youngs_modulus_gpa: float = 200.0
    poissons_ratio: float = 0.3
    density_kg_per_m3: float = 7850.0
    yield_stress_mpa: float = 280.0


class Joints(Data, frozen=True):
    """Rotational flexibility between a column and a floor or the base.

    Attributes:
        default: Name of the calibration that is used when none is asked for.
        stiffness_n_m_per_rad: Stiffness of one joint about y by the name of its calibration [N m/rad].
    """

    default: str
    stiffness_n_m_per_rad: dict[str, float]


class Yielding(Data, frozen=True):
    """Columns that yield: each storey is elastic up to a force, and goes on with a share of its stiffness.

    Attributes:
        storey_shear_n: Force at which a storey yields [N], one for all or one for each from the first up. None: that
            of plastic hinges at both ends of all columns, which a frame of plates knows.
        hardening_ratio: Stiffness beyond over that before [-].
        sharpness: Exponent of a rounded knee (Bouc 1967, Wen 1976) [-]: 1 is round, 30 as good as sharp. None: a sharp one,
            so that the storey is bilinear.
    """

    storey_shear_n: float | list[float] | None = None
    hardening_ratio: float = 0.0
    sharpness: float | None = None


class Published(Data, frozen=True):
    """Measured and published properties of a frame, for comparison; None where nothing is published."""

    source: str = ""
    mass_kg: float | None = None
    free_vibration_hz: float | None = None
    free_vibration_damping_ratio: float | None = None
    sweep_hz: list[float] = []
    roof_stiffness_n_per_mm: float | None = None
    numerical_hz: list[float] = []
    numerical_roof_stiffness_n_per_mm: float | None = None

    def __repr__(self) -> str:
        return f"Published({self.source!r}, {self.free_vibration_hz} Hz, damping ratio {self.free_vibration_damping_ratio})"


def _in_a_line(frame: PlateFrame | StickFrame) -> str:
    kind, first = type(frame).__name__, frame.storey_heights_m[0]
    return f"{kind}({frame.name!r}, {frame.storeys} storeys, first {first:g} m high)"


class PlateFrame(Data, frozen=True, tag_field="kind", tag="plate"):
    """A frame of floor plates on column strips.

    Attributes:
        name: Name of the frame.
        storeys: Number of storeys.
        storey_height_m: Distance between the mid-planes of two floors [m].
        plate: The floors.
        columns: The columns.
        joints: Stiffness of the joints.
        damping_ratio: Damping ratio of every mode, a fraction.
        title: One line that describes the frame.
        material: Steel by default.
        nonstructural_mass_kg: Mass beyond the plates, spread evenly over all floors [kg]; may be negative.
        published: What is known from tests and other models.
        added_mass_kg: Mass at the centre of each floor, from the first floor up [kg]; empty: none.
        stiffness_factor: Factor on the elastic stiffness of everything.
        joint_factor: Factor on the joints' stiffness alone.
        storey_stiffness_factor: Factor on the columns' elasticity, storey by storey; empty: 1.
        mass_eccentricity_m: Distance in y of the floors' centres of mass from the plan's centre [m].
        base_rotational_stiffness_n_m_per_rad: Spring about y on which the whole base turns; None: fixed.
        weight_factor: Factor on the weight that the geometric stiffness is made of.
        yielding: How its columns yield; None: the frame is linear.
        storey_law: Further forces in its storeys and on its floors; see `pounding.frames.storey_laws`.
        scale: Length over that of the building, ``"1:30"`` or a number; see `pounding.frames.scale`.
    """

    name: str
    storeys: int
    storey_height_m: float
    plate: Plate
    columns: Columns
    joints: Joints
    damping_ratio: float
    title: str = ""
    material: Material = Material()
    nonstructural_mass_kg: float = 0.0
    published: Published = Published()
    added_mass_kg: list[float] = []
    stiffness_factor: float = 1.0
    joint_factor: float = 1.0
    storey_stiffness_factor: list[float] = []
    mass_eccentricity_m: float = 0.0
    base_rotational_stiffness_n_m_per_rad: float | None = None
    weight_factor: float = 1.0
    yielding: Yielding | None = None
    storey_law: list[StatedLaw] = []
    scale: str | float | None = None

    __repr__ = _in_a_line

    def __post_init__(self) -> None:
        checks.plate_frame(self)

    @property
    def places_m(self) -> list[tuple[float, float]]:
        """Centres (x, y) of the columns in plan [m]."""
        if self.columns.places_m:
            return [(float(x), float(y)) for x, y in self.columns.places_m]
        x = self.plate.length_m / 2.0 - self.columns.inset_x_m
        y = (self.plate.width_m - self.columns.width_m) / 2.0 - self.columns.inset_y_m
        return [(-x, -y), (x, -y), (-x, y), (x, y)]

    @property
    def storey_heights_m(self) -> list[float]:
        """Height of each storey [m]."""
        return [self.storey_height_m] * self.storeys

    @property
    def floor_heights_m(self) -> list[float]:
        """Height of each floor above the base [m]."""
        return [self.storey_height_m * number for number in range(1, self.storeys + 1)]

    @property
    def floor_plate_mass_kg(self) -> float:
        """Mass of one floor plate [kg]."""
        plate = self.plate
        return plate.length_m * plate.width_m * plate.thickness_m * self.material.density_kg_per_m3

    @property
    def storey_columns_mass_kg(self) -> float:
        """Mass of all columns of one storey [kg]."""
        columns = self.columns
        volume = columns.width_m * columns.thickness_m * self.storey_height_m * len(self.places_m)
        return volume * self.material.density_kg_per_m3

    @property
    def added_by_floor_kg(self) -> list[float]:
        """Added mass of each floor [kg], as many entries as storeys."""
        return list(self.added_mass_kg) or [0.0] * self.storeys

    @property
    def moving_mass_kg(self) -> float:
        """Mass of floors, columns and everything on them, without any base plate [kg]."""
        structure = self.storeys * (self.floor_plate_mass_kg + self.storey_columns_mass_kg)
        return structure + self.nonstructural_mass_kg + sum(self.added_by_floor_kg)

    def weights_n(self) -> list[float]:
        """Return the weight that the columns of each storey carry at mid-height [N]."""
        spread = self.nonstructural_mass_kg / self.storeys
        floors = [self.floor_plate_mass_kg + spread + added for added in self.added_by_floor_kg]
        column = self.storey_columns_mass_kg
        above = [sum(floors[i:]) + column * (self.storeys - i - 0.5) for i in range(self.storeys)]
        return [STANDARD_GRAVITY * self.weight_factor * mass for mass in above]

    def joint_stiffness(self, calibration: str | None = None) -> float:
        """Return the stiffness of one joint [N m/rad].

        Args:
            calibration: A name in ``joints.stiffness_n_m_per_rad``; the default of the frame when None.

        Raises:
            FrameError: The frame has no such calibration.
        """
        known = self.joints.stiffness_n_m_per_rad
        wanted = calibration or self.joints.default
        if wanted not in known:
            raise FrameError(f"frame {self.name}: no calibration {wanted!r}; it has {', '.join(known)}")
        return known[wanted] * self.joint_factor * self.stiffness_factor


class Slab(Data, frozen=True):
    """The floor slab of a stick, of concrete unless stated: what its contact with a neighbour is estimated from.

    Attributes:
        thickness_m: Thickness [m].
        youngs_modulus_gpa: Young's modulus [GPa].
        poissons_ratio: Poisson's ratio [-].
        density_kg_per_m3: Density [kg/m^3].
    """

    thickness_m: float
    youngs_modulus_gpa: float = 30.0
    poissons_ratio: float = 0.2
    density_kg_per_m3: float = 2500.0


class ModeTable(Data, frozen=True):
    """Modes of a building, as a test or another program gives them.

    Attributes:
        file: The CSV they were read from; empty: they are stated here.
        frequency_hz: Frequency of each mode, the lowest first [Hz].
        damping_ratio: Damping ratio of each, a fraction.
        shapes: Shape of each at the floors, from the first up, in any scale.
        remainder_hz: Frequency of every motion that these modes do not cover [Hz]; None: where the next mode of a
            uniform shear building lies, (2 m + 1) / (2 m - 1) times the last of m.
    """

    file: str = ""
    frequency_hz: list[float] = []
    damping_ratio: list[float] = []
    shapes: list[list[float]] = []
    remainder_hz: float | None = None


class LeftOut(Data, frozen=True):
    """What a static condensation to the floors left out.

    Attributes:
        rows: Number of rows that are no floor.
        diagonal_mass: Sum of the mass matrix' diagonal on them [kg, kg m^2 for rotations].
        added_to_floors_kg: Mass along x that they add to the floors by the static shapes [kg].
    """

    rows: int
    diagonal_mass: float
    added_to_floors_kg: float


class Matrices(Data, frozen=True):
    """Mass and stiffness of a building, from another program.

    Attributes:
        mass_file: The file that the mass was read from; empty: it is stated here.
        stiffness_file: The same of the stiffness.
        floor_rows: Row of each floor's displacement along x in the files, counted from 1.
        mass_kg: Mass at the floors (storeys, storeys) [kg].
        stiffness_n_per_m: Stiffness at the floors (storeys, storeys) [N/m].
        left_out: What the condensation of the files to the floors left out.
    """

    mass_file: str = ""
    stiffness_file: str = ""
    floor_rows: list[int] = []
    mass_kg: list[list[float]] = []
    stiffness_n_per_m: list[list[float]] = []
    left_out: LeftOut | None = None


class Torsion(Data, frozen=True):
    """How the floors of a stick turn about the vertical; see `pounding.frames.torsion`.

    Attributes:
        eccentricity_m: Place across the shaking (y) of the centre of stiffness, from the centre of mass in the middle of the
            plan [m]; one for all storeys, or one for each storey of a chain.
        stiffness_n_m_per_rad: Torsional stiffness of each storey about its centre of stiffness, from the first up
            [N m/rad]; empty with ``frequency_ratio``.
        frequency_ratio: First frequency of the torsion over that of the sway if there were no eccentricity [-]: the
            torsional radius over the radius of gyration of Eurocode 8.
        floor_inertia_kg_m2: Moment of inertia of each floor about the vertical through its middle [kg m^2]; empty:
            that of a uniform floor of the plan.
    """

    eccentricity_m: float | list[float] = 0.0
    stiffness_n_m_per_rad: list[float] = []
    frequency_ratio: float | None = None
    floor_inertia_kg_m2: list[float] = []

    @property
    def is_symmetric(self) -> bool:
        """Whether a shaking along x turns no floor."""
        off = self.eccentricity_m
        return not any(off) if isinstance(off, list) else not off


class StickFrame(Data, frozen=True, tag_field="kind", tag="stick"):
    """A frame known by its floors alone: a chain of floor masses on storey springs, or what a table of modes or
    matrices say.

    Its floors move along x; with ``torsion`` they also turn about the vertical. The storey stiffnesses, some of the lowest
    frequencies, modes or matrices are stated. What they are taken from (a test, a code's estimate) holds its own joints
    and its own weight, so that ``joints`` and ``p_delta`` do not change a stick.

    Attributes:
        name: Name of the frame.
        storeys: Number of storeys.
        storey_height_m: One height for all storeys, or one for each [m].
        floor_mass_kg: Mass of each floor, from the first up [kg]; left out with ``matrices``.
        damping_ratio: One damping ratio for all modes, or one for each of the lowest modes (the modes above
            take the last); fractions. Left out with ``modes``, which have their own.
        damping_beyond: Damping ratio of the modes above those that have one: ``last`` takes the last, ``caughey`` follows
            the Caughey series through the stated ones, with two of them Rayleigh's.
        storey_stiffness_n_per_m: Stiffness of each storey, from the first up [N/m].
        frequency_hz: The lowest frequencies, at least the first [Hz].
        stiffness_ratio: Miranda's alpha of a bending-shear stick [-], 0 a wall that bends, 30 nearly a shear
            frame; it needs the first frequency alone. None: a chain of storey springs.
        modes: A table of modes instead of stiffnesses or frequencies.
        matrices: Mass and stiffness matrices instead of all of these.
        plan_m: Sides along x and y [m].
        title: One line that describes the frame.
        published: What is known from tests, for comparison.
        yielding: How its storeys yield; None: the frame is linear.
        storey_law: Further forces in its storeys and on its floors; see `pounding.frames.storey_laws`.
        scale: Length over that of the building, ``"1:30"`` or a number; see `pounding.frames.scale`.
        slab: The floors' slab, for an estimate of the contact; None where it is not known.
        torsion: How the floors turn about the vertical; None: they do not.
    """

    name: str
    storeys: int
    storey_height_m: float | list[float]
    floor_mass_kg: list[float] = []
    damping_ratio: float | list[float] | None = None
    damping_beyond: Literal["last", "caughey"] = "last"
    storey_stiffness_n_per_m: list[float] = []
    frequency_hz: list[float] = []
    stiffness_ratio: float | None = None
    modes: ModeTable | None = None
    matrices: Matrices | None = None
    plan_m: tuple[float, float] = (0.4, 0.4)
    title: str = ""
    published: Published = Published()
    yielding: Yielding | None = None
    storey_law: list[StatedLaw] = []
    scale: str | float | None = None
    slab: Slab | None = None
    torsion: Torsion | None = None

    __repr__ = _in_a_line

    def __post_init__(self) -> None:
        checks.stick_frame(self)

    @property
    def storey_heights_m(self) -> list[float]:
        """Height of each storey [m]."""
        height = self.storey_height_m
        return list(height) if isinstance(height, list) else [height] * self.storeys

    @property
    def floor_heights_m(self) -> list[float]:
        """Height of each floor above the base [m]."""
        return list(accumulate(self.storey_heights_m))

    @property
    def damping_ratios(self) -> list[float]:
        """Damping ratio of each mode, as many as storeys."""
        given = self.modes.damping_ratio if self.modes is not None else self.damping_ratio
        stated = given if isinstance(given, list) else [given or 0.0]
        return [stated[min(mode, len(stated) - 1)] for mode in range(self.storeys)]

    @property
    def moving_mass_kg(self) -> float:
        """Mass of all floors [kg]; of a mass matrix, that which a common motion of all floors moves."""
        return sum(map(sum, self.matrices.mass_kg)) if self.matrices is not None else sum(self.floor_mass_kg)


Frame = PlateFrame | StickFrame


def changed(frame: PlateFrame, **fields: Any) -> PlateFrame:
    """Return a frame with some fields replaced, checked like a new one.

    Raises:
        FrameError: A field has no such name, or a value that cannot be.
    """
    unknown = set(fields) - set(frame.__struct_fields__)
    if unknown:
        raise FrameError(f"frame {frame.name}: no field {', '.join(sorted(unknown))} to change")
    return msgspec.structs.replace(frame, **fields)
