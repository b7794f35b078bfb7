"""vtk_signed_distance.py CLOUD MESH: VTK's signed distance to oriented points on a grid of 256 cells along the longest
side with a radius of four cells (as in VTK's own examples), and the surface that VTK extracts from it."""
import sys

from vtkmodules.vtkFiltersPoints import vtkExtractSurface, vtkSignedDistance
from vtkmodules.vtkIOPLY import vtkPLYReader, vtkPLYWriter

CELLS = 256

reader = vtkPLYReader()
reader.SetFileName(sys.argv[1])
reader.Update()
box = reader.GetOutput().GetBounds()
cell = max(box[1] - box[0], box[3] - box[2], box[5] - box[4]) / CELLS
margin = 5 * cell
distance = vtkSignedDistance()
distance.SetInputConnection(reader.GetOutputPort())
distance.SetRadius(4 * cell)
distance.SetBounds(*(b + (margin if i % 2 else -margin) for i, b in enumerate(box)))
distance.SetDimensions(*(int((box[2 * i + 1] - box[2 * i] + 2 * margin) / cell) + 1 for i in range(3)))
surface = vtkExtractSurface()
surface.SetInputConnection(distance.GetOutputPort())
surface.SetRadius(4 * cell * 0.99)
surface.ComputeNormalsOff()
surface.ComputeGradientsOff()
writer = vtkPLYWriter()
writer.SetFileName(sys.argv[2])
writer.SetInputConnection(surface.GetOutputPort())
writer.Write()
