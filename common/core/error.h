// Errors of the project, one class per exit status. Libraries throw them; only the program prints and exits.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <stdexcept>
#include <string>

namespace softgrain {

/// Exit statuses of the command line.
enum class ExitStatus : int {
  good = 0,
  bad_input = 2,     ///< scene, card or option is wrong; nothing was run
  not_usable = 3,    ///< ran, but the result must not be used as it is
  file_trouble = 4,  ///< disk, permissions, missing or damaged file
  interrupted = 130  ///< stopped by a signal, checkpoint written
};

/// Base of all errors that end a command with a stated exit status.
class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  [[nodiscard]] ExitStatus status() const { return status_; }

 private:
  ExitStatus status_;
};

/// Wrong value in a scene, card or option. The message says where, what, and the allowed range.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message) : Error(ExitStatus::bad_input, message) {}
};

/// Values of a scene that do not go together, found only while it runs, where its file is not known. The program puts
/// the file before the message.
class UnfitScene : public InputError {
 public:
  using InputError::InputError;
};

/// The run came to an end without a usable result (diverged, lost grain, not converged...).
class UnusableResult : public Error {
 public:
  explicit UnusableResult(const std::string& message) : Error(ExitStatus::not_usable, message) {}
};

/// A file could not be read or written, or its content is damaged.
class IoError : public Error {
 public:
  explicit IoError(const std::string& message) : Error(ExitStatus::file_trouble, message) {}
};

/// A signal asked the run to stop; everything computed so far has been saved.
class Interrupted : public Error {
 public:
  explicit Interrupted(const std::string& message) : Error(ExitStatus::interrupted, message) {}
};

}  // namespace softgrain
