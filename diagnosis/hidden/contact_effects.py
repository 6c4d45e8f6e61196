"""What can be hidden where two frames touch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.contacts import DAMPED, STIFFNESS, Touch
from pounding.diagnosis.hidden.scenario import Scenario
from pounding.diagnosis.hidden.setting import Effect, Parameters, Setting


def _stated(setting: Setting) -> Touch:
    if setting.stated_contact is None:
        raise CaseError("nothing touches on a single frame; name two frames")
    return setting.stated_contact


def _changed(setting: Setting, **fields: float | str | None) -> Scenario:
    first, *others = setting.scenario.touches
    return replace(setting.scenario, touches=(replace(first, **fields), *others))  # type: ignore[arg-type]


def gap_offset(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Set the frames nearer or further apart than in the baseline model."""
    baseline = _stated(setting)
    offset = size * baseline.gap_m
    return _changed(setting, gap_m=baseline.gap_m + offset), {"offset": (1e3 * offset, "mm")}


def contact_stiffness(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Make the contact stiffer or softer than in the baseline model."""
    touch = _stated(setting)
    stiffness = touch.stiffness * float(np.exp(2 * size))
    unit = "N/m" if touch.law.startswith("linear") else "N/m^1.5"
    return _changed(setting, stiffness=stiffness), {"stiffness": (stiffness, unit)}


def contact_damping(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let the contact lose more or less than in the baseline model."""
    touch = _stated(setting)
    if touch.damping is not None:
        damping = touch.damping * float(np.exp(2 * size))
        return _changed(setting, damping=damping), {"damping": (damping, "N s/m")}
    restitution = float(np.clip((touch.restitution or 0.8) * np.exp(-0.5 * size), 0.2, 0.98))
    return _changed(setting, restitution=restitution), {"restitution": (restitution, "-")}


def contact_law(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let the contact follow another law, with the stiffness usual for it."""
    law = str(rng.choice([name for name in STIFFNESS if name != _stated(setting).law]))
    restitution = 0.75 if law in DAMPED else None
    scenario = _changed(setting, law=law, stiffness=STIFFNESS[law], damping=None, restitution=restitution)
    return scenario, {"law": (law, "-")}


def second_contact(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let the frames touch at another floor too; the stronger, the nearer."""
    touch = _stated(setting)
    # While the stated contact is closed, the other floor is so near; the new one has to close before.
    gap = touch.gap_m * setting.nearness * (1.0 - 0.8 * size)
    other = Touch(touch.left, touch.right, setting.floor, gap, "linear_viscoelastic", 15e6, restitution=0.7)
    return replace(setting.scenario, touches=(*setting.scenario.touches, other)), {"gap": (1e3 * gap, "mm")}


CONTACT: dict[str, Effect] = {
    "gap_offset": Effect("contact", gap_offset, 0.8, -0.8),
    "contact_stiffness": Effect("contact", contact_stiffness, 1.0, -1.0),
    "contact_damping": Effect("contact", contact_damping, 1.0, -1.0),
    "contact_law": Effect("contact", contact_law, 1.0),
    "second_contact": Effect("between", second_contact, 1.0),
}
