"""The scale of a frame: its length over its building's, and what follows for everything else.

The similitude is that of the thesis (section 3.7 and equation 7.15, after Tabatabaiefar and Mansoury 2016): model and
building feel the same accelerations, gravity among them. With the length scale s, times go with s^(1/2), velocities
with s^(1/2), frequencies with s^(-1/2). The material of the thesis' frames is the building's, so masses and forces go
with s^3.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from pounding import bounds
from pounding.errors import InputError

RATIO = re.compile(r"\s*1\s*:\s*([0-9]*\.?[0-9]+)\s*")
SAME = 5e-3
"""Two scales closer than this share are one: 0.0333 is 1:30."""


@dataclass(frozen=True)
class Scale:
    """A length scale and its similitude.

    Attributes:
        length: Length of the model over that of the building [-]; 1 is full scale.
    """

    length: float

    @property
    def time_factor(self) -> float:
        """Model time over the building's time [-]: what the time of a record is multiplied by."""
        return math.sqrt(self.length)

    @property
    def force(self) -> float:
        """Model force over the building's force [-], for one density and one acceleration."""
        return self.length**3

    @property
    def buildings_length(self) -> float:
        """Length of the building over that of the model [-]."""
        return 1.0 / self.length

    def is_near(self, other: Scale) -> bool:
        """Return whether another scale is this one, but for the digits it is written with."""
        return math.isclose(self.length, other.length, rel_tol=SAME)

    def __str__(self) -> str:
        """Return ``full scale``, or the ratio as in ``1:30``."""
        return "full scale" if self.length == 1.0 else f"1:{self.buildings_length:.4g}"


FULL_SCALE = Scale(1.0)
THESIS = Scale(1 / 30)
"""The frames of the thesis and its contacts (section 3.7: 1/30 in length, 0.182 in time)."""


def scale_of(stated: str | float, what: str, error: type[InputError] = InputError) -> Scale:
    """Return the scale that a file or an option states.

    Args:
        stated: A ratio like ``"1:30"``, or the number that it stands for.
        what: What is stated, the subject of a message.
        error: What is raised.

    Raises:
        InputError: It is neither, not positive, or above 1.
    """
    if isinstance(stated, str):
        ratio = RATIO.fullmatch(stated)
        if ratio is None or not float(ratio[1]) > 0.0:
            raise error(
                f'{what} is {stated[:40]!r}; write it as "1:30", model length to the building\'s, or as a number'
            )
        stated = 1.0 / float(ratio[1])
    bounds.SCALE.check(stated, what, error)
    return Scale(float(stated))


def of_time_factor(time_factor: float) -> Scale:
    """Return the scale whose records have their time multiplied by a factor [-]."""
    return Scale(time_factor**2)
