#include "calibrate/multi_contact_slopes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace softgrain {

namespace {

MultiContactForm form_of(std::span<const double> numbers) {
  MultiContactForm form;
  form.pressure = {std::exp(numbers[0]), numbers[1], numbers[2]};
  form.coupling = {numbers[3], numbers[4], numbers[5]};
  return form;
}

bool same_kind(const MultiContactPartner& a, const MultiContactPartner& b) {
  return a.kind == b.kind && (a.kind == PartnerKind::plane ? a.smooth == b.smooth : a.ratio == b.ratio);
}

}  // namespace

/// The sums over the contacts of a body, closed.
struct MultiContactSlopes::BodyState {
  MultiContactSum<3> sum;
  double volume = 0.0;        ///< S
  double by_exponent = 0.0;   ///< dp/db
  double by_threshold = 0.0;  ///< dp/d delta
};

/// All that forces and slopes at some numbers share.
struct MultiContactSlopes::Evaluation {
  std::span<const double> numbers;
  MultiContactForm law;
  std::vector<LostVolume<double>> lost;  ///< volume lost to each contact
  std::vector<BodyState> bodies;
};

MultiContactSlopes::MultiContactSlopes(LawForm form, const std::vector<OverlapState>& states) : form_(form) {
  for (const OverlapState& s : states) add_state(s);
}

std::size_t MultiContactSlopes::kind_of(const MultiContactPartner& partner) {
  const auto known =
      std::find_if(kinds_.begin(), kinds_.end(), [&](const MultiContactPartner& k) { return same_kind(k, partner); });
  const auto index = static_cast<std::size_t>(known - kinds_.begin());
  if (known == kinds_.end()) kinds_.push_back(partner);
  return index;
}

MultiContactSlopes::Contact MultiContactSlopes::contact_of(const MultiContactPartner& partner, double overlap) {
  return {neighbour_lens(partner, overlap), partner.direction, kind_of(partner)};
}

std::size_t MultiContactSlopes::add_body(const std::vector<Contact>& contacts) {
  bodies_.push_back({contacts_.size(), contacts.size()});
  contacts_.insert(contacts_.end(), contacts.begin(), contacts.end());
  return bodies_.size() - 1;
}

/// Soft neighbour k with the planes that press it and, last, the particle in the middle. The pair law knows that alone.
MultiContactSlopes::Side MultiContactSlopes::other_side(const OverlapState& state, std::size_t k) {
  const MultiContactPartner& p = (*state.partners)[k];
  std::vector<Contact> contacts;
  if (form_ != LawForm::pair)
    for (std::size_t j = 0; j < state.partners->size(); ++j)
      if ((*state.partners)[j].on == static_cast<std::int32_t>(k))
        contacts.push_back(contact_of((*state.partners)[j], (*state.overlap)[j] / p.ratio));
  contacts.push_back(contact_of(seen_from_neighbour(p), (*state.overlap)[k] / p.ratio));
  const std::size_t body = add_body(contacts);
  return {body, bodies_[body].first + contacts.size() - 1, p.ratio * p.ratio};
}

void MultiContactSlopes::add_state(const OverlapState& state) {
  const std::size_t touching = MultiContactConfiguration::touching_of(*state.partners);
  std::vector<Contact> contacts;
  for (std::size_t k = 0; k < touching; ++k) contacts.push_back(contact_of((*state.partners)[k], (*state.overlap)[k]));
  const std::size_t together = form_ == LawForm::pair ? 0 : add_body(contacts);
  for (std::size_t k = 0; k < touching; ++k) {
    Force force;
    const std::size_t body = form_ == LawForm::pair ? add_body({contacts[k]}) : together;
    force.centre = {body, bodies_[body].first + (form_ == LawForm::pair ? 0 : k), 1.0};
    force.has_other = (*state.partners)[k].kind == PartnerKind::soft;
    if (force.has_other) force.other = other_side(state, k);
    forces_.push_back(force);
  }
}

std::vector<double> MultiContactSlopes::numbers_of(const MultiContactModel& model) const {
  const MultiContactPressure& p = model.form.pressure;
  const MultiContactCoupling& m = model.form.coupling;
  std::vector<double> out{std::log(p.a), p.b, p.delta, m.m0, m.m1, m.m2};
  for (const MultiContactPartner& k : kinds_) {
    const PairConstants c = neighbour_constants(model, k);
    out.push_back(std::log(c.a));
    out.push_back(c.b);
  }
  return out;
}

MultiContactSlopes::Evaluation MultiContactSlopes::evaluation(std::span<const double> numbers) const {
  Evaluation out{numbers, form_of(numbers), {}, std::vector<BodyState>(bodies_.size())};
  std::vector<double> weight;
  for (std::size_t k = 0; k < kinds_.size(); ++k) weight.push_back(std::exp(numbers[kLaw + 2 * k]));
  out.lost.reserve(contacts_.size());
  for (const Contact& c : contacts_)
    out.lost.push_back(lost_volume(c.lens, weight[c.kind], numbers[kLaw + 2 * c.kind + 1]));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    BodyState& state = out.bodies[b];
    for (std::size_t c = bodies_[b].first; c < bodies_[b].first + bodies_[b].count; ++c)
      state.sum.add(out.lost[c].nu, contacts_[c].direction);
    state.volume = form_ == LawForm::directional ? out.law.equivalent_volume(state.sum) : state.sum.volume;
    state.sum.close(out.law.pressure, state.volume);
  }
  return out;
}

