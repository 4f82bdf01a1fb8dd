#include "palpable/live/player/things_file.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("a hands file is read line by line, and what is wrong is named with its line",
          "[player][things]") {
  const test::ScratchFolder folder("things_file");
  const auto file = folder / "hands.jsonl";
  test::write_bytes(
      file,
      "{\"time\":0.5,\"things\":[{\"id\":4,\"capsules\":[[0,0,0,0,0,1,0.1,0.2]]}]}\r\n"
      "\n"
      "{\"time\":1,\"things\":[]}\n"
      "{\"time\":1,\"things\":[]}\n");
  ThingsFile things(file);
  ThingsLine line;
  REQUIRE(things.next(line));
  CHECK(line.time == 0.5);
  CHECK(line.things.front().id == 4);
  CHECK(line.capsules.front().rb == 0.2);
  REQUIRE(things.next(line));
  CHECK(line.time == 1);
  CHECK(line.things.empty());
  CHECK(line.capsules.empty());
  CHECK_THROWS_WITH(things.next(line),
                    Contains("hands.jsonl: line 4: ") && Contains("times must grow"));
}

TEST_CASE("the end of a hands file, and a file that is not there", "[player][things]") {
  const test::ScratchFolder folder("things_file_end");
  const auto file = folder / "hands.jsonl";
  test::write_bytes(file, "{\"time\":0.5,\"things\":[]}");
  ThingsFile things(file);
  ThingsLine line;
  CHECK(things.next(line));
  CHECK_FALSE(things.next(line));
  CHECK_FALSE(things.next(line));
  CHECK_THROWS_WITH(ThingsFile(folder / "none.jsonl"), Contains("none.jsonl: "));
}

}  // namespace
}  // namespace palpable
