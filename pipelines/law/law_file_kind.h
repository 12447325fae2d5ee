// What a file with laws holds.
#pragma once

#include <string>

namespace softgrain {

enum class LawFileKind { card, table, cells };

/// Whether it is the card of a whole material, which a recipe leaves for people and programs: it has [material] with
/// phi_J. Throws InputError, IoError.
bool is_material_card(const std::string& path);

/// Tells them apart by content: a card has [[pair]], a table [[entry]], a card of the cell law [cell]. Throws
/// InputError for anything else, the card of a material among it, IoError.
LawFileKind law_file_kind(const std::string& path);

}  // namespace softgrain
