// Peer of benchmarks/compare_curvature: mean and Gaussian curvature of the vertices of a PLY file by vtkCurvatures, one
// line each.
#include <vtkCurvatures.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <cstdio>

int main(int count, char** arguments) {
  if (count != 2) return 2;
  vtkNew<vtkPLYReader> reader;
  reader->SetFileName(arguments[1]);
  vtkNew<vtkCurvatures> mean, gaussian;
  for (vtkCurvatures* const filter : {mean.Get(), gaussian.Get()}) filter->SetInputConnection(reader->GetOutputPort());
  mean->SetCurvatureTypeToMean();
  gaussian->SetCurvatureTypeToGaussian();
  mean->Update();
  gaussian->Update();
  vtkDataArray* const h = mean->GetOutput()->GetPointData()->GetArray("Mean_Curvature");
  vtkDataArray* const k = gaussian->GetOutput()->GetPointData()->GetArray("Gauss_Curvature");
  for (vtkIdType i = 0; i < h->GetNumberOfTuples(); ++i) std::printf("%.9g %.9g\n", h->GetTuple1(i), k->GetTuple1(i));
}
