#include "palpable/touch/refinement.h"

#include <algorithm>

namespace palpable {
namespace {

// A load of more than so many times f_0 is corrected as that one: s^2 was found to hold up to 2.
constexpr float kMostOfAsked = 1.5f;

}  // namespace

float correction_weight(float work, float shared, float asked) {
  if (!(work > 0) || !(shared > 0) || !(asked > 0)) return 0;
  const float s = std::min(shared / asked, kMostOfAsked);
  const float k = std::min(1.0f, shared / work * (shared / asked));
  return s * s * k * k * k * k;
}

}  // namespace palpable
