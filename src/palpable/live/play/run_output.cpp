#include "palpable/live/play/run_output.h"

#include <fmt/core.h>

namespace palpable {

RunFolder::RunFolder(const std::filesystem::path& folder, bool overwrite,
                     const std::vector<std::filesystem::path>& inputs)
    : folder_(folder) {
  if (folder.empty()) return;
  lock_.emplace(folder);
  replaces_ = holds_earlier_run(folder, overwrite, inputs);
}

std::unique_ptr<LiveOutput> RunFolder::begin(const LiveOutputSettings& settings) const {
  if (!lock_) return nullptr;
  if (replaces_) remove_earlier_run(folder_);
  return std::make_unique<LiveOutput>(settings);
}

void RunFolder::write(const LiveSummary& summary) const {
  write_live_summary(folder_ / "live.json", summary);
}

std::string RunFolder::text_of(const LiveOutput& output, std::string_view remedy) const {
  std::string text;
  if (output.left_out() > 0) {
    text = fmt::format(
        "{} of these frames are in the texts only, {} not even there: the disk was behind{}{}\n",
        output.left_out(), output.lines_left_out(), remedy.empty() ? "" : "; ", remedy);
  }
  if (output.files().film) text += fmt::format("{}\n", (folder_ / "touch.mp4").string());
  for (const std::string& name : output.figures()) {
    text += fmt::format("{}\n", (folder_ / name).string());
  }
  return text;
}

}  // namespace palpable
