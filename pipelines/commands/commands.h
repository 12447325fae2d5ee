// What the files of this folder have from each other, beside the commands of run_context.h: parts of calibrate, check
// and run, schema, new and examples, and what commands say of each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/error.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/run_context.h"

namespace CLI {
class App;
}

namespace softgrain {

// softgrain calibrate DATA.csv...: the law of a contact from force-displacement measurements of an experiment.

/// Whether the inputs are tables in text (.csv, .tsv, .txt, .dat). Throws InputError when only some are, or when an
/// option for such tables stands beside other files.
bool are_curve_files(const CommonOptions& options);

/// Throws InputError where a file of these names that calibrate is about to write in its directory is one of its
/// inputs: before the directory is touched.
void require_inputs_stay(const CommonOptions& options, const std::vector<std::string>& written);

/// Name of the run directory of calibrate under results/, that of its first input; and the directory that it will be.
std::string calibrate_name(const CommonOptions& options);
std::string calibrate_directory(const CommonOptions& options);

/// Fits, writes law.toml, law.h5, summary.json and the report.
ExitStatus calibrate_curves(const CommonOptions& options);

// softgrain calibrate with multi-contact measurements: several neighbours at once.

/// Whether all of these files hold multi-contact measurements; false when none does. Throws InputError for a mixture,
/// IoError.
bool are_multi_contact_files(const std::vector<std::string>& files);

/// Fits one entry per file and writes law_table.toml, law_table.h5, multi_contact.h5 (that of the first file, for the
/// report), summary.json and the report. Settings through --set: `discrepancy`, `replicates`, `min_packings`, `target`.
/// Status not_usable when a recorded point did not converge or a best law is not good. Throws InputError (settings, two
/// files of one solid fraction), UnusableResult (no force anywhere), IoError.
ExitStatus calibrate_multi_contact(const CommonOptions& options);

// softgrain check of tables that people bring: measurements of an experiment, sieve curves, radii.

// What check says of tables that are no scenes.
inline constexpr const char* kNoScene = "data, no scene: ";
inline constexpr const char* kTakenBySizes = "the key `file` of a table `sizes` of a scene takes it";

/// Says which data a text of columns holds, how many, and what takes them; `overrides` are keys that go with the file
/// of a sieve curve. Throws InputError where it holds none of these or they are not sound, IoError.
void check_table(const std::string& path, const std::vector<std::string>& overrides, Findings& out);

/// What was read of a sieve analysis: columns, diameters, Fuller's exponent, the curve, and which scenes serve it.
void check_sieves(const std::string& path, const std::vector<std::string>& overrides, Findings& out);

// softgrain check of results: files of ours, summaries, run directories.

/// An HDF5 file of any kind of ours: read as the commands would read it. Throws IoError when it is damaged.
void check_data(const std::string& path, Findings& out);

/// summary.json of a run: status, command, remarks. Throws InputError when it is none.
void check_summary(const std::string& path, Findings& out);

/// A run directory: its summary and every file of ours in it. Throws IoError when one of them is damaged, InputError
/// when there is none.
void check_directory(const std::string& path, Findings& out);

// Observables and parameters of a run as two small text files, in the form that GrainLearning (and other calibration
// tools) read: a header line "# name name ..." and columns of numbers.

/// Throws InputError unless the scene is of a kind that has observables: pipeline, soft-particle, macro. Before any
/// work.
void require_observables(const std::string& scene, const std::vector<std::string>& overrides);

/// Removes what an earlier run observed under this prefix.
void forget_observables(const std::string& prefix);

/// Writes PREFIX_sim.txt and PREFIX_param.txt.
///   A run with a macro part: strain, stress [Pa], lateral_stress [Pa], coordination, means over samples of the law's
///   curves. Other runs: Delta, Fn [N], Fn_error [N] (standard error over packings); of soft-solid contacts where they
///   were measured, and those of soft-soft contacts as Fn_soft_soft beside it where the overlaps are the same.
///   The parameters are the overrides "key=value" that are plain numbers, named by the last part of their key (the
///   whole key when two would share it).
/// Throws InputError, IoError.
void write_observables(const std::string& directory, const std::vector<std::string>& overrides,
                       const std::string& prefix);

// softgrain schema: which keys a kind of scenes has, for people, for the guide and for editors.

enum class SchemaForm { text, markdown, json };

template <>
inline constexpr auto enum_names<SchemaForm> = enum_name_list<SchemaForm>({{SchemaForm::text, "text"},
                                                                           {SchemaForm::markdown, "markdown"},
                                                                           {SchemaForm::json, "json"}});

struct SchemaOptions {
  bool chosen = false;
  std::string kind{};   ///< empty: the list of kinds
  std::string table{};  ///< "macro", "loading.stage", "." for the root; empty: the root and which tables there are
  SchemaForm form = SchemaForm::text;
  bool summary = false;  ///< members of summary.json, not keys of scenes
};

/// Adds `schema` to the program's command line.
void add_schema_command(CLI::App& app, SchemaOptions& options);

/// Prints what was asked for. Throws InputError.
ExitStatus command_schema(const SchemaOptions& options);

// softgrain new: a scene to begin with.

struct NewOptions {
  bool chosen = false;
  std::string kind{};  ///< empty: the list of kinds
  std::string out{};   ///< empty: standard output
  bool all = false;    ///< also the keys of tables that the scene does without
};

/// Adds `new` to the program's command line.
void add_new_command(CLI::App& app, NewOptions& options);

/// Writes the small scene of a kind (SceneKind::starter), with what every key means and the other keys as comments.
/// Throws InputError (no such kind, the file is there), IoError.
ExitStatus command_new(const NewOptions& options);

// softgrain examples: the scenes that come with the program.

struct ExampleOptions {
  bool chosen = false;
  std::string name{};  ///< of the file, without .toml; empty: the list
  std::string out{};   ///< empty: standard output
  bool json = false;
};

/// Adds `examples` to the program's command line.
void add_examples_command(CLI::App& app, ExampleOptions& options);

/// Lists them, or writes one, which finds the files that it names from anywhere. Throws InputError (no such scene, the
/// file is there), IoError (no scenes are installed).
ExitStatus command_examples(const ExampleOptions& options);

/// Folder of the scenes that come with the program: pipelines/ of the source tree that the program was built in, or
/// share/softgrain/pipelines of the prefix where it is installed; empty when neither is there.
std::string shipped_scenes();

/// Messages with more about files that are not there ("PATH: no such file"): the one of the program whose path ends so,
/// and, unless the path is one of the `words` of the command line, that scenes name files relative to their folders.
std::string with_missing_files_explained(const std::string& messages, const std::vector<std::string>& words);

/// The text of a scene, with every file that it names relative to `folder` named by its full path; names of what is no
/// file there stay.
std::string with_full_paths(const std::string& scene, const std::string& folder);

/// Throws InputError, which ends with `advice`, where a file that would be written is there already.
void refuse_to_overwrite(const std::string& path, const std::string& advice = "choose another name");

/// Writes `text` to a file that is not there yet and says `told` on standard output; to standard output where `path` is
/// empty. Throws InputError when it is there, IoError.
void write_new_text(const std::string& path, const std::string& text, const std::string& told);

// Words of the command line that are about commands: softgrain help and version, words that no command knows.

/// "softgrain 0.2.0 (1a2b3c4)".
std::string version_text();

/// Adds `help` and `version` to the program's command line; `version` becomes true where it is asked for.
void add_help_commands(CLI::App& app, bool& version);

/// The command line with `help COMMAND` replaced by `COMMAND --help`.
std::vector<std::string> without_help_command(std::vector<std::string> words);

/// Names of all commands.
std::vector<std::string> command_names(const CLI::App& app);

/// "run ", "law show ": the command that was given, as far as it is known; empty for none.
std::string command_on_line(const CLI::App& app);

/// What to say of an unknown command; `hint` names the nearest one, or is empty.
std::string unknown_command_text(const std::string& given, const std::string& hint,
                                 const std::vector<std::string>& known);

/// What to say of an option that nothing, or another option, follows: what it takes, as its help says. `message`: of
/// the parser, where it complained. Empty where no value is missing.
std::string missing_value_text(const CLI::App& program, const std::string& message = "");

/// What to say of an option (or the name of a part of a command) that was given and is unknown: the nearest one of the
/// command, or which commands know it. Empty when there was none.
std::string unknown_word_text(const CLI::App& app);

}  // namespace softgrain
