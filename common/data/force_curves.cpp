// Reads force-displacement measurements of an experiment, and says whether such forces can be those of a soft
// particle.
#include "common/data/force_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <unordered_set>

#include "common/core/error.h"
#include "common/data/force_curve_rows.h"
#include "common/data/soft_particle_schema.h"

namespace softgrain {

std::vector<std::string> implausible_forces(const std::vector<double>& delta, const std::vector<double>& force,
                                            double shell_radius, double youngs_modulus) {
  constexpr double kTooSoft = 2e-4;
  constexpr double kDeep = 0.1;  // Delta from which on a published soft particle bears a share that can be judged
  std::vector<std::string> out;
  if (delta.empty() || delta.size() != force.size()) return out;
  const auto most = static_cast<std::size_t>(
      std::max_element(force.begin(), force.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      force.begin());
  if (std::accumulate(force.begin(), force.end(), 0.0) < 0.0)
    out.push_back(fmt::format(
        "forces are negative (down to {:.4g} N): compression counts positive here; turn the sign if the file counts "
        "tension so",
        *std::min_element(force.begin(), force.end())));
  const double solid =
      4.0 / 3.0 * youngs_modulus * shell_radius * shell_radius * std::pow(std::max(delta[most], 0.0), 1.5);
  const double share = std::abs(force[most]) / solid;
  const std::string what =
      fmt::format("{:.4g} N at Delta = {:.3g} is {:.2g} times that of a solid sphere with this E and Rs", force[most],
                  delta[most], share);
  const char* const hint = ": check the units of force, E and radius";
  if (solid > 0.0 && share > 1.0) out.push_back(what + ", more than any soft particle" + hint);
  if (delta[most] > kDeep && share < kTooSoft) out.push_back(what + " (published soft particles: 0.01 to 0.1)" + hint);
  return out;
}

namespace {

/// Names under which a quantity may stand in the header (lower case).
struct ColumnName {
  const char* quantity;
  Unit unit;
  const char* example;  ///< of a title
  std::vector<std::string> names;
};

const std::vector<ColumnName>& column_names() {
  static const std::vector<ColumnName> names{
      {"hn",
       Unit::length,
       "hn [mm]",
       {"hn", "h_n", "h", "overlap", "displacement", "indentation", "weg", "standardweg"}},
      {"Delta", Unit::none, "Delta", {"delta", "delta_n", "hn/rs", "h/rs"}},
      {"Fn", Unit::force, "Fn [N]", {"fn", "f_n", "f", "force", "normal force", "load", "kraft", "standardkraft"}},
      {"standard error",
       Unit::force,
       "se [N]",
       {"se", "error", "standard error", "standard_error", "stderr", "fn_se", "fn error", "sigma"}},
      {"sample", Unit::none, "sample", {"sample", "specimen", "test", "packing"}},
      {"ht", Unit::length, "ht [um]", {"ht", "h_t", "tangential displacement"}},
      {"Ft", Unit::force, "Ft [N]", {"ft", "f_t", "tangential force"}},
      {"kt", Unit::stiffness, "kt [N/mm]", {"kt", "k_t", "tangential stiffness"}},
      {"branch", Unit::none, "branch", {"branch", "phase"}}};
  return names;
}

std::size_t& place(CurveLayout& layout, std::size_t quantity) {
  std::size_t* const places[] = {&layout.hn, &layout.delta, &layout.fn, &layout.error, &layout.sample,
                                 &layout.ht, &layout.ft,    &layout.kt, &layout.branch};
  return *places[quantity];
}

/// The quantity of a name, its index in column_names().
std::optional<std::size_t> quantity_of(const std::string& name) {
  for (std::size_t q = 0; q < column_names().size(); ++q) {
    const auto& names = column_names()[q].names;
    if (std::find(names.begin(), names.end(), name) != names.end()) return q;
  }
  return std::nullopt;
}

/// What to write in place of a title that is none of ours: "force_n" is meant to be "force [N]", "forse" force.
std::string known_columns(const std::string& found) {
  if (quantity_of(found)) return "";
  if (const auto q = quantity_of(found.substr(0, found.find_first_of(" _/,"))))
    if (const std::string example = column_names()[*q].example; example.ends_with(']'))
      return fmt::format(" (write it as \"{}\")", example);
  std::vector<std::string> all;
  for (const ColumnName& c : column_names()) all.insert(all.end(), c.names.begin(), c.names.end());
  const std::string near = nearest_word(found, all);
  return near.empty() ? "" : fmt::format(" (\"{}\" is near)", near);
}

[[noreturn]] void no_column(const CsvFile& file, const char* wanted) {
  std::string found;
  for (const CsvColumn& c : file.columns())
    found += (found.empty() ? "\"" : ", \"") + c.title + "\"" + known_columns(c.name);
  throw InputError(fmt::format("{}: no column {}; found {}", file.where(file.header_line()), wanted, found));
}

/// Refuses columns of strain. A strain of spheres may be the overlap over the radius or over the diameter, and the fit
/// differs by a power of two.
void refuse_ambiguous(const CsvFile& file) {
  const CsvNames ambiguous{"strain", "compressive strain", "compression", "deformation", "epsilon", "eps", "h/d",
                           "h/2r"};
  for (const CsvColumn& c : file.columns())
    if (std::find(ambiguous.begin(), ambiguous.end(), c.name) != ambiguous.end())
      throw InputError(
          fmt::format("{}: column \"{}\": over which length is it? Give the overlap as hn [mm] (also overlap, "
                      "displacement, indentation), or over the radius Rs as Delta; a strain over the diameter of the "
                      "soft particle is half of Delta",
                      file.where(file.header_line()), c.title));
}

/// Number of a repeat, however it is written (1, 01); empty: all repeats.
using Repeat = std::optional<std::int64_t>;

/// "fn 2" is Fn of repeat 2. Overlap, force and its error may be numbered.
struct NamedColumn {
  std::size_t quantity = 0;
  Repeat repeat{};
};

std::optional<NamedColumn> named_column(const std::string& name) {
  constexpr std::size_t kNumbered = 4;  // hn, Delta, Fn, error
  if (const auto q = quantity_of(name)) return NamedColumn{*q};
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  if (digits == name.size() || digits == 0) return std::nullopt;
  const std::size_t end = name.find_last_not_of(" _-.#", digits - 1) + 1;
  const auto q = quantity_of(name.substr(0, end));
  if (!q || *q >= kNumbered) return std::nullopt;
  std::int64_t repeat = 0;
  if (std::from_chars(name.data() + digits, name.data() + name.size(), repeat).ec != std::errc()) return std::nullopt;
  return NamedColumn{*q, repeat};
}

/// The table with units in the place of units.
CsvFile table_of_curves(const std::string& path) {
  CsvFile file = CsvFile::read(path);
  file.take_units_behind_names([](const std::string& name) -> std::optional<Unit> {
    const auto named = named_column(name);
    return named ? std::optional(column_names()[named->quantity].unit) : std::nullopt;
  });
  return file;
}

/// Columns by the repeat that they belong to, in the order of their numbers; those without one belong to all.
using RepeatLayouts = std::map<Repeat, CurveLayout>;

RepeatLayouts columns_of(const CsvFile& file, std::vector<std::string>& remarks) {
  RepeatLayouts out{{std::nullopt, {}}};
  std::string unused;
  refuse_ambiguous(file);
  for (std::size_t c = 0; c < file.columns().size(); ++c) {
    const auto named = named_column(file.columns()[c].name);
    if (!named) {
      unused += (unused.empty() ? "\"" : ", \"") + file.columns()[c].title + "\"";
      continue;
    }
    std::size_t& at = place(out[named->repeat], named->quantity);
    if (at != CurveLayout::none)
      throw InputError(fmt::format(
          "{}: columns \"{}\" and \"{}\" both name {}{}; repeats are numbered: Fn 1 [N], Fn 2 [N]",
          file.where(file.header_line()), file.columns()[at].title, file.columns()[c].title,
          column_names()[named->quantity].quantity, named->repeat ? fmt::format(" of repeat {}", *named->repeat) : ""));
    at = c;
  }
  if (!unused.empty()) remarks.push_back(file.path() + ": not used: " + unused);
  return out;
}

/// One layout, or one for each repeat.
std::vector<CurveLayout> layouts_of(const CsvFile& file, std::vector<std::string>& remarks) {
  const RepeatLayouts columns = columns_of(file, remarks);
  const CurveLayout& common = columns.at(std::nullopt);
  if (columns.size() == 1) return {common};
  const auto refuse = [&](const std::string& problem) {
    throw InputError(fmt::format("{}: {}", file.where(file.header_line()), problem));
  };
  if (common.fn != CurveLayout::none)
    refuse(fmt::format(
        "column \"{}\" beside numbered ones: number the forces of all repeats (Fn 1 [N], Fn 2 [N]), or none",
        file.columns()[common.fn].title));
  if (common.ft != CurveLayout::none || common.kt != CurveLayout::none)
    refuse("a tangential stiffness goes with one column of the force: give repeats by a column \"sample\"");
  std::vector<CurveLayout> out;
  for (const auto& [repeat, own] : columns) {
    if (!repeat) continue;
    if (own.fn == CurveLayout::none) refuse(fmt::format("repeat {0} has no column of the force: Fn {0} [N]", *repeat));
    CurveLayout one = common;
    one.repeat = std::to_string(*repeat);
    for (std::size_t CurveLayout::*at : {&CurveLayout::hn, &CurveLayout::delta, &CurveLayout::fn, &CurveLayout::error})
      if (own.*at != CurveLayout::none) one.*at = own.*at;
    out.push_back(one);
    if ((one.error == CurveLayout::none) != (out.front().error == CurveLayout::none))
      refuse("give the standard error of the force of every repeat, or of none");
  }
  return out;
}

void require_columns(const CsvFile& file, const CurveLayout& at) {
  if (at.hn == CurveLayout::none && at.delta == CurveLayout::none)
    no_column(file, "of the overlap, e.g. hn [mm] or Delta");
  if (at.hn != CurveLayout::none && at.delta != CurveLayout::none)
    throw InputError(file.where(file.header_line()) + ": give the overlap once, as hn or as Delta");
  if (at.fn == CurveLayout::none) no_column(file, "of the force, e.g. Fn [N]");
  if ((at.ht == CurveLayout::none) != (at.ft == CurveLayout::none))
    no_column(file, at.ht == CurveLayout::none ? "ht beside Ft" : "Ft beside ht");
  if (at.kt != CurveLayout::none && at.ft != CurveLayout::none)
    throw InputError(file.where(file.header_line()) + ": give the tangential law once, as kt or as ht and Ft");
  CurveLayout layout = at;
  for (std::size_t q = 0; q < column_names().size(); ++q) {
    const std::size_t column = place(layout, q);
    const ColumnName& known = column_names()[q];
    if (column != CurveLayout::none && column != at.sample && column != at.branch)
      file.require_unit(column, known.unit, known.example);
  }
}

/// What comments of a press test may say.
const CsvNames kKind{"kind", "contact"};
const CsvNames kRadius{"rs", "radius", "shell radius", "r", "particle radius", "radius rs"};
const CsvNames kModulus{"e", "modulus", "youngs modulus", "young modulus", "elastic modulus", "e modulus"};
const CsvNames kPoisson{"nu", "poisson ratio", "poissons ratio", "poisson number", "poisson"};
const CsvNames kFriction{"mu", "friction", "friction coefficient", "coefficient of friction"};
const CsvNames kDensity{"density", "rho", "grain density"};
const CsvNames kSample{"sample", "specimen", "test"};
const CsvNames kTouchNames{"touch", "touch point", "displacement at touch"};
const CsvNames kZeroForce{"force offset", "zero force"};
const CsvNames kMachine{"machine stiffness", "frame stiffness"};

/// What the machine adds to every reading.
void read_machine(const CsvFile& file, CurveLayout& at) {
  at.touch = file.quantity(kTouchNames, Unit::length, Range::any()).value_or(0.0);
  at.zero_force = file.quantity(kZeroForce, Unit::force, Range::any()).value_or(0.0);
  if (const auto k = file.quantity(kMachine, Unit::stiffness, Range::positive())) at.machine_stiffness = *k;
}

/// An option that says what a comment may say, where the command has such options.
std::string beside_text(const ForceCurveOptions& options, const char* option) {
  return options.by_options ? std::string("give ") + option + ", or " : "write ";
}

PairKind kind_of(const CsvFile& file, const ForceCurveOptions& options) {
  const auto said = file.word(kKind);
  if (!said && options.kind) return *options.kind;
  if (!said)
    throw InputError(file.path() + ": which contact was measured? " +
                     beside_text(options, "--kind soft-solid or soft-soft") +
                     "a comment \"# kind = soft-solid\" (against a plate) or \"# kind = soft-soft\" (two alike)");
  const auto kind = parse_enum<PairKind>(said->value);
  if (!kind)
    throw InputError(
        fmt::format("{}: {} = {}: must be soft-solid or soft-soft", file.where(said->line), said->title, said->value));
  if (options.kind && *options.kind != *kind)
    throw InputError(fmt::format("{}: {} = {} contradicts {} {}: leave one of them out", file.where(said->line),
                                 said->title, said->value, options.kind_from, to_string(*options.kind)));
  return *kind;
}

/// What the file and `beside` it say, which must be the same.
std::optional<double> agreed(const CsvFile& file, const CsvNames& names, Unit unit, const std::optional<double>& beside,
                             const char* from, const char* si) {
  constexpr double kRounding = 1e-9;
  const auto value = file.quantity(names, unit, Range::positive());
  if (!value || !beside) return value ? value : beside;
  if (std::abs(*value - *beside) <= kRounding * *value) return beside;
  const CsvSetting said = *file.setting(names);
  throw InputError(fmt::format("{}: {} = {} ({:g} {}) contradicts {} {:g} {}: leave one of them out",
                               file.where(said.line), said.title, said.value, *value, si, from, *beside, si));
}

SoftParticleSpec spec_of(const CsvFile& file, const ForceCurveOptions& options) {
  const auto radius = agreed(file, kRadius, Unit::length, options.shell_radius, options.radius_from, "m");
  if (!radius)
    throw InputError(file.path() + ": the radius of the soft particle is needed: " +
                     beside_text(options, "--radius \"16 mm\"") + "a comment \"# Rs = 16 mm\"");
  const auto modulus = agreed(file, kModulus, Unit::pressure, options.youngs_modulus, options.modulus_from, "Pa");
  if (!modulus)
    throw InputError(file.path() + ": E of the grains is needed to make the law dimensionless: " +
                     beside_text(options, "--modulus \"0.5 MPa\"") +
                     "a comment \"# E = 0.5 MPa\" (a law used with the same E gives back the measured forces)");
  SoftParticleSpec spec = unknown_soft_particle(*radius, *modulus);
  const auto take = [&](double SoftParticleSpec::*value, const CsvNames& names) {
    const SoftParticleNumber& number = soft_particle_number(value);
    spec.*value = file.quantity(names, number.unit, number.range).value_or(spec.*value);
  };
  take(&SoftParticleSpec::poisson_ratio, kPoisson);
  take(&SoftParticleSpec::friction, kFriction);
  take(&SoftParticleSpec::density, kDensity);
  return spec;
}

/// Angles are written with few digits: those that differ by no more than this share of the secant's angle are one.
constexpr double kSameAngle = 1e-3;

/// One turn with readings at 0 and +-angle, where it has them: as they were read nearby, or at +-angle between the two
/// readings around it. `turn`: angles rising.
void add_secant_points(std::span<const TangentialPoint> turn, double angle_deg, std::vector<TangentialPoint>& added) {
  for (const double at : {-angle_deg, 0.0, angle_deg}) {
    const auto distance = [at](const TangentialPoint& p) { return std::abs(p.angle_deg - at); };
    const auto nearest = std::ranges::min_element(turn, {}, distance);
    if (nearest->angle_deg == at) continue;
    TangentialPoint p = *nearest;
    const auto after = std::ranges::find_if(turn, [at](const TangentialPoint& q) { return q.angle_deg > at; });
    if (at != 0.0 && after != turn.begin() && after != turn.end()) {
      const TangentialPoint& before = *(after - 1);
      const double share = (at - before.angle_deg) / (after->angle_deg - before.angle_deg);
      p.force_parallel = before.force_parallel + share * (after->force_parallel - before.force_parallel);
    } else if (distance(*nearest) > kSameAngle * angle_deg) {
      continue;
    }
    p.angle_deg = at;
    added.push_back(p);
  }
}

/// The rotations as the fit takes them: in order, with readings at 0 and +-secant_angle_deg where they can be had, and
/// those that reach initial_angle_deg but for the digits that they were written with.
void complete_turns(ForceCurve& sample, const ForceCurveOptions& options) {
  std::vector<TangentialPoint>& all = sample.tangential;
  std::stable_sort(all.begin(), all.end(), [](const TangentialPoint& a, const TangentialPoint& b) {
    return a.delta != b.delta ? a.delta < b.delta : a.angle_deg < b.angle_deg;
  });
  std::vector<TangentialPoint> added;
  for (std::size_t k = 0, end = 0; k < all.size(); k = end) {
    while (end < all.size() && all[end].delta == all[k].delta) ++end;
    add_secant_points(std::span(all).subspan(k, end - k), options.secant_angle_deg, added);
  }
  const double initial = options.initial_angle_deg;
  for (TangentialPoint& p : all)
    if (std::abs(std::abs(p.angle_deg) - initial) <= kSameAngle * initial)
      p.angle_deg = std::copysign(initial, p.angle_deg);
  all.insert(all.end(), added.begin(), added.end());
}

/// What files of an experiment say of the soft particle.
constexpr double SoftParticleSpec::*kSaid[] = {&SoftParticleSpec::shell_radius, &SoftParticleSpec::youngs_modulus,
                                               &SoftParticleSpec::poisson_ratio, &SoftParticleSpec::friction,
                                               &SoftParticleSpec::density};

void require_same(const std::string& a, const std::string& b, const SoftParticleSpec& s, const SoftParticleSpec& t) {
  for (double SoftParticleSpec::*n : kSaid)
    if (is_known(s.*n) && is_known(t.*n) && s.*n != t.*n)
      throw InputError(
          fmt::format("{} and {}: {} differs: {} and {}", a, b, soft_particle_number(n).symbol, s.*n, t.*n));
}

/// What one file says holds for all.
void share_spec(std::vector<ForceCurves>& curves) {
  for (double SoftParticleSpec::*n : kSaid)
    for (const ForceCurves& from : curves)
      for (ForceCurves& to : curves)
        if (!is_known(to.spec.*n)) to.spec.*n = from.spec.*n;
}

}  // namespace

SaidByFile said_by_comments(const CsvFile& table) {
  return {table.setting(kKind).has_value(), table.setting(kRadius).has_value(), table.setting(kModulus).has_value()};
}

ForceCurves read_force_curves(const std::string& path, const ForceCurveOptions& options) {
  const CsvFile file = table_of_curves(path);
  ForceCurves out;
  std::vector<CurveLayout> layouts = layouts_of(file, out.remarks);
  for (const CurveLayout& at : layouts) require_columns(file, at);
  file.require_known_comments(
      {kRadius, kModulus, kKind, kPoisson, kFriction, kDensity, kSample, kTouchNames, kZeroForce, kMachine},
      "a press test");
  const CurveLayout& first = layouts.front();
  const auto sample = file.word(kSample);
  if (sample && first.sample != CurveLayout::none)
    throw InputError(fmt::format("{}: samples are named by the column \"{}\": leave the comment out",
                                 file.where(file.setting(kSample)->line), file.columns()[first.sample].title));
  out.kind = kind_of(file, options);
  out.spec = spec_of(file, options);
  out.has_errors = first.error != CurveLayout::none;
  for (CurveLayout& at : layouts) {
    if (sample) at.sample_name = sample->value;
    read_machine(file, at);
    ForceCurves one;
    one.spec = out.spec;
    CurveRows(file, at, options, one).read();
    for (ForceCurve& s : one.samples) {
      if (at.ft != CurveLayout::none) complete_turns(s, options);
      out.samples.push_back(std::move(s));
    }
    for (std::string& remark : one.remarks)
      if (std::ranges::find(out.remarks, remark) == out.remarks.end()) out.remarks.push_back(std::move(remark));
  }
  return out;
}

std::vector<std::string> implausible_forces(const ForceCurves& curves) {
  std::vector<double> delta;
  std::vector<double> force;
  for (const ForceCurve& s : curves.samples)
    for (const ForcePoint& p : s.normal) {
      delta.push_back(p.delta);
      force.push_back(p.force);
    }
  return implausible_forces(delta, force, curves.spec.shell_radius, curves.spec.youngs_modulus);
}

std::vector<ForceCurves> read_force_curve_files(const std::vector<std::string>& paths,
                                                const ForceCurveOptions& options) {
  std::vector<ForceCurves> out;
  std::vector<std::pair<std::string, ForceCurves>> before;  // as read, with their files
  for (const std::string& path : paths) {
    ForceCurves one = read_force_curves(path, options);
    for (const auto& [file, read] : before) {
      std::error_code ignored;
      if (file == path || std::filesystem::equivalent(file, path, ignored))
        throw InputError(path + ": the file is given twice");
      require_same(file, path, read.spec, one.spec);
      if (read.kind == one.kind && read.has_errors != one.has_errors)
        one.remarks.push_back(fmt::format("standard errors of {} are not used: {} gives none",
                                          read.has_errors ? file : path, read.has_errors ? path : file));
    }
    before.emplace_back(path, one);
    const auto same = std::find_if(out.begin(), out.end(), [&](const ForceCurves& c) { return c.kind == one.kind; });
    if (same == out.end()) {
      out.push_back(std::move(one));
      continue;
    }
    const std::string stem = std::filesystem::path(path).stem().string();
    std::unordered_set<std::string> taken;
    for (const ForceCurve& s : same->samples) taken.insert(s.name);
    for (ForceCurve& s : one.samples) {
      if (taken.contains(s.name)) s.name = stem + ": " + s.name;
      if (!taken.insert(s.name).second) throw InputError(path + ": sample \"" + s.name + "\" was read before");
      same->samples.push_back(std::move(s));
    }
    for (double SoftParticleSpec::*n : kSaid)
      if (!is_known(same->spec.*n)) same->spec.*n = one.spec.*n;
    same->has_errors = same->has_errors && one.has_errors;
    same->remarks.insert(same->remarks.end(), one.remarks.begin(), one.remarks.end());
  }
  share_spec(out);
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  return out;
}

}  // namespace softgrain
