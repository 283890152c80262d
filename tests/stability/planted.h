// Small faults, planted side by side in one build by scripts/mutate and switched on one at a time when a program runs.
// PLANTED=N in the environment switches fault N on. PLANTED_SEEN=FILE, a file of two bytes a fault, records which faults
// the program reached (byte 2N) and which would have changed a value (byte 2N + 1): no test can notice another one.
#pragma once
#pragma GCC system_header  // operands of any type meet here; their warnings belong to the sources

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <mutex>
#include <type_traits>

namespace planted {

inline int chosen = -1;
inline unsigned char* seen = nullptr;

// Runs before other initialisers of the library. The file is mapped, so that a killed process has recorded, too.
[[gnu::constructor(101)]] static void read_environment() {
  if (const char* number = std::getenv("PLANTED")) chosen = std::atoi(number);
  const char* path = std::getenv("PLANTED_SEEN");
  const int file = path && !seen ? open(path, O_RDWR | O_CLOEXEC) : -1;
  if (file < 0) return;
  const auto size = static_cast<std::size_t>(lseek(file, 0, SEEK_END));
  void* const mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (mapped != MAP_FAILED) seen = static_cast<unsigned char*>(mapped);
}

inline void record(int fault, bool differs) {
  if (!seen) return;
  __atomic_store_n(seen + 2 * fault, 1, __ATOMIC_RELAXED);
  if (differs) __atomic_store_n(seen + 2 * fault + 1, 1, __ATOMIC_RELAXED);
}

// True if fault N is on. In constant expressions no fault is.
template <int N>
constexpr bool on() {
  if (std::is_constant_evaluated()) return false;
  record(N, true);
  return chosen == N;
}

template <int N, class T>
constexpr T choose(T right, T wrong) {
  if (std::is_constant_evaluated()) return right;
  if constexpr (std::is_arithmetic_v<T> || std::is_pointer_v<T>)
    record(N, right != wrong);
  else
    record(N, true);
  return chosen == N ? wrong : right;
}

// `a OP b` becomes `a OP name<N>{} OP b`, which keeps precedence and the order of operands.
#define PLANTED_OPERATOR(name, op, wrong)                              \
  template <int N>                                                     \
  struct name {};                                                      \
  template <int N, class A>                                            \
  struct name##_left {                                                 \
    const A& a;                                                        \
  };                                                                   \
  template <int N, class A>                                            \
  constexpr name##_left<N, A> operator op(const A& a, name<N>) {       \
    return {a};                                                        \
  }                                                                    \
  template <int N, class A, class B>                                   \
  constexpr auto operator op(name##_left<N, A> left, const B& b) {     \
    const A& a = left.a;                                               \
    using Result = std::remove_cvref_t<decltype(a op b)>;              \
    return choose<N, Result>(a op b, static_cast<Result>(wrong));      \
  }

PLANTED_OPERATOR(less, <, a <= b)
PLANTED_OPERATOR(less_equal, <=, a < b)
PLANTED_OPERATOR(greater, >, a >= b)
PLANTED_OPERATOR(greater_equal, >=, a > b)
PLANTED_OPERATOR(equal, ==, a != b)
PLANTED_OPERATOR(unequal, !=, a == b)
PLANTED_OPERATOR(plus, +, a - b)
PLANTED_OPERATOR(minus, -, a + b)
PLANTED_OPERATOR(plus_one, +, a)
PLANTED_OPERATOR(minus_one, -, a)
#undef PLANTED_OPERATOR

template <int N>
struct add {};
template <int N, class B>
struct add_right {
  const B& b;
};
template <int N, class B>
constexpr add_right<N, B> operator+=(add<N>, const B& b) {
  return {b};
}
template <int N, class A, class B>
constexpr A& operator+=(A& a, add_right<N, B> right) {
  if (on<N>())
    a -= right.b;
  else
    a += right.b;
  return a;
}

// Operands come as functions, because the second one may not be evaluated.
template <int N, class A, class B>
constexpr bool both(const A& a, const B& b) {
  if (std::is_constant_evaluated()) return a() && b();
  const bool first = a();
  if (chosen == N) return first || b();
  const bool result = first && b();
  record(N, !result);
  return result;
}
template <int N, class A, class B>
constexpr bool either(const A& a, const B& b) {
  if (std::is_constant_evaluated()) return a() || b();
  const bool first = a();
  if (chosen == N) return first && b();
  const bool result = first || b();
  record(N, result);
  return result;
}

template <int N, class T>
constexpr const T& smaller(const T& a, const T& b) {
  const T &low = std::min(a, b), &high = std::max(a, b);
  if (std::is_constant_evaluated()) return low;
  record(N, &low != &high);
  return chosen == N ? high : low;
}
template <int N, class T>
constexpr const T& larger(const T& a, const T& b) {
  const T &low = std::min(a, b), &high = std::max(a, b);
  if (std::is_constant_evaluated()) return high;
  record(N, &low != &high);
  return chosen == N ? low : high;
}
template <int N, class T>
constexpr T smaller(std::initializer_list<T> all) {
  return choose<N, T>(std::min(all), std::max(all));
}
template <int N, class T>
constexpr T larger(std::initializer_list<T> all) {
  return choose<N, T>(std::max(all), std::min(all));
}

template <int N, class T>
auto up(T x) {
  return choose<N>(std::ceil(x), std::floor(x));
}
template <int N, class T>
auto down(T x) {
  return choose<N>(std::floor(x), std::ceil(x));
}

template <int N, class Mutex>
std::unique_lock<Mutex> lock(Mutex& mutex) {
  return on<N>() ? std::unique_lock<Mutex>() : std::unique_lock<Mutex>(mutex);
}

}  // namespace planted
