#include "palpable/live/map/surface_map.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

namespace palpable {
namespace {

const float kNaN = std::nanf("");
const PinholeCamera kCamera{160, 120, 140, 150, 80.3, 58.7};
const DepthNoise kNoise{0.001, 0, 0};

// An exact depth image: distance(ray) is Z along the ray of a pixel, or NaN.
DepthImage seen(const std::function<double(const Eigen::Vector3d&)>& Z_on_ray) {
  DepthImage depth(kCamera.width, kCamera.height);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      depth(x, y) = static_cast<float>(Z_on_ray(kCamera.unproject(x, y, 1.0)));
    }
  }
  return depth;
}

DepthImage plane(const Eigen::Vector3d& normal, double offset) {
  return seen([&](const Eigen::Vector3d& ray) { return offset / normal.dot(ray); });
}

DepthImage ball(const Eigen::Vector3d& centre, double radius) {
  return seen([&](const Eigen::Vector3d& ray) {
    const double a = ray.squaredNorm(), b = ray.dot(centre);
    const double inside = b * b - a * (centre.squaredNorm() - radius * radius);
    return inside < 0 ? std::nan("") : (b - std::sqrt(inside)) / a;
  });
}

double largest_error(const SurfaceMesh& mesh,
                     const std::function<double(const Eigen::Vector3d&)>& error) {
  double largest = 0;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    largest = std::max(largest, std::abs(error(mesh.vertices.col(i))));
  }
  return largest;
}

TEST_CASE("an exact plane comes back where it was, facing the camera", "[map][surface_map]") {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.3, 1).normalized();
  const double offset = 0.8;
  SurfaceMap map(kNoise);
  Rigid3 world_from_camera = Rigid3::Identity();
  world_from_camera.translation() = Eigen::Vector3d(0.123, -2.3, 7.7);
  world_from_camera.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (int i = 0; i < 3; ++i) map.fuse(plane(normal, offset), kCamera, world_from_camera);
  const SurfaceMesh mesh = map.mesh().surface;
  REQUIRE(mesh.triangle_count() > 5000);
  const Rigid3 camera_from_world = world_from_camera.inverse();
  const double error = largest_error(
      mesh, [&](const Eigen::Vector3d& p) { return normal.dot(camera_from_world * p) - offset; });
  CHECK(error <= test::tolerance(0.0015,
                                 "the depth of the nearest pixel stands for a voxel: half a "
                                 "pixel at 0.9 m is 3 mm, the plane leans by 0.36"));
  int facing = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.vertices.col(mesh.triangles(0, t)),
                          b = mesh.vertices.col(mesh.triangles(1, t)),
                          c = mesh.vertices.col(mesh.triangles(2, t));
    const Eigen::Vector3d outwards = camera_from_world.linear() * (b - a).cross(c - a);
    facing += outwards.dot(normal) < 0 ? 1 : 0;
  }
  CHECK(facing == mesh.triangle_count());
}

TEST_CASE("an exact sphere comes back within a third of a voxel", "[map][surface_map]") {
  const Eigen::Vector3d centre(0.05, -0.04, 0.75);
  constexpr double kRadius = 0.2;
  SurfaceMap map(kNoise);
  for (int i = 0; i < 2; ++i) map.fuse(ball(centre, kRadius), kCamera, Rigid3::Identity());
  const SurfaceMesh mesh = map.mesh().surface;
  REQUIRE(mesh.vertex_count() > 500);
  // The rim is left out: there the distance along the ray differs from that to the surface.
  const double error = largest_error(mesh, [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d outwards = (p - centre).normalized();
    return outwards.dot(p.normalized()) > -0.6 ? 0 : (p - centre).norm() - kRadius;
  });
  CHECK(error <=
        test::tolerance(0.0033, "a third of a voxel of 10 mm; half a pixel at 0.6 m is 2 mm"));
}

// The number of voxels at a surface in a box, both corners included.
int voxels_near_zero(const SurfaceMap& map, const Eigen::Vector3d& low,
                     const Eigen::Vector3d& high) {
  int count = 0;
  const double h = map.settings().voxel;
  for (double z = low.z(); z <= high.z(); z += h) {
    for (double y = low.y(); y <= high.y(); y += h) {
      for (double x = low.x(); x <= high.x(); x += h) {
        const auto d = map.distance({x, y, z});
        count += d && *d < h ? 1 : 0;
      }
    }
  }
  return count;
}

