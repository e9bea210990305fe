// SPDX-License-Identifier: MIT
// Mistakes of a host are answered by an error: null and old handles, wrong sizes, null pointers, objects that
// another thread uses.
#include <atomic>
#include <functional>
#include <thread>

#include "both.h"

namespace kelp::test {
namespace {

struct Handles {
  kelp_asset asset;
  kelp_pose pose;
  kelp_spring spring;
  kelp_planner planner;
};

struct Call {
  const char* name;
  std::function<kelp_result(const Handles&)> call;
};

// Memory that the calls below read and write; large enough for all of them.
const float kNumbers[16] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
const float kElsewhere[3] = {2, 3, 4};
float numbers[64];
std::int32_t number;
std::uint32_t count;
std::uint64_t large;
kelp_bool yes;
kelp_knot knots[4];
kelp_swing swings[4];
kelp_motion motion = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}, 0};
kelp_instance instance;  // of the handles under test

// `out`: a struct of kelp.h with its size.
template <class T>
T* out() {
  static T value;
  value = sized<T>();
  return &value;
}

const kelp_instance* in(const Handles& h) {
  instance = instanceOf(h.asset, h.pose);
  return &instance;
}

// Functions whose first handle is an asset.
const Call kAssetCalls[] = {
    {"pump", [](const Handles& h) { return kelp_asset_pump(h.asset, &yes); }},
    {"load_all", [](const Handles& h) { return kelp_asset_load_all(h.asset); }},
    {"retry", [](const Handles& h) { return kelp_asset_retry(h.asset); }},
    {"info", [](const Handles& h) { return kelp_asset_get_info(h.asset, out<kelp_asset_info>()); }},
    {"part", [](const Handles& h) { return kelp_asset_get_part(h.asset, 0, out<kelp_part>()); }},
    {"clip", [](const Handles& h) { return kelp_asset_get_clip(h.asset, 0, out<kelp_clip>()); }},
    {"cage_cells",
     [](const Handles& h) { return kelp_asset_get_cage_cells(h.asset, 0, nullptr, 0, &count); }},
    {"morphs", [](const Handles& h) { return kelp_asset_get_morphs(h.asset, 0, nullptr, 0, &count); }},
    {"find_clip", [](const Handles& h) { return kelp_asset_find_clip(h.asset, "sway", &number); }},
    {"find_part", [](const Handles& h) { return kelp_asset_find_part(h.asset, "stem", &number); }},
    {"wave", [](const Handles& h) { return kelp_asset_get_wave(h.asset, 0, 0, out<kelp_wave>()); }},
    {"track", [](const Handles& h) { return kelp_asset_get_track(h.asset, 0, 0, out<kelp_track>()); }},
    {"socket", [](const Handles& h) { return kelp_asset_get_socket(h.asset, 0, out<kelp_socket>()); }},
    {"find_socket", [](const Handles& h) { return kelp_asset_find_socket(h.asset, "tip", -1, &number); }},
    {"joint", [](const Handles& h) { return kelp_asset_get_joint(h.asset, 0, out<kelp_joint>()); }},
    {"find_joint", [](const Handles& h) { return kelp_asset_find_joint(h.asset, "root", &number); }},
    {"resident", [](const Handles& h) { return kelp_asset_resident_level(h.asset, 0, 0, &number); }},
    {"level", [](const Handles& h) { return kelp_asset_get_level(h.asset, 0, 0, out<kelp_level>()); }},
    {"distances",
     [](const Handles& h) {
       return kelp_asset_get_distance_level(h.asset, 0, 0, out<kelp_distance_level>());
     }},
    {"pool_bytes", [](const Handles& h) { return kelp_pool_bytes(h.asset, 1, &large); }},
    {"bounds",
     [](const Handles& h) {
       kelp_box box;
       return kelp_instance_get_bounds(in(h), &box);
     }},
    {"part_to_world", [](const Handles& h) { return kelp_instance_part_to_world(in(h), 0, numbers); }},
    {"parts_to_world", [](const Handles& h) { return kelp_instance_parts_to_world(in(h), numbers, 2); }},
    {"to_world", [](const Handles& h) { return kelp_instance_to_world(in(h), 0, kNumbers, numbers); }},
    {"to_rest", [](const Handles& h) { return kelp_instance_to_rest(in(h), 0, kNumbers, numbers, &yes); }},
    {"frame_at", [](const Handles& h) { return kelp_instance_frame_at(in(h), 0, kNumbers, numbers); }},
    {"socket_to_world", [](const Handles& h) { return kelp_instance_socket_to_world(in(h), 0, numbers); }},
    {"raycast",
     [](const Handles& h) {
       return kelp_raycast(in(h), 1, kNumbers, kNumbers, 1, 0, out<kelp_raycast_answer>());
     }},
    {"distance",
     [](const Handles& h) {
       return kelp_distance(in(h), 1, nullptr, kNumbers, out<kelp_distance_answer>());
     }},
    {"closest_point",
     [](const Handles& h) {
       return kelp_closest_point(in(h), 1, nullptr, kNumbers, 1, out<kelp_closest_point_answer>());
     }},
    {"sphere",
     [](const Handles& h) { return kelp_overlaps_sphere(in(h), 1, nullptr, kNumbers, 1, &number); }},
    {"capsule",
     [](const Handles& h) {
       return kelp_overlaps_capsule(in(h), 1, nullptr, kNumbers, kElsewhere, 1, &number);
     }},
    {"box",
     [](const Handles& h) {
       const float turn[4] = {0, 0, 0, 1};
       return kelp_overlaps_box(in(h), 1, nullptr, kNumbers, kNumbers, turn, &number);
     }},
    {"cast",
     [](const Handles& h) {
       return kelp_sphere_cast(in(h), 1, nullptr, kNumbers, kElsewhere, 1, out<kelp_sphere_cast_answer>());
     }},
};

