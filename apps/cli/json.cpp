// The only source of the tool that knows the library for JSON: it takes long to compile.
#include "json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sansmesh::cli {

struct Json::Writer {
  static nlohmann::ordered_json written(const Json& json) {
    switch (json.kind_) {
      case Kind::null:
        return {};
      case Kind::truth:
        return json.whole_ != 0;
      case Kind::whole:
        return static_cast<std::int64_t>(json.whole_);
      case Kind::natural:
        return json.whole_;
      case Kind::real:
        return json.real_;
      case Kind::text:
        return json.text_;
      case Kind::array: {
        auto list = nlohmann::ordered_json::array();
        for (const Json& item : json.items_) list.push_back(written(item));
        return list;
      }
      case Kind::object:
        break;
    }
    auto object = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < json.items_.size(); ++i) object[json.keys_[i]] = written(json.items_[i]);
    return object;
  }
};

Json::Json(std::initializer_list<Json> list) : kind_(Kind::array) {
  const bool pairs = std::all_of(list.begin(), list.end(), [](const Json& item) {
    return item.kind_ == Kind::array && item.items_.size() == 2 && item.items_[0].kind_ == Kind::text;
  });
  if (!pairs) {
    items_ = list;
    return;
  }
  kind_ = Kind::object;
  for (const Json& item : list) {
    keys_.push_back(item.items_[0].text_);
    items_.push_back(item.items_[1]);
  }
}

Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json Json::array() {
  Json list;
  list.kind_ = Kind::array;
  return list;
}

Json Json::object() {
  Json empty;
  empty.kind_ = Kind::object;
  return empty;
}

Json* Json::at(std::string_view path, bool add) {
  const std::size_t dot = path.find('.');
  if (dot == std::string_view::npos) return &(*this)[path];
  Json& part = (*this)[path.substr(0, dot)];
  return part.is_null() && !add ? nullptr : part.at(path.substr(dot + 1), add);
}

Json& Json::operator[](std::string_view key) {
  if (kind_ == Kind::null) kind_ = Kind::object;
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  if (found != keys_.end()) return items_[static_cast<std::size_t>(found - keys_.begin())];
  keys_.emplace_back(key);
  return items_.emplace_back();
}

void Json::push_back(Json value) {
  if (kind_ == Kind::null) kind_ = Kind::array;
  items_.push_back(std::move(value));
}

std::string Json::text() const {
  return Writer::written(*this).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sansmesh::cli
