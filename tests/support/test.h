/// @file
/// The only header that includes the test framework, so that replacing it changes a single file.
#pragma once

#include <catch2/catch.hpp>

#include <cstdlib>
#include <iostream>
#include <random>
#include <string>

namespace palpable::test {

/// A tolerance with its reason: `tolerance(1e-12, "five products of numbers near 1")`.
/// PALPABLE_TOLERANCE_SCALE=0 sets all tolerances to 0; the failures then print the real
/// differences, which shows tolerances that are too large.
inline double tolerance(double value, const char* /*reason*/) {
  static const double scale = [] {
    const char* text = std::getenv("PALPABLE_TOLERANCE_SCALE");
    return text != nullptr ? std::strtod(text, nullptr) : 1.0;
  }();
  return value * scale;
}

/// A random generator for case number `seed`; print the seed (INFO) so that a single case
/// can be repeated.
inline std::mt19937_64 random_case(unsigned seed) { return std::mt19937_64(seed); }

/// Number of calls of skip() in this run; read by main().
inline int skipped_cases = 0;
inline constexpr int kSkippedExitCode = 77;

/// Prints that the current case cannot run, and why: "SKIPPED: no display (in 'a window opens')".
inline void skip(const std::string& reason) {
  ++skipped_cases;
  std::cout << "SKIPPED: " << reason << " (in '" << Catch::getResultCapture().getCurrentTestName()
            << "')" << std::endl;
}

}  // namespace palpable::test

/// Ends a test case that cannot run here. If no other case of the program ran, it exits with
/// kSkippedExitCode, and ctest reports Skipped; the reason is in the log.
#define PALPABLE_SKIP(reason)     \
  do {                            \
    palpable::test::skip(reason); \
    return;                       \
  } while (false)
