#include "palpable/live/view/panel_parts.h"

namespace palpable {
namespace {

constexpr float kPanelWidth = 14;  // ratio to the font size

}  // namespace

float panel_width() { return kPanelWidth * ImGui::GetFontSize(); }

void begin_panel(const char* name, ImVec2 at) {
  constexpr int kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                         ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_NoNav | ImGuiWindowFlags_AlwaysAutoResize;
  const float width = panel_width();
  ImGui::SetNextWindowPos(at);
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, ImGui::GetIO().DisplaySize.y});
  ImGui::Begin(name, nullptr, kFixed);
}

bool button_in_row(const char* label, int count) {
  const float gaps = static_cast<float>(count - 1) * ImGui::GetStyle().ItemSpacing.x;
  const float all = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
  return ImGui::Button(label, {(all - gaps) / static_cast<float>(count), 0});
}

}  // namespace palpable
