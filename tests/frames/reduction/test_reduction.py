import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from pounding import frames
from pounding.frames.errors import FrameError
from pounding.frames.fe.assembly import Options, assemble
from pounding.frames.fe.mesh import Density
from pounding.frames.fe.symmetry import is_symmetric, planar_basis
from pounding.frames.reduction.craig_bampton import craig_bampton, lowest_modes
from pounding.frames.response.modal import analyse, rigid_motions

COARSE = Density(0.05, 2, 4)


@pytest.fixture(scope="module")
def five():
    frame = frames.load("5A")
    return assemble(frame), frames.build(frame, planar=False), frames.build(frame)


def below_60(model):
    return lowest_modes(model.stiffness.tocsc(), model.mass.tocsc(), keep_hz=60.0)[0]


@pytest.mark.parametrize("name", ["5A", "10", pytest.param("15B", marks=pytest.mark.slow)])
def test_all_frequencies_below_60_hz_within_a_thousandth(name):
    frame = frames.load(name)
    full = below_60(assemble(frame))
    reduced = frames.build(frame, planar=False).frequencies_hz
    assert reduced[: len(full)] == pytest.approx(full, rel=1e-3)


@pytest.mark.parametrize("name", ["5B", "10", "15A"])
def test_planar_frequencies_are_those_along_x(name):
    frame = frames.load(name)
    modes = analyse(frame)
    along = modes.frequencies_hz[modes.effective_mass_ratio[:, 0] > 1e-7]
    assert frames.build(frame).frequencies_hz[: len(along)] == pytest.approx(along, rel=1e-3)


def test_a_push_on_any_floor_is_exact(five):
    model, complete, planar = five
    for floor in (0, 4):
        load = np.zeros(model.stiffness.shape[0])
        load[model.coordinates.floor[floor, 0]] = 1.0
        full = spsolve(model.stiffness.tocsc(), load)[model.coordinates.floor[:, 0]]
        for reduced in (complete, planar):
            push = np.zeros(reduced.size)
            push[reduced.floor_x[floor]] = 1.0
            assert np.linalg.solve(reduced.stiffness, push)[reduced.floor_x] == pytest.approx(full, rel=1e-9)
    assert planar.roof_stiffness_n_per_m == pytest.approx(1.0 / full[-1], rel=1e-9)


def test_storey_model_keeps_every_push(five):
    planar = five[2]
    mass, stiffness, damping = planar.storey_model()
    full = np.linalg.inv(planar.stiffness)[np.ix_(planar.floor_x, planar.floor_x)]
    assert np.linalg.inv(stiffness) == pytest.approx(full, rel=1e-8)
    assert mass.sum() == pytest.approx(planar.moving_mass_kg, rel=0.01)
    assert (np.linalg.eigvalsh(damping) > 0).all()


def test_more_modes_come_closer_from_above():
    frame = frames.load("5A")
    first = [frames.build(frame, modes=m, use_cache=False).frequencies_hz[:5] for m in (0, 2, 12)]
    assert (first[0] >= first[1] - 1e-9).all()
    assert (first[1] >= first[2] - 1e-9).all()


def test_keep_hz_is_a_switch():
    frame = frames.load("5A")
    sizes = [frames.build(frame, keep_hz=hz).size for hz in (100.0, 300.0, 2000.0)]
    # Five floors, and the shape for the strips between base and first floor.
    assert sizes[0] == 6
    assert sizes[0] < sizes[1] < sizes[2]


def test_damping_is_the_same_in_all_modes(five):
    planar = five[2]
    modal = planar.shapes.T @ planar.damping @ planar.shapes
    expected = np.diag(4 * np.pi * 0.00664 * planar.frequencies_hz)
    assert modal == pytest.approx(expected, abs=1e-9 * expected.max())
    assert planar.shapes.T @ planar.mass @ planar.shapes == pytest.approx(np.eye(planar.size), abs=1e-9)


def test_base_translation_moves_the_floors_by_one(five):
    model, complete, planar = five
    assert planar.influence[planar.floor_x] == pytest.approx(1.0, abs=2e-3)
    assert complete.influence[complete.floor_x] == pytest.approx(1.0, abs=2e-3)
    # All mass is moved but that of the base's nodes, which is never relative.
    held = model.node_mass.diagonal().reshape(-1, 6)[model.mesh.nodes[:, 2] < 1e-9, 0].sum()
    total = planar.influence @ planar.mass @ planar.influence
    assert total == pytest.approx(planar.moving_mass_kg - held, rel=2e-3)


def test_influence_gives_the_participation_of_the_full_model():
    frame = frames.load("10")
    modes, reduced = analyse(frame), frames.build(frame)
    full = np.abs(modes.participation[modes.effective_mass_ratio[:, 0] > 1e-3, 0])
    small = np.abs(reduced.shapes.T @ reduced.mass @ reduced.influence)[: len(full)]
    assert small == pytest.approx(full, rel=1e-3)
    assert small[:3] == pytest.approx(full[:3], rel=1e-5)


