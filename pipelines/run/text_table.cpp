#include "pipelines/run/text_table.h"

#include <algorithm>

#include "common/core/text.h"

namespace softgrain {

namespace {

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) { return join_text(cells, ",", quoted) + "\n"; }

std::string markdown_line(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (std::string cell : cells) {
    std::replace(cell.begin(), cell.end(), '\n', ' ');
    std::replace(cell.begin(), cell.end(), '|', '/');
    line += " " + cell + " |";
  }
  return line + "\n";
}

}  // namespace

std::string as_csv(const TextTable& table) {
  std::string text = csv_line(table.header);
  for (const auto& row : table.rows) text += csv_line(row);
  return text;
}

std::string as_markdown(const TextTable& table) {
  std::string text = markdown_line(table.header) + "|";
  for (std::size_t k = 0; k < table.header.size(); ++k) text += "---|";
  text += "\n";
  for (const auto& row : table.rows) text += markdown_line(row);
  return text;
}

}  // namespace softgrain
