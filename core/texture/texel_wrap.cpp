#include "core/texture/texel_wrap.h"

namespace lodestone {

std::uint32_t wrapped(std::int64_t i, std::uint32_t n, TextureWrap wrap) {
  const auto modulo = [i](std::int64_t m) { return ((i % m) + m) % m; };
  std::int64_t at = 0;
  switch (wrap) {
    case TextureWrap::repeat:
      at = modulo(n);
      break;
    case TextureWrap::clamp:
      at = i < 0 ? 0 : i < n ? i : std::int64_t{n} - 1;
      break;
    case TextureWrap::mirror:
      at = modulo(2 * std::int64_t{n});
      if (at >= n) at = 2 * std::int64_t{n} - 1 - at;
      break;
  }
  return static_cast<std::uint32_t>(at);
}

}  // namespace lodestone
