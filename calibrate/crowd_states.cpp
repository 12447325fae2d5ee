#include "calibrate/crowd_states.h"

#include <algorithm>
#include <cmath>

#include "common/data/slide_direction.h"

namespace softgrain {

namespace {

/// Mean and standard error of a weighted sample; weights count repetitions.
class Mean {
 public:
  void add(double x, double weight) {
    n_ += weight;
    sum_ += weight * x;
    square_ += weight * x * x;
  }
  [[nodiscard]] double mean() const { return sum_ / n_; }
  [[nodiscard]] double error() const {
    const double m = mean();
    return n_ > 1.0 ? std::sqrt(std::max(square_ / n_ - m * m, 0.0) / (n_ - 1.0)) : 0.0;
  }

 private:
  double n_ = 0.0;
  double sum_ = 0.0;
  double square_ = 0.0;
};

struct Sums {
  std::vector<Mean> overlap;
  std::vector<Mean> force;
  Mean tangential;
};

/// What holds the first neighbour back on its slide, over E Rs^2.
double against_slide(const CrowdPoint& point, const CrowdConfiguration& configuration) {
  if (configuration.partners.empty()) return 0.0;
  return -dot(point.tangential.front(), slide_direction(configuration.partners.front().direction));
}

void average(const CrowdMeasurements& data, std::size_t configuration, const std::vector<double>& weight,
             CrowdStates& out) {
  const std::size_t neighbours = out.configuration->partners.size();
  std::vector<Sums> sums;
  for (const CrowdRun& run : data.runs) {
    if (run.configuration != static_cast<std::int64_t>(configuration)) continue;
    const double w = weight.empty() ? 1.0 : weight[static_cast<std::size_t>(run.packing)];
    if (!(w > 0.0)) continue;
    for (std::size_t k = 0; k < run.points.size(); ++k) {
      if (k >= sums.size()) {
        sums.push_back({std::vector<Mean>(neighbours), std::vector<Mean>(neighbours), {}});
        out.states.emplace_back();
      }
      const CrowdPoint& point = run.points[k];
      if (!point.converged) continue;
      for (std::size_t j = 0; j < neighbours; ++j) {
        sums[k].overlap[j].add(point.overlap[j], w);
        sums[k].force[j].add(point.normal[j], w);
      }
      sums[k].tangential.add(against_slide(point, *out.configuration), w);
      CrowdState& state = out.states[k];
      state.stage = point.stage;
      state.slide = point.slide;
      state.max_overlap = std::max(state.max_overlap, point.max_overlap);
      ++state.packings;
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k) {
    CrowdState& state = out.states[k];
    if (state.packings == 0) continue;
    for (std::size_t j = 0; j < neighbours; ++j) {
      state.overlap.push_back(sums[k].overlap[j].mean());
      state.mean.push_back(sums[k].force[j].mean());
      state.error.push_back(sums[k].force[j].error());
    }
    state.tangential = sums[k].tangential.mean();
    state.tangential_error = sums[k].tangential.error();
  }
  std::erase_if(out.states, [](const CrowdState& s) { return s.packings < 2; });
}

}  // namespace

bool CrowdStates::all_of(PartnerKind kind) const {
  return std::all_of(configuration->partners.begin(), configuration->partners.end(),
                     [kind](const CrowdPartner& p) { return p.kind == kind; });
}

double CrowdStates::largest_force() const {
  double largest = 0.0;
  for (const CrowdState& s : states)
    for (const double f : s.mean) largest = std::max(largest, f);
  return largest;
}

std::vector<CrowdStates> average_states(const CrowdMeasurements& data, const std::vector<double>& weight) {
  std::vector<CrowdStates> out(data.configurations.size());
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c].configuration = &data.configurations[c];
    average(data, c, weight, out[c]);
  }
  return out;
}

}  // namespace softgrain
