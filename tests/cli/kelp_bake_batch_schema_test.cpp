// SPDX-License-Identifier: MIT
// kelp-bake --plan and --report of a batch against their published schemas, with every status that there is.
#include <nlohmann/json.hpp>

#include "process.h"
#include "support/json_schema.h"

namespace kelp::test {
namespace {

using nlohmann::json;

std::string schemaFile(const char* name) { return std::string(KELP_SOURCE_DIR) + "/tools/kelp-bake/" + name; }

class KelpBakeBatchSchema : public testing::Test {
 protected:
  void SetUp() override {
    write("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    write("bad.obj", "f 1 2 3\n");
    write(
        "m.json",
        R"({"defaults": {"resolution": 8}, "assets": ["good.obj", "bad.obj", {"input": "good.obj", "output": "again.kelp", "up": "-x", "keep-materials": true, "write-deps": true}]})");
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  json report() { return json::parse(readWhole(folder_ / "report.json"), nullptr, false); }

  Scratch folder_;
};

TEST_F(KelpBakeBatchSchema, Plans) {
  const JsonSchema schema(schemaFile("kelp-bake-plan.schema.json"));
  for (const char* shard : {"", "--shard=2/2", "--shard=3/4"}) {
    std::vector<std::string> arguments{KELP_BAKE, "--manifest", folder_ / "m.json", "--plan"};
    if (*shard) arguments.push_back(shard);
    const ProcessResult result = runProcess(arguments);
    ASSERT_EQ(result.exit, 0) << result.err;
    const json plan = json::parse(result.out, nullptr, false);
    EXPECT_EQ(schema.check(plan), "") << result.out;
    EXPECT_NE(schema.check(json::object()), "");
  }
}

TEST_F(KelpBakeBatchSchema, Reports) {
  const JsonSchema schema(schemaFile("kelp-bake-batch.schema.json"));
  const std::vector<std::string> arguments{KELP_BAKE, "--manifest", folder_ / "m.json", "--report",
                                           folder_ / "report.json"};
  for (const char* first : {"baked", "current"}) {
    EXPECT_EQ(runProcess(arguments).exit, 3);
    const json read = report();
    EXPECT_EQ(schema.check(read), "") << read.dump(1);
    ASSERT_EQ(read["assets"].size(), 3u);
    EXPECT_EQ(read["assets"][0]["status"], first);
    EXPECT_EQ(read["assets"][1]["status"], "failed");
    EXPECT_EQ(read["assets"][2]["pack_bytes"], std::filesystem::file_size(folder_ / "again.kelp"));
  }
}

}  // namespace
}  // namespace kelp::test
