// Numbers of the laws of a library, as LawLibrary says, and back.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pipelines/law/law_library.h"

namespace softgrain {

inline constexpr const char* kTrialsNumber = "ln trials";
inline constexpr const char* kOnsetNumber = "delta";
inline constexpr double kSameRatio = 1e-6;  ///< difference up to which two rows of neighbours have one size

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

/// Mu, exponent, ratio and solid fraction of what an entry was measured on.
LibraryPoint library_point_of(const LawTableEntry& entry);

/// What refits say of the numbers of a law.
struct RefitSpread {
  std::vector<double> errors;        ///< NaN: the number does not scatter, that is, was not fitted
  std::vector<double> correlations;  ///< row-major
};
RefitSpread refit_spread(const std::vector<LibraryPartner>& partners, const LawTableEntry& entry,
                         const MultiContactLaw& law);

/// What an entry says of its material: numbers of the isotropic law, then of all else. NaN: not measured.
struct OwnNumbers {
  std::vector<double> values;
  std::vector<double> errors;        ///< of the law by its refits; NaN also where a number does not scatter
  std::vector<double> correlations;  ///< of the numbers of the law, row-major
};
/// Throws InputError where the entry has no isotropic law, or fewer than kEnoughReplicates refits of it.
OwnNumbers own_numbers(const std::vector<LibraryPartner>& partners, const LawTableEntry& own);

/// Covariance, row-major, from deviations and correlations.
std::vector<double> covariance_of(const std::vector<double>& deviations, const std::vector<double>& correlations);

/// That of the first `count` numbers of an answer, those of the law.
std::vector<double> law_covariance(const LibraryAnswer& answer, std::size_t count);

/// The isotropic law of an answer with `draws` normal draws of it as refits.
MultiContactLaw law_of_answer(const LawLibrary& library, const LibraryAnswer& answer, double poisson_ratio, int draws);

}  // namespace softgrain
