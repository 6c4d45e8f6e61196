"""What a configuration is: the frames, the gap and the record of a test, and the printed rows that were measured in it.

Each kind of test is a class. The entries are tables in the TOML files of this folder, read by `library`.
"""

from __future__ import annotations

import msgspec

CHAPTERS = (3, 4, 5, 6)


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Common to everything that is read from the files."""


class Placed(_Entry, frozen=True, kw_only=True):
    """A frame of a configuration; a table of its own, so that more can be said of the frame in this configuration.

    Attributes:
        name: Name of a shipped frame.
    """

    name: str


class Printed(_Entry, frozen=True, kw_only=True):
    """A printed row that holds what was measured in a configuration.

    Attributes:
        table: As `pounding.experiments.published.table` knows it, such as `4.1` or `section 5.2.2`.
        row: What names the row there.
    """

    table: str
    row: tuple[str | int, ...]

    def __str__(self) -> str:
        place = self.table if self.table.startswith("section") else f"Table {self.table}"
        return f"{place}, {' '.join(map(str, self.row))}"


class Experiment(_Entry, tag_field="kind", frozen=True, kw_only=True):
    """A configuration of the thesis.

    Attributes:
        name: What it is called by.
        chapters: Chapters of the thesis that report it.
        frames: Frames on the table, from left to right.
        measured: Printed rows with what was measured.
        figures: Figures of the thesis that show it, as printed.
    """

    name: str
    chapters: tuple[int, ...]
    frames: tuple[Placed, ...]
    measured: tuple[Printed, ...]
    figures: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """What kind of test it is."""
        return str(self.__struct_config__.tag)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of the frames, from left to right."""
        return tuple(frame.name for frame in self.frames)

    @property
    def motion(self) -> str | None:
        """Name of the ground motion; None where there is none."""
        return None

    @property
    def title(self) -> str:
        """What is done, in words."""
        return f"{self.kind.replace('-', ' ')} of {self.frame_names[0]}"


class FreeVibration(Experiment, tag="free-vibration", frozen=True, kw_only=True):
    """The roof is displaced and released (section 3.6.1)."""


class Push(Experiment, tag="push", frozen=True, kw_only=True):
    """The roof is pushed sideways in steps (section 3.6.2)."""


class SineSweep(Experiment, tag="sweep", frozen=True, kw_only=True):
    """The table sweeps from 0.1 to 50 Hz (section 3.6.3)."""


class Shaken(Experiment, frozen=True, kw_only=True):
    """A configuration under a ground motion.

    Attributes:
        record: Name of the ground motion.
    """

    record: str

    @property
    def motion(self) -> str:
        """Name of the ground motion."""
        return self.record


class Alone(Shaken, tag="alone", frozen=True, kw_only=True):
    """One frame under a record (section 4.2)."""

    @property
    def title(self) -> str:
        """What is done, in words."""
        return f"{self.frame_names[0]} alone under {self.record}"


class Apart(Shaken, tag="apart", frozen=True, kw_only=True):
    """Two frames as close as they can stand without touching (section 4.3.2)."""

    @property
    def title(self) -> str:
        """What is done, in words."""
        return f"{self.frame_names[0]} beside {self.frame_names[1]} under {self.record}, just not touching"


class _Pounding(Shaken, frozen=True, kw_only=True):
    """Two frames that collide.

    Attributes:
        gap_mm: Gap at rest [mm].
    """

    gap_mm: float

    @property
    def _where(self) -> str:
        left, right = self.frame_names
        return f"{left} beside {right} under {self.record}, gap {self.gap_mm:g} mm"


class Collision(_Pounding, tag="collision", frozen=True, kw_only=True):
    """Two frames that collide, with several impact laws (sections 5.2.2 and 6.3.2).

    Attributes:
        laws: Names of the laws, with the parameters that the thesis prints.
    """

    laws: tuple[str, ...]

    @property
    def title(self) -> str:
        """What is done, in words."""
        return f"{self._where}, {len(self.laws)} impact laws"


class ContactStiffness(_Pounding, tag="contact-stiffness", frozen=True, kw_only=True):
    """Two frames that collide, with several stiffnesses of the linear viscoelastic law (section 5.4).

    Attributes:
        sources: Rows of Table 5.1 as `pounding.contact.parameters.STIFFNESS_SETS` calls them.
    """

    sources: tuple[str, ...]

    @property
    def title(self) -> str:
        """What is done, in words."""
        return f"{self._where}, {len(self.sources)} contact stiffnesses"


AnyExperiment = FreeVibration | Push | SineSweep | Alone | Apart | Collision | ContactStiffness