double MultiContactSlopes::force_of(const Evaluation& at, const Side& side) const {
  const MultiContactSum<3>& sum = at.bodies[side.body].sum;
  const LostVolume<double>& nu = at.lost[side.contact];
  const double felt =
      form_ == LawForm::directional ? at.law.felt(sum, nu.nu, contacts_[side.contact].direction) : sum.volume;
  return side.area * nu.slope * sum.gain * felt;
}

void MultiContactSlopes::evaluate(std::span<const double> numbers, std::span<double> force) const {
  const Evaluation at = evaluation(numbers);
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    force[k] = force_of(at, forces_[k].centre);
    if (forces_[k].has_other) force[k] += force_of(at, forces_[k].other);
  }
}

std::vector<double> MultiContactSlopes::above_threshold(std::span<const double> numbers) const {
  const Evaluation at = evaluation(numbers);
  std::vector<double> out;
  for (const BodyState& b : at.bodies)
    out.push_back(b.volume > 0.0 ? cap_depth(b.volume) - at.law.pressure.delta : -1.0);
  return out;
}

namespace {

/// B as MultiContactForm::felt() has it, below zero too: S dS/dnu.
double felt_by(const MultiContactCoupling& m, const MultiContactSum<3>& sum, double nu, const Vec3& n) {
  return m.own() * nu + m.m0 * sum.volume - m.m1 * dot(n, sum.first) - m.m2 * sum.second_along(n);
}

/// dp/db and dp/d delta at the equivalent volume s; zeros below the threshold.
std::pair<double, double> pressure_slopes(const MultiContactPressure& p, double s) {
  const double d = cap_depth(s);
  if (!(d > p.delta)) return {0.0, 0.0};
  const double disk = 0.75 * d * (2.0 - d);
  const double at_threshold = p.delta > 0.0 ? std::pow(p.delta, p.b) : 0.0;
  const double by_exponent = std::pow(d, p.b) * std::log(d) - (p.delta > 0.0 ? at_threshold * std::log(p.delta) : 0.0);
  const double by_threshold = p.delta > 0.0 ? -p.b * at_threshold / p.delta : 0.0;
  return {p.a * by_exponent / disk, p.a * by_threshold / disk};
}

}  // namespace

/// F = area dnu/dx g(S) B, g = p(S)/S: by the numbers of the law, and by nu of every contact of the body.
void MultiContactSlopes::add_slopes(const Evaluation& at, const Side& side, std::span<double> row) const {
  const MultiContactForm& law = at.law;
  const BodyState& state = at.bodies[side.body];
  const MultiContactSum<3>& sum = state.sum;
  const Contact& own = contacts_[side.contact];
  const LostVolume<double>& nu = at.lost[side.contact];
  const bool directional = form_ == LawForm::directional;
  const double felt = directional ? law.felt(sum, nu.nu, own.direction) : sum.volume;
  const double scale = side.area * nu.slope;
  const double force = scale * sum.gain * felt;
  if (force == 0.0) return;
  const auto by_constants = [&](std::size_t contact, double by_log_weight, double by_exponent) {
    row[kLaw + 2 * contacts_[contact].kind] += by_log_weight;
    row[kLaw + 2 * contacts_[contact].kind + 1] += by_exponent;
  };
  row[0] += force;
  row[1] += scale * felt * state.by_exponent / state.volume;
  row[2] += scale * felt * state.by_threshold / state.volume;
  const double m = at.numbers[kLaw + 2 * own.kind + 1];
  by_constants(side.contact, force, force * (1.0 / m + std::log(own.lens.volume)));
  if (directional) {
    const double squares[3] = {sum.volume * sum.volume - sum.square, sum.square - norm2(sum.first),
                               sum.square - sum.second_squared()};
    const double felts[3] = {sum.volume - nu.nu, nu.nu - dot(own.direction, sum.first),
                             nu.nu - sum.second_along(own.direction)};
    for (std::size_t k = 0; k < 3; ++k)
      row[3 + k] += scale * (0.5 * sum.gain_slope * squares[k] * felt + sum.gain * felts[k]);
  }
  const Body& body = bodies_[side.body];
  for (std::size_t c = body.first; c < body.first + body.count; ++c) {
    const LostVolume<double>& other = at.lost[c];
    if (!(other.nu > 0.0)) continue;
    double volume_slope = state.volume;  // S dS/dnu
    double felt_slope = 1.0;
    if (directional) {
      const Vec3& n = contacts_[c].direction;
      volume_slope = felt_by(law.coupling, sum, other.nu, n);
      felt_slope = c == side.contact ? 1.0 : law.coupling.at(dot(own.direction, n));
    }
    const double by_nu = scale * (sum.gain_slope * volume_slope * felt + sum.gain * felt_slope);
    by_constants(c, by_nu * other.nu, by_nu * other.nu * std::log(contacts_[c].lens.volume));
  }
}

void MultiContactSlopes::slopes(std::span<const double> numbers, std::span<double> slope) const {
  Evaluation at = evaluation(numbers);
  for (BodyState& b : at.bodies) std::tie(b.by_exponent, b.by_threshold) = pressure_slopes(at.law.pressure, b.volume);
  std::fill(slope.begin(), slope.end(), 0.0);
  const std::size_t n = this->numbers();
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    const std::span<double> row = slope.subspan(k * n, n);
    add_slopes(at, forces_[k].centre, row);
    if (forces_[k].has_other) add_slopes(at, forces_[k].other, row);
  }
}

}  // namespace softgrain
