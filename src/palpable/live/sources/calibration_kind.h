/// @file
/// What a calibration file is. This is decided by its content, here alone, for every file that a
/// user names or that lies in a folder.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/calibrate/keyed_text.h"

#include <filesystem>
#include <string>

namespace palpable {

enum class CalibrationKind {
  kRig,               ///< OpenCV YAML with K1 and image_width: palpable calibrate's
  kRectified,         ///< fx fy cx cy width height baseline_m
  kFactory,           ///< a ZED's sections (factory_calibration.h)
  kIntrinsics,        ///< numbers: fx fy cx cy
  kOpencvRig,         ///< both lenses and R T under other names or without a size
  kOpencvLenses,      ///< intrinsics.yml of OpenCV's sample stereo_calib (opencv_stereo_files.h)
  kOpencvPose,        ///< its extrinsics.yml
  kRosCamera,         ///< one eye (ros_camera_info.h)
  kCamchain,          ///< Kalibr's (kalibr_camchain.h)
  kRealsenseJson,     ///< realsense_file.h
  kRealsenseListing,  ///< realsense_file.h
  kCameraJson,        ///< one camera (realsense_file.h)
  kNotRead            ///< `not_read` says of which program it is, or that it is of none
};

/// A file whose kind is known.
struct CalibrationText {
  std::filesystem::path path;
  CalibrationKind kind = CalibrationKind::kNotRead;
  std::string text;  ///< with decimal points (keyed_text.h), but for kIntrinsics
  KeyedText keys;
  /// kNotRead: one line without the file's name: whose it is or what was looked for, and what to
  /// do.
  std::string not_read;
};

/// Reads a file and decides what it is. The problem names the file: it cannot be read, is no text,
/// or is nested too deep.
[[nodiscard]] Result<CalibrationText> open_calibration(const std::filesystem::path& path);

/// Whether a file of this kind is half of a calibration: the other one is beside it.
[[nodiscard]] bool is_half(CalibrationKind kind);

}  // namespace palpable
