"""Opens a run in ParaView ready to look at: spheres as glyphs with their radius, bodies coloured by speed, walls
transparent, contacts as lines by their force.

  EPAFI_RUN=out/hopper paraview --script=tools/paraview_view.py
  EPAFI_RUN=out/hopper EPAFI_STATE=out/hopper/view.pvsm pvpython tools/paraview_view.py    # then: paraview
  out/hopper/view.pvsm EPAFI_RUN=out/hopper EPAFI_PNG=hopper.png EPAFI_MOVIE=hopper.ogv xvfb-run -a -w 5 -s "-screen 0
  1280x1024x24" pvpython tools/paraview_view.py

EPAFI_STATE: a state file that opens the run (by its absolute path) with one click. EPAFI_PNG: a picture of the last
frame. EPAFI_MOVIE: all frames (.ogv or .avi). pvpython draws into X11 windows: without a display, start it under
xvfb-run as above.
"""
import os

from paraview.simple import *  # noqa: F401,F403 (the way ParaView writes its own states)

folder = os.path.abspath(os.environ.get("EPAFI_RUN", "."))
frames = PVDReader(registrationName=os.path.basename(folder), FileName=os.path.join(folder, "frames.pvd"))
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToLast()
view = GetActiveViewOrCreate("RenderView")
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
frames.UpdatePipeline(scene.TimeKeeper.Time)

# the blocks of a frame, told apart by the arrays they carry
blocks = servermanager.Fetch(frames)
found = {}
for k in range(blocks.GetNumberOfBlocks() if hasattr(blocks, "GetNumberOfBlocks") else 1):
    data = blocks.GetBlock(k) if hasattr(blocks, "GetBlock") else blocks
    while data is not None and hasattr(data, "GetNumberOfBlocks"):
        data = data.GetBlock(0)
    if data is None:
        continue
    points, cells = data.GetPointData(), data.GetCellData()
    kind = "spheres" if points.HasArray("radius") else "contacts" if cells.HasArray("force_magnitude") else "surfaces"
    found.setdefault(kind, []).append(k)


def block(index):
    part = ExtractBlock(Input=frames)
    part.Selectors = ["/Root/Block%d" % index]
    return part


for kind, indices in found.items():
    for index in indices:
        part = block(index)
        if kind == "spheres":
            glyph = Glyph(Input=part, GlyphType="Sphere", GlyphMode="All Points", ScaleArray=["POINTS", "radius"],
                          ScaleFactor=2.0)
            glyph.GlyphType.ThetaResolution, glyph.GlyphType.PhiResolution = 12, 10
            ColorBy(Show(glyph, view), ("POINTS", "speed"))
        elif kind == "contacts":
            lines = Show(part, view)
            ColorBy(lines, ("CELLS", "force_magnitude"))
            lines.LineWidth = 2
        else:
            surface = Show(part, view)
            fixed = servermanager.Fetch(part)
            speed = part.CellData.GetArray("speed")
            at_rest = speed is not None and speed.GetRange(0)[1] == 0.0
            is_last = len(indices) > 0 and index == max(i for v in found.values() for i in v)
            if at_rest and kind == "surfaces" and is_last:
                surface.Opacity = 0.15  # walls come last in a frame
            else:
                ColorBy(surface, ("CELLS", "speed"))
camera = view.CameraPosition
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0.4, -1, 0.35], [0, 0, 0], [0, 0, 1]
ResetCamera(view)
Render(view)
if os.environ.get("EPAFI_PNG"):
    SaveScreenshot(os.environ["EPAFI_PNG"], view, ImageResolution=[900, 900])
if os.environ.get("EPAFI_STATE"):
    SaveState(os.path.abspath(os.environ["EPAFI_STATE"]))
if os.environ.get("EPAFI_MOVIE"):
    SaveAnimation(os.environ["EPAFI_MOVIE"], view, ImageResolution=[800, 800], FrameRate=15)
