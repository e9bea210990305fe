// SPDX-License-Identifier: MIT
#include "window/rig_controls.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <imgui.h>

#include "rig_knots.h"

namespace kelp::view {
namespace {

// False: the user removes the wave.
bool drawWave(Draft& draft, RigDescription::Wave& wave, int index) {
  ImGui::PushID(index);
  ImGui::Separator();
  draft.changed |= chooseKnot("##knot", wave.knot, draft.rig.knots.size());
  ImGui::SameLine();
  int target = wave.target == Target::kKnotTangent ? 1 : 0;
  if (choose("##target", target, kTargetNames, 2, 82)) {
    wave.target = target == 1 ? Target::kKnotTangent : Target::kKnotOffset;
    draft.changed = true;
  }
  ImGui::SameLine(300);
  const bool stays = !ImGui::SmallButton("remove");
  draft.changed |= dragLengths("amplitude", wave.amplitude);
  tip("What the wave adds where it is highest, in the file's axes. 1 is the model's length along the axis.");
  draft.changed |= dragNumber("period", wave.period, 0.01f, 0.05f, 1e3f, "%.2f s");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(96);
  draft.changed |= ImGui::SliderFloat("phase", &wave.phase, -1, 1, "%.2f turns");
  tip("How far the wave is ahead, in periods.");
  ImGui::PopID();
  return stays;
}

bool drawValue(Target target, glm::vec4& value) {
  ImGui::SetNextItemWidth(190);
  if (target == Target::kPartRotation) {
    if (!ImGui::DragFloat4("##value", &value.x, kLengthsPerPixel, -1, 1, "%.3f")) return false;
    const float length = glm::length(value);
    value = length > 1e-3f ? value / length : glm::vec4(0, 0, 0, 1);
    return true;
  }
  glm::vec3 shown = glm::vec3(value) + (target == Target::kPartScale ? 1.0f : 0.0f);
  if (!ImGui::DragFloat3("##value", &shown.x, kLengthsPerPixel, -1e6f, 1e6f, "%.3f")) return false;
  value = glm::vec4(shown - (target == Target::kPartScale ? 1.0f : 0.0f), 0);
  return true;
}

// Adds a key at the time `at`, with the value of the next key, unless there is one already.
void insertKey(Draft& draft, RigDescription::Track& track, float at) {
  constexpr float kLeastGap = 0.01f;  // seconds between two keys
  const auto after = std::find_if(track.keys.begin(), track.keys.end(),
                                  [&](const auto& key) { return key.time >= at - kLeastGap; });
  if (after != track.keys.end() && after->time <= at + kLeastGap) return;
  RigDescription::Key key = after != track.keys.end() ? *after : track.keys.back();
  key.time = at;
  key.in = key.out = std::nullopt;
  track.keys.insert(after, key);
  draft.changed = true;
}

// The keys of a track, in the order of their times.
void drawKeys(Draft& draft, RigDescription::Track& track) {
  for (std::size_t i = 0; i < track.keys.size(); ++i) {
    RigDescription::Key& key = track.keys[i];
    ImGui::PushID(static_cast<int>(i));
    const float least = i > 0 ? track.keys[i - 1].time + 0.01f : 0.0f,
                most = i + 1 < track.keys.size() ? track.keys[i + 1].time - 0.01f : 1e3f;
    ImGui::SetNextItemWidth(70);
    draft.changed |=
        ImGui::DragFloat("##time", &key.time, 0.01f, least, most, "%.2f s", ImGuiSliderFlags_AlwaysClamp);
    ImGui::SameLine();
    draft.changed |= drawValue(track.target, key.value);
    ImGui::SameLine();
    const bool removed = ImGui::SmallButton("x");
    ImGui::PopID();
    if (removed) {
      track.keys.erase(track.keys.begin() + static_cast<std::ptrdiff_t>(i));
      draft.changed = true;
      return;
    }
  }
}

// False: the user removes the track.
bool drawTrack(Draft& draft, RigDescription::Track& track, int index, double now, float duration) {
  ImGui::PushID(1000 + index);
  ImGui::Separator();
  char name[40];
  if (movesKnot(track.target))
    std::snprintf(name, sizeof name, "%s of knot %d", kTargetNames[static_cast<int>(track.target)],
                  track.knot);
  else
    std::snprintf(name, sizeof name, "%s", kTargetNames[static_cast<int>(track.target)]);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(name);
  ImGui::SameLine(150);
  int kind = static_cast<int>(track.interpolation);
  if (choose("##interpolation", kind, kInterpolationNames, 3, 82)) {
    track.interpolation = static_cast<Interpolation>(kind);
    for (RigDescription::Key& key : track.keys) key.in = key.out = std::nullopt;
    draft.changed = true;
  }
  tip("Cubic keys get smooth slopes by themselves.");
  ImGui::SameLine();
  if (ImGui::SmallButton("key here")) {
    const double at = duration > 0 ? now - duration * std::floor(now / duration) : now;
    insertKey(draft, track, static_cast<float>(at));
  }
  tip("Adds a key at the second that is shown, with the value of the next key.");
  ImGui::SameLine(300);
  bool stays = !ImGui::SmallButton("remove");
  drawKeys(draft, track);
  ImGui::PopID();
  stays = stays && !track.keys.empty();
  draft.changed |= !stays;
  return stays;
}

void drawTravelling(Draft& draft, RigDescription::Clip& clip, TravellingWave& wave) {
  if (!ImGui::TreeNode("a wave along all knots")) return;
  dragLengths("first knot", wave.first);
  dragLengths("last knot", wave.last);
  dragNumber("period##travelling", wave.period, 0.01f, 0.05f, 1e3f, "%.2f s");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(96);
  ImGui::SliderFloat("waves##travelling", &wave.turns, -3, 3, "%.2f");
  tip("How many waves fit between the first and the last knot. Less than 0: they run towards the first.");
  if (ImGui::Button("Replace the waves")) {
    clip.waves = wavesOf(wave, draft.rig.knots);
    draft.changed = !clip.waves.empty();
  }
  tip("Makes two waves for each knot: one for its place, one for its tangent. Three to five knots are "
      "smooth.");
  ImGui::TreePop();
}

std::string freshName(const RigDescription& rig) {
  for (int i = 1;; ++i) {
    std::string name = i == 1 ? "clip" : "clip " + std::to_string(i);
    if (std::none_of(rig.clips.begin(), rig.clips.end(), [&](const auto& clip) { return clip.name == name; }))
      return name;
  }
}

void drawAddTrack(Draft& draft, RigDescription::Clip& clip) {
  if (ImGui::SmallButton("add keys")) ImGui::OpenPopup("track");
  if (!ImGui::BeginPopup("track")) return;
  const auto offer = [&](const char* label, int knot, Target target) {
    const bool taken = std::any_of(clip.tracks.begin(), clip.tracks.end(), [&](const auto& track) {
      return track.target == target && track.knot == knot;
    });
    if (taken || !ImGui::Selectable(label)) return;
    const glm::vec4 rest = target == Target::kPartRotation ? glm::vec4(0, 0, 0, 1) : glm::vec4(0);
    clip.tracks.push_back({knot, target, Interpolation::kLinear, {{0, rest, {}, {}}, {1, rest, {}, {}}}});
    draft.changed = true;
  };
  for (int knot = 0; knot < static_cast<int>(draft.rig.knots.size()); ++knot) {
    for (const Target target : {Target::kKnotOffset, Target::kKnotTangent}) {
      const std::string label =
          std::string(kTargetNames[static_cast<int>(target)]) + " of knot " + std::to_string(knot);
      offer(label.c_str(), knot, target);
    }
  }
  for (const Target target : {Target::kPartTranslation, Target::kPartRotation, Target::kPartScale})
    offer(kTargetNames[static_cast<int>(target)], 0, target);
  ImGui::EndPopup();
}

RigDescription::Wave newWave(const RigDescription& rig, const RigDescription::Clip& clip) {
  const int last_knot = static_cast<int>(rig.knots.size()) - 1;
  RigDescription::Wave wave =
      clip.waves.empty() ? RigDescription::Wave{last_knot, Target::kKnotOffset, {}, 3, 0} : clip.waves.back();
  wave.amplitude = glm::vec3(0);
  return wave;
}

}  // namespace

void drawClipChoice(Draft& draft, ClipPanel& panel) {
  std::vector<RigDescription::Clip>& clips = draft.rig.clips;
  panel.clip = std::clamp(panel.clip, 0, std::max(static_cast<int>(clips.size()) - 1, 0));
  ImGui::SetNextItemWidth(130);
  if (ImGui::BeginCombo(
          "##clips", clips.empty() ? "no clips" : clips[static_cast<std::size_t>(panel.clip)].name.c_str())) {
    for (int i = 0; i < static_cast<int>(clips.size()); ++i) {
      if (ImGui::Selectable((clips[static_cast<std::size_t>(i)].name + "##" + std::to_string(i)).c_str(),
                            i == panel.clip)) {
        panel.clip = i;
        panel.play = clips[static_cast<std::size_t>(i)].name;
      }
    }
    ImGui::EndCombo();
  }
  tip("The clip to edit. Choose one to play it alone.");
  ImGui::SameLine();
  if (ImGui::SmallButton("new clip")) {
    clips.push_back(swayOf(draft.rig, freshName(draft.rig)));
    panel.clip = static_cast<int>(clips.size()) - 1;
    panel.play = clips.back().name;
    draft.changed = true;
  }
  tip("Makes a clip that sways like a plant.");
  if (clips.empty()) return;
  ImGui::SameLine();
  if (ImGui::SmallButton("remove clip")) {
    clips.erase(clips.begin() + panel.clip);
    draft.changed = true;
  }
}

void drawClip(Draft& draft, ClipPanel& panel, double now) {
  RigDescription::Clip& clip = draft.rig.clips[static_cast<std::size_t>(panel.clip)];
  char name[256];
  std::snprintf(name, sizeof name, "%s", clip.name.c_str());
  ImGui::SetNextItemWidth(130);
  if (ImGui::InputText("name", name, sizeof name, ImGuiInputTextFlags_EnterReturnsTrue) && name[0] != 0) {
    clip.name = name;
    draft.changed = true;
  }
  tip("Press Enter to rename the clip.");
  ImGui::SameLine();
  float duration = clip.duration.value_or(0);
  if (dragNumber("long", duration, 0.01f, 0, 1e3f, duration > 0 ? "%.2f s" : "auto")) {
    clip.duration = duration >= 0.001f ? std::optional(duration) : std::nullopt;
    draft.changed = true;
  }
  tip("The keys repeat after this many seconds. 0: as long as the last key or the longest wave.");

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
    clip.waves.push_back(newWave(draft.rig, clip));
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

}  // namespace kelp::view
