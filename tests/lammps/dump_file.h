// Dumps of LAMMPS, read back by tests.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace softgrain::test {

using State = std::map<int, std::vector<double>>;

/// A dump: id, then numbers.
inline State read_dump(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && line.rfind("ITEM: ATOMS", 0) != 0) {
  }
  State out;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    int id = 0;
    words >> id;
    double x = 0.0;
    while (words >> x) out[id].push_back(x);
  }
  return out;
}

}  // namespace softgrain::test
