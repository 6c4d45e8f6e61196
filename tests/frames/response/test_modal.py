import json

import numpy as np
import pytest

from pounding import frames
from pounding.experiments.command import main
from pounding.frames.fe.assembly import Options, assemble
from pounding.frames.fe.mesh import Density
from pounding.frames.response.modal import KINDS, analyse, describe, mac, ordinal

COARSE = Options(density=Density(0.05, 2, 4))
"""Quick, and enough where the mesh is not the question."""


@pytest.fixture(scope="module")
def five():
    return analyse(frames.load("5A"))


@pytest.fixture(scope="module")
def everything():
    """All modes of a coarse two-storey frame with mass but the very highest."""
    frame = frames.changed(frames.load("5A"), storeys=2)
    return assemble(frame, COARSE), analyse(frame, COARSE, up_to_hz=20e3)


def test_modes_are_named_and_sorted(five):
    assert (np.diff(five.frequencies_hz) > 0).all()
    assert five.descriptions[:2] == ["1st bending in x", "2nd bending in x"]
    assert "1st bending in y" in five.descriptions
    assert "1st torsion" in five.descriptions


def test_effective_masses_belong_to_their_directions(five):
    ratios = five.effective_mass_ratio
    for mode, name in enumerate(five.descriptions):
        along = {"x": 0, "y": 1}.get(name[-1])
        others = [d for d in (0, 1, 2) if d != along]
        assert ratios[mode, others].max() < 1e-10
    assert ratios[0, 0] == pytest.approx(0.861, abs=0.005)


def test_effective_masses_add_up_to_the_moving_mass(everything):
    model, modes = everything
    total = modes.effective_mass[:, :3].sum(axis=0)
    base = model.node_mass.diagonal().reshape(-1, 6)[model.mesh.nodes[:, 2] < 1e-9, 0].sum()
    free = model.frame.moving_mass_kg - base
    assert total == pytest.approx([free] * 3, rel=5e-3)
    assert (total <= free * (1 + 1e-9)).all()


def test_shapes_are_orthogonal_in_mass_and_stiffness(five):
    model = assemble(frames.load("5A"))
    assert five.shapes.T @ (model.mass @ five.shapes) == pytest.approx(np.eye(five.shapes.shape[1]), abs=1e-9)
    squares = np.diag((2 * np.pi * five.frequencies_hz) ** 2)
    assert five.shapes.T @ (model.stiffness @ five.shapes) == pytest.approx(squares, abs=1e-6 * squares.max())


def test_mac_tells_shapes_apart(five):
    values = mac(five.shapes, -2.0 * five.shapes)
    assert np.diag(values) == pytest.approx(1.0)
    assert mac(np.array([[1.0], [0.0]]), np.array([[0.0, 1.0], [1.0, 1.0]])) == pytest.approx(
        np.array([[0.0, 0.5]])
    )


def test_modes_along_x_are_those_of_the_reduced_frame(five):
    reduced = frames.build(frames.load("5A"))
    along = five.frequencies_hz[five.effective_mass_ratio[:, 0] > 1e-6]
    assert reduced.frequencies_hz[: len(along)] == pytest.approx(along, rel=1e-4)


def test_names_of_modes_count_by_kind():
    energies = np.eye(4)[[0, 0, 2, 0, 3]]
    assert describe(energies) == [f"{n} {KINDS[k]}" for n, k in
                                  (("1st", 0), ("2nd", 0), ("1st", 2), ("3rd", 0), ("1st", 3))]  # fmt: skip
    assert [ordinal(n) for n in (1, 2, 3, 4, 11, 12, 13, 21, 22, 112)] == [
        "1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st", "22nd", "112th"]  # fmt: skip


def test_a_stick_has_modes_along_x_alone():
    stick = frames.from_mapping(
        {"kind": "stick", "name": "s", "storeys": 2, "storey_height_m": 3.0, "floor_mass_kg": [1e5, 8e4],
         "storey_stiffness_n_per_m": [2e8, 1e8], "damping_ratio": 0.02}
    )  # fmt: skip
    modes = analyse(stick)
    assert modes.effective_mass_ratio[:, 0].sum() == pytest.approx(1.0)
    assert modes.effective_mass_ratio[:, 1].sum() == 0.0
    assert modes.descriptions == ["1st bending in x", "2nd bending in x"]


def verb(capsys, *words):
    main(["modal", *words])
    return capsys.readouterr().out


def test_verb_prints_one_json_object(capsys):
    result = json.loads(verb(capsys, "10", "--json", "--up-to-hz", "20"))
    assert result["frame"] == "10"
    assert result["mass_kg"] == pytest.approx(65.312)
    assert result["roof_stiffness_n_per_mm"] == pytest.approx(14.4, rel=0.02)
    first = result["modes"][0]
    assert first["frequency_hz"] == pytest.approx(3.54, rel=1e-4)
    assert {"effective_mass_ratio_x", "effective_mass_ratio_y", "damping_ratio", "description"} <= set(first)
    assert first["damping_ratio"] == 0.00431
    assert result["published"]["sweep_hz"] == [3.46, 11.13, 18.44]
    assert [mode["frequency_hz"] for mode in result["modes"]] == sorted(
        m["frequency_hz"] for m in result["modes"]
    )


def test_verb_takes_the_common_options(capsys):
    rigid = json.loads(verb(capsys, "5A", "--json", "--joints", "rigid", "--no-p-delta", "--damping", "0.02"))
    assert rigid["modes"][0]["frequency_hz"] == pytest.approx(8.44, rel=0.01)
    assert rigid["modes"][0]["damping_ratio"] == 0.02
    assert rigid["parameters"]["p_delta"] is False


def test_verb_says_that_there_is_no_mode_so_low(capsys):
    shown = verb(capsys, "5A", "--up-to-hz", "0.5")
    assert "Frame 5A: no mode up to 0.5 Hz; --up-to-hz asks for more" in shown
    assert "mass x" not in shown


def test_verb_shows_tables(capsys):
    shown = verb(capsys, "5A", "--up-to-hz", "10")
    assert "1st bending in x" in shown
    assert "roof stiffness" in shown


@pytest.mark.parametrize(
    ("words", "sentence"),
    [(["15C"], "did you mean 15A or 15B"), (["5A", "--damping", "2"], "0.5 % is 0.005"),
     (["5A", "--state", "guess"], "Choose from")],
)  # fmt: skip
def test_verb_refuses_bad_input_in_one_sentence(capsys, words, sentence):
    with pytest.raises(SystemExit) as leaving:
        main(["modal", *words])
    assert leaving.value.code == 2
    shown = capsys.readouterr()
    assert sentence in shown.err
    assert shown.out == ""
    assert len(shown.err.strip().splitlines()) == 1
