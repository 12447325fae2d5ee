// Between numpy arrays and spans, and between words and enums.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/io/scene.h"
#include "pipelines/python/binding/law_bindings.h"

namespace softgrain::python {

/// An array of this shape, to be filled.
inline Array like(const Array& model) {
  return Array(std::vector<pybind11::ssize_t>(model.shape(), model.shape() + model.ndim()));
}

inline std::span<const double> view(const Array& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}
inline std::span<double> view(Array& array) { return {array.mutable_data(), static_cast<std::size_t>(array.size())}; }

/// The value behind a word. Throws InputError that names the known words and the nearest.
template <NamedEnum Enum>
Enum parse_choice(const std::string& key, const std::string& word) {
  if (const auto value = parse_enum<Enum>(word)) return *value;
  std::vector<std::string> known;
  std::string list;
  for (const char* one : all_enum_names<Enum>()) {
    known.emplace_back(one);
    list += (list.empty() ? "\"" : ", \"") + known.back() + "\"";
  }
  const std::string near = nearest_word(word, known);
  throw InputError(key + " = \"" + word + "\": must be one of " + list +
                   (near.empty() ? "" : "; nearest is \"" + near + "\""));
}

}  // namespace softgrain::python
