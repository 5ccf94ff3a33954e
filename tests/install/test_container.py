"""The container is made of the same packages as every other environment, and from the same commands."""

from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
LINES = (REPOSITORY / ".ci" / "Containerfile").read_text(encoding="utf-8").splitlines()


def test_it_installs_the_list_of_packages_and_nothing_else():
    installing = [line for line in LINES if "apt-get install" in line]
    assert len(installing) == 1
    assert installing[0].split("--no-install-recommends ")[1].startswith("$(cat scripts/packages.txt)")
    assert "COPY scripts/packages.txt scripts/wheels.txt scripts/" in LINES


def test_it_starts_the_launcher_of_its_checkout():
    assert LINES[-1] == 'ENTRYPOINT ["/coilset/scripts/coilset"]'
    assert (REPOSITORY / "scripts" / "coilset").stat().st_mode & 0o111


def test_the_page_on_installing_says_the_same_words():
    page = (REPOSITORY / "docs" / "install.md").read_text(encoding="utf-8")
    for line in LINES[2:4]:
        assert line.removeprefix("#   ") in page
