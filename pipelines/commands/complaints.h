// How a command that ends with an error says so: to people and to programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/core/error.h"

namespace softgrain {

/// One object per line of `messages`: {"message": ...}, with "file" and "line" where it begins with them, "setting"
/// where the value came from --set, and "key", "value", "table", "allowed" and "nearest" as far as the message says
/// them.
nlohmann::json error_objects(const std::string& messages);

/// One line per mistake on standard error, "softgrain: ..."; with `as_json` one object on standard output as well:
/// {"status": "bad input", "exit_status": 2, "errors": error_objects()}. `messages`: one per line. Returns the exit
/// status.
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
