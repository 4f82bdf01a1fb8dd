#include "palpable/live/calibrate/factory_calibration.h"

#include "palpable/live/calibrate/rectification.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <clocale>
#include <cmath>
#include <string>

namespace palpable {
namespace {

using test::replaced;
using test::ScratchFolder;
using test::write_bytes;

std::string eye(const std::string& name, double scale) {
  const auto number = [&](double value) { return std::to_string(scale * value); };
  return "[" + name + "]\r\nfx=" + number(700) + "\r\nfy = " + number(701) + "\ncx=" + number(640) +
         "\ncy=" + number(360) + "\nk1=-0.17\nk2=0.027\np1=-3.1e-05\np2=0.0001\nk3=0\n\n";
}

const std::string kConf =
    eye("LEFT_CAM_FHD", 1.5) + eye("RIGHT_CAM_FHD", 1.5) + eye("LEFT_CAM_HD", 1) +
    eye("RIGHT_CAM_HD", 0.999) +
    "[STEREO]\nBaseline=63.5\nTY=0.5\nTZ=-0.25\nCV_FHD=0.02\nRX_FHD=0\nRZ_FHD=0\n"
    "CV_HD=0.02\nRX_HD=0.003\nRZ_HD=-0.001\n";

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("a factory file gives the rig of the size that is asked for", "[calibrate]") {
  const ScratchFolder folder("factory");
  const auto path = folder / "SN1.conf";
  write_bytes(path, kConf);
  const StereoRig rig = value_or_throw(read_factory_calibration(path, 1280, 720)).rig;
  CHECK(rig.left ==
        DistortedCamera{{1280, 720, 700, 701, 640, 360}, {-0.17, 0.027, -3.1e-05, 0.0001, 0}});
  CHECK(rig.right.pinhole.fx_px == Approx(699.3));
  CHECK(rig.right_from_left.translation().isApprox(Eigen::Vector3d(-0.0635, -0.0005, 0.00025)));
  const Eigen::AngleAxisd turn(rig.right_from_left.linear());
  CHECK((turn.angle() * turn.axis()).isApprox(Eigen::Vector3d(0.003, 0.02, -0.001), 1e-9));
  CHECK(value_or_throw(read_factory_calibration(path, 1920, 1080)).rig.left.pinhole.fx_px == 1050);
  CHECK(value_or_throw(read_factory_calibration(path, 0, 0)).rig.left.pinhole.width == 1280);

  // The sign differs between the vendor's own files. Where it is that of x_right = R x_left + T,
  // nothing is turned.
  write_bytes(path, replaced(kConf, "=63.5", "=-63.5"));
  const auto translation = [&](int width, int height) -> Eigen::Vector3d {
    return value_or_throw(read_factory_calibration(path, width, height))
        .rig.right_from_left.translation();
  };
  CHECK(translation(1280, 720).isApprox(Eigen::Vector3d(-0.0635, 0.0005, -0.00025)));

  // TY and TZ of a size of its own come before those of all sizes.
  write_bytes(path, kConf + "TY_HD=0.75\n");
  CHECK(translation(1280, 720).isApprox(Eigen::Vector3d(-0.0635, -0.00075, 0.00025)));
  CHECK(translation(1920, 1080).isApprox(Eigen::Vector3d(-0.0635, -0.0005, 0.00025)));
}

// The vendor's convention, as other readers of these files implement it: cv::stereoRectify with R
// and T = (Baseline, TY, TZ), whose sign does not change the line along which it rectifies.
TEST_CASE("the eyes of a factory file are aligned along the line of Baseline, TY and TZ",
          "[calibrate]") {
  const ScratchFolder folder("factory_line");
  const auto path = folder / "SN1.conf";
  // TY and TZ are exaggerated, and all three differ.
  write_bytes(path, replaced(replaced(kConf, "TY=0.5", "TY=2"), "TZ=-0.25", "TZ=-1.5"));
  const StereoRig rig = value_or_throw(read_factory_calibration(path, 1280, 720)).rig;
  const RectifiedGeometry geometry = value_or_throw(rectify_rig(rig));
  const Eigen::Vector3d line = Eigen::Vector3d(63.5, 2, -1.5).normalized();
  const Eigen::Vector3d rectified = geometry.rectified_from_right.linear() * line;
  CHECK((rectified - Eigen::Vector3d::UnitX()).norm() <
        test::tolerance(1e-9, "rounding of two rotations"));
  // A point at 0.5 m, at 60 px of disparity, lies in one row. If only Baseline were turned, the
  // rows would differ by 4 px there.
  const Eigen::Vector3d x_in_right(0.05, -0.08, 0.5);
  const Eigen::Matrix3d left_from_right = rig.right_from_left.linear().transpose();
  const Eigen::Vector3d x_in_left =
      left_from_right * (x_in_right + 0.0635 / 63.5 * Eigen::Vector3d(63.5, 2, -1.5));
  const PinholeCamera& camera = geometry.stereo.camera;
  const double row_left = camera.project(geometry.rectified_from_left * x_in_left).y();
  const double row_right = camera.project(geometry.rectified_from_right.linear() * x_in_right).y();
  CHECK(std::abs(row_left - row_right) < test::tolerance(1e-6, "rounding, px"));
}

TEST_CASE("a factory file is read the same under a locale with decimal commas", "[calibrate]") {
  const ScratchFolder folder("factory_locale");
  write_bytes(folder / "SN1.conf", kConf);
  const std::string before = std::setlocale(LC_ALL, nullptr);
  // If none is installed, the file is read under the default locale.
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  const auto calibration = read_factory_calibration(folder / "SN1.conf", 1280, 720);
  std::setlocale(LC_ALL, before.c_str());
  CHECK(value_or_throw(calibration).rig.left.distortion[0] == -0.17);
}

TEST_CASE("variants of keys, old sections and decimal commas give the same rig", "[calibrate]") {
  const ScratchFolder folder("factory_variants");
  const auto path = folder / "SN1.conf";
  const auto rig_in = [&](const std::string& text) {
    write_bytes(path, text);
    return value_or_throw(read_factory_calibration(path, 1280, 720)).rig;
  };
  const StereoRig rig = rig_in(kConf);
  std::string commas = kConf;
  for (char& c : commas) c = c == '.' ? ',' : c;
  std::string old = test::replaced_everywhere(kConf, "_CAM_", "_CAM_RESOLUTION_");
  for (const char* key : {"CV_", "RX_", "RZ_"}) {
    old = test::replaced_everywhere(old, key, std::string(key) + "RESOLUTION_");
  }
  const std::string own =
      replaced(replaced(kConf, "TY=0.5", "TY_HD=0.5"), "TZ=-0.25", "TZ_HD=-0.25");
  for (const std::string& text :
       {commas, old, own, replaced(kConf, "Baseline", "BaseLine"),
        replaced(kConf, "Baseline", "BASELINE_HD"), replaced(kConf, "fx=", "Fx=")}) {
    INFO(text);
    const StereoRig variant = rig_in(text);
    CHECK(variant.left == rig.left);
    CHECK(variant.right == rig.right);
    CHECK(variant.right_from_left.matrix() == rig.right_from_left.matrix());
  }
  // A ZED X.
  const StereoRig x = value_or_throw([&] {
                        write_bytes(path, test::replaced_everywhere(kConf, "_HD", "_SVGA"));
                        return read_factory_calibration(path, 960, 600);
                      }())
                          .rig;
  CHECK(x.left.pinhole.width == 960);
}

TEST_CASE("a factory file that cannot be used says why", "[calibrate][refusal]") {
  const ScratchFolder folder("factory_refusals");
  const auto path = folder / "SN1.conf";
  const auto refusal = [&](const std::string& bytes, int width = 1280, int height = 720) {
    write_bytes(path, bytes);
    const auto result = read_factory_calibration(path, width, height);
    REQUIRE_FALSE(result.ok());
    CHECK(contains(result.problem().message, path.string()));
    CHECK(result.problem().message.find('\n') == std::string::npos);
    return result.problem().message;
  };
  CHECK_FALSE(read_factory_calibration(folder / "none.conf", 0, 0).ok());
  CHECK(contains(refusal(""), "no factory calibration"));
  CHECK(contains(refusal(std::string(1000, '\0')), "a zero byte"));
  CHECK(contains(refusal(kConf, 672, 376), "1280 x 720, 1920 x 1080 px, not for 672 x 376"));
  std::string broken = kConf;
  broken.replace(broken.find("RX_HD=0.003"), 11, "RX_HD=zero!");
  CHECK(contains(refusal(broken), "no number STEREO.RX_HD"));
  broken = kConf;
  broken.replace(broken.find("=63.5"), 5, "=63500");
  CHECK(contains(refusal(broken), "63.5 m apart"));
}

}  // namespace
}  // namespace palpable
