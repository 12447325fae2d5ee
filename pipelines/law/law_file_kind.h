// What a file with laws holds.
#pragma once

#include <string>

namespace softgrain {

enum class LawFileKind { card, table, cells };

/// Tells them apart by content: a card has [[pair]], a table [[entry]], a card of the cell law [cell]. Throws BadInput
/// for anything else, FileTrouble.
LawFileKind law_file_kind(const std::string& path);

}  // namespace softgrain
