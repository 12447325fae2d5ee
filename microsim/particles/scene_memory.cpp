#include "microsim/particles/scene_memory.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

namespace softgrain {

namespace {

/// A line "NAME:   123 kB" of one of Linux's own files [bytes]; 0 when there is none.
double kilobytes_in(const char* path, const std::string& name) {
  std::ifstream in(path);
  std::string word;
  while (in >> word) {
    double value = 0.0;
    if (word == name + ":" && in >> value) return 1024.0 * value;
  }
  return 0.0;
}

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

}  // namespace

double estimated_memory(std::int64_t grains, double pairs, int dimension) {
  const auto n = static_cast<double>(grains);
  return dimension == 3 ? kBytesPerGrain * n + kBytesPerPair * pairs : kBytesPerDisk * n + kBytesPerDiskPair * pairs;
}

std::string memory_problem(std::int64_t grains, double available) {
  const double needed = estimated_memory(grains, kPairsPerGrain * static_cast<double>(grains));
  if (!(available > 0.0) || needed <= available) return "";
  const double each = kBytesPerGrain + kPairsPerGrain * kBytesPerPair;
  const auto whole = [](double x) { return std::to_string(static_cast<std::int64_t>(x)); };
  return "needs about " + gigabytes(needed) + " of memory (" + whole(kBytesPerGrain) + " bytes per grain and " +
         whole(kBytesPerPair) + " per listed pair, about " + whole(kPairsPerGrain) + " of which come with a grain), " +
         gigabytes(available) + " are free; allowed: up to " + whole(std::floor(available / each)) + " grains";
}

double available_memory() { return kilobytes_in("/proc/meminfo", "MemAvailable"); }

double peak_memory() { return kilobytes_in("/proc/self/status", "VmHWM"); }

}  // namespace softgrain
