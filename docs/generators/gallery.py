"""Make the gallery's pictures of shipped springs: solve each example as it stands, and keep what it draws.

    scripts/coilset python docs/generators/gallery.py            # a minute of the processor; look at the pictures
    scripts/coilset python docs/generators/gallery.py cone       # one of them

Not part of building the site.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PICTURES = REPOSITORY / "docs" / "pictures" / "gallery"
SPRINGS = ("closed_and_ground", "cone")
KEPT = ("springs", "characteristic")


def draw(name: str) -> None:
    """Solve one example into a folder of its own, and keep its pictures."""
    with tempfile.TemporaryDirectory() as folder:
        case = REPOSITORY / "examples" / "springs" / f"{name}.yaml"
        command = [sys.executable, "-m", "coilset.scripts", "solve", case, "--out", folder, "--force"]
        subprocess.run([*map(str, command)], check=True, stdout=subprocess.DEVNULL)
        for picture in KEPT:
            shutil.copyfile(Path(folder) / f"{picture}.png", PICTURES / f"{name}_{picture}.png")
    print(name)


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    for spring in sys.argv[1:] or SPRINGS:
        draw(spring)
