// Layout of macro.h5: one group per curve ("curve_000000", ...) with attributes and one data set per recorded quantity.
#include "common/data/macro_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/material.h"
#include "common/data/attributes.h"
#include "common/data/columns.h"
#include "common/data/fields.h"

namespace softgrain {

namespace {

constexpr Limits kNotNegative{0.0, kInfinity};

}  // namespace

/// What a curve says of itself, without its columns, its stages and where it comes from.
void fields(auto&& visit, Of<MacroCurve> auto& c) {
  visit("engine", c.engine);
  visit("test", c.test);
  visit("boundary", c.boundary, kLater);
  visit("note", c.note);
  visit("warning", c.warning, kIfAny);
  visit("usable", c.usable);
  visit("sample", c.sample, kNotNegative);
  visit("bodies", c.bodies, kNotNegative);
  visit("soft", c.soft, kNotNegative);
  visit("grains", c.grains, kNotNegative);
  visit("soft_volume_share", c.soft_volume_share, Limits::flag());
  visit("solid_fraction", c.solid_fraction, kNotNegative);
  fields(visit, c.cost);
  visit("preload", c.preload, Limits::flag(), kLater);
  const auto later = [&](const auto& name, auto& member, const auto&... options) {
    visit(name, member, options..., kLater);
  };
  fields(later, c.preparation, "preparation_");
}

namespace {

constexpr const char* kMacroFormat = "macro curves";

constexpr MacroColumn kColumns[] = {{"strain", "1", &MacroCurve::strain, {-kInfinity, 1.0}},
                                    {"stress_axial", "Pa", &MacroCurve::stress_axial},
                                    {"stress_lateral", "Pa", &MacroCurve::stress_lateral},
                                    {"stress_axial_contacts", "Pa", &MacroCurve::stress_axial_contacts},
                                    {"coordination", "1", &MacroCurve::coordination, kNotNegative},
                                    {"residual", "1", &MacroCurve::residual, kNotNegative}};

/// May be absent.
constexpr MacroColumn kOptionalColumns[] = {
    {"residual_largest", "1", &MacroCurve::residual_largest, kNotNegative},
    {"stress_x", "Pa", &MacroCurve::stress_x},
    {"stress_y", "Pa", &MacroCurve::stress_y},
    {"stress_deviator", "Pa", &MacroCurve::stress_deviator},
    {"fabric", "1", &MacroCurve::fabric},
    {"fabric_bodies", "1", &MacroCurve::fabric_bodies},
    {"coordination_bodies", "1", &MacroCurve::coordination_bodies, kNotNegative},
    {"law_asked", "1", &MacroCurve::law_evaluations, kNotNegative},
    {"law_beyond", "1", &MacroCurve::law_beyond, kNotNegative},
    {"law_largest", "1", &MacroCurve::law_largest, kNotNegative},
    {"stage", "1", &MacroCurve::stage, kNotNegative},
    {"strain_x", "1", &MacroCurve::strain_x},
    {"strain_y", "1", &MacroCurve::strain_y},
    {"strain_z", "1", &MacroCurve::strain_z},
    {"shear_strain", "1", &MacroCurve::shear_strain},
    {"stress_xy", "Pa", &MacroCurve::stress_xy},
    {"stress_xz", "Pa", &MacroCurve::stress_xz},
    {"stress_yz", "Pa", &MacroCurve::stress_yz},
    {"stress_asymmetry", "1", &MacroCurve::stress_asymmetry, kNotNegative},
    {"inertial_number", "1", &MacroCurve::inertial_number, kNotNegative}};

constexpr MacroColumn kBodyForces{"body_forces", "N", &MacroCurve::body_forces};

void write_quantity(const h5::Group& group, const MacroCurve& curve, const MacroColumn& c) {
  group.write(c.name, std::span<const double>(curve.*c.values));
  group.attribute_of(c.name, "unit", c.unit);
}

void write_if_any(const h5::Group& group, const MacroCurve& curve, const MacroColumn& c) {
  if (!(curve.*c.values).empty()) write_quantity(group, curve, c);
}

void write_tensors(const h5::Group& group, const MacroCurve& curve) {
  for (const MacroTensor& t : kMacroTensors)
    for (std::size_t k = 0; k < kTensorComponents.size(); ++k) {
      const std::vector<double>& values = (curve.*t.values)[k];
      if (values.empty()) continue;
      group.write(t.of(k), std::span<const double>(values));
      group.attribute_of(t.of(k), "unit", "1");
    }
}

void read_tensors(const h5::Group& group, MacroCurve& curve, std::size_t points) {
  for (const MacroTensor& t : kMacroTensors)
    for (std::size_t k = 0; k < kTensorComponents.size(); ++k)
      if (group.has(t.of(k))) (curve.*t.values)[k] = read_numbers(group, t.of(k), "1", {points});
}

constexpr const char* kForceDistribution = "force_distribution";

/// P(f/<f>) of the normal forces between bodies at the end; for readers of the file, derived from body_forces.
void write_force_distribution(const h5::Group& group, const MacroCurve& curve) {
  if (const auto distribution = force_distribution(curve.body_forces))
    write_histogram(group.create(kForceDistribution), *distribution);
}

constexpr const char* kStageGroup = "stages";
constexpr const char* kModulusStresses = "modulus_stresses";
constexpr const char* kStageAxes = "stage_stress_axes";

/// One line per stage: the axes that go by stress, or none; nothing where they are not known.
void write_stage_axes(const h5::Group& group, const std::vector<StageRecord>& stages) {
  std::string text;
  for (const StageRecord& s : stages) {
    if (!s.by_stress) return;
    std::string axes;
    for (std::size_t k = 0; k < 3; ++k)
      if ((*s.by_stress)[k]) axes += "xyz"[k];
    text += (axes.empty() ? "none" : axes) + "\n";
  }
  group.attribute(kStageAxes, text);
}

void read_stage_axes(const h5::Group& group, std::vector<StageRecord>& stages) {
  if (!group.has_attribute(kStageAxes)) return;
  std::istringstream lines(group.text(kStageAxes));
  std::string line;
  for (StageRecord& s : stages) {
    if (!std::getline(lines, line) || (line != "none" && line.find_first_not_of("xyz") != std::string::npos))
      throw IoError(fmt::format("attribute '{}': '{}' are no axes", kStageAxes, line));
    const auto has = [&](char axis) { return line != "none" && line.find(axis) != std::string::npos; };
    s.by_stress = {has('x'), has('y'), has('z')};
  }
}

// Lines of words, one for each stage.

constexpr auto kStageWords = [](auto&& visit, auto& s) {
  visit(s.kind);
  visit(s.way);
  visit(s.name);
};
constexpr auto kModulusWords = [](auto&& visit, auto& s) {
  visit(s.modulus_stress[0]);
  visit(s.modulus_stress[1]);
};

std::string lines_of(const std::vector<StageRecord>& stages, const auto& list) {
  std::string text;
  for (const StageRecord& s : stages) {
    std::string line;
    const auto word = [&line](const auto& value) {
      using Value = std::remove_cvref_t<decltype(value)>;
      if (!line.empty()) line += " ";
      if constexpr (std::is_same_v<Value, std::string>)
        line += value;
      else if constexpr (NamedEnum<Value>)
        line += to_string(value);
      else
        line += fmt::format("{:.17g}", value);
    };
    list(word, s);
    text += line + "\n";
  }
  return text;
}

/// A text is the rest of its line. False where the line does not say what it should.
bool read_line(const std::string& line, StageRecord& stage, const auto& list) {
  std::istringstream words(line);
  bool good = true;
  const auto word = [&](auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, std::string>) {
      std::getline(words >> std::ws, value);
    } else if constexpr (NamedEnum<Value>) {
      std::string text;
      words >> text;
      const auto known = parse_enum<Value>(text);
      good = good && known;
      if (known) value = *known;
    } else {
      good = good && words >> value;
    }
  };
  list(word, stage);
  return good;
}

void write_stage_records(const h5::Group& group, const std::vector<StageRecord>& stages) {
  if (stages.empty()) return;
  group.attribute(kStageGroup, lines_of(stages, kStageWords));
  write_stage_axes(group, stages);
  if (std::ranges::any_of(stages, [](const StageRecord& s) { return s.modulus_stress[1] > 0.0; }))
    group.attribute(kModulusStresses, lines_of(stages, kModulusWords));
}

/// Files without them are those of tests that do not name any.
void read_modulus_stresses(const h5::Group& group, std::vector<StageRecord>& stages) {
  if (!group.has_attribute(kModulusStresses)) return;
  std::istringstream lines(group.text(kModulusStresses));
  for (StageRecord& s : stages) {
    std::string line;
    std::getline(lines, line);
    if (!read_line(line, s, kModulusWords))
      throw IoError(fmt::format("attribute '{}': two numbers for each of the stages are needed", kModulusStresses));
  }
}

std::vector<StageRecord> read_stage_records(const h5::Group& group) {
  std::vector<StageRecord> stages;
  if (!group.has_attribute(kStageGroup)) return stages;
  std::istringstream lines(group.text(kStageGroup));
  for (std::string line; std::getline(lines, line);)
    if (!read_line(line, stages.emplace_back(), kStageWords))
      throw IoError(fmt::format("attribute '{}': unknown kind in '{}'", kStageGroup, line));
  read_modulus_stresses(group, stages);
  read_stage_axes(group, stages);
  return stages;
}

void read_column(const h5::Group& group, MacroCurve& curve, const MacroColumn& c, std::size_t length) {
  curve.*c.values = read_numbers(group, c.name, c.unit, {length}, c.limits);
}

/// The law of cells, which is no form of a multi-contact law.
const std::string kCellForm = "cell";

constexpr const char* kLawForm = "law_form";

void write_origin(const h5::Group& group, const MacroCurve& curve) {
  if (!curve.start.bodies.empty()) {
    write_attributes(group, curve.start);
    if (curve.start.rolling.friction > 0.0) rolling_fields(AttributeWriter{group}, curve.start.rolling);
  }
  if (curve.law.hash.empty()) return;
  group.attribute(kLawForm, curve.law.form ? to_string(*curve.law.form) : kCellForm);
  const AttributeWriter write{group};
  law_fields([&](const char* name, const char*, const auto& value, const auto&...) { write(name, value); }, curve.law,
             curve.law.solid_fraction);
}

/// Either may be absent.
void read_origin(const h5::Group& group, MacroCurve& curve) {
  if (group.has_attribute("start")) {
    read_attributes(group, curve.start);
    const auto rolling = [&](const char* name, double& value, const Limits& limits, const auto&...) {
      if (group.has_attribute(name)) value = read_attribute(group, name, limits);
    };
    rolling_fields(rolling, curve.start.rolling);
  }
  if (!group.has_attribute(kLawForm)) return;
  if (group.text(kLawForm) != kCellForm) curve.law.form = read_word<LawForm>(group, kLawForm);
  const AttributeReader read{group};
  law_fields([&](const char* name, const char*, auto& value, const auto&... options) { read(name, value, options...); },
             curve.law, curve.law.solid_fraction);
}

}  // namespace

