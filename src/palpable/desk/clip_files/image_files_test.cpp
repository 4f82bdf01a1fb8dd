// For each image format: the counts that are written, reading them back, and files that the reader
// refuses.
#include "palpable/desk/clip_files/image_files.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/image_file.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace palpable {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
namespace fs = std::filesystem;
using test::ScratchFolder;

/// A depth image of 0.2 m to 15 m with one unknown pixel.
DepthImage some_depth() {
  DepthImage depth(64, 48);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      depth(x, y) = 0.2f + 0.0047f * static_cast<float>(64 * y + x);
    }
  }
  depth(5, 5) = kUnknown;
  return depth;
}

TEST_CASE("measured depth is in quarters of a millimetre, and impossible values have no depth",
          "[clip_files]") {
  DepthImage depth(4, 2, 0.5f);
  depth(1, 0) = kUnknown;
  depth(2, 0) = 16.3834f;   // 65534 counts are 16.3835 m
  depth(3, 0) = 17.0f;      // beyond the counts
  depth(0, 1) = 0.00012f;   // less than half a count
  depth(1, 1) = 0.300125f;  // halfway between two counts: rounding decides
  MaskImage too_close(4, 2, 0);
  too_close(3, 1) = 255;
  const DepthCounts counts = measured_counts(depth, too_close);
  CHECK(counts(0, 0) == 2000);
  CHECK(counts(1, 0) == kNoDepth);
  CHECK(counts(2, 0) == 65534);
  CHECK(counts(3, 0) == kNoDepth);
  CHECK(counts(0, 1) == kNoDepth);
  CHECK(counts(1, 1) == std::lround(0.300125f / 0.25e-3f));
  CHECK(counts(2, 1) == 2000);
  CHECK(counts(3, 1) == kTooClose);
  CHECK(measured_counts(depth, MaskImage())(3, 1) == 2000);
  CHECK(true_counts(depth)(2, 0) == 65534);
  CHECK(true_counts(depth)(3, 0) == kNoDepth);
  CHECK(true_counts(depth)(1, 1) == std::lround(static_cast<double>(0.300125f) / 0.00025));
}

TEST_CASE("the drawn body's depth is the mean over 2 x 2 pixels if at least two are known",
          "[clip_files]") {
  DepthImage depth(6, 2, 0.4f);
  depth(1, 0) = 0.402f;    // mean of the first block: 0.4005
  depth(2, 0) = kUnknown;  // the second block has two known pixels
  depth(3, 1) = kUnknown;
  depth(4, 0) = kUnknown;  // the third block has one
  depth(5, 0) = kUnknown;
  depth(4, 1) = kUnknown;
  const DepthCounts counts = body_counts(depth);
  CHECK(counts.width() == 3);
  CHECK(counts.height() == 1);
  CHECK(counts(0, 0) == 4005);
  CHECK(counts(1, 0) == 4000);
  CHECK(counts(2, 0) == kNoDepth);
}

TEST_CASE("depth images read back as they were written", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const DepthImage depth = some_depth();
  MaskImage too_close(depth.width(), depth.height(), 0);
  too_close(0, 0) = 255;
  write_measured_depth(folder / "m.png", depth, too_close);
  write_true_depth(folder / "t.png", depth);
  write_body_depth(folder / "b.png", depth);
  CHECK(*read_depth_counts(folder / "m.png") == measured_counts(depth, too_close));
  CHECK(*read_depth_counts(folder / "t.png") == true_counts(depth));
  CHECK(*read_depth_counts(folder / "b.png") == body_counts(depth));
  CHECK_FALSE(read_depth_counts(folder / "none.png").has_value());
  const DepthImage metres = depth_of(true_counts(depth), kDepthUnit);
  CHECK(std::isnan(metres(5, 5)));
  CHECK(std::abs(metres(6, 5) - depth(6, 5)) <= 0.000126f);
  // The two kinds of file are compressed with different settings, so their sizes differ.
  write_measured_depth(folder / "m2.png", depth, MaskImage());
  DepthImage half(4, 2, 0.5F);  // of which a half fits into the file
  half(0, 0) = half(1, 0) = 20;
  half(2, 0) = std::nanf("");
  MaskImage close(4, 2, 0);
  close(3, 0) = 255;
  CHECK(write_measured_depth(folder / "h.png", half, close) == 0.5);
  CHECK(test::file_bytes(folder / "m2.png").size() != test::file_bytes(folder / "t.png").size());
}

