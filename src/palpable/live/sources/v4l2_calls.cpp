#include "palpable/live/sources/v4l2_calls.h"

#include <fmt/core.h>

#include <cerrno>

namespace palpable {

std::string reason(VideoSystem& system, const std::string& path, int error) {
  switch (error) {
    case EBUSY: {
      const std::string users = system.users(path);
      return users.empty()
                 ? fmt::format("another program is using it, which sudo fuser -v {} names", path)
                 : "another program is using it: close " + users;
    }
    case EIO:
    case EPIPE:
    case EPROTO:
    case ETIMEDOUT:
      return fmt::format(
          "the camera does not answer ({}): unplug it, and plug it into another port, without a "
          "hub",
          std::strerror(error));
    default:
      return std::strerror(error);
  }
}

Problem cannot_open(VideoSystem& system, const std::string& path, int error) {
  if (error == EACCES || error == EPERM) {
    return Problem{
        fmt::format("{} may not be opened: cameras belong to the group video; run "
                    "'sudo usermod -aG video $USER' and log in again",
                    path)};
  }
  if (error == ENOENT || error == ENODEV || error == ENXIO) {
    return Problem{
        fmt::format("there is no camera {}: palpable cameras lists those that are there", path)};
  }
  return Problem{fmt::format("{} cannot be opened: {}", path, reason(system, path, error))};
}

bool has_control(VideoSystem& system, int device, std::uint32_t id) {
  auto query = zeroed<v4l2_queryctrl>();
  query.id = id;
  return system.control(device, VIDIOC_QUERYCTRL, &query) == 0 &&
         (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
}

int set_control(VideoSystem& system, int device, std::uint32_t id, int value) {
  auto control = zeroed<v4l2_control>();
  control.id = id;
  control.value = value;
  return system.control(device, VIDIOC_S_CTRL, &control);
}

std::optional<int> value_of_control(VideoSystem& system, int device, std::uint32_t id) {
  auto control = zeroed<v4l2_control>();
  control.id = id;
  if (!has_control(system, device, id)) return std::nullopt;
  if (system.control(device, VIDIOC_G_CTRL, &control) != 0) return std::nullopt;
  return control.value;
}

}  // namespace palpable
