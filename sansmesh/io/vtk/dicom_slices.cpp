#include "sansmesh/io/vtk/dicom_slices.h"

#include <vtkDICOMImageReader.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/io/binary.h"
#include "sansmesh/io/vtk/vtk_values.h"

namespace sansmesh::inline v1::io {
namespace {

struct Slice {
  std::string file;
  Vec3 position, along_row, along_column;  ///< position of the first number; unit vectors
  double column_step = 1, row_step = 1;    ///< between columns, between rows
  double thickness = 1;
  double at = 0;                        ///< along the normal
  vtkSmartPointer<vtkImageData> image;  ///< its rows are upside down
  int columns() const { return image->GetDimensions()[0]; }
  int rows() const { return image->GetDimensions()[1]; }
};

[[noreturn]] void fail(const std::string& what, const std::string& file) {
  throw std::runtime_error(what + " (" + std::filesystem::path(file).filename().string() + ")");
}

void check_syntax(const std::string& syntax, const std::string& file) {
  for (const char* packed : {"1.2.840.10008.1.2.4", "1.2.840.10008.1.2.5", "1.2.840.10008.1.2.1.99"})
    if (syntax.find(packed) != std::string::npos) fail("holds compressed pixels, which are not read", file);
  if (syntax.find("1.2.840.10008.1.2.2") != std::string::npos)
    fail("holds a big-endian slice, which is not read", file);
}

/// Position and announced length of a tag's value; a length below 0 is unknown.
struct Tag {
  std::uint32_t name = 0;  ///< group, element
  std::int64_t value = 0, length = 0;
};

/// Checks the tags of a slice, because VTK's reader trusts them: visits them as that reader does (into sequences of
/// unknown length, past others) and throws std::runtime_error where it would read beyond the file.
class TagReader {
 public:
  explicit TagReader(const std::string& file)
      : file_(file),
        stream_(file, std::ios::binary),
        size_(static_cast<std::int64_t>(std::filesystem::file_size(file))) {}

  /// Size of the pixel data in bytes, which all exist.
  std::int64_t pixel_bytes() {
    std::int64_t pixels = -1;
    for (std::int64_t at = begin(); at + 8 <= size_;) {
      const Tag tag = tag_at(at);
      const bool beyond = tag.length > size_ - tag.value, of_pixels = tag.name == 0x7fe00010;
      const std::int64_t length = std::max<std::int64_t>(0, tag.length);
      if (pixels >= 0 && of_pixels) fail("holds several images in one file", file_);
      if (pixels >= 0 && tag.name >> 16 == 0x0028) fail("holds pixels before their description", file_);
      if (pixels >= 0 && beyond) break;  // data after the pixels are irrelevant
      if (beyond) fail("holds a truncated slice", file_);
      check(tag);
      names_.push_back(tag.name);
      if (tag.name == 0x00020010) check_syntax(bytes(tag.value, length), file_);
      if (of_pixels) pixels = length;
      at = tag.value + length;
    }
    if (pixels < 0) fail("holds a truncated slice", file_);
    return pixels;
  }

  /// Whether pixel_bytes() passed a tag; VTK's reader has undefined values for missing ones.
  bool has(std::uint32_t name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }

 private:
  std::string bytes(std::int64_t at, std::int64_t count) {
    std::string s(static_cast<std::size_t>(count), '\0');
    stream_.clear();
    stream_.seekg(at);
    if (!stream_.read(s.data(), count)) fail("holds a truncated slice", file_);
    return s;
  }

  std::int64_t begin() {
    for (const std::int64_t at : {0, 128})
      if (at + 4 <= size_ && bytes(at, 4) == "DICM") return at + 4;
    return 0;
  }

  /// The length has 4 bytes; after a two-letter type 2, or, for some types, 4 after a gap of 2.
  Tag tag_at(std::int64_t at) {
    const std::string head = bytes(at, 8), kind = head.substr(4, 2);
    Tag tag;
    tag.name = static_cast<std::uint32_t>(load<std::uint16_t>(head.data())) << 16 | load<std::uint16_t>(&head[2]);
    tag.value = at + 8;
    const auto is_of = [&](std::string_view kinds) {
      for (std::size_t k = 0; k < kinds.size(); k += 2)
        if (kinds.substr(k, 2) == kind) return true;
      return false;
    };
    if (is_of("OBOWUNSQ")) {
      tag.value += 4;
      tag.length = tag.value <= size_ ? load<std::int32_t>(bytes(at + 8, 4).data()) : 1;
    } else if (is_of("AWAEASCSUIDADSDTISLOLTPNSTTMUTSHFLSLATULUSSSFD")) {
      tag.length = load<std::uint16_t>(&head[6]);
    } else {
      tag.length = load<std::int32_t>(&head[4]);
    }
    return tag;
  }

