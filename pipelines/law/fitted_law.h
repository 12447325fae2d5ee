// A law as a file holds it: a card of pair laws, a table of multi-contact laws or a card of the cell law. Read once;
// scenes, commands and reports go by what it holds. Laws as text for a terminal.
#pragma once

#include <string>
#include <variant>

#include "common/core/error.h"
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
  std::string remark{};  ///< what to know of it; of a library: which measured material is nearest

  [[nodiscard]] const LawCard* card() const { return std::get_if<LawCard>(&content); }
  [[nodiscard]] const LawTable* table() const { return std::get_if<LawTable>(&content); }
  [[nodiscard]] const CellCard* cells() const { return std::get_if<CellCard>(&content); }
};

/// ask(), whose complaint about the law names the file that it is of.
template <class Ask>
auto complaining_of(const FittedLaw& law, const Ask& ask) {
  try {
    return ask();
  } catch (const InputError& e) {
    if (law.path.empty()) throw;
    throw InputError(law.path + ": " + e.what());
  }
}

/// "law card", "law table", "cell law".
std::string kind_text(const FittedLaw& law);

/// Reads a card (with bands and measured curve when the .h5 is beside it), a table (without its refits), a card of the
/// cell law, or those of a run directory (law_table.toml before law.toml and cell_law.toml). They are told apart by
/// content: [[pair]], [[entry]], [cell]. Throws InputError with file and line for anything else, IoError.
FittedLaw load_law(const std::string& path);
FittedLaw load_law(const Scene& file);

/// Whether a path names a table of an experiment: .csv, .tsv, .txt or .dat.
bool is_curve_file(const std::string& path);

/// The refits of a table from the .h5 beside it, where they were not read before. Throws InputError, IoError.
void read_refits(FittedLaw& law);

/// Whether it is the card of a whole material, which a recipe leaves for people and programs: it has [material] with
/// phi_J.
bool is_material_card(const Scene& file);

}  // namespace softgrain

namespace softgrain::law {

// Laws as text for a terminal, never wider than 80 columns (but for single words that are).

/// Of a card: what was measured and how, parameters with intervals, range and status, and a small plot of the normal
/// law. Of a table: every entry with its laws, neighbours, friction, and how far off the laws are. Of a card of the
/// cell law: its numbers, and a small plot of the equation of state.
std::string law_text(const FittedLaw& file, bool utf8);

/// A number with `digits` significant digits.
std::string number(double x, int digits = 4);
/// The text of each kind of law; `file` says where it comes from.
std::string show(const LawCard& card, const FittedLaw& file, bool utf8);
std::string show(const LawTable& table, const FittedLaw& file, bool utf8);
std::string show(const CellCard& card, const FittedLaw& file, bool utf8);
/// "softgrain 0.1.0 (8b5b7b7fb7b0), seed 1: softgrain run ..."; empty when the file says nothing.
std::string origin_text(const LawOrigin& origin);
/// "Rs = 0.016 m, E = 5e+05 Pa, ..." of the soft particle that was measured.
std::string show_spec(const SoftParticleSpec& spec);

}  // namespace softgrain::law
