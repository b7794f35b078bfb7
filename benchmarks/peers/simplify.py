"""simplify.py MESH.ply OUTPUT_FOLDER: a tenth of the triangles by Open3D's and VTK's decimations, defaults otherwise; prints the CPU seconds of
the decimation alone, best of three. `sansmesh assess` of what it writes gives the distances."""
import pathlib
import resource
import sys

import open3d
import vtk


def seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def best_of_three(run):
    times = []
    for _ in range(3):
        start = seconds()
        run()
        times.append(seconds() - start)
    return min(times)


source, folder = sys.argv[1], pathlib.Path(sys.argv[2])
mesh = open3d.io.read_triangle_mesh(source)
mesh.remove_unreferenced_vertices()
tenth = len(mesh.triangles) // 10
print("Open3D", best_of_three(lambda: mesh.simplify_quadric_decimation(tenth)))
open3d.io.write_triangle_mesh(str(folder / "open3d.ply"), mesh.simplify_quadric_decimation(tenth))

reader = vtk.vtkPLYReader()
reader.SetFileName(source)
reader.Update()
for name in ("vtkQuadricDecimation", "vtkDecimatePro"):
    def decimated(kind=getattr(vtk, name)):
        filter = kind()
        filter.SetInputData(reader.GetOutput())
        filter.SetTargetReduction(0.9)
        filter.Update()
        return filter.GetOutput()

    print(name, best_of_three(decimated))
    writer = vtk.vtkPLYWriter()
    writer.SetFileName(str(folder / f"{name}.ply"))
    writer.SetInputData(decimated())
    writer.Write()
