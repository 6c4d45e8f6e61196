"""An answer of `pounding gap`, `design` or `mitigate` as one HTML file that can be handed on."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from pounding.experiments.output.html import TEMPLATES
from pounding.frames.files import replacing


def write_report(
    kind: str,
    result: Mapping[str, Any],
    path: Path | str,
    pictures: Sequence[Figure] = (),
    sketch: str = "",
    **said: Any,
) -> None:
    """Write a self-contained report; an existing file is replaced only when the new one is whole.

    Args:
        kind: ``gap``, ``street``, ``design`` or ``mitigate``.
        result: The stamped result of the verb.
        path: HTML file to write.
        pictures: Pictures, put into the file itself; of a street one a pair.
        sketch: Drawing of the buildings, SVG.
        said: What the first page says beside the result, by the names that its template has.
    """
    html = TEMPLATES.get_template(f"{kind}.html").render(
        result=result, pictures=[_embedded(picture) for picture in pictures], sketch=sketch, **said
    )
    with replacing(Path(path)) as part:
        Path(part).write_text(html, encoding="utf-8")


def _embedded(picture: Figure) -> str:
    stream = io.BytesIO()
    picture.savefig(stream, format="png", dpi=110)
    return base64.b64encode(stream.getvalue()).decode("ascii")
