// Columns of sieve analyses by their titles, in English, German and French.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/io/csv_file.h"

namespace softgrain {

/// What a column of a sieve analysis says.
enum class SieveColumn {
  other,
  ignored,     ///< masses of empty sieves, limits, losses: about the curve, and no part of it
  opening,     ///< sizes of sieves
  name,        ///< names or numbers of sieves
  passing,     ///< what passes a sieve
  retained,    ///< what each sieve retains
  cumulative,  ///< what all sieves down to this one retain
  unclear,     ///< what each sieve retains, or all down to it
  running      ///< cumulative, of what passes or of what is retained
};

/// In what a column counts; `length`: of a column of values, or with any other unit, it is wrong.
enum class SieveMeasure { unknown, percent, share, mass, length };

struct SieveTitle {
  SieveColumn column = SieveColumn::other;
  SieveMeasure measure = SieveMeasure::unknown;
  std::string unit{};  ///< of lengths, as sieve_unit() gives it; of masses and what is wrong as written
};

/// What the key `column` of a scene may call the meaning of a column.
template <>
inline constexpr auto enum_names<SieveColumn> = enum_name_list<SieveColumn>({{SieveColumn::passing, "passing"},
                                                                             {SieveColumn::retained, "retained"},
                                                                             {SieveColumn::cumulative,
                                                                              "cumulative retained"}});

SieveTitle sieve_title(const CsvColumn& column);

/// Whether these are the columns of a sieve analysis: one of sizes, and one of what passes or is retained.
bool are_sieve_columns(const std::vector<CsvColumn>& columns);

/// The columns to read.
struct SieveChoice {
  std::size_t size = 0;
  std::size_t value = 0;
  SieveColumn meaning = SieveColumn::other;  ///< of `value`
  std::vector<SieveTitle> titles{};          ///< of all columns
};

/// `asked`: the key `column` of a scene, a meaning, the title of a column, or "TITLE as MEANING"; empty: what passes
/// goes before what is retained in all, before what each sieve retains. Throws InputError where there is none or there
/// are several of equal rank, and for columns that say something else in numbers.
SieveChoice choose_sieve_columns(const CsvFile& csv, const std::string& asked);

}  // namespace softgrain
