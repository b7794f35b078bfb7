// Registry of methods by name: methods of the library and methods added by programs.
#pragma once

#include <deque>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// Entries of one kind, each with a `name`. Entries keep their addresses until the program ends. Thread-safe.
template <class Entry>
class Registry {
 public:
  /// `kind` names an entry in messages: "surface". `own` are the library's entries in display order.
  Registry(std::string_view kind, const std::vector<std::span<const Entry>>& own) : kind_(kind) {
    for (const auto& some : own)
      for (const Entry& entry : some) add(entry);
  }

  /// Throws ArgumentError for a missing or taken name, and for an entry whose function `make` is null.
  void add(Entry entry) {
    const std::lock_guard lock(mutex_);
    if (entry.name.empty()) throw ArgumentError("a " + kind_ + " needs a name");
    if (found(entry.name)) throw ArgumentError("a " + kind_ + " named " + std::string(entry.name) + " already exists");
    if constexpr (requires { entry.make == nullptr; })
      if (entry.make == nullptr)
        throw ArgumentError("the " + kind_ + " " + std::string(entry.name) + " lacks a function that makes it");
    entries_.push_back(std::move(entry));
  }

  /// Returns null for an unknown name.
  const Entry* find(std::string_view name) const {
    const std::lock_guard lock(mutex_);
    return found(name);
  }

  /// Throws ArgumentError with the list of known names for an unknown name.
  const Entry& at(std::string_view name) const {
    if (const Entry* const entry = find(name)) return *entry;
    throw ArgumentError("unknown " + kind_ + " '" + printable(name, 40) + "': known are " + names());
  }

  std::vector<const Entry*> all() const {
    const std::lock_guard lock(mutex_);
    std::vector<const Entry*> all;
    all.reserve(entries_.size());
    for (const Entry& entry : entries_) all.push_back(&entry);
    return all;
  }

  /// "partition, hoppe, …"
  std::string names() const {
    std::string text;
    for (const Entry* const entry : all()) text += (text.empty() ? "" : ", ") + std::string(entry->name);
    return text;
  }

 private:
  const Entry* found(std::string_view name) const {
    for (const Entry& entry : entries_)
      if (entry.name == name) return &entry;
    return nullptr;
  }

  std::string kind_;
  std::deque<Entry> entries_;
  mutable std::mutex mutex_;
};

/// Adds an entry at program start: `static const Registered<SurfaceMethod> plane({.name = "plane", …});`
template <class Entry>
struct Registered {
  explicit Registered(Entry entry) { Entry::registry().add(std::move(entry)); }
};

}  // namespace sansmesh::inline v1