  /// These may not be empty.
  void check(const Tag& tag) const {
    for (const std::uint32_t name :
         {0x00020010u, 0x00280004u, 0x00280010u, 0x00280011u, 0x00280100u, 0x00280103u, 0x00281052u, 0x00281053u})
      if (tag.name == name && tag.length <= 0) fail("holds a slice with a damaged header", file_);
  }

  const std::string& file_;
  std::ifstream stream_;
  std::int64_t size_;
  std::vector<std::uint32_t> names_;
};

/// Called before VTK's reader allocates and fills the pixels.
void check_pixels(vtkDICOMImageReader& reader, std::int64_t pixel_bytes, const std::string& file) {
  const int bits = reader.GetBitsAllocated();
  if (bits != 8 && bits != 16) fail("holds pixels of " + std::to_string(bits) + " bits, which are not read", file);
  const auto columns = static_cast<std::int64_t>(reader.GetWidth()),
             rows = static_cast<std::int64_t>(reader.GetHeight());
  if (columns < 1 || rows < 1) fail("holds a slice without pixels", file);
  if (columns * rows * reader.GetNumberOfComponents() * (bits / 8) > pixel_bytes) fail("holds a truncated slice", file);
}

Slice read_slice(const std::string& file) {
  TagReader tags(file);
  const std::int64_t pixel_bytes = tags.pixel_bytes();
  const auto reader = vtkSmartPointer<vtkDICOMImageReader>::New();
  reader->SetFileName(file.c_str());
  reader->UpdateInformation();
  check_pixels(*reader, pixel_bytes, file);
  reader->Update();
  Slice slice;
  slice.file = file;
  slice.image = reader->GetOutput();
  if (!slice.image || !slice.image->GetPointData()->GetScalars() || slice.image->GetDimensions()[2] != 1)
    fail("holds a slice that cannot be read", file);
  const auto numbers = [&]<class T>(const T* from, std::size_t count) {
    const std::vector<double> values(from, from + count);
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
      fail("holds a slice whose position, directions or steps are not finite", file);
    return values;
  };
  if (tags.has(0x00200032)) {
    const auto p = numbers(reader->GetImagePositionPatient(), 3);
    slice.position = {p[0], p[1], p[2]};
  }
  Vec3 row, column;
  if (tags.has(0x00200037)) {
    const auto o = numbers(reader->GetImageOrientationPatient(), 6);
    row = {o[0], o[1], o[2]}, column = {o[3], o[4], o[5]};
  }
  if (!(std::abs(norm(row) - 1) < 0.1 && std::abs(norm(column) - 1) < 0.1 && std::abs(dot(row, column)) < 0.1))
    row = {1, 0, 0}, column = {0, 1, 0};  // default orientation
  slice.along_row = normalized(row);
  slice.along_column = normalized(column - slice.along_row * dot(slice.along_row, column));
  // The file stores the step between rows first.
  if (tags.has(0x00280030)) {
    const auto steps = numbers(reader->GetPixelSpacing(), 2);
    slice.row_step = steps[0] > 0 ? steps[0] : 1;
    slice.column_step = steps[1] > 0 ? steps[1] : 1;
  }
  if (tags.has(0x00180050)) {
    const auto thickness = numbers(reader->GetPixelSpacing() + 2, 1);
    slice.thickness = thickness[0] > 0 ? thickness[0] : 1;
  }
  return slice;
}

std::vector<Slice> read_slices(const std::string& path) {
  const auto probe = vtkSmartPointer<vtkDICOMImageReader>::New();
  if (!std::filesystem::is_directory(path)) {
    if (probe->CanReadFile(path.c_str()) == 0) throw std::runtime_error("is not a readable DICOM file");
    return {read_slice(path)};
  }
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path))
    if (entry.is_regular_file() && probe->CanReadFile(entry.path().c_str()) != 0)
      files.push_back(entry.path().string());
  if (files.empty()) throw std::runtime_error("is a folder without DICOM slices");
  std::sort(files.begin(), files.end());
  std::vector<Slice> slices;
  for (const std::string& file : files) slices.push_back(read_slice(file));
  return slices;
}

/// Sorts slices along the normal.
void sort_slices(std::vector<Slice>& slices) {
  const Slice first = slices[0];
  const Vec3 normal = cross(first.along_row, first.along_column);
  for (Slice& s : slices) {
    if (s.columns() != first.columns() || s.rows() != first.rows() ||
        s.image->GetNumberOfScalarComponents() != first.image->GetNumberOfScalarComponents() ||
        norm(s.along_row - first.along_row) > 1e-3 || norm(s.along_column - first.along_column) > 1e-3 ||
        std::abs(s.column_step - first.column_step) > 1e-3 * first.column_step ||
        std::abs(s.row_step - first.row_step) > 1e-3 * first.row_step)
      throw std::runtime_error("holds slices of different sizes or directions: keep one series in a folder");
    s.at = dot(normal, s.position - first.position);
  }
  std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) { return a.at < b.at; });
}

