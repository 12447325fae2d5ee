// The grading curve of all grains and bodies of a run: share of the volume that passes over the diameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/summary.h"
#include "pipelines/snapshots/snapshots.h"

namespace softgrain::report {
namespace {

/// Radii of one kind, in one unit of length.
struct Sieved {
  std::string label;
  std::string unit = "m";
  int dimension = 3;
  std::vector<double> radii{};
};

constexpr std::size_t kMostCurves = 8;
constexpr std::size_t kPoints = 200;          ///< number of points of a curve
constexpr std::uintmax_t kLarge = 300000000;  ///< states of more bytes take too long to read for a picture

/// Grains of all packings that were measured.
std::vector<Sieved> measured_grains(const Measurements& data) {
  Sieved all{.label = "grains in the shells, all packings"};
  for (const PackingInfo& packing : data.packings)
    all.radii.insert(all.radii.end(), packing.radii.begin(), packing.radii.end());
  return all.radii.empty() ? std::vector<Sieved>{} : std::vector<Sieved>{all};
}

const char* name_of(ParticleRole role) {
  if (role == ParticleRole::soft) return "soft particles";
  return role == ParticleRole::inner ? "grains in soft particles" : "solid grains";
}

/// Radii of the bodies in the last states of a run; series that hold the same radii count once.
std::vector<Sieved> bodies_of(const RunData& run) {
  std::uintmax_t bytes = 0;
  for (const std::string& file : snapshot_files(run.directory)) bytes += std::filesystem::file_size(file);
  std::vector<Sieved> out;
  if (bytes > kLarge) return out;
  std::set<std::pair<std::string, std::vector<double>>> known;
  for_each_snapshot(run.directory, SnapshotChoice::last, [&](const Snapshot& s) {
    std::map<ParticleRole, std::vector<double>> roles;
    for (const SnapshotParticle& p : s.particles) roles[p.role].push_back(p.radius);
    for (auto& [role, radii] : roles) {
      std::sort(radii.begin(), radii.end());
      const std::string series = s.series.substr(0, s.series.find_first_of("0123456789-"));
      const std::string name = name_of(role);
      if (out.size() < kMostCurves && known.emplace(name, radii).second)
        out.push_back({name + (series.empty() ? "" : " (" + s.series + ")"), s.length_unit, s.dimension, radii});
    }
  });
  std::map<std::string, int> times;  // a name that stands for one curve alone needs no series behind it
  const auto plain = [](const std::string& label) { return label.substr(0, label.find(" (")); };
  for (const Sieved& one : out) ++times[plain(one.label)];
  for (Sieved& one : out)
    if (times[plain(one.label)] == 1) one.label = plain(one.label);
  return out;
}

/// Steps are drawn as lines between `kPoints` grains that are evenly spread over the number, the ends among them.
Series passing(Sieved one, std::size_t index) {
  std::sort(one.radii.begin(), one.radii.end());
  const auto volume = [&](double r) { return one.dimension == 2 ? r * r : r * r * r; };
  double all = 0.0;
  for (const double r : one.radii) all += volume(r);
  Series s{.label = fmt::format("{}, {}", one.label, format_count(static_cast<std::int64_t>(one.radii.size()))),
           .hover = one.label,
           .x = {2e3 * one.radii.front()},
           .y = {0.0}};
  if (one.unit != "m") s.x.front() *= 1e-3;
  const std::size_t n = one.radii.size();
  const std::size_t shown = std::min(n, kPoints);
  double below = 0.0;
  std::size_t next = 1;
  for (std::size_t k = 0; k < n; ++k) {
    below += volume(one.radii[k]);
    if ((k + 1) * shown / n < next) continue;
    next = (k + 1) * shown / n + 1;
    s.x.push_back((one.unit == "m" ? 2e3 : 2.0) * one.radii[k]);
    s.y.push_back(100.0 * below / all);
  }
  s.style = {.color = palette::cycle(index), .width = 1.6, .dash = index < 7 ? "" : "6 3"};
  return s;
}

}  // namespace

std::string grading_section(const RunData& run) {
  if (is_set(run) || !run.summary_as<AnySummary>().sizes.empty()) return "";  // asked and obtained says it all
  const std::vector<Sieved> curves =
      run.measurements && run.macro.empty() ? measured_grains(*run.measurements) : bodies_of(run);
  if (curves.empty()) return "";
  const bool metres = curves.front().unit == "m";
  Plot plot(
      {.id = "grading",
       .title = "Grading curve",
       .x = {.label = metres ? "diameter [mm]" : "diameter [" + curves.front().unit + "]", .scale = Scale::logarithmic},
       .y = {.label = fmt::format("passing [% of the {}]", share_of(curves.front().dimension)),
             .low = 0.0,
             .high = 100.0}});
  for (std::size_t k = 0; k < curves.size(); ++k)
    if (curves[k].unit == curves.front().unit) plot.add(passing(curves[k], k));
  return section("grading", "Grading curve", "Particle size distribution of the grains and bodies of the run.",
                 figure_row({figure(
                     plot.svg(),
                     "Share of the volume (of disks the area) in grains smaller than the diameter, as a sieve analysis "
                     "gives it; numbers of grains behind the names.")}));
}

}  // namespace softgrain::report
