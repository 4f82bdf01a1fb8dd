/// @file
/// What the panels of both windows are made of. To be called between ImGui's NewFrame and Render.
#pragma once

#include <array>
#include <cstddef>
#include <imgui.h>

namespace palpable {

/// Begins a panel that stands where it is told and is as high as what is on it, or as the window.
/// ImGui::End() ends it. @param at  px, its upper left corner
void begin_panel(const char* name, ImVec2 at);

/// Width of a panel that begin_panel() began, px.
[[nodiscard]] float panel_width();

/// A button as wide as `count` of them in one row are.
[[nodiscard]] bool button_in_row(const char* label, int count);

/// Which of its values an enumeration or a bool has, by their names.
/// @return whether the user has chosen another one
template <class Value, std::size_t N>
bool choice(const char* of, const std::array<const char*, N>& names, Value& value) {
  bool chosen = false;
  ImGui::PushID(of);
  ImGui::TextDisabled("%s", of);
  for (std::size_t i = 0; i < N; ++i) {
    // As many in a row as there is room for.
    const float width = ImGui::CalcTextSize(names[i]).x + 2 * ImGui::GetFrameHeight();
    if (i > 0) ImGui::SameLine();
    if (i > 0 && ImGui::GetContentRegionAvail().x < width) ImGui::NewLine();
    if (ImGui::RadioButton(names[i], static_cast<std::size_t>(value) == i)) {
      value = static_cast<Value>(i);
      chosen = true;
    }
  }
  ImGui::PopID();
  return chosen;
}

}  // namespace palpable
