"""The program's content: a digest of its files and, in a checkout, the commit, to trace a result to its code."""

import hashlib
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDERS, SUFFIXES = ("meshes", "model", "scripts"), (".py", ".yaml", ".html", ".js", ".css", ".mplstyle")
DIGEST_BYTES = 6


@cache
def digest(root: Path = ROOT) -> str:
    """Digest of the names and the content of all files that a result may depend on, 12 hexadecimal digits."""
    content = hashlib.blake2b(digest_size=DIGEST_BYTES)
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                content.update(f"{path.relative_to(root).as_posix()}\0".encode() + path.read_bytes() + b"\0")
    return content.hexdigest()


def commit(root: Path = ROOT) -> str | None:
    """The commit that a checkout is at, 12 digits; None outside of one. Changed files show in the digest only."""
    try:
        git = root / ".git"
        if git.is_file():  # of a linked work tree
            git = (root / git.read_text(encoding="utf-8").partition("gitdir:")[2].strip()).resolve()
        head = (git / "HEAD").read_text(encoding="utf-8").strip()
        if not head.startswith("ref:"):
            return head[:12]
        name = head.removeprefix("ref:").strip()
        shared = git / "commondir"
        common = (git / shared.read_text(encoding="utf-8").strip()).resolve() if shared.is_file() else git
        if (common / name).is_file():
            return (common / name).read_text(encoding="utf-8").strip()[:12]
        packed = (common / "packed-refs").read_text(encoding="utf-8").splitlines()
        return next((line[:12] for line in packed if line.endswith(f" {name}")), None)
    except OSError:
        return None


def described(root: Path = ROOT) -> str:
    """Digest and commit for people: `content 0a1b2c3d4e5f, commit 123456789abc`."""
    at = commit(root)
    return f"content {digest(root)}" + (f", commit {at}" if at else "")
