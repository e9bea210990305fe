// SPDX-License-Identifier: MIT
// kelp-view's --watch without its window: which changes count, what is baked, what is said.
#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <iterator>

#include "arguments.h"
#include "support/scratch.h"
#include "workshop.h"

namespace kelp::view {
namespace {

constexpr double kStep = FileWatch::kInterval;

TEST(FileWatch, SeesEveryWayToSaveOnceItStandsStill) {
  const test::Scratch scratch;
  const std::string path = scratch.write("reed.glb", "one").string();
  FileWatch watch;
  watch.watch({path});
  double now = 0;
  const auto look = [&] { return watch.changed(now += kStep); };
  EXPECT_FALSE(look());

  scratch.write("reed.glb", "two two");  // in place
  EXPECT_FALSE(look()) << "may still be written";
  scratch.write("reed.glb", "two two two");
  EXPECT_FALSE(look());
  EXPECT_TRUE(look());
  EXPECT_FALSE(look());

  std::filesystem::rename(scratch.write("new", "two two two"), path);  // beside, then renamed: the same size
  look();
  EXPECT_TRUE(look());

  std::filesystem::remove(path);
  look();
  EXPECT_TRUE(look());
  scratch.write("reed.glb", "back");
  look();
  EXPECT_TRUE(look());
  EXPECT_FALSE(look());

  scratch.write("reed.glb", "mine");
  watch.accept();
  EXPECT_FALSE(look());
  EXPECT_FALSE(look());
}

TEST(FileWatch, AFileThatChangedWhileItWasReadIsChanged) {
  const test::Scratch scratch;
  const std::int64_t before = FileWatch::clock() - 1000000000;
  const std::string path = scratch.write("bark.png", "one").string();
  FileWatch late, early;
  late.watch({path}, before);
  early.watch({path}, FileWatch::clock() + 1000000000);
  EXPECT_TRUE(late.changed(0));
  EXPECT_FALSE(early.changed(0));
}

TEST(Dependencies, AreReadAsMakeDoes) {
  using Files = std::vector<std::string>;
  EXPECT_EQ(readDependencies("out.kelp: \\\n  reed.glb \\\n  bark.png\n"), (Files{"reed.glb", "bark.png"}));
  EXPECT_EQ(readDependencies("my\\ out.kelp: \\\n  a\\ b.glb \\\n  c$$d\\#e.png\n"),
            (Files{"a b.glb", "c$d#e.png"}));
  EXPECT_EQ(readDependencies("a:b.kelp: c:d.glb\n"), (Files{"c:d.glb"}));
  EXPECT_EQ(readDependencies("out.kelp:\n"), Files{});
  EXPECT_EQ(readDependencies(""), Files{});
}

// A kelp-bake of a few lines: notes its words, says how far it is, reads texture.png, fails if the source
// says so.
class WorkshopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    source_ = scratch_.write("reed.glb", "good").string();
    scratch_.write("texture.png", "green");
    program_ = scratch_
                   .write("tools/kelp-bake", R"(#!/bin/sh
here=$(dirname "$1")
echo "$@" >> "$here/log"
echo '{"kind":"progress","stage":"voxelize","done":0.25,"seconds":1}' >&2
case $(cat "$1") in
  bad) echo '{"kind":"error","exit":3,"text":"'"$1"': is bad; mend it"}' >&2; exit 3;;
  slow) trap 'exit 130' TERM; i=0; while [ $i -lt 200 ]; do sleep 0.05; i=$((i + 1)); done;;
  probing) touch "$here/.probe"; rm "$here/.probe"; sleep 0.3;;
