// .lode files as older programs wrote them.
#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "core/files/checksum.h"
#include "core/hierarchy/lode/lode_format.h"

namespace lodestone::test {

// Takes the signatures from a file without materials.
inline void drop_signatures(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  LodeHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  bytes.resize(header.payload_offset + header.payload_bytes);
  header.features = static_cast<std::uint16_t>(header.features & ~lode_signatures);
  header.asset_bytes = 0;
  header.asset_checksum = checksum({});
  header.table_checksum = 0;
  std::memcpy(bytes.data(), &header, sizeof(header));
  header.table_checksum = checksum(std::as_bytes(std::span(bytes)).first(header.payload_offset));
  std::memcpy(bytes.data(), &header, sizeof(header));
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace lodestone::test
