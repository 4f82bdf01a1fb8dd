#include "palpable/live/sources/packed_image.h"

#include "tests/support/test.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace palpable {
namespace {

ColorImage some_colors(int width, int height, unsigned seed) {
  auto random = test::random_case(seed);
  ColorImage image(width, height);
  for (Rgb& pixel : image) {
    pixel = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  return image;
}

TEST_CASE("colours come back to the bit, whatever they are", "[sources][recording]") {
  ImagePacker packer;
  ImageUnpacker unpacker;
  ColorImage back;
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    const int width = 1 + static_cast<int>(seed) * 3, height = 1 + static_cast<int>(seed) * 5 % 7;
    const ColorImage image = some_colors(width, height, seed);
    std::string bytes;
    packer.pack(image, bytes);
    std::string_view rest(bytes);
    REQUIRE(unpacker.unpack(rest, width, height, back));
    CHECK(back == image);
    CHECK(rest.empty());
  }
}

TEST_CASE("pictures as a camera sent them come back to the bit", "[sources][recording]") {
  auto random = test::random_case(3);
  YuyvImage image(23, 9);
  for (Yuyv& pair : image) {
    const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
    pair = {byte(), byte(), byte(), byte()};
  }
  ImagePacker packer;
  std::string bytes;
  packer.pack(image, bytes);
  std::string_view rest(bytes);
  ImageUnpacker unpacker;
  YuyvImage back;
  REQUIRE(unpacker.unpack(rest, 23, 9, back));
  CHECK(back == image);
  CHECK(rest.empty());
  rest = bytes;
  CHECK_FALSE(unpacker.unpack(rest, 23, 10, back));
}

TEST_CASE("depths come back bit by bit: unknown ones, too, and those that are none",
          "[sources][recording]") {
  DepthImage image(31, 17, 0.5F);
  auto random = test::random_case(7);
  for (float& Z : image) {
    const auto bits = static_cast<std::uint32_t>(random());
    if (bits % 3 == 0) Z = std::numeric_limits<float>::quiet_NaN();
    if (bits % 3 == 1) std::memcpy(&Z, &bits, sizeof Z);
  }
  ImagePacker packer;
  std::string bytes;
  packer.pack(image, bytes);
  std::string_view rest(bytes);
  ImageUnpacker unpacker;
  DepthImage back;
  REQUIRE(unpacker.unpack(rest, 31, 17, back));
  CHECK(std::memcmp(back.data(), image.data(), image.size() * sizeof(float)) == 0);
}

TEST_CASE("smooth pictures take less room, and images follow each other", "[sources][recording]") {
  ColorImage smooth(64, 48);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const auto shade = static_cast<std::uint8_t>(2 * x + y);
      smooth(x, y) = {shade, shade, static_cast<std::uint8_t>(shade + 10)};
    }
  }
  ImagePacker packer;
  std::string bytes = "before";
  packer.pack(smooth, bytes);
  CHECK(bytes.size() < 64 * 48 * 3 / 8);
  packer.pack(DepthImage(64, 48, 1.5F), bytes);
  std::string_view rest = std::string_view(bytes).substr(6);
  ImageUnpacker unpacker;
  ColorImage color;
  DepthImage depth;
  REQUIRE(unpacker.unpack(rest, 64, 48, color));
  REQUIRE(unpacker.unpack(rest, 64, 48, depth));
  CHECK(color == smooth);
  CHECK(depth(63, 47) == 1.5F);
  CHECK(rest.empty());
}

TEST_CASE("bytes of another size, cut ones and noise are no image",
          "[sources][recording][errors]") {
  const ColorImage image = some_colors(16, 9, 1);
  ImagePacker packer;
  std::string bytes;
  packer.pack(image, bytes);
  ImageUnpacker unpacker;
  ColorImage back;
  DepthImage depth;
  const auto unpacks = [&](std::string_view some, int width, int height) {
    return unpacker.unpack(some, width, height, back);
  };
  CHECK(unpacks(bytes, 16, 9));
  CHECK_FALSE(unpacks(bytes, 9, 8));
  CHECK_FALSE(unpacks(bytes, 32, 9));
  std::string_view whole(bytes);
  CHECK_FALSE(unpacker.unpack(whole, 16, 9, depth));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CHECK_FALSE(unpacks(std::string_view(bytes).substr(0, size), 16, 9));
  }
  auto random = test::random_case(3);
  for (int k = 0; k < 500; ++k) {
    std::string spoilt = bytes;
    spoilt[random() % spoilt.size()] = static_cast<char>(random());
    static_cast<void>(unpacks(spoilt, 16, 9));  // must not read or write out of bounds
  }
}

}  // namespace
}  // namespace palpable
