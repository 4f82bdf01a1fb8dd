#include "palpable/touch/compliance.h"

#include "palpable/base/contract.h"
#include "palpable/touch/row_kernels.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace palpable {
namespace {

// As many neighbours as a buffer of the near field holds; trouble_of() refuses more.
constexpr std::size_t kMostNeighbours = 4096;

const RowKernels& kernels() { return row_kernels().front(); }

// sum += the three rows of a vertex times a force.
void add_rows(const std::vector<std::int16_t>& rows, const std::vector<float>& scale, int vertex,
              const Eigen::Vector3f& force, std::span<float> sum) {
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t row = 3 * static_cast<std::size_t>(vertex) + d;
    kernels().add(rows.data() + row * sum.size(), force[static_cast<int>(d)] * scale[row], sum);
  }
}

}  // namespace

std::size_t padded(std::size_t n) { return (n + kRowStep - 1) / kRowStep * kRowStep; }

std::string_view trouble_of(const ComplianceTable& t) {
  const auto size = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
  const std::int64_t V = t.vertices, R = t.rank;
  if (V < 1 || R < 0 || R % static_cast<std::int64_t>(kRowStep) != 0) return "its size";
  if (size(t.modes) != 3 * V * R || size(t.mode_scale) != 3 * V || size(t.codes) != 3 * V * R ||
      size(t.code_scale) != 3 * V) {
    return "the size of its modes";
  }
  if (size(t.first) != V + 1 || size(t.near_scale) != V || t.first.front() != 0 ||
      t.first.back() != size(t.neighbours)) {
    return "its lists of neighbours";
  }
  std::int64_t numbers = 0;
  for (std::int64_t v = 0; v < V; ++v) {
    const std::int64_t count = t.first[v + 1] - std::int64_t{t.first[v]};
    if (count < 0 || count > static_cast<std::int64_t>(kMostNeighbours) ||
        t.first[v + 1] > size(t.neighbours)) {
      return "its lists of neighbours";
    }
    for (std::int64_t k = t.first[v]; k < t.first[v + 1]; ++k) {
      const bool rises = k == t.first[v] || t.neighbours[k] > t.neighbours[k - 1];
      if (t.neighbours[k] < 0 || t.neighbours[k] >= V || !rises) return "its lists of neighbours";
    }
    numbers += 9 * static_cast<std::int64_t>(padded(static_cast<std::size_t>(count)));
  }
  return numbers == size(t.near) ? std::string_view() : "the size of its near field";
}

Compliance::Compliance(ComplianceTable table) : table_(std::move(table)) {
  PALPABLE_EXPECT(trouble_of(table_).empty(), "a compliance table is consistent");
  std::size_t at = 0;
  for (int v = 0; v < table_.vertices; ++v) {
    near_first_.push_back(at);
    at += 9 * padded(neighbours(v).size());
  }
}

void Compliance::add_code(int vertex, const Eigen::Vector3f& force, std::span<float> code) const {
  add_rows(table_.codes, table_.code_scale, vertex, force, code);
}

void Compliance::add_shape(int vertex, const Eigen::Vector3f& force, std::span<float> shape) const {
  add_rows(table_.modes, table_.mode_scale, vertex, force, shape);
}

Eigen::Vector3f Compliance::modes_at(int vertex, std::span<const float> code) const {
  const auto R = static_cast<std::size_t>(table_.rank);
  const std::size_t row = 3 * static_cast<std::size_t>(vertex);
  Eigen::Vector3f u;
  kernels().dots(table_.modes.data() + row * R, 3, code, u.data());
  return u.cwiseProduct(Eigen::Map<const Eigen::Vector3f>(table_.mode_scale.data() + row));
}

void Compliance::modes_everywhere(std::span<const float> code, Eigen::Matrix3Xf& u) const {
  PALPABLE_EXPECT(u.cols() == table_.vertices, "a field has three values a vertex");
  kernels().dots(table_.modes.data(), static_cast<std::size_t>(u.size()), code, u.data());
  u.reshaped().array() *=
      Eigen::Map<const Eigen::ArrayXf>(table_.mode_scale.data(), Eigen::Index{3} * u.cols());
}

void Compliance::add_near(int vertex, const Eigen::Vector3f& force, Eigen::Matrix3Xf& u) const {
  const std::span<const int> near = neighbours(vertex);
  const std::size_t width = padded(near.size());
  const std::int16_t* rows = table_.near.data() + near_first_[vertex];
  const Eigen::Vector3f scaled = table_.near_scale[vertex] * force;
  std::array<float, kMostNeighbours> sum;  // of one component at a time
  for (int c = 0; c < 3; ++c) {
    std::fill_n(sum.begin(), width, 0.0f);
    for (int d = 0; d < 3; ++d) {
      kernels().add(rows + static_cast<std::size_t>(3 * d + c) * width, scaled[d],
                    {sum.data(), width});
    }
    for (std::size_t k = 0; k < near.size(); ++k) u(c, near[k]) += sum[k];
  }
}

Eigen::Matrix3f Compliance::near_block(int vertex, std::size_t k) const {
  const std::size_t width = padded(neighbours(vertex).size());
  const std::int16_t* rows = table_.near.data() + near_first_[vertex] + k;
  Eigen::Matrix3f block;
  for (int d = 0; d < 3; ++d) {
    for (int c = 0; c < 3; ++c) {
      block(c, d) = static_cast<float>(rows[static_cast<std::size_t>(3 * d + c) * width]);
    }
  }
  return table_.near_scale[vertex] * block;
}

}  // namespace palpable
