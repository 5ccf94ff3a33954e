"""Make the pictures of runs and commands that the pages show: run each as it stands, and keep what it draws.

    scripts/coilset python docs/generators/gallery.py            # three minutes of the processor; look at the pictures
    scripts/coilset python docs/generators/gallery.py cone       # one of the cases or commands

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
MATERIAL = EXAMPLES / "material"
# of another command: its words, and of what it draws the pictures that are kept, with their names in docs/pictures
COMMANDS: dict[str, tuple[list[str], dict[str, str]]] = {
    "drawing": (["mesh", str(EXAMPLES / "springs/closed_and_ground.yaml")], {"drawing": "spring_drawing"}),
    "functions": (["material", "show", "ck15"], {"functions": "material_functions"}),
    "fit": (
        ["material", "fit", *map(str, sorted((MATERIAL / "fit").glob("*.csv"))), "--G", "84000", "--nu", "0.28989"],
        {"fit": "material_fit_example"},
    ),
    **{
        name: (["material", "test", "ck15", str(MATERIAL / f"{name}.yaml")], {name: f"material_{name}"})
        for name in ("tension_torsion", "torsion_reversal", "torsion_tension")
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


def draw_command(name: str) -> None:
    """Run a command into a folder of its own, and keep its pictures."""
    words, kept = COMMANDS[name]
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "coilset.scripts", *words, "--out", folder, "--overwrite"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        for picture, place in kept.items():
            shutil.copyfile(Path(folder, f"{picture}.png"), DOCS / "pictures" / f"{place}.png")
    print(name)


if __name__ == "__main__":
    for one in sys.argv[1:] or [*CASES, *COMMANDS]:
        (draw if one in CASES else draw_command)(one)