esac
echo packed > "$3"
printf '%s: \\\n  %s \\\n  %s\n' "$3" "$1" "$here/texture.png" > "$7"
echo '{"kind":"note","text":"wrote '"$3"'"}' >&2
)")
                   .string();
    std::filesystem::permissions(program_, std::filesystem::perms::owner_all);
  }

  BakeOrder order(const std::string& rig = "") const {
    return {source_, {"--resolution", "64"}, (scratch_ / "reed.kelp").string(), rig};
  }

  // Until there is news, or nothing comes for so many looks.
  Workshop::News wait(Workshop& workshop, int looks = 400) {
    for (int i = 0; i < looks; ++i) {
      now_ += kStep / 4;
      if (const auto news = workshop.update(now_); news != Workshop::News::kNothing) return news;
      if (workshop.baking()) ::usleep(5000);
    }
    return Workshop::News::kNothing;
  }

  std::vector<std::string> log() const {
    std::ifstream file(scratch_ / "log");
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }

  const test::Scratch scratch_;
  std::string source_, program_;
  double now_ = 0;
};

TEST_F(WorkshopTest, BakesAtOnceAndAgainWhenAnythingItReadChanges) {
  Workshop workshop(order(), program_);
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  ASSERT_EQ(log().size(), 1u);
  EXPECT_TRUE(
      log()[0].starts_with(source_ + " -o " + (scratch_ / "reed.kelp").string() + " --progress json -MF "))
      << log()[0];
  EXPECT_TRUE(log()[0].ends_with(" --resolution 64"));
  EXPECT_EQ(workshop.job().stage(), "voxelize");
  EXPECT_EQ(workshop.job().text(), "kelp-bake: wrote " + (scratch_ / "reed.kelp").string() + "\n")
      << "progress left out";
  EXPECT_EQ(wait(workshop, 40), Workshop::News::kNothing);

  scratch_.write("texture.png", "brown");
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  std::filesystem::rename(scratch_.write("new", "good too"), source_);
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  scratch_.write("reed.rig.json", "{}");  // which kelp-bake would find
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  EXPECT_EQ(wait(workshop, 40), Workshop::News::kNothing);
  EXPECT_EQ(log().size(), 4u);
}

TEST_F(WorkshopTest, ABakeThatFailsSaysWhyAndIsTriedAgain) {
  scratch_.write("reed.glb", "bad");
  Workshop workshop(order(), program_);
  EXPECT_EQ(wait(workshop), Workshop::News::kFailed);
  EXPECT_EQ(workshop.error(), "kelp-bake: " + source_ + ": is bad; mend it");
  EXPECT_EQ(workshop.exitCode(), 3);
  EXPECT_EQ(wait(workshop, 40), Workshop::News::kNothing);
  scratch_.write("missing.bin", "");  // something it asked for comes
  EXPECT_EQ(wait(workshop), Workshop::News::kFailed);
  scratch_.write("reed.glb", "good");
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  EXPECT_EQ(workshop.error(), "");

  std::filesystem::remove(source_);
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked) << "the fake does not mind";
}

// The real one tries whether it may write there before it begins.
TEST_F(WorkshopTest, WhatABakeMakesInTheFolderIsNoChange) {
  scratch_.write("reed.glb", "bad");
  Workshop workshop(order(), program_);
  EXPECT_EQ(wait(workshop), Workshop::News::kFailed);
  scratch_.write("reed.glb", "probing");
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  EXPECT_EQ(log().size(), 2u);
}

TEST_F(WorkshopTest, AChangeInTheMidstOfABakeBeginsItAnew) {
  scratch_.write("reed.glb", "slow");
  Workshop workshop(order(), program_);
  EXPECT_EQ(wait(workshop, 20), Workshop::News::kNothing);
  EXPECT_TRUE(workshop.baking());
  scratch_.write("reed.glb", "good");
  EXPECT_EQ(wait(workshop), Workshop::News::kBaked);
  EXPECT_EQ(log().size(), 2u);
}

TEST_F(WorkshopTest, TheBakeEndsWithTheViewer) {
  scratch_.write("reed.glb", "slow");
  {
    Workshop workshop(order(), program_);
    wait(workshop, 20);
    EXPECT_TRUE(workshop.job().running());
  }
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "reed.kelp")) << "it was waited for";
}

