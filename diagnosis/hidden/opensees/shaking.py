"""A run of the second world: frames, hidden materials, contacts and loads in one OpenSees domain, step by step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.diagnosis.hidden.contacts import Touch, damping_ratio
from pounding.diagnosis.hidden.motions import Motion
from pounding.diagnosis.hidden.opensees import materials
from pounding.diagnosis.hidden.opensees.domain import Domain
from pounding.diagnosis.hidden.opensees.materials import Materials, Slider
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame, Standing, raise_frame
from pounding.diagnosis.hidden.scenario import Happened, Scenario, table_motion

IN_CONTACT = 24
"""Parts of a step in which two floors may touch."""

NEAR_M = 5e-5
"""Distance from which two floors count as near [m]."""

PRESSED_N = 1000.0
"""Force that presses a slider; its friction is that times a coefficient, so that it has no meaning [N]."""


@dataclass(frozen=True)
class Link:
    """Materials between two floors (0 is the table): on floor `upper` of `frame` against `lower`.

    With `absolute` against the room instead.
    """

    frame: str
    upper: int
    lower: int
    law: materials.Law
    absolute: bool = False


@dataclass(frozen=True)
class Rider:
    """A mass [kg] that nothing but materials holds on a floor."""

    frame: str
    floor: int
    mass: float
    law: Materials


@dataclass(frozen=True)
class PlaneScenario(Scenario):
    """The truth of a case of the second world: its laws are materials (`links`, `riders`), never `springs`.

    Attributes:
        links: Given the length of a run [s], what links two floors in it.
        riders: What moves about on the floors.
    """

    links: tuple[Callable[[float], Link], ...] = ()
    riders: tuple[Rider, ...] = ()


def happen(scenario: Scenario, motion: Motion, run: int, parts: int = 1) -> Happened:
    """Let a run happen in OpenSees; what loses its equilibrium is NaN from there on.

    The steps are the motion's. What Newmark's rule with a fixed step makes of a linear frame is another linear frame, with
    upper frequencies a little lower; it is the same in all runs, and belongs to the truth.

    Args:
        scenario: What is on the table.
        motion: What the table channel says.
        run: Number of the run, for the loads.
        parts: Steps of the integration in a step of the motion.
    """
    return _Stage(scenario, motion, run).happened(parts)


class _Stage:
    """One domain from its nodes to the last step."""

    def __init__(self, scenario: Scenario, motion: Motion, run: int) -> None:
        self.scenario, self.motion = scenario, motion
        self.table, self.pitch, self.pitching = table_motion(scenario, motion)
        duration = motion.step_s * (len(self.table) - 1)
        self.domain = Domain()
        self.frames: Mapping[str, Standing] = {
            name: raise_frame(self.domain, _plane(frame)) for name, frame in scenario.frames.items()
        }
        self.links = [make(duration) for make in getattr(scenario, "links", ())]
        self.riders = [*getattr(scenario, "riders", ()), *_appendages(scenario)]
        # Every node is there, and follows its floor, before the modes are asked for: modal damping takes what a node
        # moves in them, and of a floor with a follower that is what the follower moved.
        spots = [(link.frame, link.upper) for link in self.links]
        self.ends = [self._held(*spot) for spot in spots]
        self.slides = [
            self._held(*spot) if isinstance(link.law, Slider) else 0
            for spot, link in zip(spots, self.links, strict=True)
        ]
        self.ridden = [self._held(rider.frame, rider.floor) for rider in self.riders]
        self._follow()
        self.moduli: list[tuple[int, Callable[[float], float]]] = []
        self.domain.stand([load for frame in self.frames.values() for load in frame.weights])
        _damp(self.domain, list(self.frames.values()))
        self._tie()
        self._shake(run)
        self.contacts = [self._contact(touch) for touch in scenario.touches]

    def _held(self, frame: str, floor: int) -> int:
        beams = self.scenario.frames[frame]
        half = _plane(beams).span_m / 2
        return self.domain.node(-half, floor * beams.height_m, (1, 1, 1))

    def _node(self, frame: str, floor: int) -> int:
        return self.frames[frame].floors[floor - 1]

    def _follow(self) -> None:
        """Let the nodes between floors move along x with the floor that carries them."""
        for link, end, slider in zip(self.links, self.ends, self.slides, strict=True):
            followers = [(link.lower, end)] if link.lower and not link.absolute else []
            followers += [(link.upper, slider)] if slider else []
            for floor, node in followers:
                self.domain.release(node, 1)
                self.domain.ops.equalDOF(self._node(link.frame, floor), node, 1)

    def _tie(self) -> None:
        """Put the materials in; sliders first, for they have to be pressed while nothing rides loose."""
        pressed = []
        for link, end, slider in zip(self.links, self.ends, self.slides, strict=True):
            if isinstance(link.law, Slider):
                self._slider(link, link.law, end, slider)
                pressed.append(slider)
        press(self.domain, pressed)
        for link, end in zip(self.links, self.ends, strict=True):
            if isinstance(link.law, Materials):
                self._side_by_side(link.law, end, self._node(link.frame, link.upper))
        for rider, node in zip(self.riders, self.ridden, strict=True):
            self.domain.release(node, 1)
            self.domain.ops.mass(node, rider.mass, 0.0, 0.0)
            self._side_by_side(rider.law, self._node(rider.frame, rider.floor), node)

    def _side_by_side(self, law: Materials, low: int, high: int) -> None:
        ends = (high, low) if law.mirrored else (low, high)
        elements = [self.domain.spring(*ends, 1, *part) for part in law.parts]
        if law.modulus is not None:
            parameter = self.domain.number()
            self.domain.ops.parameter(parameter, "element", elements[0], "material", 1, "E")
            self.moduli.append((parameter, law.modulus))

    def _slider(self, link: Link, law: Slider, low: int, high: int) -> None:
        """Put in a slider: it moves along x with the upper floor and is pressed down on the lower."""
        self.domain.release(high, 2)
        slide(self.domain, law, low, high)

    def _shake(self, run: int) -> None:
        """Move the table, the room as it is seen from it, and press on floors what nobody measured."""
        domain, step = self.domain, self.motion.step_s
        pushed = domain.path(self.table - STANDARD_GRAVITY * self.pitch, step)
        domain.ops.pattern("UniformExcitation", domain.number(), 1, "-accel", pushed)
        if self.pitching.any():
            series = domain.path(self.pitching, step)
            # Only the floors' masses have a lever of note.
            domain.loads(series, self._levers())
        time = step * np.arange(len(self.table))
        for load in self.scenario.loads:
            series = domain.path(load.history(run, time), step)
            domain.loads(series, [(self._node(load.frame, load.floor), 1.0, 0.0)])
        if any(link.absolute for link in self.links):
            self._room()

    def _levers(self) -> list[tuple[int, float, float]]:
        levers = []
        for standing in self.frames.values():
            for (left, right), height in zip(
                standing.corners, standing.frame.heights_m.tolist(), strict=True
            ):
                levers += [(node, -standing.masses[node, 1] * height, 0.0) for node in (left, right)]
        return levers

    def _room(self) -> None:
        """Let the nodes that stand in the room move against the table."""
        domain, step = self.domain, self.motion.step_s
        moved = Motion("", step, self.table)
        said = (-moved.acceleration, -moved.velocity, -moved.displacement)
        series = [domain.path(values, step) for values in said]
        domain.ops.pattern("MultipleSupport", domain.number())
        ground = domain.number()
        words = ("-accel", series[0], "-vel", series[1], "-disp", series[2])
        domain.ops.groundMotion(ground, "Plain", *words)
        for link, end in zip(self.links, self.ends, strict=True):
            if link.absolute:
                domain.release(end, 1)
                domain.ops.imposedMotion(end, 1, ground)

    def _contact(self, touch: Touch) -> tuple[int, int, int, float]:
        """Return the element of a contact, its two nodes and its gap."""
        frames = [self.scenario.frames[name] for name in (touch.left, touch.right)]
        mass = float(1 / sum(1 / frame.floor_mass[touch.floor - 1] for frame in frames))
        ratio = damping_ratio(touch)
        damping = touch.damping
        if damping is None:
            damping = 2 * ratio * float(np.sqrt(touch.stiffness * mass))
        nodes = self._node(touch.left, touch.floor), self._node(touch.right, touch.floor)
        material = materials.contact(touch.law, touch.stiffness, touch.gap_m, ratio, damping, mass)
        return self.domain.spring(*nodes, 1, *material), *nodes, touch.gap_m

    def happened(self, parts: int) -> Happened:
        """Return the run after so many steps of the integration in each step of the motion."""
        ops, step, count = self.domain.ops, self.motion.step_s, len(self.table)
        nodes = [node for frame in self.frames.values() for node in frame.floors]
        moved = np.full((3, len(nodes), count), np.nan)
        forces = np.full((len(self.contacts), count), np.nan)
        moved[:, :, 0], forces[:, 0] = 0.0, 0.0
        self.domain.move()
        for sample in range(1, count):
            for parameter, modulus in self.moduli:
                ops.updateParameter(parameter, modulus((sample - 0.5) * step))
            pressed = self._steps(parts)
            if pressed is None:
                break
            forces[:, sample] = pressed
            for kind, read in enumerate((ops.nodeDisp, ops.nodeVel, ops.nodeAccel)):
                moved[kind, :, sample] = [read(node, 1) for node in nodes]
        ops.wipe()
        height = np.concatenate([beams.heights_m for beams in self.scenario.frames.values()])[:, None]
        return Happened(
            self.motion,
            self.table,
            moved[0] + height * self.pitch,
            moved[1] + height * np.gradient(self.pitch, step),
            moved[2] + self.table + height * self.pitching,
            forces,
        )

    def _steps(self, parts: int) -> list[float] | None:
        """Go on by one step of the motion; return each contact's mean force [N], or None without an equilibrium."""
        step = self.motion.step_s / parts
        if not self._near(parts * step):
            return [0.0] * len(self.contacts) if self.domain.step(parts, step) else None
        total = np.zeros(len(self.contacts))
        for _ in range(parts * IN_CONTACT):
            if not self.domain.step(1, step / IN_CONTACT):
                return None
            total -= [
                self.domain.ops.eleResponse(element, "material", 1, "stress")[0]
                for element, *_ in self.contacts
            ]
        mean: list[float] = (np.maximum(total, 0.0) / (parts * IN_CONTACT)).tolist()
        return mean

    def _near(self, step_s: float) -> bool:
        """Return whether two floors may touch within a step [s]."""
        ops = self.domain.ops
        for _, left, right, gap in self.contacts:
            nearer = ops.nodeDisp(left, 1) - ops.nodeDisp(right, 1)
            rate = ops.nodeVel(left, 1) - ops.nodeVel(right, 1)
            if nearer + max(rate, 0.0) * step_s > gap - NEAR_M:
                return True
        return False


