// Methods by name: those of the library, and those that programs add.
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

/// Entries of one kind, each with its `name`. They stay where they are for as long as the program runs. Safe to use
/// from several threads.
template <class Entry>
class Registry {
 public:
  /// `kind` names one in messages: "surface". `own` are those of the library, in the order in which they are listed.
  Registry(std::string_view kind, const std::vector<std::span<const Entry>>& own) : kind_(kind) {
    for (const auto& some : own)
      for (const Entry& entry : some) add(entry);
  }

  /// Throws ArgumentError for a missing or taken name, and for an entry whose function `make` is null.
  void add(Entry entry) {
    const std::lock_guard lock(mutex_);
    if (entry.name.empty()) throw ArgumentError("a " + kind_ + " needs a name");
    if (found(entry.name)) throw ArgumentError("there is a " + kind_ + " " + std::string(entry.name) + " already");
    if constexpr (requires { entry.make == nullptr; })
      if (entry.make == nullptr)
        throw ArgumentError("the " + kind_ + " " + std::string(entry.name) + " lacks a function that makes it");
    entries_.push_back(std::move(entry));
  }

  /// Null for a name that is none.
  const Entry* find(std::string_view name) const {
    const std::lock_guard lock(mutex_);
    return found(name);
  }

  /// Throws ArgumentError, which lists the names.
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

/// Adds an entry when a program starts: `static const Registered<SurfaceMethod> plane({.name = "plane", …});`
template <class Entry>
struct Registered {
  explicit Registered(Entry entry) { Entry::registry().add(std::move(entry)); }
};

}  // namespace sansmesh::inline v1
