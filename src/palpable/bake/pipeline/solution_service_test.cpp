#include "palpable/bake/pipeline/solution_service.h"

#include "palpable/bake/touch_bake/full_solution.h"
#include "palpable/common/base/error.h"
#include "palpable/common/response/solution_messages.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace palpable {
namespace {

SolidModel block() {
  return test::standing_rubber(box_tets({-0.03, -0.025, 0}, {0.03, 0.025, 0.04}, 6, 5, 4));
}

std::unique_ptr<FullBody> body_of(const SolidModel& model) {
  return std::make_unique<FullBody>(model, boundary_of(model.mesh), Eigen::Matrix3Xd(3, 0));
}

// The service on a thread of its own, with the other end of its stream.
class Service {
 public:
  explicit Service(std::function<std::unique_ptr<FullBody>()> make_body) {
    int ends[2];
    REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
    here_ = ends[0];
    thread_ = std::thread([this, make_body = std::move(make_body), there = ends[1]] {
      result_ = serve_full_solutions(make_body, there, there);
      ::close(there);
    });
  }
  ~Service() {
    if (thread_.joinable()) (void)end();
  }
  void send(const std::vector<std::byte>& bytes) {
    REQUIRE(::send(here_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(bytes.size()));
  }
  ExactMessage next() {
    for (;;) {
      if (const auto message = messages_.next()) return *message;
      REQUIRE_FALSE(messages_.broken());
      const auto room = messages_.room();
      const ssize_t count = ::recv(here_, room.data(), room.size(), 0);
      REQUIRE(count > 0);
      messages_.add(static_cast<std::size_t>(count));
    }
  }
  // Closes the stream. @returns the result of serve_full_solutions()
  bool end() {
    ::shutdown(here_, SHUT_WR);
    thread_.join();
    ::close(here_);
    return result_;
  }

 private:
  int here_ = -1;
  bool result_ = false;
  ExactMessages messages_{1 << 20};
  std::thread thread_;
};

TEST_CASE("the service answers loads one after the other as the solver does", "[pipeline]") {
  const SolidModel model = block();
  const auto body = body_of(model);
  Service service([&] { return body_of(model); });
  const ExactMessage ready = service.next();
  REQUIRE(ready.kind == ExactMessage::Kind::kReady);
  CHECK(ready.count == static_cast<std::uint32_t>(body->skin.shell_count()));
  int top = 0;
  for (int v = 0; v < body->skin.vertex_count(); ++v)
    if (body->skin.skin().vertices(2, v) > body->skin.skin().vertices(2, top)) top = v;
  std::vector<std::byte> bytes;
  for (const std::uint32_t number : {4U, 9U}) {
    const std::vector<VertexForce> load{{top, {0.02f * static_cast<float>(number), 0, -0.1f}}};
    write_load(number, load, bytes);
    service.send(bytes);
    const ExactMessage answer = service.next();
    REQUIRE(answer.kind == ExactMessage::Kind::kAnswer);
    CHECK(answer.number == number);
    Eigen::Matrix3Xf field;
    answer.read_solution(field);
    CHECK(field == full_solution(body->solver, body->skin, nullptr, load).value());
  }
  write_load(10, std::vector<VertexForce>{{top, {0, 0, -1e6f}}}, bytes);
  service.send(bytes);
  CHECK(service.next().count == 0);
  CHECK(service.end());
}

TEST_CASE("the service ends where what comes is no load of its body", "[pipeline]") {
  const SolidModel model = block();
  std::vector<std::byte> another, rubbish(100, std::byte{7}), ready;
  write_load(1, std::vector<VertexForce>{{100'000, {0, 0, 1}}}, another);
  write_ready(3, ready);
  for (const auto& bytes : {another, rubbish, ready}) {
    Service service([&] { return body_of(model); });
    (void)service.next();
    service.send(bytes);
    CHECK_FALSE(service.end());
  }
}

TEST_CASE("the service says why it has no body", "[pipeline]") {
  Service service([]() -> std::unique_ptr<FullBody> { throw Error("no such surface"); });
  const ExactMessage message = service.next();
  REQUIRE(message.kind == ExactMessage::Kind::kSorry);
  CHECK(message.text() == "no such surface");
  CHECK(service.end());
}

}  // namespace
}  // namespace palpable
