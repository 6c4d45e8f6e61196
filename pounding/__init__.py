"""Structural pounding: frames, impact laws, experiments on a shaking table, and the diagnosis of missing effects.

The packages are `pounding.frames`, `pounding.contact`, `pounding.experiments` and `pounding.diagnosis`. In a clone their
sources are the folders of these names beside this one, to which the links here lead.
"""

from pathlib import Path as _Path

if (_Path(__file__).parent / "frames").is_file():
    raise ImportError(
        f"{_Path(__file__).parent / 'frames'} is a text file and no link to a folder: this clone was made without symbolic "
        "links; run 'git config core.symlinks true && rm -r pounding && git checkout -- pounding' where links are allowed"
    )
