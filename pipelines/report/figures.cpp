#include "pipelines/report/figures.h"

#include <cctype>
#include <map>

namespace softgrain::report {

namespace {

/// "Fn(Delta), soft-solid" -> "fn-delta-soft-solid".
std::string file_name(const std::string& title) {
  std::string out;
  for (const char c : title) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) != 0 && u < 128)
      out += static_cast<char>(std::tolower(u));
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out.empty() ? "figure" : out;
}

/// The accessible name of a figure, which is its title.
std::string label_of(const std::string& svg) {
  const std::string key = "aria-label=\"";
  const std::size_t begin = svg.find(key);
  if (begin == std::string::npos) return "figure";
  const std::size_t end = svg.find('"', begin + key.size());
  return end == std::string::npos ? "figure" : svg.substr(begin + key.size(), end - begin - key.size());
}

}  // namespace

std::vector<Figure> figures_of(const std::string& html) {
  const std::string close = "</svg>";
  std::vector<Figure> figures;
  std::map<std::string, int> uses;
  for (std::size_t at = html.find("<svg"); at != std::string::npos; at = html.find("<svg", at)) {
    const std::size_t end = html.find(close, at);
    if (end == std::string::npos) break;
    const std::string svg = html.substr(at, end + close.size() - at);
    std::string name = file_name(label_of(svg));
    const int use = ++uses[name];
    if (use > 1) name += "-" + std::to_string(use);
    figures.push_back({name, svg + "\n"});
    at = end;
  }
  return figures;
}

}  // namespace softgrain::report
