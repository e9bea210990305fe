// SPDX-License-Identifier: MIT
#include "rig_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <imgui.h>

#include "panel_colors.h"
#include "rig_knots.h"

namespace viewer {
namespace {

using kelp::Interpolation;
using kelp::RigDescription;
using kelp::Target;

constexpr float kSpeed = 0.002f;  // of lengths, a pixel of drag

const char* const kAxes[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
const char* const kTargets[] = {"offset", "tangent", "translation", "rotation", "scale"};
const char* const kInterpolations[] = {"step", "linear", "cubic"};

// Beside the window: it hides no number.
void tip(const char* text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::SetNextWindowPos({ImGui::GetWindowPos().x - 20, ImGui::GetItemRectMin().y}, ImGuiCond_Always, {1, 0});
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(26 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool choose(const char* label, int& index, const char* const* names, int count, float width) {
  ImGui::SetNextItemWidth(width);
  return ImGui::Combo(label, &index, names, count);
}

bool chooseKnot(const char* label, int& knot, std::size_t knots) {
  char shown[16];
  std::snprintf(shown, sizeof shown, "knot %d", knot);
  bool changed = false;
  ImGui::SetNextItemWidth(82);
  if (!ImGui::BeginCombo(label, shown)) return false;
  for (int i = 0; i < static_cast<int>(knots); ++i) {
    std::snprintf(shown, sizeof shown, "knot %d", i);
    if (ImGui::Selectable(shown, i == knot)) changed = knot != i, knot = i;
  }
  ImGui::EndCombo();
  return changed;
}

bool drag3(const char* label, glm::vec3& v) {
  ImGui::SetNextItemWidth(230);
  return ImGui::DragFloat3(label, &v.x, kSpeed, -1e6f, 1e6f, "%.3f");
}

bool dragNumber(const char* label, float& v, float speed, float least, float most, const char* format) {
  ImGui::SetNextItemWidth(96);
  return ImGui::DragFloat(label, &v, speed, least, most, format, ImGuiSliderFlags_AlwaysClamp);
}

// What the functions below change; the editor is asked once all is drawn.
struct Draft {
  RigDescription rig;
  bool changed = false;
};

glm::mat3 toArtist(const RigDescription& rig) { return glm::transpose(kelp::axisRotation(rig.axis.value_or(kelp::Axis::kPlusY))); }

void drawKnot(Draft& draft, int index) {
  RigDescription::Knot& knot = draft.rig.knots[static_cast<std::size_t>(index)];
  const int count = static_cast<int>(draft.rig.knots.size());
  const bool inner = index > 0 && index + 1 < count;
  ImGui::PushID(index);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored({1, 0.78f, 0.24f, 1}, "knot %d", index);
  ImGui::SameLine(70);
  if (inner) {
    const float before = draft.rig.knots[static_cast<std::size_t>(index - 1)].at, after = draft.rig.knots[static_cast<std::size_t>(index + 1)].at;
    draft.changed |= dragNumber("at", knot.at, kSpeed, before + 0.01f, after - 0.01f, "%.3f");
    tip("Where along the axis: 0 is the first knot, 1 the last.");
    ImGui::SameLine();
    if (ImGui::SmallButton("remove")) {
      removeKnot(draft.rig, index);
      draft.changed = true;
      ImGui::PopID();
      return;
    }
    tip("The knot, with the waves and keys that move it.");
  } else {
    ImGui::TextDisabled("at %.0f", static_cast<double>(knot.at));
  }
  if (index + 1 < count && count < kelp::kMaxKnots) {
    ImGui::SameLine();
    if (ImGui::SmallButton("add next")) {
      insertKnot(draft.rig, index);
      draft.changed = true;
      ImGui::PopID();
      return;
    }
    tip("A knot half way to the next one, on the spline.");
  }
  draft.changed |= drag3("offset", knot.offset);
  tip("From the straight rig's place, in the file's axes; 1 is the model's length along the axis. Drag, or double-click and type.");
  glm::vec3 tangent = knot.tangent.value_or(glm::vec3(0));
  if (!knot.tangent) {  // shown as it is; written down once somebody touches it
    const std::vector<kelp::Knot> knots = kelp::realizeKnots(draft.rig, glm::ivec3(1));
    tangent = toArtist(draft.rig) * knots[static_cast<std::size_t>(index)].tangent;
  }
  if (drag3("tangent", tangent)) {
    knot.tangent = tangent;
    draft.changed = true;
  }
  tip("Where the spline goes from here, and how strongly: of length 1 along the axis in a straight rig.");
  ImGui::SameLine();
  bool automatic = !knot.tangent;
  if (ImGui::Checkbox("auto", &automatic)) {
    knot.tangent = automatic ? std::optional<glm::vec3>() : tangent;
    draft.changed = true;
  }
  tip("From the neighbours (Catmull-Rom).");
  ImGui::PopID();
}

// False: it is to go.
bool drawWave(Draft& draft, RigDescription::Wave& wave, int index) {
  ImGui::PushID(index);
  ImGui::Separator();
  draft.changed |= chooseKnot("##knot", wave.knot, draft.rig.knots.size());
  ImGui::SameLine();
  int target = wave.target == Target::kKnotTangent ? 1 : 0;
  if (choose("##target", target, kTargets, 2, 82)) {
    wave.target = target == 1 ? Target::kKnotTangent : Target::kKnotOffset;
    draft.changed = true;
  }
  ImGui::SameLine(300);
  const bool stays = !ImGui::SmallButton("remove");
  draft.changed |= drag3("amplitude", wave.amplitude);
  tip("What is added at the wave's height, in the file's axes; 1 is the model's length along the axis.");
  draft.changed |= dragNumber("period", wave.period, 0.01f, 0.05f, 1e3f, "%.2f s");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(96);
  draft.changed |= ImGui::SliderFloat("phase", &wave.phase, -1, 1, "%.2f turns");
  tip("A part of the period by which it is ahead.");
  ImGui::PopID();
  return stays;
}

bool drawValue(Target target, glm::vec4& value) {
  ImGui::SetNextItemWidth(190);
  if (target == Target::kPartRotation) {
    if (!ImGui::DragFloat4("##value", &value.x, kSpeed, -1, 1, "%.3f")) return false;
    const float length = glm::length(value);
    value = length > 1e-3f ? value / length : glm::vec4(0, 0, 0, 1);
    return true;
  }
  glm::vec3 shown = glm::vec3(value) + (target == Target::kPartScale ? 1.0f : 0.0f);
  if (!ImGui::DragFloat3("##value", &shown.x, kSpeed, -1e6f, 1e6f, "%.3f")) return false;
  value = glm::vec4(shown - (target == Target::kPartScale ? 1.0f : 0.0f), 0);
  return true;
}

// Keys of a track in the order of their times. False: the track is to go.
bool drawTrack(Draft& draft, RigDescription::Track& track, int index, double now, float duration) {
  ImGui::PushID(1000 + index);
  ImGui::Separator();
  char name[40];
  if (movesKnot(track.target)) std::snprintf(name, sizeof name, "%s of knot %d", kTargets[static_cast<int>(track.target)], track.knot);
  else std::snprintf(name, sizeof name, "%s", kTargets[static_cast<int>(track.target)]);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(name);
  ImGui::SameLine(150);
  int kind = static_cast<int>(track.interpolation);
  if (choose("##interpolation", kind, kInterpolations, 3, 82)) {
    track.interpolation = static_cast<Interpolation>(kind);
    for (RigDescription::Key& key : track.keys) key.in = key.out = std::nullopt;
    draft.changed = true;
  }
  tip("Cubic keys get smooth slopes of themselves.");
  ImGui::SameLine();
  if (ImGui::SmallButton("key here")) {
    const float at = duration > 0 ? static_cast<float>(now - duration * std::floor(now / duration)) : static_cast<float>(now);
    const auto after = std::find_if(track.keys.begin(), track.keys.end(), [&](const auto& key) { return key.time >= at - 0.01f; });
    if (after == track.keys.end() || after->time > at + 0.01f) {
      RigDescription::Key key = after != track.keys.end() ? *after : track.keys.back();
      key.time = at;
      key.in = key.out = std::nullopt;
      track.keys.insert(after, key);
      draft.changed = true;
    }
  }
  tip("A key at the second that is shown, with the value of the next one.");
  ImGui::SameLine(300);
  bool stays = !ImGui::SmallButton("remove");
  for (std::size_t i = 0; i < track.keys.size(); ++i) {
    RigDescription::Key& key = track.keys[i];
    ImGui::PushID(static_cast<int>(i));
    const float least = i > 0 ? track.keys[i - 1].time + 0.01f : 0.0f, most = i + 1 < track.keys.size() ? track.keys[i + 1].time - 0.01f : 1e3f;
    ImGui::SetNextItemWidth(70);
    draft.changed |= ImGui::DragFloat("##time", &key.time, 0.01f, least, most, "%.2f s", ImGuiSliderFlags_AlwaysClamp);
    ImGui::SameLine();
    draft.changed |= drawValue(track.target, key.value);
    ImGui::SameLine();
    if (ImGui::SmallButton("x")) {
      track.keys.erase(track.keys.begin() + static_cast<std::ptrdiff_t>(i));
      draft.changed = true;
      ImGui::PopID();
      break;
    }
    ImGui::PopID();
  }
  ImGui::PopID();
  stays = stays && !track.keys.empty();
  draft.changed |= !stays;
  return stays;
}

void drawTravelling(Draft& draft, RigDescription::Clip& clip, TravellingWave& wave) {
  if (!ImGui::TreeNode("a wave along all knots")) return;
  drag3("first knot", wave.first);
  drag3("last knot", wave.last);
  dragNumber("period##travelling", wave.period, 0.01f, 0.05f, 1e3f, "%.2f s");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(96);
  ImGui::SliderFloat("waves##travelling", &wave.turns, -3, 3, "%.2f");
  tip("How many fit between the first and the last knot; less than 0: it runs towards the first.");
  if (ImGui::Button("Replace the waves")) {
    clip.waves = wavesOf(wave, draft.rig.knots);
    draft.changed = !clip.waves.empty();
  }
  tip("Two waves a knot, of its place and of its tangent. Three to five knots make it smooth.");
  ImGui::TreePop();
}

std::string freshName(const RigDescription& rig) {
  for (int i = 1;; ++i) {
    std::string name = i == 1 ? "clip" : "clip " + std::to_string(i);
    if (std::none_of(rig.clips.begin(), rig.clips.end(), [&](const auto& clip) { return clip.name == name; })) return name;
  }
}

void drawClipChoice(Draft& draft, RigPanel& panel) {
  std::vector<RigDescription::Clip>& clips = draft.rig.clips;
  panel.clip = std::clamp(panel.clip, 0, std::max(static_cast<int>(clips.size()) - 1, 0));
  ImGui::SetNextItemWidth(130);
  if (ImGui::BeginCombo("##clips", clips.empty() ? "no clips" : clips[static_cast<std::size_t>(panel.clip)].name.c_str())) {
    for (int i = 0; i < static_cast<int>(clips.size()); ++i) {
      if (ImGui::Selectable((clips[static_cast<std::size_t>(i)].name + "##" + std::to_string(i)).c_str(), i == panel.clip)) {
        panel.clip = i;
        panel.play = clips[static_cast<std::size_t>(i)].name;
      }
    }
    ImGui::EndCombo();
  }
  tip("The clip to edit. Choosing one plays it alone.");
  ImGui::SameLine();
  if (ImGui::SmallButton("new clip")) {
    clips.push_back(swayOf(draft.rig, freshName(draft.rig)));
    panel.clip = static_cast<int>(clips.size()) - 1;
    panel.play = clips.back().name;
    draft.changed = true;
  }
  tip("Sways as plants do, to begin with.");
  if (clips.empty()) return;
  ImGui::SameLine();
  if (ImGui::SmallButton("remove clip")) {
    clips.erase(clips.begin() + panel.clip);
    draft.changed = true;
  }
}

void drawAddTrack(Draft& draft, RigDescription::Clip& clip) {
  if (ImGui::SmallButton("add keys")) ImGui::OpenPopup("track");
  if (!ImGui::BeginPopup("track")) return;
  const auto offer = [&](const char* label, int knot, Target target) {
    const bool taken = std::any_of(clip.tracks.begin(), clip.tracks.end(), [&](const auto& track) { return track.target == target && track.knot == knot; });
    if (taken || !ImGui::Selectable(label)) return;
    const glm::vec4 rest = target == Target::kPartRotation ? glm::vec4(0, 0, 0, 1) : glm::vec4(0);
    clip.tracks.push_back({knot, target, Interpolation::kLinear, {{0, rest, {}, {}}, {1, rest, {}, {}}}});
    draft.changed = true;
  };
  for (int knot = 0; knot < static_cast<int>(draft.rig.knots.size()); ++knot) {
    for (const Target target : {Target::kKnotOffset, Target::kKnotTangent}) {
      const std::string label = std::string(kTargets[static_cast<int>(target)]) + " of knot " + std::to_string(knot);
      offer(label.c_str(), knot, target);
    }
  }
  for (const Target target : {Target::kPartTranslation, Target::kPartRotation, Target::kPartScale}) offer(kTargets[static_cast<int>(target)], 0, target);
  ImGui::EndPopup();
}

void drawClip(Draft& draft, RigPanel& panel, double now) {
  RigDescription::Clip& clip = draft.rig.clips[static_cast<std::size_t>(panel.clip)];
  char name[256];
  std::snprintf(name, sizeof name, "%s", clip.name.c_str());
  ImGui::SetNextItemWidth(130);
  if (ImGui::InputText("name", name, sizeof name, ImGuiInputTextFlags_EnterReturnsTrue) && name[0] != 0) {
    clip.name = name;
    draft.changed = true;
  }
  tip("Enter takes it.");
  ImGui::SameLine();
  float duration = clip.duration.value_or(0);
  if (dragNumber("long", duration, 0.01f, 0, 1e3f, duration > 0 ? "%.2f s" : "auto")) {
    clip.duration = duration >= 0.001f ? std::optional(duration) : std::nullopt;
    draft.changed = true;
  }
  tip("After so many seconds keys repeat. 0: as long as the last key, or the longest wave.");

  for (std::size_t i = 0; i < clip.waves.size(); ++i) {
    if (drawWave(draft, clip.waves[i], static_cast<int>(i))) continue;
    clip.waves.erase(clip.waves.begin() + static_cast<std::ptrdiff_t>(i));
    draft.changed = true;
    break;
  }
  for (std::size_t i = 0; i < clip.tracks.size(); ++i) {
    if (drawTrack(draft, clip.tracks[i], static_cast<int>(i), now, duration)) continue;
    clip.tracks.erase(clip.tracks.begin() + static_cast<std::ptrdiff_t>(i));
    break;
  }
  ImGui::Separator();
  if (ImGui::SmallButton("add wave")) {
    const RigDescription::Wave like = clip.waves.empty() ? RigDescription::Wave{static_cast<int>(draft.rig.knots.size()) - 1, Target::kKnotOffset, {}, 3, 0} : clip.waves.back();
    clip.waves.push_back(like);
    clip.waves.back().amplitude = glm::vec3(0);
    draft.changed = true;
  }
  ImGui::SameLine();
  drawAddTrack(draft, clip);
  drawTravelling(draft, clip, panel.wave);
  if (clip.waves.empty() && clip.tracks.empty()) {
    draft.rig.clips.erase(draft.rig.clips.begin() + panel.clip);
    draft.changed = true;
  }
}

void drawHead(RigPanel& panel, RigEditor& editor, const std::function<void()>& save) {
  if (editor.parts() > 1) {
    ImGui::SetNextItemWidth(200);
    if (ImGui::BeginCombo("part", editor.name(panel.part).c_str())) {
      for (int i = 0; i < editor.parts(); ++i) {
        if (ImGui::Selectable((editor.name(i) + "##" + std::to_string(i)).c_str(), i == panel.part)) panel.part = i, panel.path.clear();
      }
      ImGui::EndCombo();
    }
  }
  const auto button = [](const char* label, bool live) {
    if (live) return ImGui::Button(label);
    ImGui::BeginDisabled();
    ImGui::Button(label);
    ImGui::EndDisabled();
    return false;
  };
  if (button("Undo", editor.canUndo())) editor.undo();
  ImGui::SameLine();
  if (button("Redo", editor.canRedo())) editor.redo();
  ImGui::SameLine();
  if (ImGui::Button("Reset")) editor.reset(panel.part);
  tip("The rig that the pack has.");
  ImGui::SameLine();
  if (ImGui::Button("Save rig")) save();
  ImGui::SameLine();
  if (editor.unsaved(panel.part)) ImGui::TextColored(kUnsaved, "not saved");
  else ImGui::TextDisabled("nothing to save");
  char path[1024];
  std::snprintf(path, sizeof path, "%s", panel.path.c_str());
  ImGui::SetNextItemWidth(-1);
  if (ImGui::InputText("##path", path, sizeof path)) panel.path = path;
  tip("Where Save rig writes, for kelp-bake --rig.");
}

}  // namespace

void drawRigPanel(RigPanel& panel, RigEditor& editor, double now, const std::function<void()>& save) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x - 12, 12}, ImGuiCond_FirstUseEver, {1, 0});
  ImGui::SetNextWindowSize({380, std::max(screen.y - 24, 200.0f)}, ImGuiCond_FirstUseEver);
  bool open = true;
  if (ImGui::Begin("rig", &open)) {
    drawHead(panel, editor, save);
    ImGui::PushTextWrapPos(0);
    if (!panel.said.empty()) ImGui::TextColored(panel.refused ? kBad : kGood, "%s", panel.said.c_str());
    if (const std::string& trouble = editor.axes(panel.part).trouble; !trouble.empty()) ImGui::TextDisabled("%s", trouble.c_str());
    ImGui::PopTextWrapPos();

    ImGui::BeginChild("rest");
    Draft draft{editor.rig(panel.part)};
    if (ImGui::CollapsingHeader("Knots", ImGuiTreeNodeFlags_DefaultOpen)) {
      ImGui::TextDisabled("along %s of the file, 1 = its length there", kAxes[static_cast<int>(draft.rig.axis.value_or(kelp::Axis::kPlusY))]);
      for (int knot = 0; knot < static_cast<int>(draft.rig.knots.size()); ++knot) drawKnot(draft, knot);
    }
    if (ImGui::CollapsingHeader("Clips", ImGuiTreeNodeFlags_DefaultOpen)) {
      drawClipChoice(draft, panel);
      if (!draft.rig.clips.empty() && panel.clip < static_cast<int>(draft.rig.clips.size())) drawClip(draft, panel, now);
    }
    ImGui::EndChild();
    if (draft.changed) {
      panel.said = editor.change(panel.part, draft.rig);
      panel.refused = !panel.said.empty();
    }
  }
  ImGui::End();
  panel.closed = !open;
}

}  // namespace viewer
