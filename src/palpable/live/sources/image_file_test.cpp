#include "palpable/live/sources/image_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/imgcodecs.hpp>

#include <string>
#include <vector>

namespace palpable {
namespace {

using test::file_bytes;
using test::ScratchFolder;
using test::write_bytes;

// Not square; every pixel has another colour, with blue far from red.
cv::Mat some_picture() {
  cv::Mat bgr(24, 40, CV_8UC3);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      bgr.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(128 + y),
                                 static_cast<std::uint8_t>(200 + x)};
    }
  }
  return bgr;
}

TEST_CASE("a colour image comes in as red, green, blue, top row first", "[sources][image_file]") {
  const ScratchFolder folder("image_color");
  ImageFileReader reader;
  ColorImage image;
  cv::imwrite((folder / "a.png").string(), some_picture());
  REQUIRE(reader.read_color(folder / "a.png", image).ok());
  REQUIRE((image.width() == 40 && image.height() == 24));
  CHECK(image(7, 3) == Rgb{207, 131, 7});
  cv::imwrite((folder / "gray.png").string(), cv::Mat(6, 5, CV_8UC1, cv::Scalar(77)));
  REQUIRE(reader.read_color(folder / "gray.png", image).ok());
  REQUIRE((image.width() == 5 && image.height() == 6));
  CHECK(image(4, 5) == Rgb{77, 77, 77});
}

TEST_CASE("a 16-bit image keeps its numbers, and no other is taken for one",
          "[sources][image_file]") {
  const ScratchFolder folder("image_16");
  cv::Mat depth(3, 5, CV_16UC1, cv::Scalar(0));
  depth.at<std::uint16_t>(2, 4) = 65535;
  depth.at<std::uint16_t>(1, 0) = 731;
  cv::imwrite((folder / "d.png").string(), depth);
  cv::imwrite((folder / "c.png").string(), some_picture());
  ImageFileReader reader;
  Image<std::uint16_t> image;
  REQUIRE(reader.read_16bit(folder / "d.png", image).ok());
  REQUIRE((image.width() == 5 && image.height() == 3));
  CHECK(image(4, 2) == 65535);
  CHECK(image(0, 1) == 731);
  const auto refused = reader.read_16bit(folder / "c.png", image);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.problem().message.find("16-bit") != std::string::npos);
}

TEST_CASE("an image that is cut off anywhere is a problem, not a gray picture",
          "[sources][image_file][fuzz]") {
  const ScratchFolder folder("image_cut");
  ImageFileReader reader;
  ColorImage image;
  for (const char* extension : {".png", ".jpg"}) {
    const auto whole = folder / (std::string("whole") + extension);
    cv::imwrite(whole.string(), some_picture());
    const std::string bytes = file_bytes(whole);
    REQUIRE(reader.read_color(whole, image).ok());
    const auto cut = folder / (std::string("cut") + extension);
    for (std::size_t length = 0; length + 12 < bytes.size(); length += 11) {
      INFO(extension << " cut to " << length << " of " << bytes.size());
      write_bytes(cut, bytes.substr(0, length));
      const auto result = reader.read_color(cut, image);
      REQUIRE_FALSE(result.ok());
      CHECK(result.problem().message.find(cut.string()) != std::string::npos);
    }
    REQUIRE(reader.read_color(whole, image).ok());  // the reader still works
  }
}

TEST_CASE("an image with bytes changed at random never harms", "[sources][image_file][fuzz]") {
  const ScratchFolder folder("image_noise");
  ImageFileReader reader;
  ColorImage image;
  for (const char* extension : {".png", ".jpg", ".bmp", ".tif", ".ppm"}) {
    const auto path = folder / (std::string("noise") + extension);
    cv::imwrite(path.string(), some_picture());
    const std::string good = file_bytes(path);
    for (unsigned seed = 0; seed < 60; ++seed) {
      INFO(extension << ", seed " << seed);
      auto random = test::random_case(seed);
      std::string bytes = good;
      // Half of the seeds change the header, which contains sizes and offsets.
      const std::size_t end =
          seed % 2 == 0 ? std::min<std::size_t>(64, bytes.size()) : bytes.size();
      for (unsigned change = 0; change <= seed % 5; ++change) {
        bytes[random() % end] = static_cast<char>(random() % 256);
      }
      write_bytes(path, bytes);
      const auto result = reader.read_color(path, image);
      if (!result.ok()) CHECK(result.problem().message.find("noise") != std::string::npos);
      if (result.ok()) CHECK((image.width() > 0 && image.height() > 0));
    }
  }
}

TEST_CASE("an image that claims a huge size is refused before memory is taken for it",
          "[sources][image_file][refusal]") {
  const ScratchFolder folder("image_huge");
  cv::imwrite((folder / "huge.png").string(), some_picture());
  std::string bytes = file_bytes(folder / "huge.png");
  bytes[16] = '\x00';
  bytes[17] = '\x01';  // width 65576
  bytes[21] = '\x01';
  write_bytes(folder / "huge.png", bytes);
  ImageFileReader reader;
  ColorImage image;
  const auto result = reader.read_color(folder / "huge.png", image);
  REQUIRE_FALSE(result.ok());
  CHECK(result.problem().message.find("65576") != std::string::npos);

  for (const char* name : {"missing.png", "."})
    CHECK_FALSE(reader.read_color(folder / name, image).ok());
  // After a good image, because its picture could be returned by mistake.
  cv::imwrite((folder / "good.png").string(), some_picture());
  for (const std::string& start : {std::string("BM"), std::string("P6"), std::string("II*\0", 4)}) {
    REQUIRE(reader.read_color(folder / "good.png", image).ok());
    write_bytes(folder / "junk.png", start + std::string(100, 'x'));
    CHECK_FALSE(reader.read_color(folder / "junk.png", image).ok());
  }
  write_bytes(folder / "text.png", "no image at all");
  const auto text = reader.read_color(folder / "text.png", image);
  REQUIRE_FALSE(text.ok());
  CHECK(text.problem().message.find("no image") != std::string::npos);
}

}  // namespace
}  // namespace palpable
