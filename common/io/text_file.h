// Whole small text files, written atomically.
#pragma once

#include <string>

namespace softgrain {

/// Writes to `path + ".tmp"`, flushes to disk and renames. Throws FileTrouble.
void write_text_atomic(const std::string& path, const std::string& text);

/// Reads a whole file. Throws FileTrouble naming the path.
std::string read_text(const std::string& path);

/// Creates the directory (and parents) and proves that a file can be written there. Throws FileTrouble.
void require_writable_directory(const std::string& path);

}  // namespace softgrain
