// SPDX-License-Identifier: MIT
// Faults against the specification that do no harm: values of a wrong type, ranges beyond their buffer,
// misaligned data. The whole file is searched, also what nothing reads, so that no broken file passes without
// a notice. Readers refuse such a range when they need it.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "gltf_json.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kMostFlaws = 8;  // kinds of them; each is one warning

class FlawList {
 public:
  void add(const std::string& place, const std::string& what) {
    const auto found =
        std::find_if(flaws_.begin(), flaws_.end(), [&](const Flaw& flaw) { return flaw.what == what; });
    if (found != flaws_.end())
      ++found->more;
    else
      flaws_.push_back({place, what, 0});
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < flaws_.size() && i < kMostFlaws; ++i)
      out.push_back(flaws_[i].place +
                    (flaws_[i].more > 0 ? " and " + std::to_string(flaws_[i].more) + " more" : "") + ": " +
                    flaws_[i].what);
    if (flaws_.size() > kMostFlaws)
      out.push_back("the file has " + std::to_string(flaws_.size() - kMostFlaws) +
                    " more kinds of faults; a glTF validator lists them");
    return out;
  }

 private:
  struct Flaw {
    std::string place, what;
    std::size_t more;
  };
  std::vector<Flaw> flaws_;
};

enum class Kind { kText, kNumber, kWhole, kFlag, kList, kObject };

// Members that have the same type everywhere in the specification (section 5).
constexpr std::array<std::pair<std::string_view, Kind>, 61> kMembers = {{
    {"name", Kind::kText},
    {"uri", Kind::kText},
    {"mimeType", Kind::kText},
    {"alphaMode", Kind::kText},
    {"interpolation", Kind::kText},
    {"path", Kind::kText},
    {"generator", Kind::kText},
    {"copyright", Kind::kText},
    {"version", Kind::kText},
    {"minVersion", Kind::kText},
    {"metallicFactor", Kind::kNumber},
    {"roughnessFactor", Kind::kNumber},
    {"alphaCutoff", Kind::kNumber},
    {"strength", Kind::kNumber},
    {"bufferView", Kind::kWhole},
    {"buffer", Kind::kWhole},
    {"byteOffset", Kind::kWhole},
    {"byteLength", Kind::kWhole},
    {"byteStride", Kind::kWhole},
    {"componentType", Kind::kWhole},
    {"count", Kind::kWhole},
    {"mesh", Kind::kWhole},
    {"skin", Kind::kWhole},
    {"camera", Kind::kWhole},
    {"material", Kind::kWhole},
    {"scene", Kind::kWhole},
    {"index", Kind::kWhole},
    {"texCoord", Kind::kWhole},
    {"source", Kind::kWhole},
    {"inverseBindMatrices", Kind::kWhole},
    {"skeleton", Kind::kWhole},
    {"node", Kind::kWhole},
    {"input", Kind::kWhole},
    {"output", Kind::kWhole},
    {"wrapS", Kind::kWhole},
    {"wrapT", Kind::kWhole},
    {"magFilter", Kind::kWhole},
    {"minFilter", Kind::kWhole},
    {"normalized", Kind::kFlag},
    {"doubleSided", Kind::kFlag},
    {"children", Kind::kList},
    {"nodes", Kind::kList},
    {"primitives", Kind::kList},
    {"joints", Kind::kList},
    {"weights", Kind::kList},
    {"translation", Kind::kList},
    {"matrix", Kind::kList},
    {"baseColorFactor", Kind::kList},
    {"emissiveFactor", Kind::kList},
    {"channels", Kind::kList},
    {"samplers", Kind::kList},
    {"targets", Kind::kList},
    {"extensionsUsed", Kind::kList},
    {"pbrMetallicRoughness", Kind::kObject},
    {"baseColorTexture", Kind::kObject},
    {"metallicRoughnessTexture", Kind::kObject},
    {"normalTexture", Kind::kObject},
    {"occlusionTexture", Kind::kObject},
    {"emissiveTexture", Kind::kObject},
    {"attributes", Kind::kObject},
    {"sparse", Kind::kObject},
}};

std::optional<double> wholeOf(const Json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  if (!object.is_object() || found == object.end() || !found->is_number()) return std::nullopt;
  const double value = *found;
  return value >= 0 && value == std::trunc(value) ? std::optional<double>(value) : std::nullopt;
}

