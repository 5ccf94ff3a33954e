"""Make the pictures of docs/pictures by the commands of pictures.yaml; look at them afterwards.

    scripts/coilset python docs/generators/pictures.py               # all but the long ones
    scripts/coilset python docs/generators/pictures.py readme cone   # some

Not part of building the site. A picture carries its titles as text, whose numbers tests/docs compares with the pages.
"""

import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import yaml

DOCS = Path(__file__).resolve().parents[1]
PICTURES = DOCS / "pictures"
TABLE: dict[str, dict[str, Any]] = yaml.safe_load((DOCS / "generators/pictures.yaml").read_text(encoding="utf-8"))
BLOCK = re.compile(r"^```yaml\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def make(name: str) -> None:
    """Run the commands of an entry in a folder of their own, and keep its pictures.

    Raises:
        FileNotFoundError: a picture is not drawn.
    """
    entry = TABLE[name]
    with tempfile.TemporaryDirectory() as folder:
        for file, (page, number) in entry.get("files", {}).items():
            blocks = BLOCK.findall((DOCS / page).read_text(encoding="utf-8"))
            Path(folder, f"{file}.yaml").write_text(blocks[number], encoding="utf-8")
        for command in entry["commands"]:  # of which `verify` ends with 1 where a number is off
            words = _words(command.replace("{out}", folder))
            subprocess.run(words, cwd=DOCS.parent, check=False, stdout=subprocess.DEVNULL)
        for picture, place in entry["pictures"].items():
            shutil.copyfile(Path(folder, f"{picture}.png"), PICTURES / f"{place}.png")


def _words(command: str) -> list[str]:
    words = shlex.split(command)
    if words[0] == "pvpython":
        return words
    return [sys.executable, *(words[1:] if words[0] == "python" else ["-m", "coilset.scripts", *words])]


if __name__ == "__main__":
    for one in sys.argv[1:] or [name for name, entry in TABLE.items() if "long" not in entry]:
        make(one)
        print(one, flush=True)
