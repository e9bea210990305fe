// SPDX-License-Identifier: MIT
#include "contained/sandbox.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <span>
#include <sstream>
#include <string_view>

#include <fcntl.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace kelp::bake_cli {
namespace {

// --- Landlock: glibc has no functions for it, and headers may be older than the kernel
// ----------------------

constexpr std::uint64_t kFirstRights = (std::uint64_t{1} << 13) - 1;
// Rights of versions 2, 3 and 5.
constexpr std::uint64_t kRefer = std::uint64_t{1} << 13, kTruncate = std::uint64_t{1} << 14,
                        kIoctl = std::uint64_t{1} << 15;

std::uint64_t rightsOf(int version) {
  return kFirstRights | (version >= 2 ? kRefer : 0) | (version >= 3 ? kTruncate : 0) |
         (version >= 5 ? kIoctl : 0);
}

int landlockVersion() {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? static_cast<int>(version) : 0;
}

// Programs load code, time zones and properties of the machine from here at any time. No user's files.
constexpr std::array kOfTheSystem{
    "/usr/lib",     "/usr/lib64",          "/usr/local/lib", "/lib",
    "/lib64",       "/proc/self",          "/proc/meminfo",  "/proc/cpuinfo",
    "/proc/sys/vm", "/sys/devices/system", "/sys/fs/cgroup", "/dev/null",
    "/dev/urandom", "/etc/ld.so.cache",    "/etc/localtime", "/usr/share/zoneinfo"};

void allow(int rules, const std::filesystem::path& path) {
  // The call itself, because a preloaded library may replace open().
  const int place = static_cast<int>(syscall(SYS_openat, AT_FDCWD, path.c_str(), O_PATH | O_CLOEXEC, 0));
  if (place < 0) return;
  struct stat status {};
  landlock_path_beneath_attr rule{};
  rule.parent_fd = place;
  rule.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE;
  if (fstat(place, &status) == 0 && S_ISDIR(status.st_mode))
    rule.allowed_access |= LANDLOCK_ACCESS_FS_READ_DIR;
  syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  close(place);
}

bool restrictFiles(int version, const std::vector<std::filesystem::path>& readable) {
  const std::uint64_t rights = rightsOf(version);
  const long made = syscall(SYS_landlock_create_ruleset, &rights, sizeof rights, 0);
  if (made < 0) return false;
  const int rules = static_cast<int>(made);
  for (const char* const path : kOfTheSystem) allow(rules, path);
  for (const std::filesystem::path& path : readable) allow(rules, path);
  const bool restricted = syscall(SYS_landlock_restrict_self, rules, 0) == 0;
  close(rules);
  return restricted;
}

// --- seccomp ----------------------------------------------------------------------------------------------

struct Forbidden {
  std::string_view what;
  const char* calls;
};

// Calls that no reader of files makes.
constexpr Forbidden kForbiddenCalls[] = {
    {"starting a program", "execve execveat"},
    {"opening a socket", "socket socketpair"},
    {"starting a process", "fork vfork"},
    {"looking into another process",
     "ptrace process_vm_readv process_vm_writev process_madvise pidfd_open pidfd_getfd"},
    {"sending a signal", "tkill rt_sigqueueinfo rt_tgsigqueueinfo pidfd_send_signal"},
    {"changing a file",
     "creat truncate rename renameat renameat2 link linkat symlink symlinkat unlink unlinkat mkdir mkdirat "
     "rmdir mknod mknodat chmod fchmod fchmodat chown lchown fchown fchownat utime utimes utimensat "
     "futimesat setxattr lsetxattr fsetxattr removexattr lremovexattr fremovexattr"},
    {"sharing memory or messages with another process",
     "shmget shmat semget msgget mq_open mq_unlink memfd_create"},
    {"changing who gets the processor first",
     "setpriority ioprio_set sched_setattr sched_setparam sched_setscheduler"},
    {"changing the system",
     "mount umount2 pivot_root chroot setns unshare swapon swapoff reboot sethostname settimeofday "
     "clock_settime init_module finit_module delete_module kexec_load bpf perf_event_open userfaultfd "
     "keyctl add_key request_key open_by_handle_at move_mount open_tree fsopen fsmount mount_setattr "
     "fsconfig fspick kexec_file_load iopl ioperm acct quotactl adjtimex clock_adjtime setdomainname syslog"},
};

// Uses of other calls that no reader makes. filterCalls() tells them by their arguments.
constexpr Forbidden kForbiddenUses[] = {{"opening a file for writing", "open openat"},
                                        {"starting a process", "clone"},
                                        {"sending a signal", "kill tgkill"},
                                        {"changing another process", "prlimit64 sched_setaffinity"},
                                        {"memory that no limit counts", "mmap"},
                                        {"typing for the user", "ioctl"}};

std::vector<std::string> callsOf(const Forbidden& group) {
  std::istringstream words(group.calls);
  return {std::istream_iterator<std::string>(words), {}};
}

struct CloseFilter {
  void operator()(void* filter) const { seccomp_release(filter); }
};
using Filter = std::unique_ptr<void, CloseFilter>;

scmp_arg_cmp where(unsigned argument, scmp_compare how, std::uint64_t first, std::uint64_t second = 0) {
  return {argument, how, first, second};
}

// Adds a rule. Returns false if that fails. A call that this processor does not have needs none.
template <class... Conditions>
bool rule(const Filter& filter, std::uint32_t action, const char* call, Conditions... conditions) {
  const int number = seccomp_syscall_resolve_name(call);
  if (number == __NR_SCMP_ERROR) return true;
  const std::array<scmp_arg_cmp, sizeof...(conditions)> all{conditions...};
  return seccomp_rule_add_array(filter.get(), action, number, static_cast<unsigned>(all.size()),
                                all.data()) == 0;
}

// Forbids open() for anything but reading. `flags`: the index of that argument.
bool forbidWriting(const Filter& filter, const char* call, unsigned flags) {
  bool added = true;
  for (const std::uint64_t mode : {O_WRONLY, O_RDWR})
    added &= rule(filter, SCMP_ACT_TRAP, call, where(flags, SCMP_CMP_MASKED_EQ, O_ACCMODE, mode));
  for (const std::uint64_t flag : {O_CREAT, O_TRUNC})
    added &= rule(filter, SCMP_ACT_TRAP, call, where(flags, SCMP_CMP_MASKED_EQ, flag, flag));
  return added;
}

bool filterCalls() {
  const Filter filter(seccomp_init(SCMP_ACT_ALLOW));
  if (!filter) return false;
  bool added = true;
  for (const Forbidden& group : kForbiddenCalls)
    for (const std::string& call : callsOf(group)) added &= rule(filter, SCMP_ACT_TRAP, call.c_str());
  added &= forbidWriting(filter, "open", 1) && forbidWriting(filter, "openat", 2);
  // A filter cannot read through pointers. Without these calls glibc uses others: clone() for threads.
  for (const char* const call : {"clone3", "openat2", "io_uring_setup"})
    added &= rule(filter, SCMP_ACT_ERRNO(ENOSYS), call);
  added &= rule(filter, SCMP_ACT_TRAP, "clone", where(0, SCMP_CMP_MASKED_EQ, CLONE_THREAD));
  // Signals to itself alone, as abort() sends; 0 is the whole group with the parent.
  const auto self = static_cast<std::uint64_t>(getpid());
  for (const char* const call : {"kill", "tgkill"})
    added &= rule(filter, SCMP_ACT_TRAP, call, where(0, SCMP_CMP_NE, self));
  for (const char* const call : {"prlimit64", "sched_setaffinity"})
    added &= rule(filter, SCMP_ACT_TRAP, call, where(0, SCMP_CMP_NE, 0));  // 0: of itself
  // RLIMIT_DATA does not count shared memory.
  constexpr std::uint64_t kShared = MAP_SHARED | MAP_ANONYMOUS;
  added &= rule(filter, SCMP_ACT_TRAP, "mmap", where(3, SCMP_CMP_MASKED_EQ, kShared, kShared));
  added &= rule(filter, SCMP_ACT_TRAP, "ioctl", where(1, SCMP_CMP_MASKED_EQ, 0xffffffff, TIOCSTI));
  return added && seccomp_load(filter.get()) == 0;
}

void (*g_forbidden)(int) = nullptr;

}  // namespace