const Call kPoseCalls[] = {
    {"parts", [](const Handles& h) { return kelp_pose_get_parts(h.pose, &number); }},
    {"fits", [](const Handles& h) { return kelp_pose_fits(h.pose, h.asset, &yes); }},
    {"knots", [](const Handles& h) { return kelp_pose_get_knots(h.pose, 0, knots, 4, &count); }},
    {"set_knots", [](const Handles& h) { return kelp_pose_set_knots(h.pose, 0, knots, 3); }},
    {"move", [](const Handles& h) { return kelp_pose_move(h.pose, 0, 0, kNumbers); }},
    {"tangent", [](const Handles& h) { return kelp_pose_set_tangent(h.pose, 0, 0, kNumbers); }},
    {"motion", [](const Handles& h) { return kelp_pose_get_motion(h.pose, 0, &motion); }},
    {"set_motion", [](const Handles& h) { return kelp_pose_set_motion(h.pose, 0, &motion); }},
    {"reset", [](const Handles& h) { return kelp_pose_reset(h.pose); }},
    {"assign", [](const Handles& h) { return kelp_pose_assign(h.pose, h.pose); }},
    {"blend", [](const Handles& h) { return kelp_pose_blend(h.pose, h.pose, 1, nullptr, 0); }},
    {"check", [](const Handles& h) { return kelp_pose_check(h.pose); }},
    {"clamp", [](const Handles& h) { return kelp_pose_clamp(h.pose); }},
    {"add_clip", [](const Handles& h) { return kelp_pose_add_clip(h.pose, h.asset, 0, 0, 1, 0); }},
};

const Call kSpringCalls[] = {
    {"parts", [](const Handles& h) { return kelp_spring_get_parts(h.spring, &number); }},
    {"swings", [](const Handles& h) { return kelp_spring_get_swings(h.spring, 0, swings, 4, &count); }},
    {"node_swings",
     [](const Handles& h) { return kelp_spring_get_node_swings(h.spring, 0, swings, 4, &count); }},
    {"reset", [](const Handles& h) { return kelp_spring_reset(h.spring); }},
    {"push", [](const Handles& h) { return kelp_spring_push(h.spring, 0, kNumbers); }},
    {"push_in_world",
     [](const Handles& h) { return kelp_spring_push_in_world(h.spring, in(h), 0, kNumbers); }},
    {"wind", [](const Handles& h) { return kelp_spring_set_wind(h.spring, 0, kNumbers); }},
    {"wind_in_world",
     [](const Handles& h) { return kelp_spring_set_wind_in_world(h.spring, in(h), 0, kNumbers); }},
    {"push_away", [](const Handles& h) { return kelp_spring_push_away(h.spring, in(h), kNumbers, 1); }},
    {"step", [](const Handles& h) { return kelp_spring_step(h.spring, 0.1f); }},
    {"add_to", [](const Handles& h) { return kelp_spring_add_to(h.spring, h.pose); }},
};

