// What a multi-contact experiment is made of: laws, materials and bodies in their slots. How it moves and what it
// records is in multi_contact_experiment.cpp.
#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "microsim/multi_contact_experiment.h"

namespace softgrain {

namespace {

// Grains and inner soft particles of every soft particle have materials of their own, so that neighbours can be made
// blind to each other: kGrain and kInner of the centre, then two for each soft neighbour.
constexpr std::int32_t kGrain = 0;
/// Inner soft particles: in every soft particle the material after that of its grains.
constexpr std::int32_t kInner = kGrain + 1;
constexpr std::int32_t kSolid = 2;  ///< solid spheres as neighbours
constexpr std::int32_t kWall = 3;   ///< planes and shells: neither meets the other, both meet grains
constexpr std::int32_t kPlane = 4;
constexpr std::int32_t kSmoothPlane = 5;
/// Grains of the first soft neighbour; the planes that press soft neighbours come after the materials of all of these.
constexpr std::int32_t kFirstOther = 6;

std::int32_t inner_of(std::int32_t grain) { return grain + kInner - kGrain; }

/// Laws are added once and shared by many pairs of materials.
class ContentLaws {
 public:
  ContentLaws(std::int32_t materials, const AnyLaw& hertz, const InnerLaws* inner) : laws_(materials) {
    hertz_ = laws_.add(hertz);
    if (inner == nullptr) return;
    soft_plane_ = laws_.add(inner->soft_plane);
    soft_solid_ = laws_.add(inner->soft_solid);
    solid_soft_ = laws_.add(inner->solid_soft);
    soft_soft_ = laws_.add(inner->soft_soft);
  }
  void solids(std::int32_t m1, std::int32_t m2) { laws_.use(m1, m2, hertz_); }
  void soft_with_solid(std::int32_t soft, std::int32_t solid) {
    if (soft_solid_ == LawSet::kNoContact) return;
    laws_.use(soft, solid, soft_solid_, true);
    laws_.use(solid, soft, solid_soft_, true);
  }
  void softs(std::int32_t m1, std::int32_t m2) {
    if (soft_soft_ != LawSet::kNoContact) laws_.use(m1, m2, soft_soft_);
  }
  /// Two contents meet (or one with itself).
  void contents(std::int32_t grain1, std::int32_t grain2) {
    solids(grain1, grain2);
    soft_with_solid(inner_of(grain1), grain2);
    soft_with_solid(inner_of(grain2), grain1);
    softs(inner_of(grain1), inner_of(grain2));
  }
  /// A content meets a solid sphere.
  void content_with(std::int32_t grain, std::int32_t solid) {
    solids(grain, solid);
    soft_with_solid(inner_of(grain), solid);
  }
  /// A content meets a plane or the inside of a shell.
  void content_with_plane(std::int32_t grain, std::int32_t plane) {
    solids(grain, plane);
    soft_with_plane(grain, plane);
  }
  void content_with_smooth(std::int32_t grain, std::int32_t plane, const AnyLaw& smooth) {
    laws_.use(grain, plane, laws_.add(smooth));
    soft_with_plane(grain, plane);
  }
  [[nodiscard]] const LawSet& laws() const { return laws_; }

 private:
  void soft_with_plane(std::int32_t grain, std::int32_t plane) {
    if (soft_plane_ != LawSet::kNoContact) laws_.use(inner_of(grain), plane, soft_plane_);
  }

