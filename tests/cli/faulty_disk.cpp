// SPDX-License-Identifier: MIT
// A disk that fails, for a program that preloads this library (LD_PRELOAD): of the calls on files in the
// folder KELP_FAULTY_FOLDER, the one of a kind with a number fails. KELP_FAULT="write 3 28": the third write
// answers errno 28; "read short": every read gives a seventh of what it could, and so for write; "rename 1
// crash": at the first one the process crashes; "write 2 hang": at the second one it waits for ever; "write 1
// lie": one byte becomes another; "write 1 swap": there and after it, nothing is written but the file
// other.kelp. KELP_FAULTY_COUNTS names a file (elsewhere) that gets the numbers of calls, a line for each
// kind, at the end. Processes that the program starts count on. KELP_FAULT="exec model.obj", or another word
// of kDeeds: so a library may do at a file; here a process that the program starts does, as it opens the
// first file whose name ends so.
#undef _FORTIFY_SOURCE  // whose read() and pread() clang does not let be defined again
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace {

constexpr const char* kKinds[] = {"open", "read", "write", "fsync", "close", "rename"};
enum Kind { kOpen, kRead, kWrite, kSync, kClose, kRename, kKindCount };

void crash() { std::raise(SIGABRT); }
void hang() {
  for (;;) pause();
}
void spin() {
  for (volatile bool on = true; on;) {
  }
}
void allocate() {
  for (;;) std::memset(::operator new(1 << 24), 1, 1 << 24);
}
void throwMuch() { throw std::runtime_error(std::string(std::size_t{1} << 30, 'x')); }
void print() {
  const std::string text(1 << 20, 'x');
  for (int i = 0; i < 1024; ++i) std::fputs(text.c_str(), i % 2 ? stdout : stderr);
  crash();
}

// If nothing stops these calls, they leave a file, a process or another visible trace.
void exec() { execl("/bin/sh", "sh", "-c", "exit 0", nullptr); }
void execInThread() { std::thread(exec).join(); }
void forkIt() {
  if (fork() == 0) _exit(0);
}
void openSocket() { socket(AF_INET, SOCK_STREAM, 0); }
void traceParent() { ptrace(PTRACE_ATTACH, getppid(), nullptr, nullptr); }
void killParent() { kill(getppid(), SIGTERM); }
void create() { syscall(SYS_openat, AT_FDCWD, "made", O_WRONLY | O_CREAT, 0666); }
void overwrite() { syscall(SYS_openat, AT_FDCWD, "1.obj", O_RDONLY | O_TRUNC); }
void removeIt() { unlink("1.obj"); }
void moveIt() { syscall(SYS_renameat2, AT_FDCWD, "1.obj", AT_FDCWD, "moved", 0); }
void changeMode() { chmod("1.obj", 0777); }
void shareSegment() { syscall(SYS_shmget, 1, 4096, 01600); }
void openQueue() { syscall(SYS_mq_open, "queue", O_RDWR | O_CREAT, 0600, nullptr); }
void makeMemoryFile() { syscall(SYS_memfd_create, "memory", 0); }
void shareMemory() { syscall(SYS_mmap, nullptr, 4096, PROT_READ, MAP_SHARED | MAP_ANONYMOUS, -1, 0L); }
void slowParent() { syscall(SYS_setpriority, 0, getppid(), 7); }
void bindParent() {
  unsigned long first = 1;
  syscall(SYS_sched_setaffinity, getppid(), sizeof first, &first);
}
void keepAccounts() { syscall(SYS_acct, "none"); }
// A limit that was lowered cannot be raised again.
void raiseLimits() {
  for (const auto kind : {RLIMIT_DATA, RLIMIT_FSIZE, RLIMIT_CORE}) {
    rlimit limit{};
    getrlimit(kind, &limit);
    if (limit.rlim_max == RLIM_INFINITY) raise(SIGUSR2);
  }
}
// Reading elsewhere is refused, and the reader goes on: it says what it got.
void readElsewhere() {
  const int file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, "/etc/passwd", O_RDONLY));
  if (file >= 0 || errno != EACCES) raise(SIGUSR2);
}
void uring() {
  if (syscall(SYS_io_uring_setup, 1, nullptr) != -1 || errno != ENOSYS) raise(SIGUSR2);
}

