"""Candidates of the user's own: an effect outside the catalogue is unknown without them and named with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.decision.conclusion import parameters
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.effects.candidate_file import read_candidates
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.effects.user import user_kinds
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.evidence import scales
from pounding.diagnosis.inference.filtering import run_filter, run_signatures, whitened
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.misfit import simulate
from pounding.diagnosis.inference.motions import motions
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import Observations, RunData, root_mean_square
from pounding.diagnosis.model.predictor import ACCELERATION, DISPLACEMENT
from pounding.diagnosis.model.twin import simulate_engine
from tests.diagnosis.models import STEP_S, measured, shaking, three_storeys

FILE = """
import math

def stroke_damper(d, v, t, damping: "N s/m" = 100):
    '''A damper that grips on one side only.'''
    return damping * v if d > 0 else 0.0

def slack_tie(d, v, t, stiffness: "N/m" = 2e4, slack: "mm" = (0.5, 4)):
    beyond = abs(d) - slack
    return math.copysign(stiffness * beyond, d) if beyond > 0 else 0.0

def guy_rope(u, v, t, stiffness: "kN/m" = 3):
    return stiffness * max(u, 0.0)
"""


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> list[type[Effect]]:
    file = tmp_path_factory.mktemp("own") / "candidates.py"
    file.write_text(FILE)
    return user_kinds(read_candidates(file))


def hidden(storey: int, damping: float, noise: float = 0.02) -> Model:
    """Measurements of the bench with a one-sided damper in a storey, made by scipy's own integrator."""
    structure = three_storeys()
    frame = structure.frames[0]
    squares, shapes = np.linalg.eigh(frame.stiffness / 6.5)
    viscous = 6.5 * shapes @ np.diag(2 * 0.01 * np.sqrt(squares)) @ shapes.T
    rng = np.random.default_rng(3)
    runs = []
    for seed in (10, 11):
        table, time = 2 * shaking(2000, seed), STEP_S * np.arange(2000)
        spline = CubicSpline(time, table)

        def acceleration(y: np.ndarray) -> np.ndarray:
            drift, rate = frame.drift @ y[:3], frame.drift @ y[3:]
            force = damping * rate[storey] if drift[storey] > 0 else 0.0
            pull = frame.stiffness @ y[:3] + viscous @ y[3:] + force * frame.drift[storey]
            return np.asarray(-pull / 6.5)

        def rate_of(t: float, y: np.ndarray, a=acceleration, s=spline) -> np.ndarray:  # type: ignore[no-untyped-def]
            return np.concatenate([y[3:], a(y) - s(t)])

        found = solve_ivp(
            rate_of, (0, time[-1]), np.zeros(6), t_eval=time, rtol=1e-6, atol=1e-9, max_step=1e-3
        )
        output = np.array([np.concatenate([acceleration(y), y[[0, 2]]]) for y in found.y.T])
        output += noise * output.std(axis=0) * rng.standard_normal(output.shape)
        runs.append(RunData(f"run{seed}.csv", STEP_S, time, table, output, np.zeros((2000, 0))))
    kinds_of = np.array([ACCELERATION] * 3 + [DISPLACEMENT] * 2)
    channels = ("a1", "a2", "a3", "d1", "d3")
    seen = Observations(channels, np.ones(5), kinds_of, np.array([0, 1, 2, 0, 2]), tuple(runs))
    return Model(structure, seen, Prior())


def found(model: Model, own: list[type[Effect]]) -> Findings:
    effects = [effect for effect in candidates(model) if effect.name != "joint_flexibility"]
    effects += [effect for kind in own for effect in places(kind, model)]
    return search(model, effects, [0], [1], lambda what, share: None)


@pytest.mark.slow
def test_what_nothing_in_the_catalogue_fits_is_named_once_the_user_offers_it(
    kinds: list[type[Effect]],
) -> None:
    model = hidden(storey=1, damping=150.0)
    assert decide(found(model, [])).verdict == "unknown_effect"
    with_own = found(model, kinds)
    decision = decide(with_own)
    assert decision.verdict == "effect_named"
    effect = decision.judged.effects[0]
    assert effect.place() | {"effect": "stroke_damper", "frame": "bench", "storey": 2} == effect.place()
    assert decision.judged.fit.values[0][0] == pytest.approx(150.0, rel=0.02)
    # The held-out gap falls from 15 % to the noise.
    assert decision.judged.misfit[1] == pytest.approx(0.02, rel=0.1)


def test_parameters_are_reported_in_the_users_units(kinds: list[type[Effect]]) -> None:
    case, nothing = None, None
    tie = kinds[1](index=0, frame="bench", storey=1)
    shown = parameters(case, nothing, tie, np.array([3e4, 2e-3]), np.array([1e3, 1e-4]))  # type: ignore[arg-type]
    assert [(one.name, round(float(one.value or 0), 6), one.unit) for one in shown] == [
        ("stiffness", 3e4, "N/m"),
        ("slack", 2.0, "mm"),
    ]


