// What every command shares: options, run directory, log, summary.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/io/file_safety.h"
#include "common/io/progress.h"
#include "common/io/provenance.h"
#include "common/io/scene.h"
#include "common/state/checkpoint.h"

namespace spdlog {
class logger;
}

namespace softgrain {

/// Options of the command line that every command takes.
struct CommonOptions {
  std::vector<std::string> inputs;  ///< positional arguments
  std::string out;                  ///< --out DIR; empty: chosen from the scene's name under results/
  int threads = 0;                  ///< --threads N (>= 1); 0 = not given: all cores
  std::uint64_t seed = 0;           ///< --seed N
  bool seed_given = false;
  std::vector<std::string> overrides;              ///< --set key=value
  bool resume = false;                             ///< --resume
  bool quiet = false;                              ///< --quiet
  bool json = false;                               ///< --json
  double checkpoint_seconds = kCheckpointSeconds;  ///< --checkpoint-every S
  std::string law;                                 ///< --law law.toml (run, macrosim, sweep, check)
  std::int64_t bands = 0;                          ///< --bands N (the same); 0: not given
  std::string engine;                              ///< --engine softgrain or lammps (of runs); empty: not given
  std::int64_t ranks = 0;                          ///< --ranks N of --engine lammps; 0: not given
  bool write_only = false;                         ///< --write-only of --engine lammps
  std::string kind;                                ///< --kind of measurements in CSV (calibrate)
  std::string radius;                              ///< --radius "16 mm" of them
  std::string modulus;                             ///< --modulus "0.5 MPa" of them
  std::string law_cache;                           ///< --law-cache DIR; empty: nothing is kept between runs
  std::string packing_cache;                       ///< --packing-cache DIR; empty: nothing is kept between runs
  std::string twin_cache;                          ///< --twin-cache DIR; empty: nothing is kept between runs
  bool different = false;                          ///< --different (compare)
  std::vector<std::string> over;                   ///< swept keys, --over key=a,b,c (sweep)
  std::string sample;                              ///< --sample lhs:20, sobol:64 or saltelli:32 (sweep)
  std::int64_t jobs = 1;                           ///< --jobs N (sweep): runs at once
  std::string only;                                ///< --only NAME (sweep): this run of the set alone
  bool slurm = false;                              ///< --slurm (sweep): writes a job array and runs nothing
  std::string seeds;                               ///< --seeds 1..8 (run, microsim, macrosim, sweep); empty: one run
  /// One of several runs: its summary goes to its file alone, and where it has ended --resume says AlreadyFinished.
  bool member = false;
  std::string to;            ///< file format, --to vtp, lammps-dump, lammps-data or csv (export)
  std::string command_line;  ///< command line as given, for provenance
  std::string maximise;      ///< --maximise RESULT (sweep): a search for its largest value
  std::string minimise;      ///< --minimise RESULT (sweep)
  std::int64_t points = 0;   ///< --points N of a search; 0: not given
};

/// Thrown where a run that is one of several is found to have ended: its results are those that it would make again.
struct AlreadyFinished {};

/// A directory of another run than the one that --resume asks to go on with.
struct FingerprintMismatch : InputError {
  using InputError::InputError;
};

/// results/NAME, or results/NAME_run where results/NAME is a folder with a page that is kept (README.md): a run does
/// not write among kept results unless it is told to.
std::string default_directory(const std::string& name);

/// Whether the run in this directory began with the same content beside scene and seed (RunContext::begin); empty where
/// the directory does not say it.
std::optional<bool> began_with(const std::string& directory, const std::string& beside);

/// A run directory in use: made, proved writable and held against other runs, with a log file; writes the summary at
/// the end.
class RunContext {
 public:
  /// `command` names the sub-command, `default_name` the directory under results/ when --out is absent
  /// (default_directory). Unless the run goes on with an earlier one, the results of that are removed
  /// (remove_earlier_run); `read` are files that the run reads beside the inputs of the command line. Throws
  /// IoError: cannot be written, another run is at work there; InputError: what is there is not to be removed.
  RunContext(const CommonOptions& options, const std::string& command, const std::string& default_name,
             const std::vector<std::string>& read = {});

