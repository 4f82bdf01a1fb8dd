#include "palpable/desk/clip_writer/kept_clip.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/live/render/gl_context.h"
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
  fs::remove(picture);  // exists again after the clip is filmed again
  CHECK(kept_clip(body, order, {}) == frames);
  CHECK_FALSE(fs::exists(picture));

  // Other bytes in the body file stand for a body that was baked again.
  std::ofstream(file, std::ios::app | std::ios::binary) << "more";
  (void)kept_clip(body, order, {});
  CHECK(fs::exists(picture));

  // What somebody put into the folder stays when it is filmed again.
  std::ofstream(order.folder / "frames" / "left" / "notes.txt") << "mine";
  std::ofstream(file, std::ios::app | std::ios::binary) << "still more";
  fs::remove(picture);
  (void)kept_clip(body, order, {});
  CHECK(fs::exists(picture));
  CHECK(fs::exists(order.folder / "frames" / "left" / "notes.txt"));

  // While another run films it, it is refused and nothing is removed.
  std::ofstream(file, std::ios::app | std::ios::binary) << "even more";
  {
    const FolderLock other(order.folder);
    CHECK_THROWS_WITH(kept_clip(body, order, {}), Catch::Contains("another run is writing"));
    CHECK(fs::exists(picture));
  }
  (void)kept_clip(body, order, {});

  // A body file in the folder would be removed together with the clip.
  fs::copy_file(file, order.folder / "ball.palpable");
  KeptClipOrder inside = order;
  inside.body_file = order.folder / "ball.palpable";
  inside.version = "1.1";
  CHECK_THROWS_WITH(kept_clip(body, inside, {}), Catch::Contains("ball.palpable: lies where"));
  CHECK(fs::exists(picture));

  // A folder without a clip's label is not touched.
  fs::remove(order.folder / "made_for.txt");
  CHECK_THROWS_WITH(kept_clip(body, order, {}), Catch::Contains("in the way"));
  std::ofstream(order.folder / "made_for.txt") << "a friend\n";
  CHECK_THROWS_WITH(kept_clip(body, order, {}), Catch::Contains("in the way"));
  CHECK(fs::exists(picture));
}

TEST_CASE("a clip whose filming was interrupted is filmed again", "[clip_writer][gl]") {
  if (!GlContext::offscreen().ok()) PALPABLE_SKIP("no OpenGL 4.5 context here");
  const test::ScratchFolder scratch("kept_clip_half");
  const fs::path file = "tests/data/ball_v1.palpable";
  const ReducedBody body = value_or_throw(read_pressable_body(file));
  const KeptClipOrder order{scratch.path() / "clip", file, "1.0", 3};
  const fs::path last = order.folder / "frames" / "left" / "000002.jpg";
  const auto interrupt = [](const ProgressReport& step) {
    if (step.done >= 1) throw Error("enough");
  };
  CHECK_THROWS_WITH(kept_clip(body, order, interrupt), "enough");
  CHECK(fs::exists(order.folder / "frames"));
  fs::remove(last);  // it may or may not have been filmed already
  CHECK(fs::exists(kept_clip(body, order, {}) / "left" / "000002.jpg"));

  // An empty label, as a full disk leaves it.
  std::ofstream(order.folder / "made_for.txt").close();
  fs::remove(last);
  (void)kept_clip(body, order, {});
  CHECK(fs::exists(last));
}

}  // namespace
}  // namespace palpable