def test_expansion_satisfies_the_full_model(five):
    # A push on the roof: the expanded displacements are those of the full mesh, nodes and all.
    model, _, planar = five
    load = np.zeros(model.stiffness.shape[0])
    load[model.coordinates.floor[-1, 0]] = 1.0
    full = (model.coordinates.to_nodes @ spsolve(model.stiffness.tocsc(), load)).reshape(-1, 6)[:, :3]
    push = np.zeros(planar.size)
    push[planar.floor_x[-1]] = 1.0
    q = np.linalg.solve(planar.stiffness, push)
    assert planar.expand(q) == pytest.approx(full, abs=1e-9 * np.abs(full).max())


def test_column_stress_of_a_push_is_that_of_statics():
    # Rigid joints, no P-Delta: each column carries a quarter of the push; the lowest column's end moments add
    # up to shear times height.
    frame = frames.load("5A")
    reduced = frames.build(frame, joints="rigid", p_delta=False, density=Density(0.02, 2, 10))
    push = np.zeros(reduced.size)
    push[reduced.floor_x[-1]] = 4.0
    stress = reduced.recovery.surface_stress(np.linalg.solve(reduced.stiffness, push))
    mesh = reduced.mesh
    middle = mesh.nodes[mesh.quads].mean(axis=1)
    column = mesh.is_column & (mesh.level == 2) & (middle[:, 0] < 0) & (middle[:, 1] < 0)
    # Moment per width from the difference of both surfaces, averaged across: M = sigma t^2 / 6.
    heights = np.unique(np.round(middle[column, 2], 9))
    bending = (stress[column, 1, 1] - stress[column, 0, 1]) / 2
    moment = [bending[np.isclose(middle[column, 2], z)].mean() * 0.04 * 0.002**2 / 6 for z in heights]
    slope = np.polyfit(heights, moment, 1)[0]
    assert abs(slope) == pytest.approx(1.0, rel=0.02)


def test_rigid_floors_change_nothing_that_matters():
    frame = frames.load("5A")
    rigid = assemble(frame, Options())
    flexible = assemble(frame, Options(rigid_floors=False))
    one, other = below_60(rigid), below_60(flexible)
    assert len(one) == len(other)
    assert other == pytest.approx(one, rel=1e-3)
    stiffness = []
    for model in (rigid, flexible):
        nodes = np.flatnonzero(model.mesh.node_part == 5)
        # Spread over the floor, because a point force alone would dent a floor that is not rigid.
        load = np.zeros((len(model.mesh.nodes), 6))
        load[nodes, 0] = 1.0 / len(nodes)
        q = spsolve(model.stiffness.tocsc(), model.coordinates.to_nodes.T @ load.ravel())
        stiffness.append(1.0 / (load.ravel() @ (model.coordinates.to_nodes @ q)))
    assert stiffness[1] == pytest.approx(stiffness[0], rel=1e-3)


def test_symmetry_finds_the_motions_along_x():
    frame = frames.load("5A")
    model = assemble(frame, Options(density=COARSE))
    quarter = planar_basis(model.mesh, model.coordinates)
    k = quarter.T @ model.stiffness @ quarter
    m = quarter.T @ model.mass @ quarter
    planar = lowest_modes(k.tocsc(), m.tocsc(), keep_hz=400.0)[0]
    full = lowest_modes(model.stiffness.tocsc(), model.mass.tocsc(), keep_hz=400.0)
    along = full[0][(full[1].T @ model.inertia_of(rigid_motions(model.mesh)[:, :1])).ravel() ** 2 > 1e-9]
    assert all(np.abs(planar / f - 1).min() < 1e-8 for f in along)
    assert quarter.shape[1] < 0.3 * quarter.shape[0]


def test_stiffness_does_not_mix_the_families():
    frame = frames.load("5A")
    model = assemble(frame, Options(density=COARSE))
    quarter = planar_basis(model.mesh, model.coordinates)
    image = model.stiffness @ quarter
    # K maps the family into itself: what sticks out of its span is round-off.
    gram = (quarter.T @ quarter).diagonal()
    outside = image - quarter @ ((quarter.T @ image).multiply(1.0 / gram[:, None]))
    assert abs(outside).max() < 1e-9 * abs(image).max()


def test_eccentric_mass_turns_the_frame():
    frame = frames.changed(frames.load("5A"), mass_eccentricity_m=0.02)
    assert not is_symmetric(frame)
    reduced = frames.build(frame, density=COARSE)
    assert len(reduced.floor_rz) == 5
    unit = np.zeros(reduced.size)
    unit[reduced.floor_rz[2]] = 1.0
    assert reduced.point_row(3, 0.2) @ unit == pytest.approx(-0.2)
    # M couples x and rz by - m e.
    coupling = reduced.mass[reduced.floor_x, reduced.floor_rz].sum()
    assert coupling == pytest.approx(-5 * frame.floor_plate_mass_kg * 0.02, rel=0.05)
    plain = frames.build(frames.load("5A"), density=COARSE)
    assert reduced.frequencies_hz[0] < plain.frequencies_hz[0]
    with pytest.raises(FrameError, match="not symmetric"):
        frames.build(frame, planar=True)