Containment containmentOfKernel() {
  // 0 or more: seccomp exists
  return {landlockVersion(), prctl(PR_GET_SECCOMP) >= 0};
}

std::string describe(const Containment& containment) {
  const std::string landlock = "Landlock " + std::to_string(containment.landlock);
  if (containment.landlock > 0 && containment.seccomp) return "contained by " + landlock + " and seccomp";
  if (containment.landlock > 0) return "contained by " + landlock + ", without seccomp";
  if (containment.seccomp) return "contained by seccomp, without Landlock";
  return "not contained: this kernel has neither Landlock nor seccomp";
}

Containment giveUpAllBut(const std::vector<std::filesystem::path>& readable, void (*forbidden)(int call)) {
  g_forbidden = forbidden;
  struct sigaction action {};
  action.sa_sigaction = [](int, siginfo_t* info, void*) { g_forbidden(info->si_syscall); };
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigaction(SIGSYS, &action, nullptr);
  Containment held;
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return held;  // both need it
  if (const int version = landlockVersion(); version > 0 && restrictFiles(version, readable))
    held.landlock = version;
  held.seccomp = filterCalls();
  return held;
}

std::string nameOfCall(int call) {
  char* const found = seccomp_syscall_resolve_num_arch(SCMP_ARCH_NATIVE, call);
  const std::string name = found ? found : std::to_string(call);
  std::free(found);
  for (const std::span<const Forbidden> groups :
       {std::span<const Forbidden>(kForbiddenCalls), std::span<const Forbidden>(kForbiddenUses)})
    for (const Forbidden& group : groups)
      for (const std::string& one : callsOf(group))
        if (name == one) return name + " (" + std::string(group.what) + ")";
  return name;
}

}  // namespace kelp::bake_cli