def slide(domain: Domain, law: Slider, low: int, high: int) -> int:
    """Put a flat bearing between two nodes at one place and return its element; see `press`.

    Args:
        domain: Where it is put.
        law: Its law.
        low: Node that carries it.
        high: Node that slides on it, free along x and y.
    """
    ops = domain.ops
    axial, turning, friction, element = (domain.number() for _ in range(4))
    ops.uniaxialMaterial("Elastic", axial, 1e4 * PRESSED_N)
    ops.uniaxialMaterial("Elastic", turning, 1e-3)
    coefficient = law.level / PRESSED_N
    ops.frictionModel("VelDependent", friction, law.breakaway * coefficient, coefficient, 1.0 / law.fades)
    rules = ("-P", axial, "-Mz", turning, "-orient", 0, 1, 0, -1, 0, 0)
    ops.element("flatSliderBearing", element, low, high, friction, law.stiffness, *rules)
    return element


def press(domain: Domain, nodes: Sequence[int]) -> None:
    """Press the upper nodes of sliders down for good."""
    if nodes:
        domain.stand([(node, 0.0, -PRESSED_N) for node in nodes])


def _plane(frame: object) -> PlaneFrame:
    if not isinstance(frame, PlaneFrame):
        raise TypeError(f"OpenSees shakes plane frames, not a {type(frame).__name__}")
    return frame


