"""A street as a verb takes it: its file read, checked and built, before long work starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import msgspec

from pounding.experiments.console import estimates
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contact_choice import Parameters
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.frame_laws import refuse_laws
from pounding.experiments.rig.states import FrameState, states_of
from pounding.experiments.rig.street import Basis, built_row, chosen_sets, named, street_contacts
from pounding.experiments.rig.street_file import Street, is_street_file, load_street
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.frames import ReducedFrame, load


@dataclass(frozen=True)
class LinearStreet:
    """A street of linear buildings, for the verbs that need no more than floors and contacts between them.

    Attributes:
        file: The street file.
        street: What it says.
        scale: The buildings' scale.
        states: Their states.
        frames: The buildings, reduced, under their names.
        parameters: The parameter set of each gap.
    """

    file: str
    street: Street
    scale: TableScale
    states: tuple[FrameState, ...]
    frames: tuple[ReducedFrame, ...]
    parameters: list[Parameters | None]

    def contacts(self, street: Street | None = None) -> tuple[list[Contact], list[Basis]]:
        """Return the contacts, each with what its numbers rest on.

        Args:
            street: The same buildings with other gaps; None: the street itself.
        """
        return street_contacts(street or self.street, self.frames, self.parameters)

    def as_dict(self) -> dict[str, Any]:
        """Return it for the parameters of a result."""
        return {
            "street": self.file,
            **msgspec.to_builtins(self.street),
            "states": [one.as_dict() for one in self.states],
            **self.scale.as_dict(),
        }


def linear_street(file: str, time_factor: float | None, damping: float | None) -> LinearStreet:
    """Return the street of a file, built.

    Args:
        file: The street file.
        time_factor: Factor on the record's time that the user states [-].
        damping: Damping ratio of every mode that the user states [-].

    Raises:
        ExperimentError: No street file, or a building that is not linear.
        FrameError: A frame that cannot be.
    """
    if not is_street_file(file):
        load(file)  # whose sentence on what is no frame is the better one
        raise ExperimentError(
            f"{file} is one frame and no street file; pounding new-street writes one from two frames or more"
        )
    street = load_street(file)
    names = [building.frame for building in street.building]
    definitions = [load(name) for name in names]
    scale = table_scale(definitions, time_factor)
    parameters = chosen_sets(street, definitions, scale)
    states = states_of(names, damping=damping)
    estimates.announce(*map(estimates.of_frame, definitions))
    frames = tuple(named(street, built_row(street, states)))
    refuse_laws(frames)
    return LinearStreet(file, street, scale, states, frames, parameters)
