// The law of all neighbours of a soft particle that was pressed on one plane: what the materials of a library that
// gave such a curve have in common. What is inside need not be known.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_library.h"

namespace softgrain {

/// A press test as a library is asked.
struct PressQuestion {
  PressNumbers numbers;
  std::vector<PressNumbers> draws{};  ///< what else the test might have given, by the errors of its fit
  double friction = 0.0;              ///< mu of the grains
};

/// The law of one plane with these a, b and delta, F/(E Rs^2) = a (D^b - delta^b), as a press test counts it; empty
/// where it has no force at D = 0.2.
std::optional<PressNumbers> press_numbers(double a, double b, double delta, double poisson_ratio);

/// Of the law of a soft particle against a plane in a card; nu is 0.3 where the card does not say it. Throws InputError
/// where the card has no such law that was fitted; `source` names the file.
PressQuestion press_question(const LawCard& card, double friction, const std::string& source);

/// Gaussian processes, one for each number, over ln F at D = 0.3, its difference from that at 0.2, and mu/(mu + 0.15)
/// of the measured materials, or mean and scatter, as LawLibrary::press_checks decide. Friction matters most where
/// there is little of it, hence the last one. Throws InputError for a library without press numbers, for a test beyond
/// what its materials gave, and for friction beyond theirs.
LibraryAnswer ask_by_press_test(const LawLibrary& library, const PressQuestion& question);

/// Every material left out in turn, and predicted by its own press numbers; empty when a material has none.
std::vector<LibraryCheck> check_press_tests(const LawLibrary& library);

/// The law table that a library gives for a press test.
struct PressTestLaw {
  PressQuestion question;
  LibraryAnswer answer;
  LawTable table;
  std::vector<std::string> remarks;  ///< what was read, which material is nearest, what was taken for granted
};

/// `path`: the table of a press test, or a law card. `friction`: mu of the grains, where the file does not say it.
/// Rs, E, nu and density are those of the file. Throws InputError, IoError.
PressTestLaw law_of_press_test(const LawLibrary& library, const std::string& path, std::optional<double> friction,
                               int draws = 64);

// A press test as the law of a scene: from the table of a test bench to a law card, with the settings that fit most.

/// The law card of a table of force over overlap: the settings of softgrain calibrate as they stand without --set, and
/// the kind of contact that was not measured by symmetry. Kind, Rs and E stand in the comments of the table. Remarks of
/// the fit are notes of the card. Throws InputError with file and line for a table that is none of a press test, and
/// where no law can be fitted; IoError.
LawCard card_of_press_test(const std::string& path);

/// A law as load_law() takes it, or that of the table of a press test. Throws as these do.
FittedLaw load_or_fit_law(const std::string& path);

}  // namespace softgrain
