// Memory that runs out, for LD_PRELOAD: the allocation with the number MEMORY_FAILS, counted from the start of main(),
// fails; with MEMORY_STAYS so do all after it. With MEMORY_OF this holds for programs with that first argument only.
// MEMORY_COUNT names a file for the number of allocations until main() returns. MEMORY_TELLS prints where it failed.
//
// MEMORY_EACH "FIRST LAST STEP" runs main() once for each of these numbers N, in a process of its own that works in a
// new folder N; it writes to N.output and N.errors, and its status, as waitpid() has it, is in N.status. After
// MEMORY_SECONDS it is killed. That saves the start of the program, which takes longer than a small build.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
}

namespace {

std::atomic<bool> counting{false};
std::atomic<long> count{0};
long fails = 0;  // 0: never
bool stays = false, tells = false;

// True if this allocation fails.
bool fails_now() {
  if (!counting.load(std::memory_order_relaxed)) return false;
  const long number = ++count;
  if (fails == 0 || number < fails || (number > fails && !stays)) return false;
  if (tells && number == fails) {
    counting = false;  // a trace allocates
    void* frames[64];
    backtrace_symbols_fd(frames, backtrace(frames, 64), STDERR_FILENO);
    counting = true;
  }
  errno = ENOMEM;
  return true;
}

void require(bool holds) {
  if (!holds) std::abort();
}

void write_number(const char* file, long number) {
  char text[32];
  const int size = std::snprintf(text, sizeof(text), "%ld\n", number);
  const int descriptor = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  require(descriptor >= 0 && write(descriptor, text, static_cast<size_t>(size)) == size);
  close(descriptor);
}

void redirect(int descriptor, const char* file) {
  const int opened = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  require(opened >= 0 && dup2(opened, descriptor) >= 0);
  close(opened);
}

using Main = int(int, char**, char**);
using Hook = void();
Main* program_main = nullptr;

int counted_main(int argc, char** argv, char** environment) {
  counting = true;
  const int status = program_main(argc, argv, environment);
  counting = false;
  if (const char* file = std::getenv("MEMORY_COUNT")) write_number(file, count);
  return status;
}

// In a new process: a folder and files of its own.
void settle(long number) {
  char name[32], file[48];
  std::snprintf(name, sizeof(name), "%ld", number);
  require(mkdir(name, 0777) == 0);
  std::snprintf(file, sizeof(file), "%s.output", name);
  redirect(STDOUT_FILENO, file);
  std::snprintf(file, sizeof(file), "%s.errors", name);
  redirect(STDERR_FILENO, file);
  require(chdir(name) == 0);
  const char* seconds = std::getenv("MEMORY_SECONDS");
  alarm(seconds ? static_cast<unsigned>(std::atoi(seconds)) : 60);
  unsetenv("MEMORY_EACH");
}

int each_main(int argc, char** argv, char** environment) {
  long first = 0, last = 0, step = 0;
  require(std::sscanf(std::getenv("MEMORY_EACH"), "%ld %ld %ld", &first, &last, &step) == 3 && step > 0);
  for (fails = first; fails <= last; fails += step) {
    const pid_t process = fork();
    require(process >= 0);
    if (process == 0) {
      settle(fails);
      return counted_main(argc, argv, environment);
    }
    int status = 0;
    require(waitpid(process, &status, 0) == process);
    char file[48];
    std::snprintf(file, sizeof(file), "%ld.status", fails);
    write_number(file, status);
  }
  return 0;
}

}  // namespace

extern "C" {
int __libc_start_main(Main* main, int argc, char** argv, Hook* init, Hook* fini, Hook* end, void* stack) {
  auto* const real = reinterpret_cast<decltype(&__libc_start_main)>(dlsym(RTLD_NEXT, "__libc_start_main"));
  const char *const of = std::getenv("MEMORY_OF"), *const number = std::getenv("MEMORY_FAILS");
  if (of && (argc < 2 || std::strcmp(argv[1], of) != 0)) return real(main, argc, argv, init, fini, end, stack);
  fails = number ? std::atol(number) : 0;
  stays = std::getenv("MEMORY_STAYS") != nullptr;
  tells = std::getenv("MEMORY_TELLS") != nullptr;
  program_main = main;
  return real(std::getenv("MEMORY_EACH") ? each_main : counted_main, argc, argv, init, fini, end, stack);
}

void* malloc(size_t bytes) { return fails_now() ? nullptr : __libc_malloc(bytes); }
void* calloc(size_t number, size_t bytes) { return fails_now() ? nullptr : __libc_calloc(number, bytes); }
void* realloc(void* memory, size_t bytes) { return fails_now() ? nullptr : __libc_realloc(memory, bytes); }
void* memalign(size_t alignment, size_t bytes) { return fails_now() ? nullptr : __libc_memalign(alignment, bytes); }
void* aligned_alloc(size_t alignment, size_t bytes) { return memalign(alignment, bytes); }
int posix_memalign(void** memory, size_t alignment, size_t bytes) {
  void* const got = memalign(alignment, bytes);
  if (!got) return ENOMEM;
  *memory = got;
  return 0;
}
}
