#include "palpable/common/base/simd_targets.h"

#include "tests/support/test.h"

#include <fstream>
#include <hwy/targets.h>
#include <string>
#include <vector>

namespace palpable {
namespace {

TEST_CASE(
    "each set of instructions is offered once while Highway has chosen it, and no choice stays",
    "[base][simd]") {
  const std::int64_t chosen_before = hwy::SupportedTargets();
  std::vector<std::int64_t> targets;
  for (std::int64_t bits = chosen_before; bits != 0; bits &= bits - 1) {
    targets.push_back(bits & -bits);
  }
  targets.push_back(HWY_SCALAR);
  std::vector<std::string> offered;
  std::vector<std::int64_t> during;
  for_each_simd_target(targets, [&](const char* name) {
    offered.emplace_back(name);
    during.push_back(hwy::SupportedTargets());
  });
  std::vector<std::string> names;
  std::vector<std::int64_t> expected;
  for (const std::int64_t target : targets) {
    if (target == HWY_SCALAR || !runs_here(target)) continue;
    names.emplace_back(hwy::TargetName(target));
    expected.push_back(target);
  }
  CHECK(offered == names);
  CHECK(during == expected);
  CHECK(hwy::SupportedTargets() == chosen_before);
}

#if HWY_ARCH_X86
TEST_CASE("AVX3_DL is used only where the processor has AVX-VNNI, which it is compiled with",
          "[base][simd]") {
  std::ifstream info("/proc/cpuinfo");
  std::string flags;
  while (std::getline(info, flags) && !flags.starts_with("flags")) {}
  if (flags.empty()) return test::skip("/proc/cpuinfo has no flags");
  CHECK(runs_here(HWY_AVX3_DL) == ((flags + " ").find(" avx_vnni ") != std::string::npos));
  CHECK(runs_here(HWY_AVX3));
}
#endif

}  // namespace
}  // namespace palpable
