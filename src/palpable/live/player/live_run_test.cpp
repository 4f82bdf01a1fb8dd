#include "palpable/live/player/live_run.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/desk/clip_files/film_friction.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <string>

namespace palpable {
namespace {

TEST_CASE("images have the friction of their scene.toml, else of the truth, else none",
          "[player][friction]") {
  const test::ScratchFolder folder("friction_of_images");
  const std::filesystem::path frames = folder / "frames";
  make_folder(frames);
  make_folder(folder / "truth");
  CHECK(friction_of_images(frames) == 0.0);
  CHECK(friction_of_images(folder / "walk.mp4") == 0.0);
  write_film_friction(folder.path(), 0.3);
  CHECK(friction_of_images(frames) == 0.3);
  CHECK(friction_of_images(frames.string() + "/") == 0.3);
  CHECK(friction_of_images(frames / "*.png") == 0.3);
  write_whole_file(frames / "scene.toml", "press_static = true\n");
  CHECK(friction_of_images(frames) == 0.3);
  write_whole_file(frames / "scene.toml", "friction = 0\n");
  CHECK(friction_of_images(frames) == 0.0);
  write_whole_file(frames / "scene.toml", "friction = 0.5\n");
  CHECK(friction_of_images(frames) == 0.5);
  CHECK_FALSE(friction_of_images("/dev/video0"));
  write_whole_file(frames / "scene.toml", "friction = 11\n");
  CHECK_THROWS_AS(friction_of_images(frames), Error);
}

}  // namespace
}  // namespace palpable
