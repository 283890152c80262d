// A blending function as data, which every backend evaluates alike. usage: blend
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main() try {
  // It rests at both ends of the band, where other curves only slow down.
  const Blend resting = own_blend({BlendCurve::Kind::table, {0, 0, 0.5f, 1, 1}});
  const Blend quintic = blend_named("polynomial:0,0,0,10,-15,6");
  for (const Blend b : {Blend::linear, Blend::smoothstep, resting, quintic}) {
    std::printf("%-28s Lipschitz constant %.3f:", std::string(name_of(b)).c_str(), blend_lipschitz(b));
    for (int i = 0; i <= 8; ++i) std::printf(" %.2f", static_cast<double>(blend_share(b, static_cast<float>(i) / 8)));
    std::printf("\n");
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
