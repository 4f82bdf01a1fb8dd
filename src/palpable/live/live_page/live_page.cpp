#include "palpable/live/live_page/live_page.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/live/live_page/half_size.h"
#include "palpable/live/live_page/page_access.h"
#include "palpable/live/live_page/skin_message.h"
#include "palpable/live/page/press_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

namespace palpable {
namespace {

constexpr int kPageJpeg = 75;  // quality: 640 x 360 pixels are some 40 KB

std::vector<ServedFile> files_of(const PageBundle& bundle) {
  return {{"", "text/html; charset=utf-8", live_page_text(bundle, kLiveSocket)},
          {"page.js", "text/javascript; charset=utf-8", bundle.script}};
}

// The second line that greets a page.
std::string page_line(const std::vector<LivePageBody>& bodies, const LivePageFacts& facts) {
  Json listed = Json::array();
  for (const LivePageBody& body : bodies) {
    listed.push_back(Json{{"name", body.event.name}, {"material", body.material}});
  }
  return Json{{"type", "page"},
              {"stress_top", facts.stress_top},
              {"picture", facts.has_picture},
              {"bodies", listed}}
      .dump();
}

}  // namespace

std::vector<LivePageBody> live_page_bodies(const Session& session) {
  std::vector<EventBody> events = event_bodies(session);
  std::vector<LivePageBody> bodies;
  for (int k = 0; k < session.body_count(); ++k) {
    const ReducedBody& model = session.body(k).model();
    bodies.push_back(
        {std::move(events[static_cast<std::size_t>(k)]), model.material, model.surface.triangles});
  }
  return bodies;
}

void keep_for_page(const Scene& scene, Scene& kept) {
  kept.number = scene.number;
  kept.time = scene.time;
  kept.touches = scene.touches;
  kept.things = scene.things;
  kept.bodies = scene.bodies;
  kept.mutual_penetration = scene.mutual_penetration;
  kept.imbalance = scene.imbalance;
  kept.left_to_move = scene.left_to_move;
  kept.inside = scene.inside;
  kept.answer = scene.answer;
  kept.contacts_dropped = scene.contacts_dropped;
  kept.friction_residual = scene.friction_residual;
  kept.camera = scene.camera;
}

LivePage::LivePage(const std::optional<LivePageSettings>& settings) {
  if (!settings) return;
  try {
    server_ = std::make_unique<PageServer>(
        PageServerSettings{.port = settings->port,
                           .token = new_page_token(),
                           .files = files_of(read_page_bundle(settings->bundle))});
  } catch (const Error& error) { throw Error(fmt::format("--serve: {}", error.what())); }
}

LivePage::~LivePage() {
  {
    const std::lock_guard lock(picture_mutex_);
    ends_ = true;
  }
  picture_came_.notify_one();
  if (encoder_.joinable()) encoder_.join();
}

std::string LivePage::url() const {
  return server_ ? fmt::format("http://127.0.0.1:{}/{}/", server_->port(), server_->token()) : "";
}

void LivePage::begin(const std::vector<LivePageBody>& bodies, const LivePageFacts& facts) {
  if (!server_) return;
  std::vector<EventBody> events;
  std::vector<Eigen::Matrix3Xi> corners;
  for (const LivePageBody& body : bodies) {
    events.push_back(body.event);
    corners.push_back(body.corners);
  }
  {
    const std::lock_guard lock(lines_mutex_);
    lines_.emplace(events);
  }
  server_->begin({hello_line(events, facts.world), page_line(bodies, facts)},
                 mesh_message(corners));
  sent_skin_.clear();  // the server has forgotten it
  if (facts.has_picture && !encoder_.joinable()) encoder_ = std::thread([this] { encode(); });
}

void LivePage::send(const Scene& scene) {
  if (!server_ || !server_->has_clients()) return;
  {
    const std::lock_guard lock(lines_mutex_);
    if (lines_) server_->send_line(lines_->line_of(scene));
  }
  if (server_->wants_skins()) send_skins(scene);
}

void LivePage::send_at_rest(const Scene& scene) {
  if (server_) send_skins(scene);
}

bool LivePage::send_missed(const Scene* scene) {
  if (!is_any_new()) return false;
  arrivals_ = server_->arrivals();
  if (scene == nullptr) return false;
  {
    const std::lock_guard lock(lines_mutex_);
    if (lines_) server_->send_missed_line(lines_->line_of(*scene));
  }
  if (server_->wants_skins()) send_skins(*scene);
  return wants_picture();
}

void LivePage::send(int frame, int tick, double time, std::span<const Touch> touches) {
  if (!server_ || !server_->has_clients()) return;
  const std::lock_guard lock(lines_mutex_);
  if (lines_) server_->send_line(lines_->tick_line(frame, tick, time, touches), false);
}

void LivePage::send_skins(const Scene& scene) {
  write_skin_message(scene.number, scene.bodies, skin_);
  const auto shown = [](const std::string& message) {
    return std::string_view(message).substr(std::min(kSkinsBegin, message.size()));
  };
  if (shown(skin_) == shown(sent_skin_)) return;  // nothing has moved
  server_->send_skin(skin_);
  std::swap(skin_, sent_skin_);
}

void LivePage::send_picture(const ColorImage& picture) {
  if (!wants_picture() || picture.width() < 2 || picture.height() < 2) return;
  {
    const std::lock_guard lock(picture_mutex_);
    picture_ = picture;
    has_picture_ = true;
  }
  picture_came_.notify_one();
}

void LivePage::encode() {
  ColorImage picture, half;
  std::vector<std::uint8_t> jpeg;
  while (true) {
    {
      std::unique_lock lock(picture_mutex_);
      picture_came_.wait(lock, [this] { return ends_ || has_picture_; });
      if (ends_) return;
      std::swap(picture, picture_);
      has_picture_ = false;
    }
    halve(picture, half);
    encode_jpeg(half, kPageJpeg, jpeg);
    if (jpeg.empty()) continue;
    server_->send_picture(
        {reinterpret_cast<const char*>(jpeg.data()),  // NOLINT(*-reinterpret-cast)
         jpeg.size()});
  }
}

std::string LivePage::text() const {
  if (!server_) return {};
  const PageCounts counts = server_->counts();
  return fmt::format(
      "page: {} clients, {} refused, {} closed because they were silent, {} sent away for what "
      "they "
      "sent; {} pictures and {} lines dropped\n",
      counts.clients, counts.refused, counts.closed_behind, counts.sent_away, counts.lost_pictures,
      counts.lost_lines);
}

}  // namespace palpable
