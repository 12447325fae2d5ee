#include "pipelines/report/packing_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "pipelines/report/number_format.h"
#include "pipelines/snapshots/snapshots.h"

namespace softgrain::report {
namespace {

Vec3 cross3(const Vec3& a, const Vec3& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/// Brings points into a cell that is periodic along some axes; its origin is a corner.
class Folding {
 public:
  explicit Folding(const Snapshot& s) : edges_(s.cell_edges), periodic_(s.periodic) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!periodic_[k]) edges_[k] = Vec3{}, edges_[k][static_cast<int>(k)] = 1.0;
    const double volume = dot(edges_[0], cross3(edges_[1], edges_[2]));
    if (volume == 0.0) periodic_ = {};
    for (std::size_t k = 0; k < 3; ++k)
      reciprocal_[k] = cross3(edges_[(k + 1) % 3], edges_[(k + 2) % 3]) * (1.0 / (volume == 0.0 ? 1.0 : volume));
  }

  /// What has to be added to bring x into the cell.
  [[nodiscard]] Vec3 shift(const Vec3& x) const {
    Vec3 sum{};
    for (std::size_t k = 0; k < 3; ++k)
      if (periodic_[k]) sum -= edges_[k] * std::floor(dot(x, reciprocal_[k]));
    return sum;
  }

  [[nodiscard]] std::vector<Vec3> cell() const {
    std::vector<Vec3> out;
    if (periodic_ == std::array<bool, 3>{}) return out;
    for (std::size_t k = 0; k < 3; ++k) out.push_back(periodic_[k] ? edges_[k] : Vec3{});
    return out;
  }

 private:
  std::array<Vec3, 3> edges_;
  std::array<bool, 3> periodic_;
  std::array<Vec3, 3> reciprocal_{};
};

std::string moment_text(const Snapshot& s) {
  const Moment moment = s.moment_name();
  const std::string name = moment == Moment::overlap ? "Δ" : to_string(moment);
  const std::string unit = moment == Moment::time ? " " + s.time_unit : "";
  const std::string value = moment == Moment::frame ? std::to_string(s.frame) : format_number(s.moment(), 3);
  return fmt::format("{} = {}{}", name, value, unit);
}

/// The label of a state without what tells it from others of its series, which comes last.
std::string series_label(const Snapshot& s) {
  const std::string& text = s.label.empty() ? s.series : s.label;
  const std::size_t comma = text.rfind(", ");
  return text.substr(0, comma == std::string::npos ? text.rfind(" at ") : comma);
}

/// n of the given numbers, evenly spread, the last among them.
std::vector<std::size_t> spread_out(const std::vector<std::size_t>& numbers, std::size_t n) {
  if (numbers.size() <= n) return numbers;
  std::vector<std::size_t> out;
  for (std::size_t k = 1; k <= n; ++k) out.push_back(numbers[k * numbers.size() / n - 1]);
  return out;
}

/// The states to look at: only the last ones where files take long to read.
SnapshotChoice affordable(const std::string& run) {
  constexpr std::uintmax_t kLarge = 300'000'000;  // [byte], seconds to read
  std::uintmax_t size = 0;
  for (const std::string& file : snapshot_files(run)) size += std::filesystem::file_size(file);
  return size > kLarge ? SnapshotChoice::last : SnapshotChoice::all;
}

/// Numbers of the states that are taken, for every series.
std::map<std::string, std::set<std::size_t>> chosen_states(const std::string& run, SnapshotChoice choice,
                                                           std::size_t most) {
  std::map<std::string, std::vector<bool>> has_contacts;
  for_each_snapshot(run, choice, [&](const Snapshot& s) {
    if (s.kind != SnapshotKind::powder) has_contacts[s.series].push_back(s.has_contacts);
  });
  std::map<std::string, std::set<std::size_t>> out;
  for (const auto& [name, has] : has_contacts) {
    const bool any = std::find(has.begin(), has.end(), true) != has.end();
    std::vector<std::size_t> numbers;
    for (std::size_t k = 0; k < has.size(); ++k)
      if (has[k] || !any) numbers.push_back(k);
    for (const std::size_t k : spread_out(numbers, most)) out[name].insert(k);
  }
  return out;
}

template <class T>
void drop_if_plain(std::vector<T>& values, const std::vector<T>& plain) {
  if (values == plain) values.clear();
}

void add_contact(const Snapshot& s, const SnapshotContact& c, const Vec3& shift, PackingState& state) {
  const auto number = static_cast<std::int32_t>(state.contacts());
  state.pairs.insert(state.pairs.end(), {c.i, c.j});
  state.forces.push_back(static_cast<float>(c.normal_force));
  const Vec3 end = c.to + shift;
  const auto j = static_cast<std::size_t>(c.j);
  if (j < s.particles.size()) {
    const float* centre = state.spheres.data() + 4 * j;
    const float near = 1e-3F * centre[3];
    bool same = true;
    for (int k = 0; k < 3; ++k) same = same && std::abs(static_cast<float>(end[k]) - centre[k]) < near;
    if (same) return;
  }
  state.bent.push_back(number);
  for (int k = 0; k < 3; ++k) state.ends.push_back(static_cast<float>(end[k]));
}

/// Contacts of every grain and the sum of their forces, before some are left out.
void note_contacts(PackingState& state) {
  state.touching.assign(state.grains(), 0);
  state.load.assign(state.grains(), 0.0F);
  for (std::size_t c = 0; c < state.contacts(); ++c)
    for (const std::int32_t k : {state.pairs[2 * c], state.pairs[2 * c + 1]}) {
      if (static_cast<std::size_t>(k) >= state.grains()) continue;
      ++state.touching[static_cast<std::size_t>(k)];
      state.load[static_cast<std::size_t>(k)] += std::abs(state.forces[c]);
    }
}

/// The strongest contacts stay, in their order; of equal ones the first.
void keep_strongest(PackingState& state, std::size_t count) {
  if (state.contacts() <= count) return;
  std::vector<float> sizes;
  for (const float f : state.forces) sizes.push_back(std::abs(f));
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(count), sizes.end(), std::greater<>());
  const float limit = sizes[count];
  auto equal = static_cast<std::ptrdiff_t>(count) -
               std::count_if(sizes.begin(), sizes.end(), [&](float f) { return f > limit; });  // as many of these
  PackingState kept;
  std::size_t b = 0;
  for (std::size_t c = 0; c < state.contacts(); ++c) {
    const bool bent = b < state.bent.size() && static_cast<std::size_t>(state.bent[b]) == c;
    const float size = std::abs(state.forces[c]);
    if (size > limit || (size == limit && equal-- > 0)) {
      if (bent) {
        kept.bent.push_back(static_cast<std::int32_t>(kept.contacts()));
        for (std::size_t k = 0; k < 3; ++k) kept.ends.push_back(state.ends[3 * b + k]);
      }
      kept.pairs.insert(kept.pairs.end(), {state.pairs[2 * c], state.pairs[2 * c + 1]});
      kept.forces.push_back(state.forces[c]);
    }
    b += bent ? 1 : 0;
  }
  state.pairs = std::move(kept.pairs);
  state.forces = std::move(kept.forces);
  state.bent = std::move(kept.bent);
  state.ends = std::move(kept.ends);
}

