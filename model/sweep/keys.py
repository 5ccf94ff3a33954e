"""Keys of cases: digests that identify what a case computes, so that results are found again and belong to it."""

import hashlib
import json
from functools import cache
from pathlib import Path

from coilset.model.base.version import __version__
from coilset.model.case.case import Case, NamedWire
from coilset.model.material import library
from coilset.model.standards.wires import wire

KEY_BYTES = 12


class Keys:
    """Keys of the cases of one sweep or search, for all of which a file is read once."""

    def __init__(self) -> None:
        self._of_material, self._of_file = cache(_material_digest), cache(_file_digest)

    def __call__(self, case: Case) -> str:
        """Digest of a case: its entries, its material's constants, the file of a measured spring, and the version."""
        content = {"version": __version__} | case.model_dump(mode="json")
        content["material"] = self._of_material(case.material)
        if "file" in content["spring"]:
            content["spring"]["file"] = self._of_file(Path(content["spring"]["file"]))
        return _digest(json.dumps(content, sort_keys=True).encode())


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=KEY_BYTES).hexdigest()


def _material_digest(material: str | NamedWire) -> str:
    """Digest of a material's constants, so that a changed material file makes new cases."""
    if isinstance(material, NamedWire):  # its diameter is that of the spring, which is in the digest of the case
        return _digest(wire(material.wire).entry.model_dump_json().encode())
    return _digest(library.load(material).content())


def _file_digest(path: Path) -> str:
    """Digest of a file; that of an empty one if it cannot be read, which its case will report."""
    try:
        return _digest(path.read_bytes())
    except OSError:
        return ""
