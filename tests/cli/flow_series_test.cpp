// Tests of unsteady flows in all file formats with time series: particles follow the formula that was sampled.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_tool.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::test {
namespace {

const std::vector<double> kTimes{0, 0.25, 0.5, 0.75, 1};

/// Linear in space and time, so that hexahedral grids and steps represent it exactly.
Vec3 spin(const Vec3& x, double t) { return Vec3{-x.y, x.x, 0} * (1 + t); }

std::string list(const std::vector<double>& numbers) { return fmt::format("{}", fmt::join(numbers, " ")); }

/// 5 × 5 × 3 points in [-1, 1]² × [0, 0.5].
struct Box {
  std::vector<Vec3> points;
  std::vector<std::array<int, 8>> cells;

  /// Moves all points except those at both ends by `shift` along x.
  explicit Box(double shift = 0) {
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 5; ++i)
          points.push_back({i / 2.0 - 1 + (i == 0 || i == 4 ? 0 : shift), j / 2.0 - 1, k / 4.0});
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
          const int a = i + 5 * (j + 5 * k), b = a + 25;
          cells.push_back({a, a + 1, a + 6, a + 5, b, b + 1, b + 6, b + 5});
        }
  }
  std::vector<double> vectors(double t) const {
    std::vector<double> all;
    for (const Vec3& x : points)
      for (std::size_t c = 0; c < 3; ++c) all.push_back(spin(x, t)[c]);
    return all;
  }
  /// One component of the points, or of vectors at them.
  static std::vector<double> component(const std::vector<double>& all, std::size_t c) {
    std::vector<double> one;
    for (std::size_t i = c; i < all.size(); i += 3) one.push_back(all[i]);
    return one;
  }
  std::vector<double> places() const {
    std::vector<double> all;
    for (const Vec3& x : points) all.insert(all.end(), {x.x, x.y, x.z});
    return all;
  }
};

std::string array_of(const std::string& name, std::size_t components, const std::vector<double>& values) {
  return fmt::format(
      "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>\n", name,
      components, list(values));
}

std::string image_step(const std::vector<double>& vectors, const std::string& name = "v",
                       const std::string& extent = "0 4 0 4 0 2",
                       const std::string& place = "Origin=\"-1 -1 0\" Spacing=\"0.5 0.5 0.25\"") {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<ImageData WholeExtent=\"{}\" {}>\n<Piece Extent=\"{}\"><PointData>{}</PointData></Piece>\n</ImageData>\n"
      "</VTKFile>\n",
      extent, place, extent, array_of(name, 3, vectors));
}

std::string grid_step(const Box& box, double t) {
  std::string corners, offsets, types;
  for (std::size_t c = 0; c < box.cells.size(); ++c) {
    for (const int k : box.cells[c]) corners += fmt::format("{} ", k);
    offsets += fmt::format("{} ", 8 * (c + 1)), types += "12 ";
  }
  const auto whole = [](const char* name, const std::string& values) {
    return fmt::format("<DataArray type=\"Int64\" Name=\"{}\" format=\"ascii\">{}</DataArray>\n", name, values);
  };
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"2.2\" byte_order=\"LittleEndian\">\n"
      "<UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData>{}{}</PointData>\n"
      "<Points>{}</Points>\n<Cells>{}{}{}</Cells>\n</Piece></UnstructuredGrid>\n</VTKFile>\n",
      box.points.size(), box.cells.size(), array_of("p", 1, std::vector<double>(box.points.size(), t)),
      array_of("v", 3, box.vectors(t)), array_of("Points", 3, box.places()), whole("connectivity", corners),
      whole("offsets", offsets), whole("types", types));
}

