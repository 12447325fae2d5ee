#include "tests/verification/cases/outside_run.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "common/io/scene.h"

namespace softgrain::verification {

namespace {

OutsideRun run(const Scene& scene) {
  const ParticlesScene setup = read_particles_scene(scene);
  OutsideRun out{setup.time.step, run_particles(setup, {})};
  if (!out.result.usable) throw std::runtime_error(setup.title + ": " + out.result.reason);
  return out;
}

}  // namespace

Vec3 OutsideRun::block(const std::vector<double>& values, std::size_t frame, std::size_t particle) const {
  const auto particles = static_cast<std::size_t>(result.system.particles.grains);
  const double* at = values.data() + 3 * (frame * particles + particle);
  return {{at[0], at[1], at[2]}};
}

Vec3 OutsideRun::position(std::size_t frame, std::size_t particle) const {
  return block(result.trajectory.position, frame, particle);
}

Vec3 OutsideRun::velocity(std::size_t frame, std::size_t particle) const {
  return block(result.trajectory.velocity, frame, particle);
}

Vec3 OutsideRun::spin(std::size_t frame, std::size_t particle) const {
  return block(result.trajectory.spin, frame, particle);
}

const ContactHistory& only_contact(const OutsideRun& run) {
  if (run.result.contacts.size() != 1 || run.result.contacts[0].count != 1)
    throw std::runtime_error("one contact was expected");
  return run.result.contacts[0];
}

OutsideRun run_text(const std::string& text, const Overrides& overrides) {
  return run(Scene::parse(text, "verification.toml", overrides));
}

std::string scene_file(const std::string& name) {
  return std::string(SOFTGRAIN_REFERENCE_DIR) + "/scenes/" + name + ".toml";
}

OutsideRun run_file(const std::string& name, const Overrides& overrides) {
  return run(Scene::load(scene_file(name), overrides));
}

std::vector<std::vector<double>> reference_table(const std::string& file) {
  std::ifstream in(std::string(SOFTGRAIN_REFERENCE_DIR) + "/" + file);
  if (!in) throw std::runtime_error(file + " cannot be read");
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double x = 0.0; words >> x;) row.push_back(x);
    if (row.size() >= 2 && words.eof()) rows.push_back(row);
  }
  if (rows.size() < 5) throw std::runtime_error(file + " holds no table");
  return rows;
}

}  // namespace softgrain::verification
