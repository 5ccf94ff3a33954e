"""Files of grids for ParaView that a full disk cannot spoil."""

from pathlib import Path

import pyvista
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from coilset.model.core.results.files.folder import whole


def write_grid(path: str | Path, grid: pyvista.UnstructuredGrid) -> None:
    """Write a grid to a .vtu file. VTK makes its text in memory, because on a full disk its own files end in a crash.

    Raises:
        CoilsetError: if the file cannot be written.
    """
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()  # base64, which is text
    writer.WriteToOutputStringOn()
    writer.Write()
    with whole(path) as part:
        part.write_text(writer.GetOutputString(), encoding="ascii")
