#include "palpable/bake/campaign/held_out.h"

#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Eigen::VectorXf;

const StoredField& field_of(const SnapshotStore& store, const char* name) {
  const StoredField* field = find_field(store.content(), name);
  if (field == nullptr) throw Error(fmt::format("{}: has no {}", store.folder().string(), name));
  return *field;
}

// (c V x L) a field of a unit on the skin.
Eigen::MatrixXf on_skin(const SnapshotStore& store, int unit, const StoredField& field,
                        const Boundary& boundary) {
  const Index c = field.components;
  const Eigen::MatrixXf all = store.rows(unit, field, 0, c * store.content().mesh.node_count());
  Eigen::MatrixXf skin(c * static_cast<Index>(boundary.node_of_vertex.size()), all.cols());
  for (std::size_t v = 0; v < boundary.node_of_vertex.size(); ++v) {
    skin.middleRows(c * static_cast<Index>(v), c) =
        all.middleRows(c * boundary.node_of_vertex[v], c);
  }
  return skin;
}

std::span<float> span_of(VectorXf& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

double median(const MatrixXd& values) {
  std::vector<double> all(values.data(), values.data() + values.size());
  return upper_median(all);
}

}  // namespace

HeldOutRecord HeldOutErrors::record() const {
  return {levels, displacement.cast<float>(), displacement_pooled, von_mises.cast<float>()};
}

double HeldOutErrors::displacement_median() const { return median(displacement); }
double HeldOutErrors::von_mises_median() const { return median(von_mises); }

HeldOutErrors held_out_errors(const ReducedBody& body, const SnapshotStore& held_out, int point,
                              HeldOutAt at) {
  PALPABLE_EXPECT(body.is_settled(), "a press has a site and a level");
  const StoreContent& content = held_out.content();
  const int S = content.site_count(), L = content.level_count();
  const Boundary boundary = split_boundary_of(content.mesh);
  const Index V = boundary.surface.vertex_count();
  if (V != body.surface.vertex_count() || S != static_cast<int>(body.sites.size())) {
    throw Error(fmt::format("{}: is not of the body '{}': {} vertices and {} sites, not {} and {}",
                            held_out.folder().string(), body.name, V, S,
                            body.surface.vertex_count(), body.sites.size()));
  }
  const StoredField& moved = field_of(held_out, "displacement");
  const StoredField& stressed = field_of(held_out, "stress");
  const VectorXd areas = vertex_areas(body.surface).transpose().replicate(3, 1).reshaped();
  HeldOutErrors errors{MatrixXd(L, S), 0, MatrixXd(L, S), content.levels.tail(L)};
  double lost = 0, whole = 0;
  VectorXf u(3 * V), sigma(6 * V), vm(V), vm_truth(V);
  for (int s = 0; s < S; ++s) {
    const int unit = point * S + s;
    const std::string why = held_out.why_not(unit);
    if (!why.empty()) throw Error(fmt::format("{}: {}", held_out.unit_file(unit).string(), why));
    const Eigen::MatrixXf u_truth = on_skin(held_out, unit, moved, boundary);
    const Eigen::MatrixXf sigma_truth = on_skin(held_out, unit, stressed, boundary);
    const VectorXd depth = held_out.unit(unit).press_depth;
    for (int l = 0; l < L; ++l) {
      const double level = at == HeldOutAt::kLevel ? content.levels[l + 1]
                                                   : level_of_press_depth(body, s, depth[l + 1]);
      const double mu[2] = {static_cast<double>(s), level};
      body.displacement.evaluate(mu, span_of(u));
      const VectorXd truth = u_truth.col(l).cast<double>();
      const double own_lost = (u.cast<double>() - truth).cwiseAbs2().dot(areas);
      const double own = truth.cwiseAbs2().dot(areas);
      errors.displacement(l, s) = std::sqrt(own_lost / own);
      lost += own_lost;
      whole += own;
      body.stress.evaluate(mu, span_of(sigma));
      von_mises(span_of(sigma), span_of(vm));
      VectorXf six = sigma_truth.col(l);
      von_mises(span_of(six), span_of(vm_truth));
      errors.von_mises(l, s) =
          static_cast<double>((vm - vm_truth).cwiseAbs().maxCoeff() / vm_truth.maxCoeff());
    }
  }
  errors.displacement_pooled = std::sqrt(lost / whole);
  return errors;
}

}  // namespace palpable
