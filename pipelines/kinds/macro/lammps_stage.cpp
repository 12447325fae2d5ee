#include "pipelines/kinds/macro/lammps_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/contact/law_set.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/dynamics/force_pass.h"
#include "common/io/child_process.h"
#include "common/io/progress.h"
#include "common/io/text_file.h"
#include "macrosim/compression.h"
#include "macrosim/curve_notes.h"
#include "macrosim/lammps_run/data_file.h"
#include "macrosim/lammps_run/dump_files.h"
#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/lammps_curve.h"
#include "macrosim/lammps_run/lammps_program.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/preparation.h"
#include "macrosim/staged_test.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

/// Materials of make_law_system().
std::vector<LawFileEntry> laws_of(const MacroSpec& spec, const SoftLaws& soft, bool any_soft) {
  const MacroSystem empty = make_law_system(spec, {}, soft, 1.0);
  const LawSet& laws = empty.system.laws;
  const auto law = [&](std::int32_t a, std::int32_t b) { return laws.law(laws.index(a, b)); };
  std::vector<LawFileEntry> out{{"solid-solid", law(0, 0)}, {"solid-wall", law(0, 2)}, {"hard", hard_law(spec)}};
  if (!any_soft) return out;
  out.insert(out.end() - 1, {{"soft-solid", law(1, 0)}, {"soft-soft", law(1, 1)}, {"soft-wall", law(1, 2)}});
  return out;
}

std::string key_of(const LammpsRuns& runs, std::int64_t sample) {
  return short_hash(fmt::format("{}\n{} {}", runs.identity, runs.law.tag, sample));
}

std::int64_t kept_states(const LammpsRuns& runs, std::int64_t sample) {
  return sample == 0 ? runs.setup.kept_states : 0;
}

void write_sample(const LammpsRuns& runs, const MacroPacking& packing, std::int64_t sample, const std::string& where) {
  const auto missing = [&](const char* file) { return !fs::exists(where + "/" + file); };
  const lammps::BodyTypes types = lammps::body_types(packing);
  const MacroSpec& spec = runs.setup.spec;
  if (missing(lammps::kLawsFile))
    write_text_atomic(where + "/" + lammps::kLawsFile,
                      (runs.law.identity.form ? "# " + identity_text(runs.law.identity) + "\n" : "") +
                          laws_text(laws_of(spec, runs.law.laws, packing.soft_count() > 0)));
  if (missing(lammps::kDataFile))
    lammps::write_data_file(where + "/" + lammps::kDataFile,
                            fmt::format("softgrain: {} bodies, sample {}", packing.bodies.size(), sample), packing,
                            types, spec.density, runs.inner_solid_fraction);
  if (missing(lammps::kSpringsFile) && lammps::has_springs(spec, packing))
    lammps::write_springs_file(where + "/" + lammps::kSpringsFile, spec, packing);
  if (missing(lammps::kScriptFile))
    write_text_atomic(
        where + "/" + lammps::kScriptFile,
        lammps::script_text({spec, packing, types, runs.title, key_of(runs, sample), kept_states(runs, sample)}));
}

/// One sample, from its files to its curve.
class Sample {
 public:
  Sample(const LammpsRuns& runs, MacroPacking& packing, std::int64_t number, const RunContext& context)
      : runs_(runs),
        packing_(packing),
        number_(number),
        where_(lammps_directory(context, number, runs.folder)),
        key_(key_of(runs, number)) {}

