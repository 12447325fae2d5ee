// A press test as the law of a scene: from the table of a test bench to a law card, with the settings that fit most.
#pragma once

#include <string>

#include "common/data/law_card.h"
#include "pipelines/law/fitted_law.h"

namespace softgrain {

/// The law card of a table of force over overlap: the settings of softgrain calibrate as they stand without --set, and
/// the kind of contact that was not measured by symmetry. Kind, Rs and E stand in the comments of the table. Remarks of
/// the fit are notes of the card. Throws InputError with file and line for a table that is none of a press test, and
/// where no law can be fitted; IoError.
LawCard card_of_press_test(const std::string& path);

/// A law as load_law() takes it, or that of the table of a press test. Throws as these do.
FittedLaw load_or_fit_law(const std::string& path);

}  // namespace softgrain
