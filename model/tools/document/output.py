"""Writes the data sheet as a page, a PDF, a table, a drawing or a solid body, by the suffix of the file's name."""

import csv
import io
from collections.abc import Callable
from html import escape
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from coilset.model.core.base.columns import as_text
from coilset.model.core.base.style import STYLE, as_written
from coilset.model.core.results.files.folder import make, whole
from coilset.model.tools.document.content import Document
from coilset.model.tools.document.dxf import dxf
from coilset.model.tools.document.pages import pages


def write(made: Document, path: str | Path) -> None:
    """Write a sheet; the suffix, one of WRITERS, selects the kind.

    Raises:
        CoilsetError: if the file cannot be written.
    """
    make(Path(path).parent)
    with whole(path) as partial:
        partial.write_bytes(WRITERS[Path(path).suffix.lower()](made))


def _pdf(made: Document) -> bytes:
    from matplotlib.backends.backend_pdf import PdfPages

    file = io.BytesIO()
    with mpl.rc_context({**STYLE, "pdf.fonttype": 42}), PdfPages(file, metadata={"CreationDate": None}) as pdf:
        for figure in pages(made):
            as_written(figure)
            pdf.savefig(figure)
    return file.getvalue()


def _html(made: Document) -> bytes:
    """One file without a network, whose text can be searched; printed, each page is a sheet."""
    style = (
        "@page{size:A4;margin:0}body{margin:0;background:#ddd}svg{display:block;width:210mm;height:297mm;"
        "margin:4mm auto;background:#fff;break-after:page}@media print{body{background:none}svg{margin:0}}"
    )
    title = escape(" ".join([made.title, *(value for _, value in made.head if value)]))
    drawn = "\n".join(_svg(figure, f"page{number}") for number, figure in enumerate(pages(made)))
    head = f'<meta charset="utf-8"><title>{title}</title><style>{style}</style>'
    page = f"<head>{head}</head>\n<body>{drawn}</body>"
    return f'<!DOCTYPE html>\n<html lang="{made.words.language}">{page}</html>\n'.encode()


def _svg(figure: Figure, salt: str) -> str:
    """A figure as an element of a page; the salt keeps its identifiers apart from those of other figures."""
    file = io.StringIO()
    with mpl.rc_context({**STYLE, "svg.fonttype": "none", "svg.hashsalt": salt}):
        as_written(figure)
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    text = file.getvalue()
    return text[text.index("<svg") :]


def _csv(made: Document) -> bytes:
    """A table; in German between semicolons, with decimal commas, as spreadsheets there read it."""
    file = io.StringIO()
    rows = csv.writer(file, delimiter=";" if made.words.language == "de" else ",", lineterminator="\n")
    rows.writerow(as_text(["", made.title, made.basis, "", ""]))
    rows.writerows(as_text(["", name, value, "", ""]) for name, value in made.head)
    rows.writerow(as_text(["", made.verdict, "", "", ""]))
    for (name, verdict, value, limit, _), _ in made.checks:
        numbers = (text.replace("−", "-") for text in (value, limit))
        rows.writerow(as_text([made.words("check"), name, *numbers, verdict]))
    rows.writerow(["", "", made.words("formula"), made.words("run"), ""])
    for title, lines in made.tables:
        for line in lines:
            numbers = (text.replace("−", "-") for text in (line.value, line.found))
            rows.writerow(as_text([title, line.label.strip(), *numbers, line.unit]))
    return file.getvalue().encode("utf-8-sig")


def _step(made: Document) -> bytes:
    from coilset.meshes.drawings.step import step  # gmsh

    return step(made.body)[0]


WRITERS: dict[str, Callable[[Document], bytes]] = {
    ".html": _html,
    ".pdf": _pdf,
    ".csv": _csv,
    ".dxf": lambda made: dxf(made.drawing),
    ".step": _step,
}
