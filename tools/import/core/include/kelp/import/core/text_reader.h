// SPDX-License-Identifier: MIT
// Words and numbers of text formats, independent of the locale.
#pragma once

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace kelp::bake {

constexpr bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

inline std::string_view trim(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

// Takes the next line off `text`, without its end: LF, CR LF, or CR alone.
inline std::string_view takeLine(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end);
  text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
  return line;
}

// Takes the next word off `text`; empty at the end.
inline std::string_view nextWord(std::string_view& text) {
  text = trim(text);
  std::size_t end = 0;
  while (end < text.size() && !isBlank(text[end])) ++end;
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

// std::from_chars of a double, which libc++ 13 of emscripten lacks: there strtod, in the locale "C", of what
// from_chars takes.
inline std::from_chars_result readDouble(std::string_view word, double& value) {
#ifdef __cpp_lib_to_chars
  return std::from_chars(word.data(), word.data() + word.size(), value);
#else
  const std::string copy(word);
  if (copy.empty() || isBlank(copy.front()) || copy.front() == '+' || copy.find_first_of("xX") != copy.npos)
    return {word.data(), std::errc::invalid_argument};
  char* end = nullptr;
  errno = 0;
  const double read = std::strtod(copy.c_str(), &end);
  const char* const behind = word.data() + (end - copy.c_str());
  if (errno == ERANGE) return {behind, std::errc::result_out_of_range};
  value = read;
  return {behind, behind == word.data() ? std::errc::invalid_argument : std::errc()};
#endif
}

inline std::optional<double> parseDouble(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = readDouble(word, value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Too small is 0. Too large is infinite, which callers refuse or drop. from_chars does not say which, so
    // look at the text.
    const std::size_t exponent = word.find_first_of("eE");
    const std::string_view whole = word.substr(0, word.find_first_of(".eE"));
    const bool small = exponent != word.npos ? word.substr(exponent + 1).front() == '-'
                                             : whole.find_first_of("123456789") == whole.npos;
    if (small) return 0.0;
    return word.front() == '-' ? -std::numeric_limits<double>::infinity()
                               : std::numeric_limits<double>::infinity();
  }
  if (error != std::errc()) return std::nullopt;
  return value;
}

// Parsed as a double, so that a denormal or 1e-50 is not an error. Beyond floats: infinite.
inline std::optional<float> parseFloat(std::string_view word) {
  const std::optional<double> value = parseDouble(word);
  if (!value) return std::nullopt;
  if (std::abs(*value) > static_cast<double>(std::numeric_limits<float>::max()))
    return std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(*value < 0 ? -1 : 1));
  return static_cast<float>(*value);
}

inline std::optional<std::int64_t> parseInteger(std::string_view word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace kelp::bake
