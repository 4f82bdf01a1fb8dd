#include "palpable/live/sources/video_system.h"

#include "palpable/live/sources/natural_order.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <locale>
#include <poll.h>
#include <sstream>
#include <string>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <system_error>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// The file itself, where `path` is one of the names that udev gives: /dev/v4l/by-id/...
fs::path device_file(const std::string& path) {
  std::error_code error;
  fs::path file = fs::canonical(path, error);
  return error ? fs::path(path) : file;
}

// The first line of a file of a USB camera in sysfs: device/ is the camera's interface, and the
// folder above it is the camera.
std::string usb_line(const std::string& path, const char* file) {
  std::ifstream in("/sys/class/video4linux" / device_file(path).filename() / "device/.." / file);
  std::string line;
  std::getline(in, line);
  return line;
}

double usb_number(const std::string& path, const char* file) {
  std::istringstream in(usb_line(path, file));
  in.imbue(std::locale::classic());
  double number = 0;
  in >> number;
  return number;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
}

// Whether a process, a folder of /proc, has opened a file. Those of other users cannot be looked
// into.
bool has_opened(const fs::path& process, const fs::path& file) {
  std::error_code error;
  for (fs::directory_iterator it(process / "fd", error), end; !error && it != end;
       it.increment(error)) {
    std::error_code gone;
    if (fs::read_symlink(it->path(), gone) == file && !gone) return true;
  }
  return false;
}

class LinuxVideo final : public VideoSystem {
 public:
  double now() override { return system_clock().now(); }
  void sleep(double seconds) override { system_clock().sleep(seconds); }

  std::vector<std::string> devices() override {
    std::vector<std::string> found;
    std::error_code error;
    for (fs::directory_iterator it("/dev", error), end; !error && it != end; it.increment(error)) {
      const std::string name = it->path().filename().string();
      if (name.starts_with("video") && is_number(name.substr(5)))
        found.push_back(it->path().string());
    }
    std::sort(found.begin(), found.end(), natural_less);
    return found;
  }

  std::string product(const std::string& path) override { return usb_line(path, "product"); }

  UsbLink usb_link(const std::string& path) override {
    return {usb_number(path, "speed"), usb_number(path, "version")};
  }

  std::string users(const std::string& path) override {
    const fs::path file = device_file(path);
    const std::string own = std::to_string(::getpid());
    std::string text;
    std::error_code error;
    for (fs::directory_iterator it("/proc", error), end; !error && it != end; it.increment(error)) {
      const std::string number = it->path().filename().string();
      if (!is_number(number) || number == own || !has_opened(it->path(), file)) continue;
      std::string name;
      std::ifstream in(it->path() / "comm");
      std::getline(in, name);
      text += (text.empty() ? "" : ", ") + name + " (process " + number + ")";
    }
    return text;
  }

  int open(const std::string& path) override {
    const int device = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return device >= 0 ? device : -errno;
  }
  void close(int device) override { ::close(device); }

  int control(int device, unsigned long request, void* argument) override {
    int result = -1;
    do { result = ::ioctl(device, request, argument); } while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
  }

  void* map(int device, std::size_t length, std::uint32_t offset) override {
    void* memory = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, device, offset);
    return memory == MAP_FAILED ? nullptr : memory;
  }
  void unmap(void* memory, std::size_t length) override { ::munmap(memory, length); }

  int wait(int device, double seconds) override {
    pollfd entry{device, POLLIN, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(1e3 * seconds));
    if (ready < 0) return errno == EINTR ? 0 : -1;
    if (ready == 0) return 0;
    return (entry.revents & POLLIN) != 0 ? 1 : -1;
  }
};

}  // namespace

VideoSystem& linux_video() {
  static LinuxVideo video;
  return video;
}

}  // namespace palpable
