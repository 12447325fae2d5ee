// HDF5 behind groups: bitwise round trips, damage found, files that appear only when complete.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

#include "common/core/error.h"
#include "common/io/hdf5_file.h"
#include "common/io/provenance.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

class Hdf5 : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() / ("softgrain_hdf5_" + std::to_string(::getpid()));
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }

  void write_sample(const std::string& name, std::size_t values = 5000) const {
    h5::AtomicFile file(path(name));
    std::vector<double> data(values);
    std::iota(data.begin(), data.end(), 0.5);
    file.root().write("data", std::span<const double>(data));
    file.commit();
  }

 private:
  fs::path directory_;
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

/// Held by another program it is not damaged.
TEST_F(Hdf5, AFileThatIsLockedIsSaidToBe) {
  write_sample("held.h5");
  const int held = ::open(path("held.h5").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(held, 0);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  try {
    (void)h5::open_file(path("held.h5"));
    ADD_FAILURE() << "it was opened";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("another program holds this file open"), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find("damaged"), std::string::npos) << e.what();
  }
  ::close(held);
  EXPECT_NO_THROW((void)h5::open_file(path("held.h5")));
}

TEST_F(Hdf5, NumbersComeBackBitForBit) {
  const std::vector<double> doubles{0.1,           -0.0,     1e-310, std::numeric_limits<double>::infinity(),
                                    std::nan("7"), 1.0 / 3.0};
  const std::vector<std::int64_t> integers{0, -1, std::numeric_limits<std::int64_t>::max(),
                                           std::numeric_limits<std::int64_t>::min()};
  {
    h5::AtomicFile file(path("a.h5"));
    const h5::Group group = file.root().create("group");
    group.write("doubles", std::span<const double>(doubles), {2, 3});
    group.write("integers", std::span<const std::int64_t>(integers));
    group.write("empty", std::span<const double>{});
    group.write("empty_table", std::span<const double>{}, {0, 3});
    file.commit();
  }
  const h5::Group group = h5::open_file(path("a.h5")).open("group");
  EXPECT_TRUE(same_bits(group.doubles("doubles"), doubles));
  EXPECT_EQ(group.shape("doubles"), (h5::Shape{2, 3}));
  EXPECT_EQ(group.integers("integers"), integers);
  EXPECT_TRUE(group.doubles("empty").empty());
  EXPECT_EQ(group.shape("empty_table"), (h5::Shape{0, 3}));
}

TEST_F(Hdf5, LargeTablesAreChunkedAndComeBack) {
  std::vector<double> data(3 * 70001);
  for (std::size_t k = 0; k < data.size(); ++k) data[k] = std::sin(static_cast<double>(k));
  {
    h5::AtomicFile file(path("large.h5"));
    file.root().write("data", std::span<const double>(data), {70001, 3});
    file.commit();
  }
  EXPECT_TRUE(same_bits(h5::open_file(path("large.h5")).doubles("data"), data));
}

TEST_F(Hdf5, AttributesKeepTextAndNumbers) {
  const std::string scene(200000, 'x');
  {
    h5::AtomicFile file(path("a.h5"));
    const h5::Group root = file.root();
    root.attribute("text", "radius [µm]\nsecond line");
    root.attribute("empty", "");
    root.attribute("scene", scene);
    root.attribute("number", 0.1);
    root.attribute("integer", std::int64_t{1} << 60);
    root.attribute("number", 0.2);  // replaces
    root.write("data", std::span<const double>(std::vector<double>{1.0}));
    root.attribute_of("data", "unit", "N");
    file.commit();
  }
  const h5::Group root = h5::open_file(path("a.h5"));
  EXPECT_EQ(root.text("text"), "radius [µm]\nsecond line");
  EXPECT_EQ(root.text("empty"), "");
  EXPECT_EQ(root.text("scene"), scene);
  EXPECT_EQ(root.number("number"), 0.2);
  EXPECT_EQ(root.integer("integer"), std::int64_t{1} << 60);
  EXPECT_TRUE(root.has_attribute("text"));
  EXPECT_FALSE(root.has_attribute("texts"));
  EXPECT_THROW((void)root.text("number"), IoError);
  EXPECT_THROW((void)root.integer("number"), IoError);
  EXPECT_THROW((void)root.number("absent"), IoError);
}

TEST_F(Hdf5, ChildrenAreListedInOrderOfCreation) {
  {
    h5::AtomicFile file(path("a.h5"));
    for (const char* name : {"zebra", "ant", "mule"}) (void)file.root().create(name);
    EXPECT_THROW((void)file.root().create("ant"), IoError);
    file.commit();
  }
  const h5::Group root = h5::open_file(path("a.h5"));
  EXPECT_EQ(root.children(), (std::vector<std::string>{"zebra", "ant", "mule"}));
  EXPECT_TRUE(root.has("ant"));
  EXPECT_FALSE(root.has("cat"));
}

TEST_F(Hdf5, WrongNamesTypesAndShapesAreFileTrouble) {
  {
    h5::AtomicFile file(path("a.h5"));
    file.root().write("data", std::span<const double>(std::vector<double>{1.0, 2.0}));
    EXPECT_THROW(file.root().write("bad", std::span<const double>(std::vector<double>{1.0, 2.0}), {3}), IoError);
    file.commit();
  }
  const h5::Group root = h5::open_file(path("a.h5"));
  EXPECT_THROW((void)root.doubles("absent"), IoError);
  EXPECT_THROW((void)root.open("absent"), IoError);
  EXPECT_THROW((void)root.integers("data"), IoError);
  EXPECT_THROW(root.attribute("late", 1.0), IoError);  // opened for reading
  try {
    (void)root.doubles("absent");
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("a.h5: /absent: "), std::string::npos) << e.what();
  }
}

