"""The four motions of the shaking-table tests: what a file must be before it is called by their names.

The samples themselves are not here: their providers do not let everyone redistribute them. What stands here
are their counts, steps and peaks, the hash of their samples, and the extremes of a few oscillators, by which
the same motion is known again when it was printed with other digits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import Record

FINGERPRINT_DAMPING = 0.02
PEAK_TOLERANCE_G = 0.001
"""The peaks of the table are given to three decimals in g, and a file may be as well."""
OSCILLATOR_TOLERANCE = 0.002
"""Of the larger extreme: four printed digits move an oscillator by less, another processing by more."""


@dataclass(frozen=True)
class Reference:
    """What a motion of the tests is known by.

    Attributes:
        title: Event and component.
        samples: Number of samples.
        step_s: Full-scale time step [s].
        pga_g: Peak [g], to three decimals.
        sha256: Of the samples in m/s^2 as little-endian float64.
        extremes_mm: By period [s], largest and smallest displacement of an oscillator with 2 % damping [mm].
        obtain: Where a user gets it.
    """

    title: str
    samples: int
    step_s: float
    pga_g: float
    sha256: str
    extremes_mm: dict[float, tuple[float, float]]
    obtain: str

    def __repr__(self) -> str:
        return (
            f"Reference({self.title!r}, {self.samples} samples at {self.step_s:g} s, peak {self.pga_g:g} g)"
        )


_BENCHMARK = (
    "the ground motions of the structural control benchmark (Ohtori, Christenson, Spencer and Dyke 2004,"
    " J. Eng. Mech. 130(4))"
)

REFERENCES = {
    "elcentro": Reference(
        "Imperial Valley 1940, El Centro, NS",
        2501,
        0.02,
        0.348,
        "9b839176b4a5ac46766d9ddddf2e14066f94b3a4e2cd9028e62a8e71c20d28c8",
        {
            0.2: (8.609, -9.074),
            0.5: (63.207, -58.0),
            1.0: (161.079, -167.88),
            2.0: (212.206, -224.372),
        },
        f"it is among {_BENCHMARK}",
    ),
    "hachinohe": Reference(
        "Tokachi-oki 1968, Hachinohe, NS",
        3601,
        0.01,
        0.229,
        "be9e90db9c6c87d075a748b2e644e304da12d03e9a50e37b82fed71723726925",
        {
            0.2: (4.877, -6.139),
            0.5: (22.217, -24.754),
            1.0: (126.067, -130.234),
            2.0: (266.216, -246.856),
        },
        f"it is among {_BENCHMARK}; the original is PARI's (Port and Airport Research Institute, Japan)",
    ),
    "northridge": Reference(
        "Northridge 1994, Sylmar County Hospital, NS",
        3000,
        0.02,
        0.843,
        "73f3f9f40a7776826a557328287d60aaeb1ed79b27e252aa8a69dd349395e42d",
        {
            0.2: (12.459, -13.692),
            0.5: (140.277, -145.064),
            1.0: (216.411, -238.095),
            2.0: (712.124, -626.911),
        },
        f"it is among {_BENCHMARK}; PEER's RSN1086 SYL360 is the same shaking in another processing",
    ),
    "kobe": Reference(
        "Hyogo-ken Nanbu 1995, Kobe JMA, NS",
        7500,
        0.02,
        0.834,
        "64d1c1893b68ea2773dfacb067d5d5d90e6171fb8c2532e41e36ed38335c43fc",
        {
            0.2: (11.38, -9.639),
            0.5: (175.382, -172.818),
            1.0: (426.989, -375.987),
            2.0: (415.338, -398.007),
        },
        f"it is among {_BENCHMARK}; PEER has the shaking as RSN1106 KJM000",
    ),
}
"""By reserved name; a file may only be called by one of these names if `verified` lets it."""

RECORDS = tuple(REFERENCES)
"""Names of the four motions, in the order of the thesis' tables."""


def verified(name: str, record: Record) -> Record:
    """Return the record under a reserved name, if it is that motion.

    It is, if its step and the hash of its samples are those of the table. It also is, and its history says
    so, if number of samples and step are the table's, the peak agrees within 0.001 g (the table rounds)
    and the extremes of four oscillators within 0.2 %, with their signs, so that a reversed polarity is
    noticed: the same samples printed with other digits or in another unit. Anything else, also the same
    shaking in another processing, is refused.

    Raises:
        ExperimentError: It is another motion; the message names what differs.
    """
    reference = REFERENCES[name]
    if record.sha256 == reference.sha256 and _same_step(reference, record):
        return record.renamed(name)
    wrong = list(_differences(reference, record))
    if wrong:
        raise ExperimentError(
            f"{record.source} is not the test's '{name}' ({reference.title}): {'; '.join(wrong)};"
            f" use the right file ({reference.obtain}), or give this one a name of its own"
        )
    note = f"known as '{name}' by count, step, peak and oscillators; its digits differ"
    return record.renamed(name, note)


def _same_step(reference: Reference, record: Record) -> bool:
    return abs(record.step_s / reference.step_s - 1) <= 1e-6


def _differences(reference: Reference, record: Record) -> Iterator[str]:
    count = len(record.acceleration_m_s2)
    if count != reference.samples:
        yield f"{count} samples instead of {reference.samples}"
    if not _same_step(reference, record):
        yield f"step {record.step_s:.6g} s instead of {reference.step_s:.6g} s"
    if abs(record.pga_g - reference.pga_g) > PEAK_TOLERANCE_G:
        yield f"peak {record.pga_g:.4f} g instead of {reference.pga_g:.3f} g"
    from pounding.experiments.records.spectra import oscillator_extremes  # only here: it takes half a second

    for period, expected in reference.extremes_mm.items():
        found = [1e3 * value for value in oscillator_extremes(record, period, FINGERPRINT_DAMPING)]
        allowed = OSCILLATOR_TOLERANCE * max(map(abs, expected))
        if any(abs(a - b) > allowed for a, b in zip(found, expected, strict=True)):
            yield (
                f"an oscillator of {period:g} s moves {found[0]:.1f} and {found[1]:.1f} mm instead of"
                f" {expected[0]:.1f} and {expected[1]:.1f} mm"
            )
            return
