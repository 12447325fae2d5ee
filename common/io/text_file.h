// Whole small text files, written atomically.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/enum_names.h"

namespace softgrain {

/// The text without the blanks at both ends.
std::string trimmed(const std::string& text);

/// Forms of files by their endings.
enum class FileForm { hdf5, json, toml, csv, tsv, txt, dat };

template <>
inline constexpr auto enum_names<FileForm> = enum_name_list<FileForm>({{FileForm::hdf5, ".h5"},
                                                                       {FileForm::json, ".json"},
                                                                       {FileForm::toml, ".toml"},
                                                                       {FileForm::csv, ".csv"},
                                                                       {FileForm::tsv, ".tsv"},
                                                                       {FileForm::txt, ".txt"},
                                                                       {FileForm::dat, ".dat"}});

/// Form of a file by the ending of its name; empty for any other ending.
inline std::optional<FileForm> file_form(const std::string& path) {
  return parse_enum<FileForm>(std::filesystem::path(path).extension().string());
}

/// Throws IoError, which names the folder, where that of a file to be written is not there.
void require_folder_of(const std::string& path);

/// Writes to `path + ".tmp"`, flushes to disk and renames. Throws IoError.
void write_text_atomic(const std::string& path, const std::string& text);

/// Writes to standard output and flushes it. Throws IoError: what nobody could read has not been said; and
/// Interrupted when a signal comes while it waits for somebody to read.
void write_standard_output(std::string_view text);

/// Reads a whole file. Throws IoError naming the path.
std::string read_text(const std::string& path);

/// Proves that `path` is a file that can be read, before a library is asked to open it: no directory, pipe or device
/// (which would keep the program waiting for ever), and its first byte comes. Throws IoError naming the path.
void require_readable_file(const std::string& path);

/// Throws IoError where a pipe stands in place of a file that is to be written: opening it would wait for a reader.
void require_no_pipe(const std::string& path);

/// Creates the directory (and parents) and proves that a file can be written there. Throws IoError.
void require_writable_directory(const std::string& path);

/// 64-bit FNV-1a as 16 hexadecimal digits: the same on every machine. Not for security.
std::string short_hash(const std::string& text);

// What bytes of a text file mean: spreadsheets and instruments write more than UTF-8.

/// Whether all bytes are UTF-8.
bool is_utf8(const std::string& bytes);

/// The text as UTF-8, without byte order mark: UTF-16 of both byte orders is recognised by its mark or by its zero
/// bytes; what is no UTF-8 counts as Windows-1252.
std::string utf8_of(const std::string& bytes);

/// The text with every byte that is no UTF-8 replaced by U+FFFD, for files that must be UTF-8.
std::string replaced_utf8(const std::string& text);

}  // namespace softgrain