const kelp_view* aView() {
  kelp_view* const view = out<kelp_view>();
  EXPECT_KELP(KELP_OK, kelp_view_defaults(view));
  return view;
}
const kelp_copy* wanted_copies;

const Call kPlannerCalls[] = {
    {"pool_bytes", [](const Handles& h) { return kelp_planner_get_pool_bytes(h.planner, &large); }},
    {"add", [](const Handles& h) { return kelp_planner_add(h.planner, h.asset); }},
    {"programs", [](const Handles& h) { return kelp_planner_get_programs(h.planner, h.asset, &count); }},
    {"copied", [](const Handles& h) { return kelp_planner_copied(h.planner); }},  // the asset's tables
    {"upload", [](const Handles& h) { return kelp_planner_upload(h.planner, 4096, out<kelp_stats>()); }},
    {"copies", [](const Handles& h) { return kelp_planner_get_copies(h.planner, &wanted_copies, &count); }},
    {"copied", [](const Handles& h) { return kelp_planner_copied(h.planner); }},
    {"draw",
     [](const Handles& h) {
       return kelp_planner_draw(h.planner, aView(), in(h), 1, 0, 0, out<kelp_draw_data>(), nullptr);
     }},
    {"trace",
     [](const Handles& h) {
       return kelp_planner_trace(h.planner, aView(), in(h), 1, out<kelp_draw_data>(), nullptr);
     }},
    {"remove", [](const Handles& h) { return kelp_planner_remove(h.planner, h.asset); }},
};

class CBadInput : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_KELP(kelp_pose_create(assets_.c, nullptr, &good_.pose));
    ASSERT_KELP(kelp_spring_create(assets_.c, nullptr, nullptr, &good_.spring));
    auto planner = sized<kelp_planner_options>();
    planner.pool_bytes = 256 << 10;
    ASSERT_KELP(kelp_planner_create(&planner, &good_.planner));
    ASSERT_KELP(kelp_planner_copied(good_.planner));
    good_.asset = assets_.c;
    std::uint32_t all = 0;
    ASSERT_KELP(kelp_pose_get_knots(good_.pose, 0, knots, 4, &all));
  }
  void TearDown() override {
    EXPECT_KELP(KELP_OK, kelp_pose_destroy(good_.pose));
    EXPECT_KELP(KELP_OK, kelp_spring_destroy(good_.spring));
    EXPECT_KELP(KELP_OK, kelp_planner_destroy(good_.planner));
  }

  static void expectBad(std::span<const Call> calls, const Handles& handles) {
    for (const Call& one : calls) EXPECT_EQ(kelp_result{KELP_ERROR_HANDLE}, one.call(handles)) << one.name;
  }

  const BothAssets assets_{packFile("distance")};
  Handles good_ = {};
};

TEST_F(CBadInput, TheCallsSucceedWithGoodHandles) {
  for (const std::span<const Call> calls :
       {std::span<const Call>(kAssetCalls), std::span<const Call>(kPoseCalls),
        std::span<const Call>(kSpringCalls), std::span<const Call>(kPlannerCalls)})
    for (const Call& one : calls) EXPECT_KELP(KELP_OK, one.call(good_)) << one.name;
}

