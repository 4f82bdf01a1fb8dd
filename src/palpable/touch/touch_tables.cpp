#include "palpable/touch/touch_tables.h"

namespace palpable {
namespace {

std::size_t bytes(const auto& list) { return list.size() * sizeof(list[0]); }
std::size_t bytes(const RoundedRows& rows) { return bytes(rows.values) + bytes(rows.scale); }
std::size_t bytes(const SymmetricForm& form) { return bytes(form.values) + bytes(form.scale); }

}  // namespace

std::size_t bytes_of(const TouchTables& tables) {
  const ComplianceTable& c = tables.compliance;
  std::size_t sum = bytes(c.cluster_of) + bytes(c.basis) + bytes(c.far_first) +
                    bytes(c.far_second) + bytes(c.couplings) + bytes(c.first) +
                    bytes(c.neighbours) + bytes(c.near) + bytes(c.near_scale);
  for (const RegionTable& region : tables.regions) {
    sum += bytes(region.vertices) + bytes(region.modes) + bytes(region.source_clusters) +
           bytes(region.sources) + bytes(region.cubic) + bytes(region.quartic);
  }
  return sum + bytes(tables.cross.modes) + bytes(tables.cross.cubic);
}

}  // namespace palpable