/// Big-endian numbers, as in NetCDF and other formats.
template <class T>
std::string big(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// NetCDF, as needed for Exodus files of one block.
class NetCdf {
 public:
  std::vector<std::pair<std::string, int>> dimensions;  ///< 0: the record dimension
  std::string attributes;
  int attribute_count = 0;
  struct Variable {
    std::string name;
    std::vector<int> dimensions;
    int type = 6;
    std::string attributes;         ///< a single one
    std::vector<std::string> data;  ///< all of it, or one entry per record
  };
  std::vector<Variable> variables;

  static std::string text(const std::string& s) { return big(static_cast<std::int32_t>(s.size())) + padded(s); }
  static std::string padded(std::string s) {
    s.resize((s.size() + 3) / 4 * 4);
    return s;
  }
  static std::string attribute(const std::string& name, int type, int count, const std::string& value) {
    return text(name) + big(type) + big(count) + padded(value);
  }

  std::string bytes(int records) const {
    std::string result;
    // The length of the header is needed for its own offsets.
    for (std::size_t start = 0; result.empty() || start != header(records, start).size();) {
      start = header(records, start).size();
      result = header(records, start);
    }
    for (const Variable& v : variables)
      if (!of_records(v)) result += padded(v.data[0]);
    for (int r = 0; r < records; ++r)
      for (const Variable& v : variables)
        if (of_records(v)) result += padded(v.data[static_cast<std::size_t>(r)]);
    return result;
  }

 private:
  bool of_records(const Variable& v) const {
    return !v.dimensions.empty() && dimensions[static_cast<std::size_t>(v.dimensions[0])].second == 0;
  }
  std::string header(int records, std::size_t start) const {
    std::string h = "CDF\x01" + big(records) + big(10) + big(static_cast<int>(dimensions.size()));
    for (const auto& [name, size] : dimensions) h += text(name) + big(size);
    h += big(12) + big(attribute_count) + attributes + big(11) + big(static_cast<int>(variables.size()));
    std::size_t fixed = start, record = start;
    for (const Variable& v : variables)
      if (!of_records(v)) record += padded(v.data[0]).size();
    for (const Variable& v : variables) {
      h += text(v.name) + big(static_cast<int>(v.dimensions.size()));
      for (const int d : v.dimensions) h += big(d);
      h += v.attributes.empty() ? big(0) + big(0) : big(12) + big(1) + v.attributes;
      std::size_t& at = of_records(v) ? record : fixed;
      const std::size_t size = padded(v.data[0]).size();
      h += big(v.type) + big(static_cast<int>(size)) + big(static_cast<int>(at));
      at += size;
    }
    return h;
  }
};

std::string exodus(const Box& box) {
  NetCdf file;
  const int points = static_cast<int>(box.points.size()), cells = static_cast<int>(box.cells.size());
  file.dimensions = {{"len_name", 33},          {"time_step", 0},       {"num_dim", 3},
                     {"num_nodes", points},     {"num_elem", cells},    {"num_el_blk", 1},
                     {"num_el_in_blk1", cells}, {"num_nod_per_el1", 8}, {"num_nod_var", 3}};
  file.attribute_count = 5;
  file.attributes = NetCdf::attribute("api_version", 5, 1, big(8.11f)) +
                    NetCdf::attribute("version", 5, 1, big(8.11f)) +
                    NetCdf::attribute("floating_point_word_size", 4, 1, big(8)) +
                    NetCdf::attribute("file_size", 4, 1, big(1)) + NetCdf::attribute("title", 2, 4, "spin");
  const auto doubles = [](const std::vector<double>& values) {
    std::string s;
    for (const double v : values) s += big(v);
    return s;
  };
  std::vector<std::string> moments;
  for (const double t : kTimes) moments.push_back(big(t));
  file.variables.push_back({"time_whole", {1}, 6, "", moments});
  file.variables.push_back({"eb_status", {5}, 4, "", {big(1)}});
  file.variables.push_back({"eb_prop1", {5}, 4, NetCdf::attribute("name", 2, 2, "ID"), {big(1)}});
  for (std::size_t c = 0; c < 3; ++c)
    file.variables.push_back(
        {std::string("coord") + "xyz" [c], { 3 }, 6, "", {doubles(Box::component(box.places(), c))}});
  std::string corners;
  for (const auto& cell : box.cells)
    for (const int k : cell) corners += big(k + 1);
  file.variables.push_back({"connect1", {6, 7}, 4, NetCdf::attribute("elem_type", 2, 3, "HEX"), {corners}});
  std::string names;
  for (const char* name : {"vx", "vy", "vz"}) names += name + std::string(31, '\0');
  file.variables.push_back({"name_nod_var", {8, 0}, 2, "", {names}});
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<std::string> steps;
    for (const double t : kTimes) steps.push_back(doubles(Box::component(box.vectors(t), c)));
    file.variables.push_back({fmt::format("vals_nod_var{}", c + 1), {1, 3}, 6, "", steps});
  }
  return file.bytes(static_cast<int>(kTimes.size()));
}

