#include "palpable/common/reduced/evaluation_times.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"

#include <array>
#include <chrono>
#include <functional>
#include <vector>

namespace palpable {
namespace {

// Median microseconds of one call. @param call  number of the touch
double median_us(int repeats, const std::function<void(int)>& call) {
  std::vector<double> times;
  for (int i = -repeats / 8; i < repeats; ++i) {  // the first ones warm the caches
    const auto begin = std::chrono::steady_clock::now();
    call(i);
    const std::chrono::duration<double, std::micro> taken =
        std::chrono::steady_clock::now() - begin;
    if (i >= 0) times.push_back(taken.count());
  }
  return upper_median(times);
}

}  // namespace

EvaluationTimes evaluation_times(const ReducedBody& unsettled, int repeats) {
  const ReducedBody body = value_or_throw(settled(unsettled));
  std::vector<float> u(body.displacement.value_count());
  std::vector<float> sigma(body.stress.value_count());
  std::vector<float> vm(sigma.size() / 6);
  const auto S = static_cast<int>(body.sites.size());
  const auto at = [&](int i) {
    const int touch = i + 1000;  // warm-up calls have negative numbers
    return std::array{static_cast<double>(touch / 20 % S), 0.05 * (touch % 20) + 0.03};
  };
  EvaluationTimes times{.repeats = repeats};
  times.displacement_us =
      median_us(times.repeats, [&](int i) { body.displacement.evaluate(at(i), u); });
  times.stress_us = median_us(times.repeats, [&](int i) { body.stress.evaluate(at(i), sigma); });
  times.all_us = median_us(times.repeats, [&](int i) {
    body.displacement.evaluate(at(i), u);
    body.stress.evaluate(at(i), sigma);
    von_mises(sigma, vm);
  });
  return times;
}

}  // namespace palpable
