"""The two worlds in which effects are hidden."""

from __future__ import annotations

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.baseline import baseline
from pounding.diagnosis.hidden.contact_effects import CONTACT
from pounding.diagnosis.hidden.effects import ASKED_FOR, CATALOGUE
from pounding.diagnosis.hidden.opensees.world import SECOND
from pounding.diagnosis.hidden.outsiders import OUTSIDE
from pounding.diagnosis.hidden.scatter import built
from pounding.diagnosis.hidden.scenario import Scenario, happen
from pounding.diagnosis.hidden.world import World

OWN = World(
    "own",
    CATALOGUE,
    ASKED_FOR,
    CONTACT,
    OUTSIDE,
    lambda rng, name: built(rng, baseline(name)),
    Scenario,
    happen,
)

WORLDS = {world.name: world for world in (OWN, SECOND)}


def world_of(engine: str) -> World:
    """Return a world that can be used here.

    Args:
        engine: ``own`` or ``opensees``.

    Raises:
        CaseError: There is no such engine, or it is not installed.
    """
    if engine not in WORLDS:
        raise CaseError(f"engine {engine!r} is not known; use one of {', '.join(WORLDS)}")
    world = WORLDS[engine]
    if world.require is not None:
        world.require()
    return world
