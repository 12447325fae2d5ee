// Pieces of summary.json that several commands write, and the remarks that go with them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/io/provenance.h"

namespace softgrain {

/// {count, solid_fraction, exponent, grains, ...}: means over packings, standard deviations beside them.
nlohmann::json packings_json(const Measurements& data);

/// {points, loop_passes, contact_evaluations, seconds, relaxation} of one relaxation; also per point.
nlohmann::json measurement_json(const Measurements& data, const std::string& relaxation);

/// Per pair kind and Delta: mean force [N], its standard error, sample deviation and number of packings (converged
/// points only).
nlohmann::json forces_json(const Measurements& data, const std::string& relaxation);

/// Per Delta: both means, ratio and its standard error, and loop passes per point of both relaxations; for kt too.
nlohmann::json relaxations_json(const Measurements& data, const std::string& reference, const std::string& candidate);

/// {bodies, loop_passes, contact_evaluations, seconds, ...} summed over the samples of one engine.
nlohmann::json macro_json(const std::vector<MacroCurve>& curves, const std::string& engine);

/// {form, solid_fraction (null of a card), E, nu, mu, hash} of the law of a run.
nlohmann::json identity_json(const LawIdentity& law);

/// Sentences about what must not be overlooked: points that did not converge, curves that are not usable.
std::vector<std::string> measurement_remarks(const Measurements& data);
/// Whether every run with a law, and every shelled twin, ends under stress: else nothing can be said relative to it.
bool all_carry_stress(const std::vector<MacroCurve>& curves);

std::vector<std::string> macro_remarks(const std::vector<MacroCurve>& curves);

/// Provenance as it goes into a summary.
nlohmann::json provenance_json(const Provenance& provenance);

}  // namespace softgrain