TEST_CASE("a ball that was seen without a mask is carved away when the wall behind is seen",
          "[map][surface_map]") {
  const Eigen::Vector3d centre(0, 0, 0.5);
  const DepthImage wall = plane(Eigen::Vector3d::UnitZ(), 1.0);
  DepthImage with_ball = ball(centre, 0.08);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    if (std::isnan(with_ball.data()[i])) with_ball.data()[i] = wall.data()[i];
  }
  SurfaceMap map(kNoise);
  const Eigen::Vector3d low(-0.2, -0.2, 0.3), high(0.2, 0.2, 0.7);
  for (int i = 0; i < 30; ++i) map.fuse(with_ball, kCamera, Rigid3::Identity());
  CHECK(voxels_near_zero(map, low, high) > 200);
  for (int i = 0; i < 10; ++i) map.fuse(wall, kCamera, Rigid3::Identity());
  CHECK(voxels_near_zero(map, low, high) == 0);
  CHECK(map.mesh().surface.vertices.row(2).minCoeff() > 0.97);
}

TEST_CASE("what moves is not taken", "[map][surface_map]") {
  const DepthImage near = plane(Eigen::Vector3d::UnitZ(), 0.6);
  MaskImage moving(kCamera.width, kCamera.height, 255);
  SurfaceMap map(kNoise);
  map.fuse(near, kCamera, Rigid3::Identity(), moving);
  CHECK(map.blocks() == 0);
  moving(80, 60) = 0;
  map.fuse(near, kCamera, Rigid3::Identity(), moving);
  CHECK(map.blocks() <= 4);
}

TEST_CASE("what comes into view of a block that has long been painted gets its colour as well",
          "[map][surface_map]") {
  SurfaceMap map(kNoise);
  const DepthImage depth(kCamera.width, kCamera.height, 0.8F);
  const ColorImage color(kCamera.width, kCamera.height, Rgb{10, 200, 30});
  MaskImage moving(kCamera.width, kCamera.height, 0);
  // Every other column of 10 px, so that each block is partly visible.
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) moving(x, y) = x / 10 % 2 == 0 ? 255 : 0;
  }
  for (int i = 0; i < 20; ++i) map.fuse(depth, kCamera, Rigid3::Identity(), moving, color);
  for (int i = 0; i < 9; ++i) map.fuse(depth, kCamera, Rigid3::Identity(), {}, color);
  const ColoredSurface mesh = map.mesh();
  REQUIRE(mesh.surface.vertex_count() > 1000);
  for (const Rgb& c : mesh.colors) REQUIRE(c == Rgb{10, 200, 30});
}

TEST_CASE("colours come from the picture", "[map][surface_map]") {
  SurfaceMap map(kNoise);
  const ColorImage green(2 * kCamera.width, 2 * kCamera.height, {10, 200, 30});
  for (int i = 0; i < 3; ++i) {
    map.fuse(plane(Eigen::Vector3d::UnitZ(), 0.6), kCamera, Rigid3::Identity(), {}, green);
  }
  const ColoredSurface mesh = map.mesh();
  REQUIRE(mesh.colors.size() == static_cast<std::size_t>(mesh.surface.vertex_count()));
  for (const Rgb& color : mesh.colors) REQUIRE(color == Rgb{10, 200, 30});
}

TEST_CASE("garbage, NaN and no pose leave a map that can be read", "[map][surface_map]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_int_distribution<std::uint32_t> bits;
    SurfaceMap map(kNoise, {.blocks = 200});
    for (int frame = 0; frame < 3; ++frame) {
      DepthImage depth(kCamera.width, kCamera.height);
      for (float& Z : depth) {
        const std::uint32_t b = bits(random);
        std::memcpy(&Z, &b, sizeof Z);
        if (b % 3 == 0) Z = 0.3F + static_cast<float>(b % 1000) * 1e-3F;
      }
      Rigid3 pose = Rigid3::Identity();
      pose.translation().x() = frame == 1 ? std::nan("") : frame * 1e7;
      map.fuse(depth, kCamera, pose);
    }
    CHECK(map.blocks() <= 200);
    CHECK(map.refused() > 0);  // the limit of blocks was reached
    const SurfaceMesh mesh = map.mesh().surface;
    CHECK(mesh.vertices.allFinite());
    CHECK((mesh.triangles.size() == 0 || mesh.triangles.maxCoeff() < mesh.vertex_count()));
    CHECK_FALSE(map.distance(Eigen::Vector3d::Constant(std::nan(""))).has_value());
  }
}

