#!/usr/bin/env python3
"""Draws a run without a display: one PNG, or a movie of all frames.

  xvfb-run -a -s "-screen 0 1280x1024x24" /usr/bin/python3 tools/render_run.py out/hopper --png hopper.png
  ... --movie hopper.ogv                      # all frames, 15 per second
  ... --frame 7 --colour normal_force --chains

Needs Debian's python3-vtk9 and xvfb (its VTK draws into X11 windows only). Reads frames.pvd and what it names.
"""
import argparse
import os
import sys
import xml.etree.ElementTree as xml

import vtk

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("folder")
parser.add_argument("--png", help="picture of one frame")
parser.add_argument("--movie", help="Ogg Theora movie of all frames")
parser.add_argument("--frame", type=int, default=-1, help="which, from 0; the last where not given")
parser.add_argument("--colour", default="speed", help="speed, kinetic_energy, id, material")
parser.add_argument("--chains", action="store_true", help="contacts as tubes, as thick as their force")
parser.add_argument("--size", type=int, nargs=2, default=(1000, 1000))
parser.add_argument("--azimuth", type=float, default=25, help="degrees about the vertical")
options = parser.parse_args()
if not options.png and not options.movie:
    parser.error("give --png or --movie")

frames = {}  # time -> files
for data in xml.parse(os.path.join(options.folder, "frames.pvd")).getroot().iter("DataSet"):
    frames.setdefault(float(data.get("timestep")), []).append(os.path.join(options.folder, data.get("file")))
times = sorted(frames)
if not times:
    sys.exit("no frames in " + options.folder)


def read(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def largest(name):
    top = 0.0
    for t in times:
        for path in frames[t]:
            if "walls" in path or "contacts" in path:
                continue
            data = read(path)
            for holder in (data.GetPointData(), data.GetCellData()):
                if holder.GetArray(name):
                    top = max(top, holder.GetArray(name).GetRange(-1)[1])
    return top


colours = vtk.vtkColorTransferFunction()
for share, r, g, b in ((0, .27, .33, .55), (.25, .16, .48, .62), (.5, .2, .65, .5), (.75, .6, .8, .3),
                       (1, .98, .88, .15)):
    colours.AddRGBPoint(share * (largest(options.colour) or 1.0), r, g, b)


def actor(mapper, opacity=1.0, colour=None):
    a = vtk.vtkActor()
    a.SetMapper(mapper)
    a.GetProperty().SetOpacity(opacity)
    a.GetProperty().SetSpecular(.15)
    if colour:
        mapper.ScalarVisibilityOff()
        a.GetProperty().SetColor(*colour)
    return a


def actors_of(path):
    data = read(path)
    if "walls" in path:
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(data)
        return actor(mapper, .16, (.55, .6, .7))
    if "contacts" in path:
        if not options.chains or data.GetNumberOfCells() == 0:
            return None
        top = data.GetCellData().GetArray("force_magnitude").GetRange()[1]
        data.GetCellData().SetActiveScalars("force_magnitude")
        to_points = vtk.vtkCellDataToPointData()
        to_points.SetInputData(data)
        tube = vtk.vtkTubeFilter()
        tube.SetInputConnection(to_points.GetOutputPort())
        bounds = data.GetBounds()
        tube.SetRadius(2e-4 * max(bounds[1] - bounds[0], bounds[5] - bounds[4]))
        tube.SetVaryRadiusToVaryRadiusByScalar()
        tube.SetRadiusFactor(25)
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(tube.GetOutputPort())
        mapper.SetScalarRange(0, top)
        return actor(mapper, 1.0, (.75, .2, .15))
    spheres = "spheres" in path
    if spheres:
        source = vtk.vtkSphereSource()
        source.SetRadius(1.0)
        source.SetThetaResolution(16)
        source.SetPhiResolution(12)
        mapper = vtk.vtkGlyph3DMapper()
        mapper.SetInputData(data)
        mapper.SetSourceConnection(source.GetOutputPort())
        mapper.SetScaleArray("radius")
        mapper.SetScaleModeToScaleByMagnitude()
        mapper.SetScalarModeToUsePointFieldData()
    else:
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(data)
        mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(options.colour)
    mapper.SetLookupTable(colours)
    mapper.SetColorModeToMapScalars()
    return actor(mapper, .25 if options.chains else 1.0)


renderer = vtk.vtkRenderer()
renderer.SetBackground(1, 1, 1)
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetMultiSamples(8)
window.SetSize(*options.size)
window.AddRenderer(renderer)


def show(time, first):
    renderer.RemoveAllViewProps()
    for path in frames[time]:
        a = actors_of(path)
        if a:
            renderer.AddActor(a)
    if first:
        renderer.ResetCamera()
        camera = renderer.GetActiveCamera()
        x = camera.GetFocalPoint()
        camera.SetPosition(x[0], x[1] - 1, x[2] + .35)
        camera.SetViewUp(0, 0, 1)
        camera.Azimuth(options.azimuth)
        box = vtk.vtkBoundingBox()
        for path in frames[time]:  # what moves fills the picture
            if "walls" not in path and "contacts" not in path:
                box.AddBounds(read(path).GetBounds())
        bounds = [0.0] * 6
        box.GetBounds(bounds)
        renderer.ResetCamera(bounds)
        camera.Zoom(1.1)
        renderer.ResetCameraClippingRange()
    window.Render()


def grabbed():
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    return grab


if options.png:
    show(times[options.frame], True)
    grab, writer = grabbed(), vtk.vtkPNGWriter()
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(options.png)
    writer.Write()
if options.movie:
    show(times[-1], True)  # the camera sees where everything ends
    grab, writer = grabbed(), vtk.vtkOggTheoraWriter()
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(options.movie)
    writer.SetRate(15)
    writer.Start()
    for t in times:
        show(t, False)
        grab.Modified()
        writer.Write()
    writer.End()
