#include "pipelines/kinds/law_table/multi_contact_stage.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

constexpr int kCoarsePoints = 16;
constexpr double kOnsetForce = 1e-3;  ///< force at the onset over that at the end of the stage
constexpr double kFirstSlide = 0.01;  ///< first recorded share of the slide

std::vector<double> overlaps_before(const MultiContactConfiguration& c, std::size_t stage) {
  return stage > 0 ? c.stages[stage - 1].overlap : std::vector<double>(c.partners.size(), 0.0);
}

/// Mean force on the neighbours of the centre that the stage moves.
double moved_force(const MultiContactConfiguration& c, const MultiContactPoint& point) {
  const auto stage = static_cast<std::size_t>(point.stage);
  const std::vector<double> before = overlaps_before(c, stage);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < c.touching(); ++k) {
    if (before[k] == c.stages[stage].overlap[k]) continue;
    sum += point.normal[k];
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// `count` values, the last one `to`, evenly after `from`.
void append_evenly(std::vector<double>& shares, double from, double to, std::int64_t count) {
  for (std::int64_t k = 1; k <= count; ++k)
    shares.push_back(k == count ? to : from + (to - from) * static_cast<double>(k) / static_cast<double>(count));
}

/// Drops what follows another value too closely; the end stays.
std::vector<double> thinned(const std::vector<double>& shares, double closest) {
  std::vector<double> out;
  for (const double s : shares)
    if (s >= closest * (1.0 - 1e-9) && (out.empty() || s - out.back() >= closest * (1.0 - 1e-9))) out.push_back(s);
  if (!out.empty() && out.back() != shares.back()) out.pop_back();
  if (out.empty() || out.back() != shares.back()) out.push_back(shares.back());
  return out;
}

std::vector<double> loading_shares(double onset, std::int64_t points) {
  std::vector<double> shares;
  const double low = 0.5 * onset;
  const double high = 1.5 * onset;
  if (high >= 1.0) {
    append_evenly(shares, onset < 1.0 ? low : 0.0, 1.0, points);
    return shares;
  }
  append_evenly(shares, low, high, points / 2);
  append_evenly(shares, high, 1.0, points - points / 2);
  return shares;
}

std::vector<double> slide_shares(std::int64_t points) {
  std::vector<double> shares;
  for (std::int64_t k = 0; k < points; ++k)
    shares.push_back(std::pow(kFirstSlide, 1.0 - static_cast<double>(k) / static_cast<double>(points - 1)));
  shares.back() = 1.0;
  return shares;
}

/// Largest change of an overlap [Rs].
double length_of(const MultiContactConfiguration& c, std::size_t stage) {
  const std::vector<double> before = overlaps_before(c, stage);
  double most = 0.0;
  for (std::size_t k = 0; k < before.size(); ++k)
    most = std::max(most, std::abs(c.stages[stage].overlap[k] - before[k]));
  return most;
}

}  // namespace

MultiContactConfiguration loading_part(const MultiContactConfiguration& configuration) {
  MultiContactConfiguration c = configuration;
  c.name = "pilot";
  c.held_out = false;
  MultiContactStage& first = c.stages.front();
  if (first.move == MultiContactMove::oblique) first = {MultiContactMove::load, first.overlap};
  const auto other =
      std::find_if(c.stages.begin(), c.stages.end(), [](const auto& s) { return s.move != MultiContactMove::load; });
  c.stages.erase(other, c.stages.end());
  return c;
}

MultiContactPlan coarse_plan(const MultiContactConfiguration& configuration) {
  std::vector<double> shares;
  append_evenly(shares, 0.0, 1.0, kCoarsePoints);
  return MultiContactPlan(configuration.stages.size(), shares);
}

std::vector<double> onset_shares(const MultiContactConfiguration& configuration,
                                 const std::vector<MultiContactRun>& runs) {
  std::vector<std::vector<double>> force(configuration.stages.size(), std::vector<double>(kCoarsePoints, 0.0));
  for (const MultiContactRun& run : runs)
    for (std::size_t k = 0; k < run.points.size(); ++k)
      force[k / kCoarsePoints][k % kCoarsePoints] += moved_force(configuration, run.points[k]);
  std::vector<double> onsets;
  for (const std::vector<double>& f : force) {
    const auto first = std::find_if(f.begin(), f.end(), [&](double x) { return x > kOnsetForce * f.back(); });
    const auto index = first == f.end() ? kCoarsePoints - 1 : first - f.begin();
    onsets.push_back(static_cast<double>(index + 1) / kCoarsePoints);
  }
  return onsets;
}

MultiContactPlan recording_plan(const MultiContactConfiguration& configuration, const std::vector<double>& onsets,
                                std::int64_t points, double increment) {
  MultiContactPlan plan;
  for (std::size_t k = 0; k < configuration.stages.size(); ++k) {
    if (configuration.stages[k].move == MultiContactMove::slide ||
        configuration.stages[k].move == MultiContactMove::roll) {
      plan.push_back(slide_shares(points));
      continue;
    }
    std::vector<double> shares;
    if (k < onsets.size())
      shares = loading_shares(onsets[k], points);
    else
      append_evenly(shares, 0.0, 1.0, points);
    plan.push_back(thinned(shares, increment / length_of(configuration, k)));
  }
  return plan;
}

}  // namespace softgrain