TEST_CASE("masks are thresholded at 127, labels stay unchanged", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  MaskImage mask(5, 4, 0);
  mask(2, 1) = 255;
  write_mask(folder / "m.png", mask);
  CHECK(*read_mask(folder / "m.png") == mask);
  GrayImage labels(5, 4, 3);
  labels(0, 0) = 127;
  labels(1, 0) = 128;
  write_labels(folder / "l.png", labels);
  CHECK(*read_labels(folder / "l.png") == labels);
  const MaskImage split = *read_mask(folder / "l.png");
  CHECK(split(0, 0) == 0);
  CHECK(split(1, 0) == 255);
  CHECK_FALSE(read_mask(folder / "none.png").has_value());
  CHECK_FALSE(read_labels(folder / "none.png").has_value());
}

TEST_CASE("files that are no images are refused by name", "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  test::write_bytes(folder / "d.png", "no image");
  CHECK_THROWS_WITH(read_depth_counts(folder / "d.png"), Catch::Contains("d.png is no image"));
  CHECK_THROWS_WITH(read_mask(folder / "d.png"), Catch::Contains("d.png is no image"));
  write_mask(folder / "m.png", MaskImage(3, 2, 255));
  CHECK_THROWS_WITH(read_depth_counts(folder / "m.png"),
                    Catch::Contains("m.png is not a 16-bit gray image"));
  CHECK_THROWS_AS(write_mask(folder / "nowhere/m.png", MaskImage(3, 2, 255)), Error);
}

TEST_CASE("an image that cannot be written is an error, however small, and no part of it remains",
          "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  const auto full = Catch::EndsWith("i.png: cannot be written: No space left on device");
  fs::create_symlink("/dev/full", folder / "i.png");
  CHECK_THROWS_WITH(write_mask(folder / "i.png", MaskImage(3, 2, 255)), full);
  CHECK_THROWS_WITH(write_body_depth(folder / "i.png", some_depth()), full);
  fs::create_symlink("/dev/full", folder / "i.jpg");
  CHECK_THROWS_WITH(write_jpeg(folder / "i.jpg", ColorImage(8, 8)),
                    Catch::EndsWith("i.jpg: cannot be written: No space left on device"));
  const test::FileSizeLimit limit(100);
  CHECK_THROWS_WITH(write_true_depth(folder / "d.png", some_depth()),
                    Catch::EndsWith("d.png: cannot be written: File too large"));
  CHECK_FALSE(fs::exists(folder / "d.png"));
}

TEST_CASE("through_jpeg() gives the picture that a reader of the file gets", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  ColorImage picture(32, 16);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      picture(x, y) = {static_cast<std::uint8_t>(8 * x), static_cast<std::uint8_t>(16 * y), 200};
    }
  }
  write_jpeg(folder / "p.jpg", picture);
  ImageFileReader reader;
  ColorImage read;
  REQUIRE(reader.read_color(folder / "p.jpg", read).ok());
  CHECK(through_jpeg(picture) == read);
  CHECK_FALSE(read == picture);
  CHECK(std::abs(read(31, 8).r - picture(31, 8).r) < 12);
}

TEST_CASE("frames are counted by their names, and other names are refused", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  CHECK(frame_name(7, ".png") == "000007.png");
  CHECK(frames_in(folder / "nowhere") == 0);
  CHECK(frames_in(folder.path()) == 0);
  CHECK_NOTHROW(expect_frames_in(folder.path(), ".png"));
  test::write_bytes(folder / "frame_3.png", "");
  CHECK(frames_in(folder.path()) == 0);
  CHECK_THROWS_WITH(expect_frames_in(folder.path(), ".png"),
                    Catch::Contains("frame_3.png is no frame's name: they are 000000.png"));
  test::write_bytes(folder / "000041.png", "");
  CHECK(frames_in(folder.path()) == 42);
  CHECK_NOTHROW(expect_frames_in(folder.path(), ".png"));
  CHECK_THROWS_WITH(expect_frames_in(folder.path(), ".ply"), Catch::Contains("000000.ply"));
  CHECK_THROWS_WITH(expect_frames_in(folder / "frame_3.png", ".png"),
                    Catch::Contains("is no folder"));
}

}  // namespace
}  // namespace palpable
