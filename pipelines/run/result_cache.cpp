#include "pipelines/run/result_cache.h"

#include <unistd.h>

#include <filesystem>
#include <mutex>

#include "common/core/error.h"
#include "common/io/file_safety.h"
#include "common/io/provenance.h"
#include "common/io/text_file.h"

namespace softgrain {

std::string SharedResults::name(const std::string& prefix, const std::string& key) {
  return prefix + "-" + short_hash(key);
}

void SharedResults::read(const std::string& format, const std::string& file, const std::string& key,
                         const std::string& again, const std::function<void(const h5::Group&)>& content) const {
  const std::string path = directory_ + "/" + file + ".h5";
  std::error_code is_a_loop;
  if (directory_.empty() || !std::filesystem::exists(path, is_a_loop)) return;
  // Where a folder or a pipe has its name a result cannot be kept: said before it is computed.
  if (!std::filesystem::is_regular_file(path, is_a_loop)) require_readable_file(path);
  try {
    const std::lock_guard lock(h5::library_mutex());
    if (check_seal(path) != Seal::whole) throw IoError(path + ": damaged, or written by an earlier version");
    const h5::Group root = h5::open_file(path);
    require_format(root, format.c_str(), path);
    if (root.text("key") != key) throw IoError(path + ": belongs to another result");
    content(root);
  } catch (const IoError& e) {
    const std::string why = e.what();
    say_((why.find(path) == std::string::npos ? path + ": " + why : why) + "; " + again);
  }
}

void SharedResults::write(const std::string& format, const std::string& file, const std::string& key,
                          const std::function<void(const h5::Group&)>& content) const {
  if (directory_.empty()) return;
  const std::string path = directory_ + "/" + file + ".h5";
  // Other processes may keep the same result: each writes a file of its own, the last one to finish stays.
  const std::string own = path + "." + std::to_string(::getpid());
  {
    const std::lock_guard lock(h5::library_mutex());
    h5::AtomicFile out(own, false, true);
    write_format(out.root(), format.c_str());
    out.root().attribute("key", key);
    content(out.root());
    out.commit();
  }
  std::error_code error;
  std::filesystem::rename(own, path, error);
  if (error) throw IoError(path + ": cannot be written: " + error.message());
}

KeyText& KeyText::add(const std::string& value) {
  // A key is kept as an attribute of a file, which has room for 64 kB: of lists and files their hash stands there.
  constexpr std::size_t kLongest = 400;
  const std::string shown = value.size() > kLongest ? "hash " + short_hash(value) : value;
  return append(fmt::format("{}:{}", value.size(), shown));
}

}  // namespace softgrain
