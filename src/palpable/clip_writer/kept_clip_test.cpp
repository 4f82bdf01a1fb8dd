#include "palpable/clip_writer/kept_clip.h"

#include "palpable/base/error.h"
#include "palpable/reduced/body_file.h"
#include "palpable/render/gl_context.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <fstream>

namespace palpable {
namespace {

namespace fs = std::filesystem;

TEST_CASE("the clip of a live run is filmed once for a body, and anew for another",
          "[clip_writer][gl]") {
  if (!GlContext::offscreen().ok()) PALPABLE_SKIP("no OpenGL 4.5 context here");
  const test::ScratchFolder scratch("kept_clip");
  const fs::path file = scratch.path() / "ball.palpable";
  fs::copy_file("tests/data/ball_v1.palpable", file);
  const ReducedBody body = value_or_throw(read_pressable_body(file));
  const KeptClipOrder order{scratch.path() / "clip", file, "1.0", 2};
  const fs::path frames = kept_clip(body, order, {});
  const fs::path picture = frames / "left" / "000001.jpg";
  CHECK(fs::exists(picture));
  fs::remove(picture);  // comes back when the clip is filmed again
  CHECK(kept_clip(body, order, {}) == frames);
  CHECK_FALSE(fs::exists(picture));

  // The same body with other bytes: a body baked anew.
  std::ofstream(file, std::ios::app | std::ios::binary) << "more";
  (void)kept_clip(body, order, {});
  CHECK(fs::exists(picture));

  // A clip whose filming was interrupted has no label and is in the way, as anything else is.
  fs::remove(order.folder / "made_for.txt");
  CHECK_THROWS_WITH(kept_clip(body, order, {}), Catch::Contains("in the way"));
  CHECK(fs::exists(picture));
}

}  // namespace
}  // namespace palpable
