/// @file
/// The only place that names the test framework, so that changing it is a change to one file.
#pragma once

#include <catch2/catch.hpp>

#include <cstdlib>
#include <iostream>
#include <random>
#include <string>

namespace palpable::test {

/// A tolerance with its reason next to it: `tolerance(1e-12, "five products of numbers near 1")`.
/// PALPABLE_TOLERANCE_SCALE=0 turns every tolerance off, and the failures then print how large
/// the real differences are: the way to find a tolerance that hides a bug.
inline double tolerance(double value, const char* /*reason*/) {
  static const double scale = [] {
    const char* text = std::getenv("PALPABLE_TOLERANCE_SCALE");
    return text != nullptr ? std::strtod(text, nullptr) : 1.0;
  }();
  return value * scale;
}

/// A generator for case number `seed`; print the seed (INFO) so that one case can be run alone.
inline std::mt19937_64 random_case(unsigned seed) { return std::mt19937_64(seed); }

/// How often it was said in this run that a case could not run; main() reads it.
inline int skipped_cases = 0;
inline constexpr int kSkippedExitCode = 77;

/// Says that the case that runs now cannot, and why: "SKIPPED: no display (in 'a window opens')".
inline void skip(const std::string& reason) {
  ++skipped_cases;
  std::cout << "SKIPPED: " << reason << " (in '" << Catch::getResultCapture().getCurrentTestName()
            << "')" << std::endl;
}

}  // namespace palpable::test

/// Ends a test case that cannot run here. A program of which no other case ran ends with
/// kSkippedExitCode, and ctest reports it as Skipped; the reason is in the log.
#define PALPABLE_SKIP(reason)     \
  do {                            \
    palpable::test::skip(reason); \
    return;                       \
  } while (false)
