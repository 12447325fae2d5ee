#include "pipelines/run/key_text.h"

#include "common/io/text_file.h"

namespace softgrain {

KeyText& KeyText::add(const std::string& value) {
  // A key is kept as an attribute of a file, which has room for 64 kB: of lists and files their hash stands there.
  constexpr std::size_t kLongest = 400;
  const std::string shown = value.size() > kLongest ? "hash " + short_hash(value) : value;
  return append(fmt::format("{}:{}", value.size(), shown));
}

}  // namespace softgrain
