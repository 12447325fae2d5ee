// Fitted laws in words that program, report and checks share: numbers with their 95 % intervals as people read them
// (one that is not known is said to be so), and what a reader of the laws should know.
#pragma once

#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// Whether both ends are numbers that differ. Ends that agree to all their digits say that nothing scattered, which is
/// not that nothing could.
bool interval_known(double low, double high);

/// "0.0447 (0.0441 to 0.0453)", with as many digits as ends need to differ; "0.0447 (interval not determined)".
std::string interval_text(double value, double low, double high);
inline std::string interval_text(const Estimate& e) { return interval_text(e.value, e.low, e.high); }

/// "103 [98.2, 107]" in multiples of `unit`; "103 [not determined]".
std::string bracket_text(const Estimate& e, double unit = 1.0);

/// As many significant digits, `least` to `most`, as two numbers need to be different texts: 7 for 132.9 and 132.9001.
int digits_to_differ(double low, double high, int least, int most);

/// Writes a number with so many significant digits.
using WriteNumber = std::string (*)(double value, int digits);

/// How the ends of an interval are written.
struct EndsForm {
  WriteNumber number;
  int digits = 4;
  const char* between = " .. ";
  const char* unknown = "not determined";  ///< the text for an interval that is not known
  bool may_be_equal = false;               ///< whether finite ends are known even if they do not differ
};

/// "0.0441 .. 0.0453".
std::string ends_text(double low, double high, const EndsForm& form);

/// How an estimate with its standard error is written.
struct EstimateForm {
  WriteNumber number;
  const char* between = " +- ";
  const char* unknown = " (?)";  ///< the text after a number whose error is not known
};

/// "0.733 +- 0.19": three digits, and two of the error. "0.733" if the error is 0, as of a number that is fixed.
std::string estimate_with_error(const Estimate& e, const EstimateForm& form);

// Which form of law a table is taken with, and whether its errors chose it.

/// "isotropic (best)" where the errors of all forms chose it (the least one leaving one loading out, of those that the
/// data determine), "isotropic (chosen)" where a key did against them, "isotropic" of a form that is not
/// taken.
std::string form_label(const LawTableEntry& entry, const MultiContactLaw& law);

// What a reader of fitted laws should know.

/// How far off a law of a table is on loadings of planes that it did not see: of one that was fitted to packings
/// leaving one out, of one that comes from a library of laws as its materials were.
std::string unseen_error_text(const LawTableEntry& entry, const MultiContactLaw& law);

/// "friction limit and kt/kn: 0.22, 0.21 against planes; not measured against solid spheres (0.22, 0.21 stand in);
/// ...".
std::string slides_text(const LawTableEntry& entry);

/// What to know of the tangential stiffnesses of a card: that they come from a frozen turn, and what runs take where
/// none was measured; empty: all were, by a slow turn or in an experiment.
std::string kt_remark(const LawCard& card);

/// How the contact unloads at the end of its range: what of the depth stays, how steeply the force begins to fall, and
/// the share of the work that comes back; that it gives back all where no branch was measured.
std::string unloading_text(const PairLaw& law);

/// "unloading is 1.16 times as steep as loading", or that it was not measured.
std::string unloading_text(const LawTableEntry& entry);

/// What a pair law misses: force of a soft particle with several neighbours over that of its pair law, from two
/// opposite planes to twelve small spheres, and among soft particles, as measured for results/law_table.
inline constexpr double kPairLawMissesLeast = 2.2;
inline constexpr double kPairLawMissesMost = 12.0;
inline constexpr double kPairLawMissesAmongSoft = 43.0;
std::string pair_law_remark();

/// Whether curves were made with a law of single contacts.
bool use_pair_law(const std::vector<MacroCurve>& curves);

}  // namespace softgrain