def test_changes_act_as_they_should():
    frame = frames.load("5A")

    def first(**changes):
        return frames.build(frames.changed(frame, **changes), density=COARSE, p_delta=False)

    plain = first()
    stiffer = first(stiffness_factor=1.21)
    assert stiffer.frequencies_hz == pytest.approx(1.1 * plain.frequencies_hz, rel=1e-9)
    heavier = first(added_mass_kg=[2.0] * 5)
    ratio = np.sqrt(plain.moving_mass_kg / heavier.moving_mass_kg)
    assert heavier.frequencies_hz[0] / plain.frequencies_hz[0] == pytest.approx(ratio, rel=0.01)
    assert heavier.roof_stiffness_n_per_m == pytest.approx(plain.roof_stiffness_n_per_m)
    spread = first(nonstructural_mass_kg=10.0)
    assert spread.frequencies_hz[0] == pytest.approx(heavier.frequencies_hz[0], rel=1e-3)
    assert first(joint_factor=0.5).frequencies_hz[0] < plain.frequencies_hz[0]
    soft = first(storey_stiffness_factor=[1.0, 1.0, 0.5, 1.0, 1.0])
    drift = np.diff(np.linalg.inv(soft.storey_model()[1])[:, -1], prepend=0.0)
    before = np.diff(np.linalg.inv(plain.storey_model()[1])[:, -1], prepend=0.0)
    assert np.argmax(drift / before) == 2
    rocking = first(base_rotational_stiffness_n_m_per_rad=2000.0)
    assert rocking.frequencies_hz[0] < 0.98 * plain.frequencies_hz[0]
    fixed = first(base_rotational_stiffness_n_m_per_rad=1e12)
    assert fixed.frequencies_hz[:5] == pytest.approx(plain.frequencies_hz[:5], rel=1e-4)
    # A rigid block on a spring in series: the roof moves by an extra F H^2 / k.
    softer = 1.0 / (1.0 / plain.roof_stiffness_n_per_m + 0.5**2 / 2000.0)
    assert rocking.roof_stiffness_n_per_m == pytest.approx(softer, rel=1e-4)


def test_gravity_softens_by_the_weight_over_the_height():
    # A storey loses the weight above over its height; 6/5 of that when its columns bend in an S.
    frame = frames.load("5A")
    light = frames.build(frame, p_delta=False, joints="rigid").storey_model()[1]
    heavy = frames.build(frame, p_delta=True, joints="rigid").storey_model()[1]
    lost = np.ones(5) @ (light - heavy) @ np.ones(5)
    lowest = frame.weights_n()[0] / frame.storey_height_m
    assert 1.0 < lost / lowest < 1.21
    doubled = frames.build(frames.changed(frame, weight_factor=2.0), joints="rigid").storey_model()[1]
    assert light - doubled == pytest.approx(2.0 * (light - heavy), rel=0.02, abs=1e-3 * lost)


def test_a_frame_that_buckles_is_refused():
    with pytest.raises(FrameError, match="buckles under its weight"):
        frames.build(frames.changed(frames.load("5A"), weight_factor=200.0), density=COARSE, use_cache=False)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda f: frames.build(f, keep_hz=100.0, modes=3), "either keep_hz or modes"),
        (lambda f: frames.build(f, joints="loose"), "use one of calibrated, rigid"),
        (lambda f: frames.build(f, damping=-0.1), "give a fraction from 0"),
        (lambda f: frames.build(f, density=COARSE).point_row(6), "no floor 6"),
        (lambda f: frames.build(f, density=COARSE).point_row(5, 0.1), "planar=False"),
        (lambda f: frames.build(f, density=COARSE).point_row(5, 0.3), "off its floors, which are 0.4 m wide"),
        (lambda f: frames.build(f, density=COARSE, modes=10**6), "ask for fewer"),
    ],
)
def test_what_is_wrong_is_said(call, sentence):
    with pytest.raises(FrameError, match=sentence):
        call(frames.load("5A"))


def test_craig_bampton_of_a_chain_with_all_modes_is_the_chain():
    from scipy.sparse import csr_matrix, diags_array

    n = 12
    k = csr_matrix(diags_array([2.0 * np.ones(n), -np.ones(n - 1), -np.ones(n - 1)], offsets=[0, 1, -1]))
    m = csr_matrix(diags_array(np.linspace(1.0, 2.0, n)))
    small = craig_bampton(k, m, np.array([11]), np.ones(n), modes=9)
    full = np.linalg.eigvalsh(
        np.diag(1 / np.sqrt(m.diagonal())) @ k.toarray() @ np.diag(1 / np.sqrt(m.diagonal()))
    )
    found = np.sort(np.linalg.eigvals(np.linalg.solve(small.mass, small.stiffness)).real)
    assert found[:6] == pytest.approx(full[:6], rel=1e-3)