  LawSet laws_;
  std::int32_t hertz_ = LawSet::kNoContact;
  std::int32_t soft_plane_ = LawSet::kNoContact;
  std::int32_t soft_solid_ = LawSet::kNoContact;
  std::int32_t solid_soft_ = LawSet::kNoContact;
  std::int32_t soft_soft_ = LawSet::kNoContact;
};

std::int32_t other_material(std::size_t soft) { return kFirstOther + 2 * static_cast<std::int32_t>(soft); }

std::int32_t press_material(std::size_t soft, std::size_t softs) {
  return other_material(softs) + static_cast<std::int32_t>(soft);
}

std::int32_t count_materials(std::size_t softs) { return press_material(softs, softs); }

LawSet multi_contact_laws(const MultiContactExperiment& e, double restitution, std::size_t softs,
                          const InnerLaws* inner) {
  const Material& grain = e.system.materials[kGrain];
  const auto law = [&](double friction) {
    return hertz_law(HertzCoefficients::of(grain, grain, friction, restitution), false);
  };
  const AnyLaw hertz = law(e.spec.friction);
  ContentLaws table(count_materials(softs), hertz, inner);
  table.contents(kGrain, kGrain);
  table.content_with(kGrain, kSolid);
  for (const std::int32_t wall : {kWall, kPlane}) table.content_with_plane(kGrain, wall);
  const auto& partners = e.configuration.partners;
  if (std::any_of(partners.begin(), partners.end(), [](const MultiContactPartner& p) { return p.smooth; }))
    table.content_with_smooth(kGrain, kSmoothPlane, law(0.0));
  for (std::size_t k = 0; k < softs; ++k) {
    const std::int32_t other = other_material(k);
    table.contents(other, other);
    table.contents(kGrain, other);
    table.content_with_plane(other, kWall);
    table.content_with_plane(other, press_material(k, softs));
  }
  return table.laws();
}

std::vector<Material> multi_contact_materials(const SoftParticleSpec& spec, std::size_t softs) {
  std::vector<Material> materials;
  for (std::int32_t m = 0; m < count_materials(softs); ++m)
    materials.push_back(
        {"material " + std::to_string(m), spec.density, spec.youngs_modulus, spec.poisson_ratio, false});
  return materials;
}

void require_configuration(const MultiContactConfiguration& c, std::size_t others) {
  constexpr double kUnit = 1e-9;
  std::size_t softs = 0;
  for (const MultiContactPartner& p : c.partners) {
    if (std::abs(norm(p.direction) - 1.0) > kUnit) throw InputError(c.name + ": a direction is no unit vector");
    if (p.kind != PartnerKind::plane && !(p.ratio > 0.0))
      throw InputError(c.name + ": the ratio of a sphere must be > 0");
    softs += p.kind == PartnerKind::soft ? 1 : 0;
  }
  if (others < softs)
    throw InputError(c.name + ": " + std::to_string(softs) + " soft neighbours, content for " + std::to_string(others));
  for (const MultiContactStage& s : c.stages)
    if (s.overlap.size() != c.partners.size()) throw InputError(c.name + ": one overlap per neighbour and stage");
}

/// Content of a soft particle as bodies of radius scale * r.
struct ContentPlace {
  Vec3 centre{};
  double scale = 0.0;  ///< radius of its shell [m]
  std::int32_t material = 0;
  Slot shell = 0;
};

void add_content(System3& s, const SoftParticleSpec& spec, const SoftContent& content, const ContentPlace& at,
                 double inner_fraction) {
  const auto add = [&](const Vec3& x, double r, double density, std::int32_t material) {
    NewBody<3> body = solid_sphere(at.centre + x * at.scale, r * at.scale, density, material);
    body.shell = at.shell;
    add_grain(s.particles, body);
  };
  for (std::size_t k = 0; k < content.grains.radius.size(); ++k)
    add(content.grains.position[k], content.grains.radius[k], spec.density, at.material);
  if (content.inner_packings.empty())
    for (const InnerSoft& inner : content.inner)
      add(inner.x, inner.r, spec.density * inner_fraction, inner_of(at.material));
}

/// Grains of the packing that inner soft particle k holds.
const ShellPacking& inner_packing(const SoftContent& content, std::size_t k) {
  return content.inner_packings[k % content.inner_packings.size()];
}

/// Grains of resolved inner soft particles; they live in their own shell, which lives in the shell of the content.
void add_inner_grains(System3& s, const SoftParticleSpec& spec, const SoftContent& content, const ContentPlace& at,
                      Slot first_shell) {
  if (content.inner_packings.empty()) return;
  for (std::size_t k = 0; k < content.inner.size(); ++k) {
    const ContentPlace inner{at.centre + content.inner[k].x * at.scale, content.inner[k].r * at.scale, at.material,
                             first_shell + static_cast<Slot>(k)};
    add_content(s, spec, {inner_packing(content, k), {}, {}}, inner, 1.0);
  }
}

void add_inner_shells(System3& s, const SoftParticleSpec& spec, const SoftContent& content, const ContentPlace& at) {
  if (content.inner_packings.empty()) return;
  for (std::size_t k = 0; k < content.inner.size(); ++k) {
    const double fraction = inner_packing(content, k).solid_fraction();
    NewBody<3> shell = solid_sphere(at.centre + content.inner[k].x * at.scale, content.inner[k].r * at.scale,
                                    spec.density * fraction, kWall);
    shell.shell = at.shell;
    add_shell(s.particles, shell);
  }
}

Slot count(const SoftContent& content) {
  std::size_t n = content.grains.radius.size();
  if (content.inner_packings.empty()) n += content.inner.size();
  for (std::size_t k = 0; k < content.inner.size() && !content.inner_packings.empty(); ++k)
    n += inner_packing(content, k).radius.size();
  return static_cast<Slot>(n);
}

/// Solid volume over the volume of the shell.
double solid_fraction(const SoftContent& content, double inner_fraction) {
  double sum = content.grains.solid_fraction();
  for (const InnerSoft& inner : content.inner) sum += inner_fraction * inner.r * inner.r * inner.r;
  return sum;
}

/// A free shell has the mass of its content, one that is held or led has none.
NewBody<3> shell_of(const SoftParticleSpec& spec, const Vec3& x, double radius, bool free, double fraction) {
  if (free) return solid_sphere(x, radius, spec.density * fraction, kWall);
  NewBody<3> shell;
  shell.x = x;
  shell.r = radius;
  shell.material = kWall;
  return shell;
}

/// Adds bodies group by group, because slots are ordered grains, shells, planes.
class Builder {
 public:
  Builder(MultiContactExperiment& e, const std::vector<const SoftContent*>& others, double inner_fraction)
      : e_(e), others_(others), fraction_(inner_fraction) {
    e_.neighbours.resize(e.configuration.partners.size());
  }

