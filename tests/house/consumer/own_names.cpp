// Ordinary words name things of the consumer's own, beside the whole namespace: none of them is ambiguous.
#include "lodestone/lodestone.h"

using namespace lodestone;

static constexpr int append = 1, blend = 1, condition = 1, cross = 1, cut = 1, describe = 1, difference = 1, dot = 1,
                     excess = 1, extend = 1, is_finite = 1, length = 1, load = 1, mean = 1, outside = 1, placement = 1,
                     project = 1, reach = 1, shape = 1, split = 1, strategy = 1, summarise = 1, without = 1;

int sum_of_own_names();
int sum_of_own_names() {
  return append + blend + condition + cross + cut + describe + difference + dot + excess + extend + is_finite + length +
         load + mean + outside + placement + project + reach + shape + split + strategy + summarise + without;
}
