// Command line of softgrain law: show, eval, export, plan, library and get.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/data/multi_contact_law.h"
#include "microsim/multi_contact_arrangements.h"

namespace CLI {
class App;
}

namespace softgrain {

enum class LawAction { none, show, eval, export_law, plan, library, get };

template <>
inline constexpr auto enum_names<LawAction> = enum_name_list<LawAction>({{LawAction::none, "none"},
                                                                         {LawAction::show, "show"},
                                                                         {LawAction::eval, "eval"},
                                                                         {LawAction::export_law, "export"},
                                                                         {LawAction::plan, "plan"},
                                                                         {LawAction::library, "library"},
                                                                         {LawAction::get, "get"}});

enum class LawFormat { lammps_table, csv, json };

template <>
inline constexpr auto enum_names<LawFormat> = enum_name_list<LawFormat>({{LawFormat::lammps_table, "lammps-table"},
                                                                         {LawFormat::csv, "csv"},
                                                                         {LawFormat::json, "json"}});

struct LawOptions {
  std::optional<LawAction> action;  ///< empty: another command; none: no action is given
  std::vector<std::string> files;   ///< card or table, or a run directory; show: one or two
  bool json = false;

  std::vector<double> deltas;  ///< --delta
  double from = 0.0;
  double to_delta = -1.0;  ///< end of the range of overlaps, --to of eval; negative: the end of the law's range
  std::int64_t steps = 11;
  double deepest = -1.0;        ///< --deepest: overlap from which a contact of a card unloads; negative: it is loaded
  std::vector<PairKind> kinds;  ///< --kind
  TangentialSlope tangential = TangentialSlope::initial;
  std::optional<Extrapolation> beyond;  ///< empty: what the law says
  std::string modulus;                  ///< --E, with or without unit; with --radius: SI units
  std::string radius;

  WantedForm form;
  Arrangement arrangement = Arrangement::one;
  PartnerKind partner = PartnerKind::plane;
  double ratio = 1.0;
  double shallow = 0.5;
  double solid_fraction = -1.0;  ///< negative: the main entry
  RangePolicy range = RangePolicy::reject;

  std::optional<LawFormat> format;  ///< file format, --to of export
  std::string out;                  ///< --out FILE; empty: standard output
  std::vector<double> ratios{1.0};
  std::int64_t rows = 1001;
  double delta_max = -1.0;  ///< negative: the end of the range

  std::string target;         ///< scene of plan, --for: macro scene, or a run of one
  std::string measure;        ///< --measure: law-table scene with the configurations that could be measured
  std::int64_t packings = 8;  ///< --packings: added at a time
  double narrow = 0.5;        ///< --narrow: wanted width over what it is
  bool as_scene = false;      ///< --toml of plan: as tables of a law-table scene

  std::int64_t next = 0;       ///< --next of library: materials that would narrow its answers most; 0: none are said
  std::string library;         ///< --library of get: the library; empty: that of the program
  double friction = -1.0;      ///< --mu of get
  double exponent = -1.0;      ///< --exponent of get
  double poisson_ratio = 0.3;  ///< --nu of get
  std::string own;             ///< --own of get: a measured table, by which the answer is corrected
  std::string press_test;      ///< --press-test of get: what the law of all neighbours is concluded from
  std::int64_t draws = 64;     ///< --draws of get
  std::string command_line{};  ///< command line as given, for provenance

  std::vector<std::string> given;  ///< names of the options on the command line, for those that do not go together
};

/// Adds `law` with its sub-commands to the program's command line.
void add_law_command(CLI::App& app, LawOptions& options);

/// What to measure next, see pipelines/kinds/law_table/law_plan.h. Throws Error.
ExitStatus plan_next(const LawOptions& options);

/// Collects the law tables below directories in a library, and says how well it predicts each material. Throws Error.
ExitStatus make_library(const LawOptions& options);

/// The law table of a material from a library. Throws Error.
ExitStatus get_law(const LawOptions& options);

/// Does what was asked. Throws Error.
ExitStatus command_law(const LawOptions& options);

}  // namespace softgrain
