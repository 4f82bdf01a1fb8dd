#include "palpable/live/view/live_panel.h"

#include "palpable/live/view/panel_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <imgui.h>
#include <string_view>

namespace palpable {
namespace {

constexpr std::chrono::duration<double> kReadable{0.5};  // s for which a number stays unchanged

// Writes a formatted line of text without allocating memory.
template <class... Values>
void text(fmt::format_string<Values...> format, Values&&... values) {
  std::array<char, 160> line{};
  const auto end =
      fmt::format_to_n(line.data(), line.size(), format, std::forward<Values>(values)...);
  ImGui::TextUnformatted(line.data(), end.out);
}

}  // namespace

void LivePanel::add(const Scene& scene) {
  touches_ = scene.touches;
  sums_.add(scene.times);
  ++frames_;
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> taken = now - since_;
  if (taken < kReadable) return;
  rate_ = frames_ / taken.count();
  means_.clear();
  for (const StageTime& stage : sums_.stages()) means_.add(stage.name, stage.ms / frames_);
  sums_.clear();
  frames_ = 0;
  since_ = now;
}

void LivePanel::lay_out(LiveControls& controls) {
  if (!controls.panel_shown) return;
  begin_panel("live", {0, 0});
  lay_out_rate();
  ImGui::Separator();
  lay_out_buttons(controls);
  ImGui::Separator();
  lay_out_look(controls);
  if (!controls.parameters.empty()) {
    ImGui::Separator();
    lay_out_parameters(controls);
  }
  ImGui::Separator();
  lay_out_touches(controls);
  ImGui::End();
  if (!controls.help_shown) return;
  begin_panel("keys", {panel_width(), 0});
  for (const LiveKey& key : LiveControls::keys()) {
    ImGui::TextUnformatted(key.key);
    ImGui::SameLine(4 * ImGui::GetFontSize());
    ImGui::TextUnformatted(key.meaning);
  }
  ImGui::End();
}

void LivePanel::lay_out_rate() {
  if (rate_ == 0) {
    text("- frames/s");
  } else {
    text("{:.1f} frames/s", rate_);
  }
  if (!ImGui::CollapsingHeader("Times")) return;
  for (const StageTime& stage : means_.stages()) {
    text("{}", stage.name);
    ImGui::SameLine(8 * ImGui::GetFontSize());
    text("{:6.1f} ms", stage.ms);
  }
}

void LivePanel::lay_out_buttons(LiveControls& controls) const {
  if (button_in_row(controls.paused ? "Go on###pause" : "Pause###pause", 2)) {
    controls.paused = !controls.paused;
  }
  ImGui::SameLine();
  if (button_in_row("Step", 2)) controls.step();
  if (button_in_row("Picture", 2)) controls.picture_wanted = true;
  ImGui::SameLine();
  if (button_in_row("Reset view", 2)) controls.reset();
  if (controls.run_may_change) lay_out_run(controls);
  ImGui::Checkbox("Keys (H)", &controls.help_shown);
  if (!note.empty()) ImGui::TextWrapped("%s", note.c_str());
}

void LivePanel::lay_out_run(LiveControls& controls) const {
  if (button_in_row(controls.placing ? "Cancel###place" : "Place body###place", 2)) {
    controls.begin_placing();
  }
  ImGui::SameLine();
  if (button_in_row("Begin anew", 2)) controls.begin_anew();
  if (button_in_row(recording.empty() ? "Record###record" : "Stop recording###record", 1)) {
    controls.wishes.recording = true;
  }
  if (controls.placing) ImGui::TextWrapped("click where it is to stand; Esc: not");
  if (!recording.empty()) ImGui::TextWrapped("recording %s", recording.c_str());
}

void LivePanel::lay_out_parameters(LiveControls& controls) const {
  int row = 0;
  for (LiveParameter& parameter : controls.parameters) {
    ImGui::PushID(row++);
    const std::string& body = names_[static_cast<std::size_t>(parameter.body)];
    text("{}{}{}", parameter.name, names_.size() > 1 ? " of " : "", names_.size() > 1 ? body : "");
    ImGui::SetNextItemWidth(-1);
    ImGui::SliderScalar("##value", ImGuiDataType_Double, &parameter.value, &parameter.low,
                        &parameter.high, "%.3g", ImGuiSliderFlags_AlwaysClamp);
    // Applying a value takes long, so it is done once the mouse button is released.
    controls.wishes.parameters |= ImGui::IsItemDeactivatedAfterEdit();
    ImGui::PopID();
  }
}

void LivePanel::lay_out_look(LiveControls& controls) const {
  choice("View", kViewNames, controls.view);
  choice("Painted", kFieldNames, controls.show.field);
  if (controls.show.field == SceneShow::Field::kComponent) {
    choice("Component", kComponentNames, controls.show.component);
  }
  choice("Occlusion", kOcclusionNames, controls.show.occlusion);
  ImGui::TextDisabled("Also shown");
  ImGui::Checkbox("contact points", &controls.show.contacts);
  ImGui::Checkbox("arrows of forces", &controls.show.forces);
  ImGui::Checkbox("legend", &controls.show.legend);
}

void LivePanel::lay_out_touches(LiveControls& controls) const {
  const bool several = names_.size() > 1;
  ImGui::TextDisabled("Touches");
  if (several) {
    if (ImGui::RadioButton("of all bodies", controls.body < 0)) controls.body = -1;
    for (int k = 0; k < static_cast<int>(names_.size()); ++k) {
      ImGui::PushID(k);
      if (ImGui::RadioButton(names_[static_cast<std::size_t>(k)].c_str(), controls.body == k)) {
        controls.body = k;
      }
      ImGui::PopID();
    }
  }
  int listed = 0;
  for (const Touch& touch : touches_) {
    if (controls.body >= 0 && touch.body != controls.body) continue;
    ++listed;
    text("{:5.1f} mm {:6.2f} N  {}", 1e3 * touch.press_depth, touch.force,
         several && controls.body < 0
             ? std::string_view(names_[static_cast<std::size_t>(touch.body)])
             : std::string_view());
  }
  if (listed == 0) text("not touched");
}

}  // namespace palpable