TEST_F(CBadInput, NullOldAndForeignHandlesAreErrors) {
  kelp_asset old_asset = {};
  kelp_pose old_pose = {};
  kelp_spring old_spring = {};
  ASSERT_KELP(kelp_asset_open_file(packFile("distance").c_str(), nullptr, &old_asset));
  ASSERT_KELP(kelp_pose_create(old_asset, nullptr, &old_pose));
  ASSERT_KELP(kelp_spring_create(old_asset, nullptr, nullptr, &old_spring));
  ASSERT_KELP(kelp_asset_destroy(old_asset));
  ASSERT_KELP(kelp_pose_destroy(old_pose));
  ASSERT_KELP(kelp_spring_destroy(old_spring));
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_asset_destroy(old_asset));
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_pose_destroy(old_pose));
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_spring_destroy(old_spring));
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_asset_destroy({0}));
  // New objects take the old places, under other ids.
  kelp_pose fresh[3] = {};
  for (kelp_pose& pose : fresh) {
    ASSERT_KELP(kelp_pose_create(good_.asset, nullptr, &pose));
    EXPECT_NE(old_pose.id, pose.id);
  }
  for (const std::uint64_t id :
       {std::uint64_t{0}, old_asset.id, old_pose.id, old_spring.id, ~std::uint64_t{0}, std::uint64_t{1} << 40,
        std::uint64_t{77}, good_.spring.id}) {
    Handles bad = good_;
    bad.asset.id = id;
    expectBad(kAssetCalls, bad);
    bad = good_;
    bad.pose.id = id;
    expectBad(kPoseCalls, bad);
    bad = good_;
    bad.spring.id = id == good_.spring.id ? good_.pose.id : id;
    expectBad(kSpringCalls, bad);
    bad = good_;
    bad.planner.id = id;
    expectBad(kPlannerCalls, bad);
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_planner_add(good_.planner, {id}));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_planner_remove(good_.planner, {id}));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_planner_get_programs(good_.planner, {id}, &count));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_planner_destroy({id}));
    kelp_pose pose = {};
    kelp_spring spring = {};
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_pose_create({id}, nullptr, &pose));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_spring_create({id}, nullptr, nullptr, &spring));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_pose_fits(good_.pose, {id}, &yes));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_pose_add_clip(good_.pose, {id}, 0, 0, 1, 0));
    if (id != 0) {
      EXPECT_KELP(KELP_ERROR_HANDLE, kelp_pose_assign(good_.pose, {id}));
      EXPECT_KELP(KELP_ERROR_HANDLE, kelp_spring_add_to(good_.spring, {id}));
      kelp_instance list[2] = {instanceOf(good_.asset, good_.pose), instanceOf(good_.asset, good_.pose)};
      list[1].previous_pose.id = id;
      auto answer = sized<kelp_raycast_answer>();
      EXPECT_KELP(KELP_ERROR_HANDLE, kelp_raycast(list, 2, kNumbers, kNumbers, 1, 0, &answer));
      EXPECT_EQ(1u, lastError().offset);
      EXPECT_EQ(kelp_unit{KELP_UNIT_INSTANCE}, lastError().unit);
    }
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_renderer_upload({id}, 0, nullptr));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_renderer_use_here({id}));
    EXPECT_KELP(KELP_ERROR_HANDLE, kelp_renderer_destroy({id}));
  }
  for (const kelp_pose pose : fresh) ASSERT_KELP(kelp_pose_destroy(pose));
}

// A struct with bytes behind it, as a later version of the header would have it.
template <class T>
struct Grown {
  T known;
  std::uint64_t unknown[2];
};

// call(struct): a function that succeeds with `good`. first: the size in the first version of the header.
template <class T, class F>
void expectSizes(const char* name, const T& good, const F& call, std::size_t first = sizeof(T)) {
  Grown<T> grown;
  std::memset(static_cast<void*>(&grown), 0, sizeof grown);  // the padding, too
  grown.known = good;
  EXPECT_KELP(KELP_OK, call(&grown.known)) << name;
  for (const std::size_t size : {std::size_t{0}, std::size_t{4}, first - 1, std::size_t{0xffffffff}}) {
    grown.known = good;
    grown.known.struct_size = static_cast<std::uint32_t>(size);
    EXPECT_KELP(KELP_ERROR_STRUCT_SIZE, call(&grown.known)) << name << " " << size;
    EXPECT_EQ(kelp_result{KELP_ERROR_STRUCT_SIZE}, lastError().result);
  }
  for (const std::size_t size : {first, sizeof(T) + 1, sizeof grown}) {
    grown.known = good;
    grown.known.struct_size = static_cast<std::uint32_t>(size);
    EXPECT_KELP(KELP_OK, call(&grown.known)) << name << " " << size;
    EXPECT_EQ(size, grown.known.struct_size) << name;
  }
  grown.known = good;
  grown.known.struct_size = sizeof grown;
  grown.unknown[1] = std::uint64_t{1} << 63;
  EXPECT_KELP(KELP_ERROR_STRUCT_SIZE, call(&grown.known)) << name << ": what is not known is not zero";
  EXPECT_KELP(KELP_ERROR_NULL, call(static_cast<T*>(nullptr))) << name;
}

