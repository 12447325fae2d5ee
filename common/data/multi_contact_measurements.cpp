// Layout of multi_contact.h5: "spec", "packings", "configurations" (one row each; "partners" and "stages" of all of
// them one after the other), "runs" (one row each; "points", and "neighbours" with one row per point and neighbour,
// likewise).
#include "common/data/multi_contact_measurements.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/data/fields.h"
#include "common/data/soft_particle_schema.h"

namespace softgrain {

namespace {

constexpr const char* kMultiContactFormat = "crowd-measurements";
constexpr Limits kTouch{-2.0, 2.0};  ///< limits of overlaps in states: a shell that moves may leave a neighbour

/// What a point says of one neighbour.
struct NeighbourRow {
  double overlap = 0.0;
  double normal = 0.0;
  Vec3 tangential{};
};

void fields(auto&& visit, Of<NeighbourRow> auto& r) {
  visit("overlap", r.overlap, "Rs", kTouch);
  visit("normal", r.normal, "E Rs^2");
  visit("tangential", r.tangential, "E Rs^2");
}

/// What a point says of one neighbour since moments are recorded.
struct MomentRow {
  Vec3 moment{};
};

void fields(auto&& visit, Of<MomentRow> auto& r) { visit("moment", r.moment, "E Rs^3"); }

constexpr ListColumn kPartners{"partner_count", &MultiContactConfiguration::partners};
constexpr ListColumn kStages{"stage_count", &MultiContactConfiguration::stages};
constexpr ListColumn kStageOverlaps{"overlaps", &MultiContactStage::overlap};
constexpr ListColumn kPoints{"point_count", &MultiContactRun::points};

void write_partners(const h5::Group& group, const std::vector<MultiContactConfiguration>& configurations) {
  const std::vector<MultiContactPartner> all = kPartners.joined(configurations);
  const h5::Group g = group.create("partners");
  g.attribute("kinds", "0 plane, 1 solid, 2 soft");
  write_records(g, all);
}

std::vector<MultiContactPartner> read_partners(const h5::Group& group) {
  const h5::Group g = group.open("partners");
  std::vector<MultiContactPartner> all(column_length(g, "kind"));
  read_records(g, all);
  for (const MultiContactPartner& p : all) {
    constexpr double kUnit = 1e-6;
    if ((p.kind == PartnerKind::plane) != (p.ratio == 0.0))
      throw IoError("a neighbour's kind and ratio do not fit: ratio 0 is that of planes");
    if (std::abs(norm(p.direction) - 1.0) > kUnit) throw IoError("the direction of a neighbour is no unit vector");
  }
  return all;
}

void write_stages(const h5::Group& group, const std::vector<MultiContactConfiguration>& configurations) {
  const std::vector<MultiContactStage> all = kStages.joined(configurations);
  const h5::Group g = group.create("stages");
  for (std::size_t k = 0; k < all.size(); ++k) g.attribute("name_" + std::to_string(k), to_string(all[k].move));
  write_records(g, all);
  kStageOverlaps.write(g, all);
  g.write("overlap", kStageOverlaps.joined(all));
  g.attribute_of("overlap", "unit", "Rs");
}

std::vector<MultiContactStage> read_stages(const h5::Group& group) {
  const h5::Group g = group.open("stages");
  std::vector<MultiContactStage> all(column_length(g, kStageOverlaps.name));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::string name = g.text("name_" + std::to_string(k));
    const auto move = parse_enum<MultiContactMove>(name);
    if (!move)
      throw IoError("a stage is called '" + name + "'; known are load, unload, reload, slide, oblique and roll");
    all[k].move = *move;
  }
  read_records(g, all);
  kStageOverlaps.read(g, all, read_numbers(g, "overlap", "Rs", {g.doubles("overlap").size()}, kOverlaps));
  return all;
}

void write_configurations(const h5::Group& root, const std::vector<MultiContactConfiguration>& all) {
  const h5::Group g = root.create("configurations");
  for (std::size_t k = 0; k < all.size(); ++k) g.attribute("name_" + std::to_string(k), all[k].name);
  write_records(g, all);
  kPartners.write(g, all);
  kStages.write(g, all);
  write_partners(g, all);
  write_stages(g, all);
}

/// Planes around soft neighbours stand behind all neighbours of the centre.
void require_presses(const MultiContactConfiguration& c) {
  const std::size_t touching = c.touching();
  for (std::size_t k = 0; k < c.partners.size(); ++k) {
    const MultiContactPartner& p = c.partners[k];
    const bool fits = k < touching ? p.on < 0
                                   : p.on >= 0 && static_cast<std::size_t>(p.on) < touching &&
                                         c.partners[static_cast<std::size_t>(p.on)].kind == PartnerKind::soft &&
                                         p.kind == PartnerKind::plane;
    if (touching == 0 || !fits)
      throw IoError("configuration '" + c.name + "': neighbour " + std::to_string(k) + " presses on what is not there");
  }
}

std::vector<MultiContactConfiguration> read_configurations(const h5::Group& root) {
  const h5::Group g = root.open("configurations");
  std::vector<MultiContactConfiguration> all(column_length(g, "centre_free"));
  for (std::size_t k = 0; k < all.size(); ++k) all[k].name = g.text("name_" + std::to_string(k));
  read_records(g, all);
  kPartners.read(g, all, read_partners(g));
  kStages.read(g, all, read_stages(g));
  for (const MultiContactConfiguration& c : all) {
    if (c.partners.empty() || c.stages.empty())
      throw IoError("configuration '" + c.name + "' has no neighbours, or no stages");
    for (const MultiContactStage& s : c.stages)
      if (s.overlap.size() != c.partners.size()) throw IoError("a stage has another number of overlaps");
    require_presses(c);
  }
  return all;
}

void write_points(const h5::Group& group, const std::vector<MultiContactPoint>& points) {
  const h5::Group g = group.create("points");
  write_records(g, points);
  write_column(g, "neighbours", "1", points, [](const auto& p) { return p.overlap.size(); });
  std::vector<NeighbourRow> rows;
  for (const MultiContactPoint& p : points)
    for (std::size_t k = 0; k < p.overlap.size(); ++k) rows.push_back({p.overlap[k], p.normal[k], p.tangential[k]});
  write_records(group.create("neighbours"), rows);
  std::vector<MomentRow> moments;
  for (const MultiContactPoint& p : points)
    for (const Vec3& m : p.moment) moments.push_back({m});
  if (moments.size() == rows.size()) write_records(group.create("moments"), moments);
}

std::vector<NeighbourRow> read_neighbours(const h5::Group& group) {
  const h5::Group g = group.open("neighbours");
  std::vector<NeighbourRow> rows(g.doubles("overlap").size());
  read_records(g, rows);
  return rows;
}

void append_neighbours(MultiContactPoint& p, const std::vector<NeighbourRow>& rows) {
  for (const NeighbourRow& r : rows) {
    p.overlap.push_back(r.overlap);
    p.normal.push_back(r.normal);
    p.tangential.push_back(r.tangential);
  }
}

/// One for each neighbour of each point, `count` in all.
void read_moments(const h5::Group& group, std::vector<MultiContactPoint>& points, std::size_t count) {
  require_shape(group, "moment_x", {count});
  std::vector<MomentRow> rows(count);
  read_records(group, rows);
  std::size_t next = 0;
  for (MultiContactPoint& p : points)
    for (std::size_t k = 0; k < p.overlap.size(); ++k) p.moment.push_back(rows[next++].moment);
}

std::vector<MultiContactPoint> read_points(const h5::Group& group) {
  const h5::Group g = group.open("points");
  std::vector<MultiContactPoint> points(column_length(g, "stage"));
  read_records(g, points);
  const std::vector<NeighbourRow> rows = read_neighbours(group);
  Slices slices(rows.size());
  read_integers(g, "neighbours", points, [&](auto& p, auto v) { append_neighbours(p, take(rows, slices, v)); });
  slices.finish();
  if (group.has("moments")) read_moments(group.open("moments"), points, rows.size());
  return points;
}

/// Points come stage by stage, and no neighbour is away from a shell that is held.
void require_path(const MultiContactRun& run, const MultiContactConfiguration& c) {
  constexpr double kRounding = 1e-6;
  std::int64_t stage = 0;
  for (const MultiContactPoint& p : run.points) {
    (void)below(p.stage, c.stages.size(), "stage of a point");
    if (p.stage < stage) throw IoError("the points of a run are not in the order of its stages");
    stage = p.stage;
    if (p.overlap.size() != c.partners.size()) throw IoError("a point has another number of neighbours");
    for (const double x : p.overlap)
      if (!c.centre_free && x < -kRounding)
        throw IoError("configuration '" + c.name + "': an overlap of " + std::to_string(x) +
                      " Rs; of a shell that is held none is below 0");
  }
}

/// Mean of the converged ones; all others say that none is.
MultiContactPoint mean_of(const std::vector<const MultiContactPoint*>& points) {
  std::vector<const MultiContactPoint*> good;
  for (const MultiContactPoint* p : points)
    if (p->converged) good.push_back(p);
  if (good.empty()) return *points.front();
  MultiContactPoint mean = *good.front();
  for (std::size_t k = 1; k < good.size(); ++k) {
    const MultiContactPoint& p = *good[k];
    for (std::size_t j = 0; j < mean.overlap.size(); ++j) mean.overlap[j] += p.overlap[j];
    for (std::size_t j = 0; j < mean.normal.size(); ++j) mean.normal[j] += p.normal[j];
    for (std::size_t j = 0; j < mean.tangential.size(); ++j) mean.tangential[j] += p.tangential[j];
    for (std::size_t j = 0; j < mean.moment.size(); ++j) mean.moment[j] += p.moment[j];
    mean.centre += p.centre;
    mean.residual = std::max(mean.residual, p.residual);
    mean.max_overlap = std::max(mean.max_overlap, p.max_overlap);
  }
  const double share = 1.0 / static_cast<double>(good.size());
  for (double& x : mean.overlap) x *= share;
  for (double& x : mean.normal) x *= share;
  for (Vec3& x : mean.tangential) x *= share;
  for (Vec3& x : mean.moment) x *= share;
  mean.centre *= share;
  return mean;
}

MultiContactRun mean_of(const std::vector<const MultiContactRun*>& runs) {
  MultiContactRun mean{runs.front()->configuration, runs.front()->packing, {}, {}};
  std::size_t length = runs.front()->points.size();
  for (const MultiContactRun* r : runs) {
    length = std::min(length, r->points.size());
    mean.cost += r->cost;
  }
  for (std::size_t k = 0; k < length; ++k) {
    std::vector<const MultiContactPoint*> points;
    for (const MultiContactRun* r : runs) points.push_back(&r->points[k]);
    mean.points.push_back(mean_of(points));
  }
  return mean;
}

/// Runs, configurations and packings must speak of each other.
void require_consistent(const MultiContactMeasurements& data) {
  for (const MultiContactRun& run : data.runs) {
    (void)below(run.packing, data.packings.size(), "packing of a run");
    const auto k = below(run.configuration, data.configurations.size(), "configuration of a run");
    require_path(run, data.configurations[static_cast<std::size_t>(k)]);
  }
}

}  // namespace

