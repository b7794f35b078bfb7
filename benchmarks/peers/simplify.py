"""simplify.py MESH.ply TRIANGLES OUTPUT.ply: simplifies a mesh by VTK's quadric decimation with volume preservation
(`vtkQuadricDecimation`), and prints the CPU seconds of the filter alone, best of three."""
import resource
import sys

from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkQuadricDecimation
from vtkmodules.vtkIOPLY import vtkPLYReader, vtkPLYWriter


def seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


source, triangles, output = sys.argv[1], int(sys.argv[2]), sys.argv[3]
reader = vtkPLYReader()
reader.SetFileName(source)
clean = vtkCleanPolyData()
clean.SetInputConnection(reader.GetOutputPort())
clean.Update()
mesh = clean.GetOutput()
best = float("inf")
for _ in range(3):
    decimation = vtkQuadricDecimation()
    decimation.SetInputData(mesh)
    decimation.VolumePreservationOn()
    decimation.SetTargetReduction(1 - triangles / mesh.GetNumberOfPolys())
    start = seconds()
    decimation.Update()
    best = min(best, seconds() - start)
print(best)
writer = vtkPLYWriter()
writer.SetFileName(output)
writer.SetInputData(decimation.GetOutput())
writer.Write()
