"""A case as a stranger writes it: `case.toml` and a CSV of each run, by docs/diagnosis/case-format.md."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tests.planar_world.baseline import Real
from tests.planar_world.measuring import SAMPLING_HZ, Channel

TABLE = ("table", "table_acceleration", "m/s^2")


def write_case(
    folder: Path, title: str, frame: str, channels: Sequence[Channel], runs: Sequence[Real]
) -> None:
    """Write a case, `case.toml` last, so that a folder with it is whole.

    Args:
        folder: Made if it is not there.
        title: Of the case.
        frame: The frame's name in the project.
        channels: All but the table's.
        runs: Readings (times, table and channels) of each run, in the units of the channels.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for number, readings in enumerate(runs, 1):
        lines = [",".join(["time_s", TABLE[0], *(channel.name for channel in channels)])]
        lines += [
            ",".join([f"{index / SAMPLING_HZ:.3f}", *(f"{value:.7g}" for value in row)])
            for index, row in enumerate(readings)
        ]
        (folder / f"run{number}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    files = [f'[[run]]\nfile = "run{number}.csv"\n' for number in range(1, len(runs) + 1)]
    name, quantity, unit = TABLE
    table = f'[[channel]]\nname = "{name}"\nquantity = "{quantity}"\nunit = "{unit}"\n'
    blocks = [f'title = "{title}"\n', f'[[frame]]\nname = "{frame}"\n', *files, table]
    blocks += [_block(frame, channel) for channel in channels]
    (folder / "case.toml").write_text("\n".join(blocks), encoding="utf-8")


def _block(frame: str, channel: Channel) -> str:
    quantity, unit = (
        ("absolute_acceleration", "m/s^2") if channel.accelerometer else ("relative_displacement", "mm")
    )
    place = f'name = "{channel.name}"\nframe = "{frame}"\nfloor = {channel.floor}\n'
    return f'[[channel]]\n{place}quantity = "{quantity}"\nunit = "{unit}"\n'