  void build(const SoftContent& centre) {
    e_.centre_bodies = count(centre);
    const Slot shell = first_shell();
    e_.centre_shell = shell;
    const ContentPlace place{{}, e_.spec.shell_radius, kGrain, shell};
    Slot softs = 0;
    each(PartnerKind::soft, [&](const auto&, auto&, std::size_t) { ++softs; });
    add_content(e_.system, e_.spec, centre, place, fraction_);
    add_inner_grains(e_.system, e_.spec, centre, place, shell + 1 + softs);
    soft_contents(shell + 1);
    solids();
    add_shell(e_.system.particles, shell_of(e_.spec, {}, e_.spec.shell_radius, e_.configuration.centre_free,
                                            solid_fraction(centre, fraction_)));
    soft_shells();
    add_inner_shells(e_.system, e_.spec, centre, place);
    planes();
  }

 private:
  template <class Work>
  void each(PartnerKind kind, Work&& work) {
    std::size_t found = 0;
    for (std::size_t k = 0; k < e_.neighbours.size(); ++k)
      if (e_.configuration.partners[k].kind == kind) work(e_.configuration.partners[k], e_.neighbours[k], found++);
  }
  [[nodiscard]] Vec3 at(const MultiContactPartner& p) const {
    if (p.on < 0) return neighbour_place(e_.spec, p, p.direction, 0.0);
    const MultiContactPartner& on = e_.configuration.partners[static_cast<std::size_t>(p.on)];
    return at(on) + p.direction * (on.ratio * e_.spec.shell_radius);
  }

