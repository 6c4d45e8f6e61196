"""A frame file to begin with: it runs as written, and nothing is overwritten."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding import frames
from pounding.experiments.command.new_frame import new_frame
from pounding.experiments.errors import ExperimentError
from pounding.frames.files import write_whole


@pytest.mark.parametrize(("plates", "first_hz", "storeys"), [(False, 1.1, 4), (True, 6.8, 5)])
def test_what_is_written_is_a_frame(tmp_path: Path, plates: bool, first_hz: float, storeys: int):
    file = tmp_path / "my office.toml"
    new_frame(file, plates=plates)
    frame = frames.load(file)
    assert (frame.name, frame.storeys) == ("my office", storeys)
    assert frames.build(frame).frequencies_hz[0] == pytest.approx(first_hz, rel=0.02)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("office", "a frame file ends in .toml; write office.toml"),
        ('of"fice.toml', "use letters, digits"),
        ("there.toml", "is there already; name another file"),
    ],
)
def test_bad_names_are_one_sentence(tmp_path: Path, name: str, said: str):
    write_whole(tmp_path / "there.toml", b"mine")
    with pytest.raises(ExperimentError, match=said):
        new_frame(tmp_path / name)
    assert (tmp_path / "there.toml").read_bytes() == b"mine"
    assert len(list(tmp_path.iterdir())) == 1
