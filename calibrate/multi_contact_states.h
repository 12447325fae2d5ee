// Means over packings of what a multi-contact measurement recorded: the numbers that multi-contact laws are fitted to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/data/multi_contact_law.h"

namespace softgrain {

/// One recorded state of a configuration, averaged over packings. Forces over E Rs^2.
struct MultiContactState {
  std::vector<double> overlap;  ///< h/Rs per neighbour, planes around soft ones included
  std::vector<double> mean;     ///< normal force per neighbour of the centre
  std::vector<double> error;    ///< its standard error
  double tangential = 0.0;      ///< force that holds the first neighbour back on its slide
  double slide = 0.0;           ///< slide of the first neighbour [Rs]
  double moment = 0.0;          ///< moment that holds the first neighbour back from rolling on, over E Rs^3
  double roll = 0.0;            ///< roll of the first neighbour [Rs]
  double max_overlap = 0.0;     ///< largest overlap of grains over all packings
  std::int64_t stage = 0;
  std::int64_t packings = 0;  ///< number of converged packings
};

/// The states of one configuration, in the order of the path.
struct MultiContactStates {
  const MultiContactConfiguration* configuration = nullptr;  ///< configuration in the data that the states come from
  std::vector<MultiContactState> states;
  MultiContactUse use = MultiContactUse::fitted;
  bool for_multi_contact = true;  ///< whether multi-contact laws may be fitted to it, too

  [[nodiscard]] bool all_of(PartnerKind kind) const;
  [[nodiscard]] double largest_force() const;  ///< mean normal force of a neighbour, over all states
};

/// Averages every configuration and says what it is used for: of all that begin with the same loading (neighbours and
/// ratios of their overlaps, stage by stage up to the first slide, roll or retreat) only the deepest is fitted, or none
/// when plain loading is held out. `data` must outlive what is returned. Bodies of a scene are never held: where there
/// are kEnoughFree loadings of planes around a free shell, multi-contact laws are fitted to free shells alone, and the
/// pair law, which has but one neighbour, to held ones; else all laws to held ones. `weight[p]` says how often packing
/// p counts (a bootstrap replicate); empty: once each. States with fewer than two converged packings are left out.
inline constexpr int kEnoughFree = 4;
std::vector<MultiContactStates> average_states(const MultiContactMeasurements& data,
                                               const std::vector<double>& weight = {});
std::vector<MultiContactStates> average_states(MultiContactMeasurements&& data,
                                               const std::vector<double>& weight = {}) = delete;

}  // namespace softgrain