TEST_F(CBadInput, SizesOfStructs) {
  const kelp_asset a = good_.asset;
  expectSizes("error", sized<kelp_error>(), [](kelp_error* s) { return kelp_last_error(s); });
  expectSizes("options", sized<kelp_asset_options>(),
              [](kelp_asset_options* s) { return kelp_asset_options_defaults(s); });
  expectSizes(
      "info", sized<kelp_asset_info>(), [a](kelp_asset_info* s) { return kelp_asset_get_info(a, s); },
      offsetof(kelp_asset_info, joints));
  expectSizes("part", sized<kelp_part>(), [a](kelp_part* s) { return kelp_asset_get_part(a, 0, s); });
  expectSizes("clip", sized<kelp_clip>(), [a](kelp_clip* s) { return kelp_asset_get_clip(a, 0, s); });
  expectSizes("wave", sized<kelp_wave>(), [a](kelp_wave* s) { return kelp_asset_get_wave(a, 0, 0, s); });
  expectSizes("track", sized<kelp_track>(), [a](kelp_track* s) { return kelp_asset_get_track(a, 0, 0, s); });
  expectSizes("socket", sized<kelp_socket>(), [a](kelp_socket* s) { return kelp_asset_get_socket(a, 0, s); });
  expectSizes("joint", sized<kelp_joint>(), [a](kelp_joint* s) { return kelp_asset_get_joint(a, 0, s); });
  expectSizes("level", sized<kelp_level>(), [a](kelp_level* s) { return kelp_asset_get_level(a, 0, 0, s); });
  expectSizes("distance level", sized<kelp_distance_level>(),
              [a](kelp_distance_level* s) { return kelp_asset_get_distance_level(a, 0, 0, s); });
  expectSizes("spring settings", sized<kelp_spring_options>(),
              [](kelp_spring_options* s) { return kelp_spring_options_defaults(s); });
  expectSizes("config", sized<kelp_renderer_options>(),
              [](kelp_renderer_options* s) { return kelp_renderer_options_defaults(s); });
  expectSizes("planner options", sized<kelp_planner_options>(),
              [](kelp_planner_options* s) { return kelp_planner_options_defaults(s); });
  expectSizes("draw data", sized<kelp_draw_data>(), [this](kelp_draw_data* s) {
    return kelp_planner_draw(good_.planner, aView(), nullptr, 0, 0, 0, s, nullptr);
  });
  constexpr std::size_t kFirstView = offsetof(kelp_view, debug);
  expectSizes(
      "view", sized<kelp_view>(), [](kelp_view* s) { return kelp_view_defaults(s); }, kFirstView);
  constexpr std::size_t kFirst = offsetof(kelp_instance, unsound);
  expectSizes(
      "instance", sized<kelp_instance>(), [](kelp_instance* s) { return kelp_instance_defaults(s); }, kFirst);

  const kelp_instance good = instanceOf(a, good_.pose);
  kelp_box box = {};
  expectSizes(
      "instance in", good, [&](kelp_instance* s) { return kelp_instance_get_bounds(s, &box); }, kFirst);
  expectSizes("ray", sized<kelp_raycast_answer>(),
              [&](kelp_raycast_answer* s) { return kelp_raycast(&good, 1, kNumbers, kNumbers, 1, 0, s); });
  expectSizes("distance", sized<kelp_distance_answer>(),
              [&](kelp_distance_answer* s) { return kelp_distance(&good, 1, nullptr, kNumbers, s); });
  expectSizes("closest", sized<kelp_closest_point_answer>(), [&](kelp_closest_point_answer* s) {
    return kelp_closest_point(&good, 1, nullptr, kNumbers, 1, s);
  });
  expectSizes("cast", sized<kelp_sphere_cast_answer>(), [&](kelp_sphere_cast_answer* s) {
    return kelp_sphere_cast(&good, 1, nullptr, kNumbers, kElsewhere, 1, s);
  });
  auto view = sized<kelp_view>();
  ASSERT_KELP(kelp_view_defaults(&view));
  expectSizes(
      "view in", view, [&](kelp_view* s) { return kelp_level_at(s, &good, 0, 0, 0, &number); }, kFirstView);

  // Null is allowed for these: the defaults.
  auto allocator = sized<kelp_allocator>();
  allocator.allocate = [](void*, std::size_t bytes) { return std::malloc(bytes); };
  allocator.deallocate = [](void*, void* memory, std::size_t) { std::free(memory); };
  expectSizes("allocator", allocator, [a](kelp_allocator* s) {
    if (!s) return kelp_result{KELP_ERROR_NULL};
    kelp_pose pose = {};
    const kelp_result result = kelp_pose_create(a, s, &pose);
    if (result == KELP_OK) {
      EXPECT_KELP(KELP_OK, kelp_pose_destroy(pose));
    }
    return result;
  });
}

