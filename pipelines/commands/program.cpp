// The command line: what there is to ask for, and how errors become messages and exit statuses.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <new>
#include <span>
#include <sstream>
#include <string_view>
#include <system_error>

#include "common/core/enum_names.h"
#include "common/core/text.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"
#include "pipelines/commands/complaints.h"
#include "pipelines/commands/law_options.h"
#include "pipelines/export/export.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

constexpr int kMostThreads = 4096;
constexpr std::int64_t kMostRanks = 1'000'000;
constexpr int kMostCompared = 100;
constexpr std::int64_t kMostSearchPoints = 1000;

struct Command {
  const char* name;
  const char* does;
  const char* inputs;  ///< name of the positional arguments in the help
  const char* inputs_help;
  int least;
  int most;
  bool saves;     ///< whether it saves at a signal what it has done; others end at once
  bool settings;  ///< whether --set and --seed mean anything
  bool writes;    ///< whether it writes where --out says
  ExitStatus (*function)(const CommonOptions&);
};

constexpr std::array<Command, 9> kCommands{{
    {"run",
     "One scene of any kind: a pipeline from packings to the resolved twin, a law table, a material, a macro scene ...",
     "SCENE.toml", "scene to run", 1, 1, true, true, true, command_run},
    {"microsim",
     "One particle-scale scene: soft particles packed and measured, particles and walls, a grain box, a cohesive "
     "powder",
     "SCENE.toml", "scene to run", 1, 1, true, true, true, command_microsim},
    {"calibrate", "Fits contact laws to measurements and writes the law card and its table", "DATA",
     "files of measurements: .h5 of this program, or .csv of an experiment", 1, 1000, false, true, true,
     command_calibrate},
    {"macrosim", "One macro scene with soft particles that act by a fitted law", "SCENE.toml", "scene to run", 1, 1,
     true, true, true, command_macrosim},
    {"sweep", "One scene over values of its keys and over seeds, each run in a directory of its own; a table and plots",
     "SCENE.toml", "scene to run", 1, 1, true, true, true, command_sweep},
    {"compare", "What differs between runs, their numbers, error norms and cost: A, B, ... against the last one", "RUN",
     "run directories or result files, the reference last; one: what a run holds within itself", 1, kMostCompared,
     false, false, true, command_compare},
    {"report", "Writes a self-contained report.html of a run directory", "DIR", "run directory", 1, 1, false, false,
     false, command_report},
    {"check", "Validates a scene, card, result or run directory and says what follows from it, without running", "FILE",
     "file or run directory to check", 1, 1, false, true, false, command_check},
    {"export", "Writes the states of a run for ParaView, OVITO, LAMMPS and others; default RUN/export-FORM", "RUN",
     "run directory, or one of its files with states", 1, 1, false, false, true, command_export},
}};

constexpr const char* kFooter =
    "Exit status: 0 good; 2 bad input; 3 ran but the result is not usable; 4 file or disk trouble; 130 interrupted.\n"
    "Numbers in files are SI, or text with a unit: radius = \"16 mm\".";

/// The command line as one text that a shell would read back.
std::string joined_command_line(int argc, char** argv) {
  return join_text(std::span(argv, static_cast<std::size_t>(argc)), " ",
                   [](const char* word) { return shell_word(word); });
}

CLI::Validator whole_number(const char* option, std::int64_t low, std::int64_t high) {
  return {[=](std::string& text) -> std::string {
            std::int64_t value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool number = error == std::errc{} && end == text.data() + text.size();
            if (number && value >= low && value <= high) return "";
            const std::string limit = high == std::numeric_limits<std::int64_t>::max()
                                          ? fmt::format("at least {}", low)
                                          : fmt::format("from {} to {}", low, high);
            return fmt::format("{} {}: must be a whole number, {}", option, text, limit);
          },
          "", "whole number"};
}

CLI::Validator name_of_result() {
  return {[](const std::string& text) -> std::string { return text.empty() ? "needs the name of a result" : ""; }, "",
          "name of a result"};
}

