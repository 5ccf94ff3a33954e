"""The pictures of the pages are those of the runs that the text beside them describes."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml
from PIL import Image

REPOSITORY = Path(__file__).resolve().parents[2]
PICTURES = REPOSITORY / "docs" / "pictures"
TABLE = yaml.safe_load((REPOSITORY / "docs/generators/pictures.yaml").read_text(encoding="utf-8"))
MADE = {place: name for name, entry in TABLE.items() for place in entry["pictures"].values()}
PAGES = {
    path.relative_to(REPOSITORY).as_posix(): path.read_text(encoding="utf-8")
    for path in [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
}
NUMBER = re.compile(r"(?<![\w.,])([-−]?\d[\d,]*(?:\.\d+)?)(?: ± [\d.]+)?\s(N/mm|N mm|N|mm|MPa|Hz|%)(?![\w/])")
NEAR = 0.02  # two numbers of one unit that differ by less are meant to be the same


def test_each_picture_is_made_by_one_entry_of_the_table():
    there = sorted(path.relative_to(PICTURES).with_suffix("").as_posix() for path in PICTURES.rglob("*.png"))
    listed = sorted(place for entry in TABLE.values() for place in entry["pictures"].values())
    assert listed == there


def numbers(text):
    """Value and half of a last digit of each number of a unit that a text states."""
    for number, unit in NUMBER.findall(text):
        plain = number.replace(",", "").replace("−", "-")
        yield float(plain), unit, 0.5 * 10.0 ** -len(plain.partition(".")[2])


def differing(title, page):
    """Numbers of a title that a page states, too, but with other digits."""
    stated = list(numbers(page))
    for value, unit, half in numbers(title):
        near = [
            (abs(other - value), half_of_other)
            for other, unit_of_other, half_of_other in stated
            if unit_of_other == unit and value and abs(other / value - 1.0) < NEAR
        ]
        if near and all(apart > 1.0001 * max(half, half_of_other) for apart, half_of_other in near):
            yield f"{value:g} {unit}"


@pytest.mark.parametrize("place", sorted(place for place, name in MADE.items() if "long" not in TABLE[name]))
def test_numbers_of_titles_are_those_of_the_pages(place):
    with Image.open(PICTURES / f"{place}.png") as picture:
        title = picture.text.get("Title", "")
    showing = [text for text in PAGES.values() if f"pictures/{place}.png" in text]
    accepted = TABLE[MADE[place]].get("others", [])
    assert [one for text in showing for one in differing(title, text) if one not in accepted] == [], title


def test_a_picture_of_another_run_is_found():
    page = "| maximum force | 253.4 ± 0.3 N |, set 13.288 ± 0.006 mm, block 17.5000 mm"
    assert list(differing("Compressed with up to 254.4 N, the spring sets 13.28 mm", page)) == ["254.4 N", "13.28 mm"]
    assert list(differing("Compressed with up to 253.4 N, the spring sets 13.29 mm to 17.5 mm; 1:48 Hz", page)) == []


def test_the_picture_of_the_rooms_is_of_todays_plan():
    """`pictures.py rooms` draws it again."""
    rooms = tomllib.loads((REPOSITORY / "model" / "rooms.toml").read_text(encoding="utf-8"))["rooms"]
    with Image.open(REPOSITORY / "docs" / "pictures" / "rooms.png") as picture:
        assert picture.text["Rooms"].split(", ") == list(rooms)
