// A law table for Python: forces of soft particles that know about all their contacts.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/data/multi_contact_law.h"
#include "pipelines/python/binding/card_binding.h"

namespace softgrain::python {

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
