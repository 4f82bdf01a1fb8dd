#include "palpable/live/events/live_events.h"

#include "palpable/live/session/frame_loop.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <vector>

namespace palpable {
namespace {

using nlohmann::json;

// A client of the socket at this path.
class SocketClient {
 public:
  explicit SocketClient(const std::string& path)
      : descriptor_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    REQUIRE(::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0);
  }
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;
  ~SocketClient() { ::close(descriptor_); }

  // The lines that have come since the last call.
  std::vector<json> lines() {
    std::array<char, 65536> bytes{};
    const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    std::vector<json> lines;
    std::string text(bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
    for (std::size_t end = 0; (end = text.find('\n')) != std::string::npos;
         text.erase(0, end + 1)) {
      lines.push_back(json::parse(text.substr(0, end)));
    }
    return lines;
  }

 private:
  int descriptor_;
};

FrameLoop loop_with_sphere_at(double x) {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = Eigen::Vector3d(x, 0, 0.4);
  return value_or_throw(FrameLoop::make(test::DentedSphere{}.body(), pose, test::wall_format(),
                                        {.press_static = true, .map = false}));
}

double first_x(const json& hello) { return hello["bodies"][0]["world_from_body"][3].get<double>(); }

TEST_CASE("clients of a run get its bodies, its frames and the ticks between them", "[events]") {
  const test::ScratchFolder folder("live_events");
  const std::string path = (folder / "s").string();
  LiveEvents events("unix:" + path);
  CHECK(events.name() == "unix:" + path);
  FrameLoop loop = loop_with_sphere_at(0.25);
  SocketClient early(path);
  Scene scene;
  scene.bodies.resize(1);
  events.send(scene);  // the run has not begun: no client is accepted yet
  CHECK(early.lines().empty());

  events.begin(loop.session);
  events.serve();
  scene.number = 7;
  events.send(scene);
  const std::vector<Touch> touches(2);
  events.send(7, 3, 0.25, touches);
  const std::vector<json> lines = early.lines();
  REQUIRE(lines.size() == 3);
  CHECK(lines[0]["type"] == "hello");
  CHECK(first_x(lines[0]) == 0.25);
  CHECK(lines[1]["frame"] == 7);
  CHECK(lines[2]["tick"] == 3);

  // A new session: those who come now are told of its poses.
  const FrameLoop other = loop_with_sphere_at(-0.5);
  events.begin(other.session);
  SocketClient late(path);
  events.serve();
  const std::vector<json> greeting = late.lines();
  REQUIRE(greeting.size() == 1);
  CHECK(first_x(greeting[0]) == -0.5);
  CHECK(events.text() ==
        "events: 2 clients, 0 refused, 0 closed because they did not read, 0 lines dropped\n");
}

TEST_CASE("a run without events has none, and an address that is none is refused", "[events]") {
  LiveEvents none(kNoEvents);
  none.begin(loop_with_sphere_at(0).session);
  none.send(Scene());
  none.serve();
  CHECK(none.name().empty());
  CHECK(none.text().empty());
  CHECK_THROWS_WITH(LiveEvents("nowhere"), Catch::StartsWith("--events: "));
}

}  // namespace
}  // namespace palpable