def _appendages(scenario: Scenario) -> list[Rider]:
    """Return the appendages of the frames as masses on springs and dashpots."""
    riders = []
    for name, frame in scenario.frames.items():
        hung = frame.appendage
        if hung is None:
            continue
        circular = 2 * np.pi * hung.frequency_hz
        dashpot = 2 * hung.ratio * circular * hung.mass
        law = Materials((("Elastic", circular**2 * hung.mass), ("Viscous", dashpot, 1.0)))
        riders.append(Rider(name, hung.floor, hung.mass, law))
    return riders


def _damp(domain: Domain, standing: list[Standing]) -> None:
    """Damp every frame as it says: Rayleigh's kind by its elements, and its lateral modes one by one."""
    for one in standing:
        alpha, beta = one.frame.rayleigh
        if alpha or beta:
            domain.ops.region(domain.number(), "-ele", *one.elements, "-rayleigh", alpha, 0.0, beta, 0.0)
        for storey, dashpot in enumerate(one.frame.dashpots.tolist(), 1):
            if dashpot:
                _dashpot(domain, one, storey, dashpot)
    if not any(one.frame.modal.size for one in standing):
        return
    count = sum(one.frame.storeys for one in standing)
    # The default solver starts from a vector of its own chance: a seed would not quite make the same case twice.
    domain.ops.eigen("-fullGenLapack", count)
    ranks = [0] * len(standing)
    ratios = []
    for mode in range(1, count + 1):
        swings = [abs(domain.ops.nodeEigenvector(one.floors[-1], mode, 1)) for one in standing]
        owner = int(np.argmax(swings))
        modal = standing[owner].frame.modal
        ratios.append(float(modal[min(ranks[owner], len(modal) - 1)]) if modal.size else 0.0)
        ranks[owner] += 1
    domain.ops.modalDampingQ(*ratios)


def _dashpot(domain: Domain, standing: Standing, storey: int, damping: float) -> None:
    frame = standing.frame
    end = domain.node(-frame.span_m / 2, storey * frame.height_m, (int(storey == 1), 1, 1))
    if storey > 1:
        domain.ops.equalDOF(standing.floors[storey - 2], end, 1)
    domain.spring(end, standing.floors[storey - 1], 1, "Viscous", damping, 1.0)