@pytest.mark.parametrize("number", [0, 1, 2])
def test_scoring_simulator_and_engine_are_the_same_function(kinds: list[type[Effect]], number: int) -> None:
    full = measured()
    runs = tuple(
        replace(run, table=run.table[:700], time_s=run.time_s[:700], measured=run.measured[:700],
                contact=run.contact[:700])
        for run in full.observed.runs[:1]
    )  # fmt: skip
    model = Model(full.structure, replace(full.observed, runs=runs), full.prior)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    effect = places(kinds[number], model)[1]
    shape = effect.grid(scales(model, filtered))[0]
    size = effect.size(model, scales(model, filtered), shape)
    motion = motions(model, filtered)[0]
    terms = effect.terms(model, filtered.modes, motion, shape)
    column = run_signatures(model, filtered, 0, [terms])[:, 0]

    def innovations(amplitude: float) -> np.ndarray:
        acting = [(effect, effect.values(amplitude, shape))]
        gains = filtered.gains
        series = model.predict(filtered.values, gains, acting, (0,)).innovations[0]
        return whitened(series, filtered.filters[0]).ravel()

    change = (innovations(0.01 * size) - innovations(0.02 * size)) / (0.01 * size)
    assert column @ change / np.linalg.norm(column) / np.linalg.norm(change) > 0.95

    nuisance, acting = np.zeros(len(model.std)), [(effect, effect.values(size, shape))]
    fast = simulate(model, nuisance, acting, [0])[0]
    engine = simulate_engine(model, nuisance, acting, [0])[0]
    error = root_mean_square(fast - engine) / root_mean_square(fast)
    without = root_mean_square(fast - simulate(model, nuisance, [], [0])[0]) / root_mean_square(fast)
    # A damper that switches at the zero of its drift does so at slightly different moments in the two.
    assert error.max() < 0.01
    assert without.max() > 3 * error.max()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def a(d, v, t, k=1.0): return k * d", "parameter 'k' has no unit"),
        ('def a(d, v, t, k: "N/m"): return k * d', "has no typical size"),
        ('def a(d, v, t, k: "N/furz" = 1.0): return k * d', 'the unit "N/furz" of \'k\' is not understood'),
        ('def a(d, v, t, k: "N/m^2" = 1.0): return k * d', "where a force in N is wanted"),
        ('def a(d, v, t, k: "N/m" = 1.0, g: "s" = 1.0): return k * (d - g)', "does not fit its units"),
        ('def a(d, v, t, k: "N/m" = 1.0): return k * d ** 0.5', "a gives nan at d = -0.05 m"),
        ('def a(d, v, t, k: "N/m" = 1.0): return k * helper(d)', "a does not compile: NameError"),
        ('def a(d, v, t, k: "N/m" = 1.0): return [k * d, ""]', "a does not compile"),
        ('def a(x, v, t, k: "N/m" = 1.0): return k * x', "the first three arguments must be d (drift) or u"),
        ('def a(d, v, t): return d', "it may have 1 to 5"),
        ('def a(d, v, t, F: "N" = 1.0, k: "N/m" = 30.0): return min(F, k * d)', "not proportional to the first"),
        ('def a(d, v, t, k: "N/m" = 1.0, g: "m" = 1.0): return k * max(d - g, 0.0)', "gives no force"),
        ('def a(d, v, t, k: "N/m" = 0): return k * d', "write a number other than 0"),
        ('def a(d, v, t, k: "N/m" = (3, 1)): return k * d', "must go from low to high"),
        ('def bumper(d, v, t, k: "N/m" = 1.0): return k * d', "rename the function"),
        ("_x = 1", "holds no candidate"),
        ("def a(:", "line 1"),
        ("import nonsense_module", "cannot be run: ModuleNotFoundError"),
        ("assert False", "cannot be run: AssertionError"),
        ("class Mine(Exception): pass\nraise Mine('so it is')", "cannot be run: Mine: so it is"),
        ("class Mine(BaseException): pass\nraise Mine", "cannot be run: Mine"),
        ("import sys\nsys.exit()", "cannot be run: SystemExit"),
        ("raise SystemExit(0)", "cannot be run: SystemExit: 0"),
        ("x = 1 \0", "line 1"),
        ("x = " + "(" * 5000 + ")" * 5000, "own.py"),
        ('def a(d, v, t, k: "N/m" = 1.0): assert False', "own.py line 1: a"),
        ('def a(d, v, t, k: "N/m**9**9**9" = 1.0): return k * d', "is not understood"),
        ('def a(d, v, t, k: "N/m**9**11**11**11" = 1.0): return k * d', "is not understood"),
        ('def a(d, v, t, k: "' + "a" * 59 + '!" = 1.0): return k * d', "is not understood"),
        ('def a(d, v, t, k: "N/m^999999999" = 1.0): return k * d', "is not understood"),
        ('def a(d, v, t, k: "9**9**9**9 N/m" = 1.0): return k * d', "is not understood"),
        ('def a(d, v, t, k: "N" + "/m" * 100 = 1.0): return k * d', "is not understood"),
        ('def a(d, v, t, k: "N/m" = 1e300): return k * d', "'k' is 1e+300 in SI; it must be 1e-15 to 1e+15"),
        ('def a(d, v, t, k: "N/m" = 10**400): return k * d', "write a number other than 0"),
        ('def a(d, v, t, k: "N/m" = "soft"): return k * d', "write a number other than 0"),
    ],
)  # fmt: skip
def test_a_bad_file_is_one_sentence(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "own.py"
    file.write_text(text + "\n")
    with pytest.raises(CaseError) as caught:
        user_kinds(read_candidates(file))
    assert list(tmp_path.iterdir()) == [file]
    assert said in str(caught.value)
    assert str(file) in str(caught.value) or "rename" in said
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "unit", ["N/m", "kN/mm", "N s/m", "N*s/m", "N/(m/s)", "kg / s ** 2", "N m^-1", "N/m^1.5*m^0.5"]
)
def test_units_are_read(tmp_path: Path, unit: str) -> None:
    file = tmp_path / "own.py"
    file.write_text(
        f'def a(d, v, t, k: "{unit}" = 2.0): return k * {"v" if "s/m" in unit or "m/s" in unit else "d"}'
    )
    (force,) = read_candidates(file)
    assert force.parameters[0].unit == unit


def test_a_missing_file_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="there is no such file of candidates"):
        read_candidates(tmp_path / "none.py")
