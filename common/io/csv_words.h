// Inner side of csv_file.h: small pieces of its texts.
#pragma once

#include <string>

#include "common/io/csv_file.h"

namespace softgrain::csv {

/// ASCII letters in lower case.
std::string lower(std::string text);

/// The text without double quotes around it.
std::string unquoted(const std::string& text);

/// "hn [mm]", "hn(mm)" into its parts.
CsvColumn column_of(const std::string& title);

/// "Young's_modulus" to "youngs modulus", Greek letters to their names.
std::string plain_name(const std::string& name);

}  // namespace softgrain::csv
