#include "palpable/common/contact/cloud_distance.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Array3f;
using Eigen::Array3i;
using Eigen::Vector3f;

// Largest number of grid cells along each axis; clouds near a body have some ten.
constexpr int kMostCells = 32;

// Largest number of corners of a voxmap, 50 MB. A body of 0.15 m has 0.13 million.
constexpr double kMostCorners = 4e6;

// Distance in voxels below which the points themselves are searched. Where a point is nearer than
// one voxel, the distance by the corners is less than 1 + sqrt(3).
constexpr float kByCorners = 3;

}  // namespace

CloudGrid::CloudGrid(double reach) : usual_cell_(static_cast<float>(reach / 2)) {
  PALPABLE_EXPECT(reach > 0 && std::isfinite(reach),
                  "the largest distance of queries is positive and finite");
  first_.reserve(kMostCells * kMostCells * kMostCells + 1);
}

void CloudGrid::reserve(std::size_t points) { entries_.reserve(points); }

// Monotonic along each axis: the points in a box lie in the cells between those of its corners.
Array3i CloudGrid::cell_of(const Vector3f& x) const {
  const Array3f cell = ((x - box_.min()).array() * per_metre_).floor();
  return cell.max(0.0f).min((cells_ - 1).cast<float>()).cast<int>();
}

void CloudGrid::build(std::span<const Vector3f> cloud) {
  box_.setEmpty();
  for (const Vector3f& point : cloud) box_.extend(point);
  entries_.resize(cloud.size());
  if (cloud.empty()) return;
  const Array3f side = box_.sizes().array();
  cells_ = (side / usual_cell_).floor().min(static_cast<float>(kMostCells - 1)).cast<int>() + 1;
  const Array3f cell = (side / cells_.cast<float>()).max(usual_cell_);
  per_metre_ = cell.inverse();
  // A counting sort, filled from the last point on, so that each cell's points keep their order.
  first_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
  const auto cell_at = [&](const Vector3f& point) -> int& {
    const Array3i at = cell_of(point);
    return first_[number_of(at.x(), at.y(), at.z())];
  };
  for (const Vector3f& point : cloud) ++cell_at(point);
  int sum = 0;
  for (int& count : first_) count = sum += count;
  for (std::size_t k = cloud.size(); k-- > 0;) {
    entries_[static_cast<std::size_t>(--cell_at(cloud[k]))] = {cloud[k], static_cast<int>(k)};
  }
}

std::optional<NearestSeen> CloudGrid::nearest(const Vector3f& x, float below) const {
  if (entries_.empty() || !(box_.squaredExteriorDistance(x) < below)) return std::nullopt;
  // A little more, so that rounding does not leave out a cell.
  const Vector3f reach = Vector3f::Constant(1.0001f * std::sqrt(below));
  const Array3i low = cell_of(x - reach), high = cell_of(x + reach);
  const Entry* best = nullptr;
  float least = below;
  for (int c = low.z(); c <= high.z(); ++c) {
    for (int b = low.y(); b <= high.y(); ++b) {
      const auto from = static_cast<std::size_t>(first_[number_of(low.x(), b, c)]);
      const auto to = static_cast<std::size_t>(first_[number_of(high.x(), b, c) + 1]);
      for (std::size_t k = from; k < to; ++k) {
        const float squared = (x - entries_[k].point).squaredNorm();
        const bool first = squared == least && best != nullptr && entries_[k].index < best->index;
        if (squared < least || first) {
          least = squared;
          best = &entries_[k];
        }
      }
    }
  }
  if (best == nullptr) return std::nullopt;
  return NearestSeen{best->index, best->point, least};
}

Voxmap::Voxmap(const Eigen::AlignedBox3d& region, double reach, double voxel)
    : reach_(static_cast<float>(reach)) {
  PALPABLE_EXPECT(reach > 0 && std::isfinite(reach),
                  "the largest distance of queries is positive and finite");
  PALPABLE_EXPECT(voxel > 0 && std::isfinite(voxel), "a voxel has a side");
  PALPABLE_EXPECT(!region.isEmpty(), "the region around a body is not empty");
  // Large enough for all points within the reach of the region.
  const Eigen::Vector3d size = region.sizes().array() + 2 * reach;
  const auto count = [&](double side) -> Eigen::Array3d {
    return (size.array() / side).ceil() + 1;
  };
  while (count(voxel).prod() > kMostCorners) voxel *= 1.05;
  corners_ = count(voxel).cast<int>();
  voxel_ = static_cast<float>(voxel);
  far_ = reach_ + std::sqrt(3.0f) * voxel_;
  far_ *= far_;
  origin_ = (region.min().array() - reach).cast<float>();
  field_.resize(static_cast<std::size_t>(corners_.cast<std::ptrdiff_t>().prod()));
  low_ = high_ = Array3i::Zero();
}

void Voxmap::reserve(std::size_t points) {
  points_.reserve(points);
  index_.reserve(points);
  next_.reserve(points);
}

// The voxel of x, or the nearest one in use, given by its first corner.
Array3i Voxmap::voxel_of(const Vector3f& x) const {
  const Array3f at = ((x - origin_).array() / voxel_).floor();
  return at.max(low_.cast<float>()).min((high_ - 1).cast<float>()).cast<int>();
}

