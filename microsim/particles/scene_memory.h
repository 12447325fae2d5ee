// How much memory a scene takes, and how much there is.
#pragma once

#include <cstdint>
#include <string>

namespace softgrain {

/// What a run holds at its peak, per grain and per listed pair, as measured with two threads on the packings of
/// tests/reference/bench (20,000 and 50,000 grains, size ratio 1 to 50; within 20 %). A grain: state, forces of two
/// steps, neighbour search. A pair: bodies, constants, history of two steps, its share of the forces, and copies while
/// the list is made anew.
inline constexpr double kBytesPerGrain = 500.0;
inline constexpr double kBytesPerPair = 190.0;
/// Listed pairs per grain of dense packings.
inline constexpr double kPairsPerGrain = 4.0;

/// Peak memory per disk and per listed pair of disks, as measured on square lattices of 40,000 and 160,000 whose lists
/// were made anew.
inline constexpr double kBytesPerDisk = 300.0;
inline constexpr double kBytesPerDiskPair = 150.0;

/// [bytes]
double estimated_memory(std::int64_t grains, double pairs, int dimension = 3);

/// Empty when a packing of so many grains fits into `available` bytes (0: unknown, anything fits); else the sentence
/// that says what it takes and how many grains would fit.
std::string memory_problem(std::int64_t grains, double available);

/// Memory that can be taken without pushing others out (MemAvailable of Linux) [bytes]; 0 when unknown.
double available_memory();

/// Most memory that this process has held so far [bytes]; 0 when unknown.
double peak_memory();

}  // namespace softgrain
