#include "experiments/sweep/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <new>

#include "core/base/error.h"
#include "core/files/input_file.h"

namespace lodestone {
namespace {

// It fails where a policy of the machine leaves the algorithm out.
void require(int succeeded) {
  if (succeeded != 1) throw UnsupportedError("the OpenSSL of this machine refuses SHA-256; see its openssl.cnf");
}

}  // namespace

void Sha256::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (!context_) throw std::bad_alloc();
  require(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

void Sha256::add(std::span<const std::byte> bytes) {
  require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
}

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum;
  unsigned size = 0;
  require(EVP_DigestFinal_ex(context_.get(), sum.data(), &size));
  std::string digits;
  for (unsigned i = 0; i < size; ++i)
    for (const int shift : {4, 0}) digits += "0123456789abcdef"[(sum[i] >> shift) & 15];
  return digits;
}

std::string sha256(std::string_view text) {
  Sha256 hash;
  hash.add(text);
  return hash.finish();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const MappedFile file(path);
  Sha256 hash;
  hash.add(file.bytes());
  return hash.finish();
}

}  // namespace lodestone