const char* mismatch(const Json& value, Kind kind) {
  switch (kind) {
    case Kind::kText:
      return value.is_string() ? nullptr : "is not a text";
    case Kind::kNumber:
      return value.is_number() ? nullptr : "is not a number";
    case Kind::kWhole:
      return value.is_number() && static_cast<double>(value) >= 0 &&
                     static_cast<double>(value) == std::trunc(static_cast<double>(value))
                 ? nullptr
                 : "is not a whole number of at least 0";
    case Kind::kFlag:
      return value.is_boolean() ? nullptr : "is neither true nor false";
    case Kind::kList:
      return value.is_array() ? nullptr : "is not an array";
    case Kind::kObject:
      return value.is_object() ? nullptr : "is not an object";
  }
  return nullptr;
}

// The content of extras and extensions is not checked. The depth was bounded before.
void checkTypes(const Json& value, const std::string& place, FlawList& flaws) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      if (value[i].is_structured()) checkTypes(value[i], placeOf(place, i), flaws);
    return;
  }
  for (const auto& [key, member] : value.items()) {
    const std::string at = place.empty() ? oneLine(key, 60) : place + "." + oneLine(key, 60);
    if (key == "extras") continue;
    if (key == "extensions") {
      if (!member.is_object())
        flaws.add(at, "is not an object and is ignored");
      else
        for (const auto& [name, extension] : member.items())
          if (!extension.is_object())
            flaws.add(at + "." + oneLine(name, 60), "is not an object and is ignored");
      continue;
    }
    if (key == "scale" && !member.is_array() && !member.is_number()) flaws.add(at, "is not a number");
    if (key == "indices" && !member.is_object()) {
      if (const char* what = mismatch(member, Kind::kWhole)) flaws.add(at, what);
    }
    for (const auto& [name, kind] : kMembers)
      if (key == name)
        if (const char* what = mismatch(member, kind)) flaws.add(at, what);
    if (member.is_structured()) checkTypes(member, at, flaws);
  }
}

struct ElementLayout {
  double component = 0, size = 0;
  bool matrix = false;
};

// Sections 3.6.2.2 and 3.6.2.4 of the specification: the columns of matrices begin at multiples of four
// bytes.
std::optional<ElementLayout> layoutOf(const Json& accessor) {
  const double type = wholeOf(accessor, "componentType").value_or(0);
  ElementLayout layout;
  layout.component = type == 5120 || type == 5121   ? 1
                     : type == 5122 || type == 5123 ? 2
                     : type == 5125 || type == 5126 ? 4
                                                    : 0;
  const auto shape = accessor.find("type");
  if (layout.component == 0 || shape == accessor.end() || !shape->is_string()) return std::nullopt;
  const std::string& text = shape->get_ref<const std::string&>();
  if (text == "SCALAR") layout.size = layout.component;
  for (int n = 2; n <= 4; ++n) {
    if (text == "VEC" + std::to_string(n)) layout.size = n * layout.component;
    if (text == "MAT" + std::to_string(n)) {
      layout.matrix = true;
      layout.size = (n - 1) * std::ceil(n * layout.component / 4) * 4 + n * layout.component;
    }
  }
  return layout.size > 0 ? std::optional<ElementLayout>(layout) : std::nullopt;
}

class RangeCheck {
 public:
  RangeCheck(const Json& root, FlawList& flaws) : root_(root), flaws_(flaws) {}

  void buffers() {
    each("buffers", [&](const Json& buffer, const std::string& place) {
      const auto length = wholeOf(buffer, "byteLength");
      if (!length)
        flaws_.add(place, "has no byteLength");
      else if (*length == 0)
        flaws_.add(place, "has a byteLength of 0");
    });
  }

  void views() {
    each("bufferViews", [&](const Json& view, const std::string& place) {
      const Json* buffer = entry("buffers", wholeOf(view, "buffer"));
      const auto length = wholeOf(view, "byteLength"), stride = wholeOf(view, "byteStride");
      if (!buffer) flaws_.add(place, "names a buffer that does not exist");
      if (!length || *length == 0)
        flaws_.add(place, "has no byteLength above 0");
      else if (buffer &&
               wholeOf(view, "byteOffset").value_or(0) + *length > wholeOf(*buffer, "byteLength").value_or(0))
        flaws_.add(place, "reaches beyond its buffer");
      if (stride && length && *stride > *length) flaws_.add(place, "has a byteStride larger than the view");
      if (stride && wholeOf(view, "target") == 34963.0)
        flaws_.add(place, "has a byteStride, but holds indices");
    });
  }

