#include "palpable/live/render/panel.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/render/font_table.h"
#include "palpable/live/render/gl_objects.h"
#include "palpable/live/render/shader_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <imgui.h>
#include <span>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr int kRowsPerEm = 48;  // rows of the window per em: letters of 15 px for 720 rows
constexpr float kOpaque = 1.0f;

// The built-in size that is nearest to `em` px.
const detail::FontSize& font_size(const detail::FontTable& table, int em) {
  return *std::min_element(
      table.sizes.begin(), table.sizes.end(),
      [em](const auto& a, const auto& b) { return std::abs(a.size - em) < std::abs(b.size - em); });
}

// Replaces ImGui's font by the built-in one (render/text.h), which is used in pictures as well.
void set_letters(ImFontAtlas& atlas, int em) {
  const detail::FontTable table = detail::font_table();
  const detail::FontSize& size = font_size(table, em);
  atlas.Clear();
  ImFontConfig config;
  config.SizePixels = std::round(size.ascent + size.descent);  // of a line
  // Loads only the one letter of ImGui's font that ImGui requires, to save memory and time.
  static constexpr ImWchar kFewest[] = {'?', '?', 0};
  config.GlyphRanges = kFewest;
  ImFont* font = atlas.AddFontDefault(&config);
  const auto letters = table.glyphs.subspan(static_cast<std::size_t>(size.first),
                                            static_cast<std::size_t>(size.count));
  std::vector<int> places;
  for (const detail::Glyph& glyph : letters) {
    const auto left = static_cast<float>(glyph.left);
    const float top = std::round(size.ascent) + static_cast<float>(glyph.top);
    // One px more than the ink, to the right and below, which separates letters in the texture.
    places.push_back(atlas.AddCustomRectFontGlyph(font, static_cast<ImWchar>(glyph.letter),
                                                  glyph.width + 1, glyph.height + 1,
                                                  std::round(glyph.advance), {left, top}));
  }
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&pixels, &width, &height);  // builds the texture
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const detail::Glyph& glyph = letters[i];
    const ImFontAtlasCustomRect& at = *atlas.GetCustomRectByIndex(places[i]);
    for (int y = 0; y < glyph.height; ++y) {
      std::memcpy(pixels + (at.Y + y) * width + at.X,
                  &table.ink[static_cast<std::size_t>(glyph.ink + y * glyph.width)],
                  static_cast<std::size_t>(glyph.width));
    }
  }
}

// Sets colours and sizes. ImGui's default sizes (for letters of 13 px) are scaled by em / 15.
void set_style(int em) {
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.ScaleAllSizes(static_cast<float>(em) / 15.0f);
  style.WindowRounding = 0;
  style.WindowBorderSize = 0;
  style.Colors[ImGuiCol_WindowBg] = {0.07f, 0.09f, 0.11f, kOpaque};
  ImGui::GetStyle() = style;
}

std::size_t byte_size(const ImVector<ImDrawVert>& v) {
  return static_cast<std::size_t>(v.Size) * sizeof(ImDrawVert);
}
std::size_t byte_size(const ImVector<ImDrawIdx>& v) {
  return static_cast<std::size_t>(v.Size) * sizeof(ImDrawIdx);
}

// The rectangle of the window that a draw list may change, px from the upper left.
ImVec4 covered_by(const ImDrawList& list) {
  ImVec4 all{1e9f, 1e9f, -1e9f, -1e9f};
  for (const ImDrawCmd& command : list.CmdBuffer) {
    ImVec4 box{1e9f, 1e9f, -1e9f, -1e9f};
    for (unsigned i = 0; i < command.ElemCount; ++i) {
      const ImDrawIdx index = list.IdxBuffer[static_cast<int>(command.IdxOffset + i)];
      const ImVec2 at = list.VtxBuffer[static_cast<int>(command.VtxOffset + index)].pos;
      box = {std::min(box.x, at.x), std::min(box.y, at.y), std::max(box.z, at.x),
             std::max(box.w, at.y)};
    }
    const ImVec4& clip = command.ClipRect;
    all = {std::min(all.x, std::max(box.x, clip.x)), std::min(all.y, std::max(box.y, clip.y)),
           std::max(all.z, std::min(box.z, clip.z)), std::max(all.w, std::min(box.w, clip.w))};
  }
  return all;
}

}  // namespace

