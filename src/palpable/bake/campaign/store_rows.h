/// @file
/// A store of snapshots as the table that a reduction reads, and the norm of its values.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/separate/snapshot_tensor.h"

#include <Eigen/Core>

#include <map>
#include <string>

namespace palpable {

/// nullptr when the store has no such field.
[[nodiscard]] const StoredField* find_field(const StoreContent& content, const char* name);

/// The point at which the parameters beyond site and level have the values `at`. A parameter that
/// is not named has the value in the middle of its list.
/// @throws Error if `at` names what the store does not have
[[nodiscard]] int point_of(const StoreContent& content, const std::map<std::string, double>& at);

/// One point's snapshots of a field over site x level. @param store  outlives the result
[[nodiscard]] SnapshotRows snapshot_rows(const SnapshotStore& store, int point,
                                         const StoredField& field);

/// The snapshots of a field at all points, over site x level x parameters.
[[nodiscard]] SnapshotRows snapshot_rows(const SnapshotStore& store, const StoredField& field);

/// (c N) the weight of each value so that the norm is an integral over the body: the node's volume,
/// and for stress twice that where a component stands for two equal ones (xy and yx).
[[nodiscard]] Eigen::VectorXd value_weights(const TetMesh& mesh, const StoredField& field);

}  // namespace palpable
