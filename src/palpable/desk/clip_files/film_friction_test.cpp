#include "palpable/desk/clip_files/film_friction.h"

#include "palpable/common/base/output_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>

namespace palpable {
namespace {

TEST_CASE("a clip states its coefficient of friction, or none", "[clip_files][friction]") {
  const test::ScratchFolder folder("film_friction");
  const std::filesystem::path clip = folder.path() / "clip";
  make_folder(clip / "truth");
  CHECK_FALSE(read_film_friction(clip));
  for (const double coefficient : {0.3, 0.0, 1.0 / 3.0}) {
    write_film_friction(clip, coefficient);
    CHECK(read_film_friction(clip) == coefficient);
  }
  for (const char* wrong : {"-0.1\n", "much\n", "11", "0.3 0.4"}) {
    INFO(wrong);
    write_whole_file(clip / "truth" / "friction.txt", wrong);
    CHECK_THROWS_WITH(read_film_friction(clip), Catch::Matchers::Contains("friction.txt") &&
                                                    Catch::Matchers::Contains("from 0 to 10"));
  }
}

}  // namespace
}  // namespace palpable
