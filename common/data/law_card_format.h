// Inner side of law_card.h: text and table of a card. For sources that write or read cards.
#pragma once

#include <array>
#include <string>

#include "common/data/law_card.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// The three threshold power laws of a pair and their places in the file.
struct LawPartName {
  const char* key;  ///< [pair.KEY]
  ThresholdPowerLaw PairLaw::*law;
  bool tangential;
};
inline constexpr std::array<LawPartName, 3> kLawParts{{{"normal", &PairLaw::normal, false},
                                                       {"tangential_initial", &PairLaw::tangential_initial, true},
                                                       {"tangential_secant", &PairLaw::tangential_secant, true}}};

/// The four numbers of a threshold power law.
struct LawParameterName {
  const char* key;
  Estimate ThresholdPowerLaw::*estimate;
  bool has_dimension;  ///< true for those in units of the law (a, c)
};
inline constexpr std::array<LawParameterName, 4> kLawParameters{{{"a", &ThresholdPowerLaw::a, true},
                                                                 {"b", &ThresholdPowerLaw::b, false},
                                                                 {"c", &ThresholdPowerLaw::c, true},
                                                                 {"delta", &ThresholdPowerLaw::delta, false}}};

/// Columns of the measured curve.
struct LawTableColumn {
  const char* name;
  std::vector<double> LawTableRows::*values;
};
inline constexpr std::array<LawTableColumn, 7> kLawTableColumns{
    {{"delta", &LawTableRows::delta},
     {"force_mean", &LawTableRows::force_mean},
     {"force_deviation", &LawTableRows::force_deviation},
     {"kt_initial_mean", &LawTableRows::kt_initial_mean},
     {"kt_initial_deviation", &LawTableRows::kt_initial_deviation},
     {"kt_secant_mean", &LawTableRows::kt_secant_mean},
     {"kt_secant_deviation", &LawTableRows::kt_secant_deviation}}};

/// The card as TOML; `table_id` names the .h5 that belongs to it.
std::string card_text(const LawCard& card, const Provenance& provenance, const std::string& table_id);

/// Card without its table. Throws InputError with file and line, IoError.
LawCard read_card_text(const Scene& file);

/// Name of the table beside a card: the same with extension .h5.
std::string table_path(const std::string& toml_path);
void write_table(const LawCard& card, const std::string& path, const Provenance& provenance,
                 const std::string& table_id);

/// Card (or law table) and .h5 name each other by `table_id`. Throws InputError when the file belongs to another one.
void require_own_table(const h5::Group& root, const std::string& table_id, const std::string& path);
inline constexpr const char* kTableId = "belongs_to";          ///< attribute of the .h5
inline constexpr const char* kLawFormat = "soft contact law";  ///< of the .h5 beside a card

/// Fills the table rows of the pairs that the file holds, and the bands of laws whose numbers are those of the card; a
/// law that was edited has none, which LawCard::notes say. Throws IoError, InputError for the table of another card.
void read_table(LawCard& card, const std::string& path);

/// Reads everything that read_table() may take from such a file, whatever its card. Throws IoError for damage.
void check_table(const std::string& path);

}  // namespace softgrain
