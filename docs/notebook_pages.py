"""Notebooks as pages: text, code, and the outputs that are kept in them, which tests/house/test_notebooks.py makes again."""

import json

from myst_parser.parsers.sphinx_ import MystParser

DOWNLOAD = "{{download}}`This page as a notebook <{name}>`; `pip install notebook`, then `jupyter notebook`, opens it."


def page(notebook, name):
    """Return a notebook as MyST Markdown.

    Args:
        notebook: The content of the file.
        name: The file's name, for the link to it.
    """
    title, *cells = notebook["cells"]
    parts = ["".join(title["source"]), DOWNLOAD.format(name=name)]
    heading = ""
    for cell in cells:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            heading = source.partition("\n")[0].lstrip("# ")
            parts.append(source)
        else:
            parts.append(fenced("python", source))
            parts += [shown(output, heading) for output in cell["outputs"]]
    return "\n\n".join(parts) + "\n"


def shown(output, heading):
    """Return one output of a cell: a picture inline, or what was printed.

    Raises:
        ValueError: An error that is kept in the notebook, or an output of a kind that no page shows.
    """
    if output["output_type"] == "stream":
        return fenced("text", "".join(output["text"]))
    if "image/png" in output.get("data", {}):
        picture = "".join(output["data"]["image/png"]).replace("\n", "")
        return f"![{heading}](data:image/png;base64,{picture})"
    raise ValueError(f"an output of type {output['output_type']} has no picture; run the notebook again")


def fenced(language, text):
    """Return text as a block of code."""
    return f"````{language}\n{text.rstrip()}\n````"


class NotebookParser(MystParser):
    """Reads a notebook as Sphinx reads a page of Markdown."""

    supported = ("notebook",)

    def parse(self, inputstring, document):
        """Parse a notebook's JSON into a document."""
        name = document["source"].rpartition("/")[2]
        super().parse(page(json.loads(inputstring), name), document)


def setup(app):
    """Let Sphinx take notebooks for pages."""
    app.add_source_suffix(".ipynb", "notebook")
    app.add_source_parser(NotebookParser)
    return {"parallel_read_safe": True}
