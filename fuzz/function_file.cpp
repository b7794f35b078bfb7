// Fuzz target: reading any bytes as a function file yields a usable function with finite values, or a FileError. The
// bytes are read unchanged and with corrected checksums, so that the checks behind the checksums are fuzzed too.
#include <algorithm>
#include <cmath>
#include <random>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/section_file.h"
#include "support/section_bytes.h"
#include "target.h"

using namespace sansmesh;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

void use(const FittedFunction& function) {
  const Box3 box = function.field.bounds();
  const Vec3 size = box.upper - box.lower;
  std::vector<Vec3> places{box.lower, box.upper, box.center(), box.center() + size * 1e3, box.center() + size * 1e18};
  const std::vector<Vec3> seeds = function.field.seeds();
  for (std::size_t i = 0; i < std::min<std::size_t>(seeds.size(), 40); ++i) places.push_back(seeds[i]);
  for (std::size_t i = 0; i < std::min<std::size_t>(function.field.functions().size(), 40); ++i)
    places.push_back(function.field.data().origin + Vec3(function.field.functions()[i].center));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 40; ++i)
    places.push_back(box.lower + Vec3{uniform(random) * size.x, uniform(random) * size.y, uniform(random) * size.z});
  std::vector<double> values(places.size());
  std::vector<Vec3> gradients(places.size());
  function.field.evaluate(places, values, gradients);
  for (std::size_t i = 0; i < places.size(); ++i)
    fuzz::demand(std::isfinite(values[i]) && is_finite(gradients[i]), "a value or gradient is not finite");

  BlockTree blocks = function.field.mesh_blocks(0.05 * size.x);
  blocks.balance();
  fuzz::demand(blocks.leaves().size() * 8 >= blocks.size(), "the blocks are no tree");
  const PointSet& samples = *function.samples;
  fuzz::demand(samples.normals.size() == samples.size(), "samples without normals");
  fuzz::demand(samples.colors.empty() || samples.colors.size() == samples.size(), "colours of other samples");
}

void read(const std::string& bytes) {
  // Aligned like a mapped file, and of exact length, so that the address sanitizer detects reads beyond the end.
  const std::shared_ptr<void> owner(::operator new (std::max<std::size_t>(1, bytes.size()), std::align_val_t{64}),
                                    [](void* p) { ::operator delete (p, std::align_val_t{64}); });
  std::memcpy(owner.get(), bytes.data(), bytes.size());
  try {
    use(read_fitted_function(SectionFile("fuzz.smf", owner, {static_cast<const char*>(owner.get()), bytes.size()})));
  } catch (const FileError& error) {
    fuzz::demand(std::string_view(error.what()).starts_with("fuzz.smf: "), "an error that does not name the file");
    fuzz::check_message(error.what());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ThreadScope one(1);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  read(bytes);
  std::string mended = bytes;
  test::mend_checksums(mended);
  if (mended != bytes) read(mended);
  return 0;
}

/// Half of the mutations change one section and repack the file, since a changed length moves all following sections.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  std::mt19937 random(seed);
  if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  std::vector<test::RawSection> sections = test::unpacked({reinterpret_cast<const char*>(data), size});
  if (sections.empty()) return LLVMFuzzerMutate(data, size, most);
  const std::size_t chosen = random() % sections.size();
  if (random() % 20 == 0) {
    sections.erase(sections.begin() + static_cast<std::ptrdiff_t>(chosen));
  } else {
    std::string& bytes = sections[chosen].bytes;
    std::string changed(bytes.size() + 256, '\0');
    std::copy(bytes.begin(), bytes.end(), changed.begin());
    changed.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(changed.data()), bytes.size(), changed.size()));
    const std::size_t element = std::clamp(sections[chosen].element_size, 1u, 128u);
    changed.resize((changed.size() + element - 1) / element * element);
    bytes = std::move(changed);
  }
  const std::string file = test::packed(sections);
  if (file.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, file.data(), file.size());
  return file.size();
}
