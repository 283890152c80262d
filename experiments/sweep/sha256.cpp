#include "experiments/sweep/sha256.h"

#include <openssl/evp.h>

#include <array>

#include "core/base/error.h"
#include "core/files/input_file.h"

namespace lodestone {

std::string sha256(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum;
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), sum.data(), &size, EVP_sha256(), nullptr) != 1)
    throw UnsupportedError("the OpenSSL of this machine refuses SHA-256; see its openssl.cnf");
  std::string digits;
  for (unsigned i = 0; i < size; ++i)
    for (const int shift : {4, 0}) digits += "0123456789abcdef"[(sum[i] >> shift) & 15];
  return digits;
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const MappedFile file(path);
  return sha256({reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()});
}

}  // namespace lodestone
