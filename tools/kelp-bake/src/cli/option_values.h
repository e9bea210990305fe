// SPDX-License-Identifier: MIT
// Conversions of the text of an option to its value.
#pragma once

#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "cli/options.h"

namespace kelp::bake_cli {

// Takes the text of an option into the value that it was made for. Returns the fault, or null.
using Take = std::function<const char*(const std::string&)>;

// T, or the T of an optional.
template <class Out>
using ValueOf = typename decltype(std::optional(std::declval<Out>()))::value_type;

template <class Out>
Take text(Out& out) {
  return [&out](const std::string& given) { return out = given, nullptr; };
}

// A number that is all of the text.
template <class Number>
std::optional<Number> parseNumber(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) return std::nullopt;
  return value;
}

// `out`: int, double, or an optional one.
template <class Out>
Take number(Out& out) {
  return [&out](const std::string& given) -> const char* {
    const auto value = parseNumber<ValueOf<Out>>(given);
    if (!value)
      return std::is_same_v<ValueOf<Out>, int> ? "not a whole number; see kelp-bake --help"
                                               : "not a number; see kelp-bake --help";
    out = *value;
    return nullptr;
  };
}

// `fault`: "unknown; use fast or best".
template <class Out>
Take choice(Out& out, const char* fault, std::map<std::string, ValueOf<Out>> choices) {
  return [&out, fault, choices = std::move(choices)](const std::string& given) {
    const auto found = choices.find(given);
    if (found == choices.end()) return fault;
    out = found->second;
    return static_cast<const char*>(nullptr);
  };
}

// 0 stands for the default, so it cannot be given.
Take countingNumber(int& out);
Take axis(std::optional<Axis>& out);
// A unit's name, or its length in meters.
Take unit(Options& options);
// "Walk:0.3".
Take moment(std::optional<bake::Moment>& out);
// "4G", "512M", "1.5 GiB", "1000000".
Take bytes(std::uint64_t& out);
Take bend(bake::Settings& settings);
// A preset or a file.
Take rig(bake::Settings& settings);

}  // namespace kelp::bake_cli
