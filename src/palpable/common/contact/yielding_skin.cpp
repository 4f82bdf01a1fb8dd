#include "palpable/common/contact/yielding_skin.h"

#include "palpable/common/contact/touch_solver.h"
#include "palpable/common/response/carried_skin.h"
#include "palpable/common/response/compliance_cache.h"
#include "palpable/common/response/linear_field.h"
#include "palpable/common/response/row_kernels.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpable {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

struct YieldingSkin::Give {
  // A share of a force: its vertex, of those that the tables know.
  struct Share {
    int vertex = 0;
    float weight = 0;
  };
  // Of one point: three corners, or three for each corner of a skin that is carried.
  struct Shares {
    std::array<Share, 9> of{};
    std::size_t count = 0;
    void add(int vertex, float weight) {
      if (weight > 0) of[count++] = {vertex, weight};
    }
  };

  Compliance compliance;
  LinearField linear;
  ComplianceCache cache;
  std::vector<SkinPoint> carried;  // (F) where a vertex stands; none: it is its own
  Matrix3Xf u;                     // (3 x V) m, by the forces that it bears
  bool bears = false;
  std::vector<Shares> shares;    // of the points
  std::vector<int> vertices;     // of these
  std::vector<char> is_brought;  // (V)
  std::vector<float> row;        // (3 slots)

  Give(const SurfaceMesh& skin, const TouchTables& tables)
      : compliance(tables.compliance),
        linear(compliance),
        cache(compliance, TouchSolver::kMostVertices),
        u(Matrix3Xf::Zero(3, compliance.vertices())),
        is_brought(static_cast<std::size_t>(compliance.vertices()), 0),
        row(std::size_t{3} * TouchSolver::kMostVertices) {
    shares.reserve(TouchSolver::kMostPoints);
    vertices.reserve(TouchSolver::kMostVertices);
    if (!tables.coarse) return;
    const Carrier carrier(tables.coarse->surface);
    Eigen::Matrix3Xd normals(3, skin.vertex_count());
    vertex_normals(skin.vertices, skin.triangles, normals);
    for (int v = 0; v < skin.vertex_count(); ++v) {
      carried.push_back(carrier.stand(skin.vertices.col(v), normals.col(v)).on);
    }
  }

  [[nodiscard]] Shares shares_of(const OtherSkin& on) const {
    Shares result;
    for (int k = 0; k < 3; ++k) {
      if (carried.empty()) {
        result.add(on.corners[k], on.weights[k]);
        continue;
      }
      const SkinPoint& stands = carried[static_cast<std::size_t>(on.corners[k])];
      for (std::size_t c = 0; c < 3; ++c) {
        result.add(stands.corners[c], on.weights[k] * stands.weights[static_cast<int>(c)]);
      }
    }
    return result;
  }

  // Of as many points as their vertices find room.
  void bring(std::span<const YieldingPoint> points) {
    for (const int v : vertices) is_brought[static_cast<std::size_t>(v)] = 0;
    vertices.clear();
    shares.clear();
    for (const YieldingPoint& point : points) {
      shares.push_back(shares_of(point.on));
      const auto& [of, count] = shares.back();
      const auto missing = static_cast<std::size_t>(std::count_if(
          of.begin(), of.begin() + static_cast<std::ptrdiff_t>(count),
          [&](const Share& s) { return is_brought[static_cast<std::size_t>(s.vertex)] == 0; }));
      if (vertices.size() + missing > std::size_t{TouchSolver::kMostVertices}) {
        shares.back().count = 0;
        continue;
      }
      for (std::size_t k = 0; k < count; ++k) {
        char& is_here = is_brought[static_cast<std::size_t>(of[k].vertex)];
        if (is_here == 0) vertices.push_back(of[k].vertex);
        is_here = 1;
      }
    }
    cache.bring(vertices);
  }
};

YieldingSkin::YieldingSkin(const SurfaceMesh& skin, const TouchTables* tables)
    : surface_(skin), give_(tables == nullptr ? nullptr : std::make_unique<Give>(skin, *tables)) {}
YieldingSkin::~YieldingSkin() = default;
YieldingSkin::YieldingSkin(YieldingSkin&&) noexcept = default;

void YieldingSkin::bear(std::span<const VertexForce> forces) {
  if (!give_ || (forces.empty() && !give_->bears)) return;
  give_->bears = !forces.empty();
  give_->linear.fill(forces, give_->u);
}

void YieldingSkin::find_gaps(std::span<const Vector3f> places, std::span<SurfaceGap> gaps) const {
  for (std::size_t k = 0; k < places.size(); ++k) gaps[k] = gap_of(places[k]);
}

SurfaceGap YieldingSkin::gap_of(const Vector3f& place) const {
  SurfaceGap gap;
  const auto found = surface_.nearest(place, kDeepInside);
  if (!found || !(found->distance < kGapReach)) return gap;
  const RoundedSkin skin = surface_.rounded_at(*found);
  gap.distance = found->distance;
  gap.normal = skin.normal;
  gap.curvature = skin.curvature;
  gap.on = {-1, surface_.corners(found->triangle), found->weights, 0};
  if (!give_ || !give_->bears) return gap;
  Vector3f moved = Vector3f::Zero();
  const Give::Shares shares = give_->shares_of(gap.on);
  for (std::size_t k = 0; k < shares.count; ++k) {
    moved += shares.of[k].weight * give_->u.col(shares.of[k].vertex);
  }
  gap.on.given_way = -gap.normal.dot(moved);
  return gap;
}

bool YieldingSkin::find(const Vector3f& place, OtherSkin& on) const {
  const auto found = surface_.nearest(place, kDeepInside);
  if (!found) return false;
  on.corners = surface_.corners(found->triangle);
  on.weights = found->weights;
  return true;
}

void YieldingSkin::add_compliance(std::span<const YieldingPoint> points,
                                  std::span<double> W) const {
  if (!give_) return;
  Give& give = *give_;
  give.bring(points);
  const std::size_t m = points.size(), width = give.row.size();
  for (std::size_t p = 0; p < m; ++p) {
    std::fill(give.row.begin(), give.row.end(), 0.0f);
    for (std::size_t k = 0; k < give.shares[p].count; ++k) {
      const Give::Share& share = give.shares[p].of[k];
      const Vector3f force = share.weight * points[p].normal;
      best_row_kernels().add_float_rows(
          give.cache.blocks().col(3 * give.cache.slot_of(share.vertex)).data(), width,
          {force.data(), 3}, give.row);
    }
    for (std::size_t other = 0; other <= p; ++other) {
      float sum = 0;
      for (std::size_t k = 0; k < give.shares[other].count; ++k) {
        const Give::Share& share = give.shares[other].of[k];
        const Eigen::Map<const Vector3f> at(give.row.data() + 3 * give.cache.slot_of(share.vertex));
        sum += share.weight * points[other].normal.dot(at);
      }
      W[p * m + other] += static_cast<double>(sum);
    }
  }
}

void YieldingSkin::add_shares(const OtherSkin& on, const Vector3f& force,
                              std::vector<VertexForce>& forces) const {
  if (!give_) return;
  const Give::Shares shares = give_->shares_of(on);
  for (std::size_t k = 0; k < shares.count; ++k) {
    forces.push_back({shares.of[k].vertex, shares.of[k].weight * force});
  }
}

}  // namespace palpable
