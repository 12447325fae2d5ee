// A press test as the law of a scene: from the table of a test bench to a law card, with the settings that fit most.
#pragma once

#include <string>

#include "common/data/law_card.h"

namespace softgrain {

/// Whether a path names a table of an experiment: .csv, .tsv, .txt or .dat.
bool is_curve_file(const std::string& path);

/// The law card of a table of force over overlap: the settings of softgrain calibrate as they stand without --set, and
/// the kind of contact that was not measured by symmetry. Kind, Rs and E stand in the comments of the table. Remarks of
/// the fit are notes of the card. Throws InputError with file and line for a table that is none of a press test, and
/// where no law can be fitted; IoError.
LawCard card_of_press_test(const std::string& path);

}  // namespace softgrain
