"""What a frame on a bench has and no linear frame of as many storeys can have; each a little, all at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

import numpy as np

from pounding.diagnosis.hidden.opensees import materials
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame
from pounding.diagnosis.hidden.opensees.shaking import Link, PlaneScenario, Rider
from pounding.diagnosis.hidden.reference import Typical

SLIPPING, LOPSIDED, DRAGGING, SWAYING = 0.008, 0.045, 0.3, 0.02
"""What a flaw of scale 1 is: the joints' share that slips, the storeys' stiffness that acts on one side only, the
damping that is not proportional to the rate over the first mode's, the mass that moves out of line over the floor's.
Each alone then leaves about 1 % of the motion of a 5A that no linear frame gives."""

MOST_SLIPPING = 0.6
MOST_SWAYING = 0.08


@dataclass(frozen=True)
class Flaws:
    """Unit flaws of one frame: how much of each kind, and where.

    Attributes:
        shares: Of the four kinds (slipping, lopsided, dragging, swaying), shape (4,); 1 in the mean.
        slipping: Of each joint level, shape (storeys + 1,).
        slips_at: Rotation at which joints slip, over the largest storey drift per height [-].
        lopsided: Of each storey, signed, shape (storeys,).
        dragging: Of each storey, shape (storeys,).
        power: Exponent of the rate in that damping.
        swaying: Of each floor, shape (storeys,).
        sways_at: Its frequency over the frame's first [-].
        sway_ratio: Its damping ratio.
    """

    shares: np.ndarray
    slipping: np.ndarray
    slips_at: float
    lopsided: np.ndarray
    dragging: np.ndarray
    power: float
    swaying: np.ndarray
    sways_at: float
    sway_ratio: float

    def stated(self) -> dict[str, object]:
        """Return them as a truth file has them."""
        return {name: np.asarray(value).tolist() for name, value in asdict(self).items()}

    def on(self, scenario: PlaneScenario, name: str, typical: Typical, scale: float) -> PlaneScenario:
        """Return a rig with these flaws in one of its frames.

        Args:
            scenario: The rig.
            name: The frame.
            typical: Its usual sizes without them.
            scale: How large they are.
        """
        frame = scenario.frames[name]
        if not isinstance(frame, PlaneFrame):
            raise TypeError("flaws of the second world were put into another frame")
        sizes = scale * self.shares
        turned = float(typical.peak_drift.max()) / frame.height_m
        flawed = replace(
            frame,
            slip_share=np.minimum(SLIPPING * sizes[0] * self.slipping, MOST_SLIPPING),
            slip_rotation=self.slips_at * turned,
        )
        links = [*self._lopsided(name, typical, sizes[1]), *self._dragging(frame, typical, sizes[2])]
        return replace(
            scenario,
            frames={**scenario.frames, name: flawed},
            links=(*scenario.links, *map(_always, links)),
            riders=(*scenario.riders, *self._swaying(frame, typical, sizes[3])),
        )

    def _lopsided(self, name: str, typical: Typical, size: float) -> list[Link]:
        """Storeys that are stiffer one way, as bowed columns are or joints with play on one side."""
        links = []
        for storey, (share, peak) in enumerate(zip(self.lopsided, typical.peak_drift, strict=True), 1):
            stiffness = LOPSIDED * size * abs(share) * float(typical.stiffness[storey - 1])
            if stiffness:
                law = materials.curve(
                    _one_sided(stiffness, np.sign(share), 0.1 * float(peak)), 5 * float(peak)
                )
                links.append(Link(name, storey, storey - 1, law))
        return links

    def _dragging(self, frame: PlaneFrame, typical: Typical, size: float) -> list[Link]:
        """Damping of bolts, cables and air: by a power of the rate."""
        linear = 2 * float(frame.ratios[0]) / (2 * np.pi * typical.first_hz) * typical.stiffness
        each = DRAGGING * size * self.dragging * linear * typical.rms_rate ** (1 - self.power)
        return [
            Link(frame.name, storey, storey - 1, materials.viscous(float(one), self.power))
            for storey, one in enumerate(each, 1)
            if one
        ]

    def _swaying(self, frame: PlaneFrame, typical: Typical, size: float) -> list[Rider]:
        """What turns or sways out of line with a floor, and hangs on it weakly, seen from the plane."""
        riders, circular = [], 2 * np.pi * self.sways_at * typical.first_hz
        for floor, share in enumerate(self.swaying, 1):
            mass = min(SWAYING * size * float(share), MOST_SWAYING) * float(frame.floor_mass[floor - 1])
            if mass:
                dashpot = 2 * self.sway_ratio * circular * mass
                law = materials.Materials((("Elastic", circular**2 * mass), ("Viscous", dashpot, 1.0)))
                riders.append(Rider(frame.name, floor, mass, law))
        return riders


def drawn_flaws(rng: np.random.Generator, storeys: int) -> Flaws:
    """Draw the unit flaws of a frame of so many storeys."""
    return Flaws(
        shares=4 * rng.dirichlet(np.ones(4)),
        slipping=rng.uniform(0.3, 1.7, storeys + 1),
        slips_at=float(rng.uniform(0.1, 0.4)),
        lopsided=rng.standard_normal(storeys),
        dragging=rng.uniform(0.3, 1.7, storeys),
        # Below 1 the force jumps where the motion turns, and no step is small enough; joints that slip are such a damping.
        power=float(rng.uniform(1.3, 1.8)),
        swaying=rng.uniform(0.3, 1.7, storeys),
        sways_at=float(rng.uniform(1.2, 2.4)),
        sway_ratio=float(rng.uniform(0.005, 0.03)),
    )


def _one_sided(stiffness: float, side: float, knee: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return a spring that acts to one side only, with a rounded knee [m]."""

    def force(d: np.ndarray) -> np.ndarray:
        past = side * d
        return np.asarray(side * stiffness * 0.5 * (past + np.sqrt(past**2 + knee**2) - knee))

    return force


def _always(link: Link) -> Callable[[float], Link]:
    return lambda _: link
