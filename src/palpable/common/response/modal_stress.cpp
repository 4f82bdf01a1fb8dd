// Eight vertices at a time (float_lanes.h). This file is compiled without contraction of a * b + c
// (CMakeLists.txt), so that all processors give the same bytes.

#include "palpable/common/response/modal_stress.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/response/float_lanes.h"
#include "palpable/common/response/shell_stress.h"

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
using Eigen::MatrixXf;
using Eigen::VectorXf;

constexpr float kMostWordSteps = 32767;  // largest number of 16 bits
constexpr float kUpper = 65536;          // one step of a word's upper half
constexpr float kSmallest = 1e-30f;      // taken as the largest gradient of a mode that is 0
// Largest gradient, without unit, of the states by which add_squares() finds S: large enough for
// single precision, small enough for cubes not to count.
constexpr float kTried = 0.1f;
// Largest deviation from 1 of the sum of a vertex's recovery weights.
constexpr double kConstant = 1e-4;

// The gradients of two modes at eight vertices: entry (i, J) is m[i + 3 J]. The upper half of each
// word holds the first mode, the lower half the second. The whole word is 65536 times the first
// number, with the lower half as a fraction that was taken into account in rounding; shifted up by
// 16 bits it is 65536 times the second number. So one shift and two conversions give sixteen
// numbers.
struct alignas(32) GradientRow {
  IntPack m[9];
};
// The same for two products of load states: what they add to the second Piola stress, Pa.
struct alignas(32) ProductStressRow {
  IntPack m[6];
};

struct Gradients {
  const GradientRow* rows;  // all pairs of modes of the first eight vertices, then of the next
  const float* scales;      // (2 pairs) for the first eight vertices, then for the next
  const float* q;           // (2 pairs)
  float* weights;           // (2 pairs) scratch
  int pairs, vertices;
  const ProductStressRow* added;  // all pairs of products, in the order of `rows`
  const float* added_weights;     // (2 added_pairs)
  int added_pairs;
};

// Adds the two numbers of each word, multiplied by their weights.
PALPABLE_ALWAYS_INLINE void add_pair(const IntPack& words, float one, float other, FloatPack& sum) {
  const IntPack low = (IntPack)((WordPack)words << 16);
  sum += one * __builtin_convertvector(words, FloatPack);
  sum += other * __builtin_convertvector(low, FloatPack);
}

struct StressAtVertices {
  template <class Law>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, const Gradients& gradients,
                                        float*& von_mises, float*& cauchy) {
    const GradientRow* row = gradients.rows;
    const float* scale = gradients.scales;
    const ProductStressRow* added_row = gradients.added;
    for (int first = 0; first < gradients.vertices; first += kPackSize) {
      for (int i = 0; i < 2 * gradients.pairs; ++i) {
        gradients.weights[i] = gradients.q[i] * scale[i];
      }
      scale += 2 * gradients.pairs;
      FloatPack sum[9]{};
      for (int i = 0; i < gradients.pairs; ++i, ++row) {
        const float one = gradients.weights[2 * i], other = gradients.weights[2 * i + 1];
        for (int c = 0; c < 9; ++c) add_pair(row->m[c], one, other, sum[c]);
      }
      FloatPack added[6]{};
      for (int i = 0; i < gradients.added_pairs; ++i, ++added_row) {
        const float one = gradients.added_weights[2 * i],
                    other = gradients.added_weights[2 * i + 1];
        for (int c = 0; c < 6; ++c) add_pair(added_row->m[c], one, other, added[c]);
      }
      Tensor<Lanes> F;
      for (int c = 0; c < 9; ++c) { F.m[c].v = c % 4 == 0 ? sum[c] + 1.0f : sum[c]; }
      FloatPack s[6];
      cauchy_stress(law, F, added, s);
      const FloatPack xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
      const FloatPack shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
      const FloatPack found = square_root(0.5f * (xy * xy + yz * yz + zx * zx) + 3.0f * shear);
      const int count = std::min(kPackSize, gradients.vertices - first);
      for (int k = 0; k < count; ++k) von_mises[first + k] = found[k];
      if (cauchy == nullptr) continue;
      for (int k = 0; k < count; ++k) {
        for (int c = 0; c < 6; ++c) cauchy[6 * (first + k) + c] = s[c][k];
      }
    }
    return 0;
  }
};

