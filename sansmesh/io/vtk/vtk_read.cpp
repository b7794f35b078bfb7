// Entry point of the module: chooses VTK's reader, monitors its errors, and returns its result.
#include <vtkAlgorithm.h>
#include <vtkCGNSReader.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkDataObject.h>
#include <vtkExodusIIReader.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkGenericEnSightReader.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenFOAMReader.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLMultiBlockDataReader.h>
#include <vtkXMLPImageDataReader.h>
#include <vtkXMLPRectilinearGridReader.h>
#include <vtkXMLPStructuredGridReader.h>
#include <vtkXMLPUnstructuredGridReader.h>
#include <vtkXMLPartitionedDataSetCollectionReader.h>
#include <vtkXMLPartitionedDataSetReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUniformGridAMRReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <streambuf>
#include <thread>

#include "sansmesh/io/grids/vtk_module.h"
#include "sansmesh/io/vtk/dicom_slices.h"
#include "sansmesh/io/vtk/vtk_blocks.h"

// Function of the library below VTK's reader of Exodus, whose header needs more packages: which errors it prints (0:
// none).
extern "C" int vtkexodusII_ex_opts(int options) __attribute__((weak));

// VTK's reader of CGNS calls this function of the underlying library for damaged files, which would end the process.
// The loader finds this definition in the module before that in its dependencies.
extern "C" __attribute__((visibility("default"))) [[noreturn]] void vtkcgns_cgio_error_exit(const char*) {
  throw std::runtime_error("is not a readable CGNS file: truncated or damaged");
}

namespace sansmesh::inline v1::io {
namespace {

/// Captures VTK's messages.
class CaptureWindow : public vtkOutputWindow {
 public:
  static CaptureWindow* New();
  vtkTypeMacro(CaptureWindow, vtkOutputWindow);

  void DisplayText(const char*) override {}
  void DisplayErrorText(const char* text) override {
    if (error.empty()) error = message_of(text);
  }
  void DisplayWarningText(const char* text) override { warn(text); }
  void DisplayGenericWarningText(const char* text) override { warn(text); }
  void DisplayDebugText(const char*) override {}

  std::string error;
  std::vector<std::string> warnings;

 protected:
  CaptureWindow() = default;

 private:
  /// Some readers report truncated data only as a warning.
  void warn(const char* text) {
    const std::string message = message_of(text);
    if (message.find("Error") == std::string::npos && message.find("error") == std::string::npos)
      warnings.push_back(message);
    else if (error.empty())
      error = message;
  }
  /// Extracts the message after "ERROR: In file.cxx, line 12" and a line break: "vtkReader (0x12): cause" → "cause".
  static std::string message_of(const char* text) {
    std::string s = text ? text : "";
    const std::size_t location = s.find(": In "), end = s.find('\n');
    if (location < end && end != std::string::npos) s = s.substr(end + 1);
    if (const std::size_t at = s.find("): "); s.starts_with("vtk") && at != std::string::npos) s = s.substr(at + 3);
    std::string line;
    for (const char c : s) {
      if (c != '\n' && c != '\r')
        line += c;
      else if (!line.empty() && line.back() != ' ')
        line += ' ';
    }
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line;
  }
};
vtkStandardNewMacro(CaptureWindow);

/// Replaces the process's output window within a scope.
class Captured {
 public:
  Captured() : before_(vtkOutputWindow::GetInstance()), verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
    vtkOutputWindow::SetInstance(window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~Captured() {
    vtkOutputWindow::SetInstance(before_);
    vtkLogger::SetStderrVerbosity(verbosity_);
  }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;

  vtkSmartPointer<CaptureWindow> window = vtkSmartPointer<CaptureWindow>::New();

 private:
  vtkSmartPointer<vtkOutputWindow> before_;
  vtkLogger::Verbosity verbosity_;
};

/// Drops output of this thread, and forwards that of others.
class OwnThreadDropped : public std::streambuf {
 public:
  explicit OwnThreadDropped(std::streambuf* others) : others_(others) {}

 protected:
  int_type overflow(int_type c) override {
    return own() || !others_ || traits_type::eq_int_type(c, traits_type::eof())
               ? traits_type::not_eof(c)
               : others_->sputc(traits_type::to_char_type(c));
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    return own() || !others_ ? count : others_->sputn(text, count);
  }
  int sync() override { return own() || !others_ ? 0 : others_->pubsync(); }

 private:
  bool own() const { return std::this_thread::get_id() == owner_; }

