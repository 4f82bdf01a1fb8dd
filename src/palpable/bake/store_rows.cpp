#include "palpable/bake/store_rows.h"

#include <algorithm>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const StoredField* find_field(const StoreContent& content, const char* name) {
  const auto at = std::find_if(content.fields.begin(), content.fields.end(),
                               [&](const StoredField& field) { return field.name == name; });
  return at == content.fields.end() ? nullptr : &*at;
}

SnapshotRows snapshot_rows(const SnapshotStore& store, int point, const StoredField& field) {
  const int S = store.content().site_count(), L = store.content().level_count();
  const Index N = Index{store.content().mesh.node_count()} * field.components;
  return {N,
          {S, L},
          [&store, point, field, S, L](Index first, Index count) {
            MatrixXd values(count, Index{S} * L);
            for (int s = 0; s < S; ++s) {
              values.middleCols(Index{s} * L, L) =
                  store.rows(point * S + s, field, first, count).cast<double>();
            }
            return values;
          },
          [&store, point, field, S, N](int s) -> MatrixXd {
            return store.rows(point * S + s, field, 0, N).cast<double>();
          }};
}

VectorXd value_weights(const TetMesh& mesh, const StoredField& field) {
  VectorXd components = VectorXd::Ones(field.components);
  if (field.name == "stress") components.tail(3).setConstant(2.0);  // xx yy zz xy yz zx
  return (components * nodal_volumes(mesh).transpose()).reshaped();
}

}  // namespace palpable