  /// Says what the run is of, once, before anything is written: scene, seed and what else determines it (`beside`, the
  /// text of a law file, say). A run that goes on must be the same one, whether it was interrupted or had ended. Throws
  /// FingerprintMismatch; AlreadyFinished (CommonOptions::member).
  void begin(const Scene& scene, std::uint64_t seed, const std::string& beside) const;

  /// A part of this run in a directory of its own below, with its own log and summary, which goes to the file alone.
  [[nodiscard]] RunContext part(const std::string& name) const;

  [[nodiscard]] const std::string& directory() const { return directory_; }
  [[nodiscard]] std::string path(const std::string& file) const { return directory_ + "/" + file; }
  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] bool quiet() const { return options_.quiet; }
  [[nodiscard]] bool resume() const { return options_.resume; }
  /// Wall time between two checkpoints of what lies between recorded points [s].
  [[nodiscard]] double checkpoint_seconds() const { return options_.checkpoint_seconds; }
  /// Directory where measurements are kept for other runs; empty: none.
  [[nodiscard]] const std::string& law_cache() const { return options_.law_cache; }
  /// Directory where prepared packings are kept for other runs; empty: none.
  [[nodiscard]] const std::string& packing_cache() const { return options_.packing_cache; }
  /// Directory where resolved twins are kept for other runs; empty: none.
  [[nodiscard]] const std::string& twin_cache() const { return options_.twin_cache; }
  /// Seed from --seed, else from the scene (`scene_seed`).
  [[nodiscard]] std::uint64_t seed(std::uint64_t scene_seed) const {
    return options_.seed_given ? options_.seed : scene_seed;
  }
  [[nodiscard]] Provenance provenance(const Scene& scene, std::uint64_t used_seed) const;

  /// A line for people: to log.txt always, to standard error unless --quiet. (log.txt also has the settings, beginning
  /// and end of every stage, what is printed at the end, and why a run ended early.)
  void say(const std::string& line) const;

  /// Writes DIR/summary.json (atomic; "status", "command", "version", "commit" added when absent), prints it on
  /// standard output with --json, else prints `people` (a few lines: what was found, how sure, where the files are) on
  /// standard output.
  void finish(nlohmann::json summary, const std::string& console) const;
  /// Writes and prints the summary as above, with "provenance" in it.
  void finish(nlohmann::json summary, const Provenance& provenance, const std::string& console) const;

  /// Runs `work`; when it ends with UnusableResult (a lost grain, a preparation that does not jam...) a summary that
  /// says so is written before the error goes on, so that the directory never looks like a run that is still going.
  void guard(const Provenance& provenance, const std::function<void()>& work) const;

 private:
  CommonOptions options_;
  std::string command_;
  std::string directory_;
  std::shared_ptr<DirectoryLock> lock_;
  int threads_ = 1;
  bool part_ = false;  ///< whether it is a part of another run
  bool shows_ = true;  ///< whether the summary goes to standard output; not for a part, nor for one of several runs
  std::shared_ptr<spdlog::logger> logger_;
  std::shared_ptr<LogScope> log_;  ///< DIR/log.txt, for all that is said while this run is at work
};

/// One function per command; returns the exit status, throws Error.
ExitStatus command_run(const CommonOptions& options);
ExitStatus command_microsim(const CommonOptions& options);
ExitStatus command_calibrate(const CommonOptions& options);
ExitStatus command_macrosim(const CommonOptions& options);
ExitStatus command_sweep(const CommonOptions& options);
ExitStatus command_compare(const CommonOptions& options);
ExitStatus command_report(const CommonOptions& options);
ExitStatus command_check(const CommonOptions& options);
ExitStatus command_export(const CommonOptions& options);

/// Parses the command line, dispatches, turns errors into messages and exit statuses.
int run_program(int argc, char** argv);

}  // namespace softgrain

// What runs leave in their directories, by name, so that a new run begins with none of it.

namespace softgrain {

/// Removes what an earlier run left in a directory, so that nothing there looks like a result of the new one: results
/// and checkpoints, by the names that runs give them, and never `inputs` of the new run (with law.h5 beside law.toml,
/// and its like). Throws InputError, and removes nothing, where that would cost what somebody may still want: the
/// directory was never one of a run (no log.txt of this program); `command` reads an input from there and would not
/// write anew what lies beside it; or it only compares.
void remove_earlier_run(const std::string& directory, const std::string& command,
                        const std::vector<std::string>& inputs);

}  // namespace softgrain
