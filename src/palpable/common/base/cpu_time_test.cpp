#include "palpable/common/base/cpu_time.h"

#include "tests/support/test.h"

#include <chrono>
#include <thread>

namespace palpable {
namespace {

// Keeps the processor busy until this process has used `cpu` more seconds of processor time. The
// test hangs if process_cpu_seconds() never rises.
void work(double cpu) {
  const double begin = process_cpu_seconds();
  while (process_cpu_seconds() - begin < cpu) {}
}

TEST_CASE("processor time is that of all threads, and none while they sleep", "[base]") {
  const double begin = process_cpu_seconds();
  CHECK(begin >= 0);
  std::thread(work, 0.02).join();
  const double worked = process_cpu_seconds();
  CHECK(worked - begin >= 0.02);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(process_cpu_seconds() - worked < 0.15);
}

}  // namespace
}  // namespace palpable
