#include "palpable/live/live_page/client_queue.h"

#include "tests/support/test.h"

#include <memory>
#include <string>
#include <vector>

namespace palpable {
namespace {

SharedBytes shared(const std::string& bytes) { return std::make_shared<const std::string>(bytes); }

// All messages as they are sent.
std::vector<std::string> drained(ClientQueue& queue) {
  std::vector<std::string> texts;
  while (const auto message = queue.next()) {
    texts.push_back(message->begin + std::string(message->rest()));
    CHECK(message->is_text == (texts.back().front() == '{'));
  }
  return texts;
}

TEST_CASE("lines go first, then the skin, and the picture when nothing else waits",
          "[live_page][queue]") {
  ClientQueue queue(1000);
  queue.set_picture(shared("picture"));
  queue.set_skin(shared("skin"));
  queue.set_mesh(shared("mesh"));
  queue.add_line(shared("{\"a\":1}"));
  queue.add_line(shared("{\"a\":2}"));
  queue.add_greeting(shared("{\"type\":\"hello\"}"));
  CHECK(drained(queue) ==
        std::vector<std::string>{"{\"type\":\"hello\"}", "{\"dropped\":0,\"a\":1}",
                                 "{\"dropped\":0,\"a\":2}", "mesh", "skin", "picture"});
  CHECK(drained(queue).empty());
}

TEST_CASE("a slow client gets the newest picture and skin, and every line", "[live_page][queue]") {
  ClientQueue queue(1000);
  for (const char* number : {"1", "2", "3"}) {
    queue.set_picture(shared(std::string("picture ") + number));
    queue.set_skin(shared(std::string("skin ") + number));
    queue.add_line(shared(std::string("{\"a\":") + number + "}"));
  }
  CHECK(drained(queue) ==
        std::vector<std::string>{"{\"dropped\":0,\"a\":1}", "{\"dropped\":0,\"a\":2}",
                                 "{\"dropped\":0,\"a\":3}", "skin 3", "picture 3"});
  CHECK(queue.lost_pictures() == 2);
  CHECK(queue.lost_lines() == 0);
}

TEST_CASE("a client that reads nothing loses whole lines, and is told how many",
          "[live_page][queue]") {
  ClientQueue queue(15);  // bytes: two lines of seven
  for (int k = 0; k < 5; ++k) queue.add_line(shared("{\"a\":" + std::to_string(k) + "}"));
  queue.lose_lines(2);
  CHECK(drained(queue) ==
        std::vector<std::string>{"{\"dropped\":0,\"a\":0}", "{\"dropped\":0,\"a\":1}"});
  CHECK(queue.lost_lines() == 5);
  queue.add_line(shared("{\"a\":5}"));
  queue.add_line(shared("{\"a\":6}"));
  CHECK(drained(queue) ==
        std::vector<std::string>{"{\"dropped\":5,\"a\":5}", "{\"dropped\":0,\"a\":6}"});
}

TEST_CASE("another session begins after the lines of the one before, without its skin",
          "[live_page][queue]") {
  ClientQueue queue(15);  // bytes: two lines of seven, and greetings beside them
  queue.add_line(shared("{\"a\":1}"));
  queue.set_mesh(shared("mesh 1"));
  queue.set_skin(shared("skin 1"));
  queue.set_picture(shared("picture 1"));
  queue.begin_anew({shared("{\"type\":\"hello\"}"), shared("{\"type\":\"page\"}")});
  queue.set_mesh(shared("mesh 2"));
  queue.add_line(shared("{\"a\":2}"));
  CHECK(queue.has_mesh());
  CHECK(drained(queue) == std::vector<std::string>{"{\"dropped\":0,\"a\":1}",
                                                   "{\"type\":\"hello\"}", "{\"type\":\"page\"}",
                                                   "{\"dropped\":0,\"a\":2}", "mesh 2"});
  CHECK_FALSE(queue.has_mesh());
  queue.add_line(shared("{\"a\":3}"));
  CHECK(drained(queue) == std::vector<std::string>{"{\"dropped\":0,\"a\":3}"});
  CHECK(queue.lost_lines() == 0);
}

TEST_CASE("what a client no longer wants is not sent", "[live_page][queue]") {
  ClientQueue queue(1000);
  queue.set_mesh(shared("mesh"));
  queue.set_skin(shared("skin"));
  queue.set_picture(shared("picture"));
  queue.drop_skin();
  CHECK(drained(queue) == std::vector<std::string>{"picture"});
  queue.set_picture(shared("picture"));
  queue.drop_picture();
  CHECK(drained(queue).empty());
}

}  // namespace
}  // namespace palpable
