// The refits behind a multi-contact law: what its parameters are together, packings drawn with replacement. They say
// how sure a force is; intervals of single parameters do not, because a, b and delta are nearly degenerate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/data/law_band.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// Numbers of a law that forces depend on, as one row: a, b, delta, m0, m1, m2, then weight and exponent of every row
/// of neighbours.
std::vector<double> multi_contact_numbers(const MultiContactLaw& law);

/// The law with other numbers, in the order of multi_contact_numbers(). Throws std::invalid_argument for a row of wrong
/// length.
MultiContactLaw with_numbers(const MultiContactLaw& law, const std::vector<double>& numbers);

/// Fills MultiContactLaw::replicates from the .h5 beside a table. Laws whose numbers are not those of the table (it was
/// edited) get none, which LawTable::notes say, and so does everything when there is no such file. Throws IoError
/// for a damaged one, InputError for that of another table.
void read_replicates(LawTable& table, const std::string& toml_path);

/// Reads the whole .h5 of a table, whatever its .toml. Throws IoError for damage.
void check_replicates(const std::string& path);

/// The table as replicate `r` of each entry's law of this form; entries draw their packings independently, so any
/// pairing of their replicates is one draw of the whole table.
LawTable replicate_of(const LawTable& table, LawForm form, std::size_t r);

/// Replicates that every entry has of this form.
std::size_t replicate_count(const LawTable& table, LawForm form);

// How sure a law of a table is, and up to where it was measured.

/// Fewer replicates than this say nothing of an interval.
inline constexpr std::size_t kEnoughReplicates = 10;

/// Largest overlap over Rs that was measured with neighbours of this kind and radius (over Rs; not of planes), from the
/// row of the nearest ratio.
double measured_overlap(const LawTableEntry& entry, LawForm form, PartnerKind partner, double ratio);

/// 95 % interval of a number of a law above 0, from what the refits to drawn packings give in its place; widened for
/// few packings. Empty with fewer than ten refits.
std::optional<LawInterval> refit_interval(double value, const std::vector<double>& refits, int packings);

}  // namespace softgrain
