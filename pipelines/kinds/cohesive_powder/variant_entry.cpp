#include "pipelines/kinds/cohesive_powder/variant_entry.h"

#include <cmath>

#include "pipelines/run/run_context.h"
#include "pipelines/run/sample_statistics.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// The number at the path, null where there is none.
json number_at(const json& sample, const std::string& path) {
  const json::json_pointer pointer(path);
  if (!sample.contains(pointer)) return nullptr;
  const json& value = sample.at(pointer);
  return value.is_number() ? value : json(nullptr);
}

/// Shares beyond the last that is given are 0.
json share_at(const json& sample, const std::string& path) {
  const bool known = sample.contains("shares") && sample["shares"].is_array();
  return known && !sample["shares"].empty() && number_at(sample, path).is_null() ? json(0.0) : number_at(sample, path);
}

/// A fit that is not usable must not count in a mean.
bool fit_usable(const json& sample) {
  const json::json_pointer pointer("/scattering/usable");
  return sample.contains(pointer) && sample.at(pointer) == true;
}

json scalars_of(const json& sample) {
  json out = json::object();
  for (const auto& [name, path] : kPowderQuantities) {
    const std::string where = path;
    if (where.starts_with("/scattering/") && !fit_usable(sample)) continue;
    out[name] = where.starts_with("/shares/") ? share_at(sample, where) : number_at(sample, where);
  }
  return out;
}

std::vector<json> usable_scalars(const json& summary) {
  std::vector<json> out;
  if (!summary.contains("samples")) return out;
  for (std::size_t k = 0; k < summary["samples"].size(); ++k) {
    json sample = summary["samples"][k];
    if (sample.value("usable", false) == false) continue;
    sample["seconds"] = number_at(summary, "/seconds/" + std::to_string(k));
    out.push_back(scalars_of(sample));
  }
  return out;
}

/// Statistics with the standard error of the mean; without samples of it, a quantity is left out.
json values_of(const std::vector<json>& scalars) {
  const json statistics = sample_statistics(scalars);
  json out = json::object();
  for (const auto& [name, s] : statistics.items()) {
    if (s["mean"].is_null()) continue;
    out[name] = s;
    out[name]["error"] = nullptr;
    if (s["deviation"].is_number())
      out[name]["error"] = s["deviation"].get<double>() / std::sqrt(s["samples"].get<double>());
  }
  return out;
}

json published_json(const std::vector<PublishedValue>& values) {
  json out = json::object();
  for (const PublishedValue& v : values)
    out[v.quantity] = {{"value", v.value}, {"error", v.error ? json(*v.error) : json(nullptr)}};
  return out;
}

/// Ours minus the published. One side's error alone would flatter or blame, so it takes both for the difference in
/// errors.
json differences(const json& values, const json& published) {
  json out = json::object();
  for (const auto& [name, theirs] : published.items()) {
    if (!values.contains(name)) continue;
    const double difference = values[name]["mean"].get<double>() - theirs["value"].get<double>();
    out[name] = {{"value", difference}, {"in_errors", nullptr}};
    const json& ours = values[name]["error"];
    if (!ours.is_number() || !theirs["error"].is_number()) continue;
    const double combined = std::hypot(ours.get<double>(), theirs["error"].get<double>());
    if (combined > 0.0) out[name]["in_errors"] = difference / combined;
  }
  return out;
}

std::string reason_of(const json& summary) {
  if (has_status(summary, RunStatus::good) || !summary.contains("remarks")) return "";
  std::string out;
  for (const json& remark : summary["remarks"]) {
    const std::string text = remark.get<std::string>();
    const bool tells = !summary.contains("samples") || text.find("not at rest") != std::string::npos;
    if (tells) out += (out.empty() ? "" : "; ") + text;
  }
  return out;
}

}  // namespace

json powder_variant_entry(const PowderVariant& variant, const json& summary) {
  const bool ran = summary.is_object();
  const std::vector<json> scalars = ran ? usable_scalars(summary) : std::vector<json>{};
  const json values = values_of(scalars);
  const json published = published_json(variant.published);
  return {{"name", variant.name},
          {"title", variant.setup.title},
          {"status", ran ? summary.value("status", "not usable") : "not run"},
          {"reason", ran ? reason_of(summary) : ""},
          {"commit", ran ? summary.value("commit", "") : ""},
          {"disks", variant.setup.spec.disks},
          {"samples", variant.setup.samples},
          {"usable_samples", scalars.size()},
          {"values", values},
          {"published", published},
          {"difference", differences(values, published)}};
}

}  // namespace softgrain