/// 2 × 2 elements of 4 × 4 points in the plane.
std::string nek_step(double t) {
  std::string bytes = fmt::format("#std 4  4  4  1          4          4 {:20.13e}         0      0      1 XU", t);
  bytes.resize(132, ' ');
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  add(6.54321f);
  for (std::int32_t e = 1; e <= 4; ++e) add(e);
  const double nodes[] = {0, 0.5 - 0.5 / std::sqrt(5.0), 0.5 + 0.5 / std::sqrt(5.0), 1};
  for (const bool velocity : {false, true})
    for (int e = 0; e < 4; ++e)
      for (std::size_t c = 0; c < 2; ++c)
        for (int j = 0; j < 4; ++j)
          for (int i = 0; i < 4; ++i) {
            const Vec3 x{(e % 2 == 0 ? -1 : 0) + nodes[i], (e < 2 ? -1 : 0) + nodes[j], 0};
            add(static_cast<float>(velocity ? spin(x, t)[c] : x[c]));
          }
  return bytes;
}

class FlowSeriesTool : public ToolTest {
 protected:
  /// Positions of a particle from the rows of a table of lines.
  std::vector<std::vector<double>> follow(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"flow", "lines"});
    arguments.insert(arguments.end(), {"-o", path("l.csv")});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? number_rows(path("l.csv")) : std::vector<std::vector<double>>();
  }
  void expect_spin(std::vector<std::string> data, double z = 0.25) {
    data.insert(data.end(), {"--unsteady", "--seeds", fmt::format("line(0.25,0,{}, 0.75,0,{}, 3)", z, z)});
    const auto rows = follow(data);
    ASSERT_GT(rows.size(), 15u);
    for (const auto& row : rows) {
      const double radius = 0.25 * (1 + row[0]), t = row[1], angle = t + 0.5 * t * t;
      EXPECT_NEAR(row[2], radius * std::cos(angle), 1e-3) << t;
      EXPECT_NEAR(row[3], radius * std::sin(angle), 1e-3) << t;
      EXPECT_NEAR(row[4], z, 1e-12);
      EXPECT_NEAR(row[5], radius * (1 + t), 2e-3);
    }
    EXPECT_NEAR(rows.back()[1], 1, 1e-12);
  }
  /// Writes one file per step and returns the names.
  std::vector<std::string> steps(const std::string& ending, const std::function<std::string(double)>& content) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < kTimes.size(); ++i) {
      names.push_back(fmt::format("step_{}.{}", i, ending));
      write(names.back(), content(kTimes[i]));
    }
    return names;
  }
  std::string collection(const std::vector<std::string>& names) {
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    for (std::size_t i = 0; i < names.size(); ++i)
      text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", kTimes[i], names[i]);
    return text + "</Collection>\n</VTKFile>\n";
  }
};

TEST_F(FlowSeriesTool, NumberedFilesOfEachKind) {
  const Box box;
  const auto raw_step = [&](double t) {
    std::string bytes;
    for (const double v : box.vectors(t)) {
      const auto f = static_cast<float>(v);
      bytes.append(reinterpret_cast<const char*>(&f), sizeof f);
    }
    return "ObjectType = Image\nNDims = 3\nDimSize = 5 5 3\nElementSpacing = 0.5 0.5 0.25\nOffset = -1 -1 0\n"
           "ElementType = MET_FLOAT\nElementNumberOfChannels = 3\nElementByteOrderMSB = False\nElementDataFile = "
           "LOCAL\n" +
           bytes;
  };
  std::vector<std::string> files = steps("mha", raw_step);
  for (const std::string times : {"0,0.25", "0,0.25,0.5,0.75,1"}) {
    std::vector<std::string> data = files;
    data.insert(data.end(), {"--times", times});
    expect_spin(data);
  }
  // A small memory limit makes no difference.
  files.insert(files.end(), {"--times", "0,0.25", "--memory", "0"});
  expect_spin(files);
  // Backward from the last moment.
  files.insert(files.end(), {"--unsteady", "--direction", "backward", "--seeds", "point(0.5,0,0.25)"});
  const auto rows = follow(files);
  ASSERT_FALSE(rows.empty());
  EXPECT_NEAR(std::atan2(rows.front()[3], rows.front()[2]), -1.5, 1e-3);
}