  void run(const LammpsEngine& engine, const std::function<void(double)>& progress) {
    MacroCurve so_far = blank_curve(spec(), packing_, runs_.law.name, number_);
    // Rows of another test are refused before LAMMPS continues after them.
    lammps::add_points(read_rows(), spec(), so_far);
    lammps::ResumePoint from =
        lammps::find_resume_point(where_, key_, recorded_points(spec()), spec().stages, lammps::grain_names(spec()));
    if (from.done) return;
    const std::string log = where_ + "/" + lammps::kLogFile;
    const std::uintmax_t before = fs::exists(log) ? fs::file_size(log) : 0;
    fs::remove(where_ + "/" + lammps::kDivergedFile);
    const auto words = lammps::command_words(engine.program, engine.ranks, from.settings);
    const ChildEnd end = run_child(words, where_, log, [&] { progress(share_done()); });
    if (end.interrupted)
      throw Interrupted(
          "stopped by a signal while LAMMPS was straining; what was recorded is saved; go on with --resume");
    if (end.status != 0 || end.signal != 0) fail(end, lammps::read_log(log, before));
  }

  [[nodiscard]] RunOutcome outcome() {
    if (spec().preparation == Preparation::lammps) take_over_preparation();
    const auto rows = read_rows();
    MacroSystem macro = make_law_system(spec(), packing_, runs_.law.laws, runs_.inner_solid_fraction);
    RunOutcome out{begin_curve(spec(), packing_, macro, runs_.law.name, number_), {}};
    out.curve.law = runs_.law.identity;
    lammps::add_points(rows, spec(), out.curve);
    for (const lammps::PointRow& row : rows) lammps::add_grains(row, spec(), packing_, out.curve);
    if (note_diverged(rows, out.curve)) return out;
    if (rows.empty() ||
        (!lammps::ended_early(rows.back()) && static_cast<std::int64_t>(rows.size()) < recorded_points(spec())))
      throw IoError(fmt::format("{}/{}: {} of {} points, although LAMMPS ended without a complaint", where_,
                                lammps::kPointsFile, rows.size(), recorded_points(spec())));
    if (!fs::exists(where_ + "/" + lammps::kEndFile))
      throw IoError(where_ + ": the last state is not there, although LAMMPS ended without a complaint");
    try {
      read_states(rows, macro, out);
    } catch (const InputError& e) {  // a cell that has become too small for its bodies
      out.curve.usable = false;
      append_part(out.curve.note, fmt::format("its last state cannot be read: {}", e.what()));
    }
    return out;
  }

 private:
  [[nodiscard]] const MacroSpec& spec() const { return runs_.setup.spec; }

  /// Share of compaction and test that is done. A compaction takes about as long as five points.
  [[nodiscard]] double share_done() const {
    const auto points = static_cast<double>(lammps::count_points(where_));
    const double before = spec().preparation == Preparation::lammps ? 5.0 : 0.0;
    const double compacted = before > 0.0 ? before * lammps::compaction_share(where_) : 0.0;
    return (compacted + points) / (before + static_cast<double>(recorded_points(spec())));
  }

  [[nodiscard]] std::vector<lammps::PointRow> read_rows() const {
    return lammps::read_points(where_, key_, lammps::grain_names(spec()));
  }

  /// Trouble of the scene is not usable, as with our own engine; any other is trouble while running.
  [[noreturn]] void fail(const ChildEnd& end, const lammps::LogTail& log) const {
    const auto rows = read_rows();
    const double strain = rows.empty() ? strain_at(spec(), 0) : rows.back()[lammps::Point::strain];
    const std::string run = fmt::format("macro run '{}'", runs_.law.name);
    if (log.says(lammps::kNotJammed)) throw UnusableResult(not_jammed_text(spec()));
    if (log.says("Lost atoms"))
      throw UnusableResult(fmt::format("{}: the centre of a body is behind a wall beyond strain {:.6f}", run, strain));
    if (log.says("Non-numeric"))
      throw UnusableResult(fmt::format("{}: relaxation diverged beyond strain {:.6f}", run, strain));
    throw IoError(fmt::format("{} {}: {}; the whole log is in {}/{}; what was recorded is saved, --resume goes on",
                              lammps::kProgramName,
                              end.signal != 0 ? fmt::format("was ended by signal {}", end.signal)
                                              : fmt::format("ended with status {}", end.status),
                              log.complaint(), where_, lammps::kLogFile));
  }

