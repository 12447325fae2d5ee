// Writes the tiny scene of every kind into DIRECTORY/KIND/, with what it needs beside it, and DIRECTORY/scenes.csv:
// name, command of the program, exit status. tests/same_bits.py runs them with two programs and compares.
//
//   every_kind_scenes DIRECTORY
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/support/every_kind.h"

int main(int argc, char** argv) {
  using namespace softgrain;
  if (argc != 2) {
    std::fprintf(stderr, "every_kind_scenes DIRECTORY\n");
    return 2;
  }
  const std::string root = argv[1];
  std::string list = "name,command,status\n";
  for (const test::KindScene& kind : test::every_kind()) {
    const std::string directory = root + "/" + kind.name;
    std::filesystem::create_directories(directory);
    write_text_atomic(directory + "/scene.toml", kind.text);
    save_card(synthetic::card(), directory + "/law.toml");
    list += fmt::format("{},{},{}\n", kind.name, kind.command, kind.status);
  }
  write_text_atomic(root + "/scenes.csv", list);
  return 0;
}
