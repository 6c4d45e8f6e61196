"""The table of all configurations as Markdown: `python -m pounding.experiments.configurations.page` prints it.

It stands in docs/experiments.md, and a test holds it there.
"""

from __future__ import annotations

from pounding.experiments.configurations.library import experiments


def markdown() -> str:
    """Return a table of every configuration: name, what it is, where it was measured, figures of the thesis."""
    lines = ["| name | what | measured in | figures |", "|---|---|---|---|"]
    for one in experiments().values():
        places = ", ".join(dict.fromkeys(str(printed).partition(",")[0] for printed in one.measured))
        lines.append(f"| `{one.name}` | {one.title} | {places} | {', '.join(one.figures)} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(markdown(), end="")
