"""Make the pictures of runs that the pages show: solve each case as it stands, and keep what it draws.

    scripts/coilset python docs/generators/gallery.py            # two minutes of the processor; look at the pictures
    scripts/coilset python docs/generators/gallery.py cone       # one of the cases

Not part of building the site.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
EXAMPLES = DOCS.parent / "examples"
# of a case: its file, where its pictures begin in docs/pictures, and which of them are kept
CASES = {
    "ck15_presetting": (EXAMPLES / "ck15_presetting.yaml", "", ("springs", "characteristic", "cross_section")),
    "first": (DOCS / "tutorial" / "first-spring.md", "tutorial/first_", ("characteristic", "cross_section")),
    **{
        name: (EXAMPLES / "springs" / f"{name}.yaml", f"gallery/{name}_", ("springs", "characteristic"))
        for name in ("closed_and_ground", "cone")
    },
}


def draw(name: str) -> None:
    """Solve a case into a folder of its own, and keep its pictures."""
    file, begin, kept = CASES[name]
    with tempfile.TemporaryDirectory() as folder:
        if file.suffix == ".md":  # the first case that the page shows
            shown = re.search(r"^```yaml\n(.*?)^```$", file.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
            assert shown
            file = Path(folder, f"{name}.yaml")
            file.write_text(shown[1], encoding="utf-8")
        results = Path(folder, "results")
        command = [sys.executable, "-m", "coilset.scripts", "solve", str(file), "--out", str(results)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        for picture in kept:
            shutil.copyfile(results / f"{picture}.png", DOCS / "pictures" / f"{begin}{picture}.png")
    print(name)


if __name__ == "__main__":
    for case in sys.argv[1:] or CASES:
        draw(case)
