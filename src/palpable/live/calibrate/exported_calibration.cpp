#include "palpable/live/calibrate/exported_calibration.h"

#include "palpable/common/base/output_file.h"
#include "palpable/live/calibrate/opencv_stereo_files.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/calibrate/ros_camera_info.h"

namespace palpable {

void export_calibration(const std::filesystem::path& folder, const StereoRig& rig) {
  make_folder(folder);
  const OpencvTexts opencv = opencv_texts(rig);
  write_whole_file(folder / "intrinsics.yml", opencv.intrinsics);
  write_whole_file(folder / "extrinsics.yml", opencv.extrinsics);
  const RectifiedGeometry geometry = rectified_geometry(rig);
  const PinholeCamera& c = geometry.stereo.camera;
  RosCamera left{rig.left, geometry.rectified_from_left.linear(), {}};
  left.projection << c.fx_px, 0, c.cx_px, 0, 0, c.fy_px, c.cy_px, 0, 0, 0, 1, 0;
  RosCamera right{rig.right, geometry.rectified_from_right.linear(), left.projection};
  right.projection(0, 3) = -c.fx_px * geometry.stereo.baseline;
  write_whole_file(folder / "left.yaml", ros_camera_text(left, "left"));
  write_whole_file(folder / "right.yaml", ros_camera_text(right, "right"));
}

}  // namespace palpable