// A list of structs of a later version of the header: they lie farther apart.
TEST_F(CBadInput, AListOfLargerInstances) {
  Grown<kelp_instance> list[2] = {{instanceOf(good_.asset, good_.pose), {}},
                                  {instanceOf(good_.asset, good_.pose), {}}};
  list[0].known.struct_size = list[1].known.struct_size = sizeof list[0];
  list[0].known.to_world[12] = 100;  // away
  Dice dice;
  runtime::Ray ray{{0, 12, 50}};  // one that hits
  do ray.direction = glm::vec3(0, 12, 0) + dice.vec3(12) - ray.origin;
  while (!raycast(runtime::Instance{assets_.cpp.get()}, ray));
  const float *const origin = &ray.origin.x, *const direction = &ray.direction.x;
  auto answer = sized<kelp_raycast_answer>();
  ASSERT_KELP(kelp_raycast(&list[0].known, 2, origin, direction, 100, 0, &answer));
  EXPECT_EQ(1u, answer.found);
  EXPECT_EQ(1, answer.instance);
  list[1].known.struct_size = sizeof(kelp_instance);
  EXPECT_KELP(KELP_ERROR_STRUCT_SIZE, kelp_raycast(&list[0].known, 2, origin, direction, 100, 0, &answer));
  EXPECT_EQ(1u, lastError().offset);
}