TEST_CASE("every set of instructions fuses to the same bytes", "[map][fuse]") {
  auto random = test::random_case(5);
  std::uniform_real_distribution<float> number(-1, 1);
  DepthImage depth(kCamera.width, kCamera.height);
  for (float& Z : depth) Z = 0.7F + 0.1F * number(random);
  for (int i = 0; i < 500; ++i) depth.data()[37 * i] = kNaN;
  std::array<std::vector<float>, 3> offset;
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
      offset[k].push_back(0.01F * static_cast<float>(i >> (3 * k) & 7));
    }
  }
  constexpr VoxelUnits units = VoxelUnits::of(0.06, 3.0);
  const FuseFrame frame{.depth = depth.data(),
                        .width = depth.width(),
                        .height = depth.height(),
                        .fx_px = 140,
                        .fy_px = 150,
                        .cx_px = 80.3F,
                        .cy_px = 58.7F,
                        .nearest = 0.05F,
                        .farthest = 0.79F,
                        .noise = {0.001F, 0.002F, 0.003F},
                        .truncation = 0.04F,
                        .truncation_sigmas = 15,
                        .best_sigma = 0.003F,
                        .carve_weight = 1,
                        .units = units,
                        .offset_x = offset[0].data(),
                        .offset_y = offset[1].data(),
                        .offset_z = offset[2].data()};
  const auto kernels = fuse_kernels();
  REQUIRE(kernels.size() >= 1);
  std::vector<std::vector<Voxel>> voxels(kernels.size(), std::vector<Voxel>(kVoxelsOfBlock, 0));
  float heaviest = 0, farthest = 0;
  for (int step = 0; step < 40; ++step) {
    const float first[3] = {0.45F * number(random), 0.35F * number(random),
                            0.6F + 0.2F * number(random)};
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      const float lowest = kernels[k].fuse(frame, first, voxels[k].data());
      INFO(kernels[k].name << " in step " << step);
      REQUIRE(voxels[k] == voxels[0]);
      float least = std::numeric_limits<float>::infinity();
      for (const Voxel voxel : voxels[k]) {
        if (!was_seen(voxel)) continue;
        least = std::min(least, units.distance_of(voxel));
        heaviest = std::max(heaviest, units.weight_of(voxel));
        farthest = std::max(farthest, std::abs(units.distance_of(voxel)));
      }
      REQUIRE(lowest == least);
    }
  }
  // Both limits of a voxel's distance: noise and sigmas above give 0.067 m.
  CHECK(heaviest == units.most_weight());
  CHECK(farthest == units.largest_distance());
}

TEST_CASE("a voxel says its distance and weight to their units", "[map][voxel]") {
  constexpr VoxelUnits units = VoxelUnits::of(0.1, 64);
  const auto packed = [](int distance, unsigned weight) {
    return static_cast<Voxel>(static_cast<std::uint16_t>(distance)) | weight << 16;
  };
  CHECK_FALSE(was_seen(packed(-5, 0)));
  CHECK(was_seen(packed(0, 1)));
  CHECK(units.distance_of(packed(-32767, 1)) == -units.largest_distance());
  CHECK(units.distance_of(packed(-1, 65535)) == -units.distance);
  CHECK(units.distance_of(packed(7, 65535)) == 7 * units.distance);
  CHECK(units.weight_of(packed(-1, 65535)) == units.most_weight());
  CHECK(units.weight_of(packed(-1, 1)) == units.weight);
  CHECK(std::abs(units.largest_distance() - 0.1F) < 1e-8F);  // half a unit of float's last place
  CHECK(std::abs(units.most_weight() - 64.0F) < 4e-6F);
}

TEST_CASE("once its blocks are there, a map takes no memory", "[map][surface_map]") {
  SurfaceMap map(kNoise);
  const DepthImage wall = plane(Eigen::Vector3d(0.1, 0, 1).normalized(), 0.7);
  map.fuse(wall, kCamera, Rigid3::Identity());
  CHECK(test::allocations_during([&] { map.fuse(wall, kCamera, Rigid3::Identity()); }) == 0);
}

}  // namespace
}  // namespace palpable