  void accessors() {
    each("accessors", [&](const Json& accessor, const std::string& place) {
      const std::optional<ElementLayout> layout = layoutOf(accessor);
      const double count = wholeOf(accessor, "count").value_or(0);
      if (count == 0) flaws_.add(place, "has no count above 0");
      const double type = wholeOf(accessor, "componentType").value_or(0);
      if (accessor.contains("normalized") && accessor["normalized"] == true && (type == 5126 || type == 5125))
        flaws_.add(place,
                   "says that its floats or 32-bit integers are normalized; they are read as they stand");
      if (!accessor.contains("bufferView")) {
        if (accessor.contains("byteOffset")) flaws_.add(place, "has a byteOffset but no bufferView");
      } else {
        range(accessor, layout, count, place);
      }
      const auto sparse = accessor.find("sparse");
      if (sparse == accessor.end() || !sparse->is_object()) return;
      const double changed = wholeOf(*sparse, "count").value_or(0);
      if (changed < 1 || changed > count)
        flaws_.add(place + ".sparse", "has a count that is not between 1 and the accessor's");
      for (const char* half : {"indices", "values"}) {
        const auto at = sparse->find(half);
        const std::string where = place + ".sparse." + half;
        const Json* view = at != sparse->end() && at->is_object()
                               ? entry("bufferViews", wholeOf(*at, "bufferView"))
                               : nullptr;
        if (!view)
          flaws_.add(where, "names a bufferView that does not exist");
        else if (view->contains("byteStride"))
          flaws_.add(where, "names a bufferView with a byteStride, which sparse data may not have");
      }
    });
  }

 private:
  template <class Check>
  void each(const char* name, Check check) {
    const auto list = root_.find(name);
    if (list == root_.end() || !list->is_array()) return;
    for (std::size_t i = 0; i < list->size(); ++i)
      if ((*list)[i].is_object()) check((*list)[i], placeOf(name, i));
  }

  const Json* entry(const char* name, std::optional<double> index) const {
    const auto list = root_.find(name);
    if (!index || list == root_.end() || !list->is_array() || *index >= static_cast<double>(list->size()))
      return nullptr;
    const Json& found = (*list)[static_cast<std::size_t>(*index)];
    return found.is_object() ? &found : nullptr;
  }

  void range(const Json& accessor, const std::optional<ElementLayout>& layout, double count,
             const std::string& place) {
    const Json* view = entry("bufferViews", wholeOf(accessor, "bufferView"));
    if (!view) {
      flaws_.add(place, "names a bufferView that does not exist");
      return;
    }
    if (!layout) return;
    const double offset = wholeOf(accessor, "byteOffset").value_or(0),
                 stride = wholeOf(*view, "byteStride").value_or(layout->size);
    const double align = layout->matrix ? 4 : layout->component;
    if (std::fmod(offset, align) != 0 ||
        std::fmod(offset + wholeOf(*view, "byteOffset").value_or(0), align) != 0)
      flaws_.add(place, "is not aligned to the size of its components");
    if (stride < layout->size) flaws_.add(place, "has elements larger than the byteStride of its bufferView");
    if (count > 0 && offset + stride * (count - 1) + layout->size > wholeOf(*view, "byteLength").value_or(0))
      flaws_.add(place, "reaches beyond its bufferView");
  }

  const Json& root_;
  FlawList& flaws_;
};

}  // namespace

std::vector<std::string> findFlaws(const Json& root) {
  FlawList flaws;
  for (const auto& [key, member] : root.items())
    if (member.is_array() && member.empty())
      flaws.add(oneLine(key, 60), "is an empty array, which glTF does not have");
  checkTypes(root, "", flaws);
  RangeCheck ranges(root, flaws);
  ranges.buffers();
  ranges.views();
  ranges.accessors();
  return flaws.lines();
}

std::set<int> hideUnknownAccessors(Json& root) {
  std::set<int> hidden;
  const auto list = root.find("accessors");
  if (list == root.end() || !list->is_array()) return hidden;
  for (std::size_t i = 0; i < list->size(); ++i) {
    Json& accessor = (*list)[i];
    if (!accessor.is_object() || !accessor.contains("type") || !accessor["type"].is_string() ||
        !wholeOf(accessor, "componentType") || layoutOf(accessor))
      continue;
    accessor = {{"type", "SCALAR"}, {"componentType", 5126}, {"count", 1}};
    hidden.insert(static_cast<int>(i));
  }
  return hidden;
}

}  // namespace kelp::bake
