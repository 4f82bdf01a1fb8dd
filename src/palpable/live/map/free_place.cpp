#include "palpable/live/map/free_place.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable {
namespace {

constexpr double kGridCell = 0.01;   // m
constexpr double kReach = 2;         // m from plane.middle to the sides of the grid
constexpr double kMargin = 0.015;    // m around and above the body that must be free
constexpr double kFlat = 0.01;       // m; points that are lower than this belong to the plane
constexpr double kSigmas = 3;        // sigma of the depth, added to kFlat
constexpr double kSeenShare = 0.85;  // share of the plane below a body that must be measured
constexpr int kSamplesInRow = 400;   // approximate samples in a row of the picture
constexpr int kFewestSamples = 2;    // samples that make a thing; a single one is an outlier
constexpr int kGridSide = static_cast<int>(2 * kReach / kGridCell);  // cells

// Counts for each cell of the plane the measured points of the plane and of things above it.
class PlaneGrid {
 public:
  PlaneGrid(const Plane& plane, const DepthImage& depth, const PinholeCamera& camera,
            const DepthNoise& noise, double height)
      : plane_(plane), axes_(camera_from_body_on(plane).linear()), cells_(kGridSide * kGridSide) {
    const int step = std::max(1, depth.width() / kSamplesInRow);
    for (int y = 0; y < depth.height(); y += step) {
      for (int x = 0; x < depth.width(); x += step) {
        const auto Z = static_cast<double>(depth(x, y));
        if (!(Z > 0)) continue;
        const Eigen::Vector3d point = camera.unproject(x, y, Z);
        // sigma of the depth, as a height above the plane.
        const double scatter = noise.sigma(Z) * std::abs(plane.normal.dot(point)) / Z;
        add(point, kFlat + kSigmas * scatter, height);
      }
    }
  }

  struct Place {
    int i, j;
  };
  [[nodiscard]] Place place_of(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d off = point - plane_.middle;
    return {static_cast<int>(std::floor((axes_.col(0).dot(off) + kReach) / kGridCell)),
            static_cast<int>(std::floor((axes_.col(1).dot(off) + kReach) / kGridCell))};
  }
  [[nodiscard]] Eigen::Vector3d middle_of(Place place) const {
    return plane_.middle + ((place.i + 0.5) * kGridCell - kReach) * axes_.col(0) +
           ((place.j + 0.5) * kGridCell - kReach) * axes_.col(1);
  }
  [[nodiscard]] bool is_plane(Place place) const {
    // Where rays are sparse a cell may have no sample, but one of its neighbours has.
    for (int j = place.j - 1; j <= place.j + 1; ++j) {
      for (int i = place.i - 1; i <= place.i + 1; ++i) {
        if (inside(i, j) && cells_[j * kGridSide + i].plane > 0) return true;
      }
    }
    return false;
  }
  [[nodiscard]] bool was_hit(Place place) const {
    return cells_[place.j * kGridSide + place.i].plane > 0;
  }
  // Whether a body can stand with its middle in this cell.
  // @param least_seen  share of the plane below it that must have been measured
  [[nodiscard]] bool is_free(Place place, double radius, double least_seen) const {
    const int reach = static_cast<int>(std::ceil((radius + kMargin) / kGridCell));
    int below = 0, seen = 0;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const double away = kGridCell * std::hypot(i, j);
        if (away > radius + kMargin) continue;
        const Place at{place.i + i, place.j + j};
        if (!inside(at.i, at.j)) return false;
        if (cells_[at.j * kGridSide + at.i].thing >= kFewestSamples) return false;
        if (away > radius) continue;
        ++below;
        seen += is_plane(at) ? 1 : 0;
      }
    }
    return seen >= least_seen * below;
  }

 private:
  struct Cell {
    std::uint16_t plane = 0, thing = 0;  // numbers of samples
  };

  static bool inside(int i, int j) { return i >= 0 && j >= 0 && i < kGridSide && j < kGridSide; }

  void add(const Eigen::Vector3d& point, double flat, double height) {
    const double above = plane_.normal.dot(point) - plane_.offset;
    if (above < -flat || above > height + kMargin) return;
    const Place at = place_of(point);
    if (!inside(at.i, at.j)) return;
    Cell& cell = cells_[at.j * kGridSide + at.i];
    std::uint16_t& count = above <= flat ? cell.plane : cell.thing;
    count = static_cast<std::uint16_t>(std::min(count + 1, 1000));
  }

  Plane plane_;
  Eigen::Matrix3d axes_;
  std::vector<Cell> cells_;
};

struct Candidate {
  double off_middle;  // px^2, in the picture
  PlaneGrid::Place place;
};

}  // namespace

std::optional<Eigen::Vector3d> free_place_on(const Plane& plane, const DepthImage& depth,
                                             const PinholeCamera& camera, const DepthNoise& noise,
                                             const Footprint& body) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the depth is the camera's");
  PALPABLE_EXPECT(body.radius >= 0 && body.radius <= kReach / 2 && body.height >= 0,
                  "a body's radius is 0 to 1 m and its height is not negative");
  const PlaneGrid grid(plane, depth, camera, noise, body.height);
  if (grid.is_free(grid.place_of(plane.middle), body.radius, kSeenShare)) return plane.middle;
  const Eigen::Vector2d middle(0.5 * (camera.width - 1), 0.5 * (camera.height - 1));
  std::vector<Candidate> candidates;
  for (int j = 0; j < kGridSide; ++j) {
    for (int i = 0; i < kGridSide; ++i) {
      if (!grid.was_hit({i, j})) continue;
      const Eigen::Vector3d point = grid.middle_of({i, j});
      if (!(point.z() > 0)) continue;
      candidates.push_back({(camera.project(point) - middle).squaredNorm(), {i, j}});
    }
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.off_middle < b.off_middle; });
  for (const double least_seen : {kSeenShare, 0.5, 0.0}) {
    for (const Candidate& candidate : candidates) {
      if (grid.is_free(candidate.place, body.radius, least_seen)) {
        return grid.middle_of(candidate.place);
      }
    }
  }
  return std::nullopt;
}

}  // namespace palpable
