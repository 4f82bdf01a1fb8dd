#include "palpable/bake/campaign/store_rows.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const StoredField* find_field(const StoreContent& content, const char* name) {
  const auto at = std::find_if(content.fields.begin(), content.fields.end(),
                               [&](const StoredField& field) { return field.name == name; });
  return at == content.fields.end() ? nullptr : &*at;
}

namespace {

// Snapshots over site x level x point, of consecutive points; the point varies fastest.
SnapshotRows rows_of_points(const SnapshotStore& store, int first_point, int points,
                            const StoredField& field) {
  const int S = store.content().site_count(), L = store.content().level_count();
  const Index N = Index{store.content().mesh.node_count()} * field.components;
  const auto site = [&store, first_point, points, field, S, L](int s, Index first, Index count) {
    MatrixXd values(count, Index{L} * points);
    for (int p = 0; p < points; ++p) {
      values(Eigen::all, Eigen::seqN(p, L, points)) =
          store.rows((first_point + p) * S + s, field, first, count).cast<double>();
    }
    return values;
  };
  return {N,
          {S, L},
          [site, S, L, points](Index first, Index count) {
            MatrixXd values(count, Index{S} * L * points);
            for (int s = 0; s < S; ++s) {
              values.middleCols(Index{s} * L * points, Index{L} * points) = site(s, first, count);
            }
            return values;
          },
          [site, N](int s) { return site(s, 0, N); }};
}

}  // namespace

SnapshotRows snapshot_rows(const SnapshotStore& store, int point, const StoredField& field) {
  return rows_of_points(store, point, 1, field);
}

SnapshotRows snapshot_rows(const SnapshotStore& store, const StoredField& field) {
  SnapshotRows rows = rows_of_points(store, 0, store.content().point_count(), field);
  for (const StoredParameter& parameter : store.content().parameters) {
    rows.sizes.push_back(static_cast<int>(parameter.values.size()));
  }
  return rows;
}

VectorXd value_weights(const TetMesh& mesh, const StoredField& field) {
  VectorXd components = VectorXd::Ones(field.components);
  if (field.name == "stress") components.tail(3).setConstant(2.0);  // xx yy zz xy yz zx
  return (components * nodal_volumes(mesh).transpose()).reshaped();
}

int point_of(const StoreContent& content, const std::map<std::string, double>& at) {
  for (const auto& wanted : at) {
    const std::string& name = wanted.first;
    const auto known = std::find_if(content.parameters.begin(), content.parameters.end(),
                                    [&](const StoredParameter& p) { return p.name == name; });
    if (known != content.parameters.end()) continue;
    std::string names;
    for (const StoredParameter& p : content.parameters) names += fmt::format(" '{}'", p.name);
    throw Error(fmt::format(
        "these snapshots have no parameter '{}';{}", name,
        names.empty() ? " there is none beside site and level" : " there are:" + names));
  }
  int point = 0;
  for (const StoredParameter& parameter : content.parameters) {
    const auto n = static_cast<int>(parameter.values.size());
    int k = n / 2;
    if (const auto wanted = at.find(parameter.name); wanted != at.end()) {
      const auto distance = (parameter.values.array() - wanted->second).abs();
      if (!(distance.minCoeff(&k) <= 1e-9 * std::abs(wanted->second))) {
        std::string there;
        for (const double value : parameter.values) there += " " + number_text(value);
        throw Error(fmt::format("'{}' has no value {}; there are:{}", parameter.name,
                                number_text(wanted->second), there));
      }
    }
    point = point * n + k;
  }
  return point;
}

}  // namespace palpable
