"""Check the second world of hidden cases against what it is said to be (`make second-world`; needs openseespy).

Not part of the tests: openseespy is no dependency, and no test may be left out for want of it. Prints one line a
check; the exit status is 1 where one fails.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from pounding import frames
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden import scenario as own
from pounding.diagnosis.hidden.contacts import STIFFNESS, Touch
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.modes import frequencies_hz
from pounding.diagnosis.hidden.motions import Motion, draw
from pounding.diagnosis.hidden.opensees import building, materials
from pounding.diagnosis.hidden.opensees.domain import Domain
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame, plane_frame
from pounding.diagnosis.hidden.opensees.shaking import Link, PlaneScenario, happen
from pounding.diagnosis.hidden.rigging import Rig, draw_rig
from pounding.diagnosis.hidden.scenario import observed
from pounding.diagnosis.hidden.worlds import SECOND
from pounding.diagnosis.hidden.writing import write_hidden

Told = Iterator[tuple[str, float, float]]
"""What was checked, what was found, and what it may be at most."""

NAMES = ("5A", "5B", "10", "15A", "15B")
STEP_S, CYCLES, AMPLITUDE_M = 5e-4, 2, 4e-3


def tuning() -> Told:
    """The first frequency is the baseline's, also with model errors; the second and third are near to it."""
    for name in NAMES:
        believed = np.asarray(frames.build(frames.load(name)).frequencies_hz[:3])
        wrong = building.drawn_errors(np.random.default_rng(1), plane_frame(name).storeys)
        for label, frame in (
            (name, plane_frame(name)),
            (f"{name} with errors", wrong.on(plane_frame(name), 2.0)),
        ):
            off = np.abs(frequencies_hz(frame, 3) / believed - 1)
            yield f"first frequency of {label}", off[0], 2e-3
            yield f"second and third frequency of {label}", float(off[1:].max()), 0.05


def pulse(duration_s: float) -> Motion:
    """A push of a twentieth of a second, then nothing."""
    time = STEP_S * np.arange(round(duration_s / STEP_S))
    return Motion("pulse", STEP_S, np.where(time < 0.05, np.sin(np.pi * time / 0.05) ** 2, 0.0))


def first_mode(frame: PlaneFrame) -> tuple[np.ndarray, np.ndarray]:
    """The roof's motion in the first mode after a pulse: its envelope's times [s] and heights."""
    moved = happen(PlaneScenario({frame.name: frame}), pulse(3.0), 0).displacement
    shape = np.linalg.eigh(np.cov(moved))[1][:, -1]
    along = shape @ moved
    peaks = np.flatnonzero((along[1:-1] > along[:-2]) & (along[1:-1] > along[2:]) & (along[1:-1] > 0)) + 1
    time = STEP_S * peaks
    return time[time > 0.3], along[peaks][time > 0.3]


def decay() -> Told:
    """An undamped frame keeps its amplitude; a damped one loses what its first damping ratio says."""
    for seed in (1, 2, 3):
        frame = building.built(np.random.default_rng(seed), "5B")
        kind = "modal" if frame.modal.size else "Rayleigh"
        for label, one, ratio in (
            ("without damping", replace(frame, rayleigh=(0.0, 0.0), modal=np.zeros(0)), 0.0),
            (f"with {kind} damping", frame, float(frame.ratios[0])),
        ):
            time, height = first_mode(one)
            rate = -np.polyfit(time, np.log(height), 1)[0]
            found = rate / (2 * np.pi * frequencies_hz(one, 1)[0])
            yield f"damping ratio of 5B {label}", abs(found - ratio), 3e-4
        circular = 2 * np.pi * frequencies_hz(frame, 12)
        alpha, beta = frame.rayleigh
        least = frame.ratios[:12].min() / frame.ratios[0]
        yield (
            f"least damping of twelve modes, seed {seed}, over the first's, missing",
            max(0.2 - least, 0.0),
            0.0,
        )
        assert beta > 0
        assert len(circular) == 12
        assert alpha >= 0


