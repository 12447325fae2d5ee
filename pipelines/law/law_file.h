// A file with laws as the law commands see it: a card, a table or a card of the cell law, with what is known of its
// making.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/data/cell_card.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"

namespace softgrain::law {

/// Who made a file, as it says; empty texts where it does not.
struct LawOrigin {
  std::string version;
  std::string commit;
  std::string command;
  std::string seed;
};

struct LawFile {
  std::string path;
  std::optional<LawCard> card;    ///< law card, with bands and measured curve when the .h5 is beside it
  std::optional<LawTable> table;  ///< law table, with replicates when the .h5 is beside it
  std::optional<CellCard> cells;
  LawOrigin origin;
};

/// Reads a card, a table, a card of the cell law, or those of a run directory (law_table.toml before law.toml and
/// cell_law.toml). Throws InputError with file and
/// line for wrong content, IoError for files.
LawFile load_law_file(const std::string& path);

/// n >= 2 values evenly spread over [low, high], the ends exact.
std::vector<double> even(double low, double high, std::size_t n);

}  // namespace softgrain::law
