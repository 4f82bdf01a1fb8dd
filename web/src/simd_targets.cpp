// Highway's choice of vector instructions for wasm, where there is nothing to choose: Debian's
// library is compiled for other processors, and only its headers serve here.

#include <cstdint>
#include <hwy/targets.h>

namespace hwy {

int64_t SupportedTargets() { return HWY_WASM; }
void SetSupportedTargetsForTest(int64_t) {}
ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
