// Large arrays in huge pages, kept once they are freed: pages of 4 kB for them, each asked of the system and cleared by
// it anew, were half of the time that a build of 16 million triangles took (docs/decisions/0054).
#pragma once

namespace lodestone {

// From here on freed memory stays with the process for the next array, and `operator new` asks for huge pages where an
// array is large. Where the system has none, or with a sanitizer, nothing changes. To be called once, at the start of
// main(). A program that calls this has operator new and delete replaced.
void keep_large_memory();

}  // namespace lodestone
