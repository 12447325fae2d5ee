#include "pipelines/law/law_library.h"

#include <fmt/format.h>
#include <gsl/gsl_qrng.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "calibrate/gaussian_process.h"
#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "pipelines/law/law_library_numbers.h"
#include "pipelines/law/law_library_predict.h"

namespace softgrain {

namespace {

/// How far beyond the convex hull of the measured materials a library serves, over the ranges of the variables. The
/// errors of leaving one out hold there: materials at corners are predicted from farther away.
constexpr double kReachOfHull = 0.1;

double on_axis(const LibraryVariable& v, double x) {
  if (v.axis == LibraryAxis::logarithm) return std::log(x);
  return v.axis == LibraryAxis::friction ? on_friction_axis(x) : x;
}

/// The variable again.
double off_axis(const LibraryVariable& v, double y) {
  if (v.axis == LibraryAxis::logarithm) return std::exp(y);
  return v.axis == LibraryAxis::friction ? kHalfFriction * y / (1.0 - y) : y;
}

std::vector<double> coordinates(const LibraryPoint& at) {
  std::vector<double> out;
  for (const LibraryVariable& v : kLibraryVariables) out.push_back(on_axis(v, at.*v.value));
  return out;
}

UnitBox box_of(const LawLibrary& library) {
  std::vector<std::vector<double>> rows;
  for (const LibraryMaterial& m : library.materials) rows.push_back(coordinates(m.at));
  return UnitBox(rows);
}

/// Solid fractions that are inside with all else as in `at`; empty text: none.
std::string fractions_inside(const UnitBox& box, LibraryPoint at) {
  constexpr double kStep = 0.005;
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (double f = box.low(3); f <= box.high(3) + 0.5 * kStep; f += kStep) {
    at.solid_fraction = f;
    if (distance_from_hull(box.points(), box(coordinates(at))) > kReachOfHull) continue;
    low = std::min(low, f);
    high = std::max(high, f);
  }
  return high > 0.0 ? fmt::format("with the other three, solid fractions from {:.3f} to {:.3f} are", low, high)
                    : "the combination of the other three is not";
}

void require_inside(const UnitBox& box, const LibraryPoint& at) {
  std::string wrong;
  const std::vector<double> u = box(coordinates(at));
  for (std::size_t a = 0; a < u.size(); ++a) {
    const LibraryVariable& v = kLibraryVariables[a];
    const auto real = [&](double y) { return off_axis(v, y); };
    if (const std::string why = outside_text(v, real(box.low(a)), real(box.high(a)), at.*v.value, u[a]); !why.empty())
      append_part(wrong, why);
  }
  if (!wrong.empty()) throw InputError("law library: " + wrong);
  if (distance_from_hull(box.points(), u) <= kReachOfHull) return;
  throw InputError(fmt::format("law library: {}: no such combination was measured; {} inside", point_text(at),
                               fractions_inside(box, at)));
}

/// Points of the box that are served, spread evenly.
std::vector<std::vector<double>> served_points(const UnitBox& box) {
  constexpr std::size_t kPoints = 256;
  constexpr std::size_t kMostTried = 100 * kPoints;
  const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> sequence(
      gsl_qrng_alloc(gsl_qrng_sobol, static_cast<unsigned>(kLibraryVariables.size())), &gsl_qrng_free);
  std::vector<std::vector<double>> out;
  std::vector<double> u(kLibraryVariables.size());
  for (std::size_t k = 0; k < kMostTried && out.size() < kPoints; ++k) {
    gsl_qrng_get(sequence.get(), u.data());
    for (std::size_t a = 0; a < u.size(); ++a)
      if (!(box.high(a) > box.low(a))) u[a] = 0.5;
    if (distance_from_hull(box.points(), u) <= kReachOfHull) out.push_back(u);
  }
  return out;
}

double mean_square_deviation(const GaussianProcess& process, const std::vector<std::vector<double>>& points) {
  double sum = 0.0;
  for (const std::vector<double>& u : points) {
    const double deviation = process.at(u).deviation;
    sum += deviation * deviation;
  }
  return sum / static_cast<double>(points.size());
}

/// Points where a law can be determined: with an onset, its deviation added, no deeper than the deepest that was. One
/// that was measured where none could (mu = 0.147, exponent 3.54, ratio 9.2, solid fraction 0.612) had its onset beyond
/// the largest overlap.
std::vector<std::vector<double>> measurable_points(const LawLibrary& library, const UnitBox& box,
                                                   const std::vector<std::vector<double>>& points) {
  const std::vector<std::string> names = library.names();
  const auto k = static_cast<std::size_t>(std::ranges::find(names, kOnsetNumber) - names.begin());
  const KnownNumber onset = known_number(library, box, k);
  const double deepest = std::ranges::max(onset.values);
  const std::vector<ProcessValue> predicted = predicted_number(library.checks[k], onset, points);
  std::vector<std::vector<double>> out;
  for (std::size_t c = 0; c < points.size(); ++c)
    if (predicted[c].mean + predicted[c].deviation <= deepest) out.push_back(points[c]);
  return out;
}

/// The candidate whose measurement leaves the least mean square over `points`, and what it leaves.
std::pair<std::size_t, double> most_telling(const GaussianProcess& process, double error,
                                            const std::vector<std::vector<double>>& candidates,
                                            const std::vector<std::vector<double>>& points) {
  std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    GaussianProcess then = process;
    then.expect(candidates[c], error);
    if (const double left = mean_square_deviation(then, points); left < best.second) best = {c, left};
  }
  return best;
}

LibraryPoint material_at(const UnitBox& box, const std::vector<double>& u) {
  const std::vector<double> row = box.row(u);
  LibraryPoint out;
  for (std::size_t a = 0; a < row.size(); ++a) out.*kLibraryVariables[a].value = off_axis(kLibraryVariables[a], row[a]);
  return out;
}

/// Positions to try per grain for the solid fraction of this point, a deviation more than expected: a packing that
/// comes out denser has a law too, a looser one often none.
double trials_at(const LawLibrary& library, const UnitBox& box, const std::vector<double>& u) {
  const std::vector<std::string> names = library.names();
  const auto k = static_cast<std::size_t>(std::ranges::find(names, kTrialsNumber) - names.begin());
  if (k == names.size() || library.checks[k].materials == 0) return std::nan("");
  const ProcessValue trials = predicted_number(library.checks[k], known_number(library, box, k), {u}).front();
  return std::exp(trials.mean + trials.deviation);
}

}  // namespace