  /// Goes where it is led: without a mass.
  [[nodiscard]] NewBody<3> led_solid(const MultiContactPartner& p) const {
    NewBody<3> body;
    body.x = at(p);
    body.r = p.ratio * e_.spec.shell_radius;
    body.material = kSolid;
    return body;
  }
  /// Index of partner k among the soft neighbours.
  [[nodiscard]] std::size_t soft_number(std::int32_t k) const {
    const auto& partners = e_.configuration.partners;
    return static_cast<std::size_t>(
        std::count_if(partners.begin(), partners.begin() + k,
                      [](const MultiContactPartner& p) { return p.kind == PartnerKind::soft; }));
  }
  /// 1 / moment of inertia of a solid neighbour, where it may turn.
  [[nodiscard]] double turning(const MultiContactPartner& p) const {
    if (!e_.configuration.turning) return 0.0;
    return 1.0 / solid_sphere({}, p.ratio * e_.spec.shell_radius, e_.spec.density, kSolid).inertia;
  }
  Slot first_shell() {
    Slot grains = e_.centre_bodies;
    each(PartnerKind::soft, [&](const auto&, auto&, std::size_t k) { grains += count(*others_[k]); });
    each(PartnerKind::solid, [&](const auto&, auto&, std::size_t) { ++grains; });
    return grains;
  }
  void soft_contents(Slot first) {
    each(PartnerKind::soft, [&](const MultiContactPartner& p, MultiContactExperiment::Neighbour& n, std::size_t k) {
      n.begin = e_.system.particles.grains;
      add_content(e_.system, e_.spec, *others_[k],
                  {at(p), p.ratio * e_.spec.shell_radius, other_material(k), first + static_cast<Slot>(k)}, fraction_);
      n.end = e_.system.particles.grains;
    });
  }
  void solids() {
    each(PartnerKind::solid, [&](const MultiContactPartner& p, MultiContactExperiment::Neighbour& n, std::size_t) {
      n.body = add_grain(e_.system.particles, led_solid(p));
      e_.system.particles.inverse_inertia[static_cast<std::size_t>(n.body)] = turning(p);
    });
  }
  void soft_shells() {
    each(PartnerKind::soft, [&](const MultiContactPartner& p, MultiContactExperiment::Neighbour& n, std::size_t k) {
      const bool free = e_.configuration.pressed(static_cast<std::size_t>(&n - e_.neighbours.data()));
      n.body = add_shell(e_.system.particles, shell_of(e_.spec, at(p), p.ratio * e_.spec.shell_radius, free,
                                                       solid_fraction(*others_[k], fraction_)));
    });
  }
  void planes() {
    each(PartnerKind::plane, [&](const MultiContactPartner& p, MultiContactExperiment::Neighbour& n, std::size_t) {
      NewBody<3> plane;
      plane.x = at(p);
      plane.material = p.on >= 0 ? press_material(soft_number(p.on), others_.size()) : p.smooth ? kSmoothPlane : kPlane;
      n.body = add_plane(e_.system.particles, plane, -p.direction);
    });
  }

  MultiContactExperiment& e_;
  const std::vector<const SoftContent*>& others_;
  double fraction_;
};

}  // namespace

MultiContactExperiment make_multi_contact(const SoftParticleSpec& spec, const MultiContactConfiguration& configuration,
                                          const SoftContent& centre, const std::vector<const SoftContent*>& others,
                                          const InnerLaws* laws) {
  require_configuration(configuration, others.size());
  bool inner = !centre.inner.empty();
  for (const SoftContent* other : others) {
    inner = inner || !other->inner.empty();
    if (!other->inner_packings.empty())
      throw InputError(configuration.name + ": inner soft particles can hold their grains in the centre only");
  }
  if (inner && laws == nullptr) throw InputError(configuration.name + ": inner soft particles need laws");
  MultiContactExperiment e;
  e.spec = spec;
  e.configuration = configuration;
  e.overlap.assign(configuration.partners.size(), 0.0);
  e.system.materials = multi_contact_materials(spec, others.size());
  const auto laws_with = [&](double restitution) {
    return multi_contact_laws(e, restitution, others.size(), inner ? laws : nullptr);
  };
  e.undamped = laws_with(1.0);
  e.damped = laws_with(spec.restitution);
  e.system.laws = e.undamped;
  Builder(e, others, laws == nullptr ? 1.0 : laws->solid_fraction).build(centre);
  return e;
}

}  // namespace softgrain