// The pipe to the parent: the first one beside the standard streams.
int pipeToParent() {
  struct stat status {};
  for (int file = 3; file < 64; ++file)
    if (fstat(file, &status) == 0 && S_ISFIFO(status.st_mode)) return file;
  return -1;
}
// A message as contained/wire.h has it, of a process that was taken over.
void tell(std::uint8_t word, const std::string& content) {
  const auto size = static_cast<std::uint32_t>(content.size());
  std::string head(1, static_cast<char>(word));
  head.append(reinterpret_cast<const char*>(&size), sizeof size);
  for (const std::string& part : {std::cref(head), std::cref(content)}) {
    for (std::size_t at = 0; at < part.size();) {
      const long some = syscall(SYS_write, pipeToParent(), part.data() + at, part.size() - at);
      if (some <= 0) _exit(9);
      at += static_cast<std::size_t>(some);
    }
  }
  hang();
}
constexpr std::uint8_t kProgress = 0, kDone = 1, kFailed = 2, kForbidden = 3, kNoWord = 9;
// As lists in lists are written in CBOR, and a list of many times nothing.
void tellNested() { tell(kFailed, std::string(1000000, '\x81')); }
void tellNestedLess() { tell(kFailed, std::string(60000, '\x81')); }
void tellFlat() {
  std::string list(std::size_t{255} << 20, '\xf6');
  tell(kDone, list.replace(0, 5, "\x9a\x0e\xff\xff\xfb"));
}
// Of most fields, nothing; then more bytes, or fewer, than fields.
void tellZeros() { tell(kDone, std::string(std::size_t{60} << 20, '\0')); }
void tellOnes() { tell(kDone, std::string(std::size_t{60} << 20, '\1')); }
void tellNothing() { tell(kDone, ""); }
void tellMuchProgress() { tell(kProgress, std::string(2000, 'x')); }
void tellNoCall() { tell(kForbidden, "12345"); }
void tellNoWord() { tell(kNoWord, ""); }

// The next bytes that are written are not those that were given.
bool g_lies = false;
void lie() { g_lies = true; }
// Or they are those of another file, and later ones are none.
bool g_swaps = false;
std::string g_other;
void swapFile() {
  g_swaps = true;
  const int file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, "other.kelp", O_RDONLY));
  g_other.resize(1 << 20);
  g_other.resize(static_cast<std::size_t>(syscall(SYS_read, file, g_other.data(), g_other.size())));
}

struct Deed {
  const char* name;
  void (*does)();
};
constexpr Deed kDeeds[] = {{"crash", crash},
                           {"hang", hang},
                           {"spin", spin},
                           {"allocate", allocate},
                           {"throw", throwMuch},
                           {"print", print},
                           {"exec", exec},
                           {"thread", execInThread},
                           {"fork", forkIt},
                           {"socket", openSocket},
                           {"trace", traceParent},
                           {"kill", killParent},
                           {"create", create},
                           {"overwrite", overwrite},
                           {"remove", removeIt},
                           {"move", moveIt},
                           {"mode", changeMode},
                           {"elsewhere", readElsewhere},
                           {"uring", uring},
                           {"nested", tellNested},
                           {"nested-less", tellNestedLess},
                           {"flat", tellFlat},
                           {"zeros", tellZeros},
                           {"ones", tellOnes},
                           {"nothing", tellNothing},
                           {"progress", tellMuchProgress},
                           {"no-call", tellNoCall},
                           {"no-word", tellNoWord},
                           {"segment", shareSegment},
                           {"queue", openQueue},
                           {"memfd", makeMemoryFile},
                           {"shared", shareMemory},
                           {"slow", slowParent},
                           {"bind", bindParent},
                           {"account", keepAccounts},
                           {"limits", raiseLimits}};

struct Plan {
  const char* folder = std::getenv("KELP_FAULTY_FOLDER");
  int kind = -1, error = 0;
  long number = 0;  // 0: every one is short
  void (*at_call)() = nullptr;
  const pid_t program = getpid();
  void (*at_file)() = nullptr;
  char at_name[64] = {};
  // zeros
  std::atomic<long>* const count =
      static_cast<std::atomic<long>*>(mmap(nullptr, sizeof(std::atomic<long>) * kKindCount,
                                           PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));

  Plan() {
    const char* const text = std::getenv("KELP_FAULT");
    char name[16] = {}, number_text[16] = {}, error_text[16] = {};
    if (text == nullptr) return;
    if (std::sscanf(text, "%15s %63s", name, at_name) == 2) {
      for (const Deed& deed : kDeeds)
        if (std::strcmp(name, deed.name) == 0) at_file = deed.does;
    }
    if (at_file != nullptr || std::sscanf(text, "%15s %15s %15s", name, number_text, error_text) < 2) return;
    for (int k = 0; k < kKindCount; ++k) {
      if (std::strcmp(name, kKinds[k]) == 0) kind = k;
    }
    number = std::atol(number_text);
    error = std::atoi(error_text);
    if (std::strcmp(error_text, "crash") == 0) at_call = crash;
    if (std::strcmp(error_text, "hang") == 0) at_call = hang;
    if (std::strcmp(error_text, "lie") == 0) at_call = lie;
    if (std::strcmp(error_text, "swap") == 0) at_call = swapFile;
  }
  ~Plan() {
    const char* const path = std::getenv("KELP_FAULTY_COUNTS");
    std::FILE* const file = path == nullptr ? nullptr : std::fopen(path, "w");
    if (file == nullptr) return;
    for (int k = 0; k < kKindCount; ++k) std::fprintf(file, "%s %ld\n", kKinds[k], count[k].load());
    std::fclose(file);
  }
};

