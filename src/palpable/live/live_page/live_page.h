/// @file
/// The page of a running session (palpable live --serve): picture, skins, touches and forces in a
/// browser on this machine. docs/web.md#the-live-desk describes what is sent.
///
///   frame loop ──> lines, skins ───────────────────> PageServer's thread ──> pages
///              ──> picture ──> halved, JPEG, on a thread of its own ──┘
///
/// While no page is open, a frame costs the loop a look at a counter. A page that is opened while
/// no frame comes, because the run is paused or its source is silent, gets the last one: the loop
/// calls send_missed() while it waits.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/events/event_lines.h"
#include "palpable/live/live_page/page_server.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

#include <Eigen/Core>

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace palpable {

/// Where the page of a run is served.
struct LivePageSettings {
  int port = 0;                  ///< of 127.0.0.1; 0: any free one
  std::filesystem::path bundle;  ///< folder of web/page's bundle (read_page_bundle())
};

/// A body as its page needs it. Constant during a session.
struct LivePageBody {
  EventBody event;
  std::string material;      ///< in words, from the body file
  Eigen::Matrix3Xi corners;  ///< of the skin's triangles, indices of vertices
};

/// The bodies of a session, in its order.
[[nodiscard]] std::vector<LivePageBody> live_page_bodies(const Session& session);

/// Copies what a page is sent of a scene, which is all but its images. Memory is reused.
void keep_for_page(const Scene& scene, Scene& kept);

/// What a page is told beside the bodies.
struct LivePageFacts {
  EventWorld world = EventWorld::kFirstCamera;
  double stress_top = 1;     ///< Pa, top of the colours: stress_scale()
  bool has_picture = false;  ///< whether send_picture() will be called
};

/// The pages of one run; without effect if there are no settings. After begin(), the functions that
/// send may be called from any thread; none of them waits.
class LivePage {
 public:
  /// Listens. Browsers that connect wait until begin().
  /// @throws Error that names --serve: the bundle is not built, or the port is taken
  explicit LivePage(const std::optional<LivePageSettings>& settings);
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;
  ~LivePage();

  [[nodiscard]] bool is_served() const { return server_ != nullptr; }
  /// http://127.0.0.1:PORT/TOKEN/; empty if nothing is served. Whoever knows it sees the session.
  [[nodiscard]] std::string url() const;

  /// Answers from now on. Called again when the run has a new session: open pages begin with it,
  /// too.
  void begin(const std::vector<LivePageBody>& bodies, const LivePageFacts& facts);

  /// Sends the touches of a frame, and its skins if a page wants them.
  void send(const Scene& scene);
  /// Sends the skins although no page may be open yet: what the first one shows until a frame.
  /// After begin().
  void send_at_rest(const Scene& scene);
  /// Whether a page may have come since send_missed() was called last: it has not got the last
  /// frame.
  [[nodiscard]] bool is_any_new() const { return server_ && server_->arrivals() != arrivals_; }
  /// While no frame comes: sends the last one's touches and skins to pages that have not got them.
  /// Costs a look at a counter if no page has come since the last call.
  /// @param scene  the last frame's; null: none came
  /// @return whether the last picture is to be sent by send_picture(), too
  bool send_missed(const Scene* scene);
  /// Sends the touches of a tick between two frames.
  void send(int frame, int tick, double time, std::span<const Touch> touches);

  /// Whether some page wants the next picture.
  [[nodiscard]] bool wants_picture() const { return server_ && server_->wants_pictures(); }
  /// Copies the picture for the encoding thread. It replaces one that still waits to be encoded.
  void send_picture(const ColorImage& picture);

  /// The numbers of pages and of what they lost in a readable line; empty if nothing is served.
  [[nodiscard]] std::string text() const;

 private:
  void send_skins(const Scene& scene);
  void encode();

  std::unique_ptr<PageServer> server_;  // null: nothing is served

  std::mutex lines_mutex_;  // ticks are sent from another thread
  std::optional<EventLines> lines_;
  std::string skin_, sent_skin_;  // of the frame loop alone, and so is:
  std::uint64_t arrivals_ = 0;    // PageServer::arrivals() at the last send_missed()

  std::mutex picture_mutex_;  // guards the following, up to encoder_
  std::condition_variable picture_came_;
  ColorImage picture_;
  bool has_picture_ = false, ends_ = false;
  std::thread encoder_;
};

}  // namespace palpable
