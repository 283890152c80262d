// Memory of large arrays: huge pages, and freed memory that is used again. Nearly half of the time of a build of 16
// million triangles went to pages of 4 kB, which the system clears one by one for each new array (docs/decisions/0054).
#pragma once

namespace lodestone {

// From here on freed memory stays with the process for the next array, and `operator new` asks for huge pages where an
// array is large. With a sanitizer, or another C library than glibc, nothing changes. To be called once, at the start
// of main(). A program that calls this has operator new and delete replaced.
void keep_large_memory();
// The same, but arrays of 32 MiB and more go back to the system when they are freed: for processes whose memory is
// limited, as what is kept between two large arrays may be too small for the next one.
void return_large_memory();
// Gives what is free within the heaps back to the system, between two steps of a process whose memory is limited.
void return_free_memory();

}  // namespace lodestone
