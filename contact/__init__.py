"""Impact laws: what two bodies that touch do to each other.

`laws` has the five laws, `parameters` the thesis' values for them, `stiffness` and `damping` the formulas
behind those, `stereo` the impact that takes no time, `collision` two free bodies that collide, and
`connector` brings a law into exudyn.
"""

from pounding.contact.collision import Collision, collide
from pounding.contact.errors import ContactError
from pounding.contact.laws import (
    BUILT_IN,
    Hertz,
    HertzDamp,
    Law,
    LinearSpring,
    LinearViscoelastic,
    NonlinearViscoelastic,
    law_class,
    names,
)
from pounding.contact.parameters import make_law, thesis_law, viscoelastic_of

__all__ = [
    "BUILT_IN",
    "Collision",
    "ContactError",
    "Hertz",
    "HertzDamp",
    "Law",
    "LinearSpring",
    "LinearViscoelastic",
    "NonlinearViscoelastic",
    "collide",
    "law_class",
    "make_law",
    "names",
    "thesis_law",
    "viscoelastic_of",
]