// Puts a number, in steps, into a word: into an empty word as its lower half, or as the upper half
// of a word whose lower half is set.
std::int32_t with_half(std::int32_t word, bool lower, float steps) {
  if (lower) return static_cast<std::int32_t>(std::lround(steps) & 0xffff);
  const double upper = std::round(static_cast<double>(steps) - word / static_cast<double>(kUpper));
  return word + static_cast<std::int32_t>(upper) * static_cast<std::int32_t>(kUpper);
}

// (3 x A) dN_a/dX at each point of each element, one after the other, 1/m.
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
  std::size_t modes, pairs;
  std::vector<float> q, weights;  // (n, padded to an even number)
  std::vector<float> scales;      // unit of one step, of all modes for each eight vertices
  std::vector<GradientRow> rows;
  Eigen::MatrixXf duals;                           // (m x n)
  Eigen::VectorXf states;                          // (m)
  std::vector<float> added_scales, added_weights;  // of products of states
  std::vector<ProductStressRow> added;

  void set_gradients(std::size_t mode, const std::vector<Matrix3f>& found);
  void set_added(const std::vector<Eigen::VectorXf>& products);
};

// Stores the gradients of a mode. Odd modes, the lower halves, must be stored first, because the
// upper halves are rounded for them.
void ModalStress::Work::set_gradients(std::size_t mode, const std::vector<Matrix3f>& found) {
  for (std::size_t first = 0; first < found.size(); first += kPackSize) {
    const std::size_t last = std::min(first + kPackSize, found.size()), pack = first / kPackSize;
    float largest = kSmallest;
    for (std::size_t v = first; v < last; ++v) {
      largest = std::max(largest, found[v].cwiseAbs().maxCoeff());
    }
    scales[pack * 2 * pairs + mode] = largest / (kMostWordSteps * kUpper);
    GradientRow& row = rows[pack * pairs + mode / 2];
    for (std::size_t v = first; v < last; ++v) {
      for (int c = 0; c < 9; ++c) {
        row.m[c][v - first] = with_half(row.m[c][v - first], mode % 2 == 1,
                                        found[v].data()[c] / largest * kMostWordSteps);
      }
    }
  }
}

void ModalStress::Work::set_added(const std::vector<Eigen::VectorXf>& products) {
  const std::size_t count = products.size(), half_count = (count + 1) / 2;
  added.assign(rows.size() / pairs * half_count, ProductStressRow{});
  added_scales.assign(2 * half_count, 0);
  added_weights.assign(2 * half_count, 0);
  for (const std::size_t half : {1, 0}) {
    for (std::size_t p = half; p < count; p += 2) {
      const float largest = std::max(kSmallest, products[p].cwiseAbs().maxCoeff());
      added_scales[p] = largest / (kMostWordSteps * kUpper);
      for (int v = 0; v < vertices; ++v) {
        ProductStressRow& row = added[static_cast<std::size_t>(v / kPackSize) * half_count + p / 2];
        for (int c = 0; c < 6; ++c) {
          row.m[c][v % kPackSize] = with_half(row.m[c][v % kPackSize], half == 1,
                                              products[p][6 * v + c] / largest * kMostWordSteps);
        }
      }
    }
  }
}

bool ModalStress::serves(const ShellTable& table) {
  if (table.materials.size() != 1 || !table.preload.isZero(0)) return false;
  for (std::size_t v = 0; v + 1 < table.first.size(); ++v) {
    double sum = 0;
    for (int k = table.first[v]; k < table.first[v + 1]; ++k) {
      sum += static_cast<double>(table.weights[static_cast<std::size_t>(k)]);
    }
    if (!(std::abs(sum - 1) <= kConstant)) return false;
  }
  return true;
}

ModalStress::ModalStress(const ShellTable& table, const MatrixXf& modes,
                         const MatrixXf& inner_modes, const LoadStates& loads, SimdLevel level) {
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
                                      pairs,
                                      std::vector<float>(2 * pairs, 0.0f),
                                      std::vector<float>(2 * pairs, 0.0f),
                                      std::vector<float>(packs * 2 * pairs, 0.0f),
                                      std::vector<GradientRow>(packs * pairs, GradientRow{}),
                                      {},
                                      {},
                                      {},
                                      {},
                                      {}});
  GradientRecovery recovery(table);
  std::vector<Matrix3f> found(static_cast<std::size_t>(V));
  Eigen::Matrix3Xf u(3, W);
  for (const std::size_t half : {1, 0}) {
    for (std::size_t i = half; i < count; i += 2) {
      u.leftCols(V) = modes.col(static_cast<Index>(i)).reshaped(3, V);
      u.rightCols(W - V) = inner_modes.col(static_cast<Index>(i)).reshaped(3, W - V);
      recovery.apply(u, found);
      work_->set_gradients(i, found);
    }
  }
  add_squares(table, modes, inner_modes, loads);
}

