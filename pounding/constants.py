"""Constants that every package shares."""

STANDARD_GRAVITY = 9.80665
"""Standard gravity [m/s^2], exact by convention (3rd CGPM, 1901)."""

STD_PER_MAD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation [-], 1 / Phi^-1(3/4)."""