  void take_over_preparation() {
    const auto bodies = lammps::read_bodies(where_ + "/" + lammps::kPreparedFile, packing_);
    packing_.low = bodies.low;
    packing_.high = bodies.high;
    for (std::size_t k = 0; k < bodies.x.size(); ++k) packing_.bodies[k].x = bodies.x[k];
  }

  /// A relaxation of which nothing was left to record.
  [[nodiscard]] bool note_diverged(const std::vector<lammps::PointRow>& rows, MacroCurve& curve) const {
    if (!fs::exists(where_ + "/" + lammps::kDivergedFile)) return false;
    const bool staged = spec().test == MacroTest::stages;
    const double strain = !staged        ? strain_at(spec(), static_cast<std::int64_t>(rows.size()))
                          : rows.empty() ? 0.0
                                         : rows.back()[lammps::Point::strain];
    note_relaxation(curve, {RelaxationEnd::diverged, 0, HUGE_VAL}, strain, spec().tolerance);
    if (rows.empty()) throw UnusableResult(fmt::format("macro run '{}': {}", curve.engine, curve.note));
    return true;
  }

  /// The state of a point, dumped as `name`.
  Snapshot state(const std::string& name, const lammps::PointRow& row, MacroSystem& macro, const MacroCurve& curve,
                 std::vector<lammps::DumpedContact>& contacts) const {
    lammps::move_to(lammps::read_bodies(where_ + "/" + lammps::bodies_file(name), packing_), macro);
    contacts = lammps::read_contacts(where_ + "/" + lammps::contacts_file(name), macro.bodies,
                                     row[lammps::Point::contacts], row[lammps::Point::force_sum]);
    MacroCurve up_to_here;
    up_to_here.engine = curve.engine;
    up_to_here.sample = number_;
    const auto point = static_cast<std::size_t>(row[lammps::Point::number]);
    up_to_here.strain = {curve.strain[point]};
    Snapshot s = named_state(macro, packing_, up_to_here, runs_.name);
    s.frame = static_cast<std::int64_t>(point);
    s.contacts = lammps::snapshot_contacts_of(contacts, macro);
    return s;
  }

  void read_states(const std::vector<lammps::PointRow>& rows, MacroSystem& macro, RunOutcome& out) const {
    const std::int64_t wanted = kept_states(runs_, number_);
    std::vector<lammps::DumpedContact> contacts;
    for (std::size_t k = 0; k + 1 < rows.size(); ++k)
      if (is_snapshot(static_cast<std::int64_t>(k), recorded_points(spec()), wanted))
        out.states.push_back(state(std::to_string(k), rows[k], macro, out.curve, contacts));
    Snapshot last = state("end", rows.back(), macro, out.curve, contacts);
    require_inside(rows.back(), macro, out.curve);
    out.curve.body_forces = lammps::normal_forces(contacts);
    if (wanted > 0) out.states.push_back(std::move(last));
    if (!runs_.law.note || !out.curve.usable) return;
    force_pass(macro.system, 0.0);
    add_law_texts(runs_.law, macro.system, out.curve);
  }

  void require_inside(const lammps::PointRow& row, const MacroSystem& macro, const MacroCurve& curve) const {
    if (!(row[lammps::Point::behind_walls] > 0.0)) return;
    const Vec3 low = box_low(macro.system, macro.box);
    const Vec3 high = box_high(macro.system, macro.box);
    std::int64_t body = 0;
    for (std::int64_t k = 0; k < macro.bodies; ++k)
      for (int a = 0; a < 3; ++a) {
        const double x = macro.system.particles.sphere[static_cast<std::size_t>(k)].x[a];
        if (x < low[a] || x > high[a]) body = k;
      }
    throw UnusableResult(behind_wall_text(curve.engine, body, curve.strain.back()));
  }

  const LammpsRuns& runs_;
  MacroPacking& packing_;
  std::int64_t number_;
  std::string where_;
  std::string key_;
};

}  // namespace

