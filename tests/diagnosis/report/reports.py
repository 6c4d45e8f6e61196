"""Reports of each kind, made by hand."""

from __future__ import annotations

from msgspec import structs

from pounding.diagnosis import Report
from pounding.diagnosis.decision.claims import Place, candidate, claim, parameter
from pounding.diagnosis.decision.conclusion import ContactMisfit
from pounding.diagnosis.decision.confidence import Basis, Features
from pounding.diagnosis.inference.misfit_map import Spot
from pounding.diagnosis.report.report import (
    ChannelMisfit,
    HeldOutMisfit,
    Misfit,
    Misfits,
    ModalRow,
)

FRICTION = Place(effect="coulomb_friction", frame="5B", storey=3)
DAMPING = Place(effect="damping_change", frame="5B", storey=3)
LAW = Place(effect="contact_law", contact=1)
FEATURES = Features("effect_named", 412.0, 380.0, 6.0, 0.97, 1)


def of_runs() -> Report:
    """Return a report on shaken frames: an effect that another cannot be told from, a dead channel among the rest."""
    size = parameter("friction_force", 12.1, 0.4, "N")
    return Report(
        verdict="effect_class",
        confidence=0.97,
        confidence_basis=Basis(calibration="some cases", features=FEATURES),
        effects=(claim(FRICTION, [size], 412.0, [FRICTION, DAMPING]),),
        misfit=Misfits(
            training=Misfit(before=0.31, after=0.021, noise_floor=0.02, explained=0.99),
            held_out=HeldOutMisfit(run="run3.csv", before=0.35, after=0.024, noise_floor=0.02),
        ),
        where=(Spot(channel="5B_a3", run="run2.csv", window_s=(1.2, 2.9), band_hz=(5.0, 8.0), misfit=0.44),),
        candidates=(candidate(FRICTION, 412.0), candidate(DAMPING, 405.0)),
        warnings=("a1 is clipped",),
        channels=(ChannelMisfit(channel="a1", before=None, after=None, noise_floor=None),),
    )


def of_a_pair() -> Report:
    """Return a report on frames that pound, whose contact has another law than believed."""
    sizes = [parameter("law", "hertz", None, "-"), parameter("stiffness", 1e9, float("nan"), "N/m^1.5")]
    report = structs.replace(of_runs(), verdict="effect_named", effects=(claim(LAW, sizes, 60.0),))
    impacts = ContactMisfit(impacts=9, before=5.0, after=1.1)
    return structs.replace(report, misfit=structs.replace(report.misfit, contact=impacts))


def of_modal_data() -> Report:
    """Return a report on modal data alone, of which one effect acts in a single test."""
    only = structs.replace(Place(effect="hysteresis", frame="5B"), test="free_vibration")
    size = parameter("first_mode_stiffness_change", -0.08, 0.01, "1")
    row = ModalRow(
        frame="5B", quantity="frequency", mode=1, test="hammer", measured=6.5, std=0.03,
        baseline=6.9, fitted=6.5, predicted=None, surprise=None,
    )  # fmt: skip
    errors = HeldOutMisfit(
        run="each number predicted from the others", before=0.06, after=0.01, noise_floor=0.005
    )
    return Report(
        verdict="effect_named",
        confidence=0.8,
        confidence_basis=Basis(calibration="posterior probability"),
        effects=(claim(only, [size], 12.0),),
        misfit=Misfits(training=Misfit(before=0.04, after=0.005, noise_floor=0.005), held_out=errors),
        where=(),
        candidates=(candidate(only, 12.0),),
        warnings=(),
        modal=(row,),
    )