def alone() -> Told:
    """A frame without any law is what the modal solver of the own world makes of the same matrices."""
    shaking = draw(np.random.default_rng(5), 1, 2.0, 1 / 4000, "artificial")[0]
    for seed in (1, 2):
        frame = building.built(np.random.default_rng(seed), "5A")
        scenario = PlaneScenario({"5A": frame}, table_gain=0.01, table_tilt=1e-3)
        ours, theirs = own.happen(scenario, shaking, 0), happen(scenario, shaking, 0, parts=3)
        for name in ("displacement", "velocity", "acceleration"):
            one, other = getattr(ours, name), getattr(theirs, name)
            off = np.sqrt(np.mean((one - other) ** 2, axis=1)) / other.std(axis=1)
            yield f"{name} of 5A, seed {seed}, against the modal solver", float(off.max()), 0.01


def loop(law: materials.Law, period_s: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deformation [m], its rate [m/s] and force [N] of a law between two nodes, one of which is moved."""
    domain, step = Domain(), 1e-4
    ops = domain.ops
    time = step * np.arange(round(CYCLES * period_s / step) + 1)
    moved = AMPLITUDE_M * np.sin(2 * np.pi * time / period_s) * np.minimum(time / (0.25 * period_s), 1.0)
    rate = np.gradient(moved, step)
    low, high = domain.node(0.0, 0.0, (1, 1, 1)), domain.node(0.0, 0.0, (0, 1, 1))
    # OpenSees ends the process where nothing at all is free.
    idle = domain.node(0.0, 0.0, (0, 1, 1))
    ops.mass(idle, 1.0, 0.0, 0.0)
    domain.spring(low, idle, 1, "Elastic", 1.0)
    if isinstance(law, materials.Slider):
        from pounding.diagnosis.hidden.opensees.shaking import press, slide

        ops.remove("sp", high, 2)
        elements, sign = [slide(domain, law, low, high)], 1.0
        press(domain, [high])
    else:
        ends, sign = ((high, low), -1.0) if law.mirrored else ((low, high), 1.0)
        elements = [domain.spring(*ends, 1, *part) for part in law.parts]
    series = [domain.path(values, step) for values in (np.gradient(rate, step), rate, moved)]
    pattern, ground = domain.number(), domain.number()
    ops.pattern("MultipleSupport", pattern)
    ops.groundMotion(ground, "Plain", "-accel", series[0], "-vel", series[1], "-disp", series[2])
    ops.imposedMotion(high, 1, ground)
    domain.move()
    force = np.zeros(len(time))
    for index in range(1, len(time)):
        if not domain.step(1, step):
            raise CaseError(f"a static cycle loses its equilibrium at {time[index]:g} s")
        if isinstance(law, materials.Slider):
            force[index] = ops.eleForce(elements[0], 4)
        else:
            force[index] = sign * sum(ops.eleResponse(one, "material", 1, "stress")[0] for one in elements)
    ops.wipe()
    return moved, rate, force


def laws() -> Told:
    """Every law's loop is its definition."""
    k, a = 1e4, AMPLITUDE_M
    d, _, f = loop(materials.curve(lambda x: 1e9 * x**3, 5 * a))
    yield "cubic spring", float(np.abs(f - 1e9 * d**3).max() / np.abs(f).max()), 2e-3
    d, _, f = loop(materials.curve(lambda x: -k * x / (1 + (x / 1e-3) ** 2) ** 2, 30e-3))
    expected = -k * d / (1 + (d / 1e-3) ** 2) ** 2
    yield "magnets", float(np.abs(f - expected).max() / np.abs(expected).max()), 0.02
    for power in (1.0, 1.7, 2.3):
        _, v, f = loop(materials.viscous(20.0, power))
        expected = 20.0 * np.sign(v) * np.abs(v) ** power
        yield f"drag of power {power:g}", float(np.abs(f - expected)[5:].max() / np.abs(expected).max()), 5e-3
    for side in (-1.0, 1.0):
        d, _, f = loop(materials.progressive_stop(side * 1e-3, k, 5e-4))
        depth = np.maximum(side * d - 1e-3, 0.0)
        expected = (
            k * side * np.interp(depth, [0, 5e-4, 1e-3, 1.0], [0, 2.5e-4, 7.5e-4, 7.5e-4 + 2 * (1 - 1e-3)])
        )
        yield (
            f"progressive stop, side {side:+g}",
            float(np.abs(f - expected).max() / np.abs(expected).max()),
            1e-6,
        )
        d, v, f = loop(materials.lossy_stop(side * 1e-3, k, 1e-3))
        depth = np.maximum(side * d - 1e-3, 0.0)
        expected = np.where(depth > 0, side * k * depth + 1e-3 * k * v, 0.0)
        # Where it would pull, it lets go.
        inside = (depth > 0) & (side * expected > 0)
        yield f"lossy stop, side {side:+g}", float(np.abs(f - expected)[inside].max() / np.abs(f).max()), 0.01
        yield f"lossy stop, side {side:+g}, open", float(np.abs(f[side * d < 0.9e-3]).max()), 1e-9
    d, _, f = loop(materials.tie(2e-3, k))
    yield "tie", float(np.abs(f - k * np.maximum(d - 2e-3, 0)).max() / np.abs(f).max()), 1e-6
    yield from yielding(k)
    yield from sliding(k)


def yielding(k: float) -> Told:
    """The two hysteretic laws: elastic when small, their force when large, closed loops that lose energy."""
    d, _, f = loop(materials.steel(10.0, k, 0.01, 15.0))
    whole = f + k * d
    yield (
        "Menegotto-Pinto, largest force",
        abs(np.abs(whole).max() / (10.0 + 0.01 * k * (AMPLITUDE_M - 1e-3)) - 1),
        0.03,
    )
    small = np.flatnonzero(np.abs(d) < 1e-4)[:50]
    yield "Menegotto-Pinto, first stiffness", float(np.abs(f[small]).max() / (k * 1e-4)), 0.03
    d, _, f = loop(materials.ramberg_osgood(10.0, k, 0.2, 8.0))
    whole = f + k * d
    forces = np.linspace(0.1, 17, 400)
    expected = float(np.interp(AMPLITUDE_M, forces / k * (1 + 0.2 * (forces / 10) ** 7), forces))
    yield "Ramberg-Osgood, largest force", abs(np.abs(whole).max() / expected - 1), 0.02
    half = len(d) // 2
    energy = float(np.sum(0.5 * (whole[half + 1 :] + whole[half:-1]) * np.diff(d[half:])))
    # Masing: the area of a loop from the curve of twice its size.
    backbone = np.linspace(0, expected, 2000)
    along = backbone / k * (1 + 0.2 * (backbone / 10) ** 7)
    area = float(np.sum(0.5 * (backbone[1:] + backbone[:-1]) * np.diff(along)))
    yield "Ramberg-Osgood, Masing's loop", abs(energy / (8 * area - 4 * AMPLITUDE_M * expected) - 1), 0.05


def sliding(k: float) -> Told:
    """The slider: its level where it slides fast, its breakaway where it turns round, an elastic start."""
    d, v, f = loop(materials.Slider(5.0, 30 * k, 1.2, 2e-3))
    fast = (np.abs(v) > 15e-3) & (np.abs(f) > 4.0)
    yield "friction, sliding fast", float(np.abs(np.abs(f[fast]) / 5.0 - 1).max()), 0.01
    yield "friction, breakaway", abs(np.abs(f).max() / 6.0 - 1), 0.03
    stuck = np.abs(f) < 2.0
    stiffness = np.diff(f)[stuck[1:]] / np.diff(d)[stuck[1:]]
    yield "friction, stiffness while stuck", abs(float(np.median(stiffness)) / (30 * k) - 1), 0.01


def contacts() -> Told:
    """Two frames that cannot meet do not; where they meet, the undamped law gives every impulse back smoothly."""
    pair = {name: building.built(np.random.default_rng(3), name) for name in ("10", "5B")}
    shaking = draw(np.random.default_rng(5), 1, 1.0, 1 / 8000, "artificial")[0]
    free = happen(PlaneScenario(pair), shaking, 0, parts=1)
    rows = [PlaneScenario(pair).row(name, 5) for name in pair]
    near = float((free.displacement[rows[0]] - free.displacement[rows[1]]).max())
    for law, stiffness in STIFFNESS.items():
        damped = {"restitution": 0.7} if law not in ("linear_spring", "hertz") else {}
        far, close = (
            happen(
                PlaneScenario(pair, touches=(Touch("10", "5B", 5, gap, law, stiffness, **damped),)),
                shaking,
                0,
                parts=1,
            )
            for gap in (1.01 * near, 0.5 * near)
        )
        yield f"{law}, out of reach, force [N]", float(np.abs(far.contact_force).max()), 0.0
        moved = close.displacement[rows[0]] - close.displacement[rows[1]] - 0.5 * near
        force = close.contact_force[0]
        # The force is the mean over a step: apart is what is so at both its ends, by more than a step's way.
        apart = np.maximum(moved, np.roll(moved, 1)) < -1e-4
        yield f"{law}, force where the floors are apart [N]", float(force[apart].max()), 1e-9
        yield f"{law}, did not touch", float(force.max() <= 10.0), 0.0


def rubbed(duration_s: float) -> Link:
    """Friction in a storey of 5A."""
    return Link("5A", 3, 2, materials.Slider(0.4, 3e6, 1.2, 5e-3))


def nothing() -> Told:
    """What hangs between two floors and does nothing changes nothing, however the frame is damped."""
    pushed = pulse(2.0)
    idle = (
        ("spring", lambda _: Link("10", 5, 4, materials.Materials((("Elastic", 1e-6),)))),
        ("slider", lambda _: Link("10", 5, 4, materials.Slider(1e-6, 1e-3, 1.2, 2e-3))),
    )
    for seed in (1, 2):
        frame = building.built(np.random.default_rng(seed), "10")
        bare = PlaneScenario({"10": frame})
        without = happen(bare, pushed, 0, parts=1).acceleration
        for what, link in idle:
            held = happen(replace(bare, links=(link,)), pushed, 0, parts=1).acceleration
            kind = "modal" if frame.modal.size else "Rayleigh's"
            yield (
                f"an idle {what} in a frame with {kind} damping",
                float((held - without).std() / without.std()),
                1e-4,
            )


def convergence() -> Told:
    """Half the step changes no channel of a run by more than 2 % of its motion: what it moves are upper frequencies."""
    without = replace(SECOND, settle=None)
    for name, friction in (("5A", False), ("5A", True), ("15A", False), ("15B", False)):
        rig: Rig = draw_rig(np.random.default_rng(2), [name], "artificial", 4.0, world=without, noise=0.005)
        scenario = rig.bare
        if friction:
            scenario = replace(scenario, links=(rubbed,))
        one, other = (
            observed(scenario, happen(scenario, rig.shakings[0], 0, parts=number), rig.channels)
            for number in (1, 2)
        )
        responses = slice(1, None)
        off = np.sqrt(np.mean((one - other) ** 2, axis=0))[responses] / other.std(axis=0)[responses]
        yield (
            f"half the step, {name}{' with friction' if friction else ''}, over the motion",
            float(off.max()),
            0.02,
        )


def cases() -> Told:
    """A seed is a case, a case can be read, and its truth says what its model error is."""
    asked = {"seed": 4, "source": "artificial", "duration_s": 1.0, "engine": "opensees", "noise": 0.01}
    one, two = (hide(["bumper:2"], ["5A"], visibility=5.0, **asked) for _ in range(2))
    same = all(np.array_equal(a.values, b.values) for a, b in zip(one.case.runs, two.case.runs, strict=True))
    yield "a seed makes two cases", float(not same), 0.0
    with tempfile.TemporaryDirectory() as folder:
        write_hidden(one, Path(folder, "case"), Path(folder, "truth.json"))
        again = read_case(Path(folder, "case"))
    off = np.abs(again.runs[0].values - one.case.runs[0].values) / one.case.runs[0].values.std(axis=0)
    yield "a case that was read again", float(off.max()), 1e-4
    error = one.truth["model_error"]
    yield "model error beyond what is drawn", max(error["misfit"] / 0.055 - 1, 0.0), 0.0


CHECKS: dict[str, Callable[[], Told]] = {
    check.__name__: check for check in (tuning, decay, alone, laws, contacts, nothing, convergence, cases)
}


def main() -> None:
    """Run the checks that are named, all without a name; the exit status is 1 where one fails."""
    names = sys.argv[1:] or list(CHECKS)
    if unknown := [name for name in names if name not in CHECKS]:
        sys.exit(f"second_world: no check {unknown[0]!r}; there are {', '.join(CHECKS)}")
    try:
        SECOND.require and SECOND.require()
    except CaseError as error:
        sys.exit(f"second_world: {error}")
    failed = 0
    for name in names:
        for what, found, most in CHECKS[name]():
            wrong = not found <= most
            failed += wrong
            print(
                f"{'FAILED' if wrong else 'ok':6} {name}: {what}: {found:.3g} (at most {most:g})", flush=True
            )
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