Plan& plan() {
  static Plan it;
  return it;
}
[[maybe_unused]] const Plan& kMadeByTheProgram = plan();

bool isIn(const char* path) {
  return plan().folder != nullptr && std::strncmp(path, plan().folder, std::strlen(plan().folder)) == 0;
}

bool isIn(int file) {
  char link[32], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return false;
  path[size] = 0;
  return isIn(path);
}

// True if this call must fail; errno is set then. A plan with at_call calls that instead.
bool fails(Kind kind) {
  const long number = ++plan().count[kind];
  if (plan().kind != kind || plan().number != number) return false;
  if (plan().at_call == nullptr) {
    errno = plan().error;
    return true;
  }
  plan().at_call();
  return false;
}

// Before a file is opened.
void visit(const char* path) {
  const std::size_t length = std::strlen(path), end = std::strlen(plan().at_name);
  if (plan().at_file != nullptr && getpid() != plan().program && length >= end &&
      std::strcmp(path + length - end, plan().at_name) == 0)
    std::exchange(plan().at_file, nullptr)();
}

std::size_t atMost(Kind kind, std::size_t size) {
  return plan().kind == kind && plan().number == 0 ? (size + 6) / 7 : size;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? static_cast<mode_t>(va_arg(rest, int)) : 0;
  va_end(rest);
  visit(path);
  // A relative path is one of the folder that the test runs in.
  if ((path[0] != '/' || isIn(path)) && fails(kOpen)) return -1;
  return next<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}

// With 64-bit offsets they are one, which libraries call by this name.
int open64(const char* path, int flags, ...) __attribute__((alias("open")));

FILE* fopen64(const char* path, const char* mode) {
  visit(path);
  if ((path[0] != '/' || isIn(path)) && fails(kOpen)) return nullptr;
  return next<FILE* (*)(const char*, const char*)>("fopen64")(path, mode);
}

ssize_t read(int file, void* bytes, size_t size) {
  const bool in = isIn(file);
  if (in && fails(kRead)) return -1;
  return next<ssize_t (*)(int, void*, size_t)>("read")(file, bytes, in ? atMost(kRead, size) : size);
}

ssize_t pread(int file, void* bytes, size_t size, off_t at) {
  const bool in = isIn(file);
  if (in && fails(kRead)) return -1;
  return next<ssize_t (*)(int, void*, size_t, off_t)>("pread")(file, bytes, in ? atMost(kRead, size) : size,
                                                               at);
}

ssize_t write(int file, const void* bytes, size_t size) {
  const bool in = isIn(file);
  if (in && fails(kWrite)) return -1;
  if (in && g_swaps) {
    const std::string other = std::exchange(g_other, {});
    syscall(SYS_write, file, other.data(), other.size());
    return static_cast<ssize_t>(size);
  }
  std::string changed;
  if (in && std::exchange(g_lies, false)) {
    changed.assign(static_cast<const char*>(bytes), size);
    changed[size / 2] ^= 0x11;
    bytes = changed.data();
  }
  return next<ssize_t (*)(int, const void*, size_t)>("write")(file, bytes, in ? atMost(kWrite, size) : size);
}

ssize_t writev(int file, const iovec* parts, int count) {
  const bool in = isIn(file);
  if (in && fails(kWrite)) return -1;
  const iovec* const first =
      std::find_if(parts, parts + count, [](const iovec& part) { return part.iov_len > 0; });
  if (in && first != parts + count && atMost(kWrite, first->iov_len) < first->iov_len)
    return next<ssize_t (*)(int, const void*, size_t)>("write")(file, first->iov_base,
                                                                atMost(kWrite, first->iov_len));
  return next<ssize_t (*)(int, const iovec*, int)>("writev")(file, parts, count);
}

int fsync(int file) {
  if (isIn(file) && fails(kSync)) return -1;
  return next<int (*)(int)>("fsync")(file);
}

int close(int file) {
  const bool failed = isIn(file) && fails(kClose);
  const int error = errno, result = next<int (*)(int)>("close")(file);  // closed all the same, as Linux does
  if (!failed) return result;
  errno = error;
  return -1;
}

int rename(const char* from, const char* to) {
  if ((from[0] != '/' || isIn(from)) && fails(kRename)) return -1;
  return next<int (*)(const char*, const char*)>("rename")(from, to);
}

}  // extern "C"