void Voxmap::build(std::span<const Vector3f> cloud) {
  points_.clear();
  index_.clear();
  box_.setEmpty();
  const AlignedBox3f all(origin_, place_of(corners_.x() - 1, corners_.y() - 1, corners_.z() - 1));
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    if (!all.contains(cloud[k])) continue;
    points_.push_back(cloud[k]);
    index_.push_back(static_cast<int>(k));
    box_.extend(cloud[k]);
  }
  next_.resize(points_.size());
  if (points_.empty()) return;
  // Only voxels within the reach of the points are used.
  low_ = Array3i::Zero();
  high_ = corners_ - 1;
  const Vector3f reach = Vector3f::Constant(reach_);
  const Array3i low = voxel_of(box_.min() - reach), high = voxel_of(box_.max() + reach) + 1;
  low_ = low;
  high_ = high;
  clear_corners();
  insert_points();
  for (int z = low_.z(); z <= high_.z(); ++z) sweep_slice(z, z - 1);
  for (int z = high_.z(); z >= low_.z(); --z) sweep_slice(z, z + 1);
}

void Voxmap::clear_corners() {
  for (int z = low_.z(); z <= high_.z(); ++z) {
    for (int y = low_.y(); y <= high_.y(); ++y) {
      Corner* row = field_.data() + number_of(low_.x(), y, z);
      std::fill(row, row + (high_.x() - low_.x() + 1), Corner{-1, far_, -1});
    }
  }
}

// Enters each point into its voxel and into the corners of that voxel.
void Voxmap::insert_points() {
  for (int k = 0; k < static_cast<int>(points_.size()); ++k) {
    const Vector3f& point = points_[k];
    const Array3i at = voxel_of(point);
    Corner& own = field_[number_of(at.x(), at.y(), at.z())];
    next_[k] = own.first;
    own.first = k;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = at.x() + (corner & 1), y = at.y() + (corner >> 1 & 1),
                z = at.z() + (corner >> 2);
      Corner& here = field_[number_of(x, y, z)];
      const float squared = (place_of(x, y, z) - point).squaredNorm();
      if (squared < here.squared) here.closest = k, here.squared = squared;
    }
  }
}

// Passes points on from slice `from` to slice z, and then between the rows of slice z, up and down.
void Voxmap::sweep_slice(int z, int from) {
  const bool has_slice = low_.z() <= from && from <= high_.z();
  const std::ptrdiff_t slice = has_slice ? number_of(0, 0, from) - number_of(0, 0, z) : 0;
  const std::ptrdiff_t row = corners_.x();
  for (int y = low_.y(); y <= high_.y(); ++y) sweep_row(y, z, slice, y > low_.y() ? -row : 0);
  for (int y = high_.y() - 1; y >= low_.y(); --y) sweep_row(y, z, 0, row);
}

// Passes points on to the row (y, z) from the rows at these offsets in field_ (0: there is none),
// and then between neighbours in the row, both ways.
void Voxmap::sweep_row(int y, int z, std::ptrdiff_t slice, std::ptrdiff_t row) {
  Corner* const corners = field_.data() + number_of(low_.x(), y, z);
  const int last = high_.x() - low_.x();
  const Vector3f begin = place_of(low_.x(), y, z);
  const auto pass_on = [&](int x, const Corner& known) {
    Corner& here = corners[x];
    if (known.closest < 0 || known.closest == here.closest) return;
    const Vector3f place(begin.x() + voxel_ * static_cast<float>(x), begin.y(), begin.z());
    const float squared = (place - points_[known.closest]).squaredNorm();
    if (squared < here.squared) here.closest = known.closest, here.squared = squared;
  };
  for (int x = 0; x <= last; ++x) {
    if (slice != 0) pass_on(x, corners[x + slice]);
    if (row != 0) pass_on(x, corners[x + row]);
    if (x > 0) pass_on(x, corners[x - 1]);
  }
  for (int x = last - 1; x >= 0; --x) pass_on(x, corners[x + 1]);
}

std::optional<NearestSeen> Voxmap::nearest(const Vector3f& x, float below) const {
  if (points_.empty() || !(box_.squaredExteriorDistance(x) < below)) return std::nullopt;
  const Array3i at = voxel_of(x);
  int best = -1;
  float least = std::numeric_limits<float>::infinity();
  const auto keep_if_nearer = [&](int k) {
    const float squared = (x - points_[k]).squaredNorm();
    const bool first = squared == least && k < best;
    if (squared < least || first) least = squared, best = k;
  };
  for (int corner = 0; corner < 8; ++corner) {
    const int known =
        field_[number_of(at.x() + (corner & 1), at.y() + (corner >> 1 & 1), at.z() + (corner >> 2))]
            .closest;
    if (known >= 0) keep_if_nearer(known);
  }
  const float by_corners = kByCorners * voxel_;
  if (least < by_corners * by_corners) {
    const Array3i low = (at - 1).max(low_), high = (at + 1).min(high_ - 1);
    for (int c = low.z(); c <= high.z(); ++c) {
      for (int b = low.y(); b <= high.y(); ++b) {
        for (int a = low.x(); a <= high.x(); ++a) {
          for (int k = field_[number_of(a, b, c)].first; k >= 0; k = next_[k]) keep_if_nearer(k);
        }
      }
    }
  }
  if (best < 0 || !(least < below)) return std::nullopt;
  return NearestSeen{index_[best], points_[best], least};
}

CloudDistance::CloudDistance(DistanceQuery how, const Eigen::AlignedBox3d& region, double reach,
                             double voxel)
    : reach_(reach), how_(CloudGrid(reach)) {
  if (how == DistanceQuery::kVoxmap) how_ = Voxmap(region, reach, voxel);
}

void CloudDistance::reserve(std::size_t points) {
  std::visit([&](auto& how) { how.reserve(points); }, how_);
}

void CloudDistance::build(std::span<const Vector3f> cloud) {
  std::visit([&](auto& how) { how.build(cloud); }, how_);
}

std::optional<NearestSeen> CloudDistance::nearest(const Vector3f& x, float below) const {
  return std::visit([&](const auto& how) { return how.nearest(x, below); }, how_);
}

}  // namespace palpable
