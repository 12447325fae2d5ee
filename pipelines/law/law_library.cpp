#include "pipelines/law/law_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/gaussian_process.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "pipelines/law/law_library_predict.h"

namespace softgrain {

namespace {

/// How far beyond the convex hull of the measured materials a library serves, over the ranges of the variables. The
/// errors of leaving one out hold there: materials at corners are predicted from farther away.
constexpr double kReachOfHull = 0.1;

double on_axis(const LibraryVariable& v, double x) { return v.logarithm ? std::log(x) : x; }

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
    const auto real = [&](double x) { return v.logarithm ? std::exp(x) : x; };
    if (const std::string why = outside_text(v, real(box.low(a)), real(box.high(a)), at.*v.value, u[a]); !why.empty())
      append_part(wrong, why);
  }
  if (!wrong.empty()) throw InputError("law library: " + wrong);
  if (distance_from_hull(box.points(), u) <= kReachOfHull) return;
  throw InputError(fmt::format("law library: {}: no such combination was measured; {} inside", point_text(at),
                               fractions_inside(box, at)));
}

}  // namespace

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