TEST_F(Hdf5, MissingForeignAndDirectoryAreRefused) {
  EXPECT_THROW((void)h5::open_file(path("absent.h5")), IoError);
  EXPECT_THROW((void)h5::open_file(path("")), IoError);
  std::ofstream(path("text.h5")) << "not HDF5 at all\n";
  EXPECT_THROW((void)h5::open_file(path("text.h5")), IoError);
  std::ofstream(path("empty.h5")).flush();
  EXPECT_THROW((void)h5::open_file(path("empty.h5")), IoError);
}

TEST_F(Hdf5, TruncatedAtAnyPlaceIsRefused) {
  write_sample("whole.h5");
  const auto size = fs::file_size(path("whole.h5"));
  for (const std::uintmax_t length : {size - 1, size / 2, size / 4, std::uintmax_t{100}, std::uintmax_t{8}}) {
    fs::copy_file(path("whole.h5"), path("cut.h5"), fs::copy_options::overwrite_existing);
    fs::resize_file(path("cut.h5"), length);
    EXPECT_THROW((void)h5::open_file(path("cut.h5")).doubles("data"), IoError) << length;
  }
}

TEST_F(Hdf5, OneFlippedBitInTheDataIsFound) {
  write_sample("whole.h5");
  const double marker = 2500.5;
  std::string bytes(fs::file_size(path("whole.h5")), '\0');
  std::ifstream(path("whole.h5"), std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const std::size_t place = bytes.find(std::string(reinterpret_cast<const char*>(&marker), sizeof marker));
  ASSERT_NE(place, std::string::npos);
  bytes[place + 3] = static_cast<char>(bytes[place + 3] ^ 1);
  std::ofstream(path("flipped.h5"), std::ios::binary) << bytes;
  EXPECT_THROW((void)h5::open_file(path("flipped.h5")).doubles("data"), IoError);
  EXPECT_EQ(h5::open_file(path("whole.h5")).doubles("data").size(), 5000U);
}

TEST_F(Hdf5, WithoutCommitNothingIsLeftBehind) {
  {
    h5::AtomicFile file(path("a.h5"));
    file.root().write("data", std::span<const double>(std::vector<double>{1.0}));
    EXPECT_FALSE(fs::exists(path("a.h5")));
  }
  EXPECT_EQ(files(), 0U);
}

TEST_F(Hdf5, TheOldFileStaysUntilCommitAndAsPreviousWhenAsked) {
  write_sample("a.h5", 1);
  {
    h5::AtomicFile file(path("a.h5"), true);
    const h5::Group kept = file.root();  // groups that outlive commit() do no harm
    kept.write("data", std::span<const double>(std::vector<double>{1.0, 2.0}));
    EXPECT_EQ(h5::open_file(path("a.h5")).doubles("data").size(), 1U);
    file.commit();
    EXPECT_THROW(kept.attribute("late", 1.0), IoError);
    EXPECT_THROW(file.commit(), IoError);
  }
  EXPECT_EQ(h5::open_file(path("a.h5")).doubles("data").size(), 2U);
  EXPECT_EQ(h5::open_file(path("a.h5.previous")).doubles("data").size(), 1U);
  EXPECT_EQ(files(), 2U);
  write_sample("a.h5", 3);
  EXPECT_EQ(h5::open_file(path("a.h5")).doubles("data").size(), 3U);
}

TEST_F(Hdf5, AFileMayBeOpenTwiceAndOutlivesItsHandle) {
  write_sample("a.h5", 4);
  const h5::Group first = h5::open_file(path("a.h5"));
  {
    const h5::Group second = h5::open_file(path("a.h5"));
    EXPECT_EQ(second.doubles("data"), first.doubles("data"));
  }
  EXPECT_EQ(first.doubles("data").size(), 4U);
}

TEST_F(Hdf5, UnwritablePlacesAreFileTrouble) {
  EXPECT_THROW(h5::AtomicFile(path("no/such/folder/a.h5")), IoError);
  fs::create_directories(path("taken.h5/inner"));
  h5::AtomicFile file(path("taken.h5"));
  EXPECT_THROW(file.commit(), IoError);
}

TEST_F(Hdf5, ProvenanceIsWritten) {
  {
    h5::AtomicFile file(path("a.h5"));
    Provenance p = build_provenance();
    p.threads = 3;
    p.seed = 42;
    p.command = "softgrain run x.toml";
    p.scene = "a = 1\n";
    write_provenance(file.root(), p);
    file.commit();
  }
  const h5::Group group = h5::open_file(path("a.h5")).open("provenance");
  EXPECT_EQ(group.integer("schema_version"), kSchemaVersion);
  EXPECT_EQ(group.integer("threads"), 3);
  EXPECT_EQ(group.integer("seed"), 42);
  EXPECT_EQ(group.text("scene"), "a = 1\n");
  EXPECT_FALSE(group.text("version").empty());
  EXPECT_FALSE(group.text("commit").empty());
  EXPECT_NE(group.text("compiler").find("-W"), std::string::npos);
}

}  // namespace
}  // namespace softgrain
