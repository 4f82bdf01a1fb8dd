#include "palpable/common/base/this_machine.h"

#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sys/resource.h>
#include <system_error>
#include <thread>

namespace palpable {

double peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

std::optional<double> available_memory() {
  std::ifstream info("/proc/meminfo");
  std::string key;
  for (double kibibytes = 0; info >> key >> kibibytes; info.ignore(64, '\n')) {
    if (key == "MemAvailable:") return 1024 * kibibytes;
  }
  return std::nullopt;
}

std::optional<std::filesystem::path> user_folder(const char* variable, const char* below_home) {
  const char* folder = std::getenv(variable);
  if (folder != nullptr && *folder != '\0') return folder;
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return std::filesystem::path(home) / below_home;
  return std::nullopt;
}

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(info, line)) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  return fmt::format("{}, {} cores", name, std::thread::hardware_concurrency());
}

std::filesystem::path folder_of_program() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) throw Error("the folder of this program is not known: " + error.message());
  return self.parent_path();
}

std::string date_today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
}

}  // namespace palpable