/// Options that are of use to some of the commands only: no other knows them, so that its help shows its own alone.
void add_options_of_runs(CLI::App& app, const Command& command, CommonOptions& o) {
  if (command.writes)
    app.add_option(
           "--out", o.out,
           "Run directory; default results/<name of the first input>, with _run behind where that holds kept results")
        ->option_text("DIR");
  if (command.settings) {
    app.add_option("--seed", o.seed, "Seed of the random numbers; default that of the scene")
        ->option_text("N")
        ->transform(whole_number("--seed", 0, std::numeric_limits<std::int64_t>::max()));
    app.add_option("--set", o.overrides, "Replaces a key of the scene: --set packing.beta=2.5 (repeatable)")
        ->option_text("KEY=VALUE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false);
  }
  if (!command.saves) return;
  app.add_flag("--resume", o.resume, "Continues from the checkpoint in the run directory");
  app.add_option("--checkpoint-every", o.checkpoint_seconds,
                 "Seconds between two checkpoints within a recorded point; default 5, 0: whenever possible")
      ->option_text("S")
      ->check(CLI::Range(0.0, 1e9).description(""));
}

void add_options(CLI::App& app, const Command& command, CommonOptions& o, std::string& observables) {
  app.add_option(command.inputs, o.inputs, command.inputs_help)->option_text(" ");
  app.add_option("--threads", o.threads, "Threads to use; default all cores. Results do not depend on it")
      ->option_text("N")
      ->transform(whole_number("--threads", 1, kMostThreads));
  add_options_of_runs(app, command, o);
  app.add_flag("--quiet", o.quiet, "No log and no progress on standard error");
  app.add_flag("--json", o.json, "Summary as one JSON object on standard output");
  const bool sweeps = command.function == command_sweep;
  const bool runs_scenes = sweeps || command.function == command_run || command.function == command_microsim ||
                           command.function == command_macrosim;
  if (sweeps) {
    app.add_option("--over", o.over,
                   "Runs the scene with each of these values of a key: --over macro.bodies=20,40 or =1..8 (repeatable: "
                   "every choice of all)")
        ->option_text("KEY=A,B,C")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false);
    app.add_option(
           "--sample", o.sample,
           "Runs N points of the ranges of keys, --over macro.wall_mu=0.1..0.8 or =1e6..1e8:log: lhs:N, sobol:N, "
           "or saltelli:N, N (keys + 2) runs for Sobol indices")
        ->option_text("FORM:N");
    app.add_option(
           "--maximise", o.maximise,
           "Searches the ranges of one or two keys, --over KEY=LOW..HIGH, for the largest value of this result: "
           "--maximise \"solid fraction\"")
        ->option_text("RESULT")
        ->check(name_of_result());
    app.add_option("--minimise", o.minimise, "The same for the smallest value")
        ->option_text("RESULT")
        ->check(name_of_result());
    app.add_option("--points", o.points, "Points of a search; default 9, with two keys 18")
        ->option_text("N")
        ->transform(whole_number("--points", 1, kMostSearchPoints));
    app.add_option("--jobs", o.jobs, "Runs so many members of the set at once, each with its share of the threads")
        ->option_text("N")
        ->transform(whole_number("--jobs", 1, kMostThreads));
    app.add_option("--only", o.only,
                   "Runs only this member of the set, by the name of its directory; --resume without "
                   "it collects")
        ->option_text("NAME");
    app.add_flag("--slurm", o.slurm, "Writes a job array for sbatch, one task for each run, and stops");
  }
  if (runs_scenes)
    app.add_option("--seeds", o.seeds,
                   "Runs the scene once with each of these seeds, in directories below DIR, and says mean, spread and "
                   "standard error")
        ->option_text("1..8");
  if (sweeps || command.function == command_run)
    app.add_option(
           "--law-cache", o.law_cache,
           "Keeps finished measurements of law tables and tests of materials here and takes from here what is known "
           "already")
        ->option_text("DIR");
  if (runs_scenes && command.function != command_microsim) {
    app.add_option("--packing-cache", o.packing_cache,
                   "Keeps prepared packings of macro scenes here and takes from here what is known already")
        ->option_text("DIR");
    app.add_option(
           "--twin-cache", o.twin_cache,
           "Keeps resolved twins of macro scenes here, whatever law they stand beside, and takes from here what "
           "is known already")
        ->option_text("DIR");
  }
  if (command.function == command_compare)
    app.add_flag("--different", o.different,
                 "Error norms also of runs that differ in bodies, materials, tests or packings");
  if (command.function == command_export)
    app.add_option("--to", o.to, "Form of the files: " + join_text(all_enum_names<ExportFormat>()))
        ->option_text("FORM");
  if (command.function == command_run || command.function == command_microsim || command.function == command_macrosim)
    app.add_option("--observables", observables,
                   "Writes what was observed to PREFIX_sim.txt and the numbers set by --set to PREFIX_param.txt, as "
                   "GrainLearning reads them; run directory PREFIX_run unless --out is given")
        ->option_text("PREFIX");
  if (command.function == command_calibrate) {
    app.add_option("--kind", o.kind, "CSV: which contact was measured, soft-solid or soft-soft")->option_text("KIND");
    app.add_option("--radius", o.radius, "CSV: radius Rs of the soft particle, e.g. \"16 mm\"")->option_text("LENGTH");
    app.add_option("--modulus", o.modulus, "CSV: Young's modulus E of its grains, e.g. \"0.5 MPa\"")
        ->option_text("PRESSURE");
  }
  if (runs_scenes && command.function != command_microsim) {
    app.add_option("--engine", o.engine,
                   "What runs a material, or a macro scene with its law: softgrain (default) or lammps")
        ->option_text("NAME");
    app.add_option("--ranks", o.ranks, "With --engine lammps: MPI ranks; default 1")
        ->option_text("N")
        ->transform(whole_number("--ranks", 1, kMostRanks));
    if (!sweeps) app.add_flag("--write-only", o.write_only, "With --engine lammps: writes its input files and stops");
  }
  if ((runs_scenes && command.function != command_microsim) || command.function == command_check) {
    app.add_option("--bands", o.bands,
                   "Macro scenes: error bars from so many draws of the law; default as the scene says (none)")
        ->option_text("N")
        ->check(CLI::Range(8, 100000).description(""));
    app.add_option(
           "--law", o.law,
           "Macro scenes: law card, law table or press test (.csv) of the soft particles; default as the scene says")
        ->option_text("LAW");
  }
}

