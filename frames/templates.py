"""Frame files to begin with: every key with a value that works and a word on what it is."""

from __future__ import annotations

from typing import Literal

Kind = Literal["stick", "plate"]

STICK = """\
# A building as a stick: one mass a floor, one spring a storey. Change the numbers; what begins with '#' may be left out.
# Try it: pounding modal THIS_FILE, then pounding shake THIS_FILE --record elcentro-chopra
kind = "stick"
name = "NAME"
title = ""                                    # one line on what it is
storeys = 4
storey_height_m = [4.0, 3.2, 3.2, 3.2]        # or one number for all
floor_mass_kg = [310e3, 290e3, 290e3, 250e3]  # from the first floor to the roof, or one number for all
frequency_hz = [1.1, 3.2]                     # measured or computed, the lowest first; one is enough
# storey_stiffness_n_per_m = [2e8, 2e8, 2e8, 2e8]   # in the place of frequency_hz
# stiffness_ratio = 2.0                       # a tall building that bends and shears, with one frequency
damping_ratio = [0.03, 0.04]                  # fractions of critical, one a mode, or one number for all
# damping_beyond = "caughey"                  # of the modes above: not the last ratio, but (of two) Rayleigh's damping
plan_m = [24.0, 15.0]                         # length along the shaking, width
# yielding = { storey_shear_n = [2.2e6, 1.9e6, 1.4e6, 0.8e6], hardening_ratio = 0.05 }   # storeys that yield
# torsion = { eccentricity_m = 2.0, frequency_ratio = 1.3 }   # floors that turn: the walls stand off the middle
# scale = "1:30"                              # a model of a building; without this line it is the building itself
slab = { thickness_m = 0.20 }                 # for the contact with a neighbour: concrete, 30 GPa
"""

PLATE = """\
# A frame of floors and columns, as plates and thin strips of finite elements. Change the numbers.
# Try it: pounding modal THIS_FILE, then pounding shake THIS_FILE --record elcentro-chopra
kind = "plate"
name = "NAME"
title = ""                       # one line on what it is
scale = "1:30"                   # of a building; records are compressed in time by its root
storeys = 5
storey_height_m = 0.1
damping_ratio = 0.005            # a fraction of critical: 0.5 %

[plate]                          # all floors
length_m = 0.4                   # along the shaking
width_m = 0.4
thickness_m = 0.005

[columns]                        # strips, thin along the shaking; one at each corner
width_m = 0.04
thickness_m = 0.002

[material]                       # steel
youngs_modulus_gpa = 200.0
poissons_ratio = 0.3
density_kg_per_m3 = 7850.0
yield_stress_mpa = 280.0

[joints]                         # rotational stiffness of one joint between column and floor; fit it to a first frequency
default = "assumed"
stiffness_n_m_per_rad = { assumed = 1000.0 }
"""


def template(kind: Kind, name: str) -> str:
    """Return the text of a frame file that can be built as it stands.

    Args:
        kind: ``stick`` or ``plate``.
        name: Name of the frame.
    """
    return {"stick": STICK, "plate": PLATE}[kind].replace("NAME", name, 1)
