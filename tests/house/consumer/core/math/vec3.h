// A header of the consumer's own, with the name of one of ours.
#pragma once

struct OwnVector {
  double x = 0;
};
