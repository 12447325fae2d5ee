#include "microsim/particles/contact_monitor.h"

#include <algorithm>
#include <cmath>

#include "common/data/rows.h"
#include "common/dynamics/pair_loop.h"

namespace softgrain {

namespace {

/// Keeps the normal force of each contact.
template <int D>
struct ForceSink {
  std::vector<double>& force;
  void apart(std::size_t c) { force[c] = 0.0; }
  template <LawTraits>
  void touch(std::size_t c, std::size_t, std::size_t, const ContactGeometry<D>&, const ContactResponse<D>& r) {
    force[c] = r.normal_force;
  }
};

/// Overlap of a listed pair; negative: gap.
template <int D>
double signed_overlap(const System<D>& s, std::size_t c) {
  const auto& p = s.particles;
  const Slot j = s.contacts.j[c];
  const Sphere<D>& a = p.sphere[static_cast<std::size_t>(s.contacts.i[c])];
  const Sphere<D>& b = p.sphere[static_cast<std::size_t>(j)];
  if (j >= p.first_plane()) return a.r - dot(a.x - b.x, p.normal_of(j));
  if (j >= p.grains) return norm(a.x - b.x) - (b.r - a.r);
  return a.r + b.r - norm(a.x - b.x - s.cell.image_shift(s.contacts.image[c]));
}

// What stands in a row of each data set of a checkpoint.

constexpr auto kPair = [](auto&& visit, auto& entry) {
  visit(entry.first.first);
  visit(entry.first.second);
  visit(entry.second.count);
};
constexpr auto kNumbers = [](auto&& visit, auto& entry) {
  auto& w = entry.second;
  visit(w.duration);
  visit(w.begin);
  visit(w.seen);
  visit(w.overlap);
  for (auto* peak : {&w.force, &w.depth}) {
    visit(peak->before);
    visit(peak->last);
    visit(peak->top);
  }
};

}  // namespace

void ContactMonitor::Peak::add(double value) {
  top = std::max(top, value);
  // Vertex of the parabola through (-1, before), (0, last), (1, value) when the middle is the highest (never with NaN).
  const double bend = before - 2.0 * last + value;
  if (last >= before && last >= value && bend < 0.0) {
    const double slope = 0.5 * (value - before);
    top = std::max(top, last - 0.5 * slope * slope / bend);
  }
  before = last;
  last = value;
}

template <int D>
void ContactMonitor::match_list(const ContactList<D>& list) {
  if (build_ == list.build && of_contact_.size() == list.i.size()) return;
  build_ = list.build;
  std::map<Key, Watched> kept;
  for (const auto& [key, w] : watched_)
    if (w.count > 0) kept.emplace(key, w);
  // Pairs that stay in the list keep their last gap.
  of_contact_.resize(list.i.size());
  for (std::size_t c = 0; c < of_contact_.size(); ++c) {
    const Key key{list.i[c], list.j[c]};
    const auto old = watched_.find(key);
    Watched fresh;
    fresh.seen = -1.0;
    of_contact_[c] = &kept.emplace(key, old == watched_.end() ? fresh : old->second).first->second;
  }
  watched_.swap(kept);  // keeps the addresses of the entries
}

void ContactMonitor::update(Watched& w, double time, double overlap, double force) const {
  const bool seen_before = w.seen >= 0.0;
  const bool touched = seen_before && w.overlap > 0.0;
  const double span = time - w.seen;
  if (overlap > 0.0 && !touched) {
    ++w.count;
    w.begin = seen_before ? time - span * overlap / (overlap - w.overlap) : time;
    w.force.reset();
    w.depth.reset();
  }
  if (overlap <= 0.0 && touched) w.duration += w.seen + span * w.overlap / (w.overlap - overlap) - w.begin;
  if (overlap > 0.0) {
    w.force.add(force);
    w.depth.add(overlap);
  }
  w.seen = time;
  w.overlap = overlap;
}

template <int D>
void ContactMonitor::observe(System<D>& s) {
  match_list(s.contacts);
  force_.assign(s.contacts.i.size(), 0.0);
  ForceSink<D> sink{force_};
  pair_loop(s, 0.0, sink);
  for (std::size_t c = 0; c < of_contact_.size(); ++c) update(*of_contact_[c], s.time, signed_overlap(s, c), force_[c]);
}

template void ContactMonitor::observe<2>(System<2>&);
template void ContactMonitor::observe<3>(System<3>&);

std::vector<ContactHistory> ContactMonitor::histories() const {
  std::vector<ContactHistory> out;
  for (const auto& [key, w] : watched_) {
    if (w.count == 0) continue;
    const double present = w.overlap > 0.0 ? w.seen - w.begin : 0.0;
    out.push_back({key.first, key.second, w.count, w.duration + present, w.force.top, w.depth.top});
  }
  return out;
}

void ContactMonitor::save(const h5::Group& group) const {
  const std::vector<Entry> entries(watched_.begin(), watched_.end());
  write_rows(group, "pairs", entries, kPair);
  write_rows(group, "numbers", entries, kNumbers);
}

void ContactMonitor::load(const h5::Group& group) {
  auto entries = records_in_rows<Entry>(group, "pairs", kPair);
  read_rows(group, "numbers", entries, kNumbers);
  watched_.clear();
  watched_.insert(entries.begin(), entries.end());
  of_contact_.clear();
  build_ = 0;
}

}  // namespace softgrain
