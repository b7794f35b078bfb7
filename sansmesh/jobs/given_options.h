// Rejects options that do not apply.
#pragma once

#include <initializer_list>
#include <string>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

struct GivenOption {
  const char* field;
  bool given;
};

/// Throws ArgumentError naming the first given option: "`field` is for meshes".
inline void refuse(std::initializer_list<GivenOption> options, const char* why) {
  for (const GivenOption& o : options)
    if (o.given) throw ArgumentError('`' + std::string(o.field) + "` " + why);
}

}  // namespace sansmesh::inline v1