void fields(auto&& visit, Of<DensitySearch> auto& s) {
  visit("density_target", s.target, Limits{0.0, 1.0});
  visit("density_tolerance", s.tolerance, kNotNegative);
  visit("density_compaction_mu", s.friction, kNotNegative);
  visit("density_tries", s.tries, kNotNegative);
}

void write_density_search(const h5::Group& group, const std::optional<DensitySearch>& search) {
  if (search) write_attributes(group, *search);
}

std::optional<DensitySearch> read_density_search(const h5::Group& group) {
  if (!group.has_attribute("density_target")) return std::nullopt;
  DensitySearch search;
  read_attributes(group, search);
  return search;
}

std::string MacroColumn::header() const {
  return std::string_view(unit) == "1" ? name : fmt::format("{} [{}]", name, unit);
}

std::string MacroTensor::of(std::size_t component) const {
  return fmt::format("{}_{}", name, kTensorComponents[component]);
}

const MacroColumn& macro_column(std::vector<double> MacroCurve::*values) {
  for (const std::span<const MacroColumn> columns :
       {std::span<const MacroColumn>(kColumns), std::span<const MacroColumn>(kOptionalColumns)})
    for (const MacroColumn& column : columns)
      if (column.values == values) return column;
  throw std::out_of_range("a member of MacroCurve that is no column");
}

