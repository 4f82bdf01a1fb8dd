#include "web/src/palpable_web.h"

#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/common/web_file/web_file.h"
#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/session_camera.h"

#include <fmt/core.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>

namespace {

using palpable::Failure;

// Text of palpable_layout(), written once.
class LayoutText {
 public:
  void open_struct(const char* name, std::size_t size) {
    text_ += fmt::format("{}\"{}\":{{\"size\":{},\"members\":{{", next(), name, size);
    is_first_ = true;
  }
  void close_struct() {
    text_ += "}}";
    is_first_ = false;
  }
  void add(const char* name, std::size_t value) {
    text_ += fmt::format("{}\"{}\":{}", next(), name, value);
  }
  void begin(const char* text) {
    text_ += text;
    is_first_ = true;
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  const char* next() { return std::exchange(is_first_, false) ? "" : ","; }

  std::string text_;
  bool is_first_ = true;
};

#define ADD_MEMBER(name) layout.add(#name, offsetof(Struct, name))
#define ADD_CONSTANT(name) layout.add(#name, static_cast<std::size_t>(name))

void add_inputs(LayoutText& layout) {
  {
    using Struct = palpable_setup;
    layout.open_struct("palpable_setup", sizeof(Struct));
    ADD_MEMBER(size);
    layout.close_struct();
  }
  {
    using Struct = palpable_capsule;
    layout.open_struct("palpable_capsule", sizeof(Struct));
    ADD_MEMBER(a), ADD_MEMBER(b), ADD_MEMBER(radius_a), ADD_MEMBER(radius_b);
    layout.close_struct();
  }
  {
    using Struct = palpable_thing;
    layout.open_struct("palpable_thing", sizeof(Struct));
    ADD_MEMBER(size), ADD_MEMBER(id), ADD_MEMBER(capsules), ADD_MEMBER(count);
    ADD_MEMBER(friction);
    layout.close_struct();
  }
}

void add_results(LayoutText& layout) {
  {
    using Struct = palpable_frame;
    layout.open_struct("palpable_frame", sizeof(Struct));
    ADD_MEMBER(size), ADD_MEMBER(time), ADD_MEMBER(body_count), ADD_MEMBER(touch_count);
    ADD_MEMBER(left_to_go), ADD_MEMBER(inside), ADD_MEMBER(answer), ADD_MEMBER(passed_through);
    layout.close_struct();
  }
  {
    using Struct = palpable_touch;
    layout.open_struct("palpable_touch", sizeof(Struct));
    ADD_MEMBER(size), ADD_MEMBER(body), ADD_MEMBER(by), ADD_MEMBER(point), ADD_MEMBER(normal);
    ADD_MEMBER(force), ADD_MEMBER(depth), ADD_MEMBER(area), ADD_MEMBER(thing);
    layout.close_struct();
  }
  {
    using Struct = palpable_skin;
    layout.open_struct("palpable_skin", sizeof(Struct));
    ADD_MEMBER(size), ADD_MEMBER(vertex_count), ADD_MEMBER(triangle_count), ADD_MEMBER(vertices);
    ADD_MEMBER(normals), ADD_MEMBER(von_mises), ADD_MEMBER(triangles), ADD_MEMBER(world_from_body);
    ADD_MEMBER(stated_displacement_error), ADD_MEMBER(stated_stress_error);
    ADD_MEMBER(contact_pressure);
    layout.close_struct();
  }
}

std::size_t joints_of(palpable::HandLayout layout) {
  return static_cast<std::size_t>(palpable::joint_count(layout));
}

std::string layout_text() {
  LayoutText layout;
  layout.begin("{\"structs\":{");
  add_inputs(layout);
  add_results(layout);
  layout.begin("},\"constants\":{");
  ADD_CONSTANT(PALPABLE_NOT_JUDGED), ADD_CONSTANT(PALPABLE_REACHED);
  ADD_CONSTANT(PALPABLE_LATER), ADD_CONSTANT(PALPABLE_NOT_REACHED);
  ADD_CONSTANT(PALPABLE_OPENXR_HAND), ADD_CONSTANT(PALPABLE_WEBXR_HAND);
  ADD_CONSTANT(PALPABLE_MEDIAPIPE_HAND), ADD_CONSTANT(PALPABLE_LEFT);
  ADD_CONSTANT(PALPABLE_RIGHT), ADD_CONSTANT(PALPABLE_HAND_CAPSULES);
  layout.begin("},\"joints\":{");
  layout.add("PALPABLE_OPENXR_HAND", joints_of(palpable::HandLayout::kOpenXr));
  layout.add("PALPABLE_WEBXR_HAND", joints_of(palpable::HandLayout::kWebXr));
  layout.add("PALPABLE_MEDIAPIPE_HAND", joints_of(palpable::HandLayout::kMediaPipe));
  layout.begin("}}");
  return layout.take();
}

#undef ADD_MEMBER
#undef ADD_CONSTANT

}  // namespace

std::unique_ptr<palpable::SessionCamera> palpable::camera_of(const palpable_setup&) {
  throw Failure(PALPABLE_NOT_POSSIBLE, "a page's core has no camera: capsules press");
}

palpable_status palpable_read_body(const void* bytes, size_t count, double scale,
                                   palpable_body** body) {
  return palpable::guarded([&] {
    palpable::require(body != nullptr, "body is null");
    *body = nullptr;
    palpable::require(bytes != nullptr, "bytes is null");
    palpable::require_scale(scale);
    auto read = palpable::read_web_file({static_cast<const std::byte*>(bytes), count});
    if (!read.ok()) throw Failure(PALPABLE_WRONG_FILE, read.problem().message);
    *body = palpable::handle_of(std::move(read).value(), scale).release();
  });
}

const char* palpable_layout(void) {
  static const std::string text = layout_text();
  return text.c_str();
}
