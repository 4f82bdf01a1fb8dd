// Eight vertices at a time (float_lanes.h). This file is compiled without contraction of a * b + c
// (CMakeLists.txt), so that all processors give the same bytes.

#include "palpable/touch/modal_stress.h"

#include "palpable/base/contract.h"
#include "palpable/touch/float_lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3f;

constexpr float kMostSteps = 32767;  // 16 bits
constexpr float kUpper = 65536;      // one step of a word's upper half
constexpr float kSmallest = 1e-30f;  // 1/m: the largest gradient of a mode that does nothing
// By which the weights of a vertex may miss 1.
constexpr double kConstant = 1e-4;

// What two modes do at eight vertices: entry (i, J) of the gradients is m[i + 3 J]. The upper half
// of each word is of the first mode, the lower one of the second. The word as a whole is 65536
// times the first's, with the lower half as its fraction, for which it was rounded; shifted up it
// is 65536 times the second's: one shift and two conversions for sixteen numbers.
struct alignas(32) GradientRow {
  IntPack m[9];
};
struct alignas(32) GradientPack {
  FloatPack m[9];
};

struct Gradients {
  const GradientRow* rows;  // of all pairs of modes of the first eight vertices, then of the next
  const GradientPack* preload;  // or none
  const float* weights;         // (2 pairs)
  int pairs, vertices;
};

struct StressAtVertices {
  template <class Law>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, const Gradients& gradients,
                                        float*& von_mises, float*& cauchy) {
    const GradientRow* row = gradients.rows;
    for (int first = 0; first < gradients.vertices; first += kPackSize) {
      FloatPack sum[9]{};
      for (int i = 0; i < gradients.pairs; ++i, ++row) {
        const float one = gradients.weights[2 * i], other = gradients.weights[2 * i + 1];
        for (int c = 0; c < 9; ++c) {
          const IntPack low = (IntPack)((WordPack)row->m[c] << 16);
          sum[c] += one * __builtin_convertvector(row->m[c], FloatPack);
          sum[c] += other * __builtin_convertvector(low, FloatPack);
        }
      }
      Tensor<Lanes> F;
      for (int c = 0; c < 9; ++c) {
        if (gradients.preload != nullptr) sum[c] += gradients.preload[first / kPackSize].m[c];
        F.m[c].v = c % 4 == 0 ? sum[c] + 1.0f : sum[c];
      }
      FloatPack s[6];
      cauchy_stress(law, F, s);
      const FloatPack xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
      const FloatPack shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
      const FloatPack square = 0.5f * (xy * xy + yz * yz + zx * zx) + 3.0f * shear;
      const int count = std::min(kPackSize, gradients.vertices - first);
      for (int k = 0; k < count; ++k) von_mises[first + k] = __builtin_sqrtf(square[k]);
      if (cauchy == nullptr) continue;
      for (int k = 0; k < count; ++k) {
        for (int c = 0; c < 6; ++c) cauchy[6 * (first + k) + c] = s[c][k];
      }
    }
    return 0;
  }
};

// A word that holds a number of steps.
std::int32_t lower_half(float steps) { return std::lround(steps) & 0xffff; }
std::int32_t upper_half(float steps, std::int32_t lower) {
  return static_cast<std::int32_t>(
      std::lround(static_cast<double>(steps) - lower / static_cast<double>(kUpper)) *
      static_cast<long>(kUpper));
}

// (3 x A) of each element, one after the other, 1/m.
Eigen::Matrix3Xf all_gradients(const ShellTable& table) {
  const Index A = table.element_nodes, Q = table.points_of_element();
  Eigen::Matrix3Xf g(3, A * Q * table.element_count());
  for (int e = 0; e < table.element_count(); ++e) {
    for (int q = 0; q < Q; ++q) {
      g.middleCols(A * (Q * e + q), A) = gradients_at(table, e, q).cast<float>();
    }
  }
  return g;
}

// The recovered gradient of a field that is known at the shell's nodes.
class GradientRecovery {
 public:
  explicit GradientRecovery(const ShellTable& table)
      : table_(table),
        g_(all_gradients(table)),
        at_points_(static_cast<std::size_t>(table.points_of_element() * table.element_count())) {}

  // @param u  (3 x W) m  @param result  (V)
  void apply(const Eigen::Matrix3Xf& u, std::vector<Matrix3f>& result) {
    const Index A = table_.element_nodes, Q = table_.points_of_element();
    for (int e = 0; e < table_.element_count(); ++e) {
      const std::span<const int> nodes = table_.nodes_of(e);
      for (Index q = 0; q < Q; ++q) {
        const Index point = Q * e + q;
        Matrix3f& sum = at_points_[static_cast<std::size_t>(point)];
        sum.setZero();
        for (Index a = 0; a < A; ++a) {
          sum += u.col(nodes[static_cast<std::size_t>(a)]) * g_.col(A * point + a).transpose();
        }
      }
    }
    for (std::size_t v = 0; v < result.size(); ++v) {
      result[v].setZero();
      for (int k = table_.first[v]; k < table_.first[v + 1]; ++k) {
        const auto at = static_cast<std::size_t>(k);
        result[v] += table_.weights[at] * at_points_[static_cast<std::size_t>(table_.points[at])];
      }
    }
  }

