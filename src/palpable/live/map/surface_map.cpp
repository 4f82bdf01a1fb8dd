#include "palpable/live/map/surface_map.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/floor_to_int.h"

#include <algorithm>
#include <cmath>
#include <hwy/cache_control.h>
#include <iterator>
#include <limits>
#include <utility>

namespace palpable {
namespace {

constexpr float kLeftOut = std::numeric_limits<float>::quiet_NaN();  // a depth that is not fused
constexpr int kSide = kVoxelsAcross;
constexpr double kNearest = 0.05;  // m; nothing is fused that is nearer to the camera

// Distance, in px, between the rays along which blocks are allocated. At 3 m depth and f = 350 px
// these rays are 34 mm apart, less than the width of a block of 10 mm voxels, 80 mm.
constexpr int kAllocationStep = 4;
// Number of frames over which the rows of these rays are distributed. With every other row, the
// rows are 68 mm apart at 3 m, still less than a block.
constexpr int kAllocationTurns = 2;

// A voxel's colour is the mean over this many frames, the first ones that show it. It does not
// change later, because the scene is static and its light nearly constant.
constexpr int kColorFrames = 4;

// After kColorFrames frames a block is painted only in every 8th frame, in case another part of its
// surface has come into view.
constexpr int kPaintAgainEvery = 8;

// A block whose smallest distance is above this share of the truncation contains no surface.
constexpr float kNothingNear = 0.95F;

constexpr double kSmallestWeight = 1e-6;  // frames; a voxel that was never seen has weight 0

// Largest coordinate, in blocks from the world's origin; nothing is kept beyond (BlockTable's
// numbers have 21 bits).
constexpr double kLargestBlock = 1 << 19;

void prefetch(const std::array<Voxel, kVoxelsOfBlock>& voxels) {
  constexpr std::size_t kLine = 64 / sizeof(Voxel);
  for (std::size_t i = 0; i < voxels.size(); i += kLine) hwy::Prefetch(&voxels[i]);
}

// Sets the depths of moving pixels to unknown.
void leave_out(const std::uint8_t* moving, float* depth, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) depth[i] = moving[i] != 0 ? kLeftOut : depth[i];
}

}  // namespace

SurfaceMap::SurfaceMap(const DepthNoise& noise, const SurfaceMapSettings& settings)
    : noise_(noise),
      settings_(settings),
      kernel_(&fuse_kernels().front()),
      table_(settings.blocks) {
  in_view_.reserve(settings.blocks);
  PALPABLE_EXPECT(settings.voxel > 0, "a voxel has a size");
  PALPABLE_EXPECT(settings.truncation >= 3 * settings.voxel, "distances reach 3 voxels or more");
  PALPABLE_EXPECT(
      settings.truncation_sigmas >= 0 && settings.largest_sigma > 0 && settings.best_sigma > 0,
      "a tolerance is not negative");
  PALPABLE_EXPECT(settings.most_weight >= 1 && settings.carve_weight > 0,
                  "the largest weight is at least 1 and the carve weight is positive");
  // sigma_Z grows with Z. The map ends at the depth where it reaches largest_sigma, by bisection.
  double low = 0, high = settings.farthest;
  if (noise.sigma(high) > settings.largest_sigma) {
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (noise.sigma(middle) > settings.largest_sigma ? high : low) = middle;
    }
  }
  farthest_ = high;
  units_ = VoxelUnits::of(
      std::max(settings.truncation, settings.truncation_sigmas * settings.largest_sigma),
      settings.most_weight);
}

// Allocates all blocks within the truncation distance of the measured surface.
void SurfaceMap::allocate(const PinholeCamera& camera, const Rigid3& world_from_camera) {
  const double block = kSide * settings_.voxel;
  const Eigen::Matrix3d R = world_from_camera.linear() / block;
  const Eigen::Vector3d origin = world_from_camera.translation() / block;
  BlocksOfLastRay last;
  last.fill(~std::uint64_t{0});
  const int first_row = kAllocationStep / 2 + kAllocationStep * (fused_ % kAllocationTurns);
  for (int y = first_row; y < camera.height; y += kAllocationStep * kAllocationTurns) {
    for (int x = kAllocationStep / 2; x < camera.width; x += kAllocationStep) {
      const auto Z = static_cast<double>(static_depth_(x, y));
      if (!(Z >= kNearest && Z <= farthest_)) continue;
      const double t =
          std::max(settings_.truncation, settings_.truncation_sigmas * noise_.sigma(Z));
      const Eigen::Vector3d ray = R * camera.unproject(x, y, 1.0);
      // With steps of half a block the ray misses only blocks of which it cuts a corner.
      const int steps = std::max(1, static_cast<int>(std::ceil(2 * t / (0.5 * block))));
      allocate_along(origin + (Z - t) * ray, (2 * t / steps) * ray, steps, last);
    }
  }
}

