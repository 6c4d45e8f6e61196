"""Slopes of frames that touch: impacts make them swing fast between samples, and a contact event is shorter than a step."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.contact_force.pair import prepare
from pounding.diagnosis.inference.filtering import run_filter, run_signatures, whitened
from pounding.diagnosis.inference.motions import motion_of
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.terms import nuisance_terms
from tests.diagnosis.pair_models import CONTACT, colliding, model_of

LARGEST = {
    "event_gain": 0.001,
    "frame_stiffness": 0.02,
    "storey_stiffness": 0.02,
    "floor_mass": 0.02,
    "damping_power": 0.02,
}
"""Largest relative error of the slopes of each kind of parameter."""


def test_signatures_of_frames_that_touch_are_slopes_of_the_innovations() -> None:
    """A force went straight from sample to sample: slopes were up to 16 % too small, and no descent got to its optimum."""
    case = colliding(CONTACT)
    model = prepare(case, model_of(case)).slow
    values = np.zeros(len(model.std))
    filtered = run_filter(model, values, starting_noise(model, (0,), 0.1), (0,))
    columns = run_signatures(
        model, filtered, 0, nuisance_terms(model, filtered.modes, motion_of(model, filtered, 0))
    )

    def innovations(there: np.ndarray) -> np.ndarray:
        found = model.predict(there, filtered.gains, (), (0,), whole=False).innovations[0]
        return np.asarray(whitened(found, filtered.filters[0]).ravel())

    seen = set()
    for number, parameter in enumerate(model.parameters):
        if parameter.kind not in LARGEST:
            continue
        by = 0.01 * model.std * (np.arange(len(model.std)) == number)
        slope = (innovations(values - by) - innovations(values + by)) / (2.0 * by[number])
        if not np.linalg.norm(slope) * model.std[number] > 1.0:
            continue
        error = np.linalg.norm(columns[:, number] - slope) / np.linalg.norm(slope)
        assert error < LARGEST[parameter.kind], parameter
        seen.add(parameter.kind)
    assert seen == set(LARGEST)