TEST_F(CBadInput, NullPointersAndBadNumbers) {
  const kelp_asset a = good_.asset;
  const kelp_pose p = good_.pose;
  const kelp_planner d = good_.planner;
  const kelp_instance i = instanceOf(a, p);
  auto source = sized<kelp_source>();
  kelp_asset asset = {};
  kelp_renderer renderer = {};
  kelp_planner planner = {};
  auto pool = sized<kelp_planner_options>();
  auto* const data = out<kelp_draw_data>();
  auto config = sized<kelp_renderer_options>();
  std::uint64_t bytes = 0;
  for (const kelp_result result : {
           kelp_asset_open(nullptr, nullptr, &asset),
           kelp_asset_open(&source, nullptr, &asset),  // no read
           kelp_asset_open_file(nullptr, nullptr, &asset),
           kelp_asset_open_file("x", nullptr, nullptr),
           kelp_asset_open_memory(nullptr, 9, nullptr, &asset),
           kelp_asset_pump(a, nullptr),
           kelp_asset_find_clip(a, nullptr, &number),
           kelp_asset_find_part(a, nullptr, &number),
           kelp_asset_find_socket(a, "tip", -1, nullptr),
           kelp_asset_find_joint(a, "root", nullptr),
           kelp_pose_create(a, nullptr, nullptr),
           kelp_pose_get_knots(p, 0, nullptr, 1, &count),
           kelp_pose_get_knots(p, 0, knots, 1, nullptr),
           kelp_pose_set_knots(p, 0, nullptr, 3),
           kelp_pose_move(p, 0, 0, nullptr),
           kelp_pose_blend(p, p, 1, nullptr, 2),
           kelp_pose_set_motion(p, 0, nullptr),
           kelp_spring_push(good_.spring, 0, nullptr),
           kelp_spring_push_away(good_.spring, &i, nullptr, 1),
           kelp_spring_push_away(good_.spring, nullptr, kNumbers, 1),
           kelp_instance_to_world(&i, 0, nullptr, numbers),
           kelp_overlaps_sphere(&i, 1, nullptr, kNumbers, 1, nullptr),
           kelp_overlaps_sphere(nullptr, 1, nullptr, kNumbers, 1, &number),
           kelp_renderer_create(&config, &renderer),  // no get_proc_address
           kelp_pool_bytes(a, 0, nullptr),
           kelp_planner_create(nullptr, &planner),
           kelp_planner_create(&pool, nullptr),
           kelp_planner_get_pool_bytes(d, nullptr),
           kelp_planner_get_programs(d, a, nullptr),
           kelp_planner_get_copies(d, nullptr, &count),
           kelp_planner_get_copies(d, &wanted_copies, nullptr),
           kelp_planner_draw(d, nullptr, nullptr, 0, 0, 0, data, nullptr),
           kelp_planner_draw(d, aView(), nullptr, 1, 0, 0, data, nullptr),
           kelp_planner_draw(d, aView(), nullptr, 0, 0, 0, nullptr, nullptr),
           kelp_planner_trace(d, nullptr, nullptr, 0, data, nullptr),
           kelp_get_program_text(0, 0, 0, 0, nullptr, nullptr, 1, &large),
           kelp_get_program_text(0, 0, 0, 0, nullptr, nullptr, 0, nullptr),
       })
    EXPECT_EQ(kelp_result{KELP_ERROR_NULL}, result);
  config.get_proc_address = [](void*, const char*) -> void* { return nullptr; };
  config.state = 2;
  kelp_instance painted = i;
  painted.palette_count = 2;
  kelp_box box;
  EXPECT_KELP(KELP_ERROR_NULL, kelp_instance_get_bounds(&painted, &box));
  for (const kelp_result result : {
           kelp_renderer_create(&config, &renderer),
           kelp_pool_bytes(a, 8, &bytes),
           kelp_planner_create(&pool, &planner),  // of no bytes
           kelp_planner_upload(d, 1, nullptr),
           kelp_get_program_text(65, 0, 0, 0, nullptr, nullptr, 0, &large),
           kelp_get_program_text(0, 3, 0, 0, nullptr, nullptr, 0, &large),
           kelp_get_program_text(0, -1, 0, 0, nullptr, nullptr, 0, &large),
           kelp_get_program_text(0, 0, 2, 0, nullptr, nullptr, 0, &large),
           kelp_get_program_text(0, 0, -1, 0, nullptr, nullptr, 0, &large),
           kelp_get_program_text(0, 0, 0, 8, nullptr, nullptr, 0, &large),
           kelp_planner_draw(d, aView(), nullptr, 0, 3, 0, data, nullptr),
           kelp_planner_draw(d, aView(), nullptr, 0, 0, 3, data, nullptr),
           kelp_planner_draw(d, aView(), nullptr, 0, -1, 0, data, nullptr),
           kelp_planner_draw(d, aView(), nullptr, 0, 0, -1, data, nullptr),
           kelp_asset_get_part(a, 2, out<kelp_part>()),
           kelp_asset_get_part(a, -1, out<kelp_part>()),
           kelp_asset_get_clip(a, 1, out<kelp_clip>()),
           kelp_asset_get_wave(a, 0, 1, out<kelp_wave>()),
           kelp_asset_get_track(a, 0, -1, out<kelp_track>()),
           kelp_asset_get_socket(a, 2, out<kelp_socket>()),
           kelp_asset_get_joint(a, 3, out<kelp_joint>()),
           kelp_pose_add_clip(p, a, 9, 0, 1, 0),
           kelp_pose_add_clip(p, a, 0, 0, 1, 2),
           kelp_pose_move(p, 0, 3, kNumbers),
           kelp_pose_get_knots(p, 2, knots, 4, &count),
           kelp_pose_get_motion(p, 5, &motion),
           kelp_spring_step(good_.spring, -1),
           kelp_spring_get_swings(good_.spring, -1, swings, 4, &count),
       })
    EXPECT_EQ(kelp_result{KELP_ERROR_MISUSE}, result);
  EXPECT_EQ(0u, asset.id);
  EXPECT_EQ(0u, renderer.id);
  EXPECT_EQ(0u, planner.id);
  pool.pool_bytes = 256 << 10;
  pool.features = 8;
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_planner_create(&pool, &planner));
}