// Allocates the blocks at `first` and after each of the steps from there. Lengths in blocks.
void SurfaceMap::allocate_along(const Eigen::Vector3d& first, const Eigen::Vector3d& step,
                                int steps, BlocksOfLastRay& last) {
  Eigen::Vector3d p = first;
  if (!((p.cwiseAbs() + steps * step.cwiseAbs()).maxCoeff() < kLargestBlock)) return;
  for (int i = 0; i <= steps; ++i, p += step) {
    const std::uint64_t key =
        BlockTable::key_of(floor_to_int(p.x()), floor_to_int(p.y()), floor_to_int(p.z()));
    std::uint64_t& before = last[static_cast<std::size_t>(i) % last.size()];
    if (key == before) continue;
    before = key;
    if (table_.find(key) != BlockTable::kNone) continue;
    Block* b = insert(key);
    if (b == nullptr) {
      ++refused_;
      continue;
    }
    b->voxels.fill(0);
    b->color.fill(0);
    b->colored = 0;
  }
}

SurfaceMap::Block* SurfaceMap::insert(std::uint64_t key) {
  const int slot = table_.insert(key);
  return slot == BlockTable::kNone ? nullptr : &store_.provide(slot);
}

int SurfaceMap::copy_blocks(int first, int count, SurfaceMap& to) const {
  PALPABLE_EXPECT(first >= 0 && count >= 1,
                  "the first slot is not negative and at least one block is copied");
  PALPABLE_EXPECT(to.settings_.voxel == settings_.voxel, "the copy has voxels of the same size");
  const int slots = used_slots();
  int slot = first;
  for (; slot < slots && count > 0; ++slot) {
    if (!table_.used(slot)) continue;
    --count;
    const std::uint64_t key = table_.key(slot);
    // A block that was removed and allocated again between two calls may already have been copied.
    const int there = to.table_.find(key);
    Block* block = there != BlockTable::kNone ? &to.store_[there] : to.insert(key);
    if (block != nullptr) *block = store_[slot];
  }
  return slot < slots ? slot : capacity();
}

std::optional<SurfaceMap::BlockView> SurfaceMap::block_in(int slot) const {
  if (slot >= used_slots() || !table_.used(slot)) return std::nullopt;
  const Block& block = store_[slot];
  return BlockView{table_.key(slot), block.voxels.data()};
}

void SurfaceMap::clear() {
  last_fused_ = {};
  for (int slot = 0; slot < used_slots(); ++slot) {
    if (table_.used(slot)) table_.erase(slot);
  }
}

// Whether a block may be visible: whether its bounding sphere touches the picture's viewing
// frustum.
bool SurfaceMap::may_show(const PinholeCamera& camera, const Eigen::Vector3d& centre) const {
  const double radius = 0.5 * std::sqrt(3.0) * kSide * settings_.voxel;
  const double z = centre.z();
  if (z < kNearest - radius || z > farthest_ + settings_.truncation + radius) return false;
  // Whether the block's sphere lies outside the plane a = slope z through the optical centre and
  // one side of the picture.
  const auto beyond = [&](double a, double slope) {
    return a - slope * z > radius * std::sqrt(1 + slope * slope);
  };
  return !beyond(centre.x(), (camera.width - 0.5 - camera.cx_px) / camera.fx_px) &&
         !beyond(-centre.x(), (camera.cx_px + 0.5) / camera.fx_px) &&
         !beyond(centre.y(), (camera.height - 0.5 - camera.cy_px) / camera.fy_px) &&
         !beyond(-centre.y(), (camera.cy_px + 0.5) / camera.fy_px);
}

