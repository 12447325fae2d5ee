#include "pipelines/law/law_library_scene.h"

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "common/core/text.h"
#include "pipelines/law/law_library.h"
#include "pipelines/law/law_library_press.h"

namespace softgrain {

namespace {

constexpr const char* kShipped = "library";

const char* const kOrPressTest = "-, unless press_test is given";
const Key kFriction{"mu", "Coulomb friction of the grains", kOrPressTest};

LibraryPoint read_library_point(const SceneTable& t) {
  return {t.number(kFriction, Unit::none, Range::friction()),
          t.number({"exponent", "b of the size distribution P(r) ~ r^-b", kOrPressTest}, Unit::none),
          t.number({"ratio", "size ratio rmax/rmin of the grains", kOrPressTest}, Unit::none, Range::above(1.0)),
          t.number({"solid_fraction", "volume of grains over that of the shell", kOrPressTest}, Unit::none,
                   Range{0.0, 1.0, true, true})};
}

LibraryMatter read_library_matter(const SceneTable& t) {
  LibraryMatter m;
  m.youngs_modulus =
      t.number({"E", "Young's modulus of the grains"}, Unit::pressure, Range::positive(), m.youngs_modulus);
  m.poisson_ratio = t.number({"nu", "Poisson's ratio"}, Unit::none, kPoissonRange, m.poisson_ratio);
  m.density = t.number({"density", "density of the grains"}, Unit::density, Range::positive(), m.density);
  return m;
}

SceneTable library_table(const SceneTable& root) {
  return root.table({"library", "with `law = \"library\"`: the material whose law is interpolated"});
}

const Key kPressTest{
    "press_test",
    "press test of one soft particle on a plane, a table or its law card, instead of the material: path "
    "relative to the scene; mu beside it where the table does not say it"};

/// mu beside a press test, which may say it itself.
std::optional<double> read_press_friction(const SceneTable& t) {
  t.refuse({"exponent", "ratio", "solid_fraction", "E", "nu", "density"},
           "goes without press_test, whose table says what is known");
  if (!t.has("mu")) return std::nullopt;
  return t.number(kFriction, Unit::none, Range::friction());
}

/// Calls look_up(), which asks the library; what it has against the question stands at `key`.
template <class LookUp>
void ask_at(const SceneTable& t, const char* key, const LookUp& look_up) {
  if (t.has_errors()) t.throw_error(key, "is not looked up before the errors of [library] are mended");
  try {
    look_up();
  } catch (const InputError& e) {
    t.throw_error(key, e.what());
  }
}

/// Of a press test, or of the material in [library].
FittedLaw library_law(const SceneTable& root, const LawLibrary& library) {
  const SceneTable t = library_table(root);
  FittedLaw law;
  LawTable table;
  if (const std::string press_test = t.text(kPressTest, ""); !press_test.empty()) {
    const std::optional<double> friction = read_press_friction(t);
    ask_at(t, "press_test", [&] {
      PressTestLaw answer = law_of_press_test(library, t.resolve(press_test), friction);
      law.remark = join_text(answer.remarks, "; ");
      table = std::move(answer.table);
    });
  } else {
    const LibraryPoint at = read_library_point(t);
    const LibraryMatter matter = read_library_matter(t);
    ask_at(t, "solid_fraction", [&] {
      const LibraryAnswer answer = ask_library(library, at);
      table = table_of(library, answer, matter);
      law.remark = nearest_text(library, answer);
      if (const std::string means = means_text(answer); !means.empty()) append_part(law.remark, means);
    });
  }
  law.text = law_table_text(table, {}, "");
  law.content = std::move(table);
  return law;
}

}  // namespace

std::string law_path(const Scene& scene, const std::string& written) {
  return written == kShipped ? written : scene.resolve(written);
}

bool asks_library(const std::string& path) {
  if (path == kShipped) return true;
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && std::filesystem::path(path).extension() == ".toml" &&
         is_library(Scene::load(path));
}

FittedLaw law_at(const SceneTable& root, const std::string& path) {
  if (!asks_library(path)) return load_or_fit_law(path);
  return library_law(root, load_library(path == kShipped ? shipped_library() : path));
}

void read_library_keys(const SceneTable& root) {
  const SceneTable t = library_table(root);
  if (!t.text(kPressTest, "").empty()) {
    (void)read_press_friction(t);
    return;
  }
  (void)read_library_point(t);
  (void)read_library_matter(t);
}

void refuse_idle_library(const SceneTable& root, const std::vector<std::string>& paths) {
  if (std::ranges::none_of(paths, asks_library))
    root.refuse({"library"}, "goes with law = \"library\", or with a library of law tables");
}

}  // namespace softgrain