void refuse_sliding(const MacroSpec& spec) {
  if (any_slides(stages_of(spec)))
    throw InputError("--engine lammps: simple-shear and direct-shear run in our own engine alone; leave it out");
}

std::optional<LammpsEngine> read_engine(const CommonOptions& options, std::int64_t bodies) {
  const auto engine = options.engine.empty() ? MacroEngine::softgrain : parse_enum<MacroEngine>(options.engine);
  if (!engine) {
    const std::string near = nearest_word(options.engine, {"softgrain", "lammps"});
    throw InputError("--engine " + options.engine + ": " + (near.empty() ? "" : "nearest is '" + near + "'; ") +
                     "known are softgrain and lammps");
  }
  if (engine == MacroEngine::softgrain) {
    if (options.ranks > 0) throw InputError("--ranks goes with --engine lammps");
    if (options.write_only) throw InputError("--write-only goes with --engine lammps");
    return std::nullopt;
  }
  if (options.write_only && options.ranks > 0)
    throw InputError("--ranks goes with a run: with --write-only LAMMPS is not started");
  LammpsEngine lammps{std::max<std::int64_t>(options.ranks, 1), options.write_only, ""};
  if (lammps.write_only) return lammps;
  lammps.program = lammps::find_program();
  if (lammps.program.empty()) throw InputError(lammps::missing_text());
  if (lammps.ranks > bodies)
    throw InputError(fmt::format("--ranks {}: the scene has {} bodies, and a rank needs one at least; allowed: 1 to {}",
                                 lammps.ranks, bodies, bodies));
  (void)lammps::command_words(lammps.program, lammps.ranks, {});  // mpirun must be there
  return lammps;
}

std::string lammps_directory(const RunContext& context, std::int64_t sample, const std::string& folder) {
  return context.path(fmt::format("{}-{}", folder, sample));
}

std::string lammps_identity(const Provenance& provenance, const std::string& more) {
  return fmt::format("{}\n# seed {}\n{}", provenance.scene, provenance.seed, more);
}

std::string written_text(const std::string& directories) {
  return fmt::format(
      "written: {}; in there: mpirun -np 4 {} -in scene.in (which ./softgrain setup --with-lammps "
      "builds); then the same command here with --resume and without --write-only",
      directories, lammps::kProgramName);
}

void write_lammps_files(const LammpsRuns& runs, const std::vector<MacroPacking>& packings, const RunContext& context) {
  for (std::size_t k = 0; k < packings.size(); ++k) {
    const auto sample = static_cast<std::int64_t>(k);
    const std::string where = lammps_directory(context, sample, runs.folder);
    std::error_code error;
    fs::create_directories(where, error);
    if (error) throw IoError(where + ": cannot be created: " + error.message());
    write_sample(runs, packings[k], sample, where);
  }
}

std::vector<RunOutcome> run_with_lammps(const LammpsRuns& runs, const LammpsEngine& engine,
                                        std::vector<MacroPacking>& packings, const RunContext& context) {
  std::vector<RunOutcome> outcomes;
  Progress progress(runs.name + " with LAMMPS", static_cast<double>(packings.size()), context.quiet());
  for (std::size_t k = 0; k < packings.size(); ++k) {
    Sample sample(runs, packings[k], static_cast<std::int64_t>(k), context);
    sample.run(engine, [&](double share) { progress.set(static_cast<double>(k) + share); });
    outcomes.push_back(sample.outcome());
  }
  return outcomes;
}

EngineUse engine_use(const LammpsEngine& engine, const std::string& directory) {
  EngineUse use{MacroEngine::lammps, engine.ranks, engine.program, ""};
  std::ifstream log(directory + "/" + lammps::kLogFile);
  for (std::string line; std::getline(log, line);)
    if (line.starts_with("LAMMPS (")) {
      use.release = line.substr(8, line.rfind(')') - 8);
      break;
    }
  return use;
}

}  // namespace softgrain
