// Law cards and law tables for Python: forces of soft particles by one contact, and of those that know about all their
// contacts.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"
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

/// Choice of a law of a table.
struct TableChoice {
  std::optional<std::string> form;       ///< none: the best of the entry
  std::optional<double> solid_fraction;  ///< none: that of the main entry
  std::string range = "reject";          ///< policy for solid fractions outside the table
  std::optional<std::string> beyond;     ///< none: what the table says
};

/// Neighbours of the soft particle.
struct NeighbourChoice {
  std::vector<std::string> kinds;
  std::vector<double> ratios;
  std::vector<std::vector<double>> directions;
};

class TableBinding {
 public:
  explicit TableBinding(LawTable table) : table_(std::move(table)) {}

  /// What the choice comes to: form, solid fraction, ranges, remark, replicates.
  [[nodiscard]] pybind11::dict about(const TableChoice& choice) const;
  /// overlap [state][neighbour] over R; one number per state for neighbour `which`, or of all (which < 0) as `overlap`.
  [[nodiscard]] Array values(const TableChoice& choice, const NeighbourChoice& around, const std::string& what,
                             int which, const Array& overlap, double scale) const;
  /// 95 % interval of neighbour `which`, low and high; none where the table keeps no replicates.
  [[nodiscard]] std::optional<std::pair<Array, Array>> interval(const TableChoice& choice,
                                                                const NeighbourChoice& around, const std::string& what,
                                                                int which, const Array& overlap, double scale) const;

 private:
  LawTable table_;
};

}  // namespace softgrain::python
