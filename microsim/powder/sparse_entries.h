// A sparse matrix as a list of entries.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace softgrain {

/// At most one entry per place.
struct SparseEntries {
  struct Entry {
    std::int64_t row = 0;
    std::int64_t column = 0;
    double value = 0.0;
  };
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  std::vector<Entry> entries;

  [[nodiscard]] SparseEntries transposed() const {
    SparseEntries out = *this;
    std::swap(out.rows, out.columns);
    for (Entry& e : out.entries) std::swap(e.row, e.column);
    return out;
  }
};

}  // namespace softgrain