 private:
  const ShellTable& table_;
  Eigen::Matrix3Xf g_;
  std::vector<Matrix3f> at_points_;
};

}  // namespace

struct ModalStress::Work {
  SimdLevel level;
  Material material;
  int vertices;
  std::size_t modes;
  std::vector<float> scales, weights;  // (n, or one more) of one step of a mode's gradients
  std::vector<GradientRow> rows;
  std::vector<GradientPack> preload;  // none where it is 0
};

bool ModalStress::serves(const ShellTable& table) {
  if (table.materials.size() != 1) return false;
  for (std::size_t v = 0; v + 1 < table.first.size(); ++v) {
    double sum = 0;
    for (int k = table.first[v]; k < table.first[v + 1]; ++k) {
      sum += static_cast<double>(table.weights[static_cast<std::size_t>(k)]);
    }
    if (!(std::abs(sum - 1) <= kConstant)) return false;
  }
  return true;
}

ModalStress::ModalStress(const ShellTable& table, const Eigen::MatrixXf& modes,
                         const Eigen::MatrixXf& inner_modes, SimdLevel level) {
  const Index V = modes.rows() / 3, n = modes.cols(), W = table.nodes();
  PALPABLE_EXPECT(trouble_of(table, static_cast<int>(V)).empty() && serves(table) &&
                      inner_modes.cols() == n && inner_modes.rows() == 3 * (W - V),
                  "modes of a consistent shell of one material");
  const std::size_t count = static_cast<std::size_t>(n), pairs = (count + 1) / 2;
  const auto packs = static_cast<std::size_t>((V + kPackSize - 1) / kPackSize);
  work_ = std::make_unique<Work>(Work{level,
                                      table.materials.front(),
                                      static_cast<int>(V),
                                      count,
                                      std::vector<float>(2 * pairs, 0.0f),
                                      std::vector<float>(2 * pairs, 0.0f),
                                      std::vector<GradientRow>(packs * pairs, GradientRow{}),
                                      {}});
  GradientRecovery recovery(table);
  std::vector<Matrix3f> found(static_cast<std::size_t>(V));
  Eigen::Matrix3Xf u(3, W);
  // The lower halves first: the upper ones are rounded for them.
  for (const std::size_t half : {1, 0}) {
    for (std::size_t i = half; i < count; i += 2) {
      u.leftCols(V) = modes.col(static_cast<Index>(i)).reshaped(3, V);
      u.rightCols(W - V) = inner_modes.col(static_cast<Index>(i)).reshaped(3, W - V);
      recovery.apply(u, found);
      float largest = 0;
      for (const Matrix3f& G : found) largest = std::max(largest, G.cwiseAbs().maxCoeff());
      if (!(largest > 0)) largest = kSmallest;
      work_->scales[i] = largest / (kMostSteps * kUpper);
      for (std::size_t v = 0; v < found.size(); ++v) {
        GradientRow& row = work_->rows[v / kPackSize * pairs + i / 2];
        for (int c = 0; c < 9; ++c) {
          const float steps = found[v].data()[c] / largest * kMostSteps;
          auto word = row.m[c][v % kPackSize];
          row.m[c][v % kPackSize] = half == 1 ? lower_half(steps) : word + upper_half(steps, word);
        }
      }
    }
  }
  if (table.preload.isZero(0)) return;
  work_->preload.assign(packs, GradientPack{});
  u = table.preload.cast<float>();
  recovery.apply(u, found);
  for (std::size_t v = 0; v < found.size(); ++v) {
    for (int c = 0; c < 9; ++c) {
      work_->preload[v / kPackSize].m[c][v % kPackSize] = found[v].data()[c];
    }
  }
}
ModalStress::~ModalStress() = default;
ModalStress::ModalStress(ModalStress&&) noexcept = default;

void ModalStress::evaluate(std::span<const float> q, std::span<float> von_mises,
                           std::span<float> cauchy) {
  Work& w = *work_;
  const auto V = static_cast<std::size_t>(w.vertices);
  PALPABLE_EXPECT(
      q.size() == w.modes && von_mises.size() == V && (cauchy.empty() || cauchy.size() == 6 * V),
      "an amplitude of each mode, and room for the skin's stress");
  for (std::size_t i = 0; i < q.size(); ++i) w.weights[i] = w.scales[i] * q[i];
  const Gradients gradients{w.rows.data(), w.preload.empty() ? nullptr : w.preload.data(),
                            w.weights.data(), static_cast<int>(w.weights.size() / 2), w.vertices};
  float *to = von_mises.data(), *tensors = cauchy.empty() ? nullptr : cauchy.data();
  std::visit(
      [&](const auto& law) { run_at<StressAtVertices>(w.level, law, gradients, to, tensors); },
      w.material);
}

}  // namespace palpable
