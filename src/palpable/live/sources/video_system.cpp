#include "palpable/live/sources/video_system.h"

#include "palpable/live/sources/natural_order.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <system_error>
#include <unistd.h>

namespace palpable {
namespace {

class LinuxVideo final : public VideoSystem {
 public:
  double now() override { return system_clock().now(); }
  void sleep(double seconds) override { system_clock().sleep(seconds); }

  std::vector<std::string> devices() override {
    std::vector<std::string> found;
    std::error_code error;
    for (std::filesystem::directory_iterator it("/dev", error), end; !error && it != end;
         it.increment(error)) {
      const std::string name = it->path().filename().string();
      const bool digits = name.size() > 5 && name.find_first_not_of("0123456789", 5) == name.npos;
      if (name.starts_with("video") && digits) found.push_back(it->path().string());
    }
    std::sort(found.begin(), found.end(), natural_less);
    return found;
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
