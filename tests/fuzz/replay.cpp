// Feeds the harnesses without libFuzzer: each file of the folders, and so many mutations of each, always the same ones.
// usage: replay HARNESS MUTATIONS FOLDER...
//
// An input fails that makes the harness crash, take longer than seconds_each, or allocate more than bytes_each and
// bytes_per_byte times its size; formats that are compressed or show a mesh many times, which their readers limit, may
// take bytes_per_packed_byte. What has failed is left in failed.HARNESS in the working folder.
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#define HARNESS(name)                                           \
  extern "C" int test_##name(const std::uint8_t*, std::size_t); \
  extern "C" [[gnu::weak]] std::size_t mutate_##name(std::uint8_t*, std::size_t, std::size_t, unsigned int);
LODESTONE_HARNESSES
#undef HARNESS
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr unsigned seconds_each = 60;  // under sanitizers, on a machine that has more to do
constexpr std::size_t bytes_each = std::size_t{64} << 20, bytes_per_byte = 1024, bytes_per_packed_byte = 16384;
constexpr std::size_t largest_input = 1 << 20;

using Bytes = std::vector<std::uint8_t>;

struct Harness {
  const char* name;
  int (*test)(const std::uint8_t*, std::size_t);
  std::size_t (*mutate)(std::uint8_t*, std::size_t, std::size_t, unsigned int);
};
constexpr Harness harnesses[] = {
#define HARNESS(name) {#name, test_##name, mutate_##name},
    LODESTONE_HARNESSES
#undef HARNESS
};

std::atomic<std::size_t> allocated{0}, most_allocated{0};
const Bytes* current = nullptr;
std::string failed_name, what;

void on_signal(int number) {
  std::fprintf(stderr, "%s: signal %d; the input is left in %s\n", what.c_str(), number, failed_name.c_str());
  std::ofstream(failed_name, std::ios::binary)
      .write(reinterpret_cast<const char*>(current->data()), static_cast<std::streamsize>(current->size()));
  std::_Exit(1);
}

std::mt19937 chance;  // of LLVMFuzzerMutate
std::size_t below(std::size_t end) { return chance() % std::max<std::size_t>(end, 1); }

// Returns the largest number of bytes allocated at once.
std::size_t feed(const Harness& harness, const Bytes& input) {
  const Bytes exact(input);  // without room beyond its end
  current = &exact;
  alarm(seconds_each);
  const std::size_t before = allocated;
  most_allocated = before;
  harness.test(exact.data(), exact.size());
  const std::size_t most = most_allocated - before;
  alarm(0);
  const std::string_view name = harness.name;
  const std::size_t per_byte = name == "gltf" || name == "draco" ? bytes_per_packed_byte : bytes_per_byte;
  if (most > bytes_each + per_byte * exact.size()) {
    std::fprintf(stderr, "%s: allocates %zu bytes for %zu\n", what.c_str(), most, exact.size());
    on_signal(0);
  }
  return most;
}

Bytes mutated(const Harness& harness, Bytes bytes, unsigned int seed) {
  chance.seed(seed);
  for (std::size_t left = 1 + below(3); left > 0; --left) {
    const std::size_t size = bytes.size(), most = std::min(largest_input, size + size / 2 + 64);
    bytes.resize(most);
    bytes.resize(harness.mutate ? harness.mutate(bytes.data(), size, most, static_cast<unsigned int>(chance()))
                                : LLVMFuzzerMutate(bytes.data(), size, most));
  }
  return bytes;
}

}  // namespace

