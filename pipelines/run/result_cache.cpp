#include "pipelines/run/result_cache.h"

#include <unistd.h>

#include <filesystem>
#include <mutex>

#include "common/core/error.h"
#include "common/data/spec_io.h"
#include "common/io/file_safety.h"
#include "common/io/text_file.h"

namespace softgrain {

std::string ResultCache::name(const std::string& prefix, const std::string& key) {
  return prefix + "-" + short_hash(key);
}

bool ResultCache::find(const std::string& key, const std::function<void(const h5::Group&)>& read) const {
  const std::string path = directory_.empty() ? "" : file(key);
  if (path.empty() || !std::filesystem::exists(path)) return false;
  try {
    const std::lock_guard lock(h5::library_mutex());
    if (check_seal(path) != Seal::whole) throw IoError(path + ": damaged, or written by an earlier version");
    const h5::Group root = h5::open_file(path);
    require_format(root, format_.c_str(), path);
    if (root.text("key") != key) throw IoError(path + ": belongs to another result");
    read(root);
    return true;
  } catch (const IoError& e) {
    say_(std::string(e.what()) + "; " + again_);
    return false;
  }
}

void ResultCache::keep(const std::string& key, const std::function<void(const h5::Group&)>& write) const {
  if (directory_.empty()) return;
  // Other processes may keep the same result: each writes a file of its own, the last one to finish stays.
  const std::string own = file(key) + "." + std::to_string(::getpid());
  {
    const std::lock_guard lock(h5::library_mutex());
    h5::AtomicFile out(own, false, true);
    write_format(out.root(), format_.c_str());
    out.root().attribute("key", key);
    write(out.root());
    out.commit();
  }
  std::error_code error;
  std::filesystem::rename(own, file(key), error);
  if (error) throw IoError(file(key) + ": cannot be written: " + error.message());
}

KeyText& KeyText::add(const std::string& value) {
  // A key is kept as an attribute of a file, which has room for 64 kB: of lists and files their hash stands there.
  constexpr std::size_t kLongest = 400;
  const std::string shown = value.size() > kLongest ? "hash " + short_hash(value) : value;
  return append(fmt::format("{}:{}", value.size(), shown));
}

}  // namespace softgrain
