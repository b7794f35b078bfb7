// Macro that exports the symbols of the public interface.
#pragma once

/// Public interface of the library, in the inline namespace v1.
namespace sansmesh {}

/// Exports a symbol from the shared library. All other symbols are hidden.
#if defined(__GNUC__)
#define SANSMESH_API __attribute__((visibility("default")))
#else
#define SANSMESH_API
#endif
