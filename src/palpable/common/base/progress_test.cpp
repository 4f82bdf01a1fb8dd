#include "palpable/common/base/progress.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("durations are given in at most two units", "[base][progress]") {
  CHECK(duration_text(0.4) == "0 s");
  CHECK(duration_text(59.4) == "59 s");
  CHECK(duration_text(59.6) == "1 min 00 s");
  CHECK(duration_text(125) == "2 min 05 s");
  CHECK(duration_text(2 * 3600 + 61) == "2 h 01 min");
}

TEST_CASE("the time left follows from the part that is done", "[base][progress]") {
  const std::string line = progress_line({"solving", 3, 12, "1 short"}, 30.0, 8);
  CHECK_THAT(line, Contains("solving") && Contains("[##......]") && Contains(" 25 %") &&
                       Contains("1 min 30 s left") && Contains("1 short"));
  CHECK_THAT(progress_line({"solving", 0, 12, ""}, 30.0, 8), !Contains("left"));
  CHECK_THAT(progress_line({"solving", 12, 12, ""}, 30.0, 8), Contains("100 %  30 s"));
}

TEST_CASE("the part done by an earlier run does not affect the estimate of the time left",
          "[base][progress]") {
  // Half was done before; a further quarter took 30 s, so the last quarter takes as long.
  CHECK_THAT(progress_line({"solving", 9, 12, ""}, 30.0, 8, 0.5), Contains("30 s left"));
  CHECK_THAT(progress_line({"solving", 6, 12, ""}, 30.0, 8, 0.5), !Contains("left"));
}

}  // namespace

}  // namespace palpable
