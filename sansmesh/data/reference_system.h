// Coordinate reference systems of files: well-known text (WKT 1 and 2), GeoTIFF keys, EPSG codes. They are read,
// compared and written, and coordinates are never converted.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

using SharedSystem = std::shared_ptr<const ReferenceSystem>;

/// System of a text: WKT 1 or 2, or "EPSG:25832", optionally with a vertical code ("EPSG:25832+7837"). Null if the text
/// is empty or is neither.
SharedSystem system_of_text(std::string_view text);

/// System of GeoTIFF keys (the arrays of the tags 34735 to 34737), null if they state none. `text`: WKT of the same
/// system, or empty.
SharedSystem system_of_keys(std::span<const std::uint16_t> keys, std::span<const double> doubles,
                            std::string_view ascii, std::string_view text = {});

/// The system as WKT for other programs; empty if only its code or keys are known, and no text follows from them (it
/// does for UTM zones on WGS 84, ETRS89 and NAD83). Units that differ from those of the text or code are in it.
std::string wkt_of(const ReferenceSystem& system);

/// "NAD83 / UTM zone 10N (EPSG:26910), unit metre"
std::string system_words(const ReferenceSystem& system);

/// "unit metre", "unit metre, heights in US survey foot", "unit unknown"
std::string unit_words(const ReferenceSystem& system);

/// False only if the systems differ for certain: in their codes, or else in their names or units. Null is any system.
bool may_be_equal(const ReferenceSystem* a, const ReferenceSystem* b);

/// Reference systems of several inputs. All pairs are compared: one that states only its unit may equal two others that
/// differ.
class CommonSystem {
 public:
  struct Stated {
    std::string name;  ///< name of the input
    SharedSystem system;
  };

  /// Adds the system of an input; null is unknown. Returns an earlier input whose system differs for certain, or null.
  const Stated* add(const std::string& name, const SharedSystem& system);
  /// The system of the inputs that states most; null if all are unknown.
  SharedSystem system() const;

 private:
  std::vector<Stated> different_;  ///< one input per description
};

/// Throws DataError, which names both, unless they may be equal. `a_is`, `b_is`: "the part".
void require_same_system(const ReferenceSystem* a, std::string_view a_is, const ReferenceSystem* b,
                         std::string_view b_is);

}  // namespace sansmesh::inline v1