// Averages the picture's colours into the voxels at the surface.
void SurfaceMap::paint(Block& block, const Eigen::Vector3f& first, const PinholeCamera& camera,
                       const ColorImage& color) {
  const int factor = color.width() / camera.width;
  const auto reach = static_cast<float>(settings_.voxel);
  const auto truncation = static_cast<float>(settings_.truncation);
  const auto fx = static_cast<float>(camera.fx_px), fy = static_cast<float>(camera.fy_px);
  const auto cx = static_cast<float>(camera.cx_px), cy = static_cast<float>(camera.cy_px);
  const auto is_near = [&](Voxel voxel) {
    return std::abs(units_.distance_of(voxel)) <= reach && was_seen(voxel);
  };
  bool any = false;
  for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
    if (i % kSide == 0) {  // most rows of voxels contain no surface
      bool row = false;
      for (std::size_t k = 0; k < kSide; ++k) row |= is_near(block.voxels[i + k]);
      if (!row) {
        i += kSide - 1;
        continue;
      }
    }
    std::uint8_t* c = &block.color[4 * i];
    if (!is_near(block.voxels[i]) || c[3] >= kColorFrames) continue;
    const float X = first.x() + offsets_[0][i], Y = first.y() + offsets_[1][i],
                Z = first.z() + offsets_[2][i];
    if (Z < static_cast<float>(kNearest)) continue;
    const int x = floor_to_int(fx * X / Z + cx + 0.5F), y = floor_to_int(fy * Y / Z + cy + 0.5F);
    if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
    if (!(std::abs(static_depth_(x, y) - Z) <= truncation)) continue;
    const Rgb seen = color(factor * x + factor / 2, factor * y + factor / 2);
    const int n = c[3];
    const auto mean = [n](int old, int now) {
      return static_cast<std::uint8_t>((n * old + now + (n + 1) / 2) / (n + 1));
    };
    c[0] = mean(c[0], seen.r);
    c[1] = mean(c[1], seen.g);
    c[2] = mean(c[2], seen.b);
    c[3] = static_cast<std::uint8_t>(n + 1);
    any = true;
  }
  block.colored += any ? 1 : 0;
}

void SurfaceMap::fuse(const DepthImage& depth, const PinholeCamera& camera,
                      const Rigid3& world_from_camera, const MaskImage& moving,
                      const ColorImage& color) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the depth is the camera's");
  PALPABLE_EXPECT(
      moving.empty() || (moving.width() == depth.width() && moving.height() == depth.height()),
      "the mask has the depth's size");
  PALPABLE_EXPECT(
      color.empty() || (color.width() >= depth.width() &&
                        color.height() >= color.width() / depth.width() * depth.height()),
      "the colour is as large as the depth or larger");
  if (depth.empty() || !world_from_camera.matrix().allFinite()) return;
  static_depth_.resize(depth.width(), depth.height());
  std::copy(depth.begin(), depth.end(), static_depth_.begin());
  if (!moving.empty()) leave_out(moving.data(), static_depth_.data(), static_depth_.size());
  allocate(camera, world_from_camera);

  const Rigid3 camera_from_world = world_from_camera.inverse(Eigen::Isometry);
  set_offsets(camera_from_world);
  const FuseFrame frame = fuse_frame(camera);
  const float nothing_near = kNothingNear * frame.truncation;
  ++fused_;
  last_fused_ = {};
  find_blocks_in_view(camera, camera_from_world);
  for (std::size_t n = 0; n < in_view_.size(); ++n) {
    if (n + 1 < in_view_.size()) prefetch(store_[in_view_[n + 1].slot].voxels);
    const auto& [slot, first] = in_view_[n];
    Block& b = store_[slot];
    const float lowest = kernel_->fuse(frame, first.data(), b.voxels.data());
    if (lowest > nothing_near) {  // rays only pass through it, or its surface was carved away
      table_.erase(slot);
      continue;
    }
    last_fused_.remember(table_.key(slot), &b);
    if (!color.empty() && (b.colored < kColorFrames || (fused_ + slot) % kPaintAgainEvery == 0)) {
      paint(b, first, camera, color);
    }
  }
}

void SurfaceMap::set_offsets(const Rigid3& camera_from_world) {
  const Eigen::Matrix3d R = settings_.voxel * camera_from_world.linear();
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const Eigen::Vector3d offset = R * Eigen::Vector3d(x, y, z);
        for (int k = 0; k < 3; ++k) {
          offsets_[k][voxel_index(x, y, z)] = static_cast<float>(offset[k]);
        }
      }
    }
  }
}

