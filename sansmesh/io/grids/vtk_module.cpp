#include "sansmesh/io/grids/vtk_module.h"

#include <dlfcn.h>
#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <vector>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/time_steps.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr const char* kModuleFile = "libsansmesh_vtk.so";

/// Folders that may contain the module, relative to the program and to the shared library, if there is one.
std::vector<std::filesystem::path> module_paths() {
  std::error_code failed;
  std::vector<std::filesystem::path> from, paths;
  if (const auto program = std::filesystem::read_symlink("/proc/self/exe", failed); !failed)
    from.push_back(program.parent_path());
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&load_vtk_module), &info) != 0 && info.dli_fname) {
    const auto library = std::filesystem::canonical(info.dli_fname, failed);
    if (!failed && (from.empty() || from[0] != library.parent_path())) from.push_back(library.parent_path());
  }
  for (const auto& folder : from) {
    constexpr const char* kInstalled = "../" SANSMESH_LIBDIR "/sansmesh";
    for (const char* inner : {".", kInstalled, "sansmesh", "../../sansmesh/io/vtk", "io/vtk"})
      paths.push_back((folder / inner / kModuleFile).lexically_normal());
  }
  return paths;
}

VtkReadFunction open_module(const std::string& file, std::string& why_not) {
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) {
    const char* const cause = ::dlerror();
    why_not = fmt::format("the module of VTK's readers cannot be loaded ({})", cause ? cause : file);
    return nullptr;
  }
  const auto interface = reinterpret_cast<VtkInterfaceFunction>(::dlsym(module, kVtkInterfaceFunction));
  const auto read = reinterpret_cast<VtkReadFunction>(::dlsym(module, kVtkReadFunction));
  if (interface && read && interface() == kVtkInterface) return read;
  ::dlclose(module);
  why_not = fmt::format("{} is of another version of sansmesh: build the target sansmesh_vtk again", file);
  return nullptr;
}

VtkReadFunction find_module(std::string& why_not) {
  if (const char* const named = std::getenv("SANSMESH_VTK_MODULE"); named && *named) return open_module(named, why_not);
  std::error_code ignored;
  for (const auto& path : module_paths()) {
    if (std::filesystem::exists(path, ignored)) return open_module(path.string(), why_not);
  }
  why_not =
      "needs VTK's readers, which are not installed: `scripts/install-deps volume`, then build with SANSMESH_BUILD_VTK "
      "(./run volume … does both)";
  return nullptr;
}

class ArraySink final : public VtkSink {
 public:
  void add(GridBlock& block, bool of_cells, Attribute array) override {
    check_cancelled();
    (of_cells ? block.cell_arrays : block.point_arrays).set(std::move(array));
  }
  bool stopped() const override {
    try {
      check_cancelled();
    } catch (const Cancelled&) {
      return true;
    }
    return false;
  }
};

}  // namespace

VtkReadFunction load_vtk_module(std::string& why_not) {
  static std::mutex mutex;
  static VtkReadFunction loaded = nullptr;
  const std::lock_guard lock(mutex);
  if (!loaded) loaded = find_module(why_not);
  return loaded;
}

GridData read_by_vtk(const VtkRequest& request) {
  std::string cause;
  const VtkReadFunction read = load_vtk_module(cause);
  if (!read) throw FileError(request.file, cause);
  GridData data;
  ArraySink sink;
  const bool whole = read(request, sink, data, cause);
  check_cancelled();
  if (!whole) throw FileError(request.file, cause);
  check_time_step(request.file, request.time_step, data.times.size());
  return data;
}

}  // namespace sansmesh::inline v1::io
