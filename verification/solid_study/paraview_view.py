"""ParaView's pictures of the deformed section, from the files of `pictures.py`: `pvpython paraview_view.py FOLDER`.

Needs ParaView (Debian: paraview, python3-paraview), without a display under `xvfb-run -a`.
"""

import sys
from pathlib import Path

from paraview import simple

FIELDS = {"von Mises stress": "MPa", "plastic work": "N/mm²"}
BODIES = {"full_travel": "full travel", "released": "released"}


def draw(folder: Path, field: str, unit: str) -> None:
    """Both bodies beside each other, their far halves, coloured by a field: paraview_FIELD.png."""
    layout = simple.CreateLayout()
    layout.SplitHorizontal(0, 0.5)
    colors = simple.GetColorTransferFunction(field)
    colors.ApplyPreset("Viridis (matplotlib)", True)
    greatest = 0.0
    for place, (file, name) in enumerate(BODIES.items()):
        view = simple.CreateRenderView(
            UseColorPaletteForBackground=0, Background=[1, 1, 1], OrientationAxesVisibility=0
        )
        simple.AssignViewToLayout(view, layout, 1 + place)
        body = simple.XMLUnstructuredGridReader(FileName=[str(folder / f"{file}.vtu")])
        body.UpdatePipeline()
        greatest = max(greatest, body.PointData[field].GetRange()[1])
        half = simple.Clip(Input=body, ClipType="Plane", Invert=0)
        half.ClipType.Origin, half.ClipType.Normal = [0, 1e-3, 0], [0, 1, 0]
        shown = simple.Show(simple.Connectivity(Input=half, ExtractionMode="Extract Largest Region"), view)
        shown.Representation, shown.Ambient, shown.Diffuse = "Surface", 0.35, 0.75
        simple.ColorBy(shown, ("POINTS", field))
        bar = simple.GetScalarBar(colors, view)
        bar.Title, bar.ComponentTitle, bar.Orientation = f"{field} in {unit}", "", "Horizontal"
        bar.TitleColor = bar.LabelColor = [0, 0, 0]
        bar.WindowLocation, bar.ScalarBarLength, bar.TitleFontSize, bar.LabelFontSize = "Lower Center", 0.5, 20, 18
        shown.SetScalarBarVisibility(view, True)
        text = simple.Show(simple.Text(Text=name), view)
        text.Color, text.FontSize, text.WindowLocation = [0, 0, 0], 24, "Upper Center"
        view.CameraParallelProjection = 1
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [10, -100, 60], [0, 0, 0], [0, 0, 1]
        simple.Render(view)
        simple.ResetCamera(view)
        view.CameraParallelScale /= 1.6
    colors.RescaleTransferFunction(0.0, greatest)
    layout.SetSize(1440, 470)
    simple.SaveScreenshot(str(folder / f"paraview_{field.replace(' ', '_')}.png"), layout)


if __name__ == "__main__":
    for field, unit in FIELDS.items():
        draw(Path(sys.argv[1]), field, unit)
