// A law as a file holds it: a card of pair laws, a table of multi-contact laws or a card of the cell law. Read once;
// scenes, commands and reports go by what it holds.
#pragma once

#include <string>
#include <variant>

#include "common/data/cell_card.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// Who made a file, as it says; empty texts where it does not.
struct LawOrigin {
  std::string version;
  std::string commit;
  std::string command;
  std::string seed;
};

struct FittedLaw {
  std::variant<LawCard, LawTable, CellCard> content;
  std::string path{};  ///< empty: not of a file
  std::string text{};  ///< content of the file
  LawOrigin origin{};

  [[nodiscard]] const LawCard* card() const { return std::get_if<LawCard>(&content); }
  [[nodiscard]] const LawTable* table() const { return std::get_if<LawTable>(&content); }
  [[nodiscard]] const CellCard* cells() const { return std::get_if<CellCard>(&content); }
};

/// "law card", "law table", "cell law".
std::string kind_text(const FittedLaw& law);

/// Reads a card (with bands and measured curve when the .h5 is beside it), a table (without its refits), a card of the
/// cell law, or those of a run directory (law_table.toml before law.toml and cell_law.toml). They are told apart by
/// content: [[pair]], [[entry]], [cell]. Throws InputError with file and line for anything else, IoError.
FittedLaw load_law(const std::string& path);
FittedLaw load_law(const Scene& file);

/// The refits of a table from the .h5 beside it, where they were not read before. Throws InputError, IoError.
void read_refits(FittedLaw& law);

/// Whether it is the card of a whole material, which a recipe leaves for people and programs: it has [material] with
/// phi_J.
bool is_material_card(const Scene& file);

}  // namespace softgrain