std::size_t MultiContactConfiguration::touching_of(const std::vector<MultiContactPartner>& partners) {
  const auto first =
      std::find_if(partners.begin(), partners.end(), [](const MultiContactPartner& p) { return p.on >= 0; });
  return static_cast<std::size_t>(first - partners.begin());
}

bool MultiContactConfiguration::pressed(std::size_t k) const {
  return std::any_of(partners.begin(), partners.end(),
                     [k](const MultiContactPartner& p) { return p.on == static_cast<std::int32_t>(k); });
}

bool MultiContactConfiguration::in_proportion() const {
  constexpr double kRounding = 1e-9;
  const std::vector<double>* first = nullptr;
  for (const MultiContactStage& stage : stages) {
    if (std::none_of(stage.overlap.begin(), stage.overlap.end(), [](double h) { return h > 0.0; })) continue;
    if (first == nullptr) first = &stage.overlap;
    const auto deepest = std::max_element(first->begin(), first->end()) - first->begin();
    const double share = stage.overlap[static_cast<std::size_t>(deepest)] / (*first)[static_cast<std::size_t>(deepest)];
    for (std::size_t k = 0; k < stage.overlap.size(); ++k)
      if (std::abs(stage.overlap[k] - share * (*first)[k]) > kRounding) return false;
  }
  return true;
}

