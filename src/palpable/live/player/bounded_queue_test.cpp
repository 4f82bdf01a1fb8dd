#include "palpable/live/player/bounded_queue.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <memory>
#include <thread>
#include <utility>

namespace palpable {
namespace {

TEST_CASE("a queue hands everything over in order and tells that it is closed",
          "[player][threads]") {
  BoundedQueue<int> queue(2);
  std::thread producer([&] {
    for (int i = 0; i < 1000; ++i) queue.push(i);
    queue.close();
  });
  int expected = 0;
  while (const auto item = queue.pop()) CHECK(*item == expected++);
  producer.join();
  CHECK(expected == 1000);
  CHECK_FALSE(queue.push(1));
  CHECK_FALSE(queue.pop().has_value());
}

TEST_CASE("a queue takes no memory once it is made", "[player]") {
  BoundedQueue<std::unique_ptr<int>> queue(3);
  std::unique_ptr<int> item = std::make_unique<int>(7);
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 1000; ++i) {
            queue.push(std::move(item));
            item = std::move(*queue.pop());
          }
        }) == 0);
  CHECK(*item == 7);
}

}  // namespace
}  // namespace palpable
