"""The second world as `hide` knows it."""

from __future__ import annotations

from pounding.diagnosis.hidden.opensees.building import built, settle
from pounding.diagnosis.hidden.opensees.domain import require
from pounding.diagnosis.hidden.opensees.effects import ASKED_FOR, CATALOGUE, CONTACT, OUTSIDE
from pounding.diagnosis.hidden.opensees.shaking import PlaneScenario, happen
from pounding.diagnosis.hidden.world import World

SECOND = World(
    "opensees",
    CATALOGUE,
    ASKED_FOR,
    CONTACT,
    OUTSIDE,
    built,
    PlaneScenario,
    happen,
    settle,
    require,
    # What a contact of a thousandth of a second is told by.
    pair_rates_hz=(4000.0,),
    # Twice as many steps change no channel by 2 % of its motion (`python -m tests.second_world convergence`).
    fine_hz=3000.0,
)
