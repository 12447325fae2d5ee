// Small text files: atomic writing, reading, writable directories.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/core/error.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

class TextFile : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() / ("softgrain_text_" + std::to_string(::getpid()));
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }

 private:
  fs::path directory_;
};

TEST_F(TextFile, RoundTripReplacesAndLeavesNoTemporary) {
  const std::string text("first\r\n\0µ end", 14);
  write_text_atomic(path("a.txt"), "old and much longer than the new text");
  write_text_atomic(path("a.txt"), text);
  EXPECT_EQ(read_text(path("a.txt")), text);
  write_text_atomic(path("a.txt"), "");
  EXPECT_EQ(read_text(path("a.txt")), "");
  EXPECT_EQ(files(), 1U);
}

TEST_F(TextFile, FailedWriteLeavesTheOldStateAndNoTemporary) {
  fs::create_directories(path("taken/inner"));
  EXPECT_THROW(write_text_atomic(path("taken"), "text"), IoError);
  EXPECT_TRUE(fs::is_directory(path("taken/inner")));
  EXPECT_EQ(files(), 1U);
  EXPECT_THROW(write_text_atomic(path("absent/a.txt"), "text"), IoError);
}

TEST_F(TextFile, AMissingFolderIsNamed) {
  const auto refused = [](const std::string& file) {
    try {
      write_text_atomic(file, "text");
    } catch (const IoError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused(path("absent/a.txt")), path("absent/a.txt") + ": there is no folder " + path("absent") +
                                               "; make it first, or choose another place");
  write_text_atomic(path("file"), "text");
  EXPECT_EQ(refused(path("file/a.txt")), path("file/a.txt") + ": " + path("file") + " is no folder");
  EXPECT_EQ(refused("/proc/a.txt").find(".tmp"), std::string::npos) << refused("/proc/a.txt");
}

TEST_F(TextFile, ReadingNamesTheFile) {
  try {
    (void)read_text(path("absent.txt"));
    FAIL() << "no error";
  } catch (const IoError& e) {
    EXPECT_EQ(std::string(e.what()), path("absent.txt") + ": no such file");
  }
  EXPECT_THROW((void)read_text(path("")), IoError);
}

TEST_F(TextFile, WritableDirectoryIsMadeWithParentsAndLeftEmpty) {
  require_writable_directory(path("a/b/c"));
  EXPECT_TRUE(fs::is_empty(path("a/b/c")));
  EXPECT_NO_THROW(require_writable_directory(path("a/b/c")));
}

TEST_F(TextFile, UnwritableDirectoriesAreFileTrouble) {
  write_text_atomic(path("file"), "text");
  EXPECT_THROW(require_writable_directory(path("file")), IoError);
  EXPECT_THROW(require_writable_directory(path("file/below")), IoError);
  EXPECT_THROW(require_writable_directory("/proc/softgrain"), IoError);
}

TEST(Interrupt, FlagIsSetAndCleared) {
  clear_interrupt();
  EXPECT_FALSE(interrupt_requested());
  request_interrupt();
  EXPECT_TRUE(interrupt_requested());
  clear_interrupt();
  EXPECT_FALSE(interrupt_requested());
}

}  // namespace
}  // namespace softgrain
