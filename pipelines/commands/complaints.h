// How a command that ends with an error says so: to people and to programs.
#pragma once

#include <string>

#include "common/core/error.h"

namespace softgrain {

/// One line per mistake on standard error, "softgrain: ..."; with `as_json` one object on standard output as well:
/// {"status": "bad input", "exit_status": 2, "errors": [{"message": ..., "file": ..., "line": ...}]}, file and line
/// where the message begins with them. `messages`: one per line. Returns the exit status.
int complain(ExitStatus status, const std::string& messages, bool as_json);

/// Removes what was made for a command that was refused: a directory that is empty, and parents that were made with it.
class FreshDirectory {
 public:
  /// Notes what of `path` is not there yet; nothing for an empty path.
  explicit FreshDirectory(std::string path);
  void remove_if_empty() const;

 private:
  std::string path_;
  int made_ = 0;  ///< how many of its last parts were missing
};

}  // namespace softgrain
