#include "common/data/force_curve_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr std::size_t kLeastPoints = 5;     ///< a, b and delta, and something to judge them by
constexpr double kLargestSceneDelta = 0.9;  ///< largest Delta that is accepted; beyond it, unit or radius are wrong

}  // namespace

void CurveRows::read() {
  for (const CsvRow& row : file_.rows()) {
    if (!at_.repeat.empty() && !has_force(row)) continue;  // repeats may be of unequal length
    const std::size_t sample = sample_of(row);
    const double delta = overlap(row);
    if (delta < 0.0)
      add_before_touch(row, delta, sample);
    else if (is_rotated(row))
      add_tangential(row, delta, sample);
    else
      add_normal(row, delta, sample);
  }
  for (std::size_t k = 0; k < negative_.size(); ++k)
    if (negative_[k]) refuse_deepest_of_wrong_sign(out_.samples[k], *negative_[k]);
  leave_out_jitter();
  if (before_touch_ > 0)
    out_.remarks.push_back(fmt::format("{}: left out of the fit: {} before touch (negative overlap)", file_.path(),
                                       counted(before_touch_, "point")));
  if (dropped_ > 0)
    out_.remarks.push_back(fmt::format("{}: left out: {} of unloading", file_.path(), counted(dropped_, "point")));
  note_falls();
  require_enough();
}

double CurveRows::required(const CsvRow& row, std::size_t column, Unit unit) const {
  const auto value = file_.number(row, column, unit);
  if (!value)
    throw InputError(fmt::format("{}: column \"{}\": the value is missing; fill it in or remove the line",
                                 file_.where(row.line), file_.columns()[column].title));
  return *value;
}

double CurveRows::overlap(const CsvRow& row) const {
  const double radius = out_.spec.shell_radius;
  double delta = at_.delta != CurveLayout::none ? required(row, at_.delta, Unit::none)
                                                : required(row, at_.hn, Unit::length) / radius;
  if (at_.touch != 0.0) delta -= at_.touch / radius;
  if (std::isfinite(at_.machine_stiffness))
    if (const auto force = file_.number(row, at_.fn, Unit::force))
      delta -= (*force - at_.zero_force) / (at_.machine_stiffness * radius);
  if (delta > kLargestSceneDelta)
    throw InputError(
        fmt::format("{}: overlap of {:.4g} Rs (Rs = {:.4g} m): allowed are at most {}; check unit and radius",
                    file_.where(row.line), delta, out_.spec.shell_radius, kLargestSceneDelta));
  return delta;
}

bool CurveRows::has_force(const CsvRow& row) const { return file_.number(row, at_.fn, Unit::force).has_value(); }

bool CurveRows::is_rotated(const CsvRow& row) const {
  if (at_.ft == CurveLayout::none) return false;
  return file_.number(row, at_.ft, Unit::force).has_value() && file_.number(row, at_.ht, Unit::length).has_value();
}

/// The overlap of one turn jitters from reading to reading: those that differ by no more than kJitter of it belong to
/// the reading of the normal force before them, or else to the turned row before them. Where turns follow each other
/// without a reading between them, an angle that comes again begins the next one.
void CurveRows::add_tangential(const CsvRow& row, double delta, std::size_t sample) {
  constexpr double kJitter = 1e-3;
  TangentialPoint p;
  p.angle_deg = required(row, at_.ht, Unit::length) * 180.0 / (std::numbers::pi * out_.spec.shell_radius);
  p.force_parallel = required(row, at_.ft, Unit::force);
  p.converged = true;
  Turn& turn = turns_[sample];
  const bool again = std::find(turn.angles.begin(), turn.angles.end(), p.angle_deg) != turn.angles.end();
  const bool near = std::abs(delta - turn.delta) <= kJitter * turn.delta;
  if (delta != turn.delta && !(near && (turn.after_reading || !again))) turn = {delta, false, {}};
  turn.angles.push_back(p.angle_deg);
  p.delta = turn.delta;
  out_.samples[sample].tangential.push_back(p);
}