// As libFuzzer's, which mutators call.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  Bytes bytes(data, data + size);
  const auto at = [&](std::size_t offset) { return bytes.begin() + static_cast<std::ptrdiff_t>(offset); };
  const std::size_t begin = below(size), end = begin + std::min<std::size_t>(size - begin, 1 + below(16));
  constexpr std::uint32_t numbers[] = {0, 1, 2, 0x7f, 0xff, 0x100, 0xffff, 0x10000, 0x7fffffff, 0x80000000, 0xffffffff};
  const std::uint32_t number = numbers[below(std::size(numbers))];
  switch (size == 0 ? 0 : below(7)) {
    case 0:
      bytes.insert(at(begin), static_cast<std::uint8_t>(chance()));
      break;
    case 1:
      bytes[begin] ^= static_cast<std::uint8_t>(1u << below(8));
      break;
    case 2:
      bytes[begin] = static_cast<std::uint8_t>(chance());
      break;
    case 3:
      if (size >= 4) std::memcpy(&bytes[std::min(begin, size - 4)], &number, 4);
      break;
    case 4:
      bytes.erase(at(begin), at(end));
      break;
    case 5: {
      const Bytes part(at(begin), at(end));
      bytes.insert(at(below(size)), part.begin(), part.end());
      break;
    }
    default: {  // a number in a text
      const auto digit = [](std::uint8_t c) { return c >= '0' && c <= '9'; };
      const auto from = std::find_if(at(begin), bytes.end(), digit), to = std::find_if_not(from, bytes.end(), digit);
      const std::string text = below(4) == 0 ? "1e39" : std::to_string(number);
      bytes.insert(bytes.erase(from, to), text.begin(), text.end());
    }
  }
  bytes.resize(std::min(bytes.size(), most));
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

#ifndef __SANITIZE_ADDRESS__
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void __libc_free(void*);

static void* counted(void* memory) {
  if (!memory) return memory;
  const std::size_t now = allocated += malloc_usable_size(memory);
  std::size_t most = most_allocated;
  while (now > most && !most_allocated.compare_exchange_weak(most, now)) {
  }
  return memory;
}
static void uncount(void* memory) { allocated -= memory ? malloc_usable_size(memory) : 0; }

void* malloc(std::size_t bytes) { return counted(__libc_malloc(bytes)); }
void* calloc(std::size_t count, std::size_t bytes) { return counted(__libc_calloc(count, bytes)); }
void* realloc(void* memory, std::size_t bytes) {
  const std::size_t before = memory ? malloc_usable_size(memory) : 0;
  void* const moved = __libc_realloc(memory, bytes);
  if (moved || bytes == 0) allocated -= before;
  return counted(moved);
}
void free(void* memory) {
  uncount(memory);
  __libc_free(memory);
}
}
#endif

int main(int argc, char** argv) {
  const auto* const harness = std::find_if(std::begin(harnesses), std::end(harnesses), [&](const Harness& h) {
    return argc > 3 && std::strcmp(h.name, argv[1]) == 0;
  });
  if (harness == std::end(harnesses)) return std::fputs("usage: replay HARNESS MUTATIONS FOLDER...\n", stderr), 2;
  for (const int number : {SIGABRT, SIGSEGV, SIGALRM, SIGFPE, SIGBUS, SIGILL}) std::signal(number, on_signal);
  const auto mutations = static_cast<unsigned int>(std::atoi(argv[2]));
  failed_name = std::string("failed.") + argv[1];
  std::size_t inputs = 0, most = 0;
  double most_per_byte = 0;
  for (int k = 3; k < argc; ++k)
    for (const auto& entry : std::filesystem::directory_iterator(argv[k])) {
      std::ifstream in(entry.path(), std::ios::binary);
      const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
      for (unsigned int i = 0; i <= mutations; ++i, ++inputs) {
        what = entry.path().string() + ", mutation " + std::to_string(i);
        const Bytes input = i == 0 ? bytes : mutated(*harness, bytes, i);
        const std::size_t used = feed(*harness, input);
        most = std::max(most, used);
        most_per_byte = std::max(most_per_byte, static_cast<double>(used) / static_cast<double>(input.size() + 4096));
      }
    }
  std::printf("%s: %zu inputs, at most %zu bytes at once, %.0f for each byte beside 4096\n", argv[1], inputs, most,
              most_per_byte);
  return inputs == 0;
}
