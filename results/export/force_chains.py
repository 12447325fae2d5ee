"""Force chains as tubes in ParaView, from what `softgrain export --to vtp` writes; draws a picture without a screen.

    pvpython force_chains.py EXPORT_DIRECTORY SERIES PICTURE.png

The same steps work in ParaView's window: open both .pvd files; Glyph with spheres scaled by radius; Tube with "Vary Radius: By Scalar".
"""
import sys

from paraview.simple import (Glyph, GetActiveViewOrCreate, GetColorTransferFunction, GetScalarBar, PVDReader, Render,
                             ResetCamera, SaveScreenshot, Show, ColorBy, Tube)

directory, series, picture = sys.argv[1:4]
particles = PVDReader(FileName=f"{directory}/{series}_particles.pvd")
contacts = PVDReader(FileName=f"{directory}/{series}_contacts.pvd")
for reader in (particles, contacts):
    reader.UpdatePipeline()
last = contacts.TimestepValues[-1] if hasattr(contacts.TimestepValues, "__len__") else contacts.TimestepValues
for reader in (particles, contacts):
    reader.UpdatePipeline(last)

view = GetActiveViewOrCreate("RenderView")
view.ViewSize = [1200, 900]
view.ViewTime = last
view.Background = [1.0, 1.0, 1.0]
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 0

# Spheres of their own size: the glyph has radius 1 and is scaled by the array "radius".
spheres = Glyph(Input=particles, GlyphType="Sphere", ScaleArray=["POINTS", "radius"], ScaleFactor=1.0,
                GlyphMode="All Points")
spheres.ScaleFactor = 1.0  # once more: ParaView takes a guess of its own when the input is set
spheres.GlyphType.Radius = 1.0
spheres.GlyphType.ThetaResolution = spheres.GlyphType.PhiResolution = 24
grains = Show(spheres, view)
grains.ColorArrayName = ["POINTS", ""]
grains.AmbientColor = grains.DiffuseColor = [0.55, 0.65, 0.85]
grains.Opacity = 0.3

# Tubes as thick as the normal force: the array at the ends of every line; the thickest a tenth of the mean radius or so.
low, high = contacts.PointData["normal_force"].GetRange()
radius = particles.PointData["radius"].GetRange()
tubes = Tube(Input=contacts, Scalars=["POINTS", "normal_force"], VaryRadius="By Scalar", NumberofSides=12)
tubes.Radius = 0.02 * radius[1]
tubes.RadiusFactor = 12.0
chains = Show(tubes, view)
ColorBy(chains, ("POINTS", "normal_force"))
colours = GetColorTransferFunction("normal_force")
colours.ApplyPreset("Inferno (matplotlib)", True)
colours.InvertTransferFunction()
colours.RescaleTransferFunction(max(low, 0.0), high)
chains.SetScalarBarVisibility(view, True)
bar = GetScalarBar(colours, view)
bar.Title = "normal force [N]"
bar.ComponentTitle = ""
bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]

ResetCamera(view)
view.CameraViewUp = [0.0, 1.0, 0.0]
view.GetActiveCamera().Azimuth(20)
view.GetActiveCamera().Elevation(15)
view.GetActiveCamera().Zoom(1.35)
Render(view)
SaveScreenshot(picture, view, ImageResolution=[1200, 900])
print(f"time {last:g}: {particles.GetDataInformation().GetNumberOfPoints()} particles, "
      f"{contacts.GetDataInformation().GetNumberOfCells()} contacts, normal force {low:.3g} to {high:.3g} N")
