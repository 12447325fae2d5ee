// Whole small text files, written atomically.
#pragma once

#include <string>
#include <string_view>

namespace softgrain {

/// Without the blanks at both ends.
std::string trimmed(const std::string& text);

/// Writes to `path + ".tmp"`, flushes to disk and renames. Throws FileTrouble.
void write_text_atomic(const std::string& path, const std::string& text);

/// Writes to standard output and flushes it. Throws FileTrouble: what nobody could read has not been said; and
/// Interrupted when a signal comes while it waits for somebody to read.
void write_standard_output(std::string_view text);

/// Reads a whole file. Throws FileTrouble naming the path.
std::string read_text(const std::string& path);

/// Proves that `path` is a file that can be read, before a library is asked to open it: no directory, pipe or device
/// (which would keep the program waiting for ever), and its first byte comes. Throws FileTrouble naming the path.
void require_readable_file(const std::string& path);

/// Creates the directory (and parents) and proves that a file can be written there. Throws FileTrouble.
void require_writable_directory(const std::string& path);

}  // namespace softgrain