MultiContactMeasurements mean_over_orientations(const MultiContactMeasurements& data) {
  MultiContactMeasurements out = data;
  if (std::all_of(data.runs.begin(), data.runs.end(), [](const MultiContactRun& r) { return r.orientation == 0; }))
    return out;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<const MultiContactRun*>> of_packing;
  for (const MultiContactRun& r : data.runs) of_packing[{r.configuration, r.packing}].push_back(&r);
  out.runs.clear();
  for (const auto& [place, runs] : of_packing) out.runs.push_back(mean_of(runs));
  return out;
}

void write_multi_contact_runs(const h5::Group& group, const std::vector<MultiContactRun>& runs) {
  write_records(group, runs);
  kPoints.write(group, runs);
  write_points(group, kPoints.joined(runs));
}

std::vector<MultiContactRun> read_multi_contact_runs(const h5::Group& group) {
  std::vector<MultiContactRun> runs(column_length(group, "configuration"));
  read_records(group, runs);
  kPoints.read(group, runs, read_points(group));
  return runs;
}

void save_multi_contact(const MultiContactMeasurements& data, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kMultiContactFormat);
  root.attribute("relaxation", data.relaxation);
  write_spec(root, data.spec);
  write_packings(root, data.packings);
  write_configurations(root, data.configurations);
  write_multi_contact_runs(root.create("runs"), data.runs);
  write_provenance(root, provenance);
  file.commit();
}

MultiContactMeasurements load_multi_contact(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kMultiContactFormat, path);
  MultiContactMeasurements data;
  try {
    data.relaxation = root.text("relaxation");
    data.spec = read_spec(root);
    data.packings = read_packings(root);
    data.configurations = read_configurations(root);
    data.runs = read_multi_contact_runs(root.open("runs"));
    require_consistent(data);
  } catch (const IoError& e) {
    const std::string text = e.what();
    throw IoError(text.starts_with(path) ? text : path + ": damaged: " + text);
  }
  return data;
}

}  // namespace softgrain