std::size_t CurveRows::sample_of(const CsvRow& row) {
  const bool all = at_.sample == CurveLayout::none;
  const std::string file =
      at_.sample_name.empty() ? std::filesystem::path(file_.path()).stem().string() : at_.sample_name;
  std::string name = all ? file : row.cells[at_.sample];
  if (name.empty())
    throw InputError(fmt::format("{}: column \"{}\": the value is missing", file_.where(row.line),
                                 file_.columns()[at_.sample].title));
  if (!at_.repeat.empty()) name += " " + at_.repeat;
  const auto [known, is_new] = index_.try_emplace(name, out_.samples.size());
  if (is_new) {
    out_.samples.push_back({name, {}, {}, {}, {}});
    lines_.emplace_back();
    turns_.emplace_back();
    negative_.emplace_back();
  }
  return known->second;
}

/// Such readings say where the zero of the force is.
void CurveRows::add_before_touch(const CsvRow& row, double delta, std::size_t sample) {
  ++before_touch_;
  const auto said = file_.number(row, at_.fn, Unit::force);
  const double force = said ? *said - at_.zero_force : std::numeric_limits<double>::quiet_NaN();
  if (!out_.samples[sample].normal.empty()) negative_[sample] = Negative{row.line, delta, force};
  if (said) out_.samples[sample].before_touch.push_back(force);
}

void CurveRows::add_normal(const CsvRow& row, double delta, std::size_t index) {
  ForceCurve& sample = out_.samples[index];
  ForcePoint p;
  p.delta = delta;
  p.force = required(row, at_.fn, Unit::force) - at_.zero_force;
  if (at_.error != CurveLayout::none) {
    p.error = required(row, at_.error, Unit::force);
    if (p.error < 0.0)
      throw InputError(fmt::format("{}: column \"{}\": {} must not be negative", file_.where(row.line),
                                   file_.columns()[at_.error].title, row.cells[at_.error]));
  }
  const std::optional<Negative> negative = std::exchange(negative_[index], std::nullopt);
  if (returns(row, delta, sample)) {
    if (options_.unloading == Unloading::fit) return add_returned(p, sample);
    if (options_.unloading == Unloading::drop) {
      ++dropped_;
      return;
    }
    throw InputError(fmt::format(
        "{}: sample \"{}\": the overlap does not rise (Delta = {:.6g} after {:.6g}); a law is fitted to the loading "
        "branch: remove unloading and repeated points, or leave them out with --set unloading=drop (unloading=fit fits "
        "a law to them)",
        file_.where(row.line), sample.name, delta, sample.normal.back().delta));
  }
  if (negative) refuse_wrong_sign(sample.name, *negative, sample.normal.back().delta, delta);
  add_stiffness(row, delta, sample);
  sample.normal.push_back(p);
  lines_[index].push_back(row.line);
  turns_[index] = {delta, true, {}};
}

/// An overlap that would rise with the others but for its sign. It would count as a reading before touch, whose force
/// says where the zero is. Jitter of the displacement around touch is smaller.
void CurveRows::refuse_wrong_sign(const std::string& sample, const Negative& reading, double before,
                                  double after) const {
  constexpr double kLeastOverlap = 0.01;
  const double overlap = -reading.delta;
  if (overlap < kLeastOverlap || overlap <= before || overlap >= after) return;
  throw InputError(fmt::format(
      "{}: sample \"{}\": Delta = {:.6g} stands between {:.6g} and {:.6g}: is the sign wrong? Negative overlaps are "
      "readings before touch",
      file_.where(reading.line), sample, reading.delta, before, after));
}

/// Such a reading behind all others would be the deepest. Who moves away there measures next to no force.
void CurveRows::refuse_deepest_of_wrong_sign(const ForceCurve& sample, const Negative& reading) const {
  const ForcePoint& last = sample.normal.back();
  if (!(-reading.delta > last.delta && last.force > 0.0 && reading.force > last.force)) return;
  throw InputError(fmt::format(
      "{}: sample \"{}\": Delta = {:.6g} has a force of {:.6g} N, more than {:.6g} N at Delta = {:.6g} before: is the "
      "sign wrong? Negative overlaps are readings before touch",
      file_.where(reading.line), sample.name, reading.delta, reading.force, last.force, last.delta));
}

