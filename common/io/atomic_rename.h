// The last step of every atomic write: a complete temporary file takes the name of the result.
#pragma once

#include <string>

namespace softgrain {

/// Name of the temporary file behind `path`; in the same directory, so that renaming is atomic.
inline std::string temporary_name(const std::string& path) { return path + ".tmp"; }

/// Flushes `temporary_name(path)` to disk and renames it to `path`; at no moment is there no file under `path` once
/// there was one. With `keep_previous` the old file stays as `path + ".previous"`. Throws IoError.
void rename_into_place(const std::string& path, bool keep_previous = false);

/// "disk full" and the like, for messages: the text of the current errno.
std::string system_message();

}  // namespace softgrain
