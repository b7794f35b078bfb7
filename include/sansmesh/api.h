// Marks of the public interface.
#pragma once

/// Everything that programs use of the library, in the inline namespace v1.
namespace sansmesh {}

/// What programs may use of the shared library: nothing else is exported.
#if defined(__GNUC__)
#define SANSMESH_API __attribute__((visibility("default")))
#else
#define SANSMESH_API
#endif
