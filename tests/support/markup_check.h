// Whether every tag of a piece of HTML or SVG is closed in the right order.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace softgrain {

inline bool has_text(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Empty when balanced, else the first tag that is not. Knows void elements (meta) and "<!DOCTYPE".
inline std::string unbalanced_tags(const std::string& markup) {
  static const std::set<std::string> voids{"meta", "br", "link", "!DOCTYPE"};
  std::vector<std::string> open;
  for (std::size_t at = markup.find('<'); at != std::string::npos; at = markup.find('<', at + 1)) {
    const std::size_t end = markup.find('>', at);
    if (end == std::string::npos) return markup.substr(at, 20);
    const bool closing = markup[at + 1] == '/';
    const std::size_t begin = at + (closing ? 2 : 1);
    const std::string name = markup.substr(begin, markup.find_first_of(" />\n", begin) - begin);
    if (voids.count(name) != 0 || (!closing && markup[end - 1] == '/')) continue;
    if (!closing) {
      open.push_back(name);
      // What stands in these is no markup.
      if (name == "script" || name == "style") at = markup.find("</" + name, at) - 1;
    } else if (open.empty() || open.back() != name) {
      return "</" + name + ">";
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

}  // namespace softgrain
