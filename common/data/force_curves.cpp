#include "common/data/force_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <unordered_set>

#include "common/core/error.h"
#include "common/data/force_curve_rows.h"
#include "common/data/force_scale.h"
#include "common/io/poisson_range.h"

namespace softgrain {

namespace {

/// Names under which a quantity may stand in the header (lower case).
struct ColumnName {
  const char* quantity;
  std::vector<std::string> names;
};

const std::vector<ColumnName>& column_names() {
  static const std::vector<ColumnName> names{
      {"hn", {"hn", "h_n", "h", "overlap", "displacement", "indentation"}},
      {"Delta", {"delta", "delta_n", "strain"}},
      {"Fn", {"fn", "f_n", "f", "force", "normal force", "load"}},
      {"standard error", {"se", "error", "standard error", "standard_error", "stderr", "fn_se", "fn error", "sigma"}},
      {"sample", {"sample", "specimen", "test", "packing"}},
      {"ht", {"ht", "h_t", "tangential displacement"}},
      {"Ft", {"ft", "f_t", "tangential force"}},
      {"kt", {"kt", "k_t", "tangential stiffness"}}};
  return names;
}

std::size_t& place(CurveLayout& layout, std::size_t quantity) {
  std::size_t* const places[] = {&layout.hn,     &layout.delta, &layout.fn, &layout.error,
                                 &layout.sample, &layout.ht,    &layout.ft, &layout.kt};
  return *places[quantity];
}

std::string known_columns(const std::string& found) {
  std::vector<std::string> all;
  for (const ColumnName& c : column_names()) all.insert(all.end(), c.names.begin(), c.names.end());
  const std::string near = nearest_word(found, all);
  return near.empty() ? "" : fmt::format(" (\"{}\" is near)", near);
}

[[noreturn]] void no_column(const CsvFile& file, const char* wanted) {
  std::string found;
  for (const CsvColumn& c : file.columns())
    found += (found.empty() ? "\"" : ", \"") + c.title + "\"" + known_columns(c.name);
  throw BadInput(fmt::format("{}: no column {}; found {}", file.where(file.header_line()), wanted, found));
}

CurveLayout layout_of(const CsvFile& file, std::vector<std::string>& remarks) {
  CurveLayout layout;
  std::string unused;
  for (std::size_t c = 0; c < file.columns().size(); ++c) {
    bool known = false;
    for (std::size_t q = 0; q < column_names().size(); ++q) {
      const auto& names = column_names()[q].names;
      if (std::find(names.begin(), names.end(), file.columns()[c].name) == names.end()) continue;
      known = true;
      if (place(layout, q) != CurveLayout::none)
        throw BadInput(fmt::format("{}: columns \"{}\" and \"{}\" both name {}", file.where(file.header_line()),
                                   file.columns()[place(layout, q)].title, file.columns()[c].title,
                                   column_names()[q].quantity));
      place(layout, q) = c;
    }
    if (!known) unused += (unused.empty() ? "\"" : ", \"") + file.columns()[c].title + "\"";
  }
  if (!unused.empty()) remarks.push_back(file.path() + ": not used: " + unused);
  return layout;
}

void require_columns(const CsvFile& file, const CurveLayout& at) {
  if (at.hn == CurveLayout::none && at.delta == CurveLayout::none)
    no_column(file, "of the overlap, e.g. hn [mm] or Delta");
  if (at.hn != CurveLayout::none && at.delta != CurveLayout::none)
    throw BadInput(file.where(file.header_line()) + ": give the overlap once, as hn or as Delta");
  if (at.fn == CurveLayout::none) no_column(file, "of the force, e.g. Fn [N]");
  if ((at.ht == CurveLayout::none) != (at.ft == CurveLayout::none))
    no_column(file, at.ht == CurveLayout::none ? "ht beside Ft" : "Ft beside ht");
  if (at.kt != CurveLayout::none && at.ft != CurveLayout::none)
    throw BadInput(file.where(file.header_line()) + ": give the tangential law once, as kt or as ht and Ft");
  const auto unit = [&](std::size_t column, Unit u, const char* example) {
    if (column != CurveLayout::none) file.require_unit(column, u, example);
  };
  unit(at.hn, Unit::length, "hn [mm]");
  unit(at.delta, Unit::none, "Delta");
  unit(at.fn, Unit::force, "Fn [N]");
  unit(at.error, Unit::force, "se [N]");
  unit(at.ht, Unit::length, "ht [um]");
  unit(at.ft, Unit::force, "Ft [N]");
  unit(at.kt, Unit::stiffness, "kt [N/mm]");
}

/// A number from a comment of the file.
std::optional<double> setting(const CsvFile& file, const std::vector<std::string>& keys, Unit unit,
                              const Range& range) {
  const auto found = file.setting(keys);
  if (!found) return std::nullopt;
  const auto complain = [&](const std::string& problem) {
    throw BadInput(fmt::format("{}: {} = {}: {}", file.where(found->line), found->key, found->value, problem));
  };
  double value = 0.0;
  try {
    value = parse_quantity(found->value, unit);
  } catch (const BadInput& e) {
    complain(e.what());
  }
  if (value < range.low || value > range.high || (range.low_open && value == range.low))
    complain(fmt::format("must be {} {}{}", range.low_open ? "above" : "at least", range.low,
                         std::isfinite(range.high) ? fmt::format(" and at most {}", range.high) : ""));
  return value;
}

PairKind kind_of(const CsvFile& file, const ForceCurveOptions& options) {
  if (options.kind) return *options.kind;
  const auto said = file.setting({"kind"});
  if (!said)
    throw BadInput(file.path() +
                   ": which contact was measured? Give --kind soft-solid or soft-soft, or a comment \"# kind = "
                   "soft-solid\"");
  if (const auto kind = from_word<PairKind>(said->value)) return *kind;
  throw BadInput(fmt::format("{}: kind = {}: must be soft-solid or soft-soft", file.where(said->line), said->value));
}

SoftParticleSpec spec_of(const CsvFile& file, const ForceCurveOptions& options) {
  const auto radius = options.shell_radius
                          ? options.shell_radius
                          : setting(file, {"rs", "radius", "shell_radius"}, Unit::length, Range::positive());
  if (!radius)
    throw BadInput(file.path() +
                   ": the radius of the soft particle is needed: --radius \"16 mm\", or a comment \"# Rs = 16 mm\"");
  const auto modulus = options.youngs_modulus
                           ? options.youngs_modulus
                           : setting(file, {"e", "modulus", "youngs_modulus"}, Unit::pressure, Range::positive());
  if (!modulus)
    throw BadInput(
        file.path() +
        ": E of the grains is needed to make the law dimensionless: --modulus \"0.5 MPa\", or a comment \"# E "
        "= 0.5 MPa\" (a law used with the same E gives back the measured forces)");
  SoftParticleSpec spec = unknown_soft_particle(*radius, *modulus);
  spec.poisson_ratio = setting(file, {"nu", "poisson_ratio"}, Unit::none, kPoissonRange).value_or(spec.poisson_ratio);
  spec.friction = setting(file, {"mu", "friction"}, Unit::none, Range::not_negative()).value_or(spec.friction);
  spec.density = setting(file, {"density", "rho"}, Unit::density, Range::positive()).value_or(spec.density);
  return spec;
}

/// Ft at +-angle, between the two measured displacements around it, where the sweep reaches that far.
void add_secant_points(ForceCurve& sample, double angle_deg) {
  std::vector<TangentialPoint>& all = sample.tangential;
  std::stable_sort(all.begin(), all.end(), [](const TangentialPoint& a, const TangentialPoint& b) {
    return a.delta != b.delta ? a.delta < b.delta : a.angle_deg < b.angle_deg;
  });
  std::vector<TangentialPoint> added;
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k].delta != all[k - 1].delta) continue;
    for (const double at : {-angle_deg, angle_deg}) {
      if (!(all[k - 1].angle_deg < at && at < all[k].angle_deg)) continue;
      TangentialPoint p = all[k];
      const double share = (at - all[k - 1].angle_deg) / (all[k].angle_deg - all[k - 1].angle_deg);
      p.angle_deg = at;
      p.force_parallel = all[k - 1].force_parallel + share * (all[k].force_parallel - all[k - 1].force_parallel);
      added.push_back(p);
    }
  }
  all.insert(all.end(), added.begin(), added.end());
}

