"""No number of an equation, table or figure that the program cites lacks its place on a page of the theory."""

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
ROOMS = ("model", "meshes", "verification", "scripts", "tests")
THEORY = "\n".join(path.read_text(encoding="utf-8") for path in sorted((REPOSITORY / "docs/theory").glob("*.md")))
NUMBER = r"(?<![\d.])([3-7]\.\d\.\d{1,2})(?!\d|\.\d)"  # of the thesis: chapters 3 to 7


def sources(rooms=ROOMS):
    return [path for room in rooms for path in sorted((REPOSITORY / room).rglob("*.py"))]


def spread(first, last):
    """(4.4.6) to (4.4.13): all numbers between two of one section."""
    head, start, stop = first.rpartition(".")[0], int(first.rpartition(".")[2]), int(last.rpartition(".")[2])
    return {f"{head}.{number}" for number in range(start, stop + 1)}


def numbers(text):
    """Equation numbers in a text, those within a range included."""
    found = set(re.findall(NUMBER, text))
    for first, last in re.findall(NUMBER + r"\)?(?:[–-]| to )\(?" + NUMBER, text):
        found |= spread(first, last)
    return found


def cited(pattern, rooms=ROOMS):
    """What the sources cite, and where first."""
    found = {}
    for path in sources(rooms):
        if path != Path(__file__).resolve():
            for number in re.findall(pattern, path.read_text(encoding="utf-8")):
                found.setdefault(number, path.relative_to(REPOSITORY))
    return found


def test_every_equation_number_has_its_equation():
    tagged = set()
    for tag in re.findall(r"\\tag\{([^}]*)\}", THEORY):
        tagged |= numbers(tag)
    sections = set(re.findall(r"^\| section (\d\.\d\.\d) \|", THEORY, re.MULTILINE))
    assert sections == {"5.2.5", "6.2.2", "7.1.1", "7.1.2", "7.2.2"}  # of the thesis, and no way around an equation
    found = {}
    for path in sources():
        if path != Path(__file__).resolve():
            for number in numbers(path.read_text(encoding="utf-8")):
                found.setdefault(number, path.relative_to(REPOSITORY))
    assert len(found) > 25
    assert {number: path for number, path in found.items() if number not in tagged | sections} == {}


def test_a_range_is_all_of_its_numbers():
    assert numbers("(4.4.6–4.4.8), (3.1.6, 3.1.8), 10.3.2, 1.2.2") == {"4.4.6", "4.4.7", "4.4.8", "3.1.6", "3.1.8"}


def test_a_number_at_the_end_of_a_sentence_is_one():
    assert numbers("By 3.1.4. And 5.2.33.") == {"3.1.4", "5.2.33"}


@pytest.mark.parametrize("kind", ["Table", "figure"])
def test_every_table_and_figure_of_the_thesis_is_placed(kind):
    """Of the thesis: two numbers, as in Table 5.2; a standard's have one."""
    named = set()
    for text in re.findall(rf"^\| {kind}s? ([^|]*)\|", THEORY, re.MULTILINE):
        named |= set(re.findall(r"\d\.\d+", text))
        for first, last in re.findall(r"(\d\.\d+) to (\d\.\d+)", text):
            named |= spread(first, last)
    found = {}
    for words, path in cited(rf"{kind}s? (\d\.\d+(?:(?: to |, | and )\d\.\d+)*)(?!\d|\.\d)").items():
        found |= {number: path for number in re.findall(r"\d\.\d+", words)}
    assert found
    assert {number: path for number, path in found.items() if number not in named} == {}


def test_every_page_that_the_code_names_is_there():
    named = cited(r"\bdocs/[\w/-]+\.(?:md|ipynb)\b", ("model", "meshes", "verification", "scripts"))
    assert len(named) > 5
    assert {page: path for page, path in named.items() if not (REPOSITORY / page).is_file()} == {}
