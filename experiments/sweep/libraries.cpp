#include "experiments/sweep/libraries.h"

#include <elf.h>
#include <fmt/core.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <set>
#include <string_view>

#include "experiments/sweep/sha256.h"

namespace lodestone {
namespace {

// The system's run-time. What it computes is laid down by standards, and security updates replace it often: runs of
// weeks would be lost to them. libm, whose last digits differ from one version to the next, is none of them.
constexpr std::array run_time = {"libc.so", "libstdc++.so", "libgcc_s.so", "libpthread.so", "libdl.so", "ld-linux"};

struct Object {
  std::string path;                 // empty: the executable
  std::string build_id;             // empty: none
  std::vector<std::string> needed;  // what it names
};

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

// Notes are a header, name and content, each padded to four bytes.
std::string build_id_in(const char* notes, std::size_t size) {
  while (size >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) header;
    std::memcpy(&header, notes, sizeof header);
    const std::size_t length = sizeof header + padded(header.n_namesz) + padded(header.n_descsz);
    if (length > size) return {};
    const char* const name = notes + sizeof header;
    if (header.n_type == NT_GNU_BUILD_ID && std::string_view(name, header.n_namesz) == std::string_view("GNU", 4)) {
      std::string text;
      const char* const id = name + padded(header.n_namesz);
      for (std::size_t i = 0; i < header.n_descsz; ++i)
        text += fmt::format("{:02x}", static_cast<unsigned char>(id[i]));
      return text;
    }
    notes += length;
    size -= length;
  }
  return {};
}

// DT_NEEDED, as the names of files without their folders.
std::vector<std::string> needed_by(const ElfW(Dyn) * dynamic, ElfW(Addr) base) {
  const char* names = nullptr;
  for (const ElfW(Dyn)* entry = dynamic; entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == DT_STRTAB)  // some loaders leave the address in it as it is in the file
      names = reinterpret_cast<const char*>(entry->d_un.d_ptr < base ? base + entry->d_un.d_ptr : entry->d_un.d_ptr);
  std::vector<std::string> needed;
  for (const ElfW(Dyn)* entry = dynamic; names && entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == DT_NEEDED) needed.emplace_back(names + entry->d_un.d_val);
  return needed;
}

int add_object(dl_phdr_info* info, std::size_t, void* objects) {
  Object object{info->dlpi_name, {}, {}};
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = info->dlpi_phdr[i];
    const auto* const start = reinterpret_cast<const char*>(info->dlpi_addr + header.p_vaddr);
    if (header.p_type == PT_NOTE && object.build_id.empty()) object.build_id = build_id_in(start, header.p_memsz);
    if (header.p_type == PT_DYNAMIC)
      object.needed = needed_by(reinterpret_cast<const ElfW(Dyn)*>(start), info->dlpi_addr);
  }
  static_cast<std::vector<Object>*>(objects)->push_back(std::move(object));
  return 0;
}

std::vector<Object> loaded_objects() {
  std::vector<Object> objects;
  dl_iterate_phdr(add_object, &objects);
  return objects;
}

// The kernel's is no file.
bool is_library(const Object& object) { return !object.path.empty() && object.path.find('/') != std::string::npos; }

LoadedLibrary identified(const Object& object) {
  std::error_code ignored;
  const bool readable = object.build_id.empty() && std::filesystem::is_regular_file(object.path, ignored);
  return {object.path, readable ? sha256_of_file(object.path) : object.build_id};
}

bool is_run_time(const std::string& name) {
  return std::ranges::any_of(run_time, [&](const char* start) { return name.starts_with(start); });
}

}  // namespace

std::vector<LoadedLibrary> loaded_libraries() {
  std::vector<LoadedLibrary> libraries;
  for (const Object& object : loaded_objects())
    if (is_library(object)) libraries.push_back(identified(object));
  return libraries;
}

std::vector<LoadedLibrary> deciding_libraries() {
  const std::vector<Object> objects = loaded_objects();
  const auto executable = std::ranges::find(objects, std::string(), &Object::path);
  std::vector<LoadedLibrary> libraries;
  if (executable == objects.end()) return libraries;
  const std::set<std::string> needed(executable->needed.begin(), executable->needed.end());
  for (const std::string& name : needed)
    for (const Object& object : objects)
      if (is_library(object) && !is_run_time(name) && std::filesystem::path(object.path).filename() == name)
        libraries.push_back(identified(object));
  return libraries;
}

}  // namespace lodestone
