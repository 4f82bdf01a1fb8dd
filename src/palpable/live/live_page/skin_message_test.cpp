#include "palpable/live/live_page/skin_message.h"

#include "palpable/live/live_page/half_size.h"
#include "tests/support/test.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace palpable {
namespace {

template <class Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number number{};
  REQUIRE(offset + sizeof(number) <= bytes.size());
  std::memcpy(&number, bytes.data() + offset, sizeof(number));
  return number;
}

TEST_CASE("a mesh has the triangles of each body in turn", "[live_page][skin]") {
  Eigen::Matrix3Xi one(3, 2), other(3, 1);
  one << 0, 2, 1, 3, 2, 1;
  other << 7, 8, 9;
  const std::string bytes = mesh_message(std::vector{one, other});
  CHECK(bytes.substr(0, 4) == "MESH");
  CHECK(bytes.size() == 4 * (2 + 1 + 6 + 1 + 3));
  CHECK(number_at<std::uint32_t>(bytes, 4) == 2);
  CHECK(number_at<std::uint32_t>(bytes, 8) == 2);
  CHECK(number_at<std::int32_t>(bytes, 12) == 0);  // the corners of a triangle lie together
  CHECK(number_at<std::int32_t>(bytes, 16) == 1);
  CHECK(number_at<std::int32_t>(bytes, 20) == 2);
  CHECK(number_at<std::uint32_t>(bytes, 36) == 1);
  CHECK(number_at<std::int32_t>(bytes, 48) == 9);
}

TEST_CASE("a skin has vertices, normals and stress of each body, and its frame's number",
          "[live_page][skin]") {
  std::vector<SceneBody> bodies(2);
  bodies[0].vertices = Eigen::Matrix3Xf::Constant(3, 2, 0.5F);
  bodies[0].normals = Eigen::Matrix3Xf::Constant(3, 2, -1);
  bodies[0].von_mises = {100, 200};
  bodies[1].vertices = Eigen::Matrix3Xf::Constant(3, 1, 2);
  bodies[1].normals = Eigen::Matrix3Xf::Constant(3, 1, 1);  // without stress
  std::string bytes = "of the frame before";
  write_skin_message(77, bodies, bytes);
  CHECK(bytes.substr(0, 4) == "SKIN");
  CHECK(bytes.size() == 4 * (3 + 1 + 2 * 7 + 1 + 7));
  CHECK(number_at<std::uint32_t>(bytes, 4) == 77);
  CHECK(number_at<std::uint32_t>(bytes, kSkinsBegin) == 2);
  CHECK(number_at<std::uint32_t>(bytes, 12) == 2);
  CHECK(number_at<float>(bytes, 16) == 0.5F);
  CHECK(number_at<float>(bytes, 16 + 24) == -1);
  CHECK(number_at<float>(bytes, 16 + 48 + 4) == 200);
  CHECK(number_at<std::uint32_t>(bytes, 72) == 1);
  CHECK(number_at<float>(bytes, 76) == 2);
  CHECK(number_at<float>(bytes, 76 + 24) == 0);
  std::string next;
  write_skin_message(78, bodies, next);
  CHECK(bytes.substr(kSkinsBegin) == next.substr(kSkinsBegin));
}

TEST_CASE("a picture at half size has the mean of four pixels", "[live_page][picture]") {
  ColorImage picture(5, 3, Rgb{9, 9, 9});
  picture(0, 0) = {0, 10, 255};
  picture(1, 0) = {2, 10, 255};
  picture(0, 1) = {4, 10, 255};
  picture(1, 1) = {4, 12, 255};
  ColorImage half;
  halve(picture, half);
  CHECK(half.width() == 2);
  CHECK(half.height() == 1);
  CHECK(half(0, 0) == Rgb{3, 11, 255});  // 10 / 4 and 42 / 4, rounded
  CHECK(half(1, 0) == Rgb{9, 9, 9});
}

}  // namespace
}  // namespace palpable
