#include "tests/verification/cases/scene_text.h"

#include <fmt/format.h>

namespace softgrain::verification {

std::string digits(double value) { return fmt::format("{}", value); }

std::string digits(const Vec3& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); }

std::string heading(const std::string& title, const Vec3& gravity) {
  return fmt::format("kind = \"particles\"\ntitle = \"{}\"\ngravity = {}\n", title, digits(gravity));
}

std::string text_of(const SceneMaterial& m) {
  const std::string text = fmt::format("\n[material.{}]\ndensity = {}\n", m.name, m.density);
  return m.youngs_modulus > 0.0 ? text + fmt::format("E = {}\nnu = {}\n", m.youngs_modulus, m.poisson_ratio) : text;
}

SceneMaterial inelastic(SceneMaterial material) {
  material.youngs_modulus = 0.0;
  return material;
}

std::string text_of(const HertzContact& c) {
  return fmt::format(
      "\n[[contact]]\npair = [\"grain\", \"{}\"]\nlaw = \"hertz-tsuji\"\nrestitution = {}\nmu = {}\ntangential = "
      "\"{}\"\n",
      c.partner, c.restitution, c.mu, c.tangential);
}

std::string text_of(const LinearContact& c) {
  return fmt::format(
      "\n[[contact]]\npair = [\"grain\", \"{}\"]\nlaw = \"linear-spring\"\nrestitution = {}\nmu = {}\n"
      "normal_stiffness = {}\ntangential_stiffness = {}\n",
      c.partner, c.restitution, c.mu, c.normal, c.tangential);
}

std::string text_of(const Ball& b) {
  return fmt::format("\n[[particle]]\nmaterial = \"grain\"\nradius = {}\nposition = {}\nvelocity = {}\nspin = {}\n",
                     b.radius, digits(b.position), digits(b.velocity), digits(b.spin));
}

std::string plane(const Vec3& point, const Vec3& normal, const std::string& material) {
  return fmt::format("\n[[wall]]\nshape = \"plane\"\npoint = {}\nnormal = {}\nmaterial = \"{}\"\n", digits(point),
                     digits(normal), material);
}

std::string cell(const Vec3& size, bool x, bool y, bool z, double shear_rate) {
  return fmt::format("\n[cell]\nsize = {}\nperiodic = [{}, {}, {}]\nshear_rate = {}\n", digits(size), x, y, z,
                     shear_rate);
}

std::string timing(double step, std::int64_t steps, std::int64_t every) {
  std::string text = fmt::format("\n[time]\nstep = {}\nsteps = {}\n", step, steps);
  if (every > 0) text += fmt::format("\n[output]\nevery = {}\n", step * static_cast<double>(every));
  return text;
}

}  // namespace softgrain::verification
