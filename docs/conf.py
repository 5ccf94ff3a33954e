"""The documentation as a site: `.ci/docs` builds it, with warnings as errors."""

import sys
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS / "generators"))

import command_pages  # noqa: E402
import demo_pages  # noqa: E402
import docstrings  # noqa: E402
import entry_pages  # noqa: E402
import formulas  # noqa: E402
import python_pages  # noqa: E402

from coilset.model.core.base.version import __version__  # noqa: E402

project, author = "coilset", "the authors of coilset"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_fence_as_directive = ["math"]  # so that ```math is a formula here as it is on code hosts
myst_heading_anchors = 3
exclude_patterns = ["_static", "generators"]
highlight_language = "none"  # of blocks that name none: commands, tables of numbers, formulas in plain text
default_role = "code"  # of single backticks in docstrings
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "ignore-module-all": True}
python_use_unqualified_type_names = True
napoleon_use_ivar = True  # attributes as fields of their class, so that none is described twice
suppress_warnings = ["ref.python"]  # two classes of one name, such as the Rod of two rooms: the link leads to the first

globals().update(formulas.configuration())

html_theme = "furo"  # page contents, dark mode, narrow screens
html_title = f"coilset {__version__}"
html_search_scorer = str(DOCS / "_static" / "scorer.js")
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_copyright = False
html_theme_options = {"top_of_page_buttons": []}  # no links to a repository that the pages do not have


def _own_environments(app: Sphinx, doctree: nodes.document) -> None:
    """Formulas that bring their own environment, such as align with its tags, get none around it."""
    for block in doctree.findall(nodes.math_block):
        if block.astext().lstrip().startswith(r"\begin{align"):
            block["nowrap"] = True


def _generate(app: Sphinx) -> None:
    """Write the pages that are read off the program."""
    entry_pages.write(DOCS / "reference" / "generated")
    command_pages.write(DOCS / "reference" / "generated")
    demo_pages.write(DOCS / "demos" / "generated")
    python_pages.write(DOCS / "reference" / "python")


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("builder-inited", _generate)
    app.connect("autodoc-skip-member", docstrings.skip)
    app.connect("autodoc-process-docstring", docstrings.process, priority=100)  # before napoleon
    app.connect("doctree-read", _own_environments)
    app.connect("build-finished", formulas.copy)