FuseFrame SurfaceMap::fuse_frame(const PinholeCamera& camera) const {
  return {.depth = static_depth_.data(),
          .width = static_depth_.width(),
          .height = static_depth_.height(),
          .fx_px = static_cast<float>(camera.fx_px),
          .fy_px = static_cast<float>(camera.fy_px),
          .cx_px = static_cast<float>(camera.cx_px),
          .cy_px = static_cast<float>(camera.cy_px),
          .nearest = static_cast<float>(kNearest),
          .farthest = static_cast<float>(farthest_),
          .noise = {static_cast<float>(noise_.constant), static_cast<float>(noise_.linear),
                    static_cast<float>(noise_.quadratic)},
          .truncation = static_cast<float>(settings_.truncation),
          .truncation_sigmas = static_cast<float>(settings_.truncation_sigmas),
          .best_sigma = static_cast<float>(settings_.best_sigma),
          .carve_weight = static_cast<float>(settings_.carve_weight),
          .units = units_,
          .offset_x = offsets_[0].data(),
          .offset_y = offsets_[1].data(),
          .offset_z = offsets_[2].data()};
}

void SurfaceMap::find_blocks_in_view(const PinholeCamera& camera, const Rigid3& camera_from_world) {
  const Eigen::Matrix3d R = settings_.voxel * camera_from_world.linear();
  const double block = kSide * settings_.voxel;
  // From a block's corner to the middle of its first voxel, to which that voxel's distance refers.
  const Eigen::Vector3d to_first = 0.5 * R * Eigen::Vector3d::Ones();
  const Eigen::Vector3d to_centre = 0.5 * kSide * R * Eigen::Vector3d::Ones();
  in_view_.clear();
  for (int slot = 0; slot < used_slots(); ++slot) {
    if (!table_.used(slot)) continue;
    const Eigen::Vector3d corner =
        camera_from_world * (block * BlockTable::place_of(table_.key(slot)).cast<double>());
    if (!may_show(camera, corner + to_centre)) continue;
    in_view_.push_back({slot, (corner + to_first).cast<float>()});
  }
}

std::optional<double> SurfaceMap::distance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d p = point / settings_.voxel;
  if (!(p.cwiseAbs().maxCoeff() < kLargestBlock)) return std::nullopt;
  Reader reader(*this);
  float d = 0;
  if (!reader.read(floor_to_int(p.x()), floor_to_int(p.y()), floor_to_int(p.z()),
                   static_cast<float>(kSmallestWeight), d)) {
    return std::nullopt;
  }
  return static_cast<double>(d);
}

// Surface nets. A cell lies between the middles of 2 x 2 x 2 voxels and is addressed by the first
// of them.
class SurfaceMap::Mesher {
 public:
  Mesher(const SurfaceMap& map, float least_weight)
      : map_(map), least_(least_weight), reader_(map), vertex_(map.capacity()) {}

  ColoredSurface run() {
    for_each_voxel([this](int slot, int i, const Eigen::Vector3i& at) { add_vertex(slot, i, at); });
    for_each_voxel(
        [this](int slot, int i, const Eigen::Vector3i& at) { add_triangles(slot, i, at); });
    ColoredSurface result;
    result.colors = std::move(colors_);
    result.surface.vertices.resize(3, std::ssize(points_));
    for (Eigen::Index k = 0; k < std::ssize(points_); ++k) {
      result.surface.vertices.col(k) = points_[k];
    }
    result.surface.triangles.resize(3, std::ssize(triangles_));
    for (Eigen::Index k = 0; k < std::ssize(triangles_); ++k) {
      result.surface.triangles.col(k) = triangles_[k];
    }
    return result;
  }

 private:
  using Corners = std::array<float, 8>;  // distances; corner c lies at (c & 1, c >> 1 & 1, c >> 2)

  template <class Work>
  void for_each_voxel(const Work& work) {
    for (int slot = 0; slot < map_.used_slots(); ++slot) {
      if (!map_.table_.used(slot)) continue;
      const Eigen::Vector3i first = kSide * BlockTable::place_of(map_.table_.key(slot));
      for (int i = 0; i < static_cast<int>(kVoxelsOfBlock); ++i) {
        work(slot, i, Eigen::Vector3i(first + place_in_block(i)));
      }
    }
  }

