// Numbers with units of which nothing is known but their text.
#pragma once

#include <optional>
#include <string>

namespace softgrain {

/// SI value of a number with any unit that scenes know ("50 GPa": 5e10; angles in degrees), or without one; none for
/// what is no such number. No unit stands for two quantities with different factors.
std::optional<double> quantity_of_any_unit(const std::string& text);

}  // namespace softgrain
