#include "palpable/live/sources/picture_clock.h"

#include "tests/support/test.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

constexpr double kPeriod = 1.0 / 30;
constexpr double kStart = 1000;
constexpr double kDelay = 0.02;  // s from the exposure to the arrival

// The system's time at which picture i of these tests is taken.
double taken(int i) { return kStart + 0.3 + i * kPeriod; }

// The time that the clock gives each picture; 0: left out.
std::vector<double> times(PictureClock& clock, const std::vector<double>& stamps,
                          bool is_system_clock = true) {
  std::vector<double> found;
  int i = 0;
  for (const double stamp : stamps) {
    clock.add({stamp, taken(i++) + kDelay, is_system_clock});
    found.push_back(clock.trouble().empty() ? clock.time() : 0);
  }
  return found;
}

PictureClock started() {
  PictureClock clock;
  clock.start(kStart);
  return clock;
}

TEST_CASE("right stamps are the times, also of a picture that was read late", "[sources][camera]") {
  PictureClock clock = started();
  CHECK(times(clock, {taken(0), taken(1), taken(2)}) == std::vector{taken(0), taken(1), taken(2)});
  clock.add({taken(3), taken(3) + 50, true});  // the program was stopped for 50 s
  CHECK(clock.trouble().empty());
  CHECK(clock.time() == taken(3));
}

TEST_CASE("first pictures with stamps from before the stream are left out", "[sources][camera]") {
  PictureClock clock = started();
  CHECK(times(clock, {kStart - 40, kStart - 39.9, taken(2), taken(3)}) ==
        std::vector{0.0, 0.0, taken(2), taken(3)});
  clock = started();
  clock.add({kStart - 40, taken(0), true});
  CHECK_THAT(clock.trouble(), Contains("40.000 s before the start of the stream"));
}

TEST_CASE("a stamp of no time at all leaves its picture out", "[sources][camera]") {
  PictureClock clock = started();
  CHECK(times(clock, {4154505010.2, taken(1), taken(2)}) == std::vector{0.0, taken(1), taken(2)});
  clock.add({taken(3) + 5, taken(3), true});
  CHECK_THAT(clock.trouble(), Contains("5.000 s after its arrival"));
}

TEST_CASE("a driver with another clock is believed once its stamps advance as time does",
          "[sources][camera]") {
  constexpr double kWall = 1.7e9;  // s since 1970
  std::vector<double> stamps;
  for (int i = 0; i < 5; ++i) stamps.push_back(kWall + taken(i));
  // It says so: no picture is lost. Times begin with the first arrival.
  PictureClock clock = started();
  std::vector<double> found = times(clock, stamps, false);
  for (int i = 0; i < 5; ++i) {
    INFO(i);
    CHECK(found[i] == Approx(taken(i) + kDelay).margin(1e-6));  // rounding of 1.7e9
  }
  // It claims to have the system's clock (uvcvideo's parameter clock=REALTIME).
  clock = started();
  found = times(clock, stamps);
  CHECK(found[0] == 0);
  CHECK(found[1] == 0);
  for (int i = 2; i < 5; ++i) CHECK(found[i] == Approx(taken(i) + kDelay).margin(1e-6));
  // Its first stamp is of an earlier stream.
  clock = started();
  stamps[0] -= 60;
  found = times(clock, stamps, false);
  CHECK(found[1] == 0);
  CHECK(found[2] == 0);
  for (int i = 3; i < 5; ++i) CHECK(found[i] == Approx(taken(i) + kDelay).margin(1e-6));
}

TEST_CASE("without stamps, or with stamps that do not advance, pictures have their arrival's time",
          "[sources][camera]") {
  PictureClock clock = started();
  CHECK(times(clock, {0, -12, 0}) ==
        std::vector{taken(0) + kDelay, taken(1) + kDelay, taken(2) + kDelay});
  clock = started();
  CHECK(times(clock, {kStart, kStart, kStart}) ==
        std::vector{kStart, taken(1) + kDelay, taken(2) + kDelay});
  // Old and not advancing: only the first pictures are lost.
  clock = started();
  CHECK(times(clock, {kStart - 9, kStart - 9, kStart - 9, kStart - 9}) ==
        std::vector{0.0, 0.0, taken(2) + kDelay, taken(3) + kDelay});
}

}  // namespace
}  // namespace palpable
