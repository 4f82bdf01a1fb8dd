#include "palpable/common/response/touchable_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/reduced_body.h"

#include <cmath>

namespace palpable {
namespace {

void multiply(std::vector<float>& scale, double factor) {
  for (float& s : scale) s = static_cast<float>(factor * static_cast<double>(s));
}

// Strains and stress stay the same. A displacement grows by s under a load that grows by s^2, so G
// is multiplied by 1/s. Modes of unit energy are multiplied by 1/sqrt(s), and the derivative of
// order n of the energy by them is multiplied by s^(3 - n) s^(-n/2).
TouchTables scaled(const TouchTables& tables, double s) {
  TouchTables result = tables;
  multiply(result.compliance.couplings.scale, 1 / s);
  multiply(result.compliance.near_scale, 1 / s);
  const double modes = 1 / std::sqrt(s), cubic = std::pow(s, -1.5), quartic = std::pow(s, -3.0);
  for (RegionTable& region : result.regions) {
    multiply(region.modes.scale, modes);
    multiply(region.far_shapes.scale, modes);  // the shares have no unit
    multiply(region.cubic.scale, cubic);
    multiply(region.quartic.scale, quartic);
  }
  multiply(result.cross.modes.scale, modes);
  multiply(result.cross.cubic.scale, cubic);
  if (result.coarse) result.coarse->surface.vertices *= s;
  result.shell.stress_free *= static_cast<float>(s);
  result.shell.preload *= static_cast<float>(s);
  if (tables.vibration) result.vibration = scaled(*tables.vibration, s);
  result.region_reach *= s;
  result.point_spacing *= s;
  return result;
}

}  // namespace

void set_friction(TouchableBody& body, double mu) {
  PALPABLE_EXPECT(is_friction(mu), "a coefficient of friction");
  if (body.touch) body.touch->friction = mu;
  if (body.modal) body.modal->friction = mu;
}

double friction_of(const TouchableBody& body) {
  if (body.touch) return body.touch->friction;
  return body.modal ? body.modal->friction : 0.0;
}

TouchableBody scaled(const TouchableBody& body, double factor) {
  TouchableBody result = scaled(body.body, factor);
  if (body.touch) result.touch = scaled(*body.touch, factor);
  if (body.modal) result.modal = scaled(*body.modal, factor);
  return result;
}

}  // namespace palpable
