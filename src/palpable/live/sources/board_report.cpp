#include "palpable/live/sources/board_report.h"

#include <fmt/core.h>

#include <numbers>
#include <utility>

namespace palpable {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

}  // namespace

Json json_of(const BoardCalibration& found, const SeenBoards& seen) {
  const StereoRig& rig = found.calibration.rig;
  Json result;
  result["pairs"] = seen.pairs;
  result["boards"] = seen.views.size();
  for (const auto& [name, eye] : {std::pair{"left", &rig.left}, std::pair{"right", &rig.right}}) {
    result[name] = {{"fx_px", eye->pinhole.fx_px},
                    {"fy_px", eye->pinhole.fy_px},
                    {"cx_px", eye->pinhole.cx_px},
                    {"cy_px", eye->pinhole.cy_px},
                    {"distortion", eye->distortion}};
  }
  result["baseline_m"] = rig.right_from_left.translation().norm();
  result["reprojection_px"] = found.reprojection_px;
  result["row_error_px"] = found.row_error_px;
  result["focal_sigma"] = found.focal_sigma;
  result["weakness"] = found.weakness.empty() ? Json(nullptr) : Json(found.weakness);
  result["tilt_degrees"] = found.tilt * kDegrees;
  result["covered"] = found.covered;
  return result;
}

std::string text_of(const BoardCalibration& found, const SeenBoards& seen,
                    const BoardPattern& pattern) {
  std::string text;
  for (std::size_t i = 0; i < seen.views.size(); ++i) {
    text += fmt::format("pair {:>4}  reprojection {:.3f} px\n", seen.views[i].number,
                        found.reprojections_px[i]);
  }
  text += fmt::format("{} boards in {} pairs", seen.views.size(), seen.pairs);
  if (seen.alike > 0) text += fmt::format(" ({} more were where another had been)", seen.alike);
  text += fmt::format("; tilt {:.0f} degrees, {:.0f} % of the picture covered\n",
                      found.tilt * kDegrees, 100 * found.covered);
  const StereoRig& rig = found.calibration.rig;
  for (const auto& [name, eye] : {std::pair{"left", &rig.left}, std::pair{"right", &rig.right}}) {
    const PinholeCamera& c = eye->pinhole;
    text += fmt::format("{:<6} f {:.2f} {:.2f} px, centre {:.2f} {:.2f} px, k1 {:.4f} k2 {:.4f}\n",
                        name, c.fx_px, c.fy_px, c.cx_px, c.cy_px, eye->distortion[0],
                        eye->distortion[1]);
  }
  const double baseline = rig.right_from_left.translation().norm();
  text += fmt::format("baseline {:.2f} mm ({:.3f} squares); focal length known to {:.2f} %\n",
                      1e3 * baseline, baseline / pattern.square, 100 * found.focal_sigma);
  text += fmt::format("reprojection {:.3f} px rms, rows after rectification {:.3f} px rms\n",
                      found.reprojection_px, found.row_error_px);
  if (!found.weakness.empty()) text += fmt::format("accepted although {}\n", found.weakness);
  return text;
}

}  // namespace palpable
