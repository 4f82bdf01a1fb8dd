#include "palpable/desk/clip_writer/sequence_folder.h"

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/live/render/gl_context.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>

using namespace palpable;
namespace fs = std::filesystem;

namespace {

/// The contents of all files under a folder, by their relative paths.
std::map<std::string, std::string> contents_of(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    contents[entry.path().lexically_relative(folder).string()] = test::file_bytes(entry.path());
  }
  return contents;
}

}  // namespace

TEST_CASE("an interrupted film leaves no truth that could be scored", "[clip_writer][gl]") {
  if (!GlContext::offscreen().ok()) PALPABLE_SKIP("no OpenGL 4.5 context here");
  const ReducedBody body = value_or_throw(read_pressable_body("tests/data/ball_v1.palpable"));
  const test::ScratchFolder scratch("half_film");
  const fs::path camera = scratch.path() / "truth" / "camera.toml";
  const auto interrupt = [&](const ProgressReport& step) {
    CHECK_FALSE(fs::exists(camera));
    if (step.done >= 2) throw Error("enough");
  };
  CHECK_THROWS_AS(write_sequence(body, {"press", 3, 5, "ball", 1}, scratch.path(), interrupt),
                  Error);
  CHECK(fs::exists(scratch.path() / "frames" / "left" / "000001.jpg"));
  CHECK_FALSE(fs::exists(camera));
  // The remains are replaced by the next film.
  write_sequence(body, {"press", 2, 5, "ball", 1}, scratch.path(), {});
  CHECK(fs::exists(camera));
  CHECK_FALSE(fs::exists(scratch.path() / "frames" / "left" / "000002.jpg"));
  CHECK(std::distance(fs::directory_iterator(scratch.path()), {}) == 2);
  // A complete film is not.
  CHECK_THROWS_WITH(write_sequence(body, {"press", 2, 5, "ball", 1}, scratch.path(), {}),
                    Catch::Contains("frames: exists"));
}

TEST_CASE("a film says how much of a touch is seen, and how far from a touch the hand is",
          "[clip_writer][gl]") {
  if (!GlContext::offscreen().ok()) PALPABLE_SKIP("no OpenGL 4.5 context here");
  const ReducedBody body = value_or_throw(read_pressable_body("tests/data/ball_v1.palpable"));
  const test::ScratchFolder scratch("film_contact");
  write_sequence(body, {"press", 130, 5, "ball", 2}, scratch.path(), {});
  int touching = 0, near = 0;
  std::optional<double> gap_before;
  for (const ContactLine& line : read_contacts(scratch.path() / "truth" / "contact.jsonl")) {
    touching += line.touching;
    CHECK(line.seen_share.has_value() == line.touching);
    if (line.seen_share) CHECK((0.0 <= *line.seen_share && *line.seen_share <= 1.0));
    if (line.touching) {
      CHECK_FALSE(line.gap);
      // The gap in the frame before a touch: a hand moves at less than 0.5 m/s.
      if (gap_before) CHECK(*gap_before < test::tolerance(0.5 / 30, "motion in one frame"));
    }
    near += line.gap && *line.gap > 0.0;
    gap_before = line.gap;
  }
  CHECK(touching > 0);
  CHECK(near > 0);
}

TEST_CASE("two threads film what one films, byte for byte", "[clip_writer][gl]") {
  if (!GlContext::offscreen().ok()) PALPABLE_SKIP("no OpenGL 4.5 context here");
  const ReducedBody body = value_or_throw(read_pressable_body("tests/data/ball_v1.palpable"));
  const test::ScratchFolder scratch("film");
  constexpr int kFrames = 3;
  for (const int threads : {1, 2})
    write_sequence(body, {"blur", kFrames, 5, "ball", threads},
                   scratch.path() / std::to_string(threads), {});
  const auto one = contents_of(scratch.path() / "1");
  CHECK(one == contents_of(scratch.path() / "2"));
  // Each frame has two pictures, depth and labels.
  CHECK(one.size() > 4 * kFrames);
  // The truth holds the skin of the filmed body and its pose.
  CHECK(one.at("truth/scene.toml") == one.at("frames/scene.toml"));
  const SurfaceMesh skin =
      value_or_throw(read_valued_ply(scratch.path() / "1/truth" / kBodySkinFile, "")).surface;
  CHECK(skin.vertices == body.surface.vertices);
  CHECK(skin.triangles == body.surface.triangles);
  CHECK(one.at("frames/left/000001.jpg") != one.at("frames/left/000002.jpg"));
}