/// Numbers of all slices, with rows from top to bottom.
AttributeValues values_of_slices(const std::vector<Slice>& slices) {
  vtkDataArray* const like = slices[0].image->GetPointData()->GetScalars();
  const int columns = slices[0].columns(), rows = slices[0].rows();
  const vtkIdType size = static_cast<vtkIdType>(columns) * rows;
  // Slices without scaling have integers, others reals.
  const bool same = std::all_of(slices.begin(), slices.end(), [&](const Slice& s) {
    return s.image->GetPointData()->GetScalars()->GetDataType() == like->GetDataType();
  });
  const auto all =
      vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(same ? like->GetDataType() : VTK_FLOAT));
  all->SetNumberOfComponents(like->GetNumberOfComponents());
  all->SetNumberOfTuples(size * static_cast<vtkIdType>(slices.size()));
  for (std::size_t k = 0; k < slices.size(); ++k) {
    vtkDataArray* const from = slices[k].image->GetPointData()->GetScalars();
    for (vtkIdType r = 0; r < rows; ++r)
      for (vtkIdType c = 0; c < columns; ++c)
        for (int component = 0; component < like->GetNumberOfComponents(); ++component)
          all->SetComponent(static_cast<vtkIdType>(k) * size + r * columns + c, component,
                            from->GetComponent((rows - 1 - r) * columns + c, component));
  }
  return values_of(*all, nullptr);
}

/// Distances along the normal; made equal if they are within the precision of headers.
std::vector<double> distances_of(const std::vector<Slice>& slices, GridData& data) {
  std::vector<double> at;
  for (const Slice& s : slices) at.push_back(s.at - slices[0].at);
  if (at.size() < 2) return at;
  const double mean = at.back() / static_cast<double>(at.size() - 1);
  double least = mean, most = mean;
  for (std::size_t k = 1; k < at.size(); ++k) {
    least = std::min(least, at[k] - at[k - 1]), most = std::max(most, at[k] - at[k - 1]);
    if (at[k] - at[k - 1] <= 1e-3 * mean)
      throw std::runtime_error(
          "holds several slices at one position (" + std::filesystem::path(slices[k - 1].file).filename().string() +
          " and " + std::filesystem::path(slices[k].file).filename().string() + "): keep one series in a folder");
  }
  if (most - least <= 0.01 * mean) {
    for (std::size_t k = 0; k < at.size(); ++k) at[k] = mean * static_cast<double>(k);
  } else {
    data.notes.push_back("the slices are not equally spaced");
  }
  return at;
}

/// For slices without positions: stacked in the order of their names.
void stack_slices(std::vector<Slice>& slices, GridData& data) {
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].position +=
        cross(slices[0].along_row, slices[0].along_column) * (slices[0].thickness * static_cast<double>(k));
  data.notes.push_back("the slices have no positions: they are stacked in the order of their names");
}

}  // namespace

void add_slices(const std::string& path, VtkSink& sink, GridData& data) {
  std::vector<Slice> slices = read_slices(path);
  const bool placed = std::any_of(slices.begin(), slices.end(),
                                  [&](const Slice& s) { return norm(s.position - slices[0].position) > 0; });
  if (!placed && slices.size() > 1) stack_slices(slices, data);
  sort_slices(slices);
  const Slice& first = slices[0];
  const Vec3 normal = cross(first.along_row, first.along_column);
  GridBlock block;
  const auto columns = static_cast<std::size_t>(first.columns()), rows = static_cast<std::size_t>(first.rows());
  block.dims = {columns, rows, slices.size()};
  const std::vector<double> at = distances_of(slices, data);
  // A tilted gantry shifts slices against each other.
  bool straight = true;
  for (const Slice& s : slices) {
    const Vec3 d = s.position - first.position;
    straight = straight &&
               norm(d - normal * dot(normal, d)) <= 0.01 * std::min(first.column_step, first.row_step) + 1e-6 * norm(d);
  }
  if (straight) {
    block.kind = GridKind::lattice;
    block.origin = first.position;
    block.directions = {first.along_row, first.along_column, normal};
    for (std::size_t i = 0; i < columns; ++i) block.axes[0].push_back(static_cast<double>(i) * first.column_step);
    for (std::size_t j = 0; j < rows; ++j) block.axes[1].push_back(static_cast<double>(j) * first.row_step);
    block.axes[2] = at;
  } else {
    block.kind = GridKind::curvilinear;
    for (const Slice& s : slices)
      for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < columns; ++i)
          block.points.push_back(s.position + first.along_row * (static_cast<double>(i) * first.column_step) +
                                 first.along_column * (static_cast<double>(j) * first.row_step));
  }
  const int components = first.image->GetNumberOfScalarComponents();
  sink.add(block, false, {"DICOMImage", values_of_slices(slices), static_cast<std::size_t>(components)});
  data.blocks.push_back(std::move(block));
}

}  // namespace sansmesh::inline v1::io
