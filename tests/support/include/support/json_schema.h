// SPDX-License-Identifier: MIT
// A small JSON Schema validator (draft 2020-12, the keywords that kelp's schemas use), so that published
// schemas are tested without a further package. A keyword it does not know is an error: nothing is skipped in
// silence.
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>

namespace kelp::test {

class JsonSchema {
 public:
  explicit JsonSchema(const std::string& path) : root_(nlohmann::json::parse(std::ifstream(path))) {}

  // The first thing wrong with `value`, or an empty string.
  std::string check(const nlohmann::json& value) const { return check(root_, value, ""); }

 private:
  using Json = nlohmann::json;

  static bool hasType(const Json& v, const std::string& type) {
    if (type == "object") return v.is_object();
    if (type == "array") return v.is_array();
    if (type == "string") return v.is_string();
    if (type == "boolean") return v.is_boolean();
    if (type == "null") return v.is_null();
    if (type == "number") return v.is_number();
    if (type == "integer") return v.is_number() && std::floor(v.get<double>()) == v.get<double>();
    throw std::runtime_error("schema: unknown type " + type);
  }

  std::string check(const Json& schema, const Json& v, const std::string& at) const {
    if (schema.is_boolean()) return schema.get<bool>() ? "" : at + ": not allowed";
    for (const auto& [key, rule] : schema.items()) {
      const std::string problem = checkKeyword(schema, key, rule, v, at);
      if (!problem.empty()) return problem;
    }
    return "";
  }

  std::string checkKeyword(const Json& schema, const std::string& key, const Json& rule, const Json& v,
                           const std::string& at) const {
    if (key[0] == '$' && key != "$ref") return "";
    if (key == "title" || key == "description" || key == "examples" || key == "default") return "";
    if (key == "$ref") return check(root_.at(Json::json_pointer(rule.get<std::string>().substr(1))), v, at);
    if (key == "const") return v == rule ? "" : at + ": is not " + rule.dump();
    if (key == "enum")
      return std::find(rule.begin(), rule.end(), v) != rule.end()
                 ? ""
                 : at + ": " + v.dump() + " is none of " + rule.dump();
    if (key == "type") {
      if (rule.is_string()) return hasType(v, rule) ? "" : at + ": is no " + rule.get<std::string>();
      for (const Json& type : rule) {
        if (hasType(v, type)) return "";
      }
      return at + ": is none of " + rule.dump();
    }
    if (key == "oneOf") {
      int matches = 0;
      for (const Json& option : rule) matches += check(option, v, at).empty() ? 1 : 0;
      return matches == 1 ? "" : at + ": matches " + std::to_string(matches) + " of the options";
    }
    if (key == "minimum")
      return !v.is_number() || v.get<double>() >= rule.get<double>() ? "" : at + ": below the minimum";
    if (key == "maximum")
      return !v.is_number() || v.get<double>() <= rule.get<double>() ? "" : at + ": above the maximum";
    if (key == "minLength")
      return !v.is_string() || v.get_ref<const std::string&>().size() >= rule.get<std::size_t>()
                 ? ""
                 : at + ": too short";
    if (key == "pattern")
      return !v.is_string() || std::regex_search(v.get<std::string>(), std::regex(rule.get<std::string>()))
                 ? ""
                 : at + ": does not match";
    if (key == "minItems")
      return !v.is_array() || v.size() >= rule.get<std::size_t>() ? "" : at + ": too few items";
    if (key == "maxItems")
      return !v.is_array() || v.size() <= rule.get<std::size_t>() ? "" : at + ": too many items";
    if (key == "minProperties")
      return !v.is_object() || v.size() >= rule.get<std::size_t>() ? "" : at + ": too few members";
    if (key == "maxProperties")
      return !v.is_object() || v.size() <= rule.get<std::size_t>() ? "" : at + ": too many members";
    if (key == "required") {
      for (const Json& name : rule) {
        if (v.is_object() && !v.contains(name.get<std::string>())) return at + ": lacks " + name.dump();
      }
      return "";
    }
    if (key == "items") {
      for (std::size_t i = 0; v.is_array() && i < v.size(); ++i) {
        const std::string problem = check(rule, v[i], at + "/" + std::to_string(i));
        if (!problem.empty()) return problem;
      }
      return "";
    }
    if (key == "propertyNames") {
      for (auto it = v.is_object() ? v.begin() : v.end(); it != v.end(); ++it) {
        const std::string problem = check(rule, Json(it.key()), at + "/" + it.key());
        if (!problem.empty()) return problem;
      }
      return "";
    }
    if (key == "properties") {
      for (const auto& [name, sub] : rule.items()) {
        if (!v.is_object() || !v.contains(name)) continue;
        const std::string problem = check(sub, v.at(name), at + "/" + name);
        if (!problem.empty()) return problem;
      }
      return "";
    }
    if (key == "additionalProperties") {
      for (auto it = v.is_object() ? v.begin() : v.end(); it != v.end(); ++it) {
        if (schema.contains("properties") && schema.at("properties").contains(it.key())) continue;
        const std::string problem = check(rule, it.value(), at + "/" + it.key());
        if (!problem.empty()) return problem;
      }
      return "";
    }
    throw std::runtime_error("schema: this validator does not know the keyword " + key);
  }

  Json root_;
};

}  // namespace kelp::test
