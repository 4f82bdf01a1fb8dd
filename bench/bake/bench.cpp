// Functions shared by several benchmarks of the offline half.

#include "bench/bake/bench.h"

#include "palpable/common/base/json.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/core.h>

#include <thread>

namespace palpable::app {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void print_figures(Json figures, bool json) {
  figures["peak_memory_mb"] = peak_memory() / 1e6;
  figures["cores"] = std::thread::hardware_concurrency();
  figures["processor"] = processor_name();
  figures["date"] = date_today();
  if (json) {
    fmt::print("{}\n", figures.dump(2));
    return;
  }
  for (const auto& [key, value] : figures.items()) fmt::print("{:<36} {}\n", key, value.dump());
}

}  // namespace palpable::app