TEST_F(FlowSeriesTool, NekFilesAreASlab) {
  for (std::size_t i = 0; i < kTimes.size(); ++i) write(fmt::format("eddy0.f{:05}", i + 1), nek_step(kTimes[i]));
  write("eddy.nek5000", "filetemplate: eddy%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 5\n");
  expect_spin({"eddy.nek5000"}, 0);
  // A damaged step has no time.
  write("eddy0.f00003", "#std");
  const Outcome outcome = run({"flow", "lines", "eddy.nek5000", "--unsteady", "-o", "x.csv"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_NE(outcome.err.find("eddy.nek5000: the time of step 2 is not known"), std::string::npos) << outcome.err;
}

TEST_F(FlowSeriesTool, FilesOfVtkAndOthers) {
  if (!has_vtk_readers()) GTEST_SKIP() << "without the module";
  const Box box;
  const auto image = [&](double t) { return image_step(box.vectors(t)); };
  const auto images = steps("vti", image);
  write("all.pvd", collection(images));
  expect_spin({"all.pvd"});
  nlohmann::json series = {{"file-series-version", "1.0"}, {"files", nlohmann::json::array()}};
  for (std::size_t i = 0; i < images.size(); ++i) series["files"].push_back({{"name", images[i]}, {"time", kTimes[i]}});
  write("all.vti.series", series.dump());
  expect_spin({"all.vti.series"});
  const auto grids = steps("vtu", [&](double t) { return grid_step(box, t); });
  write("grids.pvd", collection(grids));
  expect_spin({"grids.pvd"});
  // Points that oscillate between the steps: each step has its own vectors.
  steps("vtu", [&](double t) { return grid_step(Box(0.3 * std::sin(8 * t)), t); });
  expect_spin({"grids.pvd"});
  write("spin.ex2", exodus(box));
  expect_spin({"spin.ex2"});
  // EnSight, with vectors in three blocks of numbers.
  const auto lines = [](const std::vector<double>& values) {
    std::string s;
    for (const double v : values) s += fmt::format("{:12.5e}\n", v);
    return s;
  };
  std::string geo = fmt::format("a test\nin text\nnode id off\nelement id off\npart\n{:10}\nbody\ncoordinates\n{:10}\n",
                                1, box.points.size());
  for (std::size_t c = 0; c < 3; ++c) geo += lines(Box::component(box.places(), c));
  geo += fmt::format("hexa8\n{:10}\n", box.cells.size());
  for (const auto& cell : box.cells) {
    for (const int k : cell) geo += fmt::format("{:10}", k + 1);
    geo += "\n";
  }
  write("spin.geo", geo);
  for (std::size_t i = 0; i < kTimes.size(); ++i) {
    std::string vectors = fmt::format("vectors\npart\n{:10}\ncoordinates\n", 1);
    for (std::size_t c = 0; c < 3; ++c) vectors += lines(Box::component(box.vectors(kTimes[i]), c));
    write(fmt::format("spin.v{}", i), vectors);
  }
  write(
      "spin.case",
      "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: spin.geo\nVARIABLE\nvector per node: 1 v spin.v*\nTIME\n"
      "time set: 1\nnumber of steps: 5\nfilename start number: 0\nfilename increment: 1\ntime values: 0 0.25 0.5 0.75 "
      "1\n");
  expect_spin({"spin.case"});
}

/// A flow that no grid represents exactly, sampled in the plane.
TEST_F(FlowSeriesTool, ASampledFlowIsFollowedAsItsFormulaIs) {
  if (!has_vtk_readers()) GTEST_SKIP() << "without the module";
  const double pi = std::acos(-1.0);
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (int k = 0; k <= 20; ++k) {
    const double t = 0.5 * k, a = 0.25 * std::sin(0.2 * pi * t), b = 1 - 2 * a;
    std::vector<double> v;
    for (int j = 0; j <= 32; ++j)
      for (int i = 0; i <= 64; ++i) {
        const double x = i / 32.0, y = j / 32.0, f = a * x * x + b * x;
        v.insert(v.end(), {-0.1 * pi * std::sin(pi * f) * std::cos(pi * y),
                           0.1 * pi * std::cos(pi * f) * std::sin(pi * y) * (2 * a * x + b), 0});
      }
    write(fmt::format("gyre_{}.vti", k),
          image_step(v, "v", "0 64 0 32 0 0", "Origin=\"0 0 0\" Spacing=\"0.03125 0.03125 1\""));
    text += fmt::format("<DataSet timestep=\"{}\" file=\"gyre_{}.vti\"/>\n", t, k);
  }
  write("gyre.pvd", text + "</Collection>\n</VTKFile>\n");
  const std::vector<std::string> rest{"--seeds", "line(0.2,0.3,0, 0.6,0.6,0, 5)", "--duration", "10", "--tolerance",
                                      "1e-7"};
  const auto ends = [&](std::vector<std::string> data) {
    data.insert(data.end(), rest.begin(), rest.end());
    std::vector<Vec3> last(5);
    for (const auto& row : follow(data)) {
      last[static_cast<std::size_t>(row[0])] = {row[2], row[3], row[4]};
      EXPECT_EQ(row[4], 0);
    }
    return last;
  };
  const auto exact = ends({"double-gyre"}), cubic = ends({"gyre.pvd", "--unsteady", "--time-interpolation", "cubic"}),
             linear = ends({"gyre.pvd", "--unsteady", "--method", "linear"});
  double cubic_error = 0, linear_error = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    cubic_error = std::max(cubic_error, norm(cubic[i] - exact[i]));
    linear_error = std::max(linear_error, norm(linear[i] - exact[i]));
  }
  // Steps are a twentieth of the period apart, and the flow separates neighbours.
  EXPECT_LT(cubic_error, 5e-3);
  EXPECT_LT(linear_error, 6e-2);
  EXPECT_LT(5 * cubic_error, linear_error);
}

TEST_F(FlowSeriesTool, MissingValuesOfLaterStepsAreSaid) {
  const Box box;
  std::vector<std::string> arguments = steps("mha", [&](double t) {
    std::vector<double> vectors = box.vectors(t);
    if (t > 0.3 && t < 0.8) vectors[0] = 9.9692099683868690e36;  // NetCDF's fill value
    return "ObjectType = Image\nNDims = 3\nDimSize = 5 5 3\nElementSpacing = 0.5 0.5 0.25\nOffset = -1 -1 0\n"
           "BinaryData = False\nElementType = MET_DOUBLE\nElementNumberOfChannels = 3\nElementDataFile = LOCAL\n" +
           list(vectors);
  });
  arguments.insert(arguments.begin(), {"flow", "lines"});
  arguments.insert(arguments.end(),
                   {"--unsteady", "--times", "0,0.25", "--seeds", "point(0.5,0.2,0.25)", "-o", "l.csv"});
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("step_2.mha: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("9.96921e+36"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("; 1 more step has similar notes"), std::string::npos) << outcome.err;
}

TEST_F(FlowSeriesTool, SaysWhichStepIsWrongInOneLine) {
  const Box box;
  const auto image = [&](double t, std::size_t channels = 3) {
    std::string bytes;
    const std::vector<double> vectors = box.vectors(t);
    for (std::size_t i = 0; i < 75 * channels; ++i) {
      const auto f = static_cast<float>(vectors[i]);
      bytes.append(reinterpret_cast<const char*>(&f), sizeof f);
    }
    return fmt::format(
               "ObjectType = Image\nNDims = 3\nDimSize = 5 5 3\nElementSpacing = 0.5 0.5 0.25\nOffset = -1 -1 0\n"
               "ElementType = MET_FLOAT\nElementNumberOfChannels = {}\nElementByteOrderMSB = False\nElementDataFile = "
               "LOCAL\n",
               channels) +
           bytes;
  };
  write("a.mha", image(0)), write("b.mha", image(1)), write("c.mha", image(2));
  write("cut.mha", image(2).substr(0, 500));
  write("two.mha", image(2, 2));
  write("points.csv", "x,y,z,p\n0,0,0,1\n1,0,0,2\n0,1,0,3\n0,0,1,4\n1,1,1,5\n");
  const auto command = [](std::vector<std::string> files, const std::vector<std::string>& more = {}) {
    files.insert(files.begin(), {"flow", "lines"});
    files.insert(files.end(), {"--unsteady", "--seeds", "point(0.5,0,0.25)", "--method", "linear", "-o", "x.csv"});
    files.insert(files.end(), more.begin(), more.end());
    return files;
  };
  run({"info", "a.mha"});  // creates its files of captured output
  expect_failures({
      {command({"a.mha"}), 1, {"a.mha", "one step in time"}},
      {command({"a.mha", "b.mha", "cut.mha"}), 1, {"cut.mha"}},
      {command({"a.mha", "b.mha", "no.mha"}), 1, {"no.mha"}},
      {command({"a.mha", "points.csv"}), 1, {"points.csv", "no array"}},
      {command({"a.mha", "b.mha", "two.mha"}), 1, {"two.mha", "vectors of 2 components, the first step of 3"}},
      {command({"a.mha", "b.mha", "c.mha"}, {"--times", "0,2,1"}), 1, {"a.mha and 2 other files", "step 2 is of 1"}},
      {command({"a.mha", "b.mha", "c.mha"}, {"--times", "0,0"}), 1, {"must increase"}},
      {command({"a.mha", "b.mha", "c.mha"}, {"--times", "0,1,2,3"}), 2, {"--times has 4 numbers for 3 files"}},
      {command({"a.mha", "b.mha"}, {"--memory", "-1"}), 2, {"--memory"}},
      {command({"a.mha"}, {"--time-step", "1"}), 2, {"--time-step"}},
      {{"flow", "lines", "a.mha", "--times", "0,1", "-o", "x.csv"}, 2, {"--times needs --unsteady"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