struct SpecName {
  const char* name;
  double SoftParticleSpec::*value;
};
constexpr SpecName kSaid[] = {{"Rs", &SoftParticleSpec::shell_radius},
                              {"E", &SoftParticleSpec::youngs_modulus},
                              {"nu", &SoftParticleSpec::poisson_ratio},
                              {"mu", &SoftParticleSpec::friction},
                              {"density", &SoftParticleSpec::density}};

void require_same(const std::string& a, const std::string& b, const SoftParticleSpec& s, const SoftParticleSpec& t) {
  for (const SpecName& n : kSaid)
    if (is_known(s.*n.value) && is_known(t.*n.value) && s.*n.value != t.*n.value)
      throw BadInput(fmt::format("{} and {}: {} differs: {} and {}", a, b, n.name, s.*n.value, t.*n.value));
}

/// What one file says holds for all.
void share_spec(std::vector<ForceCurves>& curves) {
  for (const SpecName& n : kSaid)
    for (const ForceCurves& from : curves)
      for (ForceCurves& to : curves)
        if (!is_known(to.spec.*n.value)) to.spec.*n.value = from.spec.*n.value;
}

}  // namespace

ForceCurves read_force_curves(const std::string& path, const ForceCurveOptions& options) {
  const CsvFile file = CsvFile::read(path);
  ForceCurves out;
  const CurveLayout at = layout_of(file, out.remarks);
  require_columns(file, at);
  out.kind = kind_of(file, options);
  out.spec = spec_of(file, options);
  out.has_errors = at.error != CurveLayout::none;
  CurveRows(file, at, options, out).read();
  for (ForceCurve& s : out.samples)
    if (at.ft != CurveLayout::none) add_secant_points(s, options.secant_angle_deg);
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
  for (const std::string& path : paths) {
    if (std::count(paths.begin(), paths.end(), path) > 1) throw BadInput(path + ": the file is given twice");
    ForceCurves one = read_force_curves(path, options);
    const auto same = std::find_if(out.begin(), out.end(), [&](const ForceCurves& c) { return c.kind == one.kind; });
    for (const ForceCurves& before : out) require_same(paths.front(), path, before.spec, one.spec);
    if (same == out.end()) {
      out.push_back(std::move(one));
      continue;
    }
    const std::string stem = std::filesystem::path(path).stem().string();
    std::unordered_set<std::string> taken;
    for (const ForceCurve& s : same->samples) taken.insert(s.name);
    for (ForceCurve& s : one.samples) {
      if (taken.contains(s.name)) s.name = stem + ": " + s.name;
      if (!taken.insert(s.name).second) throw BadInput(path + ": sample \"" + s.name + "\" was read before");
      same->samples.push_back(std::move(s));
    }
    for (const SpecName& n : kSaid)
      if (!is_known(same->spec.*n.value)) same->spec.*n.value = one.spec.*n.value;
    same->has_errors = same->has_errors && one.has_errors;
    same->remarks.insert(same->remarks.end(), one.remarks.begin(), one.remarks.end());
  }
  share_spec(out);
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  return out;
}

}  // namespace softgrain
