// Json: what it reads and writes, and what it leaves when memory runs out at any allocation.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <new>

#include "core/files/json.h"

namespace {

long allocations = 0, fails = 0;  // the number of the allocation to fail with all after it; 0: none

void* allocate(std::size_t bytes) {
  ++allocations;
  void* const memory = fails != 0 && allocations >= fails ? nullptr : std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace lodestone {
namespace {

constexpr const char* text =
    R"({"a":[1,-2,{"b":[3.5]}],"c":"a string that does not fit into the object itself","d":{}})";

// Whatever the work has made is destroyed while there is no memory.
void run_out_everywhere(const std::function<void()>& work) {
  allocations = 0;
  work();
  const long count = allocations;
  ASSERT_GT(count, 3);
  for (long number = 1; number <= count; ++number) {
    allocations = 0;
    fails = number;
    bool ran_out = false;
    try {
      work();
    } catch (const std::bad_alloc&) {
      ran_out = true;
    }
    fails = 0;
    EXPECT_TRUE(ran_out) << number;
  }
}

TEST(Json, MembersOfANullWithoutMemory) {
  run_out_everywhere([] {
    Json root;
    root["asset"] = {{"version", "2.0"}, {"generator", "a name that needs memory of its own"}};
    root["buffers"].push_back({{"byteLength", 7}, {"extensions", {{"x", {{"fallback", true}}}}}});
    root["asset"]["extras"]["deep"].push_back(1);
  });
}

TEST(Json, CopiesAndTextsWithoutMemory) {
  const Json value = Json::parse(text);
  run_out_everywhere([&] {
    Json copy = value;
    copy.update({{"c", value}, {"e", {1, 2, 3}}});
    Json other = {1};
    other = copy;
    other["a"] = copy.dump();
  });
}

TEST(Json, ParsesWithoutMemory) {
  run_out_everywhere([] { EXPECT_EQ(Json::parse(text).size(), 3u); });
}

TEST(Json, AListOfNamedValuesIsAnObject) {
  EXPECT_EQ((Json{{"a", 1}, {"b", {1, "x"}}}).dump(), R"({"a":1,"b":[1,"x"]})");
  EXPECT_EQ((Json{{"a", 1}, 2}).dump(), R"([["a",1],2])");
  EXPECT_EQ(Json::array({{"a", 1}}).dump(), R"([["a",1]])");
  EXPECT_TRUE(Json().is_null());
}

TEST(Json, WritesWhatItReads) {
  EXPECT_EQ(Json::parse(text).dump(), text);
  EXPECT_EQ(Json::parse(R"({"a":[1,{}],"b":[]})").dump(1), "{\n \"a\": [\n  1,\n  {}\n ],\n \"b\": []\n}");
  EXPECT_EQ(Json::parse("{\"a\":1,\"a\":2}").dump(), "{\"a\":2}");
  for (const double number : {0.0, -0.0, 0.1, 1e-4, 9.99e-5, 1e14, 1e15, -1.0 / 3, 5e-324, 1.7976931348623157e308}) {
    const std::string written = Json(number).dump();
    EXPECT_TRUE(Json::parse(written).is_number_float()) << written;
    EXPECT_EQ(Json::parse(written).get<double>(), number) << written;
  }
  EXPECT_EQ(Json({100000.0, 1e15, 1e-5, NAN, INFINITY}).dump(), "[100000.0,1e+15,1e-05,null,null]");
  EXPECT_EQ(Json("\"\\\n\x01\xc3\xa4\xff").dump(), "\"\\\"\\\\\\n\\u0001\xc3\xa4\xef\xbf\xbd\"");
}

TEST(Json, NamesThePlaceOfWhatIsNotJson) {
  const auto byte_of = [](const std::string& wrong) {
    try {
      (void)Json::parse(wrong);
    } catch (const JsonError& error) {
      return static_cast<long>(error.byte);
    }
    return -1L;
  };
  EXPECT_EQ(byte_of("[1,"), 4);
  EXPECT_EQ(byte_of(""), 1);
  EXPECT_EQ(byte_of("[1]x"), 4);
  EXPECT_EQ(byte_of("[1e999]"), 0);
  EXPECT_EQ(byte_of(std::string(Json::most_depth, '[') + std::string(Json::most_depth, ']')), -1);
  EXPECT_EQ(byte_of(std::string(1'000'000, '[')), 0);
}

TEST(Json, RefusesValuesOfAnotherKind) {
  const Json object{{"a", 1}}, list{1, 2};
  EXPECT_THROW((void)object.at("b"), JsonError);
  EXPECT_THROW((void)list.at(2), JsonError);
  EXPECT_THROW((void)object[0], JsonError);
  EXPECT_THROW((void)list["a"], JsonError);
  EXPECT_THROW((void)object.begin(), JsonError);
  EXPECT_THROW((void)object.at("a").get<std::string>(), JsonError);
  EXPECT_THROW((void)Json("x").get<double>(), JsonError);
  EXPECT_THROW((void)(list.get<std::array<int, 3>>()), JsonError);
  EXPECT_EQ(list.get<std::vector<double>>(), (std::vector<double>{1, 2}));
  EXPECT_EQ(list.find("a"), nullptr);
}

TEST(Json, AddsTheNextItem) {
  Json root;
  root["meshes"][0]["primitives"][0] = 1;
  EXPECT_EQ(root.dump(), R"({"meshes":[{"primitives":[1]}]})");
  EXPECT_THROW((void)root["meshes"][2], JsonError);
}

TEST(Json, ComparesNumbersByValue) {
  EXPECT_EQ(Json(1), Json(1u));
  EXPECT_EQ(Json(1.0), Json(1));
  EXPECT_NE(Json(-1), Json(~0ull));
  EXPECT_LT(Json(-1), Json(0u));
  EXPECT_NE(Json(true), Json(1));
  EXPECT_LT((Json{{"a", 1}}), (Json{{"a", 2}}));
}

}  // namespace
}  // namespace lodestone
