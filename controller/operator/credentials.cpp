#include "controller/operator/credentials.h"

#include <grp.h>
#include <pwd.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdio>
#include <memory>

namespace flexarm {
namespace {

constexpr std::size_t kMostGroups = 65'536;  // NGROUPS_MAX of Linux
constexpr std::size_t kLongestEntry = 65'536;

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closer>;

std::vector<gid_t> SupplementaryGroupsOf(int fd) {
  std::vector<gid_t> groups(64);
  for (;;) {
    auto size = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
    if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) == 0) {
      groups.resize(size / sizeof(gid_t));
      return groups;
    }
    if (errno != ERANGE || groups.size() >= kMostGroups) return {};
    groups.resize(kMostGroups);
  }
}

}  // namespace

Credentials CredentialsOf(int fd) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return {};
  std::vector<gid_t> groups = SupplementaryGroupsOf(fd);
  groups.push_back(peer.gid);
  return {.uid = peer.uid, .pid = peer.pid, .groups = std::move(groups)};
}

std::string AccountName(uid_t uid) {
  const File file(std::fopen("/etc/passwd", "re"));
  std::vector<char> buffer(kLongestEntry);
  passwd entry{};
  passwd* found = nullptr;
  while (file && fgetpwent_r(file.get(), &entry, buffer.data(), buffer.size(), &found) == 0) {
    if (found->pw_uid == uid) return found->pw_name;
  }
  return "uid " + std::to_string(uid);
}

std::optional<gid_t> GroupNumber(const std::string& name) {
  const File file(std::fopen("/etc/group", "re"));
  std::vector<char> buffer(kLongestEntry);
  group entry{};
  group* found = nullptr;
  while (file && fgetgrent_r(file.get(), &entry, buffer.data(), buffer.size(), &found) == 0) {
    if (name == found->gr_name) return found->gr_gid;
  }
  return std::nullopt;
}

}  // namespace flexarm
