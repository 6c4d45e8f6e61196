"""Frames from a table of modes and from matrices, and the script for OpenSees."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.linalg import eigh
from scipy.sparse import csr_matrix

from pounding import frames
from pounding.experiments.command.app import main
from pounding.frames.errors import FrameError
from pounding.frames.opensees_script import springs_of
from pounding.frames.stick import notes

CHAIN = frames.StickFrame(
    name="chain",
    storeys=3,
    storey_height_m=3.0,
    floor_mass_kg=[300e3, 280e3, 200e3],
    storey_stiffness_n_per_m=[2e8, 1.8e8, 1.2e8],
    damping_ratio=[0.01, 0.02, 0.03],
)
HEAD = 'kind = "stick"\nname = "far"\nstoreys = 3\nstorey_height_m = 3.0\n'
MASSES = "floor_mass_kg = [300e3, 280e3, 200e3]\n"
MODES = '[modes]\nfile = "modes.csv"\n'
MATRICES = (
    "damping_ratio = 0.02\n[matrices]\n"
    'mass_file = "m.mtx"\nstiffness_file = "k.npz"\nfloor_rows = [1, 3, 5]\n'
)


def table(folder, count, change=None):
    reduced = frames.build(CHAIN)
    shapes = reduced.shapes / np.abs(reduced.shapes).max(axis=0)
    shapes = shapes if change is None else change(shapes)
    rows = np.column_stack([reduced.frequencies_hz, reduced.damping_ratios, shapes.T])[:count]
    lines = ["frequency_hz,damping_ratio,floor_1,floor_2,floor_3"]
    (folder / "modes.csv").write_text("\n".join([*lines, *(",".join(map(repr, r.tolist())) for r in rows)]))


def written(folder, text):
    (folder / "far.toml").write_text(text)
    return folder / "far.toml"


def large():
    """A chain of six masses of which rows 1, 3 and 5 are the floors; its stiffness and mass."""
    stiffness = 1e8 * (2 * np.eye(6) - np.eye(6, k=1) - np.eye(6, k=-1))
    stiffness[5, 5] = 1e8
    return stiffness, np.diag([300e3, 0.0, 280e3, 0.0, 200e3, 0.0])


def save(folder, stiffness, mass):
    np.savez(folder / "k.npz", stiffness=stiffness)
    mmwrite(folder / "m.mtx", csr_matrix(mass))


def test_all_modes_of_a_chain_give_the_chain(tmp_path):
    table(tmp_path, 3)
    reduced, chain = frames.build(frames.load(written(tmp_path, HEAD + MASSES + MODES))), frames.build(CHAIN)
    assert reduced.stiffness == pytest.approx(chain.stiffness, rel=1e-6, abs=1.0)
    assert reduced.damping == pytest.approx(chain.damping, rel=1e-6, abs=1.0)
    assert not notes(reduced.definition)


def test_what_the_modes_do_not_cover_has_the_stated_frequency(tmp_path):
    table(tmp_path, 1)
    chain = frames.build(CHAIN)
    first = chain.frequencies_hz[0]
    reduced = frames.build(frames.load(written(tmp_path, HEAD + MASSES + MODES)))
    assert reduced.frequencies_hz == pytest.approx([first, 3 * first, 3 * first])
    assert reduced.damping_ratios == pytest.approx([0.01] * 3)
    assert np.abs(reduced.shapes[:, 0]) == pytest.approx(np.abs(chain.shapes[:, 0]))
    assert "modes 2 to 3 are not in the table" in notes(reduced.definition)[0]
    stated = frames.load(written(tmp_path, HEAD + MASSES + MODES + "remainder_hz = 20.0\n"))
    assert frames.build(stated).frequencies_hz[1:] == pytest.approx([20.0, 20.0])


def test_a_frame_that_was_read_needs_its_files_no_more(tmp_path):
    table(tmp_path, 2)
    frame = frames.load(written(tmp_path, HEAD + MASSES + MODES))
    (tmp_path / "modes.csv").unlink()
    kept = frames.build(frame).options["modes"]
    assert kept["frequency_hz"] == frame.modes.frequency_hz
    again = {"kind": "stick", "name": "far", "storeys": 3, "storey_height_m": 3.0}
    again |= {"floor_mass_kg": CHAIN.floor_mass_kg, "modes": kept | {"file": ""}}
    assert frames.build(frames.from_mapping(again)).stiffness == pytest.approx(frames.build(frame).stiffness)


def test_matrices_are_condensed_to_the_floors(tmp_path):
    stiffness, mass = large()
    mass[1, 1] = 30e3
    save(tmp_path, stiffness, mass)
    frame = frames.load(written(tmp_path, HEAD + MATRICES))
    reduced = frames.build(frame)
    basis = np.array([[1, 0, 0], [0.5, 0.5, 0], [0, 1, 0], [0, 0.5, 0.5], [0, 0, 1], [0, 0, 1]])
    assert reduced.stiffness == pytest.approx(basis.T @ stiffness @ basis, abs=1.0)
    assert reduced.mass == pytest.approx(basis.T @ mass @ basis, abs=1e-6)
    assert frame.moving_mass_kg == pytest.approx(810e3)
    assert "3 rows are left out" in notes(frame)[0]


def test_without_mass_on_other_rows_the_condensation_is_exact(tmp_path):
    stiffness, mass = large()
    save(tmp_path, stiffness, mass)
    found = frames.build(frames.load(written(tmp_path, HEAD + MATRICES))).frequencies_hz
    squares = eigh(mass, stiffness, eigvals_only=True)[::-1][:3]
    assert found == pytest.approx(1 / np.sqrt(squares) / (2 * np.pi))


@pytest.mark.parametrize(
    ("text", "change", "sentence"),
    [
        (HEAD + MODES, None, "modes without masses are no frame"),
        (HEAD + MASSES + MODES, lambda s: s[:, [0, 0, 2]], "are 1 from orthogonal in mass"),
        (HEAD + MASSES + MODES, lambda s: np.nan * s, "not finite; leave the mode out"),
        (HEAD + MASSES + MODES + "remainder_hz = 1.0\n", None, "must be above the last mode's"),
        (HEAD + MASSES + MODES + "remainder_khz = 1.0\n", None, "expected remainder_hz"),
        (HEAD + MASSES + MODES.replace("modes.csv", "no.csv"), None, "no.csv: No such file"),
        (HEAD + MASSES + "damping_ratio = 0.1\n" + MODES, None, "leave damping_ratio out"),
        (HEAD + MASSES + "frequency_hz = [1.0]\n" + MODES, None, "frequency_hz and modes are stated"),
        (HEAD + MASSES + MODES + "shapes = [[1.0]]\n", None, "leave one of the two out"),
    ],
)
def test_modes_that_cannot_be_are_refused(tmp_path, text, change, sentence):
    table(tmp_path, 2, change)
    with pytest.raises(FrameError, match=sentence):
        frames.build(frames.load(written(tmp_path, text)))


def _skew(stiffness, mass):
    stiffness[0, 1] *= 1.1


def _free(stiffness, mass):
    stiffness[0, 0] = 1e8  # no spring to the base


def _massless(stiffness, mass):
    mass[2, 2] = 0.0


@pytest.mark.parametrize(
    ("text", "change", "sentence"),
    [
        (MATRICES, _skew, "k.npz: it is not symmetric"),
        (MATRICES, _free, "k.npz: condensed to the floors it is not positive definite; hold the base"),
        (MATRICES, _massless, "m.mtx: condensed to the floors it is not positive definite; give every floor"),
        (MATRICES.replace("5]", "7]"), None, "different rows from 1 to 6"),
        (MATRICES.replace("3, 5]", "3]"), None, "floor_rows has 2 values, needs one for each of 3 storeys"),
        (MATRICES.replace("m.mtx", "k.npz"), None, "no array 'mass'"),
        (MATRICES.replace("m.mtx", "small.mtx"), None, "it has 2 rows and .*k.npz 6"),
        (MATRICES.replace("m.mtx", "m.csv"), None, "must end in .mtx"),
        (MATRICES.replace("m.mtx", "wrong.mtx"), None, "wrong.mtx: it cannot be read"),
        (MASSES + MATRICES, None, "leave floor_mass_kg out"),
    ],
)
def test_matrices_that_cannot_be_are_refused(tmp_path, text, change, sentence):
    stiffness, mass = large()
    if change:
        change(stiffness, mass)
    save(tmp_path, stiffness, mass)
    mmwrite(tmp_path / "small.mtx", csr_matrix(np.eye(2)))
    (tmp_path / "wrong.mtx").write_text("no matrix")
    with pytest.raises(FrameError, match=sentence):
        frames.load(written(tmp_path, HEAD + text))


def test_the_script_builds_the_same_matrices(tmp_path, monkeypatch, capsys):
    table(tmp_path, 2)
    path = written(tmp_path, HEAD + MASSES + MODES)
    main(["opensees", str(path), str(tmp_path / "far.py")])
    reduced = frames.build(frames.load(path))
    masses, links, materials = {}, {}, {}

    def eigen(_solver, count):
        stiffness, damping = np.zeros((2, count + 1, count + 1))
        for low, high, (spring, dashpot) in links.values():
            place, sign = np.ix_([low, high], [low, high]), np.array([[1, -1], [-1, 1]])
            stiffness[place] += spring * sign
            damping[place] += dashpot * sign
        assert stiffness[1:, 1:] == pytest.approx(reduced.stiffness)
        assert damping[1:, 1:] == pytest.approx(reduced.damping)
        return eigh(stiffness[1:, 1:], np.diag([masses[n] for n in range(1, count + 1)]), eigvals_only=True)

    ops = SimpleNamespace(
        wipe=lambda: None,
        model=lambda *_: None,
        node=lambda *_: None,
        fix=lambda *_: None,
        mass=masses.__setitem__,
        uniaxialMaterial=lambda _kind, tag, *values: materials.__setitem__(tag, values),
        element=lambda _kind, tag, low, high, _mat, material, *_: links.__setitem__(
            tag, (low, high, materials[material])
        ),
        eigen=eigen,
    )
    monkeypatch.setitem(sys.modules, "openseespy", SimpleNamespace(opensees=ops))
    monkeypatch.setitem(sys.modules, "openseespy.opensees", ops)
    names = {"__name__": "far"}
    exec((tmp_path / "far.py").read_text(), names)
    assert names["build"]() == pytest.approx(reduced.frequencies_hz)
    assert names["DAMPING_RATIOS"] == pytest.approx(reduced.damping_ratios)


def test_a_chain_is_written_as_its_storeys():
    springs = springs_of(frames.build(CHAIN).stiffness)
    assert [(low, high) for low, high, _ in springs] == [(0, 1), (1, 2), (2, 3)]
    assert [value for *_, value in springs] == pytest.approx(CHAIN.storey_stiffness_n_per_m)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["5A", "a.py"], "only a stick can be written"),
        (["far.toml", "a.tcl"], "ends in .py"),
        (["far.toml", "b.py"], "is there already"),
        (["far.toml", "a.py"], "its mass matrix couples floors"),
    ],
)
def test_what_cannot_be_written_for_opensees_is_said(tmp_path, monkeypatch, capsys, words, sentence):
    monkeypatch.chdir(tmp_path)
    stiffness, mass = large()
    mass[1, 1] = 30e3
    save(tmp_path, stiffness, mass)
    written(tmp_path, HEAD + MATRICES)
    (tmp_path / "b.py").touch()
    with pytest.raises(SystemExit) as left:
        main(["opensees", *words])
    assert left.value.code == 2
    assert sentence in capsys.readouterr().err