  // The vertex of the cell at voxel i of a block, if the surface passes through it.
  void add_vertex(int slot, int i, const Eigen::Vector3i& at) {
    if (!(map_.units_.weight_of(map_.store_[slot].voxels[i]) >= least_)) return;
    Corners d{};
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      if (!reader_.read(at.x() + (c & 1), at.y() + (c >> 1 & 1), at.z() + (c >> 2), least_, d[c])) {
        return;
      }
      inside += d[c] <= 0 ? 1 : 0;
    }
    if (inside == 0 || inside == 8) return;
    std::vector<int>& of_block = vertex_[slot];
    if (of_block.empty()) of_block.assign(kVoxelsOfBlock, -1);
    of_block[i] = static_cast<int>(points_.size());
    // + 0.5: a voxel's value refers to its middle.
    points_.push_back(map_.settings_.voxel *
                      (at.cast<double>() + mean_crossing(d) + Eigen::Vector3d::Constant(0.5)));
    colors_.push_back(color_at(at, d));
  }

  // The mean of the points where the cell's edges cross the surface, in voxels from its corner 0.
  [[nodiscard]] static Eigen::Vector3d mean_crossing(const Corners& d) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int crossings = 0;
    for (int a = 0; a < 8; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        const int b = a | 1 << axis;
        if (b == a) continue;
        const float da = d[a], db = d[b];
        if ((da <= 0) == (db <= 0)) continue;
        Eigen::Vector3d p(a & 1, a >> 1 & 1, a >> 2);
        p[axis] = static_cast<double>(da / (da - db));
        sum += p;
        ++crossings;
      }
    }
    return sum / crossings;
  }

  // The colour of the corner that lies nearest to the surface and has one.
  [[nodiscard]] Rgb color_at(const Eigen::Vector3i& at, const Corners& d) {
    Rgb color{128, 128, 128};
    float best = std::numeric_limits<float>::infinity();
    for (int c = 0; c < 8; ++c) {
      const int x = at.x() + (c & 1), y = at.y() + (c >> 1 & 1), z = at.z() + (c >> 2);
      const std::uint8_t* rgbn =
          &reader_.block(x, y, z)->color[4 * voxel_index(x & 7, y & 7, z & 7)];
      const float near = std::abs(d[c]);
      if (rgbn[3] == 0 || near >= best) continue;
      best = near;
      color = {rgbn[0], rgbn[1], rgbn[2]};
    }
    return color;
  }

  [[nodiscard]] int vertex_of(const Eigen::Vector3i& at) const {
    const int slot = map_.table_.find(BlockTable::key_of(at.x() >> 3, at.y() >> 3, at.z() >> 3));
    if (slot == BlockTable::kNone || vertex_[slot].empty()) return -1;
    return vertex_[slot][voxel_index(at.x() & 7, at.y() & 7, at.z() & 7)];
  }

  // Two triangles for each edge from voxel i along an axis that crosses the surface, between the
  // vertices of the four cells around it.
  void add_triangles(int slot, int i, const Eigen::Vector3i& at) {
    const Voxel voxel = map_.store_[slot].voxels[i];
    if (!(map_.units_.weight_of(voxel) >= least_)) return;
    const float here = map_.units_.distance_of(voxel);
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3i next = at;
      ++next[axis];
      float there = 0;
      if (!reader_.read(next.x(), next.y(), next.z(), least_, there)) continue;
      if ((here <= 0) == (there <= 0)) continue;
      // The four cells in rotational order, from the second axis to the third.
      Eigen::Vector3i back_1 = Eigen::Vector3i::Zero(), back_2 = Eigen::Vector3i::Zero();
      back_1[(axis + 1) % 3] = 1;
      back_2[(axis + 2) % 3] = 1;
      const std::array<int, 4> around{vertex_of(at - back_1 - back_2), vertex_of(at - back_2),
                                      vertex_of(at), vertex_of(at - back_1)};
      if (*std::min_element(around.begin(), around.end()) < 0) continue;
      // Normals point to the side where the distance is positive.
      const bool along = here <= 0;
      const int p = around[0], q = along ? around[1] : around[3], r = around[2],
                s = along ? around[3] : around[1];
      triangles_.emplace_back(p, q, r);
      triangles_.emplace_back(p, r, s);
    }
  }

  const SurfaceMap& map_;
  float least_;
  Reader reader_;
  // (slots, voxels) index of the cell's vertex, -1: none; empty where a block has no vertices.
  std::vector<std::vector<int>> vertex_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Rgb> colors_;
  std::vector<Eigen::Vector3i> triangles_;
};

ColoredSurface SurfaceMap::mesh(double least_weight) const {
  return Mesher(*this, static_cast<float>(std::max(least_weight, kSmallestWeight))).run();
}

}  // namespace palpable
