#include "palpable/common/contact/point_levels.h"

#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

TEST_CASE("points of a level are at least its length apart, and every point has one within it",
          "[contact]") {
  const test::ElasticSheet sheet;
  const std::vector<SkinPoint> points = skin_points(sheet.skin, sheet.fixed, 0.002);
  const std::vector<float> levels = point_levels(sheet.skin, points, 0.008, 0.002);
  REQUIRE(levels.size() == points.size());
  const Matrix3Xf x = sheet.skin.vertices.cast<float>();
  const auto apart = [&](std::size_t a, std::size_t b) {
    return static_cast<double>((points[a].at(x) - points[b].at(x)).norm());
  };
  std::size_t last = 0;
  for (double s = 0.008; s > 0.0019; s /= std::sqrt(2.0)) {
    std::vector<std::size_t> members;
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (levels[p] > 0.999f * static_cast<float>(s)) members.push_back(p);
    }
    CHECK(members.size() > last);
    last = members.size();
    for (std::size_t p = 0; p < points.size(); ++p) {
      double nearest = 1;
      for (const std::size_t member : members) {
        if (member != p) nearest = std::min(nearest, apart(p, member));
      }
      const bool is_member = levels[p] > 0.999f * static_cast<float>(s);
      if (is_member) {
        CHECK(nearest > 0.999 * s);
      } else {
        CHECK(nearest < s);
      }
    }
  }
}

TEST_CASE("points on the other side of a thin sheet do not cover those of this side", "[contact]") {
  // Two triangles 1 mm apart that face away from each other.
  SurfaceMesh skin;
  skin.vertices.resize(3, 6);
  skin.vertices << 0, 0.01, 0, 0, 0.01, 0,  //
      0, 0, 0.01, 0, 0, 0.01,               //
      0, 0, 0, -0.001, -0.001, -0.001;
  skin.triangles.resize(3, 2);
  skin.triangles << 0, 3, 1, 5, 2, 4;
  const std::vector<std::uint8_t> fixed(6, 0);
  const std::vector<SkinPoint> points = skin_points(skin, fixed, 0.01);
  const std::vector<float> levels = point_levels(skin, points, 0.016, 0.016);
  const Matrix3Xf x = skin.vertices.cast<float>();
  int above = 0, below = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (levels[p] == 0) continue;
    (points[p].at(x).z() < -0.0005f ? below : above) += 1;
  }
  CHECK(above == 1);
  CHECK(below == 1);
}

}  // namespace
}  // namespace palpable