  std::thread::id owner_ = std::this_thread::get_id();
  std::streambuf* others_;
};

/// Drops output of the reader of CGNS to std::cerr within a scope.
class SilentErrors {
 public:
  SilentErrors() : before_(std::cerr.rdbuf()), dropped_(before_) { std::cerr.rdbuf(&dropped_); }
  ~SilentErrors() { std::cerr.rdbuf(before_); }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;

 private:
  std::streambuf* before_;
  OwnThreadDropped dropped_;
};

template <class Reader>
vtkSmartPointer<vtkAlgorithm> reader_of(const std::string& file) {
  const auto reader = vtkSmartPointer<Reader>::New();
  reader->SetFileName(file.c_str());
  return reader;
}

vtkSmartPointer<vtkAlgorithm> xml_reader(const VtkRequest& request) {
  const std::string& file = request.file;
  std::string type = request.xml_type;
  if (type.starts_with("vtk")) type = type.substr(3);
  if (type == "ImageData") return reader_of<vtkXMLImageDataReader>(file);
  if (type == "RectilinearGrid") return reader_of<vtkXMLRectilinearGridReader>(file);
  if (type == "StructuredGrid") return reader_of<vtkXMLStructuredGridReader>(file);
  if (type == "UnstructuredGrid") return reader_of<vtkXMLUnstructuredGridReader>(file);
  if (type == "PImageData") return reader_of<vtkXMLPImageDataReader>(file);
  if (type == "PRectilinearGrid") return reader_of<vtkXMLPRectilinearGridReader>(file);
  if (type == "PStructuredGrid") return reader_of<vtkXMLPStructuredGridReader>(file);
  if (type == "PUnstructuredGrid") return reader_of<vtkXMLPUnstructuredGridReader>(file);
  if (type == "MultiBlockDataSet") return reader_of<vtkXMLMultiBlockDataReader>(file);
  if (type == "PartitionedDataSet") return reader_of<vtkXMLPartitionedDataSetReader>(file);
  if (type == "PartitionedDataSetCollection") return reader_of<vtkXMLPartitionedDataSetCollectionReader>(file);
  if (type == "HierarchicalBoxDataSet" || type == "OverlappingAMR" || type == "NonOverlappingAMR") {
    const auto reader = vtkSmartPointer<vtkXMLUniformGridAMRReader>::New();
    reader->SetFileName(file.c_str());
    reader->SetMaximumLevelsToReadByDefault(0);  // all
    return reader;
  }
  throw std::runtime_error("holds VTK's data of the kind '" + type.substr(0, 40) + "', which is not a volume");
}

vtkSmartPointer<vtkAlgorithm> make_reader(const VtkRequest& request) {
  switch (request.format) {
    case VtkFormat::xml:
      return xml_reader(request);
    case VtkFormat::legacy: {
      const auto reader = vtkSmartPointer<vtkGenericDataObjectReader>::New();
      reader->SetFileName(request.file.c_str());
      reader->ReadAllScalarsOn();
      reader->ReadAllVectorsOn();
      reader->ReadAllNormalsOn();
      reader->ReadAllTensorsOn();
      reader->ReadAllColorScalarsOn();
      reader->ReadAllTCoordsOn();
      reader->ReadAllFieldsOn();
      return reader;
    }
    case VtkFormat::exodus: {
      if (vtkexodusII_ex_opts) vtkexodusII_ex_opts(0);
      const auto reader = vtkSmartPointer<vtkExodusIIReader>::New();
      if (!reader->CanReadFile(request.file.c_str()))
        throw std::runtime_error("is not a readable Exodus file: truncated or damaged");
      reader->SetFileName(request.file.c_str());
      reader->GenerateObjectIdCellArrayOff();
      reader->UpdateInformation();
      for (const int kind : {vtkExodusIIReader::NODAL, vtkExodusIIReader::ELEM_BLOCK})
        reader->SetAllArrayStatus(kind, 1);
      return reader;
    }
    case VtkFormat::ensight: {
      const auto reader = vtkSmartPointer<vtkGenericEnSightReader>::New();
      reader->SetCaseFileName(request.file.c_str());
      reader->ReadAllVariablesOn();
      return reader;
    }
    case VtkFormat::cgns: {
      const auto reader = vtkSmartPointer<vtkCGNSReader>::New();
      if (!reader->CanReadFile(request.file.c_str()))
        throw std::runtime_error("is not a readable CGNS file: truncated or damaged");
      reader->SetFileName(request.file.c_str());
      reader->UpdateInformation();
      reader->EnableAllBases();
      reader->EnableAllFamilies();
      reader->EnableAllPointArrays();
      reader->EnableAllCellArrays();
      return reader;
    }
    case VtkFormat::openfoam: {
      const auto reader = vtkSmartPointer<vtkOpenFOAMReader>::New();
      reader->SetFileName(request.file.c_str());
      reader->UpdateInformation();
      reader->EnableAllCellArrays();
      reader->EnableAllPointArrays();
      reader->DecomposePolyhedraOff();
      return reader;
    }
    case VtkFormat::dicom:
      break;  // add_slices
  }
  throw std::runtime_error("is of a format unknown to the module");
}

const char* format_name(VtkFormat format) {
  constexpr const char* names[] = {"VTK XML", "VTK legacy", "Exodus", "EnSight", "CGNS", "OpenFOAM", "DICOM"};
  return names[static_cast<std::size_t>(format)];
}

/// Kind of a data set as text: "vtkUnstructuredGrid" → "unstructured grid".
std::string kind_of(vtkDataObject& object) {
  std::string words;
  for (const char* p = object.GetClassName() + 3; *p; ++p) {
    const bool upper = *p >= 'A' && *p <= 'Z', inside = upper && p[1] >= 'A' && p[1] <= 'Z';
    if (upper && !words.empty() && !inside && words.back() != ' ') words += ' ';
    words += upper && !inside && p[1] >= 'a' ? static_cast<char>(*p - 'A' + 'a') : *p;
  }
  return words;
}

void read_series(const VtkRequest& request, const Captured& captured, VtkSink& sink, GridData& data) {
  const auto check = [&] {
    if (!captured.window->error.empty()) throw std::runtime_error(captured.window->error);
  };
  if (request.format == VtkFormat::dicom) {
    if (request.time_step > 0) return;
    data.format = "DICOM image data";
    add_slices(request.file, sink, data);
    return check();
  }
  const vtkSmartPointer<vtkAlgorithm> reader = make_reader(request);
  check();
  const vtkNew<vtkCallbackCommand> progress;
  progress->SetClientData(&sink);
  progress->SetCallback([](vtkObject* caller, unsigned long, void* of, void*) {
    if (static_cast<VtkSink*>(of)->stopped()) static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
  });
  reader->AddObserver(vtkCommand::ProgressEvent, progress);
  reader->UpdateInformation();
  check();
  vtkInformation* const info = reader->GetOutputInformation(0);
  if (info && info->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS())) {
    const double* const times = info->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
    data.times.assign(times, times + info->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()));
  }
  if (data.times == std::vector<double>{0}) data.times.clear();  // default of files without times
  if (request.time_step >= std::max<std::size_t>(1, data.times.size())) return;
  if (data.times.empty()) {
    reader->Update();
  } else {
    data.time = data.times[request.time_step];
    reader->UpdateTimeStep(*data.time);
  }
  check();
  vtkDataObject* const output = reader->GetOutputDataObject(0);
  if (!output) throw std::runtime_error("cannot be read: truncated or damaged");
  data.format = std::string(format_name(request.format)) + " " + kind_of(*output);
  add_blocks(*output, {}, sink, data);
  check();
}

void read_checked(const VtkRequest& request, VtkSink& sink, GridData& data) {
  const Captured captured;
  std::optional<SilentErrors> silent;
  if (request.format == VtkFormat::cgns) silent.emplace();
  read_series(request, captured, sink, data);
  for (const std::string& warning : captured.window->warnings) data.notes.push_back("VTK warns: " + warning);
  tidy_blocks(data);
}

}  // namespace
}  // namespace sansmesh::inline v1::io

// Only these two functions are called from outside.
extern "C" __attribute__((visibility("default"))) std::size_t sansmesh_vtk_interface() {
  return sansmesh::io::kVtkInterface;
}

extern "C" __attribute__((visibility("default"))) bool sansmesh_vtk_read(const sansmesh::io::VtkRequest& request,
                                                                         sansmesh::io::VtkSink& sink,
                                                                         sansmesh::GridData& data, std::string& error) {
  // VTK has one output window per process.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  try {
    sansmesh::io::read_checked(request, sink, data);
    return true;
  } catch (const std::exception& e) {
    error = e.what();
  } catch (...) {
    error = "VTK's reader failed";
  }
  return false;
}
