#include "common/state/checkpoint.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "common/core/text.h"
#include "common/io/file_safety.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "softgrain checkpoint";
constexpr std::int64_t kCheckpointSchema = 2;

/// FNV-1a, 64 bits: tells scenes apart, protects nothing.
std::int64_t fingerprint(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return static_cast<std::int64_t>(hash);
}

/// A file of another schema is refused as such even when this program cannot tell whether it is whole.
void require_schema(const h5::Group& root, const std::string& path) {
  if (root.integer("schema") != kCheckpointSchema)
    throw InputError(path + ": checkpoint of schema " + std::to_string(root.integer("schema")) +
                     ", this program reads " + std::to_string(kCheckpointSchema) + "; run without --resume");
}

/// Opens a file that was read to its end already. Throws DamagedCheckpoint.
h5::Group open_whole(const std::string& path) {
  try {
    h5::Group root = h5::open_file(path);
    if (root.has_attribute("kind") && root.text("kind") == kKind) return root;
  } catch (const IoError& e) {
    throw DamagedCheckpoint(e.what());
  }
  throw DamagedCheckpoint(path + ": is not a checkpoint");
}

/// Opens a checkpoint of which every byte is as it was written. Throws IoError when the disk does not give them,
/// and DamagedCheckpoint when they are others.
h5::Group open_valid(const std::string& path) {
  const Seal seal = check_seal(path);
  if (seal == Seal::broken) throw DamagedCheckpoint(path + ": damaged, its checksum does not fit its content");
  h5::Group root = open_whole(path);
  require_schema(root, path);
  if (seal == Seal::none) throw DamagedCheckpoint(path + ": damaged or cut short, it ends without its checksum");
  return root;
}

void require_match(const h5::Group& root, const std::string& path, const std::string& scene_text) {
  if (root.integer("fingerprint") != fingerprint(scene_text))
    throw InputError(
        path +
        ": belongs to another scene (or other --set values, or another file that goes with the scene); run without "
        "--resume, or into another directory");
}

}  // namespace

void write_checkpoint(const std::string& path, const std::string& scene_text,
                      const std::function<void(const h5::Group&)>& content) {
  h5::AtomicFile file(path, true, true);
  {
    const h5::Group root = file.root();
    root.attribute("kind", kKind);
    root.attribute("schema", kCheckpointSchema);
    root.attribute("fingerprint", fingerprint(scene_text));
    content(root);
  }
  file.commit();
}

std::optional<h5::Group> open_checkpoint(const std::string& path, const std::string& scene_text, std::string& note) {
  std::string trouble;
  bool damaged = true;
  for (const std::string& candidate : std::array{path, path + ".previous"}) {
    std::error_code ignored;
    if (!fs::exists(candidate, ignored)) continue;
    try {
      h5::Group root = open_valid(candidate);
      require_match(root, candidate, scene_text);
      if (!trouble.empty()) note = trouble + "; continuing from the checkpoint before it, " + candidate;
      return root;
    } catch (const IoError& e) {
      damaged = damaged && dynamic_cast<const DamagedCheckpoint*>(&e) != nullptr;
      append_part(trouble, e.what());
    }
  }
  if (trouble.empty()) return std::nullopt;
  if (damaged) throw DamagedCheckpoint(trouble + "; no sound checkpoint is left");
  throw IoError(trouble + "; no checkpoint can be read");
}

void remove_checkpoint(const std::string& path) {
  std::error_code ignored;
  for (const char* ending : {"", ".previous", ".tmp"}) fs::remove(path + ending, ignored);
}

}  // namespace softgrain
