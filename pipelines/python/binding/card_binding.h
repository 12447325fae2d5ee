// A law card for Python.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <utility>

#include "common/data/law_card.h"
#include "pipelines/python/binding/law_arrays.h"

namespace softgrain::python {

using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// A policy by name, none for none. Throws InputError.
std::optional<Extrapolation> beyond_of(const std::optional<std::string>& name);

class CardBinding {
 public:
  explicit CardBinding(LawCard card) : card_(std::move(card)) {}

  /// Force or stiffness at Delta times `scale`, in the shape of `delta`.
  [[nodiscard]] Array values(const std::string& kind, const std::string& what, const Array& delta, double scale,
                             bool secant, const std::optional<std::string>& beyond) const;
  /// 95 % interval of the same, low and high; none where the card keeps nothing to tell it from.
  [[nodiscard]] std::optional<std::pair<Array, Array>> interval(const std::string& kind, const std::string& what,
                                                                const Array& delta, double scale, bool secant,
                                                                const std::optional<std::string>& beyond) const;

 private:
  LawCard card_;
};

}  // namespace softgrain::python
