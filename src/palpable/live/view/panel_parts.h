/// @file
/// Parts of the panels of both windows. Call them between ImGui's NewFrame and Render.
#pragma once

#include <array>
#include <cstddef>
#include <imgui.h>

namespace palpable {

/// Begins a panel at a fixed position. It is as high as its content, but no higher than the window.
/// ImGui::End() ends it. @param at  px, its upper left corner
void begin_panel(const char* name, ImVec2 at);

/// The width of all panels of begin_panel(), px.
[[nodiscard]] float panel_width();

/// A button of such a width that `count` of them fill one row. @return whether it was clicked
[[nodiscard]] bool button_in_row(const char* label, int count);

/// Radio buttons for the values of an enumeration or a bool.
/// @param of     the label above them
/// @param value  set to the user's choice
/// @return whether the user has clicked one
template <class Value, std::size_t N>
bool choice(const char* of, const std::array<const char*, N>& names, Value& value) {
  bool chosen = false;
  ImGui::PushID(of);
  ImGui::TextDisabled("%s", of);
  for (std::size_t i = 0; i < N; ++i) {
    // A new row where this one is full.
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
