"""PNG images that carry their titles as text: what a picture states can be read by a program, too."""

from pathlib import Path

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from coilset.model.core.results.files.folder import whole

COMPRESSION = 3  # of PNG, from 1 to 9: files 8 % larger than by 6, in half of the time
DPI = 96.0  # of a picture that has no size in print


def write(path: str | Path, pixels: np.ndarray, title: str, dpi: float = DPI) -> None:
    """Write a PNG whose field Title holds the titles.

    Args:
        path: of the file.
        pixels: shape (rows, columns, 3 or 4), bytes.
        title: titles and captions of the picture.
        dpi: pixels an inch.
    """
    fields = PngInfo()
    fields.add_itxt("Title", title)
    picture = Image.fromarray(pixels).convert("RGB")
    with whole(path) as partial:
        picture.save(partial, "png", dpi=(dpi, dpi), compress_level=COMPRESSION, pnginfo=fields)