NextMaterials next_materials(const LawLibrary& library, int count) {
  if (library.checks.size() != library.names().size()) throw InputError("law library: it is not checked");
  if (library.checks.front().by_mean())
    throw InputError(
        "law library: the force of one plane is answered by the mean of all materials, which predicts it as well: none "
        "narrows it more than another");
  const UnitBox box = box_of(library);
  const KnownNumber force = known_number(library, box, 0);
  GaussianProcess process(force.points, force.values, force.errors);
  const double error = quantile(force.errors, 0.5);
  const double widened = library.checks.front().factor;
  const std::vector<std::vector<double>> points = served_points(box);
  const std::vector<std::vector<double>> candidates = measurable_points(library, box, points);
  if (candidates.empty()) throw InputError("law library: its materials lie in too small a part of their ranges");
  NextMaterials out{widened * std::sqrt(mean_square_deviation(process, points)), {}};
  for (int k = 0; k < count; ++k) {
    const auto [best, left] = most_telling(process, error, candidates, points);
    const std::vector<double>& u = candidates[best];
    out.materials.push_back({material_at(box, u), trials_at(library, box, u), widened * process.at(u).deviation,
                             widened * std::sqrt(left)});
    process.expect(u, error);
  }
  return out;
}

std::string point_text(const LibraryPoint& at) {
  return join_text(kLibraryVariables, ", ",
                   [&](const LibraryVariable& v) { return fmt::format("{} = {:.4g}", v.name, at.*v.value); });
}

LibraryAnswer ask_library(const LawLibrary& library, const LibraryPoint& at) {
  if (library.checks.size() != library.names().size()) throw InputError("law library: it is not checked");
  const UnitBox box = box_of(library);
  require_inside(box, at);
  LibraryAnswer out = answer_at(library, library.checks, box, box(coordinates(at)));
  out.at = at;
  return out;
}

std::vector<LibraryCheck> check_library(const LawLibrary& library) { return check_numbers(library, box_of(library)); }

std::string means_text(const LibraryAnswer& answer) {
  if (answer.by_mean.empty()) return "";
  return "mean and scatter of all materials, which predict no better: " + join_text(answer.by_mean, "; ");
}

std::string nearest_text(const LawLibrary& library, const LibraryAnswer& answer) {
  return fmt::format("nearest measured material: {}; distance {:.2f} (1: the whole measured range of one variable)",
                     point_text(library.materials[answer.nearest].at), answer.distance);
}

}  // namespace softgrain