/// Counted here and not by the parser, so that an unknown option is named before what follows it.
void require_inputs(const Command& command, const CommonOptions& options) {
  const auto given = static_cast<int>(options.inputs.size());
  if (given >= command.least && given <= command.most) return;
  const auto cut = [](const std::string& s) { return s.find('=') == std::string::npos || s.ends_with('='); };
  if (const auto found = std::ranges::find_if(options.overrides, cut);
      given > command.most && found != options.overrides.end())
    throw InputError(fmt::format("--set {}: must be of the form key=value, without blanks beside '='", *found));
  const std::string wanted = command.least == command.most ? fmt::format("{}", command.least)
                             : given < command.least       ? fmt::format("at least {}", command.least)
                                                           : fmt::format("at most {}", command.most);
  throw InputError(fmt::format("{} needs {} {}, {} given (see softgrain {} --help)", command.name, wanted,
                               command.inputs, given, command.name));
}

/// A first word that is no command: names the nearest.
void require_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::vector<std::string> names = command_names(app);
  const std::string word = argv[1];
  if (std::ranges::find(names, word) != names.end()) return;
  throw InputError(unknown_command_text(word, nearest_text(word, names), names));
}

/// A run that is refused leaves no directory behind, nor does one whose scene is not there.
ExitStatus run_or_leave_nothing(const Command& command, const CommonOptions& options, const FreshDirectory& out) {
  try {
    return command.function(options);
  } catch (const InputError&) {
    out.remove_if_empty();
    throw;
  } catch (const IoError&) {
    out.remove_if_empty();
    throw;
  }
}

/// What an earlier run observed goes where this one ends without a result, unless it was refused.
ExitStatus run_observed(const Command& command, const CommonOptions& options, const FreshDirectory& out,
                        const std::string& observables) {
  ExitStatus status = ExitStatus::good;
  try {
    status = run_or_leave_nothing(command, options, out);
  } catch (const InputError&) {
    throw;
  } catch (const Error&) {
    forget_observables(observables);
    throw;
  }
  forget_observables(observables);
  write_observables(options.out, options.overrides, observables);
  return status;
}

/// Parses and runs. CLI::ParseError (help, version, mistakes) and Error go up.
ExitStatus parse_and_run(CLI::App& app, int argc, char** argv) {
  CommonOptions options;
  options.command_line = joined_command_line(argc, argv);
  std::string observables;
  const Command* chosen = nullptr;
  for (const Command& command : kCommands) {
    CLI::App* sub = app.add_subcommand(command.name, command.does);
    sub->footer(kFooter);
    add_options(*sub, command, options, observables);
    sub->callback([&chosen, &command] { chosen = &command; });
    if (command.settings)
      sub->parse_complete_callback([&options, sub] { options.seed_given = sub->count("--seed") > 0; });
  }
  LawOptions law;
  add_law_command(app, law);
  SchemaOptions schema;
  add_schema_command(app, schema);
  NewOptions fresh;
  add_new_command(app, fresh);
  ExampleOptions examples;
  add_examples_command(app, examples);
  bool version = false;
  add_help_commands(app, version);
  // One command at most: a scene or a kind may have the name of another.
  app.require_subcommand(0, 1);
  require_command(app, argc, argv);
  app.parse(argc, argv);
  // The parser takes an option that follows one with a value for the value of it.
  if (const std::string missing = missing_value_text(app); !missing.empty())
    throw InputError(missing + " (see softgrain " + command_on_line(app) + "--help)");
  // A file that may not grow beyond a limit is trouble with a file, to be told as such, not a reason to be killed.
  std::signal(SIGXFSZ, SIG_IGN);
  end_at_once_on_signals();
  law.command_line = options.command_line;
  if (law.action) return command_law(law);
  if (schema.chosen) return command_schema(schema);
  if (fresh.chosen) return command_new(fresh);
  if (examples.chosen) return command_examples(examples);
  if (version) {
    write_standard_output(version_text() + "\n");
    return ExitStatus::good;
  }
  if (chosen == nullptr) {
    std::fputs(app.help().c_str(), stderr);
    return ExitStatus::bad_input;
  }
  require_inputs(*chosen, options);
  if (!observables.empty()) {
    require_observables(options.inputs.front(), options.overrides);
    if (options.write_only) throw InputError("--observables: nothing is observed with --write-only");
    if (options.out.empty()) options.out = observables + "_run";
  }
  const FreshDirectory out(options.out);
  if (!options.out.empty()) require_writable_directory(options.out);
  for (const std::string& cache : {options.law_cache, options.packing_cache, options.twin_cache})
    if (!cache.empty()) require_writable_directory(cache);
  if (!observables.empty() && !options.seeds.empty())
    throw InputError("--observables: goes with one run, not with --seeds");
  if (chosen->saves) install_interrupt_handler();
  return observables.empty() ? run_or_leave_nothing(*chosen, options, out)
                             : run_observed(*chosen, options, out, observables);
}

