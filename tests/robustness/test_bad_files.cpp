// The cases of tests/robustness/bad, folders in place of files, and files of spheres that are damaged in many ways: one
// line a mistake that names the file, the status that says whose fault it is, nothing written, no signal.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "common/io/text_file.h"
#include "tests/support/refused_files.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

struct Case {
  std::string name;
  std::string command = "check FILE";
  std::string file = "case.toml";
  int status = 2;
  std::vector<std::string> words;
  std::string text;
};

/// "\x41" to "A".
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text.compare(k, 2, "\\x") != 0) {
      out += text[k];
      continue;
    }
    out += static_cast<char>(std::stoi(text.substr(k + 2, 2), nullptr, 16));
    k += 3;
  }
  return out;
}

/// Whether the line is "# KEY: value"; puts the value there.
bool takes(const std::string& line, const std::string& key, std::string& value) {
  const std::string start = "# " + key + ": ";
  if (!line.starts_with(start)) return false;
  value = line.substr(start.size());
  return true;
}

std::vector<Case> read_cases(const std::string& name) {
  std::istringstream in(read_text(std::string(SOFTGRAIN_SOURCE_DIR) + "/tests/robustness/bad/" + name));
  std::vector<Case> cases;
  bool head = false;
  bool escapes = false;
  for (std::string line, value; std::getline(in, line);) {
    if (line.starts_with("=== ")) {
      if (escapes) cases.back().text = unescaped(cases.back().text);
      cases.emplace_back().name = line.substr(4);
      escapes = false;
      head = true;
    } else if (head && takes(line, "expect", value)) {
      cases.back().words.push_back(value);
    } else if (head && takes(line, "status", value)) {
      cases.back().status = std::stoi(value);
    } else if (head && (takes(line, "command", cases.back().command) || takes(line, "file", cases.back().file))) {
    } else if (head && line == "# escapes") {
      escapes = true;
    } else {
      head = false;
      cases.back().text += line + "\n";
    }
  }
  return cases;
}

std::string replaced(std::string text, const std::string& word, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += by.size())
    text.replace(at, word.size(), by);
  return text;
}

class BadFiles : public RefusedFiles {
 protected:
  void expect_cases(const std::string& file, std::size_t least) {
    const std::vector<Case> cases = read_cases(file);
    EXPECT_GE(cases.size(), least);
    for (const Case& c : cases) {
      const std::string path = directory_.file(c.file);
      write_text_atomic(path, c.text);
      ASSERT_FALSE(c.words.empty()) << c.name;
      expect(replaced(replaced(c.command, "FILE", "'" + path + "'"), "OUT", "'" + out() + "'"), c.status, c.words,
             c.name);
    }
  }
};

TEST_F(BadFiles, TextThatIsNoScene) { expect_cases("text.cases", 30); }

TEST_F(BadFiles, ScenesCardsAndCommands) { expect_cases("kinds.cases", 60); }

TEST_F(BadFiles, LawCommands) { expect_cases("law.cases", 12); }

TEST_F(BadFiles, NestingBeyondReason) {
  const std::string path = directory_.file("case.toml");
  const auto many = [](const char* part) {
    std::string text;
    for (int k = 0; k < 100000; ++k) text += part;
    return text;
  };
  for (const std::string& text : {"x = " + many("["), "x = " + many("{a="), many("a.") + "b = 1",
                                  many(many("a.").substr(0, 40).c_str()) + "b = 1"}) {
    write_text_atomic(path, text + "\n");
    expect("check '" + path + "'", 2, {"case.toml:1: "}, text.substr(0, 10));
  }
}

/// The reason stands behind the file, without the words of the C++ library.
TEST_F(BadFiles, AFolderOrALinkToItselfInPlaceOfAFile) {
  fs::create_directories(directory_.file("folder/run.h5"));
  expect("report '" + directory_.file("folder") + "'", 4, {"folder/run.h5: Is a directory"}, "folder");
  fs::create_directory(directory_.file("link"));
  fs::create_symlink("run.h5", directory_.file("link/run.h5"));
  for (const char* command : {"report", "export --to csv"})
    expect(command + (" '" + directory_.file("link") + "'"), 4, {"link/run.h5: Too many levels of symbolic links"},
           command);
}

TEST_F(BadFiles, NothingToCompareNamesAllFilesThatCouldBe) {
  const std::string empty = directory_.file("empty");
  fs::create_directory(empty);
  expect("compare '" + empty + "'", 2,
         {"empty: holds nothing to compare (macro.h5, material.h5, material_NAME.h5, measurements.h5 or law.toml)"},
         "compare");
}

/// What a list of particles may look like when it did not come through.
TEST_F(BadFiles, FilesOfSpheres) {
  const std::string scene = R"(kind = "particles"
[material.glass]
density = 2500.0
E = 1e6
nu = 0.2
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[particles]
file = "many.xyzr"
material = "glass"
[time]
end = 1e-3
)";
  write_text_atomic(directory_.file("case.toml"), scene);
  const auto bad = [&](const std::string& content, int status, const std::string& word) {
    write_text_atomic(directory_.file("many.xyzr"), content);
    expect("check '" + directory_.file("case.toml") + "'", status, {"many.xyzr", word}, word);
  };
  bad("\xef\xbb\xbf"
      "1 1 1 1\n0 0 1 0.01\n",
      2, ":1: must be four finite numbers, N Lx Ly Lz");
  bad("1,1,1,1\n0,0,1,0.01\n", 2, ":1: must be four numbers with blanks or tabs between them");
  bad(std::string("1 1 1 1\n0 0\0 1 0.01\n", 20), 2, ":2: must be four");
  bad("1 1 1 1\n0 0 1 0x1p-3\n", 2, ":2: ");
  bad("1 1 1 1\n0 0 1 0\n", 2, ":2: r = 0.000000: must be above 0");
  bad("1 1 1 1\n0 0 1 1e-120\n", 2, ":2: radius = ");
  bad("-1 1 1 1\n", 2, ":1: N must be a whole number from 1 to 1e8");
  bad("nan 1 1 1\n", 2, ":1: must be four finite numbers");
  bad("\x1f\x8b\x08", 4, "damaged or cut short");
  bad(std::string("\x1f\x8b\x08\0\0\0\0\0\0\x03xyz", 13), 4, "damaged or cut short");
  fs::remove(directory_.file("many.xyzr"));
  fs::create_directory(directory_.file("many.xyzr"));
  expect("check '" + directory_.file("case.toml") + "'", 4, {"many.xyzr"}, "a directory");
}

}  // namespace
