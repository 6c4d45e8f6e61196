"""Fragilities over a sweep: the same answer as in threads, kept in a folder, on processes and on a Dask cluster."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from pounding.experiments.command.app import main
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility import sweeping
from pounding.experiments.fragility.capacity import Limit, passing
from pounding.experiments.fragility.sweeping import Motions, passing_by_sweep, street_text
from pounding.experiments.rig.states import states_of
from pounding.experiments.rig.street import built_row, named, street_contacts
from pounding.experiments.rig.street_file import load_street

MOTIONS = Motions(("elcentro-chopra", "elcentro-peer180"))
LIMITS = (Limit("force", 3e6), Limit("drift", 0.02))
LEVELS = np.array([0.05, 0.15, 0.45])
STRENGTHS = np.array([0.3, 0.25])


@pytest.fixture
def street(tmp_path: Path) -> Path:
    """Return the file of a street of two sticks of real size."""
    for name, old, new in (("left", "", ""), ("right", "[1.1, 3.2]", "[1.9]")):
        main(["new-frame", str(tmp_path / f"{name}.toml")])
        text = (tmp_path / f"{name}.toml").read_text()
        if old:
            (tmp_path / f"{name}.toml").write_text(text.replace(old, new).replace("[0.03, 0.04]", "0.03"))
    path = tmp_path / "street.toml"
    main(["new-street", str(path), str(tmp_path / "left.toml"), str(tmp_path / "right.toml")])
    return path


def test_a_sweep_says_what_threads_say_and_runs_nothing_twice(
    street: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    loaded = load_street(street)
    states = states_of([one.frame for one in loaded.building])
    row = named(loaded, built_row(loaded, states))
    contacts, _ = street_contacts(loaded, row, ["floors"])
    records = MOTIONS.read()
    expected = passing(row, contacts, records, LEVELS / STRENGTHS[:, None], LIMITS)
    text = street_text(loaded, states, ["floors"])
    folder = tmp_path / "kept"
    words = (MOTIONS, records, STRENGTHS, LEVELS, LIMITS, text)
    np.testing.assert_array_equal(passing_by_sweep(*words, folder=folder, workers=0), expected)
    assert 0 < expected.sum() < expected.size
    assert len(list(folder.glob("*.json"))) == len(records)
    # What is finished is not run again; without the folder it would be, and fail.
    monkeypatch.setattr(sweeping, "passing", None)
    np.testing.assert_array_equal(passing_by_sweep(*words, folder=folder, workers=0), expected)
    with pytest.raises(ExperimentError, match="2 of 2 runs failed"):
        passing_by_sweep(*words, workers=0)


def test_another_motion_of_the_same_name_is_refused(street: Path) -> None:
    loaded = load_street(street)
    text = street_text(loaded, states_of([one.frame for one in loaded.building]), ["floors"])
    others = [one.flipped() for one in MOTIONS.read()]
    with pytest.raises(ExperimentError, match="another one here than where the sweep was started"):
        passing_by_sweep(MOTIONS, others, STRENGTHS, LEVELS, LIMITS, text, workers=0)


def test_nothing_to_sweep_is_said(street: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["fragility", str(street), "--set", "fema-p695-farfield", "--scheduler", "tcp://127.0.0.1:1"])
    assert left.value.code == 2
    assert "--kept and --scheduler are for the runs of --force or --drift" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.guard
def test_the_verb_says_the_same_on_a_cluster(
    street: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from distributed import LocalCluster

    names = ("elcentro-chopra", "elcentro-peer180", "hollywood-pel180", "beverlyhills-mul279")
    records = [word for name in names for word in ("--record", name)]
    words = ["fragility", str(street), *records, "--drift", "0.7", "--levels", "12", "--json"]
    capsys.readouterr()
    main(words)
    here = json.loads(capsys.readouterr().out)
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        main([*words, "--scheduler", cluster.scheduler_address, "--kept", str(tmp_path / "kept")])
    there = json.loads(capsys.readouterr().out)
    assert there["fragilities"] == here["fragilities"]
    # The same call without the cluster goes on from what is kept.
    main([*words, "--kept", str(tmp_path / "kept"), "--workers", "0"])
    assert json.loads(capsys.readouterr().out)["fragilities"] == here["fragilities"]