/// Whether a reading belongs to unloading or reloading: as its branch says, else by its overlap.
bool CurveRows::returns(const CsvRow& row, double delta, const ForceCurve& sample) const {
  const bool falls = !sample.normal.empty() && delta <= sample.normal.back().delta;
  if (at_.branch == CurveLayout::none) return falls;
  const std::string& word = row.cells[at_.branch];
  if (word == "loading" && !falls) return false;
  if ((word == "unloading" || word == "reloading") && falls) return true;
  const bool known = word == "loading" || word == "unloading" || word == "reloading";
  throw InputError(fmt::format(
      "{}: column \"{}\": {}", file_.where(row.line), file_.columns()[at_.branch].title,
      !known              ? fmt::format("\"{}\": must be loading, unloading or reloading", word)
      : word == "loading" ? fmt::format("the overlap of a loading reading must rise (Delta = {:.6g} after {:.6g})",
                                        delta, sample.normal.back().delta)
                          : "unloading and reloading lie below the largest overlap so far; beyond it loading goes on"));
}

void CurveRows::add_returned(const ForcePoint& point, ForceCurve& sample) {
  const ForcePoint& deepest = sample.normal.back();
  if (sample.unloaded.empty() || sample.unloaded.back().deepest != deepest.delta)
    sample.unloaded.push_back({deepest.delta, deepest.force, {}});
  sample.unloaded.back().points.push_back(point);
}

/// Readings that fell back a little are jitter of the displacement, no unloading.
void CurveRows::leave_out_jitter() {
  constexpr std::size_t kLeastReadings = 3;
  constexpr double kLeastDepth = 0.05;  // of the overlap where it begins
  std::size_t left_out = 0;
  for (ForceCurve& s : out_.samples)
    std::erase_if(s.unloaded, [&](const UnloadedCurve& u) {
      const auto least = std::ranges::min_element(u.points, {}, &ForcePoint::delta);
      const bool kept = at_.branch != CurveLayout::none ||
                        (u.points.size() >= kLeastReadings && least->delta < (1.0 - kLeastDepth) * u.deepest);
      left_out += kept ? 0 : u.points.size();
      return !kept;
    });
  if (left_out > 0)
    out_.remarks.push_back(fmt::format(
        "{}: {} readings whose overlap falls back by less than {:g} %, or fewer than {} in a row, are left out",
        file_.path(), left_out, 100.0 * kLeastDepth, kLeastReadings));
}

/// kt as given: the two rotations whose slope it is.
void CurveRows::add_stiffness(const CsvRow& row, double delta, ForceCurve& sample) const {
  if (at_.kt == CurveLayout::none) return;
  const auto kt = file_.number(row, at_.kt, Unit::stiffness);
  if (!kt) return;
  for (const double angle : {-options_.initial_angle_deg, options_.initial_angle_deg}) {
    TangentialPoint p;
    p.delta = delta;
    p.angle_deg = angle;
    p.force_parallel = *kt * std::numbers::pi * out_.spec.shell_radius * angle / 180.0;
    p.converged = true;
    sample.tangential.push_back(p);
  }
}

/// A force that falls is no reason to stop, but one to look at the data.
void CurveRows::note_falls() {
  constexpr double kShare = 0.1;  // of the largest force of the sample
  std::string first;
  int count = 0;
  for (std::size_t s = 0; s < out_.samples.size(); ++s) {
    const std::vector<ForcePoint>& points = out_.samples[s].normal;
    double largest = 0.0;
    for (const ForcePoint& p : points) largest = std::max(largest, p.force);
    for (std::size_t k = 1; k < points.size(); ++k) {
      if (!(points[k].force < points[k - 1].force - kShare * largest)) continue;
      if (++count == 1)
        first = fmt::format("{}: sample \"{}\": the force falls from {:.4g} to {:.4g} N while the overlap rises",
                            file_.where(lines_[s][k]), out_.samples[s].name, points[k - 1].force, points[k].force);
    }
  }
  if (count > 0) out_.remarks.push_back(first + (count > 1 ? fmt::format(" (and {} more times)", count - 1) : ""));
}

void CurveRows::require_enough() const {
  std::size_t most = 0;
  for (const ForceCurve& s : out_.samples) most = std::max(most, s.normal.size());
  if (most < kLeastPoints)
    throw InputError(fmt::format(
        "{}:{}: too few points: {} of the normal force in the longest sample, at least {} are needed", file_.path(),
        file_.rows().empty() ? file_.header_line() : file_.rows().back().line, most, kLeastPoints));
}

}  // namespace softgrain
