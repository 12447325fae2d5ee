// The one description of the numbers of a soft particle: whole, and taken by all that reads or writes them.
#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>

#include "common/core/material.h"
#include "common/data/card_text.h"
#include "common/data/soft_particle_schema.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;

/// A soft particle whose numbers all differ from the defaults and from each other.
SoftParticleSpec unlike_the_defaults() {
  SoftParticleSpec s;
  double next = 0.11;
  for (const SoftParticleNumber& number : soft_particle_numbers()) {
    s.*number.value = number.drawn.low >= 1.0 ? 1.0 + next : next;
    next += 0.03;
  }
  return s;
}

/// A number that is added to the record must be described: the list of every member does not compile without it.
TEST(SoftParticleSchema, DescribesEveryNumberOnce) {
  const SoftParticleSpec s;
  std::size_t numbers = 0;
  std::apply(
      [&](const auto&... member) {
        ((numbers += std::is_same_v<std::remove_cvref_t<decltype(member)>, double> ? 1U : 0U), ...);
      },
      every_member(s));
  EXPECT_EQ(soft_particle_numbers().size(), numbers);
  std::set<std::string> keys;
  std::set<std::string> scene_keys;
  for (const SoftParticleNumber& n : soft_particle_numbers()) {
    keys.insert(n.key);
    scene_keys.insert(n.scene_key);
    EXPECT_EQ(&soft_particle_number(n.value), &n);
  }
  EXPECT_EQ(keys.size(), numbers);
  EXPECT_EQ(scene_keys.size(), numbers);
}

TEST(SoftParticleSchema, CardsAndFilesGiveBackEveryNumber) {
  const SoftParticleSpec wanted = unlike_the_defaults();
  const test::TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("spec.h5"));
    write_spec(file.root(), wanted);
    file.commit();
  }
  const SoftParticleSpec from_file = read_spec(h5::open_file(directory.file("spec.h5")));
  const SoftParticleSpec from_card = read_spec_text(Scene::parse(spec_text(wanted), "card").root(), false);
  for (const SoftParticleNumber& n : soft_particle_numbers()) {
    EXPECT_EQ(from_file.*n.value, wanted.*n.value) << n.key;
    EXPECT_EQ(from_card.*n.value, wanted.*n.value) << n.key;
  }
}

TEST(SoftParticleSchema, OpenEndsOfRangesAreTheNextNumberWithin) {
  EXPECT_EQ(limits_of(Range::positive()).low, std::numeric_limits<double>::min());
  EXPECT_EQ(limits_of(Range::not_negative()).low, 0.0);
  EXPECT_EQ(limits_of(Range{kPoissonAbove, kPoissonHighest, true, false}).low, kPoissonLowest);
  EXPECT_EQ(limits_of(Range{0.0, 1.0, true, true}).high, 1.0 - 0.5 * std::numeric_limits<double>::epsilon());
  EXPECT_EQ(limits_of(Range::any()).high, std::numeric_limits<double>::max());
}

}  // namespace