std::string identity_text(const LawIdentity& law) {
  if (!law.form && law.hash.empty()) return "not recorded";
  const auto told = [](const std::optional<double>& x) { return x ? fmt::format("{:g}", *x) : "(not known)"; };
  return fmt::format("{} law{}, for grains of nu = {}, mu = {}, used with E = {:g} Pa; hash {}",
                     law.form ? to_string(*law.form) : kCellForm,
                     law.solid_fraction > 0.0 ? fmt::format(" at solid fraction {:.4f}", law.solid_fraction) : "",
                     told(law.poisson_ratio), told(law.friction), law.youngs_modulus, law.hash);
}

namespace {

constexpr const char* kDrawnAxial = "drawn_axial";
constexpr const char* kPlaces = "places";

/// Rows of equal length; none: no data set.
void write_rows(const h5::Group& group, const char* name, const char* unit,
                const std::vector<std::vector<double>>& rows) {
  if (rows.empty()) return;
  std::vector<double> all;
  for (const std::vector<double>& row : rows) all.insert(all.end(), row.begin(), row.end());
  group.write(name, std::span<const double>(all), {rows.size(), rows.front().size()});
  group.attribute_of(name, "unit", unit);
}

/// `wanted`: rows and columns; 0: any number.
std::vector<std::vector<double>> read_rows(const h5::Group& group, const char* name,
                                           const std::array<std::size_t, 2>& wanted) {
  std::vector<std::vector<double>> rows;
  if (!group.has(name)) return rows;
  const h5::Shape shape = group.shape(name);
  const auto fits = [&](std::size_t k) { return wanted[k] == 0 || shape[k] == wanted[k]; };
  if (shape.size() != 2 || !fits(0) || !fits(1))
    throw IoError(fmt::format("data set '{}' has another shape than the curve that it belongs to", name));
  const std::vector<double> all = group.doubles(name);
  for (std::size_t r = 0; r < shape[0]; ++r) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(r * shape[1]);
    rows.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(shape[1]));
  }
  return rows;
}

