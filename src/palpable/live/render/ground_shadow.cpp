#include "palpable/live/render/ground_shadow.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kBlurRadius = 2;                // cells; applied twice in each direction
constexpr int kMargin = 2 * kBlurRadius + 2;  // cells around the shadow that the blur may darken

int cell(int x, int y) { return y * GroundShadow::kSide + x; }

}  // namespace

void GroundShadow::cast(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xi& triangles,
                        const Eigen::Vector3f& to_light) {
  std::fill(shade_.begin(), shade_.end(), 0.0f);
  std::fill(height_.begin(), height_.end(), 0.0f);
  if (vertices.cols() == 0 || !(to_light.z() > 0.0f)) return;

  // A longer shadow would have larger cells, and be blurred at the body's foot.
  constexpr float kMostSlope = 1.2f;
  slope_ = -to_light.head<2>() / to_light.z();
  slope_ *= kMostSlope / std::max(kMostSlope, slope_.norm());
  const float height = std::max(vertices.row(2).maxCoeff(), 1e-3f);
  fallen_.resize(3, vertices.cols());
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const float z = std::max(vertices(2, i), 0.0f);
    const float far = z / (0.9f * height);
    fallen_(0, i) = vertices(0, i) + slope_.x() * z;
    fallen_(1, i) = vertices(1, i) + slope_.y() * z;
    fallen_(2, i) = 1.0f / (1.0f + far * far);
  }
  const float low_x = fallen_.row(0).minCoeff(), high_x = fallen_.row(0).maxCoeff();
  const float low_y = fallen_.row(1).minCoeff(), high_y = fallen_.row(1).maxCoeff();
  const float extent = std::max({high_x - low_x, high_y - low_y, 1e-3f});
  const float cell_size = extent / (kSide - 2 * kMargin);
  const float corner_x = 0.5f * (low_x + high_x - cell_size * kSide);
  const float corner_y = 0.5f * (low_y + high_y - cell_size * kSide);
  box_ << corner_x, corner_y, corner_x + cell_size * kSide, corner_y + cell_size * kSide;

  const auto darken = [&](int x, int y, float value, float z) {
    if (x < 0 || x >= kSide || y < 0 || y >= kSide) return;
    shade_[cell(x, y)] = std::max(shade_[cell(x, y)], value);
    height_[cell(x, y)] = std::max(height_[cell(x, y)], z);
  };
  const auto to_cells = [&](Eigen::Index i) {
    return Eigen::Vector2f((fallen_(0, i) - corner_x) / cell_size,
                           (fallen_(1, i) - corner_y) / cell_size);
  };
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const Eigen::Vector2f p = to_cells(i);
    darken(static_cast<int>(p.x()), static_cast<int>(p.y()), fallen_(2, i), vertices(2, i));
  }
  // Cells whose centre lies in a projected triangle: a mesh may be coarser than the cells.
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i v = triangles.col(t);
    const Eigen::Vector2f a = to_cells(v[0]);
    const Eigen::Vector2f ab = to_cells(v[1]) - a;
    const Eigen::Vector2f ac = to_cells(v[2]) - a;
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (std::abs(area) < 1e-6f) continue;
    const float closeness = (fallen_(2, v[0]) + fallen_(2, v[1]) + fallen_(2, v[2])) / 3.0f;
    const float top = std::max({vertices(2, v[0]), vertices(2, v[1]), vertices(2, v[2])});
    const auto first = [](float base, float p, float q) {
      return static_cast<int>(base + std::min({0.0f, p, q}));
    };
    const auto last = [](float base, float p, float q) {
      return static_cast<int>(base + std::max({0.0f, p, q}));
    };
    for (int y = first(a.y(), ab.y(), ac.y()); y <= last(a.y(), ab.y(), ac.y()); ++y) {
      for (int x = first(a.x(), ab.x(), ac.x()); x <= last(a.x(), ab.x(), ac.x()); ++x) {
        const float px = static_cast<float>(x) + 0.5f - a.x();
        const float py = static_cast<float>(y) + 0.5f - a.y();
        const float s = (px * ac.y() - py * ac.x()) / area;
        const float r = (ab.x() * py - ab.y() * px) / area;
        if (s >= 0.0f && r >= 0.0f && s + r <= 1.0f) darken(x, y, closeness, top);
      }
    }
  }
  blur();
  blur();
}

void GroundShadow::blur() {
  // Each pass blurs along x and transposes, so two passes blur in both directions.
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < kSide; ++y) {
      float sum = 0.0f;
      for (int x = -kBlurRadius; x < kSide; ++x) {
        if (x + kBlurRadius < kSide) sum += shade_[cell(x + kBlurRadius, y)];
        if (x - kBlurRadius - 1 >= 0) sum -= shade_[cell(x - kBlurRadius - 1, y)];
        if (x >= 0) {
          scratch_[cell(y, x)] = std::max(sum, 0.0f) / static_cast<float>(2 * kBlurRadius + 1);
        }
      }
    }
    std::swap(shade_, scratch_);
  }
}

}  // namespace palpable