int panel_letters(int window_width, int window_height) {
  // In a window that is narrower than 16:9 the picture has fewer rows than the window.
  const int rows = std::min(window_height, window_width * 9 / 16);
  return std::clamp(rows / kRowsPerEm, 10, 42);
}

struct Panel::State {
  State(GlProgram the_program, Layout the_layout)
      : program(std::move(the_program)),
        layout(std::move(the_layout)),
        imgui(ImGui::CreateContext()) {
    ImGui::SetCurrentContext(imgui);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // no files are written
    io.LogFilename = nullptr;
    io.BackendFlags = ImGuiBackendFlags_RendererHasVtxOffset;
    io.DeltaTime = 1.0f / 60.0f;  // constant, since panels have no animations
    io.ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
    constexpr int kVertex = sizeof(ImDrawVert);
    static_assert(sizeof(ImDrawVert) == 20 && sizeof(ImDrawIdx) == 2);
    inputs.floats(0, vertices, 2, kVertex, 0);
    inputs.floats(1, vertices, 2, kVertex, 8);
    inputs.bytes(2, vertices, kVertex, 16);
    inputs.indices(indices);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { ImGui::DestroyContext(imgui); }

  void lay_out() {
    ImGui::SetCurrentContext(imgui);
    ImGui::NewFrame();
    layout();
    ImGui::Render();
  }
  // Copies the vertices and indices of all of ImGui's draw lists into new_vertices and new_indices.
  void gather();
  void draw_anew(int width, int height);

  GlProgram program;
  Layout layout;
  ImGuiContext* imgui;
  int em = 0;
  std::array<bool, IM_ARRAYSIZE(ImGuiIO::MouseDown)> pressed_here{};  // by button
  GlTexture ink;
  // The panel as drawn last, of the window's size: without a GPU, copying is several times faster
  // than drawing.
  GlTexture drawn;
  GlFramebuffer framebuffer;
  // The parts of `drawn` that hold panels; y counts up from the lower border, as in OpenGL.
  std::vector<PixelBox> covered;
  GlBuffer vertices, indices;
  GlVertexArray inputs;
  // The content laid out last, and that in the buffers.
  std::vector<std::byte> new_vertices, new_indices, old_vertices, old_indices;
};

Panel::Panel(std::unique_ptr<State> state) : state_(std::move(state)) {}
Panel::Panel(Panel&&) noexcept = default;
Panel& Panel::operator=(Panel&&) noexcept = default;
Panel::~Panel() = default;

Result<Panel> Panel::make(Layout layout) {
  PALPABLE_EXPECT(layout != nullptr, "a panel has a layout function");
  Result<GlProgram> program = GlProgram::make(render_shader_files(), "panel.vert", "panel.frag");
  if (!program.ok()) return program.problem();
  return Panel(std::make_unique<State>(std::move(program.value()), std::move(layout)));
}

void Panel::resize(int width, int height) {
  if (width <= 0 || height <= 0) return;  // minimised
  State& s = *state_;
  ImGui::SetCurrentContext(s.imgui);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  if (const int em = panel_letters(width, height); em != s.em) {
    s.em = em;
    set_letters(*io.Fonts, em);
    set_style(em);
    unsigned char* pixels = nullptr;
    int ink_width = 0, ink_height = 0;
    io.Fonts->GetTexDataAsAlpha8(&pixels, &ink_width, &ink_height);
    s.ink = GlTexture(GL_R8, ink_width, ink_height, GL_LINEAR);
    s.ink.upload(0, 0, ink_width, ink_height, GL_RED, GL_UNSIGNED_BYTE, pixels);
  }
  // ImGui needs two passes until a window of a new size is shown correctly.
  s.lay_out();
  s.lay_out();
}

bool Panel::handle(const WindowEvent& event) {
  State& s = *state_;
  ImGui::SetCurrentContext(s.imgui);
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = {static_cast<float>(event.window_x), static_cast<float>(event.window_y)};
  using Kind = WindowEvent::Kind;
  switch (event.kind) {
    case Kind::kPress:
    case Kind::kRelease:
      if (event.button < 0 || event.button >= IM_ARRAYSIZE(io.MouseDown)) return false;
      io.MouseDown[event.button] = event.kind == Kind::kPress;
      break;
    case Kind::kWheel:
      io.MouseWheel = static_cast<float>(event.wheel);
      break;
    case Kind::kKey:  // keys are the program's
      return false;
    case Kind::kMove:
      break;
  }
  // The first pass takes in the mouse's state, the second shows its effect.
  s.lay_out();
  bool its_own = io.WantCaptureMouse;
  s.lay_out();
  // A release belongs to the panel if the press did, wherever the mouse is now.
  if (event.kind == Kind::kPress) s.pressed_here[event.button] = its_own;
  if (event.kind == Kind::kRelease) its_own = s.pressed_here[event.button];
  return its_own;
}

void Panel::lay_out() { state_->lay_out(); }

void Panel::State::gather() {
  ImGui::SetCurrentContext(imgui);
  const ImDrawData* data = ImGui::GetDrawData();
  new_vertices.clear();
  new_indices.clear();
  if (data == nullptr) return;
  for (const ImDrawList* list :
       std::span(data->CmdLists, static_cast<std::size_t>(data->CmdListsCount))) {
    const auto* v = reinterpret_cast<const std::byte*>(list->VtxBuffer.Data);
    const auto* i = reinterpret_cast<const std::byte*>(list->IdxBuffer.Data);
    new_vertices.insert(new_vertices.end(), v, v + byte_size(list->VtxBuffer));
    new_indices.insert(new_indices.end(), i, i + byte_size(list->IdxBuffer));
  }
}

bool Panel::changed() const {
  State& s = *state_;
  s.gather();
  return s.new_vertices != s.old_vertices || s.new_indices != s.old_indices;
}

void Panel::draw(int width, int height) {
  State& s = *state_;
  const bool resized = s.drawn.width() != width || s.drawn.height() != height;
  if (resized) {
    s.drawn = GlTexture(GL_RGBA8, width, height);
    s.framebuffer = GlFramebuffer(std::array<const GlTexture*, 1>{&s.drawn}, nullptr);
  }
  if (changed() || resized) {
    s.vertices.stream(std::span<const std::byte>(s.new_vertices));
    s.indices.stream(std::span<const std::byte>(s.new_indices));
    std::swap(s.new_vertices, s.old_vertices);
    std::swap(s.new_indices, s.old_indices);
    s.draw_anew(width, height);
  }
  // Panels are opaque, so they can be copied without blending.
  for (const PixelBox& at : s.covered) {
    glBlitNamedFramebuffer(s.framebuffer.get(), 0, at.x, at.y, at.right(), at.bottom(), at.x, at.y,
                           at.right(), at.bottom(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
}

void Panel::State::draw_anew(int width, int height) {
  covered.clear();
  const ImDrawData* data = ImGui::GetDrawData();
  if (data == nullptr || data->TotalIdxCount == 0) return;
  const float to_px = static_cast<float>(width) / data->DisplaySize.x;
  framebuffer.bind();
  glEnable(GL_SCISSOR_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  program.use();
  program.set("size", Eigen::Vector2f(data->DisplaySize.x, data->DisplaySize.y));
  ink.bind(0);
  inputs.bind();
  std::size_t first_index = 0;
  int first_vertex = 0;
  const auto box_of = [&](const ImVec4& at) {
    return PixelBox::between(
        static_cast<int>(at.x * to_px), height - static_cast<int>(at.w * to_px),
        static_cast<int>(at.z * to_px), height - static_cast<int>(at.y * to_px));
  };
  for (const ImDrawList* list :
       std::span(data->CmdLists, static_cast<std::size_t>(data->CmdListsCount))) {
    for (const ImDrawCmd& command : list->CmdBuffer) {
      const PixelBox clip = box_of(command.ClipRect);
      if (clip.empty()) continue;
      glScissor(clip.x, clip.y, clip.width, clip.height);
      glDrawElementsBaseVertex(
          GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), GL_UNSIGNED_SHORT,
          reinterpret_cast<const void*>((first_index + command.IdxOffset) * sizeof(ImDrawIdx)),
          first_vertex + static_cast<int>(command.VtxOffset));
    }
    first_index += static_cast<std::size_t>(list->IdxBuffer.Size);
    first_vertex += list->VtxBuffer.Size;
    if (list->IdxBuffer.Size > 0) covered.push_back(box_of(covered_by(*list)));
  }
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

}  // namespace palpable
