#include "experiments/sweep/program_identity.h"

#include <elf.h>

#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/files/input_file.h"
#include "experiments/command_line/version.h"
#include "experiments/sweep/libraries.h"
#include "experiments/sweep/sha256.h"

namespace lodestone {
namespace {

using Bytes = std::span<const std::byte>;

template <class Struct>
std::optional<Struct> at(Bytes file, std::uint64_t offset) {
  if (offset > file.size() || file.size() - offset < sizeof(Struct)) return {};
  Struct value;
  std::memcpy(&value, file.data() + offset, sizeof(Struct));
  return value;
}

std::optional<Bytes> part(Bytes file, std::uint64_t offset, std::uint64_t size) {
  if (offset > file.size() || size > file.size() - offset) return {};
  return file.subspan(offset, size);
}

// The sections that are loaded and decide what the program does; nothing for a file that is not as expected.
std::optional<std::vector<Bytes>> decisive_sections(Bytes file) {
  const auto header = at<Elf64_Ehdr>(file, 0);
  if (!header || std::memcmp(header->e_ident, ELFMAG, SELFMAG) != 0 || header->e_ident[EI_CLASS] != ELFCLASS64)
    return {};
  const auto section = [&](std::uint64_t i) { return at<Elf64_Shdr>(file, header->e_shoff + i * sizeof(Elf64_Shdr)); };
  const auto name_table = section(header->e_shstrndx);
  if (header->e_shnum == 0 || !name_table) return {};
  std::vector<Bytes> sections;
  for (std::uint64_t i = 0; i < header->e_shnum; ++i) {
    const auto s = section(i);
    if (!s) return {};
    if (!(s->sh_flags & SHF_ALLOC) || s->sh_type == SHT_NOBITS || s->sh_type == SHT_NOTE) continue;
    const auto name = part(file, name_table->sh_offset + s->sh_name, commit_section.size() + 1);
    if (name && std::memcmp(name->data(), commit_section.data(), commit_section.size()) == 0) continue;
    const auto bytes = part(file, s->sh_offset, s->sh_size);
    if (!bytes) return {};
    sections.push_back(*bytes);
  }
  return sections;
}

std::string hash_program() {
  const MappedFile file("/proc/self/exe");
  Sha256 hash;
  const auto sections = decisive_sections(file.bytes());
  if (!sections) hash.add(file.bytes());
  for (const Bytes bytes : sections.value_or(std::vector<Bytes>{})) hash.add(bytes);
  for (const LoadedLibrary& library : deciding_libraries())
    hash.add(library.identity + "  " + std::filesystem::path(library.path).filename().string() + "\n");
  return hash.finish();
}

}  // namespace

const std::string& program_hash() {
  static const std::string hash = hash_program();
  return hash;
}

nlohmann::json program_facts() {
  const ProgramCommit commit = program_commit();
  std::vector<std::string> libraries;
  for (const LoadedLibrary& library : loaded_libraries()) libraries.push_back(library.path + " " + library.identity);
  return {{"program", program_hash()},
          {"version", program_version()},
          {"commit", commit.hash},
          {"dirty", commit.dirty},
          {"compiler", LODESTONE_COMPILER},
          {"flags", LODESTONE_FLAGS},
          {"build_type", LODESTONE_BUILD_TYPE},
          {"libraries", libraries}};
}

}  // namespace lodestone
