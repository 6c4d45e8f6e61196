"""A block of rubber between two floors: soft at first, stiffer the flatter it is pressed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pounding.contact.damping import hertz_damp_ratio
from pounding.contact.errors import ContactError
from pounding.contact.laws import Law

SOFT_PA = 5e6
"""Apparent modulus E_a of a soft rubber between plates under compression [Pa]; by Gent and Lindley (1959) it is
E (1 + 2 S^2) for a block with the shape factor S, about 2 MPa (1 + 2 S^2) for a soft one."""

FLAT = 0.8
"""Share of its thickness by which a block is compressed when it counts as flat [-]; from there its force rises straight."""


@dataclass(frozen=True)
class RubberBlock(Law):
    """A block of rubber under compression, with the stress of the statistical theory of rubber (Treloar 1975, section 4.6).

    stiffness E_a A / t [N/m] of the unloaded block, thickness_m t [m], restitution [-]. With the stretch
    l = 1 - deformation / t the elastic force is E_a A (l^-2 - l) / 3. Beyond `FLAT` of the thickness it goes on along its
    tangent, for there the floors themselves begin to press. The loss is that of `HertzDamp`: a dashpot in
    proportion to the elastic force, of which the first-order loss does not depend on the spring's shape.
    """

    thickness_m: float = 0.05
    restitution: float = 0.5
    slowest_approach: float = 1e-3

    name: ClassVar[str] = "rubber_block"
    listed: ClassVar[bool] = (
        False  # a street's bumper says thickness and area; a stiffness alone makes no block
    )
    latches: ClassVar[bool] = True

    @classmethod
    def of(
        cls, area_m2: float, thickness_m: float, modulus_pa: float = SOFT_PA, restitution: float = 0.5
    ) -> RubberBlock:
        """Return a block by its size.

        Args:
            area_m2: Its area [m^2].
            thickness_m: Its thickness [m].
            modulus_pa: Apparent modulus of the rubber [Pa].
            restitution: Coefficient of restitution [-].

        Raises:
            ContactError: A size that cannot be.
        """
        if not thickness_m > 0:
            raise ContactError(f"{cls.name}: thickness_m is {thickness_m:g} m; it must be positive")
        return cls(modulus_pa * area_m2 / thickness_m, thickness_m=thickness_m, restitution=restitution)

    def __post_init__(self) -> None:
        super().__post_init__()
        hertz_damp_ratio(self.restitution)  # refuses what cannot be
        if self.thickness_m <= 0:
            raise ContactError(f"{self.name}: thickness_m is {self.thickness_m:g} m; it must be positive")

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Elastic force with a dashpot in proportion to it [N]."""
        whole, thin = self.stiffness * self.thickness_m / 3.0, 1.0 - FLAT
        stretch = xp.maximum(1.0 - deformation / self.thickness_m, thin)
        beyond = xp.maximum(deformation - FLAT * self.thickness_m, 0.0)
        tangent = self.stiffness * (2.0 * thin**-3 + 1.0) / 3.0
        elastic = whole * (xp.power(stretch, -2.0) - stretch) + tangent * beyond
        relative = rate / xp.maximum(approach, self.slowest_approach)
        return elastic * (1.0 + hertz_damp_ratio(self.restitution) * relative)
