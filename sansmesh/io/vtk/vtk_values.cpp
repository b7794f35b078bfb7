#include "sansmesh/io/vtk/vtk_values.h"

#include <vtkDataArray.h>
#include <vtkType.h>

namespace sansmesh::inline v1::io {
namespace {

template <class To, class From>
AttributeValues copied(const void* from, std::size_t tuples, std::size_t components,
                       const std::vector<std::uint32_t>* rows) {
  const From* const p = static_cast<const From*>(from);
  std::vector<To> to;
  if (!rows) {
    to.assign(p, p + tuples * components);
  } else {
    to.reserve(rows->size() * components);
    for (const std::uint32_t r : *rows) to.insert(to.end(), p + r * components, p + (r + std::size_t{1}) * components);
  }
  return to;
}

}  // namespace

AttributeValues values_of(vtkDataArray& array, const std::vector<std::uint32_t>* rows) {
  const std::size_t n = static_cast<std::size_t>(array.GetNumberOfTuples());
  const std::size_t c = static_cast<std::size_t>(array.GetNumberOfComponents());
  if (array.HasStandardMemoryLayout() && array.GetDataType() != VTK_BIT) {
    const void* const p = array.GetVoidPointer(0);
    switch (array.GetDataType()) {
      case VTK_CHAR:
      case VTK_SIGNED_CHAR:
        return copied<std::int8_t, signed char>(p, n, c, rows);
      case VTK_UNSIGNED_CHAR:
        return copied<std::uint8_t, unsigned char>(p, n, c, rows);
      case VTK_SHORT:
        return copied<std::int16_t, short>(p, n, c, rows);
      case VTK_UNSIGNED_SHORT:
        return copied<std::uint16_t, unsigned short>(p, n, c, rows);
      case VTK_INT:
        return copied<std::int32_t, int>(p, n, c, rows);
      case VTK_UNSIGNED_INT:
        return copied<std::uint32_t, unsigned int>(p, n, c, rows);
      case VTK_LONG:
        return copied<std::int64_t, long>(p, n, c, rows);
      case VTK_UNSIGNED_LONG:
        return copied<std::uint64_t, unsigned long>(p, n, c, rows);
      case VTK_LONG_LONG:
        return copied<std::int64_t, long long>(p, n, c, rows);
      case VTK_UNSIGNED_LONG_LONG:
        return copied<std::uint64_t, unsigned long long>(p, n, c, rows);
      case VTK_ID_TYPE:
        return copied<std::int64_t, vtkIdType>(p, n, c, rows);
      case VTK_FLOAT:
        return copied<float, float>(p, n, c, rows);
      default:
        break;
    }
    if (array.GetDataType() == VTK_DOUBLE) return copied<double, double>(p, n, c, rows);
  }
  std::vector<double> all(n * c);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < c; ++k)
      all[i * c + k] = array.GetComponent(static_cast<vtkIdType>(i), static_cast<int>(k));
  }
  if (array.GetDataType() == VTK_FLOAT) {
    std::vector<float> narrow(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) narrow[i] = static_cast<float>(all[i]);
    return copied<float, float>(narrow.data(), n, c, rows);
  }
  return copied<double, double>(all.data(), n, c, rows);
}

}  // namespace sansmesh::inline v1::io
