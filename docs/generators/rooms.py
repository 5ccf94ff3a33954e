"""Draw the rooms of model/rooms.toml on their floors: docs/pictures/rooms.png, by `pictures.py rooms`.

python3 docs/generators/rooms.py FOLDER
"""

import sys
import tomllib
from pathlib import Path

import matplotlib as mpl

mpl.use("agg")
import matplotlib.pyplot as plt
from matplotlib.patches import FancyBboxPatch

ROOT = Path(__file__).resolve().parents[2]
WIDTH, BOX, GAP, ROW, LABEL = 10.0, 1.3, 0.1, 0.48, 1.45  # inches
COLOURS = {"core": "#c9d9ec", "physics": "#d7e8cd", "compose": "#f6e3b4", "tools": "#f0d3cf", "face": "#e2d9ec"}
HOLDS = {
    "core": "the mechanics of one run",
    "physics": "packages that may be\nadded to it",
    "compose": "a run of both",
    "tools": "packages that work\nwith runs",
    "face": "what people and\nprograms call",
}


def plan() -> dict:
    """Content of model/rooms.toml."""
    return tomllib.loads((ROOT / "model" / "rooms.toml").read_text(encoding="utf-8"))


def lines(patterns: list[str]) -> int:
    """Number of lines of a room's files."""
    files = {path for pattern in patterns for path in ROOT.glob(pattern) if path.suffix == ".py"}
    return sum(path.read_text(encoding="utf-8").count("\n") for path in files)


def draw(folder: Path) -> None:
    """Draw rooms.png; its metadata have the names of the rooms."""
    rooms = plan()["rooms"]
    across = int((WIDTH - LABEL) // (BOX + GAP))
    floors = plan()["floors"]
    on = {floor: [name for name, room in rooms.items() if room["floor"] == floor] for floor in floors}
    heights = {floor: -(-len(names) // across) * (ROW + GAP) + GAP for floor, names in on.items()}
    total = sum(heights.values()) + GAP * len(floors)
    figure = plt.figure(figsize=(WIDTH, total))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, WIDTH), ylim=(0, total))
    axes.axis("off")
    bottom = 0.0
    for floor in floors:
        height = heights[floor]
        band = "round,pad=0.02"
        axes.add_patch(
            FancyBboxPatch((0.06, bottom + 0.06), WIDTH - 0.12, height - 0.08, band, fc=COLOURS[floor], ec="none")
        )
        axes.text(0.16, bottom + 0.5 * height + 0.09, floor, weight="bold", size=11, va="bottom")
        axes.text(0.16, bottom + 0.5 * height + 0.06, HOLDS[floor], size=6.5, va="top", color="#333333")
        for number, name in enumerate(on[floor]):
            row, column = divmod(number, across)
            x, y = LABEL + column * (BOX + GAP), bottom + height - GAP - (row + 1) * (ROW + GAP) + GAP
            size = f"{round(lines(rooms[name]['files']), -2):,} lines"
            axes.add_patch(FancyBboxPatch((x, y), BOX, ROW, "round,pad=0.01", fc="white", ec="#777777", lw=0.6))
            axes.text(x + 0.5 * BOX, y + 0.60 * ROW, name.replace("_", " "), ha="center", va="center", size=8)
            axes.text(x + 0.5 * BOX, y + 0.24 * ROW, size, ha="center", va="center", size=6, color="#555555")
        bottom += height + GAP
    figure.savefig(folder / "rooms.png", dpi=150, metadata={"Rooms": ", ".join(rooms)})


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
