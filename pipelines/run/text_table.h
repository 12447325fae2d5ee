// Tables of texts as CSV and Markdown.
#pragma once

#include <string>
#include <vector>

namespace softgrain {

struct TextTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

std::string as_csv(const TextTable& table);  ///< cells with commas, quotes or line ends are quoted
std::string as_markdown(const TextTable& table);

}  // namespace softgrain