/// Bytes of the contacts in the page.
std::size_t contact_bytes(const PackingState& s) {
  return 4 * (s.pairs.size() + s.forces.size() + s.bent.size() + s.ends.size()) / 3 * 4;
}

/// Bytes of what is known of contacts that are left out.
std::size_t noted_bytes(std::size_t grains) { return (sizeof(std::uint16_t) + sizeof(float)) * grains / 3 * 4; }

std::size_t total(const std::vector<PackingSeries>& series) {
  std::size_t sum = 0;
  for (const PackingSeries& s : series) sum += s.bytes();
  return sum;
}

/// The largest of those that `may` be made smaller; null without any.
template <class May>
PackingSeries* largest(std::vector<PackingSeries>& series, const May& may) {
  PackingSeries* found = nullptr;
  for (PackingSeries& s : series)
    if (may(s) && (found == nullptr || s.bytes() > found->bytes())) found = &s;
  return found;
}

template <class T>
std::string array_text(const std::vector<T>& values) {
  return base64({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)});
}

nlohmann::json vector_json(const Vec3& v) { return {v[0], v[1], v[2]}; }

nlohmann::json wall_json(const SnapshotWall& w) {
  nlohmann::json out{{"shape", w.shape == WallShape::plane ? "plane" : "sphere"}, {"point", vector_json(w.point)}};
  if (w.shape == WallShape::plane)
    out["normal"] = vector_json(w.normal);
  else
    out["radius"] = w.radius, out["body"] = w.body;
  return out;
}

nlohmann::json state_json(const PackingState& s) {
  nlohmann::json out{{"label", s.label},
                     {"grains", s.grains()},
                     {"spheres", array_text(s.spheres)},
                     {"body", array_text(s.body)},
                     {"role", array_text(s.role)},
                     {"ids", array_text(s.ids)},
                     {"pairs", array_text(s.pairs)},
                     {"forces", array_text(s.forces)},
                     {"bent", array_text(s.bent)},
                     {"ends", array_text(s.ends)},
                     {"touching", array_text(s.touching)},
                     {"load", array_text(s.load)},
                     {"walls", nlohmann::json::array()},
                     {"cell", nullptr}};
  for (const SnapshotWall& w : s.walls) out["walls"].push_back(wall_json(w));
  if (!s.cell.empty()) out["cell"] = {vector_json(s.cell[0]), vector_json(s.cell[1]), vector_json(s.cell[2])};
  return out;
}

}  // namespace

static_assert(std::endian::native == std::endian::little, "the page reads little-endian arrays");