// While a thread is in a call with an asset, the asset stays.
TEST_F(CBadInput, AnObjectInUseIsNotDestroyed) {
  struct Host {
    kelp_asset asset = {};
    bool opened = false;
    kelp_result destroyed = 0, by_thread = 0;
    std::vector<char> bytes;
  } host;
  host.bytes.resize(1 << 16);
  std::FILE* const file = std::fopen(packFile("distance").c_str(), "rb");
  ASSERT_NE(nullptr, file);
  host.bytes.resize(std::fread(host.bytes.data(), 1, host.bytes.size(), file));
  std::fclose(file);
  auto source = sized<kelp_source>();
  source.user = &host;
  source.size = host.bytes.size();
  source.read = [](void* user, std::uint64_t offset, void* to, std::size_t bytes) -> kelp_read {
    Host& self = *static_cast<Host*>(user);
    if (self.opened) {
      self.destroyed = kelp_asset_destroy(self.asset);
      std::thread([&self] { self.by_thread = kelp_asset_destroy(self.asset); }).join();
    }
    std::memcpy(to, self.bytes.data() + offset, bytes);
    return KELP_READ_DONE;
  };
  ASSERT_KELP(kelp_asset_open(&source, nullptr, &host.asset));
  host.opened = true;
  kelp_bool more = 0;
  ASSERT_KELP(kelp_asset_pump(host.asset, &more));
  EXPECT_EQ(kelp_result{KELP_ERROR_BUSY}, host.destroyed);
  EXPECT_EQ(kelp_result{KELP_ERROR_BUSY}, host.by_thread);
  ASSERT_KELP(kelp_asset_destroy(host.asset));
}

// Handles are made, used and destroyed on several threads at once.
TEST_F(CBadInput, HandlesOnManyThreads) {
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      kelp_pose last = {};
      for (int i = 0; i < 3000; ++i) {
        kelp_pose pose = {};
        if (kelp_pose_create(assets_.c, nullptr, &pose) != KELP_OK || kelp_pose_reset(pose) != KELP_OK)
          ++wrong;
        if (kelp_pose_destroy(pose) != KELP_OK || kelp_pose_reset(pose) != KELP_ERROR_HANDLE) ++wrong;
        if (last.id == pose.id || kelp_pose_destroy(last) != KELP_ERROR_HANDLE) ++wrong;
        last = pose;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(0, wrong);
}

TEST_F(CBadInput, ErrorsAreOfTheirThread) {
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_move(good_.pose, 0, 9, kNumbers));
  std::thread([] {
    EXPECT_EQ(kelp_result{KELP_OK}, lastError().result);
    EXPECT_STREQ("", lastError().text);
    EXPECT_EQ(kelp_result{KELP_ERROR_HANDLE}, kelp_pose_reset({0}));
    EXPECT_EQ(kelp_result{KELP_ERROR_HANDLE}, lastError().result);
  }).join();
  EXPECT_EQ(kelp_result{KELP_ERROR_MISUSE}, lastError().result);
  EXPECT_STRNE("", lastError().text);
}

TEST(CResults, HaveTexts) {
  std::vector<std::string> texts;
  for (const int code : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 100, 101, 102, 103, 104, 105, -1})
    texts.emplace_back(kelp_result_text(code));
  EXPECT_EQ(toString(ErrorCode::kChecksum), texts[7]);
  EXPECT_EQ(texts[21], texts[20]) << "105 and -1 are unknown";
  for (std::size_t i = 0; i < 21; ++i)
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(texts[i], texts[k]);
  EXPECT_EQ(100u, kelp_version()) << "0.1.0";
}

}  // namespace
}  // namespace kelp::test
