#include "pipelines/run/variant_name.h"

#include <algorithm>
#include <cctype>

namespace softgrain {

std::string read_variant_name(const SceneTable& variant) {
  std::string name = variant.text("name");
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (!plain || name.front() == '.')
    variant.add_error("name", "must be made of letters, digits, '-', '_' and '.', which does not lead");
  return name;
}

}  // namespace softgrain
