#include "core/files/text_scanner.h"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "core/base/error.h"

namespace lodestone {
namespace {

enum class CharClass : std::uint8_t { text, blank, line_end };

constexpr std::array<CharClass, 256> char_classes = [] {
  std::array<CharClass, 256> classes{};
  for (const char blank : {' ', '\t', '\v', '\f'}) classes[static_cast<unsigned char>(blank)] = CharClass::blank;
  for (const char end : {'\n', '\r'}) classes[static_cast<unsigned char>(end)] = CharClass::line_end;
  return classes;
}();

CharClass class_of(char c) { return char_classes[static_cast<unsigned char>(c)]; }

std::string_view without_plus(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+') token.remove_prefix(1);
  return token;
}

// "1.#IND", "-1.#QNAN", "1.#INF00"
std::optional<double> parse_microsoft(std::string_view token) {
  const std::size_t hash = token.find(".#");
  if (hash == std::string_view::npos) return std::nullopt;
  const std::string_view kind = token.substr(hash + 2, 3);
  if (kind == "INF") return token[0] == '-' ? -HUGE_VAL : HUGE_VAL;
  if (kind == "IND" || kind == "QNA" || kind == "SNA" || kind == "NAN") return std::nan("");
  return std::nullopt;
}

}  // namespace

std::optional<double> parse_number(std::string_view token) {
  token = without_plus(token);
  double value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(token).c_str(), nullptr);
  if (error != std::errc{}) return std::nullopt;
  if (end == token.data() + token.size()) return value;
  return parse_microsoft(token);
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
  token = without_plus(token);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc{} || end != token.data() + token.size()) return std::nullopt;
  return value;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string extension_of(const std::filesystem::path& path) { return lower_case(path.extension().string()); }

std::string quote(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) {
    if (c >= ' ' && c <= '~') {
      result += c;
    } else {
      char escape[5];
      std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned char>(c));
      result += escape;
    }
  }
  return result + (text.size() > longest ? "...'" : "'");
}

std::string_view TextScanner::token() {
  while (true) {
    const std::string_view text = input_->window(max_token + 1);
    std::size_t blanks = 0;
    while (blanks < text.size() && class_of(text[blanks]) == CharClass::blank) ++blanks;
    input_->advance(blanks);
    if (blanks == text.size() && !text.empty()) continue;  // the window had only blanks
    const std::string_view rest = input_->window(max_token + 1);
    if (rest.empty() || rest[0] == '#' || class_of(rest[0]) == CharClass::line_end) return {};
    if (rest[0] == '\\' && rest.size() > 1 && class_of(rest[1]) == CharClass::line_end) {
      input_->advance(1);
      skip_line_end();
      continue;
    }
    std::size_t length = 1;
    while (length < rest.size() && class_of(rest[length]) == CharClass::text) ++length;
    if (length > max_token)
      fail("a word has more than " + std::to_string(max_token) + " characters", "give a text file");
    // "1 2\" directly before a line end continues the line too.
    if (rest[length - 1] == '\\' && length < rest.size() && class_of(rest[length]) == CharClass::line_end) --length;
    input_->advance(length);
    return rest.substr(0, length);
  }
}

std::string_view TextScanner::token_across_lines() {
  while (true) {
    const std::string_view found = token();
    if (!found.empty() || !next_line()) return found;
  }
}

bool TextScanner::continues_with(std::string_view text) {
  std::string_view rest = input_->window(max_token);
  while (!rest.empty() && class_of(rest.front()) == CharClass::blank) {
    rest.remove_prefix(1);
    input_->advance(1);
  }
  return rest.starts_with(text);
}

std::string TextScanner::rest_of_line() {
  std::string_view text = input_->window(max_token + 1);
  std::size_t length = 0;
  while (length < text.size() && class_of(text[length]) != CharClass::line_end) ++length;
  if (length > max_token) fail("a name has more than " + std::to_string(max_token) + " characters");
  text = text.substr(0, length);
  while (!text.empty() && class_of(text.back()) == CharClass::blank) text.remove_suffix(1);
  while (!text.empty() && class_of(text.front()) == CharClass::blank) text.remove_prefix(1);
  std::string rest(text);
  input_->advance(length);
  return rest;
}

bool TextScanner::next_line() {
  while (true) {
    const std::string_view text = input_->window(1);
    std::size_t length = 0;
    while (length < text.size() && class_of(text[length]) != CharClass::line_end) ++length;
    input_->advance(length);
    if (text.empty()) return false;
    if (length < text.size()) return skip_line_end();
  }
}

// Skips a line end; false at the end of the input.
bool TextScanner::skip_line_end() {
  const std::string_view text = input_->window(3);
  const std::size_t length = text.size() > 1 && text[0] == '\r' && text[1] == '\n' ? 2 : 1;
  input_->advance(length);
  if (text.size() == length) return false;
  ++line_;
  return true;
}

double TextScanner::number(std::string_view token, const char* what) const {
  if (const std::optional<double> value = parse_number(token)) return *value;
  fail(std::string("expected ") + what + ", found " + (token.empty() ? "the end" : quote(token)));
}

std::int64_t TextScanner::integer(std::string_view token, const char* what) const {
  if (const std::optional<std::int64_t> value = parse_integer(token)) return *value;
  fail(std::string("expected ") + what + ", found " + (token.empty() ? "the end" : quote(token)));
}

void TextScanner::fail(const std::string& what, const std::string& remedy) const {
  throw InputError(describe(input_->name(), place(), what, remedy));
}

}  // namespace lodestone
