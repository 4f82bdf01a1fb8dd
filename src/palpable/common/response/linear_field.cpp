#include "palpable/common/response/linear_field.h"

#include <algorithm>
#include <cstddef>

namespace palpable {

LinearField::LinearField(const Compliance& compliance)
    : compliance_(compliance),
      sources_(static_cast<std::size_t>(compliance.clusters()) * compliance.rank()),
      targets_(sources_.size()),
      is_source_(static_cast<std::size_t>(compliance.clusters())) {
  by_cluster_.reserve(static_cast<std::size_t>(compliance.vertices()));
}

void LinearField::fill(std::span<const VertexForce> loads, const Eigen::Ref<Eigen::Matrix3Xf>& u) {
  const std::size_t k = compliance_.rank();
  const auto C = static_cast<std::size_t>(compliance_.clusters());
  const auto of = [k](std::vector<float>& numbers, std::size_t cluster) {
    return std::span<float>(numbers.data() + cluster * k, k);
  };
  std::fill(sources_.begin(), sources_.end(), 0.0f);
  std::fill(is_source_.begin(), is_source_.end(), char{0});
  by_cluster_.clear();
  for (const VertexForce& load : loads) {
    if (!load.force.isZero(0)) by_cluster_.push_back(load);
  }
  std::sort(by_cluster_.begin(), by_cluster_.end(), [&](const auto& a, const auto& b) {
    const int c = compliance_.cluster_of(a.vertex), d = compliance_.cluster_of(b.vertex);
    return c != d ? c < d : a.vertex < b.vertex;
  });
  for (const VertexForce& load : by_cluster_) {
    const auto cluster = static_cast<std::size_t>(compliance_.cluster_of(load.vertex));
    is_source_[cluster] = 1;
    compliance_.add_source(load.vertex, load.force, of(sources_, cluster));
  }
  std::fill(targets_.begin(), targets_.end(), 0.0f);
  for (std::size_t from = 0; from < C; ++from) {
    if (is_source_[from] == 0) continue;
    for (std::size_t to = 0; to < C; ++to) {
      if (!compliance_.are_far(static_cast<int>(from), static_cast<int>(to))) continue;
      compliance_.add_target(static_cast<int>(from), of(sources_, from), static_cast<int>(to),
                             of(targets_, to));
    }
  }
  compliance_.everywhere(targets_, u);
  compliance_.add_near(by_cluster_, u);
}

}  // namespace palpable