std::size_t PackingState::bytes() const {
  const std::size_t grains = 4 * (spheres.size() + body.size() + ids.size()) + role.size();
  return grains / 3 * 4 + contact_bytes(*this) + noted_bytes(load.size()) + 160 * walls.size() + 330;
}

std::size_t PackingSeries::bytes() const {
  std::size_t sum = 0;
  for (const PackingState& s : states) sum += s.bytes();
  return sum;
}

PackingState packing_state(const Snapshot& s) {
  PackingState state;
  state.label = moment_text(s);
  const Folding folding(s);
  std::vector<Vec3> shifts;
  std::vector<std::int32_t> counted;
  for (const SnapshotParticle& p : s.particles) {
    shifts.push_back(folding.shift(p.position));
    const Vec3 at = p.position + shifts.back();
    for (int k = 0; k < 3; ++k) state.spheres.push_back(static_cast<float>(at[k]));
    state.spheres.push_back(static_cast<float>(p.radius));
    state.body.push_back(static_cast<std::int32_t>(p.body));
    state.role.push_back(static_cast<std::uint8_t>(p.role));
    state.ids.push_back(static_cast<std::int32_t>(p.id));
    counted.push_back(static_cast<std::int32_t>(counted.size()));
  }
  drop_if_plain(state.ids, counted);
  drop_if_plain(state.role, std::vector<std::uint8_t>(state.role.size(), 0));
  drop_if_plain(state.body, std::vector<std::int32_t>(state.body.size(), 0));
  for (const SnapshotContact& c : s.contacts) add_contact(s, c, shifts[static_cast<std::size_t>(c.i)], state);
  state.walls = s.walls;
  state.cell = folding.cell();
  return state;
}

std::vector<PackingSeries> packing_series_of(const std::string& run, std::size_t states) {
  const SnapshotChoice choice = affordable(run);
  const auto chosen = chosen_states(run, choice, states);
  std::map<std::string, std::size_t> seen;
  std::vector<PackingSeries> series;
  for_each_snapshot(run, choice, [&](const Snapshot& s) {
    if (s.kind == SnapshotKind::powder || !chosen.at(s.series).contains(seen[s.series]++)) return;
    if (series.empty() || series.back().name != s.series)
      series.push_back({s.series, series_label(s), s.length_unit, s.force_unit, {}, s.kind});
    series.back().states.push_back(packing_state(s));
  });
  std::stable_sort(series.begin(), series.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  return series;
}

std::vector<std::string> fit_into(std::vector<PackingSeries>& series, std::size_t budget) {
  bool fewer = false;
  while (total(series) > budget) {
    PackingSeries* s = largest(series, [](const PackingSeries& one) { return one.states.size() > 1; });
    if (s == nullptr) break;
    s->states.erase(s->states.begin() + static_cast<std::ptrdiff_t>((s->states.size() - 1) / 2));
    fewer = true;
  }
  std::vector<std::string> said;
  if (fewer) said.emplace_back("Some recorded states are left out to keep the page small.");
  const std::size_t share = series.empty() ? 0 : budget / series.size();
  for (PackingSeries& s : series) {
    if (total(series) <= budget) break;
    for (PackingState& state : s.states) {
      const std::size_t all = state.contacts();
      const std::size_t bare = state.bytes() - contact_bytes(state);
      if (state.bytes() <= share || bare >= share) continue;
      const std::size_t noted = bare + noted_bytes(state.grains());
      if (noted < share) note_contacts(state);  // else none are shown
      keep_strongest(state, noted < share ? all * (share - noted) / contact_bytes(state) : 0);
      said.push_back(fmt::format("{}: the {} strongest of {} contacts.", s.label,
                                 format_count(static_cast<std::int64_t>(state.contacts())),
                                 format_count(static_cast<std::int64_t>(all))));
    }
  }
  while (total(series) > budget) {
    PackingSeries* s = largest(series, [](const PackingSeries&) { return true; });
    said.push_back(fmt::format("{} is left out: {} grains are too many for a page.", s->label,
                               format_count(static_cast<std::int64_t>(s->states.back().grains()))));
    series.erase(series.begin() + (s - series.data()));
  }
  return said;
}

std::string packing_json(const std::vector<PackingSeries>& series) {
  nlohmann::json out{{"series", nlohmann::json::array()}};
  for (const PackingSeries& s : series) {
    nlohmann::json states = nlohmann::json::array();
    for (const PackingState& state : s.states) states.push_back(state_json(state));
    out["series"].push_back({{"name", s.name},
                             {"label", s.label},
                             {"length", s.length_unit},
                             {"force", s.force_unit},
                             {"states", std::move(states)}});
  }
  std::string text = out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = (word << 8) | (k < left ? bytes[at + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= left ? digits[(word >> (18 - 6 * k)) & 63U] : '=';
  }
  return out;
}

}  // namespace softgrain::report