/// What every point of a test in stages has: results of stages are taken from it.
void require_columns_of_stages(const MacroCurve& curve) {
  for (const auto column : {&MacroCurve::stage, &MacroCurve::strain_x, &MacroCurve::strain_y, &MacroCurve::strain_z,
                            &MacroCurve::stress_x, &MacroCurve::stress_y})
    if ((curve.*column).empty())
      throw IoError(
          fmt::format("data set '{}' is missing, which curves of tests in stages have", macro_column(column).name));
  const auto stages = static_cast<double>(curve.stages.size());
  for (const double stage : curve.stage)
    if (stage >= stages)
      throw IoError(fmt::format("data set 'stage' holds {}; there are {} stages, counted from 0", stage, stages));
}

}  // namespace

void write_macro_curve(const h5::Group& group, const MacroCurve& curve) {
  write_attributes(group, curve);
  write_stage_records(group, curve.stages);
  write_density_search(group, curve.density);
  write_origin(group, curve);
  for (const MacroColumn& c : kColumns) write_quantity(group, curve, c);
  for (const MacroColumn& c : kOptionalColumns) write_if_any(group, curve, c);
  write_tensors(group, curve);
  write_if_any(group, curve, kBodyForces);
  write_force_distribution(group, curve);
  write_rows(group, kDrawnAxial, "Pa", curve.drawn_axial);
  write_rows(group, kPlaces, "m", curve.places);
  if (curve.more.empty()) return;
  const h5::Group more = group.create("more");
  for (const auto& [name, values] : curve.more) more.write(name, std::span<const double>(values));
}

MacroCurve read_macro_curve(const h5::Group& group) {
  MacroCurve curve;
  read_attributes(group, curve);
  curve.engine = current_name(curve.engine);
  curve.stages = read_stage_records(group);
  curve.density = read_density_search(group);
  read_origin(group, curve);
  const std::size_t points = group.doubles(kColumns[0].name).size();
  for (const MacroColumn& c : kColumns) read_column(group, curve, c, points);
  for (const MacroColumn& c : kOptionalColumns)
    if (group.has(c.name)) read_column(group, curve, c, points);
  if (!curve.stages.empty() && points > 0) require_columns_of_stages(curve);
  read_tensors(group, curve, points);
  if (group.has("more")) {
    const h5::Group more = group.open("more");
    for (const std::string& name : more.children()) {
      curve.more[name] = more.doubles(name);
      if (curve.more[name].size() != points)
        throw IoError(
            fmt::format("data set 'more/{}' has {} values for {} points", name, curve.more[name].size(), points));
    }
  }
  curve.drawn_axial = read_rows(group, kDrawnAxial, {0, points});
  curve.places = read_rows(group, kPlaces, {points, place_numbers(curve.bodies)});
  if (group.has(kBodyForces.name)) read_column(group, curve, kBodyForces, group.doubles(kBodyForces.name).size());
  return curve;
}

void save_macro(const std::vector<MacroCurve>& curves, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kMacroFormat);
  const h5::Group group = root.create("curves");
  for (std::size_t k = 0; k < curves.size(); ++k)
    write_macro_curve(group.create(fmt::format("curve_{:06}", k)), curves[k]);
  write_provenance(root, provenance);
  file.commit();
}

std::vector<MacroCurve> load_macro(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kMacroFormat, path);
  const h5::Group group = root.open("curves");
  std::vector<MacroCurve> curves;
  for (const std::string& name : group.children()) {
    const h5::Group one = group.open(name);
    try {
      curves.push_back(read_macro_curve(one));
    } catch (const IoError& e) {
      const std::string text = e.what();
      throw IoError(text.starts_with(path) ? text : path + ": " + name + ": " + text);
    }
  }
  return curves;
}

}  // namespace softgrain