/// Help and version go to standard output with status 0, mistakes to standard error with status 2.
int end_of_parsing(const CLI::App& app, const CLI::ParseError& e, bool as_json) {
  if (e.get_exit_code() == 0) {
    std::ostringstream text;
    (void)app.exit(e, text, text);
    write_standard_output(text.str());
    return static_cast<int>(ExitStatus::good);
  }
  const std::string command = command_on_line(app);
  std::string message = e.what();
  if (const std::string missing = missing_value_text(app, message); !missing.empty()) message = missing;
  if (const std::string unknown = unknown_word_text(app); !unknown.empty()) message = unknown;
  constexpr std::string_view kNoConversion = "Could not convert: ";  // of CLI11, of a number: "--delta = 0,1"
  if (message.starts_with(kNoConversion))
    message = message.substr(kNoConversion.size()) + ": not a value that this option takes";
  // CLI11 puts "--threads: " before the message of a validator, which names the option itself.
  if (const std::size_t colon = message.find(": ");
      message.starts_with("--") && colon != std::string::npos &&
      message.substr(colon + 2).starts_with(message.substr(0, colon) + " "))
    message.erase(0, colon + 2);
  return complain(ExitStatus::bad_input, message + " (see softgrain " + command + "--help)", as_json);
}

/// Known before anything is parsed: mistakes in the command line are told in the same form.
bool wants_json(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](const char* word) { return std::string(word) == "--json"; });
}

int parse_and_run_or_explain(CLI::App& app, int argc, char** argv) {
  try {
    return static_cast<int>(parse_and_run(app, argc, argv));
  } catch (const CLI::ParseError& e) {
    return end_of_parsing(app, e, wants_json(argc, argv));
  }
}

/// A standard stream that came closed stays unusable: its number must not go to the next file that is opened, which
/// would then receive what is meant for people.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// "run.h5: Is a directory": the system's reason after the files, as in all other messages.
std::string text_of(const std::filesystem::filesystem_error& e) {
  std::string files = e.path1().string();
  if (!e.path2().empty()) files += " to " + e.path2().string();
  return files.empty() ? e.what() : files + ": " + e.code().message();
}

/// Everything from the command line to the exit status.
int run_words(int argc, char** argv) {
  CLI::App app{"softgrain: contact laws of soft particles for extremely polydisperse packings", "softgrain"};
  app.set_version_flag("--version", version_text());
  app.footer(kFooter);
  const bool as_json = wants_json(argc, argv);
  try {
    return parse_and_run_or_explain(app, argc, argv);
  } catch (const Error& e) {
    return complain(e.status(), with_missing_files_explained(e.what(), {argv, argv + argc}), as_json);
  } catch (const std::bad_alloc&) {
    return complain(ExitStatus::not_usable, "not enough memory", as_json);
  } catch (const std::filesystem::filesystem_error& e) {
    return complain(ExitStatus::file_trouble, text_of(e), as_json);
  } catch (const std::system_error& e) {  // of streams
    return complain(ExitStatus::file_trouble, e.what(), as_json);
  } catch (const std::exception& e) {
    return complain(ExitStatus::not_usable, std::string("unexpected: ") + e.what(), as_json);
  }
}

}  // namespace

int run_program(int argc, char** argv) {
  occupy_closed_streams();
  std::vector<std::string> words = without_help_command({argv, argv + argc});
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return run_words(static_cast<int>(words.size()), pointers.data());
}

}  // namespace softgrain