TEST_F(WorkshopTest, ASavedRigIsBakedWhateverTheRigWasBefore) {
  const std::string beside = (scratch_ / "reed.rig.json").string();
  Workshop preset(order("sway"), program_);
  EXPECT_EQ(wait(preset), Workshop::News::kBaked);
  EXPECT_NE(log().back().find(" --rig sway "), std::string::npos);
  EXPECT_EQ(preset.rigPath(), beside);
  scratch_.write("reed.rig.json", "{}");
  preset.useRig(beside);
  EXPECT_EQ(wait(preset), Workshop::News::kBaked);
  EXPECT_NE(log().back().find(" --rig " + beside + " "), std::string::npos);

  EXPECT_EQ(Workshop(order("skin"), program_).rigPath(), beside);
  Workshop own(order((scratch_ / "mine.json").string()), program_);
  EXPECT_EQ(own.rigPath(), (scratch_ / "mine.json").string());
}

TEST_F(WorkshopTest, NoProgramNoBake) {
  Workshop absent(order(), "");
  EXPECT_EQ(wait(absent), Workshop::News::kFailed);
  EXPECT_NE(absent.error().find("PATH"), std::string::npos);
  Workshop broken(order(), (scratch_ / "nothing").string());
  EXPECT_EQ(wait(broken), Workshop::News::kFailed);
  EXPECT_NE(broken.error().find("nothing: cannot be started"), std::string::npos);
  EXPECT_NE(broken.exitCode(), 0);
}

std::optional<Arguments> parse(std::vector<const char*> words, std::string* wrong = nullptr) {
  words.insert(words.begin(), "kelp-view");
  std::string unused;
  return parseArguments(static_cast<int>(words.size()), words.data(), wrong ? *wrong : unused);
}

TEST(ViewArguments, AreUnderstood) {
  EXPECT_EQ(parse({})->pack, "");
  const auto plain = parse({"reed.kelp", "--frames", "3", "reed.ppm"});
  EXPECT_EQ(plain->pack, "reed.kelp");
  EXPECT_EQ(plain->frames, 3);
  EXPECT_EQ(plain->picture, "reed.ppm");
  EXPECT_FALSE(plain->watch);
  const auto pack = parse({"--edit", "--watch", "reed.kelp"});
  EXPECT_TRUE(pack->edit && pack->watch && !pack->bake);
  const auto model = parse({"--frames", "1", "--watch", "in/reed.glb", "--rig", "reed.rig.json",
                            "--resolution", "64", "--fill=solid"});
  EXPECT_EQ(model->pack, "in/reed.kelp");
  EXPECT_EQ(model->bake->source, "in/reed.glb");
  EXPECT_EQ(model->bake->rig, "reed.rig.json");
  EXPECT_EQ(model->bake->options, (std::vector<std::string>{"--resolution", "64", "--fill=solid"}));
  for (const std::vector<const char*>& named : {std::vector<const char*>{"-o", "x.kelp"},
                                                {"-ox.kelp"},
                                                {"--output=x.kelp"},
                                                {"--output", "x.kelp"}}) {
    std::vector<const char*> words{"--watch", "reed.glb"};
    words.insert(words.end(), named.begin(), named.end());
    EXPECT_EQ(parse(words)->pack, "x.kelp");
  }
}

TEST(ViewArguments, AreRefusedByName) {
  const std::pair<std::vector<const char*>, const char*> bad[] = {
      {{"--frames"}, "--frames"},
      {{"--frames", "none"}, "--frames"},
      {{"--watch"}, "--watch"},
      {{"--watch", "--edit"}, "--watch"},
      {{"a.kelp", "b.kelp"}, "b.kelp"},
      {{"--turn"}, "--turn"},
      {{"a.kelp", "--watch", "b.glb"}, "--watch"},
      {{"--watch", "a.kelp", "--resolution"}, "--resolution"},
      {{"--watch", "a.glb", "--progress", "bar"}, "--progress"},
      {{"--watch", "a.glb", "-MD"}, "-MD"},
      {{"--watch", "a.glb", "--frames", "3"}, "before --watch"}};
  for (const auto& [words, word] : bad) {
    std::string wrong;
    EXPECT_FALSE(parse(words, &wrong));
    EXPECT_NE(wrong.find(word), std::string::npos) << wrong;
  }
}

}  // namespace
}  // namespace kelp::view