// Finds S from ShellStress. The stress that is missing in a state and in the opposite one is
// averaged, so that all odd terms cancel and the square remains.
void ModalStress::add_squares(const ShellTable& table, const MatrixXf& modes,
                              const MatrixXf& inner_modes, const LoadStates& loads) {
  const Index V = modes.rows() / 3, W = table.nodes(), m = loads.states.cols();
  ShellStress shell(table, static_cast<int>(V));
  Eigen::Matrix3Xf u(3, W);
  std::vector<float> von_mises(static_cast<std::size_t>(V)), here(6 * von_mises.size()),
      exact(here);
  const auto missing = [&](const VectorXf& q) -> VectorXf {
    u.leftCols(V) = (modes * q).reshaped(3, V);
    u.rightCols(W - V) = (inner_modes * q).reshaped(3, W - V);
    shell.evaluate(u, von_mises, exact);
    evaluate({q.data(), static_cast<std::size_t>(q.size())}, von_mises, here);
    return Eigen::Map<const VectorXf>(exact.data(), 6 * V) -
           Eigen::Map<const VectorXf>(here.data(), 6 * V);
  };
  const auto square = [&](const VectorXf& q) -> VectorXf {
    return 0.5f * (missing(q) + missing(-q));
  };
  MatrixXf states = loads.states, duals = loads.duals;
  for (Index a = 0; a < m; ++a) {
    // Scaled to the gradient kTried.
    const float size = kTried / largest_gradient(states.col(a));
    states.col(a) *= size;
    duals.row(a) /= size;
  }
  std::vector<VectorXf> products;
  for (Index b = 0; b < m; ++b) {
    for (Index a = 0; a < b; ++a) {
      products.push_back(
          0.5f * (square(states.col(a) + states.col(b)) - square(states.col(a) - states.col(b))));
    }
    products.push_back(square(states.col(b)));
  }
  work_->duals = duals;
  work_->states.setZero(m);
  work_->set_added(products);
}

float ModalStress::largest_gradient(const VectorXf& q) const {
  const Work& w = *work_;
  float largest = kSmallest;
  for (std::size_t pack = 0; pack < w.rows.size() / w.pairs; ++pack) {
    FloatPack sum[9]{};
    for (std::size_t i = 0; i < w.modes; ++i) {
      const float weight = q[static_cast<Index>(i)] * w.scales[pack * 2 * w.pairs + i];
      for (int c = 0; c < 9; ++c) {
        const IntPack& words = w.rows[pack * w.pairs + i / 2].m[c];
        add_pair(words, i % 2 == 0 ? weight : 0, i % 2 == 0 ? 0 : weight, sum[c]);
      }
    }
    for (const FloatPack& of : sum) {
      for (int k = 0; k < kPackSize; ++k) largest = std::max(largest, std::abs(of[k]));
    }
  }
  return largest;
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
  std::copy(q.begin(), q.end(), w.q.begin());
  const Eigen::Map<const VectorXf> amplitudes(q.data(), std::ssize(q));
  for (Index a = 0; a < w.states.size(); ++a) {
    float sum = 0;  // a plain loop: the same order of additions on every processor
    for (Index i = 0; i < amplitudes.size(); ++i) sum += w.duals(a, i) * amplitudes[i];
    w.states[a] = sum;
  }
  std::size_t product = 0;
  for (Index b = 0; b < w.states.size(); ++b) {
    for (Index a = 0; a <= b; ++a, ++product) {
      w.added_weights[product] = w.added_scales[product] * (w.states[a] * w.states[b]);
    }
  }
  const Gradients gradients{
      w.rows.data(),    w.scales.data(),           w.q.data(),
      w.weights.data(), static_cast<int>(w.pairs), w.vertices,
      w.added.data(),   w.added_weights.data(),    static_cast<int>(w.added_weights.size() / 2)};
  float *to = von_mises.data(), *tensors = cauchy.empty() ? nullptr : cauchy.data();
  std::visit(
      [&](const auto& law) { run_at<StressAtVertices>(w.level, law, gradients, to, tensors); },
      w.material);
}

}  // namespace palpable
