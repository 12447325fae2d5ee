// Command line of softgrain law: show, eval and export.
#pragma once

#include <string>
#include <vector>

#include "common/core/error.h"

namespace CLI {
class App;
}

namespace softgrain {

struct LawOptions {
  std::string action;              ///< "show", "eval" or "export"; empty: another command
  std::vector<std::string> files;  ///< card or table, or a run directory; show: one or two
  bool json = false;

  std::vector<double> deltas;  ///< --delta
  double from = 0.0;
  double to_delta = -1.0;  ///< --to of eval, negative: the end of the range
  std::int64_t steps = 11;
  std::vector<std::string> kinds;  ///< --kind
  std::string tangential = "initial";
  std::string beyond;   ///< empty: what the law says
  std::string modulus;  ///< --E, with or without unit; with --radius: SI units
  std::string radius;

  std::string form;
  std::string arrangement = "one";
  std::string partner = "plane";
  double ratio = 1.0;
  double shallow = 0.5;
  double solid_fraction = -1.0;  ///< negative: the main entry
  std::string range = "reject";

  std::string format;  ///< --to of export
  std::string out;     ///< --out FILE; empty: standard output
  std::vector<double> ratios{1.0};
  std::int64_t rows = 1001;
  double delta_max = -1.0;  ///< negative: the end of the range

  std::vector<std::string> given;  ///< names of the options on the command line, for those that do not go together
};

/// Adds `law` with its sub-commands to the program's command line.
void add_law_command(CLI::App& app, LawOptions& options);

/// Does what was asked. Throws Error.
ExitStatus command_law(const LawOptions& options);

}  // namespace softgrain
