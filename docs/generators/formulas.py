"""MathJax inside the site, so that formulas are readable without a network.

Debian's libjs-mathjax (2.7, which PETSc's package brings along) is copied into the site, 1.6 MB of it: TeX input, HTML
output, fonts. Where it is not installed, as under conda, the pages load Sphinx's MathJax from the network instead.
"""

import shutil
from pathlib import Path

from sphinx.application import Sphinx

INSTALLED = Path("/usr/share/javascript/mathjax")
PARTS = (
    "MathJax.js",
    "config/TeX-AMS_CHTML.js",
    "extensions",
    "fonts/HTML-CSS/TeX/woff",
    "jax/element",
    "jax/input/TeX",
    "jax/output/CommonHTML",
)


def configuration() -> dict[str, object]:
    """Entries of conf.py; empty where MathJax is not installed."""
    if not all((INSTALLED / part).exists() for part in PARTS):
        return {}
    return {
        "mathjax_path": "mathjax/MathJax.js",
        "myst_update_mathjax": False,  # it sets version 3; here is the same for 2.7
        "mathjax2_config": {
            "config": ["TeX-AMS_CHTML.js"],
            "tex2jax": {"processClass": "tex2jax_process|math"},
            "messageStyle": "none",
            "showMathMenu": False,
        },
    }


def copy(app: Sphinx, error: Exception | None) -> None:
    """Copy MathJax beside the site's other scripts, when the pages are written."""
    target = Path(app.outdir) / "_static" / "mathjax"
    if error is not None or not configuration() or target.exists():
        return
    for part in PARTS:
        (target / part).parent.mkdir(parents=True, exist_ok=True)
        if (INSTALLED / part).is_dir():
            shutil.copytree(INSTALLED / part, target / part)
        else:
            shutil.copyfile(INSTALLED / part, target / part)
