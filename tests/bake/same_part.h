// SPDX-License-Identifier: MIT
// Two files that hold the same volume.
#pragma once

#include "import_scratch.h"

namespace kelp::bake::test {

inline void expectSame(const std::filesystem::path& nvdb, const std::filesystem::path& vdb,
                       const Settings& settings = {}) {
  const SourceModel a = importFile(nvdb, settings), b = importFile(vdb, settings);
  EXPECT_EQ(a.format, "NanoVDB");
  const SourcePart &x = a.parts[0], &y = b.parts[0];
  ASSERT_EQ(x.grid.has_value(), y.grid.has_value());
  if (x.grid) {
    EXPECT_EQ(x.grid->size, y.grid->size);
    EXPECT_EQ(x.grid->solid, y.grid->solid);
    EXPECT_EQ(x.grid->to_node, y.grid->to_node);
    ASSERT_EQ(x.grid->surface.size(), y.grid->surface.size());
    for (std::size_t i = 0; i < x.grid->surface.size(); ++i) {
      ASSERT_EQ(x.grid->surface[i].normal, y.grid->surface[i].normal);
      ASSERT_EQ(x.grid->surface[i].material.base_color, y.grid->surface[i].material.base_color);
    }
  } else {
    EXPECT_EQ(x.fog->size, y.fog->size);
    EXPECT_EQ(x.fog->density, y.fog->density);
    EXPECT_EQ(x.fog->heat, y.fog->heat);
    EXPECT_EQ(x.fog->extinction, y.fog->extinction);
    EXPECT_EQ(x.fog->to_node, y.fog->to_node);
  }
}

}  // namespace kelp::bake::test
