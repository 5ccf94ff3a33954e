"""Keys of cases: digests that identify what a case computes, so that results are found again and belong to it."""

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Literal

from coilset.model.core.base.version import __version__
from coilset.model.core.case.case import Case, NamedWire
from coilset.model.core.material import library
from coilset.model.tools.wires import wire

KEY_BYTES = 12
KEY_LENGTH = 2 * KEY_BYTES + 1  # letters at most

Model = Literal["rod", "uniform_rod"]


class Keys:
    """Keys of the cases of one sweep or search, for all of which a file is read once."""

    def __init__(self) -> None:
        self._of_material, self._of_file = cache(self._material_digest), cache(_file_digest)
        self.law = cache(library.load)

    @property
    def sources(self) -> int:
        """How many materials and files the keys so far contain."""
        return self._of_material.cache_info().misses + self._of_file.cache_info().misses

    def __call__(self, case: Case, model: Model = "rod") -> str:
        """Digest of a case: its entries, its material's constants, the file of a measured spring, and the version; with
        `u` behind it for its estimate by the uniform rod."""
        content = {"version": __version__} | case.model_dump(mode="json")
        content["material"] = self._of_material(case.material)
        if "file" in content["spring"]:
            content["spring"]["file"] = self._of_file(Path(content["spring"]["file"]))
        return _digest(json.dumps(content, sort_keys=True).encode()) + ("u" if model == "uniform_rod" else "")

    def _material_digest(self, material: str | NamedWire) -> str:
        """Digest of a material's constants, so that a changed material file makes new cases."""
        if isinstance(material, NamedWire):  # its diameter is that of the spring, which is in the digest of the case
            return _digest(wire(material.wire).entry.model_dump_json().encode())
        return _digest(self.law(material).content())


def as_rod(key: str) -> str:
    """The key of a case as a rod, from the one of any model."""
    return key.rstrip("u")


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=KEY_BYTES).hexdigest()


def _file_digest(path: Path) -> str:
    """Digest of a file; nothing if it cannot be read or is none, such as a device, which its case will report."""
    try:
        return _digest(path.read_bytes()) if path.is_file() else ""
    except OSError:
        return ""
