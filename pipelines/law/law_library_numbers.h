// Numbers of the laws of a library, as LawLibrary says, and back.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pipelines/law/law_library.h"

namespace softgrain {

inline constexpr const char* kTrialsNumber = "ln trials";

/// Names of the numbers that stand behind those of the law.
std::vector<std::string> side_names();

/// Numbers of one law as multi_contact_numbers() gives them, a in units of E, as numbers of the library. NaN: not
/// finite, or a row of neighbours that the law does not have.
std::vector<double> library_numbers(const std::vector<LibraryPartner>& partners, const MultiContactLaw& law,
                                    const std::vector<double>& numbers, double poisson_ratio);

/// The same back: numbers in the order of multi_contact_numbers() for a law with these neighbours.
std::vector<double> law_numbers_of(const std::vector<LibraryPartner>& partners, const std::vector<double>& numbers,
                                   double poisson_ratio);

/// Values with standard errors of what stands behind the numbers of the law; NaN: not measured.
struct SideNumbers {
  std::vector<double> values;
  std::vector<double> errors;
};
SideNumbers side_numbers(const LawTableEntry& entry, const MultiContactLaw& law);

/// Puts them into an entry whose law and material are there; `numbers` as side_names() says.
void set_side_numbers(const std::vector<LibraryNumber>& numbers, LawTableEntry& entry, MultiContactLaw& law);

/// What refits say of the numbers of a law.
struct RefitSpread {
  std::vector<double> errors;        ///< NaN: the number does not scatter, that is, was not fitted
  std::vector<double> correlations;  ///< row-major
};
RefitSpread refit_spread(const std::vector<LibraryPartner>& partners, const LawTableEntry& entry,
                         const MultiContactLaw& law);

}  // namespace softgrain
