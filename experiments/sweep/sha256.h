// SHA-256 (nist2015), the hash that `sha256sum` prints: what identifies inputs, programs and runs. Computed by OpenSSL.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lodestone {

// 64 hexadecimal digits. Throws UnsupportedError where a policy of the machine leaves the algorithm out.
[[nodiscard]] std::string sha256(std::string_view text);
// Throws FileError when the file cannot be read.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace lodestone
